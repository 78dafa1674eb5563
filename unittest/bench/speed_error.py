#!/usr/bin/env python3
"""Time of a product against its error: every engine, in both precisions, from 10^3 to 10^6 spheres, and other programs.

    cmake --build build --target bench_speed_error
    . build/env.sh; unittest/bench/speed_error.py [--spheres N ...] [--draw] [--build FOLDER]

bench_speed_error.c has the scenes and what errors are measured against. Processor time on one core. Measured numbers
go to speed_error.csv and the picture to speed_error.png, beside this file; --draw: the picture alone, of the numbers
that are there. The other programs (peers.py) are measured where Python has them, as that which accuracy_times.sh
makes; the rows of those that it has not stay in peers.csv as they are."""
import argparse
import csv
import pathlib
import subprocess
import tempfile

from from_tests import np
import peers

HERE = pathlib.Path(__file__).resolve().parent
TABLE, PEERS = HERE / "speed_error.csv", HERE / "peers.csv"
COLUMNS = ["engine", "numbers", "spheres", "tolerance", "placed", "seconds", "error"]
LINES = {    # engine: name, colour and mark
    "all pairs": ("all pairs, open", "tab:red", "s"),
    "list": ("by list, 90 neighbours", "tab:brown", "D"),
    "open": ("Ewald sums, open", "tab:orange", "o"),
    "periodic": ("Ewald sums, periodic", "tab:blue", "o"),
    "slit": ("Ewald sums, slit of 10 radii", "tab:green", "^"),
}
MARKS = {    # other programs, in the colour of what they sum: mark
    "fmm3dpy": "P", "H2Pack": "X", "pystokes": "v", "RigidMultiblobsWall": "<", "jfsd": "*",
}


def read(table):
    with open(table, newline="") as file:
        return list(csv.DictReader(file))


def write(table, columns, rows):
    with open(table, "w", newline="") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(sorted(rows, key=lambda row: int(row["spheres"])))


def measure(build, n):
    """Rows of n spheres in both tables are made anew, but for programs that are not there."""
    with tempfile.NamedTemporaryFile() as file:
        run = subprocess.run([build / "bench_speed_error", str(n), file.name], check=True, stdout=subprocess.PIPE,
                             text=True)
        ours = [dict(zip(COLUMNS, line.split(","))) for line in run.stdout.splitlines()]
        others = list(peers.rows(file.name, ours))
    write(TABLE, COLUMNS, [row for row in read(TABLE) if int(row["spheres"]) != n] + ours)
    measured = {row["program"] for row in others}
    kept = [row for row in read(PEERS) if int(row["spheres"]) != n or row["program"] not in measured]
    write(PEERS, peers.COLUMNS, kept + others)


def draw(rows, others):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt
    spheres = sorted({int(row["spheres"]) for row in rows})
    size = (2.8 * len(spheres), 4.2)
    figure, panels = plt.subplots(1, len(spheres), figsize=size, sharex=True, sharey=True, squeeze=False)
    for panel, n in zip(panels[0], spheres):
        for engine, (name, colour, mark) in LINES.items():
            for numbers, line, more in (("double", "-", ""), ("float", "--", ", floats")):
                key = (engine, numbers, str(n))
                chosen = [row for row in rows if (row["engine"], row["numbers"], row["spheres"]) == key]
                error, seconds = (np.array([float(row[column]) for row in chosen]) for column in ("error", "seconds"))
                panel.loglog(error, 1e6 * seconds / n, mark + line, color=colour, markersize=5,
                             markerfacecolor=colour if more else "white",
                             label=name + more if chosen and n == spheres[0] else None)
        for program, box in sorted({(row["program"], row["box"]) for row in others}):
            chosen = [row for row in others if (row["program"], row["box"], row["spheres"]) == (program, box, str(n))]
            panel.loglog([float(row["error"]) for row in chosen], [1e6 * float(row["seconds"]) / n for row in chosen],
                         MARKS[program], color="tab:purple" if box == "open" else "tab:gray", markersize=7,
                         linestyle=":", label=f"{program}, {box}" if n == spheres[0] else None)
        panel.set(title=f"{n} spheres", xlabel="error of a product")
        panel.grid(alpha=0.3)
    panels[0][0].set_ylabel("time of a product per sphere / µs")
    figure.legend(loc="lower center", ncols=5, fontsize="small", frameon=False)
    figure.subplots_adjust(left=0.07, right=0.98, top=0.92, bottom=0.27, wspace=0.06)
    figure.savefig(HERE / "speed_error.png", dpi=100)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--spheres", type=int, nargs="+", default=[1000, 10000, 100000, 1000000])
    parser.add_argument("--build", type=pathlib.Path, default=HERE.parents[1] / "build")
    parser.add_argument("--draw", action="store_true")
    given = parser.parse_args()
    for n in [] if given.draw else given.spheres:
        measure(given.build, n)
    draw(read(TABLE), read(PEERS))


if __name__ == "__main__":
    main()
