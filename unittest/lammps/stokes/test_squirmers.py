"""fix stokes_dynamics/overdamped with squirm: swimmers by a slip of their surface. Closed forms of a lone one, exact
pairs and walls, what their symmetry says, and one run made in several ways."""
import csv
import os

import numpy as np
import pytest

import model
from brownian import A, ETA, KT, copies, end, in_pieces
from host import by_open_mpi
from system import LammpsError, dump_lines
from test_directions import CENTRE, MOVE, POINTS, dipole_lines, dipoles, directions, some_quaternions, turned

B1, B2, BETA = 1.3, -2.1, 0.6
E = np.array((0.48, 0.6, -0.64))
ROW, COLUMN = [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]
TIGHT = f"cut_off_distance inf visc {ETA} relative_tolerance 1e-12"


def shells(points, more=""):
    return f"{TIGHT} multiblob {points} {more}"


def swim(simulation, tmp_path, x, e, words, options=f"squirm all {B1} {B2} {BETA}", dt=0.01, lines="", **more):
    sim = dipoles(simulation, tmp_path, x, e, words, dt, **more)
    return sim.commands(f"{lines}\ncompute S all stokes_dynamics/stress\n{MOVE} {options}")


def moments(sim):
    rows = np.array(sim.lmp.numpy.extract_compute("S", 1, 2))[:sim.n]
    return rows[np.argsort(sim.ids())]


# --- alone ------------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("points", [12, 42])
@pytest.mark.parametrize("one_body", ["yes", "no"])
def test_a_lone_swimmer_is_exact(simulation, tmp_path, points, one_body):
    """Speed 2 B1/3, first moments -4 pi eta a^2 B2 (e e - 1/3), no force, no torque, no spin: whatever its direction
    and length of mu"""
    sim = swim(simulation, tmp_path, CENTRE, 1.7 * E, shells(points, f"one_body {one_body}")).run(1)
    expected = -4 * np.pi * ETA * A**2 * B2 * (np.outer(E, E) - np.eye(3) / 3)[ROW, COLUMN]
    assert np.abs(sim.v - 2 / 3 * B1 * E).max() < 1e-11
    assert np.abs(sim.atom("omega")).max() < 1e-11
    assert np.abs(moments(sim)[0, :6] - expected).max() < 1e-9
    assert np.abs(sim.fix_rows("move")[:, 3:9]).max() < 1e-12


def test_it_swims_along_the_axis_of_its_quaternion(simulation, tmp_path):
    q = some_quaternions(1)
    sim = swim(simulation, tmp_path, CENTRE, (0, 0, 0), shells(12), quaternions=q).run(0)
    w, x, y, z = q[0]
    assert np.abs(sim.v[0] - 2 / 3 * B1 * np.array((2 * (x * z + w * y), 2 * (y * z - w * x),
                                                    1 - 2 * (x * x + y * y)))).max() < 1e-11


@pytest.mark.parametrize("scheme", ["ab2", "midpoint"])
def test_a_swimmer_in_a_vortex_goes_round(simulation, tmp_path, scheme):
    """In a fluid that turns as a whole it keeps its place there, along its own line: x = R(t) (x_0 + U t e_0)."""
    w, dt, steps = 0.4, 0.05, 60
    sim = swim(simulation, tmp_path, [(1.0, 0, 0)], (0.6, 0.8, 0), shells(12, "fluid_velocity v_u v_v 0"),
               f"squirm all {B1} {B2} scheme {scheme}", dt, f"variable u atom {-w}*y\nvariable v atom {w}*x").run(steps)
    t = dt * steps
    expected = turned(np.array([(1.0, 0, 0)]) + 2 / 3 * B1 * t * np.array([(0.6, 0.8, 0)]), np.array([(0, 0, w * t)]))
    assert np.abs(sim.x - expected).max() < dt**2
    assert np.abs(directions(sim) - turned(np.array([(0.6, 0.8, 0)]), np.array([(0, 0, w * t)]))).max() < 1e-9


def test_variables_give_each_swimmer_its_own_amplitude(simulation, tmp_path):
    x = copies(np.zeros((1, 3)), 3, 4000.0).x
    sim = swim(simulation, tmp_path, x, E, shells(12), "squirm some v_b 0 scheme euler",
               lines="variable b atom id*(1+step)\ngroup some id 1 3",
               box=[(-1e4, 1e4)] * 3).run(1)
    assert np.abs(sim.v - 2 / 3 * np.array([[2.0], [0], [6.0]]) * E).max() < 1e-6


# --- others, and a wall -----------------------------------------------------------------------------------------------

def exact_rows():
    path = os.path.join(model.DATA, "multiblob", "squirmers.csv")
    with open(path) as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    cases = {}
    for row in rows:
        cases.setdefault(int(row["case"]), []).append([float(value) for value in list(row.values())[1:]])
    return {k: np.array(v) for k, v in cases.items()}


# Of pairs at 2.5, 3, 4 and 6 radii and walls at 1.6, 2 and 3: largest error of U and of a W, over the largest change
# that the neighbour or the wall makes, and with margins of a sixth. Over the largest velocity: pairs 2.6, 1.2, 0.4,
# 0.07 % (12 points), 0.5, 0.2, 0.09, 0.02 % (42), walls 5.0, 2.1, 0.4 % and 0.7, 0.3, 0.07 %.
BOUNDS = {12: [0.11, 0.078, 0.041, 0.018, 0.215, 0.13, 0.052], 42: [0.021, 0.0125, 0.0095, 0.005, 0.032, 0.020, 0.0089]}


@pytest.mark.parametrize("points", [12, 42])
@pytest.mark.parametrize("case", range(7))
def test_pairs_and_walls_are_as_exact_solutions_say(simulation, tmp_path, points, case):
    rows = exact_rows()[case]
    wall, x, e, B, U = rows[0, 0], rows[:, 1:4], rows[:, 4:7], rows[:, 7:10], rows[:, 10:16]
    given = "\n".join(f"variable b{k} atom {B[0, k]}*(id==1)" + (f"+{B[1, k]}*(id==2)" if len(B) > 1 else "")
                      for k in range(3))
    sim = swim(simulation, tmp_path, A * x, e, shells(points, "wall zlo 0" if wall else ""),
               "squirm all v_b0 v_b1 v_b2", lines=given, box=[(-40.0, 40.0)] * 2 + [(0.0, 40.0)] if wall
               else None).run(0)
    alone = np.hstack([2 / 3 * B[:, :1] * e, np.zeros((len(x), 3))])
    now = np.hstack([sim.v, A * sim.atom("omega")])
    assert np.abs(now - U).max() < BOUNDS[points][case] * np.abs(U - alone).max()


def test_pushed_neighbours_go_faster_and_swimmers_slower(simulation, tmp_path):
    """Side by side, four radii apart: as the page says, and by the far flow of a source dipole 1 - (1/4)^3/2"""
    x, e, words = [(0, 0, 0), (4 * A, 0, 0)], (0, 0, 1.0), shells(42)
    pushed = dipoles(simulation, tmp_path, x, e, words,
                     0.01).commands(f"fix push all propel/self dipole {6 * np.pi * ETA * A}\n{MOVE}").run(0).v
    swims = swim(simulation, tmp_path, x, e, words, "squirm all 1.5 0").run(0).v
    assert pushed[:, 2] == pytest.approx([1.195] * 2, abs=0.005)
    assert swims[:, 2] == pytest.approx([1 - 0.5 / 64] * 2, abs=2e-4)


@pytest.mark.parametrize("points, more", [(12, ""), (42, ""), (12, "lubrication yes"), (12, "rigid_clumps yes")])
def test_nobody_pulls_at_swimmers(simulation, tmp_path, points, more):
    """Of four that are close, free of force and torque each, also a clump of two; mirrored, they do the mirrored
    thing."""
    x, e = A * np.array([(0, 0, 0), (2.2, 0.3, 0), (0.4, 2.3, 0.6), (2.6, 1.9, -0.9)]), np.random.default_rng(4).normal(
        size=(4, 3))
    molecule = [0, 0, 1, 1] if "clumps" in more else 0
    if molecule:
        x[3] = x[2] + A * np.array((2.0, 0, 0))
    sim = swim(simulation, tmp_path, x, e, shells(points, more), molecule=molecule).run(0)
    assert np.abs(sim.v).max() > 0.3
    F = sim.fix_rows("move")[:, 3:9]
    if molecule:
        assert np.abs(F[:2]).max() < 1e-9
        assert np.abs(F[2:, :3].sum(axis=0)).max() < 1e-9
        assert np.abs((F[2:, 3:] + np.cross(x[2:], F[2:, :3])).sum(axis=0)).max() < 1e-9
    else:
        assert np.abs(F).max() < 1e-9


def test_a_pair_is_symmetric(simulation, tmp_path):
    """Turned by half a turn about an axis between them the pair is itself again."""
    x = A * np.array([(1.2, 0.1, 0.3), (-1.2, -0.1, 0.3)])
    e = np.array([(0.3, 0.4, 0.8), (-0.3, -0.4, 0.8)])
    flip = np.array((-1, -1, 1))
    v = swim(simulation, tmp_path, x, e, shells(42)).run(0).v
    assert np.abs(v[1] - flip * v[0]).max() < 0.01 * np.abs(v).max()    # their shells stand alike, and are not turned


# --- with noise, and what is refused ----------------------------------------------------------------------------------

def test_a_swimmer_diffuses_as_others_do_and_its_step_is_its_stroke(simulation, tmp_path):
    """Noise of a swimmer is that of a sphere: with the same seed steps differ by the stroke, whose direction noise
    turns a little."""
    steps = []
    for options in ("", f"squirm all {B1} 0"):
        sim = dipoles(simulation, tmp_path, CENTRE, E, shells(12), 1e-6)
        sim.commands(f"{MOVE} temperature {KT} 5 {options}").run(1)
        steps.append(sim.x[0])
    assert np.abs(steps[1] - steps[0] - 1e-6 * 2 / 3 * B1 * E).max() < 1e-9


@pytest.mark.parametrize("words, lines, message", [
    (POINTS, f"{MOVE} squirm all 1 0",
     "keyword squirm: single points have no surface that slips: use multiblob of"),
    (shells(12), f"{MOVE} squirm nobody 1 0", "keyword squirm: group 'nobody' does not exist"),
    (shells(12), f"{MOVE} squirm all 1", "keyword squirm"),
    (shells(12), f"{MOVE} squirm all 1 x", "keyword squirm: 'x'"),
    (shells(12), f"{MOVE} squirm all 1 v_x", "keyword squirm: variable 'x' does not exist"),
    (shells(12), f"variable x atom 1e308*1e3*id\n{MOVE} squirm all 1 v_x",
     "keyword squirm: step 0: B1, B2 or beta of atom 1 is not a finite"),
    (shells(12), f"set atom 2 dipole 0 0 0\n{MOVE} squirm all 1 0",
     "keyword squirm: atom 2 has no direction along which it swims: give it a dipole"),
    (shells(12, "group one"), "fix move one stokes_dynamics/overdamped squirm all 1 0",
     "keyword squirm: atom 2 is not in the group of this fix"),
    (shells(12, "rigid_clumps yes clumps_only yes").replace("cut_off_distance inf", ""), f"{MOVE} squirm all 1 0",
     "clumps_only")])
def test_what_cannot_swim_is_named(simulation, tmp_path, words, lines, message):
    sim = simulation()
    prepared = dipole_lines(tmp_path, [(0, 0, 0), (5, 0, 0)], E, words, 0.02)
    at = next(k for k, line in enumerate(prepared) if line.startswith("pair_style"))
    with pytest.raises(LammpsError, match=message):
        sim.commands(prepared[:at] + ["group one id 1"] + prepared[at:] + lines.splitlines()).run(0)


# --- one run, however it is made --------------------------------------------------------------------------------------

END = dump_lines("end.dump", every=20, columns="xu yu zu mux muy muz vx vy vz")
WAYS = {"free": (shells(12), "", 0, "f f f"), "noise": (shells(12), f"temperature {KT} 7", 0, "f f f"),
        "clumps with films": (shells(12, "rigid_clumps yes lubrication yes"), "", [1, 1, 0, 2, 2, 0], "f f f"),
        "above a wall": (shells(12, "wall zlo -1"), "", 0, "f f f")}


def script(folder, way, runs, x=None, e=None):
    words, options, molecule, boundary = WAYS[way]
    x = A * np.array([(0, 0, 0), (2, 0, 0), (4.4, 0.5, 0.2), (0, 3, 0), (0, 3, 2),
                      (2.2, 2.5, 1)]) + 3.0 if x is None else x
    e = np.random.default_rng(9).normal(size=(6, 3)) if e is None else e
    lines = dipole_lines(folder, x, e, words, 0.02, molecule=molecule, boundary=boundary,
                         box=[(-40.0, 40.0)] * 2 + [(-1.0, 40.0)])
    return lines + ["variable b atom 1+0.1*id+step/40", f"{MOVE} {options} squirm all v_b -2 0.5"] + runs


@pytest.mark.ranks(2)
@pytest.mark.parametrize("way", by_open_mpi(WAYS))
def test_ranks_agree(tmp_path, way):
    one = end(tmp_path, script(tmp_path, way, END + ["run 20"]))
    assert np.abs(one[:, 6:]).max() > 0.5
    assert np.abs(one - end(tmp_path, script(tmp_path, way, END + ["run 20"]), 2)).max() < 1e-10


@pytest.mark.parametrize("way", WAYS)
def test_a_run_in_pieces_is_the_whole_run(tmp_path, way):
    whole, two, again = in_pieces(tmp_path, lambda runs: script(tmp_path, way, runs), END)
    assert np.abs(two - whole).max() < 1e-10
    assert np.abs(again - whole).max() < 1e-10


def test_a_scene_that_is_shifted_is_shifted(tmp_path):
    one = end(tmp_path, script(tmp_path, "free", END + ["run 20"]))
    x = A * np.array([(0, 0, 0), (2, 0, 0), (4.4, 0.5, 0.2), (0, 3, 0), (0, 3, 2), (2.2, 2.5, 1)]) + 3.0
    other = end(tmp_path, script(tmp_path, "free", END + ["run 20"], x=x + (1.3, -2.2, 0.7)))
    other[:, :3] -= (1.3, -2.2, 0.7)
    assert np.abs(other - one).max() < 1e-10
