"""Scenes of fix hydro/vans for relations.py: a bed of fixed and loose grains below a stream."""
import random

from relations_scene import Scene, until_settled

OPTIONS = {
    "couple": ["two", "two", "one", "none"], "layers": [1, 2, 3],
    "turbulence": ["none", "li_sawamoto", "kz", "parabolic", "pore", "rousseau", "ni_capart", "pipe"],
    "fluctuation": ["none", "none", "correlated", "uncorrelated", "depth", "langevin"],
    "classes": ["no", "yes", "3", "many"], "sizes": ["two", "two", "many"],
    "drag": ["yade", "schiller_naumann", "brown_lawler", "ferguson_church"], "lift": ["off", "off", "0.2"],
    "walls": ["no", "no", "smooth", "rough"], "surface": ["free", "speed", "follow"],
    "drive": ["slope", "pressure", "time", "discharge", "depth"], "added_mass": ["off", "off", "0.4"],
    "felt": ["centre", "volume"], "viscosity": ["constant", "einstein", "power"],
    "upflow": ["off", "off", "off", "0.002"], "bed_mixing": ["off", "0.5"], "stream": ["steady", "rest"],
    "overlap": ["twice", "twice", "once"], "average": ["all", "mobile"], "leave": ["no", "no", "yes"],
    "box": ["still", "still", "wider"],
    "period": [1, 2, 3], "skin": [0.0012, 0.0003], "steps": [4, 8, 15],
}


@until_settled
def lawful(o, no):
    """What does not go together, by the page."""
    alone = o["couple"] in ("none", "one")
    no(alone, surface="free", drive="slope" if o["drive"] != "pressure" else "pressure", bed_mixing="off")
    no(o["drive"] in ("discharge", "depth") and o["surface"] == "speed", surface="follow")
    no(o["drive"] == "depth", surface="follow")
    no(o["turbulence"] == "none", bed_mixing="off")
    no(o["couple"] == "none", upflow="off", classes="no")
    no(o["classes"] == "many", sizes="many", layers=3)
    no(o["couple"] == "none" and o["fluctuation"] in ("depth", "langevin"), fluctuation="correlated")
    no(o["fluctuation"] != "none" and o["upflow"] != "off", upflow="off")
    no(o["upflow"] != "off", added_mass="off")


def words_of(o):
    words = (f"{o['period']} mesh 24 <L 0.0024> <at z 0> fluid <rho 1000> <eta 0.001> gravity <A 0.4905 0 "
             "-9.797> phi_max 0.61")
    words += "".join(f" {name} {o[name]}" for name in ("couple", "turbulence", "drag", "lift", "felt", "viscosity",
                                                       "stream"))
    words += f" overlap {o['overlap']} average {o['average']} added_mass {o['added_mass']} solve <t 1e-3> <t 1e-4>"
    words += {"no": "", "yes": " classes yes", "3": " classes 3", "many": " classes yes"}[o["classes"]]
    words += f" bed_mixing {o['bed_mixing']}" * (o["bed_mixing"] != "off")
    words += {"no": "", "smooth": " sidewall <L 0.03> 1",
              "rough": " sidewall <L 0.03> 1 wall_roughness <L 1e-3> wall_mixing yes"}[o["walls"]]
    words += {"free": "", "speed": " surface speed <V 0.7>", "follow": " surface follow <L 0.045>"}[o["surface"]]
    words += {"slope": "", "pressure": " pressure_gradient <slope -200>", "time": " pressure_gradient v_push",
              "discharge": " discharge <nu 0.03>", "depth": " discharge <nu 0.03> adjust depth <L 0.2>"}[o["drive"]]
    words += f" upflow <V {o['upflow']}>" if o["upflow"] != "off" else ""
    bed = "<L 0.01>"
    words += {"none": "", "depth": f" fluctuation depth 7 {bed}"}.get(o["fluctuation"],
                                                                      f" fluctuation {o['fluctuation']} 7 {bed}"
                                                                    + " renewal <t 4e-5>" * (
                                                                        o["fluctuation"] != "langevin"))
    return words


def build(options, seed):
    o = lawful(options)
    s, R = Scene("vans", o, seed), random.Random(f"bed {seed}")
    for layer in range(o["layers"] + 1):
        for i in range(4):
            for j in range(4):
                x = [(0.00375 + 0.0075 * k) for k in (i, j)] + [0.0031 + 0.0066 * layer]
                v = (0, 0, 0)
                if layer:
                    x, v = [c + R.uniform(-0.0006, 0.0006) for c in x], [R.uniform(-0.1, 0.1) + 0.1 * layer * (k == 0)
                                                                         for k in range(3)]
                small = layer and R.random() < 0.5
                size = 0.003 + 0.003 * R.random() if layer and o["sizes"] == "many" else 0.0048 if small else 0.006
                s.atom(x, v, 2 if layer else 1, diameter=size, density=2500.0,
                       molecule=i + 1 if layer == 1 and j < 2 else 0)
    s.head = ["units si", "atom_style hybrid sphere bond", "comm_modify vel yes"]
    s.make = ["boundary p p f", "region box block <block 0 0.03 0 0.03 0 0.08>", "create_box 2 box"]
    s.after = ["mass * 1"]
    s.groups = ["group bed type 1", "group mobile type 2"]
    s.define = [f"neighbor <L {o['skin']}> bin", "variable push equal <one slope -200-2e6*TIME>"]
    s.pair = [("gran/hooke/history", "<k 20000> NULL 0 NULL 0.4 0", "")]
    speeds = " ".join(f"<V {0.6 * k / 24!r}>" for k in range(25))
    s.fixes = ["fix gravity all gravity <A 9.81> vector <1 0.05 0 -0.99875>"]
    s.fixes += ["region up block <block INF INF INF INF 0.015 INF>",
                "fix away mobile evaporate 3 1000 up 4711"] * (o["leave"] == "yes")
    s.fixes += ["fix wider all deform 1 x vel <V 2.0> remap x"] * (o["box"] == "wider")
    s.fixes += [f"fix vans mobile hydro/vans {words_of(o)}",
                "fix move mobile nve/sphere"]
    s.late = [f"fix_modify vans profile values {speeds}"]
    s.columns = [("p", "xu yu zu"), ("V", "vx vy vz"), ("W", "omegax omegay omegaz"),
                 ("F", "f_vans[1] f_vans[2] f_vans[3]"), ("V", "f_vans[4] f_vans[5] f_vans[6]")]
    s.globals = [("F", "f_vans[1] f_vans[2] f_vans[3]"), ("nu", "f_vans[4]"), ("V", "f_vans[5]"), ("P", "f_vans[6]"),
                 ("1", "f_vans[7]"), ("1", "f_vans[8]"), ("F", "f_vans[9]"), ("L", "f_vans[10]"), ("nu", "f_vans[18]"),
                 ("A", "f_vans[19]")]
    columns = {2: "V", 3: "1", 7: "F", 8: "rate", 9: "nu", 10: "P"}
    if o["classes"] in ("3", "many"):       # radius and transport rate of bins, and phi of one of them
        s.globals += [("L", "f_vans[28]"), ("nu", "f_vans[30]"), ("L", "f_vans[34]"), ("nu", "f_vans[36]"),
                      ("1", "f_vans[7][21]")]
    s.globals += [(kind, f"f_vans[{row}][{column}]") for row in (2, 4, 7, 12, 20) for column, kind in columns.items()]
    s.dt, s.steps, s.tolerance, s.floor = 1e-5, o["steps"], 1e-8, 1e-7
    s.length, s.spacing = 1e-4, 0.006
    return s
