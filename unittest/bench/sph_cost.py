#!/usr/bin/env python3
"""Cost of pair_style sph/artVisc/tensCorr beside LAMMPS's own sph/taitwater with fix sph, and the error of its forces.

    . build/env.sh
    /usr/bin/python3 unittest/bench/sph_cost.py [--repeat 5] [--steps 50] [--ranks] [--only WORDS]

64 000 particles on a cubic lattice of 40^3, displaced by up to 5 %, support 2.4 spacings (57 neighbours, each particle
counted), skin 0.2 spacings, periodic. Every repetition runs the rival and all of ours one after the other, so that a
busy machine slows all alike; the table has the median of the ratios, of processor time on one rank. The error is the
largest difference of static forces from an evaluation in numpy of the random scene in unittest/data/sph, over the
largest force. --ranks: 1 and 2 ranks instead.
"""
import argparse
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

from from_tests import np
import sph_tools as T

SCENE = """
units si
atom_style sph
lattice sc 0.01
region box block 0 0.4 0 0.4 0 0.4 units box
create_box 1 box
create_atoms 1 box
mass 1 0.001
displace_atoms all random 0.0005 0.0005 0.0005 1234 units box
set group all sph/rho 1000
neighbor 0.002 bin
neigh_modify delay 0 every 1
timestep 5e-5
thermo 1000
"""
OURS = SCENE + """
pair_style sph/artVisc/tensCorr {kernel} 0.012 {terms}
pair_coeff * * c 20
fix eos all sph/pressure Tait 57142.857 1000 7
fix density all sph/density/continuity {density}
fix move all {integrator}
"""
RIVAL = SCENE + """
pair_style sph/taitwater
pair_coeff * * 1000 20 0.1 0.024
fix move all sph
"""
BOTH = "artVisc 0.1 0 1.44e-6 tensCorr 0.2 0.01"
CASES = {"sph/taitwater, fix sph": RIVAL}
for kernel in ("wendland", "cubicspline"):
    for name, terms in (("plain", ""), ("artVisc + tensCorr", BOTH)):
        for integrator in ("nve/sph", "sph"):
            CASES["%s, %s, fix %s" % (kernel, name, integrator)] = OURS.format(kernel=kernel, terms=terms,
                                                                               integrator=integrator, density="")
for name, terms, density in (("artVisc", "", ""), ("artVisc + delta", "", "delta 0.1"),
                             ("artVisc + delta + shift", "shift yes", "delta 0.1"),
                             ("artVisc + delta + pliant shift", "shift pliant", "delta 0.1"),
                             ("artVisc + delta + correction", "correction yes", "delta 0.1")):
    CASES["wendland, %s, fix nve/sph" % name] = OURS.format(kernel="wendland", terms="artVisc 0.1 0 1.44e-6 " + terms,
                                                            integrator="nve/sph", density=density)


def seconds(script, steps, ranks, folder):
    path = os.path.join(folder, "in.bench")
    with open(path, "w") as f:
        f.write("plugin load stokesdynplugin.so\n" + script + "run 5\nrun %d\n" % steps)
    env = dict(os.environ, OMP_NUM_THREADS="1")
    if os.getuid() == 0:
        env.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    mpi = [shutil.which("mpirun.openmpi") or "mpirun", "-np", str(ranks)] if ranks > 1 else []
    out = subprocess.run(mpi + ["lmp", "-in", path, "-log", "none", "-nocite"], cwd=folder, env=env,
                         capture_output=True, text=True).stdout
    times, used = re.findall(r"Loop time of ([0-9.e+-]+)", out), re.findall(r"([0-9.]+)% CPU use", out)
    if len(times) != 2:
        sys.exit("the run failed:\n" + out[-2000:])
    return float(times[1]) * (float(used[1]) / 100 if ranks == 1 else 1)


def force_error(kernel, corrections):
    lmp = T.start()
    T.run(lmp, T.random_scene() + T.pair_commands(kernel, corrections, corrections) + "\nfix move all nve/sph\nrun 0")
    types = T.by_id(lmp, "type") - 1
    each = lambda values: np.array(values)[types]
    rho = T.by_id(lmp, "rho")
    F = T.evaluate(kernel, 3, T.by_id(lmp, "x", 3), T.by_id(lmp, "v", 3), rho, T.tait(rho), each(T.MASS), each(T.H),
                   (each(T.ALPHA), each(T.BETA), each(T.C), T.ETA) if corrections else None,
                   (T.EPSILON, each(T.DELTAP)) if corrections else None)[0]
    error = np.abs(T.by_id(lmp, "f", 3) - F).max() / np.abs(F).max()
    lmp.close()
    return error


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--steps", type=int, default=50)
    parser.add_argument("--ranks", action="store_true")
    parser.add_argument("--only", default="", help="only the cases with this in their name, and the rival")
    options = parser.parse_args()
    per = 1e6 / (64000 * options.steps)
    for name in [n for n in CASES if options.only not in n and not n.startswith("sph")]:
        del CASES[name]
    with tempfile.TemporaryDirectory() as folder:
        if options.ranks:
            print("| case | 1 rank, us per particle and step | 2 ranks | speed-up (median of %d) |\n|---|---|---|---|" %
                  options.repeat)
            for name in [n for n in CASES if n.endswith("nve/sph")] + ["sph/taitwater, fix sph"]:
                times = [(seconds(CASES[name], options.steps, 1, folder),
                          seconds(CASES[name], options.steps, 2, folder))
                         for _ in range(options.repeat)]
                one, two = (statistics.median(t[k] for t in times) * per for k in (0, 1))
                print("| %s | %.3f | %.3f | %.2f |" % (name, one, two, statistics.median(t[0] / t[1] for t in times)),
                      flush=True)
            return
        times = {name: [] for name in CASES}
        for _ in range(options.repeat):
            for name in CASES:
                times[name].append(seconds(CASES[name], options.steps, 1, folder))
        rival = times["sph/taitwater, fix sph"]
        print("| case | us per particle and step | over the rival (median of %d; least, most) | error of the forces |\n"
              "|---|---|---|---|" %
              options.repeat)
        for name in CASES:
            ratios = sorted(mine / theirs for mine, theirs in zip(times[name], rival))
            error = "" if name.startswith("sph") else "%.0e" % force_error(name.split(",")[0], "artVisc" in name)
            print("| %s | %.3f | %.2f (%.2f, %.2f) | %s |" % (name, statistics.median(times[name]) * per,
                                                              statistics.median(ratios), ratios[0], ratios[-1], error))


if __name__ == "__main__":
    main()
