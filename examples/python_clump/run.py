#!/usr/bin/env python3
"""Runs clump.py, which is also the notebook clump.ipynb, checks its figures and draws its picture.

    run.py [--out FOLDER] [--update]     --update: also refreshes picture and notebook in this folder
"""
import json
import pathlib
import re
import sys

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import runs  # noqa: E402
from checks import Checks  # noqa: E402


def notebook():
    """The script's cells as a notebook without output."""
    cells = []
    for cell in re.split(r"^# %%", (HERE / "clump.py").read_text(), flags=re.M)[1:]:
        head, text = cell.split("\n", 1)
        if "markdown" in head:
            text = re.sub(r"^# ?", "", text, flags=re.M)
        lines = text.strip().replace("  # noqa: E402", "").splitlines(keepends=True)
        cells.append({"cell_type": "markdown", "metadata": {}, "source": lines} if "markdown" in head else
                     {"cell_type": "code", "metadata": {}, "source": lines, "outputs": [], "execution_count": None})
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return json.dumps({"cells": cells, "metadata": {"kernelspec": kernel}, "nbformat": 4, "nbformat_minor": 4},
                      indent=1) + "\n"


def main():
    options = runs.options(__file__, __doc__)

    cells = {}
    exec(compile((HERE / "clump.py").read_text(), "clump.py", "exec"), cells)
    (options.out / "clump.ipynb").write_text(notebook())
    cells["figure"].savefig(options.out / "clump.png", dpi=100)
    if options.update:
        for name in ("clump.ipynb", "clump.png"):
            (HERE / name).write_bytes((options.out / name).read_bytes())

    clump, path = cells["clump"], cells["path"]
    checks = Checks()
    checks.near("resistance is symmetric", np.abs(clump.resistance - clump.resistance.T).max(), 0.0, 1e-12)
    checks.near("mobility is the inverse of resistance", np.abs(clump.mobility @ clump.resistance - np.eye(6)).max(),
                0.0, 1e-12)
    coarse, _ = cells["settle"](cells["START"], cells["TIME"], 100)
    middle, _ = cells["settle"](cells["START"], cells["TIME"], 200)
    order = np.log2(np.abs(coarse[-1] - middle[-1]).max() / np.abs(middle[-1] - path[-1]).max())
    checks.near("order of the path in the time step", order, 2.0, 0.1)
    checks.below("core against LAMMPS, largest difference of the paths, radii", cells["difference"], 0.1)
    checks.holds("the notebook is the script", (HERE / "clump.ipynb").read_text() == notebook())
    return checks.finish()


if __name__ == "__main__":
    sys.exit(main())
