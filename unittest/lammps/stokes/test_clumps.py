"""Clumps across borders of the box and of ranks; periodic boxes; ghosts that do not reach."""

import numpy as np
import pytest

import model
from system import LammpsError, Spheres, chain, dump_lines, input_lines, largest_difference, lmp, read_dump

ETA, A = 1.3, 0.7
STOKES = 6 * np.pi * ETA * A
EXACT = f"visc {ETA} algorithm 2 relative_tolerance 1e-12"
BOX = [(-6.0, 6.0), (-5.0, 5.0), (-7.0, 7.0)]
TILT = (2.1, -1.4, 1.7)
FORCES = "f_drag[1] f_drag[2] f_drag[3]"


def tetrahedron(centre=(0, 0, 0)):
    """Four overlapping spheres of two radii with their own velocities, 2.3 wide."""
    x = 0.8 * np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], float) + centre
    return Spheres(x, (A, A, 0.8 * A, 1.2 * A), [(0.3, 0, 0.1), (0, -0.2, 0.4), (0.1, 0.1, -0.5), (-0.3, 0.2, 0)],
                   molecule=3)


PLACES = {"face_x": (6, 0, 0), "face_y": (0, 5, 0), "face_z": (0, 0, -7), "edge": (6, 5, 0.3), "corner": (-6, 5, 7)}


@pytest.mark.hard_case("clump across borders of ranks and a periodic box")
@pytest.mark.parametrize("tilt", [None, TILT], ids=["orthogonal", "triclinic"])
@pytest.mark.parametrize("mode", ["clumps_only yes", "clumps_only yes cut_off_distance 4.5", "cut_off_distance 4.5"])
@pytest.mark.parametrize("place", PLACES)
def test_clump_across_a_periodic_border_is_the_clump_in_the_middle(simulation, tilt, mode, place):
    sim = simulation(tetrahedron(PLACES[place]), f"{mode} {EXACT}", boundary="p p p", box=BOX, tilt=tilt,
                     comm="comm_modify cutoff 5").run()
    assert np.ptp(sim.x, axis=0).max() > 5              # it does lie on several sides
    assert largest_difference(sim.drag, model.forces(tetrahedron(), ETA)) < 1e-10


@pytest.mark.hard_case("clump across borders of ranks and a periodic box")
@pytest.mark.parametrize("newton", ["on", "off"])
@pytest.mark.parametrize("tilt", [None, TILT], ids=["orthogonal", "triclinic"])
def test_clump_across_borders_of_ranks_and_box(tmp_path, newton, tilt):
    lines = []
    for place in PLACES:
        lines += input_lines(tetrahedron(PLACES[place]), f"clumps_only yes {EXACT}", tmp_path / f"{place}.data",
                             boundary="p p p", box=BOX,
                             tilt=tilt, comm="comm_modify cutoff 5", newton=newton)
        lines += dump_lines(tmp_path / f"{place}.dump", columns=FORCES) + ["run 0", "clear"]
    lmp(tmp_path, lines, ranks=2)
    for place in PLACES:
        assert largest_difference(read_dump(tmp_path / f"{place}.dump")[0][1],
                                  model.forces(tetrahedron(), ETA)) < 1e-10, place


@pytest.mark.ranks(4)
def test_triclinic_clump_on_four_ranks(tmp_path):
    lines = input_lines(tetrahedron(PLACES["corner"]), f"clumps_only yes {EXACT}", tmp_path / "data", boundary="p p p",
                        box=BOX, tilt=TILT,
                        comm="comm_modify cutoff 5")
    lmp(tmp_path, lines + dump_lines(tmp_path / "dump", columns=FORCES) + ["run 0"], ranks=4)
    assert largest_difference(read_dump(tmp_path / "dump")[0][1], model.forces(tetrahedron(), ETA)) < 1e-10


def test_molecule_zero_is_a_lone_sphere(simulation):
    spheres = tetrahedron()
    spheres.molecule[:] = (3, 0, 3, 0)
    sim = simulation(spheres, f"clumps_only yes {EXACT}", comm="comm_modify cutoff 5").run()
    assert largest_difference(sim.drag, model.forces(spheres, ETA, sees=model.same_clump(spheres))) < 1e-10
    assert np.abs(sim.perturbation[[1, 3]]).max() < 1e-15


def test_molecule_ids_from_a_fix_property_atom(simulation):
    """atom_style sphere has no molecule IDs of its own, and ghosts need not carry them."""
    spheres = tetrahedron(PLACES["face_x"])
    sim = simulation()
    sim.commands(["atom_style sphere", "boundary p p p", "plugin load stokesdynplugin.so",
                  "fix mol all property/atom mol", "region box block -6 6 -5 5 -7 7", "create_box 1 box",
                  "comm_modify cutoff 5"])
    wrapped = spheres.x.copy()
    wrapped[wrapped[:, 0] >= 6, 0] -= 12
    for i in range(spheres.n):
        sim.command("create_atoms 1 single {!r} {!r} {!r}".format(*map(float, wrapped[i])))
        sim.command(f"set atom {i + 1} diameter {float(2 * spheres.a[i])!r} density 1.0 mol {spheres.molecule[i]}")
        sim.command("set atom {} vx {!r} vy {!r} vz {!r}".format(i + 1, *map(float, spheres.v[i])))
    sim.commands([f"pair_style stokes_dynamics clumps_only yes {EXACT}", "pair_coeff * *",
                  "fix drag all stokes_dynamics"]).run()
    assert largest_difference(sim.drag, model.forces(tetrahedron(), ETA)) < 1e-10


def long_chain(box_border):
    return Spheres(chain(6, 2 * A, axis=0).x + (box_border, 0, 0), A, (0.1, 0.2, 0.3), molecule=5)


def test_a_clump_across_the_box_border_needs_no_wider_ghosts(simulation):
    sim = simulation(long_chain(7.0), f"clumps_only yes {EXACT}", boundary="p p p", box=[(-10.0, 10.0)] * 3).run()
    assert largest_difference(sim.drag, model.forces(long_chain(0.0), ETA)) < 1e-10


@pytest.mark.hard_case("ghosts that do not reach across a clump")
def test_a_clump_across_ranks_needs_no_wider_ghosts(tmp_path):
    box = [(-10.0, 10.0), (-3.0, 3.0), (-3.0, 3.0)]
    spheres = long_chain(-4.0)
    lines = input_lines(spheres, f"clumps_only yes {EXACT}", tmp_path / "data", box=box)
    lmp(tmp_path, lines + dump_lines(tmp_path / "dump", columns=FORCES) + ["run 0"], ranks=2)
    assert largest_difference(read_dump(tmp_path / "dump")[0][1], model.forces(spheres, ETA)) < 1e-10


def test_clump_that_turns_through_the_borders_of_its_box(simulation):
    """A rigid chain tumbles; LAMMPS's rigid bodies want ghosts as far as it is wide."""
    spheres = chain(4, 2 * A, axis=0, a=A)
    spheres.v = np.cross((0.4, 0.8, 0.6), spheres.x - spheres.x.mean(axis=0)) + (2.0, 1.0, 3.0)
    sim = simulation(spheres, "clumps_only yes visc 0.01 algorithm 2 relative_tolerance 1e-12",
                     comm=f"comm_modify cutoff {3 * 2 * A + 0.3}",
                     boundary="p p p", box=[(-5.0, 5.0)] * 3, dt=0.01)
    sim.commands("thermo_style custom step\nfix move all rigid/small molecule").run(1500)
    sim.commands("unfix move\nvelocity all set 0.1 -0.2 0.3").run()
    x, d = sim.x, sim.x - sim.x[0]
    assert np.abs(d).max() > 5                          # it lies across a border now
    whole = Spheres(x[0] + d - 10 * np.round(d / 10), A, (0.1, -0.2, 0.3))
    assert largest_difference(sim.drag, model.forces(whole, 0.01)) < 1e-10


def test_clump_wider_than_half_the_periodic_box_is_an_error(simulation):
    spheres = Spheres(chain(5, 2 * A, axis=0).x, A, (0, 0, 0.1), molecule=9)
    sim = simulation(spheres, f"clumps_only yes {EXACT}", boundary="p p p", box=[(-5.0, 5.0), (-9.0, 9.0), (-9.0, 9.0)],
                     comm="comm_modify cutoff 9")
    with pytest.raises(LammpsError, match="molecule 9 is wider than half of the periodic box"):
        sim.run()


def test_clump_wider_than_half_the_periodic_box_on_two_ranks_is_an_error(tmp_path):
    spheres = Spheres(chain(5, 2 * A, axis=0).x, A, (0, 0, 0.1), molecule=9)
    lines = input_lines(spheres, f"clumps_only yes {EXACT}", tmp_path / "data", boundary="p p p",
                        box=[(-5.0, 5.0), (-9.0, 9.0), (-9.0, 9.0)],
                        comm="comm_modify cutoff 9")
    failed = lmp(tmp_path, lines + ["run 0"], ranks=2, succeed=False)
    assert failed.code != 0 and "molecule 9 is wider than half of the periodic box" in failed.log


@pytest.mark.parametrize("lists", ["check yes", "every 1000 delay 0 check no"])
@pytest.mark.parametrize("noise", ["", "temperature 0.01 7"])
def test_a_box_that_shrinks_below_twice_a_clump_is_an_error_in_that_step(simulation, lists, noise):
    """From 10 by 0.1 in a step, along a clump of 4"""
    spheres = Spheres([(3, 5, 5), (5, 5, 5), (7, 5, 5.2), (7, 7.1, 5.2)], molecule=9)
    sim = simulation(spheres, "cut_off_distance inf visc 1 rigid_clumps yes multiblob 12 fluid_velocity box", fix=False,
                     dt=0.01, boundary="p p p", box=[(0.0, 10.0)] * 3, tilt=(0.0, 0.0, 0.0),
                     before_pair=f"comm_modify vel yes\nneigh_modify {lists}")
    sim.commands(f"fix shrink all deform 1 x trate -1.0 remap v\nfix move all stokes_dynamics/overdamped {noise}")
    with pytest.raises(LammpsError, match="molecule 9 is wider than half of the periodic box"):
        sim.run(40)
    assert 20 <= sim.lmp.extract_global("ntimestep") <= 24


# In this box the image of the second sphere across the border in y is closer, and more than half of the box away.
SKEW = dict(boundary="p p p", box=[(-5.0, 5.0)] * 3, tilt=(4.0, 0.0, 0.0))


@pytest.mark.parametrize("cutoff", [2, 6, 9])
def test_clump_whose_closest_images_are_not_those_of_lammps_is_an_error(simulation, cutoff):
    spheres = Spheres([(0, 0, 0), (4.9, 4.0, 0.1)], A, (0, 0, 0.1), molecule=9)
    sim = simulation(spheres, f"clumps_only yes {EXACT}", comm=f"comm_modify cutoff {cutoff}", **SKEW)
    with pytest.raises(LammpsError, match="molecule 9 is wider than half of the periodic box"):
        sim.run()


def test_clump_in_a_skew_box_sees_the_closest_image(simulation):
    """(1.8, -8) as stored; by one cell along the skew edge and one back along x it is (-4.2, 2)."""
    spheres = Spheres([(-0.4, 4.6, 0), (1.4, -3.4, 0.1)], A, (0, 0.2, 0.1), molecule=9)
    open_box = Spheres([(0, 0, 0), (-4.2, 2.0, 0.1)], A, (0, 0.2, 0.1), molecule=9)
    sim = simulation(spheres, f"clumps_only yes {EXACT}", comm="comm_modify cutoff 7", **SKEW).run()
    assert largest_difference(sim.drag, model.forces(open_box, ETA)) < 1e-10


def test_wide_clump_in_an_open_direction_is_no_error(simulation):
    spheres = Spheres(chain(5, 2 * A, axis=0).x, A, (0, 0, 0.1), molecule=9)
    sim = simulation(spheres, f"clumps_only yes {EXACT}", boundary="f p p", box=[(-5.0, 7.0), (-9.0, 9.0), (-9.0, 9.0)],
                     comm="comm_modify cutoff 9").run()
    assert largest_difference(sim.drag, model.forces(spheres, ETA)) < 1e-10


def test_cut_off_wider_than_the_periodic_box_sees_images(simulation):
    """A lone sphere sees its six nearest images: two along the motion, four across."""
    L, v = 8.0, 0.3
    sim = simulation(Spheres([(0, 0, 0)], A, (0, 0, v)), f"cut_off_distance {1.1 * L} {EXACT}", boundary="p p p",
                     box=[(-L / 2, L / 2)] * 3).run()
    f, g = 0.75 / L * (1 + 2 * A**2 / (3 * L**2)), 0.75 / L * (1 - 2 * A**2 / L**2)
    assert sim.drag[0, 2] == pytest.approx(-STOKES * v / (1 + A * (2 * (f + g) + 4 * f)), rel=1e-12)
    assert np.abs(sim.drag[0, :2]).max() < 1e-14 * STOKES


@pytest.mark.parametrize("mode", ["clumps_only yes", "clumps_only yes cut_off_distance 4", "cut_off_distance 2.4"])
def test_skin_and_reneighbouring_leave_the_trajectory_alone(simulation, mode):
    """Two clumps fly apart from overlap; the list is made anew in every step, or once for all of them."""
    trajectories = []
    for neighbour in ("neighbor 0.0 bin\nneigh_modify every 1 delay 0 check no",
                      "neighbor 2.0 bin\nneigh_modify every 1 delay 0 check yes",
                      "neighbor 0.5 bin\nneigh_modify every 1 delay 0 check yes"):
        spheres = Spheres(np.vstack([tetrahedron().x, tetrahedron((3.2, 0.5, 0.3)).x]), A,
                          [(0.5, 0.1, 0)] * 4 + [(-0.9, 0, 0.2)] * 4,
                          molecule=[1] * 4 + [2] * 4)
        sim = simulation(spheres, f"{mode} {EXACT}", boundary="p p p", box=BOX, before_pair=neighbour,
                         comm="comm_modify cutoff 6", dt=0.01)
        sim.command("fix move all nve/sphere")
        sim.run(150)
        trajectories.append(np.hstack([sim.x, sim.v]))
    assert np.abs(trajectories[1] - trajectories[0]).max() < 1e-10
    assert np.abs(trajectories[2] - trajectories[0]).max() < 1e-10
