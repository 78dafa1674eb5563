"""Fixtures of the LAMMPS tests. They need the environment of build/env.sh: unittest/run.sh sets it."""
import os
import sys

import pytest

sys.path.insert(0, os.path.dirname(__file__))

try:
    import lammps  # noqa: F401
except ImportError:
    raise pytest.UsageError("the python module of LAMMPS is not there: source build/env.sh first, or run unittest/run.sh")

from system import Simulation  # noqa: E402


@pytest.fixture
def simulation(tmp_path):
    """Makes LAMMPS instances: simulation(spheres, "visc 1 ...", boundary=...). A new one ends the one before, since LAMMPS of
    2021 keeps one list of plugins for all instances of a process: while one lives, a second cannot load the plugin."""
    made = []

    def make(spheres=None, style=None, **options):
        while made:
            made.pop().close()
        made.append(Simulation(tmp_path, spheres, style, **options))
        return made[-1]

    yield make
    while made:
        made.pop().close()
