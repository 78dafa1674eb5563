"""Brownian motion above a floor and in a slit, in boxes that are periodic along them: whatever way the noise is
made."""
import numpy as np
import pytest

from system import Spheres
from test_slab import ETA, FLOOR, MOVE, cell, matrix

KT = 0.8
SLIT = "wall zlo 0 zhi 3.5"


def scattered(n, L, H, seed=5):
    """Radius 1, overlaps among them, none with a wall"""
    rng = np.random.default_rng(seed)
    return np.column_stack([rng.uniform(0, L, (n, 2)), rng.uniform(1.02, H - 1.02, n)])


@pytest.mark.parametrize("walls", [FLOOR, SLIT])
def test_modes_have_the_variance_of_the_mobility(simulation, walls):
    """2 kT dt times the eigenvalue, of all modes together to 1.2 % and of each third of them to 2 %, in 2000
    independent steps so short that nothing moves: three times what 120 000 numbers, or a third of them, scatter."""
    n, steps, dt, box, x = 20, 2000, 1e-14, cell(8, -1, 4.5), scattered(20, 8, 3.5)
    style = f"cut_off_distance inf visc {ETA!r} relative_tolerance 1e-4 far_field_tolerance 1e-4 {walls}"
    M = matrix(simulation, x, style, box)
    eigenvalue, mode = np.linalg.eigh(0.5 * (M + M.T))
    assert eigenvalue[0] > 0
    sim = simulation(Spheres(x), style, fix=False, dt=dt, box=box, boundary="p p f")
    sim.commands(f"{MOVE} temperature {KT} 91 noise_tolerance 1e-2 scheme midpoint").run(0)
    d = []
    for _ in range(steps):
        at = sim.x.ravel()
        sim.run(1, "pre no post no")
        d.append(sim.x.ravel() - at)
    share = ((np.array(d) @ mode) ** 2).mean(axis=0) / (2 * KT * dt * eigenvalue)
    assert share.mean() == pytest.approx(1, abs=0.012)
    for third in np.split(share, 3):
        assert third.mean() == pytest.approx(1, abs=0.02)


def steep(z):
    """A soft repulsion by a plane, of a sphere of radius 1 at height z: potential and force"""
    strength, width = 6.0, 0.35
    return strength * width * np.exp((1 - z) / width), f"{strength}*exp((1-({{}}))/{width})"


# Potential at a height, and its force as a formula of LAMMPS
FIELDS = {FLOOR: (lambda z: steep(z)[0] + 0.9 * z, steep(1.0)[1].format("z") + "-0.9", 9.0),
          SLIT: (lambda z: steep(z)[0] +
                 steep(3.5 - z)[0], f"{steep(1.0)[1].format('z')}-{steep(1.0)[1].format('3.5-z')}", 3.5)}


@pytest.mark.parametrize("walls", FIELDS)
def test_heights_stay_those_of_boltzmann(simulation, walls):
    """Spheres that feel each other through the fluid alone begin with heights as Boltzmann has them, and keep their
    mean and the mean square of their gaps to the middle of it, although the mobility across the walls changes with
    height. Of each sphere the mean over the run is one sample."""
    potential, force, top = FIELDS[walls]
    rng, n, L, steps, dt = np.random.default_rng(8), 60, 16.0, 900, 0.04
    z = np.linspace(0.6, top if walls == FLOOR else 2.9, 4001)
    weight = np.exp(-potential(z) / KT)
    weight /= weight.sum()
    mean = (weight * z).sum()
    spread = (weight * (z - mean) ** 2).sum()
    heights = np.interp((rng.permutation(n) + 0.5) / n, np.cumsum(weight), z)      # evenly over the distribution
    x = np.column_stack([rng.uniform(0, L, (n, 2)), heights])
    style = f"cut_off_distance inf visc {ETA!r} relative_tolerance 1e-3 far_field_tolerance 1e-3 {walls}"
    sim = simulation(Spheres(x), style, fix=False, dt=dt, box=cell(L, -1, 40), boundary="p p f")
    sim.commands([f"variable push atom {force}", "fix push all addforce 0 0 v_push",
                  f"{MOVE} temperature {KT} 17 scheme midpoint"])
    seen, products = [], []
    for _ in range(steps // 10):
        sim.run(10, "post no")
        seen.append(sim.x[:, 2].copy())
        products.append(sim.lmp.extract_fix("move", 0, 1, nrow=9))
    seen = np.array(seen)
    for sample, expected in ((seen, mean), ((seen - mean) ** 2, spread)):
        each = sample.mean(axis=0)
        sigma = each.std() / np.sqrt(n)
        assert sigma < (0.06 * np.sqrt(spread) if expected == mean else 0.15 * spread)
        assert each.mean() == pytest.approx(expected, abs=4 * sigma + 0.01 * expected)
    assert np.mean(products) < 25
    print(f"{walls}: mean {seen.mean():.4f} of {mean:.4f}, square {((seen - mean) ** 2).mean():.4f} of {spread:.4f}, "
          f"products {np.mean(products):.1f}")
