#!/usr/bin/env python3
"""Two spheres in a strain and in a shear flow: the functions A and B of Batchelor & Green, stresslets, paths that pass
and closed ones, by multiblobs with films beside exact Stokes flow.

    run.py --out DIR    tables and picture go to DIR (default: build/examples/shear_pair)
    run.py --update     also refreshes the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from in_lammps import InLammps  # noqa: E402
from runs import np, plt, dumped, finished, need, open_axes, options, read_table, save, values  # noqa: E402

EXACT = {key: np.array([float(row[key]) for row in read_table(HERE / "exact.csv")])
         for key in ("gap", "A", "B", "S_along", "S_with", "S_across")}
GAPS, ORIENTATIONS = EXACT["gap"][::2], 12
MODELS = {"multiblob 12": ("o", "C0"), "multiblob 42": ("s", "C2")}
# first places: x, y, z of the second sphere as seen from the first
PASSING = {"1.6 off the plane": (-10, 1.6, 0), "1 off": (-10, 1.0, 0), "0.6 off, 0.6 to the side": (-10, 0.6, 0.6)}
PASS = 34.0
# first places, times, and how far half a turn may end from where it began
CLOSED = {"closed, in the plane": ((3, 0, 0), 25.0, 0.25), "closed, side by side": ((0, 0.5, 2.05), 40.0, 0.05)}


# --- exact ------------------------------------------------------------------------------------------------------------


def functions(gap):
    """A and B at a gap, interpolated; from there on the leading terms of Batchelor & Green (1972)"""
    r = 2 + gap
    if gap > EXACT["gap"][-1]:
        return 5 / r**3 - 8 / r**5 + 25 / r**6, 16 / (3 * r**5)
    at, known = np.log(gap), np.log(EXACT["gap"])
    # what varies little: (1 - A) over the gap near contact, A r^3 far away, both in 1 - A over x/(1 + x)
    near = EXACT["gap"] / (1 + EXACT["gap"])
    return (1 - cubic(at, known, (1 - EXACT["A"]) / near) * gap / (1 + gap),
            cubic(at, known, EXACT["B"] * (2 + EXACT["gap"])**3) / r**3)


def cubic(x, xs, ys):
    """Lagrange's polynomial through the four nearest places"""
    first = min(max(np.searchsorted(xs, x) - 2, 0), len(xs) - 4)
    return sum(ys[i] * np.prod([(x - xs[j]) / (xs[i] - xs[j]) for j in range(first, first + 4) if j != i])
               for i in range(first, first + 4))


def drift(r):
    """Velocity of the second sphere as seen from the first in the flow (y, 0, 0)"""
    s = np.linalg.norm(r)
    d, strained = r / s, 0.5 * np.array([r[1], r[0], 0.0])
    A, B = functions(s - 2)
    along = d * (d @ strained)
    return np.array([r[1], 0.0, 0.0]) - A * along - B * (strained - along)


def exact_path(r, time, steps=12000):
    """Runge & Kutta, fourth order"""
    path, h = [np.array(r, float)], time / steps
    for _ in range(steps):
        r = path[-1]
        k1 = drift(r)
        k2 = drift(r + h / 2 * k1)
        k3 = drift(r + h / 2 * k2)
        k4 = drift(r + h * k3)
        path.append(r + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
    return np.array(path)


# --- runs -------------------------------------------------------------------------------------------------------------


def measured(lammps, model):
    """A, B and the three stresslets at GAPS: mean and scatter over orientations of the pair [gaps, 5] each"""
    random, found = np.random.default_rng(20061), []
    turns = [np.linalg.qr(random.normal(size=(3, 3)))[0] for _ in range(ORIENTATIONS)]
    for gap in GAPS:
        rows = []
        for d, n, m in turns:
            r = 2 + gap
            lammps.place(np.array([-r / 2 * d, r / 2 * d]),
                         f"cut_off_distance inf {model} lubrication yes lubrication_gap 1e-6 "
                         "fluid_velocity v_ux v_uy v_uz")
            stresslets = []
            for E in (np.outer(d, d) - np.eye(3) / 3, (np.outer(d, n) + np.outer(n, d)) / 2,
                      (np.outer(m, n) + np.outer(n, m)) / 2):
                v, S = lammps.strained(E)
                stresslets.append((v[1] - v[0], np.einsum("kab,ab->k", S, E).mean() / np.sum(E * E)))
            rows.append((-stresslets[0][0] @ d / (2 / 3 * r), -stresslets[1][0] @ n / (r / 2),
                         *[S for _, S in stresslets]))
        found.append((np.mean(rows, axis=0), np.std(rows, axis=0)))
    return np.array(found).transpose(1, 0, 2)


def path_of(out, tag, start, time, step=0.01, points=12):
    """Second sphere as seen from the first [frames, 3]"""
    x, y, z = start
    file = out / f"{tag.replace(' ', '_')}.path"
    finished("shear_pair", ["lmp", "-in", "in.shear_pair", "-log", "none"] +
             values(dict(x=x, y=y, z=z, time=time, step=step, points=points, path=file,
                         every=max(1, round(0.05 / step)))), HERE)
    return np.array([rows[1, 1:4] - rows[0, 1:4] for _, rows in dumped(file)])


def half_turn(path, time):
    """Time of half a turn about z, and x, y, z then, turned back"""
    angle = np.unwrap(np.arctan2(path[:, 1], path[:, 0]))
    done = angle[0] - angle
    k = int(np.argmax(done >= np.pi))
    share = (np.pi - done[k - 1]) / (done[k] - done[k - 1])
    place = path[k - 1] + share * (path[k] - path[k - 1])
    return (k - 1 + share) * time / (len(path) - 1), place * (-1, -1, 1)


def draw(found, paths, exact, target):
    open_axes()
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13, 4.6), layout="constrained",
                                                 width_ratios=[1, 1, 1.5])
    for panel, first, names in ((left, 0, ("A", "B")), (middle, 2, ("S_along", "S_with", "S_across"))):
        for k, name in enumerate(names):
            panel.semilogx(EXACT["gap"], EXACT[name], "k-", lw=1, label="exact" if k == 0 else None)
            panel.annotate({"S_along": "along", "S_with": "shear with it", "S_across": "across"}.get(name, name),
                           (1.4e-5, EXACT[name][0]), xytext=(0, 6), textcoords="offset points")
        for model, (mark, colour) in MODELS.items():
            mean, scatter = found[model]
            for k in range(len(names)):
                panel.errorbar(GAPS, mean[:, first + k], scatter[:, first + k], fmt=mark, color=colour,
                               ms=5 if mark == "o" else 3, label=model if k == 0 else None)
        panel.set(xlabel="gap / radius")
    left.legend(loc="center left", bbox_to_anchor=(0, 0.62), fontsize=8)
    left.set(title="motion in a strain", ylim=(0, 1.12))
    middle.set(title="stresslet / that of a lone sphere", ylim=(0.85, 2.05))
    circle = np.exp(1j * np.linspace(0, 2 * np.pi, 100))
    right.fill(circle.real, circle.imag, color="0.75")
    right.plot(2 * circle.real, 2 * circle.imag, "k:", lw=0.7)
    for k, (name, path) in enumerate(paths.items()):
        for turned in (1, -1):
            right.plot(turned * exact[name][:, 0], turned * exact[name][:, 1], "k-", lw=1)
            right.plot(turned * path[::8, 0], turned * path[::8, 1], ".", color=f"C{k}", ms=5)
        right.plot([], [], ".", color=f"C{k}", label=name)
    right.set(aspect="equal", xlim=(-6, 6), ylim=(-2.7, 2.7), xlabel="x / radius", ylabel="y / radius",
              title="paths in a shear (exact: lines)")
    right.legend(fontsize=8, loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2)
    save(figure, target)


def main():
    given = options(__file__, __doc__)
    need("lmp")
    lammps, c = InLammps(given.out), Checks()
    found = {model: measured(lammps, model) for model in MODELS}
    columns = ("A", "B", "S_along", "S_with", "S_across")
    print("\n  gap        " + "".join(f"{name:>26}" for name in columns) + "     (exact, 12 points, 42 points)")
    for i, gap in enumerate(GAPS):
        print(f"  {gap:<10.6g} " + "".join(f"{EXACT[name][2 * i]:10.4f}" +
                                           "".join(f"{found[m][0][i, k]:8.4f}" for m in MODELS)
                                          for k, name in enumerate(columns)))
    near = (GAPS >= 1e-5) & (GAPS <= 0.51)
    for model, limit in (("multiblob 12", 1.0), ("multiblob 42", 0.7)):
        for k, name in enumerate(columns):
            # of B, which vanishes far away, relative to where the spheres touch
            scale = EXACT[name][::2] if name != "B" else EXACT["B"][0]
            off = 100 * np.abs(found[model][0][:, k] - EXACT[name][::2]) / scale
            c.below(f"{model}: {name} at gaps up to 0.5, worst error, %", off[near].max(), limit)

    paths, exact = {}, {}
    for name, start in PASSING.items():
        paths[name], exact[name] = path_of(given.out, name, start, PASS), exact_path(start, PASS)
        gaps = [np.linalg.norm(p, axis=1).min() - 2 for p in (paths[name], exact[name])]
        c.near(f"passing, {name}: smallest gap", gaps[0], gaps[1], 0.2 * gaps[1])
        c.below(f"passing, {name}: distance to the exact path at the end, sideways",
                np.abs(paths[name][-1] - exact[name][-1])[1:].max(), 0.03)
        c.below(f"passing, {name}: distance to the mirror image of its beginning, sideways",
                abs(np.interp(-start[0], paths[name][:, 0], paths[name][:, 1]) - start[1]), 0.03)
    for name, (start, time, apart) in CLOSED.items():
        path, whole = path_of(given.out, name, start, time), exact_path(start, time)
        (half, place), (exact_half, _) = half_turn(path, time), half_turn(whole, time)
        gaps = [np.linalg.norm(p, axis=1).min() - 2 for p in (path, whole)]
        print(f"  {name}: smallest gap {gaps[0]:.2e}, exact {gaps[1]:.2e}")
        c.below(f"{name}: distance to where it began after half a turn, turned back", np.linalg.norm(place - start),
                apart)
        c.near(f"{name}: time of half a turn over the exact one", half / exact_half, 1, 0.08)
        paths[name], exact[name] = path, whole
    draw(found, paths, exact, given.out / "shear_pair.png")
    if given.update:
        shutil.copy(given.out / "shear_pair.png", HERE)
    sys.exit(c.finish())


if __name__ == "__main__":
    main()
