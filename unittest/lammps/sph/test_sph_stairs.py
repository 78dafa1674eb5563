"""A bed that is cut out of a lattice turned by 1:3 has stairs. With slip and shift pliant water runs down it as down a
smooth slope without friction, and stands on it."""
import numpy as np
import pytest

from sph_tools import by_id, run, start

SLOPE = """
units si
dimension 2
atom_style sph
atom_modify map array
boundary p f p
lattice sq 0.1 orient x 3 1 0 orient y -1 3 0 origin 0.33 0.17 0
region box block 0 $(0.4*sqrt(10)) -0.5 1.6 -0.05 0.05 units box
create_box 2 box
region bed block INF INF -0.45 0 INF INF units box
region water block INF INF 0 1 INF INF units box
create_atoms 1 region water
create_atoms 2 region bed
mass * 10
group water type 1
group bed type 2
set group all sph/rho 1000
variable rho atom 1000*(1+7*9.81/1600*(1-y))^(1/7)
set group water sph/rho v_rho
neighbor 0.05 bin
neigh_modify delay 0 every 1 exclude type 2 2
pair_style sph/artVisc/tensCorr wendland 0.2 viscosity 1e-6 central shift pliant
pair_coeff * * c 40
fix eos all sph/pressure Tait $(1600*1000/7) 1000 7
fix density all sph/density/continuity delta 0.1
fix bed bed wall/adami/sph gravity {along} -9.81 0 slip yes
fix move water nve/sph
fix weight water gravity $(sqrt({along}^2+9.81^2)) vector {along} -9.81 0
fix flat all enforce2d
timestep 1.25e-3
run 800
"""


def velocities(along):
    """Of the water after 1 s, on a slope with the acceleration `along`"""
    lmp = start()
    try:
        run(lmp, SLOPE.format(along=along))
        return by_id(lmp, "v", 3)[by_id(lmp, "type") == 1]
    finally:
        lmp.close()


def test_water_runs_down_stairs_as_down_a_smooth_slope():
    """u = g sin(theta) t; 0.970, and 0.956 with shift yes."""
    assert velocities(1.0)[:, 0].mean() == pytest.approx(1.0, abs=0.035)


def test_still_water_stays_still_on_stairs():
    """The speed of waves is 3.1: half a per cent of it."""
    v = velocities(0.0)
    assert np.sqrt((v**2).sum(1).mean()) < 0.016 and abs(v[:, 0].mean()) < 1e-3
