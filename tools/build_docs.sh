#!/usr/bin/env bash
# Builds the documentation into site/ (or $SITE) and checks every link, anchor and picture in it. Open site/index.html.
# Needs the Python package with its extra: pip install ".[docs]"
set -euo pipefail
cd "$(dirname "$0")/.."

python=${PYTHON:-python3}
site=${SITE:-site}
NO_MKDOCS_2_WARNING=1 "$python" -m mkdocs build --strict --clean --site-dir "$site"
"$python" tools/check_site.py "$site"
