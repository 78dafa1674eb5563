"""Everybody sees everybody in a periodic box, and in a large open one: far_field.

Scenes of unittest/data/ewald (README there): dense sums over k and over images, made with two splittings."""
import csv
import functools
import pathlib
import re

import numpy as np
import pytest

from host import allowed
from system import LammpsError, Spheres, dump_lines, input_lines, lmp, note, read_dump

DATA = pathlib.Path(__file__).resolve().parents[2] / "data" / "ewald"
SCENES = ["p01", "p02", "p04", "p05", "p07", "p10", "p12", "p14"]
ALL = "cut_off_distance inf algorithm 2 max_iter 1000"
FORCES = "x y z vx vy vz f_drag[1] f_drag[2] f_drag[3] f_drag[7] f_drag[8] f_drag[9]"


def table(name):
    with open(DATA / name) as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))


@functools.lru_cache(None)
def scene(name):
    """(settings of the scene, columns by name)"""
    about = next(row for row in table("scenes.csv") if row["scene"] == name)
    rows = table(f"{name}.csv")
    return about, {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


def columns(rows, names):
    return np.stack([rows[name] for name in names.split()], axis=1)


def box_of(about):
    tilt = tuple(float(about[t]) for t in ("xy", "xz", "yz"))
    return [(0.0, float(about[length])) for length in ("lx", "ly", "lz")], tilt if any(tilt) else None


def inside(x, box, tilt):
    """The images within the box, as data files want them."""
    (_, lx), (_, ly), (_, lz) = box
    xy, xz, yz = tilt or (0.0, 0.0, 0.0)
    edges = np.array([[lx, 0, 0], [xy, ly, 0], [xz, yz, lz]])
    f = np.linalg.solve(edges.T, x.T).T
    return (f - np.floor(f)) @ edges


def moving(name, motion):
    """Lines of the scene with the velocities of the resistance problem R, or with one velocity for all, S; the
    reference."""
    about, rows = scene(name)
    box, tilt = box_of(about)
    if motion == "R":
        v, w = columns(rows, "vx vy vz"), columns(rows, "wx wy wz")
        F, T = columns(rows, "Rx Ry Rz"), columns(rows, "RTx RTy RTz")
    else:
        v, w = np.tile((0.48, -0.6, 0.64), (len(rows["a"]), 1)), np.zeros((len(rows["a"]), 3))
        F, T = columns(rows, "Sx Sy Sz"), columns(rows, "STx STy STz")
    spheres = Spheres(inside(columns(rows, "x y z"), box, tilt), rows["a"], v)
    spins = [f"set atom {i + 1} omega " + " ".join(repr(float(c)) for c in w[i]) for i in range(spheres.n)]
    words = f"{ALL} visc {about['eta']} rotation {about['rotation']}"
    return spheres, words, dict(boundary="p p p", box=box, tilt=tilt), spins, np.hstack([F, T])


def deviation(rows, reference, a):
    """rms of forces over that of the reference; torques count over the radius."""
    scale = np.hstack([np.ones((len(a), 3)), np.repeat(1.0 / a[:, None], 3, axis=1)])
    return np.linalg.norm((rows - reference) * scale) / np.linalg.norm(reference * scale)


def solved(simulation, name, motion, tolerance):
    spheres, words, where, spins, reference = moving(name, motion)
    sim = simulation(spheres, f"{words} relative_tolerance {0.1 * tolerance} far_field_tolerance {tolerance}", **where)
    sim.commands(spins).run()
    error = deviation(sim.fix_rows()[:, [0, 1, 2, 6, 7, 8]], reference, spheres.a)
    note("error", error)
    return error


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("motion", ["R", "S"])
@pytest.mark.parametrize("name", SCENES)
def test_forces_are_those_of_the_periodic_sum(simulation, name, motion, tolerance):
    assert solved(simulation, name, motion, tolerance) < 10 * tolerance


@pytest.mark.parametrize("name", ["p04", "p07", "p12", "p14"])
def test_one_two_three_and_four_ranks_are_one(tmp_path, name):
    spheres, words, where, spins, reference = moving(name, "R")
    lines = input_lines(spheres, words + " relative_tolerance 1e-12 far_field_tolerance 1e-12", tmp_path / "data",
                        **where)
    lines = ["box tilt large"] + lines + spins + dump_lines(tmp_path / "dump", columns=FORCES) + ["run 0"]
    first = None
    for ranks in allowed(1, 2, 3, 4):
        lmp(tmp_path, lines, ranks=ranks)
        rows = read_dump(tmp_path / "dump")[0][1][:, 6:]
        first = rows if first is None else first
        assert deviation(rows, first, spheres.a) < 1e-10
    assert deviation(first, reference, spheres.a) < 1e-10


BASIS = {"SC": [(0, 0, 0)], "BCC": [(0, 0, 0), (0.5, 0.5, 0.5)],
         "FCC": [(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)]}


@pytest.mark.parametrize("lattice", BASIS)
def test_drag_of_cubic_arrays(simulation, lattice):
    """F = 6 pi eta a K U with the superficial velocity U, here of the fluid past spheres at rest."""
    a, eta, U = 0.7, 1.3, np.array([0.3, -0.2, 0.5])
    for row in table("lattice_drag.csv"):
        phi, K = float(row["phi"]), float(row["K_rpy"])
        if row["lattice"] != lattice:
            continue
        L = (4 / 3 * np.pi * a**3 * len(BASIS[lattice]) / phi)**(1 / 3)
        spheres = Spheres(L * (np.array(BASIS[lattice]) + 0.123), a)
        sim = simulation(spheres, f"{ALL} visc {eta} fluid_velocity {U[0]} {U[1]} {U[2]} relative_tolerance 1e-12 "
                         "far_field_tolerance 1e-12", boundary="p p p", box=[(0.0, L)] * 3).run()
        assert np.abs(sim.drag / (6 * np.pi * eta * a * U) - K).max() < 1e-9 * K, phi


def cloud(n, phi, seed=5, ratio=3.0):
    rng = np.random.default_rng(seed)
    a = rng.uniform(1.0, ratio, n)
    side = (4 / 3 * np.pi * (a**3).sum() / phi)**(1 / 3)
    return Spheres(rng.uniform(0, side, (n, 3)), a, rng.normal(size=(n, 3)) + (0.0, 0.0, 1.0))


@pytest.mark.parametrize("rotation", ["no", "yes"])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_an_open_cloud_has_the_forces_of_all_pairs(simulation, tolerance, rotation):
    spheres = cloud(300, 0.2)
    words = f"{ALL} visc 1.3 rotation {rotation} relative_tolerance {0.1 * tolerance}"
    direct = simulation(spheres, words + " far_field direct").run().fix_rows()
    ewald = simulation(spheres, f"{words} far_field ewald far_field_tolerance {tolerance}").run().fix_rows()
    take = [0, 1, 2, 6, 7, 8]
    error = deviation(ewald[:, take], direct[:, take], spheres.a)
    assert 0.0 < error < 10 * tolerance


# --- when ------------------------------------------------------------------------------------------------------------

def said(log):
    return [line for line in log.read_text().splitlines() if line.startswith("Far field by Ewald sums")]


@pytest.mark.parametrize("n,split", [(200, False), (6000, True)])
def test_auto_splits_the_sum_of_large_open_clouds(simulation, tmp_path, n, split):
    log = tmp_path / "log"
    simulation(cloud(n, 0.1), "cut_off_distance inf algorithm 2 visc 1 relative_tolerance 1e-1",
               log=log).run().run().close()
    assert len(said(log)) == split      # once, though there are two runs


def test_a_box_that_is_changed_between_runs(simulation, tmp_path):
    """The parameters are told again, and the forces are those of a new run in the new box."""
    log, spheres, words = tmp_path / "log", cloud(60,
                                                  0.1), f"{ALL} visc 1 relative_tolerance 1e-9 far_field_tolerance 1e-4"
    sim = simulation(spheres, words, log=log, boundary="p p p", box=[(0.0, 40.0)] * 3).run().run()
    sim.command("change_box all x final 0 50 y final 0 50 z final 0 50 remap")
    forces = sim.run().drag
    sim.close()
    lines = said(log)
    assert len(lines) == 2 and lines[0] != lines[1]
    assert "60 spheres in the periodic box: grid" in lines[0] and "far_field_tolerance 0.0001" in lines[0]
    spheres.x = spheres.x * 50 / 40
    again = simulation(spheres, words, boundary="p p p", box=[(0.0, 50.0)] * 3).run().drag
    assert np.linalg.norm(forces - again) < 1e-7 * np.linalg.norm(again)


@pytest.mark.parametrize("boundary", ["p f f", "f p s", "m f p"])
def test_boxes_with_one_period_are_refused(simulation, boundary):
    with pytest.raises(LammpsError, match="cut_off_distance: 'inf' requires a box that is periodic in all three.*p p "
                                          "p.*clumps_only"):
        simulation(cloud(5, 0.01), f"{ALL} visc 1", boundary=boundary, box=[(-1.0, 40.0)] * 3).run()


def test_periodic_planes_are_refused(simulation):
    flat = Spheres([(1, 1, 0), (4, 2, 0)], 0.5, (0, 1, 0))
    sim = simulation()
    lines = input_lines(flat, f"{ALL} visc 1", str(sim.folder / "flat.data"), boundary="p p p",
                        box=[(0, 9), (0, 9), (-0.5, 0.5)])
    with pytest.raises(LammpsError, match="cut_off_distance: 'inf' in two dimensions requires boundary f f p"):
        sim.commands(["dimension 2"] + lines).run()


@pytest.mark.parametrize("words,text", [("far_field direct", "far_field direct"),
                                        ("precondition sparse", "precondition sparse"),
                                        ("tensor oseen", "tensor: 'oseen'")])
def test_what_a_periodic_sum_has_not_got(simulation, words, text):
    with pytest.raises(LammpsError, match=text + ".*not periodic"):
        simulation(cloud(5, 0.01), f"{ALL} visc 1 {words}", boundary="p p p", box=[(-1.0, 40.0)] * 3).run()


# --- two levels ------------------------------------------------------------------------------------------------------

def wide(x, larges=3, ratio=25.0):
    """Small spheres, and a few so large that a splitting of their own costs less; these hold some of the small ones."""
    rng = np.random.default_rng(4)
    a = rng.uniform(0.8, 1.2, len(x))
    a[7:7 + larges] = ratio * rng.uniform(0.7, 1.0, larges)
    return Spheres(x, a, rng.normal(size=x.shape) + (0.0, 0.0, 1.0))


def test_few_large_spheres_in_an_open_cloud_have_the_forces_of_all_pairs(simulation, tmp_path):
    log, words = tmp_path / "log", f"{ALL} visc 1.3 relative_tolerance 1e-3"
    spheres = wide(lattice(12, 0.15)[0].x)
    direct = simulation(spheres, words + " far_field direct").run().drag
    sim = simulation(spheres, words + " far_field ewald far_field_tolerance 1e-4", log=log).run()
    assert 0.0 < np.linalg.norm(sim.drag - direct) < 1e-2 * np.linalg.norm(direct)
    sim.close()
    assert re.search("; 3 spheres of radius [0-9.]+ and more on a second level: grid", said(log)[0])


@pytest.mark.ranks(3)
def test_two_levels_on_three_ranks(tmp_path):
    spheres = wide(np.random.default_rng(6).uniform(0, 24.0, (250, 3)))
    lines = input_lines(spheres, f"{ALL} visc 1.3 rotation no relative_tolerance 1e-11 far_field_tolerance 1e-6",
                        tmp_path / "data", boundary="p p p", box=[(0.0, 24.0)] * 3, tilt=(4.0, -3.0, 2.0))
    first = None
    for ranks in (1, 3):
        run = lmp(tmp_path, ["box tilt large"] + lines + dump_lines(tmp_path / "dump", columns=FORCES) + ["run 0"],
                  ranks=ranks)
        assert "on a second level" in run.log
        rows = read_dump(tmp_path / "dump")[0][1][:, 6:]
        first = rows if first is None else first
        assert deviation(rows, first, spheres.a) < 1e-10


@pytest.mark.ranks(2)
def test_rows_in_order_of_cells_are_those_of_their_atoms(tmp_path):
    """So many spheres that one rank sorts its rows by cells, as two ranks with half of them each do not."""
    rng = np.random.default_rng(8)
    x = 3.0 * np.array(list(np.ndindex(26, 26, 26))) + rng.uniform(0, 0.9, (26**3, 3))
    spheres = Spheres(rng.permutation(x), np.ones(len(x)), rng.normal(size=x.shape))
    lines = input_lines(spheres, f"{ALL} visc 1.3 rotation no relative_tolerance 1e-3", tmp_path / "data",
                        boundary="p p p", box=[(0.0, 78.0)] * 3)
    rows = []
    for ranks in (1, 2):
        lmp(tmp_path, lines + dump_lines(tmp_path / "dump", columns=FORCES) + ["run 0"], ranks=ranks)
        rows.append(read_dump(tmp_path / "dump")[0][1][:, 6:])
    assert deviation(rows[1], rows[0], spheres.a) < 1e-3


# --- runs ------------------------------------------------------------------------------------------------------------

def final(sim):
    return np.hstack([sim.x, sim.v, sim.fix_rows()[:, :6]])


@pytest.mark.parametrize("boundary", ["p p p", "f f f"])
@pytest.mark.parametrize("restart", [False, True])
def test_a_run_in_two_pieces(simulation, tmp_path, boundary, restart):
    """The open box around the cloud, which lasts while the spheres move, is kept too. In double precision, as solves
    below 1e-4 have it: atoms stand in another order then, and so do sums."""
    spheres = cloud(40, 0.05, ratio=1.5)
    words = "cut_off_distance inf visc 1.3 algorithm 2 far_field ewald far_field_tolerance 1e-2 relative_tolerance 9e-5"
    lines = input_lines(spheres, words, tmp_path / "data",
                        boundary=boundary, box=[(-20.0, 45.0)] * 3 if "f" in boundary else [(0.0, 25.0)] * 3, fix=False,
                        dt=0.05)
    rest = ["fix drag all stokes_dynamics apply no", "fix move all nve"]
    whole = final(simulation().commands(lines + rest).run(30))
    sim = simulation().commands(lines + rest).run(17)
    if restart:
        sim.command(f"write_restart {tmp_path}/mid")
        sim = simulation().commands(["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/mid",
                                     "timestep 0.05"] + rest)
    assert np.abs(final(sim.run(13)) - whole).max() < 1e-10 * np.abs(whole).max()


@pytest.mark.parametrize("ranks", [1, 3])
def test_a_box_that_shrinks_and_shears_in_the_run(simulation, tmp_path, ranks):
    """Forces of a step are those that a new run finds for the box and the spheres as the step before has left them."""
    words = f"{ALL} visc 1.3 relative_tolerance 1e-10 far_field_tolerance 1e-10"
    lines = input_lines(cloud(50, 0.1), words, tmp_path / "data", boundary="p p p", box=[(0.0, 30.0)] * 3,
                        tilt=(0.0, 0.0, 0.0), dt=0.01)
    lines += ["fix squeeze all deform 1 x scale 0.7 z scale 0.9 xy erate 3.2 remap x",
              *dump_lines(tmp_path / "dump", every=11), f"restart 10 {tmp_path}/last", "run 11"]
    lmp(tmp_path, lines, ranks=ranks)
    (_, before), (_, after) = read_dump(tmp_path / "dump")
    again = ["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/last.10",
             f"pair_style stokes_dynamics {words} warm_start no",
             "pair_coeff * *", "fix drag all stokes_dynamics apply no"]
    sim = simulation().commands(again).run()
    assert np.linalg.norm(sim.drag - after[:, 6:9]) < 1e-8 * np.linalg.norm(sim.drag)
    assert np.linalg.norm(before[:, 6:9] - after[:, 6:9]) > 0.1 * np.linalg.norm(sim.drag)


# --- the long waves as a preconditioner ------------------------------------------------------------------------------

def lattice(m, phi, seed=2):
    """m^3 equal spheres about the points of a cubic lattice, not overlapping, and the side of their box"""
    rng = np.random.default_rng(seed)
    step = (4 / 3 * np.pi / phi)**(1 / 3)
    points = np.stack(np.meshgrid(*3 * [np.arange(m) + 0.5], indexing="ij"), axis=-1).reshape(-1, 3)
    x = step * points + rng.uniform(-1, 1, points.shape) * (step - 2) / 2
    return Spheres(x, 1.0, rng.normal(size=x.shape)), m * step


def doublets(m, phi):
    """Each sphere of the lattice a molecule with its twin, a radius away."""
    spheres, side = lattice(m, phi / 2)
    rng = np.random.default_rng(8)
    arms = rng.normal(size=spheres.x.shape)
    x = np.vstack([spheres.x, spheres.x + arms / np.linalg.norm(arms, axis=1)[:, None]])
    molecules = np.tile(np.arange(spheres.n) + 1, 2)
    return Spheres(x % side, 1.0, np.vstack([spheres.v, -spheres.v]), molecules), side


@pytest.mark.parametrize("rotation", ["no", "yes"])
@pytest.mark.parametrize("scene,gain", [(lattice(8, 0.3), 2.0), (doublets(6, 0.3), 2.2)], ids=["spheres", "clumps"])
def test_waves_take_off_iterations_and_leave_the_answer(simulation, scene, gain, rotation):
    spheres, side = scene
    found = {}
    for how in ("none", "waves"):
        sim = simulation(spheres, f"{ALL} visc 1.3 warm_start no relative_tolerance 1e-7 far_field_tolerance 1e-4 "
                         f"rotation {rotation} precondition {how}", boundary="p p p", box=[(0.0, side)] * 3).run()
        found[how] = sim.iterations, sim.drag
    assert found["none"][0] > gain * found["waves"][0]
    assert np.linalg.norm(found["none"][1] - found["waves"][1]) < 1e-5 * np.linalg.norm(found["none"][1])


@pytest.mark.parametrize("rotation", ["no", "yes"])
@pytest.mark.ranks(3)
def test_waves_on_three_ranks(tmp_path, rotation):
    spheres, side = doublets(5, 0.3)
    lines = input_lines(spheres, f"{ALL} visc 1.3 warm_start no relative_tolerance 1e-10 far_field_tolerance 1e-11 "
                        f"precondition waves rotation {rotation}", tmp_path / "data", boundary="p p p",
                        box=[(0.0, side)] * 3)
    rows = []
    for ranks in (1, 3):
        lmp(tmp_path, lines + dump_lines(tmp_path / "dump", columns=FORCES) + ["run 0"], ranks=ranks)
        rows.append(read_dump(tmp_path / "dump")[0][1][:, 6:])
    assert deviation(rows[1], rows[0], spheres.a) < 1e-9


def test_auto_takes_the_waves_in_a_run(simulation):
    """Velocities that are others in each step; the waves, once made, are kept while spheres move a little."""
    spheres, side = lattice(8, 0.3)
    iterations = {}
    for how in ("none", "auto"):
        sim = simulation(spheres, f"{ALL} visc 1.3 relative_tolerance 1e-6 precondition {how}", boundary="p p p",
                         box=[(0.0, side)] * 3, dt=1e-3)
        sim.commands(["unfix drag", "fix drag all stokes_dynamics apply no", "fix move all nve"])
        rng = np.random.default_rng(3)
        for k in range(8):
            sim.raw("v")[:] = rng.normal(size=spheres.x.shape)
            sim.run(1 if k else 0, "pre no post no" if k else "post no")
        iterations[how] = sim.iterations
    assert iterations["auto"] < 0.6 * iterations["none"]


@pytest.mark.parametrize("dt,warned", [(0.02, False), (2.0, True)])
def test_the_time_step_guard_watches_in_a_periodic_box(simulation, tmp_path, dt, warned):
    """lambda is the smallest eigenvalue of the mobility scaled to unit diagonal; a sphere alone forgets its velocity in
    m/(6 pi eta a)."""
    spheres, side = lattice(5, 0.3)
    log, mass, drag = tmp_path / "log", 1.7 * 4 / 3 * np.pi, 6 * np.pi * 1.3
    sim = simulation(spheres, f"{ALL} visc 1.3", log=log, boundary="p p p", box=[(0.0, side)] * 3, dt=dt * mass / drag)
    sim.commands(["unfix drag", "fix drag all stokes_dynamics", "fix move all nve"]).run(1)
    limit, smallest = sim.fix_vector()[8], sim.fix_vector()[7]
    sim.close()
    assert ("is above" in " ".join(log.read_text().split())) == warned
    assert 0.01 < smallest < 0.9 and limit == pytest.approx(2 * mass / drag * smallest, rel=1e-6)
