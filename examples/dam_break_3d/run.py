#!/usr/bin/env python3
"""Runs dam_break_3d; heights and pressures against the experiment. After: . build/env.sh

    run.py [--quick] [--reuse] [--update] [N ...]

N: particles over the depth, 10 if none is given. Up to 10 the run has 6 s, finer ones 0.72 s, which is the impact;
--quick: 0.72 s for all. Multiples of 10: the patches that measure the load are 0.055 m high, a whole number of
spacings. --reuse: takes the logs of earlier runs in build/examples/dam_break_3d where there are some, also of one that
is not finished.
"""
import os
import re
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np, RESULTS, TOP  # noqa: E402

c, plt = S.Checks(), S.pyplot()
sizes = [int(word) for word in sys.argv[1:] if word.isdigit()] or [10]
IMPACT, WINDOW = 0.72, 0.3
# Largest errors: of a coarse run, and from 30 particles over the depth on
COARSE = {"arrival": 0.05, "load": 0.15, "face": 0.3, "H2": 0.06, "H4": 0.03}
FINE = {"arrival": 0.03, "load": 0.15, "face": 0.3, "H2": 0.05, "H4": 0.05}
# The sensors that each patch of the box's front is compared with
SENSORS = ("P1", "P2", "P3", "P4")
PATCHES = {"L1": ("P1",), "L2": ("P2", "P3"), "L3": ("P4",)}
PATCH_OF = {sensor: patch for patch, sensors in PATCHES.items() for sensor in sensors}
OUT = os.path.join(RESULTS, "dam_break_3d")


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
    names.update({"f_L[%s]" % k: "L" + k for k in "123"})
    return dict({"t": table["Time"]}, **{names[name]: table[name] for name in names}), minutes


def first(t, value, limit):
    """When a curve passes a limit, between its samples."""
    k = np.nonzero(value > limit)[0][0]
    return t[k - 1] + (t[k] - t[k - 1]) * (limit - value[k - 1]) / (value[k] - value[k - 1])


def arrival(curves, name="P1"):
    """When P1, or what is taken for it, passes 500 Pa."""
    return first(curves["t"], curves[name], 500)


def means(curves, names, begin, end):
    """Means of curves between two times after the first of them has passed 500 Pa."""
    fine = arrival(curves, names[0]) + np.linspace(begin, end, 3001)
    return np.array([np.interp(fine, curves["t"], curves[name]).mean() for name in names])


def loads(begin, end):
    """What the sensors that belong to each patch measured."""
    of_sensor = dict(zip(SENSORS, means(fast, SENSORS, begin, end)))
    return np.array([np.mean([of_sensor[name] for name in sensors]) for sensors in PATCHES.values()])


def differences(name, curves, end):
    """Of a height, over the largest that was measured, up to a time."""
    t = slow["t"][slow["t"] <= min(end, curves["t"][-1])]
    return (np.interp(t, curves["t"], curves[name]) - slow[name][:len(t)]) / slow[name].max()


def heading(*columns):
    return "| particles over the depth | " + " | ".join(columns) + " |\n" + "|---" * (len(columns) + 1) + "|\n"


def percent(name, values):
    return "| %s | %s |\n" % (name, " | ".join("%+.0f %%" % (100 * value) for value in values))


def pascals(values):
    return "| experiment | %s |\n" % " | ".join("%.0f Pa" % value for value in values)


at_box = arrival(fast)
times = heading("arrival at the box", "H2 to 0.72 s", "H4 to 0.72 s", "H2 to 6 s", "H4 to 6 s", "processor, min")
times += "| experiment | %.3f s | | | | | |\n" % at_box
patches = heading("0 to 0.055 m", "0.055 to 0.11 m", "0.11 to 0.165 m",
                  "all three") + pascals([*loads(0, WINDOW), loads(0, WINDOW).mean()])
probes = heading(*SENSORS) + pascals(means(fast, SENSORS, 0, WINDOW))
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
    end = min(WINDOW, curves["t"][-1] - arrival(curves, "L1"))
    late = arrival(curves) / at_box - 1
    load = means(curves, list(PATCHES), 0, end) / loads(0, end) - 1
    face = means(curves, list(PATCHES), 0, end).mean() / loads(0, end).mean() - 1
    probe = means(curves, SENSORS, 0, end) / means(fast, SENSORS, 0, end) - 1
    early, later = (means(curves, ["L1"], *window)[0] / loads(*window)[0] for window in ((0, 0.08), (0.08, end)))
    print("[dam_break_3d] load on the lowest patch over P1, from 0 to 0.08 s after the arrival: %.2f, "
          "from there to %.2f s: %.2f; arrival by this load: %+.1f %%" %
          (early, end, later, 100 * (arrival(curves, "L1") / at_box - 1)))
    heights = {name: np.sqrt(np.mean(differences(name, curves, IMPACT) ** 2)) for name in ("H2", "H4")}
    whole = ["%.3f" % abs(differences(name, curves, 6)).mean() if curves["t"][-1] > 5.9 else "" for name in heights]
    times += "| %d | %+.1f %% | %.3f | %.3f | %s | %s | %s |\n" % (
        n, 100 * late, heights["H2"], heights["H4"], *whole, "%.0f" % minutes if minutes > 0 else "")
    patches += percent(n, [*load, face])
    probes += percent(n, probe)
    limits = FINE if n >= 30 else COARSE
    c.below("%d over the depth: arrival at the box, off by" % n, abs(late), limits["arrival"])
    c.below("%d over the depth: mean load on the lowest patch in %.2f s from there, off P1 by" % (n, end), abs(load[0]),
            limits["load"])
    c.below("%d over the depth: mean load on all three patches, off by" % n, abs(face), limits["face"])
    for name, value in heights.items():
        c.below("%d over the depth: %s in the first 0.72 s, rms difference over the largest" % (n, name), value,
                limits[name])
    for axis, name in zip(axes.flat, ("H2", "P1", "P2", "H4", "P3", "P4")):
        label = "%d particles over the depth" % n
        if name[0] == "H":
            axis.plot(curves["t"], curves[name], lw=1, label=label)
            continue
        # loads and, pale, probes as means over 6 ms, over the noise of sound
        calm = {key: np.convolve(curves[key] / 1000, np.full(3, 1 / 3), "same") for key in (name, PATCH_OF[name])}
        line = axis.plot(curves["t"], calm[PATCH_OF[name]], lw=1, label=label)[0]
        axis.plot(curves["t"], calm[name], lw=1, alpha=0.3, color=line.get_color())
axes[0, 0].legend(fontsize=8)
figure.tight_layout()
figure.savefig(os.path.join(OUT, "dam_break_3d.png"), bbox_inches="tight")
S.keep(folder, OUT, "dam_break_3d.png", "\n".join((times, patches, probes)))
sys.exit(c.finish())
