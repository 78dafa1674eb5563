#!/usr/bin/env python3
"""Frey's three runs: transport rate beside the measured one, profiles, frey.png.     run.py [--ranks N] [--seconds T] [--length L] [--reuse DIR]

Needs lmp on the PATH (. build/env.sh). --reuse reads results of an earlier run in DIR."""
import argparse
import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
from runs import np, plt  # noqa: E402

D = 0.006
SCALE = np.sqrt(1.5 * 9.81 * D ** 3)
# name: depth [m], layers of beads, measured transport rate [m2/s], from phi and velocity profiles of Frey (2014)
RUNS = {"6": (0.053, 7.08, 1.18e-4), "14": (0.057, 7.37, 2.41e-4), "20": (0.059, 7.30, 3.45e-4)}
# factor on the friction of the side walls, and rules
SETS = {"yade": ("1.0", "yade"), "quarter": ("0.25", "consistent")}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=8)
    parser.add_argument("--length", type=int, default=60)
    parser.add_argument("--reuse")
    options = parser.parse_args()
    figure, axes = plt.subplots(1, 4, figsize=(15, 4.3))
    with tempfile.TemporaryDirectory() as temporary:
        directory = options.reuse or temporary
        for k, (run, (depth, layers, measured)) in enumerate(RUNS.items()):
            axes[0].bar(k - 0.27, measured / SCALE, 0.25, color="0.6", label="measured" if k == 0 else None)
            for which, (choice, (wall, rules)) in enumerate(SETS.items()):
                name = f"{run}.{choice}"
                if not options.reuse:
                    log = f"log.vans_frey.{run}.{options.ranks}" if choice == "yade" else "log.vans_frey.quarter"
                    subprocess.run(["mpirun", "-np", str(options.ranks), "lmp", "-in", os.path.join(HERE, "in.vans_frey"), "-screen", "none",
                                    "-log", os.path.join(HERE, log), "-var", "depth", str(depth), "-var", "layers", str(layers), "-var", "name", name, "-var", "wall", wall,
                                    "-var", "rules", rules, "-var", "seconds", str(options.seconds), "-var", "length", str(options.length)],
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
    figure.savefig(os.path.join(HERE, "frey.png"), dpi=100)


main()
