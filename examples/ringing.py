"""The mode n = 2 of a viscous drop in two dimensions: its exact frequency and damping, and those of a recorded
amplitude; and the rate at which a wave on a jet grows."""
import numpy as np


def slope(q, n=2):
    """q I_n'(q)/I_n(q) of the modified Bessel function, by its power series"""
    term = top = bottom = 1.0 + 0j
    top *= n
    for k in range(1, 400):
        term *= q * q / (4 * k * (k + n))
        bottom += term
        top += (2 * k + n) * term
        if abs(term) < 1e-17 * abs(bottom):
            break
    return top / bottom


def mode(nu, R=1.0):
    """Frequency and damping of small amplitudes, rho = sigma = 1: a potential r^2 and a stream function I_2(q r), q^2 =
    s/nu, no shear stress at the surface and the pressure of its curvature. The complex rate s is found by Newton's
    method from that of little viscosity."""
    nu = nu / R**0.5

    def residual(s, n=2):
        q = np.sqrt(s / nu + 0j)
        B = -2 * n * (n - 1) / (q * q + 2 * n * n - 2 * slope(q))
        return s * s + 2 * nu * n * s * ((n - 1) + B * (slope(q) - 1)) + n * (n * n - 1) * (1 + B)

    s, small = -4 * nu + 1j * 6**0.5, 1e-6
    for _ in range(50):
        step = residual(s) * 2 * small / (residual(s + small) - residual(s - small))
        s -= step
        if abs(step) < 1e-12:
            break
    return s.imag / R**1.5, -s.real / R**1.5


def fitted(t, amplitude, w, g):
    """Frequency and damping of exp(-g t) (a sin w t + b cos w t) + d, least squares by Gauss's and Newton's method from
    w and g"""
    a, b, d = 0.0, 0.0, 0.0
    for k in range(100):
        fade, sin, cos = np.exp(-g * t), np.sin(w * t), np.cos(w * t)
        columns = [fade * sin, fade * cos, np.ones_like(t)]
        if k == 0:      # these are linear
            a, b, d = np.linalg.lstsq(np.stack(columns, 1), amplitude, rcond=None)[0]
        ring = fade * (a * sin + b * cos)
        columns += [t * fade * (a * cos - b * sin), -t * ring]
        change = np.linalg.lstsq(np.stack(columns, 1), amplitude - ring - d, rcond=None)[0]
        a, b, d, w, g = np.array([a, b, d, w, g]) + change
        if np.abs(change).max() < 1e-12:
            break
    return w, g


def bessel(n, x):
    """I_n(x) of the modified Bessel function, by its power series"""
    term, total = (x / 2) ** n / (1 if n == 0 else n), 0.0
    for k in range(1, 60):
        total += term
        term *= x * x / (4 * k * (k + n))
    return total


def growth(k, nu, R=1.0):
    """Rate of the wave number k on a jet, rho = sigma = 1: Rayleigh's, k R I_1/I_0 (1 - k^2 R^2)/R^3 as its square, and
    the friction of a thin jet, 3 nu k^2 (Weber)"""
    x = k * R
    return (x * bessel(1, x) / bessel(0, x) * (1 - x * x) / R**3 + (1.5 * nu * k * k) ** 2) ** 0.5 - 1.5 * nu * k * k
