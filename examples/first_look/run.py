#!/usr/bin/env python3
"""Four rigid bodies of touching spheres settle in a viscous fluid: from Python, without LAMMPS.

    run.py --out DIR    the picture goes to DIR (default: build/examples/first_look)
    run.py --update     also refreshes the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import csv
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent), str(HERE.parents[1] / "PKG-STOKESDYN" / "python")]
from checks import Checks  # noqa: E402
from runs import np, plt, options, save  # noqa: E402
import stokesdyn  # noqa: E402

# Units: radius of a sphere 1, its weight less buoyancy 1, 6 pi eta = 1: a lone sphere settles with speed 1.
VISCOSITY = 1 / (6 * np.pi)
BODIES = {
    "a sphere": [(0, 0, 0)],
    "three in a row": [(-2, 0, 0), (0, 0, 0), (2, 0, 0)],
    "an L": [(-2, 0, 0), (0, 0, 0), (2, 0, 0), (2, 0, 2)],
    "a tetrahedron": np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)]) / np.sqrt(2),
}
TIME, POSES = 9.0, 4


def rotation(v):
    """The rotation by the vector v, as a matrix (Rodrigues)."""
    angle = np.linalg.norm(v)
    if angle == 0.0:
        return np.eye(3)
    x, y, z = v / angle
    K = np.array([(0, -z, y), (z, 0, -x), (-y, x, 0)])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def fall(body, pose, steps=200):
    """Centres of the spheres at each step [steps + 1, n, 3]: the midpoint rule with the body's mobility."""
    body = np.asarray(body, float)
    clump = stokesdyn.Clump(body, radius=1, shell=42, viscosity=VISCOSITY)
    mass_centre, dt = body.mean(axis=0), TIME / steps
    arm = mass_centre - clump.centre
    down = np.array([0, 0, -len(body)])

    def motion(pose):
        force = pose.T @ down
        U, W = clump.velocity(force, np.cross(arm, force))
        return pose @ (U + np.cross(W, arm)), pose @ W

    where, frames = np.zeros(3), []
    for _ in range(steps + 1):
        frames.append(where + (body - mass_centre) @ pose.T)
        velocity, spin = motion(rotation(0.5 * dt * motion(pose)[1]) @ pose)
        where, pose = where + dt * velocity, rotation(dt * spin) @ pose
    return np.array(frames)


def picture(paths, path):
    figure, axes = plt.subplots(figsize=(6.6, 4.6), layout="constrained")
    for k, (name, frames) in enumerate(paths.items()):
        x0 = 9.0 * k
        axes.axhline(-TIME, color="0.6", ls=":", lw=1)
        axes.plot(x0 + frames[:, :, 0].mean(axis=1), frames[:, :, 2].mean(axis=1), "k-", lw=0.8)
        for pose in frames[np.linspace(0, len(frames) - 1, POSES).astype(int)]:
            for x, y, z in sorted(pose, key=lambda sphere: -sphere[1]):
                axes.add_patch(plt.Circle((x0 + x, z), 1, fc=f"C{k}", ec="k", lw=0.6, alpha=0.9))
        axes.text(x0, 4.2, name, ha="center")
    axes.text(31.5, -TIME, " without the\n fluid between\n the spheres\n all would be here", va="center",
              fontsize="small")
    axes.set(aspect="equal", xlim=(-4, 40), ylim=(-23, 6), ylabel="height / radius", xticks=[])
    for side in ("top", "right", "bottom"):
        axes.spines[side].set_visible(False)
    save(figure, path, dpi=90)


def exact_drag(name):
    """[3, 3] drag of a touching clump in exact Stokes flow, in units of 6 pi eta a."""
    text = (HERE.parent / "sedimentation" / "data" / "clusters_exact.csv").read_text().splitlines()
    row = next(row for row in csv.DictReader(line for line in text if not line.startswith("#")) if row["name"] == name)
    return np.array([[float(row[f"R{i}{j}"]) for j in (1, 2, 3)] for i in (1, 2, 3)]) / (6 * np.pi)


def main():
    given = options(__file__, __doc__)
    c = Checks()
    tilt = rotation(np.array([0, np.pi / 4, 0]))
    paths = {name: fall(body, tilt) for name, body in BODIES.items()}
    speeds = {name: (frames[0, :, 2].mean() - frames[-1, :, 2].mean()) / TIME for name, frames in paths.items()}
    print("\n  body              mean speed / that of a lone sphere")
    for name, speed in speeds.items():
        print(f"  {name:16}  {speed:.3f}")
    print()
    c.near("a sphere settles with Stokes' speed", speeds["a sphere"], 1.0, 1e-9)
    tetrahedron = 4 / (np.trace(exact_drag("tetrahedron")) / 3)
    c.near("a tetrahedron: speed against exact Stokes flow, %", 100 * (speeds["a tetrahedron"] / tetrahedron - 1), 0.0,
           0.2)
    row = paths["three in a row"].mean(axis=1)
    moved = row[-1] - row[0]
    along, across = (3 / drag for drag in (1.541386898, 1.839973583))    # exact, sedimentation/data/chains_exact.csv
    c.near("three in a row: speed against exact Stokes flow, %",
           100 * (-moved[2] / TIME / (0.5 * (along + across)) - 1), 0.0, 0.2)
    drift = np.degrees(np.arctan2(abs(moved[0]), -moved[2]))
    c.near("three in a row: drift to the side, degrees", drift,
           np.degrees(np.arctan((along - across) / (along + across))), 0.1)
    L = paths["an L"]
    c.holds("the L turns as it falls", abs(np.cross(L[0, 2] - L[0, 0], L[-1, 2] - L[-1, 0])[1]) > 1.0)
    picture(paths, given.out / "first_look.png")
    if given.update:
        shutil.copy(given.out / "first_look.png", HERE)
    sys.exit(c.finish())


if __name__ == "__main__":
    main()
