"""Why the pipeline changes its curvature estimator with noise: every estimator at rising noise, meshes and raw clouds.

  python bench/adaptive_choice.py --shapelight build/release/bin/shapelight MESHES...

Noise is in mean edge lengths. Prints two tables as Markdown: the rank correlation of curvedness with that of the clean
mesh (Taubin, one pass), and the mean distance of clean features to a 5 % sample, relative to farthest points.
"""

import argparse
from pathlib import Path

import judge
import numpy as np
from sampling_quality import triangles_of
from scipy.stats import spearmanr
from stage_contribution import write_mesh

NOISE = (0.0, 0.02, 0.05, 0.1, 0.2, 0.4)  # [mean edge lengths]
METHODS = {f"{method}, {passes} passes": ["--curvature-method", method, "--curvature-passes", passes, "--no-denoise"]
           for method, passes in (("taubin", 0), ("taubin", 1), ("taubin", 4), ("quadric", 0), ("quadric", 1),
                                  ("normal-field", 0), ("normal-field", 1))}


def curvedness(tool, path, folder, options):
    tool.run("fields", path, "-o", folder / "fields.ply", "--no-retinex", "--no-segment", "--force", *options)
    return judge.read_ply(folder / "fields.ply")["curvedness"]


def measure(tool, path, folder):
    """{(kind, method, noise): (rank correlation, feature distance)}"""
    points, triangles = tool.points(path), triangles_of(tool, path, folder)
    edges = points[triangles[:, 0]] - points[triangles[:, 1]]
    h = np.linalg.norm(edges, axis=1).mean()
    is_feature = judge.features(points)
    figures = {}
    write_mesh(folder / "clean.ply", points, triangles)
    truth = curvedness(tool, folder / "clean.ply", folder, METHODS["taubin, 1 passes"])
    count = round(0.05 * len(points))
    chosen = tool.sample(folder / "clean.ply", "--count", count, "--method", "farthest")[0]["source_index"]
    base = judge.judge(points, is_feature, points[chosen])["feature_coverage_mean"]
    for level in NOISE:
        moved = points + np.random.default_rng(1).normal(scale=max(level * h, 1e-300), size=points.shape)
        write_mesh(folder / "mesh.ply", moved, triangles)
        judge.write_ply(folder / "cloud.ply", moved)
        for kind in ("mesh", "cloud"):
            for name, options in METHODS.items():
                bend = curvedness(tool, folder / f"{kind}.ply", folder, options)
                known = np.isfinite(bend) & np.isfinite(truth)
                chosen = tool.sample(folder / f"{kind}.ply", "--count", count, *options)[0]["source_index"]
                distance = judge.judge(points, is_feature, points[chosen])["feature_coverage_mean"]
                figures[kind, name, level] = spearmanr(bend[known], truth[known]).statistic, distance / base
    return figures


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--shapelight", default="build/release/bin/shapelight", help="the command line tool")
    arguments = parser.parse_args()
    tool = judge.Shapelight(arguments.shapelight)
    runs = [measure(tool, path, Path(tool.folder.name)) for path in arguments.files]
    for figure, title in enumerate(("Rank correlation of curvedness with the clean mesh's",
                                    "Feature distance of a 5 % sample, relative to farthest points of the clean mesh")):
        for kind in ("mesh", "cloud"):
            print(f"\n{title}, {kind}:\n\n| estimator | " + " | ".join(f"{level:g} h" for level in NOISE) + " |")
            print("| --- |" + " ---: |" * len(NOISE))
            for name in METHODS:
                cells = [f"{np.mean([run[kind, name, level][figure] for run in runs]):.2f}" for level in NOISE]
                print(f"| {name} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
