#!/usr/bin/env python3
"""Ellipsoids, rods, discs, cubes and bodies from STL files as rigid clumps of overlapping spheres (fill.py): errors of
drag and rotation, and the weight of such a clump (in.weight).

    run.py --out DIR     results and the picture go to DIR (default: build/examples/shapes)
    run.py --quick       ellipsoids, files and weight only
    run.py --update      also refreshes the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import re
import shutil
import struct
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]
import fill  # noqa: E402
from checks import Checks  # noqa: E402
from runs import np, plt, finished, need, open_axes, options, save, values  # noqa: E402

# spheres on the axis of an ellipsoid of half-axes 3, 1, 1: limits of the errors of drag and rotation, per cent
ON_AXIS = {9: (2.2, 6), 15: (0.9, 2.4), 25: (0.5, 1)}
GAPS = (0.4, 0.2, 0.1, 0.05)
# of the picture: shape, sizes, gap
SHOWN = {"ellipsoid 3 1 1": 0.1, "rod 4 1": 0.1, "disc 2 0.5": 0.2, "cube 2": 0.2}


def spheroid(a, b):
    """Drag along and across the axis, torque about and across it; half-axes a > b, viscosity 1 (Perrin 1934)"""
    e = np.sqrt(1 - (b / a)**2)
    L = np.log((1 + e) / (1 - e))
    return (np.pi * a * 16 * e**3 / ((1 + e**2) * L - 2 * e), np.pi * a * 32 * e**3 / (2 * e + (3 * e**2 - 1) * L),
            np.pi * a**3 * 32 / 3 * e**3 * (1 - e**2) / (2 * e - (1 - e**2) * L),
            np.pi * a**3 * 32 / 3 * e**3 * (2 - e**2) / ((1 + e**2) * L - 2 * e))


def on_axis(n, a=3.0, b=1.0):
    """n spheres that touch a prolate spheroid from within: centres evenly between those of the tips, which have radius
    b^2/a"""
    x = np.linspace(-1, 1, n) * (a - b * b / a)
    return np.column_stack([x, 0 * x, 0 * x]), np.sqrt(np.maximum(b * b * (1 - x**2 / (a * a - b * b)), (b * b / a)**2))


def errors(found, exact):
    """Largest of drag, and of rotation, in per cent"""
    return [100 * np.abs(np.array(f) / e - 1).max() for f, e in zip(found, exact)]


def ellipsoids(c):
    exact = fill.ellipsoid_resistance((3, 1, 1))
    along, across, about, tumble = spheroid(3.0, 1.0)
    c.below("exact: three axes against Perrin's two", np.abs(np.array([exact[0] / (along, across, across), exact[1] /
                                                                       (about, tumble, tumble)]) - 1).max(), 1e-9)
    rows = {"on the axis": [], "inscribed": [], "grown": []}
    for n, (drag, rotation) in ON_AXIS.items():
        found = errors(fill.resistance(*on_axis(n), 42)[:2], exact)
        c.below(f"3:1, {n} spheres on the axis: error of the drag, per cent", found[0], drag)
        c.below(f"3:1, {n} spheres on the axis: error of the rotation, per cent", found[1], rotation)
        rows["on the axis"].append((n, *found))
    triangles = fill.surface("ellipsoid", "311")
    for gap in GAPS:
        for name, grow in (("inscribed", 0.0), ("grown", 0.3)):
            x, a = fill.fill(triangles, gap * 3**(1 / 3), grow)
            rows[name].append((len(a), *errors(fill.resistance(x, a, 12)[:2], exact)))
    c.below("3:1, fill of gap 0.1, grown: error of the drag, per cent", rows["grown"][2][1], 1.5)
    c.below("3:1, fill of gap 0.1, grown: error of the rotation, per cent", rows["grown"][2][2], 3)
    c.below("3:1, fill of gap 0.05, grown: error of the drag, per cent", rows["grown"][3][1], 0.8)
    for name, found in rows.items():
        print(f"  3:1, {name}: " + "; ".join("{} spheres {:.2f}, {:.2f} %".format(*row) for row in found), flush=True)
    return rows


def stl(out, c):
    """A cube as an ASCII and as a binary file, turned inside out, and with a hole"""
    triangles = fill.cube(2.0, 1).astype("<f4")
    def binary(faces):
        return b"cube".ljust(80) + struct.pack("<I", len(faces)) + b"".join(bytes(12) + face.tobytes() + b"\0\0"
                                                                            for face in faces)
    def text(faces):
        return ("solid cube\n" + "".join("facet normal 0 0 0\nouter loop\n" +
                                         "".join("vertex {:.7g} {:.7g} {:.7g}\n".format(*p) for p in face) +
                                         "endloop\nendfacet\n" for face in faces) + "endsolid\n")
    (out / "binary.stl").write_bytes(binary(triangles))
    (out / "text.stl").write_text(text(triangles))
    (out / "inside_out.stl").write_bytes(binary(np.ascontiguousarray(triangles[:, ::-1])))
    (out / "hole.stl").write_bytes(binary(triangles[1:]))
    for name in ("binary", "text", "inside_out"):
        volume, middle = fill.volume_and_centre(fill.surface("stl", [str(out / f"{name}.stl")]))
        c.near(f"cube from {name}.stl: volume", volume, 8, 1e-6)
    mass, _, inertia = fill.inertia(fill.surface("stl", [str(out / "text.stl"), "2"]), 0.5)
    c.below("cube of edge 4, density 0.5: mass and moments of inertia",
            np.abs(np.array([mass / 32 - 1, *(inertia / (32 * 16 / 6)) -
                             (1, 1, 1, 0, 0, 0)])).max(), 1e-6)
    try:
        fill.surface("stl", [str(out / "hole.stl")])
        said = ""
    except fill.Error as why:
        said = str(why)
    c.holds("cube with a hole: refused, and told how many edges are open",
            "not closed: 3 edges belong to one triangle" in said)


def weight(out, c):
    """The same clump by the densities of fill.py, and by the density of the material"""
    fill.main(["ellipsoid", "3", "1", "1", "--gap", "0.1", "--finer", "0", "--out", str(out / "body")])
    drag, volume = fill.ellipsoid_resistance((3, 1, 1))[0][2], fill.volume_and_centre(
        fill.surface("ellipsoid", "311"))[0]
    for density in (0, 1):
        said = finished("shapes", ["lmp", "-in", "in.weight", "-log", str(out / "weight.log")] + values(
            dict(body=out / "body.data", set_density=density)), HERE)
        mass, speed = map(float, re.search(r"^ *0 +(\S+) +(\S+) *$", said, re.M).groups())
        print(f"  density {density or 'of fill.py'}: mass {mass:.4f}, speed {speed:.4f}; the body has {volume:.4f}, "
              f"{volume / drag:.4f}")
        if density == 0:
            c.near("weight: mass of the clump", mass, volume, 1e-6 * volume)
            c.near("weight: speed, exact for the ellipsoid across its axis", speed, 4 * np.pi / drag,
                   0.01 * 4 * np.pi / drag)
        else:
            c.within("weight: with the density of the material, mass too large by a factor", mass / volume, 2, 6)


def balls(panel, x, radius):
    """Spheres seen from the side and a little from above, those in front painted last"""
    tilt = np.radians(25)
    turn = np.array([[0.94, 0.34, 0], [-0.34, 0.94, 0], [0, 0, 1]])
    y = x @ turn.T
    flat = np.column_stack([y[:, 0], y[:, 2] * np.cos(tilt) + y[:, 1] * np.sin(tilt)])
    depth = -y[:, 1] * np.cos(tilt) + y[:, 2] * np.sin(tilt)
    # one sphere in front of another one hides it by its own depth: paint by pieces of constant depth
    base = np.array([0.46, 0.44, 0.70])
    for level in np.linspace((depth - radius).min(), (depth + radius).max(), 60):
        for p, d, a in zip(flat, depth, radius):
            if abs(level - d) < a:
                s = np.sqrt(a * a - (level - d)**2)
                light = (level - d) / a if level > d else 0
                panel.add_patch(plt.Circle(p, s, lw=0,
                                           color=tuple(np.clip(base * (0.6 + 0.4 * light) + 0.35 * light**2, 0, 1))))
    panel.set(xlim=(flat.min() - 1.2, flat.max() + 1.2), ylim=(flat[:, 1].min() - 1.3, flat[:, 1].max() + 1.3))
    panel.set_aspect("equal")
    panel.axis("off")


def draw(rows, path, c):
    open_axes()
    figure = plt.figure(figsize=(12, 5.4), layout="constrained")
    grid = figure.add_gridspec(2, 3, width_ratios=[1, 1, 1.3])
    for k, (words, gap) in enumerate(SHOWN.items()):
        shape, *sizes = words.split()
        triangles = fill.surface(shape, sizes)
        size = (3 * fill.volume_and_centre(triangles)[0] / (4 * np.pi))**(1 / 3)
        x, a = fill.fill(triangles, gap * size, 0.3)
        finer = fill.fill(triangles, gap / 2 * size, 0.3)
        drag, rotation = errors(fill.resistance(x, a, 12)[:2], fill.resistance(*finer, 12)[:2])
        print(f"  {words}, gap {gap}: {len(a)} spheres differ from {len(finer[1])} by {drag:.2f} % (drag), "
              f"{rotation:.2f} % (rotation)", flush=True)
        c.below(f"{words}: drag against twice as fine a fill, per cent", drag, 2.5)
        panel = figure.add_subplot(grid[k // 2, k % 2])
        balls(panel, x, a)
        panel.set_title(f"{words}: {len(a)} spheres", fontsize=10)
    panel = figure.add_subplot(grid[:, 2])
    for (name, found), mark, colour in zip(rows.items(), "os^", ("C0", "C1", "C2")):
        n, drag, rotation = np.array(found).T
        panel.loglog(n, drag, mark + "-", color=colour, label=f"{name}: drag")
        panel.loglog(n, rotation, mark + ":", color=colour, mfc="w", label=f"{name}: rotation")
    panel.set(xlabel="spheres", ylabel="largest error, per cent", title="ellipsoid 3:1 against exact values")
    panel.set_yticks([0.3, 1, 3, 10, 30], ["0.3", "1", "3", "10", "30"])
    panel.set_xticks([4, 6, 10, 16, 25], ["4", "6", "10", "16", "25"], minor=False)
    panel.set_xticks([], minor=True)
    panel.legend(fontsize=8, frameon=False)
    save(figure, path)


def main():
    given = options(__file__, __doc__, quick=False)
    need("lmp")
    c = Checks()
    rows = ellipsoids(c)
    stl(given.out, c)
    weight(given.out, c)
    if not given.quick:
        draw(rows, given.out / "shapes.png", c)
        if given.update:
            shutil.copy(given.out / "shapes.png", HERE)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
