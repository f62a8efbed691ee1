"""C++ and Python give the same bytes: the parts of registration."""

import numpy as np
import pytest

import shapelight as sl
from shapelight import stages


@pytest.fixture(scope="module")
def T(data):
    return sl.read_transform(data / "scans/T_dragonStandRight_24_to_0.txt")


@pytest.fixture(scope="module")
def source(data):
    return stages.prepare_scan(data / "scans/dragonStandRight_24.ply")


@pytest.fixture(scope="module")
def target(data):
    return stages.prepare_scan(data / "scans/dragonStandRight_0.ply")


def in_input_frame(scan):
    clouds = [stages.RegistrationCloud(c.position + scan.origin, c.normal) for c in (scan.full, scan.samples)]
    return stages.ScanView(*clouds)


@pytest.fixture(scope="module")
def moving(source):
    return in_input_frame(source)


@pytest.fixture(scope="module")
def fixed(target):
    return in_input_frame(target)


def numbers(*values):
    return np.array(values, dtype=np.float64)


def test_prepare_scan(source, cpp, same_bytes):
    same_bytes(source.origin, cpp("prepare_scan.origin", np.float64))
    same_bytes(source.full.position, cpp("prepare_scan.full", np.float64))
    same_bytes(source.full.normal, cpp("prepare_scan.normal", np.float64))
    same_bytes(source.samples.position, cpp("prepare_scan.samples", np.float64))
    same_bytes(source.keypoints, cpp("prepare_scan.keypoints", np.uint32))


def test_register_prepared(source, target, T, cpp, same_bytes):
    result = stages.register_prepared(source, target, init=T)
    same_bytes(result.T_target_source, cpp("register_prepared", np.float64))
    same_bytes(numbers(result.confidence), cpp("register_prepared.confidence", np.float64))


def test_coarse_alignment(source, target, cpp, same_bytes):
    spacing = max(stages.coarse_spacing(source.full), stages.coarse_spacing(target.full))
    same_bytes(numbers(spacing), cpp("coarse_spacing", np.float64))
    described = [stages.describe_points(scan.full, scan.keypoints, spacing) for scan in (source, target)]
    for name, dtype in (("position", float), ("normal", float), ("descriptor", np.float32), ("keypoints", np.uint32)):
        same_bytes(getattr(described[0], name), cpp(f"describe_points.{name}", dtype))
    hypotheses = stages.align_coarsely(*described, same_side=True, max_hypotheses=3)
    same_bytes(hypotheses[0].T_target_source, cpp("align_coarsely", np.float64))
    same_bytes(numbers(*[h.support for h in hypotheses]), cpp("align_coarsely.support", np.float64))


def test_registration_cloud(moving, cpp, same_bytes):
    same_bytes(numbers(moving.samples.spacing, moving.samples.diagonal), cpp("registration_cloud", np.float64))


@pytest.mark.parametrize(
    "name, options",
    [
        ("register_by_icp", {"metric": "gicp"}),
        ("register_by_ficp", {"lambda_": 1.0}),
        ("register_by_soft_icp", {"candidates": 2}),
    ],
)
def test_methods(name, options, moving, fixed, T, cpp, same_bytes):
    result = getattr(stages, name)(moving.samples, fixed.samples, T, **options)
    same_bytes(result.T_target_source, cpp(name, np.float64))
    same_bytes(result.error, cpp(f"{name}.error", np.float64))
    same_bytes(numbers(result.iterations, result.inlier_ratio, result.rms), cpp(f"{name}.numbers", np.float64))


def test_assess_pose(moving, fixed, T, cpp, same_bytes):
    pose = stages.assess_pose(moving.full, fixed.full, T, rivals=[0.5])
    found = numbers(pose.confidence, pose.overlap, pose.residual, pose.gate, pose.mean_error, pose.std_error,
                    pose.rival_weight)
    same_bytes(found, cpp("assess_pose", np.float64))
    same_bytes(pose.covariance.T, cpp("assess_pose.covariance", np.float64))


def test_joint_refinement(moving, fixed, T, cpp, same_bytes):
    fit = stages.measure_fit(fixed, moving, T, max_distance=4.0)
    same_bytes(numbers(fit.overlap, fit.matches, fit.rms), cpp("measure_fit", np.float64))
    result = stages.refine_jointly([fixed, moving], [(0, 1)], [np.eye(4), T])
    same_bytes(result.T_world_scan[1], cpp("refine_jointly", np.float64))


def test_pose_graph(T, cpp, same_bytes):
    covariance = np.eye(6) * 0.25
    edges = [stages.PoseGraphEdge(t, s, T, covariance, 0.9) for t, s in ((0, 1), (0, 2), (1, 2))]
    graph = stages.optimize_pose_graph(3, edges, min_confidence=0.1)
    for i, pose in enumerate(graph.T_world_scan):
        same_bytes(pose, cpp(f"pose_graph.{i}", np.float64))
    same_bytes(numbers(graph.chi_sq_before, graph.chi_sq_after), cpp("pose_graph.chi_sq", np.float64))
    off = stages.measure_disagreement(edges[2], [np.eye(4), T, T])
    same_bytes(numbers(off.rotation, off.translation, off.chi_sq), cpp("measure_disagreement", np.float64))
