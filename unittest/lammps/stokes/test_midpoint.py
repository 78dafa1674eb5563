"""fix stokes_dynamics/overdamped, scheme midpoint: who takes part and who is near whom are those of the step, in its
middle too."""
import numpy as np
import pytest

from system import Spheres
from without_inertia import P6

MOVE = "fix move all stokes_dynamics/overdamped scheme midpoint"


def swing(simulation, lists):
    """Two spheres: a step away from each other, by less than half the skin of 6, and two towards each other. They begin
    0.4 skins within cut-off and skin, are beyond these in the middle of the first step, and end 0.3 skins within the
    cut-off of 8."""
    skin, cutoff = 6.0, 8.0
    x = 0.5 * (cutoff + 0.6 * skin)
    unit = P6 * 0.45 * skin    # forces so that, on the line through the last two, v is 1, -1, -1 in these units
    sim = simulation(Spheres([(-x, 0, 0), (x, 0, 0)]),
                     f"cut_off_distance {cutoff} taper wendland visc 1 relative_tolerance 1e-12",
                     box=[(-30, 30)] * 3, dt=1.0, fix=False, before_pair=f"neighbor {skin} bin\nneigh_modify {lists}\n"
                     "comm_modify cutoff 15")
    sim.commands([f"variable f equal {unit!r}*((step==0)-(step==1)/3-(step==2)*7/9)", "variable g equal -v_f",
                  "group one id 1", "group two id 2", "fix a one addforce v_g 0 0", "fix b two addforce v_f 0 0",
                  "fix c all addforce 0 1 0", MOVE]).run(3)
    return sim.x, sim.v


def test_a_list_is_made_where_lammps_re_neighboured(simulation):
    (x, v), (there, kept) = swing(simulation,
                                  "delay 0 every 1 check no"), swing(simulation, "delay 0 every 1 check yes")
    assert x[1, 0] - x[0, 0] == pytest.approx(8.0 - 0.3 * 6.0, abs=1e-9)
    assert np.abs(v[:, 1] - 1 / P6).max() > 1e-3 / P6    # they feel each other
    assert np.abs(there - x).max() < 1e-12 and np.abs(kept - v).max() < 1e-12


def test_a_sphere_that_is_outside_of_the_region_only_in_the_middle_of_a_step(simulation):
    """x' = x + dt u(x + dt/2 u(x)), whether or not the region has a gap there"""
    ends = []
    for gap in ("", "region gap block 0.4 0.6 INF INF INF INF side out"):
        sim = simulation(Spheres([(0, 0, 0), (9, 0, 0)]),
                         f"cut_off_distance inf visc 1 fluid_velocity v_u 0 0 {'region gap' if gap else ''}",
                         box=[(-30, 30)] * 3, dt=1.0, fix=False, before_pair=f"variable u atom (1+0.5*x)*(x<4)\n{gap}")
        ends.append(sim.commands(MOVE).run(1).x)
    assert ends[0][0, 0] == pytest.approx(1.25, rel=1e-3)
    assert np.array_equal(*ends)
