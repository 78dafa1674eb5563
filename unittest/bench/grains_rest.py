#!/usr/bin/env python3
"""A tank at rest for many steps, of plain water and with a bed of grains: kinetic energy, and the level of the water.

    . build/env.sh
    unittest/bench/grains_rest.py [--steps 100000] [--tank water|bed|both]
        both: a quarter of an hour on a free core

The tank is that of test_a_bed_in_a_tank_stays_at_rest: 6 x 6 spacings, 12 deep, grains of 1 spacing, phi 0.5, at random
and held. The level is the mean of nine probes and of a tenth of the run; beside it stands the height of the volumes of
all water, m/(rho (1 - phi)), over the area.
"""
import argparse
import os
import sys

import from_tests  # noqa: F401
import numpy as np

sys.path.insert(0, os.path.join(sys.path[0], "sph"))
from grains_tools import scene  # noqa: E402
from sph_tools import run, start  # noqa: E402

G, C = 1.0, 30.0
PROBES = " ".join(f"height z {x} {y} 0" for x in (1, 3, 5) for y in (1, 3, 5))
BED = "lattice sc 1 origin 0.5 0.5 0.5\nregion bed block 0 6 0 6 0 6 units box\ncreate_atoms 2 region bed"
ANY = "create_atoms 2 single 3 3 15.9 units box"     # a grain in the air, for the group


def tank(bed):
    return scene((6, 6, 16), 0.3, C, 0.01, "", BED if bed else ANY, 1.0, "p p f", gravity=f"0 0 {-G}", floor=4,
                 mover="", pair="central artVisc 0.1 0 0.04 shift yes",
                 before_fix=f"fix down water gravity {G} vector 0 0 -1\n"
                            f"variable rho atom (1+7*{G}*(12-z)/{C * C})^(1/7)\n"
                            "set group sph sph/rho v_rho\nset group sph mass v_rho\n"
                            + "displace_atoms grains random 0.2 0.2 0.2 77 units box\n" * bed
                            + f"compute level sph sph/probe {PROBES}\nvariable level equal ave(c_level)\n"
                              "compute k water ke\n")


def print_rows(bed, steps):
    part = steps // 10
    lmp = start()
    run(lmp, tank(bed))
    run(lmp, f"fix mean all ave/time 10 {part // 10} {part} v_level c_k\nrun 0")
    for k in range(10):
        run(lmp, f"run {part}")
        n = lmp.extract_global("nlocal")
        kind = np.array(lmp.numpy.extract_atom("type", nelem=n)).ravel()[:n] == 1
        m, rho = (np.array(lmp.numpy.extract_atom(name, nelem=n)).ravel()[:n][kind] for name in ("rmass", "rho"))
        phi = np.array(lmp.numpy.extract_fix("g", 1, 2))[:n, 0][kind]
        level, energy = (lmp.extract_fix("mean", 0, 1, column) for column in (0, 1))
        print(f"{'bed' if bed else 'water'}, step {part * (k + 1)}: level {level:.4f}, kinetic energy {energy:.2e}, "
              f"volumes {(m / (rho * (1 - phi))).sum() / 36:.4f}", flush=True)
    lmp.close()


options = argparse.ArgumentParser()
options.add_argument("--steps", type=int, default=100000)
options.add_argument("--tank", choices=("water", "bed", "both"), default="both")
options = options.parse_args()
for bed in {"water": [0], "bed": [1], "both": [0, 1]}[options.tank]:
    print_rows(bed, options.steps)
