"""unittest/bench/long_run.py, 20 000 of its million steps, and a little of long_suspension.py."""
import os
import sys

import pytest

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "bench"))

import long_run  # noqa: E402
import long_suspension  # noqa: E402
from system import note  # noqa: E402


@pytest.mark.hard_case("long run: no drift of memory, residual, momentum, forces (a million steps: "
                       "unittest/bench/long_run.py)")
def test_nothing_creeps_in(tmp_path):
    sim = long_run.start(tmp_path)
    try:
        windows = list(long_run.windows(sim, 20000, 5))
        assert sim.solves >= 20000 and sim.fix_vector()[6] == 0
    finally:
        sim.close()
    note("residual", max(w["residual"] for w in windows))
    note("error", max(w["drift"] for w in windows))
    assert windows[-1]["step"] == 20000
    for w in windows:
        assert 0.1 * long_run.TOLERANCE < w["residual"] <= long_run.TOLERANCE
        assert w["momentum"] < 1e-13
        assert w["drift"] < 1e-4                    # the tolerance times the condition of the matrix, some hundred
    assert windows[-1]["memory"] - windows[0]["memory"] < 0.1       # a leak of 6 bytes a step


def test_in_single_precision_nothing_moves_all_aside(tmp_path, monkeypatch):
    """Films in shear, 200 of the ten thousand steps of unittest/bench/long_suspension.py, with fewer spheres."""
    monkeypatch.setitem(long_suspension.SCENES, "films", (2, *long_suspension.SCENES["films"][1:]))
    sim = long_suspension.begin(long_suspension.melted("films", tmp_path), "films", "relative_tolerance 1e-3")
    windows = list(long_suspension.windows(sim, "films", 200, 2, tmp_path))
    sim.close()
    note("error", max(w["velocity"] for w in windows))
    for w in windows:
        assert 1e-7 < w["velocity"] < 2e-3 and w["spin"] < 4e-3
        assert max(w["drift"], w["turning"]) < 1e-3 and abs(w["dissipation"]) < 1e-4      # means: the tolerance
        assert w["balance"] < 1e-13 and w["products"] < 8


def test_a_square_falls_straight_in_single_precision(tmp_path):
    found = long_suspension.square(tmp_path, "relative_tolerance 1e-3", 200)
    assert found["fallen"] > 1 and found["products"] == 1
    assert max(found[what] for what in ("aside", "turned", "sides", "tilt")) < 1e-7
