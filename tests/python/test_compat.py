"""compat against Open3D itself."""

import numpy as np
import pytest

import shapelight as sl
from shapelight import compat

open3d = pytest.importorskip("open3d", reason="Open3D is not installed")
theirs = open3d.pipelines.registration
DISTANCE = 0.005


@pytest.fixture(scope="module")
def scans(data):
    """Two scans of the dragon, with normals, and a starting pose beside the true one."""
    clouds = []
    for name in ("dragonStandRight_24", "dragonStandRight_0"):
        scan = sl.read(data / f"scans/{name}.ply")
        cloud = sl.to_open3d(scan.positions[::4].copy())
        cloud.estimate_normals()
        clouds.append(cloud)
    init = sl.read_transform(data / "scans/T_dragonStandRight_24_to_0.txt")
    init[:3, 3] += 0.001
    return *clouds, init


@pytest.fixture(scope="module")
def cloud(scans):
    return scans[0]


METHODS = ["PointToPoint", "PointToPlane", "ForGeneralizedICP"]


@pytest.mark.parametrize("method", METHODS)
def test_icp_ends_where_open3d_ends(scans, method):
    name = f"TransformationEstimation{method}"
    register = "registration_generalized_icp" if method == METHODS[2] else "registration_icp"
    criteria = theirs.ICPConvergenceCriteria(1e-9, 1e-9, 100)
    expected = getattr(theirs, register)(*scans[:2], DISTANCE, scans[2], getattr(theirs, name)(), criteria)
    actual = getattr(compat, register)(*scans[:2], DISTANCE, scans[2], getattr(compat, name)(), criteria)
    np.testing.assert_allclose(actual.transformation, expected.transformation, atol=2e-4)
    assert actual.fitness == pytest.approx(expected.fitness, abs=1e-3)
    assert actual.inlier_rmse == pytest.approx(expected.inlier_rmse, rel=5e-3)


def test_open3d_estimation_objects_are_taken(scans):
    results = [
        compat.registration_icp(*scans[:2], DISTANCE, scans[2], made.TransformationEstimationPointToPlane())
        for made in (compat, theirs)
    ]
    np.testing.assert_array_equal(results[0].transformation, results[1].transformation)


def test_the_iteration_limit_is_kept(scans):
    poses = [
        compat.registration_icp(*scans[:2], DISTANCE, scans[2], criteria=compat.ICPConvergenceCriteria(max_iteration=n))
        for n in (1, 30)
    ]
    assert not np.allclose(poses[0].transformation, poses[1].transformation, atol=1e-6)


def test_large_offsets_cost_no_precision(scans):
    source, target, init = scans
    near = compat.registration_icp(source, target, DISTANCE, init)
    offset = np.array([5e5, 4e6, 100.0])
    far = [open3d.geometry.PointCloud(cloud).translate(offset) for cloud in (source, target)]
    T = np.eye(4)
    T[:3, 3] = offset
    found = compat.registration_icp(*far, DISTANCE, T @ init @ np.linalg.inv(T)).transformation
    np.testing.assert_allclose(np.linalg.inv(T) @ found @ T, near.transformation, atol=1e-6)


def test_evaluation_is_open3ds(scans):
    expected = theirs.evaluate_registration(*scans[:2], DISTANCE, scans[2])
    actual = compat.evaluate_registration(*scans[:2], DISTANCE, scans[2])
    pairs = np.asarray(expected.correspondence_set)
    np.testing.assert_array_equal(actual.correspondence_set, pairs[np.argsort(pairs[:, 0])])
    assert actual.fitness == expected.fitness
    assert actual.inlier_rmse == pytest.approx(expected.inlier_rmse, rel=1e-12)


def test_points_that_are_not_finite_are_left_out(scans):
    source = np.asarray(scans[0].points).copy()
    source[7] = np.nan
    found = compat.evaluate_registration(source, scans[1], DISTANCE, scans[2])
    assert 7 not in found.correspondence_set[:, 0] and found.correspondence_set[:, 0].max() > 7
    distances = compat.compute_point_cloud_distance(source, scans[1])
    assert np.flatnonzero(np.isnan(distances)).tolist() == [7]


def test_nothing_near_is_no_error(scans):
    far = np.eye(4)
    far[0, 3] = 100.0
    found = compat.evaluate_registration(*scans[:2], DISTANCE, far)
    assert found.fitness == 0.0 and found.inlier_rmse == 0.0 and found.correspondence_set.shape == (0, 2)


def test_normals_are_asked_for_or_estimated(scans):
    bare = [np.asarray(cloud.points).copy() for cloud in scans[:2]]
    with pytest.raises(sl.InvalidInput, match="target: point to plane needs normals"):
        compat.registration_icp(*bare, DISTANCE, scans[2], compat.TransformationEstimationPointToPlane())
    bare[0][3] = np.nan
    found = compat.registration_generalized_icp(*bare, DISTANCE, scans[2])
    expected = compat.registration_generalized_icp(*scans[:2], DISTANCE, scans[2])
    np.testing.assert_allclose(found.transformation, expected.transformation, atol=2e-3)


def test_what_is_not_offered_is_refused(scans):
    kernel = theirs.TransformationEstimationPointToPlane(theirs.TukeyLoss(0.1))
    for method in (kernel, compat.TransformationEstimationPointToPoint(with_scaling=True), object()):
        with pytest.raises(sl.InvalidInput, match="estimation_method"):
            compat.registration_icp(*scans[:2], DISTANCE, scans[2], method)
    with pytest.raises(sl.InvalidInput, match="expected more than 0"):
        compat.registration_icp(*scans[:2], 0.0)


def test_one_input_point_for_each_voxel(cloud):
    thin = compat.voxel_down_sample(cloud, 0.004)
    assert type(thin) is open3d.geometry.PointCloud and thin.has_normals()
    given = {tuple(p) for p in np.asarray(cloud.points)}
    assert all(tuple(p) in given for p in np.asarray(thin.points))
    assert len(thin.points) == pytest.approx(len(cloud.voxel_down_sample(0.004).points), rel=0.05)


def test_down_sampling_keeps_as_many_as_open3d(cloud):
    assert len(compat.random_down_sample(cloud, 0.1).points) == len(cloud.random_down_sample(0.1).points)
    assert len(compat.random_down_sample(cloud, 0.0).points) == 0
    for k in (1, 7):
        expected = np.asarray(cloud.uniform_down_sample(k).points)
        np.testing.assert_array_equal(np.asarray(compat.uniform_down_sample(cloud, k).points), expected)
    assert len(compat.farthest_point_down_sample(cloud, 50).points) == 50


def test_random_samples_follow_the_seed(cloud):
    samples = [np.asarray(compat.random_down_sample(cloud, 0.1, seed=s).points) for s in (0, 0, 1)]
    np.testing.assert_array_equal(samples[0], samples[1])
    assert not np.array_equal(samples[0], samples[2])


def test_distances_are_open3ds(scans):
    expected = np.asarray(scans[0].compute_point_cloud_distance(scans[1]))
    np.testing.assert_allclose(compat.compute_point_cloud_distance(*scans[:2]), expected, rtol=1e-12)


def test_decimation_reaches_the_count(data):
    mesh = sl.to_open3d(sl.read(data / "meshes/fandisk.off"))
    small = compat.simplify_quadric_decimation(mesh, 1000)
    assert type(small) is open3d.geometry.TriangleMesh
    assert len(small.triangles) in (999, 1000) and small.is_edge_manifold()
    with pytest.raises(sl.InvalidInput, match="max_error"):
        compat.simplify_quadric_decimation(mesh, 1000, 0.1)


def test_bad_numbers_are_refused(cloud):
    for call in (
        lambda: compat.random_down_sample(cloud, 1.5),
        lambda: compat.uniform_down_sample(cloud, 0),
        lambda: compat.voxel_down_sample(cloud, 0.0),
        lambda: compat.farthest_point_down_sample(cloud, 0),
    ):
        with pytest.raises(sl.InvalidInput):
            call()
