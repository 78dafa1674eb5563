#!/usr/bin/env python3
"""Runs drops: Laplace's pressure, the mode n = 2 against the linear solution of a viscous drop, contact angles; and a
jet that breaks up, by the rates at which waves on it grow. After: . build/env.sh"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402
from ringing import fitted, growth, mode  # noqa: E402


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
    c.near("%d across, Ohnesorge number %g: its damping, over exact" % (n, mu), table[-1][4], 1.0,
           0.15 if S.QUICK else 0.10)
    c.near("%d across: pressure at rest, over sigma/R" % n, pressure, 1.0, 0.05)
    return S.dump(os.path.join(out, "drops.dump"))


def wall(angle, n, time):
    out, run = S.lmp(folder, "drops", "wall%g" % angle, scene="wall", n=n, angle=angle, rest=0.8 * time,
                     time=0.2 * time)
    late = angle_of(run["v_high"].mean(), run["v_count"][-1] * 4 / n**2)
    c.near("contact angle where %g is asked for" % angle, late, angle, 8 if S.QUICK else 6)
    return late, S.dump(os.path.join(out, "drops.dump"))[-1]


def wave(k, n=10, mu=0.02, time=2.8):
    """Wave number times the radius of a jet, the rate at which such a wave grows, and that of the linear solution"""
    _, run = S.lmp(folder, "jet", "wave%g" % k, n=n, k=k, mu=mu, time=time)
    long = 2 * np.pi / k
    R = (run["v_count"][-1] / np.pi / long) ** 0.5 * (long / round(long * n / 2)) ** 1.5
    late = run["v_now"] > 0.28 * time
    rate = np.polyfit(run["v_now"][late], np.log(run["v_a"][late]), 1)[0]
    c.near("jet %d across: rate of a wave of %.2f R, over exact" % (n, long / R), rate / growth(k, mu, R), 1.0, 0.13)
    return k * R, rate, growth(k, mu, R)


def fastest(waves):
    """Wave length of the largest rate: of a parabola through the rates"""
    a, b, _ = np.polyfit(*np.transpose(waves), 2)
    return 2 * np.pi / (-b / (2 * a))


if S.QUICK:
    ring(20, 0.05, 3)
    wall(60, 14, 5)
    wave(0.7, 8)
    sys.exit(c.finish())
rings = ring(20, 0.05, 8)
ring(20, 0.01, 8)
angles = [(asked, *wall(asked, 20, 10)) for asked in (45, 60, 90, 120, 150)]
waves = [wave(k) for k in (0.5, 0.6, 0.7, 0.8, 0.9)]
longest, exact = fastest([w[:2] for w in waves]), fastest([(w[0], w[2]) for w in waves])
c.near("jet: wave length that grows fastest, over exact", longest / exact, 1.0, 0.15)
jet_folder, _ = S.lmp(folder, "jet", "long", begin=0.1, time=8.6)
shots = S.dump(os.path.join(jet_folder, "jet.dump"))

figure, axes = plt.subplots(2, 5, figsize=(9, 3.6))
for axis, shot in zip(axes[0], rings):
    axis.scatter(shot["x"], shot["y"], s=3, c=np.hypot(shot["vx"], shot["vy"]), cmap="viridis", vmin=0, vmax=0.15)
for axis, (asked, found, shot) in zip(axes[1], angles):
    middle = shot["x"][shot["type"] == 1].mean()
    axis.scatter(shot["x"] - middle, shot["y"], s=2, c=np.where(shot["type"] == 1, "tab:blue", "0.6"))
    axis.set(title="%g asked, %.0f" % (asked, found), xlim=(-1.9, 1.9), ylim=(-0.4, 1.8))
for axis in axes.flat:
    axis.set(aspect="equal", xticks=[], yticks=[])
out = os.path.join(S.RESULTS, "drops")
figure.tight_layout()
broken, axes = plt.subplots(4, 1, figsize=(6, 5))
for axis, shot in zip(axes, [shots[k] for k in (0, 8, 12, 16)]):
    order, long = np.argsort(shot["z"]), 2 * np.pi / 0.7
    for k in range(2):
        axis.scatter(shot["x"][order] + k * long, shot["y"][order], s=2, c=shot["vx"][order], cmap="coolwarm",
                     vmin=-0.5, vmax=0.5)
    axis.set(aspect="equal", xticks=[], yticks=[], xlim=(0, 2 * long), ylim=(-2, 2))
broken.tight_layout()
broken.savefig(os.path.join(out, "jet.png"), dpi=80)
figure.savefig(os.path.join(out, "drops.png"), dpi=90)
S.keep(folder, out, "drops.png", "| particles across | Ohnesorge number | pressure | frequency | damping |\n"
                                 "|---|---|---|---|---|\n" +
       "".join("| %d | %g | %.3f | %.3f | %.3f |\n" % row for row in table))
S.keep(folder, out, "jet.png", "| wave length over R | rate | exact |\n|---|---|---|\n" +
       "".join("| %.2f | %.3f | %.3f |\n" % (2 * np.pi / k, rate, right) for k, rate, right in waves) +
       "| fastest: %.2f | | %.2f |\n" % (longest, exact), "waves.md")
sys.exit(c.finish())
