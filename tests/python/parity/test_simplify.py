"""C++ and Python give the same bytes: methods of simplification."""

import numpy as np
import pytest

import shapelight as sl
from shapelight import stages


@pytest.fixture(scope="module")
def mesh(data):
    return sl.read(data / "meshes/fandisk.off")


@pytest.fixture
def same_mesh(cpp, same_bytes):
    def check(result, name):
        same_bytes(result.vertices, cpp(f"{name}.vertices", np.float64))
        same_bytes(result.faces, cpp(f"{name}.faces", np.uint32))
        same_bytes(result.source_vertex, cpp(f"{name}.source_vertex", np.uint32))

    return check


def test_simplify_qslim(mesh, same_mesh):
    same_mesh(stages.simplify_qslim(mesh, vertices=500), "simplify_qslim")
    features = mesh.triangles[:300, :2]
    options = {"placement": "optimal", "boundary_weight": 2.0}
    same_mesh(stages.simplify_qslim(mesh, faces=2000, features=features, **options), "simplify_qslim.optimal")


def test_simplify_ssim(mesh, same_mesh):
    samples, features = np.arange(0, len(mesh), 10), mesh.triangles[:300, :2]
    denoised = mesh.positions * 1.0625
    result = stages.simplify_ssim(mesh, vertices=700, samples=samples, denoised=denoised, features=features)
    same_mesh(result, "simplify_ssim")


def test_simplify_ssim_paper(mesh, same_mesh):
    samples, features = np.arange(0, len(mesh), 10), mesh.triangles[:300, :2]
    arrays = mesh.positions, mesh.triangles
    same_mesh(stages.simplify_ssim_paper(*arrays, vertices=700, samples=samples, features=features),
              "simplify_ssim_paper")


def test_oddities(mesh, cpp, same_mesh):
    vertices = np.vstack([mesh.positions, np.zeros((1, 3))])
    faces = np.vstack([mesh.triangles, mesh.triangles[7:8]])
    result = stages.simplify_qslim(vertices, faces, vertices=500)
    same_mesh(result, "simplify_qslim.odd")
    assert list(result.oddities.values()) == list(cpp("simplify_qslim.oddities", np.uint64))
    assert result.oddities["duplicate_faces"] == 1 and result.oddities["unused_vertices"] == 1
