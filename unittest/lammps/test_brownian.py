"""fix stokes_dynamics/overdamped with a temperature: covariance of one step against the mobility, Boltzmann's distribution in traps and
bonds, one run on several ranks and in pieces, and what is refused. Bounds are four standard deviations of the sample."""
import os
import re

import numpy as np
import pytest

import model
from system import LammpsError, Spheres, dump_lines, input_lines, lmp, read_dump

P6 = 6 * np.pi
ETA, A, KT = 1.3, 0.7, 0.8
UNIT = P6 * ETA * A
SHORT = 1e-11 * A**2 * UNIT / KT    # nothing moves in such a step


def noise(sim, options="", kT=KT, seed=12345, fix="move"):
    return sim.commands(f"fix {fix} all stokes_dynamics/overdamped temperature {kT!r} {seed} {options}")


def steps_of(sim, steps):
    """Displacements [steps, n, 3] of single steps"""
    out = []
    for k in range(steps):
        x = sim.x
        sim.run(1, "pre no post no" if k else "post no")
        out.append(sim.x - x)
    return np.array(out)


def copies(shape, count, spacing=12.0):
    """So many of a shape, each a molecule of its own, on a lattice"""
    k, side = np.arange(count), int(np.ceil(count**(1 / 3)))
    origin = spacing * np.column_stack([k % side, k // side % side, k // side**2])
    return Spheres((origin[:, None, :] + shape).reshape(-1, 3), A, molecule=np.repeat(k + 1, len(shape)))


def check_covariance(d, expected, dt, sigmas=4.5):
    """Samples d [n, k] of displacements against 2 kT dt times expected"""
    C = d.T @ d / len(d) / (2 * KT * dt)
    sigma = np.sqrt((np.outer(np.diag(expected), np.diag(expected)) + expected**2) / len(d))
    assert np.abs((C - expected) / sigma).max() < sigmas


# --- one step -------------------------------------------------------------------------------------------------------------

TRIO = A * np.array([(0, 0, 0), (2.5, 0, 0), (0.4, 2.3, 0.6)])


@pytest.mark.parametrize("rotation", ["no", "yes"])
def test_covariance_of_a_step_is_the_mobility(simulation, rotation):
    sim = noise(simulation(copies(TRIO, 2000), f"cut_off_distance inf visc {ETA} clumps_only yes rotation {rotation}", fix=False, dt=SHORT))
    d = steps_of(sim, 10).reshape(-1, 9)
    M = model.mobility(TRIO, np.full(3, A), ETA)
    assert M[0] * UNIT == pytest.approx([1, 0, 0, 0.536, 0, 0, 0.352475, 0.032310, 0.008429], abs=1e-6)
    check_covariance(d, M, SHORT)


def test_lone_spheres_move_as_einstein_says_and_normally(simulation):
    sim = noise(simulation(Spheres(copies(np.zeros((1, 3)), 4000).x, A), f"cut_off_distance inf visc {ETA} clumps_only yes", fix=False,
                           dt=SHORT))
    d = steps_of(sim, 8).ravel() / np.sqrt(2 * KT * SHORT / UNIT)
    n = len(d)
    assert d.mean() == pytest.approx(0, abs=4 / np.sqrt(n))
    assert (d**2).mean() == pytest.approx(1, abs=4 * np.sqrt(2 / n))
    assert (d**4).mean() == pytest.approx(3, abs=4 * np.sqrt(96 / n))


def test_open_cloud_has_the_covariance_of_all_pairs(simulation):
    """Four near spheres that all see each other: every draw is one sample."""
    x = A * np.array([(0, 0, 0), (2.2, 0, 0), (1.0, 1.9, 0), (0.8, 0.5, 1.7)])
    sim = noise(simulation(Spheres(x, A), f"cut_off_distance inf visc {ETA}", fix=False, dt=SHORT))
    check_covariance(steps_of(sim, 2000).reshape(-1, 12), model.mobility(x, np.full(4, A), ETA), SHORT)


# N, phi: 1 - 1.7600873 (phi/N)^(1/3) + phi/N for each sphere, wherever they stand (one point per sphere, equal radii)
@pytest.mark.parametrize("m, phi, own", [(2, 0.1, 0.604020), (3, 0.2, 0.664306), (5, 0.2, 0.795739)])
def test_self_diffusion_in_a_periodic_cube(simulation, m, phi, own):
    side = m * A * (4 / 3 * np.pi / phi)**(1 / 3)
    g = (np.arange(m) + 0.5) * side / m
    x = np.array([(p, q, r) for p in g for q in g for r in g]) + np.random.default_rng(m).uniform(-0.2, 0.2, (m**3, 3)) * A
    steps = max(60, 4000 // m**3)
    sim = noise(simulation(Spheres(x, A), f"cut_off_distance inf visc {ETA} far_field_tolerance 1e-4", fix=False, dt=SHORT, boundary="p p p",
                           box=[(0.0, side)] * 3))
    d = steps_of(sim, steps)
    assert d.std()**2 / (2 * KT * SHORT / UNIT) == pytest.approx(own, rel=4 * np.sqrt(2 / d.size) + 2e-3)


def test_periodic_noise_has_the_covariance_of_the_products(simulation):
    """The mobility by unit forces in the same box, and the drawn steps"""
    x = A * np.array([(0.5, 0.5, 0.5), (2.3, 1.0, 0.4), (1.1, 2.4, 3.0)])
    side = 6 * A
    style = f"cut_off_distance inf visc {ETA} far_field_tolerance 1e-5"
    M = np.zeros((9, 9))
    for k in range(9):
        sim = simulation(Spheres(x, A), style, fix=False, dt=SHORT, boundary="p p p", box=[(0.0, side)] * 3)
        force = ["0", "0", "0"]
        force[k % 3] = "v_one"
        sim.commands(f"variable one atom id=={k // 3 + 1}\nfix push all addforce {' '.join(force)}\n"
                     "fix move all stokes_dynamics/overdamped").run(0)
        M[:, k] = sim.v.ravel()
    sim = noise(simulation(Spheres(x, A), style, fix=False, dt=SHORT, boundary="p p p", box=[(0.0, side)] * 3))
    check_covariance(steps_of(sim, 1500).reshape(-1, 9), M, SHORT)


# --- rigid clumps ---------------------------------------------------------------------------------------------------------

CLUMPS = f"cut_off_distance inf visc {ETA} clumps_only yes rigid_clumps yes rotation yes"
L_OF_FOUR = A * np.array([(0, 0, 0), (2, 0, 0), (4, 0, 0), (0, 2, 0)])
ROD = A * np.array([(0, 0, 2.0 * k) for k in range(5)])


def rigid_motion(d, shape):
    """[samples, 6] displacement of the centroid and turn of samples d [samples, spheres, 3] of small displacements"""
    r = shape - shape.mean(axis=0)
    K = np.zeros((3 * len(r), 6))
    for k, (x, y, z) in enumerate(r):
        K[3 * k:3 * k + 3, :3] = np.eye(3)
        K[3 * k:3 * k + 3, 3:] = [(0, z, -y), (-z, 0, x), (y, -x, 0)]
    return np.linalg.lstsq(K, d.reshape(len(d), -1).T, rcond=None)[0].T


def test_clump_without_symmetry_moves_with_its_six_by_six(simulation):
    sim = noise(simulation(copies(L_OF_FOUR, 2500), CLUMPS, fix=False, dt=SHORT))
    V = rigid_motion(steps_of(sim, 8).reshape(-1, 4, 3), L_OF_FOUR)
    V[:, 3:] *= A
    C = V.T @ V / len(V) / (2 * KT * SHORT) * UNIT
    known = {(0, 0): 0.561894, (1, 1): 0.517759, (2, 2): 0.473551, (0, 1): -0.019734, (0, 5): 0.008365, (1, 5): -0.012600,
             (2, 3): -0.010115, (2, 4): 0.007082}
    for (p, q), value in known.items():
        sigma = np.sqrt((C[p, p] * C[q, q] + value**2) / len(V))
        assert C[p, q] == pytest.approx(value, abs=4.5 * sigma), (p, q)


def test_rod_turns_as_its_diffusivity_says(simulation):
    """<u(0).u(t)> = exp(-2 D_r t) at D_r t = 1/4, of 2000 rods, within four deviations"""
    Dr = 0.033267 * KT / (8 * np.pi * ETA * A**3)
    steps = 25
    sim = noise(simulation(copies(ROD, 2000, 30.0), CLUMPS, fix=False, dt=0.25 / Dr / steps))
    def axes():
        x = sim.x.reshape(-1, 5, 3)
        u = x[:, 4] - x[:, 0]
        return u / np.linalg.norm(u, axis=1)[:, None]
    before = axes()
    sim.run(steps)
    assert np.abs(np.linalg.norm(np.diff(sim.x.reshape(-1, 5, 3), axis=1), axis=2) / (2 * A) - 1).max() < 1e-12
    assert (axes() * before).sum(axis=1).mean() == pytest.approx(np.exp(-0.5), abs=4 * 0.34 / np.sqrt(2000))


def home(count, centre, spacing=12.0):
    """Variables hx hy hz: how far an atom is from where the centroid of its clump of four was when copies() put it there"""
    side = int(np.ceil(count**(1 / 3)))
    return [f"variable hx atom x-({centre[0]!r})-{spacing}*((mol-1)%{side})",
            f"variable hy atom y-({centre[1]!r})-{spacing}*(floor((mol-1)/{side})%{side})",
            f"variable hz atom z-({centre[2]!r})-{spacing}*floor((mol-1)/{side * side})"]


def test_boltzmann_of_a_clump_in_a_field_and_a_trap(simulation):
    """Spheres pulled to one place are a trap on the centroid, <c^2> = 3 kT/k; a couple on the long arm a field, energy -2 kT cos:
    <cos> = coth 2 - 1/2. A clump that its noise moved about another point would drift against both."""
    count, k, E = 1000, 0.5 * KT / A**2, 2 * KT / (4 * A)
    sim = simulation(copies(L_OF_FOUR, count), CLUMPS, fix=False, dt=0.2 * UNIT * A**2 / KT)
    sim.commands(home(count, L_OF_FOUR.mean(axis=0)))
    sim.commands([f"variable f{d} atom -{k / 4!r}*v_h{d}" for d in "xyz"])
    sim.commands(f"variable couple atom {E!r}*((id-1)%4==2)-{E!r}*((id-1)%4==0)\n"
                 "fix trap all addforce v_fx v_fy v_fz\nfix field all addforce 0 0 v_couple")
    noise(sim).run(200)
    squares, cosines = [], []
    x0 = copies(L_OF_FOUR, count).x.reshape(-1, 4, 3).mean(axis=1)
    for _ in range(5):
        sim.run(30)
        x = sim.x.reshape(-1, 4, 3)
        squares.append(((x.mean(axis=1) - x0)**2).sum(axis=1))
        cosines.append((x[:, 2] - x[:, 0])[:, 2] / (4 * A))
    n = 3.0 * count    # samples 30 steps apart are not quite independent
    cosines = np.array(cosines)
    assert cosines.mean() == pytest.approx(0.53731, abs=4 * 0.417 / np.sqrt(n))
    assert (cosines**2).mean() == pytest.approx(0.46269, abs=4 * 0.31 / np.sqrt(n))
    assert np.mean(squares) * k / (3 * KT) == pytest.approx(1, abs=4 * np.sqrt(2 / (3 * n)) + 0.01)


# --- equilibrium of free spheres ------------------------------------------------------------------------------------------

@pytest.mark.parametrize("scheme, expected", [("ab2", 1.0227), ("euler", 1.1111)])
def test_variance_in_a_trap_is_that_of_the_scheme(simulation, scheme, expected):
    """h = dt k/(6 pi eta a) = 0.2: (1 - h/2)/(1 - h/2 - h^2/2) and 1/(1 - h/2)"""
    k, h = 3.0, 0.2
    x = copies(np.zeros((1, 3)), 3000).x
    side = int(np.ceil(3000**(1 / 3)))
    sim = simulation(Spheres(x, A), f"cut_off_distance inf visc {ETA} clumps_only yes", fix=False, dt=h * UNIT / k)
    index = {"x": f"((id-1)%{side})", "y": f"(floor((id-1)/{side})%{side})", "z": f"floor((id-1)/{side * side})"}
    sim.commands([f"variable f{d} atom -{k!r}*({d}-12.0*{index[d]})" for d in "xyz"] + ["fix trap all addforce v_fx v_fy v_fz"])
    noise(sim, f"scheme {scheme}").run(40)
    samples = []
    for _ in range(15):
        sim.run(12)
        samples.append(((sim.x - x)**2).mean())
    assert np.mean(samples) * k / KT == pytest.approx(expected, abs=4 * np.sqrt(2 / (3000 * 3 * 15 * 0.8)) * expected)


def test_bond_has_boltzmanns_length(simulation):
    """k = 100, r0 = 2.2 in units of kT and a, h = 0.1 for the relative motion: <r> - r0 = 0.009072, variance 9.959e-3 (+0.5 %)."""
    count, k = 1200, 100 * KT / A**2
    spheres = copies(A * np.array([(0, 0, 0), (2.2, 0, 0)]), count).chain_bonds()
    rate = k / UNIT * 2 * (1 - 1.5 / 2.2 + 1 / 2.2**3)    # of r, by the mobility along the line
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} clumps_only yes", fix=False, dt=0.1 / rate)
    sim.commands(["bond_style harmonic", f"bond_coeff 1 {k / 2!r} {2.2 * A!r}"])
    noise(sim).run(60)
    lengths = []
    for _ in range(6):
        sim.run(30)
        x = sim.x.reshape(-1, 2, 3)
        lengths.append(np.linalg.norm(x[:, 1] - x[:, 0], axis=1) / A)
    r, n = np.array(lengths), 6 * count * 0.9
    assert r.mean() - 2.2 == pytest.approx(0.009072, abs=4 * 0.0998 / np.sqrt(n))
    assert r.var() == pytest.approx(9.959e-3 * 1.005, rel=4 * np.sqrt(2 / n) + 0.005)


# --- one run, in whatever pieces and on however many ranks ------------------------------------------------------------------

def scattered(n=40, side=18.0, seed=4):
    """Spheres of several sizes that do not overlap by more than a tenth, and at last three clumps of four"""
    rng, x, a = np.random.default_rng(seed), [], []
    while len(x) < n:
        p, r = rng.uniform(0, side, 3), rng.uniform(0.6, 1.0)
        if all(np.linalg.norm((p - q + side / 2) % side - side / 2) > 0.9 * (r + b) for q, b in zip(x, a)):
            x.append(p)
            a.append(r)
    return Spheres(x, a)


def in_clumps():
    spheres = copies(L_OF_FOUR, 9, 6.0)
    spheres.x += 3.0
    spheres.molecule[32:] = 0
    return spheres


WAYS = {"open": ("f f f", scattered, "cut_off_distance inf visc 1.1 rotation yes"),
        "periodic": ("p p p", scattered, "cut_off_distance inf visc 1.1 far_field_tolerance 1e-6"),
        "clumps": ("p p p", in_clumps, "cut_off_distance inf visc 1.1 clumps_only yes rigid_clumps yes rotation yes"),
        "flexible": ("p p p", in_clumps, "cut_off_distance inf visc 1.1 clumps_only yes")}
MOVE = "fix move all stokes_dynamics/overdamped temperature {} {}"


def script(folder, way, runs, newton="on", T="v_T", seed=7):
    boundary, make, words = WAYS[way]
    lines = input_lines(make(), words, os.path.join(str(folder), "spheres.data"), fix=False, boundary=boundary, newton=newton, dt=0.02,
                        box=[(0.0, 18.0)] * 3 if boundary[0] == "p" else [(-60.0, 60.0)] * 3)
    return lines + ["variable T equal 1.5+step/100", "variable fx atom 0.3*sin(id)", "fix pull all addforce v_fx 0 -2",
                    MOVE.format(T, seed) if T is not None else MOVE.split(" temp")[0]] + runs


def end(folder, lines, ranks=1):
    lmp(folder, lines, ranks)
    return read_dump(os.path.join(str(folder), "end.dump"))[-1][1]


END = dump_lines("end.dump", every=20, columns="xu yu zu vx vy vz")


@pytest.mark.parametrize("way", WAYS)
def test_ranks_and_newton_do_not_matter(tmp_path, way):
    one = end(tmp_path, script(tmp_path, way, END + ["run 20"]))
    for ranks, newton in ((2, "on"), (4, "off")):
        assert np.abs(end(tmp_path, script(tmp_path, way, END + ["run 20"], newton), ranks) - one).max() < 1e-10
    other = end(tmp_path, script(tmp_path, way, END + ["run 20"], seed=8))
    still = end(tmp_path, script(tmp_path, way, END + ["run 20"], T="0"))
    assert np.abs(other - one)[:, :3].max() > 0.1 and np.abs(still - one)[:, :3].max() > 0.1


@pytest.mark.parametrize("way", WAYS)
def test_a_run_in_pieces_is_the_run_in_one(tmp_path, way):
    whole = end(tmp_path, script(tmp_path, way, END + ["run 20"]))
    assert np.abs(end(tmp_path, script(tmp_path, way, END + ["run 7", "run 13"])) - whole).max() < 1e-10
    lmp(tmp_path, script(tmp_path, way, ["run 7", "write_restart half.restart"]))
    again = script(tmp_path, way, END + ["run 13"])
    cut = [i for i, line in enumerate(again) if line.startswith("read_data")][0]
    again = [line for line in again[:cut] if "boundary" not in line] + ["read_restart half.restart"] + again[cut + 1:]
    assert np.abs(end(tmp_path, again) - whole).max() < 1e-10


@pytest.mark.parametrize("way", WAYS)
def test_temperature_0_is_the_run_without(tmp_path, way):
    """Bit for bit"""
    without = end(tmp_path, script(tmp_path, way, END + ["run 20"], T=None))
    assert (end(tmp_path, script(tmp_path, way, END + ["run 20"], T="0")) == without).all()


def test_numbers_of_the_root_are_told(simulation):
    spheres = scattered(100, 14.0)
    sim = simulation(spheres, "cut_off_distance inf visc 1.1", fix=False, dt=1e-6)
    noise(sim, "noise_tolerance 0.01").run(0)
    products, error = (sim.lmp.extract_fix("move", 0, 1, nrow=k) for k in (9, 10))
    assert 5 <= products <= 20 and error < 0.01 / 3
    sim.commands("unfix move")
    noise(sim, "noise_tolerance 1e-4").run(0)
    assert products < sim.lmp.extract_fix("move", 0, 1, nrow=9)
    assert sim.lmp.extract_fix("move", 0, 1, nrow=10) < 1e-4 / 3


# --- what is refused --------------------------------------------------------------------------------------------------------

INF = f"cut_off_distance inf visc {ETA}"


@pytest.mark.parametrize("words, message", [("temperature -1 5", "'-1' must be >= 0"), ("temperature 1 0", "keyword temperature: '0' must"),
                                            ("temperature 1 5 noise_tolerance 0.5", "'0.5' must be below 0.5"),
                                            ("temperature 1 5 noise_tolerance 0", "noise_tolerance: '0' must be > 0"),
                                            ("temperature v_none 5", "variable 'none' does not exist"),
                                            ("temperature v_atoms 5", "noise has one temperature"),
                                            ("temperature v_minus 5", "'-2' must be >= 0, in step 0"),
                                            ("temperature 1 5 adapt 1 1e-3 1 1", "leave adapt out"),
                                            ("temperature 1 5 held some", "keyword held: the mobility has a drift"),
                                            ("noise_tolerance 0.1", "keyword noise_tolerance requires a temperature")])
def test_words_that_mean_nothing_are_errors(simulation, words, message):
    sim = simulation(Spheres(TRIO, A), INF, fix=False, dt=1e-3)
    sim.commands("variable atoms atom id\nvariable minus equal -2\ngroup some id 1")
    with pytest.raises(LammpsError, match=re.escape(message)):
        sim.commands(f"fix move all stokes_dynamics/overdamped {words}").run(0)


FIELD = "variable eta atom 1+0.1*x"


@pytest.mark.parametrize("style, lines, message", [
    (f"{INF} rotation yes lubrication yes", "", "keyword lubrication of pair_style stokes_dynamics: the mobility has a drift"),
    (f"{INF} multiblob 12", "", "keyword multiblob of pair_style stokes_dynamics: the mobility has a drift"),
    (f"{INF} rigid_clumps yes rotation yes", "", "use clumps_only yes"),
    (f"{INF} tensor oseen", "", "use tensor rpy"),
    (f"cut_off_distance 4 visc {ETA}", "", "keyword cut_off_distance: '4' of pair_style stokes_dynamics: the mobility has a drift"),
    (f"cut_off_distance 4 taper wendland visc {ETA}", "", "keyword taper of pair_style stokes_dynamics: the mobility has a drift"),
    ("cut_off_distance inf visc v_eta", "", "keyword visc of pair_style stokes_dynamics, which varies in space"),
    (INF, "fix step all dt/reset 10 NULL 0.1 0.1", "of style dt/reset makes steps of unequal length"),
    (INF, "fix bath none langevin 1 1 1 77", "of style langevin has noise or a drag of its own"),
    (INF, "fix bath none viscous 1", "of style viscous has noise or a drag of its own")])
def test_drifts_and_other_noise_are_errors(simulation, style, lines, message):
    sim = simulation(Spheres(TRIO, A, molecule=[1, 1, 2]), style, fix=False, dt=1e-3, before_pair=FIELD)
    sim.commands(f"group none id 99\n{lines}")
    with pytest.raises(LammpsError, match=re.escape(message)):
        noise(sim).run(0)


def test_friction_is_an_error(simulation):
    style = [f"pair_style hybrid/overlay gran/hooke/history 10 NULL 0 NULL 0.5 0 stokes_dynamics {INF}",
             "pair_coeff * * gran/hooke/history", "pair_coeff * * stokes_dynamics"]
    sim = simulation(Spheres(TRIO, A), style, fix=False, dt=1e-3, comm="comm_modify vel yes")
    with pytest.raises(LammpsError, match=re.escape("pair_style gran/hooke/history has friction (0.5)")):
        noise(sim).run(0)


def test_steps_that_are_too_long_are_warned_of(tmp_path):
    lines = input_lines(Spheres(TRIO, A), INF, os.path.join(str(tmp_path), "spheres.data"), fix=False, dt=3.0, box=[(-90.0, 90.0)] * 3)
    text = lmp(tmp_path, lines + [MOVE.format(1.0, 3), "run 1"]).text
    assert "of its radius: use a shorter time step" in text and "of half the skin, so that lists" in text
    quiet = [line.replace("timestep 3.0", "timestep 1e-4") for line in lines]
    text = lmp(tmp_path, quiet + [MOVE.format(1.0, 3), "run 1"]).text
    assert "of its radius: use" not in text and "Brownian motion, kT = 1, seed 3" in text
