"""Linear theory of a box that floats in a tank: incompressible, inviscid, small motions. By symmetry half of the tank,
in square cells: the potential of the flow from its values at the free surface and the velocity w of the box,

    eta_t = phi_y, phi_t = - g eta at the free surface;   M w_t = - g b z - int phi_t dx - (M - M_0) g
    (density of water 1)

for a box of the width b and the mass M that begins at the draft of M_0, at rest."""
import numpy as np


def potentials(d, wide, deep, half, draft):
    """Cells of size d. Solves the Laplace equation for one surface value after the other, and for w = 1. Returns phi_y
    at the surface and phi at the bottom of the box, for each."""
    nx, ny, nb, nd = (int(round(q / d)) for q in (wide, deep, half, draft))
    number = -np.ones((nx, ny), int)
    fluid = np.ones((nx, ny), bool)
    fluid[nx - nb:, ny - nd:] = False
    number[fluid] = np.arange(fluid.sum())
    free, A = nx - nb, np.zeros((fluid.sum(),) * 2)
    right = np.zeros((fluid.sum(), free + 1))
    for i, j in zip(*np.nonzero(fluid)):
        k = number[i, j]
        for p, q in ((i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)):
            if 0 <= p < nx and 0 <= q < ny and fluid[p, q]:
                A[k, k] += 1
                A[k, number[p, q]] -= 1
            elif q == ny:    # the surface is half a cell above
                A[k, k] += 2
                right[k, i] += 2
            elif q > j:    # what flows in through the box's bottom
                right[k, free] += d
    phi = np.linalg.solve(A, right)
    up = -2 / d * phi[number[:free, ny - 1]]
    up[:, :free] += 2 / d * np.eye(free)
    # to the face from half a cell below, with its slope w = 1
    below = phi[number[free:, ny - nd - 1]]
    below[:, free] += d / 2
    return up, below


def heave(M, M0, b=0.3, wide=1.0, deep=0.5, g=1.0, d=0.0125, T=9.0, dt=0.01):
    """t, z(t) of the box's centre."""
    up, below = potentials(d, wide / 2, deep, b / 2, M0 / b)
    free = len(up)
    load = 2 * d * below.sum(0)    # of both halves
    n = 2 * free + 2    # eta, phi, z, w
    A = np.zeros((n, n))
    eta, phi, z, w = slice(0, free), slice(free, 2 * free), n - 2, n - 1
    A[eta, phi], A[eta, w] = up[:, :free], up[:, free]
    A[phi, eta] = -g * np.eye(free)
    A[z, w] = 1
    total = M + load[free]    # with the added mass
    A[w, z], A[w, eta] = -g * b / total, g * load[:free] / total
    push = np.zeros(n)
    push[w] = -(M - M0) * g / total
    t, y, out = np.arange(0, T, dt), np.zeros(n), []
    for _ in t:
        out.append(y[z])
        k1 = A @ y + push
        k2 = A @ (y + dt / 2 * k1) + push
        k3 = A @ (y + dt / 2 * k2) + push
        k4 = A @ (y + dt * k3) + push
        y = y + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return t, np.array(out)


if __name__ == "__main__":
    for cell in (0.025, 0.0125):
        time, height = heave(0.036, 0.03, d=cell)
        at = np.nonzero((height[1:-1] - height[:-2]) * (height[2:] - height[1:-1]) < 0)[0] + 1
        print(cell, time[at].round(2), height[at].round(5))
