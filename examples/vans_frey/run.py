#!/usr/bin/env python3
"""Frey's three runs: transport rate beside the measured one, profiles, frey.png.     run.py [--ranks N] [--seconds T] [--length L] [--out DIR] [--reuse DIR] [--update]

Needs lmp on the PATH (. build/env.sh). Ends with a line ok or MISSED for each figure of the README. --reuse reads results of an earlier run in DIR."""
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


def main():
    given, c = options(__file__, __doc__, ranks=1, seconds=8.0, length=60, reuse=""), Checks()
    need("mpirun", "lmp")
    directory = given.reuse or given.out
    figure, axes = plt.subplots(1, 4, figsize=(15, 4.3))
    for k, (run, (depth, layers, measured)) in enumerate(RUNS.items()):
        axes[0].bar(k - 0.27, measured / SCALE, 0.25, color="0.6", label="measured" if k == 0 else None)
        for which, (choice, (wall, rules)) in enumerate(SETS.items()):
            name = f"{run}.{choice}"
            if not given.reuse:
                log = f"log.vans_frey.{run}.{given.ranks}" if choice == "yade" else f"log.vans_frey.{run}.quarter.{given.ranks}"
                subprocess.run(["mpirun", "-np", str(given.ranks), "lmp", "-in", os.path.join(HERE, "in.vans_frey"), "-screen", "none",
                                "-log", log, "-var", "depth", str(depth), "-var", "layers", str(layers), "-var", "name", name, "-var", "wall", wall,
                                "-var", "rules", rules, "-var", "seconds", str(given.seconds), "-var", "length", str(given.length)],
                               cwd=directory, check=True)
            series = np.loadtxt(os.path.join(directory, f"series.{name}"))
            t = series[:, 0] * 4e-5
            late = t >= t[-1] / 2
            q = series[:, 1] / SCALE
            means = [q[(t >= s) & (t < s + 1)].mean() for s in np.arange(int(t[-1] / 2), t[-1] - 0.9)]
            error = np.std(means, ddof=1) / np.sqrt(len(means))
            print(f"run {run}, {choice:8s}: q* = {q[late].mean():.4f} +- {error:.4f} (scatter {q[late].std():.4f}), measured {measured / SCALE:.4f}: "
                  f"ratio {q[late].mean() * SCALE / measured:.2f}; Shields number {series[late, 2].mean():.4f} +- {series[late, 2].std():.4f}, "
                  f"surface {series[late, 5].mean():.3f} m/s")
            c.near(f"run {run}, {choice}: q*", q[late].mean(), *FOUND[name])
            axes[0].bar(k + 0.27 * which, q[late].mean(), 0.25, yerr=error, color=f"C{k}", alpha=(1, 0.5)[which], hatch=(None, "//")[which])
            rows = [line.split() for line in open(os.path.join(directory, f"profiles.{name}")) if not line.startswith("#")]
            profile = np.array([row for row in rows if len(row) == 11][-301:], dtype=float)
            z = profile[:, 1] / D
            style = dict(color=f"C{k}", ls=("-", ":")[which])
            axes[1].plot(profile[:, 3], z, **style)
            solid = profile[:, 3] > 1e-2
            axes[2].plot(profile[solid, 4], z[solid], label=f"run {run}, {choice}", **style)
            axes[3].plot(profile[:-1, 2], z[:-1], **style)
    axes[0].set(xticks=range(3), xticklabels=[f"run {run}" for run in RUNS], ylabel="q*", title="Transport rate (hatched: quarter)")
    axes[1].set(xlabel="phi", ylabel="z/d", title="Volume fraction")
    axes[2].set(xlabel="m/s", title="Velocity of the grains")
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
