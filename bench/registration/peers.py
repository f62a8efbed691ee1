"""small_gicp and Open3D on the samples and starts that registration_experiment exported: the same rows as its own.

  python3 bench/registration/peers.py EXPORTED --output peers.csv [--samplers shape-nb stratified] [--percent 5]

A package that is not installed is skipped with a line. Single-threaded; CPU time of preprocessing (trees, normals,
covariances of the samples) and of registration apart.
"""

import argparse
import csv
import importlib
import os
import sys
import time
from pathlib import Path

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np  # noqa: E402, after the number of threads

GATE = 0.1  # of the target's diagonal, as in our own runs
NEIGHBORS = 20


def error_of(pose, truth, middle, diagonal):
    """(rotation [degrees], shift of the middle of the overlap [diagonals])."""
    apart = truth[:3, :3].T @ pose[:3, :3]
    sine = 0.5 * np.linalg.norm([apart[2, 1] - apart[1, 2], apart[0, 2] - apart[2, 0], apart[1, 0] - apart[0, 1]])
    shift = (pose - truth) @ np.append(middle, 1.0)
    return np.degrees(np.arctan2(sine, 0.5 * (np.trace(apart) - 1))), np.linalg.norm(shift[:3]) / diagonal


class SmallGicp:
    MODULE = "small_gicp"
    TYPES = {"small_gicp icp": "ICP", "small_gicp plane": "PLANE_ICP", "small_gicp gicp": "GICP"}

    def __init__(self, source, target, diagonal):
        import small_gicp
        self.library, self.diagonal = small_gicp, diagonal
        self.clouds = [small_gicp.PointCloud(points[:, :3]) for points in (target, source)]
        for cloud in self.clouds:
            small_gicp.estimate_normals_covariances(cloud, num_neighbors=NEIGHBORS, num_threads=1)
        self.tree = small_gicp.KdTree(self.clouds[0], num_threads=1)

    def __call__(self, method, start):
        found = self.library.align(*self.clouds, self.tree, start, registration_type=self.TYPES[method],
                                   max_correspondence_distance=GATE * self.diagonal, num_threads=1,
                                   max_iterations=100, rotation_epsilon=1e-6,
                                   translation_epsilon=1e-6 * self.diagonal)
        return found.T_target_source, found.iterations


class Open3d:
    MODULE = "open3d"
    TYPES = {"open3d icp": "TransformationEstimationPointToPoint",
             "open3d plane": "TransformationEstimationPointToPlane",
             "open3d gicp": "TransformationEstimationForGeneralizedICP"}

    def __init__(self, source, target, diagonal):
        import open3d
        self.registration, self.diagonal = open3d.pipelines.registration, diagonal
        self.clouds = []
        for points in (source, target):
            cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(np.ascontiguousarray(points[:, :3])))
            cloud.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(NEIGHBORS))
            self.clouds.append(cloud)

    def __call__(self, method, start):
        align = (self.registration.registration_generalized_icp if method.endswith("gicp")
                 else self.registration.registration_icp)
        estimation = getattr(self.registration, self.TYPES[method])()
        criteria = self.registration.ICPConvergenceCriteria(1e-7, 1e-7, 100)
        found = align(*self.clouds, GATE * self.diagonal, start, estimation, criteria)
        return found.transformation, ""


def measure(peer, folder, samples, rows):
    truth, starts = (np.loadtxt(folder / f).reshape(-1, 4, 4) for f in ("truth.txt", "starts.txt"))
    *middle, diagonal = np.loadtxt(folder / "middle.txt")
    source, target = (np.loadtxt(samples / f"{which}.xyz") for which in ("source", "target"))
    sampler, percent = samples.name.rsplit("-", 1)
    begin = time.process_time()
    aligner = peer(source, target, diagonal)
    prepare_ms = 1e3 * (time.process_time() - begin)
    for method in peer.TYPES:
        for i, start in enumerate(starts):
            begin = time.process_time()
            pose, iterations = aligner(method, start)
            cpu_ms = 1e3 * (time.process_time() - begin)
            rotation, shift = error_of(np.asarray(pose), truth[0], middle, diagonal)
            rows.append({"pair": folder.name, "sampler": sampler, "percent": percent, "method": method, "start": i,
                         "rotation_deg": rotation, "shift": shift, "success": int(rotation < 2 and shift < 0.01),
                         "iterations": iterations, "prepare_cpu_ms": prepare_ms, "cpu_ms": cpu_ms})


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("exported", type=Path)
    parser.add_argument("--output", type=Path, required=True)
    parser.add_argument("--samplers", nargs="*", default=["shape-nb", "stratified"])
    parser.add_argument("--percent", nargs="*", default=["5"])
    arguments = parser.parse_args()
    rows = []
    for peer in (SmallGicp, Open3d):
        try:
            importlib.import_module(peer.MODULE)
        except ImportError as error:
            print(f"{peer.MODULE}: not installed, skipped ({error})", file=sys.stderr)
            continue
        for folder in sorted(p for p in arguments.exported.iterdir() if p.is_dir()):
            for sampler in arguments.samplers:
                for percent in arguments.percent:
                    samples = folder / f"{sampler}-{percent}"
                    if samples.is_dir():
                        measure(peer, folder, samples, rows)
    with open(arguments.output, "w", newline="") as file:
        if rows:
            writer = csv.DictWriter(file, rows[0])
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main()
