#!/usr/bin/env bash
# Makes wheels/: the sdist, and from it a wheel that carries oneTBB, fmt, libpng and liblzf inside, for any Linux with
# this machine's glibc or a newer one. PYTHON says for which Python (python3).
set -euo pipefail
cd "$(dirname "$0")/.."

"${PYTHON:-python3}" -m venv --clear build/tools
export PATH=$PWD/build/tools/bin:$PATH
pip install -q -r tools/requirements.txt
rm -rf wheels build/system_wheel
mkdir -p build/tmp
TMPDIR=$PWD/build/tmp CXX=${CXX:-c++} python -m build --no-isolation -o build/system_wheel  # the wheel from the sdist
auditwheel repair -w wheels build/system_wheel/*.whl
cp build/system_wheel/*.tar.gz wheels/
