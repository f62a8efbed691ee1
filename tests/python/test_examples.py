"""The programs in examples/python, on shipped data."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import shapelight as sl

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "python"


def run(name, *arguments, code=0):
    environment = {**os.environ, "PYTHONPATH": str(Path(sl.__file__).parents[1])}
    command = [sys.executable, EXAMPLES / name, *arguments]
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, env=environment)
    assert done.returncode == code, done.stderr
    return done.stdout + done.stderr


def test_thin_a_scan(data, tmp_path):
    out = tmp_path / "thin.pcd"
    text = run("thin_a_scan.py", data / "clouds/simple.las", out, 0.2)
    assert "1065 points, 213 kept" in text and "no point is farther" in text
    thin = sl.read(out)
    assert len(thin) == 213
    assert "intensity" in thin.attributes


def test_simplify_a_statue(data, tmp_path):
    out, picture = tmp_path / "statue.ply", tmp_path / "statue.png"
    text = run("simplify_a_statue.py", data / "meshes/fandisk.off", out, picture, 0.1)
    assert "6475 vertices" in text and "RMS distance" in text
    assert sl.read(out).kind == "mesh"
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_register_two_scans(data, tmp_path):
    scans = data / "scans"
    pose, merged = tmp_path / "pose.txt", tmp_path / "merged.ply"
    pair = [scans / f"dragonStandRight_{angle}.ply" for angle in (24, 0)]
    text = run("register_two_scans.py", *pair, pose, merged)
    assert "confidence" in text
    truth = sl.read_transform(scans / "T_dragonStandRight_24_to_0.txt")
    np.testing.assert_allclose(sl.read_transform(pose), truth, atol=0.005)
    assert len(sl.read(merged)) == 41841 + 34836


def test_scans_that_do_not_fit_are_refused(data, tmp_path):
    scans = [data / "scans/bun000_quarter.rif", data / "meshes/fandisk.off"]
    text = run("register_two_scans.py", *scans, tmp_path / "pose.txt", tmp_path / "merged.ply", code=1)
    assert "could not be registered" in text
    assert list(tmp_path.iterdir()) == []


def test_stream_a_big_file(data, tmp_path):
    pytest.importorskip("laspy")
    pytest.importorskip("lazrs")
    out = tmp_path / "thin.laz"
    assert "1065 points, 107 kept" in run("stream_a_big_file.py", data / "clouds/simple.laz", out)
    assert len(sl.read(out)) == 107
