"""Keywords fluid_velocity and visc: numbers, equal-style and atom-style variables."""
import numpy as np
import pytest

import model
from system import Spheres, dump_lines, input_lines, largest_difference, lmp, read_dump

ETA, A = 1.3, 0.7
EXACT = "algorithm 2 relative_tolerance 1e-12 max_iter 500"
MODES = {"all": "cut_off_distance inf", "list": "cut_off_distance 30"}
U = np.array((0.25, -0.4, 0.15))


def cloud(n=14, seed=11):
    rng = np.random.default_rng(seed)
    return Spheres(rng.uniform(-3, 3, (n, 3)), rng.uniform(0.4, 1.1, n), rng.normal(size=(n, 3)))


def numbers(u):
    return " ".join(repr(float(c)) for c in u)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("algorithm", [1, 2])
def test_only_the_velocity_relative_to_the_fluid_counts(simulation, mode, algorithm):
    spheres = Spheres([(0, 0, 0), (1.5, 0.6, 0)], (A, 0.5 * A), [(0.3, -0.1, 0.2), (0.1, 0.4, -0.3)])
    style = f"{MODES[mode]} visc {ETA} algorithm {algorithm} relative_tolerance 1e-13"
    moving = simulation(spheres, f"{style} fluid_velocity {numbers(U)}").run().drag
    spheres.v = spheres.v - U
    assert largest_difference(moving, simulation(spheres, style).run().drag) < 1e-12


@pytest.mark.parametrize("mode", MODES)
def test_fluid_velocity_as_numbers(simulation, mode):
    spheres = cloud()
    sim = simulation(spheres, f"{MODES[mode]} visc {ETA} fluid_velocity {numbers(U)} {EXACT}").run()
    assert largest_difference(sim.drag, model.forces(spheres, ETA, U)) < 1e-10


def test_shear_flow_as_atom_style_variable(simulation):
    spheres = cloud()
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} fluid_velocity v_shear 0 0.2 {EXACT}",
                     before_pair="variable shear atom 0.6*z-0.1").run()
    u = np.stack([0.6 * spheres.x[:, 2] - 0.1, np.zeros(spheres.n), np.full(spheres.n, 0.2)], axis=1)
    assert largest_difference(sim.drag, model.forces(spheres, ETA, u)) < 1e-10


def test_fluid_velocity_as_equal_style_variable_follows_the_step(simulation):
    spheres = cloud()
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} fluid_velocity v_gust 0 v_lift {EXACT}",
                     before_pair="variable gust equal 0.1*step\nvariable lift equal 0.3")
    sim.commands(dump_lines(sim.folder / "dump")).run(3).close()      # nothing integrates: only the fluid changes
    for step, rows in read_dump(sim.folder / "dump"):
        assert largest_difference(rows[:, 6:], model.forces(spheres, ETA, (0.1 * step, 0, 0.3))) < 1e-10


def test_fluid_velocity_from_per_atom_properties_that_a_cfd_code_writes(simulation):
    spheres = cloud()
    sim = simulation(spheres, f"cut_off_distance inf visc v_eta add_force no fluid_velocity v_ux v_uy v_uz {EXACT}",
                     before_pair="fix cfd all property/atom d_ux d_uy d_uz d_eta\n"
                                 "compute cfd all property/atom d_ux d_uy d_uz d_eta\nvariable ux atom c_cfd[1]\n"
                                 "variable uy atom c_cfd[2]\nvariable uz atom c_cfd[3]\nvariable eta atom c_cfd[4]")
    rng = np.random.default_rng(1)
    for step in range(3):
        order = sim.ids() - 1
        u, eta = rng.normal(size=(spheres.n, 3)), rng.uniform(1, 2, spheres.n)
        for d, name in enumerate(("d_ux", "d_uy", "d_uz")):
            sim.lmp.numpy.extract_atom(name, 2)[:sim.n] = u[order, d]
        sim.lmp.numpy.extract_atom("d_eta", 2)[:sim.n] = eta[order]
        sim.run(1 if step else 0)
        assert largest_difference(sim.drag, model.forces(spheres, eta, u)) < 1e-10


def test_variable_may_use_a_compute(simulation):
    spheres = cloud()
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} fluid_velocity v_u 0 0 {EXACT}",
                     before_pair="compute here all property/atom z\ncompute mean all reduce ave c_here\n"
                                 "variable mean equal c_mean\nvariable u atom c_here-v_mean").run(2)
    u = np.zeros((spheres.n, 3))
    u[:, 0] = spheres.x[:, 2] - spheres.x[:, 2].mean()
    assert largest_difference(sim.drag, model.forces(spheres, ETA, u)) < 1e-10


def test_number_given_as_variables_is_that_number(simulation):
    spheres = cloud()
    style = f"cut_off_distance inf visc {{}} fluid_velocity {{}} {U[1]} {U[2]} {EXACT}"
    plain = simulation(spheres, style.format(ETA, U[0])).run().drag
    for kind in ("equal", "atom"):
        sim = simulation(spheres, style.format("v_eta", "v_u"),
                         before_pair=f"variable eta {kind} {ETA}\nvariable u {kind} {U[0]}").run()
        assert largest_difference(sim.drag, plain) < 1e-13


@pytest.mark.parametrize("mode", MODES)
def test_local_viscosity_scales_each_pair_by_the_geometric_mean(simulation, mode):
    spheres = cloud()
    sim = simulation(spheres, f"{MODES[mode]} visc v_eta {EXACT}", before_pair="variable eta atom 1.1+2.3*(x>0)").run()
    assert largest_difference(sim.drag, model.forces(spheres, 1.1 + 2.3 * (spheres.x[:, 0] > 0))) < 1e-10


@pytest.mark.parametrize("mode", MODES)
def test_local_viscosity_on_two_ranks(tmp_path, mode):
    spheres = cloud()
    lines = input_lines(spheres, f"{MODES[mode]} visc v_eta fluid_velocity v_u 0 0 {EXACT}", tmp_path / "data",
                        before_pair="variable eta atom 1.1+2.3*(x>0)\nvariable u atom 0.3*y")
    lmp(tmp_path, lines + dump_lines(tmp_path / "dump") + ["run 0"], ranks=2)
    u = np.zeros((spheres.n, 3))
    u[:, 0] = 0.3 * spheres.x[:, 1]
    reference = model.forces(spheres, 1.1 + 2.3 * (spheres.x[:, 0] > 0), u)
    assert largest_difference(read_dump(tmp_path / "dump")[0][1][:, 6:], reference) < 1e-10


def test_local_viscosity_leaves_the_resistance_symmetric(simulation):
    spheres = cloud()
    v = np.random.default_rng(2).normal(size=(2, spheres.n, 3))
    F = []
    for field in v:
        spheres.v = field
        F.append(simulation(spheres, f"cut_off_distance inf visc v_eta {EXACT}",
                            before_pair="variable eta atom 1.5+0.3*x").run().drag)
    assert (F[0] * v[1]).sum() == pytest.approx((F[1] * v[0]).sum(),
                                                abs=1e-9 * np.linalg.norm(F[0]) * np.linalg.norm(v[1]))


def test_variables_are_evaluated_for_the_group_only(simulation):
    """Outside the group the viscosity may be anything."""
    spheres = cloud()
    sim = simulation(spheres, f"cut_off_distance inf visc v_eta group some {EXACT}",
                     before_pair="group some id 1:9\nvariable eta atom 1.2*(id<=9)").run()
    part = Spheres(spheres.x[:9], spheres.a[:9], spheres.v[:9])
    assert largest_difference(sim.drag[:9], model.forces(part, 1.2)) < 1e-10
    assert np.abs(sim.drag[9:]).max() == 0.0
