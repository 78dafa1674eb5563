#!/usr/bin/env python3
"""Relations as judge: a scene is drawn, and a change of its input that must not matter; both are run and compared.

    . build/env.sh; unittest/lammps/relations.py N [SEED] [--model stokes|sph|vans] [--one NUMBER] [--ranks R]

Scenes are in relations_stokes.py, relations_sph.py and relations_vans.py, changes in relations_changes.py (with the
reason where one cannot hold). A case that fails is made smaller, one option after the other, as long as it fails, and
printed as shell commands with both inputs. Exits with 1 if a case failed."""
import argparse
import collections
import os
import random
import re
import sys
import tempfile
import time

import numpy as np

import host
import relations_changes as changes
import relations_sph
import relations_stokes
import relations_vans
import system
from relations_frame import Frame

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "examples"))
from image import Image  # noqa: E402

MODELS = {"stokes": relations_stokes, "sph": relations_sph, "vans": relations_vans}


def most_ranks():
    """The largest number of ranks of a case"""
    return host.at_most(3)


# --- an input ---------------------------------------------------------------------------------------------------------

def commands(scene, frame, ranks=1, newton="on", grid="", tiled=False, skin=0.0, sort="", far=0.0, search="",
             balance="", told=False, doubled=False, pieces="", again=0, hybrid="", twice=""):
    """[(ranks, lines)]: one input, or two where the second reads the restart file of the first."""
    def write(lines):
        return [word for line in lines for word in frame.write(line).split("\n")]

    head = scene.head + [f"newton {newton}", "atom_modify map array" + f" sort {sort}" * bool(sort),
                         "plugin load stokesdynplugin.so"]
    head += [f"processors <each {grid}>"] * bool(grid) + ["comm_style tiled"] * tiled
    strangers = scene.strangers() if hybrid == "strangers" else []
    after = strangers + [f"replicate <each {scene.repeats}>"] * doubled + scene.after
    begin = write(head + scene.make) + scene.create(frame) + write(after + scene.groups)
    define = [re.sub("^neighbor <L .*?>", f"neighbor <L {skin}>", line) if skin else line for line in scene.define]
    define = [re.sub("^(neighbor .*) bin$", rf"\1 {search}", line) if search else line for line in define]
    define += [f"comm_modify cutoff <L {far * scene.spacing}>"] * bool(far)
    define += [f"timestep <t {scene.dt!r}>", "thermo_style custom step"]
    moved = {"": "", "rcb": "rcb", "shift": f"shift {'xy' if scene.model == 'sph 2-D' else 'xyz'} 10 1.01"}[balance]
    fixes = write(scene.fixes) + [f"fix even all balance 2 1.0 {moved}"] * bool(moved)
    fixes += write([f"fix told all dt/reset 1 NULL <t {scene.dt!r}> <L 1e6> units box"]) * told
    balance, pair = ["balance 1.1 rcb"] * tiled, scene.pair_lines(hybrid)
    if twice:
        body = write(define + scene.pair_lines(hybrid, frame.write(scene.other) if twice == "other" else None)) + fixes
        body += (["run 0 post no"] + write(pair) + ["print \"$(%s)\"" % scene.output_between] *
                 bool(scene.output_between))
    else:
        body = write(define + pair) + fixes
    output, n = write(scene.output(doubled)), scene.steps
    if pieces == "restart":
        resumed = (write([line for line in head if not line.startswith(("units", "atom_style"))]) +
                   ["read_restart between"])
        resumed += write(define + (pair if hybrid or len(scene.pair) > 1 else [])) + fixes + output + [
            f"run {n - n // 2}"]
        first = begin + balance + body + write(scene.late) + output + [f"run {n // 2}", "write_restart between"]
        return [(ranks, first), (again or ranks, resumed)]
    runs = {"two": [n // 2, n - n // 2], "ones": [1] * n, "zero": [0, n]}.get(pieces, [n])
    return [(ranks, begin + balance + body + write(scene.late) + output + [f"run {k}" for k in runs])]


class Result:
    """error: of LAMMPS, or empty; values: {(what, kind, step): numbers in the frame of the scene}"""

    def __init__(self, error="", values=None):
        self.error, self.values = error, values or {}


def run(scene, frame, how):
    with tempfile.TemporaryDirectory() as folder:
        for k, (ranks, lines) in enumerate(commands(scene, frame, **how)):
            try:
                done = system.lmp(folder, lines, ranks, succeed=False)
            except (AssertionError, OSError) as error:
                return Result(f"ERROR: {error}")
            says = re.findall("^ERROR.*", done.log + "\n" + done.text, re.M)
            if says or done.code:
                return Result(says[0] if says else f"ERROR: exit code {done.code}: {done.text[-300:]}")
        return Result(values=read(scene, frame, folder, done.log))


def rows_of(path, scene, frame):
    """{step: rows of the atoms that the scene began with}, in their order of the scene's own numbers; nan: an atom that
    has left"""
    frames, old = {}, {frame.new_id(k): k for k in range(1, len(scene.atoms) + 1)}
    with open(path) as file:
        parts = file.read().split("ITEM: TIMESTEP\n")[1:]
    for part in parts:
        rows = frames.setdefault(int(part.split()[0]),
                                 np.full((len(scene.atoms), sum(len(w.split()) for _, w in scene.columns)), np.nan))
        for line in part[part.index("ITEM: ATOMS"):].splitlines()[1:]:
            words = line.split()
            if int(words[0]) in old:
                rows[old[int(words[0])] - 1] = [float(w) for w in words[1:]]
    assert not np.isnan(frames[min(frames)]).any() or min(frames) > 0, "atoms of the scene are not there"
    return frames


def read(scene, frame, folder, log):
    values = {}
    for step, rows in rows_of(os.path.join(folder, "out"), scene, frame).items():
        at = 0
        for kind, words in scene.columns:
            width = len(words.split())
            back = frame.back(kind, rows[:, at:at + width] if width > 1 else rows[:, at])
            values["atoms: " + words, kind, step] = scene.at_rest(kind, step, back)
            at += width
    wide = 1 + sum(len(words.split()) for _, words in scene.globals)
    for line in log.splitlines():
        numbers = line.split()
        if len(numbers) == wide > 1 and all(re.fullmatch("[-+0-9.e]+|-?(nan|inf)", word) for word in numbers):
            at = 1
            for kind, words in scene.globals:
                width = len(words.split())
                values["thermo: " + words, kind,
                       int(numbers[0])] = frame.back(kind, [float(w) for w in numbers[at:at + width]])
                at += width
    if scene.grid:
        velocity = Image(os.path.join(folder, f"flow.{scene.steps}.vti"))["velocity"]
        values["flow", "V", scene.steps] = frame.back_grid(velocity)
    return values


def differences(scene, a, b):
    """[(difference in units of the largest value of its kind, what)], largest first"""
    found = []
    for key in a.values.keys() & b.values.keys():
        x, y = a.values[key], b.values[key]
        if x.shape != y.shape:
            found.append((np.inf, f"{key[0]}: {x.shape} and {y.shape}"))
            continue
        gone = np.isnan(x) & np.isnan(y)
        scale = max(scene.length if key[1] == "p" else np.abs(x[~gone]).max(initial=0.0), scene.floor)
        found.append((float(np.nan_to_num(np.abs(x - y)[~gone], nan=np.inf).max(initial=0.0) / scale),
                      f"{key[0]} in step {key[2]}"))
    return sorted(found, reverse=True)


# --- a case -----------------------------------------------------------------------------------------------------------

class Case:
    """options: of the scene, in full; names: the changes"""

    def __init__(self, model, seed, options, names):
        self.model, self.seed, self.options, self.names = model, seed, options, names

    @classmethod
    def draw(cls, seed, number, most, model=None):
        R = random.Random(f"{seed} {number}")
        model = model or R.choices(list(MODELS), [60, 28, 12])[0]
        module = MODELS[model]
        options = module.lawful({name: R.choice(values) for name, values in module.OPTIONS.items()})
        return cls(model, f"{seed} {number}", options, changes.draw(R, dict(options, **{"model of": model}), most))

    def scene(self, **instead):
        return MODELS[self.model].build(dict(self.options, **instead), self.seed)

    def way(self):
        """scene, frame and how of the changed input, and how loose it is"""
        how, frame, options, loose = {}, None, {}, 1.0
        for name in self.names:
            c = changes.CHANGES[name]
            how.update(c["how"])
            frame, options, loose = c["frame"] or frame, c["options"] or options, max(loose, c["loose"])
        scene = self.scene(**options)
        return scene, frame(scene) if frame else Frame(), how, loose

    def judge(self):
        """("", "") if it holds, ("refused", why) if the scene itself is refused, else ("differs" or "breaks", what)"""
        plain = self.scene()
        first = run(plain, Frame(), {})
        if first.error:
            return "refused", first.error
        scene, frame, how, loose = self.way()
        second = run(scene, frame, how)
        if second.error:
            return "breaks", second.error
        found = differences(plain, first, second)
        assert any(key[2] == plain.steps for key in first.values.keys() & second.values.keys()), self.title()
        self.worst = found[0]
        allowed = max(plain.tolerance * loose, changes.coarse(self.names, self.options))
        if found[0][0] <= allowed:
            return "", f"{found[0][0]:.0e}"
        return "differs", f"{found[0][0]:.1e} for {allowed:.1e}: {found[0][1]}"

    def reduced(self, patience=300.0):
        """The smallest case that still fails in the same way"""
        case, end = self, time.time() + patience
        what = case.judge()[0]
        module, again = MODELS[self.model], True
        while again and time.time() < end:
            again = False
            smaller = [Case(case.model, case.seed, case.options, [n for n in case.names if n != name])
                       for name in case.names if len(case.names) > 1]
            for name, values in module.OPTIONS.items():
                k = values.index(case.options[name]) if case.options[name] in values else 0
                for simple in dict.fromkeys(values[:k]):
                    smaller.append(Case(case.model, case.seed, module.lawful(dict(case.options, **{name: simple})),
                                        case.names))
            for other in smaller:
                if (other.options, other.names) == (case.options, case.names) or time.time() > end:
                    continue
                full = dict(other.options, **{"model of": other.model})
                if not any(changes.reason(n, full) for n in other.names) and other.judge()[0] == what:
                    case, again = other, True
                    break
        return case

    def title(self):
        simple = MODELS[self.model].OPTIONS
        given = {k: v for k, v in self.options.items() if v != simple[k][0]}
        return f"{self.model} [{' + '.join(self.names)}] {given}"

    def script(self):
        """Both inputs, as shell commands"""
        scene, frame, how, _ = self.way()
        text = []
        for name, inputs in (("one", commands(self.scene(), Frame())), ("other", commands(scene, frame, **how))):
            text.append(f"mkdir -p {name}; cd {name}")
            for k, (ranks, lines) in enumerate(inputs):
                text += [f"cat > in.{k} << 'END'"] + lines + ["END",
                                                              " ".join(host.mpirun(ranks) + ["lmp", "-in", f"in.{k}"])]
            text.append("cd ..")
        return "\n".join(text)


def judge(seed, numbers, most, model=None, tell=lambda *words: None):
    """(failures as texts, counts of what ran: options and changes)"""
    failures, ran = [], collections.Counter()
    for number in numbers:
        case = Case.draw(seed, number, most, model)
        what, why = case.judge()
        ran["refused" if what == "refused" else "judged"] += 1
        if what != "refused":
            ran.update(case.names)
            ran.update(f"{case.model}: {k} {v}" for k, v in case.options.items())
        tell(number, what or "holds", case.title(), why)
        if what in ("differs", "breaks"):
            small = case.reduced()
            failures.append("\n".join([f"case {number} of seed {seed} {what}: {case.title()}", why,
                                       f"smallest: {small.title()}", small.judge()[1], small.script()]))
            tell(failures[-1])
    return failures, ran


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("cases", type=int)
    parser.add_argument("seed", type=int, nargs="?", default=1)
    parser.add_argument("--model", choices=MODELS)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--one", action="store_true", help="print the inputs of the first case, and judge it")
    parser.add_argument("--ranks", type=int, default=most_ranks(), help="the largest number of ranks")
    given = parser.parse_args()
    if given.one:
        print(Case.draw(given.seed, given.first, given.ranks, given.model).script())
    began = time.time()
    failures, ran = judge(given.seed, range(given.first, given.first + given.cases), given.ranks, given.model,
                          lambda *words: print(*words, flush=True))
    for name, count in sorted(ran.items()):
        print(f"{count:6d} {name}")
    print(f"{ran['judged']} cases judged, {ran['refused']} refused, {len(failures)} failed, "
          f"{time.time() - began:.0f} s")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
