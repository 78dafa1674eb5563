#!/usr/bin/env python3
"""Sheet flow of Revil-Baudard et al. (2015): velocity, Reynolds stress and concentration over the measured ones,
sheet_flow.png.
    run.py [--ranks N] [--seconds T] [--bed N] [--suspension yes|no] [--mixing C|off] [--friction F] [--out DIR]
    [--reuse DIR] [--update]

The run begins with the measured velocity of the water over a flat bed. Its means are those of the second half. --bed:
another seed; --suspension no: without the turbulence that spreads the grains; --mixing: bed_mixing; --friction: of two
grains. Needs lmp on the PATH (. build/env.sh). Ends with a line ok or MISSED for each figure of the README. --reuse
reads results of an earlier run in DIR."""
import os
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.dirname(HERE))
from checks import Checks  # noqa: E402
from runs import need, np, options, plt  # noqa: E402
from vans_runs import by_second, error, keep, lmp, profiles  # noqa: E402

D, CELLS, TOP, BED = 0.003, 1071, 0.1605, 0.027         # grains; slices; surface of the water and of the flat bed, m
SCALE = np.sqrt(0.19 * 9.81 * D ** 3)                   # q* = q/SCALE
PHI_REST = 0.55                                         # of the bed, measured


def trapezoid(y, x):
    return (0.5 * (y[1:] + y[:-1]) * np.diff(x)).sum()


def measured():
    """z, phi; z, velocity, stress of the water; transport rate."""
    z, phi = np.loadtxt(os.path.join(HERE, "measured_phi.csv"), delimiter=",").T
    z_u, u, stress = np.loadtxt(os.path.join(HERE, "measured_u.csv"), delimiter=",").T
    return (z, phi), (z_u, u, 1000 * stress), trapezoid(phi * np.interp(z, z_u, u), z)


def start(path):
    """The file of keyword profile: the measured velocity over a flat bed of as many grains."""
    (z, phi), (z_u, u, _), _ = measured()
    flat = z[0] + trapezoid(phi, z) / PHI_REST
    middles = (np.arange(CELLS - 1) + 0.5) * TOP / (CELLS - 1)
    profile = np.interp(middles - BED + flat, z_u, u)
    np.savetxt(path, np.concatenate([[0.0], profile, profile[-1:]]), fmt="%.6g")


def closest(profile):
    """The shift in height for which phi is nearest to the measured one."""
    (z, phi), _, _ = measured()
    shifts = np.arange(-0.022, -0.008, 1e-4)
    distance = [np.sqrt(((np.interp(z, profile[:, 1] + shift, profile[:, 3]) - phi) ** 2).mean()) for shift in shifts]
    return shifts[np.argmin(distance)], min(distance)


def main():
    given, c = options(__file__, __doc__, ranks=1, seconds=24.0, bed=0, suspension="yes", mixing="0.5", friction=0.2,
                       reuse=""), Checks()
    need("mpirun", "lmp")
    as_it_is = (given.suspension, given.mixing, given.friction) == ("yes", "0.5", 0.2)
    directory, name = given.reuse or given.out, f"{given.bed}.{given.suspension}.{given.mixing}.{given.friction:g}"
    if not given.reuse:
        start(given.out / f"start.{name}")
        lmp(HERE, given, directory, name=name, seed=4711 + given.bed, seconds=given.seconds, start=f"start.{name}",
            mixing=given.mixing, friction=given.friction, walk="langevin" if given.suspension == "yes" else "none")
    series = np.loadtxt(os.path.join(directory, f"series.{name}"))[:, 1:]
    profile = profiles(os.path.join(directory, f"profiles.{name}"), 0.5)
    (z, phi), (z_u, u, stress), q = measured()
    shift, of_phi = closest(profile)
    height = profile[:, 1] + shift
    of_u = np.sqrt(((np.interp(z_u, height, profile[:, 2]) - u) ** 2).mean())
    late = series[series[:, 0] > 0.5 * series[-1, 0]]
    # as published, the volume fraction times the velocity of the water; and that of the grains themselves
    alike, found = (profile[:, 3] * profile[:, 2]).sum() * TOP / (CELLS - 1) / SCALE, late[:, 1].mean() / SCALE
    blocks = by_second(late[:, 0], late[:, 1], late[0, 0]) / SCALE
    print(f"q* of phi and the water's velocity {alike:.3f}, of the grains {found:.3f} +- {error(blocks):.3f}, "
          f"by the second {np.round(blocks, 2)}; measured {q / SCALE:.3f}; surface {late[:, 3].mean():.3f} m/s, "
          f"largest stress {profile[:, 10].max():.2f} Pa")
    if as_it_is:
        c.near("q* of phi and the water's velocity, over the measured one", alike * SCALE / q, 1.0, 0.15)
        c.near("q* of the grains, over the same", found * SCALE / q, 1.0, 0.15)
        c.below("rms distance from the measured phi, of its range", of_phi / PHI_REST, 0.1)
        c.below("rms distance from the measured velocity, of its range", of_u / u.max(), 0.1)
    else:
        c.below("q* of the grains, over the measured one", found * SCALE / q, 2.0)

    figure, axes = plt.subplots(1, 3, figsize=(12, 4.6), sharey=True)
    rows = ((z_u, u, profile[:, 2], "velocity of the water, m/s"), (z_u, stress, profile[:, 10], "Reynolds stress, Pa"),
            (z, phi, profile[:, 3], "phi"))
    for axis, (at, values, ours, what) in zip(axes, rows):
        axis.plot(values, at / D, "o", color="0.3", ms=3.5, label="Revil-Baudard et al. 2015")
        axis.plot(ours[:-1], height[:-1] / D, color="C0", label="fix hydro/vans")
        axis.set(xlabel=what)
        axis.grid(alpha=0.3)
    solid = profile[:, 3] > 0.05
    axes[0].plot(profile[solid, 4], height[solid] / D, color="C1", label="its grains")
    axes[0].set(ylabel="z/d", ylim=(-4, 36))
    axes[0].legend(frameon=False)
    figure.tight_layout()
    figure.savefig(given.out / "sheet_flow.png", dpi=100)
    keep(HERE, given, "sheet_flow.png")
    return c.finish()


sys.exit(main())
