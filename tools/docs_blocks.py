#!/usr/bin/env python3
"""Runs the code blocks of a page of the documentation, in order, in a folder in which data/ is the repository's.

  tools/docs_blocks.py PAGE FOLDER

```python blocks share one namespace; each ```bash or ```sh block is a shell of its own, which stops at the first error;
```cpp blocks are whole programs, built against the library found in CMAKE_PREFIX_PATH and run. A block with
title="FILE" is written to FILE and left to the blocks after it. Blocks that set a machine up (SETUP) are not run; the
scripts that they name must exist. A block that only others can run stands below `<!-- run elsewhere: REASON -->`.
"""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
FENCE = re.compile(r"^(?P<indent> *)```(?P<info>[^\n`]*)\n(?P<body>.*?)^(?P=indent)```\s*$", re.MULTILINE | re.DOTALL)
ELSEWHERE = re.compile(r"<!-- run elsewhere: \S[^>]*-->\s*\Z")
TITLE = re.compile(r'title="([^"]+)"')
SETUP = re.compile(r"\s*(#.*|(\./|tools/|sudo )\S+\.sh.*|(sudo )?apt\S* .*|(python3? -m )?pip3? install .*"
                   r"|python3? -m venv \S+|(\.|source) \S+/activate)?\s*(#.*)?")
PROJECT = """cmake_minimum_required(VERSION 3.22)
project(page LANGUAGES CXX)
set(CMAKE_BUILD_TYPE Release)
find_package(shapelight CONFIG REQUIRED)
add_executable(page page.cpp)
target_link_libraries(page PRIVATE shapelight::shapelight)
"""


class Block(NamedTuple):
    language: str
    title: str  # file that the block is, or ""
    code: str
    line: int  # of the first line of code, in the page


def blocks(text):
    """The blocks of a page that are to be run or written."""
    found = []
    for fence in FENCE.finditer(text):
        language, title = (fence["info"].split() or [""])[0], TITLE.search(fence["info"])
        if ELSEWHERE.search(text, 0, fence.start()) or not (language in RUNNERS or title):
            continue
        width = len(fence["indent"])
        code = "\n".join(line[width:] for line in fence["body"].splitlines()) + "\n"
        found.append(Block(language, title[1] if title else "", code, text.count("\n", 0, fence.start("body")) + 1))
    return found


def run_python(block, page, names):
    exec(compile("\n" * (block.line - 1) + block.code, page, "exec"), names)


def run_shell(block, page, names):
    lines = block.code.splitlines()
    if all(SETUP.fullmatch(line) for line in lines):
        check_setup(lines)
        return
    subprocess.run(["bash", "-euo", "pipefail", "-c", block.code], check=True)


def check_setup(lines):
    for script in re.findall(r"\S+\.sh\b", "\n".join(lines)):
        if not os.access(ROOT / script, os.X_OK):
            raise FileNotFoundError(f"{script}: no such program in the repository")
    extras = (ROOT / "pyproject.toml").read_text()
    for name in re.findall(r"\.\[([\w,]+)\]", "\n".join(lines)):
        for extra in name.split(","):
            if not re.search(rf"^{extra} *= *\[", extras, re.MULTILINE):
                raise LookupError(f"[{extra}]: no such extra in pyproject.toml")


def run_cpp(block, page, names):
    folder = Path(f".cpp_{block.line}")
    folder.mkdir()
    (folder / "page.cpp").write_text(block.code)
    (folder / "CMakeLists.txt").write_text(PROJECT)
    for command in (["cmake", "-S", folder, "-B", folder], ["cmake", "--build", folder], [folder / "page"]):
        subprocess.run([str(word) for word in command], check=True)


RUNNERS = {"python": run_python, "bash": run_shell, "sh": run_shell, "cpp": run_cpp}


def run_page(page, folder):
    (folder / "data").symlink_to(ROOT / "data")
    commands = folder / ".commands"
    commands.mkdir()
    shapelight = commands / "shapelight"  # of the Python that runs this, whatever else is installed
    shapelight.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m shapelight "$@"\n')
    shapelight.chmod(0o755)
    os.environ["PATH"] = f"{commands.resolve()}:{Path(sys.executable).parent}:{os.environ['PATH']}"
    os.chdir(folder)
    names = {"__name__": "__main__"}
    for block in blocks(page.read_text()):
        place = f"{page.name}:{block.line}"
        print(f"--- {place}", flush=True)
        try:
            if block.title:
                Path(block.title).write_text(block.code)
            else:
                RUNNERS[block.language](block, str(page), names)
            sys.stdout.flush()
        except BaseException:
            print(f"failed: {place}", file=sys.stderr, flush=True)
            raise


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    Path(sys.argv[2]).mkdir(parents=True, exist_ok=True)
    sys.path.pop(0)  # as in an interactive Python, pages see no modules of tools/
    run_page(Path(sys.argv[1]).resolve(), Path(sys.argv[2]))
