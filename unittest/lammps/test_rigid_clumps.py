"""rigid_clumps yes: resistances computed once per shape, forces from pose and slip motion."""
import re

import numpy as np
import pytest

from model import forces, read_table, same_clump
from system import Spheres, dump_lines, input_lines, lmp, read_dump
from test_rotation import CLUSTERS, resistance, tabulated, torques

WIDE = "comm_modify cutoff 40"
SOLVED = "algorithm 2 relative_tolerance 1e-12 max_iter 1000"
TRANSLATION, ROTATION = {12: 0.6e-2, 42: 0.35e-2}, {12: 1.5e-2, 42: 0.4e-2}


def rotation_matrix(rng):
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def many(name, count, seed=1, spacing=15.0, a=1.0):
    """count copies of a cluster on a row, each turned, its spheres in another order, in rigid motion; returns motion too."""
    rng = np.random.default_rng(seed)
    shape = CLUSTERS[name]
    x, v, w, molecule, turn, orders = [], [], [], [], [], []
    for k in range(count):
        R, order = rotation_matrix(rng), rng.permutation(len(shape))
        centre, U, W = np.array([spacing * k, 0.3, -0.2]), rng.normal(size=3), rng.normal(size=3)
        y = shape[order] @ R.T
        x.append(a * y + centre)
        v.append(U + np.cross(W, a * (y - y.mean(axis=0))))
        w.append(np.broadcast_to(W, y.shape))
        molecule += [10 * k + 3] * len(shape)
    return Spheres(np.vstack(x), a, np.vstack(v), molecule), np.vstack(w)


def forces_and_torques(sim, omega):
    sim.raw("omega")[:] = omega[sim.ids() - 1]
    sim.run(0)
    return sim.drag, torques(sim)


@pytest.mark.parametrize("name", CLUSTERS)
def test_one_point_without_rotation_is_the_ordinary_solve(simulation, name):
    spheres, omega = many(name, 3)
    sim = simulation(spheres, f"clumps_only yes visc 1.3 {SOLVED}", comm=WIDE)
    expected, _ = forces_and_torques(sim, omega)
    sim = simulation(spheres, "clumps_only yes rigid_clumps yes visc 1.3", comm=WIDE)
    F, T = forces_and_torques(sim, omega)
    assert np.abs(F - expected).max() < 1e-10 * np.abs(expected).max()
    assert np.abs(T).max() == 0.0


@pytest.mark.parametrize("name", CLUSTERS)
def test_one_point_with_rotation_is_the_ordinary_solve(simulation, name):
    spheres, omega = many(name, 3)
    sim = simulation(spheres, f"clumps_only yes visc 1.3 rotation yes {SOLVED}", comm=WIDE)
    expected = np.hstack(forces_and_torques(sim, omega))
    sim = simulation(spheres, "clumps_only yes rigid_clumps yes rotation yes visc 1.3", comm=WIDE)
    answer = np.hstack(forces_and_torques(sim, omega))
    for c in (slice(0, 3), slice(3, 6)):
        assert np.abs(answer[:, c] - expected[:, c]).max() < 1e-9 * np.abs(expected[:, c]).max()
    # v' and w' stand for those forces
    rows, v = sim.fix_rows(), sim.v
    assert np.abs(rows[:, 0:3] - 6 * np.pi * 1.3 * (rows[:, 3:6] - v)).max() < 1e-12 * np.abs(rows[:, 0:3]).max()


def exact_kind(name):
    return next(r["kind"] for r in read_table("clusters_full.csv") if r["name"] == name and r["kind"].startswith("exact"))


@pytest.mark.parametrize("shell", [12, 42])
@pytest.mark.parametrize("name", CLUSTERS)
def test_shells_come_close_to_the_exact_drag(simulation, name, shell):
    x = CLUSTERS[name]
    R = resistance(simulation(Spheres(x, molecule=1), f"clumps_only yes rigid_clumps yes shell {shell} visc 1", comm=WIDE), x)
    exact = tabulated(name, exact_kind(name))
    assert np.abs(R - R.T).max() < 1e-9 * np.abs(R).max()
    for block, limit in ((slice(0, 3), TRANSLATION[shell]), (slice(3, 6), ROTATION[shell])):
        ours, theirs = np.linalg.eigvalsh(R[block, block]), np.linalg.eigvalsh(exact[block, block])
        assert np.abs(ours / theirs - 1).max() < limit


def test_lone_spheres_and_single_sphere_clumps_have_stokes_drag_and_torque(simulation):
    a, eta = 0.7, 1.3
    v, w = np.array([[0.3, -1.0, 0.4], [0.7, 0.1, -0.2]]), np.array([[0.2, 0.5, -0.4], [1.0, -0.3, 0.6]])
    sim = simulation(Spheres([[0, 0, 0], [1.1, 0.3, 0]], a, v, [0, 4]), f"clumps_only yes rigid_clumps yes shell 42 visc {eta}")
    F, T = forces_and_torques(sim, w)
    assert np.abs(F + 6 * np.pi * eta * a * v).max() < 1e-10 * np.abs(F).max()
    assert np.abs(T + 8 * np.pi * eta * a**3 * w).max() < 1e-10 * np.abs(T).max()


def test_equal_clumps_share_one_shape_and_mirror_images_do_not(tmp_path):
    spheres, _ = many("helix4_chiral", 5)
    mirror = Spheres(spheres.x * [1, 1, -1] + [0, 0, 30], 1.0, spheres.v, np.array(spheres.molecule) + 1000)
    both = Spheres(np.vstack((spheres.x, mirror.x)), 1.0, np.vstack((spheres.v, mirror.v)),
                   np.concatenate((spheres.molecule, mirror.molecule)))
    for n, system in ((1, spheres), (2, both)):
        text = lmp(tmp_path, input_lines(system, "clumps_only yes rigid_clumps yes shell 12 visc 1", tmp_path / "data", comm=WIDE)
                   + ["run 0", "run 0"], ranks=2).log
        assert text.count("Rigid clumps, shape") == n
        assert "hydrodynamic radius" in text


def test_mirror_image_flips_the_coupling(simulation):
    """Coupling of force and rotation, about the centroid: C' = -P C P for the image in the mirror P."""
    x, P = CLUSTERS["helix4_chiral"], np.diag([1.0, 1.0, -1.0])
    couplings = []
    for y in (x, x @ P):
        R = resistance(simulation(Spheres(y, molecule=1), "clumps_only yes rigid_clumps yes shell 42 visc 1", comm=WIDE), y)
        couplings.append(R[:3, 3:])
    assert np.abs(couplings[0]).max() > 0.5
    assert np.abs(couplings[1] + P @ couplings[0] @ P).max() < 1e-9 * np.abs(couplings[0]).max()


# Any linear flow: G of u = G x, as formulas or stored per atom.
G = np.array([[0.2, 0.3, -0.2], [0.1, -0.5, 0.5], [-0.4, 0.25, 0.3]])
FORMULAS = "\n".join("variable g{} atom {}*x+{}*y+{}*z".format(n, *row) for n, row in zip("xyz", G))
STORED = ("fix u all property/atom d_ux d_uy d_uz\n" + "\n".join(f"set group all d_u{n} v_g{n}" for n in "xyz")
          + "\ncompute u all property/atom d_ux d_uy d_uz\n" + "\n".join(f"variable s{n} atom c_u[{k + 1}]" for k, n in enumerate("xyz")))


@pytest.mark.parametrize("name", ["doublet", "trimer_line", "square", "tetrahedron", "helix4_chiral"])
def test_linear_flow_is_exact(simulation, name):
    """With one point a sphere: the same as the ordinary solve in the same flow, clumps in rigid motion."""
    spheres, omega = many(name, 2)
    flow = "fluid_velocity v_gx v_gy v_gz"
    sim = simulation(spheres, f"clumps_only yes visc 1.3 {SOLVED} {flow}", before_pair=FORMULAS, comm=WIDE)
    expected, _ = forces_and_torques(sim, omega)
    sim = simulation(spheres, f"clumps_only yes rigid_clumps yes visc 1.3 {flow}", before_pair=FORMULAS, comm=WIDE)
    F, _ = forces_and_torques(sim, omega)
    assert np.abs(F - expected).max() < 1e-10 * np.abs(expected).max()


def test_flow_stored_per_atom_is_the_flow_of_the_formulas_where_the_clump_spans_space(simulation):
    spheres, omega = many("tetrahedron", 2)
    answers = []
    for prefix, lines in (("g", FORMULAS), ("s", FORMULAS + "\n" + STORED)):
        sim = simulation(spheres, f"clumps_only yes rigid_clumps yes shell 12 visc 1.3 fluid_velocity v_{prefix}x v_{prefix}y v_{prefix}z",
                         before_pair=lines, comm=WIDE)
        answers.append(np.hstack(forces_and_torques(sim, omega)))
    assert np.abs(answers[0] - answers[1]).max() < 1e-9 * np.abs(answers[0]).max()


def test_chain_along_the_flow_of_a_shear_feels_the_vorticity(simulation):
    """u_x = g z, chain of 3 along x: its centres see no velocity at all, but it must turn. Against the ordinary solve with torques."""
    g = 0.9
    spheres = Spheres(CLUSTERS["trimer_line"][:, [2, 1, 0]], 1.0, molecule=1)
    # The strain turns a row of touching spheres by the part B of Jeffery's orbit; at rest, torque = R_rot g/2 (1 - B) about y.
    R = resistance(simulation(spheres, f"clumps_only yes visc 1 rotation yes {SOLVED}", comm=WIDE), spheres.x)
    answers = []
    for words in (f"rotation yes {SOLVED}", "rigid_clumps yes rotation yes"):
        sim = simulation(spheres, f"clumps_only yes visc 1 {words} fluid_velocity v_ux 0 0", before_pair=f"variable ux atom {g}*z",
                         comm=WIDE)
        sim.run(0)
        F, T = sim.drag, torques(sim)
        answers.append((T + np.cross(spheres.x, F)).sum(axis=0))
    assert 0.0 < answers[0][1] < 0.5 * R[4, 4] * g / 2
    assert np.abs(answers[1] - answers[0]).max() < 1e-9 * answers[0][1]


@pytest.mark.parametrize("words", ["rotation no", "rotation yes", "shell 12"])
def test_ranks_periodic_borders_and_order_leave_the_motion_alone(tmp_path, words):
    """Clumps that move under fix rigid/small in a periodic box, across its borders, 1 against 2 and 4 ranks, list and tiled."""
    spheres, _ = many("tetrapod5", 6, spacing=9.0)
    box = [(-9.0, 45.0), (-9.0, 9.0), (-9.0, 9.0)]
    last = {}
    for ranks, comm in ((1, ""), (2, ""), (4, "comm_style tiled\nbalance 1.0 rcb")):
        lines = input_lines(spheres, f"clumps_only yes rigid_clumps yes {words} visc 1.3", tmp_path / "data", boundary="p p p", box=box,
                            comm="comm_modify cutoff 6\n" + comm, dt=0.01)
        lines += ["thermo_style custom step", "fix down all addforce 3.0 1.0 -2.0", "fix rigid all rigid/small molecule"]
        lines += dump_lines(tmp_path / "dump", every=200, columns="xu yu zu vx vy vz f_drag[1] f_drag[2] f_drag[3]") + ["run 200"]
        lmp(tmp_path, lines, ranks=ranks)
        last[ranks] = read_dump(tmp_path / "dump")[-1][1]
    assert np.abs(last[1][:, 0:3] - spheres.x).max() > 0.5
    for ranks in (2, 4):
        for c in (slice(0, 3), slice(3, 6), slice(6, 9)):
            assert np.abs(last[ranks][:, c] - last[1][:, c]).max() < 1e-10 * np.abs(last[1][:, c]).max()


def test_restart_goes_on_as_the_unbroken_run(tmp_path):
    spheres, _ = many("helix4_chiral", 3)
    lines = input_lines(spheres, "clumps_only yes rigid_clumps yes shell 12 visc 1.3", tmp_path / "data", comm=WIDE, dt=0.01)
    moves = ["thermo_style custom step", "fix down all addforce 3.0 1.0 -2.0", "fix rigid all rigid/small molecule"]
    columns = "xu yu zu vx vy vz f_drag[1] f_drag[7] f_drag[8]"
    lmp(tmp_path, lines + moves + [f"restart 50 {tmp_path}/restart"] + dump_lines(tmp_path / "whole", every=100, columns=columns)
        + ["run 100"])
    lmp(tmp_path, ["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/restart.50", WIDE, "fix drag all stokes_dynamics"] + moves
        + dump_lines(tmp_path / "rest", every=100, columns=columns) + ["run 50"])
    whole, rest = read_dump(tmp_path / "whole")[-1][1], read_dump(tmp_path / "rest")[-1][1]
    assert np.abs(whole - rest).max() < 1e-10 * np.abs(whole).max()


def test_force_and_torque_sums_dissipate(simulation):
    spheres, omega = many("fcc13", 2)
    sim = simulation(spheres, "clumps_only yes rigid_clumps yes shell 12 visc 1.3", comm=WIDE)
    F, T = forces_and_torques(sim, omega)
    power = -(F * spheres.v).sum() - (T * omega).sum()
    assert power > 0.0
    assert sim.fix_scalar() == pytest.approx(power, rel=1e-12)


# --- which clumps have the same shape

# Third sphere of an angle of three (size 2.6) displaced: each is the shape of the one before, but the first and the last are 2 d apart.
@pytest.mark.parametrize("d", [0.0, 3e-6, 1e-4, 2e-4, 2.5e-4, 1e-3])
def test_nearly_equal_clumps_have_their_drag_on_any_ranks(tmp_path, d):
    angle = np.array([(0, 0, 0), (2, 0, 0), (0, 2, 0)], float)
    centres = [(-10, 0, 0), (10, 0, 0), (10, 0, 8)]
    x = np.vstack([angle + (0, 0, 0) + c + np.array([(0, 0, 0), (0, 0, 0), (0, k * d, 0)]) for k, c in enumerate(centres)])
    spheres = Spheres(x, 1.0, (1.0, 0, 0), np.repeat([1, 2, 3], 3))
    totals, shapes = [], []
    for ranks, processors in ((1, "1 1 1"), (2, "2 1 1"), (2, "1 1 2")):
        lines = input_lines(spheres, "clumps_only yes rigid_clumps yes shell 12 visc 1", tmp_path / "data",
                            comm=f"processors {processors}\ncomm_modify cutoff 10")
        shapes.append(lmp(tmp_path, [lines[0], f"processors {processors}"] + [w for w in lines[1:] if not w.startswith("processors")]
                          + dump_lines(tmp_path / "dump", columns="f_drag[1]") + ["run 0"], ranks=ranks).log.count("Rigid clumps, shape"))
        F = read_dump(tmp_path / "dump")[-1][1][:, 0]
        totals.append(F.reshape(3, 3).sum(axis=1))
    assert np.abs(np.array(totals) / -30.73 - 1).max() < 1e-3
    assert np.abs(np.array(totals) / totals[0] - 1).max() < 1e-10
    assert shapes == shapes[:1] * 3


def block(n, digits, seed=3):
    """n copies of a clump of ten in a cube, turned, with coordinates of so many digits."""
    rng = np.random.default_rng(seed)
    shape = np.vstack([CLUSTERS["cube8"], [(0.3, -0.2, 2.6), (0.1, 2.9, 0.4)]])
    side = int(np.ceil(n ** (1 / 3)))
    x = np.vstack([shape @ rotation_matrix(rng).T + 12.0 * np.array([k % side, k // side % side, k // side**2]) - 6.0 * side
                   for k in range(n)])
    return Spheres(np.array([[float(f"%.{digits}g" % c) for c in row] for row in x]), 1.0, molecule=np.repeat(np.arange(1, n + 1), 10))


@pytest.mark.parametrize("ranks", [1, 2])
def test_equal_clumps_from_a_file_of_six_digits_share_one_shape(tmp_path, ranks):
    text = lmp(tmp_path, input_lines(block(500, 6), "clumps_only yes rigid_clumps yes shell 12 visc 1", tmp_path / "data", comm="comm_modify cutoff 12")
               + ["run 0"], ranks=ranks).log
    assert text.count("Rigid clumps, shape") == 1


def test_clumps_that_all_differ_are_told_apart_in_little_time(tmp_path):
    """1500 shapes; pairs of them that are looked at in earnest are few."""
    spheres = block(1500, 12)
    rng = np.random.default_rng(5)
    spheres.x[9::10] += rng.uniform(-0.5, 0.5, size=(1500, 3))
    text = lmp(tmp_path, input_lines(spheres, "clumps_only yes rigid_clumps yes visc 1", tmp_path / "data", comm="comm_modify cutoff 12")
               + ["timer full", "run 0"], ranks=2).log
    assert text.count("Rigid clumps, shape") == 1500


@pytest.mark.parametrize("ranks", [1, 2])
def test_stiffly_bonded_clumps_that_migrate_make_no_new_shapes(tmp_path, ranks):
    """Pairs held by stiff springs that breathe by less than the tolerance, in a flow through a periodic box."""
    spheres = Spheres([(k % 2 * 2.0 - 5, 4.0 * (k // 2) - 6, 0) for k in range(8)], 1.0, (2.0, 0.3, 0), np.arange(8) // 2 + 1,
                      bonds=[(k, k + 1) for k in (1, 3, 5, 7)])
    lines = input_lines(spheres, "clumps_only yes rigid_clumps yes visc 0.1 shell 12 fluid_velocity 2 0.3 0 add_force yes", tmp_path / "data",
                        boundary="p p p", box=[(-8.0, 8.0)] * 3, comm="comm_modify cutoff 6", dt=2e-3)
    at = lines.index("bond_style zero")
    lines[at:at + 2] = ["bond_style harmonic", "bond_coeff 1 1e4 2.0001"]
    text = lmp(tmp_path, lines + ["special_bonds lj/coul 0 1 1", "fix nve all nve/sphere", "run 2000", "run 2000"], ranks=ranks).log
    assert text.count("Rigid clumps, shape") == 1


def test_shapes_that_nobody_has_are_dropped(tmp_path):
    """Two clumps of which one is stretched and set back: its own shape goes, and is solved anew the next time."""
    spheres, _ = many("square", 2)
    lines = input_lines(spheres, "clumps_only yes rigid_clumps yes shell 12 visc 1", tmp_path / "data", comm=WIDE)
    pull, back = "displace_atoms corner move 0 0 0.3", "displace_atoms corner move 0 0 -0.3"
    text = lmp(tmp_path, lines + ["run 0", "group corner id 8", pull, "run 0", "run 0", back, "run 0", pull, "run 0"], ranks=2).log
    assert re.findall("Rigid clumps, shape ([0-9]+)", text) == ["1", "2", "3"]


# --- a run that ends in an error, and the next

def fresh(simulation, spheres, style, **options):
    return simulation(spheres, style, comm=WIDE, **options).run(0).drag


@pytest.mark.hard_case("run after an error of rigid clumps")
def test_run_after_spheres_at_one_point(simulation):
    spheres = Spheres([(0, 0, 0), (2, 0, 0), (0, 2, 0), (20, 0, 0), (22, 0, 0), (20, 2, 0)], 1.0, (0.3, 0.1, 0), [1, 1, 1, 2, 2, 2])
    style = "clumps_only yes rigid_clumps yes shell 12 visc 1"
    expected = fresh(simulation, spheres, style)
    sim = simulation(spheres, style, comm=WIDE)
    sim.commands("group moved id 2\ndisplace_atoms moved move -2 0 0")
    for _ in range(2):
        with pytest.raises(Exception, match="at one point"):
            sim.run(0)
    with pytest.raises(Exception, match="at one point"):
        sim.run(1, "pre no")
    sim.commands("displace_atoms moved move 2 0 0").run(0)
    assert np.abs(sim.drag - expected).max() < 1e-12


@pytest.mark.hard_case("run after an error of rigid clumps")
@pytest.mark.parametrize("shell", [100000000, 2147483646, 2147483647])
def test_run_after_a_shell_that_is_too_large(simulation, shell):
    spheres, _ = many("square", 2)
    style = "stokes_dynamics clumps_only yes rigid_clumps yes visc 1 shell"
    expected = fresh(simulation, spheres, "clumps_only yes rigid_clumps yes visc 1 shell 12")
    sim = simulation(spheres, f"clumps_only yes rigid_clumps yes visc 1 shell {shell}", comm=WIDE)
    for _ in range(2):
        with pytest.raises(Exception, match="its resistance needs .* GB, more than 4; use a smaller shell"):
            sim.run(0)
    sim.commands(f"pair_style {style} 12\npair_coeff * *").run(0)
    assert np.abs(sim.drag - expected).max() < 1e-12


@pytest.mark.hard_case("run after an error of rigid clumps")
def test_run_after_a_split_a_bent_and_a_shrunk_clump(simulation):
    spheres, _ = many("square", 2)
    style = "clumps_only yes rigid_clumps yes visc 1 group some"
    sim = simulation(spheres, style, comm=WIDE, before_pair="group some id 1:2 5:8", dt=1e-3)
    with pytest.raises(Exception, match="molecule 3 is split"):
        sim.run(0)
    found = [(spheres, sim.commands("group some id 3:4").run(0).drag)]
    sim.commands("fix nve all nve/sphere\nvelocity all create 1.0 4711")
    with pytest.raises(Exception, match="is not rigid"):
        sim.run(200)
    sim.command("unfix nve")                    # as it stands now it is a clump like any other
    found.append((Spheres(sim.x, 1.0, sim.v, spheres.molecule), sim.run(0).drag))
    sim.commands("group gone id 3\ndelete_atoms group gone compress no").run(0)
    found.append((Spheres(sim.x, 1.0, sim.v, np.delete(spheres.molecule, 2)), sim.drag))
    for now, drag in found:
        assert np.abs(drag - fresh(simulation, now, "clumps_only yes rigid_clumps yes visc 1")).max() < 1e-10


# --- molecule IDs

@pytest.mark.parametrize("molecule", [-5, 5, -2147483647])
def test_negative_molecule_is_a_molecule(simulation, molecule):
    """As for fix rigid/small and neigh_modify exclude molecule: only 0 is none. All checks see it."""
    spheres, _ = many("square", 2)
    expected = fresh(simulation, spheres, "clumps_only yes rigid_clumps yes visc 1")
    spheres.molecule[:4] = 7
    set_it = f"set atom 1*4 mol {molecule}"
    sim = simulation(spheres, "clumps_only yes rigid_clumps yes visc 1", comm=WIDE, before_pair=set_it, dt=1e-3).run(0)
    assert np.abs(sim.drag - expected).max() < 1e-12
    sim.commands("fix nve all nve/sphere\nvelocity all create 1.0 4711\nvelocity all set NULL NULL 0")
    sim.commands("group other id 5:8\nvelocity other set 0 0 0")
    with pytest.raises(Exception, match=f"molecule {molecule} is not rigid"):
        sim.run(200)
    sim = simulation(spheres, "clumps_only yes rigid_clumps yes visc 1 group some", comm=WIDE,
                     before_pair=set_it + "\ngroup some id 1:2 5:8")
    with pytest.raises(Exception, match=f"molecule {molecule} is split"):
        sim.run(0)
    sim = simulation(spheres, "clumps_only yes rigid_clumps yes visc 1", comm=WIDE, before_pair=set_it)
    sim.commands(LOSE.format(*spheres.x[2]))
    with pytest.raises(Exception, match=f"molecule {molecule} has gained or lost atoms"):
        sim.run(5)


# --- what is not rigid

@pytest.mark.hard_case("rigid clump that bends")
@pytest.mark.parametrize("ranks", [1, 2])
def test_clump_that_bends_is_an_error_that_names_the_molecule(tmp_path, ranks):
    spheres, _ = many("square", 3)
    lines = input_lines(spheres, "clumps_only yes rigid_clumps yes visc 1.3", tmp_path / "data", comm=WIDE, dt=1e-3)
    ended = lmp(tmp_path, lines + ["fix nve all nve/sphere", "velocity all create 1.0 4711", "run 200"], ranks=ranks, succeed=False)
    assert "keyword rigid_clumps: the clump of molecule" in ended.text
    assert "is not rigid" in ended.text


@pytest.mark.hard_case("rigid_clumps auto: clump that bends")
def test_auto_solves_bent_clumps_anew(simulation):
    """Loose spheres with drag: every clump soon loses its shape. The force is the model's for the velocities of the half step."""
    spheres, omega = many("square", 3)
    sim = simulation(spheres, f"clumps_only yes visc 1.3 rigid_clumps auto {SOLVED}", comm=WIDE, dt=1e-3)
    sim.command("fix nve all nve/sphere")
    sim.run(300)
    rows = sim.fix_rows()
    half_step = rows[:, 3:6] - rows[:, 0:3] / (6 * np.pi * 1.3)
    now = Spheres(sim.x, 1.0, half_step, spheres.molecule)
    F = forces(now, 1.3, sees=same_clump(now))
    assert sim.solves > 100
    assert np.abs(rows[:, 0:3] - F).max() < 1e-9 * np.abs(F).max()


LOSE = """group gone id 3
fix nve all nve/limit 1e-9
region r sphere {} {} {} 0.1
fix lose gone evaporate 1 1 r 4711"""


@pytest.mark.hard_case("rigid clump that loses an atom")
def test_lost_atom_is_an_error(simulation):
    spheres, _ = many("square", 2)
    sim = simulation(spheres, "clumps_only yes rigid_clumps yes visc 1.3", comm=WIDE)
    sim.commands(LOSE.format(*spheres.x[2]))
    with pytest.raises(Exception, match="molecule 3 has gained or lost atoms"):
        sim.run(5)


@pytest.mark.hard_case("rigid_clumps auto: clump that loses an atom")
def test_auto_goes_on_after_a_lost_atom(simulation):
    spheres, _ = many("square", 2)
    sim = simulation(spheres, f"clumps_only yes rigid_clumps auto visc 1.3 {SOLVED}", comm=WIDE)
    sim.commands(LOSE.format(*spheres.x[2])).run(5)
    assert sim.n == 7 and sim.solves > 0
    assert np.all(np.isfinite(sim.drag))


def flexible(count):
    """Triangles of soft springs that fall and bend, and one that falls rigid."""
    spheres, _ = many("triangle", count, spacing=9.0)
    spheres.v[:] = 0.0
    spheres.bonds = [(3 * k + p, 3 * k + q) for k in range(count) for p, q in ((1, 2), (2, 3))]
    return spheres


def bending(tmp_path, spheres):
    lines = input_lines(spheres, f"clumps_only yes rigid_clumps auto shell 12 visc 0.7 add_force yes {SOLVED}", tmp_path / "data", comm=WIDE, dt=0.01)
    at = lines.index("bond_style zero")
    lines[at:at + 2] = ["bond_style harmonic", "bond_coeff 1 5 2.3"]
    return lines + ["group rigid id 4:6", "group soft subtract all rigid", "special_bonds lj/coul 0 1 1", "fix down all addforce 3.0 1.0 -2.0",
                    "fix rigid rigid rigid/small molecule", "fix nve soft nve/sphere"]


@pytest.mark.parametrize("ranks", [1, 2])
def test_auto_run_cut_in_pieces_is_the_same_run(tmp_path, ranks):
    spheres = flexible(3)
    columns = "xu yu zu vx vy vz f_drag[1]"
    frames, shapes = [], []
    for runs in (["run 40"], ["run 20"] * 2, ["run 10"] * 4):
        shapes.append(lmp(tmp_path, bending(tmp_path, spheres) + dump_lines(tmp_path / "dump", every=40, columns=columns) + runs,
                          ranks=ranks).log.count("Rigid clumps, shape"))
        frames.append(read_dump(tmp_path / "dump")[-1])
    assert [step for step, _ in frames] == [40, 40, 40]
    for _, rows in frames[1:]:
        assert np.abs(rows - frames[0][1]).max() < 1e-10 * np.abs(frames[0][1]).max()
    assert shapes == shapes[:1] * 3


def test_auto_restart_knows_who_is_loose(tmp_path):
    spheres = flexible(3)
    spheres.molecule[:3] = -9
    columns = "xu yu zu vx vy vz f_drag[1]"
    lmp(tmp_path, bending(tmp_path, spheres) + [f"restart 20 {tmp_path}/restart"] + dump_lines(tmp_path / "whole", every=40, columns=columns) + ["run 40"])
    lines = bending(tmp_path, spheres)
    after = lines[lines.index("group rigid id 4:6") + 2:]
    text = lmp(tmp_path, ["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/restart.20", WIDE, "fix drag all stokes_dynamics"] + after
               + dump_lines(tmp_path / "rest", every=40, columns=columns) + ["run 20"], ranks=2).log
    assert text.count("Rigid clumps, shape") == 1
    whole, rest = read_dump(tmp_path / "whole")[-1][1], read_dump(tmp_path / "rest")[-1][1]
    assert np.abs(whole - rest).max() < 1e-10 * np.abs(whole).max()


def test_bent_clump_does_not_hide_one_that_is_split(simulation):
    """auto: molecule 13 bends in the very step in which molecule 3 loses two spheres to the group."""
    spheres, _ = many("square", 2)
    spheres.v[4:] = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 1)]
    sim = simulation(spheres, f"clumps_only yes rigid_clumps auto visc 1.3 {SOLVED} region r", comm=WIDE, dt=1e-2,
                     before_pair="region r block {} 100 -100 100 -100 100".format(np.sort(spheres.x[:4, 0])[1:3].mean() - 1.0))
    spheres.v[:4] = 0.0
    with pytest.raises(Exception, match="molecule 3 is split"):
        sim.commands("velocity all set -1 0 0 sum yes\nfix nve all nve/sphere").run(400)


@pytest.mark.parametrize("many_lost", [3000])
def test_many_clumps_that_lose_atoms_at_once_are_no_recursion(simulation, many_lost):
    x = np.array([(5.0 * (k % 100), 5.0 * (k // 100), z) for k in range(many_lost) for z in (0.0, 2.0)])
    spheres = Spheres(x, 1.0, (0, 0, 0.1), np.repeat(np.arange(1, many_lost + 1), 2))
    sim = simulation(spheres, "clumps_only yes rigid_clumps auto visc 1", comm=WIDE)
    sim.commands("fix nve all nve/limit 1e-9\nregion up block INF INF INF INF 1.0 INF\n"
                 f"fix lose all evaporate 1 {many_lost} up 4711").run(3)
    assert sim.n == many_lost
    assert np.abs(sim.drag[:, 2] / (-6 * np.pi * sim.v[:, 2]) - 1).max() < 0.05


@pytest.mark.hard_case("blow-up in a periodic box")
@pytest.mark.parametrize("far", [1e6, 1e20])
def test_positions_far_out_of_a_periodic_box_end_in_an_error(tmp_path, far):
    spheres, _ = many("square", 2, spacing=8.0)
    lines = input_lines(spheres, f"clumps_only yes rigid_clumps auto visc 1.3 {SOLVED}", tmp_path / "data", boundary="p p p",
                        box=[(-9.0, 15.0), (-9.0, 9.0), (-9.0, 9.0)], comm="comm_modify cutoff 6", dt=1e-3)
    ended = lmp(tmp_path, lines + ["neigh_modify every 1 delay 0 check yes", "fix nve all nve/sphere", "velocity all create 1.0 4711", "run 100",
                                   f"velocity all scale {far * far}", "timestep 1.0", "run 100"], timeout=20, succeed=False)
    assert "ERROR" in ended.text


@pytest.mark.parametrize("how", ["group half", "region r"])
def test_split_clump_is_an_error(simulation, how):
    spheres, _ = many("square", 2)
    x = spheres.x[0]
    with pytest.raises(Exception, match="the clump of molecule 3 is split by the keyword group or region"):
        simulation(spheres, f"clumps_only yes rigid_clumps yes visc 1.3 {how}", comm=WIDE,
                   before_pair="group half id 1:2 5:8\nregion r sphere {} {} {} 1.0".format(*x)).run(0)


@pytest.mark.parametrize("words, message", [
    ("cut_off_distance inf rigid_clumps yes", "keyword rigid_clumps: with clumps_only no, rotation yes .or a shell. is required"),
    ("clumps_only yes cut_off_distance 5 rigid_clumps yes", "keyword rigid_clumps: no cut_off_distance may be given"),
    ("clumps_only yes rigid_clumps maybe", "keyword rigid_clumps: 'maybe' is none of: no, yes, auto"),
    ("clumps_only yes rigid_clumps yes shell 7", "keyword shell: '7' must be 1 or >= 12"),
    ("clumps_only yes rigid_clumps yes shell -1", "keyword shell: '-1' must be >= 1"),
    ("clumps_only yes shell 12", "keyword shell requires rigid_clumps yes"),
    ("clumps_only yes rigid_clumps yes tensor oseen", "keyword rigid_clumps is not available with tensor oseen"),
])
def test_bad_input(simulation, words, message):
    with pytest.raises(Exception, match=message):
        simulation(Spheres([[0, 0, 0]]), f"{words} visc 1")


@pytest.mark.hard_case("rigid clump with equal spheres at one point")
def test_spheres_at_one_point_are_an_error(simulation):
    with pytest.raises(Exception, match="two of its spheres of equal radius are at one point"):
        simulation(Spheres([[0, 0, 0], [0, 0, 0], [1, 0, 0]], molecule=1), "clumps_only yes rigid_clumps yes visc 1").run(0)


def test_a_resistance_too_large_for_memory_is_an_error_before_anything_is_allocated(simulation):
    with pytest.raises(Exception, match="needs .* GB, more than 4; use a smaller shell"):
        simulation(Spheres(CLUSTERS["fcc13"], molecule=1), "clumps_only yes rigid_clumps yes shell 100000000 visc 1", comm=WIDE).run(0)


def test_ghosts_too_short_for_a_clump_are_an_error(tmp_path):
    spheres = Spheres(np.column_stack((2.0 * np.arange(10), np.zeros(10), np.zeros(10))), molecule=1)
    ended = lmp(tmp_path, input_lines(spheres, "clumps_only yes rigid_clumps yes visc 1", tmp_path / "data") + ["run 0"], ranks=2,
                succeed=False)
    assert "use: comm_modify cutoff 18.3" in ended.text


