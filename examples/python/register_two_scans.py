"""Brings a scan onto another one that overlaps it, without a starting guess, and writes the motion and both as one.

    python register_two_scans.py SOURCE TARGET TRANSFORM.txt MERGED
"""

import sys

import shapelight as sl


def main() -> None:
    source, target, transform, merged = sys.argv[1:5]

    moving, fixed = sl.read(source), sl.read(target)
    try:
        result = sl.register(moving, fixed, min_confidence=0.8)
    except sl.PostconditionFailed as error:
        sys.exit(f"the scans could not be registered: {error}")
    sl.write_transform(transform, result.T_target_source)
    aligned: sl.Geometry = result.output
    sl.write(merged, sl.concatenate([fixed, aligned]))

    print(f"confidence {result.confidence:.2f}, overlap {result.overlap:.0%}, mean error {result.mean_error:.2g}")


if __name__ == "__main__":
    main()
