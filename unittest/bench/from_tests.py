"""numpy, and the way to the helpers of unittest/lammps. Debian's python has numpy and pytest, another one on the PATH
need not.

APART: words of LAMMPS, with which two ranks are two runs of one rank that know nothing of each other. Where each has
half of the spheres, they share what two ranks share, cores, memory and caches, and neither say nor wait nor do anything
twice: no two ranks of this machine are faster than that."""
import os
import sys

DEBIAN = "/usr/bin/python3"
APART = ["-partition", "2x1"]
try:
    import numpy as np      # noqa: F401
    import pytest           # noqa: F401
except ImportError:
    if sys.executable == DEBIAN or not os.path.exists(DEBIAN):
        raise
    os.execv(DEBIAN, [DEBIAN] + sys.argv)
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "lammps"))
