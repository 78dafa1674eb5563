"""Preconditioners change how an answer is reached, never the answer."""
import itertools
import re

import numpy as np
import pytest

from host import allowed, at_most, by_open_mpi
from suspensions import A, ALONG, ETA, EXACT, STOKES, flocs, lattice, loose_lattice
from system import LammpsError, Spheres, dump_lines, input_lines, largest_difference, lmp, lmp_in_turn, read_dump

PAIR = "Pair style stokes_dynamics"
MODES = {"all": "cut_off_distance inf", "clumps": "clumps_only yes", "taper": "cut_off_distance 12 taper wendland"}
WAYS = [("all", "clump", "yes", 1), ("all", "sparse", "yes", 1), ("all", "auto", "no", 1), ("all", "none", "yes", 1),
        ("all", "clump", "yes", 2), ("all", "sparse", "no", 2), ("all", "none", "no", 2),
        ("clumps", "clump", "yes", 1), ("clumps", "auto", "no", 1), ("clumps", "clump", "yes", 2),
        ("clumps", "none", "yes", 2), ("taper", "clump", "yes", 1), ("taper", "auto", "yes", 2)]
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
    return ways_by_list(tmp_path, spheres, words, ranks, [precondition], boundary, box)[0]


def ways_by_list(tmp_path, spheres, words, ranks, preconditions, boundary="f f f", box=None):
    """The same of each way to precondition, all in one start"""
    inputs = []
    for k, way in enumerate(preconditions):
        lines = input_lines(spheres, f"{words} visc {ETA} {EXACT} precondition {way}", tmp_path / "data",
                            boundary=boundary, box=box, comm="comm_modify cutoff 9")
        inputs.append(lines + ["thermo_style custom step f_drag[4]"] + dump_lines(tmp_path / f"dump.{k}") + ["run 0"])
    logs = lmp_in_turn(tmp_path, inputs, ranks)
    return [(read_dump(tmp_path / f"dump.{k}")[-1][1][:, 6:9], int(re.findall(r"^ +0 +([0-9]+) *$", log, re.M)[-1]))
            for k, log in enumerate(logs)]


@pytest.mark.parametrize("mode", LISTS)
def test_blocks_of_clumps_that_ranks_share(tmp_path, mode):
    """clumps_only: every rank has all of its clumps, and the blocks are the inverse. Else it has blocks of the parts
    that it owns."""
    spheres = flocs(30, 10, 16.0, spread=1.5)
    expected, plain = forces_by_list(tmp_path, spheres, LISTS[mode], 1, "none")
    for ranks in allowed(1, 2, 4):
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


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("rotation,few", [("no", 66), ("yes", 33)])
def test_auto_is_the_inverse_of_200_unknowns_and_not_of_more(tmp_path, rotation, few, ranks):
    """One iteration leaves rounding, as no approximation does. Some spheres coincide with others to a hundredth."""
    cloud, rng = loose_lattice(5), np.random.default_rng(8)
    iterations = {}
    for n in (few, few + 1):
        x = np.vstack([cloud.x[:n - 4], cloud.x[:4] + 0.01])
        spheres = Spheres(x, rng.uniform(0.5, 1.0, n) * A, rng.normal(size=(n, 3)))
        words = f"cut_off_distance inf rotation {rotation}"
        (drag, iterations[n]), (expected, plain) = ways_by_list(tmp_path, spheres, words, ranks, ["auto", "none"],
                                                                box=[(-20.0, 40.0)] * 3)
        assert largest_difference(drag, expected) < 1e-9 and plain > 30
    assert iterations[few] <= 2 and 5 < iterations[few + 1] < 30


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
    words = (f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-6 warm_start no precondition "
             f"{precondition}")
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


def iterations_of_a_fall(simulation, tmp_path, words, steps=60, edge=6):
    spheres, log = loose_lattice(edge, v=0.3), tmp_path / "log"
    spheres.v += (0.0, 0.0, -1.0)
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} algorithm 2 {words}", log=log, box=[(-40.0, 60.0)] * 3,
                     density=20.0, dt=1e-3)
    sim.commands(["fix move all nve/sphere", "fix pull all gravity 1 vector 0 0 -1",
                  "thermo_style custom step f_drag[4]", "thermo 1"]).run(steps)
    sim.close()
    return np.array([int(i) for i in re.findall(r"^ +\d+ +(\d+) *$", log.read_text(), re.M)])[1:]


@pytest.mark.parametrize("rotation", ["no", "yes"])
def test_auto_is_the_factor_with_a_warm_start_too(simulation, tmp_path, rotation):
    """Some ten iterations a step without."""
    none = iterations_of_a_fall(simulation, tmp_path, f"relative_tolerance 1e-6 rotation {rotation} precondition none")
    auto = iterations_of_a_fall(simulation, tmp_path, f"relative_tolerance 1e-6 rotation {rotation}")
    assert none[-20:].mean() > 5
    assert auto[-20:].mean() < 0.4 * none[-20:].mean()


def test_auto_is_nothing_for_few_spheres_that_go_on_to_a_loose_tolerance(simulation, tmp_path):
    def means(tolerance):
        return [iterations_of_a_fall(simulation, tmp_path, f"relative_tolerance {tolerance} precondition {way}",
                                     edge=4).mean()
                for way in ("none", "auto")]

    loose, tight = means(1e-3), means(9e-4)
    assert loose[0] == loose[1] < 2 and tight[1] < 0.9 * tight[0]


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("mode", LISTS)
def test_auto_is_the_blocks_where_spheres_see_by_list(tmp_path, mode, ranks):
    ways, inputs, its, residual = list(itertools.product(("none", "clump", "auto"), ("no", "yes"))), [], {}, {}
    spheres = flocs(30, 10, 16.0, spread=1.5)
    spheres.v *= 0.01
    for precondition, warm in ways:
        words = (f"{LISTS[mode]} visc {ETA} algorithm 2 relative_tolerance 1e-4 precondition {precondition} "
                 f"warm_start {warm}")
        lines = input_lines(spheres, words, tmp_path / "data", box=[(-20.0, 40.0)] * 3, dt=1e-3, density=1e4,
                            comm="comm_modify cutoff 9")
        inputs.append(lines + ["fix move all nve", "thermo 1", "thermo_style custom step f_drag[4] f_drag[5]",
                               "run 15"])
    for way, log in zip(ways, lmp_in_turn(tmp_path, inputs, ranks)):
        rows = re.findall(r"^ +[0-9]+ +([0-9]+) +([-+.e0-9]+) *$", log, re.M)
        assert len(rows) == 16
        its[way], residual[way] = [int(n) for n, _ in rows], [float(r) for _, r in rows]
    assert its["auto", "no"] == its["clump", "no"] and max(its["clump", "no"]) < 0.8 * min(its["none", "no"])
    assert its["auto", "yes"] == its["clump", "yes"] and sum(its["clump", "yes"]) <= sum(its["none", "yes"])
    # the blocks are the inverse where they were made, and one iteration of theirs leaves rounding
    if mode == "clumps":
        assert its["clump", "yes"][0] == 1 and residual["clump", "yes"][0] < 1e-12


def going(tmp_path, name, mode, precondition, molecules, tolerance, ranks=1, newton="on", cut=False):
    """Positions, velocities and forces after 12 steps in which a cloud is sheared by 0.6, so that what preconditions is
    made two or three times; cut: in a run to step 5 and one from its restart file."""
    spheres, folder = loose_lattice(4), tmp_path / name
    folder.mkdir()
    spheres.x += 2.0
    spheres.v = spheres.x @ np.array([[0.0, 0.5, 0.0], [0.0, 0.0, -0.4], [0.3, 0.0, 0.0]])
    spheres.molecule = molecules * (np.arange(64) // 4 + 1)
    words, boundary, box = MODES.get(mode, MODES["all"]), "f f f", [(-20.0, 40.0)] * 3
    if mode == "periodic":
        boundary, box, words = "p p p", [(0.0, 9.0)] * 3, words + " far_field_tolerance 1e-6"
    words += f" visc {ETA} algorithm 2 relative_tolerance {tolerance} precondition {precondition}"
    lines = input_lines(spheres, words, folder / "data", boundary=boundary, box=box, newton=newton,
                        comm="comm_modify cutoff 8", density=1e3, dt=0.1)
    rest = ["fix move all nve/sphere"]
    end = [f"dump end all custom 1 {folder}/dump id xu yu zu vx vy vz f_drag[1] f_drag[2] f_drag[3]",
           "dump_modify end sort id format float %.17g first no"]
    if cut:
        lmp(folder, lines + rest + ["run 5", f"write_restart {folder}/mid"], ranks=ranks)
        lines = [f"newton {newton}", "plugin load stokesdynplugin.so", f"read_restart {folder}/mid",
                 "comm_modify cutoff 8", "fix drag all stokes_dynamics", "timestep 0.1"]
        lmp(folder, lines + rest + end + ["run 7"], ranks=ranks)
    else:
        lmp(folder, lines + rest + end + ["run 12"], ranks=ranks)
    return read_dump(folder / "dump")[-1][1][:, 1:]


@pytest.mark.parametrize("mode,precondition,molecules,tolerance", by_open_mpi([
    ("clumps", "clump", 1, 1e-3), ("all", "sparse", 0, 1e-3), ("all", "none", 1, 1e-3), ("all", "clump", 1, 1e-3),
    ("periodic", "waves", 0, 1e-3), ("all", "auto", 0, 9e-4),        # 192 unknowns: the inverse
    # blocks of the parts of clumps that a rank owns are others on other ranks: at a loose tolerance the answer shows
    # them
    ("periodic", "waves", 1, 1e-13), ("taper", "clump", 1, 1e-13)], but=2, several=True))
def test_ranks_restart_and_newton_leave_the_run_as_it_is(tmp_path, mode, precondition, molecules, tolerance):
    """Also at a tolerance at which the answer shows what preconditioned it, and though it was made some steps
    before."""
    args = (mode, precondition, molecules, tolerance)
    expected = going(tmp_path, "one", *args)
    scale = np.abs(expected).max(axis=0)
    for name, how in (("four", {"ranks": at_most(4)}), ("newton", {"newton": "off", "ranks": 2}),
                      ("cut", {"cut": True, "ranks": 2})):
        assert (np.abs(going(tmp_path, name, *args, **how) - expected) / scale).max() < 1e-10, name


REFUSED = [
    ("cut_off_distance inf taper wendland", ["keyword taper requires a cut_off_distance"]),
    ("clumps_only yes taper spherical", ["keyword taper requires a cut_off_distance"]),
    ("cut_off_distance 5 taper gauss", ["keyword taper: 'gauss' is none of: none, wendland, spherical"]),
    ("cut_off_distance 5 taper", ["keyword taper: value missing"]),
    ("clumps_only yes algorithm 2 precondition sparse",
     ["keyword precondition: 'sparse' requires cut_off_distance inf"]),
    ("cut_off_distance 5 algorithm 2 precondition sparse",
     ["keyword precondition: 'sparse' requires cut_off_distance inf"]),
    ("cut_off_distance inf precondition clump", ["keyword precondition: 'clump' requires algorithm 2"]),
    ("cut_off_distance inf precondition sparse algorithm 1", ["keyword precondition: 'sparse' requires algorithm 2"]),
    ("cut_off_distance inf algorithm 2 precondition ilu",
     ["keyword precondition: 'ilu' is none of: auto, none, clump, sparse"]),
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
                                 "plugin load stokesdynplugin.so", "region box block -9 9 -9 9 -9 9",
                                 "create_box 1 box", "create_atoms 1 single 0 0 0", "create_atoms 1 single 3 0 0",
                                 "set type 1 diameter 1.4", "pair_style stokes_dynamics cut_off_distance inf visc "
                                                            f"{ETA} algorithm 2 precondition clump",
                                 "pair_coeff * *", "fix drag all stokes_dynamics"])
    with pytest.raises(LammpsError, match=f"{PAIR}: keyword precondition: 'clump' requires molecule IDs"):
        sim.run()
