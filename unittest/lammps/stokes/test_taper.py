"""A taper is another model: its answer is that of the tapered matrix."""
import numpy as np
import pytest

import model
from suspensions import A, ALONG, ETA, EXACT, flocs, loose_lattice
from system import LammpsError, chain, largest_difference

TAPER = {"wendland": lambda q: np.where(q < 1, (1 - q)**4 * (1 + 4 * q), 0.0),
         "spherical": lambda q: np.where(q < 1, 1 - 1.5 * q + 0.5 * q**3, 0.0)}


def factors(x, taper, range_):
    t = TAPER[taper](np.linalg.norm(x[:, None] - x[None], axis=2) / range_)
    np.fill_diagonal(t, 1.0)
    return t


@pytest.mark.parametrize("taper", TAPER)
@pytest.mark.parametrize("mode,R", [("", 4.0), ("", 9.0), ("clumps_only yes", 6.0)])
def test_tapered_forces_against_a_dense_solve(simulation, taper, mode, R):
    spheres = flocs(6, 8, 8.0, spread=2.0)
    M = model.mobility(spheres.x, spheres.a, ETA, sees=model.same_clump(spheres) if mode else None)
    M *= np.kron(factors(spheres.x, taper, R), np.ones((3, 3)))
    expected = np.linalg.solve(M, -spheres.v.ravel()).reshape(-1, 3)
    sim = simulation(spheres, f"cut_off_distance {R} {mode} taper {taper} visc {ETA} {EXACT}",
                     comm="comm_modify cutoff 12").run()
    assert largest_difference(sim.drag, expected) < 1e-9


@pytest.mark.parametrize("taper", TAPER)
def test_tapered_forces_and_torques_against_a_dense_solve(simulation, taper):
    spheres, R = loose_lattice(3, v=1.0), 5.0
    spheres.a *= np.random.default_rng(7).uniform(0.6, 1.0, spheres.n)
    w = np.random.default_rng(8).normal(size=(spheres.n, 3))
    n = spheres.n
    M = model.mobility(spheres.x, spheres.a, ETA, rotation=True) * np.kron(factors(spheres.x, taper, R),
                                                                           np.ones((6, 6)))
    expected = np.linalg.solve(M, -np.hstack([spheres.v, w]).ravel()).reshape(n, 6)
    sim = simulation(spheres, f"cut_off_distance {R} taper {taper} rotation yes visc {ETA} {EXACT}")
    sim.raw("omega")[:] = w[sim.ids() - 1]
    sim.run()
    rows = sim.fix_rows()
    assert largest_difference(rows[:, 0:3], expected[:, :3]) < 1e-9
    assert largest_difference(rows[:, 6:9], expected[:, 3:]) < 1e-9


@pytest.mark.hard_case("cut-off that makes the matrix indefinite, with a taper")
@pytest.mark.parametrize("taper", TAPER)
def test_taper_solves_where_the_plain_cut_off_is_refused(simulation, taper):
    spheres, R = chain(10, 2 * A, a=A, v=ALONG, molecule=0), 2.5 * A
    words = f"cut_off_distance {R} visc {ETA} {EXACT}"
    with pytest.raises(LammpsError, match="not positive definite.*taper"):
        simulation(spheres, words).run()
    sim = simulation(spheres, f"{words} taper {taper}").run()
    assert sim.residual <= 1e-12 and sim.fix_scalar() > 0.0
    M = model.mobility(spheres.x, spheres.a, ETA) * np.kron(factors(spheres.x, taper, R), np.ones((3, 3)))
    assert largest_difference(sim.drag, np.linalg.solve(M, -spheres.v.ravel()).reshape(-1, 3)) < 1e-9
