"""Forces, density rates and filtered densities of one instant, against the reference tables and an independent
evaluation."""
import numpy as np
import pytest

import sph_tools as T
from sph_tools import by_id, evaluate, fix_by_id, pair_commands, random_scene, run, start, table, tait, vectors


@pytest.fixture
def lmp():
    made = []

    def make(*args):
        while made:
            made.pop().close()
        made.append(start(args))
        return made[-1]

    yield make
    while made:
        made.pop().close()


def off(value, expected):
    """Largest difference over the largest value."""
    return np.abs(value - expected).max() / np.abs(expected).max()


def own(name, lmp, artvisc, tenscorr, dim=3, mu=0.0):
    types = by_id(lmp, "type") - 1
    each = lambda values: np.array(values)[types]
    rho = by_id(lmp, "rho")
    return evaluate(name, dim, by_id(lmp, "x", 3), by_id(lmp, "v", 3), rho, tait(rho), each(T.MASS), each(T.H),
                    (each(T.ALPHA), each(T.BETA), each(T.C), T.ETA) if artvisc else None,
                    (T.EPSILON, each(T.DELTAP)) if tenscorr else None, mu)


# The limits are the truncated kernel constants of the program that made the tables.
@pytest.mark.parametrize("name, limit", [("cubicspline", 6e-6), ("wendland", 3e-10)])
@pytest.mark.parametrize("artvisc, tenscorr", [(0, 0), (0, 1), (1, 0)])
@pytest.mark.parametrize("newton", ["on", "off"])
def test_forces_against_tables(lmp, name, limit, artvisc, tenscorr, newton):
    L = lmp()
    run(L, random_scene(newton) + pair_commands(name, artvisc, tenscorr) + "\nfix move all nve/sph\nrun 0")
    expected = table("s_rand3d_%s_av%d_tc%d.csv" % (name, artvisc, tenscorr))
    assert np.abs(by_id(L, "v", 3) - vectors(expected, "vx vy vz")).max() == 0.0
    assert off(by_id(L, "f", 3), vectors(expected, "fx fy fz")) <= limit
    assert off(fix_by_id(L, "eos"), expected["p"]) <= 1e-12
    F, drho, _, _ = own(name, L, artvisc, tenscorr)
    assert off(by_id(L, "f", 3), F) <= 1e-12
    assert off(fix_by_id(L, "density"), drho) <= 1e-12


@pytest.mark.parametrize("name", ["cubicspline", "wendland", "cubicspline2d", "wendland2d"])
@pytest.mark.parametrize("mu", [0.0, 0.7])
@pytest.mark.parametrize("integrator", ["nve/sph", "sph"])
def test_every_term_at_once(lmp, name, mu, integrator):
    """Also what no table has: both corrections together, viscosity, the two-dimensional kernels, LAMMPS's own fix
    sph."""
    L = lmp()
    extra = "viscosity %g" % mu if mu else ""
    run(L, random_scene() + pair_commands(name, 1, 1, extra) + "\nfix move all %s\nrun 0" % integrator)
    F, drho, _, _ = own(name.replace("2d", ""), L, 1, 1, 2 if "2d" in name else 3, mu)
    assert off(by_id(L, "f", 3), F) <= 1e-12
    assert off(by_id(L, "drho"), drho) <= 1e-12


@pytest.mark.parametrize("name", ["cubicspline", "wendland"])
def test_two_dimensions_follow_the_box(lmp, name):
    L = lmp()
    run(L, """
    units si
    dimension 2
    atom_style sph
    atom_modify map array
    lattice sq 0.01
    region box block 0 0.1 0 0.1 -0.005 0.005 units box
    create_box 1 box
    create_atoms 1 box
    displace_atoms all random 0.003 0.003 0 4711 units box
    mass 1 0.1
    variable a atom 0.3*sin(300*x)
    variable rho atom 1000+20*sin(200*y)
    velocity all set v_a v_a 0
    set group all sph/rho 1000
    set atom * sph/rho v_rho
    neighbor 0.003 bin
    pair_style sph/artVisc/tensCorr %s 0.013 artVisc 0.1 0.2 1e-6 tensCorr 0.2 0.01 viscosity 0.4
    pair_coeff * * c 20
    fix eos all sph/pressure Tait 60000 1000 7
    fix density all sph/density/continuity
    fix move all nve/sph
    run 0
    """ % name)
    n = 100
    one = np.ones(n)
    rho = by_id(L, "rho")
    F, drho, _, _ = evaluate(name, 2, by_id(L, "x", 3), by_id(L, "v", 3), rho, tait(rho), 0.1 * one, 0.013 * one,
                             (0.1 * one, 0.2 * one, 20 * one, 1e-6), (0.2, 0.01 * one), 0.4, np.array([0.1, 0.1, 1.0]))
    assert off(by_id(L, "f", 3), F) <= 1e-12
    assert off(by_id(L, "drho"), drho) <= 1e-12


@pytest.mark.parametrize("artvisc", [0, 1])
@pytest.mark.parametrize("newton", ["on", "off"])
def test_diffusion_with_types_that_differ_only_in_the_speed_of_sound(lmp, artvisc, newton):
    """Without artVisc no other term asks for c, and the types must not be taken for one."""
    L = lmp()
    run(L, random_scene(newton) + """
    mass * 0.001
    pair_style sph/artVisc/tensCorr wendland 0.0125 %s
    pair_coeff 1 1 c 2
    pair_coeff 2 2 c 20
    unfix density
    fix density all sph/density/continuity delta 0.1
    fix move all nve/sph
    run 0
    """ % ("artVisc 0.05 0.1 1e-6" if artvisc else ""))
    types, rho, x = by_id(L, "type"), by_id(L, "rho"), by_id(L, "x", 3)
    one = np.ones(len(rho))
    drho = evaluate("wendland", 3, x, by_id(L, "v", 3), rho, tait(rho), 0.001 * one, 0.0125 * one)[1]
    drho += T.diffusion("wendland", 3, x, rho, 0.001 * one, 0.0125 * one, np.where(types == 1, 2.0, 20.0), 0.1)
    assert off(fix_by_id(L, "density"), drho) <= 1e-12


def test_density_rate_against_tables(lmp):
    """The peer's density after a step of 1e-3 from the positions of its step 1, where velocities are those of the
    start."""
    first, second = table("d_rand3d_cubicspline_m1_step1.csv"), table("d_rand3d_cubicspline_m1_step2.csv")
    expected = (second["rho"] - first["rho"]) / 1e-3
    L = lmp()
    run(L, random_scene() + pair_commands("cubicspline", 1, 0) + "\nfix move all nve/sph")
    for k, axis in enumerate("xyz"):
        for i, value in enumerate(first[axis]):
            L.command("set atom %d %s %.17g" % (i + 1, axis, value))
    L.command("run 0")
    assert off(fix_by_id(L, "density"), expected) <= 6e-6


@pytest.mark.parametrize("newton", ["on", "off"])
def test_shepard_filter_against_table(lmp, newton):
    expected = table("d_rand3d_cubicspline_m3.csv")
    L = lmp()
    run(L, random_scene(newton) + pair_commands("cubicspline", 1, 0) +
        "\nfix filter all sph/density/corr shepard every 1\nfix move all nve/sph\ntimestep 1e-12\nrun 1")
    assert off(by_id(L, "rho") - 1000.0, expected["rho"] - 1000.0) <= 6e-6


@pytest.mark.parametrize("name", ["cubicspline", "wendland"])
@pytest.mark.parametrize("newton", ["on", "off"])
def test_summation(lmp, name, newton):
    L = lmp()
    run(L, random_scene(newton, density="summation") + pair_commands(name, 1, 1) + "\nfix move all nve/sph\nrun 0")
    F, _, rho, _ = own(name, L, 1, 1)
    assert off(by_id(L, "rho"), rho) <= 1e-12
    assert off(by_id(L, "f", 3), F) <= 1e-12


@pytest.mark.parametrize("words, state", [("absolut 7.5", lambda r: 7.5**2 * r),
                                          ("relativ 130 990", lambda r: 130 * (r - 990)),
                                          ("relativ 130 990 55", lambda r: 130 * (r - 990) + 55),
                                          ("Tait 5e4 990 7", lambda r: 5e4 * ((r / 990) ** 7 - 1)),
                                          ("Tait 5e4 990 1.4 -55", lambda r: 5e4 * ((r / 990) ** 1.4 - 1) - 55)])
def test_equations_of_state(lmp, words, state):
    L = lmp()
    run(L, random_scene() + "unfix eos\nfix eos all sph/pressure " + words + "\n" + pair_commands("wendland", 0, 0) +
        "\nfix move all nve/sph\nrun 0")
    assert off(fix_by_id(L, "eos"), state(by_id(L, "rho"))) <= 1e-12


def test_state_per_group(lmp):
    L = lmp()
    run(L, random_scene() + """
    unfix eos
    group one type 1
    group two type 2
    fix eos one sph/pressure Tait 60000 1000 7
    fix two two sph/pressure relativ 100 990
    """ + pair_commands("wendland", 0, 0) + "\nfix move all nve/sph\nrun 0")
    rho, types = by_id(L, "rho"), by_id(L, "type")
    assert off(fix_by_id(L, "eos"), np.where(types == 1, tait(rho), 100 * (rho - 990))) <= 1e-12


@pytest.mark.parametrize("newton", ["on", "off"])
def test_virial_is_that_of_the_pair_forces(lmp, newton):
    """The sum of d F over all pairs, from numpy; and per atom it adds up to the same."""
    L = lmp()
    run(L, random_scene(newton) + pair_commands("wendland", 1, 1, "viscosity 0.7") +
        "\nfix move all nve/sph\ncompute w all pressure NULL virial\ncompute a all stress/atom NULL virial\n"
        "compute s all reduce sum c_a[1] c_a[2] c_a[3] c_a[4] c_a[5] c_a[6]\n"
        "thermo_style custom step c_w[1] c_w[4] c_s[1]\nrun 0")
    x, F = by_id(L, "x", 3), by_id(L, "f", 3)
    volume = 0.165**3
    exact = [(x[:, a] * F[:, b]).sum() for a, b in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    pressure = np.array(L.numpy.extract_compute("w", 0, 1)) * volume
    stress = np.array(L.numpy.extract_compute("s", 0, 1))
    # The viscous force is not central, so xy and yx differ; LAMMPS keeps x_a F_b with a < b.
    assert np.abs(pressure - exact).max() <= 1e-12 * np.abs(exact).max()
    assert np.abs(-stress - exact).max() <= 1e-12 * np.abs(exact).max()


def test_hybrid_overlay(lmp):
    """The same forces below pair_style hybrid/overlay, with another style that adds nothing at this distance."""
    L = lmp()
    run(L, random_scene() + pair_commands("wendland", 1, 1) + "\nfix move all nve/sph\nrun 0")
    alone = by_id(L, "f", 3)
    L = lmp()
    lines = pair_commands("wendland", 1, 1).split("\n")
    lines[0] = lines[0].replace("pair_style", "pair_style hybrid/overlay") + " zero 0.001"
    lines[1:] = [line.replace(" h ", " sph/artVisc/tensCorr h ") for line in lines[1:]]
    mean = lambda v: 0.5 * (v[0] + v[1])
    lines.append("pair_coeff 1 2 sph/artVisc/tensCorr h %.17g c %.17g alpha %.17g beta %.17g deltap %.17g" %
                 tuple(mean(v) for v in (T.H, T.C, T.ALPHA, T.BETA, T.DELTAP)))
    lines.append("pair_coeff * * zero")
    run(L, random_scene() + "\n".join(lines) + "\nfix move all nve/sph\nrun 0")
    assert off(by_id(L, "f", 3), alone) <= 1e-13


def test_fix_adapt_reaches_the_coefficients(lmp):
    L = lmp()
    run(L, random_scene() + pair_commands("wendland", 1, 0) +
        "\nfix move all nve/sph\nvariable c equal 40\nfix change all adapt 1 pair sph/artVisc/tensCorr c * * v_c\n"
        "run 0")
    changed = by_id(L, "f", 3)
    L = lmp()
    lines = pair_commands("wendland", 1, 0).split("\n")
    lines = [lines[0]] + [line.split(" c ")[0] + " c 40 alpha" + line.split(" alpha")[1] for line in lines[1:]]
    run(L, random_scene() + "\n".join(lines) + "\nfix move all nve/sph\nrun 0")
    assert off(changed, by_id(L, "f", 3)) <= 1e-13
