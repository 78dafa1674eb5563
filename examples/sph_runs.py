"""What the scripts of the SPH examples share: running an input, reading its thermo output, profiles and dumps.

Each ends with a line "ok" or "MISSED" for every figure of its README, and the exit status. With --quick only those of
the shortest runs."""
import os
import subprocess
import sys

from checks import Checks  # noqa: F401
from runs import listening, np, plt, RESULTS, TOP

QUICK = "--quick" in sys.argv


def lmp(folder, name, tag, **variables):
    """Runs folder/in.name with lmp from the PATH (. build/env.sh) in build/examples/<name>; returns the thermo table:
    columns by name."""
    out = os.path.join(RESULTS, name)
    os.makedirs(out, exist_ok=True)
    log = "log.%s.%s" % (name, tag)
    command = ["lmp", "-in", os.path.join(folder, "in." + name), "-log", log, "-screen", "none", "-nocite"]
    for key, value in variables.items():
        command += ["-var", key, str(value)]
    print("[%s] %s" % (name, " ".join("%s=%s" % item for item in variables.items())), flush=True)
    with listening(os.path.join(out, log)):
        failed = subprocess.run(command, cwd=out).returncode
    if failed:
        sys.exit("the run failed; see %s" % os.path.join(out, log))
    return out, thermo(os.path.join(out, log))


def thermo(path):
    names, rows = [], []
    with open(path) as f:
        for line in f:
            words = line.split()
            if words[:1] == ["Step"]:
                names, rows = words, []
            elif names and len(words) == len(names):
                try:
                    rows.append([float(w) for w in words])
                except ValueError:
                    pass
    table = np.array(rows)
    return {name: table[:, k] for k, name in enumerate(names)}


def profiles(path):
    """Blocks of a fix ave/chunk file: list of (step, rows) without empty layers. Columns: layer, coordinate, count,
    values."""
    blocks = []
    with open(path) as f:
        for line in f:
            words = line.split()
            if line.startswith("#"):
                continue
            if len(words) == 3:
                blocks.append((int(words[0]), []))
            else:
                blocks[-1][1].append([float(w) for w in words])
    return [(step, np.array([r for r in rows if r[2] > 0])) for step, rows in blocks]


def dump(path):
    """Snapshots of a dump custom file: list of dictionaries of columns."""
    shots = []
    with open(path) as f:
        for block in f.read().split("ITEM: ATOMS")[1:]:
            names, *lines = block.split("ITEM:")[0].splitlines()
            names = names.split()
            rows = np.array([line.split() for line in lines], float).reshape(-1, len(names))
            shots.append(dict(zip(names, rows.T)))
    return shots


def pyplot():
    plt.rcParams.update({"figure.dpi": 110, "font.size": 10, "axes.grid": True, "grid.alpha": 0.3})
    return plt


def keep(folder, out, picture, table, name="table.md"):
    """Writes the table beside the picture (None: there is none); with --update both go to the example's own folder
    too."""
    with open(os.path.join(out, name), "w") as f:
        f.write(table)
    print(table)
    if "--update" in sys.argv:
        import shutil

        for file in filter(None, (picture, name)):
            shutil.copy(os.path.join(out, file), folder)
