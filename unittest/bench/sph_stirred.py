#!/usr/bin/env python3
"""Water that has been thrown about in a tank and has come to rest: how much higher does it stand than it was filled?

    . build/env.sh
    unittest/bench/sph_stirred.py 8 16 [--scheme "shift pliant"]     # numbers of rows; 32 take some minutes

Two dimensions, depth 1 and width 2, g = 1, c = 20, Wendland's kernel, h of two spacings, delta 0.1, viscosity 0.005
central. The water begins with vortices of 1.5 sqrt(g H). At t = 30 nothing moves; the level is that of three probes.
"""
import argparse
import sys

from from_tests import np
sys.path.insert(0, __file__.rsplit("/bench", 1)[0] + "/lammps")
from sph_tools import run, start       # noqa: E402

END = 30.0


def tank(n, scheme):
    dx, h = 1 / n, 2 / n
    return f"""
units lj
dimension 2
boundary f f p
atom_style sph
lattice sq {n * n} origin 0.5 0.5 0
region box block {-6 * dx} {2 + 6 * dx} {-6 * dx} 7 {-dx / 2} {dx / 2} units box
create_box 2 box
region all block {-4 * dx} {2 + 4 * dx} {-4 * dx} 5 INF INF units box
region room block 0 2 0 INF INF INF units box
region air block 0 2 1 INF INF INF units box
create_atoms 2 region all
set region room type 1
delete_atoms region air
mass * {dx * dx}
set group all sph/rho 1
group water type 1
group walls type 2
displace_atoms water random {0.05 * dx} {0.05 * dx} 0 1 units box
variable vx atom 3*sin(PI*x)*(y-0.5)
variable vy atom 1.5*cos(PI*x)
velocity water set v_vx v_vy NULL units box
pair_style sph/artVisc/tensCorr wendland {h} viscosity 0.005 central {scheme}
pair_coeff * * c 20
fix eos all sph/pressure Tait $(400/7) 1 7
fix density all sph/density/continuity delta 0.1
fix tank walls wall/adami/sph gravity 0 -1 0
fix move water nve/sph
fix fall water gravity 1 vector 0 -1 0
fix flat all enforce2d
compute level water sph/probe height y 0.5 0.3 0 height y 1 0.3 0 height y 1.5 0.3 0
neighbor {0.3 * dx} bin
neigh_modify delay 0 every 1
timestep {0.35 * h / 20}
fix mean all ave/time 10 100 {int(END / (0.35 * h / 20)) // 1000 * 1000} c_level[1] c_level[2] c_level[3]
run {int(END / (0.35 * h / 20)) // 1000 * 1000}
"""


options = argparse.ArgumentParser()
options.add_argument("rows", type=int, nargs="+")
options.add_argument("--scheme", default="shift yes")
options = options.parse_args()
for n in options.rows:
    lmp = start()
    run(lmp, tank(n, options.scheme))
    rise = np.mean([lmp.extract_fix("mean", 0, 1, k) for k in range(3)]) + 0.3 - 1
    print(f"{options.scheme}, {n} rows: the level is {100 * rise:.1f} % too high, {n * rise:.2f} spacings", flush=True)
    lmp.close()
