#!/usr/bin/env python3
"""Runs wave_maker; height of the waves over the stroke of the piston, against linear theory. After: . build/env.sh"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402

c, plt = S.Checks(), S.pyplot()
k, stroke = 0.5 * np.pi, 0.12
w = np.sqrt(k * np.tanh(k))
# Biesel & Suquet 1951: height over stroke of a piston, depth 1
theory = 2 * (np.cosh(2 * k) - 1) / (np.sinh(2 * k) + 2 * k)
out, run = S.lmp(folder, "wave_maker", "16")
t, level = run["Time"], run["c_H[1]"]
last = t > t[-1] - 2 * 2 * np.pi / w
harmonics = np.stack([f(m * w * t[last]) for m in (1, 2) for f in (np.cos, np.sin)] + [np.ones(last.sum())], axis=1)
fit = np.linalg.lstsq(harmonics, level[last], rcond=None)[0]
ratio = 2 * np.hypot(*fit[:2]) / stroke
c.near("height over stroke", ratio, theory, 0.05 * theory)
# Havelock 1929: the wave far from the piston is eta = H/2 cos(k x - w t) for the piston S/2 sin(w t)
ahead = np.angle(np.exp(1j * (np.arctan2(fit[1], fit[0]) - 3 * k)))
c.near("phase of the wave at x = 3, radians", ahead, 0.0, 0.15)
figure, axis = plt.subplots(figsize=(7, 3.2))
axis.plot(t, level, label="gauge at x = 3")
axis.plot(t[last], fit[4] + 0.5 * stroke * theory * np.cos(w * t[last] - 3 * k), "k--", label="linear theory")
axis.set(xlabel=r"$t \sqrt{g/H}$", ylabel="height of the surface")
axis.legend()
figure.savefig(os.path.join(out, "wave_maker.png"), bbox_inches="tight")
S.keep(folder, out, "wave_maker.png", "| | run | linear theory |\n|---|---|---|\n| height over stroke | %.3f | %.3f |\n"
                                      "| phase at x = 3, radians | %+.3f | 0 |\n"
       % (ratio, theory, ahead))
sys.exit(c.finish())
