#!/usr/bin/env python3
"""Settling, short-time diffusion and high-frequency viscosity of hard spheres at equilibrium, all from the same places,
beside the published fits.

    run.py --out DIR         one set of places for each volume fraction; picture from sets.csv; to DIR (default:
                             build/examples/hard_spheres)
    run.py --sets 24         as many sets as the kept table has, with 42 points for every sixth of them (half an hour)
    run.py --sets 24 --update     also refreshes sets.csv and the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from equilibrium import compressibility, hard_spheres, measured_pressure, pressure  # noqa: E402
from in_lammps import SHEARS, InLammps  # noqa: E402
from runs import np, plt, need, open_axes, options, read_table, save  # noqa: E402

PHIS, N, PROBES, EVERY = (0.05, 0.1, 0.2, 0.3, 0.45), 500, 6, 6
MODELS = {
    "one point": "cut_off_distance inf rotation yes lubrication yes",
    "multiblob 12": "cut_off_distance inf multiblob 12 lubrication yes fluid_velocity box",
    "multiblob 42": "cut_off_distance inf multiblob 42 lubrication yes fluid_velocity box",
}
MARKS = {"one point": ("^", "C1"), "multiblob 12": ("o", "C0"), "multiblob 42": ("s", "C2")}
WHAT = {"K": "settling", "D": "short-time self-diffusion", "eta": "high-frequency viscosity"}
# Largest distance to the fits at each volume fraction, per cent, beside twice the standard error
LIMITS = {
    ("multiblob 12", "K"): (1, 1, 2, 3, 11), ("multiblob 12", "D"): (1, 1, 1, 1.5, 3),
    ("multiblob 12", "eta"): (1, 1, 1, 1, 3), ("multiblob 42", "K"): (1, 1, 2, 2, 4),
    ("multiblob 42", "D"): (1, 1, 1, 1.5, 3), ("multiblob 42", "eta"): (1, 1, 1, 1, 3),
}


# --- published fits, relative to a lone sphere and to the fluid -------------------------------------------------------


def settling(phi):
    """Riest, Eckert, Richtering & Naegele, Soft Matter 11, 2821 (2015), to multipole simulations of Abade et al.
    (2010)"""
    return 1 - 6.5464 * phi * (1 - 3.348 * phi + 7.426 * phi**2 - 10.034 * phi**3 + 5.882 * phi**4)


def diffusion(phi):
    """Heinen, Banchio & Naegele, J. Chem. Phys. 135, 154504 (2011)"""
    return 1 - 1.8315 * phi * (1 + 0.1195 * phi - 0.70 * phi**2)


def viscosity(phi):
    """Sierou & Brady, J. Fluid Mech. 448, 115 (2001)"""
    crowd = phi * (1 + phi * (1 + phi - 2.3 * phi**2))
    return (1 + 1.5 * crowd) / (1 - crowd)


FITS = {"K": settling, "D": diffusion, "eta": viscosity}


# --- one set of places ------------------------------------------------------------------------------------------------


def measured(lammps, model, x, edge, seed):
    """K, D and eta in the box. D: the trace of the mobility, from forces of +1 and -1 at random, the same for every
    model"""
    lammps.place(x, MODELS[model], edge, tolerance=1e-3)
    along = np.eye(3)
    K = np.mean([lammps.velocities(np.tile(e, (N, 1))) @ e for e in along])
    random = np.random.default_rng(seed)
    D = np.mean([f * lammps.velocities(f) for f in random.choice([-1.0, 1.0], (PROBES, N, 3))])
    if model == "one point":
        return K, D, np.nan
    stress = [lammps.stress(plane) for plane in SHEARS]
    return K, D, 1 - np.mean([s[3 + k] + s[9 + k] for k, s in enumerate(stress)])


def all_sets(lammps, sets):
    for phi in PHIS:
        for k, (x, edge) in enumerate(hard_spheres(N, phi, sets, seed=1 + int(100 * phi))):
            contact = measured_pressure(x, edge, phi)
            for model in MODELS:
                if model != "multiblob 42" or (k % EVERY == 0 and sets > 1):
                    K, D, eta = measured(lammps, model, x, edge, 1000 * k)
                    yield dict(phi=phi, set=k, model=model, K=K, D=D, eta=eta, pressure=contact)
                    print(f"  phi {phi}, set {k}, {model}: K {K:.4f}, D {D:.4f}, eta {eta:.4f}", flush=True)


def columns(rows):
    """(phi, model, quantity): values of all sets; (phi, model, "set"): their numbers"""
    found = {}
    for row in rows:
        for what in ("K", "D", "eta", "pressure", "set"):
            found.setdefault((float(row["phi"]), row["model"], what), []).append(float(row[what]))
    return {key: np.array(value) for key, value in found.items()}


def endless(found, phi, model, what):
    """Mean and its standard error, without a box: to K and D, what waves longer than the box add, 1.7601 S(0)
    (phi/N)^(1/3) and with 1 for S(0), in a fluid of the suspension's viscosity (Ladd, J. Chem. Phys. 93, 3484 (1990)).
    42 points, which have some of the sets only: by their difference to 12 on the same places"""
    sample = found[phi, model, what]
    if model == "multiblob 42":
        twelve = found[phi, "multiblob 12", what]
        other = sample - twelve[found[phi, model, "set"].astype(int)]
        value, error = twelve.mean() + other.mean(), np.hypot(standard_error(twelve), standard_error(other))
    else:
        value, error = sample.mean(), standard_error(sample)
    if what == "eta":
        return value, error
    # films make it as viscous as shells do
    thick = found[phi, "multiblob 12" if model == "one point" else model, "eta"].mean()
    return value + 1.7601 * (phi / N)**(1 / 3) / thick * (compressibility(phi) if what == "K" else 1.0), error


def standard_error(sample):
    return np.std(sample, ddof=1) / len(sample)**0.5


# --- picture and figures ----------------------------------------------------------------------------------------------


def draw(found, path):
    open_axes()
    figure, panels = plt.subplots(1, 3, figsize=(11, 4), layout="constrained")
    phi = np.linspace(0, 0.47, 100)
    for panel, (what, name) in zip(panels, WHAT.items()):
        panel.plot(phi, FITS[what](phi), "k-", lw=1.2, label="published fit")
        for model, (mark, colour) in MARKS.items():
            if (PHIS[0], model, what) in found and not (model == "one point" and what == "eta"):
                y, error = np.array([endless(found, p, model, what) for p in PHIS]).T
                panel.errorbar(PHIS, y, 2 * error, fmt=mark, color=colour, ms=6 if model == "multiblob 12" else 4,
                               label="one point, lubrication" if model == "one point" else model)
        panel.set(title=name, xlabel="volume fraction", yscale="log")
        panel.legend(fontsize=8)
    panels[0].set(ylabel="over a lone sphere", ylim=(0.03, 1.1))
    panels[1].set(ylim=(0.15, 1.1))
    panels[2].set(ylabel="over the fluid")
    for panel, ticks in zip(panels, ((0.03, 0.1, 0.3, 1), (0.2, 0.3, 0.5, 1), (1, 2, 3, 5))):
        panel.set_yticks(ticks, ticks)
        panel.minorticks_off()
    save(figure, path)


def write(rows, path):
    lines = ["# Hard spheres, N = 500, in the box: settling, self-diffusion, viscosity; pressure from the contacts. "
             "run.py --sets 24 --update",
             "phi,set,model,K,D,eta,pressure"]
    lines += [f"{r['phi']},{r['set']},{r['model']},{r['K']:.6f},{r['D']:.6f},{r['eta']:.5f},{r['pressure']:.3f}"
              for r in rows]
    path.write_text("\n".join(lines) + "\n")


def check_table(c, found):
    for phi in PHIS:
        contact = found[phi, "multiblob 12", "pressure"]
        c.near(f"phi {phi}: pressure by the contacts, over that of Carnahan & Starling", contact.mean() / pressure(phi),
               1, 0.05 + 2 * standard_error(contact) / pressure(phi))
    for (model, what), limits in LIMITS.items():
        for phi, limit in zip(PHIS, limits):
            value, error = endless(found, phi, model, what)
            fit = FITS[what](phi)
            c.near(f"{WHAT[what]}, phi {phi}, {model}: {value:.4f} +- {error:.4f}; off the fit, %",
                   100 * (value / fit - 1), 0, limit + 200 * error / fit)


def check_first(c, rows, found):
    """One set against the kept ones"""
    for row in rows:
        for what in ("K", "D", "eta"):
            kept = found[row["phi"], row["model"], what]
            if np.isfinite(row[what]):
                c.near(f"first set, phi {row['phi']}, {row['model']}: {what}", row[what], kept.mean(),
                       4 * np.std(kept, ddof=1))


def main():
    given = options(__file__, __doc__, sets=1)
    need("lmp")
    rows, c = list(all_sets(InLammps(given.out), given.sets)), Checks()
    if given.sets > 1:
        write(rows, given.out / "sets.csv")
    kept = HERE / "sets.csv" if given.sets == 1 else given.out / "sets.csv"
    found = columns(read_table(kept))
    check_table(c, found)
    if given.sets == 1:
        check_first(c, rows, found)
    draw(found, given.out / "hard_spheres.png")
    if given.update:
        for name in ("hard_spheres.png",) + (("sets.csv",) if given.sets > 1 else ()):
            shutil.copy(given.out / name, HERE)
    sys.exit(c.finish())


if __name__ == "__main__":
    main()
