"""Other CMake projects use the library: installed, from the Debian package's files, and as a subdirectory."""

import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCAN = ROOT / "data/scans/dragonStandRight_0.ply"


def run(*command):
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def points_kept(name, *definitions):
    folder = ROOT / "build" / name  # two levels down, as the other builds, whose objects ccache has
    shutil.rmtree(folder, ignore_errors=True)
    run("cmake", "-S", ROOT / "tests/consumer", "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", *definitions)
    run("cmake", "--build", folder)
    return int(subprocess.run([folder / "consumer", SCAN], check=True, capture_output=True).stdout)


def test_installed(build, tmp_path):
    run("cmake", "--install", build, "--prefix", tmp_path)
    assert points_kept("consumer", f"-DCMAKE_PREFIX_PATH={tmp_path}") == 500


def test_debian_package(unpacked):
    assert points_kept("consumer_debian", f"-DCMAKE_PREFIX_PATH={unpacked}/usr") == 500


def test_subdirectory():
    launcher = [f"-DCMAKE_CXX_COMPILER_LAUNCHER={ccache}"] if (ccache := shutil.which("ccache")) else []
    strict = "-DSHAPELIGHT_WARNINGS_AS_ERRORS=ON"  # the flags of the other builds
    assert points_kept("consumer_subdirectory", f"-DSHAPELIGHT_SOURCE={ROOT}", strict, *launcher) == 500


def test_missing_libraries_are_named(tmp_path):
    done = subprocess.run(["cmake", "-S", ROOT, "-B", tmp_path, "-DCMAKE_DISABLE_FIND_PACKAGE_fmt=ON",
                           "-DCMAKE_DISABLE_FIND_PACKAGE_liblzf=ON"], capture_output=True, text=True)
    assert done.returncode != 0
    assert "apt-get install libfmt-dev liblzf-dev" in done.stderr and "tools/install_dependencies.sh" in done.stderr
