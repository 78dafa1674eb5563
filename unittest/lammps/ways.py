"""The ways to solve a scene that the hard cases go through, each with its answer by dense linear algebra."""
import numpy as np

import model
from system import note

ETA, A = 1.3, 0.7
STOKES = 6 * np.pi * ETA * A
EXACT = "algorithm 2 relative_tolerance 1e-12 max_iter 5000"
COLUMNS = "x y z vx vy vz f_drag[1] f_drag[2] f_drag[3] f_drag[7] f_drag[8] f_drag[9]"


class Way:
    """Keywords of the pair style. {reach} in them is larger than the scene: no cut-off, but lists of pairs, or a
    taper."""

    def __init__(self, words, rotation=False, taper=None, clumps=False):
        self.words, self.rotation, self.taper, self.clumps = words, rotation, taper, clumps

    def style(self, spheres, ending=EXACT, eta=ETA):
        return f"{self.words.format(reach=repr(reach(spheres)))} visc {eta!r} {ending}"

    def matrix(self, spheres, eta=ETA, x=None):
        """x: where the spheres are by now; the reach stays. Leading axes are frames."""
        x = spheres.x if x is None else x
        return model.mobility(x, np.broadcast_to(spheres.a, x.shape[:-1]), eta,
                              sees=model.same_clump(spheres) if self.clumps else None,
                              taper=(self.taper, reach(spheres)) if self.taper else None, rotation=self.rotation)

    def slip(self, v, omega):
        return -(np.hstack([v, np.broadcast_to(omega, v.shape)]) if self.rotation else v).ravel()

    def forces(self, spheres, omega=0.0, eta=ETA, v=None):
        """[n,3], with rotation forces and torques [n,6], in a fluid at rest"""
        slip = self.slip(spheres.v if v is None else v, omega)
        return np.linalg.solve(self.matrix(spheres, eta), slip).reshape(spheres.n, -1)

    def answer(self, sim):
        rows = sim.fix_rows()
        return np.hstack([rows[:, 0:3], rows[:, 6:9]]) if self.rotation else rows[:, 0:3]

    def forces_on_the_way(self, spheres, frames):
        """[k,n,3] or [k,n,6]; frames [k,n,6+] with places and velocities, which may have come from spheres by any
        way"""
        x, v = frames[..., 0:3], frames[..., 3:6]
        slip = -np.concatenate([v, np.zeros_like(v)], axis=-1) if self.rotation else -v
        F = np.linalg.solve(self.matrix(spheres, x=x), slip.reshape(len(frames), -1, 1))
        return F.reshape(slip.shape)

    def answer_of_frames(self, frames):
        """Of rows with the columns COLUMNS"""
        return frames[..., 6:12] if self.rotation else frames[..., 6:9]

    def error(self, answer, expected, spheres):
        """Largest difference, of a force or of a torque over the radius, in units of the largest force. Goes into the
        table."""
        difference = answer - expected
        difference[..., 3:] /= spheres.a[:, None]
        value = np.abs(difference).max() / np.linalg.norm(expected[..., :3], axis=-1).max()
        note("error", value)
        return value

    def residual(self, answer, spheres, omega=0.0, eta=ETA):
        """By the definition on the page: each row scaled by its 6 pi eta a, or 8 pi eta a^3 made a force by sqrt(4/3)
        a"""
        scale = np.repeat(6 * np.pi * eta * spheres.a[:, None], 3, axis=1)
        if self.rotation:
            scale = np.hstack([scale, scale * spheres.a[:, None] * (8 / 6) / np.sqrt(4 / 3)])
        slip = self.slip(spheres.v, omega)
        rest = slip - self.matrix(spheres, eta) @ answer.ravel()
        return np.linalg.norm(scale.ravel() * rest) / np.linalg.norm(scale.ravel() * slip)


def reach(spheres):
    return float(1.5 * np.linalg.norm(np.ptp(spheres.x, axis=0)) + 4.0 * spheres.a.max())


WAYS = {"none": Way("cut_off_distance inf precondition none"),
        "clump": Way("cut_off_distance inf precondition clump"),
        "sparse": Way("cut_off_distance inf precondition sparse"),
        "clumps_only": Way("clumps_only yes", clumps=True),
        "list": Way("cut_off_distance {reach} precondition none"),
        "rotation": Way("cut_off_distance inf rotation yes", rotation=True),
        "rotation sparse": Way("cut_off_distance inf rotation yes precondition sparse", rotation=True),
        "rotation clumps_only": Way("clumps_only yes rotation yes precondition clump", rotation=True, clumps=True),
        "taper": Way("cut_off_distance {reach} taper wendland", taper="wendland")}
