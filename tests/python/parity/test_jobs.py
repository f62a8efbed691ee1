"""C++ and Python give the same bytes for the same job."""

import numpy as np
import pytest

import shapelight as sl

SIDES = ("forward", "backward", "symmetric")


@pytest.fixture(scope="module")
def fandisk(data):
    return sl.read(data / "meshes/fandisk.off")


@pytest.fixture(scope="module")
def simplified(fandisk):
    options = {"preset": "fast", "placement": "optimal", "measure": True}
    return sl.simplify(fandisk.positions, fandisk.triangles, ratio="20%", **options)


def summary(distance):
    return np.array([distance.mean, distance.rms, distance.max])


def test_sample(cpp, data, same_bytes, fandisk):
    same_bytes(sl.sample(data / "scans/dragonStandRight_0.ply", ratio=0.05).indices, cpp("sample", np.uint32))
    same_bytes(sl.sample(fandisk, count=500, preset="paper").indices, cpp("sample.paper", np.uint32))


def test_fields(cpp, same_bytes, fandisk):
    fields = sl.fields(fandisk)
    for name in ("shape_index", "curvedness", "illumination", "reflectance", "importance"):
        same_bytes(getattr(fields, name), cpp(f"fields.{name}", np.float32))
    same_bytes(fields.segment, cpp("fields.segment", np.int32))


def test_simplify(cpp, same_bytes, simplified):
    same_bytes(simplified.vertices, cpp("simplify.vertices", np.float64))
    same_bytes(simplified.faces, cpp("simplify.faces", np.uint32))
    same_bytes(simplified.source_vertex, cpp("simplify.source_vertex", np.uint32))
    for side in SIDES:
        same_bytes(summary(getattr(simplified.measured, side)), cpp(f"simplify.measured.{side}", np.float64))


def test_metrics(cpp, data, same_bytes, fandisk, simplified):
    distance = sl.metrics(fandisk, simplified.output, samples=20000, seed=3, distances=True)
    for side in SIDES:
        same_bytes(summary(getattr(distance, side)), cpp(f"metrics.{side}", np.float64))
    same_bytes(distance.distances, cpp("metrics.distances", np.float64))
    quality = sl.metrics(fandisk, data / "clouds/simple.las")
    coverage = np.array([quality.coverage_max, quality.feature_coverage_mean])
    same_bytes(coverage, cpp("metrics.coverage", np.float64))


def test_register(cpp, data, same_bytes):
    result = sl.register(data / "scans/dragonStandRight_24.ply", data / "scans/dragonStandRight_0.ply")
    same_bytes(result.T_target_source, cpp("register", np.float64))
    same_bytes(np.array([result.confidence]), cpp("register.confidence", np.float64))


def test_align(cpp, data, same_bytes):
    result = sl.align([data / "scans/dragonStandRight_0.ply", data / "scans/dragonStandRight_24.ply"])
    same_bytes(result.scans[1].T_world_scan, cpp("align", np.float64))
    same_bytes(result.merged.positions, cpp("align.merged", np.float64))
