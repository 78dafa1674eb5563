"""What the tests of fix hydro/vans share: tables, scenes, and runs under mpirun."""
import csv
import os
import subprocess

import numpy as np
import pytest
from lammps import LMP_STYLE_ATOM, LMP_STYLE_GLOBAL, LMP_TYPE_ARRAY, LMP_TYPE_VECTOR, lammps

from host import PATIENCE, environment, lmp_program, mpirun

TABLES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "data", "vans")
ARRAY = ["z", "u", "phi", "vx", "vy", "vz", "drag", "b", "nut", "stress"]
VECTOR = ["fx", "fy", "fz", "transport", "friction_velocity", "largest_stress", "outside", "shields", "drag", "bed",
          "momentum", "transit", "driving", "bottom", "walls", "surface", "others", "discharge", "drive", "elevation",
          "volume", "mean_transport", "transport_error", "mean_stress", "stress_error", "wall_share", "pressed"]


def table(name):
    """Header and columns of a reference table."""
    header = {}
    with open(os.path.join(TABLES, name + ".csv")) as file:
        lines = [line.rstrip("\n") for line in file]
    for line in lines:
        if line.startswith("#") and "=" in line:
            key, value = line[1:].split("=", 1)
            header[key.strip()] = [float(word) for word in value.split()]
    body = [line for line in lines if not line.startswith("#")]
    reader = csv.reader(body)
    names = next(reader)
    rows = list(reader)
    columns = {}
    for c, column in enumerate(names):
        columns[column] = np.array([float(row[c]) for row in rows if c < len(row) and row[c] != ""])
    return header, columns


def difference(values, reference):
    """Largest difference relative to the largest entry of the reference."""
    reference = np.asarray(reference)
    return np.abs(np.asarray(values) - reference).max() / np.abs(reference).max()


def write_columns(path, *columns):
    np.savetxt(path, np.array(columns).T, fmt="%.17g")
    return str(path)


OPEN = []


@pytest.fixture(autouse=True)
def close_scenes():
    """A LAMMPS that a failed test leaves behind would keep the plugin from the next."""
    yield
    while OPEN:
        OPEN.pop().close()


class Scene:
    """A LAMMPS with the plugin, a box, and spheres where they are asked for."""

    @classmethod
    def of(cls, script):
        """The scene of a whole script."""
        scene = cls.__new__(cls)
        scene.lmp = lammps(cmdargs=["-log", "none", "-screen", "none"])
        OPEN.append(scene.lmp)
        scene.do(*[line for line in script.replace("&\n", "").split("\n") if line.strip()])
        return scene

    def __init__(self, box=(0, 0.02, 0, 0.02, -0.02, 0.15), boundary="p p f", comm=None, extra=(), style="sphere",
                 grid=None, units="si"):
        self.lmp = lammps(cmdargs=["-log", "none", "-screen", "none"], comm=comm)
        OPEN.append(self.lmp)
        self.do("plugin load stokesdynplugin.so", "units " + units, "atom_style " + style, "boundary " + boundary,
                "newton on", "atom_modify map array", "comm_modify vel yes", *(["processors " + grid] if grid else []),
                "region box block " + " ".join(str(b) for b in box), "create_box 1 box",
                "pair_style zero 0.01", "pair_coeff * *", "neighbor 0.001 bin", "timestep 1e-5",
                "mass 1 1" if style == "atomic" else "thermo 1000000", *extra)

    def do(self, *commands):
        for command in commands:
            self.lmp.command(command)

    def spheres(self, x, v, radius, density=2500.0):
        for i, (xi, vi) in enumerate(zip(x, v)):
            self.do("create_atoms 1 single %.17g %.17g %.17g units box" % tuple(xi))
        for i, vi in enumerate(v):
            self.do("set atom %d vx %.17g vy %.17g vz %.17g diameter %.17g density %.17g" %
                    (i + 1, *vi, 2 * np.broadcast_to(radius, len(x))[i], density))

    def column(self, name, rows, fix="h"):
        k = ARRAY.index(name) if isinstance(name, str) else name
        return np.array([self.lmp.extract_fix(fix, LMP_STYLE_GLOBAL, LMP_TYPE_ARRAY, n, k) for n in range(rows)])

    def number(self, name, fix="h"):
        return self.lmp.extract_fix(fix, LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR, VECTOR.index(name))

    def atoms(self, name):
        """A per-atom array in the order of the atom IDs; name: of an atom property, or a fix ID with f_."""
        n = int(self.lmp.get_natoms())
        order = np.argsort(self.lmp.numpy.extract_atom("id")[:n])
        if name.startswith("f_"):
            values = self.lmp.numpy.extract_fix(name[2:], LMP_STYLE_ATOM, LMP_TYPE_ARRAY)
        else:
            values = self.lmp.numpy.extract_atom(name)
        return np.array(values[:n])[order]

    def molecule(self, ids, value):
        """As the command set does, which takes no negative one since 2025"""
        rows = np.isin(self.lmp.numpy.extract_atom("id")[:int(self.lmp.get_natoms())], ids)
        self.lmp.numpy.extract_atom("molecule")[:len(rows)][rows] = value

    def close(self):
        OPEN.remove(self.lmp)
        self.lmp.close()


# A box without grains, for run_lmp
WATER_ALONE = """
plugin load stokesdynplugin.so
units si
region box block 0 1 0 1 0 1
create_box 1 box
mass 1 1
pair_style zero 0.1
pair_coeff * *
"""


def run_lmp(directory, script, ranks=1, name="in.test", variables=()):
    """Runs lmp on a script; its output. Fails the test with the end of the output if lmp fails."""
    path = os.path.join(str(directory), name)
    with open(path, "w") as file:
        file.write(script)
    flags = [word for key, value in variables for word in ("-var", key, str(value))]
    return subprocess.run(mpirun(ranks) + [lmp_program(), "-in", name, "-log", "none"] + flags, cwd=str(directory),
                          env=environment(), capture_output=True, text=True, timeout=PATIENCE)


def dump_rows(path):
    """The last snapshot of a custom dump, by atom ID."""
    with open(path) as file:
        lines = file.read().split("\n")
    start = max(k for k, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
    rows = np.array([[float(word) for word in line.split()] for line in lines[start + 1:] if line.strip()])
    return rows[np.argsort(rows[:, 0])]


BED = """
plugin load stokesdynplugin.so
units si
atom_style sphere
boundary p p f
newton on
comm_modify vel yes
atom_modify map array
{processors}
region box block 0 0.03 0 0.03 0 0.08
create_box 2 box
{lattice}
pair_style gran/hooke/history 20000 NULL 0 NULL 0.4 {damp}
pair_coeff * *
neighbor 0.0012 bin
timestep 1e-5
variable gx equal 0.4905+2*step*dt
variable dpdx equal -200-2e5*step*dt
fix gravity all gravity 9.81 vector 0.05 0 -0.99875
group bed type 1
group mobile type 2
fix vans {group} hydro/vans {every} {vans}
fix move mobile nve/sphere
"""


def bed_script(vans, every=20, group="mobile", layers=4, damp=0, processors="", seed=5, spread=None):
    """Fixed spheres on the bottom and layers of loose ones of two sizes above it, given a push; the stream as the
    keywords say. spread: each loose grain has a size of its own instead, smaller by up to this part."""
    rng = np.random.default_rng(seed)
    lines, atom = [], 0
    d = 0.006
    for layer in range(layers + 1):
        for i in range(4):
            for j in range(4):
                atom += 1
                x, y = (0.00375 + 0.0075 * i) % 0.03, (0.00375 + 0.0075 * j) % 0.03
                z = 0.0031 + 0.0066 * layer
                if layer:
                    x, y, z = np.array([x, y, z]) + rng.uniform(-0.0006, 0.0006, 3)
                diameter = d if layer == 0 or rng.random() < 0.5 else 0.8 * d
                if layer and spread is not None:
                    diameter = d * (1 - spread * rng.random())
                v = rng.uniform(-0.1, 0.1, 3) + [0.1 * layer, 0, 0] if layer else np.zeros(3)
                lines.append("create_atoms %d single %.17g %.17g %.17g units box" % (1 if layer == 0 else 2, x, y, z))
                lines.append("set atom %d diameter %.17g density 2500 vx %.17g vy %.17g vz %.17g" %
                             (atom, diameter, *v))
    return BED.format(vans=vans, every=every, group=group, lattice="\n".join(lines), damp=damp, processors=processors)
