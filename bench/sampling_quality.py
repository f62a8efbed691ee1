"""Compares our samplers with each other and with other programs', as files and as raw clouds, in one run.

  python bench/sampling_quality.py --shapelight build/release/bin/shapelight --output quality FILES...

Writes quality.csv (every figure) and quality.md (the tables of docs/results.md). Distances are ratios to our farthest
point sample of the same input and count: below 1 is better than farthest points. Nothing here is measured by
shapelight itself: judge.py uses numpy and scipy only.
"""

import argparse
import csv
import resource
import sys
import tempfile
from pathlib import Path

import judge
import numpy as np
import peers

RATIOS = (0.02, 0.05, 0.10, 0.25)
OURS = {"shape": ["--preset", "detail"], "shape, fast": ["--preset", "fast"], "shape, paper": ["--preset", "paper"],
        **{method: ["--method", method] for method in ("farthest", "poisson", "voxel", "stratified", "random")}}
REFERENCE = "farthest"
SIX = {"armadillo", "bunny", "falcon", "horse", "nefertiti", "scorpion"}  # what docs/results.md leads with
LOOKED_AT = {"armadillo", "nefertiti", "falcon", "lucy", "fandisk", "screwdriver", "bunny",
             "dragon_res2"}  # when the constants of the density were set
DISTANCES = ("feature_coverage_mean", "coverage_mean", "coverage_max", "surface_gap")


class Input:
    """A file, or its points as a raw cloud; positions relative to the centre, so that float32 peers lose nothing."""

    def __init__(self, tool, path, as_cloud, folder):
        self.name, self.kind = path.stem, tool.run("info", path)["input"]["kind"]
        flat = folder / "points.ply"
        tool.run("convert", path, flat, "--force")
        everything = judge.positions(judge.read_ply(flat))
        self.finite = np.isfinite(everything).all(axis=1)
        if as_cloud:
            everything = everything[self.finite]
            self.finite = np.ones(len(everything), dtype=bool)
            self.kind, path = "cloud", folder / "cloud.ply"
            judge.write_ply(path, everything)
        self.path = path
        self.everything = everything - 0.5 * (everything[self.finite].min(axis=0) + everything[self.finite].max(axis=0))
        self.points = self.everything[self.finite]
        self.triangles = triangles_of(tool, path, folder) if self.kind == "mesh" else None


def triangles_of(tool, path, folder):
    """Through OFF: three corner indices a line, the same vertices in the same order."""
    off = folder / "mesh.off"
    tool.run("convert", path, off, "--force")
    lines = [line for line in off.read_text().splitlines() if line and not line.startswith("#")]
    num_vertices, num_faces = map(int, lines[1].split()[:2])
    faces = lines[2 + num_vertices:2 + num_vertices + num_faces]
    return np.array([line.split()[1:4] for line in faces], dtype=np.int32)


def on_surface(tool, data):
    """False for the points that shapelight flags as strays: it ranks them behind all others."""
    table, report = tool.sample(data.path, "--ratio", 1, "--order")
    order = np.zeros(len(data.everything), dtype=np.int64)
    order[table["source_index"]] = table["order"]
    result = report["result"]
    return order[data.finite] < result["usable"] - result["duplicates"] - result["outliers"]


def run_ours(tool, data, count, options):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    table, report = tool.sample(data.path, "--count", count, "--threads", 1, *options)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    share = report["seconds"]["sample"] / report["seconds"]["total"]
    return data.everything[table["source_index"]], cpu * share


def measure(tool, data):
    """Yields one row per sampler and ratio."""
    is_feature, kept = judge.features(data.points), on_surface(tool, data)
    others = peers.all_peers(data.points, data.triangles, tool.points)
    for ratio in RATIOS:
        count = max(1, round(ratio * len(data.points)))
        runs = {name: (lambda o=options: run_ours(tool, data, count, o)) for name, options in OURS.items()}
        runs |= {name: (lambda p=peer: p(count)) for name, peer in others.items()}
        for name, run in runs.items():
            done = run()
            if done is None:
                continue
            sample, seconds = done
            yield {"input": data.name, "kind": data.kind, "points": len(data.points), "ratio": ratio, "sampler": name,
                   "count": len(sample), **judge.judge(data.points, is_feature, sample),
                   "surface_gap": judge.judge(data.points[kept], is_feature[kept], sample)["coverage_max"],
                   "strays": len(kept) - int(kept.sum()), "microseconds": 1e6 * seconds / len(data.points)}


def relative_to_reference(rows):
    reference = {(r["input"], r["kind"], r["ratio"]): r for r in rows if r["sampler"] == REFERENCE}
    for row in rows:
        base = reference[row["input"], row["kind"], row["ratio"]]
        yield {**row, **{key: row[key] / base[key] for key in DISTANCES}}


def cell(rows, sampler, ratio, name):
    """Geometric mean (worst)."""
    values = [row[name] for row in rows if row["sampler"] == sampler and row["ratio"] == ratio]
    if not values:
        return "-"
    return f"{np.exp(np.mean(np.log(np.maximum(values, 1e-9)))):.2f} ({max(values):.2f})"


def table(rows, columns):
    """One line per sampler; columns: (title, ratio, name of the figure)."""
    lines = ["| sampler | " + " | ".join(title for title, _, _ in columns) + " |",
             "| --- |" + " ---: |" * len(columns)]
    for sampler in dict.fromkeys(row["sampler"] for row in rows):
        lines.append(f"| {sampler} | " + " | ".join(cell(rows, sampler, r, name) for _, r, name in columns) + " |")
    return "\n".join(lines)


def tables(rows):
    def by_ratio(name):
        return table(rows, [(f"{100 * ratio:g} %", ratio, name) for ratio in RATIOS])

    parts = ["Mean distance of feature points to the sample, ratio to farthest point:",
             by_ratio("feature_coverage_mean")]
    parts += ["Largest gap, ratio to farthest point:", by_ratio("coverage_max")]
    if any(row["strays"] > 0 for row in rows):
        parts += ["The same without the points that shapelight flags as strays:", by_ratio("surface_gap")]
    parts += ["At 10 %: mean distance of all points to the sample (ratio), standard deviation of the spacing over its "
              "mean, CPU microseconds per input point:",
              table(rows, [("mean distance", 0.10, "coverage_mean"), ("spacing", 0.10, "spacing_cv"),
                           ("CPU us/point", 0.10, "microseconds")])]
    return parts


def groups(rows):
    """(title, rows); a mesh may be in two groups."""
    meshes = [r for r in rows if r["kind"] == "mesh"]
    surfaces = {r["input"] for r in meshes}
    clouds = [r for r in rows if r["kind"] == "cloud" and r["input"] in surfaces]
    yield "Six meshes", [r for r in meshes if r["input"] in SIX]
    yield "Other meshes", [r for r in meshes if r["input"] not in SIX]
    yield "Held out: meshes not looked at when constants were set", [r for r in meshes if r["input"] not in LOOKED_AT]
    yield "Vertices of the six meshes as raw clouds", [r for r in clouds if r["input"] in SIX]
    yield "Vertices of the other meshes as raw clouds", [r for r in clouds if r["input"] not in SIX]
    yield "Scans: range images and measured clouds", [r for r in rows if r["input"] not in surfaces]


def markdown(rows):
    parts = []
    for title, group in groups(list(relative_to_reference(rows))):
        if not group:
            continue
        flagged = {True: ", {strays} flagged", False: ""}
        names = ", ".join(dict.fromkeys(
            ("{input} ({points} points" + flagged[row["strays"] > 0] + ")").format(**row) for row in group))
        parts += [f"### {title}", f"{names}. Geometric mean over the inputs (worst one).", *tables(group)]
    return "\n\n".join(parts) + "\n"


def read_csv(path):
    with open(path, newline="") as file:
        return [{k: v if k in ("input", "kind", "sampler") else float(v) if "." in v or "e" in v else int(v)
                 for k, v in row.items()} for row in csv.DictReader(file)]


def write_csv(path, rows):
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--shapelight", default="build/release/bin/shapelight", help="the command line tool")
    parser.add_argument("--output", type=Path, default=Path("quality"), help="OUTPUT.csv and OUTPUT.md are written")
    parser.add_argument("--merge", nargs="*", type=Path, default=[], help="CSV files of earlier runs to include")
    arguments = parser.parse_args()
    if not arguments.files and not arguments.merge:
        parser.error("expected files to measure, or --merge")
    tool = judge.Shapelight(arguments.shapelight)
    rows = [row for path in arguments.merge for row in read_csv(path)]
    folder = Path(tempfile.mkdtemp(dir=tool.folder.name))
    for path in arguments.files:
        as_given = Input(tool, path, False, folder)
        kinds = [as_given, Input(tool, path, True, folder)] if as_given.kind == "mesh" else [as_given]
        for data in kinds:
            print(f"{data.name} as {data.kind}, {len(data.points)} points", file=sys.stderr, flush=True)
            rows += measure(tool, data)
            write_csv(arguments.output.with_suffix(".csv"), rows)  # after each, so that a long run can be cut short
    write_csv(arguments.output.with_suffix(".csv"), rows)
    arguments.output.with_suffix(".md").write_text(markdown(rows))


if __name__ == "__main__":
    main()
