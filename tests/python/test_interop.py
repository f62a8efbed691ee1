"""Geometries of other libraries: in, out, and there and back."""

import numpy as np
import pytest

import shapelight as sl

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 1]], dtype=float)
PYRAMID = np.array([[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [0, 2, 1], [0, 3, 2]])
RED = np.array([255, 0, 0, 10, 128], np.uint8)
NORMALS = CORNERS / np.maximum(np.linalg.norm(CORNERS, axis=1, keepdims=True), 1)


def pyramid(triangles=PYRAMID, **attributes):
    columns = {
        **{name: NORMALS[:, axis].astype(np.float32) for axis, name in enumerate(("nx", "ny", "nz"))},
        **{"red": RED, "green": RED[::-1].copy(), "blue": np.full(5, 7, np.uint8)},
        **{"heat": np.linspace(0, 1, 5), "uv_0": np.arange(5.0), "uv_1": np.arange(5.0) ** 2},
    }
    return sl.Geometry(CORNERS, triangles, columns, {"patch": np.arange(len(triangles))} if len(triangles) else {})


def assert_kept(actual, expected, names):
    np.testing.assert_array_equal(actual.positions, expected.positions)
    np.testing.assert_array_equal(actual.triangles, expected.triangles)
    assert set(actual.attributes) == set(names)
    for name in names:
        np.testing.assert_array_equal(actual.attributes[name], expected.attributes[name], name)
        assert actual.attributes[name].dtype == expected.attributes[name].dtype or name.startswith("n"), name


COLORS, DIRECTIONS = ["red", "green", "blue"], ["nx", "ny", "nz"]
OTHERS = ["heat", "uv_0", "uv_1"]


@pytest.mark.parametrize("triangles", [PYRAMID, PYRAMID[:0]], ids=["mesh", "cloud"])
class TestThereAndBack:
    def test_open3d_legacy(self, triangles):
        open3d = pytest.importorskip("open3d", reason="Open3D is not installed")
        thing = sl.to_open3d(pyramid(triangles))
        assert type(thing) is (open3d.geometry.TriangleMesh if len(triangles) else open3d.geometry.PointCloud)
        assert_kept(sl.as_geometry(thing), pyramid(triangles), COLORS + DIRECTIONS)

    def test_open3d_tensor(self, triangles):
        pytest.importorskip("open3d", reason="Open3D is not installed")
        back = sl.as_geometry(sl.to_open3d(pyramid(triangles), tensor=True))
        assert_kept(back, pyramid(triangles), COLORS + DIRECTIONS + OTHERS)
        np.testing.assert_array_equal(back.triangle_attributes.get("patch", []), np.arange(len(triangles)))

    def test_trimesh(self, triangles):
        pytest.importorskip("trimesh", reason="trimesh is not installed")
        back = sl.as_geometry(sl.to_trimesh(pyramid(triangles)))
        assert_kept(back, pyramid(triangles), COLORS + (OTHERS if len(triangles) else []))
        np.testing.assert_array_equal(back.triangle_attributes.get("patch", []), np.arange(len(triangles)))

    def test_pyvista(self, triangles):
        pytest.importorskip("pyvista", reason="PyVista is not installed")
        back = sl.as_geometry(sl.to_pyvista(pyramid(triangles)))
        assert_kept(back, pyramid(triangles), COLORS + DIRECTIONS + OTHERS)
        np.testing.assert_array_equal(back.triangle_attributes.get("patch", []), np.arange(len(triangles)))


def test_open3d_float_colors_and_precision_come_back():
    open3d = pytest.importorskip("open3d", reason="Open3D is not installed")
    cloud = open3d.t.geometry.PointCloud(CORNERS.astype(np.float32))
    cloud.point["colors"] = open3d.core.Tensor(np.tile(RED[:, None] / np.float32(255), 3))
    cloud.point["intensities"] = open3d.core.Tensor(np.arange(5, dtype=np.float32)[:, None])
    out = sl.sample(cloud, count=3, method="farthest").output
    assert type(out) is open3d.t.geometry.PointCloud
    assert out.point["positions"].dtype == out.point["colors"].dtype == open3d.core.float32
    assert out.point["intensities"].shape == (3, 1)
    kept = out.point["intensities"].numpy().ravel().astype(int)
    np.testing.assert_allclose(out.point["colors"].numpy()[:, 0], RED[kept] / 255, atol=1e-7)


def test_open3d_colors_are_rounded_to_bytes():
    open3d = pytest.importorskip("open3d", reason="Open3D is not installed")
    cloud = sl.to_open3d(CORNERS)
    cloud.colors = open3d.utility.Vector3dVector(np.tile([[0.0], [0.001], [0.003], [0.999], [1.0]], 3))
    assert sl.as_geometry(cloud).attributes["green"].tolist() == [0, 0, 1, 255, 255]


def test_open3d_may_change_its_points_afterwards():
    open3d = pytest.importorskip("open3d", reason="Open3D is not installed")
    cloud = sl.to_open3d(CORNERS)
    geometry = sl.as_geometry(cloud)
    cloud.points = open3d.utility.Vector3dVector(np.zeros((5, 3)))
    np.testing.assert_array_equal(geometry.positions, CORNERS)


def test_open3d_vectors_and_tensors_are_arrays():
    open3d = pytest.importorskip("open3d", reason="Open3D is not installed")
    np.testing.assert_array_equal(sl.as_geometry(open3d.utility.Vector3dVector(CORNERS)).positions, CORNERS)
    np.testing.assert_array_equal(sl.as_geometry(open3d.core.Tensor(CORNERS)).positions, CORNERS)


def test_trimesh_vertices_are_read_in_place():
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    mesh = trimesh.creation.icosphere()
    assert sl.as_geometry(mesh)._view().positions_address == mesh.vertices.ctypes.data
    assert sl.as_geometry(mesh.vertices)._view().positions_address == mesh.vertices.ctypes.data


def test_trimesh_keeps_duplicate_and_unused_vertices():
    pytest.importorskip("trimesh", reason="trimesh is not installed")
    twice = sl.Geometry(np.vstack([CORNERS, CORNERS]), PYRAMID)
    np.testing.assert_array_equal(sl.to_trimesh(twice).vertices, twice.positions)


def test_trimesh_texture_and_face_colors_follow():
    trimesh = pytest.importorskip("trimesh", reason="trimesh is not installed")
    material = trimesh.visual.material.SimpleMaterial()
    uv = CORNERS[:, :2].astype(np.float32)
    mesh = trimesh.Trimesh(CORNERS, PYRAMID, process=False)
    mesh.visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    geometry = sl.as_geometry(mesh)
    np.testing.assert_array_equal(geometry.corner_texcoords, uv[PYRAMID.ravel()])
    back = sl.interop.like(mesh, geometry)
    np.testing.assert_array_equal(back.visual.uv, uv)
    assert back.visual.material is material
    colored = trimesh.Trimesh(CORNERS, PYRAMID, face_colors=[[9, 8, 7, 255]] * 6, process=False)
    assert sl.as_geometry(colored).triangle_attributes["red"].tolist() == [9] * 6


def test_pyvista_polygons_become_triangles():
    pyvista = pytest.importorskip("pyvista", reason="PyVista is not installed")
    surface = pyvista.PolyData(CORNERS, [4, 0, 3, 2, 1, 3, 0, 1, 4, 3, 1, 2, 4])
    surface.cell_data["patch"] = [5, 6, 7]
    geometry = sl.as_geometry(surface)
    assert len(geometry.triangles) == 4
    assert sorted(geometry.triangle_attributes["patch"]) == [5, 5, 6, 7]
    corners = geometry.positions[geometry.triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    assert areas.sum() == pytest.approx(surface.area)


def test_pyvista_grids_of_one_layer_are_range_images():
    pyvista = pytest.importorskip("pyvista", reason="PyVista is not installed")
    x, y, z = np.meshgrid(np.arange(4.0), np.arange(3.0), [0.0], indexing="ij")
    geometry = sl.as_geometry(pyvista.StructuredGrid(x, y, z))
    assert geometry.kind == "range_image" and geometry.grid.shape == (3, 4)
    np.testing.assert_array_equal(geometry.positions[geometry.grid[2, 1]], [1, 2, 0])
    assert sl.as_geometry(pyvista.ImageData(dimensions=(3, 3, 3))).kind == "cloud"


def test_laspy_is_read_as_its_file_and_goes_back(data, same_bytes):
    laspy = pytest.importorskip("laspy", reason="the extra [las] is not installed")
    thing = laspy.read(data / "clouds/simple.las")
    geometry, expected = sl.as_geometry(thing), sl.read(data / "clouds/simple.las")
    same_bytes(geometry.positions, expected.positions)
    assert list(geometry.attributes) == list(expected.attributes)
    result = sl.sample(thing, ratio=0.1, method="voxel")
    kept = np.sort(result.indices)
    assert type(result.output) is laspy.LasData
    np.testing.assert_array_equal(result.output.points.array, thing.points.array[kept])


@pytest.mark.parametrize("kind", ["open3d", "trimesh", "pyvista"])
def test_results_come_back_in_the_type_that_came_in(kind, data):
    pytest.importorskip(kind, reason=f"{kind} is not installed")
    mesh = getattr(sl, f"to_{kind}")(sl.read(data / "meshes/fandisk.off"))
    simplified = sl.simplify(mesh, faces=1000, method="qslim").output
    assert type(simplified) is type(mesh)
    assert len(sl.as_geometry(simplified).triangles) in (999, 1000)
    fields = sl.fields(mesh, preset="fast").output
    assert type(fields) is (sl.Geometry if kind == "open3d" else type(mesh))  # whose legacy meshes have no room
    assert "shape_index" in sl.as_geometry(fields).attributes


def test_single_precision_comes_back():
    points = np.random.default_rng(0).random((100, 3)).astype(np.float32)
    result = sl.sample(points, count=10, method="random")
    assert result.output.dtype == np.float32
    np.testing.assert_array_equal(result.output, points[np.sort(result.indices)])


def test_pairs_of_vertices_and_faces():
    geometry = sl.as_geometry((CORNERS, PYRAMID))
    np.testing.assert_array_equal(geometry.triangles, PYRAMID)
    vertices, faces = sl.interop.like((CORNERS.astype(np.float32), PYRAMID), geometry)
    assert vertices.dtype == np.float32 and len(faces) == 6
    simplified = sl.simplify(CORNERS.astype(np.float32), PYRAMID, vertices=5, method="qslim").output
    assert simplified[0].dtype == np.float32 and len(simplified[1]) == 6
    assert "shape_index" in sl.fields((CORNERS, PYRAMID), preset="fast").output.attributes
    assert len(sl.as_geometry(((0, 0, 0), (1, 1, 1)))) == 2  # a pair of points is no such pair


def test_tensors_are_asked_for_an_array():
    class Tensor:
        """As of a device, with gradients."""

        def detach(self):
            return self

        def cpu(self):
            return self

        def numpy(self):
            return CORNERS

        def __array__(self, *args, **kwargs):
            raise TypeError("requires grad")

    assert len(sl.as_geometry(Tensor())) == 5


def test_tables_of_pandas():
    pandas = pytest.importorskip("pandas", reason="pandas is not installed")
    np.testing.assert_array_equal(sl.as_geometry(pandas.DataFrame(CORNERS, columns=list("xyz"))).positions, CORNERS)


def test_what_is_not_understood_is_told(tmp_path):
    for thing in (object(), "missing.ply", np.zeros((3, 2)), {"x": 1}):
        with pytest.raises(sl.Error):
            sl.as_geometry(thing)
    with pytest.raises(sl.InvalidInput, match="faces: only points"):
        sl.as_geometry(pyramid(), PYRAMID)


def test_concatenate_keeps_what_all_have():
    plain = sl.Geometry(CORNERS, attributes={"heat": np.zeros(5)})
    whole = sl.concatenate([pyramid(), plain])
    assert len(whole) == 10 and list(whole.attributes) == ["heat"] and whole.kind == "cloud"
    with pytest.raises(sl.InvalidInput):
        sl.concatenate([])


@pytest.mark.parametrize("library", ["open3d", "trimesh", "pyvista"])
def test_missing_libraries_are_named(library, monkeypatch):
    monkeypatch.setattr("importlib.util.find_spec", lambda name, *rest: None)
    with pytest.raises(ImportError, match=f"pip install {library}"):
        getattr(sl, f"to_{library}")(CORNERS)
