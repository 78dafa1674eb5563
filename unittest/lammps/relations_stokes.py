"""Scenes of pair_style stokes_dynamics for relations.py: free spheres and clumps, all models and ways of motion."""
import random

import numpy as np

from relations_scene import Scene, until_settled

# The first value of an option is the simplest one: to it a failing case goes back, one option after the other.
OPTIONS = {
    "space": ["open", "shrink", "wall", "periodic", "tilt", "deform", "floor", "slit", "flux"],
    "spheres": [2, 5, 9], "clumps": [0, 1, 3, 3], "radii": ["equal", "unlike", "shells"],
    "pairs": ["inf", "inf", "inf", "inf", "clumps_only", "taper", "list"],
    "model": ["", "rotation yes", "multiblob 12", "multiblob 12", "multiblob 42",
              "multiblob 42 half", "multiblob 12 multiblob_most 42"], "films": ["no", "no", "yes"],
    "rigid": ["no", "yes", "yes", "auto", "shell"],
    "motion": ["forces", "forces inside", "ab2", "ab2", "euler", "midpoint"],
    "noise": ["no", "no", "yes"], "held": ["no", "no", "still", "moved"], "spin": ["no", "no", "no", "all", "slips"],
    "directions": ["no", "no", "mu"], "drive": ["no", "no", "torque", "pin", "squirm"],
    "adapt": ["no"] * 5 + ["yes"], "flow": ["rest", "uniform", "shear", "time", "box"],
    "visc": ["number", "number", "formula"], "select": ["all", "all", "all", "group", "region"], "every": [1, 1, 2, 3],
    "guess": ["warm", "warm", "cold"], "far": ["auto", "direct", "ewald"], "contacts": ["no", "no", "no", "yes"],
    "look": ["nothing", "field", "stress"], "skin": [0.3, 0.05],
    "steps": [2, 4, 7],
}
CLOSED = ("periodic", "tilt", "deform")
SLABS = ("floor", "slit", "flux")              # periodic in two directions


@until_settled
def lawful(o, no):
    """What does not go together, by the pages: the later option gives way."""
    overdamped = o["motion"] in ("ab2", "euler", "midpoint")
    blobs = o["model"].startswith("multiblob")
    no(o["pairs"] != "inf", films="no", far="auto", look="nothing", model="rotation yes" if blobs else o["model"])
    no(o["pairs"] != "inf" and o["space"] in ("wall", "deform"), space="open")
    no(o["clumps"] == 0, rigid="no")
    no(o["rigid"] == "auto" and (o["pairs"] != "clumps_only" or overdamped), rigid="yes")
    no(o["rigid"] != "no" and o["pairs"] in ("taper", "list"), rigid="no")
    no(o["rigid"] == "shell" and (blobs or o["space"] == "wall"), rigid="yes")
    no(o["rigid"] != "no" and o["model"] == "", model="rotation yes")
    no(o["films"] == "yes" and o["model"] == "", model="rotation yes")
    no(o["pairs"] == "list", films="no", rigid="no", clumps=0, motion=o["motion"] if not overdamped else "forces")
    no(o["pairs"] == "clumps_only" and overdamped and o["rigid"] == "no" and o["noise"] == "no",
       rigid="yes" if o["clumps"] else "no")
    no(o["pairs"] == "clumps_only" and o["motion"] == "midpoint", motion="ab2")
    no(not overdamped, noise="no", held="no", spin="no", adapt="no", directions="no", drive="no")
    no(o["model"] == "", directions="no", drive="no")
    no(o["drive"] == "pin" and o["pairs"] != "inf", drive="torque")
    no(o["drive"] == "squirm" and (not blobs or o["pairs"] != "inf"), drive="torque")
    no(o["drive"] == "squirm", directions="mu")
    no(overdamped, every=1)
    no(o["look"] != "nothing" and blobs, guess="warm")      # else the forces of points are not kept
    no(o["noise"] == "yes", adapt="no", contacts="no", held="still" if o["held"] == "moved" and o["clumps"]
       else o["held"])
    no(o["noise"] == "yes" and o["pairs"] != "inf", noise="no")
    no(o["noise"] == "yes" and o["motion"] in ("ab2", "euler") and (
        o["films"] == "yes" or blobs or o["space"] == "wall" or o["rigid"] != "no" or o["held"] != "no" or
        o["spin"] != "no" or o["drive"] == "pin" or o["visc"] == "formula"), motion="midpoint")
    no(o["held"] == "moved", adapt="no")      # fix move wants one time step
    no(o["held"] == "moved" and o["motion"] == "midpoint" and o["rigid"] != "no", held="still")
    no(o["spin"] != "no" and (o["model"] == "" or o["rigid"] != "no"), spin="no")
    no(o["space"] == "deform", flow="box", adapt="no", held="no", contacts="no")
    no(o["space"] != "deform" and o["flow"] == "box", flow="rest")
    no(o["space"] == "wall" and o["flow"] == "uniform", flow="shear")
    slab = o["space"] in SLABS
    no(slab and o["pairs"] != "inf", pairs="inf")
    no(slab and (o["rigid"] == "shell" or o["model"] == "rotation yes"), model="multiblob 12",
       rigid="yes" if o["rigid"] == "shell" else o["rigid"])
    no(slab and o["flow"] == "uniform", flow="shear")
    no(slab and o["look"] == "stress", look="nothing")
    no(o["space"] in CLOSED + SLABS and o["far"] == "direct", far="auto")
    no(o["space"] in CLOSED + SLABS and o["far"] == "auto" and o["pairs"] == "inf", far="ewald")
    no(o["space"] in CLOSED and o["flow"] == "shear", flow="uniform")
    no(o["space"] == "wall" and o["far"] == "ewald" and o["model"] == "rotation yes", far="auto")
    no(o["space"] == "wall" and o["model"] == "" and o["far"] == "ewald", far="auto")
    no(o["select"] != "all" and (o["clumps"] or overdamped), select="all")
    no(o["look"] == "stress" and not (blobs and o["space"] in CLOSED), look="nothing")
    no(o["look"] == "field" and o["space"] == "wall", look="nothing")
    no(o["model"].startswith("multiblob 42"), spheres=min(o["spheres"], 5), clumps=min(o["clumps"], 1))
    no(o["space"] in CLOSED + SLABS and o["visc"] == "formula" and o["noise"] == "yes", visc="number")
    no(o["contacts"] == "yes" and o["space"] in CLOSED and o["films"] == "yes", contacts="no")


def places(o, seed):
    """[(place, radius, molecule)]: clumps of two to four spheres, and free ones."""
    R, L, made = random.Random(f"places {seed}"), 7.0, []

    def free(p, a):
        # LAMMPS makes no atom outside of the box; those of a clump are on one side of its faces
        most = 6.4 if o["space"] in CLOSED[1:] else 8.8
        behind = o["space"] in ("wall",) + SLABS and (p[2] - a < -8.2 or p[2] + a > 8.9)
        return not behind and all(abs(c) < most for c in p) and all(np.linalg.norm(p - q) > 1.03 * (a + b) for q, b,
                                                                    _ in made)

    def point():
        return np.array([R.uniform(-L, L) for _ in range(3)])

    def draw(make, tries=300):
        for _ in range(tries):
            new = make()
            if all(free(p, a) for p, a, _ in new):
                return made.extend(new)

    def clump(m):
        n, axis = R.choice([2, 3, 3, 4]), np.array([R.gauss(0, 1) for _ in range(3)])
        c, axis = point(), axis / np.linalg.norm(axis)
        return [(c + 1.6 * i * axis + (np.array([0, 0, 0.9 * (i % 2)]) if n == 4 else 0.0),
                 0.62 if o["radii"] == "shells" and i % 2 else 1.0, m) for i in range(n)]

    for m in range(o["clumps"]):
        draw(lambda: clump(m + 1))
    for _ in range(o["spheres"]):
        draw(lambda: [(point(), R.choice({"equal": [1.0], "unlike": [1.0, 0.6, 1.2],
                                          "shells": [1.0, 0.35, 0.6, 1.7]}[o["radii"]]), 0)])
    return made


def pair_words(o):
    """The words of the pair style, solved so well that what is left is below all tolerances."""
    words = {"inf": "cut_off_distance inf", "clumps_only": "clumps_only yes",
             "taper": "cut_off_distance <L 5.5> taper wendland",
             "list": "cut_off_distance <L 3.1>"}[o["pairs"]]
    words += " relative_tolerance 1e-10 max_iter 900 algorithm 2 " + o["model"]
    words += {"no": "", "yes": " rigid_clumps yes", "auto": " rigid_clumps auto",
              "shell": " rigid_clumps yes shell 12"}[o["rigid"]]
    # spheres that overlap by much, each turned as it comes, have no positive matrix with it
    words += " one_body no" * (o["model"].startswith("multiblob") and o["clumps"] > 0 and o["rigid"] == "no")
    words += " lubrication yes" * (o["films"] == "yes") + " warm_start no" * (o["guess"] == "cold")
    words += " visc v_eta" if o["visc"] == "formula" else " visc <eta 1.3>"
    words += {"rest": "", "uniform": " fluid_velocity <V 0.3 0.1 -0.2>", "box": " fluid_velocity box"}.get(
        o["flow"], " fluid_velocity v_ux v_uy v_uz")
    words += {"all": "", "group": " group some", "region": " region zone"}[o["select"]]
    words += (f" far_field {o['far']}" * (o["far"] != "auto") + (" far_field_tolerance 1e-8" if o["space"] in SLABS
                                                                 else " far_field_tolerance 1e-11") *
              (o["far"] == "ewald"))
    words += (" wall <side zlo -8.3>" * (o["space"] in ("wall", "floor")) + " add_force yes" *
              (o["motion"] == "forces inside"))
    words += " wall <side zlo -8.3> <side zhi 9.0>" * (o["space"] in ("slit", "flux")) + " flow flux" * (
        o["space"] == "flux")
    return words + f" update_every {o['every']}" * (o["every"] != 1)


def build(options, seed):
    o = lawful(options)
    s, R = Scene("stokes", o, seed), random.Random(f"forces {seed}")
    drift = {m: [R.uniform(-0.3, 0.3) for _ in range(3)] for m in range(1, 4)}     # a clump moves as one from the start
    for p, a, m in places(o, seed):
        v = drift.get(m) or [R.uniform(-0.3, 0.3) for _ in range(3)]
        mu = {"mu": [R.gauss(0, 1) for _ in range(3)]} if o["directions"] == "mu" else {}
        s.atom(p, v if "forces" in o["motion"] else (0, 0, 0), diameter=2 * a, density=1.7, molecule=m, **mu)
    lone = [k + 1 for k, a in enumerate(s.atoms) if not a["molecule"]]
    turning = o["model"] or o["rigid"] == "shell"
    box(s, o)
    fluid(s, o)
    s.pair = ([("gran/hooke", "<k 50> NULL 0 NULL 0 0", "")] * (o["contacts"] == "yes") +
              [("stokes_dynamics", pair_words(o), "")])
    if o["contacts"] == "yes":
        s.define.append("comm_modify vel yes")
    s.fixes = ["fix pull odd addforce <F 3 1 -4>", "fix push even addforce <F -2 1.5 -2.5>"]
    s.columns = [("p", "xu yu zu"), ("V", "vx vy vz")]
    if "forces" in o["motion"]:
        inertia(s, o)
    else:
        without_inertia(s, o, lone, seed)
    look(s, o)
    s.columns += [("W", "omegax omegay omegaz")] if turning else []
    s.output_between = "f_report" if "forces" in o["motion"] else "f_move"
    s.other = other_words(o, turning)
    s.dt, s.steps, s.tolerance = 0.004, o["steps"], 2e-5 if o["noise"] == "yes" or o["films"] == "yes" else 2e-6
    return s


def box(s, o):
    closed = o["space"] in CLOSED
    s.head = ["units lj", "atom_style hybrid sphere bond" + " dipole" * (o["directions"] == "mu")]
    slab = o["space"] in SLABS
    s.make = ["boundary <each "
              f"{'p p f' if slab else dict(open='f f f', wall='f f f', shrink='m m m').get(o['space'], 'p p p')}>"]
    half = "-9 9 -9 9 -9 9" if closed else "-9 9 -9 9 -30 30" if slab else "-30 30 -30 30 -30 30"
    tilt = " <L 1.5> <L -1.0> <L 2.0>" if o["space"] in CLOSED[1:] else ""
    s.make.append(f"region box {'prism' if tilt else 'block'} <block {half}>{tilt}")
    s.make += ["create_box 1 box bond/types 1 extra/bond/per/atom 4 extra/special/per/atom 4"]
    s.after = ["mass 1 1"]
    s.groups = [f"group odd id <ids {' '.join(str(k + 1) for k in range(0, len(s.atoms), 2))}>",
                "group even subtract all odd"]
    s.define = [f"neighbor <L {o['skin']}> bin"]


def fluid(s, o):
    """Its flow and viscosity, and who is in it"""
    if o["space"] in CLOSED:
        flow, eta = "0.3*sin(2*PI*Z/18) 0 0.1*cos(2*PI*X/18)", "1.3+0.05*sin(2*PI*X/18)"
    elif o["space"] in SLABS:
        height = "(Z+8.3)" if o["space"] == "floor" else "0.1*(Z+8.3)*(9-Z)"
        flow, eta = f"0.2*{height} 0.05*{height} 0", "1.3+0.05*sin(2*PI*X/18)"
    else:
        flow, eta = ("0.2*(Z+8.3) 0.05*(Z+8.3) 0" if o["space"] == "wall"
                     else "0.2*Z 0.1*X 0"), "1.3+0.05*sin(0.3*X)*cos(0.2*Y)"
    s.define += [f"<field u V {flow}>"] * (o["flow"] == "shear") + [f"variable eta atom <one eta {eta}>"] * (
        o["visc"] == "formula")
    if o["flow"] == "time":
        factor = "*cos(40*TIME)"
        s.define.append("<field u V " + " ".join(f"({f}){factor}" if f != "0" else f for f in flow.split()) + ">")
    s.groups += [f"group some id <ids {' '.join(str(k) for k in range(1, len(s.atoms) + 1) if k % 4 != 3)}>"] * (
        o["select"] == "group")
    s.define += ["region zone block <block -6 5 INF INF INF 6>"] * (o["select"] == "region")


def look(s, o):
    if o["look"] == "stress":
        s.fixes.append("compute stress all stokes_dynamics/stress")
        s.globals += [("stress", " ".join(f"c_stress[{k}]" for k in range(1 + 6 * part, 7 + 6 * part)))
                      for part in range(3)]
        if o["clumps"] and "forces" in o["motion"]:
            s.globals.pop()      # the virial of fix rigid/small, which depends on where the origin is
    if o["look"] == "field":
        s.grid = ((5, 4, 6), (-6.0, -5.0, -4.0), (6.0, 5.0, 7.0))


def other_words(o, turning):
    words = "cut_off_distance inf visc <eta 2> relative_tolerance 1e-6 " + " fluid_velocity box" * (o["flow"] == "box")
    words += " add_force yes" * (o["motion"] == "forces inside")
    words += " rigid_clumps yes rotation yes" if o["clumps"] else " rotation yes" if turning else ""
    if o["look"] == "stress" or o["space"] in SLABS or o["drive"] == "squirm":
        words = words.replace("rotation yes", "")
        words += " multiblob 42" if o["look"] == "stress" else " multiblob 12" if turning else ""
    words += " wall <side zlo -8.3>" * (o["space"] == "floor") + " wall <side zlo -8.3> <side zhi 9.0>" * (
        o["space"] in ("slit", "flux"))
    return words


def inertia(s, o):
    s.fixes.append("fix report all stokes_dynamics")      # before fix rigid, which reads forces in its setup
    if o["clumps"]:
        s.define.append("comm_modify cutoff <L 8>")
        s.groups += ["group lone molecule 0", "group bound subtract all lone"]
        s.fixes += ["fix bodies bound rigid/small molecule", "fix move lone nve/sphere",
                    "neigh_modify exclude molecule/intra all"]
    else:
        s.fixes.append("fix move all nve/sphere")
    s.columns += [("F", "f_report[1] f_report[2] f_report[3]"), ("V", "f_report[4] f_report[5] f_report[6]"),
                  ("Q", "f_report[7] f_report[8] f_report[9]")]
    s.globals += [("power", "f_report"), ("F", "f_report[1] f_report[2] f_report[3]")]


def without_inertia(s, o, lone, seed):
    R, words, taken, bound = random.Random(f"held {seed}"), f"scheme {o['motion']}", [], []
    if o["noise"] == "yes":
        words += " temperature <E 0.4> 4711 noise_tolerance 1e-7"
    if o["held"] != "no" and lone:
        taken = R.sample(lone, min(2, len(lone)))
        bound = ([k + 1 for k, a in enumerate(s.atoms) if a["molecule"] == 1] if o["rigid"] != "no" and R.random() < 0.5
                 else [])
        s.groups.append(f"group hold id <ids {' '.join(map(str, taken + bound))}>")
        words += " held hold"
        if o["held"] == "moved":
            s.groups.append(f"group drag id <ids {taken[0]}>")
            s.fixes.append("fix tug drag move wiggle <L 0.2 0.1 0.3> <t 0.5>")
    rest, all_held = [k for k in lone if k not in taken], taken + bound
    if o["drive"] == "pin" and rest:
        s.groups.append(f"group rotor id <ids {rest.pop()}>")
        words += " pin rotor"
    free = [k for k in range(1, len(s.atoms) + 1) if k not in all_held]
    if o["drive"] in ("torque", "pin") and free:
        s.groups.append(f"group driven id <ids {' '.join(map(str, free[::2] + free[-1:]))}>")
        words += " torque driven <Q 4 -3 6>"
    if o["drive"] == "squirm":
        words += " squirm odd <V 0.9> <V -0.7>"
    if o["spin"] != "no" and rest:
        s.groups.append(f"group whirl id <ids {' '.join(map(str, rest[:2]))}>")
        words += " spin whirl <W 0 3 1>" + " <Q 5>" * (o["spin"] == "slips")
    if o["adapt"] == "yes":
        words += " adapt 2 <t 1e-5> <t 0.02> <L 0.01>"
    if o["clumps"]:
        s.define.append("neigh_modify exclude molecule/intra all")
    if o["space"] == "deform":
        s.fixes.append("fix shear all deform 1 xz erate <rate 0.4> remap none")
    s.fixes.append(f"fix move all stokes_dynamics/overdamped {words}")
    s.columns += [("V", "f_move[1] f_move[2] f_move[3]"), ("F", "f_move[4] f_move[5] f_move[6]"),
                  ("Q", "f_move[7] f_move[8] f_move[9]")]
    s.columns += [("turn", "f_move[11] f_move[12] f_move[13]")] * (o["rigid"] != "no")
    s.columns += [("1", "mux muy muz")] * (o["directions"] == "mu")
    s.globals += [("power", "f_move"), ("V", "f_move[1]"), ("t", "f_move[9]")]
