"""fix stokes_dynamics/overdamped with spin: spheres that a field keeps spinning, by a torque that is found and may be
cut."""
import re

import numpy as np
import pytest

from brownian import A, END, ETA, KT, TIGHT, check_heights, check_pieces, check_ranks, end, noise, script
from system import LammpsError, Spheres

FIX = "fix move all stokes_dynamics/overdamped"
BOX = [(-30.0, 30.0)] * 3
X = np.array([(0, 0, 0), (2.3, 0.4, 0), (0.7, 2.6, 0.5), (2.0, 2.0, 3.5), (5.0, -1.0, 1.0)])
W = np.array((0.3, 2.0, -0.4))
LOAD = np.array([(np.sin(3 * i), 0.1 * i, -5 - 0.2 * i) for i in range(1, 6)])
PULL = ("variable fx atom sin(3*id)\nvariable fy atom 0.1*id\nvariable fz atom -5-0.2*id\n"
        "fix pull all addforce v_fx v_fy v_fz")
SPUN, FREE = [0, 2, 3], [1, 4]


def spinning(simulation, words, options=f"spin some {W[0]} {W[1]} {W[2]}", molecule=0, x=X):
    sim = simulation(Spheres(x, molecule=molecule), f"cut_off_distance inf visc {ETA} {words} relative_tolerance 1e-10",
                     fix=False, box=BOX, dt=0.02)
    return sim.commands(f"group some id 1 3 4\n{PULL}\n{FIX} {options}")


def twist(sim, torques):
    """Torques [n, 3] by atom ID"""
    def add(_lmp, _step, n, tag, _x, f):
        f[:] = 0
        sim.raw("torque")[:n] += torques[np.asarray(tag).ravel()[:n] - 1]
    sim.command("fix field all external pf/callback 1 1")
    sim.lmp.set_fix_external_callback("field", add)
    return sim


@pytest.mark.parametrize("words", ["rotation yes", "rotation yes lubrication yes", "rotation yes wall zlo -3",
                                   "multiblob 12 lubrication yes", "rotation yes lubrication yes wall zlo -2.5",
                                   "rotation yes rigid_clumps yes lubrication yes"])
def test_spun_spheres_turn_as_told_by_the_torque_that_is_found(simulation, words):
    """The same torques, put on spheres that are free, turn them as fast and move all alike."""
    molecule = [0, 7, 0, 0, 7] if "clumps" in words else 0
    sim = spinning(simulation, words, molecule=molecule).run(3)
    rows, omega, v, x = sim.fix_rows("move"), sim.atom("omega"), sim.v, sim.x
    assert np.abs(omega[SPUN] - W).max() < 1e-12 and np.abs(omega[FREE] - W).max() > 1
    assert np.abs(rows[SPUN, 6:9]).max(axis=1).min() > 1
    again = twist(spinning(simulation, words, "", molecule, x), np.isin(range(5), SPUN)[:, None] * -rows[:, 6:9]).run(0)
    assert np.abs(again.v - v).max() < 1e-6 * np.abs(v).max()
    assert np.abs(again.atom("omega") - omega).max() < 1e-6
    if molecule == 0:
        assert np.abs(rows[:, 3:6] + LOAD).max() < 1e-7 * np.abs(LOAD).max() and np.abs(rows[FREE, 6:9]).max() < 1e-6


def test_a_lone_sphere_needs_the_torque_of_stokes(simulation):
    sim = simulation(Spheres([(0, 0, 0)], A), f"cut_off_distance inf visc {ETA} rotation yes", fix=False, box=BOX,
                     dt=0.1)
    sim.commands(f"{FIX} spin all {W[0]} {W[1]} {W[2]}").run(1)
    assert sim.fix_rows("move")[0, 6:9] == pytest.approx(-8 * np.pi * ETA * A**3 * W, rel=1e-12)


def test_above_the_largest_torque_a_sphere_slips(simulation):
    """Of two spheres one is close to the floor: its film needs more. It turns by the largest torque, and the other one
    as told."""
    w, far = 3.0, 8 * np.pi * ETA
    x = np.array([(0, 0, 1.01), (9, 0, 9.0)])
    def run(most, steps=4):
        sim = simulation(Spheres(x), f"cut_off_distance inf visc {ETA} rotation yes lubrication yes wall zlo 0 "
                                     "relative_tolerance 1e-9", fix=False,
                         box=[(-30.0, 40.0), (-30.0, 30.0), (-1.0, 30.0)], dt=1e-4)
        return sim.commands(f"group tops id 1 2\n{FIX} spin tops 0 {w} 0 {most}").run(steps)
    free = run("")
    need = -free.fix_rows("move")[:, 7]
    assert need[0] > 1.8 * far * w and need[1] == pytest.approx(far * w, rel=0.01)
    assert free.lmp.extract_fix("move", 0, 1, nrow=11) == 0
    cut = run(1.5 * far * w)
    assert cut.lmp.extract_fix("move", 0, 1, nrow=11) == 1
    assert cut.fix_rows("move")[0, 6:9] == pytest.approx((0, -1.5 * far * w, 0), abs=1e-6 * far * w)
    assert cut.atom("omega")[1, 1] == pytest.approx(w, rel=1e-12) and 0.3 * w < cut.atom("omega")[0, 1] < 0.9 * w
    cut.commands("displace_atoms all move 0 0 3").run(4)    # up there it needs less, and is as fast as told
    assert cut.lmp.extract_fix("move", 0, 1, nrow=11) == 0 and cut.atom("omega")[0, 1] == pytest.approx(w, rel=1e-12)
    assert run(2 * need[0]).lmp.extract_fix("move", 0, 1, nrow=11) == 0
    left = run(1.5 * far * w)    # who leaves the group does not slip
    assert left.lmp.extract_fix("move", 0, 1, nrow=11) == 1
    left.commands("group tops clear\ngroup tops id 2").run(0)
    assert left.lmp.extract_fix("move", 0, 1, nrow=11) == 0


@pytest.mark.parametrize("of_others, turns", [(5.0, 4.0), (1.0, 2.0), (-5.0, -4.0), (2.5, 3.0), (3.5, 3.0)])
def test_a_sphere_that_slips_is_driven_or_braked(simulation, of_others, turns):
    """Angular velocities about y, of a lone sphere and a field of 3: other torques alone would give the first, the
    field's largest torque gives 1."""
    sim = simulation(Spheres([(0, 0, 0)], A), f"cut_off_distance inf visc {ETA} rotation yes", fix=False, box=BOX,
                     dt=1e-4)
    unit = 8 * np.pi * ETA * A**3
    twist(sim.commands(f"{FIX} spin all 0 3 0 {unit}"), np.array([(0, of_others * unit, 0)])).run(3)
    assert sim.atom("omega")[0] == pytest.approx((0, turns, 0), abs=1e-9)
    assert sim.lmp.extract_fix("move", 0, 1, nrow=11) == (turns != 3.0)


def test_spun_spheres_diffuse_as_boltzmann_says(simulation):
    """Held from turning they have another mobility, and its drift."""
    sim = check_heights(simulation, 6, "rotation yes", "spin all 0 0 0")
    assert np.abs(sim.atom("omega")).max() == 0.0


# --- ranks, pieces ----------------------------------------------------------------------------------------------------

def crowd():
    """Some within the reach of films, above z = -60"""
    rng, x = np.random.default_rng(4), []
    while len(x) < 12:
        p = rng.uniform(0, 6.0, 3) * (1, 1, 0.6)
        if all(np.linalg.norm(p - q) > 2.02 * A for q in x):
            x.append(p)
    return Spheres(np.array(x) + (-2.0, -2.0, -60 + 1.05 * A), A)


SHARP = "cut_off_distance inf visc 1.1 relative_tolerance 1e-12 max_iter 400 rotation yes lubrication yes wall zlo EDGE"
WAYS = {"spun": ("f f f", crowd, SHARP, " spin all 0 3 0" + TIGHT),
        "cut": ("f f f", crowd, SHARP, " spin all 0 3 0 40" + TIGHT)}


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
def test_ranks_and_newton_do_not_matter(tmp_path, way):
    check_ranks(tmp_path, way, 1e-9, 1e-8)


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
def test_a_run_in_pieces_is_the_run_in_one(tmp_path, way):
    check_pieces(tmp_path, way, 1e-9, 1e-8)


def test_the_largest_torque_matters_there(tmp_path):
    ends = [end(tmp_path, script(tmp_path, way, END + ["run 20"])) for way in WAYS.values()]
    assert np.abs(ends[1] - ends[0])[:, :3].max() > 0.01


# --- what is refused --------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("style, words, message", [
    ("rotation yes", "spin some 0 1", "keyword spin"),
    ("rotation yes", "spin some 0 1 two", "keyword spin: 'two'"),
    ("rotation yes", "spin some 0 1 0 0", "keyword spin: '0' must be > 0"),
    ("rotation yes", "spin some 0 0 0 3", "keyword spin: a largest torque needs an axis"),
    ("rotation yes", "spin nobody 0 1 0", "keyword spin: group 'nobody' does not exist"),
    ("", "spin some 0 1 0", "keyword spin: keyword rotation of pair_style stokes_dynamics must be yes"),
    ("rotation yes rigid_clumps yes", "spin some 0 1 0", "keyword spin: atom 3 is part of a rigid clump"),
    ("rotation yes", "held some spin some 0 1 0",
     "keyword spin: atom 1 is in the group of keyword held or pin as well"),
    ("rotation yes", "spin some 0 1 0 temperature 1 5 scheme ab2", "keyword spin: the mobility has a drift")])
def test_what_cannot_spin_is_named(simulation, style, words, message):
    with pytest.raises(LammpsError, match=re.escape(message)):
        spinning(simulation, style, words, [0, 0, 7, 0, 7]).run(0)


def test_lone_clumps_do_not_spin(simulation):
    sim = simulation(Spheres(X), f"clumps_only yes rigid_clumps yes visc {ETA} rotation yes", fix=False, box=BOX,
                     dt=0.1)
    with pytest.raises(LammpsError, match="keyword spin: it is for spheres that feel each other: use clumps_only no"):
        sim.commands(f"{FIX} spin all 0 1 0").run(0)
