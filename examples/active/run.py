#!/usr/bin/env python3
"""Active Brownian particles (in.active): one alone, two that feel each other's flow, thousands that do not, and a crowd
in a layer.

    run.py --out DIR     results and the picture go to DIR (default: build/examples/active)
    run.py --quick       fewer particles, and no crowd: seconds
    run.py --update      also refreshes the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, dumped, finished, need, options, save, values  # noqa: E402

ALONE, TOGETHER = "clumps_only yes rotation yes", "cut_off_distance inf rotation yes"
SPIN = 4 / 3                     # 8 pi eta a^3, as 6 pi eta a is 1
PECLET, D_R = 10.0, 1 / SPIN     # of the walkers: v a/D; kT, and so D, is 1
LAG, STEP = 20, 0.005            # of their frames, in steps
CROWD, EDGE, KT = 324, 54.0, 0.01


def write(path, x, e, low, high):
    """Data file of spheres at x with the directions e, in a box"""
    rows = "".join("{} 1 {:.17g} {:.17g} {:.17g} 2 1 0 {:.17g} {:.17g} {:.17g} 0\n".format(i + 1, *p, *d)
                   for i, (p, d) in enumerate(zip(x, e)))
    box = "".join(f"{a} {b} {c}lo {c}hi\n" for a, b, c in zip(low, high, "xyz"))
    path.write_text(f"active\n\n{len(x)} atoms\n1 atom types\n{box}\nMasses\n\n1 1\n\nAtoms\n\n{rows}")


def run(out, name, **variables):
    """Steps and rows [frames, spheres, 12]: place, velocity, angular velocity, direction"""
    finished("active", ["lmp", "-in", "in.active", "-log", str(out / f"{name}.log")] + values(
        dict(spheres=out / f"{name}.data", out=out / f"{name}.places", **variables)), HERE)
    steps, rows = zip(*dumped(out / f"{name}.places"))
    return np.array(steps), np.array(rows)[:, :, 1:]


def directions(n, rng):
    e = rng.normal(size=(n, 3))
    return e / np.linalg.norm(e, axis=1)[:, None]


# --- two of them, by a dense matrix -----------------------------------------------------------------------------------

def flow_of_all(x, F):
    """Velocity and angular velocity [n, 3] of spheres of radius 1 that do not overlap, 6 pi eta = 1 (Rotne & Prager
    1969)"""
    U, W = F.copy(), np.zeros_like(F)
    for i in range(len(x)):
        for j in set(range(len(x))) - {i}:
            r = x[i] - x[j]
            s = np.linalg.norm(r)
            along = r * (r @ F[j]) / s**2
            U[i] += 3 / (4 * s) * ((1 + 2 / (3 * s**2)) * F[j] + (1 - 2 / s**2) * along)
            W[i] += 3 / 4 * np.cross(F[j], r) / s**3
    return U, W


def dense_path(x, e, t, n):
    """Places and directions after the time t in n steps of Runge and Kutta's method"""
    def rate(x, e):
        U, W = flow_of_all(x, e)
        return np.array([U, np.cross(W, e)])
    y, h = np.array([x, e]), t / n
    for _ in range(n):
        k1 = rate(*y)
        k2 = rate(*(y + h / 2 * k1))
        k3 = rate(*(y + h / 2 * k2))
        y = y + h / 6 * (k1 + 2 * k2 + 2 * k3 + rate(*(y + h * k3)))
    return y


def pair(out, c):
    x, e = np.array([(0, 0, 0), (3.0, 1.0, 0.5)]), np.array([(0.6, 0.8, 0), (0, 0.28, 0.96)])
    write(out / "one.data", x[:1], e[:1], [-30] * 3, [30] * 3)
    _, rows = run(out, "one", steps=10, every=10)
    c.below("one alone: its velocity from push/(6 pi eta a) along its direction", np.abs(rows[-1, 0, 3:6] - e[0]).max(),
            1e-14)
    write(out / "pair.data", x, e, [-30] * 3, [30] * 3)
    steps, rows = run(out, "pair", steps=800, every=10, dt=0.01)
    worst = 0.0
    for frame in rows:
        dense = np.array(flow_of_all(frame[:, :3], frame[:, 9:]))
        worst = max(worst, np.abs(np.array([frame[:, 3:6], frame[:, 6:9]]) - dense).max())
    c.below("two: velocities and angular velocities from a dense matrix, all the way", worst, 1e-10)
    end = dense_path(x, e, 8.0, 4000)
    c.below("two: places after 8 radii, from Runge and Kutta's method", np.abs(rows[-1, :, :3] - end[0]).max(), 1e-4)
    c.below("two: directions there", np.abs(rows[-1, :, 9:] - end[1]).max(), 1e-4)
    return rows


# --- thousands, each for itself ---------------------------------------------------------------------------------------

def walk_law(t, v):
    """Mean square displacement with D = kT = 1"""
    return 6 * t + v**2 / (2 * D_R**2) * (2 * D_R * t - 1 + np.exp(-2 * D_R * t))


def walkers(out, c, n, steps):
    rng, m = np.random.default_rng(1), int(np.ceil(np.sqrt(n)))
    k = np.arange(n)
    x = np.column_stack([k % m + 0.5, k // m + 0.5, 0 * k])
    write(out / "walkers.data", x, directions(n, rng), [0, 0, -m / 2], [m, m, m / 2])
    _, rows = run(out, "walkers", model=ALONE, edges="p", push=PECLET, kT=1, dt=STEP, steps=steps, every=LAG)
    x, e = rows[:, :, :3], rows[:, :, 9:]
    lags = np.unique(np.geomspace(1, 2.5 / (D_R * STEP * LAG), 14).astype(int))
    t, square, memory, error = lags * LAG * STEP, [], [], []
    for lag in lags:
        d = ((x[lag:] - x[:-lag])**2).sum(axis=2).mean(axis=0)       # of each walker
        square.append(d.mean())
        error.append(d.std() / np.sqrt(n) / d.mean())
        memory.append((e[lag:] * e[:-lag]).sum(axis=2).mean())
    square, memory, error = np.array(square), np.array(memory), np.array(error)
    law = walk_law(t, PECLET)
    print(f"  walkers: standard error of the last mean square displacement {100 * error[-1]:.2f} %")
    c.below("walkers: mean square displacement over its law, less 1, in standard errors",
            (np.abs(square / law - 1) / error).max(), 3.5)
    c.below("walkers: mean of e(0).e(t) from exp(-2 D_r t)", np.abs(memory - np.exp(-2 * D_R * t)).max(),
            3 / np.sqrt(n))
    late = (square[-1] + PECLET**2 / (2 * D_R**2) * (1 - np.exp(-2 * D_R * t[-1]))) / (6 * t[-1])
    c.near("walkers: long-time diffusion over D + v^2/(6 D_r)", late / (1 + PECLET**2 / (6 * D_R)), 1,
           max(0.02, 3 * error[-1]))
    return t, square


# --- a crowd ----------------------------------------------------------------------------------------------------------

def crowd(out, c):
    rng, m = np.random.default_rng(3), int(np.ceil(np.sqrt(CROWD)))
    k, found = np.arange(CROWD), {}
    x = np.column_stack([(k % m + 0.5) * EDGE / m, (k // m + 0.5) * EDGE / m, 0 * k])
    e = directions(CROWD, rng)
    for name, model in (("alone", ALONE), ("together", TOGETHER)):
        write(out / f"{name}.data", x, e, [0, 0, -EDGE / 2], [EDGE, EDGE, EDGE / 2])
        steps, rows = run(out, name, model=model, edges="p", kT=KT, dt=0.02, layer=5, contact=15, steps=8000, every=400)
        now, late = rows[:, :, 9:], rows[len(rows) // 2:]
        memory = (now[1:] * now[:-1]).sum(axis=2).mean()
        spread = np.std([np.histogram2d(*np.mod(frame[:, :2], EDGE).T, bins=3, range=[[0, EDGE]] * 2)[0]
                         for frame in late], axis=(1, 2))
        found[name] = rows[-1], memory
        print(f"  crowd, {name}: mean of e(0).e(8) {memory:.3f}; spheres in a ninth of the layer {CROWD / 9:.0f} +- "
              f"{spread.mean():.1f}; mean speed in the layer {np.linalg.norm(late[:, :, 3:5], axis=2).mean():.3f}",
              flush=True)
    law = np.exp(-2 * KT * D_R * 8)
    c.near("crowd without hydrodynamics: e(0).e(8), closed form", found["alone"][1], law, 0.01)
    c.within("crowd with hydrodynamics: flows turn the spheres, e(0).e(8)", found["together"][1], 0.4, 0.8)
    return found


def discs(panel, frame, title):
    x, angle = np.mod(frame[:, :2], EDGE), np.arctan2(frame[:, 10], frame[:, 9])
    colours = plt.get_cmap("twilight")((angle + np.pi) / (2 * np.pi))
    for shift in np.array(np.meshgrid([-1, 0, 1], [-1, 0, 1])).reshape(2, -1).T * EDGE:
        for p, colour in zip(x + shift, colours):
            if (np.abs(p - EDGE / 2) < EDGE / 2 + 1).all():
                panel.add_patch(plt.Circle(p, 1, fc=colour, ec="0.3", lw=0.4))
    panel.set(xlim=(0, EDGE), ylim=(0, EDGE), xticks=[], yticks=[], title=title)
    panel.set_aspect("equal")


def draw(walk, found, path):
    plt.rcParams.update({"font.size": 10})
    figure, panels = plt.subplots(1, 3, figsize=(13, 4.4), layout="constrained")
    t, square = walk
    fine = np.geomspace(t[0], t[-1], 200)
    panels[0].loglog(fine, walk_law(fine, PECLET), "k-", lw=1.2, label="closed form")
    panels[0].loglog(fine, 6 * fine, ":", color="0.5", label="without a push")
    panels[0].loglog(t, square, "o", color="C1", label="run")
    panels[0].set(xlabel="time, in a^2/D", ylabel="mean square displacement, in a^2",
                  title="particles that do not feel each other")
    panels[0].legend(frameon=False)
    for panel, name, title in zip(panels[1:], ("alone", "together"), ("without hydrodynamics", "with hydrodynamics")):
        discs(panel, found[name][0], f"a crowd {title}")
    save(figure, path)


def main():
    given = options(__file__, __doc__, quick=False)
    need("lmp")
    c = Checks()
    pair(given.out, c)
    walk = walkers(given.out, c, *((1000, 1600) if given.quick else (4000, 3200)))
    if not given.quick:
        draw(walk, crowd(given.out, c), given.out / "active.png")
        if given.update:
            shutil.copy(given.out / "active.png", HERE)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
