#!/usr/bin/env python3
"""10 000 spheres settle onto a floor, in a cell that repeats along it (in.settling_layer): a strip of pictures, and the
structure against time.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/settling_layer)
    run.py --quick      400 spheres in place of 10 000: seconds
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
from runs import np, plt, dumped, finished, need, open_axes, options, save, values  # noqa: E402

SPACING, STEP, K = 3.0, 0.05, 12.0
EARLY, FIRST = 2.0, 1.5         # until here speeds are those of the beginning; a centre below is in the first layer


def scatter(path, n, rows):
    """In planes of a square lattice, each shifted at random, at random within a third of its spacing. Returns the side
    of the cell."""
    rng, L, k = np.random.default_rng(5), SPACING * rows, np.arange(n)
    x = np.column_stack([k % rows + 0.5, k // rows % rows + 0.5, k // rows**2 + 0.54]) * SPACING + rng.uniform(
        -0.45, 0.45, (n, 3))
    x[:, :2] = (x[:, :2] + rng.uniform(0, L, (n // rows**2 + 1, 2))[k // rows**2]) % L
    with open(path, "w") as data:
        data.write(f"spheres\n\n{n} atoms\n1 atom types\n0 {L} xlo xhi\n0 {L} ylo yhi\n"
                   f"-2 {x[:, 2].max() + 5} zlo zhi\n\nAtoms\n\n")
        data.write("".join("{} 1 2 1 {:.10g} {:.10g} {:.10g}\n".format(i + 1, *p) for i, p in enumerate(x)))
    return L


def settle(out, n, rows, steps):
    """Frames (time, places), thermo rows (time, mean height, mean speed down, lowest centre, largest move of a step),
    side of the cell"""
    L = scatter(out / "spheres.data", n, rows)
    finished("settling_layer", ["lmp", "-in", str(HERE / "in.settling_layer"), "-log", "log.settling"] + values(
        dict(spheres=out / "spheres.data", steps=steps, step=STEP, out="settling.places")), out)
    frames = [(STEP * step, rows[:, 1:4]) for step, rows in dumped(out / "settling.places")]
    thermo = [[float(w) for w in line.split()] for line in (out / "log.settling").read_text().splitlines()
              if re.match(r" *\d+( +-?[\d.]+(e-?\d+)?){4} *$", line)]
    thermo = np.array(thermo) * (STEP, 1, -1, 1, 1)
    return frames, thermo, L


def fraction_at(x, L, bins):
    """Volume fraction of slices: of each sphere the part that is in them"""
    def below(z):       # of a sphere at height 0, of unit radius: its volume below z
        z = np.clip(z, -1, 1)
        return np.pi * (2 / 3 + z - z**3 / 3)
    parts = below(bins[:, None] - x[:, 2])
    return np.diff(parts, axis=0).sum(axis=1) / (L * L * np.diff(bins))


def draw(frames, thermo, L, path):
    open_axes()
    figure = plt.figure(figsize=(11, 6.6), layout="constrained")
    upper, lower = figure.subfigures(2, 1, height_ratios=[1.25, 1])
    top, wide = max(x[:, 2].max() for _, x in frames) + 1, min(L, 50.0)
    panels = upper.subplots(2, 4, height_ratios=[top, wide])
    for k in range(4):
        t, x = frames[[0, len(frames) // 8, len(frames) // 3, len(frames) - 1][k]]
        side, above = panels[:, k]
        for panel, (i, j), shown in ((side, (0, 2), x[(x[:, 1] < 8) & (x[:, 0] < wide)]),
                                     (above, (0, 1), x[(x[:, 0] < wide) & (x[:, 1] < wide)])):
            shown = shown[np.argsort(-shown[:, 1] if panel is side else shown[:, 2])]
            panel.add_collection(plt.matplotlib.collections.PatchCollection([plt.Circle(p[[i, j]], 1) for p in shown],
                                                                            lw=0.2, edgecolors="k",
                                                                            facecolors=plt.cm.viridis(
                                                                                np.clip((shown[:, 2] - 1) / 8, 0, 1))))
            panel.set(aspect="equal", xticks=[], yticks=[], xlim=(0, wide), ylim=(0, top if panel is side else wide))
            panel.spines["left"].set_visible(False)
        side.set_title(f"t = {t:.0f}")
    profile, layer, speed = lower.subplots(1, 3)
    bins = np.arange(0, top + 0.25, 0.25)
    for k, colour in zip((0, len(frames) // 8, len(frames) // 3, len(frames) - 1), ("C7", "C1", "C2", "C0")):
        profile.plot(fraction_at(frames[k][1], L, bins), 0.5 * (bins[1:] + bins[:-1]), color=colour,
                     label=f"t = {frames[k][0]:.0f}")
    profile.set(xlabel="volume fraction", ylabel="height / radius", xlim=(0, 0.8), title="profile")
    profile.legend(frameon=False)
    layer.plot([t for t, _ in frames], [np.pi * (x[:, 2] < FIRST).sum() / L**2 for t, x in frames],
               label="lowest layer")
    layer.set(xlabel="time", ylabel="area fraction", ylim=(0, 0.9), title="lowest layer (centres below 1.5)")
    speed.plot(thermo[1:, 0], thermo[1:, 2])
    speed.set(xlabel="time", ylabel="mean / that of a lone sphere", ylim=(0, None), title="speed downwards")
    save(figure, path)


def main():
    given = options(__file__, __doc__, quick=False)
    need("lmp")
    frames, thermo, L = settle(given.out, *((400, 10, 1000) if given.quick else (10000, 50, 800)))
    draw(frames, thermo, L, given.out / "settling_layer.png")
    print(f"picture: {given.out / 'settling_layer.png'}\n")
    x = frames[-1][1]
    layer = np.array([np.pi * (y[:, 2] < FIRST).sum() / L**2 for _, y in frames])
    on_floor = K * np.maximum(0, 1 - x[:, 2]).sum() / len(x)
    c = Checks()
    early = thermo[(thermo[:, 0] > 0) & (thermo[:, 0] <= EARLY), 2]
    c.within("mean speed in the beginning over that of a lone sphere", early.mean(), 0.15, 0.35)
    c.near("nobody comes or goes: spheres in each frame", min(len(y) for _, y in frames), len(x), 0)
    c.near("at the end: force on the floor over the weight of all", on_floor, 1.0, 0.1)
    c.below("at the end: mean speed", abs(thermo[-1, 2]), 0.03)
    c.within("at the end: area fraction of the lowest layer", layer[-1], 0.6, 0.9)
    c.holds("the lowest layer fills up: a third, two thirds of the run, its end", layer[0] < layer[len(layer) // 3] <=
            layer[-1] + 0.02)
    c.within("deepest dent in the floor, radii", 1 - thermo[-1, 3], 0.03, 0.35)
    if given.update:
        shutil.copy(given.out / "settling_layer.png", HERE)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
