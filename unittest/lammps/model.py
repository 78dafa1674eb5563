"""The model by dense linear algebra, written from the published formulas and sharing nothing with the plugin.

(I/(6 pi eta_i a_i) + Omega) F = u_inf - v, with Omega_ij of the viscosity sqrt(eta_i eta_j). With rotation the unknowns
are forces and torques. The formulas: Zuk, Wajnryb, Mizerski & Szymczak 2014; far apart as Wajnryb, Mizerski, Zuk &
Szymczak
2013. Leading
axes of x [..., n, 3] and a [..., n] are scenes of n spheres each."""
import csv
import os

import numpy as np

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "data")

# what the tapers multiply a pair's block with, q = R/range
TAPER = {"wendland": lambda q: np.where(q < 1, (1 - q)**4 * (1 + 4 * q), 0.0),
         "spherical": lambda q: np.where(q < 1, 1 - 1.5 * q + 0.5 * q**3, 0.0)}

EPSILON = np.zeros((3, 3, 3))       # Levi-Civita's
EPSILON[0, 1, 2] = EPSILON[1, 2, 0] = EPSILON[2, 0, 1] = 1.0
EPSILON[0, 2, 1] = EPSILON[2, 1, 0] = EPSILON[1, 0, 2] = -1.0


def pairs(x, a):
    """Of each pair: R and direction of i seen from j, ai, aj, and who is in which branch. At one point: no
    direction."""
    r = x[..., :, None, :] - x[..., None, :, :]
    R = np.linalg.norm(r, axis=-1)
    ai, aj = np.broadcast_arrays(a[..., :, None], a[..., None, :])
    inside = (R <= np.abs(ai - aj)) | (R == 0.0)
    safe = np.where(R == 0.0, 1.0, R)
    return safe, r / safe[..., None], ai, aj, inside, R > ai + aj


def tensor(f, g, h):
    """f I + g hh"""
    return f[..., None, None] * np.eye(3) + g[..., None, None] * h[..., :, None] * h[..., None, :]


def velocity_of_force(x, a):
    """Blocks [..., n, n, 3, 3] for unit viscosity; the diagonal is the sphere's own."""
    R, h, ai, aj, inside, far = pairs(x, a)
    s, d = ai**2 + aj**2, (ai - aj)**2
    overlap = 6 * np.pi * ai * aj * 32 * R**3
    f = np.where(far, (1 + s / (3 * R**2)) / (8 * np.pi * R), (16 * R**3 * (ai + aj) - (d + 3 * R**2)**2) / overlap)
    g = np.where(far, (1 - s / R**2) / (8 * np.pi * R), 3 * (d - R**2)**2 / overlap)
    f, g = np.where(inside, 1 / (6 * np.pi * np.maximum(ai, aj)), f), np.where(inside, 0.0, g)
    return tensor(f, g, h)


def spin_of_torque(x, a):
    R, h, ai, aj, inside, far = pairs(x, a)
    d = ai - aj
    A = 5 * R**6 - 27 * R**4 * (ai**2 + aj**2) + 32 * R**3 * (ai**3 + aj**3) - 9 * R**2 * (ai**2 - aj**2)**2 \
        - d**4 * (ai**2 + 4 * ai * aj + aj**2)
    B = 3 * (d**2 - R**2)**2 * (ai**2 + 4 * ai * aj + aj**2 - R**2)
    overlap = 8 * np.pi * (ai * aj)**3 * 64 * R**3
    f = np.where(far, -1 / (16 * np.pi * R**3), A / overlap)
    g = np.where(far, 3 / (16 * np.pi * R**3), B / overlap)
    f, g = np.where(inside, 1 / (8 * np.pi * np.maximum(ai, aj)**3), f), np.where(inside, 0.0, g)
    return tensor(f, g, h)


def spin_of_force(x, a):
    """Angular velocity of i = f (force on j) x h, h the direction of i seen from j."""
    R, h, ai, aj, inside, far = pairs(x, a)
    overlap = (ai - aj + R)**2 * (aj**2 + 2 * aj * (ai + R) - 3 * (ai - R)**2) / (16 * np.pi * ai**3 * aj * 8 * R**2)
    f = np.where(far, 1 / (8 * np.pi * R**2), overlap)
    # The force on a sphere inside i turns i as a whole by its lever; i inside j only goes along with it.
    f = np.where(inside, np.where(ai > aj, R / (8 * np.pi * ai**3), 0.0), f)
    return f[..., None, None] * np.einsum("...k,kpq->...pq", h, EPSILON)


def mobility(x, a, eta, sees=None, taper=None, rotation=False):
    """Matrix [..., 3n, 3n], with rotation [..., 6n, 6n] in the order force, torque of each sphere. sees [n,n]: who sees
    whom; None: everybody. taper: (name, range)."""
    n, m = a.shape[-1], 6 if rotation else 3
    eta = np.broadcast_to(eta, a.shape)
    blocks = np.zeros(a.shape + (n, m, m))
    blocks[..., :3, :3] = velocity_of_force(x, a)
    if rotation:
        blocks[..., 3:, 3:] = spin_of_torque(x, a)
        blocks[..., 3:, :3] = spin_of_force(x, a)
        blocks[..., :3, 3:] = np.swapaxes(np.swapaxes(blocks[..., 3:, :3], -4, -3), -1, -2)
    factor = 1 / np.sqrt(eta[..., :, None] * eta[..., None, :])
    own = np.eye(n, dtype=bool)
    if taper:
        R = np.linalg.norm(x[..., :, None, :] - x[..., None, :, :], axis=-1)
        factor = factor * np.where(own, 1.0, TAPER[taper[0]](R / taper[1]))
    if sees is not None:
        factor = factor * (sees | own)
    blocks *= factor[..., None, None]
    return np.swapaxes(blocks, -3, -2).reshape(a.shape[:-1] + (m * n, m * n))


def forces(spheres, eta, u_inf=0.0, sees=None):
    slip = np.broadcast_to(u_inf, spheres.v.shape) - spheres.v
    return np.linalg.solve(mobility(spheres.x, spheres.a, eta, sees), slip.ravel()).reshape(-1, 3)


def forces_and_torques(x, a, eta, v, omega, **how):
    """[n, 6] in a fluid at rest"""
    slip = -np.hstack([v, np.broadcast_to(omega, v.shape)])
    return np.linalg.solve(mobility(x, a, eta, rotation=True, **how), slip.ravel()).reshape(-1, 6)


def same_clump(spheres):
    m = spheres.molecule
    return (m[:, None] == m[None, :]) & (m[:, None] != 0)


def read_table(name):
    """Rows of a table in unittest/data as dicts of strings; lines that begin with # are its source."""
    with open(os.path.join(DATA, name)) as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))
