"""Trajectories: integrators, rigid bodies, contacts, a viscosity that changes."""
import numpy as np
import pytest

from system import DENSITY, Spheres, chain, dump_lines, largest_difference, read_dump

ETA, A = 1.3, 0.7
STOKES = 6 * np.pi * ETA * A
MASS = 4 / 3 * np.pi * A**3 * DENSITY
EXACT = f"visc {ETA} algorithm 2 relative_tolerance 1e-12"
# Total drag of chains of touching spheres, model, in 6 pi eta a U: along and across the axis.
ALONG = {1: 1.0, 2: 1.2307692308, 3: 1.4864864865, 10: 2.8644863357}
ACROSS = {1: 1.0, 2: 1.3913043478, 3: 1.7788461538, 10: 3.9660679076}


def three_free():
    return Spheres([(0, 0, 0), (1.9, 0.3, 0), (0.2, 1.9, 0.8)], A, [(0.3, 0, 0.1), (0, -0.2, 0.4), (0.1, 0.1, -0.5)],
                   molecule=1)


def test_force_inside_the_pair_style_and_by_the_fix_give_the_same_trajectory(simulation):
    ends = []
    for add_force in ("yes", "no"):
        sim = simulation(three_free(), f"cut_off_distance inf {EXACT} add_force {add_force}", dt=0.01,
                         box=[(-20.0, 20.0)] * 3)
        sim.commands("fix move all nve/sphere\nfix pull all gravity 2.0 vector 0 0 -1").run(200)
        ends.append(np.hstack([sim.x, sim.v]))
    assert np.abs(ends[1] - ends[0]).max() < 1e-13


def test_lone_sphere_slows_down_as_stokes_says(simulation):
    tau, dt = MASS / STOKES, 1e-3
    sim = simulation(Spheres([(0, 0, 0)], A, (0, 0, 0.5)), f"cut_off_distance inf {EXACT} add_force yes", dt=dt,
                     fix=False, box=[(-9.0, 9.0)] * 3)
    sim.commands("fix move all nve/sphere").run(100)
    # LAMMPS's velocity Verlet with a force of the half-step velocity: v/2 dt and 1/(1 + ...) differ from exp in second
    # order
    assert sim.v[0, 2] == pytest.approx(0.5 * np.exp(-100 * dt / tau), rel=2 * dt / tau)


def terminal_velocity(simulation, spheres, integrate, gravity, style="clumps_only yes", steps=1500, dt=0.02):
    sim = simulation(spheres, f"{style} {EXACT}", dt=dt, comm="comm_modify cutoff 60",
                     box=[(-30.0, 30.0), (-30.0, 30.0), (-60.0, 20.0)])
    sim.commands(["thermo_style custom step", "neigh_modify exclude molecule/intra all",
                  f"fix pull all gravity {gravity} vector 0 0 -1",
                  f"fix move all {integrate}"]).run(steps)
    return sim


@pytest.mark.parametrize("integrate", ["rigid single", "rigid molecule", "rigid/small molecule"])
def test_rigid_chain_of_three_falls_at_the_velocity_of_the_model(simulation, integrate):
    g = 2.0
    sim = terminal_velocity(simulation, chain(3, 2 * A, axis=2, a=A), integrate, g)
    assert sim.v[:, 2] == pytest.approx(-3 * MASS * g / (STOKES * ALONG[3]), rel=1e-8)
    assert np.abs(sim.v[:, :2]).max() < 1e-10


def test_rigid_chain_at_45_degrees_keeps_its_orientation_and_drifts(simulation):
    g, axis = 2.0, np.array((1, 0, 1)) / np.sqrt(2)
    spheres = Spheres(np.outer(np.arange(3) - 1, 2 * A * axis), A, molecule=1)
    sim = terminal_velocity(simulation, spheres, "rigid/small molecule", g)
    weight = 3 * MASS * g / STOKES
    along, across = weight / np.sqrt(2) / ALONG[3], weight / np.sqrt(2) / ACROSS[3]
    expected = (-(along - across) / np.sqrt(2), 0, -(along + across) / np.sqrt(2))
    assert np.abs(sim.v - expected).max() < 1e-7 * weight
    now = sim.x[2] - sim.x[0]
    assert np.abs(now / np.linalg.norm(now) - axis).max() < 1e-9


def test_two_rigid_clumps_with_clumps_only_fall_as_if_alone(simulation):
    g = 2.0
    x = np.vstack([chain(3, 2 * A).x, chain(2, 2 * A, axis=0).x + (0, 2.2 * A, 0)])
    sim = terminal_velocity(simulation, Spheres(x, A, molecule=[1] * 3 + [2] * 2), "rigid/small molecule", g)
    assert sim.v[:3, 2] == pytest.approx(-3 * MASS * g / (STOKES * ALONG[3]), rel=1e-8)
    assert sim.v[3:, 2] == pytest.approx(-2 * MASS * g / (STOKES * ACROSS[2]), rel=1e-8)


def test_update_every_does_not_change_the_terminal_velocity(simulation):
    g = 2.0
    sim = terminal_velocity(simulation, chain(3, 2 * A, a=A), "rigid/small molecule", g,
                            f"clumps_only yes update_every 10", steps=4000, dt=0.005)
    assert sim.v[:, 2] == pytest.approx(-3 * MASS * g / (STOKES * ALONG[3]), rel=1e-8)


def test_pair_of_free_spheres_falls_faster_than_one(simulation):
    """Side by side at s = 3, model value 1.2685185 U0: two_spheres in the mobility form."""
    g = 2.0
    sim = terminal_velocity(simulation, Spheres([(0, 0, 0), (3 * A, 0, 0)], A), "nve/sphere", g, "cut_off_distance inf")
    assert sim.v[:, 2] == pytest.approx(-MASS * g / STOKES * (1 + 3 / (4 * 3) + 1 / (2 * 27)), rel=1e-8)


def contact_scene():
    """Three spheres, two of them pressed together by a tenth of a radius."""
    return Spheres([(0, 0, 0), (1.9 * A, 0, 0), (0, 3 * A, 0)], A, [(0.3, 0, 0.1), (0, -0.2, 0.4), (0.1, 0.1, -0.5)])


GRAN = "gran/hooke/history 500 NULL 10 NULL 0.5 1"


@pytest.mark.parametrize("order", ["contact first", "drag first"])
@pytest.mark.parametrize("add_force", ["yes", "no"])
def test_under_hybrid_overlay_contact_and_drag_add_up(simulation, order, add_force):
    contact = simulation(contact_scene(), [f"pair_style {GRAN}", "pair_coeff * *"], newton="off",
                         before_pair="comm_modify vel yes", fix=False).run().f
    drag = simulation(contact_scene(), f"cut_off_distance inf {EXACT}",
                      fix=False).commands("fix drag all stokes_dynamics").run().drag
    assert np.abs(contact).max() > 1.0
    styles = [GRAN, f"stokes_dynamics cut_off_distance inf {EXACT} add_force {add_force}"]
    names = ["gran/hooke/history", "stokes_dynamics"]
    if order == "drag first":
        styles.reverse()
    lines = ["pair_style hybrid/overlay " + " ".join(styles)] + [f"pair_coeff * * {name}" for name in names]
    sim = simulation(contact_scene(), lines, newton="off", before_pair="comm_modify vel yes", fix=True).run()
    assert largest_difference(sim.f, contact + drag) < 1e-12
    assert largest_difference(sim.drag, drag) < 1e-12


def test_under_hybrid_overlay_contacts_of_rigid_clumps_do_not_hide_their_drag(simulation):
    """The usual recipe: no contacts within a clump, hence no pairs of it in LAMMPS's lists."""
    g = 2.0
    lines = [f"pair_style hybrid/overlay {GRAN} stokes_dynamics clumps_only yes {EXACT}",
             "pair_coeff * * gran/hooke/history",
             "pair_coeff * * stokes_dynamics"]
    sim = simulation(chain(3, 2 * A, a=A), lines, newton="off",
                     before_pair="comm_modify vel yes cutoff 9\nneigh_modify exclude molecule/intra all",
                     dt=0.02, box=[(-9.0, 9.0), (-9.0, 9.0), (-40.0, 20.0)])
    sim.commands(["thermo_style custom step", "fix move all rigid/small molecule",
                  f"fix pull all gravity {g} vector 0 0 -1"]).run(1500)
    assert sim.v[:, 2] == pytest.approx(-3 * MASS * g / (STOKES * ALONG[3]), rel=1e-8)


# --- fix adapt --------------------------------------------------------------------------------------------------------

def test_fix_adapt_varies_the_viscosity(simulation):
    """Nothing integrates, so F is proportional to the viscosity of the step."""
    sim = simulation(three_free(), f"cut_off_distance inf {EXACT} update_every 3")
    first = sim.run().drag
    sim.commands(["variable eta equal 1.3+0.2*step", "fix vary all adapt 1 pair stokes_dynamics visc * * v_eta"])
    sim.commands(dump_lines(sim.folder / "dump")).run(7).close()
    for step, rows in read_dump(sim.folder / "dump"):
        # v' of constant velocities does not depend on the viscosity, so solves and steps between agree
        assert largest_difference(rows[:, 6:9], first * (1.3 + 0.2 * step) / 1.3) < 1e-10, step


def test_fix_adapt_may_set_the_viscosity_back(simulation):
    sim = simulation(three_free(), f"cut_off_distance inf {EXACT}")
    first = sim.run().drag
    sim.commands(["variable eta equal 4.0", "fix vary all adapt 1 pair stokes_dynamics visc * * v_eta reset yes"]).run(
        2)
    assert largest_difference(sim.drag, first * 4.0 / 1.3) < 1e-10
    sim.commands("unfix vary").run()
    assert largest_difference(sim.drag, first) < 1e-10


def test_fix_adapt_under_hybrid_overlay(simulation):
    lines = [f"pair_style hybrid/overlay {GRAN} stokes_dynamics cut_off_distance inf {EXACT}",
             "pair_coeff * * gran/hooke/history",
             "pair_coeff * * stokes_dynamics"]
    sim = simulation(contact_scene(), lines, newton="off", before_pair="comm_modify vel yes")
    first = sim.run().drag
    sim.commands(["variable eta equal 4.0", "fix vary all adapt 1 pair stokes_dynamics visc * * v_eta"]).run(1)
    assert largest_difference(sim.drag, first * 4.0 / 1.3) < 1e-10
