"""Exact answers that several examples compare with."""
from runs import np


def approach_drag(gap):
    """Force over 6 pi eta a U of equal spheres that approach each other with U each (Brenner 1961, gap in radii)"""
    alpha = np.arccosh(1 + gap / 2)
    n = np.arange(1, int(25 / alpha) + 30, dtype=float)
    w, m = np.exp(-(2 * n + 1) * alpha), 2 * n + 1          # numerator and denominator times w
    top = 1 + 2 * w + w * w + m * m * np.sinh(alpha) ** 2 * w
    bottom = 1 - w * w - m * np.sinh(2 * alpha) * w
    return 4 / 3 * np.sinh(alpha) * np.sum(n * (n + 1) / ((2 * n - 1) * (2 * n + 3)) * (top / bottom - 1))
