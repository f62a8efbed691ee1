"""E57 by pye57: all scans of a file in the file's frame."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Dict, List

import numpy as np
import pye57
from numpy.typing import NDArray
from pye57 import libe57
from pye57.utils import convert_spherical_to_cartesian

from ..errors import BudgetExceeded, Error, FormatError, ReadError
from ..files import Context
from ..geometry import NO_INDEX, Geometry, concatenate

CHUNK = 200_000  # points between two looks for Ctrl-C
MOST_PIXELS_PER_POINT = 10
CARTESIAN = ("cartesianX", "cartesianY", "cartesianZ")
SPHERICAL = ("sphericalRange", "sphericalAzimuth", "sphericalElevation")
INVALID = ("cartesianInvalidState", "sphericalInvalidState")
OUR_NAMES = {
    "colorRed": "red",
    "colorGreen": "green",
    "colorBlue": "blue",
    "rowIndex": "row",
    "columnIndex": "column",
    "timeStamp": "time_stamp",
    "isColorInvalid": "color_invalid",
    "isIntensityInvalid": "intensity_invalid",
    "isTimeStampInvalid": "time_stamp_invalid",
    "returnIndex": "return_index",
    "returnCount": "return_count",
    "nor:normalX": "nx",
    "nor:normalY": "ny",
    "nor:normalZ": "nz",
}


def read(path: str, context: Context) -> Geometry:
    """Points that were measured, moved by their scan's pose. A single scan keeps its pixels and its viewpoint; of
    several, the attribute `scan` tells the number."""
    place = "header"
    try:
        open(path, "rb").close()  # a missing file is that, whatever pye57 says
        file = pye57.E57(path)
        scans = []
        for index in range(file.scan_count):
            place = f"scan {index}"
            scans.append(_read_scan(file, index, context))
            context.report((index + 1) / file.scan_count)
    except Error:
        raise
    except MemoryError as error:
        raise BudgetExceeded(f"e57: {path}: {place}: more points than there is memory for") from error
    except OSError as error:
        raise ReadError(f"e57: {path}: {error}") from error
    except Exception as error:
        reason = (str(error).strip() or type(error).__name__).splitlines()[0]
        raise FormatError(f"e57: {path}: {place}: {reason}") from error
    if not sum(map(len, scans)):
        raise FormatError(f"e57: {path}: {len(scans)} scans without a measured point, expected at least one")
    if len(scans) == 1:
        return _with_pixels(scans[0])
    for index, scan in enumerate(scans):
        scan.attributes["scan"] = np.full(len(scan), index, np.uint16 if len(scans) <= 0xFFFF else np.uint32)
    merged = concatenate(scans)
    partial = sorted({name for scan in scans for name in scan.attributes} - set(merged.attributes))
    if partial:
        merged.warnings.append(f"left out, as not every scan has them: {', '.join(partial)}")
    return merged


def _read_scan(file: Any, index: int, context: Context) -> Geometry:
    header = file.get_header(index)
    names = list(header.point_fields)
    system = next((s for s in (CARTESIAN, SPHERICAL) if set(s) <= set(names)), None)
    if system is None:
        raise FormatError(f"e57: {file.path}: scan {index}: no coordinates, expected {CARTESIAN} or {SPHERICAL}")
    columns = _read_columns(file, header, names, context)
    valid = np.ones(header.point_count, bool)
    for name in INVALID:
        valid &= columns.pop(name, 0) == 0
    positions = np.column_stack([columns.pop(name) for name in system])[valid]
    if system is SPHERICAL:
        positions = convert_spherical_to_cartesian(positions)
    for name in SPHERICAL + CARTESIAN:
        columns.pop(name, None)  # the same points, once more
    prototype = libe57.StructureNode(header.points.prototype())
    attributes = {}
    for name, column in columns.items():
        is_integer = isinstance(prototype[name], libe57.IntegerNode)
        attributes[OUR_NAMES.get(name, name.replace(":", "_"))] = _narrowed(column[valid], is_integer)
    if header.has_pose():
        positions = positions @ header.rotation_matrix.T + header.translation
        _turn_normals(attributes, header.rotation_matrix)
    viewpoint = np.asarray(header.translation, float) if header.has_pose() else None
    return Geometry(positions, attributes=attributes, viewpoint=viewpoint, format="e57")


def _read_columns(file: Any, header: Any, names: List[str], context: Context) -> Dict[str, NDArray[Any]]:
    """Every field as float64, which holds what E57 writers store."""
    count = header.point_count
    columns = {name: np.empty(count) for name in names}
    part = {name: np.empty(min(CHUNK, max(count, 1))) for name in names}
    buffers = libe57.VectorSourceDestBuffer()
    for name, array in part.items():
        buffers.append(libe57.SourceDestBuffer(file.image_file, name, array, len(array), True, True))
    reader = header.points.reader(buffers)
    filled = 0
    while filled < count and (got := reader.read()):
        context.check()
        for name, array in part.items():
            columns[name][filled : filled + got] = array[:got]
        filled += got
    if filled < count:
        raise FormatError(f"e57: {file.path}: the file ends at point {filled} of a scan, {count} expected")
    return columns


def _narrowed(values: NDArray[np.float64], is_integer: bool) -> NDArray[Any]:
    """The smallest of the usual types that holds every value."""
    for kind in (np.uint8, np.uint16, np.uint32, np.int32) if is_integer else (np.float32,):
        with np.errstate(invalid="ignore", over="ignore"):
            narrow: NDArray[Any] = values.astype(kind)
            if np.array_equal(narrow.astype(np.float64), values, equal_nan=True):
                return narrow
    return values


def _turn_normals(attributes: Dict[str, NDArray[Any]], rotation: NDArray[np.float64]) -> None:
    names = ("nx", "ny", "nz")
    if set(names) <= set(attributes):
        turned = np.column_stack([attributes[name] for name in names]) @ rotation.T
        attributes.update((name, turned[:, axis].astype(np.float32)) for axis, name in enumerate(names))


def _with_pixels(scan: Geometry) -> Geometry:
    """Rows and columns become the grid, when it is not almost empty and no pixel holds two points."""
    row, column = (scan.attributes.get(name) for name in ("row", "column"))
    if row is None or column is None or row.dtype.kind != "u" or column.dtype.kind != "u":
        return scan
    row, column = row.astype(np.int64) - row.min(), column.astype(np.int64) - column.min()
    shape = int(row.max()) + 1, int(column.max()) + 1
    if shape[0] * shape[1] > MOST_PIXELS_PER_POINT * len(scan):
        return scan
    grid = np.full(shape, NO_INDEX, np.uint32)
    grid[row, column] = np.arange(len(scan), dtype=np.uint32)
    if np.count_nonzero(grid != NO_INDEX) < len(scan):
        return scan
    rest = {name: v for name, v in scan.attributes.items() if name not in ("row", "column")}
    return replace(scan, grid=grid, attributes=rest)
