"""Scenes, grammar and rules of pair_style and fix stokes_dynamics, written from their pages (for fuzz.py)."""
from fuzz_grammar import (BAD, COUNT, GOOD, LOUD, ODD, U, VARIABLES, YES_NO, Choice, Field, Integer, Name, Number, NumberOr,
                          delete_something)

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

STOKES = {
    "cut_off_distance": [Number(lambda v: v > 0, ["inf", "inf", "inf", "12", "4.5", "1e-6"], ["200", "0", "-1", "1e300", "INF"])],
    "visc": [Field(lambda v: v > 0, ["1", "0.625", "1e-3"], ["0", "-1", "1e-300", "1e300"])],
    "update_every": [COUNT], "clumps_only": [YES_NO], "region": [Name("zone", "part", "nowhere")],
    "group": [Name("all", "g", "half", "nobody")], "add_force": [YES_NO],
    "relative_tolerance": [Number(lambda v: 0 < v < 1, ["1e-3", "1e-8", "1e-2"], ["0", "-1", "1", "2", "0.5", "1e-300", "0.1"],
                                  odd=lambda v: v == 0.1, loud=lambda v: v > 0.1)],
    "max_iter": [Integer(lambda v: v >= 1, ["100", "1", "1000"], ["0", "-5", "2147483647"], odd=lambda v: v == 0)],
    "algorithm": [Choice("1", "2", "2", "2")], "fluid_velocity": [U, U, U], "tensor": [Choice("rpy", "rpy", "rpy", "oseen")],
    "taper": [Choice("none", "wendland", "spherical")], "lubrication": [YES_NO],
    "lubrication_gap": [Number(lambda v: v >= 1e-6, ["1e-3", "0.01"], ["0", "-1", "1e-7"])],
    "lubrication_range": [Number(lambda v: 0 < v <= 8, ["2", "1", "8"], ["0", "-1", "9", "1e-3"], odd=lambda v: v == 1e-3)],
    "precondition": [Choice("auto", "none", "clump", "sparse", "waves")], "far_field": [Choice("auto", "direct", "ewald")],
    "far_field_tolerance": [Number(lambda v: 1e-13 <= v <= 0.1, ["1e-3", "1e-6"], ["0", "-1", "1", "1e-14", "0.11"])],
    "warm_start": [YES_NO], "rotation": [YES_NO], "fluid_vorticity": [U, U, U], "rigid_clumps": [Choice("yes", "no", "auto")],
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
    case.judge(words, STOKES)
    s = case.value
    cut, clumps = s("cut_off_distance"), s("clumps_only") == "yes"
    shell, rigid, rotation = int(s("shell", "1")), s("rigid_clumps", "no"), s("rotation") == "yes"
    case.refuse_if(how == "no radius", "radius")
    case.refuse_if("visc" not in case.settings, "visc")
    case.refuse_if(cut is None and not clumps, "cut_off_distance")
    everybody, far, sparse = cut == "inf" and not clumps, s("far_field", "auto"), s("precondition") == "sparse"
    case.refuse_if("far_field" in case.settings and not everybody, "far_field")
    case.refuse_if("far_field_tolerance" in case.settings and (not everybody or far == "direct"), "far_field_tolerance")
    case.refuse_if(far == "ewald" and s("tensor") == "oseen", "far_field", "tensor")
    case.refuse_if(far == "ewald" and sparse, "precondition", "far_field")
    case.refuse_if(everybody and how == "periodic" and (sparse or far == "direct" or s("tensor") == "oseen"), "far_field",
                   "precondition", "tensor")
    case.refuse_if(s("precondition") == "waves" and (not everybody or how != "periodic" or s("algorithm", "1") != "2"),
                   "precondition")
    lubricated, gap, reach = s("lubrication") == "yes", s("lubrication_gap", "1e-3"), s("lubrication_range", "2")
    case.refuse_if(lubricated and (not everybody or not rotation and shell == 1), "lubrication")
    case.refuse_if(not lubricated and "lubrication_gap" in case.settings, "lubrication_gap")
    case.refuse_if(not lubricated and "lubrication_range" in case.settings, "lubrication_range")
    case.refuse_if(case.level != BAD and float(gap) >= float(reach), "lubrication_gap")
    case.refuse_if(clumps and how in ("no molecules", "no radius"), "clumps_only", "molecule", "radius")
    case.refuse_if(s("taper", "none") != "none" and cut in (None, "inf"), "taper")
    case.refuse_if(s("precondition") == "sparse" and cut != "inf", "precondition")
    case.refuse_if(s("precondition") in ("clump", "sparse") and s("algorithm", "1") != "2" and rigid != "yes", "precondition")
    case.refuse_if(s("precondition") == "clump" and how == "no molecules", "precondition")
    case.refuse_if(rotation and s("tensor") == "oseen", "rotation", "tensor")
    case.refuse_if(rigid != "no" and not clumps, "rigid_clumps")
    case.refuse_if(rigid != "no" and cut not in (None, "inf"), "rigid_clumps", "cut_off_distance")
    if rigid != "no" and cut == "inf":
        case.says(ODD, "rigid_clumps", "cut_off_distance")
    case.refuse_if(rigid != "no" and s("tensor") == "oseen", "rigid_clumps", "tensor")
    case.refuse_if(shell != 1 and rigid == "no", "shell")
    case.refuse_if("fluid_vorticity" in case.settings and not rotation and shell == 1, "fluid_vorticity")
    case.refuse_if(rigid == "yes" and (s("region") == "part" or s("group") == "half"), "region", "group")
    if cut not in (None, "inf") and float(cut) > 100 * BOX:
        case.says(ODD, "cut_off_distance")
    if cut not in (None, "inf") and how == "periodic":
        ratio = float(cut) / BOX
        case.says(LOUD if ratio > 10 else ODD if ratio > 1 else GOOD, *["cut_off_distance"] * (ratio > 1))
    if "precondition" in case.settings and rigid != "no" or shell == 1 and "shell" in case.settings or shell > 500 \
            or rigid == "auto" or clumps and s("precondition") == "sparse":
        case.says(ODD, "precondition", "shell")


def forgive_unselected(case):
    """Values that nobody asks for need not be right."""
    asked = {k for k, words in case.settings.items() if any(w.startswith("v_") for w in words)}
    if (case.value("region") == "nowhere" or case.value("group") == "nobody") and case.level == BAD and set(case.faults) <= asked:
        case.level = ODD


def make_stokes(case):
    case.style, how = "stokes_dynamics", spheres(case)
    required = ["visc"] + case.draw.choice([["cut_off_distance"], ["clumps_only"], ["cut_off_distance", "algorithm"]])
    words = case.damaged(case.words_of(STOKES, required))
    if how == "periodic":       # 55 boxes take LAMMPS half a minute; 11 are warned of as well
        words = ["200" if w == "1e3" else w for w in words]
    case.tried = len(case.lines)
    case.lines += ["pair_style stokes_dynamics " + " ".join(words), "pair_coeff * *"]
    judge_stokes(case, words, how)
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
