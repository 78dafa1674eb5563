#!/usr/bin/env python3
"""22 x 22 x 22 touching spheres in a LAMMPS run, unit velocity, from zero, relative_tolerance 1e-6: drag, iterations,
seconds a product, on 1 and 2 ranks, with the diagonal and with the sparse factor.

    . build/env.sh; unittest/bench/lattice_in_lammps.py [SIDE]

Step 0 makes the factor, step 1 keeps it (warm_start no, spheres at rest in their places), so the difference is the
set-up. Seconds a product: pair time of step 1 over its products, iterations and one check; the vector work and the
factor's are in it. The known drag is that of libstokes (Ichiki), an independent code, in units of 6 pi eta a U."""
import os
import re
import subprocess
import sys
import tempfile

from math import pi

A, ETA, U = 0.7, 1.3, 0.9
KNOWN = {10: 12.852858, 22: 29.013577}


def run(folder, side, ranks, precondition):
    """Drag over 6 pi eta a U, iterations, residual, seconds of set-up and of the solve"""
    name = os.path.join(folder, "in")
    spacing, end = 2 * A, 2 * A * side
    with open(name, "w") as out:
        out.write(f"""units lj
atom_style sphere
boundary f f f
plugin load stokesdynplugin.so
lattice sc {1 / spacing**3:.17g}
region box block {-end} {2 * end} {-end} {2 * end} {-end} {2 * end} units box
create_box 1 box
region grid block {-0.1 * A} {end - A} {-0.1 * A} {end - A} {-0.1 * A} {end - A} units box
create_atoms 1 region grid
set group all diameter {2 * A:.17g} density 1
velocity all set {U:.17g} 0 0 units box
timestep 1e-12
pair_style stokes_dynamics cut_off_distance inf visc {ETA:.17g} algorithm 2 relative_tolerance 1e-6 max_iter 1000 &
           warm_start no precondition {precondition}
pair_coeff * *
fix drag all stokes_dynamics apply no
thermo 1
thermo_style custom step atoms f_drag[1] f_drag[4] f_drag[5]
thermo_modify norm no format float %.12g
run 0
run 1 pre no
""")
    env = dict(os.environ, OMP_NUM_THREADS="1", OPENBLAS_NUM_THREADS="1")
    if os.getuid() == 0:
        env.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    log = os.path.join(folder, "log")
    words = ["lmp", "-in", name, "-log", log, "-screen", "none", "-nocite"]
    subprocess.run(["mpirun", "-np", str(ranks)] + words, check=True, env=env, stdout=subprocess.DEVNULL)
    with open(log) as lines:
        text = lines.read()
    rows = re.findall(r"^ +1 +(\d+) +(\S+) +(\S+) +(\S+) *$", text, re.M)
    pair = re.findall(r"^Pair +\| +\S+ +\| +(\S+)", text, re.M)
    atoms, force, iterations, residual = (float(v) for v in rows[-1])
    if atoms != side**3:
        sys.exit(f"{atoms:.0f} spheres instead of {side**3}")
    return -force / (6 * pi * ETA * A * U), int(iterations), residual, float(pair[-1])


def main():
    side = int(sys.argv[1]) if len(sys.argv) > 1 else 22
    known = KNOWN.get(side)
    print(f"{side}^3 touching spheres; known drag {known}")
    print(f"{'':18s} {'drag':>12s} {'error':>9s} {'iterations':>10s} {'residual':>9s} {'solve, s':>9s} "
          f"{'s/product':>10s}")
    with tempfile.TemporaryDirectory() as folder:
        for precondition in ("none", "sparse"):
            for ranks in (1, 2):
                drag, iterations, residual, seconds = run(folder, side, ranks, precondition)
                error = f"{drag / known - 1:9.1e}" if known else ""
                print(f"{precondition + ', ' + str(ranks) + ' rank(s)':18s} {drag:12.6f} {error:>9s} {iterations:10d} "
                      f"{residual:9.1e} {seconds:9.3f} {seconds / (iterations + 1):10.5f}", flush=True)


if __name__ == "__main__":
    main()
