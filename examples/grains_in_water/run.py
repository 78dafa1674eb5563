#!/usr/bin/env python3
"""Runs grains_in_water, packed loosely and densely: how far the columns run out, the pressure of the water in them, and
what must not change. After: . build/env.sh"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402

c, plt = S.Checks(), S.pyplot()
steps, dt = 250 if S.QUICK else 4000, 0.013
early = 1 if S.QUICK else 4    # the snapshot at t = 13


# Rondon, Pouliquen & Aussillous 2011, as published with sedFoam (tutorials/Py/DATA/Rondon2012): height over width and
# phi at first; height at last over that at first; run-out over width; largest excess pressure at the foot, in Pa, over
# phi (2500 - 1010) 9.81 height
MEASURED = {"loose": (4.8 / 6, 0.55, 2.62 / 4.8, (21.2 - 6) / 6, 144 / (0.55 * 1490 * 9.81 * 0.048)),
            "dense": (4.2 / 6, 0.60, 4.22 / 4.2, (12.1 - 6) / 6, -126 / (0.60 * 1490 * 9.81 * 0.042))}


def front(shot):
    """The place up to which 95 % of the grains stand that touch the floor."""
    return np.quantile(shot["x"][(shot["type"] == 2) & (shot["z"] < 1)], 0.95)


def excess(shot):
    """Pressure of the water at the foot of the column over that of water as deep far from it."""
    water, P = shot["type"] == 1, shot["f_eos"] + shot["z"]
    low = water & (shot["z"] < 4)
    return P[low & (shot["x"] < 5)].mean() - P[low & (shot["x"] > 15)].mean()


figure, axes = plt.subplots(4, 2, figsize=(9, 7.2), layout="constrained",
                            gridspec_kw=dict(height_ratios=[1, 1, 1, 1.1]))
rows, fronts, pressures = [], {}, {}
for column, (name, packed) in enumerate((("loose", dict(friction=1, calm=3)), ("dense", dict(friction=0, calm=0.1)))):
    out, run = S.lmp(folder, "grains_in_water", name, steps=steps, **packed)
    shots = S.dump(os.path.join(out, "grains_in_water.dump"))
    first, last = shots[0], shots[-1]
    water, grains = last["type"] == 1, last["type"] == 2
    fronts[name], pressures[name] = [front(s) for s in shots], [excess(s) for s in shots]
    c.below(name + ": water that has left the tank, of all",
            np.mean((last["z"][water] < 0) | (last["x"][water] < 0) | (last["x"][water] > 24)), 1e-9)
    level = [np.sort(s["z"][s["type"] == 1])[-30:].mean() for s in (first, last)]
    c.near(name + ": level of the water at the end over that at the beginning", level[1] / level[0], 1.0, 0.05)
    rows.append((name, run["v_packing"][0], first["z"][first["type"] == 2].max(), last["z"][grains].max(),
                 fronts[name][early], fronts[name][-1], np.mean(pressures[name][1:early + 1])))
    for k, shot in enumerate((shots[0], shots[early], last)):
        a = axes[k, column]
        w, g = shot["type"] == 1, shot["type"] == 2
        a.scatter(shot["x"][w], shot["z"][w], s=5, c=np.hypot(shot["vx"], shot["vz"])[w], cmap="Blues", vmin=-0.02,
                  vmax=0.15, lw=0)
        a.scatter(shot["x"][g], shot["z"][g], s=26, c="tan", edgecolor="saddlebrown", lw=0.5)
        a.set(aspect="equal", xlim=(0, 24), ylim=(0, 12), ylabel="z")
        a.grid(False)
    axes[0, column].set_title("%s, phi %.2f" % (name, rows[-1][1]))
times = 250 * dt * np.arange(len(shots))
for a, of, label in ((axes[3, 0], fronts, "front"), (axes[3, 1], pressures, "excess pressure")):
    for name, style in (("loose", "o-"), ("dense", "s--")):
        a.plot(times, of[name], style, ms=3, label=name)
    a.set(xlabel="time", ylabel=label)
    a.legend()
figure.savefig(os.path.join(out, "grains_in_water.png"), bbox_inches="tight")
table = ("| | phi | height at first | height at last | front at t = 13 | front at last | excess pressure until t = 13 |"
         "\n|---|---|---|---|---|---|---|\n")
table += "".join("| %s | %.2f | %.1f | %.1f | %.1f | %.1f | %+.2f |\n" % row for row in rows)
table += ("\n| | height over width | phi | height at last, of the first | run-out over width |"
          " largest excess pressure |\n|---|---|---|---|---|---|\n")
found = {row[0]: (row[2] / 6, row[1], row[3] / row[2], row[5] / 6 - 1,
                  max(pressures[row[0]][1:], key=abs) / (row[1] * 1.5 * row[2])) for row in rows}
for name in ("loose", "dense"):
    for who, of in (("measured", MEASURED), ("here", found)):
        table += "| %s, %s | %.2f | %.2f | %.2f | %.2f | %+.2f |\n" % (name, who, *of[name])
loose, dense = rows
c.within("loose and dense: difference of phi", loose[1] - dense[1], -0.15, -0.05)
c.below("excess pressure of the water in the dense column, which is sucked in", dense[6], -0.3)
c.below("the same less that of the loose column", dense[6] - loose[6], -0.3)
if not S.QUICK:
    c.below("way of the dense front until t = 13 over that of the loose one", (dense[4] - 6) / (loose[4] - 6), 0.5)
    c.within("loose: run-out over the width of the column", loose[5] / 6 - 1, 1.0, 1.5)
    for name in ("loose", "dense"):
        c.near(name + ": height at last, of that at first, over the measured one", found[name][2] / MEASURED[name][2],
               1.0, 0.2)
    c.below("dense: run-out over that of the loose one", (dense[5] - 6) / (loose[5] - 6), 0.75)
S.keep(folder, out, "grains_in_water.png", table)
sys.exit(c.finish())
