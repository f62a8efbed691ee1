"""A mesh of about a million vertices to a tenth: CPU seconds, what a second thread brings, memory, equal bytes.

  python bench/simplification/million.py --data data --meshes armadillo --output out

The mesh is a small one with every triangle cut into k x k, rounded, with waves and fine grain, the same in every run.
Writes million.csv and million.md. Memory is the peak of the whole process, files included.
"""

import json
import os
import sys
import time
from pathlib import Path

import cells
import methods
import numpy as np
from meshes import mean_edge, read_off, subdivided, taubin, vertex_normals, write_off
from table1 import find_inputs, markdown_table

VERTICES = 1_000_000
KEPT = 0.1


def displaced(points, triangles):
    """Rounds the flat pieces, then moves vertices along their normals: waves of 8 to 60 edges, and grain."""
    points = taubin(points, triangles, iterations=10)
    edge, normals = mean_edge(points, triangles), vertex_normals(points, triangles)
    height = np.zeros(len(points))
    for wavelength, amplitude in ((60, 1.2), (23, 0.4), (8, 0.1)):
        phase = points * (2 * np.pi / (wavelength * edge))
        height += amplitude * edge * np.sin(phase[:, 0]) * np.sin(phase[:, 1] + 1) * np.sin(phase[:, 2] + 2)
    height += 0.05 * edge * np.random.default_rng(1).uniform(-1, 1, len(points))
    return points + height[:, None] * normals


def large_mesh(mesh, folder):
    target = folder / f"{mesh.stem}-million.off"
    if not target.exists():
        points, triangles = read_off(mesh)
        parts = max(1, round((VERTICES / len(points)) ** 0.5))
        points, triangles = subdivided(points, triangles, parts)
        write_off(target, displaced(points, triangles), triangles)
    return target


def run(command):
    """Wall seconds, CPU seconds and peak memory of one process."""
    start = time.monotonic()
    pid = os.spawnvp(os.P_NOWAIT, str(command[0]), [str(word) for word in command])
    _, status, usage = os.wait4(pid, 0)
    if status != 0:
        raise methods.Failed(f"{Path(command[0]).name}: exit code {os.waitstatus_to_exitcode(status)}")
    return {"wall": time.monotonic() - start, "process_cpu": usage.ru_utime + usage.ru_stime,
            "peak_bytes": usage.ru_maxrss * 1024}


def run_shapelight(arguments, name, mesh, wanted, threads):
    result, report = arguments.output / f"{name}-{threads}.off", arguments.output / "report.json"
    options = methods.SHAPELIGHT[name]
    row = run([arguments.shapelight, "simplify", mesh, "-o", result, "--vertices", wanted, "--threads", threads,
               "--force", "-q", "--json", report, *options])
    seconds = json.loads(report.read_text())["seconds"]
    report.unlink()
    row["simplify_wall"] = seconds["total"] - seconds.get("read", 0) - seconds.get("write", 0)
    return {"program": name, "threads": threads, **row}, result


def markdown(name, total, wanted, rows):
    table = [[r["program"], str(r["threads"]), f"{r['wall']:.1f}", f"{r['process_cpu']:.1f}",
              f"{r['speedup']:.2f}" if "speedup" in r else "-", f"{r['bytes_per_vertex']:.0f}",
              {True: "yes", False: "NO"}.get(r.get("same_bytes"), "-"), f"{1e4 * r['rms']:.3g}", f"{r['normals']:.3g}"]
             for r in rows]
    head = ["program", "threads", "wall s with files", "CPU s with files", "speed-up without", "peak bytes a vertex",
            "same bytes", "RMS 1e-4", "normals"]
    return f"{name}, {total} vertices, to {wanted}:\n\n" + markdown_table(head, table)


def main():
    parser = cells.parser(__doc__)
    parser.add_argument("--methods", nargs="*", default=["SSim", "SSim free, fast", "QSlim"])
    parser.add_argument("--document", type=Path, help="page whose part 'million' is replaced")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    bench, inputs = cells.Cells(arguments), find_inputs(arguments.data)
    name = cells.chosen(arguments.meshes or ["armadillo"], list(inputs), "meshes")[0]
    mesh = large_mesh(bench.mesh(inputs[name]), bench.folder / "meshes")
    total = cells.count_vertices(mesh)
    wanted, rows = round(KEPT * total), []

    def add(row, result):
        row |= {"vertices": total, "bytes_per_vertex": row["peak_bytes"] / total,
                **cells.judge(bench.judge_binary, mesh, result)}
        rows.append(row)
        print(row, file=sys.stderr, flush=True)

    for method in arguments.methods:
        try:
            one, first = run_shapelight(arguments, method, mesh, wanted, 1)
            two, second = run_shapelight(arguments, method, mesh, wanted, 2)
        except methods.Failed as error:
            print(f"{method}: {error}", file=sys.stderr)
            continue
        same = first.read_bytes() == second.read_bytes()
        for row, result in ((one, first), (two, second)):
            add({**row, "speedup": one["simplify_wall"] / row["simplify_wall"], "same_bytes": same}, result)
            result.unlink()
    collapse = Path(arguments.rivals) / "cgal_collapse"
    if collapse.exists():
        result = arguments.output / "lt.off"
        add({"program": "CGAL Lindstrom-Turk", "threads": 1, **run([collapse, "lt", mesh, result, wanted])}, result)
        result.unlink()
    cells.write_csv(arguments.output / "million.csv", rows)
    text = markdown(name, total, wanted, rows)
    (arguments.output / "million.md").write_text(text)
    if arguments.document:
        cells.replace_part(arguments.document, "million", text)


if __name__ == "__main__":
    main()
