#!/usr/bin/env python3
"""Three and two spheres fall without inertia: paths of fix stokes_dynamics/overdamped with one point per sphere against
converged ones of the same model, which are computed here; with multiblobs beside exact and published ones.

    run.py --out DIR        results and the picture go to DIR (default: build/examples/falling_three)
    run.py --update         also refreshes the picture in this folder
    run.py --figure FILE    FILE: the whole published figure, rows "x, z" (see figure5.csv); also prints the distances
                            to it

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, dumped, finished, need, open_axes, options, save, values  # noqa: E402

THREE = np.array([(-5.0, 0, 0), (0, 0, 0), (7.0, 0, 0)])
# Exact Stokes flow at t = 200 (multipoles of orders 5 and 7 agree to 3e-6), x and z
EXACT = np.array([(-3.75262, -257.61411), (7.25190, -258.32847), (1.03032, -258.74972)])
END = 200.0
# what a sphere is: points, films
MODELS = {"one point": (1, "no"), "multiblob 12": (12, "yes"), "multiblob 42": (42, "yes")}


# --- the same model by other means -------------------------------------------------------------------------------


def velocities(x):
    """Rotne-Prager-Yamakawa tensor of equal spheres that do not overlap, each with weight 1 along -z"""
    r = x[:, None] - x[None]
    s = np.linalg.norm(r, axis=2) + np.eye(len(x))
    f, g = 0.75 / s * (1 + 2 / (3 * s**2)), 0.75 / s * (1 - 2 / s**2)
    u = -(g / s**2 * r[:, :, 2])[:, :, None] * r
    u[:, :, 2] -= f
    u[np.arange(len(x)), np.arange(len(x))] = (0, 0, -1)
    return u.sum(axis=1)


def runge_kutta(x, end, n):
    """Fourth order; places at n + 1 times"""
    path, h = [x], end / n
    for _ in range(n):
        k1 = velocities(x)
        k2 = velocities(x + h / 2 * k1)
        k3 = velocities(x + h / 2 * k2)
        k4 = velocities(x + h * k3)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        path.append(x)
    return np.array(path)


# --- runs ---------------------------------------------------------------------------------------------------------


def lammps(out, tag, **variables):
    """Places and velocities [frames, spheres, 6]"""
    path = out / f"{tag}.path"
    command = ["stdbuf", "-oL", "lmp", "-in", "in.falling_three", "-log", str(out / f"log.{tag}"), "-var", "path",
               str(path)]
    finished("falling_three", command + values(variables), HERE)
    return np.array([rows[:, 1:] for _, rows in dumped(path)])


def distances(points, path):
    """Sideways, of points x z from the nearest path of a sphere at that height"""
    result = []
    for x, z in points:
        at = [np.interp(-z, -path[:, k, 2], path[:, k, 0]) for k in range(3)]
        result.append(min(abs(x - a) for a in at))
    return np.array(result)


def medians(points, path):
    """Distance to the points of each hundred radii of depth"""
    away, depth = distances(points, path), -points[:, 1]
    return [float(np.median(away[(depth >= top) & (depth < top + 100)])) for top in range(0, int(depth.max()) + 1, 100)]


def draw(paths, figure5, errors, target):
    open_axes()
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5.5), layout="constrained", width_ratios=[1.8, 1])
    for (name, path), (style, wide) in zip(paths.items(), ((":", 1), ("--", 1.2), ("-", 1.5))):
        for k, colour in enumerate(("C0", "C1", "C2")):
            left.plot(-path[:, k, 2], path[:, k, 0], style, color=colour, lw=wide)
        left.plot([], [], style, color="k", lw=wide, label=name)
    left.plot(-figure5[:, 1], figure5[:, 0], "ko", ms=3, label="Durlofsky, Brady & Bossis 1987")
    left.plot(-EXACT[:, 1], EXACT[:, 0], "x", color="crimson", ms=8, mew=2, label="exact Stokes flow, t = 200")
    left.set(xlabel="depth / radius", ylabel="x / radius", title="Three spheres fall side by side", xlim=(0, 720))
    left.legend(fontsize=9, loc="upper left", ncols=2)
    left.set_ylim(-6, 17)
    for scheme, marker in (("ab2", "o-"), ("euler", "s-")):
        steps, e = np.array(errors[scheme]).T
        right.loglog(steps, e, marker, label=scheme)
    right.set(xlabel="time step, in radii of fall of a lone sphere",
              ylabel="largest error of a place at t = 100 / radius",
              title="Adams-Bashforth and Euler")
    right.grid(alpha=0.3)
    right.legend()
    save(figure, target)


def main():
    given = options(__file__, __doc__, figure="")
    out = given.out
    need("lmp")
    reference = runge_kutta(THREE, END, 4000)
    middle = reference[2000]

    errors = {}
    for scheme in ("ab2", "euler"):
        errors[scheme] = []
        for step in (4.0, 2.0, 1.0, 0.5, 0.25):
            end = lammps(out, f"{scheme}_{step}", step=step, scheme=scheme, time=100.0, frames=1)[-1, :, :3]
            errors[scheme].append((step, np.abs(end - middle).max()))
            print(f"  {scheme}, step {step}: largest error at t = 100 {errors[scheme][-1][1]:.2e} radii", flush=True)
    paths = {name: lammps(out, f"three_{points}", step=0.25, time=600.0, frames=1200, points=points, films=films)
             for name, (points, films) in MODELS.items()}
    at_end = int(END / 600 * 1200)
    path = lammps(out, "three", step=0.05, frames=400)
    fine = np.abs(lammps(out, "fine", step=0.001, time=40.0, frames=1)[-1, :, :3] - reference[800]).max()
    two = lammps(out, "two", case="two", step=1.0, time=40.0, frames=1)[-1]
    figure5 = np.loadtxt(HERE / "figure5.csv", delimiter=",", skiprows=3)
    draw(paths, figure5, errors, out / "falling_three.png")
    if given.figure:
        whole = np.loadtxt(given.figure, delimiter=",")
        for name, p in paths.items():
            print(f"  {name}: median sideways distance to the whole figure, each 100 radii: " +
                  " ".join(f"{d:.2f}" for d in medians(whole, p)))
    print(f"picture: {out / 'falling_three.png'}\n")

    c = Checks()
    slope = {s: np.log2(errors[s][-2][1] / errors[s][-1][1]) for s in errors}
    c.near("order of ab2", slope["ab2"], 2.0, 0.1)
    c.near("order of euler", slope["euler"], 1.0, 0.05)
    c.below("error of ab2 at step 0.25, in radii", errors["ab2"][-1][1], 4e-4)
    c.below("error of ab2 at step 0.001 and t = 40, in radii", fine, 1e-8)
    c.below("error at step 0.05 and t = 200, in radii", np.abs(path[-1, :, :3] - reference[-1]).max(), 1e-3)
    pair = np.array([(0.0, 0, 0), (2.6, 0, 1.2)])
    c.below("two equal spheres keep distance and speed: error of their places at t = 40, steps of 1",
            np.abs(two[:, :3] - pair - 40 * velocities(pair)).max(), 1e-11)
    for name, first, second in (("one point", 0.1, 0.2), ("multiblob 12", 0.05, 0.05), ("multiblob 42", 0.05, 0.05)):
        near, far = medians(figure5, paths[name])[:2]
        c.below(f"{name}: median sideways distance to the published paths down to -100, in radii", near, first)
        c.below(f"{name}: the same from -100 to -200", far, second)
    for name, low, high in (("one point", 0.35, 0.45), ("multiblob 12", 0.0, 0.05), ("multiblob 42", 0.0, 0.05)):
        place = paths[name][at_end, :, :3:2]
        c.within(f"{name}: largest distance to exact Stokes flow at t = 200, in radii", np.abs(place - EXACT).max(),
                 low, high)
    deep = [np.array([np.interp(600, -p[:, k, 2], p[:, k, 0]) for k in range(3)])
            for p in (paths["multiblob 12"], paths["multiblob 42"])]
    c.below("multiblob 12 beside 42 at a depth of 600, largest distance in radii", np.abs(deep[0] - deep[1]).max(), 0.5)
    if given.update:
        shutil.copy(out / "falling_three.png", HERE)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
