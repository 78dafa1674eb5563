"""Scenes, grammar and rules of pair_style and fix stokes_dynamics, written from their pages (for fuzz.py)."""
from fuzz_grammar import (BAD, COUNT, GOOD, ODD, U, VARIABLES, YES_NO, Choice, Field, Integer, MaybeNumber, Name,
                          Number, NumberOr, Or, delete_something, positive)

BOX = 18.0
SPHERES = """units lj
atom_style {style}
atom_modify map array
boundary {boundary}
plugin load stokesdynplugin.so
region box block -9 9 -9 9 -9 9
create_box 1 box
create_atoms 1 single -4 0 0
create_atoms 1 single -2 0 0
create_atoms 1 single 0 0.1 0
create_atoms 1 single 3 3 0
create_atoms 1 single 3 4.9 0.2
create_atoms 1 single -3 -4 4
{radii}
{molecules}
velocity all set 0.1 -0.2 0.3
velocity all create 0.5 4711 loop geom
{variables}
region zone block INF INF INF INF INF INF
region part block -3 20 -20 20 -20 20
region nowhere block 8 8.5 8 8.5 8 8.5
group g id 1 2 3
group half id 1 2 6
group nobody empty
timestep 1e-4
thermo 100000"""

WALL = NumberOr("EDGE", Number(lambda v: True, ["-8.5", "-20"], ["0", "8", "nan"], odd=lambda v: v > -8))

STOKES = {
    "cut_off_distance": [Number(lambda v: v > 0, ["inf", "inf", "inf", "12", "4.5", "1e-6"],
                                ["200", "0", "-1", "1e300", "INF"])],
    "visc": [Field(lambda v: v > 0, ["1", "0.625", "1e-3"], ["0", "-1", "1e-300", "1e300"])],
    "update_every": [COUNT], "clumps_only": [YES_NO], "region": [Name("zone", "part", "nowhere")],
    "group": [Name("all", "g", "half", "nobody")], "add_force": [YES_NO],
    "relative_tolerance": [Number(lambda v: 0 < v < 1, ["1e-3", "1e-8", "1e-2"],
                                  ["0", "-1", "1", "2", "0.5", "1e-300", "0.1"],
                                  odd=lambda v: v == 0.1, loud=lambda v: v > 0.1)],
    "max_iter": [Integer(lambda v: v >= 1, ["100", "1", "1000"], ["0", "-5", "2147483647"], odd=lambda v: v == 0)],
    "algorithm": [Choice("1", "2", "2", "2")], "fluid_velocity": [Or([U, U, U], box=[])],
    "tensor": [Choice("rpy", "rpy", "rpy", "oseen")], "taper": [Choice("none", "wendland", "spherical")],
    "lubrication": [YES_NO], "lubrication_gap": [Number(lambda v: v >= 1e-6, ["1e-3", "0.01"], ["0", "-1", "1e-7"])],
    "lubrication_range": [Number(lambda v: 0 < v <= 8, ["2", "1", "8"], ["0", "-1", "9", "1e-3"],
                                 odd=lambda v: v == 1e-3)],
    "precondition": [Choice("auto", "none", "clump", "sparse", "waves")],
    "far_field": [Choice("auto", "direct", "ewald")],
    "far_field_tolerance": [Number(lambda v: 1e-13 <= v <= 0.1, ["1e-3", "1e-6"], ["0", "-1", "1", "1e-14", "0.11"])],
    "warm_start": [YES_NO], "rotation": [YES_NO], "fluid_vorticity": [U, U, U],
    "rigid_clumps": [Choice("yes", "no", "auto")],
    "multiblob": [Integer(lambda v: v in (1, 12, 42), ["1", "12", "42"], ["0", "2", "-1", "13", "2147483648"])],
    "one_body": [YES_NO], "wall": [Choice("zlo", "zlo", "xlo", "ylo"), WALL], "flow": [Choice("pressure", "flux")],
    "shell": [Integer(lambda v: v == 1 or v >= 12, ["1", "12", "13", "42"],
                      ["0", "2", "11", "-1", "2147483647", "2147483646", "2147483648"], odd=lambda v: v > 500)],
}


for key, word in (("cut_off_distance", "inf"), ("far_field_tolerance", "auto")):
    STOKES[key] = [NumberOr(word, STOKES[key][0])]


def spheres(case):
    """A scene; how it differs from the usual one."""
    how = case.draw.choices(["open", "periodic", "no molecules", "no radius"], [70, 18, 9, 3])[0]
    style = {"no molecules": "sphere", "no radius": "bond"}.get(how, "hybrid sphere bond")
    radii = "mass 1 1" if how == "no radius" else "set group all diameter 2 density 1.7\nset atom 5 diameter 1.6"
    molecules = "" if how == "no molecules" else "set atom 1*3 mol 1\nset atom 4*5 mol 2"
    radii += "\nmass 1 1" * (style == "hybrid sphere bond")
    boundary = "p p p" if how == "periodic" else "f f f"
    case.lines = SPHERES.format(style=style, boundary=boundary, radii=radii, molecules=molecules,
                                variables=VARIABLES).split("\n")
    return how


def judge_stokes(case, words, how):
    """The rules of the page beyond single words."""
    if not case.judge(words, STOKES) and "wall" in words:
        case.faults.append("wall")     # a second one is looked for before all else
    s = case.value
    cut, clumps = s("cut_off_distance"), s("clumps_only") == "yes"
    shell, rigid = int(s("shell", "1")), s("rigid_clumps", "no")
    case.refuse_if(how == "no radius", "radius")
    case.refuse_if("visc" not in case.settings, "visc")
    case.refuse_if(cut is None and not clumps, "cut_off_distance")
    everybody, far, sparse = cut == "inf" and not clumps, s("far_field", "auto"), s("precondition") == "sparse"
    case.refuse_if("far_field" in case.settings and not everybody, "far_field")
    case.refuse_if("far_field_tolerance" in case.settings and (not everybody or far == "direct"), "far_field_tolerance")
    case.refuse_if(far == "ewald" and s("tensor") == "oseen", "far_field", "tensor")
    case.refuse_if(far == "ewald" and sparse, "precondition", "far_field")
    case.refuse_if(everybody and how == "periodic" and (sparse or far == "direct" or s("tensor") == "oseen"),
                   "far_field", "precondition", "tensor")
    case.refuse_if(s("precondition") == "waves" and (not everybody or how != "periodic" or s("algorithm", "1") != "2"),
                   "precondition")
    lubricated = s("lubrication") == "yes"
    reach = s("lubrication_range", "1" if s("multiblob", "1") != "1" else "2")
    blobs = int(s("multiblob", "1"))
    turns = s("rotation") == "yes" or shell != 1 or blobs != 1
    case.refuse_if(lubricated and (not everybody or not turns), "lubrication")
    case.refuse_if(blobs != 1 and (not everybody or s("tensor") == "oseen" or "shell" in case.settings or
                                   s("rotation") == "no" or "precondition" in case.settings or case.level != BAD and
                                   lubricated and float(reach) > 2),
                   "multiblob", "lubrication_range")
    case.refuse_if(blobs == 1 and "one_body" in case.settings, "one_body")
    case.refuse_if("flow" in case.settings, "flow")      # there is one wall at most
    if "wall" in case.settings:
        case.refuse_if(how == "periodic" or s("tensor") == "oseen" or far == "ewald" and turns and blobs == 1
                       or s("precondition") == "waves" or shell != 1 or rigid != "no" and clumps, "wall")
        if s("fluid_velocity") or case.settings["wall"][1] == "EDGE":
            case.says(ODD, "wall", "fluid_velocity")
    judge_stokes_choices(case, how)


def judge_stokes_choices(case, how):
    """Films, clumps and what goes with them"""
    s = case.value
    cut, clumps = s("cut_off_distance"), s("clumps_only") == "yes"
    shell, rigid, rotation = int(s("shell", "1")), s("rigid_clumps", "no"), s("rotation") == "yes"
    turns = rotation or shell != 1 or int(s("multiblob", "1")) != 1
    lubricated, gap = s("lubrication") == "yes", s("lubrication_gap", "1e-3")
    reach = s("lubrication_range", "1" if s("multiblob", "1") != "1" else "2")
    case.refuse_if(not lubricated and "lubrication_gap" in case.settings, "lubrication_gap")
    case.refuse_if(not lubricated and "lubrication_range" in case.settings, "lubrication_range")
    case.refuse_if(case.level != BAD and float(gap) >= float(reach), "lubrication_gap")
    case.refuse_if(clumps and how in ("no molecules", "no radius"), "clumps_only", "molecule", "radius")
    case.refuse_if(s("taper", "none") != "none" and cut in (None, "inf"), "taper")
    case.refuse_if(s("precondition") == "sparse" and cut != "inf", "precondition")
    case.refuse_if(s("precondition") in ("clump", "sparse") and s("algorithm", "1") != "2" and rigid != "yes",
                   "precondition")
    case.refuse_if(s("precondition") == "clump" and how == "no molecules", "precondition")
    case.refuse_if(rotation and s("tensor") == "oseen", "rotation", "tensor")
    case.refuse_if(rigid != "no" and how in ("no molecules", "no radius"), "rigid_clumps", "molecule", "radius")
    case.refuse_if(rigid == "auto" and not clumps or rigid != "no" and not clumps and not turns, "rigid_clumps")
    case.refuse_if(rigid != "no" and clumps and cut not in (None, "inf"), "rigid_clumps", "cut_off_distance")
    if rigid != "no" and cut == "inf":
        case.says(ODD, "rigid_clumps", "cut_off_distance")
    case.refuse_if(rigid != "no" and s("tensor") == "oseen", "rigid_clumps", "tensor")
    case.refuse_if(shell != 1 and rigid == "no", "shell")
    case.refuse_if("fluid_vorticity" in case.settings and (not turns or s("fluid_velocity") == "box"),
                   "fluid_vorticity")
    case.refuse_if(rigid == "yes" and (s("region") == "part" or s("group") == "half"), "region", "group")
    if cut not in (None, "inf") and float(cut) > 100 * BOX:
        case.says(ODD, "cut_off_distance")
    if cut not in (None, "inf") and how == "periodic" and not clumps:
        case.says(ODD if float(cut) > BOX else GOOD)
    if "precondition" in case.settings and rigid != "no" or shell == 1 and "shell" in case.settings or shell > 500 \
            or rigid == "auto" or clumps and s("precondition") == "sparse":
        case.says(ODD, "precondition", "shell")


# A periodic box that deforms
DEFORMS = ["x erate 0.2", "z vel -0.3", "x final -8 9 z volume", "xy erate 0.5", "yz wiggle 0.3 1e-3",
           "y erate 0.1 xz erate -0.3"]


def deform(case):
    """Adds fix deform, and what the page says of how it moves atoms: remap x, v, none."""
    how, remap = case.draw.choice(DEFORMS), case.draw.choice(["v"] * 6 + ["x", "none"])
    if any(tilt in how for tilt in ("xy", "yz", "xz")):
        case.lines.append("change_box all triclinic")
    case.lines.append(f"fix shear all deform 1 {how} remap {remap}")
    return remap


def judge_deform(case, remap):
    fluid = case.settings.get("fluid_velocity", ["0"])
    moves, clumps = fluid[0] == "box" or "v_place" in fluid, case.value("rigid_clumps", "no") != "no"
    case.refuse_if(moves and remap != "v" or clumps and remap == "x", "remap")


def forgive_unselected(case):
    """Values that nobody asks for need not be right."""
    asked = {k for k, words in case.settings.items() if any(w.startswith("v_") for w in words)}
    if (case.value("region") == "nowhere" or case.value("group") == "nobody") and case.level == BAD and set(
        case.faults) <= asked:
        case.level = ODD


def make_stokes(case):
    case.style, how = "stokes_dynamics", spheres(case)
    required = ["visc"] + case.draw.choice([["cut_off_distance"], ["clumps_only"], ["cut_off_distance", "algorithm"]])
    words = case.damaged(case.words_of(STOKES, required))
    if how == "periodic":       # 55 boxes take LAMMPS half a minute; 11 are warned of as well
        words = ["200" if w == "1e3" else w for w in words]
    remap = deform(case) if how == "periodic" and case.draw.random() < 0.5 else None
    case.tried = len(case.lines)
    case.lines += ["pair_style stokes_dynamics " + " ".join(words), "pair_coeff * *"]
    judge_stokes(case, words, how)
    if remap:
        judge_deform(case, remap)
    forgive_unselected(case)
    if case.draw.random() < 0.5:
        case.lines.append("fix drag all stokes_dynamics")
    if how != "no radius":
        case.lines.append("fix move all nve/sphere")
    delete_something(case, "region", "group")


def make_stokes_coeff(case):
    case.style = "stokes_dynamics"
    case.refuse_if(spheres(case) == "no radius", "radius")
    words = case.damaged(["*", "*"])
    case.lines += ["pair_style stokes_dynamics clumps_only no cut_off_distance 1e-6 visc 1"]
    case.tried = len(case.lines)
    case.lines.append("pair_coeff " + " ".join(words))
    case.says(GOOD if words == ["*", "*"] else ODD, "pair_coeff")
    case.refuse_if(len(words) > 2, "pair_coeff", "pair_style")


def make_stokes_fix(case):
    case.style, add = "stokes_dynamics", case.draw.choice(["yes", "no"])
    spheres(case)
    pair = case.draw.random() < 0.9
    if pair:
        case.lines += [f"pair_style stokes_dynamics cut_off_distance 1e-6 visc 1 add_force {add}", "pair_coeff * *"]
    words = case.damaged(case.words_of({"apply": [YES_NO]}, few=1))
    second = case.draw.random() < 0.1
    case.tried = len(case.lines)
    case.lines.append("fix drag " + case.draw.choice(["all", "g", "nobody"]) + " stokes_dynamics " + " ".join(words))
    if second:
        case.lines.append("fix other all stokes_dynamics apply yes")
    if "no radius" not in case.lines and case.judge(words, {"apply": [YES_NO]}):
        applies = case.value("apply", "yes" if add == "no" else "no") == "yes"
        case.refuse_if(not pair, "pair_style")
        case.refuse_if(applies and add == "yes" or second and (applies or add == "yes"), "apply", "add_force")
    if any(line == "atom_style bond" for line in case.lines):
        case.says(BAD, "radius")


OVERDAMPED = {
    "scheme": [Choice("ab2", "euler", "midpoint")], "held": [Name("g", "half", "nobody")],
    "pin": [Name("g", "half", "nobody")], "torque": [Name("g", "half", "nobody")] +
    [Field(lambda v: True, ["0", "0.5", "-2"], ["1e3"])] * 3,
    "squirm": [Name("g", "half", "nobody")] + [Field(lambda v: True, ["0", "0.5", "-2"], ["1e3"])] * 2,
    "adapt": [COUNT, positive("1e-6", "1e-5"), positive("1e-5", "1e-4"), positive("0.01", "1")],
    "temperature": [Field(lambda v: v >= 0, ["1", "0.2", "0"], ["-1", "1e300"], atom=False),
                    Integer(lambda v: 0 < v < 2**31, ["1", "4711"], ["0", "-3", "2147483647", "2147483648"])],
    "spin": [Name("g", "half", "nobody")] + [Number(lambda v: True, ["0", "0.5", "-2"], ["1e3"])] * 3 +
    [MaybeNumber(positive("0.1", "50"))],
    "noise_tolerance": [Number(lambda v: 0 < v < 0.5, ["0.01", "0.1"], ["0", "0.5", "-1", "1e-300"],
                               odd=lambda v: v < 1e-6)],
}
FLUIDS = ["", "rotation yes", "multiblob 12", "multiblob 12 lubrication yes", "rotation yes lubrication yes",
          "wall zlo -8.5", "multiblob 12 wall zlo -8.5", "rigid_clumps yes rotation yes", "rigid_clumps yes shell 12",
          "wall zlo -8.5 far_field ewald", "multiblob 12 wall zlo -8.5 far_field ewald"]
# in a periodic box that deforms
CARRIED = ["fluid_velocity box" + more for more in ("", " rotation yes lubrication yes", " multiblob 12",
                                                    " rigid_clumps yes rotation yes")]


def judge_overdamped(case, words, fluid):
    """The rules of the page beyond single words."""
    understood = case.judge(words, OVERDAMPED)
    adapt = case.settings.get("adapt")
    case.refuse_if(adapt and adapt[1] != adapt[2] and float(adapt[1]) > float(adapt[2]), "adapt")
    if not understood:
        return
    given, scheme, T = case.settings, case.value("scheme", ""), case.value("temperature", "0")
    case.refuse_if("noise_tolerance" in given and "temperature" not in given, "noise_tolerance")
    case.refuse_if(fluid.startswith("rigid") and case.value("held") == "half", "held")     # a clump in part
    case.refuse_if(fluid.startswith("rigid") and case.value("pin") == "half", "pin")
    for one, other in (("held", "pin"), ("pin", "spin"), ("held", "torque")):
        case.refuse_if({case.value(one), case.value(other)} <= {"g", "half"}, one, other)
    # no dipoles
    case.refuse_if("squirm" in given and ("multiblob" not in fluid or case.value("squirm") != "nobody"), "squirm")
    if "torque" in given:
        turns = any(word in fluid for word in ("rotation", "multiblob", "shell"))
        case.refuse_if(not turns and case.value("torque") != "nobody", "torque")
        case.says(ODD)
    if "spin" in given:
        case.refuse_if(not any(word in fluid for word in ("rotation", "multiblob", "shell")), "spin", "rotation")
        # no free spheres there
        case.refuse_if(fluid.startswith("rigid") and case.value("spin") != "nobody", "spin")
        case.refuse_if({case.value("held"), case.value("spin")} <= {"g", "half"}, "spin", "held")
        case.refuse_if(len(given["spin"]) == 5 and not any(float(w) for w in given["spin"][1:4]), "spin")
        case.says(ODD)
    if T in ("0", "v_zero"):
        case.says(ODD if "temperature" in given or scheme == "midpoint" else GOOD)
        return
    drift = ("held" in given or "pin" in given or "spin" in given or
             any(word in fluid for word in ("lubrication", "multiblob", "wall", "rigid")))
    case.refuse_if("adapt" in given or drift and scheme in ("ab2", "euler"), "temperature", "scheme")
    case.says(ODD)        # a step may be too long for such a temperature


def make_overdamped(case):
    case.style, fluid = "stokes_dynamics/overdamped", case.draw.choice(FLUIDS + CARRIED)
    while spheres(case) in ("no radius", "no molecules"):
        pass
    case.lines[3] = "boundary p p p" if fluid in CARRIED else "boundary f f f"
    remap = deform(case) if fluid in CARRIED else "v"
    words = case.damaged(case.words_of(OVERDAMPED, few=3))
    case.lines += [f"pair_style stokes_dynamics cut_off_distance inf visc 1 {fluid}", "pair_coeff * *",
                   "fix weight all addforce 0 0 -1"]
    case.tried = len(case.lines)
    case.lines.append("fix move all stokes_dynamics/overdamped " + " ".join(words))
    judge_overdamped(case, words, fluid)
    case.refuse_if(remap == "x", "remap")
    case.refuse_if(fluid in CARRIED and "adapt" in case.settings, "adapt")
    if remap == "none":
        case.says(ODD)
