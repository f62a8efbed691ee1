"""Counts, shares, lengths and sizes as people write them: the same grammar as on the command line."""

from __future__ import annotations

from typing import Any, Dict, Optional, Sequence, Union

from .. import _core
from ..arguments import as_real, as_whole
from ..describe import option_table
from ..errors import BudgetExceeded
from ..geometry import Geometry

Count = Union[int, str]
"""[points] 1200, "50k" or "2M"."""
Share = Union[float, str]
"""[1] 0.1 or "10%"."""
Length = Union[float, str]
"""In input units, or a share of the bounding box's diagonal: "0.5%"."""
Bytes = Union[int, str]
"""[bytes] 2000000000, "512M" or "2G"."""


def as_count(name: str, value: Optional[Count]) -> Optional[int]:
    if isinstance(value, str):
        return int(_core.parse_count(name, value))
    return None if value is None else as_whole(value, name, 1)


def as_share(name: str, value: Optional[Share]) -> Optional[float]:
    if isinstance(value, str):
        return float(_core.parse_ratio(name, value))
    return None if value is None else as_real(value, name)


def as_length(name: str, value: Optional[Length], geometry: Geometry) -> Optional[float]:
    if isinstance(value, str):
        return float(_core.parse_length(name, value, geometry.diagonal))
    return None if value is None else as_real(value, name)


def as_numbers(function: str, options: Dict[str, Any], geometry: Geometry) -> Dict[str, Any]:
    """A function's options with shares and lengths as numbers."""
    resolved = dict(options)
    for row in option_table(function):
        name = row["name"]
        if row["type"] != "float" or not isinstance(options.get(name), str):
            continue
        if row["unit"] == "input length unit":
            resolved[name] = as_length(name, options[name], geometry)
        elif row["unit"] == "1":
            resolved[name] = as_share(name, options[name])
    return resolved


def check_memory(function: str, inputs: Sequence[Geometry], max_memory: Optional[Bytes]) -> None:
    """Raises BudgetExceeded when the job's estimate is larger than what is allowed."""
    if max_memory is None:
        return
    name = "max_memory"
    limit = _core.parse_bytes(name, max_memory) if isinstance(max_memory, str) else as_whole(max_memory, name)
    needed = sum(len(geometry) for geometry in inputs) * _core.bytes_per_point[function]
    if needed > limit:
        raise BudgetExceeded(f"the job needs about {needed >> 20} MiB, more than max_memory {max_memory} allows")
