#!/usr/bin/env python3
"""Sheet flow below waves: Shields number, transport rate and thickness of the sheet beside published laws, waves.png.
    run.py [--quick] [--ranks N] [--waves N] [--seed N] [--out DIR] [--reuse DIR] [--update]

The first wave, in which the water begins at rest, is left out; --quick runs a quarter of it over a thin bed. Needs lmp
on the PATH (. build/env.sh). Ends with a line ok or MISSED for each figure of the README. --reuse reads results of an
earlier run in DIR."""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
from checks import Checks  # noqa: E402
from runs import need, np, options, plt  # noqa: E402
from vans_runs import error, keep, lmp  # noqa: E402

D, RHO, G, S = 0.003, 1000.0, 9.81, 2.65
U0, T = 2.2, 4.0                                # of the water far above the bed: largest velocity, period
SCALE = np.sqrt((S - 1) * G * D**3)             # q* = q/SCALE
WEIGHT = (S - 1) * RHO * G * D                  # Shields number: stress/WEIGHT
PARTS = 50                                      # profiles of a wave


def swart(roughness):
    """Friction factor of waves, stress = f rho U0^2/2 (Swart 1974); A: how far the water goes to each side."""
    A = U0 * T / (2 * np.pi)
    return np.exp(5.213 * (roughness / A) ** 0.194 - 5.977)


def ribberink(theta):
    """Mean q* of half a wave by the bed load of Ribberink (1998), 11 (theta - 0.05)^1.65, at the stress of every
    moment."""
    now = theta * np.sin(np.pi * (np.arange(500) + 0.5) / 500) ** 2
    return (11 * np.maximum(now - 0.05, 0) ** 1.65).mean()


def blocks(path):
    """[profile, slice, column] of the file of fix ave/time: z, velocity of the water, phi, velocity of the grains,
    stress"""
    rows = [line.split() for line in open(path) if line[0] != "#"]
    size = int(rows[0][1]) + 1
    whole = [rows[k + 1:k + size] for k in range(0, len(rows) - size + 1, size)]
    return np.array(whole, float)[:, :, 1:]


def sheet(profile):
    """Bottom and top: below it goes a hundredth of the transport; above it phi is less than 0.08."""
    z, _, phi, v, _ = profile.T
    carried = np.cumsum(phi * v) / (phi * v).sum()
    return z[carried > 0.01][0], z[phi > 0.08][-1]


def of_a_wave(path, waves):
    """[phase, slice, column]: means of the same phase of all half waves but those of the first wave; going backwards is
    going forwards, turned round"""
    turned = blocks(path)[PARTS:PARTS * waves] * 1.0
    backwards = (np.arange(len(turned)) // (PARTS // 2)) % 2 == 1
    turned[np.ix_(backwards, range(turned.shape[1]), [1, 3, 4])] *= -1
    return turned.reshape(-1, PARTS // 2, *turned.shape[1:]).mean(0)


def brief(given, c):
    """A quarter of the first wave over a thin bed of 5 x 5 grains"""
    lmp(HERE, given, given.out, name="waves", speed=U0, period=T, waves=0.25, seed=given.seed, side=5, layers=5)
    t, surface, q, stress, outside = np.loadtxt(os.path.join(given.out, "series.waves")).T[1:]
    last = blocks(os.path.join(given.out, "profiles.waves"))[-1]
    c.near("velocity far above the bed after a quarter of the wave, over the largest", surface[-1] / U0, 1.0, 0.05)
    c.within("Shields number", stress[-10:].mean() / WEIGHT, 0.3, 1.3)
    c.within("q*", q[-10:].mean() / SCALE, 0.5, 8.0)
    bottom, top = sheet(last)
    c.within("thickness of the sheet over d", (top - bottom) / D, 2.0, 12.0)
    c.below("grains outside the mesh", outside.max(), 0)
    return c.finish()


def main():
    given, c = options(__file__, __doc__, ranks=1, waves=3, seed=4711, quick=False, reuse=""), Checks()
    need("mpirun", "lmp")
    if given.quick:
        return brief(given, c)
    directory = given.reuse or given.out
    if not given.reuse:
        lmp(HERE, given, directory, name="waves", speed=U0, period=T, waves=given.waves, seed=given.seed)
    t, surface, q = np.loadtxt(os.path.join(directory, "series.waves")).T[1:4]
    late = t > T
    halves = [abs(q[(t > k * T / 2) & (t <= (k + 1) * T / 2)].mean()) / SCALE for k in range(2, 2 * given.waves)]
    phases = of_a_wave(os.path.join(directory, "profiles.waves"), given.waves)
    theta = phases[:, :, 4].max(1) / WEIGHT
    most = theta.argmax()
    bottom, top = sheet(phases[most])
    layer, wanted = (top - bottom) / D, 0.5 * RHO * swart(2.5 * D) * U0**2 / WEIGHT
    rows = [("largest Shields number; Swart 1974, roughness 2.5 d", theta.max(), wanted),
            ("mean q* of half a wave; Ribberink 1998 at that number", np.mean(halves), ribberink(theta.max())),
            ("thickness of the sheet over d; 13 times that number", layer, 13 * theta.max())]
    table = ("| | here | published | ratio |\n|---|---|---|---|\n" +
             "".join("| %s | %.2f | %.2f | %.2f |\n" % (*row, row[1] / row[2]) for row in rows))
    print(table + f"q* of {len(halves)} halves: {np.round(halves, 2)}, error of the mean {error(halves):.2f}; "
          f"sheet from {bottom / D:.1f} to {top / D:.1f} d, phase of the largest stress {(most + 0.5) / PARTS:.2f} of "
                  f"a wave; largest velocity at the surface {abs(surface[late]).max():.2f} m/s")
    c.near("largest Shields number over Swart's", rows[0][1] / rows[0][2], 1.0, 0.3)
    c.near("mean q* of half a wave over Ribberink's", rows[1][1] / rows[1][2], 1.0, 0.5)
    c.near("thickness of the sheet over 13 d times the Shields number", rows[2][1] / rows[2][2], 1.0, 0.35)
    c.below("net q* of whole waves over that of half a wave", abs(q[late].mean()) / SCALE / np.mean(halves), 0.15)

    figure, axes = plt.subplots(1, 3, figsize=(12, 4.2))
    for axis, column, what in ((axes[0], 1, "velocity of the water, m/s"), (axes[1], 2, "phi")):
        for k in (2, 7, 12, 17, 22):
            axis.plot(phases[k, :-1, column], phases[k, :-1, 0] / D, label="%.2f of a wave" % ((k + 0.5) / PARTS))
        axis.set(xlabel=what, ylabel="z/d", ylim=(0, 40))
        axis.grid(alpha=0.3)
    axes[1].axhspan(bottom / D, top / D, color="0.9", label="sheet")
    axes[1].legend(frameon=False, fontsize=8)
    axes[2].plot(t / T, q / SCALE, label="q*")
    axes[2].plot(t / T, surface / U0, color="0.5", lw=1, label="velocity far above, over the largest")
    axes[2].set(xlabel="time, waves", ylim=(-10, 12))
    axes[2].legend(frameon=False, fontsize=8)
    axes[2].grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(given.out / "waves.png", dpi=100)
    keep(HERE, given, "waves.png")
    return c.finish()


sys.exit(main())
