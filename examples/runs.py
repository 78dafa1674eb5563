"""What the scripts of the examples share: a python with numpy and matplotlib, MPI, programs that must be there, where
results go."""
import argparse
import contextlib
import csv
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time

import other_python

TOP = pathlib.Path(__file__).resolve().parents[1]
# in the folder of the build, whose name is that of cmake/setup.sh
RESULTS = pathlib.Path(os.environ.get("STOKESDYN_BUILD", TOP / "build")).resolve() / "examples"

# matplotlib keeps its font list here, since a bare environment has no home; once written it is used again.
os.environ.setdefault("MPLCONFIGDIR", str(RESULTS / "matplotlib"))

other_python.unless("numpy", "matplotlib")
import matplotlib        # noqa: E402
import numpy as np       # noqa: E402,F401
matplotlib.use("Agg")
import matplotlib.pyplot as plt    # noqa: E402,F401

os.environ["OMPI_MCA_rmaps_base_oversubscribe"] = "1"         # two ranks on one core as well
if os.geteuid() == 0:
    os.environ["OMPI_ALLOW_RUN_AS_ROOT"] = os.environ["OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"] = "1"


def need(*programs):
    for program in programs:
        if shutil.which(program) is None:
            sys.exit(f"{program} is not on the PATH; run cmake/setup.sh and '. build/env.sh' first")


def options(script, text, **more):
    """What every run.py takes: --out DIR, where all that it makes goes (a folder of build/examples unless told), made
    if need be; --update, which also refreshes what is kept beside run.py. more: names of further options, with their
    defaults."""
    name = pathlib.Path(script).resolve().parent.name
    parser = argparse.ArgumentParser(description=text, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=pathlib.Path, default=RESULTS / name)
    parser.add_argument("--update", action="store_true")
    for key, default in more.items():
        how = dict(action="store_true") if default is False else dict(type=type(default), default=default)
        parser.add_argument("--" + key, **how)
    given = parser.parse_args()
    given.out = given.out.resolve()
    given.out.mkdir(parents=True, exist_ok=True)
    return given


SILENCE = 6          # seconds; on a busy machine a line may come three times as late
LISTENED_TO = []      # files to which runs of LAMMPS print, the latest one last


def last_row(path):
    """Of thermo output, as far as LAMMPS has written it: the latest line that begins with a step and has one more
    number"""
    with open(path, "rb") as file:
        file.seek(max(0, os.path.getsize(path) - 4000))
        lines = file.read().decode(errors="replace").splitlines()
    rows = [" ".join(line.split()) for line in lines if re.match(r" *\d+ +[-\d]\S*( |$)", line)]
    return rows[-1][:100] if rows else ""


def say_how_long(name):
    """A line every SILENCE seconds, so that whoever waits sees that the example goes on."""
    began = time.time()
    while True:
        time.sleep(SILENCE)
        try:
            row = last_row(LISTENED_TO[-1])
        except (IndexError, OSError):      # nothing runs, or it has just ended
            row = ""
        print(f"[{name}] {time.time() - began:.0f} s so far" + (f"; LAMMPS: {row}" if row else ""), flush=True)


if pathlib.Path(sys.argv[0]).name == "run.py":
    threading.Thread(target=say_how_long, args=[pathlib.Path(sys.argv[0]).resolve().parent.name], daemon=True).start()


@contextlib.contextmanager
def listening(path):
    LISTENED_TO.append(path)
    try:
        yield
    finally:
        LISTENED_TO.remove(path)


def finished(name, command, cwd):
    """What the command printed in cwd, or the end with the last lines of that. name: of the example. Several at once
    would trip over each other in Open MPI's folder of temporary files."""
    with tempfile.TemporaryDirectory(prefix="sd") as scratch:
        path = pathlib.Path(scratch) / "printed"
        with path.open("w") as printed, listening(path):
            done = subprocess.run(command, cwd=cwd, env=dict(os.environ, TMPDIR=scratch), stdin=subprocess.DEVNULL,
                                  stdout=printed, stderr=subprocess.STDOUT)
        said = path.read_text(errors="replace")
    # at the beginning of a line: so LAMMPS speaks, MPI does otherwise
    if done.returncode != 0 or re.search("^ERROR", said, re.M):
        sys.exit("\n".join(said.splitlines()[-20:]) + f"\n{name}: {' '.join(command)} failed in {cwd}")
    return said


def thermo(said, first):
    """Rows [samples, columns] of the table of thermo output whose header begins with the words `first`, in what a
    LAMMPS printed. Older LAMMPS put one space between the words, newer ones pad them to columns."""
    header = re.search(r"^ *" + r" +".join(first.split()) + r"\b.*\n", said, re.M)
    rows = said[header.end():said.index("\nLoop time", header.end())].splitlines()
    return np.array([row.split() for row in rows if re.match(r" *\d", row)], float)


def read_table(path):
    """Rows of a table with comments and one line of names, as dictionaries"""
    return list(csv.DictReader(line for line in path.read_text().splitlines() if not line.startswith("#")))


def values(variables):
    """-var name value ... of a command line of LAMMPS"""
    return [word for name, value in variables.items() for word in ("-var", name, str(value))]


def dumped(path):
    """Of a dump custom file: step and rows [atoms, columns] of each frame."""
    for block in path.read_text().split("ITEM: TIMESTEP\n")[1:]:
        lines = block.split("\n")
        yield int(lines[0]), np.array([[float(w) for w in line.split()] for line in lines[8:8 + int(lines[2])]])


def open_axes():
    """Of pictures from here on: no frame above and on the right"""
    plt.rcParams.update({"font.size": 10, "axes.spines.top": False, "axes.spines.right": False})


def save(figure, path, dpi=80):
    figure.savefig(path, dpi=dpi, pil_kwargs={"optimize": True})
    plt.close(figure)
