"""LAZ and COPC by laspy and lazrs: attributes, coordinates and records as the library's own LAS reader gives them."""

from __future__ import annotations

import io
import logging
import os
import struct
import tempfile
from dataclasses import replace
from typing import Any, BinaryIO, Dict, Iterator, List, Optional, Tuple

import laspy
import lazrs
import numpy as np
from numpy.typing import NDArray

from .. import files
from ..errors import BudgetExceeded, Error, FormatError, ReadError, WriteError
from ..geometry import NO_INDEX, Geometry
from .las_bytes import HEADER_SIZE, POINT_FORMAT, check_table, las_info, read_head

logging.getLogger("laspy").addHandler(logging.NullHandler())  # it logs, and then raises, the same

CHUNK = 100_000  # points between two looks for Ctrl-C
OUR_NAMES = {
    "key_point": "keypoint",
    "scan_angle_rank": "scan_angle",
    "wavepacket_index": "wave_packet_index",
    "wavepacket_offset": "wave_packet_offset",
    "wavepacket_size": "wave_packet_size",
    "return_point_wave_location": "return_point_location",
    "x_t": "wave_dx",
    "y_t": "wave_dy",
    "z_t": "wave_dz",
}


def read(path: str, context: files.Context) -> Geometry:
    """The whole file; memory is the result and one chunk."""
    whole: Optional[Geometry] = None
    filled = 0
    for chunk, count in chunks(path, CHUNK):
        context.check()
        if whole is None:
            columns = {name: np.empty(count, column.dtype) for name, column in chunk.attributes.items()}
            whole = replace(chunk, positions=np.empty((count, 3)), attributes=columns)
        rows = slice(filled, filled + len(chunk))
        whole.positions[rows] = chunk.positions
        for name, column in chunk.attributes.items():
            whole.attributes[name][rows] = column
        filled += len(chunk)
        context.report(filled / count)
    assert whole is not None  # chunks() refuses a file without points
    return whole


def write(path: str, geometry: Geometry, context: files.Context) -> List[str]:
    """Lays the points out as LAS with the library's own writer, then compresses them chunk by chunk."""
    with tempfile.TemporaryDirectory(dir=os.path.dirname(path) or ".") as folder:
        plain = os.path.join(folder, "plain.las")
        left_out = files.write(plain, geometry)
        try:
            with open(plain, "rb") as source, open(path, "wb") as target:
                _compress(source, target, context)
        except Error:
            raise
        except Exception as error:
            raise WriteError(f"laz: {path}: {error}") from error
    return left_out


def _compress(source: BinaryIO, target: BinaryIO, context: files.Context) -> None:
    size, start, number = struct.unpack_from("<HII", source.read(POINT_FORMAT), HEADER_SIZE)
    source.seek(0)
    head = bytearray(source.read(start))
    stride = struct.unpack_from("<H", head, POINT_FORMAT + 1)[0]
    extra = stride - laspy.PointFormat(head[POINT_FORMAT]).size
    scheme = lazrs.LazVlr.new_for_compression(head[POINT_FORMAT], extra)
    payload = scheme.record_data()
    record = struct.pack("<H16sHH32s", 0, b"laszip encoded", 22204, len(payload), b"lazrs") + payload
    struct.pack_into("<II", head, HEADER_SIZE + 2, start + len(record), number + 1)
    head[POINT_FORMAT] |= 0x80
    target.write(head[:size] + record + head[size:])
    compressor = lazrs.ParLasZipCompressor(target, scheme)
    total = os.fstat(source.fileno()).st_size
    while block := source.read(CHUNK * stride):
        context.check()
        compressor.compress_many(np.frombuffer(block, np.uint8))
        context.report(source.tell() / total)
    compressor.done()


def chunks(path: str, size: int) -> Iterator[Tuple[Geometry, int]]:
    """The points in the order of the file, `size` at a time, and the number of all of them."""
    place = "header"
    try:
        with open(path, "rb") as file:
            head = read_head(file)
            reader = laspy.LasReader(file, closefd=False, read_evlrs=False)
            count = reader.header.point_count
            if not 0 < count < NO_INDEX:
                raise ValueError(f"{count} points, expected 1 to {NO_INDEX - 1}")
            if reader.header.are_points_compressed:
                check_table(file, reader.header)
            layout = _Layout(head, reader.header)
            file.seek(reader.header.offset_to_point_data)
            while reader.points_read < count:
                place = f"behind point {reader.points_read}"
                expected = min(size, count - reader.points_read)
                chunk = layout.geometry(reader.read_points(size))
                if len(chunk) < expected:
                    raise FormatError(f"laz: {path}: the file ends {expected - len(chunk)} points early")
                yield chunk, count
    except (Error, KeyboardInterrupt, SystemExit, GeneratorExit):
        raise
    except MemoryError as error:
        raise BudgetExceeded(f"laz: {path}: {place}: more points than there is memory for") from error
    except OSError as error:
        raise ReadError(f"laz: {path}: {error}") from error
    except BaseException as error:  # panics of lazrs derive from nothing less
        raise FormatError(f"laz: {path}: {place}: {error}") from error


def from_laspy(las: Any) -> Geometry:
    """A laspy.LasData as a geometry."""
    head = io.BytesIO()
    las.header.write_to(head)
    return _Layout(head.getvalue(), las.header).geometry(las.points)


def to_laspy(geometry: Geometry) -> Any:
    """A geometry as laspy.LasData, by way of the library's own writer."""
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "points.las")
        files.write(path, geometry)
        return laspy.read(path)


class _Layout:
    """What the points of one file have in common."""

    def __init__(self, head: bytes, header: Any) -> None:
        self.info = las_info(head)
        self.warnings: List[str] = []
        described = [d for record in header.vlrs.get("ExtraBytesVlr") for d in record.extra_bytes_structs]
        typed = {d.format_name() for d in described if d.data_type}
        self.extra = [d.name for d in header.point_format.extra_dimensions if d.name in typed]
        for dimension in header.point_format.extra_dimensions:
            if dimension.name not in typed:
                self.warnings.append(f"{dimension.num_bits // 8} undocumented bytes per point skipped")
            elif dimension.is_scaled:
                about = "has a scale or offset; its stored values are kept"
                self.warnings.append(f"extra dimension {dimension.name} {about}")
        skipped = header.number_of_evlrs - any(vlr.user_id == "copc" for vlr in header.vlrs)
        if header.version.minor >= 4 and skipped > 0:
            self.warnings.append(f"{skipped} extended variable length records behind the points skipped")

    def geometry(self, points: Any) -> Geometry:
        positions = np.empty((len(points), 3))
        for axis, name in enumerate("XYZ"):
            positions[:, axis] = points.array[name] * self.info.scale[axis] + self.info.offset[axis]
        columns = self._columns(points)
        return Geometry(positions, attributes=columns, format="laz", las=self.info, warnings=list(self.warnings))

    def _columns(self, points: Any) -> Dict[str, NDArray[Any]]:
        """Values as stored, so that they can be written back: extra dimensions without their scale."""
        columns: Dict[str, NDArray[Any]] = {}
        for name in points.point_format.standard_dimension_names:
            if name not in "XYZ":
                columns[OUR_NAMES.get(name, name)] = np.array(points[name])
        for name in self.extra:
            values = points.array[name].reshape(len(points), -1)
            for k, column in enumerate(values.T):
                columns.setdefault(name if values.shape[1] == 1 else f"{name}_{k}", np.array(column))
        return columns
