"""The fluid of a closed tank by FEniCSx, and what goes between it and LAMMPS.

Navier-Stokes on hexahedra, velocities of second order and pressure of first (Taylor-Hood). A step is implicit in the
viscous part and explicit in the convective one, so its matrix is factorised once:

    rho (u' - u)/dt - rho div-form(u u) - div(2 eta D(u')) + grad p' = sum_k f_k delta_s(x - x_k),   div u' = 0

in its weak form. The test function that is 1 everywhere then says: momentum of the fluid changes by the forces of the
spheres and by those of the walls, which are the residuals of the nodes there.

delta_s is a Gaussian of width s. Forces go to the nodes by its mean of their shape functions, and velocities come from
them by the same weights: P u and P^T f. They sum to 1, so no momentum is lost on the way. Gaussian and shape functions
are products of one function for each direction, and so is a weight: X_i Y_j Z_k."""
import ctypes
import logging

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc
import ufl
from dolfinx import fem, mesh
from dolfinx.fem import petsc
from scipy.special import erf

logging.disable(logging.INFO)      # dolfinx tells of every form that it compiles
# the trapezoidal rule out to 5 widths, which integrates a Gaussian to rounding
OFFSETS = np.linspace(-5.0, 5.0, 101)
WEIGHTS = np.exp(-0.5 * OFFSETS**2) / np.exp(-0.5 * OFFSETS**2).sum()


class Fluid:
    def __init__(self, width, height, cells, eta, rho, dt, smear):
        """cells: of the width; the height has as many to the length"""
        self.size, self.rho, self.dt, self.smear, self.eta = np.array([width, width, height]), rho, dt, smear, eta
        self.cells = np.array([cells, cells, round(cells * height / width)])
        domain = mesh.create_box(MPI.COMM_SELF, [np.zeros(3), self.size], self.cells.tolist(), mesh.CellType.hexahedron)
        cell = domain.ufl_cell()
        self.W = fem.FunctionSpace(domain,
                                   ufl.MixedElement([ufl.VectorElement("Q", cell, 2), ufl.FiniteElement("Q", cell, 1)]))
        self.V, self.to_w = self.W.sub(0).collapse()
        self.to_w = np.array(self.to_w)
        Q, pressure_to_w = self.W.sub(1).collapse()
        self.u = fem.Function(self.V)
        self._nodes(domain)
        self._forms(domain)
        self._walls(domain, pressure_to_w[0])

    def _forms(self, domain):
        (u, p), (v, q) = ufl.TrialFunctions(self.W), ufl.TestFunctions(self.W)
        strain = ufl.sym(ufl.grad(u))
        a = (self.rho / self.dt * ufl.inner(u, v) + 2 * self.eta * ufl.inner(strain, ufl.grad(v)) - p * ufl.div(v) - q *
             ufl.div(u)) * ufl.dx
        # what is known; u x u in divergence form, so that a constant test function does not see it
        known = self.rho / self.dt * ufl.inner(self.u,
                                               v) + self.rho * ufl.inner(ufl.outer(self.u, self.u), ufl.grad(v).T)
        self.known = fem.form(known * ufl.dx(metadata={"quadrature_degree": 6}))
        self.matrix = petsc.assemble_matrix(fem.form(a))
        self.matrix.assemble()
        w = ufl.TestFunction(self.V)
        self.volume = [fem.assemble_vector(fem.form(w[d] * ufl.dx)).array.copy() for d in range(3)]

    def _walls(self, domain, one_pressure):
        """No slip; and one pressure is 0, since only differences of it mean anything."""
        facets = mesh.locate_entities_boundary(domain, 2, lambda x: np.full(x.shape[1], True))
        fixed = fem.locate_dofs_topological((self.W.sub(0), self.V), 2, facets)[0]
        self.fixed = np.unique(np.append(fixed, one_pressure)).astype(np.int32)
        held = self.matrix.copy()
        held.zeroRows(self.fixed, 1.0)
        self.solver = PETSc.KSP().create(MPI.COMM_SELF)
        self.solver.setOperators(held)
        self.solver.setType("preonly")
        self.solver.getPC().setType("lu")
        self.solver.getPC().setFactorSolverType("mumps")
        self.solver.setUp()
        # residuals of the walls, by direction: entry k of the mixed vector is velocity component k of node ...
        self.direction = np.full(self.matrix.size[0], -1)
        self.direction[self.to_w] = np.arange(len(self.to_w)) % 3
        self.solution = self.matrix.createVecRight()
        self.known_vector = self.matrix.createVecLeft()

    def _nodes(self, domain):
        """Number of the node at each place of the lattice of half cells."""
        at = np.rint(self.V.tabulate_dof_coordinates() / self.size * (2 * self.cells)).astype(int)
        self.node = np.empty(2 * self.cells + 1, dtype=int)
        self.node[tuple(at.T)] = np.arange(len(at))

    def weights(self, x):
        """X, Y, Z [n, nodes along the axis] of the places x [n, 3]. What is beyond a wall counts as on it, where
        nothing moves."""
        products = []
        for d in range(3):
            points = np.clip(x[:, d, None] + self.smear * OFFSETS, 0.0, self.size[d]) / self.size[d] * self.cells[d]
            cell = np.minimum(points.astype(int), self.cells[d] - 1)
            t = points - cell
            sums = np.zeros((len(x), 2 * self.cells[d] + 1))
            for node, shape in enumerate(((1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1))):
                np.add.at(sums, (np.arange(len(x))[:, None], 2 * cell + node), shape * WEIGHTS)
            products.append(sums)
        return products

    def velocity(self, P):
        """P u"""
        u = self.u.x.array.reshape(-1, 3)[self.node]
        return np.einsum("ni,nj,nk,ijkd->nd", *P, u, optimize=["einsum_path", (2, 3), (1, 2), (0, 1)])

    def spread(self, P, force):
        """P^T f, by nodes"""
        on_nodes = np.empty((self.node.size, 3))
        on_nodes[self.node] = np.einsum("ni,nj,nk,nd->ijkd", *P, force,
                                        optimize=["einsum_path", (2, 3), (0, 1), (0, 1)])
        return on_nodes.ravel()

    def advance(self, P, force):
        """One step under forces [n, 3] of the spheres on the fluid. Returns the force of the walls on it."""
        b = self.known_vector
        b.array[:] = fem.assemble_vector(self.known).array[:b.local_size]
        b.array[self.to_w] += self.spread(P, force)
        rhs = b.copy()
        rhs.array[self.fixed] = 0.0
        self.solver.solve(rhs, self.solution)
        residual = self.matrix * self.solution - b
        self.u.x.array[:] = self.solution.array[self.to_w]
        inner = residual.array.copy()
        inner[self.fixed] = 0.0
        self.unsolved = np.abs(inner).max()
        return np.array([residual.array[self.fixed][self.direction[self.fixed] == d].sum() for d in range(3)])

    def momentum(self):
        return self.rho * np.array([self.volume[d] @ self.u.x.array for d in range(3)])


def own_disturbance(x, force, molecule, eta, smear):
    """Velocity at each sphere of the spheres of its own molecule (0: of itself), in fluid without end: what the mesh
    would give it twice. Stokes flow of a Gaussian force, taken as the Gaussian mean: a width of sqrt(2) s; Maxey &
    Patel 2001."""
    s = np.sqrt(2) * smear
    u = force / (6 * np.pi * eta * np.sqrt(np.pi / 2) * s)
    for m in np.unique(molecule[molecule > 0]):
        i = np.nonzero(molecule == m)[0]
        r = x[i, None] - x[None, i]
        d = np.linalg.norm(r, axis=-1) + np.eye(len(i))
        e, g = erf(d / (s * np.sqrt(2))), np.exp(-d**2 / (2 * s**2)) * s / d * np.sqrt(2 / np.pi)
        along, across = (1 - 3 * s**2 / d**2) * e + 3 * g, (1 + s**2 / d**2) * e - g
        off = (1 - np.eye(len(i))) / (8 * np.pi * eta * d)
        pair = ((off * across)[..., None, None] * np.eye(3) + (off * along / d**2)[..., None, None] * r[..., :, None] *
                r[..., None, :])
        u[i] += np.einsum("ijpq,jq->ip", pair, force[i])
    return u


class Tank:
    """Grains in LAMMPS, fluid here. correct: without the grains' own disturbance."""

    def __init__(self, lmp, fluid, molecule, correct=True):
        self.lmp, self.fluid, self.molecule, self.correct = lmp, fluid, molecule, correct
        self.walls = np.zeros(3)                 # impulse of the walls on the fluid
        self.before = None
        self.give(np.zeros((len(molecule), 3)))

    def gather(self, name, columns):
        return np.array(self.lmp.gather(name, 1, columns)).reshape(-1, columns)

    def give(self, u):
        """The fluid's velocity for each sphere, by ID."""
        for d, name in enumerate(("d_ux", "d_uy", "d_uz")):
            self.lmp.scatter(name, 1, 1, (len(u) * ctypes.c_double)(*u[:, d]))

    def begin(self):
        self.lmp.command("run 0 post no")
        self.before = self.gather("f_drag", 9)[:, :3], self.gather("x", 3)

    def step(self):
        """velocity Verlet gives the grains dt/2 (F + F') in a step: this is what the fluid has to lose."""
        self.lmp.command("run 1 pre no post no")
        F, x = self.gather("f_drag", 9)[:, :3], self.gather("x", 3)
        P = self.fluid.weights(x)
        self.walls += self.fluid.dt * self.fluid.advance(P, -0.5 * (self.before[0] + F))
        u = self.fluid.velocity(P)
        if self.correct:
            u -= own_disturbance(x, -F, self.molecule, self.fluid.eta, self.fluid.smear)
        self.give(u)
        self.before = F, x

    def grain_momentum(self):
        return (self.gather("rmass", 1) * self.gather("v", 3)).sum(axis=0)
