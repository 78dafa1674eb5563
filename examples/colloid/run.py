#!/usr/bin/env python3
"""Short-time self-diffusion of hard spheres in a periodic box from Brownian steps (in.colloid), for one point per
sphere, with films, and for spheres as shells of points, beside the published fit.

    run.py --out DIR     results and the picture go to DIR (default: build/examples/colloid)
    run.py --update      also refreshes the picture in this folder
    run.py --sets 40     eight times the samples

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from equilibrium import hard_spheres  # noqa: E402
from runs import np, plt, dumped, finished, need, open_axes, options, save, values  # noqa: E402

PHIS, N, DT, STEPS = (0.1, 0.2, 0.3, 0.4), 108, 1e-8, 8
# words of the pair style, and how many steps for one of multiblobs
MODELS = {"one point": ("rotation no", 8), "one point, films": ("rotation yes lubrication yes", 4),
          "multiblob 12, films": ("multiblob 12 lubrication yes", 1)}
MARKS = {"one point": ("v", "C3"), "one point, films": ("^", "C1"), "multiblob 12, films": ("o", "C0")}
# What must come out (None: the fit), and how far from it at each volume fraction, per cent, beside twice the standard
# error: one point per sphere diffuses as if alone; with films as by forces on the same model (../hard_spheres)
WANTED = {"one point": ((1, 1, 1, 1), (1, 1, 1, 1)),
          "one point, films": ((0.8801, 0.7116, 0.5120, None), (1.5, 1.5, 1.5, 10)),
          "multiblob 12, films": ((None,) * 4, (1, 1, 1.5, 2.5))}


def diffusion(phi):
    """Heinen, Banchio & Naegele, J. Chem. Phys. 135, 154504 (2011)"""
    return 1 - 1.8315 * phi * (1 + 0.1195 * phi - 0.70 * phi**2)


def viscosity(phi):
    """Sierou & Brady, J. Fluid Mech. 448, 115 (2001): what waves longer than the box move in, where films make it so
    thick"""
    crowd = phi * (1 + phi * (1 + phi - 2.3 * phi**2))
    return (1 + 1.5 * crowd) / (1 - crowd)


def steps_of(out, phi, x, edge, model, words, steps, seed):
    """Displacements [steps, N, 3] over their root mean square if each sphere were alone"""
    name = f"{100 * phi:.0f}.{model.split(',')[0].replace(' ', '_')}{'.films' * ('films' in model)}"
    with open(out / f"{name}.data", "w") as data:
        data.write(f"spheres\n\n{N} atoms\n1 atom types\n" + "".join(f"0 {edge:.17g} {d}lo {d}hi\n" for d in "xyz") +
                   "\nAtoms\n\n")
        data.write("".join("{} 1 2 1 {:.15g} {:.15g} {:.15g}\n".format(k + 1, *p) for k, p in enumerate(x)))
    finished("colloid", ["lmp", "-in", "in.colloid", "-log", str(out / f"{name}.log")] + values(
        dict(places=out / f"{name}.data", model=words, steps=steps, seed=seed, out=out / f"{name}.places")), HERE)
    x = np.array([rows[:, 1:] for _, rows in dumped(out / f"{name}.places")])
    return np.diff(x, axis=0) / np.sqrt(2 * DT / (6 * np.pi))


def measured(sets, phi, model):
    """Self-diffusion over that of a lone sphere, without a box (Ladd, J. Chem. Phys. 93, 3484 (1990)), and its standard
    error, from the means of all sets of places. One point per sphere leaves the viscosity of the fluid as it is."""
    thick = viscosity(phi) if "films" in model else 1.0
    return np.mean(sets) + 1.7601 * (phi / N)**(1 / 3) / thick, np.std(sets, ddof=1) / np.sqrt(len(sets))


def draw(found, path):
    open_axes()
    figure, panel = plt.subplots(figsize=(6.2, 4.2), layout="constrained")
    phi = np.linspace(0, 0.45, 100)
    panel.plot(phi, diffusion(phi), "k-", lw=1.2, label="published fit")
    panel.plot(phi, 1 - 1.8315 * phi, ":", color="0.5", lw=1, label="1 - 1.83 phi")
    for model, (mark, colour) in MARKS.items():
        y, error = np.array([found[model, p] for p in PHIS]).T
        panel.errorbar(PHIS, y, 2 * error, fmt=mark, color=colour, ms=6, label=model)
    panel.set(xlabel="volume fraction", ylabel="short-time self-diffusion over that of a lone sphere", ylim=(0, 1.1),
              xlim=(0, 0.45))
    panel.legend(fontsize=8)
    save(figure, path)


def main():
    given = options(__file__, __doc__, sets=5)
    need("lmp")
    began, found = time.time(), {}
    for phi in PHIS:
        sets = list(hard_spheres(N, phi, given.sets, seed=1 + int(100 * phi)))
        for model, (words, more) in MODELS.items():
            D = [(steps_of(given.out, phi, x, edge, model, words, more * STEPS, 100 * k + 7)**2).mean()
                 for k, (x, edge) in enumerate(sets)]
            found[model, phi] = measured(D, phi, model)
            print(f"  phi {phi}, {model}: {found[model, phi][0]:.4f} +- {found[model, phi][1]:.4f}; "
                  f"fit {diffusion(phi):.4f}; {time.time() - began:.0f} s", flush=True)
    draw(found, given.out / "colloid.png")
    if given.update:
        shutil.copy(given.out / "colloid.png", HERE)
    c = Checks()
    for model, (wanted, limits) in WANTED.items():
        for phi, value, limit in zip(PHIS, wanted, limits):
            D, error = found[model, phi]
            value = value or diffusion(phi)
            c.near(f"{model}, phi {phi}: {D:.4f} +- {error:.4f}; off {value:.4f}, %", 100 * (D / value - 1), 0,
                   limit + 200 * error / value)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
