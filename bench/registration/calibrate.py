#!/usr/bin/env python3
"""Fits the confidence of a pose to registrations whose truth is known, and tests it on others.

    calibrate.py TRAIN.csv... --test TEST.csv...      (from confidence_data)

A pose is right when it turns less than 3 degrees and shifts less than 2 % of the diagonal from the truth. Prints the
coefficients for src/registration/pose_confidence.cpp (they are not written there by themselves), a table of predicted
against met shares on the test runs, and how many wrong poses would have been reported as good."""

import argparse
import csv
import math
import sys

import numpy

FEATURES = ("overlap", "contrast", "normal_agreement", "free_space", "conditioning")
WRONG = 4.0


def is_right(row):
    return 0.0 <= float(row["rotation_deg"]) < 3.0 and float(row["shift"]) < 0.02


def features(row):
    """Must be those of pose_confidence.cpp."""
    value = {name: float(row[name]) for name in row if name not in ("kind", "source", "target")}
    return [
        math.log(max(value["overlap"], 1e-3)),
        math.log(min(max(value["contrast"], 0.1), 3.0)),
        math.log(max(value["normal_agreement"], 0.05)),
        math.log(max(value["in_free_space"], 0.01)),
        math.log(min(max(value["conditioning"], 1e-7), 1e-2)),
    ]


def determined(row):
    """0 when the surfaces leave a motion free, 1 when they leave none."""
    return min(max(math.log10(max(float(row["conditioning"]), 1e-12)) + 4.0, 0.0), 1.0)


def rival_weight(row):
    """Poses that fit alike share the probability."""
    return float(row["rival_weight"])


def read(paths):
    rows = []
    for path in paths:
        with open(path) as file:
            rows += list(csv.DictReader(file))
    return rows


def design(rows):
    return numpy.array([[1.0] + features(row) for row in rows]), numpy.array([float(is_right(row)) for row in rows])


def fit(x, y, ridge=1.0, steps=100):
    """Logistic regression by Newton's method; the ridge holds all but the constant. A wrong pose that is believed does
    more harm than a right one that is not, so it weighs WRONG times as much: the confidence errs on the low side."""
    cost = numpy.where(y > 0, 1.0, WRONG)
    weight = numpy.zeros(x.shape[1])
    penalty = ridge * numpy.eye(x.shape[1])
    penalty[0, 0] = 0.0
    for _ in range(steps):
        p = 1.0 / (1.0 + numpy.exp(-numpy.clip(x @ weight, -40, 40)))
        gradient = x.T @ (cost * (y - p)) - penalty @ weight
        hessian = (x * (cost * p * (1.0 - p))[:, None]).T @ x + penalty
        weight += numpy.linalg.solve(hessian, gradient)
    return weight


def report(rows, confidence, right):
    print("| confidence | runs | right |\n| --- | ---: | ---: |")
    for low, high in ((0.0, 0.1), (0.1, 0.3), (0.3, 0.5), (0.5, 0.7), (0.7, 0.9), (0.9, 0.99), (0.99, 1.01)):
        inside = (confidence >= low) & (confidence < high)
        share = f"{100 * right[inside].mean():.1f} %" if inside.any() else "-"
        print(f"| {low:g} to {min(high, 1):g} | {inside.sum()} | {share} |")
    print("\n| kind | runs | right poses | reported | wrong among the reported |\n| --- | ---: | ---: | ---: | ---: |")
    for kind in sorted({row["kind"] for row in rows}):
        of_kind = numpy.array([row["kind"] == kind for row in rows])
        told = of_kind & (confidence >= 0.5)
        print(f"| {kind} | {of_kind.sum()} | {int(right[of_kind].sum())} | {told.sum()} | {int((1 - right[told]).sum())} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("train", nargs="+")
    parser.add_argument("--test", nargs="+", default=[])
    parser.add_argument("--as-reported", action="store_true", help="judge the confidence in the files, fit nothing")
    arguments = parser.parse_args()
    rows = read(arguments.train)
    x, y = design(rows)
    if not arguments.as_reported:
        alone = numpy.array([rival_weight(row) < 0.1 and determined(row) == 1.0 for row in rows])
        weight = fit(x[alone], y[alone])
        usual = x[alone & (y > 0)].mean(axis=0)
        print(f"constant {weight[0]:.3f}")
        for name, value, of_right in zip(FEATURES, weight[1:], usual[1:]):
            print(f"{name} {value:.3f}, of right poses {of_right:.3f}")
        if arguments.test:
            rows = read(arguments.test)
            x, y = design(rows)
        rivals = numpy.array([rival_weight(row) for row in rows])
        held = numpy.array([determined(row) for row in rows])
        confidence = held / (1.0 + numpy.exp(-(x @ weight))) / (1.0 + rivals)
    else:
        confidence = numpy.array([float(row["confidence"]) for row in rows])
    print()
    report(rows, confidence, y)
    return 0


if __name__ == "__main__":
    sys.exit(main())
