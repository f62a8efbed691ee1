"""Graphs by every builder are those of the C++ library, byte for byte."""

import numpy as np
import pytest

import shapelight as sl
from shapelight import stages

ARRAYS = {
    "offsets": np.uint32,
    "neighbors": np.uint32,
    "weight": np.float32,
    "position": np.float64,
    "normal": np.float64,
    "area": np.float64,
    "boundary": np.uint8,
    "outlier": np.uint8,
    "global_id": np.uint32,
    "vertex_of_point": np.uint32,
    "origin": np.float64,
    "mean_edge_length": np.float64,
    "total_area": np.float64,
}
VIEWPOINT = [0.0, 0.0, 2.0]


@pytest.fixture(scope="module")
def mesh(data):
    return sl.read(data / "meshes/fandisk.off")


@pytest.fixture(scope="module")
def scan(data):
    return sl.read(data / "scans/bun000_quarter.rif")


@pytest.fixture(scope="module")
def cloud(data):
    return sl.read(data / "clouds/simple.las")


@pytest.fixture
def same_graph(cpp, same_bytes):
    def check(graph, name):
        for array, dtype in ARRAYS.items():
            same_bytes(getattr(graph, array), cpp(f"{name}.{array}", dtype))
        same_bytes(np.array(list(graph.diagnostics.values()), np.uint64), cpp(f"{name}.diagnostics", np.uint64))
        stages.validate(graph)

    return check


def test_build_graph(mesh, scan, cloud, same_graph):
    same_graph(stages.build_graph(mesh), "build_graph.mesh")
    same_graph(stages.build_graph(mesh.positions, mesh.triangles), "build_graph.mesh")
    same_graph(stages.build_graph(scan, depth_jump=3.0), "build_graph.range_image")
    same_graph(stages.build_graph(cloud, neighbors=9), "build_graph.cloud")


def test_graph_from_mesh(mesh, same_graph):
    same_graph(stages.graph_from_mesh(mesh.positions, mesh.triangles), "graph_from_mesh")


def test_graph_from_range_image(scan, same_graph):
    graph = stages.graph_from_range_image(scan.positions, scan.grid, VIEWPOINT, depth_jump=4.0)
    same_graph(graph, "graph_from_range_image")


def test_graph_from_points(cloud, same_graph):
    graph = stages.graph_from_points(cloud.positions, cloud.positions[0], neighbors=7, flag_outliers=False)
    same_graph(graph, "graph_from_points")


def test_graph_of_places(cloud, same_graph):
    same_graph(stages.graph_of_places(cloud.positions), "graph_of_places")


def test_range_image_triangles(scan, cpp, same_bytes):
    triangles = stages.range_image_triangles(scan.positions, scan.grid, VIEWPOINT, depth_jump=4.0)
    same_bytes(triangles, cpp("range_image_triangles", np.uint32))


def test_ring_collector(mesh, cpp, same_bytes):
    rings = stages.RingCollector(stages.build_graph(mesh))
    same_bytes(rings.collect(17, 3, 20), cpp("RingCollector.collect", np.uint32))
