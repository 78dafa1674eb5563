"""What is far away, or flies there, ends an SPH run with a message, and a compute with a number: no hang, no crash."""
import re

import pytest

from sph_tools import run, start
from system import lmp

CUBE = """
units si
atom_style sph
atom_modify map array
boundary {boundary}
plugin load stokesdynplugin.so
region box block -0.02 0.02 -0.02 0.02 -0.02 0.02
create_box 1 box
lattice sc 0.01
create_atoms 1 box
mass 1 0.001
set group all sph/rho 1000
neighbor 0.002 bin
timestep 1e-6
pair_style sph/artVisc/tensCorr wendland 0.012 artVisc 0.1 0 1e-6 tensCorr 0.2 0.01
pair_coeff * * c 20
fix eos all sph/pressure Tait 57142.9 1000 7
fix density all sph/density/continuity
fix move all nve/sph
"""


def cube(lines, boundary="s s s"):
    return CUBE.format(boundary=boundary) + lines


def test_a_particle_that_flies_farther_than_the_filler_is_away(tmp_path):
    """The list of near pairs has room for pairs alone, however far a particle goes in a step."""
    ended = lmp(tmp_path, cube("set atom 1 sph/rho 1e30\nrun 3\n"), succeed=False)
    assert ended.code == 0 or (ended.code == 1 and "ERROR: " in ended.text), ended.text[-1500:]


@pytest.mark.parametrize("boundary", ["p p p", "s s s"])
@pytest.mark.parametrize("place", ["1e7", "-1e20", "1e300"])
def test_a_probe_of_pressure_far_outside_has_a_number(tmp_path, boundary, place):
    """In a periodic box that of an image of the point, as far as the digits of its place tell which."""
    log = lmp(tmp_path, cube(f"compute P all sph/probe pressure {place} 0 0\nthermo_style custom step c_P[1]\nrun 0\n",
                             boundary)).log
    assert re.search(r"\n\s*0 +-?[0-9.e+-]+\s*\n", log)


def height_from(base, lines=""):
    script = cube(f"compute P all sph/probe height z 0.0031 0.0017 {base!r}\nthermo_style custom step c_P[1]\n"
                  f"{lines}\nrun 0", "p p s")
    sim = start()
    try:
        run(sim, script.replace("wendland 0.012", "wendland 0.02").replace("plugin load", "#"))
        return sim.extract_compute("P", 0, 1)[0]
    finally:
        sim.close()


def test_a_gauge_far_below_the_water_has_the_height_over_it():
    """Millions of millions of samples, of which those that reach particles are a few. All distances are whole numbers
    of them."""
    near = height_from(-0.02)
    assert 0.03 < near < 0.06
    for below in (1.0, 100.0, 1e9):
        assert height_from(-0.02 - below) - below == pytest.approx(near, abs=1e-6)


def test_a_drop_far_above_leaves_the_gauge_alone():
    """A single particle fills less than half of the space around it, so it is no surface."""
    without = height_from(-0.02, "group one id 5\ndelete_atoms group one")
    for up in (1.0, 300.0):
        assert height_from(-0.02, f"set atom 5 x 0.0031 y 0.0017 z {up!r}") == pytest.approx(without, rel=1e-12)


def test_a_probe_does_not_hang_in_a_run_that_blows_up(tmp_path):
    """LAMMPS looks for lost atoms when it makes a new list: until then a probe sees a particle at 1e15."""
    ended = lmp(tmp_path, cube("compute P all sph/probe pressure 0.01 0 0 height z 0 0 -0.02\n"
                               "compute S all sph/surface/atom\n"
                               "compute most all reduce max c_S[1]\nthermo_style custom step c_P[1] c_P[2] c_most\n"
                               "thermo 1\n"
                               "neigh_modify delay 10 every 10 check no\nvelocity all set 0 0 0\n"
                               "group one id 5\nvelocity one set 3e21 2e21 1e21\nrun 20\n", "p p p"), succeed=False)
    assert ended.code == 1 and re.search("ERROR: .*(density|Lost atoms|Non-numeric)", ended.text), ended.text[-1500:]
