"""Thins a LAS, LAZ or COPC file that does not fit into memory: only the kept points are held. Needs the extra "las".

    python stream_a_big_file.py BIG.laz THIN.laz [RATIO]
"""

import sys

import shapelight as sl


def main() -> None:
    source, target = sys.argv[1:3]
    ratio = float(sys.argv[3]) if len(sys.argv) > 3 else 0.1

    read, kept = 0, []
    for chunk in sl.iter_chunks(source, size=500_000):
        read += len(chunk)
        kept.append(chunk.select(sl.sample(chunk, ratio=ratio).indices))
    thin = sl.concatenate(kept)
    sl.write(target, thin)

    print(f"{read} points, {len(thin)} kept")


if __name__ == "__main__":
    main()
