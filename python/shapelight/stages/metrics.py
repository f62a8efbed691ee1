"""How good a result is: samples against their reference, one surface against another."""

from __future__ import annotations

from typing import TYPE_CHECKING, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..describe import described
from ..geometry import as_points
from ..interop import GeometryLike, as_geometry
from ..progress import Progress, as_callable
from ..results import SamplingQuality, SurfaceDistance, surface_distance
from ._arrays import as_count, as_optional_field
from .spatial import TriangleTree

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .._options import MeasureSurfaceDistanceOptions

__all__ = [
    "measure_sampling",
    "measure_surface_distance",
    "surface_variation_knn",
    "vertex_distances",
]


def measure_sampling(
    reference: ArrayLike,
    samples: ArrayLike,
    importance: Optional[ArrayLike] = None,
    *,
    threads: int = 0,
    progress: Progress = None,
) -> SamplingQuality:
    """Measures (m, 3) samples against their (n, 3) reference points, exactly.

    importance  (n,) of the reference points: the tenth with the largest is "feature"; without, these figures are 0

    Raises InvalidInput (empty, of unequal length, or not finite: names the index).
    """
    points, chosen = as_points(reference, "reference"), as_points(samples, "samples")
    weights = as_optional_field(importance, "importance")
    with as_callable(progress) as report:
        return SamplingQuality(**_core.measure_sampling(points, chosen, weights, threads, report))


def surface_variation_knn(
    points: ArrayLike, k: int = 30, *, threads: int = 0, progress: Progress = None
) -> NDArray[np.float64]:
    """(n,) surface variation (Pauly, Gross and Kobbelt 2002) over the k nearest points, the point itself included;
    needs neither mesh nor normals. Raises InvalidInput (k < 3, or a point that is not finite)."""
    with as_callable(progress) as report:
        return np.asarray(_core.surface_variation_knn(as_points(points), as_count(k, "k", 3), threads, report))


@described("measure_surface_distance")
def measure_surface_distance(
    reference: GeometryLike,
    test: GeometryLike,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[MeasureSurfaceDistanceOptions],
) -> SurfaceDistance:
    """How far two meshes are apart, as Metro measures it (Cignoni, Rocchini and Scopigno 1998), with exact closest
    points. Meshes are whatever `as_geometry` takes; arrays as (vertices, faces).

    Raises InvalidInput (no triangle or no area, index out of range, a corner that is not finite: says in which mesh).
    """
    views = as_geometry(reference)._view(attributes=False), as_geometry(test)._view(attributes=False)
    with as_callable(progress) as report:
        return surface_distance(_core.measure_surface_distance(*views, {**options}, threads, report))


def vertex_distances(
    mesh: GeometryLike, surface: TriangleTree, *, threads: int = 0, progress: Progress = None
) -> NDArray[np.float64]:
    """(n,) [input length unit] distance from every vertex to the surface; NaN at a vertex that is not finite."""
    view = as_geometry(mesh)._view(attributes=False)
    with as_callable(progress) as report:
        return np.asarray(_core.vertex_distances(view, surface._tree, threads, report))
