#!/usr/bin/env python3
"""Rate of the all-pairs product inside a LAMMPS run, on 1 and 2 ranks: 10 000 polydisperse spheres, max_iter 1.

    . build/env.sh; unittest/bench/product_in_lammps.py [REPEATS]

The pair time of the log holds all that a step of the pair style does. A solve of one iteration from zero has two products, that
of the iteration and that of the residual checked at its end; of two iterations three. The difference of the two is one product
and the vector work of one iteration. The best of the repeats is printed, as the least disturbed;
processor time is pair time by the CPU use of the log."""
import os
import re
import subprocess
import sys
import tempfile

DEBIAN = "/usr/bin/python3"
try:
    import numpy as np
except ImportError:
    if sys.executable == DEBIAN or not os.path.exists(DEBIAN):
        raise
    os.execv(DEBIAN, [DEBIAN] + sys.argv)

N, STEPS = 10000, 5


def pair_time(folder, ranks, iterations):
    """Seconds a step: of the clock, of the processor"""
    rng = np.random.default_rng(1)
    a = rng.uniform(0.5, 1.5, N)
    side = (4 / 3 * np.pi * (a**3).sum() / 0.2)**(1 / 3)
    x, v = rng.uniform(0, side, (N, 3)), rng.normal(size=(N, 3))
    data, log = os.path.join(folder, "data"), os.path.join(folder, "log")
    with open(data, "w") as out:
        out.write(f"spheres\n\n{N} atoms\n1 atom types\n\n")
        out.write("".join(f"0 {side!r} {c}lo {c}hi\n" for c in "xyz"))
        out.write("\nAtoms\n\n" + "".join(f"{i + 1} 1 {2 * a[i]} 1.0 {x[i][0]} {x[i][1]} {x[i][2]}\n" for i in range(N)))
        out.write("\nVelocities\n\n" + "".join(f"{i + 1} {v[i][0]} {v[i][1]} {v[i][2]} 0 0 0\n" for i in range(N)))
    with open(os.path.join(folder, "in"), "w") as out:
        out.write(f"""units lj
atom_style sphere
boundary f f f
comm_modify mode single
plugin load stokesdynplugin.so
read_data {data}
pair_style stokes_dynamics cut_off_distance inf visc 1 algorithm 2 max_iter {iterations} relative_tolerance 1e-15 &
           warm_start no precondition none
pair_coeff * *
fix drag all stokes_dynamics apply no
run {STEPS}
""")
    env = dict(os.environ, OMP_NUM_THREADS="1")
    if os.getuid() == 0:
        env.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    words = ["lmp", "-in", os.path.join(folder, "in"), "-log", log, "-screen", "none", "-nocite"]
    if ranks > 1:
        words = ["mpirun", "-np", str(ranks)] + words
    subprocess.run(words, check=True, env=env, stdout=subprocess.DEVNULL)
    with open(log) as lines:
        text = lines.read()
    wall = float(re.search(r"^Pair +\| +\S+ +\| +(\S+)", text, re.M).group(1)) / STEPS
    return wall, wall * float(re.search(r"([0-9.]+)% CPU use", text).group(1)) / 100.0


def main():
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    best = {}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(repeats):
            for ranks in (1, 2):
                for iterations in (1, 2):
                    key = ranks, iterations
                    best[key] = np.minimum(best.get(key, np.inf), pair_time(folder, ranks, iterations))
    for k, clock in enumerate(("wall clock", "processor time of a rank")):
        for ranks in (1, 2):
            one, two = best[ranks, 1][k], best[ranks, 2][k]
            print(f"{clock}, {ranks} rank(s): pair time {one:.4f} s a step, 2 products: {2e-9 * N * N / one:.3f} G pairs/s; "
                  f"one more product: {1e-9 * N * N / (two - one):.3f} G pairs/s")
        print(f"2 ranks against 1: {best[1, 1][k] / best[2, 1][k]:.2f}")


if __name__ == "__main__":
    main()
