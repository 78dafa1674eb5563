#!/usr/bin/env python3
"""Runs both scenes of coupling.py on 1 and 2 ranks, compares them and draws the picture.

    run.py --out DIR    results go to DIR (default: build/examples/cfd_coupling)
    run.py --quick      all but two-way on one rank for the first 80 steps only
    run.py --update     also refreshes the logs and the picture in this folder

Ends with a line ok or MISSED for each figure of the README, and exits with 1 when one is missed.
"""
import pathlib
import shutil
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from checks import Checks  # noqa: E402
from runs import np, need, options  # noqa: E402
from plot import draw  # noqa: E402

RUNS = (("prescribed", "callback", 1), ("prescribed", "callback", 2),
        ("two-way", "callback", 1), ("two-way", "callback", 2), ("two-way", "loop", 1))
BALANCE = 1e-12
RANKS = 1e-8            # radii; the solver's tolerance of 1e-10, over a run
DRIVERS = 1e-12


def run(scene, driver, ranks, out, steps=None):
    """What it has left in its folder: tracks, curve, imbalance, drift. steps: None for all"""
    folder = out / f"{driver}.{ranks}"
    folder.mkdir(parents=True, exist_ok=True)
    result = folder / f"{scene}.npz"
    result.unlink(missing_ok=True)
    command = ["mpirun", "-np", str(ranks), sys.executable, str(HERE / "coupling.py"), scene, "--driver", driver,
               "--out", str(folder), "--log",
               str(folder / f"log.{scene}")] + ["--steps", str(steps)] * (steps is not None)
    start = time.time()
    print(f"[{scene}, {driver}, {ranks} rank{'s' if ranks > 1 else ''}]", end=" ", flush=True)
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    print(f"{time.time() - start:.0f} s", flush=True)
    for line in done.stdout.splitlines()[-2 if done.returncode == 0 else 0:]:
        print("  " + line)
    if not result.is_file():        # exit code 1 and a result: the balance is missed, which is said below
        sys.exit(f"{scene}, {driver}, {ranks} ranks: exit code {done.returncode}")
    return dict(np.load(result))


def main():
    given = options(__file__, __doc__, quick=False)
    out = given.out
    need("mpirun")

    results = {which: run(*which, out, 80 if given.quick and which != RUNS[2] else None) for which in RUNS}
    one = out / "callback.1"
    draw(one, one / "cfd_coupling.png")
    print(f"picture: {one / 'cfd_coupling.png'}\n")
    if given.update:
        shutil.copy(one / "cfd_coupling.png", HERE)
        for scene in ("prescribed", "two-way"):
            for ranks in (1, 2):
                shutil.copy(out / f"callback.{ranks}" / f"log.{scene}", HERE / f"log.cfd_coupling.{scene}.{ranks}")

    def distance(one, other):
        both = [results[which]["tracks"] for which in (one, other)]
        begun = min(map(len, both))
        return np.abs(both[0][:begun] - both[1][:begun]).max()

    c = Checks()
    for (scene, driver, ranks), result in results.items():
        name = f"{scene}, {driver}, {ranks} rank{'s' if ranks > 1 else ''}"
        c.below(f"{name}: force + momentum rate of the fluid", float(result["imbalance"]), BALANCE)
        c.below(f"{name}: momentum over the run", float(result["drift"]), BALANCE)
    c.below("prescribed: tracks of 2 ranks against 1, in radii", distance(RUNS[0], RUNS[1]), RANKS)
    c.below("two-way: tracks of 2 ranks against 1, in radii", distance(RUNS[2], RUNS[3]), RANKS)
    c.below("two-way: tracks of the loop against the callback, in radii", distance(RUNS[2], RUNS[4]), DRIVERS)
    time, chains, _, _, fluid = results[RUNS[2]]["curve"][:, :5].T
    c.near("two-way: momentum of the chains at the start", chains[0], 12000.0, 1.0)
    c.near("two-way: momentum of the chains at time 100", np.interp(100.0, time, chains), 8021.2, 0.1)
    c.near("two-way: momentum of the chains at the end", chains[-1], 6530.0, 5.0)
    c.near("two-way: momentum of the fluid at the end", fluid[-1], 5470.0, 5.0)
    return c.finish()


if __name__ == "__main__":
    sys.exit(main())
