#!/usr/bin/env python3
"""Runs dam_break_3d; heights and pressures against the experiment. After: . build/env.sh

    run.py [--quick] [--reuse] [--update] [N ...]

N: particles over the depth, 10 if none is given. Up to 10 the run has 6 s, finer ones 0.72 s, which is the impact; --quick: 0.72 s for
all. --reuse: takes the logs of earlier runs in build/examples/dam_break_3d where there are some, also of one that is not finished.
"""
import os
import re
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np, TOP  # noqa: E402

c, plt = S.Checks(), S.pyplot()
sizes = [int(word) for word in sys.argv[1:] if word.isdigit()] or [10]
IMPACT, WINDOW = 0.72, 0.3
# Largest errors: of a coarse run, and from 30 particles over the depth on
COARSE, FINE = {"arrival": 0.04, "load": 0.35, "H2": 0.06, "H4": 0.03}, {"arrival": 0.03, "load": 0.15, "H2": 0.05, "H4": 0.05}
OUT = os.path.join(TOP, "build", "examples", "dam_break_3d")


def measurement(name):
    with open(os.path.join(TOP, "unittest", "data", "sph", name)) as f:
        lines = [line.split(",") for line in f.read().split("\n") if line and not line.startswith("#")]
    return dict(zip(lines[0], np.array(lines[1:], float).T))


slow, fast = measurement("spheric_2_experiment.csv"), measurement("spheric_2_impact.csv")


def run(n):
    """Thermo table, processor's minutes."""
    path = os.path.join(OUT, "log.dam_break_3d.%d" % n)
    if not ("--reuse" in sys.argv and os.path.exists(path)):
        S.lmp(folder, "dam_break_3d", str(n), n=n, time=IMPACT if S.QUICK or n > 10 else 6)
    text, table = open(path).read(), S.thermo(path)
    found = [re.findall(word, text) for word in (r"Loop time of ([\d.]+)", r"([\d.]+)% CPU use")]
    minutes = float(found[0][-1]) * float(found[1][-1]) / 6000 if all(found) else float("nan")
    names = {"c_%s[%s]" % (kind, k): kind + k for kind in "HP" for k in "1234"}
    return dict({"t": table["Time"]}, **{names[name]: table[name] for name in names}), minutes


def first(t, value, limit):
    """When a curve passes a limit, between its samples."""
    k = np.nonzero(value > limit)[0][0]
    return t[k - 1] + (t[k] - t[k - 1]) * (limit - value[k - 1]) / (value[k] - value[k - 1])


def arrival(curves):
    """When P1 passes 500 Pa."""
    return first(curves["t"], curves["P1"], 500)


def loads(curves, begin, end):
    """Means of P1 to P4 between two times after the arrival."""
    fine = arrival(curves) + np.linspace(begin, end, 3001)
    return np.array([np.interp(fine, curves["t"], curves["P" + k]).mean() for k in "1234"])


def rms(name, curves, end):
    """Difference of a height over the largest that was measured, up to a time."""
    t = slow["t"][slow["t"] <= min(end, curves["t"][-1])]
    return np.sqrt(np.mean((np.interp(t, curves["t"], curves[name]) - slow[name][:len(t)]) ** 2)) / slow[name].max()


table = "| particles over the depth | arrival at the box | P1 | P2 | P3 | P4 | mean of the four | H2, H4 to 0.72 s | H2, H4 to 6 s | processor, min |\n" \
        "|---|---|---|---|---|---|---|---|---|---|\n"
at_box, measured = arrival(fast), loads(fast, 0, WINDOW)
table += "| experiment | %.3f s | %.0f Pa | %.0f Pa | %.0f Pa | %.0f Pa | %.0f Pa | | | |\n" % (at_box, *measured, measured.mean())
figure, axes = plt.subplots(2, 3, figsize=(12, 6))
for axis, name in zip(axes.flat, ("H2", "P1", "P2", "H4", "P3", "P4")):
    curves = slow if name[0] == "H" else fast
    axis.plot(curves["t"], curves[name], "k", lw=1, label="experiment")
    axis.set(title=name, xlabel="time (s)", ylabel="height (m)" if name[0] == "H" else "pressure (kPa)")
    if name[0] == "P":
        axis.lines[0].set_ydata(curves[name] / 1000)
        axis.set(xlim=(0.36, IMPACT), ylim=(-6, 16))
for n in sizes:
    curves, minutes = run(n)
    end = min(WINDOW, curves["t"][-1] - arrival(curves))
    load, known = loads(curves, 0, end), loads(fast, 0, end)
    off = (arrival(curves) / at_box - 1, *(load / known - 1), load.mean() / known.mean() - 1)
    if end > 0.1:
        print("[dam_break_3d] P1 over the measured one, from 0 to 0.08 s after the arrival: %.2f, from there to %.2f s: %.2f" % (
            loads(curves, 0, 0.08)[0] / loads(fast, 0, 0.08)[0], end, loads(curves, 0.08, end)[0] / loads(fast, 0.08, end)[0]))
    heights = {name: rms(name, curves, IMPACT) for name in ("H2", "H4")}
    whole = "%.3f, %.3f" % tuple(rms(name, curves, 6) for name in heights) if curves["t"][-1] > 5.9 else ""
    table += "| %d | %s | %.3f, %.3f | %s | %s |\n" % (n, " | ".join("%+.1f %%" % (100 * x) if k == 0 else "%+.0f %%" % (100 * x) for k, x in enumerate(off)),
                                                      heights["H2"], heights["H4"], whole, "%.0f" % minutes if minutes > 0 else "")
    limits = FINE if n >= 30 else COARSE
    c.below("%d over the depth: arrival at the box, off by" % n, abs(off[0]), limits["arrival"])
    c.below("%d over the depth: mean of P1 in %.2f s from there, off by" % (n, end), abs(off[1]), limits["load"])
    for name, value in heights.items():
        c.below("%d over the depth: %s in the first 0.72 s, rms difference over the largest" % (n, name), value, limits[name])
    for axis, name in zip(axes.flat, ("H2", "P1", "P2", "H4", "P3", "P4")):
        # pressures as means over 4 ms, over the noise of sound
        value = curves[name] if name[0] == "H" else np.convolve(curves[name] / 1000, np.full(3, 1 / 3), "same")
        axis.plot(curves["t"], value, lw=1, label="%d particles over the depth" % n)
axes[0, 0].legend(fontsize=8)
figure.tight_layout()
figure.savefig(os.path.join(OUT, "dam_break_3d.png"), bbox_inches="tight")
S.keep(folder, OUT, "dam_break_3d.png", table)
sys.exit(c.finish())
