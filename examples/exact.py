"""Exact answers that several examples compare with."""
from runs import TOP, np, read_table

WALLS = TOP / "unittest" / "data" / "walls"     # computed by another code; the tables say how


def approach_drag(gap):
    """Force over 6 pi eta a U of equal spheres that approach each other with U each (Brenner 1961, gap in radii)"""
    alpha = np.arccosh(1 + gap / 2)
    n = np.arange(1, int(25 / alpha) + 30, dtype=float)
    w, m = np.exp(-(2 * n + 1) * alpha), 2 * n + 1          # numerator and denominator times w
    top = 1 + 2 * w + w * w + m * m * np.sinh(alpha) ** 2 * w
    bottom = 1 - w * w - m * np.sinh(2 * alpha) * w
    return 4 / 3 * np.sinh(alpha) * np.sum(n * (n + 1) / ((2 * n - 1) * (2 * n + 3)) * (top / bottom - 1))


def wall_drag(gap):
    """Force over 6 pi eta a U of a sphere that moves towards a plane wall (Brenner 1961, gap in radii)"""
    alpha = np.arccosh(1 + gap)
    n = np.arange(1, int(25 / alpha) + 30, dtype=float)
    w, m = np.exp(-(2 * n + 1) * alpha), 2 * n + 1
    top = 1 - w * w + m * np.sinh(2 * alpha) * w
    bottom = (1 - w)**2 - m * m * np.sinh(alpha)**2 * w
    return 4 / 3 * np.sinh(alpha) * np.sum(n * (n + 1) / ((2 * n - 1) * (2 * n + 3)) * (top / bottom - 1))


def sphere_at_wall():
    """Of a lone sphere of radius 1 above a plane wall, by gap: resistances over 6 pi eta a (normal, parallel), 8 pi eta
    a^2 (coupling) and 8 pi eta a^3 (roll, spin)"""
    rows = read_table(WALLS / "wall_functions.csv")
    names = {"gap": "gap_over_a",
             **{name: name + "_exact" for name in ("normal", "parallel", "coupling", "roll", "spin")}}
    return {name: np.array([float(row[column]) for row in rows]) for name, column in names.items()}


def sphere_in_shear():
    """The same in the flow u_x = z: parallel, coupling, roll, and of a sphere that rests force over 6 pi eta a h,
    torque over 4 pi eta a^3, h the height of its centre"""
    rows = read_table(WALLS / "wall_shear.csv")
    names = {"gap": "gap_over_a", "parallel": "parallel", "coupling": "coupling", "roll": "roll",
             "force": "shear_force_over_6_pi_eta_a_h_rate", "torque": "shear_torque_over_4_pi_eta_a3_rate"}
    return {name: np.array([float(row[column]) for row in rows]) for name, column in names.items()}


def along_wall(exact, force, torque):
    """U and W of a free sphere under a force along x over 6 pi eta a and a torque about y over 8 pi eta a^3"""
    F, T = np.broadcast_arrays(force, torque)
    det = exact["parallel"] * exact["roll"] - 4 / 3 * exact["coupling"]**2
    return (exact["roll"] * F - 4 / 3 * exact["coupling"] * T) / det, (exact["parallel"] * T - exact["coupling"] *
                                                                       F) / det
