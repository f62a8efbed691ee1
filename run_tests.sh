#!/usr/bin/env bash
# Builds everything with warnings as errors and runs all tests: the library, the command, the Python package as installed
# from its wheel, the documentation, the packages.
set -euo pipefail
cd "$(dirname "$0")"
# The same flags and paths for every build, so that ccache compiles the library once.
export CCACHE_BASEDIR=${CCACHE_BASEDIR:-$PWD} CCACHE_NOHASHDIR=1 CXX=${CXX:-c++}
export SKBUILD_CMAKE_DEFINE="SHAPELIGHT_WARNINGS_AS_ERRORS=ON"

tools/install_dependencies.sh
cmake --preset dev >/dev/null
cmake --build --preset dev
ctest --preset dev
tools/build_wheel.sh
tools/build_debian.sh build/dev
tools/build_test_environment.sh
source build/venv/bin/activate
python tools/python_options.py --check
python -m pytest
tools/build_docs.sh
