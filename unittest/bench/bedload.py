#!/usr/bin/env python3
"""Bed load of fix hydro/vans beside laws of measured rates: the bed of examples/vans_bedload, of glass beads of 6 mm,
at several slopes. Rows of doc/vans_stream.md.

    . build/env.sh
    unittest/bench/bedload.py                                     # 6 runs of 16 s, a minute of processor time each
    unittest/bench/bedload.py --slopes 0.03 --seconds 4           # one, short
    unittest/bench/bedload.py --fluctuation correlated            # the same with fluctuations of the velocity
    unittest/bench/bedload.py --reuse DIR                         # prints the rows of an earlier run again

q* = q/sqrt((s - 1) g d^3) with the volume q of grains per width and time. The Shields number is the largest Reynolds
stress over (rho_s - rho) g d. Both are means over the second half of the run, +- the standard error of their seconds.

  Meyer-Peter and Mueller (1948):    q* = 8 (theta - 0.047)^1.5
  Wong and Parker (2006):            q* = 4.93 (theta - 0.047)^1.6, the same measurements without the form drag that
                                     1948 took from them"""
import argparse
import os
import subprocess
import tempfile

from from_tests import np

EXAMPLES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "examples")
INPUT = os.path.join(EXAMPLES, "vans_bedload", "in.vans_bedload")
D, THRESHOLD = 0.006, 0.047
SCALE = (1.5 * 9.81 * D**3) ** 0.5


def meyer_peter_mueller(theta):
    return 8.0 * max(theta - THRESHOLD, 0.0) ** 1.5


def wong_parker(theta):
    return 4.93 * max(theta - THRESHOLD, 0.0) ** 1.6


def run(folder, slope, given):
    """Writes series.SLOPE: steps, q, Shields number, .."""
    text = open(INPUT).read()
    where = "solve $(v_every*dt) ${fluid_dt}"
    assert where in text
    if given.fluctuation != "none":
        text = text.replace(where, f"{where} fluctuation {given.fluctuation} 4711 auto")
    with open(os.path.join(folder, "in.bedload"), "w") as f:
        f.write(text)
    values = {"slope": slope, "depth": given.depth, "seconds": given.seconds, "name": slope}
    asked = [word for key, value in values.items() for word in ("-var", key, str(value))]
    subprocess.run(["lmp", "-in", "in.bedload", "-screen", "none", "-log", f"log.{slope}", "-nocite"] + asked,
                   cwd=folder, check=True)


def mean(t, values):
    """Of the second half, with the error by its seconds"""
    parts = [values[(t > s) & (t <= s + 1.0)].mean() for s in np.arange(t[-1] / 2, t[-1] - 0.99)]
    return values[t > t[-1] / 2].mean(), np.std(parts, ddof=1) / len(parts) ** 0.5 if len(parts) > 1 else np.nan


def row(folder, slope):
    series = np.loadtxt(os.path.join(folder, f"series.{slope}"))
    t = series[:, 0] * 4e-5
    (rate, spread), (theta, _) = mean(t, series[:, 1] / SCALE), mean(t, series[:, 2])
    mpm, wp = meyer_peter_mueller(theta), wong_parker(theta)
    over = [f"{rate / law:.2f}" if law > 0.0 else "-" for law in (mpm, wp)]
    print(f"| {slope} | {theta:.3f} | {rate:.3g} +- {spread:.1g} | {mpm:.3g} | {wp:.3g} | {over[0]} | {over[1]} |",
          flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--slopes", type=float, nargs="+", default=[0.015, 0.02, 0.03, 0.04, 0.05, 0.06])
    parser.add_argument("--depth", type=float, default=10.0)
    parser.add_argument("--seconds", type=float, default=16.0)
    parser.add_argument("--fluctuation", default="none")
    parser.add_argument("--reuse")
    given = parser.parse_args()
    columns = ["slope", "Shields number", "q*", "Meyer-Peter and Mueller", "Wong and Parker", "over the first",
               "over the second"]
    print(f"| {' | '.join(columns)} |\n{'|---' * len(columns)}|", flush=True)
    folder = given.reuse or tempfile.mkdtemp(prefix="bedload")
    for slope in given.slopes:
        if not given.reuse:
            run(folder, slope, given)
        row(folder, slope)
    print(f"files: {folder}")


if __name__ == "__main__":
    main()
