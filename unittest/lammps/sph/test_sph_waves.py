"""Waves on water beside theory. doc/sph_order.md and doc/fix_sph_tension.md have the figures of more particles, by
unittest/bench/sph_waves.py."""
import numpy as np
import pytest

from sph_water_waves import lamb, standing, tension_on_wave
from sph_wave import C0, DX, NX, RHO0, wave


def test_lambs_wave_has_its_limits():
    """Little viscosity: the wave without friction, and 2 nu k^2. Capillary waves: sigma k^3."""
    k, nu = 2 * np.pi, 1e-7
    frequency, damping = lamb(k, 0.5, nu, 0.0)
    assert frequency == pytest.approx(np.sqrt(k * np.tanh(k / 2)), rel=1e-5)
    assert damping == pytest.approx(2 * nu * k * k, rel=2e-3)
    assert lamb(k, 5.0, nu, 1e4)[0] == pytest.approx(np.sqrt(1e4 * k**3), rel=1e-4)


@pytest.mark.parametrize("scene, frequency, damping", [({}, 0.939, 1.15), ({"h": 1.5}, 0.966, 0.85)])
def test_a_standing_wave_rings_as_lamb_has_it(scene, frequency, damping):
    """As far as 16 particles over the wave length can: with 64 the frequency is right within 0.1 %, the damping within
    4 %."""
    found = standing(16, periods=4, **scene)
    assert found[0] == pytest.approx(frequency, abs=0.01)
    assert found[1] == pytest.approx(damping, abs=0.05)


def test_tension_on_a_wave_has_the_right_sum_and_works_as_below_the_surface():
    """Which is why capillary waves are slow in proportion to h: doc/fix_sph_tension.md."""
    for n, work in ((32, 0.861), (64, 0.931)):
        found = tension_on_wave(n)
        assert found[0] == pytest.approx(1.012, abs=0.005)
        assert found[1] == pytest.approx(work, abs=0.005)


@pytest.mark.parametrize("friction, times", [("viscosity {mu} laplacian", 1.0), ("viscosity {mu} central", 3.0),
                                             ("artVisc {alpha} 0 {eta}", 2.9)])
def test_sound_dies_by_the_friction_of_its_divergence(friction, times, tmp_path):
    """Its energy by nu k^2: by the Laplacian once, by the central form, and so by artVisc, whose nu is alpha h c/16,
    three times, as the force is that of a stress with a bulk viscosity."""
    h, nu, k = 2 * DX, 0.01, 2 * np.pi / (NX * DX)
    pair = friction.format(mu=nu * RHO0, alpha=16 * nu / (h * C0), eta=0.01 * h * h)
    t, energies, _ = wave(tmp_path / "data", "nve/sph", 0.2, 320, 1, h=h,
                          extra=f"pair_style sph/artVisc/tensCorr wendland {h} {pair}\npair_coeff * * c {C0}")
    seconds = t[-1] * NX * DX / C0
    assert -np.log(energies[-1] / energies[0]) / (nu * k * k * seconds) == pytest.approx(times, rel=0.03)
