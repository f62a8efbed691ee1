"""What each stage adds to a sample: coverage with stages switched on and off, clean and with noise.

  python bench/stage_contribution.py --shapelight build/release/bin/shapelight --output stages FILES...

Noise is Gaussian, 0.1 % of the diagonal in every coordinate. Features are those of the clean mesh, and distances are
between the clean places of the points, so that a sampler gains nothing by choosing noise. Ratios are to farthest
points of the clean mesh. Writes stages.csv and stages.md (the table of docs/results.md).
"""

import argparse
import csv
import sys
from pathlib import Path

import judge
import numpy as np
from sampling_quality import triangles_of

RATIOS = (0.05, 0.10)
NOISE = 0.001  # [diagonal]
SMOOTH_SHAPE_INDEX = ["--shape-index", "regularised", "--curvature-passes", "1"]
VARIANTS = {
    "farthest": ["--method", "farthest"],
    "detail": [],
    "detail, no NLM": ["--no-denoise"],
    "detail, no Retinex": ["--no-retinex"],
    "fast (neither)": ["--preset", "fast"],
    "detail, literal shape index": ["--shape-index", "literal"],
    "paper": ["--preset", "paper"],
    "paper, no NLM": ["--preset", "paper", "--no-denoise"],
    "paper, no Retinex (segments of s)": ["--preset", "paper", "--no-retinex"],
    "paper, no segments": ["--preset", "paper", "--no-segment"],
    "paper, regularised shape index": ["--preset", "paper", *SMOOTH_SHAPE_INDEX],
    "random": ["--method", "random"],
}


def write_mesh(path, points, triangles):
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
              + "".join(f"property double {axis}\n" for axis in "xyz")
              + f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n")
    faces = np.zeros(len(triangles), dtype=[("count", "u1"), ("corner", "<i4", 3)])
    faces["count"], faces["corner"] = 3, triangles
    path.write_bytes(header.encode() + points.astype("<f8").tobytes() + faces.tobytes())


def near_features(points, is_feature):
    """Features and their neighbours within one typical spacing: a sample there is on or next to a feature."""
    tree = judge.cKDTree(points)
    spacing = np.median(tree.query(points, k=2, workers=-1)[0][:, 1])
    distance, _ = judge.cKDTree(points[is_feature]).query(points, workers=-1)
    return distance <= spacing


def measure(tool, path, folder):
    points, triangles = tool.points(path), triangles_of(tool, path, folder)
    is_feature = judge.features(points)
    near = near_features(points, is_feature)
    diagonal = np.linalg.norm(points.max(axis=0) - points.min(axis=0))
    reference = {}  # farthest points of the clean mesh, which come first
    for level in (0.0, NOISE):
        moved = folder / "moved.ply"
        noise = np.random.default_rng(1).normal(scale=level * diagonal, size=points.shape) if level > 0.0 else 0.0
        write_mesh(moved, points + noise, triangles)
        for ratio in RATIOS:
            for name, options in VARIANTS.items():
                table, report = tool.sample(moved, "--count", round(ratio * len(points)), *options)
                chosen = table["source_index"]
                figures = judge.judge(points, is_feature, points[chosen])
                base = reference.setdefault(ratio, figures)
                yield {"input": path.stem, "noise": level, "ratio": ratio, "variant": name,
                       "features": figures["feature_coverage_mean"] / base["feature_coverage_mean"],
                       "gap": figures["coverage_max"] / base["coverage_max"],
                       "on_features": near[chosen].mean(), "chance": near.mean(),
                       "denoised": int(report["result"]["denoised"])}


def markdown(rows):
    lines = []
    for level in dict.fromkeys(row["noise"] for row in rows):
        here = [row for row in rows if row["noise"] == level]
        names = ", ".join(dict.fromkeys(row["input"] for row in here))
        chance = np.mean([row["chance"] for row in here])
        lines += [f"### {'Clean' if level == 0.0 else f'Noise, {100 * level:g} % of the diagonal'}", "",
                  f"{names}. On or next to features by chance: {100 * chance:.0f} %.", "",
                  "| variant | NLM ran on | " + " | ".join(
                      f"features {r:.0%} | gap {r:.0%} (worst) | on features {r:.0%}" for r in RATIOS) + " |",
                  "| --- | ---: |" + " ---: |" * 3 * len(RATIOS)]
        for name in VARIANTS:
            of = [row for row in here if row["variant"] == name]
            cells = [f"{sum(r['denoised'] for r in of) // len(RATIOS)} of {len(of) // len(RATIOS)}"]
            for ratio in RATIOS:
                at = [row for row in of if row["ratio"] == ratio]
                mean = {key: np.exp(np.mean([np.log(row[key]) for row in at])) for key in ("features", "gap")}
                cells += [f"{mean['features']:.2f}", f"{mean['gap']:.2f} ({max(row['gap'] for row in at):.2f})",
                          f"{100 * np.mean([row['on_features'] for row in at]):.0f} %"]
            lines.append(f"| {name} | " + " | ".join(cells) + " |")
        lines.append("")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", type=Path)
    parser.add_argument("--shapelight", default="build/release/bin/shapelight", help="the command line tool")
    parser.add_argument("--output", type=Path, default=Path("stages"), help="OUTPUT.csv and OUTPUT.md are written")
    arguments = parser.parse_args()
    tool = judge.Shapelight(arguments.shapelight)
    rows = []
    for path in arguments.files:
        print(path, file=sys.stderr, flush=True)
        rows += measure(tool, path, Path(tool.folder.name))
    with open(arguments.output.with_suffix(".csv"), "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    arguments.output.with_suffix(".md").write_text(markdown(rows))


if __name__ == "__main__":
    main()
