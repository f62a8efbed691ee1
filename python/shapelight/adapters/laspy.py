"""laspy: LasData."""

from __future__ import annotations

from typing import Any, Optional

from ..geometry import Geometry


def to_geometry(thing: Any) -> Optional[Geometry]:
    if not hasattr(thing, "points") or not hasattr(thing, "header"):
        return None
    from ..extras import las

    return las.from_laspy(thing)


def from_geometry(geometry: Geometry, as_: Any = None) -> Any:
    from ..extras import las

    return las.to_laspy(geometry)
