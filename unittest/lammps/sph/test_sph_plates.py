"""Viscous flows of SPH beside closed forms. doc/sph_viscosity.md has the figures of more particles, by
unittest/bench/sph_plates.py."""
import pytest

from sph_plates import cylinders, swinging_plate, two_viscosities, viscosity_in_couette, viscosity_in_poiseuille

LAPLACIAN = dict(pair="laplacian correction yes", h=1.3, kernel="cubicspline")


@pytest.mark.parametrize("flow, scene, expected", [
    (viscosity_in_poiseuille, LAPLACIAN, 0.971), (viscosity_in_couette, LAPLACIAN, 0.997),
    (viscosity_in_poiseuille, dict(pair="central shift yes"), 0.966),
    (viscosity_in_couette, dict(pair="central shift yes"), 0.975),
    (viscosity_in_couette, dict(pair="central correction yes", h=1.5), 0.903)])
def test_the_viscosity_between_plates(flow, scene, expected):
    """Ten across. With laplacian it becomes mu with more; with central it stays at 0.90 where h is 1.5 spacings."""
    assert flow(10, **scene) == pytest.approx(expected, abs=0.01)


def test_two_viscosities_side_by_side():
    """1 to 10, ten across: the layer in which they mix is as thick as h."""
    assert two_viscosities(10, ratio=10, jitter=0, time=6, **LAPLACIAN) < 0.06


@pytest.mark.parametrize("scene, error", [(LAPLACIAN, 0.014), (dict(pair="central shift yes"), 0.017)])
def test_a_plate_that_swings(scene, error):
    assert swinging_plate(5, **scene) == pytest.approx(error, abs=0.003)


def test_slow_flow_past_cylinders():
    """24 across, cylinders of 8.6 spacings; 1.001 with 48."""
    assert cylinders(24, "central shift yes", time=0.5) == pytest.approx(0.966, abs=0.01)
