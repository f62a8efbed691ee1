#!/usr/bin/env bash
# Makes the Debian packages of a finished build: build_debian.sh [BUILD_FOLDER [OUTPUT_FOLDER]].
set -euo pipefail
cd "$(dirname "$0")/.."
cpack -G DEB --config "${1:-build/release}/CPackConfig.cmake" -B "${2:-build/packages}"
