"""Trees answer as they do in C++, byte for byte."""

import numpy as np
import pytest

import shapelight as sl
from shapelight import stages


@pytest.fixture(scope="module")
def mesh(data):
    return sl.read(data / "meshes/fandisk.off")


@pytest.fixture(scope="module")
def queries(mesh):
    return 1.25 * mesh.positions[::3]


@pytest.fixture(scope="module")
def tree(mesh):
    return stages.KdTree(mesh.positions)


@pytest.fixture(scope="module")
def surface(mesh):
    return stages.TriangleTree(mesh)


def test_kd_tree_nearest(tree, queries, cpp, same_bytes):
    for name, found in (
        ("KdTree.nearest", tree.nearest(queries)),
        ("KdTree.nearest.5", tree.nearest(queries, 5, radius=0.15)),
    ):
        same_bytes(found.distances, cpp(f"{name}.distances", np.float64))
        same_bytes(found.indices, cpp(f"{name}.indices", np.uint32))


def test_kd_tree_within(tree, queries, cpp, same_bytes):
    found = tree.within(queries, 0.1)
    same_bytes(found.offsets, cpp("KdTree.within.offsets", np.int64))
    same_bytes(found.distances, cpp("KdTree.within.distances", np.float64))
    same_bytes(found.indices, cpp("KdTree.within.indices", np.uint32))


def test_kd_tree_all_nearest(tree, cpp, same_bytes):
    same_bytes(tree.all_nearest(4), cpp("KdTree.all_nearest", np.uint32))


def test_triangle_tree_closest(surface, queries, cpp, same_bytes):
    found = surface.closest(queries)
    same_bytes(found.distances, cpp("TriangleTree.closest.distances", np.float64))
    same_bytes(found.triangles, cpp("TriangleTree.closest.triangles", np.uint32))
    same_bytes(found.points, cpp("TriangleTree.closest.points", np.float64))


def test_triangle_tree_first_hit(surface, queries, cpp, same_bytes):
    found = surface.first_hit(queries, -queries)
    same_bytes(found.distances, cpp("TriangleTree.first_hit.distances", np.float64))
    same_bytes(found.triangles, cpp("TriangleTree.first_hit.triangles", np.uint32))
    same_bytes(found.points, cpp("TriangleTree.first_hit.points", np.float64))
    same_bytes(found.normals, cpp("TriangleTree.first_hit.normals", np.float64))


def test_closest_point_on_triangle(mesh, queries, cpp, same_bytes):
    a, b, c = (mesh.positions[mesh.triangles[: len(queries), corner]] for corner in range(3))
    same_bytes(stages.closest_point_on_triangle(queries, a, b, c), cpp("closest_point_on_triangle", np.float64))
