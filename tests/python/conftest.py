"""What the tests share: the shipped data, and the results of the C++ library and of the command."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def data():
    """Folder of the data that the repository ships."""
    return ROOT / "data"


@pytest.fixture(scope="session")
def cpp(tmp_path_factory):
    """cpp(name, dtype): what a C++ function returned, as recorded by tests/parity."""
    program = os.environ.get("SHAPELIGHT_PARITY", str(ROOT / "build/dev/tests/parity/parity"))
    folder = tmp_path_factory.mktemp("parity")
    subprocess.run([program, folder], check=True)
    return lambda name, dtype: np.fromfile(folder / f"{name}.bin", dtype=dtype)


@pytest.fixture(scope="session")
def same_bytes():
    """Asserts that two arrays are of one type and equal byte for byte."""

    def check(actual, expected):
        actual = np.ascontiguousarray(actual)
        assert actual.dtype == expected.dtype
        assert actual.tobytes() == expected.tobytes()

    return check
