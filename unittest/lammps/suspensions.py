"""Clouds of flocs and lattices, as those of the core's tests of solvers."""
import numpy as np

from system import Spheres

ETA, A = 1.3, 0.7
STOKES = 6 * np.pi * ETA * A
EXACT = "algorithm 2 relative_tolerance 1e-12 max_iter 2000"
ALONG = (0.0, 0.0, 0.4)


def flocs(count, m, side, seed=1, spread=1.0):
    """Each sphere stuck to one before it at 0.6 to 0.95 of the sum of their radii; flocs at random places of a cube,
    none overlapping another. As cloud_flocs of the core's tests."""
    rng = np.random.default_rng(seed)
    x, a, molecule = np.zeros((0, 3)), np.zeros(0), []
    while len(molecule) < count * m:
        its_a = A * np.exp(rng.uniform(0, np.log(spread), m)) if spread > 1 else np.full(m, A)
        its_x = np.zeros((m, 3))
        its_x[0] = rng.uniform(0, side, 3)
        for i in range(1, m):
            to, e = rng.integers(i), rng.normal(size=3)
            its_x[i] = its_x[to] + rng.uniform(0.6, 0.95) * (its_a[i] + its_a[to]) * e / np.linalg.norm(e)
        if len(x) and (np.linalg.norm(its_x[:, None] - x[None], axis=2) < its_a[:, None] + a[None]).any():
            continue
        x, a = np.vstack([x, its_x]), np.append(a, its_a)
        molecule += [len(molecule) // m + 1] * m
    return Spheres(x, a, rng.normal(size=(len(x), 3)), molecule)


def lattice(n, v=ALONG):
    grid = np.array([(i, j, k) for i in range(n) for j in range(n) for k in range(n)], float)
    return Spheres(2 * A * grid, A, v)


def loose_lattice(n, v=0.0, seed=2):
    """A dense cloud without contacts: volume fraction 0.43."""
    rng = np.random.default_rng(seed)
    spheres = lattice(n)
    spheres.x = 1.07 * spheres.x + rng.uniform(-0.06, 0.06, spheres.x.shape) * A
    spheres.v = v * rng.normal(size=spheres.x.shape)
    return spheres
