#!/usr/bin/env python3
"""Flexible fibres of spheres, bonds and angles (in.fibres): they settle and bend, tumble and buckle in shear.

    run.py --out DIR     results and the picture go to DIR (default: build/examples/fibres)
    run.py --quick       without the long runs in shear
    run.py --update      also refreshes the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, dumped, finished, need, options, save, values  # noqa: E402

N, LONG = 15, 20               # spheres of a fibre that settles, of one that buckles
SHORT, RE = 10, 8.2899          # of one that tumbles, and its exact effective aspect ratio (../tumbling)
POINTS, PIECES = "cut_off_distance inf", "cut_off_distance inf rigid_clumps yes multiblob 12"


def write(path, x, piece):
    """Data file of one fibre; piece: so many spheres have one molecule ID; 0: all are free"""
    n = len(x)
    atoms = "".join("{} 1 {:.15g} {:.15g} {:.15g} {} 2 1\n".format(i + 1, *p, 1 + i // piece if piece else 0)
                    for i, p in enumerate(x))
    path.write_text(f"fibre\n\n{n} atoms\n{n - 1} bonds\n{n - 2} angles\n1 atom types\n1 bond types\n1 angle types\n" +
                    "".join(f"-900 900 {c}lo {c}hi\n" for c in "xyz") + f"\nAtoms\n\n{atoms}\nBonds\n\n" +
                    "".join(f"{i} 1 {i} {i + 1}\n" for i in range(1, n)) + "\nAngles\n\n" +
                    "".join(f"{i} 1 {i} {i + 1} {i + 2}\n" for i in range(1, n - 1)))


def run(out, name, x, piece=0, **variables):
    """Steps and rows [frames, spheres, 9]: place, velocity, force"""
    write(out / f"{name}.data", x, piece)
    finished("fibres", ["lmp", "-in", "in.fibres", "-log", str(out / f"{name}.log")] + values(
        dict(fibre=out / f"{name}.data", out=out / f"{name}.places", **variables)), HERE)
    steps, rows = zip(*dumped(out / f"{name}.places"))
    return np.array(steps), np.array(rows)[:, :, 1:]


def mobility(x):
    """[n, 3, n, 3] of spheres of radius 1 that may overlap a little, 6 pi viscosity 1 (Rotne & Prager 1969, Yamakawa
    1970)"""
    n = len(x)
    M = np.zeros((n, 3, n, 3))
    for i in range(n):
        M[i, :, i] = np.eye(3)
        for j in set(range(n)) - {i}:
            r = x[i] - x[j]
            s = np.linalg.norm(r)
            line = np.outer(r, r) / s**2
            M[i, :, j] = (3 / (4 * s) * ((1 + 2 / (3 * s**2)) * np.eye(3) + (1 - 2 / s**2) * line) if s > 2 else
                          (1 - 9 * s / 32) * np.eye(3) + 3 * s / 32 * line)
    return M


def straight(n, axis):
    x = np.zeros((n, 3))
    x[:, axis] = 2.0 * (np.arange(n) - (n - 1) / 2)
    return x


def weak_bending(bend, weight):
    """Speed, and how much lower the middle is than the ends, of a straight fibre that settles across itself, to first
    order in the weight: P (F + B w) = U for all spheres, P: mobility across, B: forces of the angles, w:
    displacement"""
    P = mobility(straight(N, 0))[:, 2, :, 2]
    D = np.diff(np.eye(N), 2, axis=0) / 2                          # angles from displacements, neighbours 2 apart
    B = -bend * D.T @ D
    drag = np.linalg.solve(P, np.ones(N))
    U = N * weight / drag.sum()
    w = np.linalg.lstsq(B, U * drag - weight, rcond=1e-12)[0]      # along the weight
    return U, w[N // 2] - (w[0] + w[-1]) / 2


def settle(out, c):
    x = straight(N, 0)
    x[:, 2] = 0.3 * np.sin(np.arange(N))
    _, rows = run(out, "bent", x, steps=1, every=1, weight=0.5)
    right = np.einsum("iajb,jb->ia", mobility(x), rows[0][:, 6:9])
    c.below("bent fibre: velocities from a dense matrix, over the largest",
            np.abs(rows[0][:, 3:6] - right).max() / np.abs(right).max(), 1e-10)
    bend, weight = 200.0, 0.02
    _, rows = run(out, "weak", straight(N, 0), bend=bend, weight=weight, steps=60000, every=60000, dt=2e-3)
    U, sag = weak_bending(bend, weight)
    z = rows[-1][:, 2]
    c.near("settles, stiff: speed over that of the straight fibre", -rows[-1][:, 5].mean() / U, 1, 1e-3)
    c.near("settles, stiff: how much the middle is ahead, over first order", ((z[0] + z[-1]) / 2 - z[N // 2]) / sag, 1,
           0.02)
    x = straight(N, 0)
    x[:, 2] = 0.01 * np.arange(N)
    return run(out, "loose", x, bend=20, weight=0.5, steps=60000, every=3000, dt=1e-3)[1]


def buckling_rate(number):
    """Growth rate over the rate of shear of the first bend of a straight fibre at 45 degrees, where shear compresses it
    most. With s along the fibre, of length 1, and w across it (local slender-body theory, Becker & Shelley, Phys. Rev.
    Lett. 87, 198301 (2001)):
        w_t = (s w' + w)/2 + (s^2 - 1/4)/8 w'' - w''''/number,   free ends,
    in Legendre polynomials; the first two modes are displacement and rotation"""
    s, weight = np.polynomial.legendre.leggauss(50)
    s, weight = s / 2, weight / 2
    basis = [np.polynomial.legendre.Legendre.basis(k, domain=[-0.5, 0.5]) for k in range(20)]
    w, w1, w2 = (np.array([f.deriv(k)(s) if k else f(s) for f in basis]) for k in range(3))
    flow = 0.5 * (s * w1 + w) + (s**2 - 0.25) / 8 * w2
    rates = np.linalg.eigvals(np.linalg.solve((w * weight) @ w.T, (w * weight) @ flow.T - (w2 * weight) @ w2.T /
                                              number))
    return np.sort(rates.real)[-3]


def turn(rows, dt_of_frames):
    """The time from 45 to 225 degrees, of the line between the ends, and the shortest of these lines over the length"""
    d = rows[:, -1, :3] - rows[:, 0, :3]
    angle, t = np.unwrap(np.arctan2(d[:, 0], d[:, 2])), dt_of_frames * np.arange(len(rows))
    at = [np.interp(part * np.pi, angle, t) for part in (0.25, 1.25)]
    return at[1] - at[0], angle[-1] > 1.25 * np.pi, np.linalg.norm(d, axis=1).min() / (2 * (rows.shape[1] - 1))


def shear(out, c):
    x = straight(SHORT, 2)
    x[:, 0] = 0.02 * np.sin(np.arange(SHORT))
    half, found = np.pi * (RE + 1 / RE), {}
    for name, bend, piece, model in (("pieces", 400, 2, PIECES), ("free", 400, 0, "cut_off_distance inf rotation yes")):
        _, rows = run(out, name, x, piece=piece, model=model, rate=1, bend=bend, dt=0.002, steps=17000, every=100)
        found[name] = turn(rows, 0.2)
        print(f"  shear, {name}: half a turn {found[name][0]:.3f}, Jeffery {half:.3f}; shortest end to end "
              f"{found[name][2]:.3f}", flush=True)
    c.holds("shear, pieces of two spheres: it turns over", found["pieces"][1])
    c.near("shear, pieces of two spheres: half a turn over Jeffery's", found["pieces"][0] / half, 1, 0.05)
    c.holds("shear, single spheres: it lies down along the flow and stays", not found["free"][1])
    shown = {}
    for bend, dt in ((3000, 2e-4), (10, 5e-4)):
        _, rows = run(out, f"bend{bend}", tilted(LONG), piece=2, model=PIECES, rate=1, bend=bend, stretch=500, dt=dt,
                      steps=round(6 / dt), every=round(0.2 / dt))
        shortest = turn(rows, 0.2)[2]
        number = 8 / 6 * (2 * LONG)**4 / (2 * bend * (2 * np.log(2 * LONG) - 1))
        print(f"  shear, elasto-viscous number {number:.0f}: shortest end to end {shortest:.3f} of the length",
              flush=True)
        shown[number] = rows, shortest
    (low, stiff), (high, limp) = shown.items()
    c.below("shear, stiff: growth rate of the first bend by theory", buckling_rate(low), 0.0)
    c.below("shear, stiff: shortest distance of the ends below the length, part", 1 - stiff[1], 0.01)
    c.within("shear, limp: growth rate of the first bend by theory, over the rate of shear", buckling_rate(high), 0.5,
             np.inf)
    c.below("shear, limp: shortest distance of the ends over the length", limp[1], 0.8)
    return shown


def tilted(n):
    """A nearly straight fibre against the flow, so that it is first compressed"""
    s = 2.0 * (np.arange(n) - (n - 1) / 2)
    bow = 0.2 * np.cos(2.5 * np.pi * s / s[-1] / 2)
    return np.column_stack([-0.94 * s + 0.342 * bow, 0 * s, 0.342 * s + 0.94 * bow])


def draw(fall, shown, path):
    plt.rcParams.update({"font.size": 10})
    figure, panels = plt.subplots(1, 3, figsize=(11, 5), layout="constrained")
    for k in range(0, len(fall), 4):
        for p in fall[k]:
            panels[0].add_patch(plt.Circle(p[[0, 2]], 1, fc=plt.get_cmap("viridis")(k / len(fall)), ec="0.2", lw=0.3))
    panels[0].set(title="settles", xlim=(-22, 22), ylim=(fall[-1][:, 2].min() - 4, 6))
    for panel, (number, (rows, _)), title in zip(panels[1:], shown.items(), ("stiff", "limp")):
        for row, k in enumerate(np.linspace(0, len(rows) - 1, 8).astype(int)):
            x = rows[k][:, :3] - rows[k][:, :3].mean(axis=0)
            for p in x:
                panel.add_patch(plt.Circle((p[0] + 44 * (row % 2), p[2] - 38 * (row // 2)), 1, fc="#1b9e77", ec="0.2",
                                           lw=0.3))
        panel.set(title=f"in shear, {title} (number {number:.0f})", xlim=(-22, 66), ylim=(-136, 22))
    for panel in panels:
        panel.set(xticks=[], yticks=[])
        panel.set_aspect("equal")
    save(figure, path)


def main():
    given = options(__file__, __doc__, quick=False)
    need("lmp")
    c = Checks()
    fall = settle(given.out, c)
    z = fall[-1][:, 2]
    c.within("settles, limp: its ends are far behind the middle, radii", (z[0] + z[-1]) / 2 - z[N // 2], 4, 14)
    x = fall[-1][:, :3] - fall[-1][:, :3].mean(axis=0)
    c.below("settles, limp: left and right are mirror images, radii",
            np.abs(np.abs(x[:, 0]) - np.abs(x[::-1, 0])).max(), 0.1)
    c.near("theory: the number at which a fibre begins to buckle, growth rate there", buckling_rate(306.4), 0, 1e-3)
    if not given.quick:
        draw(fall, shear(given.out, c), given.out / "fibres.png")
        if given.update:
            shutil.copy(given.out / "fibres.png", HERE)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
