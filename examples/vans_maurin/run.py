#!/usr/bin/env python3
"""Run r2d6s2 of Maurin, Chauchat and Frey (2016): transport, stress, surface velocity and profiles beside the published
ones, maurin.png.
    run.py [--ranks N] [--seconds T] [--beds N] [--out DIR] [--reuse DIR] [--update]

The means are those of the second half of the run. --beds: so many beds from other seeds; with two or more the errors
are those between beds, with one those between its seconds. Needs lmp on the PATH (. build/env.sh). Ends with a line ok
or MISSED for each figure of the README. --reuse reads results of an earlier run in DIR."""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
from checks import Checks  # noqa: E402
from runs import need, np, options, plt  # noqa: E402
from vans_runs import D, SCALE, by_second, error, keep, lmp, profiles  # noqa: E402

CELLS = 825
WEIGHT = 1500 * 9.81 * D                        # the stress at a Shields number of 1, Pa
# of all 900 rows of the published profiles
PUBLISHED = {"q*": 3.2524e-3 / SCALE, "Shields number": 41.313 / WEIGHT, "surface, m/s": 2.3505}
# how far a mean over 5 s of one bed may be away from the published value
TOLERANCE = {"q*": 0.15, "Shields number": 0.03, "surface, m/s": 0.10}
ROWS = ("phi", "grains, m/s", "water, m/s", "Reynolds stress, Pa")
RMS = (0.03, 0.06, 0.06, 1.5)


def start(path, published):
    """The file of keyword profile: the published velocity of the water in the middles of the slices."""
    z, u = published[0], published[3]
    middles = (np.arange(CELLS - 1) + 0.5) * 27.5 / (CELLS - 1)
    np.savetxt(path, np.concatenate([[0.0], np.interp(middles, z, u), [u[-1]]]), fmt="%.6g")


def simulate(given, directory, published, bed):
    """One bed: its series (t, q, Shields number, surface) and the profiles of its second half."""
    if not given.reuse:
        start(given.out / f"start.{bed}", published)
        lmp(HERE, given, directory, name=bed, seed=4711 + bed, seconds=given.seconds, start=f"start.{bed}")
    return np.loadtxt(os.path.join(directory, f"series.{bed}"))[:, 1:], profiles(
        os.path.join(directory, f"profiles.{bed}"), 0.5)


def figures(series, profile):
    """Of the second half of one bed: q*, Shields number of the mean stress, velocity on the surface."""
    late = series[series[:, 0] > 0.5 * series[-1, 0]]
    return late[:, 1].mean() / SCALE, profile[:, 10].max() / WEIGHT, late[:, 3].mean()


def columns(profile):
    """z/d and the four published profiles; the stress at the lower edge of its slice, the velocity of grains where
    there are some."""
    z, phi = profile[:, 1] / D, profile[:, 3]
    dz = z[1] - z[0]
    solid = phi > 1e-2
    return (z, phi), (z[solid], profile[solid, 4]), (z[:-1], profile[:-1, 2]), (z - 0.5 * dz, profile[:, 10])


def main():
    given, c = options(__file__, __doc__, ranks=1, seconds=10.0, beds=1, reuse=""), Checks()
    need("mpirun", "lmp")
    published = np.loadtxt(os.path.join(HERE, "published.csv"), delimiter=",", skiprows=4).T
    beds = [simulate(given, given.reuse or given.out, published, bed) for bed in range(given.beds)]
    found = np.array([figures(*bed) for bed in beds])
    series = beds[0][0]
    seconds = [by_second(series[:, 0], series[:, k], 0.5 * series[-1, 0]) for k in (1, 2, 3)]
    for k, (what, wanted) in enumerate(PUBLISHED.items()):
        spread = error(found[:, k]) if len(beds) > 1 else error(seconds[k] / (SCALE if k == 0 else 1))
        print(f"{what:15s} {found[:, k].mean():.4f} +- {spread:.4f}, published {wanted:.4f}: "
              f"{100 * (found[:, k].mean() / wanted - 1):+.1f} %")
        c.near(what, found[:, k].mean(), wanted, TOLERANCE[what])

    figure, axes = plt.subplots(1, 4, figsize=(15, 4.6), sharey=True)
    for k, what in enumerate(ROWS):
        axes[k].plot(published[k + 1], published[0], color="0.1", lw=2.5, alpha=0.5, label="Maurin et al. 2016")
        for _, profile in beds:
            axes[k].plot(*columns(profile)[k][::-1], color="C0", lw=0.8)
        axes[k].plot([], [], color="C0", lw=0.8, label=f"fix hydro/vans, {len(beds)} bed" + "s" * (len(beds) > 1))
        z, values = columns(np.mean([profile for _, profile in beds], axis=0))[k]
        inside = (published[0] > z[0]) & (published[0] < z[-1])
        distance = np.sqrt(((np.interp(published[0][inside], z, values) - published[k + 1][inside]) ** 2).mean())
        c.below(f"rms distance from the published {what}", distance, RMS[k])
        axes[k].set(xlabel=what)
        axes[k].grid(alpha=0.3)
    axes[0].set(ylabel="z/d", ylim=(0, 27.5))
    axes[0].legend(frameon=False)
    figure.tight_layout()
    figure.savefig(given.out / "maurin.png", dpi=100)
    np.savetxt(given.out / "beds.csv", found, fmt="%.4f", delimiter=",", header=",".join(PUBLISHED).replace(", ", " "),
               comments="")
    keep(HERE, given, "maurin.png", "beds.csv")
    return c.finish()


sys.exit(main())
