"""Memory that is not there ends a run with "out of memory" and the way out, on all ranks: no hang, no "terminate called"."""
import pathlib
import re
import subprocess

import numpy as np
import pytest

from system import Spheres, input_lines, lmp

SCARCE = pathlib.Path(__file__).resolve().with_name("scarce_memory.cpp")


@pytest.fixture
def scarce(tmp_path, monkeypatch):
    """scarce(MALLOC_LIMIT=bytes): what lmp is started with from now on"""
    library = tmp_path / "libscarce.so"
    subprocess.run(["c++", "-O1", "-fPIC", "-shared", "-o", library, SCARCE], check=True)

    def limit(**limits):
        monkeypatch.setenv("LD_PRELOAD", str(library))
        for name, value in limits.items():
            monkeypatch.setenv(name, str(value))
    return limit


@pytest.mark.parametrize("ranks", [2])
def test_blas_that_finds_no_room_says_so(tmp_path, scarce, ranks):
    """OpenBLAS would try for ever to map its 134 MB."""
    lines = input_lines(Spheres([(0, 0, 0), (0, 0, 2)], molecule=1), "clumps_only yes visc 1 rigid_clumps yes shell 12", str(tmp_path / "data"),
                        comm="comm_modify cutoff 9")
    scarce(MALLOC_LIMIT=130000000)
    run = lmp(tmp_path, lines + ["run 0"], ranks, timeout=20, succeed=False)
    assert run.code != 0 and "Pair style stokes_dynamics: out of memory: linear algebra (BLAS) needs 0.14 GB of address space" in run.text


STYLES = {"pair": ("fluid_velocity v_u 0 0", ["fix drag all stokes_dynamics"], "(Pair style|Fix) stokes_dynamics: out of memory on this rank"),
          "fix": ("", ["fix move all stokes_dynamics/overdamped"], "(?i)stokes_dynamics.*: out of memory on this rank")}


@pytest.mark.parametrize("style, ranks", [("pair", 2), ("fix", 1)])
def test_memory_of_cpp_that_is_not_there_is_told(tmp_path, scarce, style, ranks):
    words, fixes, message = STYLES[style]
    x = 3.0 * np.stack(np.meshgrid(*3 * [np.arange(32)]), axis=-1).reshape(-1, 3)
    lines = input_lines(Spheres(x), f"cut_off_distance 4 taper wendland visc 1 {words}", str(tmp_path / "data"), fix=False,
                        before_pair="variable u atom 0.1*z")
    scarce(NEW_LIMIT=300000)
    run = lmp(tmp_path, lines + fixes + ["run 0"], ranks, timeout=20, succeed=False)
    assert run.code != 0 and re.search(message, run.text), run.text[-1500:]
    assert "terminate called" not in run.text and "more ranks" in run.text


@pytest.mark.parametrize("scarce_rank", [0, 1])
def test_one_rank_without_memory_for_a_shape_ends_all(tmp_path, scarce, scarce_rank):
    """Every rank keeps every shape: one that cannot must not leave the other waiting for it."""
    x = np.random.default_rng(3).uniform(0, 100, (20000, 3))
    lines = input_lines(Spheres(x, molecule=1), "clumps_only yes visc 1 rigid_clumps yes", str(tmp_path / "data"), fix=False)
    scarce(MALLOC_LIMIT=480000, MALLOC_MOST=480000, SCARCE_RANK=scarce_rank)    # three numbers for each sphere of a shape
    run = lmp(tmp_path, lines + ["run 0"], 2, timeout=20, succeed=False)
    assert run.code != 0 and "Pair style stokes_dynamics: keyword rigid_clumps: out of memory" in run.text, run.text[-1500:]
