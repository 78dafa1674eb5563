#!/usr/bin/env python3
"""Lets a ball of 100 000 spheres fall with in.cloud_100000 and draws the film.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/cloud_100000)
    run.py --update     also refreshes the logs and the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import re
import shutil
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, dumped, finished, need, options, values  # noqa: E402


def lammps(out, log, ranks, **variables):
    """Speed of the ball in the end and that of a ball of point forces; seconds of the last run."""
    shutil.copy(HERE / "in.cloud_100000", out)
    (out / "out").mkdir(exist_ok=True)
    command = ["mpirun", "-np", str(ranks), "lmp", "-in", "in.cloud_100000", "-log", log, "-nocite"]
    start = time.time()
    said = finished("cloud_100000", command + values(variables), out)
    print(f"[{log}, {ranks} rank{'s' if ranks > 1 else ''}] {time.time() - start:.0f} s", flush=True)
    return [float(word) for word in re.search("^settling (.*) predicted (.*)$", said, re.M).groups()]


def frames(out):
    """id x y z vz of every sphere, frame by frame"""
    return [rows for _, rows in dumped(out / "out" / "film")]


def film_strip(film, R, path):
    fig, axes = plt.subplots(1, len(film), figsize=(12.0, 4.4), dpi=90, layout="constrained", sharey=True)
    for ax, rows in zip(axes, film):
        slab = rows[np.abs(rows[:, 2]) < 0.08 * R]
        shown = ax.scatter(slab[:, 1] / R, slab[:, 3] / R, c=-slab[:, 4], s=0.5, cmap="viridis", vmin=600, vmax=1200,
                           linewidths=0)
        ax.set(aspect="equal", xlim=(-1.25, 1.25), ylim=(-3.2, 1.2), xticks=[])
    axes[0].set_ylabel("height / radius of the ball")
    fig.colorbar(shown, ax=axes, label="speed / that of a lone sphere", shrink=0.7)
    fig.savefig(path)
    plt.close(fig)


def main():
    given = options(__file__, __doc__)
    out = given.out
    need("lmp", "mpirun")
    c = Checks()

    # A fifth of it, at once: against the sum over all pairs, and on 1 rank against 2
    found = {}
    for name, ranks, words in (("direct", 2, dict(far_field="direct")), ("ewald", 2, dict(far_field="ewald")),
                               ("one", 1, dict(far_field="ewald"))):
        lammps(out, f"log.{name}", ranks, spheres=20000, steps=1, frames=1, falls=1e-6, **words)
        found[name] = frames(out)[0][:, 4]
    scale = np.sqrt(np.mean(found["direct"]**2))
    c.below("20 000 spheres: rms error of their speed, far_field_tolerance 1e-3, over its rms",
            np.sqrt(np.mean((found["ewald"] - found["direct"])**2)) / scale, 1e-4)
    c.below("20 000 spheres: 1 rank against 2", np.abs(found["one"] - found["ewald"]).max() / scale, 1e-6)

    lammps(out, "log.cloud_100000.1", 1, steps=1, frames=1, falls=0.05)
    speed, predicted = lammps(out, "log.cloud_100000.2", 2)
    film = frames(out)
    R = (100000 / 0.05)**(1 / 3)
    c.near("speed of the ball at first, in that of point forces in a ball", -film[0][:, 4].mean() / predicted, 1.0,
           0.01)
    c.near("the same in the end", speed / predicted, 1.0, 0.02)
    c.within("height that it has fallen, in its radii", (film[0][:, 3].mean() - film[-1][:, 3].mean()) / R, 1.9, 2.05)
    inside = np.linalg.norm(film[-1][:, 1:4] - film[-1][:, 1:4].mean(axis=0), axis=1) < 1.1 * R
    c.within("spheres that have stayed within 1.1 radii of its centre", inside.mean(), 0.95, 1.0)
    film_strip([film[k] for k in (0, 2, 4, 6, 8)], R, out / "cloud_100000.png")
    if given.update:
        for name in ("cloud_100000.png", "log.cloud_100000.1", "log.cloud_100000.2"):
            shutil.copy(out / name, HERE)
    sys.exit(c.finish())


if __name__ == "__main__":
    main()
