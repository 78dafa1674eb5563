"""Every case of data/golden.csv through LAMMPS."""
import numpy as np
import pytest

from model import read_table
from system import Spheres, largest_difference

TOLERANCE = 1e-9        # of the largest force of the case; the table has 13 digits
EXACT = "algorithm 2 relative_tolerance 1e-12 max_iter 1000"


def golden_cases():
    cases = {}
    for row in read_table("golden.csv"):
        cases.setdefault(row["case"], []).append(row)
    return cases


CASES = golden_cases()


def columns(name, *keys):
    return np.array([[float(row[key]) for key in keys] for row in CASES[name]])


def spheres_of(name):
    return Spheres(columns(name, "x", "y", "z"), columns(name, "a")[:, 0], columns(name, "vx", "vy", "vz"),
                   columns(name, "clump")[:, 0].astype(int))


def answer(name, which):
    return columns(name, "Fx_" + which, "Fy_" + which, "Fz_" + which)


def eta_of(name):
    return float(CASES[name][0]["eta"])


def reach(spheres):
    """A cut-off larger than the scene."""
    return 1.5 * np.linalg.norm(np.ptp(spheres.x, axis=0)) + 3.0 * spheres.a.max()


def si(name):
    """LAMMPS's default skin is 0.3 lengths, which suits spheres of radius 1 and not of 1e-6."""
    return "neighbor 0.3e-6 bin" if name.startswith("SI") else ""


@pytest.mark.hard_case("golden.csv, SI units among them")
@pytest.mark.parametrize("name", CASES)
def test_every_sphere_sees_every_other(simulation, name):
    spheres = spheres_of(name)
    sim = simulation(spheres, f"cut_off_distance inf visc {eta_of(name)!r} {EXACT}", before_pair=si(name)).run()
    assert largest_difference(sim.drag, answer(name, "all")) < TOLERANCE


@pytest.mark.parametrize("name", CASES)
def test_finite_cut_off_larger_than_the_scene_is_no_cut_off(simulation, name):
    spheres = spheres_of(name)
    sim = simulation(spheres, f"cut_off_distance {float(reach(spheres))!r} visc {eta_of(name)!r} {EXACT}",
                     before_pair=si(name)).run()
    assert largest_difference(sim.drag, answer(name, "all")) < TOLERANCE


@pytest.mark.hard_case("golden.csv, SI units among them")
@pytest.mark.parametrize("name", CASES)
def test_clumps_only_without_cut_off(simulation, name):
    spheres = spheres_of(name)
    sim = simulation(spheres, f"clumps_only yes visc {eta_of(name)!r} {EXACT}",
                     comm=f"comm_modify cutoff {float(reach(spheres))!r}",
                     before_pair=si(name)).run()
    assert largest_difference(sim.drag, answer(name, "clump")) < TOLERANCE


@pytest.mark.parametrize("name", CASES)
def test_clumps_only_with_cut_off_larger_than_the_clumps(simulation, name):
    spheres = spheres_of(name)
    sim = simulation(spheres,
                     f"clumps_only yes cut_off_distance {float(reach(spheres))!r} visc {eta_of(name)!r} {EXACT}",
                     before_pair=si(name)).run()
    assert largest_difference(sim.drag, answer(name, "clump")) < TOLERANCE


def test_both_columns_differ_where_there_are_two_clumps():
    assert largest_difference(answer("two_clumps", "all"), answer("two_clumps", "clump")) > 0.01
