#!/usr/bin/env python3
"""How good the guess is from which a warm solve starts: iterations a solve, and the error that the tolerance leaves.

    . build/env.sh; unittest/bench/warm_start.py

Settling cloud: examples/settling_cloud until time 0.3; error of its speed against the same run at relative_tolerance
1e-9, for spheres alone and clumps alone against what they must have. Clouds of 1000: spheres on a given path, 0.01
radii a step, whose velocities change by 1 % in some ten steps; error of the forces against a solve to 1e-10, the mean
of 60 steps."""
import os
import pathlib
import subprocess
import tempfile

from from_tests import np
from precondition_auto import dilute, falling
from system import Simulation, environment
from suspensions import A, flocs, loose_lattice

EXAMPLE = pathlib.Path(__file__).resolve().parents[2] / "examples" / "settling_cloud"
TETRAHEDRON = 2.462500      # speed of a lone clump in that of a sphere
STEPS = 60


def settle(interactions, tolerance="1e-3"):
    """Iterations a solve, speed at the end."""
    with tempfile.TemporaryDirectory() as folder:
        script = (EXAMPLE / "in.settling_cloud").read_text()
        head, last = script.rsplit("run             ", 1)
        count = "fix its all ave/time 1 ${steps} ${steps} c_drag[1] file its\n"
        with open(os.path.join(folder, "in"), "w") as out:
            out.write(head + count + "run             " + last)
        (pathlib.Path(folder) / "out").mkdir()
        subprocess.run(["cp", str(EXAMPLE / "tetrahedron.mol"), folder], check=True)
        variables = {"interactions": interactions, "images": "no", "time": "0.3", "tolerance": tolerance}
        words = [w for name, value in variables.items() for w in ("-var", name, value)]
        subprocess.run(["lmp", "-in", "in", "-log", "none", "-screen", "none", *words], cwd=folder, env=environment(),
                       check=True)
        its = np.loadtxt(os.path.join(folder, "its"), ndmin=2)[-1, 1]
        return its, np.loadtxt(os.path.join(folder, "out", f"{interactions}.curve"))[-1, 2]


def path(spheres, words):
    """Iterations of each solve and forces of each step."""
    with tempfile.TemporaryDirectory() as folder:
        sim = Simulation(folder, spheres, f"visc 1 cut_off_distance inf algorithm 2 max_iter 1000 {words}",
                         before_pair="fix move all nve", dt=0.01 * A / np.linalg.norm(spheres.v, axis=1).mean())
        sim.command("unfix drag")
        sim.command("fix drag all stokes_dynamics apply no")
        wave = np.random.default_rng(8).normal(size=spheres.v.shape)
        its, F = [], []
        for k in range(STEPS):
            sim.raw("v")[np.argsort(sim.ids())] = spheres.v * (1 + 0.01 * np.sin(0.3 * k) * wave)
            sim.run(1 if k else 0, "pre no post no" if k else "post no")
            its.append(sim.iterations)
            F.append(sim.drag)
        sim.close()
        return np.array(its[1:]), np.array(F[1:])


def main():
    print("settling cloud: iterations a solve, relative error of the speed")
    for interactions, wanted in (("none", 1.0), ("clump", TETRAHEDRON), ("all", None)):
        its, speed = settle(interactions)
        late = settle(interactions, "1e-9")[1]
        reached = f"   at {speed / wanted:.6f} of its end" if wanted else ""
        print(f"  {interactions:6} {its:6.2f}   {abs(speed / late - 1):.1e}" + reached, flush=True)
    print("clouds of 1000: iterations a solve, error of the forces")
    for name, spheres in (("phi 0.43", falling(loose_lattice(10))), ("phi 0.02", falling(dilute())),
                          ("50 flocs of 20", falling(flocs(50, 20, 34.7 * A)))):
        exact = path(spheres, "relative_tolerance 1e-10")[1]
        for tolerance in ("1e-2", "1e-3", "1e-6"):
            its, F = path(spheres, f"relative_tolerance {tolerance}")
            error = np.linalg.norm(F - exact, axis=(1, 2)) / np.linalg.norm(exact, axis=(1, 2))
            print(f"  {name:15} {tolerance:5} {its.mean():6.2f}   {error.mean():.1e}", flush=True)


if __name__ == "__main__":
    main()
