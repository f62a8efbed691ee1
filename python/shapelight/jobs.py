"""The jobs: one function each, the same names and options as the shapelight command."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Dict, Literal, Optional, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from .describe import described, option_table
from .errors import InvalidInput, PostconditionFailed
from .geometry import Geometry, as_transform
from .interop import GeometryLike, as_geometry
from .progress import Progress, as_callable
from .results import (
    AlignedPair,
    AlignedScan,
    AlignResult,
    FieldsResult,
    RegisterResult,
    SampleResult,
    SamplingQuality,
    SimplifyResult,
    SurfaceDistance,
    surface_distance,
)

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import AlignOptions, FieldsOptions, MetricsOptions, RegisterOptions, SampleOptions, SimplifyOptions

Share = Union[float, str]
"""0.1 or "10%"."""
Length = Union[float, str]
"""In input units, or a share of the bounding box's diagonal: "0.5%"."""


def _number(name: str, value: Union[None, float, str], whole: float, expected: str) -> Optional[float]:
    """A number, or a share of `whole` written "5%"."""
    if not isinstance(value, str):
        return value
    try:
        return float(value[:-1]) / 100.0 * whole if value.endswith("%") else float(value)
    except ValueError:
        raise InvalidInput(f"{name}: '{value}', expected {expected}") from None


def _share(name: str, value: Optional[Share]) -> Optional[float]:
    return _number(name, value, 1.0, "a share such as 0.1 or '10%'")


def _length(name: str, value: Optional[Length], geometry: Geometry) -> Optional[float]:
    whole = geometry.diagonal if isinstance(value, str) else 1.0
    return _number(name, value, whole, "a length such as 0.5 or '2%' of the diagonal")


def _resolve(table: str, options: Dict[str, Any], geometry: Geometry) -> Dict[str, Any]:
    """Options with shares and lengths as numbers."""
    resolved = dict(options)
    for row in option_table(table):
        name = row["name"]
        if row["type"] != "float" or not isinstance(options.get(name), str):
            continue
        if row["unit"] == "input length unit":
            resolved[name] = _length(name, options[name], geometry)
        elif row["unit"] == "1":
            resolved[name] = _share(name, options[name])
    return resolved


@described("sample")
def sample(
    points_or_mesh: GeometryLike,
    faces: Optional[ArrayLike] = None,
    *,
    count: Optional[int] = None,
    ratio: Optional[Share] = None,
    spacing: Optional[Length] = None,
    preset: Literal["detail", "fast", "paper"] = "detail",
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[SampleOptions],
) -> SampleResult:
    """Keeps the points that carry the shape: exactly as many as asked for, none twice (paper, section II.D).

    points_or_mesh  (n, 3) points, or whatever `as_geometry` takes; C-contiguous float64 is not copied
    faces           (m, 3) vertex indices, when the points are a mesh's
    count           [points] to keep, or
    ratio           share of the finite points to keep, or
    spacing         [input length unit, or "%" of the diagonal] what the method bounds
    preset          "fast": without non-local means and Retinex; "paper": the literal paper
    threads         0: all cores; never changes a result
    progress        None, True, a callable (fraction, phase), or a tqdm bar

    Raises InvalidInput (options, or not exactly one of count, ratio and spacing), TargetUnreachable (fewer points can
    be chosen than asked for).
    """
    geometry = as_geometry(points_or_mesh, faces)
    share, length = _share("ratio", ratio), _length("spacing", spacing, geometry)
    given = _resolve("sample", {**options}, geometry)
    with as_callable(progress) as report:
        found = _core.sample(geometry._view(), count, share, length, preset, given, threads, report)
    return SampleResult(**found, source=points_or_mesh, geometry=geometry)


@described("fields")
def fields(
    points_or_mesh: GeometryLike,
    faces: Optional[ArrayLike] = None,
    *,
    preset: Literal["detail", "fast", "paper"] = "detail",
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[FieldsOptions],
) -> FieldsResult:
    """Shape index, curvedness, illumination, reflectance, segment and importance per point (paper, II.A to II.C).

    points_or_mesh  (n, 3) points, or whatever `as_geometry` takes; C-contiguous float64 is not copied
    faces           (m, 3) vertex indices, when the points are a mesh's

    Raises InvalidInput (option out of range).
    """
    geometry = as_geometry(points_or_mesh, faces)
    with as_callable(progress) as report:
        found = _core.fields(geometry._view(), preset, {**options}, threads, report)
    columns = found.pop("attributes")
    whole = replace(geometry, attributes={**geometry.attributes, **columns})
    arrays = {name: columns.get(name, np.zeros(0, np.float32)) for name in FIELD_NAMES}
    return FieldsResult(**arrays, **found, source=points_or_mesh, geometry=whole)


FIELD_NAMES = ("shape_index", "curvedness", "illumination", "reflectance", "segment", "importance")


@described("simplify")
def simplify(
    mesh_or_vertices: GeometryLike,
    triangles: Optional[ArrayLike] = None,
    /,
    *,
    vertices: Optional[int] = None,
    faces: Optional[int] = None,
    ratio: Optional[Share] = None,
    max_error: Optional[Length] = None,
    preset: Optional[Literal["detail", "fast", "best", "paper"]] = None,
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

    Raises InvalidInput, TargetUnreachable (with `reachable`), PostconditionFailed (the result is withheld).
    """
    for name, value in (("vertices", vertices), ("faces", faces)):
        if isinstance(value, (np.ndarray, list)):
            raise InvalidInput(f"{name}: an array; pass arrays by position: simplify(vertices, faces, ratio=0.1)")
    geometry = as_geometry(mesh_or_vertices, triangles)
    share, length = _share("ratio", ratio), _length("max_error", max_error, geometry)
    given = _resolve("simplify", {**options}, geometry)
    with as_callable(progress) as report:
        found = _core.simplify(geometry._view(), vertices, faces, share, length, preset, given, threads, report)
    simplified = Geometry(**found.pop("geometry"))
    measured = found.pop("measured")
    return SimplifyResult(
        vertices=simplified.positions,
        faces=simplified.triangles,
        measured=measured and surface_distance(measured),
        **found,
        source=mesh_or_vertices,
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
        found = _core.metrics(first._view(), second._view(), distances, {**options}, threads, report)
    if found["surfaces"] is not None:
        return surface_distance(found["surfaces"], distances=found["distances"])
    return SamplingQuality(**found["points"], distances=found["distances"])


@described("register")
def register(
    source: GeometryLike,
    target: GeometryLike,
    *,
    init: Optional[ArrayLike] = None,
    min_confidence: float = 0.5,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[RegisterOptions],
) -> RegisterResult:
    """The motion that brings the source onto a target that overlaps it (paper, section III.B).

    source, target  scans: whatever `as_geometry` takes
    init            (4, 4) rigid, source into target, to start from; else a starting pose is looked for
    min_confidence  [1] a pose that is less sure is withheld; 0 takes any

    Raises FormatError (too few points), InvalidInput, PostconditionFailed: the confidence is below `min_confidence`;
    its attribute `result` holds the RegisterResult.
    """
    moving, fixed = as_geometry(source), as_geometry(target)
    start = None if init is None else as_transform(init, "init")
    given = _resolve("register", {**options}, fixed)
    with as_callable(progress) as report:
        found = _core.register_scans(moving._view(), fixed._view(), start, given, threads, report)
    result = RegisterResult(**found, source=source, geometry=moving)
    if not result.confidence >= min_confidence:
        raise _withheld(
            f"confidence {result.confidence:.2f} is below min_confidence {min_confidence:g}: {result.doubt}", result
        )
    return result


@described("align")
def align(
    scans: Sequence[GeometryLike],
    *,
    merged: bool = True,
    allow_partial: bool = False,
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
    geometries = [as_geometry(scan) for scan in scans]
    if len(geometries) < 2:
        raise InvalidInput(f"scans: {len(geometries)}, expected two or more")
    given = _resolve("align", {**options}, geometries[0])
    with as_callable(progress) as report:
        found = _core.align_scans([g._view() for g in geometries], merged, given, threads, report)
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
