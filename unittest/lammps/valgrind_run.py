"""A small LAMMPS run under valgrind memcheck: no error may have our code in its stack.   valgrind_run.py FOLDER

LAMMPS and Open MPI have errors of their own, so each is looked at: it is ours if a frame of its stack is in one of our
files or carries one of our names. Writes FOLDER/valgrind.xml."""
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as tree

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from system import Spheres, dump_lines, environment, input_lines  # noqa: E402

MOVE = ["fix move all nve/sphere", "timestep 0.01"]
COMMON = "visc 1.3 algorithm 2 relative_tolerance 1e-6"


def clumps():
    """Five clumps of four spheres; three of them lie across the borders of the box."""
    rng = np.random.default_rng(1)
    centres = np.array([(0, 0, 0), (5.8, 1, -2), (-3, 5.9, 2), (1, -2, 5.9), (3, 3, -3)], float)
    corner = 0.7 * np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)])
    x = (centres[:, None] + corner[None, :]).reshape(-1, 3)
    v = np.repeat(rng.normal(size=(5, 3)), 4, axis=0)
    return Spheres(x, 0.9, v, np.repeat(np.arange(1, 6), 4))


def wide():
    """Few large spheres among small ones: Ewald sums of two levels."""
    rng = np.random.default_rng(4)
    a = np.where(np.arange(200) % 80 == 7, 20.0, 1.0)
    return Spheres(rng.uniform(-11, 11, (200, 3)), a, rng.normal(size=(200, 3)))


def script(folder):
    box, spheres = [(-6.0, 6.0)] * 3, clumps()

    def scene(name, style, of=spheres, **options):
        return input_lines(of, style, os.path.join(folder, name + ".data"), **options)

    lines = scene("clump", f"clumps_only yes {COMMON} add_force yes", boundary="p p p", box=box,
                  comm="comm_modify cutoff 4",
                  before_pair="neigh_modify exclude molecule/intra all every 1 delay 0 check no")
    lines += ["compute p all pair stokes_dynamics", "thermo_style custom step c_p[1] c_p[2]", "variable w atom z<0",
              "group half variable w",
              "fix move all rigid/small molecule", "timestep 0.01", "run 3", f"write_restart {folder}/mid.restart",
              "run 2", "clear"]
    lines += ["plugin load stokesdynplugin.so", f"read_restart {folder}/mid.restart", "thermo_style custom step",
              "fix move all rigid/small molecule", "run 2", "clear"]
    # every sphere with those in reach, half of them ghosts; spheres come and go
    lines += scene("list", f"cut_off_distance 2.5 {COMMON} region r", boundary="p p p", box=box,
                   before_pair="neigh_modify every 1 delay 0 check no\nregion r block -4 INF INF INF INF INF")
    lines += MOVE + dump_lines(os.path.join(folder, "list.dump")) + [
        "run 3", "create_atoms 1 single 1.1 1.2 1.3", "set type 1 diameter 1.2", "run 1", "group gone id 3 7 11",
        "delete_atoms group gone", "run 2",
        "clear"]
    # Ewald sums: torques in an oblique box that shrinks, waves as preconditioner; an open box; two levels
    lines += scene("periodic",
                   f"cut_off_distance inf {COMMON} rotation yes precondition waves far_field_tolerance 1e-3",
                   boundary="p p p", box=box, tilt=(1.0, 0.5, -0.5))
    lines += MOVE + ["fix squeeze all deform 1 x scale 0.9 remap x", "run 2", "clear"]
    lines += scene("open", f"cut_off_distance inf {COMMON} far_field ewald far_field_tolerance 1e-3") + MOVE + [
        "run 2", "clear"]
    loose = "cut_off_distance inf visc 1.3 algorithm 2 relative_tolerance 0.5"
    lines += scene("levels", f"{loose} far_field_tolerance 1e-3", wide(), boundary="p p p", box=[(-11.0, 11.0)] * 3)
    lines += MOVE + ["run 1", "clear"]
    lines += scene("all", f"cut_off_distance inf {COMMON}",
                   before_pair="variable s atom 1+0.1*x\nvariable u equal 0.1*step")
    lines += ["pair_style stokes_dynamics cut_off_distance inf visc v_s fluid_velocity v_u 0 0 "
              "update_every 2 algorithm 2",
              "pair_coeff * *"]
    return lines + MOVE + ["run 3"]


def is_ours(error):
    for stack in error.findall("stack"):
        for frame in stack.findall("frame"):
            library, function = frame.findtext("obj") or "", frame.findtext("fn") or ""
            if library.endswith(("stokesdynplugin.so",
                                 "stokesdynstyles.so")) or "StokesDyn::" in function or function.startswith("sd_"):
                return True
    return False


def describe(error):
    what = error.findtext("what") or error.findtext("xwhat/text")
    frames = error.find("stack").findall("frame")
    return what + "\n" + "\n".join("    " + (f.findtext("fn") or f.findtext("obj") or "?") for f in frames[:12])


def main(folder):
    report = os.path.join(folder, "valgrind.xml")
    if os.path.exists(report):
        os.remove(report)
    with tempfile.TemporaryDirectory() as scratch:
        path = os.path.join(scratch, "in.valgrind")
        with open(path, "w") as out:
            out.write("\n".join(script(scratch)) + "\n")
        ran = subprocess.run(["valgrind", "--tool=memcheck", "--keep-debuginfo=yes", "--leak-check=full",
                              "--show-leak-kinds=definite",
                              "--errors-for-leak-kinds=definite", "--error-limit=no", "--num-callers=40", "--xml=yes",
                              f"--xml-file={report}", "lmp", "-in", path, "-log", "none", "-nocite"],
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env=environment())
    text = ran.stdout.decode(errors="replace")
    if ran.returncode != 0 or "ERROR" in text:
        print(text[-2000:])
        print(f"valgrind: the run itself failed (exit code {ran.returncode})")
        return 1
    errors = tree.parse(report).getroot().findall("error")
    ours = [e for e in errors if is_ours(e)]
    for e in ours:
        print(describe(e))
    print(f"valgrind: {len(ours)} errors of ours ({len(errors)} in all, the others of LAMMPS and MPI); "
          f"whole report: {report}")
    return 1 if ours else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
