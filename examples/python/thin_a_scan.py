"""Thins a scan to a tenth of its points and keeps its features.

    python thin_a_scan.py SCAN OUT [RATIO]
"""

import sys

import shapelight as sl


def main() -> None:
    source, target = sys.argv[1:3]
    ratio = float(sys.argv[3]) if len(sys.argv) > 3 else 0.1

    scan = sl.read(source)
    result = sl.sample(scan, ratio=ratio)
    quality = sl.metrics(scan, result.output)
    sl.write(target, result.output)  # every attribute travels

    print(f"{len(scan)} points, {len(result.indices)} kept, noise {result.noise:.2g}")
    if isinstance(quality, sl.SamplingQuality):
        print(f"no point is farther than {quality.coverage_max:.3g} from a kept one")


if __name__ == "__main__":
    main()
