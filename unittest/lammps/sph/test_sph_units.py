"""SPH takes force = mass x acceleration and pressure = mass / (length x time^2): unit systems where that does not hold
are refused."""
import numpy as np
import pytest

from sph_tools import by_id, pair_commands, random_scene, run, start
from test_sph_input import message

SCENE = random_scene().replace("units si", "units {}") + pair_commands("wendland", 1, 1,
                                                                       "viscosity 0.7") + "\nfix move all nve/sph\n"
STYLES = ["sph/pressure absolut 3", "sph/density/continuity", "sph/density/summation",
          "sph/density/corr shepard every 3", "nve/sph", "nve/sph/stationary", "wall/adami/sph",
          "check/timestep/sph 1 0.3"]


@pytest.mark.parametrize("units", ["lj", "si", "cgs", "micro", "nano"])
def test_consistent_units_give_the_same_numbers(units):
    def ten_steps(units):
        lmp = start()
        try:
            run(lmp, SCENE.format(units) + "fix c all check/timestep/sph 1 0.9\ntimestep 2e-5\nrun 10")
            return [by_id(lmp, "f", 3), by_id(lmp, "v", 3), by_id(lmp, "rho"), np.array([lmp.extract_fix("c", 0, 0)])]
        finally:
            lmp.close()

    for mine, si in zip(ten_steps(units), ten_steps("si")):
        assert np.abs(mine - si).max() <= 1e-14 * np.abs(si).max()


@pytest.mark.parametrize("units", ["real", "metal", "electron"])
@pytest.mark.parametrize("style", STYLES)
def test_other_units_are_refused_by_every_fix_that_knows_the_fluid(units, style):
    text = message(random_scene().split("fix eos")[0].replace("units si", "units " + units) + "fix 1 all " + style)
    assert "Fix " + style.split()[0] + ": units " + units in text
    assert "use units lj, si, cgs, micro or nano" in text


def test_other_units_are_refused_by_the_pair_style():
    scene = random_scene().split("fix eos")[0].replace("units si", "units real") + pair_commands("wendland", 1, 1)
    assert "Pair style sph/artVisc/tensCorr: units real" in message(scene + "\nrun 0")
