"""Whatever is passed for an argument: a result, or an error in words of the library's own or of Python."""

import inspect

import numpy as np
import pytest

import shapelight as sl
from shapelight import compat, pictures, stages
from shapelight.errors import in_keywords

EYE = np.eye(4)
PIXELS = np.zeros((4, 4, 3), np.uint8)
BAD = (None, "x", b"x", -1, 2.5, float("nan"), [], [[1, 2], [3]], {"a": 1}, object(), np.zeros((2, 2)), 1j, True)


@pytest.fixture(scope="module")
def things():
    rng = np.random.default_rng(0)
    points = rng.random((60, 3)) * (1, 1, 0.1)
    graph = stages.build_graph(points)
    corners = np.vstack([np.zeros(3), np.eye(3)])
    tetrahedron = sl.Geometry(corners, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    cloud = stages.RegistrationCloud(points, np.tile([0.0, 0.0, 1.0], (60, 1)))
    return {"points": points, "graph": graph, "mesh": tetrahedron, "cloud": cloud, "field": np.ones(len(graph))}


def calls(t, folder):
    """Arguments with which each function does something."""
    points, graph, mesh, cloud, field = (t[k] for k in ("points", "graph", "mesh", "cloud", "field"))
    tree = stages.KdTree(points)
    surface = stages.TriangleTree(mesh)
    yield sl.sample, {"points_or_mesh": points, "count": 3, "method": "random"}
    yield sl.fields, {"points_or_mesh": points}
    yield sl.metrics, {"reference": mesh, "test": mesh, "samples": 20}
    yield sl.register, {"source": points, "target": points, "init": EYE, "min_confidence": 0}
    yield sl.align, {"scans": [points, points], "allow_partial": True}
    yield sl.render, {"geometries": mesh, "width": 40, "height": 40}
    yield sl.show, {"color": "x", "dots": points, "titles": ["a"]}
    yield sl.read, {"path": "missing.png", "intrinsics": (1, 1, 0, 0)}
    yield sl.write, {"path": folder / "a.ply", "geometry": points, "overwrite": True}
    yield sl.iter_chunks, {"path": "missing.las", "size": 10}
    yield sl.read_transform, {"path": "missing.txt"}
    yield sl.write_transform, {"path": folder / "t.txt", "transform": EYE, "overwrite": True}
    yield sl.write_png, {"path": folder / "a.png", "image": PIXELS, "overwrite": True}
    yield sl.as_geometry, {"source": points, "faces": mesh.triangles}
    yield sl.concatenate, {"parts": [mesh, mesh]}
    yield sl.Geometry, {name: value for name, value in vars(mesh).items() if not name.startswith("_")}
    yield mesh.select, {"indices": [0, 1]}
    yield mesh.transformed, {"T_new_old": EYE}
    yield tree.nearest, {"queries": points, "k": 2, "radius": 1.0}
    yield tree.within, {"queries": points, "radius": 1.0}
    yield surface.closest, {"queries": points}
    yield surface.first_hit, {"origins": points, "directions": points}
    yield pictures.image_grid, {"images": [PIXELS], "columns": 1}
    yield pictures.parse_view, {"text": "iso", "geometry": mesh}
    yield pictures.color_by_field, {"geometry": mesh, "field": "x"}
    yield pictures.color_by_values, {"values": field, "name": "a"}
    yield pictures.map_color, {"map": "diverging", "t": field}
    yield pictures.srgb_to_linear, {"value": 0.5}
    yield stages.build_graph, {"points_or_mesh": points}
    yield stages.graph_from_points, {"points": points}
    yield stages.RegistrationCloud, {"positions": points, "viewpoint": [0, 0, 1]}
    yield stages.sample_random, {"graph": graph, "count": 3}
    yield stages.sample_voxel, {"graph": graph, "spacing": 0.2}
    yield stages.sample_by_shape, {"graph": graph, "density": field, "count": 3}
    yield stages.simplify_qslim, {"mesh": mesh, "vertices": 4}
    yield stages.register_by_icp, {"source": cloud, "target": cloud, "T_target_source": EYE}
    yield stages.assess_pose, {"source": cloud, "target": cloud, "T_target_source": EYE}
    yield stages.camera_on_sphere, {}
    yield stages.coarse_spacing, {"cloud": cloud}
    yield compat.voxel_down_sample, {"cloud": points, "voxel_size": 0.5}
    yield compat.farthest_point_down_sample, {"cloud": points, "num_samples": 4}
    yield compat.compute_point_cloud_distance, {"source": points, "target": points}


def test_no_error_is_in_the_words_of_the_bindings(things, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = []
    for function, good in calls(things, tmp_path):
        names = [p.name for p in inspect.signature(function).parameters.values() if p.kind is not p.VAR_POSITIONAL]
        for name in names:
            for bad in BAD:
                try:
                    function(**{**good, name: bad})
                except Exception as error:
                    known = isinstance(error, (sl.Error, TypeError, ValueError))
                    if not known or "incompatible function arguments" in str(error):
                        found.append(f"{function.__qualname__}({name}={bad!r}): {type(error).__name__}: {error}"[:160])
    assert not found, "\n".join(found)


TOLD = {
    "^ratio: 1.5 is out of range": {"ratio": 1.5},
    "^local_weight: 2 is out of range": {"ratio": 0.1, "local_weight": 2},
    "^expected exactly one of count, ratio and spacing": {"ratio": 0.1, "count": 2},
    "^count: -1, expected at least 1": {"count": -1},
    "^count: 2.5, expected a whole number": {"count": 2.5},
    "^threads: -1, expected a whole number": {"count": 1, "threads": -1},
    "^preset: 3, expected text": {"count": 1, "preset": 3},
}


@pytest.mark.parametrize("message", TOLD)
def test_messages_name_the_keyword(things, message):
    with pytest.raises(sl.InvalidInput, match=message):
        sl.sample(things["points"], **TOLD[message])


def test_flags_of_the_command_become_keywords():
    assert in_keywords("--max-error: 0") == "max_error: 0"
    assert in_keywords("scan.ply: exists (--force allows it)") == "scan.ply: exists (overwrite=True allows it)"
    assert in_keywords("a; --no-skip-boundary allows those") == "a; skip_boundary=False allows those"
    assert in_keywords("my --scan.ply: cannot read") == "my --scan.ply: cannot read"


def test_whole_floats_and_numpy_numbers_are_numbers(things):
    expected = sl.sample(things["points"], count=6).indices
    for count in (6.0, np.float32(6), np.int8(6), np.array(6)):
        np.testing.assert_array_equal(sl.sample(things["points"], count=count).indices, expected)


def test_any_number_of_threads_gives_the_same():
    points = np.random.default_rng(0).random((20000, 3))
    expected = sl.sample(points, ratio=0.1).indices
    np.testing.assert_array_equal(sl.sample(points, ratio=0.1, threads=10**6).indices, expected)


@pytest.mark.parametrize("kind", [complex, "datetime64[s]", str])
def test_what_are_no_real_numbers_is_refused(things, kind):
    with pytest.raises(sl.InvalidInput, match="points: .*expected an array of numbers"):
        sl.sample(things["points"].astype(int).astype(kind), count=3)


def test_masked_points_are_not_finite(things):
    masked = np.ma.masked_array(things["points"], mask=np.arange(60)[:, None] % [2, 2, 2] == 0)
    assert sl.sample(masked, ratio=1.0).usable == 30


def test_byte_order_and_half_precision_are_kept_as_floats(things):
    for kind in (">f4", np.float16):
        assert sl.sample(things["points"].astype(kind), count=3).output.dtype == np.float32


def test_geometry_tells_at_once_what_an_attribute_lacks(things):
    with pytest.raises(sl.InvalidInput, match=r"attribute rgb: shape \(60, 3\), expected \(60,\); one attribute per"):
        sl.Geometry(things["points"], attributes={"rgb": np.zeros((60, 3))})
    with pytest.raises(sl.InvalidInput, match="attribute day: datetime64"):
        sl.Geometry(things["points"], attributes={"day": np.zeros(60, "datetime64[s]")})
    scan = sl.Geometry(things["points"], attributes={"a": np.zeros(60, ">f4"), "b": np.zeros(60, np.longdouble)})
    assert [column.dtype for column in scan.select([0]).attributes.values()] == [np.float32, np.float64]
    scan.attributes["late"] = np.zeros(59)
    with pytest.raises(sl.InvalidInput, match="attribute late"):
        scan.select([0])


def test_select_takes_a_mask(things):
    mask = things["points"][:, 0] > 0.5
    scan = sl.Geometry(things["points"])
    np.testing.assert_array_equal(scan.select(mask).positions, things["points"][mask])


def test_likely_mistakes_are_told(things, tmp_path):
    points, mesh = things["points"], things["mesh"]
    with pytest.raises(sl.InvalidInput, match="transpose it"):
        sl.sample(points.T, count=3)
    with pytest.raises(sl.InvalidInput, match="expected a tuple"):
        sl.as_geometry([mesh.positions, mesh.triangles])
    with pytest.raises(sl.InvalidInput, match="points: NoneType, expected"):
        sl.sample(None, count=3)
    with pytest.raises(sl.InvalidInput, match="zero byte"):
        sl.write(str(tmp_path / "a\0b.ply"), mesh)
    with pytest.raises(sl.InvalidInput, match="at least one finite point"):
        sl.show(np.full((3, 3), np.nan))


def test_results_with_arrays_equal_themselves_only(things):
    one, other = (sl.sample(things["points"], count=3) for _ in range(2))
    assert one in [other, one] and one != other and len({one, other}) == 2
