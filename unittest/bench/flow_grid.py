#!/usr/bin/env python3
"""What fluid_velocity grid costs a step of plain Stokes drag, beside a velocity that is a number:

    . build/env.sh; unittest/bench/flow_grid.py [--repeat 3] [--scenes "in contact" ...]

97336 spheres in a periodic box, one core. Free: pair style and fix nve/sphere, nothing else. In contact: a bed of
overlapping spheres that jostle, as in DEM: gran/hooke/history, lists that are made anew, communication. Processor time,
ns a sphere and step, the smallest of several runs of 50 steps, the fluids in turn. The flow is linear, so that the
look-up is exact: the largest difference of a force from that of the formula, in units of the largest force, stands
beside it."""
import argparse
import pathlib
import sys
import tempfile
import time

from from_tests import np
from system import Simulation, largest_difference

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples"))
import flow_grid  # noqa: E402

N, SPACING, ETA, STEPS = 46, 1.1, 1.3, 50
EDGE = N * SPACING
# slow: the bed is moved alike by all of them
SLOPE = 1e-3 * np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 0.5], [0.2, 0.0, 0.0]])

SCENE = f"""units lj
atom_style sphere
boundary p p p
comm_modify vel yes
plugin load stokesdynplugin.so
lattice sc {SPACING**-3:.17g}
region box block 0 {N} 0 {N} 0 {N}
create_box 1 box
create_atoms 1 box
set group all density 1.7
velocity all create 1.0 4711
timestep 5e-4
thermo 1000000
"""
DRAG = f"stokes_dynamics cut_off_distance 1e-6 algorithm 1 add_force yes visc {ETA}"
SCENES = {
    "free": "set group all diameter 1.0\npair_style {drag}\npair_coeff * *\n",
    "free, rotation yes": "set group all diameter 1.0\npair_style {drag} rotation yes\npair_coeff * *\n",
    "in contact": "set group all diameter 1.11\nneighbor 0.1 bin\nneigh_modify delay 0 every 1\n"
                  "pair_style hybrid/overlay gran/hooke/history 2000.0 NULL 50.0 NULL 0.5 1 {drag}\n"
                  "pair_coeff * * gran/hooke/history\npair_coeff * * stokes_dynamics\n",
}


def write_grid(path, n):
    at = np.linspace(0.0, EDGE, n)
    x = np.stack(np.meshgrid(at, at, at, indexing="ij")[::-1], axis=-1)
    flow_grid.write(path, [at, at, at], x @ SLOPE.T)
    return f"grid {path}"


def simulation(folder, scene, fluid):
    sim = Simulation(folder)
    return sim.commands(SCENE + SCENES[scene].format(drag=f"{DRAG} fluid_velocity {fluid}") +
                        "fix move all nve/sphere\n")


def error(folder, fluid):
    """Of the drag, against the formula."""
    sim = simulation(folder, "free", fluid)
    sim.run()
    drag = 6 * np.pi * ETA * 0.5 * (sim.x @ SLOPE.T - sim.v)
    worst = largest_difference(sim.f, drag)
    sim.close()
    return worst


def times(folder, scene, fluid):
    """ns a sphere and step, of several runs."""
    sim = simulation(folder, scene, fluid)
    sim.run(200, "post no")
    spent = []
    for _ in range(4):
        began = time.process_time()
        sim.run(STEPS, "post no" if "contact" in scene else "pre no post no")
        spent.append((time.process_time() - began) / STEPS / N**3 * 1e9)
    sim.close()
    return spent


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--repeat", type=int, default=3)
    arguments.add_argument("--scenes", nargs="+", choices=SCENES, default=list(SCENES))
    options = arguments.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        fluids = {"a number": "1e-3 5e-4 2e-4"}
        fluids.update((f"grid of {n}^3", write_grid(f"{folder}/{n}.grid", n)) for n in (33, 65, 129))
        print("| scene | fluid_velocity | ns a sphere and step | more than a number | of the step, % |"
              " error of the drag |")
        print("|---|---|---|---|---|---|")
        errors = {name: error(folder, words) for name, words in fluids.items() if name != "a number"}
        for scene in options.scenes:
            spent = {name: [] for name in fluids}
            for _ in range(options.repeat):
                for name, words in fluids.items():
                    spent[name] += times(folder, scene, words)
            number = min(spent["a number"])
            for name, all_ in spent.items():
                more = min(all_) - number
                rest = f"{more:.0f} | {100 * more / number:.0f} | {errors[name]:.0e}" if name in errors else "| |"
                print(f"| {scene} | {name} | {min(all_):.0f} | {rest} |", flush=True)


if __name__ == "__main__":
    main()
