"""fix stokes_dynamics/field in boxes that are periodic in two directions: the engine moves specks."""
import numpy as np
import pytest

from host import allowed
from system import LammpsError, Spheres
from test_field import run
from test_slab import MOVE, cell, heap
from test_wall import pull

ETA, H, L = 0.7, 6.0, 11.0
PRESSURE, FLUX = "wall zlo 0 zhi 6", "wall zlo 0 zhi 6 flow flux"
GEOMETRIES = {"floor": "wall zlo 0", "pressure": PRESSURE, "flux": FLUX, "layer": ""}


def scene(way, seed=7):
    spheres, F = heap(seed=seed)
    spheres.x[:, 2] = np.maximum(spheres.x[:, 2], 1.001 * spheres.a)
    F[:, :2] -= F[:, :2].mean(axis=0) if way == "layer" else 0
    return spheres, F


def flow(folder, way, grid, spheres, F, tolerance=1e-6, more="", before=(), **how):
    style = (f"cut_off_distance inf visc {ETA} relative_tolerance 1e-9 far_field_tolerance {tolerance} "
             f"{GEOMETRIES[way]} {more}")
    return run(folder, spheres, style, pull(F) + [*before, MOVE], grid, box=cell(L, -1, 20), boundary="p p f", dt=1e-9,
               **how)


def mean_along(way, z, zj, a, F):
    """Of the forces on an area L x L, at a height z: walls-periodic (1), with the speck's radius 0"""
    shape = zj * (H - zj) - a ** 2 / 3
    per = {"floor": np.minimum(z, zj),
           "layer": -0.5 * abs(z - zj)}.get(way, np.minimum(z, zj) * (H - np.maximum(z, zj)) / H)
    per = per - (way == "flux") * 3 / H ** 3 * z * (H - z) * shape
    return (per[:, None] * F).sum(axis=0) / (ETA * L * L)


@pytest.mark.parametrize("way", GEOMETRIES)
def test_the_mean_in_a_plane_is_that_of_the_forces(tmp_path, way):
    """In a plane that cuts no sphere: its points sum all waves that reach it but for those shorter than their
    distance."""
    x = np.array([(1.0, 2.0, 1.2), (6.0, 3.0, 1.1), (4.0, 8.0, 4.6), (9.0, 9.0, 1.3)])
    a, F = np.array([1.0, 0.5, 0.8, 1.2]), np.array([(1, 0.3, -1), (-0.5, 1, 0.2), (2, -1, 0.4), (0.7, 0.4, 1)])
    F[:, :2] -= F[:, :2].mean(axis=0) if way == "layer" else 0
    z = 3.1
    field, _ = flow(tmp_path, way, f"32 32 1 lo 0 0 {z} hi {L * 31 / 32} {L * 31 / 32} {z}", Spheres(x, a), F)
    mean = field["velocity"].reshape(-1, 3).mean(axis=0)
    assert not field["inside"].any()
    assert mean[:2] == pytest.approx(mean_along(way, z, x[:, 2], a, F[:, :2]), abs=1e-5)
    assert mean[2] == pytest.approx(0, abs=1e-5)      # the mean pressure carries what acts across


@pytest.mark.parametrize("way, top", [("floor", 0.0), ("pressure", H), ("flux", H)])
def test_fluid_rests_at_walls_and_is_not_behind_them(tmp_path, way, top):
    spheres, F = scene(way)
    for z, rests in ((0.0, 0), (top, 0), (-0.5, 0), (0.001, 5e-3), (top - 0.001 if top else 0.001, 5e-3)):
        field, _ = flow(tmp_path, way, f"9 9 1 lo 0 0 {z} hi 9 9 {z}", spheres, F)
        assert np.abs(field["velocity"][field["inside"] == 0]).max() <= rests


@pytest.mark.parametrize("way, more", [*[(way, "") for way in GEOMETRIES], ("floor", "multiblob 12 lubrication yes"),
                                       ("flux", "multiblob 12")])
def test_a_small_sphere_goes_with_the_flow(tmp_path, way, more):
    """But for the second derivatives that it averages over, a^2/6"""
    spheres, F = scene(way)
    if more:
        spheres, F = Spheres([(1, 2, 1.3), (5, 3, 4.4)], [1.0, 0.8]), np.array([(1, 0.4, 0.3), (0.5, 0.2, -1)])
    small, at = 0.1, np.array([(8.3, 6.1, 2.9), (2.2, 9.7, 3.3)])
    x = spheres.x if more else np.array([p for p in spheres.x if np.linalg.norm(at - p, axis=1).min() > 2.2])
    a = spheres.a[:len(x)]
    a, F = np.clip(a, 0.9, 1.0), F[:len(x)]
    x[:, 2] = np.clip(x[:, 2], 1.01 * a, H - 1.01 * a)
    F[:, :2] -= F[:, :2].mean(axis=0) if way == "layer" else 0
    both = Spheres(np.vstack([x, at]), np.append(a, [small] * 2))
    _, rows = flow(tmp_path, way, "1 1 1", both, np.vstack([F, 0 * at]), more=more)
    for k, p in enumerate(at):
        field, _ = flow(tmp_path, way, "1 1 1 lo {0} {1} {2} hi {0} {1} {2}".format(*p), Spheres(x, a), F, more=more)
        assert field["velocity"].ravel() == pytest.approx(rows[len(x) + k, 4:7], abs=2e-3 * np.abs(rows[:, 4:7]).max())
        assert np.abs(rows[len(x) + k, 4:7]).max() > 2e-3


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
@pytest.mark.parametrize("way", GEOMETRIES)
def test_the_error_is_the_tolerance(tmp_path, way, tolerance):
    spheres, F = scene(way)
    grid = f"9 8 7 lo 0 0 0.4 hi {L} {L} 5.7"
    exact, near = (flow(tmp_path, way, grid, spheres, F, tolerance=t)[0] for t in (1e-10, tolerance))
    off = (near["velocity"] - exact["velocity"])[exact["inside"] == 0]
    unit = np.sqrt((F ** 2).sum(axis=1).mean() / 3) / (6 * np.pi * ETA * np.sqrt((spheres.a ** 2).mean()))
    assert np.sqrt((off ** 2).mean()) < tolerance * unit


@pytest.mark.parametrize("way", GEOMETRIES)
def test_ranks_and_periods_do_not_matter(tmp_path, way):
    """Points a period on have the same flow, and a grid whose points are of several ranks and pieces too."""
    spheres, F = scene(way)
    grid = f"5 4 110 lo {-L} 0 0.3 hi {L} {L} 5.9"
    one = flow(tmp_path, way, grid, spheres, F, 1e-4)[0]["velocity"]
    assert one[..., -1, :] == pytest.approx(one[..., 0, :], abs=1e-9)
    for ranks in allowed(2, 4):
        assert flow(tmp_path, way, grid, spheres, F, 1e-4, ranks=ranks)[0]["velocity"] == pytest.approx(one, abs=1e-9)


def test_the_stream_is_added(tmp_path):
    spheres, F = scene("pressure")
    grid = f"9 8 7 lo 0 0 0.4 hi {L} {L} 5.7"
    still = flow(tmp_path, "pressure", grid, spheres, F)[0]
    moving = flow(tmp_path, "pressure", grid, spheres, F, more="fluid_velocity v_u 0 0",
                  before_pair="variable u atom 0.2*z*(6-z)")[0]
    z = still.points()[..., 2]
    outside = still["inside"] == 0
    assert (moving["velocity"] - still["velocity"])[outside] == pytest.approx(
        (np.stack([0.2 * z * (H - z), 0 * z, 0 * z], axis=-1))[outside], abs=1e-9)


@pytest.mark.parametrize("style, boundary, message", [
    ("cut_off_distance inf visc 1 wall zlo 0", "f f f",
     "keyword wall, whose images are not in the flow .* in an open box; make the box periodic along "
     "the wall .boundary p p f."),
    ("cut_off_distance 3 visc 1", "p p f",
     "periodic in 2 of 3 directions: .* in two of them with cut_off_distance inf")])
def test_boxes_without_a_flow_are_named(simulation, style, boundary, message):
    sim = simulation(Spheres([(1, 1, 2)]), style, box=cell(12), boundary=boundary, dt=1e-3)
    with pytest.raises(LammpsError, match=message):
        sim.commands(["fix flow all stokes_dynamics/field 1 flow.*.vti 3 3 3"]).run()
