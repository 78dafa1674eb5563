"""Flows with a known solution, in two dimensions: Gresho's vortex, Taylor-Green, Poiseuille, a still tank, a dam break,
a gravity wave, a free disk, a rotating square, two layers, Rayleigh-Taylor. Each makes the particles, runs them with
lmp and returns the figures of its last moment. An option of the pair style or of the density is a keyword of the
function `flow`:

    kernel wendland | cubicspline, hdx, pair "shift yes" ..., density "delta 0.1" ..., alpha (of artVisc), n (particles
    per unit length)
"""
import os
import re
import resource
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from sph_runs import dump, np  # noqa: E402


def lattice(x, y):
    X, Y = np.meshgrid(x, y)
    return np.stack([X.ravel(), Y.ravel()], axis=1)


def write_data(path, x, v, rho, mass, types, lo, hi):
    """LAMMPS data file for atom_style sph; mass: of each type."""
    d3 = x.shape[1] == 3
    with open(path, "w") as f:
        f.write("# SPH particles\n\n%d atoms\n%d atom types\n\n" % (len(x), len(mass)))
        for k, axis in enumerate("xyz"):
            bounds = (lo[k], hi[k]) if k < 2 or d3 else (-0.5, 0.5)
            f.write("%.17g %.17g %slo %shi\n" % (*bounds, axis, axis))
        f.write("\nMasses\n\n" + "".join("%d %.17g\n" % (k + 1, m) for k, m in enumerate(mass)) + "\nAtoms\n\n")
        for i in range(len(x)):
            f.write("%d %d %.17g 0 1 %.17g %.17g %.17g\n" % (i + 1, types[i], rho[i], x[i][0], x[i][1],
                                                             x[i][2] if d3 else 0.0))
        f.write("\nVelocities\n\n")
        for i in range(len(x)):
            f.write("%d %.17g %.17g %.17g\n" % (i + 1, v[i][0], v[i][1], v[i][2] if d3 else 0.0))


def tait(P, c, rho0=1.0):
    """Density that has the pressure P (exponent 7, background left out)."""
    return rho0 * (1 + 7 * P / (rho0 * c**2)) ** (1 / 7)


class BlownUp(RuntimeError):
    """A run whose water flew apart, which some schemes do: what LAMMPS said of it. Whatever else ends a run is no
    figure but a mistake."""


FLEW_APART = re.compile("Lost atoms|has the density|the lowest of fix|moved more than half the neighbour skin|"
                        "Non-numeric|not a finite number|\\bnan\\b")


INPUT = """
plugin load stokesdynplugin.so
units lj
dimension {dim}
boundary {boundary}
atom_style sph
newton on
read_data data.flow
group fluid type {fluid}
neighbor {skin} bin
neigh_modify delay 0 every 1
pair_style sph/artVisc/tensCorr {kernel} {h} {pair}
{coeff}
{eos}
fix density all sph/density/continuity {density}
{extra}
fix move fluid nve/sph
timestep {dt}
thermo {every}
thermo_style custom step cpu
thermo_modify lost {lost}
dump d all custom {every} dump.flow id type x y z vx vy vz f_p
dump_modify d format float %.15g sort id
run {steps}
"""


def run(s, T, dt, shots=2):
    """Runs the scene s (dictionary) to the time T; returns the snapshots (arrays by column), the processor's
    seconds, the time between snapshots."""
    steps = max(1, int(np.ceil(T / dt / shots))) * shots
    dt, every = T / steps, steps // shots
    s = dict(dict(dim=2, boundary="p p p", pair="", density="", extra="", fluid="1",
                  coeff="pair_coeff * * c %g" % s["c"], rough=None, lost="error"), **s)
    if "eos" not in s:
        s["eos"] = "fix p all sph/pressure Tait %.17g 1 7 %.17g" % (s["c"] ** 2 / 7, s.get("P0", 0.0))
    with tempfile.TemporaryDirectory() as folder:
        write_data(os.path.join(folder, "data.flow"), s["x"], s["v"], s["rho"], s["mass"], s["types"], s["lo"], s["hi"])
        with open(os.path.join(folder, "in.flow"), "w") as f:
            f.write(INPUT.format(dt=repr(float(dt)), every=every, steps=steps, skin=0.25 * s["dx"],
                                 **{k: s[k] for k in (
                "dim", "boundary", "fluid", "kernel", "h", "pair", "coeff", "eos", "density", "extra", "lost")}))
        begin = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = subprocess.run(["lmp", "-in", "in.flow", "-log", "none", "-nocite"], cwd=folder, capture_output=True,
                              text=True)
        if done.returncode:
            said = next((line for line in done.stdout.splitlines() if line.startswith("ERROR")),
                        done.stdout[-600:] + done.stderr[-600:])
            raise (BlownUp if FLEW_APART.search(said) else RuntimeError)(said)
        seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - begin
        return dump(os.path.join(folder, "dump.flow")), seconds, dt * every


def options(o, dx):
    h, pair = o.get("hdx", 2.0) * dx, o.get("pair", "")
    if "alpha" in o:
        pair += " artVisc %.17g 0 %.17g" % (o["alpha"], 0.01 * h * h)
    return dict(kernel=o.get("kernel", "wendland"), h=h, dx=dx, pair=pair, density=o.get("density", ""))


def gresho(n, **o):
    """Triangular vortex (Gresho & Chan 1990), no viscosity, t = 1, c = 10, from a lattice jittered by `rough`: mean of
    the error of the velocity around, within r < 0.5."""
    def speed(r):
        return np.where(r < 0.2, 5 * r, np.where(r < 0.4, 2 - 5 * r, 0))

    def pressure(r):
        middle = 9 + 12.5 * r**2 - 20 * r + 4 * np.log(np.maximum(r, 1e-9) / 0.2)
        return np.where(r < 0.2, 5 + 12.5 * r**2, np.where(r < 0.4, middle, 3 + 4 * np.log(2))) - 5
    dx, c = 1 / n, 10.0
    x = lattice(*[(np.arange(n) + 0.5) * dx] * 2)
    x += np.random.default_rng(3).uniform(-1, 1, x.shape) * o.get("rough", 0.0) * dx
    d = x - 0.5
    r = np.maximum(np.hypot(*d.T), 1e-12)
    v = np.stack([-d[:, 1], d[:, 0]], axis=1) * (speed(r) / r)[:, None]
    s = dict(options(o, dx), x=x, v=v, rho=tait(pressure(r), c), mass=[dx * dx], types=np.ones(n * n, int), lo=(0, 0),
             hi=(1, 1), c=c, P0=o.get("background", 0.0))
    shots, seconds, _ = run(s, 1.0, 0.25 * s["h"] / c, 1)
    e = shots[-1]
    q = np.stack([e["x"], e["y"]], axis=1) % 1 - 0.5
    r1 = np.maximum(np.hypot(*q.T), 1e-12)
    w = (e["vy"] * q[:, 0] - e["vx"] * q[:, 1]) / r1
    return {"L1": np.abs(w - speed(r1))[r1 < 0.5].mean(), "seconds": seconds}


def taylor_green(n, **o):
    """Vortices at Re = 100 in a unit box, from a jittered lattice: error of the amplitude at t = 1, rms error of the
    velocity."""
    dx, c, nu = 1 / n, 10.0, 0.01
    random = np.random.default_rng(5)
    x = (lattice(*[(np.arange(n) + 0.5) * dx] * 2) + random.uniform(-0.1, 0.1, (2, n * n)).T * dx) % 1

    def U(x):
        X, Y = 2 * np.pi * x.T
        return np.stack([-np.cos(X) * np.sin(Y), np.sin(X) * np.cos(Y)], axis=1)
    # starts with the pressure of the incompressible flow: a uniform one would make sound of 3 % of the velocity
    P = -0.25 * (np.cos(4 * np.pi * x[:, 0]) + np.cos(4 * np.pi * x[:, 1]))
    s = dict(options(o, dx), x=x, v=U(x), rho=tait(P, c), mass=[dx * dx], types=np.ones(n * n, int), lo=(0, 0),
             hi=(1, 1), c=c, P0=1.0)
    s["pair"] += " viscosity %g" % nu
    shots, seconds, _ = run(s, 1.0, 0.25 * min(s["h"] / c, s["h"] ** 2 / (8 * nu)), 1)
    e = shots[-1]
    v, u, decay = np.stack([e["vx"], e["vy"]],
                           axis=1), U(np.stack([e["x"], e["y"]], axis=1)), np.exp(-8 * np.pi**2 * nu)
    return {"amplitude": (v * u).sum() / (u * u).sum() / decay - 1,
            "rms": np.sqrt(((v - u * decay) ** 2).sum() / (u * u).sum()) / decay,
            "seconds": seconds}


def poiseuille(n, **o):
    """Start of a channel flow between walls of particles: largest error of the velocity at t = 2 over the final speed
    1."""
    nu, g, dx, c = 0.1, 0.8, 1 / n, 10.0
    hdx = o.get("hdx", 2.0)
    layers, w = int(np.ceil(2 * hdx)), max(10, int(np.ceil(4 * hdx + 2)))
    x = lattice((np.arange(w) + 0.5) * dx, (np.arange(-layers, n + layers) + 0.5) * dx)
    fluid = (x[:, 1] > 0) & (x[:, 1] < 1)
    s = dict(options(o, dx), x=x, v=0 * x, rho=np.ones(len(x)), mass=[dx * dx] * 2, types=np.where(fluid, 1, 2),
             lo=(0, -(layers + 1) * dx), hi=(w * dx, 1 + (layers + 1) * dx), c=c, P0=1.0, boundary="p f p",
             extra="group wall type 2\nfix w wall wall/adami/sph\nfix g fluid addforce %.17g 0 0" % (g * dx * dx))
    s["pair"] += " viscosity %g" % nu
    shots, seconds, t = run(s, 2.0, 0.25 * min(s["h"] / c, s["h"] ** 2 / (8 * nu)), 1)
    e = shots[-1]
    y, m = e["y"][fluid], np.arange(1, 400, 2)[:, None]
    exact = g / (2 * nu) * y * (1 - y) - (4 * g / (nu * np.pi**3 * m**3) * np.sin(np.pi * y * m) *
                                          np.exp(-m * m * np.pi**2 * nu * 2.0)).sum(0)
    return {"error": np.abs(e["vx"][fluid] - exact).max(), "seconds": seconds}


# --- free surfaces ----------------------------------------------------------------------------------------------------


def basin(n, wide, high, top, hdx, dim=2):
    """Lattice of a tank, walls of particles up to row `top`; which are fluid when it is filled to `high` rows."""
    dx, layers = 1 / n, int(np.ceil(2 * hdx))
    across = (np.arange(-layers, wide + layers) + 0.5) * dx
    up = (np.arange(-layers, top) + 0.5) * dx
    if dim == 2:
        x = lattice(across, up)
    else:
        x = np.stack([a.ravel() for a in np.meshgrid(across, up, across, indexing="ij")], axis=1)
    side = [k for k in range(dim) if k != 1]
    inside = (x[:, 1] > 0) & np.all([(x[:, k] > 0) & (x[:, k] < wide * dx) for k in side], axis=0)
    fluid = inside & (x[:, 1] < high * dx)
    keep = fluid | ~inside
    return dx, x[keep], fluid[keep], layers


def hydrostatic(y, H, c, g=1.0, rho0=1.0):
    """Where a row of a uniform lattice comes to lie under its own weight, and its density."""
    a = 7 * g / c**2
    rho = rho0 * (1 + a * np.maximum(H - y, 0)) ** (1 / 7)
    return 7 / (6 * a) * ((1 + a * H) ** (6 / 7) - (1 + a * np.maximum(H - y, 0)) ** (6 / 7)), rho


def walled(o, dx, x, fluid, rho, c, layers, dim=2, slip="yes", g=1.0):
    m = dx**dim
    lo, hi = x.min(0) - dx, x.max(0) + dx
    hi[1] += 2.0    # spray stays in the box
    weight = "fix g fluid addforce 0 %.17g 0\n" % (-m * g)
    return dict(options(o, dx), dim=dim, x=x, v=0 * x, rho=rho, mass=[m, m], types=np.where(fluid, 1, 2), lo=lo, hi=hi,
                c=c, boundary="f f p" if dim == 2 else "f f f",
                extra=weight + "group wall type 2\nfix w wall wall/adami/sph gravity 0 %.17g 0 slip %s" % (-g, slip))


def tank(n, **o):
    """Still water, 2 x 1 (3-D: 1 x 1 x 1), from a jittered hydrostatic lattice, `steps`: largest speed over sqrt(g H)
    at the end."""
    dim, c = int(o.get("dim", 2)), 10.0
    dx, x, fluid, layers = basin(n, 2 * n if dim == 2 else n, n, n + int(np.ceil(2 * o.get("hdx", 2.0))),
                                 o.get("hdx", 2.0), dim)
    y, rho = hydrostatic(x[:, 1], 1.0, c)
    rho = np.where(fluid, rho, 1.0)
    x[fluid, 1] = y[fluid]
    x[fluid] += np.random.default_rng(7).uniform(-1, 1, (fluid.sum(), dim)) * o.get("rough", 0.1) * dx
    s = walled(o, dx, x, fluid, rho, c, layers, dim)
    dt = 0.25 * s["h"] / c
    shots, seconds, _ = run(s, int(o.get("steps", 10000)) * dt, dt, 4)
    speeds = [np.sqrt(e["vx"] ** 2 + e["vy"] ** 2 + e["vz"] ** 2)[fluid].max() for e in shots]
    return {"speed": speeds[-1], "speed/2": speeds[2], "outside": ((shots[-1]["y"][fluid] < 0)).sum(),
            "seconds": seconds}


def dam_break(n, **o):
    """Column 2 x 1 in a tank of length 4, slip, to t = 6 sqrt(H/g): front at 1.5, energy over that of the start,
    particles in walls, and those that went through the walls and out of the box: of the plain scheme only, from the
    impact on, counted and left out."""
    c = 20.0
    dx, x, fluid, layers = basin(n, 4 * n, n, 3 * n, o.get("hdx", 2.0))
    keep = ~fluid | (x[:, 0] < 2)
    x, fluid = x[keep], fluid[keep]
    y, rho = hydrostatic(x[:, 1], 1.0, c)
    rho = np.where(fluid, rho, 1.0)
    x[fluid, 1] = y[fluid]
    s = dict(walled(o, dx, x, fluid, rho, c, layers), lost="warn")
    shots, seconds, every = run(s, 6.0, 0.25 * s["h"] / c, 60)
    shots = [{name: column[e["type"] == 1] for name, column in e.items()} for e in shots]

    def energy(e):
        rho = (1 + 7 * e["f_p"] / c**2) ** (1 / 7)
        inner = c**2 / 7 * (rho**6 / 6 + 1 / rho - 7 / 6)
        return (0.5 * (e["vx"] ** 2 + e["vy"] ** 2) + e["y"] + inner).sum()
    E = np.array([energy(e) for e in shots])
    end = shots[-1]
    X, Y = end["x"], end["y"]
    return {"front": shots[int(round(1.5 / every))]["x"].max() + dx / 2, "energy": E.max() / E[0] - 1,
            "energy end": E[-1] / E[0] - 1, "in walls": ((Y < 0) | (X < 0) | (X > 4)).sum(),
            "lost": fluid.sum() - len(X), "seconds": seconds}


def wave(n, **o):
    """Standing gravity wave, length 1, depth 1/2, kinematic viscosity 0.004: frequency and decay over those without and
    with leading order of viscosity, sqrt(g k tanh k H) and 2 nu k^2; "exact": decay over that of linear theory, free
    slip at the bottom."""
    g, H, A, rho0, mu = 9.81, 0.5, 0.02, 1.0, 0.004
    k = 2 * np.pi
    om = np.sqrt(g * k * np.tanh(k * H))
    dx, c = 1 / n, 10 * np.sqrt(g * H)
    layers = int(np.ceil(2 * o.get("hdx", 2.0))) + 1
    x = lattice((np.arange(n) + 0.5) * dx, (np.arange(-layers, n // 2) + 0.5) * dx)
    fluid = x[:, 1] > 0
    Y = np.maximum(x[:, 1], 0)
    v = np.stack([-A * om * np.cosh(k * Y) / np.sinh(k * H) * np.sin(k * x[:, 0]),
                  A * om * np.sinh(k * Y) / np.sinh(k * H) * np.cos(k * x[:, 0])], axis=1) * fluid[:, None]
    y, rho = hydrostatic(x[:, 1], H, c, g)
    x[fluid, 1] = y[fluid]
    s = walled(o, dx, x, fluid, np.where(fluid, rho, rho0), c, layers, g=g)
    s.update(v=v, boundary="p f p", lo=(0, x[:, 1].min() - dx), hi=(1, 2))
    s["pair"] += " viscosity %g %s" % (mu, o.get("viscosity", "laplacian"))
    T = 2 * np.pi / om
    shots, seconds, every = run(s, 4 * T, 0.25 * s["h"] / c, 320)
    v0 = v[fluid]
    a = np.array([(np.stack([e["vx"], e["vy"]], axis=1)[fluid] * v0).sum() for e in shots[1:]]) / (v0**2).sum()
    leading = 2 * mu * k * k
    found = oscillation(a, every * (1 + np.arange(len(a))), om, leading)
    return dict(found, exact=found["decay"] * leading / viscous_decay(k, H, mu, g), seconds=seconds)


def viscous_decay(k, H, nu, g):
    """Decay s of the wave exp(-s t) over a bottom with free slip, linear theory (Lamb, Hydrodynamics, art. 349, for
    finite depth): with m^2 = k^2 - s/nu,  (2 nu k^2 - s)^2 + g k tanh kH = 4 nu^2 k^3 m tanh kH / tanh mH."""
    s = 2 * nu * k * k - 1j * np.sqrt(g * k * np.tanh(k * H))
    for _ in range(50):
        m = np.sqrt(k * k - s / nu)
        s = 2 * nu * k * k - 1j * np.sqrt(g * k * np.tanh(k * H) - 4 * nu**2 * k**3 * m * np.tanh(k * H) /
                                          np.tanh(m * H))
    return s.real


def oscillation(a, t, om, decay):
    """Frequency from the zeros of the amplitude a(t), decay from its peaks, both over what they should be."""
    z = np.nonzero(a[:-1] * a[1:] < 0)[0]
    zeros = t[z] - a[z] * (t[z + 1] - t[z]) / (a[z + 1] - a[z])
    peaks = [i for i in range(3, len(a) - 3) if abs(a[i]) == np.abs(a[i - 3:i + 4]).max()]
    rate = -np.polyfit(t[peaks], np.log(np.abs(a[peaks])), 1)[0]
    return {"frequency": np.pi * (len(zeros) - 1) / (zeros[-1] - zeros[0]) / om, "decay": rate / decay if decay
            else rate}


def disk(n, **o):
    """Free disk of radius 1/2 in solid rotation, mu 0.01, to t = 0.5: angular momentum left."""
    dx, c = 1 / n, 10.0
    x = lattice(*[(np.arange(-n, n) + 0.5) * dx] * 2)
    x = x[np.hypot(*x.T) < 0.5]
    v = np.stack([-x[:, 1], x[:, 0]], axis=1)
    s = dict(options(o, dx), x=x, v=v, rho=tait(0.5 * ((x**2).sum(1) - 0.25), c), mass=[dx * dx],
             types=np.ones(len(x), int), lo=(-2, -2), hi=(2, 2), c=c, boundary="f f p")
    s["pair"] += " viscosity 0.01 " + o.get("viscosity", "laplacian")
    shots, seconds, _ = run(s, 0.5, 0.25 * s["h"] / c, 1)
    L = [(e["x"] * e["vy"] - e["y"] * e["vx"]).sum() for e in (shots[0], shots[-1])]
    return {"angular momentum - 1": L[1] / L[0] - 1, "seconds": seconds}


def square(n, **o):
    """Rotating square patch, no viscosity, to t = 2: kinetic energy and angular momentum left."""
    dx, c = 1 / n, 7.0
    x = lattice(*[(np.arange(n) + 0.5) * dx - 0.5] * 2)
    v = np.stack([x[:, 1], -x[:, 0]], axis=1)
    s = dict(options(o, dx), x=x, v=v, rho=np.ones(n * n), mass=[dx * dx], types=np.ones(n * n, int), lo=(-3, -3),
             hi=(3, 3), c=c, boundary="f f p")
    shots, seconds, _ = run(s, 2.0, 0.25 * s["h"] / c, 1)
    a, b = shots[0], shots[-1]
    return {"energy": (b["vx"] ** 2 + b["vy"] ** 2).sum() / (a["vx"] ** 2 + a["vy"] ** 2).sum(),
            "angular momentum - 1": (b["x"] * b["vy"] - b["y"] * b["vx"]).sum() /
            (a["x"] * a["vy"] - a["y"] * a["vx"]).sum() - 1, "seconds": seconds}


def sloshing(n, **o):
    """A tank 1 long, filled to 1/2, moves by X (1 - cos W t) from rest, W 0.7 of its first frequency, three periods:
    largest difference of the centre of the water (relative to the tank) from linear theory over the largest excursion.
    Modes k = j pi, j odd: eta'' + w^2 eta = - k tanh(k/2) a X W^2 cos W t, w^2 = g k tanh(k/2), a = -4/k^2; the centre
    is the sum of eta a."""
    c, X, H = 10.0, 0.01, 0.5
    w1 = np.sqrt(np.pi * np.tanh(np.pi * H))
    W = 0.7 * w1
    dx, x, fluid, layers = basin(n, n, n // 2, n, o.get("hdx", 2.0))
    y, rho = hydrostatic(x[:, 1], H, c)
    x[fluid, 1] = y[fluid]
    s = walled(o, dx, x, fluid, np.where(fluid, rho, 1.0), c, layers)
    s["lo"], s["hi"] = s["lo"] - 0.1, s["hi"] + 0.1
    s["extra"] = """variable w equal {W:.17g}
    variable x equal {X:.17g}*(1-cos(v_w*time))
    variable v equal {X:.17g}*v_w*sin(v_w*time)
    variable b equal -{X:.17g}*v_w^2*cos(v_w*time)
    fix g fluid addforce 0 {weight:.17g} 0
    group wall type 2
    variable none equal 0
    fix push wall move variable v_x v_none NULL v_v v_none NULL
    fix w wall wall/adami/sph gravity v_b -1 0 slip yes""".format(W=float(W), X=X, weight=-dx * dx)
    shots, seconds, every = run(s, 3 * 2 * np.pi / w1, 0.25 * s["h"] / c, 120)
    t = every * np.arange(len(shots))
    centre = np.array([e["x"][fluid].mean() for e in shots]) - X * (1 - np.cos(W * t)) - 0.5
    exact = 0 * t
    for j in range(1, 20, 2):
        k = j * np.pi
        w2, a = k * np.tanh(k * H), -4 / k**2
        exact += (a / (2 * H) * -k * np.tanh(k * H) * a * X * W**2 / (w2 - W**2) *
                  (np.cos(W * t) - np.cos(np.sqrt(w2) * t)))
    return {"error": np.abs(centre - exact).max() / np.abs(exact).max(), "seconds": seconds}


def rigidity(hdx):
    """G / P of a square lattice with Wendland's kernel for a shear along its diagonals. F = - sum V_a V_b (P_a + P_b)
    grad W and the rate
    - rho tr(L M), M = - sum V d grad W, take the energy P V tr(L M) from a strain rate L. At the strain e, stretched
    along x and pressed along y, M_xx - M_yy = 2 m e, and tr(L M) = 2 m e de/dt: the energy - P V m e^2 is that of a
    solid with G = - P m / 2."""
    def difference(e):
        x, y = lattice(*[np.arange(-12, 13)] * 2).T * np.array([[1 + e], [1 / (1 + e)]])
        gradient = 35 / (4 * np.pi) / hdx**4 * np.maximum(1 - np.hypot(x, y) / (2 * hdx), 0) ** 3    # - W' / r
        return (gradient * (x * x - y * y)).sum()
    return (difference(-1e-4) - difference(1e-4)) / 8e-4


def shear_wave(n, **o):
    """A lattice without viscosity under the uniform pressure 50 in a unit box. A fluid would glide; frequency and decay
    of its standing shear wave along the diagonal, over those of a solid, omega^2 = G k^2 / rho."""
    dx, c, P0, k = 1 / n, 10.0, 50.0, np.sqrt(8) * np.pi
    x = lattice(*[(np.arange(n) + 0.5) * dx] * 2)
    v = 1e-3 * np.cos(2 * np.pi * x.sum(1))[:, None] * np.array([1, -1])
    s = dict(options(o, dx), x=x, v=v, rho=np.ones(n * n), mass=[dx * dx], types=np.ones(n * n, int), lo=(0, 0),
             hi=(1, 1), c=c, P0=P0)
    om = k * np.sqrt(P0 * rigidity(o.get("hdx", 2.0)))
    shots, seconds, every = run(s, 3 * np.pi / om, 0.25 * s["h"] / c, 150)
    a = np.array([(np.stack([e["vx"], e["vy"]], axis=1) * v).sum() for e in shots[1:]]) / (v**2).sum()
    return dict(oscillation(a, every * (1 + np.arange(len(a))), om, 0.0), seconds=seconds)


# --- two fluids -------------------------------------------------------------------------------------------------------


def layers_scene(n, ratio, o, lid=False, high=1.0):
    """A heavy fluid, depth 1/2, under a light one; wide 1 and periodic, hydrostatic. Types: heavy, light, their
    walls."""
    g, c, dx = 1.0, 10.0, 1 / n
    wall = int(np.ceil(2 * o.get("hdx", 2.0)))
    x = lattice((np.arange(n) + 0.5) * dx, (np.arange(-wall, n + (wall if lid else 0)) + 0.5) * dx)
    light = x[:, 1] > 0.5
    fluid = (x[:, 1] > 0) & (x[:, 1] < 1)
    rho0 = np.where(light, 1.0, ratio)
    P = np.where(light, 1 - x[:, 1], 0.5 + ratio * (0.5 - x[:, 1])) * g
    rho = np.where(fluid, tait(P, c, rho0), rho0)
    rows = (np.arange(n) + 0.5) * dx
    of_row = np.where(rows > 0.5, 1.0, ratio)
    thick = dx * of_row / tait(np.where(rows > 0.5, 1 - rows, 0.5 + ratio * (0.5 - rows)) * g, c, of_row)
    centre = np.cumsum(thick) - thick / 2
    row = np.clip((x[:, 1] / dx).astype(int), 0, n - 1)
    x[:, 1] = np.where(fluid, centre[row], np.where(x[:, 1] > 1, x[:, 1] - 1 + thick.sum(), x[:, 1]))
    x[fluid] += o.get("rough", 0.0) * dx * np.random.default_rng(1).uniform(-1, 1, (fluid.sum(), 2))
    m = [ratio * dx * dx, dx * dx]
    s = dict(options(o, dx), x=x, v=0 * x, rho=rho, mass=m * 2, types=1 + light + 2 * ~fluid,
             lo=(0, x[:, 1].min() - dx), hi=(1, 2), c=c, boundary="p f p", fluid="1 2",
             eos="group heavy type 1 3\ngroup light type 2 4\nfix p heavy sph/pressure Tait %.17g %.17g 7\n"
                 "fix q light sph/pressure Tait %.17g 1 7" % (ratio * c * c / 7, ratio, c * c / 7),
             extra="fix g1 fluid addforce 0 v_weight 0\ngroup wall type 3 4\n"
                   "fix w wall wall/adami/sph gravity 0 -1 0 slip yes")
    s["extra"] = "variable weight atom -mass*1.0\n" + s["extra"]
    s["density"] += " volume yes"
    if s["pair"]:
        s["coeff"] = "pair_coeff * * c %g deltap %.17g" % (c, dx)
    return s, fluid, light


def two_layers(n, **o):
    """Two layers at rest, free surface, `steps`: largest speed over sqrt(g H), slope of the pressure over rho g, light
    and heavy, without the rows within 1.5 spacings of the interface: to the heavy fluid it is a free surface, and the
    last rows of the plain force below one have 3/4 to 0.87 of the slope, whatever the resolution."""
    ratio = o.get("ratio", 10.0)
    s, fluid, light = layers_scene(n, ratio, o)
    dt = 0.25 * s["h"] / s["c"]
    shots, seconds, _ = run(s, int(o.get("steps", 10000)) * dt, dt, 4)
    e, c = shots[-1], s["c"]
    speed = np.hypot(e["vx"], e["vy"])[fluid].max()
    between = (e["y"][light & fluid].min() + e["y"][~light & fluid].max()) / 2
    inside = fluid & (np.abs(e["y"] - between) > 1.5 / n)
    slope = []
    for who, rho0 in ((light & inside, 1.0), (~light & inside, ratio)):
        slope.append(-np.polyfit(e["y"][who], e["f_p"][who], 1)[0] / rho0)
    return {"speed": speed, "slope light": slope[0], "slope heavy": slope[1], "seconds": seconds}


def interface(n, **o):
    """Standing wave on the interface of two layers below a lid: frequency over linear theory,
    omega^2 = g k (rho_1 - rho_2) / (rho_1 coth k h_1 + rho_2 coth k h_2)."""
    ratio, A, k = o.get("ratio", 2.0), 0.01, 2 * np.pi
    s, fluid, light = layers_scene(n, ratio, o, lid=True)
    coth = 1 / np.tanh(0.5 * k)
    om = np.sqrt(k * (ratio - 1) / (ratio * coth + coth))
    depth = np.where(light, 1 - s["x"][:, 1], s["x"][:, 1])    # from the wall
    depth = np.clip(depth, 0, 0.5)
    sign = np.where(light, 1.0, -1.0)
    X = s["x"][:, 0]
    v = A * om / np.sinh(0.5 * k) * np.stack([sign * np.cosh(k * depth) * np.sin(k * X),
                                              np.sinh(k * depth) * np.cos(k * X)], axis=1)
    s["v"] = v * fluid[:, None]
    shots, seconds, every = run(s, 3 * 2 * np.pi / om, 0.25 * s["h"] / s["c"], 240)
    v0 = s["v"][fluid]
    w = np.where(light, 1.0, ratio)[fluid][:, None]
    a = np.array([(w * np.stack([e["vx"], e["vy"]], axis=1)[fluid] * v0).sum() for e in shots[1:]]) / (w * v0**2).sum()
    return dict(oscillation(a, every * (1 + np.arange(len(a))), om, 0.0), seconds=seconds)


def rayleigh_taylor(n, **o):
    """A heavy fluid over a light one in a closed box, periodic in x: one wave of the interface grows from a thousandth
    of its length. Rate over linear theory, s^2 = g k (rho_1 - rho_2) / (rho_1 coth k h_1 + rho_2 coth k h_2): slope of
    ln a over the last three quarters, a the velocity's projection on the mode. light: speed of sound of the light fluid
    over that of the heavy one."""
    ratio, amplitude, k, c, dx = o.get("ratio", 3.0), 0.001, 2 * np.pi, 10.0, 1 / n
    layers = int(np.ceil(2 * o.get("hdx", 2.0)))
    x = lattice((np.arange(n) + 0.5) * dx, (np.arange(-layers, n + layers) + 0.5) * dx)
    heavy, fluid = x[:, 1] > 0.5, (x[:, 1] > 0) & (x[:, 1] < 1)
    rho0 = np.where(heavy, ratio, 1.0)
    pressure = lambda y: np.where(y > 0.5, ratio * (1 - y), 0.5 * ratio + 0.5 - y)    # g = 1
    sound = o.get("light", 1.0) * c
    rho = np.where(fluid, tait(np.clip(pressure(x[:, 1]), 0, None), np.where(heavy, c, sound), rho0), rho0)
    rows = (np.arange(n) + 0.5) * dx
    of_row = np.where(rows > 0.5, ratio, 1.0)
    thick = dx * of_row / tait(pressure(rows), np.where(rows > 0.5, c, sound), of_row)
    row = np.clip((x[:, 1] / dx).astype(int), 0, n - 1)
    x[:, 1] = np.where(fluid, (np.cumsum(thick) - thick / 2)[row],
                       np.where(x[:, 1] > 1, x[:, 1] - 1 + thick.sum(), x[:, 1]))
    high, below = thick.sum(), thick[:n // 2].sum()
    rate = np.sqrt(k * (ratio - 1) / (ratio / np.tanh(k * (high - below)) + 1 / np.tanh(k * below)))
    wall = np.where(heavy, high - x[:, 1], x[:, 1])    # distance from it
    depth = np.where(heavy, high - below, below)
    mode = np.stack([np.where(heavy, 1, -1) * np.cosh(k * wall) * np.sin(k * x[:, 0]),
                     np.sinh(k * wall) * np.cos(k * x[:, 0])], axis=1)
    mode *= (fluid / np.sinh(k * depth))[:, None]
    x = x + amplitude * mode
    m = [dx * dx, ratio * dx * dx]
    s = dict(options(o, dx), x=x, v=amplitude * rate * mode, rho=rho, mass=m * 2, types=1 + heavy + 2 * ~fluid, c=c,
             boundary="p f p", lo=(0, x[:, 1].min() - dx), hi=(1, x[:, 1].max() + dx), fluid="1 2",
             eos="group light type 1 3\ngroup heavy type 2 4\nfix q light sph/pressure Tait %.17g 1 7\n"
                 "fix p heavy sph/pressure Tait %.17g %.17g 7" % (sound * sound / 7, ratio * c * c / 7, ratio),
             extra="variable weight atom -mass*1.0\nfix g1 fluid addforce 0 v_weight 0\ngroup wall type 3 4\n"
                   "fix w wall wall/adami/sph gravity 0 -1 0 slip yes")
    if s["pair"]:
        s["coeff"] = "pair_coeff * * c %g deltap %.17g" % (c, dx)
        if sound != c:
            s["coeff"] += "".join("\npair_coeff %s c %g" % (pair, sound) for pair in ("1 1", "1 3", "3 3"))
    s["density"] += " volume yes"
    shots, seconds, every = run(s, o.get("time", 2.0) / rate, 0.25 * s["h"] / max(c, sound), 40)
    weight = rho0[fluid][:, None]
    a = np.array([(weight * np.stack([e["vx"], e["vy"]], axis=1)[fluid] * mode[fluid]).sum() for e in shots[11:]])
    return {"rate": np.polyfit(every * np.arange(len(a)), np.log(np.maximum(a, 1e-300)), 1)[0] / rate,
            "seconds": seconds}


if __name__ == "__main__":
    name, n = sys.argv[1], [int(k) for k in sys.argv[2].split(",")]
    words = dict(word.split("=", 1) for word in sys.argv[3:])
    o = {k: v if k in ("kernel", "pair", "density", "viscosity") else float(v) for k, v in words.items()}
    for k in n:
        got = globals()[name](k, **o)
        print(name, k, o, {key: float("%.4g" % value) for key, value in got.items()}, flush=True)
