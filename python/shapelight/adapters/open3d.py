"""Open3D: PointCloud and TriangleMesh, legacy and tensor."""

from __future__ import annotations

import importlib
from typing import Any, Dict, Optional

import numpy as np
from numpy.typing import NDArray

from ..geometry import Geometry, as_points
from .columns import Columns, color_bytes, color_shares, gather, spread


def _class_of(thing: Any) -> tuple[str, bool]:
    """Its name, and whether it is the tensor kind."""
    for base in type(thing).__mro__:
        if base.__module__.startswith("open3d") and base.__name__ in ("PointCloud", "TriangleMesh"):
            return base.__name__, ".t." in base.__module__
    return "", False


def to_geometry(thing: Any) -> Optional[Geometry]:
    """Legacy points are copied once: their memory goes away when the object gets other points."""
    name, is_tensor = _class_of(thing)
    if not name:
        return None
    return _from_tensor(thing, name) if is_tensor else _from_legacy(thing, name)


def from_geometry(geometry: Geometry, as_: Any = None, *, tensor: bool = False) -> Any:
    return _tensor(geometry, as_) if tensor or _class_of(as_)[1] else _legacy(geometry)


def _from_legacy(thing: Any, name: str) -> Geometry:
    is_mesh = name == "TriangleMesh"
    columns: Columns = {}
    spread("normals", np.asarray(thing.vertex_normals if is_mesh else thing.normals), columns)
    spread("colors", color_bytes(thing.vertex_colors if is_mesh else thing.colors), columns)
    points = np.array(thing.vertices if is_mesh else thing.points).reshape(-1, 3)
    if not is_mesh:
        return Geometry(points, attributes=columns)
    texcoords = np.asarray(thing.triangle_uvs, dtype=np.float32)
    triangles = np.asarray(thing.triangles).astype(np.uint32)
    return Geometry(points, triangles, columns, corner_texcoords=texcoords if len(texcoords) else None)


def _from_tensor(thing: Any, name: str) -> Geometry:
    is_mesh = name == "TriangleMesh"
    points = {k: v.cpu().numpy() for k, v in (thing.vertex if is_mesh else thing.point).items()}
    faces = {k: v.cpu().numpy() for k, v in thing.triangle.items()} if is_mesh else {}
    positions = points.pop("positions")
    kind = "float32" if positions.dtype == np.float32 else "float64"
    triangles = faces.pop("indices", np.zeros((0, 3))).astype(np.uint32)
    texcoords = faces.pop("texture_uvs", None)
    return Geometry(
        as_points(positions),
        triangles,
        _columns(points),
        _columns(faces),
        corner_texcoords=None if texcoords is None else texcoords.reshape(-1, 2).astype(np.float32),
        coordinate_type=kind,
    )


def _columns(arrays: Dict[str, NDArray[Any]]) -> Columns:
    columns: Columns = {}
    for name, array in arrays.items():
        spread(name, color_bytes(array) if name == "colors" else array, columns)
    return columns


def _legacy(geometry: Geometry) -> Any:
    open3d: Any = importlib.import_module("open3d")
    vectors = open3d.utility.Vector3dVector
    arrays = gather(geometry.attributes)
    is_mesh = len(geometry.triangles) > 0
    made = open3d.geometry.TriangleMesh() if is_mesh else open3d.geometry.PointCloud()
    setattr(made, "vertices" if is_mesh else "points", vectors(geometry.positions))
    if "normals" in arrays:
        setattr(made, "vertex_normals" if is_mesh else "normals", vectors(as_points(arrays["normals"])))
    if "colors" in arrays:
        shares = np.ascontiguousarray(color_shares(arrays["colors"])[:, :3])
        setattr(made, "vertex_colors" if is_mesh else "colors", vectors(shares))
    if is_mesh:
        made.triangles = open3d.utility.Vector3iVector(geometry.triangles.astype(np.int32))
        if geometry.corner_texcoords is not None:
            made.triangle_uvs = open3d.utility.Vector2dVector(geometry.corner_texcoords.astype(np.float64))
    return made


def _tensor(geometry: Geometry, as_: Any) -> Any:
    open3d: Any = importlib.import_module("open3d")
    def tensor(array: NDArray[Any]) -> Any:
        array = np.ascontiguousarray(array if array.ndim > 1 else array[:, None])
        return open3d.core.Tensor.from_numpy(array.copy() if not array.flags.writeable else array)

    is_mesh = len(geometry.triangles) > 0
    made = open3d.t.geometry.TriangleMesh() if is_mesh else open3d.t.geometry.PointCloud()
    points, faces = (made.vertex, made.triangle) if is_mesh else (made.point, {})
    kind = np.float32 if geometry.coordinate_type == "float32" else np.float64
    points["positions"] = tensor(geometry.positions.astype(kind))
    for name, array in gather(geometry.attributes).items():
        if name == "colors" and (array.dtype != np.uint8 or _has_float_colors(as_)):
            array = color_shares(array).astype(np.float32)
        points[name] = tensor(array)
    if is_mesh:
        faces["indices"] = tensor(geometry.triangles.astype(np.int64))
        for name, array in gather(geometry.triangle_attributes).items():
            faces[name] = tensor(array)
        if geometry.corner_texcoords is not None:
            faces["texture_uvs"] = tensor(geometry.corner_texcoords.reshape(-1, 3, 2))
    return made.to(as_.device) if _class_of(as_)[1] else made


def _has_float_colors(thing: Any) -> bool:
    name, is_tensor = _class_of(thing)
    if not is_tensor:
        return False
    arrays = dict((thing.vertex if name == "TriangleMesh" else thing.point).items())
    return "colors" in arrays and "Float" in str(arrays["colors"].dtype)
