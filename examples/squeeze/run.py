#!/usr/bin/env python3
"""Two spheres without inertia pressed together, and one falling past the other: with lubrication, without, and exact.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/squeeze)
    run.py --update     also refreshes the picture and the log in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from exact import approach_drag  # noqa: E402
from runs import np, plt, dumped, finished, need, open_axes, options, save, values  # noqa: E402


def squeeze_time(gaps):
    """When a force of 1 on each has closed the gap of 1 to these: the integral of drag/2 over the gap"""
    s = np.linspace(0.0, np.log(gaps.min()), 1201)
    rate = np.array([approach_drag(np.exp(x)) * np.exp(x) / 2 for x in s])
    h = (s[0] - s[1]) / 3
    t = np.concatenate([[0.0], np.cumsum(h * (rate[:-2:2] + 4 * rate[1:-1:2] + rate[2::2]))])
    return np.interp(np.log(gaps), s[::2][::-1], t[::-1])


def lammps(out, tag, **variables):
    """Times, places of both spheres [frames, 2, 3], gaps"""
    command = ["lmp", "-in", str(HERE / "in.squeeze"), "-log", f"log.{tag}", "-var", "path", f"{tag}.path"]
    finished("squeeze", command + values(variables), out)
    steps, rows = zip(*dumped(out / f"{tag}.path"))
    x = np.array(rows)[:, :, 1:4]
    return np.array(steps) * float(variables["step"]), x, np.linalg.norm(x[:, 1] - x[:, 0], axis=1) - 2


def draw(pressed, exact_gap, passed, exact, target):
    open_axes()
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 5), layout="constrained", width_ratios=[1.3, 1])
    left.semilogy(*exact_gap, "k-", lw=1, label="exact (Brenner 1961)")
    for tag, colour, label in (("yes", "C0", "lubrication yes"), ("no", "C3", "lubrication no")):
        t, _, gap = pressed[tag]
        left.semilogy(t[gap > 0], gap[gap > 0], "o", ms=3.5, color=colour, label=label)
        t, x, _ = passed[tag]
        r = x[:, 1] - x[:, 0]
        right.plot(r[:, 0], r[:, 2], "o", ms=3.5, color=colour, label=label)
    left.set(xlabel="time / (6 pi eta a^2 / F)", ylabel="gap / radius", title="Two spheres pressed together",
             ylim=(1e-5, 1.5))
    left.legend()
    angle = np.linspace(-np.pi / 2, np.pi / 2, 200)
    right.fill_betweenx(2 * np.sin(angle), 0 * angle, 2 * np.cos(angle), color="0.92", lw=0)
    right.text(0.1, 0, "overlap", color="0.5", va="center")
    right.plot(exact[:, 3] - exact[:, 1], exact[:, 4] - exact[:, 2], "k-", lw=1, label="exact")
    right.set(xlabel="x / radius", ylabel="z / radius", xlim=(0, 5), ylim=(-4.5, 4.5), aspect="equal",
              title="One that falls past another,\nits centre as seen from that")
    right.legend(loc="upper right")
    save(figure, target)


def main():
    given = options(__file__, __doc__)
    out = given.out
    need("lmp")
    exact = np.loadtxt(HERE / "exact.csv", delimiter=",", skiprows=3)
    pressed, passed = {}, {}
    for tag in ("yes", "no"):
        pressed[tag] = lammps(out, f"squeeze_{tag}", case="squeeze", lubrication=tag, step=0.005, time=3.8, frames=76)
        passed[tag] = lammps(out, f"pass_{tag}", case="pass", lubrication=tag, step=0.01, time=30.0, frames=120)
    far = lammps(out, "pass_far", case="pass", lubrication="yes", range=8, step=0.01, time=30.0, frames=120)
    rough = lammps(out, "rough", case="squeeze", lubrication="yes", floor=1e-2, step=0.005, time=2.6, frames=520)

    t, _, gap = pressed["yes"]
    gaps = np.exp(np.linspace(0, np.log(9e-6), 400))
    times = squeeze_time(gaps)
    wanted = np.exp(np.interp(t, times, np.log(gaps)))
    draw(pressed, (times, gaps), passed, exact, out / "squeeze.png")
    print(f"picture: {out / 'squeeze.png'}\n")

    def off(run):
        return np.abs(run[1][:, :, [0, 2]].reshape(len(exact), 4) - exact[:, 1:]).max()

    def mirrored(run):
        """x where the second sphere is as far below the first as it began above"""
        r = run[1][:, 1] - run[1][:, 0]
        return np.interp(4.0, -r[:, 2], r[:, 0])

    c = Checks()
    c.below("drag of approach at a gap of 1e-4 against its law near contact, 1/(2 gap) + 9/20 ln(1/gap) + 1.346",
            abs(approach_drag(1e-4) / (5000 + 0.45 * np.log(1e4) + 1.346) - 1), 1e-4)
    c.below("pressed together: largest relative error of the gap, down to 1e-5 radii", np.max(np.abs(gap / wanted - 1)),
            2e-3)
    free = pressed["no"][0][np.argmax(pressed["no"][2] < 0)]
    c.within("without lubrication they touch, and go on, at time", free, 1.0, 1.2)
    touch = rough[0][np.argmax(rough[2] < 0)]
    c.within("rough spheres (lubrication_gap 1e-2) touch at time", touch, 2.3, 2.4)
    least = (np.hypot(exact[:, 3] - exact[:, 1], exact[:, 4] - exact[:, 2]) - 2).min()
    c.near("falling past: smallest gap over the exact one", passed["yes"][2].min() / least, 1.0, 0.06)
    c.near("the same with lubrication_range 8", far[2].min() / least, 1.0, 0.01)
    c.below("places of both over 25 radii of fall, off the exact ones by, in radii", off(passed["yes"]), 0.05)
    c.below("the same with lubrication_range 8", off(far), 0.003)
    c.within("without lubrication: smallest gap, an overlap", passed["no"][2].min(), -0.75, -0.65)
    c.near("Stokes flow has no direction of time: sideways distance behind over that before",
           mirrored(passed["yes"]) / 0.8, 1.0, 5e-4)
    if given.update:
        shutil.copy(out / "squeeze.png", HERE)
        shutil.copy(out / "log.pass_yes", HERE / "log.squeeze.1")
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
