#!/usr/bin/env python3
"""A ship from an STL file in still water: the file, its particles (particles.py), the lift that Archimedes gives, its
draft (in.ship).

    run.py --out DIR     results and the picture go to DIR (default: build/examples/ship)
    run.py --quick       the ship held for 0.4 s only
    run.py --update      also refreshes the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]
import particles  # noqa: E402
import surfaces  # noqa: E402
from checks import Checks  # noqa: E402
from runs import np, finished, need, options, thermo, values  # noqa: E402

L, B, T, FREEBOARD = 2.0, 0.8, 0.4, 0.2
# volumes of Wigley's hull below and above the water line
UNDER, ABOVE = 4 / 9 * L * B * T, 2 / 3 * L * B * FREEBOARD
TANK, LEVEL, G = (2.8, 1.6, 1.0), 0.8, 9.81


def hull(n=32, m=16):
    """Triangles of Wigley's hull: half breadth B/2 (1 - (2x/L)^2)(1 - (z/T)^2) below the water line z = 0, with upright
    sides above it and a deck"""
    x = np.linspace(-L / 2, L / 2, n + 1)
    z = np.concatenate([np.linspace(-T, 0, m + 1), np.linspace(0, FREEBOARD, m // 4 + 1)[1:]])
    y = np.outer(1 - (2 * x / L)**2, 1 - (np.minimum(z, 0) / T)**2) * B / 2
    X, Z = np.broadcast_arrays(x[:, None], z[None, :])
    def halves(a, b, c, d):
        return np.concatenate([np.stack(three, axis=2).reshape(-1, 3, 3) for three in ((a, b, c), (a, c, d))])
    # cut from the middle of the keel outwards, so that at its ends no triangle lies in the plane y = 0
    def quads(p):
        a, b, c, d = p[:-1, :-1], p[1:, :-1], p[1:, 1:], p[:-1, 1:]
        return np.concatenate([halves(*(q[:n // 2] for q in (a, b, c, d))),
                               halves(*(q[n // 2:] for q in (b, c, d, a)))])
    port, starboard = np.stack([X, y, Z], axis=2), np.stack([X, -y, Z], axis=2)
    deck = np.stack([starboard[:, -1], port[:, -1]], axis=1)
    return np.concatenate([quads(starboard), quads(port)[:, ::-1], quads(deck)])


def bowl(radius=0.4, n=24):
    """Triangles of the inside of a bowl: half a sphere, with a lid"""
    angle = np.linspace(-np.pi / 2, 0, n + 1)
    r = np.concatenate([radius * np.cos(angle), [0.0]])
    return surfaces.profile_mesh(np.concatenate([radius * np.sin(angle), [0.0]]), r)


def wrong(scene, part, cells, near):
    """How many nodes of the lattice within `near` of the box of the part are on the wrong side, by the winding
    number"""
    low, high = part.box()
    grid = np.stack(np.meshgrid(*scene.axes, indexing="ij"), axis=3)
    here = ((grid > low - near) & (grid < high + near)).all(axis=3)
    # a node on the surface is where inside() has it
    points = grid[here] + scene.dx * np.array([1.414e-7, 0.732e-7, 0])
    return int(((surfaces.winding_number(part.triangles, points) > 0.5) != cells[here]).sum())


def geometry(out, c):
    """Files that are no ship: with a hole through, hollow, open; and a bowl"""
    angle = 2 * np.pi * np.arange(33) / 32
    tube = np.stack([0.3 + 0.12 * np.cos(angle), 0.12 * np.sin(angle)], axis=1)
    torus = np.stack([np.outer(np.cos(angle), tube[:, 0]), np.outer(np.sin(angle), tube[:, 0]),
                      np.tile(tube[:, 1], (33, 1))], axis=2)
    torus[:, -1], torus[-1] = torus[:, 0], torus[0]
    a, b, d, e = torus[:-1, :-1], torus[1:, :-1], torus[1:, 1:], torus[:-1, 1:]
    surfaces.write_stl(out / "ring.stl",
                       np.concatenate([np.stack(t, axis=2).reshape(-1, 3, 3) for t in ((a, b, d), (a, d, e))]))
    outer, inner = surfaces.sphere_mesh(8) * 0.4, surfaces.sphere_mesh(8)[:, ::-1] * 0.2
    surfaces.write_stl(out / "hollow.stl", np.concatenate([outer, inner]))
    surfaces.write_stl(out / "open.stl", outer[2:])
    for name, middle in (("ring", particles.WATER), ("hollow", 0)):
        scene = particles.main(["--spacing", "0.04", "--tank", "1.2", "1.2", "1.2", "--level", "1.1", "--body",
                                str(out / f"{name}.stl"), "at", "0.6", "0.6", "0.6", "--fit"])
        part, cells = scene.parts[0], scene.solids[0]
        c.near(f"{name}: volume of the particles",
               cells.sum() * scene.dx**3 / surfaces.volume_and_centre(part.triangles)[0], 1, 0.01)
        c.below(f"{name}: particles on the wrong side", wrong(scene, part, cells, 0.08), 0)
        centre = tuple(np.searchsorted(axis, 0.6) for axis in scene.axes)
        c.holds(f"{name}: {'water runs through' if middle else 'the cavity stays empty'}", scene.type[centre] == middle)
    try:
        particles.main(["--spacing", "0.04", "--tank", "1", "1", "1", "--level", "0.6", "--body",
                        str(out / "open.stl")])
        said = ""
    except surfaces.Error as why:
        said = str(why)
    c.holds("a surface that is not closed: " + said[-230:], "open.stl" in said and
            "4 edges belong to one triangle only" in said)
    surfaces.write_stl(out / "bowl.stl", 1000 * bowl())
    scene = particles.main(["--spacing", "0.025", "--vessel", str(out / "bowl.stl"), "scale", "mm", "--level", "-0.1",
                            "--out", str(out / "bowl")])
    x, kind = scene.particles()
    water = x[kind == particles.WATER]
    c.near("bowl: volume of the water", len(water) * scene.dx**3 / (np.pi * 0.3**2 * (3 * 0.4 - 0.3) / 3), 1, 0.01)
    near = np.array([np.min(np.linalg.norm(x[kind == particles.WALL] - p, axis=1)) for p in water[::20]])
    c.holds("bowl: no water below its wall", len(near) and np.linalg.norm(water, axis=1).max() < 0.4)


def ship(out, n, c, quick):
    dx = B / n
    # of the surface, as water is compressed by its own weight: depth^2 g / (2 c^2)
    sunk = G * LEVEL**2 / (2 * 100 * G * LEVEL)
    scene = particles.main(["--spacing", f"{dx:.9g}", "--tank", *map(str, TANK), "--level", str(LEVEL), "--body",
                            str(out / "hull.stl"), "scale", "mm", "at", str(TANK[0] / 2), str(TANK[1] / 2),
                            f"{LEVEL - sunk:.9g}", "density", f"{1000 * UNDER / (UNDER + ABOVE):.9g}", "--out",
                            str(out / f"ship{n}")])
    cells = scene.solids[0]
    c.near(f"{n} across: volume of the particles over that of the hull", cells.sum() * dx**3 / (UNDER + ABOVE), 1, 0.01)
    c.below(f"{n} across: particles on the wrong side", wrong(scene, scene.parts[0], cells, 2 * dx), 0)
    c.near(f"{n} across: mass for fix rigid over displacement",
           float((out / f"ship{n}.3.body").read_text().split()[2]) / (1000 * UNDER),
           1, 0.003)
    for afloat in ((0,) if quick else (0, 1)):
        given = values(dict(scene=f"ship{n}", spacing=f"{dx:.9g}", level=LEVEL, afloat=afloat,
                            time=0.4 if quick else 1))
        said = finished("ship", ["lmp", "-in", str(HERE / "in.ship"), "-log", f"log.ship.{n}.{afloat}", "-nocite",
                                 *given], out)
        _, time, lift, z, _ = thermo(said, "Step Time").T
        late = time > (0.2 if quick else 0.3)
        if afloat:
            c.near(f"{n} across: afloat, mean of its heave in spacings", (z[late] - z[0]).mean() / dx, 0, 0.15)
        else:
            c.near(f"{n} across: lift over the weight of the displaced water", lift[late].mean() / (1000 * G * UNDER),
                   1, 0.05)


def main():
    given = options(__file__, __doc__, quick=False)
    need("lmp")
    c = Checks()
    surfaces.write_stl(given.out / "hull.stl", 1000 * hull())
    c.near("hull.stl: volume over Wigley's",
           surfaces.volume_and_centre(surfaces.read(given.out / "hull.stl", 0.001))[0] / (UNDER + ABOVE),
           1, 0.003)
    geometry(given.out, c)
    ship(given.out, 12, c, given.quick)
    if given.update:
        shutil.copy(given.out / "ship12.png", HERE / "ship.png")
    sys.exit(c.finish())


if __name__ == "__main__":
    main()
