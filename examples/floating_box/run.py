#!/usr/bin/env python3
"""Runs floating_box: draft at rest, heave of a box that is made heavier, against Archimedes and linear theory. After: .
build/env.sh"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [folder, os.path.dirname(folder)]
import linear  # noqa: E402
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402

c, plt = S.Checks(), S.pyplot()
CASES = ((40, 0.05),) if S.QUICK else ((40, 0.05), (80, 0.03))
table = ("| particles over the box | draft at rest, spacings off | heave period over linear theory |"
         " swing of the third period over it |\n|---|---|---|---|\n")
figure, axis = plt.subplots(figsize=(7, 3.6))
exact_t, exact = linear.heave(0.036, 0.03)
NEW = -0.2 * 0.03 / 0.3 * 0.7    # the draft of a tenth of the mass more; the water rises by 0.3 of it


def passages(t, u):
    k = np.nonzero(u[:-1] * u[1:] < 0)[0]
    return t[k] + u[k] * (t[k + 1] - t[k]) / (u[k] - u[k + 1])


for n, limit in CASES:
    out, rest = S.lmp(folder, "floating_box", "rest.%d" % n, n=n, density=0.5, time=6)
    off = (rest["c_gauge[1]"] - rest["v_y"]).mean() * n    # level less centre: draft less half of the height
    c.below("%d high: draft at rest, spacings off" % (n // 5), abs(off), limit)
    out, swing = S.lmp(folder, "floating_box", "heave.%d" % n, n=n, density=0.6, time=9)
    t, u = swing["Time"], swing["v_y"] - swing["v_y"][0] - NEW
    mine, theory = passages(t, u)[:5], passages(exact_t, exact - NEW)[:5]
    ratio = (mine[-1] - mine[0]) / (theory[-1] - theory[0])
    c.below("%d high: heave period over linear theory, off by" % (n // 5), abs(ratio - 1), 0.03)
    last = u[t > 6]
    table += "| %d | %+.3f | %.4f | %.2f |\n" % (n // 5, off, ratio, np.ptp(last) / np.ptp(exact[exact_t > 6]))
    axis.plot(t, u + NEW, label="%d particles high" % (n // 5))
axis.plot(exact_t, exact, "k--", label="linear theory, no friction")
axis.set(xlabel=r"$t \sqrt{g}$", ylabel="heave")
axis.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=3)
figure.savefig(os.path.join(out, "floating_box.png"), bbox_inches="tight")
S.keep(folder, out, "floating_box.png", table)
sys.exit(c.finish())
