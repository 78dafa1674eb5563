#!/usr/bin/env python3
"""The flow around falling spheres, in a suspension and around a sphere in shear, from the files of fix
stokes_dynamics/field.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/streamlines)
    run.py --update     also refreshes the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, dumped, finished, need, options, save, values  # noqa: E402
from image import Image  # noqa: E402


def lammps(out, scene, points, lo, hi, tag=""):
    """The flow, and of the spheres x z and velocities"""
    name = out / f"{scene}{tag}.*"
    command = ["lmp", "-in", "in.streamlines", "-log", str(out / f"log.{scene}{tag}")]
    finished("streamlines", command + values({"scene": scene, "points": points, "lo": lo, "hi": hi, "out": name}), HERE)
    (_, rows), = dumped(out / f"{scene}{tag}.0.dump")
    return Image(out / f"{scene}{tag}.0.vti"), rows


def draw(axes, image, rows, title, less=(0.0, 0.0)):
    """Streamlines in the plane y = 0, coloured by speed"""
    x, z = image.axis(0), image.axis(2)
    u = image["velocity"][:, 0, :, 0] - less[0]
    w = image["velocity"][:, 0, :, 2] - less[1]
    speed = np.hypot(u, w)
    shown = axes.pcolormesh(x, z, speed, cmap="magma", shading="gouraud", rasterized=True)
    axes.streamplot(x, z, u, w, color="w", linewidth=0.6, arrowsize=0.7, density=1.4)
    for row in rows:
        if abs(row[2]) < row[4]:
            axes.add_patch(plt.Circle((row[1], row[3]), np.sqrt(row[4]**2 - row[2]**2), fc="0.85", ec="k", lw=0.7))
    axes.set(xlim=(x[0], x[-1]), ylim=(z[0], z[-1]), aspect="equal", title=title, xlabel="x / a", ylabel="z / a")
    plt.colorbar(shown, ax=axes, shrink=0.7, label="speed")


def shear_exact(x):
    """What a sphere that turns freely adds to the shear u_x = 0.5 z"""
    E = np.array([[0, 0, 0.25], [0, 0, 0], [0.25, 0, 0]])
    r = np.linalg.norm(x, axis=-1, keepdims=True)
    return -2.5 * x * np.einsum("...p,pq,...q", x, E, x)[..., None] / r**5 * (1 - 1 / r**2) - (x @ E) / r**5


def main():
    given = options(__file__, __doc__)
    need("lmp")
    out, c = given.out, Checks()
    three, spheres = lammps(out, "three", "161 1 107", "-12 0 -8", "12 0 8")
    suspension, many = lammps(out, "suspension", "121 1 121", "-9 0 -9", "9 0 9")
    shear, one = lammps(out, "shear", "81 1 81", "-4 0 -4", "4 0 4")

    plt.rcParams.update({"font.size": 9})
    figure, axes = plt.subplots(1, 3, figsize=(14, 4.4), layout="constrained", width_ratios=[1.35, 1, 1])
    draw(axes[0], three, spheres, "Three spheres fall, seen from the ground")
    draw(axes[1], suspension, many, "A suspension settles")
    draw(axes[2], shear, one, "A sphere turns in a shear flow")
    save(figure, out / "streamlines.png")

    inside = three["inside"][:, 0, :] == 1
    middle = three["velocity"][np.abs(three.axis(2)).argmin(), 0, np.abs(three.axis(0)).argmin()]
    c.near("three spheres: velocity of the point at the middle one over that of the sphere", middle[2] / spheres[1, 7],
           1.0, 1e-3)
    c.within("share of the plane that is sphere, over three circles", inside.mean() * 24 * 16 / (3 * np.pi), 0.97, 1.03)
    far, _ = lammps(out, "three", "1 1 2", "0 0 50", "0 0 1000", "_far")
    c.near("far above: velocity over that of three point forces, 1000 radii away",
           far["velocity"][1, 0, 0, 2] / (-3 * 1.5 / 1000), 1.0, 3e-4)

    x = shear.points()
    outside = (shear["inside"] == 0) & (np.linalg.norm(x, axis=-1) > 1.3)
    with np.errstate(divide="ignore", invalid="ignore"):
        exact = shear_exact(x)
    error = shear["velocity"] - exact
    error[..., 0] -= 0.5 * x[..., 2]
    c.near("shear: spin of the sphere over half the vorticity",
           shear["velocity"][45, 0, 40, 0] / (0.25 * shear.axis(2)[45]), 1.0, 1e-3)
    c.below("shear: largest error of the flow from 1.3 radii on, in speeds of the surface",
            np.abs(error[outside]).max() / 0.25, 0.05)

    coarse, _ = lammps(out, "three", "21 1 21", "-4 0 2", "4 0 8", "_coarse")
    fine, _ = lammps(out, "three", "41 1 41", "-4 0 2", "4 0 8", "_fine")
    finest, _ = lammps(out, "three", "81 1 81", "-4 0 2", "4 0 8", "_finest")

    def between(a, b):
        """Error of linear interpolation half way along x"""
        rows = a["velocity"][:, 0]
        return np.abs(0.5 * (rows[:, 1:] + rows[:, :-1]) - b["velocity"][::2, 0, 1::2]).max()
    c.near("between the points: order of the error of linear interpolation",
           np.log2(between(coarse, fine) / between(fine, finest)), 2.0, 0.2)
    if given.update:
        shutil.copy(out / "streamlines.png", HERE)
    sys.exit(c.finish())


if __name__ == "__main__":
    main()
