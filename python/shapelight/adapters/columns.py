"""Arrays of several components, such as normals (n, 3), against columns with the names of PLY."""

from __future__ import annotations

from typing import Any, Dict

import numpy as np
from numpy.typing import ArrayLike, NDArray

Columns = Dict[str, NDArray[Any]]
VECTORS = {"normals": ("nx", "ny", "nz"), "colors": ("red", "green", "blue", "alpha")}


def spread(name: str, values: ArrayLike, into: Columns) -> None:
    """(n,) or (n, 1) becomes `name`; normals and colors their columns of PLY; others name_0, name_1, ..."""
    array = np.asarray(values)
    if array.dtype.kind not in "biuf" or array.ndim == 0 or not len(array):
        return
    array = array.reshape(len(array), -1)
    width = array.shape[1]
    names = VECTORS.get(name, ())
    if name == "normals" and width != 3 or name == "colors" and width not in (3, 4):
        names = ()
    for k, column in enumerate(array.T):
        into[names[k] if names else name if width == 1 else f"{name}_{k}"] = np.ascontiguousarray(column)


def gather(columns: Columns) -> Columns:
    """What spread() took apart: (n, 3) normals, (n, 3 or 4) colors, (n, k) name_0 to name_(k - 1), else (n,)."""
    left = dict(columns)
    joined: Columns = {}
    for name, parts in VECTORS.items():
        if all(part in left for part in parts[:3]):
            joined[name] = np.column_stack([left.pop(part) for part in parts if part in left])
    for first in [name for name in left if name.endswith("_0")]:
        stem, width = first[:-2], 0
        while f"{stem}_{width}" in left and left[f"{stem}_{width}"].dtype == left[first].dtype:
            width += 1
        if width > 1:
            joined[stem] = np.column_stack([left.pop(f"{stem}_{k}") for k in range(width)])
    return {**left, **joined}


def color_bytes(colors: ArrayLike) -> NDArray[np.uint8]:
    """0 to 255 from shares of 1, from 16 bits, or from bytes."""
    array = np.asarray(colors)
    if array.dtype == np.uint8:
        return array
    return np.rint(color_shares(array) * 255.0).astype(np.uint8)


def color_shares(colors: ArrayLike) -> NDArray[np.float64]:
    """0 to 1. Whole numbers up to 255 are bytes, others 16 bits."""
    array = np.asarray(colors)
    if array.dtype.kind == "f":
        return np.clip(np.nan_to_num(array.astype(np.float64)), 0.0, 1.0)
    full = 255.0 if array.dtype == np.uint8 or not array.size or array.max() <= 255 else 65535.0
    return np.clip(array / full, 0.0, 1.0)
