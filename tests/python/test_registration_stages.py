"""Registration, virtual scans and simplification by themselves: what goes in, what comes out, what is refused."""

import numpy as np
import pytest

import shapelight as sl
from shapelight import stages


@pytest.fixture(scope="module")
def bunny(data):
    return sl.simplify(data / "meshes/bunny.ply", vertices=3000, method="qslim").output


@pytest.fixture(scope="module")
def pair(bunny):
    return stages.scan_pair(bunny, overlap=0.8, width=120, height=120)


@pytest.fixture(scope="module")
def clouds(pair):
    scans = [stages.prepare_scan(scan.geometry) for scan in (pair.source, pair.target)]
    return [stages.RegistrationCloud(s.full.position + s.origin, s.full.normal) for s in scans]


def off(T, truth, cloud):
    """[input length unit] how far a cloud is moved away from its true place, on average."""
    wrong = T @ np.linalg.inv(truth)
    placed = cloud.position @ truth[:3, :3].T + truth[:3, 3]
    return np.linalg.norm(placed @ wrong[:3, :3].T + wrong[:3, 3] - placed, axis=1).mean()


@pytest.mark.parametrize("method", ["register_by_icp", "register_by_ficp", "register_by_soft_icp"])
def test_methods_find_the_true_pose_from_near_it(method, clouds, pair):
    start = pair.T_target_source.copy()
    start[:3, 3] += 0.01
    result = getattr(stages, method)(*clouds, start)
    assert result.converged and len(result.error) == result.iterations
    truth = pair.T_target_source
    assert off(result.T_target_source, truth, clouds[0]) < 0.2 * off(start, truth, clouds[0])


def test_the_true_pose_is_trusted_and_another_is_not(clouds, pair):
    assert stages.assess_pose(*clouds, pair.T_target_source).confidence > 0.5
    wrong = pair.T_target_source @ np.diag([-1.0, 1, -1, 1])
    assert stages.assess_pose(*clouds, wrong).confidence < 0.5


def test_prepared_scans_register_as_scans_do(pair):
    scans = [stages.prepare_scan(scan.geometry, seed=1) for scan in (pair.source, pair.target)]
    prepared = stages.register_prepared(*scans)
    result = sl.register(pair.source.geometry, pair.target.geometry, seed=1)
    np.testing.assert_array_equal(prepared.T_target_source, result.T_target_source)
    assert len(prepared.output) == len(pair.source.geometry)


def test_a_cloud_shows_its_points_without_a_copy(clouds):
    cloud = clouds[0]
    assert cloud.position.ctypes.data == cloud.position.ctypes.data
    assert not cloud.position.flags.writeable
    assert cloud.position.shape == cloud.normal.shape == (len(cloud), 3)
    assert cloud.viewpoint is None and "with normals" in repr(cloud)
    alone = stages.RegistrationCloud([[0, 0, 0], [0, 2, 0]], viewpoint=[1, 2, 3])
    assert alone.spacing == 2 and list(alone.viewpoint) == [1, 2, 3] and alone.normal.shape == (0, 3)


def test_points_outlive_their_cloud():
    position = stages.RegistrationCloud(np.arange(30.0).reshape(10, 3)).position
    np.testing.assert_array_equal(position, np.arange(30.0).reshape(10, 3))


def test_poses_of_a_loop_agree():
    turn = np.array([[0.0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    edges = [stages.PoseGraphEdge(i, (i + 1) % 4, turn) for i in range(4)]
    graph = stages.optimize_pose_graph(4, edges)
    assert graph.T_world_scan.shape == (4, 4, 4) and graph.num_groups == 1
    assert [edge.use for edge in graph.edges] == ["used"] * 4
    np.testing.assert_allclose(graph.T_world_scan[2], np.diag([-1.0, -1, 1, 1]), atol=1e-9)
    assert stages.measure_disagreement(edges[0], graph.T_world_scan).chi_sq < 1e-12


def test_joint_refinement_closes_gaps(clouds, pair):
    views = [stages.ScanView(cloud, cloud) for cloud in clouds]
    moved = pair.T_target_source.copy()
    moved[:3, 3] += 0.001
    before = stages.measure_fit(views[1], views[0], moved)
    result = stages.refine_jointly(views[::-1], [(0, 1)], [np.eye(4), moved])
    after = stages.measure_fit(views[1], views[0], result.T_world_scan[1])
    assert result.converged and after.rms < 0.5 * before.rms


def test_virtual_scans_lie_on_the_mesh(bunny, pair):
    scan = pair.target
    back = scan.geometry.transformed(scan.T_mesh_scan)
    assert scan.geometry.kind == "range_image" and scan.geometry.grid.shape == (120, 120)
    assert np.nanmax(sl.metrics(bunny, back, distances=True).distances) < 1e-9
    found = stages.scan_overlap(pair.source.geometry, pair.target.geometry, pair.T_target_source)
    assert abs(found - 0.8) <= 0.011


def test_features_survive(data):
    mesh = sl.read(data / "meshes/fandisk.off")
    edges = mesh.triangles[:40, :2]
    kept = stages.simplify_qslim(mesh, vertices="500", features=edges).source_vertex
    plain = stages.simplify_qslim(mesh, vertices=500).source_vertex
    assert np.isin(edges, kept).mean() > np.isin(edges, plain).mean() + 0.1


BAD = {
    "expected exactly one target": lambda m, c: stages.simplify_qslim(m),
    "vertices: -3, expected at least 1": lambda m, c: stages.simplify_ssim(m, vertices=-3),
    "sample 9999 >= 3000 vertices": lambda m, c: stages.simplify_ssim(m, vertices=100, samples=[9999]),
    "2 denoised positions": lambda m, c: stages.simplify_ssim(m, vertices=100, denoised=[[0, 0, 0]] * 2),
    r"features: shape \(1, 3\)": lambda m, c: stages.simplify_qslim(m, vertices=100, features=[[1, 2, 3]]),
    "point 0 is not finite": lambda m, c: stages.RegistrationCloud([[np.nan, 0, 0]]),
    "normals": lambda m, c: stages.RegistrationCloud([[1, 0, 0]], [[1, 0, 0]] * 2),
    "viewpoint: shape": lambda m, c: stages.RegistrationCloud([[1, 0, 0]], viewpoint=[1, 2]),
    r"shape \(3, 3\), expected \(4, 4\)": lambda m, c: stages.register_by_icp(*c, np.eye(3)),
    "expected a rigid motion": lambda m, c: stages.register_by_icp(*c, 2 * np.eye(4)),
    "metric: 'area', expected one of": lambda m, c: stages.register_by_icp(*c, np.eye(4), metric="area"),
    "keypoint 5 >= 2 points": lambda m, c: stages.align_coarsely(*[described(keypoints=[5])] * 2),
    "2 positions, 1 normals": lambda m, c: stages.align_coarsely(*[described(normal=[[0, 0, 1]])] * 2),
    "edge 0": lambda m, c: stages.optimize_pose_graph(2, [stages.PoseGraphEdge(0, 2, np.eye(4))]),
    "scans below 1": lambda m, c: stages.measure_disagreement(stages.PoseGraphEdge(0, 1, np.eye(4)), [np.eye(4)]),
    "scan 1 has no normals": lambda m, c: stages.measure_fit(
        stages.ScanView(*c), stages.ScanView(*[stages.RegistrationCloud(np.eye(3))] * 2), np.eye(4)),
    "field of view": lambda m, c: stages.virtual_scan(m, stages.VirtualCamera(field_of_view=4.0)),
    "triangle tree: 0 triangles": lambda m, c: stages.virtual_scan(m.positions, stages.VirtualCamera()),
}


def described(**changes):
    points = {"spacing": 1.0, "position": np.zeros((2, 3)), "normal": np.zeros((2, 3)),
              "descriptor": np.zeros((2, 33)), "keypoints": [0]}
    return stages.DescribedPoints(**{**points, **changes})


@pytest.mark.parametrize("message", BAD)
def test_bad_input_is_told(message, bunny, clouds):
    with pytest.raises(sl.InvalidInput, match=message):
        BAD[message](bunny, clouds)
