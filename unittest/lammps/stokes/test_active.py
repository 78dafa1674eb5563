"""What directions do on average and in fields: free decay, Langevin's function with films, shells and a wall, active
diffusion, a dipole in a rotating field, a rod in a shear. Each against its closed form. Averages have a fixed seed and
their standard error beside them."""
import numpy as np
import pytest

import model
from brownian import A, ETA, KT, L_OF_FOUR, copies
from test_directions import CENTRE, MOVE, POINTS, SHELLS, SPIN, dipoles, directions, rotation
from test_squirmers import shells, swim

D = KT / SPIN    # of the rotation of a sphere
DRAG = 6 * np.pi * ETA * A
APART = f"{POINTS} clumps_only yes"
WIDE = [(-60.0, 400.0)] * 3


def unit(n, seed):
    e = np.random.default_rng(seed).normal(size=(n, 3))
    return e / np.linalg.norm(e, axis=1)[:, None]


def lattice(n, spacing=4.0):
    side = int(np.ceil(n**(1 / 3)))
    return spacing * np.array([(i // side**2, i // side % side, i % side) for i in range(n)], float)


# --- free decay -------------------------------------------------------------------------------------------------------

def test_directions_of_spheres_forget_as_exp_says(simulation, tmp_path):
    """<e(0).e(t)> = exp(-2 D t) at three times, within 1 % and four standard errors"""
    n, dt = 10000, 0.02
    e = unit(n, 5)
    sim = dipoles(simulation, tmp_path, lattice(n), e, APART, dt / D,
                  box=WIDE).commands(f"{MOVE} temperature {KT} 4711\nthermo 0")
    for t in (0.1, 0.2, 0.4):
        sim.run(round(t / dt) if t == 0.1 else round(t / 2 / dt))
        dots = (directions(sim) * e).sum(axis=1)
        error = dots.std() / np.sqrt(n)
        assert dots.mean() == pytest.approx(np.exp(-2 * t), abs=4 * error)
        assert dots.mean() == pytest.approx(np.exp(-2 * t), rel=0.01)


def exponential(M):
    values, vectors = np.linalg.eigh(0.5 * (M + M.T))
    return vectors * np.exp(values) @ vectors.T


@pytest.mark.parametrize("words, n, steps", [("clumps_only yes rigid_clumps yes", 4000, 20),
                                             ("rigid_clumps yes", 343, 12)])
def test_axes_of_clumps_forget_as_their_diffusion_tensor_says(simulation, tmp_path, words, n, steps):
    """<R(t)> = exp(-(tr D - D) t) of a body that begins along its own axes: nine numbers. D by unit torques."""
    tensor = np.zeros((3, 3))
    for d in range(3):
        sim = dipoles(simulation, tmp_path, L_OF_FOUR, (0, 0, 0), f"{POINTS} clumps_only yes rigid_clumps yes", 0.1,
                      molecule=1)
        sim.commands(f"group one id 1\n{MOVE} torque one {' '.join(str(int(k == d)) for k in range(3))}").run(0)
        tensor[:, d] = KT * sim.atom("omega")[0]
    t = 0.5 / np.trace(tensor)
    x = (lattice(n, 60.0 if n < 1000 else 8.0)[:, None] + L_OF_FOUR).reshape(-1, 3)
    sim = dipoles(simulation, tmp_path, x, (0, 0, 0), f"{POINTS} {words}", t / steps,
                  molecule=np.repeat(np.arange(1, n + 1), 4), box=[(-100.0, 700.0)] * 3)
    sim.commands(f"{MOVE} temperature {KT} 4711\nthermo 0").run(steps)
    R = rotation(sim.fix_rows("move")[::4, 9:13])
    errors = R.std(axis=0) / np.sqrt(n)
    expected = exponential(-(np.trace(tensor) * np.eye(3) - tensor) * t)
    assert np.abs(R.mean(axis=0) - expected).max() < 4 * errors.max() + 0.2 * t / steps * np.trace(tensor)
    assert expected[0, 0] - expected[2, 2] > 4 * errors.max() or n < 1000


# --- a field against noise --------------------------------------------------------------------------------------------

def in_equilibrium(n, kappa, seed=8):
    """Directions in a field along z"""
    u, phi = np.random.default_rng(seed).uniform(size=(2, n))
    z = 1 + np.log(u + (1 - u) * np.exp(-2 * kappa)) / kappa
    s = np.sqrt(1 - z**2)
    return np.column_stack([s * np.cos(2 * np.pi * phi), s * np.sin(2 * np.pi * phi), z])


def cosine_in_field(simulation, tmp_path, x, kappa, words, options="", tau=0.02, burn=50, steps=1, **more):
    """From equilibrium, which must stay: mean of cos after burn steps, over steps more, and an upper bound of its
    standard error"""
    sim = dipoles(simulation, tmp_path, x, in_equilibrium(len(x), kappa), words, tau / D, **more)
    sim.commands(f"fix field all efield 0 0 {kappa * KT!r}\n{MOVE} temperature {KT} 99 {options}\nthermo 0").run(burn)
    sim.commands("compute m all property/atom muz\ncompute r all reduce ave c_m\n"
                 "fix mean all ave/time 1 1 1 c_r ave running").run(steps)
    langevin = 1 / np.tanh(kappa) - 1 / kappa
    variance = 1 - 2 * langevin / kappa - langevin**2
    return sim, sim.lmp.extract_fix("mean", 0, 0), langevin, np.sqrt(variance / len(x) / max(1, tau * steps))


@pytest.mark.parametrize("kappa", [0.5, 2.0, 8.0])
def test_points_in_a_field_are_as_langevin_says(simulation, tmp_path, kappa):
    n = 4000
    sim, _, langevin, _ = cosine_in_field(simulation, tmp_path, lattice(n), kappa, APART, box=WIDE)
    z = directions(sim)[:, 2]
    assert z.mean() == pytest.approx(langevin, abs=3 * z.std() / np.sqrt(n))


PAIRS = (lattice(4, 30.0)[:, None] + A * np.array([(0, 0, 0), (2.15, 0, 0)])).reshape(-1, 3)
FLOOR = A * np.array([(20.0 * (k % 4), 20.0 * (k // 4), 1.1) for k in range(16)])
BESIDE = {"shells": (PAIRS, SHELLS, "pin all", {}), "films": (PAIRS, f"{POINTS} lubrication yes", "pin all", {}),
          "films between shells": (PAIRS[:4], f"{SHELLS} lubrication yes", "pin all", {}),
          "a wall": (FLOOR, f"{POINTS} wall zlo 0 lubrication yes", "pin all",
                     {"box": [(-40.0, 90.0)] * 2 + [(0.0, 40.0)]}),
          "free shells": (lattice(8, 12.0), SHELLS, "", {})}


@pytest.mark.parametrize("kappa", [0.5, 2.0, 8.0])
@pytest.mark.parametrize("beside", BESIDE)
def test_neighbours_films_and_walls_leave_langevins_function_alone(simulation, tmp_path, beside, kappa):
    """Whatever the mobility, and its drift: the error is the bound of a mean over time, whose correlations last 1/(2 D)
    or less."""
    x, words, options, more = BESIDE[beside]
    _, cosine, langevin, error = cosine_in_field(simulation, tmp_path, x, kappa, words,
                                                 options + " noise_tolerance 0.1", tau=0.05 if kappa == 8.0 else 0.1,
                                                 burn=10, steps=300, **more)
    assert cosine == pytest.approx(langevin, abs=3 * error)


# --- active particles -------------------------------------------------------------------------------------------------

def test_active_particles_diffuse_by_their_push(simulation, tmp_path):
    """<dx^2> = 6 D_t t + v^2/(2 D^2) (2 D t - 1 + exp(-2 D t)), that is D_t + v^2/(6 D) in the long run, within 2 %;
    and the speed is v."""
    n, dt, t, v = 8000, 0.04, 2.0, 3.0 * A * D
    e = unit(n, 6)
    sim = dipoles(simulation, tmp_path, lattice(n), e, APART, dt / D, box=WIDE)
    sim.commands(f"fix push all propel/self dipole {DRAG * v!r}\n{MOVE} temperature {KT} 4711\nthermo 0").run(0)
    assert np.abs(sim.v - v * e).max() < 1e-12
    start = sim.x
    sim.run(round(t / dt))
    squares = ((sim.x - start)**2).sum(axis=1)
    expected = 6 * KT / DRAG * t / D + v**2 / (2 * D**2) * (2 * t - 1 + np.exp(-2 * t))
    error = squares.std() / np.sqrt(n)
    assert squares.mean() == pytest.approx(expected, rel=0.02)
    assert squares.mean() == pytest.approx(expected, abs=4 * error)


def test_a_pushed_pair_is_as_dense_algebra_says(simulation, tmp_path):
    x, e, push = A * np.array([(0, 0, 0), (2.3, 0.4, 0.1)]), unit(2, 7), 2.5
    sim = dipoles(simulation, tmp_path, x, e, POINTS,
                  0.01).commands(f"fix push all propel/self dipole {push}\n{MOVE}").run(0)
    U = model.mobility(x, np.full(2, A), ETA, rotation=True) @ np.hstack([push * e, np.zeros((2, 3))]).ravel()
    assert np.abs(np.hstack([sim.v, sim.atom("omega")]).ravel() - U).max() < 1e-10 * np.abs(U).max()


# --- fields and flows without noise -----------------------------------------------------------------------------------

OMEGA = 0.7


def in_rotating_field(simulation, tmp_path, angle, words, scheme, steps):
    """The angle after the time 2, of a dipole in a field along x that rotates about z, mu E = 8 pi eta a^3"""
    sim = dipoles(simulation, tmp_path, CENTRE, (np.cos(angle), np.sin(angle), 0), f"{words} relative_tolerance 1e-12",
                  2.0 / steps)
    sim.commands(f"variable ex equal {SPIN!r}*cos({OMEGA}*step*dt)\nvariable ey equal {SPIN!r}*sin({OMEGA}*step*dt)\n"
                 f"fix field all efield v_ex v_ey 0\n{MOVE} scheme {scheme}").run(steps)
    return np.arctan2(*directions(sim)[0, 1::-1])


@pytest.mark.parametrize("words, scheme", [(POINTS, "euler"), (POINTS, "ab2"), (POINTS, "midpoint"), (SHELLS, "ab2")])
def test_a_dipole_lags_behind_a_rotating_field(simulation, tmp_path, words, scheme):
    """By the angle whose sine is omega 8 pi eta a^3/(mu E), whatever the step"""
    lag = np.arcsin(OMEGA)
    assert in_rotating_field(simulation, tmp_path, -lag, words, scheme, 20) == pytest.approx(2 * OMEGA - lag, abs=1e-12)


@pytest.mark.parametrize("scheme, order", [("euler", 1), ("ab2", 2), ("midpoint", 2)])
def test_a_dipole_turns_towards_a_rotating_field(simulation, tmp_path, scheme, order):
    """Observed order against its equation, angle' = sin(omega t - angle), and 1e-6 in short steps"""
    start, n = 2.0, 1000
    def rate(t, angle):
        return np.sin(OMEGA * t - angle)
    expected = start
    for k in range(n):
        t, h = 2.0 * k / n, 2.0 / n
        k1 = rate(t, expected)
        k2 = rate(t + h / 2, expected + h / 2 * k1)
        k3 = rate(t + h / 2, expected + h / 2 * k2)
        expected += h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(t + h, expected + h * k3))
    errors = [abs(in_rotating_field(simulation, tmp_path, start, POINTS, scheme, steps) - expected)
              for steps in (40, 80) + ((2000,) if order == 2 else ())]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.25)
    assert order == 1 or errors[2] < 1e-6


@pytest.mark.parametrize("scheme, order", [("euler", 1), ("ab2", 2), ("midpoint", 2)])
def test_the_axis_of_a_rod_goes_round_as_jeffery_says(simulation, tmp_path, scheme, order):
    """A dipole along a rod of five spheres in a shear: tan(angle) = r tan(t rate/(r + 1/r)), r from how fast it turns
    across the flow"""
    rod, rate, t = A * np.array([(0, 0, 2.0 * k) for k in range(5)]), 0.8, 4.0
    words = f"{POINTS} rigid_clumps yes relative_tolerance 1e-13 fluid_velocity v_u 0 0"
    def run(steps):
        sim = dipoles(simulation, tmp_path, rod, (0, 0, 1.0), words, t / max(1, steps), molecule=1)
        return sim.commands(f"variable u atom {rate}*z\n{MOVE} scheme {scheme}").run(steps)
    across = run(0).atom("omega")[0, 1] / rate    # r^2/(r^2 + 1)
    r = np.sqrt(across / (1 - across))
    expected = np.arctan(r * np.tan(rate * t / (r + 1 / r)))
    errors = []
    for steps in (40, 80) + ((2000,) if order == 2 else ()):
        e = directions(run(steps))[2]
        errors.append(abs(np.arctan2(e[0], e[2]) - expected))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.25)
    assert order == 1 or errors[2] < 1e-6


# --- two swimmers -----------------------------------------------------------------------------------------------------

def test_two_swimmers_are_as_dense_algebra_of_their_points_says(simulation, tmp_path):
    """The points of a lone swimmer, its slip there, and the tensor: written down anew, without the one-body addition"""
    x, e, B1 = A * np.array([(0, 0, 0), (2.4, 0.5, -0.3)]), unit(2, 9), 1.1
    sim = swim(simulation, tmp_path, x, e, shells(12, "one_body no"), f"squirm all {B1} 0").run(0)
    phi, R, b = 0.5 * (1 + np.sqrt(5)), 0.6563217307, 0.5622830568
    ico = np.array([p for s in (1, -1) for f in (phi, -phi) for p in ((0, s, f), (s, f, 0), (f, 0, s))]) / np.sqrt(
        1 + phi**2)
    turn = rotation(np.array([(1, 2, 3, 4)]) / np.sqrt(30))[0]
    r = A * R * ico @ turn.T
    points = (x[:, None] + r).reshape(-1, 3)
    M = model.mobility(points, np.full(24, A * b), ETA)
    K = np.zeros((72, 12))
    for i in range(2):
        for k in range(12):
            at = 36 * i + 3 * k
            K[at:at + 3, 6 * i:6 * i + 3] = np.eye(3)
            K[at:at + 3, 6 * i + 3:6 * i + 6] = np.cross(np.eye(3), r[k]).T
    def slip(direction, uniform):
        unit_r = r / A
        g = 0.1 * (2 * (unit_r**2).sum(axis=1)[:, None] * direction - unit_r * (unit_r @ direction)[:, None]) + (
            b**2 - 1) / 6 * direction
        return -2 / 3 * direction - 10 * (g - uniform * direction)
    lone = np.linalg.inv(M[:36, :36])
    uniform = (lone @ (slip(e[0], 0.0) + 2 / 3 * e[0]).ravel()).reshape(12, 3).sum(axis=0) @ e[0] / -10 / DRAG
    u = B1 * np.concatenate([slip(direction, uniform).ravel() for direction in e])
    resistance = np.linalg.inv(M)
    V = np.linalg.solve(K.T @ resistance @ K, -K.T @ resistance @ u).reshape(2, 6)
    assert np.abs(np.hstack([sim.v, sim.atom("omega")]) - V).max() < 1e-7
