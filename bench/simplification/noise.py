"""Simplifying a noisy mesh, judged against the clean one: what the prior and the denoised target of SSim are worth.

  python bench/simplification/noise.py --data data --output out

Gaussian noise of 0.1 % of the diagonal in every coordinate. "Smoothed, then X" runs X on the mesh after 15 rounds of
Taubin's smoothing, so its vertices are no input points. Also on the clean mesh: SSim without samples, as a control.
Writes noise.csv and noise.md.
"""

import sys
from pathlib import Path

import cells
import methods
from meshes import diagonal, mean_edge, read_off, taubin, with_noise, write_off
from table1 import REMOVED, find_inputs, markdown_table

SIGMA = 0.001  # of the diagonal
CLEAN = ("QSlim", "SSim", "SSim, no samples")
NOISY = ("QSlim", "QEM optimal", "SSim", "SSim, no samples", "SSim free, fast", "SSim free, best",
         "CGAL Lindstrom-Turk")
SMOOTHED = ("QSlim", "QEM optimal", "CGAL Lindstrom-Turk")


def variants(mesh):
    """(clean, noisy, smoothed) OFF files with the same triangles; (sigma as a share of the mean edge)."""
    points, triangles = read_off(mesh)
    sigma = SIGMA * diagonal(points)
    noisy, smoothed = (mesh.with_name(f"{mesh.stem}-{kind}.off") for kind in ("noisy", "smoothed"))
    dirty = with_noise(points, sigma)
    if not smoothed.exists():
        write_off(noisy, dirty, triangles)
        write_off(smoothed, taubin(dirty, triangles), triangles)
    return noisy, smoothed, sigma / mean_edge(points, triangles)


def markdown(rows):
    labels = list(dict.fromkeys((r["mesh"], r["label"]) for r in rows))
    by_cell = {(r["mesh"], r["label"], r["removed"]): r for r in rows}

    def text(key):
        row = by_cell[key]
        return f"{1e4 * row['rms']:.3g} / {row['normals']:.3g}" if "rms" in row else "failed"

    head = ["RMS, 1e-4 of the diagonal / normals, degrees", *(f"{100 * r:g} %" for r in REMOVED)]
    return markdown_table(head, [[f"{mesh.split('-')[0]}: {label}", *(text((mesh, label, r)) for r in REMOVED)]
                                 for mesh, label in labels])


def main():
    parser = cells.parser(__doc__)
    parser.add_argument("--document", type=Path, help="page whose part 'noise' is replaced")
    arguments = parser.parse_args()
    bench, inputs = cells.Cells(arguments), find_inputs(arguments.data)
    every = methods.all_methods(arguments.shapelight, arguments.rivals)
    rows = []
    for mesh_name in cells.chosen(arguments.meshes or ["armadillo"], list(inputs), "meshes"):
        clean = bench.mesh(inputs[mesh_name])
        noisy, smoothed, share = variants(clean)
        print(f"{mesh_name}: noise of {share:.2f} mean edges", file=sys.stderr)
        plan = [(clean, "clean, {}", CLEAN), (noisy, "noisy, {}", NOISY), (smoothed, "smoothed, then {}", SMOOTHED)]
        for mesh, label, names in plan:
            for name in (name for name in names if name in every):
                for removed in REMOVED:
                    rows.append({"label": label.format(name), **bench.measure(every[name], mesh, removed, clean)})
                    print(*rows[-1].values(), file=sys.stderr, flush=True)
    arguments.output.mkdir(parents=True, exist_ok=True)
    cells.write_csv(arguments.output / "noise.csv", rows)
    (arguments.output / "noise.md").write_text(markdown(rows))
    if arguments.document:
        cells.replace_part(arguments.document, "noise", markdown(rows))


if __name__ == "__main__":
    main()
