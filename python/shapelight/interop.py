"""Takes geometries in the types people have, and gives results back in them."""

from __future__ import annotations

import importlib
import importlib.util
import os
from typing import Any, Iterable, Optional, Tuple, TypeGuard, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .adapters import adapter_of
from .arguments import as_array
from .errors import InvalidInput
from .files import read
from .geometry import NO_INDEX, Geometry, as_indices, as_points

GeometryLike = Union[Geometry, ArrayLike, "os.PathLike[str]", Any]
"""A Geometry; (n, 3) points; (height, width, 3) points of an organised scan; (vertices, faces); a path; a point cloud
or mesh of Open3D, trimesh, PyVista or laspy."""


def as_geometry(source: GeometryLike, faces: Optional[ArrayLike] = None) -> Geometry:
    """Whatever carries points, as a Geometry, with the attributes it has. C-contiguous float64 points are not copied.

    source  (n, 3) points, also of torch, pandas or whatever numpy takes; (height, width, 3) points of an organised
            scan; a pair (vertices, faces); a path; a PointCloud or TriangleMesh of Open3D, legacy or tensor; a Trimesh
            or PointCloud of trimesh; a data set of PyVista; a laspy.LasData; a Geometry
    faces   (m, 3) vertex indices, for points alone

    Raises InvalidInput that says what is understood.
    """
    if faces is None and _is_pair(source):
        source, faces = source
    found = _own_kind(source)
    if found is not None:
        if faces is not None:
            raise InvalidInput(f"faces: only points take them, and {type(source).__name__} is more than points")
        return found
    array = _points(source)
    if array.ndim == 3 and faces is None:
        return _organised(array)
    triangles = np.zeros((0, 3), np.uint32) if faces is None else as_indices(faces, "faces", (-1, 3))
    return Geometry(as_points(array), triangles, coordinate_type=_coordinate_type(array))


def like(source: GeometryLike, geometry: Geometry) -> Any:
    """A geometry as the type that came in, with the attributes that this type has room for: an array, of the same
    precision, for an array; (vertices, faces) for such a pair; a Geometry for one, and for a path."""
    if isinstance(source, (Geometry, str, os.PathLike)):
        return geometry
    adapter = adapter_of(source)
    if adapter is not None and adapter.to_geometry(source) is not None:
        return adapter.from_geometry(geometry, source)
    if _is_pair(source):
        return like(source[0], geometry), geometry.triangles
    return geometry.positions.astype(_coordinate_type(as_array(source, "points")), copy=False)


def like_with(source: GeometryLike, geometry: Geometry, names: Iterable[str]) -> Any:
    """like(), or the geometry itself when that type has no room for these attributes."""
    converted = like(source, geometry)
    return converted if set(names) <= set(as_geometry(converted).attributes) else geometry


def to_open3d(geometry: GeometryLike, *, tensor: bool = False) -> Any:
    """An open3d.geometry.PointCloud or TriangleMesh, with normals and colors; tensor=True: one of open3d.t.geometry,
    which has room for every attribute. Raises ImportError when Open3D is missing."""
    return _made_by("open3d", geometry, tensor=tensor)


def to_trimesh(geometry: GeometryLike) -> Any:
    """A trimesh.Trimesh with all attributes, or a trimesh.PointCloud with colors. Raises ImportError when trimesh is
    missing."""
    return _made_by("trimesh", geometry)


def to_pyvista(geometry: GeometryLike) -> Any:
    """A pyvista.PolyData with all attributes: colors as "RGB", normals as "Normals". Raises ImportError when PyVista is
    missing."""
    return _made_by("pyvista", geometry)


def to_laspy(geometry: GeometryLike) -> Any:
    """A laspy.LasData, laid out as `write` lays out LAS files. Raises ImportError when laspy is missing."""
    return _made_by("laspy", geometry)


def _is_pair(source: Any) -> TypeGuard[Tuple[Any, Any]]:
    """(vertices, faces)."""
    return isinstance(source, tuple) and len(source) == 2 and as_array(source[0], "vertices").ndim == 2


def _points(source: Any) -> NDArray[Any]:
    if isinstance(source, list) and len(source) == 2 and all(np.ndim(part) == 2 for part in source):
        raise InvalidInput("points: a list of two arrays, expected a tuple (vertices, faces)")
    array = as_array(source, "points")
    if array.ndim == 0:
        raise InvalidInput(
            f"points: {type(source).__name__}, expected (n, 3) or (height, width, 3) numbers, (vertices, faces), a "
            "path, a Geometry, or a point cloud or mesh of Open3D, trimesh, PyVista or laspy"
        )
    return array


def _own_kind(source: Any) -> Optional[Geometry]:
    """What is more than an array."""
    if isinstance(source, Geometry):
        return source
    if isinstance(source, (str, os.PathLike)):
        return read(source)
    adapter = adapter_of(source)
    return None if adapter is None else adapter.to_geometry(source)


def _made_by(library: str, geometry: GeometryLike, **options: bool) -> Any:
    _need(library)
    made = as_geometry(geometry)
    return importlib.import_module(f".adapters.{library}", __package__).from_geometry(made, **options)


def _need(library: str) -> None:
    if importlib.util.find_spec(library) is None:
        extra = "'shapelight[las]'" if library == "laspy" else library
        raise ImportError(f"to_{library}: {library} is not installed: pip install {extra}")


def _coordinate_type(array: NDArray[Any]) -> str:
    return "float32" if array.dtype.kind == "f" and array.dtype.itemsize <= 4 else "float64"


def _organised(array: NDArray[Any]) -> Geometry:
    if array.shape[2] != 3:
        raise InvalidInput(f"points: shape {array.shape}, expected (n, 3) or (height, width, 3)")
    points = as_points(array.reshape(-1, 3))
    pixels = np.arange(len(points), dtype=np.uint32)
    pixels[~np.isfinite(points).all(axis=1)] = NO_INDEX
    return Geometry(points, grid=pixels.reshape(array.shape[:2]), coordinate_type=_coordinate_type(array))
