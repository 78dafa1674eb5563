#!/usr/bin/env python3
"""What keyword precondition's auto chooses, and what each way costs: pair time of short runs, one rank.

    . build/env.sh; unittest/bench/precondition_auto.py [--repeat N] [SCENE ...]

The ways take turns, so that a loaded machine slows all; best of N runs. "Latest": time of the second half of the run
alone, when the first factor is made. Spheres of cold scenes rest and every solve starts from zero; those of warm scenes
fall, freely, and solves start from the last ones."""
import argparse
import os
import re
import subprocess
import tempfile

from from_tests import np
from system import Spheres, environment, input_lines
from suspensions import A, flocs, lattice, loose_lattice


def dilute(n=1000, phi=0.02):
    rng = np.random.default_rng(3)
    side = A * (n * 4 / 3 * np.pi / phi)**(1 / 3)
    return Spheres(rng.uniform(0, side, (n, 3)), A, rng.normal(size=(n, 3)))


def first_of(spheres, n):
    return Spheres(spheres.x[:n], A, spheres.v[:n])


def falling(spheres):
    spheres.v = 0.3 * np.random.default_rng(5).normal(size=spheres.x.shape) + (0, 0, -1.0)
    return spheres


def floating(*how):
    spheres = flocs(*how)
    spheres.v = spheres.v * 0.3
    return spheres


def lone(spheres):
    spheres.molecule = np.zeros(spheres.n, int)
    return spheres


# scene: spheres, cold or warm, tolerance, rotation, steps of each half, the preconditioner that competes
SCENES = {
    "lattice 10^3, cold, 1e-6": (lambda: lattice(10, (0.4, 0.2, 0.1)), "cold", 1e-6, "no", 60, "sparse"),
    "lattice 10^3, cold, 1e-6, rotation": (lambda: lattice(10, (0.4, 0.2, 0.1)), "cold", 1e-6, "yes", 60, "sparse"),
    "cloud 10^3, phi 0.43, warm, 1e-3": (lambda: falling(loose_lattice(10)), "warm", 1e-3, "no", 300, "sparse"),
    "cloud 10^3, phi 0.43, warm, 1e-6": (lambda: falling(loose_lattice(10)), "warm", 1e-6, "no", 120, "sparse"),
    "cloud 10^3, phi 0.43, warm, 1e-6, rotation": (lambda: falling(loose_lattice(10)), "warm", 1e-6, "yes", 60,
                                                   "sparse"),
    "dilute 1000, phi 0.02, cold, 1e-2": (dilute, "cold", 1e-2, "no", 60, "sparse"),
    "dilute 1000, phi 0.02, cold, 1e-6": (dilute, "cold", 1e-6, "no", 60, "sparse"),
    "50 flocs x 20, cold, 1e-6": (lambda: flocs(50, 20, 34.7 * A), "cold", 1e-6, "no", 30, "clump"),
    "50 flocs x 20, cold, 1e-6, rotation": (lambda: flocs(50, 20, 34.7 * A), "cold", 1e-6, "yes", 20, "clump"),
    "50 flocs x 20, free, warm, 1e-3": (lambda: floating(50, 20, 34.7 * A), "warm", 1e-3, "no", 60, "clump"),
    "100 flocs x 20, clumps_only, cold, 1e-6": (lambda: flocs(100, 20, 45.0 * A), "cold", 1e-6, "no", 60, "clump"),
    "100 flocs x 20, clumps_only, warm, 1e-3": (lambda: floating(100, 20, 45.0 * A), "warm", 1e-3, "no", 200, "clump"),
    "50 spheres, cold, 1e-6": (lambda: first_of(loose_lattice(4, 1.0), 50), "cold", 1e-6, "no", 2000, "sparse"),
    "50 spheres, warm, 1e-3": (lambda: first_of(falling(loose_lattice(4)), 50), "warm", 1e-3, "no", 2000, "sparse"),
    "8 spheres, cold, 1e-6": (lambda: loose_lattice(2, 1.0), "cold", 1e-6, "no", 5000, "sparse"),
    "8 spheres, cold, 1e-3": (lambda: loose_lattice(2, 1.0), "cold", 1e-3, "no", 5000, "sparse"),
}


def run(folder, spheres, start, tolerance, rotation, steps, precondition, sees):
    """Of each half: pair seconds a step; of the second: iterations of its last step"""
    words = (f"{sees} visc 1.3 algorithm 2 relative_tolerance {tolerance} max_iter 1000 rotation {rotation} "
             f"warm_start {'yes' if start == 'warm' else 'no'} precondition {precondition}")
    lines = input_lines(spheres, words, os.path.join(folder, "data"), box=[(-60.0, 120.0)] * 3, density=20.0, dt=1e-3,
                        comm="comm_modify cutoff 40")
    if start == "warm":
        lines += ["fix move all nve/sphere", "fix pull all gravity 1 vector 0 0 -1"]
    else:
        lines += ["timestep 1e-12"]
    lines += ["fix mean all ave/time 1 {0} {0} f_drag[4]".format(steps), "thermo_style custom step f_mean", "thermo 0",
              f"run {steps}", f"run {steps} pre no"]
    name, log = os.path.join(folder, "in"), os.path.join(folder, "log")
    with open(name, "w") as out:
        out.write("\n".join(lines) + "\n")
    env = dict(environment(), OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    subprocess.run(["lmp", "-in", name, "-log", log, "-screen", "none", "-nocite"], check=True, env=env)
    with open(log) as f:
        text = f.read()
    seconds = [float(t) / steps for t in re.findall(r"^Pair +\| +\S+ +\| +(\S+)", text, re.M)]
    its = [float(w[1]) for w in (line.split() for line in text.splitlines()) if len(w) == 2 and w[0] == str(2 * steps)]
    return sum(seconds) / 2, seconds[1], its[-1]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=int, default=2)
    parser.add_argument("scene", nargs="*", help="words of the names of scenes; all without")
    args = parser.parse_args()
    print("| scene | iterations none | with | auto | ms a solve, none | with | auto | latest, none | with | auto |"
          " auto over the best |")
    print("|---|" + "---:|" * 10)
    for name, (make, start, tolerance, rotation, steps, rival) in SCENES.items():
        if args.scene and not any(word in name for word in args.scene):
            continue
        spheres = make() if rival == "clump" else lone(make())
        best = {}
        with tempfile.TemporaryDirectory() as folder:
            for _ in range(args.repeat):
                for way in ("none", rival, "auto"):
                    sees = "clumps_only yes" if "clumps_only" in name else "cut_off_distance inf"
                    whole, latest, its = run(folder, spheres, start, tolerance, rotation, steps, way, sees)
                    before = best.get(way, (np.inf, np.inf, its))
                    best[way] = (min(whole, before[0]), min(latest, before[1]), its)
        n, r, a = (best[way] for way in ("none", rival, "auto"))
        print(f"| {name} ({rival}) | {n[2]:.1f} | {r[2]:.1f} | {a[2]:.1f} | {1e3 * n[0]:.3f} | {1e3 * r[0]:.3f} |"
              f" {1e3 * a[0]:.3f} | {1e3 * n[1]:.3f} | {1e3 * r[1]:.3f} | {1e3 * a[1]:.3f} |"
              f" {a[1] / min(n[1], r[1]):.2f} |", flush=True)


if __name__ == "__main__":
    main()
