#!/usr/bin/env python3
"""Runs river_bump, with a bed whose rows follow the bump and one of stairs, each with both shifts, against Bernoulli.
After: . build/env.sh"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import sph_runs as S  # noqa: E402
from runs import np  # noqa: E402

Q, D, G, BUMP = 0.15, 0.3, 9.81, 0.06


def bed(x):
    return np.where(abs(x - 1.2) < 0.4, BUMP * (1 - ((x - 1.2) / 0.4) ** 2), 0.0)


def bernoulli(B):
    """The height of the surface: D + q^2/(2 g D^2) = B + d + q^2/(2 g d^2), the slow branch."""
    head = D + Q**2 / (2 * G * D**2) - B
    return B + max(root.real for root in np.roots([1, -head, 0, Q**2 / (2 * G)]) if abs(root.imag) < 1e-9)


def heights(run, since):
    late = run["Time"] > since
    return [run["v_" + key][late].mean() for key in ("before", "crest", "behind")]


def discharge(run, key, since):
    t, mass = run["Time"], run["v_" + key]
    late = t > since
    return np.polyfit(t[late], mass[late], 1)[0]


c, plt = S.Checks(), S.pyplot()
n, time, since = (10, 3, 1) if S.QUICK else (15, 9, 4)
exact = [bernoulli(float(bed(x))) for x in (0.4, 1.2, 2.0)]
out, run = S.lmp(folder, "river_bump", "%d" % n, n=n, time=time)
rows, shot = heights(run, since), S.dump(os.path.join(out, "river_bump.dump"))[-1]
for name, height, right in zip(("before", "over the crest of", "behind"), rows, exact):
    c.near("surface %s the bump, over Bernoulli's" % name, height / right, 1.0, 0.02 if S.QUICK else 0.01)
c.near("discharge at the inlet, over q", discharge(run, "came", since) / Q, 1.0, 0.03 if S.QUICK else 0.01)
if not S.QUICK:
    c.near("discharge at the outlet, over q", discharge(run, "went", since) / Q, 1.0, 0.01)
    cut = heights(S.lmp(folder, "river_bump", "stairs", n=n, time=time, stairs="yes")[1], since)
    for name, height, right in zip(("before", "over the crest of", "behind"), cut, exact):
        c.near("with a bed of stairs: surface %s the bump" % name, height / right, 1.0, 0.02)
    plain = []
    for stairs in ("no", "yes"):
        word = "plain" + "_stairs" * (stairs == "yes")
        plain.append(heights(S.lmp(folder, "river_bump", word, n=n, time=time, stairs=stairs, shift="yes")[1], since))
    c.below("shift yes and stairs: surface before the bump, over Bernoulli's", plain[1][0] / exact[0], 0.96)

    figure, axes = plt.subplots(figsize=(8, 2.6))
    x = np.linspace(0, 2.4, 241)
    axes.fill_between(x, 0, bed(x), color="0.6")
    colours = axes.scatter(shot["x"], shot["y"], s=2, c=shot["vx"], cmap="viridis", vmin=0.3, vmax=0.9)
    axes.plot(x, [bernoulli(float(b)) for b in bed(x)], "r", lw=1, label="Bernoulli")
    axes.set(aspect="equal", xlim=(0, 2.4), ylim=(0, 0.4), xlabel="x (m)", ylabel="y (m)")
    figure.colorbar(colours, ax=axes, label="velocity along x (m/s)", shrink=0.7)
    axes.legend(loc="lower right")
    figure.savefig(os.path.join(out, "river_bump.png"), bbox_inches="tight", dpi=90)
    S.keep(folder, out, "river_bump.png",
           "| surface above the floor, m | before the bump | over its crest | behind it |\n|---|---|---|---|\n"
           "| Bernoulli | %.3f | %.3f | %.3f |\n"
           "| rows follow the bed | %.3f | %.3f | %.3f |\n| a bed of stairs | %.3f | %.3f | %.3f |\n"
           "| rows follow the bed, `shift yes` | %.3f | %.3f | %.3f |\n| a bed of stairs, `shift yes` | %.3f |"
           " %.3f | %.3f |\n"
           % (*exact, *rows, *cut, *plain[0], *plain[1]))
sys.exit(c.finish())
