"""Suspensions of fix sph/grains: how they settle in a tank."""
import numpy as np
import pytest

from grains_tools import of_bed, scene
from sph_tools import by_id, run, start


@pytest.mark.parametrize("law, phi, w", [("brown_lawler", 0.2, 0.05), ("beetstra", 0.4, 0.02)])
def test_a_suspension_settles_in_a_tank_with_the_flow_back(law, phi, w):
    """From the floor to the surface, heavier than water by F(w): the grains of its middle fall at (1 - phi) w, with the law's slip w, as the water between
    them rises by phi w. Over the 400 steps, in which sound of the beginning goes up and down twice: 5 %."""
    mu, g, c, dt, high = 0.1, 0.1, 8, 0.05, 16
    d = (phi * 6 / np.pi) ** (1 / 3)
    density = 1 + 3 * np.pi * mu * d * w * of_bed(law, w * d / mu, 1 - phi) / (g * np.pi / 6 * d**3)
    bed = f"lattice sc 1 origin 0.5 0.5 0.5\nregion bed block 0 5 0 5 0 {high} units box\ncreate_atoms 2 region bed"
    lmp = start()
    text = scene((5, 5, high + 4), mu, c, dt, "drag " + law, bed, d, "p p f", density=density, gravity=f"0 0 {-g}", floor=4, before_fix=f"""
    fix down all gravity {g} vector 0 0 -1
    fix bottom grains wall/gran hooke 30 NULL 1 NULL 0 0 zplane 0 NULL
    variable rho atom (1+7*{g}*{1 + phi * (density - 1)}*({high}-z)/{c * c})^(1/7)
    set group sph sph/rho v_rho
    set group sph mass v_rho
    displace_atoms grains random 0.1 0.1 0.1 77 units box
    velocity grains set 0 0 {-(1 - phi) * w} units box
    velocity water set 0 0 {phi * w} units box""")
    run(lmp, text.replace("zero 1", "gran/hooke 30 NULL 1 NULL 0 0").replace("pair_coeff * * zero", "pair_coeff * * none\npair_coeff 2 2 gran/hooke"))
    run(lmp, "run 0")
    before = by_id(lmp, "x", 3)[:, 2]
    run(lmp, "run 400")
    after, kind = by_id(lmp, "x", 3)[:, 2], by_id(lmp, "type")
    lmp.close()
    middle = (kind == 2) & (before > 5) & (before < high - 5)
    speed = (before - after)[middle].mean() / (400 * dt)
    assert abs(speed / ((1 - phi) * w) - 1) < 0.05, speed / ((1 - phi) * w)
