"""lubrication yes: pairs against exact resistances, clusters against exact velocities, any ranks, runs in pieces."""
import numpy as np
import pytest

from system import LammpsError, Spheres, dump_lines, input_lines, lmp, read_dump

P6 = 6 * np.pi
FIX = "fix move all stokes_dynamics/overdamped"
ALL = "cut_off_distance inf visc 1.3 rotation yes lubrication yes"


def squeezed(simulation, xi, words=""):
    """Speed at which two unit spheres approach each other under equal and opposite forces 6 pi eta, and the fix's vector"""
    spheres = Spheres([(0, 0, 0), (0.6 * (2 + xi), 0, 0.8 * (2 + xi))])
    sim = simulation(spheres, f"{ALL} relative_tolerance 1e-9 {words}", fix=False)
    push = 1.3 * P6 * np.array((0.6, 0, 0.8))
    for i, sign in ((1, 1), (2, -1)):
        sim.commands(f"group g{i} id {i}\nfix push{i} g{i} addforce " + " ".join(repr(float(c)) for c in sign * push))
    sim.commands(FIX).run(0)
    return (sim.v[0] - sim.v[1]) @ (0.6, 0, 0.8)


@pytest.mark.parametrize("xi", [1e-3, 1e-2, 0.1])
def test_approach_of_two_spheres_is_that_of_the_film_between_them(simulation, xi):
    """Jeffrey & Onishi 1984: XA11 - XA12 = 1/(2 xi) + 9/20 ln(1/xi) + 1.34558 + 3/56 xi ln(1/xi) + O(xi), times 6 pi eta a."""
    resistance = 1 / (2 * xi) + 0.45 * np.log(1 / xi) + 1.34558 + 3 / 56 * xi * np.log(1 / xi)
    assert squeezed(simulation, xi) == pytest.approx(2 / resistance, rel=1e-4 + 0.2 * xi * xi + 0.3 * xi / resistance)


def test_no_film_is_thinner_than_the_floor(simulation):
    floor = squeezed(simulation, 0.01, "lubrication_gap 0.01")
    below = squeezed(simulation, 0.001, "lubrication_gap 0.01")
    assert below == pytest.approx(floor, rel=0.02) and below != squeezed(simulation, 0.001)


def test_film_ends_at_the_range(simulation):
    without = squeezed(simulation, 0.51, "lubrication_range 0.5")
    assert without != pytest.approx(squeezed(simulation, 0.51), rel=0.01)
    assert without == pytest.approx(2 * (1 - 1.5 / 2.51 + 1 / 2.51**3), rel=1e-8)
