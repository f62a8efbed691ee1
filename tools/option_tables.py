#!/usr/bin/env python3
"""Fills the option tables of docs/ from `shapelight COMMAND --help`, so that they cannot differ from the program.

  tools/option_tables.py [--check] [--shapelight build/release/bin/shapelight]

A table stands between `<!-- options: COMMAND [/ GROUP] -->` and `<!-- end of options -->`. GROUP is a heading of the
help ("Options", "Stage options", "Common options"); without it, all of them. --check changes nothing and ends with 1
when a table is out of date.
"""

import argparse
import re
import subprocess
import sys
from pathlib import Path

from command_help import parse, plain

MARKED = re.compile(r"(<!-- options: (\S+)(?: / ([^>]+?))? -->\n).*?(<!-- end of options -->)", re.DOTALL)
EXTRAS = re.compile(r"(?: \[(?P<unit>[^\]]+)\])?(?: \((?P<default>[^()]+)\))?$")


def row(flags, meaning):
    flags = plain(flags).replace("|", "\\|")
    extras = EXTRAS.search(meaning)
    text = meaning[:extras.start()].replace("|", "\\|")
    return f"| `{flags}` | {text} | {extras['unit'] or ''} | {extras['default'] or ''} |"


CHOICES = re.compile(r" ([\w-]+(?:\|[\w-]+)+)$")


def in_words(flags, meaning):
    """Choices are named in the meaning: a | in code ends the cell for some readers of Markdown, escaped or not."""
    if not (choices := CHOICES.search(flags)):
        return flags, meaning
    names, extras = choices[1].split("|"), EXTRAS.search(meaning)
    text = meaning[:extras.start()]
    if not all(name in text for name in names):
        text += f" One of {', '.join(f'`{name}`' for name in names)}."
    return f"{flags[:choices.start()]} NAME", text + extras[0]


def table(shapelight, command, group):
    done = subprocess.run([shapelight, command, "--help"], capture_output=True, text=True, check=True)
    groups = parse(done.stdout)
    wanted = [group] if group else [name for name in groups if name != "Positionals"]
    rows = [row(*in_words(*option)) for name in wanted for option in groups[name] if "--help" not in option[0]]
    return "\n".join(["| option | meaning | unit | default |", "| --- | --- | --- | --- |", *rows]) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--shapelight", default="build/release/bin/shapelight")
    arguments = parser.parse_args()
    stale = []
    for page in sorted((Path(__file__).parent.parent / "docs").rglob("*.md")):
        old = page.read_text()
        new = MARKED.sub(lambda m: m[1] + table(arguments.shapelight, m[2], m[3]) + m[4], old)
        if new != old:
            stale.append(page.name)
            if not arguments.check:
                page.write_text(new)
    if stale:
        print(("out of date: " if arguments.check else "updated: ") + ", ".join(stale))
    return 1 if stale and arguments.check else 0


if __name__ == "__main__":
    sys.exit(main())
