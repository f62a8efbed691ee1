"""The jobs: one function each, the same names and options as the shapelight command."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, Literal, Optional, Union

import numpy as np
from numpy.typing import ArrayLike

from . import _core
from .describe import described
from .errors import InvalidInput
from .geometry import Geometry
from .interop import GeometryLike, as_geometry
from .progress import Progress, as_callable
from .results import FieldsResult, SampleResult

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import FieldsOptions, SampleOptions

Share = Union[float, str]
"""0.1 or "10%"."""
Length = Union[float, str]
"""In input units, or a share of the bounding box's diagonal: "0.5%"."""


def _share(name: str, value: Optional[Share]) -> Optional[float]:
    if not isinstance(value, str):
        return value
    try:
        return float(value[:-1]) / 100.0 if value.endswith("%") else float(value)
    except ValueError:
        raise InvalidInput(f"{name}: '{value}', expected a share such as 0.1 or '10%'") from None


def _length(name: str, value: Optional[Length], view: _core.GeometryView) -> Optional[float]:
    if not isinstance(value, str):
        return value
    try:
        return float(value[:-1]) / 100.0 * view.diagonal if value.endswith("%") else float(value)
    except ValueError:
        raise InvalidInput(f"{name}: '{value}', expected a length such as 0.5 or '2%' of the diagonal") from None


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
    view = geometry._view()
    with as_callable(progress) as report:
        found = _core.sample(
            view, count, _share("ratio", ratio), _length("spacing", spacing, view), preset, options, threads, report
        )
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
        found = _core.fields(geometry._view(), preset, options, threads, report)
    columns = found.pop("attributes")
    whole = replace(geometry, attributes={**geometry.attributes, **columns})
    arrays = {name: columns.get(name, np.zeros(0, np.float32)) for name in FIELD_NAMES}
    return FieldsResult(**arrays, **found, source=points_or_mesh, geometry=whole)


FIELD_NAMES = ("shape_index", "curvedness", "illumination", "reflectance", "segment", "importance")
