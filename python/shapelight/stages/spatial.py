"""Nearest points, closest points on a mesh, and where rays meet it; exact, for many queries at once."""

from __future__ import annotations

from typing import NamedTuple, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..arguments import as_real
from ..geometry import NO_INDEX, as_points
from ..interop import GeometryLike, as_geometry
from ..progress import Progress, as_callable
from ._arrays import as_count

__all__ = [
    "NO_INDEX",
    "ClosestPoints",
    "KdTree",
    "NearestPoints",
    "PointsWithin",
    "RayHits",
    "TriangleTree",
    "closest_point_on_triangle",
]


class NearestPoints(NamedTuple):
    """Of each of n queries; (n,) when k is 1, else (n, k), nearest first, ties by index."""

    distances: NDArray[np.float64]
    """[input length unit]; infinite where there is no point."""
    indices: NDArray[np.uint32]
    """Of the tree's points; NO_INDEX where there is none."""


class PointsWithin(NamedTuple):
    """Of query i: indices[offsets[i]:offsets[i + 1]], nearest first, ties by index."""

    offsets: NDArray[np.int64]
    """(n + 1,)."""
    indices: NDArray[np.uint32]
    """(m,) of the tree's points."""
    distances: NDArray[np.float64]
    """(m,) [input length unit]."""


class ClosestPoints(NamedTuple):
    """On a mesh, of each of n queries; of equally close triangles the one with the smallest index."""

    distances: NDArray[np.float64]
    """(n,) [input length unit]; NaN for a query that is not finite."""
    triangles: NDArray[np.uint32]
    """(n,) NO_INDEX for a query that is not finite."""
    points: NDArray[np.float64]
    """(n, 3) on the triangles."""


class RayHits(NamedTuple):
    """Where each of n rays first meets a mesh."""

    distances: NDArray[np.float64]
    """(n,) [lengths of the direction] from the origin; infinite when nothing is met."""
    triangles: NDArray[np.uint32]
    """(n,) NO_INDEX when nothing is met."""
    points: NDArray[np.float64]
    """(n, 3); NaN when nothing is met."""
    normals: NDArray[np.float64]
    """(n, 3) unit normals of the triangles, by their winding; NaN when nothing is met."""


class KdTree:
    """Kd-tree over (n, 3) points, of which it keeps a copy. Raises InvalidInput for a point that is not finite."""

    def __init__(self, points: ArrayLike) -> None:
        self._tree = _core.make_kd_tree(as_points(points))

    def __len__(self) -> int:
        return len(self._tree)

    def __repr__(self) -> str:
        return f"KdTree({len(self)} points)"

    def nearest(
        self,
        queries: ArrayLike,
        k: int = 1,
        *,
        radius: float = np.inf,
        threads: int = 0,
        progress: Progress = None,
    ) -> NearestPoints:
        """The k nearest points of each of the (n, 3) queries, none farther than `radius` [input length unit]."""
        with as_callable(progress) as report:
            limits = as_count(k, "k"), as_real(radius, "radius")
            found = self._tree.nearest(as_points(queries, "queries"), *limits, threads, report)
        return NearestPoints(*(np.squeeze(column, axis=1) if k == 1 else column for column in found))

    def within(
        self, queries: ArrayLike, radius: float, *, threads: int = 0, progress: Progress = None
    ) -> PointsWithin:
        """All points with distance <= radius [input length unit] of each of the (n, 3) queries."""
        with as_callable(progress) as report:
            places, limit = as_points(queries, "queries"), as_real(radius, "radius")
            return PointsWithin(*self._tree.within(places, limit, threads, report))

    def all_nearest(self, k: int, *, threads: int = 0, progress: Progress = None) -> NDArray[np.uint32]:
        """(len(tree), k): of every point the k nearest others, nearest first; NO_INDEX where there are fewer. Several
        times faster than as many queries."""
        with as_callable(progress) as report:
            return np.asarray(self._tree.all_nearest(as_count(k, "k"), threads, report))


class TriangleTree:
    """Tree over the triangles of a mesh, of which it keeps a copy.

    Raises InvalidInput (index out of range, a corner that is not finite, no triangle).
    """

    def __init__(
        self,
        mesh: GeometryLike,
        faces: Optional[ArrayLike] = None,
        *,
        threads: int = 0,
        progress: Progress = None,
    ) -> None:
        with as_callable(progress) as report:
            self._tree = _core.make_triangle_tree(as_geometry(mesh, faces)._view(attributes=False), threads, report)

    def __len__(self) -> int:
        return len(self._tree)

    def __repr__(self) -> str:
        return f"TriangleTree({len(self)} triangles)"

    def closest(self, queries: ArrayLike, *, threads: int = 0, progress: Progress = None) -> ClosestPoints:
        """The closest points on the mesh to (n, 3) queries; fastest when queries that follow each other are close."""
        with as_callable(progress) as report:
            return ClosestPoints(*self._tree.closest(as_points(queries, "queries"), threads, report))

    def first_hit(
        self, origins: ArrayLike, directions: ArrayLike, *, threads: int = 0, progress: Progress = None
    ) -> RayHits:
        """Where the rays origin + t direction, t > 0, first meet a triangle, from either side; both (n, 3).

        Nothing slips through between triangles that share corners. Raises InvalidInput when the lengths differ.
        """
        starts, ways = as_points(origins, "origins"), as_points(directions, "directions")
        with as_callable(progress) as report:
            return RayHits(*self._tree.first_hit(starts, ways, threads, report))


def closest_point_on_triangle(query: ArrayLike, a: ArrayLike, b: ArrayLike, c: ArrayLike) -> NDArray[np.float64]:
    """Closest point to each query on its triangle (a, b, c), which may be degenerate (Ericson 2005, section 5.1.5).
    All are (3,) or (n, 3) and are broadcast against each other."""
    corners = np.broadcast_arrays(query, a, b, c)
    points = _core.closest_point_on_triangle(*(as_points(np.atleast_2d(corner)) for corner in corners))
    return np.asarray(points).reshape(corners[0].shape)
