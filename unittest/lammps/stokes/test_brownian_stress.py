"""The stress that Brownian motion adds (compute stokes_dynamics/stress): -kT div C/V, C: loads on bodies -> first
moments of the forces on the fluid. Its mean against differences of C, C against the velocities in strain, the
coefficient of phi^2 of a dilute suspension, pieces and ranks."""
import os

import numpy as np
import pytest

from brownian import ETA, KT, TIGHT, end, in_pieces, script
from host import by_open_mpi
from system import LammpsError, Spheres, dump_lines
from test_brownian_bodies import CROOKED, SHARP, close_spheres, in_few_clumps
from test_brownian_shear import DEFORM

# three unit spheres with films, and what an independent program finds for eta = kT = 1 with these
# films (0.41015 0.03902 0.67409 0.96436 1.97316 with its own, read from fewer means over the orientations of the
# shells), and without films
THREE = np.array([[0, 0, 0], [2.05, 0, 0], [0.3, 2.02, 0.5]])
OF_THREE = [0.41277, 0.03971, 0.67460, 0.96076, 1.97214]
WITHOUT_FILMS = [-0.134159, -0.065528, 0.075241, -0.024386, 0.094191]
WORDS = "cut_off_distance inf visc 1 relative_tolerance 1e-11 max_iter 400 multiblob 12"
FILMS = f"{WORDS} lubrication yes"
SUM = ["compute S all stokes_dynamics/stress variance {}",
       "compute sum all reduce sum " + " ".join(f"c_S[{k}]" for k in range(1, 13))]
BASIS = np.zeros((5, 3, 3))    # unit strains; the moments in them are those of OF_THREE
for k, (p, q) in enumerate([(0, 1), (0, 2), (1, 2)]):
    BASIS[k, p, q] = BASIS[k, q, p] = 0.5**0.5
BASIS[3] = np.diag([1, -1, 0]) / 2**0.5
BASIS[4] = np.diag([1, 1, -2]) / 6**0.5


def in_basis(xx, yy, zz, xy, xz, yz):
    return np.einsum("kpq,pq->k", BASIS, np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]))


def moments(simulation, spheres, words, lines, move=""):
    """Sum of first moments of a run of no steps, with these lines before the fix"""
    sim = simulation(spheres, words, fix=False, dt=1e-3)
    sim.commands(lines + [f"fix move all stokes_dynamics/overdamped {move}"] + [line.format("raw") for line in SUM] +
                 ["thermo_style custom step c_sum[1]"]).run(0)
    row = np.array([sim.lmp.extract_compute("sum", 0, 1)[k] for k in range(12)])
    return in_basis(*(row[:6] + row[6:]))


def push(ids, direction):
    return [f"group pushed id {' '.join(str(i) for i in ids)}",
            "fix push pushed addforce " + " ".join(repr(float(c) / len(ids)) for c in np.eye(3)[direction])]


def divergence(simulation, columns, d=1e-4):
    """Central differences: columns are functions that give a column of C where its coordinate is by so much another
    one"""
    return sum((column(d) - column(-d)) / (2 * d) for column in columns)


def of_sphere(simulation, spheres, words, i, direction):
    def column(d):
        x = spheres.x.copy()
        x[i, direction] += d
        return moments(simulation, Spheres(x, spheres.a, molecule=spheres.molecule), words, push([i + 1], direction))
    return column


def strain_velocity(simulation, x, E):
    """Velocities [n, 3] of free spheres in the flow E.x"""
    sim = simulation(Spheres(x), f"{FILMS} fluid_velocity v_u0 v_u1 v_u2", fix=False, dt=1e-3,
                     before_pair="\n".join(f"variable u{p} atom " + "+".join(f"({float(E[p, q])!r})*{'xyz'[q]}"
                                                                             for q in range(3)) for p in range(3)))
    return sim.commands("fix move all stokes_dynamics/overdamped").run(0).v


def test_the_mean_is_the_divergence_of_velocities_in_strain_too(simulation):
    """C is the transpose of what a strain does to the velocities, beyond carrying the spheres"""
    div = divergence(simulation, [of_sphere(simulation, Spheres(THREE), FILMS, i, d) for i in range(3)
                                  for d in range(3)])
    other, step = np.zeros(5), 1e-4
    for k in range(5):
        for i in range(3):
            for d in range(3):
                for sign in (1, -1):
                    x = THREE.copy()
                    x[i, d] += sign * step
                    other[k] += sign * (strain_velocity(simulation, x, BASIS[k]) - x @ BASIS[k])[i, d] / (2 * step)
    assert div == pytest.approx(-other, abs=1e-6) or div == pytest.approx(other, abs=1e-6)
    assert div == pytest.approx(OF_THREE, abs=6e-5)    # its constants of a lone sphere have six digits
    points = divergence(simulation, [of_sphere(simulation, Spheres(THREE), WORDS, i, d) for i in range(3)
                                     for d in range(3)])
    assert points == pytest.approx(WITHOUT_FILMS, abs=4e-6)


def sample(simulation, folder, spheres, words, steps, variance, dt=2e-7, seed=5):
    """[steps, 5] sums of moments over kT, in steps in which hardly anything moves"""
    sim = simulation(spheres, words, fix=False, dt=dt)
    sim.commands([f"fix move all stokes_dynamics/overdamped temperature {KT!r} {seed} noise_tolerance 1e-6"] +
                 [line.format(variance) for line in SUM] +
                 [f"fix out all ave/time 1 1 1 c_sum[*] start 2 file {folder}/moments"]).run(steps + 1)
    rows = np.loadtxt(os.path.join(folder, "moments"))
    return np.array([in_basis(*(row[1:7] + row[7:13])) for row in rows]) / KT


def check_mean(samples, expected, sigmas=4.0):
    error = samples.std(axis=0) / np.sqrt(len(samples))
    assert (np.abs(samples.mean(axis=0) - expected) < sigmas * error).all()
    return error


def test_the_stress_of_a_step_has_that_mean(simulation, tmp_path):
    spheres = Spheres(THREE)
    div = divergence(simulation, [of_sphere(simulation, spheres, FILMS, i, d) for i in range(3) for d in range(3)])
    low = check_mean(sample(simulation, tmp_path, spheres, FILMS, 1500, "low"), div)
    assert low.max() < 0.2 and div[4] > 20 * low[4]
    raw = check_mean(sample(simulation, tmp_path, spheres, FILMS, 200, "raw"), div)
    assert raw.min() > 200 * low.max()


def turned(x, axis, angle):
    c, s, centre = np.cos(angle), np.sin(angle), x.mean(axis=0)
    R = np.eye(3)
    p, q = (axis + 1) % 3, (axis + 2) % 3
    R[p, p], R[p, q], R[q, p], R[q, q] = c, -s, s, c
    return (x - centre) @ R.T + centre


def test_a_clump_has_it_too_with_its_turns(simulation, tmp_path):
    """A clump of four beside a sphere: the divergence is over the places of both and the turns of the clump. Random
    forces on its spheres are no stress of what holds it together."""
    words = f"{WORDS} rigid_clumps yes"
    x = np.vstack([CROOKED / 0.7, [(1.2, -1.9, 0.6)]])
    make = lambda x: Spheres(x, molecule=[1, 1, 1, 1, 0])

    def whole(direction):
        return lambda d: moments(simulation, make(np.vstack([x[:4] + d * np.eye(3)[direction], x[4:]])), words,
                                 push([1, 2, 3, 4], direction))

    def turn(axis):
        def column(d):
            torque = " ".join(repr(0.25 * float(c)) for c in np.eye(3)[axis])
            return moments(simulation, make(np.vstack([turned(x[:4], axis, d), x[4:]])), words,
                           ["group clump id 1 2 3 4"], f"torque clump {torque}")
        return column

    columns = [whole(d) for d in range(3)] + [turn(d) for d in range(3)] + [of_sphere(simulation, make(x), words, 4, d)
                                                                            for d in range(3)]
    div = divergence(simulation, columns)
    error = check_mean(sample(simulation, tmp_path, make(x), words, 1500, "low"), div)
    assert (np.abs(div) > 4 * error).any()


# --- a dilute suspension ----------------------------------------------------------------------------------------------

def pair_functions(simulation, gap, h, t):
    """A, B: V_1 - V_2 = E.r - r [A hh + B (1 - hh)].E.h of free spheres in a strain, r along h; G, H: their relative
    mobility along h and across, t, over that of far ones"""
    r = 2.0 + gap
    x = 0.5 * r * np.array([h, -h])
    relative = lambda v: v[0] - v[1]
    pull = relative(strain_velocity(simulation, x, np.outer(h, h) - np.eye(3) / 3))
    shear = relative(strain_velocity(simulation, x, np.outer(h, t) + np.outer(t, h)))
    mobility = []
    for e in (h, t):
        sim = simulation(Spheres(x), FILMS, fix=False, dt=1e-3)
        sim.commands([f"variable f{d} atom (3-2*id)*({float(e[d])!r})" for d in range(3)] +
                     ["fix pull all addforce v_f0 v_f1 v_f2", "fix move all stokes_dynamics/overdamped"]).run(0)
        mobility.append(relative(sim.v) @ e * 3 * np.pi)
    return 1 - pull @ h / (r * 2 / 3), 1 - shear @ t / r, *mobility


def directions(count):
    """Evenly over half a sphere, each with one across"""
    z = (np.arange(count) + 0.5) / count
    angle = 2.399963 * np.arange(count)
    h = np.column_stack([np.sqrt(1 - z**2) * np.cos(angle), np.sqrt(1 - z**2) * np.sin(angle), z])
    t = np.cross(h, (0.3, 0.2, -0.9))
    return zip(h, t / np.linalg.norm(t, axis=1)[:, None])


def test_the_coefficient_of_phi_squared_at_low_peclet_numbers(simulation):
    """Brownian part of the viscosity of a dilute suspension, 0.9125 phi^2 [5.9147 - 5.0022, recalled]. At Pe -> 0 the
    density of pairs is 1 - hEh f; the radial equation for f by finite volumes on a logarithmic grid, fluxes r^2 (V_r +
    D G f'), then the mean of div C."""
    gaps = np.array([1e-3, 4e-3, 0.012, 0.03, 0.07, 0.15, 0.3, 0.5, 0.75, 1.0, 1.5, 2.5, 4.0, 7.0, 14.0])
    fn = np.array([np.mean([pair_functions(simulation, gap, h, t) for h, t in directions(8)], axis=0) for gap in gaps])
    r0 = 2 + gaps
    table = np.column_stack([fn[:, 0] * r0**3, fn[:, 1] * r0**5, fn[:, 2] / np.where(gaps < 1, gaps / (gaps + 0.3), 1),
                             fn[:, 3]])

    def ABGH(r):
        q = np.log(np.clip(r - 2, gaps[0], gaps[-1]))
        A, B, G, H = (spline(np.log(gaps), column, q) for column in table.T)
        G = G * np.where(r < 3, (r - 2) / (r - 1.7), 1)
        far = r > 2 + gaps[-1]
        return A / r**3, B / r**5, np.where(far, 1 - 1.5 / r, G), np.where(far, 1 - 0.75 / r, H)

    n = 2000
    edge = 2 + np.exp(np.linspace(np.log(2e-4), np.log(60), n + 1))
    mid = 2 + np.sqrt((edge[1:] - 2) * (edge[:-1] - 2))
    (A, B, G, _), (_, Bm, _, Hm) = ABGH(edge), ABGH(mid)
    volume, V, D = np.diff(edge**3) / 3, edge * (1 - A), 2 / (6 * np.pi)
    rhs = np.diff(edge**2 * V) - 3 * (1 - Bm) * volume
    rhs[0] += edge[0]**2 * V[0]
    rhs[-1] = 0
    c = edge[1:-1]**2 * D * G[1:-1] / np.diff(mid)
    M = np.zeros((n, n))
    k = np.arange(n - 1)
    M[k, k + 1] += c
    M[k + 1, k] += c
    M[k, k] -= c
    M[k + 1, k + 1] -= c
    M[np.arange(n), np.arange(n)] -= 6 * D * Hm / mid**2 * volume
    M[-1] = 0
    M[-1, -1] = 1
    f = np.linalg.solve(M, rhs)
    div = -(np.diff(edge**3 * A) / volume - 3 * Bm)
    density = 3 / (4 * np.pi)
    coefficient = -0.5 * density**2 * (2 / 15) * (4 * np.pi * volume * div * f).sum() / 2
    assert coefficient == pytest.approx(0.91, abs=0.03)


def spline(x, y, at):
    """Cubic Hermite with slopes of parabolas through three points"""
    h, d = np.diff(x), np.diff(y) / np.diff(x)
    m = np.concatenate([[d[0]], (h[1:] * d[:-1] + h[:-1] * d[1:]) / (h[1:] + h[:-1]), [d[-1]]])
    k = np.clip(np.searchsorted(x, at) - 1, 0, len(h) - 1)
    t = (at - x[k]) / h[k]
    return (y[k] * (1 + 2 * t) * (1 - t)**2 + h[k] * m[k] * t * (1 - t)**2 + y[k + 1] * t**2 * (3 - 2 * t) + h[k] *
            m[k + 1] * t**2 * (t - 1))


# --- output -----------------------------------------------------------------------------------------------------------

COLUMNS = "xu yu zu vx vy vz " + " ".join(f"c_S[{k}]" for k in range(1, 13))
ROWS = dump_lines("end.dump", every=20, columns=COLUMNS)
WAYS = {"shells with films": ("p p p", close_spheres, f"{SHARP} multiblob 12 lubrication yes fluid_velocity box",
                              TIGHT + DEFORM),
        "clumps": ("p p p", in_few_clumps, f"{SHARP} rigid_clumps yes multiblob 12 lubrication yes", TIGHT)}


@pytest.mark.ranks(2)
@pytest.mark.parametrize("way", by_open_mpi(WAYS.values()), ids=WAYS)
def test_stress_of_a_run_in_pieces_is_that_of_the_run_in_one(tmp_path, way):
    make = lambda runs: script(tmp_path, way, ["compute S all stokes_dynamics/stress variance low"] + runs)
    whole, two, again = in_pieces(tmp_path, make, ROWS)
    scale = np.abs(whole[:, 6:]).max()
    for other in (two, again, end(tmp_path, make(ROWS + ["run 20"]), 2)):
        assert np.abs(other - whole)[:, 6:].max() < 1e-7 * scale


IN_SETUP = ["fix pull all addforce 0.3 0 -1", "fix move all stokes_dynamics/overdamped temperature 0.8 5"]


@pytest.mark.parametrize("variance, temperature", [("raw", 0.8), ("low", 0.8), ("raw", 0.0)])
@pytest.mark.parametrize("words", ["start 2", ""])
def test_averages_take_the_value_of_the_first_step_too(simulation, tmp_path, variance, temperature, words):
    """Where one value is asked for each time, LAMMPS takes the first in set-up, before the fixes that come later"""
    sim = simulation(Spheres(THREE), f"{FILMS}", fix=False, dt=1e-3)
    sim.commands(IN_SETUP[:1] + [line.format(variance) for line in SUM] +
                 [f"fix out all ave/time 1 1 2 c_sum[4] {words} file {tmp_path}/values"] +
                 [IN_SETUP[1].replace("0.8", str(temperature))] +
                 ["thermo 2", "thermo_style custom step c_sum[4]",
                  f"fix same all print 2 '$(step) $(c_sum[4]:%.8g)' file {tmp_path}/same"]).run(4).run(2)
    values, same = np.loadtxt(tmp_path / "values"), np.loadtxt(tmp_path / "same")
    assert list(values[:, 0]) == [0, 2, 4, 6] and np.abs(values[:, 1]).min() > 0
    for step, value in same:
        assert values[values[:, 0] == step, 1] == pytest.approx(value, rel=1e-5)


def test_averages_take_the_first_value_in_a_box_that_shears_too(simulation, tmp_path):
    """The solve of a step with noise reads the fluid half a step later"""
    sim = simulation(Spheres(THREE), f"{FILMS} fluid_velocity box", fix=False, dt=1e-3, boundary="p p p",
                     box=[(-10.0, 10.0)] * 3, tilt=(0.0, 0.0, 0.0))
    sim.commands(["fix shear all deform 1 xy erate 0.5 remap none", *IN_SETUP, "compute S all stokes_dynamics/stress",
                  f"fix out all ave/time 2 1 2 c_S[4] file {tmp_path}/values", "thermo_style custom c_S[4]"]).run(0)
    assert np.loadtxt(tmp_path / "values")[1] == pytest.approx(sim.lmp.extract_compute("S", 0, 1)[3], rel=1e-5)


def test_a_first_value_without_all_forces_is_an_error(simulation):
    sim = simulation(Spheres(THREE), FILMS, fix=False, dt=1e-3)
    sim.commands(IN_SETUP[1:] + [line.format("raw") for line in SUM] + ["fix out all ave/time 1 1 2 c_sum[4]"] +
                 IN_SETUP[:1])
    with pytest.raises(LammpsError,
                       match="before all forces of this step were known: define it after the fixes that add forces"):
        sim.run(2)


def test_pressure_of_the_particles_is_ideal_and_virial(simulation):
    """n kT, and the virial of springs; a clump counts once, who is held does not"""
    spheres = Spheres([(1, 1, 1), (3.1, 1, 1), (6, 6, 6), (8.1, 6, 6), (5, 1, 8)], molecule=[1, 1, 0, 0, 0],
                      bonds=[(3, 4)])
    sim = simulation(spheres, f"{WORDS} rigid_clumps yes", fix=False, dt=1e-3, boundary="p p p", box=[(0.0, 11.0)] * 3)
    sim.commands(["bond_style harmonic", "bond_coeff 1 3.5 1.7", "group held id 5", "comm_modify cutoff 5",
                  f"fix move all stokes_dynamics/overdamped temperature {KT!r} 5 held held",
                  "compute S all stokes_dynamics/stress", "thermo_style custom step c_S[19]"]).run(0)
    assert sim.lmp.extract_compute("S", 0, 1)[18] == pytest.approx((3 * KT + 2.1 * -2 * 3.5 * (2.1 - 1.7) / 3) /
                                                                   11.0**3, rel=1e-9)


# --- the pressure of a suspension at rest -----------------------------------------------------------------------------

def hard_spheres(n, phi, sweeps=300, seed=3):
    """Places of unit spheres in a periodic cube, and its edge: from a cubic lattice, by moves at random that keep them
    apart"""
    rng, edge = np.random.default_rng(seed), (4 / 3 * np.pi * n / phi)**(1 / 3)
    m = int(np.ceil((n / 4)**(1 / 3)))
    corner = np.array([(i, j, k) for i in range(m) for j in range(m) for k in range(m)], float)
    x = ((corner[:, None] + [(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)]).reshape(-1, 3) * edge / m)[:n]
    for _ in range(sweeps):
        for i, move in enumerate(rng.uniform(-0.3, 0.3, (n, 3))):
            d = x - x[i] - move
            r = np.linalg.norm(d - edge * np.rint(d / edge), axis=1)
            r[i] = 9.0
            if r.min() > 2.0:
                x[i] += move
    return x % edge, edge


@pytest.mark.parametrize("phi, steps", [(0.3, 500), (0.45, 400)])
def test_osmotic_pressure_is_that_of_carnahan_and_starling(simulation, tmp_path, phi, steps):
    """Value 19 of spheres at rest. Springs of stiffness k below a distance of 2 + (pi kT/2k)^1/2 make them as large as
    hard spheres of radius 1 (Barker & Henderson 1967). Its error: of blocks that are long beside the life of a
    contact."""
    x, edge = hard_spheres(32, phi)
    k = 400.0 * KT
    reach = 2 + (np.pi * KT / (2 * k))**0.5
    style = [f"pair_style hybrid/overlay soft {reach!r} stokes_dynamics cut_off_distance inf visc "
             f"{1 / (6 * np.pi)!r} multiblob 12",
             f"pair_coeff * * soft {k * (reach / np.pi)**2!r}", "pair_coeff * * stokes_dynamics"]
    sim = simulation(Spheres(x), style, fix=False, dt=2.5e-4 / KT, boundary="p p p", box=[(0.0, float(edge))] * 3)
    noise = f"fix move all stokes_dynamics/overdamped temperature {KT!r} 5"
    sim.commands([noise, "compute S all stokes_dynamics/stress",
                  f"fix out all ave/time 2 1 2 c_S[19] start 4 file {tmp_path}/pressure"]).run(steps)
    p = np.loadtxt(os.path.join(tmp_path, "pressure"))[:, 1] * edge**3 / (32 * KT)
    blocks = np.array([part.mean() for part in np.array_split(p[len(p) // 5:], 8)])
    exact = (1 + phi + phi**2 - phi**3) / (1 - phi)**3
    error = blocks.std(ddof=1) / len(blocks)**0.5
    assert error < 0.12 * exact
    assert blocks.mean() == pytest.approx(exact, abs=4 * error)
