"""rigid_clumps yes: resistances computed once per shape, forces from pose and slip motion."""
import numpy as np
import pytest

from host import allowed
from model import forces, read_table
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
    """count copies of a cluster on a row, each turned, its spheres in another order, in rigid motion; returns motion
    too."""
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
    return next(r["kind"] for r in read_table("clusters_full.csv") if r["name"] == name and
                r["kind"].startswith("exact"))


@pytest.mark.parametrize("shell", [12, 42])
@pytest.mark.parametrize("name", CLUSTERS)
def test_shells_come_close_to_the_exact_drag(simulation, name, shell):
    x = CLUSTERS[name]
    R = resistance(simulation(Spheres(x, molecule=1), f"clumps_only yes rigid_clumps yes shell {shell} visc 1",
                              comm=WIDE), x)
    exact = tabulated(name, exact_kind(name))
    assert np.abs(R - R.T).max() < 1e-9 * np.abs(R).max()
    for block, limit in ((slice(0, 3), TRANSLATION[shell]), (slice(3, 6), ROTATION[shell])):
        ours, theirs = np.linalg.eigvalsh(R[block, block]), np.linalg.eigvalsh(exact[block, block])
        assert np.abs(ours / theirs - 1).max() < limit


def test_lone_spheres_and_single_sphere_clumps_have_stokes_drag_and_torque(simulation):
    a, eta = 0.7, 1.3
    v, w = np.array([[0.3, -1.0, 0.4], [0.7, 0.1, -0.2]]), np.array([[0.2, 0.5, -0.4], [1.0, -0.3, 0.6]])
    sim = simulation(Spheres([[0, 0, 0], [1.1, 0.3, 0]], a, v, [0, 4]),
                     f"clumps_only yes rigid_clumps yes shell 42 visc {eta}")
    F, T = forces_and_torques(sim, w)
    assert np.abs(F + 6 * np.pi * eta * a * v).max() < 1e-10 * np.abs(F).max()
    assert np.abs(T + 8 * np.pi * eta * a**3 * w).max() < 1e-10 * np.abs(T).max()


def test_equal_clumps_share_one_shape_and_mirror_images_do_not(tmp_path):
    spheres, _ = many("helix4_chiral", 5)
    mirror = Spheres(spheres.x * [1, 1, -1] + [0, 0, 30], 1.0, spheres.v, np.array(spheres.molecule) + 1000)
    both = Spheres(np.vstack((spheres.x, mirror.x)), 1.0, np.vstack((spheres.v, mirror.v)),
                   np.concatenate((spheres.molecule, mirror.molecule)))
    for n, system in ((1, spheres), (2, both)):
        text = lmp(tmp_path, input_lines(system, "clumps_only yes rigid_clumps yes shell 12 visc 1", tmp_path / "data",
                                         comm=WIDE)
                   + ["run 0", "run 0"], ranks=2).log
        assert text.count("Rigid clumps, shape") == n
        assert "hydrodynamic radius" in text


def test_mirror_image_flips_the_coupling(simulation):
    """Coupling of force and rotation, about the centroid: C' = -P C P for the image in the mirror P."""
    x, P = CLUSTERS["helix4_chiral"], np.diag([1.0, 1.0, -1.0])
    couplings = []
    for y in (x, x @ P):
        R = resistance(simulation(Spheres(y, molecule=1), "clumps_only yes rigid_clumps yes shell 42 visc 1",
                                  comm=WIDE), y)
        couplings.append(R[:3, 3:])
    assert np.abs(couplings[0]).max() > 0.5
    assert np.abs(couplings[1] + P @ couplings[0] @ P).max() < 1e-9 * np.abs(couplings[0]).max()


# Any linear flow: G of u = G x, as formulas or stored per atom.
G = np.array([[0.2, 0.3, -0.2], [0.1, -0.5, 0.5], [-0.4, 0.25, 0.3]])
FORMULAS = "\n".join("variable g{} atom {}*x+{}*y+{}*z".format(n, *row) for n, row in zip("xyz", G))
STORED = ("fix u all property/atom d_ux d_uy d_uz\n" + "\n".join(f"set group all d_u{n} v_g{n}" for n in "xyz")
          + "\ncompute u all property/atom d_ux d_uy d_uz\n" +
          "\n".join(f"variable s{n} atom c_u[{k + 1}]" for k, n in enumerate("xyz")))


@pytest.mark.parametrize("name", ["doublet", "trimer_line", "square", "tetrahedron", "helix4_chiral"])
def test_linear_flow_is_exact(simulation, name):
    """With one point per sphere: the same as the ordinary solve in the same flow, clumps in rigid motion."""
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
        sim = simulation(spheres, f"clumps_only yes rigid_clumps yes shell 12 visc 1.3 fluid_velocity v_{prefix}x "
                                  f"v_{prefix}y v_{prefix}z",
                         before_pair=lines, comm=WIDE)
        answers.append(np.hstack(forces_and_torques(sim, omega)))
    assert np.abs(answers[0] - answers[1]).max() < 1e-9 * np.abs(answers[0]).max()


def test_chain_along_the_flow_of_a_shear_feels_the_vorticity(simulation):
    """u_x = g z, chain of 3 along x: its centres see no velocity at all, but it must turn. Against the ordinary solve
    with torques."""
    g = 0.9
    spheres = Spheres(CLUSTERS["trimer_line"][:, [2, 1, 0]], 1.0, molecule=1)
    # The strain turns a row of touching spheres by the part B of Jeffery's orbit; at rest, torque = R_rot g/2 (1 - B)
    # about y.
    R = resistance(simulation(spheres, f"clumps_only yes visc 1 rotation yes {SOLVED}", comm=WIDE), spheres.x)
    answers = []
    for words in (f"rotation yes {SOLVED}", "rigid_clumps yes rotation yes"):
        sim = simulation(spheres, f"clumps_only yes visc 1 {words} fluid_velocity v_ux 0 0",
                         before_pair=f"variable ux atom {g}*z", comm=WIDE)
        sim.run(0)
        F, T = sim.drag, torques(sim)
        answers.append((T + np.cross(spheres.x, F)).sum(axis=0))
    assert 0.0 < answers[0][1] < 0.5 * R[4, 4] * g / 2
    assert np.abs(answers[1] - answers[0]).max() < 1e-9 * answers[0][1]


@pytest.mark.parametrize("words", ["rotation no", "rotation yes", "shell 12"])
def test_ranks_periodic_borders_and_order_leave_the_motion_alone(tmp_path, words):
    """Clumps that move under fix rigid/small in a periodic box, across its borders, 1 against 2 and 4 ranks, list and
    tiled."""
    spheres, _ = many("tetrapod5", 6, spacing=9.0)
    box = [(-9.0, 45.0), (-9.0, 9.0), (-9.0, 9.0)]
    last = {}
    for ranks, comm in allowed((1, ""), (2, ""), (4, "comm_style tiled\nbalance 1.0 rcb")):
        lines = input_lines(spheres, f"clumps_only yes rigid_clumps yes {words} visc 1.3", tmp_path / "data",
                            boundary="p p p", box=box, comm="comm_modify cutoff 6\n" + comm, dt=0.01)
        lines += ["thermo_style custom step", "fix down all addforce 3.0 1.0 -2.0",
                  "fix rigid all rigid/small molecule"]
        lines += dump_lines(tmp_path / "dump", every=200,
                            columns="xu yu zu vx vy vz f_drag[1] f_drag[2] f_drag[3]") + ["run 200"]
        lmp(tmp_path, lines, ranks=ranks)
        last[ranks] = read_dump(tmp_path / "dump")[-1][1]
    assert np.abs(last[1][:, 0:3] - spheres.x).max() > 0.5
    for ranks in allowed(2, 4):
        for c in (slice(0, 3), slice(3, 6), slice(6, 9)):
            assert np.abs(last[ranks][:, c] - last[1][:, c]).max() < 1e-10 * np.abs(last[1][:, c]).max()


def test_restart_goes_on_as_the_unbroken_run(tmp_path):
    spheres, _ = many("helix4_chiral", 3)
    lines = input_lines(spheres, "clumps_only yes rigid_clumps yes shell 12 visc 1.3", tmp_path / "data", comm=WIDE,
                        dt=0.01)
    moves = ["thermo_style custom step", "fix down all addforce 3.0 1.0 -2.0", "fix rigid all rigid/small molecule"]
    columns = "xu yu zu vx vy vz f_drag[1] f_drag[7] f_drag[8]"
    lmp(tmp_path, lines + moves + [f"restart 50 {tmp_path}/restart"] +
        dump_lines(tmp_path / "whole", every=100, columns=columns)
        + ["run 100"])
    lmp(tmp_path, ["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/restart.50", WIDE,
                   "fix drag all stokes_dynamics"] + moves
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
