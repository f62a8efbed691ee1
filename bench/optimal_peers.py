"""Fast-Quadric-Mesh-Simplification (two Python packages of it) on the meshes of quadric_collapse.

    optimal_peers.py OUTPUT_DIR MESH...      CPU time of the call, best of 5; a tenth of the faces is kept
"""

import sys
import time
from pathlib import Path

import fast_simplification
import numpy as np
import pyfqmr
import trimesh

from surface_error import load


def with_fast_simplification(vertices, faces, target):
    points, triangles = vertices.astype(np.float32), faces.astype(np.int32)
    start = time.process_time()
    result = fast_simplification.simplify(points, triangles, target_count=target)
    return result, time.process_time() - start


def with_pyfqmr(vertices, faces, target):
    simplifier = pyfqmr.Simplify()
    start = time.process_time()
    simplifier.setMesh(vertices, faces)
    simplifier.simplify_mesh(target_count=target, aggressiveness=7, preserve_border=False, verbose=False)
    result = simplifier.getMesh()[:2]
    return result, time.process_time() - start


if __name__ == "__main__":
    output = Path(sys.argv[1])
    for path in map(Path, sys.argv[2:]):
        vertices, faces = load(path)
        used, faces = np.unique(faces, return_inverse=True)
        vertices, faces = vertices[used], faces.reshape(-1, 3).astype(np.int32)
        for name, run in [("fast-simplification", with_fast_simplification), ("pyfqmr", with_pyfqmr)]:
            runs = [run(vertices, faces, len(faces) // 10) for _ in range(5)]
            (points, triangles), _ = runs[-1]
            trimesh.Trimesh(points, triangles, process=False).export(output / f"{path.stem}.{name}.ply")
            print(f"{path.stem:<16} {name:<20} {len(points):>9} {len(triangles):>9} {min(t for _, t in runs):>9.4f}",
                  flush=True)
