#!/usr/bin/env python3
"""Two files in, a pose out: `shapelight register` beside Open3D's global registration, with no starting guess.

  end_to_end.py PAIRS_FOLDER --shapelight build/release/bin/shapelight [--turns 3] [--only NAME...]

PAIRS_FOLDER holds pairs.csv (name, source, target, transform, ...). Each pair is run as it is and with the source turned at
random. Open3D: voxels of 1/60 of the diagonal, normals, FPFH, RANSAC or fast global registration (FGR), then point-to-plane
ICP on voxels a third as large, as in its documentation. Prints Markdown: runs within 3 degrees and 2 % of the diagonal of the
truth, runs that a program reported as good (shapelight: exit code 0; Open3D has no such verdict) but were wrong, the median
rotation error of the right ones, CPU seconds (all threads)."""

import argparse
import csv
import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy
import open3d

KINECT = "585,585,320,240"


def turn(seed):
    rng = numpy.random.default_rng(seed)
    matrix = numpy.eye(4)
    q, r = numpy.linalg.qr(rng.normal(size=(3, 3)))
    q *= numpy.sign(numpy.diag(r))
    matrix[:3, :3] = q * numpy.sign(numpy.linalg.det(q))
    return matrix


def convert(shapelight, path, output):
    extra = ["--intrinsics", KINECT] if path.suffix == ".png" else []
    subprocess.run([shapelight, "convert", path, output, "--force", "-q", *extra], check=True, capture_output=True)
    cloud = open3d.io.read_point_cloud(str(output))
    return cloud.remove_non_finite_points()


def errors(found, truth, cloud):
    middle = numpy.append(cloud.get_axis_aligned_bounding_box().get_center(), 1.0)
    diagonal = numpy.linalg.norm(cloud.get_axis_aligned_bounding_box().get_extent())
    cosine = (numpy.trace(found[:3, :3].T @ truth[:3, :3]) - 1.0) / 2.0
    return numpy.degrees(numpy.arccos(numpy.clip(cosine, -1, 1))), numpy.linalg.norm((found - truth) @ middle) / diagonal


def by_shapelight(shapelight, source, target):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([shapelight, "register", source, target, "--json", "-", "-q"], capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return numpy.array(json.loads(done.stdout)["result"]["T_target_source"]), done.returncode == 0, cpu


def by_open3d(source, target, fast):
    registration = open3d.pipelines.registration
    before = resource.getrusage(resource.RUSAGE_SELF)
    voxel = numpy.linalg.norm(target.get_axis_aligned_bounding_box().get_extent()) / 60

    def prepare(cloud, size):
        thin = cloud.voxel_down_sample(size)
        thin.estimate_normals(open3d.geometry.KDTreeSearchParamHybrid(radius=2 * size, max_nn=30))
        return thin

    clouds = [prepare(c, voxel) for c in (source, target)]
    features = [registration.compute_fpfh_feature(
        c, open3d.geometry.KDTreeSearchParamHybrid(radius=5 * voxel, max_nn=100)) for c in clouds]
    if fast:
        option = registration.FastGlobalRegistrationOption(maximum_correspondence_distance=0.5 * voxel)
        coarse = registration.registration_fgr_based_on_feature_matching(*clouds, *features, option)
    else:
        open3d.utility.random.seed(1)
        coarse = registration.registration_ransac_based_on_feature_matching(
            *clouds, *features, True, 1.5 * voxel, registration.TransformationEstimationPointToPoint(False), 3,
            [registration.CorrespondenceCheckerBasedOnEdgeLength(0.9),
             registration.CorrespondenceCheckerBasedOnDistance(1.5 * voxel)],
            registration.RANSACConvergenceCriteria(100000, 0.999))
    fine = [prepare(c, voxel / 3) for c in (source, target)]
    result = registration.registration_icp(*fine, 0.4 * voxel, coarse.transformation,
                                           registration.TransformationEstimationPointToPlane())
    after = resource.getrusage(resource.RUSAGE_SELF)
    return result.transformation, None, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pairs", type=Path)
    parser.add_argument("--shapelight", default="build/release/bin/shapelight")
    parser.add_argument("--turns", type=int, default=3)
    parser.add_argument("--only", nargs="*", default=[])
    arguments = parser.parse_args()
    open3d.utility.set_verbosity_level(open3d.utility.VerbosityLevel.Error)
    print("| pair | program | right | wrong but reported as good | rotation error, median of the right [deg] | CPU [s] |")
    print("| --- | --- | ---: | ---: | ---: | ---: |")
    with open(arguments.pairs / "pairs.csv") as file, tempfile.TemporaryDirectory() as folder:
        for row in csv.DictReader(file):
            if arguments.only and row["name"] not in arguments.only:
                continue
            source = convert(arguments.shapelight, arguments.pairs / row["source"], Path(folder) / "source.ply")
            target = convert(arguments.shapelight, arguments.pairs / row["target"], Path(folder) / "target.ply")
            truth = numpy.loadtxt(arguments.pairs / row["transform_source_to_target"])
            results = {"shapelight": [], "Open3D RANSAC": [], "Open3D FGR": []}
            for seed in range(arguments.turns):
                T_turned_source = turn(seed) if seed else numpy.eye(4)
                turned = open3d.geometry.PointCloud(source).transform(T_turned_source)
                open3d.io.write_point_cloud(f"{folder}/turned.ply", turned)
                expected = truth @ numpy.linalg.inv(T_turned_source)
                for name, run in (("shapelight", lambda: by_shapelight(arguments.shapelight, f"{folder}/turned.ply",
                                                                        f"{folder}/target.ply")),
                                  ("Open3D RANSAC", lambda: by_open3d(turned, target, False)),
                                  ("Open3D FGR", lambda: by_open3d(turned, target, True))):
                    found, reported, cpu = run()
                    results[name].append((*errors(found, expected, turned), reported, cpu))
            for name, runs in results.items():
                right = [rotation for rotation, shift, _, _ in runs if rotation < 3 and shift < 0.02]
                false = sum(bool(reported) and not (rotation < 3 and shift < 0.02) for rotation, shift, reported, _ in runs)
                print(f"| {row['name']} | {name} | {len(right)}/{len(runs)} | {false if name == 'shapelight' else '-'} | "
                      f"{numpy.median(right) if right else float('nan'):.3f} | "
                      f"{numpy.median([cpu for *_, cpu in runs]):.2f} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
