"""Changes of an input that must not matter (for relations.py), and which of them cannot hold where, with the reason.

A change is a dictionary that joins others: entries of `how` say how LAMMPS is run (relations.commands), `frame` is a
Frame that moves the whole input, `options` are options of the scene that make the same physics in another way. loose:
by how much the tolerance of the scene is too small for it."""
import random

import numpy as np

import relations_sph
from relations_frame import Frame, turned

def change(frame=None, loose=1.0, options=None, **how):
    return {"how": how, "frame": frame, "options": options, "loose": loose}


LAYOUT = {
    "ranks 2": change(ranks=2), "ranks 3": change(ranks=3),
    "newton off": change(newton="off"),
    "grid 1 1 2": change(ranks=2, grid="1 1 *"), "grid 3 1 1": change(ranks=3, grid="* 1 1"),
    "tiled": change(ranks=2, tiled=True),
    "skin": change(skin=0.11), "unsorted": change(sort="0 0"),
    "far ghosts": change(far=5.5), "all with all": change(search="nsq"), "search by type": change(search="multi"),
    "balanced on the way": change(ranks=2, balance="shift"),
    "tiled on the way": change(ranks=3, tiled=True, balance="rcb"), "time step told again": change(told=True),
}
PIECES = {
    "two runs": change(pieces="two"), "runs of 1": change(pieces="ones"), "run 0 before": change(pieces="zero"),
    "restart": change(pieces="restart"), "restart on 2": change(pieces="restart", again=2),
    "restart from 2 on 1": change(pieces="restart", ranks=2, again=1),
    "restart from 2 on 3": change(pieces="restart", ranks=2, again=3),
}
STYLES = {
    "hybrid": change(hybrid="hybrid"), "overlay before": change(hybrid="before"),
    "overlay after": change(hybrid="after"), "pair style twice": change(twice="same"),
    "another pair style before": change(twice="other"),
    "strangers": change(hybrid="strangers"),
}
FRAMES = {
    "shift": change(frame=lambda s: Frame(shift=s.spacing *
                                          np.array((3.3, -5.1, 0.0 if s.model == "sph 2-D" else 7.7)))),
    "turn": change(frame=lambda s: Frame(R=turned("y", "-x", "z") if s.model == "sph 2-D" else turned("y", "z", "x"))),
    "turn back": change(frame=lambda s: Frame(R=turned("-y", "x", "z") if s.model == "sph 2-D"
                                              else turned("x", "-z", "y"))),
    "mirror": change(frame=lambda s: Frame(R=turned("x", "-y", "z"))),
    "mirror at the wall": change(frame=lambda s: Frame(R=turned("x", "-y", "z") if s.model == "sph 2-D"
                                                       else turned("x", "y", "-z"))),
    "renumbered": change(frame=lambda s: Frame(order=shuffled(s, lambda a: 0))),
    "members": change(frame=lambda s: Frame(order=members(s))),
    "units": change(frame=lambda s: Frame(scale=(1000.0, 40.0, 0.3))),
    "small units": change(frame=lambda s: Frame(scale=(1e-3, 0.02, 1e-4))),
}
ENGINES = {"direct": change(options={"far": "direct"}, loose=10.0),
           "ewald": change(options={"far": "ewald"}, loose=10.0)}
BOXES = {"oblique edges": change(options={"edges": "oblique"}), "twice": change(doubled=True),
         "shrunk edges": change(options={"edges": "shrunk"}), "drift": change(options={"drift": "yes"})}
CHANGES = {**LAYOUT, **PIECES, **STYLES, **FRAMES, **ENGINES, **BOXES}
KINDS = (LAYOUT, PIECES, STYLES, FRAMES, ENGINES, BOXES)


def shuffled(scene, key):
    order = list(range(1, len(scene.atoms) + 1))
    random.Random(f"order {scene.seed}").shuffle(order)
    return order


def members(scene):
    """Each clump's IDs among themselves in the opposite order"""
    order = list(range(1, len(scene.atoms) + 1))
    for m in {a.get("molecule") for a in scene.atoms} - {0, None}:
        ids = [k + 1 for k, a in enumerate(scene.atoms) if a["molecule"] == m]
        for new, old in zip(ids, reversed(ids)):
            order[new - 1] = old
    return order


def triclinic(o):
    return o.get("space") in ("tilt", "deform", "oblique", "shear")


TURNS = ("turn", "turn back", "mirror", "mirror at the wall")
CUTS = tuple(PIECES)
RESTARTS = tuple(name for name in PIECES if name.startswith("restart"))
# (changes, where they cannot hold, why)
EXCEPTIONS = [
    (TURNS, triclinic, "LAMMPS has triclinic boxes of one orientation only"),
    (TURNS + ("renumbered", "members"),
     lambda o: o.get("noise") == "yes", "random numbers belong to atom IDs and to the axes x, y, z"),
    (("renumbered",), lambda o: o.get("fluctuation", "none") != "none", "random numbers belong to atom IDs"),
    (tuple(name for name in TURNS if name != "mirror"), lambda o: o["model of"] == "vans",
     "the stream runs along x, and z is up"),
    (("mirror",), lambda o: o.get("fluctuation", "none") != "none", "random numbers belong to the axes x, y, z"),
    (("grid 1 1 2",), lambda o: o.get("dim") == 2, "two dimensions"),
    (TURNS, lambda o: o.get("look") == "virial" and
     (o["viscosity"] == "laplacian" or o["scheme"] in ("shift", "pliant", "correction")),
     "forces that are not along the line of centres: of their virial LAMMPS has six numbers of nine"),
    (TURNS, lambda o: o.get("look") == "height", "a height is measured along +AXIS"),
    (("members",), lambda o: not o.get("clumps"), "no clumps"),
    (("pair style twice",), lambda o: o.get("grains") == "yes" and o["space"] == "tank",
     "the volume of wall particles is that of the pressure of the step before, and of the input in the first"),
    (CUTS + ("pair style twice",), lambda o: o.get("space") ==
     "body", "fix rigid ... gravity of LAMMPS begins each run with half a step without weight"),
    (CUTS, lambda o: o.get("space") in ("shear", "stretch"), "fix deform changes the box after the force of a step, "
     "so the first force of a run sees it one step further, and at run 0 it has no rate"),
    (CUTS, lambda o: "forces" in o.get("motion", "") and
     (o["flow"] in ("shear", "time", "box") or o["visc"] == "formula"),
     "LAMMPS's Verlet has other velocities in the first step of a run; the page asks for numbers"),
    (("direct", "ewald"), lambda o: o["model of"] != "stokes" or o["pairs"] != "inf", "no sum over all pairs"),
    (("direct",), lambda o: o.get("space") in ("periodic", "tilt", "deform") or o.get("far") == "direct",
     "periodic boxes have Ewald sums only"),
    (("ewald",), lambda o: o.get("far") == "ewald" or o.get("space") == "wall" and
     not o["model"].startswith("multiblob"), "there already, or refused above a wall with one point per "
                                             "sphere that turns"),
    (("direct", "ewald"), lambda o: o.get("noise") == "yes", "each engine draws its own numbers"),
    (("another pair style before",), lambda o: o.get("space") in ("floor", "slit", "flux"),
     "the other one has rigid clumps, which need rotation, which one-point spheres have not there"),
    (("another pair style before",),
     lambda o: o["model of"] != "stokes", "SPH keeps rates in its fixes; the stream has no pair style"),
    (("pair style twice", "another pair style before"),
     lambda o: o.get("adapt") == "yes", "adapt goes on from the time step that it has chosen"),
    (CUTS, lambda o: o.get("adapt") == "yes" and o["flow"] == "time",
     "a formula of step*dt is that of another time when a run begins with a time step that was chosen since"),
    (("units", "small units"), lambda o: o.get("state") == "absolut" and o.get("look") == "energy",
     "the elastic energy of the law absolut counts from the density 1"),
    (CUTS, lambda o: o.get("box") == "wider",
     "a run begins with contacts at the places that fix deform gave the grains after the last step"),
    (CUTS, lambda o: o.get("leave") == "yes" and (o["classes"] != "no" or o["bed_mixing"] != "off" or
                                                  o["turbulence"] in ("pore", "rousseau", "ni_capart")),
     "the classes are those of the grains that there are when a run begins"),
    (("pair style twice",), lambda o: o["model of"] == "vans", "the stream has no pair style"),
    (("newton off", "tiled", "tiled on the way"), lambda o: o["model of"] == "vans",
     "pair gran with history does not go with it"),
    (("time step told again",), lambda o: o.get("adapt") == "yes" or o.get("noise") == "yes",
     "the fix has steps of its own; with noise fix dt/reset is refused"),
    (("twice",), lambda o: o["model of"] != "sph" or o["dim"] == 2 and o["space"] in ("column", "ends", "body") or
     o["dim"] == 3 and o["space"] == "shear" or o["space"] == "stretch" or o["wall"] == "turning",
     "not periodic along that axis, or not with the same velocities; or the middle of the box matters"),
    (("drift",), lambda o: o["model of"] != "sph" or not relations_sph.may_drift(o), "not Galilean invariant"),
    (("shrunk edges",), lambda o: o["model of"] != "sph" or o["space"] not in relations_sph.WALLED or
     o["look"] == "virial", "no open edges, or open ends; a virial is per volume of the box"),
    (("oblique edges",), lambda o: o["model of"] != "sph" or o["space"] not in relations_sph.PERIODIC[o["dim"]] or
     o["wall"] == "turning", "a box that is periodic there, with right angles; images do not turn with a wall"),
    (("strangers",), lambda o: o["model of"] != "sph", "of one type, or all spheres"),
    (("hybrid", "overlay before", "overlay after"), lambda o: o.get("contacts") == "yes", "a hybrid already"),
]


# (changes, others, where, why): what does not go together
CLASHES = [(RESTARTS, tuple(STYLES), lambda o: o["model of"] == "vans",
            "LAMMPS's pair_style hybrid loses the history of contacts in a restart file"),
           (("oblique edges",), TURNS, lambda o: True, "LAMMPS has triclinic boxes of one orientation only")]

# (changes, where, tolerance, why): what matters, but not much
COARSE = [
    (TURNS, lambda o: o.get("model", "").startswith("multiblob") or o.get("rigid") == "shell", 0.2,
     "the points of a free sphere's shell stand in the axes x, y, z"),
    (TURNS, lambda o: o.get("drive") == "squirm" and o.get("clumps"), 1.0,
     "and the slip of a swimmer that overlaps another one pushes on those few points of it that are near"),
]


def coarse(names, options):
    """The tolerance of what the changes may do by right, or 0"""
    return max([tolerance for which, where, tolerance, _ in COARSE if set(which) & set(names) and where(options)],
               default=0.0)


def reason(name, options):
    """Why this change cannot hold in a scene of these options, or None."""
    for names, where, why in EXCEPTIONS:
        if name in names and where(options):
            return why
    return None


def possible(options, most):
    return [name for name, c in CHANGES.items()
            if max(c["how"].get("ranks", 1), c["how"].get("again", 1)) <= most and not reason(name, options)]


def draw(R, options, most):
    """One to three changes that go together."""
    names = possible(options, most)
    chosen = []
    for _ in range(R.choice([1, 1, 2, 2, 3])):
        kind = R.choice([k for k in KINDS if any(n in names for n in k)])
        name = R.choice([n for n in kind if n in names])
        clash = any(where(options) and {name, n} & set(some) and {name, n} & set(others) for n in chosen
                    for some, others, where, _ in CLASHES)
        if not clash and together([CHANGES[n] for n in chosen + [name]]):
            chosen.append(name)
    return chosen


def together(changes):
    """No two say the same thing, and at most one moves the input."""
    keys = [k for c in changes for k in c["how"]]
    return len(keys) == len(set(keys)) and sum(c["frame"] is not None for c in changes) < 2 \
        and sum(c["options"] is not None for c in changes) < 2
