#!/usr/bin/env python3
"""Runs both flows on several meshes, prints their errors and draws fluid.png.

    run.py [--ranks N] [--out DIR] [--update]

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed."""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
from checks import Checks  # noqa: E402
from runs import need, np, options, plt  # noqa: E402
from vans_runs import keep, lmp, profiles  # noqa: E402

NU, KAPPA, H, G = 1e-6, 0.41, 0.1, 0.49029565
U_STAR = np.sqrt(G * H)
# the README's errors: Poiseuille flow by slices, the layer from the coarsest mesh to the finest
PARABOLA = {11: 1.0e-2, 26: 1.6e-3, 101: 1.0e-4, 401: 6.25e-6}
LAYER = 6.1e-3, 2.0e-3, 5.0e-4, 7.2e-5


def run(case, cells, given):
    log = f"log.vans_fluid.{case}.{given.ranks}" if cells in (101, 5001) else "none"
    lmp(HERE, given, given.out, log, case=case, cells=cells)
    values = profiles(given.out / f"profile.{case}.{cells}", 0.5)
    return values[:-1, 1], values[:-1, 2]


def layer(z):
    """The exact integral of the closure: (nu + (kappa z)^2 u') u' = u_star^2 (1 - z/H), without eddies where z
    u_star/nu < 11.3."""
    edge = 11.3 * NU / U_STAR

    def gradient(s):
        stress = U_STAR ** 2 * (1 - s / H)
        return 2 * stress / (NU + np.sqrt(NU ** 2 + 4 * (KAPPA * s) ** 2 * stress))

    s = np.exp(np.linspace(np.log(edge), np.log(H * (1 - 1e-12)), 200001))
    middle = 0.5 * (s[1:] + s[:-1])
    u = np.concatenate([[0], np.cumsum((gradient(s[1:]) + 4 * gradient(middle) + gradient(s[:-1])) / 6 * np.diff(s))])
    below = np.minimum(z, edge)
    return (U_STAR ** 2 / NU * (below - below ** 2 / (2 * H)) +
            np.where(z > edge, np.interp(np.log(np.maximum(z, edge)), np.log(s), u), 0))


def main():
    given, c = options(__file__, __doc__, ranks=1), Checks()
    need("mpirun", "lmp")
    figure, (left, right, errors) = plt.subplots(1, 3, figsize=(13, 4.2))
    print("Poiseuille flow, error relative to the largest velocity")
    meshes, worst = (11, 26, 101, 401), []
    for cells in meshes:
        z, u = run("poiseuille", cells, given)
        dz, parabola = 1 / (cells - 1), 0.1 / 0.002 * z * (1 - z)
        discrete = parabola + 0.1 / 0.002 * dz ** 2 / 4
        worst.append(np.abs(u - parabola).max() / 12.5)
        print(f"  {cells:6d} slices: to the parabola {worst[-1]:.2e}, to the discrete closed form "
              f"{np.abs(u - discrete).max() / 12.5:.1e}")
        c.below(f"Poiseuille, {cells} slices: to the discrete closed form", np.abs(u - discrete).max() / 12.5, 2e-12)
        c.near(f"Poiseuille, {cells} slices: to the parabola", worst[-1], PARABOLA[cells], 0.03 * PARABOLA[cells])
        if cells == 26:
            left.plot(u, z, "o", ms=4, label="25 slices")
    s = np.linspace(0, 1, 200)
    left.plot(50 * s * (1 - s), s, "k-", lw=1, label="parabola")
    errors.loglog(1 / (np.array(meshes) - 1), worst, "o-", label="Poiseuille")

    print("turbulent layer, Re_tau = %.0f, error in friction velocities" % (U_STAR * H / NU))
    k = np.array([3, 6, 12, 24])
    meshes, worst = [], []
    # the end of the sublayer in the middle between two nodes, so that the order of convergence shows
    for cells in [int(round((n + 0.5) * U_STAR * H / NU / 11.3)) + 1 for n in k]:
        z, u = run("layer", cells, given)
        meshes.append(cells)
        worst.append(np.abs(u - layer(z)).max() / U_STAR)
        print(f"  {cells:6d} slices, dz+ = {H / (cells - 1) * U_STAR / NU:.2f}: to the exact integral of the closure "
              f"{worst[-1]:.2e}, surface {u[-1]:.4f} m/s")
    for found, wanted in zip(worst, LAYER):
        c.near("layer: to the exact integral of the closure", found, wanted, 0.03 * wanted)
    run("layer", 5001, given)
    right.semilogx(z * U_STAR / NU, u / U_STAR, "C0-", lw=3, alpha=0.5, label=f"{cells} slices")
    zp = np.logspace(0, np.log10(H * U_STAR / NU * 0.999), 300)
    right.semilogx(zp, layer(zp * NU / U_STAR) / U_STAR, "k-", lw=1, label="exact integral of the closure")
    right.semilogx(zp[zp > 11.3], np.log(zp[zp > 11.3] / 11.3) / KAPPA + 11.3, "r:", label="log law from 11.3")
    errors.loglog(11.3 / (k + 0.5) / 11.3 * 0.1, worst, "s-", label="turbulent layer (dz+/113)")
    print("  orders:", ", ".join("%.2f" % (np.log(a / b) / np.log((m + 0.5) / (n + 0.5))) for a, b, n,
                                 m in zip(worst, worst[1:], k, k[1:])))
    errors.loglog([2.5e-3, 0.1], [2e-6, 2e-6 * 1600], "k:", label="second order")
    left.set(xlabel="u [m/s]", ylabel="z [m]", title="Poiseuille flow")
    right.set(xlabel="z u*/nu", ylabel="u/u*", title="Turbulent layer on a slope of 0.05")
    errors.set(xlabel="dz", ylabel="largest error", title="Convergence")
    for axes in (left, right, errors):
        axes.legend(frameon=False, fontsize=8)
        axes.grid(alpha=0.3)
    figure.tight_layout()
    figure.savefig(given.out / "fluid.png", dpi=110)
    keep(HERE, given, "fluid.png", f"log.vans_fluid.poiseuille.{given.ranks}", f"log.vans_fluid.layer.{given.ranks}")
    return c.finish()


sys.exit(main())
