"""Figures of the stage-level metrics are those of the C++ library, byte for byte."""

import dataclasses

import numpy as np
import pytest

import shapelight as sl
from shapelight import stages


@pytest.fixture(scope="module")
def mesh(data):
    return sl.read(data / "meshes/fandisk.off")


@pytest.fixture(scope="module")
def moved(mesh):
    return sl.Geometry(1.25 * mesh.positions, mesh.triangles)


def test_measure_sampling(mesh, cpp, same_bytes):
    importance = np.arange(len(mesh)) % 11
    q = stages.measure_sampling(mesh.positions, mesh.positions[::9], importance)
    same_bytes(np.array([q.coverage_max, q.coverage_mean]), cpp("measure_sampling.coverage", np.float64))
    feature = [q.feature_coverage_max, q.feature_coverage_mean, q.feature_share]
    same_bytes(np.array(feature), cpp("measure_sampling.feature", np.float64))
    same_bytes(np.array([q.spacing_mean, q.spacing_min, q.spacing_cv]), cpp("measure_sampling.spacing", np.float64))


def test_surface_variation_knn(mesh, cpp, same_bytes):
    same_bytes(stages.surface_variation_knn(mesh.positions, 12), cpp("surface_variation_knn", np.float64))


def test_measure_surface_distance(mesh, moved, cpp, same_bytes):
    found = stages.measure_surface_distance(mesh, moved, samples=5000, seed=3)
    for name in ("forward", "backward", "symmetric", "normal_deviation_deg"):
        figures = np.array(dataclasses.astuple(getattr(found, name)))
        same_bytes(figures, cpp(f"measure_surface_distance.{name}", np.float64))
    for name in ("vertex_rms", "diagonal"):
        same_bytes(getattr(found, name), cpp(f"measure_surface_distance.{name}", np.float64))
    assert found.samples == cpp("measure_surface_distance.samples", np.uint64)


def test_vertex_distances(mesh, moved, cpp, same_bytes):
    distances = stages.vertex_distances(mesh, stages.TriangleTree(moved))
    same_bytes(distances, cpp("vertex_distances", np.float64))
