"""Pictures: shaded meshes, range images and clouds, with fields as colours. The same as `shapelight render` makes."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterable, List, Optional, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .arguments import Path as FileName
from .arguments import as_array, as_file_name, as_floats, as_real, as_text, as_whole
from .describe import described
from .errors import InvalidInput
from .geometry import as_points
from .interop import GeometryLike, as_geometry
from .progress import Progress, as_callable
from .results import Result

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._options import RenderOptions

Picture = NDArray[np.uint8]
"""(height, width, 3) red, green, blue; the first row on top."""


def _is_point(thing: Any) -> bool:
    return isinstance(thing, (list, tuple, np.ndarray)) and len(thing) == 3 and all(np.isscalar(x) for x in thing)


def _several(things: Any) -> List[Any]:
    """A list of geometries as it is; one geometry, which may be a tuple or a list of points, as a list of one."""
    is_list = isinstance(things, list) and not (things and _is_point(things[0]))
    return list(things) if is_list else [things]


def _texts(given: Union[str, Sequence[str]], name: str) -> List[str]:
    """One or several."""
    several = [given] if isinstance(given, str) or not isinstance(given, Iterable) else given
    return [as_text(text, name) for text in several]


def _field_names(color: Union[str, Sequence[str]]) -> List[str]:
    """One or several; values are for `show`."""
    names = [color] if isinstance(color, str) else list(color) if isinstance(color, Iterable) else [color]
    if not all(isinstance(name, str) for name in names):
        raise InvalidInput("color: expected the name of a field, or a list of names (sl.show takes values, too)")
    return names


def _name(thing: Any) -> str:
    return Path(thing).stem if isinstance(thing, (str, os.PathLike)) else ""


@described("render")
def render(
    geometries: Union[GeometryLike, Sequence[GeometryLike]],
    *,
    color: Union[None, str, Sequence[str]] = None,
    dots: Union[None, GeometryLike, Sequence[GeometryLike]] = None,
    titles: Union[None, str, Sequence[str]] = None,
    view: str = "auto",
    point_size: float = 0.0,
    dot_size: float = 0.0,
    captions: bool = True,
    threads: int = 0,
    progress: Progress = None,
    **options: Unpack[RenderOptions],
) -> Picture:
    """Draws geometries side by side, in every colour and under every set of dots, as (height, width, 3) uint8.

    geometries  whatever `as_geometry` takes, or a list of such
    color       field to colour by: an attribute, "rgb", "normal", "x", "y", "z" or "none"; or a list, a panel each;
                for values see `show`
    dots        points to draw on top, such as a sample; or a list of such, a panel each
    titles      captions, one per panel; else what the files and colours are called
    view        "auto", "front", "back", "left", "right", "top", "bottom", "iso", or "x,y,z" of the eye
    point_size  [pixels] diameter of a cloud's points; 0: by their spacing
    dot_size    [pixels] diameter of the dots; 0: by their number
    captions    False: a single panel that fills the picture, without caption and colour bar

    Raises InvalidInput (no geometry, no finite point, no such field: lists those there are).
    """
    inputs = [(_name(g), as_geometry(g)._view()) for g in _several(geometries)]
    marks = [(_name(d), as_geometry(d).positions) for d in ([] if dots is None else _several(dots))]
    style = {
        "colors": _field_names("none" if color is None else color),
        "titles": _texts(() if titles is None else titles, "titles"),
        "view": as_text(view, "view"),
        "point_size": as_real(point_size, "point_size"),
        "dot_size": as_real(dot_size, "dot_size"),
        "captions": bool(captions),
    }
    with as_callable(progress) as report:
        return np.asarray(_core.render(inputs, marks, style, {**options}, threads, report))


def _as_picture(image: ArrayLike) -> Picture:
    array = as_array(image, "image")
    if array.ndim != 3 or array.shape[2] != 3 or array.dtype != np.uint8:
        raise InvalidInput(f"image: {array.dtype} {array.shape}, expected uint8 (height, width, 3)")
    return np.ascontiguousarray(array)


def write_png(path: FileName, image: ArrayLike, *, overwrite: bool = False) -> None:
    """Writes a (height, width, 3) uint8 picture, beside its target, then renames. The same image gives the same bytes.

    Raises WriteError (exists and `overwrite` is off, no space, ...).
    """
    _core.write_png(as_file_name(path), _as_picture(image), bool(overwrite))


def image_grid(
    images: Sequence[ArrayLike],
    *,
    columns: int,
    gap: int = 0,
    background: Tuple[int, int, int] = (255, 255, 255),
) -> Picture:
    """Places pictures row by row in `columns`, each centred in a cell as large as the largest; `gap` [pixels]."""
    pictures = [_as_picture(image) for image in images]
    color = [as_whole(channel, "background") for channel in background]
    if len(color) != 3 or max(color) > 255:
        raise InvalidInput(f"background: {color}, expected red, green, blue up to 255")
    return np.asarray(_core.image_grid(pictures, as_whole(columns, "columns", 1), as_whole(gap, "gap"), color))


@dataclass(frozen=True, repr=False, eq=False)
class View(Result):
    """How one looks at an object."""

    direction: NDArray[np.float64]
    """(3,) unit, from the eye into the scene, input frame."""
    up: NDArray[np.float64]
    """(3,) unit, perpendicular to direction."""
    distance: float
    """[input length unit] of the eye from the box's middle; 0: by the field of view."""


def parse_view(text: str, geometry: GeometryLike) -> View:
    """What `view` of `render` means for a geometry. Raises InvalidInput that lists what is understood."""
    direction, up, distance = _core.parse_view(as_text(text, "view"), as_geometry(geometry)._view())
    return View(direction, up, distance)


@dataclass(frozen=True, repr=False, eq=False)
class FieldColors(Result):
    """A field as colours, and what its colour bar says."""

    colors: NDArray[np.float32]
    """(n, 3) sRGB in [0, 1]; grey where the field is not finite."""
    name: str
    """Empty where a colour bar says nothing: "rgb", "normal"."""
    map: str
    """"sequential", "blue-yellow", "diverging" or "categorical"."""
    min: float
    """Value of the first colour."""
    max: float
    """Value of the last colour."""


def color_by_field(geometry: GeometryLike, field: str) -> FieldColors:
    """Colours by an attribute, or by "rgb", "normal", "x", "y", "z". Raises InvalidInput that lists the fields."""
    return FieldColors(**_core.color_by_field(as_geometry(geometry)._view(), as_text(field, "field")))


def color_by_values(values: ArrayLike, name: str = "") -> FieldColors:
    """Colours of (n,) values. The name decides for some: "shape_index" has the range -1 to 1, labels get one each."""
    return FieldColors(**_core.color_by_values(_numbers(values), as_text(name, "name")))


def map_color(map: str, t: ArrayLike) -> NDArray[np.float32]:
    """(n, 3) sRGB of (n,) numbers in [0, 1]; clamped outside, grey for NaN. `map`: see `FieldColors`."""
    return np.asarray(_core.map_color(as_text(map, "map"), _numbers(t)))


def distinct_color(labels: ArrayLike) -> NDArray[np.float32]:
    """(n, 3) sRGB of (n,) labels: neighbours in number differ clearly; grey for negative ones."""
    return np.asarray(_core.distinct_color(np.ascontiguousarray(_numbers(labels), dtype=np.int64)))


def value_range(values: ArrayLike) -> Tuple[float, float]:
    """The 1st and 99th percentile of the finite values, as far apart as colours need."""
    low, high = _core.value_range(_numbers(values))
    return float(low), float(high)


def to_oklab(colors: ArrayLike) -> NDArray[np.float64]:
    """(n, 3) OKLab (Ottosson 2020) of (n, 3) sRGB in [0, 1]."""
    return np.asarray(_core.to_oklab(as_points(colors, "colors")))


def from_oklab(lab: ArrayLike) -> NDArray[np.float32]:
    """(n, 3) sRGB of (n, 3) OKLab, clipped to what sRGB can show."""
    return np.asarray(_core.from_oklab(as_points(lab, "lab")))


def srgb_to_linear(value: float) -> float:
    """One channel in [0, 1] from sRGB to linear light."""
    return float(_core.srgb_to_linear(as_real(value, "value")))


def linear_to_srgb(value: float) -> float:
    """One channel in [0, 1] from linear light to sRGB."""
    return float(_core.linear_to_srgb(as_real(value, "value")))


def _numbers(values: ArrayLike) -> NDArray[np.float64]:
    array = as_floats(values, "values")
    if array.ndim != 1:
        raise InvalidInput(f"values: shape {array.shape}, expected (n,)")
    return array
