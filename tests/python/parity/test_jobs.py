"""C++ and Python give the same bytes for the same job."""

import numpy as np

import shapelight as sl


def test_sample(cpp, data, same_bytes):
    result = sl.sample(data / "scans/dragonStandRight_0.ply", ratio=0.05)
    same_bytes(result.indices, cpp("sample", np.uint32))
