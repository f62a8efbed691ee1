"""Fields by every stage are those of the C++ library, byte for byte."""

import numpy as np
import pytest

from shapelight import stages

METHODS = ["taubin", "quadric", "normal-field"]  # in the order of the C++ enumeration


@pytest.fixture(scope="module")
def graph(data):
    return stages.build_graph(data / "meshes/fandisk.off")


@pytest.fixture(scope="module")
def curvatures(graph):
    return stages.estimate_curvatures(
        graph, curvature_method="quadric", curvature_passes=2, curvature_neighbors=15
    )


@pytest.fixture
def shape_index(cpp):
    return cpp("compute_shape_index", np.float64)


@pytest.mark.parametrize("name", ["k1", "k2", "direction1"])
def test_estimate_curvatures(curvatures, name, cpp, same_bytes):
    same_bytes(getattr(curvatures, name), cpp(f"estimate_curvatures.{name}", np.float64))


def test_curvedness(curvatures, cpp, same_bytes):
    same_bytes(stages.curvedness(curvatures.k1, curvatures.k2), cpp("curvedness", np.float64))
    same_bytes(curvatures.curvedness, cpp("curvedness", np.float64))


def test_estimate_noise(graph, cpp, same_bytes):
    same_bytes(stages.estimate_noise(graph), cpp("estimate_noise", np.float64))


def test_compute_shape_index(graph, curvatures, shape_index, same_bytes):
    sigma = stages.estimate_noise(graph)
    same_bytes(stages.compute_shape_index(graph, curvatures, sigma, flatness=0.1), shape_index)


def test_compute_surface_variation(graph, cpp, same_bytes):
    variation = stages.compute_surface_variation(graph, variation_method="diffusion", variation_neighbors=40)
    same_bytes(variation, cpp("compute_surface_variation", np.float64))


def test_non_local_means(graph, curvatures, shape_index, cpp, same_bytes):
    smooth = stages.non_local_means(graph, shape_index, curvatures.direction1, nlm_rings=2)
    same_bytes(smooth, cpp("non_local_means", np.float64))


def test_smooth_positions(graph, cpp, same_bytes):
    same_bytes(stages.smooth_positions(graph, smoothing_iterations=3), cpp("smooth_positions", np.float64))


def test_decompose_retinex(graph, shape_index, cpp, same_bytes):
    split = stages.decompose_retinex(graph, shape_index, retinex_sigma=4.0)
    same_bytes(split.illumination, cpp("decompose_retinex.illumination", np.float64))
    same_bytes(split.reflectance, cpp("decompose_retinex.reflectance", np.float64))


def test_segment_field(graph, cpp, same_bytes):
    cut = stages.segment_field(graph, cpp("decompose_retinex.reflectance", np.float64), segment_min_points=50)
    same_bytes(cut.label, cpp("segment_field.label", np.uint32))
    assert cut.count == cpp("segment_field.count", np.uint64)


@pytest.mark.parametrize(
    "case, kind, options",
    [("compute_fields", "mesh", {}), ("compute_fields.paper", "cloud", {"preset": "paper", "curvature_passes": 3})],
)
def test_compute_fields(graph, case, kind, options, cpp, same_bytes):
    fields = stages.compute_fields(graph, kind, **options)
    arrays = "k1 k2 curvedness shape_index surface_variation illumination reflectance importance noise"
    for name in arrays.split():
        same_bytes(getattr(fields, name), cpp(f"{case}.{name}", np.float64))
    same_bytes(fields.segment, cpp(f"{case}.segment", np.uint32))
    assert fields.num_segments == cpp(f"{case}.num_segments", np.uint64)
    assert fields.denoised == cpp(f"{case}.denoised", np.uint8)
    assert fields.curvature_passes == cpp(f"{case}.curvature_passes", np.int32)
    assert METHODS.index(fields.curvature_method) == cpp(f"{case}.curvature_method", np.uint8)
