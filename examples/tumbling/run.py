#!/usr/bin/env python3
"""Lets straight chains tumble in a shear flow with in.tumbling and compares the periods with Jeffery's and exact
values.

    run.py --out DIR    curves and the picture go to DIR (default: build/examples/tumbling)
    run.py --quick      two ranks for a hundredth of the way
    run.py --update     also refreshes the picture and the logs in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, TOP, finished, need, open_axes, options  # noqa: E402

# Effective aspect ratios of chains of touching spheres in exact Stokes flow (Lamb's multipole solution, computed
# independently of the plugin's code, 1e-8); the period is 2 pi (re + 1/re)/shear rate (Jeffery 1922; Bretherton 1962).
EXACT = {2: 1.981649, 5: 4.491020, 10: 8.289892}
PERIOD_LIMIT = 0.005                # relative
CURVE_LIMIT = 0.2                   # degrees, against the closed form with the measured period


def period_of(re):
    return 2 * np.pi * (re + 1 / re)


def aspect_ratio(period):
    """re > 1 of a period, shear rate 1."""
    h = period / (4 * np.pi)
    return h + np.sqrt(h * h - 1)


def jeffery(re, t, phi0):
    """Angle of the axis from the gradient direction z towards the flow direction x, projected on their plane, at times
    t."""
    tau = np.arctan2(np.sin(phi0) / re, np.cos(phi0)) + t * re / (re * re + 1)
    return phi0 + np.unwrap(np.arctan2(re * np.sin(tau), np.cos(tau))) - np.arctan2(re * np.sin(tau[0]), np.cos(tau[0]))


def tilt_of_orbit(re, phi, constant):
    """Angle of the axis to the vorticity direction y on the orbit of this constant, degrees."""
    return np.degrees(np.arctan(constant * re / np.sqrt((re * np.cos(phi))**2 + np.sin(phi)**2)))


class Case:
    """part: of the way that it takes to measure a period"""

    def __init__(self, n, tilt=0, shell=42, ranks=1, images=False, part=1.0):
        self.n, self.tilt, self.shell, self.ranks, self.images, self.part = n, tilt, shell, ranks, images, part
        self.tag = f"chain{n}_{tilt}_{shell}_{ranks}"
        self.label = ("doublet" if n == 2 else f"chain of {n}") + (f", axis tilted by {tilt} degrees" if tilt else "")
        self.label += f", shell {shell}" if shell != 42 else ""
        self.label += f", {ranks} ranks" if ranks > 1 else ""

    def run(self, out):
        curve, log = out / f"{self.tag}.curve", out / f"{self.tag}.log"
        command = ["stdbuf", "-oL", "lmp", "-in", "in.tumbling", "-log", str(log), "-var", "n", str(self.n), "-var",
                   "tilt", str(self.tilt), "-var", "shell", str(self.shell), "-var", "curve", str(curve),
                   "-var", "turns", str(1.3 * self.part)]
        if self.images:
            command += ["-var", "image", str(out / self.tag)]
        if self.ranks > 1:
            command = ["mpirun", "-np", str(self.ranks)] + command
        finished("tumbling", command, HERE)
        self.t, x, y, z = np.loadtxt(curve).T
        self.axis = np.stack((x, y, z), axis=1) / np.sqrt(x * x + y * y + z * z)[:, None]
        if self.part == 1.0:
            self.measure(x, z)
        return self

    def measure(self, x, z):
        self.phi = np.unwrap(np.arctan2(x, z))
        self.theta = np.degrees(np.arccos(self.axis[:, 1]))
        # From a quarter of a right angle on, when the start from rest is forgotten, until the axis is there again.
        start, end = (np.interp(angle, self.phi, self.t) for angle in (np.pi / 8, np.pi / 8 + 2 * np.pi))
        self.period = end - start
        self.re = aspect_ratio(self.period)
        self.error = self.period / period_of(EXACT[self.n]) - 1
        # The closed form, with the aspect ratio of this period, through the point where the measurement starts
        late = self.t >= start
        closed = jeffery(self.re, np.concatenate(([0.0], self.t[late] - start)), np.pi / 8)[1:]
        self.deviation = np.degrees(np.abs(closed - self.phi[late]).max())
        if self.tilt:
            constant = np.tan(np.radians(self.theta[0])) / self.re * np.sqrt((self.re * np.cos(self.phi[0]))**2
                                                                           + np.sin(self.phi[0])**2)
            self.theta_closed = tilt_of_orbit(self.re, self.phi, constant)
            self.drift = np.abs(self.theta - self.theta_closed).max()


def draw(done, out, path):
    open_axes()
    chains = [c for c in done if c.tilt == 0 and c.ranks == 1 and c.shell == 42]
    figure = plt.figure(figsize=(12, 6.6), layout="constrained")
    grid = figure.add_gridspec(2, 9, height_ratios=[3, 1])
    axis = figure.add_subplot(grid[0, :])
    for c, colour in zip(chains, ("C0", "C1", "C2")):
        half = period_of(EXACT[c.n]) / 2
        t = np.linspace(0, c.t[-1], 2000)
        axis.plot(t / half, np.degrees(jeffery(EXACT[c.n], t, 0.0)), "-", color=colour, lw=1.3,
                  label=f"{c.label}: Jeffery, exact aspect ratio {EXACT[c.n]:.4f}")
        pick = np.searchsorted(c.t, np.linspace(0, 1.25 * 2 * half, 61)[:-1])
        axis.plot(c.t[pick] / half, np.degrees(c.phi[pick]), "o", color=colour, ms=4.5, mec="black", mew=0.4,
                  label=f"{c.label}: run, period {c.period:.4f}, exact {period_of(EXACT[c.n]):.4f}")
    axis.set_xlabel("time / exact half period")
    axis.set_ylabel("angle of the axis from the gradient direction, degrees")
    axis.set_yticks(range(0, 541, 90))
    axis.set_xlim(0, 2.5)
    axis.set_ylim(0, 470)
    axis.grid(alpha=0.3)
    axis.legend(fontsize=9, loc="upper left")
    axis.set_title("Straight chains of touching spheres in simple shear: long near the flow direction, quick across it")
    images = sorted(out.glob("chain5_0_42_1.*.ppm"))[:9]
    for k, image in enumerate(images):
        cell = figure.add_subplot(grid[1, k])
        cell.imshow(plt.imread(image))
        cell.set_xticks([])
        cell.set_yticks([])
        for side in cell.spines.values():
            side.set_visible(False)
        cell.set_title(f"{k}/16 period", fontsize=9)
    figure.savefig(path, dpi=90, pil_kwargs={"optimize": True})
    plt.close(figure)


# The table of the README: period of a chain, and how near to it this machine's arithmetic must come
PERIODS = {(2, 42): 15.6159, (5, 42): 29.5516, (10, 42): 52.6835, (5, 12): 29.7735, (5, 1): 28.7687}


def check(done):
    c = Checks()
    one = {(run.n, run.tilt, run.shell): run for run in done if run.ranks == 1}
    for run in done:
        if run.ranks == 2:
            alone = one[run.n, run.tilt, run.shell]
            _, here, there = np.intersect1d(run.t, alone.t, return_indices=True)
            c.below(f"{run.label}: change of the axis against 1", np.abs(run.axis[here] - alone.axis[there]).max(),
                    1e-8)
        if run.part < 1.0:
            continue
        c.near(f"{run.label}: period", run.period, PERIODS[run.n, run.shell], 3e-4)
        if run.shell != 1:      # a point is no sphere
            limit = PERIOD_LIMIT if run.shell == 42 else 0.015
            c.near(f"{run.label}: period over the exact {period_of(EXACT[run.n]):.4f}", run.error + 1.0, 1.0, limit)
        if run.shell == 42:
            c.below(f"{run.label}: degrees from Jeffery's closed form for its own aspect ratio {run.re:.4f}",
                    run.deviation,
                    CURVE_LIMIT)
        if run.tilt:
            c.below(f"{run.label}: degrees from its orbit", run.drift, CURVE_LIMIT)
    c.near("chain of 5, shell 1: period over that of a dense solution of its model", one[5, 0, 1].period / 28.76868,
           1.0, 1e-3)
    return c.finish()


def main():
    given = options(__file__, __doc__, quick=False)
    out = given.out
    need("lmp", "mpirun")
    for image in out.glob("chain*.ppm"):
        image.unlink()

    start = time.time()
    done = []
    for case in (Case(2), Case(5, images=True), Case(10), Case(5, tilt=45),
                 Case(5, ranks=2, part=0.01 if given.quick else 1.0),
                 Case(5, shell=12), Case(5, shell=1)):
        done.append(case.run(out))
        if case.part < 1.0:
            continue
        print(f"  {case.label}: period {case.period:.5f}, exact {period_of(EXACT[case.n]):.5f}, "
              f"{100 * case.error:+.3f} %; effective aspect ratio {case.re:.5f}", flush=True)
    draw(done, out, out / "tumbling.png")
    if given.update:
        shutil.copy(out / "tumbling.png", HERE)
        for ranks in (1, 2):
            log = (out / f"chain5_0_42_{ranks}.log").read_text().replace(str(out) + "/", "").replace(str(TOP) + "/", "")
            (HERE / f"log.tumbling.{ranks}").write_text(log)
    print(f"{len(done)} runs in {time.time() - start:.0f} s; picture: {out / 'tumbling.png'}\n")
    return check(done)


if __name__ == "__main__":
    sys.exit(main())
