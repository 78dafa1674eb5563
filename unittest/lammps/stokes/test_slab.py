"""Boxes that are periodic in two directions, through LAMMPS: above a floor, in a slit, in an open layer. Against sums
in another code, closed forms, and themselves."""
import csv
import functools
import os

import numpy as np
import pytest

import model
from host import by_open_mpi
from same_end import same_end_on_ranks
from system import LammpsError, Spheres, from_restart, input_lines, lmp
from test_wall import pull

ETA = 1 / (6 * np.pi)                    # 6 pi eta = 1
MOVE = "fix move all stokes_dynamics/overdamped"
STYLE = f"cut_off_distance inf visc {ETA!r} far_field_tolerance 1e-12 relative_tolerance 1e-10"


def scenes():
    """{name: rows} of slab/scenes.csv"""
    of = {}
    for row in csv.DictReader(line for line in open(os.path.join(model.DATA, "slab", "scenes.csv"))
                              if not line.startswith("#")):
        of.setdefault(row["scene"], []).append(row)
    return of


def numbers(rows, names):
    return np.array([[float(row[c]) for c in names.split()] for row in rows])


def words_of(row):
    """Of the pair style, and the box"""
    H = float(row["H"] or 0)
    walls = {"open": "", "wall": "wall zlo 0",
             "slit": f"wall zlo 0 zhi {H!r} flow {row['convention']}"}[row["geometry"]]
    return walls, [(0.0, float(row["Lx"])), (0.0, float(row["Ly"])), (-1.0, (H or 45.0) + 1.0)]


def fall(simulation, spheres, F, style, box, boundary="p p f", steps=0, dt=1e-9, **options):
    sim = simulation(spheres, style, fix=False, dt=dt, box=box, boundary=boundary, **options)
    return sim.commands(pull(np.broadcast_to(np.array(F, float), spheres.x.shape)) + [MOVE]).run(steps)


def output(sim, k):
    """Value k of the fix that moves"""
    return sim.lmp.extract_fix("move", 0, 1, nrow=k - 1)


@pytest.mark.parametrize("name", scenes())
def test_velocities_are_those_of_another_code(simulation, name):
    rows = scenes()[name]
    walls, box = words_of(rows[0])
    spheres = Spheres(numbers(rows, "x y z"), numbers(rows, "a")[:, 0])
    sim = fall(simulation, spheres, numbers(rows, "Fx Fy Fz"), f"{STYLE} {walls}".replace(repr(ETA), "1"), box)
    U = numbers(rows, "Ux Uy Uz")
    assert sim.v == pytest.approx(U, abs=1e-10 * np.abs(U).max())


# --- against closed forms and other codes -----------------------------------------------------------------------------

def cell(L, lo=-1.0, hi=60.0):
    return [(0.0, float(L)), (0.0, float(L)), (float(lo), float(hi))]


# Of one sphere of one point in a cell L x L, over 1/(6 pi eta a): along, across, by another code
@pytest.mark.parametrize("walls, z, L, along, across", [
    ("wall zlo 0", 1.0, 8, 0.573400, 0.247089), ("wall zlo 0", 1.5, 4, 1.617393, 0.2730165428),
    ("wall zlo 0", 1.0, 32, 0.501234, 0.249996), ("wall zlo 0 zhi 4", 2.0, 4, 1.031874, 0.291052),
    ("wall zlo 0 zhi 4 flow flux", 2.0, 4, 0.289428, 0.291052), ("wall zlo 0 zhi 4", 2.0, 16, 0.568103, 0.366159)])
def test_a_lone_sphere_in_a_cell(simulation, walls, z, L, along, across):
    for F, d, U in (((1, 0, 0), 0, along), ((0, 0, 1), 2, across)):
        sim = fall(simulation, Spheres([(0.3, 0.2, z)]), F, f"{STYLE} {walls}", cell(L))
        assert sim.v[0, d] == pytest.approx(U, abs=1e-6)


# Square layers that are pushed along and down, of an area fraction, by another code
@pytest.mark.parametrize("spacing, along, down", [(3.963327, 1.003626165, 0.200929885),
                                                  (2.802496, 1.712828339, 0.125531476)])
def test_a_layer_on_the_floor(simulation, spacing, along, down):
    for F, d, U in (((1, 0, 0), 0, along), ((0, 0, 1), 2, down)):
        sim = fall(simulation, Spheres([(0, 0, 1.0)]), F, f"{STYLE} wall zlo 0", cell(spacing))
        assert sim.v[0, d] == pytest.approx(U, abs=2e-6)


# A shell of 12 points with the films of both walls against the exact sphere (mobilities across and along, free to
# turn). In a wide square cell the flows with and without pressure gradient differ from the lone sphere by the same,
# with opposite signs.
@pytest.mark.parametrize("H, z, across, along, off", [(2.2, 1.1, 0.047549, 0.253454, 0.036),
                                                      (2.5, 1.25, 0.113121, 0.331195, 0.012),
                                                      (4, 2.0, 0.358527, 0.541784, 0.004),
                                                      (10, 2.5, 0.564226, 0.744783, 0.003),
                                                      (10, 5.0, 0.715889, 0.802444, 0.003)])
def test_a_shell_with_films_in_a_slit(simulation, H, z, across, along, off):
    style = (f"cut_off_distance inf visc {ETA!r} multiblob 12 lubrication yes lubrication_gap 1e-6 relative_tolerance "
             f"1e-5 wall zlo 0 zhi {H}")
    box = cell(6 * H + 12, -1, H + 1)
    v = [fall(simulation, Spheres([(0.3, 0.2, z)]), F, f"{style} {flow}", box).v[0]
         for F, flow in (((0, 0, 1), ""), ((1, 0, 0), "flow pressure"), ((1, 0, 0), "flow flux"))]
    assert v[0][2] == pytest.approx(across, rel=off)
    assert 0.5 * (v[1][0] + v[2][0]) == pytest.approx(along, rel=off)


def test_a_bead_in_a_slit_moves_as_faxen_says(simulation):
    """In the middle; his series is good to 5e-4 at 10 radii."""
    H, s = 10.0, 1 / 5.0
    faxen = 1 - 1.004 * s + 0.418 * s ** 3 + 0.21 * s ** 4 - 0.169 * s ** 5
    assert faxen == pytest.approx(0.802826, abs=1e-3)
    v = [fall(simulation, Spheres([(0, 0, 5)]), (1, 0, 0),
              f"cut_off_distance inf visc {ETA!r} multiblob 12 wall zlo 0 zhi 10 flow {flow} "
              "relative_tolerance 1e-5", cell(80, -1, 11)).v[0, 0] for flow in ("pressure", "flux")]
    assert 0.5 * (v[0] + v[1]) == pytest.approx(faxen, abs=1e-3)


def test_a_sphere_swims_along_in_a_poiseuille_flow(simulation):
    """Without a force: with the mean of the stream over its surface, z (H - z) - a^2/3"""
    style = f"{STYLE} wall zlo 0 zhi 5 fluid_velocity v_u 0 0"
    sim = fall(simulation, Spheres([(1, 2, 1.7)]), (0, 0, 0), style, cell(12, -1, 6),
               before_pair="variable u atom z*(5-z)")
    assert sim.v[0] == pytest.approx((1.7 * 3.3, 0, 0), abs=1e-9)


@pytest.mark.parametrize("formula, told", [("0.3*z", False), ("0.3*z*y", True)])
def test_a_stream_needs_no_period_across_the_walls(simulation, tmp_path, formula, told):
    lines = input_lines(Spheres([(1, 2, 1.7)]), f"{STYLE} wall zlo 0 fluid_velocity v_u 0 0", str(tmp_path / "data"),
                        fix=False, box=cell(12), boundary="p p f", before_pair=f"variable u atom {formula}")
    assert ("does not have the period of the box" in lmp(tmp_path, lines + [MOVE, "run 0"]).log) == told


# --- one scene, in other ways -----------------------------------------------------------------------------------------

def heap(n=14, H=6.0, L=11.0, seed=7, clumps=True):
    """Spheres of unlike radii between 0 and H that do not overlap much; one cuts the floor; a rigid doublet"""
    rng, x, a = np.random.default_rng(seed), [], []
    while len(x) < n:
        r = np.exp(rng.uniform(-0.6, 0.1))
        p = np.array([*rng.uniform(0, L, 2), rng.uniform(1.03 * r, H - 1.03 * r)])
        d = [p - q for q in x]
        if all(np.linalg.norm([*((e[:2] + L / 2) % L - L / 2), e[2]]) > 1.02 * (r + b) for e, b in zip(d, a)):
            x.append(p)
            a.append(r)
    x, a = np.array(x), np.array(a)
    return Spheres(x, a, molecule=0), rng.normal(size=(n, 3))


FLOOR, SLIT = "wall zlo 0", "wall zlo 0 zhi 6 flow flux"
WAYS = {"floor": FLOOR, "slit": SLIT, "shells in a slit": f"{SLIT} multiblob 12 lubrication yes",
        "clumps in a slit": f"{SLIT} multiblob 12 lubrication yes rigid_clumps yes"}


@pytest.mark.parametrize("walls", [FLOOR, SLIT])
@pytest.mark.parametrize("algorithm", ["algorithm 1", "algorithm 2", "algorithm 2 precondition clump"])
def test_forces_for_given_velocities_are_the_inverse(simulation, walls, algorithm):
    spheres, F = heap()
    style = f"cut_off_distance inf visc 1 far_field_tolerance 1e-9 relative_tolerance 1e-11 max_iter 300 {walls}"
    v = fall(simulation, spheres, F, style, cell(11, -1, 9)).v
    sim = simulation(Spheres(spheres.x, spheres.a, v), f"{style} {algorithm}", box=cell(11, -1, 9),
                     boundary="p p f").run()
    assert sim.drag == pytest.approx(-F, abs=1e-7)


def test_drags_of_shells_are_the_inverse_too(simulation):
    spheres, F = heap(4)
    style = ("cut_off_distance inf visc 1 multiblob 12 lubrication yes relative_tolerance 1e-8 far_field_tolerance "
             f"1e-8 max_iter 300 {SLIT}")
    moving = fall(simulation, spheres, F, style, cell(11, -1, 9))
    v, omega = moving.v, moving.atom("omega")
    sim = simulation(Spheres(spheres.x, spheres.a, v), style, box=cell(11, -1, 9), boundary="p p f")
    for i, w in enumerate(omega):
        sim.set("omega", i + 1, w)
    assert sim.run().drag == pytest.approx(-F, abs=1e-4)


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("walls", ["lo", "hi", "both", ""])
def test_walls_may_stand_at_any_side(simulation, axis, walls):
    """The scene and its box turned; below a ceiling it hangs upside down."""
    spheres, F = heap()
    F[:, :2] -= F[:, :2].mean(axis=0)
    sign = -1 if walls == "hi" else 1
    names = {"lo": f"wall {{}}lo {-0.5!r}", "hi": "wall {}hi 0.5", "both": f"wall {{0}}lo -0.5 {{0}}hi 5.5",
             "": ""}[walls]
    expected = fall(simulation, spheres, F,
                    f"{STYLE} {dict(lo=FLOOR, hi=FLOOR, both='wall zlo 0 zhi 6').get(walls, '')}".replace(
                        "1e-12", "1e-6"),
                    cell(11, -9, 9)).v
    order = [(d - axis - 1) % 3 for d in range(3)]      # component d is that one of the scene
    shift = [-0.5 * sign if d == axis else 0.0 for d in range(3)]
    scene = Spheres(np.array([(sign if o == 2 else 1) * spheres.x[:, o] for o in order]).T + shift, spheres.a)
    box = [(-9.0, 9.0) if d == axis else (0.0, 11.0) for d in range(3)]
    sim = fall(simulation, scene, np.array([(sign if o == 2 else 1) * F[:, o] for o in order]).T,
               f"{STYLE} {names.format('xyz'[axis])}".replace("1e-12", "1e-6"), box,
               " ".join("f" if d == axis else "p" for d in range(3)))
    got = np.array([(sign if o == 2 else 1) * sim.v[:, d]
                    for d, o in sorted(enumerate(order), key=lambda pair: pair[1])]).T
    assert got == pytest.approx(expected, abs=1e-9 * np.abs(expected).max())


def test_edges_of_the_box_are_positions(simulation):
    spheres, F = heap()
    box = [(0.0, 11.0), (0.0, 11.0), (-0.25, 6.5)]
    edge, at = (fall(simulation, spheres, F, f"cut_off_distance inf visc 1 wall {where}", box).v
                for where in ("zlo EDGE zhi EDGE", "zlo -0.25 zhi 6.5"))
    assert (edge == at).all()


def script(folder, way, runs, newton="on", begin=None):
    spheres, _ = heap(6 if "multiblob" in WAYS[way] else 14)
    if "clumps" in way:
        spheres.x[1], spheres.a[1] = spheres.x[0] + (0.9 * spheres.a[0], 0, 0), spheres.a[0]
        spheres.molecule[:2] = 1
    pair = f"cut_off_distance inf visc 1 {WAYS[way]} relative_tolerance 1e-12 far_field_tolerance 1e-3 max_iter 400"
    lines = input_lines(spheres, pair, str(folder / "heap.data"), boundary="p p f", fix=False, dt=0.02, newton=newton,
                        box=cell(11, -1, 9))
    if begin:
        lines = [line for line in from_restart(lines, begin) if not line.startswith("pair_")]
    return lines + ["variable fx atom 2*sin(id)", "fix weight all addforce v_fx 0 -1", MOVE] + runs


@pytest.mark.parametrize("way", by_open_mpi(WAYS))
def test_ranks_newton_and_restart_do_not_matter(tmp_path, way):
    same_end_on_ranks(tmp_path, functools.partial(script, tmp_path, way), 8,
                      "xu yu zu vx vy vz omegax omegay omegaz", before_restart=3)


def test_a_layer_moves_by_forces_that_add_up_to_0(simulation):
    """Its mean flow is 0 far away; a force across it needs no counterpart."""
    spheres, F = heap()
    F[:, :2] -= F[:, :2].mean(axis=0)
    low, high = (fall(simulation, Spheres(spheres.x + (0, 0, up), spheres.a), F, STYLE, cell(11, -99, 99)).v
                 for up in (0, 31.7))
    assert low == pytest.approx(high, abs=1e-9)
    floor = fall(simulation, Spheres(spheres.x + (0, 0, 60), spheres.a), F, f"{STYLE} {FLOOR}", cell(11, -1, 99)).v
    drift = ((spheres.x[:, 2] + 60)[:, None] * F[:, :2]).sum(axis=0) / (2 * ETA * 121)
    assert floor[:, :2] - drift == pytest.approx(low[:, :2], abs=1e-8)
    assert floor[:, 2] == pytest.approx(low[:, 2], abs=1e-8)


def test_a_roller_in_a_wide_cell_rolls_as_in_open_fluid(simulation):
    """What the images of a roller at the floor do falls with the third power of the distance."""
    style = f"cut_off_distance inf visc {ETA!r} multiblob 12 lubrication yes relative_tolerance 1e-6 {FLOOR}"
    v = []
    for boundary in ("f f f", "p p f"):
        sim = simulation(Spheres([(1, 1, 1.1)]), style, fix=False, dt=1e-9,
                         box=[(-30.0, 30.0), (-30.0, 30.0), (-1.0, 30.0)], boundary=boundary)
        v.append(sim.commands([f"{MOVE} spin all 0 1 0"]).run().v[0].copy())
    assert v[0][0] > 0.02
    assert v[1] == pytest.approx(v[0], abs=0.01 * v[0][0])


def matrix(simulation, x, style, box):
    """Velocities of unit forces"""
    M = np.empty((3 * len(x), 3 * len(x)))
    for k in range(3 * len(x)):
        M[:, k] = fall(simulation, Spheres(x), np.eye(3 * len(x))[k].reshape(-1, 3), style, box).v.ravel()
    return M


@pytest.mark.parametrize("walls", [FLOOR, "wall zlo 0 zhi 3.5"])
def test_a_held_sphere_is_in_the_way(simulation, walls):
    x, style = [(1.0, 1.0, 1.2),
                (3.1, 1.0,
                 1.9)], f"cut_off_distance inf visc {ETA!r} relative_tolerance 1e-10 far_field_tolerance 1e-9 {walls}"
    M = matrix(simulation, x, style, cell(8, -1, 4))
    sim = simulation(Spheres(x), style, fix=False, dt=1e-9, box=cell(8, -1, 4), boundary="p p f")
    sim.commands(["group still id 2", "group free id 1", "fix pull free addforce 0.3 0.5 -1",
                  f"{MOVE} held still"]).run()
    free = (M[:3, :3] - M[:3, 3:] @ np.linalg.solve(M[3:, 3:], M[3:, :3])) @ (0.3, 0.5, -1)
    assert sim.v == pytest.approx(np.array([free, (0, 0, 0)]), abs=1e-8)


def test_a_slit_upside_down_takes_as_many_products(simulation):
    """A body is preconditioned by the wall that it is near to."""
    style = f"cut_off_distance inf visc {ETA!r} multiblob 12 lubrication yes relative_tolerance 1e-8 wall zlo 0 zhi 6"
    low, high = (output(fall(simulation, Spheres([(1, 1, z), (6, 3, z)]), (0.4, 0, 1), style, cell(11, -1, 9)), 4)
                 for z in (1.02, 4.98))
    assert high == low


def test_the_pressure_gradient_that_keeps_the_flux_at_0(simulation):
    """Of one-point spheres; taken away from the velocities it leaves those without it."""
    spheres, F = heap()
    eta, H, a, z = 0.7, 6.0, spheres.a, np.clip(spheres.x[:, 2], spheres.a, 6.0 - spheres.a)
    style = f"cut_off_distance inf visc {eta} far_field_tolerance 1e-10 wall zlo 0 zhi 6 flow"
    sim = fall(simulation, spheres, F, f"{style} pressure", cell(11, -1, 9))
    free, none = sim.v, [output(sim, k) for k in (13, 14, 15)]
    sim = fall(simulation, spheres, F, f"{style} flux", cell(11, -1, 9))
    p = np.array([output(sim, k) for k in (13, 14, 15)])
    shape = (z * (H - z) - a ** 2 / 3)[:, None]
    assert none == [0, 0, 0] and p[2] == 0
    assert p == pytest.approx(6 / (121 * H ** 3) * (shape * F * (1, 1, 0)).sum(axis=0), rel=1e-10)
    assert sim.v == pytest.approx(free - shape * p / (2 * eta), abs=1e-8)


def test_shells_in_a_slit_put_up_the_gradient_of_their_points(simulation):
    """Far from the walls the force is spread over the points of the shell as over the surface of a sphere."""
    H, F = 30.0, (0.3, -0.2, 0.5)
    sim = fall(simulation, Spheres([(1, 2, 11.0)]), F,
               f"cut_off_distance inf visc 0.7 multiblob 42 wall zlo 0 zhi {H} flow flux "
               "relative_tolerance 1e-8", cell(60, -1, 31))
    p = np.array([output(sim, k) for k in (13, 14)])
    assert p == pytest.approx(6 / (3600 * H ** 3) * (11 * 19 - 1 / 3) * np.array(F[:2]), rel=1e-3)


# --- streams, and the stress that spheres put into them ---------------------------------------------------------------

@pytest.mark.parametrize("more", ["", "multiblob 12"])
def test_a_sphere_in_the_middle_of_a_couette_flow(simulation, more):
    """Walls that go with the fluid, without films: half as fast as they are, turning more slowly than the fluid; and
    seen from the other wall"""
    v = []
    for formula in ("0.3*z", "0.3*(z-5)"):
        style = (f"cut_off_distance inf visc {ETA!r} relative_tolerance 1e-8 far_field_tolerance 1e-8 wall zlo 0 zhi 5 "
                 f"fluid_velocity v_u 0 0 {more}")
        sim = fall(simulation, Spheres([(1, 2, 2.5), (7, 8, 1.4)]), (0, 0, 0), style, cell(12, -1, 6),
                   before_pair=f"variable u atom {formula}")
        v.append(np.hstack([sim.v, sim.atom("omega")]))
    assert v[0] - v[1] == pytest.approx(np.array([(1.5, 0, 0, 0, 0, 0)] * 2), abs=1e-8)
    alone = fall(simulation, Spheres([(1, 2, 2.5)]), (0, 0, 0), style, cell(12, -1, 6),
                 before_pair="variable u atom 0.3*z")
    assert alone.v[0] == pytest.approx((0.75, 0, 0), abs=1e-7)
    if more:
        assert 0.12 < alone.atom("omega")[0, 1] < 0.15


def test_a_shell_in_the_middle_of_a_poiseuille_flow(simulation):
    """As Faxen's law says, u + a^2/6 u'', but for the third power of its size"""
    style = (f"cut_off_distance inf visc {ETA!r} relative_tolerance 1e-7 multiblob 42 lubrication yes wall zlo 0 zhi "
             "12 fluid_velocity v_u 0 0")
    sim = fall(simulation, Spheres([(1, 2, 6.0)]), (0, 0, 0), style, cell(40, -1, 13),
               before_pair="variable u atom z*(12-z)")
    assert sim.v[0] == pytest.approx((36 - 1 / 3, 0, 0), abs=0.05)


@pytest.mark.parametrize("wall, formula, more, message", [
    ("wall zlo 0 zhi 5", "v_u 0 0", "multiblob 12 lubrication yes",
     "the fluid moves along the wall zhi at 5, where its velocity is 1 of the largest, "
     "and the films of keyword lubrication are those of walls at rest"),
    ("wall zlo 0", "0 0 v_u", "", None), ("wall zlo 0", "v_u 0 0", "multiblob 12 lubrication yes", None),
    ("wall zlo -1", "0 0 v_u", "", "nothing flows through the wall zlo at -1, and its component z there is 0.4 of the "
                                   "largest velocity: give one that is 0")])
def test_a_stream_that_walls_do_not_know_is_named(simulation, wall, formula, more, message):
    def move():
        fall(simulation, Spheres([(1, 2, 2.5)]), (0, 0, 0),
             f"cut_off_distance inf visc 1 fluid_velocity {formula} {wall} {more}", cell(12, -2, 6),
             before_pair="variable u atom 0.3*z")
    if message is None:
        return move()
    with pytest.raises(LammpsError, match=message):
        move()


@pytest.mark.parametrize("heights", [(2.5,), (2.5, 1.4)])
@pytest.mark.parametrize("component", [0, 2])
def test_a_velocity_that_is_stored_for_atoms_is_not_known_at_the_wall(simulation, component, heights):
    """As of a CFD code, which gives it where the sphere is: it moves nothing on the wall, and the sphere is where it
    would be by a formula."""
    spheres = Spheres([(1 + 5 * k, 2, z) for k, z in enumerate(heights)])
    words = ["0", "0", "0"]
    words[component] = "v_u"
    store = ["fix cfd all property/atom d_u", "compute cfd all property/atom d_u", "variable u atom c_cfd"]
    store[1:1] = [f"set atom {k + 1} d_u {0.1 * z * z!r}" for k, z in enumerate(heights)]
    v = [fall(simulation, spheres, (0, 0, 0),
              f"cut_off_distance inf visc 1 relative_tolerance 1e-9 far_field_tolerance 1e-9 {FLOOR} "
              f"fluid_velocity {' '.join(words)}", cell(12, -2, 6), before_pair=lines).v
         for lines in ("\n".join(store), "variable u atom 0.1*z*z")]
    assert v[0] == pytest.approx(v[1], abs=1e-7)
    fall(simulation, spheres, (0, 0, 0),
         f"cut_off_distance inf visc 1 multiblob 12 lubrication yes {FLOOR} fluid_velocity {' '.join(words)}",
         cell(12, -2, 6), before_pair="\n".join(store))


@pytest.mark.parametrize("words, message",
                         [("0 0 v_u", "nothing flows through the wall zlo at 0, and its component z there is 1 "
                                      "of the largest"),
                          ("v_u 0 0",
                           "the fluid moves along the wall zlo at 0, where its velocity is 1 of the largest")])
@pytest.mark.parametrize("boundary", ["p p f", "f f f"])
def test_one_number_for_all_by_a_variable_is_looked_at(simulation, words, message, boundary):
    sim = simulation(Spheres([(1, 2, 2.5)]), f"cut_off_distance inf visc 1 multiblob 12 lubrication yes {FLOOR} "
                                             f"fluid_velocity {words}", fix=False,
                     dt=1e-9, box=cell(12, -2, 6), boundary=boundary, before_pair="variable u equal 0.3")
    with pytest.raises(LammpsError, match=message):
        sim.commands([MOVE]).run()


def moments(simulation, spheres, style, box, boundary, F=(0, 0, 0)):
    sim = simulation(spheres, f"{style} visc 0.7 multiblob 12 relative_tolerance 1e-8 fluid_velocity v_u 0 0",
                     fix=False, dt=1e-9, box=box, boundary=boundary, before_pair="variable u atom 0.3*z")
    sim.commands(pull(np.broadcast_to(np.array(F, float), spheres.x.shape)) +
                 [MOVE, "compute S all stokes_dynamics/stress",
                  "compute most all reduce max c_S[1]",
                  "thermo_style custom step c_most"]).run()
    return np.array(sim.lmp.numpy.extract_compute("S", 1, 2))[:sim.n][np.argsort(sim.ids())][:, :12].copy()


@pytest.mark.parametrize("walls, z", [("wall zlo 0", 20.0), ("wall zlo 0 zhi 40", 20.0)])
def test_the_first_moment_of_a_shell_far_from_walls(simulation, walls, z):
    """-20/3 pi eta a^3 E"""
    S = moments(simulation, Spheres([(1, 2, z)]), f"cut_off_distance inf {walls}", cell(40, -1, 41), "p p f")
    assert S[0, [0, 1, 2, 3, 4, 5]] == pytest.approx(-20 / 3 * np.pi * 0.7 * np.array([0, 0, 0, 0, 0.15, 0]), abs=0.02)


def test_moments_in_a_wide_cell_are_those_in_open_fluid_above_the_floor(simulation):
    """What images of a stresslet at the floor do falls with the fourth power of the distance."""
    spheres = Spheres([(1, 1, 1.2), (3.3, 1, 1.5)])
    box = [(-30.0, 30.0), (-30.0, 30.0), (-1.0, 30.0)]
    for F in ((0, 0, 0), (0, 0, -1)):
        for films in ("", "lubrication yes"):
            wide, open_ = (moments(simulation, spheres, f"cut_off_distance inf wall zlo 0 {films}", box, b, F)
                           for b in ("p p f", "f f f"))
            assert wide == pytest.approx(open_, abs=2e-3 * np.abs(open_).max())


def test_the_mean_stress_of_a_slab_has_no_volume(simulation):
    sim = simulation(Spheres([(1, 1, 2)]), f"cut_off_distance inf visc 1 multiblob 12 {FLOOR}", box=cell(12),
                     boundary="p p f", fix=False, dt=0.1)
    with pytest.raises(LammpsError, match="its vector is an average over a periodic box, and this box is not periodic; "
                                          "the per-atom array needs no"):
        sim.commands([MOVE, "compute S all stokes_dynamics/stress", "thermo_style custom step c_S[1]"]).run()


# --- noise ------------------------------------------------------------------------------------------------------------

def test_noise_in_a_slit_has_the_covariance_of_the_products(simulation):
    """2 kT dt times the mobility, of 700 independent steps so short that nothing moves"""
    kT, dt, x = 0.8, 1e-14, [(1.0, 1.0, 1.2), (3.1, 1.0, 1.9)]
    style = f"cut_off_distance inf visc {ETA!r} relative_tolerance 1e-6 wall zlo 0 zhi 3.5"
    M = matrix(simulation, x, style, cell(8, -1, 4))
    sim = simulation(Spheres(x), style, fix=False, dt=dt, box=cell(8, -1, 4), boundary="p p f")
    sim.commands(f"{MOVE} temperature {kT} 91 noise_tolerance 1e-3 scheme midpoint").run(0)
    d = []
    for k in range(700):
        at = sim.x.ravel()
        sim.run(1, "pre no post no")
        d.append(sim.x.ravel() - at)
    C = np.cov(np.array(d).T, bias=True) / (2 * kT * dt)
    sigma = np.sqrt((np.outer(np.diag(M), np.diag(M)) + M ** 2) / len(d))
    assert np.abs((C - M) / sigma).max() < 4.5
