"""Hard scenes through LAMMPS: right, or a message that says why not. pytest --table prints what they report.

Most go through every way to solve a scene (ways.py). Cases that other files test have the mark hard_case there."""
import time

import numpy as np
import pytest

import model
from hard import U, all_ways, check, cloud, directions
from system import LammpsError, Spheres, chain, note
from ways import A, ETA, STOKES, WAYS, Way


# --- spheres in one another -------------------------------------------------------------------------------------------

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


# --- radii of very different size -------------------------------------------------------------------------------------

@pytest.mark.hard_case("radii 1:100, touching")
@all_ways
def test_touching_spheres_of_radii_one_to_hundred(simulation, way):
    """The matrix scaled to unit diagonal is harmless: eigenvalues 0.9 to 1.1 without rotation."""
    spheres = Spheres([(0, 0, 0), (0, 60.6 * A, 80.8 * A)], [A, 100 * A], [(0.3, -0.2, 0.4), (-0.1, 0.2, 0.5)],
                      molecule=1)
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
    """Clumps of 2 to 12 spheres, radii log-uniform in 1:ratio, each sphere crossing or within one before it; all in one
    box, so that clumps overlap each other, too. One group for each size: molecule [m], x [m,n,3], a [m,n], v
    [m,n,3]."""
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
@pytest.mark.parametrize("words,count,clump_error",
                         [("precondition none", 10000, 1e-2), ("precondition clump", 10000, 1e-6),
                          ("rotation yes", 3000, 1e-2),
                          ("cut_off_distance 60 taper wendland", 10000, 1e-6)])
def test_ten_thousand_random_clumps(simulation, words, count, clump_error):
    """The residual is over all of them. A clump alone may be worse: without blocks the tolerance is shared by all."""
    groups = random_clumps(count, 100.0)
    spheres = Spheres(*(np.concatenate(parts) for parts in zip(*(
        (x.reshape(-1, 3), a.ravel(), v.reshape(-1, 3), np.repeat(molecule, a.shape[1])) for molecule, x, a,
        v in groups))))
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


# --- many -------------------------------------------------------------------------------------------------------------

@pytest.mark.hard_case("touching chain of 1000")
@pytest.mark.parametrize("words", ["cut_off_distance inf precondition none", "cut_off_distance inf precondition sparse",
                                   "clumps_only yes", "cut_off_distance 3000"])
def test_iterations_of_a_chain_of_1000(simulation, words):
    """Along and across one after the other: where its matrix is factored, that takes longer than all else."""
    sim = simulation(chain(1000, 2 * A, a=A), f"{words} visc {ETA} algorithm 2 relative_tolerance 1e-6 warm_start no")
    for axis, total, iterations in ((2, 96.5627389569, 29), (0, 167.0455949432, 17)):
        sim.raw("v")[:] = 0.4 * np.eye(3)[axis]
        sim.run()
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


@pytest.mark.hard_case("memory of 4000 shells with films")
def test_memory_of_4000_shells_with_films(simulation):
    """Vectors of a solve are the largest part: two more doubles per coordinate of a point are 0.6 kB per sphere, as
    are those of the films' own solve."""
    sim = simulation().commands("""
        units lj
        atom_style sphere
        atom_modify sort 0 0
        plugin load stokesdynplugin.so
        lattice fcc 0.0716
        region box block 0 10 0 10 0 10
        create_box 1 box
        create_atoms 1 box
        set group all diameter 2.0 density 1.0
        displace_atoms all random 0.05 0.05 0.05 5
        pair_style stokes_dynamics cut_off_distance inf visc 1.0 algorithm 2 multiblob 12 lubrication yes
        pair_coeff * *
        fix load all addforce 0 0 -1.0
        fix move all stokes_dynamics/overdamped
        timestep 1e-4
        """)
    growth = growth_of_memory(lambda: sim.command("run 3 post no")) / 4.0
    note("kB per sphere", growth)
    assert growth < 14.2


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
    sim = simulation(spheres, way.style(spheres, "algorithm 2 relative_tolerance 1e-18 max_iter 5000"),
                     log=tmp_path / "log").run()
    assert 1e-17 < sim.residual < 1e-14 and sim.iterations < 500 and sim.fix_vector()[6] == 1
    assert way.error(way.answer(sim), way.forces(spheres), spheres) < 1e-12
    sim.close()
    warnings = [line for line in (tmp_path / "log").read_text().splitlines() if "algorithm 2: " in line]
    assert len(warnings) == 1 and "stopped at the accuracy of double precision" in warnings[0]
    note("says", warnings[0])
