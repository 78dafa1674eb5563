"""fix stokes_dynamics/overdamped of free spheres: paths against converged ones (unittest/data/motion), closed forms,
orders, steps."""
import csv
import os

import numpy as np
import pytest

import model
from system import Spheres, input_lines, lmp
from without_inertia import ALL, FIX, P6, THREE, cloud, contacts, fall, weight


def table(case, level, t):
    path = os.path.join(model.DATA, "motion", "trajectories.csv")
    rows = csv.DictReader(line for line in open(path) if not line.startswith("#"))
    return [{k: float(v) for k, v in row.items() if k not in ("case", "level") and v} for row in rows
            if row["case"] == case and row["level"] == level and float(row["t"]) == t]


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
    sim = simulation(Spheres([(1, 2, 3)], a), f"cut_off_distance inf visc {eta} rotation yes", fix=False,
                     box=[(-900, 900.0)] * 3, dt=dt)
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


@pytest.mark.parametrize("scheme, limit", [("ab2", 1.0), ("euler", 2.0)])
def test_contacts_limit_the_step_as_they_should(simulation, scheme, limit):
    """Two spheres pressed together by 2 F against a spring k: stable while dt k mu < limit, mu that of their
    approach."""
    k, F, a = 50.0, 1.0, 1.0
    overlap = F / k
    mu = 2 / P6 * (1 - model.velocity_of_force(np.array([[0, 0, 0], [2.0 - overlap, 0, 0]]), np.ones(2))[0, 1, 0, 0] *
                   P6)
    for part, stable in ((0.95, True), (1.05, False)):
        sim = simulation(Spheres([(0, 0, 0), (2.0 - overlap * 1.001, 0, 0)]), contacts(k, ALL), fix=False,
                         box=[(-9.0, 9.0)] * 3, dt=part * limit / (k * mu),
                         comm="comm_modify vel yes", before_pair="neighbor 1 bin\nneigh_modify delay 0")
        sim.commands(f"group one id 1\ngroup two id 2\nfix a one addforce {F} 0 0\nfix b two addforce {-F} 0 0\n"
                     f"{FIX} scheme {scheme}").run(300)
        deviation = abs(2.0 - np.ptp(sim.x[:, 0]) - overlap) / overlap
        assert (deviation < 1e-6) if stable else (deviation > 0.01)


def test_adapt_follows_the_fastest(simulation):
    """The step is xmax over the largest speed, within its bounds, at most twice the last; the path is that of small
    steps."""
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


@pytest.mark.parametrize("boundary, style, gap", [("p p p", "cut_off_distance inf", 2 * (np.hypot(1.2, 0.3) - 1)),
                                                  ("f f f", "cut_off_distance inf", 1.2),
                                                  ("f s p", "cut_off_distance 3 taper wendland",
                                                   2 * (np.hypot(1.2, 0.3) - 1)),
                                                  ("f p f", "cut_off_distance 1.1 taper wendland", 1.2)])
@pytest.mark.parametrize("ranks", [1, 3])
def test_smallest_gap_needs_no_ghosts(tmp_path, boundary, style, gap, ranks):
    """Across a periodic face and across ranks, and where the faces are none: no ghosts are asked for, or too few."""
    spheres = Spheres([(0, 0, -9.4), (1, 0, -0.8), (1, 0, 0.8), (0, 0.3, 9.4)], 0.5)
    lines = input_lines(spheres, f"{style} visc 1", str(tmp_path / "data"), boundary, [(-10.0, 10.0)] * 3, fix=False,
                        dt=1e-3)
    lmp(tmp_path, lines + [FIX, "run 0", f'print "$(f_move[8]:%.15g)" file {tmp_path}/gap'], ranks)
    assert float((tmp_path / "gap").read_text()) == pytest.approx(gap, rel=1e-12)


def test_smallest_gap_in_a_plane(tmp_path):
    """The third direction of a plane is periodic by name only."""
    lines = input_lines(Spheres([(0, 0, 0), (1.4, 0, 0)], 0.5), "cut_off_distance inf visc 1", str(tmp_path / "data"),
                        "f f p", [(-10.0, 10.0), (-10.0, 10.0), (-0.3, 0.3)], fix=False, dt=1e-3)
    lmp(tmp_path, ["dimension 2"] + lines + ["fix plane all enforce2d", FIX, "run 0",
                                             f'print "$(f_move[8]:%.15g)" file {tmp_path}/gap'])
    assert float((tmp_path / "gap").read_text()) == pytest.approx(0.8, rel=1e-12)


PLANE = dict(boundary="f f p", box=[(-20.0, 20.0), (-20.0, 20.0), (-0.5, 0.5)])


@pytest.mark.parametrize("scheme", ["ab2", "midpoint"])
@pytest.mark.parametrize("style, molecule", [("fluid_velocity 0.1 0 0.3", 0),
                                             ("rotation yes fluid_velocity 0.1 0 0.3", 0), ("multiblob 12", 0),
                                             ("multiblob 12 rigid_clumps yes", [1, 1, 1, 0])])
def test_nobody_leaves_a_plane(simulation, tmp_path, style, molecule, scheme):
    """Nor turns but about its normal: neither a stream across it carries spheres off, nor shells of points that stand
    askew to it."""
    lines = input_lines(Spheres([(0, 0, 0), (2, 0, 0), (2.3, 2.1, 0), (-2, -1.5, 0)], molecule=molecule),
                        f"{ALL} {style}", str(tmp_path / "data"), fix=False, dt=0.05, **PLANE)
    sim = simulation().commands(["dimension 2"] + lines)
    sim.commands(["variable fx atom 9*sin(id)", "variable fy atom -8*cos(id)", "fix pull all addforce v_fx v_fy 0",
                  f"{FIX} scheme {scheme}"]).run(20)
    assert (sim.x[:, 2] == 0).all() and (sim.v[:, 2] == 0).all() and (sim.atom("omega")[:, :2] == 0).all()
    assert np.abs(sim.x[0, :2]).max() > 0.1


def test_contacts_allow_a_step_that_is_told(tmp_path):
    spheres = Spheres([(0, 0, 0), (1.99, 0, 0)])
    lines = input_lines(spheres, contacts(50.0, ALL), os.path.join(str(tmp_path), "spheres.data"), fix=False,
                        box=[(-9.0, 9.0)] * 3, dt=0.3, comm="comm_modify vel yes")
    out = lmp(tmp_path, lines + [FIX, "run 1"])
    limit = 0.39 * P6
    assert f"contacts and bonds of stiffness k allow time steps up to 0.39 6 pi eta a / k = {limit:.6g} / k" in out.log
    assert f"time step 0.3 is above {limit / 50:.6g}" in out.log


@pytest.mark.parametrize("part, friction, warned", [(0.9, 0.0, False), (1.1, 0.0, True), (0.1, 0.5, True)])
def test_springs_that_films_slow_allow_longer_steps(tmp_path, part, friction, warned):
    """A cluster of twelve about one: overlaps fade in steps up to the limit with films of a gap of xi, 0.64/xi times
    the one without. Springs across (here 2/7 as stiff) have the limit without."""
    ways = [(p, q, 0) for p in (1, -1) for q in (1, -1)]
    x = 1.99 / 2**0.5 * np.array([(0, 0, 0)] + [np.roll(way, turn) for way in ways for turn in range(3)])
    limit = 0.39 * P6 * 64
    style = f"{ALL} rotation yes lubrication yes lubrication_gap 0.01"
    lines = input_lines(Spheres(x), contacts(50.0, style, friction), os.path.join(str(tmp_path), "spheres.data"),
                        fix=False, box=[(-19.0, 19.0)] * 3, dt=part * limit / 50, comm="comm_modify vel yes")
    out = lmp(tmp_path, lines + [FIX, "thermo_style custom step f_move[8]", "thermo 12", "run 12"])
    assert f"with films between them, up to {limit:.6g} / k" in " ".join(out.log.split())
    assert ("is above" in out.log) == warned
    gaps = [float(line.split()[1]) for line in out.log.splitlines() if line.split()[:1] in (["0"], ["12"]) and
            len(line.split()) == 2]
    assert gaps[0] == pytest.approx(-0.01) and (warned or abs(gaps[1]) < 0.003)
