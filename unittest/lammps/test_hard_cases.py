"""Hard scenes through LAMMPS: right, or a message that says why not. pytest --table prints what they report.

Most go through every way to solve a scene (ways.py). Cases that other files test have the mark hard_case there."""
import time

import numpy as np
import pytest

import model
from system import LammpsError, Spheres, chain, dump_lines, input_lines, largest_difference, lmp, note, read_dump
from ways import A, COLUMNS, ETA, EXACT, STOKES, WAYS, Way

PAIR = "Pair style stokes_dynamics"
U = np.array((0.3, -0.2, 0.4))


def all_ways(test):
    return pytest.mark.parametrize("way", WAYS.values(), ids=list(WAYS))(test)


def directions(rng, shape):
    e = rng.normal(size=shape + (3,))
    return e / np.linalg.norm(e, axis=-1)[..., None]


def cloud(n=20, seed=3):
    """Random spheres of radii 0.4 to 1.2, one clump; most overlap others, and one is hidden."""
    rng = np.random.default_rng(seed)
    spheres = Spheres(rng.uniform(-2, 2, (n, 3)), rng.uniform(0.4, 1.2, n), rng.normal(size=(n, 3)), molecule=1)
    spheres.x[1], spheres.a[1] = spheres.x[0] + 0.1, 0.2
    return spheres


def check(simulation, way, spheres, tolerance, **options):
    """The forces are those of dense algebra, the residual is the one it is said to be."""
    sim = simulation(spheres, way.style(spheres), **options).run()
    answer = way.answer(sim)
    assert way.error(answer, way.forces(spheres), spheres) < tolerance
    assert sim.residual <= 1e-12 and sim.fix_vector()[6] == 0
    return sim


# --- spheres in one another --------------------------------------------------------------------------------------------

@pytest.mark.hard_case("two equal spheres merge, R = 2a to 1e-14 a and 0")
@all_ways
def test_two_equal_spheres_merge(simulation, way):
    """Closed form along the axis: lambda = 1/(1 + w), w = 1 - 3 R/(16 a) where they overlap."""
    for s in (2.0, 1.0, 0.1, 1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 1e-14, 0.0):
        spheres = Spheres([(0, 0, 0), (0, 0, s * A)], A, (0, 0, U[2]), molecule=1)
        w = 1 - 3 * s / 16
        if way.taper:
            w *= model.TAPER[way.taper](s * A / (1.5 * s * A + 4 * A))
        sim = simulation(spheres, way.style(spheres)).run()
        error = abs(-sim.drag[:, 2].sum() / (STOKES * U[2]) - 2 / (1 + w))
        note("error", error)
        assert error < 1e-9 and np.abs(sim.drag[:, :2]).max() < 1e-9 * STOKES


@pytest.mark.hard_case("two equal spheres 1e-8 a apart, different velocities")
@all_ways
def test_nearly_coincident_spheres_with_different_velocities(simulation, way):
    """Their relative motion along the axis meets a resistance of 2 D/(3s/16), to the digits that are left of 1 - w."""
    s = 1e-8
    spheres = Spheres([(0, 0, 0), (0, 0, s * A)], A, [(0, 0, 0.1), (0, 0, 0.4)], molecule=1)
    w = 1 - 3 * s / 16
    if way.taper:
        w *= model.TAPER[way.taper](s * A / (1.5 * s * A + 4 * A))
    sim = simulation(spheres, way.style(spheres, "algorithm 2 relative_tolerance 1e-6 max_iter 100")).run()
    between = sim.drag[0, 2] - sim.drag[1, 2]
    assert between == pytest.approx(STOKES * 0.3 / (1 - w), rel=1e-6)
    assert sim.drag[:, 2].sum() == pytest.approx(-STOKES * 0.5 / (1 + w), abs=1e-7 * between)


@pytest.mark.hard_case("20 spheres hidden in another")
@all_ways
def test_twenty_spheres_hidden_in_another(simulation, way):
    rng = np.random.default_rng(1)
    a = np.append(3.0, rng.uniform(0.1, 1.0, 20))
    x = np.vstack([np.zeros(3), directions(rng, (20,)) * (rng.uniform(0, 1, 20) * (3.0 - a[1:]))[:, None]])
    spheres = Spheres(x, a, U, molecule=1)
    sim = check(simulation, way, spheres, 1e-9)
    if not way.taper:
        big = 6 * np.pi * ETA * 3.0
        assert np.abs(sim.drag[1:]).max() < 1e-9 * big
        assert np.abs(sim.drag[0] + big * U).max() < 1e-9 * big


@pytest.mark.hard_case("all spheres at one point, equal radii or not")
@pytest.mark.parametrize("radii", ["equal", "unequal"])
@all_ways
def test_all_spheres_at_one_point_drag_as_the_largest(simulation, way, radii):
    rng = np.random.default_rng(2)
    a = np.full(50, A) if radii == "equal" else rng.uniform(0.1, 1.4, 50)
    spheres = Spheres(np.tile((1.0, -2.0, 0.5), (50, 1)), a, U, molecule=1)
    sim = simulation(spheres, way.style(spheres, "algorithm 2 relative_tolerance 1e-9 max_iter 500")).run()
    expected = -6 * np.pi * ETA * a.max() * U
    note("error", np.abs(sim.drag.sum(axis=0) - expected).max() / np.linalg.norm(expected))
    assert np.abs(sim.drag.sum(axis=0) - expected).max() < 1e-8 * np.linalg.norm(expected)
    assert sim.fix_vector()[6] == 0


@pytest.mark.hard_case("equal spheres at one point, different velocities")
@all_ways
def test_equal_spheres_at_one_point_with_different_velocities_are_refused(simulation, way):
    v = np.random.default_rng(3).normal(size=(50, 3))
    spheres = Spheres(np.tile((1.0, -2.0, 0.5), (50, 1)), A, v, molecule=1)
    with pytest.raises(LammpsError, match="singular.*one point with different velocities"):
        simulation(spheres, way.style(spheres)).run()


@pytest.mark.hard_case("algorithm 1: equal spheres at one point")
@pytest.mark.parametrize("v", [U, [U, -0.3 * U]], ids=["same velocity", "different velocities"])
@pytest.mark.parametrize("words", ["cut_off_distance inf", "cut_off_distance 9", "clumps_only yes",
                                   "cut_off_distance inf rotation yes"])
def test_substitution_at_one_point_is_refused(simulation, words, v):
    """Its residual swings between two values for ever, and rounding says whether it falls."""
    for gap in (0.0, 1e-12, 1e-9):
        spheres = Spheres([(0, 0, 0), (0, 0, gap * A)], A, v, molecule=1)
        with pytest.raises(LammpsError, match="algorithm 1: diverged.*use algorithm 2"):
            simulation(spheres, f"{words} visc {ETA} algorithm 1 strict").run()


# --- radii of very different size ---------------------------------------------------------------------------------------

@pytest.mark.hard_case("radii 1:100, touching")
@all_ways
def test_touching_spheres_of_radii_one_to_hundred(simulation, way):
    """The matrix scaled to unit diagonal is harmless: eigenvalues 0.9 to 1.1 without rotation."""
    spheres = Spheres([(0, 0, 0), (0, 60.6 * A, 80.8 * A)], [A, 100 * A], [(0.3, -0.2, 0.4), (-0.1, 0.2, 0.5)], molecule=1)
    sim = check(simulation, way, spheres, 1e-10)
    assert sim.iterations <= 8


@pytest.mark.hard_case("a giant sphere, 1000 spheres of 1/100 in and around it (400 with rotation)")
@pytest.mark.parametrize("way", [w for w in WAYS.values() if "clump" not in w.words],
                         ids=[name for name, w in WAYS.items() if "clump" not in w.words])
def test_giant_sphere_with_tiny_ones(simulation, way):
    """Half of them are inside, the others touch or cross its surface, and one another."""
    rng = np.random.default_rng(4)
    n = 400 if way.rotation else 1000
    R = np.append(rng.uniform(0.0, 99.0, n // 2), rng.uniform(99.0, 101.0, n // 2))
    spheres = Spheres(np.vstack([np.zeros(3), directions(rng, (n,)) * R[:, None]]), np.append(100.0, np.ones(n)), U)
    sim = simulation(spheres, way.style(spheres, "algorithm 2 relative_tolerance 1e-8 max_iter 2000")).run()
    assert sim.residual <= 1e-8 and sim.fix_vector()[6] == 0
    assert way.residual(way.answer(sim), spheres) == pytest.approx(sim.residual, rel=1e-3, abs=1e-13)


def random_clumps(count, ratio, seed=1):
    """Clumps of 2 to 12 spheres, radii log-uniform in 1:ratio, each sphere crossing or within one before it; all in one box, so
    that clumps overlap each other, too. One group for each size: molecule [m], x [m,n,3], a [m,n], v [m,n,3]."""
    rng = np.random.default_rng(seed)
    size, groups = rng.integers(2, 13, count), []
    for n in range(2, 13):
        molecule = 1 + np.nonzero(size == n)[0]
        m = len(molecule)
        a = np.exp(rng.uniform(-0.5, 0.5, (m, n)) * np.log(ratio))
        x = np.zeros((m, n, 3))
        x[:, 0] = rng.uniform(0, 60, (m, 3))
        for i in range(1, n):
            to = rng.integers(i, size=m)
            R = rng.uniform(0, 1, m) * (a[:, i] + a[np.arange(m), to])
            x[:, i] = x[np.arange(m), to] + R[:, None] * directions(rng, (m,))
        groups.append((molecule, x, a, rng.normal(size=(m, n, 3))))
    return groups


@pytest.mark.hard_case("10 000 random overlapping clumps, radii 1:100, in one run")
@pytest.mark.parametrize("words,count,clump_error", [("precondition none", 10000, 1e-2), ("precondition clump", 10000, 1e-6),
                                                     ("rotation yes", 3000, 1e-2),
                                                     ("cut_off_distance 60 taper wendland", 10000, 1e-6)])
def test_ten_thousand_random_clumps(simulation, words, count, clump_error):
    """The residual is over all of them. A clump alone may be worse: without blocks the tolerance is shared by all."""
    groups = random_clumps(count, 100.0)
    spheres = Spheres(*(np.concatenate(parts) for parts in zip(*(
        (x.reshape(-1, 3), a.ravel(), v.reshape(-1, 3), np.repeat(molecule, a.shape[1])) for molecule, x, a, v in groups))))
    way = Way("clumps_only yes " + words, rotation="rotation" in words)
    sim = simulation(spheres, way.style(spheres, "algorithm 2 relative_tolerance 1e-6 max_iter 3000")).run()
    assert sim.residual <= 1e-6 and sim.fix_vector()[6] == 0
    answer, at, rest, rhs, worst = way.answer(sim), 0, 0.0, 0.0, 0.0
    for _, x, a, v in groups:
        m, n = a.shape
        F = answer[at:at + m * n].reshape(m, -1)
        at += m * n
        M = model.mobility(x, a, ETA, rotation=way.rotation, taper=("wendland", 60.0) if "taper" in words else None)
        D = 6 * np.pi * ETA * np.repeat(a[..., None], 3, axis=2)
        slip = -v
        if way.rotation:
            slip = np.concatenate([slip, 0 * slip], axis=2)
            D = np.concatenate([D, D * a[..., None] * (8 / 6) / np.sqrt(4 / 3)], axis=2)
        D, slip = D.reshape(m, -1), slip.reshape(m, -1)
        rest += (D**2 * (slip - np.einsum("kpq,kq->kp", M, F))**2).sum()
        rhs += (D**2 * slip**2).sum()
        exact = np.linalg.solve(M, slip[..., None])[..., 0]
        worst = max(worst, (np.linalg.norm(F - exact, axis=1) / np.linalg.norm(exact, axis=1)).max())
    note("error", worst)
    assert np.sqrt(rest / rhs) == pytest.approx(sim.residual, rel=1e-3, abs=1e-13)
    assert worst < clump_error


@pytest.mark.hard_case("clump of 300 overlapping spheres, radii 1:10")
@pytest.mark.parametrize("velocities", ["uniform", "random"])
@all_ways
def test_dense_clump_of_300_spheres(simulation, way, velocities):
    """The iterations of plain conjugate gradients for such clumps, by dense algebra: up to 151 and 383."""
    rng = np.random.default_rng(5)
    a = A * np.exp(rng.uniform(0, np.log(10), 300))
    x = np.zeros((300, 3))
    for i in range(1, 300):
        to = rng.integers(i)
        x[i] = x[to] + 0.6 * (a[i] + a[to]) * directions(rng, ())
    spheres = Spheres(x, a, U if velocities == "uniform" else rng.normal(size=(300, 3)), molecule=1)
    sim = simulation(spheres, way.style(spheres, "algorithm 2 relative_tolerance 1e-6 max_iter 1000")).run()
    answer = way.answer(sim)
    assert sim.residual <= 1e-6 and sim.fix_vector()[6] == 0
    assert sim.iterations <= (400 if velocities == "random" else 160)
    assert way.residual(answer, spheres) == pytest.approx(sim.residual, rel=1e-3, abs=1e-13)
    assert way.error(answer, way.forces(spheres), spheres) < 1e-3


# --- many ---------------------------------------------------------------------------------------------------------------

@pytest.mark.hard_case("touching chain of 1000")
@pytest.mark.parametrize("axis,total,iterations", [(2, 96.5627389569, 29), (0, 167.0455949432, 17)], ids=["along", "across"])
@pytest.mark.parametrize("words", ["cut_off_distance inf precondition none", "cut_off_distance inf precondition sparse",
                                   "clumps_only yes", "cut_off_distance 3000"])
def test_iterations_of_a_chain_of_1000(simulation, words, axis, total, iterations):
    spheres = chain(1000, 2 * A, a=A)
    spheres.v[:, axis] = 0.4
    sim = simulation(spheres, f"{words} visc {ETA} algorithm 2 relative_tolerance 1e-6").run()
    assert 1 <= sim.iterations <= iterations and sim.fix_vector()[6] == 0
    error = abs(-sim.drag[:, axis].sum() / (STOKES * 0.4) / total - 1)
    note("error", error)
    assert error < 1e-6


def growth_of_memory(run):
    """Megabytes that this process has at most while it runs, above those before."""
    def in_status(key):
        with open("/proc/self/status") as f:
            return next(int(line.split()[1]) * 1024e-6 for line in f if line.startswith(key))

    with open("/proc/self/clear_refs", "w") as f:
        f.write("5")                                # VmHWM, the peak, starts anew
    before = in_status("VmRSS")
    run()
    return in_status("VmHWM") - before


@pytest.mark.hard_case("memory of a chain of 4000")
@pytest.mark.parametrize("words", ["precondition none", "precondition sparse", "rotation yes"])
def test_memory_of_a_chain_of_4000(simulation, words):
    """One number for each pair would be 128 MB; LAMMPS's bins for sorting, in this empty box, too many to count."""
    spheres = chain(4000, 2 * A, a=A, v=U, molecule=0)
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance 0.1 {words}")
    assert growth_of_memory(sim.run) < 32.0
    assert sim.residual <= 0.1


@pytest.mark.hard_case("1 sphere selected of 100 000")
@pytest.mark.parametrize("words", ["cut_off_distance inf", "cut_off_distance 3", "clumps_only yes",
                                   "cut_off_distance inf rotation yes", "cut_off_distance 3 taper wendland",
                                   "clumps_only yes rigid_clumps yes"])
def test_one_sphere_among_100000(simulation, words):
    sim = simulation().commands(f"""
        units lj
        atom_style hybrid sphere bond
        boundary f f f
        atom_modify map array
        plugin load stokesdynplugin.so
        region box block 0 90 0 90 0 90
        create_box 1 box bond/types 1
        create_atoms 1 random 100000 77 box
        set group all diameter {2 * A} density 1.7
        velocity all create 1e-4 4
        group one id 77777
        set group one mol 9
        pair_style stokes_dynamics {words} visc {ETA} algorithm 2 group one
        pair_coeff * *
        fix drag all stokes_dynamics
        """)
    began = time.process_time()
    assert growth_of_memory(sim.run) < 250.0
    assert time.process_time() - began < 3.0         # a tenth of that on the machine of unittest/bench
    F, v = sim.drag, sim.v
    assert np.abs(F[77776] + STOKES * v[77776]).max() < 1e-14 * STOKES * np.abs(v[77776]).max()
    assert np.abs(np.delete(F, 77776, axis=0)).max() == 0.0


@pytest.mark.hard_case("tolerance below rounding")
@all_ways
def test_tolerance_that_rounding_does_not_allow(simulation, tmp_path, way):
    """The residual that conjugate gradients carry along falls for ever; the one reported is that of the answer."""
    spheres = cloud()
    sim = simulation(spheres, way.style(spheres, "algorithm 2 relative_tolerance 1e-18 max_iter 5000"), log=tmp_path / "log").run()
    assert 1e-17 < sim.residual < 1e-14 and sim.iterations < 500 and sim.fix_vector()[6] == 1
    assert way.error(way.answer(sim), way.forces(spheres), spheres) < 1e-12
    sim.close()
    warnings = [line for line in (tmp_path / "log").read_text().splitlines() if "algorithm 2: " in line]
    assert len(warnings) == 1 and "stopped at the accuracy of double precision" in warnings[0]
    note("says", warnings[0])


# --- spheres that move -------------------------------------------------------------------------------------------------

def frames_of(sim, steps):
    """[step, sphere, COLUMNS] of a run; nothing but what the commands before have set in motion moves."""
    sim.commands(dump_lines(sim.folder / "dump", columns=COLUMNS)).run(steps)
    assert sim.fix_vector()[6] == 0
    sim.command("undump out")
    return np.array([rows for _, rows in read_dump(sim.folder / "dump")])


def passing_by(simulation, way, x, dt):
    """A sphere of radius A at (x, 0.1, 0) that goes along -x through a larger one at the origin, past a third."""
    spheres = Spheres([(0, 0, 0), (x, 0.1, 0), (1.0, 2.0, -2.0)], [1.9, A, 1.1], [U, (-1, 0, 0), (0.1, 0.3, -0.2)], molecule=1)
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


# --- places and units ---------------------------------------------------------------------------------------------------

@pytest.mark.hard_case("radius 1e-9 m in SI units, radius 1e6, 1e8 radii from the origin")
@pytest.mark.parametrize("scale,eta,units,offset", [(1e-9, 1e-3, "si", 0.0), (1e6, 1.3, "lj", 0.0), (1.0, 1.3, "lj", 1e8)],
                         ids=["nanometres", "1e6", "far away"])
@all_ways
def test_scales_and_places(simulation, way, scale, eta, units, offset):
    spheres = cloud()
    spheres.x = (spheres.x + offset) * scale
    spheres.a *= scale
    spheres.v *= scale
    sim = simulation(spheres, way.style(spheres, EXACT, eta), units=units, before_pair=f"neighbor {0.1 * scale} bin").run()
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


# --- what the model does not have, and what is refused --------------------------------------------------------------------

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
            with pytest.raises(LammpsError, match="not positive definite with tensor oseen.*must be below 1; use tensor rpy"):
                sim.run()
        elif "algorithm" not in words:
            w = 1.5 / s if len(np.shape(v)) == 1 else -1.5 / s
            assert np.abs(sim.run().drag[0, 2] * (1 + w) / (STOKES * 0.4) + 1) < 1e-9


@pytest.mark.hard_case("cut-off that ends within a clump, definite all the same")
@pytest.mark.parametrize("R,too_large", [(4.5, 0.3987), (6.5, 0.2298), (10.5, 0.0979), (18.5, 0.0)])
def test_cut_off_within_a_clump_is_warned_of(simulation, tmp_path, R, too_large):
    """Chain of ten along its axis, drag too large by 40, 23 and 10 %; at 18.5 a all see each other."""
    sim = simulation(chain(10, 2 * A, a=A, v=(0, 0, U[2])), f"clumps_only yes cut_off_distance {R * A} visc {ETA} {EXACT}",
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
    ended = lmp(tmp_path, lines, ranks=2, timeout=30, succeed=False)
    assert ended.code != 0
    assert f"{PAIR}: step 3, atom 7: its velocity is not a finite number" in ended.log


@pytest.mark.hard_case("NaN angular velocity, 1 and 2 ranks")
@pytest.mark.parametrize("ranks", [1, 2])
def test_angular_velocity_that_is_nan_stops_all_ranks(tmp_path, ranks):
    lines = input_lines(cloud(), f"cut_off_distance inf rotation yes visc {ETA} algorithm 2", tmp_path / "data")
    lines += ["variable bad atom exp(999)-exp(999)", "group one id 7", "set group one omega v_bad 0 0", "run 3"]
    ended = lmp(tmp_path, lines, ranks=ranks, timeout=30, succeed=False)
    assert ended.code != 0
    assert f"{PAIR}: step 0, atom 7: its velocity is not a finite number" in ended.log


# --- ranks --------------------------------------------------------------------------------------------------------------

def hard_scene():
    """Radii 1:100 at random, which overlap and hide one another; two spheres at one point, two that touch."""
    rng = np.random.default_rng(9)
    x, a = rng.uniform(-40, 40, (40, 3)), np.exp(rng.uniform(np.log(0.3), np.log(30.0), 40))
    v = rng.normal(size=(40, 3))
    x[1], a[1], v[1] = x[0], a[0], v[0]
    x[3] = x[2] + (a[2] + a[3]) * np.array((0.6, 0.0, 0.8))
    return Spheres(x, a, v, molecule=1)


@pytest.fixture(scope="module", params=[1, 2], ids=["1 rank", "2 ranks"])
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
