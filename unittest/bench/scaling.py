#!/usr/bin/env python3
"""What a rank has to hold and to say, for more and more ranks: no times, so ranks may share a core.

    . build/env.sh && unittest/bench/scaling.py [--spheres 10000 100000] [--ranks 1 2 4 8 16 32] [--films] [--multiblob]
        [--link 2 10]

A periodic box of spheres (volume fraction 0.1) that settle without inertia, tolerances 1e-3. Of the ranks the one with
most: memory beyond that of LAMMPS without the style; messages, bytes and collective calls of a step beyond LAMMPS's;
and the ranks that it speaks with. From runs of 1 and of 3 steps, whose difference is two steps; counts by
count_messages.c under MPI.

On paper: what that would take on a network where a message takes --link microseconds, and a byte 1/so many GB/s: the
messages one after the other, all bytes, and collective calls as log2(ranks) messages. Beside it --step seconds of one
rank (of each scene, as they are printed), shared evenly: where the first is as long as the second, ranks wait for
messages."""
import argparse
import os
import re
import subprocess
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
PLAIN = "cut_off_distance inf visc 1 relative_tolerance 1e-3 far_field_tolerance 1e-3"
FILMS = PLAIN + " rotation yes lubrication yes"
SHELLS = PLAIN + " multiblob 12 lubrication yes"


def positions(n, rng):
    """A simple cubic lattice, shaken so that no two spheres of radius 1 touch; its box"""
    m = int(np.ceil(n ** (1 / 3)))
    spacing = (4 * np.pi / 3 / 0.1) ** (1 / 3)
    x = (np.stack(np.meshgrid(*3 * [np.arange(m)], indexing="ij"), axis=-1).reshape(-1, 3)[:n] + 0.5) * spacing
    return x + rng.uniform(-0.7, 0.7, x.shape), m * spacing


def write_data(path, x, box):
    with open(path, "w") as out:
        out.write(f"spheres\n\n{len(x)} atoms\n1 atom types\n\n")
        out.write("".join(f"0 {box} {d}lo {d}hi\n" for d in "xyz") + "\nAtoms # sphere\n\n")
        out.writelines(f"{i + 1} 1 2.0 1.0 {a:.8f} {b:.8f} {c:.8f}\n" for i, (a, b, c) in enumerate(x))


def script(data, words, steps):
    style = (f"pair_style stokes_dynamics {words}\nfix move all stokes_dynamics/overdamped" if words
             else "pair_style zero 2\n")
    return (f"units lj\natom_style sphere\nboundary p p p\nplugin load stokesdynplugin.so\nread_data {data}\n{style}\n"
            "pair_coeff * *\n"
            f"fix pull all addforce 0 0 -1\ntimestep 0.01\nthermo 1000\nrun {steps}\n")


def count(folder, library, data, words, steps, ranks):
    (folder / "in").write_text(script(data, words, steps))
    run = subprocess.run(["mpirun", "--oversubscribe", "-np", str(ranks), "-x", f"LD_PRELOAD={library}", "lmp", "-in",
                          "in", "-log", "none"],
                         cwd=folder, capture_output=True, text=True)
    found = re.search(r"^COUNTED (.*)$", run.stdout, re.M)
    memory = re.search(r"\(min/avg/max\) = \S+ \| \S+ \| (\S+) Mbytes", run.stdout)
    if not found or not memory:
        raise SystemExit(run.stdout[-2000:] + run.stderr[-2000:])
    return np.array([float(memory.group(1)) * 2 ** 20] + [float(k) for k in found.group(1).split()])


def on_paper(step, ranks, link):
    """Milliseconds of the messages, bytes and collective calls of a step"""
    messages, sent, calls, in_calls = step[1:5]
    latency, rate = 1e-3 * link[0], 1e-6 / link[1]
    return latency * (messages + calls * np.log2(max(ranks, 1))) + rate * (sent + in_calls)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--spheres", type=int, nargs="+", default=[10000])
    options.add_argument("--ranks", type=int, nargs="+", default=[1, 2, 4, 8, 16, 32])
    options.add_argument("--films", action="store_true")
    options.add_argument("--multiblob", action="store_true")
    options.add_argument("--link", type=float, nargs=2, default=[2.0, 10.0], metavar=("MICROSECONDS", "GB/s"))
    options.add_argument("--step", type=float, nargs="+", default=[])
    asked = options.parse_args()
    os.environ.update(OMP_NUM_THREADS="1", OMPI_MCA_mpi_yield_when_idle="1")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        library = folder / "count_messages.so"
        subprocess.run(["mpicc", "-O2", "-shared", "-fPIC", HERE / "count_messages.c", "-o", library], check=True)
        print("spheres scene  ranks  memory/MB  messages/step  MB/step  collectives/step  MB/step  partners  "
              "paper/ms  work/ms")
        for n in asked.spheres:
            data = folder / "data"
            write_data(data, *positions(n, np.random.default_rng(1)))
            for ranks in asked.ranks:
                without = [count(folder, library, data, "", steps, ranks) for steps in (1, 3)]
                scenes = [("plain", PLAIN)] + asked.films * [("films", FILMS)] + asked.multiblob * [("shells", SHELLS)]
                for k, (scene, words) in enumerate(scenes):
                    one, three = [count(folder, library, data, words, steps, ranks) for steps in (1, 3)]
                    step = (three - one - (without[1] - without[0])) / 2
                    print(f"{n:7} {scene:6} {ranks:5} {(one - without[0])[0] / 2 ** 20:10.1f} {step[1]:14.0f} "
                          f"{step[2] / 2 ** 20:8.2f} {step[3]:17.0f} {step[4] / 2 ** 20:8.3f} {one[5]:9.0f} "
                          f"{on_paper(step, ranks, asked.link):9.2f} "
                          + (f"{1e3 * asked.step[k] / ranks:8.1f}" if k < len(asked.step) else ""), flush=True)


if __name__ == "__main__":
    main()
