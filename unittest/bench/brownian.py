#!/usr/bin/env python3
"""Cost of Brownian motion, inside LAMMPS on one core.

    brownian.py [N] [STEPS] [PHI] [MODEL]

A step of N hard spheres (100 000) in a periodic box at volume fraction PHI (0.2) to 1e-3, with a temperature and without, in one process:
processor time, products of the near part and their ratio. noise_tolerance 0.01. MODEL: words of the pair style, "multiblob 12 lubrication
yes": then a step has one solve with a random slip of the points (scheme midpoint), and its time is also given over that of one product,
which is what a sharper solve takes more for each product more."""
import resource
import sys
import tempfile

import from_tests  # noqa: F401
from from_tests import np
from system import Simulation, Spheres


def neighbours(x, edge, reach):
    """[n, k] who may be within the reach of each, themselves too; n: nobody"""
    m = int(edge // reach)
    cell = np.minimum((x / edge * m).astype(int), m - 1)
    number = cell @ (m * m, m, 1)
    order = np.argsort(number, kind="stable")
    count = np.bincount(number, minlength=m**3)
    place = np.arange(len(x)) - np.repeat(np.cumsum(count) - count, count)
    table = np.full((m**3, count.max()), len(x))
    table[number[order], place] = order
    around = (cell[:, None] + np.indices((3, 3, 3)).reshape(3, -1).T - 1) % m
    return table[around @ (m * m, m, 1)].reshape(len(x), -1)


def hard_spheres(n, phi, sweeps=100, step=0.12):
    """From a lattice, by Monte Carlo moves of all at once: whoever would overlap where another one stands or would go stays. And the edge of the
    box"""
    edge, m = (n * 4 / 3 * np.pi / phi)**(1 / 3), int(np.ceil(n**(1 / 3)))
    x, rng = (np.indices((m, m, m)).reshape(3, -1).T[:n] + 0.5) * edge / m, np.random.default_rng(1)
    assert edge / m > 2, "phi is too large for a cubic lattice"
    for _ in range(sweeps):
        near = neighbours(x, edge, 2 + 2 * 3**0.5 * step)
        y = x + rng.uniform(-step, step, x.shape)
        stays = np.zeros(n, bool)
        for others in (x, y):
            d = y[:, None] - np.vstack([others, np.full(3, np.inf)])[near]
            d -= edge * np.round(np.where(np.isfinite(d), d, 0) / edge)
            stays |= (((d**2).sum(axis=2) < 4) & (near != np.arange(n)[:, None])).any(axis=1)
        x = np.where(stays[:, None], x, y) % edge
    return x, edge


def seconds(n, steps, phi, words, model=""):
    """Processor time of a step; products of the root"""
    x, edge = hard_spheres(n, phi)
    with tempfile.TemporaryDirectory() as folder:
        sim = Simulation(folder, Spheres(x), f"cut_off_distance inf visc 1 far_field_tolerance 1e-3 {model}", fix=False, dt=1e-5, boundary="p p p",
                         box=[(0.0, edge)] * 3)
        sim.commands(f"neighbor 0.6 bin\nfix w all addforce 0 0 -1\nfix move all stokes_dynamics/overdamped {words}").run(1)
        before = resource.getrusage(resource.RUSAGE_SELF).ru_utime
        sim.run(steps, "pre no post no")
        spent = (resource.getrusage(resource.RUSAGE_SELF).ru_utime - before) / steps
        products = [sim.lmp.extract_fix("move", 0, 1, nrow=k) for k in (9, 3)]
        sim.close()
    return spent, products


def main():
    given = sys.argv[1:] + ["100000", "3", "0.2", ""][len(sys.argv) - 1:]
    n, steps, phi, model = (kind(word) for kind, word in zip((int, int, float, str), given))
    still, (_, alone) = seconds(n, steps, phi, "", model)
    moving, (products, solve) = seconds(n, steps, phi, "temperature 1 7", model)
    if model:
        (sharp, (_, many)), (loose, (_, few)) = (seconds(n, 1, phi, "", f"{model} warm_start no relative_tolerance {tol}") for tol in (1e-7, 1e-2))
        print(f"a product {(sharp - loose) / (many - few):.4f} s ({many:.0f} and {few:.0f} of them); a step with Brownian motion is "
              f"{moving * (many - few) / (sharp - loose):.1f} products")
    print(f"{n} spheres, phi {phi}: {still:.4f} s a step, with Brownian motion {moving:.4f} s, {moving / still:.2f} times as much; "
          f"{products:.0f} products of the near part; the solve {solve:.0f} ({alone:.0f} without)")


if __name__ == "__main__":
    main()
