#!/usr/bin/env python3
"""Other programs beside this one: a product of the Rotne-Prager-Yamakawa mobility with forces, its time and its error.

    cmake --build build --target bench_speed_error
    python3 -m venv peers
    peers/bin/pip install numpy scipy cython setuptools matplotlib fmm3dpy
    peers/bin/pip install --no-build-isolation pystokes
    peers/bin/pip install jfsd; peers/bin/pip install "jax==0.4.38" "jaxlib==0.4.38"    # jfsd asks for a jax that is gone
    peers/bin/python unittest/bench/peers.py [--spheres N ...] [--build FOLDER] [--seconds MOST] [--only NAME ...]

The scenes are those of bench_speed_error.c, which runs before and after the others. Processor time on one core, the least
of several products. A program that is not installed is left out, and so is a case whose smaller scene shows that it would
take longer than MOST. peers.csv keeps the rows of programs and scenes that were not measured; speed_error.py draws them.

    placed        what new places cost: trees, lists, tables
    seconds       a product; of fmm3d with its trees, which it builds in every product
    error         rms of the velocities' error over that of F/(6 pi a)
    ours_placed, ours_seconds   our fastest product that is at least as accurate, from the same run"""
import argparse
import csv
import importlib.metadata
import math
import os
import pathlib
import subprocess
import sys
import tempfile
import time

# One thread each, and double precision; before numpy and the programs are imported
for threads in "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS":
    os.environ[threads] = "1"
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
os.environ["JAX_ENABLE_X64"] = "1"

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
TABLE = HERE / "peers.csv"
COLUMNS = ["program", "version", "box", "spheres", "setting", "placed", "seconds", "error", "ours_placed", "ours_seconds"]
SAMPLES = 200


class Scene:
    """N spheres of radius 1 in fluid of viscosity 1, their forces, and their velocities less F/(6 pi)."""
    def __init__(self, file):
        numbers = np.fromfile(file)
        self.n, self.edge = int(numbers[0]), float(numbers[1])
        self.x, self.F, *u = numbers[2:].reshape(4, self.n, 3)
        self.u = dict(zip(("open", "periodic"), u))

    def error(self, box, u):
        some = slice(None, None, max(1, self.n // SAMPLES)) if box == "open" else slice(None)
        own = self.F[some] / (6 * math.pi)
        return np.linalg.norm(u[some] - own - self.u[box][some]) / np.linalg.norm(own)


# --- each program: box, setting, place() and product() of its cases; product takes what place returned ---

def fmm3d(scene):
    """Fast multipoles: Stokeslets, and the gradient of Laplace dipoles for what is left of the tensor (fmm3dpy 2.1:
    both kernels with their 1/(8 pi) and 1/(4 pi))."""
    import fmm3dpy
    x, F = np.asfortranarray(scene.x.T), np.asfortranarray(scene.F.T)

    def product(tolerance):
        u = fmm3dpy.stfmm3d(eps=tolerance, sources=x, stoklet=F, ifppreg=1).pot.reshape(3, -1)
        quadrupole = fmm3dpy.lfmm3d(eps=tolerance, sources=x, dipvec=F, pg=2).grad.reshape(3, -1)
        return (u + quadrupole / 3).T + scene.F / (6 * math.pi)
    for k in range(2, 13):
        yield "open", f"1e-{k}", lambda k=k: 10.0**-k, product


def pystokes(scene):
    """All pairs, in compiled loops."""
    from pystokes import unbounded
    body = unbounded.Rbm(radius=1, particles=scene.n, viscosity=1)
    x, F = scene.x.T.ravel(), scene.F.T.ravel()

    def product(u):
        u[:] = 0
        body.mobilityTT(u, x, F)
        return u.reshape(3, -1).T
    yield "open", "", lambda: np.zeros(3 * scene.n), product


def jfsd(scene):
    """Spectral Ewald sums of forces and torques, compiled by JAX; made for graphics cards, here on the processor. It
    keeps the grid points around every sphere: more spheres need more than 20 GB."""
    if scene.n > 20000:
        return
    import jax
    from jfsd import mobility, utils
    n, edge, split = scene.n, scene.edge, 0.5
    x = jax.numpy.asarray(scene.x - edge / 2)
    loads = np.zeros((n, 6))
    loads[:, :3] = scene.F

    def place(tolerance):
        cut = math.sqrt(-math.log(tolerance)) / split
        _, near, *_ = utils.cpu_nlist(x, np.full(3, edge), cut, 0.0, 0.0, 0.0)
        (volume, prefactor, exponent, half, waves, _, distances, _, table, own, nx, ny, nz, support, entries, step,
         *_) = utils.init_periodic_box(tolerance, split, edge, edge, edge, cut, 0.0, 0.0, x, n, 0.0, 1)
        grid = tuple(int(m) for m in (nx, ny, nz))
        placed = utils.precompute_rpy(x, distances, near, 0.0, n, edge, edge, edge, *grid, prefactor, exponent, volume,
                                      int(support), half, entries, step, cut, table)
        return grid, int(support), waves, own, [row.block_until_ready() for row in placed]

    def product(placed):
        grid, support, waves, own, rest = placed
        u = mobility.mobility_periodic(n, *grid, support, waves, own, *rest, loads.ravel())
        return np.asarray(u).reshape(n, 6)[:, :3] / (6 * math.pi)
    for k in range(2, 9):
        yield "periodic", f"1e-{k}", lambda k=k: place(10.0**-k), product


PROGRAMS = {"fmm3dpy": fmm3d, "pystokes": pystokes, "jfsd": jfsd}


# --- measuring ---

def timed(call, *arguments):
    begin = time.process_time()
    answer = call(*arguments)
    return time.process_time() - begin, answer


def measure(scene, box, place, product):
    """Placed twice and more than once multiplied, so that what is compiled at first use is not counted."""
    place()
    placed, state = timed(place)
    product(state)
    least, total = math.inf, 0.0
    for _ in range(9):
        seconds, u = timed(product, state)
        least, total = min(least, seconds), total + seconds
        if total > 20:
            break
    return placed, least, scene.error(box, u)


def others(scene, most, only):
    for name, cases in PROGRAMS.items():
        try:
            version = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
        if only and name not in only:
            continue
        for box, setting, place, product in cases(scene):
            placed, seconds, error = measure(scene, box, place, product)
            row = [name, version, box, scene.n, setting, f"{placed:.3g}", f"{seconds:.4g}", f"{error:.3g}"]
            print(*row, flush=True)
            yield dict(zip(COLUMNS, row))
            if placed + seconds > most:
                break


def ours(build, n, file):
    run = subprocess.run([build / "bench_speed_error", str(n), file], check=True, stdout=subprocess.PIPE, text=True)
    names = "engine", "numbers", "spheres", "tolerance", "placed", "seconds", "error"
    return [dict(zip(names, line.split(","))) for line in run.stdout.splitlines()]


def beside(row, rows):
    """Our fastest product of this box that is as accurate, or the most accurate one."""
    engines = ("open", "all pairs") if row["box"] == "open" else ("periodic",)
    good = [r for r in rows if r["engine"] in engines and float(r["error"]) <= float(row["error"])]
    rows = good or [min((r for r in rows if r["engine"] in engines), key=lambda r: float(r["error"]))]
    best = min(rows, key=lambda r: float(r["seconds"]))
    return {"ours_placed": f'{float(best["placed"]):.3g}', "ours_seconds": f'{float(best["seconds"]):.4g}'}


def key(row):
    return tuple(str(row[column]) for column in ("program", "box", "spheres", "setting"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--spheres", type=int, nargs="+", default=[1000, 10000, 100000])
    parser.add_argument("--build", type=pathlib.Path, default=HERE.parents[1] / "build")
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--only", nargs="+", choices=PROGRAMS)
    given = parser.parse_args()
    with open(TABLE, newline="") as file:
        rows = {key(row): row for row in csv.DictReader(file)}
    for n in given.spheres:
        with tempfile.NamedTemporaryFile() as file:
            mine = ours(given.build, n, file.name)
            measured = list(others(Scene(file.name), given.seconds, given.only))
            mine += ours(given.build, n, file.name)
        rows.update((key(row), row | beside(row, mine)) for row in measured)
    with open(TABLE, "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows[k] for k in sorted(rows, key=lambda k: (k[0], k[1], int(k[2]), float(k[3] or 1))))


if __name__ == "__main__":
    sys.exit(main())
