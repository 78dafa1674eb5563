#!/usr/bin/env python3
"""Cost of fix sph/grains: a step with 10^4 grains in 10^5 water particles over the same step without the coupling.

    . build/env.sh
    /usr/bin/python3 unittest/bench/grains_cost.py [--repeat 3] [--steps 8] [--side 46] [--grains 10000]

side^3 water particles on a lattice, h of 2 spacings, viscosity, shift and delta; grains of half a spacing at random
among them, periodic. Every repetition runs both one after the other, so that a busy machine slows both alike; the ratio
is that of processor time on one rank, the median of the repetitions.
"""
import argparse
import statistics
import tempfile

from sph_cost import seconds

SCENE = """
units lj
atom_style hybrid sph sphere
boundary p p p
comm_modify vel yes
lattice sc 1 origin 0.5 0.5 0.5
region box block 0 {side} 0 {side} 0 {side} units box
create_box 2 box
create_atoms 1 box
create_atoms 2 random {grains} 4711 NULL
mass * 1
group water type 1
group grains type 2
set type 2 diameter 0.5 density 2.65
set type 1 sph/rho 1
set type 1 mass 1
velocity water create 0.01 4711 loop geom
pair_style hybrid/overlay sph/artVisc/tensCorr wendland 2 viscosity 0.3 central shift yes zero 0.5
pair_coeff * * zero
pair_coeff 1 1 sph/artVisc/tensCorr c 10 deltap 1
neighbor 0.3 bin
neigh_modify delay 0 every 1
timestep 0.02
thermo 1000
fix eos water sph/pressure Tait 14.2857 1 7
fix den water sph/density/continuity delta 0.1 volume yes
fix flow water nve/sph
fix move grains nve/sphere
fix down grains addforce 0 0 -0.01
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, default in (("repeat", 3), ("steps", 8), ("side", 46), ("grains", 10000)):
        parser.add_argument("--" + name, type=int, default=default)
    given = parser.parse_args()
    scene, ratios = SCENE.format(side=given.side, grains=given.grains), []
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(given.repeat):
            without, coupled = [seconds(scene + more, given.steps, 1, folder) / given.steps
                                for more in ("", "fix couple grains sph/grains\n")]
            ratios.append(coupled / without)
            print(f"  a step {without:.3f} s without, {coupled:.3f} s with the coupling: {ratios[-1]:.3f}", flush=True)
    print(f"{given.grains} grains in {given.side ** 3} water particles: {statistics.median(ratios):.3f} of the step "
          f"without the coupling ({min(ratios):.3f} to {max(ratios):.3f})")


if __name__ == "__main__":
    main()
