#!/usr/bin/env python3
"""Viscosity of suspensions by multiblobs: of dilute rigid clumps and of pairs of spheres beside exact numbers, and of
200 spheres in steady shear beside published laws.

    run.py --out DIR            clumps, pairs, a short shear, and the picture with shear.csv; to DIR (default:
                                build/examples/viscosity)
    run.py --strain 25          also shears each suspension by so much (an hour)
    run.py --strain 25 --update also refreshes shear.csv and the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from equilibrium import hard_spheres, write_data  # noqa: E402
from in_lammps import InLammps  # noqa: E402
from runs import np, plt, dumped, finished, need, open_axes, options, read_table, save, values  # noqa: E402

MODELS = ("multiblob 12", "multiblob 42")
PHIS, N, SETTLED, BLOCK = (0.1, 0.2, 0.3, 0.4), 200, 5.0, 2.5
STRAINS = [np.array(E) / np.linalg.norm(E) for E in (
    [[0, 1, 0], [1, 0, 0], [0, 0, 0]], [[0, 0, 1], [0, 0, 0], [1, 0, 0]], [[0, 0, 0], [0, 0, 1], [0, 1, 0]],
    [[1, 0, 0], [0, -1, 0], [0, 0, 0]], [[1, 0, 0], [0, 1, 0], [0, 0, -2]])]


def shapes():
    """Centres of touching spheres"""
    found = {"sphere": np.zeros((1, 3)), "doublet": np.array([(0, 0, -1.0), (0, 0, 1.0)]),
             "triangle": np.array([(0, 0, 0), (2, 0, 0), (1, 3**0.5, 0)]),
             "tetrahedron": np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]) / 2**0.5}
    for n in (3, 5, 10, 20):
        found[f"row of {n}"] = np.array([(0, 0, 2.0 * k) for k in range(n)])
    return {row["shape"]: (found[row["shape"]], float(row["last"])) for row in read_table(HERE / "clumps.csv")}


def answer(lammps, E):
    """Stresslets of all spheres together in the strain E, of which what is along E, in those of a lone sphere"""
    return np.sum(lammps.strained(E)[1].sum(axis=0) * E)


def intrinsic(lammps, x, model):
    lammps.place(x - x.mean(axis=0), f"cut_off_distance inf {model} rigid_clumps yes fluid_velocity v_ux v_uy v_uz",
                 molecule=1)
    return 2.5 / len(x) * np.mean([answer(lammps, E) for E in STRAINS])


# --- pairs: the coefficient of phi^2 ----------------------------------------------------------------------------------


def excess(lammps, r, direction, model):
    """Mean stresslet of a sphere of a free pair over all strains, less that of a lone sphere"""
    lammps.place(np.outer([-r / 2, r / 2], direction),
                 f"cut_off_distance inf {model} lubrication yes lubrication_gap 1e-6 "
                 "fluid_velocity v_ux v_uy v_uz", tolerance=1e-9)
    return np.mean([answer(lammps, E) for E in STRAINS]) / 2 - 1


def of_pairs(lammps, model, nodes=16, far=20.0):
    """Viscosity 1 + 5/2 phi + c phi^2 of spheres at random places: c = 5/2 + 15/2 int J r^2 dr over r > 2, J the excess
    of a pair at r; J falls as r^-6 (Batchelor & Green 1972). With r = 2/u, u = 1 - (1 - v)^3 nodes are dense at
    contact."""
    directions = np.linalg.qr(np.random.default_rng(4711).normal(size=(3, 3)))[0]
    last = 1 - (1 - 2 / far)**(1 / 3)
    points, weights = np.polynomial.legendre.leggauss(nodes)
    c = 2.5 + 7.5 * excess(lammps, far, directions[0], model) * far**3 / 3
    for v, w in zip(last + (1 - last) * (points + 1) / 2, (1 - last) * weights / 2):
        u = 1 - (1 - v)**3
        c += 7.5 * 8 / u**4 * 3 * (1 - v)**2 * w * np.mean([excess(lammps, 2 / u, d, model) for d in directions])
    return c


# --- steady shear -----------------------------------------------------------------------------------------------------


def equilibrium_law(phi):
    """High-frequency viscosity of hard spheres at equilibrium: Sierou & Brady, J. Fluid Mech. 448, 115 (2001)"""
    crowd = phi * (1 + phi * (1 + phi - 2.3 * phi**2))
    return (1 + 1.5 * crowd) / (1 - crowd)


def morris_boulay(phi, most=0.68):
    """J. Rheol. 43, 1213 (1999)"""
    x = phi / most
    return 1 + 2.5 * phi / (1 - x) + 0.1 * x**2 / (1 - x)**2


def zarraga(phi):
    """Experiments: Zarraga, Hill & Leighton, J. Rheol. 44, 185 (2000)"""
    return np.exp(-2.34 * phi) / (1 - phi / 0.62)**3


def sheared(out, tag, phi, n, **variables):
    """Rows of the file of stresses: step, 18 stresses, products of the solve, smallest gap"""
    folder = out / tag
    folder.mkdir(exist_ok=True)
    write_data(folder / "spheres.data", *next(hard_spheres(n, phi, 1, seed=3)))
    finished("viscosity", ["lmp", "-in", "in.shear", "-log", str(folder / "log"), "-nocite"] +
             values(dict(variables, data=folder / "spheres.data", out=folder)), HERE)
    return np.loadtxt(folder / "stress", ndmin=2)


def viscosity_of(rows):
    return 1 - rows[:, 4] - rows[:, 10] - rows[:, 16]


def normal_stresses(rows):
    """First and second difference over the viscosity of the fluid and the rate; signs of compute pressure"""
    xx, yy, zz = (-(rows[:, k] + rows[:, k + 6] + rows[:, k + 12]) for k in (1, 2, 3))
    return xx - yy, yy - zz


def mean_of_blocks(strain, curve):
    """Mean of what comes after SETTLED, and its standard error from blocks of the strain"""
    block = ((strain - SETTLED) // BLOCK).astype(int)
    means = [curve[block == b].mean() for b in range(block.max() + 1) if (block == b).sum() > 0.9 * (block == 0).sum()]
    return np.mean(means), np.std(means, ddof=1) / len(means)**0.5


def steady(out, phi, strain, step=0.01):
    rows = sheared(out, f"shear_{phi}", phi, N, strain=strain, step=step, every=5)
    at = rows[:, 0] * step
    result = dict(phi=phi, strain=strain)
    for name, curve in (("viscosity", viscosity_of(rows)), ("films", -rows[:, 10]), ("contacts", -rows[:, 16]),
                        *zip(("N1", "N2"), normal_stresses(rows))):
        result[name], result[name + "_error"] = mean_of_blocks(at, curve)
    middle = len(rows) // 2
    result["products"], result["products_late"] = rows[len(rows) // 10:middle, 19].mean(), rows[middle:, 19].mean()
    result["gap"] = rows[:, 20].min()
    print(f"  phi {phi}: " + ", ".join(f"{key} {value:.4g}" for key, value in result.items()), flush=True)
    return result


def order_of_the_step(out, phi=0.2, n=32, strain=0.4):
    """Largest error of a place across the faces of the sheared box, by steps"""
    ends = {}
    for step in (0.04, 0.02, 0.005):
        sheared(out, "order", phi, n, strain=strain, step=step, frames=strain, every=2, tolerance=1e-7)
        *_, (_, rows) = dumped(out / "order" / "spheres")
        ends[step] = rows[np.argsort(rows[:, 0]), 1:4]
    edge, fine = (4 / 3 * np.pi * n / phi)**(1 / 3), ends.pop(0.005)
    errors = {}
    for step, end in ends.items():
        d = end - fine
        turns = np.rint(d[:, 1] / edge)
        d[:, 0] -= turns * strain * edge
        errors[step] = np.abs(d - edge * np.rint(d / edge)).max()
    return errors


# --- picture and figures ----------------------------------------------------------------------------------------------


def draw(clumps, table, path):
    open_axes()
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.6), layout="constrained", width_ratios=[1, 1.2])
    names, place = list(clumps), np.arange(len(clumps))
    left.bar(place, [exact for exact, _ in clumps.values()], color="0.8", width=0.7, label="exact")
    for k, (model, mark) in enumerate(zip(MODELS, "os")):
        left.plot(place, [found[k] for _, found in clumps.values()], mark, color=f"C{2 * k}", ms=7 - 3 * k, label=model)
    for x, (exact, found) in zip(place, clumps.values()):
        left.annotate(f"{exact:.3g}\n{100 * (found[0] / exact - 1) + 0.0:+.2f} %", (x, exact), xytext=(0, 5),
                      textcoords="offset points", ha="center", fontsize=8)
    left.set_xticks(place, names, rotation=35, ha="right")
    left.set(ylabel="intrinsic viscosity", ylim=(0, 22), title="rigid clumps, dilute")
    left.legend(fontsize=8, loc="upper left")
    phi = np.linspace(0, 0.42, 100)
    right.plot(phi, zarraga(phi), "k--", lw=1, label="experiments: Zarraga et al. 2000")
    right.plot(phi, equilibrium_law(phi), "k-", lw=1, label="at equilibrium, simulations: Sierou & Brady 2001")
    right.plot(phi, morris_boulay(phi), "k:", lw=1.2, label="law of Morris & Boulay 1999")
    y, error = (np.array([float(row[key]) for row in table]) for key in ("viscosity", "viscosity_error"))
    right.errorbar([float(row["phi"]) for row in table], y, 2 * error, fmt="o", color="C0",
                   label="multiblob 12 in steady shear")
    right.set(yscale="log", xlabel="volume fraction", ylabel="viscosity / that of the fluid",
              title="200 spheres in steady shear")
    right.set_yticks((1, 2, 3, 5, 10), (1, 2, 3, 5, 10))
    right.minorticks_off()
    right.legend(fontsize=8, loc="upper left")
    save(figure, path)


def main():
    given = options(__file__, __doc__, strain=0.0)
    need("lmp")
    lammps, c, clumps = InLammps(given.out), Checks(), {}
    for name, (x, exact) in shapes().items():
        clumps[name] = exact, [intrinsic(lammps, x, model) for model in MODELS]
        for model, value, limit in zip(MODELS, clumps[name][1], (0.6, 0.2)):
            c.near(f"intrinsic viscosity of a {name}, {model}, over exact, %", 100 * (value / exact - 1), 0, limit)
    c.near("pairs, multiblob 12: coefficient of phi^2", of_pairs(lammps, "multiblob 12"), 5.0022, 0.1)
    c.near("pairs, multiblob 42: coefficient of phi^2", of_pairs(lammps, "multiblob 42"), 5.0022, 0.1)

    errors = order_of_the_step(given.out)
    print("  largest error of a place by steps: " + ", ".join(f"{step}: {error:.2e}" for step, error in errors.items()))
    c.near("ab2 across sheared faces: error at steps of 0.04 over 0.02, of second order beside 0.005",
           errors[0.04] / errors[0.02], 63 / 15, 0.5)

    if given.strain:
        table = [steady(given.out, phi, given.strain) for phi in PHIS]
        (given.out / "shear.csv").write_text(
            "# 200 spheres in steady shear, over the fluid's viscosity and the rate; errors of the mean. "
            f"run.py --strain {given.strain:g} --update\n" +
            ",".join(table[0]) + "\n" + "".join(",".join(f"{value:.5g}" for value in row.values()) + "\n"
                                                for row in table))
    kept = read_table((given.out if given.strain else HERE) / "shear.csv")
    for row in ({key: float(value) for key, value in row.items()} for row in kept):
        phi, slack = row["phi"], 2 * row["viscosity_error"]
        c.within(f"steady shear, phi {phi}: viscosity, between the published laws", row["viscosity"],
                 morris_boulay(phi) - slack, zarraga(phi) + slack)
        c.below(f"steady shear, phi {phi}: second normal stress difference is negative", row["N2"], 2 * row["N2_error"])
        c.below(f"steady shear, phi {phi}: products of a step, second half over the first",
                row["products_late"] / row["products"], 1.1)
        c.below(f"steady shear, phi {phi}: largest overlap, in radii", -row["gap"], 0.01)
    begin = viscosity_of(sheared(given.out, "short", 0.3, N, strain=0.04, step=0.01, every=1))[0]
    c.near("phi 0.3: viscosity of one set of places at equilibrium, over the published one",
           begin / equilibrium_law(0.3), 1, 0.06)
    draw(clumps, kept, given.out / "viscosity.png")
    if given.update:
        for name in ("viscosity.png",) + (("shear.csv",) if given.strain else ()):
            shutil.copy(given.out / name, HERE)
    sys.exit(c.finish())


if __name__ == "__main__":
    main()
