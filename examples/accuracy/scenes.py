"""Scenes whose velocities are known from exact Stokes flow, for run.py. A scene is a list of cases; a case has

    x         [n, 3] centres of unit spheres
    force     [n, 3] on each; 6 pi eta a = 1, so a lone sphere has the velocity of its force
    molecule  [n] spheres of one number, not 0, are one rigid body
    box       edge of the periodic cube, or None: open
    wall      is there a wall at z = 0?
    strain    [3, 3] rate of strain of the fluid, about the origin; the velocities are those less the fluid's, or None:
              at rest
    exact     the answer of `measure`, by exact Stokes flow
    measure   function of the velocities [n, 3] that the error is about
"""
import csv
import pathlib

from exact import WALLS, along_wall, approach_drag, sphere_at_wall
from runs import np

HERE = pathlib.Path(__file__).resolve().parent
SEDIMENTATION = HERE.parent / "sedimentation" / "data"


class Case:
    def __init__(self, x, force, exact, measure=np.asarray, molecule=None, box=None, strain=None, wall=False):
        self.x, self.force = np.atleast_2d(np.asarray(x, float)), np.asarray(force, float)
        self.molecule = np.zeros(len(self.x), int) if molecule is None else molecule
        self.exact, self.measure, self.box, self.strain = np.asarray(exact, float), measure, box, strain
        self.wall = wall

    def error(self, velocity, correction=0.0):
        return np.linalg.norm(self.measure(velocity) + correction - self.exact) / np.linalg.norm(self.exact)


def table(path):
    return list(csv.DictReader(line for line in path.read_text().splitlines() if not line.startswith("#")))


def downwards(n):
    return np.tile([0.0, 0.0, -1.0], (n, 1))


def rigid_clumps():
    """Twelve rigid clumps of 2 to 13 touching spheres, each alone under its weight along x, y and z."""
    drag = {row["name"]: np.array([[float(row[f"R{i}{j}"]) for j in range(1, 7)] for i in range(1, 7)]) / (6 * np.pi)
            for row in table(SEDIMENTATION / "clusters_exact.csv")}
    places = {}
    for row in table(SEDIMENTATION / "cluster_geometry.csv"):
        places.setdefault(row["name"], []).append([float(row[k]) for k in "xyz"])
    for name, R in drag.items():
        if name not in places:
            continue
        x = np.array(places[name])
        x -= x.mean(axis=0)
        for axis in range(3):
            force = np.zeros((len(x), 3))
            force[:, axis] = -1.0
            motion = np.linalg.solve(R, np.concatenate([force.sum(axis=0), np.zeros(3)]))
            yield Case(x, force, motion[:3] + np.cross(motion[3:], x), molecule=np.ones(len(x), int))


def two_spheres_settle():
    """Two spheres under their weight, along and across their line of centres, at distances of 2.01 to 10 radii."""
    for row in table(HERE / "two_spheres.csv"):
        distance = float(row["distance"])
        yield Case([(0, 0, 0), (0, 0, distance)], downwards(2), float(row["along"]) * downwards(2))
        yield Case([(0, 0, 0), (distance, 0, 0)], downwards(2), float(row["across"]) * downwards(2))


def two_spheres_pressed():
    """Two spheres pressed together, at gaps of 0.01 to 1 radius."""
    for gap in (0.01, 0.03, 0.1, 0.3, 1.0):
        force = np.array([(0, 0, 1.0), (0, 0, -1.0)])
        yield Case([(0, 0, 0), (0, 0, 2 + gap)], force, force / approach_drag(gap))


def two_spheres_strained():
    """Two free spheres in a strain along their line of centres and in a shear with it, gaps of 0.01 to 1 radius: how
    they lag behind the fluid, by A and B of Batchelor & Green (shear_pair/exact.csv). The error is relative to the
    fluid's velocity at their centres."""
    for row in table(HERE.parent / "shear_pair" / "exact.csv"):
        gap = float(row["gap"])
        if not 0.009 < gap < 1.1:
            continue
        x = np.array([(0, 0, -1 - gap / 2), (0, 0, 1 + gap / 2)])
        for strain, lag in ((np.diag([-0.5, -0.5, 1.0]), float(row["A"])),
                            (np.array([(0, 0, 0.5), (0, 0, 0), (0.5, 0, 0)]), float(row["B"]))):
            fluid = x @ strain
            yield Case(x, np.zeros((2, 3)), fluid, lambda v, fluid=fluid, lag=lag: v + (1 + lag) * fluid, strain=strain)


def close_clusters(only=None):
    """Clusters of 3 to 27 free spheres, gaps of 0.01 and 0.02 radii, under their weight; or the one of that name."""
    found = {}
    for row in table(HERE.parent / "dense_settling" / "exact.csv"):
        if only in (None, row["cluster"]):
            found.setdefault(row["cluster"], []).append([float(row[k]) for k in ("x", "y", "z", "Ux", "Uy", "Uz")])
    for rows in map(np.array, found.values()):
        yield Case(rows[:, :3], downwards(len(rows)), rows[:, 3:])


def of_pystokes():
    """Row of pystokes.csv, and its case: two and three spheres that settle, measured by their mean speed"""
    for row in table(HERE / "pystokes.csv"):
        d = float(row["distance"])
        x = {"two along their line": [(0, 0, 0), (0, 0, d)], "two side by side": [(0, 0, 0), (d, 0, 0)],
             "a triangle": [(0, 0, 0), (d, 0, 0), (0.5 * d, 0.75**0.5 * d, 0)]}[row["scene"]]
        yield row, Case(x, downwards(len(x)), float(row["exact"]), mean_fall)


def one_at_a_wall(pushed):
    """A lone sphere above a wall at gaps of 0.01 to 1 radius that falls to it, or is pushed along it."""
    known = sphere_at_wall()
    along, _ = along_wall(known, 1.0, 0.0)
    for gap, normal, sideways in zip(known["gap"], known["normal"], along):
        if 0.01 <= gap <= 1:
            exact = np.array([(sideways, 0, 0)]) if pushed else downwards(1) / normal
            yield Case([(0, 0, 1 + gap)], [(1, 0, 0)] if pushed else downwards(1), exact, wall=True)


def groups_at_a_wall(load):
    """Two and three equal spheres above a wall, gaps of 0.1 to 0.5 from it and among each other, all under one force or
    random ones."""
    found = {}
    for row in table(WALLS / "groups_exact.csv"):
        if row["load"] == load and not row["group"].startswith("pair_radii"):
            found.setdefault(row["group"],
                             []).append([float(row[k]) for k in ("x", "y", "z", "Fx", "Fy", "Fz", "Ux", "Uy", "Uz")])
    for rows in map(np.array, found.values()):
        yield Case(rows[:, :3], rows[:, 3:6], 6 * np.pi * rows[:, 6:], wall=True)


def mean_fall(velocity):
    return -velocity[:, 2].mean()


def arrays(phi):
    """A simple cubic array that settles: 1/K of Zick & Homsy, J. Fluid Mech. 115, 13 (1982)."""
    K = {0.027: 2.008, 0.064: 2.810, 0.125: 4.292, 0.216: 7.442, 0.343: 15.4, 0.45: 28.1}[phi]
    cell = (4 / 3 * np.pi / phi)**(1 / 3)
    x = cell * np.array([(i, j, k) for i in (0.25, 1.25) for j in (0.25, 1.25) for k in (0.25, 1.25)])
    yield Case(x, downwards(8), 1 / K, mean_fall, box=2 * cell)


def settling(phi):
    """Hindered settling of hard spheres at equilibrium: fit to multipole simulations of Abade et al. (J. Chem. Phys.
    132, 014503 (2010)) by Riest et al. (Soft Matter 11, 2821 (2015))"""
    return 1 - 6.5464 * phi * (1 - 3.348 * phi + 7.426 * phi**2 - 10.034 * phi**3 + 5.882 * phi**4)


def beyond_the_box(phi, n):
    """What waves longer than a box of n spheres add to the speed of settling, in a fluid of the viscosity of the
    suspension as the model has it: 1.7601 S(0) (phi/n)^(1/3) (Ladd, J. Chem. Phys. 93, 3484 (1990)), S(0) of Carnahan &
    Starling."""
    S0 = (1 - phi)**4 / ((1 + 2 * phi)**2 + phi**3 * (phi - 4))
    return 1.7601 * S0 * (phi / n)**(1 / 3)


def high_frequency_viscosity(phi):
    """Of hard spheres, relative to the fluid's (Sierou & Brady, J. Fluid Mech. 448, 115 (2001)): divides beyond_the_box
    for models that have stresslets."""
    crowd = phi * (1 + phi * (1 + phi - 2.3 * phi**2))
    return (1 + 1.5 * crowd) / (1 - crowd)


def suspension(phi, places):
    """Of each set of places [n, 3] in a cube of some edge: the weight along x, y and z, by turning the places."""
    for x, edge in places:
        for axis in range(3):
            yield Case(np.roll(x, axis, axis=1), downwards(len(x)), settling(phi), mean_fall, box=edge)
