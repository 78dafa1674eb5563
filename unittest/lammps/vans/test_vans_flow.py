"""fix hydro/vans: one grain, closed forms of the fluid, clumps, and what LAMMPS offers around it."""
import numpy as np
import pytest
# close_scenes is a fixture
from vans_helper import WATER_ALONE, Scene, bed_script, close_scenes, run_lmp, write_columns  # noqa: F401

WATER = "fluid 1030 0.0017 gravity 0 0 -9.7"


def terminal_velocity(a, hindrance=1.0, rho=1030.0, eta=0.0017, density=2570.0, g=9.7):
    """(0.44 w + 24.4 nu/d) w = 4/3 (s-1) g d / hindrance"""
    B, C = 24.4 * eta / rho / (2 * a), 4 / 3 * (density / rho - 1) * g * 2 * a / hindrance
    return (-B + np.sqrt(B * B + 4 * 0.44 * C)) / 0.88


def settle(tmp_path, phi, drag="hindrance 3.1"):
    """Speed that one grain reaches in water at rest with a given phi."""
    a = 0.0011
    given = write_columns(tmp_path / "given", np.full(40, phi), np.zeros(40), np.zeros(40))
    s = Scene(box=(0, 0.02, 0, 0.02, 0, 4))
    s.spheres([[0.01, 0.01, 3.9]], [[0, 0, 0]], a, density=2570)
    s.do("timestep 2e-4", f"fix h all hydro/vans 1 mesh 40 0.1 0 {WATER} couple none given file {given} "
                          f"{drag} stream rest", "fix g all gravity 9.7 vector 0 0 -1",
         "fix m all nve/sphere", "run 10000")
    v = -s.atoms("v")[0, 2]
    s.close()
    return v


def test_terminal_velocity(tmp_path):
    assert abs(settle(tmp_path, 0.0) / terminal_velocity(0.0011) - 1) < 1e-6


@pytest.mark.parametrize("phi", [0.2, 0.45])
def test_hindered_settling(tmp_path, phi):
    """Terminal velocity with the drag (1 - phi)^-3.1 times as large, and from it the exponent: the ratio of the two
    drags at the speeds reached."""
    v = settle(tmp_path, phi)
    assert abs(v / terminal_velocity(0.0011, (1 - phi) ** -3.1) - 1) < 1e-6
    B = 24.4 * 0.0017 / 1030 / 0.0022
    free = terminal_velocity(0.0011)
    exponent = np.log((0.44 * v + B) * v / ((0.44 * free + B) * free)) / np.log(1 - phi)
    assert abs(exponent / 3.1 - 1) < 0.01


@pytest.mark.parametrize("law, phi", [("ergun", 0.55), ("gidaspow", 0.4)])
def test_settling_in_a_bed_by_ergun(tmp_path, law, phi):
    """6 pi a eta w (150 phi/(18 e^2) + 1.75 Re/(18 e)) is the submerged weight."""
    e, a, eta, rho = 1 - phi, 0.0011, 0.0017, 1030.0
    A, B, C = 1.75 * 2 * a * rho / eta / (18 * e), 150 * phi / (18 * e**2), 2 / 9 * a * a * (2570 - rho) * 9.7 / eta
    w = (-B + np.sqrt(B * B + 4 * A * C)) / (2 * A)
    assert abs(settle(tmp_path, phi, "drag " + law) / w - 1) < 1e-6


def test_poiseuille():
    """Discrete closed form u = -dpdx/(2 eta) (z (H-z) + dz^2/4), 1e-10 of the largest."""
    s = Scene()
    s.do("fix h all hydro/vans 1 mesh 26 0.04 0 fluid 1000 0.001 gravity 0 0 -9.81 couple fluid turbulence none "
         "surface speed 0 pressure_gradient -0.1 solve 1e7 1e4", "run 1")
    z, u = s.column("z", 26)[:25], s.column("u", 26)[:25]
    exact = 0.1 / 0.002 * (z * (1 - z) + 0.04 ** 2 / 4)
    assert np.abs(u - exact).max() < 1e-10 * exact.max()
    s.close()


@pytest.mark.parametrize("law, over", [("rousseau", 1.003), ("kz sublayer yes", 0.918), ("kz", 0.589)])
def test_friction_of_a_smooth_bottom_beside_keulegan(law, over):
    """Mean speed over u_star, beside 2.5 ln(H u_star/nu) + 3.25 (Keulegan 1938); rows of doc/vans_stream.md. Without
    grains rousseau had pores of no size, and met no number."""
    s = Scene()
    s.do(f"fix h all hydro/vans 1 mesh 627 $(0.02/626) 0 fluid 1000 0.001 couple fluid gravity {0.005 * 9.81} 0 -9.8 "
         f"turbulence {law} solve 2 0.2", "run 100")
    star = np.sqrt(0.005 * 9.81 * 0.02)
    keulegan = 2.5 * np.log(0.02 * star / 1e-6) + 3.25
    assert abs(s.number("discharge") / 0.02 / star / keulegan / over - 1) < 0.01
    s.close()


@pytest.mark.parametrize("words, over", [("sublayer yes", 1.08), ("", 0.66)])
def test_a_smooth_duct_below_a_lid_beside_the_logarithmic_law(words, over):
    """Of a channel with two walls, U/u_star = ln(H u_star/2 nu)/0.41 + 5.2 - 1/0.41, H u_star/2 nu = 1118. Both walls
    have their layer: the profile is the same from above."""
    s = Scene(style="atomic")
    s.do("fix h all hydro/vans 1 mesh 401 0.00025 0 fluid 1000 0.001 gravity 0 0 -9.8 couple fluid solve 1 0.1 "
         f"pressure_gradient -10 surface speed 0 turbulence pipe {words}", "run 400")
    u, star = s.column("u", 401)[:-1], np.sqrt(10 * 0.05 / 1000)
    s.close()
    assert np.abs(u - u[::-1]).max() < 1e-9 * u.max()
    assert u.mean() / star / (np.log(star * 0.05 / 1e-6) / 0.41 + 5.2 - 1 / 0.41) == pytest.approx(over, abs=0.02)


def test_a_lid_that_a_law_of_turbulence_does_not_know_is_told(tmp_path):
    """With kz it takes nine tenths of the drive; with sublayer a stream that its surface alone drives was laminar."""
    for words, says in (("surface speed 0 turbulence kz", "keyword surface: speed 0 is a lid at rest"),
                        ("surface speed 0 turbulence pipe", ""), ("surface speed 1 turbulence kz", ""),
                        ("surface speed 0 turbulence none", ""), ("turbulence kz sublayer yes", ""),
                        ("surface speed 1 turbulence pipe sublayer yes", ""),
                        ("surface speed 1 pressure_gradient 0 turbulence pipe sublayer yes", "keyword sublayer: its")):
        gradient = "" if "gradient" in words or "speed" not in words else "pressure_gradient -10"
        done = run_lmp(tmp_path, WATER_ALONE + f"""
fix vans all hydro/vans 1 mesh 401 0.00025 0 fluid 1000 0.001 gravity {0 if "speed" in words else 0.1} 0 -9.81 &
    couple fluid solve 0.1 0.1 {words} {gradient}
run 1
""")
        assert done.returncode == 0, done.stdout[-2000:]
        told = [line for line in done.stdout.splitlines() if "keyword surface:" in line or "keyword sublayer:" in line]
        assert len(told) == bool(says) and all(says in line for line in told)


def test_uneven_mesh(tmp_path):
    """Edges from a file: Poiseuille between slices that grow; the heights are the file's, and the first edge is the
    bottom."""
    edges = 0.5 + 0.7 * np.linspace(0, 1.02, 103) ** 1.2
    mesh = write_columns(tmp_path / "edges", edges)
    s = Scene()
    s.do(f"fix h all hydro/vans 1 mesh file {mesh} fluid 1100 0.002 gravity 0 0 -9.81 couple fluid turbulence none "
         "surface speed 0 pressure_gradient -0.13 solve 1e7 1e4", "run 1")
    z, u = s.column("z", 102)[:101] - 0.5, s.column("u", 102)[:101]
    H = edges[101] - 0.5
    exact = 0.13 / 0.004 * z * (H - z)
    assert np.allclose(s.column("z", 102), 0.5 * (edges[1:] + edges[:-1]), rtol=1e-14)
    assert np.abs(u - exact).max() < 2e-3 * exact.max()
    s.close()


def test_pressure_gradient_and_surface_speed_from_variables():
    """Twice the gradient, twice the flow."""
    u = []
    for gradient in ("-0.1", "v_p"):
        s = Scene()
        s.do("variable p equal -0.2", "variable w equal 0.0",
             f"fix h all hydro/vans 1 mesh 26 0.04 0 fluid 1000 0.001 gravity 0 0 -9.81 couple fluid turbulence none "
             f"surface speed v_w pressure_gradient {gradient} solve 1e7 1e4", "run 1")
        u.append(s.column("u", 26))
        s.close()
    assert np.abs(u[1] - 2 * u[0]).max() < 1e-10 * u[1].max()


def test_python_sets_the_profile():
    """fix_modify ID profile values: a frozen stream from python; the force follows at once."""
    s = Scene()
    s.spheres([[0.01, 0.01, 0.0155]], [[0, 0, 0]], 0.001)
    s.do(f"fix h all hydro/vans 1 mesh 20 0.001 0 {WATER} couple none", "run 0")
    assert s.atoms("f_h")[0, 0] == 0
    s.do("fix_modify h profile values " + " ".join("%g" % (0.02 * k) for k in range(21)), "run 0")
    w = 0.02 * 16
    drag = 0.5 * 1030 * np.pi * 1e-6 * (0.44 * w + 24.4 * 0.0017 / 1030 / 0.002) * w
    assert abs(s.atoms("f_h")[0, 0] / drag - 1) < 1e-12
    with pytest.raises(Exception, match="3 values, ncell \\+ 1 = 21 are needed"):
        s.do("fix_modify h profile values 1 2 3")
    s.close()


def test_region_and_group_choose_the_grains():
    """Outside the group: no force, but counted in the averages; outside the region: neither."""
    s = Scene()
    s.spheres([[0.005, 0.01, 0.0105], [0.01, 0.01, 0.0105], [0.015, 0.01, 0.0105]], np.zeros((3, 3)), 0.001)
    s.do("group some id 1 2", "region left block 0 0.008 INF INF INF INF",
         f"fix h some hydro/vans 1 mesh 20 0.001 0 {WATER} couple one stream rest", "run 0")
    volume = (s.column("phi", 20) * 0.001 * 4e-4).sum()
    assert abs(volume / (3 * 4 / 3 * np.pi * 1e-9) - 1) < 1e-12
    assert np.all((s.atoms("f_h")[:, 2] > 0) == [True, True, False])
    s.do("unfix h", f"fix h some hydro/vans 1 mesh 20 0.001 0 {WATER} couple one stream rest region left", "run 0")
    volume = (s.column("phi", 20) * 0.001 * 4e-4).sum()
    assert abs(volume / (4 / 3 * np.pi * 1e-9) - 1) < 1e-12
    assert np.all((s.atoms("f_h")[:, 2] > 0) == [True, False, False])
    s.close()


def test_a_grain_beyond_the_edge_of_the_box_is_where_its_image_is():
    """LAMMPS wraps it only when it re-neighbours. A region that ends at the edge has it all the while."""
    rows = []
    for along in ("INF INF", "0 0.02"):
        s = Scene()
        s.spheres([[0.0199, 0.01, 0.0105]], [[1, 0, 0]], 0.001)
        s.do(f"region r block {along} 0 0.02 INF INF units box", "fix move all nve/sphere",
             f"fix h all hydro/vans 1 mesh 20 0.001 0 {WATER} couple one stream rest region r", "run 20")
        assert s.atoms("x")[0, 0] > 0.02
        rows.append(np.append(s.atoms("f_h"), s.column("phi", 20)))
        s.close()
    assert rows[0].any() and np.array_equal(*rows)


@pytest.mark.parametrize("gone, says", [("region r delete", "keyword region: region 'r' does not exist"),
                                        ("variable g delete", "keyword gravity: variable 'g' does not exist")])
def test_a_run_that_is_not_prepared_misses_what_keywords_name(gone, says):
    s = Scene()
    s.spheres([[0.01, 0.01, 0.0105]], np.zeros((1, 3)), 0.001)
    s.do("region r block INF INF INF INF INF INF", "variable g equal 0", "fix move all nve/sphere",
         "fix h all hydro/vans 1 mesh 20 0.001 0 fluid 1000 0.001 gravity v_g 0 -9.81 couple one stream rest region r",
         "run 2", gone)
    with pytest.raises(Exception, match=says):
        s.do("run 2 pre no")
    s.close()


def test_overlaps_of_clumps_count_once():
    """Two equal spheres: the union by the formula of the lens; and as a rigid body that settles under the stream's
    force on both members."""
    a, h = 0.001, 0.0013
    lens = np.pi * (4 * a + h) * (2 * a - h) ** 2 / 12
    for overlap, expected in (("twice", 8 / 3 * np.pi * a ** 3), ("once", 8 / 3 * np.pi * a ** 3 - lens)):
        s = Scene(style="hybrid sphere bond", box=(0, 0.02, 0, 0.02, 0, 0.06))
        # across the periodic border
        s.spheres([[0.0196, 0.01, 0.015], [0.0196 + h - 0.02, 0.01, 0.015]], np.zeros((2, 3)), a)
        s.do("thermo_style custom step", "set atom 1*2 mol 1", "set atom 2 image 1 NULL NULL",
             "neigh_modify exclude molecule/intra all",
             f"fix h all hydro/vans 10 mesh 21 0.001 0 {WATER} couple one stream rest overlap {overlap}",
             "fix g all gravity 9.7 vector 0 0 -1", "fix r all rigid/small molecule", "run 200")
        volume = (s.column("phi", 21) * 0.001 * 4e-4).sum()
        assert abs(volume / expected - 1) < 1e-10
        assert s.atoms("v")[0, 2] < 0 and abs(s.atoms("v")[0, 2] - s.atoms("v")[1, 2]) < 1e-12
        s.close()


def test_fix_pour_and_fix_adapt(tmp_path):
    """Grains that fall in and grains that grow are in the averages."""
    script = bed_script("mesh 200 0.0003 0 fluid 1000 0.001 gravity 0.4905 0 -9.797 profile zero phi_max 0.61",
                        layers=0)
    script = script.replace("0.05 0 -0.99875", "0 0 -1").replace("atom_style sphere", "atom_style sphere 1") + """
region in block 0 0.03 0 0.03 0.03 0.06
fix pour mobile pour 20 2 4711 region in diam one 0.005 dens 2500 2500 vol 0.2 20
run 3000
fix phi all ave/time 1 1 1 f_vans[3] mode vector ave one file phi.1
run 20
unfix phi
variable grown equal 0.0055
fix grow mobile adapt 1 atom diameter v_grown
fix phi all ave/time 1 1 1 f_vans[3] mode vector ave one file phi.2
run 20
print "count $(count(mobile))"
"""
    done = run_lmp(tmp_path, script)
    assert done.returncode == 0, done.stdout[-1500:] + done.stderr[-500:]
    count = int([line for line in done.stdout.split("\n") if line.startswith("count")][-1].split()[1])
    assert count > 0
    sums = []
    for k in (1, 2):
        rows = [line.split() for line in open(tmp_path / f"phi.{k}") if not line.startswith("#")]
        last = max(i for i, row in enumerate(rows) if row[1] == "200" and len(row) == 2 and row[0] != "200")
        sums.append(sum(float(row[1]) for row in rows[last + 1:last + 201]) * 0.0003 * 9e-4)
    bed = 16 * np.pi / 6 * 0.006 ** 3
    assert abs(sums[0] / (bed + count * np.pi / 6 * 0.005 ** 3) - 1) < 1e-4
    assert abs(sums[1] / (bed + count * np.pi / 6 * 0.0055 ** 3) - 1) < 1e-4


def test_thermo_numbers(tmp_path):
    """Transport rate, friction velocity and Shields number are what the profiles say."""
    u = write_columns(tmp_path / "u", 0.05 * np.arange(22))
    s = Scene()
    s.spheres([[0.005, 0.01, 0.0055], [0.013, 0.01, 0.0072]], [[0.1, 0, 0], [0.3, 0, 0]], 0.0015)
    s.do(f"fix h all hydro/vans 1 mesh 21 0.001 0 fluid 1000 0.001 gravity 0.5 0 -9.8 couple one profile file {u}",
         "run 0")
    q = (s.column("phi", 21) * s.column("vx", 21)).sum() * 0.001
    assert abs(s.number("transport") / q - 1) < 1e-13
    # sum of V v over the area
    assert abs(q / (4 / 3 * np.pi * 0.0015 ** 3 * 0.4 / 4e-4) - 1) < 1e-12
    stress = s.column("stress", 21).max()
    assert stress > 0 and s.number("largest_stress") == stress
    assert abs(s.number("friction_velocity") / np.sqrt(stress / 1000) - 1) < 1e-14
    assert abs(s.number("shields") / (stress / (1500 * np.hypot(0.5, 9.8) * 0.003)) - 1) < 1e-12
    assert abs(s.number("drag") / s.atoms("f_h")[:, 0].sum() - 1) < 1e-12
    s.close()


def test_fluctuations(tmp_path):
    """Moments over the grains in units of the friction velocity; none below the bed; seeded."""
    n, u = 2000, write_columns(tmp_path / "u", 0.02 * np.arange(22))
    rng = np.random.default_rng(3)
    x = np.column_stack([rng.uniform(0, 0.02, (n, 2)), rng.uniform(0.001, 0.0199, n)])
    seen = []
    for model, seed in (("correlated", 5), ("uncorrelated", 5), ("correlated", 5), ("correlated", 6)):
        s = Scene(extra=["neigh_modify one 10000 page 100000"])
        s.spheres(x[:n], np.zeros((n, 3)), 1e-5)
        s.do(f"fix h all hydro/vans 1 mesh 21 0.001 0 fluid 1000 0.001 gravity 0.5 0 -9.8 couple none profile file {u} "
             f"fluctuation {model} {seed} 0.006", "run 0")
        stress, fluctuation = s.column("stress", 21), s.atoms("f_h")[:, 3:]
        above = x[:, 2] > 0.006
        assert np.abs(fluctuation[~above]).max() == 0
        scaled = fluctuation[above] / np.sqrt(stress[(x[above, 2] / 0.001).astype(int)] / 1000)[:, None]
        moments = np.array([[(scaled[:, i] * scaled[:, j]).mean() for j in range(3)] for i in range(3)])
        expected = np.array([[2, 0, -1], [0, 1, 0], [-1, 0, 1]]) if model == "correlated" else np.eye(3)
        assert np.abs(moments - expected).max() < 5 * 2 / np.sqrt(above.sum())
        seen.append(fluctuation)
        s.close()
    assert np.array_equal(seen[0], seen[2]) and not np.array_equal(seen[0], seen[3])
