#!/usr/bin/env python3
"""Falls the twelve clumps and straight chains with in.sedimentation and compares their settling velocities.

    run.py --out DIR    writes tables and pictures into DIR (default: build/examples/sedimentation)
    run.py --update     also refreshes the pictures, the logs and the table of README.md in this folder

Every velocity is compared with two values:
  model   the Rotne-Prager system of the spheres as they stand at the end of the run, solved here densely by numpy: what
          pair_style stokes_dynamics must give
  exact   Stokes flow around the clump (no slip on its surface), data/clusters_exact.csv and data/chains_exact.csv: what
          the model approximates
The ladder then repeats the twelve clumps with better models (torques, shells of 12, 42 and 162 points per sphere) and
compares with exact, and with what the clump's own 6x6 resistance says. Ends with a line ok or MISSED for each figure of
the README, and exits with 1 when one is missed.
"""
import concurrent.futures
import os
import pathlib
import shutil
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from rigid import rigid_velocities, rotation_between  # noqa: E402
from runs import np, plt, TOP, finished, need, open_axes, options, read_table  # noqa: E402

# As in in.sedimentation; lengths below are in radii, velocities in those of a lone sphere.
A, RHO, RHOF, ETA, G = 50e-6, 2500.0, 970.0, 0.97, 9.81
U0 = 2 * (RHO - RHOF) * G * A**2 / (9 * ETA)

VELOCITY_LIMIT = 1e-6               # relative, against the model
CLUMP_BAND = (-11.0, 0.0)           # per cent, drag against exact: the model is a lower bound of the drag
CHAIN_BAND = (-5.0, 0.0)
SHELL_LIMIT = {12: 0.6, 42: 0.35, 162: 0.15}        # per cent, velocity against exact
OWN_LIMIT = 1e-6                    # relative, velocity against the clump's own 6x6 resistance
# The ladder of the README: error of the drag against exact of the twelve clumps, worst and mean, per cent
LADDER_ERRORS = {"1": (9.26, 6.07), "torque": (3.05, 2.43), "12": (0.10, 0.04), "42": (0.17, 0.11), "162": (0.06, 0.04)}

SOLVED = "algorithm 2 relative_tolerance 1e-10"
# Steps of the ladder: what it is called, and the words of the pair style
LADDER = {"1": SOLVED, "torque": "rotation yes " + SOLVED, "12": "rigid_clumps yes shell 12",
          "42": "rigid_clumps yes shell 42", "162": "rigid_clumps yes shell 162"}
# How its time is measured: the drag alone of each sphere, then both ways to come to the same answer
TIMED = {"Stokes drag of each sphere": "cut_off_distance 9e-5",
         "1, solved every step": "algorithm 2 relative_tolerance 1e-4", "1, rigid_clumps": "rigid_clumps yes",
         "torque, solved every step": "rotation yes algorithm 2 relative_tolerance 1e-4",
         "torque, rigid_clumps": "rotation yes rigid_clumps yes", "shell 12, rigid_clumps": LADDER["12"],
         "shell 42, rigid_clumps": LADDER["42"], "shell 162, rigid_clumps": LADDER["162"]}
TIMED_CLUMP, COPIES, TIMED_STEPS = "cube8", 6, 300


GEOMETRY = {}
for row in read_table(HERE / "data" / "cluster_geometry.csv"):
    GEOMETRY.setdefault(row["name"], []).append([float(row[k]) for k in "xyz"])
GEOMETRY = {name: np.array(x) for name, x in GEOMETRY.items()}
CLUMP_EXACT = {row["name"]: np.array([[float(row[f"R{i}{j}"]) for j in range(1, 7)] for i in range(1, 7)]) / (6 * np.pi)
               for row in read_table(HERE / "data" / "clusters_exact.csv")}
CHAIN_EXACT = {int(row["N"]): (float(row["Fpar"]), float(row["Fperp"]))
               for row in read_table(HERE / "data" / "chains_exact.csv")}
DRIFT_MODEL = {(int(row["N"]), float(row["angle_deg"])): float(row["drift_deg_model"])
               for row in read_table(HERE / "data" / "drift.csv")}


# --- the two values to compare with -------------------------------------------------------------------------------


def rotne_prager(x):
    """[3N x 3N] mobility of unit spheres that do not overlap, in units of 1/(6 pi eta a) (Rotne & Prager 1969)."""
    n = len(x)
    M = np.eye(3 * n)
    for i in range(n):
        for j in range(n):
            if i != j:
                r = x[i] - x[j]
                s = np.linalg.norm(r)
                e = np.outer(r, r) / s**2
                M[3 * i:3 * i + 3, 3 * j:3 * j + 3] = 3 / (4 * s) * (np.eye(3) + e) + (np.eye(3) - 3 * e) / (2 * s**3)
    return M


def model_resistance(x):
    """[6 x 6] resistance of the clump about the origin in the model: spheres that take no torque."""
    K = rigid_velocities(x)
    return K.T @ np.linalg.solve(rotne_prager(x), K)


def settle(R, weight):
    """U, W of a body of resistance R under a force and no torque. A straight chain of torque-free spheres has no
    resistance to spin about its axis, hence the pseudo-inverse: no spin there."""
    V = np.linalg.pinv(R, rcond=1e-10) @ np.concatenate([weight, np.zeros(3)])
    return V[:3], V[3:]


def exact_velocities(case, turn):
    """Exact U, W of the clump turned by the matrix turn."""
    weight = np.array([0.0, 0.0, -case.n])
    if case.clump == "chain":
        axis = turn[:, 2]
        par, perp = CHAIN_EXACT[case.n]
        along = axis * (axis @ weight)
        return along / par + (weight - along) / perp, np.zeros(3)
    U, W = settle(CLUMP_EXACT[case.clump], turn.T @ weight)
    return turn @ U, turn @ W


def drift_angle(U):
    return np.degrees(np.arctan2(np.hypot(U[0], U[1]), -U[2]))


def chain_drift(par, perp, angle):
    """Drift angle of a body with these drags along and across its axis, degrees."""
    s, c = np.sin(np.radians(angle)), np.cos(np.radians(angle))
    return np.degrees(np.arctan2((1 / par - 1 / perp) * s * c, c * c / par + s * s / perp))


def steepest(par, perp):
    """Angle of the axis at which the drift is largest, degrees."""
    return np.degrees(np.arctan(np.sqrt(perp / par)))


# --- one run --------------------------------------------------------------------------------------------------------


def execute(command):
    return finished("sedimentation", command, HERE)


class Case:
    """A run of in.sedimentation and what came of it."""

    def __init__(self, clump, angle, n=None, ranks=1, radius=A, steps=400, picture=False, level="1"):
        self.level = level
        self.clump, self.angle, self.ranks = clump, angle, ranks
        self.radius, self.steps, self.picture = radius, steps, picture
        self.shape = GEOMETRY[clump] if clump != "chain" else np.array([[0, 0, 2.0 * i - n + 1] for i in range(n)])
        self.n = len(self.shape)
        self.label = f"chain of {n}" if clump == "chain" else clump
        self.title = self.label + (f", {ranks} ranks" if ranks > 1 else "") + ("" if radius == A else ", 1 mm beads")
        self.tag = f"{clump}{n or ''}_{angle:.4g}_{ranks}" + ("" if radius == A else "_long")
        self.tag += "" if level == "1" else f"_{level}"

    def run(self, out):
        self.image, state, log = out / f"{self.tag}.ppm", out / f"{self.tag}.state", out / f"{self.tag}.log"
        # stdbuf: an error message must leave LAMMPS before it aborts.
        command = ["stdbuf", "-oL", "lmp", "-in", "in.sedimentation", "-log", str(log), "-var", "clump", self.clump,
                   "-var", "angle", f"{self.angle:.17g}", "-var", "n", str(self.n if self.clump == "chain" else 10),
                   "-var", "steps", str(self.steps), "-var", "a", f"{self.radius:.17g}", "-var", "state", str(state),
                   "-var", "model", LADDER[self.level]]
        if self.ranks > 1:
            command = ["mpirun", "-np", str(self.ranks)] + command
        if self.picture:
            command += ["-var", "image", str(self.image)]
        execute(command)
        spheres = np.loadtxt(state, skiprows=9, ndmin=2)
        if spheres.shape != (self.n, 10) or not np.isfinite(spheres).all():
            sys.exit(f"sedimentation: {state} does not hold {self.n} spheres with finite numbers")
        self.evaluate(spheres)
        return self

    def evaluate(self, spheres):
        unit = U0 * (self.radius / A)**2
        x, v = spheres[:, 4:7] / self.radius, spheres[:, 7:10] / unit
        self.fallen = -x[:, 2].mean()
        x = x - x.mean(0)                                        # equal masses
        V = np.linalg.lstsq(rigid_velocities(x), v.ravel(), rcond=1e-10)[0]
        self.U, self.W = V[:3], V[3:]
        self.turn = rotation_between(self.shape, x)
        weight = np.array([0.0, 0.0, -self.n])
        self.U_model, self.W_model = settle(model_resistance(x), weight)
        self.U_exact, self.W_exact = exact_velocities(self, self.turn)
        self.model_error = np.linalg.norm(self.U - self.U_model) / np.linalg.norm(self.U_model)
        self.drag, self.drag_model, self.drag_exact = (self.n / -U[2] for U in (self.U, self.U_model, self.U_exact))
        self.drag_error = 100 * (self.drag / self.drag_exact - 1)
        self.exact_error = 100 * np.linalg.norm(self.U - self.U_exact) / np.linalg.norm(self.U_exact)
        self.drift, self.drift_exact = drift_angle(self.U), drift_angle(self.U_exact)
        self.spin_error = np.linalg.norm(self.W - self.W_model)   # in U0/a
        axis = self.turn[:, 2]
        self.tilt = np.degrees(np.arctan2(np.hypot(axis[0], axis[1]), axis[2]))


def cases():
    doublet, ten = [model_drags(n) for n in (2, 10)]
    list_ = [Case(name, angle, picture=angle == 45) for name in GEOMETRY for angle in (0, 45, 90)]
    list_ += [Case("chain", angle, n) for n in (2, 3, 5, 10, 20, 50) for angle in (0, 45, 90)]
    list_ += [Case("doublet", angle) for angle in (15, 30, steepest(*doublet), 60, 75)]
    list_ += [Case("chain", angle, 10) for angle in (15, 30, steepest(*ten), 60, 75)]
    # Beads of 1 mm fall several radii within some thousand steps; the velocity cannot tell whether the axis turns
    # slowly.
    list_ += [Case("doublet", 45, radius=10 * A, steps=20000), Case("chain", 45, 10, radius=10 * A, steps=8000)]
    list_ += [Case("helix4_chiral", 0, ranks=2), Case("chain", 45, 50, ranks=2)]
    return list_


def ladder_cases():
    list_ = [Case(name, 45, level=level) for level in list(LADDER)[1:] for name in GEOMETRY]
    return list_ + [Case("helix4_chiral", 0, level="42")]


def own_resistance(out, name):
    """[6 x 6] resistance of a clump with shell 42 about its centroid, as the plugin gives it in six rigid motions."""
    motion = out / f"{name}_42.motion"
    execute(["stdbuf", "-oL", "lmp", "-in", "in.six_motions", "-log", "none", "-var", "clump", f"clumps/{name}.mol",
             "-var", "model", LADDER["42"], "-var", "out", str(motion)])
    R = np.zeros((6, 6))
    for mode in range(6):
        rows = np.loadtxt(f"{motion}.{mode + 1}", skiprows=9, ndmin=2)
        x, F, T = rows[:, 1:4], rows[:, 4:7], rows[:, 7:10]
        R[:3, mode], R[3:, mode] = -F.sum(0), -(T + np.cross(x - x.mean(0), F)).sum(0)
    return R / (6 * np.pi)


def own_errors(case, R):
    """Velocity (relative) and angular velocity (in U0/a) of a run against what follows from the resistance R of its
    clump."""
    U, W = settle(R, case.turn.T @ np.array([0.0, 0.0, -case.n]))
    return np.linalg.norm(case.turn.T @ case.U - U) / np.linalg.norm(U), np.linalg.norm(case.turn.T @ case.W - W)


def measure(out, words):
    """Processor time of the pair style per sphere and step, ns; time of the solve of the shape, s."""
    log = out / "timing.log"
    execute(["stdbuf", "-oL", "lmp", "-in", "in.sedimentation", "-log", str(log), "-var", "clump", TIMED_CLUMP,
             "-var", "angle", "45", "-var", "copies", str(COPIES), "-var", "steps", str(TIMED_STEPS), "-var", "model",
             words, "-var", "clumps_only", "no" if "cut_off_distance" in words else "yes"])
    text = log.read_text()
    section = next(line for line in text.splitlines() if line.startswith("Pair ")).split("|")
    seconds = float(section[2]) * float(section[5]) / 100
    solved = [float(line.split("solved in ")[1].split()[0]) for line in text.splitlines() if "solved in" in line]
    return seconds / (TIMED_STEPS * COPIES**3 * len(GEOMETRY[TIMED_CLUMP])) * 1e9, (solved or [0.0])[0]


def model_drags(n):
    """Drag of a chain along and across its axis in the model, in units of a lone sphere's."""
    R = model_resistance(np.array([[0, 0, 2.0 * i - n + 1] for i in range(n)]))
    return R[2, 2], R[0, 0]


# --- tables, pictures -----------------------------------------------------------------------------------------------

HEAD = ["clump", "N", "angle", "velocity", "model", "error %", "exact", "error %", "drag", "exact", "error %",
        "drift", "exact"]


def row(c):
    speed = [-U[2] * U0 * (c.radius / A)**2 * 1e6 for U in (c.U, c.U_model, c.U_exact)]
    rounding = "< 1e-11" if c.model_error < 1e-13 else f"{100 * c.model_error:.1e}"
    return [c.title, str(c.n), f"{c.angle:.4g}", f"{speed[0]:.3f}", f"{speed[1]:.3f}", rounding, f"{speed[2]:.3f}",
            f"{100 * (speed[0] / speed[2] - 1):+.2f}", f"{c.drag:.4f}", f"{c.drag_exact:.4f}", f"{c.drag_error:+.2f}",
            f"{c.drift:.4f}", f"{c.drift_exact:.4f}"]


def table(rows):
    width = [max(len(r[k]) for r in rows) for k in range(len(rows[0]))]
    text = ["| " + " | ".join([r[0].ljust(width[0])] + [c.rjust(w) for c, w in zip(r[1:], width[1:])]) + " |"
            for r in rows]
    text.insert(1, "|" + "|".join("-" * (w + 2) if k == 0 else "-" * (w + 1) + ":" for k, w in enumerate(width)) + "|")
    return "\n".join(text) + "\n"


def errors_of(level, done, ladder):
    runs = [c for c in done + ladder if (c.level, c.angle, c.ranks, c.radius) == (level, 45, 1, A) and
            c.clump != "chain"]
    return [abs(c.drag_error) for c in runs], [c.exact_error for c in runs]


def ladder_table(times, done, ladder):
    """Rows of text"""
    plain = next(iter(times.values()))[0]
    rows = [["model of a sphere", "drag: worst %", "mean %", "velocity: worst %", "ns per sphere and step",
             "times Stokes drag", "solved once in"]]
    for name, (time_, solved) in times.items():
        level = name.split(",")[0].replace("shell ", "")
        if level in LADDER:
            drag, velocity = errors_of(level, done, ladder)
            cells = [f"{max(drag):.2f}", f"{np.mean(drag):.2f}", f"{max(velocity):.2f}"]
        else:
            worst = [100 * (c.n / c.drag_exact - 1) for c in done if c.clump != "chain" and c.angle == 45 and
                     c.title == c.label]
            cells = [f"{max(worst):.0f}", f"{np.mean(worst):.0f}", ""]
        rows.append([name] + cells + [f"{time_:.0f}", f"{time_ / plain:.2f}", f"{solved:.2g} s" if solved else ""])
    return rows


def draw_ladder(times, done, ladder, path):
    open_axes()
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 4.8), gridspec_kw={"width_ratios": [1.25, 1]},
                                         constrained_layout=True)
    names = list(GEOMETRY)
    styles = {"1": ("o", "C3", "one point per sphere"), "torque": ("s", "C1", "point with torque"),
              "12": ("^", "C0", "shell 12"), "42": ("D", "C2", "shell 42"), "162": ("v", "C4", "shell 162")}
    for level, (marker, colour, label) in styles.items():
        errors, _ = errors_of(level, done, ladder)
        left.semilogy(range(len(names)), np.maximum(errors, 1e-3), marker, color=colour, ms=6, label=label)
    left.set_xticks(range(len(names)), [n.replace("_", " ") for n in names], rotation=50, ha="right",
                    rotation_mode="anchor")
    left.set_ylabel("error of the drag against exact, %")
    left.set_ylim(5e-3, 40)
    left.grid(axis="y", alpha=0.3)
    left.legend(fontsize=9, ncol=5, loc="upper center", columnspacing=0.7, handletextpad=0.0, borderpad=0.3)
    left.set_title("Twelve clumps falling at 45 degrees")
    for name, (time_, _) in times.items():
        level = name.split(",")[0].replace("shell ", "")
        if level not in LADDER:
            right.axvline(time_, color="0.5", lw=1, ls="--")
            right.text(time_ * 0.93, 0.045, "Stokes drag of each sphere", rotation=90, va="bottom", ha="right",
                       fontsize=9, color="0.4")
            continue
        errors, _ = errors_of(level, done, ladder)
        marker, colour, label = styles[level]
        rigid = "rigid_clumps" in name
        right.loglog(time_, max(errors), marker, color=colour, ms=9, mfc=colour if rigid else "white", mew=1.5)
        right.loglog([time_, time_], [np.mean(errors), max(errors)], "-", color=colour, lw=1)
        up = -12 if not rigid else -3 if level.isdigit() and level != "1" else 8    # clear of marks
        right.annotate(label if rigid else "solved every step", (time_, max(errors)), xytext=(9, up),
                       textcoords="offset points", fontsize=9)
    right.set_xlim(10, 2e4)
    right.set_ylim(0.03, 30)
    right.set_xlabel("time of the pair style, ns per sphere and step")
    right.set_ylabel("error of the drag: worst (mark) to mean, %")
    right.grid(alpha=0.3)
    right.set_title("Error against cost; filled: rigid_clumps yes")
    figure.savefig(path, dpi=100)
    plt.close(figure)


def check_ladder(c, done, ladder, own, times):
    for level, limit in SHELL_LIMIT.items():
        runs = [run for run in ladder if run.level == str(level) and run.angle == 45]
        worst = max(runs, key=lambda run: run.exact_error)
        c.below(f"shell {level}, {len(runs)} clumps: velocity against exact, worst ({worst.label}), %",
                worst.exact_error, limit)
    for level, (worst, mean) in LADDER_ERRORS.items():
        errors, _ = errors_of(level, done, ladder)
        c.holds(f"model {level}: every clump was run", len(errors) == len(GEOMETRY))
        c.near(f"model {level}: error of the drag, worst, %", max(errors), worst, 0.006)
        c.near(f"model {level}: error of the drag, mean, %", np.mean(errors), mean, 0.006)
    errors = {run.label: own_errors(run, own[run.clump]) for run in ladder if run.level == "42" and run.angle == 45}
    for k, what in enumerate(("velocity", "spin")):
        name = max(errors, key=lambda label: errors[label][k])
        c.below(f"shell 42: {what} against the clump's own 6x6 resistance, worst ({name})", errors[name][k], OWN_LIMIT)
    chiral = next(run for run in ladder if run.clump == "helix4_chiral" and run.angle == 0)
    c.below("shell 42: spin of the chiral clump against exact",
            np.linalg.norm(chiral.W - chiral.W_exact) / np.linalg.norm(chiral.W_exact), 0.02)
    c.near("shell 42: its spin, U0/a", np.linalg.norm(chiral.W), 0.03226, 1e-5)
    few, many = times["shell 12, rigid_clumps"][0], times["shell 162, rigid_clumps"][0]
    c.below("time of a step with shell 162 over that with shell 12", many / few, 1.25)


def draw(done, path):
    open_axes()
    figure, (left, right) = plt.subplots(1, 2, figsize=(12, 5), gridspec_kw={"width_ratios": [1.25, 1]},
                                         constrained_layout=True)

    # Drag against exact
    groups = list(GEOMETRY) + [f"chain of {n}" for n in (5, 10, 20, 50)]
    left.axhspan(*CLUMP_BAND, color="0.93", zorder=0)
    left.axhline(0, color="black", lw=1)
    left.text(len(groups) - 0.5, -0.15, "exact Stokes flow", ha="right", va="top", fontsize=9)
    left.text(len(groups) - 0.5, -10.9, "band that the run must keep to", ha="right", va="bottom", fontsize=9,
              color="0.4")
    for angle, marker, colour in ((0, "o", "C0"), (45, "s", "C1"), (90, "^", "C2")):
        points = [(groups.index(c.label), c.drag_error) for c in done
                  if c.label in groups and c.angle == angle and c.title == c.label]
        shift = (angle - 45) / 45 * 0.17
        left.plot([k + shift for k, _ in points], [e for _, e in points], marker, color=colour, ms=6, label=f"{angle}°")
    left.set_xticks(range(len(groups)), [g.replace("_", " ") for g in groups], rotation=50, ha="right",
                    rotation_mode="anchor")
    left.set_xlim(-0.6, len(groups) - 0.4)
    left.set_ylim(-11.6, 0.6)
    left.set_ylabel("drag of the falling clump against exact, %")
    left.legend(title="axis to gravity", loc="lower left", bbox_to_anchor=(0.0, 0.02), fontsize=9)
    left.set_title("Drag at terminal velocity")

    # Drift
    angles = np.linspace(0, 90, 181)
    for n, clump, colour in ((10, "chain", "C3"), (2, "doublet", "C0")):
        name = f"{'doublet' if n == 2 else 'chain of 10'}"
        right.plot(angles, chain_drift(*model_drags(n), angles), color=colour, lw=1.5,
                   label=f"{name}: model, closed form")
        right.plot(angles, chain_drift(*CHAIN_EXACT[n], angles), "--", color=colour, lw=1.2, label=f"{name}: exact")
        points = [(c.angle, c.drift) for c in done if c.clump == clump and c.n == n and c.title == c.label]
        right.plot(*zip(*points), "o", color=colour, ms=6, mec="black", mew=0.5, label=f"{name}: runs")
    right.set_xlabel("angle of the axis to gravity, degrees")
    right.set_ylabel("drift angle of the path, degrees")
    right.set_xlim(0, 90)
    right.set_ylim(0, 11.5)
    right.set_xticks(range(0, 91, 15))
    right.legend(fontsize=8.5, loc="upper left", ncol=2, columnspacing=1.2, handlelength=1.8)
    right.set_title("Tilted chains drift sideways")
    figure.savefig(path, dpi=110)
    plt.close(figure)


def contact_sheet(done, ladder, path):
    shown = [c for c in done if c.picture]
    shell = {(c.clump, c.angle): c.drag for c in ladder if c.level == "42"}
    figure, axes = plt.subplots(2, 6, figsize=(12, 4.7), constrained_layout=True)
    for c, ax in zip(shown, axes.flat):
        ax.imshow(plt.imread(c.image))
        ax.set_axis_off()
        ax.set_title(f"{c.label.replace('_', ' ')}\ndrag {shell[c.clump, c.angle]:.3f}, exact {c.drag_exact:.3f}",
                     fontsize=9.5)
    scale = plt.matplotlib.cm.ScalarMappable(plt.matplotlib.colors.Normalize(0, 0.7), "viridis")
    bar = figure.colorbar(scale, ax=axes, shrink=0.85, pad=0.01, extend="both")
    bar.set_label("drag of a sphere / drag of a lone sphere\nat the same velocity", fontsize=9.5)
    figure.savefig(path, dpi=80, pil_kwargs={"optimize": True})
    plt.close(figure)


# --- what must hold -------------------------------------------------------------------------------------------------


def check(c, done):
    def find(clump, angle, n=None, ranks=1, radius=A):
        return next(run for run in done if (run.clump, run.ranks, run.radius) == (clump, ranks, radius)
                    and abs(run.angle - angle) < 1e-9 and n in (None, run.n))

    def place(run):
        return f"{run.label} at {run.angle:.4g} degrees"

    worst = max(done, key=lambda run: run.model_error)
    c.below(f"velocity against the model, worst ({place(worst)})", worst.model_error, VELOCITY_LIMIT)
    worst = max(done, key=lambda run: run.spin_error)
    c.below(f"spin against the model, worst ({place(worst)}), U0/a", worst.spin_error, 1e-6)
    helix = find("helix4_chiral", 0)
    c.near("spin of the chiral clump, U0/a", np.linalg.norm(helix.W), 0.05795, 1e-5)
    c.holds("its sense is that of exact flow", helix.W @ helix.W_exact > 0)
    c.near("its drift, degrees", helix.drift, 2.65, 0.01)
    c.below("spin of all others, U0/a", max(np.linalg.norm(run.W) for run in done if run.clump != "helix4_chiral"),
            1e-8)
    for kind, band, (least, most) in (("clumps", CLUMP_BAND, (-9.26, -2.94)), ("chains", CHAIN_BAND, (-4.61, -1.75))):
        errors = [run.drag_error for run in done if (run.clump == "chain") == (kind == "chains")]
        c.within(f"drag of the {kind} against exact, lowest, %", min(errors), *band)
        c.within(f"drag of the {kind} against exact, highest, %", max(errors), *band)
        c.near(f"drag of the {kind} against exact, lowest as in the README, %", min(errors), least, 0.006)
        c.near(f"drag of the {kind} against exact, highest as in the README, %", max(errors), most, 0.006)
    drifts = [abs(run.drift - DRIFT_MODEL[run.n, run.angle]) for run in done if run.clump in ("chain", "doublet")
              and (run.n, run.angle) in DRIFT_MODEL]
    c.below(f"drift angle against {len(drifts)} values of drift.csv, worst, degrees", max(drifts), 1e-5)
    c.near("drift of the doublet at 45 degrees", find("doublet", 45).drift, 3.50353, 1e-4)
    angle = steepest(*model_drags(2))
    steep = find("doublet", angle)
    c.near(f"drift of the doublet at {angle:.2f} degrees", steep.drift, 3.5101, 0.01)
    c.holds("no doublet drifts more", all(run.drift <= steep.drift for run in done if run.clump == "doublet"))
    for run in done:
        if run.radius != A:
            c.below(f"{run.title}: turns while it falls, degrees", abs(run.tilt - run.angle), 1e-6)
            c.within(f"{run.title}: radii fallen", run.fallen, 2, 100)
        if run.ranks == 2:
            one = find(run.clump, run.angle, run.n)
            c.below(f"{run.title} against 1: velocity", np.linalg.norm(run.U - one.U) / np.linalg.norm(one.U), 1e-10)


def update_folder(out, done, ladder_rows):
    for name in ("sedimentation.png", "clumps.png", "ladder.png"):
        shutil.copy(out / name, HERE / name)
    for ranks in (1, 2):
        log = (out / f"helix4_chiral_0_{ranks}.log").read_text().replace(str(out) + "/", "").replace(str(TOP) + "/", "")
        (HERE / f"log.sedimentation.{ranks}").write_text(log)
    twice = ("chain of 2", "chain of 3")                          # these are doublet and trimer_line
    rows = [row(c) for c in done if c.angle == 45 and c.title == c.label and c.label not in twice]
    readme = HERE / "README.md"
    text = readme.read_text()
    for name, lines in (("table", table([HEAD] + rows)), ("ladder", table(ladder_rows))):
        begin, end = f"<!-- {name} of run.py -->\n", f"<!-- end of {name} -->"
        head, rest = text.split(begin)
        text = head + begin + lines + end + rest.split(end)[1]
    readme.write_text(text)


def main():
    given = options(__file__, __doc__)
    out = given.out
    need("lmp", "mpirun")

    start = time.time()
    todo = cases()
    done = []
    widths = (24, 3, 6, 9, 9, 8, 9, 8, 8, 8, 8, 8, 8)
    show = lambda cells: " ".join(c.ljust(w) if k == 0 else c.rjust(w) for k, (c, w) in enumerate(zip(cells, widths)))
    print(f"{'':8}" + show(HEAD), flush=True)
    ladder, own, times = [], {}, {}
    with concurrent.futures.ThreadPoolExecutor(max_workers=2 * min(4, os.cpu_count() or 1)) as pool:
        try:
            for k, case in enumerate(pool.map(lambda c: c.run(out), todo)):
                done.append(case)
                print(f"[{k + 1:2d}/{len(todo)}] " + show(row(case)), flush=True)
            print("\nthe ladder: the twelve clumps with torques and shells", flush=True)
            ladder.extend(pool.map(lambda c: c.run(out), ladder_cases()))
            own.update(zip(GEOMETRY, pool.map(lambda name: own_resistance(out, name), GEOMETRY)))
            print("[sedimentation] times of the models", flush=True)
            for _ in range(3):          # one at a time, in turns, so that a loaded machine slows all; the least counts
                for name, words in TIMED.items():
                    times[name] = min(times.get(name, (np.inf, 0.0)), measure(out, words))
        except SystemExit:
            pool.shutdown(cancel_futures=True)
            raise
    ladder_rows = ladder_table(times, done, ladder)
    print("\n" + table(ladder_rows))

    units = "velocities (downwards) in micrometres per second, drags in units of a lone sphere's, angles in degrees"
    (out / "table.md").write_text(units.capitalize() + ".\n\n" + table([HEAD] + [row(c) for c in done]))
    draw(done, out / "sedimentation.png")
    contact_sheet(done, ladder, out / "clumps.png")
    draw_ladder(times, done, ladder, out / "ladder.png")
    (out / "ladder.md").write_text(table(ladder_rows))
    if given.update:
        update_folder(out, done, ladder_rows)

    print(f"\n{len(done) + len(ladder) + len(own) + 3 * len(times)} runs in {time.time() - start:.0f} s\n"
          f"tables: {out / 'table.md'}, {out / 'ladder.md'}\npictures: "
          + ", ".join(str(out / name) for name in ("sedimentation.png", "clumps.png", "ladder.png")) + "\n")
    c = Checks()
    check(c, done)
    check_ladder(c, done, ladder, own, times)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
