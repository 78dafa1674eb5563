#!/usr/bin/env python3
"""Seconds against error of pair_style sph/artVisc/tensCorr: the plain scheme, delta, shift and correction in four flows
of ../sph_order (flows.py), each at several resolutions. A table and a picture. After: . build/env.sh

    sph.py [--quick] [--update]        --quick: the coarse ones; all of them take three minutes

Ends with a line ok or MISSED for each statement of the README, and exits with 1 when one is missed.
"""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.dirname(HERE), os.path.join(os.path.dirname(HERE), "sph_order")]
import flows  # noqa: E402
import sph_runs as S  # noqa: E402

DELTA = {"density": "delta 0.1"}
OPTIONS = {"plain": {}, "delta": DELTA, "shift": dict(DELTA, pair="shift yes"),
           "correction": dict(DELTA, pair="correction yes")}
# The cubic spline, which shift refuses, is where a channel needs correction: with Wendland's kernel, h = 2 spacings,
# all are alike.
SPLINE = {"kernel": "cubicspline", "hdx": 1.3}
COLOR = {"plain": "C7", "delta": "C0", "shift": "C1", "correction": "C3"}
# A free surface has no correction.
FLOWS = [
    ("gresho", "Gresho's vortex: mean error of the velocity", (25, 50, 100), list(OPTIONS), lambda got, n: got["L1"]),
    ("poiseuille", "Poiseuille, cubic spline (shift: Wendland): largest error", (10, 20, 40), list(OPTIONS),
     lambda got, n: got["error"]),
    ("tank", "still tank, jittered, 10^4 steps: largest speed / sqrt(gH)", (10, 20), ["plain", "delta", "shift"],
     lambda got, n: got["speed"]),
    ("dam_break", "dam break: energy gained, particles in walls or lost, shares", (10, 20, 30),
     ["plain", "delta", "shift"], lambda got, n: max(got["energy"], 0.0) + (got["in walls"] + got["lost"]) /
     (2 * n * n)),
]


def measure():
    """Rows (flow, option, n, error, seconds); a run that blew up has the error nan."""
    rows = []
    for name, _, sizes, options, error in FLOWS:
        for n in sizes[:1] if S.QUICK else sizes:
            for option in options:
                print("[speed_error] %s, %s, %d" % (name, option, n), flush=True)
                more = SPLINE if name == "poiseuille" and option != "shift" else {}
                try:
                    got = getattr(flows, name)(n, **OPTIONS[option], **more)
                except flows.BlownUp as why:
                    print("[speed_error] blown up: %s" % why, flush=True)
                    got = None
                rows.append((name, option, n, *((error(got, n), got["seconds"]) if got else (float("nan"),) * 2)))
    return rows


def table(rows):
    lines = ["| flow | particles per length | " + " | ".join("%s: error, s" % o for o in OPTIONS) + " |",
             "|---|---|" + "---|" * len(OPTIONS)]
    for name, _, sizes, _, _ in FLOWS:
        for n in sizes:
            cells = {o: "%.3g, %.2g" % (e, t) if e == e else "blown up" for flow, o, m, e,
                     t in rows if (flow, m) == (name, n)}
            if cells:
                lines.append("| %s | %d | %s |" % (name.replace("_", " "), n,
                                                   " | ".join(cells.get(o, "") for o in OPTIONS)))
    return "\n".join(lines) + "\n"


def picture(rows, path):
    figure, axes = S.pyplot().subplots(2, 2, figsize=(9, 6.6))
    for ax, (name, title, _, options, _) in zip(axes.flat, FLOWS):
        for option in options:
            points = [(t, e) for flow, o, _, e, t in rows if (flow, o) == (name, option)]    # nan: not drawn
            ax.loglog(*zip(*points), "o-", color=COLOR[option], label=option)
        ax.set(title=title, xlabel="seconds", ylabel="error")
        ax.title.set_fontsize(9)
    axes[0, 0].legend()
    figure.tight_layout()
    figure.savefig(path)


def check(c, rows):
    error = {(name, option, n): e for name, option, n, e, _ in rows}
    for name, best, rival, limit in (("gresho", "correction", "plain", 0.05),
                                     ("poiseuille", "correction", "plain", 0.2),
                                     ("tank", "shift", "delta", 0.3)):
        n = max(n for flow, o, n in error if flow == name)
        c.below("%s, n = %d: error of %s over %s" % (name, n, best, rival),
                error[name, best, n] / error[name, rival, n],
                1.0 if S.QUICK else limit)


def main():
    c, rows = S.Checks(), measure()
    out = os.path.join(S.RESULTS, "speed_error")
    os.makedirs(out, exist_ok=True)
    picture(rows, os.path.join(out, "sph.png"))
    check(c, rows)
    S.keep(HERE, out, "sph.png", table(rows), "sph.md")
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
