"""What users do between and within runs: spheres come, go and change, runs are repeated, LAMMPS is cleared."""
import numpy as np
import pytest

import model
from system import LammpsError, Spheres, dump_lines, input_lines, largest_difference, lmp, read_dump

ETA, A = 1.3, 0.7
EXACT = f"visc {ETA} algorithm 2 relative_tolerance 1e-12"
BOX = [(-9.0, 9.0)] * 3
MODES = {"all": "cut_off_distance inf", "list": "cut_off_distance 15"}


def five():
    x = [(0, 0, 0), (1.5, 0.2, 0), (0, 1.7, 0.4), (2.6, 1.9, -0.7), (-1.2, 0.3, 1.8)]
    return Spheres(x, (A, 0.8 * A, A, 1.3 * A, 0.5 * A), np.random.default_rng(4).normal(size=(5, 3)),
                   molecule=[1, 1, 1, 2, 2])


def expected_now(sim, eta=ETA):
    """The model for what LAMMPS holds now; only right where forces were computed with the velocities of now."""
    return model.forces(Spheres(sim.x, sim.atom("radius").ravel(), sim.v), eta)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("n", [1, 10])
def test_run_0_twice_is_the_same(simulation, mode, n):
    sim = simulation(five(), f"{MODES[mode]} {EXACT} update_every {n}", box=BOX).run()
    first = sim.drag
    assert np.array_equal(sim.run().drag, first)
    assert largest_difference(first, expected_now(sim)) < 1e-10


def test_run_0_after_a_run_changes_nothing(simulation):
    sim = simulation(five(), f"cut_off_distance inf {EXACT}", box=BOX,
                     dt=0.01).commands("fix move all nve/sphere").run(20)
    x, v, F = sim.x, sim.v, sim.drag
    sim.run()
    assert np.array_equal(sim.x, x) and np.array_equal(sim.v, v) and np.array_equal(sim.drag, F)


@pytest.mark.parametrize("mode", MODES)
def test_velocity_set_between_runs_is_in_the_next_force(simulation, mode):
    sim = simulation(five(), f"{MODES[mode]} {EXACT}", box=BOX).run()
    sim.commands("velocity all set 0.3 -0.2 0.5").run()
    assert np.array_equal(sim.v, np.tile((0.3, -0.2, 0.5), (5, 1)))
    assert largest_difference(sim.drag, expected_now(sim)) < 1e-10


def test_velocity_set_between_solves_is_in_the_next_force_with_the_stored_perturbation(simulation):
    sim = simulation(five(), f"cut_off_distance inf {EXACT} update_every 10", box=BOX).run(3)
    stored = sim.perturbation
    sim.commands("velocity all set 0.3 -0.2 0.5").run()
    stokes = 6 * np.pi * ETA * sim.atom("radius").reshape(-1, 1)
    assert np.array_equal(sim.perturbation, stored)
    assert largest_difference(sim.drag, stokes * (stored - sim.v)) < 1e-12


@pytest.mark.parametrize("mode", MODES)
def test_displaced_spheres_are_in_the_next_force(simulation, mode):
    sim = simulation(five(), f"{MODES[mode]} {EXACT}", box=BOX, before_pair="group one id 4").run()
    sim.commands("displace_atoms one move 0.4 -0.3 0.2").run()
    assert largest_difference(sim.drag, expected_now(sim)) < 1e-10


@pytest.mark.parametrize("mode", MODES)
def test_radius_set_between_runs_is_in_the_next_force(simulation, mode):
    sim = simulation(five(), f"{MODES[mode]} {EXACT}", box=BOX).run()
    sim.commands("set atom 2 diameter 1.9").run()
    assert largest_difference(sim.drag, expected_now(sim)) < 1e-10


def test_molecule_set_between_runs_is_in_the_next_force(simulation):
    sim = simulation(five(), f"clumps_only yes {EXACT}", box=BOX, comm="comm_modify cutoff 9").run()
    sim.commands("set atom 4 mol 1").run()
    spheres = five()
    spheres.molecule[3] = 1
    assert largest_difference(sim.drag, model.forces(spheres, ETA, sees=model.same_clump(spheres))) < 1e-10


def test_group_changed_between_runs_is_in_the_next_force(simulation):
    """As many spheres as before, but others."""
    sim = simulation(five(), f"cut_off_distance inf {EXACT} group some", box=BOX,
                     before_pair="group some id 1 2 3").run()
    sim.commands("group some clear\ngroup some id 1 2 4").run()
    part = [0, 1, 3]
    spheres = five()
    assert largest_difference(sim.drag[part], model.forces(Spheres(spheres.x[part], spheres.a[part], spheres.v[part]),
                                                           ETA)) < 1e-10
    assert np.abs(sim.drag[[2, 4]]).max() == 0.0


def test_box_that_becomes_larger_between_runs_is_in_the_next_force(simulation):
    """Images move away although no sphere does."""
    L = 6.0
    sim = simulation(Spheres([(0.1, 0.2, 0.3)], A, (0, 0, 0.3)), f"cut_off_distance 6.5 {EXACT}", boundary="p p p",
                     box=[(-L / 2, L / 2)] * 3).run()
    with_images = sim.drag
    sim.commands("change_box all x final -9 9 y final -9 9 z final -9 9").run()
    assert largest_difference(sim.drag, [(0, 0, -6 * np.pi * ETA * A * 0.3)]) < 1e-12
    assert largest_difference(with_images, sim.drag) > 0.1


@pytest.mark.parametrize("mode", MODES)
def test_new_settings_between_runs_are_in_the_next_force(simulation, mode):
    sim = simulation(five(), f"clumps_only yes {EXACT} update_every 10", box=BOX, comm="comm_modify cutoff 9").run(3)
    sim.commands([f"pair_style stokes_dynamics {MODES[mode]} visc 2.6 algorithm 2 relative_tolerance 1e-12 "
                  "update_every 10",
                  "pair_coeff * *"]).run()
    assert largest_difference(sim.drag, expected_now(sim, 2.6)) < 1e-10


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("n", [1, 10])
def test_created_atoms_take_part_at_once(simulation, mode, n):
    sim = simulation(five(), f"{MODES[mode]} {EXACT} update_every {n}", box=BOX).run(3)
    sim.commands("create_atoms 1 single 0.3 -1.7 1.1\nset atom 6 diameter 1.3\nset atom 6 vx 0.2 vy 0.1 vz -0.4").run()
    assert sim.n == 6
    assert largest_difference(sim.drag, expected_now(sim)) < 1e-10


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("n", [1, 10])
def test_deleted_atoms_are_gone_at_once(simulation, mode, n):
    sim = simulation(five(), f"{MODES[mode]} {EXACT} update_every {n}", box=BOX, before_pair="group gone id 2").run(3)
    sim.commands("delete_atoms group gone").run()
    assert sim.n == 4
    assert largest_difference(sim.drag, expected_now(sim)) < 1e-10


def frames(path):
    """Frames of a dump whose number of atoms changes: [(step, ids, rows)]."""
    return [(step, rows[:, 0].astype(int), rows[:, 1:]) for step, rows in read_dump(path)]


@pytest.mark.hard_case("spheres that evaporate in a run")
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("n", [1, 10])
@pytest.mark.parametrize("ranks", [1, 2])
def test_spheres_that_evaporate_within_a_run_are_gone_at_once(tmp_path, mode, n, ranks):
    rng = np.random.default_rng(2)
    spheres = Spheres(rng.uniform(-4, 4, (12, 3)), rng.uniform(0.4, 0.8, 12), (0.2, 0.1, -0.3))
    lines = input_lines(spheres, f"{MODES[mode]} {EXACT} update_every {n}", tmp_path / "data", box=BOX)
    lines += ["region box block INF INF INF INF INF INF", "fix gone all evaporate 3 1 box 4711"]
    lines += dump_lines(tmp_path / "dump", columns="id x y z f_drag[1] f_drag[2] f_drag[3]") + ["run 12"]
    lmp(tmp_path, lines, ranks=ranks)
    sizes = set()
    for step, ids, rows in frames(tmp_path / "dump"):
        sizes.add(len(ids))
        left = Spheres(spheres.x[ids - 1], spheres.a[ids - 1], spheres.v[ids - 1])
        assert largest_difference(rows[:, 3:6], model.forces(left, ETA)) < 1e-10, step
    assert len(sizes) >= 4


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("ranks", [1, 2])
def test_spheres_that_are_deposited_within_a_run_take_part_at_once(tmp_path, mode, ranks):
    """Nothing moves but what is deposited."""
    lines = input_lines(five(), f"{MODES[mode]} {EXACT} update_every 10", tmp_path / "data", box=BOX)
    lines += ["region top block -6 6 -6 6 4 8",
              "fix rain all deposit 4 1 3 4711 region top near 1.0 vz -0.5 -0.5 id next",
              "neigh_modify every 1 delay 0"]
    lines += dump_lines(tmp_path / "dump", columns="id x y z vx vy vz radius f_drag[1] f_drag[2] f_drag[3]") + [
        "run 15"]
    lmp(tmp_path, lines, ranks=ranks)
    sizes = set()
    for step, ids, rows in frames(tmp_path / "dump"):
        sizes.add(len(ids))
        assert largest_difference(rows[:, 7:10], model.forces(Spheres(rows[:, 0:3], rows[:, 6], rows[:, 3:6]),
                                                              ETA)) < 1e-9, step
    assert sizes >= {5, 7, 9}


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("n", [1, 4])
def test_rerun_of_a_dump_gives_the_forces_of_its_frames(simulation, mode, n):
    sim = simulation(five(), f"{MODES[mode]} {EXACT} update_every {n}", box=BOX,
                     dt=0.02).commands("fix move all nve/sphere")
    sim.commands(dump_lines(sim.folder / "dump", every=3)).run(12).commands("undump out\nunfix move")
    sim.commands(dump_lines(sim.folder / "again", every=3))
    sim.command(f"rerun {sim.folder}/dump dump x y z vx vy vz")
    radii = sim.atom("radius").ravel()
    sim.close()
    for (step, before), (step_again, again) in zip(read_dump(sim.folder / "dump"), read_dump(sim.folder / "again")):
        assert step == step_again and largest_difference(again[:, 0:6], before[:, 0:6]) < 1e-12
        if n == 1:
            # positions and velocities of the end of the step, which the dump holds
            assert largest_difference(again[:, 6:9], model.forces(Spheres(before[:, 0:3], radii, before[:, 3:6]),
                                                                  ETA)) < 1e-9, step
        assert np.isfinite(again).all()


def test_rerun_in_a_new_instance_gives_the_forces_of_its_frames(simulation):
    first = simulation(five(), f"cut_off_distance inf {EXACT} update_every 4", box=BOX,
                       dt=0.02).commands("fix move all nve/sphere")
    first.commands(dump_lines(first.folder / "dump", every=3)).run(12)
    radii = first.atom("radius").ravel()
    sim = simulation(five(), f"cut_off_distance inf {EXACT}", box=BOX)
    sim.commands(dump_lines(sim.folder / "again", every=3)).command(f"rerun {sim.folder}/dump dump x y z vx vy vz")
    sim.close()
    for (_, before), (step, again) in zip(read_dump(sim.folder / "dump"), read_dump(sim.folder / "again")):
        assert largest_difference(again[:, 6:9], model.forces(Spheres(before[:, 0:3], radii, before[:, 3:6]),
                                                              ETA)) < 1e-9, step


@pytest.mark.loader
def test_clear_and_load_again(simulation):
    sim = simulation()
    drags = []
    for _ in range(3):
        sim.commands(input_lines(five(), f"cut_off_distance inf {EXACT}", sim.folder / "data", box=BOX)).run()
        drags.append(sim.drag)
        sim.command("clear")
    assert np.array_equal(drags[0], drags[1]) and np.array_equal(drags[0], drags[2])


@pytest.mark.loader
def test_many_instances_in_one_process(simulation):
    drags = [simulation(five(), f"cut_off_distance inf {EXACT}", box=BOX).run(2).drag for _ in range(3)]
    assert np.array_equal(drags[0], drags[1]) and np.array_equal(drags[0], drags[2])


def test_pair_style_may_be_exchanged_and_come_back(simulation):
    sim = simulation(five(), f"cut_off_distance inf {EXACT} add_force yes", box=BOX, fix=False).run()
    first = sim.f
    sim.commands("pair_style zero 3.0\npair_coeff * *").run()
    assert np.abs(sim.f).max() == 0.0
    sim.commands([f"pair_style stokes_dynamics cut_off_distance inf {EXACT} add_force yes", "pair_coeff * *"]).run()
    assert largest_difference(sim.f, first) < 1e-14


@pytest.mark.loader
def test_plugin_may_be_unloaded_after_use(simulation):
    sim = simulation(five(), f"cut_off_distance inf {EXACT} add_force yes", box=BOX, fix=False).run()
    sim.commands("plugin unload pair stokes_dynamics\npair_style zero 3.0\npair_coeff * *").run()
    assert np.abs(sim.f).max() == 0.0


@pytest.mark.parametrize("min_style", ["cg", "fire"])
def test_minimisation_is_refused(simulation, min_style):
    sim = simulation(five(), f"cut_off_distance inf {EXACT}", box=BOX)
    with pytest.raises(LammpsError, match="stokes_dynamics cannot be minimised: a drag depends on velocities"):
        sim.commands(f"min_style {min_style}\nminimize 1e-4 1e-6 10 10")
    sim.commands("run 0")                                # and LAMMPS is not broken by that
    assert largest_difference(sim.drag, expected_now(sim)) < 1e-10


def test_respa_is_refused(simulation):
    sim = simulation(five(), f"cut_off_distance inf {EXACT}",
                     box=BOX).commands("fix move all nve/sphere\nrun_style respa 2 2")
    with pytest.raises(LammpsError, match="does not support run_style respa"):
        sim.run()


def test_one_step_with_500_spheres_on_two_ranks_is_that_of_one(tmp_path):
    """Enough spheres that lists grow, spheres are sorted and move between ranks."""
    rng = np.random.default_rng(9)
    grid = np.array([(i, j, k) for i in range(8) for j in range(8) for k in range(8)], float) * 2.2
    spheres = Spheres(grid + rng.uniform(-0.3, 0.3, grid.shape), rng.uniform(0.5, 1.0, 512), rng.normal(size=(512, 3)),
                      molecule=1 + np.arange(512) // 8)
    ends = []
    for ranks in (1, 2):
        lines = input_lines(spheres, "clumps_only yes visc 1.3 algorithm 2 relative_tolerance 1e-12", tmp_path / "data",
                            boundary="p p p",
                            box=[(-1.0, 16.6 * 2.4)] * 3, comm="comm_modify cutoff 19", dt=0.02,
                            before_pair="atom_modify sort 5 0\nneigh_modify every 1 delay 0")
        lines += ["fix move all nve/sphere"] + dump_lines(tmp_path / f"dump{ranks}", every=30) + ["run 30"]
        lmp(tmp_path, lines, ranks=ranks)
        ends.append(read_dump(tmp_path / f"dump{ranks}")[-1][1])
    assert np.abs(ends[1] - ends[0]).max() < 1e-10 * np.abs(ends[0]).max()
