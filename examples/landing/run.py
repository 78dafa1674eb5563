#!/usr/bin/env python3
"""A sphere falls to a floor: gap against time with the wall's images, with its film, as a shell of points, and exact.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/landing)
    run.py --update     also refreshes the picture and the log in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from exact import sphere_at_wall, wall_drag  # noqa: E402
from runs import np, plt, dumped, finished, need, open_axes, options, save  # noqa: E402

FILM = "lubrication yes lubrication_gap 1e-6"
# colour, legend, keywords
MODELS = {"free": ("C7", "no wall in the fluid", ""),
          "wall": ("C3", "wall zlo 0", "wall zlo 0"),
          "points": ("C1", "wall, multiblob 12", "wall zlo 0 multiblob 12"),
          "film": ("C0", "wall, rotation, lubrication", f"wall zlo 0 rotation yes {FILM}"),
          "shell": ("C2", "wall, multiblob 12, lubrication", f"wall zlo 0 multiblob 12 {FILM}")}
HEIGHTS = np.array([3.0, 2.0, 1.5, 1.1, 1.01])
# of the model's own mobility, 1 - 9/8 s + s^3/2 - s^5/8 with s = a/z, and of the exact one
OF_IMAGES = np.array([2.7806341314, 4.5232388997, 5.6622122889, 6.8907636319, 7.2320841294])
EXACT = np.array([2.7902751, 4.5755874, 5.8482487, 7.9750854, 10.4213978])


def lammps(out, model):
    """Times, heights, speeds"""
    finished("landing", ["lmp", "-in", str(HERE / "in.landing"), "-log", f"log.{model}", "-var", "model",
                         MODELS[model][2], "-var", "path", f"{model}.path"], out)
    steps, rows = zip(*dumped(out / f"{model}.path"))
    rows = np.array(rows)[:, 0]
    return 0.01 * np.array(steps), rows[:, 3], -rows[:, 6], rows


def fall(least):
    """Time and gap of the exact fall from z = 5 to a gap of `least`: the integral of the drag over the gap"""
    s = np.linspace(np.log(4.0), np.log(least), 4801)
    rate = np.array([wall_drag(np.exp(x)) * np.exp(x) for x in s])
    h = (s[0] - s[1]) / 3
    t = np.concatenate([[0.0], np.cumsum(h * (rate[:-2:2] + 4 * rate[1:-1:2] + rate[2::2]))])
    return t, np.exp(s[::2])


def passes(run, heights):
    """Times at which it passes these heights; between two steps the gap falls like an exponential"""
    t, z = run[:2]
    inside = z > 1
    return np.interp(-np.log(heights - 1), -np.log(z[inside] - 1), t[inside])


def draw(runs, exact, path):
    open_axes()
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.6), layout="constrained")
    left.semilogy(*exact, "k-", lw=1, label="exact (Brenner 1961)")
    right.loglog(exact[1], [1 / wall_drag(gap) for gap in exact[1]], "k-", lw=1, label="exact")
    for model, (colour, label, _) in MODELS.items():
        t, z, speed = runs[model][:3]
        shown = z > 1
        marks = dict(color=colour, lw=0, marker="o", label=label, ms=7 if model == "film" else 3.5,
                     mfc="none" if model == "film" else None)
        left.semilogy(t[shown], z[shown] - 1, markevery=25, **marks)
        if model != "free":
            right.loglog(z[shown] - 1, speed[shown], markevery=0.04, **marks)
    left.set(xlabel="time / (6 pi eta a^2 / F)", ylabel="gap / radius", xlim=(0, 15), ylim=(1e-4, 6),
             title="A sphere falls to the floor")
    right.set(xlabel="gap / radius", ylabel="speed over that without floor", xlim=(1e-3, 5), ylim=(1e-3, 1.2),
              title="Its speed")
    left.legend(loc="lower left")
    save(figure, path)


def main():
    given = options(__file__, __doc__)
    out = given.out
    need("lmp")
    runs = {model: lammps(out, model) for model in MODELS}
    exact = fall(1e-5)
    draw(runs, exact, out / "landing.png")
    times = {model: passes(runs[model], HEIGHTS) for model in MODELS if model != "free"}
    for model, t in times.items():
        print(f"  {model:8s} passes z = 3, 2, 1.5, 1.1, 1.01 at " + " ".join(f"{x:.4f}" for x in t))
    print(f"picture: {out / 'landing.png'}\n")

    table = sphere_at_wall()
    c = Checks()
    c.below("Brenner's series against the table of another code",
            np.max([abs(wall_drag(g) / x - 1) for g, x in zip(table["gap"], table["normal"])]), 1e-8)
    c.below("exact times against the printed ones",
            np.max(np.abs(np.interp(-np.log(HEIGHTS - 1), -np.log(exact[1]), exact[0]) - EXACT)), 2e-5)
    c.below("images alone: times off those of its own mobility by", np.max(np.abs(times["wall"] - OF_IMAGES)), 5e-4)
    c.below("rotation, lubrication: times off the exact ones by", np.max(np.abs(times["film"] - EXACT)), 2e-4)
    c.below("multiblob 12, lubrication: times off the exact ones by", np.max(np.abs(times["shell"] - EXACT)), 6e-4)
    t, z = runs["film"][:2]
    c.near("rotation, lubrication: gap at the end over the exact one",
           (z[-1] - 1) / np.exp(np.interp(t[-1], exact[0], np.log(exact[1]))), 1.0, 0.002)
    rows = runs["shell"][3]
    c.below("multiblob 12, lubrication: it falls straight, and turns by itself: largest speed sideways, spin",
            np.max(np.abs(rows[rows[:, 3] > 1][:, [4, 5, 7, 8, 9]])), 1e-3)
    for model, low, high in (("wall", 2.9, 3.5), ("points", 1.5, 2.2)):
        t, z, speed = runs[model][:3]
        fast = np.interp(-1.1, -z, speed) * wall_drag(0.1)
        c.within(f"{model}: speed at a gap of 0.1 over the exact one", fast, low, high)
    c.within("images alone: it goes through the floor at time", np.interp(-1.0, -runs["wall"][1], runs["wall"][0]), 7.2,
             7.35)
    if given.update:
        shutil.copy(out / "landing.png", HERE)
        shutil.copy(out / "log.film", HERE / "log.landing.1")
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
