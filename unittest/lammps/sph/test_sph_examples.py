"""The SPH examples keep the figures of their READMEs: the quick ones here, all of them with examples/run.sh all. And
what ends a run is seen."""
import os
import subprocess
import sys

import pytest

from host import PATIENCE, environment

EXAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "examples")


@pytest.mark.parametrize("name", ["channel_flow", "dam_break_bed", "drops", "grain_cloud", "grains_in_water",
                                  "liggghts", "river_bump", "sph_order", "still_water", "taylor_green"])
def test_figures_hold(name):
    done = subprocess.run([sys.executable, os.path.join(EXAMPLES, name, "run.py"), "--quick"], env=environment(),
                          capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode == 0 and "\nok " in done.stdout and "MISSED" not in done.stdout, done.stdout + done.stderr


# --- sph_order/flows.py -----------------------------------------------------------------------------------------------

@pytest.fixture
def flows(monkeypatch):
    monkeypatch.syspath_prepend(os.path.join(EXAMPLES, "sph_order"))
    import flows
    return flows


def test_what_lammps_says_of_a_mistake_is_seen(flows):
    with pytest.raises(RuntimeError, match="gauss") as why:
        flows.gresho(8, kernel="gauss")
    assert not isinstance(why.value, flows.BlownUp)


def test_water_that_flies_apart_is_told_from_a_mistake(flows, monkeypatch):
    run = flows.run
    monkeypatch.setattr(flows, "run", lambda scene, T, dt, shots: run(scene, 40 * T, 40 * dt, shots))
    with pytest.raises(flows.BlownUp, match="atom"):
        flows.gresho(8)
