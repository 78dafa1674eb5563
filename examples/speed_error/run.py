#!/usr/bin/env python3
"""Time per step against error, for many settings of pair_style stokes_dynamics.

    run.py [--data FILE | --large] [--quick] [--error 1e-2] [--ranks 2] [--out FOLDER] [--screening] [--update]

Scenes are built in, or one is read from a data file of atom_style hybrid sphere bond. Every setting follows the same
path of the spheres (their velocities are given, the force is not applied), so all forces can be compared at the same
step. Prints a table for each scene, draws the Pareto fronts (speed_error.png in FOLDER, default
build/examples/speed_error), names the cheapest setting below the wanted error, and runs that one on more ranks.
    --quick       smaller scenes, fewer settings
    --large       only what Ewald sums are for: 10^4 spheres in a periodic box, 10^5 in an open one (large.png)
    --ranks       of the last run, as many as there are cores up to 4; 1: none
    --screening   only the table of what a taper leaves of the drag
    --update      the table, speed_error.txt or large.txt, and the picture go to this folder as well

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed; with --data there is
none.
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
os.environ.setdefault("OMP_NUM_THREADS", "1")
import large  # noqa: E402
from checks import Checks  # noqa: E402
from runs import np, plt, RESULTS  # noqa: E402

try:
    from lammps import lammps
except ImportError:
    sys.exit("run.py: the python module of LAMMPS is not there: cmake/setup.sh, then . build/env.sh")

VISC = 1.0
MOVE = 0.01             # of a radius and step, at the mean speed
STEPS = 20              # timed; forces are compared at the last but one, when an old v' is oldest
FLOOR = 1e-9            # of the picture
FAMILY = {"tolerance": "C0", "precondition": "C2", "warm_start no": "C8", "update_every": "C1", "algorithm 1": "C5",
          "cut-off": "C3", "taper": "C4", "clumps_only": "C6", "rigid_clumps": "C9", "rotation": "C7", "shell": "k",
          "tensor oseen": "gold", "ranks": "m", "far_field_tolerance": "C5"}
MARKER = {"ranks": "^"}
# Total drag of 6^3 touching spheres over that of one, by the range of a taper: wendland, spherical
SCREENED = {10: (35.1852, 29.1094), 20: (16.2945, 14.6554), 40: (10.0487, 10.1139), 80: (8.1693, 8.6028)}


# --- scenes: positions, radii, velocities, molecules; lengths in radii ---------------------------------------------


def lattice(n=10):
    grid = np.array([(i, j, k) for i in range(n) for j in range(n) for k in range(n)], float)
    return 2.0 * grid, np.ones(n**3), np.zeros(n**3, int)


def flocs(count=50, m=20, side=34.7, seed=1):
    """Each sphere stuck to one before it; spheres of two flocs do not overlap."""
    rng = np.random.default_rng(seed)
    x = np.zeros((0, 3))
    while len(x) < count * m:
        new = np.zeros((m, 3))
        new[0] = rng.uniform(0, side, 3)
        for i in range(1, m):
            e = rng.normal(size=3)
            new[i] = new[rng.integers(i)] + rng.uniform(1.2, 1.9) * e / np.linalg.norm(e)
        if not len(x) or np.linalg.norm(new[:, None] - x[None], axis=2).min() > 2.0:
            x = np.vstack([x, new])
    return x, np.ones(len(x)), 1 + np.arange(len(x)) // m


def dilute(n, phi=0.02, seed=1):
    """Radii 0.5 to 2, evenly in the logarithm; no overlaps."""
    rng = np.random.default_rng(seed)
    a = np.exp(rng.uniform(np.log(0.5), np.log(2.0), n))
    side = (4 / 3 * np.pi * (a**3).sum() / phi)**(1 / 3)
    x = np.zeros((n, 3))
    for i in range(n):
        while True:
            x[i] = rng.uniform(0, side, 3)
            if i == 0 or (np.linalg.norm(x[:i] - x[i], axis=1) > a[:i] + a[i]).all():
                break
    return x, a, np.zeros(n, int)


def scenes(quick):
    """name: (spheres, one velocity for each clump?, words of the exact model, steps)"""
    n = 7 if quick else 10
    yield f"{n}^3 touching spheres", lattice(n), False, "cut_off_distance inf", STEPS
    k = 20 if quick else 50
    yield f"{k} flocs of 20", flocs(k, 20, 34.7 * (k / 50)**(1 / 3)), False, "cut_off_distance inf", STEPS
    m = 400 if quick else 1000
    yield f"dilute cloud of {m}", dilute(m), False, "cut_off_distance inf", STEPS
    yield f"{k} rigid clumps of 20", flocs(k, 20, 34.7 * (k / 50)**(1 / 3), seed=2), True, "clumps_only yes", STEPS
    if not quick:
        yield "cloud of 10 000", dilute(10000, 0.05), False, "cut_off_distance inf", 5


def settings(exact, has_clumps, rigid, n, quick, radius=1.0):
    """(family, words, is it a finer model, which no error of this one judges?) of a scene; radius: of its spheres, the
    unit of cut-offs"""
    two = f"{exact} algorithm 2 relative_tolerance"
    for tolerance in ("1e-1", "1e-2", "1e-3") + (() if quick else ("1e-4",)) + ("1e-6",):
        yield "tolerance", f"{two} {tolerance}", False
    for how in ("none", "clump") if has_clumps else ("none", "sparse"):
        if exact.startswith("cut_off") or how != "sparse":
            for tolerance in ("1e-3", "1e-6"):
                yield "precondition", f"{two} {tolerance} precondition {how}", False
    yield "warm_start no", f"{two} 1e-3 warm_start no", False
    for every in (5, 20):
        yield "update_every", f"{two} 1e-3 update_every {every}", False
    yield "algorithm 1", f"{exact} algorithm 1 strict relative_tolerance 1e-3", False
    if rigid:
        yield "rigid_clumps", "clumps_only yes rigid_clumps yes", False
        yield "shell", "clumps_only yes rigid_clumps yes shell 12", True
    else:
        yield "cut-off", f"cut_off_distance {1e-6 * radius:g}", False
        yield "cut-off", f"cut_off_distance {8 * radius:g} algorithm 2 relative_tolerance 1e-3", False
        for taper in ("wendland", "spherical"):
            for R in (10, 40) if quick else (10, 20, 40):
                words = f"cut_off_distance {R * radius:g} taper {taper} algorithm 2 relative_tolerance 1e-3"
                yield "taper", words, False
        if has_clumps:
            yield "clumps_only", "clumps_only yes algorithm 2 relative_tolerance 1e-3", False
    yield "tensor oseen", f"{two} 1e-3 tensor oseen", False
    if n <= 1000:
        yield "rotation", f"{two} 1e-3 rotation yes", True


# --- one run --------------------------------------------------------------------------------------------------------


def write_data(path, x, a, v, molecule, side=None):
    """In the periodic box from 0 to side, or with room around them"""
    lo, hi = (np.zeros(3), np.full(3, side)) if side else (x.min(axis=0) - 10.0 * a.max(),
                                                           x.max(axis=0) + 10.0 * a.max())
    with open(path, "w") as out:
        out.write(f"spheres\n\n{len(x)} atoms\n0 bonds\n1 atom types\n1 bond types\n\n")
        for d, c in enumerate("xyz"):
            out.write(f"{float(lo[d]):.17g} {float(hi[d]):.17g} {c}lo {c}hi\n")
        out.write("\nAtoms\n\n")
        for i, (r, radius, m) in enumerate(zip(x.tolist(), a.tolist(), molecule.tolist())):
            out.write(f"{i + 1} 1 {r[0]:.17g} {r[1]:.17g} {r[2]:.17g} {2 * radius:.17g} 1.0 {m}\n")
        out.write("\nVelocities\n\n")
        for i, u in enumerate(v.tolist()):
            out.write(f"{i + 1} {u[0]:.17g} {u[1]:.17g} {u[2]:.17g} 0 0 0\n")


class Scene:
    """A data file, and what a rank cannot tell from its own spheres: the time step in which they move by MOVE radii;
    whether they are at rest, so that they fall; how far ghosts must reach for a clump to be seen whole."""

    def __init__(self, data, dt=0.0, rest=False, ghosts=0.0, boundary="f f f"):
        self.data, self.dt, self.rest, self.ghosts, self.boundary = data, dt, rest, ghosts, boundary

    def look(self):
        lmp = self.open()
        self.n = n = lmp.extract_global("nlocal")
        if n == 0:
            sys.exit(f"run.py: no atoms in {self.data}")
        a, v, x = (lmp.numpy.extract_atom(name)[:n] for name in ("radius", "v", "x"))
        clump = lmp.numpy.extract_atom("molecule")[:n].ravel()
        self.rest, self.radius = not np.abs(v).any(), float(a.mean())
        self.dt = float(MOVE * self.radius / (1.0 if self.rest else np.linalg.norm(v, axis=1).mean()))
        self.ghosts = float(max(np.linalg.norm(np.ptp(x[clump == k], axis=0)) for k in np.unique(clump)) + 4 * a.max())
        lmp.close()
        return self

    def open(self):
        lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
        for line in ["units lj", "atom_style hybrid sphere bond", f"boundary {self.boundary}", "atom_modify map array",
                     "comm_modify mode single", "plugin load stokesdynplugin.so", f"read_data {self.data}"]:
            lmp.command(line)
        if self.rest:
            lmp.command("velocity all set 0 0 -1")
        return lmp

    def words(self):
        return [str(self.data), repr(float(self.dt)), "rest" if self.rest else "moving", repr(float(self.ghosts)),
                self.boundary]


class Answer:
    """Forces, total drag and dissipation at the last but one step, CPU time per step; refused: the error of LAMMPS
    instead."""

    def __init__(self, parts):
        self.refused = next((part["refused"] for part in parts if part["refused"]), None)
        if self.refused:
            return
        joined = {key: np.concatenate([part[key] for part in parts]) for key in ("id", "F", "v")}
        self.F = joined["F"][np.argsort(joined["id"])]
        mean = joined["v"].mean(axis=0)
        self.drag = -self.F.sum(axis=0) @ mean / np.linalg.norm(mean) if mean.any() else 0.0
        self.dissipation, self.iterations = parts[0]["dissipation"], parts[0]["iterations"]
        self.time = max(part["time"] for part in parts)     # a rank that waits spends time, too

    def errors(self, reference):
        force = np.linalg.norm(self.F - reference.F) / np.linalg.norm(reference.F)
        # of the velocity that a given weight brings
        drag = abs(reference.drag / self.drag - 1.0) if self.drag else 0.0
        return force, drag, abs(self.dissipation / reference.dissipation - 1.0)


def run(scene, words, steps, end=lammps.close):
    """This rank's part of an answer."""
    lmp, part = scene.open(), {"refused": None}
    try:
        for line in [f"pair_style stokes_dynamics visc {VISC} max_iter 1000 {words}", "pair_coeff * *",
                     "fix drag all stokes_dynamics apply no", "fix move all nve", f"timestep {scene.dt:.17g}",
                     "thermo 1000000"] + [f"comm_modify cutoff {scene.ghosts:.17g}"] * ("clumps_only" in words) + [
                         "run 0 post no"]:
            lmp.command(line)
        began = time.process_time()
        lmp.command(f"run {steps - 1} pre no post no")
        spent = time.process_time() - began
        n = lmp.extract_global("nlocal")
        part |= {"id": lmp.numpy.extract_atom("id")[:n].ravel().copy(), "v": lmp.numpy.extract_atom("v")[:n].copy(),
                 "F": np.array(lmp.numpy.extract_fix("drag", 1, 2))[:n, 0:3].copy(),
                 "dissipation": lmp.extract_fix("drag", 0, 0), "iterations": lmp.extract_fix("drag", 0, 1, nrow=3)}
        began = time.process_time()
        lmp.command("run 1 pre no post no")
        part["time"] = (spent + time.process_time() - began) / steps
    except Exception as e:
        text = " ".join(str(e).split())
        part["refused"] = ("diverges" if "diverged" in text else "not definite" if "positive definit" in text else
                           text.removeprefix("ERROR: Pair style stokes_dynamics: "))
    end(lmp)
    return part


def solve(scene, words, steps, ranks=1):
    if ranks == 1:
        return Answer([run(scene, words, steps)])
    with tempfile.TemporaryDirectory() as folder:
        command = ["mpirun", "-np", str(ranks), sys.executable, __file__,
                   "--rank-of", folder, words, str(steps), *scene.words()]
        # The copy that python made of its environment at the start: without what MPI has put there for this process
        # since.
        ended = subprocess.run(command, env=dict(os.environ), capture_output=True, text=True)
        if ended.returncode:
            sys.exit(f"run.py: {' '.join(command)}:\n{ended.stdout}{ended.stderr}")
        parts = [np.load(path, allow_pickle=True) for path in sorted(pathlib.Path(folder).glob("*.npz"))]
        return Answer([{key: part[key][()] for key in part} for part in parts])


def rank_of(folder, words, steps, data, dt, rest, ghosts, boundary):
    """One rank of solve()."""
    part = run(Scene(data, float(dt), rest == "rest", float(ghosts), boundary), words, int(steps), lammps.finalize)
    # Open MPI, MPICH
    me = next(os.environ[name] for name in ("OMPI_COMM_WORLD_RANK", "PMI_RANK") if name in os.environ)
    np.savez(pathlib.Path(folder) / me, **part)


class Report:
    """Prints, and keeps the text for the log."""

    def __init__(self):
        self.lines = []

    def __call__(self, line=""):
        print(line, flush=True)
        self.lines.append(line)


def front(points):
    """Those of (error, time, ...) that no other beats in both, by falling error."""
    best, kept = np.inf, []
    for p in sorted(points, key=lambda p: (p[0], p[1])):
        if p[1] < best:
            best = p[1]
            kept.append(p)
    return kept


def measure(say, name, data, exact, steps, options, wanted, ranks, boundary="f f f",
            reference_words="relative_tolerance 1e-10"):
    scene = Scene(data, boundary=boundary).look()
    # Solved at the beginning and at the step where forces are compared.
    reference = solve(scene, f"{exact} algorithm 2 {reference_words} update_every {steps - 1}", steps)
    if reference.refused:
        sys.exit(f"run.py: {name}: no reference: {reference.refused}")
    say(f"\n{name}: {scene.n} spheres; reference: {exact}, {reference_words}")
    say(f"  {'ms/step':>8} {'force':>8} {'settling':>8} {'dissip.':>8} {'its':>4}   setting")
    points, refused = [], {}

    def row(family, words, other, on=1):
        answer = solve(scene, words, steps, on)
        if answer.refused:
            say(f"  {'-':>8} {answer.refused:<35}   {words}")
            refused[words] = answer.refused
            return
        errors = answer.errors(reference)
        say("  {:8.3f} {:8.1e} {:8.1e} {:8.1e} {:4.0f}   {}".format(
            1e3 * answer.time, *errors, answer.iterations,
            words + (f" ({on} ranks)" if on > 1 else " *" if other else "")))
        points.append((max(errors), 1e3 * answer.time, words, family, other))

    for option in options:
        row(*option)
    good = [p for p in points if p[0] <= wanted and not p[4]]
    if good:
        best = min(good, key=lambda p: p[1])
        say(f"  cheapest with all errors <= {wanted:g}: {best[1]:.3f} ms per step, error {best[0]:.1e}\n    {best[2]}")
        if ranks > 1:
            row("ranks", best[2], True, ranks)
    else:
        say(f"  no setting has all errors <= {wanted:g}")
    return points, refused


def draw(path, results, wanted):
    columns = min(3, len(results) + 1)      # the last panel is the legend
    rows = -(-(len(results) + 1) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(5.2 * columns, 4.4 * rows), squeeze=False,
                                constrained_layout=True)
    seen = {}
    for axis, (name, points, _) in zip(axes.flat, results):
        for error, ms, _, family, other in points:
            seen[family] = axis.scatter(max(error, FLOOR), ms, color=FAMILY[family], s=36, zorder=3,
                                        marker=MARKER.get(family, "x" if other else "o"))
        line = front([(max(p[0], FLOOR), p[1]) for p in points if not p[4]])
        x, y = zip(*line)
        axis.step(x, y, where="post", color="0.5", zorder=1)
        axis.axvline(wanted, color="0.7", linestyle=":", zorder=0)
        axis.set(xscale="log", yscale="log", title=name, xlabel="largest of the three errors")
        axis.grid(alpha=0.3)
    for axis in axes[:, 0]:
        axis.set_ylabel("CPU time, ms per step")
    for axis in axes.flat[len(results):]:
        axis.axis("off")
    handles = [(seen[f], f) for f in FAMILY if f in seen]
    axes.flat[len(results)].legend(*zip(*handles), loc="center", title="o the model    x a finer model    ^ more ranks")
    figure.savefig(path, dpi=90)


def measure_large(say, folder, quick, wanted, ranks):
    results = []
    for name, (x, a, molecule), side, reference, options in large.scenes(quick):
        v = np.array([0.0, 0.0, -1.0]) + 0.2 * np.random.default_rng(7).normal(size=x.shape)
        data = folder / "large.data"
        write_data(data, x, a, v, molecule, side)
        results.append((name, *measure(say, name, data, large.EXACT, large.STEPS, options, wanted, ranks,
                                       "p p p" if side else "f f f", reference)))
    return results


# --- what a taper screens -------------------------------------------------------------------------------------------


def screening(say, folder):
    x, a, molecule = lattice(6)
    v = np.tile([0.0, 0.0, -1.0], (len(x), 1))
    data = folder / "lattice.data"
    write_data(data, x, a, v, molecule)

    scene = Scene(data).look()

    def drag(words):
        return solve(scene, f"{words} algorithm 2 relative_tolerance 1e-9", 2).drag / (6 * np.pi * VISC)

    screened = {"exact": drag("cut_off_distance inf")}
    exact = screened["exact"]
    say(f"\nTotal drag of 6^3 touching spheres over that of one: {exact:.6f}")
    say(f"  {'range, radii':>12} {'wendland':>10} {'times':>7} {'spherical':>10} {'times':>7}")
    for R in (10, 20, 40, 80):
        w, s = screened[R] = [drag(f"cut_off_distance {R} taper {t}") for t in ("wendland", "spherical")]
        say(f"  {R:12d} {w:10.4f} {w / exact:7.3f} {s:10.4f} {s / exact:7.3f}")
    return screened


# --- what must hold -------------------------------------------------------------------------------------------------


def check_screening(c, screened):
    c.near("drag of 6^3 touching spheres over that of one", screened["exact"], 7.482203, 1e-6)
    for R, values in SCREENED.items():
        for taper, value, wanted in zip(("wendland", "spherical"), screened[R], values):
            c.near(f"the same, {taper} {R}", value, wanted, 1e-4)


def check_scene(c, name, points, refused, wanted):
    """What the README says of all scenes. The reference is solved to 1e-10, so that an error below 1e-8 says little."""
    def words(point):
        return point[2].split()

    for point in points:
        error, _, setting, family, _ = point
        if family in ("tolerance", "precondition", "warm_start no"):
            tolerance = float(words(point)[words(point).index("relative_tolerance") + 1])
            alone, plain = "rigid" in name, "none" in words(point)      # 20 and 6 times, 150 and 29 have been seen
            times = (300 if plain else 40) if alone else 40 if plain else 8
            c.below(f"{name}: error over tolerance, {setting}", error / max(tolerance, 1e-8), times)
        elif family in ("cut-off", "taper") or "clumps_only" in words(point) and "rigid" not in name:
            c.within(f"{name}: error, {setting}", error, wanted, 10.0)
        elif family == "rigid_clumps":
            c.below(f"{name}: error, {setting}", error, 1e-9)
        elif family == "tensor oseen":
            c.within(f"{name}: error, {setting}", error, 0.05, 0.5)
    c.holds(f"{name}: algorithm 1 diverges",
            any("algorithm 2" not in key and text == "diverges" for key, text in refused.items()))
    touching = "dilute" not in name and "cloud" not in name
    for what, must in (("tensor oseen", touching), ("cut_off_distance 8 ", "touching" in name or "flocs" in name)):
        if must:
            c.holds(f"{name}: {what.strip()} is not definite",
                    any(what in key and text == "not definite" for key, text in refused.items()))
    c.holds(f"{name}: a setting has all errors below {wanted:g}", any(p[0] <= wanted and not p[4] for p in points))
    times = {p[2]: p[1] for p in points}
    warm = next((key for key in times if "relative_tolerance 1e-3 warm_start no" in key), None)
    if warm:
        c.below(f"{name}: time of a step over that without warm start",
                times[warm.replace(" warm_start no", "")] / times[warm], 0.8)


def read_arguments():
    options = argparse.ArgumentParser(description="Time per step against error, for many settings of stokes_dynamics.")
    options.add_argument("--data", help="data file of atom_style hybrid sphere bond, any units; all at rest: they fall")
    options.add_argument("--clumps", action="store_true",
                         help="with --data: the clumps are rigid and do not see each other")
    options.add_argument("--quick", action="store_true")
    options.add_argument("--large", action="store_true")
    options.add_argument("--error", type=float, default=1e-2)
    options.add_argument("--ranks", type=int, default=min(4, len(os.sched_getaffinity(0))))
    options.add_argument("--out", default=RESULTS / "speed_error")
    options.add_argument("--screening", action="store_true")
    options.add_argument("--update", action="store_true")
    given = options.parse_args()
    if not given.error > 0.0:
        sys.exit(f"run.py: --error {given.error} must be > 0")
    if given.ranks < 1:
        sys.exit(f"run.py: --ranks {given.ranks} must be > 0")
    return given


def measure_data(say, given):
    data = pathlib.Path(given.data).resolve()
    if not data.is_file():
        sys.exit(f"run.py: --data {given.data}: there is no such file")
    exact = "clumps_only yes" if given.clumps else "cut_off_distance inf"
    kinds = settings(exact, given.clumps, given.clumps, 1000, given.quick, Scene(data).look().radius)
    return [(data.name, *measure(say, data.name, data, exact, STEPS, kinds, given.error, given.ranks))]


def measure_scenes(say, folder, given):
    results = []
    for name, (x, a, molecule), rigid, exact, steps in scenes(given.quick):
        rng = np.random.default_rng(7)
        own = rng.normal(size=(len(x) + 1, 3))     # of each sphere, or of each clump
        v = np.array([0.0, 0.0, -1.0]) + 0.2 * (own[molecule] if rigid else own[:len(x)])
        data = folder / "scene.data"
        write_data(data, x, a, v, molecule)
        kinds = list(settings(exact, molecule.any(), rigid, len(x), given.quick))
        if len(x) > 2000:       # seconds per step: only what may be worth it
            kinds = [k for k in kinds if k[0] == "cut-off" or not any(w in k[1] for w in
                     (" 1e-6", "warm_start no", " 40 ", "update_every 20"))]
        results.append((name, *measure(say, name, data, exact, steps, kinds, given.error, given.ranks)))
    return results


def main():
    if sys.argv[1:2] == ["--rank-of"]:
        rank_of(*sys.argv[2:])
        return
    given = read_arguments()
    folder = pathlib.Path(given.out).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    say, c = Report(), Checks()
    if given.screening:
        check_screening(c, screening(say, folder))
        sys.exit(c.finish())
    kept = "large" if given.large else "speed_error"     # names of picture and log
    if given.large:
        results = measure_large(say, folder, given.quick, given.error, given.ranks)
    elif given.data:
        results = measure_data(say, given)
    else:
        results = measure_scenes(say, folder, given)
        screened = screening(say, folder)
    draw(folder / f"{kept}.png", results, given.error)
    (folder / f"{kept}.txt").write_text("\n".join(say.lines) + "\n")
    say(f"\npicture: {folder / kept}.png")
    if given.update:
        for name in (f"{kept}.png", f"{kept}.txt"):
            shutil.copy(folder / name, HERE)
    if given.data:
        return
    print()
    for name, points, refused in results:
        if given.large:
            large.check(c, name, points, given.error)
        else:
            check_scene(c, name, points, refused, given.error)
    if not given.large:
        check_screening(c, screened)
    sys.exit(c.finish())


if __name__ == "__main__":
    main()
