"""Readers and writers that stand on other libraries: the extras of the package."""

from __future__ import annotations

import importlib
from importlib.util import find_spec
from typing import List

from ..files import Context, Reader, Writer, register_format
from ..geometry import Geometry


def _reader(module: str) -> Reader:
    """Imports the module, and with it the other library, at the first call."""

    def read(path: str, context: Context) -> Geometry:
        geometry: Geometry = importlib.import_module(f".{module}", __name__).read(path, context)
        return geometry

    return read


def _writer(module: str) -> Writer:
    def write(path: str, geometry: Geometry, context: Context) -> List[str]:
        return list(importlib.import_module(f".{module}", __name__).write(path, geometry, context))

    return write


def register_extras() -> None:
    """Makes known what is installed. The library names the missing extra for a format that is not."""
    if find_spec("laspy") and find_spec("lazrs"):
        about = "compressed LAS, and COPC (.copc.laz), by laspy and lazrs"
        register_format("laz", [".laz"], about, read=_reader("las"), write=_writer("las"))
    if find_spec("pye57"):
        register_format("e57", [".e57"], "ASTM E57 scans, by pye57", read=_reader("e57"))
