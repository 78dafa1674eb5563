"""fix stokes_dynamics/overdamped: one run in whatever pieces and on however many ranks, and what changes between
runs."""
import os

import numpy as np
import pytest

from host import allowed, by_open_mpi
from system import Spheres, dump_lines, from_restart, input_lines, lmp, lmp_in_turn, read_dump
from without_inertia import ALL, FIX, P6, THREE, contacts, mixed, weight

WAYS = {"spheres": "cut_off_distance inf visc 1.1 rotation yes",
        "spheres by list": "cut_off_distance 9 taper wendland visc 1.1",
        "clumps": "cut_off_distance inf visc 1.1 rotation yes rigid_clumps yes relative_tolerance 1e-12",
        "clumps with shells": "cut_off_distance inf visc 1.1 rigid_clumps yes shell 12 fluid_velocity v_u 0 0 "
                              "relative_tolerance 1e-12",
        "clumps by list": "cut_off_distance 9 taper wendland visc 1.1 rotation yes rigid_clumps yes "
                          "relative_tolerance 1e-12",
        "close spheres": "cut_off_distance inf visc 1.1 rotation yes lubrication yes relative_tolerance 1e-12",
        "close clumps": "cut_off_distance inf visc 1.1 rigid_clumps yes shell 12 fluid_velocity v_u 0 0 "
                        "lubrication yes lubrication_gap 1e-2 relative_tolerance 1e-12",
        "shells of points": "cut_off_distance inf visc 1.1 multiblob 12 rigid_clumps yes fluid_velocity v_u 0 0 "
                            "lubrication yes relative_tolerance 1e-12",
        "clumps apart": "clumps_only yes visc 1.1 rotation yes rigid_clumps yes shell 12 fluid_velocity v_u 0 0"}


def script(folder, way, runs, newton="on", options="", box=(-40.0, 40.0), boundary="p p p"):
    boundary = "f f f" if "inf" in WAYS[way] else boundary
    lines = input_lines(mixed(), contacts(20.0, WAYS[way]), os.path.join(str(folder), "spheres.data"), fix=False,
                        box=[box] * 3, dt=0.3, boundary=boundary, newton=newton, comm="comm_modify vel yes cutoff 9\n"
                        "neigh_modify exclude molecule/intra all",
                        before_pair="variable u atom 0.05*z")
    # a force on every sphere of its own, so that bodies turn
    return lines + ["variable fx atom 0.3*sin(id)", "fix pull all addforce v_fx 0 -6", f"{FIX} {options}"] + runs


def end(name="end.dump"):
    return dump_lines(name, every=100, columns="x y z vx vy vz omegax omegay omegaz")


def last_frame(folder, name="end.dump"):
    return read_dump(os.path.join(str(folder), name))[-1][1]


def difference(a, b):
    """Up to the box: places within 80"""
    d = a - b
    d[:, :3] -= 80 * np.round(d[:, :3] / 80)
    return np.abs(d).max()


@pytest.mark.parametrize("way", by_open_mpi(WAYS, but=2))
def test_ranks_and_newton_do_not_matter(tmp_path, way):
    frames = []
    for ranks, newton in allowed((1, "on"), (2, "on"), (4, "off")):
        lmp(tmp_path, script(tmp_path, way, end() + ["run 100"], newton), ranks)
        frames.append(last_frame(tmp_path))
    assert np.abs(frames[0][:, :9]).max() > 1
    assert max(difference(f, frames[0]) for f in frames[1:]) < 1e-10


@pytest.mark.parametrize("way, options, ranks",
                         by_open_mpi([(way, "", 2) for way in WAYS], but=3, several=True) +
                         [("clumps with shells", "adapt 3 1e-3 0.5 0.05", 1), ("spheres", "scheme euler", 1)])
def test_a_run_in_pieces_is_the_run_in_one(tmp_path, way, options, ranks):
    """In two runs, and in two with a restart file in between"""
    def once(runs):
        return script(tmp_path, way, runs, options=options)

    # contacts of LAMMPS 29Sep2021 that begin a second time (two runs, write_restart) want memory that nobody has used:
    # first in a start
    lmp_in_turn(tmp_path, [once(["run 37", "write_restart half.restart"]), once(end() + ["run 100"]),
                           from_restart(once(end("restarted.dump") + ["run 63"]))], ranks)
    lmp(tmp_path, once(end("two.dump") + ["run 37", "run 63"]), ranks)
    for name in ("two.dump", "restarted.dump"):
        assert difference(last_frame(tmp_path, name), last_frame(tmp_path)) < 1e-10, name


@pytest.mark.parametrize("words", ["", "multiblob 12 warm_start no", "multiblob 12 lubrication yes warm_start no"])
def test_a_run_goes_on_by_the_second_order_when_nothing_has_changed(simulation, words):
    """Euler's step is for changes alone: a run in ten pieces is the run in one, also where solves leave nothing to
    begin the next one from."""
    ends = []
    for pieces in (1, 10):
        sim = simulation(THREE, f"{ALL} relative_tolerance 1e-12 {words}", fix=False, box=[(-99.0, 99.0)] * 3, dt=0.5)
        sim.commands([weight(THREE), FIX])
        for _ in range(pieces):
            sim.run(20 // pieces)
        ends.append(sim.x)
    assert np.abs(ends[1] - ends[0]).max() < 1e-13


def test_a_restart_file_of_the_midst_of_a_run_is_that_of_its_end(simulation, tmp_path):
    """Command restart: what velocities follow from is in the file before the run ends."""
    words = [f"pair_style stokes_dynamics {ALL}", "pair_coeff * *"]
    lines = input_lines(THREE, words, str(tmp_path / "data"), fix=False, box=[(-99.0, 99.0)] * 3, dt=0.5)
    rest = [weight(THREE), FIX]
    x = simulation().commands(lines + rest + [f"restart 12 {tmp_path}/half.*"]).run(20).x
    again = simulation().commands(["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/half.12", *words] + rest)
    assert np.abs(again.run(8).x - x).max() < 1e-13


@pytest.mark.parametrize("points", ["rotation yes", "multiblob 12"])
def test_a_restart_file_knows_where_the_factor_of_films_was_made(simulation, tmp_path, points):
    """To a loose tolerance the answer shows which factor its preconditioner has: that of some steps ago, as long as
    films hardly change. Of a row of spheres it is the same in whatever order they are."""
    rng, n = np.random.default_rng(8), 12
    x = np.column_stack([2.06 * np.arange(n) - 12, *rng.uniform(-0.1, 0.1, (2, n))])
    words = [f"pair_style stokes_dynamics cut_off_distance inf visc {1 / P6!r} relative_tolerance 0.03 lubrication yes "
             f"warm_start no {points}", "pair_coeff * *"]
    lines = input_lines(Spheres(rng.permutation(x)), words, str(tmp_path / "data"), fix=False,
                        box=[(-99.0, 99.0)] * 3, dt=2e-4)
    rest = ["variable fx atom sin(3*x)", "variable fz atom cos(2*x)", "fix pull all addforce v_fx 0 v_fz", FIX]
    whole = simulation().commands(lines + rest).run(30).v
    sim = simulation().commands(lines + rest).run(13)
    sim.command(f"write_restart {tmp_path}/half")
    pieces = sim.run(17).v
    sim = simulation().commands(["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/half", *words] + rest)
    for v in (pieces, sim.run(17).v):
        assert np.abs(v - whole).max() < 1e-9


@pytest.mark.parametrize("change", ["fix grow all adapt 1 atom diameter v_d", "fix grow tail adapt 1 atom diameter v_d",
                                    "change_box all x scale 1.0005 y scale 1.0005 z scale 1.0005 remap units box"])
def test_a_factor_of_films_is_not_that_of_other_numbers(simulation, tmp_path, change):
    """Radii within a run, or the box between two, change so little that films hardly do: to a loose tolerance the
    answer is still that of a factor of now, as in a run that has had no other."""
    rng, n = np.random.default_rng(8), 12
    x = np.column_stack([2.06 * np.arange(n) - 12, *rng.uniform(-0.1, 0.1, (2, n))])
    words = (f"cut_off_distance inf visc {1 / P6!r} relative_tolerance 0.03 lubrication yes warm_start no rotation yes "
             "far_field_tolerance 1e-9")
    found = []
    for begin in (1, 0):    # a step is far shorter than any digit of the places
        lines = input_lines(Spheres(x), words, str(tmp_path / "data"), fix=False, box=[(-12.5, 12.5)] * 3, dt=1e-18,
                            boundary="p p p")
        lines[1] = "atom_style hybrid sphere 1 bond"
        sim = simulation().commands(lines + [f"variable d equal 2.002-0.002*(step<{begin})", "group tail id 1:4",
                                             "variable fx atom sin(3*x)", "variable fz atom cos(2*x)",
                                             "fix pull all addforce v_fx 0 v_fz", FIX])
        if "adapt" in change:
            found.append(sim.commands(change).run(1).v)
        else:
            found.append((sim.run(1) if begin else sim).commands(change).run(0).v)
    assert np.abs(found[1] - found[0]).max() < 1e-9


def test_a_sphere_moved_by_hand_starts_anew(simulation):
    """displace_atoms between runs: what was before the move says nothing of the path after it."""
    ends = []
    for before in (0, 20):
        sim = simulation(THREE, ALL, fix=False, box=[(-99.0, 99.0)] * 3, dt=0.3)
        sim.commands([weight(THREE), FIX])
        sim.run(before) if before else None
        for k, x in enumerate([(-4, 0, 0), (0, 1, 0), (3, 0, 3)]):
            sim.set("x", k + 1, x)
        sim.run(10)
        ends.append(sim.x)
    assert np.abs(ends[1] - ends[0]).max() < 1e-12


@pytest.mark.parametrize("change, after", [("unfix weight", 0.0), ("unfix weight\nfix weight all addforce 0 0 2", 2.0),
                                           ("pair_style stokes_dynamics cut_off_distance inf visc 4\npair_coeff * *",
                                            -0.25),
                                           ("variable u equal 0.5", -0.5), ("variable u equal 0.0", -1.0)])
def test_a_force_that_is_taken_away_leaves_nothing(simulation, change, after):
    """Between two runs: the first step goes by the velocity of now alone. Nothing has changed in the last case."""
    sim = simulation(Spheres([(0, 0, 0)]), f"cut_off_distance inf visc {1 / P6!r} fluid_velocity 0 0 v_u", fix=False,
                     box=[(-30.0, 30.0)] * 3, dt=0.1, before_pair="variable u equal 0.0")
    sim.commands("fix weight all addforce 0 0 -1").commands(FIX).run(10)
    assert sim.x[0, 2] == pytest.approx(-1.0, abs=1e-13)
    after = after if "visc" not in change else -1 / (P6 * 4)
    sim.commands(change).run(10)
    assert sim.x[0, 2] == pytest.approx(-1.0 + after, abs=1e-13)


@pytest.mark.parametrize("way", ["delete_atoms", "evaporate"])
def test_the_step_after_atoms_have_gone_is_eulers(simulation, way):
    """What is left falls more slowly at once: no part of the step is of the velocities before."""
    spheres = Spheres([(0, 0, 0), (3, 0, 0), (0.5, 2.5, 0)])
    sim = simulation(spheres, ALL, fix=False, box=[(-40.0, 40.0)] * 3, dt=0.3)
    sim.commands(weight(THREE)).commands(FIX).commands("group heavy id 3")
    if way == "evaporate":
        sim.commands("region all block EDGE EDGE EDGE EDGE EDGE EDGE\nfix gone heavy evaporate 10 1 all 4711").run(9)
        assert sim.n == 3
        sim.run(1)
    else:
        sim.run(9).commands("delete_atoms group heavy compress no").run(0)
    assert sim.n == 2 and sim.fix_vector("move")[1] == 0.0
    x, v = sim.x, sim.v
    sim.run(1)
    assert np.abs(sim.x - x - 0.3 * v).max() < 1e-14


@pytest.mark.parametrize("tolerance, first, longer", [(1e-12, 0.02, 8.0), (1e-2, 1e-5, 1e4)])
def test_a_far_longer_step_is_eulers(simulation, tolerance, first, longer):
    """It does not multiply what two solves have left of their tolerance; one eight times as long goes on as ever."""
    spheres = Spheres([(0, 0, 0), (2.1, 0, 0), (0.5, 2.3, 0)])
    words = f"cut_off_distance inf visc 1 multiblob 12 lubrication yes relative_tolerance {tolerance}"
    sim = simulation(spheres, words, fix=False, box=[(-40.0, 40.0)] * 3, dt=first)
    sim.commands(weight(spheres)).commands(FIX).run(0)
    old = sim.v
    sim.run(1)
    x, v, dt = sim.x, sim.v, first * longer
    sim.commands(f"timestep {dt}").run(1)
    change = v - old if longer < 10 else np.zeros_like(v)
    assert np.abs((sim.x - x) / dt - v - 0.5 * longer * change).max() < max(2 * tolerance, 1e-10) * np.abs(v).max()
    assert np.abs(v - old).max() > 1e-5


def test_a_restarted_step_of_adapt_is_told_to_others(simulation, tmp_path):
    """Whoever keeps the length of a step (another integration here, springs of friction elsewhere) has that of the run,
    not that which a script names after read_restart."""
    words = "pair_style stokes_dynamics cut_off_distance inf visc 1 group slow\npair_coeff * *"
    lines = input_lines(THREE, words.splitlines(), str(tmp_path / "data"), fix=False, box=[(-40.0, 40.0)] * 3, dt=0.1,
                        before_pair="group slow id 1 2\ngroup fast id 3\nvelocity fast set 1 0 0")
    rest = ["fix pull slow addforce 0 0 -1", "fix other fast nve/sphere",
            "fix move slow stokes_dynamics/overdamped adapt 5 1e-3 0.1 10"]
    x = simulation().commands(lines + rest).run(18).x
    simulation().commands(lines + rest + ["run 12", f"write_restart {tmp_path}/half"])
    again = simulation().commands(["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/half",
                                   *words.splitlines()] + rest)
    assert np.abs(again.command("timestep 0.01") or again.run(6).x - x).max() < 1e-12


def test_values_outlive_the_memory_of_the_pair_style(simulation):
    """unfix of the internal fix: no number is read from where it was."""
    sim = simulation(THREE, ALL, fix=False, box=[(-40.0, 40.0)] * 3, dt=0.3)
    sim.commands(weight(THREE)).commands(FIX).run(3)
    assert sim.fix_vector("move")[5] == 4
    sim.command("unfix STOKES_DYNAMICS_STATE")
    assert (sim.fix_vector("move")[3:7] == 0).all()
    assert sim.run(1).fix_vector("move")[5] == 2
