#!/usr/bin/env python3
"""Rate of the all-pairs product inside a LAMMPS run, on 1 and 2 ranks, against the bare kernel of the core: 10 000
polydisperse spheres, forces alone and with torques (rotation yes), max_iter 1.

    cmake --build build --target bench_product; . build/env.sh; OPENBLAS_NUM_THREADS=1
    unittest/bench/product_in_lammps.py [REPEATS]

The pair time of the log holds all that a step of the pair style does. A solve of one iteration from zero has two
products, that of the iteration and that of the residual checked at its end. Kernel, 1 rank and 2 ranks take turns;
medians of the repeats."""
import os
import re
import subprocess
import sys
import tempfile

from from_tests import np

N, STEPS = 10000, 5
BENCH = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "build", "bench_product")


def kernel():
    """Pairs per second of the bare kernel: of forces, with torques"""
    words = subprocess.run([BENCH, "kernel"], check=True, capture_output=True, text=True).stdout.split()
    return {"no": float(words[1]), "yes": float(words[3])}


def pair_time(folder, ranks, rotation):
    """Seconds a step"""
    rng = np.random.default_rng(1)
    a = rng.uniform(0.5, 1.5, N)
    side = (4 / 3 * np.pi * (a**3).sum() / 0.2)**(1 / 3)
    x, v = rng.uniform(0, side, (N, 3)), rng.normal(size=(N, 3))
    data, log = os.path.join(folder, "data"), os.path.join(folder, "log")
    with open(data, "w") as out:
        out.write(f"spheres\n\n{N} atoms\n1 atom types\n\n")
        out.write("".join(f"0 {side:.17g} {c}lo {c}hi\n" for c in "xyz"))
        out.write("\nAtoms\n\n" + "".join(f"{i + 1} 1 {2 * a[i]} 1.0 {x[i][0]} {x[i][1]} {x[i][2]}\n"
                                          for i in range(N)))
        out.write("\nVelocities\n\n" + "".join(f"{i + 1} {v[i][0]} {v[i][1]} {v[i][2]} 0 0 0\n" for i in range(N)))
    with open(os.path.join(folder, "in"), "w") as out:
        out.write(f"""units lj
atom_style sphere
boundary f f f
comm_modify mode single
plugin load stokesdynplugin.so
read_data {data}
pair_style stokes_dynamics cut_off_distance inf visc 1 algorithm 2 max_iter 1 relative_tolerance 1e-15 &
           warm_start no precondition none rotation {rotation}
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
    return float(re.search(r"^Pair +\| +\S+ +\| +(\S+)", text, re.M).group(1)) / STEPS


def main():
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    cases = [(rotation, ranks) for rotation in ("no", "yes") for ranks in (0, 1, 2)]    # 0: the kernel
    rate = {case: [] for case in cases}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(repeats):
            bare = kernel()
            for rotation, ranks in cases:
                rate[rotation, ranks].append(2 * N * N / pair_time(folder, ranks, rotation) if ranks
                                             else bare[rotation])
    print(f"{'':34s} {'G pairs/s':>10s} {'of kernel':>10s} {'of 1 rank':>10s}")
    for rotation, ranks in cases:
        name = (("forces and torques" if rotation == "yes" else "forces") +
                (f", {ranks} rank(s)" if ranks else ", bare kernel"))
        now, bare, one = (np.median(rate[rotation, r]) for r in (ranks, 0, 1))
        print(f"{name:34s} {1e-9 * now:10.3f} {now / bare:10.2f} " + (f"{now / one:10.2f}" if ranks else ""))


if __name__ == "__main__":
    main()
