#!/usr/bin/env python3
"""Makes the pictures of tutorials and gallery anew, by running the pages that show them.

  tools/docs_images.py [PAGE...]
"""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs/images"
SHOWN = re.compile(r"!\[[^\]]*\]\((?:\S*/)?images/([\w.-]+)\)")


def main():
    pages = [Path(name).resolve() for name in sys.argv[1:]]
    for page in pages or [*sorted((ROOT / "docs/tutorials").glob("*.md")), ROOT / "docs/gallery.md"]:
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([sys.executable, ROOT / "tools/docs_blocks.py", page, folder], check=True)
            for name in SHOWN.findall(page.read_text()):
                if (Path(folder) / name).exists():
                    shutil.copyfile(Path(folder) / name, IMAGES / name)
                    print(f"docs/images/{name}")


if __name__ == "__main__":
    main()
