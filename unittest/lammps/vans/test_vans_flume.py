"""fix hydro/vans as a flume has it: viscous slots, clumps, sand, discharge, a surface that moves, settling in a
vessel."""
import numpy as np
import pytest
# close_scenes is a fixture
from vans_helper import Scene, bed_script, close_scenes, run_lmp, write_columns  # noqa: F401

WATER = "fluid 1000 0.001 gravity 0 0 -9.81"


# --- side walls -------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("nu, gx", [(1e-6, 0.002), (1e-5, 0.05), (1e-4, 0.98), (1e-3, 0.98)])
def test_a_slow_stream_in_a_slot_is_plane_poiseuille_flow(nu, gx):
    """U = gx W^2/(12 nu) in the mean over the width, far from the bottom."""
    W = 0.0065
    s = Scene()
    s.do(f"fix h all hydro/vans 1 mesh 401 0.0025 0 fluid 1000 {1000 * nu} gravity {gx} 0 -9.8 couple fluid turbulence "
         f"none sidewall {W} 1 solve {50 * W * W / nu / 12} {0.02 * W * W / nu / 12}", "run 1")
    assert abs(s.column("u", 401)[300] / (gx * W * W / 12 / nu) - 1) < 1e-3
    s.close()


def test_walls_take_the_share_of_einstein_vanoni_and_brooks():
    """A stream of given speed and slope: R_w = f_w(U R_w/nu) U^2/(8 g), the share 2 R_w/W, by iteration here."""
    W, g, U = 0.0065, 0.98, 0.5
    s = Scene()
    s.do(f"fix h all hydro/vans 1 mesh 21 0.001 0 fluid 1000 0.001 gravity {g} 0 -9.8 couple fluid turbulence none "
         f"sidewall {W} 1",
         "fix_modify h profile values 0 " + " ".join("%g" % U for _ in range(21)))
    R = W / 2
    for _ in range(200):
        f = 0.03
        for _ in range(100):
            f = (2 * np.log10(U * R / 1e-6 * np.sqrt(f)) + 0.32) ** -2
        R = f * U * U / 8 / g
    assert abs(s.number("wall_share") / (2 * R / W) - 1) < 1e-9
    s.close()


# --- grains -----------------------------------------------------------------------------------------------------------

def sphere_drag(a, w):
    return 0.5 * 1000 * np.pi * a * a * (0.44 * w + 24.4e-6 / (2 * a)) * w


@pytest.mark.parametrize("density", [900, 1150])
@pytest.mark.parametrize("couple", ["one", "none"])
def test_a_clump_moves_by_its_own_volume(density, couple):
    """Two spheres a radius apart have 27/16 of the volume of one: with overlap once light clumps rise and heavy ones
    sink, at the speed where 27/16 of the drag of one is the weight less buoyancy of that volume."""
    a = 0.003
    s = Scene(style="hybrid sphere bond", box=(0, 0.06, 0, 0.06, -4, 4), extra=["thermo_style custom step"])
    s.spheres([[0.03, 0.03, 0], [0.033, 0.03, 0]], np.zeros((2, 3)), a, density * 27 / 32)
    s.do("set group all mol 1", "neigh_modify exclude molecule/intra all", "timestep 1e-3",
         "fix m all rigid/small molecule", "fix g all gravity 9.81 vector 0 0 -1",
         f"fix h all hydro/vans 100 mesh 201 0.04 -4 {WATER} couple {couple} stream rest overlap once hindrance 0",
         "run 3000")
    V = 27 / 16 * 4 / 3 * np.pi * a ** 3
    low, high = 0.0, 1.0
    for _ in range(60):
        w = 0.5 * (low + high)
        low, high = (w, high) if 27 / 16 * sphere_drag(a, w) < abs(density - 1000) * V * 9.81 else (low, w)
    assert abs(s.atoms("v")[0, 2] / np.copysign(w, 1000 - density) - 1) < 1e-3
    s.close()


def test_the_water_gets_the_drag_of_grains_of_any_sizes():
    """conserve no, no classes: the force that the exchange takes from the water is that on the grains, of 6 and 3
    mm."""
    rng = np.random.default_rng(4)
    x = rng.uniform([0, 0, 0.004], [0.02, 0.02, 0.014], (20, 3))
    s = Scene()
    s.spheres(x, np.zeros((20, 3)), np.where(np.arange(20) % 2, 0.003, 0.0015) / 1.5)
    u = " ".join("%g" % (0.02 * k) for k in range(22))
    s.do("fix h all hydro/vans 1 mesh 21 0.001 0 fluid 1000 0.001 gravity 0.5 0 -9.8 conserve no solve 1e-12 1e-13",
         f"fix_modify h profile values {u}", "run 1")
    taken = (1000 * s.column("b", 21) * (s.column("u", 21) - s.column("vx", 21)) * 0.001 * 4e-4)[:-1].sum()
    assert abs(taken / s.number("drag") - 1) < 1e-6
    s.close()


def test_rules_yade_with_two_sizes_are_told(tmp_path):
    vans = "mesh 200 0.0003 0 fluid 1000 0.001 gravity 0.4905 0 -9.797 phi_max 0.61 rules yade"
    assert "radii from 0.0024 to 0.003 are replaced by their mean in the drag on the water" in run_lmp(
        tmp_path, bed_script(vans) + "run 1\n").stdout
    assert "are replaced by their mean" not in run_lmp(tmp_path, bed_script(vans + " classes yes") + "run 1\n").stdout


def test_a_time_step_that_is_too_long_for_the_drag_is_told(tmp_path):
    """A grain of 1 mm in a thick liquid: m/(dF/dw) = rho d^2/(18.3 eta) = 1.4e-5 s."""
    script = """units si
plugin load stokesdynplugin.so
atom_style sphere
boundary p p f
region b block 0 0.1 0 0.1 -1 1
create_box 1 b
create_atoms 1 single 0.05 0.05 0
set group all diameter 0.001 density 2650
pair_style zero 0.01
pair_coeff * *
fix m all nve/sphere
fix s all hydro/vans 100 mesh 101 0.02 -1 fluid 1200 10 gravity 0 0 -9.81 couple none stream rest
timestep {}
run 1
"""
    limit = 2650e-6 / (18.3 * 10)
    assert f"take at most {limit:.6g}" in run_lmp(tmp_path, script.format(2e-5)).stdout
    assert "take at most" not in run_lmp(tmp_path, script.format(1e-5)).stdout
    light = script.replace("stream rest", "stream rest added_mass 0.5")     # of 600 kg/m3 of water: leaves 3/4 of it
    assert f"take at most {2050 / 2650 * limit:.6g}" in run_lmp(tmp_path, light.format(1.2e-5)).stdout
    none = light.replace("density 2650", "density 590")
    too_light = "keyword added_mass: atom 1 is not heavier than 0.5 times the water"
    assert too_light in run_lmp(tmp_path, none.format(1e-9)).stdout
    rigid = ("create_atoms 1 single 0.05 0.05 0.001\nset atom 2 diameter 0.001 density 5000\nset group all mol 1\n"
             "fix m all rigid/small molecule\n")
    for fine in ("", rigid):
        lines = none.replace("atom_style sphere", "atom_style hybrid sphere bond").replace(
            "fix m all nve/sphere\n", f"mass 1 1\nthermo_style custom step\n{fine}")
        said = run_lmp(tmp_path, lines.format(1e-9)).stdout
        assert "Loop time" in said and "keyword added_mass" not in said


def test_spheres_of_sand_fall_as_measured():
    """Quartz of 0.1 to 10 mm, drag brown_lawler: 3 % of Clift & Gauvin."""
    d = np.geomspace(1e-4, 1e-2, 9)
    s = Scene(box=(0, 1, 0, 1, -8, 1), extra=["pair_style none", "comm_modify cutoff 0.1"])
    s.spheres([[(k + 0.5) / 9, 0.5, 0.5] for k in range(9)], np.zeros((9, 3)), d / 2, 2650)
    s.do("timestep 2e-4", f"fix h all hydro/vans 1 mesh 10 0.7 -6.5 {WATER} couple none stream rest drag brown_lawler",
         "fix g all gravity 9.81 vector 0 0 -1", "fix m all nve/sphere", "run 12000")
    w = -s.atoms("v")[:, 2]
    Re = w * d / 1e-6
    measured = np.ones(9)
    for _ in range(300):
        Re = measured * d / 1e-6
        drag = 24 / Re * (1 + 0.15 * Re ** 0.687) + 0.42 / (1 + 42500 * Re ** -1.16)
        measured = 0.5 * measured + 0.5 * np.sqrt(4 / 3 * 1.65 * 9.81 * d / drag)
    print(np.abs(w / measured - 1).max())
    assert np.abs(w / measured - 1).max() < 0.03
    s.close()


def test_added_mass_is_carried_along():
    """A light grain set free: m dv/dt = (rho V - m) g - C rho V dv/dt. 1e-3: the drag of the first steps."""
    s = Scene()
    s.spheres([[0.01, 0.01, 0.05]], np.zeros((1, 3)), 0.003, 1200)
    s.do("timestep 1e-5", f"fix h all hydro/vans 1 mesh 100 0.001 0 {WATER} couple none stream rest added_mass 0.5",
         "fix g all gravity 9.81 vector 0 0 -1", "fix m all nve/sphere", "run 100")
    assert abs(s.atoms("v")[0, 2] / (-(1200 - 1000) / (1200 + 500) * 9.81 * 1e-3) - 1) < 2e-3
    s.close()


def test_water_that_has_moved_on_alone_rests_until_it_does_so_again():
    """No acceleration of a solve that a user asked for pushes grains in all steps after it."""
    forces = []
    for added in ("", "added_mass 0.5"):
        s = Scene()
        s.spheres([[0.01, 0.01, 0.05]], np.zeros((1, 3)), 0.003, 2650)
        s.do(f"fix h all hydro/vans 1 mesh 101 0.001 0 fluid 1000 1e-6 gravity 2 0 -9.8 turbulence none area 1 couple "
             f"none {added}", "fix_modify h solve 0.5 0.001", "run 1")
        forces.append(s.atoms("f"))
        s.close()
    assert forces[0][0, 0] > 0 and np.array_equal(*forces)


@pytest.mark.parametrize("density", [1000, 2650])
def test_water_that_swings_takes_grains_along_by_their_added_mass(density):
    """Without friction (rho_s + C rho) dv/dt = (1 + C) rho dU/dt: a grain of the water's density goes as the water, one
    of quartz 0.476 times as far. 0.01: the drag of 1e-9 Pa s, and the delay of a coupling."""
    s = Scene()
    s.spheres([[0.01, 0.01, 0.05]], np.zeros((1, 3)), 0.005, density)
    s.do("variable w equal 2*PI/0.1", "variable t equal (step-25)*dt",
         "variable swing equal -1000*1e-3*v_w*cos(v_w*v_t)",
         "fix h all hydro/vans 50 mesh 101 0.001 0 fluid 1000 1e-9 gravity 0 0 -9.8 turbulence none area 1 drag "
         "brown_lawler added_mass 0.5 pressure_gradient v_swing", "fix g all gravity 9.8 vector 0 0 -1",
         "fix z all setforce NULL NULL 0", "fix m all nve/sphere", "run 0")
    speeds = []
    for _ in range(200):
        s.do("run 50 pre no post no")
        speeds.append((s.atoms("v")[0, 0], s.column("u", 101)[50]))
    s.close()
    grain, water = np.ptp(np.array(speeds), axis=0)
    assert water > 1.9e-3 and abs(grain / water / (1500 / (density + 500)) - 1) < 0.01


@pytest.mark.parametrize("keywords", ["gravity 0 0 -9.81 pressure_gradient -200",
                                      "gravity 0 0 -9.81 pressure_gradient v_p", "gravity 0 0 -9.81 discharge v_q",
                                      "gravity 0.05 0 -9.81 discharge v_q"])
def test_a_pressure_that_drives_the_water_drives_grains_in_it_too(keywords):
    """Grains as dense as inviscid water go with it: both gain dp/dx/rho, without any slip. Where the discharge is held
    what it takes beyond gravity is a pressure; grains feel it from the next coupling on. What gravity does to the
    grains is the business of fix gravity."""
    s = Scene()
    s.spheres([[0.01, 0.01, 0.0305], [0.005, 0.01, 0.0605], [0.01, 0.003, 0.0905]], np.zeros((3, 3)),
              [0.001, 0.002, 0.003], 1000)
    acceleration = 0.2
    s.do("timestep 1e-4", "variable p equal -100-100", f"variable q equal {acceleration}*v_water*step*dt",
         "variable water equal 0.1", "fix m all nve/sphere")
    s.do(f"fix h all hydro/vans 1 mesh 101 0.001 0 fluid 1000 1e-9 turbulence none {keywords}", "run 0")
    s.do(f"variable water equal {s.number('volume')}", "fix g all gravity 9.81 vector 0 0 -1" if "0.05" not in keywords
         else f"fix g all gravity {np.hypot(0.05, 9.81)} vector 0.05 0 -9.81", "run 200")
    t = 200 * 1e-4
    u, v = s.column("u", 101)[40], s.atoms("v")[:, 0]
    late = 3 if "discharge" in keywords else 0
    assert abs(u / (acceleration * t) - 1) < 1e-4
    assert np.abs(v / (acceleration * t) - 1).max() < 1e-4 + late / 200
    pressed = (acceleration - (0.05 if "0.05" in keywords else 0)) * t * s.atoms("rmass").sum()
    assert abs(s.number("pressed") / pressed - 1) < 1e-9 + late / 200
    s.close()


# --- water ------------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("keywords", ["couple fluid", "couple two conserve no"])
def test_the_books_are_kept_without_grains_too(keywords):
    """Momentum of the water = driving + bottom + walls + surface - what others got."""
    s = Scene()
    s.do(f"fix h all hydro/vans 1 mesh 101 0.001 0 fluid 1000 0.001 gravity 0.1 0 -9.8 {keywords} sidewall 0.05 "
         "1 solve 1 0.01", "run 3")
    got = sum(s.number(k) for k in ("driving", "bottom", "walls", "surface")) - s.number("others")
    assert s.number("driving") > 0 and abs(s.number("momentum") / got - 1) < 1e-12
    s.close()


def test_gravity_may_change_in_a_run():
    """A variable and fix_modify gravity: a laminar stream on twice the slope is twice as fast, and buoyancy follows."""
    u = []
    for gravity, asked in (("0.1 0 -9.8", []), ("v_g 0 -9.8", []), ("0.05 0 -9.8", ["fix_modify h gravity 0.2 0 v_z"])):
        s = Scene()
        s.spheres([[0.01, 0.01, 0.0155]], [[0, 0, 0]], 1e-5)
        s.do("variable g equal 0.2", "variable z equal -4.9",
             f"fix h all hydro/vans 1 mesh 21 0.001 0 fluid 1000 0.1 gravity {gravity} turbulence none solve 100 0.1",
             *asked, "run 0", "run 1")
        u.append(s.column("u", 21))
        if asked:
            assert abs(s.atoms("f_h")[0, 2] / (4 / 3 * np.pi * 1e-15 * 1000 * 4.9) - 1) < 1e-9
        s.close()
    assert np.abs(u[1] / u[0] - 2).max() < 1e-6 and np.abs(u[2] / u[0] - 2).max() < 1e-6


def test_discharge_is_held():
    """Laminar stream over a plane: q = g H^3/(3 nu), from which the slope is known; q itself to rounding, also when it
    changes in a run."""
    s = Scene()
    s.do("variable q equal 1e-4*(1+step)", "fix h all hydro/vans 1 mesh 201 0.0001 0 fluid 1000 0.1 gravity 0 0 -9.8 "
                                           "couple fluid turbulence none discharge v_q solve 100 0.1")
    for step in (1, 2):
        s.do("run 1")
        assert abs(s.number("discharge") / (1e-4 * (1 + step)) - 1) < 1e-12
        assert abs(s.number("drive") / (3 * 1e-4 * 1e-4 * (1 + step) / 0.02 ** 3) - 1) < 2e-3    # order dz^2
    s.close()


def test_the_discharge_over_a_moving_bed_is_held():
    s = Scene.of(bed_script("mesh 201 0.0003 0 fluid 1000 0.001 gravity 0 0 -9.81 phi_max 0.61 discharge 0.015 "
                            "surface follow 0.05"))
    for _ in range(5):
        s.do("run 40")
        assert abs(s.number("discharge", "vans") / 0.015 - 1) < 1e-12
    s.close()


def test_the_surface_follows_and_the_water_stays():
    """Grains swell to twice their volume: the water keeps its volume to rounding, and the surface rises by what was
    added."""
    s = Scene(style="sphere 1")
    s.spheres(np.random.default_rng(1).uniform([0, 0, 0.004], [0.02, 0.02, 0.009], (10, 3)), np.zeros((10, 3)), 0.001)
    s.do("variable d equal 0.002*2^(step/30/3)", "fix a all adapt 1 atom diameter v_d", "timestep 1e-9",
         "fix h all hydro/vans 1 mesh 41 0.0005 0 fluid 1000 0.001 gravity 0.5 0 -9.8 phi_max 0.9 solve 0.01 1e-3 "
         "surface follow 0.0149", "run 0")
    volume, surface, V = s.number("volume"), s.number("elevation"), 10 * 4 / 3 * np.pi * 1e-9
    assert abs(surface - 0.0149) < 1e-15 and abs(volume - (0.0149 - V / 4e-4)) < 1e-15
    for step in range(30):
        s.do("run 1")
        assert abs(s.number("volume") / volume - 1) < 1e-14
    grown = 4 / 3 * np.pi * 10 * s.atoms("radius")[0] ** 3
    assert abs((s.number("elevation") - surface) / ((grown - V) / 4e-4) - 1) < 1e-9
    s.close()


def test_the_depth_follows_the_discharge():
    """A laminar stream down a slope of given gx: the depth comes to that of q = gx H^3/(3 nu), and q to what was asked,
    from too little water and from too much. One grain far too small to matter, since the surface moves with the
    averages."""
    nu, gx, q = 1e-3, 2.0, 1e-4
    H = (3 * nu * q / gx) ** (1 / 3)
    for start in (0.7, 1.4):
        s = Scene()
        s.spheres([[0.01, 0.01, 2e-4]], np.zeros((1, 3)), 1e-5)
        dz = H / 80
        s.do(f"fix h all hydro/vans 1 mesh 161 {dz} 0 fluid 1000 1 gravity {gx} 0 -9.8 turbulence none discharge {q} "
             f"adjust depth 0.005 surface follow {start * H} solve 0.01 1e-3", "run 600")
        assert abs(s.number("discharge") / q - 1) < 1e-6
        assert abs(s.number("elevation") / H - 1) < 1e-3    # order dz^2
        assert s.number("drive") == gx
        s.close()


def test_turbulence_spreads_sinking_grains_as_rouse_has_it():
    """The stream kappa u_star z (1 - z/H), u' of the Langevin walk, grains that sink at w: their number falls with the
    height as [(H - z)/z]^(w schmidt/(kappa u_star)). The exponent is the one for which the mean of ln((H - z)/z)
    between 0.1 and 0.8 H is that of the grains there; its sampling error is 3 %."""
    n, cells, H, u_star, kappa, schmidt, a = 2000, 200, 0.1, 0.05, 0.41, 0.5, 1e-4
    rouse = 0.6
    w = rouse * kappa * u_star / schmidt
    edge = H / cells * np.arange(cells + 1)
    middle = 0.5 * (edge[1:] + edge[:-1])
    u = u_star / kappa * np.log(np.concatenate([[edge[1] / 30], middle, [H]]) / (edge[1] / 30))
    Re = 2 * a * w / 1e-5
    density = 1000 + 6 * np.pi * 1e-2 * a * w * (1 + 0.15 * Re ** 0.687) / (9.81 * 4 / 3 * np.pi * a ** 3)
    s = Scene(box=(0, 1, 0, 1, -0.01, 0.2), extra=["pair_style none", "comm_modify cutoff 0.01"])
    s.do(f"region r block 0 1 0 1 {0.02 * H} {0.98 * H}", f"create_atoms 1 random {n} 11 r",
         f"set group all diameter {2 * a} density {density:.10g}", "timestep 2e-4",
         f"fix h all hydro/vans 5 mesh {cells + 1} {H / cells} 0 fluid 1000 1e-2 gravity 0.5 0 -9.81 couple none "
         f"stream rest turbulence parabolic drag schiller_naumann fluctuation langevin 3 -1 schmidt {schmidt}",
         "fix_modify h profile values " + " ".join("%.8g" % v for v in u),
         "fix g all gravity 9.81 vector 0 0 -1", "fix m all nve/sphere",
         f"fix walls all wall/reflect zlo {0.02 * H} zhi {0.98 * H}", "run 200", "timestep 1e-3", "run 5000")
    logs = []
    for _ in range(10):
        s.do("run 500")
        z = s.atoms("x")[:, 2]
        z = z[(z > 0.1 * H) & (z < 0.8 * H)]
        logs.append(np.log((H - z) / z))
    s.close()
    found, z = np.concatenate(logs).mean(), np.linspace(0.1, 0.8, 2001)

    def mean(exponent):
        number = ((1 - z) / z) ** exponent
        return (number * np.log((1 - z) / z)).sum() / number.sum()

    low, high = 0.0, 5.0
    for _ in range(50):
        half = 0.5 * (low + high)
        low, high = (half, high) if mean(half) < found else (low, half)
    print("Rouse number", half)
    assert abs(half / rouse - 1) < 0.1


def test_light_grains_return_from_the_surface():
    """Grains without weight in that stream, which mix over its depth within 1 s. Above the surface are only those that
    have just passed it; without u' that turns there a quarter of them would be, for good."""
    n, cells, H, u_star, kappa, a = 300, 50, 0.1, 0.22, 0.41, 2e-4
    z = H / cells * (np.arange(cells) + 0.5)
    u = u_star / kappa * np.log(np.concatenate([[1e-4], z, [H]]) / 1e-4)
    s = Scene(box=(0, 1, 0, 1, -0.01, 0.2), extra=["pair_style none", "comm_modify cutoff 0.01"])
    s.do(f"region r block 0 1 0 1 {0.1 * H} {0.9 * H}", f"create_atoms 1 random {n} 11 r",
         f"set group all diameter {2 * a} density 1000", "timestep 2e-4",
         f"fix h all hydro/vans 5 mesh {cells + 1} {H / cells} 0 fluid 1000 1e-3 gravity 0.5 0 -9.81 couple none "
         "stream rest turbulence parabolic drag schiller_naumann fluctuation langevin 3 -1",
         "fix_modify h profile values " + " ".join("%.8g" % v for v in u),
         "fix g all gravity 9.81 vector 0 0 -1", "fix m all nve/sphere", f"fix floor all wall/reflect zlo {0.02 * H}",
         "run 200", "timestep 5e-4", "run 8000")
    z = s.atoms("x")[:, 2]
    s.close()
    assert (z > 0.8 * H).sum() > 0.05 * n    # they come there
    assert (z > H + 2e-3).sum() < 0.02 * n and (z > H).sum() < 0.06 * n


def brown_lawler(a, density, eta):
    """The speed of a lone sphere."""
    w = 0.1
    for _ in range(500):
        Re = max(2 * a * w * 1000 / eta, 1e-9)
        drag = 24 / Re * (1 + 0.15 * Re ** 0.681) + 0.407 / (1 + 8710 / Re)
        w = 0.5 * w + 0.5 * np.sqrt(8 / 3 * (density / 1000 - 1) * 9.81 * a / drag)
    return w


@pytest.mark.parametrize("phi", [0.15, 0.4])
@pytest.mark.parametrize("d, eta, expected", [(2e-4, 5.8e-3, 0.2), (1e-3, 4.8e-3, 20), (1.85e-3, 1e-3, 500)])
def test_suspensions_settle_in_a_vessel_by_richardson_and_zaki(d, eta, expected, phi):
    """A lattice of grains, the same phi in every slice, in a vessel (upflow 0): w_0 (1 - phi)^n, 5 %, with n = 4.65,
    4.4 Re^-0.03, 4.4 Re^-0.1, 2.4 of Richardson & Zaki. Held up by that flux they stay where they are."""
    h, n, w0 = d * (np.pi / 6 / phi) ** (1 / 3), 9, brown_lawler(d / 2, 2650, eta)
    Re = w0 * d * 1000 / eta
    assert 0.7 < Re / expected < 1.4
    exponent = 4.65 if Re < 0.2 else 4.4 * Re ** -0.03 if Re < 1 else 4.4 * Re ** -0.1 if Re < 500 else 2.4
    hindered = w0 * (1 - phi) ** exponent
    x = np.array([[i, j, k] for i in range(3) for j in range(3) for k in range(n)], float) + 0.5
    for flux, start, speed in ((0.0, 0.7 * hindered, hindered), (hindered, 0.0, 0.0)):
        s = Scene(box=(0, 3 * h, 0, 3 * h, -40 * h, 20 * h), extra=["pair_style none", f"comm_modify cutoff {h}"])
        s.spheres(h * x, np.array([[0, 0, -start]] * len(x)), d / 2, 2650)
        s.do(f"timestep {0.02 * hindered / 9.81}",
             f"fix h all hydro/vans 1 mesh 61 {h} {-40 * h} fluid 1000 {eta} gravity 0 0 -9.81 stream rest couple one "
             f"grains point drag brown_lawler upflow {flux}", "fix g all gravity 9.81 vector 0 0 -1",
             "fix m all nve/sphere", "run 600")
        inside = -s.atoms("v")[:, 2].reshape(3, 3, n)[:, :, 3:6].mean()
        print(Re, phi, flux, inside / hindered)
        assert abs(inside - speed) < 0.05 * hindered
        # the water bears what the grains weigh in it, less what they still gain in speed
        pressure = s.column(11, 61)
        weight = 1650 * 9.81 * np.pi / 6 * d ** 3 * len(x) / (9 * h * h)
        assert abs(pressure[0] / weight - 1) < 0.02
        s.close()


@pytest.mark.parametrize("d, eta, dt", [(2e-4, 5.8e-3, 1.2e-4), (1e-3, 4.8e-3, 1e-4), (1.85e-3, 1e-3, 1e-4)])
def test_a_fluidised_bed_expands_by_richardson_and_zaki(d, eta, dt):
    """Free grains on a floor, at first packed to phi 0.45, in water that rises with w_0 (1 - phi)^n, phi = 0.3: at Re
    0.2, 20 and 500 their bed comes to that phi within 5 % and stays there. Slices of three diameters; the highest one,
    in part empty, makes the bed 8 % higher than its phi."""
    h, rng = d * (np.pi / 6 / 0.45) ** (1 / 3), np.random.default_rng(6)
    w0 = brown_lawler(d / 2, 2650, eta)
    Re = w0 * d * 1000 / eta
    flux = w0 * 0.7 ** (4.65 if Re < 0.2 else 4.4 * Re ** -0.03 if Re < 1 else 4.4 * Re ** -0.1)
    mass = 2650 * np.pi / 6 * d ** 3
    k = 0.5 * mass * (np.pi / 25 / dt) ** 2
    contact = f"gran/hooke/history {k} NULL {0.43 * np.sqrt(2 * k / mass)} NULL 0.1 1"
    s = Scene(box=(0, 6 * h, 0, 6 * h, -d, 60 * d), extra=["pair_style " + contact, "pair_coeff * *",
                                                           f"neighbor {0.3 * d} bin"])
    x = h * (np.array([[i, j, l] for i in range(6) for j in range(6) for l in range(8)]) +
             0.5) + rng.uniform(-0.02 * d, 0.02 * d, (288, 3))
    s.spheres(x, np.zeros((288, 3)), d / 2, 2650)
    s.do(f"timestep {dt}", f"fix floor all wall/{contact.replace('/hooke', ' hooke', 1)} zplane 0 NULL",
         "fix g all gravity 9.81 vector 0 0 -1", "fix m all nve/sphere",
         f"fix h all hydro/vans 5 mesh 20 {3 * d} 0 fluid 1000 {eta} gravity 0 0 -9.81 stream rest couple one drag "
         f"brown_lawler upflow {flux}", f"run {int(70 * d / w0 / dt)}")
    phi = 288 * np.pi / 6 * d ** 3 / (36 * h * h * 2 * s.atoms("x")[:, 2].mean())
    inside = s.column("phi", 20)[:3]
    print(Re, inside, phi)
    assert np.abs(inside / 0.3 - 1).max() < 0.05 and np.abs(s.column("vz", 20)[:3]).max() < 1e-3 * flux
    assert abs(phi / 0.3 - 1) < 0.1
    s.close()


def test_a_bed_in_slices_finer_than_its_grains_is_told_to_break_up(tmp_path):
    script = bed_script("mesh 200 0.0003 0 fluid 1000 0.001 gravity 0 0 -9.8 stream rest couple one upflow {}")
    assert "use slices of three diameters" in run_lmp(tmp_path, script.format(0.1) + "run 0\n").stdout
    assert "use slices of three diameters" not in run_lmp(tmp_path, script.format("off") + "run 0\n").stdout


def test_a_run_stops_when_its_mean_is_known():
    """A stream that shakes about its mean: fix halt on the error of the steady state; asked anew, it knows nothing."""
    s = Scene()
    s.do("variable p equal -100*(1+0.3*sin(step*1.7))", "fix h all hydro/vans 1 mesh 21 0.001 0 fluid 1000 0.1 gravity "
         "0 0 -9.8 couple fluid turbulence kz pressure_gradient v_p "
         "solve 0.1 0.01", "variable e equal f_h[25]/(f_h[24]+1e-99)", "fix stop all halt 1 v_e < 0.02 error continue",
         "run 3000")
    steps = s.lmp.extract_global("ntimestep")
    assert 16 <= steps < 3000 and 0 < s.number("stress_error") < 0.02 * s.number("mean_stress")
    s.do("unfix stop", "run 500")
    assert abs(s.number("mean_stress") / s.number("largest_stress") - 1) < 0.4
    s.do("fix_modify h steady anew")
    assert s.number("mean_stress") == 0
    s.close()
