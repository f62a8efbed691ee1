"""Fewer points for the eye: what is sent to a browser."""

from __future__ import annotations

from dataclasses import replace
from typing import Tuple

import numpy as np
from numpy.typing import NDArray

from .errors import InvalidInput
from .geometry import Geometry


def thin(geometry: Geometry, most: int) -> Geometry:
    """Its finite points, or where these are more than `most`, the first one in each cell of a grid, which then stands
    for all points of its cell in triangles. A grid of pixels stays only where no point goes.

    Raises InvalidInput when no point is finite.
    """
    finite = np.flatnonzero(np.isfinite(geometry.positions).all(axis=1))
    if not len(finite):
        raise InvalidInput("no finite point")
    if len(finite) == len(geometry) <= most:
        return geometry
    kept, cell_of = _first_in_cells(geometry.positions[finite], most)
    place = np.full(len(geometry), -1, dtype=np.int64)
    place[finite] = cell_of
    fewer = geometry.select(finite[kept])
    return replace(fewer, triangles=_renumbered(geometry.triangles, place))


def _first_in_cells(positions: NDArray[np.float64], most: int) -> Tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Indices of the points kept, and the place among them of the point that stands for each point."""
    everyone = np.arange(len(positions))
    if len(positions) <= most:
        return everyone, everyone
    low = positions.min(axis=0)
    size = float((positions.max(axis=0) - low).max()) / np.sqrt(most)
    while True:
        x, y, z = np.floor((positions - low) / size).astype(np.int64).T
        _, kept, cell_of = np.unique((x << 42) | (y << 21) | z, return_index=True, return_inverse=True)
        if len(kept) <= most:
            return kept, cell_of.reshape(-1)
        size *= 1.05 * np.sqrt(len(kept) / most)  # as many cells as a surface has


def _renumbered(triangles: NDArray[np.uint32], place: NDArray[np.int64]) -> NDArray[np.uint32]:
    """Without those that lost a corner or their area."""
    corners = place[triangles]
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    whole = (corners >= 0).all(axis=1) & (a != b) & (b != c) & (c != a)
    return np.asarray(corners[whole], dtype=np.uint32)
