"""Which pairs of scans, samplers and methods are run, and the runs themselves: cells kept on disk."""

import csv
import hashlib
import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

METHODS = ["ficp", "ficp-pure", "softicp", "icp", "plane", "gicp"]
SAMPLERS = ["shape-nb", "shape", "paper", "stratified", "stratified-nb", "random", "voxel", "farthest", "poisson",
            "normal"]
FEW_SAMPLERS = ["shape-nb", "shape", "paper", "stratified", "random"]

# name: shipped mesh, overlap, noise as a share of the diagonal, azimuth of the target's camera [degrees]
SHIPPED = {"bunny-95": ("bunny.ply", 0.95, 0, 0), "bunny-75": ("bunny.ply", 0.75, 0.0005, 120),
           "bunny-55": ("bunny.ply", 0.55, 0, 240), "armadillo-90": ("armadillo.ply", 0.90, 0.0005, 0),
           "armadillo-70": ("armadillo.ply", 0.70, 0, 90), "armadillo-50": ("armadillo.ply", 0.50, 0.0005, 200),
           "fandisk-85": ("fandisk.off", 0.85, 0, 30), "fandisk-75": ("fandisk.off", 0.75, 0.0005, 270),
           "fandisk-65": ("fandisk.off", 0.65, 0, 150)}
MORE_OVERLAPS = [0.8, 0.6, 0.9, 0.7, 0.5]  # of the meshes that are named, in turn
REAL = {"bunny 45": ("stanford_bunny/bun045.ply", "stanford_bunny/bun000.ply",
                     "stanford_bunny/T_bun045_to_bun000.txt"),
        "dragon 24": ("stanford_dragon/dragonStandRight_24.ply", "stanford_dragon/dragonStandRight_0.ply",
                      "stanford_dragon/T_dragonStandRight_24_to_0.txt"),
        "dragon 48": ("stanford_dragon/dragonStandRight_48.ply", "stanford_dragon/dragonStandRight_0.ply",
                      "stanford_dragon/T_dragonStandRight_48_to_0.txt")}
SHIPPED_REAL = {"dragon 24": ("dragonStandRight_24.ply", "dragonStandRight_0.ply",
                              "T_dragonStandRight_24_to_0.txt")}
HIGH = ["bunny 45", "dragon 24", "armadillo-70", "bunny-75", "armadillo-90", "fandisk-85", "bunny-95"]
HIGH_PAIRS = 6  # of these are also run at 25, 50 and 95 %, where a run takes seconds


def pairs(data, real, meshes):
    """{name: arguments of registration_experiment}."""
    folder, files = (real, REAL) if real else (data / "scans", SHIPPED_REAL)
    found = {name: ["--scans", name, *(str(folder / f) for f in words)] for name, words in files.items()}
    for name, (mesh, *words) in SHIPPED.items():
        found[name] = ["--mesh", name, str(data / "meshes" / mesh), *map(str, words)]
    for i, mesh in enumerate(meshes):
        overlap = MORE_OVERLAPS[i % len(MORE_OVERLAPS)]
        name = f"{mesh.stem}-{100 * overlap:.0f}"
        found[name] = ["--mesh", name, str(mesh), str(overlap), str(0.0005 * (i % 2)), str(50 * i)]
    return found


def jobs(all_pairs, arguments):
    """The command lines, the longest first: [(name of the cell, arguments)]."""
    common = ["--pixels", "400", "--polished", "1", "--starts", str(arguments.starts)]
    low = [*common, "--samplers", ",".join(SAMPLERS), "--percent", "5" if arguments.quick else "10,5"]
    high = [*common, "--samplers", ",".join(FEW_SAMPLERS), "--percent", "25" if arguments.quick else "95,50,25"]
    chosen = [name for name in HIGH if name in all_pairs][:HIGH_PAIRS]
    result = [(f"{name} high", all_pairs[name] + high) for name in chosen]
    return result + [(f"{name} low", words + low) for name, words in all_pairs.items()]


def read_csv(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def run_cell(binary, name, words, cache, export):
    """The rows of the cell, from disk when the same program has run the same command before."""
    identity = hashlib.sha256(binary.read_bytes() + json.dumps(words).encode()).hexdigest()
    folder = cache / name.replace(" ", "_")
    runs, samplings, done = (folder / f for f in ("runs.csv", "samplings.csv", "identity"))
    if not (done.exists() and done.read_text() == identity):
        folder.mkdir(parents=True, exist_ok=True)
        exports = ["--export", str(export)] if name.endswith("low") else []
        subprocess.run([binary, *words, *exports, "--runs", runs, "--samplings", samplings], check=True)
        done.write_text(identity)
    return read_csv(runs), read_csv(samplings)


def run(binary, all_jobs, cache, export, workers):
    """Rows of all cells: (runs, samplings). A cell that fails is named and left out."""
    runs, samplings = [], []
    with ThreadPoolExecutor(workers) as pool:
        futures = [(name, pool.submit(run_cell, binary, name, words, cache, export)) for name, words in all_jobs]
        for name, future in futures:
            try:
                more_runs, more_samplings = future.result()
                runs += more_runs
                samplings += more_samplings
            except subprocess.CalledProcessError as error:
                print(f"{name}: failed with exit code {error.returncode}, left out", file=sys.stderr)
    return runs, samplings
