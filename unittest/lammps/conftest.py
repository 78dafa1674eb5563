"""Fixtures of the LAMMPS tests. They need the environment of build/env.sh: unittest/run.sh sets it.

With --table only the hard cases are run (tests with the mark hard_case), and a table of them is printed: what the runs themselves
reported, nothing else."""
import os
import re
import subprocess
import sys

import pytest

sys.path.insert(0, os.path.dirname(__file__))

try:
    import lammps
except ImportError:
    raise pytest.UsageError("the python module of LAMMPS is not there: source build/env.sh first, or run unittest/run.sh")

import system  # noqa: E402
from system import Simulation  # noqa: E402


@pytest.fixture
def simulation(tmp_path):
    """Makes LAMMPS instances: simulation(spheres, "visc 1 ...", boundary=...). A new one ends the one before;
    test_instances.py has several at a time."""
    made = []

    def make(spheres=None, style=None, **options):
        while made:
            made.pop().close()
        made.append(Simulation(tmp_path, spheres, style, **options))
        return made[-1]

    yield make
    while made:
        made.pop().close()


# --- a LAMMPS without MPI --------------------------------------------------------------------------------------------------

def without_mpi():
    """A test of several ranks has nothing to test: it is skipped."""
    start = subprocess.Popen.__init__

    def on_one_rank(self, words, *args, **options):
        if words[0] == "mpirun":
            pytest.skip("this LAMMPS has no MPI")
        start(self, words, *args, **options)

    subprocess.Popen.__init__ = on_one_rank


# --- the table of hard cases ---------------------------------------------------------------------------------------------

def pytest_addoption(parser):
    parser.addoption("--table", action="store_true", help="run the hard cases only and print a table of them")


def pytest_configure(config):
    config.addinivalue_line("markers", "hard_case(name): a case of the table that --table prints; several tests may share one")
    if config.getoption("numprocesses", default=None):
        return    # this process hands the tests out (pytest-xdist): its workers must not inherit the traces of its MPI
    probe = lammps.lammps(cmdargs=system.quiet_arguments())
    if not probe.has_mpi_support:
        without_mpi()
    probe.close()


# Files that take long and come late in the alphabet: they begin first, so that no core waits for them in the end.
LONG = ["test_wall", "test_vans_coupling"]


def pytest_collection_modifyitems(config, items):
    items.sort(key=lambda item: item.path.stem not in LONG)      # a stable sort
    if config.getoption("--table"):
        others = [item for item in items if not item.get_closest_marker("hard_case")]
        items[:] = [item for item in items if item.get_closest_marker("hard_case")]
        config.hook.pytest_deselected(items=others)


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item, call):
    """Each report of a hard case carries its name and what its runs have said so far."""
    report = (yield).get_result()
    mark = item.get_closest_marker("hard_case")
    report.hard_case = mark.args[0] if mark else None
    if call.when == "setup":
        system.notes = []
    report.notes = system.notes


def in_short(message):
    """A message of the pair style without what is the same in all of them."""
    message = re.sub(r" \([^()]*\.cpp:[0-9]+\)", "", message).split(" Last command:")[0]
    return re.sub(r"^(ERROR|WARNING)( on proc [0-9]+)?: (Pair style stokes_dynamics: )?(step [0-9]+(, |: ))?", "", message)


def pytest_terminal_summary(terminalreporter, config):
    if not config.getoption("--table"):
        return
    cases = {}
    for outcome in ("passed", "failed", "error"):
        for report in terminalreporter.stats.get(outcome, []):
            if getattr(report, "hard_case", None):
                case = cases.setdefault(report.hard_case, {"passed": 0, "failed": 0, "seconds": 0.0, "notes": []})
                case["passed" if outcome == "passed" else "failed"] += 1
                case["seconds"] += report.duration
                case["notes"] += report.notes
    write = terminalreporter.write_line
    write("")
    write("| case | tests passed | failed | iterations | largest residual | largest error of a force | says | s |")
    write("|---|---|---|---|---|---|---|---|")
    for name, case in cases.items():
        def of(kind):
            return [value for which, value in case["notes"] if which == kind]

        def largest(kind, form):
            return format(max(of(kind)), form) if of(kind) else ""

        iterations = f"{min(of('iterations'))} to {max(of('iterations'))}" if of("iterations") else ""
        says = list(dict.fromkeys(in_short(message) for message in of("says")))
        what = (says[0] + (f" (and {len(says) - 1} more)" if len(says) > 1 else "")) if says else ""
        write(f"| {name} | {case['passed']} | {case['failed']} | {iterations} | {largest('residual', '.1e')} |"
              f" {largest('error', '.1e')} | {what} | {case['seconds']:.2f} |")
