"""Stages by themselves: what they take, refuse and keep alive."""

import gc
import inspect

import numpy as np
import pytest

import shapelight as sl
from shapelight import stages


@pytest.fixture(scope="module")
def mesh(data):
    return sl.read(data / "meshes/fandisk.off")


@pytest.fixture(scope="module")
def graph(mesh):
    return stages.build_graph(mesh)


@pytest.fixture(scope="module")
def ones(graph):
    return np.ones(len(graph))


@pytest.mark.parametrize("look", [lambda g: g.position, lambda g: g.neighbors_of(5)])
def test_arrays_of_a_deleted_graph_stay_valid(mesh, look):
    graph = stages.build_graph(mesh)
    array = look(graph)
    expected = array.copy()
    del graph
    gc.collect()
    others = [stages.build_graph(factor * mesh.positions, mesh.triangles[::-1]) for factor in (2, 3)]
    assert len(others) == 2  # which would have taken freed memory
    np.testing.assert_array_equal(array, expected)


def test_ring_collector_keeps_its_graph(mesh, graph):
    rings = stages.RingCollector(stages.build_graph(mesh))
    gc.collect()
    np.testing.assert_array_equal(rings.collect(5, 1)[1:], graph.neighbors_of(5))
    with pytest.raises(sl.InvalidInput, match="vertex 6475: expected one below 6475"):
        rings.collect(6475, 1)


def test_views_are_read_only_and_shared(graph):
    assert not graph.area.flags.writeable
    assert graph.area.ctypes.data == graph.area.ctypes.data
    assert repr(graph).startswith("SurfaceGraph(6475 vertices, 19419 edges")


def test_maps_between_points_and_vertices(mesh, graph):
    np.testing.assert_array_equal(graph.vertex_of_point[graph.global_id], np.arange(len(graph)))
    np.testing.assert_allclose(graph.position + graph.origin, mesh.positions[graph.global_id], atol=1e-12)


@pytest.mark.parametrize(
    "call",
    [
        lambda g, f: stages.compute_shape_index(g, stages.Curvatures(f, f, f), 0.0),
        lambda g, f: stages.non_local_means(g, f, np.zeros((len(g), 3))),
        lambda g, f: stages.non_local_means(g, np.ones(len(g)), np.zeros((len(f), 3))),
        lambda g, f: stages.decompose_retinex(g, f),
        lambda g, f: stages.segment_field(g, f),
        lambda g, f: stages.sampling_density(g, np.ones(len(g)), f),
        lambda g, f: stages.sample_by_shape(g, f, count=5),
        lambda g, f: stages.sample_paper(g, f, np.zeros(len(g), int), count=5),
        lambda g, f: stages.measure_sampling(g.position, g.position[:9], f),
    ],
)
def test_wrong_length_names_both(graph, call):
    with pytest.raises(sl.InvalidInput, match=r"(?s)6470.*6475|6475.*6470"):
        call(graph, np.ones(6470))


@pytest.mark.parametrize("values", [np.ones(6475) * 1j, np.ones((6475, 1)), ["a"] * 6475, 3.0])
def test_a_field_is_a_row_of_numbers(graph, values):
    with pytest.raises(sl.InvalidInput, match=r"field: shape .* expected \(n,\) numbers"):
        stages.segment_field(graph, values)


def test_labels_are_whole_numbers(graph, ones):
    with pytest.raises(sl.InvalidInput, match="segment: float64, expected whole numbers"):
        stages.sample_paper(graph, ones, ones, count=5)


def test_other_types_are_converted(graph, ones):
    ramp = np.linspace(-1, 1, len(graph)).astype(np.float32)
    expected = stages.segment_field(graph, ramp.astype(np.float64)).label
    strided = np.repeat(ramp, 2)[::2]
    for field in (ramp, strided, ramp.tolist()):
        np.testing.assert_array_equal(stages.segment_field(graph, field).label, expected)


def test_options_are_those_of_the_library(graph):
    parameters = inspect.signature(stages.estimate_curvatures).parameters
    assert parameters["curvature_method"].default == "taubin"
    assert parameters["curvature_method"].kind is inspect.Parameter.KEYWORD_ONLY
    with pytest.raises(TypeError, match="did you mean 'curvature_method'"):
        stages.estimate_curvatures(graph, curvature_metod="quadric")
    with pytest.raises(sl.InvalidInput, match="curvature_method: 'best', expected one of 'taubin'"):
        stages.estimate_curvatures(graph, curvature_method="best")
    with pytest.raises(sl.InvalidInput, match="kind: 'solid', expected one of 'mesh'"):
        stages.compute_fields(graph, "solid")


def test_choosing_the_curvature_method_ends_the_adaptive_choice(graph):
    fields = stages.compute_fields(graph, "mesh", curvature_method="quadric")
    assert (stages.compute_fields(graph, "mesh").curvature_method, fields.curvature_method) == ("taubin", "quadric")


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_threads_do_not_matter(mesh, graph, threads):
    again = stages.build_graph(mesh, threads=threads)
    assert again.position.tobytes() == graph.position.tobytes()
    one, many = (stages.compute_fields(graph, "mesh", threads=n).importance for n in (threads, 0))
    assert one.tobytes() == many.tobytes()
    tree = stages.KdTree(mesh.positions)
    one, many = (tree.within(mesh.positions, 0.1, threads=n) for n in (threads, 0))
    assert all(a.tobytes() == b.tobytes() for a, b in zip(one, many))


def test_progress_ends_at_one_and_its_exception_stops_the_stage(graph, ones):
    seen = []
    stages.compute_fields(graph, "mesh", progress=lambda fraction, phase: seen.append(fraction))
    assert len(seen) > 5 and seen == sorted(seen) and seen[-1] == 1.0
    seen.clear()
    stages.estimate_noise(graph, progress=lambda fraction, phase: seen.append(fraction))
    assert seen == [1.0]

    def fail(fraction, phase):
        raise KeyError(phase)

    with pytest.raises(KeyError):
        stages.compute_fields(graph, "mesh", progress=fail)


def test_samplers_leave_strays_out_unless_given(data):
    scan = sl.read(data / "scans/dragonStandRight_0.ply")
    graph = stages.graph_from_points(scan.positions)
    strays = np.flatnonzero(graph.outlier)
    assert len(strays) > 0
    usable = len(graph) - len(strays)
    assert not np.isin(stages.sample_random(graph, count=usable), strays).any()
    everything = stages.sample_random(graph, count=len(graph), candidates=np.arange(len(graph)))
    assert np.isin(strays, everything).all()
    with pytest.raises(sl.InvalidInput, match=f"expected at most {usable}"):
        stages.sample_random(graph, count=usable + 1)


def test_a_sampler_takes_one_target(graph):
    for target in ({}, {"count": 5, "spacing": 0.1}):
        with pytest.raises(sl.InvalidInput, match="exactly one of count and spacing"):
            stages.sample_voxel(graph, **target)
    for count in (0, -3):
        with pytest.raises(sl.InvalidInput, match=f"count: {count}, expected at least 1"):
            stages.sample_farthest(graph, count=count)
    for candidates in ([3, 2], [0, 6475]):
        with pytest.raises(sl.InvalidInput, match="expected ascending vertices below 6475"):
            stages.sample_farthest(graph, count=1, candidates=candidates)
    assert len(stages.sample_farthest(graph, count=np.int64(4))) == 4
