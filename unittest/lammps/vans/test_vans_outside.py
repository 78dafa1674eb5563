"""fix hydro/vans beside what others have measured or published: falls in oil and of sand, batch settling, roughness of
a bed, hops, grains that stick."""
import re

import numpy as np
import pytest
# close_scenes is a fixture
from vans_helper import WATER_ALONE, Scene, bed_script, close_scenes, run_lmp, write_columns  # noqa: F401


def falls(x, d, density, water, drag, box, steps, dt):
    """Speeds of lone spheres after a time that is long for them."""
    s = Scene(box=box, extra=["pair_style none", "comm_modify cutoff 0.1"])
    s.spheres(x, np.zeros((len(x), 3)), np.asarray(d) / 2, density)
    s.do(f"timestep {dt}", f"fix h all hydro/vans 1 mesh 10 0.7 -6.5 {water} gravity 0 0 -9.81 couple none stream "
                           f"rest drag {drag}", "fix g all gravity 9.81 vector 0 0 -1",
         "fix m all nve/sphere", f"run {steps}")
    w = -s.atoms("v")[:, 2]
    s.close()
    return w


@pytest.mark.parametrize("rho, eta, published", [(970, 0.373, 0.038), (965, 0.212, 0.060), (962, 0.113, 0.091),
                                                 (960, 0.058, 0.128)])
def test_a_sphere_falls_in_oil_as_ten_cate_has_it(rho, eta, published):
    """15 mm, 1120 kg/m3 (ten Cate et al. 2002, infinite oil by Abraham's formula): 8 %; Clift & Gauvin's fit to
    measurements: 1.5 %."""
    w = falls([[0.5, 0.5, 0.5]], [0.015], 1120, f"fluid {rho} {eta}", "brown_lawler", (0, 1, 0, 1, -8, 1), 20000,
              2e-4)[0]
    fit = published
    for _ in range(300):
        Re = fit * 0.015 * rho / eta
        drag = 24 / Re * (1 + 0.15 * Re ** 0.687) + 0.42 / (1 + 42500 * Re ** -1.16)
        fit = 0.5 * fit + 0.5 * np.sqrt(4 / 3 * (1120 / rho - 1) * 9.81 * 0.015 / drag)
    print(w, fit, published)
    assert abs(w / fit - 1) < 0.015 and abs(w / published - 1) < 0.08


def test_sand_falls_by_ferguson_and_church_and_near_others():
    """0.1 to 5 mm, rho_s 2650, water of 20 C: the law's own closed form R g d^2/(18 nu + (0.75 R g d^3)^0.5) to 1e-5;
    Soulsby (1997) and Cheng (1997) to 25 %."""
    d, nu = np.array([1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3]), 1.002e-3 / 998.2
    w = falls([[(k + 0.5) / 6, 0.5, 0.5] for k in range(6)], d, 2650, "fluid 998.2 0.001002", "ferguson_church",
              (0, 1, 0, 1, -8, 1), 20000, 1e-4)
    R = 2650 / 998.2 - 1
    size = d * (R * 9.81 / nu ** 2) ** (1 / 3)
    soulsby = nu / d * (np.sqrt(10.36 ** 2 + 1.049 * size ** 3) - 10.36)
    cheng = nu / d * (np.sqrt(25 + 1.2 * size ** 2) - 5) ** 1.5
    print(w / soulsby, w / cheng)
    assert np.abs(w * (18 * nu + np.sqrt(0.75 * R * 9.81 * d ** 3)) / (R * 9.81 * d ** 2) - 1).max() < 1e-5
    assert np.abs(w / soulsby - 1).max() < 0.25 and np.abs(w / cheng - 1).max() < 0.25


W0, E = 100 * 9.81 * 2.9e-4 ** 2 / (18 * 0.0199975), 0.51       # Stokes's speed of the lone bead; 1 - phi
SETTLING = {    # closed forms at Re of 1e-5, and how far from the measured speed the page has them
    "drag schiller_naumann hindrance richardson_zaki": (W0 * E ** 4.65, 0.54),
    "drag schiller_naumann hindrance 3.15": (W0 * E ** 4.15, 1.16),
    "drag schiller_naumann hindrance 4.15": (W0 * E ** 5.15, 0.10),
    "drag gidaspow": (W0 * E / (150 * 0.49 / (18 * E ** 2)), 0.15),
    "drag beetstra": (W0 * E / (10 * 0.49 / E ** 2 + E ** 2 * (1 + 1.5 * 0.49 ** 0.5)), -0.07),
    "drag koch_hill": (W0 * E / (10 * 0.49 / E ** 2), -0.045),
}


@pytest.mark.parametrize("law", SETTLING)
def test_a_dense_batch_settles_by_its_law_and_near_the_measured_speed(law):
    """Beads of 0.29 mm in silicone oil at phi 0.49: the interface fell at 6.5e-6 m/s (Pham Van Bang et al. 2006). A
    lattice in slices of three of its spacings, so that each has the same phi: the closed form to 1 %; beetstra and
    koch_hill within 10 % of the measured speed."""
    d, layers = 2.9e-4, 30
    h = d * (np.pi / 6 / 0.49) ** (1 / 3)
    s = Scene(box=(0, 4 * h, 0, 4 * h, -2 * d, (layers + 3) * h), extra=["pair_style none", f"comm_modify cutoff {h}"])
    x = h * (np.array([[i, j, k] for i in range(4) for j in range(4) for k in range(layers)]) + 0.5)
    s.spheres(x, np.zeros((len(x), 3)), d / 2, 1050)
    s.do("timestep 2e-5", f"fix h all hydro/vans 20 mesh 11 {3 * h} 0 fluid 950 0.0199975 gravity 0 0 -9.81 couple one "
                          f"stream rest {law} upflow 0",
         "fix g all gravity 9.81 vector 0 0 -1", "fix m all nve/sphere", "run 2000")
    inside = -s.atoms("v")[:, 2].reshape(4, 4, layers)[:, :, 9:21].mean()
    speed, off = SETTLING[law]
    print(law, inside, speed, inside / 6.5e-6)
    assert abs(inside / speed - 1) < 0.01 and abs(inside / 6.5e-6 - 1 - off) < 0.02
    if law in ("drag beetstra", "drag koch_hill"):
        assert abs(inside / 6.5e-6 - 1) < 0.10
    s.close()


def over_fixed_grains(d, long, high, density, loose, rough):
    """The head of an input: a layer of fixed grains of diameter d at heights between -rough and rough, `long` by 6 of
    them, and above it others that the command `loose` makes; lengths in d."""
    return f"""
plugin load stokesdynplugin.so
units si
atom_style sphere
atom_modify map array
boundary p p f
newton off
comm_modify vel yes
lattice sc {d}
region box block 0 {long} 0 6 -1.2 {high}
create_box 2 box
region bottom block 0 {long} 0 6 -0.5 0.4
create_atoms 1 region bottom
{loose}
set group all diameter {d} density {density}
group fixed type 1
group loose type 2
variable rough atom {rough}*(2*random(0,1,4711)-1)
set group fixed z v_rough
"""


BED = over_fixed_grains(0.006, 6, 16, 2500, "region cloud block 0 6 0 6 1 5\ncreate_atoms 2 random 100 4711 cloud",
                        0.00275) + """
pair_style gran/hooke/history 2000 NULL 1620 NULL 0.4 1
pair_coeff * *
neighbor 0.0015 bin
neigh_modify delay 0 every 1 check yes exclude type 1 1
fix floor all wall/gran hooke/history 2000 NULL 1620 NULL 0.4 1 zplane -0.006 NULL
fix weight loose gravity 9.81 vector 0.02 0 -1
timestep 5e-5
fix move loose nve/limit 1e-5
fix damp loose viscous 0.02
run 4000
unfix move
unfix damp
fix move loose nve/sphere
fix damp loose viscous 0.001
run 6000
unfix damp
unfix move
unfix weight
unfix floor
set group all vx 0 vy 0 vz 0
reset_timestep 0
timestep 0.01
"""
STREAM = ("fix h loose hydro/vans 1 mesh 200 0.00025 0 fluid 1000 0.001 gravity 0.1962 0 -9.81 phi_max 0.61 "
          "solve 0.01 1e-4")


def test_a_fixed_bed_is_as_rough_as_the_page_says():
    """k_s in diameters, from the speed U of the surface by the logarithmic law U/u* = ln(30 h/k_s)/0.41, where rho u*^2
    is the largest stress and h = u*^2/(g S): 10 % of the page, at 5 and at 10 diameters of water."""
    s = Scene.of(BED)
    for words, *page in (("", 0.8, 0.9), ("felt volume", 1.1, 1.3), ("turbulence ni_capart", 1.6, 1.8),
                         ("turbulence rousseau", 10, 13)):
        for cells, steps, expected in ((200, 2500, page[0]), (320, 4000, page[1])):
            s.do(STREAM.replace("mesh 200", f"mesh {cells}") + " " + words, f"run {steps}")
            shear, surface = s.number("friction_velocity"), s.column("u", cells)[cells - 1]
            rough = 30 * shear ** 2 / 0.1962 / np.exp(0.41 * surface / shear) / 0.006
            print(words, shear ** 2 / 0.1962 / 0.006, surface, rough)
            s.do("unfix h")
            assert abs(rough / expected - 1) < 0.1
    s.close()


HOPS = over_fixed_grains(0.015, 40, 20, 2650, "region start block 0 40 1 5 2 4\ncreate_atoms 2 random 6 4711 start",
                         0.0045) + """
pair_style gran/hooke/history 20000 NULL {damp} NULL 0.4 1
pair_coeff * *
neighbor 0.003 bin
neigh_modify delay 0 every 1 exclude type 1 1 exclude type 2 2
fix weight loose gravity 9.81 vector 0 0 -1
timestep 2e-5
fix move loose nve/sphere
fix s loose hydro/vans 1 mesh 300 0.001 -0.0075 fluid 1000 0.001 gravity 0 0 -9.81 couple none &
  profile file {profile} stream rest drag brown_lawler felt volume
thermo 1000000
"""


def hops(damp, profile, seconds):
    """Mean height and length, in diameters, of the hops of 6 grains of gravel over a fixed bed, after a second."""
    s = Scene.of(HOPS.format(damp=damp, profile=profile))
    way, times = [], int(seconds / 2e-3)
    s.do("run 0")
    for _ in range(times):
        s.do("run 100 pre no post no")
        way.append(np.concatenate([s.atoms("x")[-6:], s.atoms("v")[-6:]], 1))
    s.close()
    way, found = np.array(way)[500:], []
    for grain in way.transpose(1, 0, 2):
        z, along = grain[:, 2] / 0.015, np.cumsum(grain[:, 3]) * 2e-3 / 0.015
        low = [k for k in range(1, len(z) - 1) if z[k] < z[k - 1] and z[k] <= z[k + 1]]
        found += [(z[a:b].max() - 0.5 * (z[a] + z[b]), along[b] - along[a]) for a, b in zip(low, low[1:])]
    found = np.array([hop for hop in found if hop[0] > 0.05])
    return found.mean(0)


def test_measured_hops_of_gravel_lie_between_those_of_hard_and_of_damped_contacts(tmp_path):
    """15 mm at a Shields number of 0.08 (Nino & Garcia 1994): 0.6 to 1 diameters high and 4 to 8 long. With a
    restitution of 0 they are lower and shorter, with 0.8 higher and longer: the contact law has to damp for the
    water."""
    z = np.concatenate([[0], (np.arange(300) + 0.5) * 0.001]) - (0.0075 + 0.25 * 0.015)
    u = np.where(30 * z > 0.015, 0.139 / 0.41 * np.log(np.maximum(30 * z / 0.015, 1)), 0)
    profile = tmp_path / "u.txt"
    np.savetxt(profile, u)
    damped, hard = hops(8000, profile, 4), hops(415, profile, 4)
    assert damped[0] < 0.6 and damped[1] < 4, damped
    assert hard[0] > 1.0 and hard[1] > 6, hard


@pytest.mark.parametrize("words, said",
                         [("", "li_sawamoto: a bed of fixed grains is about as rough as k_s = 0.9 grain"),
                          ("felt volume", "k_s = 1.2 grain"), ("turbulence ni_capart", "k_s = 1.7 grain"),
                          ("turbulence rousseau", "k_s = 12 grain"), ("turbulence kz", None),
                          ("couple one", None)])
def test_the_log_says_how_rough_the_bed_is(tmp_path, words, said):
    """Once, by the law of the run."""
    done = run_lmp(tmp_path, bed_script("mesh 200 0.0003 0 fluid 1000 0.001 gravity 0.49 0 -9.8 " + words) +
                   "run 0\nrun 0\n")
    assert done.returncode == 0 and done.stdout.count("grain diameters; flumes have 1 to 2") == (said is not None)
    assert said is None or said in done.stdout
    assert "a smooth bottom" not in done.stdout    # there are grains


@pytest.mark.parametrize("words, law", [
    ("couple fluid turbulence kz", "kz"), ("couple fluid turbulence parabolic", "parabolic"), ("", "li_sawamoto"),
    ("couple fluid turbulence ni_capart", "ni_capart"), ("couple fluid sublayer yes", None),
    ("couple fluid turbulence rousseau", None), ("couple fluid turbulence none", None),
    ("couple fluid rules yade", None), ("couple one", None), ("couple fluid radius 0.01 given file phi", None)])
def test_a_smooth_bottom_that_rubs_as_if_it_had_grains_is_told_once(tmp_path, words, law):
    """With couple two there may be grains, but there are none; with couple fluid they may be given."""
    write_columns(tmp_path / "phi", 0.5 * (np.arange(20) < 3), np.zeros(20), np.zeros(20))
    done = run_lmp(tmp_path, f"""
plugin load stokesdynplugin.so
units si
atom_style sphere
comm_modify vel yes
boundary p p f
region box block 0 1 0 1 0 1
create_box 1 box
pair_style zero 0.1
pair_coeff * *
fix vans all hydro/vans 10 mesh 20 0.05 0 fluid 1000 0.001 gravity 0.01 0 -9.81 solve 1 0.1 {words}
run 0
run 0
""")
    assert done.returncode == 0, done.stdout[-2000:]
    assert done.stdout.count("a smooth bottom rubs as if it had grains of 75 nu/u_star") == (law is not None)
    assert law is None or f"keyword turbulence: there are no grains, and with {law} a" in done.stdout


@pytest.mark.parametrize("law, dt, swing, told", [("kz", 0.2, 1e-2, False), ("kz", 2, 1e-2, True), ("kz", 1e4, 4, True),
                                                  ("none", 1e4, 1e-3, False),
                                                  ("none sidewall 0.0065 1", 2, 1e-3, False),
                                                  ("none sidewall 0.0065 1", 20, 4, True)])
def test_steps_of_a_solve_in_which_the_stream_swings_are_told(tmp_path, law, dt, swing, told):
    """H/u_star is 1.41, and U/gx of side walls alone 3.2. How much the speeds of the surface of two steps differ at
    most, over their mean: more than a half and less than `swing` where it is large."""
    done = run_lmp(tmp_path, WATER_ALONE + f"""
fix vans all hydro/vans 1 mesh 201 0.0005 0 fluid 1000 0.001 gravity 0.05 0 -9.81 couple fluid turbulence {law} &
    solve {dt} {dt}
timestep {dt}
run 100
print "SPEED $(f_vans[201][2])"
run 1
print "SPEED $(f_vans[201][2])"
""")
    assert done.returncode == 0, done.stdout[-2000:]
    one, two = [float(line.split()[1]) for line in done.stdout.splitlines() if line.startswith("SPEED")]
    part = abs(one - two) / (one + two) * 2
    assert part < swing and (swing < 1 or part > 0.5)
    assert done.stdout.count("keyword solve: the step dt = ") == told


def test_water_that_turns_about_is_not_told_to_swing(tmp_path):
    """Where it stands still it is driven most, and side walls take nothing."""
    done = run_lmp(tmp_path, WATER_ALONE + """
variable g equal 0.05*cos(PI*time)
fix vans all hydro/vans 1 mesh 21 0.005 0 fluid 1000 0.001 gravity v_g 0 -9.81 couple fluid turbulence none &
    sidewall 0.0065 1 solve 0.05 0.05
timestep 0.05
run 100
""")
    assert done.returncode == 0 and "keyword solve" not in done.stdout, done.stdout[-2000:]


@pytest.mark.parametrize("slices, words, told", [
    (21, "sublayer yes", True), (21, "turbulence rousseau", True), (501, "sublayer yes", False),
    (21, "turbulence none", False), (21, "rules yade", False), (21, "radius 0.01 given file phi", False)])
def test_slices_too_high_for_a_smooth_bottom_are_told_once(tmp_path, slices, words, told):
    """H u_star/nu becomes 3162, so that each of 20 slices is 158 nu/u_star high, and each of 500 is 6. Grains in the
    lowest one rub by their drag. The warning asks for five of these units."""
    write_columns(tmp_path / "phi", 0.5 * (np.arange(21) < 3), np.zeros(21), np.zeros(21))
    done = run_lmp(tmp_path, f"""
plugin load stokesdynplugin.so
units si
atom_style sphere
region box block 0 1 0 1 0 1
create_box 1 box
pair_style zero 0.1
pair_coeff * *
fix vans all hydro/vans 1 mesh {slices} $(0.1/({slices}-1)) 0 fluid 1000 0.001 gravity 0.01 0 -9.81 couple fluid &
    solve 400 0.4 {words}
run 2
""")
    assert done.returncode == 0, done.stdout[-2000:]
    says = re.findall("slice has no grains and is ([0-9.]+) nu/u_star high.* at most ([0-9.e-]+),", done.stdout)
    assert len(says) == told
    for size, wanted in says:
        assert 20 < float(size) < 160 and float(wanted) * float(size) == pytest.approx(5 * 0.005, rel=1e-4)


STICK = """
plugin load stokesdynplugin.so
units si
atom_style sphere
boundary p p f
newton off
comm_modify vel yes
atom_modify map array
region box block 0 0.02 0 0.02 0 0.1
create_box 2 box
create_atoms 1 single 0.01 0.01 0.02
create_atoms 2 single 0.01 0.01 0.0180000001
set group all diameter 0.002 density 2650
group loose type 2
variable gamma equal ${bond}*(2650-1000)*9.81*PI/6*0.002^3/(${pull}*PI*0.001/2)
pair_style granular
pair_coeff * * ${law} 2e6 0.3 0.3 ${gamma} tangential linear_history 400 1 0.4
neighbor 0.0005 bin
timestep 2e-5
fix weight loose gravity 9.81 vector 0 0 -1
fix move loose nve/sphere
fix water loose hydro/vans 1 mesh 150 0.0002 0 fluid 1000 0.001 gravity 0 0 -9.81 couple none stream rest &
  drag brown_lawler
run 4000
print "height $(z[2])"
"""


@pytest.mark.parametrize("law, pull, bond, hangs", [("dmt", 4, 0.99, False), ("dmt", 4, 1.01, True),
                                                    ("jkr", 3, 0.99, False), ("jkr", 3, 1.2, True)])
def test_a_grain_hangs_where_adhesion_bears_its_weight_in_water(tmp_path, law, pull, bond, hangs):
    """The largest force of the law, 4 or 3 pi gamma a/2, beside (rho_s - rho) g V, the buoyancy being that of the fix.
    A grain that just touches has 8/9 of it by jkr, so that it hangs at once where that is enough."""
    done = run_lmp(tmp_path, STICK, variables=[("bond", bond), ("law", law), ("pull", pull)])
    height = float(done.stdout.split("\nheight ")[1].split()[0])
    assert (abs(height - 0.018) < 1e-6) == hangs and (height < 0.01) != hangs


@pytest.mark.parametrize("weight, says", [
    ("fix g all gravity 9.81 vector 0.05 0 -1", False), ("fix g all gravity 9.81 vector 0 0 -1", True),
    ("fix g all gravity 5.886 vector 0.05 0 -1", True), ("", False), ("fix g one gravity 9.81 vector 0 0 -1", False),
    ("fix g all gravity 9.81 vector 0 0 -1\nfix x all addforce 1e-3 0 0", False)])
def test_a_weight_that_is_not_that_of_the_stream_is_warned_of(tmp_path, weight, says):
    """A flume whose grains lie level, or whose buoyancy is taken off their weight and comes again by the fix, ran
    without a word. A weight with other forces, of some grains alone or of none may be meant."""
    done = run_lmp(tmp_path, f"""plugin load stokesdynplugin.so
units si
atom_style sphere
boundary p p f
region box block 0 0.1 0 0.1 -1 1 units box
create_box 1 box
create_atoms 1 single 0.05 0.05 0.5
create_atoms 1 single 0.05 0.05 0.8
set group all diameter 0.006 density 2500
group one id 1
pair_style zero 0.01
pair_coeff * *
fix s all hydro/vans 1 mesh 100 0.02 -1 fluid 1000 0.001 gravity 0.49 0 -9.8 couple none stream rest
{weight}
fix m all nve/sphere
timestep 1e-6
run 2
run 2
""")
    said = "keyword gravity has the numbers 0.49 0 -9.8, and fix gravity pulls the grains with"
    assert done.returncode == 0 and done.stdout.count(said) == 2 * says, done.stdout + done.stderr
