"""fix stokes_dynamics/overdamped with held: spheres and clumps of given velocity, and the forces on them, against dense
algebra."""
import numpy as np
import pytest

import model
from system import Spheres, dump_lines, input_lines, lmp, read_dump

ETA = 1.3
FIX = "fix move all stokes_dynamics/overdamped"
X = np.array([(0, 0, 0), (2.3, 0.4, 0), (0.7, 2.6, 0.5), (-1.9, 1.0, 2.2), (-3.8, 0.6, 2.9), (2.0, 2.0, 3.5),
              (5.0, -1.0, 1.0)])
MOLECULE = np.array([0, 0, 0, 1, 1, 0, 0])
U = np.array((0.1, 0.2, -0.3))
LOAD = np.array([[np.sin(3 * i), 0.1 * i, -5 - 0.2 * i] for i in range(1, 8)])
PULL = ("variable fx atom sin(3*id)\nvariable fy atom 0.1*id\nvariable fz atom -5-0.2*id\n"
        "fix pull all addforce v_fx v_fy v_fz")
BOX = [(-30.0, 30.0)] * 3


def rigid(x, molecule):
    """K [6 n, 6 bodies], and the first sphere of each body"""
    bodies = [[i] for i in np.nonzero(molecule == 0)[0]] + [list(np.nonzero(molecule == m)[0])
                                                            for m in np.unique(molecule[molecule > 0])]
    K = np.zeros((6 * len(x), 6 * len(bodies)))
    for b, who in enumerate(bodies):
        centre = x[who].mean(axis=0)
        for i in who:
            r = x[i] - centre
            K[6 * i:6 * i + 6, 6 * b:6 * b + 6] = np.eye(6)
            K[6 * i:6 * i + 3, 6 * b + 3:6 * b + 6] = [[0, r[2], -r[1]], [-r[2], 0, r[0]], [r[1], -r[0], 0]]
    return K, bodies


def exact(x, molecule, held, given):
    """Velocities of the spheres and forces of the fluid on them [n, 6]: free bodies have their loads, held ones V =
    given(centre)."""
    K, bodies = rigid(x, molecule)
    R = np.linalg.inv(model.mobility(x, np.ones(len(x)), ETA, rotation=True))
    u = np.hstack([np.tile(U, (len(x), 1)), np.zeros((len(x), 3))]).ravel()
    load = np.hstack([LOAD, np.zeros((len(x), 3))]).ravel()
    is_held = np.repeat([who[0] in held for who in bodies], 6)
    V = np.concatenate([given(x[who].mean(axis=0)) if who[0] in held else np.zeros(6) for who in bodies])
    A = K.T @ R @ K
    right = K.T @ (load + R @ u)
    V[~is_held] = np.linalg.solve(A[np.ix_(~is_held, ~is_held)], (right - A @ np.where(is_held, V, 0))[~is_held])
    v = K @ V
    return v.reshape(-1, 6), -(R @ (v - u)).reshape(-1, 6)


CASES = {"one sphere": ([0], ""), "a sphere and a clump": ([2, 3, 4], ""), "all": (list(range(7)), ""),
         "moved": ([0, 3, 4], "fix m still move linear 0.5 -0.2 0.1"),
         "turned": ([1, 3, 4], "fix m still move rotate 1 0 0 0 0 1 20")}


def given_by(move, x):
    if "linear" in move:
        return lambda centre: np.array((0.5, -0.2, 0.1, 0, 0, 0))
    if "rotate" in move:
        W = np.array((0, 0, 2 * np.pi / 20))
        return lambda centre: np.concatenate([np.cross(W, centre - (1, 0, 0)), W])
    return lambda centre: np.zeros(6)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("ranks", [1, 2])
def test_held_bodies_move_as_given_and_the_others_as_the_fluid_between_says(tmp_path, case, ranks):
    held, move = CASES[case]
    words = (f"cut_off_distance inf visc {ETA} rotation yes rigid_clumps yes relative_tolerance 1e-10 fluid_velocity "
             f"{U[0]} {U[1]} {U[2]}")
    lines = input_lines(Spheres(X, molecule=MOLECULE), words, str(tmp_path / "data"), fix=False, box=BOX, dt=0.01)
    lines += [f"group still id {' '.join(str(i + 1) for i in held)}"] + PULL.splitlines() + [move, f"{FIX} held still"]
    columns = "x y z vx vy vz omegax omegay omegaz " + " ".join(f"f_move[{k}]" for k in range(4, 10))
    lmp(tmp_path, lines + dump_lines(tmp_path / "end", every=3, columns=columns) + ["run 3"], ranks)
    rows = read_dump(tmp_path / "end")[-1][1]
    x = rows[:, :3]
    v, F = exact(x, MOLECULE, held, given_by(move, x))
    scale, force = np.abs(v).max(), np.abs(F).max()
    assert np.abs(rows[:, 3:9] - v).max() < 1e-7 * max(scale, 1)
    K, bodies = rigid(x, MOLECULE)
    # of bodies: a doublet's two share theirs as they like
    assert np.abs(K.T @ (rows[:, 9:15] - F).ravel()).max() < 1e-7 * force
    moved = np.abs(x[held] - X[held]).max()
    assert moved == 0 if not move else moved > 0.01


def test_a_held_sphere_alone_feels_the_stream(simulation):
    """Clumps that do not feel each other: 6 pi eta a u on a sphere, and on a clump what the pair style finds for it at
    rest."""
    ends = []
    for motion in (f"group still molecule 0 1\n{FIX} held still", "fix drag all stokes_dynamics apply no"):
        sim = simulation(Spheres(X[3:6], molecule=[1, 1, 0]),
                         f"clumps_only yes visc {ETA} rigid_clumps yes shell 12 fluid_velocity 0.1 v_u -0.3",
                         fix=False, box=BOX, dt=0.1, before_pair="variable u atom 0.3*z")
        sim.commands(motion).run(1)
        ends.append(sim.fix_rows("move" if "overdamped" in motion
                                 else "drag")[:, [3, 4, 5] if "overdamped" in motion else [0, 1, 2]])
        assert (sim.x == X[3:6]).all()
    assert np.abs(ends[0] - ends[1]).max() < 1e-12 * np.abs(ends[1]).max()
    assert ends[0][2, 0] == pytest.approx(6 * np.pi * ETA * 0.1, rel=1e-12)


def test_films_press_a_sphere_onto_a_held_one(simulation):
    """What holds it is what the other one is pressed on with, whatever the gap: all force goes through the film and the
    fluid."""
    sim = simulation(Spheres([(0, 0, 0), (0, 0, 2.001)]),
                     "cut_off_distance inf visc 1 rotation yes lubrication yes relative_tolerance 1e-9",
                     fix=False, box=BOX, dt=1e-3)
    sim.commands(f"group floor id 1\nfix w all addforce 0 0 -3\n{FIX} held floor").run(10)
    rows = sim.fix_rows("move")
    assert (sim.x[0] == 0).all() and -0.01 < sim.v[1, 2] < 0
    assert rows[1, 5] == pytest.approx(3, rel=1e-9) and rows[0, 5] < -2.5


def test_a_held_run_in_pieces_is_the_run_in_one(simulation, tmp_path):
    words = f"cut_off_distance inf visc {ETA} rotation yes rigid_clumps yes relative_tolerance 1e-12"
    lines = input_lines(Spheres(X, molecule=MOLECULE), words, str(tmp_path / "data"), fix=False, box=BOX, dt=0.05)
    rest = ["group still id 1 4 5"] + PULL.splitlines() + ["fix m still move linear 0.5 -0.2 0.1", f"{FIX} held still"]
    whole = simulation().commands(lines + rest).run(30).x
    sim = simulation().commands(lines + rest).run(13)
    sim.command(f"write_restart {tmp_path}/half")
    assert np.abs(sim.run(17).x - whole).max() < 1e-10
    again = simulation().commands(["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/half",
                                   f"pair_style stokes_dynamics {words}", "pair_coeff * *", "timestep 0.05"] + rest[1:])
    assert np.abs(again.run(17).x - whole).max() < 1e-10


@pytest.mark.parametrize("keyword", ["held", "pin"])
def test_others_are_held_from_now_on(simulation, keyword):
    """Their velocities jump: nothing is extrapolated from those of before. Who is held does not leave its place, who is
    let go begins with a step of Euler."""
    sim = simulation(Spheres(X), f"cut_off_distance inf visc {ETA} relative_tolerance 1e-12", fix=False, box=BOX,
                     dt=0.05)
    sim.commands(["group still id 1 4"] + PULL.splitlines() + [f"{FIX} {keyword} still"]).run(5)
    sim.commands(["group still clear", "group still id 2 7"]).run(0)
    x, v = sim.x, sim.v
    assert (v[[1, 6]] == 0).all() and np.abs(v[[0, 3]]).max(axis=1).min() > 0.1
    assert np.abs(sim.run(1).x - x - 0.05 * v).max() < 1e-13


@pytest.mark.parametrize("line, message", [
    (f"{FIX} held nobody", "keyword held: group 'nobody' does not exist"),
    (f"group part id 4\n{FIX} held part", "keyword held: the clump of molecule 1 is only partly in the group"),
    (f"{FIX}\nfix m all move linear 1 0 0", "fix m of style move integrates spheres that fix"),
    (f"group some id 1\n{FIX} held some\nfix m all move linear 1 0 0",
     "fix m of style move integrates spheres that fix"),
    (f"{PULL}\ngroup some id 1 3\nfix m some move linear 0 NULL 0.1\n{FIX} held some",
     "keyword held: fix move leaves atom 1 free along y .NULL., where force and mass then move it"),
    (f"{PULL}\ngroup some id 1 3\nvariable z equal 0.1*step*dt\nvariable w equal 0.1\n{FIX} held some\n"
     "fix m some move variable NULL NULL v_z NULL NULL v_w", "fix move leaves atom 1 free along x"),
])
def test_what_cannot_be_held_is_named(simulation, line, message):
    sim = simulation(Spheres(X, molecule=MOLECULE), f"cut_off_distance inf visc {ETA} rotation yes rigid_clumps yes",
                     fix=False, box=BOX, dt=0.01)
    with pytest.raises(Exception, match=message):
        sim.commands(line).run(1)


@pytest.mark.parametrize("style, told", [("setforce 0 0 0", True), ("freeze", True), ("addforce 0 0 0", False)])
def test_who_takes_forces_away_to_hold_spheres_is_told_how(tmp_path, style, told):
    lines = input_lines(Spheres(X), f"cut_off_distance inf visc {ETA}", str(tmp_path / "data"), fix=False, box=BOX,
                        dt=0.01)
    log = lmp(tmp_path, lines + ["group bed id 1 2", f"fix hold bed {style}", FIX, "run 0"]).log
    assert ("without inertia a force of 0 does not hold a sphere: use keyword held GROUP" in log) == told
    log = lmp(tmp_path, lines + ["group bed id 1 2", f"fix hold bed {style}", f"{FIX} held bed", "run 0"]).log
    assert "does not hold a sphere" not in log


# --- scheme midpoint --------------------------------------------------------------------------------------------------

# and the velocity of the first moment, which fix move leaves to the user
MOVES = {"linear": ("fix go some move linear 0.5 -0.2 0.1", (0.5, -0.2, 0.1)),
         "rotate": (f"fix go some move rotate 1 0 0 0 0 1 9\nset group some omega 0 0 {2 * np.pi / 9!r}",
                    (0, -2 * np.pi / 9, 0)),
         "wiggle": ("fix go some move wiggle 0.5 -0.9 0.3 7", 2 * np.pi / 7 * np.array((0.5, -0.9, 0.3)))}


def dragged(simulation, steps, move, words, options="scheme midpoint", order=1, t=4.0):
    """Sphere 1 on its way through the others, which fall. order: which of the two fixes stands first"""
    fix, v = MOVES[move]
    sim = simulation(Spheres(X[[0, 1, 2, 5, 6]]), f"cut_off_distance inf visc {ETA} {words} relative_tolerance 1e-10",
                     fix=False, box=BOX, dt=t / steps)
    start = "group some id 1\nvelocity some set {!r} {!r} {!r}\n".format(*map(float, v))
    return sim.commands(start + PULL + "\n" + "\n".join([fix, f"{FIX} held some {options}"][::order]))


@pytest.mark.parametrize("move", MOVES)
@pytest.mark.parametrize("words", ["rotation yes", "rotation yes lubrication yes wall zlo -4"])
def test_a_dragged_sphere_moves_others_by_the_second_order(simulation, move, words):
    """In whatever order the two fixes stand; the same path as by ab2"""
    ends = [dragged(simulation, n, move, words, order=-1 if n == 50 else 1).run(n).x for n in (24, 50, 96, 1000)]
    ends.append(dragged(simulation, 1000, move, words, "scheme ab2").run(1000).x)
    errors = [np.abs(e - ends[3]).max() for e in ends[:3]]
    assert np.abs(ends[4] - ends[3]).max() < 0.2 * errors[2]
    for coarse, fine, ratio in ((0, 1, 50 / 24), (1, 2, 96 / 50)):
        assert np.log(errors[coarse] / errors[fine]) / np.log(ratio) == pytest.approx(2, abs=0.3)


def test_a_dragged_sphere_alone_feels_its_drag(simulation):
    sim = simulation(Spheres(X[:1]), f"cut_off_distance inf visc {ETA} rotation yes", fix=False, box=BOX, dt=0.1)
    sim.commands(["group some id 1", MOVES["linear"][0], f"{FIX} held some scheme midpoint"]).run(5)
    assert sim.fix_rows("move")[0, 3:6] == pytest.approx(-6 * np.pi * ETA * np.array((0.5, -0.2, 0.1)), rel=1e-12)
    assert sim.x[0] == pytest.approx(X[0] + 0.5 * np.array((0.5, -0.2, 0.1)), abs=1e-12)


def test_a_dragged_sphere_among_others_feels_what_the_dense_algebra_says(simulation):
    """Free spheres and a clump around it, in a stream"""
    sim = simulation(Spheres(X, molecule=MOLECULE),
                     f"cut_off_distance inf visc {ETA} rotation yes rigid_clumps yes relative_tolerance 1e-10 "
                     f"fluid_velocity {U[0]} {U[1]} {U[2]}", fix=False, box=BOX, dt=0.05)
    sim.commands(f"group some id 1\n{PULL}\n{MOVES['linear'][0]}\n{FIX} held some scheme midpoint").run(4)
    v, F = exact(sim.x, MOLECULE, [0], given_by("linear", X))
    assert np.abs(sim.v - v[:, :3]).max() < 1e-7 * np.abs(v).max()
    assert np.abs(sim.fix_rows("move")[0, 3:9] - F[0]).max() < 1e-7 * np.abs(F).max()


@pytest.mark.parametrize("words", ["", "rotation yes lubrication yes", "multiblob 12 lubrication yes"])
def test_a_sphere_dragged_through_the_noise_is_one_at_rest_in_a_stream(simulation, words):
    """Two others in traps that go along, by the same random numbers: their drift is that of the mobility beside a held
    sphere. Only the traps and the random forces are the same; what differs is who moves."""
    U, dt, x = np.array((0.4, -0.3, 0.2)), 0.02, X[[0, 1, 2]]
    ends = []
    for moves in (True, False):
        stream = "" if moves else "fluid_velocity {!r} {!r} {!r}".format(*map(float, -U))
        sim = simulation(Spheres(x), f"cut_off_distance inf visc {ETA} {words} {stream} relative_tolerance "
                                     "1e-11 max_iter 400", fix=False,
                         box=BOX, dt=dt)
        for d in range(3):
            home = "+".join(f"(id=={i + 1})*({x[i, d]:.17g})" for i in range(3))
            sim.command(f"variable f{'xyz'[d]} atom -20*({'xyz'[d]}-({home})-({moves * U[d]:.17g})*step*{dt})")
        sim.command("fix trap all addforce v_fx v_fy v_fz")
        if moves:
            sim.commands("group some id 1\nvelocity some set {0!r} {1!r} {2!r}\n"
                         "fix go some move linear {0!r} {1!r} {2!r}".format(*map(float, U)))
        sim.commands(f"group probe id 1\n{FIX} held probe temperature 0.8 77 noise_tolerance 1e-9").run(40)
        ends.append((sim.x - moves * 40 * dt * U, sim.fix_rows("move")[:, 3:6]))
    assert np.abs(ends[0][0] - x)[1:].max() > 0.1 and np.abs(ends[0][0] - x)[0].max() < 1e-12
    assert np.abs(ends[0][0] - ends[1][0]).max() < 1e-8
    assert np.abs(ends[0][1] - ends[1][1]).max() < 1e-6 * np.abs(ends[0][1]).max()


def test_a_held_sphere_of_a_flexible_clump_across_a_sheared_face(simulation):
    """Clumps that do not feel each other, in a box that shears: the clump across the face moves as in the middle of the
    box."""
    rate, side, answers = 0.4, 10.0, []
    for lower in (0.0, 4.0):
        x = np.array([(5, 9.4, 5), (5.2, 11.2, 5.1), (6.5, 10.4, 6.0)]) - (0, lower, 0)
        x[:, 1] %= side
        go = "{!r} 0.1 -0.3 units box".format(float(rate * x[1, 1] + 0.2))    # the same beside the fluid there
        sim = simulation(Spheres(x, molecule=1), f"clumps_only yes visc {ETA} rotation yes fluid_velocity box "
                                                 "relative_tolerance 1e-10", fix=False,
                         boundary="p p p", box=[(0.0, side)] * 3, tilt=(0.0, 0.0, 0.0), dt=1e-9)
        sim.commands([f"fix d all deform 1 xy erate {rate} remap v", "fix weight all addforce 0 1 -3", "group one id 2",
                      f"velocity one set {go}", f"fix go one move linear {go}", f"{FIX} held one"]).run(0)
        v = sim.v - rate * np.outer(x[:, 1], (1, 0, 0))
        answers.append(np.hstack([v, sim.fix_rows("move")[:, 3:9]]))
    assert np.abs(answers[0] - answers[1]).max() < 1e-6 * np.abs(answers[1]).max()


def test_forces_when_the_fix_that_held_spheres_is_gone(simulation):
    """The pair style asks nobody then who is held."""
    words = f"cut_off_distance inf visc {ETA} rotation yes rigid_clumps yes lubrication yes relative_tolerance 1e-10"
    sim = simulation(Spheres(X, molecule=MOLECULE), words, fix=False, box=BOX, dt=0.01)
    sim.commands(f"group still id 1 4 5\n{PULL}\n{FIX} held still").run(2)
    x, v, omega = sim.x, sim.v, sim.atom("omega")
    sim.commands("unfix move\ngroup still clear\ngroup still id 4\nfix drag all stokes_dynamics apply no").run(0)
    found = sim.fix_rows()
    sim = simulation(Spheres(x, v=v, molecule=MOLECULE), words, box=BOX)
    for i in range(len(x)):
        sim.set("omega", i + 1, omega[i])
    sim.run(0)
    assert np.abs(found - sim.fix_rows()).max() < 1e-7 * np.abs(found).max()
