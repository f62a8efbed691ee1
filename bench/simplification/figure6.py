"""Figure 6 of the paper: the error against T, the share of local samples, for SSim and SSim as the paper words it.

  python bench/simplification/figure6.py --data data --meshes armadillo bunny --output out

Writes figure6.csv, figure6.md and figure6.svg.
"""

import sys
from pathlib import Path

import cells
import methods
from table1 import find_inputs, markdown_table

SHARES = (0.0, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 1.0)
CURVES = {"SSim": ["--method", "ssim"], "SSim paper": ["--method", "ssim-paper", "--preset", "paper"]}


def markdown(rows):
    lines = [[f"{mesh}, {curve}", *(f"{1e4 * r['rms']:.3g}" if "rms" in r else "failed" for r in rows
                                    if r["mesh"] == mesh and r["curve"] == curve)]
             for mesh, curve in dict.fromkeys((r["mesh"], r["curve"]) for r in rows)]
    removed = 100 * rows[0]["removed"]
    return (f"RMS distance, 1e-4 of the diagonal, {removed:g} % removed, against T:\n\n"
            + markdown_table(["T", *(f"{t:g}" for t in SHARES)], lines))


def plot(rows, path):
    import matplotlib
    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "shapelight"
    import matplotlib.pyplot as plt

    figure, panels = plt.subplots(1, len(CURVES), figsize=(9, 3.4))
    for panel, curve in zip(panels, CURVES):
        for mesh in dict.fromkeys(r["mesh"] for r in rows):
            line = [r for r in rows if r["mesh"] == mesh and r["curve"] == curve and "rms" in r]
            panel.plot([r["T"] for r in line], [1e4 * r["rms"] for r in line], marker="o", markersize=3, label=mesh)
        panel.set_title(curve, fontsize=10)
        panel.set_xlabel("T, share of local samples")
        panel.set_ylabel("RMS, 1e-4 of the diagonal")
        panel.set_ylim(bottom=0)
        panel.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


def main():
    parser = cells.parser(__doc__)
    parser.add_argument("--removed", type=float, default=0.9, help="share of the vertices to remove")
    parser.add_argument("--document", type=Path, help="page whose part 'figure6' is replaced")
    arguments = parser.parse_args()
    bench, inputs = cells.Cells(arguments), find_inputs(arguments.data)
    rows = []
    for mesh_name in cells.chosen(arguments.meshes or ["armadillo", "bunny"], list(inputs), "meshes"):
        mesh = bench.mesh(inputs[mesh_name])
        for curve, options in CURVES.items():
            for share in SHARES:
                method = methods.shapelight(arguments.shapelight, f"{curve} T={share:g}",
                                            [*options, "--local-weight", share])
                rows.append({"curve": curve, "T": share, **bench.measure(method, mesh, arguments.removed)})
                print(*rows[-1].values(), file=sys.stderr, flush=True)
    arguments.output.mkdir(parents=True, exist_ok=True)
    cells.write_csv(arguments.output / "figure6.csv", rows)
    (arguments.output / "figure6.md").write_text(markdown(rows))
    plot(rows, arguments.output / "figure6.svg")
    if arguments.document:
        cells.replace_part(arguments.document, "figure6", markdown(rows))


if __name__ == "__main__":
    main()
