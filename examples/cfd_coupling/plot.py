"""Draws what coupling.py has left: tracks of the chains over the flow, and where the momentum went."""
import io

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.collections import CircleCollection
from PIL import Image

from coupling import EDGE, SAMPLE, SNAPSHOT, PrescribedFlow

CHAIN = 5


def draw_chains(ax, tracks, frames, colours):
    """Tracks of the centres, broken where they cross the periodic border, and the spheres at some times."""
    n = tracks.shape[1] // CHAIN
    centre = tracks.reshape(len(tracks), n, CHAIN, 3).mean(axis=2)
    for c in range(n):
        p = centre[:, c, :2] % EDGE
        broken = np.any(np.abs(np.diff(p, axis=0)) > EDGE / 2, axis=1)
        p = np.insert(p, np.flatnonzero(broken) + 1, np.nan, axis=0)
        ax.plot(p[:, 0], p[:, 1], color=colours[c], lw=1.0, zorder=2)
    unit = ax.transData.transform((1.0, 0.0))[0] - ax.transData.transform((0.0, 0.0))[0]
    area = np.pi * (unit * 72.0 / ax.figure.dpi) ** 2
    for f in frames:
        ax.add_collection(CircleCollection([area], offsets=tracks[f, :, :2] % EDGE, offset_transform=ax.transData,
                                           zorder=3, facecolors=np.repeat(colours, CHAIN, axis=0), edgecolors="black",
                                           linewidths=0.3))


def panel(ax, title):
    ax.set(xlim=(0, EDGE), ylim=(0, EDGE), aspect="equal", title=title, xlabel="x / a", ylabel="y / a")


def draw(folder, picture):
    """From folder/prescribed.npz and folder/two-way.npz."""
    given, mutual = np.load(folder / "prescribed.npz"), np.load(folder / "two-way.npz")
    fig, (left, middle, right) = plt.subplots(1, 3, figsize=(14, 4.4), dpi=110, layout="constrained")
    fig.get_layout_engine().set(wspace=0.04)
    panel(left, "prescribed: chains settle through vortices")
    panel(middle, "two-way: fluid and tracks at time 30")

    grid = np.linspace(0.0, EDGE, 65)
    x, y = np.meshgrid(grid, grid)
    flow = PrescribedFlow()
    points = np.stack((x.ravel(), y.ravel(), 0.0 * x.ravel()), axis=-1)
    u, eta = flow.velocity(points), flow.viscosity(points).reshape(x.shape)
    shade = left.contourf(x, y, eta * 6.0 * np.pi, levels=np.arange(0.7, 1.46, 0.05), cmap="Blues", vmax=2.0, zorder=0)
    fig.colorbar(shade, ax=left, label="viscosity / reference", shrink=0.8)
    thin = dict(color="0.45", linewidth=0.6, density=1.0, arrowsize=0.8, zorder=1)
    left.streamplot(x, y, u[:, 0].reshape(x.shape), u[:, 1].reshape(x.shape), **thin)

    u = mutual["u"]
    slab = np.concatenate((u, u[:1])).mean(axis=2)
    slab = np.concatenate((slab, slab[:, :1]), axis=1)
    nodes = np.linspace(0.0, EDGE, len(slab))
    shade = middle.contourf(nodes, nodes, slab[:, :, 0].T, levels=15, cmap="Oranges", zorder=0)
    fig.colorbar(shade, ax=middle, label="fluid velocity in x, mean over the depth", shrink=0.8)
    middle.streamplot(nodes, nodes, slab[:, :, 0].T, slab[:, :, 1].T, **thin)

    fig.canvas.draw()       # the axes have their final size from here on
    tracks = given["tracks"]
    draw_chains(left, tracks, range(0, len(tracks), 25),
                plt.cm.turbo(np.linspace(0.05, 0.95, tracks.shape[1] // CHAIN)))
    tracks = mutual["tracks"]
    first = tracks[: 1 + SNAPSHOT // SAMPLE]
    draw_chains(middle, first, (0, len(first) - 1), plt.cm.turbo(np.linspace(0.05, 0.95, tracks.shape[1] // CHAIN)))

    time, clumps, fluid, off = mutual["curve"][:,
                                               0], mutual["curve"][:, 1], mutual["curve"][:, 4], mutual["curve"][:, 7:]
    right.plot(time, clumps, label="chains", color="C0")
    right.plot(time, fluid, label="fluid", color="C1")
    right.plot(time, clumps + fluid, label="sum", color="k")
    right.set(title="two-way: momentum in x", xlabel="time", ylim=(0, 1.12 * clumps[0]), box_aspect=1.0)
    error = np.linalg.norm(off, axis=1).max() / clumps[0]
    right.text(time[-1], 1.02 * clumps[0], f"sum constant to {error:.0e} of itself", ha="right")
    right.legend(loc="lower right")
    whole = io.BytesIO()
    fig.savefig(whole)
    Image.open(whole).convert("RGB").quantize(colors=96).save(picture, optimize=True)      # a third of the size
