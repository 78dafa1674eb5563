#!/usr/bin/env python3
"""30 rigid chains of five spheres fall without inertia, as all feel each other and each as if it were alone; a film of
both.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/falling_clumps)
    run.py --update     also refreshes the pictures in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
import film  # noqa: E402
from runs import np, plt, dumped, finished, need, options, save, values  # noqa: E402

SHOWN = (0, 2, 4, 6, 8, 10, 12)
FINE = 5    # frames of the film per time


def lammps(out, tag, ranks=1, **variables):
    """Frames [time, spheres, (molecule x y z vx vy vz)] and the curve: time, speed, centre, products, not converged,
    gap"""
    (out / tag).mkdir(parents=True, exist_ok=True)
    for name in ("in.falling_clumps", "chain5.mol"):
        shutil.copy(HERE / name, out / tag)
    command = ["mpirun", "-np", str(ranks)] if ranks > 1 else ["stdbuf", "-oL"]
    command += ["lmp", "-in", "in.falling_clumps", "-var", "out", "."]
    finished("falling_clumps", command + values(variables), out / tag)
    only = variables.get("only", "no")
    frames = np.array([rows[:, 1:] for _, rows in dumped(out / tag / f"spheres.{only}")])
    return frames, np.loadtxt(out / tag / f"curve.{only}", ndmin=2)[:, 1:]


def point_forces(spheres, own):
    """Mean settling speed of points of weight 5 in the places of the clumps: their own speed, and Oseen's tensor of the
    others"""
    c = spheres[:, 1:4].reshape(-1, 5, 3).mean(axis=1)
    r = c[:, None] - c[None]
    s = np.linalg.norm(r, axis=2)
    np.fill_diagonal(s, np.inf)
    return own + 5.0 * 0.75 * (1 / s + r[:, :, 2]**2 / s**3).sum() / len(c)


def bend(frames):
    """Largest deviation of a distance within a chain from what it was"""
    x = frames[:, :, 1:4].reshape(len(frames), -1, 5, 3)
    ends = np.linalg.norm(x[:, :, 4] - x[:, :, 0], axis=-1), np.linalg.norm(x[:, :, 2] - x[:, :, 0], axis=-1)
    return max(np.abs(d - exact).max() for d, exact in zip(ends, (8.0, 4.0)))


def strip(rows, path):
    figure, axes = plt.subplots(len(rows), len(SHOWN), figsize=(11, 5.2), layout="constrained", sharey="row")
    for row, (title, frames) in zip(axes, rows):
        for axis, t in zip(row, SHOWN):
            x, y, z = frames[t, :, 1:4].T
            middle = z.mean()
            for k in np.argsort(-y):
                axis.add_patch(plt.Circle((x[k], z[k] - middle), 1.0, fc=f"C{int(frames[t, k, 0]) % 10}", ec="black",
                                          lw=0.3))
            axis.set(xlim=(-20, 20), ylim=(-20, 20), aspect="equal", xticks=[], yticks=[])
            axis.set_xlabel(f"{-middle:.0f} below" if t else "")
            if row[0] is axes[0, 0]:
                axis.set_title(f"time {t}", fontsize=10)
        row[0].set_ylabel(title)
    save(figure, path, 85)


def moving(rows, path):
    """Both clouds side by side, each seen from its centre."""
    pictures = []
    for k in range(len(rows[0][1])):
        figure, axes = plt.subplots(1, 2, figsize=(6.2, 3.5), dpi=80)
        figure.subplots_adjust(0.01, 0.02, 0.99, 0.88, wspace=0.03)
        for axis, (title, frames) in zip(axes, rows):
            x, y, z = frames[k, :, 1:4].T
            for i in np.argsort(-y):
                axis.add_patch(plt.Circle((x[i], z[i] - z.mean()), 1.0, fc=f"C{int(frames[k, i, 0]) % 10}", ec="black",
                                          lw=0.3))
            axis.set(xlim=(-20, 20), ylim=(-20, 20), aspect="equal", xticks=[], yticks=[])
            axis.set_title(f"{title}, {-z.mean():.0f} radii below", fontsize=9)
        pictures.append(film.picture(figure))
    film.write(pictures, path, colours=32)


def main():
    given = options(__file__, __doc__)
    out = given.out
    need("lmp", "mpirun")
    together, curve = lammps(out, "together", frame=1 / FINE)
    alone, lonely = lammps(out, "alone", only="yes", frame=1 / FINE)
    moving((("all feel each other", together), ("each alone", alone)), out / "falling_clumps.gif")
    together, alone = together[::FINE], alone[::FINE]
    exact, _ = lammps(out, "exact", tolerance="1e-10", time=0.01, frame=0.01)
    fine, _ = lammps(out, "fine", step=0.005)
    two, _ = lammps(out, "two_ranks", ranks=2, time=1.0)
    strip((("all feel each other", together), ("each alone", alone)), out / "falling_clumps.png")

    at_rest = slice(1, 6)       # of the curve: before much has changed; its first row is of no velocities yet
    speed, own = curve[at_rest, 1].mean(), lonely[at_rest, 1].mean()
    points = point_forces(together[0], own)
    v, v_exact = together[0, :, 4:], exact[0, :, 4:]
    print(f"  speed {speed:.3f}, each alone {own:.4f}, point forces {points:.3f}; "
          f"products per step {curve[:, 3].mean():.2f}")
    print(f"picture: {out / 'falling_clumps.png'}\n")
    c = Checks()
    c.near("speed as all feel each other, in that of a lone sphere", speed, 14.55, 0.05)
    c.near("speed with clumps_only yes", own, 2.2276, 0.002)
    c.near("how often faster", speed / own, 6.53, 0.05)
    c.within("over the speed of point forces in the same places", speed / points, 0.9, 1.02)
    c.near("speed at the end", curve[-5:, 1].mean(), 13.93, 0.2)
    c.below("error of the velocities at relative_tolerance 1e-3, of the largest",
            np.abs(v - v_exact).max() / np.abs(v_exact).max(), 3e-4)
    c.below("products with the mobility a step, mean", curve[:, 3].mean(), 3.0)
    c.below("steps whose solve did not converge", curve[-1, 4], 0)
    c.below("largest change of a distance within a chain, in radii", max(bend(together), bend(alone)), 1e-11)
    c.below("largest overlap, in radii", -curve[:, 5].min(), 0.15)
    c.below("half the step: change of the centre at the end, in radii",
            np.abs((fine[-1] - together[-1])[:, 1:4].mean(axis=0)).max(), 0.01)
    c.below("size of the film, MB", (out / "falling_clumps.gif").stat().st_size / 1e6, 2.0)
    c.below("2 ranks against 1 at time 1, in radii", np.abs(two[-1] - together[1])[:, 1:4].max(), 1e-6)
    if given.update:
        for name in ("falling_clumps.png", "falling_clumps.gif"):
            shutil.copy(out / name, HERE)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
