#!/usr/bin/env python3
"""Runs dam_break_3d; heights and pressures against the experiment. After: . build/env.sh

    run.py [--quick] [--update] [N ...]      N: particles over the depth, 10 if none is given; --quick: the first 0.7 s
"""
import os
import resource
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402

c, plt = S.Checks(), S.pyplot()
sizes = [int(word) for word in sys.argv[1:] if word.isdigit()] or [10]
TIME = 0.7 if S.QUICK else 6
with open(os.path.join(folder, "..", "..", "unittest", "data", "sph", "spheric_2_experiment.csv")) as f:
    lines = [line.split(",") for line in f.read().split("\n") if line and not line.startswith("#")]
measured = dict(zip(lines[0], np.array(lines[1:], float).T))
GAUGES = {kind + k: "c_%s[%s]" % (kind, k) for kind in "HP" for k in "1234"}


def first(t, value, limit):
    """When a curve passes a limit, between its samples."""
    k = np.nonzero(value > limit)[0][0]
    return t[k - 1] + (t[k] - t[k - 1]) * (limit - value[k - 1]) / (value[k] - value[k - 1])


def mean(t, value, begin, end):
    fine = np.linspace(begin, end, 2001)
    return np.interp(fine, t, value).mean()


def processor():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def rms(name, run):
    """Of a height, over the deepest that was measured, in all the time that was run."""
    t = measured["t"][(measured["t"] < TIME) & (measured["t"] < run["Time"][-1])]
    return np.sqrt(np.mean((np.interp(t, run["Time"], run[GAUGES[name]]) - measured[name][:len(t)]) ** 2)) / measured[name].max()


figure, axes = plt.subplots(2, 2, figsize=(10, 6))
for axis, name in zip(axes.T.flat, ("H2", "H4", "P1", "P3")):
    keep = measured["t"] <= TIME
    axis.plot(measured["t"][keep], measured[name][keep], "k", lw=1, label="experiment")
    axis.set(title=name, xlabel="time (s)", ylabel="height (m)" if name[0] == "H" else "pressure (Pa)")
table = "| particles over the depth | arrival at the box, s | P1, mean of 0.3 s from there, Pa | H2, H4, rms difference over the largest | processor, min |\n" \
        "|---|---|---|---|---|\n"
at_box = first(measured["t"], measured["P1"], 500)
impulse = mean(measured["t"], measured["P1"], at_box, at_box + 0.3)
table += "| experiment | %.3f | %.0f | | |\n" % (at_box, impulse)
for n in sizes:
    before = processor()
    out, run = S.lmp(folder, "dam_break_3d", str(n), n=n, time=TIME)
    t = run["Time"]
    arrival = first(t, run["c_P[1]"], 500)
    load = mean(t, run["c_P[1]"], arrival, arrival + 0.3)
    heights = [rms(name, run) for name in ("H2", "H4")]
    table += "| %d | %.3f | %.0f | %.3f, %.3f | %.0f |\n" % (n, arrival, load, *heights, (processor() - before) / 60)
    c.near("%d over the depth: arrival at the box, s" % n, arrival, at_box, 0.13 * at_box)
    c.near("%d over the depth: mean of P1 in 0.3 s from there, over the measured one" % n, load / impulse, 1, 0.25)
    c.below("%d over the depth: H4, rms difference over the largest" % n, heights[1], 0.08)
    for axis, name in zip(axes.T.flat, ("H2", "H4", "P1", "P3")):
        axis.plot(t, run[GAUGES[name]], label="%d particles over the depth" % n)
for axis in axes[:, 1]:
    axis.set(ylim=(-1000, 12000))
axes[0, 0].legend()
figure.tight_layout()
figure.savefig(os.path.join(out, "dam_break_3d.png"), bbox_inches="tight")
S.keep(folder, out, "dam_break_3d.png", table)
sys.exit(c.finish())
