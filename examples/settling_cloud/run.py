#!/usr/bin/env python3
"""Lets the cloud fall with and without hydrodynamic interactions between the clumps, compares the speeds and draws
them.

    run.py --out DIR    results, images and pictures go to DIR (default: build/examples/settling_cloud)
    run.py --update     also refreshes the logs and the pictures in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import io
import pathlib
import shutil
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, dumped, finished, need, options, values  # noqa: E402
from PIL import Image  # noqa: E402

# As in in.settling_cloud. Lengths are in radii of a sphere, speeds in those of a lone sphere, forces in its weight.
MASS, INTERVAL = 0.01, 0.5
TITLE = {"all": "all spheres interact", "clump": "spheres of a clump interact", "none": "no sphere sees another"}
SHOWN = (0.0, 0.8, 1.4, 2.0, 2.4, 3.2)          # times of the montage
FRAME = 0.1                                     # time between two images


# --- what to compare with -----------------------------------------------------------------------------------------


def lone_clump():
    """Settling speed of a tetrahedron of touching spheres in the model, by a dense solve."""
    x = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(2.0)
    M = np.eye(12)
    for i in range(4):
        for j in range(4):
            if i != j:
                r = x[i] - x[j]
                s = np.linalg.norm(r)
                e = np.outer(r, r) / s**2
                M[3 * i:3 * i + 3, 3 * j:3 * j + 3] = 3 / (4 * s) * (np.eye(3) + e) + (np.eye(3) - 3 * e) / (2 * s**3)
    drag = np.linalg.solve(M, np.tile([0.0, 0.0, 1.0], 4)).reshape(4, 3).sum(axis=0)[2]
    return 4.0 / drag


def point_forces(centre):
    """Mean settling speed when each clump is a point force of weight 4: its own speed, and Oseen's tensor of all
    others.

        U = U_1 + 4 < sum_(j != i) 3/4 (1/r + z^2/r^3) >
    """
    r = centre[:, None] - centre[None]
    s = np.linalg.norm(r, axis=2)
    np.fill_diagonal(s, np.inf)
    return lone_clump() + 4.0 * 0.75 * (1.0 / s + r[:, :, 2]**2 / s**3).sum() / len(centre)


def formula(n, R):
    """The same for n points spread evenly in a sphere of radius R, where < 1/r > = 6/(5R) over pairs, and z^2/r^2 =
    1/3.

        U = U_1 (1 + 6/5 n a_h/R),   a_h = 4/U_1 the hydrodynamic radius of a clump
    """
    return lone_clump() + 4.0 * 1.2 * n / R


# --- runs ---------------------------------------------------------------------------------------------------------


def lammps(out, ranks, log, variables):
    (out / "out").mkdir(parents=True, exist_ok=True)
    for name in ("in.settling_cloud", "tetrahedron.mol"):
        shutil.copy(HERE / name, out)
    command = ["mpirun", "-np", str(ranks), "lmp", "-in", "in.settling_cloud", "-log", log] + values(variables)
    start = time.time()
    finished("settling_cloud", command, out)
    print(f"[{log}, {ranks} rank{'s' if ranks > 1 else ''}] {time.time() - start:.0f} s", flush=True)


def curve(out, name):
    """Columns: time, speed, height of the centre, radius, dent of the floor."""
    return np.loadtxt(out / "out" / f"{name}.curve")[:, 1:]


def frames(out, name):
    """Step; id, molecule, x, y, z, vz of every sphere."""
    return list(dumped(out / "out" / f"{name}.spheres"))


def centres(spheres):
    order = np.argsort(spheres[:, 1], kind="stable")
    return spheres[order, 2:5].reshape(-1, 4, 3).mean(axis=1)


def overlap(spheres):
    """The largest of two spheres of different clumps, in radii."""
    x, molecule = spheres[:, 2:5], spheres[:, 1]
    s = np.linalg.norm(x[:, None] - x[None], axis=2)
    s[molecule[:, None] == molecule[None]] = np.inf
    return 2.0 - s.min()


# --- pictures -----------------------------------------------------------------------------------------------------


def save(fig, path):
    whole = io.BytesIO()
    fig.savefig(whole)
    plt.close(fig)
    Image.open(whole).convert("RGB").quantize(colors=64).save(path, optimize=True)      # a third of the size


def montage(out, path):
    rows = ("all", "clump")
    fig, axes = plt.subplots(len(rows), len(SHOWN), figsize=(11.0, 6.4), dpi=100, layout="constrained")
    last = plt.imread(sorted((out / "out").glob("all.*.ppm"))[-1])
    floor = np.flatnonzero(last.min(axis=(1, 2)) < 230).max() + 1       # the row of pixels that the spheres rest on
    for row, name in zip(axes, rows):
        images = sorted((out / "out").glob(f"{name}.*.ppm"))
        for ax, t in zip(row, SHOWN):
            ax.imshow(plt.imread(images[round(t / FRAME)])[:floor])
            ax.set(xticks=[], yticks=[])
            ax.spines[["top", "left", "right"]].set_visible(False)
            ax.spines["bottom"].set_linewidth(2.5)          # the floor
            if name == rows[0]:
                ax.set_title(f"time {t:.1f}")
        row[0].set_ylabel(TITLE[name])
    save(fig, path)


def plot_speeds(curves, sums, path):
    fig, (left, right) = plt.subplots(1, 2, figsize=(11.0, 4.0), dpi=90, layout="constrained")
    for k, (name, c) in enumerate(curves.items()):
        left.plot(c[:, 0], c[:, 1], color=f"C{k}", label=TITLE[name])
        right.plot(c[:, 0], c[:, 2], color=f"C{k}", label=TITLE[name])
    t, exact, R = sums
    falling = t < 2.2
    left.plot(t[falling], exact[falling], "k--", lw=1, label="point forces, at the clumps' places")
    left.plot(t[falling], formula(200, R[falling]), "k:", lw=1.2, label="point forces, uniform sphere")
    left.set(xlabel="time", ylabel="settling speed of the cloud / that of a sphere", ylim=(0, 75))
    left.legend(loc="upper right", fontsize="small", ncols=2)
    right.set(xlabel="time", ylabel="height of its centre / radius of a sphere", ylim=(0, 105))
    right.legend(fontsize="small")
    save(fig, path)


def main():
    given = options(__file__, __doc__)
    out = given.out
    need("lmp", "mpirun")
    shutil.rmtree(out / "out", ignore_errors=True)

    short = {}
    for ranks in (1, 2):
        lammps(out, ranks, f"log.settling_cloud.{ranks}", dict(time=0.05, frame=0.05, images="no"))
        short[ranks] = frames(out, "all")[-1][1]
    for name in TITLE:
        # Clumps alone are compared to five digits, and their blocks make every solve exact in one iteration.
        lammps(out, 2, f"log.{name}", dict(interactions=name, images="no" if name == "none" else "yes",
                                           tolerance="1e-6" if name == "clump" else "1e-3"))

    curves = {name: curve(out, name) for name in TITLE}
    step, now = np.loadtxt(out / "out" / "all.curve")[-1, :2]
    whole = frames(out, "all")
    t = np.array([n for n, _ in whole]) * now / step
    exact = np.array([point_forces(centres(s)) for _, s in whole])
    R = np.interp(t, curves["all"][:, 0], curves["all"][:, 3])
    montage(out, out / "settling_cloud.png")
    plot_speeds(curves, (t, exact, R), out / "speed.png")

    # The cloud is still speeding up when it meets the floor, so its drag is a little less than its weight. Between two
    # solves v' is as old as INTERVAL/2 relaxation times on average, which adds so much to the mass.
    cloud = curves["all"]
    k = np.argmax(cloud[:, 1])
    rate = np.polyfit(cloud[k - 8:k - 1, 0], cloud[k - 8:k - 1, 1], 1)[0]
    now, speed, _, radius, _ = cloud[k - 8:k - 1].mean(axis=0)
    steady = speed / (1.0 - MASS * (1.0 + 0.5 * INTERVAL) * rate)
    predicted = np.interp(now, t, exact)
    one = lone_clump()
    print(f"\n  settling speed in that of a lone sphere, at time {now:.2f}    measured    expected")
    for what, value, expected in ((TITLE["none"], curves["none"][-1, 1], "1"),
                                  (TITLE["clump"], curves["clump"][-1, 1], f"{one:.6f} (one clump, model)"),
                                  (TITLE["all"], speed, ""),
                                  (f"  its acceleration of {rate:.2f} taken out", steady,
                                   f"{predicted:.2f} (point forces where the clumps are)"),
                                  ("", np.nan,
                                   f"{formula(200, radius):.2f} (point forces, uniform, R = {radius:.2f})")):
        print(f"    {what:50}" + (f"{value:11.6f}" if np.isfinite(value) else 11 * " ") + f"    {expected}")
    print(f"pictures: {out / 'settling_cloud.png'}, {out / 'speed.png'}; images: {out / 'out'}\n")

    c = Checks()
    c.near("speed of spheres that see nobody", curves["none"][-1, 1], 1.0, 1e-5)
    c.near("speed of clumps that see nobody", curves["clump"][-1, 1], one, 1e-5 * one)
    c.near("speed of the cloud", speed, 46.05, 0.5)
    c.near("its acceleration", rate, 2.19, 0.3)
    c.near("its speed without that", steady, 47.35, 0.5)
    c.near("the speed of point forces in the places of the clumps", predicted, 48.49, 0.1)
    c.near("the speed of point forces spread evenly", formula(200, radius), 49.32, 0.1)
    c.within("speed of the cloud over that of the point forces", steady / predicted, 0.93, 1.02)
    c.near("how often faster than one clump", speed / one, 18.7, 0.2)
    c.below("largest overlap of two spheres, in radii", max(overlap(s) for _, s in whole), 0.006)
    c.below("largest dent of the floor, in radii", cloud[:, 4].max(), 0.02)
    c.below("2 ranks against 1, in radii", np.abs(short[1] - short[2])[:, 2:5].max(), 1e-10)
    if given.update:
        for name in ("settling_cloud.png", "speed.png", "log.settling_cloud.1", "log.settling_cloud.2"):
            shutil.copy(out / name, HERE)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
