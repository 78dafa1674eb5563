"""fix sph/grains: grains smaller than h in the water of SPH. The water is a lattice of spacing 1, h = 2, density 1;
numbers are of order 1."""
import numpy as np
import pytest

from grains_tools import H, brown_lawler, of_bed, scene, singles
from host import allowed
from sph_tools import by_id, fix_by_id, mpirun, read_dump, run, start


def forces_on_grains(lmp):
    n = lmp.extract_global("nlocal")
    kinds, rows = np.array(lmp.numpy.extract_atom("type", nelem=n))[:n], np.array(lmp.numpy.extract_fix("g", 1, 2))[:n]
    return rows[kinds == 2]


def force_of_all(lmp):
    return np.array([lmp.extract_fix("g", 0, 1, k) for k in range(3)])


# --- one grain --------------------------------------------------------------------------------------------------------

R = np.linspace(0, 2, 801)[1:]
K, dK = (1 - R / 2) ** 4 * (2 * R + 1) * 21 / (16 * np.pi), 5 * R * (1 - R / 2) ** 3 * 21 / (16 * np.pi)


def waves(n):
    """|W(k)|^2 and the part S of mu k^2 that the friction of SPH has, for the waves of a cube of n spacings; k in 1/h,
    its direction, and W, S of any k."""
    ks = (np.arange(1500) + 0.5) / 100
    W = np.array([4 * np.pi * (R * R * K * np.sinc(k * R / np.pi)).sum() * (R[1] - R[0]) for k in ks])
    j = lambda x: np.where(x > 0.02, (np.sin(x) / x - np.cos(x)) / x**2, 1 / 3 - x * x / 30)
    S = np.array([40 * np.pi * (R * dK * (1 / 3 - j(k * R))).sum() * (R[1] - R[0]) / k**2 for k in ks])
    n3 = np.stack(np.meshgrid(*[np.arange(-25, 26)] * 3, indexing="ij"), -1).reshape(-1, 3) * 2 * np.pi * H / n
    k = np.linalg.norm(n3, axis=1)
    keep = (k > 0) & (k < 15)
    return k[keep], n3[keep, 2] / k[keep], ks, W, S


def test_a_grain_falls_as_the_law_and_the_flow_of_its_box_have_it():
    """In a periodic cube whose water has no mean velocity each grain stands in the flow of its images, which Oseen's
    equation has as a sum over waves; less its own flow, the same as an integral. The terminal speed is the law's speed
    plus that: 1 %, at h = 2, 3 and 4 grain diameters."""
    n, mu, Re = 10, 1.0, 0.1
    k, c, ks, W, S = waves(n)
    for diameter in (H / 2, H / 3, H / 4):
        U = Re / diameter
        F = np.pi * diameter / 8 * brown_lawler(Re) * U
        Wk, Sk, carried = np.interp(k, ks, W), np.interp(k, ks, S), U * H
        images = 6 * np.pi * (H / n) ** 3 * (Wk**2 * (1 - c * c) / (k**2 * Sk) /
                                             (1 + (carried * c / (k * Sk)) ** 2)).sum()
        s = carried / (ks * S)
        alone = 3 / np.pi * (W**2 / S * ((1 + s**-2) * np.arctan(s) / s - s**-2)).sum() * (ks[1] - ks[0])
        right = U + F / (6 * np.pi * mu * H) * (images - alone)
        push = f"fix pull grains addforce 0 0 {-F:.17g}\nfix push water addforce 0 0 {F / n**3:.17g}"
        lmp = start()
        run(lmp, scene((n, n, n), mu, 2.5, 0.15, "", singles([(5.03, 4.97, 5.1)]), diameter, before_fix=push))
        run(lmp, "compute v grains reduce sum vz\ncompute w water reduce ave vz\nvariable p atom mass*vz\n"
                 "compute p all reduce sum v_p\nthermo_style custom c_v c_w c_p\nrun 250")
        speed = lmp.extract_compute("w", 0, 0) - lmp.extract_compute("v", 0, 0)
        assert abs(speed / right - 1) < 0.01, (diameter, speed, right)
        assert abs(speed / U - 1) > 0.04    # that the images matter
        assert abs(lmp.extract_compute("p", 0, 0)) < 1e-12 * F * 250 * 0.15
        lmp.close()


@pytest.mark.parametrize("Re, ratio, allowed_error", [(10, 2, 0.02), (10, 3, 0.01), (10, 4, 0.01), (200, 2, 0.01),
                                                      (200, 3, 0.01), (200, 4, 0.01)])
def test_a_grain_with_inertia_falls_as_the_law_has_it(Re, ratio, allowed_error):
    """In a periodic column, before its wake comes round: the law's own speed to 1 %, at h of 2, 3 and 4 diameters. At
    Re = 10 and 2 diameters the own flow is 8 % of the speed and has not developed yet: 2 %."""
    U, d, n = 0.5, H / ratio, (8, 8, 16)
    F = np.pi / 8 * d * d * brown_lawler(Re) / Re * U * U
    push = f"fix pull grains addforce 0 0 {-F:.17g}\nfix push water addforce 0 0 {F / np.prod(n):.17g}"
    lmp = start()
    run(lmp, scene(n, U * d / Re, 5, 0.06, "", singles([(4.03, 3.97, 12.1)]), d, before_fix=push))
    run(lmp, f"velocity grains set 0 0 {-U} units box\ncompute v grains reduce sum vz\ncompute w water reduce ave vz\n"
             "thermo_style custom c_v c_w\nrun 180")
    speed = (lmp.extract_compute("w", 0, 0) - lmp.extract_compute("v", 0, 0)) / U
    lmp.close()
    assert abs(speed - 1) < allowed_error, speed


def test_a_grain_without_weight_in_water_at_rest_stays():
    lmp = start()
    run(lmp, scene((8, 8, 8), 0.5, 5, 0.05, "", singles([(3.3, 4.1, 3.9)])))
    run(lmp, "run 100")
    n = lmp.extract_global("nlocal")
    x = by_id(lmp, "x", 3)[-1]
    assert np.abs(x - (3.3, 4.1, 3.9)).max() < 1e-6 and n == 513
    lmp.close()


@pytest.mark.parametrize("place", [(3.1, 2.9, 4.2), (2.7, 3.2, 0.6), (3.0, 3.4, 5.6)],
                         ids=["inside", "on the floor", "a support below the surface"])
def test_a_held_grain_bears_the_weight_of_the_water_in_its_place(place):
    """In a tank at rest, whatever sums over neighbours are at a wall or a surface, with next to no drag. The water
    begins with its hydrostatic density."""
    g, c = 0.05, 6.0
    lmp = start()
    run(lmp, scene((6, 6, 12), 0.3, c, 0.06, "viscosity 0.001", singles([place]), 1.0, "p p f", gravity=f"0 0 {-g}",
                   floor=4, mover="", before_fix=f"fix down water gravity {g} vector 0 0 -1\n"
                              f"variable rho atom (1+7*{g}*(8-z)/{c * c})^(1/7)\n"
                              "set group sph sph/rho v_rho\nset group sph mass v_rho"))
    run(lmp, "run 150\nfix mean all ave/time 1 150 150 f_g[3]\nrun 150")
    lift = lmp.extract_fix("mean", 0, 0) / (g * np.pi / 6)
    lmp.close()
    assert abs(lift - 1) < 0.01, lift


# --- beds -------------------------------------------------------------------------------------------------------------

BLOCK = "lattice sc 1 origin 0.5 0.5 0.5\nregion bed block 0 5 0 5 4 12 units box\ncreate_atoms 2 region bed"


@pytest.mark.parametrize("phi, spacing", [(0.27, 1), (0.52, 1), (0.6, 5 / 6)])
@pytest.mark.parametrize("law", ["ergun", "beetstra", "brown_lawler"])
def test_a_fixed_bed_has_the_pressure_drop_of_its_law(law, phi, spacing):
    """A body force G per mass of water drives a flow through a lattice of fixed grains that fills the periodic box: G
    rho = n F(w), Re 0.5 to 5."""
    mu, e, diameter = 0.1, 1 - phi, spacing * (6 / np.pi * phi) ** (1 / 3)
    for w in (0.05, 0.5):
        Re = w * diameter / mu
        G = 3 * np.pi * mu * diameter * w * of_bed(law, Re, e) / spacing**3
        lmp = start()
        run(lmp, scene((5, 5, 5), mu, 10, 0.02, "drag " + law,
                       f"lattice sc {spacing**-3}\ncreate_atoms 2 box\nlattice sc 1", diameter, mover="",
                       before_fix=f"fix push water gravity {G:.17g} vector 0 0 1"))
        run(lmp, f"velocity water set 0 0 {0.5 * w} units box\nrun 100")
        v, kind = by_id(lmp, "v", 3)[:, 2], by_id(lmp, "type")
        lmp.close()
        assert (kind == 2).sum() == round(5 / spacing) ** 3
        assert abs(v[kind == 1].mean() / w - 1) < 0.02, (w, v[kind == 1].mean() / w)


@pytest.mark.parametrize("law", ["beetstra", "brown_lawler"])
def test_a_suspension_settles_as_its_law_has_it(law):
    """Grains that are free to move, pulled by F, in water that is pushed back by as much: from rest to the slip w of (1
    - phi) F(w) = F, within 1 %. The water flows back: momentum stays 0."""
    mu, d, w = 0.1, 0.8, 0.3
    phi = np.pi / 6 * d**3
    F = (1 - phi) * 3 * np.pi * mu * d * w * of_bed(law, w * d / mu, 1 - phi)
    lmp = start()
    run(lmp, scene((5, 5, 5), mu, 10, 0.02, "drag " + law, "create_atoms 2 box", d,
                   before_fix=f"fix pull grains addforce 0 0 {-F:.17g}\nfix push water addforce 0 0 {F:.17g}"))
    run(lmp, "displace_atoms grains random 0.1 0.1 0.1 77 units box\nrun 200")
    m, v, kind = by_id(lmp, "rmass"), by_id(lmp, "v", 3)[:, 2], by_id(lmp, "type")
    lmp.close()
    assert abs((v[kind == 1].mean() - v[kind == 2].mean()) / w - 1) < 0.01
    assert v[kind == 1].mean() > 0.05 and abs((m * v).sum()) < 1e-12 * (m * np.abs(v)).sum()


def lowered(diameter, viscosity):
    """How far the level of a tank, 12 spacings deep, rises when 96 grains are lowered from the air, out of reach, into
    its middle, and what their volume would make of it"""
    g, c, dt = 0.05, 6, 0.06
    above = "region above block 0 4 0 4 17 23 units box\ncreate_atoms 2 region above"
    text = scene((4, 4, 24), 0.3, c, dt, f"viscosity {viscosity}", above, diameter, "p p f", gravity=f"0 0 {-g}",
                 floor=4, mover="", before_fix=f"fix down water gravity {g} vector 0 0 -1\n"
                            "compute level sph sph/probe height z 1 1 0 height z 3 3 0\n"
                            "variable level equal ave(c_level)\n"
                            "fix mean all ave/time 1 200 200 v_level")
    lmp = start()
    run(lmp, text.replace("region water block 0 4 0 4 0 20", "region water block 0 4 0 4 0 12"))
    run(lmp, "run 200")
    level = [lmp.extract_fix("mean", 0, 0)]
    run(lmp, "fix sink grains move linear 0 0 -0.4 units box\nrun 583\nunfix sink\nvelocity grains set 0 0 0\nrun 400")
    level.append(lmp.extract_fix("mean", 0, 0))
    z, kind = by_id(lmp, "x", 3)[:, 2], by_id(lmp, "type")
    lmp.close()
    assert (kind == 2).sum() == 96 and np.abs(z[kind == 2] - 6).max() < 2.6
    return level[1] - level[0], 96 * np.pi / 6 * diameter**3 / 16


def test_the_water_of_a_tank_rises_by_the_volume_of_grains_that_are_lowered_into_it():
    """Within 1 %. Water of SPH that is stirred fills 0.03 spacings more, and without grains just as well: so the rise
    is that over grains of a thousandth of the volume, with the same drag."""
    rise, volume = lowered(1.0, 0.01)
    stirred, nothing = lowered(0.1, 0.1)
    assert abs(stirred) < 0.05 and volume > 3
    assert abs((rise - stirred) / (volume - nothing) - 1) < 0.01, (rise, stirred, volume)


def test_the_flux_goes_through_the_edges_of_a_block():
    """(1 - phi) u is that of the clear water through a block of grains, 0.52 of its volume, whose edges are as sharp as
    the kernel: 2 %, as the mean over h to both sides, everywhere along x. With delta 0.1 it would be 2.4 %: delta lets
    water through where the slope of the pressure changes."""
    mu, G = 0.1, 0.05
    lmp = start()
    run(lmp, scene((5, 5, 16), mu, 25, 0.01, "drag ergun", BLOCK, 1.0, mover="",
                   pair="central artVisc 0.2 0 0.04 shift yes", delta=0.02,
                   before_fix=f"fix push water gravity {G:.17g} vector 0 0 1"))
    run(lmp, "run 600")
    n = lmp.extract_global("nlocal")
    x, v, kind = [np.array(lmp.numpy.extract_atom(name, nelem=n, dim=3 if name != "type" else 1))[:n]
                  for name in ("x", "v", "type")]
    phi = np.array(lmp.numpy.extract_fix("g", 1, 2))[:n, 0]
    water, z, flux = kind == 1, x[:, 2], v[:, 2] * (1 - phi)
    lmp.close()
    assert phi[water].max() > 0.5 and phi[water].min() < 1e-3
    rows = np.array([flux[water & (z >= k) & (z < k + 1)].mean() for k in range(16)])
    along = sum(np.roll(rows, k) for k in range(4)) / 4
    assert rows.mean() > 0 and np.abs(along / rows.mean() - 1).max() < 0.02, along / rows.mean()


def test_a_bed_in_a_tank_stays_at_rest():
    """Grains at random on the floor of a tank, phi 0.5 and uneven at the scale of a grain, under a pressure of a
    hundred grains' weight: no sound grows, and the pressure of the water between them is that of the tank without them,
    1 % of that of the floor."""
    g, c = 1.0, 30.0
    bed = "lattice sc 1 origin 0.5 0.5 0.5\nregion bed block 0 6 0 6 0 6 units box\ncreate_atoms 2 region bed"
    lmp = start()
    run(lmp, scene((6, 6, 16), 0.3, c, 0.01, "", bed, 1.0, "p p f", gravity=f"0 0 {-g}", floor=4, mover="",
                   pair="central artVisc 0.1 0 0.04 shift yes", before_fix=f"fix down water gravity {g} vector 0 0 -1\n"
                              f"variable rho atom (1+7*{g}*(12-z)/{c * c})^(1/7)\n"
                              "set group sph sph/rho v_rho\nset group sph mass v_rho\n"
                                                                           "displace_atoms grains random 0.2 0.2 "
                                                                           "0.2 77 units box"))
    run(lmp, "run 500")
    z, v, kind, P = by_id(lmp, "x", 3)[:, 2], by_id(lmp, "v", 3), by_id(lmp, "type"), fix_by_id(lmp, "eos")
    lmp.close()
    water = kind == 1
    assert np.abs(v[water]).max() < 0.01
    inside = water & (z < 5)
    assert np.abs(P[inside] - (12 - z[inside])).max() < 0.12


def test_a_bed_that_reaches_the_surface_does_not_hide_the_level():
    """compute sph/probe has the volume of the mixture: water of 12 spacings in grains of phi 0.52 that are heaped up
    higher."""
    bed = "lattice sc 1 origin 0.5 0.5 0.5\nregion bed block 0 5 0 5 0 16 units box\ncreate_atoms 2 region bed"
    lmp = start()
    run(lmp, scene((5, 5, 16), 0.3, 10, 0.01, "", bed, 1.0, "p p f", gravity="0 0 -0.1", floor=4, mover="",
                   before_fix="compute level sph sph/probe height z 3 3 0\nthermo_style custom c_level[1]"))
    run(lmp, "run 0")
    level = lmp.extract_compute("level", 0, 1)[0]
    lmp.close()
    assert abs(level - 12) < 0.05, level


def test_a_grain_that_is_not_in_the_group_is_told_of(tmp_path):
    for where, told in (("all", True), ("grains", False)):
        lmp = start(["-log", str(tmp_path / where)])
        run(lmp, scene((8, 8, 8), 0.3, 6, 0.03, "", singles([(3.3, 4.1, 3.9)])))
        run(lmp, f"region room block 5 7 5 7 5 7 units box\nfix rain {where} deposit 1 2 1 4711 region room units box\n"
                 "run 2\nrun 0\nlog none")
        assert lmp.get_natoms() == 514
        lmp.close()
        assert ("atom 514 has a type of its grains and is not in its group" in (tmp_path / where).read_text()) == told


# --- momentum, ranks, restarts ----------------------------------------------------------------------------------------

CLOUD = np.random.default_rng(5).uniform(0, 8, (60, 3))
CLOSED = dict(size=(8, 8, 8), mu=0.3, c=6, dt=0.03, fix="", grains=singles(CLOUD), diameter=0.9)
STIR = """
    variable sx atom 0.5*sin(2*PI*z/8)
    variable sy atom 0.4*cos(2*PI*x/8)
    velocity all set v_sx v_sy 0.1 sum no units box
    velocity grains set 0.3 -0.2 0.1 sum yes units box
"""
AGAIN = f"""
    pair_coeff * * zero
    pair_coeff 1 1 sph/artVisc/tensCorr c 6 deltap 1
    pair_coeff 1 3 sph/artVisc/tensCorr
    pair_coeff 3 3 sph/artVisc/tensCorr c 6 deltap 1
    comm_modify vel yes
    neighbor 0.3 bin
    neigh_modify delay 0 every 1
    timestep 0.03
    fix eos sph sph/pressure Tait {36 / 7} 1 7
    fix den sph sph/density/continuity delta 0.1 volume yes
    fix mw water nve/sph
    fix mg grains nve/sphere
    fix g grains sph/grains
"""


@pytest.mark.parametrize("ranks, newton", allowed((1, "on"), (1, "off"), (2, "on"), (2, "off"), (4, "on"), (4, "off")))
def test_momentum_of_water_and_grains_is_kept_on_any_number_of_ranks(ranks, newton, tmp_path):
    """Closed periodic box: the sum changes by 1e-12 of sum m |v|, and the trajectories are those of one rank."""
    lmp = start()
    run(lmp, scene(**CLOSED) + STIR + f"write_restart {tmp_path}/begin\nrun 40")
    m, v, x = by_id(lmp, "rmass"), by_id(lmp, "v", 3), by_id(lmp, "x", 3)
    lmp.close()
    script = f"newton {newton}\natom_modify map array\nread_restart begin\n" + AGAIN + """
    dump d all custom 40 dump.* id type mass x y z vx vy vz f_g[1] f_g[4]
    dump_modify d format float %.17g
    run 40"""
    done = mpirun(ranks, script, tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    momenta, sizes = [], []
    for step in (0, 40):
        t = read_dump(tmp_path / f"dump.{step}")
        mv = t["mass"][:, None] * np.stack([t["vx"], t["vy"], t["vz"]], 1)
        momenta.append(mv.sum(0))
        sizes.append(np.abs(mv).sum())
    assert t["f_g[1]"].max() > 0.04 and sizes[1] != sizes[0]
    assert np.abs(momenta[1] - momenta[0]).max() < 1e-12 * sizes[0]
    assert np.abs(np.stack([t["vx"], t["vy"], t["vz"]], 1) - v).max() < 1e-11
    off = np.abs(np.stack([t["x"], t["y"], t["z"]], 1) - x)
    assert np.minimum(off, np.abs(8 - off)).max() < 1e-11 and np.abs(m - t["mass"]).max() < 1e-12


def test_rigid_clumps_of_grains_and_water_keep_their_momentum():
    """Eight bodies of seven or eight grains each."""
    text = (scene(**{**CLOSED, "mover": ""}) + STIR + "fix ids all property/atom i_b\nvariable b atom (id-1)%8\n"
                                                      "set group grains i_b v_b\nfix mg grains rigid custom i_b\n")
    lmp = start()
    momenta = []
    for steps in (0, 40):
        run(lmp, text + "run 0" if steps == 0 else f"run {steps}")
        m, v = by_id(lmp, "rmass")[:, None], by_id(lmp, "v", 3)
        momenta.append((m * v).sum(0))
    assert np.abs(force_of_all(lmp)).max() > 0.1
    lmp.close()
    assert np.abs(momenta[1] - momenta[0]).max() < 1e-12 * (m * np.abs(v)).sum()


@pytest.mark.parametrize("runs", ["run 40", "run 15\nrun 25", "run 20\nrun 0\nrun 20",
                                  "run 15\nreset_timestep 0\nrun 25", "run 20\nwrite_restart {file}",
                                  "run 20 every 7 \"write_restart {file}\""],
                         ids=["one", "two", "with none between", "reset_timestep", "restart", "restart from within"])
def test_a_broken_run_is_the_unbroken_one(runs, tmp_path):
    """In the middle of a fall, to rounding: the forces of the last step stand, which had velocities at half step.
    Grains have no pressure."""
    lmp = start()
    run(lmp, scene(**CLOSED) + STIR + "run 40")
    right = by_id(lmp, "x", 3), by_id(lmp, "v", 3), by_id(lmp, "rmass"), fix_by_id(lmp, "eos")
    lmp.close()
    assert np.abs(right[3][-60:]).max() == 0 and np.abs(right[3]).max() > 1e-3
    lmp = start()
    run(lmp, scene(**CLOSED) + STIR + runs.format(file=tmp_path / "half"))
    if "restart" in runs:
        lmp.close()
        lmp = start()
        run(lmp, f"atom_modify map array sort 0 0\nread_restart {tmp_path}/half\n" + AGAIN)
        run(lmp, "run 40 upto")
    for one, other in zip(right, (by_id(lmp, "x", 3), by_id(lmp, "v", 3), by_id(lmp, "rmass"), fix_by_id(lmp, "eos"))):
        off = np.abs(one - other)
        assert np.minimum(off, np.abs(8 - off)).max() < 1e-13
    lmp.close()


@pytest.mark.parametrize("change", ["velocity grains set 0.5 NULL NULL units box",
                                    "velocity water set NULL 0.2 NULL units box",
                                    "displace_atoms grains move 0.4 0 0 units box",
                                    "displace_atoms water move 0.4 0 0 units box", "set group grains diameter 0.7",
                                    "set group grains density 2.0"])
def test_a_run_after_a_change_finds_the_drag_anew(change):
    """The force on grains at the beginning is that of a run that begins so, within what the volumes of the water are
    lacking that are found from phi."""
    found = []
    for before in ("run 5\n", "run 5\nunfix g\nfix g grains sph/grains displace no\n"):
        lmp = start()
        run(lmp, scene(**CLOSED) + STIR + before + change + "\nrun 0")
        found.append(forces_on_grains(lmp)[:, 1:])
        lmp.close()
    assert np.abs(found[0] - found[1]).max() < 1e-3 * np.abs(found[0]).max()


@pytest.mark.parametrize("words", ["drag ergun", "viscosity 3", "own_flow no", "hindrance 2"])
def test_another_law_after_a_restart_acts_in_the_first_force(words, tmp_path):
    """As that of a fix with another ID does, which has nothing of the file."""
    lmp = start()
    run(lmp, scene(**CLOSED) + STIR + f"run 5\nwrite_restart {tmp_path}/half")
    old = forces_on_grains(lmp)[:, 1:]
    lmp.close()
    found = []
    for name in ("g", "again"):
        lmp = start()
        run(lmp, f"atom_modify map array sort 0 0\nread_restart {tmp_path}/half\n" +
            AGAIN.replace("fix g grains sph/grains", f"fix {name} grains sph/grains displace no {words}") + "run 0")
        found.append(by_id(lmp, "f", 3)[-60:])
        lmp.close()
    assert np.abs(found[0] - found[1]).max() < 1e-3 * np.abs(found[0]).max()
    assert np.abs(found[0] - old).max() > 0.05 * np.abs(old).max()


def test_drag_that_is_stiff_does_not_overshoot():
    """Grains whose own time is a thousandth of the step go with the water at once, and all momentum is kept."""
    lmp = start()
    run(lmp, scene((8, 8, 8), 0.3, 6, 0.03, "viscosity 300", singles(CLOUD), 0.9))
    run(lmp, "velocity grains set 1 0 0 units box\nvariable p atom mass*vx\ncompute p all reduce sum v_p\n"
             "thermo_style custom c_p\nrun 3")
    v, kind = by_id(lmp, "v", 3)[:, 0], by_id(lmp, "type")
    m = by_id(lmp, "rmass")
    mean = (m * v).sum() / m.sum()
    lmp.close()
    assert v[kind == 2].min() > 0 and v[kind == 2].max() < 0.5
    assert abs(mean * m.sum() - m[kind == 2].sum()) < 1e-12 * m.sum()


# --- bad input --------------------------------------------------------------------------------------------------------

ONE = singles([(3.3, 4.1, 3.9)])
BAD = {
    "large grains": (dict(diameter=1.01), "",
                     "the smoothing length h = 2 is below 2 diameters of the largest grain, 1.01"),
    "no viscosity": (dict(pair="X"), "",
                     "keyword viscosity is required: drag needs the dynamic viscosity of the water"),
    "grains in the water": (dict(), "group grains type 1",
                            "atom 1 of its group has a type of pair_style sph/artVisc/tensCorr"),
    "dense": (dict(grains=singles([(3.3 + 0.01 * k, 4.1, 3.9) for k in range(80)]), diameter=1.0), "",
              "the volume fraction of grains around atom"),
    "no volume": (dict(), "unfix den\nfix den sph sph/density/continuity delta 0.1",
                  "needs volume yes of fix sph/density/continuity"),
    "correction": (dict(pair="central correction yes"), "", "does not go with correction yes"),
    "gravity behind": (dict(), "fix late all gravity 1 vector 0 0 -1",
                       "fix late of style gravity stands behind fix sph/grains in the input"),
    "push of the water behind": (dict(), "fix late water addforce 0 0 -1",
                                 "fix late of style addforce stands behind fix sph/grains"),
    "setforce before": (dict(before_fix="fix hold grains setforce 0 0 0"), "",
                        "fix hold of style setforce stands before fix sph/grains in the input"),
    "stiff bodies": (dict(grains=singles([(3, 4, 4), (4, 4, 4)]), mover="fix mg grains rigid single",
                          fix="viscosity 300"), "velocity grains set 1 0 0 units box",
                     "atom 513 is of a rigid body, on which drag is explicit: the time step 0.05 must be below its "
                     "mass over its drag, 0.0"),
    "grains that grow": (dict(atom_style="sph sphere 1"),
                         "variable d equal 0.5+step\nfix grow grains adapt 1 atom diameter v_d",
                         "the smoothing length h = 2 is below 2 diameters of the largest grain, 1.5"),
    "two": (dict(), "fix g2 grains sph/grains", "more than one fix sph/grains; put all grains into one group"),
    "dynamic group": (dict(), "group some dynamic grains every 1\nunfix g\nfix g some sph/grains",
                      "fix g of style sph/grains has the dynamic group some"),
    "drag of another fix": (dict(), "fix calm grains viscous 0.1",
                            "fix calm of style viscous drags grains that the water of SPH drags already"),
    "a pull behind the grains": (dict(), "fix pull grains drag 4 4 4 0.1 1",
                                 "fix pull of style drag stands behind fix sph/grains in the input"),
    "filter": (dict(), "fix filter water sph/density/corr shepard every 10", "does not go with fix sph/density/corr"),
    "drag": (dict(fix="drag stokes"), "", "keyword drag: 'stokes'"),
    "hindrance": (dict(fix="drag ergun hindrance 3"), "",
                  "keyword hindrance: ergun, gidaspow, beetstra and koch_hill have the neighbours"),
    "fall": (dict(fix="fall_diameter 0"), "", "keyword fall_diameter"),
    "viscosity": (dict(fix="viscosity -1"), "", "keyword viscosity"),
    "displace": (dict(fix="displace maybe"), "", "keyword displace"),
    "own flow": (dict(fix="own_flow 2"), "", "keyword own_flow"),
    "unknown": (dict(fix="classes 0"), "", "unknown keyword 'classes'"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_names_the_way_out(case):
    changes, more, message = BAD[case]
    lmp = start()
    text = scene(**{**dict(size=(8, 8, 8), mu=0.5, c=5, dt=0.05, fix="", grains=ONE), **changes})
    if case == "no viscosity":
        text = text.replace("viscosity 0.5 X", "artVisc 0.2 0 0.04").replace("deltap 1", "")
    if case == "grains in the water":
        text = text.replace("group grains type 2", "group grains type 1 2").replace("fix mg grains nve/sphere", "")
        more = ""
    with pytest.raises(RuntimeError, match=message.replace("(", r"\(")):
        run(lmp, text + more + "\nrun 1")
    lmp.close()


def test_a_pull_to_a_point_is_no_drag():
    """LAMMPS's fix drag before fix sph/grains is a force as others."""
    lmp = start()
    run(lmp, scene(size=(8, 8, 8), mu=0.5, c=5, dt=0.05, fix="", grains=ONE,
                   before_fix="fix pull grains drag 4 4 4 0.1 1") + "\nrun 1")
    lmp.close()


def test_another_atom_style_or_dimension_is_refused():
    from sph_tools import random_scene

    lmp = start()
    with pytest.raises(RuntimeError, match="use atom_style hybrid sph sphere"):
        run(lmp, random_scene() + "\nfix g all sph/grains")
    lmp.close()
    lmp = start()
    with pytest.raises(RuntimeError, match="needs dimension 3"):
        run(lmp, "units lj\ndimension 2\natom_style hybrid sph sphere\nregion b block 0 4 0 4 -0.5 0.5\n"
                 "create_box 1 b\nfix g all sph/grains")
    lmp.close()
