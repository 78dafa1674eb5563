"""An independent model of one solve of the stream (numpy, dense matrices), for two tables:
    python3 independent_stream.py fluid_turb_lm2_wall > fluid_turb_lm2_wall.consistent.csv
    python3 independent_stream.py fluid_turb_lm5 > fluid_turb_lm5.consistent.csv
fluid_turb_lm2_wall has side walls. The friction factor is the root of 1/sqrt(f) = 2 log10(Re sqrt(f)) + 0.32, by
bisection, with Re on the hydraulic radius, half the width, or the laminar 24/Re where that is the larger (below Re 0.02
the law of turbulent streams would be larger again: it does not count there). fluid_turb_lm5 has grains of two radii;
pores and the mean diameter 6 V/S are of as many grains of either as there are."""
import os
import sys

import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))


def read(path):
    header, rows = {}, []
    for line in open(path):
        line = line.rstrip("\n")
        if line.startswith("#"):
            if "=" in line:
                key, value = line[1:].split("=", 1)
                header[key.strip()] = [float(word) for word in value.split()]
        else:
            rows.append(line.split(","))
    names, rows = rows[0], rows[1:]
    return header, {name: np.array([float(row[c]) for row in rows if row[c] != ""]) for c, name in enumerate(names)}


def friction(Re):
    """Bisection in log10 sqrt(f), of which 1/sqrt(f) - 2 log10(Re sqrt(f)) - 0.32 is a falling function."""
    low, high = np.full_like(Re, -8.0), np.full_like(Re, 12.0)
    for _ in range(200):
        middle = 0.5 * (low + high)
        above = 10 ** -middle - 2 * (np.log10(Re) + middle) - 0.32 > 0
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    return np.where(Re < 1, 24 / Re, np.maximum(10 ** (2 * low), 24 / Re))


def sums_of_grains(header, c):
    """Volume and surface of the grains in a slice over its volume"""
    a = np.array(header["radiusParts"])[:, None]
    phi = np.array([c["phi_c0"], c["phi_c1"]])
    return phi.sum(0), (phi * 3 / a).sum(0)


def lengths(header, c, sums=sums_of_grains):
    key = lambda name: header[name][0]
    dz, kappa, phi_max, phi = key("deltaZ"), key("kappa"), key("phiMax"), c["phi"]
    if key("ilm") == 5:
        V, S = sums(header, c)
        some = S > 0
        S = np.where(some, S, 1)
        pore = (1 - phi) / np.maximum(phi, 1e-3) * np.where(some, V / S, 1)
        z, bed = edges(header), edges(header)[np.flatnonzero(phi > key("phiBed"))[-1]]
        return np.maximum(np.minimum(pore / 2, 0.2 * np.where(some, 6 * V / S, 0)), kappa * (z - bed))
    assert key("ilm") == 2
    packed = np.flatnonzero(phi >= phi_max)
    p = np.minimum(phi, phi_max)
    if len(packed):
        p[:packed[-1]] = phi_max
    return np.concatenate([[0], np.cumsum(kappa * dz * (phi_max - p) / phi_max)[:-1]])


def edges(header):
    return header["deltaZ"][0] * np.arange(int(header["nCell"][0]))


def solve(header, c, friction=friction, sums=sums_of_grains):
    key = lambda name: header[name][0]
    N, dz, rho, nu = int(key("nCell")), key("deltaZ"), key("densFluid"), key("viscoDyn") / key("densFluid")
    M, phi, v, U = N - 1, c["phi"], c["vx"], c["u_in"].copy()
    steps = round(key("t_end") / key("dt"))
    dt, width, coef = key("t_end") / steps, key("channelWidth"), key("fluidFrictionCoef")
    slip = U[1:] - v
    with np.errstate(divide="ignore", invalid="ignore"):
        b = phi / (4 / 3 * np.pi * key("radiusPart") ** 3) * c["drag"] / slip / rho
    b = np.minimum(np.where(b > 0, b, 0), 0.1 / dt)
    l = lengths(header, c, sums)
    h = np.full(N, dz)
    h[0] = h[M] = dz / 2
    e = 1 - phi
    node = np.concatenate([[phi[0]], 0.5 * (phi[1:] + phi[:-1])])
    e_node = 1 - node
    e_node[M] = e[M - 1]
    assert key("irheolf") == 0 and key("iusl") == 1 and key("viscousSubLayer") == 0
    drive = header["gravity"][0] - key("dpdx") / rho
    q = phi * v
    for _ in range(steps):
        nut = l ** 2 * np.abs(U[1:] - U[:-1]) / h
        speed = np.maximum(np.abs(U[1:N]), 1e-10 * nu / (0.5 * width))
        wall = key("fluidWallFriction") * e[:M] * 2 / width * coef * friction(
            np.maximum(speed * 0.5 * width / nu, 1e-10)) / 8 * speed / 2
        A, r = np.zeros((M, M)), np.zeros(M)
        for j in range(M):                                     # the row of slice j, unknown U'[j + 1]
            A[j, j] += e[j] / dt + b[j] + wall[j]
            r[j] += e[j] * U[j + 1] / dt + b[j] * v[j] + e[j] * drive - wall[j] * U[j + 1]
            for n, sign in ((j + 1, 1), (j, -1)):              # fluxes through its upper and lower node, into the slice
                viscous, eddy = e[j] / dz * nu / h[n], e_node[n] * nut[n] / h[n] / dz
                above, below = n, n - 1                        # slices on both sides of node n
                up, down = min(above, M - 1), below            # free surface: U above it is that below
                A[j, up] -= sign * (viscous * e[above] + eddy)
                if below >= 0:
                    A[j, down] += sign * (viscous * e[below] + eddy)
                r[j] += sign * viscous * (q[above] - q[below] if n > 0 else 0)
        U[1:N] = np.linalg.solve(A, r)
        U[N] = U[M]
    stress = rho * e_node * nut * (U[1:] - U[:-1]) / h
    return U, b, nut, stress


if __name__ == "__main__":
    case = sys.argv[1]
    U, b, nut, stress = solve(*read(os.path.join(HERE, case + ".csv")))
    print("# inputs and parameters: the same case: " + case)
    print("u_out,taufsi,nut,stress")
    for k in range(len(U)):
        print(",".join("%.17g" % a[k] if k < len(a) else "" for a in (U, b, nut, stress)))
