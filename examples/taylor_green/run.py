#!/usr/bin/env python3
"""Runs taylor_green at three resolutions; table and picture: amplitude of the vortices against the exact decay. After:
. build/env.sh"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402

plt, c = S.pyplot(), S.Checks()
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2))
table = "| particles | h / dx | largest error of the amplitude, t = 0 to 2 | order |\n|---|---|---|---|\n"
last = None
# SPH converges when the support shrinks and holds more particles: h/dx grows with n.
WANTED = {25: (2.35, None), 50: (0.47, 2.33), 100: (0.10, 2.24)}
for n, ratio in ((25, 2.2),) if S.QUICK else ((25, 2.2), (50, 3.0), (100, 4.0)):
    out, t = S.lmp(folder, "taylor_green", n, n=n, ratio=ratio)
    error = np.abs(t["v_amplitude"] - t["v_exact"]).max()
    table += "| %d x %d | %.1f | %.2f %% | %s |\n" % (n, n, ratio, 100 * error, "%.2f" % np.log2(last / error) if last
                                                      else "")
    c.near("%d x %d: largest error of the amplitude in %%" % (n, n), 100 * error, WANTED[n][0], 0.05 * WANTED[n][0])
    if last:
        c.near("%d x %d: order" % (n, n), np.log2(last / error), WANTED[n][1], 0.1)
    last = error
    left.plot(t["Time"], t["v_amplitude"], "o", ms=4, mfc="none", label="%d x %d: %.2f %%" % (n, n, 100 * error))
    shot = S.dump(os.path.join(out, "taylor_green.%d.dump" % n))[-1]
    if n == 50:
        colours = right.scatter(shot["x"], shot["y"], c=np.hypot(shot["vx"], shot["vy"]), s=5, cmap="viridis")
        figure.colorbar(colours, ax=right, label="speed")
left.plot(t["Time"], t["v_exact"], "k-", lw=1, label="exact")
left.set(xlabel="time", ylabel="amplitude")
left.legend()
right.set(aspect="equal", title="t = 2, 50 x 50 particles", xlim=(0, 1), ylim=(0, 1))
right.grid(False)
figure.tight_layout()
figure.savefig(os.path.join(out, "taylor_green.png"))
S.keep(folder, out, "taylor_green.png", table)
sys.exit(c.finish())
