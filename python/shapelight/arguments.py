"""Arguments on their way into the library. What it cannot take is refused here, in words."""

from __future__ import annotations

import operator
import os
import reprlib
from typing import Any, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .errors import InvalidInput

Path = Union[str, bytes, "os.PathLike[str]", "os.PathLike[bytes]"]


def as_array(values: Any, name: str) -> NDArray[Any]:
    """Whatever numpy takes, and tensors that it does not take as they are (gradients, other devices); masked floats
    become NaN. Raises InvalidInput for rows of different lengths."""
    for method in ("detach", "cpu", "numpy"):
        if hasattr(values, method):
            values = getattr(values, method)()
    if np.ma.isMaskedArray(values) and values.dtype.kind == "f":
        values = values.filled(np.nan)
    try:
        return np.asarray(values)
    except ValueError as error:
        raise InvalidInput(f"{name}: no array of one shape: {error}") from None


def as_floats(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """float64, C-contiguous: the array itself when it is that already. Raises InvalidInput for what are no real
    numbers."""
    array = as_array(values, name)
    if array.dtype.kind not in "biufO" or array.ndim == 0 and array.dtype == object:
        what = array.dtype if array.ndim else type(values).__name__
        raise InvalidInput(f"{name}: {what}, expected an array of numbers")
    try:
        return np.asarray(array, dtype=np.float64, order="C")
    except (TypeError, ValueError) as error:
        raise InvalidInput(f"{name}: expected an array of numbers: {error}") from None


def as_whole(value: Any, name: str, least: int = 0) -> int:
    """A whole number, also as a float or in an array of no dimension. Raises InvalidInput."""
    if isinstance(value, (float, np.floating)) and float(value).is_integer():
        value = int(value)
    try:
        number = operator.index(value)
    except TypeError:
        raise InvalidInput(f"{name}: {reprlib.repr(value)}, expected a whole number") from None
    if not least <= number < 2**63:
        raise InvalidInput(f"{name}: {number}, expected {f'at least {least}' if number < least else 'below 2^63'}")
    return number


def as_real(value: Any, name: str) -> float:
    """A number, also in an array of no dimension. Raises InvalidInput."""
    try:
        if isinstance(value, (str, bytes)) or np.iscomplexobj(value) or np.ndim(value) != 0:
            raise TypeError
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise InvalidInput(f"{name}: {reprlib.repr(value)}, expected a number") from None


def as_text(value: Any, name: str) -> str:
    if not isinstance(value, str):
        raise InvalidInput(f"{name}: {reprlib.repr(value)}, expected text")
    return str(value)


def as_file_name(path: Path) -> str:
    """Raises TypeError for what is no path, InvalidInput for a name that no file can have."""
    name = os.fsdecode(path)
    if "\0" in name:
        raise InvalidInput(f"{name!r}: a zero byte in the name of a file")
    try:
        name.encode()
    except UnicodeEncodeError:
        raise InvalidInput(f"{name!r}: expected a name in UTF-8") from None
    return name
