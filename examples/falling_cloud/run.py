#!/usr/bin/env python3
"""A cloud of spheres falls, with hydrodynamic interactions and without: a moving picture, for the README too.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/falling_cloud)
    run.py --update     also refreshes the picture and the log in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, dumped, finished, need, options, thermo, values  # noqa: E402
import film  # noqa: E402

SPHERES, RADIUS, TIME = 800, 24.0, 4.2
PANELS = {"none": "each sphere alone\n(Stokes drag)", "all": "all spheres feel\neach other"}


def fall(out, interactions, **variables):
    command = ["lmp", "-in", "in.falling_cloud", "-log", f"log.{interactions}", "-nocite"]
    said = finished("falling_cloud",
                    command + values(dict(interactions=interactions, out=".", spheres=SPHERES, R=RADIUS, time=TIME,
                                          **variables)), out)
    return thermo(said, "Step Time v_speed"), [frame[:, 1:] for _, frame in dumped(out / f"film.{interactions}")]


def frame(positions, upper, time):
    """One picture of the film: both clouds at one time, near spheres before far ones. upper: who began in the upper
    half."""
    figure, axes = plt.subplots(1, 2, figsize=(4.6, 5.6), dpi=90, sharey=True)
    figure.subplots_adjust(0.01, 0.01, 0.99, 0.9, wspace=0.02)
    for side, (name, title) in zip(axes, PANELS.items()):
        order = np.argsort(-positions[name][:, 1])
        x, _, z = positions[name][order].T
        side.scatter(x, z, s=9, c=np.where(upper[order], "#e07b1f", "#1f5fa8"), linewidths=0)
        side.set(xlim=(-45, 45), ylim=(-202, 32), xticks=[], yticks=[], aspect="equal")
        side.set_title(title, fontsize=10)
    axes[0].text(-42, -198, f"time {time:.1f} a/U", fontsize=8)
    return film.picture(figure)


def moving(paths, times, path):
    start = paths["all"][0][:, 2]
    pictures = [frame({name: frames[k] for name, frames in paths.items()}, start > start.mean(), time)
                for k, time in enumerate(times)]
    film.write(pictures, path)


def main():
    given = options(__file__, __doc__)
    need("lmp")
    shutil.copy(HERE / "in.falling_cloud", given.out)
    c, rows, paths = Checks(), {}, {}
    for name in PANELS:
        rows[name], paths[name] = fall(given.out, name)
    c.near("each sphere alone: speed of the cloud", rows["none"][-1, 2], 1.0, 1e-9)
    # N point forces spread evenly in a sphere of radius R (Ekiel-Jezewska, Metzger & Guazzelli, Phys. Fluids 18, 038104
    # (2006))
    predicted = 1 + 1.2 * SPHERES / RADIUS
    c.near("all feel each other: speed at first, over that of an even ball of point forces",
           rows["all"][0, 2] / predicted, 1.0, 0.05)
    fallen = {name: table[-1, 3] - table[0, 3] for name, table in rows.items()}
    c.within("all feel each other: how many times farther the cloud has fallen", fallen["all"] / fallen["none"], 40.0,
             42.0)
    moving(paths, rows["all"][:, 1], given.out / "falling_cloud.gif")
    c.below("size of the moving picture, MB", (given.out / "falling_cloud.gif").stat().st_size / 1e6, 2.0)
    c.holds("the moving picture has a frame for each time", film.frames(given.out / "falling_cloud.gif") ==
            len(paths["all"]))
    if given.update:
        shutil.copy(given.out / "falling_cloud.gif", HERE)
        shutil.copy(given.out / "log.all", HERE / "log.falling_cloud.1")
    sys.exit(c.finish())


if __name__ == "__main__":
    main()
