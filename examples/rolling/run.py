#!/usr/bin/env python3
"""A sphere and a rigid chain go down an incline: speed and spin against the gap, with and without the film between them
and the wall.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/rolling)
    run.py --update     also refreshes the picture and the log in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from exact import along_wall, sphere_at_wall  # noqa: E402
from runs import np, plt, dumped, finished, need, open_axes, options, save, values  # noqa: E402

FILM = "lubrication yes lubrication_gap 1e-6"
SLOPE = np.radians(75)
STEP = 0.05
# colour, legend, keywords, further variables
RUNS = {"images": ("C3", "sphere, rotation", "rotation yes", {}),
        "film": ("C0", "sphere, rotation, lubrication", f"rotation yes {FILM}", {}),
        "shell": ("C2", "sphere, multiblob 12, lubrication", f"multiblob 12 {FILM}", {}),
        "log": ("C4", "chain across, multiblob 12, lubrication", f"multiblob 12 {FILM}", dict(n=5, axis="y"))}
# Goldman, Cox & Brenner (1967) near contact: their constants
PUBLISHED = {"parallel": (8 / 15, 0.9588), "coupling": (-1 / 10, 0.1895), "roll": (2 / 5, 0.3817)}


def lammps(out, tag, keywords, **variables):
    """Times, and of the middle sphere gap, places, velocities over the force down the slope, spins over the same"""
    command = ["lmp", "-in", str(HERE / "in.rolling"), "-log", f"log.{tag}", "-var", "path", f"{tag}.path", "-var",
               "model", keywords]
    finished("rolling", command + values(variables), out)
    steps, rows = zip(*dumped(out / f"{tag}.path"))
    rows = np.array(rows)
    middle = rows[:, rows.shape[1] // 2]
    pull = np.sin(np.radians(float(variables.get("slope", 75))))
    return dict(t=STEP * np.array(steps), gap=middle[:, 3] - 1, x=middle[:, 1], U=middle[:, 4] / pull,
                W=middle[:, 8] / pull)


def published(gap):
    functions = {name: slope * np.log(1 / gap) + constant for name, (slope, constant) in PUBLISHED.items()}
    return along_wall(functions, 1.0, 0.0)


def strip(axis, run, apart):
    """The sphere after equal ways, with a spoke that turns as it does"""
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (run["W"][1:] + run["W"][:-1]) * np.diff(run["t"]))]) * np.sin(SLOPE)
    for way in np.arange(0.0, run["x"][-1], apart):
        k = np.argmax(run["x"] >= way)
        x, z = run["x"][k], 1 + run["gap"][k]
        axis.add_patch(plt.Circle((x, z), 1, fc="#cfe3f5", ec="C0", lw=1))
        spoke = np.array([np.sin(angle[k]), np.cos(angle[k])])
        axis.plot(*np.transpose([(x, z), (x, z) + 0.95 * spoke]), color="C3", lw=1.5)
        axis.text(x, -0.35, f"t = {run['t'][k]:.0f}", ha="center", va="top", fontsize=9)
    axis.axhline(0, color="black", lw=2)
    axis.set(aspect="equal", xlim=(-1.5, run["x"][-1] + 1.5), ylim=(-1.1, 3.1))
    axis.axis("off")
    axis.set_title("Down a slope of 75 degrees, seen with the slope laid flat: the sphere slides more than it rolls",
                   fontsize=11)


def draw(runs, exact, path):
    open_axes()
    figure = plt.figure(figsize=(11, 6.6), layout="constrained")
    panels = figure.add_gridspec(2, 2, height_ratios=[1, 2.6])
    strip(figure.add_subplot(panels[0, :]), runs["film"], 2.3)
    left, right = figure.add_subplot(panels[1, 0]), figure.add_subplot(panels[1, 1])
    gap, U, W = exact
    left.semilogx(gap, U, "k-", lw=1, label="exact")
    right.semilogx(gap, W / U, "k-", lw=1, label="exact")
    near = np.geomspace(1e-5, 0.03, 50)
    V, spin = published(near)
    left.semilogx(near, V, "k:", lw=1.5, label="Goldman, Cox & Brenner near contact")
    right.semilogx(near, spin / V, "k:", lw=1.5, label="Goldman, Cox & Brenner near contact")
    for tag, (colour, label, _, _) in RUNS.items():
        run = runs[tag]
        shown = run["gap"] > 0
        marks = dict(color=colour, lw=0, marker="o", markevery=0.05, label=label, ms=8 if tag == "film" else 4,
                     mfc="none" if tag == "film" else None)
        left.semilogx(run["gap"][shown], run["U"][shown], **marks)
        right.semilogx(run["gap"][shown], (run["W"] / run["U"])[shown], **marks)
    left.set(xlabel="gap / radius", ylabel="speed over that of a lone sphere in open fluid", xlim=(1e-4, 1.2),
             ylim=(0, 1.05))
    right.set(xlabel="gap / radius", ylabel="spin times radius over speed", xlim=(1e-4, 1.2), ylim=(0, 0.26))
    right.axhline(0.25, color="0.7", lw=0.8)
    right.text(1.1e-4, 0.251, "1/4: at contact; 1: rolling without slip", color="0.5", va="bottom", fontsize=9)
    left.legend(fontsize=9)
    save(figure, path)


def main():
    given = options(__file__, __doc__)
    out = given.out
    need("lmp")
    runs = {tag: lammps(out, tag, keywords, **more) for tag, (_, _, keywords, more) in RUNS.items()}
    table = sphere_at_wall()
    exact = table["gap"], *along_wall(table, 1.0, 0.0)
    draw(runs, exact, out / "rolling.png")

    def at(tag, gap, what):
        return np.interp(np.log(1 / gap), np.log(1 / runs[tag]["gap"][runs[tag]["gap"] > 0]),
                         runs[tag][what][runs[tag]["gap"] > 0])

    def off(tag, what, known, least):
        gaps = exact[0][(exact[0] > least) & (exact[0] < 0.95)]
        return max(abs(at(tag, g, what) / np.interp(np.log(g), np.log(exact[0]), known) - 1) for g in gaps)

    # a chain that lies along the slope, at rest: exact speeds of data by multipoles
    along = {gap: lammps(out, f"along_{gap}", f"multiblob 12 {FILM}", n=5, axis="x", slope=90, gap=gap, time=0)["U"][0]
             for gap in (0.1, 1.0)}
    print(f"picture: {out / 'rolling.png'}\n")
    c = Checks()
    c.below("rotation, lubrication: speed off the exact one by, gaps of 0.001 to 1", off("film", "U", exact[1], 1e-3),
            1e-4)
    c.below("rotation, lubrication: spin off the exact one by", off("film", "W", exact[2], 1e-3), 5e-4)
    c.below("multiblob 12, lubrication: speed off the exact one by", off("shell", "U", exact[1], 1e-3), 0.005)
    c.below("multiblob 12, lubrication: spin off the exact one by, gaps of 0.001 to 0.3",
            max(abs(at("shell", g, "W") / np.interp(np.log(g), np.log(exact[0]), exact[2]) - 1) for g in exact[0]
                if 1e-3 < g < 0.3), 0.03)
    c.near("rotation, lubrication: speed at a gap of 0.1", at("film", 0.1, "U"), 0.44304988, 1e-5)
    c.near("rotation, lubrication: spin at a gap of 0.1", at("film", 0.1, "W"), 0.02703135, 2e-6)
    c.near("images alone: speed, at a gap of 0.1", at("images", 0.1, "U"), 0.54374313, 2e-5)
    c.near("images alone: spin, at a gap of 0.1", at("images", 0.1, "W"), 0.06403251, 1e-5)
    c.below("Goldman, Cox & Brenner near contact, off at a gap of 0.001 by",
            abs(published(1e-3)[0] / np.interp(-3, np.log10(exact[0]), exact[1]) - 1), 5e-3)
    c.near("the chain along the slope at a gap of 1: speed over the exact one", along[1.0] / (5 * 0.295408), 1.0, 0.005)
    c.near("the chain along the slope at a gap of 0.1: speed over the exact one", along[0.1] / (5 * 0.142117), 1.0,
           0.02)
    if given.update:
        shutil.copy(out / "rolling.png", HERE)
        shutil.copy(out / "log.film", HERE / "log.rolling.1")
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
