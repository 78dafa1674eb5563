"""rotation yes: forces and torques of spheres that move and spin."""
import numpy as np
import pytest

from model import read_table
from system import Spheres, dump_lines, input_lines, lmp, read_dump

EXACT = "algorithm 2 relative_tolerance 1e-12 max_iter 1000"


def clusters():
    shapes = {}
    for row in read_table("cluster_geometry.csv"):
        shapes.setdefault(row["name"], []).append([float(row[c]) for c in "xyz"])
    return {name: np.array(x) for name, x in shapes.items()}


CLUSTERS = clusters()


def tabulated(name, kind):
    for row in read_table("clusters_full.csv"):
        if row["name"] == name and row["kind"] == kind:
            return np.array([[float(row[f"R{i}{j}"]) for j in range(1, 7)] for i in range(1, 7)])
    raise KeyError(name)


def rigid_motion(x, mode):
    """Velocities and angular velocities of spheres in unit translation (mode 0-2) or rotation (3-5) about their
    centroid."""
    U, W = np.zeros(3), np.zeros(3)
    (U if mode < 3 else W)[mode % 3] = 1.0
    return U + np.cross(W, x - x.mean(axis=0)), np.broadcast_to(W, x.shape)


def torques(sim):
    return sim.fix_rows()[:, 6:9]


def resistance(sim, x):
    """6x6 about the centroid, from six rigid motions of the spheres of a simulation."""
    R = np.zeros((6, 6))
    for mode in range(6):
        v, w = rigid_motion(x, mode)
        order = sim.ids() - 1    # every run may sort the atoms anew
        sim.raw("v")[:], sim.raw("omega")[:] = v[order], w[order]
        sim.run(0)
        F, T = sim.drag, torques(sim)
        R[:3, mode] = -F.sum(axis=0)
        R[3:, mode] = -(T + np.cross(x - x.mean(axis=0), F)).sum(axis=0)
    return R


@pytest.mark.parametrize("scene", ["cut_off_distance inf", "clumps_only yes", "cut_off_distance 40"])
@pytest.mark.parametrize("name", CLUSTERS)
def test_resistance_is_that_of_beads_with_torques(simulation, name, scene):
    x = CLUSTERS[name]
    sim = simulation(Spheres(x, molecule=1), f"{scene} visc 1 rotation yes {EXACT}", comm="comm_modify cutoff 40")
    R, expected = resistance(sim, x), tabulated(name, "rpy_tt_rt_rr")
    assert np.abs(R - expected).max() < 1e-8 * np.abs(expected).max()
    assert np.abs(R - R.T).max() < 1e-9 * np.abs(R).max()


@pytest.mark.parametrize("s, n", [(1.5, 2), (1.0, 2), (0.5, 2), (1.0, 5), (0.5, 5)])
def test_fused_chains(simulation, s, n):
    row = next(r for r in read_table("fused.csv") if int(r["N"]) == n and float(r["s_over_a"]) == s)
    x = np.zeros((n, 3))
    x[:, 2] = s * np.arange(n)
    R = resistance(simulation(Spheres(x, molecule=1), f"cut_off_distance inf visc 1 rotation yes {EXACT}"), x)
    assert R[2, 2] / (6 * np.pi) == pytest.approx(float(row["Fpar_rpy6"]), rel=2e-8)
    assert R[0, 0] / (6 * np.pi) == pytest.approx(float(row["Fperp_rpy6"]), rel=2e-8)
    assert R[3, 3] / (8 * np.pi) == pytest.approx(float(row["Rrot_rpy6"]), rel=2e-8)


@pytest.mark.hard_case("spin of a lone sphere, rotation yes")
def test_lone_sphere_spins_against_its_torque(simulation):
    a, eta, w = 0.7, 1.3, np.array([0.3, -0.8, 1.1])
    sim = simulation(Spheres([[0.1, 0.2, 0.3]], a), f"cut_off_distance inf visc {eta} rotation yes")
    sim.raw("omega")[:] = w
    sim.run(0)
    assert torques(sim)[0] == pytest.approx(-8 * np.pi * eta * a**3 * w, rel=1e-14)
    assert np.abs(sim.drag).max() == 0.0
    assert sim.fix_scalar() == pytest.approx(8 * np.pi * eta * a**3 * w @ w, rel=1e-14)


def random_scene(seed=3, n=12):
    rng = np.random.default_rng(seed)
    return (Spheres(rng.uniform(0, 6, (n, 3)), rng.uniform(0.3, 1.2, n), rng.normal(size=(n, 3))),
            rng.normal(size=(n, 3)))


def test_torque_reaches_the_atoms_either_way(simulation):
    answers = []
    for style, fix in (("add_force yes", True), ("add_force no", True)):
        spheres, w = random_scene()
        sim = simulation(spheres, f"cut_off_distance inf visc 1.3 rotation yes {EXACT} {style}", fix=fix)
        sim.raw("omega")[:] = w[sim.ids() - 1]
        sim.run(0)
        assert np.abs(sim.atom("torque") - torques(sim)).max() < 1e-12 * np.abs(torques(sim)).max()
        assert np.abs(sim.f - sim.drag).max() < 1e-12 * np.abs(sim.drag).max()
        answers.append(torques(sim))
    assert np.abs(answers[0] - answers[1]).max() < 1e-11 * np.abs(answers[0]).max()


# A linear flow: u = G x. Its gradient is found from the formulas, so what moves with the fluid feels nothing.
FLOW = """variable gx atom 0.3*y-0.2*z
variable gy atom 0.5*z+0.1*x
variable gz atom -0.4*x"""
G = np.array([[0, 0.3, -0.2], [0.1, 0, 0.5], [-0.4, 0, 0]])


@pytest.mark.parametrize("scene", ["cut_off_distance inf", "clumps_only yes"])
def test_what_rotates_with_the_fluid_feels_only_its_strain(simulation, scene):
    """Rigid rotation of the fluid: no force and no torque on spheres that take part."""
    spheres, _ = random_scene()
    spheres.molecule[:] = 1
    spin = np.array([0.3, -0.7, 0.5])
    formulas = "\n".join(f"variable {n} atom {w}" for n, w in zip(
        ("gx", "gy", "gz"), (f"{spin[1]}*z-{spin[2]}*y", f"{spin[2]}*x-{spin[0]}*z", f"{spin[0]}*y-{spin[1]}*x")))
    spheres.v = np.cross(spin, spheres.x)
    sim = simulation(spheres, f"{scene} visc 1.3 rotation yes {EXACT} fluid_velocity v_gx v_gy v_gz",
                     before_pair=formulas, comm="comm_modify cutoff 40")
    sim.raw("omega")[:] = spin
    sim.run(0)
    free = 6 * np.pi * 1.3
    assert np.abs(sim.drag).max() < 1e-12 * free
    assert np.abs(torques(sim)).max() < 1e-12 * free


def test_vorticity_given_equals_vorticity_of_the_formulas(simulation):
    spheres, w = random_scene()
    vorticity = [G[2, 1] - G[1, 2], G[0, 2] - G[2, 0], G[1, 0] - G[0, 1]]
    answers = []
    for extra in ("", "fluid_vorticity {} {} {}".format(*vorticity)):
        sim = simulation(spheres,
                         f"cut_off_distance inf visc 1.3 rotation yes {EXACT} fluid_velocity v_gx v_gy v_gz {extra}",
                         before_pair=FLOW)
        sim.raw("omega")[:] = w[sim.ids() - 1]
        before = sim.x
        sim.run(0)
        assert np.array_equal(sim.x, before)
        answers.append(np.hstack((sim.drag, torques(sim))))
    assert np.abs(answers[0] - answers[1]).max() < 1e-12 * np.abs(answers[0]).max()


def test_bead_in_shear_rotates_with_half_the_vorticity(simulation):
    """Free sphere, no torque: its torque is 8 pi eta a^3 (w_inf - W)."""
    sim = simulation(Spheres([[0.5, 0.2, 2.0]], 0.7),
                     "cut_off_distance inf visc 1.3 rotation yes fluid_velocity v_ux 0 0",
                     before_pair="variable ux atom 0.9*z")
    sim.run(0)
    assert torques(sim)[0] == pytest.approx(8 * np.pi * 1.3 * 0.343 * np.array([0, 0.45, 0]), abs=1e-13)


@pytest.mark.parametrize("ranks", [2, 4])
def test_ranks_agree_also_with_rotation(tmp_path, ranks):
    """A moving scene with update_every, list and all pairs: 1 rank against more."""
    spheres, _ = random_scene(n=20)
    spheres.molecule[:] = np.repeat([1, 2, 3, 4], 5)
    for scene in ("cut_off_distance inf", "clumps_only yes"):
        last = []
        for np_ in (1, ranks):
            lines = input_lines(spheres, f"{scene} visc 1.3 rotation yes {EXACT} update_every 3", tmp_path / "data",
                                dt=1e-4, comm="comm_modify cutoff 30")
            lines += ["fix nve all nve/sphere"] + dump_lines(tmp_path / "dump", every=7,
                                                             columns="x y z omegax omegay omegaz "
                                                             "f_drag[7] f_drag[8] f_drag[9]") + ["run 7"]
            lmp(tmp_path, lines, ranks=np_)
            last.append(read_dump(tmp_path / "dump")[-1][1])
        for c in (slice(0, 3), slice(3, 6), slice(6, 9)):
            assert np.abs(last[0][:, c] - last[1][:, c]).max() < 1e-10 * np.abs(last[0][:, c]).max()


def test_restart_goes_on_as_the_unbroken_run(tmp_path):
    spheres, _ = random_scene()
    lines = input_lines(spheres, f"cut_off_distance inf visc 1.3 rotation yes {EXACT} update_every 4",
                        tmp_path / "data", dt=1e-4)
    columns = "x y z omegax omegay omegaz f_drag[7] f_drag[8] f_drag[9]"
    lmp(tmp_path, lines + ["fix nve all nve/sphere", f"restart 10 {tmp_path}/restart"]
        + dump_lines(tmp_path / "whole", every=20, columns=columns) + ["run 20"])
    lmp(tmp_path, ["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/restart.10",
                   "fix drag all stokes_dynamics", "fix nve all nve/sphere"] +
        dump_lines(tmp_path / "rest", every=20, columns=columns) + ["run 10"])
    whole, rest = read_dump(tmp_path / "whole")[-1][1], read_dump(tmp_path / "rest")[-1][1]
    assert np.abs(whole - rest).max() < 1e-10 * np.abs(whole).max()


def test_oseen_has_no_rotation(simulation):
    with pytest.raises(Exception, match="keyword rotation: yes is not available with tensor oseen"):
        simulation(Spheres([[0, 0, 0]]), "cut_off_distance inf visc 1 rotation yes tensor oseen")


def test_vorticity_needs_rotation(simulation):
    with pytest.raises(Exception, match="fluid_vorticity has no effect without rotation yes"):
        simulation(Spheres([[0, 0, 0]]), "cut_off_distance inf visc 1 fluid_vorticity 1 0 0")
