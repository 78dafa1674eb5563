#!/usr/bin/env python3
"""Runs both scenes of coupling.py on 1 and 2 ranks, compares them and draws the picture.

    run.py [OUT]        results go to OUT (default: build/examples/cfd_coupling)
    run.py --update     also refreshes the logs and the picture in this folder

Exits with 1 and says which when a figure is missed.
"""
import pathlib
import shutil
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
from runs import np, need, TOP  # noqa: E402
from plot import draw  # noqa: E402

RUNS = (("prescribed", "callback", 1), ("prescribed", "callback", 2),
        ("two-way", "callback", 1), ("two-way", "callback", 2), ("two-way", "loop", 1))
BALANCE = 1e-12         # what coupling.py demands
RANKS = 1e-8            # radii; the solver's tolerance of 1e-10, over a run
DRIVERS = 1e-12


def run(scene, driver, ranks, out):
    """The folder with the results."""
    folder = out / f"{driver}.{ranks}"
    folder.mkdir(parents=True, exist_ok=True)
    command = ["mpirun", "-np", str(ranks), sys.executable, str(HERE / "coupling.py"), scene, "--driver", driver,
               "--out", str(folder), "--log", str(folder / f"log.{scene}")]
    start = time.time()
    print(f"[{scene}, {driver}, {ranks} rank{'s' if ranks > 1 else ''}]", end=" ", flush=True)
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    print(f"{time.time() - start:.0f} s", flush=True)
    for line in done.stdout.splitlines()[-2 if done.returncode == 0 else 0:]:
        print("  " + line)
    if done.returncode != 0:
        sys.exit(f"{scene}, {driver}, {ranks} ranks: exit code {done.returncode}")
    return folder


def main():
    arguments = sys.argv[1:]
    update = "--update" in arguments
    arguments = [a for a in arguments if a != "--update"]
    if len(arguments) > 1 or any(a.startswith("-") for a in arguments):
        sys.exit(__doc__)
    out = pathlib.Path(arguments[0] if arguments else TOP / "build" / "examples" / "cfd_coupling").resolve()
    need("mpirun")

    tracks = {}
    for scene, driver, ranks in RUNS:
        folder = run(scene, driver, ranks, out)
        tracks[scene, driver, ranks] = np.load(folder / f"{scene}.npz")["tracks"]

    def distance(one, other):
        return np.abs(tracks[one] - tracks[other]).max()

    missed = 0
    for what, value, limit in (
            ("prescribed: 2 ranks against 1", distance(RUNS[0], RUNS[1]), RANKS),
            ("two-way:    2 ranks against 1", distance(RUNS[2], RUNS[3]), RANKS),
            ("two-way:    loop of 'run 1' against the callback", distance(RUNS[2], RUNS[4]), DRIVERS)):
        missed += not value <= limit
        verdict = "ok    " if value <= limit else "MISSED"
        print(f"  {verdict}  {what}: tracks apart by {value:.1e} radii at most, limit {limit:.0e}")

    one = out / "callback.1"
    draw(one, one / "cfd_coupling.png")
    print(f"picture: {one / 'cfd_coupling.png'}")
    if update:
        shutil.copy(one / "cfd_coupling.png", HERE)
        for scene in ("prescribed", "two-way"):
            for ranks in (1, 2):
                shutil.copy(out / f"callback.{ranks}" / f"log.{scene}", HERE / f"log.cfd_coupling.{scene}.{ranks}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
