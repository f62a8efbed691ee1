"""Simplifiers with a Python interface: python python_peers.py PEER IN.off OUT.off VERTICES

They take a number of triangles, so it is searched until the number of vertices fits; only the last call is timed.
Prints JSON: CPU seconds of that call (all threads) and vertices.
"""

import json
import sys
import time

import numpy as np
from meshes import read_off, write_off

MAX_TRIES = 8


def open3d(points, triangles):
    import open3d

    mesh = open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(points),
                                        open3d.utility.Vector3iVector(triangles.astype(np.int32)))

    def call(num_triangles):
        result = mesh.simplify_quadric_decimation(num_triangles)
        return result, lambda: (np.asarray(result.vertices), np.asarray(result.triangles))

    return call


def fast_simplification(points, triangles):
    import fast_simplification as peer

    points, triangles = np.ascontiguousarray(points), np.ascontiguousarray(triangles, dtype=np.int32)

    def call(num_triangles):
        result = peer.simplify(points, triangles, target_count=num_triangles)
        return result, lambda: (result[0], result[1])

    return call


def pymeshlab(points, triangles):
    import pymeshlab as peer

    def call(num_triangles):
        meshes = peer.MeshSet()
        meshes.add_mesh(peer.Mesh(points, triangles.astype(np.int32)))
        start = time.process_time()
        meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=num_triangles)
        call.seconds = time.process_time() - start  # without the copies into MeshLab
        result = meshes.current_mesh()
        return meshes, lambda: (result.vertex_matrix(), result.face_matrix())

    return call


def meshoptimizer(points, triangles):
    import meshoptimizer as peer

    # single precision: about the centre nothing is lost but what the type cannot hold
    low, high = points.min(axis=0), points.max(axis=0)
    single = np.ascontiguousarray(points - 0.5 * (low + high), dtype=np.float32)
    indices = np.ascontiguousarray(triangles.ravel(), dtype=np.uint32)

    def call(num_triangles):
        result = np.zeros_like(indices)
        count = peer.simplify(result, indices, single, target_index_count=3 * num_triangles, target_error=1e9)
        return result, lambda: (points, result[:count].reshape(-1, 3))

    return call


PEERS = {peer.__name__: peer for peer in (open3d, fast_simplification, pymeshlab, meshoptimizer)}


def main():
    name, source, target, vertices = sys.argv[1:5]
    points, triangles = read_off(source)
    call, wanted = PEERS[name](points, triangles), int(vertices)
    num_triangles, best, seconds = len(triangles) - 2 * (len(points) - wanted), None, 0.0
    for _ in range(MAX_TRIES):
        start = time.process_time()
        keep, arrays = call(num_triangles)
        seconds = getattr(call, "seconds", time.process_time() - start)
        result = arrays()
        got = len(np.unique(result[1]))
        if best is None or abs(got - wanted) < abs(best[0] - wanted):
            best = got, seconds, result[0].copy(), result[1].copy()
        del keep
        if got == wanted:
            break
        num_triangles = max(4, num_triangles + 2 * (wanted - got))
    write_off(target, best[2], best[3])
    print(json.dumps({"cpu_seconds": best[1], "vertices": best[0]}))


if __name__ == "__main__":
    main()
