#!/usr/bin/env python3
"""Lets a chiral clump and its mirror image fall with in.propeller and compares how they spin with exact values.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/propeller)
    run.py --update     also refreshes the picture and the logs in this folder

Two values to compare with, at the orientation that the clump has at each time:
  own     velocity and angular velocity that follow from the clump's own 6x6 resistance, which the plugin gives in six
          rigid motions (../sedimentation/in.six_motions)
  exact   the same from exact Stokes flow, ../sedimentation/data/clusters_exact.csv
Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
SEDIMENTATION = HERE.parent / "sedimentation"

sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from rigid import rigid_velocities, rotation_between  # noqa: E402
from runs import np, plt, TOP, dumped, finished, need, open_axes, options, read_table, values  # noqa: E402

WEIGHT = np.array([0.0, 0.0, -4 * 6 * np.pi])       # four spheres; viscosity, radius and their settling velocity are 1
MIRROR = np.diag([-1.0, 1.0, 1.0])
OWN_LIMIT = {"velocity": 1e-6, "spin": 1e-6}        # relative, at the end of the fall
EXACT_LIMIT = {12: 0.035, 42: 0.03, 162: 0.03}      # of the spin at the end of the fall


def shape():
    x = np.array([[float(r[k]) for k in "xyz"] for r in read_table(SEDIMENTATION / "data" / "cluster_geometry.csv")
                  if r["name"] == "helix4_chiral"])
    return x - x.mean(axis=0)


def exact_resistance():
    return next(np.array([[float(r[f"R{i}{j}"]) for j in range(1, 7)] for i in range(1, 7)])
                for r in read_table(SEDIMENTATION / "data" / "clusters_exact.csv") if r["name"] == "helix4_chiral")


def mirrored(R):
    """Resistance of the mirror image: forces are vectors, torques pseudovectors."""
    S = np.block([[MIRROR, np.zeros((3, 3))], [np.zeros((3, 3)), -MIRROR]])
    return S @ R @ S


def settle(R, turn):
    """U (of the centroid) and W of a clump of resistance R, turned by the matrix turn, under its weight."""
    V = np.linalg.solve(R, np.concatenate((turn.T @ WEIGHT, np.zeros(3))))
    return turn @ V[:3], turn @ V[3:]


def spin_curve(R, turn, t):
    """Angle turned about the vertical at times t for a clump of resistance R, by Runge and Kutta's method."""
    def rate(Q):
        W = settle(R, Q)[1]
        return np.array([[0, -W[2], W[1]], [W[2], 0, -W[0]], [-W[1], W[0], 0]]) @ Q, W[2]
    angle, steps = [0.0], 20
    for h in np.diff(t) / steps:
        total = angle[-1]
        for _ in range(steps):
            k1, a1 = rate(turn)
            k2, a2 = rate(turn + h / 2 * k1)
            k3, a3 = rate(turn + h / 2 * k2)
            k4, a4 = rate(turn + h * k3)
            turn = turn + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
            total += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
        u, _, vt = np.linalg.svd(turn)
        turn = u @ vt
        angle.append(total)
    return np.array(angle)


def lammps(cwd, script, log, ranks=1, **variables):
    command = ["mpirun", "-np", str(ranks)] * (ranks > 1) + ["stdbuf", "-oL", "lmp", "-in", script, "-log", str(log)]
    finished("propeller", command + values(variables), cwd)


def own_resistance(out, name, shell):
    lammps(SEDIMENTATION, "in.six_motions", "none", clump=HERE / f"{name}.mol", model=f"rigid_clumps yes shell {shell}",
           out=out / f"{name}_{shell}")
    R = np.zeros((6, 6))
    for mode in range(6):
        (_, rows), = dumped(out / f"{name}_{shell}.{mode + 1}")
        x, F, T = rows[:, 1:4], rows[:, 4:7], rows[:, 7:10]
        R[:3, mode], R[3:, mode] = -F.sum(0), -(T + np.cross(x - x.mean(0), F)).sum(0)
    return R


class Fall:
    """Motion of one of the two clumps in a run."""

    def __init__(self, rows, molecule, x0, R_own, R_exact):
        self.R_own, self.R_exact = R_own, R_exact
        self.x, self.turn, U, W, own, exact = [], [], [], [], [], []
        for spheres in rows:
            mine = spheres[spheres[:, 1] == molecule]
            x, v = mine[:, 2:5], mine[:, 5:8]
            V = np.linalg.lstsq(rigid_velocities(x - x.mean(0)), v.ravel(), rcond=None)[0]
            turn = rotation_between(x0, x)
            self.x.append(x)
            self.turn.append(turn)
            U.append(V[:3])
            W.append(V[3:])
            own.append(settle(R_own, turn))
            exact.append(settle(R_exact, turn))
        self.x, self.U, self.W = np.array(self.x), np.array(U), np.array(W)
        self.own, self.exact = np.array(own), np.array(exact)       # [frame][U or W]
        # Azimuth of the way that the clump has turned about the vertical
        step = [np.arctan2(*(b @ a.T)[[1, 0], 0]) for a, b in zip(self.turn[:-1], self.turn[1:])]
        self.angle = np.concatenate(([0.0], np.cumsum(step)))


def run(out, shell, ranks=1):
    motion = out / f"{shell}_{ranks}.motion"
    lammps(HERE, "in.propeller", out / f"{shell}_{ranks}.log", ranks, shell=shell, motion=motion)
    steps, rows = zip(*dumped(motion))
    dt = 0.5 * 2 * 0.05 / 9                                         # as in in.propeller
    x0, R = shape(), exact_resistance()
    clump = Fall(rows, 1, x0, own_resistance(out, "helix4_chiral", shell), R)
    image = Fall(rows, 2, x0 @ MIRROR, own_resistance(out, "helix4_mirror", shell), mirrored(R))
    return dt * np.array(steps), clump, image


def balls(axis, x, colours):
    """Spheres of unit radius seen from the side (along y), those in front painted last, each with a light from
    above."""
    for k in np.argsort(-x[:, 1]):
        centre = np.array([x[k, 0], x[k, 2]])
        for s in np.linspace(0, 1, 24):
            base = np.array(plt.matplotlib.colors.to_rgb(colours[k]))
            axis.add_patch(plt.Circle(centre + s * np.array([-0.3, 0.35]), 1 - s, lw=0,
                                      color=tuple(base * (0.55 + 0.45 * s) + (1 - base) * 0.5 * s**3)))
    axis.set_aspect("equal")
    axis.axis("off")


def draw(t, clump, image, path):
    open_axes()
    figure = plt.figure(figsize=(12, 6.6), layout="constrained")
    grid = figure.add_gridspec(3, 9, height_ratios=[1.1, 1.1, 3])
    # one turn of the steady spin, in eighths
    rate = abs(clump.W[-1][2])
    start = len(t) // 3
    colours = ("#d95f02", "#7570b3", "#1b9e77", "#e6ab02")
    for k in range(9):
        frame = int(np.argmin(np.abs(t - t[start] - k / 8 * 2 * np.pi / rate)))
        for row, fall in enumerate((clump, image)):
            axis = figure.add_subplot(grid[row, k])
            x = fall.x[frame]
            balls(axis, x - x.mean(axis=0), colours)
            axis.set_xlim(-2.9, 2.9)
            axis.set_ylim(-2.5, 2.5)
            if row == 0:
                axis.set_title(f"{k}/8 turn", fontsize=9)
            if k == 0:
                axis.text(-2.9, 0, ("clump", "mirror image")[row], rotation=90, ha="right", va="center", fontsize=10)
    axis = figure.add_subplot(grid[2, :])
    for fall, colour, name in ((clump, "C1", "clump"), (image, "C0", "mirror image")):
        down = -(fall.x.mean(axis=1)[:, 2] - fall.x.mean(axis=1)[0, 2])
        exact = spin_curve(fall.R_exact, fall.turn[0], t)
        axis.plot(down, exact / (2 * np.pi), "-", color=colour, lw=1.4, label=f"{name}: exact Stokes flow")
        pick = slice(0, None, 10)
        axis.plot(down[pick], fall.angle[pick] / (2 * np.pi), "o", color=colour, ms=5, mec="black", mew=0.4,
                  label=f"{name}: run")
    axis.axhline(0, color="0.6", lw=0.8)
    axis.set_xlabel("depth, in radii of a sphere")
    axis.set_ylabel("turns about the vertical")
    axis.legend(fontsize=9, loc="upper left", ncol=2)
    axis.grid(alpha=0.3)
    axis.set_title("A chiral clump spins as it falls, its mirror image the other way (seen from the side)")
    figure.savefig(path, dpi=90, pil_kwargs={"optimize": True})
    plt.close(figure)


def difference(a, b):
    return np.linalg.norm(a - b) / np.linalg.norm(b)


# The table of the README: velocity and spin of the clump at the end of its fall
MEASURED = {12: (2.04249, 0.013362), 42: (2.04526, 0.012647), 162: (2.04377, 0.012755)}


def check(c, shell, t, clump, image):
    """What must hold of a fall on one rank."""
    W, own, exact = clump.W[-1], clump.own[-1], clump.exact[-1]
    speed, spin = MEASURED[shell]
    c.near(f"shell {shell}: velocity", -clump.U[-1][2], speed, 2e-5)
    c.near(f"shell {shell}: spin", W[2], spin, 2e-6)
    c.near(f"shell {shell}: spin of the image", image.W[-1][2], -spin, 2e-6)
    for name, measured, kind in (("velocity", clump.U[-1], 0), ("spin", W, 1)):
        c.below(f"shell {shell}: {name} against the clump's own 6x6", difference(measured, own[kind]), OWN_LIMIT[name])
    late = range(len(t) // 10, len(t))
    c.below(f"shell {shell}: spin against it all the way but the first tenth",
            max(difference(clump.W[k], clump.own[k][1]) for k in late), 1e-3)
    c.below(f"shell {shell}: velocity against exact", difference(clump.U[-1], exact[0]), 0.006)
    c.below(f"shell {shell}: spin against exact", difference(W, exact[1]), EXACT_LIMIT[shell])
    c.below(f"shell {shell}: spin of the image against the mirror image of the spin",
            np.abs(clump.W @ -MIRROR - image.W).max() / np.abs(clump.W).max(), 1e-6)


def main():
    given = options(__file__, __doc__)
    out = given.out
    need("lmp", "mpirun")

    began, falls = time.time(), {}
    for shell, ranks in ((12, 1), (42, 1), (162, 1), (42, 2)):
        t, clump, image = falls[shell, ranks] = run(out, shell, ranks)
        if ranks == 2:
            continue
        W, own, exact = clump.W[-1], clump.own[-1], clump.exact[-1]
        final = spin_curve(clump.R_exact, clump.turn[0], t)
        rate = (final[-1] - final[-2]) / (t[-1] - t[-2])            # once its own orientation is steady
        print(f"  shell {shell}: spin {W[2]:+.6f}, own {own[1][2]:+.6f}, exact there {exact[1][2]:+.6f}, exact motion "
              f"{rate:+.6f}; image {image.W[-1][2]:+.6f}; velocity {-clump.U[-1][2]:.6f}, exact {-exact[0][2]:.6f}; "
              f"turns {clump.angle[-1] / (2 * np.pi):+.4f}, exact {final[-1] / (2 * np.pi):+.4f}", flush=True)
    draw(*falls[42, 1], out / "propeller.png")
    if given.update:
        shutil.copy(out / "propeller.png", HERE)
        for ranks in (1, 2):
            log = (out / f"42_{ranks}.log").read_text().replace(str(out) + "/", "").replace(str(TOP) + "/", "")
            (HERE / f"log.propeller.{ranks}").write_text(log)
    print(f"4 runs in {time.time() - began:.0f} s; picture: {out / 'propeller.png'}\n")

    c = Checks()
    for (shell, ranks), fall in falls.items():
        if ranks == 1:
            check(c, shell, *fall)
    c.below("2 ranks against 1, in radii", np.abs(falls[42, 2][1].x - falls[42, 1][1].x).max(), 1e-8)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
