"""What Open3D's PointCloud and TriangleMesh do to themselves, as functions of any object that as_geometry() takes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput
from ..interop import GeometryLike, as_geometry, like
from ..jobs import sample, simplify
from ..stages.spatial import KdTree


def voxel_down_sample(cloud: GeometryLike, voxel_size: float) -> Any:
    """One point for each occupied cube of edge `voxel_size` [input length unit].

    Differs from Open3D: the point is the input point nearest to the others' mean, not the mean; attributes are its own.
    """
    return sample(cloud, spacing=voxel_size, method="voxel", flag_outliers=False).output


def random_down_sample(cloud: GeometryLike, sampling_ratio: float, *, seed: int = 0) -> Any:
    """A random share of the points, as many as in Open3D. Differs: the same `seed` always gives the same points."""
    if not 0.0 <= sampling_ratio <= 1.0:
        raise InvalidInput(f"sampling_ratio: {sampling_ratio}, expected 0 to 1")
    geometry = as_geometry(cloud)
    count = int(len(geometry) * sampling_ratio)
    if count == 0:
        return like(cloud, geometry.select([]))
    kept = sample(geometry, count=count, method="random", seed=seed, flag_outliers=False).indices
    return like(cloud, geometry.select(np.sort(kept)))


def uniform_down_sample(cloud: GeometryLike, every_k_points: int) -> Any:
    """Points 0, k, 2 k, ...: the same as Open3D's."""
    if every_k_points < 1:
        raise InvalidInput(f"every_k_points: {every_k_points}, expected at least 1")
    geometry = as_geometry(cloud)
    return like(cloud, geometry.select(np.arange(0, len(geometry), every_k_points, dtype=np.uint32)))


def farthest_point_down_sample(cloud: GeometryLike, num_samples: int) -> Any:
    """`num_samples` points, each as far as can be from those before it.

    Differs from Open3D: the first point is chosen, not point 0 (there is no `start_index`), the points keep the order
    of the input, and it takes O(n log n) rather than O(n num_samples).
    """
    return sample(cloud, count=num_samples, method="farthest", flag_outliers=False).output


def simplify_quadric_decimation(
    mesh: GeometryLike,
    target_number_of_triangles: int,
    maximum_error: float = math.inf,
    boundary_weight: float = 1.0,
) -> Any:
    """The mesh with `target_number_of_triangles` or one fewer, by quadric edge collapse onto free vertices (Garland and
    Heckbert 1997).

    Differs from Open3D: the result is checked and stays manifold where the input was, attributes and texture follow,
    and the error is bounded by shapelight.simplify(max_error=...) in lengths, so `maximum_error` is refused.
    """
    if maximum_error != math.inf:
        raise InvalidInput("maximum_error: not bounded here; use shapelight.simplify(mesh, max_error=...), in lengths")
    simplified = simplify(
        mesh,
        faces=target_number_of_triangles,
        method="qslim",
        placement="optimal",
        boundary_weight=boundary_weight,
    )
    return simplified.output


def compute_point_cloud_distance(source: GeometryLike, target: GeometryLike) -> NDArray[np.float64]:
    """(n,) [input length unit]: from every point of `source` to the nearest of `target`. Differs from Open3D: an array
    comes back, and points that are not finite have no distance (NaN) and are nobody's nearest."""
    moving, fixed = as_geometry(source).positions, as_geometry(target).positions
    distances = np.full(len(moving), np.nan)
    seen = np.isfinite(moving).all(axis=1)
    distances[seen] = KdTree(fixed[np.isfinite(fixed).all(axis=1)]).nearest(moving[seen]).distances
    return distances
