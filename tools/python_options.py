#!/usr/bin/env python3
"""Writes python/shapelight/_options.py, the types of keyword options, from the installed package's own tables.

  tools/python_options.py [--check]

--check changes nothing and ends with 1 when the file is out of date.
"""

import argparse
import sys
from pathlib import Path

from shapelight import _core

HEADER = '''"""Types of the keyword options of every function. Made by tools/python_options.py; do not edit."""

from __future__ import annotations

from typing import Literal, TypedDict
'''


def type_of(row):
    if row["choices"]:
        return "Literal[" + ", ".join(f'"{name}"' for name in row["choices"]) + "]"
    return row["type"]


def class_name(function):
    return "".join(word.capitalize() for word in function.split("_")) + "Options"


def parents_of(function, tables):
    """Functions whose options are among those of this one, the largest first, without overlaps."""
    mine = {repr(row) for row in tables[function]}
    parents, taken = [], set()
    for other in sorted(tables, key=lambda name: (-len(tables[name]), name)):
        rows = {repr(row) for row in tables[other]}
        if rows and rows < mine and not rows & taken:
            parents.append(other)
            taken |= rows
    return parents, taken


def class_text(function, tables):
    parents, inherited = parents_of(function, tables)
    bases = [class_name(parent) for parent in parents] or ["TypedDict"]
    head = f"class {class_name(function)}({', '.join(bases)}, total=False):"
    if len(head) > 120:
        head = f"class {class_name(function)}(\n    " + ",\n    ".join([*bases, "total=False"]) + ",\n):"
    lines = [f"\n\n{head}", f'    """Options of {function}()."""']
    rows = [row for row in tables[function] if repr(row) not in inherited]
    for row in rows:
        unit = f" [{row['unit']}]" if row["unit"] not in ("", "1") else ""
        lines += [f"    {row['name']}: {type_of(row)}", f'    """{row["meaning"]}{unit} ({row["default"]})"""']
    if rows:
        lines.insert(2, "")
    return "\n".join(lines) + "\n"


def text():
    tables = dict(_core.option_tables)
    by_size = sorted(tables, key=lambda name: (len(tables[name]), name))  # parents first
    return HEADER + "".join(class_text(function, tables) for function in by_size)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    check = parser.parse_args().check
    path = Path(__file__).parent.parent / "python/shapelight/_options.py"
    old, new = path.read_text() if path.exists() else "", text()
    if new == old:
        return 0
    if not check:
        path.write_text(new)
    print(("out of date: " if check else "updated: ") + path.name)
    return 1 if check else 0


if __name__ == "__main__":
    sys.exit(main())
