"""pair_style given again in one input: what follows depends on the last one only, whatever came before."""
import numpy as np
import pytest

from system import Spheres

SETTINGS = ["", "rotation yes", "rotation yes lubrication yes", "multiblob 12 lubrication yes", "multiblob 12 one_body no lubrication yes",
            "multiblob 42 lubrication yes", "multiblob 12", "rotation yes lubrication yes lubrication_gap 0.01", "rigid_clumps yes rotation yes",
            "rigid_clumps yes rotation yes shell 12", "rigid_clumps yes rotation yes shell 42 lubrication yes", "precondition none"]


def cluster():
    places = np.array([(0, 0, 0), (2.1, 0, 0), (0.3, 2.05, 0.2), (-1.4, 0.9, 1.6), (1.3, 1.2, -2.4), (9.0, 1.0, 0.0)])
    return Spheres(places + 20.0, [1.0, 1.0, 1.0, 0.8, 1.1, 1.0], molecule=[1, 1, 0, 0, 0, 0])


def settle(simulation, words, boundary):
    sim = simulation(cluster(), style_of(words), fix=False, dt=1e-9, boundary=boundary, box=[(0.0, 40.0)] * 3)
    return sim.commands(["fix weight all addforce 0.3 -0.2 -1.0", "fix move all stokes_dynamics/overdamped"])


def style_of(words):
    return f"cut_off_distance inf visc 1.3 relative_tolerance 1e-8 far_field_tolerance 1e-9 {words}"


@pytest.mark.parametrize("boundary", ["f f f", "p p p"])
def test_a_pair_style_given_again_is_as_if_it_were_the_first(simulation, boundary):
    fresh = {}
    for words in SETTINGS:
        fresh[words] = settle(simulation, words, boundary).run().v.copy()
    sim = settle(simulation, SETTINGS[-1], boundary).run()
    for words in SETTINGS + SETTINGS[::-1]:
        sim.commands([f"pair_style stokes_dynamics {style_of(words)}", "pair_coeff * *"]).run()
        assert np.abs(sim.v - fresh[words]).max() < 1e-7 * np.abs(fresh[words]).max(), words
