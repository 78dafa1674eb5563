#!/usr/bin/env python3
"""The error of every model against exact Stokes flow, scene by scene, beside what the model costs.

    run.py --out DIR    tables and picture go to DIR (default: build/examples/accuracy)
    run.py --update     also refreshes the picture in this folder

The tables of PKG-STOKESDYN/doc/howto_accuracy.md are what this example wants to find: it ends with a line ok or MISSED
for each of their numbers, and exits with 1 when one is missed. A new model is a line of MODELS, and a column of these
tables.
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
from equilibrium import hard_spheres  # noqa: E402
from in_lammps import SHEARS, InLammps  # noqa: E402
from runs import np, plt, need, options, read_table, save  # noqa: E402
import scenes  # noqa: E402
import stokesdyn  # noqa: E402

FREE = {
    "two spheres settle": list(scenes.two_spheres_settle()),
    "two spheres pressed together": list(scenes.two_spheres_pressed()),
    "a triangle, gaps of 0.01": list(scenes.close_clusters("triangle_0.01")),
    "clusters near contact": list(scenes.close_clusters()),
    "two spheres in a strain": list(scenes.two_spheres_strained()),
    **{f"array, phi {phi}": list(scenes.arrays(phi)) for phi in (0.027, 0.064, 0.125, 0.216, 0.343, 0.45)},
    "one falls to a wall": list(scenes.one_at_a_wall(pushed=False)),
    "one slides along a wall": list(scenes.one_at_a_wall(pushed=True)),
    "groups fall to a wall": list(scenes.groups_at_a_wall("down")),
    "groups slide along a wall": list(scenes.groups_at_a_wall("along")),
    "groups at a wall, random forces": list(scenes.groups_at_a_wall("random")),
}    # suspensions are added in main()
PHIS, CONFIGURATIONS = (0.05, 0.1, 0.2, 0.3, 0.45), 4
CLUMPS = {"rigid clumps": list(scenes.rigid_clumps())}


class Model:
    """Keywords of the pair style, or the arguments of stokesdyn.Clump, and the scenes for which the model is meant.
    stresslets: its spheres resist strain. viscous: its suspensions are as viscous as real ones, by films if not by
    stresslets."""

    def __init__(self, name, keywords, where, stresslets=False, viscous=False):
        self.name, self.keywords, self.where, self.stresslets, self.viscous = (name, keywords, where, stresslets,
                                                                               viscous or stresslets)


MODELS = [
    Model("one point", "cut_off_distance inf", FREE),
    Model("rotation", "cut_off_distance inf rotation yes", FREE),
    Model("lubrication", "cut_off_distance inf rotation yes lubrication yes", FREE, viscous=True),
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
        shapes[key] = stokesdyn.Clump(case.x, 1, viscosity=1 / (6 * np.pi),
                                      **model.keywords), time.process_time() - began
    clump = shapes[key][0]
    arms = case.x - clump.centre
    U, W = clump.velocity(case.force.sum(axis=0), np.cross(arms, case.force).sum(axis=0))
    return U + np.cross(W, arms)


class Lammps(InLammps):
    """One LAMMPS in this process, which gets case after case."""

    def prepare(self, model, case):
        more = " wall zlo 0" if case.wall else "" if case.strain is None else " fluid_velocity v_ux v_uy v_uz"
        self.place(case.x, model.keywords + more, case.box, case.molecule, 1e-6 if len(case.x) < 100 else 1e-4)

    def velocities_of(self, model, case):
        if isinstance(model.keywords, dict):
            return clump_velocities(model, case)
        self.prepare(model, case)
        return self.velocities(case.force) if case.strain is None else self.carried(case.strain)

    def viscosity(self, model, places):
        """High-frequency viscosity: mean over sets of places and three directions of shear"""
        found = []
        for x, edge in places:
            self.place(x, model.keywords + " fluid_velocity box", edge, tolerance=1e-3)
            found += [1 - stress[3 + k] - stress[9 + k] for k, stress in enumerate(map(self.stress, SHEARS))]
        return np.mean(found)

    def step(self, model, case, steps=5):
        """Seconds of the processor for a step; for a clump, for the resistance of its shape."""
        if isinstance(model.keywords, dict):
            clump_velocities(model, case)
            return shapes[case.x.tobytes(), model.name][1]
        self.prepare(model, case)
        self.velocities(case.force)
        began = time.process_time()
        self.lmp.command(f"run {steps} pre no")
        return (time.process_time() - began) / steps


def missing_waves(model, name, case):
    """What is added to the speed of a suspension in a box, for one that has no end."""
    if not name.startswith("suspension"):
        return 0.0
    phi = float(name.split()[-1])
    return scenes.beyond_the_box(phi, len(case.x)) / (scenes.high_frequency_viscosity(phi) if model.viscous else 1.0)


def all_sets_over_few(phi):
    """Mean settling speed of all sets of places that hard_spheres has, over that of its first CONFIGURATIONS, both by
    multiblob 12. The long waves in places of a few hundred spheres differ from set to set by some per cent, but act
    alike on all models."""
    speed = [float(row["K"]) for row in read_table(HERE.parent / "hard_spheres" / "sets.csv")
             if row["model"] == "multiblob 12" and float(row["phi"]) == phi]
    return np.mean(speed) / np.mean(speed[:CONFIGURATIONS])


def beside_pystokes(lammps):
    """(scene, model): error in per cent, with its sign, where PyStokes's is known"""
    found = {}
    for row, case in scenes.of_pystokes():
        scene = f"{row['scene']}, {row['distance']}"
        found[scene, "PyStokes"], found[scene, "PyStokes, more modes"] = (100 * (float(row[key]) - 1)
                                                                          for key in ("pystokes", "more"))
        for model in MODELS:
            if model.where is FREE and model.name in ("lubrication", "multiblob 12"):
                found[scene, model.name] = 100 * (case.measure(lammps.velocities_of(model, case)) / case.exact - 1)
    return found


def wanted(table="scene"):
    """(scene, model): the number of the page, in per cent. table: what stands over the first column"""
    found, head = {}, None
    for line in PAGE.read_text().splitlines():
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if not line.startswith("|"):
            head = None
        elif head is None:
            head = cells if cells[0] == table else [""]
        elif head[0]:
            for model, cell in zip(head[1:], cells[1:]):
                if re.match(r"[-+]?[\d.]+ %$", cell):
                    found[cells[0], model.strip("`")] = float(cell[:-1])
    return found


def draw(errors, costs, path):
    shown = ["rigid clumps", "two spheres settle", "two spheres pressed together", "clusters near contact",
             "array, phi 0.125", "suspension, phi 0.1"]
    figure, axes = plt.subplots(2, 3, figsize=(11, 6.4), layout="constrained", sharey=True)
    for panel, scene in zip(axes.flat, shown):
        for model in MODELS:
            if scene in model.where:
                y = errors[scene, model.name]      # a triangle: the error is below the picture
                panel.loglog(1e3 * costs[model], max(y, 0.03), "o" if y > 0.03 else "v", ms=7, label=model.name)
        panel.legend(fontsize=7, loc="upper right")
        panel.axhspan(0.01, 1, color="C2", alpha=0.08)
        clumps = scene == "rigid clumps"
        panel.set(title=scene, ylim=(0.02, 9000), xlim=(0.1, 1e4) if clumps else (0.1, 100),
                  xlabel="ms once per shape (13 spheres)" if clumps else "ms per step (864 spheres)")
    for panel in axes[:, 0]:
        panel.set_ylabel("error of the velocities, %")
    save(figure, path)


def main():
    given = options(__file__, __doc__)
    need("lmp")
    lammps, errors, costs = Lammps(given.out), {}, {}
    for phi in PHIS:
        places = list(hard_spheres(500, phi, CONFIGURATIONS, seed=1 + int(100 * phi)))     # as in hard_spheres
        FREE[f"suspension, phi {phi}"] = list(scenes.suspension(phi, places))
        for model in MODELS:
            if model.stresslets:
                errors[f"viscosity, phi {phi}",
                       model.name] = 100 * (lammps.viscosity(model, places) / scenes.high_frequency_viscosity(phi) - 1)
    for model in MODELS:
        for scene, cases in model.where.items():
            answers = [(case, lammps.velocities_of(model, case)) for case in cases]
            # one number, with its sign: the mean of all configurations
            if scene.startswith(("array", "suspension")):
                mean = np.mean([case.measure(v) for case, v in answers])
                if scene.startswith("suspension"):
                    mean *= all_sets_over_few(float(scene.split()[-1]))
                errors[scene, model.name] = 100 * ((mean + missing_waves(model, scene, cases[0])) / cases[0].exact - 1)
            else:
                errors[scene, model.name] = 100 * max(case.error(v) for case, v in answers)
    x, edge = next(hard_spheres(864, 0.1, 1, seed=4711, melt=600))
    many = scenes.Case(x, scenes.downwards(len(x)), 1.0, scenes.mean_fall, box=edge)
    biggest = max(CLUMPS["rigid clumps"], key=lambda case: len(case.x))
    for model in MODELS:
        costs[model] = lammps.step(model, biggest if model.where is CLUMPS else many)

    for where in (CLUMPS, FREE):
        models = [model for model in MODELS if model.where is where]
        print("\n| scene | " + " | ".join(model.name for model in models) + " |")
        for scene in list(where) + ([f"viscosity, phi {phi}" for phi in PHIS] if where is FREE else []):
            print(f"| {scene} | " + " | ".join(f"{errors[scene, model.name]:.3g} %" if (scene, model.name) in errors
                                               else "none" for model in models) + " |")
        print(f"| {'ms once per shape' if where is CLUMPS else 'ms per step'} | " +
              " | ".join(f"{1e3 * costs[model]:.3g}" for model in models) + " |")
    print()
    draw({key: abs(value) for key, value in errors.items()}, costs, given.out / "accuracy.png")

    c, page = Checks(), wanted()
    c.holds("the page has a number for every scene and model", set(page) == set(errors))
    for key in sorted(set(page) & set(errors)):
        # places of a few hundred spheres scatter
        slack = 3 + 0.1 * page[key] if key[0].startswith(("suspension", "viscosity")) else 0.03 * page[key] + 0.006
        c.near(f"{key[0]}, {key[1]}: error, %", errors[key], page[key], slack)
    beside, page = beside_pystokes(lammps), wanted("beside PyStokes")
    c.holds("the page has a number for every scene that PyStokes has", set(page) == set(beside))
    for key in sorted(set(page) & set(beside)):
        c.near(f"{key[0]}, {key[1]}: error, %", beside[key], page[key], 0.012)
    if given.update:
        shutil.copy(given.out / "accuracy.png", HERE)
    sys.exit(c.finish())


if __name__ == "__main__":
    main()
