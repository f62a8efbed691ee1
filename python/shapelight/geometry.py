"""Points, and whatever of triangles, pixels and attributes the input has."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Dict, Iterable, List, Mapping, Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .arguments import as_array, as_floats, as_text
from .errors import InvalidInput

NO_INDEX = 0xFFFFFFFF  # marks "no point" in a grid


@dataclass
class LasInfo:
    """What a LAS file says beside its points; kept so that writing it back loses nothing."""

    scale: tuple[float, float, float]
    offset: tuple[float, float, float]
    point_format: int
    header: bytes = field(repr=False)
    vlrs: bytes = field(repr=False)


def as_points(points: ArrayLike, name: str = "points") -> NDArray[np.float64]:
    """(n, 3) float64, C-contiguous: the array itself when it is that already, else a copy.

    Raises InvalidInput for another shape and for what is no array of numbers.
    """
    array = as_floats(points, name)
    if array.ndim != 2 or array.shape[1] != 3:
        hint = "; transpose it" if array.ndim == 2 and array.shape[0] == 3 else ""
        raise InvalidInput(f"{name}: shape {array.shape}, expected (n, 3){hint}")
    return array


def as_vector(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """(3,) float64. Raises InvalidInput."""
    array = as_floats(values, name)
    if array.shape != (3,):
        raise InvalidInput(f"{name}: shape {array.shape}, expected (3,)")
    return array


def as_indices(values: ArrayLike, name: str, shape: tuple[int, ...]) -> NDArray[np.uint32]:
    """uint32, C-contiguous, of a shape in which -1 stands for any length. Raises InvalidInput, also for negatives."""
    array = as_array(values, name)
    if array.size == 0:
        array = np.zeros([max(n, 0) for n in shape], dtype=np.uint32)
    if array.dtype.kind not in "iu":
        raise InvalidInput(f"{name}: {array.dtype}, expected whole numbers")
    if array.ndim != len(shape) or any(w not in (-1, n) for w, n in zip(shape, array.shape)):
        wanted = ", ".join("n" if n < 0 else str(n) for n in shape)
        raise InvalidInput(f"{name}: shape {array.shape}, expected ({wanted}{',' if len(shape) == 1 else ''})")
    if array.dtype != np.uint32 and array.size and (array.min() < 0 or array.max() > NO_INDEX):
        raise InvalidInput(f"{name}: {array.min()} to {array.max()}, expected 0 to {NO_INDEX}")
    return np.ascontiguousarray(array, dtype=np.uint32)


def _columns(given: Mapping[str, ArrayLike], name: str, count: int) -> Dict[str, NDArray[Any]]:
    if not isinstance(given, Mapping):
        raise InvalidInput(f"{name}: {type(given).__name__}, expected {{name: ({count},) numbers}}")
    return {as_text(key, f"{name}: name of one"): _column(values, key, count) for key, values in given.items()}


def _column(values: ArrayLike, name: str, count: int) -> NDArray[Any]:
    """Of a type that the library has: of bool, float16 and long double the nearest, in the machine's byte order."""
    array = as_array(values, f"attribute {name}")
    if array.shape != (count,):
        several = "; one attribute per component" if array.ndim == 2 and len(array) == count else ""
        raise InvalidInput(f"attribute {name}: shape {array.shape}, expected ({count},){several}")
    if array.dtype.kind not in "biuf":
        raise InvalidInput(f"attribute {name}: {array.dtype}, expected numbers")
    nearest = {"?": np.uint8, "e": np.float32, np.dtype(np.longdouble).char: np.float64}
    return np.ascontiguousarray(array, dtype=nearest.get(array.dtype.char, array.dtype.newbyteorder("=")))


def _texcoords(values: ArrayLike, triangles: int) -> NDArray[np.float32]:
    array = as_floats(values, "corner_texcoords")
    if array.shape != (3 * triangles, 2):
        raise InvalidInput(f"corner_texcoords: shape {array.shape}, expected {(3 * triangles, 2)}, three per triangle")
    return array.astype(np.float32)


@dataclass(repr=False, eq=False)
class Geometry:
    """A mesh, a range image or a point cloud: what `read` returns, `write` takes, and every job accepts.

    positions            (n, 3) float64 [input length unit], exact; not finite where nothing was measured
    triangles            (m, 3) uint32, counter-clockwise seen from outside; empty unless a mesh
    attributes           {name: (n,)} per point. Names follow PLY: nx ny nz, red green blue, intensity, ...
    triangle_attributes  {name: (m,)} per triangle
    grid                 (height, width) uint32: the point of each pixel, NO_INDEX where nothing was seen; or None
    viewpoint            (3,) float64: the sensor, when known; or None
    corner_texcoords     (3 m, 2) float32 per triangle corner, or None
    coordinate_type      what the coordinates had in the file: "float32" or "float64"
    """

    positions: NDArray[np.float64]
    triangles: NDArray[np.uint32] = field(default_factory=lambda: np.zeros((0, 3), np.uint32))
    attributes: Dict[str, NDArray[Any]] = field(default_factory=dict)
    triangle_attributes: Dict[str, NDArray[Any]] = field(default_factory=dict)
    grid: Optional[NDArray[np.uint32]] = None
    viewpoint: Optional[NDArray[np.float64]] = None
    corner_texcoords: Optional[NDArray[np.float32]] = None
    coordinate_type: str = "float64"
    comments: List[str] = field(default_factory=list)
    warnings: List[str] = field(default_factory=list)
    format: str = ""
    las: Optional[LasInfo] = None

    def __post_init__(self) -> None:
        self.positions = as_points(self.positions, "positions")
        self.triangles = as_indices(self.triangles, "triangles", (-1, 3))
        if self.grid is not None:
            self.grid = as_indices(self.grid, "grid", (-1, -1))
        if self.viewpoint is not None:
            self.viewpoint = as_vector(self.viewpoint, "viewpoint")
        self._check()

    def _check(self) -> None:
        """Of what may have been changed since: that it is what the library takes."""
        n, m = len(self.positions), len(self.triangles)
        self.attributes = _columns(self.attributes, "attributes", n)
        self.triangle_attributes = _columns(self.triangle_attributes, "triangle_attributes", m)
        if self.corner_texcoords is not None:
            self.corner_texcoords = _texcoords(self.corner_texcoords, m)
        if self.coordinate_type not in ("float32", "float64"):
            raise InvalidInput(f"coordinate_type: {self.coordinate_type!r}, expected 'float32' or 'float64'")
        if isinstance(self.comments, str):
            raise InvalidInput("comments: text, expected a list of lines")
        if not isinstance(self.las, (LasInfo, type(None))):
            raise InvalidInput(f"las: {type(self.las).__name__}, expected a LasInfo or None")

    @property
    def kind(self) -> str:
        """"mesh", "range_image" or "cloud"."""
        if len(self.triangles):
            return "mesh"
        return "cloud" if self.grid is None else "range_image"

    @property
    def diagonal(self) -> float:
        """[input length unit] of the bounding box of the finite points."""
        return float(self._view(attributes=False).diagonal)

    @property
    def bounding_box(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Lowest and highest corner, (3,) each [input length unit], of the finite points."""
        low, high = self._view(attributes=False).bounding_box
        return low, high

    def __len__(self) -> int:
        return len(self.positions)

    def __repr__(self) -> str:
        faces = f", {len(self.triangles)} triangles" if len(self.triangles) else ""
        pixels = "" if self.grid is None else f", {self.grid.shape[1]} x {self.grid.shape[0]} pixels"
        names = f", attributes {', '.join(self.attributes)}" if self.attributes else ""
        return f"Geometry({self.kind}: {len(self)} points{faces}{pixels}{names})"

    def _repr_html_(self) -> Optional[str]:
        from .scene import html_of

        return html_of(self)

    def select(self, indices: ArrayLike) -> Geometry:
        """The points at `indices` in that order, or those where a mask (n,) is True, with their attributes; triangles
        and pixels are left behind."""
        array = as_array(indices, "indices")
        if array.dtype == np.bool_ and array.shape == (len(self),):
            array = np.flatnonzero(array)
        return Geometry(**self._view().select_points(as_indices(array, "indices", (-1,))))

    def transformed(self, T_new_old: ArrayLike) -> Geometry:
        """A moved copy: p_new = R p_old + t, with normals and viewpoint. `T_new_old` is rigid, (4, 4)."""
        return Geometry(**self._view().transformed(as_transform(T_new_old)))

    def _view(self, *, attributes: bool = True) -> _core.GeometryView:
        """What the library reads: positions and triangles in place, the rest copied; `attributes` where needed."""
        triangles = self.triangles if len(self.triangles) else None
        viewpoint = None if self.viewpoint is None else [float(x) for x in self.viewpoint]
        if not attributes:
            return _core.GeometryView(self.positions, triangles, self.grid, viewpoint)
        self._check()
        rest: Dict[str, Any] = {
            "attributes": self.attributes,
            "triangle_attributes": self.triangle_attributes,
            "coordinate_type": self.coordinate_type,
            "comments": [as_text(line, "comments: one of them") for line in self.comments],
            "format": self.format,
            "las": self.las,
        }
        if self.corner_texcoords is not None:
            rest["corner_texcoords"] = self.corner_texcoords
        return _core.GeometryView(self.positions, triangles, self.grid, viewpoint, rest)


def concatenate(parts: Iterable[Geometry]) -> Geometry:
    """The points of several geometries as one cloud, with the attributes that all of them have.

    Pixels and triangles are left behind; what belongs to a file is the first one's. Raises InvalidInput when there is
    none.
    """
    found = list(parts)
    for part in found:
        if not isinstance(part, Geometry):
            raise InvalidInput(f"concatenate: {type(part).__name__}, expected geometries; as_geometry makes them")
    if not found:
        raise InvalidInput("concatenate: no geometry, expected at least one")
    names = [name for name in found[0].attributes if all(name in g.attributes for g in found)]
    first = found[0]
    return Geometry(
        np.concatenate([g.positions for g in found]),
        attributes={name: np.concatenate([g.attributes[name] for g in found]) for name in names},
        coordinate_type="float32" if all(g.coordinate_type == "float32" for g in found) else "float64",
        comments=first.comments,
        warnings=list(dict.fromkeys(text for g in found for text in g.warnings)),
        format=first.format,
        las=first.las,
    )


def as_transform(transform: ArrayLike, name: str = "transform") -> NDArray[np.float64]:
    """(4, 4) float64, C-contiguous. Raises InvalidInput for another shape."""
    array = as_floats(transform, name)
    if array.shape != (4, 4):
        raise InvalidInput(f"{name}: shape {array.shape}, expected (4, 4)")
    return array
