#!/usr/bin/env python3
"""Cost of rigid_clumps: processor time of pair style and drag fix a sphere and step, against the same run with Stokes
drag alone.

    rigid_clumps.py [--clumps N] [--steps N] [--repeat N] [--memory]

N clumps of ten spheres (10 000) fall at their settling velocity, each turned in its own way, as rigid bodies on one
core (in.rigid_clumps). For each model the median of `repeat` runs (5), the models in turn, so that a disturbance of the
machine meets all of them. Times are LAMMPS's own (timer full: wall time times share of the processor): Pair, the
section of the pair style, and Modify, which is mostly fix rigid/small. The rivals are
  Stokes drag, this style   cut_off_distance below the distance of neighbours: no interactions; with and without torques
  Stokes drag, fix viscous  the cheapest drag there is: f = -k v, equal spheres
--memory: largest memory of a run of 100 000 clumps with shell 162 instead, one step.
"""
import argparse
import os
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
RIGID = "clumps_only yes rigid_clumps yes"
MODELS = {
    "Stokes drag, fix viscous": "none",
    "Stokes drag, this style": "cut_off_distance 1e-6 algorithm 1",
    "Stokes drag and torque, this style": "cut_off_distance 1e-6 algorithm 1 rotation yes",
    "shell 1": RIGID,
    "shell 1, rotation yes": f"{RIGID} rotation yes",
    "shell 12": f"{RIGID} shell 12",
    "shell 42": f"{RIGID} shell 42",
    "shell 162": f"{RIGID} shell 162",
    "solved every step, to 1e-3": "clumps_only yes algorithm 2",
}
REFERENCE = "Stokes drag, this style"
# Error of the drag of the twelve clumps of examples/sedimentation against exact, worst, per cent
ERROR = {"shell 1": 9.26, "shell 1, rotation yes": 3.05, "shell 12": 0.10, "shell 42": 0.17, "shell 162": 0.06,
         "solved every step, to 1e-3": 9.3}


def run(words, n, steps, folder):
    """Log of a run of 10 n^3 clumps."""
    log = pathlib.Path(folder) / "log"
    command = ["stdbuf", "-oL", "lmp", "-in", "in.rigid_clumps", "-log", str(log), "-var", "n", str(n),
               "-var", "steps", str(steps)]
    command += ["-var", "viscous", "yes"] if words == "none" else ["-var", "model", words]
    done = subprocess.run(command, cwd=HERE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit("\n".join(done.stdout.splitlines()[-20:]) + f"\n{' '.join(command)} failed")
    return log.read_text()


def section(log, name):
    """Processor seconds of a section in the last run of a log."""
    line = [line for line in log.splitlines() if line.startswith(name + " ")][-1].split("|")
    return float(line[2]) * float(line[5]) / 100


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--clumps", type=int, default=10000)
    arguments.add_argument("--steps", type=int, default=100)
    arguments.add_argument("--repeat", type=int, default=5)
    arguments.add_argument("--memory", action="store_true")
    options = arguments.parse_args()
    os.environ["OMP_NUM_THREADS"] = "1"
    with tempfile.TemporaryDirectory() as folder:
        if options.memory:
            n = round((100000 / 10)**(1 / 3))
            log = run(MODELS["shell 162"], n, 1, folder)
            peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024**2
            print(f"{10 * n**3} clumps of 10 spheres, shell 162: {peak:.2f} GB at most; the shape was "
                  + next(line for line in log.splitlines() if "solved in" in line).split(", ")[-1])
            return 0 if peak < 2.0 else 1
        n = round((options.clumps / 10)**(1 / 3))
        spheres = 100 * n**3
        times = {name: [] for name in MODELS}
        for _ in range(options.repeat):
            for name, words in MODELS.items():
                log = run(words, n, options.steps, folder)
                times[name].append([section(log, part) / (options.steps * spheres) * 1e9
                                    for part in ("Pair", "Modify")])
    # fix viscous is part of Modify; the rest of that section is the same in all runs
    medians = {name: [statistics.median(t[k] for t in all_) for k in (0, 1)] for name, all_ in times.items()}
    pair, both = medians[REFERENCE][0], sum(medians[REFERENCE])
    print(f"{spheres // 10} clumps of 10 spheres, ns a sphere and step, median of {options.repeat}:\n")
    print("| | Pair | Modify | both | Pair, times Stokes drag | both, times Stokes drag | both, times fix viscous |"
          " error of the drag, % |")
    print("|---|---:|---:|---:|---:|---:|---:|---:|")
    bare = sum(medians["Stokes drag, fix viscous"])
    for name, (p, m) in medians.items():
        print(f"| {name} | {p:.0f} | {m:.0f} | {p + m:.0f} | {p / pair:.2f} | {(p + m) / both:.2f} |"
              f" {(p + m) / bare:.2f} | {ERROR.get(name, '')} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
