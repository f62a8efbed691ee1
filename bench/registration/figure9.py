"""Figure 9 of the paper, and more: registration on samples, against the share of points kept.

  python3 bench/registration/figure9.py --shapelight-build build/bench [--pairs DIR] [--meshes FILE...]

Runs registration_experiment on the shipped scans and on virtual scans of the shipped meshes; --pairs DIR adds the
Stanford pairs (stanford_bunny/, stanford_dragon/), --meshes one virtual pair each. Then the peers that are installed.
Finished cells are kept, so that a run can be cut short. Writes the tables of docs/results-registration.md, between its
marks, and plots into docs/images.
"""

import argparse
import csv
import datetime
import subprocess
import sys
from pathlib import Path

import analysis
import plan

ROOT = Path(__file__).resolve().parents[2]
PERCENTS = [95.0, 50.0, 25.0, 10.0, 5.0]
MARK = "<!-- measured: written by bench/registration/figure9.py -->"


def plain_ticks(axis):
    """1, 2 and 5 in every decade, as numbers."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())


def plots(runs, folder):
    import matplotlib
    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "shapelight"
    import matplotlib.pyplot as plt

    folder.mkdir(parents=True, exist_ok=True)
    columns = {"rotation_deg": "rotation error [degrees]", "relative_e_mu": "e_mu / e_mu at the truth",
               "relative_e_delta": "e_delta / e_delta at the truth", "cpu_ms": "CPU [ms]"}
    for method, name in (("ficp-pure", "FICP"), ("softicp", "SoftICP")):
        figure, panels = plt.subplots(1, len(columns), figsize=(13, 3.2))
        for panel, (column, label) in zip(panels, columns.items()):
            for sampler in plan.FEW_SAMPLERS:
                common = set.intersection(*(set(runs.pairs(method, sampler, p)) for p in PERCENTS))
                line = [analysis.median_of([v for pair, v in runs.per_pair(method, sampler, p, column).items()
                                            if pair in common]) for p in PERCENTS]
                if common and None not in line:
                    panel.plot(range(len(PERCENTS)), line, marker="o", markersize=3, label=sampler)
            panel.set_xticks(range(len(PERCENTS)), [f"{p:g}" for p in PERCENTS])
            panel.set_xlabel("P [% kept]")
            panel.set_ylabel(label)
            if column in ("rotation_deg", "cpu_ms"):
                panel.set_yscale("log")
                plain_ticks(panel.yaxis)
        panels[0].legend(fontsize=7)
        figure.suptitle(f"{name}: median of the pairs that were run at every P", fontsize=10)
        figure.tight_layout()
        figure.savefig(folder / f"registration-{method}.svg", metadata={"Date": None})
        plt.close(figure)
    return ["registration-ficp-pure.svg", "registration-softicp.svg"]


def ratio_plot(runs, path, percent=5.0):
    """Ratios to stratified samples with their intervals: what Fig. 9 is about."""
    import matplotlib.pyplot as plt

    samplers = [s for s in plan.SAMPLERS if s != analysis.SPS]
    figure, panels = plt.subplots(1, 3, figsize=(11, 3.2), sharey=True)
    for panel, method in zip(panels, ("ficp", "softicp", "gicp")):
        for i, sampler in enumerate(samplers):
            r = analysis.ratio(runs.solved(method, sampler, percent, "rotation_deg"),
                               runs.solved(method, analysis.SPS, percent, "rotation_deg"))
            if r:
                panel.plot([r["low"], r["high"]], [i, i], color="C0")
                panel.plot(r["ratio"], i, "o", color="C0")
        panel.axvline(1.0, color="grey", linewidth=0.8)
        panel.set_xscale("log")
        plain_ticks(panel.xaxis)
        panel.set_title(method, fontsize=10)
        panel.set_xlabel(f"error / error with {analysis.SPS}")
        panel.set_yticks(range(len(samplers)), samplers)
        panel.invert_yaxis()
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def document(runs, samplings, peers, images, arguments):
    pairs = sorted(runs.truth)
    overlap = {row["pair"]: float(row["overlap"]) for row in samplings}
    methods = plan.METHODS
    points = {row["pair"]: (row["source_points"], row["target_points"]) for row in samplings}
    parts = [
        f"Measured on {len(pairs)} pairs, {sum(t == 'exact' for t in runs.truth.values())} of them virtual scans with "
        f"exact truth. {arguments.starts} starts per cell at P of 10 and 5 %, 3 at 25 %, 1 above. "
        f"{datetime.date.today().isoformat()}.\n",
        "## What the paper says, and what was measured\n\nA ratio below 1 means the first is better, over the pairs "
        "that both solve from half of the starts or more; in brackets the 95 % interval, bootstrapped over pairs. A "
        "claim holds when the whole interval says so; with this many claims, one in twenty does by chance.\n\n"
        + analysis.markdown_table(["claim", "measured", "verdict"], analysis.claims(runs, samplings)),
        "## What we aim at\n\n"
        + analysis.markdown_table(["target", "measured", ""], analysis.targets(runs, samplings)),
        *(f"## Rotation error at P = {p:g} %\n\nMedian over pairs of successful runs [degrees], and the share of "
          "successes (rotation below 2 degrees and the middle of the overlap within 1 % of the diagonal).\n\n"
          + analysis.accuracy_table(runs, methods, plan.SAMPLERS, p)
          + f"\nRotation error over that with `{analysis.SPS}` samples, over the pairs that both solve:\n\n"
          + analysis.ratio_table(runs, methods, plan.SAMPLERS, p) for p in (10.0, 5.0)),
        "## Which pairs are not solved (P = 5 %)\n\nShare of successes, where it is not 100 % throughout.\n\n"
        + analysis.unsolved_table(runs, ["ficp", "ficp-pure", "softicp", "gicp"], [analysis.SBS, analysis.SPS], 5.0),
        "## The border or the shape? (P = 5 %)\n\n" + analysis.border_table(runs, methods, 5.0),
        "## Do two samplings keep the same places? (P = 5 %)\n\n" + analysis.sampling_table(samplings, 5.0),
        "## Against P\n\nRotation error [degrees] / e_mu on the full scans over e_mu at the truth / CPU of the registration "
        "[ms]: medians over the pairs that were run at every P.\n\n"
        + analysis.sweep_table(runs, ["ficp", "ficp-pure", "softicp", "gicp"], plan.FEW_SAMPLERS, PERCENTS)
        + "".join(f"\n![{image}](images/{image})\n" for image in images),
        "## With the polish (P = 5 %)\n\nRotation error before and after the tool's last step, the sampled source "
        "against the full target.\n\n" + analysis.polish_table(runs, methods, plan.SAMPLERS, 5.0)
        + f"\nAfter ficp, error with `{analysis.SBS}` samples over that with `{analysis.SPS}` ones: "
        f"{analysis.polish_ratio(runs, 'ficp', 5.0)}.\n",
    ]
    if peers:
        parts.append("## Others on the same samples and starts (P = 5 %)\n\nOne thread; `preparing` is what a package "
                     "does to the samples first (trees, normals, covariances; ours takes the full scan's normals).\n\n"
                     + analysis.peer_table(runs, analysis.Runs(peers), ["shape-nb", "stratified"], 5.0))
    parts.append("## The pairs\n\n" + analysis.markdown_table(
        ["pair", "truth", "points", "overlap"],
        [[p, runs.truth[p], " / ".join(points[p]), f"{overlap[p]:.2f}"] for p in pairs]))
    return "\n".join(parts)


def replace_measured(page, text):
    """Replaces what follows the mark; what people wrote above it stays."""
    above = page.read_text().split(MARK)[0] if page.exists() else "# Results: registration\n\n"
    page.write_text(f"{above}{MARK}\n\n{text}")


def run_peers(exported, output):
    peers = Path(__file__).with_name("peers.py")
    subprocess.run([sys.executable, peers, exported, "--output", output], check=True)
    return plan.read_csv(output)


def write_csv(path, rows):
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--shapelight-build", type=Path, default=ROOT / "build/bench")
    parser.add_argument("--data", type=Path, default=ROOT / "data", help="folder with meshes/ and scans/")
    parser.add_argument("--pairs", type=Path, help="folder with stanford_bunny/ and stanford_dragon/")
    parser.add_argument("--meshes", type=Path, nargs="*", default=[], help="more meshes to scan")
    parser.add_argument("--starts", type=int, default=20)
    parser.add_argument("--jobs", type=int, default=2, help="processes at once")
    parser.add_argument("--quick", action="store_true", help="P of 5 and 25 %% only")
    parser.add_argument("--output", type=Path, default=ROOT / "build/figure9", help="folder of cells and CSV files")
    parser.add_argument("--document", type=Path, default=ROOT / "docs/results-registration.md")
    arguments = parser.parse_args()
    binary = arguments.shapelight_build / "bin/registration_experiment"
    if not binary.exists():
        sys.exit(f"{binary}: not there; cmake --preset bench && cmake --build --preset bench")

    exported = arguments.output / "exported"
    all_jobs = plan.jobs(plan.pairs(arguments.data, arguments.pairs, arguments.meshes), arguments)
    rows, samplings = plan.run(binary, all_jobs, arguments.output / "cells", exported, arguments.jobs)
    if not rows:
        sys.exit("no cell was finished")
    peers = run_peers(exported, arguments.output / "peers.csv")
    for name, table in (("runs.csv", rows), ("samplings.csv", samplings)):
        write_csv(arguments.output / name, table)
    runs, images = analysis.Runs(rows), []
    try:
        folder = arguments.document.parent / "images"
        images = plots(runs, folder)
        ratio_plot(runs, folder / "registration-ratios.svg")
        images.append("registration-ratios.svg")
    except ImportError:
        print("matplotlib: not installed, no plots", file=sys.stderr)
    replace_measured(arguments.document, document(runs, samplings, peers, images, arguments))
    print(arguments.document)


if __name__ == "__main__":
    main()
