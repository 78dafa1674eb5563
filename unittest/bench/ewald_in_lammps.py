#!/usr/bin/env python3
"""Ewald sums inside a LAMMPS run in units of T4, the time of an all-pairs product of 10^4 spheres in the same run.

    . build/env.sh; OPENBLAS_NUM_THREADS=1 unittest/bench/ewald_in_lammps.py [quick | ranks]

A product is the difference of steps with 1 and with 1 + MORE iterations over MORE, vectors of the solver included.
Set-up is a step in which all spheres move with the fluid: lists, windows and images are made, nothing is left to solve,
and no product is taken; what LAMMPS does in a step is in it. Least of REPEATS; T4 is measured anew before each row.
Processor time. ranks: one and two ranks in turn, and two runs of half as many spheres side by side, which is the most
that two ranks could be; time of the clock, medians of ROUNDS. Memory: of the process, with all that LAMMPS keeps.
Errors: unittest/bench/bench_ewald.c has those of the same sums, test_ewald.py those of the forces."""
import os
import subprocess
import sys
import tempfile

from from_tests import APART, np
from host import environment, mpirun

REPEATS, MORE, ROUNDS = 3, 4, 5
SCENES = [  # name, N, boundary, tolerance, radii 1 : ratio, rotation
    ("periodic", 100000, "p p p", "1e-3", 1, "no"),
    ("periodic", 100000, "p p p", "1e-6", 1, "no"),
    ("periodic, radii 1 : 3", 100000, "p p p", "1e-3", 3, "no"),
    ("periodic, torques", 100000, "p p p", "1e-3", 1, "yes"),
    ("open", 100000, "f f f", "3e-7", 1, "no"),
    ("periodic", 1000000, "p p p", "1e-3", 1, "no")]

PROGRAM = """
import sys, time, resource
from lammps import lammps
lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite", "-in", "none"] + sys.argv[6:])
for line in open(sys.argv[1]):
    lmp.command(line)
style, iterations, repeats = sys.argv[2], [int(k) for k in sys.argv[3].split(",")], int(sys.argv[5])
clock = getattr(time, sys.argv[4])
best = []
for k in iterations + [0]:
    lmp.command(f"pair_style stokes_dynamics {style} max_iter {max(k, 1)}")
    lmp.command("pair_coeff * *")
    if k == 0:
        lmp.command("velocity all set 0 0 0")
    lmp.command("run 0 post no")
    times = []
    for r in range(repeats):
        begin = clock()
        lmp.command("run 1 pre no post no")
        times.append(clock() - begin)
    best.append(min(times))
if lmp.extract_setting("world_rank") == 0:
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    print("\\n" + " ".join(map(str, best + [memory])), flush=True)    # in one piece: halves write to one pipe
lmp.close()
lmp.finalize()
"""


def write(folder, n, boundary, ratio):
    """Spheres at random, of volume fraction 0.2; they overlap."""
    rng = np.random.default_rng(1)
    a = rng.uniform(1.0, ratio, n)
    side = (4 / 3 * np.pi * (a**3).sum() / 0.2)**(1 / 3)
    x, v = rng.uniform(0, side, (n, 3)), rng.normal(size=(n, 3))
    with open(os.path.join(folder, "data"), "w") as out:
        out.write(f"spheres\n\n{n} atoms\n1 atom types\n\n" + "".join(f"0 {side:.17g} {c}lo {c}hi\n" for c in "xyz"))
        out.write("\nAtoms\n\n" + "".join(f"{i + 1} 1 {2 * a[i]} 1.0 {x[i][0]} {x[i][1]} {x[i][2]}\n"
                                          for i in range(n)))
        out.write("\nVelocities\n\n" + "".join(f"{i + 1} {v[i][0]} {v[i][1]} {v[i][2]} 0 0 0\n" for i in range(n)))
    with open(os.path.join(folder, "in"), "w") as out:
        out.write(f"units lj\natom_style sphere\nboundary {boundary}\nplugin load stokesdynplugin.so\n"
                  f"read_data {folder}/data\nneighbor 0.3 bin\ncomm_modify cutoff 3\ntimestep 1e-9\n")


def measure(n, boundary, words, ratio=1, rotation="no", ranks=1, clock="process_time", apart=()):
    """Seconds of a product, seconds of the set-up of a solve, GB; of one of the runs that are apart"""
    with tempfile.TemporaryDirectory() as folder:
        write(folder, n, boundary, ratio)
        style = ("cut_off_distance inf visc 1 algorithm 2 relative_tolerance 1e-15 warm_start no precondition none "
                 f"rotation {rotation} {words}")
        run = mpirun(ranks)
        out = subprocess.run(run + [sys.executable, "-c", PROGRAM, f"{folder}/in", style, f"1,{1 + MORE}", clock,
                                    str(REPEATS), *apart],
                             check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, env=environment() | {
                                 "LAMMPS_PLUGIN_PATH": os.environ["LAMMPS_PLUGIN_PATH"]}, text=True).stdout.split()
        one, more, setup, memory = [float(word) for word in out[-4:]]
        return (more - one) / MORE, setup, memory


def two_ranks(n, tolerance):
    words = f"far_field ewald far_field_tolerance {tolerance}"
    ways = [(n, 1, ()), (n, 2, ()), (n // 2, 2, APART)]
    times = [[measure(spheres, "p p p", words, ranks=ranks, clock="perf_counter", apart=apart)[:2]
              for spheres, ranks, apart in ways] for _ in range(ROUNDS)]
    one, two, halves = np.median(times, axis=0)
    print(f"{n:<9} {tolerance:9}  {one[0]:9.4f} {two[0]:9.4f} {halves[0]:9.4f}   "
          + "   ".join(f"{one[k] / two[k]:5.2f} {one[k] / halves[k]:5.2f}" for k in (0, 1)), flush=True)


def main():
    if "ranks" in sys.argv:
        print("N         tolerance  s a product: 1 rank, 2, two halves; 1 over 2, 1 over halves: product, set-up")
        two_ranks(100000, "1e-3")
        two_ranks(100000, "1e-6")
        return
    quick = "quick" in sys.argv
    print("N         scene                    tolerance  product/T4  set-up/T4  GB     (T4 in s)")
    for name, n, boundary, tolerance, ratio, rotation in SCENES[:1] if quick else SCENES:
        t4 = measure(10000, "f f f", "far_field direct")[0]
        product, setup, memory = measure(n, boundary, f"far_field ewald far_field_tolerance {tolerance}", ratio,
                                         rotation)
        print(f"{n:<9} {name:24} {tolerance:9}  {product / t4:8.2f}  {setup / t4:9.2f}  {memory:5.2f}   ({t4:.4f})",
              flush=True)


if __name__ == "__main__":
    main()
