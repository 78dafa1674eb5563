#!/usr/bin/env python3
"""Runs drops: Laplace's pressure, the mode n = 2 against the linear solution of a viscous drop, contact angles. After: . build/env.sh"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402
from ringing import fitted, mode  # noqa: E402


def angle_of(height, area):
    """Of the cap of a circle with this area and height of the centre of mass"""
    t = np.radians(np.arange(5.0, 175.0, 0.01))
    R = np.sqrt(area / (t - np.sin(t) * np.cos(t)))
    return np.degrees(np.interp(height, 2 / 3 * R * np.sin(t) ** 3 / (t - np.sin(t) * np.cos(t)) - R * np.cos(t), t))


c, plt, table, shown = S.Checks(), S.pyplot(), [], []


def ring(n, mu, time, rest=6):
    """Pressure at rest over Laplace's; frequency and damping over those of the linear solution"""
    out, run = S.lmp(folder, "drops", "ring%d_%g" % (n, mu), n=n, mu=mu, rest=rest, time=time)
    R = (run["v_count"][-1] / np.pi) ** 0.5 * 2 / n
    t, q = run["v_now"][1:], run["v_bend"][1:]
    w, g = mode(mu, R)
    fit = fitted(t, q, w, g)
    pressure = run["v_p"][0] * R    # of the first row of this run, before it has moved
    table.append((n, mu, pressure, fit[0] / w, fit[1] / g))
    c.near("%d across, Ohnesorge number %g: frequency of n = 2, over exact" % (n, mu), table[-1][3], 1.0, 0.02)
    c.near("%d across, Ohnesorge number %g: its damping, over exact" % (n, mu), table[-1][4], 1.0, 0.15 if S.QUICK else 0.10)
    c.near("%d across: pressure at rest, over sigma/R" % n, pressure, 1.0, 0.05)
    return S.dump(os.path.join(out, "drops.dump"))


def wall(angle, n, time):
    out, run = S.lmp(folder, "drops", "wall%g" % angle, scene="wall", n=n, angle=angle, rest=0.8 * time, time=0.2 * time)
    late = angle_of(run["v_high"].mean(), run["v_count"][-1] * 4 / n**2)
    c.near("contact angle where %g is asked for" % angle, late, angle, 8 if S.QUICK else 6)
    return late, S.dump(os.path.join(out, "drops.dump"))[-1]


if S.QUICK:
    ring(20, 0.05, 3)
    wall(60, 14, 5)
    sys.exit(c.finish())
rings = ring(20, 0.05, 8)
ring(20, 0.01, 8)
angles = [(asked, *wall(asked, 20, 10)) for asked in (45, 60, 90, 120, 150)]

figure, axes = plt.subplots(2, 5, figsize=(9, 3.6))
for axis, shot in zip(axes[0], rings):
    axis.scatter(shot["x"], shot["y"], s=3, c=np.hypot(shot["vx"], shot["vy"]), cmap="viridis", vmin=0, vmax=0.15)
for axis, (asked, found, shot) in zip(axes[1], angles):
    middle = shot["x"][shot["type"] == 1].mean()
    axis.scatter(shot["x"] - middle, shot["y"], s=2, c=np.where(shot["type"] == 1, "tab:blue", "0.6"))
    axis.set(title="%g asked, %.0f" % (asked, found), xlim=(-1.9, 1.9), ylim=(-0.4, 1.8))
for axis in axes.flat:
    axis.set(aspect="equal", xticks=[], yticks=[])
out = os.path.join(os.path.dirname(os.path.dirname(folder)), "build", "examples", "drops")
figure.tight_layout()
figure.savefig(os.path.join(out, "drops.png"), dpi=90)
S.keep(folder, out, "drops.png", "| particles across | Ohnesorge number | pressure | frequency | damping |\n|---|---|---|---|---|\n" +
       "".join("| %d | %g | %.3f | %.3f | %.3f |\n" % row for row in table))
sys.exit(c.finish())
