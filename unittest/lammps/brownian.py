"""Scenes and runs of Brownian motion for the tests of fix stokes_dynamics/overdamped with a temperature."""
import os

import numpy as np
import pytest

from host import allowed
from system import Spheres, dump_lines, from_restart, input_lines, lmp, lmp_in_turn, read_dump

P6 = 6 * np.pi
ETA, A, KT = 1.3, 0.7, 0.8
UNIT = P6 * ETA * A
SHORT = 1e-11 * A**2 * UNIT / KT    # nothing moves in such a step


def noise(sim, options="", kT=KT, seed=12345, fix="move"):
    return sim.commands(f"fix {fix} all stokes_dynamics/overdamped temperature {kT!r} {seed} {options}")


def steps_of(sim, steps):
    """Displacements [steps, n, 3] of single steps"""
    out = []
    for k in range(steps):
        x = sim.x
        sim.run(1, "pre no post no" if k else "post no")
        out.append(sim.x - x)
    return np.array(out)


def copies(shape, count, spacing=12.0):
    """So many of a shape, each a molecule of its own, on a lattice"""
    k, side = np.arange(count), int(np.ceil(count**(1 / 3)))
    origin = spacing * np.column_stack([k % side, k // side % side, k // side**2])
    return Spheres((origin[:, None, :] + shape).reshape(-1, 3), A, molecule=np.repeat(k + 1, len(shape)))


def check_covariance(d, expected, dt, sigmas=4.5):
    """Samples d [n, k] of displacements against 2 kT dt times expected"""
    C = d.T @ d / len(d) / (2 * KT * dt)
    sigma = np.sqrt((np.outer(np.diag(expected), np.diag(expected)) + expected**2) / len(d))
    assert np.abs((C - expected) / sigma).max() < sigmas


TRIO = A * np.array([(0, 0, 0), (2.5, 0, 0), (0.4, 2.3, 0.6)])


L_OF_FOUR = A * np.array([(0, 0, 0), (2, 0, 0), (4, 0, 0), (0, 2, 0)])


def in_a_plane(simulation, tmp_path, spheres, words, dt):
    """In a plane of an unbounded fluid: z is held, and the mobility of x and y has a divergence."""
    side = spheres.x[:, :2].max() + 20.0
    lines = input_lines(spheres, words, os.path.join(str(tmp_path), "plane.data"), fix=False, dt=dt, boundary="f f p",
                        box=[(-20.0, side), (-20.0, side), (-0.5, 0.5)])
    return simulation().commands(["dimension 2"] + lines)


def scattered(n=40, side=18.0, seed=4):
    """Spheres of several sizes that do not overlap by more than a tenth, and at last three clumps of four"""
    rng, x, a = np.random.default_rng(seed), [], []
    while len(x) < n:
        p, r = rng.uniform(0, side, 3), rng.uniform(0.6, 1.0)
        if all(np.linalg.norm((p - q + side / 2) % side - side / 2) > 0.9 * (r + b) for q, b in zip(x, a)):
            x.append(p)
            a.append(r)
    return Spheres(x, a)


def in_clumps():
    spheres = copies(L_OF_FOUR, 9, 6.0)
    spheres.x += 3.0
    spheres.molecule[32:] = 0
    return spheres


MOVE = "fix move all stokes_dynamics/overdamped temperature {} {}"
TIGHT = " noise_tolerance 3e-12"    # of the root, and of the solve with noise


def script(folder, way, runs, newton="on", T="v_T", seed=7):
    """way: boundary, scene, words of the pair style, and of the fix"""
    boundary, make, words, options = way
    lines = input_lines(make(), words, os.path.join(str(folder), "spheres.data"), fix=False, boundary=boundary,
                        newton=newton, dt=0.02, box=[(0.0, 18.0)] * 3 if boundary[0] == "p" else [(-60.0, 60.0)] * 3)
    move = MOVE.format(T, seed) + options if T is not None else MOVE.split(" temp")[0] + options.replace(TIGHT, "")
    return lines + ["variable T equal 1.5+step/100", "variable fx atom 0.3*sin(id)", "fix pull all addforce v_fx 0 -2",
                    move] + runs


def end(folder, lines, ranks=1):
    lmp(folder, lines, ranks)
    return read_dump(os.path.join(str(folder), "end.dump"))[-1][1]


def ends(folder, inputs):
    """Of several inputs in one start"""
    lmp_in_turn(folder, [[line.replace("end.dump", f"end.{k}.dump") for line in lines]
                         for k, lines in enumerate(inputs)])
    return [read_dump(os.path.join(str(folder), f"end.{k}.dump"))[-1][1] for k in range(len(inputs))]


END = dump_lines("end.dump", every=20, columns="xu yu zu vx vy vz")
# velocities beyond that of the fluid: in a box that is sheared LAMMPS adds to v what the other side of a face has more,
# when it makes its lists
BEYOND = dump_lines("end.dump", every=20, columns="xu yu zu f_move[1] f_move[2] f_move[3]")


def check_same(one, other, of_x, of_v):
    assert np.abs(one - other)[:, :3].max() < of_x
    assert np.abs(one - other)[:, 3:].max() < of_v


def check_ranks(folder, way, of_x=1e-10, of_v=1e-10, END=END):
    one, other, still = ends(folder, [script(folder, way, END + ["run 20"], **how)
                                      for how in ({}, {"seed": 8}, {"T": "0"})])
    for ranks, newton in allowed((2, "on"), (4, "off")):
        check_same(end(folder, script(folder, way, END + ["run 20"], newton), ranks), one, of_x, of_v)
    assert np.abs(other - one)[:, :3].max() > 0.1 and np.abs(still - one)[:, :3].max() > 0.1


def in_pieces(folder, make, END=END):
    """Ends of a run of 20 steps, of the same in two pieces, and of one that goes on from a restart file. make(lines):
    the input that ends in these"""
    def named(name, runs):
        return make([line.replace("end.dump", f"{name}.dump") for line in END] + runs)

    lmp_in_turn(folder, [named("whole", ["run 20"]), named("two", ["run 7", "run 13"]),
                         make(["run 7", "write_restart half.restart"]), from_restart(named("again", ["run 13"]))])
    return [read_dump(os.path.join(str(folder), f"{name}.dump"))[-1][1] for name in ("whole", "two", "again")]


def check_pieces(folder, way, of_x=1e-10, of_v=1e-10, END=END):
    """A run in two, and one that goes on from a restart file"""
    whole, two, again = in_pieces(folder, lambda runs: script(folder, way, runs), END)
    check_same(two, whole, of_x, of_v)
    check_same(again, whole, of_x, of_v)


def check_heights(simulation, side, model, options):
    """side^2 spheres apart above a floor, in a trap of 25 kT/a^2 at 1.9 a and with a weight of 0.5 kT/a, stand as
    Boltzmann says: mean height 1.88 a, sigma 0.2 a; without the drift 0.11 sigma lower. Returns the simulation at its
    end."""
    count, K = side**2, 25 * KT / A**2
    k = np.arange(count)
    x = np.column_stack([25.0 * A * (k % side), 25.0 * A * (k // side), 0 * k + 1.88 * A])
    sim = simulation(Spheres(x, A), f"cut_off_distance inf visc {ETA} {model} wall zlo 0", fix=False,
                     dt=0.12 * UNIT / K, box=[(-40.0, 170.0), (-40.0, 170.0), (-1.0, 60.0)])
    sim.commands(f"variable fz atom {K!r}*({1.9 * A!r}-z)-{0.5 * KT / A!r}\nfix trap all addforce 0 0 v_fz")
    noise(sim, options).run(60)
    z = []
    for _ in range(60):
        sim.run(20, "pre no post no")
        z.append(sim.x[:, 2] / A)
    z, n = np.array(z), 60 * count * 0.8
    assert (z.mean() - 1.88) / 0.2 == pytest.approx(0, abs=4 / np.sqrt(n) + 0.003)
    assert z.var() == pytest.approx(0.04 * 1.008, rel=4 * np.sqrt(2 / n) + 0.005)
    return sim
