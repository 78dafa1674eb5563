"""The guess from which algorithm 2 starts. Spheres that see nobody need no solve: whatever the tolerance, the guess
already is their Stokes drag, since their v' is 0 and F = 6 pi eta a (u_inf + v' - v)."""
import numpy as np
import pytest

import suspensions
from host import allowed
from suspensions import flocs, loose_lattice
from system import Spheres, chain, input_lines, lmp

ETA = 0.37
EXACT = 1e-13           # of the largest force: rounding

LONE = np.array([[0.0, 0.0, 0.0], [9.0, 1.0, 0.0], [0.0, -8.0, 3.0], [5.0, 7.0, -6.0], [-7.0, 5.0, 8.0]])
RADII = np.array([0.5, 0.8, 1.1, 1.3, 0.7])


def speeding_up(n, steps, seed=4):
    """Velocities and spins [steps][n,6] that change from step to step: along a line, to which a guess may extrapolate,
    and by a little beyond it, which must not be lost although the tolerance would bear it."""
    rng = np.random.default_rng(seed)
    start, rate, wave = rng.normal(size=(3, n, 6))
    return [start + 0.02 * k * rate + 3e-4 * np.sin(1.7 * k) * wave for k in range(steps)]


def drags(simulation, spheres, style, motion, rotation):
    """Force and torque [n,6] of each step; the spheres stay where they are, their velocities are given."""
    sim = simulation(spheres, style)
    found = []
    for k, now in enumerate(motion):
        order = np.argsort(sim.ids())       # LAMMPS may sort the atoms as a run begins
        sim.raw("v")[order] = now[:, :3]
        sim.raw("omega")[order] = now[:, 3:]
        sim.run(1 if k else 0, "pre no post no" if k else "post no")
        rows = sim.fix_rows()
        found.append(np.hstack([rows[:, 0:3], rows[:, 6:9]]))
    return found


def stokes(a, now, rotation):
    F = -6 * np.pi * ETA * a[:, None] * now[:, :3]
    T = -8 * np.pi * ETA * a[:, None] ** 3 * now[:, 3:] * (rotation == "yes")
    return np.hstack([F, T])


def worst(found, exact):
    """Largest difference in units of the largest force, and of the largest torque."""
    scale = np.repeat([max(np.abs(exact[:, :3]).max(), 1e-300), max(np.abs(exact[:, 3:]).max(), 1.0)], 3)
    return (np.abs(found - exact) / scale).max()


@pytest.mark.parametrize("rotation", ["no", "yes"])
@pytest.mark.parametrize("tolerance", ["1e-3", "5e-2"])
@pytest.mark.parametrize("seen", ["cut_off_distance 1e-6", "clumps_only yes", "clumps_only yes precondition clump"])
@pytest.mark.parametrize("every", [1, 3])
def test_spheres_that_see_nobody_have_stokes_drag_in_every_step(simulation, seen, tolerance, rotation, every):
    spheres = Spheres(LONE, RADII)
    motion = speeding_up(len(LONE), 8)
    style = f"visc {ETA} {seen} algorithm 2 relative_tolerance {tolerance} rotation {rotation} update_every {every}"
    for now, found in zip(motion, drags(simulation, spheres, style, motion, rotation)):
        assert worst(found, stokes(RADII, now, rotation)) < EXACT


@pytest.mark.parametrize("rotation", ["no", "yes"])
@pytest.mark.parametrize("precondition", ["none", "clump"])
def test_a_lone_sphere_beside_clumps_has_stokes_drag_in_every_step(simulation, precondition, rotation):
    """What it takes to solve the clumps leaves alone what is solved already."""
    clump = chain(6, 1.7, molecule=1)
    far = LONE + (30.0, 0.0, 0.0)
    spheres = Spheres(np.vstack([clump.x, far]), np.concatenate([clump.a, RADII]), molecule=[1] * 6 + [0] * len(far))
    motion = speeding_up(spheres.n, 8)
    style = (f"visc {ETA} clumps_only yes algorithm 2 relative_tolerance 1e-3 rotation {rotation} precondition "
             f"{precondition}")
    for now, found in zip(motion, drags(simulation, spheres, style, motion, rotation)):
        assert worst(found[6:], stokes(RADII, now[6:], rotation)) < EXACT


def test_a_guess_that_is_exact_needs_no_iteration(simulation):
    motion = speeding_up(len(LONE), 4)
    sim = simulation(Spheres(LONE, RADII), f"visc {ETA} clumps_only yes algorithm 2 relative_tolerance 1e-8")
    for k, now in enumerate(motion):
        order = np.argsort(sim.ids())
        sim.raw("v")[order] = now[:, :3]
        sim.run(1 if k else 0, "pre no post no" if k else "post no")
        assert k == 0 or sim.iterations == 0


# The default, algorithm 1, hands over to 2 in the first solve of this scene.
@pytest.mark.parametrize("algorithm", ["", "algorithm 2"])
def test_warm_start_takes_two_iterations_a_step_and_keeps_the_tolerance(simulation, tmp_path, algorithm):
    spheres = loose_lattice(6, v=0.3)
    spheres.v += (0.0, 0.0, -1.0)
    words = f"cut_off_distance inf visc {suspensions.ETA} {algorithm} warm_start"
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


@pytest.mark.parametrize("precondition,molecules,tolerance",
                         [("none", 0, 1e-2), ("clump", 1, 1e-2), ("sparse", 0, 1e-2),
                         ("auto", 0, 1e-6), ("auto", 0, 1e-3), ("auto", 1, 1e-3)])
def test_warm_start_survives_a_restart(simulation, tmp_path, precondition, molecules, tolerance):
    """At a loose tolerance the answer shows where the solver began and what preconditioned it. The factor is not in the
    restart file, but where it was made: after 40 steps it is worn and not yet made anew."""
    words = (f"cut_off_distance inf visc {suspensions.ETA} algorithm 2 relative_tolerance {tolerance} precondition "
             f"{precondition}")
    spheres = flocs(4, 6, 8.0)
    spheres.molecule *= molecules
    rest = ["fix drag all stokes_dynamics", "fix pull all gravity 1.5 vector 0.3 0 -1", "fix move all nve/sphere"]
    begin = input_lines(spheres, words, tmp_path / "data", box=[(-30.0, 40.0)] * 3, fix=False, dt=0.002) + rest
    sim = simulation().commands(begin).run(40)
    sim.command(f"write_restart {tmp_path}/mid")
    sim.run(40)
    expected = np.hstack([sim.x, sim.v, sim.drag])
    sim = simulation().commands(["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/mid", "timestep 0.002"] +
                                rest)
    sim.run(40)
    assert np.abs(np.hstack([sim.x, sim.v, sim.drag]) - expected).max() < 1e-10


def test_a_guess_turns_with_its_clump(simulation):
    """Rods that fall and turn: a step takes one product since the last two answers turn with them, two without."""
    n = 3
    places = 7.0 * np.indices((n, n, n)).reshape(3, -1).T[:, None] + [(-2, 0, 0), (0, 0, 0), (2, 0, 0)]
    sim = simulation(Spheres(places.reshape(-1, 3), molecule=1 + np.arange(3 * n**3) // 3),
                     f"cut_off_distance inf visc {1 / (6 * np.pi)} rotation yes rigid_clumps yes", fix=False, dt=0.01,
                     boundary="p p p", box=[(0.0, 7.0 * n)] * 3, comm="neigh_modify exclude molecule/intra all")
    sim.commands(["variable fx atom 2*cos(mol)*(id-3*mol+1)", "variable fz atom 2*sin(mol)*(id-3*mol+1)",
                  "fix pull all addforce v_fx v_fz -1", "fix move all stokes_dynamics/overdamped"]).run(4, "post no")
    products = []
    for _ in range(10):
        sim.run(1, "pre no post no")
        products.append(sim.fix_vector("move")[3])
    assert products == [1] * 10


@pytest.mark.parametrize("points", ["rotation yes", "multiblob 12"])
def test_a_guess_goes_with_the_fluid_across_the_border_of_a_box_that_shears(simulation, points):
    """A sphere that crosses it, and its velocity with it, jumps; what it does against the fluid goes on."""
    n, rng = 3, np.random.default_rng(5)
    x = 2.5 * (np.indices((n, n, n)).reshape(3, -1).T + 0.9) + rng.uniform(-0.2, 0.2, (n**3, 3))
    words = f"cut_off_distance inf visc {1 / (6 * np.pi)} fluid_velocity box lubrication yes {points}"
    sim = simulation(Spheres(x % (2.5 * n)), words, fix=False, dt=0.002, boundary="p p p", box=[(0.0, 2.5 * n)] * 3,
                     tilt=(0.0, 0.0, 0.0), comm="neigh_modify delay 0 every 1 check no")
    sim.commands(["fix shear all deform 1 xy erate 0.5 remap none", "fix pull all addforce 0 25 0",
                  "fix move all stokes_dynamics/overdamped"]).run(4, "post no")
    products, crossed, y = [], 0, sim.x[:, 1]
    for _ in range(15):
        sim.run(1, "pre no post no")
        products.append(sim.fix_vector("move")[3])
        crossed += np.sum(np.abs(sim.x[:, 1] - y) > n)
        y = sim.x[:, 1]
    assert crossed > 0 and max(products) <= 2


# What a solve was asked before, of the same spheres: forces from velocities that are nearly those asked for then;
# motions with random numbers that are small
ASKED_BEFORE = {"forces": ["fix before all stokes_dynamics apply no"],
                "noise": ["fix before all stokes_dynamics/overdamped scheme midpoint temperature 1e-5 7 "
                          "noise_tolerance 0.1"]}


@pytest.mark.parametrize("before", ASKED_BEFORE)
def test_what_a_solve_was_asked_before_is_no_guess_of_other_questions(simulation, before):
    """At a loose tolerance the answer shows where the solver began: it does so from nothing, as without a run
    before."""
    x = np.array([(0, 0, 0), (2.3, 0, 0), (0, 2.4, 0.3), (2.2, 2.3, 0.9)])
    words = f"cut_off_distance inf visc {ETA} multiblob 12 lubrication yes relative_tolerance 0.05"
    pull, move = "fix pull all addforce 0.3 0.1 -1", "fix move all stokes_dynamics/overdamped"
    fresh = simulation(Spheres(x), words, fix=False).commands([pull, move, "run 0"])
    expected, spin = fresh.v, fresh.atom("omega")
    sim = simulation(Spheres(x, v=expected), words, fix=False)
    for i in range(4):
        sim.set("omega", i + 1, spin[i])
    sim.commands([pull] + ASKED_BEFORE[before] + ["run 0", "unfix before", move, "run 0"])
    assert np.array_equal(sim.v, expected) and np.array_equal(sim.atom("omega"), spin)


@pytest.mark.parametrize("points", ["rotation yes", "multiblob 12"])
def test_steps_take_as_many_products_on_any_ranks(tmp_path, points):
    """24 steps in which a guess is as often within the tolerance as just beyond it: one product or two, for no rank
    knows less of the last answers or of the films than one that knows all"""
    n, rng, found = 4, np.random.default_rng(5), []
    x = 2.4 * (np.indices((n, n, n)).reshape(3, -1).T + 0.9) + rng.uniform(-0.15, 0.15, (n**3, 3))
    for ranks in allowed(1, 2, 4):
        words = f"cut_off_distance inf visc {1 / (6 * np.pi)} lubrication yes {points}"
        lines = input_lines(Spheres(x % (2.4 * n)), words, tmp_path / "data", "p p p", [(0.0, 2.4 * n)] * 3, dt=0.08,
                            fix=False, comm="neigh_modify delay 0 every 1 check no")
        lmp(tmp_path, lines + ["variable pull atom 2*(id%2)-1", "fix pull all addforce 0 0 v_pull",
                               "fix move all stokes_dynamics/overdamped", "variable products equal f_move[4]",
                               f'fix out all print 1 "${{products}}" screen no file {tmp_path}/products', "run 24"],
            ranks)
        found.append(np.loadtxt(tmp_path / "products")[1:].sum())
    assert 24 < max(found) < 1.1 * min(found)
