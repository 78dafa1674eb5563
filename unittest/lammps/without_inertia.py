"""Spheres and clumps under fix stokes_dynamics/overdamped: what its tests share."""
import numpy as np

from system import Spheres

P6 = 6 * np.pi
FIX = "fix move all stokes_dynamics/overdamped"
ALL = "cut_off_distance inf visc 1"
CLUMPS = "cut_off_distance inf visc 1 rotation yes rigid_clumps yes"
COMM = "comm_modify cutoff 12\nneigh_modify exclude molecule/intra all"
THREE = Spheres([(-5, 0, 0), (0, 0, 0), (7, 0, 0)])


def weight(spheres, unit=P6):
    """fix addforce of the weight on each sphere"""
    return f"fix weight all addforce 0 0 {-unit!r}"


def fall(simulation, spheres, style=ALL, options="", t=40.0, steps=100, lines="", box=400.0, **more):
    sim = simulation(spheres, style, fix=False, box=[(-box, box)] * 3, dt=t / steps, **more)
    sim.commands(lines or weight(spheres)).commands(f"{FIX} {options}").run(steps)
    return sim


def contacts(k, style, friction=0.0):
    """Springs between spheres that overlap, without damping, and the pair style"""
    return [f"pair_style hybrid/overlay gran/hooke/history {k!r} NULL 0 NULL {friction} 0 stokes_dynamics {style}",
            "pair_coeff * * gran/hooke/history", "pair_coeff * * stokes_dynamics"]


def cloud(n=40, seed=3, spread=0.5):
    """Spheres of several sizes, some of which overlap by up to a tenth"""
    rng, x, a = np.random.default_rng(seed), [], []
    while len(x) < n:
        p, r = rng.uniform(-6, 6, 3), rng.uniform(1 - spread, 1 + spread)
        if all(np.linalg.norm(p - q) > 0.9 * (r + b) for q, b in zip(x, a)):
            x.append(p)
            a.append(r)
    return Spheres(x, a)


def chains(clumps=6, m=5, seed=4, side=14.0, molecule=1):
    rng, x = np.random.default_rng(seed), np.zeros((0, 3))
    while len(x) < clumps * m:
        axis = rng.normal(size=3)
        new = rng.uniform(0, side, 3) + np.outer(2 * np.arange(m) - (m - 1), axis / np.linalg.norm(axis))
        if len(x) == 0 or np.linalg.norm(new[:, None] - x, axis=-1).min() > 2.05:
            x = np.vstack([x, new])
    return Spheres(x, molecule=molecule + np.repeat(np.arange(clumps), m))


def mixed():
    """Chains, a doublet and free spheres"""
    spheres = chains(4, 3, seed=8, side=11.0)
    free = np.array([(-4.0, 1, 2), (5.5, -5, 3), (14.0, 14, 14), (1.0, 16, 4)])
    return Spheres(np.vstack([spheres.x, free]), molecule=np.append(spheres.molecule, [0] * 4))
