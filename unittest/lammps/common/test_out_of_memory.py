"""Memory that is not there ends a run with "out of memory" and the way out, on all ranks: no hang, no "terminate
called"."""
import pathlib
import re
import subprocess

import numpy as np
import pytest

from system import Spheres, input_lines, lmp

SCARCE = pathlib.Path(__file__).resolve().parents[1] / "scarce_memory.cpp"


@pytest.fixture(scope="module")
def scarce_memory(tmp_path_factory):
    library = tmp_path_factory.mktemp("scarce") / "libscarce.so"
    subprocess.run(["c++", "-O1", "-fPIC", "-shared", "-o", library, SCARCE], check=True)
    return str(library)


@pytest.fixture
def scarce(scarce_memory, monkeypatch):
    """scarce(MALLOC_LIMIT=bytes): what lmp is started with from now on"""
    def limit(**limits):
        monkeypatch.setenv("LD_PRELOAD", scarce_memory)
        for name, value in limits.items():
            monkeypatch.setenv(name, str(value))
    return limit


@pytest.mark.parametrize("ranks", [2])
def test_blas_that_finds_no_room_says_so(tmp_path, scarce, ranks):
    """OpenBLAS would try for ever to map its 134 MB."""
    lines = input_lines(Spheres([(0, 0, 0), (0, 0, 2)], molecule=1), "clumps_only yes visc 1 rigid_clumps yes shell 12",
                        str(tmp_path / "data"), comm="comm_modify cutoff 9")
    scarce(MALLOC_LIMIT=130000000)
    run = lmp(tmp_path, lines + ["run 0"], ranks, succeed=False)
    assert (run.code != 0 and "Pair style stokes_dynamics: out of memory: linear algebra (BLAS) needs 0.14 GB "
                              "of address space" in run.text)


STYLES = {"pair": ("fluid_velocity v_u 0 0", ["fix drag all stokes_dynamics"],
                   "(Pair style|Fix) stokes_dynamics: out of memory on this rank"),
          "fix": ("", ["fix move all stokes_dynamics/overdamped"], "(?i)stokes_dynamics.*: out of memory on this rank")}


@pytest.mark.parametrize("style, ranks", [("pair", 2), ("fix", 1)])
def test_memory_of_cpp_that_is_not_there_is_told(tmp_path, scarce, style, ranks):
    words, fixes, message = STYLES[style]
    x = 3.0 * np.stack(np.meshgrid(*3 * [np.arange(32)]), axis=-1).reshape(-1, 3)
    lines = input_lines(Spheres(x), f"cut_off_distance 4 taper wendland visc 1 {words}", str(tmp_path / "data"),
                        fix=False, before_pair="variable u atom 0.1*z")
    scarce(NEW_LIMIT=300000)
    run = lmp(tmp_path, lines + fixes + ["run 0"], ranks, succeed=False)
    assert run.code != 0 and re.search(message, run.text), run.text[-1500:]
    assert "terminate called" not in run.text and "more ranks" in run.text


@pytest.mark.ranks(2)
@pytest.mark.parametrize("scarce_rank", [0, 1])
def test_one_rank_without_memory_for_a_shape_ends_all(tmp_path, scarce, scarce_rank):
    """Every rank keeps every shape: one that cannot must not leave the other waiting for it."""
    x = np.random.default_rng(3).uniform(0, 100, (20000, 3))
    lines = input_lines(Spheres(x, molecule=1), "clumps_only yes visc 1 rigid_clumps yes", str(tmp_path / "data"),
                        fix=False)
    # three numbers for each sphere of a shape
    scarce(MALLOC_LIMIT=480000, MALLOC_MOST=480000, SCARCE_RANK=scarce_rank)
    run = lmp(tmp_path, lines + ["run 0"], ranks=2, succeed=False)
    told = "Pair style stokes_dynamics: keyword rigid_clumps: out of memory"
    assert run.code != 0 and told in run.text, run.text[-1500:]


# Cells of SPH particles that are alone: no list of pairs is as long as what a compute asks for.
ALONE = """units lj
atom_style sph
atom_modify map array
boundary f f f
plugin load stokesdynplugin.so
lattice sc 1.0
region box block -0.5 {n}.5 -0.5 {n}.5 -0.5 {n}.5
create_box 1 box
create_atoms 1 box
mass * 1.0
set group all sph/rho 1.0
pair_style sph/artVisc/tensCorr wendland 0.3
pair_coeff * *
neighbor 0.1 bin
fix density all sph/density/summation
fix move all nve/sph
""".splitlines()


def test_a_compute_without_memory_tells_it(tmp_path, scarce):
    """Six numbers for each particle are more than any array before."""
    lines = [line.format(n=19) for line in ALONE] + ["fix eos all sph/pressure Tait 14.3 1 7",
                                                     "compute s all sph/surface/atom", "run 0",
                                                     "compute most all reduce max c_s[1]",
                                                     "thermo_style custom step c_most", "run 0"]
    scarce(NEW_LIMIT=40 * 20**3)
    run = lmp(tmp_path, lines, succeed=False)
    assert run.code != 0 and "Compute sph/surface/atom: out of memory on this rank" in run.text, run.text[-1500:]
    assert "terminate called" not in run.text


@pytest.mark.ranks(2)
@pytest.mark.parametrize("scarce_rank", [0, 1])
def test_one_rank_without_memory_for_a_fix_ends_all(tmp_path, scarce, scarce_rank):
    """The constructor fails in its first rows, before LAMMPS has been told of them."""
    # a number for each atom that LAMMPS has room for
    scarce(CALLOC_LIMIT=8 * 16385, CALLOC_MOST=8 * 16385, SCARCE_RANK=scarce_rank)
    lines = [line.format(n=3) for line in ALONE] + ["fix eos all sph/pressure Tait 14.3 1 7", "run 0"]
    run = lmp(tmp_path, lines, ranks=2, succeed=False)
    assert run.code != 0 and "Fix sph/pressure: out of memory on this rank" in run.text, run.text[-1500:]
    assert "terminate called" not in run.text


@pytest.mark.ranks(2)
@pytest.mark.parametrize("scarce_rank", [0, 1])
def test_one_rank_without_memory_for_a_stream_ends_all(tmp_path, scarce, scarce_rank):
    slices = 20000
    scarce(CALLOC_LIMIT=18 * 8 * slices, CALLOC_MOST=18 * 8 * (slices + 2), SCARCE_RANK=scarce_rank)
    lines = ["units si", "atom_style sphere", "plugin load stokesdynplugin.so", "region box block 0 1 0 1 0 1",
             "create_box 1 box", f"fix h all hydro/vans 1 mesh {slices} 1e-4 0 fluid 1000 0.001 gravity 0.5 0 -9.8"]
    run = lmp(tmp_path, lines, ranks=2, succeed=False)
    assert run.code != 0 and f"Fix hydro/vans: out of memory for {slices} slices" in run.text, run.text[-1500:]


@pytest.mark.ranks(2)
@pytest.mark.parametrize("scarce_rank", [0, 1])
def test_one_rank_without_memory_for_a_shell_ends_all(tmp_path, scarce, scarce_rank):
    """Every rank makes the shell of a sphere for itself."""
    lines = input_lines(Spheres([(0, 0, 0), (0, 0, 3)]), "cut_off_distance inf visc 1 multiblob 42",
                        str(tmp_path / "data"))
    size = 8 * (3 * 42)**2    # the inverse mobility of its points
    scarce(MALLOC_LIMIT=size, MALLOC_MOST=size, SCARCE_RANK=scarce_rank)
    run = lmp(tmp_path, lines + ["run 0"], ranks=2, succeed=False)
    assert run.code != 0 and "keyword multiblob: '42': out of memory" in run.text, run.text[-1500:]


@pytest.mark.ranks(2)
@pytest.mark.parametrize("scarce_rank", [0, 1])
@pytest.mark.parametrize("fix", ["fix drag all stokes_dynamics", "fix move all stokes_dynamics/overdamped"])
def test_one_rank_without_memory_within_a_solve_ends_all(tmp_path, scarce, fix, scarce_rank):
    """A product asks for the numbers of all ranks, and one has no room for them."""
    n = 31
    x = 3.0 * np.stack(np.meshgrid(*3 * [np.arange(4)]), axis=-1).reshape(-1, 3)[:n]
    lines = input_lines(Spheres(x, v=(0, 0, 1)), "cut_off_distance inf far_field direct visc 1 multiblob 12",
                        str(tmp_path / "data"), fix=False)
    scarce(NEW_LIMIT=8 * 36 * n, NEW_MOST=8 * 36 * n, SCARCE_RANK=scarce_rank)
    run = lmp(tmp_path, lines + ["fix down all addforce 0 0 -1", fix, "run 0"], ranks=2, succeed=False)
    assert run.code != 0 and re.search("Pair style stokes_dynamics: step 0: .*out of memory",
                                       run.text), run.text[-1500:]


def test_multiblob_asks_for_the_room_of_blas_first(tmp_path, scarce):
    """At the command, which makes the shell by linear algebra; there OpenBLAS tried for ever."""
    lines = input_lines(Spheres([(0, 0, 0)]), "cut_off_distance inf visc 1 multiblob 12", str(tmp_path / "data"),
                        fix=False)
    scarce(MALLOC_LIMIT=130000000)
    run = lmp(tmp_path, lines, succeed=False)
    assert run.code != 0 and "linear algebra (BLAS) needs 0.14 GB" in run.text
