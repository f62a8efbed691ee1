"""What the pages say to type works, and makes the pictures that tutorials and gallery show.

C++ blocks are built against an installed library: of the prefix $SHAPELIGHT_PREFIX, else of the build tree
$SHAPELIGHT_BUILD (build/dev).
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import docs_blocks  # noqa: E402

PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
PICTURES = re.compile(r"!\[[^\]]*\]\((?:\S*/)?images/([\w.-]+)\)")

SHOWN_ONLY = ("text", "json", "cmake")


@pytest.fixture(scope="session")
def prefix(tmp_path_factory):
    """Where the C++ library is installed."""
    if "SHAPELIGHT_PREFIX" in os.environ:
        return os.environ["SHAPELIGHT_PREFIX"]
    build = os.environ.get("SHAPELIGHT_BUILD", str(ROOT / "build/dev"))
    folder = tmp_path_factory.mktemp("prefix")
    subprocess.run(["cmake", "--install", build, "--prefix", folder], check=True, stdout=subprocess.DEVNULL)
    return str(folder)


def needs_library(page):
    return any(block.language in ("cpp", "cmake") for block in docs_blocks.blocks(page.read_text()))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_blocks_run(page, tmp_path, request):
    environment = dict(os.environ)
    environment["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if path)
    if needs_library(page):
        environment["CMAKE_PREFIX_PATH"] = request.getfixturevalue("prefix")
    runner = [sys.executable, ROOT / "tools/docs_blocks.py", page, tmp_path]
    done = subprocess.run(runner, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.returncode == 0, done.stdout[-4000:]
    if page.parent.name == "tutorials" or page.name == "gallery.md":
        missing = [name for name in PICTURES.findall(page.read_text()) if not (tmp_path / name).exists()]
        assert not missing, f"shown, but made by no block of the page: {missing}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_block_says_what_it_is(page):
    languages = {fence["info"].split(" ")[0] for fence in docs_blocks.FENCE.finditer(page.read_text())}
    assert languages <= {*docs_blocks.RUNNERS, *SHOWN_ONLY}


def parsed(text):
    return [(block.language, block.title, block.code) for block in docs_blocks.blocks(text)]


def test_blocks_are_found():
    assert parsed("```bash\nls\n```\n```text\nx\n```\n") == [("bash", "", "ls\n")]
    assert parsed('=== "Python"\n\n    ```python\n    a = 1\n    if a:\n        a = 2\n    ```\n') == [
        ("python", "", "a = 1\nif a:\n    a = 2\n")]
    assert parsed('```cmake title="CMakeLists.txt"\nproject(x)\n```\n') == [("cmake", "CMakeLists.txt", "project(x)\n")]
    assert parsed("<!-- run elsewhere: needs a cluster -->\n```bash\nfalse\n```\n") == []
    assert parsed("<!-- run elsewhere: -->\n```bash\nfalse\n```\n") != []


def test_errors_stop_a_page(tmp_path):
    wrong = ("```bash\nfalse\ntrue\n```\n", "```python\n1 / 0\n```\n", "```sh\n./absent.sh\n```\n")
    for number, block in enumerate(wrong):
        page = tmp_path / f"{number}.md"
        page.write_text(block)
        done = subprocess.run([sys.executable, ROOT / "tools/docs_blocks.py", page, tmp_path / str(number)],
                              stderr=subprocess.PIPE, text=True)
        assert done.returncode != 0 and f"failed: {page.name}:2" in done.stderr
