#!/usr/bin/env python3
"""Runs the cells of two_lammps.ipynb one after the other, without jupyter, checks their figures and saves their
picture.

    run.py [--out FOLDER] [--update]     --update: also refreshes the picture in this folder
"""
import json
import pathlib
import shutil
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import runs  # noqa: E402
from checks import Checks  # noqa: E402


def main():
    options = runs.options(__file__, __doc__)

    names = {}
    cells = json.loads((HERE / "two_lammps.ipynb").read_text())["cells"]
    for k, cell in enumerate(cells):
        if cell["cell_type"] == "code":
            exec(compile("".join(cell["source"]), f"cell {k + 1}", "exec"), names)
    names["figure"].savefig(options.out / "notebook.png", dpi=100)
    if options.update:
        shutil.copy(options.out / "notebook.png", HERE)

    speed, stokes, drop = names["speed"], names["stokes"], names["drop"]
    checks = Checks()
    checks.near("speed of a sphere that feels itself only, over Stokes's", speed[0] / stokes, 1.0, 1e-9)
    checks.within("speed of the cloud, over that of a drop of so many spheres", speed[1] / drop, 0.9, 1.1)
    alone, together = names["fall"][-1] - names["fall"][0]
    checks.below("path of the lone spheres, over that of the cloud", alone / together, 0.4)
    checks.holds("the notebook holds no output", all(not cell.get("outputs") for cell in cells))
    checks.holds("each LAMMPS has its own atoms", names["alone"] is not names["together"])
    return checks.finish()


if __name__ == "__main__":
    sys.exit(main())
