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


PLACES = np.array([(-4.0, 1, 2), (3, -2, 1)])


def at_places(simulation, commands, dt, molecule=0):
    words = "cut_off_distance inf visc 1 relative_tolerance 1e-10" + " rigid_clumps yes rotation yes" * molecule
    return simulation(Spheres(PLACES, molecule=molecule), words, box=[(-10, 10)] * 3, boundary="p p p", dt=dt,
                      fix=False).commands(commands).run(10)


@pytest.mark.parametrize("noise, error", [("", 1e-12), (" temperature 1e-4 4711", 2e-3)])
def test_a_step_begins_where_a_barostat_has_put_the_spheres(simulation, noise, error):
    """Without forces they keep their places in the box, which shrinks; noise moves them by some 3e-4."""
    sim = at_places(simulation, [MOVE + noise, "fix press all press/berendsen iso 2 2 0.1 modulus 10"], 1e-3)
    edge = sim.lmp.extract_box()[1][0]
    assert 9.9 < edge < 9.95
    assert np.abs(sim.x * 10 / edge - PLACES).max() < error


@pytest.mark.parametrize("noise, molecule", [("", 0), ("", 1), (" temperature 0.01 4711", 0)])
def test_a_step_begins_where_spheres_are_centred(simulation, noise, molecule):
    """fix recenter does so before the step, so that their centre is off by this one at its end. Noise is tied to the
    grid of the box, and so another one."""
    free, centred = (at_places(simulation, [centre, "fix w all addforce 1 0 0", MOVE + noise], 1e-2, molecule).x
                     for centre in ("", "fix centre all recenter 1 2 3"))
    assert noise or np.abs(np.diff(free, axis=0) - np.diff(centred, axis=0)).max() < 1e-8
    assert np.abs(centred.mean(axis=0) - (1, 2, 3)).max() < 0.03
