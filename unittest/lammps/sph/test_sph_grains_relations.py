"""fix sph/grains: changes of an input that must not matter do not. relations.py draws others: ranks, newton, pieces,
restarts, frames, hybrids."""
import re

import numpy as np
import pytest

from grains_tools import scene, singles
from sph_tools import by_id, fix_by_id, run, start

WIDE = (6, 4, 14)
places = np.random.default_rng(3).uniform((0.5, 0, 1), (5.5, 4, 14), (30, 3))
TANK = scene(WIDE, 0.3, 8, 0.02, "drag beetstra", singles(places), 0.9, "p p f", gravity="0 0 -0.5", floor=4,
             before_fix="fix down all gravity 0.5 vector 0 0 -1\nvelocity grains set 0.1 -0.2 -0.3 units box")
TANK = TANK.replace("set type 1*3 sph/rho 1", "set type 1 sph/rho 1\n    set type 2 sph/rho 1\n"
                                              "    set type 3 sph/rho 1")


def state(script, commands="run 30"):
    """Places, velocities, masses, pressures and forces of the fix, by ID."""
    lmp = start()
    run(lmp, script)
    run(lmp, commands)
    n = lmp.extract_global("nlocal")
    order = np.argsort(np.array(lmp.numpy.extract_atom("id", nelem=n)).ravel()[:n])
    found = by_id(lmp, "x", 3), by_id(lmp, "v", 3), by_id(lmp, "rmass"), fix_by_id(lmp, "eos"), np.array(
        lmp.numpy.extract_fix("g", 1, 2))[:n][order]
    lmp.close()
    return found


def difference(found, right):
    off = [np.abs(a - b) for a, b in zip(found, right)]
    off[0] = np.minimum(off[0], np.abs(off[0] - (WIDE[0], WIDE[1], np.inf)))
    return max(a.max() for a in off)


@pytest.fixture(scope="module")
def right():
    return state(TANK)


def renamed(script, names):
    """The same with other types: names[old] = new."""
    def line(text):
        words = text.split(" ")
        if words[0] == "create_atoms":
            words[1] = names[words[1]]
        elif words[0] == "pair_coeff" and words[1] in names:
            words[1:3] = sorted(names[w] for w in words[1:3])
        elif words[0] in ("set", "group") and "type" in words:
            after = words.index("type") + 1
            words[after:] = [names.get(w, w) if k == 0 or words[0] == "group" else w
                             for k, w in enumerate(words[after:])]
        return " ".join(words)
    return "\n".join(line(text.strip()) for text in script.split("\n"))


INPUTS = {
    "other order of types": renamed(TANK, {"1": "2", "2": "3", "3": "1"}),
    "grains first": renamed(TANK, {"1": "3", "2": "1", "3": "2"}),
    "groups of pressure and density that overlap with grains": re.sub("fix (eos|den) sph", r"fix \1 all", TANK),
    "atoms are sorted": TANK.replace("sort 0 0", "sort 5 1.0"),
    "skin": TANK.replace("neighbor 0.3", "neighbor 0.8"),
    "hybrid": TANK.replace("hybrid/overlay", "hybrid").replace("* * zero", "1*3 2 zero\n    pair_coeff 2 3 zero"),
    "diameters are set anew in each step": TANK.replace("hybrid sph sphere", "hybrid sph sphere 1").replace(
        "fix g grains", "variable d equal 0.9\n    fix same grains adapt 1 atom diameter v_d\n    fix g grains"),
    "a third pair style": TANK.replace("zero 1", "zero 1 gran/hooke 0 0 0 0 0 0").replace(
        "* * zero", "* * zero\n    pair_coeff 2 2 gran/hooke"),
}


@pytest.mark.parametrize("change", INPUTS)
def test_an_input_that_says_the_same_gives_the_same(change, right):
    assert INPUTS[change] != TANK
    assert difference(state(INPUTS[change]), right) < 1e-12


def test_twice_the_thickness_of_a_slice_is_twice_the_same(right):
    """A slice of 2 h, the thinnest, and its neighbour: no grain sees its own image."""
    found = state(TANK.replace("set type 1 sph/rho 1", "replicate 1 2 1\n    set type 1 sph/rho 1"))
    for one, two in zip(right[1:], found[1:]):
        assert np.abs(np.sort(np.concatenate([one, one]), 0) - np.sort(two, 0)).max() < 1e-12


@pytest.mark.parametrize("again, allowed", [("eos sph sph/pressure Tait %.17g 1 7" % (64 / 7), 1e-12),
                                            ("den sph sph/density/continuity delta 0.1 volume yes", 1e-12),
                                            ("g grains sph/grains drag beetstra displace no", 2e-3)])
def test_a_fix_that_is_defined_again_goes_on(again, allowed, right):
    """The coupling finds the drag anew: second order in the time step, here 1e-3 of the forces in that moment."""
    found = state(TANK, f"run 15\nunfix {again.split()[0]}\nfix {again}\nrun 15")
    assert difference(found, right) < allowed


def test_grains_pass_open_ends_with_the_water():
    """Grains as heavy as the water that a plug flow carries from near an inlet through an outlet: nothing accelerates,
    and the water that comes in fills the room that they leave."""
    lmp = start()
    text = scene((24, 5, 5), 0.05, 10, 0.05, "", singles([(10.2, 2.4, 2.6), (11.2, 3.4, 1.6)]), 0.9, "f p p",
                 density=1.0)
    run(lmp, text + "velocity all set 1 0 0 units box\nfix in water sph/inlet xlo 7 7 velocity 1\n"
                    "fix out water sph/outlet xhi 17 7 pressure 0\nrun 200")
    x, v, m, kind = by_id(lmp, "x", 3)[:, 0], by_id(lmp, "v", 3), by_id(lmp, "rmass"), by_id(lmp, "type")
    lmp.close()
    assert np.abs(v - [1, 0, 0]).max() < 1e-9 and (x[kind == 2] > 17).all()
    flow = (kind == 1) & (x > 7) & (x < 17)
    assert flow.sum() == 250 and abs(m[flow].sum() - 250) < 1e-3


def test_the_discharge_of_an_inlet_is_that_of_the_water_between_the_grains():
    """A bed at rest, phi 0.4, that reaches into the layer: Q of water alone, so that it flows with Q/(A (1 - phi)); 5 %
    for the end of the layer, where grains stand at the surface of the water."""
    lmp = start()
    bed = "lattice sc 1 origin 0.5 0.5 0.5\nregion bed block 0 12 0 5 0 5 units box\ncreate_atoms 2 region bed"
    run(lmp, scene((12, 5, 5), 0.5, 10, 0.05, "", bed, (6 / np.pi * 0.4) ** (1 / 3), "f p p", mover="") +
        "fix in water sph/inlet xlo 7 7 flow_rate 2.5\nrun 2")
    x, v, kind = by_id(lmp, "x", 3)[:, 0], by_id(lmp, "v", 3)[:, 0], by_id(lmp, "type")
    lmp.close()
    assert v[(kind == 1) & (x < 7)] == pytest.approx(0.1 / 0.6, rel=0.05)
