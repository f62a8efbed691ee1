#!/usr/bin/env python3
"""Checks who includes whom: the table below is the architecture. Exit code 1 names every arrow that is not in it."""

import re
import sys
from pathlib import Path

STAGES = {"features", "denoise", "retinex", "segment", "sample"}
BASE = {"core", "data"}
NEIGHBORHOOD = BASE | {"spatial", "graph"}
ALLOWED = {
    "core": {"core"},
    "data": BASE,
    "io": BASE | {"io"},
    "spatial": BASE | {"spatial"},
    "graph": NEIGHBORHOOD,
    **{stage: NEIGHBORHOOD | {stage} for stage in STAGES},
    "simplify": BASE | {"spatial", "simplify"},
    "metrics": BASE | {"spatial", "metrics"},
    "registration": BASE | {"spatial", "registration"},
    "synthetic": BASE | {"spatial", "synthetic"},
    "pipeline": NEIGHBORHOOD | STAGES | {"simplify", "metrics", "registration", "pipeline"},
    "render": NEIGHBORHOOD | {"io", "render"},
}
ONLY_IN = {  # header -> the only files that may include it
    "thread": {"src/core/parallel.cpp"},
    "atomic": {"src/core/parallel.cpp"},
    "random": set(),
}
INCLUDE = re.compile(r'^\s*#include\s+[<"]([^>"]+)[>"]', re.MULTILINE)


def module_of(included):
    parts = included.removeprefix("shapelight/").split("/")
    return parts[0] if len(parts) > 1 and parts[0] in ALLOWED else None


def main():
    root = Path(__file__).resolve().parent.parent
    wrong = []
    for folder in ("include/shapelight", "src"):
        for file in sorted((root / folder).rglob("*.[ch]pp")):
            name = file.relative_to(root).as_posix()
            module = file.relative_to(root / folder).parts[0]
            for included in INCLUDE.findall(file.read_text()):
                target = module_of(included)
                if target and target not in ALLOWED[module]:
                    wrong.append(f"{name}: {module} may not include {target} ({included})")
                if included in ONLY_IN and name not in ONLY_IN[included]:
                    wrong.append(f"{name}: <{included}> is not allowed here")
    print("\n".join(wrong) if wrong else "layers hold")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
