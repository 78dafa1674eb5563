"""Directions (mu of atom_style dipole, quaternions of atom_style ellipsoid, turns of clumps) turn with their spheres
and clumps in fix stokes_dynamics/overdamped: closed forms, orders, noise, clumps, one run on several ranks and in
pieces, and what is refused."""
import functools
import os

import numpy as np
import pytest

import model
from brownian import A, ETA, KT, L_OF_FOUR, SHORT, TRIO, copies, check_covariance, end, in_pieces
from system import LammpsError, dump_lines
from test_loading import lammps_source

SPIN = 8 * np.pi * ETA * A**3
OPEN = [(-40.0, 40.0)] * 3
CENTRE = [(0.0, 0.0, 0.0)]
MOVE = "fix move all stokes_dynamics/overdamped"
POINTS, SHELLS = f"cut_off_distance inf visc {ETA} rotation yes", f"cut_off_distance inf visc {ETA} multiblob 12"
CLUMPS = f"{POINTS} rigid_clumps yes relative_tolerance 1e-10"


def dipole_lines(folder, x, mu, words, dt, molecule=0, boundary="f f f", box=None, tilt=None, quaternions=None):
    """Everything up to pair_coeff and the time step; quaternions [n,4] or none"""
    x, n = np.asarray(x, float), len(x)
    mu, molecule = np.broadcast_to(np.asarray(mu, float), (n, 3)), np.broadcast_to(molecule, (n,))
    lines = ["dipoles", "", f"{n} atoms", "1 atom types"]
    lines += [f"{float(lo)!r} {float(hi)!r} {c}lo {c}hi" for (lo, hi), c in zip(box or OPEN, "xyz")]
    lines += [f"{tilt} 0.0 0.0 xy xz yz"] if tilt is not None else []
    lines += ["", "Atoms", ""]
    for i in range(n):
        place, direction = (" ".join(repr(float(c)) for c in row) for row in (x[i], mu[i]))
        lines.append(f"{i + 1} 1 {place} {2 * A!r} 1.0 0.0 {direction} {molecule[i]}"
                     + (" 1" if quaternions is not None else ""))
    if quaternions is not None:
        lines[2:2] = [f"{n} ellipsoids"]
        lines += ["", "Ellipsoids", ""] + [f"{i + 1} {2 * A!r} {2 * A!r} {2 * A!r} " +
                                           " ".join(repr(float(c)) for c in q)
                                           for i, q in enumerate(quaternions)]
    data = os.path.join(str(folder), "dipoles.data")
    with open(data, "w") as out:
        out.write("\n".join(lines) + "\n")
    style = "hybrid sphere dipole molecular" + (" ellipsoid" if quaternions is not None else "")
    return ["units lj", f"atom_style {style}", f"boundary {boundary}", "atom_modify map array", "newton on",
            "plugin load stokesdynplugin.so", f"read_data {data}", f"pair_style stokes_dynamics {words}",
            "pair_coeff * *", "neigh_modify every 1 delay 0", f"timestep {float(dt)!r}"]


def dipoles(simulation, tmp_path, *arguments, **options):
    return simulation().commands(dipole_lines(tmp_path, *arguments, **options))


def directions(sim):
    rows = np.array(sim.lmp.numpy.extract_atom("mu", nelem=sim.n, dim=4))    # its own guess is two columns
    return rows[np.argsort(sim.ids()), :3]


def turned(e, w):
    """e [n,3] by the rotation vectors w [n,3]"""
    angle = np.linalg.norm(w, axis=-1, keepdims=True)
    axis = np.divide(w, angle, out=np.zeros_like(w), where=angle > 0)
    return (e * np.cos(angle) + np.cross(axis, e) * np.sin(angle)
            + axis * (axis * e).sum(axis=-1, keepdims=True) * (1 - np.cos(angle)))


# --- one sphere, where the answer is known ----------------------------------------------------------------------------

@pytest.mark.parametrize("scheme", ["euler", "ab2", "midpoint"])
@pytest.mark.parametrize("words", [POINTS, SHELLS])
def test_a_shear_turns_by_half_its_rate_and_keeps_the_length(simulation, tmp_path, words, scheme):
    """However long the step; a dipole of length 0 stays."""
    rate, steps, dt = 0.8, 50, 0.3
    x, mu = [(0, 0, 0), (3000, 0, 0)], 1.7 * np.array([(0.6, 0.0, 0.8), (0, 0, 0)])
    sim = dipoles(simulation, tmp_path, x, mu, f"{words} relative_tolerance 1e-10 fluid_velocity v_u 0 0", dt,
                  box=[(-4000.0, 4000.0)] * 3)
    sim.commands(f"variable u atom {rate}*z\n{MOVE} scheme {scheme}").run(steps)
    expected = turned(mu, np.array([(0, rate / 2 * steps * dt, 0)] * 2))
    assert np.abs(directions(sim) - expected).max() < 1e-9
    assert np.linalg.norm(directions(sim)[0]) == pytest.approx(1.7, rel=1e-14)
    assert not directions(sim)[1].any()


@pytest.mark.parametrize("scheme", ["ab2", "midpoint"])
def test_a_direction_that_is_set_between_runs_is_gone_on_from(simulation, tmp_path, scheme):
    sim = dipoles(simulation, tmp_path, CENTRE, (1, 0, 0), POINTS, 0.1).commands([f"{MOVE} scheme {scheme}"]).run(1)
    sim.commands(["set group all dipole 0 0 1", "run 1 pre no"])
    assert np.array_equal(directions(sim), [(0, 0, 1)])


@functools.lru_cache(maxsize=None)
def in_field_and_shear(t):
    """e(t) of a dipole (1, 0, 0) in a field along y and a flow that turns by 0.3 about x, by Runge and Kutta's
    method"""
    e, n = np.array((1.0, 0, 0)), 500
    def rate(e):
        return np.cross(np.array((0.3, 0, 0)) + np.cross(e, (0, 1.0, 0)), e)
    for _ in range(n):
        k1 = rate(e)
        k2 = rate(e + 0.5 * t / n * k1)
        k3 = rate(e + 0.5 * t / n * k2)
        e = e + t / n * (k1 + 2 * k2 + 2 * k3 + rate(e + t / n * k3)) / 6
    return e


@pytest.mark.parametrize("words, scheme, order", [(POINTS, "euler", 1), (POINTS, "ab2", 2), (POINTS, "midpoint", 2),
                                                  (SHELLS, "ab2", 2), (SHELLS, "midpoint", 2)])
def test_order_in_a_field_and_a_shear(simulation, tmp_path, words, scheme, order):
    errors = []
    for steps in (20, 40, 80):
        sim = dipoles(simulation, tmp_path, CENTRE, (1, 0, 0),
                      f"{words} relative_tolerance 1e-11 fluid_velocity 0 v_u 0", 2.0 / steps)
        sim.commands(f"variable u atom -0.6*z\nfix field all efield 0 {SPIN!r} 0\n{MOVE} scheme {scheme}").run(steps)
        errors.append(np.abs(directions(sim)[0] - in_field_and_shear(2.0)).max())
    assert np.log2(errors[1] / errors[2]) == pytest.approx(order, abs=0.2)
    assert errors[2] < (2e-2 if order == 1 else 1e-3)


def test_a_dipole_turns_into_the_field_as_its_law_says(simulation, tmp_path):
    """mu_y = tanh(t mu E/(8 pi eta a^3)), and the torque is that of the moment as it stands"""
    sim = dipoles(simulation, tmp_path, CENTRE, (1, 0, 0), POINTS, 1e-3)
    sim.commands(f"fix field all efield 0 {SPIN!r} 0\n{MOVE}").run(1000)
    assert directions(sim)[0] == pytest.approx([1 / np.cosh(1), np.tanh(1), 0], abs=1e-6)
    assert sim.atom("omega")[0, 2] == pytest.approx(1 / np.cosh(1), abs=1e-6)


def test_length_stays_in_a_long_run(simulation, tmp_path):
    sim = dipoles(simulation, tmp_path, CENTRE, (0.3, -0.2, 1.1), f"{POINTS} fluid_velocity v_u 0 0", 0.01,
                  box=[(-4000.0, 4000.0)] * 3)
    sim.commands(f"variable u atom z\nfix field all efield 0 0.3 {SPIN!r}\n{MOVE} temperature 0.1 5\nthermo 0").run(
        20000)
    assert np.linalg.norm(directions(sim)[0]) == pytest.approx(np.sqrt(0.09 + 0.04 + 1.21), rel=4e-16 * 4)


def test_in_a_box_that_shears(simulation, tmp_path):
    """A sphere that falls through a face that moves, and comes in at another place; its images do not turn it."""
    mu = np.array([(1.0, 0.3, 0.5)])
    sim = dipoles(simulation, tmp_path, CENTRE, mu, f"{POINTS} fluid_velocity box far_field_tolerance 1e-9", 0.02,
                  boundary="p p p", box=[(0.0, 12.0)] * 3, tilt=0.0)
    sim.commands(f"fix shear all deform 1 xy erate 0.5 remap v flip no\n{MOVE}\nfix fall all addforce 0 -90 0").run(40)
    assert 5 < sim.x[0, 1] < 11
    assert np.abs(directions(sim) - turned(mu, np.array([(0, 0, -0.25 * 0.8)]))).max() < 1e-8


@pytest.mark.parametrize("scheme", ["ab2", "midpoint"])
def test_held_and_spun_spheres_turn_as_told(simulation, tmp_path, scheme):
    """One is held and rests, fix move turns one, keyword spin turns another one; a neighbour pulls."""
    x, mu, dt = [(0, 0, 0), (3, 0, 0), (6, 0, 0), (9, 1, 0)], [(1, 0, 0.5)] * 4, 0.02
    sim = dipoles(simulation, tmp_path, x, mu, POINTS, dt)
    sim.commands("group one id 1\ngroup two id 2\ngroup fixed id 1 2\ngroup field id 3\nset group two omega 0 0 0.5\n"
                 f"fix turn two move rotate 3 0 0 0 0 1 {4 * np.pi!r}\n"
                 f"{MOVE} scheme {scheme} held fixed spin field 0.4 0 -1.1\nfix pull all addforce 0 3 0").run(30)
    w = np.array([(0, 0, 0), (0, 0, 0.5), (0.4, 0, -1.1)])
    assert np.abs(directions(sim)[:3] - turned(np.array(mu[:3]), 30 * dt * w)).max() < 1e-12
    assert np.abs(directions(sim)[3] - mu[3]).max() > 1e-3


# --- rigid clumps -----------------------------------------------------------------------------------------------------

def rotation_between(before, after):
    """Of clumps [n, m, 3] by their spheres (Kabsch)"""
    P, Q = (x - x.mean(axis=1, keepdims=True) for x in (before, after))
    U, _, V = np.linalg.svd(np.einsum("nmi,nmj->nij", Q, P))
    U[:, :, 2] *= np.linalg.det(U @ V)[:, None]
    return U @ V


@pytest.mark.parametrize("words, options", [(CLUMPS, "scheme euler"), (CLUMPS, "scheme ab2"),
                                            (CLUMPS, "scheme midpoint"),
                                            (CLUMPS + " clumps_only yes", f"temperature {KT} 7"),
                                            (CLUMPS, f"temperature {KT} 7"),
                                            (f"{SHELLS} rigid_clumps yes", f"temperature {KT} 7"),
                                            (f"{SHELLS} rigid_clumps yes", "")])
def test_directions_of_a_clump_turn_with_it(simulation, tmp_path, words, options):
    clumps = copies(L_OF_FOUR, 3, 6.0)
    mu = np.random.default_rng(3).normal(size=(12, 3))
    sim = dipoles(simulation, tmp_path, clumps.x, mu, f"{words} fluid_velocity v_u 0 0", 0.05, molecule=clumps.molecule)
    before = sim.x.reshape(3, 4, 3)
    sim.commands(f"variable u atom z\n{MOVE} {options}\nfix field all efield 0 2 0\nfix pull all addforce 0 -3 0").run(
        60)
    R = rotation_between(before, sim.x.reshape(3, 4, 3))
    assert np.abs(R - np.eye(3)).max() > 0.3
    assert np.abs(directions(sim) - np.einsum("nij,nmj->nmi", R, mu.reshape(3, 4, 3)).reshape(-1, 3)).max() < 1e-12


# --- quaternions, and the turn of a clump -----------------------------------------------------------------------------

QUATERNIONS = "compute q all property/atom quatw quati quatj quatk"


def quaternions(sim):
    rows = np.array(sim.lmp.numpy.extract_compute("q", 1, 2))[:sim.n]
    return rows[np.argsort(sim.ids())]


def rotation(q):
    """Matrices [n,3,3] of unit quaternions [n,4]"""
    w, v = q[:, :1, None], q[:, 1:]
    cross = np.zeros((len(q), 3, 3))
    for k in range(3):
        cross[:, :, k] = np.cross(v, np.eye(3)[k])
    return (2 * w**2 - 1) * np.eye(3) + 2 * w * cross + 2 * v[:, :, None] * v[:, None, :]


def some_quaternions(n, seed=21):
    q = np.random.default_rng(seed).normal(size=(n, 4))
    return q / np.linalg.norm(q, axis=1)[:, None]


QUAT_WAYS = {"euler": (POINTS, "scheme euler", 0, ""), "ab2": (POINTS, "scheme ab2", 0, ""),
             "midpoint": (SHELLS, "", 0, ""), "noise": (POINTS, f"temperature {KT} 7", 0, ""),
             "shells with noise": (SHELLS, f"temperature {KT} 7", 0, ""),
             "spin": (POINTS, "spin all 0.4 0 -1.1", 0, ""),
             "held": (POINTS, "held all", 0, "fix turn all move rotate 3 0 0 0 0.6 0.8 {:.17g}"),
             "held with midpoint": (POINTS, "scheme midpoint held all", 0,
                                    "fix turn all move rotate 3 0 0 0 0.6 0.8 {:.17g}"),
             "clumps": (CLUMPS, "", [1, 1, 1, 1, 2, 2, 2, 2, 0, 0, 0, 0], ""),
             "held clumps": (CLUMPS, "held all", [1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3],
                             "fix turn all move rotate 3 0 0 0 0.6 0.8 {:.17g}")}


@pytest.mark.parametrize("way", QUAT_WAYS)
def test_quaternions_turn_as_dipoles_do(simulation, tmp_path, way):
    """Dipoles in any direction are fixed in the axes that quaternions say, and these keep their length."""
    words, options, molecule, more = QUAT_WAYS[way]
    x, mu, q = copies(L_OF_FOUR, 3, 6.0).x, np.random.default_rng(3).normal(size=(12, 3)), some_quaternions(12)
    sim = dipoles(simulation, tmp_path, x, mu, f"{words} fluid_velocity v_u 0 0", 0.05, molecule=molecule,
                  quaternions=q)
    period = 4.0
    sim.commands(f"variable u atom z\n{more.format(period)}\nset group all omega 0 {0.6 * 2 * np.pi / period!r} "
                 f"{0.8 * 2 * np.pi / period!r}\n"
                 f"{MOVE} {options}\nfix field all efield 0 2 0\nfix pull all addforce 0 -3 0\n{QUATERNIONS}\n"
                 "fix read all ave/atom 1 1 1 c_q[*]").run(60)
    now = quaternions(sim)
    turn = rotation(now) @ rotation(q).transpose(0, 2, 1)
    assert np.abs(turn - np.eye(3)).max(axis=(1, 2)).min() > 0.3
    assert np.abs(directions(sim) - np.einsum("nij,nj->ni", turn, mu)).max() < 2e-12
    assert np.abs(np.linalg.norm(now, axis=1) - 1).max() < 1e-15


@pytest.mark.parametrize("words, options", [(CLUMPS, ""), (CLUMPS, "scheme midpoint"),
                                            (CLUMPS + " clumps_only yes", f"temperature {KT} 7"),
                                            (f"{SHELLS} rigid_clumps yes", f"temperature {KT} 7")])
def test_the_fix_tells_how_a_clump_has_turned(simulation, tmp_path, words, options):
    """Columns 10 to 13: by the same quaternion as its spheres; 1 before the first step; 0 of free spheres"""
    x = copies(L_OF_FOUR, 3, 6.0).x
    sim = dipoles(simulation, tmp_path, x, (0, 0, 1), f"{words} fluid_velocity v_u 0 0", 0.05,
                  molecule=[1, 1, 1, 1, 2, 2, 2, 2, 0, 0, 0, 0])
    sim.commands(f"variable u atom z\n{MOVE} {options}\nfix pull all addforce 0 -3 0").run(0)
    assert (sim.fix_rows("move")[:, 9:13] == [[1, 0, 0, 0]] * 8 + [[0, 0, 0, 0]] * 4).all()
    before = sim.x[:8].reshape(2, 4, 3)
    sim.run(40).run(20)
    turned_by = sim.fix_rows("move")[:, 9:13]
    R = rotation_between(before, sim.x[:8].reshape(2, 4, 3))
    assert np.abs(R - np.eye(3)).max() > 0.3
    assert np.abs(rotation(turned_by[:8]).reshape(2, 4, 3, 3) - R[:, None]).max() < 1e-12
    assert not turned_by[8:].any()


@pytest.mark.nothing_to_test_if(lammps_source(), "LAMMPS of 2021 has no atom style with a quaternion for each atom")
def test_quaternions_of_bonded_particles_turn_and_drive_their_bonds(simulation, tmp_path):
    """atom_style bpm/sphere: steadily under a torque along its own axes; and bpm/rotational pulls back two that have
    turned apart."""
    def two(bonds, options):
        sim = simulation().commands(
            "units lj\natom_style bpm/sphere\nboundary f f f\natom_modify map array\nnewton on off\n"
            "plugin load stokesdynplugin.so\n"
            "special_bonds lj 0 1 1 coul 1 1 1\nregion box block -20 20 -20 20 -20 20\n"
            "create_box 1 box bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4\n"
            f"create_atoms 1 single 0 0 0\ncreate_atoms 1 single {2 * A!r} 0 0\n"
            f"set group all diameter {2 * A!r} density 1\n"
            f"comm_modify vel yes cutoff 6\npair_style stokes_dynamics {POINTS}\npair_coeff * *\n{bonds}\n"
            "timestep 1e-3\n"
            f"group first id 1\n{QUATERNIONS}\nfix read all ave/atom 1 1 1 c_q[*]\n{MOVE} {options}")
        return sim
    sim = two("", f"torque first 0 0 {SPIN!r} body yes")
    sim.run(500)
    q = quaternions(sim)
    # the other one in its flow
    assert q[0] == pytest.approx([np.cos(0.25), 0, 0, np.sin(0.25)], abs=1e-3) and abs(q[1, 3]) > 1e-3
    bonds = ("bond_style bpm/rotational smooth no\nbond_coeff 1 20 20 20 20 1e6 1e6 1e6 1e6 0 0 0 0\n"
             "create_bonds single/bond 1 1 2")
    free = two("", "torque first 0 0 1").run(200).atom("omega")[0, 2]
    bound = two(bonds, "torque first 0 0 1").run(2000).atom("omega")
    assert abs(bound[0, 2]) < 0.5 * free and bound[0, 2] == pytest.approx(bound[1, 2], rel=0.05)


# --- noise ------------------------------------------------------------------------------------------------------------

def steps_and_turns(sim, steps):
    """Displacements and changes of direction [steps, n, 6] of single steps"""
    out = []
    for k in range(steps):
        before = np.hstack([sim.x, directions(sim)])
        sim.run(1, "pre no post no" if k else "post no")
        out.append(np.hstack([sim.x, directions(sim)]) - before)
    return np.array(out)


@pytest.mark.parametrize("scene, words", [("open", ""), ("alone", "clumps_only yes"),
                                          ("periodic", "far_field_tolerance 1e-5")])
def test_translation_and_rotation_are_drawn_together(simulation, tmp_path, scene, words):
    """Covariance of steps d and turns w x e of three near spheres against their mobility, in a box by unit loads"""
    e = np.array([(1.0, 0, 0), (0, 1.0, 0), (0.6, 0, 0.8)])
    K = np.zeros((18, 18))
    for i in range(3):
        at = 6 * i
        K[at:at + 3, at:at + 3] = np.eye(3)
        K[at + 3:at + 6, at + 3:at + 6] = np.cross(np.eye(3), e[i]).T
    box = dict(boundary="p p p", box=[(-2.0, 3.5)] * 3) if scene == "periodic" else {}
    def begin(options, dt):
        return dipoles(simulation, tmp_path, TRIO, e, f"{POINTS} {words}", dt, **box).commands(f"{MOVE} {options}")
    if scene == "alone":
        M = np.diag(([1 / (6 * np.pi * ETA * A)] * 3 + [1 / SPIN] * 3) * 3)
    elif scene == "open":
        M = model.mobility(TRIO, np.full(3, A), ETA, rotation=True)
    else:
        M = np.zeros((18, 18))
        sim = begin("", 1e-9)
        sim.command("fix load all external pf/callback 1 1")
        for k in range(18):
            def add(_lmp, _step, n, tag, _x, f, k=k):
                rows = np.asarray(tag).ravel()[:n] == k // 6 + 1
                f[:] = 0
                if k % 6 < 3:
                    f[rows, k % 6] = 1
                else:
                    sim.raw("torque")[:n][rows, k % 6 - 3] += 1
            sim.lmp.set_fix_external_callback("load", add)
            sim.run(0)
            M[:, k] = np.hstack([sim.v, sim.atom("omega")]).ravel()
        assert np.abs(M - M.T).max() < 1e-4 * M.max()
    d = steps_and_turns(begin(f"temperature {KT} 12345", SHORT), 1500).reshape(-1, 18)
    d -= d.mean(axis=0)
    expected = K @ M @ K.T
    seen = np.diag(expected) > 1e-12 * expected.max()
    check_covariance(d[:, seen], expected[np.ix_(seen, seen)], SHORT)


def test_memory_of_a_direction_decays_as_debye_says(simulation, tmp_path):
    """<e(0).e(t)> = exp(-2 D t) of 4000 points, each alone; the steps are seen as D dt/6, 0.4 % here."""
    D, n, steps = KT / SPIN, 4000, 20
    mu = np.random.default_rng(5).normal(size=(n, 3))
    mu /= np.linalg.norm(mu, axis=1)[:, None]
    x = copies(np.zeros((1, 3)), n, 4.0).x
    sim = dipoles(simulation, tmp_path, x, mu, f"{POINTS} clumps_only yes", 0.5 / D / steps, box=[(-60.0, 120.0)] * 3)
    sim.commands(f"{MOVE} temperature {KT} 4711").run(steps)
    assert (directions(sim) * mu).sum(axis=1).mean() == pytest.approx(np.exp(-1), abs=4 * 0.48 / np.sqrt(n) + 3e-3)


@pytest.mark.parametrize("words", [POINTS, SHELLS])
def test_active_particles_far_apart_turn_as_free_ones(simulation, tmp_path, words):
    """fix propel/self pushes along the direction. Squares of the steps of e, 2 (1 - exp(-2 D dt)) each."""
    D, push, n, steps = KT / SPIN, 2.0, 27, 60
    tau = 0.005
    mu = np.random.default_rng(6).normal(size=(n, 3))
    mu /= np.linalg.norm(mu, axis=1)[:, None]
    x = copies(np.zeros((1, 3)), n, 14.0).x - 14.0
    sim = dipoles(simulation, tmp_path, x, mu, words, tau / D)
    sim.commands(f"fix push all propel/self dipole {push}\n{MOVE} temperature {KT} 4711").run(0)
    assert np.abs(sim.f - push * mu).max() < 1e-12
    d = steps_and_turns(sim, steps)[:, :, 3:]
    assert (d**2).sum(axis=2).mean() == pytest.approx(2 * (1 - np.exp(-2 * tau)), rel=4.5 / np.sqrt(n * steps) + 0.01)


def test_langevin_of_dipoles_in_a_field(simulation, tmp_path):
    """<cos> = coth 2 - 1/2 where mu E is 2 kT"""
    n, D = 2000, KT / SPIN
    x = copies(np.zeros((1, 3)), n, 4.0).x
    mu = np.random.default_rng(8).normal(size=(n, 3))
    mu /= np.linalg.norm(mu, axis=1)[:, None]
    sim = dipoles(simulation, tmp_path, x, mu, f"{POINTS} clumps_only yes", 0.02 / D, box=[(-60.0, 120.0)] * 3)
    sim.commands(f"fix field all efield 0 0 {2 * KT!r}\n{MOVE} temperature {KT} 99").run(120)
    assert directions(sim)[:, 2].mean() == pytest.approx(1 / np.tanh(2) - 0.5, abs=4 * 0.43 / np.sqrt(n))


# --- one run, however it is made --------------------------------------------------------------------------------------

COLUMNS = ("xu yu zu mux muy muz " + " ".join(f"c_q[{k}]" for k in range(1, 5)) + " " +
           " ".join(f"f_move[{k}]" for k in range(10, 14)))
END = [QUATERNIONS] + dump_lines("end.dump", every=20, columns=COLUMNS)
WAYS = {"noise in shear": ("p p p", f"{POINTS} fluid_velocity box", "temperature 1.5 7", 0,
                           ["fix shear all deform 1 xy erate 0.5 remap v"]),
        "shells with noise": ("f f f", SHELLS, "temperature 1.5 7", 0, []),
        "clumps": ("f f f", CLUMPS, "scheme ab2", [1, 1, 1, 1, 2, 2, 2, 2, 0, 0, 0, 0], [])}


def script(folder, way, runs):
    boundary, words, options, molecule, more = WAYS[way]
    x = copies(L_OF_FOUR, 3, 5.0).x + 1.0
    mu = np.random.default_rng(9).normal(size=(12, 3))
    box = [(0.0, 12.0)] * 3 if boundary[0] == "p" else None
    lines = dipole_lines(folder, x, mu, words, 0.02, molecule=molecule, boundary=boundary, box=box,
                         tilt=0.0 if box else None, quaternions=some_quaternions(12))
    return lines + ["fix field all efield 0 4 1", "fix push all propel/self dipole 2.0", *more,
                    f"{MOVE} {options}"] + runs


@pytest.mark.ranks(2)
@pytest.mark.parametrize("way", WAYS)
def test_ranks_agree(tmp_path, way):
    one = end(tmp_path, script(tmp_path, way, END + ["run 20"]))
    two = end(tmp_path, script(tmp_path, way, END + ["run 20"]), 2)
    start = np.random.default_rng(9).normal(size=(12, 3))
    assert np.abs(one[:, 3:6] - start).max() > 0.1
    assert np.abs(one[:, 6:10] - some_quaternions(12)).max() > 0.05
    assert np.abs(one - two).max() < 1e-12


@pytest.mark.parametrize("way", WAYS)
def test_a_run_in_pieces_is_the_whole_run(tmp_path, way):
    whole, two, again = in_pieces(tmp_path, lambda runs: script(tmp_path, way, runs), END)
    assert np.abs(two - whole).max() < 1e-12
    assert np.abs(again - whole).max() < 1e-12


# --- what is refused --------------------------------------------------------------------------------------------------

def test_directions_of_spheres_that_do_not_turn_are_refused(simulation, tmp_path):
    sim = dipoles(simulation, tmp_path, CENTRE, (1, 0, 0), f"cut_off_distance inf visc {ETA}", 0.1)
    with pytest.raises(LammpsError,
                       match="has directions .the dipole of atom 1.*with rotation no spheres do not turn: use"):
        sim.commands(MOVE).run(0)
    sim = dipoles(simulation, tmp_path, CENTRE, (0, 0, 0), f"cut_off_distance inf visc {ETA}", 0.1)
    sim.commands(MOVE).run(1)
