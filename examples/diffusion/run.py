#!/usr/bin/env python3
"""Lets rods, discs and helices diffuse with in.diffusion and compares all that their motion says with their 6x6
mobility.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/diffusion)
    run.py --update     also refreshes the picture in this folder

The mobility of each shape follows from the forces in its six rigid motions (../sedimentation/in.six_motions), where
nothing is random. Of the run:
  covariance of displacement and turn over a few steps, in the axes of the body, over twice the time
  mean square displacement of the centre of mobility, 6 D t
  <u(0).u(t)> of the axis of rod and disc, exp(-2 D_r t)
Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent

sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from rigid import rigid_velocities  # noqa: E402
from runs import np, plt, dumped, finished, need, open_axes, options, save, values  # noqa: E402

DT, EVERY, STEPS, COPIES = 0.08, 5, 2500, 300
SPACING = 60.0
_ring = [(2 * np.cos(k * np.pi / 3), 2 * np.sin(k * np.pi / 3), 0.0) for k in range(6)]
SHAPES = {"rod": np.array([(0.0, 0.0, 2.0 * k) for k in range(5)]), "disc": np.array([(0.0, 0.0, 0.0)] + _ring),
          "helix": np.array([(1.6 * np.cos(k * np.pi / 3), 1.6 * np.sin(k * np.pi / 3), 1.2 * k) for k in range(10)])}
SHAPES = {name: x - x.mean(axis=0) for name, x in SHAPES.items()}
AXIS = {"rod": 2, "disc": 2}


def cross(d):
    return np.array([[0, -d[2], d[1]], [d[2], 0, -d[0]], [-d[1], d[0], 0]])


# --- the mobility, from six motions -----------------------------------------------------------------------------------

def molecule(path, x):
    rows = [f"{k + 1} " for k in range(len(x))]
    with open(path, "w") as out:
        out.write(f"# of run.py\n\n{len(x)} atoms\n\nCoords\n\n")
        out.write("\n".join(r + "{:.15g} {:.15g} {:.15g}".format(*p) for r, p in zip(rows, x)))
        out.write("\n\nTypes\n\n" + "\n".join(r + "1" for r in rows) + "\n\nDiameters\n\n" +
                  "\n".join(r + "2" for r in rows) + "\n")


def mobility(out, name):
    """N about the centre of mobility [6, 6], and where that is from the centroid"""
    x = SHAPES[name]
    molecule(out / f"{name}.mol", x)
    finished("diffusion", ["lmp", "-in", "in.six_motions", "-log", "none"] + values(
        dict(clump=out / f"{name}.mol", model="rigid_clumps yes shell 42", out=out / f"{name}.motion")),
             HERE.parent / "sedimentation")
    R = np.zeros((6, 6))
    for mode in range(6):
        (_, rows), = dumped(out / f"{name}.motion.{mode + 1}")
        places, F, T = rows[:, 1:4], rows[:, 4:7], rows[:, 7:10]
        R[:3, mode], R[3:, mode] = -F.sum(0), -(T + np.cross(places - places.mean(0), F)).sum(0)
    N = np.linalg.inv((R + R.T) / 2)
    B, D = N[:3, 3:], N[3:, 3:]
    o = np.linalg.solve(np.trace(D) * np.eye(3) - D, [B[2, 1] - B[1, 2], B[0, 2] - B[2, 0], B[1, 0] - B[0, 1]])
    S = np.block([[np.eye(3), -cross(o)], [np.zeros((3, 3)), np.eye(3)]])
    return S @ N @ S.T, o


# --- a run ------------------------------------------------------------------------------------------------------------

def turned_at_random(x, rng):
    q = rng.normal(size=4)
    w, p = q[0] / np.linalg.norm(q), q[1:] / np.linalg.norm(q)
    return x + 2 * np.cross(p, np.cross(p, x) + w * x)


def diffuse(out, name):
    """Places [frames, copies, spheres, 3]"""
    rng, n = np.random.default_rng(3), len(SHAPES[name])
    side = int(np.ceil(COPIES**(1 / 3)))
    with open(out / f"{name}.data", "w") as data:
        data.write(f"clumps\n\n{COPIES * n} atoms\n1 atom types\n1 bond types\n")
        data.write("".join(f"{-SPACING} {side * SPACING} {d}lo {d}hi\n" for d in "xyz") + "\nAtoms\n\n")
        for c in range(COPIES):
            at = SPACING * np.array((c % side, c // side % side, c // side**2))
            for k, p in enumerate(turned_at_random(SHAPES[name], rng) + at):
                data.write("{} 1 {:.15g} {:.15g} {:.15g} 2 1 {}\n".format(c * n + k + 1, *p, c + 1))
    finished("diffusion", ["lmp", "-in", "in.diffusion", "-log", str(out / f"{name}.log")] + values(
        dict(clumps=out / f"{name}.data", dt=DT, steps=STEPS, every=EVERY, out=out / f"{name}.places")), HERE)
    return np.array([rows[:, 1:].reshape(COPIES, n, 3) for _, rows in dumped(out / f"{name}.places")])


def poses(x, shape):
    """Rotations from the shape to spheres at x [..., n, 3] (Kabsch 1976). A rod has no turn about itself; any will
    do."""
    u, _, vt = np.linalg.svd(np.swapaxes(x - x.mean(axis=-2, keepdims=True), -1, -2) @ shape)
    u = u * np.stack([np.ones(u.shape[:-2]), np.ones(u.shape[:-2]), np.linalg.det(u @ vt)], axis=-1)[..., None, :]
    return u @ vt


class Run:
    def __init__(self, name, x, N, o):
        shape, t = SHAPES[name], DT * EVERY
        self.N, self.axes = N, poses(x, shape)
        self.centre = x.mean(axis=2) + self.axes @ o
        self.t = t * np.arange(1, len(x) // 2)
        self.msd = np.array([((self.centre[k:] - self.centre[:-k])**2).sum(axis=-1).mean()
                             for k in range(1, len(x) // 2)])
        if name in AXIS:
            u = self.axes[..., AXIS[name]]
            if name == "rod":
                u = x[:, :, -1] - x[:, :, 0]
                u = u / np.linalg.norm(u, axis=-1, keepdims=True)
            self.turning = np.array([(u[k:] * u[:-k]).sum(axis=-1).mean() for k in range(1, len(x) // 2)])
        # displacement and turn of each pair of frames, in the axes of the body halfway: by least squares from its
        # spheres
        moved = np.swapaxes(self.axes[:-1], -1, -2) @ np.swapaxes(x[1:] - x[:-1], -1, -2)
        moved = np.swapaxes(moved, -1, -2).reshape(-1, shape.size)
        V = moved @ np.linalg.pinv(rigid_velocities(shape - o), rcond=1e-10).T
        self.samples = len(V)
        self.C = V.T @ V / self.samples / (2 * t)

    def deviation(self, p, q):
        return np.sqrt((self.N[p, p] * self.N[q, q] + self.N[p, q]**2) / self.samples)


# --- picture ----------------------------------------------------------------------------------------------------------

def balls(axis, x, colour):
    for k in np.argsort(-x[:, 1]):
        base = np.array(plt.matplotlib.colors.to_rgb(colour))
        for s in np.linspace(0, 1, 20):
            axis.add_patch(plt.Circle(x[k, [0, 2]] + s * np.array([-0.3, 0.35]), 1 - s, lw=0,
                                      color=tuple(base * (0.55 + 0.45 * s) + (1 - base) * 0.5 * s**3)))
    axis.set_aspect("equal")
    axis.autoscale_view()
    axis.axis("off")


COLOURS = {"rod": "C0", "disc": "C3", "helix": "C2"}


def draw(runs, path):
    open_axes()
    figure = plt.figure(figsize=(11.5, 4.6), layout="constrained")
    grid = figure.add_gridspec(3, 3, width_ratios=[1, 3, 3])
    msd, entries = figure.add_subplot(grid[:, 1]), figure.add_subplot(grid[:, 2])
    tilt = np.array([[1, 0, 0], [0, 0.75, -0.66], [0, 0.66, 0.75]])
    for k, (name, run) in enumerate(runs.items()):
        balls(figure.add_subplot(grid[k, 0]), SHAPES[name] @ tilt.T if name == "disc" else SHAPES[name][:, [2, 1, 0]],
              COLOURS[name])
        D = np.trace(run.N[:3, :3]) / 3
        msd.plot(run.t[::8], run.msd[::8] / (6 * D * run.t[::8]), "o", ms=4, color=COLOURS[name],
                 label=f"{name}: displacement over 6 D t")
        if name in AXIS:
            Dr = (run.N[3, 3] + run.N[4, 4]) / 2
            msd.plot(run.t[::8], run.turning[::8], "s", ms=4, mfc="none", color=COLOURS[name],
                     label=f"{name}: <u(0).u(t)>")
            msd.plot(run.t, np.exp(-2 * Dr * run.t), "-", lw=1, color=COLOURS[name])
        unit = np.sqrt(np.outer(np.diag(run.N), np.diag(run.N)))
        upper = np.triu_indices(6 if name != "rod" else 5)
        entries.plot((run.N / unit)[upper], (run.C / unit)[upper], "o", ms=5, color=COLOURS[name], label=name,
                     alpha=0.8)
    msd.axhline(1, color="0.6", lw=0.8)
    msd.set_ylim(0, 1.15)
    msd.set_xlabel(r"time, $\eta$ a$^3$/kT")
    msd.legend(fontsize=8)
    entries.plot([-0.3, 1.05], [-0.3, 1.05], "-", color="0.6", lw=0.8)
    entries.set_xlabel("6x6 mobility, over its diagonal")
    entries.set_ylabel("covariance of the steps")
    entries.legend(fontsize=9)
    entries.grid(alpha=0.3)
    save(figure, path)


# --- what must hold ---------------------------------------------------------------------------------------------------

def check(c, name, run):
    moving = 6 if name != "rod" else 5
    N, C = run.N, run.C
    D, measured = np.trace(N[:3, :3]) / 3, np.trace(C[:3, :3]) / 3
    c.near(f"{name}: D by the steps", measured / D, 1.0, 4 * np.sqrt(2 / (3 * run.samples)) + 0.005)
    Dr, turning = np.diag(N)[3:moving].mean(), np.diag(C)[3:moving].mean()
    c.near(f"{name}: D of rotation by the steps", turning / Dr, 1.0, 4 * np.sqrt(2 / (2 * run.samples)) + 0.005)
    worst = max(abs(C[p, q] - N[p, q]) / run.deviation(p, q) for p in range(moving) for q in range(p, moving))
    c.below(f"{name}: worst entry of the 6x6, in standard deviations", worst, 5.0)
    k = len(run.t) // 2
    c.near(f"{name}: mean square displacement at t = {run.t[k]:.3g} over 6 D t", run.msd[k] / (6 * D * run.t[k]), 1.0,
           0.08)
    if name in AXIS:
        exact = np.exp(-2 * (N[3, 3] + N[4, 4]) / 2 * run.t[k])
        c.near(f"{name}: <u(0).u(t)> there", run.turning[k], exact, 0.04)


def main():
    given = options(__file__, __doc__)
    need("lmp")
    began, runs = time.time(), {}
    for name in SHAPES:
        N, o = mobility(given.out, name)
        runs[name] = run = Run(name, diffuse(given.out, name), N, o)
        turns = 5 if name == "rod" else 6
        coupling, found = np.abs(N[:3, 3:]).max(), np.abs(run.C[:3, 3:turns]).max()
        print(f"  {name}: D {np.trace(run.C[:3, :3]) / 3:.6f}, exact {np.trace(N[:3, :3]) / 3:.6f}; "
              f"largest coupling of turn and displacement {found:.6f}, exact {coupling:.6f}; {run.samples} steps",
              flush=True)
    draw(runs, given.out / "diffusion.png")
    if given.update:
        shutil.copy(given.out / "diffusion.png", HERE)
    print(f"6 runs in {time.time() - began:.0f} s; picture: {given.out / 'diffusion.png'}\n")

    c = Checks()
    for name, run in runs.items():
        check(c, name, run)
    helix = runs["helix"]
    p, q = np.unravel_index(np.abs(helix.N[:3, 3:]).argmax(), (3, 3))
    c.near("helix: its largest coupling of turn and displacement", helix.C[p, 3 + q] / helix.N[p, 3 + q], 1.0,
           4 * helix.deviation(p, 3 + q) / abs(helix.N[p, 3 + q]))
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
