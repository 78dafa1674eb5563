#!/usr/bin/env python3
"""Turns STL files and simple shapes into particles of water, walls and bodies for pair_style sph/artVisc/tensCorr: a
data file of atom_style sph, an infile of fix rigid for each body, and a picture of cuts.

    particles.py --spacing 0.05 --tank 3 1 0.8 --level 0.6 --body hull.stl scale mm at 1.5 0.5 0.6 density 400 --out
    scene particles.py --spacing 0.05 --vessel bowl.stl --level 0.3 --out scene

    --tank X Y Z      a tank 0..X, 0..Y, 0..Z that is open above; or
    --vessel SHAPE    a closed surface that is the inside of a vessel; its wall stands around it
    --level Z         height of the water
    --wall SHAPE      a solid that is fixed (type 2, as tank and vessel); may be given several times
    --body SHAPE      a body of its own type, 3 and up; may be given several times
    --spacing DX      distance of the particles; X, Y, Z and the level are rounded to it
    --h 1.5           smoothing length over the spacing: walls are 2 h thick, the reach of the kernel
    --fit             moves each wall and body by up to a quarter of a spacing to where the volume of its particles is
                      best, and says how
    --density 1000    of the water: all particles have the mass density DX^3
    --out NAME        writes NAME.data, NAME.3.body .. (mass, centre, inertia of the bodies for fix rigid
                      infile), NAME.png

SHAPE is FILE.stl (ASCII or binary; other files if the Python module trimesh is installed), ellipsoid A B C (half-axes),
rod LENGTH RADIUS, disc RADIUS THICKNESS or cube EDGE, and after it any of

    scale S           a factor, or the unit of the file if the scene is in metres: mm cm m inch foot
    turn AXIS DEGREES about x, y or z through the origin of the file
    at X Y Z          where its origin goes, after scale and turn
    density RHO       of a body, for its infile (that of the water unless given)

Types: 1 water, 2 walls, 3 and up bodies. A particle belongs to a body when its centre lies in the surface. It is an
error when a surface is not closed, or when parts meet. It needs Python and numpy, and matplotlib for the picture.
"""
import argparse
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from surfaces import (np, Error, SHAPES, closed, inertia, inside, read, section, surface,  # noqa: E402
                      volume_and_centre)

WATER, WALL, BODY = 1, 2, 3
UNITS = {"mm": 0.001, "cm": 0.01, "m": 1.0, "inch": 0.0254, "foot": 0.3048}


# --- parts ------------------------------------------------------------------------------------------------------------

class Part:
    """A closed surface in its place: name, triangles, density (None: that of the water)"""

    def __init__(self, words):
        self.name, self.density = " ".join(words), None
        count = 1 + SHAPES.get(words[0], 0)
        if words[0] in SHAPES:
            triangles = surface(words[0], words[1:count])
        else:
            triangles = closed(read(words[0]), words[0])
            self.name = words[0]
        words = list(words[count:])
        needs = {"scale": 1, "turn": 2, "at": 3, "density": 1}
        given = {}
        while words:
            key = words.pop(0)
            if key not in needs or len(words) < needs[key]:
                raise Error(f"{self.name}: {key}: known are scale S, turn AXIS DEGREES, at X Y Z, density RHO")
            given[key] = [words.pop(0) for _ in range(needs[key])]
        factor = self._scale(*given.get("scale", ["1"]))
        self.triangles = factor * triangles @ self._turn(*given.get("turn", ["z", "0"])).T + self._numbers(
            given.get("at", ["0"] * 3), "at")
        if "density" in given:
            self.density = self._numbers(given["density"], "density")[0]
            if self.density <= 0:
                raise Error(f"{self.name}: density {self.density:g}: must be > 0")

    def _numbers(self, words, key):
        try:
            values = np.array([float(word) for word in words])
        except ValueError:
            raise Error(f"{self.name}: {key} {' '.join(words)}: not a number") from None
        if not np.isfinite(values).all():
            raise Error(f"{self.name}: {key} {' '.join(words)}: not finite")
        return values

    def _scale(self, word):
        factor = UNITS[word] if word in UNITS else self._numbers([word], "scale")[0]
        if factor <= 0:
            raise Error(f"{self.name}: scale {word}: must be > 0")
        return factor

    def _turn(self, axis, degrees):
        if axis not in ("x", "y", "z"):
            raise Error(f"{self.name}: turn {axis}: the axis must be x, y or z")
        k, angle = "xyz".index(axis), np.radians(self._numbers([degrees], "turn")[0])
        i, j, turn = (k + 1) % 3, (k + 2) % 3, np.eye(3)
        turn[i, i] = turn[j, j] = np.cos(angle)
        turn[j, i], turn[i, j] = np.sin(angle), -np.sin(angle)
        return turn

    def box(self):
        return self.triangles.min(axis=(0, 1)), self.triangles.max(axis=(0, 1))


# --- the lattice ------------------------------------------------------------------------------------------------------

def shifted(cells, by):
    """The cells moved by whole cells; what leaves the lattice is lost"""
    out = np.zeros_like(cells)
    to = tuple(slice(max(k, 0), n + min(k, 0)) for k, n in zip(by, cells.shape))
    of = tuple(slice(max(-k, 0), n + min(-k, 0)) for k, n in zip(by, cells.shape))
    out[to] = cells[of]
    return out


def around(cells, reach):
    """All cells that are within reach (in spacings) of one of these"""
    n = int(reach + 1e-9)
    offsets = np.array(np.meshgrid(*[np.arange(-n, n + 1)] * 3)).reshape(3, -1).T
    near = np.zeros_like(cells)
    for by in offsets[(offsets**2).sum(axis=1) <= reach**2 + 1e-9]:
        near |= shifted(cells, by)
    return near


def thin(cells, reach):
    """Cells of a solid that belong to no ball in it whose diameter is the reach: there water on one side feels water on
    the other"""
    return cells & ~around(~around(~cells, reach / 2), reach / 2)


def reached(cells, start):
    """Those cells that are joined to one of start by faces"""
    found = cells & start
    while True:
        more = found.copy()
        for by in np.concatenate([np.eye(3, dtype=int), -np.eye(3, dtype=int)]):
            more |= shifted(found, by)
        more &= cells
        if (more == found).all():
            return found
        found = more


class Scene:
    """Types of all nodes of a lattice (0: nothing there). vessel: a Part or None; tank: three lengths or None"""

    def __init__(self, spacing, h, tank, vessel, level, walls, bodies, fit=False):
        self.dx, self.h, self.parts, self.said = spacing, h, walls + bodies, []
        self.walls, self.bodies, self.vessel, self.level = walls, bodies, vessel, level
        self.layers = int(np.ceil(2 * h - 1e-9))
        tank_cells = self._lattice(tank)
        room = inside(vessel.triangles, *self.axes, vessel.name) if vessel else tank_cells
        if fit:
            for part in self.parts:
                self._fit(part)
        self.solids = [self._solid(part) for part in self.parts]
        container = around(room, 2 * h) & ~room if vessel else self._shell(tank_cells)
        self.type = np.where(container, WALL, 0)
        for number, (part, cells) in enumerate(zip(self.parts, self.solids)):
            fixed = number < len(walls)
            taken = cells & (self.type > 0) & ~(container if fixed else np.zeros_like(container))
            if taken.any():
                raise Error(f"{part.name}: {taken.sum()} of its particles stand in another part or in "
                            "the wall: move it")
            self.type[cells] = WALL if fixed else BODY + number - len(walls)
        self._pour(room)

    def _lattice(self, tank):
        """Planes of nodes, half a spacing off the walls of the tank; returns its nodes"""
        boxes = [part.box() for part in [*self.parts, self.vessel]
                 if part] + ([(np.zeros(3), np.array(tank))] if tank else [])
        margin = self.layers + 1    # and room for what --fit moves
        low = np.floor(np.min([b[0] for b in boxes], axis=0) / self.dx + 1e-6).astype(int) - margin
        high = np.ceil(np.max([b[1] for b in boxes], axis=0) / self.dx - 1e-6).astype(int) + margin
        if np.prod((high - low).astype(float)) > 1e8:
            raise Error(f"the scene is {' x '.join(map(str, high - low))} spacings: too many. Are spacing and scale in "
                        "the same unit?")
        self.axes = [(np.arange(a, b) + 0.5) * self.dx for a, b in zip(low, high)]
        self.low, self.high = low * self.dx, high * self.dx
        if not tank:
            return None
        n = np.rint(np.array(tank) / self.dx) * self.dx
        within = [(axis > 0) & (axis < length) for axis, length in zip(self.axes, n)]
        return within[0][:, None, None] & within[1][None, :, None] & within[2][None, None, :]

    def _shell(self, tank_cells):
        """Floor and sides of the tank, open above"""
        shell = tank_cells
        for unit in np.eye(3, dtype=int):
            shell = shell | np.any([shifted(shell, k * unit) for k in range(-self.layers, self.layers + 1)], axis=0)
        top = self.axes[2][np.nonzero(tank_cells.any(axis=(0, 1)))[0].max()]
        return shell & ~tank_cells & (self.axes[2] <= top)[None, None, :]

    def _fit(self, part):
        """Moves the part to where its number of nodes is closest to its volume, of equal ones by the least"""
        wanted = volume_and_centre(part.triangles)[0] / self.dx**3
        moves = np.array(np.meshgrid(*[[-1, 0, 1]] * 3)).reshape(3, -1).T / 4 * self.dx
        off = [abs(inside(part.triangles + by, *self.axes, part.name).sum() - wanted) for by in moves]
        by = moves[np.lexsort([np.linalg.norm(moves, axis=1), off])[0]]
        part.triangles = part.triangles + by
        self.said.append(f"{part.name}: moved by {' '.join(f'{v / self.dx:g}' for v in by)} spacings")

    def _solid(self, part):
        cells = inside(part.triangles, *self.axes, part.name)
        if not cells.any():
            size = part.box()[1] - part.box()[0]
            raise Error(f"{part.name}: no particle lies in it; it is {size[0]:.4g} x {size[1]:.4g} x {size[2]:.4g}, "
                        f"the spacing is {self.dx:g}. Is the scale right?")
        volume = volume_and_centre(part.triangles)[0]
        off = cells.sum() * self.dx**3 / volume - 1
        weak = thin(cells, 2 * self.h).sum() / cells.sum()
        self.said.append(f"{part.name}: {cells.sum()} particles, volume {volume:.6g}, that of the particles "
                         f"{100 * off:+.2f} %; {100 * weak:.0f} % of it is thinner than the reach of the kernel, "
                         f"{2 * self.h * self.dx:.4g}")
        if abs(off) > 0.01:
            self.said.append(f"WARNING: {part.name}: the volume of its particles is off by more than 1 %: "
                             "take a smaller spacing, or --fit")
        if weak > 0.3:
            self.said.append(f"WARNING: {part.name}: too thin, water on one side feels water on the other: "
                             "take a smaller spacing or a thicker body, or give the wetted side as --vessel")
        return cells

    def _pour(self, room):
        """Water below the level, but for cavities that no water can get into from above"""
        wet = room & (self.type == 0) & (self.axes[2] < self.level)[None, None, :]
        if not wet.any():
            raise Error(f"level {self.level:g}: there is no room for water below it")
        free = room & (self.type == 0)
        open_above = reached(free, free & (np.arange(len(self.axes[2])) ==
                                           np.nonzero(free.any(axis=(0, 1)))[0].max())[None, None, :])
        self.type[wet & open_above] = WATER
        dry = (wet & ~open_above).sum()
        if dry:
            self.said.append(f"{dry} nodes below the level are closed in and stay empty")

    def particles(self):
        """Places [n, 3] and types [n]"""
        node = np.nonzero(self.type)
        return np.stack([axis[k] for axis, k in zip(self.axes, node)], axis=1), self.type[node]


# --- files ------------------------------------------------------------------------------------------------------------

def write_data(path, scene, density):
    x, kind = scene.particles()
    types = BODY - 1 + len(scene.bodies)
    with open(path, "w") as file:
        file.write(f"SPH particles, spacing {scene.dx:.9g}, by particles.py\n\n{len(x)} atoms\n{types} atom types\n")
        for a, b, c in zip(scene.low, scene.high, "xyz"):
            file.write(f"{a:.9g} {b:.9g} {c}lo {c}hi\n")
        file.write("\nMasses\n\n" + "".join(f"{k + 1} {density * scene.dx**3:.9g}\n" for k in range(types)) +
                   "\nAtoms # sph\n\n")
        # id type rho e cv x y z
        file.writelines(f"{n + 1} {kind[n]} {density:.9g} 0 1 {x[n, 0]:.9g} {x[n, 1]:.9g} {x[n, 2]:.9g}\n"
                        for n in range(len(x)))


def write_body(path, part, density):
    """One line of the infile of fix rigid: mass, centre and inertia of the solid that the surface holds, at rest"""
    mass, middle, I = inertia(part.triangles, part.density or density)
    path.write_text("1\n1 " + " ".join(f"{v:.9g}" for v in (mass, *middle, *I)) + " 0 0 0 0 0 0 0 0 0\n")


def draw(path, scene):
    """Cuts through the middle of the first part, along y, x and z: particles in the cut, and the surfaces"""
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    shown = scene.parts or [scene.vessel]
    middle = np.mean(shown[0].box(), axis=0) if shown[0] else (scene.low + scene.high) / 2
    x, kind = scene.particles()
    colour = np.array(["lightskyblue", "0.6"] + ["sandybrown"] * len(scene.bodies))[kind - 1]
    figure, axes = plt.subplots(1, 3, figsize=(12, 3.6), gridspec_kw={"wspace": 0.3})
    for axis, k in zip(axes, (1, 0, 2)):
        i, j = [m for m in range(3) if m != k]
        plane = scene.axes[k][np.argmin(np.abs(scene.axes[k] - middle[k]))]
        here = np.abs(x[:, k] - plane) < scene.dx / 4
        axis.set(aspect="equal", xlim=(scene.low[i], scene.high[i]), ylim=(scene.low[j], scene.high[j]),
                 xlabel="xyz"[i], ylabel="xyz"[j])
        axis.figure.canvas.draw()
        points = axis.transData.transform([[0, 0], [scene.dx, 0]])[:, 0] @ [-1, 1] * 72 / figure.dpi
        axis.scatter(x[here, i], x[here, j], s=(0.85 * points)**2, c=colour[here], lw=0)
        for part in filter(None, scene.parts + [scene.vessel]):
            for line in section(part.triangles, k, plane):
                axis.plot(line[:, i], line[:, j], "k-", lw=0.8)
    figure.savefig(path, dpi=90, bbox_inches="tight", pil_kwargs={"optimize": True})
    plt.close(figure)


def main(argv=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--spacing", type=float, required=True)
    parser.add_argument("--h", type=float, default=1.5)
    holds = parser.add_mutually_exclusive_group(required=True)
    holds.add_argument("--tank", type=float, nargs=3)
    holds.add_argument("--vessel", nargs="+")
    parser.add_argument("--level", type=float, required=True)
    parser.add_argument("--wall", nargs="+", action="append", default=[])
    parser.add_argument("--body", nargs="+", action="append", default=[])
    parser.add_argument("--fit", action="store_true")
    parser.add_argument("--density", type=float, default=1000.0)
    parser.add_argument("--out", type=pathlib.Path)
    given = parser.parse_args(argv)
    for name, value in (("spacing", given.spacing), ("density", given.density),
                        *(("tank", v) for v in given.tank or [])):
        if not 0 < value < np.inf:
            raise Error(f"--{name} {value:g}: must be > 0")
    if not 1 <= given.h <= 4:
        raise Error(f"--h {given.h:g}: must be 1 to 4, as it is the smoothing length over the spacing")
    scene = Scene(given.spacing, given.h, given.tank, Part(given.vessel) if given.vessel else None, given.level,
                  [Part(words) for words in given.wall], [Part(words) for words in given.body], given.fit)
    print("\n".join(scene.said + ["{} particles: {} of water, {} of walls, {} of bodies; walls of {} layers".format(
        (scene.type > 0).sum(), (scene.type == WATER).sum(), (scene.type == WALL).sum(), (scene.type >= BODY).sum(),
        scene.layers)]))
    if given.out:
        given.out.parent.mkdir(parents=True, exist_ok=True)
        write_data(f"{given.out}.data", scene, given.density)
        for number, part in enumerate(scene.bodies):
            write_body(pathlib.Path(f"{given.out}.{BODY + number}.body"), part, given.density)
        try:
            draw(f"{given.out}.png", scene)
        except ImportError:
            print(f"no {given.out}.png: Python's matplotlib is not installed")
    return scene


if __name__ == "__main__":
    try:
        main()
    except Error as why:
        sys.exit(f"particles.py: {why}")
