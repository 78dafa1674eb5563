#!/usr/bin/env python3
"""Fills a closed surface with overlapping spheres, as a rigid clump for pair_style stokes_dynamics, and says how wrong
its drag is.

    fill.py ellipsoid A B C     half-axes                    fill.py cube EDGE
    fill.py rod LENGTH RADIUS   with half-spheres at the ends; LENGTH without them
    fill.py disc RADIUS THICKNESS                            fill.py stl FILE [SCALE]     ASCII or binary

    --gap 0.05       how deep the spheres may leave the surface uncovered, over the radius of the sphere of the
                     same volume
    --grow 0.3       by how much the inscribed spheres grow, over the gap, so that the surface runs between
                     them; 0: they stay inscribed
    --density 1      mass of the body over its volume: the densities of the spheres are such that the clump weighs
                     what the body does
    --out NAME       writes NAME.data (atom_style hybrid sphere bond, molecule 1) and NAME.mol (for create_atoms and fix
                     rigid/small)
    --finer 2        compare with a fill of a gap smaller by this factor; 0: with none
    --shell 12       points on each sphere in this comparison

The spheres are first inscribed: each touches the surface from within at a sample of it (the shrinking ball of Ma, Bae &
Choi 2012). Those that cover most of what is not covered yet are taken first. Then all radii grow by --grow times the
gap. Drag and rotation come from the Python module stokesdyn, without LAMMPS. For ellipsoids the exact values stand
beside them (Oberbeck 1876, Jeffery 1922).
"""
import argparse
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from surfaces import np, Error, SHAPES, cube, inertia, surface, volume_and_centre    # noqa: E402,F401

# --- the fill ---------------------------------------------------------------------------------------------------------

def samples(triangles, n, seed=1):
    """n points of the surface, evenly spread, with inward normals"""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    area = np.linalg.norm(normal, axis=1) / 2
    rng, total = np.random.default_rng(seed), np.cumsum(area)
    k = np.minimum(np.searchsorted(total, (np.arange(n) + rng.random()) / n * total[-1]), len(area) - 1)
    u, v = rng.random((2, n))
    over = u + v > 1
    u[over], v[over] = 1 - u[over], 1 - v[over]
    a, b, c = triangles[k].transpose(1, 0, 2)
    return a + u[:, None] * (b - a) + v[:, None] * (c - a), -normal[k] / (2 * area[k, None])


def inscribed(x, normal):
    """Centres and radii of the largest spheres that touch each sample x from within and hold no other sample.
    A sphere through x[i] with its centre on the normal passes through x[j] if its radius is |x[j] - x[i]|^2 / (2
    normal.(x[j] - x[i]))."""
    radius = np.empty(len(x))
    for i in range(len(x)):
        d = x - x[i]
        up = d @ normal[i]
        square = (d * d).sum(axis=1)
        ahead = up > 1e-6 * np.sqrt(square)
        radius[i] = np.min(square[ahead] / (2 * up[ahead]))
    return x + radius[:, None] * normal, radius


def fill(triangles, gap, grow=0.0, n=3000):
    """Centres and radii of inscribed spheres such that no sample of the surface is farther than gap from the nearest of
    them; the radii are then larger by grow times the gap"""
    x, normal = samples(triangles, n)
    centre, radius = inscribed(x, normal)
    covers = np.empty((n, n), bool)
    for j in range(n):
        covers[j] = np.linalg.norm(x - centre[j], axis=1) - radius[j] <= gap
    left, chosen = np.ones(n, bool), []
    while left.any():
        gain = covers[:, left].sum(axis=1)
        best = np.nonzero(gain == gain.max())[0]
        j = best[np.argmax(radius[best])]
        chosen.append(j)
        left &= ~covers[j]
    return centre[chosen], radius[chosen] + grow * gap


def densities(centre, radius, triangles, density):
    """Of the spheres, so that the clump has the mass of the body and its centre of mass: close to one number for all of
    them"""
    volume, middle = volume_and_centre(triangles)
    own = 4 / 3 * np.pi * radius**3
    part = own * volume / own.sum()
    A = np.concatenate([np.ones((1, len(own))), (centre - middle).T / volume**(1 / 3)])
    wanted = np.array([volume, 0, 0, 0]) - A @ part
    # rcond: centres on a line or in a plane say nothing across it
    part = part + own * (A.T @ np.linalg.lstsq(A * own @ A.T, wanted, rcond=1e-3)[0])
    if (part <= 0).any():
        raise Error("the centres of the spheres lie all on one side of the centre of mass: use a smaller --gap")
    return density * part / own


# --- how wrong it is --------------------------------------------------------------------------------------------------

def ellipsoid_resistance(axes):
    """Drag along the three half-axes and torque about them, viscosity 1"""
    a = np.asarray(axes, float)
    t, weight = np.polynomial.legendre.leggauss(400)       # s = scale (1 + t)/(1 - t), squared for the end at infinity
    u, weight = (t + 1) / 2, weight / 2
    scale = (a**2).mean()
    s = scale * (u / (1 - u))**2
    ds = scale * 2 * u / (1 - u)**3
    delta = np.sqrt(np.prod(a[:, None]**2 + s, axis=0))
    chi = a.prod() * np.sum(weight * ds / delta)
    alpha = np.array([a.prod() * np.sum(weight * ds / delta / (b**2 + s)) for b in a])
    drag = 16 * np.pi * a.prod() / (chi + alpha * a**2)
    j, k = [1, 2, 0], [2, 0, 1]
    return drag, 16 * np.pi * a.prod() / 3 * (a[j]**2 + a[k]**2) / (a[j]**2 * alpha[j] + a[k]**2 * alpha[k])


def resistance(centre, radius, shell):
    """Drag along the axes x, y, z and torque about them, viscosity 1; the number of points"""
    import stokesdyn
    clump = stokesdyn.Clump(centre, radius, shell=shell)
    return np.diag(clump.resistance)[:3], np.diag(clump.resistance)[3:], clump.points


def report(values, reference, name):
    print(f"  {name:34s}" + "  ".join("{} {:+.2f} {:+.2f} {:+.2f} %".format(what, *(100 * (v / w - 1)))
                                   for what, v, w in zip(("drag", "rotation"), values, reference)))


# --- files ------------------------------------------------------------------------------------------------------------

def write_data(path, centre, radius, density):
    low, high = (centre - radius[:, None]).min(axis=0) - 1, (centre + radius[:, None]).max(axis=0) + 1
    box = "".join(f"{a:.8g} {b:.8g} {c}lo {c}hi\n" for a, b, c in zip(low, high, "xyz"))
    rows = "".join("{} 1 {:.9g} {:.9g} {:.9g} {:.9g} {:.9g} 1\n".format(i + 1, *p, 2 * r, d)
                   for i, (p, r, d) in enumerate(zip(centre, radius, density)))
    path.write_text(f"inscribed spheres, by fill.py\n\n{len(radius)} atoms\n1 atom types\n{box}\n"
                    f"Atoms # hybrid\n\n{rows}")


def write_molecule(path, centre, radius, triangles, density):
    mass, middle, I = inertia(triangles, density)
    def rows(values):
        return "".join(f"{i + 1} {' '.join(f'{v:.9g}' for v in np.atleast_1d(row))}\n" for i, row in enumerate(values))
    path.write_text(f"inscribed spheres, by fill.py\n\n{len(radius)} atoms\n{mass:.9g} mass\n" +
                    " ".join(f"{v:.9g}" for v in middle) + " com\n" + " ".join(f"{v:.9g}" for v in I) + " inertia\n\n" +
                    f"Coords\n\n{rows(centre)}\nTypes\n\n{rows([1] * len(radius))}\nDiameters\n\n{rows(2 * radius)}")


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("shape", choices=[*SHAPES, "stl"])
    parser.add_argument("sizes", nargs="+")
    parser.add_argument("--gap", type=float, default=0.05)
    parser.add_argument("--grow", type=float, default=0.3)
    parser.add_argument("--density", type=float, default=1.0)
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--finer", type=float, default=2.0)
    parser.add_argument("--shell", type=int, default=12)
    given = parser.parse_args(argv)
    triangles = surface(given.shape, given.sizes)
    volume, middle = volume_and_centre(triangles)
    size = (3 * volume / (4 * np.pi))**(1 / 3)
    if given.gap < 0.01:
        raise Error(f"--gap {given.gap}: must be 0.01 or larger, as the surface has 3000 samples")
    centre, radius = fill(triangles, given.gap * size, given.grow)
    density = densities(centre, radius, triangles, given.density)
    print(f"{len(radius)} spheres, radii {radius.min():.4g} to {radius.max():.4g}; volume of the body {volume:.6g}, "
          f"its centre {middle.round(6).tolist()}; the spheres weigh together "
          f"{(density * 4 / 3 * np.pi * radius**3).sum():.6g}")
    if given.out:
        write_data(given.out.with_suffix(".data"), centre, radius, density)
        write_molecule(given.out.with_suffix(".mol"), centre, radius, triangles, given.density)
    if given.finer > 0 or given.shape == "ellipsoid":
        *values, points = resistance(centre, radius, given.shell)
        print("  {} points: drag {:.5g} {:.5g} {:.5g} viscosity, rotation {:.5g} {:.5g} {:.5g} viscosity; "
              "along and about x, y, z".format(
            points, *values[0], *values[1]))
        if given.shape == "ellipsoid":
            report(values, ellipsoid_resistance([float(word) for word in given.sizes]),
                   "error, against the exact values:")
        if given.finer > 0:
            more, large = fill(triangles, max(given.gap / given.finer, 0.01) * size, given.grow)
            report(values, resistance(more, large, given.shell)[:2], f"error, against {len(large)} spheres:")


if __name__ == "__main__":
    try:
        main()
    except Error as why:
        sys.exit(f"fill.py: {why}")
    except ValueError as why:      # of float(), or of stokesdyn
        sys.exit(f"fill.py: {why}")
