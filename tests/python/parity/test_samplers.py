"""Every sampler chooses the vertices that it chooses in C++, in the same order."""

import numpy as np
import pytest

from shapelight import stages


@pytest.fixture(scope="module")
def graph(data):
    return stages.build_graph(data / "meshes/fandisk.off")


@pytest.fixture(scope="module")
def even(graph):
    return np.arange(0, len(graph), 2)


@pytest.fixture(scope="module")
def field(graph):
    return np.arange(len(graph)) % 7


@pytest.fixture(scope="module")
def signed_field(graph):
    return (np.arange(len(graph)) % 5) * 0.5 - 1.0


@pytest.mark.parametrize(
    "name, options",
    [
        ("sample_random", {"seed": 7, "random_area_weighted": True}),
        ("sample_voxel.count", {"voxel_fill_share": 0.3}),
        ("sample_stratified.count", {"stratified_suppression": 0.2}),
        ("sample_poisson.count", {"seed": 7, "poisson_passes": 1}),
        ("sample_normal_space", {"normal_collars": 5}),
        ("sample_covariance", {}),
        ("sample_farthest.count", {}),
    ],
)
def test_count_among_candidates(graph, even, name, options, cpp, same_bytes):
    sampler = getattr(stages, name.split(".")[0])
    same_bytes(sampler(graph, count=300, candidates=even, **options), cpp(name, np.uint32))


@pytest.mark.parametrize(
    "name, options",
    [
        ("sample_voxel", {}),
        ("sample_stratified", {"seed": 7}),
        ("sample_poisson", {"seed": 7}),
        ("sample_farthest", {}),
    ],
)
def test_spacing_among_all(graph, name, options, cpp, same_bytes):
    same_bytes(getattr(stages, name)(graph, spacing=0.2, **options), cpp(f"{name}.spacing", np.uint32))


def test_sample_by_shape(graph, even, field, cpp, same_bytes):
    chosen = stages.sample_by_shape(graph, field, count=300, candidates=even, local_weight=0.9)
    same_bytes(chosen, cpp("sample_by_shape.count", np.uint32))
    same_bytes(stages.sample_by_shape(graph, field, spacing=0.2), cpp("sample_by_shape.spacing", np.uint32))


def test_sample_paper(graph, even, signed_field, cpp, same_bytes):
    label = np.arange(len(graph)) // 1000
    chosen = stages.sample_paper(graph, signed_field, label, count=300, candidates=even, local_weight=0.3)
    same_bytes(chosen, cpp("sample_paper", np.uint32))


def test_sampling_density(graph, field, signed_field, cpp, same_bytes):
    raised = np.arange(len(graph)) % 11 + 1
    same_bytes(stages.sampling_density(graph, field, raised, noisy=True), cpp("sampling_density", np.float64))
    modulated = stages.sampling_density(graph, field, raised, signed_field, field)
    same_bytes(modulated, cpp("sampling_density.modulated", np.float64))
