# %% [markdown]
# # A clump from Python
#
# Resistance and mobility of an L of four spheres as numpy arrays, how it settles without inertia, and the same through
# LAMMPS. Units: radius of a sphere 1, drag of a lone sphere 1 (viscosity 1/(6 pi)), weight of a sphere, less buoyancy,
# 1. So a lone sphere settles with velocity 1. After `. build/env.sh`.

# %%
import numpy as np
import stokesdyn

VISCOSITY = 1 / (6 * np.pi)
L = np.array([(0.0, 0, 0), (2, 0, 0), (4, 0, 0), (4, 2, 0)])
clump = stokesdyn.Clump(L, radius=1, shell=42, viscosity=VISCOSITY)
with np.printoptions(precision=4, suppress=True):
    print("resistance about", clump.centre)
    print(clump.resistance)

# %% [markdown]
# Three directions in which it settles without turning away from them would be the eigenvectors of the mobility's first
# block, if the weight acted at the centre of hydrodynamic stress. It acts at the centre of mass, so the L turns as
# well.

# %%
mass_centre = L.mean(axis=0)
arm = mass_centre - clump.centre                 # in the axes of the clump
WEIGHT = np.array([0, 0, -len(L)])


def motion(R):
    """Velocity of the centre of mass, and angular velocity, of the clump in the pose R: x = c + R (L - mass_centre)."""
    force = R.T @ WEIGHT
    U, W = clump.velocity(force, np.cross(arm, force))
    return R @ (U + np.cross(W, arm)), R @ W


def turned(R, angle):
    """R, turned by a vector of rotation."""
    size = np.linalg.norm(angle)
    if size == 0.0:
        return R
    k = angle / size
    K = np.array([(0, -k[2], k[1]), (k[2], 0, -k[0]), (-k[1], k[0], 0)])
    return (np.eye(3) + np.sin(size) * K + (1 - np.cos(size)) * K @ K) @ R


def settle(R, time, steps):
    """The path of the centre of mass [steps + 1, 3] and the last pose: the midpoint rule, of second order."""
    dt, path = time / steps, np.zeros((steps + 1, 3))
    for k in range(steps):
        half = turned(R, 0.5 * dt * motion(R)[1])
        velocity, spin = motion(half)
        path[k + 1] = path[k] + dt * velocity
        R = turned(R, dt * spin)
    return path, R


START = turned(np.eye(3), np.array([1.0, 0.3, 0.2]))
TIME = 40.0
path, pose = settle(START, TIME, 400)
print("after time", TIME, "the clump is at", path[-1].round(3))

# %% [markdown]
# The same in LAMMPS: a rigid body with a mass so small that its inertia does not matter. Nothing is read from files.

# %%
from lammps import lammps  # noqa: E402

MASS = 0.01                                      # of a sphere, also its relaxation time
lmp = lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"])
lmp.commands_string(f"""
plugin        load stokesdynplugin.so
units         lj
atom_style    hybrid sphere bond
boundary      m m m
newton        off
region        box block -20 20 -20 20 -20 20
create_box    1 box
""")
for x in (L - mass_centre) @ START.T:
    lmp.command("create_atoms 1 single {:.15g} {:.15g} {:.15g}".format(*x))
lmp.commands_string(f"""
set           group all diameter 2 density {MASS / (4 / 3 * np.pi)} mol 1
mass          1 1
pair_style    stokes_dynamics clumps_only yes rigid_clumps yes shell 42 visc {VISCOSITY} add_force yes
pair_coeff    * *
comm_modify   cutoff 12
neigh_modify  exclude molecule/intra all
fix           weight all gravity {1 / MASS} vector 0 0 -1
fix           rigid all rigid/small molecule
variable      x equal xcm(all,x)
variable      y equal xcm(all,y)
variable      z equal xcm(all,z)
timestep      {0.2 * MASS}
thermo_style  custom step
""")
every = round(TIME / 40 / (0.2 * MASS))
lammps_path = [np.zeros(3)]
for k in range(40):
    lmp.command(f"run {every} pre {'yes' if k == 0 else 'no'} post no")
    lammps_path.append(np.array([lmp.extract_variable(name) for name in "xyz"]))
lammps_path = np.array(lammps_path)
lmp.close()
difference = np.abs(lammps_path - path[::10]).max()
print("LAMMPS ends at", lammps_path[-1].round(3), "largest difference of the paths", difference.round(3))

# %%
import matplotlib.pyplot as plt  # noqa: E402

figure, axes = plt.subplots(1, 2, figsize=(7, 3.4), layout="constrained")
for axis, (d, e, across) in zip(axes, ((0, 2, "x"), (1, 2, "y"))):
    axis.plot(path[:, d], path[:, e], label="stokesdyn.Clump, no inertia")
    axis.plot(lammps_path[:, d], lammps_path[:, e], ".", label="pair_style stokes_dynamics")
    axis.set(xlabel=f"{across} / radius", ylabel="z / radius")
axes[0].legend(fontsize="small")
