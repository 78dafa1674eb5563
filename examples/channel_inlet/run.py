#!/usr/bin/env python3
"""Runs channel_inlet; mass flux through four sections, and the velocity near the outlet against Poiseuille's. After: .
build/env.sh"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402

c, plt = S.Checks(), S.pyplot()
n = 8 if S.QUICK else 16
out, run = S.lmp(folder, "channel_inlet", str(n), n=n)
late = run["Time"] > 8
flux = np.array([run["f_mean[%d]" % k][late].mean() for k in (1, 2, 3, 4)])
c.below("mass flux through four sections: largest difference to the inlet's", np.abs(flux - 1).max(), 0.005)
slope = ((run["f_P[1]"] - run["f_P[2]"])[late]).mean()
c.near("pressure gradient from x = 2 to 3, over 12 mu", slope / 0.6, 1.0, 0.05 if S.QUICK else 0.02)
shots = [s for s in S.dump(os.path.join(out, "channel_inlet.dump"))[-16:]]
y, u = [np.concatenate([s[key][(s["x"] > 3) & (s["x"] < 3.9)] for s in shots]) for key in ("y", "vx")]
off = np.sqrt(np.mean((u - 6 * y * (1 - y)) ** 2))
c.below("velocity at x = 3 to 3.9 against the parabola, rms over the mean velocity", off, 0.05 if S.QUICK else 0.03)

figure, (above, below) = plt.subplots(2, 1, figsize=(8, 4.8), gridspec_kw={"height_ratios": (1, 1.6), "hspace": 0.45})
last = shots[-1]
colours = above.scatter(last["x"], last["y"], s=4, c=last["vx"], cmap="viridis", vmin=0, vmax=1.5)
for plane in (0, 4):
    above.axvline(plane, color="k", lw=1)
above.set(aspect="equal", xlim=(-0.5, 4.5), xticks=range(5), yticks=(0, 1))
above.grid(False)
figure.colorbar(colours, ax=above, label="velocity")
for x in (0.1, 0.5, 1.5, 3.5):
    near = np.concatenate([np.stack([s["y"], s["vx"]])[:, np.abs(s["x"] - x) < 0.1] for s in shots], axis=1)
    rows = np.arange(n) + 0.5
    mean = [near[1][np.abs(near[0] * n - r) < 0.5].mean() for r in rows]
    below.plot(rows / n, mean, "o-", ms=3, label="x = %g" % x)
Y = np.linspace(0, 1, 101)
below.plot(Y, 6 * Y * (1 - Y), "k--", label="Poiseuille")
below.set(xlabel="y", ylabel="velocity")
below.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=5)
figure.savefig(os.path.join(out, "channel_inlet.png"), bbox_inches="tight")
S.keep(folder, out, "channel_inlet.png",
       "| | run | exact |\n|---|---|---|\n| mass flux at x = 0.75, 1.75, 2.75, 3.75 | %s | 1 |\n"
       "| pressure gradient from x = 2 to 3 | %.3f | 0.600 |\n"
       "| velocity near the outlet, rms difference | %.3f | 0 |\n" % (" ".join("%.4f" % f for f in flux), slope, off))
sys.exit(c.finish())
