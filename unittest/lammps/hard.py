"""What the hard scenes (test_hard_cases.py, test_hard_runs.py) share."""
import numpy as np
import pytest

from system import Spheres
from ways import WAYS

PAIR = "Pair style stokes_dynamics"
U = np.array((0.3, -0.2, 0.4))


def all_ways(test):
    return pytest.mark.parametrize("way", WAYS.values(), ids=list(WAYS))(test)


def directions(rng, shape):
    e = rng.normal(size=shape + (3,))
    return e / np.linalg.norm(e, axis=-1)[..., None]


def cloud(n=20, seed=3):
    """Random spheres of radii 0.4 to 1.2, one clump; most overlap others, and one is hidden."""
    rng = np.random.default_rng(seed)
    spheres = Spheres(rng.uniform(-2, 2, (n, 3)), rng.uniform(0.4, 1.2, n), rng.normal(size=(n, 3)), molecule=1)
    spheres.x[1], spheres.a[1] = spheres.x[0] + 0.1, 0.2
    return spheres


def check(simulation, way, spheres, tolerance, **options):
    """The forces are those of dense algebra, the residual is the one it is said to be."""
    sim = simulation(spheres, way.style(spheres), **options).run()
    answer = way.answer(sim)
    assert way.error(answer, way.forces(spheres), spheres) < tolerance
    assert sim.residual <= 1e-12 and sim.fix_vector()[6] == 0
    return sim
