"""Where the builds leave what is tested here: tools/build_wheel.sh and tools/build_debian.sh."""

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def only(folder, pattern):
    found = sorted(folder.glob(pattern))
    assert len(found) == 1, f"{folder}: expected one {pattern}, found {[path.name for path in found]}"
    return found[0]


@pytest.fixture(scope="session")
def build():
    return ROOT / "build/dev"


@pytest.fixture(scope="session")
def wheel():
    return only(ROOT / "wheels", "*.whl")


@pytest.fixture(scope="session")
def sdist():
    return only(ROOT / "wheels", "*.tar.gz")


@pytest.fixture(scope="session")
def debs():
    """The tool's package and the developers' one."""
    return only(ROOT / "build/packages", "shapelight_*.deb"), only(ROOT / "build/packages", "libshapelight-dev_*.deb")


@pytest.fixture(scope="session")
def unpacked(debs, tmp_path_factory):
    """A folder in which both Debian packages are unpacked, as / would be."""
    folder = tmp_path_factory.mktemp("debian")
    for deb in debs:
        subprocess.run(["dpkg-deb", "-x", deb, folder], check=True)
    return folder
