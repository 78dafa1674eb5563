"""Rigid bodies of points, for the examples."""
from runs import np


def rigid_velocities(x):
    """[3N x 6] matrix: velocities of points x from (U, W) of the rigid body."""
    K = np.zeros((3 * len(x), 6))
    for i, r in enumerate(x):
        K[3 * i:3 * i + 3, :3] = np.eye(3)
        K[3 * i:3 * i + 3, 3:] = [[0, r[2], -r[1]], [-r[2], 0, r[0]], [r[1], -r[0], 0]]
    return K


def rotation_between(x, y):
    """Rotation matrix that turns the points x into the points y, both about their centroids (Kabsch 1976)."""
    u, _, vt = np.linalg.svd((y - y.mean(0)).T @ (x - x.mean(0)))
    return u @ np.diag([1, 1, np.sign(np.linalg.det(u @ vt))]) @ vt
