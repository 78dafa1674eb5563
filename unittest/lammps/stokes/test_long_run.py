"""unittest/bench/long_run.py, 20 000 of its million steps."""
import os
import sys

import pytest

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "bench"))

import long_run  # noqa: E402
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
