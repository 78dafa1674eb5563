"""fix stokes_dynamics/overdamped of rigid clumps: known paths, the dense solution, shapes that stay rigid."""
import numpy as np
import pytest

import model
from system import Spheres
from test_overdamped import table
from without_inertia import CLUMPS, COMM, FIX, chains, fall, mixed

def rotation_of(q):
    w, x, y, z = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                     [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                     [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]])


def rows_of(body):
    return np.array([body[c] for c in "xyz"]), rotation_of([body[c] for c in ("q0", "qx", "qy", "qz")])


DOUBLET = np.array([(0, 0, -1.0), (0, 0, 1.0)])


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
        sim = fall(simulation, doublet_and_sphere(), CLUMPS + " relative_tolerance 1e-8", f"scheme {scheme}",
                   steps=steps, comm=COMM)
        now = sim.x
        axis = (now[1] - now[0]) / 2
        errors.append((np.abs(now - reference).max(), np.abs(axis - R[:, 2]).max()))
    slopes = np.log2(np.array(errors[1]) / errors[2])
    assert slopes == pytest.approx([order] * 2, abs=0.1 if order == 2 else 0.05)
    assert errors[-1][0] < (1e-3 if order == 2 else 5e-2)


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
    sim = simulation(spheres, CLUMPS + " relative_tolerance 1e-10", fix=False, box=[(-40.0, 60.0)] * 3, dt=0.01,
                     comm=COMM)
    sim.commands("variable fx atom sin(3*x)\nvariable fz atom -5-0.1*id\nfix pull all addforce v_fx 0 v_fz\n" +
                 FIX).run(2)
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
        sim = simulation(chains(1), f"{only} visc 1.3 rigid_clumps yes shell 42 fluid_velocity v_u 0 v_w", fix=False,
                         box=[(-40.0, 60.0)] * 3, dt=0.5, comm=COMM, before_pair="variable u atom 0.3*z+0.1*x\n"
                         "variable w atom -0.1*z")
        sim.commands(f"fix pull all addforce 0.5 0 -1\n{FIX}").run(20)
        ends.append(np.hstack([sim.x, sim.v]))
    assert np.abs(ends[1] - ends[0]).max() < 1e-10


def test_period_of_the_doublet_in_shear(simulation):
    """Jeffery's orbit: the rate of turning is w1 cos^2 + w2 sin^2, so the period is 2 pi/sqrt(w1 w2), here that of
    shell 42: 15.61585 in examples/tumbling, with a Stokes number of 0.01."""
    words = "clumps_only yes visc 1 rigid_clumps yes shell 42 fluid_velocity v_u 0 0"

    def chain_in_shear(axis, dt=0.01):
        sim = simulation(Spheres(np.outer((-1, 1), axis), molecule=1), words, fix=False, box=[(-9.0, 9.0)] * 3,
                         comm=COMM, dt=dt, before_pair="variable u atom z")
        return sim.commands(FIX)

    rates = [chain_in_shear(axis).run(0).atom("omega")[0, 1] for axis in ((0, 0, 1.0), (1.0, 0, 0))]
    period = 2 * np.pi / np.sqrt(rates[0] * rates[1])
    assert period == pytest.approx(15.61585, rel=1e-6)
    sim = chain_in_shear((0, 0, 1.0), dt=period / 20000).run(20000)
    axis = (sim.x[1] - sim.x[0]) / 2
    late = np.arctan2(axis[0], axis[2]) / rates[0]      # how far it is past a whole turn, as a time
    assert abs(late) < 1e-6 * period
    assert np.abs(axis[1]) < 1e-10


@pytest.mark.parametrize("words, growth", [("cut_off_distance inf multiblob 12", 1.6),
                                           ("cut_off_distance inf multiblob 42", 0.08),
                                           ("cut_off_distance inf multiblob 42 half", 0.0),
                                           ("clumps_only yes shell 12", 0.0)])
def test_orbits_of_a_doublet_in_shear_are_closed_as_the_page_says(simulation, words, growth):
    """The orbit constant, by the axis as it crosses the plane of vorticity and gradient: its growth per half turn in
    per cent, over four whole turns"""
    dt, axis = 0.02, np.array((0.466, -0.396, 0.791))
    sim = simulation(Spheres(np.outer((-1, 1), axis / np.linalg.norm(axis)), molecule=1),
                     f"{words} visc 1 rigid_clumps yes fluid_velocity v_u 0 0", fix=False, box=[(-9.0, 9.0)] * 3,
                     comm=COMM, dt=dt, before_pair="variable u atom z").commands(FIX).run(0)
    constants, before = [], None
    for _ in range(700):
        x = sim.run(5, "pre no post no").x
        p = (x[1] - x[0]) / 2
        if before is not None and before[0] * p[0] < 0:
            y = (before[1] * p[0] - p[1] * before[0]) / (p[0] - before[0])
            constants.append(np.sqrt(1 / y**2 - 1))
        before = p
    assert len(constants) >= 8
    half_turns = len(constants) - 2 + len(constants) % 2
    found = 100 * ((constants[half_turns] / constants[0])**(1 / half_turns) - 1)
    assert found == pytest.approx(growth, rel=0.1, abs=0.01)


def test_shapes_stay_rigid(simulation):
    spheres = chains(2, 3, side=6.0)
    sim = fall(simulation, spheres, CLUMPS.replace("cut_off_distance inf", "clumps_only yes") +
               " fluid_velocity 0 0 0.5", t=100.0,
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
        sim = simulation(inside, words, fix=False, box=[(-10.0, 10.0)] * 3 if boundary[0] == "p"
                         else [(-150.0, 150.0)] * 3, dt=2.0, boundary=boundary, comm=COMM)
        sim.commands("fix pull all addforce 0.9 0.4 -2\nvariable fx atom 0.1*id\n"
                     f"fix also all addforce v_fx 0 0\n{FIX}").run(150)
        ends.append((sim.x - inside.x, sim.v))
    for moved, v in ends[:2]:
        difference = moved - ends[2][0]
        assert np.abs(difference).max() > 10    # it has crossed the border
        assert np.abs(difference - 20 * np.round(difference / 20)).max() < 1e-12
        assert np.abs(v - ends[2][1]).max() < 1e-12


@pytest.mark.parametrize("change", ["reset", "delete"])
def test_clumps_are_known_by_their_atoms_of_now(simulation, change):
    """Commands between two runs give other IDs: to the spheres of a clump each other's, or those of a sphere that is
    gone."""
    spheres = Spheres([(0, 0, 0), (-1.5, 0, 0), (0, 6, 0), (2, 6, 0), (2, 8, 0), (30, 0, 0)], [1, 0.5, 1, 1, 1, 1],
                      molecule=[1, 1, 2, 2, 2, 0])
    words = "cut_off_distance inf visc 1.3 rigid_clumps yes rotation yes relative_tolerance 1e-9"
    comm = "comm_modify cutoff 9"
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
    """rigid_clumps yes, clumps_only no: what moves the clumps so without inertia is what the pair style finds for that
    motion; in open space and with all periodic images."""
    words = f"{CLUMPS} relative_tolerance 1e-10 fluid_velocity {flow} max_iter 500".replace("rotation yes", "shell 12")
    spheres = mixed()
    sim = simulation(spheres, words, fix=False, box=[(-40.0, 60.0) if boundary == "f f f" else (-12.0, 22.0)] * 3,
                     dt=0.01, comm=COMM, before_pair="variable u atom 0.3*z+0.1*x", boundary=boundary)
    sim.commands(
        f"variable fx atom sin(3*x)\nvariable fz atom -5-0.1*id\nfix pull all addforce v_fx 0 v_fz\n{FIX}").run(2)
    load, before = sim.f, sim.fix_rows("move")[:, 3:9]
    for algorithm in ("2", "2 precondition clump", "1"):
        sim.commands("unfix move\nfix drag all stokes_dynamics\n"
                     f"pair_style stokes_dynamics {words} algorithm {algorithm}\n"
                     "pair_coeff * *").run(0)
        rows = sim.fix_rows()
        forces = np.hstack([rows[:, :3], rows[:, 6:9]])
        assert np.abs(forces - before).max() < 1e-7 * np.abs(load).max()
        for m in np.unique(spheres.molecule):
            who = spheres.molecule == m
            balance = (rows[who, :3] + load[who]).sum(axis=0) if m else rows[who, :3] + load[who]
            assert np.abs(balance).max() < 1e-7 * np.abs(load).max()
        sim.commands(f"unfix drag\n{FIX}")
