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


def text():
    classes = [HEADER]
    for function, rows in sorted(_core.option_tables.items()):
        name = "".join(word.capitalize() for word in function.split("_")) + "Options"
        lines = [f"\n\nclass {name}(TypedDict, total=False):", f'    """Options of {function}()."""', ""]
        if not rows:
            lines.pop()
        for row in rows:
            unit = f" [{row['unit']}]" if row["unit"] not in ("", "1") else ""
            lines += [f"    {row['name']}: {type_of(row)}", f'    """{row["meaning"]}{unit} ({row["default"]})"""']
        classes.append("\n".join(lines) + "\n")
    return "".join(classes)


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
