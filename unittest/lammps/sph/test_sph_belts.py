"""Wall particles that have a velocity and keep their place: the lid of a cavity, a belt, a wall that fix move no longer
moves. They rub the water and neither make nor take any."""
import numpy as np
import pytest

from sph_tools import by_id, run, start

# Water in a closed box of walls, n particles wide. The lid ends at the corners of the water.
CAVITY = """
units lj
dimension 2
atom_style sph
atom_modify map array
boundary f f p
variable n index 10
lattice sq $(v_n*v_n) origin 0.5 0.5 0
region all block -0.4 1.4 -0.4 1.4 -0.05 0.05 units box
create_box 3 all
create_atoms 2 box
region cavity block 0 1 0 1 INF INF units box
region lid block {lid} 1 INF INF INF units box
set region cavity type 1
set region lid type 3
mass * $(1/v_n^2)
group water type 1
group walls type 2 3
group lid type 3
set group all sph/rho 1
neighbor 0.05 bin
neigh_modify delay 0 every 1
pair_style sph/artVisc/tensCorr wendland 0.2 viscosity 0.05 {scheme}
pair_coeff * * c 10
fix eos all sph/pressure Tait $(100/7) 1 7
fix density all sph/density/continuity delta 0.1
fix move water nve/sph
fix wall walls wall/adami/sph own_acceleration yes
{motion}
fix flat all enforce2d
timestep 5e-3
"""
SHORT, WIDE = "0 1", "INF INF"


def water(lid, motion, scheme="shift yes", steps=400):
    """The LAMMPS after these steps; x, v and density of the water, by ID; and the IDs of all that were water at
    first."""
    lmp = start()
    run(lmp, CAVITY.format(lid=lid, motion=motion, scheme=scheme) + f"run {steps}")
    flows = by_id(lmp, "type") == 1
    assert flows.sum() == 100
    return lmp, by_id(lmp, "x", 3)[flows], by_id(lmp, "v", 3)[flows], by_id(lmp, "rho")[flows]


@pytest.mark.parametrize("lid, scheme", [(SHORT, ""), (SHORT, "shift yes"), (SHORT, "correction yes"),
                                         (WIDE, "shift yes")])
def test_a_lid_neither_makes_nor_takes_water(lid, scheme):
    """The water turns under a lid of a tenth of the speed of sound, so its density differs by about v^2/c^2 = 0.01. A
    lid that the density took to move would be a source at one end of the cavity and a sink at the other."""
    lmp, x, v, rho = water(lid, "velocity lid set 1 0 0 units box", scheme)
    lmp.close()
    assert ((x[:, :2] > 0) & (x[:, :2] < 1)).all()
    assert 0.97 < rho.min() and rho.max() < 1.04
    assert v[:, 0].max() > 0.2 and v[:, 0].min() < -0.05


def test_a_wall_that_fix_move_has_left_stands():
    """Its velocity is still there, and the user need not take it away for the water to stay."""
    motion = "fix go walls move linear 0.08 0 0 units box\nrun 100\nunfix go"
    lmp, x, _, rho = water(SHORT, motion, steps=600)
    moved = 0.08 * 100 * 5e-3
    lmp.close()
    assert (x[:, 0] > moved - 0.02).all() and (x[:, 0] < 1 + moved + 0.02).all() and (x[:, 1] < 1.02).all() and (
        x[:, 1] > -0.02).all()
    assert 0.97 < rho.min() and rho.max() < 1.03


def test_a_lid_that_gains_speed_does_not_push():
    """With own_acceleration yes the wall's pressure follows the acceleration of its place, and that of a lid is 0."""
    pressed = []
    for speed in (0, 5):
        lmp, *_ = water(SHORT, "run 1", steps=1)
        run(lmp, f"velocity lid set {speed} 0 0 units box\nrun 1 pre no")
        pressed.append(by_id(lmp, "rho")[by_id(lmp, "type") == 3])
        lmp.close()
    assert np.abs(pressed[1] - pressed[0]).max() < 1e-3


def test_the_run_says_that_it_has_belts(tmp_path):
    log = tmp_path / "log"
    for speed, said in ((0, 0), (1, 1)):
        lmp = start(["-log", str(log)])
        run(lmp, CAVITY.format(lid=SHORT, motion=f"velocity lid set {speed} 0 0 units box", scheme="shift yes") +
            "run 1")
        lmp.close()
        lines = [line for line in log.read_text().splitlines() if "particles of the wall have a velocity" in line]
        assert len(lines) == said
    assert lines[0].startswith("Fix wall/adami/sph: 40 particles") and "lid or a belt" in lines[0]
