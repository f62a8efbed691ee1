"""The surface cut where a field changes."""

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

    from .._options import SegmentFieldOptions

__all__ = ["SegmentationResult", "segment_field"]


@dataclass(frozen=True, repr=False, eq=False)
class SegmentationResult(Result):
    """Connected segments of a surface."""

    label: NDArray[np.uint32]
    """(n,) in [0, count), numbered by the lowest vertex of the segment."""
    count: int


@described("segment_field")
def segment_field(
    graph: SurfaceGraph,
    field: ArrayLike,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SegmentFieldOptions],
) -> SegmentationResult:
    """Cuts the surface where an (n,) finite field changes (the paper's eq. 9 to 12; Felzenszwalb and Huttenlocher).

    Raises InvalidInput (names option or vertex; wrong length).
    """
    with as_callable(progress) as report:
        return SegmentationResult(**_core.segment_field(graph, as_field(field, "field"), {**options}, threads, report))
