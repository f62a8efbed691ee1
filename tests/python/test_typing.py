"""The package and its examples pass mypy --strict, as users see them: with the stub of the extension module."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import shapelight as sl

ROOT = Path(__file__).resolve().parents[2]
pytest.importorskip("mypy")


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    """A folder with the package's sources and the stub, which a build makes and a source tree lacks."""
    source = Path(sl.__file__).parent
    folder = tmp_path_factory.mktemp("typing")
    copy = folder / "shapelight"
    shutil.copytree(source, copy, ignore=shutil.ignore_patterns("*.so", "__pycache__"))
    if not (copy / "_core.pyi").exists():
        pytest.importorskip("nanobind")
        stub = [sys.executable, "-m", "nanobind.stubgen", "-q", "-i", source.parent, "-m", "shapelight._core"]
        subprocess.run([*stub, "-o", copy / "_core.pyi"], check=True)
    return folder


def mypy(package, *arguments):
    command = [sys.executable, "-m", "mypy", "--config-file", ROOT / "pyproject.toml", "--no-incremental", *arguments]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, env={"MYPYPATH": str(package)})
    return done.returncode, done.stdout + done.stderr


def test_package_is_typed(package):
    code, text = mypy(package, "-p", "shapelight")
    assert code == 0, text


def test_package_is_typed_for_the_oldest_python(package):
    code, text = mypy(package, "--python-version", "3.10", "-p", "shapelight")
    assert code == 0, text


def test_examples_are_typed(package):
    code, text = mypy(package, *sorted((ROOT / "examples/python").glob("*.py")))
    assert code == 0, text


def test_wrong_calls_are_found(package, tmp_path):
    program = tmp_path / "wrong.py"
    program.write_text(
        "import shapelight as sl\n"
        "sl.sample([[0.0, 0.0, 0.0]], ratio=0.1, methd='shape')\n"
        "sl.sample([[0.0, 0.0, 0.0]], ratio=0.1, threads='two')\n"
        "sl.sample([[0.0, 0.0, 0.0]], ratio=0.1).index\n"
    )
    code, text = mypy(package, program)
    assert code == 1
    assert all(f"wrong.py:{line}: error" in text for line in (2, 3, 4)), text
