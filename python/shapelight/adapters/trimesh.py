"""trimesh: Trimesh and PointCloud."""

from __future__ import annotations

import importlib
from typing import Any, Optional

import numpy as np
from numpy.typing import NDArray

from ..geometry import Geometry
from .columns import Columns, color_bytes, gather, spread


def to_geometry(thing: Any) -> Optional[Geometry]:
    """Vertices are not copied. Normals that trimesh computes are not taken along, as it computes them again."""
    if not hasattr(thing, "vertices"):
        return None
    columns: Columns = {}
    for name, values in getattr(thing, "vertex_attributes", {}).items():
        spread(name, values, columns)
    if not hasattr(thing, "faces"):
        spread("colors", _without_full_alpha(thing.colors), columns)
        return Geometry(np.asarray(thing.vertices), attributes=columns)
    of_faces: Columns = {}
    for name, values in thing.face_attributes.items():
        spread(name, values, of_faces)
    triangles = np.asarray(thing.faces).astype(np.uint32).reshape(-1, 3)
    texcoords = None
    kind = thing.visual.kind
    if kind == "vertex":
        spread("colors", _without_full_alpha(thing.visual.vertex_colors), columns)
    elif kind == "face":
        spread("colors", _without_full_alpha(thing.visual.face_colors), of_faces)
    elif kind == "texture" and thing.visual.uv is not None:
        texcoords = np.asarray(thing.visual.uv, np.float32)[triangles.ravel()]
    return Geometry(np.asarray(thing.vertices), triangles, columns, of_faces, corner_texcoords=texcoords)


def from_geometry(geometry: Geometry, as_: Any = None) -> Any:
    trimesh: Any = importlib.import_module("trimesh")
    arrays = gather(geometry.attributes)
    colors = arrays.pop("colors", None)
    if not len(geometry.triangles):
        return trimesh.PointCloud(geometry.positions, colors=None if colors is None else color_bytes(colors))
    of_faces = gather(geometry.triangle_attributes)
    face_colors = of_faces.pop("colors", None)
    made = trimesh.Trimesh(
        geometry.positions,
        geometry.triangles.astype(np.int64),
        vertex_normals=arrays.pop("normals", None),
        vertex_colors=None if colors is None else color_bytes(colors),
        face_colors=None if face_colors is None or colors is not None else color_bytes(face_colors),
        vertex_attributes=arrays,
        face_attributes=of_faces,
        process=False,
    )
    uv = _per_vertex(geometry)
    if uv is not None:
        material = getattr(getattr(as_, "visual", None), "material", None)
        made.visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    return made


def _without_full_alpha(colors: Any) -> NDArray[Any]:
    array = np.asarray(colors)
    return array[:, :3] if array.ndim == 2 and array.shape[1] == 4 and (array[:, 3] == 255).all() else array


def _per_vertex(geometry: Geometry) -> Optional[NDArray[np.float64]]:
    """Texture coordinates, when the corners that meet at a vertex agree on them."""
    if geometry.corner_texcoords is None:
        return None
    corners = geometry.triangles.ravel()
    uv = np.zeros((len(geometry), 2))
    uv[corners] = geometry.corner_texcoords
    return uv if np.array_equal(uv[corners], geometry.corner_texcoords) else None
