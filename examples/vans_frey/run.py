#!/usr/bin/env python3
"""Frey's three runs: transport rate and profiles beside the measured ones, frey.png.
    run.py [--ranks N] [--seconds T] [--length L] [--beds N] [--deeper MM] [--wall F] [--felt centre|volume] [--out DIR]
    [--reuse DIR] [--update]

--beds: so many beds of each run, from other seeds; with two or more the errors are those between beds, with one those
between its seconds. --deeper: so many mm more water, --wall: this factor on the friction of the walls, both under the
consistent rules, and then only what comes out. Needs lmp on the PATH (. build/env.sh). Ends with a line ok or MISSED
for each figure of the README. --reuse reads results of an earlier run in DIR."""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
from checks import Checks  # noqa: E402
from runs import need, np, options, plt  # noqa: E402
from vans_runs import D, SCALE, by_second, error, keep, lmp, profiles  # noqa: E402

# name: depth [m], layers of beads, measured transport rate [m2/s], from phi and velocity profiles of Frey (2014)
RUNS = {"6": (0.053, 7.08, 1.18e-4), "14": (0.057, 7.37, 2.41e-4), "20": (0.059, 7.30, 3.45e-4)}
RULES = ("yade", "consistent")
# q* over five beds, in the README, and how far a mean over 4 s of one of them may be away
FOUND = {("6", "yade"): (0.09, 0.06), ("14", "yade"): (0.13, 0.07), ("20", "yade"): (0.19, 0.09),
         ("6", "consistent"): (0.0, 0.02), ("14", "consistent"): (0.015, 0.04), ("20", "consistent"): (0.05, 0.05)}


def measured_profiles():
    """By run: z/d, phi, v."""
    rows = [line.split(",") for line in open(os.path.join(HERE, "measured.csv")) if line[0].isdigit()]
    return {run: np.array([row[1:] for row in rows if row[0] == run], dtype=float).T for run in RUNS}


def simulate(given, directory, run, rules, bed):
    """One bed: its series and the profiles of its second half."""
    depth, layers, _ = RUNS[run]
    deeper, wall, felt = (given.deeper, given.wall, given.felt) if rules == "consistent" else (0, 1, "centre")
    name = f"{run}.{rules}" + f".deeper{deeper:g}" * (deeper != 0) + f".wall{wall:g}" * (wall != 1) + f".{bed}"
    if not given.reuse:
        lmp(HERE, given, directory, depth=depth + 1e-3 * deeper, layers=layers, name=name, rules=rules, wall=wall,
            felt=felt, seconds=given.seconds, length=given.length, seed=4711 + bed)
    return np.loadtxt(os.path.join(directory, f"series.{name}")), profiles(os.path.join(directory, f"profiles.{name}"),
                                                                           0.5)


def second_half(series):
    return series[series[:, 0] >= series[-1, 0] / 2]


def mean_and_error(all_series, column):
    """Over beds, or over the seconds of the only one; of the second half of the runs."""
    late = [second_half(series) for series in all_series]
    means = [rows[:, column].mean() for rows in late]
    t = late[0][:, 0] * 4e-5
    return np.mean(means), error(means if len(means) > 1 else by_second(t, late[0][:, column], t[0]))


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
    given, c = options(__file__, __doc__, ranks=1, seconds=8.0, length=60, beds=1, deeper=0.0, wall=1.0, felt="centre",
                       reuse=""), Checks()
    need("mpirun", "lmp")
    directory, points = given.reuse or given.out, measured_profiles()
    as_it_is = given.deeper == 0 and given.wall == 1
    table = ["run,rules,bed,q*,Shields number,surface m/s"]
    figure, axes = plt.subplots(1, 4, figsize=(15, 4.3))
    for k, (run, (_, _, measured)) in enumerate(RUNS.items()):
        axes[0].bar(k - 0.27, measured / SCALE, 0.25, color="0.6", label="measured" if k == 0 else None)
        axes[1].plot(points[run][1], points[run][0], "o", ms=2, color=f"C{k}")
        axes[2].plot(points[run][2], points[run][0], "o", ms=2, color=f"C{k}")
        for which, rules in enumerate(RULES):
            beds = [simulate(given, directory, run, rules, bed) for bed in range(given.beds)]
            all_series, profile = [series for series, _ in beds], np.mean([rows for _, rows in beds], axis=0)
            table += [
                f"{run},{rules},{bed},{rows[:, 1].mean() / SCALE:.4f},{rows[:, 2].mean():.4f},{rows[:, 5].mean():.4f}"
                      for bed, rows in enumerate(map(second_half, all_series))]
            q, spread = (value / SCALE for value in mean_and_error(all_series, 1))
            shields, surface = mean_and_error(all_series, 2)[0], mean_and_error(all_series, 5)[0]
            d_phi, d_v, shift = distance(profile, points[run])
            print(f"run {run}, {rules:10s}: q* = {q:.4f} +- {spread:.4f}, measured {measured / SCALE:.4f}: "
                  f"ratio {q * SCALE / measured:.2f}; Shields number {shields:.4f}, surface {surface:.3f} m/s; "
                  f"rms from the measured phi {d_phi:.3f}, v {d_v:.3f} m/s, bed shifted by {shift:.2f} d")
            if rules == "yade" or as_it_is:
                c.near(f"run {run}, {rules}: q*", q, *FOUND[run, rules])
            c.below(f"run {run}, {rules}: rms distance from the measured phi", d_phi, 0.08)
            axes[0].bar(k + 0.27 * which, q, 0.25, yerr=spread, color=f"C{k}", alpha=(1, 0.5)[which],
                        hatch=(None, "//")[which])
            z = profile[:, 1] / D + shift
            style = dict(color=f"C{k}", ls=("-", ":")[which])
            axes[1].plot(profile[:, 3], z, **style)
            solid = profile[:, 3] > 1e-2
            axes[2].plot(profile[solid, 4], z[solid], label=f"run {run}, {rules}", **style)
            axes[3].plot(profile[:-1, 2], z[:-1], **style)
    axes[0].set(xticks=range(3), xticklabels=[f"run {run}" for run in RUNS], ylabel="q*",
                title="Transport rate (hatched: consistent)")
    axes[1].set(xlabel="phi", ylabel="z/d", title="Volume fraction (dots: measured)")
    axes[2].set(xlabel="m/s", title="Velocity of the grains (dots: measured)")
    axes[3].set(xlabel="m/s", title="Velocity of the water")
    axes[0].legend(frameon=False)
    axes[2].legend(frameon=False, fontsize=7)
    for ax in axes:
        ax.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(given.out / "frey.png", dpi=100)
    (given.out / "beds.csv").write_text("\n".join(table) + "\n")
    keep(HERE, given, "frey.png", "beds.csv")
    return c.finish()


sys.exit(main())
