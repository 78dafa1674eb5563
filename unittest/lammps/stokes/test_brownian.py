"""fix stokes_dynamics/overdamped with a temperature: covariance of one step against the mobility, Boltzmann's
distribution in traps and bonds, one run on several ranks and in pieces, and what is refused. Bounds are four standard
deviations of the sample."""
import os
import re

import numpy as np
import pytest

import model
from brownian import (A, END, ETA, KT, L_OF_FOUR, MOVE, P6, SHORT, TRIO, UNIT, check_covariance, check_heights,
                      check_pieces, check_ranks, copies, end, in_a_plane, in_clumps, noise, scattered, script, steps_of)
from host import by_open_mpi
from system import LammpsError, Spheres, input_lines, lmp

# --- one step ---------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("rotation", ["no", "yes"])
def test_covariance_of_a_step_is_the_mobility(simulation, rotation):
    sim = noise(simulation(copies(TRIO, 2000), f"cut_off_distance inf visc {ETA} clumps_only yes rotation {rotation}",
                           fix=False, dt=SHORT))
    d = steps_of(sim, 10).reshape(-1, 9)
    M = model.mobility(TRIO, np.full(3, A), ETA)
    assert M[0] * UNIT == pytest.approx([1, 0, 0, 0.536, 0, 0, 0.352475, 0.032310, 0.008429], abs=1e-6)
    check_covariance(d, M, SHORT)


def test_lone_spheres_move_as_einstein_says_and_normally(simulation):
    sim = noise(simulation(Spheres(copies(np.zeros((1, 3)), 4000).x, A),
                           f"cut_off_distance inf visc {ETA} clumps_only yes", fix=False,
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
    check_covariance(steps_of(sim, 2000).reshape(-1, 12), model.mobility(x, np.full(4, A), ETA), SHORT)


# N, phi: 1 - 1.7600873 (phi/N)^(1/3) + phi/N for each sphere, wherever they stand (one point per sphere, equal radii)
@pytest.mark.parametrize("m, phi, own", [(2, 0.1, 0.604020), (3, 0.2, 0.664306), (5, 0.2, 0.795739)])
def test_self_diffusion_in_a_periodic_cube(simulation, m, phi, own):
    side = m * A * (4 / 3 * np.pi / phi)**(1 / 3)
    g = (np.arange(m) + 0.5) * side / m
    x = (np.array([(p, q, r) for p in g for q in g for r in g]) +
         np.random.default_rng(m).uniform(-0.2, 0.2, (m**3, 3)) * A)
    steps = max(60, 4000 // m**3)
    sim = noise(simulation(Spheres(x, A), f"cut_off_distance inf visc {ETA} far_field_tolerance 1e-4", fix=False,
                           dt=SHORT, boundary="p p p", box=[(0.0, side)] * 3))
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
        force[k % 3] = "v_one"
        sim.commands(f"variable one atom id=={k // 3 + 1}\nfix push all addforce {' '.join(force)}\n"
                     "fix move all stokes_dynamics/overdamped").run(0)
        M[:, k] = sim.v.ravel()
    sim = noise(simulation(Spheres(x, A), style, fix=False, dt=SHORT, boundary="p p p", box=[(0.0, side)] * 3))
    check_covariance(steps_of(sim, 1500).reshape(-1, 9), M, SHORT)


# --- rigid clumps -----------------------------------------------------------------------------------------------------

CLUMPS = f"cut_off_distance inf visc {ETA} clumps_only yes rigid_clumps yes rotation yes"
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
    sim = noise(simulation(copies(L_OF_FOUR, 2500), CLUMPS, fix=False, dt=SHORT))
    V = rigid_motion(steps_of(sim, 8).reshape(-1, 4, 3), L_OF_FOUR)
    V[:, 3:] *= A
    C = V.T @ V / len(V) / (2 * KT * SHORT) * UNIT
    known = {(0, 0): 0.561894, (1, 1): 0.517759, (2, 2): 0.473551, (0, 1): -0.019734, (0, 5): 0.008365,
             (1, 5): -0.012600, (2, 3): -0.010115, (2, 4): 0.007082}
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


def home(count, centre, spacing=12.0):
    """Variables hx hy hz: how far an atom is from where the centroid of its clump of four was when copies() put it
    there"""
    side = int(np.ceil(count**(1 / 3)))
    return [f"variable hx atom x-({centre[0]:.17g})-{spacing}*((mol-1)%{side})",
            f"variable hy atom y-({centre[1]:.17g})-{spacing}*(floor((mol-1)/{side})%{side})",
            f"variable hz atom z-({centre[2]:.17g})-{spacing}*floor((mol-1)/{side * side})"]


def test_boltzmann_of_a_clump_in_a_field_and_a_trap(simulation):
    """Spheres pulled to one place are a trap on the centroid, <c^2> = 3 kT/k; a couple on the long arm a field, energy
    -2 kT cos: <cos> = coth 2 - 1/2. A clump that its noise moved about another point would drift against both."""
    count, k, E = 1000, 0.5 * KT / A**2, 2 * KT / (4 * A)
    sim = simulation(copies(L_OF_FOUR, count), CLUMPS, fix=False, dt=0.2 * UNIT * A**2 / KT)
    sim.commands(home(count, L_OF_FOUR.mean(axis=0)))
    sim.commands([f"variable f{d} atom -{k / 4!r}*v_h{d}" for d in "xyz"])
    sim.commands(f"variable couple atom {E!r}*((id-1)%4==2)-{E!r}*((id-1)%4==0)\n"
                 "fix trap all addforce v_fx v_fy v_fz\nfix field all addforce 0 0 v_couple")
    noise(sim).run(200)
    squares, cosines = [], []
    x0 = copies(L_OF_FOUR, count).x.reshape(-1, 4, 3).mean(axis=1)
    for _ in range(5):
        sim.run(30)
        x = sim.x.reshape(-1, 4, 3)
        squares.append(((x.mean(axis=1) - x0)**2).sum(axis=1))
        cosines.append((x[:, 2] - x[:, 0])[:, 2] / (4 * A))
    n = 3.0 * count    # samples 30 steps apart are not quite independent
    cosines = np.array(cosines)
    assert cosines.mean() == pytest.approx(0.53731, abs=4 * 0.417 / np.sqrt(n))
    assert (cosines**2).mean() == pytest.approx(0.46269, abs=4 * 0.31 / np.sqrt(n))
    assert np.mean(squares) * k / (3 * KT) == pytest.approx(1, abs=4 * np.sqrt(2 / (3 * n)) + 0.01)


# --- equilibrium of free spheres --------------------------------------------------------------------------------------

@pytest.mark.parametrize("scheme, expected", [("ab2", 1.0227), ("euler", 1.1111)])
def test_variance_in_a_trap_is_that_of_the_scheme(simulation, scheme, expected):
    """h = dt k/(6 pi eta a) = 0.2: (1 - h/2)/(1 - h/2 - h^2/2) and 1/(1 - h/2)"""
    k, h = 3.0, 0.2
    x = copies(np.zeros((1, 3)), 3000).x
    side = int(np.ceil(3000**(1 / 3)))
    sim = simulation(Spheres(x, A), f"cut_off_distance inf visc {ETA} clumps_only yes", fix=False, dt=h * UNIT / k)
    index = {"x": f"((id-1)%{side})", "y": f"(floor((id-1)/{side})%{side})", "z": f"floor((id-1)/{side * side})"}
    sim.commands([f"variable f{d} atom -{k!r}*({d}-12.0*{index[d]})" for d in "xyz"] +
                 ["fix trap all addforce v_fx v_fy v_fz"])
    noise(sim, f"scheme {scheme}").run(40)
    samples = []
    for _ in range(15):
        sim.run(12)
        samples.append(((sim.x - x)**2).mean())
    assert np.mean(samples) * k / KT == pytest.approx(expected, abs=4 * np.sqrt(2 / (3000 * 3 * 15 * 0.8)) * expected)


def test_bond_has_boltzmanns_length(simulation):
    """k = 100, r0 = 2.2 in units of kT and a, h = 0.1 for the relative motion: <r> - r0 = 0.009072, variance 9.959e-3
    (+0.5 %)."""
    count, k = 1200, 100 * KT / A**2
    spheres = copies(A * np.array([(0, 0, 0), (2.2, 0, 0)]), count).chain_bonds()
    rate = k / UNIT * 2 * (1 - 1.5 / 2.2 + 1 / 2.2**3)    # of r, by the mobility along the line
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} clumps_only yes", fix=False, dt=0.1 / rate)
    sim.commands(["bond_style harmonic", f"bond_coeff 1 {k / 2!r} {2.2 * A!r}"])
    noise(sim).run(60)
    lengths = []
    for _ in range(6):
        sim.run(30)
        x = sim.x.reshape(-1, 2, 3)
        lengths.append(np.linalg.norm(x[:, 1] - x[:, 0], axis=1) / A)
    r, n = np.array(lengths), 6 * count * 0.9
    assert r.mean() - 2.2 == pytest.approx(0.009072, abs=4 * 0.0998 / np.sqrt(n))
    assert r.var() == pytest.approx(9.959e-3 * 1.005, rel=4 * np.sqrt(2 / n) + 0.005)


# --- scheme midpoint: where the mobility has a drift ------------------------------------------------------------------

def test_bond_in_a_plane_has_boltzmanns_length(simulation, tmp_path):
    """k = 4, r0 = 2.2 in units of kT and a: <r> 2.31364, variance 0.23709; without the drift the mean is 0.107 sigma
    short."""
    count, k = 900, 4 * KT / A**2
    c = np.arange(count)
    origin = 12.0 * np.column_stack([c % 40, c // 40, 0 * c])
    pair = A * np.array([(0, 0, 0), (2.3, 0, 0)])
    spheres = Spheres((origin[:, None] + pair).reshape(-1, 3), A, molecule=np.repeat(c + 1, 2)).chain_bonds()
    sim = in_a_plane(simulation, tmp_path, spheres, f"cut_off_distance inf visc {ETA} clumps_only yes", 0.1 * UNIT / k)
    sim.commands(["bond_style harmonic", f"bond_coeff 1 {k / 2!r} {2.2 * A!r}", "comm_modify cutoff 8"])
    noise(sim, "scheme midpoint").run(60)
    lengths = []
    for _ in range(8):
        sim.run(25)
        x = sim.x.reshape(-1, 2, 3)
        lengths.append(np.linalg.norm(x[:, 1] - x[:, 0], axis=1) / A)
    assert (sim.x[:, 2] == 0).all()
    r, n = np.array(lengths), 8 * count * 0.9
    assert (r.mean() - 2.31364) / np.sqrt(0.23709) == pytest.approx(0, abs=4 / np.sqrt(n) + 0.003)
    assert r.var() == pytest.approx(0.23709, rel=4 * np.sqrt(2 / n) + 0.01)


def test_midpoint_is_of_second_order_in_the_forces_too(simulation):
    """A bonded pair that falls beside a third sphere: forces change with position."""
    x, ends = np.array([(0, 0, 0), (2.6, 0, 0.3), (-1.0, 3.5, 0)]), []
    for steps in (25, 50, 100, 1600):
        sim = simulation(Spheres(x, molecule=[1, 1, 2]).chain_bonds(), "cut_off_distance inf visc 1", fix=False,
                         dt=20.0 / steps, box=[(-90.0, 90.0)] * 3)
        sim.commands(["bond_style harmonic", "bond_coeff 1 4 2.2", f"fix weight all addforce 0 0 {-P6!r}",
                      "fix move all stokes_dynamics/overdamped scheme midpoint"]).run(steps)
        ends.append(sim.x)
    errors = [np.abs(e - ends[-1]).max() for e in ends[:-1]]
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2, abs=0.25)


def test_midpoint_with_steps_of_unequal_length_is_of_second_order_too(simulation):
    """Short ones and such three times as long, in turns: what a force was counts by the length of the step before."""
    x, ends = np.array([(0, 0, 0), (2.6, 0, 0.3), (-1.0, 3.5, 0)]), []
    for pairs in (10, 20, 40, 400):
        sim = simulation(Spheres(x, molecule=[1, 1, 2]).chain_bonds(), "cut_off_distance inf visc 1", fix=False, dt=1.0,
                         box=[(-90.0, 90.0)] * 3)
        sim.commands(["bond_style harmonic", "bond_coeff 1 4 2.2", f"fix weight all addforce 0 0 {-P6!r}",
                      "fix move all stokes_dynamics/overdamped scheme midpoint"])
        for k in range(2 * pairs):
            sim.command(f"timestep {20.0 / (4 * pairs) * (1 + 2 * (k % 2))!r}")
            sim.run(1, "pre no post no" if k else "post no")
        ends.append(sim.x)
    errors = [np.abs(e - ends[-1]).max() for e in ends[:-1]]
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2, abs=0.25)


FLOWS = {"velocity": ("fluid_velocity v_ux v_uy 0", ""), "viscosity": ("fluid_velocity 0 0 0.2", " visc v_eta"),
         "series": ("fluid_velocity grid flow", "")}


@pytest.mark.parametrize("what", FLOWS)
@pytest.mark.parametrize("model", ["rotation yes", "multiblob 12", "rotation yes rigid_clumps yes"])
def test_midpoint_is_of_second_order_in_a_flow_that_changes_in_time(simulation, tmp_path, what, model):
    """Formulas of time and place, and a series of grids: the fluid at x_mid is that of the middle of the step."""
    x, ends, (words, visc) = A * np.array([(0, 0, 0), (2.6, 0, 0.3), (-1.0, 3.5, 0)]), [], FLOWS[what]
    t = np.linspace(0, 2.0, 401)
    rows = "\n".join(f"{0.3 * np.cos(3 * s):.17g} {0.2 * np.sin(3 * s):.17g} 0.1" for s in t.tolist())
    (tmp_path / "flow").write_text("stokesdyn_grid 1\nx 1 0.0\ny 1 0.0\nz 1 0.0\ntime 401 0.0 2.0 clamp\n"
                                   f"columns ux uy uz\nrows text\n{rows}\n")
    for steps in (10, 20, 400):
        sim = simulation(Spheres(x, A, molecule=[1, 1, 2]), [
            "variable t equal step*dt", "variable eta equal 1.3+0.6*sin(3*v_t)",
            "variable ux atom 0.3*cos(3*v_t)+0.02*y*sin(3*v_t)", "variable uy atom 0.2*sin(3*v_t)+0.01*z*cos(3*v_t)",
            "pair_style stokes_dynamics cut_off_distance inf "
            f"{words.replace('grid flow', f'grid {tmp_path}/flow')}{visc or f' visc {ETA}'} "
            f"{model} relative_tolerance 1e-10", "pair_coeff * *"], fix=False, dt=2.0 / steps, box=[(-90.0, 90.0)] * 3)
        sim.commands([f"fix weight all addforce 0 0 {-P6!r}",
                      "fix move all stokes_dynamics/overdamped scheme midpoint"]).run(steps)
        ends.append(sim.x)
    errors = [np.abs(e - ends[-1]).max() for e in ends[:-1]]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2, abs=0.25)


def two_dumbbells():
    return Spheres(A * np.array([(0, 0, 0), (0, 0, 2), (2.3, 0.2, 0), (2.4, 2.2, 0), (-1, -2.5, 0.4)]), A,
                   molecule=[1, 1, 2, 2, 0])


def test_clumps_that_feel_each_other_move_with_their_common_mobility(simulation):
    """Both centroids and a free sphere: covariance of a step against velocities under unit forces"""
    share = np.kron(np.array([(0.5, 0.5, 0, 0, 0), (0, 0, 0.5, 0.5, 0), (0, 0, 0, 0, 1.0)]), np.eye(3))
    style = f"cut_off_distance inf visc {ETA} rigid_clumps yes rotation yes relative_tolerance 1e-8"
    N = np.zeros((9, 9))
    for k in range(9):
        sim = simulation(two_dumbbells(), style, fix=False, dt=SHORT)
        load = [f"{part:.17g}*(id=={i + 1})" for i, part in enumerate(share[k, k % 3::3]) if part]
        force = ["v_load" if d == k % 3 else "0" for d in range(3)]
        sim.commands([f"variable load atom {'+'.join(load)}", f"fix push all addforce {' '.join(force)}",
                      "fix move all stokes_dynamics/overdamped"]).run(0)
        N[:, k] = share @ sim.v.ravel()
    sim = noise(simulation(two_dumbbells(), style, fix=False, dt=SHORT), "scheme midpoint")
    d = steps_of(sim, 1500)
    check_covariance(d.reshape(-1, 15) @ share.T, N, SHORT)
    arm = d[:, 1] - d[:, 0]    # the dumbbells turn, and stay as long as they are
    assert np.abs(arm[:, 2]).max() < 1e-3 * np.abs(arm[:, 0]).max()


def test_spheres_above_a_wall_stand_as_boltzmann_says(simulation):
    check_heights(simulation, 8, "", "scheme midpoint")


LONE_CLUMPS = f"cut_off_distance inf visc {ETA} clumps_only yes rigid_clumps yes rotation yes"


def test_what_midpoint_cannot_move_is_an_error(simulation, tmp_path):
    spheres = Spheres(TRIO, A, molecule=[1, 1, 2])
    with pytest.raises(LammpsError, match="midpoint is for bodies that feel each other"):
        noise(simulation(spheres, LONE_CLUMPS, fix=False, dt=1e-3), "scheme midpoint").run(0)
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} rigid_clumps yes rotation yes", fix=False, dt=1e-3)
    sim.commands("group some molecule 1\nfix go some move linear 1 0 0")
    with pytest.raises(LammpsError, match="midpoint needs the orientation of clumps in the middle of a step"):
        noise(sim, "held some").run(0)


@pytest.mark.parametrize("words, options, message", [
    (f"cut_off_distance inf visc {ETA}", "scheme ab2",
     "dimension 2, which holds a coordinate: the mobility has a drift"),
    (LONE_CLUMPS, "", "lone clumps in a plane have a drift: use clumps_only no")])
def test_a_plane_needs_the_midpoint(simulation, tmp_path, words, options, message):
    sim = in_a_plane(simulation, tmp_path, Spheres([(0, 0, 0), (3, 0, 0)], A), words, 1e-3)
    with pytest.raises(LammpsError, match=message):
        noise(sim, options).run(0)


@pytest.mark.parametrize("style, scheme", [("", "ab2"), ("wall zlo -9", "midpoint"),
                                           ("rotation yes lubrication yes", "midpoint"),
                                           ("clumps_only yes rigid_clumps yes rotation yes", "ab2"),
                                           ("multiblob 12", "midpoint")])
def test_the_scheme_is_midpoint_where_a_drift_exists(simulation, style, scheme):
    ends = []
    for options in ("", f"scheme {scheme}"):
        sim = noise(simulation(Spheres(TRIO, A, molecule=[1, 1, 2]), f"cut_off_distance inf visc {ETA} {style}",
                               fix=False, dt=1e-3), options)
        ends.append(sim.run(2).x)
    assert (ends[0] == ends[1]).all()


# --- one run, in whatever pieces and on however many ranks ------------------------------------------------------------

MIDPOINT = " scheme midpoint"
WAYS = {"open": ("f f f", scattered, "cut_off_distance inf visc 1.1 rotation yes", ""),
        "periodic": ("p p p", scattered, "cut_off_distance inf visc 1.1 far_field_tolerance 1e-6", ""),
        "clumps": ("p p p", in_clumps, "cut_off_distance inf visc 1.1 clumps_only yes rigid_clumps yes rotation yes",
                   ""),
        "flexible": ("p p p", in_clumps, "cut_off_distance inf visc 1.1 clumps_only yes", ""),
        "clumps midpoint": ("f f f", in_clumps, "cut_off_distance inf visc 1.1 rigid_clumps yes rotation yes "
                                                "relative_tolerance 1e-12", MIDPOINT),
        "midpoint": ("p p p", scattered, "cut_off_distance inf visc 1.1 far_field_tolerance 1e-6", MIDPOINT)}


@pytest.mark.parametrize("way", by_open_mpi(WAYS.values(), but=2), ids=WAYS)
def test_ranks_and_newton_do_not_matter(tmp_path, way):
    check_ranks(tmp_path, way)


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
def test_a_run_in_pieces_is_the_run_in_one(tmp_path, way):
    check_pieces(tmp_path, way)


@pytest.mark.parametrize("way", ["open", "periodic", "clumps", "flexible"])
def test_temperature_0_is_the_run_without(tmp_path, way):
    """Bit for bit"""
    without = end(tmp_path, script(tmp_path, WAYS[way], END + ["run 20"], T=None))
    assert (end(tmp_path, script(tmp_path, WAYS[way], END + ["run 20"], T="0")) == without).all()


def test_numbers_of_the_root_are_told(simulation):
    spheres = scattered(100, 14.0)
    sim = simulation(spheres, "cut_off_distance inf visc 1.1", fix=False, dt=1e-6)
    noise(sim, "noise_tolerance 0.01").run(0)
    products, error = (sim.lmp.extract_fix("move", 0, 1, nrow=k) for k in (9, 10))
    assert 5 <= products <= 20 and error < 0.01 / 3
    sim.commands("unfix move")
    noise(sim, "noise_tolerance 1e-4").run(0)
    assert products < sim.lmp.extract_fix("move", 0, 1, nrow=9)
    assert sim.lmp.extract_fix("move", 0, 1, nrow=10) < 1e-4 / 3


def test_products_in_a_periodic_box_do_not_depend_on_the_number(simulation):
    """At most 7 of the near part; by the same rule as for 10^5 spheres"""
    for n, side in ((64, 11.0), (500, 21.8)):
        m = int(np.ceil(n**(1 / 3)))
        g = np.indices((m, m, m)).reshape(3, -1).T[:n] * side / m
        sim = simulation(Spheres(g + np.random.default_rng(2).uniform(-0.2, 0.2, g.shape)),
                         "cut_off_distance inf visc 1.1 far_field_tolerance 1e-3",
                         fix=False, dt=1e-6, boundary="p p p", box=[(0.0, side)] * 3)
        noise(sim).run(0)
        assert 3 <= sim.lmp.extract_fix("move", 0, 1, nrow=9) <= 7


# --- what is refused --------------------------------------------------------------------------------------------------

INF = f"cut_off_distance inf visc {ETA}"


@pytest.mark.parametrize("words, message", [("temperature -1 5", "'-1' must be >= 0"),
                                            ("temperature 1 0", "keyword temperature: '0' must"),
                                            ("temperature 1 5 noise_tolerance 0.5", "'0.5' must be below 0.5"),
                                            ("temperature 1 5 noise_tolerance 0", "noise_tolerance: '0' must be > 0"),
                                            ("temperature v_none 5", "variable 'none' does not exist"),
                                            ("temperature v_atoms 5", "keyword temperature: the variable must be of "
                                             "equal style: one value for all"),
                                            ("temperature v_minus 5", "'-2' must be >= 0, in step 0"),
                                            ("temperature 1 5 adapt 1 1e-3 1 1", "leave out adapt"),
                                            ("temperature 1 5\ntimestep -0.001", "the time step -0.001 is negative"),
                                            ("temperature 1 5 held some scheme ab2",
                                             "keyword held: the mobility has a drift"),
                                            ("noise_tolerance 0.1", "keyword noise_tolerance requires a temperature")])
def test_words_that_mean_nothing_are_errors(simulation, words, message):
    sim = simulation(Spheres(TRIO, A), INF, fix=False, dt=1e-3)
    sim.commands("variable atoms atom id\nvariable minus equal -2\ngroup some id 1")
    with pytest.raises(LammpsError, match=re.escape(message)):
        sim.commands(f"fix move all stokes_dynamics/overdamped {words}").run(0)


FIELD = "variable eta atom 1+0.1*x"


@pytest.mark.parametrize("style, lines, message", [
    (f"{INF} rotation yes lubrication yes", "",
     "keyword lubrication of pair_style stokes_dynamics: the mobility has a drift"),
    (f"{INF} multiblob 12", "", "keyword multiblob of pair_style stokes_dynamics: the mobility has a drift"),
    (f"{INF} rigid_clumps yes rotation yes", "", "with clumps that feel each other: the mobility has a drift"),
    (f"{INF} wall zlo -9", "", "keyword wall of pair_style stokes_dynamics: the mobility has a drift"),
    (f"{INF} tensor oseen", "", "use tensor rpy"),
    (f"cut_off_distance 4 clumps_only yes visc {ETA}", "",
     "keyword cut_off_distance: '4' of pair_style stokes_dynamics: the mobility has a drift"),
    (f"cut_off_distance 4 visc {ETA}", "",
     "keyword cut_off_distance: '4' of pair_style stokes_dynamics leaves out flows"),
    (f"cut_off_distance inf wall zlo -99 visc {ETA}", "",
     "keyword wall of pair_style stokes_dynamics: the mobility has a drift"),
    (f"cut_off_distance 4 taper wendland visc {ETA}", "",
     "keyword taper of pair_style stokes_dynamics: the mobility has a drift"),
    ("cut_off_distance inf visc v_eta", "", "keyword visc of pair_style stokes_dynamics, which varies in space"),
    ("clumps_only yes rigid_clumps yes shell 12 visc v_eta", "",
     "lone clumps in a viscosity that varies in space have a drift"),
    (INF, "fix step all dt/reset 10 NULL 0.1 0.1", "of style dt/reset makes steps of unequal length"),
    (INF, "fix bath all langevin 1 1 1 77", "of style langevin adds a drag to spheres"),
    (INF, "fix bath all viscous 1", "of style viscous adds a drag to spheres")])
def test_drifts_and_other_noise_are_errors(simulation, style, lines, message):
    sim = simulation(Spheres(TRIO, A, molecule=[1, 1, 2]), style, fix=False, dt=1e-3, before_pair=FIELD)
    sim.commands(lines)
    with pytest.raises(LammpsError, match=re.escape(message)):
        noise(sim, "scheme ab2").run(0)


def test_friction_is_an_error(simulation):
    style = [f"pair_style hybrid/overlay gran/hooke/history 10 NULL 0 NULL 0.5 0 stokes_dynamics {INF}",
             "pair_coeff * * gran/hooke/history", "pair_coeff * * stokes_dynamics"]
    sim = simulation(Spheres(TRIO, A), style, fix=False, dt=1e-3, comm="comm_modify vel yes")
    with pytest.raises(LammpsError, match=re.escape("pair_style gran/hooke/history has friction (0.5)")):
        noise(sim).run(0)


def test_steps_that_are_too_long_are_warned_of(tmp_path):
    lines = input_lines(Spheres(TRIO, A), INF, os.path.join(str(tmp_path), "spheres.data"), fix=False, dt=3.0,
                        box=[(-90.0, 90.0)] * 3)
    text = lmp(tmp_path, lines + [MOVE.format(1.0, 3), "run 1"]).text
    assert "of its radius: use a shorter time step" in text and "of half the skin, so that lists" in text
    quiet = [line.replace("timestep 3.0", "timestep 1e-4") for line in lines]
    text = lmp(tmp_path, quiet + [MOVE.format(1.0, 3), "run 1"]).text
    assert "of its radius: use" not in text and "Brownian motion, kT = 1, seed 3" in text
    text = lmp(tmp_path, lines + ["neighbor 0 bin", MOVE.format(1.0, 3), "run 1"]).text
    assert "of its radius: use a shorter time step" in text and "skin" not in text


def test_steps_that_come_again_have_the_same_numbers_and_are_warned_of(simulation, tmp_path):
    """The way out, another seed, has others, and runs that go on have no word."""
    sim = noise(simulation(Spheres(TRIO, A), INF, fix=False, dt=1e-3, log=tmp_path / "log"))
    moved, x = [], sim.x
    for before in ("", "reset_timestep 0", "reset_timestep 0\nunfix move\n" + MOVE.format(KT, 9)):
        sim.commands(before).run(5).run(5)
        moved.append(sim.x - x)
        x = sim.x
    told = " ".join((tmp_path / "log").read_text().split())
    assert told.count("noise of steps up to 10 was drawn with this seed before reset_timestep") == 1
    assert np.abs(moved[1] / moved[0] - 1).max() < 0.05 < np.abs(moved[2] / moved[0] - 1).min()


def test_frames_of_a_rerun_draw_nothing_and_have_no_word(simulation, tmp_path):
    sim = noise(simulation(Spheres(TRIO, A), INF, fix=False, dt=1e-3, log=tmp_path / "log"))
    sim.commands(f"dump d all custom 1 {tmp_path}/frames id x y z").run(5)
    sim.commands(f"undump d\nrerun {tmp_path}/frames dump x y z").run(5)
    assert "was drawn with this seed" not in " ".join((tmp_path / "log").read_text().split())


def test_a_temperature_that_follows_a_compute_is_that_of_the_step(simulation):
    """Whenever thermo output is written; the sphere in front goes fast, and the temperature with it."""
    ends = []
    for thermo in (1, 1000):
        sim = simulation(Spheres(TRIO, A), f"cut_off_distance inf visc {ETA}", fix=False, dt=0.01)
        sim.commands(["compute front all reduce max x", "variable T equal 1e-3*(1+c_front)",
                      "fix pull all addforce 50 0 0", f"thermo {thermo}",
                      "fix move all stokes_dynamics/overdamped temperature v_T 4711"]).run(20)
        ends.append(sim.x)
    assert np.ptp(ends[0][:, 0]) > 0.0 and np.array_equal(*ends)
