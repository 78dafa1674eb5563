"""Closed surfaces of triangles, numpy alone: STL files and simple shapes, whether they are closed, what they hold, who
is inside.

shapes/fill.py makes clumps of spheres of them, ship/particles.py walls, bodies and water for SPH."""
import pathlib
import struct

import other_python

other_python.unless("numpy")
import numpy as np    # noqa: E402


class Error(Exception):
    """What is wrong with a shape, for whoever gave it."""


# --- surfaces of triangles --------------------------------------------------------------------------------------------

def read_stl(path, scale=1.0):
    """[n, 3, 3] corners of the triangles of an STL file"""
    try:
        data = pathlib.Path(path).read_bytes()
    except OSError as why:
        raise Error(f"{path}: {why.strerror}") from None
    count = struct.unpack("<I", data[80:84])[0] if len(data) >= 84 else 0
    if len(data) == 84 + 50 * count and count:
        rows = np.frombuffer(data, np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")]), count,
                             84)
        return scale * rows["corners"].astype(float)
    words = data.decode("ascii", "replace").split()
    try:
        corners = [[float(word) for word in words[k + 1:k + 4]] for k, word in enumerate(words) if word == "vertex"]
        triangles = scale * np.array(corners).reshape(-1, 3, 3)
    except ValueError:
        raise Error(f"{path}: neither a binary STL file (84 + 50 n bytes) nor an ASCII one with three numbers "
                    "after each 'vertex'") from None
    if not len(triangles):
        raise Error(f"{path}: there is no triangle in it")
    return triangles


def read(path, scale=1.0):
    """The same of any file: an STL file by read_stl, others (OBJ, PLY, OFF, ...) by the module trimesh if it is
    installed"""
    if pathlib.Path(path).suffix.lower() == ".stl":
        return read_stl(path, scale)
    try:
        import trimesh
    except ImportError:
        raise Error(f"{path}: files other than .stl need the Python module trimesh, which is not installed") from None
    try:
        return scale * np.array(trimesh.load(path, force="mesh").triangles, float)
    except Exception as why:       # trimesh has many kinds
        raise Error(f"{path}: trimesh cannot read it: {why}") from None


def write_stl(path, triangles):
    """A binary STL file; it keeps seven digits"""
    rows = np.zeros(len(triangles), np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")]))
    rows["corners"] = triangles
    pathlib.Path(path).write_bytes(b"closed surface".ljust(80) + struct.pack("<I", len(rows)) + rows.tobytes())


def numbered(triangles):
    """The corners as [n, 3] numbers, equal for corners at the same place to 1e-6 of the size; triangles without area
    are left out"""
    size = np.ptp(triangles.reshape(-1, 3), axis=0).max()
    _, number = np.unique(np.round(triangles.reshape(-1, 3) / (1e-6 * size)).astype(np.int64), axis=0,
                          return_inverse=True)
    number = number.reshape(-1, 3)
    good = (number[:, 0] != number[:, 1]) & (number[:, 1] != number[:, 2]) & (number[:, 2] != number[:, 0])
    return number[good], triangles[good]


def closed(triangles, name):
    """The triangles with normals that point outwards, or an error: each edge must belong to two triangles, once in each
    direction"""
    if not np.isfinite(triangles).all():
        raise Error(f"{name}: a corner is not finite")
    number, triangles = numbered(triangles)
    edges = np.concatenate([number[:, [0, 1]], number[:, [1, 2]], number[:, [2, 0]]])
    pairs, times = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    open_edges, crossings = (times == 1).sum(), (times > 2).sum()
    if open_edges or crossings:
        where = triangles.reshape(-1,
                                  3)[np.argmax((number.ravel()[:, None] == pairs[np.argmax(times != 2)]).any(axis=1))]
        raise Error(f"{name}: the surface is not closed: {open_edges} edges belong to one triangle only and "
                    f"{crossings} to more than two, the first near {where.round(6).tolist()}. Fill its holes and join "
                    "its parts (for example in MeshLab or Blender)")
    if len(np.unique(edges, axis=0)) != len(edges):
        raise Error(f"{name}: the triangles do not turn in one sense. Make their normals consistent (for example in "
                    "MeshLab or Blender)")
    return triangles if volume_and_centre(triangles)[0] > 0 else triangles[:, ::-1]


def volume_and_centre(triangles):
    """By the tetrahedra that the triangles form with the origin"""
    six = np.einsum("ni,ni->n", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2]))
    return six.sum() / 6, (six[:, None] * triangles.sum(axis=1)).sum(axis=0) / 4 / six.sum()


def inside(triangles, x, y, z, name="surface"):
    """[nx, ny, nz] whether the nodes of a lattice lie in the closed surface. x, y, z: coordinates of its planes,
    increasing.

    A ray goes up through each column of nodes. Where it enters through a triangle that faces down, the winding number
    grows by one, where it leaves it falls; inside it is 1. Columns are shifted by 1e-7 of a spacing, so that no ray
    meets an edge. The two triangles at an edge find the same number, with opposite sign, for the side on which the ray
    passes, so that it meets exactly one of them."""
    step = max(x[1] - x[0], y[1] - y[0])
    X, Y = x + 1.414e-7 * step, y + 0.732e-7 * step
    jump = np.zeros((len(x), len(y), len(z) + 1), int)
    for corners in triangles:
        low, high = corners[:, :2].min(axis=0), corners[:, :2].max(axis=0)
        i0, i1 = np.searchsorted(X, [low[0], high[0]])
        j0, j1 = np.searchsorted(Y, [low[1], high[1]])
        if i0 == i1 or j0 == j1:
            continue
        # of the edge against corner k - 1
        sides = [_side(corners[k], corners[k - 2], X[i0:i1, None], Y[None, j0:j1]) for k in range(3)]
        up = (sides[0] > 0) & (sides[1] > 0) & (sides[2] > 0)
        down = (sides[0] < 0) & (sides[1] < 0) & (sides[2] < 0)
        hit = np.nonzero(up | down)
        weight = np.array([sides[k][hit] for k in range(3)])
        height = (weight[0] * corners[2, 2] + weight[1] * corners[0, 2] + weight[2] * corners[1, 2]) / weight.sum(
            axis=0)
        jump[hit[0] + i0, hit[1] + j0, np.searchsorted(z, height)] += np.where(up[hit], -1, 1)
    winding = np.cumsum(jump, axis=2)
    if winding[:, :, -1].any() or (winding < 0).any() or (winding > 1).any():
        raise Error(f"{name}: parts of the surface lie in each other or cross, or a cavity has normals that point into "
                    "the body. Join the parts (for example in MeshLab or Blender)")
    return winding[:, :, :-1] == 1


def _side(a, b, x, y):
    """> 0 where (x, y) lies to the left of the line from a to b seen from above; the same number but for the sign from
    b to a"""
    if tuple(a) > tuple(b):
        return -_side(b, a, x, y)
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])


def winding_number(triangles, points):
    """1 within and 0 outside a closed surface: the solid angle that it fills, seen from each point, over 4 pi (Van
    Oosterom & Strackee 1983). Slower than inside(), and another way to the same answer."""
    total = np.zeros(len(points))
    for k, point in enumerate(points):
        a, b, c = (triangles - point).transpose(1, 0, 2)
        A, B, C = (np.linalg.norm(v, axis=1) for v in (a, b, c))
        dot = [np.einsum("ni,ni->n", *pair) for pair in ((a, b), (b, c), (c, a))]
        total[k] = 2 * np.arctan2(np.einsum("ni,ni->n", a, np.cross(b, c)),
                                  A * B * C + dot[0] * C + dot[1] * A + dot[2] * B).sum()
    return total / (4 * np.pi)


def section(triangles, axis, at):
    """[n, 2, 3] the lines in which the plane x[axis] = at cuts the surface"""
    above = triangles[:, :, axis] > at
    cut = above.any(axis=1) & ~above.all(axis=1)
    lines = []
    for corners, up in zip(triangles[cut], above[cut]):
        pairs = [(corners[k - 1], corners[k]) for k in range(3) if up[k - 1] != up[k]]
        lines.append([a + (at - a[axis]) / (b[axis] - a[axis]) * (b - a) for a, b in pairs])
    return np.array(lines).reshape(-1, 2, 3)


def sphere_mesh(n):
    """Triangles of the unit sphere: an octahedron whose edges are cut into n"""
    corner = [np.array(v, float) for v in ((1, 0, 0), (0, 1, 0), (0, 0, 1))]
    faces = []
    for signs in np.array(np.meshgrid([1, -1], [1, -1], [1, -1])).reshape(3, -1).T:
        a, b, c = (s * v for s, v in zip(signs, corner))
        p = {(i, j): (i * a + j * b + (n - i - j) * c) / n for i in range(n + 1) for j in range(n + 1 - i)}
        for i in range(n):
            for j in range(n - i):
                some = [(p[i, j], p[i + 1, j], p[i, j + 1])]
                some += [(p[i + 1, j], p[i + 1, j + 1], p[i, j + 1])] if i + j < n - 1 else []
                faces += some if signs.prod() > 0 else [face[::-1] for face in some]
    x = np.array(faces)
    return x / np.linalg.norm(x, axis=2, keepdims=True)


def profile_mesh(z, r, n=96):
    """Triangles of the body of revolution whose surface goes through the rings (z, r), from bottom to top, about the
    axis z"""
    z, r = np.concatenate([[z[0]], z, [z[-1]]]), np.concatenate([[0], r, [0]])
    phi = 2 * np.pi * np.arange(n + 1) / n
    ring = np.stack([np.outer(r, np.cos(phi)), np.outer(r, np.sin(phi)), np.repeat(z[:, None], n + 1, axis=1)], axis=2)
    ring[:, -1] = ring[:, 0]
    a, b, c, d = ring[:-1, :-1], ring[:-1, 1:], ring[1:, 1:], ring[1:, :-1]
    return np.concatenate([np.stack([a, b, c], axis=2).reshape(-1, 3, 3),
                           np.stack([a, c, d], axis=2).reshape(-1, 3, 3)])


def rod(length, radius):
    angle = np.linspace(-np.pi / 2, np.pi / 2, 33)
    low, high = angle[:17], angle[16:]
    along = np.linspace(-length / 2, length / 2, max(2, int(6 * length / radius)))[1:-1]
    z = np.concatenate([radius * np.sin(low) - length / 2, along, radius * np.sin(high) + length / 2])
    return profile_mesh(z, np.concatenate([radius * np.cos(low), radius + 0 * along, radius * np.cos(high)]))


def disc(radius, thickness):
    out = np.linspace(0, radius, 25)[1:]
    up = np.linspace(-thickness / 2, thickness / 2, 6)[1:-1]
    z = np.concatenate([0 * out - thickness / 2, up, 0 * out + thickness / 2])
    return profile_mesh(z, np.concatenate([out, radius + 0 * up, out[::-1]]))


def cube(edge, n=16):
    s = np.linspace(-0.5, 0.5, n + 1) * edge
    u, v = (w.ravel() for w in np.meshgrid(s[:-1], s[:-1], indexing="ij"))
    h, faces = edge / n, []
    for axis in range(3):
        for side in (-1, 1):
            def at(du, dv):
                x = np.empty((len(u), 3))
                x[:, axis], x[:, (axis + 1) % 3], x[:, (axis + 2) % 3] = side * edge / 2, u + du * h, v + dv * h
                return x
            for three in ((at(0, 0), at(1, 0), at(1, 1)), (at(0, 0), at(1, 1), at(0, 1))):
                faces.append(np.stack(three[::side], axis=1))
    return np.concatenate(faces)


def inertia(triangles, density):
    """Of the body about its centre of mass: xx yy zz xy xz yz, by tetrahedra"""
    volume, middle = volume_and_centre(triangles)
    t = triangles - middle
    six = np.einsum("ni,ni->n", t[:, 0], np.cross(t[:, 1], t[:, 2]))
    s = t.sum(axis=1)
    second = (np.einsum("n,ni,nj->ij", six, s, s) + np.einsum("n,nki,nkj->ij", six, t, t)) / 120
    I = density * (np.trace(second) * np.eye(3) - second)
    return density * volume, middle, I[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


SHAPES = {"ellipsoid": 3, "rod": 2, "disc": 2, "cube": 1}


def surface(shape, words):
    """Triangles of the shape, closed"""
    if shape == "stl":
        if len(words) not in (1, 2):
            raise Error("stl needs a file, and may have a scale after it")
        return closed(read_stl(words[0], float(words[1]) if len(words) == 2 else 1.0), words[0])
    sizes = [float(word) for word in words]
    if len(sizes) != SHAPES[shape] or min(sizes) <= 0:
        raise Error(f"{shape} needs {SHAPES[shape]} sizes > 0, not {' '.join(words)}")
    triangles = sphere_mesh(24) * sizes if shape == "ellipsoid" else {"rod": rod, "disc": disc,
                                                                      "cube": cube}[shape](*sizes)
    return closed(triangles, shape)
