#!/usr/bin/env python3
"""Spheres of unlike radii whose points go with the radius (multiblob 12), beside 12 points for all (multiblob_most 12):
errors and cost.

    . build/env.sh; unittest/bench/unlike.py [pairs [RATIO ...] | groups | suspensions [SETS] | equal [SETS] | clusters]

pairs: two spheres alone under eleven loads (unlike_pairs.csv), twelve orientations; the worst load's error of the
smaller sphere, on the scale of its own motion (unittest/lammps/unlike.py): mean over the orientations, worst one.
groups: of three and four spheres, the worst small one under each kind of load. suspensions: two radii, half and half by
volume, volume fraction 0.25, periodic: viscosity, settling and self-diffusion of both classes over lone ones, and what
they are off 162 points for all, in per cent of themselves; the settling of small spheres, which is next to nothing, of
the lone speed. equal: hard spheres of one radius by shells of any kind, beside the published fits. clusters: those of
near_contact_clusters.csv, 3 to 27 spheres; radii of 0.6 to 1.6 in some. Cost: processor time of a solve from zero to
1e-3."""
import csv
import os
import pathlib
import sys
import tempfile
import time

from from_tests import np
import model
import unlike
from system import Simulation

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples"))
from equilibrium import compressibility, hard_spheres    # noqa: E402
from in_lammps import SHEARS, InLammps    # noqa: E402

BY_RADIUS, ALIKE = "multiblob 12 lubrication yes", "multiblob 12 lubrication yes multiblob_most 12"
GAPS = (0.01, 0.055, 0.1, 0.3, 1.0)
FINE = "multiblob 162 lubrication yes"


made, folder = [], tempfile.mkdtemp()


def simulation(spheres, style, **options):
    while made:
        made.pop().close()
    made.append(Simulation(folder, spheres, style, **options))
    return made[-1]


def groups():
    for case, (_, a, _) in unlike.GROUPS.items():
        for name, style in (("by radius", BY_RADIUS), ("12 for all", ALIKE)):
            off = unlike.group_errors(unlike.group_motions(simulation, case, style), case)
            print(f"| {case} | {name} | " + " | ".join(f"{kind} {value[a < 0.99].max():.1f}"
                                                       for kind, value in off.items()) + " |", flush=True)


def pairs(ratios):
    known = unlike.rows()
    for ratio in ratios:
        for name, style in (("by radius", BY_RADIUS), ("12 for all", ALIKE)):
            cells, spin = [], []
            for xi in GAPS:
                V0 = unlike.exact(known[ratio, xi])
                V = unlike.motions(simulation, folder, ratio, xi, style, unlike.turns(12))
                off = 100 * unlike.errors(V, V0, ratio)[..., 1]
                cells.append(f"{off.mean(axis=0).max():.1f} ({off.max():.1f})")
                k = unlike.LOADS.index("E shear")
                spin.append(100 * np.linalg.norm((V - V0)[:, k, 1, 3:], axis=-1).mean() / np.linalg.norm(V0[k, 1, 3:]))
            print(f"| 1 : {ratio:g} | {name} | " + " | ".join(cells) + f" | {max(spin):.1f} |", flush=True)


def packed(a, phi, seed, gap=2e-3):
    """Places [n, 3] of spheres that do not overlap in a periodic cube, and its edge: pushed apart, then moved at
    random"""
    rng = np.random.default_rng(seed)
    edge, n = (4 / 3 * np.pi * (a ** 3).sum() / phi) ** (1 / 3), len(a)
    x = rng.uniform(0, edge, (n, 3))
    nearest = lambda d: d - edge * np.rint(d / edge)    # noqa: E731
    touch = a[:, None] + a
    for _ in range(20000):
        d = nearest(x[:, None] - x)
        r = np.linalg.norm(d, axis=-1) + 99 * np.eye(n)
        over = np.maximum(touch * (1 + gap) - r, 0)
        if over.max() < 0.2 * gap * a.min():
            break
        share = a ** 3 / (a[:, None] ** 3 + a ** 3)
        x = x + ((0.8 * share * over)[..., None] * d / r[..., None]).sum(axis=1)
    for _ in range(60):
        for i in rng.permutation(n):
            there = x[i] + rng.normal(size=3) * 0.15 * a[i]
            r = np.linalg.norm(nearest(there - x), axis=1)
            r[i] = 99
            if (r > touch[i] * (1 + gap / 2)).all():
                x[i] = there
    return x % edge, edge


def measured(lammps, keywords, x, edge, a, classes, probes=6):
    """Viscosity, then settling and self-diffusion of each class over lone ones; seconds of a solve"""
    n = len(x)
    lammps.place(x, f"cut_off_distance inf {keywords} fluid_velocity box", edge, tolerance=1e-3, radius=a)
    # first, as long as nothing pushes the spheres
    eta = 1 - np.mean([s[3 + k] + s[9 + k] for k, s in enumerate(map(lammps.stress, SHEARS))])
    began, heavy = time.process_time(), a[:, None] ** 3
    fall = np.array([lammps.velocities(heavy * e) @ e for e in np.eye(3)]).mean(axis=0) / a ** 2
    cost = (time.process_time() - began) / 3
    signs = np.random.default_rng(5).choice([-1.0, 1.0], (probes, n, 3))
    D = np.mean([(f * lammps.velocities(f)).mean(axis=1) for f in signs], axis=0) * a
    return np.array([eta] + [what[which].mean() for what in (fall, D) for which in classes]), cost


def suspensions(sets):
    lammps = InLammps(pathlib.Path(tempfile.mkdtemp()))
    print("viscosity, settling large, small, D large, small: in the first set; off 162 points for all, "
          "mean of the sets, per cent")
    for name, large, small, ratio in (("1:2", 10, 80, 2.0), ("1:3", 4, 108, 3.0)):
        a = np.r_[np.ones(large), np.full(small, 1 / ratio)]
        classes, found = (a > 0.99, a < 0.99), {}
        for k in range(sets):
            x, edge = packed(a, 0.25, 11 + k)
            for style in (ALIKE, BY_RADIUS, FINE):
                value, cost = measured(lammps, style, x, edge, a, classes)
                found.setdefault(style, []).append((value, cost))
        fine = np.array([value for value, _ in found[FINE]])
        for style, rows in found.items():
            off = 100 * (np.array([value for value, _ in rows]) - fine) / np.where(np.arange(5) == 2, 1.0, fine)
            print(f"{name} {style:55s} " + " ".join(f"{v:8.4f}" for v in rows[0][0]) + " | " +
                  " ".join(f"{v:+6.2f}" for v in off.mean(axis=0)) + " worst " +
                  " ".join(f"{v:5.2f}" for v in np.abs(off).max(axis=0)) +
                  f" | {np.median([cost for _, cost in rows]):.2f} s", flush=True)


def fits(phi):
    """Settling, diffusion, viscosity of hard spheres (examples/hard_spheres/run.py has the sources)"""
    crowd = phi * (1 + phi * (1 + phi - 2.3 * phi ** 2))
    return np.array([1 - 6.5464 * phi * (1 - 3.348 * phi + 7.426 * phi ** 2 - 10.034 * phi ** 3 + 5.882 * phi ** 4),
                     1 - 1.8315 * phi * (1 + 0.1195 * phi - 0.70 * phi ** 2), (1 + 1.5 * crowd) / (1 - crowd)])


def equal(sets, n=500):
    lammps = InLammps(pathlib.Path(tempfile.mkdtemp()))
    for phi in (0.3, 0.45, 0.5):
        for k, (x, edge) in enumerate(hard_spheres(n, phi, sets, seed=1 + int(100 * phi))):
            for points in ("12", "42", "42 half", "162"):
                (eta, K, D), cost = measured(lammps, f"multiblob {points} lubrication yes", x, edge, np.ones(n),
                                             (np.ones(n, bool),))
                waves = 1.7601 * (phi / n) ** (1 / 3) / eta     # longer than the box
                value = np.array([K + compressibility(phi) * waves, D + waves, eta])
                print(f"phi {phi}, set {k}, multiblob {points:8s} settling, D, viscosity " +
                      " ".join(f"{v:.4f}" for v in value) + " | off the fits, % " +
                      " ".join(f"{v:+.1f}" for v in 100 * (value / fits(phi) - 1)) + f" | {cost:.2f} s", flush=True)


def clusters():
    """Mean and largest error of all velocities of a cluster"""
    found = {}
    with open(os.path.join(model.DATA, "motion", "near_contact_clusters.csv")) as lines:
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            found.setdefault((row["case"], row["load"]),
                             []).append([float(row[name]) for name in "x y z a Fx Fy Fz Ux Uy Uz".split()])
    lammps = InLammps(pathlib.Path(tempfile.mkdtemp()))
    for points in ("12", "12 multiblob_most 12", "42", "42 half", "162"):
        off, costs = {}, []
        for (case, load), rows in found.items():
            rows = np.array(rows)
            unequal = "unlike radii" if np.ptp(rows[:, 3]) > 0.1 else "equal radii"
            began = time.process_time()
            lammps.place(rows[:, :3], f"cut_off_distance inf multiblob {points} lubrication yes", radius=rows[:, 3])
            # 6 pi eta is 1 here, eta in the table
            v, exact = lammps.velocities(rows[:, 4:7]) / (6 * np.pi), rows[:, 7:]
            off.setdefault((unequal, load.split("_")[0]),
                           []).append((100 * np.linalg.norm(v - exact) / np.linalg.norm(exact), case))
            costs.append(time.process_time() - began)
        for key, values in sorted(off.items()):
            worst = max(values)
            print(f"multiblob {points:22s} {key[0]}, {key[1]:7s} {len(values):3d}: "
                  f"mean {np.mean([v for v, _ in values]):.2f} %, worst {worst[0]:.2f} ({worst[1]}) | "
                  f"{np.mean(costs):.3f} s", flush=True)


if __name__ == "__main__":
    words = sys.argv[1:] or ["pairs"]
    if words[0] == "pairs":
        pairs([float(w) for w in words[1:]] or [1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0, 10.0])
    elif words[0] == "suspensions":
        suspensions(int((words + ["3"])[1]))
    elif words[0] in ("clusters", "groups"):
        {"clusters": clusters, "groups": groups}[words[0]]()
    else:
        equal(int((words + ["2"])[1]))
