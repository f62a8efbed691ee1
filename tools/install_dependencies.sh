#!/usr/bin/env bash
# Installs what shapelight builds with, from Debian's own packages. Needs root or sudo; does nothing when all are there.
set -euo pipefail

packages=(
  build-essential cmake ninja-build ccache    # compiler and build
  libeigen3-dev libtbb-dev libfmt-dev         # library
  libpng-dev liblzf-dev nlohmann-json3-dev
  libcli11-dev                                # command line
  python3-dev python3-venv                    # Python package
  dpkg-dev file                               # Debian packages
  libgtest-dev                                # tests
)
missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
done
[ ${#missing[@]} -eq 0 ] && exit 0

sudo=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "installing ${missing[*]} needs root or sudo" >&2; exit 1; }
  sudo=(sudo)
fi
echo "installing: ${missing[*]}"
"${sudo[@]}" apt-get update -qq
DEBIAN_FRONTEND=noninteractive "${sudo[@]}" apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
