#!/usr/bin/env python3
"""The bed in calm and in shaken air, fluidised.png.

    run.py [--ranks N] [--seconds T] [--out DIR] [--quick] [--update]

--quick: half of the time. Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is
missed."""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
from checks import Checks  # noqa: E402
from runs import need, np, options, plt  # noqa: E402
from vans_runs import D, keep, lmp  # noqa: E402

AIR, RHO, ETA = 18.5, 1.225, 1.813e-5
WEIGHT = np.pi / 6 * D ** 3 * 2500 * 9.81


def drag(w):
    """On a lone bead, along x, by the law of the page; w [n][3]."""
    size = np.linalg.norm(w, axis=1)
    return 0.5 * RHO * np.pi * (D / 2) ** 2 * (0.44 * size + 24.4 * ETA / (RHO * D)) * w[:, 0]


def main():
    given, c = options(__file__, __doc__, ranks=1, seconds=4.0, quick=False), Checks()
    seconds = 2.0 if given.quick else given.seconds
    need("mpirun", "lmp")
    figure, axes = plt.subplots(figsize=(6, 4))
    found = {}
    for name, intensity in (("calm", 0.0), ("shaken", 2.0)):
        log = f"log.vans_fluidised.{given.ranks}" if name == "shaken" else "none"
        lmp(HERE, given, given.out, log, intensity=intensity, name=name, seconds=seconds)
        series = np.loadtxt(given.out / f"series.{name}")
        t = (series[:, 0] - series[0, 0]) * 5e-5
        found[name] = series[t > t[-1] / 2]
        axes.plot(t, series[:, 1] / D, label=name)
    beads = int(2.5 * 0.61 * 100 * 6 / np.pi)
    calm, shaken = found["calm"], found["shaken"]
    n = beads * len(shaken)
    rng = np.random.default_rng(1)
    # beads at rest, to first order: what they feel in shaken air, over their weight
    lifted = [drag(np.array([AIR, 0, 0]) + s * rng.standard_normal((400000, 3))).mean() / WEIGHT for s in (0.0, 2.0)]
    print(f"drag on a bead at rest over its weight: calm {lifted[0]:.4f}, shaken {lifted[1]:.4f}")
    print(f"force of the air over weight: calm {calm[:, 5].mean() / WEIGHT:.4f}, "
          f"shaken {shaken[:, 5].mean() / WEIGHT:.4f}")
    print(f"mean height in diameters: calm {calm[:, 1].mean() / D:.3f}, shaken {shaken[:, 1].mean() / D:.2f}")
    for k, axis in enumerate("xyz"):
        c.near(f"rms of the fluctuation along {axis}, m/s", np.sqrt(shaken[:, 2 + k].mean()), 2.0,
               2.0 * 5 / np.sqrt(2 * n))
    # beads at rest feel drag and buoyancy
    c.near("calm: force of the air over weight", calm[:, 5].mean() / WEIGHT, lifted[0] + RHO / 2500, 1e-3)
    c.within("calm: mean height, diameters", calm[:, 1].mean() / D, 1.0, 2.2)
    c.within("shaken: mean height, diameters", shaken[:, 1].mean() / D, 2.5, 4.0)
    axes.set(xlabel="time [s]", ylabel="mean height of the beads / d", title="Beads in rising air")
    axes.legend(frameon=False)
    axes.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(given.out / "fluidised.png", dpi=100)
    keep(HERE, given, "fluidised.png", f"log.vans_fluidised.{given.ranks}")
    return c.finish()


sys.exit(main())
