"""The meshes of the experiments as arrays and OFF files: every program gets the same triangles in full precision."""

import subprocess
from pathlib import Path

import numpy as np

DEPTH_JUMP = 4.0  # a triangle of a scan with a side of more than so many median sides spans a depth jump


def read_off(path):
    """(points, triangles) of an OFF file of triangles; further columns, such as colours, are left out."""
    with open(path) as file:
        file.readline()
        num_points, num_triangles = map(int, file.readline().split()[:2])
        points = np.loadtxt(file, max_rows=num_points, usecols=(0, 1, 2), ndmin=2)
        triangles = np.loadtxt(file, max_rows=num_triangles, usecols=(1, 2, 3), dtype=np.int64, ndmin=2)
    if triangles.min(initial=0) < 0 or triangles.max(initial=0) >= num_points:
        raise ValueError(f"{path}: a corner beyond the vertices")
    return points, triangles


def write_off(path, points, triangles):
    """Only points that a triangle uses; returns their number."""
    used, triangles = np.unique(triangles, return_inverse=True)
    points, triangles = np.asarray(points, dtype=np.float64)[used], triangles.reshape(-1, 3)
    with open(path, "w") as file:
        file.write(f"OFF\n{len(points)} {len(triangles)} 0\n")
        np.savetxt(file, points, fmt="%.17g")
        np.savetxt(file, triangles, fmt="3 %d %d %d")
    return len(points)


def proper(triangles):
    """Without triangles that name a vertex twice, and without second copies of a triangle."""
    corners = np.sort(triangles, axis=1)
    distinct = (corners[:, 0] != corners[:, 1]) & (corners[:, 1] != corners[:, 2])
    first = np.zeros(len(triangles), dtype=bool)
    first[np.unique(corners, axis=0, return_index=True)[1]] = True
    return triangles[distinct & first]


def has_range_grid(path):
    with open(path, "rb") as file:
        return b"range_grid" in file.read(2048)


def read_range_grid(path):
    """(points, grid of vertex indices, -1 where empty) of a Stanford range image in ASCII PLY."""
    header, body = Path(path).read_text().split("end_header\n", 1)
    words = header.split()
    columns, rows = int(words[words.index("num_cols") + 1]), int(words[words.index("num_rows") + 1])
    num_points = int(words[words.index("vertex") + 1])
    lines = body.splitlines()
    points = np.array([line.split()[:3] for line in lines[:num_points]], dtype=np.float64)
    cells = [line.split() for line in lines[num_points:num_points + rows * columns]]
    grid = np.array([int(cell[1]) if cell[0] == "1" else -1 for cell in cells]).reshape(rows, columns)
    return points, grid


def triangulate_grid(points, grid):
    """Two triangles a cell, cut along its shorter diagonal, or one where a corner is missing; none over depth jumps."""
    a, b, c, d = (part.ravel() for part in (grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]))

    def length(i, j):
        return np.where((i >= 0) & (j >= 0), np.linalg.norm(points[i] - points[j], axis=1), np.inf)

    along_ac = length(a, c) <= length(b, d)
    along_ac = np.where((b < 0) | (d < 0), True, np.where((a < 0) | (c < 0), False, along_ac))
    corners = np.concatenate([np.stack(t, axis=1)[cut] for t, cut in
                              (((a, b, c), along_ac), ((a, c, d), along_ac),
                               ((a, b, d), ~along_ac), ((b, c, d), ~along_ac))])
    corners = corners[(corners >= 0).all(axis=1)]
    sides = np.stack([length(corners[:, i], corners[:, (i + 1) % 3]) for i in range(3)], axis=1)
    return corners[sides.max(axis=1) <= DEPTH_JUMP * np.median(sides)]


def prepare(shapelight, path, folder):
    """Writes the mesh of a file, or of a range image, as OFF with used vertices only; returns the OFF's path."""
    off = Path(folder) / (Path(path).stem + ".off")
    if off.exists():
        return off
    off.parent.mkdir(parents=True, exist_ok=True)
    if Path(path).suffix == ".ply" and has_range_grid(path):
        points, grid = read_range_grid(path)
        triangles = triangulate_grid(points, grid)
    else:
        plain = off.with_suffix(".plain.off")
        subprocess.run([shapelight, "convert", path, plain, "--force", "-q"], check=True)
        points, triangles = read_off(plain)
        plain.unlink()
    part = off.with_suffix(".part")
    write_off(part, points, proper(triangles))
    part.rename(off)
    return off


def mean_edge(points, triangles):
    return np.mean([np.linalg.norm(points[triangles[:, i]] - points[triangles[:, (i + 1) % 3]], axis=1)
                    for i in range(3)])


def diagonal(points):
    return np.linalg.norm(points.max(axis=0) - points.min(axis=0))


def vertex_normals(points, triangles):
    a, b, c = (points[triangles[:, i]] for i in range(3))
    normals = np.zeros_like(points)
    for corner in range(3):
        np.add.at(normals, triangles[:, corner], np.cross(b - a, c - a))
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)


def with_noise(points, sigma, seed=1):
    """Gaussian in every coordinate."""
    return points + np.random.default_rng(seed).normal(scale=sigma, size=points.shape)


def taubin(points, triangles, iterations=15, shrink=0.5, grow=-0.53):
    """Taubin's smoothing: a step towards the mean of the neighbours, then one back."""
    from scipy.sparse import coo_matrix

    i = np.concatenate([triangles[:, k] for k in (0, 1, 2, 1, 2, 0)])
    j = np.concatenate([triangles[:, k] for k in (1, 2, 0, 0, 1, 2)])
    adjacency = coo_matrix((np.ones(len(i)), (i, j)), shape=(len(points), len(points))).tocsr()
    adjacency.data[:] = 1.0
    degree = np.maximum(np.asarray(adjacency.sum(axis=1)), 1.0)
    for _ in range(iterations):
        for factor in (shrink, grow):
            points = points + factor * (adjacency @ points / degree - points)
    return points


def subdivided(points, triangles, parts):
    """Every side in `parts` equal pieces, every triangle in parts^2."""
    lattice = [(i, j) for i in range(parts + 1) for j in range(parts + 1 - i)]
    index = {at: number for number, at in enumerate(lattice)}
    weights = np.array([(parts - i - j, i, j) for i, j in lattice], dtype=np.int64)
    # A lattice point is named by its corners in ascending order with their weights: equal on both sides of an edge.
    order = np.argsort(triangles, axis=1)
    corners = np.take_along_axis(triangles, order, axis=1)
    share = weights[None, :, :].repeat(len(triangles), axis=0)
    share = np.take_along_axis(share, order[:, None, :].repeat(len(lattice), axis=1), axis=2)
    names = np.where(share > 0, corners[:, None, :] * (parts + 1) + share, -1).reshape(-1, 3)
    unique, first, inverse = np.unique(np.sort(names, axis=1), axis=0, return_index=True, return_inverse=True)
    del unique
    positions = (share[:, :, :, None] * points[corners][:, None, :, :]).sum(axis=2).reshape(-1, 3)[first] / parts
    inverse = inverse.reshape(len(triangles), len(lattice))
    small = [(index[i, j], index[i + 1, j], index[i, j + 1]) for i, j in lattice if i + j < parts]
    small += [(index[i + 1, j], index[i + 1, j + 1], index[i, j + 1]) for i, j in lattice if i + j < parts - 1]
    return positions, np.concatenate([inverse[:, list(t)] for t in small])
