"""RMS distance between surfaces, by Open3D, so that shapelight does not judge itself.

    surface_error.py REFERENCE TEST...      symmetric RMS in 1e-4 of the diagonal, normal deviation in degrees
"""

import sys

import numpy as np
import open3d as o3d
import trimesh


def load(path):
    mesh = trimesh.load(path, process=False, force="mesh")
    return np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int64)


def sample(vertices, faces, count, seed=0):
    """Stratified area-uniform samples and the normals of their faces."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    area = np.linalg.norm(cross, axis=1)
    rng = np.random.default_rng(seed)
    at = (np.arange(count) + rng.random(count)) / count * area.sum()
    face = np.minimum(np.searchsorted(np.cumsum(area), at), len(faces) - 1)
    u, v = np.sqrt(rng.random(count)), rng.random(count)
    points = (1 - u)[:, None] * a[face] + (u * (1 - v))[:, None] * b[face] + (u * v)[:, None] * c[face]
    return points, cross[face] / np.maximum(area[face], 1e-300)[:, None]


class Surface:
    def __init__(self, vertices, faces, center, scale, count):
        self.vertices = (vertices - center) / scale
        self.points, self.normals = sample(self.vertices, faces, count)
        self.scene = o3d.t.geometry.RaycastingScene()
        self.scene.add_triangles(o3d.core.Tensor(self.vertices.astype(np.float32)),
                                 o3d.core.Tensor(faces.astype(np.uint32)))

    def distances(self, other):
        """From our samples to the other surface: squared distances, angles."""
        hit = other.scene.compute_closest_points(o3d.core.Tensor(self.points.astype(np.float32)))
        offset = self.points - hit["points"].numpy()
        cosine = np.clip((self.normals * hit["primitive_normals"].numpy()).sum(1), -1, 1)
        return (offset**2).sum(1), np.degrees(np.arccos(cosine))


def compare(reference, test, count=400_000):
    vertices, faces = reference
    used = vertices[np.unique(faces)]
    low, high = used.min(0), used.max(0)
    scale = np.linalg.norm(high - low)
    a = Surface(vertices, faces, (low + high) / 2, scale, count)
    b = Surface(*test, (low + high) / 2, scale, count)
    (d_ab, n_ab), (d_ba, n_ba) = a.distances(b), b.distances(a)
    rms = np.sqrt((d_ab.mean() + d_ba.mean()) / 2)
    return rms * 1e4, np.sqrt((np.mean(n_ab**2) + np.mean(n_ba**2)) / 2)


if __name__ == "__main__":
    source = load(sys.argv[1])
    for name in sys.argv[2:]:
        rms, angle = compare(source, load(name))
        print(f"{name:<60} rms {rms:8.4f}  normals {angle:6.2f}", flush=True)
