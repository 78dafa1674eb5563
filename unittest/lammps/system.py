"""LAMMPS systems from arrays of spheres: in this process through the python module, or by mpirun with a script.

A Simulation is a LAMMPS instance with the spheres and pair_style stokes_dynamics in it. The same input lines drive lmp
under mpirun, where the answer comes back as a dump sorted by atom ID."""
import ctypes
import os
import re
import subprocess

import numpy as np

from host import PATIENCE, environment, lmp_program, mpirun

DENSITY = 1.7
PLUGIN = "stokesdynplugin.so"


def there(path):
    """The path of a plugin that a build makes for tests alone. Of one that is not there LAMMPS says so much in passing,
    and ends with an error about the first command that needs it."""
    assert os.path.isfile(path), f"{path} is missing: build with cmake -D STOKESDYN_TESTS=ON"
    return path


# What the runs of a test said, for the table of hard cases (conftest.py): (kind, value), kind one of iterations,
# residual, error (of the forces) and says.
notes = []


def note(kind, value):
    # not numpy's numbers: pytest-xdist sends reports from process to process
    notes.append((kind, float(value) if isinstance(value, float) else value))


# Styles that the LAMMPS of the set-up lacks, by a plugin (styles_of_today.cpp)
STYLES_OF_TODAY = os.path.join(os.environ.get("LAMMPS_PLUGIN_PATH", ""), "wrong", "stylesoftoday.so")


class Spheres:
    """n spheres: x [n,3], radius a, velocity v and molecule ID (each one value or one a sphere), bonds as pairs of atom
    IDs."""

    def __init__(self, x, a=1.0, v=(0.0, 0.0, 0.0), molecule=0, bonds=()):
        self.x = np.atleast_2d(np.asarray(x, float))
        n = self.n = len(self.x)
        self.a = np.broadcast_to(np.asarray(a, float), (n,)).copy()
        self.v = np.broadcast_to(np.asarray(v, float), (n, 3)).copy()
        self.molecule = np.broadcast_to(np.asarray(molecule, int), (n,)).copy()
        self.bonds = [tuple(b) for b in bonds]

    def chain_bonds(self):
        """Bonds between successive spheres of each molecule."""
        self.bonds = [(i + 1, i + 2) for i in range(self.n - 1) if self.molecule[i] == self.molecule[i + 1] != 0]
        return self

    def open_box(self):
        margin = 4.0 * self.a.max() + 0.1 * np.ptp(self.x, axis=0).max()
        return [(lo - margin, hi + margin) for lo, hi in zip(self.x.min(axis=0), self.x.max(axis=0))]

    def write_data(self, path, box=None, tilt=None, density=DENSITY):
        """A data file for atom_style hybrid sphere bond."""
        bounds = box or self.open_box()
        lines = ["spheres", "", f"{self.n} atoms", f"{len(self.bonds)} bonds", "1 atom types", "1 bond types",
                 "8 extra bond per atom", "8 extra special per atom"]
        lines += [f"{lo!r} {hi!r} {c}lo {c}hi" for (lo, hi), c in zip(((float(l), float(h)) for l, h in bounds), "xyz")]
        if tilt:
            lines.append("{!r} {!r} {!r} xy xz yz".format(*tilt))
        lines += ["", "Atoms", ""]
        for i in range(self.n):
            x = " ".join(repr(float(c)) for c in self.x[i])
            lines.append(f"{i + 1} 1 {x} {float(2.0 * self.a[i])!r} {density!r} {self.molecule[i]}")
        lines += ["", "Velocities", ""]
        for i in range(self.n):
            lines.append(f"{i + 1} " + " ".join(repr(float(c)) for c in self.v[i]) + " 0 0 0")
        if self.bonds:
            lines += ["", "Bonds", ""] + [f"{k + 1} 1 {i} {j}" for k, (i, j) in enumerate(self.bonds)]
        with open(path, "w") as out:
            out.write("\n".join(lines) + "\n")
        return path


def chain(n, spacing=2.0, axis=2, a=1.0, v=(0.0, 0.0, 0.0), molecule=1):
    """A straight row of spheres; spacing in units of length."""
    x = np.zeros((n, 3))
    x[:, axis] = spacing * np.arange(n)
    return Spheres(x, a, v, molecule)


def input_lines(spheres, style, data, boundary="f f f", box=None, tilt=None, newton="on", comm="", before_pair="",
                fix=True, density=DENSITY, units="lj", dt=None):
    """Everything up to the run command. style: the words after pair_style stokes_dynamics, or a list of whole lines.
    A periodic boundary needs box: three (lo, hi)."""
    spheres.write_data(data, box, tilt, density)
    lines = [f"units {units}", "atom_style hybrid sphere bond", f"newton {newton}", f"boundary {boundary}",
             "comm_modify mode single", "atom_modify map array", f"plugin load {PLUGIN}", f"read_data {data}"]
    if spheres.bonds:
        lines += ["bond_style zero", "bond_coeff *"]
    lines += comm.splitlines() + before_pair.splitlines()
    lines += [f"pair_style stokes_dynamics {style}", "pair_coeff * *"] if isinstance(style, str) else list(style)
    if fix:
        lines.append("fix drag all stokes_dynamics")
    if dt:
        lines.append(f"timestep {float(dt)!r}")
    return lines


def quiet_arguments(log="none"):
    return ["-log", str(log), "-screen", "none", "-nocite"]


class LammpsError(Exception):
    """An error of LAMMPS with its whole text, in one line."""


class Simulation:
    """A LAMMPS of this process. Rows of all answers are in order of atom ID."""

    def __init__(self, folder, spheres=None, style=None, log="none", **options):
        from lammps import lammps
        self.folder = folder
        self.lmp = lammps(cmdargs=quiet_arguments(log))
        self.command("echo none")
        if spheres is not None:
            try:
                self.commands(input_lines(spheres, style, os.path.join(str(folder), "spheres.data"), **options))
            except Exception:
                self.close()
                raise

    def close(self):
        if self.lmp:
            self.lmp.close()
            self.lmp = None

    def commands(self, lines):
        for line in lines.splitlines() if isinstance(lines, str) else lines:
            if line.strip():
                self.command(line.strip())
        return self

    def command(self, line):
        """As command() of the python module, which in 2021 cuts error messages off after 100 characters."""
        lib, handle = self.lmp.lib, self.lmp.lmp
        lib.lammps_command(handle, line.encode())
        if lib.lammps_has_error(handle):
            text = ctypes.create_string_buffer(4000)
            lib.lammps_get_last_error_message(handle, text, len(text))
            message = " ".join(text.value.decode().split())
            note("says", message)
            raise LammpsError(message)

    def run(self, steps=0, options=""):
        self.command(f"run {steps} {options}")
        if self.lmp.has_id("fix", "drag"):
            values = self.fix_vector()
            note("iterations", int(values[3]))
            note("residual", values[4])
        return self

    # --- atoms
    @property
    def n(self):
        return self.lmp.extract_global("nlocal")

    def ids(self):
        return np.array(self.lmp.numpy.extract_atom("id")).ravel()[:self.n].copy()

    def raw(self, name):
        """The array of LAMMPS itself, in its own order: writing there changes the atoms."""
        return self.lmp.numpy.extract_atom(name)[:self.n]

    def atom(self, name):
        return np.array(self.raw(name))[np.argsort(self.ids())].copy()

    def set(self, name, atom_id, value):
        self.raw(name)[int(np.nonzero(self.ids() == atom_id)[0][0])] = value

    @property
    def x(self):
        return self.atom("x")

    @property
    def v(self):
        return self.atom("v")

    @property
    def f(self):
        return self.atom("f")

    # --- fix stokes_dynamics and compute pair
    def fix_rows(self, fix="drag"):
        rows = np.array(self.lmp.numpy.extract_fix(fix, 1, 2))[:self.n]
        return rows[np.argsort(self.ids())].copy()

    @property
    def drag(self):
        """F of every sphere [n,3]."""
        return self.fix_rows()[:, 0:3]

    @property
    def perturbation(self):
        """v' of every sphere [n,3]."""
        return self.fix_rows()[:, 3:6]

    def fix_scalar(self, fix="drag"):
        return self.lmp.extract_fix(fix, 0, 0)

    def fix_vector(self, fix="drag"):
        return np.array([self.lmp.extract_fix(fix, 0, 1, nrow=k) for k in range(9)])

    @property
    def iterations(self):
        return int(self.fix_vector()[3])

    @property
    def residual(self):
        return self.fix_vector()[4]

    @property
    def solves(self):
        return int(self.fix_vector()[5])

    def compute_vector(self, compute, n):
        pointer = self.lmp.extract_compute(compute, 0, 1)
        return np.array([pointer[k] for k in range(n)])


# --- lmp as a program of its own ---------------------------------------------------------------------------------

class Finished:
    def __init__(self, code, text, log):
        self.code, self.text, self.log = code, text, log


def lmp(folder, lines, ranks=1, timeout=PATIENCE, succeed=True):
    """Run lmp on the lines; text: all it printed. A run that does not end within the timeout fails the test."""
    script, log = os.path.join(str(folder), "in.test"), os.path.join(str(folder), "log.test")
    with open(script, "w") as out:
        out.write("\n".join(lines.splitlines() if isinstance(lines, str) else lines) + "\n")
    words = [lmp_program(), "-in", script, "-log", log, "-nocite"]
    if ranks > 1:
        # The ranks leave one after the other, and mpirun kills the rest when the first has failed: rank 0 perhaps
        # before its log is on disk. So the shell in between always succeeds and tells the exit code.
        words = mpirun(ranks) + ["sh", "-c", '"$@" || echo "exit code $?"', "sh"] + words
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, cwd=str(folder),
                               env=environment(), start_new_session=True)
    try:
        text = process.communicate(timeout=timeout)[0].decode(errors="replace")
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, 9)
        process.communicate()
        raise AssertionError(f"lmp on {ranks} ranks did not end within {timeout} s")
    code = process.returncode or int((re.findall("exit code ([0-9]+)", text) or [0])[0])
    if succeed:
        assert code == 0 and "ERROR" not in text, text[-3000:]
    with open(log) as f:
        finished = Finished(code, text, f.read())
    if not finished.log:      # rank 0 was ended by another one: pytest shows this where a test fails for it
        print(f"the log is empty; exit code {code}, printed: {text[-3000:]}")
    for line in finished.log.splitlines():
        if re.match("ERROR.*: Pair style", line):
            note("says", line)
    return finished


def lmp_in_turn(folder, inputs, ranks=1):
    """Several inputs (lists of lines) in one start of lmp, each after a `clear`: the log of each. mpirun takes as long
    to start as most scenes to run."""
    lines = []
    for k, one in enumerate(inputs):
        lines += ["clear"] * (k > 0) + [f'print "input {k} of several"'] + list(one)
    return re.split(r"^input \d+ of several$", lmp(folder, lines, ranks).log, flags=re.M)[1:]


def dump_lines(path, every=1, columns="x y z vx vy vz f_drag[1] f_drag[2] f_drag[3]", name="out"):
    return [f"dump {name} all custom {every} {path} id {columns}", f"dump_modify {name} sort id format float %.17g"]


def from_restart(lines, path="half.restart"):
    """An input that reads its atoms from a restart file, in place of its read_data"""
    cut = [k for k, line in enumerate(lines) if line.startswith("read_data")][0]
    return [line for line in lines[:cut] if "boundary" not in line] + [f"read_restart {path}"] + lines[cut + 1:]


def read_dump(path):
    """[(step, rows without the ID)] of a dump sorted by atom ID."""
    frames = []
    with open(path) as lines:
        for line in lines:
            if line.startswith("ITEM: TIMESTEP"):
                step = int(next(lines))
            elif line.startswith("ITEM: NUMBER"):
                n = int(next(lines))
            elif line.startswith("ITEM: ATOMS"):
                frames.append((step, np.array([[float(w) for w in next(lines).split()[1:]] for _ in range(n)])))
    return frames


def largest_difference(a, b):
    """Largest difference of two sets of vectors, in units of the largest length in the second."""
    a, b = np.asarray(a), np.asarray(b)
    scale = np.linalg.norm(b.reshape(-1, 3), axis=1).max()
    return np.abs(a - b).max() / scale
