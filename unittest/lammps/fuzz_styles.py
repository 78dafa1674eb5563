"""Scenes, grammars and rules of all styles, written from the pages in PKG-STOKESDYN/doc (for fuzz.py)."""
import os
import re

from fuzz_grammar import BAD, GOOD, LOUD, ODD, Case, Choice, Counted, Field, File, Integer, Name, Number, Or, decimal, read, write

# --- kinds of words that many keywords share

ANY = Number(lambda v: True, ["0", "1", "-2.5", "0.3"])
def positive(*good, border=("0", "-1"), odd=lambda v: False):
    return Number(lambda v: v > 0, list(good), border, odd)


POSITIVE = Number(lambda v: v > 0, ["1", "0.7", "2.5"], ["0", "-1", "1e-300", "1e300", "-0"])
NOT_NEGATIVE = Number(lambda v: v >= 0, ["0", "0.1", "1"], ["-1", "-1e-300", "1e300"])
COUNT = Integer(lambda v: v >= 1, ["1", "2", "7"], ["0", "-1", "2147483647", "2147483648", "1.0", "1e3"])
YES_NO = Choice("yes", "no")
U = Field(lambda v: True, ["0", "0.4", "-1"])


# --- pair_style stokes_dynamics, fix stokes_dynamics --------------------------------------------------------------------

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
variable eta equal 1.5
variable zero equal 0
variable minus equal -1
variable nan equal 1e308*10-1e308*10
variable text string hello
variable index index 3 4
variable place atom 1.2+0.01*x
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
    "taper": [Choice("none", "wendland", "spherical")], 
    "precondition": [Choice("auto", "none", "clump", "sparse", "waves")], "far_field": [Choice("auto", "direct", "ewald")],
    "far_field_tolerance": [Number(lambda v: 1e-13 <= v <= 0.1, ["1e-3", "1e-6"], ["0", "-1", "1", "1e-14", "0.11"])],
    "warm_start": [YES_NO], "rotation": [YES_NO], "fluid_vorticity": [U, U, U], "rigid_clumps": [Choice("yes", "no", "auto")],
    "shell": [Integer(lambda v: v == 1 or v >= 12, ["1", "12", "13", "42"],
                      ["0", "2", "11", "-1", "2147483647", "2147483646", "2147483648"], odd=lambda v: v > 500)],
}


class NumberOr:
    def __init__(self, word, number):
        self.word, self.number, self.good, self.border = word, number, number.good + [word], number.border

    def judge(self, word, case):
        return GOOD if word == self.word else self.number.judge(word, case)


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
    case.lines = SPHERES.format(style=style, boundary=boundary, radii=radii, molecules=molecules).split("\n")
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


def delete_something(case, *settings):
    """Perhaps a region, group or variable that the command names vanishes before the run."""
    if case.draw.random() > 0.04:
        return
    names = {"region": "region {} delete", "group": "group {} delete", "average": "group {} delete"}
    there = [k for k in settings if k in case.settings and case.value(k) != "all" and case.level != BAD]
    if there:
        k = case.draw.choice(there)
        case.lines.append(names[k].format(case.value(k)))
        case.says(BAD, k)
    elif "v_eta" in case.variables and case.level != BAD:
        case.lines.append("variable eta delete")
        case.says(BAD, *[k for k, v in case.settings.items() if "v_eta" in v])


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


# --- fix hydro/vans -----------------------------------------------------------------------------------------------------

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
{radii}
velocity all set 0.1 0.01 -0.02
variable eta equal 1.5
variable zero equal 0
variable minus equal -1
variable nan equal 1e308*10-1e308*10
variable text string hello
variable index index 3 4
variable place atom 1.2+0.01*x
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
    "gravity": [Number(lambda v: True, ["0.5", "0", "-0.3"]), Number(lambda v: True, ["0"]),
                Number(lambda v: True, ["-9.81"], ["9.81", "0"])],
    "area": [positive("0.0004", "0.0008")],
    "couple": [Choice("none", "one", "two", "fluid")], "profile": [Or(zero=[], file=[File("profile.txt")])],
    "given": [Or(averaged=[], file=[File("given.txt")])], "convective": [Or(off=[], file=[File("convective.txt")])],
    "solve": [positive("1e-3", "0.01", border=["0", "-1", "1e-6", "1e3"]), positive("1e-4", "1e-3", border=["0", "-1", "1e-9"])],
    "stream": [Choice("steady", "rest")], "hindrance": [Number(lambda v: True, ["3.1", "0", "2"], ["-1", "100"])],
    "lift": [Or(off=[], otherwise=[ANY])],
    "turbulence": [Choice("none", "kz", "parabolic", "li_sawamoto", "pore", "rousseau", "ni_capart", "pipe")],
    "kappa": [positive("0.41", odd=lambda v: v == 0)], "phi_max": [FRACTION], "phi_bed": [FRACTION],
    "bed_average": [Integer(lambda v: v >= 1, ["1", "3"], ["0", "1000000"], odd=lambda v: v > 1e6)],
    "sublayer": [YES_NO], "viscosity": [Choice("constant", "einstein", "power")],
    "surface": [Or(free=[], speed=[EQUAL])], "pressure_gradient": [EQUAL],
    "sidewall": [Or(off=[], otherwise=[positive("0.0065"), NOT_NEGATIVE])], "radius": [positive("0.003")], "classes": [YES_NO],
    "class_radii": [Counted(32, positive("0.003", "0.002"))],
    "grains": [Choice("extended", "point")], "felt": [Choice("centre", "volume")], "overlap": [Choice("twice", "once")],
    "fluctuation": [Or(none=[], correlated=[SEED, BED], uncorrelated=[SEED, BED], depth=[SEED, BED])],
    "intensity": [Or(stress=[], file=[File("convective.txt")], otherwise=[EQUAL])],
    "renewal": [positive("0.1", "1e-4")], "region": [Name("zone", "part", "nowhere")],
    "average": [Name("all", "g", "nobody")], "conserve": [YES_NO], "rules": [Choice("consistent", "consistent", "yade")],
}


def files(folder):
    """What the keywords of hydro/vans read; CELLS slices."""
    for name, text in (("mesh.txt", "\n".join(str(0.001 * k) for k in range(CELLS + 1))), ("short.txt", "1.0\n2.0\n1.5\n"),
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
    case.refuse_if(s("fluctuation", "none") != "none" and s("couple") == "fluid", "fluctuation")
    case.refuse_if(s("felt") == "volume" and "yade" == s("rules"), "felt")
    case.refuse_if(s("felt") == "volume" and s("grains") == "point", "felt")
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
    driven = "pressure_gradient" in case.settings or s("surface") == "speed" or s("profile") == "file" or s("stream") == "rest"
    if s("gravity") is not None and float(s("gravity")) == 0.0 and (not driven or s("pressure_gradient") in ("0", "v_zero")):
        case.says(ODD, "drives")
    if s("couple") == "fluid" and s("given") == "file" and "radius" not in case.settings:
        case.says(ODD, "radius")
    if s("class_radii") or s("rules") == "yade" or s("couple") == "fluid" and how == "no radius" or s("average") == "nobody" \
            or s("region") == "nowhere" or case.settings.get("class_radii"):
        case.says(ODD, "class_radii", "rules", "mesh", "average")
    numbers = [abs(decimal(w)) for words in case.settings.values() for w in words if decimal(w) is not None]
    if any(v > 1e5 or 0 < v < 1e-5 for v in numbers):      # a scale that no stream has: anything finite or refused will do
        case.says(ODD, "")
        case.extreme = True


def make_vans(case):
    case.style = "hydro/vans"
    how = case.draw.choices(["usual", "no molecules", "no radius"], [80, 15, 5])[0]
    style = {"no molecules": "sphere", "no radius": "atomic"}.get(how, "hybrid sphere bond")
    radii = "mass 1 1" if how == "no radius" else "set group all diameter 0.006 density 2500"
    if how == "usual":
        radii += "\nmass 1 1\nset atom 1*2 mol 1"
    case.lines = GRAINS.format(style=style, radii=radii).split("\n")
    required = ["mesh", "fluid", "gravity"]
    words = case.damaged([case.draw.choice(COUNT.good)] + case.words_of(VANS, required, few=7))
    case.tried = len(case.lines)
    case.lines.append("fix s " + case.draw.choice(["all", "all", "g"]) + " hydro/vans " + " ".join(words))
    judge_vans(case, words, how)
    delete_something(case, "region", "average")


def make_vans_modify(case):
    case.style = "hydro/vans"
    case.lines = GRAINS.format(style="sphere", radii="set group all diameter 0.006 density 2500").split("\n")
    case.lines.append(f"fix s all hydro/vans 1 mesh {CELLS} 0.001 0 fluid 1000 0.001 gravity 0.5 0 -9.81 solve 1e-3 1e-4")
    values = ["values"] + [str(0.01 * k) for k in range(CELLS + 1)]
    others = [["average"], ["solve", "1e-3", "1e-4"], ["given", "given.txt"]]
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


# --- SPH ----------------------------------------------------------------------------------------------------------------

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
LENGTH = positive("0.013", "0.012", border=["0", "-1", "1e-12", "0.05"])
ARTVISC = [Number(lambda v: v >= 0, ["0.1", "0"], ["-1"])] * 2 + [Number(lambda v: v >= 0, ["1.7e-6", "0"], ["-1"])]
SPACING = positive("0.01", border=["0", "-1", "0.03"])
SOUND = positive("20", "25")
SPH_PAIR = {"artVisc": ARTVISC, "tensCorr": [NOT_NEGATIVE, SPACING], "viscosity": [positive("1e-3", odd=lambda v: v == 0)],
            "shift": [YES_NO], "correction": [YES_NO]}
SPH_COEFF = {"h": [LENGTH], "c": [SOUND], "alpha": [NOT_NEGATIVE], "beta": [NOT_NEGATIVE], "deltap": [SPACING]}
KERNELS = ["cubicspline", "wendland", "cubicspline2d", "wendland2d"]
B, RHO = positive("57142.9", "300"), positive("1000")
PRESSURES = [("absolut", [positive("20", "7")]), ("relativ", [B, RHO]), ("relativ", [B, RHO, ANY]), ("Tait", [B, RHO, POSITIVE]),
             ("Tait", [B, RHO, POSITIVE, ANY])]
PLANE = Number(lambda v: True, ["-0.01", "-0.02", "NULL"], ["0.06", "0.01"])
FAR = Number(lambda v: True, ["0.06", "0.04", "NULL"], ["-0.01", "0.01"])


def water(case, **instead):
    """The scene, with some of its lines replaced. The tried line is the one that is replaced first."""
    lines = {"pair": "pair_style sph/artVisc/tensCorr wendland 0.013 artVisc 0.1 0 1.7e-6 tensCorr 0.2 0.01 viscosity 1e-3",
             "coeff": "pair_coeff * * c 20", "eos": "fix eos all sph/pressure Tait 57142.9 1000 7",
             "density": "fix density all sph/density/continuity", "move": "fix move all nve/sph"}
    tried = next(iter(instead.values()))
    lines.update(instead)
    case.lines = WATER.split("\n") + [line for line in lines.values() if line]
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
    moved = [name for name in ("shift", "correction") if case.settings.get(name, [""])[0] == "yes"]
    case.refuse_if(moved, "shift", "correction")    # the scene has no delta
    case.refuse_if("tensCorr" in case.settings and float(case.settings["tensCorr"][1]) >= 2 * h, "deltap")


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
    words = case.damaged([name] + [w for kind in kinds for w in write(kind, case.draw)])
    group = case.draw.choice(["all"] * 6 + ["fluid", "nobody"])
    water(case, eos=f"fix eos {group} sph/pressure " + " ".join(words))
    ways = [kinds for name, kinds in PRESSURES if words[:1] == [name]] or [[B]]
    kinds = max((k for k in ways if len(k) < len(words)), key=len, default=ways[0])
    first = words[0] if words else ""
    case.judge(words, {}, [("equation of state", Choice("absolut", "relativ", "Tait"))] + [(first, k) for k in kinds])
    if case.level == BAD:
        case.faults += words[:1] + ["equation of state"]
    elif group != "all":
        case.says(ODD, "")
    case.extreme |= violent(words, 1e8)


def make_sph_density(case):
    draw = case.draw
    what = draw.choice(["continuity", "summation", "corr"])
    case.style = "sph/density/" + what
    grammar = {"continuity": {"delta": [NOT_NEGATIVE]}, "summation": {}, "corr": {}}[what]
    begin = [("shepard", Choice("shepard")), ("every", Choice("every")), ("every", COUNT)] if what == "corr" else []
    words = case.damaged([w for _, kind in begin for w in write(kind, draw)] + case.words_of(grammar, few=len(grammar)))
    name, group = "filter" if what == "corr" else "density", draw.choice(["all"] * 5 + ["fluid", "nobody"])
    water(case, **{name: f"fix {name} {group} {case.style} " + " ".join(words)})
    if not case.judge(words, grammar, begin) and what == "corr":
        case.faults += ["shepard", "every"]


def make_sph_move(case):
    draw = case.draw
    case.style = draw.choice(["nve/sph", "nve/sph/stationary"])
    words = case.damaged([]) if draw.random() < 0.5 else []
    water(case, move=f"fix move {draw.choice(['all', 'fluid', 'wall', 'nobody', 'missing'])} {case.style} " + " ".join(words))
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
        planes = [("wall", Choice("xplane", "yplane", "zplane")), ("plane", OrNull(PLANE)), ("plane", OrNull(FAR))]
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


class OrNull:
    def __init__(self, number):
        self.number, self.good, self.border = number, number.good, number.border

    def judge(self, word, case):
        return GOOD if word == "NULL" else self.number.judge(word, case)


ADAMI = {"gravity": [ANY, ANY, ANY], "slip": [YES_NO]}


def make_sph_adami(case):
    case.style = "wall/adami/sph"
    words = case.damaged(case.words_of(ADAMI, few=2))
    group = case.draw.choice(["wall"] * 6 + ["all", "nobody"])
    water(case, adami=f"fix tank {group} wall/adami/sph " + " ".join(words), move="fix move fluid nve/sph")
    case.judge(words, ADAMI)
    if group != "wall":
        case.says(ODD, "")
    case.extreme |= violent(words)


def make_sph_check(case):
    case.style = "check/timestep/sph"
    begin = [("N", COUNT), ("fraction", Number(lambda v: v > 0, ["0.3", "0.25"], ["0", "-1", "1.5"], odd=lambda v: v > 1))]
    words = case.damaged([w for _, k in begin for w in write(k, case.draw)] + case.draw.choice([[], ["warn"], ["stop"]]))
    water(case, check="fix limit all check/timestep/sph " + " ".join(words))
    if not case.judge(words, {"warn": [], "stop": []}, begin):
        case.faults += ["form", "N", "fraction"]


MAKERS = [(make_stokes, 42), (make_stokes_fix, 4), (make_stokes_coeff, 1), (make_vans, 24), (make_vans_modify, 2),
          (make_sph_pair, 8), (make_sph_coeff, 5), (make_sph_pressure, 3), (make_sph_density, 3), (make_sph_move, 1),
          (make_sph_wall, 4), (make_sph_adami, 2), (make_sph_check, 2)]


def draw(seed, number):
    """A case of any style, made of its seed and number alone."""
    return Case(seed, number, MAKERS)
