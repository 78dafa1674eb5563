"""Places of hard spheres at equilibrium (equilibrium.c, compiled when it is first asked for), and what theory says of
them."""
import ctypes
import os
import subprocess
import sys

from runs import RESULTS, TOP, np


def library():
    source, target = TOP / "examples" / "equilibrium.c", RESULTS / "equilibrium.so"
    if not target.exists() or target.stat().st_mtime < source.stat().st_mtime:
        target.parent.mkdir(parents=True, exist_ok=True)
        made = target.with_suffix(f".{os.getpid()}")
        done = subprocess.run([os.environ.get("CC", "cc"), "-O3", "-shared", "-fPIC", "-fno-math-errno", "-o", made,
                               source, "-lm"])
        if done.returncode != 0:
            sys.exit(f"{source.name}: the compiler failed")
        made.replace(target)
    found = ctypes.CDLL(str(target))
    found.equilibrium.restype = ctypes.c_long
    return found


def cells(n):
    """Edge of a cubic lattice of n places, in cells of four"""
    return int(np.ceil((n / 4)**(1 / 3) - 1e-9))


def lattice(n):
    """n places in a unit cube, of a cubic lattice whose cell has four, as far as there are; as far apart as may be"""
    m = cells(n)
    corners = np.array([(i, j, k) for i in range(m) for j in range(m) for k in range(m)], float)
    face = np.array([(0, 0, 0), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, 0.5, 0.5)])
    every = ((corners[:, None] + face).reshape(-1, 3) + 0.25) / m
    return every[np.linspace(0, len(every), n, endpoint=False).astype(int)]


def hard_spheres(n, phi, sets, seed, melt=5000, between=400):
    """`sets` sets of places [n, 3] of spheres of radius 1 and the edge of their cube, each `between` sweeps after the
    last one; the first after `melt` sweeps from a lattice. In a sweep each sphere is displaced once, by as much as half
    of the trials allow."""
    move, edge = library().equilibrium, (4 / 3 * np.pi * n / phi)**(1 / 3)
    if edge / cells(n) < 8**0.5:
        sys.exit(f"equilibrium.py: {n} spheres at a volume fraction of {phi} overlap on their lattice; "
                 "4 m^3 spheres do not")
    x, state, step = lattice(n) * edge, ctypes.c_uint64(seed * 2654435761 + 88172645463325252), 1.0

    def sweep(times):
        accepted = move(n, x.ctypes.data_as(ctypes.c_void_p), ctypes.c_double(edge), ctypes.c_long(times),
                        ctypes.c_double(step), ctypes.byref(state))
        if accepted < 0:
            sys.exit(f"equilibrium.c: {n} spheres at a volume fraction of {phi} fill a box that is too small for it")
        return accepted / (n * times)

    for _ in range(20):
        step = min(edge / 2, step * (0.5 + sweep(melt // 200)))
    sweep(melt)
    for _ in range(sets):
        sweep(between)
        yield x.copy(), edge


def write_data(path, x, edge):
    """Data file for LAMMPS, atom_style sphere: spheres of diameter 2 in a periodic cube that fix deform can shear"""
    path.write_text(f"spheres\n\n{len(x)} atoms\n1 atom types\n\n" +
                    "".join(f"0 {edge:.17g} {c}lo {c}hi\n" for c in "xyz") +
                    "0 0 0 xy xz yz\n\nAtoms\n\n" + "".join(f"{i + 1} 1 2.0 1.0 {a:.17g} {b:.17g} {c:.17g}\n"
                                                            for i, (a, b, c) in enumerate(x.tolist())))


def pressure(phi):
    """Over that of an ideal gas: Carnahan & Starling, J. Chem. Phys. 51, 635 (1969)"""
    return (1 + phi + phi**2 - phi**3) / (1 - phi)**3


def compressibility(phi):
    """S(0), the structure factor of waves without end: Carnahan & Starling"""
    return (1 - phi)**4 / ((1 + 2 * phi)**2 + phi**3 * (phi - 4))


def distances(x, edge):
    """Of all pairs, nearest images"""
    i, j = np.triu_indices(len(x), 1)
    r = x[i] - x[j]
    return np.linalg.norm(r - edge * np.rint(r / edge), axis=1)


def measured_pressure(x, edge, phi, width=0.04):
    """Over that of an ideal gas, 1 + 4 phi g(2): g between 2 and 2 + width, and the next such shell, extrapolated to
    contact"""
    r, n = distances(x, edge), len(x)
    edges = 2 + width * np.arange(4)
    g = np.histogram(r, edges)[0] / (n * (n - 1) / 2 * 4 / 3 * np.pi * np.diff(edges**3) / edge**3)
    return 1 + 4 * phi * (15 * g[0] - 10 * g[1] + 3 * g[2]) / 8
