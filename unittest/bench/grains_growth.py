#!/usr/bin/env python3
"""Growth of the Rayleigh-Taylor instability of a suspension of phi 0.1 over clear water (fix sph/grains), and of two
fluids of its density, against linear theory.

    . build/env.sh
    unittest/bench/grains_growth.py [WAVELENGTH ...] 

In spacings of the water, h = 2; 16 and 32 unless others are given: half a minute on a free core.

Scene and theory are those of unittest/lammps/sph/test_sph_suspension.py. "With the kernel" is the theory of grains that
move with the mean of the water over the kernel and bear on that mean.
"""
import os
import sys

import from_tests

sys.path.insert(0, os.path.join(sys.path[0], "sph"))
from test_sph_suspension import EXCESS, MU, growth, suspension, theory  # noqa: E402

TWO_FLUIDS = """
units lj
atom_style hybrid sph sphere
atom_modify map array sort 0 0
lattice sc 1 origin 0.5 0.5 0.5
region box block 0 {across} 0 4 0 {across} units box
region layer block 0 {across} 0 4 {low} {high} units box
create_box 2 box
create_atoms 1 box
set region layer type 2
group light type 1
group heavy type 2
set type 1 mass 1
set type 2 mass {rho}
set type 1 sph/rho 1
set type 2 sph/rho {rho}
displace_atoms all random 0.05 0.05 0.05 77 units box
pair_style sph/artVisc/tensCorr wendland 2 viscosity {mu} central shift yes
pair_coeff * * c 10 deltap 1
comm_modify vel yes
neighbor 0.3 bin
neigh_modify delay 0 every 1
timestep 0.04
fix one light sph/pressure Tait {B} 1 7
fix two heavy sph/pressure Tait {B2} {rho} 7
fix density all sph/density/continuity delta 0.1 volume yes
fix flow all nve/sph
fix weight heavy addforce 0 0 {down}
fix lift light addforce 0 0 {up}
"""


def two_fluids(across):
    rho = 1 + EXCESS
    return TWO_FLUIDS.format(across=across, low=across // 4, high=3 * across // 4, rho=rho, mu=MU, B=100 / 7,
                             B2=100 * rho / 7, down=-EXCESS / 2, up=EXCESS / 2)


for across in [int(word) for word in sys.argv[1:]] or [16, 32]:
    time = {16: 9}.get(across, 14 * (across / 32) ** 0.5)
    sharp, blurred = theory(across, False)[0], theory(across, True)[0]
    found = growth(suspension(across), across, time)
    print(f"wavelength {across / 2:g} h: suspension {found:.4f}, {found / sharp:.3f} of theory ({sharp:.4f}), "
          f"{found / blurred:.3f} of that with the kernel ({blurred:.4f}); "
          f"two fluids {growth(two_fluids(across), across, time) / sharp:.3f} of theory", flush=True)
