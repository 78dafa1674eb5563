#!/usr/bin/env python3
"""Laminar flow over a backward-facing step by OpenFOAM, and rigid chains and spheres in it: ./run.sh installs what this
needs and calls it. Writes to build/examples/openfoam_step; --update also refreshes the picture here."""
import os
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from runs import need, options, plt    # noqa: E402
from checks import Checks              # noqa: E402
import numpy as np                     # noqa: E402
import flow_grid                       # noqa: E402
import stokesdyn                       # noqa: E402

# Erturk 2008 (Computers & Fluids 37, 633), expansion 1:2, heights of the step; Re = mean velocity x twice the step / nu
REATTACHMENT = {100: 2.922, 400: 8.237}
RE, ETA = 100, 0.02        # of the particles' run: viscosity 2/Re
A, LENGTH = 0.005, 5       # radius of a chain's spheres, how many
SETTLING, TAU = 0.05, 0.02
COUNT = 600                # chains, and as many spheres
STEPS = 10000


# --- the flow ---------------------------------------------------------------------------------------------------------

def run(words, folder, log):
    with open(log, "a") as out:
        status = subprocess.run(words, cwd=folder, stdout=out, stderr=subprocess.STDOUT).returncode
    if status:
        sys.exit(f"{words[0]} failed, see {log}")


def solve(out, re, cells):
    """The steady flow on a mesh of `cells` to the step; the VTK file of its last iteration."""
    case = out / f"re{re}-{cells}"
    shutil.rmtree(case, ignore_errors=True)
    shutil.copytree(HERE / "case", case)
    for name, values in (("constant/transportProperties", {"NU": 2 / re}),
                         ("system/blockMeshDict", {"INLETX": 2 * cells, "CHANNELX": 8 * cells, "CELLS": cells})):
        text = (case / name).read_text()
        for word, value in values.items():
            text = text.replace(f" {word} ", f" {value} ").replace(f" {word};",
                                                                   f" {value};").replace(f"({word} ", f"({value} ")
        (case / name).write_text(text)
    for words in (["blockMesh"], ["simpleFoam"], ["foamToVTK", "-latestTime"]):
        run(words, case, case / "log")
    if "SIMPLE solution converged" not in (case / "log").read_text():
        sys.exit(f"simpleFoam has not converged, see {case}/log")
    return next(case.glob("VTK/*/internal.vtu"))


def reattachment(vtk, cells):
    """Where the wall shear changes sign: u at the centres of the first cells above the floor."""
    x = np.linspace(0.2, 25.0, 5000)
    u, _ = flow_grid.sample(flow_grid.read_vtk(str(vtk)), [x, np.array([-1.0 + 0.5 / cells]), np.array([0.05])], "U",
                            str(vtk))
    u = u[0, 0, :, 0]
    k = np.nonzero((u[:-1] < 0.0) & (u[1:] >= 0.0))[0][0]
    return x[k] - u[k] * (x[k + 1] - x[k]) / (u[k + 1] - u[k])


# --- the particles ----------------------------------------------------------------------------------------------------

def weights():
    """Force on a sphere of a chain and on a single one, so that both settle at one mean speed, and the radius of the
    single ones: that of a chain's volume."""
    chain = stokesdyn.Clump([(0, 0, 2 * A * k) for k in range(LENGTH)], radius=A, shell=42, viscosity=ETA)
    single = A * LENGTH**(1 / 3)
    return 6 * np.pi * ETA * chain.hydrodynamic_radius * SETTLING / LENGTH, 6 * np.pi * ETA * single * SETTLING, single


def write_spheres(path, single):
    """Chains in all directions, spread over the inlet just before the step; a sphere begins where each chain does."""
    rng = np.random.default_rng(1)
    # The time of a sphere to take the fluid's speed is tau; a chain of n needs longer, by its mass over its drag.
    density = 9 * ETA * TAU / (2 * A**2)
    lines = []
    centres = np.column_stack([np.full(COUNT, -0.2), *rng.uniform(0.1, 0.9, (2, COUNT))])
    for k, centre in enumerate(centres):
        axis = rng.normal(size=3)
        axis /= np.linalg.norm(axis)
        for m in range(LENGTH):
            x = centre + 2 * A * (m - (LENGTH - 1) / 2) * axis
            lines.append(f"{len(lines) + 1} 1 {x[0]:.9g} {x[1]:.9g} {x[2]:.9g} {2 * A} {density:.9g} {k + 1}")
    for x in centres:
        lines.append(f"{len(lines) + 1} 2 {x[0]:.9g} {x[1]:.9g} {x[2]:.9g} {2 * single:.9g} "
                     f"{9 * ETA * TAU / (2 * single**2):.9g} 0")
    path.write_text(f"chains and spheres\n\n{len(lines)} atoms\n2 atom types\n-4 80 xlo xhi\n-1.2 1.2 ylo yhi\n"
                    "0 1 zlo zhi\n\n"
                    "Atoms\n\n" + "\n".join(lines) + "\n")


def read_tracks(path):
    """Rows id mol type x y radius of all frames [frames, n, 6]."""
    frames = []
    with open(path) as lines:
        for line in lines:
            if line.startswith("ITEM: NUMBER"):
                n = int(next(lines))
            elif line.startswith("ITEM: ATOMS"):
                frames.append(np.loadtxt(lines, max_rows=n))
    return np.array(frames)


def streamfunction(axes, u):
    """psi [ny, nx] from the floor up, the step counted as floor; below 0 between floor and dividing streamline."""
    y = axes[1]
    return np.concatenate([np.zeros((1, u.shape[1])), np.cumsum(0.5 * (u[1:] + u[:-1]) * np.diff(y)[:, None], axis=0)])


def look_up(axes, field, x, y):
    """Bilinear"""
    i = np.clip(np.searchsorted(axes[0], x) - 1, 0, len(axes[0]) - 2)
    j = np.clip(np.searchsorted(axes[1], y) - 1, 0, len(axes[1]) - 2)
    p, q = (x - axes[0][i]) / (axes[0][i + 1] - axes[0][i]), (y - axes[1][j]) / (axes[1][j + 1] - axes[1][j])
    return ((1 - q) * ((1 - p) * field[j, i] + p * field[j, i + 1]) + q *
            ((1 - p) * field[j + 1, i] + p * field[j + 1, i + 1]))


class Fates:
    """Of each body: its track [frames, 2], where it first touches the floor (nan: it does not), its time in the bubble
    before."""

    def __init__(self, rows, per_body, axes, psi, dt, length):
        frames = rows.shape[0]
        rows = rows.reshape(frames, -1, per_body, 6)
        self.track = rows[..., 3:5].mean(axis=2)
        on_floor = (rows[..., 4] - rows[..., 5] < -1.0 + 0.1 * A).any(axis=2)
        first = np.where(on_floor.any(axis=0), on_floor.argmax(axis=0), frames)
        x, y = self.track[..., 0], self.track[..., 1]
        self.landed = np.array([x[f, k] if f < frames else np.nan for k, f in enumerate(first)])
        inside = (x > 0) & (x < length) & (look_up(axes, psi, x, y) < 0.0) & (np.arange(frames)[:, None] < first)
        self.residence = dt * inside.sum(axis=0)
        self.caught = self.landed < length
        self.share = self.caught.mean()
        # of a share of independent bodies
        self.share_error = np.sqrt(self.share * (1 - self.share) / len(first))


def draw(path, axes, u, psi, length, chains, spheres):
    fig, (flow, fate) = plt.subplots(2, 1, figsize=(10, 6), height_ratios=(1.3, 1))
    x, y = np.linspace(-1, 10, 331), np.linspace(-1, 1, 61)
    X, Y = np.meshgrid(x, y)
    field = [look_up(axes, u[..., d], X, Y) for d in (0, 1)]
    flow.streamplot(x, y, *field, density=(2.4, 0.9), color="0.75", linewidth=0.6, arrowsize=0.6)
    flow.contour(axes[0], axes[1], np.where((axes[0] > 0)[None, :], psi, np.nan), levels=[0.0], colors="k",
                 linewidths=1)
    for body, colour, name in ((chains, "tab:red", "chains"), (spheres, "tab:blue", "spheres")):
        some = list(np.nonzero(body.caught)[0][:6]) + list(np.nonzero(~body.caught)[0][:6])
        for n, k in enumerate(some):
            flow.plot(*body.track[:, k].T, color=colour, linewidth=0.8, label=name if n == 0 else None)
    flow.fill_between([-1, 0], -1, 0, color="0.4")
    flow.plot([length], [-1], "k^", clip_on=False)
    flow.set(xlim=(-1, 10), ylim=(-1, 1), ylabel="y / step",
             title=f"Re = {RE}: streamlines, the bubble's edge, some paths")
    flow.legend(loc="upper right")
    edges = np.linspace(0, 25, 51)
    for body, colour, name in ((chains, "tab:red", "chains"), (spheres, "tab:blue", "spheres")):
        fate.hist(body.landed, edges, color=colour, alpha=0.5, label=f"{name}: {100 * body.share:.1f} % caught")
    fate.axvline(length, color="k", linewidth=1)
    fate.set(xlabel="x / step where the floor is first touched", ylabel="bodies")
    fate.legend()
    fig.tight_layout()
    fig.savefig(path, dpi=110)


def main():
    given = options(__file__, __doc__, meshes="24 36")
    os.environ.setdefault("WM_PROJECT_DIR", "/usr/share/openfoam")
    need("lmp", "blockMesh", "simpleFoam", "foamToVTK")
    out, checks = given.out, Checks()
    lengths = {}
    for re in REATTACHMENT:
        for cells in map(int, given.meshes.split()):
            vtk = solve(out, re, cells)
            lengths[re, cells] = reattachment(vtk, cells)
            print(f"Re {re}, {cells} cells to the step: reattachment at {lengths[re, cells]:.4f}, "
                  f"published {REATTACHMENT[re]}", flush=True)
            if re == RE:
                flow_vtk = vtk
        checks.near(f"reattachment at Re {re}", lengths[re, cells], REATTACHMENT[re], 0.03 * REATTACHMENT[re])
    length = lengths[RE, cells]

    # x nodes half a cell apart; walls are nodes: y = -1, 0, 1
    box = [-3.999, 29.999, -1, 1, 0.05, 0.05]
    axes = [np.linspace(box[0], box[1], 1361), np.linspace(-1, 1, 97), np.array([0.05])]
    u, there = flow_grid.sample(flow_grid.read_vtk(str(flow_vtk)), axes, "U", str(flow_vtk))
    u[~there] = 0.0
    flow_grid.write(out / "flow.grid", axes, u, beyond={"x": "clamp", "y": "clamp"}, binary=True)
    u = u[0]
    psi = streamfunction(axes, u[..., 0])
    flux = psi[-1, axes[0] > -3.9]
    checks.below("flux through each cross section off 1, largest", np.abs(flux - 1).max(), 0.01)

    weight, weight_sphere, single = weights()
    write_spheres(out / "spheres.data", single)
    run(["lmp", "-in", str(HERE / "in.openfoam_step"), "-log", "log.openfoam_step", "-screen", "none", "-nocite",
         "-var", "data", "spheres.data", "-var", "flow", "flow.grid", "-var", "weight", repr(float(weight)), "-var",
         "weight_sphere", repr(float(weight_sphere)), "-var", "tau", str(TAU), "-var", "steps", str(STEPS)], out,
        out / "lmp.out")
    tracks = read_tracks(out / "tracks.dump")
    dt = 50 * TAU / 5
    chains = Fates(tracks[:, :COUNT * LENGTH], LENGTH, axes, psi, dt, length)
    spheres = Fates(tracks[:, COUNT * LENGTH:], 1, axes, psi, dt, length)

    for name, body in (("chains", chains), ("spheres", spheres)):
        landed = body.landed[np.isfinite(body.landed)]
        print(f"{name}: {100 * body.share:.1f} +- {100 * body.share_error:.1f} % caught in the recirculation, "
              f"residence there {body.residence[body.caught].mean():.2f}; on the floor {len(landed)}, "
              f"median at x = {np.median(landed):.2f}")
        checks.below(f"{name}: deepest centre below the floor, radii", (-1 - body.track[..., 1].min()) / A, 0.0)
        checks.within(f"{name}: share caught", body.share, 0.01, 0.6)
    checks.holds("chains lie along the flow and settle more slowly: fewer are caught", chains.share < spheres.share)
    draw(out / "openfoam_step.png", axes, u, psi, length, chains, spheres)
    if given.update:
        shutil.copy(out / "openfoam_step.png", HERE)
    return checks.finish()


if __name__ == "__main__":
    sys.exit(main())
