#!/usr/bin/env python3
"""Runs channel_flow at three resolutions, both flows; table and picture: profiles against the series. After: . build/env.sh"""
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
    return U * y + (2 * U / (n * np.pi) * (-1.0) ** n * np.sin(n * np.pi * y) * np.exp(-((n * np.pi) ** 2) * nu * t)).sum(0)


plt = S.pyplot()
figure, axes = plt.subplots(1, 2, figsize=(10, 4), sharey=True)
table = "| flow | particles across | largest error, t = 0.5 to 3 | order |\n|---|---|---|---|\n"
for flow, axis in (("poiseuille", axes[0]), ("couette", axes[1])):
    last = None
    for n in (10, 20, 40):
        out, t = S.lmp(folder, "channel_flow", "%s.%d" % (flow, n), flow=flow, n=n)
        step = (t["Time"][-1] - t["Time"][0]) / (t["Step"][-1] - t["Step"][0])
        blocks = [b for b in S.profiles(os.path.join(out, "%s.%d.txt" % (flow, n))) if b[0] > 0]
        error = max(np.abs(rows[:, 3] - series(flow, rows[:, 1], s * step)).max() for s, rows in blocks)
        table += "| %s | %d | %.2f %% | %s |\n" % (flow, n, 100 * error, "%.2f" % np.log2(last / error) if last else "")
        last = error
    y = np.linspace(0, 1, 200)
    for k, (s, rows) in enumerate(blocks[:1] + blocks[1::2]):
        axis.plot(series(flow, y, s * step), y, "k-", lw=1, label="series" if k == 0 else None)
        axis.plot(rows[:, 3], rows[:, 1], "o", ms=4, mfc="none", color="C%d" % k, label="t = %.1f" % (s * step))
    axis.set(xlabel="velocity", title=flow.capitalize() + " flow, 40 particles across")
    axis.legend(fontsize=8)
axes[0].set_ylabel("y")
figure.tight_layout()
figure.savefig(os.path.join(out, "channel_flow.png"))
S.keep(folder, out, "channel_flow.png", table)
