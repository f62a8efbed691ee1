"""What the surface says at every vertex: curvature, shape index, surface variation, noise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..describe import described
from ..progress import Progress, as_callable
from ..results import Result
from ._arrays import as_field
from .graph import SurfaceGraph

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .._options import ComputeShapeIndexOptions, ComputeSurfaceVariationOptions, EstimateCurvaturesOptions

__all__ = [
    "Curvatures",
    "compute_shape_index",
    "compute_surface_variation",
    "curvedness",
    "estimate_curvatures",
    "estimate_noise",
]


@dataclass(frozen=True, repr=False, eq=False)
class Curvatures(Result):
    """Principal curvatures, positive where the surface is convex seen from the side its normals point to."""

    k1: NDArray[np.float64]
    """(n,) [1 / input length unit] the larger one."""
    k2: NDArray[np.float64]
    """(n,) [1 / input length unit] the smaller one."""
    direction1: NDArray[np.float64]
    """(n, 3) unit tangents along k1, sign arbitrary; zero where the curvature is undefined."""

    @property
    def curvedness(self) -> NDArray[np.float64]:
        """(n,) [1 / input length unit] sqrt((k1^2 + k2^2) / 2)."""
        return curvedness(self.k1, self.k2)


@described("estimate_curvatures")
def estimate_curvatures(
    graph: SurfaceGraph,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[EstimateCurvaturesOptions],
) -> Curvatures:
    """Principal curvatures at every vertex (the ingredient of the paper's eq. 2): "taubin" for meshes, "quadric" for
    clean clouds, "normal-field" for noisy ones.

    Raises InvalidInput (option out of range).
    """
    with as_callable(progress) as report:
        return Curvatures(**_core.estimate_curvatures(graph, {**options}, threads, report))


def curvedness(k1: ArrayLike, k2: ArrayLike) -> NDArray[np.float64]:
    """Koenderink's curvedness sqrt((k1^2 + k2^2) / 2) of (n,) principal curvatures: how much the surface bends,
    whatever its shape. Raises InvalidInput when the lengths differ."""
    return np.asarray(_core.curvedness(as_field(k1, "k1"), as_field(k2, "k2")))


@described("compute_shape_index")
def compute_shape_index(
    graph: SurfaceGraph,
    curvatures: Curvatures,
    sigma: float,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[ComputeShapeIndexOptions],
) -> NDArray[np.float64]:
    """(n,) shape index (Koenderink; the paper's eq. 2): -1 cup, -0.5 rut, 0 saddle or flat, 0.5 ridge, 1 dome.

    curvatures  of `estimate_curvatures`, or anything that has (n,) `k1` and `k2`
    sigma       [input length unit] noise, of `estimate_noise`

    Raises InvalidInput (names option or vertex; wrong length).
    """
    k1, k2 = as_field(curvatures.k1, "k1"), as_field(curvatures.k2, "k2")
    with as_callable(progress) as report:
        return np.asarray(_core.compute_shape_index(graph, k1, k2, sigma, {**options}, threads, report))


@described("compute_surface_variation")
def compute_surface_variation(
    graph: SurfaceGraph,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[ComputeSurfaceVariationOptions],
) -> NDArray[np.float64]:
    """(n,) surface variation (Pauly et al. 2002): the smallest eigenvalue's share of the covariance of the points
    around a vertex, 0 on a plane, at most 1/3. Raises InvalidInput (option out of range)."""
    with as_callable(progress) as report:
        return np.asarray(_core.compute_surface_variation(graph, {**options}, threads, report))


def estimate_noise(graph: SurfaceGraph, *, threads: int = 0, progress: Progress = None) -> float:
    """[input length unit] robust standard deviation of the measurement noise along the normal; 0 when no vertex has
    at least 9 vertices in its 2-ring."""
    with as_callable(progress) as report:
        return float(_core.estimate_noise(graph, threads, report))
