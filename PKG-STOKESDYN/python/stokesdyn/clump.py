"""Hydrodynamic resistance of a rigid clump of spheres, from libstokesdyn.so: the core of PKG-STOKESDYN without
LAMMPS."""
import ctypes
import numbers
import os
import pathlib

import numpy as np

__all__ = ["Clump", "Error", "read", "version"]


class Error(ValueError):
    """A bad argument, or a clump without an answer."""


class _Result(ctypes.Structure):
    """As in stokesdyn.c."""
    _fields_ = [("resistance", ctypes.c_double * 36), ("mobility", ctypes.c_double * 36),
                ("centre", ctypes.c_double * 3), ("radius", ctypes.c_double), ("dense", ctypes.c_double),
                ("iterative", ctypes.c_double), ("points", ctypes.c_int), ("iterations", ctypes.c_int)]


def _library():
    """libstokesdyn.so: that of STOKESDYN_LIBRARY, of the installation that this file is in, or on the library path."""
    here = pathlib.Path(__file__).resolve().parent
    named = os.environ.get("STOKESDYN_LIBRARY")
    beside = [path for path in (here / "libstokesdyn.so", here.parents[2] / "libstokesdyn.so") if path.exists()]
    library = ctypes.CDLL(named or str(beside[0] if beside else "libstokesdyn.so"))
    doubles = np.ctypeslib.ndpointer(np.float64, flags="C_CONTIGUOUS")
    library.stokesdyn_clump.argtypes = [ctypes.c_int, doubles, doubles, ctypes.c_int, ctypes.c_int, ctypes.c_double,
                                        ctypes.POINTER(_Result)]
    library.stokesdyn_status.restype = library.stokesdyn_version.restype = ctypes.c_char_p
    return library


_core = _library()
version = _core.stokesdyn_version().decode()
_STATUS = {_core.stokesdyn_status(code).decode(): code for code in range(16)}
_NO_MEMORY, _SINGULAR = _STATUS["out of memory"], _STATUS["the mobility matrix is singular"]


def _numbers(name, value, shape):
    """An array of finite numbers of this shape; "n" stands for any length."""
    try:
        array = np.array(value, dtype=np.float64, order="C")
    except (TypeError, ValueError):
        raise Error(f"{name} must be numbers, not {value!r}") from None
    if array.ndim != len(shape) or any(wanted not in ("n", got) for wanted, got in zip(shape, array.shape)):
        wanted, got = (", ".join(map(str, lengths)) for lengths in (shape, array.shape))
        raise Error(f"{name} must have the shape [{wanted}], not [{got}]")
    if not np.isfinite(array).all():
        raise Error(f"{name} must be finite: there is {array[~np.isfinite(array)][0]}")
    return array


def _within(name, values, least, most):
    """Resistances go like viscosity * length^3, and double numbers end at 1e308."""
    for number in np.ravel(values):
        if not least <= abs(number) <= most:
            raise Error(f"{name} must be {least:g} ... {most:g}, not {number:g}: use other units")


def _positive(name, value):
    number = float(_numbers(name, value, ()))
    if number <= 0.0:
        raise Error(f"{name} must be > 0, not {value!r}")
    return number


class Clump:
    """A rigid clump of spheres in a viscous fluid at rest far away.

    x           [n, 3] centres; spheres may touch, overlap, or lie inside each other
    radius      one for all, or [n]
    shell       points on each sphere: 42 is right to about 0.2 %; 12 and more, or 1: one point force
    rotation    shell 1 only: torques on the spheres take part
    viscosity   dynamic
    memory      bytes that the solve may use; a clump that needs more is solved iteratively, or refused

    Then there are, as numpy arrays about `centre`, where coupling is symmetric:
    resistance  [6, 6] force and torque (rows) that it takes to move with velocity and angular velocity (columns)
    mobility    [6, 6] its inverse; 0 for a motion that nothing resists (spin of a row of point forces)
    centre      [3] of hydrodynamic stress
    hydrodynamic_radius, points, iterations (0: dense)
    """

    def __init__(self, x, radius, shell=42, rotation=True, viscosity=1.0, memory=2e9):
        self.x = _numbers("x", x, ("n", 3))
        n = len(self.x)
        if n == 0:
            raise Error("x must have at least one sphere")
        self.radius = np.full(n, _numbers("radius", radius, ())) if np.ndim(radius) == 0 else _numbers(
            "radius", radius, (n,))
        if (self.radius <= 0.0).any():
            raise Error(f"radius must be > 0: there is {self.radius.min()}")
        _within("radius", self.radius, 1e-60, 1e60)
        _within("x", self.x, 0, 1e60)
        self.viscosity = _positive("viscosity", viscosity)
        _within("viscosity", self.viscosity, 1e-100, 1e100)
        if not isinstance(shell, numbers.Integral) or isinstance(shell,
                                                                 bool) or not (shell == 1 or 12 <= shell <= 100000):
            raise Error(f"shell must be 1 or a whole number from 12 on, not {shell!r}")
        if not isinstance(rotation, (bool, np.bool_)):
            raise Error(f"rotation must be True or False, not {rotation!r}")
        result = _Result()
        status = _core.stokesdyn_clump(n, self.x, self.radius, int(shell), int(rotation), _positive("memory", memory),
                                       ctypes.byref(result))
        if status == _NO_MEMORY:
            if result.iterative == 0.0:
                raise Error("out of memory: linear algebra (BLAS) needs 0.14 GB of address space at once; "
                            "is there a limit (ulimit -v)?")
            raise Error(f"memory {memory:g}: the solve needs {result.iterative:.3g} bytes, "
                        f"{result.dense:.3g} for a dense one")
        if status == _SINGULAR:
            raise Error("x: two spheres of equal radius lie at one point, or too nearly so")
        if status:
            raise Error(f"the clump has no answer: {_core.stokesdyn_status(status).decode()}")
        self.resistance = self.viscosity * np.array(result.resistance).reshape(6, 6)
        self.mobility = np.array(result.mobility).reshape(6, 6) / self.viscosity
        self.centre = np.array(result.centre)
        self.hydrodynamic_radius = result.radius
        self.points, self.iterations = result.points, result.iterations

    def velocity(self, force=(0.0, 0.0, 0.0), torque=(0.0, 0.0, 0.0)):
        """Velocity of the centre and angular velocity of the free clump under a force and a torque about the centre."""
        load = np.concatenate([_numbers("force", force, (3,)), _numbers("torque", torque, (3,))])
        motion = self.mobility @ load
        return motion[:3], motion[3:]


def read(path):
    """Centres [n, 3] and radii [n] of a LAMMPS molecule file (sections Coords and Diameters), or of lines "x y z
    radius"."""
    try:
        lines = [line.split("#")[0].replace(",", " ").split() for line in pathlib.Path(path).read_text().splitlines()]
    except OSError as why:
        raise Error(f"path {path}: {why.strerror}") from None
    try:
        section, rows = None, {"Coords": {}, "Diameters": {}}
        for line in lines[1:]:    # the first is a title
            if line and line[0][0].isalpha():
                section = line[0]
            elif line and section in rows:
                rows[section][int(line[0])] = [float(word) for word in line[1:]]
        coords, diameters = rows["Coords"], rows["Diameters"]
        if coords and coords.keys() == diameters.keys():
            return (np.array([coords[k] for k in sorted(coords)]),
                    0.5 * np.array([diameters[k][0] for k in sorted(coords)]))
        if coords or diameters:
            raise Error(f"path {path}: Coords and Diameters of all atoms are needed")
        table = np.array([[float(word) for word in line] for line in lines if line])
    except Error:
        raise
    except (ValueError, IndexError) as why:
        raise Error(f"path {path}: {why}") from None
    if table.ndim != 2 or table.shape[1] != 4:
        raise Error(f"path {path}: lines of x y z radius are needed")
    return table[:, :3], table[:, 3]
