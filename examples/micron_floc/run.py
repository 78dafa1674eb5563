#!/usr/bin/env python3
"""2000 spheres of 2 micrometres fall through water towards a floor: a second of theirs without inertia, and how long it
would take with it.

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
    rows = [[float(w) for w in line.split()] for line in text.splitlines()
            if re.match(r" +\d+( +[-+.\de]+){6,10} *$", line)]
    return np.array([row for row in rows if len(row) == len(rows[0])]), seconds, sum(int(n) for _, n, _ in loops)


def point_forces(x, floor=True):
    """Mean settling speed of points of equal weight: their own, Oseen's tensor of the others, and Blake's images of all
    in the floor"""
    total = 0.0
    for k in range(len(x)):
        r = np.delete(x, k, axis=0) - x[k]
        s = np.linalg.norm(r, axis=1)
        total += (1 / s + r[:, 2]**2 / s**3).sum()
        if floor:
            R, product = np.hypot(np.hypot(x[:, 0] - x[k, 0], x[:, 1] - x[k, 1]), x[:, 2] + x[k, 2]), x[:, 2] * x[k, 2]
            z = (x[:, 2] + x[k, 2])**2 / R**2
            total += ((2 * product / R**2 * (1 - 3 * z) - 1 - z) / R).sum()
    return LONE * (1 + 0.75 * total / len(x))


def draw(rows, shots, speeds, path):
    plt.rcParams.update({"font.size": 10})
    figure, axes = plt.subplots(1, 6, figsize=(12, 2.7), layout="constrained", width_ratios=[1] * 5 + [1.6])
    for axis, (t, x) in zip(axes, shots):
        axis.scatter(x[:, 0], x[:, 2], s=1.2, c=x[:, 1], cmap="viridis", linewidths=0)
        axis.axhline(0, color="black", lw=2)
        axis.set(xlim=(-55, 55), ylim=(-3, 110), aspect="equal", xticks=[], title=f"{t:.2f} s")
        axis.tick_params(labelleft=axis is axes[0])
    axes[0].set_ylabel("height / um")
    axes[-1].plot(rows[1:, 1], rows[1:, 2], label="floor in the fluid")
    t, with_floor, without = np.transpose(speeds)
    axes[-1].plot(t, without, "C3--", label="same places, no floor")
    axes[-1].plot(t, with_floor, "k.", label="point forces, floor")
    axes[-1].set(xlabel="time / s", title="mean speed / (um/s)", ylim=(0, 400))
    axes[-1].legend(fontsize=8)
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
    landed = np.interp(-3.0, rows[:, 4] - 1, rows[:, 1])      # the lowest centre at 3 um
    sample = [whole[k] for k in np.unique(np.linspace(0, len(whole) - 1, 10).astype(int))]
    speeds = [(t, point_forces(x[:, :3]), point_forces(x[:, :3], floor=False)) for t, x in sample]
    draw(rows, [whole[np.argmin([abs(t - s) for t, _ in whole])] for s in (0.0, 0.2, 0.4, landed, end)], speeds,
         out / "micron_floc.png")

    falling = [(t, v) for t, v, _ in speeds if 0 < t < landed]
    ratio = [np.interp(t, rows[1:, 1], rows[1:, 2]) / v for t, v in falling]
    with_inertia = step_inertia * end * 1e6 / 0.1
    print(f"  {len(whole[0][1])} spheres; {steps} steps, {computing:.0f} s of the processor for {end:.2f} s; "
          f"it comes to the floor at {landed:.2f} s")
    print(f"  with inertia {1e3 * step_inertia:.0f} ms per step of 0.1 us: {with_inertia / 86400:.1f} days; "
          f"ratio {with_inertia / computing:.0f}")
    for t, v, free in speeds:
        print(f"  {t:.2f} s: speed {np.interp(t, rows[1:, 1], rows[1:, 2]):.1f} um/s, point forces {v:.1f}, "
              f"without floor {free:.1f}; lone {LONE:.3f}")
    print(f"  picture: {out / 'micron_floc.png'}\n")
    c = Checks()
    c.within("speed over that of point forces and their images in the same places, as it falls: least", min(ratio),
             0.96, 1.02)
    c.within("the same, most", max(ratio), 0.98, 1.03)
    c.within("speed at the start over that without floor", speeds[0][1] / speeds[0][2], 0.7, 0.8)
    c.below("largest error figure of a step, in radii", rows[1:, 5].max(), 1e-3)
    c.below("largest overlap of two spheres once it falls, in radii", -rows[1:, 8].min(), 0.02)
    c.below("no sphere touches the floor: largest dent of it, in radii", rows[:, 4].max(), 0.0)
    c.below("it has come down: height of the centre at the end, um", rows[-1, 3], 10.0)
    c.holds("computing with inertia takes more than a thousand times as long", with_inertia > 1000 * computing)
    if given.update:
        shutil.copy(out / "micron_floc.png", HERE)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
