"""simplify(), metrics(), register() and align(): what they take, promise and refuse."""

import numpy as np
import pytest

import shapelight as sl


@pytest.fixture(scope="module")
def bunny(data):
    return sl.read(data / "meshes/bunny.ply")


@pytest.fixture(scope="module")
def scans(data):
    return [sl.read(data / f"scans/dragonStandRight_{angle}.ply") for angle in (0, 24)]


def test_simplify_gives_back_what_came_in(bunny):
    from_arrays = sl.simplify(bunny.positions, bunny.triangles, ratio="5%", preset="fast")
    vertices, faces = from_arrays.output
    assert len(vertices) == round(0.05 * len(bunny)) and faces.max() < len(vertices)
    from_geometry = sl.simplify(bunny, ratio=0.05, preset="fast")
    assert isinstance(from_geometry.output, sl.Geometry)
    assert set(from_geometry.output.attributes) == set(bunny.attributes)
    np.testing.assert_array_equal(from_geometry.vertices, vertices)


def test_vertices_of_placement_input_are_input_vertices(bunny):
    result = sl.simplify(bunny, faces=2000, method="qslim")
    np.testing.assert_array_equal(result.vertices, bunny.positions[result.source_vertex])
    assert abs(len(result.faces) - 2000) <= 1


def test_lengths_may_be_shares_of_the_diagonal(bunny):
    by_share = sl.simplify(bunny, max_error="2%", method="qslim")
    by_length = sl.simplify(bunny, max_error=0.02 * bunny.diagonal, method="qslim")
    np.testing.assert_array_equal(by_share.source_vertex, by_length.source_vertex)
    assert by_share.measured.symmetric.max <= 0.02 * bunny.diagonal
    with pytest.raises(sl.InvalidInput, match="max_error: 'much'"):
        sl.simplify(bunny, max_error="much")


def test_arrays_by_keyword_are_told_where_they_belong(bunny):
    with pytest.raises(sl.InvalidInput, match="by position"):
        sl.simplify(bunny.positions, faces=bunny.triangles, ratio=0.1)


def test_too_few_faces_are_unreachable(bunny):
    with pytest.raises(sl.TargetUnreachable) as caught:
        sl.simplify(bunny, vertices=10**6)
    assert caught.value.reachable > 30000


def test_partial_results_say_so(bunny):
    most = sl.simplify(bunny, vertices="10M", allow_partial=True, method="qslim")
    assert most.is_partial and len(most.vertices) == 34834
    all_points = sl.sample(bunny, count="50k", method="random", allow_partial=True)
    assert all_points.is_partial and len(all_points.indices) == len(bunny)
    assert not sl.sample(bunny, count=10, method="random", allow_partial=True).is_partial


def test_memory_is_refused_before_work_starts(bunny, scans):
    for job in (
        lambda: sl.sample(bunny, ratio=0.1, max_memory="1M"),
        lambda: sl.fields(bunny, max_memory=10**6),
        lambda: sl.simplify(bunny, ratio=0.1, max_memory="10M"),
        lambda: sl.register(*scans, max_memory="10M"),
        lambda: sl.align(scans, max_memory="10M"),
    ):
        with pytest.raises(sl.BudgetExceeded) as caught:
            job()
        assert caught.value.code == 7


def test_relative_distances_are_shares_of_the_diagonal(bunny):
    distance = sl.metrics(bunny, sl.simplify(bunny, ratio=0.1, method="qslim").geometry, samples=1000)
    assert distance.relative.symmetric.max == distance.symmetric.max / distance.diagonal
    assert distance.rmse == distance.forward.rms
    assert 0 < distance.normal_deviation_deg.rms < 90


def test_a_mesh_is_no_distance_from_itself(bunny):
    distance = sl.metrics(bunny, bunny, samples=1000)
    assert distance.symmetric.max < 1e-9 * bunny.diagonal
    assert "forward=DistanceSummary(mean=" in repr(distance)


def test_register_brings_the_source_onto_the_target(scans):
    target, source = scans
    result = sl.register(source, target)
    moved = result.output
    np.testing.assert_allclose(
        moved.positions, source.positions @ result.T_target_source[:3, :3].T + result.T_target_source[:3, 3], atol=1e-12
    )
    again = sl.register(moved, target, init=np.eye(4))
    assert np.abs(again.T_target_source - np.eye(4)).max() < 1e-3
    assert again.hypotheses == 0


def test_a_doubtful_pose_is_withheld(scans, bunny):
    with pytest.raises(sl.PostconditionFailed, match="confidence") as caught:
        sl.register(scans[0], bunny)
    assert caught.value.code == 6
    assert caught.value.result.confidence < 0.5
    assert sl.register(scans[0], bunny, min_confidence=0).T_target_source.shape == (4, 4)


def test_init_must_be_rigid(scans):
    with pytest.raises(sl.InvalidInput, match="rigid"):
        sl.register(scans[1], scans[0], init=2.0 * np.eye(4))
    with pytest.raises(sl.InvalidInput, match="shape"):
        sl.register(scans[1], scans[0], init=np.eye(3))


def test_align_places_scans_and_withholds_what_does_not_fit(scans, bunny):
    result = sl.align([*scans, bunny], merged=False, allow_partial=True)
    assert result.num_placed == 2 and result.merged is None
    assert np.isnan(result.poses[2]).all() and np.isfinite(result.poses[:2]).all()
    with pytest.raises(sl.PostconditionFailed, match="2 of 3 scans"):
        sl.align([*scans, bunny], merged=False)
    with pytest.raises(sl.InvalidInput, match="two or more"):
        sl.align(scans[:1])
