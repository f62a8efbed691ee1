"""Takes geometries in the types people have, and gives results back in them."""

from __future__ import annotations

import os
from typing import Any, Optional, Union

import numpy as np
from numpy.typing import ArrayLike

from .errors import InvalidInput
from .files import read
from .geometry import NO_INDEX, Geometry, as_indices, as_points

GeometryLike = Union[Geometry, ArrayLike, "os.PathLike[str]", Any]
"""A Geometry; (n, 3) points; (vertices, faces); (height, width, 3) points of an organised scan; a path."""


def as_geometry(source: GeometryLike, faces: Optional[ArrayLike] = None) -> Geometry:
    """Whatever carries points, as a Geometry. C-contiguous float64 points are not copied.

    Raises InvalidInput that says what is understood.
    """
    if isinstance(source, Geometry):
        return source
    if isinstance(source, (str, os.PathLike)):
        return read(source)
    if isinstance(source, tuple) and len(source) == 2 and faces is None:
        source, faces = source
    array = np.asarray(source)
    if array.ndim == 3 and faces is None:
        return _organised(array)
    triangles = np.zeros((0, 3), np.uint32) if faces is None else as_indices(faces, "faces", (-1, 3))
    return Geometry(as_points(array), triangles)


def like(source: GeometryLike, geometry: Geometry) -> Any:
    """A geometry as the type that came in: an array for an array, else a Geometry."""
    if isinstance(source, (Geometry, str, os.PathLike)):
        return geometry
    return geometry.positions


def _organised(array: Any) -> Geometry:
    if array.shape[2] != 3:
        raise InvalidInput(f"points: shape {array.shape}, expected (n, 3) or (height, width, 3)")
    points = as_points(array.reshape(-1, 3))
    pixels = np.arange(len(points), dtype=np.uint32)
    pixels[~np.isfinite(points).all(axis=1)] = NO_INDEX
    return Geometry(points, grid=pixels.reshape(array.shape[:2]))
