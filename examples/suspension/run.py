#!/usr/bin/env python3
"""Hindered settling in periodic boxes: spheres with in.suspension at several volume fractions, rigid clumps with
in.clumps.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/suspension)
    run.py --update     also refreshes the logs and the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import re
import shutil
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from equilibrium import compressibility, hard_spheres  # noqa: E402
from runs import np, plt, dumped, finished, need, options, values  # noqa: E402

PHIS = (0.05, 0.1, 0.2, 0.3, 0.45)
N, SETS = 4 * 14**3, 4
# settling speed of one-point spheres over the exact one
TOO_FAST = {0.05: 1.07, 0.1: 1.17, 0.2: 1.37, 0.3: 1.76, 0.45: 2.9}
# the same with 12 points and films; viscosity of the suspension, which the missing waves feel then (Sierou & Brady
# 2001)
MULTIBLOB = {0.1: (1.00, 1.311), 0.3: (1.03, 2.655)}


def theory(phi):
    """Of this model: Rotne-Prager mobilities summed over pairs, hard spheres of Percus & Yevick, no net flux"""
    return 1 + phi - 1.2 * phi * (5 - phi + phi**2 / 2) / (1 + 2 * phi)


def exact(phi):
    """Hard spheres at equilibrium with their whole hydrodynamics: fit to multipole simulations of Abade et al. (J.
    Chem. Phys. 132, 014503 (2010)) by Riest, Eckert, Richtering & Naegele (Soft Matter 11, 2821 (2015)), up to phi =
    0.5"""
    return 1 - 6.5464 * phi * (1 - 3.348 * phi + 7.426 * phi**2 - 10.034 * phi**3 + 5.882 * phi**4)


def beyond_the_box(phi):
    """What the waves that are longer than the box would add: 1.7601 S(0) (phi/N)^(1/3), with the compressibility S(0)
    of hard spheres (Carnahan & Starling) (Ladd, J. Chem. Phys. 93, 3484 (1990))"""
    return 1.7601 * compressibility(phi) * (phi / N)**(1 / 3)


def places(phi, k=0):
    return f"places.{phi}.{k}.data"


def write_places(out, phi):
    """Sets of hard spheres at equilibrium, as data files"""
    for k, (x, edge) in enumerate(hard_spheres(N, phi, SETS, seed=1 + int(100 * phi), melt=1000, between=200)):
        rows = "".join(f"{i + 1} 1 2.0 1.0 {p[0]:.17g} {p[1]:.17g} {p[2]:.17g}\n"
                       for i, p in enumerate((x % edge).tolist()))
        (out / places(phi, k)).write_text(f"hard spheres, volume fraction {phi}\n\n{N} atoms\n1 atom types\n\n" +
                                          "".join(f"0 {edge:.17g} {c}lo {c}hi\n" for c in "xyz") + "\nAtoms\n\n" + rows)


def lammps(out, script, log, ranks=2, **variables):
    command = ["mpirun", "-np", str(ranks), "lmp", "-in", script, "-log", log, "-nocite"]
    start = time.time()
    said = finished("suspension", command + values(variables), out)
    print(f"[{log}, {ranks} rank{'s' if ranks > 1 else ''}] {time.time() - start:.0f} s", flush=True)
    return [float(word) for word in re.findall("^settling (.*)$", said, re.M)]


def thermo(log):
    """Rows of the last run"""
    rows, inside = [], False
    for line in log.read_text().splitlines():
        words = line.split()
        if words[:2] == ["Step", "Time"]:
            rows, inside = [], True
        elif words[:2] == ["Loop", "time"]:
            inside = False
        elif inside:
            rows.append([float(word) for word in words])
    return np.array(rows)


def picture(speeds, fall, path):
    fig, (left, right) = plt.subplots(1, 2, figsize=(11.0, 4.6), dpi=90, layout="constrained")
    phi = np.linspace(0, 0.5, 100)
    left.plot(phi, exact(phi), "k-", lw=1.4, label="exact: hard spheres at equilibrium")
    left.plot(phi, (1 - phi)**5.6, "k:", lw=1, label="experiments, Brownian: $(1-\\phi)^{5.6}$")
    left.plot(phi, (1 - phi)**4.48, "k--", lw=1, label="experiments, not Brownian: $(1-\\phi)^{4.48}$")
    left.plot(phi, theory(phi), "C1-", lw=1.2, label="theory of this model")
    spread = [np.std(np.mean(speeds[p], axis=1), ddof=1) for p in PHIS]
    left.errorbar(PHIS, [np.mean(speeds[p]) + beyond_the_box(p) for p in PHIS], 2 * np.array(spread) / SETS**0.5,
                  fmt="o", color="C0", label="this plugin, one point per sphere")
    left.set(xlabel="volume fraction $\\phi$", ylabel="settling speed / that of a lone sphere", ylim=(0, 1))
    left.legend(fontsize="small")
    near = np.abs(fall[:, 2] - fall[:, 2].mean()) < 3.0
    x, v = fall[near][:, 1:4], fall[near][:, 4:7]
    v = v - fall[:, 4:7].mean(axis=0)
    shown = right.scatter(x[:, 0], x[:, 2], c=v[:, 2], s=14, cmap="coolwarm", vmin=-1, vmax=1)
    right.quiver(x[:, 0], x[:, 2], v[:, 0], v[:, 2], width=0.002, scale=30)
    right.set(aspect="equal", xlabel="x / a", ylabel="z / a",
              title="a slice at $\\phi$ = 0.1: velocities less their mean")
    fig.colorbar(shown, ax=right, label="upwards / speed of a lone sphere")
    fig.savefig(path)
    plt.close(fig)


def main():
    given = options(__file__, __doc__)
    out = given.out
    need("lmp", "mpirun")
    for name in ("in.suspension", "in.clumps", "bipyramid5.mol"):
        shutil.copy(HERE / name, out)
    c, speeds = Checks(), {}
    for phi in PHIS:
        write_places(out, phi)
        speeds[phi] = [lammps(out, "in.suspension", f"log.{phi}.{k}", places=places(phi, k),
                              dump="yes" if (phi, k) == (0.1, 0) else "no")
                       for k in range(SETS)]
        endless = np.mean(speeds[phi]) + beyond_the_box(phi)
        c.near(f"spheres, phi {phi}: settling speed, beside the theory of the model", endless, theory(phi), 0.02)
        c.near(f"spheres, phi {phi}: times the exact speed", endless / exact(phi), TOO_FAST[phi],
               0.1 * (TOO_FAST[phi] - 0.7))
    for phi, (wanted, thick) in MULTIBLOB.items():
        blob = [lammps(out, "in.suspension", f"log.blob.{phi}.{k}", places=places(phi, k), points=12, films="yes")
                for k in range(SETS)]
        c.near(f"spheres, phi {phi}, multiblob 12: times the exact speed",
               (np.mean(blob) + beyond_the_box(phi) / thick) / exact(phi), wanted, 0.03)
    fine, one, two = (lammps(out, "in.suspension", log, places=places(0.1), tolerance=tolerance, ranks=ranks)
                      for log, tolerance, ranks in (("log.fine", 1e-6, 2), ("log.suspension.1", 1e-4, 1),
                                                    ("log.suspension.2", 1e-4, 2)))
    c.below("spheres: 1 rank against 2", np.abs(np.subtract(one, two)).max(), 1e-10)
    c.below("spheres: far_field_tolerance 1e-4 against 1e-6", np.abs(np.subtract(two, fine)).max(), 4e-4)
    lone = lammps(out, "in.clumps", "log.lone", ranks=1, phi=1e-9, steps=0)[0]
    lammps(out, "in.clumps", "log.clumps")
    rows = thermo(out / "log.clumps")
    print(f"\n  clumps at phi 0.1: {rows[0, 2]:.3f} at first, {rows[-1, 2]:.3f} after falling "
          f"{rows[:, 2].mean() * rows[-1, 1]:.1f} radii; alone {lone:.3f}")
    c.within("clumps: mean speed over that of a lone clump", rows[-1, 2] / lone, 0.2, 0.5)
    c.below("clumps: products of a solve to 1e-3 in flight", rows[1:, 4].max(), 4)

    print("\n  phi     settling speed in the box (each set)   without a box    theory    exact    "
          "(1-phi)^5.6    (1-phi)^4.48")
    for phi in PHIS:
        print(f"  {phi:4}    " + "  ".join(f"{u:.4f}" for u in np.mean(speeds[phi], axis=1)) +
              f"                  {np.mean(speeds[phi]) + beyond_the_box(phi):.3f}            {theory(phi):.3f}     "
              f"{exact(phi):.3f}    {(1 - phi)**5.6:.3f}          {(1 - phi)**4.48:.3f}")
    *_, (_, last) = dumped(out / "suspension.spheres")
    picture(speeds, last, out / "suspension.png")
    if given.update:
        for name in ("suspension.png", "log.suspension.1", "log.suspension.2"):
            shutil.copy(out / name, HERE)
    sys.exit(c.finish())


if __name__ == "__main__":
    main()
