"""Geometries of other libraries, by the library that their class comes from. Each module has

    to_geometry(thing)            the Geometry, or None when it is no geometry
    from_geometry(geometry, as_)  the library's own; `as_` is the thing that came in, or None

and imports its library only when it is called for.
"""

from __future__ import annotations

import importlib
from typing import Any, Optional

LIBRARIES = ("open3d", "trimesh", "pyvista", "laspy")


def adapter_of(thing: Any) -> Optional[Any]:
    """The module for the library that the class of `thing` comes from, if any."""
    for base in type(thing).__mro__:
        library = base.__module__.partition(".")[0]
        if library in LIBRARIES:
            return importlib.import_module(f".{library}", __name__)
    return None
