#!/usr/bin/env python3
"""Falls at three concentrations, speeds beside the closed form, drag.png.     run.py [--ranks N] [--out DIR] [--update]

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed."""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
from checks import Checks  # noqa: E402
from runs import need, np, options, plt  # noqa: E402
from vans_runs import keep, lmp  # noqa: E402


def closed_form(d, phi):
    """(0.44 w + 24.4 nu/d) w (1 - phi)^-3.1 = 4/3 (s - 1) g d"""
    B, C = 24.4e-6 / d, 4 / 3 * 1.5 * 9.81 * d * (1 - phi) ** 3.1
    return (-B + np.sqrt(B * B + 4 * 0.44 * C)) / 0.88


def main():
    given, c = options(__file__, __doc__, ranks=1), Checks()
    need("mpirun", "lmp")
    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2))
    fine = np.logspace(-4, -2, 200)
    speed = {}
    for phi in ("0.0", "0.2", "0.4"):
        lmp(HERE, given, given.out, f"log.vans_drag.{given.ranks}" if phi == "0.2" else "none", phi=phi)
        rows = np.loadtxt(given.out / f"speeds.{phi}", skiprows=9)
        rows = rows[np.argsort(rows[:, 0])]
        d, w = rows[:, 1], -rows[:, 2]
        speed[phi] = w
        error = np.abs(w / closed_form(d, float(phi)) - 1)
        print(f"phi {phi}: terminal velocity {w.min():.5f} to {w.max():.5f} m/s, largest error against the closed form "
              f"{error.max():.1e}")
        c.below(f"phi {phi}: largest error of the terminal velocity", error.max(), 1e-11)
        left.loglog(d * 1e3, w, "o", ms=5, label=f"phi = {phi}")
        left.loglog(fine * 1e3, closed_form(fine, float(phi)), "k-", lw=1)
    # the exponent from the drags at the speeds reached
    B = 24.4e-6 / d
    free = (0.44 * speed["0.0"] + B) * speed["0.0"]
    for phi in ("0.2", "0.4"):
        exponent = np.log((0.44 * speed[phi] + B) * speed[phi] / free) / np.log(1 - float(phi))
        print(f"phi {phi}: exponent of hindrance from the runs {exponent.min():.6f} to {exponent.max():.6f}")
        c.near(f"phi {phi}: exponent of hindrance", exponent[np.abs(exponent - 3.1).argmax()], 3.1, 5e-7)
    v = fine * closed_form(fine, 0) / 1e-6
    right.loglog(v, 0.44 + 24.4 / v, "k-", lw=1, label="0.44 + 24.4/Re")
    Re = speed["0.0"] * d / 1e-6
    right.loglog(Re, 4 / 3 * 1.5 * 9.81 * d / speed["0.0"] ** 2, "o", ms=5, label="from the runs, phi = 0")
    left.set(xlabel="grain diameter [mm]", ylabel="terminal velocity [m/s]",
             title="Glass in water at rest (lines: closed form)")
    right.set(xlabel="Re", ylabel="drag coefficient", title="Drag coefficient")
    for axes in (left, right):
        axes.legend(frameon=False)
        axes.grid(alpha=0.3, which="both", lw=0.4)
    figure.tight_layout()
    figure.savefig(given.out / "drag.png", dpi=110)
    keep(HERE, given, "drag.png", f"log.vans_drag.{given.ranks}")
    return c.finish()


sys.exit(main())
