#!/usr/bin/env python3
"""The largest time step of a dense Brownian suspension with stiff contacts.

    dense_noise.py [SPRING] [GAP] [SEEDS] [STEP ...]

32 multiblobs of 12 points with films, at a volume fraction of 0.5 in a periodic box, with a temperature and contacts of
SPRING (1000) kT/a^2; films end at a GAP of 1e-4 a. Steps of 8e-3, 4e-3, ... 2.5e-4 a^2/D, D = kT/(6 pi eta a): of the
last two thirds of 3 a^2/D, averaged over SEEDS (2), the energy of contacts of a sphere in kT, the deepest overlap in
radii, what a step takes in products, and solves that did not converge. h: dt SPRING, the step over the relaxation of a
contact."""
import sys
import tempfile

import from_tests  # noqa: F401
from from_tests import np
from system import Simulation, Spheres

COUNT, PHI, LENGTH = 32, 0.5, 3.0
EDGE = (COUNT * 4 / 3 * np.pi / PHI)**(1 / 3)


def apart(x):
    """[n, n, 3] to each from each other, of images the nearest; [n, n] by how much they overlap"""
    d = x[:, None] - x[None]
    d -= EDGE * np.round(d / EDGE)
    return d, np.maximum(2 - np.linalg.norm(d, axis=2), 0) * (1 - np.eye(COUNT))


def disordered(seed):
    """Random places, pushed apart until nobody overlaps"""
    x = np.random.default_rng(seed).uniform(0, EDGE, (COUNT, 3))
    while True:
        d, deep = apart(x)
        if deep.max() == 0:
            return Spheres(x % EDGE)
        x += 0.4 * ((deep + 1e-3 * (deep > 0))[:, :, None] * d / np.maximum(2 - deep, 1e-3)[:, :, None]).sum(axis=1)


def suspension(folder, spring, gap, seed, step):
    words = f"cut_off_distance inf visc {1 / (6 * np.pi)!r} multiblob 12 lubrication yes lubrication_gap {gap!r}"
    style = [f"pair_style hybrid/overlay gran/hooke {spring!r} NULL 0 NULL 0 0 stokes_dynamics {words}",
             "pair_coeff * * gran/hooke",
             "pair_coeff * * stokes_dynamics"]
    sim = Simulation(folder, disordered(seed), style, fix=False, dt=step, boundary="p p p", box=[(0.0, EDGE)] * 3,
                     comm="comm_modify vel yes")
    return sim.commands(f"fix move all stokes_dynamics/overdamped temperature 1.0 {seed}")


def moments(spring, gap, seed, step, length=LENGTH):
    """Means of the energy of a sphere and of the products, the deepest overlap, solves that failed"""
    with tempfile.TemporaryDirectory() as folder:
        sim = suspension(folder, spring, gap, seed, step)
        every, energy, deepest, products = max(1, round(1e-2 / step)), [], 0.0, []
        for k in range(round(length / step / every)):
            sim.run(every, "pre no post no" if k else "post no")
            if k * every * step < length / 3:
                continue
            deep = apart(sim.x)[1]
            energy.append(0.25 * spring * (deep**2).sum() / COUNT)
            deepest = max(deepest, deep.max())
            products.append([sim.lmp.extract_fix("move", 0, 1, nrow=n) for n in (9, 3)])
        failed = sim.lmp.extract_fix("move", 0, 1, nrow=6)
        sim.close()
    return np.mean(energy), deepest, *np.mean(products, axis=0), failed


def main():
    given = [float(word) for word in sys.argv[1:]]
    spring, gap, seeds = given[:3] + [1000.0, 1e-4, 2][len(given[:3]):]
    for step in given[3:] or [8e-3 / 2**k for k in range(6)]:
        rows = np.array([moments(spring, gap, 4711 + seed, step) for seed in range(int(seeds))])
        energy, deepest, root, solve, failed = rows.mean(axis=0)
        spread = rows[:, 0].std() / max(1, len(rows) - 1)**0.5
        print(f"dt {step:.3g} a^2/D, h {step * spring:.3g}: {energy:.3f} +- {spread:.3f} kT, "
              f"overlap {rows[:, 1].max():.3f}, {root:.0f} + {solve:.0f} products, {failed:.0f} failed", flush=True)


if __name__ == "__main__":
    main()
