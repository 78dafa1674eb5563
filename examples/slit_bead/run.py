#!/usr/bin/env python3
"""A bead in a slit between two walls (in.slit_bead): speed against height and width, beside Faxen's series and exact
values.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/slit_bead)
    run.py --update     also refreshes the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, dumped, finished, need, open_axes, options, save  # noqa: E402

# Of a sphere of radius 1 over that in open fluid: distance of the walls, height, across them, along them (free to
# turn). Computed by this project in another code, to the digits that are here.
EXACT = [(2.2, 1.1, 0.047549, 0.253454), (2.5, 1.25, 0.113121, 0.331195), (4, 2.0, 0.358527, 0.541784),
         (10, 2.5, 0.564226, 0.744783), (10, 5.0, 0.715889, 0.802444)]
WIDTHS = [2.2, 2.5, 3.0, 4.0, 6.0, 10.0, 20.0]
HEIGHTS = [1.02, 1.1, 1.5, 2.5, 5.0, 7.5, 8.5, 8.9, 8.98]       # where they are 10 apart


def faxen(H, quarter=False):
    """Speed along two walls at a distance H of a sphere of radius 1, in the middle, or at a quarter of it (Faxen
    1922)"""
    if quarter:
        s = 4 / H
        return 1 - 0.6526 * s + 0.1475 * s**3 - 0.131 * s**4 - 0.0644 * s**5
    s = 2 / H
    return 1 - 1.004 * s + 0.418 * s**3 + 0.21 * s**4 - 0.169 * s**5


def speeds(out, beads, **more):
    """{(H, z, d): speed along component d of the force, in units of that in open fluid} for beads (H, z, d); along the
    walls the mean of both flows, which differ from a lone bead by as much each way. In one start of LAMMPS."""
    runs = [(bead, flow) for bead in beads for flow in (("pressure", "flux") if bead[2] == 0 else ("pressure",))]
    names = ["H", "z", "L", "force", "flow", "out", *more]
    lines = []
    for k, ((H, z, d), flow) in enumerate(runs):
        force = " ".join("1" if axis == d else "0" for axis in range(3))
        of_this = [H, z, 6 * H + 12, f'"{force}"', flow, f"bead.{k}", *(f'"{words}"' for words in more.values())]
        if k:
            lines += ["clear"] + [f"variable {name} delete" for name in names]
        lines += [f"variable {name} index {value}" for name, value in zip(names, of_this)]
        lines += [f"include {HERE / 'in.slit_bead'}"]
    (out / "in.beads").write_text("\n".join(lines) + "\n")
    finished("slit_bead", ["lmp", "-in", "in.beads", "-log", "log.bead"], out)
    found = {}
    for k, (bead, _) in enumerate(runs):
        found.setdefault(bead, []).append(list(dumped(out / f"bead.{k}"))[-1][1][0, 1 + bead[2]])
    return {bead: np.mean(each) for bead, each in found.items()}


def draw(middle, heights, images, path):
    open_axes()
    figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.6), layout="constrained")
    H = np.linspace(2.6, 20, 200)
    left.plot(H, faxen(H), "k-", lw=1, label="along, Faxen's series")
    for d, name, colour in ((0, "along", "C0"), (2, "across", "C1")):
        left.plot(WIDTHS, middle[d], "o", color=colour, label=f"{name}, multiblob 12 with films")
        exact = [(row[0], row[3 if d == 0 else 2]) for row in EXACT if row[1] == row[0] / 2]
        left.plot(*np.transpose(exact), "kx", ms=9, label="exact" if d == 0 else None)
    left.plot(WIDTHS, images, "s", color="C3", mfc="none", label="across, one point")
    left.set(xscale="log", xlabel="distance of the walls / radius", ylabel="speed over that in open fluid", ylim=(0, 1),
             title="a bead in the middle of a slit")
    left.set_xticks(WIDTHS, [f"{w:g}" for w in WIDTHS])
    left.legend(frameon=False)
    z, along, across = np.transpose(heights)
    right.plot(along, z, "o-", color="C0", label="along")
    right.plot(across, z, "o-", color="C1", label="across")
    right.plot([row[3] for row in EXACT if row[0] == 10], [row[1] for row in EXACT if row[0] == 10], "kx", ms=9)
    right.plot([row[2] for row in EXACT if row[0] == 10], [row[1] for row in EXACT if row[0] == 10], "kx", ms=9,
               label="exact")
    right.plot([faxen(10), faxen(10, True), faxen(10, True)], [5, 2.5, 7.5], "k+", ms=11, label="Faxen's series")
    right.axhline(0, color="k", lw=2)
    right.axhline(10, color="k", lw=2)
    right.set(xlabel="speed over that in open fluid", ylabel="height / radius", xlim=(0, 1),
              title="walls 10 radii apart")
    right.legend(frameon=False, loc="center left")
    save(figure, path)


def main():
    given = options(__file__, __doc__)
    need("lmp")
    out, c = given.out, Checks()
    places = {(H, H / 2) for H in WIDTHS} | {(10.0, z) for z in HEIGHTS}
    speed = speeds(out, sorted((*place, d) for place in places for d in (0, 2)))
    points = speeds(out, [(H, H / 2, 2) for H in WIDTHS], model="algorithm 2")
    middle = {d: [speed[H, H / 2, d] for H in WIDTHS] for d in (0, 2)}
    images = [points[H, H / 2, 2] for H in WIDTHS]
    heights = [(z, speed[10.0, z, 0], speed[10.0, z, 2]) for z in HEIGHTS]
    draw(middle, heights, images, out / "slit_bead.png")
    print(f"picture: {out / 'slit_bead.png'}\n")
    at = {10: dict((row[0], row[1:]) for row in heights)}
    for H, z, across, along in EXACT:
        found = at[10][z] if H == 10 else (middle[0][WIDTHS.index(H)], middle[2][WIDTHS.index(H)])
        c.near(f"H = {H:g}, z = {z:g}: along, over exact", found[0] / along, 1.0, 0.005 if H > 2.5 else 0.036)
        c.near(f"H = {H:g}, z = {z:g}: across, over exact", found[1] / across, 1.0, 0.005 if H > 2.5 else 0.016)
    for H in (10, 20):
        c.near(f"H = {H}: in the middle, over Faxen's series", middle[0][WIDTHS.index(H)] / faxen(H), 1.0, 0.003)
    c.near("H = 10: at a quarter, over Faxen's series", at[10][2.5][0] / faxen(10, True), 1.0, 0.003)
    c.below("H = 10: as far from the upper wall as from the lower one: largest difference",
            max(abs(at[10][z][k] - at[10][10 - z][k]) for z in (1.1, 1.5, 2.5) for k in (0, 1)), 2e-3)
    c.within("H = 2.2: one point per sphere falls too fast across the walls, by", images[0] / EXACT[0][2], 2.0, 4.0)
    if given.update:
        shutil.copy(out / "slit_bead.png", HERE)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
