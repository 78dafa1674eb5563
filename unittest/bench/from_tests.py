"""numpy, and the way to the helpers of unittest/lammps. Debian's python has numpy and pytest, another one on the PATH
need not."""
import os
import sys

DEBIAN = "/usr/bin/python3"
try:
    import numpy as np      # noqa: F401
    import pytest           # noqa: F401
except ImportError:
    if sys.executable == DEBIAN or not os.path.exists(DEBIAN):
        raise
    os.execv(DEBIAN, [DEBIAN] + sys.argv)
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "lammps"))
