"""Other programs' samplers behind one interface: (points, count) -> (sampled points, CPU seconds, of all threads).

Open3D and fpsample are called in this process. PCL has no Python interface: its command line tools are called, if they
are there, and the time is the one that they print for the computation alone, without files.
"""

import atexit
import math
import re
import shutil
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

COUNT_TOLERANCE = 0.005  # of the samplers that have no count, only a size
MAX_EXACT_DISTANCES = 8e9  # Open3D's farthest point takes points x count distances


def timed(call):
    start = time.process_time()
    result = call()
    return result, time.process_time() - start


def by_size(points, count, sample_of_size):
    """Searches the cell size for which sample_of_size(size) -> (sample, seconds) has `count` points, in log-log."""
    extent = np.linalg.norm(points.max(axis=0) - points.min(axis=0))
    size, low, high, best = extent / math.sqrt(count), 0.0, math.inf, None
    for _ in range(14):
        sample, seconds = sample_of_size(size)
        if best is None or abs(len(sample) - count) < abs(len(best[0]) - count):
            best = sample, seconds
        if abs(len(sample) - count) <= COUNT_TOLERANCE * count:
            break
        low, high = (size, high) if len(sample) > count else (low, size)
        guess = size * math.sqrt(len(sample) / count)
        size = guess if low < guess < high else math.sqrt(low * high) if low > 0 and high < math.inf else size * 0.7
    return best


def open3d_peers(points, triangles):
    try:
        import open3d
    except ImportError:
        return {}
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))

    def voxel(count):
        def sample_of_size(size):
            sample, seconds = timed(lambda: cloud.voxel_down_sample(size))
            return np.asarray(sample.points), seconds

        return by_size(points, count, sample_of_size)

    def farthest(count):
        if len(points) * count > MAX_EXACT_DISTANCES:
            return None
        sample, seconds = timed(lambda: cloud.farthest_point_down_sample(count))
        return np.asarray(sample.points), seconds

    def poisson(count):
        mesh = open3d.geometry.TriangleMesh(open3d.utility.Vector3dVector(points),
                                            open3d.utility.Vector3iVector(triangles))
        sample, seconds = timed(lambda: mesh.sample_points_poisson_disk(count))
        return np.asarray(sample.points), seconds

    peers = {"Open3D voxel (means)": voxel, "Open3D farthest": farthest}
    if triangles is not None:
        peers["Open3D Poisson (on triangles)"] = poisson
    return peers


def fpsample_peers(points):
    try:
        import fpsample
    except ImportError:
        return {}
    single = points.astype(np.float32)

    def of(function, *arguments):
        def sample(count):
            chosen, seconds = timed(lambda: function(single, count, *arguments))
            return points[np.asarray(chosen, dtype=np.int64)], seconds

        return sample

    return {"fpsample kd-line": of(fpsample.bucket_fps_kdline_sampling, 7),
            "fpsample kd-tree": of(fpsample.bucket_fps_kdtree_sampling)}


def write_pcd(path, points):
    header = ("VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {0}\nHEIGHT 1\n"
              "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {0}\nDATA binary\n").format(len(points))
    path.write_bytes(header.encode() + points.astype("<f4").tobytes())


def pcl_peers(points, read_points):
    tools = {"PCL voxel grid (means)": ("pcl_voxel_grid", lambda size: ["-leaf", f"{size},{size},{size}"]),
             "PCL uniform sampling": ("pcl_uniform_sampling", lambda size: ["-radius", str(size)])}
    folder = Path(tempfile.mkdtemp())
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    source, target = folder / "in.pcd", folder / "out.pcd"
    write_pcd(source, points)

    def of(tool, arguments):
        def sample_of_size(size):
            done = subprocess.run([tool, source, target, *arguments(size)], capture_output=True, text=True, check=True)
            words = re.sub(r"\x1b\[[0-9;]*m", "", done.stdout + done.stderr)
            milliseconds = re.findall(r"\[done, ([\d.e+-]+) ms", words)
            return read_points(target), float(milliseconds[1]) / 1000.0  # loading, computing, saving

        return lambda count: by_size(points, count, sample_of_size)

    return {name: of(tool, arguments) for name, (tool, arguments) in tools.items() if shutil.which(tool)}


def all_peers(points, triangles, read_points):
    """Every peer that is installed. `read_points` reads a PCD file, which PCL writes compressed."""
    return {**open3d_peers(points, triangles), **fpsample_peers(points), **pcl_peers(points, read_points)}
