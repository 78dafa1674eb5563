#!/usr/bin/env python3
"""Two-way bedload at two slopes: runs, time means with their scatter, bedload.png.

    run.py [--ranks N] [--seconds T] [--out DIR] [--reuse DIR] [--update]

Needs lmp on the PATH (. build/env.sh). Ends with a line ok or MISSED for each figure of the README. Results of an
earlier run in DIR are read instead with --reuse."""
import os
import pathlib
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
from checks import Checks  # noqa: E402
import film  # noqa: E402
from runs import dumped, need, np, options, plt  # noqa: E402
from matplotlib.collections import EllipseCollection  # noqa: E402
from vans_runs import D, SCALE, by_second, error, keep, lmp, profiles  # noqa: E402

# slope, depth over d, beginning of the mean, what Yade gave for a bed made the same way (mean and its error, from
# blocks of 1 s)
CASES = {"a": (0.05, 10, 8, (0.579, 0.007), (0.2578, 0.0010), (1.666, 0.002)),
         "b": (0.08, 9, 7, (1.563, 0.026), (0.3426, 0.0025), (1.862, 0.003))}

# the README's means, of the second slope over five beds, and how far two runs of this length may be apart: there three
# times the scatter between beds
FOUND = {"a": {"q*": 0.577, "Shields number": 0.2557, "surface velocity [m/s]": 1.661},
         "b": {"q*": 1.511, "Shields number": 0.3412, "surface velocity [m/s]": 1.847}}
TOLERANCE = {"a": {"q*": 0.06, "Shields number": 0.006, "surface velocity [m/s]": 0.015},
             "b": {"q*": 0.18, "Shields number": 0.009, "surface velocity [m/s]": 0.035}}


def blocks(t, values, begin):
    """Mean, standard deviation in time, and error of the mean from blocks of 1 s."""
    late = values[t >= begin]
    return late.mean(), late.std(), error(by_second(t, values, begin))


def frame(grains, profile, time):
    """One picture of the film: grains from the side, coloured by their speed, those in front last; beside them the mean
    speed of the water"""
    figure, (side, beside) = plt.subplots(1, 2, figsize=(5.2, 4.9), dpi=80, sharey=True,
                                          gridspec_kw={"width_ratios": (1.7, 1)})
    figure.subplots_adjust(0.01, 0.11, 0.99, 0.93, wspace=0.04)
    grains = np.concatenate([grains + np.array((0, image * 10 * D, 0, 0, 0, 0)) for image in (-1, 0, 1)])
    order = np.argsort(-grains[:, 2])
    x, z, r, v = grains[order][:, (1, 3, 4, 5)].T
    side.add_collection(EllipseCollection(2 * r, 2 * r, 0, units="xy", offsets=np.column_stack([x, z]),
                                          transOffset=side.transData, array=v, cmap="turbo", clim=(0, 1.2),
                                          edgecolors="k", linewidths=0.3))
    side.set(xlim=(0, 0.06), ylim=(-0.005, 0.085), xticks=[], yticks=[], aspect="equal", title="grains, by their speed")
    side.title.set_fontsize(10)
    beside.plot(profile[:, 2], profile[:, 1], color="tab:blue")
    beside.set(xlabel="water, m/s", xlim=(0, 2.1), xticks=[0, 1, 2])
    beside.text(0.1, 0.08, "t = %.2f s" % time, fontsize=9)
    return film.picture(figure)


def main():
    given, c = options(__file__, __doc__, ranks=1, seconds=16.0, reuse=""), Checks()
    need("mpirun", "lmp")
    directory = given.reuse or given.out
    figure, axes = plt.subplots(1, 4, figsize=(15, 4.3))
    for k, (name, (slope, depth, begin, *yade)) in enumerate(CASES.items()):
        if not given.reuse:
            print(f"slope {slope}: {given.seconds:g} s of bedload", flush=True)
            lmp(HERE, given, directory, f"log.vans_bedload.{name}.{given.ranks}", slope=slope, depth=depth,
                seconds=given.seconds, name=name)
        series = np.loadtxt(os.path.join(directory, f"series.{name}"))
        t = series[:, 0] * 4e-5
        begin = min(begin, t[-1] / 2)
        for what, column, factor, peer in (("q*", 1, 1 / SCALE, yade[0]), ("Shields number", 2, 1, yade[1]),
                                           ("surface velocity [m/s]", 4, 1, yade[2])):
            mean, scatter, spread = blocks(t, series[:, column] * factor, begin)
            print(f"  slope {slope}: {what:24s} {mean:.4f} +- {spread:.4f} (scatter in time {scatter:.4f});  Yade "
                  f"{peer[0]} +- {peer[1]}")
            c.near(f"slope {slope}: {what}", mean, FOUND[name][what], TOLERANCE[name][what])
        axes[0].plot(t, series[:, 1] / SCALE, lw=0.6, color=f"C{k}", alpha=0.8, label=f"slope {slope}")
        axes[0].axhline(yade[0][0], color=f"C{k}", ls="--", lw=1)
        profile = profiles(os.path.join(directory, f"profiles.{name}"), 0.5)
        z = profile[:, 1] / D
        axes[1].plot(profile[:, 3], z, color=f"C{k}")
        axes[2].plot(profile[:-1, 2], z[:-1], color=f"C{k}", label=f"water, {slope}")
        solid = profile[:, 3] > 1e-2
        axes[2].plot(profile[solid, 4], z[solid], "--", color=f"C{k}", label=f"grains, {slope}")
        axes[3].plot(profile[:-1, 10], z[:-1] - 0.5 * (z[1] - z[0]), color=f"C{k}")
    axes[0].set(xlabel="t [s]", ylabel="q*", title="Transport rate (dashed: Yade's mean)")
    axes[1].set(xlabel="phi", ylabel="z/d", title="Volume fraction")
    axes[2].set(xlabel="velocity [m/s]", title="Velocities")
    axes[3].set(xlabel="Reynolds stress [Pa]", title="Stress in the water")
    axes[0].legend(frameon=False, loc="upper left")
    axes[2].legend(frameon=False, fontsize=8)
    for ax in axes:
        ax.grid(alpha=0.3)
    axes[0].set_ylim(0, 2.6)
    figure.tight_layout()
    figure.savefig(given.out / "bedload.png", dpi=100)
    shots = list(dumped(pathlib.Path(directory) / "film.b"))
    film.write([frame(grains, profile, step * 4e-5) for step, grains in shots], given.out / "bedload.gif", colours=24)
    c.below("size of the film, MB", (given.out / "bedload.gif").stat().st_size / 1e6, 2.0)
    keep(HERE, given, "bedload.png", "bedload.gif", *(f"log.vans_bedload.{name}.{given.ranks}" for name in CASES))
    return c.finish()


sys.exit(main())
