"""LAS headers and records as bytes: what has to be checked before laspy and lazrs believe it, and what is kept."""

from __future__ import annotations

import os
import struct
from typing import Any, BinaryIO

import lazrs
import numpy as np

from ..geometry import LasInfo

MOST_PER_CHUNK = 10_000_000  # points; 50,000 is usual
# Of the public header block (ASPRS LAS 1.4 R15) and of a variable length record. [bytes]
MIN_HEADER = 227
HEADER_SIZE, POINT_FORMAT, SCALE_AND_OFFSET = 94, 104, 131  # the first is followed by start and number of records
VLR_HEADER, VLR_USER, VLR_SIZE = 54, 2, 20
OF_COMPRESSION = (b"laszip encoded", b"copc")


def read_head(file: BinaryIO) -> bytes:
    """Everything before the points. laspy believes the number of records, whatever the room for them."""
    start = file.read(MIN_HEADER)
    if len(start) < MIN_HEADER or start[:4] != b"LASF":
        raise ValueError(f"not a LAS file, expected LASF and {MIN_HEADER} bytes or more")
    size, points, number = struct.unpack_from("<HII", start, HEADER_SIZE)
    if not MIN_HEADER <= size <= points <= os.fstat(file.fileno()).st_size or number > (points - size) // VLR_HEADER:
        raise ValueError(f"{number} records between bytes {size} and {points} do not fit")
    file.seek(0)
    head = file.read(points)
    file.seek(0)
    return head


def check_table(file: BinaryIO, header: Any) -> None:
    """What lazrs believes, and takes memory for, before it looks at the chunks."""
    records = header.vlrs.get("LasZipVlr")
    if not records:
        raise ValueError("the points are compressed, expected a record of laszip that says how")
    scheme = lazrs.LazVlr(records[0].record_data)
    stride, start, size = header.point_format.size, header.offset_to_point_data, os.fstat(file.fileno()).st_size
    if scheme.item_size() != stride:
        raise ValueError(f"compressed records of {scheme.item_size()} bytes, expected {stride}")
    if not scheme.uses_variable_size_chunks() and not 0 < scheme.chunk_size() <= MOST_PER_CHUNK:
        raise ValueError(f"chunks of {scheme.chunk_size()} points, expected 1 to {MOST_PER_CHUNK}")
    end = _at(file, "<q", start)
    if end == -1:
        end = _at(file, "<q", size - 8)
    if not start + 8 <= end <= size - 8:
        raise ValueError(f"table of chunks at byte {end}, expected {start + 8} to {size - 8}")
    number = _at(file, "<I", end + 4)
    if number > (end - start) // stride:  # a chunk begins with a whole point
        raise ValueError(f"byte {end}: {number} chunks do not fit into {end - start} bytes")
    file.seek(start)
    table = lazrs.read_chunk_table(file, scheme)
    if sum(length for _, length in table) > end - start or sum(points for points, _ in table) < header.point_count:
        raise ValueError(f"byte {end}: the chunks do not hold {header.point_count} points in {end - start} bytes")


def _at(file: BinaryIO, kind: str, offset: int) -> int:
    file.seek(offset)
    return int(struct.unpack(kind, file.read(struct.calcsize(kind)))[0])


def las_info(head: bytes) -> LasInfo:
    """Header and records as of the file that the decompressed points would be."""
    size, _, number = struct.unpack_from("<HII", head, HEADER_SIZE)
    header, left = bytearray(head[:size]), head[size:]
    records = []
    for i in range(number):
        end = VLR_HEADER + (struct.unpack_from("<H", left, VLR_SIZE)[0] if len(left) >= VLR_HEADER else 0)
        if end > len(left):
            raise ValueError(f"record {i + 1} of {number} does not end before the points")
        if left[VLR_USER : VLR_USER + 16].rstrip(b"\0") not in OF_COMPRESSION:
            records.append(left[:end])
        left = left[end:]
    vlrs = b"".join(records) + left
    header[POINT_FORMAT] &= 0x3F  # the upper bits say "compressed"
    struct.pack_into("<II", header, HEADER_SIZE + 2, size + len(vlrs), len(records))
    numbers = struct.unpack_from("<6d", header, SCALE_AND_OFFSET)
    if not np.isfinite(numbers).all() or 0.0 in numbers[:3]:
        raise ValueError(f"scale {numbers[:3]}, offset {numbers[3:]}, expected finite numbers and no scale of 0")
    return LasInfo(numbers[:3], numbers[3:], header[POINT_FORMAT], bytes(header), vlrs)
