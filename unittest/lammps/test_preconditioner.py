"""Preconditioners, warm start, taper and the time-step guard: they change how an answer is reached and how it is watched. The
first two never change the answer; a taper is another model, and its answer is that of the tapered matrix."""
import re

import numpy as np
import pytest

import model
from system import LammpsError, Spheres, chain, dump_lines, input_lines, largest_difference, lmp, read_dump

ETA, A = 1.3, 0.7
STOKES = 6 * np.pi * ETA * A
EXACT = "algorithm 2 relative_tolerance 1e-12 max_iter 2000"
PAIR = "Pair style stokes_dynamics"
ALONG = (0.0, 0.0, 0.4)


def flocs(count, m, side, seed=1, spread=1.0):
    """Each sphere stuck to one before it at 0.6 to 0.95 of the sum of their radii; flocs at random places of a cube, none
    overlapping another. As cloud_flocs of the core's tests."""
    rng = np.random.default_rng(seed)
    x, a, molecule = np.zeros((0, 3)), np.zeros(0), []
    while len(molecule) < count * m:
        its_a = A * np.exp(rng.uniform(0, np.log(spread), m)) if spread > 1 else np.full(m, A)
        its_x = np.zeros((m, 3))
        its_x[0] = rng.uniform(0, side, 3)
        for i in range(1, m):
            to, e = rng.integers(i), rng.normal(size=3)
            its_x[i] = its_x[to] + rng.uniform(0.6, 0.95) * (its_a[i] + its_a[to]) * e / np.linalg.norm(e)
        if len(x) and (np.linalg.norm(its_x[:, None] - x[None], axis=2) < its_a[:, None] + a[None]).any():
            continue
        x, a = np.vstack([x, its_x]), np.append(a, its_a)
        molecule += [len(molecule) // m + 1] * m
    return Spheres(x, a, rng.normal(size=(len(x), 3)), molecule)


def lattice(n, v=ALONG):
    grid = np.array([(i, j, k) for i in range(n) for j in range(n) for k in range(n)], float)
    return Spheres(2 * A * grid, A, v)


def loose_lattice(n, v=0.0, seed=2):
    """A dense cloud without contacts: volume fraction 0.43."""
    rng = np.random.default_rng(seed)
    spheres = lattice(n)
    spheres.x = 1.07 * spheres.x + rng.uniform(-0.06, 0.06, spheres.x.shape) * A
    spheres.v = v * rng.normal(size=spheres.x.shape)
    return spheres


# --- the answer does not depend on how it is found -------------------------------------------------------------------

MODES = {"all": "cut_off_distance inf", "clumps": "clumps_only yes", "taper": "cut_off_distance 12 taper wendland"}
WAYS = [("all", "clump", "yes", 1), ("all", "sparse", "yes", 1), ("all", "auto", "no", 1), ("all", "none", "yes", 1),
        ("all", "clump", "yes", 2), ("all", "sparse", "no", 2), ("all", "none", "no", 2),
        ("clumps", "clump", "yes", 1), ("clumps", "auto", "no", 1), ("clumps", "clump", "yes", 2), ("clumps", "none", "yes", 2),
        ("taper", "clump", "yes", 1), ("taper", "auto", "yes", 2)]
STEPS = 6


def moving(tmp_path, mode, precondition, warm, ranks, rotation="no", molecules=True):
    """Forces at the last of a few steps of free flocs, whose spheres move against each other: the clumps bend."""
    spheres = flocs(12, 10, 15.0, spread=2.0)
    spheres.v *= 0.3
    words = f"{MODES[mode]} visc {ETA} {EXACT} rotation {rotation} precondition {precondition} warm_start {warm}"
    if not molecules:
        spheres.molecule[:] = 0
    box = [(-20.0, 40.0)] * 3
    lines = input_lines(spheres, words, tmp_path / "data", box=box, comm="comm_modify cutoff 25", dt=0.005)
    lines += ["fix move all nve/sphere"] + dump_lines(tmp_path / "dump", every=STEPS) + [f"run {STEPS}"]
    lmp(tmp_path, lines, ranks=ranks)
    return read_dump(tmp_path / "dump")[-1][1][:, 6:9]


@pytest.fixture(scope="module")
def reference(tmp_path_factory):
    known = {}

    def get(mode, rotation="no"):
        if (mode, rotation) not in known:
            known[mode, rotation] = moving(tmp_path_factory.mktemp("reference"), mode, "none", "no", 1, rotation)
        return known[mode, rotation]

    return get


@pytest.mark.parametrize("mode,precondition,warm,ranks", WAYS)
def test_answer_does_not_depend_on_preconditioner_and_warm_start(tmp_path, reference, mode, precondition, warm, ranks):
    assert largest_difference(moving(tmp_path, mode, precondition, warm, ranks), reference(mode)) < 1e-9


@pytest.mark.parametrize("mode,precondition,ranks", [("all", "clump", 1), ("all", "sparse", 2), ("clumps", "clump", 2)])
def test_nor_does_it_with_rotation(tmp_path, reference, mode, precondition, ranks):
    assert largest_difference(moving(tmp_path, mode, precondition, "yes", ranks, "yes"), reference(mode, "yes")) < 1e-9


@pytest.mark.parametrize("ranks", [1, 2])
def test_nor_when_auto_turns_to_the_sparse_factor(tmp_path, reference, ranks):
    """120 spheres without clumps and far more iterations than a factor costs."""
    assert largest_difference(moving(tmp_path, "all", "auto", "no", ranks, molecules=False), reference("all")) < 1e-9


LISTS = {"clumps": "clumps_only yes", "taper": "cut_off_distance 6 taper wendland"}


def forces_by_list(tmp_path, spheres, words, ranks, precondition, boundary="f f f", box=None):
    """Forces after one solve, and the iterations it took."""
    lines = input_lines(spheres, f"{words} visc {ETA} {EXACT} precondition {precondition}", tmp_path / "data", boundary=boundary,
                        box=box, comm="comm_modify cutoff 9")
    lines += ["thermo_style custom step f_drag[4]"] + dump_lines(tmp_path / "dump") + ["run 0"]
    log = lmp(tmp_path, lines, ranks=ranks).log
    its = re.findall(r"^ +0 +([0-9]+) *$", log, re.M)
    return read_dump(tmp_path / "dump")[-1][1][:, 6:9], int(its[-1])


@pytest.mark.parametrize("mode", LISTS)
def test_blocks_of_clumps_that_ranks_share(tmp_path, mode):
    """clumps_only: every rank has all of its clumps, and the blocks are the inverse. Else it has blocks of the parts that it owns."""
    spheres = flocs(30, 10, 16.0, spread=1.5)
    expected, plain = forces_by_list(tmp_path, spheres, LISTS[mode], 1, "none")
    for ranks in (1, 2, 4):
        drag, its = forces_by_list(tmp_path, spheres, LISTS[mode], ranks, "clump")
        assert largest_difference(drag, expected) < 1e-10
        assert its <= 2 if mode == "clumps" else its < 0.8 * plain


@pytest.mark.parametrize("mode", LISTS)
def test_blocks_of_clumps_across_a_periodic_boundary(tmp_path, mode):
    spheres, box = flocs(20, 10, 16.0), [(0.0, 24.0)] * 3
    expected, its = forces_by_list(tmp_path, spheres, LISTS[mode], 1, "clump", "p p p", [(-8.0, 24.0)] * 3)
    expected, plain = forces_by_list(tmp_path, spheres, LISTS[mode], 1, "none", "p p p", box)
    for shift, ranks in ((0.0, 1), (9.0, 1), (9.0, 2)):
        spheres.x = np.mod(spheres.x + shift, 24.0)
        drag, across = forces_by_list(tmp_path, spheres, LISTS[mode], ranks, "clump", "p p p", box)
        assert largest_difference(drag, expected) < 1e-10
        assert across <= (its + 2 if ranks == 1 or mode == "clumps" else plain)


# --- iterations ------------------------------------------------------------------------------------------------------

def test_touching_lattice_of_1000_with_the_sparse_factor(simulation):
    """Drag of the model: dense factorisation. Without the factor 42 iterations."""
    style = f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-6"
    sim = simulation(lattice(10), f"{style} precondition sparse").run()
    assert 1 <= sim.iterations <= 18 and sim.residual <= 1e-6
    assert -sim.drag[:, 2].sum() / (STOKES * ALONG[2]) == pytest.approx(12.852858, abs=2e-6)


@pytest.mark.parametrize("precondition,most", [("clump", 25), ("auto", 15)])
def test_flocs_with_the_blocks_of_their_clumps_and_with_the_factor_of_all(simulation, precondition, most):
    spheres = flocs(50, 20, 34.7 * A)
    spheres.v[:] = ALONG
    style = f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-6"
    sim = simulation(spheres, f"{style} precondition {precondition}").run()
    assert 1 <= sim.iterations <= most and sim.residual <= 1e-6


def test_auto_is_the_sparse_factor_from_the_first_solve_on(simulation):
    """Velocities without relation to those before, so a warm start is of no use. Without 30 to 60."""
    sim = simulation(lattice(6), f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-9")
    rng, iterations = np.random.default_rng(4), []
    for _ in range(9):
        sim.raw("v")[:] = rng.normal(size=(sim.n, 3))
        iterations.append(sim.run().iterations)
    assert max(iterations) <= 18


def turned(x, rng):
    """About their mean, by a random rotation (QR of random numbers)."""
    Q, R = np.linalg.qr(rng.normal(size=(3, 3)))
    Q *= np.sign(np.diag(R))
    if np.linalg.det(Q) < 0:
        Q[:, 0] *= -1
    return x.mean(axis=0) + (x - x.mean(axis=0)) @ Q.T


@pytest.mark.parametrize("precondition", ["clump", "sparse"])
def test_what_has_moved_too_far_is_made_anew(simulation, precondition):
    """Flocs that turn each their own way: as if the run began there. A cloud that moves as a whole keeps its factor."""
    spheres, rng = flocs(50, 20, 45.0 * A), np.random.default_rng(6)
    spheres.v[:] = ALONG
    words = f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-6 warm_start no precondition {precondition}"
    sim = simulation(spheres, words, box=[(-60.0, 120.0)] * 3).run()
    began = sim.iterations
    for k in range(50):
        spheres.x[20 * k:20 * k + 20] = turned(spheres.x[20 * k:20 * k + 20], rng)
    sim.raw("x")[:] = spheres.x[sim.ids() - 1]
    sim.run()
    iterations, residual, drag = sim.iterations, sim.residual, sim.drag
    sim.raw("x")[:] += (3.0, -2.0, 1.0)
    assert sim.run().iterations == iterations
    anew = simulation(spheres, words, box=[(-60.0, 120.0)] * 3).run()
    assert iterations == anew.iterations and abs(iterations - began) <= 3 and residual <= 1e-6
    assert largest_difference(drag, anew.drag) < 1e-5


def iterations_of_a_fall(simulation, tmp_path, words, steps=60):
    spheres, log = loose_lattice(6, v=0.3), tmp_path / "log"
    spheres.v += (0.0, 0.0, -1.0)
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} algorithm 2 {words}", log=log, box=[(-40.0, 60.0)] * 3,
                     density=20.0, dt=1e-3)
    sim.commands(["fix move all nve/sphere", "fix pull all gravity 1 vector 0 0 -1", "thermo_style custom step f_drag[4]",
                  "thermo 1"]).run(steps)
    sim.close()
    return np.array([int(i) for i in re.findall(r"^ +\d+ +(\d+) *$", log.read_text(), re.M)])[1:]


@pytest.mark.parametrize("rotation", ["no", "yes"])
def test_auto_is_the_factor_with_a_warm_start_too(simulation, tmp_path, rotation):
    """Some ten iterations a step without."""
    none = iterations_of_a_fall(simulation, tmp_path, f"relative_tolerance 1e-6 rotation {rotation} precondition none")
    auto = iterations_of_a_fall(simulation, tmp_path, f"relative_tolerance 1e-6 rotation {rotation}")
    assert none[-20:].mean() > 5
    assert auto[-20:].mean() < 0.4 * none[-20:].mean()


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("mode", LISTS)
def test_auto_is_the_blocks_where_spheres_see_by_list(tmp_path, mode, ranks):
    its, residual = {}, {}
    for precondition in ("none", "clump", "auto"):
        for warm in ("no", "yes"):
            spheres = flocs(30, 10, 16.0, spread=1.5)
            spheres.v *= 0.01
            words = f"{LISTS[mode]} visc {ETA} algorithm 2 relative_tolerance 1e-4 precondition {precondition} warm_start {warm}"
            lines = input_lines(spheres, words, tmp_path / "data", box=[(-20.0, 40.0)] * 3, dt=1e-3, density=1e4,
                                comm="comm_modify cutoff 9")
            lines += ["fix move all nve", "thermo 1", "thermo_style custom step f_drag[4] f_drag[5]", "run 15"]
            log = lmp(tmp_path, lines, ranks=ranks).log
            rows = re.findall(r"^ +[0-9]+ +([0-9]+) +([-+.e0-9]+) *$", log, re.M)
            its[precondition, warm], residual[precondition, warm] = [int(n) for n, _ in rows], [float(r) for _, r in rows]
    assert its["auto", "no"] == its["clump", "no"] and max(its["clump", "no"]) < 0.8 * min(its["none", "no"])
    assert its["auto", "yes"] == its["clump", "yes"] and sum(its["clump", "yes"]) <= sum(its["none", "yes"])
    if mode == "clumps":        # the blocks are the inverse where they were made, and one iteration of theirs leaves rounding
        assert its["clump", "yes"][0] == 1 and residual["clump", "yes"][0] < 1e-12


# --- kept from step to step --------------------------------------------------------------------------------------------

def going(tmp_path, name, mode, precondition, molecules, tolerance, ranks=1, newton="on", cut=False):
    """Positions, velocities and forces after 12 steps in which a cloud is sheared by 0.6, so that what preconditions is made two
    or three times; cut: in a run to step 5 and one from its restart file."""
    spheres, folder = loose_lattice(4), tmp_path / name
    folder.mkdir()
    spheres.x += 2.0
    spheres.v = spheres.x @ np.array([[0.0, 0.5, 0.0], [0.0, 0.0, -0.4], [0.3, 0.0, 0.0]])
    spheres.molecule = molecules * (np.arange(64) // 4 + 1)
    words, boundary, box = MODES.get(mode, MODES["all"]), "f f f", [(-20.0, 40.0)] * 3
    if mode == "periodic":
        boundary, box, words = "p p p", [(0.0, 9.0)] * 3, words + " far_field_tolerance 1e-6"
    words += f" visc {ETA} algorithm 2 relative_tolerance {tolerance} precondition {precondition}"
    lines = input_lines(spheres, words, folder / "data", boundary=boundary, box=box, newton=newton, comm="comm_modify cutoff 8",
                        density=1e3, dt=0.1)
    rest = ["fix move all nve/sphere"]
    end = [f"dump end all custom 1 {folder}/dump id xu yu zu vx vy vz f_drag[1] f_drag[2] f_drag[3]",
           "dump_modify end sort id format float %.17g first no"]
    if cut:
        lmp(folder, lines + rest + ["run 5", f"write_restart {folder}/mid"], ranks=ranks)
        lines = [f"newton {newton}", "plugin load stokesdynplugin.so", f"read_restart {folder}/mid", "comm_modify cutoff 8",
                 "fix drag all stokes_dynamics", "timestep 0.1"]
        lmp(folder, lines + rest + end + ["run 7"], ranks=ranks)
    else:
        lmp(folder, lines + rest + end + ["run 12"], ranks=ranks)
    return read_dump(folder / "dump")[-1][1][:, 1:]


@pytest.mark.parametrize("mode,precondition,molecules,tolerance", [
    ("all", "none", 1, 1e-3), ("all", "sparse", 0, 1e-3), ("all", "clump", 1, 1e-3), ("clumps", "clump", 1, 1e-3),
    ("periodic", "waves", 0, 1e-3),
    # blocks of the parts of clumps that a rank owns are others on other ranks: at a loose tolerance the answer shows them
    ("periodic", "waves", 1, 1e-13), ("taper", "clump", 1, 1e-13)])
def test_ranks_restart_and_newton_leave_the_run_as_it_is(tmp_path, mode, precondition, molecules, tolerance):
    """Also at a tolerance at which the answer shows what preconditioned it, and though it was made some steps before."""
    args = (mode, precondition, molecules, tolerance)
    expected = going(tmp_path, "one", *args)
    scale = np.abs(expected).max(axis=0)
    for name, how in (("four", {"ranks": 4}), ("newton", {"newton": "off", "ranks": 2}), ("cut", {"cut": True, "ranks": 2})):
        assert (np.abs(going(tmp_path, name, *args, **how) - expected) / scale).max() < 1e-10, name


# --- warm start ------------------------------------------------------------------------------------------------------

def test_warm_start_takes_two_iterations_a_step_and_keeps_the_tolerance(simulation, tmp_path):
    spheres = loose_lattice(6, v=0.3)
    spheres.v += (0.0, 0.0, -1.0)
    words = f"cut_off_distance inf visc {ETA} algorithm 2 warm_start"
    taken = {}
    for warm in ("no", "yes"):
        log = tmp_path / f"log.{warm}"
        sim = simulation(spheres, f"{words} {warm}", log=log, box=[(-40.0, 60.0)] * 3, density=20.0, dt=1e-3)
        sim.commands(["fix move all nve/sphere", "fix pull all gravity 1 vector 0 0 -1",
                      "variable its equal f_drag[4]", "variable left equal f_drag[5]",
                      "thermo_style custom step v_its v_left", "thermo 1", "run 200"])
        sim.close()
        rows = [line.split() for line in log.read_text().splitlines()]
        rows = np.array([[float(w) for w in r] for r in rows if len(r) == 3 and r[0].isdigit()])
        assert len(rows) == 201
        assert rows[:, 2].max() <= 1e-3
        taken[warm] = rows[1:, 1].mean()
    assert taken["yes"] <= 2.0 < taken["no"]


@pytest.mark.parametrize("precondition,molecules,tolerance", [("none", 0, 1e-2), ("clump", 1, 1e-2), ("sparse", 0, 1e-2),
                                                             ("auto", 0, 1e-6), ("auto", 0, 1e-3), ("auto", 1, 1e-3)])
def test_warm_start_survives_a_restart(simulation, tmp_path, precondition, molecules, tolerance):
    """At a loose tolerance the answer shows where the solver began and what preconditioned it. The factor is not in the restart
    file, but where it was made: after 40 steps it is worn and not yet made anew."""
    words = f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance {tolerance} precondition {precondition}"
    spheres = flocs(4, 6, 8.0)
    spheres.molecule *= molecules
    rest = ["fix drag all stokes_dynamics", "fix pull all gravity 1.5 vector 0.3 0 -1", "fix move all nve/sphere"]
    begin = input_lines(spheres, words, tmp_path / "data", box=[(-30.0, 40.0)] * 3, fix=False, dt=0.002) + rest
    sim = simulation().commands(begin).run(40)
    sim.command(f"write_restart {tmp_path}/mid")
    sim.run(40)
    expected = np.hstack([sim.x, sim.v, sim.drag])
    sim = simulation().commands(["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/mid", "timestep 0.002"] + rest)
    sim.run(40)
    assert np.abs(np.hstack([sim.x, sim.v, sim.drag]) - expected).max() < 1e-10


# --- taper -----------------------------------------------------------------------------------------------------------

TAPER = {"wendland": lambda q: np.where(q < 1, (1 - q)**4 * (1 + 4 * q), 0.0),
         "spherical": lambda q: np.where(q < 1, 1 - 1.5 * q + 0.5 * q**3, 0.0)}


def factors(x, taper, range_):
    t = TAPER[taper](np.linalg.norm(x[:, None] - x[None], axis=2) / range_)
    np.fill_diagonal(t, 1.0)
    return t


@pytest.mark.parametrize("taper", TAPER)
@pytest.mark.parametrize("mode,R", [("", 4.0), ("", 9.0), ("clumps_only yes", 6.0)])
def test_tapered_forces_against_a_dense_solve(simulation, taper, mode, R):
    spheres = flocs(6, 8, 8.0, spread=2.0)
    M = model.mobility(spheres.x, spheres.a, ETA, sees=model.same_clump(spheres) if mode else None)
    M *= np.kron(factors(spheres.x, taper, R), np.ones((3, 3)))
    expected = np.linalg.solve(M, -spheres.v.ravel()).reshape(-1, 3)
    sim = simulation(spheres, f"cut_off_distance {R} {mode} taper {taper} visc {ETA} {EXACT}", comm="comm_modify cutoff 12").run()
    assert largest_difference(sim.drag, expected) < 1e-9


@pytest.mark.parametrize("taper", TAPER)
def test_tapered_forces_and_torques_against_a_dense_solve(simulation, taper):
    spheres, R = loose_lattice(3, v=1.0), 5.0
    spheres.a *= np.random.default_rng(7).uniform(0.6, 1.0, spheres.n)
    w = np.random.default_rng(8).normal(size=(spheres.n, 3))
    n = spheres.n
    M = model.mobility(spheres.x, spheres.a, ETA, rotation=True) * np.kron(factors(spheres.x, taper, R), np.ones((6, 6)))
    expected = np.linalg.solve(M, -np.hstack([spheres.v, w]).ravel()).reshape(n, 6)
    sim = simulation(spheres, f"cut_off_distance {R} taper {taper} rotation yes visc {ETA} {EXACT}")
    sim.raw("omega")[:] = w[sim.ids() - 1]
    sim.run()
    rows = sim.fix_rows()
    assert largest_difference(rows[:, 0:3], expected[:, :3]) < 1e-9
    assert largest_difference(rows[:, 6:9], expected[:, 3:]) < 1e-9


@pytest.mark.hard_case("cut-off that makes the matrix indefinite, with a taper")
@pytest.mark.parametrize("taper", TAPER)
def test_taper_solves_where_the_plain_cut_off_is_refused(simulation, taper):
    spheres, R = chain(10, 2 * A, a=A, v=ALONG, molecule=0), 2.5 * A
    words = f"cut_off_distance {R} visc {ETA} {EXACT}"
    with pytest.raises(LammpsError, match="not positive definite.*taper"):
        simulation(spheres, words).run()
    sim = simulation(spheres, f"{words} taper {taper}").run()
    assert sim.residual <= 1e-12 and sim.fix_scalar() > 0.0
    M = model.mobility(spheres.x, spheres.a, ETA) * np.kron(factors(spheres.x, taper, R), np.ones((3, 3)))
    assert largest_difference(sim.drag, np.linalg.solve(M, -spheres.v.ravel()).reshape(-1, 3)) < 1e-9


# --- time-step guard -------------------------------------------------------------------------------------------------

def test_limit_of_a_lone_sphere_is_its_relaxation_time_twice(simulation):
    sim = simulation(Spheres([(0, 0, 0)], A, ALONG), f"cut_off_distance inf visc {ETA} {EXACT}").run()
    if sim.iterations:
        mass = sim.raw("rmass").ravel()[0]
        assert sim.fix_vector()[7] == pytest.approx(1.0) and sim.fix_vector()[8] == pytest.approx(2 * mass / STOKES)


def test_limit_is_that_of_the_smallest_eigenvalue(simulation):
    spheres = loose_lattice(4, v=1.0)
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} {EXACT} precondition none").run()
    smallest = np.linalg.eigvalsh(STOKES * model.mobility(spheres.x, spheres.a, ETA))[0]
    mass = 1.7 * 4 / 3 * np.pi * A**3
    assert sim.fix_vector()[7] == pytest.approx(smallest, rel=1e-3)
    assert sim.fix_vector()[8] == pytest.approx(2 * mass * sim.fix_vector()[7] / STOKES, rel=1e-12)


def smallest_eigenvalue(spheres, rotation):
    """Of the mobility scaled to unit diagonal."""
    M = model.mobility(spheres.x, spheres.a, ETA, rotation=rotation)
    root = np.sqrt(np.diag(M))
    return np.linalg.eigvalsh(M / np.outer(root, root))[0]


@pytest.mark.parametrize("what,rotation", [("cloud", "no"), ("cloud", "yes"), ("flocs", "no")])
@pytest.mark.parametrize("precondition", ["none", "clump", "sparse", "auto"])
def test_eigenvalue_is_right_where_the_solves_do_not_show_it(simulation, what, rotation, precondition):
    """Uniform velocity, a loose tolerance, preconditioners: all hide the smallest eigenvalue from the conjugate gradients, whose own
    estimate is then 2 to 30 times too large."""
    spheres = loose_lattice(5) if what == "cloud" else flocs(6, 20, 14.0)
    spheres.a *= np.random.default_rng(7).uniform(0.9, 1.0, spheres.n)
    spheres.v = np.tile(ALONG, (spheres.n, 1))
    spheres.molecule = np.arange(spheres.n) // 5 + 1 if what == "cloud" else spheres.molecule
    words = f"cut_off_distance inf visc {ETA} algorithm 2 rotation {rotation} precondition {precondition}"
    sim = simulation(spheres, words, dt=1e-2).run()
    expected = smallest_eigenvalue(spheres, rotation == "yes")
    assert (1 - 1e-9) * expected < sim.fix_vector()[7] < 1.2 * expected
    relaxation = min(1.7 * 4 / 3 * np.pi * spheres.a**3 / (6 * np.pi * ETA * spheres.a))
    assert sim.fix_vector()[8] == pytest.approx(2 * relaxation * sim.fix_vector()[7], rel=1e-9)


@pytest.mark.parametrize("factor,stable", [(0.95, True), (1.05, False)])
def test_limit_of_the_time_step_counts_spins(simulation, factor, stable):
    mass, spin = 1.7 * 4 / 3 * np.pi * A**3, 8 * np.pi * ETA * A**3
    limit = 2 * 0.4 * mass * A**2 / spin
    spheres = Spheres([(0, 0, 0), (200, 0, 0)], A)
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} {EXACT} rotation yes", dt=factor * limit, box=[(-300, 300)] * 3)
    sim.raw("omega")[:] = ALONG
    sim.commands(["fix move all nve/sphere"]).run(200)
    assert sim.fix_vector()[8] == pytest.approx(limit, rel=1e-2)
    assert (np.abs(sim.raw("omega")).max() < 0.4) == stable


def row_of_twelve():
    return chain(12, 1.2 * A, a=A, molecule=0)


def unequal_lattice(n=4):
    spheres = lattice(n, v=0.0)
    spheres.a *= np.random.default_rng(3).uniform(0.4, 1.0, spheres.n)
    return spheres


@pytest.mark.parametrize("rotation", ["no", "yes"])
@pytest.mark.parametrize("make,precondition", [(lambda: lattice(5), "none"), (row_of_twelve, "none"), (lambda: lattice(6), "sparse"),
                                               (unequal_lattice, "none")], ids=["lattice", "overlapping", "sparse", "unequal"])
def test_growth_starts_within_a_fifth_of_the_printed_limit(simulation, make, precondition, rotation):
    """Spheres with a breath of velocity and spin, and nothing but drag: below the limit every motion dies, above it one grows.
    Translation and spin of close spheres die together, so the limit is not that of the fastest spin times that of the mobility."""
    spheres, rng = make(), np.random.default_rng(5)
    spheres.v = 1e-15 * rng.normal(size=spheres.x.shape)
    spins = 1e-15 / A * rng.normal(size=spheres.x.shape)
    words = (f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-6 max_iter 500 rotation {rotation} "
             f"precondition {precondition}")
    limit, growth = 1e-2, {}
    for factor in (1.0, 1 / 1.2, 1.2):
        sim = simulation(spheres, words, dt=factor * limit)
        sim.raw("omega")[:] = spins
        sim.commands(["fix move all nve/sphere", "thermo_modify lost ignore"])
        if factor == 1.0:
            limit = sim.run(0).fix_vector()[8]
            continue
        largest = []
        for _ in range(2):
            sim.run(40)
            largest.append(max(np.abs(sim.raw("v")).max(), A * np.abs(sim.raw("omega")).max() * (rotation == "yes")))
        growth[factor] = largest[1] / largest[0]
    assert growth[1 / 1.2] < 1.0 < growth[1.2]


@pytest.mark.hard_case("time step above the limit")
@pytest.mark.parametrize("precondition", ["none", "sparse"])
def test_dense_free_cloud_is_stable_below_the_printed_limit_and_not_above(simulation, tmp_path, precondition):
    """No force but drag: the kinetic energy can only fall. Slow spheres, so that a run that blows up stays in its box."""
    spheres = loose_lattice(5, v=1e-7)
    words = f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-6 precondition {precondition}"
    energy, warnings, limit = {}, {}, 1e-3
    for factor in (0.0, 0.5, 2.0):
        log = tmp_path / f"log.{factor}"
        sim = simulation(spheres, words, log=log, dt=1e-9 if factor == 0.0 else factor * limit)
        sim.commands(["fix move all nve/sphere", "compute energy all ke", "thermo_style custom step c_energy",
                      "thermo_modify format float %.15g lost ignore", "thermo 1"]).run(15 if factor else 0)
        if factor == 0.0:
            limit = sim.fix_vector()[8]
        sim.close()
        text = log.read_text()
        energy[factor] = np.array([float(e) for e in re.findall(r"^ +\d+ +([-+.0-9e]+) *$", text, re.M)])
        warnings[factor] = [line for line in text.splitlines() if "WARNING" in line and "time step" in line]
    assert limit > 0.0
    assert len(energy[0.5]) == len(energy[2.0]) == 16
    assert (np.diff(energy[0.5]) < 0.0).all()
    assert energy[2.0].max() > 1e6 * energy[2.0][0]
    assert warnings[0.5] == [] and len(warnings[2.0]) == 1
    for word in (PAIR, "time step", "above", "2 m lambda/(6 pi eta a)", "lambda"):
        assert word in warnings[2.0][0]


# --- bad input -------------------------------------------------------------------------------------------------------

REFUSED = [
    ("cut_off_distance inf taper wendland", ["keyword taper requires a cut_off_distance"]),
    ("clumps_only yes taper spherical", ["keyword taper requires a cut_off_distance"]),
    ("cut_off_distance 5 taper gauss", ["keyword taper: 'gauss' is none of: none, wendland, spherical"]),
    ("cut_off_distance 5 taper", ["keyword taper: value missing"]),
    ("clumps_only yes algorithm 2 precondition sparse", ["keyword precondition: 'sparse' requires cut_off_distance inf"]),
    ("cut_off_distance 5 algorithm 2 precondition sparse", ["keyword precondition: 'sparse' requires cut_off_distance inf"]),
    ("cut_off_distance inf precondition clump", ["keyword precondition: 'clump' requires algorithm 2"]),
    ("cut_off_distance inf precondition sparse algorithm 1", ["keyword precondition: 'sparse' requires algorithm 2"]),
    ("cut_off_distance inf algorithm 2 precondition ilu", ["keyword precondition: 'ilu' is none of: auto, none, clump, sparse"]),
    ("cut_off_distance inf algorithm 2 precondition", ["keyword precondition: value missing"]),
    ("cut_off_distance inf algorithm 2 warm_start maybe", ["keyword warm_start: 'maybe' is none of: no, yes"]),
    ("cut_off_distance inf algorithm 2 warm_start", ["keyword warm_start: value missing"]),
]


@pytest.mark.parametrize("words,expected", REFUSED, ids=[words for words, _ in REFUSED])
def test_refused(simulation, words, expected):
    spheres = Spheres([(-1.5, 0, 0), (0.4, 0.2, 0), (1.9, 0.3, 0.2)], A, ALONG, molecule=1)
    with pytest.raises(LammpsError) as error:
        simulation(spheres, f"visc {ETA} {words}")
    for text in [PAIR] + expected:
        assert text in str(error.value)


def test_blocks_of_clumps_without_molecule_ids_are_refused(simulation):
    sim = simulation().commands(["units lj", "atom_style sphere", "boundary f f f", "atom_modify map array",
                                 "plugin load stokesdynplugin.so", "region box block -9 9 -9 9 -9 9", "create_box 1 box",
                                 "create_atoms 1 single 0 0 0", "create_atoms 1 single 3 0 0", "set type 1 diameter 1.4",
                                 f"pair_style stokes_dynamics cut_off_distance inf visc {ETA} algorithm 2 precondition clump",
                                 "pair_coeff * *", "fix drag all stokes_dynamics"])
    with pytest.raises(LammpsError, match=f"{PAIR}: keyword precondition: 'clump' requires molecule IDs"):
        sim.run()
