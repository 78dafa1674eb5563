"""Scenes of pair_style sph/artVisc/tensCorr for relations.py: full boxes, also oblique ones and ones that shear or
stretch, drops, tanks, columns that fall, channels, open ends, bodies."""
import random
from itertools import product

from relations_scene import Scene, until_settled

OPTIONS = {
    "dim": [2, 2, 3], "wide": [1, 1, 1, 2], "space": ["full", "drop", "tank", "tank", "column", "channel", "ends",
                                                      "body", "oblique", "shear", "stretch"],
    "scheme": ["plain", "delta", "shift", "shift", "pliant", "correction", "summation"], "volume": ["no", "no", "yes"],
    "fluids": [1, 1, 2], "kernel": ["wendland", "cubicspline"], "artVisc": ["no", "yes"],
    "tensCorr": ["no", "no", "yes"], "viscosity": ["no", "central", "laplacian"],
    "rheology": ["no", "no", "bingham", "carreau"], "implicit": ["no", "no", "yes"], "filter": ["no", "no", "yes"],
    "state": ["Tait", "Tait", "tension no", "relativ", "absolut"],
    "wall": ["at rest", "slip", "suction no", "moving", "turning", "own"], "plane": ["no", "no", "plane", "region"],
    "gravity": ["no", "yes"], "grains": ["no", "no", "yes"], "tension": ["no", "no", "yes"],
    "look": ["nothing", "energy", "probe", "virial", "height"], "skin": [0.3, 0.15], "steps": [2, 5, 9],
    "edges": ["square"], "drift": ["no"],       # oblique, shrunk; yes: changes
}
WALLED = ("tank", "column", "channel", "body")
FULL = ("full", "oblique", "shear", "stretch")
PERIODIC = {2: ("full", "drop"), 3: ("full", "drop", "tank", "channel")}    # along x and y, with right angles


def may_drift(o):
    """Shift is not Galilean invariant; probes, walls and the middle of a box that stretches stay where they are."""
    return (o["space"] in ("full", "oblique", "shear") and o["scheme"] in ("plain", "delta", "summation") and
            o["look"] in ("nothing", "virial"))


@until_settled
def lawful(o, no):
    """What does not go together, by the pages."""
    # surface tension
    no(o["space"] == "drop", tension="yes")
    no(o["tension"] == "yes" and o["space"] in FULL, space="drop")
    no(o["tension"] == "yes", scheme="pliant" if o["scheme"] == "pliant" else "shift", volume="no", fluids=1,
       grains="no", space="tank" if o["space"] == "channel" else o["space"],
       state="Tait" if o["state"] == "absolut" else o["state"])
    no(o["space"] in ("ends", "body"), dim=2)
    no(o["dim"] == 2, wide=1)
    no(o["scheme"] == "correction" and o["space"] not in FULL + ("channel",), space="channel")
    no(o["scheme"] == "correction", plane="no")
    no(o["scheme"] == "summation" and o["space"] in ("ends", "body"), scheme="plain")
    no(o["scheme"] == "summation", volume="no", filter="no")
    no(o["scheme"] in ("shift", "pliant", "correction"), tensCorr="no", filter="no")
    no(o["scheme"] in ("shift", "pliant"), kernel="wendland")
    no(o["scheme"] == "pliant" and (o["fluids"] == 2 or o["grains"] == "yes"), scheme="shift")
    no(o["scheme"] == "pliant", volume="no")
    no(o["volume"] == "yes", tensCorr="no", filter="no")
    no(o["fluids"] == 2, volume="yes" if o["scheme"] != "summation" else "no", filter="no")
    no(o["fluids"] == 2 and (o["scheme"] == "summation" or o["space"] in ("ends", "body")), fluids=1)
    # at an outlet the water would meet a vacuum
    no(o["state"] == "absolut" and (o["fluids"] == 2 or o["space"] == "ends"), state="Tait")
    no(o["space"] not in WALLED, wall="at rest")
    no(o["space"] == "body", wall="own")
    no(o["space"] != "body" and o["wall"] == "own" and o["scheme"] == "summation", wall="at rest")
    no(o["space"] in FULL + ("drop", "ends", "channel", "body"), plane="no")
    no(o["viscosity"] == "laplacian" and o["wall"] in ("moving", "turning", "own"), viscosity="central")
    # the page: shift beside faces that glide
    no(o["space"] == "shear" and o["scheme"] in ("shift", "pliant"), scheme="correction")
    no(o["look"] == "height" and (o["space"] not in ("tank", "column") or o["gravity"] == "no"), look="probe")
    no(o["viscosity"] == "no", rheology="no", implicit="no")
    no(o["space"] == "body", gravity="yes")
    # grains smaller than h
    no(o["grains"] == "yes", dim=3, scheme="delta" if o["scheme"] in ("plain", "correction", "summation")
       else o["scheme"], volume="yes", fluids=1, rheology="no", implicit="no", plane="no", look="nothing",
       wall="at rest", space=o["space"] if o["space"] in ("full", "oblique", "stretch") else "tank",
       viscosity="laplacian" if o["viscosity"] == "laplacian" else "central")
    no(o["edges"] == "oblique" and o["space"] not in PERIODIC[o["dim"]], edges="square")
    no(o["edges"] == "shrunk" and o["space"] not in WALLED, edges="square")
    no(not may_drift(o), drift="no")
    # that of fix rigid depends on where the origin is
    no(o["space"] == "body" and o["look"] == "virial", look="energy")


# number of cells along x, y, z in two and three dimensions; which sides are periodic
# (y twice as large with wide 2: so many ghosts that buffers are not large by chance)
SIZES = {**dict.fromkeys(FULL, ((20, 10, 1), (10, 8, 8))),
         "tank": ((20, 10, 1), (9, 8, 6)), "column": ((24, 10, 1), (12, 8, 7)),
         "drop": ((20, 14, 1), (11, 10, 10)), "channel": ((20, 8, 1), (9, 8, 6)), "ends": ((16, 8, 1), None),
         "body": ((14, 9, 1), None)}
OPEN_X = ("column", "ends")
SHEAR = 0.4                     # times the height is the largest velocity
TILT = (3.0, -2.0, 1.5)         # xy xz yz of a box that is no block
BODY = [(x, y) for x in (5, 6, 7, 8) for y in (5, 6, 7)]


def size_of(o):
    nx, ny, nz = SIZES[o["space"]][o["dim"] - 2]
    return (nx, ny * o["wide"] if o["dim"] == 3 else ny, nz)


def kinds_of_cells(o):
    """{cell: type} of the scene: 1 and 4 fluid, 2 walls, 3 a body"""
    size = size_of(o)
    up = o["dim"] - 1
    begin, end = [0, 0, 0], list(size)
    if o["space"] == "column":
        end[0] //= 2
    if o["space"] == "ends":
        begin[0], end[0] = -4, 20
    cells = {c: 3 if o["space"] == "body" and c[:2] in BODY else 4 if o["fluids"] == 2 and c[up] >= size[up] // 2 else 1
             for c in product(*map(range, begin, end))}
    if o["space"] == "drop":
        cells = {c: t for c, t in cells.items() if in_drop(o, c)}
    walls = [(-3, 0)] * (o["space"] in WALLED) + [(size[up], size[up] + 3)] * (o["space"] == "channel")
    for first, last in walls:
        begin, end = [0, 0, 0], list(size)
        begin[up], end[up] = first, last
        cells.update({c: 2 for c in product(*map(range, begin, end))})
    return cells


def in_drop(o, cell):
    """Two drops, one of them across a periodic edge"""
    size = size_of(o)[:o["dim"]]
    middle = [sum((c + 0.5 - at * n) ** 2 for c, n, at in zip(cell, size, where))
              for where in ((0.4, 0.4, 0.5), (0.9, 1.05, 0.9))]
    return middle[0] < 4.2**2 or middle[1] < 1.6**2


def box_of(o):
    size, up = size_of(o), o["dim"] - 1
    lo, hi, each = [0.0, 0.0, 0.0], [float(n) for n in size], ["p", "p", "p"]
    if o["space"] in WALLED:
        lo[up], hi[up], each[up] = -3.5, hi[up] + 3.5, "f"
    if o["space"] == "ends":
        lo[0], hi[0] = -6.0, 21.0
    if o["space"] in OPEN_X:
        lo[0], each[0] = min(lo[0], -1.0), "f"
    if o["dim"] == 2:
        lo[2], hi[2] = -0.5, 0.5
    return lo, hi, [e.replace("f", "s") if o["edges"] == "shrunk" else e for e in each]


def tilt_of(o):
    (nx, ny, _), flat = size_of(o), o["dim"] == 2
    if o["edges"] == "oblique":
        return (float(nx), 0.0, float(ny) if not flat and o["space"] not in WALLED else 0.0)
    if o["space"] in ("oblique", "shear"):
        return (TILT[0], 0.0, 0.0) if flat else TILT
    return (0.0, 0.0, 0.0)


def place(o, x):
    """In a box that is no block, of what would be at x in a block: between the rows that tilt with it; or the same
    place, as one box repeats the other"""
    (xy, xz, yz), (nx, ny, nz) = tilt_of(o), size_of(o)
    if o["edges"] == "oblique":
        c = x[2] / nz
        b = x[1] / ny - c * (yz != 0.0)
        a, b = (x[0] / nx - b) % 1.0, b % 1.0
        return [nx * a + xy * b, ny * b + yz * c, x[2]]
    return [x[0] + xy * x[1] / ny + xz * x[2] / nz, x[1] + yz * x[2] / nz, x[2]]


def add_grains(s, o, R):
    """Type 5, apart from each other and from the surface, not at rest."""
    size = size_of(o)
    for cell in product(range(1, size[0] - 1, 2), range(1, size[1] - 1, 2), range(1, size[2] - 2, 2)):
        if R.random() < 0.6:
            x = [c + R.uniform(0.3, 0.7) for c in cell]
            s.atom(place(o, x), [R.uniform(-0.2, 0.2) for _ in range(3)], 5, from_box=x,
                   diameter=R.uniform(0.3, 0.65), density=2.65)


def build(options, seed):
    o = lawful(options)
    flat, R = o["dim"] == 2, random.Random(f"water {seed}")
    sph = {"mass": 1.0} if o["grains"] == "yes" else {}
    s = Scene("sph 2-D" if flat else "sph", o, seed)
    s.drift[0] = 0.7 * (o["drift"] == "yes")
    ends = o["space"] == "ends"
    for cell, kind in kinds_of_cells(o).items():
        fluid = kind in (1, 4)
        jitter = 0.0 if not fluid else 0.04 if ends else 0.1
        x = [c + (0.05 if ends and k == 0 else 0.5) + R.uniform(-jitter, jitter) for k, c in enumerate(cell)]
        v = [R.uniform(-0.05, 0.05) * fluid + 4.0 * (ends and k == 0) for k in range(3)]
        v[0] += SHEAR * x[1] * (o["space"] == "shear")
        if flat:
            x[2] = v[2] = 0.0
        s.atom(place(o, x), v, kind, from_box=x, rho=1.0 + R.uniform(-0.005, 0.005) * fluid,
               kind="rho2" if flat else "rho", **sph)
    if o["grains"] == "yes":
        add_grains(s, o, R)
    commands(s, o, "2" if flat else "", 1 if flat else 2, *box_of(o))
    return s


def commands(s, o, d, up, lo, hi, each):
    flat, grains = bool(d), o["grains"] == "yes"
    s.types, s.repeats = 5 if grains else 4, "2 1 1" if flat else "1 2 1"
    s.head = ["units lj", f"dimension {o['dim']}", "atom_style hybrid sph sphere" if grains else "atom_style sph"]
    s.head += ["comm_modify vel yes"] * grains
    spans = " ".join(f"{a!r} {b!r}" for a, b in zip(lo, hi))
    region = f"block <block {spans}>"
    if any(tilt_of(o)):
        region = f"prism <block {spans}> " + " ".join(f"<L {t}>" for t in tilt_of(o))
    s.head += ["box tilt large"] * any(tilt_of(o))
    s.make = [f"boundary <each {' '.join(each)}>", f"region box {region}",
              f"create_box {s.types + 1} box"]
    s.after = ["mass * <m 1.0>"]
    s.groups = ["group grains type 5", "group moves type 1 4 5"] * grains
    s.groups += ["group fluid type 1 4", "group wall type 2 3", "group first type 1 2 3", "group second type 4"]
    s.define = [f"neighbor <L {o['skin']}> bin", "neigh_modify delay 0 every 1 check yes"]
    pair_style(s, o, d)
    fluid_fixes(s, o, d, up)
    border_fixes(s, o, d, up)
    s.fixes.append("fix move fluid nve/sph")
    s.fixes += ["fix roll grains nve/sphere", "fix couple grains sph/grains drag beetstra"] * grains
    s.fixes += ["fix flat all enforce2d"] * flat
    s.fixes.append("compute rho all sph/rho/atom")
    look(s, o, d, up)
    columns(s, o, d)
    # implicit friction is left at a residual of 1e-8
    s.dt, s.steps, s.tolerance = 0.01, o["steps"], 1e-6 if o["implicit"] == "yes" else 1e-8


def pair_style(s, o, d):
    shifts = o["scheme"] in ("shift", "pliant", "correction")
    words = f"{o['kernel']} <L 1.3>" + " artVisc 0.1 0.0 <area 0.01>" * (o["artVisc"] == "yes")
    words += " tensCorr 0.2 <L 1.0>" * (o["tensCorr"] == "yes")
    words += f" viscosity <eta{d} 0.05> {o['viscosity']}" * (o["viscosity"] != "no")
    words += {"bingham": f" rheology bingham <P{d} 0.02> <eta{d} 0.5>",
              "carreau": f" rheology carreau <t 2.0> 0.4 <eta{d} 0.5>"}.get(o["rheology"], "")
    words += " implicit yes" * (o["implicit"] == "yes")
    words += {"shift": " shift yes", "pliant": " shift pliant", "correction": " correction yes"}.get(o["scheme"], "")
    coefficients = "c <V 10>" + " deltap <L 1.0>" * shifts
    s.pair = [("sph/artVisc/tensCorr", words, coefficients)]
    if o["grains"] == "yes":
        s.pair = [("soft", "<L 0.6>", [("* *", "<E 0.0>"), ("5 5", "<E 0.5>")]),
                  ("sph/artVisc/tensCorr", words, [("1*4 1*4", coefficients)])]


def weight_of(o, up):
    pull = [0.0, 0.0, 0.0]
    pull[up] = -0.1 if o["gravity"] == "yes" else 0.0
    return pull


def fluid_fixes(s, o, d, up):
    grains = o["grains"] == "yes"
    state = {"Tait": f"Tait <P{d} 14.2857> <rho{d} 1.0> 7", "relativ": f"relativ <V2 100> <rho{d} 1.0>",
             "absolut": "absolut <V 10>", "tension no": f"Tait <P{d} 14.2857> <rho{d} 1.0> 7 tension no"}[o["state"]]
    direction = "<1 {} {} {}>".format(*[p / 0.1 for p in weight_of(o, up)])
    particles = "sph" if grains else "all"
    s.groups += ["group sph type 1 2 3 4"] * grains
    s.fixes = [f"fix p {'first' if o['fluids'] == 2 else particles} sph/pressure {state}"]
    if o["fluids"] == 2:
        s.fixes.append(f"fix p2 second sph/pressure {state}")
    rate = "" if o["scheme"] == "plain" else " delta 0.1"
    s.fixes.append("fix d all sph/density/summation" if o["scheme"] == "summation" else
                   f"fix d {particles} sph/density/continuity" + rate + " volume yes" * (o["volume"] == "yes"))
    s.fixes += ["fix filter fluid sph/density/corr shepard every 2"] * (o["filter"] == "yes")
    s.fixes += [f"fix g {'moves' if grains else 'fluid'} gravity <A 0.1> vector {direction}"] * (o["gravity"] == "yes")


def border_fixes(s, o, d, up):
    flat, walled = bool(d), o["space"] in WALLED
    weight = "<A {} {} {}>".format(*weight_of(o, up))
    if walled:
        s.fixes.append("fix w wall wall/adami/sph" + f" gravity {weight}" * (o["gravity"] == "yes")
                       + {"slip": " slip yes", "suction no": " suction no",
                          "own": " own_acceleration yes"}.get(o["wall"], ""))
        if o["wall"] in ("moving", "turning", "own"):
            s.groups.append("group tank type 2")
            axis = "<p 9.0 4.0 2.0> <W 0 0 1>" if flat else "<p 4.0 4.0 2.0> <W 1 0.5 2>"
            s.fixes.append("fix tug tank move " + (f"rotate {axis} <t 90.0>" if o["wall"] == "turning" else
                                                   "wiggle <L 0.3 0.0 0.0> <t 2.0>"))
    if o["space"] == "body":
        s.groups.append("group box type 3")
        s.fixes.append("fix float box rigid single gravity g force * on on off torque * off off on")
    if o["space"] == "shear":
        s.fixes.append(f"fix glide all deform 1 xy erate <rate {SHEAR}> remap v")
    if o["space"] == "stretch":
        s.fixes.append("fix press all deform 1 <axis x> trate <rate -0.2> <axis y> trate <rate 0.15> remap x")
    if o["space"] == "ends":
        s.fixes += ["fix in fluid sph/inlet <side xlo 0> <L 4.0> velocity <V 4.0>",
                    f"fix out fluid sph/outlet <side xhi 16> <L 4.0> pressure <P{d} 0.1>"]
    if o["plane"] == "plane":
        s.fixes.append(f"fix plane fluid wall/sph <planes {'y' if flat else 'z'} -0.6 NULL> <L 0.6> <F 1.0>")
    if o["plane"] == "region":
        s.define.append(f"region room block <block INF INF {'-0.6 INF INF INF' if flat else 'INF INF -0.6 INF'}>")
        s.fixes.append("fix plane fluid wall/region/sph room <L 0.6> <F 1.0>")
    if o["tension"] == "yes":
        angles = " contact 2 70" * walled + " 3 120" * (o["space"] == "body")
        s.fixes.append(f"fix pull fluid sph/tension <{'F' if flat else 'k'} 1.0>{angles} force yes")


def columns(s, o, d):
    flat, grains = bool(d), o["grains"] == "yes"
    s.columns = [("p", "xu yu zu"), ("V", "vx vy vz"), ("rho" + d, "c_rho"), ("P" + d, "f_p")]
    s.columns += [("drho" + d, "f_d")] * (o["scheme"] != "summation")
    if o["tension"] == "yes":
        s.columns += [("curvature", "f_pull[1]"), ("1", "f_pull[2]"), ("1", "f_pull[3] f_pull[4] f_pull[5]")]
        s.globals += [("F", "f_pull[1] f_pull[2] f_pull[3]"), ("1", "f_pull[4]"),
                      ("L" if flat else "area", "f_pull[5]")]
    s.columns += [("1", "f_couple[1]"), ("F", "f_couple[2] f_couple[3] f_couple[4]")] * grains
    s.globals += [("F", "f_couple[1] f_couple[2] f_couple[3]"), ("1", "f_couple[4]")] * grains


def look(s, o, d, up):
    if o["look"] == "energy":
        s.fixes.append("compute en fluid sph/energy")
        s.globals += [("E", f"c_en[{k}]") for k in (1, 3, 4, 5, 6, 8, 9)]
    elif o["look"] == "virial":
        s.fixes.append("compute vir all pressure NULL virial")
        s.globals += [("P" + d, "c_vir"), ("stress" + d, " ".join(f"c_vir[{k}]" for k in range(1, 7)))]
    elif o["look"] in ("probe", "height"):
        probe = f"pressure <p 3.2 3.1 {'0' if up == 1 else '2.7'}>"
        if o["look"] == "height":
            probe += f" height <axis {'xyz'[up]}> <p 3.2 {'0' if up == 1 else '3.1'} 0>"
        s.fixes.append(f"compute probe all sph/probe {probe}")
        s.globals += [("P" + d, "c_probe[1]")] + [("L", "c_probe[2]")] * (o["look"] == "height")
