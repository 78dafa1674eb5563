"""The time step above which drag makes a motion grow: the number that is printed, and what happens beside it."""
import re

import numpy as np
import pytest

import model
from suspensions import A, ALONG, ETA, EXACT, STOKES, flocs, lattice, loose_lattice
from system import Spheres, chain

PAIR = "Pair style stokes_dynamics"


def test_limit_of_a_lone_sphere_is_its_relaxation_time_twice(simulation):
    sim = simulation(Spheres([(0, 0, 0)], A, ALONG), f"cut_off_distance inf visc {ETA} {EXACT}").run()
    if sim.iterations:
        mass = sim.raw("rmass").ravel()[0]
        assert sim.fix_vector()[7] == pytest.approx(1.0) and sim.fix_vector()[8] == pytest.approx(2 * mass / STOKES)


def test_limit_is_that_of_the_smallest_eigenvalue(simulation):
    spheres = loose_lattice(4, v=1.0)
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} {EXACT} precondition none").run()
    smallest = np.linalg.eigvalsh(STOKES * model.mobility(spheres.x, spheres.a, ETA))[0]
    mass = 1.7 * 4 / 3 * np.pi * A**3
    assert sim.fix_vector()[7] == pytest.approx(smallest, rel=1e-3)
    assert sim.fix_vector()[8] == pytest.approx(2 * mass * sim.fix_vector()[7] / STOKES, rel=1e-12)


def smallest_eigenvalue(spheres, rotation):
    """Of the mobility scaled to unit diagonal."""
    M = model.mobility(spheres.x, spheres.a, ETA, rotation=rotation)
    root = np.sqrt(np.diag(M))
    return np.linalg.eigvalsh(M / np.outer(root, root))[0]


@pytest.mark.parametrize("what,rotation", [("cloud", "no"), ("cloud", "yes"), ("flocs", "no")])
@pytest.mark.parametrize("precondition", ["none", "clump", "sparse", "auto"])
def test_eigenvalue_is_right_where_the_solves_do_not_show_it(simulation, what, rotation, precondition):
    """Uniform velocity, a loose tolerance, preconditioners: all hide the smallest eigenvalue from the conjugate
    gradients, whose own estimate is then 2 to 30 times too large."""
    spheres = loose_lattice(5) if what == "cloud" else flocs(6, 20, 14.0)
    spheres.a *= np.random.default_rng(7).uniform(0.9, 1.0, spheres.n)
    spheres.v = np.tile(ALONG, (spheres.n, 1))
    spheres.molecule = np.arange(spheres.n) // 5 + 1 if what == "cloud" else spheres.molecule
    words = f"cut_off_distance inf visc {ETA} algorithm 2 rotation {rotation} precondition {precondition}"
    sim = simulation(spheres, words, dt=1e-2).run()
    expected = smallest_eigenvalue(spheres, rotation == "yes")
    assert (1 - 1e-9) * expected < sim.fix_vector()[7] < 1.2 * expected
    relaxation = min(1.7 * 4 / 3 * np.pi * spheres.a**3 / (6 * np.pi * ETA * spheres.a))
    assert sim.fix_vector()[8] == pytest.approx(2 * relaxation * sim.fix_vector()[7], rel=1e-9)


@pytest.mark.parametrize("factor,stable", [(0.95, True), (1.05, False)])
def test_limit_of_the_time_step_counts_spins(simulation, factor, stable):
    mass, spin = 1.7 * 4 / 3 * np.pi * A**3, 8 * np.pi * ETA * A**3
    limit = 2 * 0.4 * mass * A**2 / spin
    spheres = Spheres([(0, 0, 0), (200, 0, 0)], A)
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} {EXACT} rotation yes", dt=factor * limit,
                     box=[(-300, 300)] * 3)
    sim.raw("omega")[:] = ALONG
    sim.commands(["fix move all nve/sphere"]).run(200)
    assert sim.fix_vector()[8] == pytest.approx(limit, rel=1e-2)
    assert (np.abs(sim.raw("omega")).max() < 0.4) == stable


def row_of_twelve():
    return chain(12, 1.2 * A, a=A, molecule=0)


def unequal_lattice(n=4):
    spheres = lattice(n, v=0.0)
    spheres.a *= np.random.default_rng(3).uniform(0.4, 1.0, spheres.n)
    return spheres


@pytest.mark.parametrize("rotation", ["no", "yes"])
@pytest.mark.parametrize("make,precondition", [(lambda: lattice(5), "none"), (row_of_twelve, "none"),
                                               (lambda: lattice(6), "sparse"), (unequal_lattice, "none")],
                         ids=["lattice", "overlapping", "sparse", "unequal"])
def test_growth_starts_within_a_fifth_of_the_printed_limit(simulation, make, precondition, rotation):
    """Spheres with a breath of velocity and spin, and nothing but drag: below the limit every motion dies, above it one
    grows. Translation and spin of close spheres die together, so the limit is not that of the fastest spin times that
    of the mobility."""
    spheres, rng = make(), np.random.default_rng(5)
    spheres.v = 1e-15 * rng.normal(size=spheres.x.shape)
    spins = 1e-15 / A * rng.normal(size=spheres.x.shape)
    words = (f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-6 max_iter 500 rotation {rotation} "
             f"precondition {precondition}")
    limit, growth = 1e-2, {}
    for factor in (1.0, 1 / 1.2, 1.2):
        sim = simulation(spheres, words, dt=factor * limit)
        sim.raw("omega")[:] = spins
        sim.commands(["fix move all nve/sphere", "thermo_modify lost ignore"])
        if factor == 1.0:
            limit = sim.run(0).fix_vector()[8]
            continue
        largest = []
        for _ in range(2):
            sim.run(40)
            largest.append(max(np.abs(sim.raw("v")).max(), A * np.abs(sim.raw("omega")).max() * (rotation == "yes")))
        growth[factor] = largest[1] / largest[0]
    assert growth[1 / 1.2] < 1.0 < growth[1.2]


@pytest.mark.hard_case("time step above the limit")
@pytest.mark.parametrize("precondition", ["none", "sparse"])
def test_dense_free_cloud_is_stable_below_the_printed_limit_and_not_above(simulation, tmp_path, precondition):
    """No force but drag: the kinetic energy can only fall. Slow spheres, so that a run that blows up stays in its
    box."""
    spheres = loose_lattice(5, v=1e-7)
    words = f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 1e-6 precondition {precondition}"
    energy, warnings, limit = {}, {}, 1e-3
    for factor in (0.0, 0.5, 2.0):
        log = tmp_path / f"log.{factor}"
        sim = simulation(spheres, words, log=log, dt=1e-9 if factor == 0.0 else factor * limit)
        sim.commands(["fix move all nve/sphere", "compute energy all ke", "thermo_style custom step c_energy",
                      "thermo_modify format float %.15g lost ignore", "thermo 1"]).run(15 if factor else 0)
        if factor == 0.0:
            limit = sim.fix_vector()[8]
        sim.close()
        text = log.read_text()
        energy[factor] = np.array([float(e) for e in re.findall(r"^ +\d+ +([-+.0-9e]+) *$", text, re.M)])
        warnings[factor] = [line for line in text.splitlines() if "WARNING" in line and "time step" in line]
    assert limit > 0.0
    assert len(energy[0.5]) == len(energy[2.0]) == 16
    assert (np.diff(energy[0.5]) < 0.0).all()
    assert energy[2.0].max() > 1e6 * energy[2.0][0]
    assert warnings[0.5] == [] and len(warnings[2.0]) == 1
    for word in (PAIR, "time step", "above", "2 m lambda/(6 pi eta a)", "lambda"):
        assert word in warnings[2.0][0]
