"""The SPH examples keep the figures of their READMEs: the quick ones here, all of them with examples/run.sh all."""
import os
import subprocess
import sys

import pytest

from system import environment

EXAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "examples")


@pytest.mark.parametrize("name", ["channel_flow", "liggghts", "sph_order", "still_water", "taylor_green"])
def test_figures_hold(name):
    done = subprocess.run([sys.executable, os.path.join(EXAMPLES, name, "run.py"), "--quick"], env=environment(), capture_output=True,
                          text=True, timeout=300)
    assert done.returncode == 0 and "\nok " in done.stdout and "MISSED" not in done.stdout, done.stdout + done.stderr
