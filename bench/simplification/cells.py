"""One cell of an experiment: a mesh, simplified and judged. Kept on disk, so that a run can be cut short."""

import argparse
import csv
import json
import re
import tempfile
from pathlib import Path

import methods
import numpy as np
from meshes import prepare

FIGURES = {"rms": ("RMS distance, 1e-4 of the diagonal", 1e4),
           "hausdorff": ("largest distance, 1e-3 of the diagonal", 1e3),
           "normals": ("normals, RMS angle in degrees", 1.0), "cpu_seconds": ("CPU seconds", 1.0)}


def judge(binary, reference, result):
    """Distances as shares of the reference's diagonal, symmetric; see bench/rivals/mesh_judge.cpp."""
    both = json.loads(methods.run([binary, reference, result])[0])["symmetric"]
    return {"rms": both["rms"], "hausdorff": both["max"], "normals": both["normal_rms_deg"]}


def count_vertices(off):
    with open(off) as file:
        file.readline()
        return int(file.readline().split()[0])


class Cells:
    def __init__(self, arguments):
        self.judge_binary = Path(arguments.rivals) / "mesh_judge"
        self.folder = Path(arguments.cache)
        (self.folder / "cells").mkdir(parents=True, exist_ok=True)
        self.shapelight = arguments.shapelight

    def mesh(self, path):
        return prepare(self.shapelight, path, self.folder / "meshes")

    def measure(self, method, mesh, removed, reference=None):
        """Simplifies `mesh` (OFF) to the share 1 - removed, judges it against `reference` or itself."""
        reference = reference or mesh
        total = count_vertices(mesh)
        wanted = round((1 - removed) * total)
        name = re.sub(r"[^A-Za-z0-9.]+", "-", f"{mesh.stem} {100 * removed:g} {method.name}")
        file = self.folder / "cells" / f"{name}.json"
        identity = " ".join([method.identity, *map(methods.digest, (mesh, reference, self.judge_binary))])
        if file.exists():
            kept = json.loads(file.read_text())
            if kept["identity"] == identity:
                return kept["cell"]
        cell = {"mesh": mesh.stem, "vertices_in": total, "removed": removed, "method": method.name, "wanted": wanted}
        with tempfile.TemporaryDirectory() as scratch:
            result = Path(scratch) / "result.off"
            try:
                cell["cpu_seconds"] = method(mesh, wanted, result)
                cell["vertices"] = count_vertices(result)
                cell |= judge(self.judge_binary, reference, result)
            except methods.Failed as error:
                cell["error"] = str(error)
        file.write_text(json.dumps({"identity": identity, "cell": cell}, indent=1))
        return cell


def parser(description):
    """Options that every experiment has."""
    result = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    result.add_argument("--shapelight", default="build/release/bin/shapelight", help="the command line tool")
    result.add_argument("--rivals", default="build/rivals", help="folder of the programs of bench/rivals")
    result.add_argument("--data", type=Path, default=Path("data"), help="folder with meshes/ and scans/ or pairs/")
    result.add_argument("--cache", default="build/simplification", help="folder of finished cells")
    result.add_argument("--output", type=Path, default=Path("out"), help="folder of the tables and plots")
    result.add_argument("--meshes", nargs="*", help="names without extension; all by default")
    return result


def chosen(names, available, what):
    unknown = [name for name in names or [] if name not in available]
    if unknown:
        raise SystemExit(f"unknown {what}: {', '.join(unknown)}; expected some of: {', '.join(available)}")
    return [name for name in available if not names or name in names]


def write_csv(path, rows):
    columns = list(dict.fromkeys(key for row in rows for key in row))
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, columns)
        writer.writeheader()
        writer.writerows(rows)


def geometric_mean(values):
    return float(np.exp(np.mean(np.log(np.maximum(values, 1e-12)))))


def replace_part(document, name, text):
    """Puts generated text between the two comments <!-- NAME --> and <!-- end of NAME --> of a page."""
    start, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
    before, rest = document.read_text().split(start)
    document.write_text(before + start + text + end + rest.split(end)[1])
