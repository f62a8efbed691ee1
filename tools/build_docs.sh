#!/usr/bin/env bash
# Builds the documentation into site/ and checks every link, anchor and picture in it. Open site/index.html.
# Needs the Python package with its extra: pip install ".[docs]"
set -euo pipefail
cd "$(dirname "$0")/.."

python=${PYTHON:-python3}
DISABLE_MKDOCS_2_WARNING=true NO_MKDOCS_2_WARNING=1 "$python" -m mkdocs build --strict --clean
"$python" tools/check_site.py site
