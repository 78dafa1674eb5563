"""What is thrown back over the plane of an inlet bounces off it where the layer is not."""
import numpy as np
import pytest

from host import at_most
from sph_tools import BASIN, by_id, mpirun, run, start

TANK = BASIN + """
region low block INF 1 0 0.5 INF INF units box
region floor block INF 1.4 INF 0 INF INF units box
region end block 1 1.4 0 1.6 INF INF units box
region walls union 2 floor end
create_atoms 1 region low
create_atoms 2 region walls
mass * 0.01
{}
group water type 1
group walls type 2
neighbor 0.03 bin
neigh_modify delay 0 every 1
pair_style sph/artVisc/tensCorr wendland 0.2 artVisc 0.1 0 4e-4 shift yes
pair_coeff * * c 20
fix eos all sph/pressure Tait $(400/7) 1 7 tension no
fix density all sph/density/continuity delta 0.1
fix walls walls wall/adami/sph gravity 0 -1 0 slip yes
fix in water sph/inlet xlo 0 0.7 velocity 0 gravity 0 -1 0
fix move water nve/sph
fix g water gravity 1 vector 0 -1 0
fix flat all enforce2d
compute E water sph/energy
variable balance equal c_E+c_E[4]-c_E[6]-c_E[7]
timestep 0.0025
thermo_style custom step v_balance c_E[1]
thermo_modify norm no lost error
"""
DROP = """region drop block 0.2 0.5 1 1.3 INF INF units box
create_atoms 1 region drop
group drop region drop
velocity drop set -1 0 0 units box
variable rho atom (1+7/400*(0.5-y)*(y<0.5))^(1/7)
set group all sph/rho v_rho
"""
HIGH = """region high block 0 1 0.5 1 INF INF units box
create_atoms 1 region high
variable rho atom (1+7/400*((x<0)*(0.5-y)*(y<0.5)+(x>0)*(1-y)*(y<1)))^(1/7)
set group all sph/rho v_rho
"""


def test_spray_bounces_off_the_plane_and_falls():
    """A drop that flies against the plane of an inlet at rest, above its layer: no water hangs there in the end. The
    energy of what bounces is not lost."""
    lmp = start()
    run(lmp, TANK.format(DROP) + "run 0 post no\n")
    before = lmp.get_thermo("v_balance")
    run(lmp, "run 1600 post no")
    x, water = by_id(lmp, "x", 3), by_id(lmp, "type") == 1
    assert water.sum() == 94
    above = water & (x[:, 1] > 0.7)
    assert not (above & (x[:, 0] < 0)).any() and x[water, 0].min() > -0.7
    assert lmp.get_thermo("v_balance") == pytest.approx(before, rel=1e-4)
    lmp.close()


def test_spray_asks_nothing_of_ranks_and_restarts(tmp_path):
    """While the drop meets the plane."""
    dump = "\nwrite_dump water custom end.dump x y vx vy modify format float %.17g"
    scene = TANK.format(DROP)

    def go(ranks, text):
        done = mpirun(ranks, text + dump, tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
        rows = np.loadtxt(tmp_path / "end.dump", skiprows=9)
        return rows[np.lexsort((rows[:, 1].round(7), rows[:, 0].round(7)))]
    first = go(1, scene + "run 170")
    assert (first[:, 2] > 0.1).any()
    assert np.abs(go(at_most(2), scene + "run 170") - first).max() < 1e-10
    go(1, scene + "run 110\nwrite_restart half")
    fixes = "\n".join(line for line in scene.splitlines() if line.startswith(("fix", "neigh", "timestep", "compute")))
    assert np.abs(go(1, "atom_modify map array\nread_restart half\n" + fixes + "\nrun 60") - first).max() < 1e-10


def test_water_that_stands_above_the_layer_comes_to_rest():
    """Twice as deep before an inlet at rest as its layer: what comes over the plane stays there, and the rest comes to
    rest."""
    lmp = start()
    run(lmp, TANK.format(HIGH) + "run 1200 post no")
    x, water = by_id(lmp, "x", 3), by_id(lmp, "type") == 1
    back = water & (x[:, 0] < 0) & (x[:, 1] > 0.5)
    assert 0 < back.sum() < 12 and x[back, 0].min() > -0.06
    assert x[water & (x[:, 0] > 0), 1].max() > 0.9
    assert lmp.get_thermo("c_E[1]") < 1e-3
    lmp.close()
