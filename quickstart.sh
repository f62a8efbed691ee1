#!/usr/bin/env bash
# Sets up everything on a Debian 12 machine, builds, samples and simplifies a real scan and registers another one with it;
# leaves the results and pictures, and a virtual environment with the Python package, in out/.
set -euo pipefail
cd "$(dirname "$0")"
export CCACHE_BASEDIR=${CCACHE_BASEDIR:-$PWD} CCACHE_NOHASHDIR=1 CXX=${CXX:-c++}  # the library is compiled once

tools/install_dependencies.sh
cmake --preset release >/dev/null
cmake --build --preset release

shapelight=build/release/bin/shapelight
scan=data/scans/dragonStandRight_0.ply
mkdir -p out/quickstart
echo
"$shapelight" fields "$scan" -o out/quickstart/fields.ply --force
"$shapelight" sample "$scan" -o out/quickstart/sample.ply --ratio 5% --index-field --order --force
"$shapelight" metrics "$scan" out/quickstart/sample.ply
"$shapelight" render out/quickstart/fields.ply -o out/quickstart/sample.png --force \
  --color reflectance,segment,none --dots out/quickstart/sample.ply --width 1800 --height 800
echo
"$shapelight" simplify "$scan" -o out/quickstart/simplified.ply --ratio 5% --placement optimal --measure --force
"$shapelight" render "$scan" out/quickstart/simplified.ply -o out/quickstart/simplified.png --force --width 1800 --height 800
echo
"$shapelight" register data/scans/dragonStandRight_24.ply "$scan" -o out/quickstart/registered.ply \
  --transform out/quickstart/transform.txt --force
"$shapelight" sample out/quickstart/registered.ply -o out/quickstart/dots.ply --count 2500 --method farthest -q --force
"$shapelight" render "$scan" -o out/quickstart/registered.png --dots out/quickstart/dots.ply --width 1200 --height 900 --force
echo
python3 -m venv out/venv
out/venv/bin/pip install -q .
out/venv/bin/python -c "import shapelight as sl; print(sl.sample(sl.read('$scan'), ratio=0.05))"
echo
echo "the sample:  out/quickstart/sample.ply"
echo "the picture: out/quickstart/sample.png (the scan by reflectance, by segments, and plain; the samples on top)"
echo "the mesh:    out/quickstart/simplified.ply, a twentieth of the vertices; beside the scan in simplified.png"
echo "the poses:   out/quickstart/registered.ply, a second scan brought onto the first; registered.png, transform.txt"
echo "the tool:    $shapelight --help"
echo "in Python:   out/venv/bin/python, import shapelight"
