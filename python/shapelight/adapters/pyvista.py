"""PyVista: PolyData, StructuredGrid of one layer, and the points of any other data set."""

from __future__ import annotations

import importlib
from typing import Any, Optional

import numpy as np

from ..geometry import Geometry, as_points
from .columns import Columns, color_bytes, gather, spread

COLOR_NAMES = ("RGB", "RGBA", "rgb", "rgba", "colors", "Colors")


def to_geometry(thing: Any) -> Optional[Geometry]:
    """Polygons and strips become triangles; vertices and lines are left behind."""
    if not hasattr(thing, "points") or not hasattr(thing, "point_data"):
        return None
    faces, of_faces, grid = np.zeros((0, 3), np.uint32), {}, None
    if hasattr(thing, "is_all_triangles") and (thing.n_faces if hasattr(thing, "n_faces") else len(thing.faces)):
        surface = thing if thing.is_all_triangles else thing.triangulate()
        faces = surface.faces.reshape(-1, 4)[:, 1:].astype(np.uint32)
        of_faces = _columns(surface.cell_data) if surface.n_cells == len(faces) else {}
        thing = surface
    elif hasattr(thing, "dimensions") and sorted(thing.dimensions)[0] == 1:
        width, height = [n for n in thing.dimensions if n > 1] or [1, 1]
        grid = np.arange(width * height, dtype=np.uint32).reshape(height, width)
    kind = "float32" if thing.points.dtype == np.float32 else "float64"
    points = as_points(np.asarray(thing.points))
    return Geometry(points, faces, _columns(thing.point_data), of_faces, grid, coordinate_type=kind)


def from_geometry(geometry: Geometry, as_: Any = None) -> Any:
    pyvista: Any = importlib.import_module("pyvista")
    points = geometry.positions.astype(np.float32 if geometry.coordinate_type == "float32" else np.float64)
    if len(geometry.triangles):
        made = pyvista.PolyData.from_regular_faces(points, geometry.triangles.astype(np.int64))
        _store(geometry.triangle_attributes, made.cell_data)
    else:
        made = pyvista.PolyData(points)
    _store(geometry.attributes, made.point_data)
    return made


def _columns(arrays: Any) -> Columns:
    columns: Columns = {}
    for name in arrays.keys():
        array = np.asarray(arrays[name])
        is_color = name in COLOR_NAMES and array.dtype == np.uint8 and array.ndim == 2
        spread("colors" if is_color else "normals" if name == "Normals" else name, array, columns)
    return columns


def _store(columns: Columns, to: Any) -> None:
    for name, array in gather(columns).items():
        if name == "colors":
            to["RGB"] = color_bytes(array)
        else:
            to["Normals" if name == "normals" else name] = array
