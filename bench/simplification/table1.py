"""Table 1 of the paper, on meshes that are to be had: every method at 50, 90 and 95 % of the vertices removed.

  python bench/simplification/table1.py --data data --output out

Writes table1.csv (every figure), table1.md (the tables of docs/results-simplification.md) and table1.svg. The judge is
mesh_judge of bench/rivals, which shares no code with shapelight. A run that was cut short goes on where it stopped.
"""

import sys
from pathlib import Path

import cells
import methods
import numpy as np
from cells import FIGURES

REMOVED = (0.50, 0.90, 0.95)
BASES = ("QSlim", "CGAL Lindstrom-Turk")
MESHES = ("bunny", "falcon", "nefertiti", "horse", "lucy", "scorpion", "armadillo", "dragon_res2", "turbine_blade",
          "fandisk")  # in the place of: tubby, bird, buddha, duck, angel, lobster, frog (three and four), valve
SCANS = ("bun000", "dragonStandRight_0")
PLOTTED = (0.1, 10)  # ratios beyond are drawn at the edge
TUNED = ("fandisk", "bunny", "armadillo")  # constants of SSim were set on these


def find_inputs(data):
    """{name: path} in the order above, of what the folder has."""
    found = {}
    for name in (*MESHES, *SCANS):
        at = [p for folder in ("meshes", "scans", "pairs/*") for p in sorted(Path(data).glob(f"{folder}/{name}.*"))]
        if at:
            found[name] = at[0]
    return found


def markdown_table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "| --- |" + " ---: |" * (len(head) - 1)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def ratios_to(rows, base, method, figure):
    """{(mesh, share removed): ratio of `method` to `base`}"""
    by_cell = {(r["mesh"], r["removed"], r["method"]): r[figure] for r in rows if "rms" in r}
    return {(mesh, removed): value / by_cell[mesh, removed, base] for (mesh, removed, name), value in by_cell.items()
            if name == method and (mesh, removed, base) in by_cell}


def number(value):
    return f"{value:.2f}" if value < 100 else f"{value:.0f}"


def ratio_row(rows, base, method):
    """Geometric means of every figure, and of the RMS distance the worst cell and how many cells are below 1."""
    texts = []
    for figure in FIGURES:
        ratios = ratios_to(rows, base, method, figure)
        values = [[v for (_, r), v in ratios.items() if r == removed] for removed in REMOVED]
        texts.append(" / ".join(number(cells.geometric_mean(v)) if v else "-" for v in values))
    distances = ratios_to(rows, base, method, "rms")
    worst = max(distances, key=distances.get)
    return [method, *texts, f"{number(distances[worst])} ({worst[0]} {100 * worst[1]:g} %)",
            f"{sum(v < 1 for v in distances.values())} of {len(distances)}"]


def summary(rows, names):
    shares = " / ".join(f"{100 * removed:g}" for removed in REMOVED)
    head = ["method", "RMS", "largest", "normals", "CPU", "worst RMS", "RMS below 1"]
    for base in BASES:
        table = [ratio_row(rows, base, name) for name in names if name != base and ratios_to(rows, base, name, "rms")]
        if table:
            yield f"Ratio to {base}, geometric mean at {shares} % removed:\n\n" + markdown_table(head, table)


def cell_text(row, figure):
    if row is None:
        return "-"
    return "failed" if "rms" not in row else f"{row[figure] * FIGURES[figure][1]:.3g}"


def full_tables(rows, names):
    by_cell = {(r["mesh"], r["removed"], r["method"]): r for r in rows}
    places = list(dict.fromkeys((r["mesh"], r["removed"]) for r in rows))
    for figure, (title, _) in FIGURES.items():
        table = [[f"{mesh} {100 * removed:g} %", *(cell_text(by_cell.get((mesh, removed, n)), figure) for n in names)]
                 for mesh, removed in places]
        yield f"{title}:\n\n" + markdown_table(["removed", *names], table)


def remarks(rows):
    """Failures, and results with another number of vertices than asked."""
    lines = [f"- {r['method']}, {r['mesh']} {100 * r['removed']:g} %: {r['error']}" for r in rows if "error" in r]
    lines += [f"- {r['method']}, {r['mesh']} {100 * r['removed']:g} %: {r['vertices']} vertices, not {r['wanted']}"
              for r in rows if "rms" in r and r["vertices"] != r["wanted"]]
    return "Failed, or not the number of vertices asked for:\n\n" + "\n".join(lines) + "\n" if lines else ""


def markdown(rows, names):
    groups = {"All": rows, "Meshes": [r for r in rows if r["mesh"] in MESHES],
              "Range scans": [r for r in rows if r["mesh"] in SCANS],
              "Without the meshes that constants were set on": [r for r in rows if r["mesh"] not in TUNED]}
    parts = []
    for title, group in groups.items():
        inputs = dict.fromkeys(r["mesh"] for r in group)
        if inputs and (title == "All" or len(inputs) < len({r["mesh"] for r in rows})):
            parts += [f"### {title}\n\n{', '.join(inputs)}.\n", *summary(group, names)]
    parts += ["### Every cell\n", *full_tables(rows, names), remarks(rows)]
    return "\n".join(part for part in parts if part)


def plot(rows, names, path):
    """One dot per mesh and share removed: the ratio to QSlim."""
    import matplotlib
    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "shapelight"
    import matplotlib.pyplot as plt

    by_cell = {(r["mesh"], r["removed"], r["method"]): r for r in rows if "rms" in r}
    shown = ("rms", "hausdorff", "normals")
    figure, panels = plt.subplots(1, len(shown), sharey=True, figsize=(13, 0.42 * len(names) + 1.4))
    for panel, name in zip(panels, shown):
        for color, removed in zip(("#8fbce6", "#3977b5", "#12385c"), REMOVED):
            points = [(np.clip(row[name] / by_cell[mesh, share, "QSlim"][name], *PLOTTED), names.index(method))
                      for (mesh, share, method), row in by_cell.items()
                      if share == removed and method in names and (mesh, share, "QSlim") in by_cell]
            shift = 0.25 * (REMOVED.index(removed) - 1)
            panel.scatter([x for x, _ in points], [y + shift for _, y in points], s=9, color=color,
                          label=f"{100 * removed:g} % removed")
        panel.axvline(1, color="#888888", linewidth=0.8)
        panel.set_xscale("log")
        panel.set_xlim(*PLOTTED)
        panel.set_title(FIGURES[name][0].split(",")[0] + ", ratio to QSlim", fontsize=10)
        panel.grid(axis="y", alpha=0.25)
    panels[0].set_yticks(range(len(names)), names)
    panels[0].invert_yaxis()
    panels[-1].legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


def main():
    parser = cells.parser(__doc__)
    parser.add_argument("--methods", nargs="*", help="names of methods; all by default")
    parser.add_argument("--document", type=Path, help="page whose part 'table1' is replaced")
    arguments = parser.parse_args()
    bench, every = cells.Cells(arguments), methods.all_methods(arguments.shapelight, arguments.rivals)
    inputs = find_inputs(arguments.data)
    names = cells.chosen(arguments.methods, list(every), "methods")
    rows = []
    for mesh_name in cells.chosen(arguments.meshes, list(inputs), "meshes"):
        mesh = bench.mesh(inputs[mesh_name])
        for removed in REMOVED:
            for name in names:
                rows.append(bench.measure(every[name], mesh, removed))
                print(*rows[-1].values(), file=sys.stderr, flush=True)
    arguments.output.mkdir(parents=True, exist_ok=True)
    cells.write_csv(arguments.output / "table1.csv", rows)
    text = markdown(rows, names)
    (arguments.output / "table1.md").write_text(text)
    if any(r["method"] == "QSlim" and "rms" in r for r in rows):
        plot(rows, names, arguments.output / "table1.svg")
    if arguments.document:
        cells.replace_part(arguments.document, "table1", text)


if __name__ == "__main__":
    main()
