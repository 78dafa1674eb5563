#!/usr/bin/env python3
"""2000 spheres of 2 micrometres fall through water onto a floor: a second of theirs without inertia, and how long it would take with it.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/micron_floc)
    run.py --update     also refreshes the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import re
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, dumped, finished, need, options, save, values  # noqa: E402

WEIGHT = 4 / 3 * np.pi * 9.81e-6        # nN, less buoyancy
LONE = WEIGHT / (6 * np.pi) * 1e6       # um/s, settling speed of a lone sphere


def lammps(out, tag, **variables):
    """Rows of the thermo output, seconds of computing, steps"""
    log = out / f"log.{tag}"
    command = ["stdbuf", "-oL", "lmp", "-in", "in.micron_floc", "-log", str(log), "-var", "out", str(out)]
    finished("micron_floc", command + values(variables), HERE)
    text = log.read_text()
    loops = re.findall(r"^Loop time of (\S+) on 1 procs for (\d+) steps.*?^(\S+)% CPU use", text, re.M | re.S)
    seconds = sum(float(t) * float(share) / 100 for t, _, share in loops)       # of the processor
    rows = [[float(w) for w in line.split()] for line in text.splitlines() if re.match(r" +\d+( +[-+.\de]+){6,10} *$", line)]
    return np.array([row for row in rows if len(row) == len(rows[0])]), seconds, sum(int(n) for _, n, _ in loops)


def point_forces(x):
    """Mean settling speed of points of equal weight: their own, and Oseen's tensor of the others"""
    total = 0.0
    for k in range(len(x)):
        r = np.delete(x, k, axis=0) - x[k]
        s = np.linalg.norm(r, axis=1)
        total += 0.75 * (1 / s + r[:, 2]**2 / s**3).sum()
    return LONE * (1 + total / len(x))


def draw(rows, shots, path):
    plt.rcParams.update({"font.size": 10})
    figure, axes = plt.subplots(1, 6, figsize=(12, 3.8), layout="constrained", width_ratios=[1] * 5 + [1.5])
    for axis, (t, x) in zip(axes, shots):
        axis.scatter(x[:, 0], x[:, 2], s=1.2, c=x[:, 1], cmap="viridis", linewidths=0)
        axis.axhline(0, color="black", lw=2)
        axis.set(xlim=(-48, 48), ylim=(-3, 140), aspect="equal", xticks=[], title=f"{t:.2f} s")
        axis.tick_params(labelleft=axis is axes[0])
    axes[0].set_ylabel("height / um")
    axes[-1].plot(rows[:, 1], rows[:, 3])
    axes[-1].set(xlabel="time / s", title="height of the centre / um")
    save(figure, path, 85)


def main():
    given = options(__file__, __doc__)
    out = given.out
    need("lmp")
    inertia, spent, steps = lammps(out, "inertia", inertia="yes")
    step_inertia = spent / steps
    rows, computing, steps = lammps(out, "floc")
    times = dict(zip(rows[:, 0].astype(int), rows[:, 1]))
    whole = [(times[n], x[:, 1:]) for n, x in dumped(out / "spheres") if n in times]
    end = rows[-1, 1]
    draw(rows, [whole[np.argmin([abs(t - s) for t, _ in whole])] for s in (0.0, 0.2, 0.35, 0.8, end)], out / "micron_floc.png")

    falling = rows[:, 2] > 100
    speed = rows[falling][2:].mean(axis=0)[2]
    points = np.mean([point_forces(x[:, :3]) for t, x in whole if t <= rows[falling][-1, 1]][2:])
    with_inertia = step_inertia * end * 1e6 / 0.1
    print(f"  {len(whole[0][1])} spheres; {steps} steps, {computing:.0f} s of the processor for {end:.2f} s")
    print(f"  with inertia {1e3 * step_inertia:.0f} ms a step of 0.1 us: {with_inertia / 86400:.1f} days; ratio {with_inertia / computing:.0f}")
    print(f"  speed {speed:.1f} um/s, lone sphere {LONE:.3f}, point forces {points:.1f}; picture: {out / 'micron_floc.png'}\n")
    c = Checks()
    c.near("settling speed as it falls, um/s", speed, 248.0, 4.0)
    c.within("over the speed of point forces in the same places", speed / points, 0.95, 1.03)
    c.below("largest error figure of a step, in radii", rows[1:, 5].max(), 1e-3)
    c.below("largest overlap of two spheres once it falls, in radii", -rows[1:, 8].min(), 0.02)
    c.below("largest dent of the floor, in radii", rows[:, 4].max(), 0.05)
    c.below("it has come down: height of the centre at the end, um", rows[-1, 3], 15.0)
    c.holds("computing with inertia takes more than a thousand times as long", with_inertia > 1000 * computing)
    if given.update:
        shutil.copy(out / "micron_floc.png", HERE)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
