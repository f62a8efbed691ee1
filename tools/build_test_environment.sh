#!/usr/bin/env bash
# Makes build/venv: an empty environment, into which only the wheel goes, and, once that was seen to run, what its tests
# need besides. PYTHON says for which Python (python3).
set -euo pipefail
cd "$(dirname "$0")/.."

"${PYTHON:-python3}" -m venv --clear build/venv
wheel=$(ls "$PWD"/wheels/*.whl)
build/venv/bin/pip install -q "$wheel"
(cd build/venv && bin/shapelight --version && bin/python -c "import shapelight")  # away from the sources, numpy alone
build/venv/bin/pip install -q "$wheel[las,e57]" -r tests/requirements.txt
