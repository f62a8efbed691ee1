"""One number: the file VERSION."""

import importlib.metadata
import subprocess
from pathlib import Path

import shapelight

ROOT = Path(__file__).resolve().parents[2]
VERSION = (ROOT / "VERSION").read_text().strip()


def output_of(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()


def test_cpp(build):
    assert output_of(build / "bin/shapelight", "--version") == f"shapelight {VERSION}"
    assert f'set(PACKAGE_VERSION "{VERSION}")' in (build / "shapelightConfigVersion.cmake").read_text()


def test_python(wheel, sdist):
    assert shapelight.__version__ == VERSION
    assert importlib.metadata.version("shapelight") == VERSION
    assert wheel.name.startswith(f"shapelight-{VERSION}-")
    assert sdist.name == f"shapelight-{VERSION}.tar.gz"


def test_debian(debs, unpacked):
    for deb in debs:
        assert output_of("dpkg-deb", "-f", deb, "Version") == VERSION
    assert output_of(unpacked / "usr/bin/shapelight", "--version") == f"shapelight {VERSION}"


def test_changelog_has_it():
    assert f"\n## {VERSION}" in (ROOT / "CHANGELOG.md").read_text()
