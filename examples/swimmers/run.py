#!/usr/bin/env python3
"""Bodies that swim or are kept in motion: a bacterium driven by opposite torques (in.bacterium), pinned rotors
(in.rotors), and plates of held spheres as moving walls (in.plates).

    run.py --out DIR     results and the picture go to DIR (default: build/examples/swimmers)
    run.py --quick       shorter runs, without the picture
    run.py --update      also refreshes the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from rigid import rigid_velocities  # noqa: E402
from runs import np, plt, dumped, finished, need, open_axes, options, save, values  # noqa: E402

TORQUE, STIFFNESS = 20.0, 20.0
ACROSS, HIGH = 5, 16.0          # spheres along an edge of a plate, and height of the box: two gaps of half of it


def run(out, script, name, **variables):
    """Of each frame of the file: rows"""
    finished("swimmers", ["lmp", "-in", f"in.{script}", "-log", str(out / f"{name}.log")] + values(
        dict(out=out / f"{name}.frames", **variables)), HERE)
    return np.array([rows for _, rows in dumped(out / f"{name}.frames")])


# --- bacterium --------------------------------------------------------------------------------------------------------

def bacterium():
    """Centres, radii; the first four spheres are the head"""
    head = [(0, y, z) for y in (-1, 1) for z in (-1, 1)]
    phi = 2 * np.pi * np.arange(19) / 9
    tail = np.column_stack([2 + 3 * phi / (2 * np.pi), 0.8 * np.cos(phi), 0.8 * np.sin(phi)])
    return np.concatenate([head, tail]), np.array([1.0] * 4 + [0.3] * 19)


def write_bug(path, x, a, one=False):
    """one: head and tail are one clump"""
    box = "".join(f"-60 60 {c}lo {c}hi\n" for c in "xyz")
    rows = "".join("{} {} {:.15g} {:.15g} {:.15g} {:.15g} 1 {}\n".format(i + 1, 1 + (i > 3), *p, 2 * r,
                                                                         1 if one else 1 + (i > 3))
                   for i, (p, r) in enumerate(zip(x, a)))
    path.write_text(f"bug\n\n{len(x)} atoms\n2 atom types\n{box}\nAtoms # hybrid\n\n{rows}")


def mobility(x, a):
    """[6n, 6n] of spheres that do not overlap, forces and torques, viscosity 1 (Rotne & Prager 1969; Zuk et al.
    2014)"""
    n = len(x)
    M = np.zeros((n, 2, 3, n, 2, 3))
    for i in range(n):
        M[i, 0, :, i, 0] = np.eye(3) / (6 * np.pi * a[i])
        M[i, 1, :, i, 1] = np.eye(3) / (8 * np.pi * a[i]**3)
        for j in set(range(n)) - {i}:
            r = x[i] - x[j]
            s = np.linalg.norm(r)
            line, size = np.outer(r, r) / s**2, (a[i]**2 + a[j]**2) / s**2
            cross = -np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]]) / (8 * np.pi * s**3)    # F x r
            M[i, 0, :, j, 0] = ((1 + size / 3) * np.eye(3) + (1 - size) * line) / (8 * np.pi * s)
            M[i, 0, :, j, 1] = M[i, 1, :, j, 0] = cross
            M[i, 1, :, j, 1] = (3 * line - np.eye(3)) / (16 * np.pi * s**3)
    return M.reshape(6 * n, 6 * n)


def dense(x, a, torque, gap):
    """Velocities of all spheres: two rigid bodies, opposite torques, and the spring along x between their centres of
    mass"""
    parts, m = (np.arange(4), np.arange(4, len(x))), a**3
    centre = [np.average(x[p], axis=0, weights=m[p]) for p in parts]
    K = np.zeros((6 * len(x), 12))
    for k, p in enumerate(parts):
        rigid = rigid_velocities(x[p] - centre[k]).reshape(-1, 3, 6)
        for row, i in zip(rigid, p):
            K[6 * i:6 * i + 3, 6 * k:6 * k + 6] = row
            K[6 * i + 3:6 * i + 6, 6 * k + 3:6 * k + 6] = np.eye(3)
    pull = STIFFNESS * (centre[1][0] - centre[0][0] - gap)
    load = np.concatenate([(pull, 0, 0, -torque, 0, 0), (-pull, 0, 0, torque, 0, 0)])
    V = np.linalg.solve(K.T @ np.linalg.solve(mobility(x, a), K), load)
    return (K @ V).reshape(-1, 6)[:, :3]


def swim(out, c, quick):
    x, a = bacterium()
    gap = np.average(x[4:, 0])
    write_bug(out / "bug.data", x, a)
    steps, speed = (200, 8000)[not quick], {}
    for name, torque in (("forwards", TORQUE), ("backwards", -TORQUE)):
        rows = run(out, "bacterium", name, bug=out / "bug.data", torque=torque, gap=f"{gap:.15g}", steps=steps,
                   every=steps // 20)
        v = np.array([frame[:, 5:8] for frame in rows])
        right = np.array([dense(frame[:, 2:5], a, torque, gap) for frame in rows])
        c.below(f"bacterium, {name}: velocities from a dense matrix, all the way, over the largest",
                np.abs(v - right).max() / np.abs(right).max(), 1e-7)
        at = np.array([np.average(frame[:4, 2], weights=a[:4]**3) for frame in rows])
        speed[name] = (at[-1] - at[len(at) // 2]) / (0.02 * steps / 20 * (len(at) - 1 - len(at) // 2))
        bug = rows
    print(f"  bacterium: speed {speed['forwards']:.5f} and {speed['backwards']:.5f}")
    c.below("bacterium: the other sense of the motor swims the other way; sum over difference of speeds",
            abs(speed["forwards"] + speed["backwards"]) / abs(speed["forwards"] - speed["backwards"]),
            0.02 if not quick else 0.2)
    write_bug(out / "one.data", x, a, one=True)
    rows = run(out, "bacterium", "one", bug=out / "one.data", gap=f"{gap:.15g}", steps=20, every=20)
    c.below("head and tail in one rigid clump: forces inside it cancel, it rests", np.abs(rows[-1][:, 5:8]).max(),
            1e-12)
    return bug, a


# --- rotors and plates ------------------------------------------------------------------------------------------------

def rotors(out, c):
    rows = run(out, "rotors", "rotors")[-1]
    x, v, f = rows[:, 1:4], rows[:, 4:7], rows[:, 8:10]
    # torques on the rotors from their angular velocity, then all velocities
    M = 8 * np.pi * mobility(x, np.ones(3)).reshape(3, 2, 3, 3, 2, 3)
    by_force = np.einsum("iakjb,jb->iak", M[:, :, :, :, 0], np.column_stack([f, 0 * f[:, 0]]))
    spin = M[:2, 1, :, :2, 1].reshape(6, 6)
    T = np.linalg.solve(spin, (np.array([(0, 0, 1.0)] * 2) - by_force[:2, 1]).ravel()).reshape(2, 3)
    right = by_force[:, 0] + np.einsum("ikjb,jb->ik", M[:, 0, :, :2, 1], T)
    c.below("rotors and a free sphere: velocities from a dense matrix", np.abs(v - right).max(), 1e-7)
    s = np.linalg.norm(x[1] - x[0])
    between = 4 / 3 * (1 - (1 + 2 / (3 * s**2)) * 3 / 4 / s)      # of opposite forces across the line of the two
    c.near("rotors: force on a pin, against that by the flow of two rotlets", abs(f[0, 1]), 1 / s**2 / between,
           0.02 / s**2 / between)
    c.below("rotors: they stay where they are pinned", np.abs(v[:2]).max(), 1e-6)


def plates(out, c):
    """Profile of the free spheres between the plates, and the stress on the plates"""
    edge, k = 2.0 * ACROSS, np.arange(ACROSS**2)
    flat = np.column_stack([2.0 * (k % ACROSS) + 1, 2.0 * (k // ACROSS) + 1, 0.0 * k])
    heights = np.array([2.5, 3.2, 4.0, 4.8, 5.5])
    free = np.column_stack([[2, 6, 5, 8, 3], [2, 4, 5, 8, 7], heights])
    rows = [(1, 2, p) for p in flat] + [(2, 2, p + (0, 0, HIGH / 2)) for p in flat] + [(3, 0.6, p) for p in free]
    text = "".join("{} {} {} 1 {:.15g} {:.15g} {:.15g}\n".format(i + 1, kind, size, *p)
                   for i, (kind, size, p) in enumerate(rows))
    (out / "plates.data").write_text(f"plates\n\n{len(rows)} atoms\n3 atom types\n0 {edge} xlo xhi\n0 {edge} ylo yhi\n"
                                     f"{-HIGH / 4} {3 * HIGH / 4} zlo zhi\n\nAtoms\n\n{text}")
    rows = run(out, "plates", "plates", plates=out / "plates.data")[-1]
    kind, v = rows[:, 1], rows[:, 5]
    v = v + 0.5                                                  # seen from the lower plate
    rate, start = np.polyfit(heights, v[kind == 3], 1)
    stress = [rows[kind == k, 8].sum() / (2 * edge**2) for k in (1, 2)]
    gap = 1 / rate
    print(f"  plates: rate of shear {rate:.5f}, gap {gap:.3f} of {HIGH / 2:.0f} between the centres, stress {stress}")
    c.near("plates: stress over viscosity times rate of shear of the free spheres", stress[0] / rate, 1, 0.01)
    c.below("plates: sum of the forces on both, over that on one", abs(sum(stress)) / abs(stress[0]), 1e-3)
    c.near("plates: in the middle half of the speed", v[kind == 3][2], 0.5, 1e-3)
    c.below("plates: free spheres from a straight line, over the speed",
            np.abs(v[kind == 3] - start - rate * heights).max(), 1e-3)
    return heights, v[kind == 3], start, rate


def draw(bug, a, profile, path):
    open_axes()
    figure, panels = plt.subplots(1, 2, figsize=(10, 4.6), layout="constrained", width_ratios=[1.15, 1])
    for k, shade in ((0, 0.25), (len(bug) // 2, 0.5), (len(bug) - 1, 1.0)):
        x = bug[k][:, 2:5]
        for i in np.argsort(-x[:, 1]):
            panels[0].add_patch(plt.Circle((x[i, 0], x[i, 2] - 5 * (k > 0) - 5 * (k == len(bug) - 1)), a[i],
                                           alpha=shade, fc="#d95f02" if i < 4 else "#1b9e77", ec="0.2", lw=0.5))
    every = np.array([frame[:, 2] for frame in bug])
    panels[0].set(xlim=(every.min() - 1.5, every.max() + 1.5), ylim=(-12.6, 2.6), yticks=[],
                  xlabel="x, in radii of the head's spheres", title="a bacterium swims: begin, middle, end of the run")
    panels[0].set_aspect("equal")
    z, v, start, rate = profile
    for height in (0, HIGH / 2):
        panels[1].axhspan(height - 1, height + 1, color="0.85")
    panels[1].plot([0, 1], (np.array([0, 1]) - start) / rate, "k-", lw=1, label="straight line")
    panels[1].plot(v, z, "o", color="C1", label="free spheres")
    panels[1].set(xlabel="velocity over that of the upper plate", ylabel="height",
                  title="between plates of held spheres")
    panels[1].legend(frameon=False)
    save(figure, path)


def main():
    given = options(__file__, __doc__, quick=False)
    need("lmp")
    c = Checks()
    bug, a = swim(given.out, c, given.quick)
    rotors(given.out, c)
    profile = plates(given.out, c)
    if not given.quick:
        draw(bug, a, profile, given.out / "swimmers.png")
        if given.update:
            shutil.copy(given.out / "swimmers.png", HERE)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
