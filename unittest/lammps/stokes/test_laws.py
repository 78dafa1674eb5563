"""Laws that every scene without inertia obeys, whatever its model and its box: motions are linear in loads, the work
that loads of one scene do on motions of another is mutual, it is dissipated, and two cells of a lattice are one."""
import numpy as np
import pytest

from system import Spheres
from test_multiblob import MOVE, pull

TIGHT = "cut_off_distance inf visc 1.3 relative_tolerance 1e-11 max_iter 900 far_field_tolerance 1e-10 lubrication yes"
# A clump of three, a sphere in its crevice and a free one
X, MOLECULE = np.array([(0, 0, 0), (1.8, 0, 0), (0, 1.8, 0), (0.2, 0.3, 2.25), (-2.3, -2.3, 1.2)]), [1, 1, 1, 0, 0]
CELL = [(-4.0, 5.0), (-4.0, 5.5), (-1.5, 3.6)]
BOXES = {"open": ("", {}), "periodic": ("", dict(boundary="p p p", box=CELL)),
         "tilted": ("", dict(boundary="p p p", box=CELL, tilt=(2.0, -1.5, 1.0))), "wall": ("wall zlo -1.3", {}),
         "floor": ("wall zlo -1.3", dict(boundary="p p f", box=CELL)),
         "slit": ("wall zlo -1.3 zhi 3.4", dict(boundary="p p f", box=CELL))}


@pytest.mark.parametrize("model", ["multiblob 12", "rotation yes"])
@pytest.mark.parametrize("where", BOXES)
def test_motions_are_linear_mutual_and_dissipate_the_work(simulation, where, model):
    words, box = BOXES[where]
    if where in ("floor", "slit"):
        model = "multiblob 42" if model == "rotation yes" else model     # there spheres that turn are multiblobs
    rng = np.random.default_rng(9)

    def answer(F, T):
        """Velocities and spins of all spheres under forces on all and a torque on the fourth, and the dissipation"""
        sim = simulation(Spheres(X, molecule=MOLECULE), f"{TIGHT} {model} rigid_clumps yes {words}", fix=False, dt=1e-9,
                         comm="neigh_modify exclude molecule/intra all", **box)
        torque = " ".join(map(repr, map(float, T[3])))
        sim.commands(pull(F) + ["group turned id 4", f"{MOVE} torque turned {torque}"]).run()
        return np.hstack([sim.v, sim.atom("omega")]), sim.fix_scalar("move")

    loads = rng.normal(size=(2, 5, 6))
    loads[:, [0, 1, 2, 4], 3:] = 0
    (a, power), (b, _) = (answer(load[:, :3], load[:, 3:]) for load in loads)
    both = loads[0] + 2 * loads[1]
    c = answer(both[:, :3], both[:, 3:])[0]
    assert np.abs(c - a - 2 * b).max() < 1e-9 * np.abs(c).max()
    assert abs((a * loads[1]).sum() - (b * loads[0]).sum()) < 1e-9 * power
    assert (a * loads[0]).sum() == pytest.approx(power, rel=1e-12)


@pytest.mark.parametrize("model", ["multiblob 12", "rotation yes"])
@pytest.mark.parametrize("tilt", [None, (1.5, -1.0, 2.0)])
def test_two_cells_of_a_lattice_are_one(simulation, tilt, model):
    H = np.diag((7.3, 8.6, 6.7))
    H[1, 0], H[2, 0], H[2, 1] = tilt or (0, 0, 0)
    x = np.array([(0.5, 0.4, 0.3), (2.3, 1.6, 0.9), (5.0, 4.0, 1.0), (3.0, 5.0, 4.0), (6.0, 1.0, 4.5)])
    F = np.random.default_rng(5).normal(size=(5, 3))

    def fallen(cells, axis):
        edges = np.diag((1.0, 1.0, 1.0))
        edges[axis, axis] = cells
        box = edges @ H
        sim = simulation(Spheres(np.vstack([x + k * H[axis] for k in range(cells)])), f"{TIGHT} {model}", fix=False,
                         boundary="p p p", box=[(0.0, float(box[d, d])) for d in range(3)], dt=1e-9,
                         tilt=[float(c) for c in (box[1, 0], box[2, 0], box[2, 1])] if tilt else None)
        sim.commands(pull(np.vstack([F] * cells)) + [MOVE]).run()
        return np.hstack([sim.v, sim.atom("omega")])

    one = fallen(1, 0)
    for axis in range(3):
        two = fallen(2, axis)
        assert np.abs(two - np.vstack([one, one])).max() < 2e-9 * np.abs(one).max()


@pytest.mark.parametrize("words", ["multiblob 12", "multiblob 42 half one_body no"])
@pytest.mark.parametrize("where", ["open", "periodic"])
def test_stress_under_loads_and_motion_in_a_strain_are_mutual(simulation, where, words):
    """The power of loads on what a strain does to velocities is that of the strain against the stress of these loads,
    with films, clumps and unlike radii. The sum of both stresses is linear in what causes it."""
    F, rate = np.random.default_rng(3).normal(size=(5, 3)), 1.4
    shear = f"fix shear all deform 1 xy erate {rate} remap none"

    def answer(F, lines):
        """Velocities less those of the fluid, and P_xy V of all spheres"""
        box, flow = dict(BOXES[where][1]), "variable u atom 0"
        if where == "periodic":
            box["tilt"], fluid = (0.0, 0.0, 0.0), "box"
        else:
            fluid, flow = "v_u 0 0", f"variable u atom {rate if lines else 0.0}*y"
        sim = simulation(Spheres(X, (1, 1, 1, 0.9, 0.7), molecule=MOLECULE), f"{TIGHT} {words} rigid_clumps yes "
                         f"fluid_velocity {fluid}", fix=False, dt=1e-9, before_pair=flow, **box)
        sim.commands(["neigh_modify exclude molecule/intra all"] + pull(F) + [MOVE] +
                     [shear] * (where == "periodic" and lines) +
                     ["compute S all stokes_dynamics/stress", "dump d all custom 1 /dev/null c_S[1]"]).run()
        rows = np.array(sim.lmp.numpy.extract_compute("S", 1, 2))[:sim.n]
        return sim.fix_rows("move")[:, :3], rows[:, 3].sum() + rows[:, 9].sum()

    _, loaded = answer(F, False)
    carried, strained = answer(0 * F, True)
    both, sum_of_both = answer(F, True)
    assert loaded * rate == pytest.approx((F * carried).sum(), rel=1e-7)
    assert sum_of_both == pytest.approx(loaded + strained, rel=1e-7)


@pytest.mark.parametrize("words, lines", [("", [f"{MOVE} torque all 0.3 0 2.0"]),
                                          ("add_force yes", ["fix move all nve/sphere", "set group all omega 0.3 0 0.4",
                                                             "set atom 1 omega 0.1 0.2 0.7"])])
def test_stress_of_friction_is_symmetric(simulation, words, lines):
    """Two spheres in touch along x: the virial of LAMMPS is x F_y where the stress has half of it; torques of the fluid
    and of the keyword are no part of this."""
    pair = f"stokes_dynamics cut_off_distance inf visc 1.3 multiblob 12 relative_tolerance 1e-6 {words}"
    sim = simulation(Spheres([(3, 4, 4), (4.999, 4, 4)]),
                     [f"pair_style hybrid/overlay gran/hooke/history 1e4 NULL 0 NULL 0.5 0 {pair}",
                      "pair_coeff * * gran/hooke/history", "pair_coeff * * stokes_dynamics"], boundary="p p p",
                     box=[(0.0, 8.0)] * 3, fix=False, dt=1e-5, comm="comm_modify vel yes")
    sim.commands(lines + ["compute S all stokes_dynamics/stress", "compute P all pressure NULL pair",
                          "thermo_style custom step c_S[16] c_P[4]", "thermo 20"]).run(20)
    S, P = sim.compute_vector("S", 18)[12:], sim.compute_vector("P", 6)
    assert abs(P[3]) > 1e-6
    assert S[3:5] == pytest.approx(P[3:5] / 2, abs=2e-3 * np.abs(P[3:]).max())
    assert np.abs(S[:3] - P[:3]).max() < 1e-12 * np.abs(P).max()
