"""Compares `shapelight metrics` with Metro, MeshLab and Open3D, in one run.

  python bench/metrics_agreement.py --shapelight build/bench/bin/shapelight [--metro FOLDER] MESHES...

FOLDER holds Metro's own sample: knot_orig.ply, knot_subsampled.ply and its output for each, *_metro.ply, with the
distance to the other mesh as the vertex property `quality` (VCGLib, apps/metro/sample; GPL, not shipped here).
Every mesh is measured against itself decimated to a tenth by MeshLab. Times are CPU seconds: ours of the whole process
with one thread, files, normals and vertices included; peers' of the calls alone.
"""

import argparse
import json
import resource
import subprocess
import tempfile
import time
from pathlib import Path

import judge
import numpy as np
import open3d as o3d
import pymeshlab

SHARE = 0.1  # of the faces
SAMPLES = 1000000  # per surface: MeshLab's are independent, and a heavy tail needs many
DIRECTIONS = ("forward", "backward")


def children_cpu():
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def timed(work):
    start = time.process_time()
    return work(), time.process_time() - start


def shapelight_metrics(tool, reference, test, *options):
    start = children_cpu()
    done = subprocess.run([tool, "metrics", reference, test, "--json", "-", "--threads", "1", "-q", *options],
                          check=True, capture_output=True, text=True)
    return json.loads(done.stdout)["result"], children_cpu() - start


def agree_with_metro(tool, folder, scratch):
    pairs = (("knot_orig", "knot_subsampled"), ("knot_subsampled", "knot_orig"))
    print("| vertices of | to | largest difference from Metro | largest distance |\n| --- | --- | --- | --- |")
    for test, reference in pairs:
        out = scratch / f"{test}.ply"
        shapelight_metrics(tool, folder / f"{reference}.ply", folder / f"{test}.ply", "-o", out, "--samples", "1000")
        ours = np.asarray(judge.read_ply(out)["distance"], dtype=float)
        metro = np.asarray(judge.read_ply(folder / f"{test}_metro.ply")["quality"], dtype=float)
        print(f"| {test} ({len(ours)}) | {reference} | {np.abs(ours - metro).max():.2g} | {metro.max():.6g} |")


def meshlab_filter(meshes, direction, vertices, surface):
    """One direction; `meshes` holds the reference as 0, the test as 1."""
    sampled, target = (0, 1) if direction == "forward" else (1, 0)
    return meshes.get_hausdorff_distance(sampledmesh=sampled, targetmesh=target, samplevert=vertices, sampleedge=False,
                                         sampleface=surface, samplenum=SAMPLES,
                                         maxdist=pymeshlab.PercentageValue(100))


def meshlab_distances(meshes, direction):
    """Means of samples of the area alone, since MeshLab would mix the vertices in; maxima of both."""
    surface, vertices = meshlab_filter(meshes, direction, False, True), meshlab_filter(meshes, direction, True, False)
    return {"mean": surface["mean"], "rms": surface["RMS"], "max": max(surface["max"], vertices["max"])}


def open3d_closest(mesh, points):
    scene = o3d.t.geometry.RaycastingScene(nthreads=1)
    scene.add_triangles(mesh.vertex_matrix().astype(np.float32), mesh.face_matrix().astype(np.uint32))
    return scene.compute_closest_points(points, nthreads=1)["points"].numpy()


def random_points(mesh, count, rng):
    corners = mesh.vertex_matrix()[mesh.face_matrix()]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    chosen = corners[np.sort(rng.choice(len(area), size=count, p=area / area.sum()))]  # neighbours follow each other
    weights = rng.dirichlet((1, 1, 1), size=count)
    return np.einsum("nk,nkd->nd", weights, chosen).astype(np.float32)


def agree_with_meshlab(tool, path, scratch, rng):
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.load_new_mesh(str(path))
    meshes.meshing_remove_unreferenced_vertices()  # MeshLab would measure them too
    meshes.generate_copy_of_current_mesh()
    meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=int(SHARE * meshes.current_mesh().face_number()))
    reference, test = scratch / f"{path.stem}.ply", scratch / f"{path.stem}_reduced.ply"
    for number, file in ((0, reference), (1, test)):
        meshes.set_current_mesh(number)
        meshes.save_current_mesh(str(file))
    ours, our_time = shapelight_metrics(tool, reference, test, "--samples", str(SAMPLES))
    their_time = timed(lambda: [meshlab_filter(meshes, direction, True, True) for direction in DIRECTIONS])[1]
    open3d_time = 0.0
    for sampled, target in ((0, 1), (1, 0)):
        points = random_points(meshes.mesh(sampled), SAMPLES, rng)
        open3d_time += timed(lambda: open3d_closest(meshes.mesh(target), points))[1]
    for name in DIRECTIONS:
        theirs = meshlab_distances(meshes, name)
        cells = [f"{ours[name][key]:.5g} ({ours[name][key] / theirs[key] - 1:+.2%})" for key in theirs]
        print(f"| {path.stem}, {name} | {' | '.join(cells)} | |")
    print(f"| {path.stem}, CPU s | shapelight {our_time:.2f} | MeshLab {their_time:.2f} ({their_time / our_time:.1f} x) | "
          f"Open3D {open3d_time:.2f} ({open3d_time / our_time:.1f} x) | {SAMPLES} samples |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shapelight", required=True)
    parser.add_argument("--metro", type=Path)
    parser.add_argument("meshes", nargs="*", type=Path)
    arguments = parser.parse_args()
    rng = np.random.default_rng(0)
    with tempfile.TemporaryDirectory() as folder:
        if arguments.metro:
            agree_with_metro(arguments.shapelight, arguments.metro, Path(folder))
        print("\n| ours (difference from MeshLab) | mean | rms | max | |\n| --- | --- | --- | --- | --- |")
        for path in arguments.meshes:
            agree_with_meshlab(arguments.shapelight, path, Path(folder), rng)


if __name__ == "__main__":
    main()
