"""Brownian motion of what sees each other as bodies: spheres as shells of points, clumps with shells, films, walls,
held spheres. Covariance of one step against the mobility, Boltzmann's distribution, one run on several ranks and in
pieces."""
import os
import sys

import numpy as np
import pytest

from brownian import (A, END, ETA, KT, SHORT, TIGHT, UNIT, check_covariance, check_pieces, check_ranks, check_same, end,
                      in_a_plane, noise, script, steps_of)
from host import by_open_mpi
from system import Spheres, input_lines, lmp

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "bench"))
import dense_noise  # noqa: E402

INF = f"cut_off_distance inf visc {ETA} relative_tolerance 1e-6"
TRIO = A * np.array([(0, 0, 0), (2.1, 0, 0), (0.4, 2.2, 0.6)])


def mobility(make, count, size, share):
    """[size, size] from velocities under unit forces; share [size, 3 n]: what of the atoms' is a number"""
    N = np.zeros((size, size))
    for k in range(size):
        lines = []
        for d in range(3):
            parts = [f"{share[k, 3 * i + d]:.17g}*(id=={i + 1})" for i in range(count) if share[k, 3 * i + d]]
            lines.append(f"variable load{d} atom {'+'.join(parts) or '0'}")
        sim = make().commands(lines + ["fix push all addforce v_load0 v_load1 v_load2",
                                       "fix move all stokes_dynamics/overdamped"]).run(0)
        N[:, k] = share @ sim.v.ravel()
    return N


def check_step(make, count, share, steps, options=""):
    N = mobility(make, count, len(share), share)
    d = steps_of(noise(make(), options), steps)
    check_covariance(d.reshape(steps, -1) @ share.T, N, SHORT)


SPHERES = np.eye(9)
DUMBBELLS = A * np.array([(0, 0, 0), (0, 0, 2), (2.1, 0.2, 0), (2.2, 2.2, 0)])
CENTRES = np.kron([(0.5, 0.5, 0, 0), (0, 0, 0.5, 0.5)], np.eye(3))


@pytest.mark.parametrize("words, count", [("multiblob 12 lubrication yes", 1000),
                                          ("rotation yes lubrication yes", 2000),
                                          ("multiblob 12 lubrication yes wall zlo -0.8", 500)])
def test_step_of_spheres_has_the_covariance_of_their_mobility(simulation, words, count):
    check_step(lambda: simulation(Spheres(TRIO, A), f"{INF} {words}", fix=False, dt=SHORT), 3, SPHERES, count)


@pytest.mark.parametrize("words", ["rigid_clumps yes shell 12", "rigid_clumps yes multiblob 12 lubrication yes"])
def test_step_of_clumps_has_the_covariance_of_their_mobility(simulation, words):
    check_step(lambda: simulation(Spheres(DUMBBELLS, A, molecule=[1, 1, 2, 2]), f"{INF} {words}", fix=False,
                                  dt=SHORT), 4, CENTRES, 1000)


def test_step_in_a_periodic_box_has_the_covariance_of_the_mobility(simulation):
    """Films through the faces of the box, too"""
    x = TRIO + 0.1
    make = lambda: simulation(Spheres(x % 3.2, A), f"{INF} multiblob 12 lubrication yes far_field_tolerance 1e-4",
                              fix=False, dt=SHORT, boundary="p p p", box=[(0.0, 3.2)] * 3)
    check_step(make, 3, SPHERES, 350)


NOT_POSITIVE = "the near part of the periodic sum has a negative mode"


def test_a_near_part_that_is_not_positive_gives_way_to_the_whole_matrix(simulation, tmp_path):
    """Spheres that overlap by half; it is said once."""
    x, box = (np.array([(1, 2, 1), (1, 2, 1)]) + np.outer((0, 1.145), (0.5**0.5, 0, 0.5**0.5)),
              dict(boundary="p p p", box=[(0.0, 5.0)] * 3))
    words = "cut_off_distance inf visc 1 multiblob 12 relative_tolerance 1e-8 far_field_tolerance 1e-6"
    check_step(lambda: simulation(Spheres(x), words, fix=False, dt=SHORT, **box), 2, np.eye(6), 350,
               "noise_tolerance 1e-6")
    said = []
    for distance in (1.0, 2.0):
        lines = input_lines(Spheres((x - x[0]) * distance + x[0]), words, str(tmp_path / "data"), fix=False, dt=SHORT,
                            **box)
        said.append(lmp(tmp_path, lines + ["fix move all stokes_dynamics/overdamped temperature 0.8 7 "
                                           "noise_tolerance 1e-6", "run 5"]).log.count(NOT_POSITIVE))
    assert said == [1, 0]


def test_held_spheres_stay_and_the_others_feel_it(simulation):
    """The mobility beside spheres that are held is less than that beside free ones."""
    make = lambda: simulation(Spheres(TRIO, A), f"{INF} multiblob 12 lubrication yes", fix=False,
                              dt=SHORT).commands("group some id 2 3")
    share = SPHERES[:3]
    free = mobility(make, 3, 3, share)
    N = np.zeros((3, 3))
    for k in range(3):
        sim = make().commands(["variable one atom id==1",
                               f"fix push all addforce {' '.join('v_one' if d == k else '0' for d in range(3))}",
                               "fix move all stokes_dynamics/overdamped held some"]).run(0)
        N[:, k] = sim.v[0]
    assert (np.linalg.eigvalsh(free - N) > 0.05 * free[0, 0]).all()
    d = steps_of(noise(make(), "held some"), 1200)
    assert (d[:, 1:] == 0).all()
    check_covariance(d[:, 0], N, SHORT)


def test_clumps_in_a_plane_stay_in_it(simulation, tmp_path):
    """They turn about its normal, and their step has the covariance of their mobility in the plane."""
    flat = DUMBBELLS[:, [0, 2, 1]] * (1, 1, 0)
    make = lambda: in_a_plane(simulation, tmp_path, Spheres(flat, A, molecule=[1, 1, 2, 2]),
                              f"{INF} rigid_clumps yes rotation yes", SHORT)
    share = CENTRES[[0, 1, 3, 4]]
    N = mobility(make, 4, 4, share)
    d = steps_of(noise(make()), 1200)
    assert (d[:, :, 2] == 0).all() and np.abs(d[:, 1] - d[:, 0]).max() > 0
    check_covariance(d.reshape(len(d), -1) @ share.T, N, SHORT)


LENGTH = 1e-8


@pytest.mark.parametrize("words, molecule", [("rotation yes lubrication yes wall zlo {}", 0),
                                             ("multiblob 12 lubrication yes", 0),
                                             ("rotation yes rigid_clumps yes", [1, 1, 2, 2]),
                                             ("rigid_clumps yes shell 12 lubrication yes", [1, 1, 2, 2])])
def test_steps_do_not_depend_on_the_unit_of_length(simulation, words, molecule):
    """Spheres of nanometres in metres take the steps that they take in nanometres, by the same random numbers."""
    ends = []
    for unit in (1.0, LENGTH):
        sim = simulation(Spheres(unit * DUMBBELLS, unit * A, molecule=molecule), f"{INF} {words.format(-0.8 * unit)}",
                         fix=False, dt=0.003 * unit**3, box=[(-40.0 * unit, 40.0 * unit)] * 3,
                         before_pair=f"neighbor {0.3 * unit!r} bin")
        noise(sim).run(3)
        ends.append(sim.x / unit)
    assert np.abs(ends[0] - DUMBBELLS).max() > 0.01
    assert np.abs(ends[1] - ends[0]).max() < 1e-7


@pytest.mark.parametrize("step, kT", [(8e-3, 0.2), (1e-3, 0.1)])
def test_no_step_is_too_long_for_films_and_stiff_contacts(step, kT):
    """Volume fraction 0.5; a long step makes spheres overlap more. Long runs: unittest/bench/dense_noise.py"""
    energy, deepest, _, solve, failed = dense_noise.moments(1000.0, 1e-4, 4711, step, 0.15)
    assert failed == 0 and solve < 30 and deepest < 0.15 and 0.2 * kT < energy < 3 * kT


# --- equilibrium ------------------------------------------------------------------------------------------------------

def boltzmann(k, r0):
    """Mean and variance of a bond of energy k/2 (r - r0)^2 in units of kT"""
    r = np.linspace(1e-3, 6, 60001)
    p = r**2 * np.exp(-0.5 * k * (r - r0)**2)
    mean = (p * r).sum() / p.sum()
    return mean, (p * (r - mean)**2).sum() / p.sum()


def lengths_of_bonds(sim, k, r0, runs, steps):
    """[runs, bonds] in radii, every so many steps from equilibrium on; the ends of each bond follow one another"""
    sim.commands(["bond_style harmonic", f"bond_coeff 1 {k / 2!r} {r0 * A!r}", "comm_modify cutoff 8"])
    noise(sim).run(60)
    lengths = []
    for _ in range(runs):
        sim.run(steps, "pre no post no")
        x = sim.x.reshape(-1, 2, 3)
        lengths.append(np.linalg.norm(x[:, 1] - x[:, 0], axis=1) / A)
    return np.array(lengths)


@pytest.mark.parametrize("words, runs", [("rotation yes lubrication yes", 400)])
def test_bonds_between_spheres_with_films_have_boltzmanns_length(simulation, words, runs):
    """Without the drift of the film the mean is 0.27 sigma too short. They are no molecules: within one there are no
    films."""
    count, k = 8, 25 * KT / A**2
    origin = np.array([(p, q, r) for p in (0, 30) for q in (0, 30) for r in (0, 30)], float)
    x = (origin[:, None] + A * np.array([(0, 0, 0), (2.45, 0, 0)])).reshape(-1, 3)
    spheres = Spheres(x, A, bonds=[(2 * i + 1, 2 * i + 2) for i in range(count)])
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} {words}", fix=False, dt=0.1 * UNIT / k,
                     box=[(-90.0, 120.0)] * 3)
    r = lengths_of_bonds(sim, k, 2.45, runs, 20)
    (mean, variance), n = boltzmann(25, 2.45), runs * count * 0.4
    assert (r.mean() - mean) / np.sqrt(variance) == pytest.approx(0, abs=4 / np.sqrt(n))
    assert r.var() == pytest.approx(variance, rel=4 * np.sqrt(2 / n) + 0.01)


def test_stiff_bond_between_multiblobs_with_a_film_has_boltzmanns_length(simulation):
    """A gap of 0.15 and a standard deviation of 0.04 radii, in steps of 0.2 over the rate of the bond. Without the
    drift the mean is 0.16 sigma too short; the scheme's own error is 0.02 sigma of the mean and 5 % of the
    variance."""
    count, k, r0, runs = 8, 625 * KT / A**2, 2.15, 400
    origin = np.array([(p, q, r) for p in (0, 30) for q in (0, 30) for r in (0, 30)], float)
    x = (origin[:, None] + A * np.array([(0, 0, 0), (r0, 0, 0)])).reshape(-1, 3)
    make = lambda dt: simulation(Spheres(x, A, bonds=[(2 * i + 1, 2 * i + 2) for i in range(count)]),
                                 f"cut_off_distance inf visc {ETA} multiblob 12 lubrication yes", fix=False, dt=dt,
                                 box=[(-90.0, 120.0)] * 3)
    apart = make(SHORT).commands(["variable f atom (id%2)*2-1", "fix push all addforce v_f 0 0",
                                  "fix move all stokes_dynamics/overdamped"]).run(0)
    rate = k * (apart.v[0, 0] - apart.v[1, 0])
    r = lengths_of_bonds(make(0.2 / rate), k, r0, runs, 5)
    (mean, variance), n = boltzmann(625, r0), runs * count * 0.5
    assert (r.mean() - mean) / np.sqrt(variance) == pytest.approx(0.02, abs=3 / np.sqrt(n))
    assert r.var() == pytest.approx(1.04 * variance, rel=3 * np.sqrt(2 / n) + 0.01)


# --- one run, in whatever pieces and on however many ranks ------------------------------------------------------------

def close_spheres(n=10, side=18.0, seed=4):
    """Some within the reach of films"""
    rng, x, a = np.random.default_rng(seed), [], []
    while len(x) < n:
        p, r = rng.uniform(0, 7.0, 3), rng.uniform(0.7, 1.0)
        if all(np.linalg.norm((p - q + side / 2) % side - side / 2) > 1.01 * (r + b) for q, b in zip(x, a)):
            x.append(p)
            a.append(r)
    return Spheres((np.array(x) - 2.0) % side, a)


# no two of its poses look alike, and so its shells stand the same after a restart
CROOKED = A * np.array([(0, 0, 0), (2, 0, 0), (3, 1.74, 0), (0.3, 0.4, 1.95)])


def in_few_clumps():
    x = np.vstack([CROOKED, CROOKED[:, [1, 2, 0]] + (2.6, 2.6, 0), A * np.array([(-2.5, 0, 0), (-3, 2.3, 0)])])
    return Spheres((x + (16.0, 3.0, 3.0)) % 18.0, A, molecule=[1] * 4 + [2] * 4 + [0, 0])


def above_a_wall():
    spheres = close_spheres()
    spheres.x[:, 2] = 0.5 * spheres.x[:, 2] - 58.6
    return spheres


SHARP = "cut_off_distance inf visc 1.1 relative_tolerance 1e-12 far_field_tolerance 1e-4 max_iter 400"
CLOSE = 1e-10, 1e-9    # of places in a box of 18 and of velocities of about 5, with films as good as their solve
WAYS = {"shells with films": ("p p p", close_spheres, f"{SHARP} multiblob 12 lubrication yes", TIGHT),
        "clumps of shells": ("p p p", in_few_clumps, f"{SHARP} rigid_clumps yes multiblob 12 lubrication yes", TIGHT),
        "clumps with a shell": ("f f f", in_few_clumps, f"{SHARP} rigid_clumps yes shell 12", TIGHT),
        "above a wall": ("f f f", above_a_wall, f"{SHARP} rotation yes lubrication yes wall zlo EDGE", TIGHT),
        "films": ("p p p", close_spheres, f"{SHARP} rotation yes lubrication yes", TIGHT)}


def test_temperature_0_is_the_run_without(tmp_path):
    """Bit for bit"""
    way = WAYS["shells with films"]
    without = end(tmp_path, script(tmp_path, way, END + ["run 20"], T=None))
    assert (end(tmp_path, script(tmp_path, way, END + ["run 20"], T="0")) == without).all()


def test_a_step_takes_one_solve_and_a_root(simulation):
    sim = noise(simulation(Spheres(TRIO, A), f"{INF} multiblob 12 lubrication yes", fix=False, dt=1e-3)).run(3)
    solves, products, error = (sim.lmp.extract_fix("move", 0, 1, nrow=k) for k in (5, 9, 10))
    assert solves == 1 + 3 and products <= 12 and error < 0.0034


@pytest.mark.parametrize("way", by_open_mpi(WAYS.values()), ids=WAYS)
def test_ranks_and_newton_do_not_matter(tmp_path, way):
    check_ranks(tmp_path, way, *CLOSE)


@pytest.mark.ranks(2)
def test_a_rank_that_has_no_copies_may_be_copied(tmp_path):
    """Two spheres of one rank stand between those of the other, in the box round them, and are copied there; these are
    far from both. A rank that had no copies to refresh for the noise of films left the other waiting."""
    x = A * np.array([(-1.2, 0, 0), (-3.5, 0.3, 0), (1.2, 0, 40.0), (1.2, 0, -40.0)])
    lines = script(tmp_path, ("f f f", lambda: Spheres(x, A), f"{SHARP} multiblob 12 lubrication yes", TIGHT),
                   END + ["run 20"])
    one = end(tmp_path, lines)
    before = next(k for k, line in enumerate(lines) if line.startswith("boundary"))
    check_same(end(tmp_path, [*lines[:before], "processors 2 1 1", *lines[before:]], 2), one, *CLOSE)


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
def test_a_run_in_pieces_is_the_run_in_one(tmp_path, way):
    check_pieces(tmp_path, way, *CLOSE)
