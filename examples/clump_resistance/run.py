#!/usr/bin/env python3
"""Runs clump_resistance on clumps whose drag is known and compares.

    run.py [--program FILE]     FILE: the program (default: clump_resistance.sh, which sets everything up when need be)

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed. The row of four
overlapping spheres has its values from the test-suite of PyGRPY (github.com/RadostW/PyGRPY), to the digits that it
prints; the touching pair and the cube of eight have theirs from exact Stokes flow.
"""
import argparse
import math
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402

STOKES = 6 * math.pi


class Clump:
    """What the program prints about a clump: radius, period and the rows of both matrices."""

    def __init__(self, program, file, *words, spheres=None):
        done = subprocess.run([program, str(file), *words], input=spheres, stdout=subprocess.PIPE, text=True)
        if done.returncode != 0:
            sys.exit(f"clump_resistance: {file} {' '.join(words)} failed")
        self.matrix = {}
        for line in done.stdout.splitlines():
            first, *rest = line.split()
            if first == "radius":
                self.radius = float(rest[0])
            elif first in ("resistance", "mobility"):
                rows = self.matrix[first] = []
            elif first == "in" and "period" in line:
                self.period = float(line.split("period")[1].split()[0])
                self.aspect = float(line.split("ratio")[1].split(",")[0])
            elif self.matrix and len(rows) < 6:
                rows.append([float(word) for word in line.split()])

    def across(self, name):
        return self.matrix[name][0][0]

    def along(self, name):
        return self.matrix[name][2][2]


def row_of_four(c, program):
    row = Clump(program, HERE / "row4.txt", "shell", "1")
    mobility = row.matrix["mobility"]
    for what, value, wanted, relative in (("hydrodynamic radius", row.radius, 1.5409546371938094, 1e-9),
                                          ("mobility across", mobility[0][0], 0.03225999460266797, 5e-8),
                                          ("mobility along", mobility[2][2], 0.03876335168633891, 5e-8),
                                          ("rotational mobility across", mobility[3][3], 0.006590020934028927, 5e-8),
                                          ("rotational mobility along", mobility[5][5], 0.017665748920274064, 5e-8)):
        c.near(f"row of four, shell 1: {what}", value, wanted, relative * wanted)


def touching_pair(c, program):
    for shell, drag, period in ((12, 0.006, 0.01), (42, 0.0035, 0.005), (162, 0.0015, 0.0025)):
        pair = Clump(program, "-", "shell", str(shell), spheres="0 0 0 1\n0 0 2 1\n")
        for what, value, wanted, relative in (("drag along", pair.along("resistance") / STOKES, 1.290283, drag),
                                              ("drag across", pair.across("resistance") / STOKES, 1.449322, drag),
                                              ("Jeffery period x shear rate", pair.period, 15.621755, period)):
            c.near(f"touching pair, shell {shell}: {what}", value, wanted, relative * wanted)


def cube(c, program):
    exact = 2.34182
    for words, error in ((("shell", "1", "rotation", "no"), -7.63), (("shell", "1"), -2.46), (("shell", "12"), -0.02),
                         (("shell", "42"), -0.12), (("shell", "162"), -0.04)):
        radius = Clump(program, HERE.parent / "sedimentation" / "clumps" / "cube8.mol", *words).radius
        c.near(f"cube of eight, {' '.join(words)}: radius against exact, %", 100 * (radius / exact - 1), error, 0.01)


def snowman(c, program):
    """The three spheres whose output the README shows."""
    clump = Clump(program, HERE / "snowman.mol")
    c.near("snowman: hydrodynamic radius", clump.radius, 1.464137095, 1e-7)
    c.near("snowman: drag across", clump.across("resistance"), 28.784862, 1e-5)
    c.near("snowman: drag along", clump.along("resistance"), 25.496384, 1e-5)
    c.near("snowman: effective aspect ratio", clump.aspect, 1.963008, 1e-5)
    c.near("snowman: Jeffery period x shear rate", clump.period, 15.53474, 1e-4)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(HERE / "clump_resistance.sh"))
    parser.add_argument("--out", help="as in the other examples; nothing is written here")
    program = parser.parse_args().program
    c = Checks()
    for part in (row_of_four, touching_pair, cube, snowman):
        part(c, program)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
