"""What is known of dilute suspensions of hard spheres, from pairs: settling 1 - 6.546 phi, short-time self-diffusion
1 - 1.8315 phi, that of turning 1 - 0.631 phi, and the high-frequency viscosity 1 + 2.5 phi + 5.002 phi^2. And what lone
clumps do not feel of a flow that curves."""
import numpy as np
import pytest

from system import Spheres
from test_brownian_stress import directions
from test_multiblob import MOVE, P6, strained

SHEARS = [np.diag((1.0, -1.0, 0.0)), np.diag((1.0, 1.0, -2.0))]
SHEARS += [np.outer(a, b) + np.outer(b, a) for a, b in zip(np.eye(3), np.roll(np.eye(3), 1, axis=0))]


def traces(simulation, r, h, words):
    """Of two spheres at the distance r along h, over those of a lone one: of the mobility of one, of one by the other,
    of the turns of one; and the mean first moment of both in five strains. Each less what it is far away."""
    spheres, words = Spheres(np.outer([0.0, r], h)), f"multiblob {words} lubrication yes"
    sim = simulation(spheres, f"cut_off_distance inf visc {1 / P6!r} {words} relative_tolerance 1e-8", fix=False,
                     dt=1e-9)
    names = [kind + axis for kind in "ft" for axis in "xyz"]
    sim.commands([f"variable {name} equal 0" for name in names] +
                 ["group one id 1", "fix pull one addforce v_fx v_fy v_fz", f"{MOVE} torque one v_tx v_ty v_tz"])
    moved = []
    for name in names:
        sim.command(f"variable {name} equal 1")
        v, w = sim.run().v, sim.atom("omega") * 4 / 3
        moved.append((v[0], v[1]) if name[0] == "f" else (w[0], w[1]))
        sim.command(f"variable {name} equal 0")
    moved = np.array(moved)
    own, other = (sum(moved[k, s, k] for k in range(3)) for s in (0, 1))
    turn = sum(moved[3 + k, 0, k] for k in range(3))
    moment = np.mean([strained(simulation, spheres, E, words)[1] / 2 for E in SHEARS])
    return np.array([own - 3, other - 3 / r, turn - 3, moment - 1])


def dilute(simulation, h, words):
    """Settling, self-diffusion, that of turning; coefficient of phi^2: integrals of traces over all distances, by Gauss
    in the third root of the gap up to 4 radii, and in 4 over the distance beyond (Batchelor 1972, 1976)"""
    t, weight = np.polynomial.legendre.leggauss(6)
    t, weight = (1 + t) / 2, weight / 2
    near = sum(w * 6 * q**2 * (2 + 2 * q**3)**2 * traces(simulation, 2 + 2 * q**3, h, words) for q, w in zip(t, weight))
    far = sum(w * 64 / q**4 * traces(simulation, 4 / q, h, words) for q, w in zip(t, weight))
    own, other, turn, moment = near + far
    return np.array([own + other - 5, own, turn, 2.5 + 7.5 * moment])


@pytest.mark.parametrize("words, count, margins", [("12", 4, (0.02, 0.015, 0.02, 0.25)),
                                                   ("42 half", 1, (0.004, 0.004, 0.006, 0.05))])
def test_coefficients_of_dilute_suspensions(simulation, words, count, margins):
    """Batchelor (1972, 1976), Jones (1989), Cichocki & Felderhof (1988). Films make the last 5 % of self-diffusion,
    20 % of that of turning, and 13 % of the viscosity."""
    found = np.mean([dilute(simulation, h, words) for h, _ in directions(count)], axis=0)
    assert (np.abs(found - (-6.546, -1.8315, -0.631, 5.002)) < margins).all()


# --- a flow that curves -----------------------------------------------------------------------------------------------

@pytest.mark.parametrize("n, alone, among", [(1, 0.1667, 0.1667), (2, 0.295, 0.177), (3, 0.501, 0.182),
                                             (5, 1.10, 0.161), (10, 3.43, 0.095)])
def test_what_chains_across_a_parabola_do_not_feel(simulation, n, alone, among):
    """Numbers of the page on clumps, in a^2 u'': how much slower they are than shells of all spheres, which are slower
    than the flow at a lone sphere by Faxen's a^2/6 u''"""
    chain = Spheres(np.outer(2 * np.arange(n) - n + 1.0, (0, 0, 1)), molecule=1)

    def speed(words):
        sim = simulation(chain, f"{words} rigid_clumps yes visc 1 fluid_velocity v_u 0 0 relative_tolerance 1e-9",
                         before_pair="variable u atom 1-z*z/2", fix=False, dt=1e-9)
        return 1 - sim.commands(MOVE).run().v[:, 0].mean()

    felt = speed("cut_off_distance inf multiblob 42 half")
    assert n > 1 or felt == pytest.approx(1 / 6, abs=1e-9)
    assert felt - speed("clumps_only yes shell 42") == pytest.approx(alone, rel=0.01)
    assert felt - speed("cut_off_distance inf shell 42") == pytest.approx(among, rel=0.01)
