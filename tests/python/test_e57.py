"""E57: poses, pixels, attributes, and files that are not what they say."""

import numpy as np
import pytest

import shapelight as sl

pye57 = pytest.importorskip("pye57", reason="the extra [e57] is not installed")

QUARTER_TURN = np.array([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])  # about z: x goes to y


def write(path, scans, shape=(4, 5), poses=True, pixels=True):
    """Scans of a plane z = scan + 1, seen from (10, 20, 30 + scan); the pixel in row 1, column 2 saw nothing."""
    row, column = (a.ravel() for a in np.mgrid[: shape[0], : shape[1]])
    with pye57.E57(str(path), "w") as file:
        for scan in range(scans):
            points = {
                "cartesianX": column * 1.0,
                "cartesianY": row * 1.0,
                "cartesianZ": np.full(row.size, scan + 1.0),
                "intensity": np.linspace(0.0, 1.0, row.size),
                "colorRed": np.arange(row.size),
                "colorGreen": np.full(row.size, 7),
                "colorBlue": np.full(row.size, 255),
                "cartesianInvalidState": np.where((row == 1) & (column == 2), 2, 0),
            }
            if pixels:
                points.update(rowIndex=row + 3, columnIndex=column)
            pose = {"rotation": QUARTER_TURN, "translation": np.array([10.0, 20.0, 30.0 + scan])} if poses else {}
            file.write_scan_raw(points, **pose)
    return path


def test_a_single_scan_is_a_range_image_seen_from_its_pose(tmp_path):
    scan = sl.read(write(tmp_path / "one.e57", 1))
    assert scan.kind == "range_image" and scan.grid.shape == (4, 5) and len(scan) == 19
    assert scan.grid[1, 2] == 0xFFFFFFFF
    np.testing.assert_allclose(scan.positions[scan.grid[3, 4]], [10 - 3, 20 + 4, 31], atol=1e-12)
    np.testing.assert_array_equal(scan.viewpoint, [10, 20, 30])
    assert {name: column.dtype for name, column in scan.attributes.items()} == {
        "intensity": np.float32,
        "red": np.uint8,
        "green": np.uint8,
        "blue": np.uint8,
    }
    np.testing.assert_array_equal(scan.attributes["red"], np.delete(np.arange(20), 7))


def test_several_scans_share_a_frame_and_are_numbered(tmp_path):
    cloud = sl.read(write(tmp_path / "two.e57", 2))
    assert cloud.kind == "cloud" and cloud.viewpoint is None
    np.testing.assert_array_equal(cloud.attributes["scan"], np.repeat([0, 1], 19))
    np.testing.assert_allclose(cloud.positions[[0, 19]], [[10, 20, 31], [10, 20, 33]], atol=1e-12)


def test_without_pixels_a_scan_is_a_cloud(tmp_path):
    assert sl.read(write(tmp_path / "flat.e57", 1, pixels=False)).kind == "cloud"


@pytest.mark.parametrize("name, message", [("bad-crc", "checksum"), ("InvalidCVHeader", "without a measured point")])
def test_malformed_files_are_refused(data, name, message):
    with pytest.raises(sl.FormatError, match=f"e57: .*{name}.e57.*{message}"):
        sl.read(data / f"malformed/e57_{name}.e57")


def test_missing_files_are_that(tmp_path):
    with pytest.raises(sl.ReadError, match="nothing.e57"):
        sl.read(tmp_path / "nothing.e57")


def test_truncated_files_are_refused(tmp_path):
    raw = write(tmp_path / "one.e57", 1).read_bytes()
    for size in range(0, len(raw), 97):
        (tmp_path / "cut.e57").write_bytes(raw[:size])
        with pytest.raises(sl.FormatError, match="cut.e57"):
            sl.read(tmp_path / "cut.e57")


def crc32c(page):
    crc = 0xFFFFFFFF
    for byte in page:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ (0x82F63B78 if crc & 1 else 0)
    return crc ^ 0xFFFFFFFF


def with_text(path, old, new):
    """The file with other text of the same length, and with checksums that are right."""
    assert len(old) == len(new)
    raw = bytearray(path.read_bytes())
    text = bytearray(b"".join(raw[page : page + 1020] for page in range(0, len(raw), 1024)))
    at = text.index(old)
    text[at : at + len(old)] = new
    for page in range(0, len(raw), 1024):
        raw[page : page + 1020] = text[page // 1024 * 1020 :][:1020]
        raw[page + 1020 : page + 1024] = crc32c(raw[page : page + 1020]).to_bytes(4, "big")
    path.write_bytes(raw)
    return path


@pytest.mark.parametrize(
    "old, new",
    [
        (b'recordCount="20"', b'recordCount="99"'),
        (b"<cartesianX", b"<kartesianX"),
        (b"</e57Root>", b"</e57Boot>"),
        (b"<data3D", b"<data4D"),
        (b'fileOffset="48"', b'fileOffset="99"'),
    ],
)
def test_contents_that_do_not_fit_are_refused(tmp_path, old, new):
    path = write(tmp_path / "one.e57", 1)
    assert len(sl.read(with_text(path, old, old))) == 19  # the checksums are right
    with pytest.raises(sl.FormatError, match="e57: .*one.e57: "):
        sl.read(with_text(path, old, new))
