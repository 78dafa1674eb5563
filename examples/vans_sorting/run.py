#!/usr/bin/env python3
"""Grains of 4 to 8 mm, mixed, under a stream: the large ones rise, sorting.png.

    run.py [--seconds T] [--ranks N] [--out DIR] [--reuse DIR] [--quick] [--update]

Needs lmp on the PATH (. build/env.sh). Ends with a line ok or MISSED for each figure of the README. Results of an
earlier run in DIR are read instead with --reuse."""
import os
import pathlib
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
from checks import Checks  # noqa: E402
from runs import dumped, need, np, options, plt  # noqa: E402
from matplotlib.collections import EllipseCollection  # noqa: E402
from vans_runs import D, keep, lmp  # noqa: E402

BINS = 6        # of the loose grains; one more is that of the fixed ones
DT = 2.5e-5


def blocks(path):
    """Of a file of fix ave/time mode vector: its steps and its blocks [steps, slices, columns]."""
    rows = [np.array(line.split(), float) for line in open(path) if not line.startswith("#")]
    steps = [row[0] for row in rows if len(row) == 2]
    return np.array(steps), np.array([row for row in rows if len(row) > 2]).reshape(len(steps), -1, len(rows[1]))


def side(axes, grains):
    """The loose grains from the side, coloured by their size, those in front last."""
    x, z, r = grains[np.argsort(-grains[:, 2])][:, (1, 3, 4)].T
    axes.add_collection(EllipseCollection(2 * r, 2 * r, 0, units="xy", offsets=np.column_stack([x, z]),
                                          transOffset=axes.transData, array=2000 * r, cmap="viridis_r", clim=(4, 8),
                                          edgecolors="k", linewidths=0.3))
    axes.set(xlim=(0, 0.06), ylim=(-0.006, 0.066), xticks=[], yticks=[], aspect="equal")


def main():
    given, c = options(__file__, __doc__, ranks=1, seconds=24.0, reuse="", quick=False), Checks()
    need("mpirun", "lmp")
    seconds = 3.5 if given.quick else given.seconds
    directory = pathlib.Path(given.reuse or given.out)
    if not given.reuse:
        lmp(HERE, given, directory, f"log.vans_sorting.{given.ranks}", seconds=seconds)

    series = np.loadtxt(directory / "bins.txt")
    t, numbers = series[:, 0] * DT, series[:, 1:].reshape(len(series), BINS + 1, 3)[:, :BINS]
    size, height, carried = 2000 * numbers[0, :, 0], numbers[:, :, 1] / D, numbers[:, :, 2]
    steps, profiles = blocks(directory / "profiles.txt")
    z, phi = profiles[0, :, 1] / D, profiles[:, :, 11::5][:, :, :BINS]
    late = t > 0.85 * t[-1]
    first, last = height[:2].mean(0), height[late].mean(0)
    print("  size, mm            " + "  ".join("%6.2f" % s for s in size))
    print("  height at first, d  " + "  ".join("%6.2f" % h for h in first))
    print("  height at last, d   " + "  ".join("%6.2f" % h for h in last))
    # the surface layer: the highest loose grains, half a layer of 6 mm
    at_end = phi[-1]
    above = np.cumsum((at_end.sum(1) * np.gradient(z))[::-1])[::-1]
    top = (above < 0.5) & (at_end.sum(1) > 1e-3)
    mean_size = {name: (part * size).sum() / part.sum() for name, part in (("all", at_end), ("surface", at_end[top]))}
    print("  mean size at the surface %.2f mm, of all grains %.2f mm" % (mean_size["surface"], mean_size["all"]))
    rise = last - first
    slope, offset = np.polyfit(size, rise, 1)
    print("  rise %.2f d for every mm of size" % slope)
    speed = carried[late].mean(0) / (phi[-1] * np.gradient(z)[:, None]).sum(0) / D
    print("  mean speed, m/s     " + "  ".join("%6.3f" % v for v in speed))

    c.near("loose grains in the bins at the end over those at the beginning", phi[-1].sum() / phi[0].sum(), 1.0, 1e-3)
    c.below("mixed at first: height of a bin over the mean, largest, d", np.abs(first - first.mean()).max(), 0.5)
    c.holds("the largest grains rise and the smallest sink", rise[-1] > 0.1 and rise[0] < -0.3)
    c.within("largest over smallest, d", rise[-1] - rise[0], *((0.4, 2.5) if given.quick else (2.2, 4.2)))
    c.holds("the largest grains travel faster than the smallest", speed[-1] > 1.5 * speed[0])
    if not given.quick:
        c.holds("every bin ends above all smaller ones", np.all(np.diff(last) > 0))
        c.within("correlation of rise and size", np.corrcoef(size, rise)[0, 1], 0.95, 1.0)
        c.within("armour: mean size of the surface over that of all", mean_size["surface"] / mean_size["all"], 1.08,
                 1.25)

    figure, axes = plt.subplots(1, 4, figsize=(15, 4.4), gridspec_kw={"width_ratios": (1.1, 1.1, 1, 1.3)})
    frames = list(dumped(directory / "grains.dump"))
    for ax, (step, grains) in zip(axes[:2], (frames[0], frames[-1])):
        side(ax, grains)
        ax.set_title("t = %.0f s" % (step * DT))
    colours = plt.get_cmap("viridis_r")((size - 4) / 4)
    for k in range(BINS):
        axes[2].plot(phi[-1][:, k], z, color=colours[k], label="%.1f mm" % size[k])
        axes[2].plot(phi[0][:, k], z, color=colours[k], ls=":", lw=1)
        axes[3].plot(t, height[:, k], color=colours[k], label="%.1f mm" % size[k])
    axes[2].set(xlabel="phi of each bin (dotted: at first)", ylabel="z/d", ylim=(-0.5, 8))
    axes[3].set(xlabel="t [s]", ylabel="mean height/d", xscale="log")
    axes[3].legend(frameon=False, fontsize=8)
    for ax in axes[2:]:
        ax.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(given.out / "sorting.png", dpi=100)
    keep(HERE, given, "sorting.png", f"log.vans_sorting.{given.ranks}")
    return c.finish()


sys.exit(main())
