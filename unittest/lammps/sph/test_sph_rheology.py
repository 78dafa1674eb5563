"""Fluids whose viscosity depends on the shear rate, against closed forms: channels, a Couette viscometer; and what is
refused."""
import numpy as np
import pytest

from sph_tools import by_id, mpirun, random_scene, read_dump, run, start
from test_sph_input import MOVE, PAIR, message

# mu, tau, n, mumax; rho = 1, the channel is 1 wide
LAWS = {"power_law": (0.1, 0.0, 0.5, 0.4), "bingham": (0.1, 0.1, 1.0, 0.8), "herschel_bulkley": (0.1, 0.05, 0.7, 0.8)}


def words(name):
    mu, tau, n, most = LAWS[name]
    numbers = {"power_law": (n, most), "bingham": (tau, most), "herschel_bulkley": (tau, n, most)}[name]
    return "viscosity %.17g {} rheology %s %s" % (mu, name, " ".join("%.17g" % x for x in numbers))


def shear_rate(name, stress):
    """The inverse of stress = min(mumax G, tau + mu G^n)."""
    mu, tau, n, most = LAWS[name]
    return np.maximum(stress / most, (np.maximum(stress - tau, 0.0) / mu) ** (1.0 / n))


def closed_form(name, g, y):
    """The stress g y of a channel of width 1, integrated from the wall."""
    s = np.linspace(0.0, 0.5, 4001)
    G = shear_rate(name, g * s)
    u = np.concatenate([[0.0], np.cumsum(0.5 * (G[1:] + G[:-1]) * np.diff(s))])
    return np.interp(np.abs(y), s, u[-1] - u)


def driven(name):
    """g that gives the centre the speed 1."""
    low, high = 1e-3, 1e3
    for _ in range(60):
        middle = (low * high) ** 0.5
        low, high = (middle, high) if closed_form(name, middle, 0.0) < 1.0 else (low, middle)
    return low


CHANNEL = """
    units si
    dimension 2
    atom_style sph
    atom_modify map array
    boundary p f p
    lattice sq {dx} origin 0.5 0.5 0
    region box block 0 {length} {bottom} {top} -{half} {half} units box
    create_box 2 box
    region all block 0 {length} {floor} {roof} -{half} {half} units box
    region water block 0 {length} -0.5 0.5 -{half} {half} units box
    create_atoms 2 region all
    set region water type 1
    group water type 1
    group wall type 2
    mass * {mass}
    set group all sph/rho 1
    displace_atoms water random {tenth} {tenth} 0 4711
    variable u atom (1-4*y*y)*(type==1)
    velocity all set v_u 0 0 units box
    neighbor {skin} bin
    neigh_modify delay 0 every 1 exclude type 2 2
    pair_style sph/artVisc/tensCorr cubicspline {h} {viscosity} correction yes
    pair_coeff * * c 10
    fix eos all sph/pressure Tait 14.285714285714286 1 7
    fix density all sph/density/continuity delta 0.1
    fix wall wall wall/adami/sph
    fix move water nve/sph
    fix rest wall nve/sph/stationary
    fix g water addforce {force} 0 0
    fix flat all enforce2d
    timestep {dt}
    """


def channel(name, across, T, form="laplacian", dt=0.0, more=""):
    """A channel, from the parabola of a Newtonian fluid on: its root mean square error in units of the speed of the
    centre, and that of the discharge; at the start, and at the end. `more`: words for the pair style."""
    dx, g, layers = 1.0 / across, driven(name), 3
    h = 1.3 * dx
    dt = dt or min(0.3 * h / 10, 0.9 * h * h / (8 * LAWS[name][3]))
    lmp = start()
    try:
        run(lmp, CHANNEL.format(dx=dx, half=dx / 2, length=8 * dx, bottom=-0.5 - (layers + 1) * dx,
                                top=0.5 + (layers + 1) * dx, floor=-0.5 - layers * dx,
                                roof=0.5 + layers * dx, mass=dx * dx, tenth=0.1 * dx, skin=0.3 * dx, h=h,
                                viscosity=words(name).format(form) + more, force=g * dx * dx, dt=dt))
        errors = []
        for steps in (0, int(T / dt)):
            run(lmp, "run %d" % steps)
            water = by_id(lmp, "type") == 1
            u, y = by_id(lmp, "v", 3)[water, 0], by_id(lmp, "x", 3)[water, 1]
            exact = closed_form(name, g, y)
            errors.append((np.sqrt(((u - exact) ** 2).mean()), u.mean() / exact.mean() - 1))
        return errors
    finally:
        lmp.close()


# seconds until the start is forgotten, and what is left of it and of the particles then, 20 across
@pytest.mark.parametrize("name, T", [("power_law", 16), ("bingham", 6), ("herschel_bulkley", 8)])
def test_a_channel_forgets_its_parabola_and_finds_the_closed_form(name, T):
    """From 6 to 10 % off to 1 % of the speed of the centre, with a smaller error on smaller particles."""
    coarse, fine = channel(name, 10, T), channel(name, 20, T)
    assert min(coarse[0][0], fine[0][0]) > 0.06
    assert fine[1][0] < 0.01 and abs(fine[1][1]) < 0.011
    assert fine[1][0] < 0.75 * coarse[1][0] < 0.012


@pytest.fixture
def stiff(monkeypatch):
    """Bingham's fluid, whose plug fills half of the channel, with a mumax of 160 times mu; the longest explicit time
    step, 10 across"""
    monkeypatch.setitem(LAWS, "bingham", (0.1, 1.0, 1.0, 16.0))
    return 0.13**2 / (8 * 16)


def test_implicit_friction_bears_twenty_times_the_explicit_step(stiff):
    """As explicit friction in 22 times as many steps (0.0570, -0.0200), which boils at such a step: the plug is fluid
    there."""
    implicit = channel("bingham", 10, 2.0, dt=20 * stiff, more=" implicit yes")[1]
    assert implicit[0] == pytest.approx(0.0570, abs=1e-3) and implicit[1] == pytest.approx(-0.0200, abs=1e-3)
    assert channel("bingham", 10, 2.0, dt=20 * stiff)[1][0] > 0.08


def test_implicit_friction_is_of_first_order_and_meets_the_explicit_one(stiff):
    """From the same start for the same time: half the step, half the difference; 1e-6 of the centre's speed in small
    steps."""
    apart = []
    for part in (0.2, 0.1):
        both = [channel("bingham", 10, 40 * stiff, dt=part * stiff, more=more)[1] for more in ("", " implicit yes")]
        apart.append(abs(both[0][1] - both[1][1]))
    assert apart[1] == pytest.approx(0.5 * apart[0], rel=0.15) and apart[1] < 1e-4, apart


def test_a_wall_bears_what_drives_the_channel_with_implicit_friction():
    """Newton's fluid in steps of 30 times the explicit limit, in which explicit friction does not last: momentum leaves
    by the walls alone."""
    dx, h, g = 0.1, 0.13, 8.0 * 16
    text = CHANNEL.format(dx=dx, half=dx / 2, length=8 * dx, bottom=-0.9, top=0.9, floor=-0.8, roof=0.8, mass=dx * dx,
                          tenth=0.1 * dx, skin=0.03, h=h, viscosity="viscosity 16 {}", force=g * dx * dx,
                          dt=0.3 * h / 10)
    lmp = start()
    try:
        run(lmp, text.format("implicit yes") + "run 200")
        u = by_id(lmp, "v", 3)[by_id(lmp, "type") == 1, 0]
        assert lmp.extract_fix("wall", 0, 1, 0) == pytest.approx(g * 0.8, rel=1e-3)
        assert u.mean() == pytest.approx(2.0 / 3.0, rel=0.03)
    finally:
        lmp.close()
    assert message(text.format("") + "run 200")


def test_a_type_may_have_its_own_law():
    """Newton's fluid by pair_coeff (tau 0, n 1) in a style that is Bingham's: the parabola stays. Without it, the same
    g moves nothing."""
    dx, h = 0.1, 0.13
    speeds = []
    for own in ("", "pair_coeff * * c 10 mu 0.1 tau 0"):
        lmp = start()
        try:
            run(lmp, CHANNEL.format(dx=dx, half=dx / 2, length=8 * dx, bottom=-0.9, top=0.9, floor=-0.8, roof=0.8,
                                    mass=dx * dx, tenth=0.1 * dx, skin=0.03, h=h,
                                    viscosity="viscosity 0.1 rheology bingham 0.9 4", force=0.8 * dx * dx, dt=5e-4) +
                own + "\nrun 4000")
            speeds.append(by_id(lmp, "v", 3)[by_id(lmp, "type") == 1, 0].mean())
        finally:
            lmp.close()
    assert speeds[1] == pytest.approx(2.0 / 3.0, rel=0.03)
    assert speeds[0] < 0.03     # 0.8 y < 0.9: with mumax it creeps, (2/3) (0.1/4) of Newton's speed


def test_it_stands_on_a_slope_below_its_yield_stress_and_creeps_with_mumax():
    """A layer without a lid: what moves it, g d = 0.8, is below tau = 0.9, and it goes with the speed of a fluid that
    has mumax everywhere."""
    dx, h, dt = 0.1, 0.2, 2e-4
    lmp = start()
    try:
        text = CHANNEL.format(dx=dx, half=dx / 2, length=8 * dx, bottom=-1.0, top=0.9, floor=-0.9, roof=0.5,
                              mass=dx * dx, tenth=0, skin=0.03, h=h, viscosity="", force=0.8 * dx * dx, dt=dt)
        text = text.replace("cubicspline", "wendland").replace("correction yes",
                                                               "viscosity 0.1 central rheology bingham 0.9 8 shift yes")
        run(lmp, text.replace("(1-4*y*y)", "0") + "run 3000")
        water = by_id(lmp, "type") == 1
        u, y = by_id(lmp, "v", 3)[water, 0], by_id(lmp, "x", 3)[water, 1]
        exact = 0.8 / 8 * (y + 0.5 - (y + 0.5) ** 2 / 2)
        assert u.mean() == pytest.approx(exact.mean(), rel=0.05)
    finally:
        lmp.close()


SCENE = CHANNEL.format(dx=0.1, half=0.05, length=1.6, bottom=-0.9, top=0.9, floor=-0.8, roof=0.8, mass=0.01, tenth=0.01,
                       skin=0.03, h=0.13, viscosity="viscosity 0.1 central rheology herschel_bulkley 0.05 0.7 0.8",
                       force=0.008, dt=2e-3)
DUMP = "\nwrite_dump all custom end.dump id x y vx vy fx fy modify format float %.17g"


@pytest.mark.ranks(3)
@pytest.mark.parametrize("friction, close", [("explicit", 1e-9), ("implicit", 1e-7)])
def test_ranks_newton_and_a_restart_change_nothing(friction, close, tmp_path):
    """Of implicit friction the solve is left at 1e-8."""
    scene = SCENE if friction == "explicit" else SCENE.replace("correction yes", "correction yes implicit yes").replace(
        "0.7 0.8", "0.7 8")
    again = """
    atom_modify map array
    read_restart half
    neighbor 0.03 bin
    neigh_modify delay 0 every 1 exclude type 2 2
    """ + scene[scene.index("    fix eos"):]
    ends = []
    for name, ranks, text in (("one", 1, scene + "run 100"), ("three", 3, scene + "run 100"),
                              ("newton off", 2, "newton off\n" + scene + "run 100"),
                              ("restart", 1, scene + "run 50\nwrite_restart half\nclear\n"
                                                     "plugin load stokesdynplugin.so\n" + again + "run 50")):
        folder = tmp_path / name
        folder.mkdir()
        done = mpirun(ranks, text + DUMP, folder)
        assert done.returncode == 0, done.stdout
        end = read_dump(folder / "end.dump")
        if ends:                        # create_atoms numbers the atoms rank by rank
            along = end["x"] - ends[0]["x"][:, None]
            partner = np.hypot(along - 1.6 * np.rint(along / 1.6), end["y"] - ends[0]["y"][:, None]).argmin(1)
            end = {n: end[n][partner] for n in end}
        ends.append(end)
    for k, end in enumerate(ends[1:]):
        for names in (("vx", "vy"), ("fx", "fy")):
            scale = max(np.abs(ends[0][n]).max() for n in names)
            assert max(np.abs(end[n] - ends[0][n]).max() for n in names) < close * scale, (k, names)


STYLE = "pair_style sph/artVisc/tensCorr wendland 0.012 viscosity 1 "
WITH = PAIR.replace("\n", " viscosity 1 rheology bingham 2 30\n", 1)
REFUSED = {
    "law": (STYLE + "rheology mud 1 2",
            "keyword rheology: 'mud' is none of: power_law, bingham, herschel_bulkley, carreau"),
    "no viscosity": (STYLE.replace("viscosity 1 ", "") + "rheology bingham 1 2",
                     "keyword rheology needs keyword viscosity"),
    "tau": (STYLE + "rheology bingham -1 2", "keyword rheology: '-1' must be >= 0"),
    "mumax": (STYLE + "rheology bingham 1", "keyword rheology: value missing"),
    "n": (STYLE + "rheology power_law 0 10", "keyword rheology: '0' must be > 0"),
    "coeff without": (PAIR + "pair_coeff 1 1 tau 3", "keyword tau: the pair_style has no rheology"),
    "coeff tau": (WITH + "pair_coeff 1 1 tau -3", "keyword tau: '-3' must be >= 0"),
    "coeff n": (WITH + "pair_coeff 1 1 n 0", "keyword n: '0' must be > 0"),
    "coeff pair": (WITH + "pair_coeff 1 2 mu 3", "keyword mu: with rheology and with implicit each particle"),
    "mumax below mu": (WITH + "pair_coeff * * mumax 0.5\n" + MOVE + "run 0",
                       "type 1: mumax = 0.5 must not be smaller than mu = 1"),
    "implicit": (STYLE.replace("viscosity 1 ", "") + "implicit yes", "keyword implicit needs keyword viscosity"),
    "implicit pair": (PAIR.replace("\n", " viscosity 1 implicit yes\n", 1) + "pair_coeff 1 2 mu 3",
                      "keyword mu: with rheology and with implicit"),
    "implicit fix sph": (PAIR.replace("\n", " viscosity 1 implicit yes\n", 1) + MOVE.replace("nve/sph", "sph") +
                         "run 0", "keyword implicit needs fix nve/sph"),
    "carreau n": (PAIR.replace("\n", " viscosity 1 rheology carreau 0.1 1.5 30\n", 1) + MOVE + "run 0",
                  "n = 1.5 must be at most 1 with carreau"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused(name):
    commands, expected = REFUSED[name]
    assert expected in message(random_scene() + commands)


def test_a_time_step_that_mumax_does_not_bear_is_warned_of(tmp_path):
    long, short = [mpirun(1, SCENE.replace("timestep 0.002", f"timestep {dt}") + "run 0", tmp_path).stdout
                   for dt in (0.0012, 0.0011)]
    assert "the time step 0.0012 is longer than h^2 rho/(18 mumax) = 0.00117" in long
    assert "mumax" not in short.replace("rheology herschel_bulkley", "")


def test_fix_check_timestep_uses_the_viscosities_of_the_moment():
    """Sheared at the rate 2 everywhere, the viscosity is 0.1 + 0.9/2; at rest it is mumax."""
    limits = []
    for rate in (0.0, 2.0):
        lmp = start()
        try:
            text = SCENE.replace("herschel_bulkley 0.05 0.7 0.8", "bingham 0.9 4").replace("(1-4*y*y)", "%g*y" % rate)
            run(lmp, text.replace("displace_atoms water random 0.01 0.01", "displace_atoms water random 0 0") +
                "region middle block INF INF -0.21 0.21 INF INF units box\ngroup middle region middle\n"
                "fix limit middle check/timestep/sph 1 10\nrun 0")
            limits.append(lmp.extract_fix("limit", 0, 1, 0))
        finally:
            lmp.close()
    assert limits[0] == pytest.approx(0.13**2 / (18 * 4), rel=1e-9)
    assert limits[1] == pytest.approx(0.13**2 / (18 * (0.1 + 0.9 / 2)), rel=1e-6)
