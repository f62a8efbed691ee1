"""What a call from Python costs over the same call from C++: CPU and wall time, and peak memory.

  python bench/python/overhead.py --call-cost build/bench/bin/call_cost --mesh data/meshes/armadillo.ply --runs 7

Both sides get the same million points (a mesh cut finer, and its vertices as a raw cloud), warm, and take turns, so
that what else the machine does meets both. Prints a Markdown table: medians, their ratio, and the range of the ratios
of neighbouring runs. The package on the path and call_cost must be built from the same sources.
"""

import argparse
import ctypes
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

import shapelight as sl


def finer(vertices, faces, parts):
    """Every triangle cut into parts x parts, with waves, so that no part is flat."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    steps = [(i, j) for i in range(parts + 1) for j in range(parts + 1 - i)]
    number = {step: k for k, step in enumerate(steps)}
    shares = np.array([(parts - i - j, i, j) for i, j in steps]) / parts
    points = np.einsum("sk,fkd->fsd", shares, np.stack([a, b, c], axis=1)).reshape(-1, 3)
    cells = [(number[i, j], number[i + 1, j], number[i, j + 1]) for i, j in steps if i + j < parts]
    cells += [(number[i + 1, j], number[i + 1, j + 1], number[i, j + 1]) for i, j in steps if i + j < parts - 1]
    triangles = (np.arange(len(faces))[:, None, None] * len(steps) + np.array(cells)[None]).reshape(-1, 3)
    diagonal = np.linalg.norm(np.ptp(points, axis=0))
    _, first, merged = np.unique(np.round(points / diagonal, 9), axis=0, return_index=True, return_inverse=True)
    points = points[first]
    points += 1e-4 * diagonal * np.sin(np.roll(points, 1, axis=1) * (400.0 / diagonal))
    return np.ascontiguousarray(points), merged.reshape(-1)[triangles].astype(np.uint32)


class CppSide:
    """call_cost, one run at a time."""

    def __init__(self, program, job, threads, files):
        command = [str(program.resolve()), job, str(threads), *map(str, files)]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def run(self):
        self.process.stdin.write("\n")
        self.process.stdin.flush()
        return [float(word) for word in self.process.stdout.readline().split()]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def status_bytes(name):
    for line in Path("/proc/self/status").read_text().splitlines():
        if line.startswith(name):
            return 1024.0 * float(line.split()[1])
    return 0.0


def run_python(call):
    ctypes.CDLL(None).malloc_trim(0)
    Path("/proc/self/clear_refs").write_text("5")
    before = status_bytes("VmRSS:")
    wall, cpu = time.perf_counter(), time.process_time()
    call()
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    return [wall, cpu, status_bytes("VmHWM:") - before]


def compare(name, call, cpp, runs):
    cpp.run(), run_python(call)  # warm
    ours, theirs = [], []
    for _ in range(runs):
        theirs.append(cpp.run())
        ours.append(run_python(call))
    cells = [name]
    for k, unit in ((1, 1.0), (0, 1.0), (2, 1e-6)):
        a, b = [statistics.median(run[k] for run in side) * unit for side in (theirs, ours)]
        ratios = sorted(p[k] / c[k] for p, c in zip(ours, theirs))
        digits = 0 if k == 2 else 2
        cells += [f"{a:.{digits}f}", f"{b:.{digits}f}", f"{b / a:.3f} ({ratios[0]:.2f} to {ratios[-1]:.2f})"]
    print("| " + " | ".join(cells) + " |", flush=True)


def turned(points):
    angle = 0.3
    rotation = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    return np.ascontiguousarray(points @ rotation.T)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--call-cost", type=Path, required=True)
    parser.add_argument("--mesh", type=Path, required=True)
    parser.add_argument("--points", type=int, default=1_000_000)
    parser.add_argument("--runs", type=int, default=7)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()

    mesh = sl.read(arguments.mesh)
    parts = int(np.ceil(np.sqrt(arguments.points / len(mesh.positions))))
    points, triangles = finer(np.asarray(mesh.positions), np.asarray(mesh.triangles), parts)
    other = turned(points)
    threads = arguments.threads
    jobs = {
        "sample-cloud": (lambda: sl.sample(points, ratio=0.1, threads=threads), ["points"]),
        "sample-mesh": (lambda: sl.sample((points, triangles), ratio=0.1, threads=threads), ["points", "triangles"]),
        "simplify": (lambda: sl.simplify(points, triangles, ratio=0.1, threads=threads), ["points", "triangles"]),
        "register": (lambda: sl.register(other, points, threads=threads), ["other", "points"]),
    }
    print(f"{len(points)} vertices, {len(triangles)} triangles, {threads} thread(s), {arguments.runs} runs\n")
    print("| call | C++ CPU, s | Python | ratio | C++ wall, s | Python | ratio | C++ peak, MB | Python | ratio |")
    print("| --- |" + " ---: |" * 9)
    with tempfile.TemporaryDirectory() as folder:
        files = {name: Path(folder) / name for name in ("points", "other", "triangles")}
        points.tofile(files["points"])
        other.tofile(files["other"])
        triangles.tofile(files["triangles"])
        for name, (call, inputs) in jobs.items():
            if arguments.only not in name:
                continue
            cpp = CppSide(arguments.call_cost, name, threads, [files[i] for i in inputs])
            compare(name, call, cpp, arguments.runs)
            cpp.close()


if __name__ == "__main__":
    main()
