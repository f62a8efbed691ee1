#!/usr/bin/env bash
# Builds everything with warnings as errors and runs all tests.
set -euo pipefail
cd "$(dirname "$0")"

tools/install_dependencies.sh
cmake --preset dev >/dev/null
cmake --build --preset dev
ctest --preset dev
