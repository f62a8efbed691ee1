"""Measures samples with numpy and scipy alone, so that shapelight does not judge itself.

Points are (n, 3) float64 arrays in the units of the file.
"""

import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

FEATURE_NEIGHBORS = 30


def surface_variation(points):
    """Smallest eigenvalue share of the covariance of the 30 nearest points, one per point."""
    _, nearest = cKDTree(points).query(points, k=FEATURE_NEIGHBORS, workers=-1)
    around = points[nearest]
    around -= around.mean(axis=1, keepdims=True)
    eigenvalues = np.linalg.eigvalsh(np.einsum("nki,nkj->nij", around, around))
    return eigenvalues[:, 0] / np.maximum(eigenvalues.sum(axis=1), 1e-300)


def features(points):
    """True for the tenth of the points with the largest surface variation."""
    variation = surface_variation(points)
    return variation >= np.quantile(variation, 0.9)


def judge(points, is_feature, sample):
    """Coverage (distances from points to the nearest sample) and spacing of a sample."""
    tree = cKDTree(sample)
    distance, _ = tree.query(points, workers=-1)
    spacing = tree.query(sample, k=2, workers=-1)[0][:, 1]
    return {
        "coverage_max": distance.max(),
        "coverage_mean": distance.mean(),
        "feature_coverage_mean": distance[is_feature].mean(),
        "spacing_cv": spacing.std() / spacing.mean(),
    }


def write_ply(path, points):
    header = "ply\nformat binary_little_endian 1.0\nelement vertex {}\n{}end_header\n".format(
        len(points), "".join(f"property double {axis}\n" for axis in "xyz"))
    Path(path).write_bytes(header.encode() + np.ascontiguousarray(points, dtype="<f8").tobytes())


def read_ply(path):
    """A binary little-endian PLY of points, as shapelight writes it: {column name: array}."""
    types = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4",
             "float": "<f4", "double": "<f8", "int8": "i1", "uint8": "u1", "int16": "<i2", "uint16": "<u2",
             "int32": "<i4", "uint32": "<u4", "float32": "<f4", "float64": "<f8"}
    data = Path(path).read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    columns, count, in_vertex = [], 0, False
    for line in data[:end].decode().splitlines():
        words = line.split()
        if words[0] == "element":
            in_vertex = words[1] == "vertex"
            count = int(words[2]) if in_vertex else count
        elif words[0] == "property" and in_vertex:
            columns.append((words[2], types[words[1]]))
    return np.frombuffer(data, dtype=columns, count=count, offset=end)


def positions(table):
    return np.stack([table[axis].astype(np.float64) for axis in "xyz"], axis=1)


class Shapelight:
    """Calls the command line tool."""

    def __init__(self, binary):
        self.binary = str(binary)
        self.folder = tempfile.TemporaryDirectory()

    def run(self, *arguments):
        """Runs a command and returns its JSON report."""
        done = subprocess.run([self.binary, *map(str, arguments), "--json", "-", "-q"], capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"{' '.join(map(str, arguments))}: {done.stderr.strip()}")
        return json.loads(done.stdout)

    def points(self, path):
        """All finite points of any file that shapelight reads."""
        out = Path(self.folder.name) / "points.ply"
        self.run("convert", path, out, "--force")
        points = positions(read_ply(out))
        return points[np.isfinite(points).all(axis=1)]

    def sample(self, path, *options):
        """(indices into the input's points, report)."""
        out = Path(self.folder.name) / "sample.ply"
        report = self.run("sample", path, "-o", out, "--index-field", "--force", *options)
        return read_ply(out), report
