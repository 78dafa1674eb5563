#!/usr/bin/env python3
"""Cost of motion without inertia, inside LAMMPS on one core.

    overdamped.py [REPEATS] [N] [CLUMPS]
    overdamped.py films [REPEATS] [SIDE]
    overdamped.py ranks [REPEATS] [SIDE]

Free spheres: a step of fix stokes_dynamics/overdamped, N spheres (4000), all pairs, in units of one product, which is
half of what a solve of one iteration takes (max_iter 1: two products). Rigid clumps: a step of 10 000 clumps of ten
with clumps_only yes, shell 42, against pair style and fix rigid/small. Both answers are exact: one product, one 6x6.
Films: a step of SIDE^3 (22) spheres at volume fraction 0.3 in a periodic box, every second pulled up and the others
down, with and without lubrication, to 1e-3; the fastest move 0.01 radii a step. Ranks: the step with lubrication of
SIDE^3 (46) spheres on one rank and on two, and of two runs of half as many side by side, which is the most that two
ranks could be; steps of one product and of two alternate, not in the same order on one rank and on two, so that their
number is even. Medians; what is compared takes turns."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

from from_tests import APART, np
from system import environment

HERE = pathlib.Path(__file__).resolve().parent


def loop_time(words, steps, ranks=1, apart=()):
    """Seconds a step, set-up not counted: of one rank those of the processor, which other programs do not lengthen; of
    several, and of the first of those that are apart, by the clock"""
    start = ["mpirun", "-np", str(ranks)] if ranks > 1 else []
    with tempfile.TemporaryDirectory() as folder:
        log = os.path.join(folder, "log")
        subprocess.run(start + ["lmp", "-log", log, "-screen", "none", "-nocite", *apart] + words, check=True, cwd=HERE,
                       stdout=subprocess.DEVNULL, env=environment())
        said = open(log + (".0" if apart else "")).read()
    seconds, busy = (float(re.findall(line, said, re.M)[-1]) for line in (r"^Loop time of (\S+)", r"^(\S+)% CPU use"))
    return seconds / steps * (busy / 100 if ranks == 1 else 1)


def cloud(folder, n):
    rng = np.random.default_rng(1)
    side = (4 / 3 * np.pi * n / 0.1)**(1 / 3)
    x = rng.uniform(0, side, (n, 3))
    data = os.path.join(folder, "data")
    with open(data, "w") as out:
        out.write(f"spheres\n\n{n} atoms\n1 atom types\n\n")
        out.write("".join(f"{-side:.17g} {2 * side:.17g} {c}lo {c}hi\n" for c in "xyz"))
        out.write("\nAtoms\n\n" + "".join(f"{i + 1} 1 2.0 1.0 {p[0]} {p[1]} {p[2]}\n" for i, p in enumerate(x)))
    return data


def spheres(folder, data, rotation, overdamped, steps):
    moves = ("pair_style stokes_dynamics cut_off_distance inf far_field direct visc 1 rotation {}\npair_coeff * *\n"
             "fix f all addforce 0 0 -1\n"
             "fix m all stokes_dynamics/overdamped") if overdamped else (
             "pair_style stokes_dynamics cut_off_distance inf far_field direct visc 1 rotation {} "
             "algorithm 2 max_iter 1 warm_start no precondition none\npair_coeff * *\nvelocity all set 0 0 1\n"
             "fix d all stokes_dynamics apply no")
    with open(os.path.join(folder, "in"), "w") as out:
        out.write("units lj\natom_style sphere\nboundary f f f\nplugin load stokesdynplugin.so\n"
                  f"read_data {data}\ntimestep 1e-6\n{moves.format(rotation)}\nrun {steps}\n")
    return loop_time(["-in", os.path.join(folder, "in")], steps)


def films(folder, side, words, steps=20, ranks=1, apart=()):
    """A cubic lattice shaken by up to 0.19 radii, so that nobody overlaps; of runs that are apart each has half"""
    spacing, rng = (4 / 3 * np.pi / 0.3)**(1 / 3), np.random.default_rng(1)
    deep = side // 2 if apart else side
    places = np.indices((side, side, deep)).reshape(3, -1).T
    x = spacing * (places + 0.5) + rng.uniform(-0.19, 0.19, places.shape)
    with open(os.path.join(folder, "data"), "w") as out:
        out.write(f"spheres\n\n{len(x)} atoms\n1 atom types\n\n" +
                  "".join(f"0 {m * spacing:.17g} {c}lo {c}hi\n" for c, m in zip("xyz", (side, side, deep))))
        out.write("\nAtoms\n\n" + "".join(f"{i + 1} 1 2.0 1.0 {p[0]} {p[1]} {p[2]}\n" for i, p in enumerate(x)))
    with open(os.path.join(folder, "in"), "w") as out:
        out.write("units lj\natom_style sphere\nboundary p p p\nplugin load stokesdynplugin.so\n"
                  f"read_data {folder}/data\ntimestep 0.2\n"
                  "pair_style stokes_dynamics cut_off_distance inf visc 1 rotation yes relative_tolerance 1e-3 "
                  f"{words}\npair_coeff * *\nvariable f atom 2*(id%2)-1\nfix f all addforce 0 0 v_f\n"
                  "fix m all stokes_dynamics/overdamped\n"
                  f"run 5\nrun {steps}\n")
    return loop_time(["-in", os.path.join(folder, "in")], steps, ranks, apart)


def clumps(overdamped, count, steps=50):
    n = round((count / 10)**(1 / 3))
    words = "clumps_only yes rigid_clumps yes shell 42"
    return loop_time(["-in", "in.rigid_clumps", "-var", "n", str(n), "-var", "steps", str(steps), "-var", "model",
                      words]
                     + (["-var", "overdamped", "yes"] if overdamped else []), steps)


def main():
    if sys.argv[1:2] == ["films"]:
        repeats, side = (int(sys.argv[k]) if len(sys.argv) > k else d for k, d in ((2, 3), (3, 22)))
        with tempfile.TemporaryDirectory() as folder:
            times = np.array([[films(folder, side, words) for words in ("", "lubrication yes")]
                              for _ in range(repeats)])
        without, with_films = np.median(times, axis=0)
        print(f"{side**3} free spheres in a periodic box: a step {1e3 * without:.1f} ms, "
              f"with lubrication {1e3 * with_films:.1f} ms")
        return
    if sys.argv[1:2] == ["ranks"]:
        repeats, side = (int(sys.argv[k]) if len(sys.argv) > k else d for k, d in ((2, 3), (3, 46)))
        with tempfile.TemporaryDirectory() as folder:
            times = np.array([[films(folder, side, "lubrication yes", 10, ranks, apart)
                               for ranks, apart in ((1, ()), (2, ()), (2, APART))] for _ in range(repeats)])
        print(f"{side**3} free spheres with lubrication: a step {1e3 * np.median(times[:, 0]):.0f} ms on one rank; "
              "times as fast " + "; ".join(f"{what} {np.median(ratio):.2f} ({', '.join('%.2f' % r for r in ratio)})"
                                           for what, ratio in (("on two ranks", times[:, 0] / times[:, 1]),
                                                               ("in two halves", times[:, 0] / times[:, 2]))))
        return
    repeats, n, count = (int(sys.argv[k]) if len(sys.argv) > k else d for k, d in ((1, 5), (2, 4000), (3, 10000)))
    with tempfile.TemporaryDirectory() as folder:
        data = cloud(folder, n)
        for rotation in ("no", "yes"):
            times = np.array([[spheres(folder, data, rotation, o, 5) for o in (True, False)] for _ in range(repeats)])
            step, two = np.median(times, axis=0)
            print(f"{n} free spheres, rotation {rotation}: a step {1e3 * step:.1f} ms, {2 * step / two:.2f} products "
                  f"of {500 * two:.1f} ms")
    times = np.array([[clumps(o, count) for o in (True, False)] for _ in range(repeats)])
    new, old = np.median(times, axis=0)
    print(f"{count} clumps of 10, shell 42, clumps_only yes: a step {1e3 * new:.1f} ms; pair style and fix rigid/small"
          f" {1e3 * old:.1f} ms: {new / old:.2f}")


if __name__ == "__main__":
    main()
