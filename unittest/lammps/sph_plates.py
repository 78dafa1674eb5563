"""Flows of SPH between plane plates, a width of 1 apart, and past a square array of cylinders, each beside its closed
form: Poiseuille's and Couette's, two viscosities side by side, a plate that swings (Stokes's second problem), and the
drag of slow flow past cylinders (Sangani and Acrivos, Int. J. Multiphase Flow 8, 1982)."""
import numpy as np

from sph_tools import by_id, run, start

SOUND = 5.0
HEAD = """
units lj
dimension 2
atom_style sph
atom_modify map array
boundary p {across} p
lattice sq {per_area:.17g} origin 0.5 0.5 0
region all block {box} {back:.17g} {front:.17g} units box
create_box 4 all
create_atoms 1 box
{types}
mass * $(1/v_per_area)
set group all sph/rho 1
group water type 1 2
group walls type 3 4
displace_atoms water random {jitter:.17g} {jitter:.17g} 0 4711 units box
neighbor {skin:.17g} bin
neigh_modify delay 0 every 1
pair_style sph/artVisc/tensCorr {kernel} {h:.17g} viscosity {mu:.17g} {pair}
pair_coeff * * c {c}
{mus}
fix eos all sph/pressure Tait $({c}^2/7) 1 7 1
fix density all sph/density/continuity delta 0.1
fix move water nve/sph
fix flat all enforce2d
"""
PLATES = """region two block INF INF 0.5 INF INF INF units box
region low block INF INF INF 0 INF INF units box
region high block INF INF {width:.17g} INF INF INF units box
set region two type 2
set region low type 3
set region high type 4"""


class Flow:
    """n particles to a length of 1, h in spacings; pair: form of the viscosity and scheme. ratio: of the viscosity of
    the upper half of a channel to that of the lower. width: None for the array of cylinders."""

    def __init__(self, n, pair, h=2.0, kernel="wendland", mu=0.1, ratio=1.0, width=1.0, jitter=0.1, sound=SOUND):
        self.n, self.mu, self.ratio, self.width, dx = n, (mu, mu * ratio), ratio, width, 1 / n
        self.length = 12 * dx if width else 1.0
        h *= dx
        layer = (int(np.ceil(2 * h / dx)) + 0.01) * dx
        box = f"0 {self.length:.17g} {-layer:.17g} {width + layer:.17g}" if width else "-0.5 0.5 -0.5 0.5"
        radius = np.sqrt(0.1 / np.pi)
        types = (PLATES.format(width=width) if width else
                 f"region round cylinder z 0 0 {radius:.17g} INF INF units box\nset region round type 3")
        share = 18 if "central" in pair else 8
        self.dt = min(0.3 * h / sound, 0.8 * h**2 / share / max(self.mu))
        self.lmp = start(["-var", "per_area", str(n * n)])
        run(self.lmp, HEAD.format(across="f" if width else "p", per_area=n * n, box=box, back=-dx / 5, front=dx / 5,
                                  types=types, jitter=jitter * dx, skin=0.3 * dx, kernel=kernel, h=h, mu=mu, pair=pair,
                                  c=sound, mus=f"pair_coeff 2*4 2*4 c {sound} mu {mu * ratio:.17g}\n"
                                               f"pair_coeff 3 3 c {sound} mu {mu:.17g}" if ratio != 1 else ""))
        run(self.lmp, f"timestep {self.dt:.17g}")

    def go(self, time, shots=1):
        """After each of the shots: types, heights, velocities along x and forces along x of all."""
        for _ in range(shots):
            run(self.lmp, f"run {max(1, round(time / shots / self.dt))}")
            yield (by_id(self.lmp, "type"), by_id(self.lmp, "x", 3)[:, 1], by_id(self.lmp, "v", 3)[:, 0],
                   by_id(self.lmp, "f", 3)[:, 0])


def viscosity_in_poiseuille(n, pair, time=4.0, **more):
    """Over mu: exact discharge over that found, from the exact flow on."""
    flow = Flow(n, pair, **more)
    run(flow.lmp, f"fix wall walls wall/adami/sph gravity {1.6 * flow.mu[0]} 0 0\n"
                  f"fix g water gravity {1.6 * flow.mu[0]} vector 1 0 0\n"
                  "variable u atom 0.8*y*(1-y)\nvelocity water set v_u 0 NULL units box")
    found = [u[t < 3].mean() for t, y, u, F in flow.go(1.5 * time, 30)][20:]
    flow.lmp.close()
    return 0.8 / 6 / np.mean(found)


def viscosity_in_couette(n, pair, time=4.0, **more):
    """Over mu: stress on both walls over mu U, from the exact flow on."""
    flow = Flow(n, pair, **more)
    run(flow.lmp, "fix wall walls wall/adami/sph\ngroup lid type 4\nvelocity lid set 0.2 0 0 units box\n"
                  "variable u atom 0.2*y\nvelocity water set v_u 0 NULL units box")
    found = [F[t == 3].sum() - F[t == 4].sum() for t, y, u, F in flow.go(1.5 * time, 30)][20:]
    flow.lmp.close()
    return np.mean(found) / 2 / flow.length / flow.mu[0] / 0.2


def two_viscosities(n, pair, ratio, time=10.0, **more):
    """A body force along two layers, from rest: largest error of the velocity over the largest velocity."""
    flow = Flow(n, pair, ratio=ratio, **more)
    run(flow.lmp, "fix wall walls wall/adami/sph gravity 0.2 0 0\nfix g water gravity 0.2 vector 1 0 0")
    (t, y, u, F), = flow.go(time)
    flow.lmp.close()
    one, two = flow.mu
    a, b = np.linalg.solve([[0.5, -0.5], [one, two]], [0.025 / one - 0.025 / two, 0.2])
    exact = np.where(t == 1, a * y - 0.1 * y * y / one, b * (1 - y) - 0.1 * (1 - y)**2 / two)
    return np.abs(u - exact)[t < 3].max() / exact[t < 3].max()


def swinging_plate(n, pair, **more):
    """n particles to the layer sqrt(2 nu/w) = 1, six layers from plate to plate: largest error of the velocity in the
    fifth period, over that of the plate."""
    flow = Flow(n, pair, mu=1.0, width=6.0, jitter=0, **more)
    period = 2 * np.pi / 2.0
    steps = 16 * int(np.ceil(period / flow.dt / 16))
    flow.dt = period / steps
    run(flow.lmp, f"""timestep {flow.dt:.17g}
        variable x equal 0.1*sin(2*step*dt)
        variable u equal 0.2*cos(2*step*dt)
        variable o equal 0
        group low type 3
        fix go low move variable v_x v_o NULL v_u v_o NULL
        fix wall walls wall/adami/sph own_acceleration yes""")
    worst = 0.0
    for k, (t, y, u, F) in enumerate(flow.go(5 * period, 80)):
        phase = np.exp(2j * period * (k + 1) / 16)
        exact = 0.2 * (np.sinh((1 + 1j) * (6 - y)) / np.sinh((1 + 1j) * 6) * phase).real
        if k >= 64:
            worst = max(worst, np.abs(u - exact)[t < 3].max() / 0.2)
    flow.lmp.close()
    return worst


def cylinders(n, pair, time=0.9, **more):
    """Drag per length over mu U, of a tenth of the area, over that of Sangani and Acrivos: from the discharge."""
    def drag(phi):
        return 4 * np.pi / (-0.5 * np.log(phi) - 0.738 + phi - 0.887 * phi**2 + 2.038 * phi**3)
    flow = Flow(n, pair, mu=1.0, width=None, jitter=0, sound=10.0, **more)
    G = 0.28 * drag(0.1)
    run(flow.lmp, f"fix wall walls wall/adami/sph gravity {G:.17g} 0 0\nfix g water gravity {G:.17g} vector 1 0 0\n"
                  "velocity water set 0.28 0 0 units box")
    found = [u[t == 1].sum() / n**2 for t, y, u, F in flow.go(time, 40)][30:]
    phi = (by_id(flow.lmp, "type") == 3).sum() / n**2
    flow.lmp.close()
    return G / np.mean(found) / drag(phi)
