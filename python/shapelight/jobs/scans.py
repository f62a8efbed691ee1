"""Registration of two scans and of many."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Sequence

from numpy.typing import ArrayLike

from .. import _core
from ..arguments import as_real
from ..describe import described
from ..errors import InvalidInput, PostconditionFailed
from ..geometry import Geometry, as_transform
from ..interop import GeometryLike, as_geometry
from ..progress import Progress, as_callable
from ..results import AlignedPair, AlignedScan, AlignResult, RegisterResult
from .quantities import Bytes, as_numbers, check_memory

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .._options import AlignOptions, RegisterOptions


@described("register")
def register(
    source: GeometryLike,
    target: GeometryLike,
    *,
    init: Optional[ArrayLike] = None,
    min_confidence: float = 0.5,
    max_memory: Optional[Bytes] = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[RegisterOptions],
) -> RegisterResult:
    """The motion that brings the source onto a target that overlaps it (paper, section III.B).

    source, target  scans: whatever `as_geometry` takes
    init            (4, 4) rigid, source into target, to start from; else a starting pose is looked for
    min_confidence  [1] a pose that is less sure is withheld; 0 takes any
    max_memory      [bytes, or "2G"] refuse the job when its estimate is larger

    Raises FormatError (too few points), InvalidInput, PostconditionFailed: the confidence is below `min_confidence`;
    its attribute `result` holds the RegisterResult.
    """
    least = as_real(min_confidence, "min_confidence")
    moving, fixed = as_geometry(source), as_geometry(target)
    check_memory("register", [moving, fixed], max_memory)
    start = None if init is None else as_transform(init, "init")
    given = as_numbers("register", {**options}, fixed)
    views = moving._view(attributes=False), fixed._view(attributes=False)
    with as_callable(progress) as report:
        found = _core.register_scans(*views, start, given, threads, report)
    result = RegisterResult(**found, source=source, geometry=moving, target=fixed)
    if not result.confidence >= least:
        raise _withheld(
            f"confidence {result.confidence:.2f} is below min_confidence {least:g}: {result.doubt}", result
        )
    return result


@described("align")
def align(
    scans: Sequence[GeometryLike],
    *,
    merged: bool = True,
    allow_partial: bool = False,
    max_memory: Optional[Bytes] = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[AlignOptions],
) -> AlignResult:
    """Brings many scans into one frame, without starting guesses: that of the first scan of the largest group.

    scans          two or more: whatever `as_geometry` takes
    merged         also all points of the placed scans as one cloud
    allow_partial  return what could be placed when some scans could not

    Raises InvalidInput (names the scan), PostconditionFailed: not all scans could be placed; its attribute `result`
    holds the AlignResult.
    """
    merged = bool(merged)
    geometries = [as_geometry(scan) for scan in scans]
    if len(geometries) < 2:
        raise InvalidInput(f"scans: {len(geometries)}, expected two or more")
    check_memory("align", geometries, max_memory)
    given = as_numbers("align", {**options}, geometries[0])
    with as_callable(progress) as report:
        found = _core.align_scans([g._view(attributes=merged) for g in geometries], merged, given, threads, report)
    found["scans"] = [AlignedScan(**scan) for scan in found["scans"]]
    found["pairs"] = [AlignedPair(**pair) for pair in found["pairs"]]
    cloud = found.pop("merged")
    result = AlignResult(**found, sources=tuple(scans), merged=None if cloud is None else Geometry(**cloud))
    if not result.all_placed and not (allow_partial and result.num_placed > 1):
        raise _withheld(f"{result.num_placed} of {len(result.scans)} scans could be placed", result)
    return result


def _withheld(message: str, result: Any) -> PostconditionFailed:
    error = PostconditionFailed(message)
    error.result = result
    return error
