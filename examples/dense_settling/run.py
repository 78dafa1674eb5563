#!/usr/bin/env python3
"""Clusters of 3 to 27 close spheres settle: with lubrication, without, with the usual sum over pairs, and exactly.

    run.py --out DIR    results and the picture go to DIR (default: build/examples/dense_settling)
    run.py --update     also refreshes the picture and the log in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, plt, finished, need, open_axes, options, read_table, save, values  # noqa: E402


KEYS = ("no", "sum", "yes", "12")


def clusters():
    """Places [n, 3] and exact velocities [n, 3] by name, in the order of the table"""
    found = {}
    for row in read_table(HERE / "exact.csv"):
        found.setdefault(row["cluster"], []).append([float(row[k]) for k in ("x", "y", "z", "Ux", "Uy", "Uz")])
    return {name: (np.array(rows)[:, :3], np.array(rows)[:, 3:]) for name, rows in found.items()}


def write_data(path, x):
    low, high = x.min() - 5, x.max() + 5
    lines = ["close spheres", "", f"{len(x)} atoms", "1 atom types", ""]
    lines += [f"{low} {high} {d}lo {d}hi" for d in "xyz"]
    lines += ["", "Atoms # sphere", ""]
    lines += [f"{i + 1} 1 2.0 1.0 {p[0]:.12g} {p[1]:.12g} {p[2]:.12g}" for i, p in enumerate(x)]
    path.write_text("\n".join(lines) + "\n")


def lammps(out, name, model):
    """Velocities [n, 3]; model: lubrication yes or no, or points of a multiblob"""
    tag, lubrication, points = f"{name}_{model}", "no" if model == "no" else "yes", 12 if model == "12" else 1
    command = ["lmp", "-in", str(HERE / "in.dense_settling"), "-log", f"log.{tag}"]
    finished("dense_settling", command + values(dict(path=f"{tag}.path", data=f"{name}.data", lubrication=lubrication,
                                                     points=points)), out)
    return np.loadtxt(out / f"{tag}.path", skiprows=9)[:, 1:4]


def draw(numbers, speeds, target):
    open_axes()
    figure, axes = plt.subplots(figsize=(8, 4.5), layout="constrained")
    axes.axhline(1, color="k", lw=1)
    for key, style, label in (("no", "v--C3", "model without lubrication"),
                              ("sum", "s--C1", "exact pairs added in full"), ("yes", "o-C0", "lubrication yes"),
                              ("12", "*-C2", "multiblob 12, lubrication yes")):
        axes.plot(numbers, speeds[key], style, label=label)
    axes.set(xlabel="spheres in the cluster, gaps of 0.01 to 0.02 radii", ylabel="speed of settling / exact",
             xticks=numbers, ylim=(0.5, 1.25), title="Each pair holds fluid that its neighbours hold as well")
    axes.legend()
    save(figure, target)


def main():
    given = options(__file__, __doc__)
    out = given.out
    need("lmp")
    usual = {row["cluster"]: row for row in read_table(HERE / "classical.csv")}
    numbers, speeds, errors = [], {key: [] for key in KEYS}, {key: [] for key in KEYS}
    for name, (x, exact) in clusters().items():
        write_data(out / f"{name}.data", x)
        numbers.append(len(x))
        for key in ("no", "yes", "12"):
            v = lammps(out, name, key)
            speeds[key].append(v[:, 2].mean() / exact[:, 2].mean())
            errors[key].append(np.linalg.norm(v - exact) / np.linalg.norm(exact))
        speeds["sum"].append(-float(usual[name]["speed"]) / exact[:, 2].mean())
        errors["sum"].append(float(usual[name]["error"]))
        print(f"  {len(x)} spheres: error {100 * errors['no'][-1]:.1f} % without, {100 * errors['sum'][-1]:.1f} % with "
              f"the usual sum, {100 * errors['yes'][-1]:.2f} % with lubrication, {100 * errors['12'][-1]:.2f} % "
              "with multiblob 12", flush=True)
    draw(numbers, speeds, out / "dense_settling.png")
    print(f"picture: {out / 'dense_settling.png'}\n")

    last = {key: 100 * value[-1] for key, value in errors.items()}
    c = Checks()
    c.below("lubrication yes: largest error of the velocities of a cluster, per cent", 100 * max(errors["yes"]), 1.2)
    c.below("its mean, per cent", 100 * np.mean(errors["yes"]), 0.7)
    c.below("multiblob 12: largest error of the velocities of a cluster, per cent", 100 * max(errors["12"]), 0.25)
    c.within("27 spheres without lubrication, per cent", last["no"], 16, 17)
    c.within("27 spheres with the usual sum, per cent", last["sum"], 39, 41)
    c.below("27 spheres with lubrication, per cent", last["yes"], 1.2)
    c.holds("the usual sum becomes worse with every further neighbour", np.all(np.diff(errors["sum"]) > 0))
    c.holds("from six spheres on it is worse than nothing",
            all(s > n for s, n in zip(errors["sum"][2:], errors["no"][2:])))
    if given.update:
        shutil.copy(out / "dense_settling.png", HERE)
        shutil.copy(out / "log.cube27_0.02_yes", HERE / "log.dense_settling.1")
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
