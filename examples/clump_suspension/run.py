#!/usr/bin/env python3
"""Rigid rods settle in a periodic box, each of five spheres that are shells of points: streams form, rods turn upright.

    run.py --out DIR              results and picture go to DIR (default: build/examples/clump_suspension); half as
                                  long as the kept picture
    run.py --time 60 --update     as long as that picture, which is refreshed
    run.py --film                 also the film, in DIR; with --update it is refreshed too

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
import film  # noqa: E402
from matplotlib.collections import EllipseCollection  # noqa: E402
from runs import np, plt, dumped, finished, need, options, save, thermo, values  # noqa: E402

RODS, LENGTH, BOX = 80, 5, np.array([28.0, 28.0, 70.0])
SHOWN = (0, 10, 20, 30)
# Drag of a lone rod over that of one sphere, along and across: exact multipoles, as in sedimentation/data
EXACT = {"along": 1.986538, "across": 2.539384}


def scattered(seed=20061, gap=0.1):
    """Spheres [rods, LENGTH, 3] at random places and directions, one rod after the other, without contact"""
    random, rods = np.random.default_rng(seed), np.empty((0, 3))
    while len(rods) < RODS * LENGTH:
        d = random.normal(size=3)
        new = random.uniform(size=3) * BOX + np.outer(2 * np.arange(LENGTH) - LENGTH + 1, d / np.linalg.norm(d))
        r = new[:, None] - rods[None]
        if not (np.linalg.norm(r - BOX * np.rint(r / BOX), axis=2) < 2 + gap).any():
            rods = np.vstack([rods, new])
    return rods.reshape(RODS, LENGTH, 3)


def upright():
    return np.array([[(0.0, 0.0, 2.0 * k) for k in range(LENGTH)]])


def write_data(path, rods):
    x = rods.reshape(-1, 3) % BOX
    rows = "".join(f"{i + 1} 1 {p[0]:.17g} {p[1]:.17g} {p[2]:.17g} 2.0 1.0 {i // LENGTH + 1}\n"
                   for i, p in enumerate(x.tolist()))
    path.write_text(f"rods\n\n{len(x)} atoms\n1 atom types\n\n" +
                    "".join(f"0 {edge:.17g} {c}lo {c}hi\n" for c, edge in zip("xyz", BOX.tolist())) +
                    "\nAtoms\n\n" + rows)


def lammps(out, tag, rods, ranks=1, **variables):
    """Frames [time, rods, LENGTH, (x y z vx vy vz)] and the rows of the log: step, time, speed, error estimate,
    products, residual, not converged, gap"""
    folder = out / tag
    folder.mkdir(exist_ok=True)
    write_data(folder / "rods.data", rods)
    command = ["mpirun", "-np", str(ranks)] if ranks > 1 else []
    said = finished("clump_suspension", command + ["lmp", "-in", "in.clump_suspension", "-log", str(folder / "log"),
                                                   "-nocite"] +
                    values(dict(variables, data=folder / "rods.data", out=folder)), HERE)
    frames = np.array([rows[:, 2:] for _, rows in dumped(folder / "rods")])
    return frames.reshape(len(frames), -1, LENGTH, 6), thermo(said, "Step v_now")


def along(frames):
    """From the first to the last sphere of each rod"""
    d = frames[:, :, -1, :3] - frames[:, :, 0, :3]
    return d - BOX * np.rint(d / BOX)


def alignment(frames):
    """Mean of the squared cosine between rods and the vertical: 1/3 at random"""
    d = along(frames)
    return (d[:, :, 2]**2 / (d**2).sum(axis=2)).mean(axis=1)


def streams(frames):
    """Variance of the vertical velocities of rods over the square of their mean"""
    v = frames[:, :, :, 5].mean(axis=2)
    return v.var(axis=1) / v.mean(axis=1)**2


def rods_of(axis, frame, mean):
    x, v = frame[:, :, :3] % BOX, frame[:, :, 5].mean(axis=1)
    colours = plt.get_cmap("coolwarm_r")(0.5 + (v - mean) / 6.0)
    flat, owner = x.reshape(-1, 3), np.repeat(np.arange(len(frame)), LENGTH)
    near_last = np.argsort(-flat[:, 1])
    axis.add_collection(EllipseCollection(2.0, 2.0, 0.0, units="xy", offsets=flat[near_last][:, [0, 2]],
                                          offset_transform=axis.transData, facecolors=colours[owner[near_last]],
                                          edgecolors="black", linewidths=0.3))
    axis.set(xlim=(0, BOX[0]), ylim=(0, BOX[2]), aspect="equal", xticks=[], yticks=[])


def strip(frames, curve, path):
    figure, axes = plt.subplots(1, len(SHOWN) + 1, figsize=(11, 4.6), layout="constrained",
                                width_ratios=[1] * len(SHOWN) + [2.2])
    for axis, t in zip(axes, (t for t in SHOWN if t < len(frames))):
        rods_of(axis, frames[t], curve["speed"][t] * -1)
        axis.set_title(f"time {t}", fontsize=10)
    curves(axes[-1], curve, len(frames))
    save(figure, path, 85)


def curves(axis, curve, until):
    axis.plot(curve["time"][:until], curve["speed"][:until] / curve["lone"], "C3-",
              label="mean speed / that of a lone rod at random")
    axis.plot(curve["time"][:until], curve["alignment"][:until], "C0-",
              label="mean $\\cos^2$ of the angle to the vertical")
    axis.axhline(1 / 3, color="C0", ls=":", lw=1)
    axis.set(xlabel="time", xlim=(0, curve["time"][-1]), ylim=(0, 1.2))
    axis.legend(fontsize=8, loc="upper left")
    axis.spines[["top", "right"]].set_visible(False)


def moving(frames, curve, path):
    pictures = []
    for k, frame in enumerate(frames):
        figure, (left, right) = plt.subplots(1, 2, figsize=(6.4, 5.6), dpi=80, width_ratios=[1, 1.5])
        figure.subplots_adjust(0.01, 0.1, 0.98, 0.99, wspace=0.14)
        rods_of(left, frame, curve["speed"][k] * -1)
        curves(right, curve, k + 1)
        pictures.append(film.picture(figure))
    film.write(pictures, path, colours=48, each=110)


def main():
    given = options(__file__, __doc__, time=30.0, film=False)
    out, c = given.out, Checks()
    need("lmp", "mpirun")
    for points, limit in ((12, 0.3), (42, 0.1)):
        for name, rods in (("along", upright()), ("across", upright()[:, :, [2, 1, 0]])):
            frames, _ = lammps(out, "lone", rods + 10, sides="m", points=points, time=0.025, frame=0.025,
                               tolerance=1e-6)
            speed = -frames[0, 0, :, 5].mean()
            c.near(f"lone rod, multiblob {points}: drag {name} itself over exact, %",
                   100 * (LENGTH / speed / EXACT[name] - 1), 0, limit)

    rods = scattered()
    first = {points: lammps(out, f"first_{points}", rods, points=points, films=films, time=0.025, frame=0.025,
                            tolerance=1e-4)[0][0]
             for points, films in ((1, "no"), (12, "yes"), (42, "yes"))}
    v = {points: frame[:, :, 3:].reshape(-1, 3) for points, frame in first.items()}
    for points, low, high in ((12, 0, 1.0), (1, 3.0, 30.0)):
        c.within(f"velocities of all spheres at the beginning, {points} points against 42, %",
                 100 * np.linalg.norm(v[points] - v[42]) / np.linalg.norm(v[42]), low, high)

    frames, rows = lammps(out, "rods", rods, time=given.time)
    lone = LENGTH * (1 / EXACT["along"] / 3 + 2 / EXACT["across"] / 3)
    curve = dict(time=rows[:, 1], speed=rows[:, 2], alignment=alignment(frames), lone=lone)
    for k in range(0, len(rows), 5):
        print(f"  time {rows[k, 1]:4.0f}: speed over a lone rod {rows[k, 2] / lone:.3f}, "
              f"alignment {curve['alignment'][k]:.3f}, streams {streams(frames)[k]:.3f}, products {rows[k, 4]:.0f}, "
              f"gap {rows[k, 7]:.3f}")
    bent = np.linalg.norm(along(frames), axis=-1) - 2 * (LENGTH - 1)
    c.below("largest change of the length of a rod, radii", np.abs(bent).max(), 1e-8)
    c.below("steps whose solve did not converge", rows[-1, 6], 0)
    c.below("products of a step, mean after the first", rows[1:, 4].mean(), 9.0)
    c.below("largest overlap, radii", -rows[:, 7].min(), 0.1)
    c.within("alignment at the beginning", curve["alignment"][0], 0.25, 0.42)
    c.within("alignment in the last third", curve["alignment"][-len(rows) // 3:].mean(), 0.4, 0.9)
    two, _ = lammps(out, "two", rods, ranks=2, time=0.25, frame=0.25)
    c.below("2 ranks against 1 at time 0.25, radii",
            np.abs(two[-1] - lammps(out, "one", rods, time=0.25, frame=0.25)[0][-1])[..., :3].max(), 1e-4)
    strip(frames, curve, out / "clump_suspension.png")
    if given.film:
        moving(frames, curve, out / "clump_suspension.gif")
    if given.update:
        for name in ["clump_suspension.png"] + ["clump_suspension.gif"] * given.film:
            shutil.copy(out / name, HERE)
    sys.exit(c.finish())


if __name__ == "__main__":
    main()
