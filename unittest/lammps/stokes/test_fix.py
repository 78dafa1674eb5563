"""fix stokes_dynamics and compute pair: what they report, and who adds the force."""
import numpy as np
import pytest

import model
from system import LammpsError, Spheres, dump_lines, input_lines, largest_difference, lmp, read_dump

ETA, A = 1.3, 0.7
EXACT = f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-12"
U = np.array((0.25, -0.4, 0.15))


def five():
    x = [(0, 0, 0), (1.5, 0.2, 0), (0, 1.7, 0.4), (2.6, 1.9, -0.7), (-1.2, 0.3, 1.8)]
    return Spheres(x, (A, 0.8 * A, A, 1.3 * A, 0.5 * A), np.random.default_rng(4).normal(size=(5, 3)))


def six_pi_eta_a(spheres):
    return 6 * np.pi * ETA * spheres.a[:, None]


def pressure_and_energy(sim):
    sim.commands("thermo_style custom step pe pxx pyy pzz pxy").run()
    return [sim.lmp.get_thermo(name) for name in ("pe", "pxx", "pyy", "pzz", "pxy")]


def test_columns_are_force_perturbation_and_no_torque(simulation):
    spheres = five()
    sim = simulation(spheres, f"{EXACT} fluid_velocity {U[0]} {U[1]} {U[2]}").run()
    rows, F = sim.fix_rows(), model.forces(spheres, ETA, U)
    assert rows.shape == (5, 9)
    assert largest_difference(rows[:, 0:3], F) < 1e-10
    assert np.abs(rows[:, 3:6] - (F / six_pi_eta_a(spheres) - U + spheres.v)).max() < 1e-10
    assert np.abs(rows[:, 6:9]).max() == 0.0


def test_perturbation_is_the_velocity_that_the_other_spheres_add(simulation):
    """v' = - sum over the others of Omega F."""
    spheres = five()
    sim = simulation(spheres, EXACT).run()
    M = model.mobility(spheres.x, spheres.a, ETA)
    others = -(M @ sim.drag.ravel()).reshape(-1, 3) + sim.drag / six_pi_eta_a(spheres)
    assert np.abs(sim.perturbation - others).max() < 1e-10


def test_scalar_is_the_dissipation_rate(simulation):
    spheres = five()
    sim = simulation(spheres, f"{EXACT} fluid_velocity {U[0]} {U[1]} {U[2]}").run()
    expected = -(model.forces(spheres, ETA, U) * (spheres.v - U)).sum()
    assert expected > 0.0 and sim.fix_scalar() == pytest.approx(expected, rel=1e-10)


def test_vector_is_total_force_and_the_solver_s_numbers(simulation):
    spheres = five()
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-9 precondition none")
    sim.commands("fix move all nve/sphere\ntimestep 1e-4").run(3)
    vector = sim.fix_vector()
    assert vector[0:3] == pytest.approx(sim.drag.sum(axis=0), rel=1e-12)
    assert 5 <= vector[3] <= 15 and vector[3] == int(vector[3])
    assert 0.0 < vector[4] <= 1e-9
    assert list(vector[5:7]) == [4, 0]                   # setup and three steps


def test_residual_is_that_of_the_force_returned(simulation):
    spheres = five()
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-3").run()
    D = six_pi_eta_a(spheres)
    r = D * (-spheres.v - (model.mobility(spheres.x, spheres.a, ETA) @ sim.drag.ravel()).reshape(-1, 3))
    # products of floats
    assert sim.residual == pytest.approx(np.linalg.norm(r) / np.linalg.norm(D * spheres.v), abs=1e-7)


def test_fix_of_a_subset_reports_that_subset(simulation):
    spheres = five()
    sim = simulation(spheres, EXACT,
                     before_pair="group some id 2 4").commands("fix part some stokes_dynamics apply no").run()
    F, rows = model.forces(spheres, ETA), sim.fix_rows("part")
    assert largest_difference(rows[[1, 3], 0:3], F[[1, 3]]) < 1e-10
    assert np.abs(rows[[0, 2, 4]]).max() == 0.0
    assert sim.fix_vector("part")[0:3] == pytest.approx(F[[1, 3]].sum(axis=0), rel=1e-9)
    assert sim.fix_scalar("part") == pytest.approx(-(F * spheres.v)[[1, 3]].sum(), rel=1e-9)
    assert largest_difference(sim.drag, F) < 1e-10       # the other fix, of all


def test_fix_of_a_subset_applies_to_that_subset(simulation):
    spheres = five()
    sim = simulation(spheres, EXACT, fix=False,
                     before_pair="group some id 2 4").commands("fix part some stokes_dynamics").run()
    F = model.forces(spheres, ETA)
    assert largest_difference(sim.f[[1, 3]], F[[1, 3]]) < 1e-10
    assert np.abs(sim.f[[0, 2, 4]]).max() == 0.0


WHO_ADDS = [("no", "", True), ("no", "apply yes", True), ("no", "apply no", False), ("yes", "", True),
            ("yes", "apply no", True)]


@pytest.mark.parametrize("add_force,apply,added", WHO_ADDS)
def test_force_is_added_once_or_not_at_all_and_reported_always(simulation, add_force, apply, added):
    spheres = five()
    sim = simulation(spheres, f"{EXACT} add_force {add_force}",
                     fix=False).commands(f"fix drag all stokes_dynamics {apply}").run()
    F = model.forces(spheres, ETA)
    assert largest_difference(sim.f, F) < 1e-10 if added else np.abs(sim.f).max() == 0.0
    assert largest_difference(sim.drag, F) < 1e-10


def test_add_force_yes_needs_no_fix(simulation):
    spheres = five()
    sim = simulation(spheres, f"{EXACT} add_force yes", fix=False).run()
    assert largest_difference(sim.f, model.forces(spheres, ETA)) < 1e-10


def test_add_force_no_without_a_fix_adds_nothing(simulation):
    sim = simulation(five(), EXACT, fix=False).run()
    assert np.abs(sim.f).max() == 0.0


def warnings_of_nobody(simulation, tmp_path, style, fix):
    log = tmp_path / "log"
    sim = simulation(five(), style, fix=False, log=log)
    sim.commands(fix).run(1).run(1)
    sim.close()
    return log.read_text().count("nothing applies the force")


@pytest.mark.parametrize("fix", ["", "fix drag all stokes_dynamics apply no"])
def test_nobody_applies_is_said_once(simulation, tmp_path, fix):
    assert warnings_of_nobody(simulation, tmp_path, EXACT, fix) == 1


@pytest.mark.parametrize("style,fix", [(EXACT, "fix drag all stokes_dynamics"), (EXACT + " add_force yes", "")])
def test_nothing_is_said_when_somebody_applies(simulation, tmp_path, style, fix):
    assert warnings_of_nobody(simulation, tmp_path, style, fix) == 0


@pytest.mark.parametrize("words, fixes, told", [
    ("", "fix drag some stokes_dynamics\nfix move all nve/sphere", True),
    ("", "fix drag some stokes_dynamics\nfix move some nve/sphere", False),
    ("", "fix drag some stokes_dynamics\nfix move all nve/sphere\nfix hold others setforce 0 0 0", False),
    ("", "fix drag all stokes_dynamics\nfix move all nve/sphere", False),
    ("group some", "fix drag some stokes_dynamics\nfix move all nve/sphere", False)])
def test_spheres_that_move_without_their_force_are_told_once(simulation, tmp_path, words, fixes, told):
    log = tmp_path / "log"
    sim = simulation(five(), f"{EXACT} {words}", fix=False, log=log,
                     before_pair="group some id 1 3\ngroup others subtract all some")
    sim.commands(fixes).run(1).run(1).close()
    assert log.read_text().count("atom 2 takes part and is moved, but no fix stokes_dynamics applies its") == told


def test_fix_before_or_after_others_does_not_matter(simulation):
    spheres = five()
    sim = simulation(spheres, EXACT).commands("fix pull all addforce 1 2 3").run()
    assert largest_difference(sim.f, model.forces(spheres, ETA) + (1, 2, 3)) < 1e-10


def test_drag_has_neither_energy_nor_virial(simulation):
    spheres = five()
    without = simulation(spheres, ["pair_style zero 3.0", "pair_coeff * *"], fix=False)
    bare = pressure_and_energy(without)
    sim = simulation(spheres, f"{EXACT} add_force yes")
    values = pressure_and_energy(sim)
    assert values == pytest.approx(bare, rel=1e-13) and values[0] == 0.0
    assert np.abs(sim.f).max() > 0.0


def test_compute_pair_reports_iterations_residual_unconverged_and_dissipation(simulation):
    spheres = five()
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-14 max_iter 3 "
                              "precondition none")
    sim.commands("compute p all pair stokes_dynamics\nthermo_style custom step c_p c_p[1]")
    sim.commands("fix move all nve/sphere\ntimestep 1e-4").run(2)
    vector = sim.compute_vector("p", 4)
    assert list(vector[[0, 2]]) == [3, 3]
    assert vector[1] == sim.residual > 1e-14
    assert vector[3] == pytest.approx(sim.fix_scalar(), rel=1e-12) and vector[3] > 0.0


def test_reports_do_not_depend_on_ranks(tmp_path):
    lines = input_lines(five(), f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-3",
                        tmp_path / "data")
    lines += ["compute p all pair stokes_dynamics",
              "thermo_style custom step c_p[1] c_p[2] c_p[3] c_p[4] f_drag " +
              " ".join(f"f_drag[{k}]" for k in range(1, 8)),
              'thermo_modify format float "%.15g" norm no', "run 0"]
    rows = []
    for ranks in (1, 2):
        log = lmp(tmp_path, lines, ranks=ranks).log.splitlines()
        rows.append([float(w) for w in log[[i for i, l in enumerate(log) if l.split()[:1] == ["Step"]][0] + 1].split()])
    assert rows[1] == pytest.approx(rows[0], rel=1e-10)


def test_values_reach_variables_dumps_and_averages(simulation):
    spheres = five()
    sim = simulation(spheres, EXACT).commands(["compute total all reduce sum f_drag[1] f_drag[2] f_drag[3]",
                                               "variable power equal f_drag",
                                               "fix mean all ave/time 1 2 2 f_drag f_drag[4]",
                                               "fix each all ave/atom 1 2 2 f_drag[1]",
                                               "thermo_style custom step c_total[1] v_power"]).run(2)
    assert sim.compute_vector("total", 3) == pytest.approx(sim.drag.sum(axis=0), rel=1e-12)
    assert sim.lmp.extract_variable("power") == sim.fix_scalar()


def test_fix_without_the_pair_style_is_an_error(simulation):
    sim = simulation(five(), ["pair_style zero 3.0", "pair_coeff * *"])
    with pytest.raises(LammpsError, match="Fix stokes_dynamics: there is no pair_style stokes_dynamics"):
        sim.run()


def test_rows_of_many_fixes_migrate(tmp_path):
    """Four thousand numbers with each atom, more than LAMMPS's buffers hold unannounced: what comes to the other rank
    is what left."""
    spheres = Spheres([(-3, 0, 0), (-1, 0, 0), (-0.5, 3, 0), (2, 0, 3)], v=(5.0, 0.1, 0.0))
    ends = []
    for ranks in (1, 2):
        lines = input_lines(spheres, "cut_off_distance inf visc 1", str(tmp_path / "data"), fix=False,
                            box=[(-20.0, 20.0)] * 3, dt=0.01, before_pair="neighbor 0.1 bin\nneigh_modify delay 0")
        lines = ["processors * 1 1"] + lines
        lines += [f"fix report{k} all stokes_dynamics apply no" for k in range(400)] + ["fix drag all stokes_dynamics",
                                                                                        "fix move all nve"]
        lmp(tmp_path, lines + dump_lines(tmp_path / "end", every=40,
                                         columns="x y z f_report0[1] f_report99[1] f_report399[3]") + ["run 40"], ranks)
        ends.append(read_dump(tmp_path / "end")[-1][1])
    assert (ends[0][:, 0] > 0).sum() > (spheres.x[:, 0] > 0).sum()
    assert np.abs(ends[1] - ends[0]).max() < 1e-12


def two_dumbbells():
    return Spheres([(0, 0, 0), (2, 0, 0), (8, 0, 0), (8, 2, 0)], 0.9, (0.3, 0.1, -0.4), molecule=[1, 1, 2, 2])


RIGID = ["fix bodies some rigid molecule", "fix bodies some rigid/small molecule", "fix bodies some rigid/nve single"]


@pytest.mark.parametrize("rigid", RIGID)
def test_fix_that_reads_forces_before_the_drag_is_there_is_an_error(simulation, rigid):
    """It would begin every run with a kick without drag, and a run in two pieces would not be that in one."""
    style = "cut_off_distance inf visc 1.3 algorithm 2"
    sim = simulation(two_dumbbells(), style,
                     fix=False).commands(["group some id 1 2", rigid, "fix drag all stokes_dynamics"])
    with pytest.raises(LammpsError, match="stands before this fix in the input.*define fix drag first"):
        sim.run()
    sim.commands(["unfix drag", "fix drag all stokes_dynamics apply no"]).run(1)
    sim.commands(["unfix drag", "group others id 3 4", "fix drag others stokes_dynamics"]).run(1)
    sim.commands(["unfix drag", "unfix bodies", "fix drag all stokes_dynamics", rigid]).run(1)


# --- commands that ask the pair style for forces once more ------------------------------------------------------------


@pytest.mark.parametrize("add_force", ["yes", "no"])
def test_fix_numdiff_changes_nothing(simulation, add_force):
    """It computes the pair style for displaced atoms in every step; energies have nothing of a drag, and the forces of
    the step stay."""
    style = f"cut_off_distance inf visc 1.3 algorithm 2 update_every 3 add_force {add_force}"
    ends = []
    for numdiff in ([], ["fix shifted all numdiff 1 0.01", "thermo 1"]):
        sim = simulation(five(), style, dt=0.01).commands(["fix move all nve/sphere", *numdiff]).run(5).run(5)
        ends.append((sim.x, sim.v, sim.f, sim.fix_rows(), sim.fix_vector()))
    assert ends[0][4][5] < 8    # solves
    for one, other in zip(*ends):
        assert np.array_equal(one, other)
