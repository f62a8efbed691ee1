"""How good a result is: samples against their reference, one surface against another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..describe import described
from ..geometry import as_points
from ..interop import GeometryLike, as_geometry
from ..progress import Progress, as_callable
from ..results import Result
from ._arrays import as_count, as_optional_field
from .spatial import TriangleTree

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .._options import MeasureSurfaceDistanceOptions

__all__ = [
    "DistanceSummary",
    "NormalDeviation",
    "SamplingQuality",
    "SurfaceDistance",
    "measure_sampling",
    "measure_surface_distance",
    "surface_variation_knn",
    "vertex_distances",
]


@dataclass(frozen=True, repr=False)
class SamplingQuality(Result):
    """How well a sample stands for its reference points. Lengths in [input length unit]."""

    coverage_max: float
    """Largest distance from a reference point to its nearest sample."""
    coverage_mean: float
    """Mean of those distances."""
    feature_coverage_mean: float
    """The same over the tenth of the reference with the largest importance; 0 without importance."""
    feature_coverage_max: float
    feature_share: float
    """Share of samples whose nearest reference point is in that tenth."""
    spacing_mean: float
    """Mean distance from a sample to the nearest other one."""
    spacing_min: float
    """Smallest of those distances."""
    spacing_cv: float
    """Their standard deviation by their mean; 0 is a perfect lattice."""


@dataclass(frozen=True)
class DistanceSummary:
    """Distances from the points of one surface to another. [input length unit]"""

    mean: float
    """Over the area."""
    rms: float
    """Over the area: the paper's eq. 15."""
    max: float
    """Over the samples and all vertices: the one-sided Hausdorff distance from below."""

    def scaled(self, factor: float) -> DistanceSummary:
        """Times a factor, such as 1 / diagonal."""
        return DistanceSummary(self.mean * factor, self.rms * factor, self.max * factor)


@dataclass(frozen=True)
class NormalDeviation:
    """Angles between the face normals at a point and at its closest point. [rad]"""

    rms: float
    p95: float
    """95th percentile."""


@dataclass(frozen=True, repr=False)
class SurfaceDistance(Result):
    """How far two surfaces are apart. [input length unit]"""

    forward: DistanceSummary
    """From the reference to the test mesh."""
    backward: DistanceSummary
    """From the test mesh to the reference."""
    symmetric: DistanceSummary
    """Mean of the means, root of the mean square, larger maximum."""
    vertex_rms: float
    """Root mean square over the vertices of the reference, to the test mesh."""
    diagonal: float
    """Of the reference's bounding box."""
    normal_deviation: NormalDeviation
    """Of both directions together."""
    samples: int
    """[points] taken per surface."""


def measure_sampling(
    reference: ArrayLike,
    samples: ArrayLike,
    importance: Optional[ArrayLike] = None,
    *,
    threads: int = 0,
    progress: Progress = None,
) -> SamplingQuality:
    """Measures (m, 3) samples against their (n, 3) reference points, exactly.

    importance  (n,) of the reference points: the tenth with the largest is "feature"

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
    points. Meshes are whatever `as_geometry` takes; arrays as Geometry(vertices, faces).

    Raises InvalidInput (no triangle or no area, index out of range, a corner that is not finite: says in which mesh).
    """
    views = as_geometry(reference)._view(), as_geometry(test)._view()
    with as_callable(progress) as report:
        found = _core.measure_surface_distance(*views, options, threads, report)
    for direction in ("forward", "backward", "symmetric"):
        found[direction] = DistanceSummary(**found[direction])
    found["normal_deviation"] = NormalDeviation(**found["normal_deviation"])
    return SurfaceDistance(**found)


def vertex_distances(
    mesh: GeometryLike, surface: TriangleTree, *, threads: int = 0, progress: Progress = None
) -> NDArray[np.float64]:
    """(n,) [input length unit] distance from every vertex to the surface; NaN at a vertex that is not finite."""
    view = as_geometry(mesh)._view()
    with as_callable(progress) as report:
        return np.asarray(_core.vertex_distances(view, surface._tree, threads, report))
