#!/usr/bin/env python3
"""A lone sphere in shear near a wall: force and torque of one that is held, velocity and spin of a free one, against
exact values.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/wall_shear)
    run.py --update     also refreshes the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from exact import along_wall, sphere_in_shear  # noqa: E402
from runs import np, plt, dumped, finished, need, open_axes, options, save  # noqa: E402

FILM = "lubrication yes lubrication_gap 1e-6"
MODELS = {"points": ("C3", "rotation", "rotation yes"),
          "film": ("C0", "rotation, lubrication", f"rotation yes {FILM}"),
          "shell": ("C2", "multiblob 12, lubrication", f"multiblob 12 {FILM}")}
WHAT = {"force": "force of the one at rest / (6 pi eta a rate h)", "torque": "its torque / (4 pi eta a^3 rate)",
        "speed": "speed of the free one / (rate h)", "spin": "its spin / (rate/2)"}


def lammps(out, model):
    """Gaps, and what WHAT says"""
    (out / f"{model}.table").unlink(missing_ok=True)
    finished("wall_shear", ["lmp", "-in", str(HERE / "in.wall_shear"), "-log", f"log.{model}", "-var", "model",
                            MODELS[model][2], "-var", "table", f"{model}.table"], out)
    rows = np.array([row for _, (row,) in dumped(out / f"{model}.table")])
    h, F, T = rows[::2, 1:4].T
    U, W = rows[1::2, 4:].T
    return {"gap": h - 1, "force": F / h, "torque": 1.5 * T, "speed": U / h, "spin": 2 * W}    # 4 pi eta a^3 = 2/3


def draw(runs, exact, path):
    open_axes()
    figure, axes = plt.subplots(1, 4, figsize=(13, 3.8), layout="constrained")
    for axis, (name, title) in zip(axes, WHAT.items()):
        axis.semilogx(exact["gap"], exact[name], "k-", lw=1, label="exact")
        for model, (colour, label, _) in MODELS.items():
            open_circle = model == "film"
            axis.semilogx(runs[model]["gap"], runs[model][name], color=colour, lw=0, marker="o",
                          ms=9 if open_circle else 4, mfc="none" if open_circle else None, label=label)
        axis.set(xlabel="gap / radius", title=title)
        axis.title.set_fontsize(10)
    axes[0].axhline(1.7005, color="0.7", lw=0.8)
    axes[0].text(0.012, 1.703, "contact: 1.7005 (O'Neill 1968)", color="0.5", fontsize=9, va="bottom")
    axes[3].legend(loc="lower right", fontsize=9)
    save(figure, path, 75)


def main():
    given = options(__file__, __doc__)
    out = given.out
    need("lmp")
    runs = {model: lammps(out, model) for model in MODELS}
    exact = sphere_in_shear()
    h = 1 + exact["gap"]
    U, W = along_wall(exact, exact["force"] * h, 0.5 * exact["torque"])
    exact.update(speed=U / h, spin=2 * W)
    draw(runs, exact, out / "wall_shear.png")
    known = {name: np.array([exact[name][np.argmin(abs(exact["gap"] - g))] for g in runs["film"]["gap"]])
             for name in WHAT}
    for k, gap in enumerate(runs["film"]["gap"]):
        print(f"  gap {gap:7.4f}: " + ";  ".join(f"{name} {known[name][k]:.4f}" +
                                                 "".join(f" {runs[m][name][k]:.4f}" for m in MODELS)
                                                  for name in WHAT))
    print(f"exact, then {', '.join(MODELS)}; picture: {out / 'wall_shear.png'}\n")
    c = Checks()
    for name in WHAT:
        c.below(f"rotation, lubrication: {name} off by", np.max(np.abs(runs["film"][name] - known[name])), 2e-5)
    for name in WHAT:
        c.below(f"multiblob 12, lubrication: {name} off by", np.max(np.abs(runs["shell"][name] - known[name])), 0.01)
    c.within("rotation alone: speed of the free one off by", np.max(np.abs(runs["points"]["speed"] - known["speed"])),
             0.45, 0.5)
    if given.update:
        shutil.copy(out / "wall_shear.png", HERE)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
