#!/usr/bin/env python3
"""A dam breaks over a bed of loose grains, and over one that is held: scour, front, and what must not change. After: .
build/env.sh"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402

c, plt = S.Checks(), S.pyplot()
every = 60 if S.QUICK else 250
BASIN = 9       # length and depth of the reservoir above the bed


def columns(shot):
    """Grains in each column of 2 diameters."""
    grains = shot["type"] == 2
    return np.histogram(shot["x"][grains], np.arange(0, 37, 2))[0]


def front(shot):
    """Of the water above the bed: how far the layer above 4.6 diameters has come."""
    return np.quantile(shot["x"][(shot["type"] == 1) & (shot["z"] > 4.6)], 0.98)


shots = {}
for name, loose, pictures in (("loose", "yes", 8), ("held", "no", 2)):
    out, run = S.lmp(folder, "dam_break_bed", name, steps=pictures * every, every=every, loose=loose)
    shots[name] = S.dump(os.path.join(out, "dam_break_bed.dump"))
    first, last = shots[name][0], shots[name][-1]
    water = last["type"] == 1
    c.below(name + ": water that has left the tank, of all",
            np.mean((last["z"][water] < 0) | (last["x"][water] < 0) | (last["x"][water] > 36)), 1e-9)
    if loose == "no":
        moved = max(np.abs(last[k] - first[k])[first["type"] == 2].max() for k in "xz")
        c.below("held: how far a grain has moved", moved, 1e-12)

times = np.arange(len(shots["loose"])) * every * 0.005
before, after = columns(shots["loose"][0]), columns(shots["loose"][-1])
height = 4.0 * after / before.mean()        # of a bed as dense as at first, which is 4 high
grains = shots["loose"][0]["type"] == 2
way = shots["loose"][-1]["x"][grains] - shots["loose"][0]["x"][grains]
speed = {name: (front(frames[2]) - front(frames[0])) / times[2] for name, frames in shots.items()}
rows = [("mean way of a grain", "%.2f" % way.mean()), ("largest way", "%.1f" % way.max()),
        ("deepest scour (columns of 2 d)", "%.2f" % (4.0 - height.min())),
        ("where", "x = %.0f" % (2 * height.argmin() + 1)), ("highest heap", "%.2f" % (height.max() - 4.0)),
        ("where", "x = %.0f" % (2 * height.argmax() + 1)),
        ("speed of the front at first, loose, over sqrt(g H)", "%.2f" % (speed["loose"] / np.sqrt(BASIN))),
        ("held", "%.2f" % (speed["held"] / np.sqrt(BASIN)))]
for row in rows:
    print("  %s: %s" % row)
c.holds("the flood carries grains downstream", way.mean() > 0.05)
c.below("the front, over that of Ritter's wave, 2 sqrt(g H)", speed["loose"] / (2 * np.sqrt(BASIN)), 1.0)
if not S.QUICK:
    c.holds("the bed is scoured at the dam", 2 * height.argmin() + 1 < 16)
    c.holds("the heap is downstream of the scour", height.argmax() > height.argmin())

figure, axes = plt.subplots(4, 1, figsize=(8, 8.2), sharex=True)
for a, k in zip(axes, (0, 2, 4, len(shots["loose"]) - 1)):
    shot = shots["loose"][k]
    w, g = shot["type"] == 1, shot["type"] == 2
    a.scatter(shot["x"][w], shot["z"][w], s=9, c=np.hypot(shot["vx"], shot["vz"])[w], cmap="Blues", vmin=-1, vmax=5,
              lw=0)
    a.scatter(shot["x"][g], shot["z"][g], s=40, c="tan", edgecolor="saddlebrown", lw=0.5)
    a.set(aspect="equal", xlim=(0, 36), ylim=(0, 14), ylabel="z", title="t = %.1f" % times[k])
    a.grid(False)
axes[-1].step(np.arange(0, 37, 2), np.append(height, height[-1]), where="post", color="k", lw=1)
axes[-1].set_xlabel("x")
figure.tight_layout()
figure.savefig(os.path.join(out, "dam_break_bed.png"), bbox_inches="tight")
table = "| | |\n|---|---|\n" + "".join("| %s | %s |\n" % row for row in rows)
S.keep(folder, out, "dam_break_bed.png", table)
sys.exit(c.finish())
