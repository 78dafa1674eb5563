"""fix stokes_dynamics/overdamped with torque, given torques in the axes of space or of the particle, and with pin,
spheres and clumps that turn in their place: dense algebra, closed forms, what is found again by LAMMPS's own forces,
one run made in several ways."""
import numpy as np
import pytest

import model
from brownian import A, ETA, KT, L_OF_FOUR, copies, end, in_pieces
from system import LammpsError, Spheres, dump_lines
from test_directions import (CENTRE, CLUMPS, MOVE, POINTS, QUATERNIONS, SHELLS, SPIN, dipole_lines, dipoles, directions,
                             quaternions, rotation, some_quaternions, turned)
from test_spin import BOX, FREE, LOAD, PULL, X, twist

T = np.array((2.0, -1.0, 3.0))
TORQUE = "torque some 2 -1 3"
SOME = np.isin(range(5), [0, 2, 3])
WORDS = ["rotation yes", "rotation yes lubrication yes", "rotation yes wall zlo -3", "multiblob 12 lubrication yes",
         "rotation yes lubrication yes wall zlo -2.5", "rotation yes rigid_clumps yes lubrication yes",
         "multiblob 12 rigid_clumps yes", "rotation yes rigid_clumps yes clumps_only yes",
         "rigid_clumps yes shell 12 clumps_only yes"]


def loaded(simulation, words, options="", x=X, pull=PULL):
    molecule = [7, 7, 8, 8, 8] if "shell" in words else [0, 7, 0, 0, 7] if "clumps" in words else 0
    sim = simulation(Spheres(x, molecule=molecule), f"cut_off_distance inf visc {ETA} {words} relative_tolerance 1e-10",
                     fix=False, box=BOX, dt=0.02)
    return sim.commands(f"group some id 1 3 4\ngroup both id 2 5\n{pull}\n{MOVE} {options}")


# --- torque -----------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("words", WORDS)
def test_a_given_torque_is_one_of_lammps(simulation, words):
    def answer(sim):
        sim.run(0)
        return np.hstack([sim.v, sim.atom("omega"), sim.fix_rows("move")])
    by_keyword = answer(loaded(simulation, words, TORQUE))
    by_lammps = answer(twist(loaded(simulation, words), SOME[:, None] * T))
    without = answer(loaded(simulation, words))
    assert np.abs(by_keyword - by_lammps).max() < 1e-12 * np.abs(by_lammps).max()
    assert np.abs(by_keyword - without)[:, :6].max() > 0.01


def test_a_lone_sphere_turns_by_stokes_law_and_variables_change(simulation, tmp_path):
    """A torque that grows with time: the angle is its integral, to which Adams' and Bashforth's step is exact after the
    first one."""
    sim = dipoles(simulation, tmp_path, CENTRE, (1, 0, 0), POINTS, 0.01)
    sim.commands(f"variable t equal {SPIN!r}*(0.3+step*dt)\nvariable s atom id*{SPIN!r}\ngroup some id 1\n"
                 f"{MOVE} torque some 0 0 v_t").run(100)
    assert sim.atom("omega")[0] == pytest.approx([0, 0, 1.3], rel=1e-12)
    assert np.arctan2(*directions(sim)[0, 1::-1]) == pytest.approx(0.3 + 0.5 - 0.5 * 0.01**2, rel=1e-12)
    sim.command("unfix move")
    sim.commands(f"{MOVE} torque some 0 v_s 0").run(0)
    assert sim.atom("omega")[0] == pytest.approx([0, 1, 0], rel=1e-12)


@pytest.mark.parametrize("words, scheme", [(CLUMPS, "ab2"), (CLUMPS, "euler"), (CLUMPS, "midpoint"),
                                           (CLUMPS + " clumps_only yes", "ab2"),
                                           (f"{SHELLS} rigid_clumps yes relative_tolerance 1e-10", "ab2")])
def test_a_torque_along_the_axes_of_a_clump_turns_it_steadily(simulation, tmp_path, words, scheme):
    """Its angular velocity is fixed in its own axes, so in space too; along the axes of space it is not."""
    turns = {}
    for axes in ("body yes", "body no"):
        sim = dipoles(simulation, tmp_path, L_OF_FOUR, (0, 0, 0), words, 0.05, molecule=1)
        sim.commands(f"group one id 2\n{MOVE} scheme {scheme} torque one 20 10 -30 {axes}").run(0)
        W = sim.atom("omega")[0]
        sim.run(40)
        turns[axes] = rotation(sim.fix_rows("move")[:1, 9:13])[0], turned(np.eye(3), np.tile(2.0 * W, (3, 1))).T
    now, expected = turns["body yes"]
    assert np.abs(now - np.eye(3)).max() > 0.5
    assert np.abs(now - expected).max() < (1e-4 if scheme == "midpoint" else 1e-9)    # which extrapolates torques
    now, expected = turns["body no"]
    assert np.abs(now - expected).max() > 1e-2


def test_axes_of_a_sphere_are_its_quaternion_or_its_dipole(simulation, tmp_path):
    q, mu, x = some_quaternions(4), np.random.default_rng(2).normal(size=(4, 3)), copies(np.zeros((1, 3)), 4, 9.0).x
    words = f"{POINTS} fluid_velocity v_u 0 0 clumps_only yes"
    sim = dipoles(simulation, tmp_path, x, mu, words, 0.05, quaternions=q)
    sim.commands(f"variable u atom 0.8*z\n{QUATERNIONS}\n{MOVE} torque all 2 -1 3 body yes\n"
                 "fix read all ave/atom 1 1 1 c_q[*]").run(30)
    expected = rotation(quaternions(sim)) @ T / SPIN + (0, 0.4, 0)
    assert np.abs(rotation(q) @ T / SPIN + (0, 0.4, 0) - expected).max() > 0.1
    assert np.abs(sim.atom("omega") - expected).max() < 1e-12
    sim = dipoles(simulation, tmp_path, x, mu, words, 0.05)
    sim.commands(f"variable u atom 0.8*z\n{MOVE} torque all 0 0 3 body yes").run(30)
    e = directions(sim) / np.linalg.norm(mu, axis=1)[:, None]
    assert np.abs(sim.atom("omega") - 3 * e / SPIN - (0, 0.4, 0)).max() < 1e-12


@pytest.mark.parametrize("words, lines, message", [
    (POINTS, f"{MOVE} torque nobody 1 0 0", "keyword torque: group 'nobody' does not exist"),
    (POINTS, f"{MOVE} torque all 1 0", "keyword torque"),
    (POINTS, f"{MOVE} torque all 1 0 x", "keyword torque: 'x'"),
    (POINTS, f"{MOVE} torque all 1 0 v_x", "keyword torque: variable 'x' does not exist"),
    (POINTS, f"{MOVE} torque all 1 0 0 body maybe", "keyword torque: 'maybe'"),
    (POINTS, f"variable bad atom 1e308*1e3*id\n{MOVE} torque all 1 0 v_bad",
     "keyword torque: step 0: the torque on atom 1 is not a finite"),
    (POINTS + " group one", f"fix move one stokes_dynamics/overdamped torque all 1 0 0",
     "keyword torque: atom 2 is not in the group of this fix, which does not move it"),
    (POINTS, f"{MOVE} held one torque all 1 0 0",
     "keyword torque: atom 1 is in the group of keyword held as well.*use keyword pin"),
    (f"cut_off_distance inf visc {ETA}", f"set group all dipole 0 0 0\n{MOVE} torque all 1 0 0",
     "keyword torque: atom 1 is a free sphere, and with rotation no"),
    (POINTS, f"set group all dipole 0 0 0\n{MOVE} torque all 1 0 0 body yes",
     "body yes: atom 1 has no axes of its own: give it a dipole"),
    (POINTS, f"{MOVE} torque all 1 0 0 body yes",
     "body yes: atom 1 has a dipole, which is a z axis alone: Tx and Ty must be 0"),
    (POINTS, f"{MOVE} pin nobody", "keyword pin: group 'nobody' does not exist"),
    (POINTS, f"{MOVE} pin one held all", "keyword pin: atom 1 is in the group of keyword held as well"),
    (POINTS, f"{MOVE} pin one spin all 0 0 1", "keyword spin: atom 1 is in the group of keyword held or pin as well"),
    (CLUMPS + " clumps_only yes", f"{MOVE} pin one",
     "keyword pin: it is for spheres and clumps that feel each other: use clumps_only no"),
    (CLUMPS, f"{MOVE} pin one", "keyword pin: the clump of molecule 1 is only partly in the group"),
    (POINTS, f"{MOVE} pin one temperature 1 5 scheme ab2", "keyword pin: the mobility has a drift")])
def test_what_cannot_be_turned_or_pinned_is_named(simulation, tmp_path, words, lines, message):
    sim = simulation()
    prepared = dipole_lines(tmp_path, L_OF_FOUR, (0, 0, 1), words, 0.02, molecule=1 if "clumps" in words else 0)
    at = next(k for k, line in enumerate(prepared) if line.startswith("pair_style"))
    with pytest.raises(LammpsError, match=message):
        sim.commands(prepared[:at] + ["group one id 1"] + prepared[at:] + lines.splitlines()).run(0)


# --- pin --------------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("words", WORDS[:7])
def test_pinned_spheres_and_clumps_stay_by_the_force_that_is_found(simulation, words):
    """The same forces, put on spheres that are free, move all alike."""
    group = "both" if "clumps" in words else "some"
    pinned = [1, 4] if "clumps" in words else [0, 2, 3]
    sim = loaded(simulation, words, f"pin {group} {TORQUE}").run(5)
    rows, v, omega, x = sim.fix_rows("move"), sim.v, sim.atom("omega"), sim.x
    if group == "both":
        assert np.abs(v[pinned].mean(axis=0)).max() < 1e-12 and np.abs(v[pinned]).max() > 1e-3
        assert np.abs(x[pinned].mean(axis=0) - X[pinned].mean(axis=0)).max() < 1e-12
    else:
        assert (v[pinned] == 0).all() and (x[pinned] == X[pinned]).all()
        assert np.abs(rows[:, 6:9] + SOME[:, None] * T).max() < 1e-6
    assert np.abs(omega[pinned]).max(axis=1).min() > 1e-3
    free = loaded(simulation, words, x=x, pull="")
    def add(_lmp, _step, n, tag, _x, f):
        who = np.asarray(tag).ravel()[:n] - 1
        f[:n] = -rows[who, 3:6]
        free.raw("torque")[:n] += -rows[who, 6:9]
    free.command("fix field all external pf/callback 1 1")
    free.lmp.set_fix_external_callback("field", add)
    free.run(0)
    assert np.abs(free.v - v).max() < 1e-6 * np.abs(v).max()
    assert np.abs(free.atom("omega") - omega).max() < 1e-6 * np.abs(omega).max()


def test_pinned_spheres_move_their_neighbours_as_dense_algebra_says(simulation):
    sim = loaded(simulation, "rotation yes", f"pin some {TORQUE}").run(0)
    R = np.linalg.inv(model.mobility(X, np.ones(5), ETA, rotation=True))
    known = np.hstack([np.repeat(SOME[:, None], 3, axis=1), np.zeros((5, 3), bool)]).ravel()
    V = np.zeros(30)
    V[~known] = np.linalg.solve(R[np.ix_(~known, ~known)], np.hstack([LOAD, SOME[:, None] * T]).ravel()[~known])
    assert np.abs(np.hstack([sim.v, sim.atom("omega")]).ravel() - V).max() < 1e-9
    assert np.abs(sim.fix_rows("move")[:, 3:9].ravel() + R @ V).max() < 1e-7


@pytest.mark.parametrize("words, options", [(POINTS, "scheme euler"), (POINTS, "scheme ab2"),
                                            (SHELLS, "scheme midpoint")])
def test_a_pinned_sphere_turns_in_a_shear(simulation, tmp_path, words, options):
    x = [(0.3, 0, 2.0)]
    sim = dipoles(simulation, tmp_path, x, (0.6, 0, 0.8), f"{words} fluid_velocity v_u 0 0 relative_tolerance 1e-12",
                  0.1)
    sim.commands(f"variable u atom 0.8*z\n{MOVE} {options} pin all").run(50)
    assert (sim.x == x).all()
    assert np.abs(directions(sim) - turned(np.array([(0.6, 0, 0.8)]), np.array([(0, 2.0, 0)]))).max() < 1e-9


def test_a_pinned_sphere_turns_by_noise_in_its_place(simulation, tmp_path):
    """<e(0).e(t)> = exp(-2 D t), and its dipole is where a field wants it"""
    n, D, steps, x = 512, KT / SPIN, 20, copies(np.zeros((1, 3)), 512, 9.0).x
    mu = np.random.default_rng(5).normal(size=(n, 3))
    mu /= np.linalg.norm(mu, axis=1)[:, None]
    sim = dipoles(simulation, tmp_path, x, mu, f"{POINTS} far_field direct", 0.5 / D / steps, box=[(-60.0, 120.0)] * 3)
    sim.commands(f"{MOVE} temperature {KT} 4711 pin all noise_tolerance 0.1").run(steps)
    assert (sim.x == x).all()
    assert (directions(sim) * mu).sum(axis=1).mean() == pytest.approx(np.exp(-1), abs=4 * 0.48 / np.sqrt(n))


# --- one run, however it is made --------------------------------------------------------------------------------------

END = dump_lines("end.dump", every=20, columns="xu yu zu mux muy muz vx vy vz omegax omegay omegaz")
WAYS = {"points": (POINTS, "scheme ab2", 0), "shells with noise": (SHELLS, "temperature 1.5 7", 0),
        "clumps": (CLUMPS, "scheme ab2", [1, 1, 1, 1, 2, 2, 2, 2, 0, 0, 0, 0])}


def script(folder, way, runs):
    words, options, molecule = WAYS[way]
    lines = dipole_lines(folder, copies(L_OF_FOUR, 3, 5.0).x + 1.0, np.random.default_rng(9).normal(size=(12, 3)),
                         words, 0.02, molecule=molecule)
    return lines + ["group some id 1 2 3 4", "group loaded id 5 6 9", "variable t atom 3+id+step/10",
                    "fix push all propel/self dipole 2.0",
                    f"{MOVE} {options} pin some torque loaded 0 0 v_t body yes"] + runs


@pytest.mark.ranks(2)
@pytest.mark.parametrize("way", WAYS)
def test_ranks_agree(tmp_path, way):
    one = end(tmp_path, script(tmp_path, way, END + ["run 20"]))
    assert np.abs(one - end(tmp_path, script(tmp_path, way, END + ["run 20"]), 2)).max() < 1e-12


@pytest.mark.parametrize("way", WAYS)
def test_a_run_in_pieces_is_the_whole_run(tmp_path, way):
    whole, two, again = in_pieces(tmp_path, lambda runs: script(tmp_path, way, runs), END)
    assert np.abs(two - whole).max() < 1e-12
    assert np.abs(again - whole).max() < 1e-12
