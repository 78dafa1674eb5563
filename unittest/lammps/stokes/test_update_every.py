"""Keyword update_every: v' every N steps, F with the velocity of every step."""
import numpy as np
import pytest

import model
from system import Spheres, dump_lines, largest_difference, read_dump

ETA, A, DT = 1.3, 0.7, 0.01
STOKES = 6 * np.pi * ETA * A
EXACT = "algorithm 2 relative_tolerance 1e-12"
COLUMNS = "x y z vx vy vz f_drag[1] f_drag[2] f_drag[3] f_drag[4] f_drag[5] f_drag[6]"


def three():
    return Spheres([(0, 0, 0), (1.6, 0.3, 0), (0.2, 1.9, 0.8)], A, [(0.3, 0, 0.1), (0, -0.2, 0.4), (0.1, 0.1, -0.5)])


def falling(simulation, first_step=0, n=10, reach="inf", more=""):
    sim = simulation(three(), f"cut_off_distance {reach} visc {ETA} update_every {n} {EXACT} {more}", dt=DT)
    return sim.commands([f"reset_timestep {first_step}", "fix pull all gravity 3.0 vector 0.2 0 -1",
                         "fix move all nve/sphere", "neigh_modify every 1 delay 0"] +
                        dump_lines(sim.folder / "dump", columns=COLUMNS))


def rows(sim, steps):
    sim.run(steps)
    solves = sim.solves
    sim.close()
    return read_dump(sim.folder / "dump"), solves


@pytest.mark.hard_case("update_every from rest: the first step is solved")
@pytest.mark.parametrize("first_step", [0, 7, 10, 13])
@pytest.mark.parametrize("reach", ["inf", "10"])
def test_first_step_is_solved_and_not_free_draining(simulation, first_step, reach):
    sim = falling(simulation, first_step, reach=reach).run(0)
    spheres = three()
    assert largest_difference(sim.drag, model.forces(spheres, ETA)) < 1e-10
    assert largest_difference(sim.drag, -STOKES * spheres.v) > 0.1
    assert sim.solves == 1


@pytest.mark.parametrize("reach", ["inf", "10"])
def test_between_solves_the_force_follows_the_velocity_with_the_stored_perturbation(simulation, reach):
    frames, _ = rows(falling(simulation, reach=reach), 29)
    for (_, before), (step, now) in zip(frames, frames[1:]):
        half_step_velocity = (now[:, 0:3] - before[:, 0:3]) / DT            # which velocity Verlet shows to forces
        stored = now[:, 9:12]
        assert largest_difference(now[:, 6:9], STOKES * (stored - half_step_velocity)) < 1e-11
        if step % 10:
            assert np.array_equal(stored, before[:, 9:12])
        else:
            assert not np.array_equal(stored, before[:, 9:12])
            fresh = model.forces(Spheres(now[:, 0:3], A, half_step_velocity), ETA)
            assert largest_difference(now[:, 6:9], fresh) < 1e-10


@pytest.mark.parametrize("first_step,steps,due", [(0, 29, {10, 20}), (0, 30, {10, 20, 30}), (7, 20, {10, 20}),
                                                  (10, 5, set()), (13, 7, {20})])
def test_solves_fall_on_multiples_of_n(simulation, first_step, steps, due):
    frames, solves = rows(falling(simulation, first_step), steps)
    changed = {step for (_, a), (step, b) in zip(frames, frames[1:]) if not np.array_equal(a[:, 9:12], b[:, 9:12])}
    assert changed == due
    assert solves == 1 + len(due)


def test_between_solves_the_force_follows_the_fluid(simulation):
    sim = simulation(three(), f"cut_off_distance inf visc {ETA} update_every 10 {EXACT} fluid_velocity v_u 0 0",
                     before_pair="variable u equal 0.2*step")
    sim.commands(dump_lines(sim.folder / "dump", columns=COLUMNS))          # nothing integrates
    frames, _ = rows(sim, 9)
    stored = frames[0][1][:, 9:12]
    for step, now in frames:
        assert np.array_equal(now[:, 9:12], stored)
        assert largest_difference(now[:, 6:9], STOKES * (stored + (0.2 * step, 0, 0) - three().v)) < 1e-13


def test_perturbation_follows_its_sphere_to_another_rank(tmp_path):
    """Spheres cross the border of two ranks and are sorted between solves."""
    from system import input_lines, lmp
    spheres = Spheres([(-1.2, 0, 0), (-2.6, 0.4, 0.2), (1.3, 0.1, 0), (2.7, 0, 0)], A,
                      [(2, 0, 0.1), (2, 0.1, 0), (-0.4, 0, 0.3), (1, 0, 0)])
    for ranks in (1, 2):
        lines = input_lines(spheres,
                            f"cut_off_distance 9 visc {ETA} update_every 50 algorithm 2 relative_tolerance 1e-12",
                            tmp_path / "data",
                            box=[(-9, 9), (-2, 2), (-2, 2)],
                            before_pair="neigh_modify every 1 delay 0 check no\natom_modify sort 3 1.0", dt=DT)
        lines += ["unfix drag", "fix drag all stokes_dynamics apply no", "fix move all nve/sphere"]
        lines += dump_lines(tmp_path / f"dump{ranks}", every=10, columns=COLUMNS) + ["run 140"]
        lmp(tmp_path, lines, ranks=ranks)
    one, two = (read_dump(tmp_path / f"dump{ranks}") for ranks in (1, 2))
    assert one[-1][1][0, 0] > 0.5                       # it did cross
    for (step, a), (_, b) in zip(one, two):
        assert largest_difference(b[:, 6:9], a[:, 6:9]) < 1e-10, step
        assert largest_difference(b[:, 9:12], a[:, 9:12]) < 1e-10, step


@pytest.mark.parametrize("moved", [True, False])
def test_a_run_at_another_step_solves_first(simulation, moved):
    """Also when the step that reset_timestep sets is in the interval of the last solve: spheres may have been displaced
    meanwhile."""
    sim = simulation(three(), f"cut_off_distance inf visc {ETA} update_every 10 {EXACT}", dt=1e-9).run(13)
    sim.commands((["displace_atoms all random 0.3 0.3 0.3 77"] if moved else []) + ["reset_timestep 17"]).run(0)
    assert largest_difference(sim.drag, model.forces(Spheres(sim.x, A, three().v), ETA)) < 1e-10
