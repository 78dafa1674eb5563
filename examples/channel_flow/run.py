#!/usr/bin/env python3
"""Runs channel_flow at three resolutions, both flows; table and picture: profiles against the series. After: .
build/env.sh"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402


def series(flow, y, t, nu=0.1, g=0.8, U=1.0):
    """Poiseuille and Couette start-up between y = 0 and 1."""
    if flow == "poiseuille":
        k = (2 * np.arange(100) + 1)[:, None] * np.pi
        return g / (2 * nu) * y * (1 - y) - (4 * g / (nu * k**3) * np.sin(k * y) * np.exp(-k * k * nu * t)).sum(0)
    n = np.arange(1, 200)[:, None]
    return (U * y + (2 * U / (n * np.pi) * (-1.0) ** n * np.sin(n * np.pi * y) *
                     np.exp(-((n * np.pi) ** 2) * nu * t)).sum(0))


# Largest error in %, and order from the resolution before.
WANTED = {("poiseuille", 10): (3.70, None), ("poiseuille", 20): (1.15, 1.68), ("poiseuille", 40): (0.40, 1.53),
          ("couette", 10): (1.80, None), ("couette", 20): (0.41, 2.15), ("couette", 40): (0.15, 1.40)}

plt, c = S.pyplot(), S.Checks()
figure, axes = plt.subplots(1, 2, figsize=(10, 4), sharey=True)
table = "| flow | particles across | largest error, t = 0.5 to 3 | order |\n|---|---|---|---|\n"
for flow, axis in (("poiseuille", axes[0]), ("couette", axes[1])):
    last = None
    for n in (10,) if S.QUICK else (10, 20, 40):
        out, t = S.lmp(folder, "channel_flow", "%s.%d" % (flow, n), flow=flow, n=n)
        step = (t["Time"][-1] - t["Time"][0]) / (t["Step"][-1] - t["Step"][0])
        blocks = [b for b in S.profiles(os.path.join(out, "%s.%d.txt" % (flow, n))) if b[0] > 0]
        error = max(np.abs(rows[:, 3] - series(flow, rows[:, 1], s * step)).max() for s, rows in blocks)
        table += "| %s | %d | %.2f %% | %s |\n" % (flow, n, 100 * error, "%.2f" % np.log2(last / error) if last else "")
        c.near("%s, %d across: largest error in %%" % (flow, n), 100 * error, WANTED[flow, n][0],
               0.05 * WANTED[flow, n][0])
        if last:
            c.near("%s, %d across: order" % (flow, n), np.log2(last / error), WANTED[flow, n][1], 0.1)
        last = error
    y = np.linspace(0, 1, 200)
    for k, (s, rows) in enumerate(blocks[:1] + blocks[1::2]):
        axis.plot(series(flow, y, s * step), y, "k-", lw=1, label="series" if k == 0 else None)
        axis.plot(rows[:, 3], rows[:, 1], "o", ms=4, mfc="none", color="C%d" % k, label="t = %.1f" % (s * step))
    axis.set(xlabel="velocity", title=flow.capitalize() + " flow, %d particles across" % n)
    axis.legend(fontsize=8)
axes[0].set_ylabel("y")
figure.tight_layout()
figure.savefig(os.path.join(out, "channel_flow.png"))
S.keep(folder, out, "channel_flow.png", table)
sys.exit(c.finish())
