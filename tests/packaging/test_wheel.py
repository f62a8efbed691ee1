"""What the wheel and the sdist hold, and what they do not."""

import re
import subprocess
import tarfile
import zipfile
from pathlib import Path

import pytest

import shapelight


@pytest.fixture(scope="module")
def names(wheel):
    return [name for name in zipfile.ZipFile(wheel).namelist() if not name.endswith("/")]


def test_wheel_holds_the_package_its_types_and_the_command(wheel, names):
    assert {"shapelight/__init__.py", "shapelight/_core.pyi", "shapelight/py.typed"} <= set(names)
    [metadata] = [name for name in names if name.endswith(".dist-info/entry_points.txt")]
    assert "shapelight = shapelight.__main__:main" in zipfile.ZipFile(wheel).read(metadata).decode()


def test_wheel_holds_nothing_else(names):
    allowed = re.compile(r"shapelight/(\w+/)*[\w.-]+\.(py|pyi|js|css|html)|shapelight/py\.typed"
                         r"|shapelight/_core\.[\w-]+\.so|shapelight\.libs/lib[\w.-]+|shapelight-[\w.]+\.dist-info/.*")
    assert [name for name in names if not allowed.fullmatch(name)] == []


def test_wheel_carries_its_libraries(wheel, names):
    carried = {Path(name).name.split("-")[0] for name in names if name.startswith("shapelight.libs/")}
    assert {"libtbb", "libfmt", "libpng16", "liblzf"} <= carried
    assert "manylinux" in wheel.name


def test_installed_module_uses_the_libraries_of_the_wheel():
    module = shapelight._core.__file__
    linked = subprocess.run(["ldd", module], check=True, capture_output=True, text=True).stdout
    outside = [line.split()[0] for line in linked.splitlines() if "=>" in line and "shapelight.libs" not in line]
    system = r"lib(c|m|dl|pthread|rt|stdc\+\+|gcc_s|z)\.so\.\d+"  # of every manylinux machine
    assert [name for name in outside if not re.fullmatch(system, name)] == []


def test_module_is_stripped_and_small():
    module = Path(shapelight._core.__file__)
    sections = subprocess.run(["readelf", "-S", "-W", module], check=True, capture_output=True, text=True).stdout
    assert ".symtab" not in sections and ".debug_info" not in sections
    assert module.stat().st_size < 20e6


def test_sdist_holds_what_a_build_needs_and_no_data(sdist):
    names = [name.split("/", 1)[1] for name in tarfile.open(sdist).getnames() if "/" in name]
    folders = {name.split("/")[0] for name in names}
    needed = {"CMakeLists.txt", "LICENSE", "PKG-INFO", "README.md", "VERSION", "apps", "cmake", "include", "pyproject.toml",
              "python", "src", "tools"}
    assert folders == needed
    assert "tools/install_dependencies.sh" in names
    assert not [name for name in names if name.endswith((".so", ".o", ".a", ".pyc"))]
