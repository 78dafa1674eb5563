"""fix stokes_dynamics/overdamped: paths against converged ones (unittest/data/motion), closed forms, orders, clumps against the dense
solution, one run in pieces and on several ranks."""
import csv
import os

import numpy as np
import pytest

import model
from system import Spheres, dump_lines, input_lines, lmp, read_dump

P6 = 6 * np.pi
FIX = "fix move all stokes_dynamics/overdamped"
ALL = "cut_off_distance inf visc 1"


def weight(spheres, unit=P6):
    """fix addforce of the weight on each sphere"""
    return f"fix weight all addforce 0 0 {-unit!r}"


def table(case, level, t):
    path = os.path.join(model.DATA, "motion", "trajectories.csv")
    rows = csv.DictReader(line for line in open(path) if not line.startswith("#"))
    return [{k: float(v) for k, v in row.items() if k not in ("case", "level") and v} for row in rows
            if row["case"] == case and row["level"] == level and float(row["t"]) == t]


def fall(simulation, spheres, style=ALL, options="", t=40.0, steps=100, lines="", box=400.0, **more):
    sim = simulation(spheres, style, fix=False, box=[(-box, box)] * 3, dt=t / steps, **more)
    sim.commands(lines or weight(spheres)).commands(f"{FIX} {options}").run(steps)
    return sim


def contacts(k, style, friction=0.0):
    """Springs between spheres that overlap, without damping, and the pair style"""
    return [f"pair_style hybrid/overlay gran/hooke/history {k!r} NULL 0 NULL {friction} 0 stokes_dynamics {style}",
            "pair_coeff * * gran/hooke/history", "pair_coeff * * stokes_dynamics"]


# --- free spheres ----------------------------------------------------------------------------------------------------------

THREE = Spheres([(-5, 0, 0), (0, 0, 0), (7, 0, 0)])


@pytest.mark.parametrize("scheme, order", [("ab2", 2), ("euler", 1)])
@pytest.mark.parametrize("level", ["TT", "FT"])
def test_three_spheres_fall_along_the_known_path(simulation, level, scheme, order):
    reference = table("three_horizontal", level, 40.0)
    errors = []
    for steps in (40, 80, 160, 320):
        sim = fall(simulation, THREE, ALL + (" rotation yes" if level == "FT" else ""), f"scheme {scheme}", steps=steps)
        errors.append(np.abs(sim.x - [[row[c] for c in "xyz"] for row in reference]).max())
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    assert slopes[-1] == pytest.approx(order, abs=0.1 if order == 2 else 0.05)
    assert errors[-1] < (1e-4 if order == 2 else 1e-2)
    velocities = [[row["U" + c] for c in "xyz"] for row in reference]
    assert np.abs(sim.v - velocities).max() < 10 * errors[-1]
    if level == "FT":
        assert np.abs(sim.atom("omega") - [[row["W" + c] for c in "xyz"] for row in reference]).max() < 10 * errors[-1]


def test_path_to_eight_digits_with_a_small_step(simulation):
    sim = fall(simulation, THREE, steps=100000)
    reference = [[row[c] for c in "xyz"] for row in table("three_horizontal", "TT", 40.0)]
    assert np.abs(sim.x - reference).max() < 1e-8


@pytest.mark.parametrize("dt", [1e-3, 7.0])
def test_lone_sphere_is_exact(simulation, dt):
    eta, a = 1.3, 0.7
    sim = simulation(Spheres([(1, 2, 3)], a), f"cut_off_distance inf visc {eta} rotation yes", fix=False, box=[(-900, 900.0)] * 3, dt=dt)
    sim.commands(f"fix pull all addforce 0.4 0.1 -0.2\n{FIX}").run(50)
    U = np.array((0.4, 0.1, -0.2)) / (P6 * eta * a)
    assert np.abs(sim.x[0] - (1, 2, 3) - 50 * dt * U).max() < 1e-14 * (3 + 50 * dt) * 3
    assert np.abs(sim.v[0] - U).max() < 1e-15 and (sim.atom("omega") == 0).all()


@pytest.mark.parametrize("n", [3, 5])
def test_polygon_keeps_its_shape_and_speed(simulation, n):
    angle = 2 * np.pi * np.arange(n) / n
    x = 5.0 * np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    sim = fall(simulation, Spheres(x), t=10.0, steps=10)
    R = np.linalg.norm(x[0] - x[1:], axis=1)    # equal loads across the plane: 1 + sum f(R)
    speed = 1 + (0.75 / R * (1 + 2 / (3 * R**2))).sum()
    assert np.abs(sim.v[:, 2] + speed).max() < 1e-12
    assert np.abs(sim.x - x + (0, 0, 10 * speed)).max() < 1e-10


def test_flexible_clumps_see_their_own_spheres_alone(simulation):
    x = np.array([(0, 0, 0), (2.5, 0, 0), (0.4, 2.3, 0.6), (5, 1, 0), (5, 3.2, 0.5)])
    spheres = Spheres(x, molecule=[1, 1, 0, 2, 2])
    sim = simulation(spheres, "visc 1.3 clumps_only yes", fix=False, box=[(-50.0, 50.0)] * 3, dt=0.01)
    sim.commands(f"variable fx atom id\nfix pull all addforce v_fx 0.3 -1\n{FIX}").run(3)
    expected = model.mobility(sim.x, spheres.a, 1.3, sees=model.same_clump(spheres)) @ sim.f.ravel()
    assert np.abs(sim.v.ravel() - expected).max() < 1e-12 * np.abs(expected).max()


def cloud(n=40, seed=3, spread=0.5):
    """Spheres of several sizes, some of which overlap by up to a tenth"""
    rng, x, a = np.random.default_rng(seed), [], []
    while len(x) < n:
        p, r = rng.uniform(-6, 6, 3), rng.uniform(1 - spread, 1 + spread)
        if all(np.linalg.norm(p - q) > 0.9 * (r + b) for q, b in zip(x, a)):
            x.append(p)
            a.append(r)
    return Spheres(x, a)


@pytest.mark.parametrize("rotation", [False, True])
def test_velocities_are_those_of_the_mobility(simulation, rotation):
    eta, spheres = 1.3, cloud()
    words = f"cut_off_distance inf visc {eta} fluid_velocity 0.1 0.2 -0.3 rotation {'yes' if rotation else 'no'}"
    sim = simulation(spheres, contacts(10.0, words, friction=0.5), fix=False, box=[(-50.0, 50.0)] * 3, dt=0.01,
                     comm="comm_modify vel yes")
    sim.commands("variable fx atom sin(x)+id\nvariable fy atom cos(y)\nvariable fz atom -id\n"
                 f"fix pull all addforce v_fx v_fy v_fz\n{FIX}").run(3)
    assert np.abs(sim.atom("torque")).max() > 0.01
    f = sim.f
    load = np.hstack([f, sim.atom("torque")]) if rotation else f
    fluid = np.array((0.1, 0.2, -0.3, 0, 0, 0))[:load.shape[1]]
    expected = (model.mobility(sim.x, spheres.a, eta, rotation=rotation) @ load.ravel()).reshape(load.shape)
    got = np.hstack([sim.v, sim.atom("omega")]) if rotation else sim.v
    assert np.abs(got - fluid - expected).max() < 1e-12 * np.abs(expected).max()
    rows = sim.fix_rows("move")
    assert np.abs(rows[:, :3] - expected[:, :3]).max() < 1e-12 * np.abs(expected).max()
    assert np.abs(rows[:, 3:6] + f).max() < 1e-12 * np.abs(f).max()
    power = (load * expected).sum()
    assert sim.fix_scalar("move") == pytest.approx(power, rel=1e-12)
    vector = sim.fix_vector("move")
    assert vector[0] == pytest.approx(np.linalg.norm(sim.v, axis=1).max(), rel=1e-14)
    assert vector[3] == 1 and vector[5] == 4 and vector[6] == 0 and vector[8] == 0.01
    R = np.linalg.norm(sim.x[:, None] - sim.x, axis=-1) + 1e9 * np.eye(spheres.n)
    assert vector[7] == pytest.approx((2 * (R / (spheres.a[:, None] + spheres.a) - 1)).min(), rel=1e-9)


def test_weight_counts_whether_defined_before_or_after(simulation):
    ends = []
    for first, second in ((weight(THREE), FIX), (FIX, weight(THREE))):
        sim = simulation(THREE, ALL, fix=False, box=[(-99.0, 99.0)] * 3, dt=0.3)
        sim.commands([first, second]).run(20)
        ends.append(sim.x)
    assert (ends[0] == ends[1]).all()


def test_stream_carries_and_turns(simulation):
    rate = 0.7
    words = f"cut_off_distance inf visc 1 rotation yes fluid_velocity v_u 0 0"
    sim = simulation(Spheres([(0, 2, 0)]), words, fix=False, box=[(-99.0, 99.0)] * 3, dt=0.1,
                     before_pair=f"variable u atom {rate}*y")
    sim.commands(FIX).run(10)
    assert sim.x[0] == pytest.approx((rate * 2, 2, 0), abs=1e-13)
    assert sim.atom("omega")[0] == pytest.approx((0, 0, -rate / 2), abs=1e-13)


# --- steps -----------------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("scheme, limit", [("ab2", 1.0), ("euler", 2.0)])
def test_contacts_limit_the_step_as_they_should(simulation, scheme, limit):
    """Two spheres pressed together by 2 F against a spring k: stable while dt k mu < limit, mu that of their approach."""
    k, F, a = 50.0, 1.0, 1.0
    overlap = F / k
    mu = 2 / P6 * (1 - model.velocity_of_force(np.array([[0, 0, 0], [2.0 - overlap, 0, 0]]), np.ones(2))[0, 1, 0, 0] * P6)
    for part, stable in ((0.95, True), (1.05, False)):
        sim = simulation(Spheres([(0, 0, 0), (2.0 - overlap * 1.001, 0, 0)]), contacts(k, ALL), fix=False, box=[(-9.0, 9.0)] * 3, dt=part * limit / (k * mu),
                         comm="comm_modify vel yes", before_pair="neighbor 1 bin\nneigh_modify delay 0")
        sim.commands(f"group one id 1\ngroup two id 2\nfix a one addforce {F} 0 0\nfix b two addforce {-F} 0 0\n"
                     f"{FIX} scheme {scheme}").run(300)
        deviation = abs(2.0 - np.ptp(sim.x[:, 0]) - overlap) / overlap
        assert (deviation < 1e-6) if stable else (deviation > 0.01)


def test_adapt_follows_the_fastest(simulation):
    """The step is xmax over the largest speed, within its bounds, at most twice the last; the path is that of small steps."""
    spheres = Spheres([(0, 0, 0), (2.6, 0, 1.2), (1.0, 3.5, -0.5)])
    sim = simulation(spheres, ALL, fix=False, box=[(-99.0, 99.0)] * 3, dt=1e-3)
    sim.commands(weight(spheres)).commands(f"{FIX} adapt 1 1e-4 0.5 0.05\nvariable t equal time")
    sim.run(0)
    assert sim.fix_vector("move")[8] == pytest.approx(2e-3)
    sim.run(30)
    speed = np.linalg.norm(sim.v, axis=1).max()
    assert sim.fix_vector("move")[8] == pytest.approx(0.05 / speed, rel=1e-12)
    assert sim.fix_vector("move")[2] < 0.06
    t, x = sim.lmp.extract_variable("t"), sim.x
    fine = fall(simulation, spheres, t=t, steps=4000)
    assert np.abs(x - fine.x).max() < 2e-3


# --- rigid clumps -----------------------------------------------------------------------------------------------------------

def rotation_of(q):
    w, x, y, z = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def rows_of(body):
    return np.array([body[c] for c in "xyz"]), rotation_of([body[c] for c in ("q0", "qx", "qy", "qz")])


DOUBLET = np.array([(0, 0, -1.0), (0, 0, 1.0)])
CLUMPS = "cut_off_distance inf visc 1 rotation yes rigid_clumps yes"
COMM = "comm_modify cutoff 12\nneigh_modify exclude molecule/intra all"


def doublet_and_sphere():
    c, R = rows_of(table("doublet_and_sphere", "FT", 0.0)[0])
    return Spheres(np.vstack([c + DOUBLET @ R.T, (3.0, 0.5, 1.0)]), molecule=[1, 1, 0])


@pytest.mark.parametrize("scheme, order", [("ab2", 2), ("euler", 1)])
def test_doublet_and_sphere_fall_along_the_known_path(simulation, scheme, order):
    body, lone = table("doublet_and_sphere", "FT", 40.0)
    c, R = rows_of(body)
    reference = np.vstack([c + DOUBLET @ R.T, [lone[k] for k in "xyz"]])
    errors = []
    for steps in (100, 200, 400):
        sim = fall(simulation, doublet_and_sphere(), CLUMPS + " relative_tolerance 1e-8", f"scheme {scheme}", steps=steps,
                   comm=COMM)
        now = sim.x
        axis = (now[1] - now[0]) / 2
        errors.append((np.abs(now - reference).max(), np.abs(axis - R[:, 2]).max()))
    slopes = np.log2(np.array(errors[1]) / errors[2])
    assert slopes == pytest.approx([order] * 2, abs=0.1 if order == 2 else 0.05)
    assert errors[-1][0] < (1e-3 if order == 2 else 5e-2)


def chains(clumps=6, m=5, seed=4, side=14.0, molecule=1):
    rng, x = np.random.default_rng(seed), np.zeros((0, 3))
    while len(x) < clumps * m:
        axis = rng.normal(size=3)
        new = rng.uniform(0, side, 3) + np.outer(2 * np.arange(m) - (m - 1), axis / np.linalg.norm(axis))
        if len(x) == 0 or np.linalg.norm(new[:, None] - x, axis=-1).min() > 2.05:
            x = np.vstack([x, new])
    return Spheres(x, molecule=molecule + np.repeat(np.arange(clumps), m))


def rigid_velocities(x, molecule, load, eta=1.0):
    """Of rigid clumps of spheres with torques, by dense linear algebra: U at the centroid and W of each"""
    ids = np.unique(molecule)
    M = model.mobility(x, np.ones(len(x)), eta, rotation=True)
    K = np.zeros((6 * len(x), 6 * len(ids)))
    for b, m in enumerate(ids):
        centre = x[molecule == m].mean(axis=0)
        for i in np.nonzero(molecule == m)[0]:
            r = x[i] - centre
            K[6 * i:6 * i + 6, 6 * b:6 * b + 6] = np.eye(6)
            K[6 * i:6 * i + 3, 6 * b + 3:6 * b + 6] = [[0, r[2], -r[1]], [-r[2], 0, r[0]], [r[1], -r[0], 0]]
    return np.linalg.solve(K.T @ np.linalg.solve(M, K), K.T @ load.ravel()), K


def test_clumps_move_as_the_dense_solution_says(simulation):
    spheres = chains()
    sim = simulation(spheres, CLUMPS + " relative_tolerance 1e-10", fix=False, box=[(-40.0, 60.0)] * 3, dt=0.01, comm=COMM)
    sim.commands("variable fx atom sin(3*x)\nvariable fz atom -5-0.1*id\nfix pull all addforce v_fx 0 v_fz\n" + FIX).run(2)
    load = np.hstack([sim.f, sim.atom("torque")])
    V, K = rigid_velocities(sim.x, spheres.molecule, load)
    assert np.abs(np.hstack([sim.v, sim.atom("omega")]).ravel() - K @ V).max() < 1e-8 * np.abs(V).max()
    hydro = sim.fix_rows("move")
    for m in np.unique(spheres.molecule):    # what the fluid does balances what else acts
        who = spheres.molecule == m
        assert np.abs((hydro[who, 3:6] + load[who, :3]).sum(axis=0)).max() < 1e-10


def test_a_lone_clump_with_shells_does_not_care_whether_others_could_interact(simulation):
    ends = []
    for only in ("clumps_only yes", "cut_off_distance inf"):
        sim = simulation(chains(1), f"{only} visc 1.3 rigid_clumps yes shell 42 fluid_velocity v_u 0 v_w", fix=False, box=[(-40.0, 60.0)] * 3, dt=0.5,
                         comm=COMM, before_pair="variable u atom 0.3*z+0.1*x\nvariable w atom -0.1*z")
        sim.commands(f"fix pull all addforce 0.5 0 -1\n{FIX}").run(20)
        ends.append(np.hstack([sim.x, sim.v]))
    assert np.abs(ends[1] - ends[0]).max() < 1e-10


def test_period_of_the_doublet_in_shear(simulation):
    """Jeffery's orbit: the rate of turning is w1 cos^2 + w2 sin^2, so the period is 2 pi/sqrt(w1 w2), here that of shell 42:
    15.61585 in examples/tumbling, with a Stokes number of 0.01."""
    words = "clumps_only yes visc 1 rigid_clumps yes shell 42 fluid_velocity v_u 0 0"

    def chain_in_shear(axis, dt=0.01):
        sim = simulation(Spheres(np.outer((-1, 1), axis), molecule=1), words, fix=False, box=[(-9.0, 9.0)] * 3, comm=COMM, dt=dt,
                         before_pair="variable u atom z")
        return sim.commands(FIX)

    rates = [chain_in_shear(axis).run(0).atom("omega")[0, 1] for axis in ((0, 0, 1.0), (1.0, 0, 0))]
    period = 2 * np.pi / np.sqrt(rates[0] * rates[1])
    assert period == pytest.approx(15.61585, rel=1e-6)
    sim = chain_in_shear((0, 0, 1.0), dt=period / 20000).run(20000)
    axis = (sim.x[1] - sim.x[0]) / 2
    late = np.arctan2(axis[0], axis[2]) / rates[0]      # how far it is past a whole turn, as a time
    assert abs(late) < 1e-6 * period
    assert np.abs(axis[1]) < 1e-10


def test_shapes_stay_rigid(simulation):
    spheres = chains(2, 3, side=6.0)
    sim = fall(simulation, spheres, CLUMPS.replace("cut_off_distance inf", "clumps_only yes") + " fluid_velocity 0 0 0.5", t=100.0,
               steps=100000, lines="variable f atom sin(step*0.01+id)\nfix pull all addforce v_f 0 -9.4", comm=COMM)
    for m in (1, 2):
        x = sim.x[spheres.molecule == m]
        assert np.linalg.norm(x[1] - x[0]) == pytest.approx(2.0, abs=1e-11)
        assert np.linalg.norm(x[2] - x[0]) == pytest.approx(4.0, abs=1e-11)


@pytest.mark.parametrize("m", [1, 2, 5])
def test_periodic_border_is_none_for_a_clump(simulation, m):
    words = "clumps_only yes visc 1 rotation yes rigid_clumps yes"
    ends = []
    for shift, boundary in ((0.0, "p p p"), (-9.9, "p p p"), (0.0, "f f f")):
        spheres = chains(1, m, side=1e-3)
        spheres.x = spheres.x + shift + 0.01
        inside = Spheres((spheres.x + 10) % 20 - 10 if boundary[0] == "p" else spheres.x, molecule=spheres.molecule)
        sim = simulation(inside, words, fix=False, box=[(-10.0, 10.0)] * 3 if boundary[0] == "p" else [(-150.0, 150.0)] * 3, dt=2.0,
                         boundary=boundary, comm=COMM)
        sim.commands(f"fix pull all addforce 0.9 0.4 -2\nvariable fx atom 0.1*id\nfix also all addforce v_fx 0 0\n{FIX}").run(150)
        ends.append((sim.x - inside.x, sim.v))
    for moved, v in ends[:2]:
        difference = moved - ends[2][0]
        assert np.abs(difference).max() > 10    # it has crossed the border
        assert np.abs(difference - 20 * np.round(difference / 20)).max() < 1e-12
        assert np.abs(v - ends[2][1]).max() < 1e-12


# --- one run, in whatever pieces and on however many ranks ------------------------------------------------------------------

def mixed():
    """Chains, a doublet and free spheres"""
    spheres = chains(4, 3, seed=8, side=11.0)
    free = np.array([(-4.0, 1, 2), (5.5, -5, 3), (14.0, 14, 14), (1.0, 16, 4)])
    return Spheres(np.vstack([spheres.x, free]), molecule=np.append(spheres.molecule, [0] * 4))


WAYS = {"spheres": "cut_off_distance inf visc 1.1 rotation yes", "spheres by list": "cut_off_distance 9 taper wendland visc 1.1",
        "clumps": "cut_off_distance inf visc 1.1 rotation yes rigid_clumps yes",
        "clumps with shells": "cut_off_distance inf visc 1.1 rigid_clumps yes shell 12 fluid_velocity v_u 0 0",
        "clumps by list": "cut_off_distance 9 taper wendland visc 1.1 rotation yes rigid_clumps yes",
        "close spheres": "cut_off_distance inf visc 1.1 rotation yes lubrication yes relative_tolerance 1e-12",
        "close clumps": "cut_off_distance inf visc 1.1 rigid_clumps yes shell 12 fluid_velocity v_u 0 0 lubrication yes "
                        "lubrication_gap 1e-2 relative_tolerance 1e-12",
        "shells of points": "cut_off_distance inf visc 1.1 multiblob 12 rigid_clumps yes fluid_velocity v_u 0 0 lubrication yes "
                            "relative_tolerance 1e-12",
        "clumps apart": "clumps_only yes visc 1.1 rotation yes rigid_clumps yes shell 12 fluid_velocity v_u 0 0"}


def script(folder, way, runs, newton="on", options="", box=(-40.0, 40.0), boundary="p p p"):
    boundary = "f f f" if "inf" in WAYS[way] else boundary
    lines = input_lines(mixed(), contacts(20.0, WAYS[way]), os.path.join(str(folder), "spheres.data"), fix=False, box=[box] * 3, dt=0.3,
                        boundary=boundary, newton=newton, comm="comm_modify vel yes cutoff 9\nneigh_modify exclude molecule/intra all",
                        before_pair="variable u atom 0.05*z")
    # a force on every sphere of its own, so that bodies turn
    return lines + ["variable fx atom 0.3*sin(id)", "fix pull all addforce v_fx 0 -6", f"{FIX} {options}"] + runs


END = dump_lines("end.dump", every=100, columns="x y z vx vy vz omegax omegay omegaz")


def last_frame(folder):
    return read_dump(os.path.join(str(folder), "end.dump"))[-1][1]


def difference(a, b):
    """Up to the box: places within 80"""
    d = a - b
    d[:, :3] -= 80 * np.round(d[:, :3] / 80)
    return np.abs(d).max()


@pytest.mark.parametrize("way", WAYS)
def test_ranks_and_newton_do_not_matter(tmp_path, way):
    frames = []
    for ranks, newton in ((1, "on"), (2, "on"), (4, "off")):
        lmp(tmp_path, script(tmp_path, way, END + ["run 100"], newton), ranks)
        frames.append(last_frame(tmp_path))
    assert np.abs(frames[0][:, :9]).max() > 1
    assert max(difference(f, frames[0]) for f in frames[1:]) < 1e-10


@pytest.mark.parametrize("way, options, ranks", [(way, "", 2) for way in WAYS] + [("clumps with shells", "adapt 3 1e-3 0.5 0.05", 1),
                                                                                   ("spheres", "scheme euler", 1)])
def test_a_run_in_pieces_is_the_run_in_one(tmp_path, way, options, ranks):
    lmp(tmp_path, script(tmp_path, way, END + ["run 100"], options=options), ranks)
    whole = last_frame(tmp_path)
    lmp(tmp_path, script(tmp_path, way, END + ["run 37", "run 63"], options=options), ranks)
    assert difference(last_frame(tmp_path), whole) < 1e-10
    lmp(tmp_path, script(tmp_path, way, ["run 37", "write_restart half.restart"], options=options), ranks)
    again = script(tmp_path, way, END + ["run 63"], options=options)
    cut = [i for i, line in enumerate(again) if line.startswith("read_data")][0]
    again = [line for line in again[:cut] if "boundary" not in line] + ["read_restart half.restart"] + again[cut + 1:]
    lmp(tmp_path, again, ranks)
    assert difference(last_frame(tmp_path), whole) < 1e-10


@pytest.mark.parametrize("boundary, style, gap", [("p p p", "cut_off_distance inf", 2 * (np.hypot(1.2, 0.3) - 1)),
                                                  ("f f f", "cut_off_distance inf", 1.2),
                                                  ("f s p", "cut_off_distance 3", 2 * (np.hypot(1.2, 0.3) - 1)),
                                                  ("f p f", "cut_off_distance 1.1 taper wendland", 1.2)])
@pytest.mark.parametrize("ranks", [1, 3])
def test_smallest_gap_needs_no_ghosts(tmp_path, boundary, style, gap, ranks):
    """Across a periodic face and across ranks, and where the faces are none: no ghosts are asked for, or too few."""
    spheres = Spheres([(0, 0, -9.4), (1, 0, -0.8), (1, 0, 0.8), (0, 0.3, 9.4)], 0.5)
    lines = input_lines(spheres, f"{style} visc 1", str(tmp_path / "data"), boundary, [(-10.0, 10.0)] * 3, fix=False, dt=1e-3)
    lmp(tmp_path, lines + [FIX, "run 0", f'print "$(f_move[8]:%.15g)" file {tmp_path}/gap'], ranks)
    assert float((tmp_path / "gap").read_text()) == pytest.approx(gap, rel=1e-12)


def test_smallest_gap_in_a_plane(tmp_path):
    """The third direction of a plane is periodic by name only."""
    lines = input_lines(Spheres([(0, 0, 0), (1.4, 0, 0)], 0.5), "cut_off_distance inf visc 1", str(tmp_path / "data"), "f f p",
                        [(-10.0, 10.0), (-10.0, 10.0), (-0.3, 0.3)], fix=False, dt=1e-3)
    lmp(tmp_path, ["dimension 2"] + lines + ["fix plane all enforce2d", FIX, "run 0", f'print "$(f_move[8]:%.15g)" file {tmp_path}/gap'])
    assert float((tmp_path / "gap").read_text()) == pytest.approx(0.8, rel=1e-12)


def test_a_sphere_moved_by_hand_starts_anew(simulation):
    """displace_atoms between runs: what was before the move says nothing of the path after it."""
    ends = []
    for before in (0, 20):
        sim = simulation(THREE, ALL, fix=False, box=[(-99.0, 99.0)] * 3, dt=0.3)
        sim.commands([weight(THREE), FIX])
        sim.run(before) if before else None
        for k, x in enumerate([(-4, 0, 0), (0, 1, 0), (3, 0, 3)]):
            sim.set("x", k + 1, x)
        sim.run(10)
        ends.append(sim.x)
    assert np.abs(ends[1] - ends[0]).max() < 1e-12


@pytest.mark.parametrize("change", ["reset", "delete"])
def test_clumps_are_known_by_their_atoms_of_now(simulation, change):
    """Commands between two runs give other IDs: to the spheres of a clump each other's, or those of a sphere that is gone."""
    spheres = Spheres([(0, 0, 0), (-1.5, 0, 0), (0, 6, 0), (2, 6, 0), (2, 8, 0), (30, 0, 0)], [1, 0.5, 1, 1, 1, 1], molecule=[1, 1, 2, 2, 2, 0])
    words, comm = "cut_off_distance inf visc 1.3 rigid_clumps yes rotation yes relative_tolerance 1e-9", "comm_modify cutoff 9"
    sim = simulation(spheres, words, fix=False, box=[(-60, 60)] * 3, comm=comm)
    sim.commands("fix weight all addforce 0.1 0 -1").commands(FIX).run(0)
    if change == "delete":      # a sphere of molecule 2 as well
        sim.commands("group gone id 3 6\ndelete_atoms group gone compress no")
    sim.commands(f"{'reset_atoms id' if sim.lmp.version() >= 20230615 else 'reset_atom_ids'} sort yes").run(0)
    now, v = Spheres(sim.x, sim.atom("radius"), molecule=sim.atom("molecule")), sim.v
    assert change == "delete" or (now.a[:2] == [0.5, 1]).all()
    fresh = simulation(now, words, fix=False, box=[(-60, 60)] * 3, comm=comm)
    fresh.commands("fix weight all addforce 0.1 0 -1").commands(FIX).run(0)
    assert np.abs(fresh.v - v).max() < 1e-7 * np.abs(v).max()


@pytest.mark.parametrize("boundary, flow", [("f f f", "v_u 0.2 0"), ("p p p", "0.1 0.2 0 far_field_tolerance 1e-12")])
def test_forces_for_given_velocities_are_the_inverse(simulation, boundary, flow):
    """rigid_clumps yes, clumps_only no: what moves the clumps so without inertia is what the pair style finds for that motion; in
    open space and with all periodic images."""
    words = f"{CLUMPS} relative_tolerance 1e-10 fluid_velocity {flow} max_iter 500".replace("rotation yes", "shell 12")
    spheres = mixed()
    sim = simulation(spheres, words, fix=False, box=[(-40.0, 60.0) if boundary == "f f f" else (-12.0, 22.0)] * 3, dt=0.01, comm=COMM,
                     before_pair="variable u atom 0.3*z+0.1*x", boundary=boundary)
    sim.commands(f"variable fx atom sin(3*x)\nvariable fz atom -5-0.1*id\nfix pull all addforce v_fx 0 v_fz\n{FIX}").run(2)
    load, before = sim.f, sim.fix_rows("move")[:, 3:9]
    for algorithm in ("2", "2 precondition clump", "1"):
        sim.commands(f"unfix move\nfix drag all stokes_dynamics\npair_style stokes_dynamics {words} algorithm {algorithm}\n"
                     "pair_coeff * *").run(0)
        rows = sim.fix_rows()
        forces = np.hstack([rows[:, :3], rows[:, 6:9]])
        assert np.abs(forces - before).max() < 1e-7 * np.abs(load).max()
        for m in np.unique(spheres.molecule):
            who = spheres.molecule == m
            balance = (rows[who, :3] + load[who]).sum(axis=0) if m else rows[who, :3] + load[who]
            assert np.abs(balance).max() < 1e-7 * np.abs(load).max()
        sim.commands(f"unfix drag\n{FIX}")


# --- whose velocities, which forces ------------------------------------------------------------------------------------------

@pytest.mark.parametrize("other", ["temp/rescale 1 1 1 0.01 1", "temp/berendsen 1 1 1", "momentum 1 linear 1 1 1"])
def test_who_writes_to_v_does_not_steer(simulation, other):
    """v is output: thermostats and fix momentum change what is printed, not the path, and not the step of adapt."""
    ends = []
    for line in ("", f"fix other all {other}"):
        sim = simulation(cloud(8), ALL, fix=False, box=[(-30.0, 30.0)] * 3, dt=0.05)
        sim.commands(weight(THREE)).commands(line).commands(f"{FIX} adapt 1 1e-3 0.5 0.05").run(20)
        ends.append(sim.x)
    assert np.abs(ends[0][:, 2] - cloud(8).x[:, 2]).max() > 0.5
    assert (ends[1] == ends[0]).all()


@pytest.mark.parametrize("change, after", [("unfix weight", 0.0), ("unfix weight\nfix weight all addforce 0 0 2", 2.0),
                                           ("pair_style stokes_dynamics cut_off_distance inf visc 4\npair_coeff * *", -0.25),
                                           ("variable u equal 0.5", -0.5), ("variable u equal 0.0", -1.0)])
def test_a_force_that_is_taken_away_leaves_nothing(simulation, change, after):
    """Between two runs: the first step goes by the velocity of now alone. Nothing has changed in the last case."""
    sim = simulation(Spheres([(0, 0, 0)]), f"cut_off_distance inf visc {1 / P6!r} fluid_velocity 0 0 v_u", fix=False,
                     box=[(-30.0, 30.0)] * 3, dt=0.1, before_pair="variable u equal 0.0")
    sim.commands("fix weight all addforce 0 0 -1").commands(FIX).run(10)
    assert sim.x[0, 2] == pytest.approx(-1.0, abs=1e-13)
    after = after if "visc" not in change else -1 / (P6 * 4)
    sim.commands(change).run(10)
    assert sim.x[0, 2] == pytest.approx(-1.0 + after, abs=1e-13)


def test_a_run_goes_on_by_the_second_order_when_nothing_has_changed(simulation):
    """Euler's step is for changes alone: a run in ten pieces is the run in one."""
    ends = []
    for pieces in (1, 10):
        sim = simulation(THREE, ALL, fix=False, box=[(-99.0, 99.0)] * 3, dt=0.5)
        sim.commands([weight(THREE), FIX])
        for _ in range(pieces):
            sim.run(20 // pieces)
        ends.append(sim.x)
    assert np.abs(ends[1] - ends[0]).max() < 1e-13


@pytest.mark.parametrize("way", ["delete_atoms", "evaporate"])
def test_the_step_after_atoms_have_gone_is_eulers(simulation, way):
    """What is left falls more slowly at once: no part of the step is of the velocities before."""
    spheres = Spheres([(0, 0, 0), (3, 0, 0), (0.5, 2.5, 0)])
    sim = simulation(spheres, ALL, fix=False, box=[(-40.0, 40.0)] * 3, dt=0.3)
    sim.commands(weight(THREE)).commands(FIX).commands("group heavy id 3")
    if way == "evaporate":
        sim.commands("region all block EDGE EDGE EDGE EDGE EDGE EDGE\nfix gone heavy evaporate 10 1 all 4711").run(9)
        assert sim.n == 3
        sim.run(1)
    else:
        sim.run(9).commands("delete_atoms group heavy compress no").run(0)
    assert sim.n == 2 and sim.fix_vector("move")[1] == 0.0
    x, v = sim.x, sim.v
    sim.run(1)
    assert np.abs(sim.x - x - 0.3 * v).max() < 1e-14


def test_a_restarted_step_of_adapt_is_told_to_others(simulation, tmp_path):
    """Whoever keeps the length of a step (another integration here, springs of friction elsewhere) has that of the run, not that which
    a script names after read_restart."""
    words = "pair_style stokes_dynamics cut_off_distance inf visc 1 group slow\npair_coeff * *"
    lines = input_lines(THREE, words.splitlines(), str(tmp_path / "data"), fix=False, box=[(-40.0, 40.0)] * 3, dt=0.1,
                        before_pair="group slow id 1 2\ngroup fast id 3\nvelocity fast set 1 0 0")
    rest = ["fix pull slow addforce 0 0 -1", "fix other fast nve/sphere", "fix move slow stokes_dynamics/overdamped adapt 5 1e-3 0.1 10"]
    x = simulation().commands(lines + rest).run(18).x
    simulation().commands(lines + rest + ["run 12", f"write_restart {tmp_path}/half"])
    again = simulation().commands(["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/half", *words.splitlines()] + rest)
    assert np.abs(again.command("timestep 0.01") or again.run(6).x - x).max() < 1e-12


def test_values_outlive_the_memory_of_the_pair_style(simulation):
    """unfix of the internal fix: no number is read from where it was."""
    sim = simulation(THREE, ALL, fix=False, box=[(-40.0, 40.0)] * 3, dt=0.3)
    sim.commands(weight(THREE)).commands(FIX).run(3)
    assert sim.fix_vector("move")[5] == 4
    sim.command("unfix STOKES_DYNAMICS_STATE")
    assert (sim.fix_vector("move")[3:7] == 0).all()
    assert sim.run(1).fix_vector("move")[5] == 2


# --- what does not go with it -----------------------------------------------------------------------------------------------

@pytest.mark.parametrize("lines, message", [
    ("fix other all nve/sphere", "fix other of style nve/sphere integrates atoms of the same group"),
    ("fix other all nve", "fix other of style nve integrates atoms of the same group"),
    ("fix other all nvt temp 1 1 1", "fix other of style nvt integrates atoms of the same group"),
    ("fix other all rigid single", "fix other of style rigid integrates atoms of the same group"),
    ("fix other all rigid/small molecule", "fix other of style rigid/small integrates atoms of the same group"),
    ("fix other all viscous 1.0", "fix other of style viscous drags atoms of the same group"),
    ("fix other all langevin 1 1 1 4711", "fix other of style langevin drags atoms of the same group"),
    ("fix other all stokes_dynamics", "fix other of style stokes_dynamics cannot apply"),
    ("fix other all stokes_dynamics apply yes", "fix other of style stokes_dynamics cannot apply"),
    ("fix other all stokes_dynamics/overdamped", "fix other of style stokes_dynamics/overdamped integrates atoms of the same"),
    ("pair_style stokes_dynamics cut_off_distance inf visc 1 add_force yes\npair_coeff * *", "keyword add_force .* must be no"),
    ("pair_style stokes_dynamics cut_off_distance inf visc 1 update_every 3\npair_coeff * *", "update_every .* must be 1, not 3"),
    ("pair_style stokes_dynamics clumps_only yes visc 1 rigid_clumps auto rotation yes\npair_coeff * *", "yes or no, not auto"),
    ("pair_style stokes_dynamics clumps_only yes visc 1 rigid_clumps yes\npair_coeff * *", "requires rotation yes or a shell"),
    ("pair_style none", "there is no pair_style stokes_dynamics"),
    ("run_style respa 2 2", "respa"),
    ("group some id 1\npair_style stokes_dynamics cut_off_distance inf visc 1 group some\npair_coeff * *",
     "atom 2 is in its group or in the selection of pair_style stokes_dynamics"),
    ("comm_modify vel yes\npair_style hybrid/overlay gran/hooke/history 10 NULL 0.3 NULL 0 0 stokes_dynamics cut_off_distance inf visc 1\n"
     "pair_coeff * * gran/hooke/history\npair_coeff * * stokes_dynamics", "pair_style gran/hooke/history damps its contacts .gamma 0.3"),
    ("comm_modify vel yes\npair_style hybrid/overlay gran/hooke 10 NULL 0.3 0.1 0 1 stokes_dynamics cut_off_distance inf visc 1\n"
     "pair_coeff * * gran/hooke\npair_coeff * * stokes_dynamics", "pair_style gran/hooke damps its contacts"),
])
def test_what_does_not_go_with_it_is_named(simulation, lines, message):
    sim = simulation(chains(2), ALL, fix=False, box=[(-40.0, 40.0)] * 3, dt=0.01, comm=COMM)
    sim.commands(FIX)
    with pytest.raises(Exception, match=message):
        sim.commands(lines).run(1)


def test_it_cannot_be_minimised(simulation):
    sim = simulation(doublet_and_sphere(), ALL, fix=False, box=[(-20.0, 20.0)] * 3, dt=0.01, comm=COMM)
    sim.commands(FIX)
    with pytest.raises(Exception, match="cannot be minimised|minimize cannot be used"):
        sim.command("minimize 0 1e-3 10 10")


@pytest.mark.parametrize("words, message", [
    ("scheme rk4", "Fix stokes_dynamics/overdamped: keyword scheme: 'rk4'"),
    ("scheme", "keyword scheme"),
    ("adapt 0 1 2 3", "keyword adapt: '0' must be >= 1"),
    ("adapt 1 -1 2 3", "keyword adapt: '-1' must be > 0"),
    ("adapt 1 2 1 3", "keyword adapt: tmin '2' must not be above tmax '1'"),
    ("adapt 1 2 3", "keyword adapt"),
    ("adapt 1 1 2 nan", "keyword adapt: 'nan'"),
    ("rigid yes", "unknown keyword 'rigid'"),
    ("scheme ab2 scheme euler", "keyword scheme"),
])
def test_bad_words(simulation, words, message):
    sim = simulation(doublet_and_sphere(), ALL, fix=False, box=[(-20.0, 20.0)] * 3, dt=0.01, comm=COMM)
    with pytest.raises(Exception, match=message):
        sim.commands(f"{FIX} {words}")


def test_other_atoms_may_be_integrated_otherwise(simulation):
    sim = simulation(THREE, "cut_off_distance inf visc 1 group slow", fix=False, box=[(-20.0, 20.0)] * 3, dt=0.01,
                     before_pair="group slow id 1 2\ngroup fast id 3\nvelocity fast set 1 0 0")
    sim.commands("fix other fast nve/sphere\nfix move slow stokes_dynamics/overdamped\nfix pull slow addforce 0 0 -1").run(10)
    assert sim.v[2] == pytest.approx((1, 0, 0)) and sim.v[0, 2] < -0.05


def test_contacts_allow_a_step_that_is_told(tmp_path):
    spheres = Spheres([(0, 0, 0), (1.99, 0, 0)])
    lines = input_lines(spheres, contacts(50.0, ALL), os.path.join(str(tmp_path), "spheres.data"), fix=False, box=[(-9.0, 9.0)] * 3, dt=0.3,
                        comm="comm_modify vel yes")
    out = lmp(tmp_path, lines + [FIX, "run 1"])
    limit = 0.39 * P6
    assert f"contacts and bonds of stiffness k allow time steps up to 0.39 6 pi eta a / k = {limit:.6g} / k" in out.log
    assert f"time step 0.3 is above {limit / 50:.6g}" in out.log
