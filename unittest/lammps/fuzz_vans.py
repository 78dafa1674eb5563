"""Scenes, grammar and rules of fix hydro/vans, written from its page (for fuzz.py)."""
import os

from fuzz_grammar import (ANY, BAD, COUNT, LOUD, NOT_NEGATIVE, ODD, VARIABLES, YES_NO, Choice, Counted, Field, File,
                          Integer, Name, Number, Or, decimal, delete_something, positive)

CELLS = 20
GRAINS = """units si
atom_style {style}
atom_modify map array
boundary p p f
plugin load stokesdynplugin.so
region box block 0 0.02 0 0.02 -0.02 0.15
create_box 1 box
create_atoms 1 single 0.004 0.004 0.004
create_atoms 1 single 0.014 0.012 0.006
create_atoms 1 single 0.005 0.013 0.018
create_atoms 1 single 0.013 0.004 0.04
region heap block 0 0.02 0 0.02 0.008 0.018
{radii}
velocity all set 0.1 0.01 -0.02
{variables}
region zone block INF INF INF INF INF INF
region part block 0 0.01 0 0.02 -1 1
region nowhere block 0 0.001 0 0.001 0.1 0.101
group g id 1 2
group nobody empty
pair_style zero 0.01
pair_coeff * *
neighbor 0.001 bin
timestep 1e-5
thermo 100000"""
# 40 more grains, and a size for each
MANY = """create_atoms 1 random 40 4711 heap
variable size atom random(0.001,0.004,5)
set group all diameter v_size
set group all density 2500"""
SEED = Integer(lambda v: v >= 1, ["4711", "1"], ["0", "-1", "9223372036854775807"], odd=lambda v: v <= 0)
BED = Or(auto=[], otherwise=[ANY])
EQUAL = Field(lambda v: True, ["0", "0.3", "-0.1"], atom=False)
FRACTION = Number(lambda v: 0 < v <= 1, ["0.61", "0.08", "1"], ["0", "1.01", "-0.1"])
VANS = {
    "mesh": [Or(file=[File("mesh.txt")], otherwise=[
        Integer(lambda v: v >= 1, [str(CELLS)] * 4 + ["40"], ["1", "0", "-3", "2", "99999999999", "20.0"],
                odd=lambda v: v == 1 or v > 1e6),
        positive("0.001", "0.002"), Number(lambda v: True, ["0", "-0.01"])])],
    "fluid": [positive("1000"), positive("0.001")],
    "gravity": [Field(lambda v: True, ["0.5", "0", "-0.3"], atom=False), Field(lambda v: True, ["0"], atom=False),
                Field(lambda v: True, ["-9.81", "9.81"], atom=False)],
    "drag": [Choice("yade", "schiller_naumann", "brown_lawler", "ferguson_church", "ergun", "gidaspow", "beetstra",
                    "koch_hill")],
    "added_mass": [Or(off=[], otherwise=[NOT_NEGATIVE])], "upflow": [Or(off=[], otherwise=[EQUAL])],
    "discharge": [Or(off=[], otherwise=[EQUAL])], "wall_roughness": [NOT_NEGATIVE], "wall_mixing": [YES_NO],
    "bed_mixing": [Or(off=[], otherwise=[NOT_NEGATIVE])],
    "area": [positive("0.0004", "0.0008")], "fall_diameter": [positive("0.7", "1", "1.3")],
    "schmidt": [positive("0.44", "1")], "adjust": [Or(slope=[], depth=[positive("0.5", "20")])],
    "couple": [Choice("none", "one", "two", "fluid")], "profile": [Or(zero=[], file=[File("profile.txt")])],
    "given": [Or(averaged=[], file=[File("given.txt")])], "convective": [Or(off=[], file=[File("convective.txt")])],
    "solve": [positive("1e-3", "0.01", border=["0", "-1", "1e-6", "1e3"]),
              positive("1e-4", "1e-3", border=["0", "-1", "1e-9"])],
    "stream": [Choice("steady", "rest")], "hindrance": [Or(richardson_zaki=[], di_felice=[], otherwise=[NOT_NEGATIVE])],
    "lift": [Or(off=[], otherwise=[ANY])],
    "turbulence": [Choice("none", "kz", "parabolic", "li_sawamoto", "pore", "rousseau", "ni_capart", "pipe")],
    "kappa": [positive("0.41", odd=lambda v: v == 0)], "phi_max": [FRACTION], "phi_bed": [FRACTION],
    "bed_average": [Integer(lambda v: v >= 1, ["1", "3"], ["0", "1000000"], odd=lambda v: v > 1e6)],
    "sublayer": [YES_NO], "viscosity": [Choice("constant", "einstein", "power")],
    "surface": [Or(free=[], speed=[EQUAL], follow=[positive("0.012")])], "pressure_gradient": [EQUAL],
    "sidewall": [Or(off=[], otherwise=[positive("0.0065"), NOT_NEGATIVE])], "radius": [positive("0.003")],
    "classes": [Or(yes=[], no=[], otherwise=[Integer(lambda v: 1 <= v <= 1000, ["1", "3", "40"], ["0", "1001", "2.5"],
                                                     odd=lambda v: v == 1000)])],
    "class_radii": [Counted(32, positive("0.003", "0.002"))],
    "grains": [Choice("extended", "point")], "felt": [Choice("centre", "volume")], "overlap": [Choice("twice", "once")],
    "fluctuation": [Or(none=[], correlated=[SEED, BED], uncorrelated=[SEED, BED], depth=[SEED, BED],
                       langevin=[SEED, BED])],
    "intensity": [Or(stress=[], file=[File("convective.txt")],
                     otherwise=[Field(lambda v: v >= 0, ["0", "0.3"], ["-0.1"], atom=False)])],
    "renewal": [positive("0.1", "1e-4")], "region": [Name("zone", "part", "nowhere")],
    "average": [Name("all", "g", "nobody")], "conserve": [YES_NO],
    "rules": [Choice("consistent", "consistent", "yade")],
}


def files(folder):
    """What the keywords of hydro/vans read; CELLS slices."""
    for name, text in (("mesh.txt", "\n".join(str(0.001 * k) for k in range(CELLS + 1))),
                       ("short.txt", "1.0\n2.0\n1.5\n"),
                       ("profile.txt", "# velocities\n" + "\n".join(str(0.01 * k) for k in range(CELLS + 1))),
                       ("given.txt", "0.1 0.02 1e-4\n" * CELLS), ("full.txt", "1.2 0.02 1e-4\n" * CELLS),
                       ("convective.txt", "1e-5\n" * CELLS), ("words.txt", "a b c\n" * CELLS), ("empty.txt", "")):
        with open(os.path.join(folder, name), "w") as out:
            out.write(text + "\n")


def judge_vans(case, words, how):
    case.judge(words, VANS, [("N", COUNT)])
    s = case.value
    if case.level == BAD and case.variables and int(s("N", "1")) > 2:
        case.level = ODD        # the variables are not asked in a run of two steps
    for name in ("mesh", "fluid", "gravity"):
        case.refuse_if(name not in case.settings, name)
    case.refuse_if(how == "no radius" and s("couple") != "fluid", "radius")
    case.refuse_if(how == "no molecules" and s("overlap") == "once", "overlap")
    for name in ("renewal", "intensity"):
        case.refuse_if(name in case.settings and s("fluctuation", "none") == "none", name)
    case.refuse_if("renewal" in case.settings and s("fluctuation") == "depth", "renewal")
    case.refuse_if(s("fluctuation", "none") != "none" and s("couple") == "fluid", "fluctuation")
    case.refuse_if(s("felt") == "volume" and "yade" == s("rules"), "felt")
    case.refuse_if(s("felt") == "volume" and s("grains") == "point", "felt")
    yade, couple = s("rules") == "yade", s("couple", "two")
    case.refuse_if(yade and (s("drag", "yade") != "yade" or s("hindrance") in ("richardson_zaki", "di_felice")), "drag")
    case.refuse_if(s("drag") in ("ergun", "gidaspow", "beetstra", "koch_hill") and "hindrance" in case.settings,
                   "hindrance")
    case.refuse_if(s("upflow", "off") != "off" and (yade or couple in ("none", "fluid")), "upflow")
    case.refuse_if(s("classes", "no") not in ("yes", "no") and "class_radii" in case.settings, "classes")
    held, walls = s("discharge", "off") != "off", s("sidewall", "off") != "off"
    deep = s("adjust") == "depth"
    case.refuse_if(held and (yade or couple in ("none", "one") or s("surface") == "speed" or
                             "pressure_gradient" in case.settings and not deep), "discharge")
    case.refuse_if(deep and not (held and s("surface") == "follow"), "adjust")
    case.refuse_if("schmidt" in case.settings and s("fluctuation") != "langevin", "schmidt")
    case.refuse_if(yade and s("fluctuation") == "langevin", "fluctuation")
    case.refuse_if(yade and "fall_diameter" in case.settings, "fall_diameter")
    case.refuse_if(s("surface") == "follow" and (yade or couple != "two"), "surface")
    mixed = decimal(s("bed_mixing", "0")) not in (0.0, None)
    case.refuse_if(mixed and (yade or s("turbulence") == "none"), "bed_mixing")
    if yade and (s("added_mass", "off") != "off" or "wall_roughness" in case.settings or s("wall_mixing") == "yes"):
        case.says(ODD, "added_mass", "wall_roughness", "wall_mixing")
    case.refuse_if(s("wall_mixing") == "yes" and not walls, "wall_mixing")
    if "wall_roughness" in case.settings and not walls:
        case.says(ODD, "wall_roughness")
    if held or s("surface") == "follow" or "upflow" in case.settings or "added_mass" in case.settings:
        case.says(ODD, "surface", "discharge", "mesh", "upflow", "added_mass")
    judge_vans_values(case, how)


def judge_vans_values(case, how):
    """Numbers that do not go together, and scenes of which the page says nothing"""
    s = case.value
    if s("mesh", "file") != "file":
        cells, dz, bottom = (float(w) for w in case.settings["mesh"])
        for name in ("profile", "given", "convective"):
            case.refuse_if(s(name) == "file" and cells != CELLS, name)
        if not bottom <= 0.0 or not 0.02 <= bottom + cells * dz <= 0.1:
            case.says(ODD, "mesh")      # it may miss the grains
    if "solve" in case.settings:
        period, dt = (float(w) for w in case.settings["solve"])
        case.refuse_if(dt > period * 1.001, "solve")
        if 0 < dt <= period and not period / dt < 1e6:
            case.says(ODD if period / dt < 1e8 else LOUD, "solve")
    driven = "pressure_gradient" in case.settings or s("surface") == "speed" or s("profile") == "file" or s(
        "stream") == "rest"
    if s("gravity") is not None and decimal(s("gravity")) in (0.0, None) and (not driven or s("pressure_gradient") in (
        "0", "v_zero")):
        case.says(ODD, "drives")
    if s("couple") == "fluid" and s("given") == "file" and "radius" not in case.settings:
        case.says(ODD, "radius")
    if s("class_radii") or s("rules") == "yade" or s("couple") == "fluid" and how == "no radius" or s(
        "average") == "nobody" \
            or s("region") == "nowhere" or case.settings.get("class_radii"):
        case.says(ODD, "class_radii", "rules", "mesh", "average")
    numbers = [abs(decimal(w)) for words in case.settings.values() for w in words if decimal(w) is not None]
    # a scale that no stream has: anything finite or refused will do
    if any(v > 1e5 or 0 < v < 1e-5 for v in numbers):
        case.says(ODD, "")
        case.extreme = True


def make_vans(case):
    case.style = "hydro/vans"
    how = case.draw.choices(["usual", "many sizes", "no molecules", "no radius"], [50, 30, 15, 5])[0]
    style = {"no molecules": "sphere", "no radius": "atomic"}.get(how, "hybrid sphere bond")
    radii = "mass 1 1" if how == "no radius" else "set group all diameter 0.006 density 2500"
    if how == "many sizes":
        radii = MANY
    if how in ("usual", "many sizes"):
        radii += "\nmass 1 1\nset atom 1*2 mol 1"
    case.lines = GRAINS.format(variables=VARIABLES, style=style, radii=radii).split("\n")
    required = ["mesh", "fluid", "gravity"]
    words = case.damaged([case.draw.choice(COUNT.good)] + case.words_of(VANS, required, few=7))
    case.tried = len(case.lines)
    case.lines.append("fix s " + case.draw.choice(["all", "all", "g"]) + " hydro/vans " + " ".join(words))
    judge_vans(case, words, how)
    delete_something(case, "region", "average")


def make_vans_modify(case):
    case.style = "hydro/vans"
    case.lines = GRAINS.format(variables=VARIABLES, style="sphere",
                               radii="set group all diameter 0.006 density 2500").split("\n")
    case.lines.append(f"fix s all hydro/vans 1 mesh {CELLS} 0.001 0 fluid 1000 0.001 gravity 0.5 0 -9.81 "
                      "solve 1e-3 1e-4")
    values = ["values"] + [str(0.01 * k) for k in range(CELLS + 1)]
    others = [["gravity", "0.3", "0", "-9.81"], ["steady", "anew"], ["average"], ["solve", "1e-3", "1e-4"],
              ["given", "given.txt"]]
    words = case.damaged(case.draw.choice([["profile"] + values, ["profile", "file", "profile.txt"]] + others))
    case.tried = len(case.lines)
    case.lines.append("fix_modify s " + " ".join(words))
    numbers = [("profile", Number(lambda v: True, []))] * (CELLS + 1)
    if words[:1] != ["profile"]:
        case.says(ODD, "")      # energy, virial, ...: LAMMPS's own
    elif words[1:2] == ["values"]:
        case.judge(words[2:], {}, numbers)
    else:
        case.judge(words[1:], {}, [("profile", Choice("file")), ("profile", File("profile.txt"))])
    if case.level == BAD:
        case.faults += ["profile", "values", "fix_modify"]
