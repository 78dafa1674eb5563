"""The examples that take seconds: every figure of their READMEs holds, and a run leaves what is kept in the repository
alone. examples/run.sh all runs the rest of them too."""
import hashlib
import pathlib
import re
import subprocess
import sys

import pytest

from host import PATIENCE, environment

EXAMPLES = pathlib.Path(__file__).resolve().parents[3] / "examples"
QUICK = ["dense_settling", "first_look", "fixed_bed", "landing", "notebook", "python_clump",
         "rolling", "slit_bead", "squeeze", "vans_drag", "vans_fluid", "wall_shear"]
# by their option --quick
BRIEF = ["active", "cfd_coupling", "fibres", "hele_shaw", "magnetic", "rheology", "roller_layer", "settling_layer",
         "shapes", "ship", "swimmers", "tumbling", "vans_fluidised", "vans_sorting", "vans_waves"]


# how a warning about a command of LAMMPS beside ours begins (common/neighbours.h)
NEIGHBOUR = re.compile(r"WARNING: (?:Pair style|Fix) [\w/]+: (?:(?:fix|compute) \S+ of style|\w+_style \S+ \w).*")


def neighbours_warned_of(*logs):
    return [warning for log in logs for warning in NEIGHBOUR.findall(log.read_text(errors="replace"))]


def kept(folder):
    """Of every file below the folder its content, in short; but Python's of another test, which may come meanwhile."""
    return {path: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(folder.rglob("*"))
            if path.is_file() and path.suffix != ".pyc"}


@pytest.mark.parametrize("name", QUICK + BRIEF)
def test_every_figure_of_an_example_holds(name, tmp_path):
    before = kept(EXAMPLES / name)
    env = dict(environment(), PYTHONDONTWRITEBYTECODE="1")
    command = [sys.executable, str(EXAMPLES / name / "run.py"), "--out",
               str(tmp_path / "out")] + ["--quick"] * (name in BRIEF)
    run = subprocess.run(command, env=env, cwd=tmp_path, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                         stderr=subprocess.STDOUT, text=True, timeout=PATIENCE)
    assert run.returncode == 0, run.stdout[-3000:]
    assert not re.search("^MISSED", run.stdout, re.M), run.stdout[-3000:]
    assert len(re.findall("^ok  ", run.stdout, re.M)) >= 5, run.stdout[-3000:]
    assert kept(EXAMPLES / name) == before
    assert not neighbours_warned_of(*(path for path in (tmp_path / "out").rglob("*") if path.is_file() and
                                      "log" in path.name))


def test_settings_for_spheres_of_ones_own_do_not_depend_on_their_unit_of_length(tmp_path):
    """Cut-offs were 8 and more in the units of the file: with radii of half a millimetre they reached everybody."""
    errors = []
    for radius in 1.0, 5e-4:
        data = tmp_path / f"{radius}.data"
        rows = [f"{k + 1} 1 {3.9 * radius * k} 0 0 {2 * radius} 1.0 0" for k in range(7)]
        box = [f"{-40 * radius} {40 * radius} {axis}lo {axis}hi" for axis in "xyz"]
        data.write_text("\n".join(["spheres", "", "7 atoms", "1 atom types", *box, "", "Atoms", "", *rows, ""]))
        command = [sys.executable, str(EXAMPLES / "speed_error" / "run.py"), "--data", str(data), "--quick",
                   "--ranks", "1", "--out", str(tmp_path)]
        run = subprocess.run(command, env=dict(environment(), PYTHONDONTWRITEBYTECODE="1"), stdin=subprocess.DEVNULL,
                             capture_output=True, text=True, timeout=PATIENCE)
        assert run.returncode == 0, run.stdout[-3000:] + run.stderr[-3000:]
        with_cut_off = re.findall(r"^ +[\d.]+ +(\S+e\S+) .*cut_off_distance \d", run.stdout, re.M)
        errors.append([float(error) for error in with_cut_off])
    assert len(errors[0]) >= 5 and errors[1] == pytest.approx(errors[0], rel=0.1)


# --- the logs that are kept beside the examples -----------------------------------------------------------------------

def commands(script):
    """The lines of an input script that LAMMPS echoes, continued ones as one, blanks as one blank. None stands for a
    label: when a jump goes there, LAMMPS echoes neither the label nor what it skips."""
    text = re.sub(r"^(echo\s+none)$.*?^echo\s+log$", r"\1", re.sub(r"&[ \t]*\n", "", script), flags=re.S | re.M)
    lines = [" ".join(line.split()) for line in text.splitlines() if line.strip()]
    return [None if line.startswith("label ") else line for line in lines]


def not_echoed(script, log):
    """Commands of the script that the log lacks, but for those that a jump to a label has skipped."""
    echoed = {" ".join(line.split()) for line in log.splitlines()}
    missing, run = [], []
    for line in commands(script):
        if line is None:
            run = []
        elif line not in echoed:
            run.append(line)
        else:
            missing += run
            run = []
    return missing + run


LOGS = sorted(EXAMPLES.glob("*/log.*"))


@pytest.mark.parametrize("log", LOGS, ids=lambda path: path.name)
def test_logs_of_examples_are_of_this_version(log):
    package = EXAMPLES.parent / "PKG-STOKESDYN"
    between_releases = re.search("^## To come", (package / "CHANGELOG.md").read_text(), re.M)
    version = (package / "VERSION").read_text().strip() + ("+" if between_releases else "")
    text = log.read_text()
    assert re.findall("^PKG-STOKESDYN ([^,]+), built for LAMMPS", text,
                      re.M) == [version], "run the example's run.py --update"
    assert not not_echoed((log.parent / f"in.{log.parent.name}").read_text(), text), "the input has changed since"


def test_there_are_logs():
    assert len(LOGS) >= 30


def test_no_log_has_a_warning_of_a_command_beside_ours(tmp_path):
    assert not neighbours_warned_of(*LOGS)
    (tmp_path / "log").write_text("WARNING: Pair style stokes_dynamics: compute P of style pressure knows "
                                  "nothing (x.cpp:9)\n"
                                  "WARNING: Fix stokes_dynamics/overdamped: pair_style granular must have no damping\n")
    assert len(neighbours_warned_of(tmp_path / "log")) == 2


def test_a_changed_input_is_seen():
    log = "units lj\nfix 1 all nve   x y\njump SELF there\nrun 5\n"
    assert not not_echoed("units lj\nfix 1 all nve &\n  x y\njump SELF there\nthermo 7\nlabel there\nrun 5\n", log)
    assert not_echoed("units lj\nthermo 7\nrun 5\n", log) == ["thermo 7"]


# --- checks.py --------------------------------------------------------------------------------------------------------

@pytest.fixture
def checks(monkeypatch):
    monkeypatch.syspath_prepend(str(EXAMPLES))
    import checks
    return checks.Checks()


@pytest.mark.parametrize("value", [2.0, 1.0 + 1e-3, float("nan"), float("inf")])
def test_a_figure_that_is_off_is_missed(checks, capsys, value):
    assert not checks.near("period", value, 1.0, 1e-4)
    assert checks.near("frequency", 1.00001, 1.0, 1e-4)
    assert checks.finish() == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("MISSED  period: ") and lines[1].startswith("ok      frequency: ")


def test_limits_belong_to_what_is_allowed(checks):
    assert checks.below("overlap", 0.02, 0.02) and checks.within("speed", 0.93, 0.93,
                                                                 1.02) and checks.holds("it stands", True)
    assert checks.finish() == 0
    assert not checks.below("overlap", 0.0201, 0.02) and not checks.within("speed", 1.03, 0.93, 1.02)
    assert not checks.holds("it stands", False)
    assert checks.finish() == 1


def test_a_script_that_looks_at_nothing_fails(checks):
    assert checks.finish() == 1
