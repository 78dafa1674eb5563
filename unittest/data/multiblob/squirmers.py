"""Makes squirmers.csv: velocities of two squirmers, and of one above a no-slip wall z = 0, exactly.

Radius 1, viscosity 1, no forces and torques. Point forces inside of each sphere (with Blake's images above the wall)
and the rigid motions are found by least squares from the slip at points of the surfaces; 150 points more or fewer
change the velocities by less than 2e-5 at distances from 2.5 and heights from 1.6.
Slip: Blake 1971, J. Fluid Mech. 46, 199; with the azimuthal part beta cos theta sin theta.
Images: Blake 1971, Proc. Camb. Phil. Soc. 70, 303.
Usage: python3 squirmers.py > squirmers.csv   (2 minutes)"""
import numpy as np


def fibonacci(n):
    """n points, spread evenly over the unit sphere"""
    k = np.arange(n) + 0.5
    z, phi = 1 - 2 * k / n, np.pi * (1 + 5**0.5) * k
    return np.column_stack([np.sqrt(1 - z * z) * np.cos(phi), np.sqrt(1 - z * z) * np.sin(phi), z])


def point_forces(x, y, wall):
    """[nx, 3, ny, 3]: velocity at x of unit forces at y"""
    r = x[:, None] - y[None]
    R = np.linalg.norm(r, axis=2)[..., None, None]
    G = np.eye(3) / R + r[..., :, None] * r[..., None, :] / R**3
    if wall:
        mirror, up = np.array([1, 1, -1.0]), np.array([0, 0, 1.0])
        h = y[None, :, 2][..., None, None]
        q = r + 2 * h[..., 0] * up
        Q = np.linalg.norm(q, axis=2)[..., None, None]
        qq, q3 = q[..., :, None] * q[..., None, :], q[..., 2][..., None, None]
        source = np.eye(3) / Q**3 - 3 * qq / Q**5
        doublet = (np.eye(3) * q3 + q[..., :, None] * up - up[:, None] * q[..., None, :]) / Q**3 - 3 * qq * q3 / Q**5
        G = G - np.eye(3) / Q - qq / Q**3 + 2 * h * (h * source - doublet) * mirror
    return (G / (8 * np.pi)).transpose(0, 2, 1, 3)


def slip(n, e, B):
    c = n @ e
    return -(B[0] + B[1] * c)[:, None] * (e - c[:, None] * n) + B[2] * c[:, None] * np.cross(e, n)


def rigid(r):
    """[points, 3, 6]: velocities of (U, W), and transposed force and torque"""
    K = np.zeros((len(r), 3, 6))
    K[:, :, :3] = np.eye(3)
    for d in range(3):
        K[:, :, 3 + d] = np.cross(np.eye(3)[d], r)
    return K


def exact(x, e, B, wall, n=250, m=700, inside=0.5):
    """U, W [spheres, 6]; n forces at the distance inside from each centre, m points of the surface"""
    N, sources, surface = len(x), inside * fibonacci(n), fibonacci(m)
    y, p = (np.concatenate([c + points for c in x]) for points in (sources, surface))
    A, b = np.zeros((3 * m * N + 6 * N, 3 * n * N + 6 * N)), np.zeros(3 * m * N + 6 * N)
    A[:3 * m * N, :3 * n * N] = point_forces(p, y, wall).reshape(3 * m * N, 3 * n * N)
    for i in range(N):
        rows, motion = slice(3 * m * i, 3 * m * (i + 1)), slice(3 * n * N + 6 * i, 3 * n * N + 6 * (i + 1))
        A[rows, motion] = -rigid(surface).reshape(3 * m, 6)
        A[3 * m * N + 6 * i:3 * m * N + 6 * (i + 1), 3 * n * i:3 * n * (i + 1)] = rigid(sources).reshape(3 * n, 6).T
        b[rows] = slip(surface, np.array(e[i]), B[i]).ravel()
    return np.linalg.lstsq(A, b, rcond=1e-13)[0][3 * n * N:].reshape(N, 6)


def main():
    e = [(0.6, 0.0, 0.8), (0.0, 1.0, 0.0)]
    B = [(1.0, -3.0, 0.5), (0.7, 2.0, 0.0)]
    print("# exact squirmers: squirmers.py beside this file; radius 1, viscosity 1, free; wall 1: "
          "above a no-slip wall z = 0")
    print("case,wall,x,y,z,ex,ey,ez,B1,B2,beta,Ux,Uy,Uz,Wx,Wy,Wz")
    cases = [(0, [(0, 0, 0), (s, 0, 0)]) for s in (2.5, 3.0, 4.0, 6.0)] + [(1, [(0, 0, h)]) for h in (1.6, 2.0, 3.0)]
    for k, (wall, x) in enumerate(cases):
        U = exact(np.array(x, float), e, B, wall, inside=0.5 if wall else 0.45)
        for i in range(len(x)):
            print(",".join(f"{v:.7g}" for v in [k, wall, *x[i], *e[i], *B[i], *U[i]]))


if __name__ == "__main__":
    main()
