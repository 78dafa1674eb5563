#!/usr/bin/env python3
"""Runs still_water with both kernels, and with the settings for water that stays at rest for long; table and picture:
pressure over depth, kinetic energy over time. After: . build/env.sh"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402

plt, c = S.pyplot(), S.Checks()
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4))
table = ("| kernel, h / dx, settings | slope of the pressure over mean rho g | kinetic energy, first quarter |"
         " last quarter | load on the floor over weight | rise of the centre over the depth |\n"
         "|---|---|---|---|---|---|\n")
PLAIN, SHIFT = ("alpha 0.1", {}), ("shift, alpha 0.05", {"shift": "yes", "delta": 0.1, "alpha": 0.05})
RUNS = (("wendland", 2.0, "C0", PLAIN), ("wendland", 1.5, "C2", PLAIN), ("cubicspline", 1.2, "C1", PLAIN),
        ("wendland", 2.0, "C3", SHIFT))
# Slope, kinetic energies of the first and last quarter in J, load over weight.
WANTED = {(2.0, "alpha 0.1"): (0.9923, 3.4e-4, 2.0e-4, 1.004), (1.5, "alpha 0.1"): (1.0023, 7.8e-3, 4.0e-3, 1.001),
          (1.2, "alpha 0.1"): (0.9979, 1.3e-3, 8.4e-4, 1.001),
          (2.0, "shift, alpha 0.05"): (0.9932, 7.7e-4, 5.1e-4, 1.007)}
for kernel, ratio, colour, (settings, more) in RUNS[1:2] if S.QUICK else RUNS:
    tag = "%s.%s.%s" % (kernel, ratio, more.get("shift", "no"))
    out, t = S.lmp(folder, "still_water", tag, kernel=kernel, ratio=ratio, **more)
    layer = S.profiles(os.path.join(out, "profile.%s.txt" % tag))[-1][1]
    first, *_, last = S.dump(os.path.join(out, "still_water.%s.dump" % tag))
    rise = last["y"].mean() - first["y"].mean()
    y, p, rho = layer[:, 1], layer[:, 3], layer[:, 4]
    inside = (y > 0.05) & (y < 0.95)
    slope = -np.polyfit(y[inside], p[inside], 1)[0] / (9.81 * rho[inside].mean())
    e, n = t["c_kinetic"], len(t["Step"]) // 4
    table += ("| %s, %s, %s | %.4f | %.1e J | %.1e J | %.3f | %.4f |\n" %
              (kernel, ratio, settings, slope, e[1:n + 1].mean(), e[-n:].mean(), -t["v_load"][-n:].mean(), rise))
    who, (wanted, before, after, load) = "%s, h = %s dx, %s: " % (kernel, ratio, settings), WANTED[ratio, settings]
    c.near(who + "slope of the pressure", slope, wanted, 0.002)
    c.near(who + "kinetic energy, first quarter, J", e[1:n + 1].mean(), before, 0.1 * before)
    c.near(who + "kinetic energy, last quarter, J", e[-n:].mean(), after, 0.2 * after)
    c.near(who + "load on the floor over weight", -t["v_load"][-n:].mean(), load, 0.005)
    left.plot(p / 1000, y, "o", ms=3.5, color=colour, label="%s, h = %s dx, %s: %+.2f %%" %
              (kernel, ratio, settings, 100 * (slope - 1)))
    right.semilogy(t["Time"][1:], e[1:], color=colour)
left.plot([0, 9.81], [1, 0], "k-", lw=1, label="hydrostatic")
left.set(xlabel="pressure (kPa)", ylabel="height (m)")
left.legend(fontsize=8)
right.set(xlabel="time (s)", ylabel="kinetic energy of 500 kg (J)")
figure.tight_layout()
figure.savefig(os.path.join(out, "still_water.png"))
S.keep(folder, out, "still_water.png", table)
sys.exit(c.finish())
