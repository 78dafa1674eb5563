#!/usr/bin/env python3
"""Frey's three runs: transport rate and profiles beside the measured ones, frey.png.
    run.py [--ranks N] [--seconds T] [--length L] [--beds N] [--felt centre|volume] [--out DIR] [--reuse DIR] [--update]

--beds: so many beds of each run, from other seeds; with two or more the errors are those between beds, with one those between its seconds. Needs lmp on the PATH (. build/env.sh). Ends with a line ok or MISSED for each figure of the README. --reuse reads results of an earlier run in DIR."""
import os
import shutil
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
from checks import Checks  # noqa: E402
from runs import need, np, options, plt  # noqa: E402

D = 0.006
SCALE = np.sqrt(1.5 * 9.81 * D ** 3)
# name: depth [m], layers of beads, measured transport rate [m2/s], from phi and velocity profiles of Frey (2014)
RUNS = {"6": (0.053, 7.08, 1.18e-4), "14": (0.057, 7.37, 2.41e-4), "20": (0.059, 7.30, 3.45e-4)}
# factor on the friction of the side walls, and rules
# q* over several beds, in the README, and how far a mean over 4 s of one of them may be away
FOUND = {"6.yade": (0.07, 0.05), "14.yade": (0.13, 0.05), "20.yade": (0.20, 0.07),
         "6.quarter": (0.03, 0.05), "14.quarter": (0.11, 0.05), "20.quarter": (0.16, 0.05)}
SETS = {"yade": ("1.0", "yade"), "quarter": ("0.25", "consistent")}


def keep(given, *names):
    """--update: what belongs beside this file."""
    for name in names if given.update else ():
        shutil.copy(given.out / name, HERE)


def measured_profiles():
    """By run: z/d, phi, v."""
    rows = [line.split(",") for line in open(os.path.join(HERE, "measured.csv")) if line[0].isdigit()]
    return {run: np.array([row[1:] for row in rows if row[0] == run], dtype=float).T for run in RUNS}


def simulate(given, directory, run, choice, bed):
    """One bed: its series and the profiles of its second half."""
    depth, layers, _ = RUNS[run]
    wall, rules = SETS[choice]
    name = f"{run}.{choice}" + (f".{bed}" if bed else "")
    if not given.reuse:
        log = "none" if bed else f"log.vans_frey.{run}." + ("" if choice == "yade" else "quarter.") + str(given.ranks)
        settings = dict(depth=depth, layers=layers, name=name, wall=wall, rules=rules, seconds=given.seconds, length=given.length, seed=4711 + bed,
                        felt=given.felt if rules == "consistent" else "centre")
        subprocess.run(["mpirun", "-np", str(given.ranks), "lmp", "-in", os.path.join(HERE, "in.vans_frey"), "-screen", "none", "-log", log]
                       + [word for key, value in settings.items() for word in ("-var", key, str(value))], cwd=directory, check=True)
    rows = [line.split() for line in open(os.path.join(directory, f"profiles.{name}")) if not line.startswith("#")]
    return np.loadtxt(os.path.join(directory, f"series.{name}")), np.array([row for row in rows if len(row) == 11][-301:], dtype=float)


def second_half(series):
    return series[series[:, 0] >= series[-1, 0] / 2]


def mean_and_error(all_series, column):
    """Over beds, or over the seconds of the only one."""
    late = [second_half(series) for series in all_series]
    means = [rows[:, column].mean() for rows in late]
    if len(means) == 1:
        t = late[0][:, 0] * 4e-5
        means = [late[0][(t >= s) & (t < s + 1), column].mean() for s in np.arange(int(t[0]), t[-1] - 0.9)]
    return np.mean([rows[:, column].mean() for rows in late]), np.std(means, ddof=1) / np.sqrt(len(means)) if len(means) > 1 else np.nan


def distance(profile, points):
    """rms of phi and of v, from the measured points, and the shift of the bed in d that brings phi closest."""
    z, phi, v = points
    height, solid = profile[:, 1] / D, profile[:, 3] > 1e-2
    found = []
    for shift in np.arange(-1, 1.001, 0.02):
        d_phi = np.interp(z, height + shift, profile[:, 3]) - phi
        d_v = np.interp(z, height[solid] + shift, profile[solid, 4]) - v
        found.append((np.sqrt((d_phi ** 2).mean()), np.sqrt((d_v ** 2).mean()), shift))
    return min(found)


def main():
    given, c = options(__file__, __doc__, ranks=1, seconds=8.0, length=60, beds=1, felt="centre", reuse=""), Checks()
    need("mpirun", "lmp")
    directory, points = given.reuse or given.out, measured_profiles()
    figure, axes = plt.subplots(1, 4, figsize=(15, 4.3))
    for k, (run, (_, _, measured)) in enumerate(RUNS.items()):
        axes[0].bar(k - 0.27, measured / SCALE, 0.25, color="0.6", label="measured" if k == 0 else None)
        axes[1].plot(points[run][1], points[run][0], "o", ms=2, color=f"C{k}")
        axes[2].plot(points[run][2], points[run][0], "o", ms=2, color=f"C{k}")
        for which, choice in enumerate(SETS):
            beds = [simulate(given, directory, run, choice, bed) for bed in range(given.beds)]
            all_series, profile = [series for series, _ in beds], np.mean([rows for _, rows in beds], axis=0)
            q, error = (value / SCALE for value in mean_and_error(all_series, 1))
            shields, surface = mean_and_error(all_series, 2)[0], mean_and_error(all_series, 5)[0]
            d_phi, d_v, shift = distance(profile, points[run])
            print(f"run {run}, {choice:8s}: q* = {q:.4f} +- {error:.4f}, measured {measured / SCALE:.4f}: ratio {q * SCALE / measured:.2f}; "
                  f"Shields number {shields:.4f}, surface {surface:.3f} m/s; rms from the measured phi {d_phi:.3f}, v {d_v:.3f} m/s, bed shifted by {shift:.2f} d")
            c.near(f"run {run}, {choice}: q*", q, *FOUND[f"{run}.{choice}"])
            c.below(f"run {run}, {choice}: rms distance from the measured phi", d_phi, 0.08)
            axes[0].bar(k + 0.27 * which, q, 0.25, yerr=error, color=f"C{k}", alpha=(1, 0.5)[which], hatch=(None, "//")[which])
            z = profile[:, 1] / D + shift
            style = dict(color=f"C{k}", ls=("-", ":")[which])
            axes[1].plot(profile[:, 3], z, **style)
            solid = profile[:, 3] > 1e-2
            axes[2].plot(profile[solid, 4], z[solid], label=f"run {run}, {choice}", **style)
            axes[3].plot(profile[:-1, 2], z[:-1], **style)
    axes[0].set(xticks=range(3), xticklabels=[f"run {run}" for run in RUNS], ylabel="q*", title="Transport rate (hatched: quarter)")
    axes[1].set(xlabel="phi", ylabel="z/d", title="Volume fraction (dots: measured)")
    axes[2].set(xlabel="m/s", title="Velocity of the grains (dots: measured)")
    axes[3].set(xlabel="m/s", title="Velocity of the water")
    axes[0].legend(frameon=False)
    axes[2].legend(frameon=False, fontsize=7)
    for ax in axes:
        ax.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(given.out / "frey.png", dpi=100)
    keep(given, "frey.png", f"log.vans_frey.20.quarter.{given.ranks}", f"log.vans_frey.6.{given.ranks}")
    return c.finish()


sys.exit(main())
