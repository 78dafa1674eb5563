"""Keyword wall: a plane no-slip wall, through LAMMPS, against closed forms, tables of another code and itself
turned."""
import csv
import functools
import os

import numpy as np
import pytest

import model
from host import at_most, by_open_mpi
from same_end import same_end_on_ranks
from system import LammpsError, Spheres, dump_lines, from_restart, input_lines, lmp, read_dump

MOVE = "fix move all stokes_dynamics/overdamped"
ETA = 1 / (6 * np.pi)                    # 6 pi eta = 1
FT = f"cut_off_distance inf visc {ETA!r} rotation yes relative_tolerance 1e-10 wall zlo 0"
TT = FT.replace("rotation yes ", "")
BOX = [(-60.0, 60.0), (-60.0, 60.0), (-1.0, 119.0)]


def pull(F, T=None):
    """A force, and a torque, of its own on every sphere"""
    columns = [("f", F)] + ([("t", T)] if T is not None else [])
    names = [k + c for k, _ in columns for c in "xyz"]
    lines = ["fix own all property/atom " + " ".join("d_" + name for name in names)]
    for k, values in columns:
        lines += [f"set atom {i + 1} " + " ".join(f"d_{k}{c} {value!r}" for c, value in zip("xyz", map(float, f)))
                  for i, f in enumerate(values)]
    lines.append("compute own all property/atom " + " ".join("d_" + name for name in names))
    lines += [f"variable {name} atom c_own[{k + 1}]" for k, name in enumerate(names)]
    lines.append("fix pull all addforce v_fx v_fy v_fz")
    return lines + (["fix twist all addtorque/atom v_tx v_ty v_tz"] if T is not None else [])


def fall(simulation, spheres, F, style=FT, steps=0, dt=1e-9, **options):
    options.setdefault("box", BOX)
    sim = simulation(spheres, style, fix=False, dt=dt, **options)
    return sim.commands(pull(np.broadcast_to(np.array(F, float), spheres.x.shape)) + [MOVE]).run(steps)


FILM = FT + " lubrication yes lubrication_gap 1e-6"
# Times from z = 5, weight 1: the ordinary differential equation of the self mobility by another code
@pytest.mark.parametrize("z, t, steps", [(3, 2.7806341314, 150), (2, 4.5232388997, 200), (1.1, 6.8907636319, 800)])
def test_a_sphere_falls_to_the_wall_in_the_known_time(simulation, z, t, steps):
    sim = fall(simulation, Spheres([(0.3, 0.2, 5)]), (0, 0, -1), TT, steps, t / steps)
    assert sim.x[0] == pytest.approx((0.3, 0.2, z), abs=2e-5)


@pytest.mark.parametrize("gap, U, W", [(0.1, 0.54374313, 0.06403251), (0.01, 0.50492647, 0.09009191)])
def test_a_sphere_pushed_along_the_wall_turns(simulation, gap, U, W):
    sim = fall(simulation, Spheres([(0, 0, 1 + gap)]), (1, 0, 0))
    assert sim.v[0] == pytest.approx((U, 0, 0), abs=1e-8)
    assert sim.atom("omega")[0] == pytest.approx((0, W, 0), abs=1e-8)


def test_two_spheres_above_the_wall(simulation):
    sim = fall(simulation, Spheres([(-1.25, 0, 1.5), (1.25, 0, 1.5)]), (0, 0, -1))
    assert sim.v[1] == pytest.approx((0.060980414311, 0, -0.371744761226), abs=1e-11)
    assert sim.atom("omega")[1] == pytest.approx((0, -0.040827662743, 0), abs=1e-11)
    sim = fall(simulation, Spheres([(0, 0, 1.5), (0, 0, 4.0)]), (0, 0, -1))
    assert sim.v[:, 2] == pytest.approx((-0.560017933077, -0.904771119966), abs=1e-11)


# U_z, U_x, U_y of unit forces, W_y of F_x; the mean of the two spheres' velocities is that of the centre
@pytest.mark.parametrize("x, expected", [
    ([(-1, 0, 2), (1, 0, 2)], (0.262311482231, 0.559106259701, 0.452636696846, -0.015061872563)),
    ([(0, 0, 2), (0, 0, 4)], (0.426443523213, 0.505854155563, 0.505854155563, 0.020420247560))])
def test_rigid_doublet_above_the_wall(simulation, x, expected):
    for d, U in zip((2, 0, 1), expected):
        F = np.zeros(3)
        F[d] = 0.5
        sim = fall(simulation, Spheres(x, molecule=1), F, FT + " rigid_clumps yes")
        assert sim.v.mean(axis=0)[d] == pytest.approx(U, abs=1e-9)
        if d == 0:
            assert sim.atom("omega")[0, 1] == pytest.approx(expected[3], abs=1e-9)


# --- films ------------------------------------------------------------------------------------------------------------

# Exact, another code; the film stops a sphere, so that the last step is not longer than the rest
@pytest.mark.parametrize("z, t, steps", [(3, 2.7902751, 150), (1.5, 5.8482487, 300), (1.01, 10.4213978, 1500)])
def test_a_sphere_with_a_film_falls_as_it_should(simulation, z, t, steps):
    sim = fall(simulation, Spheres([(0.3, 0.2, 5)]), (0, 0, -1), FILM.replace("1e-10", "1e-8"), steps, t / steps)
    assert sim.x[0] == pytest.approx((0.3, 0.2, z), abs=3e-5)


@pytest.mark.parametrize("gap, U, W", [(0.1, 0.44304988, 0.02703135), (0.01, 0.29611765, 0.03654131),
                                       (0.001, None, 0.159055)])
def test_a_sphere_with_a_film_rolls_as_it_should(simulation, gap, U, W):
    sim = fall(simulation, Spheres([(0, 0, 1 + gap)]), (1, 0, 0), FILM)
    v, w = sim.v[0], sim.atom("omega")[0]
    if U:
        assert v == pytest.approx((U, 0, 0), abs=3e-6)
        assert w == pytest.approx((0, W, 0), abs=3e-6)
    assert w[1] / v[0] == pytest.approx(W / (U or 1), abs=2e-5)


# Goldman, Cox & Brenner's problem, computed again: U/h and 2W of a free sphere in u_x = z
@pytest.mark.parametrize("gap, U, W", [(0.05, 0.6636, 0.6838), (0.1, 0.7389, 0.7534), (0.3, 0.864, 0.869),
                                       (1, 0.964, 0.964)])
@pytest.mark.parametrize("model", ["rotation yes", "multiblob 12"])
def test_a_free_sphere_in_shear(simulation, gap, U, W, model):
    style = (f"cut_off_distance inf visc 1 {model} relative_tolerance 1e-10 wall zlo 0 lubrication yes "
             "fluid_velocity v_u 0 0")
    sim = fall(simulation, Spheres([(0, 0, 1 + gap)]), (0, 0, 0), style, before_pair="variable u atom z")
    off = 6e-4 if model == "rotation yes" else 2e-2
    assert sim.v[0, 0] / (1 + gap) == pytest.approx(U, abs=off)
    assert 2 * sim.atom("omega")[0, 1] == pytest.approx(W, abs=off)


def test_a_held_sphere_in_shear(simulation):
    sim = simulation(Spheres([(0, 0, 1.1)]), FILM + " fluid_velocity v_u 0 0", box=BOX, before_pair="variable u atom z")
    sim.run()
    assert sim.drag[0] == pytest.approx((1.6325438 * 1.1, 0, 0), abs=3e-5)
    assert sim.fix_rows()[0, 6:9] == pytest.approx((0, 0.9517912 * 2 / 3, 0), abs=2e-5)


def groups(name):
    """{(group, load): rows}"""
    of = {}
    for row in csv.DictReader(line for line in open(os.path.join(model.DATA, "walls", name))
                              if not line.startswith("#")):
        of.setdefault((row["group"], row["load"]), []).append(row)
    return of


def fall_of(simulation, rows, style):
    """[n, 6] velocities of a group"""
    values = np.array([[float(row[c]) for c in ("x", "y", "z", "Fx", "Fy", "Fz", "a")] for row in rows])
    sim = fall(simulation, Spheres(values[:, :3], values[:, 6]), values[:, 3:6],
               f"cut_off_distance inf visc 1 {style} lubrication yes lubrication_gap 1e-6 wall zlo 0 "
               "relative_tolerance 1e-10")
    return np.hstack([sim.v, sim.atom("omega")])


def columns(rows, ending=""):
    return np.array([[float(row[k + c + ending]) for k in "UW" for c in "xyz"] for row in rows])


def test_groups_are_those_of_the_model_in_another_code(simulation):
    for rows in groups("groups.csv").values():
        expected = columns(rows, "_model")
        assert np.abs(fall_of(simulation, rows, "rotation yes") - expected).max() < 2e-6 * np.abs(expected).max()


# Worst of the three loads, in per cent of all velocities, against the full flow, of 12 and 42 points; one point per
# sphere has 4 to 13, 12 points without films up to 80
WORST = {"pair_side_by_side": (0.78, 0.16), "pair_one_above": (0.80, 0.19), "pair_close": (1.97, 0.84),
         "pair_close_low": (2.72, 1.60), "triangle": (2.78, 1.02)}
# The prototype measured U without W, as its column of one point per sphere shows, which the tables above give to all
# its digits so; its shells stood otherwise and had no one-body addition: 0.5, 0.5, 1.8, 3.1, 1.7. Measured so, shells
# as they stand here have these. Without the addition, at five other orientations, they had 0.4 to 1.1, 0.2 to 0.9, 0.9
# to 2.0, 2.4 to 4.2, 1.8 to 2.9: one draw is no better known than that.
WORST_U = {"pair_side_by_side": 0.64, "pair_one_above": 0.76, "pair_close": 0.82, "pair_close_low": 2.37,
           "triangle": 1.95}


@pytest.mark.parametrize("points", [12, 42])
def test_shells_with_both_films_are_near_the_full_flow(simulation, points):
    worst, worst_U = dict.fromkeys(WORST, 0.0), dict.fromkeys(WORST, 0.0)
    for (group, _), rows in groups("groups_exact.csv").items():
        if group in WORST:
            expected = columns(rows)
            off = fall_of(simulation, rows, f"multiblob {points}") - expected
            worst[group] = max(worst[group], 100 * np.linalg.norm(off) / np.linalg.norm(expected))
            worst_U[group] = max(worst_U[group], 100 * np.linalg.norm(off[:, :3]) / np.linalg.norm(expected[:, :3]))
    assert worst == {group: pytest.approx(figures[points == 42], abs=0.006) for group, figures in WORST.items()}
    if points == 12:
        assert worst_U == {group: pytest.approx(figure, abs=0.006) for group, figure in WORST_U.items()}


# A sphere that touches the wall has a quarter of its mobility across it, so that a quarter of the step is stable
@pytest.mark.parametrize("step, warned", [(0.55, True), (0.45, False)])
def test_the_time_step_of_a_lone_sphere_at_the_wall(tmp_path, step, warned):
    mass = 4 / 3 * np.pi * 1.7
    lines = input_lines(Spheres([(0, 0, 1.0001)], v=(0, 0, 0.1)), TT.replace("relative_tolerance 1e-10", ""),
                        str(tmp_path / "one.data"), box=BOX, dt=step * mass)
    said = lmp(tmp_path, lines + ["run 0"]).log
    assert ("the limit 2 m lambda/(6 pi eta a)" in said) == warned


# --- one scene, turned and dealt out ----------------------------------------------------------------------------------

def heap(n=12, seed=7):
    """Spheres of unlike radii above z = 0, one of which cuts it; a rigid doublet among them"""
    rng = np.random.default_rng(seed)
    a = np.exp(rng.uniform(-0.7, 0.5, n))
    x = rng.uniform(-4, 4, (n, 3))
    x[:, 2] = a * rng.uniform(1.02, 4.0, n)
    x[3, 2] = 0.9 * a[3]
    x[1], a[1] = x[0] + (0, 0, a[0] + a[1]), a[1]
    return Spheres(x, a, molecule=[1, 1] + [0] * (n - 2)), rng.normal(size=(n, 3))


SIDES = {"zlo": ((0, 1, 2), 1), "zhi": ((1, 0, 2), -1), "xlo": ((1, 2, 0), 1), "xhi": ((2, 1, 0), -1),
         "ylo": ((2, 0, 1), 1), "yhi": ((0, 2, 1), -1)}


def turned(rows, side):
    """The scene above z = 0 to one in front of that side: a rotation"""
    axes, sign = SIDES[side]
    out = np.empty_like(rows)
    for d, axis in enumerate(axes):
        out[:, axis] = rows[:, d] * (sign if d == 2 else 1)
    return out


@pytest.mark.parametrize("style", ["", "rotation yes", "rotation yes rigid_clumps yes", "rotation yes lubrication yes",
                                   "multiblob 12 rigid_clumps yes lubrication yes"])
def test_six_sides_are_one_scene_turned(simulation, style):
    spheres, F = heap()
    spheres.x[3] *= 1.3
    answers = {}
    for side in SIDES:
        scene = Spheres(turned(spheres.x, side), spheres.a, molecule=spheres.molecule)
        if "multiblob" in style and side not in ("zlo", "zhi"):
            continue                     # the shells of free spheres do not turn with the scene
        sim = fall(simulation, scene, turned(F, side),
                   f"cut_off_distance inf visc 1 {style} relative_tolerance 1e-11 wall {side} 0",
                   box=[(-60, 60)] * 3)
        v = sim.v
        answers[side] = np.array([v[:, axis] * (SIDES[side][1] if d == 2 else 1)
                                  for d, axis in enumerate(SIDES[side][0])])
    for side, answer in answers.items():
        tolerance = 0.05 if "multiblob" in style else 1e-9
        assert np.abs(answer - answers["zlo"]).max() < tolerance * np.abs(answers["zlo"]).max(), side


@pytest.mark.parametrize("algorithm", ["algorithm 1", "algorithm 2", "algorithm 2 precondition none",
                                       "algorithm 2 precondition clump"])
@pytest.mark.parametrize("rotation", ["no", "yes", "yes lubrication yes"])
def test_forces_for_given_velocities_are_the_inverse(simulation, rotation, algorithm):
    spheres, F = heap()
    style = f"cut_off_distance inf visc 1 rotation {rotation} wall zlo 0 relative_tolerance 1e-11 max_iter 300 "
    spheres.molecule[:] = 0
    moving = fall(simulation, spheres, F, style, box=BOX)
    v, w = moving.v, moving.atom("omega")
    sim = simulation(Spheres(spheres.x, spheres.a, v), style + algorithm, box=BOX)
    for i in range(spheres.n):
        sim.set("omega", i + 1, w[i])
    sim.run()
    assert sim.drag == pytest.approx(-F, abs=1e-8)


def test_a_lone_sphere_is_not_alone_at_a_wall(simulation):
    for style in ("cut_off_distance inf", "cut_off_distance 5", "clumps_only yes"):
        sim = simulation(Spheres([(1, 2, 1.25)], 1.0, (0.3, 0, 0.7)),
                         f"{style} visc {ETA!r} wall zlo 0 relative_tolerance 1e-12", box=BOX)
        sim.run()
        s = 0.8
        along = 1 - 9 / 16 * s + s ** 3 / 8 - s ** 5 / 16
        across = 1 - 9 / 8 * s + s ** 3 / 2 - s ** 5 / 8
        assert sim.drag[0] == pytest.approx((-0.3 / along, 0, -0.7 / across), abs=1e-10), style


@pytest.mark.parametrize("style, side", [("", "zlo"), ("", "xhi"), ("multiblob 12 one_body no", "xhi"),
                                         ("multiblob 12 rigid_clumps yes", "zlo")])
def test_ewald_sums_have_images(simulation, style, side):
    """Against all pairs: spheres that cut the wall among them; and alone"""
    many = 12 if style else 30
    for n in (many, 1):
        spheres, F = heap(many)
        x, a = spheres.x[:n], spheres.a[:n]
        v = []
        for how in ("direct", "ewald far_field_tolerance 1e-6"):
            scene = Spheres(turned(x, side), a, molecule=[1, 1] + [0] * (n - 2) if n > 1 else 0)
            sim = fall(simulation, scene, turned(F[:n], side),
                       f"cut_off_distance inf visc 1 {style} wall {side} 0 relative_tolerance 1e-9 far_field {how}",
                       box=[(-60, 60)] * 3)
            v.append(sim.v.copy())
        assert 0 < np.abs(v[1] - v[0]).max() < 1e-5 * np.abs(v[0]).max()


def test_far_wall_is_no_wall(simulation):
    spheres, F = heap()
    answers = [fall(simulation, spheres, F, f"cut_off_distance inf visc 1 rotation yes relative_tolerance 1e-9 {wall}",
                    box=BOX).v
               for wall in ("", "wall zlo -1e8", "wall yhi 1e8")]
    for answer in answers[1:]:
        assert np.abs(answer - answers[0]).max() < 1e-6 * np.abs(answers[0]).max()


def test_a_sphere_pressed_into_the_wall_moves_as_one_that_touches_it(simulation):
    for F in ((1, 0, 0), (0, 0, 1)):
        v = [fall(simulation, Spheres([(0, 0, z)]), F).v for z in (0.99, 1.0)]
        assert np.abs(v[0] - v[1]).max() < 1e-12


def test_the_edge_of_the_box_is_a_position(simulation):
    spheres, F = heap()
    edge, at = (fall(simulation, spheres, F, f"cut_off_distance inf visc 1 wall zlo {where}",
                     box=[(-60, 60), (-60, 60), (-0.5, 50)]).v
                for where in ("EDGE", "-0.5"))
    assert (edge == at).all()


@pytest.mark.parametrize("style", ["", "update_every 10", "rotation yes lubrication yes", "multiblob 12"])
def test_the_edge_of_a_box_that_is_changed_between_runs(simulation, style):
    """No sphere moves, but the wall does: forces are those at the new wall."""
    scene = Spheres([(0, 0, 2), (2.5, 0, 3)], v=[(0.1, 0.2, -1), (0.3, 0, 0.5)])
    box = [(-60, 60), (-60, 60), (-0.5, 50)]
    words = f"cut_off_distance inf visc 1 {style} relative_tolerance 1e-10 wall zlo"
    moved = simulation(scene, f"{words} EDGE", box=box).run(3).commands("change_box all z final 0.5 50").run().drag
    assert moved == pytest.approx(simulation(scene, f"{words} 0.5", box=box).run().drag, abs=1e-8 * np.abs(moved).max())


STYLES = {"points": "rotation yes", "shells": "multiblob 12 rigid_clumps yes lubrication yes",
          "films": "rotation yes rigid_clumps yes lubrication yes", "ewald": "far_field ewald far_field_tolerance 1e-3",
          "shells by ewald": "multiblob 12 lubrication yes far_field ewald far_field_tolerance 1e-3"}


def script(folder, style, runs, newton="on", begin=None):
    spheres, _ = heap(6)
    spheres.x[3, 2] *= 1.2
    pair = f"cut_off_distance inf visc 1 {STYLES[style]} wall zlo 0 relative_tolerance 1e-12"
    lines = input_lines(spheres, pair, str(folder / "heap.data"), fix=False, dt=0.05, newton=newton, box=BOX)
    if begin:
        lines = [line for line in from_restart(lines, begin) if not line.startswith("pair_")]
    return lines + ["variable fx atom 0.4*sin(id)", "fix weight all addforce v_fx 0 -3", MOVE] + runs


@pytest.mark.parametrize("style", by_open_mpi(STYLES, but=2))
def test_ranks_newton_and_restart_do_not_matter(tmp_path, style):
    whole = same_end_on_ranks(tmp_path, functools.partial(script, tmp_path, style), 4,
                              "x y z vx vy vz omegax omegay omegaz", before_restart=2)
    assert np.abs(whole[:, :3]).max() > 1


@pytest.mark.parametrize("style", ["cut_off_distance 6", "cut_off_distance 6 taper wendland rotation yes",
                                   "clumps_only yes rotation yes"])
def test_lists_of_pairs_do_not_depend_on_ranks(tmp_path, style):
    """Images of spheres that other ranks have"""
    spheres, _ = heap(30)
    spheres.molecule[:] = [k // 3 + 1 for k in range(30)]
    spheres.v = np.random.default_rng(2).normal(size=(30, 3))
    answers = []
    for ranks, newton in ((1, "on"), (at_most(4), "off")):
        lines = input_lines(spheres, f"{style} visc 1 algorithm 2 wall zlo 0 relative_tolerance 1e-12 max_iter 500",
                            str(tmp_path / "heap.data"), newton=newton, box=[(-9, 9), (-9, 9), (-1, 20)])
        lmp(tmp_path, lines + dump_lines("out.dump") + ["run 0"], ranks)
        answers.append(read_dump(str(tmp_path / "out.dump"))[-1][1][:, 6:])
    assert np.abs(answers[1] - answers[0]).max() < 1e-10 * np.abs(answers[0]).max()


# --- what there is no answer for --------------------------------------------------------------------------------------

@pytest.mark.parametrize("words, options, message", [
    ("wall zlo 0 zhi 9", {}, "keyword wall: between two walls the box must be periodic along them: "
                             "use boundary p p f, or leave out"),
    ("wall zlo", {}, "keyword wall: .*missing|wall"),
    ("wall up 0", {}, "keyword wall: 'up'"),
    ("wall zlo 0 tensor oseen", {}, "keyword wall is not available with tensor oseen: use tensor rpy"),
    ("wall zlo 0 far_field ewald rotation yes", {},
     "keyword wall: far_field ewald has no images of torques in a wall: use multiblob 12"),
    ("wall zlo 0 precondition waves algorithm 2", {}, "precondition waves is for periodic boxes"),
    ("wall zlo 0 rigid_clumps yes shell 12", {}, "a shell is computed once, without the wall: use multiblob 12"),
    ("wall zlo 0 lubrication yes", {}, "keyword lubrication: yes requires rotation yes"),
    ("wall zlo 0", dict(boundary="p f f"),
     "keyword wall: the box is periodic in one of the two directions along it: use boundary p p f, or f f f"),
    ("wall zlo 0", dict(boundary="p p p"),
     "keyword wall: it needs boundary f, s or m across it, and z is periodic: use boundary p p f, or f f f"),
    ("wall zlo EDGE", dict(boundary="f f s"), "wall: EDGE: that side of the box follows the spheres"),
    ("wall xlo EDGE", dict(tilt=(1.0, 0, 0)),
     "wall: EDGE: that side of the box is tilted: give the position of the wall"),
    ("wall zlo 0 fluid_velocity 0 0 0.1", {},
     "nothing flows through the wall zlo at 0, and its component z is '0.1' there: give 0"),
    ("wall zlo 2.5", {}, "step 0: keyword wall: the centre of atom 1, radius 1, is 0.5 behind the wall zlo at 2.5"),
    ("wall zhi 0", {}, "keyword wall: the centre of atom . radius 1, is . behind the wall zhi at 0|atom"),
    ("wall zlo 2", {}, "the centre of atom 1, radius 1, is 0 behind the wall"),
])
def test_what_does_not_go_with_a_wall_is_named(simulation, words, options, message):
    spheres = Spheres([(0, 0, 2), (0, 3, 4)])
    with pytest.raises(LammpsError, match=message):
        simulation(spheres, f"cut_off_distance inf visc 1 {words}", box=BOX, **options).run()


def test_pressed_shells_with_the_addition_are_told_to_leave_it_out(simulation):
    spheres, F = heap(30)
    with pytest.raises(LammpsError,
                       match="not positive definite with the one-body addition of multiblob: use one_body no"):
        fall(simulation, spheres, F,
             "cut_off_distance inf visc 1 multiblob 12 lubrication yes wall zlo 0 relative_tolerance 1e-9")


def test_moments_of_films_are_those_of_pairs(simulation):
    """A film of the wall has a force and no first moment; the points that feel it in their stead have one."""
    sim = simulation(Spheres([(0, 0, 1.1)]), "cut_off_distance inf visc 1 multiblob 12 lubrication yes wall zlo 0",
                     box=BOX, fix=False, dt=1e-9)
    sim.commands(pull(np.array([(0.5, 0, -1.0)])) + [MOVE, "compute S all stokes_dynamics/stress",
                                                     "dump d all custom 1 /dev/null c_S[1]"])
    sim.run()
    rows = np.array(sim.lmp.numpy.extract_compute("S", 1, 2))[0]
    assert np.abs(rows[:6]).max() > 1e-3 and (rows[6:] == 0).all()


def test_tables_of_lone_clumps_know_no_wall(simulation):
    with pytest.raises(LammpsError, match="a resistance that is computed once, without the wall: use cut_off_distance "
                                          "inf and multiblob 12"):
        simulation(Spheres([(0, 0, 2), (0, 2, 2)], molecule=1),
                   "clumps_only yes rigid_clumps yes rotation yes visc 1 wall zlo 0", box=BOX).run()


def test_a_box_that_shrinks_takes_no_wall_along(simulation):
    sim = simulation(Spheres([(0, 0, 2), (0, 3, 4)]), "cut_off_distance inf visc 1 wall zlo EDGE", box=BOX)
    sim.commands("fix shrink all deform 1 z final 0 90 remap x")
    with pytest.raises(LammpsError,
                       match="that side of the box is at .* now and was at -1 when the run began: walls do not move"):
        sim.run(100)


@pytest.mark.parametrize("words, message", [
    ("wall zlo 1.5", "1 spheres cut the wall zlo at 1.5: they move as if they touched it"),
    ("wall zlo 0 fluid_velocity 0.1 0 0",
     "keyword fluid_velocity: the fluid rests at the wall zlo at 0, and its component x is '0.1' there")])
def test_warnings(tmp_path, words, message):
    lines = input_lines(Spheres([(0, 0, 2), (0, 3, 4)]), f"cut_off_distance inf visc 1 {words}",
                        str(tmp_path / "two.data"), box=BOX)
    said = lmp(tmp_path, lines + ["run 2", "run 2"]).log
    assert said.count("WARNING: Pair style stokes_dynamics: " +
                      ("keyword" if "fluid" in words else "keyword wall")) >= 1
    assert message in said
