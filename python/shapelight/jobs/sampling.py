"""Sampling and the fields that guide it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal, Optional

import numpy as np
from numpy.typing import ArrayLike

from .. import _core
from ..arguments import as_text
from ..describe import described
from ..errors import TargetUnreachable
from ..interop import GeometryLike, as_geometry
from ..progress import Progress, as_callable
from ..results import FieldsResult, SampleResult
from .quantities import Bytes, Count, Length, Share, as_count, as_length, as_numbers, as_share, check_memory

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from .._options import FieldsOptions, SampleOptions


@described("sample")
def sample(
    points_or_mesh: GeometryLike,
    faces: Optional[ArrayLike] = None,
    *,
    count: Optional[Count] = None,
    ratio: Optional[Share] = None,
    spacing: Optional[Length] = None,
    preset: Literal["detail", "fast", "paper"] = "detail",
    allow_partial: bool = False,
    max_memory: Optional[Bytes] = None,
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
    allow_partial   as many points as there are when the count cannot be reached; `is_partial` says so
    max_memory      [bytes, or "2G"] refuse the job when its estimate is larger
    threads         0: all cores; never changes a result
    progress        None, True, a callable (fraction, phase), or a tqdm bar

    Raises InvalidInput (options, or not exactly one of count, ratio and spacing), TargetUnreachable (fewer points can
    be chosen than asked for), BudgetExceeded.
    """
    geometry = as_geometry(points_or_mesh, faces)
    check_memory("sample", [geometry], max_memory)
    size = as_count("count", count), as_share("ratio", ratio), as_length("spacing", spacing, geometry)
    given = as_numbers("sample", {**options}, geometry)
    preset_name = as_text(preset, "preset")
    view = geometry._view(attributes=False)
    is_partial = False
    with as_callable(progress) as report:
        try:
            found = _core.sample(view, *size, preset_name, given, threads, report)
        except TargetUnreachable as error:
            if not allow_partial or error.reachable == 0:
                raise
            is_partial = True
            found = _core.sample(view, error.reachable, None, None, preset_name, given, threads, report)
    return SampleResult(**found, is_partial=is_partial, source=points_or_mesh, geometry=geometry)


@described("fields")
def fields(
    points_or_mesh: GeometryLike,
    faces: Optional[ArrayLike] = None,
    *,
    preset: Literal["detail", "fast", "paper"] = "detail",
    max_memory: Optional[Bytes] = None,
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
    check_memory("fields", [geometry], max_memory)
    with as_callable(progress) as report:
        found = _core.fields(geometry._view(attributes=False), as_text(preset, "preset"), {**options}, threads, report)
    columns = found.pop("attributes")
    whole = replace(geometry, attributes={**geometry.attributes, **columns})
    arrays = {name: columns.get(name, np.zeros(0, np.float32)) for name in FIELD_NAMES}
    return FieldsResult(**arrays, **found, source=points_or_mesh, geometry=whole)


FIELD_NAMES = ("shape_index", "curvedness", "illumination", "reflectance", "segment", "importance")
