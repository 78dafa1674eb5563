#!/usr/bin/env python3
"""Diffusion of polymer chains of 10 to 200 beads with in.polymer, with and without hydrodynamic interactions.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/polymer)
    run.py --update     also refreshes the picture in this folder

Chains start in equilibrium, which is Gaussian whatever the fluid does, so that no time is lost on coming there. What
their centres do in a step is compared with
  Rouse      kT/(6 pi eta a N), beads that do not feel each other
  Kirkwood   kT tr M/3 of the mean over all pairs of beads, averaged over the chains: by this script from the same
             mobility
  Zimm       0.196 kT/(eta b sqrt N), the limit of long chains (Doi & Edwards, The Theory of Polymer Dynamics, 4.2)
Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent

sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, finished, need, open_axes, options, save, values  # noqa: E402

B = 4.0                         # rms length of a spring; radius of a bead, viscosity and kT are 1
BEADS = 6400                    # of a run, in as many chains as that makes
LENGTHS = {10: 30, 20: 40, 50: 60, 100: 100, 200: 120}    # beads of a chain: steps
ZIMM = 8 / (3 * np.sqrt(6 * np.pi**3))


def chains(n, count, rng):
    """Gaussian chains [count, n, 3], their centres at 0"""
    x = np.cumsum(rng.normal(0.0, B / np.sqrt(3), (count, n, 3)), axis=1)
    return x - x.mean(axis=1, keepdims=True)


def write(path, x):
    count, n = x.shape[:2]
    side = int(np.ceil(count**(1 / 3)))
    cell = 12 * B * np.sqrt(n)
    k = np.arange(count)
    x = x + cell * (np.column_stack([k % side, k // side % side, k // side**2]) + 0.5)[:, None]
    with open(path, "w") as out:
        out.write(f"chains\n\n{count * n} atoms\n{count * (n - 1)} bonds\n1 atom types\n1 bond types\n"
                  "2 extra bond per atom\n"
                  "6 extra special per atom\n" + "".join(f"{-cell} {cell * (side + 1)} {d}lo {d}hi\n" for d in "xyz") +
                  "\nAtoms\n\n")
        for i, (p, q, r) in enumerate(x.reshape(-1, 3)):
            out.write(f"{i + 1} 1 {p:.10f} {q:.10f} {r:.10f} 2 1 {i // n + 1}\n")
        out.write("\nBonds\n\n")
        bonds = [(c * n + i + 1, c * n + i + 2) for c in range(count) for i in range(n - 1)]
        out.write("".join(f"{j + 1} 1 {p} {q}\n" for j, (p, q) in enumerate(bonds)))


def kirkwood(x):
    """kT tr/3 of the mean of the pair mobilities, Rotne, Prager and Yamakawa's for beads of one radius"""
    n = x.shape[1]
    total = 0.0
    for chain in x:
        R = np.linalg.norm(chain[:, None] - chain[None], axis=2)[np.triu_indices(n, 1)]
        total += 2 * np.where(R > 2, 1 / np.maximum(R, 1e-9), 1 - R * 9 / 32 + R / 32).sum()
    return (n + total / len(x)) / n**2 / (6 * np.pi)


def centres(path):
    """[steps, chains, 3]"""
    frames, rows = [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if line.startswith("#"):
            continue
        if len(words) == 2:
            rows = []
            frames.append(rows)
        else:
            rows.append([float(w) for w in words[1:]])
    return np.array(frames)


def diffuse(out, n, interact, x):
    """Diffusivity of the centres and its deviation; dt"""
    name = f"{n}_{interact}"
    write(out / f"{name}.data", x)
    finished("polymer", ["lmp", "-in", "in.polymer", "-log", str(out / f"{name}.log")] + values(
        dict(chains=out / f"{name}.data", b=B, steps=LENGTHS[n], interact=interact, out=out / f"{name}.centres")), HERE)
    steps = np.diff(centres(out / f"{name}.centres"), axis=0)
    dt = 0.05 * 6 * np.pi * B**2 / 3
    return (steps**2).mean() / (2 * dt), np.sqrt(2 / steps.size)


def draw(rows, shown, path):
    open_axes()
    figure, (left, axis) = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
    left.plot(shown[:, 0], shown[:, 2], "-", color="0.7", lw=1)
    left.scatter(shown[:, 0], shown[:, 2], s=26, c=np.arange(len(shown)), cmap="viridis", zorder=2, edgecolors="black",
                 linewidths=0.3)
    left.set_aspect("equal")
    left.axis("off")
    left.set_title(f"a chain of {len(shown)} beads", fontsize=10)
    n = np.array([r["n"] for r in rows])
    line = np.geomspace(8, 260, 50)
    axis.loglog(n, [r["D"] for r in rows], "o", color="C0", ms=7, label="run, beads move each other")
    axis.loglog(n, [r["kirkwood"] for r in rows], "-", color="C0", lw=1.2, label="Kirkwood")
    axis.loglog(line, ZIMM / B / np.sqrt(line), "--", color="C0", lw=1, label=r"Zimm, 0.196 kT/($\eta$ b $\sqrt{N}$)")
    axis.loglog(n, [r["rouse"] for r in rows], "s", color="C3", ms=6, label="run, beads alone")
    axis.loglog(line, 1 / (6 * np.pi * line), "-", color="C3", lw=1, label=r"Rouse, kT/(6 $\pi\eta$ a N)")
    axis.set_xlabel("beads of a chain, N")
    axis.set_ylabel(r"diffusivity, kT/($\eta$ a)")
    axis.legend(fontsize=8.5)
    axis.grid(alpha=0.3, which="both", lw=0.4)
    save(figure, path)


def main():
    given = options(__file__, __doc__)
    need("lmp")
    began, rng, rows, shown = time.time(), np.random.default_rng(7), [], None
    for n in LENGTHS:
        x = chains(n, BEADS // n, rng)
        shown = x[0]
        D, deviation = diffuse(given.out, n, "yes", x)
        rouse, _ = diffuse(given.out, n, "no", x)
        rows.append(dict(n=n, D=D, rouse=rouse, deviation=deviation, kirkwood=kirkwood(chains(n, 4 * BEADS // n, rng))))
        r = rows[-1]
        print(f"  {n:4d} beads: D {D:.6f} +- {D * deviation:.6f}, Kirkwood {r['kirkwood']:.6f}, "
              f"Zimm {ZIMM / B / np.sqrt(n):.6f}; alone {rouse:.6f}, Rouse {1 / (6 * np.pi * n):.6f}", flush=True)
    draw(rows, shown, given.out / "polymer.png")
    if given.update:
        shutil.copy(given.out / "polymer.png", HERE)
    print(f"{2 * len(rows)} runs in {time.time() - began:.0f} s; picture: {given.out / 'polymer.png'}\n")

    c = Checks()
    for r in rows:
        c.near(f"{r['n']} beads: D over Kirkwood's", r["D"] / r["kirkwood"], 1.0, 4 * r["deviation"] + 0.02)
        c.near(f"{r['n']} beads alone: D over Rouse's", r["rouse"] * 6 * np.pi * r["n"], 1.0, 4 * r["deviation"])
    slope = np.polyfit(np.log([r["n"] for r in rows[-3:]]), np.log([r["D"] for r in rows[-3:]]), 1)[0]
    c.within("slope of D, 50 to 200 beads", slope, -0.62, -0.46)
    long = rows[-1]
    c.near("200 beads: D over Zimm's", long["D"] / (ZIMM / B / np.sqrt(200)), 1.0, 0.10)
    c.below("200 beads: D alone over D", long["rouse"] / long["D"], 0.12)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
