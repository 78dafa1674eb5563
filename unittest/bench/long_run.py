#!/usr/bin/env python3
"""A long run in miniature: a ring of eight spheres on springs sinks and tumbles in a shear flow that swings to and fro, a million
steps. What may creep in, window by window:

    . build/env.sh; unittest/bench/long_run.py [--steps 1000000] [--windows 10]

memory      megabytes allocated and not freed, above those after the first window
residual    largest of all steps; relative_tolerance is 1e-6
momentum    sum of m v at the end of a window less that at its start, less all impulses of drag and weight in between, in units
            of the impulse of the weight: LAMMPS's velocity Verlet conserves it but for rounding
drift       forces at the end of the window against a dense solve of where the spheres are and how fast they go, in units of the
            largest: the warm start must not lead astray. The tolerance times the condition of the matrix bounds it, some hundred
Size and velocity of the ring tell that it stays together and goes on moving."""
import argparse
import ctypes
import tempfile

from from_tests import np
import model
from system import DENSITY, Simulation, Spheres

ETA, G, SHEAR, DT, TOLERANCE = 1.3, 2.0, 0.5, 0.02, 1e-6
A = np.array([0.7, 0.7, 0.7, 0.7, 0.8, 0.8, 0.6, 0.6])
MASS = 4 / 3 * np.pi * A**3 * DENSITY
WEIGHT = MASS.sum() * G


class Mallinfo2(ctypes.Structure):
    """Of glibc, in bytes"""
    _fields_ = [(name, ctypes.c_size_t) for name in ("arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks", "fsmblks",
                                                     "uordblks", "fordblks", "keepcost")]


def in_use():
    """Megabytes that are allocated and not freed. What the process has from the system tells less: it has room to spare."""
    mallinfo2 = ctypes.CDLL(None).mallinfo2
    mallinfo2.restype = Mallinfo2
    info = mallinfo2()
    return (info.uordblks + info.hblkhd) / 1e6


def ring():
    """Out of round by up to a fifth of a radius; each sphere is bonded to the next, and to the next but two."""
    angle = 2 * np.pi * np.arange(8) / 8
    x = 2.2 * np.stack([np.cos(angle), 0.3 * np.sin(2 * angle), np.sin(angle)], axis=1)
    spheres = Spheres(x + np.random.default_rng(1).uniform(-0.15, 0.15, (8, 3)), A, (0, 0, -0.5))
    spheres.bonds = [(i + 1, (i + k) % 8 + 1) for i in range(8) for k in (1, 3)]
    return spheres


def windows(sim, steps, count):
    """One dictionary a window."""
    length = steps // count
    sim.commands(["bond_style harmonic", "bond_coeff 1 10.0 2.0",
                  f"fix pull all gravity {G} vector 0 0 -1", "fix move all nve/sphere", "thermo_style custom step",
                  f"fix sums all ave/time 1 {length} {length} f_drag[1] f_drag[2] f_drag[3]",
                  f"fix spread all ave/histo 1 {length} {length} 0.0 1.0 1 f_drag[5] kind global", "thermo 1000000000"]).run()
    for k in range(count):
        start, first = MASS @ sim.v, sim.fix_vector()[:3]
        sim.command(f"run {length} pre {'no' if k else 'yes'} post no")
        last = sim.fix_vector()[:3]
        # The mean is over the steps 1 ... length; the trapezoidal rule wants half of step 0 instead of half of the last.
        mean = np.array([sim.lmp.extract_fix("sums", 0, 1, nrow=d) for d in range(3)]) + (first - last) / (2 * length)
        impulse = length * DT * (mean - (0, 0, WEIGHT))
        v, x = sim.v, sim.x
        half_step = v - 0.5 * DT * (sim.f / MASS[:, None])     # which velocity Verlet shows to forces
        exact = model.forces(Spheres(x, A, half_step), ETA, flow(x, (k + 1) * length))
        yield {"step": (k + 1) * length, "memory": in_use(), "residual": sim.lmp.extract_fix("spread", 0, 1, nrow=3),
               "momentum": np.abs(MASS @ v - start - impulse).max() / (WEIGHT * length * DT),
               "drift": np.abs(sim.drag - exact).max() / np.linalg.norm(exact, axis=1).max(),
               "size": np.linalg.norm(np.ptp(x, axis=0)), "velocity": v[:, 2].mean(), "unconverged": sim.fix_vector()[6]}


def flow(x, step):
    """In units of length and time; the same in the words of LAMMPS is in start()."""
    return np.outer(SHEAR * np.cos(1e-3 * step) * (x[:, 2] - MASS @ x[:, 2] / MASS.sum()), (1.0, 0.0, 0.0))


def start(folder):
    return Simulation(folder, ring(), f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance {TOLERANCE} "
                      "fluid_velocity v_shear 0 0", dt=DT, boundary="s s s",
                      before_pair=f"neighbor 1.0 bin\nvariable shear atom {SHEAR}*cos(1e-3*step)*(z-xcm(all,z))")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--steps", type=int, default=1000000)
    parser.add_argument("--windows", type=int, default=10)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        sim = start(folder)
        print("    steps  memory MB  largest residual  momentum     drift  size of the ring  velocity  unconverged")
        for w in windows(sim, options.steps, options.windows):
            if w["step"] == options.steps // options.windows:
                memory = w["memory"]
            print("{step:9d}  {grown:9.4f}  {residual:16.6e}  {momentum:8.1e}  {drift:8.1e}  {size:16.2f}  {velocity:8.4f}  "
                  "{unconverged:11.0f}".format(grown=w["memory"] - memory, **w), flush=True)
        sim.close()


if __name__ == "__main__":
    main()
