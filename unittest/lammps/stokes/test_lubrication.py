"""lubrication yes: pairs against exact resistances, clusters against exact velocities, any ranks, runs in pieces."""
import re

import numpy as np
import pytest

from host import allowed
from system import LammpsError, Spheres, dump_lines, from_restart, input_lines, lmp, read_dump

P6 = 6 * np.pi
FIX = "fix move all stokes_dynamics/overdamped"
ALL = "cut_off_distance inf visc 1.3 rotation yes lubrication yes"


def squeezed(simulation, xi, words=""):
    """Speed at which two unit spheres approach each other under equal and opposite forces 6 pi eta, and the fix's
    vector"""
    spheres = Spheres([(0, 0, 0), (0.6 * (2 + xi), 0, 0.8 * (2 + xi))])
    sim = simulation(spheres, f"{ALL} relative_tolerance 1e-9 {words}", fix=False)
    push = 1.3 * P6 * np.array((0.6, 0, 0.8))
    for i, sign in ((1, 1), (2, -1)):
        sim.commands(f"group g{i} id {i}\nfix push{i} g{i} addforce " + " ".join(repr(float(c)) for c in sign * push))
    sim.commands(FIX).run(0)
    return (sim.v[0] - sim.v[1]) @ (0.6, 0, 0.8)


@pytest.mark.parametrize("xi", [1e-3, 1e-2, 0.1])
def test_approach_of_two_spheres_is_that_of_the_film_between_them(simulation, xi):
    """Jeffrey & Onishi 1984: XA11 - XA12 = 1/(2 xi) + 9/20 ln(1/xi) + 1.34558 + 3/56 xi ln(1/xi) + O(xi), times 6 pi
    eta a."""
    resistance = 1 / (2 * xi) + 0.45 * np.log(1 / xi) + 1.34558 + 3 / 56 * xi * np.log(1 / xi)
    assert squeezed(simulation, xi) == pytest.approx(2 / resistance, rel=1e-4 + 0.2 * xi * xi + 0.3 * xi / resistance)


def test_no_film_is_thinner_than_the_floor(simulation):
    floor = squeezed(simulation, 0.01, "lubrication_gap 0.01")
    below = squeezed(simulation, 0.001, "lubrication_gap 0.01")
    assert below == pytest.approx(floor, rel=0.02) and below != squeezed(simulation, 0.001)


def test_film_ends_at_the_range(simulation):
    without = squeezed(simulation, 0.51, "lubrication_range 0.5")
    assert without != pytest.approx(squeezed(simulation, 0.51), rel=0.01)
    assert without == pytest.approx(2 * (1 - 1.5 / 2.51 + 1 / 2.51**3), rel=1e-8)


# --- images, ranks, forces for given velocities -----------------------------------------------------------------------

L = 11.0
CLOSE = "far_field_tolerance 1e-12 relative_tolerance 1e-11 max_iter 500"
PERIODIC = dict(fix=False, boundary="p p p",
                comm="comm_modify cutoff 6 vel yes\nneigh_modify exclude molecule/intra all")
LOADS = ["variable fx atom 3*sin(id)", "variable fz atom -5-0.1*id", "fix pull all addforce v_fx 0.3 v_fz", FIX]


def dense(n=40, doublets=6, seed=4):
    """Free spheres and doublets at random in the periodic cube, at volume fraction 0.13, pushed apart to gaps of 1e-4
    and more"""
    rng = np.random.default_rng(seed)
    molecule = np.append(np.repeat(np.arange(1, doublets + 1), 2), np.zeros(n - 2 * doublets, int))
    x = rng.uniform(0, L, (n, 3))
    for _ in range(2000):
        for k in range(doublets):    # doublets stay 2 apart
            d = x[2 * k + 1] - x[2 * k]
            d -= L * np.round(d / L)
            middle = x[2 * k] + 0.5 * d
            x[2 * k], x[2 * k + 1] = middle - d / np.linalg.norm(d), middle + d / np.linalg.norm(d)
        d = x[:, None] - x
        d -= L * np.round(d / L)
        r = np.linalg.norm(d, axis=-1) + 9 * np.eye(n) + 9 * ((molecule[:, None] == molecule) & (molecule > 0))
        overlap = np.maximum(2.0002 - r, 0)
        if overlap.max() < 1e-4:
            break
        x += 0.3 * ((overlap + 2e-4 * (overlap > 0)) / r)[..., None].__mul__(d).sum(axis=1)
    assert overlap.max() < 1e-4
    return Spheres(np.mod(x, L), molecule=molecule)


def test_periodic_border_is_none(simulation):
    """Velocities are the same wherever the border cuts: films go through it."""
    answers = []
    for shift in (0.0, 0.37 * L):
        spheres = dense()
        spheres.x = np.mod(spheres.x + shift, L)
        sim = simulation(spheres, f"{ALL} {CLOSE}", box=[(0.0, L)] * 3, **PERIODIC)
        sim.commands(LOADS).run(0)
        answers.append(np.hstack([sim.v, sim.atom("omega")]))
    assert np.abs(answers[0] - answers[1]).max() < 1e-9 * np.abs(answers[0]).max()
    alone = simulation(spheres, f"{ALL.replace('lubrication yes', '')} {CLOSE}", box=[(0.0, L)] * 3, **PERIODIC)
    alone.commands(LOADS).run(0)
    assert np.abs(alone.v - answers[0][:, :3]).max() > 0.1 * np.abs(answers[0]).max()


@pytest.mark.parametrize("words", ["", "rigid_clumps yes shell 12"])
def test_periodic_box_on_any_ranks(tmp_path, words):
    frames = []
    for ranks, newton in allowed((1, "on"), (2, "on"), (4, "off")):
        lines = input_lines(dense(), f"{ALL} {CLOSE} {words}", tmp_path / "data", box=[(0.0, L)] * 3, dt=1e-3,
                            newton=newton, **PERIODIC)
        columns = "x y z vx vy vz omegax omegay omegaz f_move[4] f_move[5] f_move[6]"
        lmp(tmp_path, lines + LOADS + dump_lines("out.dump", every=5, columns=columns, name="out") + ["run 5"], ranks)
        frames.append(read_dump(tmp_path / "out.dump")[-1][1])
    scale = np.abs(frames[0]).max(axis=0)
    for frame in frames[1:]:
        d = frame - frames[0]
        d[:, :3] -= L * np.round(d[:, :3] / L)
        assert (np.abs(d).max(axis=0) < 1e-10 * np.maximum(scale, 1)).all()


@pytest.mark.parametrize("words, ranks", [("", 2), ("rigid_clumps yes shell 12", 1)])
def test_periodic_run_in_pieces_is_the_run_in_one(tmp_path, words, ranks):
    """Films and images after a restart are those of before it, and so is what the solver begins from."""
    style = f"{ALL} {CLOSE} {words}"
    lines = input_lines(dense(), style, tmp_path / "data", box=[(0.0, L)] * 3, dt=1e-3, **PERIODIC) + LOADS
    columns = "x y z vx vy vz omegax omegay omegaz f_move[4] f_move[5] f_move[6]"
    end = dump_lines("end.dump", every=10, columns=columns, name="end")
    lmp(tmp_path, lines + end + ["run 10"], ranks)
    whole = read_dump(tmp_path / "end.dump")[-1][1]
    lmp(tmp_path, lines + ["run 4", "write_restart half.restart"], ranks)
    again = from_restart(lines)
    lmp(tmp_path, again + end + ["run 6"], ranks)
    d = read_dump(tmp_path / "end.dump")[-1][1] - whole
    d[:, :3] -= L * np.round(d[:, :3] / L)
    assert (np.abs(d).max(axis=0) < 1e-10 * np.maximum(np.abs(whole).max(axis=0), 1)).all()


@pytest.mark.parametrize("boundary, words", [("f f f", "fluid_velocity v_u 0.2 0"),
                                             ("p p p", "fluid_velocity 0.1 0.2 0"),
                                             ("f f f", "fluid_velocity v_u 0.2 0 rigid_clumps yes shell 12"),
                                             ("p p p", "rigid_clumps yes")])
def test_forces_for_given_velocities_are_the_inverse(simulation, boundary, words):
    """What moves spheres and clumps so without inertia is what the pair style finds for that motion."""
    spheres = dense()
    words = f"{ALL} {words} relative_tolerance 1e-11 max_iter 500" + (" far_field_tolerance 1e-12" if boundary[0] == "p"
                                                                      else "")
    sim = simulation(spheres, words, box=[(0.0, L) if boundary[0] == "p" else (-20.0, 30.0)] * 3,
                     before_pair="variable u atom 0.3*z+0.1*x", **dict(PERIODIC, boundary=boundary))
    sim.commands(LOADS).run(0)
    load, before = sim.f, sim.fix_rows("move")[:, 3:9]
    power = sim.fix_scalar("move")
    sim.commands(f"unfix move\nfix drag all stokes_dynamics\npair_style stokes_dynamics {words} algorithm 2\n"
                 "pair_coeff * *").run(0)
    rows = sim.fix_rows()
    forces = np.hstack([rows[:, :3], rows[:, 6:9]])
    assert np.abs(forces - before).max() < 1e-6 * np.abs(load).max()
    assert sim.fix_scalar() == pytest.approx(power, rel=1e-6) and power > 0
    free = (spheres.molecule == 0) if "rigid" in words else slice(None)
    assert np.abs(before[free, :3] + load[free]).max() < 1e-9 * np.abs(load).max()


def test_spheres_far_apart_are_as_without(simulation):
    far = Spheres([(0, 0, 0), (5, 0, 1), (0, 7, 0)])
    answers = []
    for words in (ALL, ALL.replace("lubrication yes", "")):
        sim = simulation(far, words, fix=False).commands(LOADS)
        sim.run(0)
        assert sim.fix_vector("move")[3] == 1
        answers.append(np.hstack([sim.v, sim.atom("omega")]))
    assert np.abs(answers[0] - answers[1]).max() < 1e-15


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_doublet_along_an_axis_is_solved_to_rounding(simulation, axis):
    """By symmetry the loop meets the answer itself, where what is left of the power is rounding, of any sign."""
    for place in np.random.default_rng(3).uniform(5, 15, (10, 3)):
        x = np.array([place, place])
        x[1, axis] += 2.02
        answers = []
        for words in (ALL, ALL.replace("lubrication yes", "")):
            words += " rigid_clumps yes relative_tolerance 1e-10 far_field_tolerance 1e-11"
            sim = simulation(Spheres(x, molecule=1), words, box=[(0.0, 20.0), (0.0, 21.0), (0.0, 22.0)], **PERIODIC)
            sim.commands("fix weight all addforce 0.1 0.2 -1").commands(FIX).run(0)
            answers.append(sim.v)
        assert np.abs(answers[0] - answers[1]).max() < 1e-9 * np.abs(answers[1]).max()


def test_a_push_from_far_away_carries_a_close_pair_along(simulation):
    """It moves in the flow of a point force as one, which films do not see, nor the power of what its forces lack."""
    x = np.array([(0, 0, 0), (-0.0264908952, -0.834536161, 1.70792138), (3000, 0, 1500)])
    style = "cut_off_distance inf visc 1.3 multiblob 12 lubrication yes relative_tolerance 1e-10"
    sim = simulation(Spheres(x, [1.3, 0.4, 0.4]), style, fix=False, box=[(-10.0, 3010.0)] * 3)
    sim.commands(["group pushed id 3", FIX])
    h = x[2] / np.linalg.norm(x[2])
    for push in np.eye(3):
        sim.command("fix push pushed addforce " + " ".join(map(str, push)))
        sim.run(0).command("unfix push")
        u = (push + push @ h * h) / (8 * np.pi * 1.3 * np.linalg.norm(x[2]))
        assert np.abs(sim.v[:2] - u).max() < 2e-3 * np.abs(u).max()


def test_radii_that_are_too_different_are_named(simulation):
    spheres = Spheres([(0, 0, 0), (90, 0, 0)], [0.5, 80.0])
    with pytest.raises(LammpsError,
                       match="keyword lubrication: radii from 0.5 to 80: lubrication is for ratios of radii up to 100"):
        simulation(spheres, ALL, fix=False).commands(LOADS).run(0)


def test_contact_comes_to_rest_and_opens(simulation):
    """Two spheres pressed onto each other by 1 with a spring of 50, lubricated: they rest 1/50 into each other; pulled
    apart, they open slowly, with forces that balance all the time."""
    style = [f"pair_style hybrid/overlay gran/hooke/history 50 NULL 0 NULL 0 0 stokes_dynamics {ALL}",
             "pair_coeff * * gran/hooke/history",
             "pair_coeff * * stokes_dynamics"]
    sim = simulation(Spheres([(0, 0, 0), (2.05, 0, 0)]), style, fix=False, dt=0.05, comm="comm_modify vel yes",
                     box=[(-60.0, 60.0)] * 3)
    sim.commands(
        "group left id 1\ngroup right id 2\nfix push left addforce 1 0 0\nfix back right addforce -1 0 0").commands(FIX)
    sim.run(20000)
    assert sim.x[1, 0] - sim.x[0, 0] == pytest.approx(2 - 1 / 50, rel=1e-5)
    sim.commands("unfix push\nunfix back\nfix push left addforce -1 0 0\nfix back right addforce 1 0 0")
    gaps, speeds = [], []
    for _ in range(40):
        sim.run(200)
        gaps.append(sim.x[1, 0] - sim.x[0, 0] - 2)
        speeds.append(sim.v[1, 0] - sim.v[0, 0])
    assert (np.diff(gaps) > 0).all() and (np.diff(speeds)[np.array(gaps[1:]) > 1e-3] >
                                          0).all() and gaps[-1] > 1e-3 > 0 > gaps[0]


@pytest.mark.parametrize("part, stable", [(0.9, True), (1.1, False)])
def test_films_limit_explicit_steps_as_is_told(simulation, tmp_path, part, stable):
    """Two free spheres with inertia that approach each other: below the limit of the log they slow down, above it they
    shake, with a warning."""
    xi, mass = 0.01, 4 / 3 * np.pi * 1.7
    limit = 2 / (2 * 1.3 * P6 * (1 / (4 * xi) - 0.75 + 0.225 * np.log(1 / xi) + 0.995 - 0.35) / mass)
    log = tmp_path / "log"
    sim = simulation(Spheres([(0, 0, 0), (2 + xi, 0, 0)], 1.0, [(1e-9, 0, 0), (-1e-9, 0, 0)]),
                     f"{ALL} add_force yes algorithm 2", fix=False, dt=part * limit, log=log)
    sim.commands("fix move all nve/sphere").run(60)
    text = open(log).read()
    told = float(re.search(r"explicit time steps of free spheres are stable up to ([^ ;]+)", text).group(1))
    assert told == pytest.approx(limit, rel=0.03)
    assert ("is above" in text and "use fix stokes_dynamics/overdamped" in text) == (part * limit > told)
    assert (np.abs(sim.v).max() < 1e-9) == stable


@pytest.mark.parametrize("e", [0.01, -0.01, 0.03])
def test_films_in_shear_dissipate(simulation, e):
    """A film resists what a strain does to its pair, so that power is lost also where no sphere slips, and where
    spheres move a little with the force on them: never less than nothing, here a parabola in the slip."""
    lost = []
    for k in (0.0, e, 2 * e):
        sim = simulation(Spheres([(0, 0, 0), (1.21166208, 0, 1.61554944)]),
                         "cut_off_distance inf visc 0.05305 fluid_velocity v_ux 0 0 rotation yes "
                         "lubrication yes algorithm 2 relative_tolerance 1e-10 add_force yes", box=[(-20.0, 20.0)] * 3,
                         comm="comm_modify cutoff 12 vel yes", before_pair="variable ux atom 0.2*z\n"
                         f"variable vx atom 0.2*z+{k}*0.6*(3-2*id)\nvariable vz atom {k}*0.8*(3-2*id)\n"
                         "velocity all set v_vx 0 v_vz\nset group all omega 0 0.1 0")
        sim.commands("compute p all pair stokes_dynamics\nthermo_style custom step f_drag c_p[4]").run(0)
        lost.append(sim.fix_scalar())
        assert sim.compute_vector("p", 4)[3] == pytest.approx(lost[-1], rel=1e-12)
    assert lost[0] == pytest.approx(0.4935869, abs=1e-6) and min(lost) > 0
    assert lost[2] - 2 * lost[1] + lost[0] >= 0


def test_free_shells_lose_least_in_a_strain(simulation):
    """Helmholtz: no other motion than the free one loses less. What is lost is the rate of the fix, which may have
    either sign, less that of the first moments; both sides of the free motion are alike."""
    x, gradient = np.array([(0, 0, 0), (1.1, -0.3, 1.8), (-1.7, 0.4, 0.9)]), np.array([1.0, 0.5, -1.5])
    style = "cut_off_distance inf visc 1.3 multiblob 12 lubrication yes relative_tolerance 1e-10 " \
            "fluid_velocity v_ux v_uy v_uz"
    options = dict(box=[(-20.0, 20.0)] * 3, before_pair="\n".join(f"variable u{c} atom {g}*{c}"
                                                                 for c, g in zip("xyz", gradient)))
    spheres = Spheres(x, [1.0, 1.0, 0.9])
    sim = simulation(spheres, style, fix=False, **options).commands(FIX).run(0)
    free, spin, lost = sim.v, sim.atom("omega"), []
    for part in (0.5, 1.0, 1.5):
        sim = simulation(Spheres(x, spheres.a, x * gradient + part * (free - x * gradient)), style, **options)
        for k in range(3):
            sim.set("omega", k + 1, part * spin[k])
        sim.commands(["compute D all stokes_dynamics/stress", "compute d all reduce sum " + " ".join(
            f"c_D[{k}]" for k in (1, 2, 3, 7, 8, 9)), "thermo_style custom step c_d[1]"]).run(0)
        moments = sim.compute_vector("d", 6)
        lost.append(sim.fix_scalar() - (moments[:3] + moments[3:]) @ gradient)
        assert part != 0.5 or sim.fix_scalar() < 0
    assert lost[0] == pytest.approx(lost[2], rel=1e-7) and lost[0] > lost[1] * 1.01 > 0


def test_what_is_lost_in_shear_is_the_same_with_and_without_inertia(simulation):
    """Velocities from forces, and forces from these velocities: one power."""
    rng = np.random.default_rng(6)
    x = np.array([(0, 0, 0), (2.03, 0, 0.1), (0.9, 1.85, 0.2), (4.0, 4.0, 4.0), (3.0, 0.4, 2.1)])
    words = ("cut_off_distance inf visc 1.3 fluid_velocity v_ux v_uy 0 rotation yes lubrication yes "
             "relative_tolerance 1e-11")
    options = dict(fix=False, box=[(-20.0, 20.0)] * 3, dt=1e-3,
                   before_pair="variable ux atom 0.7*z\nvariable uy atom 0.3*y-0.2*x")
    sim = simulation(Spheres(x), words, **options)
    sim.commands("variable f atom 2*sin(9*id)\nfix pull all addforce v_f 0 v_f\n"
                 "fix move all stokes_dynamics/overdamped").run(0)
    power, v, w = sim.fix_scalar("move"), sim.v, sim.atom("omega")
    sim = simulation(Spheres(x, v=v), words + " algorithm 2 add_force yes", **{**options, "fix": True})
    for k in range(len(x)):
        sim.set("omega", k + 1, w[k])
    sim.run(0)
    assert power > 0 and sim.fix_scalar() == pytest.approx(power, rel=1e-7)
    sim.run(0)      # a run that begins where the last one ended
    assert sim.fix_scalar() == pytest.approx(power, rel=1e-7)


@pytest.mark.parametrize("molecule, words, warned", [
    ((3, 3, 3), "multiblob 12", True), ((3, 3, 4), "multiblob 12", False), ((0, 0, 0), "multiblob 12", False),
    ((3, 3, 3), "rigid_clumps yes multiblob 12", False), ((3, 0, 3), "rotation yes", False),
    ((3,), "multiblob 12", False)])
@pytest.mark.parametrize("ranks", [1, 2])
def test_films_of_spheres_that_are_all_one_molecule_are_warned_of(tmp_path, molecule, words, warned, ranks):
    spheres = Spheres([(0, 0, 0), (2.05, 0, 0), (5, 0, 0)][:len(molecule)], molecule=molecule)
    lines = input_lines(spheres, f"cut_off_distance inf visc 1.3 {words} lubrication yes", tmp_path / "data", fix=False)
    log = " ".join(lmp(tmp_path, lines + [FIX, "run 0"], ranks=ranks).log.split())
    assert ("keyword lubrication: all spheres have the molecule ID" in log) == warned
    assert not warned or "the molecule ID 3, and there are no films within a molecule" in log


@pytest.mark.parametrize("n, points, warned", [(6, 1, True), (6, 12, False), (5, 1, False)])
def test_films_of_single_points_in_a_large_cloud_are_warned_of(tmp_path, n, points, warned):
    spheres = Spheres(3.0 * np.array([(i, j, k) for i in range(n) for j in range(n) for k in range(n)]))
    lines = input_lines(spheres, f"cut_off_distance inf visc 1.3 rotation yes lubrication yes multiblob {points} "
                                 "relative_tolerance 0.1",
                        tmp_path / "data", fix=False)
    log = " ".join(lmp(tmp_path, lines + [FIX, "run 0"]).log.split())
    assert (f"with one point per sphere it slows down a cloud of {n ** 3} close spheres" in log) == warned
