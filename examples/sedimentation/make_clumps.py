#!/usr/bin/env python3
"""Writes clumps/NAME.mol, the LAMMPS molecule files of in.sedimentation, from data/cluster_geometry.csv."""
import pathlib

here = pathlib.Path(__file__).resolve().parent

clumps = {}
lines = [line for line in (here / "data" / "cluster_geometry.csv").read_text().splitlines() if not line.startswith("#")]
for line in lines[1:]:
    name, _, radius, x, y, z = line.split(",")
    clumps.setdefault(name, []).append((float(radius), x, y, z))

for name, spheres in clumps.items():
    ids = range(1, len(spheres) + 1)
    text = [f"# {name}: {len(spheres)} touching spheres, lengths in sphere radii",
            "# made by make_clumps.py from data/cluster_geometry.csv", "", f"{len(spheres)} atoms", "", "Coords", ""]
    text += [f"{i} {x} {y} {z}" for i, (_, x, y, z) in zip(ids, spheres)]
    text += ["", "Types", ""] + [f"{i} 1" for i in ids]
    text += ["", "Diameters", ""] + [f"{i} {2 * radius:g}" for i, (radius, *_) in zip(ids, spheres)]
    (here / "clumps" / f"{name}.mol").write_text("\n".join(text) + "\n")
print(f"{len(clumps)} molecule files in {here / 'clumps'}")
