"""fix stokes_dynamics/overdamped with a temperature: covariance of one step against the mobility, Boltzmann's distribution in traps and
bonds, one run on several ranks and in pieces, and what is refused. Bounds are four standard deviations of the sample."""
import numpy as np
import pytest

import model
from system import LammpsError, Spheres, dump_lines, input_lines, lmp, read_dump

P6 = 6 * np.pi
ETA, A, KT = 1.3, 0.7, 0.8
UNIT = P6 * ETA * A
SHORT = 1e-11 * A**2 * UNIT / KT    # nothing moves in such a step


def noise(sim, options="", kT=KT, seed=12345, fix="move"):
    return sim.commands(f"fix {fix} all stokes_dynamics/overdamped temperature {kT!r} {seed} {options}")


def steps_of(sim, steps):
    """Displacements [steps, n, 3] of single steps"""
    out = []
    for k in range(steps):
        x = sim.x
        sim.run(1, "pre no post no" if k else "post no")
        out.append(sim.x - x)
    return np.array(out)


def copies(shape, count, spacing=12.0):
    """So many of a shape, each a molecule of its own, on a lattice"""
    k, side = np.arange(count), int(np.ceil(count**(1 / 3)))
    origin = spacing * np.column_stack([k % side, k // side % side, k // side**2])
    return Spheres((origin[:, None, :] + shape).reshape(-1, 3), A, molecule=np.repeat(k + 1, len(shape)))


def check_covariance(d, expected, dt, sigmas=4.5):
    """Samples d [n, k] of displacements against 2 kT dt times expected"""
    C = d.T @ d / len(d) / (2 * KT * dt)
    sigma = np.sqrt((np.outer(np.diag(expected), np.diag(expected)) + expected**2) / len(d))
    assert np.abs((C - expected) / sigma).max() < sigmas


# --- one step -------------------------------------------------------------------------------------------------------------

TRIO = A * np.array([(0, 0, 0), (2.5, 0, 0), (0.4, 2.3, 0.6)])


@pytest.mark.parametrize("rotation", ["no", "yes"])
def test_covariance_of_a_step_is_the_mobility(simulation, rotation):
    sim = noise(simulation(copies(TRIO, 2000), f"cut_off_distance inf visc {ETA} clumps_only yes rotation {rotation}", fix=False, dt=SHORT))
    d = steps_of(sim, 10).reshape(-1, 9)
    M = model.mobility(TRIO, np.full(3, A), ETA)
    assert M[0] * UNIT == pytest.approx([1, 0, 0, 0.536, 0, 0, 0.352475, 0.032310, 0.008429], abs=1e-6)
    check_covariance(d, M, SHORT)


def test_lone_spheres_move_as_einstein_says_and_normally(simulation):
    sim = noise(simulation(Spheres(copies(np.zeros((1, 3)), 4000).x, A), f"cut_off_distance inf visc {ETA} clumps_only yes", fix=False,
                           dt=SHORT))
    d = steps_of(sim, 8).ravel() / np.sqrt(2 * KT * SHORT / UNIT)
    n = len(d)
    assert d.mean() == pytest.approx(0, abs=4 / np.sqrt(n))
    assert (d**2).mean() == pytest.approx(1, abs=4 * np.sqrt(2 / n))
    assert (d**4).mean() == pytest.approx(3, abs=4 * np.sqrt(96 / n))


def test_open_cloud_has_the_covariance_of_all_pairs(simulation):
    """Four near spheres that all see each other: every draw is one sample."""
    x = A * np.array([(0, 0, 0), (2.2, 0, 0), (1.0, 1.9, 0), (0.8, 0.5, 1.7)])
    sim = noise(simulation(Spheres(x, A), f"cut_off_distance inf visc {ETA}", fix=False, dt=SHORT))
    check_covariance(steps_of(sim, 4000).reshape(-1, 12), model.mobility(x, np.full(4, A), ETA), SHORT)


# N, phi: 1 - 1.7600873 (phi/N)^(1/3) + phi/N for each sphere, wherever they stand (one point per sphere, equal radii)
@pytest.mark.parametrize("m, phi, own", [(2, 0.1, 0.604020), (3, 0.2, 0.664306), (5, 0.2, 0.795739)])
def test_self_diffusion_in_a_periodic_cube(simulation, m, phi, own):
    side = m * A * (4 / 3 * np.pi / phi)**(1 / 3)
    g = (np.arange(m) + 0.5) * side / m
    x = np.array([(p, q, r) for p in g for q in g for r in g]) + np.random.default_rng(m).uniform(-0.2, 0.2, (m**3, 3)) * A
    steps = max(100, 9000 // m**3)
    sim = noise(simulation(Spheres(x, A), f"cut_off_distance inf visc {ETA} far_field_tolerance 1e-4", fix=False, dt=SHORT, boundary="p p p",
                           box=[(0.0, side)] * 3))
    d = steps_of(sim, steps)
    assert d.std()**2 / (2 * KT * SHORT / UNIT) == pytest.approx(own, rel=4 * np.sqrt(2 / d.size) + 2e-3)


def test_periodic_noise_has_the_covariance_of_the_products(simulation):
    """The mobility by unit forces in the same box, and the drawn steps"""
    x = A * np.array([(0.5, 0.5, 0.5), (2.3, 1.0, 0.4), (1.1, 2.4, 3.0)])
    side = 6 * A
    style = f"cut_off_distance inf visc {ETA} far_field_tolerance 1e-5"
    M = np.zeros((9, 9))
    for k in range(9):
        sim = simulation(Spheres(x, A), style, fix=False, dt=SHORT, boundary="p p p", box=[(0.0, side)] * 3)
        force = ["0", "0", "0"]
        force[k % 3] = f"$(id=={k // 3 + 1})" if False else "v_one"
        sim.commands(f"variable one atom id=={k // 3 + 1}\nfix push all addforce {' '.join(force)}\n"
                     "fix move all stokes_dynamics/overdamped").run(0)
        M[:, k] = sim.v.ravel()
    sim = noise(simulation(Spheres(x, A), style, fix=False, dt=SHORT, boundary="p p p", box=[(0.0, side)] * 3))
    check_covariance(steps_of(sim, 4000).reshape(-1, 9), M, SHORT)


# --- rigid clumps ---------------------------------------------------------------------------------------------------------

CLUMPS = f"cut_off_distance inf visc {ETA} clumps_only yes rigid_clumps yes rotation yes"
L_OF_FOUR = A * np.array([(0, 0, 0), (2, 0, 0), (4, 0, 0), (0, 2, 0)])
ROD = A * np.array([(0, 0, 2.0 * k) for k in range(5)])


def rigid_motion(d, shape):
    """[samples, 6] displacement of the centroid and turn of samples d [samples, spheres, 3] of small displacements"""
    r = shape - shape.mean(axis=0)
    K = np.zeros((3 * len(r), 6))
    for k, (x, y, z) in enumerate(r):
        K[3 * k:3 * k + 3, :3] = np.eye(3)
        K[3 * k:3 * k + 3, 3:] = [(0, z, -y), (-z, 0, x), (y, -x, 0)]
    return np.linalg.lstsq(K, d.reshape(len(d), -1).T, rcond=None)[0].T


def test_clump_without_symmetry_moves_with_its_six_by_six(simulation):
    dt = 1e-4 * SHORT    # turns come from differences of positions: of the step no more than of rounding
    sim = noise(simulation(copies(L_OF_FOUR, 2500), CLUMPS, fix=False, dt=1e4 * dt))
    V = rigid_motion(steps_of(sim, 8).reshape(-1, 4, 3), L_OF_FOUR)
    V[:, 3:] *= A
    C = V.T @ V / len(V) / (2 * KT * SHORT) * UNIT
    known = {(0, 0): 0.561894, (1, 1): 0.517759, (2, 2): 0.473551, (0, 1): -0.019734, (0, 5): 0.008365, (1, 5): -0.012600,
             (2, 3): -0.010115, (2, 4): 0.007082}
    for (p, q), value in known.items():
        sigma = np.sqrt((C[p, p] * C[q, q] + value**2) / len(V))
        assert C[p, q] == pytest.approx(value, abs=4.5 * sigma), (p, q)


def test_rod_turns_as_its_diffusivity_says(simulation):
    """<u(0).u(t)> = exp(-2 D_r t) at D_r t = 1/4, of 2000 rods, within four deviations"""
    Dr = 0.033267 * KT / (8 * np.pi * ETA * A**3)
    steps = 25
    sim = noise(simulation(copies(ROD, 2000, 30.0), CLUMPS, fix=False, dt=0.25 / Dr / steps))
    def axes():
        x = sim.x.reshape(-1, 5, 3)
        u = x[:, 4] - x[:, 0]
        return u / np.linalg.norm(u, axis=1)[:, None]
    before = axes()
    sim.run(steps)
    assert np.abs(np.linalg.norm(np.diff(sim.x.reshape(-1, 5, 3), axis=1), axis=2) / (2 * A) - 1).max() < 1e-12
    assert (axes() * before).sum(axis=1).mean() == pytest.approx(np.exp(-0.5), abs=4 * 0.34 / np.sqrt(2000))


def test_tracking_by_the_centre_of_mobility_has_no_drift(simulation):
    """L of four in a trap on its centroid: <c^2> = 3 kT/k. About another point the noise would drive it."""
    k = 3.0
    count = 2000
    sim = simulation(copies(L_OF_FOUR, count), CLUMPS, fix=False, dt=0.1 * UNIT / k, before_pair="")
    sim.commands("fix home all property/atom d_hx d_hy d_hz") if False else None
    centre = np.repeat(copies(L_OF_FOUR, count).x.reshape(-1, 4, 3).mean(axis=1), 4, axis=0)
    offset = (L_OF_FOUR - L_OF_FOUR.mean(axis=0))
    # each sphere is pulled by k/4 of the distance of the centroid from its place: forces by compute chunk
    sim.commands("compute mol all chunk/atom molecule\ncompute com all com/chunk mol\ncompute spread all chunk/spread/atom mol c_com[*]")
    side = int(np.ceil(count**(1 / 3)))
    at = centre[0]
    sim.commands(f"variable n atom (mol-1)%{side}\nvariable m atom floor((mol-1)/{side})%{side}\nvariable l atom floor((mol-1)/{side * side})")
    for d, name, index in ((0, "x", "n"), (1, "y", "m"), (2, "z", "l")):
        sim.commands(f"variable f{name} atom -{k / 4!r}*(c_spread[{d + 1}]-12.0*v_{index}-({at[d]!r}))")
    sim.commands("fix trap all addforce v_fx v_fy v_fz")
    noise(sim).run(60)
    samples = []
    for _ in range(8):
        sim.run(15)
        c = sim.x.reshape(-1, 4, 3).mean(axis=1) - centre[::4]
        samples.append((c**2).sum(axis=1).mean())
    assert np.mean(samples) == pytest.approx(3 * KT / k, rel=0.03)
    assert offset.shape == (4, 3)
