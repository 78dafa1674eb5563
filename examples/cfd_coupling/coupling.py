#!/usr/bin/env python3
"""A small outside CFD code coupled to LAMMPS: it gives every sphere the fluid's velocity and viscosity and reads the
drag back.

    coupling.py prescribed      clumps cross a given cellular flow of varying viscosity
    coupling.py two-way         clumps and a body of fluid exchange momentum

The order of a step (velocity Verlet), and where the CFD code stands in it:

    half a kick with the force F_n, drift to x_(n+1)
    pair style:   F_(n+1) from the velocities of the half step and the fluid velocity that was written in step n
    callback:     reads x_(n+1) and F_(n+1), advances the fluid, writes the fluid velocity at x_(n+1), which acts
                  in step n+2
    half a kick with F_(n+1)

So the coupling is explicit with a lag of one step. The clumps receive the impulse dt/2 (F_n + F_(n+1)) in a step, not
dt F_(n+1). The fluid is given exactly the opposite, hence momentum is conserved to rounding.
"""
import argparse
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import other_python      # noqa: E402

other_python.unless("numpy")
import numpy as np       # noqa: E402

try:
    from lammps import lammps, LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR
except ImportError:
    sys.exit("coupling.py: the python module of LAMMPS is not found; type: . ../../build/env.sh")

ETA = 1.0 / (6.0 * np.pi)       # 6 pi eta a = 1
EDGE, DEPTH = 128.0, 32.0       # the box
SPEED = 1.0                     # of the vortices
WAVE = 2.0 * np.pi / EDGE
SAMPLE, REPORT = 8, 40          # steps between two points of a track, two lines of output
SNAPSHOT = 120                  # the step whose fluid is kept for the picture


def vortices(x, y):
    """Taylor and Green's cellular flow: four vortices in the box."""
    ux, uy = np.sin(WAVE * x) * np.cos(WAVE * y), -np.cos(WAVE * x) * np.sin(WAVE * y)
    return SPEED * np.stack((ux, uy, 0.0 * x), axis=-1)


class PrescribedFlow:
    """Steady vortices that nothing disturbs, in a fluid whose viscosity changes with height by a factor of 2."""

    def velocity(self, x):
        return vortices(x[:, 0], x[:, 1])

    def viscosity(self, x):
        return ETA * 2.0 ** (0.5 * np.sin(WAVE * x[:, 1]))

    def rate(self, x, F):
        """What the fluid receives per time; a prescribed flow swallows it."""
        return -F.sum(axis=0)

    def total(self, rate):
        return rate

    def advance(self, impulse, dt):
        pass

    def momentum(self):
        return np.zeros(3)


class PeriodicFluid:
    """Incompressible fluid of finite mass on a periodic grid, solved in Fourier space:

        rho (du/dt + u.grad u) = -grad p + eta lap u + f,   div u = 0

    Each sphere takes its velocity from the eight nearest grid points and gives its reaction to them with the same
    weights. The weights sum to 1, so no momentum is lost on the way; pressure, viscosity and convection move momentum
    about but leave its sum alone, which is the mode k = 0.
    """

    def __init__(self, rho, cell):
        self.rho = rho
        self.n = np.array([round(EDGE / cell), round(EDGE / cell), round(DEPTH / cell)])
        self.cell = cell
        x, y, _ = np.meshgrid(*(cell * np.arange(n) for n in self.n), indexing="ij")
        self.u = vortices(x, y)
        k = np.meshgrid(*(2.0 * np.pi * np.fft.fftfreq(n, cell) for n in self.n), indexing="ij")
        self.k = np.stack(k, axis=-1)
        self.k2 = (self.k ** 2).sum(axis=-1)
        # of products: the others would be aliased
        self.resolved = np.all(np.abs(self.k) < 2.0 / 3.0 * np.pi / cell, axis=-1)

    def weights(self, x):
        at = x / self.cell
        low = np.floor(at).astype(int)
        part = at - low
        for corner in np.ndindex(2, 2, 2):
            yield tuple(((low + corner) % self.n).T), np.prod(np.where(corner, part, 1.0 - part), axis=1)[:, None]

    def velocity(self, x):
        return sum(w * self.u[node] for node, w in self.weights(x))

    def viscosity(self, x):
        return np.full(len(x), ETA)

    def rate(self, x, F):
        out = np.zeros_like(self.u)
        for node, w in self.weights(x):
            np.add.at(out, node, -w * F)
        return out

    def total(self, rate):
        return rate.sum(axis=(0, 1, 2))

    def advance(self, impulse, dt):
        u_k = np.fft.fftn(self.u, axes=(0, 1, 2))
        curl = np.fft.ifftn(1j * np.cross(self.k, u_k), axes=(0, 1, 2)).real
        push = np.fft.fftn(np.cross(self.u, curl), axes=(0, 1, 2)) * self.resolved[..., None]
        push[0, 0, 0] = 0.0                                         # convection has no mean
        u_k += dt * push + np.fft.fftn(impulse, axes=(0, 1, 2)) / (self.rho * self.cell ** 3)
        k2 = np.where(self.k2 > 0.0, self.k2, 1.0)
        u_k -= self.k * ((self.k * u_k).sum(axis=-1) / k2)[..., None]        # incompressible
        u_k *= np.exp(-ETA / self.rho * self.k2 * dt)[..., None]
        self.u = np.fft.ifftn(u_k, axes=(0, 1, 2)).real

    def momentum(self):
        return self.rho * self.cell ** 3 * self.u.sum(axis=(0, 1, 2))


class Coupling:
    """What is exchanged with LAMMPS, once per step."""

    def __init__(self, lmp, fluid):
        self.lmp, self.fluid = lmp, fluid
        self.step = self.error = None
        self.imbalance = 0.0                # largest |force on the clumps + momentum rate of the fluid| / sum of |F|
        self.reaction = np.zeros(3)         # momentum given to the fluid so far
        self.tracks, self.snapshot = [], np.zeros(0)

    def write(self):
        """Every rank gives its own spheres the fluid that they see."""
        if self.lmp.extract_global("nlocal") == 0:
            return
        x = self.lmp.numpy.extract_atom("x")
        u = self.fluid.velocity(x)
        for d, name in enumerate(("d_ux", "d_uy", "d_uz")):
            self.lmp.numpy.extract_atom(name)[:] = u[:, d]
        self.lmp.numpy.extract_atom("d_eta")[:] = self.fluid.viscosity(x)

    def gather(self, name, columns):
        """A per-atom quantity of all ranks in the order of the IDs; each rank then knows all, and keeps the whole
        fluid."""
        return np.array(self.lmp.gather(name, 1, columns)).reshape(-1, columns)

    def exchange(self, step):
        """Forces and positions are those of this step: advance the fluid, write what the next step will see."""
        dt = self.lmp.extract_global("dt")
        x, F = self.gather("x", 3), self.gather("f_drag", 9)[:, :3]
        rate = self.fluid.rate(x, F)
        total = self.fluid.total(rate)
        on_clumps = [self.lmp.extract_fix("drag", LMP_STYLE_GLOBAL, LMP_TYPE_VECTOR, d) for d in range(3)]
        self.imbalance = max(self.imbalance, np.linalg.norm(on_clumps + total) / np.linalg.norm(F, axis=1).sum())
        # the same step again: a setup has evaluated the force anew
        if self.step is not None and step != self.step:
            impulse = 0.5 * dt * (self.rate + rate)
            self.fluid.advance(impulse, dt)
            self.reaction += self.fluid.total(impulse)
        self.rate, self.step = rate, step
        self.write()
        if step % SAMPLE == 0 and step // SAMPLE == len(self.tracks):
            self.tracks.append(self.positions())
        if step == SNAPSHOT:
            self.snapshot = getattr(self.fluid, "u", np.zeros(0)).copy()

    def callback(self, caller, step, nlocal, tag, x, f):
        try:                # an exception would be lost on its way through C
            self.exchange(step)
        except Exception as error:
            self.error = self.error or error

    def clump_momentum(self):
        v, m = self.gather("v", 3), self.gather("rmass", 1)
        return (m * v).sum(axis=0)

    def positions(self):
        """Across periodic borders."""
        image = np.array(self.lmp.gather("image", 0, 3)).reshape(-1, 3)
        return self.gather("x", 3) + image * (EDGE, EDGE, DEPTH)


SCENES = {
    "prescribed": dict(steps=1000, variables={}),
    "two-way": dict(steps=1200, variables=dict(mass=50.0, weight=0.0, speed=2.0, row=64.0, spread=20.0, chains=24)),
}


def read_arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scene", choices=SCENES)
    parser.add_argument("--steps", type=int, help="default: 1000 or 1200")
    parser.add_argument("--driver", choices=("callback", "loop"), default="callback",
                        help="fix external in one run, or a loop of 'run 1 pre no': the same answer")
    parser.add_argument("--out", default=".", help="directory for SCENE.npz")
    parser.add_argument("--log", default="log.lammps")
    return parser.parse_args()


def begin(args):
    words = ["-screen", "none", "-log", args.log]
    for name, value in dict(SCENES[args.scene]["variables"], edge=EDGE, depth=DEPTH, report=REPORT).items():
        words += ["-var", name, str(value)]
    return lammps(cmdargs=words)


class Balance:
    """The momentum of clumps and fluid, which only the weight changes: a row of a table from time to time"""

    def __init__(self, coupling, say, two_way):
        self.coupling, self.say, self.two_way = coupling, say, two_way
        lmp, mass = coupling.lmp, coupling.gather("rmass", 1).sum()
        self.weight = np.array((0.0, -lmp.extract_variable("gravity", None, 0) * mass, 0.0))
        self.start = coupling.clump_momentum() + coupling.fluid.momentum()
        self.curve, self.largest, self.drift = [], 0.0, 0.0
        say("    time   momentum of the clumps     momentum of the fluid      sum - start - weight*time   force "
            "+ rate of fluid")
        say("                  x            y            x            y            x            y         "
            "largest / sum of |F|")

    def report(self):
        coupling = self.coupling
        time = coupling.step * coupling.lmp.extract_global("dt")
        clumps = coupling.clump_momentum()
        body = coupling.fluid.momentum() if self.two_way else coupling.reaction
        off = clumps + body - self.start - self.weight * time
        self.largest = max(self.largest, np.linalg.norm(clumps), np.linalg.norm(body))
        self.drift = max(self.drift, np.linalg.norm(off))
        self.curve.append(np.concatenate(([time], clumps, body, off)))
        self.say(f"{time:8.1f} {clumps[0]:12.4f} {clumps[1]:12.4f} {body[0]:12.4f} {body[1]:12.4f} {off[0]:12.1e} "
                 f"{off[1]:12.1e}           {coupling.imbalance:9.1e}")

    def holds(self):
        imbalance = self.coupling.imbalance
        self.say(f"largest |force on the clumps + momentum rate of the fluid| / sum of |F|: {imbalance:.2e}")
        self.say(f"largest error of the momentum over the run / largest momentum:           "
                 f"{self.drift / self.largest:.2e}")
        balanced = imbalance < 1e-12 and self.drift < 1e-12 * self.largest
        if not balanced:
            self.say("the momentum balance is missed: both numbers must be below 1e-12")
        return balanced


def march(coupling, driver, steps, balance):
    lmp = coupling.lmp
    if driver == "callback":
        lmp.command("fix cfd all external pf/callback 1 1")         # after fix drag: its forces are those of this step
        lmp.set_fix_external_callback("cfd", coupling.callback)
    lmp.command("run 0 post no")
    if driver == "loop":
        coupling.exchange(0)
    balance.report()
    for done in range(0, steps, REPORT):
        count = min(REPORT, steps - done)
        if driver == "callback":
            lmp.command(f"run {count} pre no post no")
        else:
            for step in range(done + 1, done + count + 1):
                lmp.command("run 1 pre no post no")
                coupling.exchange(step)
        if coupling.error:
            raise coupling.error
        balance.report()


def main():
    args = read_arguments()
    out = os.path.abspath(args.out)
    lmp = begin(args)
    root = lmp.extract_setting("world_rank") == 0

    def say(text):
        """On the screen and in the log file."""
        lmp.command(f'print "{text}"')
        if root:
            print(text, flush=True)

    os.chdir(os.path.dirname(os.path.abspath(__file__)))
    lmp.file("in.cfd_coupling")
    fluid = PrescribedFlow() if args.scene == "prescribed" else PeriodicFluid(rho=0.012, cell=8.0)
    coupling = Coupling(lmp, fluid)
    # before the first force: the viscosity of a new property is 0, which the pair style refuses
    coupling.write()
    balance = Balance(coupling, say, args.scene == "two-way")
    march(coupling, args.driver, args.steps or SCENES[args.scene]["steps"], balance)
    balanced = balance.holds()
    if root:
        os.makedirs(out, exist_ok=True)
        np.savez(os.path.join(out, args.scene + ".npz"), curve=np.array(balance.curve),
                 tracks=np.array(coupling.tracks), u=coupling.snapshot, imbalance=coupling.imbalance,
                 drift=balance.drift / balance.largest)
    lmp.close()
    lmp.finalize()
    return 0 if balanced else 1


if __name__ == "__main__":
    sys.exit(main())
