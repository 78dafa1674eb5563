"""Pairs of spheres of unlike radii through LAMMPS, as unittest/data/multiblob/unlike_pairs.csv has them: their motions
under eleven loads, turned as they may be, and how far these are off; and groups of three and four, as unlike_groups.csv
has them."""
import csv
import os

import numpy as np

import model
from system import Spheres, read_dump

LOADS = ["F_l along", "F_l across", "F_s along", "F_s across", "T_l along", "T_l across", "T_s along", "T_s across",
         "E along", "E shear", "E across"]
STRAINS = {"E along": np.diag([1.0, 1.0, -2.0]) / 6 ** 0.5, "E shear": np.array([(0, 0, 1), (0, 0, 0), (1, 0, 0)]) /
           2 ** 0.5,
           "E across": np.diag([1.0, -1.0, 0.0]) / 2 ** 0.5}


def rows():
    """{(ratio, xi): {load: exact Ul Wl Us Ws}}"""
    found = {}
    with open(os.path.join(model.DATA, "multiblob", "unlike_pairs.csv")) as lines:
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            key = float(row["ratio"]), float(row["xi"])
            found.setdefault(key, {})[row["load"]] = [float(row[name]) for name in ("Ul", "Wl", "Us", "Ws")]
    return found


def exact(row):
    """[11 loads][2 spheres][6] U and W in the frame of the pair"""
    out = np.zeros((len(LOADS), 2, 6))
    for k, load in enumerate(LOADS):
        U, W = (2, 5) if load.endswith("along") else (0, 4)
        for q in range(2):
            out[k, q, U], out[k, q, W] = row[load][2 * q:2 * q + 2]
    return out


def turns(count, seed=7):
    """Rotations, even at random"""
    rng = np.random.default_rng(seed)
    out = []
    for _ in range(count):
        Q, R = np.linalg.qr(rng.normal(size=(3, 3)))
        Q = Q * np.sign(np.diag(R))
        out.append(Q * np.linalg.det(Q))
    return out


def loads():
    """[11][2 spheres][6] F and T in the frame of the pair; none in the strains"""
    out = np.zeros((len(LOADS), 2, 6))
    for k, load in enumerate(LOADS[:8]):
        out[k, int(load[2] == "s"), {"F along": 2, "F across": 0, "T along": 5,
                                     "T across": 4}[load[0] + load[3:]]] = 1.0
    return out


def push(sim, rows):
    """Force and torque [n, 6] on each sphere, in the order of atom IDs; rows: or a function of the step"""
    def give(_, step, nlocal, tags, x, f):
        torque, now = sim.raw("torque"), rows(step) if callable(rows) else rows
        for i in range(nlocal):
            f[i], torque[i] = np.split(now[tags[i] - 1], 2)
    sim.command("fix load all external pf/callback 1 1")
    sim.lmp.set_fix_external_callback("load", give, None)


def motions(simulation, folder, ratio, xi, style, ways):
    """[ways][11][2][6] U and W in the frame of the pair, those of the strains less the flow at the centres. One run for
    each way, one load a step."""
    a = np.array((1.0, 1.0 / ratio))
    z = np.array([(0, 0, a.sum() * (1 + xi / 2)), (0, 0, 0.0)])
    path = os.path.join(str(folder), "motions")
    wanted, found = loads(), []
    for Q in ways:
        x = z @ Q.T
        flow = []
        for c in range(3):
            terms = []
            for k, load in enumerate(LOADS[8:]):
                E = Q @ STRAINS[load] @ Q.T
                terms.append(f"(step=={8 + k})*(" + "+".join(f"({E[c, d]:.17g})*{'xyz'[d]}" for d in range(3)) + ")")
            flow.append(f"variable u{c} atom " + "+".join(terms).replace("step", "v_now"))
        sim = simulation(Spheres(x, a), f"cut_off_distance inf visc 1 {style} fluid_velocity v_u0 v_u1 v_u2 "
                                        "relative_tolerance 1e-7", fix=False,
                         dt=1e-12, before_pair="\n".join(["variable now equal step"] + flow), box=[(-9.0, 9.0)] * 3)
        turned = np.concatenate([wanted[..., :3] @ Q.T, wanted[..., 3:] @ Q.T], axis=-1)
        push(sim, lambda step, turned=turned: turned[min(step, 10)])
        sim.commands(["fix move all stokes_dynamics/overdamped",
                      f"dump all all custom 1 {path} id vx vy vz omegax omegay omegaz",
                      "dump_modify all sort id format float %.17g"]).run(10)
        sim.command("undump all")
        V = np.array([frame for _, frame in read_dump(path)])
        for k, load in enumerate(LOADS[8:]):
            E = Q @ STRAINS[load] @ Q.T
            V[8 + k, :, :3] -= x @ E
        found.append(np.concatenate([V[..., :3] @ Q, V[..., 3:] @ Q], axis=-1))
    return np.array(found)


def errors(V, V0, ratio):
    """[ways][11][2 spheres] over the sphere's own scale: hypot(U, a W) of what it is off, over the largest exact answer
    of that sphere over the directions of that kind of load (that of a strain at least E a/2)"""
    a = np.array((1.0, 1.0 / ratio))

    def size(v):
        return np.hypot(np.linalg.norm(v[..., :3], axis=-1), a * np.linalg.norm(v[..., 3:], axis=-1))

    own = size(V0)
    kinds = [load.split()[0] for load in LOADS]
    scale = np.array([[max(own[j, q] for j, kind in enumerate(kinds) if kind == kinds[k]) for q in range(2)]
                      for k in range(len(LOADS))])
    scale[8:] = np.maximum(scale[8:], a / 2)
    return size(V - V0) / scale


# --- groups -----------------------------------------------------------------------------------------------------------

def groups():
    """{case: (x, a, {load: (F, T, U, W)})}"""
    found = {}
    with open(os.path.join(model.DATA, "multiblob", "unlike_groups.csv")) as lines:
        for row in csv.DictReader(line for line in lines if not line.startswith("#")):
            numbers = [float(row[name]) for name in "x y z a Fx Fy Fz Tx Ty Tz Ux Uy Uz Wx Wy Wz".split()]
            found.setdefault(row["case"], {}).setdefault(row["load"], []).append(numbers)
    return {case: (np.array(next(iter(loads.values())))[:, :3], np.array(next(iter(loads.values())))[:, 3],
                   {load: np.array(rows)[:, 4:] for load, rows in loads.items()}) for case, loads in found.items()}


GROUPS = groups()
STRAIN = {"strain xy": (0, 1, 0.5 ** 0.5), "strain xz": (0, 2, 0.5 ** 0.5), "strain yz": (1, 2, 0.5 ** 0.5)}


def strain_of(load):
    E = np.zeros((3, 3))
    if load in STRAIN:
        i, j, value = STRAIN[load]
        E[i, j] = E[j, i] = value
    elif load == "strain xx-yy":
        E[0, 0], E[1, 1] = 0.5 ** 0.5, -0.5 ** 0.5
    elif load == "strain zz":
        E = np.diag([1, 1, -2]) / 6 ** 0.5
    return E


def group_motions(simulation, case, style):
    """{load: [n, 6]} U and W, in the strains less the flow at each centre"""
    x, a, loads = GROUPS[case]
    found = {}
    for load, rows in loads.items():
        E = strain_of(load)
        flow = [f"variable u{c} atom " + "+".join(f"({E[c, d]:.17g})*{'xyz'[d]}" for d in range(3)) for c in range(3)]
        sim = simulation(Spheres(x, a), f"cut_off_distance inf visc 1 {style} fluid_velocity v_u0 v_u1 v_u2 "
                                        "relative_tolerance 1e-7", fix=False,
                         dt=1e-12, before_pair="\n".join(flow))
        push(sim, rows[:, :6])
        sim.commands("fix move all stokes_dynamics/overdamped").run()
        found[load] = np.hstack([sim.v - x @ E, sim.atom("omega")])
    return found


def group_errors(found, case):
    """{kind of load: [n]} per cent of the sphere's largest own motion under that kind of load; strain: at least E
    a/2"""
    x, a, loads = GROUPS[case]
    scale = np.repeat(np.stack([np.ones_like(a), a], axis=1), 3, axis=1)
    out = {}
    for kind in ("strain", "forces", "torques", "weight"):
        names = [load for load in loads if load.startswith(kind)]
        own = np.array([np.linalg.norm(scale * loads[load][:, 6:], axis=1) for load in names]).max(axis=0)
        off = np.array([np.linalg.norm(scale * (found[load] - loads[load][:, 6:]), axis=1) for load in names]).max(
            axis=0)
        out[kind] = 100 * off / np.maximum(own, 0.5 * a if kind == "strain" else 0)
    return out
