#!/usr/bin/env python3
"""Runs grains_in_water, packed loosely and densely: how far the column runs out, and what must not change. After: . build/env.sh"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402

c, plt = S.Checks(), S.pyplot()
steps = 500 if S.QUICK else 2000
figure, axes = plt.subplots(3, 2, figsize=(9, 5.4), sharex=True, sharey=True)
rows = []
for column, (name, packed) in enumerate((("loose", dict(dry=0, number=1, top=9.2)), ("dense", dict(dry=5000, number=1.1, top=10)))):
    out, run = S.lmp(folder, "grains_in_water", name, steps=steps, **packed)
    shots = S.dump(os.path.join(out, "grains_in_water.dump"))
    first, last = shots[0], shots[-1]
    water, grains = last["type"] == 1, last["type"] == 2
    # what stands at the floor: the place up to which 95 % of the lowest grains are
    front = [np.quantile(s["x"][(s["type"] == 2) & (s["z"] < 1)], 0.95) for s in shots]
    c.below(name + ": fastest water at the end, over the speed of a fall from the column's height",
            np.hypot(last["vx"], last["vz"])[water].max() / np.sqrt(2 * first["z"][first["type"] == 2].max()), 0.3)
    c.below(name + ": water that has left the tank, of all", np.mean((last["z"][water] < 0) | (last["x"][water] < 0) | (last["x"][water] > 24)), 1e-9)
    level = [np.sort(s["z"][s["type"] == 1])[-30:].mean() for s in (first, last)]
    c.near(name + ": level of the water at the end over that at the beginning", level[1] / level[0], 1.0, 0.05)
    if not S.QUICK:
        c.within(name + ": the front of the lowest grains at t = 16, from 6", front[-1], 7.5, 12)
    rows.append((name, run["c_phi"][0], front[0], front[-1], first["z"][first["type"] == 2].max(), last["z"][grains].max()))
    for k, shot in enumerate((shots[0], shots[len(shots) // 2], last)):
        a = axes[k, column]
        w, g = shot["type"] == 1, shot["type"] == 2
        a.scatter(shot["x"][w], shot["z"][w], s=5, c=np.hypot(shot["vx"], shot["vz"])[w], cmap="Blues", vmin=-0.1, vmax=0.5, lw=0)
        a.scatter(shot["x"][g], shot["z"][g], s=26, c="tan", edgecolor="saddlebrown", lw=0.5)
        a.set(aspect="equal", xlim=(0, 24), ylim=(0, 13), ylabel="z")
        a.grid(False)
    axes[0, column].set_title(name)
    axes[2, column].set_xlabel("x")
figure.savefig(os.path.join(out, "grains_in_water.png"), bbox_inches="tight")
table = "| | mean phi at the grains | front at first | front at last | height at first | height at last |\n|---|---|---|---|---|---|\n"
table += "".join("| %s | %.3f | %.1f | %.1f | %.1f | %.1f |\n" % row for row in rows)
S.keep(folder, out, "grains_in_water.png", table)
sys.exit(c.finish())
