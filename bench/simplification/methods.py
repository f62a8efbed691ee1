"""Every way to simplify that the experiments compare: METHOD(mesh.off, vertices, result.off) -> CPU seconds."""

import hashlib
import importlib.metadata
import json
import resource
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).parent
TIMEOUT = 100  # seconds; a peer that hangs is a failed cell

SHAPELIGHT = {
    "QSlim": ["--method", "qslim"],
    "QSlim, border 1000": ["--method", "qslim", "--boundary-weight", 1000],
    "SSim paper": ["--method", "ssim-paper", "--preset", "paper"],
    "SSim": ["--method", "ssim"],
    "SSim, no samples": ["--method", "ssim", "--sample-weight", 1],
    "QEM optimal": ["--method", "qslim", "--placement", "optimal"],
    "SSim free, fast": ["--method", "ssim", "--placement", "optimal", "--preset", "fast"],
    "SSim free, best": ["--method", "ssim", "--placement", "optimal", "--preset", "best"],
}
PROGRAMS = {"CGAL Lindstrom-Turk": ["cgal_collapse", "lt"], "CGAL Garland-Heckbert": ["cgal_collapse", "gh"],
            "OpenMesh": ["openmesh_quadric"]}
PYTHON = {"meshoptimizer": "meshoptimizer", "Open3D": "open3d", "fast-simplification": "fast_simplification",
          "MeshLab": "pymeshlab"}
ON_INPUT_VERTICES = {"QSlim", "QSlim, border 1000", "SSim paper", "SSim", "SSim, no samples", "OpenMesh",
                     "meshoptimizer"}


class Failed(Exception):
    """A program gave no result."""


def digest(path):
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()[:16]


def run(command):
    """(stdout, CPU seconds of the process)."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    try:
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True, timeout=TIMEOUT)
    except subprocess.TimeoutExpired as error:
        raise Failed(f"no result within {TIMEOUT} s") from error
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        raise Failed((done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1])
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


class Method:
    """`identity` changes when the program or its options do: a cached result counts only for the same identity."""

    def __init__(self, name, command, identity, without_files=False):
        self.name, self.command, self.identity, self.without_files = name, command, identity, without_files

    def __call__(self, source, vertices, target):
        stdout, cpu = run(self.command(source, vertices, target))
        report = json.loads(stdout.strip().splitlines()[-1] if not self.without_files else stdout)
        if not self.without_files:
            return report["cpu_seconds"]
        seconds = report["seconds"]
        return cpu * (seconds["total"] - seconds.get("read", 0) - seconds.get("write", 0)) / seconds["total"]


def shapelight(binary, name, options):
    """One thread; CPU time of the process without its share for reading and writing."""
    def command(source, vertices, target):
        return [binary, "simplify", source, "-o", target, "--vertices", vertices, "--threads", 1, "--force", "-q",
                "--json", "-", *options]

    return Method(name, command, f"{digest(binary)} {options}", without_files=True)


def program(path, name, options):
    return Method(name, lambda source, vertices, target: [path, *options, source, target, vertices],
                  f"{digest(path)} {options}")


def python_peer(name, peer):
    package = peer.replace("_", "-")
    return Method(name, lambda source, vertices, target: [sys.executable, HERE / "python_peers.py", peer, source,
                                                          target, vertices],
                  f"{package} {importlib.metadata.version(package)} {digest(HERE / 'python_peers.py')}")


def all_methods(shapelight_binary, rivals):
    """{name: Method} of everything that is installed."""
    found = {}
    if shutil.which(shapelight_binary):
        found |= {name: shapelight(shapelight_binary, name, options) for name, options in SHAPELIGHT.items()}
    for name, (file, *options) in PROGRAMS.items():
        if (Path(rivals) / file).exists():
            found[name] = program(Path(rivals) / file, name, options)
    for name, peer in PYTHON.items():
        try:
            found[name] = python_peer(name, peer)
        except importlib.metadata.PackageNotFoundError:
            pass
    return found
