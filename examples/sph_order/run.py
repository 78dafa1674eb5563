#!/usr/bin/env python3
"""Error and seconds of flows with a known solution, for the plain scheme, delta, shift and correction (flows.py); a
table, and a line ok or MISSED for each figure of the README. After: . build/env.sh

    run.py [--quick | --all] [--update]
        unless told the flows that have a figure: 140 s of one core; --quick: the small ones of them, 3 s
        --all, --update: also those that only the table has, such as the plain scheme where it fails: 200 s
"""
import os
import sys

folder = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(folder))
import flows  # noqa: E402
import sph_runs as S  # noqa: E402

DELTA = {"density": "delta 0.1"}
OPTIONS = {"plain": {}, "delta": DELTA, "shift": dict(DELTA, pair="shift yes"),
           "correction": dict(DELTA, pair="correction yes"),
           "correction, cubic spline": dict(DELTA, pair="correction yes", kernel="cubicspline", hdx=1.3),
           "cubic spline": dict(kernel="cubicspline", hdx=1.3),
           "central": dict(DELTA, viscosity="central"),
           "central, shift": dict(DELTA, viscosity="central", pair="shift yes"),
           "two fluids": DELTA, "two fluids, correction": dict(DELTA, pair="correction yes", hdx=1.5)}
ALL = "--all" in sys.argv or "--update" in sys.argv
# flow, options, n, more; figure: at most this (size), or between two; quick
ROWS = [
    ("gresho", "plain", 25, {}, {}, 0), ("gresho", "plain", 50, {}, {}, 0), ("gresho", "delta", 50, {}, {}, 0),
    ("gresho", "shift", 25, {}, {"L1": 0.032}, 1), ("gresho", "shift", 50, {}, {"L1": 0.015}, 0),
    ("gresho", "shift", 100, {}, {"L1": 0.015}, 0), ("gresho", "correction", 25, {}, {"L1": 0.030}, 1),
    ("gresho", "correction", 50, {}, {"L1": 0.006}, 0),
    ("gresho", "correction", 100, {}, {"L1": 0.0013}, 0),
    ("gresho", "correction, cubic spline", 100, {"rough": 0.1}, {"L1": 0.0013}, 0),
    ("taylor_green", "plain", 50, {}, {}, 0), ("taylor_green", "delta", 50, {}, {}, 0),
    ("taylor_green", "shift", 25, {}, {"amplitude": 0.035, "rms": 0.04}, 1),
    ("taylor_green", "shift", 50, {}, {"amplitude": 0.012, "rms": 0.013}, 0),
    ("taylor_green", "correction", 50, {}, {"amplitude": 0.01, "rms": 0.017}, 0),
    ("taylor_green", "correction, cubic spline", 50, {}, {"amplitude": 0.005, "rms": 0.017}, 0),
    ("taylor_green", "correction, cubic spline", 50, {"hdx": 1.2}, {"amplitude": 0.004, "rms": 0.005}, 0),
    ("poiseuille", "cubic spline", 40, {}, {}, 0),
    ("poiseuille", "correction, cubic spline", 10, {}, {"error": 0.02}, 1),
    ("poiseuille", "correction, cubic spline", 20, {}, {"error": 0.007}, 1),
    ("poiseuille", "correction, cubic spline", 40, {}, {"error": 0.0025}, 0),
    ("disk", "delta", 20, {}, {}, 0), ("disk", "central", 20, {}, {"angular momentum - 1": 1e-12}, 1),
    ("disk", "central, shift", 20, {}, {"angular momentum - 1": 1e-4}, 1),
    ("square", "shift", 30, {}, {"angular momentum - 1": 1e-4}, 1),
    ("wave", "delta", 40, {}, {}, 0), ("wave", "central, shift", 40, {},
                                       {"frequency": (0.97, 1.03), "decay": (0.95, 1.05)}, 0),
    ("tank", "plain", 20, {}, {}, 0), ("tank", "delta", 20, {}, {}, 0), ("tank", "shift", 20, {}, {"speed": 0.012}, 0),
    ("tank", "delta", 6, {"dim": 3, "steps": 4000}, {}, 0), ("tank", "shift", 6, {"dim": 3, "steps": 4000}, {}, 0),
    ("tank", "shift", 6, {"dim": 3}, {}, 0),
    ("tank", "shift", 6, {"dim": 3, "alpha": 0.01}, {"speed": 0.012}, 0),
    ("dam_break", "plain", 20, {}, {}, 0), ("dam_break", "delta", 20, {}, {"energy": 1e-9, "lost": 0}, 0),
    ("dam_break", "shift", 20, {}, {"front": (3.62, 3.69), "energy": 1e-9, "in walls": 24, "lost": 0}, 0),
    ("sloshing", "plain", 20, {}, {}, 0), ("sloshing", "shift", 20, {}, {"error": 0.08}, 1),
    ("sloshing", "shift", 40, {}, {}, 0), ("sloshing", "shift", 40, {"hdx": 2.5}, {"error": 0.025}, 0),
    ("sloshing", "shift", 60, {"hdx": 2.5}, {"error": 0.02}, 0),
    ("shear_wave", "plain", 20, {}, {"frequency": (0.98, 1.02)}, 1),
    ("shear_wave", "plain", 20, {"hdx": 2.5}, {"frequency": (0.97, 1.03)}, 1),
    ("two_layers", "two fluids", 20, {"ratio": 2}, {"speed": 0.01, "slope heavy": (0.98, 1.02),
                                                    "slope light": (0.92, 1.08)}, 0),
    ("two_layers", "two fluids", 20, {"ratio": 10}, {"speed": 0.01, "slope heavy": (0.98, 1.02),
                                                     "slope light": (0.92, 1.08)}, 0),
    ("two_layers", "two fluids", 20, {"ratio": 1000}, {"speed": 0.01, "slope heavy": (0.98, 1.02),
                                                       "slope light": (0.92, 1.08)}, 0),
    ("interface", "two fluids", 32, {"ratio": 2}, {"frequency": (0.97, 1.03)}, 0),
    ("interface", "two fluids", 32, {"ratio": 10}, {"frequency": (0.97, 1.03)}, 0),
    ("rayleigh_taylor", "two fluids", 40, {}, {}, 0), ("rayleigh_taylor", "two fluids, correction", 20, {},
                                                       {"rate": (0.88, 0.96)}, 1),
    ("rayleigh_taylor", "two fluids, correction", 40, {}, {"rate": (0.96, 1.01)}, 0),
    ("rayleigh_taylor", "two fluids, correction", 20, {"ratio": 1000, "light": 10}, {"rate": (0.88, 0.96)}, 0),
    ("rayleigh_taylor", "two fluids, correction", 40, {"ratio": 1000, "light": 10}, {"rate": (0.96, 1.01)}, 0),
    ("rayleigh_taylor", "two fluids, correction", 80, {}, {"rate": (0.98, 1.01)}, 0),
]


def main():
    c = S.Checks()
    table = "| flow | options | particles per length | figures | seconds |\n|---|---|---|---|---|\n"
    for name, option, n, more, figures, quick in ROWS:
        if not (quick if S.QUICK else figures or ALL):
            continue
        what = "%s, %s, %d%s" % (name, option, n, "".join(", %s %g" % item for item in more.items()))
        print("[sph_order] " + what, flush=True)
        try:
            got = getattr(flows, name)(n, **dict(OPTIONS[option], **more))
        except flows.BlownUp as why:
            print("[sph_order] blown up: %s" % why, flush=True)
            got = {"blown up": 1, "seconds": 0}
        for figure, limit in figures.items():
            value = float(got.get(figure, "nan"))
            if isinstance(limit, tuple):
                c.within("%s: %s" % (what, figure), value, *limit)
            else:
                c.below("%s: %s" % (what, figure), abs(value) if figure != "energy" else value, limit)
        words = ", ".join("%s %.3g" % (key, value) for key, value in got.items() if key != "seconds")
        table += "| %s%s | %s | %d | %s | %.3g |\n" % (name.replace("_", " "),
                                                       "".join(", %s %g" % item for item in more.items()), option, n,
                                                     words, got["seconds"])
    out = os.path.join(S.RESULTS, "sph_order")
    os.makedirs(out, exist_ok=True)
    S.keep(folder, out, None, table)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
