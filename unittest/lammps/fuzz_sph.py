"""Scenes, grammar and rules of pair_style sph/artVisc/tensCorr and its fixes, written from their pages (for
fuzz.py)."""
from fuzz_grammar import (ANY, BAD, COUNT, NOT_NEGATIVE, ODD, POSITIVE, VARIABLES, YES_NO, Choice, Field, Integer,
                          Maybe, Name, Number, NumberOr, Or, decimal, positive, read, write)

WATER = """units si
atom_style sph
atom_modify map array
boundary f f f
plugin load stokesdynplugin.so
region box block -0.05 0.08 -0.05 0.08 -0.05 0.08
create_box 2 box
lattice sc 0.01
region water block -0.001 0.031 -0.001 0.031 -0.001 0.031 units box
create_atoms 1 region water
region bottom block -1 1 -1 1 -1 0.005 units box
set region bottom type 2
group fluid type 1
group wall type 2
group nobody empty
mass * 0.001
set group all sph/rho 1001
velocity all set 0.1 -0.05 0.02
velocity all create 1e16 4711 loop geom
region zone block -0.02 0.05 -0.02 0.05 -0.02 0.05 units box
region part block -0.005 0.015 -0.02 0.05 -0.02 0.05 units box
variable eta equal 1.5
neighbor 0.003 bin
neigh_modify delay 0 every 1
timestep 1e-6
thermo 100000"""
# no free surface, as correction needs it
BULK = WATER.replace("boundary f f f", "boundary p p p").replace("block -0.05 0.08 -0.05 0.08 -0.05 0.08",
                                                                 "block 0 0.04 0 0.04 0 0.04")
LENGTH = positive("0.013", "0.012", border=["0", "-1", "1e-12", "0.05"])
ARTVISC = [Number(lambda v: v >= 0, ["0.1", "0"], ["-1"])] * 2 + [Number(lambda v: v >= 0, ["1.7e-6", "0"], ["-1"])]
SPACING = positive("0.01", border=["0", "-1", "0.03"])
SOUND = positive("20", "25")
SPH_PAIR = {"artVisc": ARTVISC, "tensCorr": [NOT_NEGATIVE, SPACING],
            "viscosity": [positive("1e-3", odd=lambda v: v == 0), Maybe("central", "laplacian")],
            "shift": [Choice("yes", "yes", "no", "pliant")], "correction": [YES_NO]}
SPH_DENSITY = {"delta": [Number(lambda v: v >= 0, ["0", "0.1", "0.1", "0.2"], ["-1", "1e300"])], "volume": [YES_NO]}
SPH_COEFF = {"h": [LENGTH], "c": [SOUND], "alpha": [NOT_NEGATIVE], "beta": [NOT_NEGATIVE], "deltap": [SPACING]}
KERNELS = ["cubicspline", "wendland", "cubicspline2d", "wendland2d"]
B, RHO = positive("57142.9", "300"), positive("1000")
PRESSURES = [("absolut", [positive("20", "7")]), ("relativ", [B, RHO]), ("relativ", [B, RHO, ANY]),
             ("Tait", [B, RHO, POSITIVE]), ("Tait", [B, RHO, POSITIVE, ANY])]
PLANE = Number(lambda v: True, ["-0.01", "-0.02"], ["0.06", "0.01"])
FAR = Number(lambda v: True, ["0.06", "0.04"], ["-0.01", "0.01"])


def water(case, scene=WATER, **instead):
    """The scene, with some of its lines replaced. The tried line is the one that is replaced first."""
    lines = {"pair": "pair_style sph/artVisc/tensCorr wendland 0.013 artVisc 0.1 0 1.7e-6 tensCorr 0.2 0.01 "
                     "viscosity 1e-3",
             "coeff": "pair_coeff * * c 20", "eos": "fix eos all sph/pressure Tait 57142.9 1000 7",
             "density": "fix density all sph/density/continuity", "move": "fix move all nve/sph"}
    tried = next(iter(instead.values()))
    lines.update(instead)
    case.lines = scene.split("\n") + [line for line in lines.values() if line]
    case.tried = case.lines.index(tried)


def violent(words, limit=1e5):
    """Particles fly apart."""
    return any(abs(decimal(w) or 0.0) > limit for w in words)


def make_sph_pair(case):
    case.style = "sph/artVisc/tensCorr"
    words = case.damaged([case.draw.choice(KERNELS)] + write(LENGTH, case.draw) + case.words_of(SPH_PAIR, few=3))
    c = case.draw.random() < 0.9
    water(case, pair="pair_style sph/artVisc/tensCorr " + " ".join(words), coeff="pair_coeff * *" + " c 20" * c)
    if not case.judge(words, SPH_PAIR, [("kernel", Choice(*KERNELS)), ("h", LENGTH)]):
        case.faults += ["kernel", words[0] if words else "kernel"]
        return
    h = float(case.value("h"))
    if h > 1:
        case.says(ODD, "")      # many times the box
    case.extreme |= violent(words)
    case.refuse_if("artVisc" in case.settings and not c, "artVisc")
    moved = [name for name in ("shift", "correction") if case.settings.get(name, [""])[0] in ("yes", "pliant")]
    case.refuse_if(moved, "shift", "correction")    # the scene has no delta
    case.refuse_if("tensCorr" in case.settings and float(case.settings["tensCorr"][1]) >= 2 * h, "deltap")


def make_sph_order(case):
    """Shift, correction, central viscosity, two fluids and delta: what goes with what. The pair style or the density is
    damaged."""
    draw = case.draw
    case.style = "sph/artVisc/tensCorr"
    bulk, walled, mover = draw.random() < 0.6, draw.random() < 0.1, draw.choice(["nve/sph"] * 9 + ["sph"])
    kernel, h = draw.choice(["wendland"] * 5 + ["cubicspline", "wendland2d"]), draw.choice(["0.013", "0.012", "0.015"])
    terms = [name for name, chance in (("artVisc", 0.3), ("tensCorr", 0.15), ("viscosity", 0.5), ("shift", 0.5),
                                       ("correction", 0.5))
             if draw.random() < chance]
    words = [w for name in terms for w in [name] + [w for kind in SPH_PAIR[name] for w in write(kind, draw)]]
    density = [w for name in SPH_DENSITY if draw.random() < (0.85 if name == "delta" else 0.25)
               for w in [name] + [w for kind in SPH_DENSITY[name] for w in write(kind, draw)]]
    first = draw.random() < 0.6
    words, density = (case.damaged(words), density) if first else (words, case.damaged(density))
    lines = {"pair": f"pair_style sph/artVisc/tensCorr {kernel} {h} " + " ".join(words),
             "density": "fix density all sph/density/continuity " + " ".join(density)}
    lines = lines if first else dict(reversed(lines.items()))
    water(case, BULK if bulk else WATER, **lines, move=f"fix move all {mover}",
          **({"wall": "fix around all wall/region/sph zone 0.005 0"} if walled else {}))
    case.extreme |= violent(words + density)
    yes = lambda name: case.value(name, "no") == "yes"
    names = ("shift", "correction", "volume")
    if not case.judge(words, SPH_PAIR):
        return
    pliant = case.value("shift") == "pliant"
    case.refuse_if(yes("correction") and case.value("shift") in ("no", "pliant"), *names)
    if not case.judge(density, SPH_DENSITY):
        return
    corrects, volume, tensile = yes("correction"), yes("volume"), "tensCorr" in case.settings
    case.refuse_if(volume and (tensile or mover == "sph"), *names)
    case.refuse_if(tensile and float(case.settings["tensCorr"][1]) >= 2 * float(h), "deltap")
    if not (corrects or yes("shift") or pliant):
        return
    case.refuse_if(pliant and volume, *names)
    case.refuse_if(tensile or mover == "sph" or kernel == "wendland2d", *names)
    case.refuse_if(not float(case.value("delta", "0")) > 0, *names)
    case.refuse_if(kernel == "cubicspline" and not corrects, *names)
    case.refuse_if(corrects and (walled or not bulk), *names)


def make_sph_global(case):
    """Speed of sound or smoothing length of each type, beside pair_coeff or instead of it."""
    case.style, draw = "property/global", case.draw
    kinds = {"speedOfSound": SOUND, "sl": LENGTH}
    name = draw.choice(list(kinds))
    words = case.damaged([name, "peratomtype"] + [w for _ in range(2) for w in write(kinds[name], draw)])
    c = draw.random() < 0.5
    water(case, wide="fix wide all property/global " + " ".join(words), coeff="pair_coeff * *" + " c 20" * c)
    case.extreme |= violent(words)
    kind = kinds.get(words[0] if words else "", SOUND)
    if not case.judge(words, {}, [("property", Choice(*kinds)), ("kind", Choice("peratomtype")), (name, kind),
                                  (name, kind)]):
        case.faults += words[:1]
        return
    lengths = words[0] == "sl"
    case.refuse_if(lengths and not c, "artVisc")
    values = [float(w) for w in words[2:4]]
    case.refuse_if(lengths and min(values) <= 0.005, "deltap")
    if lengths and max(values) > 1:
        case.says(ODD, "")


def make_sph_coeff(case):
    case.style = "sph/artVisc/tensCorr"
    types = case.draw.choice([["*", "*"], ["*", "*"], ["1", "2"], ["1*2", "1*2"], ["2", "1"], ["1", "3"], ["0", "*"]])
    words = case.damaged(types + case.words_of(SPH_COEFF, ["c"], few=4))
    water(case, coeff="pair_coeff " + " ".join(words))
    case.extreme |= violent(words)
    usual = words[:2] in (["*", "*"], ["1*2", "1*2"])
    if not usual:
        case.says(ODD, "")      # pairs of types are LAMMPS's; missing ones too
    if not case.judge(words[2:], SPH_COEFF):
        if not usual:
            case.faults.append("")
        return
    case.refuse_if(usual and "c" not in case.settings, "artVisc")
    h = float(case.value("h", "0.013"))
    case.refuse_if(usual and float(case.value("deltap", "0.01")) >= 2 * h, "deltap")


def make_sph_pressure(case):
    case.style = "sph/pressure"
    name, kinds = case.draw.choice(PRESSURES)
    tension = case.draw.choice([[], [], ["tension", "yes"], ["tension", "no"]])
    words = case.damaged([name] + [w for kind in kinds for w in write(kind, case.draw)] + tension)
    group = case.draw.choice(["all"] * 6 + ["fluid", "nobody"])
    water(case, eos=f"fix eos {group} sph/pressure " + " ".join(words))
    ways = [kinds for name, kinds in PRESSURES if words[:1] == [name]] or [[B]]
    numbers = words[:words.index("tension")] if "tension" in words else words
    kinds = max((k for k in ways if len(k) < len(numbers)), key=len, default=ways[0])
    first = words[0] if words else ""
    case.judge(words, {"tension": [YES_NO]}, [("equation of state", Choice("absolut", "relativ", "Tait"))] +
               [(first, k) for k in kinds])
    case.refuse_if(first == "absolut" and case.value("tension", "yes") == "no", "tension")
    if case.level == BAD:
        case.faults += words[:1] + ["equation of state"]
    elif group != "all":
        case.says(ODD, "")
    case.extreme |= violent(words, 1e8)


def make_sph_density(case):
    draw = case.draw
    what = draw.choice(["continuity", "summation", "corr"])
    case.style = "sph/density/" + what
    grammar = {"continuity": SPH_DENSITY, "summation": {}, "corr": {}}[what]
    begin = [("shepard", Choice("shepard")), ("every", Choice("every")), ("every", COUNT)] if what == "corr" else []
    words = case.damaged([w for _, kind in begin for w in write(kind, draw)] + case.words_of(grammar, few=len(grammar)))
    name, group = "filter" if what == "corr" else "density", draw.choice(["all"] * 5 + ["fluid", "nobody"])
    water(case, **{name: f"fix {name} {group} {case.style} " + " ".join(words)})
    if not case.judge(words, grammar, begin):
        case.faults += ["shepard", "every"] if what == "corr" else []
        return
    case.refuse_if(case.value("volume") == "yes", "volume")     # the scene has tensCorr


def make_sph_move(case):
    draw = case.draw
    case.style = draw.choice(["nve/sph", "nve/sph/stationary"])
    words = case.damaged([]) if draw.random() < 0.5 else []
    water(case, move=f"fix move {draw.choice(['all', 'fluid', 'wall', 'nobody', 'missing'])} {case.style} " +
          " ".join(words))
    if "missing" in case.lines[case.tried].split()[2]:
        case.says(BAD, "group")
    case.refuse_if(bool(words), *words[:1])


def make_sph_wall(case):
    draw = case.draw
    rest = [("wall", positive("0.01", "0.005")), ("wall", NOT_NEGATIVE)]
    kind = draw.choice(["plane", "cylinder", "region"])
    if kind == "region":
        case.style, begin = "wall/region/sph", [("region", Name("zone", "part"))] + rest
    elif kind == "cylinder":
        case.style, begin = "wall/sph", [("wall", Choice("zcylinder")), ("zcylinder", positive("0.2"))] + rest
    else:
        planes = [("wall", Choice("xplane", "yplane", "zplane")), ("plane", NumberOr("NULL", PLANE)),
                  ("plane", NumberOr("NULL", FAR))]
        case.style, begin = "wall/sph", planes + rest
    words = case.damaged([w for _, k in begin for w in write(k, draw)])
    water(case, wall=f"fix wall all {case.style} " + " ".join(words))
    if not case.judge(words, {}, begin):
        case.faults += words[:1] + ["wall", "region", "plane"]
    elif kind == "plane":
        lo, hi = words[1:3]
        if lo == hi == "NULL":
            case.says(ODD, words[0])
        case.refuse_if("NULL" not in (lo, hi) and float(lo) >= float(hi), words[0])
    case.extreme |= violent(words, 1.0)     # r0, D


ADAMI = {"gravity": [ANY, ANY, ANY], "slip": [YES_NO], "suction": [YES_NO]}


def make_sph_adami(case):
    case.style = "wall/adami/sph"
    words = case.damaged(case.words_of(ADAMI, few=2))
    group = case.draw.choice(["wall"] * 6 + ["all", "nobody"])
    water(case, adami=f"fix tank {group} wall/adami/sph " + " ".join(words), move="fix move fluid nve/sph")
    case.judge(words, ADAMI)
    if group != "wall":
        case.says(ODD, "")
    case.extreme |= violent(words)


# Particles stand at 0 to 0.03, the box ends at -0.05 and 0.08.
FACES = ["xlo", "xhi", "ylo", "yhi", "zlo", "zhi"]
OPENING = [("FACE", Choice(*FACES)),
           ("POSITION", Number(lambda v: True, ["0.005", "0.025", "0.015"], ["0.06", "-0.03", "-2"])),
           ("WIDTH", positive("0.04", "0.041", border=["0", "-1", "0.03", "0.07"]))]
SPEED = Field(lambda v: True, ["1", "0", "0.3"])
ENDS = {"inlet": {"velocity": [SPEED], "gravity": [Field(lambda v: True, ["0", "-9.81"], atom=False)] * 3},
        "outlet": {"pressure": [Field(lambda v: True, ["0", "100", "-3"])]}}


def make_sph_opening(case):
    draw, end = case.draw, case.draw.choice(list(ENDS))
    case.style, grammar = "sph/" + end, ENDS[end]
    face = draw.choice(FACES)
    place = draw.choice(["0.005", "0.015"] if face.endswith("lo") else ["0.025", "0.015"])
    words = [face, place] if draw.random() < 0.8 else [w for _, kind in OPENING[:2] for w in write(kind, draw)]
    words = case.damaged(words + write(OPENING[2][1],
                                       draw) + case.words_of(grammar, ["velocity"] if end == "inlet" else [], few=1))
    group = draw.choice(["all"] * 6 + ["fluid", "nobody"])
    water(case, WATER.replace("variable eta equal 1.5", VARIABLES),
          opening=f"fix end {group} sph/{end} " + " ".join(words))
    case.extreme |= violent(words)
    if not case.judge(words, grammar, OPENING):
        case.faults += ["FACE", "POSITION", "WIDTH"]
        return
    case.refuse_if(end == "inlet" and "velocity" not in case.settings, "velocity")
    face, plane, width = (case.value(name) for name, _ in OPENING)
    plane, width, side = float(plane), float(width), -1 if face.endswith("lo") else 1
    case.refuse_if(plane + width > 0.08 if side > 0 else plane - width < -0.05, "layer")
    spheres = {"all": (0.0, 0.03), "fluid": (0.01 if face == "zlo" else 0.0, 0.03), "nobody": None}[group]
    case.refuse_if(spheres and width < 0.039 or width < 0.003, "width")
    empty = not spheres or (spheres[0] > plane if side < 0 else spheres[1] < plane)
    case.refuse_if(end == "inlet" and empty, "layer")


def make_sph_check(case):
    case.style = "check/timestep/sph"
    begin = [("N", COUNT), ("fraction", Number(lambda v: v > 0, ["0.3", "0.25"], ["0", "-1", "1.5"],
                                               odd=lambda v: v > 1))]
    words = case.damaged([w for _, k in begin for w in write(k, case.draw)] +
                         case.draw.choice([[], ["warn"], ["stop"]]))
    water(case, check="fix limit all check/timestep/sph " + " ".join(words))
    if not case.judge(words, {"warn": [], "stop": []}, begin):
        case.faults += ["form", "N", "fraction"]


class Angles:
    """TYPE ANGLE, once or more"""
    TYPE = Integer(lambda v: v in (1, 2), ["2"], ["1", "0", "3"])
    ANGLE = Number(lambda v: 0 < v < 180, ["60", "90", "120.5"], ["0", "180", "-1", "1e-3"])

    def write(self, draw):
        return [w for _ in range(draw.choice([1, 1, 1, 2])) for kind in (self.TYPE, self.ANGLE)
                for w in write(kind, draw)]

    def read(self, case):
        words = read(self.TYPE, case) + read(self.ANGLE, case)
        while case.at < len(case.words) and decimal(case.words[case.at]) is not None:
            words += read(self.TYPE, case) + read(self.ANGLE, case)
        case.types = getattr(case, "types", []) + words[::2]
        return words


TENSION = {"contact": [Angles()], "force": [YES_NO]}


def make_sph_tension(case):
    case.style, draw = "sph/tension", case.draw
    walled, shift = draw.random() < 0.6, draw.choice(["yes"] * 8 + ["pliant", "no"])
    volume, group = draw.choice(["no"] * 9 + ["yes"]), draw.choice(["all"] * 6 + ["fluid", "nobody", "wall"])
    words = case.damaged(write(positive("0.072", "0.5", border=["0", "-1", "99", "101"]),
                               draw) + case.words_of(TENSION, few=2))
    water(case, tension=f"fix pull {group} sph/tension " + " ".join(words),
          pair=f"pair_style sph/artVisc/tensCorr wendland 0.013 viscosity 1 central shift {shift}",
          density=f"fix density all sph/density/continuity delta 0.1 volume {volume}",
          **({"walls": "fix tank wall wall/adami/sph", "move": "fix move fluid nve/sph"} if walled else {}))
    case.lines.append(case.lines.pop(case.tried))       # the pair style first
    case.tried = len(case.lines) - 1
    if not case.judge(words, TENSION, [("SIGMA", positive("0.072"))]):
        return
    types = getattr(case, "types", [])
    case.refuse_if(len(set(map(int, types))) < len(types), "contact")
    case.refuse_if(any(int(t) != 2 or not walled for t in types), "contact")
    case.refuse_if(shift == "no", "shift")
    case.refuse_if(volume == "yes", "volume", "shift")      # shift pliant refuses it too
    case.refuse_if(group in ("nobody", "wall") or group == "fluid" and not walled, "group")
    sigma = float(case.value("SIGMA"))
    case.extreme |= sigma > 400
    case.refuse_if(sigma > 100 and case.value("force", "no") == "no", "Ohnesorge")


# 8 grains (type 3) in the water
WET = BULK.replace("atom_style sph", "atom_style hybrid sph sphere").replace("create_box 2 box",
                                                                             "create_box 3 box").replace(
    "mass * 0.001", "mass * 0.001\ncreate_atoms 3 random 8 4711 box\nset type 3 diameter {diameter} density 2650\n"
    "set type 1*2 mass 0.001\n"
    "group grains type 3\ngroup sph type 1 2").replace("set group all sph/rho 1001",
                                                       "set group sph sph/rho 1001\ncomm_modify vel yes")
OF_BED = ["ergun", "gidaspow", "beetstra", "koch_hill"]
GRAINS = {"viscosity": [positive("1e-3")],
          "drag": [Choice("yade", "schiller_naumann", "brown_lawler", "ferguson_church", *OF_BED)],
          "hindrance": [Or(richardson_zaki=[], di_felice=[], otherwise=[NOT_NEGATIVE])],
          "fall_diameter": [positive("0.7", "1", "1.3")], "displace": [YES_NO], "own_flow": [YES_NO]}


def make_sph_grains(case):
    case.style, draw = "sph/grains", case.draw
    diameter, wet = draw.choice(["0.005"] * 6 + ["0.0065", "0.0066", "0.02"]), draw.random() < 0.9
    group, volume = draw.choice(["grains"] * 8 + ["nobody", "all", "sph"]), draw.choice(["yes"] * 9 + ["no"])
    words = case.damaged(case.words_of(GRAINS, few=3))
    water(case, WET.format(diameter=diameter), grains=f"fix drag {group} sph/grains " + " ".join(words),
          pair="pair_style hybrid/overlay sph/artVisc/tensCorr wendland 0.013 " +
          ("viscosity 1e-3" if wet else "artVisc 0.1 0 1.7e-6") + " zero 0.01",
          coeff="pair_coeff * * zero", more="pair_coeff 1*2 1*2 sph/artVisc/tensCorr c 20",
          eos="fix eos sph sph/pressure Tait 57142.9 1000 7",
          density=f"fix density sph sph/density/continuity delta 0.1 volume {volume}",
          move="fix move sph nve/sph", roll="fix roll grains nve/sphere")
    case.lines.append(case.lines.pop(case.tried))       # the pair style first
    case.tried = len(case.lines) - 1
    case.extreme |= violent(words)
    if not case.judge(words, GRAINS):
        return
    case.refuse_if(case.value("drag") in OF_BED and "hindrance" in case.settings, "hindrance")
    case.refuse_if(group in ("all", "sph"), "group")
    case.refuse_if(not wet and "viscosity" not in case.settings, "viscosity")
    case.refuse_if(volume == "no", "volume")
    case.refuse_if(float(diameter) > 0.0065 and group == "grains", "smoothing length")
    if group == "nobody":
        case.says(ODD, "")
