#!/usr/bin/env python3
"""Runs dam_break; table, picture and film: the front against experiments. After: . build/env.sh"""
import os
import shutil
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import film  # noqa: E402
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402

plt, c = S.pyplot(), S.Checks()


def frame(shot, time):
    """One picture of the film: water, coloured by its speed, and the tank"""
    scene, axes = plt.subplots(figsize=(5.4, 3.9), dpi=90)
    scene.subplots_adjust(0, 0, 1, 1)
    wall, speed = shot["type"] == 2, np.hypot(shot["vx"], shot["vy"])
    axes.scatter(shot["x"][wall], shot["y"][wall], s=4, color="0.6", linewidths=0)
    axes.scatter(shot["x"][~wall], shot["y"][~wall], s=13, c=speed[~wall], cmap="turbo", vmin=0, vmax=2.5, linewidths=0)
    axes.set(aspect="equal", xlim=(-0.03, 0.615), ylim=(-0.03, 0.435))
    axes.axis("off")
    axes.text(0.42, 0.4, "t = %.2f s" % time, fontsize=9)
    return film.picture(scene)


out, t = S.lmp(folder, "dam_break", 1)
figure = plt.figure(figsize=(10, 5.2))
grid = figure.add_gridspec(3, 2, width_ratios=(1.1, 1))
front = figure.add_subplot(grid[:, 0])
with open(os.path.join(folder, "..", "..", "unittest", "data", "sph", "dam_experiment.csv")) as f:
    rows = [line.split(",") for line in f.read().split() if not line.startswith(("#", "source"))]
worst = {}
table = "| experiment | T | Z | run | difference |\n|---|---|---|---|---|\n"
for source, mark in (("koshizuka_oka_1996", "s"), ("martin_moyce_1952_a2.25in", "^")):
    T, Z = np.array([[float(r[1]), float(r[2])] for r in rows if r[0] == source]).T
    front.plot(T, Z, mark, color="k", mfc="none", label=source.replace("_", " "))
    for a, b in zip(T, Z):
        if 0 < a <= 3:
            here = np.interp(a, t["v_T"], t["v_Z"])
            worst[source] = max(worst.get(source, 0), abs(here / b - 1))
            table += "| %s | %.3f | %.3f | %.3f | %+.1f %% |\n" % (source.replace("_", " "), a, b, here,
                                                                   100 * (here / b - 1))
for source, limit in (("koshizuka_oka_1996", 4.3), ("martin_moyce_1952_a2.25in", 5.0)):
    c.below(source.replace("_", " ") + ": largest difference of the front in %", 100 * worst[source], limit)
front.plot(t["v_T"], t["v_Z"], "-", label="run")
front.set(xlabel=r"$T = t\sqrt{2g/L}$", ylabel=r"front $Z = x/L$", xlim=(0, 3.2))
front.legend()
shots = S.dump(os.path.join(out, "dam_break.dump"))
for k in (1, 2, 3):
    axis, shot = figure.add_subplot(grid[k - 1, 1]), shots[10 * k]
    wall = shot["type"] == 2
    axis.scatter(shot["x"][wall], shot["y"][wall], s=2, color="0.7")
    colours = axis.scatter(shot["x"][~wall], shot["y"][~wall], s=3, c=shot["f_eos"][~wall] / 1000, cmap="viridis",
                           vmin=0, vmax=2.5)
    axis.set(aspect="equal", xlim=(-0.03, 0.62), ylim=(-0.03, 0.31), xticks=[], yticks=[])
    axis.text(0.35, 0.25, "T = %.1f" % k)
    axis.grid(False)
figure.colorbar(colours, ax=figure.axes[1:], label="pressure (kPa)", shrink=0.8)
figure.savefig(os.path.join(out, "dam_break.png"), bbox_inches="tight")
path = os.path.join(out, "dam_break.gif")
film.write([frame(shot, time) for shot, time in zip(shots, t["Time"])], path, colours=24)
c.below("size of the film, MB", os.path.getsize(path) / 1e6, 2.0)
c.holds("the film has a frame for each row of the log", film.frames(path) == len(t["Time"]))
S.keep(folder, out, "dam_break.png", table)
if "--update" in sys.argv:
    for name in ("dam_break.gif", "log.dam_break.1"):
        shutil.copy(os.path.join(out, name), folder)
sys.exit(c.finish())
