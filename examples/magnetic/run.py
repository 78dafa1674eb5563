#!/usr/bin/env python3
"""Magnetic beads in a field that rotates: beads with a dipole of their own (in.ferro), pairs and a chain that the field
magnetises (in.para).

    run.py --out DIR     results and the picture go to DIR (default: build/examples/magnetic)
    run.py --quick       without the chain
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

DIPOLE, BEADS = 3.0, 12


def write(path, x, mu):
    """Data file of beads at x with dipoles along the axis x"""
    rows = "".join("{} 1 {:.17g} {:.17g} {:.17g} 2 1 0 {:.17g} 0 0 0\n".format(i + 1, *p, m)
                   for i, (p, m) in enumerate(zip(x, mu)))
    box = "".join(f"-60 60 {c}lo {c}hi\n" for c in "xyz")
    path.write_text(f"beads\n\n{len(x)} atoms\n1 atom types\n{box}\nMasses\n\n1 1\n\nAtoms\n\n{rows}")


def run(out, script, name, **variables):
    """Steps and rows [frames, beads, columns]"""
    finished("magnetic", ["lmp", "-in", f"in.{script}", "-log", str(out / f"{name}.log")] + values(
        dict(beads=out / f"{name}.data", out=out / f"{name}.rows", **variables)), HERE)
    steps, rows = zip(*dumped(out / f"{name}.rows"))
    return np.array(steps), np.array(rows)[:, :, 1:]


# --- dipoles of their own ---------------------------------------------------------------------------------------------

def rate_law(w, critical):
    """Mean angular velocity of a bead in a field of angular velocity w (Adler 1946)"""
    return np.where(w <= critical, w, w - np.sqrt(np.maximum(w**2 - critical**2, 0)))


def ferro(out, c):
    """Beads of unlike dipoles in one field: rates of the field over the critical rate of each, and mean rates of the
    beads over that"""
    dt, critical = 0.005, 1 / np.concatenate([np.linspace(0.2, 0.95, 6), np.linspace(1.05, 3, 12)])
    write(out / "ferro.data", [(4.0 * k - 50, 0, 0) for k in range(len(critical))], critical)
    steps, rows = run(out, "ferro", "ferro", dt=dt, steps=20000, every=10)
    t = dt * steps
    lag = t[:, None] - np.unwrap(np.arctan2(rows[:, :, 1], rows[:, :, 0]), axis=0)
    follows = critical > 1
    c.below("own dipoles: lag of beads that follow, from arcsin(w/w_c), rad",
            np.abs(lag[-1] - np.arcsin(np.minimum(1 / critical, 1)))[follows].max(), 1e-4)
    mean = np.ones(len(critical))
    for k in np.nonzero(~follows)[0]:
        turns = np.floor(lag[-1, k] / (2 * np.pi))           # whole turns by which the bead falls behind, and when
        at = [np.interp(2 * np.pi * n, lag[:, k], t) for n in (1, turns)]
        mean[k] = 1 - 2 * np.pi * (turns - 1) / (at[1] - at[0])
    law = rate_law(1.0, critical)
    c.below("own dipoles: mean rate of beads that slip, from w - sqrt(w^2 - w_c^2)", np.abs(mean - law)[~follows].max(),
            2e-4)
    return 1 / critical, mean / critical


# --- dipoles that the field makes -------------------------------------------------------------------------------------

def mobility_of_pair(r):
    """Velocity of each of two beads that opposite forces 1 across their line move, if they do not turn (Rotne & Prager
    1969)"""
    return 1 - 3 / (4 * r) * (1 + 2 / (3 * r**2)) - (3 / (4 * r**2))**2 / (3 / 4 - 3 / (8 * r**3))


def pairs(out, c):
    write(out / "pair.data", [(-1.05, 0, 0), (1.05, 0, 0)], [DIPOLE] * 2)
    found = []
    for w in (0.1, 0.3, 0.5):
        dt, n = 0.002, 10000
        steps, rows = run(out, "para", "pair", rate=w, dipole=DIPOLE, dt=dt, steps=n, every=n // 2)
        d = rows[-1, 1] - rows[-1, 0]
        r, lag = np.linalg.norm(d), np.mod(w * dt * n - np.arctan2(d[1], d[0]) + np.pi / 2, np.pi) - np.pi / 2
        law = 0.5 * np.arcsin(w * r / 2 / mobility_of_pair(r) * r**4 / (3 * DIPOLE**2))
        c.near(f"pair, rate {w}: lag behind the field, rad", lag, law, 2e-3 * law)
        found.append((w, lag, law))
    print(f"  pair: it follows up to the rate {6 * DIPOLE**2 / r**5 * mobility_of_pair(r):.3f}")
    return found


def angle_of(rows):
    """Of each frame: the angle of the line from the first bead to the last"""
    d = rows[:, -1] - rows[:, 0]
    return np.unwrap(np.arctan2(d[:, 1], d[:, 0]))


def chain(out, c):
    write(out / "chain.data", [(2.1 * (k - (BEADS - 1) / 2), 0.02 * np.sin(k), 0) for k in range(BEADS)],
          [DIPOLE] * BEADS)
    shown = {}
    for w in (0.02, 0.05, 0.3):
        n = int(1.25 * np.pi / w / 0.004) // 100 * 100
        steps, rows = run(out, "para", "chain", rate=w, dipole=DIPOLE, dt=0.004, steps=n, every=n // 100)
        gaps = np.linalg.norm(np.diff(rows[-1], axis=0), axis=1)
        shown[w] = rows[-1], w * 0.004 * n
        print(f"  chain of {BEADS}, rate {w}: it turned by {angle_of(rows)[-1]:.3f} of {w * 0.004 * n:.3f} rad, "
              f"largest distance of neighbours {gaps.max():.2f}", flush=True)
        if w == 0.02:
            c.below("chain, rate 0.02: distance of neighbours", gaps.max(), 2.2)
        if w == 0.3:
            c.within("chain, rate 0.3: it breaks, distance of neighbours", gaps.max(), 3, 1e3)
    return shown


def draw(rates, found, shown, path):
    plt.rcParams.update({"font.size": 10})
    figure, panels = plt.subplots(1, 4, figsize=(14, 3.9), layout="constrained", width_ratios=[1.5, 1, 1, 1])
    w = np.linspace(0, 3, 400)
    panels[0].plot(w, rate_law(w, 1.0), "k-", lw=1.2, label="closed form")
    panels[0].plot(*rates, "o", color="C1", label="run")
    panels[0].set(xlabel="angular velocity of the field, over the critical one",
                  ylabel="mean angular velocity of a bead",
                  title="beads with a dipole of their own")
    panels[0].legend(frameon=False)
    for panel, (w, (x, field)) in zip(panels[1:], shown.items()):
        for p in x:
            panel.add_patch(plt.Circle(p[:2], 1, fc="#7570b3", ec="0.2", lw=0.5))
        arrow = 11 * np.array([np.cos(field), np.sin(field)])
        panel.annotate("", arrow, -arrow, arrowprops=dict(arrowstyle="->", color="C3", lw=1.2), zorder=0)
        panel.set(xlim=(-14, 14), ylim=(-14, 14), xticks=[], yticks=[], title=f"paramagnetic chain, rate {w}")
        panel.set_aspect("equal")
    panels[1].text(-13, -13, "arrow: the field", color="C3")
    save(figure, path)


def main():
    given = options(__file__, __doc__, quick=False)
    need("lmp")
    c = Checks()
    rates = ferro(given.out, c)
    found = pairs(given.out, c)
    if not given.quick:
        draw(rates, found, chain(given.out, c), given.out / "magnetic.png")
        if given.update:
            shutil.copy(given.out / "magnetic.png", HERE)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
