#!/usr/bin/env python3
"""Cost of Brownian motion, inside LAMMPS on one core.

    brownian.py [N] [STEPS] [PHI] [MODEL]

A step of N hard spheres (100 000) in a periodic box at volume fraction PHI (0.2) to 1e-3, with a temperature and
without, in one process: processor time, products of the near part and their ratio. noise_tolerance 0.01. MODEL: words
of the pair style, "multiblob 12 lubrication yes": then a step has one solve with a random slip of the points (scheme
midpoint), and its time is also given over that of one product, which is what a sharper solve takes more for each
product more."""
import functools
import pathlib
import resource
import sys
import tempfile

import from_tests  # noqa: F401
from system import Simulation, Spheres

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples"))
from equilibrium import hard_spheres    # noqa: E402


@functools.lru_cache(maxsize=None)
def places(n, phi):
    """At equilibrium, and the edge of the box: the closest pairs decide how many products a solve takes"""
    return next(hard_spheres(n, phi, 1, seed=1, melt=400, between=100))


def seconds(n, steps, phi, words, model=""):
    """Processor time of a step; products of the root"""
    x, edge = places(n, phi)
    with tempfile.TemporaryDirectory() as folder:
        sim = Simulation(folder, Spheres(x), f"cut_off_distance inf visc 1 far_field_tolerance 1e-3 {model}", fix=False,
                         dt=1e-5, boundary="p p p", box=[(0.0, edge)] * 3)
        sim.commands(
            f"neighbor 0.6 bin\nfix w all addforce 0 0 -1\nfix move all stokes_dynamics/overdamped {words}").run(1)
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
        (sharp, (_, many)), (loose,
                             (_, few)) = (seconds(n, 1, phi, "", f"{model} warm_start no relative_tolerance {tol}")
                                          for tol in (1e-7, 1e-2))
        print(f"a product {(sharp - loose) / (many - few):.4f} s ({many:.0f} and {few:.0f} of them); "
              f"a step with Brownian motion is {moving * (many - few) / (sharp - loose):.1f} products")
    print(f"{n} spheres, phi {phi}: {still:.4f} s a step, with Brownian motion {moving:.4f} s, {moving / still:.2f} "
          f"times as much; {products:.0f} products of the near part; the solve {solve:.0f} ({alone:.0f} without)")


if __name__ == "__main__":
    main()
