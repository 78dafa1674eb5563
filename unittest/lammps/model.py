"""The model by dense linear algebra, written from the published formulas and sharing nothing with the plugin.

(I/(6 pi eta_i a_i) + Omega) F = u_inf - v, with Omega_ij of the viscosity sqrt(eta_i eta_j)."""
import csv
import os

import numpy as np

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "data")


def pair_block(r, ai, aj):
    """Rotne-Prager-Yamakawa, unit viscosity: Zuk, Wajnryb, Mizerski & Szymczak 2014, equations for TT."""
    R = np.linalg.norm(r)
    if R <= abs(ai - aj) or R == 0.0:
        return np.eye(3) / (6 * np.pi * max(ai, aj))
    hh = np.outer(r, r) / R**2
    if R > ai + aj:
        s = ai**2 + aj**2
        return ((1 + s / (3 * R**2)) * np.eye(3) + (1 - s / R**2) * hh) / (8 * np.pi * R)
    d = (ai - aj)**2
    return ((16 * R**3 * (ai + aj) - (d + 3 * R**2)**2) * np.eye(3) + 3 * (d - R**2)**2 * hh) / (32 * R**3 * 6 * np.pi * ai * aj)


def mobility(x, a, eta, sees=None):
    """sees [n,n]: who sees whom; None: everybody."""
    n = len(x)
    eta = np.broadcast_to(eta, (n,))
    M = np.zeros((3 * n, 3 * n))
    for i in range(n):
        M[3 * i:3 * i + 3, 3 * i:3 * i + 3] = np.eye(3) / (6 * np.pi * eta[i] * a[i])
        for j in range(n):
            if i != j and (sees is None or sees[i, j]):
                M[3 * i:3 * i + 3, 3 * j:3 * j + 3] = pair_block(x[i] - x[j], a[i], a[j]) / np.sqrt(eta[i] * eta[j])
    return M


def forces(spheres, eta, u_inf=0.0, sees=None):
    slip = np.broadcast_to(u_inf, spheres.v.shape) - spheres.v
    return np.linalg.solve(mobility(spheres.x, spheres.a, eta, sees), slip.ravel()).reshape(-1, 3)


def same_clump(spheres):
    m = spheres.molecule
    return (m[:, None] == m[None, :]) & (m[:, None] != 0)


def read_table(name):
    """Rows of a table in unittest/data as dicts of strings; lines that begin with # are its source."""
    with open(os.path.join(DATA, name)) as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))
