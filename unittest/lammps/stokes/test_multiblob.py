"""multiblob: spheres as shells of points, through LAMMPS, against unittest/data/multiblob and against each other."""
import csv
import os
import pathlib
import re
import sys

import numpy as np
import pytest

import model
from system import LammpsError, Spheres, dump_lines, input_lines, lmp, read_dump

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "examples"))
import flow_grid    # noqa: E402

MOVE = "fix move all stokes_dynamics/overdamped"
P6 = 6 * np.pi


def rows_of(name, **wanted):
    path = os.path.join(model.DATA, "multiblob", name)
    rows = csv.DictReader(line for line in open(path) if not line.startswith("#"))
    return [row for row in rows if all(row[key] == value for key, value in wanted.items())]


def columns(rows, names):
    return np.array([[float(row[name]) for name in names.split()] for row in rows])


def pull(F):
    """A force of its own on every sphere"""
    lines = ["fix own all property/atom d_fx d_fy d_fz"]
    lines += [f"set atom {i + 1} " + " ".join(f"d_f{c} {value!r}" for c, value in zip("xyz", map(float, f)))
              for i, f in enumerate(F)]
    return lines + ["compute own all property/atom d_fx d_fy d_fz"] + [f"variable f{c} atom c_own[{d + 1}]"
                                                                       for d, c in enumerate("xyz")] + \
        ["fix pull all addforce v_fx v_fy v_fz"]


def fall(simulation, spheres, F, style, **options):
    sim = simulation(spheres, f"cut_off_distance inf visc 1 multiblob {style}", fix=False, dt=1e-9, **options)
    return sim.commands(pull(F) + [MOVE]).run()


def off(v, w):
    return np.linalg.norm(v - w) / np.linalg.norm(w)


@pytest.mark.parametrize("points", [12, 42])
def test_lone_sphere_is_exact(simulation, points):
    eta, a, F, spin = 1.3, 0.7, np.array((0.3, -1.0, 2.0)), np.array((0.2, 0.1, -0.4))
    sim = simulation(Spheres([(1, 2, 3)], a),
                     f"cut_off_distance inf visc {eta} multiblob {points} relative_tolerance 1e-10", fix=False,
                     dt=1e-9)
    sim.commands([f"fix pull all addforce {F[0]} {F[1]} {F[2]}", MOVE]).run()
    assert np.abs(sim.v[0] - F / (P6 * eta * a)).max() < 1e-10
    sim = simulation(Spheres([(1, 2, 3)], a, F),
                     f"cut_off_distance inf visc {eta} multiblob {points} relative_tolerance 1e-10")
    sim.set("omega", 1, spin)
    sim.run()
    assert np.abs(sim.fix_rows()[0, :3] / (-P6 * eta * a) - F).max() < 1e-9
    assert np.abs(sim.fix_rows()[0, 6:9] / (-8 * np.pi * eta * a ** 3) - spin).max() < 1e-9


def test_lone_sphere_turns_with_half_the_rate_of_a_shear(simulation):
    sim = simulation(Spheres([(1, 2, 3)]),
                     "cut_off_distance inf visc 1 multiblob 12 fluid_velocity v_u 0 0 relative_tolerance 1e-10",
                     before_pair="variable u atom 0.8*y", fix=False, dt=1e-9)
    sim.commands(MOVE).run()
    assert np.abs(sim.v[0] - (1.6, 0, 0)).max() < 1e-10
    assert np.abs(sim.atom("omega")[0] - (0, 0, -0.4)).max() < 1e-10


ETA, CURVED = 1.3, ("variable u atom 0.9-0.8*y*y-0.5*z*z", "variable w atom 0.3*x*y+0.2*x")


def curved(x):
    """The velocity of the formulas, its Laplacian and half its curl"""
    x, y, z = x
    return (np.array((0.9 - 0.8 * y * y - 0.5 * z * z, 0, 0.3 * x * y + 0.2 * x)), np.array((-2.6, 0, 0)),
            0.5 * np.array((0.3 * x, -z - 0.3 * y - 0.2, 1.6 * y)))


@pytest.mark.parametrize("points", [12, 42])
def test_lone_sphere_in_a_curved_flow_obeys_faxen(simulation, points):
    a, x = 0.7, (0.4, 0.6, -0.3)
    u, bend, turn = curved(x)
    carried = u + a * a / 6 * bend
    style = f"cut_off_distance inf visc {ETA} multiblob {points} fluid_velocity v_u 0 v_w relative_tolerance 1e-11"
    sim = simulation(Spheres([x], a), style, fix=False, dt=1e-9, before_pair="\n".join(CURVED))
    sim.commands(MOVE).run()
    assert np.abs(sim.v[0] - carried).max() < 1e-9
    assert np.abs(sim.atom("omega")[0] - turn).max() < 1e-9
    sim = simulation(Spheres([x], a), style, before_pair="\n".join(CURVED)).run()    # at rest
    assert np.abs(sim.drag[0] - P6 * ETA * a * carried).max() < 1e-8


def test_curved_flow_of_a_grid(simulation, tmp_path):
    """Nodes half a radius apart: what is there comes out. A sphere over the edge takes the flow as linear."""
    a, axes = 0.8, [np.linspace(-4, 4, 21)] * 3
    z, y, x = np.meshgrid(*axes, indexing="ij")
    flow_grid.write(tmp_path / "grid", axes, np.stack([0.9 - 0.8 * y * y - 0.5 * z * z, 0 * x, 0 * x], axis=-1))
    for there, u, bend in (((0.4, 0.8, -1.2), 0.9 - 0.8 * 0.64 - 0.5 * 1.44, -2.6),
                           ((0.0, 3.8, 0.0), 0.9 - 0.4 * (3.6 ** 2 + 16), 0.0)):
        sim = simulation(Spheres([there], a),
                         f"cut_off_distance inf visc 1 multiblob 12 fluid_velocity grid {tmp_path}/grid "
                         "relative_tolerance 1e-11", fix=False, dt=1e-9, box=[(-4.0, 4.0)] * 3)
        sim.commands(MOVE).run()
        assert abs(sim.v[0, 0] - u - a * a / 6 * bend) < 1e-9


def test_rigid_clump_feels_the_curvature_that_free_spheres_feel_in_its_place(simulation):
    """Force and torque of a doublet at rest; its shells stand otherwise. Without the curvature of one of the two they
    differ by more."""
    x = np.array([(0.2, 0.5, -0.3), (0.2 + 2 * 0.6, 0.5 - 2 * 0.64, -0.3 + 2 * 0.48)])
    found = []
    for style, molecule in (("", 0), ("rigid_clumps yes", 1)):
        sim = simulation(Spheres(x, molecule=molecule),
                         f"cut_off_distance inf visc 1 multiblob 42 fluid_velocity v_u 0 v_w {style} "
                         "relative_tolerance 1e-9", before_pair="\n".join(CURVED)).run()
        torque = (np.cross(x - x.mean(axis=0), sim.drag) + sim.fix_rows()[:, 6:9]).sum(axis=0)
        found.append(np.concatenate([sim.drag.sum(axis=0), torque]))
    assert off(*found) < 2e-3


@pytest.mark.parametrize("case, load", [("cube8_0.1", "random"), ("unequal4_0.01", "weight_z"),
                                        ("random5_0.001", "random")])
def test_clusters_near_contact(simulation, case, load):
    rows = rows_of("clusters_multiblob.csv", case=case, load=load)
    spheres = Spheres(columns(rows, "x y z"), columns(rows, "a")[:, 0])
    sim = fall(simulation, spheres, columns(rows, "Fx Fy Fz"),
               "12 multiblob_most 12 lubrication yes relative_tolerance 1e-8")
    assert off(sim.v, columns(rows, "Ux Uy Uz")) < 3e-3
    assert off(sim.atom("omega"), columns(rows, "Wx Wy Wz")) < 3e-3


def test_suspension_of_two_radii_in_a_periodic_box(simulation):
    rows = rows_of("bidisperse.csv", load="random")
    side = float(rows[0]["box"])
    spheres = Spheres(columns(rows, "x y z") % side, columns(rows, "a")[:, 0])
    sim = fall(simulation, spheres, columns(rows, "Fx Fy Fz"),
               "12 multiblob_most 12 lubrication yes relative_tolerance 1e-6", boundary="p p p",
               box=[(0.0, side)] * 3, comm="neighbor 0.1 bin")
    assert off(sim.v, columns(rows, "Ux Uy Uz")) < 3e-3
    assert off(sim.atom("omega"), columns(rows, "Wx Wy Wz")) < 3e-3


def test_ewald_sums_in_open_space_are_all_pairs(simulation):
    rows = rows_of("clusters_multiblob.csv", case="cube8_0.1", load="random")
    spheres = Spheres(columns(rows, "x y z"), columns(rows, "a")[:, 0])
    found = []
    for way in ("direct", "ewald far_field_tolerance 1e-9"):
        sim = fall(simulation, spheres, columns(rows, "Fx Fy Fz"), f"12 relative_tolerance 1e-9 far_field {way}")
        found.append(sim.v)
    assert off(*found) < 1e-7


def test_the_far_field_tolerance_is_that_of_spheres(simulation, tmp_path):
    """Sums over 12 points of each are those of as many spheres of their radius, to sqrt(12) 0.5623 tolerances."""
    sites, parts = 3.75 * (np.indices((8, 8, 8)).reshape(3, -1).T + 0.5), []
    for every, a, style, tolerance in ((12, 1.0, "multiblob 12", 1e-3), (1, 0.5623, "", 1e-3 * np.sqrt(12) * 0.5623)):
        log = tmp_path / str(every)
        words = f"cut_off_distance inf visc 1 algorithm 2 {style} far_field_tolerance {tolerance}"
        simulation(Spheres(sites[:480:every], a), words, log=log, boundary="p p p", box=[(0.0, 30.0)] * 3).run().close()
        said = re.search(r"Far field .* splitting parameter (\S+), near part up to ([^;]+);", log.read_text())
        parts.append([float(number) for number in said.groups()])
    assert parts[0] == pytest.approx(parts[1], rel=1e-3)


@pytest.mark.parametrize("clumps", ["", "rigid_clumps yes"])
def test_forces_of_velocities_of_forces(simulation, clumps):
    """The pair style undoes what the fix does."""
    rows = rows_of("clusters_multiblob.csv", case="unequal4_0.01", load="random")
    F = columns(rows, "Fx Fy Fz")
    spheres = Spheres(columns(rows, "x y z"), columns(rows, "a")[:, 0], molecule=[1, 1, 0, 0] if clumps else 0)
    style = f"12 lubrication yes relative_tolerance 1e-10 {clumps}"
    sim = fall(simulation, spheres, F, style)
    spheres.v, spins = sim.v, sim.atom("omega")
    sim = simulation(spheres, f"cut_off_distance inf visc 1 multiblob {style}")
    for i, spin in enumerate(spins):
        sim.set("omega", i + 1, spin)
    sim.run()
    found = -sim.fix_rows()
    if clumps:    # what holds the members of a clump together is not the fluid's
        found[0, :3] += found[1, :3]
        F = np.vstack([F[0] + F[1], F[2:]])
        found = np.delete(found, 1, 0)
    assert off(found[:, :3], F) < 1e-7


def test_a_solve_begins_where_the_last_one_ended(simulation):
    rows = rows_of("bidisperse.csv", load="weight_z")
    side = float(rows[0]["box"])
    spheres = Spheres(columns(rows, "x y z") % side, columns(rows, "a")[:, 0])
    products = []
    for warm in ("yes", "no"):
        sim = simulation(spheres, f"cut_off_distance inf visc 1 multiblob 12 lubrication yes warm_start {warm}",
                         fix=False, dt=0.01, boundary="p p p", box=[(0.0, side)] * 3, comm="neighbor 0.1 bin")
        sim.commands([f"fix weight all addforce 0 0 {-P6!r}", MOVE]).run(6)
        products.append(sim.fix_vector("move")[3])
    assert products[0] <= 3 < 0.6 * products[1]


@pytest.mark.parametrize("points", ["multiblob 12", "rotation yes"])
def test_guesses_do_not_add_up_the_errors_of_answers(simulation, points):
    """Between exact answers the line is within the tolerance, so one product a step is enough. With answers to the
    tolerance it is as well, where their errors fade from guess to guess (sd_bodies.c), and in runs of one step too."""
    rows = rows_of("bidisperse.csv", load="weight_z")
    side, products = float(rows[0]["box"]), []
    sim = simulation(Spheres(columns(rows, "x y z") % side, columns(rows, "a")[:, 0]),
                     f"cut_off_distance inf visc 1 {points} lubrication yes", fix=False, dt=0.004, boundary="p p p",
                     box=[(0.0, side)] * 3, comm="neighbor 0.1 bin")
    sim.commands([f"fix weight all addforce 0 0 {-P6!r}", MOVE]).run(4, "post no")
    for begin in ["no"] * 20 + ["yes"] * 3:
        sim.run(1, f"pre {begin} post no")
        products.append(sim.fix_vector("move")[3])
    assert products == [1] * 23


def test_radii_too_different_for_films(simulation):
    sim = simulation(Spheres([(0, 0, 0), (0, 0, 13)], [1.0, 11.0]),
                     "cut_off_distance inf visc 1 multiblob 12 multiblob_most 12 lubrication yes")
    with pytest.raises(LammpsError, match="with multiblob lubrication is for ratios of radii up to 10; "
                                          "use group to select spheres, or lubrication no"):
        sim.run()


@pytest.mark.parametrize("ranks", [2, 3])
def test_forces_do_not_depend_on_ranks(tmp_path, ranks):
    rows = rows_of("bidisperse.csv", load="random")
    side = float(rows[0]["box"])
    spheres = Spheres(columns(rows, "x y z") % side, columns(rows, "a")[:, 0], columns(rows, "Ux Uy Uz"))
    found = []
    for number in (1, ranks):
        lines = input_lines(spheres, "cut_off_distance inf visc 1 multiblob 12 lubrication yes relative_tolerance "
                                     "1e-11 add_force yes",
                            os.path.join(str(tmp_path), "data"), "p p p", [(0.0, side)] * 3, comm="neighbor 0.1 bin",
                            dt=1e-9)
        lmp(tmp_path, lines + [f"dump d all custom 1 {tmp_path}/forces id fx fy fz tqx tqy tqz",
                               "dump_modify d sort id format float %.15g",
                               "run 0"], number)
        found.append(np.loadtxt(f"{tmp_path}/forces", skiprows=9))
    assert np.abs(found[1] - found[0]).max() < 1e-8 * np.abs(found[0]).max()


@pytest.mark.parametrize("part", [0.85, 1.2])
def test_limit_of_explicit_steps_is_that_of_shells(tmp_path, part):
    """Eight spheres near contact, without films: the run names its limit, below it they slow down, above it they fly
    apart."""
    rows = rows_of("clusters_multiblob.csv", case="cube8_0.1", load="random")
    spheres = Spheres(columns(rows, "x y z"), 1.0, 1e-6 * columns(rows, "Ux Uy Uz"))

    def run(dt, steps):
        lines = input_lines(spheres, "cut_off_distance inf visc 1 multiblob 12 relative_tolerance 1e-4 add_force yes",
                            os.path.join(str(tmp_path), "data"), density=1.0, dt=dt, fix=False)
        return lmp(tmp_path, lines + ["fix move all nve/sphere", f"dump d all custom 60 {tmp_path}/v id vx vy vz",
                                      f"run {steps}"]).log

    told = float(" ".join(run(1.0, 0).split()).split("is above ")[1].split(",")[0])
    log = run(part * told, 60)
    v = np.loadtxt(f"{tmp_path}/v", skiprows=9 + 8 + 9)[:, 1:]
    assert ("is above" in log) == (part > 1)
    assert np.abs(v).max() > 1e3 * np.abs(spheres.v).max() if part > 1 else np.abs(v).max() < 0.1 * np.abs(
        spheres.v).max()


# --- shear and stress -------------------------------------------------------------------------------------------------

STRESS = "compute S all stokes_dynamics/stress"


def moments(sim):
    rows = np.array(sim.lmp.numpy.extract_compute("S", 1, 2))[:sim.n][np.argsort(sim.ids())]
    return rows[:, :6], rows[:, 6:]


def test_moment_of_a_lone_sphere_in_a_shear(simulation):
    eta, a, rate = 1.3, 0.7, 0.8
    sim = simulation(Spheres([(1, 2, 3)], a), f"cut_off_distance inf visc {eta} multiblob 12 fluid_velocity v_u 0 0",
                     before_pair=f"variable u atom {rate}*y", fix=False, dt=1e-9)
    sim.commands([MOVE, STRESS, "dump d all custom 1 /dev/null c_S[1]"]).run()
    points, films = moments(sim)
    expected = np.array((0, 0, 0, -20 / 3 * np.pi * eta * a ** 3 * rate / 2, 0, 0))
    assert np.abs(points[0] - expected).max() < 1e-3 * abs(expected[3]) and (films == 0).all()


def sheared(simulation, style="", clump=0):
    """Two radii at a volume fraction of 0.3 in a box that shears with the fluid: half of the rate of shear is a
    strain."""
    rows = rows_of("bidisperse.csv", load="E_xy")
    side, rate = float(rows[0]["box"]), 2**0.5
    spheres = Spheres(columns(rows, "x y z") % side, columns(rows, "a")[:, 0])
    sim = simulation(spheres, "cut_off_distance inf visc 1 multiblob 12 multiblob_most 12 lubrication yes "
                              f"relative_tolerance 1e-6 fluid_velocity v_u 0 0 {style}", boundary="p p p",
                     box=[(0.0, side)] * 3, tilt=(0, 0, 0), fix=False, dt=1e-9,
                     before_pair=f"variable u atom {rate!r}*y", comm="neighbor 0.1 bin")
    sim.commands([f"fix shear all deform 1 xy erate {rate!r} remap none", MOVE, STRESS,
                  "thermo_style custom step " + " ".join(f"c_S[{k}]" for k in range(1, 19))])
    return sim.run(), rows, side, rate


def test_stress_of_a_sheared_suspension(simulation):
    sim, rows, side, rate = sheared(simulation)
    U, W = sim.v.copy(), sim.atom("omega").copy()
    U[:, 0] -= rate * sim.x[:, 1]
    W[:, 2] += 0.5 * rate
    assert off(U, columns(rows, "Ux Uy Uz")) < 3e-3 and off(W, columns(rows, "Wx Wy Wz")) < 3e-3
    points, films = moments(sim)
    assert off(points + films, columns(rows, "Sxx Syy Szz Sxy Sxz Syz")) < 3e-3
    whole = sim.compute_vector("S", 18)
    assert np.abs(whole[:6] - points.sum(axis=0) / side ** 3).max() < 1e-10
    assert np.abs(whole[6:12] - films.sum(axis=0) / side ** 3).max() < 1e-10
    # what resists the strain raises the viscosity: signs of compute pressure
    assert 1.0 < -whole[3] / rate < 1.2 and 1.0 < -whole[9] / rate < 1.2 and (whole[12:] == 0).all()


def test_stress_of_other_forces_is_their_virial(simulation):
    """Columns 13 to 18: a spring between two spheres across the border of the box, - r f/V as compute pressure has it,
    and nothing of it in the others' beside what it makes them do."""
    side, k, rest = 9.0, 3.0, 2.2
    x = np.array([(0.4, 3.0, 8.0), (8.0, 4.5, 0.6)])
    spheres = Spheres(x, bonds=[(1, 2)], molecule=1)
    sim = simulation(spheres, "cut_off_distance inf visc 1.3 multiblob 12 lubrication yes", boundary="p p p",
                     box=[(0.0, side)] * 3, fix=False, dt=1e-9, comm="comm_modify cutoff 5")
    sim.commands(["bond_style harmonic", f"bond_coeff 1 {k} {rest}", MOVE, STRESS, "compute P all pressure NULL bond",
                  "thermo_style custom step c_S[13] c_P[1]"]).run()
    r = x[0] - x[1]
    r -= side * np.round(r / side)
    length = np.linalg.norm(r)
    expected = np.outer(r, r) * (-2 * k * (length - rest)) / length / side ** 3
    whole = sim.compute_vector("S", 18)
    assert abs(length - rest) > 0.1
    assert np.abs(whole[12:] - expected[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]).max() < 1e-12
    assert np.abs(whole[12:] - sim.compute_vector("P", 6)).max() < 1e-12


@pytest.mark.parametrize("rigid", ["rigid/small", "rigid"])
def test_stress_of_rigid_bodies_does_not_depend_on_who_moves_them(simulation, rigid):
    """Two clumps in a sheared box, one of them across a face: with hardly any inertia, LAMMPS's rigid bodies, whose
    forces of constraint are among the other forces, against motion without inertia, where they belong to the points."""
    x = np.array([(3.0, 3.0, 3.0), (4.9, 3.3, 3.2), (5.2, 5.1, 3.7), (8.3, 7.0, 5.6), (9.6, 8.1, 6.7)]) % 9.0
    side, rate, who = 9.0, 0.8, [1, 1, 1, 2, 2]
    style = "cut_off_distance inf visc 1.3 multiblob 12 rigid_clumps yes relative_tolerance 1e-8 fluid_velocity box "
    box = dict(boundary="p p p", box=[(0.0, side)] * 3, tilt=(0, 0, 0), fix=False, density=1e-5)
    thermo = [STRESS, "thermo_style custom step " + " ".join(f"c_S[{k}]" for k in range(1, 19))]

    def total(sim):
        P = sim.compute_vector("S", 18).reshape(3, 6).sum(axis=0)
        return P - P[:3].mean() * np.array((1, 1, 1, 0, 0, 0))

    sim = simulation(Spheres(x, 0.97, molecule=who), style, dt=1e-9, **box)
    sim.commands([f"fix shear all deform 1 xz erate {rate} remap none", MOVE] + thermo).run()
    spheres, omega, expected = Spheres(x, 0.97, sim.v.copy(), who), sim.atom("omega").copy(), total(sim)
    sim.close()
    sim = simulation(spheres, style + "add_force yes", dt=1e-15, **box)
    sim.commands([f"set atom {i + 1} omega {w[0]!r} {w[1]!r} {w[2]!r}" for i, w in enumerate(omega.tolist())])
    sim.commands(["set atom 5 image 1 0 0", f"fix bodies all {rigid} molecule",
                  f"fix shear all deform 1 xz erate {rate} remap v"] + thermo).run(2)
    assert np.abs(sim.compute_vector("S", 18)[12:]).max() > 0.1 * np.abs(expected).max()
    assert np.abs(total(sim) - expected).max() < 1e-5 * np.abs(expected).max()


def stressed(folder, style):
    """Eight spheres that move"""
    rows = rows_of("clusters_multiblob.csv", case="cube8_0.1", load="random")
    spheres = Spheres(columns(rows, "x y z") + 0.3, 1.0, 0.1 * columns(rows, "Ux Uy Uz"))
    lines = input_lines(spheres, "cut_off_distance inf visc 1 multiblob 12 lubrication yes add_force yes "
                                 f"relative_tolerance 1e-9 {style}",
                        os.path.join(str(folder), "data"), dt=1e-10, fix=False, before_pair="variable u atom 0.7*y")
    return lines + ["fix move all nve/sphere", STRESS]


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("flow", ["0", "v_u"])
def test_stress_of_a_first_step_without_a_solve(tmp_path, ranks, flow):
    """A run that goes on, with its atoms in another order, and one from a restart file: the rows of the step before."""
    again = ["atom_modify sort 1 0.5"] + dump_lines("two", columns="c_S[*]") + ["run 0", "write_restart restart",
                                                                                "clear",
                                                                                "plugin load stokesdynplugin.so",
                                                                                "variable u atom 0.7*y",
                                                                                "read_restart restart",
                                                                                "fix move all nve/sphere", STRESS]
    lmp(tmp_path, stressed(tmp_path, f"fluid_velocity {flow} 0 0") + dump_lines("one", columns="c_S[*]") +
        ["run 1", "undump out"] + again +
        dump_lines("three", columns="c_S[*]") + ["run 0"], ranks)
    one, two, three = (read_dump(tmp_path / name)[-1][1] for name in ("one", "two", "three"))
    assert np.abs(one[:, :6]).max() > 0.1 and np.abs(one[:, 6:]).max() > 0.1
    assert np.abs(two - one).max() < 1e-6 and np.abs(three - one).max() < 1e-6


def test_stress_between_solves(tmp_path):
    """update_every 3: forces of points are those of the last solve, films those of now."""
    lmp(tmp_path, stressed(tmp_path, "update_every 3") + dump_lines("rows", columns="c_S[*]") + ["run 3"])
    steps = [rows for _, rows in read_dump(tmp_path / "rows")]
    assert np.abs(steps[0]).max() > 0.1
    for rows in steps[1:]:
        assert 0 < np.abs(rows - steps[0]).max() < 1e-3 * np.abs(steps[0]).max()


def test_stress_between_solves_turns_with_the_clump(simulation):
    """A heavy triangle that spins by 0.3 in nine steps: its moments are those of the first step, turned, solved or
    not."""
    rate, found = 0.7, []
    x = np.array([(-1.4, -0.7, 0), (1.4, -0.7, 0), (0, 1.4, 0)])
    spheres = Spheres(x, 1.0, np.cross((0, 0, rate), x), molecule=1)
    for every in (1, 10):
        sim = simulation(spheres, "cut_off_distance inf visc 1 multiblob 12 rigid_clumps yes relative_tolerance 1e-10 "
                                  f"update_every {every}",
                         density=1e9, dt=0.3 / 9 / rate)
        sim.commands([f"set atom * omega 0 0 {rate!r}", "fix bodies all rigid single", STRESS,
                      "dump d all custom 1 /dev/null c_S[1]", "thermo_style custom step"]).run(9)
        found.append(sum(moments(sim)))
    assert np.abs(found[1] - found[0]).max() < 1e-6 * np.abs(found[0]).max()


def test_stress_needs_shells_of_points(simulation):
    sim = simulation(Spheres([(1, 2, 3)]), "cut_off_distance inf visc 1", fix=False)
    with pytest.raises(LammpsError, match="Compute stokes_dynamics/stress: it requires pair_style stokes_dynamics with "
                                          "multiblob"):
        sim.commands([STRESS]).run()
    with pytest.raises(LammpsError, match="unknown keyword 'virial'"):
        sim.command("compute T all stokes_dynamics/stress virial")


def test_stress_of_an_open_box_has_no_average(simulation):
    sim = simulation(Spheres([(1, 2, 3)]), "cut_off_distance inf visc 1 multiblob 12", fix=False)
    sim.commands([MOVE, STRESS, "thermo_style custom step c_S[1]"])
    with pytest.raises(LammpsError, match="its vector is an average over a periodic box, and this box is not periodic"):
        sim.run()


# --- pairs and clumps in a strain, exact ------------------------------------------------------------------------------


def strained(simulation, spheres, E, style):
    """Velocities less those of the flow E x, and the moments of all spheres along E, in those of a lone sphere in E"""
    formulas = [f"variable u{c} atom " + "+".join(f"({g!r})*{d}" for g, d in zip(row, "xyz"))
                for c, row in zip("xyz", E.tolist())]
    sim = simulation(spheres, "cut_off_distance inf visc 1 fluid_velocity v_ux v_uy v_uz "
                              f"relative_tolerance 1e-8 {style}",
                     before_pair="\n".join(formulas), fix=False, dt=1e-9)
    sim.commands([MOVE, STRESS, "dump d all custom 1 /dev/null c_S[1]"]).run()
    S = sum(moments(sim)).sum(axis=0)[[0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(3, 3)
    return sim.v - sim.x @ E, -np.sum(S * E) / np.sum(E * E) / (20 / 3 * np.pi)


@pytest.mark.parametrize("gap, A, S", [(1e-4, 0.999593, 1.910044), (1e-2, 0.961946, 1.873095),
                                       (0.1, 0.732436, 1.655834), (0.5, 0.347646, 1.312501)])
def test_pair_in_a_strain_along_its_line_of_centres(simulation, gap, A, S):
    """Batchelor & Green (1972): the pair comes near at 1 - A of the flow's rate, and each sphere has S of a lone one's
    stresslet. Numbers: bispherical coordinates."""
    x = np.outer([-1 - gap / 2, 1 + gap / 2], np.array((2, -1, 2)) / 3)
    E = 1.7 * (np.outer(x[1], x[1]) / (x[1] @ x[1]) - np.eye(3) / 3)
    slip, whole = strained(simulation, Spheres(x), E, "multiblob 12 lubrication yes lubrication_gap 1e-6")
    assert abs((slip[0] - slip[1]) @ x[1] / ((x[1] - x[0]) @ E @ x[1]) - A) < 0.015 * A
    assert abs(whole / 2 - S) < 0.015 * S


@pytest.mark.parametrize("n, exact", [(1, 2.5), (2, 3.053452), (5, 4.618060)])
def test_intrinsic_viscosity_of_a_rigid_row(simulation, n, exact):
    """Galerkin multipoles; films and neighbours apart, this is the dilute limit of a suspension of such clumps."""
    d = np.array((1, 2, 2)) / 3
    spheres = Spheres(np.outer(2 * np.arange(n) - n + 1.0, d), molecule=1)
    basis = [np.diag((1.0, -1.0, 0.0)), np.diag((1.0, 1.0, -2.0))]
    basis += [np.outer(a, b) + np.outer(b, a) for a, b in zip(np.eye(3), np.roll(np.eye(3), 1, axis=0))]
    found = 2.5 / n * np.mean([strained(simulation, spheres, E, "multiblob 12 rigid_clumps yes")[1] for E in basis])
    assert abs(found / exact - 1) < (1e-6 if n == 1 else 6e-3)


def test_stress_of_dihedrals_and_impropers_is_among_the_others(simulation, tmp_path):
    """Columns 13 to 18: as compute pressure has them"""
    side, x = 14.0, np.array([(4, 4, 4), (6.3, 4, 4), (6.5, 6.2, 4.3), (8.6, 6.4, 5.5)])
    spheres = Spheres(x, bonds=[(1, 2), (2, 3), (3, 4)], molecule=1)
    path = spheres.write_data(str(tmp_path / "data"), [(0.0, side)] * 3)
    text = open(path).read().replace("1 bond types", "1 bond types\n1 dihedrals\n1 dihedral types\n1 impropers\n"
                                                     "1 improper types")
    with open(path, "w") as data:
        data.write(text + "\nDihedrals\n\n1 1 1 2 3 4\n\nImpropers\n\n1 1 1 2 3 4\n")
    sim = simulation().commands([
        "units lj", "atom_style hybrid sphere molecular", "boundary p p p", "atom_modify map array",
        "plugin load stokesdynplugin.so", f"read_data {path}", "bond_style zero", "bond_coeff *",
        "dihedral_style harmonic", "dihedral_coeff 1 5.0 1 2", "improper_style harmonic",
        "improper_coeff 1 3.0 10", "comm_modify cutoff 6",
        "pair_style stokes_dynamics cut_off_distance inf visc 1.3 multiblob 12",
        "pair_coeff * *", "timestep 1e-9", MOVE, STRESS, "compute D all pressure NULL dihedral",
        "compute I all pressure NULL improper", "thermo_style custom step c_S[13] c_D[1] c_I[1]"]).run()
    parts = [sim.compute_vector(name, 6) for name in "DI"]
    assert min(np.abs(part).max() for part in parts) > 1e-4
    assert np.abs(sim.compute_vector("S", 18)[12:] - sum(parts)).max() < 1e-12
