"""Waves on water beside theory. doc/sph_order.md and doc/fix_sph_tension.md have the figures of more particles, by
unittest/bench/sph_waves.py."""
import numpy as np
import pytest

from sph_water_waves import lamb, standing, tension_on_wave


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
