"""Hard scenes, as test_hard_cases.py has them: spheres that move, places and units, what is refused, and ranks."""
import numpy as np
import pytest

import model
from hard import PAIR, U, all_ways, check, cloud
from system import LammpsError, Spheres, chain, dump_lines, input_lines, largest_difference, lmp, note, read_dump
from ways import A, COLUMNS, ETA, EXACT, STOKES, WAYS, Way


# --- spheres that move ------------------------------------------------------------------------------------------------

def frames_of(sim, steps):
    """[step, sphere, COLUMNS] of a run; nothing but what the commands before have set in motion moves."""
    sim.commands(dump_lines(sim.folder / "dump", columns=COLUMNS)).run(steps)
    assert sim.fix_vector()[6] == 0
    sim.command("undump out")
    return np.array([rows for _, rows in read_dump(sim.folder / "dump")])


def passing_by(simulation, way, x, dt):
    """A sphere of radius A at (x, 0.1, 0) that goes along -x through a larger one at the origin, past a third."""
    spheres = Spheres([(0, 0, 0), (x, 0.1, 0), (1.0, 2.0, -2.0)], [1.9, A, 1.1], [U, (-1, 0, 0), (0.1, 0.3, -0.2)],
                      molecule=1)
    sim = simulation(spheres, way.style(spheres), dt=dt, box=[(-20.0, 20.0)] * 3)
    return spheres, sim.commands("group moving id 2\nfix move moving move linear -1 0 0")


def largest_step(F):
    """Largest change of a force (or torque) from one frame to the next."""
    return np.abs(np.diff(F, axis=0)).max()


@pytest.mark.hard_case("path through contact, overlap and the inside, out again: forces right and continuous")
@all_ways
def test_path_through_another_sphere(simulation, way):
    """One run of 400 steps; a slope of 4 Stokes drags a length is more than the model has anywhere."""
    spheres, sim = passing_by(simulation, way, 4.0, 0.02)
    frames = frames_of(sim, 400)
    assert frames[-1, 1, 0] == pytest.approx(-4.0)
    F = way.answer_of_frames(frames)
    assert way.error(F, way.forces_on_the_way(spheres, frames), spheres) < 1e-9
    assert 1e-4 * STOKES < largest_step(F[..., :3]) < 0.02 * 4 * STOKES


@pytest.mark.hard_case("approach to 1e-12 of contact, and of the inside, and across")
@pytest.mark.parametrize("R", [1.9 + A, 1.9 - A], ids=["contact", "inside"])
@all_ways
def test_steps_of_1e_minus_12_across_contact(simulation, way, R):
    """Where the formula changes, forces change as little as the place; the solves differ by the tolerance."""
    spheres, sim = passing_by(simulation, way, np.sqrt(R**2 - 0.1**2) + 5e-12, 1e-12)
    frames = frames_of(sim, 10)
    distance = np.linalg.norm(frames[:, 1, :3] - frames[:, 0, :3], axis=1)
    assert distance[0] > R + 1e-12 and distance[-1] < R - 1e-12 and np.abs(distance - R).min() < 1e-12
    F = way.answer_of_frames(frames)
    assert way.error(F, way.forces_on_the_way(spheres, frames), spheres) < 1e-9
    assert largest_step(F[..., :3]) < 1e-10 * STOKES


@pytest.mark.hard_case("clump that flies apart in a run")
@all_ways
def test_clump_that_flies_apart(simulation, way):
    """20 overlapping spheres move away from their middle, each its own way, to twice its size."""
    spheres = cloud()
    spheres.v = spheres.x - spheres.x.mean(axis=0)
    sim = simulation(spheres, way.style(spheres), dt=0.01, box=[(-20.0, 20.0)] * 3)
    sim.commands("unfix drag\nfix drag all stokes_dynamics apply no\nfix move all nve/sphere")
    frames = frames_of(sim, 100)
    assert np.ptp(frames[-1, :, 0]) == pytest.approx(2.0 * np.ptp(spheres.x[:, 0]))
    assert way.error(way.answer_of_frames(frames), way.forces_on_the_way(spheres, frames), spheres) < 1e-9


@pytest.mark.hard_case("clump that loses sphere after sphere in a run, until all are lone")
@pytest.mark.parametrize("way", [WAYS["clump"], WAYS["clumps_only"], WAYS["rotation clumps_only"],
                                 Way("clumps_only yes rigid_clumps auto", clumps=True)],
                         ids=["clump", "clumps_only", "rotation clumps_only", "rigid_clumps auto"])
def test_clump_that_loses_its_spheres(simulation, way):
    """Every second step one of them gets molecule ID 0. The blocks of the preconditioner, too, go by molecules."""
    spheres = cloud(8)
    if "rigid" in way.words:
        spheres.v = U + np.cross((0.2, -0.3, 0.1), spheres.x)
    sim = simulation(spheres, way.style(spheres))
    sim.commands(["variable k equal step/2"] + dump_lines(sim.folder / "dump", columns="mol " + COLUMNS))
    sim.run(16, 'every 2 "set atom $k mol 0"')
    frames = read_dump(sim.folder / "dump")
    assert [int((rows[:, 0] == 1).sum()) for _, rows in frames] == [8, 8, 8, 7, 7, 6, 6, 5, 5, 4, 4, 3, 3, 2, 2, 1, 1]
    for _, rows in frames:
        now = Spheres(spheres.x, spheres.a, spheres.v, rows[:, 0].astype(int))
        assert way.error(way.answer_of_frames(rows[:, 1:]), way.forces(now), now) < 1e-9
    lone = -6 * np.pi * ETA * spheres.a[:, None] * spheres.v
    if way.clumps:
        assert largest_difference(sim.drag, lone) < 1e-9


# --- places and units -------------------------------------------------------------------------------------------------

@pytest.mark.hard_case("radius 1e-9 m in SI units, radius 1e6, 1e8 radii from the origin")
@pytest.mark.parametrize("scale,eta,units,offset", [(1e-9, 1e-3, "si", 0.0), (1e6, 1.3, "lj", 0.0),
                                                    (1.0, 1.3, "lj", 1e8)],
                         ids=["nanometres", "1e6", "far away"])
@all_ways
def test_scales_and_places(simulation, way, scale, eta, units, offset):
    spheres = cloud()
    spheres.x = (spheres.x + offset) * scale
    spheres.a *= scale
    spheres.v *= scale
    sim = simulation(spheres, way.style(spheres, EXACT, eta), units=units,
                     before_pair=f"neighbor {0.1 * scale} bin").run()
    assert way.error(way.answer(sim), way.forces(spheres, eta=eta), spheres) < 1e-9
    assert sim.residual <= 1e-12 and sim.fix_vector()[6] == 0


def row_of_spheres():
    rng = np.random.default_rng(6)
    along = np.array((2.0, -1.0, 2.0)) / 3.0
    return Spheres(np.cumsum(rng.uniform(0.5, 2.5, 20))[:, None] * A * along, A * rng.uniform(0.5, 1.5, 20), molecule=1)


def plane_of_spheres():
    rng = np.random.default_rng(7)
    e, f = np.array((2.0, -1.0, 2.0)) / 3.0, np.array((1.0, 2.0, 0.0)) / np.sqrt(5.0)
    grid = np.array([(i, j) for i in range(5) for j in range(5)])
    return Spheres(1.4 * A * grid @ np.array([e, f]), A * rng.uniform(0.5, 1.5, 25), molecule=1)


@pytest.mark.hard_case("collinear and coplanar spheres")
@pytest.mark.parametrize("scene", [row_of_spheres, plane_of_spheres], ids=["collinear", "coplanar"])
@all_ways
def test_flat_scenes(simulation, way, scene):
    spheres = scene()
    spheres.v = np.random.default_rng(8).normal(size=(spheres.n, 3))
    check(simulation, way, spheres, 1e-9)


@pytest.mark.hard_case("collinear and coplanar rigid clumps")
@pytest.mark.parametrize("scene", [row_of_spheres, plane_of_spheres], ids=["collinear", "coplanar"])
def test_flat_rigid_clumps(simulation, scene):
    spheres = scene()
    spheres.v = U + np.cross((0.2, -0.3, 0.1), spheres.x)
    sim = simulation(spheres, f"clumps_only yes rigid_clumps yes visc {ETA}").run()
    assert WAYS["none"].error(sim.drag, model.forces(spheres, ETA), spheres) < 1e-9


# --- what the model does not have, and what is refused ----------------------------------------------------------------

@pytest.mark.hard_case("spin of a straight chain")
def test_spin_of_a_straight_chain_about_its_axis(simulation):
    """Without rotation the spheres are points, and those of a chain do not move when it spins."""
    spheres, omega = chain(5, 2 * A, a=A), np.array((0.0, 0.0, 0.3))
    for way, spins in ((WAYS["none"], False), (WAYS["rotation"], True)):
        sim = simulation(spheres, way.style(spheres))
        sim.raw("omega")[:] = omega
        sim.run()
        torque = sim.fix_rows()[:, 6:9]
        assert np.abs(sim.drag).max() < 1e-12 * STOKES
        if spins:
            expected = way.forces(spheres, omega)[:, 3:]
            assert np.abs(torque - expected).max() < 1e-10 * np.abs(expected).max()
            assert torque[:, 2].max() < 0.0
        else:
            assert np.abs(torque).max() == 0.0


@pytest.mark.hard_case("tensor oseen at R = 1.5 a")
@pytest.mark.parametrize("words", ["cut_off_distance inf", "cut_off_distance 9", "clumps_only yes",
                                   "cut_off_distance inf algorithm 1"])
@pytest.mark.parametrize("v", [(0, 0, 0.4), [(0, 0, 0.4), (0, 0, -0.4)]], ids=["same velocity", "approaching"])
def test_oseen_where_its_matrix_is_singular(simulation, words, v):
    """For one velocity there would be an answer, the same that lies beyond a matrix without one."""
    for s, refused in ((1.2, True), (1.5, True), (1.501, False)):
        sim = simulation(Spheres([(0, 0, 0), (0, 0, s * A)], A, v, molecule=1), f"{words} visc {ETA} tensor oseen " +
                         ("" if "algorithm" in words else EXACT))
        if refused:
            with pytest.raises(LammpsError,
                               match="not positive definite with tensor oseen.*must be below 1; use tensor rpy"):
                sim.run()
        elif "algorithm" not in words:
            w = 1.5 / s if len(np.shape(v)) == 1 else -1.5 / s
            assert np.abs(sim.run().drag[0, 2] * (1 + w) / (STOKES * 0.4) + 1) < 1e-9


@pytest.mark.hard_case("cut-off that ends within a clump, definite all the same")
@pytest.mark.parametrize("R,too_large", [(4.5, 0.3987), (6.5, 0.2298), (10.5, 0.0979), (18.5, 0.0)])
def test_cut_off_within_a_clump_is_warned_of(simulation, tmp_path, R, too_large):
    """Chain of ten along its axis, drag too large by 40, 23 and 10 %; at 18.5 a all see each other."""
    sim = simulation(chain(10, 2 * A, a=A, v=(0, 0, U[2])),
                     f"clumps_only yes cut_off_distance {R * A} visc {ETA} {EXACT}",
                     log=tmp_path / "log").run(2)
    assert -sim.drag[:, 2].sum() / (STOKES * U[2]) / 2.8644863357 - 1 == pytest.approx(too_large, abs=1e-4)
    sim.close()
    log = (tmp_path / "log").read_text().splitlines()
    warnings = [line for line in log if "is shorter than the clump of molecule 1:" in line]
    assert len(warnings) == (1 if too_large else 0)
    for line in warnings:
        note("says", line)


def test_cut_off_within_a_clump_is_warned_of_on_two_ranks(tmp_path):
    """Spheres that take no part are not missed. The chain crosses the border of the ranks, and those of the box."""
    spheres = chain(10, 2 * A, a=A, v=U)
    spheres.x[:, 2] += 1.0
    for last, missing in ((10, 28), (6, 6), (3, 0)):
        lines = input_lines(spheres, f"clumps_only yes cut_off_distance {4.5 * A} visc {ETA} group some {EXACT}",
                            tmp_path / "data", boundary="p p p", box=[(-20, 20), (-20, 20), (-15, 5)],
                            before_pair=f"group some id 1:{last}")
        log = lmp(tmp_path, lines + ["run 0"], ranks=2).log
        assert ("is shorter than the clump" in log) == (missing > 0)
        assert not missing or f"molecule 1: {missing} of its {last * (last - 1) // 2} pairs" in log


@pytest.mark.hard_case("tiny mass: the drag of the dense model, and a warning of the time step")
def test_tiny_mass(simulation, tmp_path):
    spheres, way = cloud(), WAYS["none"]
    sim = simulation(spheres, way.style(spheres), density=1e-200, log=tmp_path / "log").run()
    assert way.error(way.answer(sim), way.forces(spheres), spheres) < 1e-9
    sim.close()
    warnings = [line for line in (tmp_path / "log").read_text().splitlines() if f"WARNING: {PAIR}" in line]
    assert len(warnings) == 1 and "the time step 0.005 is above" in warnings[0]
    note("says", warnings[0])


NAN = {"sparse": "cut_off_distance inf precondition sparse",
       "clump": "cut_off_distance inf precondition clump", "rotation": "cut_off_distance inf rotation yes",
       "rigid": "clumps_only yes rigid_clumps yes"}


@pytest.mark.hard_case("NaN velocity between two runs, 1 and 2 ranks")
@pytest.mark.parametrize("words", NAN.values(), ids=list(NAN))
def test_velocity_that_is_nan_stops_the_run(simulation, words):
    """Also where there is a warm start and a factor from the steps before."""
    sim = simulation(cloud(), f"{words} visc {ETA} algorithm 2").run(3)
    sim.set("v", 7, [0.1, float("nan"), 0.2])
    with pytest.raises(LammpsError, match=f"{PAIR}: step 3, atom 7: its velocity is not a finite number"):
        sim.run(3)


@pytest.mark.hard_case("NaN velocity between two runs, 1 and 2 ranks")
@pytest.mark.parametrize("words", NAN.values(), ids=list(NAN))
def test_velocity_that_is_nan_stops_both_ranks(tmp_path, words):
    lines = input_lines(cloud(), f"{words} visc {ETA} algorithm 2", tmp_path / "data", comm="comm_modify cutoff 12")
    lines += ["variable bad atom vx+0*exp(999*(id==7))", "run 3", "velocity all set v_bad NULL NULL", "run 3"]
    ended = lmp(tmp_path, lines, ranks=2, succeed=False)
    assert ended.code != 0
    assert f"{PAIR}: step 3, atom 7: its velocity is not a finite number" in ended.log


@pytest.mark.hard_case("NaN angular velocity, 1 and 2 ranks")
@pytest.mark.parametrize("ranks", [1, 2])
def test_angular_velocity_that_is_nan_stops_all_ranks(tmp_path, ranks):
    lines = input_lines(cloud(), f"cut_off_distance inf rotation yes visc {ETA} algorithm 2", tmp_path / "data")
    lines += ["variable bad atom exp(999)-exp(999)", "group one id 7", "set group one omega v_bad 0 0", "run 3"]
    ended = lmp(tmp_path, lines, ranks=ranks, succeed=False)
    assert ended.code != 0
    assert f"{PAIR}: step 0, atom 7: its velocity is not a finite number" in ended.log


# --- ranks ------------------------------------------------------------------------------------------------------------

def hard_scene():
    """Radii 1:100 at random, which overlap and hide one another; two spheres at one point, two that touch."""
    rng = np.random.default_rng(9)
    x, a = rng.uniform(-40, 40, (40, 3)), np.exp(rng.uniform(np.log(0.3), np.log(30.0), 40))
    v = rng.normal(size=(40, 3))
    x[1], a[1], v[1] = x[0], a[0], v[0]
    x[3] = x[2] + (a[2] + a[3]) * np.array((0.6, 0.0, 0.8))
    return Spheres(x, a, v, molecule=1)


@pytest.fixture(scope="module", params=[1, pytest.param(2, marks=pytest.mark.ranks(2))], ids=["1 rank", "2 ranks"])
def hard_scene_forces(request, tmp_path_factory):
    """Of every way, in one run of lmp."""
    folder, lines = tmp_path_factory.mktemp("hard"), []
    columns = "f_drag[1] f_drag[2] f_drag[3] f_drag[7] f_drag[8] f_drag[9]"
    for name, way in WAYS.items():
        lines += input_lines(hard_scene(), way.style(hard_scene()), folder / "data", comm="comm_modify cutoff 200")
        lines += dump_lines(folder / name.replace(" ", "_"), columns=columns) + ["run 0", "clear"]
    lmp(folder, lines, ranks=request.param)
    return {name: read_dump(folder / name.replace(" ", "_"))[0][1] for name in WAYS}


@pytest.mark.hard_case("hidden, coincident and touching spheres of radii 1:100, 1 and 2 ranks")
@pytest.mark.parametrize("name", WAYS)
def test_hard_scene_on_ranks(hard_scene_forces, name):
    way, spheres = WAYS[name], hard_scene()
    answer = hard_scene_forces[name][:, :6 if way.rotation else 3]
    # The two at one point share their force in any way: as one sphere they have the sum.
    answer = np.vstack([answer[0] + answer[1], answer[2:]])
    one = Spheres(*(np.delete(part, 1, axis=0) for part in (spheres.x, spheres.a, spheres.v)), molecule=1)
    assert way.error(answer, way.forces(one), one) < 1e-8
