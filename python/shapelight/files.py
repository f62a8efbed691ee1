"""Reading and writing, by the format that the extension names."""

from __future__ import annotations

import os
from typing import Any, Callable, Dict, Iterator, List, Optional, Protocol, Sequence, Tuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from .arguments import Path, as_file_name, as_floats, as_real, as_whole
from .errors import FormatError, InvalidInput
from .geometry import Geometry, as_transform
from .progress import Progress, as_callable



def read(
    path: Path,
    *,
    intrinsics: Optional[Tuple[float, float, float, float]] = None,
    depth_scale: float = 1000.0,
    threads: int = 0,
    progress: Progress = None,
) -> Geometry:
    """Reads a mesh, range image or point cloud; the format is chosen by extension, see `formats`.

    intrinsics   fx, fy, cx, cy [pixels] of a depth image; else a text file beside the image is looked for
    depth_scale  [steps per output length unit] of a depth image: depth = value / depth_scale

    Raises ReadError (missing, unreadable), FormatError (malformed or unsupported; names the place).
    """
    name = as_file_name(path)
    camera = None if intrinsics is None else as_floats(intrinsics, "intrinsics")
    if camera is not None and camera.shape != (4,):
        raise InvalidInput(f"intrinsics: shape {camera.shape}, expected fx, fy, cx, cy")
    scale = as_real(depth_scale, "depth_scale")
    reader = _readers.get(os.path.splitext(name)[1].lower())
    with as_callable(progress) as report:
        if reader is not None:
            return _read_here(reader, name, report)
        return Geometry(**_core.read_geometry(name, None if camera is None else camera.tolist(), scale, threads, report))


def iter_chunks(path: Path, size: int = 1_000_000) -> Iterator[Geometry]:
    """The points of a LAS, LAZ or COPC file in the order of the file, `size` at a time: the file is never held whole.

        kept = [chunk.select(sl.sample(chunk, ratio=0.1).indices) for chunk in sl.iter_chunks("large.laz")]
        sl.write("thin.laz", sl.concatenate(kept))

    Raises ImportError when the extra is missing (pip install 'shapelight[las]'), InvalidInput (another format, size),
    ReadError, FormatError.
    """
    name, size = as_file_name(path), as_whole(size, "size", 1)
    if not name.lower().endswith((".las", ".laz")):
        raise InvalidInput(f"{name}: only .las and .laz (also .copc.laz) can be read in chunks")
    try:
        from .extras import las
    except ImportError as error:
        raise ImportError("reading in chunks needs laspy and lazrs: pip install 'shapelight[las]'") from error
    return (chunk for chunk, _ in las.chunks(name, size))


def write(
    path: Path,
    geometry: Any,
    *,
    ascii: bool = False,
    overwrite: bool = False,
    threads: int = 0,
    progress: Progress = None,
) -> List[str]:
    """Writes beside the target, then renames, so that the target is either old or complete.

    Returns the names of attributes that the format cannot hold.
    Raises InvalidInput (unknown extension), WriteError (exists and `overwrite` is off, no space, ...).
    """
    from .interop import as_geometry

    with as_callable(progress) as report:
        view = as_geometry(geometry)._view()
        return list(_core.write_geometry(as_file_name(path), view, bool(ascii), bool(overwrite), threads, report))


def formats() -> List[Dict[str, Any]]:
    """The file formats that can be read and written: name, extensions, description, can_read, can_write."""
    return list(_core.supported_formats())


class Context(Protocol):
    """How a reader or writer of a registered format is to run."""

    def check(self) -> None:
        """Raises when Ctrl-C was pressed."""

    def report(self, fraction: float) -> None:
        """What share of the work is done."""


Reader = Callable[[str, Context], Geometry]
Writer = Callable[[str, Geometry, Context], List[str]]
_readers: Dict[str, Reader] = {}  # by extension


class _Here:
    """The caller's own thread, in which Ctrl-C is seen between any two steps of Python."""

    def __init__(self, progress: Optional[Callable[[float, str], Any]]) -> None:
        self.progress = progress

    def check(self) -> None:
        pass

    def report(self, fraction: float) -> None:
        if self.progress is not None:
            self.progress(fraction, "read")


def _read_here(reader: Reader, path: str, progress: Optional[Callable[[float, str], Any]]) -> Geometry:
    """Without the detour over the library, which would hold the points once more."""
    geometry = reader(path, _Here(progress))
    if not np.isfinite(geometry.positions).all(axis=1).any():
        raise FormatError(f"{path}: {len(geometry)} points and none of them finite, expected at least one")
    return geometry


def register_format(
    name: str,
    extensions: Sequence[str],
    description: str,
    *,
    read: Optional[Reader] = None,
    write: Optional[Writer] = None,
) -> None:
    """Makes a format known to `read`, `write` and the command, for the whole process.

    read   (path, context) -> Geometry; call context.check() now and then: it raises when Ctrl-C was pressed
    write  (path, geometry, context) -> names of attributes left out; the path is an empty file that is renamed later

    Raises InvalidInput when an extension belongs to another format.
    """
    _core.register_format(name, list(extensions), description, read, write)
    for extension in extensions:
        if read is not None:
            _readers[extension] = read


def read_transform(path: Path) -> NDArray[np.float64]:
    """(4, 4): a rigid transform from plain text, 4 rows of 4 numbers, source into target."""
    return np.asarray(_core.read_transform(as_file_name(path)))


def write_transform(path: Path, transform: ArrayLike, *, overwrite: bool = False) -> None:
    """Writes a rigid (4, 4) transform with 17 digits, beside its target, then renames. Raises WriteError."""
    _core.write_transform(as_file_name(path), as_transform(transform), bool(overwrite))
