"""KdTree and TriangleTree against brute force."""

import numpy as np
import pytest

import shapelight as sl
from shapelight import stages


@pytest.fixture(scope="module")
def points():
    return np.random.default_rng(1).random((400, 3))


@pytest.fixture(scope="module")
def queries():
    return np.random.default_rng(2).random((70, 3))


@pytest.fixture(scope="module")
def distances(points, queries):
    return np.linalg.norm(queries[:, None] - points[None], axis=2)


def test_nearest_is_the_nearest(points, queries, distances):
    tree = stages.KdTree(points)
    one, many = tree.nearest(queries), tree.nearest(queries, 6)
    assert one.indices.shape == (70,) and many.indices.shape == (70, 6)
    np.testing.assert_array_equal(one.indices, distances.argmin(axis=1))
    np.testing.assert_allclose(many.distances, np.sort(distances, axis=1)[:, :6])
    np.testing.assert_array_equal(many.indices, distances.argsort(axis=1)[:, :6])


def test_nearest_tells_what_is_missing(points, queries):
    few = stages.KdTree(points[:2]).nearest(queries, 4)
    assert np.isinf(few.distances[:, 2:]).all() and (few.indices[:, 2:] == stages.NO_INDEX).all()
    assert np.isfinite(few.distances[:, :2]).all()
    assert (stages.KdTree(points[:2]).nearest(queries + 5, radius=0.1).indices == stages.NO_INDEX).all()
    assert stages.KdTree(np.zeros((0, 3))).nearest(queries).indices.shape == (70,)


def test_within_is_all_within(points, queries, distances):
    found = stages.KdTree(points).within(queries, 0.3)
    assert found.offsets.shape == (71,)
    for i, row in enumerate(distances):
        slots = slice(found.offsets[i], found.offsets[i + 1])
        expected = np.flatnonzero(row <= 0.3)
        np.testing.assert_array_equal(np.sort(found.indices[slots]), expected)
        np.testing.assert_allclose(found.distances[slots], np.sort(row[expected]))


def test_all_nearest_leaves_itself_out(points):
    table = stages.KdTree(points).all_nearest(3)
    expected = stages.KdTree(points).nearest(points, 4).indices[:, 1:]
    np.testing.assert_array_equal(table, expected)


def test_kd_tree_refuses(points):
    tree = stages.KdTree(points)
    with pytest.raises(sl.InvalidInput, match="k: 0, expected at least 1"):
        tree.nearest(points, 0)
    with pytest.raises(sl.InvalidInput, match="radius: -1, expected a length >= 0"):
        tree.within(points, -1)
    with pytest.raises(sl.InvalidInput, match=r"queries: shape \(3,\), expected \(n, 3\)"):
        tree.nearest([0, 0, 0])
    with pytest.raises(sl.InvalidInput, match="point 1 is not finite"):
        stages.KdTree([[0, 0, 0], [0, np.nan, 0]])


@pytest.fixture(scope="module")
def square():
    """The unit square in z = 0, seen from above."""
    return stages.TriangleTree([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])


def test_closest_on_a_square(square):
    found = square.closest([[0.75, 0.25, 2.0], [-3.0, 0.5, 4.0], [np.nan, 0, 0]])
    np.testing.assert_array_equal(found.distances, [2, 5, np.nan])
    np.testing.assert_array_equal(found.triangles, [0, 1, stages.NO_INDEX])
    np.testing.assert_array_equal(found.points, [[0.75, 0.25, 0], [0, 0.5, 0], [np.nan] * 3])


def test_rays_at_a_square(square):
    found = square.first_hit([[0.75, 0.25, 2.0], [0.75, 0.25, 2.0]], [[0, 0, -0.5], [0, 0, 1]])
    np.testing.assert_array_equal(found.distances, [4, np.inf])
    np.testing.assert_array_equal(found.triangles, [0, stages.NO_INDEX])
    np.testing.assert_array_equal(found.points, [[0.75, 0.25, 0], [np.nan] * 3])
    np.testing.assert_array_equal(found.normals, [[0, 0, 1], [np.nan] * 3])
    with pytest.raises(sl.InvalidInput, match="1 origins and 2 directions"):
        square.first_hit([[0, 0, 0]], [[0, 0, 1]] * 2)


def test_triangle_tree_refuses():
    with pytest.raises(sl.InvalidInput, match="0 triangles, expected 1"):
        stages.TriangleTree([[0, 0, 0]])


def test_closest_point_on_triangle_broadcasts():
    corners = [0, 0, 0], [1, 0, 0], [0, 1, 0]
    np.testing.assert_array_equal(stages.closest_point_on_triangle([0.25, 0.25, 3], *corners), [0.25, 0.25, 0])
    found = stages.closest_point_on_triangle([[0.25, 0.25, 3], [-1, -1, 0]], *corners)
    np.testing.assert_array_equal(found, [[0.25, 0.25, 0], [0, 0, 0]])
