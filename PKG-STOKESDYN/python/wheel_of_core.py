"""Makes the wheel that pip installs: stokesdyn.py and libstokesdyn.so, which CMake compiles from the core without LAMMPS.

These are the functions that pip calls (PEP 517). They need nothing but Python itself, so that pip works without a network."""
import base64
import hashlib
import os
import pathlib
import subprocess
import sysconfig
import tempfile
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
TOP = HERE.parents[1]
VERSION = (HERE.parent / "VERSION").read_text().strip()
TAG = "py3-none-" + sysconfig.get_platform().replace("-", "_").replace(".", "_")
INFO = f"stokesdyn-{VERSION}.dist-info"

METADATA = f"""Metadata-Version: 2.1
Name: stokesdyn
Version: {VERSION}
Summary: Hydrodynamic resistance of rigid clumps of spheres, from the core of PKG-STOKESDYN
License: GPL-2.0-only
Requires-Python: >=3.8
Requires-Dist: numpy
"""


def library(folder):
    """libstokesdyn.so, compiled in the folder; or that which STOKESDYN_LIBRARY names, where it is compiled already."""
    named = os.environ.get("STOKESDYN_LIBRARY")
    if named:
        return pathlib.Path(named).read_bytes()
    for command in (["cmake", "-S", TOP / "cmake", "-B", folder, "-D", "STOKESDYN_PLUGIN=OFF"],
                    ["cmake", "--build", folder, "--target", "stokesdyn_python", "-j", str(os.cpu_count() or 1)]):
        subprocess.run(command, check=True)
    return (pathlib.Path(folder) / "libstokesdyn.so").read_bytes()


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    with tempfile.TemporaryDirectory(prefix="stokesdyn") as folder:
        files = {"stokesdyn.py": (HERE / "stokesdyn.py").read_bytes(), "libstokesdyn.so": library(folder)}
    files[f"{INFO}/METADATA"] = METADATA.encode()
    files[f"{INFO}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: stokesdyn\nRoot-Is-Purelib: false\nTag: {TAG}\n".encode()
    files[f"{INFO}/LICENSE"] = (TOP / "LICENSE").read_bytes()
    record = ""
    for name, content in files.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest()).rstrip(b"=").decode()
        record += f"{name},sha256={digest},{len(content)}\n"
    files[f"{INFO}/RECORD"] = (record + f"{INFO}/RECORD,,\n").encode()
    name = f"stokesdyn-{VERSION}-{TAG}.whl"
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, content in files.items():
            wheel.writestr(path, content)
    return name
