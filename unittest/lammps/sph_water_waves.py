"""A standing wave of small amplitude on water, with or without surface tension, beside Lamb's exact frequency and
damping (Hydrodynamics, 1932, section 349). g = 1, rho = 1, wave length 1, depth 0.5."""
import os
import sys

import numpy as np

from sph_tools import by_id, run, start

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "examples"))
from ringing import fitted  # noqa: E402

K, DEPTH = 2 * np.pi, 0.5
TANK = """
units lj
dimension 2
atom_style sph
atom_modify map array
boundary p f p
lattice sq {per_area:.17g} origin 0.5 0.5 0
region all block 0 1 {floor:.17g} 1 {back:.17g} {front:.17g} units box
create_box 2 all
region water block INF INF 0 0.5 INF INF units box
region floor block INF INF INF 0 INF INF units box
create_atoms 1 region water
create_atoms 2 region floor
mass * $(1/v_per_area)
group water type 1
group walls type 2
variable rho atom (1+7/v_c^2*(0.5-y))^(1/7)
set group all sph/rho 1
set group water sph/rho v_rho
variable u atom v_size*sin(2*PI*x)*(exp(2*PI*y)+exp(-2*PI*y))
variable w atom -v_size*cos(2*PI*x)*(exp(2*PI*y)-exp(-2*PI*y))
velocity water set v_u v_w 0 units box
neighbor {skin:.17g} bin
neigh_modify delay 0 every 1
pair_style sph/artVisc/tensCorr wendland {h:.17g} viscosity {nu:.17g} central shift yes
pair_coeff * * c $c
fix eos all sph/pressure Tait $(v_c^2/7) 1 7 tension {tension}
fix density all sph/density/continuity delta 0.1
fix walls walls wall/adami/sph gravity 0 -1 0 slip yes
fix move water nve/sph
fix g water gravity 1 vector 0 -1 0
{more}
timestep {dt:.17g}
"""


def lamb(k, depth, nu, sigma):
    """Frequency and damping of the linear wave; (s + 2)^2 + theta^-2 = 4 sqrt(1 + s) by Newton's method."""
    omega = np.sqrt((k + sigma * k**3) * np.tanh(k * depth))
    theta = nu * k * k / omega
    s = -2 + 1j / theta
    for _ in range(30):
        s -= ((s + 2)**2 + theta**-2 - 4 * np.sqrt(1 + s)) / (2 * (s + 2) - 2 / np.sqrt(1 + s))
    return s.imag * theta * omega, -s.real * theta * omega


def begun(n, nu, sigma, h, size, more):
    """LAMMPS with the tank, the speed of sound, and the time step"""
    c = 10 * max(1.0, np.sqrt(sigma * K))
    dt = 0.3 * h / n / c
    lmp = start()
    numbers = {"c": c, "per_area": n * n, "size": size}
    run(lmp, "\n".join(f"variable {name} equal {value:.17g}" for name, value in numbers.items()))
    run(lmp, TANK.format(per_area=n * n, floor=-6 / n, back=-0.5 / n, front=0.5 / n, skin=0.3 / n, h=h / n, nu=nu,
                         dt=dt, tension="yes" if sigma else "no", more=more))
    return lmp, dt


def tension_on_wave(n, h=2.0, sigma=0.1, height=0.004):
    """Of the force of fix sph/tension on a wave at rest: its sum, and its work on the motion of the wave, over those of
    a tension at the surface itself."""
    found = []
    for a in (height, -height):
        lmp, _ = begun(n, 0.005, sigma, h, 0.0, "")
        run(lmp, f"""variable along atom -{a / 2 / np.sinh(K * DEPTH):.17g}*sin(2*PI*x)*(exp(2*PI*y)+exp(-2*PI*y))
            variable up atom {a / 2 / np.sinh(K * DEPTH):.17g}*cos(2*PI*x)*(exp(2*PI*y)-exp(-2*PI*y))""")
        water, at = by_id(lmp, "type") == 1, K * by_id(lmp, "x", 3)
        run(lmp, f"displace_atoms water move v_along v_up 0 units box\nfix tension water sph/tension {sigma}\nrun 0")
        F = by_id(lmp, "f", 3).copy()
        run(lmp, "unfix tension\nrun 0")
        F = (F - by_id(lmp, "f", 3))[water]
        lmp.close()
        at = at[water]
        motion = np.array([-np.sin(at[:, 0]) * np.cosh(at[:, 1]), np.cos(at[:, 0]) * np.sinh(at[:, 1])]).T
        found.append((F[:, 1] @ np.cos(at[:, 0]), (F[:, :2] * motion).sum() / np.sinh(K * DEPTH)))
    return (np.array(found[1]) - found[0]) / (sigma * height * K * K)


def standing(n, nu=0.002, sigma=0.0, h=2.0, periods=6):
    """Frequency and damping over Lamb's, of a wave of height 0.02 that is let go where it is plane: n particles per
    wave length, h in spacings."""
    omega, damping = lamb(K, DEPTH, nu, sigma)
    lmp, dt = begun(n, nu, sigma, h, 0.02 * omega / (2 * np.sinh(K * DEPTH)),
                    f"fix tension water sph/tension {sigma}" if sigma else "")
    every, t, mode = int(2 * np.pi / omega / 20 / dt), [], []
    for sample in range(int(periods * 20) + 1):
        run(lmp, f"run {every if sample else 0} post no")
        t.append(sample * every * dt)
        x, v, water = by_id(lmp, "x", 3), by_id(lmp, "v", 3), by_id(lmp, "type") == 1
        mode.append((v[water, 1] * np.cos(K * x[water, 0])).sum())
    lmp.close()
    t, mode = np.array(t), np.array(mode) / mode[0]
    late = t > np.pi / omega    # the layer at the surface where vorticity spreads has grown
    found = fitted(t[late] - t[late][0], mode[late], omega, damping)
    return found[0] / omega, found[1] / damping
