"""C++ and Python give the same bytes: virtual scans."""

import numpy as np
import pytest

import shapelight as sl
from shapelight import stages

OPTIONS = {"width": 80, "height": 60, "noise": 0.01, "dropout": 0.1, "random_pose": True, "seed": 3}


@pytest.fixture(scope="module")
def mesh(data):
    return sl.read(data / "meshes/fandisk.off")


@pytest.fixture
def same_scan(cpp, same_bytes):
    def check(scan, name):
        same_bytes(scan.geometry.positions, cpp(f"{name}.positions", np.float64))
        same_bytes(scan.geometry.grid, cpp(f"{name}.grid", np.uint32))
        same_bytes(scan.T_mesh_scan, cpp(f"{name}.T_mesh_scan", np.float64))

    return check


def test_cameras(mesh, cpp, same_bytes):
    sphere = stages.bounding_sphere(mesh)
    same_bytes(sphere.center, cpp("bounding_sphere.center", np.float64))
    same_bytes(np.array([sphere.radius]), cpp("bounding_sphere.radius", np.float64))
    camera = stages.camera_on_sphere(sphere, 0.4, 0.2, field_of_view=0.6, distance=4.0)
    same_bytes(camera.T_mesh_camera, cpp("camera_on_sphere", np.float64))
    ring = stages.ring_of_cameras(sphere, 5, 0.1, 0.3)
    same_bytes(ring[-1].T_mesh_camera, cpp("ring_of_cameras", np.float64))


def test_virtual_scan(mesh, same_scan):
    camera = stages.camera_on_sphere(stages.bounding_sphere(mesh), 0.4, 0.2, field_of_view=0.6, distance=4.0)
    same_scan(stages.virtual_scan((mesh.positions, mesh.triangles), camera, **OPTIONS), "virtual_scan")


def test_scan_pair(mesh, cpp, same_scan, same_bytes):
    pair = stages.scan_pair(mesh, overlap=0.6, **OPTIONS)
    same_scan(pair.source, "scan_pair.source")
    same_scan(pair.target, "scan_pair.target")
    same_bytes(pair.T_target_source, cpp("scan_pair.T_target_source", np.float64))
    same_bytes(np.array([pair.overlap, pair.azimuth_between]), cpp("scan_pair.overlap", np.float64))
    overlap = stages.scan_overlap(pair.source.geometry, pair.target.geometry, pair.T_target_source)
    same_bytes(np.array([overlap]), cpp("scan_overlap", np.float64))
