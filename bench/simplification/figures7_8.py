"""Figures 7 and 8 of the paper: the original, QSlim, SSim as the paper words it, and SSim, side by side as pictures.

  python bench/simplification/figures7_8.py --data data --meshes armadillo --output out

Writes one picture a mesh and share removed: figure7_MESH_90.png, figure8_MESH_95.png.
"""

import tempfile
from pathlib import Path

import cells
import methods
from table1 import find_inputs

REMOVED = {7: 0.90, 8: 0.95}
SHOWN = ("QSlim", "SSim paper", "SSim")


def main():
    parser = cells.parser(__doc__)
    parser.add_argument("--view", default="auto", help="as for shapelight render")
    arguments = parser.parse_args()
    bench, inputs = cells.Cells(arguments), find_inputs(arguments.data)
    every = methods.all_methods(arguments.shapelight, arguments.rivals)
    arguments.output.mkdir(parents=True, exist_ok=True)
    for mesh_name in cells.chosen(arguments.meshes or ["armadillo"], list(inputs), "meshes"):
        mesh = bench.mesh(inputs[mesh_name])
        for number, removed in REMOVED.items():
            with tempfile.TemporaryDirectory() as scratch:
                results = [Path(scratch) / f"{name}.off" for name in SHOWN]
                for name, result in zip(SHOWN, results):
                    every[name](mesh, round((1 - removed) * cells.count_vertices(mesh)), result)
                picture = arguments.output / f"figure{number}_{mesh_name}_{100 * removed:g}.png"
                methods.run([arguments.shapelight, "render", mesh, *results, "-o", picture, "--force", "-q",
                             "--view", arguments.view, "--width", 1400, "--height", 1300])
                print(f"{picture}: original, {', '.join(SHOWN)}, {100 * removed:g} % removed")


if __name__ == "__main__":
    main()
