"""A field split into a smooth part and detail."""

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

    from .._options import DecomposeRetinexOptions

__all__ = ["RetinexResult", "decompose_retinex"]


@dataclass(frozen=True, repr=False, eq=False)
class RetinexResult(Result):
    """The two parts of a field s: with the intensity I = (s + 1) / 2, reflectance = log(I + 1) - log(L + 1)."""

    illumination: NDArray[np.float64]
    """(n,) L in [0, 1], the smooth part."""
    reflectance: NDArray[np.float64]
    """(n,) R in [-log 2, log 2], the detail."""


@described("decompose_retinex")
def decompose_retinex(
    graph: SurfaceGraph,
    field: ArrayLike,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[DecomposeRetinexOptions],
) -> RetinexResult:
    """Splits an (n,) field in [-1, 1], such as the shape index, into a smooth part and detail by a bilateral mean
    (the paper's eq. 4 to 8).

    Raises InvalidInput (names option or vertex; wrong length).
    """
    with as_callable(progress) as report:
        return RetinexResult(**_core.decompose_retinex(graph, as_field(field, "field"), {**options}, threads, report))
