"""The one door to several ranks (host.py), and who is known to go through it (conftest.py)."""
import os
import shutil
import subprocess

import pytest

import host
from conftest import names
from system import lmp


@pytest.fixture
def mpich(monkeypatch):
    monkeypatch.setattr(host, "family", lambda: "MPICH")
    monkeypatch.setattr(os, "sched_getaffinity", lambda process: {0, 1})


def test_mpich_has_as_many_as_cores(mpich):
    assert host.allowed(1, 2, 4) == [1, 2] and host.allowed((2, "on"),
                                                            (4, "off")) == [(2, "on")] and host.at_most(3) == 2
    with pytest.raises(AssertionError, match="3 ranks where there may be 2"):
        host.mpirun(3)


def test_ranks_of_mpich_wait_for_those_of_another_test(mpich, tmp_path, monkeypatch):
    """Each of three programs writes that it has begun, and some time later that it has ended: none begins in
    between."""
    monkeypatch.setattr(host.tempfile, "gettempdir", lambda: str(tmp_path))
    script = f"echo begins >> {tmp_path}/said; sleep 0.2; echo ends >> {tmp_path}/said"
    for process in [subprocess.Popen(host.one_at_a_time() + ["sh", "-c", script]) for _ in range(3)]:
        assert process.wait(timeout=host.PATIENCE) == 0
    assert (tmp_path / "said").read_text().split() == ["begins", "ends"] * 3


def test_mpirun_has_a_folder_of_this_process():
    folder = host.environment()["TMPDIR"]
    assert os.path.isdir(folder) and folder == host.environment()["TMPDIR"] and folder != host.tempfile.gettempdir()


def test_without_mpi_there_is_one(monkeypatch):
    monkeypatch.setattr(host, "family", lambda: "")
    assert host.allowed(1, 2) == [1] and host.at_most(4) == 1 and host.mpirun(1) == []


def test_a_test_that_does_not_say_so_may_have_one(mpich):
    """This one: nothing in it has such a name."""
    assert host.undeclared and host.mpirun(1) == []
    with pytest.raises(AssertionError, match="mark says so"):
        host.mpirun(2)


def test_mpirun_is_that_of_lammps(tmp_path):
    for family, words in (("MPICH", "HYDRA build details:"), ("Open MPI", "mpirun (Open MPI) 4.1.4")):
        folder = tmp_path / family
        folder.mkdir()
        (folder / "mpirun").write_text(f"#!/bin/sh\necho '{words}'\n")
        (folder / "mpirun").chmod(0o755)
    folders = [str(tmp_path / name) for name in host.FAMILIES]
    for family in host.FAMILIES:
        assert host.launcher_of(family, folders)[0] == str(tmp_path / family / "mpirun")
    with pytest.raises(AssertionError, match="no mpirun of MPICH"):
        host.launcher_of("MPICH", [str(tmp_path / "Open MPI")])


def test_the_program_is_that_of_the_path_and_no_script():
    assert host.said(host.lmp_program(), "-h") == host.said("lmp", "-h")
    with open(shutil.which(host.lmp_program()), "rb") as file:
        assert file.read(2) != b"#!"


def test_names_are_found_where_a_function_uses_them():
    def outer():
        def inner(number):
            return print(number, ranks_within=1)
        for ranks in (1, 2):
            inner(ranks)
    assert {"ranks", "inner", "number", "ranks_within"} <= names(outer.__code__)


@pytest.mark.parametrize("family, left_out", [("MPICH", 2), ("Open MPI", 0)])
def test_scenes_that_differ_in_the_core_alone_are_asked_mpich_once(monkeypatch, family, left_out):
    monkeypatch.setattr(host, "family", lambda: family)
    for some, values in ((host.by_open_mpi("abc"), [("a",), ("b",), ("c",)]),
                         (host.by_open_mpi([(1, 2), (3, 4), (5, 6)], several=True), [(1, 2), (3, 4), (5, 6)])):
        assert [one.values for one in some] == values and not some[0].marks
        assert sum(mark.args[0] for one in some for mark in one.marks) == left_out


@pytest.mark.ranks(2)
def test_a_run_that_is_over_before_a_thread_of_open_mpi_had_a_core(tmp_path, monkeypatch):
    """Without threads_rest.c five of six such runs end by signal 11."""
    late = os.path.join(os.path.dirname(host.__file__), "late_thread.c")
    subprocess.run(["cc", "-shared", "-fPIC", "-o", tmp_path / "late.so", late, "-ldl"], check=True)
    monkeypatch.setenv("LD_PRELOAD", str(tmp_path / "late.so"))
    run = lmp(tmp_path, ["region b block 0 5 0 5 0 5", "create_box 1 b", "mass 1 1", "run 0"], 2)
    assert "Total wall time" in run.text
