"""LAZ, COPC and chunks: against the library's own LAS reader, byte for byte."""

import os
import struct
import subprocess
import sys

import numpy as np
import pytest

import shapelight as sl

laspy = pytest.importorskip("laspy", reason="the extra [las] is not installed")
lazrs = pytest.importorskip("lazrs", reason="the extra [las] is not installed")


@pytest.fixture
def las(data):
    return data / "clouds/simple.las"


@pytest.fixture
def rich(tmp_path):
    """LAS 1.4 in format 8 with 1 and 3 components of extra bytes, over two blocks of decompression."""
    rng = np.random.default_rng(0)
    n = 120_000
    header = laspy.LasHeader(point_format=8, version="1.4")
    header.offsets, header.scales = [500_000.0, 4_000_000.0, 100.0], [0.001, 0.002, 0.01]
    header.add_extra_dim(laspy.ExtraBytesParams("amplitude", "f4"))
    header.add_extra_dim(laspy.ExtraBytesParams("beam", "3u2"))
    points = laspy.LasData(header)
    points.xyz = header.offsets + rng.random((n, 3)) * 1000.0
    points.intensity = rng.integers(0, 65536, n)
    points.return_number = rng.integers(1, 16, n)
    points.scanner_channel = rng.integers(0, 4, n)
    points.key_point = rng.integers(0, 2, n)
    points.scan_angle = rng.integers(-30000, 30000, n)
    points.nir = rng.integers(0, 65536, n)
    points.amplitude = rng.random(n)
    points.beam = rng.integers(0, 65536, (n, 3))
    path = tmp_path / "rich.las"
    points.write(str(path))
    return path


def assert_equal(actual, expected, same_bytes):
    same_bytes(actual.positions, expected.positions)
    assert list(actual.attributes) == list(expected.attributes)
    for name, column in expected.attributes.items():
        same_bytes(actual.attributes[name], column)


def test_laz_equals_its_las_twin(data, same_bytes):
    assert_equal(sl.read(data / "clouds/simple.laz"), sl.read(data / "clouds/simple.las"), same_bytes)


@pytest.mark.parametrize("source", ["las", "rich"])
def test_there_and_back_loses_nothing(source, request, tmp_path, same_bytes):
    original = sl.read(request.getfixturevalue(source))
    sl.write(tmp_path / "a.las", original)
    assert sl.write(tmp_path / "a.laz", original) == []
    back = sl.read(tmp_path / "a.laz")
    assert_equal(back, original, same_bytes)
    sl.write(tmp_path / "b.las", back)
    assert (tmp_path / "b.las").read_bytes() == (tmp_path / "a.las").read_bytes()
    assert sorted(os.listdir(tmp_path)) == sorted({"a.las", "a.laz", "b.las"} | {"rich.las"} & {f"{source}.las"})


def test_other_software_reads_what_we_write(rich, tmp_path):
    sl.write(tmp_path / "a.laz", sl.read(rich))
    theirs, ours = laspy.read(rich), laspy.read(tmp_path / "a.laz")
    for name in (*theirs.point_format.standard_dimension_names, "amplitude"):
        np.testing.assert_array_equal(theirs[name], ours[name])
    np.testing.assert_array_equal(theirs["beam"][:, 2], ours["beam_2"])
    assert theirs.header.maxs.tolist() == ours.header.maxs.tolist()


def test_attributes_have_the_names_and_types_of_the_las_reader(rich):
    attributes = sl.read(rich).attributes
    assert {"keypoint", "scan_angle", "nir", "amplitude", "beam_0", "beam_1", "beam_2"} <= set(attributes)
    assert attributes["amplitude"].dtype == np.float32 and attributes["beam_2"].dtype == np.uint16


@pytest.mark.parametrize("size", [1, 400, 1065, 2000])
def test_chunks_add_up_to_the_file(data, size, same_bytes):
    expected = sl.read(data / "clouds/simple.las")
    for name in ("simple.las", "simple.laz"):
        chunks = list(sl.iter_chunks(data / "clouds" / name, size))
        assert {len(c) for c in chunks[:-1]} <= {size}
        assert_equal(sl.concatenate(chunks), expected, same_bytes)
        assert chunks[-1].las.vlrs == expected.las.vlrs


def test_chunks_refuse_what_they_cannot_read(data):
    with pytest.raises(sl.InvalidInput, match="expected at least 1"):
        sl.iter_chunks(data / "clouds/simple.las", 0)
    with pytest.raises(sl.InvalidInput, match="only .las and .laz"):
        sl.iter_chunks(data / "meshes/bunny.ply")
    with pytest.raises(sl.ReadError):
        next(sl.iter_chunks("missing.laz"))


def copc_of(path):
    """A file that is laid out as COPC: its record first, and chunks of different sizes."""
    raw = path.read_bytes()
    size, start, number = struct.unpack_from("<HII", raw, 94)
    stride = struct.unpack_from("<H", raw, 105)[0]
    scheme = lazrs.LazVlr.new_for_compression(raw[104], stride - laspy.PointFormat(raw[104]).size, True)
    payload = scheme.record_data()
    records = struct.pack("<H16sHH32s", 0, b"copc", 1, 160, b"") + bytes(160)
    records += struct.pack("<H16sHH32s", 0, b"laszip encoded", 22204, len(payload), b"") + payload
    head = bytearray(raw[:start])
    head[104] |= 0x80
    struct.pack_into("<II", head, 96, start + len(records), number + 2)
    target = path.with_suffix(".copc.laz")
    with open(target, "wb") as file:
        file.write(head[:size] + records + head[size:])
        compressor = lazrs.LasZipCompressor(file, scheme)
        points = np.frombuffer(raw, np.uint8, offset=start)
        ends = [0, 700, 5000, 120_000]
        compressor.compress_chunks([points[a * stride : b * stride] for a, b in zip(ends, ends[1:])])
        compressor.done()
    return target


def test_copc_is_laz_without_its_index(rich, tmp_path, same_bytes):
    expected, actual = sl.read(rich), sl.read(copc_of(rich))
    assert_equal(actual, expected, same_bytes)
    sl.write(tmp_path / "a.las", expected)
    sl.write(tmp_path / "b.las", actual)
    assert (tmp_path / "a.las").read_bytes() == (tmp_path / "b.las").read_bytes()


def damaged(path, where, kind, value):
    raw = bytearray(path.read_bytes())
    struct.pack_into(kind, raw, where, value)
    return bytes(raw)


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda p: b"", "not a LAS file"),
        (lambda p: p.read_bytes()[:300], "do not fit"),
        (lambda p: p.read_bytes()[:-2000], "table of chunks"),
        (lambda p: damaged(p, 100, "<I", 2**31), "2147483648 records between bytes 227 and 333"),
        (lambda p: damaged(p, 107, "<I", 2**31), "do not hold 2147483648 points"),
        (lambda p: damaged(p, 107, "<I", 0), "0 points"),
        (lambda p: damaged(p, 227 + 54 + 12, "<I", 2**30), "chunks of 1073741824 points"),
        (lambda p: damaged(p, 18203 + 4, "<I", 2**30), "1073741824 chunks do not fit"),
        (lambda p: damaged(p, 131, "<d", 0.0), "no scale of 0"),
        (lambda p: damaged(p, 104, "<B", 0x8B), "header"),
    ],
)
def test_malformed_files_are_refused_with_the_place(data, tmp_path, make, message):
    path = tmp_path / "bad.laz"
    path.write_bytes(make(data / "clouds/simple.laz"))
    with pytest.raises((sl.FormatError, sl.ReadError), match=message) as caught:
        sl.read(path)
    assert str(path) in str(caught.value)


def test_flipped_bytes_never_hurt(data, tmp_path):
    rng = np.random.default_rng(0)
    raw = np.fromfile(data / "clouds/simple.laz", np.uint8)
    for _ in range(60):
        bad = raw.copy()
        bad[rng.integers(0, len(bad), 4)] = rng.integers(0, 256, 4)
        bad[: rng.integers(0, len(bad))].tofile(tmp_path / "bad.laz")
        with pytest.raises((sl.FormatError, sl.ReadError)):
            sl.read(tmp_path / "bad.laz")


def test_missing_files_are_that(tmp_path):
    with pytest.raises(sl.ReadError, match="nothing.laz"):
        sl.read(tmp_path / "nothing.laz")


def test_progress_ends_at_one_and_may_stop_the_reading(rich, tmp_path):
    sl.write(tmp_path / "a.laz", sl.read(rich))
    seen = []
    sl.read(tmp_path / "a.laz", progress=lambda fraction, phase: seen.append(fraction))
    assert seen == sorted(seen) and seen[-1] == 1.0 and len(seen) > 1

    def stop(fraction, phase):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sl.read(tmp_path / "a.laz", progress=stop)


def test_the_command_reads_and_writes_laz(data, tmp_path):
    made = tmp_path / "thin.laz"
    source = data / "clouds/simple.laz"
    command = [sys.executable, "-m", "shapelight", "sample", source, "-o", made, "--count", "100"]
    subprocess.run(command, check=True, capture_output=True)
    assert len(laspy.read(made).points) == 100


def test_the_extra_is_named_where_it_is_missing(data):
    program = f"""
import importlib.util, sys
found = importlib.util.find_spec
importlib.util.find_spec = lambda name, *a: None if name in ("laspy", "lazrs", "pye57") else found(name, *a)
sys.modules["laspy"] = None
import shapelight as sl
try:
    sl.read({str(data / "clouds/simple.laz")!r})
except sl.FormatError as error:
    assert "pip install 'shapelight[las]'" in str(error), error
else:
    raise SystemExit("no error")
for call in (lambda: sl.iter_chunks({str(data / "clouds/simple.laz")!r}), lambda: sl.to_laspy([[0, 0, 0]])):
    try:
        call()
    except ImportError as error:
        assert "pip install 'shapelight[las]'" in str(error), error
    else:
        raise SystemExit("no error")
"""
    subprocess.run([sys.executable, "-c", program], check=True)
