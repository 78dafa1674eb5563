"""A standing sound wave on a periodic square lattice without viscosity: energy against time."""
import numpy as np

from sph_tools import by_id, run, start, write_data

C0, RHO0, GAMMA, DX, NX, NY = 10.0, 1000.0, 7.0, 0.01, 32, 8
B = C0**2 * RHO0 / GAMMA
M = RHO0 * DX * DX


def specific_energy(rho):
    """Integral of P/rho^2 for Tait's equation, 0 at rho0."""
    s = rho / RHO0
    return B / RHO0 * ((s ** (GAMMA - 1) - 1) / (GAMMA - 1) + 1 / s - 1)


def wave(path, integrator, courant, steps, samples, amplitude=1e-3, kernel="wendland", h=1.3 * DX, thermal=0.0,
         extra=""):
    """Times in periods of the wave, total energies and kinetic energies."""
    x = np.stack([a.ravel() for a in np.meshgrid((np.arange(NX) + 0.5) * DX, (np.arange(NY) + 0.5) * DX, [0.0],
                                                 indexing="ij")], axis=1)
    L = NX * DX
    v = np.zeros_like(x)
    v[:, 0] = amplitude * C0 * np.sin(2 * np.pi * x[:, 0] / L)
    random = np.random.default_rng(2)
    v[:, :2] += thermal * C0 * random.uniform(-1, 1, (len(x), 2))
    write_data(path, x, v, np.full(len(x), RHO0), np.ones(len(x), int), [0, 0, -0.5], [L, NY * DX, 0.5])
    dt = courant * h / C0
    lmp = start()
    run(lmp, """
    units si
    dimension 2
    atom_style sph
    atom_modify map array
    read_data %s
    mass 1 %.17g
    neighbor 0.1e-2 bin
    neigh_modify delay 0 every 1
    pair_style sph/artVisc/tensCorr %s %.17g
    pair_coeff * *
    fix eos all sph/pressure Tait %.17g %.17g %.17g
    fix rho all sph/density/continuity
    fix move all %s
    timestep %.17g
    thermo 1000000
    %s
    run 0 post no
    """ % (path, M, kernel, h, B, RHO0, GAMMA, integrator, dt, extra))
    energies, kinetic = [], []
    for k in range(samples + 1):
        if k:
            lmp.command("run %d post no pre no" % (steps // samples))
        kin = 0.5 * M * (by_id(lmp, "v", 3) ** 2).sum()
        kinetic.append(kin)
        energies.append(kin + M * specific_energy(by_id(lmp, "rho")).sum())
    lmp.close()
    t = np.arange(samples + 1) * (steps // samples) * dt * C0 / L
    return t, np.array(energies), np.array(kinetic)
