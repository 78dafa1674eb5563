"""What the scripts of the examples share: a python with numpy and matplotlib, MPI, programs that must be there, the verdict."""
import os
import pathlib
import shutil
import sys

TOP = pathlib.Path(__file__).resolve().parents[1]

# matplotlib keeps its font list here, since a bare environment has no home; once written it is used again.
os.environ.setdefault("MPLCONFIGDIR", str(TOP / "build" / "examples" / "matplotlib"))

DEBIAN = "/usr/bin/python3"
try:
    import matplotlib
    import numpy as np      # noqa: F401
except ImportError:         # Debian's python has them, another one on the PATH need not
    if sys.executable == DEBIAN or not os.path.exists(DEBIAN):
        raise
    os.execv(DEBIAN, [DEBIAN] + sys.argv)
matplotlib.use("Agg")
import matplotlib.pyplot as plt    # noqa: E402,F401

os.environ["OMPI_MCA_rmaps_base_oversubscribe"] = "1"         # two ranks on one core as well
if os.geteuid() == 0:
    os.environ["OMPI_ALLOW_RUN_AS_ROOT"] = os.environ["OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"] = "1"


def need(*programs):
    for program in programs:
        if shutil.which(program) is None:
            sys.exit(f"{program} is not on the PATH; run cmake/setup.sh and '. build/env.sh' first")


def verdict(facts):
    """Prints (text, does it hold?) line by line; how many do not."""
    for fact, holds in facts:
        print("  " + ("ok      " if holds else "MISSED  ") + fact)
    return sum(not holds for _, holds in facts)
