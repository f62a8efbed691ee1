"""The command, with and without Python, writes the files that Python's own functions give, byte for byte."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import shapelight as sl

ROOT = Path(__file__).resolve().parents[3]
BINARY = Path(os.environ.get("SHAPELIGHT_BINARY", ROOT / "build/dev/bin/shapelight"))
HERE = {**os.environ, "PYTHONPATH": str(Path(sl.__file__).parents[1])}  # the package that is tested
COMMANDS = {"package": [sys.executable, "-m", "shapelight"], "binary": [str(BINARY)]}


@pytest.fixture(params=COMMANDS)
def command(request, tmp_path):
    """command(*arguments) runs it in an empty folder and returns the JSON report."""
    def run(*arguments):
        report = tmp_path / "report.json"
        call = [*COMMANDS[request.param], *map(str, arguments), "--json", str(report), "-q"]
        subprocess.run(call, cwd=tmp_path, env=HERE, check=True)
        return json.loads(report.read_text())

    return run


@pytest.fixture
def same_file(tmp_path):
    """Compares a file that the command wrote with a geometry, written by Python."""

    def check(name, geometry, **options):
        expected = tmp_path / ("expected" + Path(name).suffix)
        sl.write(expected, geometry, **options)
        assert (tmp_path / name).read_bytes() == expected.read_bytes()

    return check


@pytest.fixture(scope="module")
def bunny():
    return ROOT / "data/scans/bun000_quarter.rif"


@pytest.fixture(scope="module")
def fandisk():
    return ROOT / "data/meshes/fandisk.off"


@pytest.fixture(scope="module")
def scans():
    return [ROOT / f"data/scans/dragonStandRight_{angle}.ply" for angle in (24, 0)]


def test_convert(command, same_file, bunny):
    command("convert", bunny, "out.pcd", "--ascii")
    same_file("out.pcd", sl.read(bunny), ascii=True)


def test_sample(command, same_file, bunny):
    report = command("sample", bunny, "-o", "out.ply", "--ratio", "20%", "--seed", "3")
    result = sl.sample(sl.read(bunny), ratio="20%", seed=3)
    same_file("out.ply", result.output)
    assert report["counts"]["out"] == len(result.indices)
    assert report["result"]["usable"] == result.usable and report["result"]["noise"] == result.noise


def test_sample_by_another_method(command, same_file, fandisk):
    command("sample", fandisk, "-o", "out.las", "--spacing", "2%", "--method", "poisson")
    same_file("out.las", sl.sample(sl.read(fandisk), spacing="2%", method="poisson").output)


def test_fields(command, same_file, bunny):
    report = command("fields", bunny, "-o", "out.ply")
    result = sl.fields(sl.read(bunny))
    same_file("out.ply", result.output)
    assert report["result"]["noise"] == result.noise


def test_simplify(command, same_file, fandisk):
    command("simplify", fandisk, "-o", "out.obj", "--vertices", "1k", "--placement", "optimal", "--preset", "fast")
    same_file("out.obj", sl.simplify(sl.read(fandisk), vertices="1k", placement="optimal", preset="fast").output)


def test_metrics(command, fandisk, tmp_path):
    simplified = sl.simplify(sl.read(fandisk), vertices=1000, method="qslim").output
    sl.write(tmp_path / "test.ply", simplified)
    report = command("metrics", fandisk, "test.ply", "--samples", "20000")["result"]
    distance = sl.metrics(fandisk, tmp_path / "test.ply", samples=20000)
    for side in ("forward", "backward", "symmetric"):
        summary = getattr(distance, side)
        assert report[side] == {"mean": summary.mean, "rms": summary.rms, "max": summary.max}
    angles = distance.normal_deviation_deg
    assert report["normal_deviation_deg"] == {"rms": angles.rms, "p95": angles.p95}


def test_register(command, same_file, scans, tmp_path):
    report = command("register", *scans, "-o", "out.ply", "--transform", "pose.txt")["result"]
    result = sl.register(sl.read(scans[0]), scans[1])
    same_file("out.ply", result.output)
    sl.write_transform(tmp_path / "expected.txt", result.T_target_source)
    assert (tmp_path / "pose.txt").read_bytes() == (tmp_path / "expected.txt").read_bytes()
    np.testing.assert_array_equal(report["T_target_source"], result.T_target_source)
    for name in ("confidence", "overlap", "mean_error", "std_error", "rms", "iterations", "stop"):
        assert report[name] == getattr(result, name), name


def test_align(command, same_file, scans, tmp_path):
    command("align", *scans, "-o", "aligned")
    result = sl.align(scans)
    same_file("aligned/merged.ply", result.merged)
    for scan, aligned in zip(scans, result.scans):
        sl.write_transform(tmp_path / "expected.txt", aligned.T_world_scan, overwrite=True)
        pose = tmp_path / "aligned" / f"{scan.stem}.pose.txt"
        assert pose.read_bytes() == (tmp_path / "expected.txt").read_bytes()


def test_render(command, bunny, fandisk, tmp_path):
    size = {"width": 400, "height": 300}
    command("render", fandisk, bunny, "-o", "out.png", "--color", "none,z", "--dots", bunny, "--view", "iso",
            "--width", "400", "--height", "300", "--dot-size", "2")
    sl.write_png(tmp_path / "expected.png",
                 sl.render([fandisk, bunny], color=["none", "z"], dots=bunny, view="iso", dot_size=2, **size))
    assert (tmp_path / "out.png").read_bytes() == (tmp_path / "expected.png").read_bytes()
