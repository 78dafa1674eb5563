#!/usr/bin/env python3
"""Viscosity and normal stresses of dense suspensions in steady shear: Brownian hard spheres over the Peclet number
(in.rheology), and grains with and without friction (in.friction), beside published laws.

    run.py --out DIR       short runs beside sweep.csv and friction.csv, and the picture of these; to DIR (default:
                           build/examples/rheology)
    run.py --quick         the same with 32 spheres, some seconds
    run.py --all           every row anew with 500 spheres: --spheres 108 for a smaller box, --sets 2 for two runs a row
    run.py --larger        larger.csv anew: 500 spheres at the ends of the sweep, by short runs
    run.py --all --update  also refreshes the tables and the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from equilibrium import hard_spheres, write_data  # noqa: E402
from runs import np, plt, finished, need, open_axes, options, read_table, save, values  # noqa: E402

PHIS, PECLETS = (0.3, 0.45), (1, 3, 10, 30, 100, 1000)
LARGER = 1, 1000
GRAINS, FRICTIONS, GRAIN_STEP = (0.4, 0.45, 0.5), (0.0, 0.5), 1.4e-3
# Viscosity with friction over that of experiments: a small box jams sooner
BEYOND = {0.4: (0.7, 1.3), 0.45: (0.7, 1.3), 0.5: (1.0, 2.3)}


# --- published laws, viscosity over that of the fluid ---------------------------------------------------------------


def low_shear(phi):
    """Experiments: van der Werff & de Kruif, J. Rheol. 33, 421 (1989)"""
    return (1 - phi / 0.63)**-2


def theory(phi):
    """At low shear, in agreement with those experiments: Verberg, de Schepper & Cohen, Phys. Rev. E 55, 3143 (1997)"""
    at_contact = (1 - phi / 2) / (1 - phi)**3
    return at_contact * (1 + 1.44 * (phi * at_contact)**2 / (1 - 0.1241 * phi + 10.46 * phi**2))


def high_shear(phi):
    """The same"""
    return (1 - phi / 0.71)**-2


def boyer(phi, most=0.585):
    """Experiments with rough spheres: Boyer, Guazzelli & Pouliquen, Phys. Rev. Lett. 107, 188301 (2011)"""
    x = (phi / (most - phi))**2
    return 1 + 2.5 * phi / (1 - phi / most) + (0.32 + 0.38 / (1 + 0.005 * x)) * x


# --- runs -----------------------------------------------------------------------------------------------------------


def step_of(peclet):
    """Time step: small beside what noise and shear move. The contact's stiffness follows from it (in.rheology)"""
    return 1e-3 / (1 + peclet / 10)


def brownian(out, x, edge, peclet, strain, seed):
    """Rows of samples: time; stresses over the viscosity and the rate, of fluid and of contacts, xx yy zz xy each;
    smallest gap"""
    write_data(out / "places.data", x, edge)
    step = step_of(peclet)
    steps = 20 * round(strain / (peclet * step) / 20)
    return ran(out, "in.rheology", places=out / "places.data", Pe=peclet, step=step, run=steps, seed=seed)


def grains(out, phi, mu, cells, strain, seed):
    steps = 20 * round(strain / GRAIN_STEP / 20)
    return ran(out, "in.friction", phi=phi, mu=mu, cells=cells, step=GRAIN_STEP, run=steps, seed=seed)


def ran(out, script, **variables):
    samples = out / "samples.txt"
    command = ["lmp", "-in", script, "-log", str(out / "log"), "-nocite"]
    finished("rheology", command + values(dict(variables, out=samples)), HERE)
    rows = np.loadtxt(samples, ndmin=2)
    rows[:, 0] *= variables["step"]
    return rows


# --- means ----------------------------------------------------------------------------------------------------------


def steady(runs, start, block, rate=1.0):
    """Means of what comes after the time `start`, and their standard errors, from blocks of all runs"""
    means, gap = [], np.inf
    for rows in runs:
        rows = rows[rows[:, 0] > start]
        fluid, contact = rows[:, 1:5], rows[:, 5:9]
        total = fluid + contact
        curves = np.array([total[:, 3], contact[:, 3], total[:, 0] - total[:, 1], total[:, 1] - total[:, 2]])
        number = ((rows[:, 0] - start) / block - 1e-9).astype(int)
        full = [b for b in range(number.max() + 1) if np.sum(number == b) > 0.9 * np.sum(number == 0)]
        means += [curves[:, number == b].mean(axis=1) for b in full]
        gap = min(gap, rows[:, 9].min())
    found, errors = np.mean(means, axis=0), np.std(means, axis=0, ddof=1) / len(means)**0.5
    result = {"runs": len(runs), "strain": rate * block * len(means)}
    for name, value, error in zip(("viscosity", "contacts", "N1", "N2"), found, errors):
        result[name], result[name + "_error"] = value, error
    return dict(result, gap=gap)


def of_brownian(runs, peclet, part=1.0):
    return steady(runs, min(2 / peclet, 0.5), part * min(1 / peclet, 0.5), peclet)


def of_grains(runs):
    return steady(runs, 1.5, 1.0)


def sweep(out, n, sets, peclets=PECLETS, most_strain=8.0, part=1.0):
    """part: of the usual length of a block, where runs are short"""
    for phi in PHIS:
        places = list(hard_spheres(n, phi, sets, seed=1 + int(100 * phi)))
        for peclet in peclets:
            strain = min(1.0, 0.375 * peclet) * most_strain
            runs = [brownian(out, x, edge, peclet, strain, 4711 + k) for k, (x, edge) in enumerate(places)]
            yield told(dict(phi=phi, Pe=peclet, **of_brownian(runs, peclet, part)))


def friction(out, n, sets):
    cells = round((n / 4)**(1 / 3))
    for phi in GRAINS:
        for mu in FRICTIONS:
            runs = [grains(out, phi, mu, cells, 4.5, 4711 + k) for k in range(sets)]
            yield told(dict(phi=phi, mu=mu, **of_grains(runs)))


def told(row):
    print("  " + ", ".join(f"{key} {value:.4g}" for key, value in row.items()), flush=True)
    return row


def write(rows, path, what):
    rows = list(rows)
    lines = [f"# {what}", ",".join(rows[0])] + [",".join(f"{value:.5g}" for value in row.values()) for row in rows]
    path.write_text("\n".join(lines) + "\n")


def columns(rows, *names):
    return [np.array([float(row[name]) for row in rows]) for name in names]


def chosen(rows, **what):
    """Of a kept table, the rows that have these values"""
    return [row for row in rows if all(float(row[key]) == value for key, value in what.items())]


# --- picture --------------------------------------------------------------------------------------------------------


def draw(brownian_rows, larger_rows, grain_rows, path):
    open_axes()
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(12.5, 4.4), layout="constrained")
    for phi, mark, colour in zip(PHIS, "so", ("C0", "C3")):
        rows = chosen(brownian_rows, phi=phi)
        peclet, y, error = columns(rows, "Pe", "viscosity", "viscosity_error")
        left.errorbar(peclet, y, 2 * error, fmt=mark + "-", lw=0.8, color=colour, ms=5, label=f"volume fraction {phi}")
        at, larger_y, error = columns(chosen(larger_rows, phi=phi), "Pe", "viscosity", "viscosity_error")
        left.errorbar(at * 1.15, larger_y, 2 * error, fmt=mark, lw=0.8, color=colour, mfc="white", ms=5)
        left.plot((peclet[0] / 6, peclet[0] / 2), 2 * [low_shear(phi)], "--", color=colour, lw=1.5)
        left.plot((peclet[0] / 6, peclet[0] / 2), 2 * [theory(phi)], ":", color=colour, lw=1.5)
        left.plot((peclet[-1] * 1.5, peclet[-1] * 5), 2 * [high_shear(phi)], "--", color=colour, lw=1.5)
        for name, style, fill, shift in (("N1", "-", colour, 0.94), ("N2", ":", "none", 1.06)):
            y, error = columns(rows, name, name + "_error")
            middle.errorbar(peclet * shift, y, 2 * error, fmt=mark, ls=style, lw=0.8, color=colour, mfc=fill, ms=5,
                            label=f"{name}, {phi}")
    left.plot([], [], "kD", mfc="white", ms=5, label="500 spheres")
    left.plot([], [], "k--", lw=1.5, label="limits of experiments: van der Werff & de Kruif 1989")
    left.plot([], [], "k:", lw=1.5, label="limit of low shear: Verberg et al. 1997")
    over_fluid = "viscosity / that of the fluid"
    left.set(xscale="log", yscale="log", xlabel="Peclet number", ylabel=over_fluid, ylim=(2.4, 38),
             title="Brownian hard spheres")
    left.set_yticks((3, 4, 5, 7, 10, 15), (3, 4, 5, 7, 10, 15))
    middle.axhline(0, color="0.6", lw=0.8)
    middle.set(xscale="log", xlabel="Peclet number", ylabel="N / (viscosity of the fluid x rate of shear)",
               ylim=(-4, 4), title="their normal stress differences")
    phi = np.linspace(0.35, 0.52, 50)
    right.plot(phi, boyer(phi), "k--", lw=1.2, label="experiments: Boyer et al. 2011")
    for mu, mark, colour in zip(FRICTIONS, "os", ("C0", "C1")):
        at, y, error = columns(chosen(grain_rows, mu=mu), "phi", "viscosity", "viscosity_error")
        right.errorbar(at, y, 2 * error, fmt=mark + "-", lw=0.8, color=colour, ms=5, label=f"friction {mu}")
    right.set(yscale="log", xlabel="volume fraction", ylabel=over_fluid, title="grains, without a temperature")
    right.set_xticks(GRAINS, GRAINS)
    right.set_yticks((5, 10, 20, 40, 60), (5, 10, 20, 40, 60))
    for panel in (left, right):
        panel.minorticks_off()
    for panel in (left, middle, right):
        panel.legend(fontsize=8, loc="upper left" if panel is right else "upper right")
    save(figure, path)


# --- figures --------------------------------------------------------------------------------------------------------


def numbers(row):
    return {key: float(value) for key, value in row.items()}


def excess(a, b):
    """Of the viscosity, in standard errors"""
    return (a["viscosity"] - b["viscosity"]) / np.hypot(a["viscosity_error"], b["viscosity_error"])


def check_brownian(c, rows):
    for phi in PHIS:
        at = {row["Pe"]: row for row in map(numbers, chosen(rows, phi=phi))}
        slow, fast, say = at[1], at[1000], f"Brownian, phi {phi}: "
        least = min(at.values(), key=lambda row: row["viscosity"])
        c.within(say + "thins: viscosity at Pe 1 less the least, in errors", excess(slow, least), 2, 1000)
        c.within(say + "thickens: viscosity at Pe 1000 less the least, in errors", excess(fast, least), 2, 1000)
        c.within(say + "Peclet number of the least viscosity", least["Pe"], 3, 100)
        slack, low, high = 2 * slow["viscosity_error"] / slow["viscosity"], low_shear(phi), high_shear(phi)
        c.below(say + "viscosity at Pe 1, over the low-shear limit of experiments", slow["viscosity"] / low, 1 + slack)
        c.near(say + "viscosity at Pe 1000, over their high-shear limit", fast["viscosity"] / high, 1, 0.3)
        sign = (at[3]["N1"] - fast["N1"]) / np.hypot(at[3]["N1_error"], fast["N1_error"])
        c.within(say + "N1 changes its sign: at Pe 3 less that at Pe 1000, in standard errors", sign, 2, 1000)
        c.below(say + "N1 at Pe 1000", fast["N1"], -2 * fast["N1_error"])
        c.below(say + "N2 at Pe 1000", fast["N2"], -2 * fast["N2_error"])


def check_larger(c, larger_rows, rows):
    for row in map(numbers, larger_rows):
        beside = numbers(chosen(rows, phi=row["phi"], Pe=row["Pe"])[0])
        say = f"Brownian, phi {row['phi']:g}, Pe {row['Pe']:g}: "
        c.within(say + "viscosity of 500 spheres less that of 108, in errors", excess(row, beside), -3, 3)


def check_grains(c, rows):
    for phi in GRAINS:
        smooth, rough = (numbers(chosen(rows, phi=phi, mu=mu)[0]) for mu in FRICTIONS)
        say = f"grains, phi {phi}: "
        ratio = rough["viscosity"] / boyer(phi)
        c.within(say + "with friction, viscosity over that of experiments with rough spheres", ratio, *BEYOND[phi])
        c.within(say + "friction makes it more viscous, in standard errors", excess(rough, smooth), 2, 1000)
        c.below(say + "N2 with friction", rough["N2"], -2 * rough["N2_error"])
    smooth, rough = (columns(chosen(rows, mu=mu), "viscosity")[0] for mu in FRICTIONS)
    gain = rough / smooth
    told_gain = ", ".join(f"{g:.3g}" for g in gain)
    c.holds("grains: friction matters more, the denser they are: " + told_gain, np.all(np.diff(gain) > 0))


def check_short(c, out, kept_brownian, kept_grains):
    """Short runs of 108 spheres beside the kept rows"""
    for phi in PHIS:
        x, edge = next(hard_spheres(108, phi, 1, seed=7))
        new = of_brownian([brownian(out, x, edge, 100, 5.0, 1)], 100)
        ratio = new["viscosity"] / numbers(chosen(kept_brownian, phi=phi, Pe=100)[0])["viscosity"]
        c.near(f"strain of 5, phi {phi}, Pe 100: viscosity over the kept one", ratio, 1, 0.2)
    for mu in FRICTIONS:
        new = of_grains([grains(out, 0.45, mu, 3, 4.0, 1)])
        ratio = new["viscosity"] / numbers(chosen(kept_grains, phi=0.45, mu=mu)[0])["viscosity"]
        # single runs scatter by a fifth
        c.near(f"strain of 4, phi 0.45, friction {mu}: viscosity over the kept one", ratio, 1, 0.35)


def check_quick(c, out):
    """What shows after a small strain of 32 spheres"""
    x, edge = next(hard_spheres(32, 0.3, 1, seed=7))
    viscosity = brownian(out, x, edge, 100, 1.0, 1)[2:, [4, 8]].sum(axis=1)
    c.within("32 spheres, phi 0.3, Pe 100, strain of 1: viscosity", viscosity.mean(), 2.4, 4)
    smooth, rough = (grains(out, 0.45, mu, 2, 0.3, 1)[5:, [4, 8]].sum(axis=1).mean() for mu in FRICTIONS)
    c.within("32 grains, phi 0.45, strain of 0.3: viscosity with friction over that without", rough / smooth, 1.05, 3)


def main():
    given = options(__file__, __doc__, quick=False, all=False, larger=False, spheres=500, sets=1)
    need("lmp")
    c, made, made_larger = Checks(), given.out if given.all else HERE, given.out if given.larger else HERE
    if given.all:
        what = f"{given.spheres} spheres; stresses over the fluid's viscosity and the rate of shear; errors of the mean"
        write(sweep(given.out, given.spheres, given.sets), made / "sweep.csv", what)
        write(friction(given.out, given.spheres, given.sets), made / "friction.csv", what)
    if given.larger:
        rows = sweep(given.out, given.spheres, given.sets, LARGER, 4.0, 0.25)
        write(rows, made_larger / "larger.csv", f"{given.spheres} spheres, as sweep.csv")
    brownian_rows, grain_rows = read_table(made / "sweep.csv"), read_table(made / "friction.csv")
    larger_rows = read_table(made_larger / "larger.csv")
    check_brownian(c, brownian_rows)
    check_larger(c, larger_rows, brownian_rows)
    check_grains(c, grain_rows)
    if given.quick:
        check_quick(c, given.out)
    elif not given.all and not given.larger:
        check_short(c, given.out, brownian_rows, grain_rows)
    draw(brownian_rows, larger_rows, grain_rows, given.out / "rheology.png")
    if given.update:
        tables = ("sweep.csv", "friction.csv") * given.all + ("larger.csv",) * given.larger
        for name in ("rheology.png",) + tables:
            shutil.copy(given.out / name, HERE)
    sys.exit(c.finish())


if __name__ == "__main__":
    main()
