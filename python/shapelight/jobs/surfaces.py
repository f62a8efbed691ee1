"""Simplification, and how far surfaces are apart."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, Optional, Union

from numpy.typing import ArrayLike

from .. import _core
from ..arguments import as_text
from ..describe import described
from ..errors import InvalidInput, TargetUnreachable
from ..geometry import Geometry
from ..interop import GeometryLike, as_geometry
from ..progress import Progress, as_callable
from ..results import SamplingQuality, SimplifyResult, SurfaceDistance, surface_distance
from .quantities import Bytes, Count, Length, Share, as_count, as_length, as_numbers, as_share, check_memory

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .._options import MetricsOptions, SimplifyOptions


@described("simplify")
def simplify(
    mesh_or_vertices: GeometryLike,
    triangles: Optional[ArrayLike] = None,
    /,
    *,
    vertices: Optional[Count] = None,
    faces: Optional[Count] = None,
    ratio: Optional[Share] = None,
    max_error: Optional[Length] = None,
    preset: Optional[Literal["detail", "fast", "best", "paper"]] = None,
    allow_partial: bool = False,
    max_memory: Optional[Bytes] = None,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SimplifyOptions],
) -> SimplifyResult:
    """Fewer vertices, the same shape (paper, section III.A): simplify(mesh, ratio=0.1), simplify(vertices, faces, ...).

    mesh_or_vertices  a mesh or range image, or (n, 3) vertices; of a cloud the points are sampled
    triangles         (m, 3) vertex indices, when vertices were given
    vertices          to keep, exactly, or
    faces             to keep, within one, or
    ratio             share of the finite vertices to keep, or
    max_error         [input length unit, or "%" of the diagonal] largest distance between input and result, both ways
    preset            "fast": fewer sweeps, "best": more, "paper": the literal paper; None is "detail"

    allow_partial     as far as it goes when the target cannot be reached; `is_partial` says so
    max_memory        [bytes, or "2G"] refuse the job when its estimate is larger

    Raises InvalidInput, TargetUnreachable (with `reachable`), PostconditionFailed (the result is withheld),
    BudgetExceeded.
    """
    for name, value in (("vertices", vertices), ("faces", faces)):
        if isinstance(value, (list, tuple)) or getattr(value, "ndim", 0) > 0:
            raise InvalidInput(f"{name}: an array; pass arrays by position: simplify(vertices, faces, ratio=0.1)")
    geometry = as_geometry(mesh_or_vertices, triangles)
    check_memory("simplify", [geometry], max_memory)
    num_vertices, num_faces = as_count("vertices", vertices), as_count("faces", faces)
    size = num_vertices, num_faces, as_share("ratio", ratio), as_length("max_error", max_error, geometry)
    given = as_numbers("simplify", {**options}, geometry)
    if preset is not None:
        as_text(preset, "preset")
    view = geometry._view()
    is_partial = False
    with as_callable(progress) as report:
        try:
            found = _core.simplify(view, *size, preset, given, threads, report)
        except TargetUnreachable as error:
            if not allow_partial or error.reachable == 0:
                raise
            is_partial = True
            most = error.reachable
            num_vertices, num_faces = (None, most) if num_faces else (most, None)
            found = _core.simplify(view, num_vertices, num_faces, None, None, preset, given, threads, report)
    simplified = Geometry(**found.pop("geometry"))
    measured = found.pop("measured")
    return SimplifyResult(
        vertices=simplified.positions,
        faces=simplified.triangles,
        measured=measured and surface_distance(measured),
        **found,
        is_partial=is_partial,
        source=mesh_or_vertices,
        original=geometry,
        geometry=simplified,
    )


@described("metrics")
def metrics(
    reference: GeometryLike,
    test: GeometryLike,
    *,
    distances: bool = False,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[MetricsOptions],
) -> Union[SurfaceDistance, SamplingQuality]:
    """How far two surfaces are apart or, when one is a cloud, how well the points of `test` cover the reference.

    reference, test  whatever `as_geometry` takes; meshes of arrays as (vertices, faces)
    distances        also from every vertex of `test` to the surface of the reference

    Raises InvalidInput (no surface or no area, an index out of range).
    """
    first, second = as_geometry(reference), as_geometry(test)
    with as_callable(progress) as report:
        views = first._view(attributes=False), second._view(attributes=False)
        found = _core.metrics(*views, bool(distances), {**options}, threads, report)
    if found["surfaces"] is not None:
        return surface_distance(found["surfaces"], distances=found["distances"])
    return SamplingQuality(**found["points"], distances=found["distances"])
