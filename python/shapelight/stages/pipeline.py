"""All stages in a row."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..describe import described
from ..progress import Progress, as_callable
from ..results import Result
from .graph import SurfaceGraph

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .._options import FieldsOptions

__all__ = ["SurfaceFields", "compute_fields"]


@dataclass(frozen=True, repr=False, eq=False)
class SurfaceFields(Result):
    """What the stages found, per vertex of the graph; arrays of stages that were switched off are empty."""

    noise: float
    """[input length unit] standard deviation along the normal."""
    denoised: bool
    """Non-local means ran."""
    curvature_method: str
    """The one used."""
    curvature_passes: int
    """The number used."""
    k1: NDArray[np.float64]
    """(n,) [1 / input length unit] larger principal curvature, convex positive."""
    k2: NDArray[np.float64]
    """(n,) [1 / input length unit] smaller principal curvature."""
    curvedness: NDArray[np.float64]
    """(n,) [1 / input length unit]."""
    shape_index: NDArray[np.float64]
    """(n,) in [-1, 1]."""
    surface_variation: NDArray[np.float64]
    """(n,) in [0, 1/3]."""
    illumination: NDArray[np.float64]
    """(n,) in [0, 1]: the smooth part of the shape index."""
    reflectance: NDArray[np.float64]
    """(n,) in [-log 2, log 2]: the detail."""
    segment: NDArray[np.uint32]
    """(n,) labels from 0."""
    num_segments: int
    importance: NDArray[np.float64]
    """(n,) density of samples that the shape asks for, see `sampling_density`."""


@described("fields")
def compute_fields(
    graph: SurfaceGraph,
    kind: Literal["mesh", "range_image", "cloud"],
    *,
    preset: Literal["detail", "fast", "paper"] = "detail",
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[FieldsOptions],
) -> SurfaceFields:
    """Runs the stages over a graph: noise, curvature, shape index, non-local means, Retinex, segmentation, importance
    (paper, sections II.A to II.C). The graph is given, so its options are not read.

    kind  of the input, such as `Geometry.kind`; steers the adaptive choices only. Choosing how curvature is estimated
          ends these, as it does for `fields`.

    Raises InvalidInput (option out of range).
    """
    given: dict[str, Any] = dict(options)
    if given.keys() & {"curvature_method", "curvature_passes"}:
        given["adaptive"] = False
    with as_callable(progress) as report:
        return SurfaceFields(**_core.compute_fields(graph, kind, preset, given, threads, report))
