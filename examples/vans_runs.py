"""What the scripts of the vans examples share: running an input, its profiles, means with their errors, what is kept
beside run.py."""
import os
import shutil
import subprocess

from runs import listening, np

D = 0.006                                       # of the beads, m
SCALE = np.sqrt(1.5 * 9.81 * D ** 3)            # q* = q/SCALE


def lmp(folder, given, directory, log="none", **variables):
    """Runs the input of the example in folder, in directory."""
    source = os.path.join(folder, "in." + os.path.basename(folder))
    with listening(os.path.join(directory, log)):
        subprocess.run(["mpirun", "-np", str(given.ranks), "lmp", "-in", source, "-screen", "none", "-log", log]
                       + [word for key, value in variables.items() for word in ("-var", key, str(value))],
                       cwd=directory, check=True)


def keep(folder, given, *names):
    """--update: what belongs into the folder of the example."""
    for name in names if given.update else ():
        shutil.copy(given.out / name, folder)


def profiles(path, begin=0.0):
    """Of a file of fix ave/time mode vector: mean over its blocks whose steps end after the share `begin` of the run; a
    row a slice, columns as those of fix hydro/vans from the second."""
    blocks, steps = [], []
    for line in open(path):
        words = line.split()
        if words[0] == "#":
            continue
        if len(words) == 2:
            blocks.append([])
            steps.append(float(words[0]))
        else:
            blocks[-1].append([float(word) for word in words])
    whole = [(step, block) for step, block in zip(steps, blocks) if len(block) == len(blocks[0])]
    return np.mean([block for step, block in whole if step > begin * whole[-1][0]], axis=0)


def error(values):
    """Standard error of the mean of independent values; not a number for one."""
    return np.std(values, ddof=1) / np.sqrt(len(values)) if len(values) > 1 else np.nan


def by_second(t, values, begin=0.0):
    """Means over each whole second from begin."""
    return np.array([values[(t >= s) & (t < s + 1)].mean() for s in np.arange(begin, t[-1] - 0.9)])
