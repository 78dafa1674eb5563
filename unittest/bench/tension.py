#!/usr/bin/env python3
"""Rows of doc/fix_sph_tension.md that are too long for a test: drops that rest and ring, contact angles, capillary
pressure, cost.

    . build/env.sh
    unittest/bench/tension.py ring 20 0.01       # 2-D, particles across, Ohnesorge number: pressure, frequency,
                                                 # damping over exact
    unittest/bench/tension.py calm 20 4711       # 2-D, Ohnesorge number 0.001, lattice disturbed by this seed:
                                                 # extrema of 20 time units
    unittest/bench/tension.py ball 20            # 3-D: pressure, frequency, damping at 0.05
    unittest/bench/tension.py cap 20 60          # 3-D: contact angle on a plane, from the height of the centre of mass
                                                 # and of the top
    unittest/bench/tension.py slot 20 60         # 2-D: capillary pressure between two plates, over exact
    unittest/bench/tension.py cost               # processor time of a step over that of one without the fix

rho = sigma = R = 1, Wendland's kernel, h of two spacings. Jets and contact angles in 2-D: examples/drops.
"""
import statistics
import sys

from from_tests import np
sys.path.insert(0, __file__.rsplit("/bench", 1)[0] + "/lammps/sph")
from test_sph_tension import by_id, drop, fitted, mode, run, start, steps       # noqa: E402


def pressure(lmp, c):
    """Mean within half the radius"""
    x, rho = by_id(lmp, "x", 3), by_id(lmp, "rho")
    return (c * c / 7 * (rho**7 - 1))[np.linalg.norm(x - x.mean(0), axis=1) < 0.5].mean()


def rested(across, dim=2, time=6.0, **more):
    text, dt, c = drop(across, dim, more="force yes", **more)
    lmp = start()
    run(lmp, text + f"run {int(time / dt)}")
    volume = len(by_id(lmp, "x", 3)) * (2 / across) ** dim
    R = (volume / np.pi) ** 0.5 if dim == 2 else (volume * 0.75 / np.pi) ** (1 / 3)
    return lmp, dt, c, R


def pull(lmp, c, mu, dim=2):
    flow = ["0.15*x", "-0.15*y"] if dim == 2 else ["0.15*x", "-0.075*y", "-0.075*z"]
    run(lmp, f"pair_coeff * * c {c} mu {mu}\n" + "".join(f"variable w{k} atom {v}\n" for k, v in enumerate(flow)) +
        f"velocity all set v_w0 v_w1 {'NULL' if dim == 2 else 'v_w2'} units box\nrun 0")


def ring(across, mu):
    lmp, dt, c, R = rested(int(across))
    p = pressure(lmp, c) * R
    pull(lmp, c, float(mu))
    w0, g0 = mode(float(mu), R)
    w, g = fitted(*steps(lmp, 8.0, dt).T, w0, g0)
    print(f"{across} across, Ohnesorge number {mu}: pressure {p:.3f}, frequency {w / w0:.3f}, damping {g / g0:.3f}")


def calm(across, seed):
    lmp, dt, c, R = rested(int(across), jitter=0.1, seed=int(seed))
    p = pressure(lmp, c) * R
    pull(lmp, c, 0.001)
    q = steps(lmp, 20.0, dt)[:, 1]
    q -= q.mean()
    peaks = [v for a, v, b in zip(q, q[1:], q[2:]) if v > a and v >= b and v > 0.01]
    x = by_id(lmp, "x", 3)
    print(f"{across} across, Ohnesorge number 0.001, seed {seed}: pressure {p:.3f}, maxima " +
          " ".join(f"{v:.4f}" for v in peaks) +
          f"; drops {lmp.extract_fix('t', 0, 1, 3):.0f}, centre {np.abs(x.mean(0)).max():.4f}")


def ball(across):
    lmp, dt, c, R = rested(int(across), 3, 4.0)
    p = pressure(lmp, c) * R / 2
    pull(lmp, c, 0.05, 3)
    rows = []
    for k in range(int(4.0 / dt / 20)):
        lmp.command("run 20 pre no post no")
        x = by_id(lmp, "x", 3)
        x -= x.mean(0)
        rows.append(((k + 1) * 20 * dt, (x[:, 0] ** 2 - 0.5 * (x[:, 1] ** 2 + x[:, 2] ** 2)).mean()))
    w0, g0 = (8 / R**3 - (0.25 / R**2) ** 2) ** 0.5, 0.25 / R**2
    w, g = fitted(*np.array(rows).T, w0, g0)
    print(f"3-D, {across} across, Ohnesorge number 0.05: pressure {p:.3f}, frequency {w / w0:.3f}, "
          f"damping {g / g0:.3f} (of little viscosity)")


WALLED = """
units lj
dimension {dim}
atom_style sph
boundary f f {third}
lattice {lattice} {density:.17g} origin 0.5 0.5 {middle}
region box block -2.6 2.6 {low} 3 {deep} units box
create_box 2 box
{atoms}
mass * {mass:.17g}
group water type 1
group walls type 2
set group all sph/rho 1
displace_atoms water random {jitter:.17g} {jitter:.17g} {jitter_z:.17g} 4711 units box
neighbor {dx:.17g} bin
neigh_modify delay 0 every 1
comm_modify vel yes
pair_style sph/artVisc/tensCorr wendland {h:.17g} viscosity 0.3 central shift yes
pair_coeff * * c {c}
fix eos all sph/pressure Tait {B:.17g} 1 7
fix density all sph/density/continuity delta 0.1
fix wall walls wall/adami/sph
fix move water nve/sph
{flat}
fix t water sph/tension 1 contact 2 {angle} force yes
timestep {dt:.17g}
thermo 1000000
"""
CAP = """region ball sphere 0 0 0 1 units box
region up block INF INF 0 INF INF INF units box
region cap intersect 2 ball up
region under cylinder y 0 0 {wide} {under:.17g} 0 units box
create_atoms 1 region cap
create_atoms 2 region under"""
SLOT = """region liquid block -0.5 0.5 0 1.2 INF INF units box
region out block {left:.17g} {right:.17g} {under:.17g} 2.5 INF INF units box
region hole block -0.5 0.5 0 3 INF INF side out units box
region plates intersect 2 out hole
create_atoms 1 region liquid
create_atoms 2 region plates"""


def walled(dim, dx, c, angle, atoms):
    flat = dim == 2
    return WALLED.format(dim=dim, third="p" if flat else "f", lattice="sq" if flat else "sc", density=dx**-dim,
                         middle=0 if flat else 0.5, low=-5 * dx, deep="-0.01 0.01" if flat else "-2.6 2.6", atoms=atoms,
                         mass=dx**dim, jitter=0.05 * dx, jitter_z=0 if flat else 0.05 * dx, dx=dx, h=2 * dx, c=c,
                         B=c * c / 7, angle=angle, dt=0.5 * dx / c, flat="fix flat all enforce2d" if flat else "")


def means(text, time, dt, *of):
    """Means over the last fifth of the run"""
    lmp = start()
    run(lmp, text + f"run {int(0.8 * time / dt)}")
    rows = []
    for _ in range(20):
        lmp.command(f"run {int(0.01 * time / dt)} pre no post no")
        water = by_id(lmp, "type") == 1
        rows.append([f(by_id(lmp, "x", 3)[water], by_id(lmp, "rho")[water]) for f in of])
    return np.mean(rows, 0), water.sum()


def cap(across, angle, time=7.0):
    dx, c = 2 / int(across), 20.0
    text = walled(3, dx, c, angle, CAP.format(wide=2.0 if float(angle) < 60 else 1.8, under=-4 * dx))
    (middle, top), count = means(text, time, 0.5 * dx / c, lambda x, rho: x[:, 1].mean(),
                                 lambda x, rho: x[:, 1].max() + dx / 2)
    t = np.radians(np.arange(20.0, 170.0, 0.05))
    R = (count * dx**3 / (np.pi / 3 * (2 + np.cos(t)) * (1 - np.cos(t)) ** 2)) ** (1 / 3)
    h = R * (1 - np.cos(t))
    by_centre, by_top = np.interp(middle, 0.75 * (2 * R - h) ** 2 / (3 * R - h) - R * np.cos(t),
                                  t), np.interp(top, h, t)
    print(f"3-D, {across} across, angle {angle}: by the centre {np.degrees(by_centre):.1f}, "
          f"by the top {np.degrees(by_top):.1f} degrees")


def slot(across, angle):
    dx, c = 1 / int(across), 40.0
    text = walled(2, dx, c, angle, SLOT.format(left=-0.5 - 4 * dx, right=0.5 + 4 * dx, under=-4 * dx))
    where = lambda x: (np.abs(x[:, 0]) < 0.25) & (x[:, 1] > 0.2) & (x[:, 1] < 0.5)      # noqa: E731
    (p,), _ = means(text, 6.0, 0.5 * dx / c, lambda x, rho: (c * c / 7 * (rho**7 - 1))[where(x)].mean())
    print(f"slot {across} wide, angle {angle}: capillary pressure {p / (-2 * np.cos(np.radians(float(angle)))):.3f} of "
          "exact")


def cost():
    import re
    import subprocess
    import tempfile
    for dim, across, count in ((2, 100, 60), (2, 300, 10), (3, 36, 14)):
        text, _, _ = drop(across, dim, more="force yes")
        ratios = []
        for _ in range(7):
            seconds = []
            for scene in (text, text.replace("fix t all", "# fix t all")):
                with tempfile.NamedTemporaryFile("w", suffix=".in") as f:
                    f.write("plugin load stokesdynplugin.so\n" + scene + f"run 5\nrun {count}\n")
                    f.flush()
                    out = subprocess.run(["lmp", "-in", f.name, "-log", "none", "-nocite"], capture_output=True,
                                         text=True).stdout
                loops = re.findall(r"Loop time of ([0-9.e+-]+) .* with (\d+) atoms", out)
                seconds.append(float(loops[1][0]) * float(re.findall(r"([0-9.]+)% CPU use", out)[1]))
            ratios.append(seconds[0] / seconds[1])
        print(f"{dim}-D, {loops[1][1]} particles: a step takes {statistics.median(ratios):.2f} times as long")


if __name__ == "__main__":
    {"ring": ring, "calm": calm, "ball": ball, "cap": cap, "slot": slot, "cost": cost}[sys.argv[1]](*sys.argv[2:])
