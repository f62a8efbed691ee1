"""Per-vertex values on their way into the library, which checks their number."""

from __future__ import annotations

from typing import Optional

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arguments import as_array, as_floats, as_whole
from ..errors import InvalidInput
from ..geometry import as_indices


def as_field(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """(n,) float64, C-contiguous: the array itself when it is that already. Raises InvalidInput."""
    array = as_array(values, name)
    if array.ndim != 1 or array.dtype.kind not in "fiub":
        raise InvalidInput(f"{name}: shape {array.shape} of {array.dtype}, expected (n,) numbers")
    return as_floats(array, name)


def as_optional_field(values: Optional[ArrayLike], name: str) -> Optional[NDArray[np.float64]]:
    return None if values is None else as_field(values, name)


def as_labels(values: ArrayLike, name: str) -> NDArray[np.uint32]:
    """(n,) uint32. Raises InvalidInput, also for negatives."""
    return as_indices(values, name, (-1,))


def as_count(value: int, name: str, least: int = 1) -> int:
    return as_whole(value, name, least)
