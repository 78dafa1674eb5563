"""Both algorithms: what they answer, how many iterations they take, and when they refuse."""
import numpy as np
import pytest

import model
from system import LammpsError, Spheres, chain, largest_difference

ETA, A = 1.3, 0.7
STOKES = 6 * np.pi * ETA * A
EXACT = "algorithm 2 relative_tolerance 1e-12 max_iter 2000"
ALONG = (0.0, 0.0, 0.4)
ACROSS = (0.4, 0.0, 0.0)


def touching_chain(n, v, **options):
    return chain(n, 2 * A, a=A, v=v, **options)


def cloud(n=20, seed=3, overlap=1.0):
    """Random spheres of radii 0.4 to 1.2 with random velocities; some of them overlap."""
    rng = np.random.default_rng(seed)
    return Spheres(rng.uniform(-3, 3, (n, 3)) * overlap, rng.uniform(0.4, 1.2, n), rng.normal(size=(n, 3)))


def cube(n, v):
    grid = np.array([(i, j, k) for i in range(n) for j in range(n) for k in range(n)], float)
    return Spheres(2 * A * grid, A, v, molecule=1)


# --- algorithm 1 -----------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("k", [1, 2, 3, 4])
@pytest.mark.parametrize("reach", ["inf", "10"])
def test_substitution_follows_the_analytic_trace(simulation, k, reach):
    sim = simulation(touching_chain(2, ALONG),
                     f"cut_off_distance {reach} visc {ETA} max_iter {k} relative_tolerance 1e-15").run()
    expected = -(1 - (-0.625)**(k + 1)) / 1.625
    assert np.abs(sim.drag[:, 2] / (STOKES * ALONG[2]) - expected).max() < 1e-12
    assert np.abs(sim.drag[:, :2]).max() == 0.0
    assert sim.iterations == k


def test_substitution_is_the_default_and_converges_for_two_spheres(simulation):
    sim = simulation(touching_chain(2, ALONG), f"cut_off_distance inf visc {ETA} relative_tolerance 1e-12").run()
    assert np.abs(sim.drag[:, 2] / (STOKES * ALONG[2]) + 1 / 1.625).max() < 1e-12
    assert sim.residual <= 1e-12 and sim.fix_vector()[6] == 0


def test_default_tolerance_is_one_in_a_thousand(simulation):
    sim = simulation(touching_chain(2, ALONG), f"cut_off_distance inf visc {ETA}").run()
    assert 1e-3 / 1.7 < sim.residual <= 1e-3        # each substitution takes off a factor 0.625


@pytest.mark.parametrize("edge, tolerance, far, words, floats", [
    (8, "1e-3", "auto", "", True), (8, "1e-4", "auto", "", True), (8, "1e-3", "auto", "rotation yes", True),
    (8, "9e-5", "1e-3", "", False), (7, "1e-3", "auto", "", False), (8, "1e-3", "9e-6", "", False),
    (8, "1e-3", "auto", "wall zlo -9", False)])
def test_products_of_loose_solves_are_in_single_precision(simulation, edge, tolerance, far, words, floats):
    """One product: its digits are those of a tight far field, which is in double precision, or those of floats."""
    spheres = cube(edge, np.random.default_rng(1).normal(size=(edge**3, 3)))
    style = f"cut_off_distance inf visc {ETA} max_iter 1 relative_tolerance {tolerance} {words}"
    loose, tight = (simulation(spheres, f"{style} far_field_tolerance {of}").run().drag for of in (far, "1e-9"))
    assert largest_difference(loose, tight) < 2e-6
    assert (loose == tight).all() == (not floats)


@pytest.mark.hard_case("algorithm 1 where it diverges")
def test_substitution_on_three_spheres_along_their_axis_stops_and_names_the_way_out(simulation):
    sim = simulation(touching_chain(3, ALONG), f"cut_off_distance inf visc {ETA} algorithm 1 strict")
    with pytest.raises(LammpsError) as error:
        sim.run()
    for word in ("diverged", "residual", "iteration", "use algorithm 2"):
        assert word in str(error.value)


@pytest.mark.parametrize("words", ["cut_off_distance inf", "cut_off_distance 9", "clumps_only yes",
                                   "cut_off_distance inf rotation yes"])
def test_where_substitution_diverges_gradients_go_on(simulation, tmp_path, words):
    """The default never strands a run: one warning, and from then on every force is that of algorithm 2, in this run
    and the next."""
    spheres, style = touching_chain(3, ALONG), f"{words} visc {ETA} relative_tolerance 1e-11"
    reference = simulation(spheres, style + " algorithm 2").run().drag
    log = tmp_path / "log"
    sim = simulation(spheres, style, log=log).run(2).run(2)
    assert largest_difference(sim.drag, reference) < 1e-9
    assert sim.iterations < 20 and sim.residual <= 1e-11
    said = " ".join(log.read_text().split())
    assert said.count("the run goes on with algorithm 2") == 1 and "step 0: algorithm 1: diverged: residual" in said


@pytest.mark.parametrize("strict", [False, True])
def test_where_substitution_is_too_slow_gradients_go_on(simulation, tmp_path, strict):
    """Four spheres three radii apart, where 100 substitutions leave forces 1.7 times too large."""
    spheres = Spheres([[-3, 0, 0], [0, 0, 0.5], [3, 0.5, 0], [0, 3, 1]], v=(1.0, 0.0, 0.0))
    style = f"cut_off_distance inf rotation yes visc {ETA}"
    reference = simulation(spheres, style + " algorithm 2 relative_tolerance 1e-9").run().drag
    sim = simulation(spheres, style + " algorithm 1 strict" * strict, log=tmp_path / "log").run(2).run(2)
    said = " ".join((tmp_path / "log").read_text().split())
    assert said.count("algorithm 1: too slow: residual") == (not strict)
    off = sim.drag[:, 0].sum() / reference[:, 0].sum()
    assert off > 1.5 if strict else abs(off - 1) < 1e-3


@pytest.mark.parametrize("n,converges", [(4, True), (5, False)])
def test_substitution_across_a_chain_converges_up_to_four(simulation, n, converges):
    reference = simulation(touching_chain(n, ACROSS), f"cut_off_distance inf visc {ETA} {EXACT}").run().drag
    sim = simulation(touching_chain(n, ACROSS),
                     f"cut_off_distance inf visc {ETA} max_iter 2000 relative_tolerance 1e-10 "
                     "algorithm 1 strict")
    if converges:
        assert largest_difference(sim.run().drag, reference) < 1e-8
    else:
        with pytest.raises(LammpsError, match="diverged"):
            sim.run()


@pytest.mark.hard_case("more iterations needed than max_iter")
@pytest.mark.parametrize("words,iterations",
                         [("max_iter 5", 5), ("algorithm 2 precondition none warm_start no max_iter 1", 1)])
def test_running_out_of_iterations_warns_and_is_counted(simulation, tmp_path, words, iterations):
    log = tmp_path / "log"
    sim = simulation(touching_chain(4, ACROSS), f"cut_off_distance inf visc {ETA} relative_tolerance 1e-10 {words}",
                     log=log)
    sim.commands("fix move all nve/sphere\ntimestep 1e-3").run(3)
    assert sim.fix_vector()[6] == sim.solves == 4
    assert sim.residual > 1e-10 and sim.iterations == iterations
    sim.close()
    warnings = [line for line in log.read_text().splitlines() if line.startswith("WARNING") and
                "no convergence within the allowed iterations" in line]
    assert len(warnings) == 1
    for word in ("residual", f"iteration {iterations}", f"max_iter {iterations}", "relative_tolerance"):
        assert word in warnings[0]


# --- algorithm 2 -----------------------------------------------------------------------------------------------------

def test_gradients_take_at_most_14_iterations_for_a_chain_of_100(simulation):
    sim = simulation(touching_chain(100, ACROSS),
                     f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-6")
    sim.commands("compute p all pair stokes_dynamics\nthermo_style custom step c_p[1] c_p[2]").run()
    assert 1 <= sim.iterations <= 14
    assert sim.compute_vector("p", 2)[0] == sim.iterations and sim.residual <= 1e-6


def test_gradients_take_at_most_35_iterations_for_a_cube_of_512(simulation):
    sim = simulation(cube(8, ACROSS), f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-6").run()
    assert 1 <= sim.iterations <= 35 and sim.residual <= 1e-6


@pytest.mark.parametrize("n,along,across", [(2, 1.2307692308, 1.3913043478), (3, 1.4864864865, 1.7788461538),
                                            (10, 2.8644863357, 3.9660679076), (50, 8.6027049165, 13.4436992194)])
def test_drag_of_touching_chains(simulation, n, along, across):
    """Totals of the model in 6 pi eta a U: dense solves, 11 digits."""
    for v, expected in ((ALONG, along), (ACROSS, across)):
        sim = simulation(touching_chain(n, v), f"cut_off_distance inf visc {ETA} {EXACT}").run()
        assert -sim.drag.sum(axis=0) @ v / 0.4**2 / STOKES == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("reach", ["inf", "30"])
def test_random_overlapping_cloud_of_unequal_spheres_against_dense_solve(simulation, reach):
    spheres = cloud()
    sim = simulation(spheres, f"cut_off_distance {reach} visc {ETA} {EXACT}").run()
    assert largest_difference(sim.drag, model.forces(spheres, ETA)) < 1e-9


def test_finite_cut_off_leaves_out_what_is_farther(simulation):
    spheres = chain(6, 2.5 * A, a=A, v=(0.1, 0.2, 0.3))
    R = 5.5 * A
    sees = np.linalg.norm(spheres.x[:, None] - spheres.x[None, :], axis=2) <= R
    sim = simulation(spheres, f"cut_off_distance {R} visc {ETA} {EXACT}").run()
    reference = model.forces(spheres, ETA, sees=sees)
    assert largest_difference(sim.drag, reference) < 1e-10
    assert largest_difference(reference, model.forces(spheres, ETA)) > 1e-3


def test_cut_off_is_a_length_and_not_a_multiple_of_the_radius(simulation):
    x = [(0, 0, 0), (0, 0, 3.0 * A)]
    seen = simulation(Spheres(x, A, ALONG), f"cut_off_distance {3.001 * A} visc {ETA} {EXACT}").run().drag
    unseen = simulation(Spheres(x, A, ALONG), f"cut_off_distance {2.999 * A} visc {ETA} {EXACT}").run().drag
    assert largest_difference(unseen, [(0, 0, -STOKES * ALONG[2])] * 2) < 1e-14
    assert seen[0, 2] / unseen[0, 2] == pytest.approx(1 / (1 + 1.5 / 3 - 1 / 27), rel=1e-12)


@pytest.mark.hard_case("cut-off that makes the matrix indefinite")
def test_indefinite_cut_off_is_an_error_that_names_it(simulation):
    R = 2.5 * A
    sim = simulation(touching_chain(10, ALONG), f"cut_off_distance {R} visc {ETA} algorithm 2")
    with pytest.raises(LammpsError) as error:
        sim.run()
    text = str(error.value)
    for word in ("not positive definite", f"cut_off_distance {R:g}", "use cut_off_distance inf"):
        assert word in text


def test_oseen_agrees_with_its_closed_form_for_two_distant_spheres(simulation):
    s = 5.0
    spheres = Spheres([(0, 0, 0), (0, 0, s * A)], A, ALONG)
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} tensor oseen {EXACT}").run()
    assert np.abs(sim.drag[:, 2] / (STOKES * ALONG[2]) + 1 / (1 + 1.5 / s)).max() < 1e-12


@pytest.mark.parametrize("algorithm", [1, 2])
def test_oseen_at_one_point_is_an_error_that_names_it(simulation, algorithm):
    spheres = Spheres([(0, 0, 0), (0, 0, 3 * A), (0, 0, 3 * A)], A, ALONG)
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} tensor oseen algorithm {algorithm}")
    with pytest.raises(LammpsError, match="tensor oseen.*is inf and must be below 1; use tensor rpy"):
        sim.run()


# --- coincident and hidden spheres ---------------------------------------------------------------------------------

@pytest.mark.hard_case("one sphere hidden in another")
@pytest.mark.parametrize("offset", [0.0, 0.3, 0.69])
def test_hidden_sphere_carries_nothing(simulation, offset):
    spheres = Spheres([(0, 0, 0), (0, 0.6 * offset, 0.8 * offset)], [2 * A, 1.3 * A - 0.69], ALONG)
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} {EXACT}").run()
    assert np.abs(sim.drag[1]).max() < 1e-11 * STOKES
    assert np.abs(sim.drag[0] + 2 * STOKES * np.array(ALONG)).max() < 1e-11 * STOKES


# --- exact statements ----------------------------------------------------------------------------------------------

@pytest.mark.hard_case("single sphere")
@pytest.mark.parametrize("algorithm", [1, 2])
@pytest.mark.parametrize("mode", ["cut_off_distance inf", "cut_off_distance 3", "clumps_only yes"])
def test_lone_sphere_feels_stokes_drag_exactly(simulation, algorithm, mode):
    v, u = np.array((0.3, -0.2, 0.4)), np.array((0.05, 0.1, -0.7))
    sim = simulation(Spheres([(0.1, 0.2, 0.3)], A, v),
                     f"{mode} visc {ETA} algorithm {algorithm} fluid_velocity {u[0]} {u[1]} {u[2]}").run()
    assert np.abs(sim.drag[0] - STOKES * (u - v)).max() < 1e-14 * STOKES
    assert np.abs(sim.perturbation).max() < 1e-15
    assert sim.residual < 1e-15


@pytest.mark.hard_case("u = v everywhere")
@pytest.mark.parametrize("algorithm", [1, 2])
@pytest.mark.parametrize("mode", ["cut_off_distance inf", "cut_off_distance 8"])
def test_spheres_that_move_with_the_fluid_feel_nothing(simulation, algorithm, mode):
    u = (0.3, -0.2, 0.4)
    sim = simulation(cloud(), f"{mode} visc {ETA} algorithm {algorithm} fluid_velocity {u[0]} {u[1]} {u[2]}")
    sim.raw("v")[:] = u
    sim.run()
    assert np.abs(sim.drag).max() == 0.0
    assert sim.iterations == 0 and sim.residual == 0.0 and sim.fix_scalar() == 0.0


def test_dissipation_is_positive_and_the_work_of_the_drag(simulation):
    for seed in range(5):
        spheres = cloud(seed=seed)
        sim = simulation(spheres, f"cut_off_distance inf visc {ETA} {EXACT}").run()
        assert sim.fix_scalar() > 0.0
        assert sim.fix_scalar() == pytest.approx(-(sim.drag * spheres.v).sum(), rel=1e-12)


@pytest.mark.parametrize("mode", ["cut_off_distance inf", "cut_off_distance 40", "clumps_only yes"])
def test_reciprocity(simulation, mode):
    """The resistance matrix is symmetric: F of one velocity field times another is the same the other way round."""
    spheres = cloud(16)
    spheres.molecule[:] = 1 + np.arange(16) % 3
    rng = np.random.default_rng(8)
    v = rng.normal(size=(2, 16, 3))
    F = []
    for field in v:
        spheres.v = field
        F.append(simulation(spheres, f"{mode} visc {ETA} {EXACT}", comm="comm_modify cutoff 30").run().drag)
    one, other = (F[0] * v[1]).sum(), (F[1] * v[0]).sum()
    assert one == pytest.approx(other, abs=1e-9 * np.linalg.norm(F[0]) * np.linalg.norm(v[1]))


def test_answer_is_linear_in_velocity_and_viscosity(simulation):
    spheres = cloud()
    first = simulation(spheres, f"cut_off_distance inf visc {ETA} {EXACT}").run().drag
    spheres.v = 3.5 * spheres.v
    second = simulation(spheres, f"cut_off_distance inf visc {2 * ETA} {EXACT}").run().drag
    assert largest_difference(second, 7.0 * first) < 1e-9


def test_answer_turns_with_the_scene(simulation):
    spheres = cloud()
    first = simulation(spheres, f"cut_off_distance inf visc {ETA} {EXACT}").run().drag
    Q = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))[0]
    turned = Spheres(spheres.x @ Q.T, spheres.a, spheres.v @ Q.T)
    assert largest_difference(simulation(turned, f"cut_off_distance inf visc {ETA} {EXACT}").run().drag,
                              first @ Q.T) < 1e-9


def test_units_do_not_matter(simulation):
    """The same scene in metres: radii of a micron, viscosity of water."""
    L, eta, T = 1e-6, 1e-3, 1e-2
    spheres = cloud()
    first = simulation(spheres, f"cut_off_distance inf visc {ETA} {EXACT}").run().drag
    small = Spheres(spheres.x * L, spheres.a * L, spheres.v * L / T)
    sim = simulation(small, f"cut_off_distance {30 * L} visc {eta} {EXACT}", units="si",
                     before_pair=f"neighbor {0.1 * L} bin", density=1000.0).run()
    assert largest_difference(sim.drag, first * (eta / ETA) * L * L / T) < 1e-9
