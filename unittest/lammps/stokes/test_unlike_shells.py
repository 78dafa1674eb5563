"""multiblob with unlike radii: who has how many points, and that nothing depends on ranks, restarts, images or
numbering."""
import os
import re

import numpy as np
import pytest

from host import allowed
from system import LammpsError, Spheres, dump_lines, from_restart, input_lines, lmp, read_dump
from unlike import push

MOVE = "fix move all stokes_dynamics/overdamped"
P6 = 6 * np.pi
SIDE = 6.0


def apart(radii, spacing):
    return np.arange(len(radii))[:, None] * np.array([(spacing, 0.1 * spacing, -0.2 * spacing)])


def points_of(tmp_path, radii, words, succeed=True):
    """How many points the sum is over, as the log says; the log"""
    x = apart(radii, 20.0) % 100.0
    lines = input_lines(Spheres(x, radii), f"cut_off_distance inf visc 1 multiblob {words}",
                        os.path.join(str(tmp_path), "data"), "p p p", [(0.0, 100.0)] * 3, comm="neighbor 0.1 bin",
                        fix=False)
    log = lmp(tmp_path, lines + [MOVE, "run 0"], succeed=succeed).log
    told = re.search(r"Far field by Ewald sums of (\d+)", log)
    return told and int(told.group(1)), " ".join(log.split())


@pytest.mark.parametrize("radii, words, points", [
    ((1, 1.5), "12", (12, 12)), ((1, 1.51), "12", (12, 42)), ((0.4, 1.0), "12", (12, 42)),
    ((1, 2.51, 1.6), "12", (12, 162, 42)), ((0.2, 1.0, 0.3), "12", (12, 162, 12)),
    ((1, 5.1, 2.0, 3.0), "12", (12, 642, 42, 162)), ((1, 10), "12", (12, 642)),
    ((1, 1.5), "42", (42, 42)), ((1, 2.0), "42", (42, 42)), ((1, 3.0), "42", (42, 162)), ((1, 6.0), "42", (42, 642)),
    ((1, 10), "12 multiblob_most 12", (12, 12)), ((1, 10), "12 multiblob_most 42", (12, 42)),
    ((1, 10, 2), "12 multiblob_most 162", (12, 162, 42)),
    ((1, 12), "12 multiblob_most 162", (12, 162)), ((1, 1), "162", (162, 162)), ((1, 4), "162", (162, 162)),
    ((1, 1), "42 half", (42, 42))])
def test_points_go_with_the_radius(tmp_path, radii, words, points):
    assert points_of(tmp_path, radii, words)[0] == sum(points)


def test_all_alike_is_warned_of(tmp_path):
    assert ("WARNING: Pair style stokes_dynamics: keyword multiblob_most: radii from 1 to 1.6: "
            "all spheres have 12 points" in points_of(tmp_path, (1, 1.6), "12 multiblob_most 12")[1])
    for radii, words in (((1, 1.6), "12"), ((1, 1.4), "12 multiblob_most 12")):
        assert "multiblob_most" not in re.sub("pair_style.*?visc 1 [a-z0-9_ ]*", "",
                                              points_of(tmp_path, radii, words)[1])


def test_beyond_one_to_ten_there_is_an_error(simulation):
    sim = simulation(Spheres([(0, 0, 0), (0, 0, 30)], [1.0, 10.1]), "cut_off_distance inf visc 1 multiblob 12")
    with pytest.raises(LammpsError, match="keyword multiblob: radii from 1 to 10.1: larger spheres have more points up "
                                          "to a ratio of 10; use group to select spheres, or multiblob_most 162"):
        sim.run()


RADII = (0.1, 0.17, 0.3, 0.7, 1.0)


@pytest.mark.parametrize("one_body", ["yes", "no"])
def test_lone_spheres_of_every_shell_are_exact(simulation, one_body):
    """Far from each other. Without the addition half shells turn too easily, by 0.4 to 5 %."""
    x, F = apart(RADII, 1e6), np.random.default_rng(3).normal(size=(5, 6))
    sim = simulation(Spheres(x, RADII), f"cut_off_distance inf visc 1.3 multiblob 12 one_body {one_body} "
                                        "relative_tolerance 1e-10", fix=False,
                     dt=1e-9)
    sim.command("fix load all external pf/callback 1 1")

    def push(_, step, nlocal, tags, x, f):
        torque = sim.raw("torque")
        for i in range(nlocal):
            f[i], torque[i] = F[tags[i] - 1, :3], F[tags[i] - 1, 3:]
    sim.lmp.set_fix_external_callback("load", push, None)
    sim.commands([MOVE]).run()
    a = np.array(RADII)[:, None]
    assert np.abs(sim.v / (F[:, :3] / (P6 * 1.3 * a)) - 1).max() < 2e-5
    turns = (np.abs(sim.atom("omega") / (F[:, 3:] / (8 * np.pi * 1.3 * a ** 3)) - 1)).max(axis=1)
    assert turns[0] < 1e-8 and (turns.max() < 1e-8 if one_body == "yes" else turns[1] > 0.04 and
                                0.003 < turns[4] < 0.02)


def test_moments_of_lone_spheres_of_every_shell(simulation, tmp_path):
    sim = simulation(Spheres(apart(RADII, 1e4), RADII),
                     "cut_off_distance inf visc 1.3 multiblob 12 fluid_velocity v_u 0 0 "
                     "relative_tolerance 1e-10", before_pair="variable u atom 0.8*y", fix=False, dt=1e-9)
    sim.commands([MOVE, "compute S all stokes_dynamics/stress"] + dump_lines(f"{tmp_path}/out", columns="c_S[4]")).run()
    volume = 20 / 3 * np.pi * 1.3 * np.array(RADII) ** 3
    assert np.abs(np.abs(last(tmp_path)[:, 0]) / volume - 0.4).max() < 1e-6


def crowd(seed=5, sizes=((1.0, 3), (0.45, 12), (0.25, 40))):
    """Spheres of three sizes at random in a periodic cube, without overlaps; their radii"""
    rng = np.random.default_rng(seed)
    x, a = [], []
    for radius, count in sizes:
        while sum(r == radius for r in a) < count:
            p = rng.uniform(0, SIDE, 3)
            d = np.array(x).reshape(-1, 3) - p
            d -= SIDE * np.round(d / SIDE)
            if not len(x) or (np.linalg.norm(d, axis=1) > 1.02 * (np.array(a) + radius)).all():
                x.append(p)
                a.append(radius)
    return np.array(x), np.array(a)


def script(tmp_path, x, a, words="", before="", molecule=0):
    lines = input_lines(Spheres(x, a, molecule=molecule),
                        f"cut_off_distance inf visc 1 multiblob 12 lubrication yes {words}",
                        os.path.join(str(tmp_path), "data"), "p p p", [(0.0, SIDE)] * 3, comm="neighbor 0.1 bin",
                        fix=False, dt=0.01, before_pair="variable u atom 0.3*sin(z*2*PI/6)\n"
                                                        "compute r all property/atom radius\nvariable w atom -c_r^3")
    return lines + ["fix weight all addforce 0 0 v_w", before or MOVE, "compute S all stokes_dynamics/stress"] + \
        dump_lines("out", columns="vx vy vz omegax omegay omegaz c_S[*]")


def last(tmp_path):
    return read_dump(os.path.join(str(tmp_path), "out"))[-1][1]


def three_sizes(tmp_path, ranks=1, clumps=False, words="", before="", tail=("run 2",), tolerance=1e-9):
    x, a = crowd()
    molecule = [0] * len(a)
    if clumps:    # a small sphere stands on each large one
        molecule[:3], molecule[15:18] = (1, 2, 3), (1, 2, 3)
        x[15:18] = (x[:3] + 1.2 * np.array((0, 0.6, 0.8))) % SIDE
        clear = np.ones(len(a), bool)
        for i in range(15, 18):
            d = x - x[i]
            d -= SIDE * np.round(d / SIDE)
            near = np.linalg.norm(d, axis=1) < 1.02 * (a + a[i])
            near[[i, i - 15]] = False
            clear &= ~near
        x, a, molecule = x[clear], a[clear], [m for m, c in zip(molecule, clear) if c]
        words += " rigid_clumps yes"
    lines = script(tmp_path, x, a,
                   f"fluid_velocity v_u 0 0 relative_tolerance {tolerance} far_field_tolerance 1e-10 {words}", before,
                   molecule)
    lmp(tmp_path, lines + list(tail), ranks)
    return last(tmp_path)


@pytest.mark.parametrize("clumps", [False, True])
def test_three_sizes_do_not_depend_on_ranks(tmp_path, clumps):
    one = three_sizes(tmp_path, 1, clumps)
    for ranks in allowed(2, 4):
        other = three_sizes(tmp_path, ranks, clumps)
        assert np.abs(other - one).max() < 1e-7 * np.abs(one).max()


NOISY = "fix move all stokes_dynamics/overdamped scheme midpoint temperature 0.05 7 noise_tolerance 1e-6"


def test_noise_of_three_sizes_does_not_depend_on_ranks(tmp_path):
    found = [three_sizes(tmp_path, ranks, before=NOISY, tail=("run 1",)) for ranks in (1, 2)]
    assert np.abs(found[1] - found[0]).max() < 1e-4 * np.abs(found[0]).max()


@pytest.mark.parametrize("clumps", [False, True])
def test_three_sizes_go_on_from_a_restart_file(tmp_path, clumps):
    """The forces of all points are in it: without them the solves would begin elsewhere, and end within their tolerance
    elsewhere."""
    whole = three_sizes(tmp_path, 1, clumps, tail=("run 3", "run 2"), tolerance=1e-3)
    three_sizes(tmp_path, 1, clumps, tail=("run 3", "write_restart half.restart"), tolerance=1e-3)
    again = [line for line in script(tmp_path, *crowd()) if not line.startswith("pair_")]
    lmp(tmp_path, from_restart(again) + ["run 2"])
    assert np.abs(last(tmp_path) - whole).max() < 1e-12 * np.abs(whole).max()


def test_who_has_which_shell_is_kept(tmp_path):
    """The smallest sphere goes away: the others keep their points, also from a restart file."""
    x, a = np.array([(1, 1, 1), (3, 3, 3), (5, 5, 1.0)]), (1.0, 0.5, 0.35)
    gone = ["group small id 3", "delete_atoms group small"]
    lines = script(tmp_path, x, a)
    log = lmp(tmp_path, lines + ["run 1", *gone, "run 1", "write_restart half.restart"]).log
    assert re.findall(r"Ewald sums of (\d+)", log) == ["186", "174"]
    again = [line for line in lines if not line.startswith("pair_")]
    assert re.findall(r"Ewald sums of (\d+)", lmp(tmp_path, from_restart(again) + ["run 1"]).log) == ["174"]
    other = [line.replace("visc 1 ", "visc 1.1 ") for line in lines]
    assert re.findall(r"Ewald sums of (\d+)", lmp(tmp_path, from_restart(other) + ["run 1"]).log) == ["54"]


@pytest.mark.parametrize("radii, change, told", [
    ((1, 1), "fix change all deposit 1 1 1 77 region there units box", "radii have come to be from 0.5 to 1 since"),
    ((1, 1), "fix change some adapt 1 atom diameter v_d", "radii have come to be from 1 to 1.6 since"),
    ((1, 2), "fix change some adapt 1 atom diameter v_d", None)], ids=["small one", "growth", "growth of points"])
def test_radii_of_a_run_that_would_have_other_points_are_warned_of(tmp_path, radii, change, told):
    """The deposited sphere has LAMMPS's radius of 0.5. Among unlike radii one that grows gets its points at once."""
    lines = input_lines(Spheres(apart(radii, 20.0), radii), "cut_off_distance inf visc 1 multiblob 12",
                        os.path.join(str(tmp_path), "data"), fix=False,
                        comm="group some id 1\nvariable d equal 2+0.6*step\nregion there block 8 9 4 5 -9 -8")
    lines = [line.replace("hybrid sphere bond", "hybrid sphere 1 bond") for line in lines]
    log = " ".join(lmp(tmp_path, lines + [MOVE, change, "run 2 post no"]).log.split())
    assert log.count("radii have come to be") == (told is not None)
    assert told is None or f"WARNING: Pair style stokes_dynamics: keyword multiblob: {told}" in log


def test_small_shells_of_42_points_are_half_ones_after_a_restart_too(tmp_path):
    lines = [line.replace("multiblob 12", "multiblob 42")
             for line in script(tmp_path, np.array([(1, 1, 1), (3, 3, 3.0)]), (1.0, 0.5))]
    lmp(tmp_path, lines + ["run 1", "write_restart half.restart", "run 1"])
    whole = last(tmp_path)
    lmp(tmp_path, from_restart([line for line in lines if not line.startswith("pair_")]) + ["run 1"])
    assert np.abs(last(tmp_path) - whole).max() < 1e-12 * np.abs(whole).max()


def test_three_sizes_anywhere_in_the_box_and_in_any_order(tmp_path):
    x, a = crowd()
    style = "relative_tolerance 1e-9 far_field_tolerance 1e-10"
    lmp(tmp_path, script(tmp_path, x, a, style) + ["run 0"])
    here = last(tmp_path)
    order = np.random.default_rng(2).permutation(len(a))
    lmp(tmp_path, script(tmp_path, (x[order] + (1.3, -2.2, 0.4)) % SIDE, a[order], style) + ["run 0"])
    assert np.abs(last(tmp_path) - here[order]).max() < 1e-7 * np.abs(here).max()


def test_forces_of_velocities_of_forces_of_three_sizes(simulation):
    """The pair style undoes what the fix does, clumps of unlike members among them."""
    x = np.array([(0, 0, 0), (1.15, 0, 0.3), (0.1, 1.6, 0.2), (0.4, -0.3, 1.45), (-1.3, 0.2, -0.3)])
    a, F = (1.0, 0.17, 0.55, 0.42, 0.3), np.random.default_rng(4).normal(size=(5, 3))
    style = "cut_off_distance inf visc 1 multiblob 12 lubrication yes relative_tolerance 1e-10"
    lines = ["fix own all property/atom d_fx d_fy d_fz"]
    lines += [f"set atom {i + 1} " + " ".join(f"d_f{c} {value!r}" for c, value in zip("xyz", map(float, f)))
              for i, f in enumerate(F)]
    lines += ["compute own all property/atom d_fx d_fy d_fz"] + [f"variable f{c} atom c_own[{d + 1}]"
                                                                 for d, c in enumerate("xyz")]
    spheres = Spheres(x, a)
    sim = simulation(spheres, style, fix=False, dt=1e-9)
    sim.commands(lines + ["fix pull all addforce v_fx v_fy v_fz", MOVE]).run()
    spheres.v, spins = sim.v, sim.atom("omega")
    sim = simulation(spheres, style)
    for i, spin in enumerate(spins):
        sim.set("omega", i + 1, spin)
    sim.run()
    assert np.abs(-sim.fix_rows()[:, :3] - F).max() < 1e-6
    assert np.abs(sim.fix_rows()[:, 6:9]).max() < 1e-6


def test_a_clump_of_unlike_members_falls_as_one_of_finer_shells(simulation):
    found = []
    for words in ("12", "12 multiblob_most 12", "162"):
        sim = simulation(Spheres([(0, 0, 0), (0.8, 0.6 * 1.3, 0.2)], [1.0, 0.35], molecule=1),
                         f"cut_off_distance inf visc 1 multiblob {words} rigid_clumps yes relative_tolerance 1e-9",
                         fix=False, dt=1e-9)
        sim.commands(["fix weight all addforce 0.3 0 -1", MOVE]).run()
        found.append(np.concatenate([sim.v[0], sim.atom("omega")[0]]))
    size = np.linalg.norm(found[2])
    assert np.linalg.norm(found[0] - found[2]) < 2e-3 * size


def resistance(simulation, tmp_path, x, a, words, **options):
    """[6n, 6n]: forces and torques for velocities and spins, by one load after the other"""
    n, path = len(a), os.path.join(str(tmp_path), "moved")
    loads = np.eye(6 * n).reshape(6 * n, n, 6)
    sim = simulation(Spheres(x, a), f"cut_off_distance inf visc 1 multiblob 12 relative_tolerance 1e-11 {words}",
                     fix=False, dt=1e-12, **options)
    push(sim, lambda step: loads[min(step, 6 * n - 1)])
    sim.commands([MOVE] + dump_lines(path, columns="vx vy vz omegax omegay omegaz")).run(6 * n - 1)
    sim.command("undump out")
    return np.linalg.inv(np.array([frame.ravel() for _, frame in read_dump(path)]).T)


def test_films_in_a_slit_are_those_of_lone_pairs_and_of_each_wall(simulation, tmp_path):
    """What films add to the resistance is a sum, also over a periodic border, and of shells of 162 and 12 points."""
    def films(x, a, words="", **options):
        return (resistance(simulation, tmp_path, x, a, words + " lubrication yes", **options) -
                resistance(simulation, tmp_path, x, a, words, **options))

    a = np.array([1.0, 0.35, 0.35])
    x = np.array([(0.6, 4.0, 1.1), (7.5245, 4.0, 2.0025), (4.0, 4.0, 4.62)])
    in_slit = films(x, a, "far_field_tolerance 1e-9 wall zlo 0 zhi 5", boundary="p p f",
                    box=[(0.0, 8.0), (0.0, 8.0), (-0.5, 5.5)])
    alone, box = np.zeros((18, 18)), [(-40.0, 40.0)] * 3
    alone[:12, :12] = films([x[0], x[1] - (8, 0, 0), (30, 0, 0)], a, box=box)[:12, :12]
    for wall, away in (("zlo 0", 30), ("zhi 5", -30)):
        for i in range(3):
            own = slice(6 * i, 6 * i + 6)
            alone[own, own] += films([(0, 0, x[i, 2]), (0, 30, away)], [a[i], 0.35], f"wall {wall}", box=box)[:6, :6]
    assert np.abs(alone[:6, 6:12]).max() > 3 and np.abs(alone[12:, 12:]).max() > 3
    assert np.abs(in_slit - alone).max() < 1e-7 * np.abs(alone).max()
