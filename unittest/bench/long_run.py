#!/usr/bin/env python3
"""A long run in miniature: a ring of eight spheres on springs sinks and tumbles in a shear flow that swings to and fro,
a million steps. What may creep in, window by window:

    . build/env.sh; unittest/bench/long_run.py [--steps 1000000] [--windows 10]

memory      megabytes allocated and not freed, above those after the first window
residual    largest of all steps; relative_tolerance is 1e-6
momentum    sum of m v at the end of a window less that at its start, less all impulses of drag and weight in between,
            in units of the impulse of the weight: LAMMPS's velocity Verlet conserves it but for rounding
drift       forces at the end of the window against a dense solve of where the spheres are and how fast they go, in
            units of the largest: the warm start must not lead astray. The tolerance times the condition of the
            matrix bounds it, some hundred
Size and velocity of the ring tell that it stays together and goes on moving.

    long_run.py --brownian

Two multiblobs with a film, bound by a bond, each in a trap, with Brownian motion (scheme midpoint): the variance of
each coordinate over Boltzmann's, window by window. x: along the line of the traps; sum, difference: of both spheres'
places. The last lines have the means with their standard errors, from the spread of the windows, and the trend: the
last half of the windows less the first."""
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
    _fields_ = [(name, ctypes.c_size_t) for name in ("arena", "ordblks", "smblks", "hblks", "hblkhd", "usmblks",
                                                     "fsmblks", "uordblks", "fordblks", "keepcost")]


def in_use():
    """Megabytes that are allocated and not freed. What the process has from the system tells less: it has room to
    spare."""
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
                  f"fix spread all ave/histo 1 {length} {length} 0.0 1.0 1 f_drag[5] kind global",
                  "thermo 1000000000"]).run()
    for k in range(count):
        start, first = MASS @ sim.v, sim.fix_vector()[:3]
        sim.command(f"run {length} pre {'no' if k else 'yes'} post no")
        last = sim.fix_vector()[:3]
        # The mean is over the steps 1 ... length; the trapezoidal rule wants half of step 0 instead of half of the
        # last.
        mean = np.array([sim.lmp.extract_fix("sums", 0, 1, nrow=d) for d in range(3)]) + (first - last) / (2 * length)
        impulse = length * DT * (mean - (0, 0, WEIGHT))
        v, x = sim.v, sim.x
        half_step = v - 0.5 * DT * (sim.f / MASS[:, None])     # which velocity Verlet shows to forces
        exact = model.forces(Spheres(x, A, half_step), ETA, flow(x, (k + 1) * length))
        yield {"step": (k + 1) * length, "memory": in_use(), "residual": sim.lmp.extract_fix("spread", 0, 1, nrow=3),
               "momentum": np.abs(MASS @ v - start - impulse).max() / (WEIGHT * length * DT),
               "drift": np.abs(sim.drag - exact).max() / np.linalg.norm(exact, axis=1).max(),
               "size": np.linalg.norm(np.ptp(x, axis=0)), "velocity": v[:, 2].mean(),
               "unconverged": sim.fix_vector()[6]}


def flow(x, step):
    """In units of length and time; the same in the words of LAMMPS is in start()."""
    return np.outer(SHEAR * np.cos(1e-3 * step) * (x[:, 2] - MASS @ x[:, 2] / MASS.sum()), (1.0, 0.0, 0.0))


def start(folder):
    return Simulation(folder, ring(), f"cut_off_distance inf visc {ETA} algorithm 2 relative_tolerance {TOLERANCE} "
                      "fluid_velocity v_shear 0 0", dt=DT, boundary="s s s",
                      before_pair=f"neighbor 1.0 bin\nvariable shear atom {SHEAR}*cos(1e-3*step)*(z-xcm(all,z))")


KT, TRAP, BOND, REST, APART = 0.8, 20.0, 60.0, 2.35, 2.3     # of radius 1
DRAG = 6 * np.pi * ETA


def boltzmann():
    """Means and variances of sum and difference: [6] each, x y z of the one, then of the other"""
    g = np.linspace(-1.3, 1.3, 131)
    x, y, z = np.meshgrid(APART + g, g, g, indexing="ij")
    r = np.sqrt(x * x + y * y + z * z)
    p = np.exp(-(TRAP / 4 * ((x - APART)**2 + y * y + z * z) + BOND / 2 * (r - REST)**2) / KT)
    mean = [(p * c).sum() / p.sum() for c in (x, y, z)]
    return np.array([APART, 0, 0] + mean), np.array([2 * KT / TRAP] * 3 +
                                                    [(p * (c - m)**2).sum() / p.sum() for c, m in zip((x, y, z), mean)])


def brownian_windows(folder, steps, count, every=10):
    """Variances over Boltzmann's [6] and means less Boltzmann's over the deviation [6], a window each"""
    spheres = Spheres([(0, 0, 0), (APART, 0, 0)])
    spheres.bonds = [(1, 2)]
    sim = Simulation(folder, spheres, f"cut_off_distance inf visc {ETA} multiblob 12 lubrication yes", fix=False,
                     dt=0.1 * DRAG / (TRAP + 2 * BOND), box=[(-20.0, 22.0)] * 3)
    sim.commands(["bond_style harmonic", f"bond_coeff 1 {BOND / 2} {REST}", "special_bonds lj/coul 1 1 1",
                  "comm_modify cutoff 9", f"variable fx atom -{TRAP}*(x-{APART}*(id-1))", f"variable fy atom -{TRAP}*y",
                  f"variable fz atom -{TRAP}*z", "fix trap all addforce v_fx v_fy v_fz",
                  f"fix move all stokes_dynamics/overdamped temperature {KT} 4711",
                  "thermo 1000000000"]).run(1000)
    mean, variance = boltzmann()
    for _ in range(count):
        places = []
        for _ in range(steps // count // every):
            sim.run(every, "pre no post no")
            x = sim.x
            places.append(np.concatenate([x[0] + x[1], x[1] - x[0]]))
        places = np.array(places)
        yield ((places - mean)**2).mean(axis=0) / variance, (places.mean(axis=0) - mean) / np.sqrt(variance)
    sim.close()


def run_brownian(folder, steps, count):
    print("    steps  variance over Boltzmann's: sum x      y      z  difference x      y      z", flush=True)
    ratios, means = [], []
    for k, (ratio, mean) in enumerate(brownian_windows(folder, steps, count)):
        ratios.append(ratio)
        means.append(mean)
        print(f"{(k + 1) * (steps // count):9d}  " + " ".join(f"{v:8.3f}" for v in ratio), flush=True)
    ratios, half = np.array(ratios), count // 2
    for name, rows in (("variances", ratios), ("means less Boltzmann's, in deviations", np.array(means))):
        print(f"{name}: " + ", ".join(f"{m:.3f} +- {e:.3f}"
                                      for m, e in zip(rows.mean(axis=0), rows.std(axis=0, ddof=1) / np.sqrt(count))))
    trend = ratios[-half:].mean(axis=1) - ratios[:half].mean(axis=1)
    print(f"trend of the mean variance: {trend.mean():.3f} +- {trend.std(ddof=1) / np.sqrt(half):.3f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--steps", type=int, default=1000000)
    parser.add_argument("--windows", type=int, default=10)
    parser.add_argument("--brownian", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        if options.brownian:
            return run_brownian(folder, options.steps, options.windows)
        sim = start(folder)
        print("    steps  memory MB  largest residual  momentum     drift  size of the ring  velocity  unconverged")
        for w in windows(sim, options.steps, options.windows):
            if w["step"] == options.steps // options.windows:
                memory = w["memory"]
            print("{step:9d}  {grown:9.4f}  {residual:16.6e}  {momentum:8.1e}  {drift:8.1e}  {size:16.2f}  "
                  "{velocity:8.4f}  {unconverged:11.0f}".format(grown=w["memory"] - memory, **w), flush=True)
        sim.close()


if __name__ == "__main__":
    main()
