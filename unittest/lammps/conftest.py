"""Fixtures of the LAMMPS tests. They need the environment of build/env.sh: unittest/run.sh sets it.

With --table only the hard cases are run (tests with the mark hard_case), and a table of them is printed: what the runs
themselves reported, nothing else."""
import os
import re
import sys

import pytest

HERE = os.path.dirname(os.path.abspath(__file__))
# what tests share stands beside this file; some take a scene from a test of another folder
sys.path[:0] = [HERE] + [os.path.join(HERE, room) for room in ("common", "stokes", "sph", "vans")]

try:
    import lammps  # noqa: F401
except ImportError:
    raise pytest.UsageError("the python module of LAMMPS is not there: source build/env.sh first, "
                            "or run unittest/run.sh")

import host  # noqa: E402
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


# --- several ranks, and what some LAMMPS has nothing of ---------------------------------------------------------------

def names(code):
    """All names that a function and the functions within it use, those of arguments that it gives included"""
    found = {*code.co_names, *code.co_varnames, *code.co_freevars, *code.co_cellvars}
    for value in code.co_consts:
        if hasattr(value, "co_code"):
            found |= names(value)
        elif isinstance(value, tuple):
            found |= {word for word in value if isinstance(word, str)}
    return found


def ranks_of(item):
    """How many ranks a test needs: what its mark or its parameter `ranks` says, 2 where its code has any name with
    "ranks" in it. A test that uses several and says so nowhere fails (host.mpirun)."""
    mark, parameters = item.get_closest_marker("ranks"), item.callspec.params if hasattr(item, "callspec") else {}
    if mark:
        return mark.args[0]
    return (parameters["ranks"] if "ranks" in parameters else 2
            if any("ranks" in name for name in names(item.function.__code__)) else 1)


def left_out(item):
    """Why there is nothing to test here, or None"""
    for mark in item.iter_markers("nothing_to_test_if"):
        condition, reason = mark.args
        if condition:
            return reason
    most = host.most()
    return (None if ranks_of(item) <= most
            else f"more ranks than this LAMMPS may have here ({host.family() or 'no MPI'}: {most})")


LEFT_OUT = {}      # reason: tests


def leave_out(config, items):
    kept, out = [], []
    for item in items:
        if ranks_of(item) > 1 and not item.get_closest_marker("ranks"):
            item.add_marker(pytest.mark.ranks(ranks_of(item)))
        reason = left_out(item)
        (out if reason else kept).append(item)
        if reason:
            LEFT_OUT[reason] = LEFT_OUT.get(reason, 0) + 1
    items[:] = kept
    config.hook.pytest_deselected(items=out)
    if hasattr(config, "workeroutput"):
        config.workeroutput["left_out"] = LEFT_OUT


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node):
    """Of pytest-xdist: every worker has collected the same"""
    LEFT_OUT.update(getattr(node, "workeroutput", {}).get("left_out", {}))


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item):
    host.undeclared = not item.get_closest_marker("ranks")


# --- the table of hard cases ------------------------------------------------------------------------------------------

def pytest_addoption(parser):
    parser.addoption("--table", action="store_true", help="run the hard cases only and print a table of them")


def pytest_configure(config):
    for line in ("hard_case(name): a case of the table that --table prints; several tests may share one",
                 "ranks(n): needs n ranks; set for all whose code names them (ranks_of)",
                 "loader: of stokesdynplugin.so itself",
                 "nothing_to_test_if(condition, reason): is left out, and the reason told, where the condition holds"):
        config.addinivalue_line("markers", line)
    # newer pytest-xdist would begin with the files of most tests, which are not those of LONG
    config.option.loadscopereorder = False


# Files that take long and come late in the alphabet: they begin first, so that no core waits for them in the end.
LONG = ["test_relations", "test_wall", "test_vans_coupling"]


@pytest.hookimpl(tryfirst=True)      # before -m looks at the marks
def pytest_collection_modifyitems(config, items):
    leave_out(config, items)
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
    return re.sub(r"^(ERROR|WARNING)( on proc [0-9]+)?: (Pair style stokes_dynamics: )?(step [0-9]+(, |: ))?", "",
                  message)


def pytest_terminal_summary(terminalreporter, config):
    for reason, tests in LEFT_OUT.items():
        terminalreporter.write_line(f"{tests} left out: {reason}")
    if config.getoption("--table"):
        table_of_hard_cases(terminalreporter)


def table_of_hard_cases(terminalreporter):
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
