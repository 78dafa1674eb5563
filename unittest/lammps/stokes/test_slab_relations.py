"""Boxes that are periodic in two directions: one scene in another way, through LAMMPS; and scenes that there are none
of, on every rank."""
import re

import numpy as np
import pytest

from host import allowed, by_open_mpi
from system import LammpsError, Spheres, dump_lines, input_lines, lmp, read_dump
from test_slab import FLOOR, MOVE, cell, fall, heap, matrix
from test_wall import pull

L, H = 11.0, 6.0
TIGHT = "cut_off_distance inf visc 0.7 far_field_tolerance 1e-12 relative_tolerance 1e-10"
SHELLS = "cut_off_distance inf visc 0.7 far_field_tolerance 1e-9 relative_tolerance 1e-11 multiblob 12 lubrication yes"
PRESSURE, FLUX = "wall zlo 0 zhi 6", "wall zlo 0 zhi 6 flow flux"
GEOMETRIES = {"floor": FLOOR, "pressure": PRESSURE, "flux": FLUX, "layer": ""}


def scene(way, shells=False):
    spheres, F = heap(5 if shells else 14)
    F[:, :2] -= F[:, :2].mean(axis=0) if way == "layer" else 0
    return spheres, F


def same(got, expected, off):
    assert got == pytest.approx(expected, abs=off * np.abs(expected).max())


def test_a_second_wall_far_away_is_none(simulation):
    """Forces along the walls without a moment about the floor leave the fluid up there at rest; others move it as z
    z'/H says."""
    spheres, F = scene("floor")
    z = np.maximum(spheres.x[:, 2], spheres.a)
    floor, slit = (fall(simulation, spheres, F, f"{TIGHT} {walls}", cell(L, -1, 61)).v
                   for walls in (FLOOR, "wall zlo 0 zhi 60"))
    drift = z[:, None] * (z[:, None] * F[:, :2]).sum(axis=0) / (60 * 0.7 * L * L)
    same(slit[:, :2] + drift, floor[:, :2], 1e-10)
    same(slit[:, 2], floor[:, 2], 1e-10)


def test_a_floor_far_away_is_a_plane_of_symmetry(simulation):
    """In a periodic box of height 300 with mirror images of the opposite sign: waves along the floor do not reach it,
    and in the mean the fluid rests there and at 150, half a period on."""
    spheres, F = heap()
    x, z = spheres.x + (0, 0, 40), 40 + spheres.x[:, 2]
    floor = fall(simulation, Spheres(x, spheres.a), F, f"{TIGHT} {FLOOR}", cell(L, -1, 60)).v
    both = Spheres(np.vstack([x, x * (1, 1, -1)]), np.tile(spheres.a, 2))
    v = fall(simulation, both, np.vstack([F, F * (-1, -1, 1)]), TIGHT, [(0.0, L), (0.0, L), (-150.0, 150.0)],
             "p p p").v[:len(x)]
    v[:, :2] += z[:, None] * (z[:, None] * F[:, :2]).sum(axis=0) / (150 * 0.7 * L * L)
    same(v, floor, 1e-10)


@pytest.mark.parametrize("style", [TIGHT, SHELLS])
@pytest.mark.parametrize("way", ["pressure", "flux"])
def test_a_slit_upside_down(simulation, way, style):
    spheres, F = scene(way, style is SHELLS)
    up = fall(simulation, spheres, F, f"{style} {GEOMETRIES[way]}", cell(L, -1, 7)).v
    down = fall(simulation, Spheres(spheres.x * (1, 1, -1) + (0, 0, H), spheres.a), F * (1, 1, -1),
                f"{style} {GEOMETRIES[way]}", cell(L, -1, 7)).v
    same(down * (1, 1, -1), up, 1e-10 if style is TIGHT else 1e-2)      # the 12 points are not turned over with it


@pytest.mark.parametrize("way, style", [*[(way, TIGHT) for way in GEOMETRIES], ("floor", SHELLS), ("flux", SHELLS)])
def test_two_cells_side_by_side_are_one(simulation, way, style):
    spheres, F = scene(way, style is SHELLS)
    one = fall(simulation, spheres, F, f"{style} {GEOMETRIES[way]}", cell(L, -1, 9)).v
    both = Spheres(np.vstack([spheres.x, spheres.x + (0, L, 0)]), np.tile(spheres.a, 2))
    two = fall(simulation, both, np.vstack([F, F]), f"{style} {GEOMETRIES[way]}",
               [(0.0, L), (0.0, 2 * L), (-1.0, 9.0)]).v
    same(two, np.vstack([one, one]), 1e-10 if style is TIGHT else 1e-6)


@pytest.mark.parametrize("way, style", [*[(way, TIGHT) for way in GEOMETRIES], ("flux", SHELLS)])
def test_nothing_depends_on_a_shift_along_the_walls(simulation, way, style):
    spheres, F = scene(way, style is SHELLS)
    here = fall(simulation, spheres, F, f"{style} {GEOMETRIES[way]}", cell(L, -1, 9)).v
    x = spheres.x + (3.77, 6.13, 0)
    x[:, :2] %= L
    there = fall(simulation, Spheres(x, spheres.a), F, f"{style} {GEOMETRIES[way]}", cell(L, -1, 9)).v
    same(there, here, 1e-10 if style is TIGHT else 1e-7)


def test_flux_less_pressure_is_of_rank_one_in_each_direction(simulation):
    x = [(1.0, 1.0, 1.2), (3.1, 4.0, 1.9), (6.0, 2.0, 4.1)]
    free, closed = (matrix(simulation, x, f"{TIGHT} {walls}", cell(L, -1, 9)) for walls in (PRESSURE, FLUX))
    off = (free - closed).reshape(3, 3, 3, 3)               # sphere, component, sphere, component
    shape = np.array([z * (H - z) - 1 / 3 for _, _, z in x])
    expected = 3 / (0.7 * L * L * H ** 3) * np.outer(shape, shape)
    for d in range(3):
        for e in range(3):
            assert off[:, d, :, e] == pytest.approx(expected if d == e < 2 else np.zeros((3, 3)), abs=1e-11)


@pytest.mark.parametrize("way, style", by_open_mpi([("flux", SHELLS), *[(way, TIGHT) for way in GEOMETRIES]], but=2,
                                                   several=True))
def test_velocities_are_those_of_one_rank(tmp_path, way, style):
    spheres, F = scene(way, style is SHELLS)

    def v(ranks):
        lines = input_lines(spheres, f"{style} {GEOMETRIES[way]}", str(tmp_path / "data"), boundary="p p f", fix=False,
                            dt=1e-9, box=cell(L, -1, 9))
        lmp(tmp_path, lines + pull(F) + [MOVE] + dump_lines("v.dump", 1, "vx vy vz f_move[4]") + [
            "variable p equal f_move[13]", "thermo_style custom step v_p", "thermo_modify format float %.15g", "run 0"],
            ranks)
        return read_dump(str(tmp_path / "v.dump"))[-1][1]
    one = v(1)
    for ranks in allowed(2, 4):
        same(v(ranks), one, 1e-10)


# --- what there is no answer for --------------------------------------------------------------------------------------

@pytest.mark.parametrize("lines, message", [
    (["change_box all triclinic", "fix g all deform 1 xy erate 0.1 remap v"],
     "fix g of style deform changes the box, and in a slit, periodic along it"),
    (["fix g all deform 1 z scale 1.1"], "fix g of style deform changes the box"),
    (["fix g all press/berendsen x 1 1 10"],
     "fix g of style press/berendsen changes the box, .* boxes must stay as they are: leave it out, or use "
     "boundary p p p without wall"),
])
def test_a_box_that_changes_is_named(simulation, lines, message):
    sim = simulation(Spheres([(1, 1, 2)]), f"cut_off_distance inf visc 1 {PRESSURE}", box=cell(12, 0, 6),
                     boundary="p p f", fix=False, dt=0.1)
    with pytest.raises(LammpsError, match=message):
        sim.commands([*lines, MOVE]).run()


def test_a_box_may_change_between_runs(simulation):
    spheres, F = heap()
    style = f"{TIGHT} {PRESSURE}"
    there = fall(simulation, spheres, F, style, cell(13, -1, 9)).v
    sim = fall(simulation, spheres, F, style, cell(11, -1, 9))
    same(sim.commands(["change_box all x final 0 13 y final 0 13"]).run().v, there, 1e-10)


def test_spheres_that_cut_either_wall_are_counted(tmp_path):
    """They move as if they touched it."""
    lines = input_lines(Spheres([(1, 1, 0.97), (4, 4, 3), (8, 3, 5.02)]), f"cut_off_distance inf visc 1 {PRESSURE}",
                        str(tmp_path / "data"), fix=False, box=cell(12, -1, 7), boundary="p p f", dt=1e-3)
    for ranks in (1, *allowed(2)):
        log = lmp(tmp_path, lines + [MOVE, "run 2"], ranks).log
        assert log.count(
            "keyword wall: 2 spheres cut the wall zlo at 0, or zhi at 6: they move as if they touched it") == 1


@pytest.mark.parametrize("words, lines, message", [
    ("wall zlo 2.5", [], "the centre of atom 1, radius 1, is 0.5 behind the wall zlo at 2.5"),
    ("wall zlo 1.5 zhi 3.4", [], "does not fit between zlo at 1.5 and zhi at 3.4: the walls must be at least 2 apart"),
    ("", ["fix push all addforce 1 0 0"], "the forces along x add up to 2: .* or forces that add up to 0"),
    ("wall zlo 0", ["set atom 2 diameter 0.1"], "the largest radius must be at most 10 times the smallest"),
    ("wall zlo 0 rotation yes", [], "torques of one-point spheres are not summed: use multiblob 12"),
    ("wall zlo 0 zhi 9 fluid_velocity 0 0 v_u", [], "nothing flows through the wall zhi at 9"),
])
def test_every_rank_ends_with_the_error(tmp_path, words, lines, message):
    script = input_lines(Spheres([(1, 1, 2), (10, 10, 2.2)]), f"cut_off_distance inf visc 1 {words}",
                         str(tmp_path / "data"), fix=False, box=cell(12, -1, 13), boundary="p p f", dt=1e-3,
                         before_pair="variable u atom z")
    for ranks in (1, *allowed(2)):
        done = lmp(tmp_path, script + lines + [MOVE, "run 0"], ranks, succeed=False)
        assert done.code != 0 and re.search(message, " ".join(done.text.split())), done.text[-1500:]
