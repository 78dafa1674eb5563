#!/usr/bin/env python3
"""Drag of cubic arrays of spheres with in.fixed_bed, one point per sphere and shells of points, beside exact values.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/fixed_bed)
    run.py --update     also refreshes the log and the picture in this folder

K is the drag of a sphere of the array over that of a lone one at the superficial velocity. Exact: Zick & Homsy, J.
Fluid Mech. 115, 13 (1982), simple cubic. Ends with a line ok or MISSED for each figure of the README, and exits with 1
when one is missed.
"""
import pathlib
import re
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, need, options  # noqa: E402

EXACT = {0.027: 2.008, 0.064: 2.810, 0.125: 4.292, 0.216: 7.442, 0.343: 15.4}
BASIS = {"simple": [(0, 0, 0)], "body-centred": [(0, 0, 0), (0.5, 0.5, 0.5)],
         "face-centred": [(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)]}
# 1/K = 1 - c phi^(1/3) + phi of the model with one point per sphere, as long as spheres do not overlap: Hasimoto's
# constants
HASIMOTO = {"simple": 1.7601189, "body-centred": 1.7918585, "face-centred": 1.7917472}
POINTS, MULTIBLOBS = (100, 400), (12, 42)
# of K with multiblobs
LIMITS = {0.027: 0.001, 0.064: 0.002, 0.125: 0.004, 0.216: 0.02, 0.343: 0.11}


def drag(out, name, x, a, L, box="p", ranks=1, points=1):
    """Total drag of the spheres x of radius a in a cube of side L; points: of each, multiblob"""
    data = out / f"{name}.data"
    rows = "".join(f"{i + 1} 1 {2 * a:.17g} 1 {p[0]:.17g} {p[1]:.17g} {p[2]:.17g}\n"
                   for i, p in enumerate((x % L if box == "p" else x).tolist()))
    lo = 0.0 if box == "p" else -L
    data.write_text(f"spheres\n\n{len(x)} atoms\n1 atom types\n\n" +
                    "".join(f"{lo:.17g} {L:.17g} {c}lo {c}hi\n" for c in "xyz") +
                    "\nAtoms\n\n" + rows)
    words = ["mpirun", "-np", str(ranks)] if ranks > 1 else []
    words += ["lmp", "-in", "in.fixed_bed", "-log", f"log.{name}.{ranks}", "-var", "data", data.name, "-var", "box",
              box, "-var", "points", str(points)]
    run = subprocess.run(words, cwd=out, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    found = re.findall("^drag (.*)$", run.stdout, re.M)
    if run.returncode or not found:
        sys.exit(run.stdout[-2000:] + f"fixed_bed: {' '.join(words)} failed in {out}")
    return float(found[-1])


def shell(n):
    """n points evenly on the unit sphere, a spiral of the golden angle, and half of their mean distance"""
    k = np.arange(n) + 0.5
    z, turn = 1 - 2 * k / n, np.pi * (3 - np.sqrt(5)) * k
    r = np.sqrt(1 - z**2)
    return np.stack([r * np.cos(turn), r * np.sin(turn), z], axis=1), float(0.5 * np.sqrt(4 * np.pi / n))


def main():
    given = options(__file__, __doc__)
    out = given.out
    need("lmp", "mpirun")
    shutil.copy(HERE / "in.fixed_bed", out)
    c = Checks()
    phis, K = sorted(EXACT), {}
    for lattice, basis in BASIS.items():
        K[lattice] = []
        for phi in phis:
            L = float((4 / 3 * np.pi * len(basis) / phi)**(1 / 3))
            K[lattice].append(drag(out, "point", L * (np.array(basis) + 0.25), 1.0, L) / len(basis))
            c.near(f"one point per sphere, {lattice}, phi {phi}: K", K[lattice][-1],
                   1 / (1 - HASIMOTO[lattice] * phi**(1 / 3) + phi), 1e-6 * K[lattice][-1])
    for points in MULTIBLOBS:
        name, K[f"multiblob {points}"] = f"multiblob {points}", []
        for phi in phis:
            L = float((4 / 3 * np.pi / phi)**(1 / 3))
            K[name].append(drag(out, "blob", np.full((1, 3), L / 2), 1.0, L, points=points))
            c.near(f"{name}, simple, phi {phi}: K beside Zick & Homsy", K[name][-1], EXACT[phi],
                   LIMITS[phi] * EXACT[phi])
    for n in POINTS:
        x, a = shell(n)
        alone = drag(out, "alone", x, a, 3.0, box="f")
        K[n] = []
        for phi in phis:
            L = float((4 / 3 * np.pi / phi)**(1 / 3)) * alone
            K[n].append(drag(out, "shell", x + 0.5 * L, a, L) / alone)
            if phi <= 0.216:
                c.near(f"shell of {n} points, simple, phi {phi}: K beside Zick & Homsy", K[n][-1], EXACT[phi],
                       (0.0015 if phi <= 0.125 else 0.007) * EXACT[phi])
    two = drag(out, "shell", x + 0.5 * L, a, L, ranks=2) / alone
    c.near(f"2 ranks: K at phi {phis[-1]}", two, K[POINTS[-1]][-1], 1e-6 * two)

    print("\n  phi    exact   point    " + "   ".join(f"{n} points" for n in POINTS) + "   multiblob 12   multiblob 42")
    for k, phi in enumerate(phis):
        print(f"  {phi:5}  {EXACT[phi]:6.3f}  {K['simple'][k]:6.3f}   " +
              "   ".join(f"{K[n][k]:10.4f}" for n in (*POINTS, "multiblob 12", "multiblob 42")))

    fig, ax = plt.subplots(figsize=(6.4, 4.0), dpi=90, layout="constrained")
    ax.plot(phis, [EXACT[p] for p in phis], "k-", lw=1, label="exact, simple cubic (Zick & Homsy 1982)")
    ax.plot(phis, K["simple"], "s--", color="C1", ms=5, label="one point per sphere")
    ax.plot(phis, K[POINTS[-1]], "o", color="C0", ms=6, label=f"shell of {POINTS[-1]} points")
    ax.plot(phis, K["multiblob 12"], "*", color="C2", ms=9, label="multiblob 12")
    ax.plot(phis, K["multiblob 42"], ".", color="C3", ms=7, label="multiblob 42")
    ax.set(xlabel="volume fraction", ylabel="K: drag over that of a lone sphere", yscale="log")
    ax.legend(fontsize="small")
    fig.savefig(out / "fixed_bed.png")
    if given.update:
        shutil.copy(out / "fixed_bed.png", HERE)
        for ranks in (1, 2):
            shutil.copy(out / f"log.shell.{ranks}", HERE / f"log.fixed_bed.{ranks}")
    sys.exit(c.finish())


if __name__ == "__main__":
    main()
