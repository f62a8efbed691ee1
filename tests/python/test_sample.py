"""sample(): arrays in, indices out."""

import numpy as np
import pytest

import shapelight as sl


@pytest.fixture(scope="module")
def points():
    rng = np.random.default_rng(0)
    directions = rng.normal(size=(5000, 3))
    return directions / np.linalg.norm(directions, axis=1, keepdims=True)


def test_count_is_exact_and_indices_are_unique(points):
    result = sl.sample(points, count=321)
    assert result.indices.dtype == np.uint32
    assert len(np.unique(result.indices)) == 321


def test_contiguous_doubles_are_read_in_place(points):
    geometry = sl.as_geometry(points)
    for view in (geometry._view(), geometry._view(attributes=False)):
        assert view.positions_address == points.ctypes.data


def test_strided_and_read_only_arrays_give_the_same(points):
    wide = np.zeros((len(points), 6))
    wide[:, ::2] = points
    frozen = points.copy()
    frozen.flags.writeable = False
    expected = sl.sample(points, ratio=0.1).indices
    for array in (wide[:, ::2], np.asfortranarray(points), frozen, points.tolist()):
        np.testing.assert_array_equal(sl.sample(array, ratio=0.1).indices, expected)


def test_wrong_names_are_told(points):
    with pytest.raises(TypeError, match="did you mean 'local_weight'"):
        sl.sample(points, ratio=0.1, local_wieght=0.5)


def test_errors_have_the_exit_code(points):
    with pytest.raises(sl.TargetUnreachable) as caught:
        sl.sample(points, count=10**6)
    assert caught.value.code == 5 and caught.value.reachable == len(points)
    with pytest.raises(sl.InvalidInput, match="expected exactly one"):
        sl.sample(points)
