"""Bad input to the SPH styles: each has its own error, which names the command and the value."""
import os
import subprocess

import pytest

import sph_tools as T
from sph_tools import random_scene, run, start
from host import PATIENCE, environment, lmp_program, mpirun

PAIR = "pair_style sph/artVisc/tensCorr wendland 0.012\npair_coeff * *\n"
MOVE = "fix move all nve/sph\n"


def message(text, tmp_path=None):
    lmp = start()
    try:
        run(lmp, text)
    except Exception as error:
        return str(error)
    finally:
        lmp.close()
    return "no error"


STYLE = "pair_style sph/artVisc/tensCorr "
ONE_LINE = {
    "kernel missing": ("pair_style sph/artVisc/tensCorr", "kernel is missing"),
    "kernel": (STYLE + "gauss 0.012", "unknown kernel 'gauss'"),
    "h missing": (STYLE + "wendland", "keyword wendland: value missing: h"),
    "h zero": (STYLE + "wendland 0", "'0' must be > 0"),
    "h negative": (STYLE + "wendland -0.1", "'-0.1' must be > 0"),
    "h word": (STYLE + "wendland small", "'small' is not a number"),
    "h nan": (STYLE + "wendland nan", "'nan' is not a finite number"),
    "artVisc short": (STYLE + "wendland 0.012 artVisc 0.1 0", "keyword artVisc: value missing: eta"),
    "artVisc negative": (STYLE + "wendland 0.012 artVisc -0.1 0 0", "keyword artVisc: '-0.1' must be >= 0"),
    "tensCorr short": (STYLE + "wendland 0.012 tensCorr 0.2", "keyword tensCorr: value missing"),
    "deltap zero": (STYLE + "wendland 0.012 tensCorr 0.2 0", "keyword tensCorr: '0' must be > 0"),
    "viscosity": (STYLE + "wendland 0.012 viscosity 0", "keyword viscosity: '0' must be > 0"),
    "keyword": (STYLE + "wendland 0.012 artvisc 1 2 3", "unknown keyword 'artvisc'"),
    "shift": (STYLE + "wendland 0.012 shift hard", "keyword shift: 'hard' is none of: no, yes, pliant"),
    "pliant correction": (STYLE + "wendland 0.012 shift pliant correction yes",
                          "correction yes has a shift of its own, which has nothing that resists"),
    "coeff keyword": (PAIR + "pair_coeff 1 1 rho 3", "unknown keyword 'rho'"),
    "coeff value": (PAIR + "pair_coeff 1 1 h", "keyword h: value missing"),
    "coeff h": (PAIR + "pair_coeff 1 1 h 0", "keyword h: '0' must be > 0"),
    "coeff c": (PAIR + "pair_coeff 1 1 c -3", "keyword c: '-3' must be > 0"),
    "coeff alpha": (PAIR + "pair_coeff 1 1 alpha 3", "keyword alpha: the pair_style has no artVisc"),
    "coeff deltap": (PAIR + "pair_coeff 1 1 deltap 0.01", "keyword deltap: the pair_style has no tensCorr"),
    "coeff order": (PAIR + "pair_coeff 2 1*1 c 3", "no pair of types '2 1*1'"),
    "state missing": ("fix 1 all sph/pressure", "equation of state is missing"),
    "state": ("fix 1 all sph/pressure tait 1 2 3", "unknown keyword 'tait'"),
    "state B": ("fix 1 all sph/pressure absolut 0", "keyword absolut: '0' must be > 0"),
    "state rho0": ("fix 1 all sph/pressure relativ 10 -1", "keyword relativ: '-1' must be > 0"),
    "state gamma": ("fix 1 all sph/pressure Tait 10 1000", "keyword Tait: value missing: gamma"),
    "state P0": ("fix 1 all sph/pressure Tait 10 1000 7 x", "keyword Tait: 'x' is not a number"),
    "state tension": ("fix 1 all sph/pressure Tait 10 1000 7 tension maybe",
                      "keyword tension: 'maybe' is none of: no, yes"),
    "state tension absolut": ("fix 1 all sph/pressure absolut 10 tension no", "absolut has no negative pressure"),
    "state more": ("fix 1 all sph/pressure Tait 10 1000 7 0 5", "unknown keyword '5'"),
    "delta": ("fix 1 all sph/density/continuity delta -1", "keyword delta: '-1' must be >= 0"),
    "delta twice": ("fix 1 all sph/density/continuity delta 0.1 delta 0.1", "keyword delta: given twice"),
    "continuity": ("fix 1 all sph/density/continuity diffuse", "unknown keyword 'diffuse'"),
    "summation": ("fix 1 all sph/density/summation 3", "unknown keyword '3'"),
    "corr": ("fix 1 all sph/density/corr mls every 3", "shepard every N"),
    "corr every": ("fix 1 all sph/density/corr shepard every 0", "keyword every: '0' must be >= 1"),
    "volume": ("fix 1 all sph/density/continuity volume maybe", "keyword volume: 'maybe' is none of: no, yes"),
    "viscosity kind": (STYLE + "wendland 0.012 viscosity 1 shear", "unknown keyword 'shear'"),
    "property": ("fix 1 all property/global youngsModulus peratomtype 1 1",
                 "'youngsModulus' is none of: speedOfSound, sl"),
    "property kind": ("fix 1 all property/global sl scalar 1", "'scalar' is none of: peratomtype"),
    "property short": ("fix 1 all property/global sl peratomtype 1", "keyword sl: value missing"),
    "property zero": ("fix 1 all property/global sl peratomtype 1 0", "keyword sl: '0' must be > 0"),
    "property long": ("fix 1 all property/global sl peratomtype 1 1 1", "unknown keyword '1'"),
    "nve": ("fix 1 all nve/sph 3", "unknown keyword '3'"),
    "stationary": ("fix 1 all nve/sph/stationary 3", "unknown keyword '3'"),
    "wall kind": ("fix 1 all wall/sph plane 0 1 2 3", "unknown keyword 'plane'"),
    "wall null": ("fix 1 all wall/sph xplane NULL NULL 1 1", "both walls are NULL"),
    "wall order": ("fix 1 all wall/sph xplane 1 0 1 1", "lo 1 must be smaller than hi 0"),
    "wall r0": ("fix 1 all wall/sph zcylinder 1 0 1", "keyword zcylinder: '0' must be > 0"),
    "wall D": ("fix 1 all wall/sph zplane 0 1 0.1", "keyword zplane: value missing: D"),
    "wall radius": ("fix 1 all wall/sph zcylinder -1 0.1 1", "keyword zcylinder: '-1' must be > 0"),
    "region": ("fix 1 all wall/region/sph nowhere 0.1 1", "region 'nowhere' does not exist"),
    "adami": ("fix 1 all wall/adami/sph gravity 0 0", "keyword gravity: value missing"),
    "adami suction": ("fix 1 all wall/adami/sph suction 0", "keyword suction: '0' is none of: no, yes"),
    "adami slip": ("fix 1 all wall/adami/sph slip maybe", "keyword slip: 'maybe' is none of: no, yes"),
    "check N": ("fix 1 all check/timestep/sph 0 0.3", "keyword N: '0' must be >= 1"),
    "check fraction": ("fix 1 all check/timestep/sph 1 0", "keyword fraction: '0' must be > 0"),
    "check short": ("fix 1 all check/timestep/sph 1", "check/timestep/sph N fraction"),
    "wall gravity of four": ("variable text string 0\nfix 1 all wall/adami/sph gravity v_text 0 -2.5 0",
                             "wall/adami/sph: unknown keyword '0': keyword gravity before it has all of its values"),
    "check word": ("fix 1 all check/timestep/sph 1 0.3 crash", "unknown keyword 'crash'"),
}


@pytest.mark.parametrize("case", ONE_LINE)
def test_arguments(case):
    line, expected = ONE_LINE[case]
    assert expected in message(random_scene() + line)


AT_RUN = {
    "no pressure": (PAIR + MOVE + "unfix eos", "no fix sph/pressure"),
    "no density": (PAIR + MOVE + "unfix density", "no fix sph/density/continuity or sph/density/summation"),
    "two densities": (PAIR + MOVE + "fix more all sph/density/summation", "only one can set the density"),
    "two filters": (PAIR + MOVE + "fix a all sph/density/corr shepard every 3\n"
                                  "fix b all sph/density/corr shepard every 3",
                    "more than one fix sph/density/corr"),
    "two speeds of sound": (PAIR + MOVE + "fix a all property/global speedOfSound peratomtype 20 20\n"
                            "fix h all property/global sl peratomtype 0.012 0.012\n"
                                          "fix b all property/global speedOfSound peratomtype 30 20",
                            "more than one fix property/global gives speedOfSound"),
    "two pressures": (PAIR + MOVE + "fix more all sph/pressure absolut 3",
                      "atom 1 is in the groups of two fixes sph/pressure"),
    "pressure for a part": (PAIR + MOVE + "unfix eos\ngroup one type 1\nfix eos one sph/pressure absolut 3",
                            "is in the group of no fix"),
    "no pair style": (MOVE, "Fix sph/pressure: there is no pair_style sph/artVisc/tensCorr"),
    "nobody advances the density": (PAIR + "fix move all nve", "nothing advances the density; use fix nve/sph"),
    "mixed integrators": (PAIR + "group one type 1\ngroup two type 2\nfix a one nve/sph\nfix b two sph",
                          "cannot be mixed"),
    "c missing": (STYLE + "wendland 0.012 artVisc 0.1 0 0\npair_coeff * *\n" + MOVE,
                  "keyword artVisc needs the speed of sound"),
    "c missing for delta": (PAIR + MOVE + "unfix density\nfix density all sph/density/continuity delta 0.1",
                            "needs the speed of sound"),
    "c missing for check": (PAIR + MOVE + "fix c all check/timestep/sph 1 0.3", "has no speed of sound"),
    "deltap": (STYLE + "wendland 0.012 tensCorr 0.2 0.024\npair_coeff * *\n" + MOVE,
               "deltap 0.024 must be smaller than the support 2 h = 0.024"),
    "coefficients": (STYLE + "wendland 0.012\npair_coeff 1 1\n" + MOVE, "All pair coeffs are not set"),
    "skin": (PAIR + MOVE + "neighbor 0 bin", "a skin of 0 is too small"),
    "one place": (PAIR + MOVE + "set atom 7 x 0.01 y 0.01 z 0.01\nset atom 9 x 0.01 y 0.01 z 0.01", "are at one place"),
    "density 0": (PAIR + MOVE + "set atom 7 sph/rho 0", "atom 7 has the density 0; it must be a number > 0"),
    "density negative": (PAIR + MOVE + "set atom 7 sph/rho -3", "atom 7 has the density -3; it must be a number > 0"),
    "minimise": (PAIR + "minimize 0 0 1 1", "cannot be minimised"),
    "behind a plane": (PAIR + MOVE + "fix w all wall/sph xplane 0.01 NULL 0.001 1", "is on or behind the wall"),
    "outside a region": (PAIR + MOVE + "region r block 0.01 1 -1 1 -1 1 units box\nfix w all wall/region/sph r 0.001 1",
                         "is on or behind the wall"),
    "respa": (PAIR + MOVE + "run_style respa 2 2 pair 1", "respa"),
    "respa with fix sph": (PAIR + "fix move all sph\nrun_style respa 2 2 pair 1", "run_style respa"),
    "wall group moves": (PAIR + MOVE + "group w type 2\nfix w w wall/adami/sph",
                         "Fix wall/adami/sph: atom 1 of its group is also integrated by fix move"),
    "wall group moves with fix sph": (PAIR + "fix move all sph\ngroup w type 2\nfix w w wall/adami/sph",
                                      "is also integrated by fix move"),
    "no such pressure": (PAIR + "group one type 1\ngroup two type 2\nfix move one nve/sph\n"
                                "fix w two wall/adami/sph gravity 0 -1e7 0",
                         "that the fluid asks for is not above -60000, the lowest of fix eos"),
    "no such pressure of absolut": (PAIR + "unfix eos\nfix eos all sph/pressure absolut 3\ngroup one type 1\n"
                                    "group two type 2\n"
                                    "fix move one nve/sph\nfix w two wall/adami/sph gravity 0 -1e7 0",
                                    "that the fluid asks for is not above 0, the lowest of fix eos"),
    "integrated twice": (PAIR + MOVE + "fix more all nve/sph",
                         "atom 1 is integrated twice, by fix more of style nve/sph and by another fix"),
    "moved as well": (PAIR + MOVE + "fix more all move linear 0 0 0",
                      "atom 1 is integrated twice, by fix more of style move and by another fix"),
    "integrated by two styles": (PAIR + MOVE + "fix more all nve", "integrated twice, by fix more of style nve"),
    "rerun": (PAIR + MOVE + "dump d all atom 1 {dump}\nrun 1\nrerun {dump} dump x y z", "cannot be used with rerun"),
    "not prepared": (PAIR + MOVE + "run 1\nwrite_data {dump}\nrun 1 pre no", "nor with 'pre no' after write_data"),
    "stop": (PAIR.replace("* *", "* * c 20") + MOVE + "timestep 0.1\nfix c all check/timestep/sph 1 0.3 stop",
             "more than 0.3"),
}


@pytest.mark.parametrize("case", AT_RUN)
def test_scenes(case, tmp_path):
    lines, expected = AT_RUN[case]
    assert expected in message(random_scene() + lines.replace("{dump}", str(tmp_path / "dump")) + "\nrun 1")


@pytest.mark.parametrize("wall, bad, good", [
    ("xplane -1 NULL 0.001 1", "p f f", "f p p"), ("yplane NULL 1 0.001 1", "f p f", "p f p"),
    ("zplane -1 1 0.001 1", "p p p", "p p f"),
    # The box of the scene goes from -0.06 to 0.105: a cylinder around 0 leaves it through the periodic faces.
    ("zcylinder 1 0.001 1", "p f f", "f f p"), ("zcylinder 1 0.001 1", "f p f", "f f f")])
def test_walls_of_a_periodic_box(wall, bad, good):
    """Particles would go round, or see each other through the wall."""
    scene = random_scene() + PAIR + MOVE + "fix w all wall/sph " + wall + "\nrun 0"
    assert "Fix wall/sph: keyword " + wall.split()[0] in message(scene.replace("boundary f f f", "boundary " + bad))
    assert message(scene.replace("boundary f f f", "boundary " + good)) == "no error"


def test_a_support_of_very_many_boxes_is_asked_about():
    """h in other units: LAMMPS would make ghosts without end."""
    scene = (random_scene().replace("boundary f f f", "boundary p p p") + "pair_style sph/artVisc/tensCorr wendland 5\n"
             "pair_coeff * *\n" + MOVE)
    text = message(scene + "run 0")
    assert "types 1 and 1: the support 2 h = 10 is 60.6" in text and "is it in other units?" in text


def test_cylinder_inside_a_periodic_box():
    """Nobody gets out of a cylinder that is a support away from its images."""
    box = ("units si\natom_style sph\nregion b block -1 1 -1 1 -1 1\ncreate_box 1 b\n"
           "create_atoms 1 single 0.1 0.2 0\nmass 1 1\nset group all sph/rho 1000\nneighbor 0.01 bin\n"
           "pair_style sph/artVisc/tensCorr wendland 0.1\npair_coeff * *\nfix e all sph/pressure absolut 3\n"
           "fix d all sph/density/continuity\nfix m all nve/sph\nfix w all wall/sph zcylinder %s 0.1 1\nrun 0")
    assert message(box % "0.89") == "no error"
    assert "keyword zcylinder" in message(box % "0.91")


ADAPT = {"h": ("0.012-0.01*step", "'-0.008' must be > 0"), "c": ("20-10*step", "'0' must be > 0"),
         "alpha": ("0.1-0.1*step", "'-0.1' must be >= 0"), "beta": ("-0.5", "'-0.5' must be >= 0"),
         "deltap": ("0.01-0.01*step", "'0' must be > 0"), "viscosity": ("-1", "keyword viscosity: '-1' must be > 0"),
         "eta": ("-2", "keyword artVisc: eta '-2' must be >= 0"),
         "epsilon": ("-3", "keyword tensCorr: epsilon '-3' must be >= 0"),
         "tau": ("0.1-0.1*step", "'-0.1' must be >= 0"), "n": ("1-step", "'0' must be > 0"),
         "mumax": ("0.0005", "mumax = 0.0005 must not be smaller"),
         "lambda": ("-1", "'-1' must be > 0")}


@pytest.mark.parametrize("name", ADAPT)
def test_fix_adapt_may_set_no_value_that_the_commands_refuse(name):
    formula, expected = ADAPT[name]
    style = STYLE + "wendland 0.012 artVisc 0.1 0.1 1e-6 viscosity 1e-3" + (" tensCorr 0.2 0.01" if name != "h" else "")
    style += " rheology bingham 1 2" if name in ("tau", "n", "mumax", "lambda") else ""
    text = message(random_scene() + style + f"\npair_coeff * * c 20\n{MOVE}variable v equal {formula}\n"
                   f"fix adapt all adapt 1 pair sph/artVisc/tensCorr {name} * * v_v\nrun 3")
    assert "Pair style sph/artVisc/tensCorr" in text and expected in text


@pytest.mark.parametrize("ranks", [1, 2])
def test_message_of_one_rank_reaches_a_file(tmp_path, ranks):
    """LAMMPS aborts all ranks then, and drops what its output buffers hold."""
    script = tmp_path / "in.test"
    script.write_text("plugin load stokesdynplugin.so\n" + random_scene() + PAIR + MOVE + "set atom 7 sph/rho 0\n"
                      "run 1\n")
    command = mpirun(ranks) + [lmp_program(), "-in", str(script), "-log", "log.test", "-nocite"]
    with open(tmp_path / "out", "w") as out:
        code = subprocess.run(command, stdout=out, stderr=subprocess.STDOUT, cwd=tmp_path, env=environment(),
                              timeout=PATIENCE).returncode
    assert code != 0
    assert "atom 7 has the density 0; it must be a number > 0" in (tmp_path / "out").read_text()
    if ranks == 1:
        assert "atom 7 has the density 0; it must be a number > 0" in (tmp_path / "log.test").read_text()


def test_atom_style_without_density():
    assert "use atom_style sph" in message("atom_style atomic\nregion r block 0 1 0 1 0 1\ncreate_box 1 r\n"
                                           "fix 1 all sph/density/continuity")
    text = ("atom_style atomic\nregion r block 0 1 0 1 0 1\ncreate_box 1 r\ncreate_atoms 1 single 0.5 0.5 0.5\n"
            "mass 1 1\n" + PAIR + "run 0")
    assert "use atom_style sph" in message(text)


def test_nan_density_names_the_atom():
    lmp = start()
    try:
        run(lmp, random_scene() + PAIR + MOVE + "run 1")
        n = lmp.extract_global("nlocal")
        ids, v = lmp.numpy.extract_atom("id", nelem=n), lmp.numpy.extract_atom("v", nelem=n, dim=3)
        v[list(ids).index(7)] = float("nan")
        with pytest.raises(Exception, match="atom [0-9]* has the density -?nan; it must be a number > 0"):
            run(lmp, "run 2")
    finally:
        lmp.close()


def test_outdated_neighbour_list_is_an_error():
    """Rebuilding at most every 20 steps, with particles that cross the skin in fewer."""
    text = (random_scene() + PAIR + MOVE + "neigh_modify delay 20 every 1 check yes\nneighbor 0.0005 bin\n"
                                           "timestep 1e-4\nrun 40")
    assert "moved more than half the neighbour skin 0.0005 before the neighbour list could be rebuilt" in message(text)


def test_nve_sph_needs_pair_style():
    text = random_scene().replace("fix eos", "#").replace("fix density", "#") + MOVE + "run 1"
    assert "Fix nve/sph: there is no pair_style" in message(text)


def test_lammps_without_sph_package(tmp_path):
    """The other styles load, and the plugin says what is missing. The LAMMPS here has the package, so a small library
    hides it."""
    source = tmp_path / "hide.c"
    source.write_text("#include <dlfcn.h>\n#include <string.h>\n"
                      "int lammps_has_style(void *lmp, const char *kind, const char *name)\n{\n"
                      "  if (strcmp(kind, \"atom\") == 0 && strcmp(name, \"sph\") == 0) return 0;\n"
                      "  int (*real)(void *, const char *, const char *) = (int (*)(void *, const char *, "
                      "const char *)) dlsym((void *) -1L, \"lammps_has_style\");\n"
                      "  return real(lmp, kind, name);\n}\n")
    library = tmp_path / "hide.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-o", library, source, "-ldl"], check=True)
    script = tmp_path / "in.test"
    script.write_text("plugin load stokesdynplugin.so\nplugin list\n")
    env = dict(environment(), LD_PRELOAD=str(library))
    done = subprocess.run(["lmp", "-in", str(script), "-log", "none", "-nocite"], env=env, capture_output=True,
                          text=True, cwd=tmp_path)
    assert "the SPH styles are not loaded; they need a LAMMPS with the SPH package" in done.stdout
    assert "stokes_dynamics" in done.stdout and "sph/pressure" not in done.stdout
