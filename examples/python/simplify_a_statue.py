"""Simplifies a mesh to a tenth of its vertices, says how far the result is from it, and draws both.

    python simplify_a_statue.py MESH OUT PICTURE.png [RATIO]
"""

import sys

import shapelight as sl


def main() -> None:
    source, target, picture = sys.argv[1:4]
    ratio = float(sys.argv[4]) if len(sys.argv) > 4 else 0.1

    mesh = sl.read(source)
    result = sl.simplify(mesh, ratio=ratio, measure=True)
    sl.write(target, result.output)
    sl.show(result).save(picture)

    print(f"{len(mesh.positions)} vertices, {len(result.vertices)} kept")
    if result.measured is not None:
        print(f"RMS distance {100 * result.measured.relative.symmetric.rms:.3f} % of the diagonal")


if __name__ == "__main__":
    main()
