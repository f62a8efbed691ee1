"""Taking noise out: of any field by non-local means, of the positions by Taubin smoothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..describe import described
from ..geometry import as_points
from ..progress import Progress, as_callable
from ._arrays import as_field
from .graph import SurfaceGraph

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .._options import NonLocalMeansOptions, SmoothPositionsOptions

__all__ = ["non_local_means", "smooth_positions"]


@described("non_local_means")
def non_local_means(
    graph: SurfaceGraph,
    field: ArrayLike,
    direction1: ArrayLike,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[NonLocalMeansOptions],
) -> NDArray[np.float64]:
    """(n,) the field without noise (the paper's eq. 1 and 3): every value becomes a mean over the vertices around,
    weighted by how alike their surroundings are, so edges stay.

    field       (n,) finite
    direction1  (n, 3) unit tangents or zero, in any frame: `Curvatures.direction1`

    Raises InvalidInput (names option or vertex; wrong length).
    """
    values, tangents = as_field(field, "field"), as_points(direction1, "direction1")
    with as_callable(progress) as report:
        return np.asarray(_core.non_local_means(graph, values, tangents, {**options}, threads, report))


@described("smooth_positions")
def smooth_positions(
    graph: SurfaceGraph,
    *,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SmoothPositionsOptions],
) -> NDArray[np.float64]:
    """(n, 3) [input length unit] positions without noise (Taubin 1995), relative to `graph.origin` as
    `graph.position` is; the volume is kept, border vertices move along the border only.

    Raises InvalidInput (option out of range).
    """
    with as_callable(progress) as report:
        return np.asarray(_core.smooth_positions(graph, {**options}, threads, report))
