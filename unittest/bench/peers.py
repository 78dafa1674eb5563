"""Other programs beside this one, for speed_error.py: a product of the Rotne-Prager-Yamakawa mobility with forces, its
time and its error, in the scenes of bench_speed_error.c. Processor time on one core, the least of several products. A
program that is not installed is left out, and its tighter tolerances once a product has taken MOST seconds. Rows:

    placed        what new places cost: trees, lists, tables
    seconds       a product; of fmm3d with its trees, which it builds in every product
    error         rms of the velocities' error over that of F/(6 pi a)
    ours_placed, ours_seconds   our fastest product that is at least as accurate, from the same run"""
import importlib.metadata
import math
import os
import time

# One thread each, and double precision; before the programs are imported
for threads in "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS":
    os.environ[threads] = "1"
os.environ["XLA_FLAGS"] = "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
os.environ["JAX_ENABLE_X64"] = "1"

import numpy as np

COLUMNS = ["program", "version", "box", "spheres", "setting", "placed", "seconds", "error", "ours_placed",
           "ours_seconds"]
SAMPLES = 200
MOST = 30.0


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
    for k in (2, 3, 6, 9, 12):
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
    """Spectral Ewald sums of forces and torques, compiled by JAX; made for graphics cards, here on the processor."""
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
        rows = utils.precompute_rpy(x, distances, near, 0.0, n, edge, edge, edge, *grid, prefactor, exponent, volume,
                                    int(support), half, entries, step, cut, table)
        return grid, int(support), waves, own, [row.block_until_ready() for row in rows]

    def product(placed):
        grid, support, waves, own, rest = placed
        u = mobility.mobility_periodic(n, *grid, support, waves, own, *rest, loads.ravel())
        return np.asarray(u).reshape(n, 6)[:, :3] / (6 * math.pi)
    for k in (2, 4, 6, 8):
        yield "periodic", f"1e-{k}", lambda k=k: place(10.0**-k), product


# On PyPI: its cases, and the most spheres that do not take hours or, of jfsd, which keeps the grid points around each,
# more than 20 GB
PROGRAMS = {"fmm3dpy": (fmm3d, 100000), "pystokes": (pystokes, 10000), "jfsd": (jfsd, 10000)}


# --- measuring ---

def timed(call, *arguments):
    begin = time.process_time()
    answer = call(*arguments)
    return time.process_time() - begin, answer


def measure(scene, box, place, product):
    """Placed twice, and at least two products: what is compiled at first use is not counted."""
    place()
    placed, state = timed(place)
    times = []
    while len(times) < 2 or len(times) < 9 and sum(times) < 3:
        seconds, u = timed(product, state)
        times.append(seconds)
    return placed, min(times), scene.error(box, u)


def beside(box, error, ours):
    """Our fastest product of this box that is as accurate, or else the most accurate one"""
    engines = ("open", "all pairs") if box == "open" else ("periodic",)
    rows = [row for row in ours if row["engine"] in engines]
    good = [row for row in rows if float(row["error"]) <= error]
    best = min(good, key=lambda row: float(row["seconds"])) if good else min(rows, key=lambda row: float(row["error"]))
    return best["placed"], best["seconds"]


def rows(file, ours):
    """Of every program that is installed, in a scene of bench_speed_error; ours: its rows"""
    scene = Scene(file)
    for name, (cases, most) in PROGRAMS.items():
        try:
            version = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
        if scene.n > most:
            continue
        for box, setting, place, product in cases(scene):
            placed, seconds, error = measure(scene, box, place, product)
            row = [name, version, box, str(scene.n), setting, f"{placed:.3g}", f"{seconds:.4g}", f"{error:.3g}",
                   *beside(box, error, ours)]
            print(*row, flush=True)
            yield dict(zip(COLUMNS, row))
            if placed + seconds > MOST:
                break
