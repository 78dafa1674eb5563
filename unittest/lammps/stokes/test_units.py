"""The drag in every unit system of LAMMPS: its own convention is that viscosity times length times velocity, times
force->vxmu2f, is a force (pair_style lubricate uses it in every term). The factors below are made of CODATA 2018
constants and of the definitions of the units in LAMMPS's manual, not taken from the program."""
import numpy as np
import pytest

from system import LammpsError, Spheres, lmp, input_lines

AVOGADRO, CHARGE, CALORIE = 6.02214076e23, 1.602176634e-19, 4.184

# SI value of a unit of: length, velocity, viscosity, force
UNITS = {
    "lj": (1.0, 1.0, 1.0, 1.0),
    "si": (1.0, 1.0, 1.0, 1.0),
    "cgs": (1e-2, 1e-2, 0.1, 1e-5),
    "real": (1e-10, 1e-10 / 1e-15, 0.1, 1e3 * CALORIE / AVOGADRO / 1e-10),
    "metal": (1e-10, 1e-10 / 1e-12, 0.1, CHARGE / 1e-10),
    # mass in picograms, nanoseconds; attograms
    "micro": (1e-6, 1e-6 / 1e-6, 1e-15 / (1e-6 * 1e-6), 1e-15 * 1e-6 / 1e-12),
    "nano": (1e-9, 1e-9 / 1e-9, 1e-21 / (1e-9 * 1e-9), 1e-21 * 1e-9 / 1e-18),
}
ETA, A, V = 1.3, 0.7, (0.31, -0.2, 0.15)


@pytest.mark.parametrize("units", list(UNITS))
@pytest.mark.parametrize("style", ["cut_off_distance inf algorithm 2", "clumps_only yes",
                                   "clumps_only yes rigid_clumps yes"])
def test_drag_of_a_sphere_is_stokes_in_every_unit_system(simulation, units, style):
    length, velocity, viscosity, force = UNITS[units]
    sim = simulation(Spheres([(0, 0, 0)], A, V), f"{style} visc {ETA}", units=units).run()
    stokes = -6 * np.pi * ETA * A * np.array(V) * (viscosity * length * velocity / force)
    assert sim.drag[0] == pytest.approx(stokes, rel=2e-5)    # LAMMPS's own constants have six digits


def test_units_electron_as_lammps_converts_them(simulation):
    """LAMMPS's own number: its manual does not say what its unit of viscosity is, and Pa s would give another."""
    sim = simulation(Spheres([(0, 0, 0)], A, V), f"cut_off_distance inf visc {ETA}", units="electron").run()
    stokes = -6 * np.pi * ETA * A * np.array(V)
    assert sim.drag[0] == pytest.approx(3.39893149e1 * stokes, rel=1e-8)


@pytest.mark.parametrize("units", ["si", "real", "metal", "nano"])
def test_limit_of_the_time_step_is_in_the_units_of_time(tmp_path, units):
    """A lone pair far apart: lambda is close to 1 and the limit 2 m/(6 pi eta a), a time; drag may be added explicitly
    below it."""
    spheres = Spheres([(0, 0, 0), (50.0, 0, 0)], A, [V, V])
    length, velocity, viscosity, force = UNITS[units]
    density = 1.7
    lines = input_lines(spheres, f"cut_off_distance inf visc {ETA} algorithm 2", tmp_path / "data", units=units,
                        density=density)
    lines += ["run 0", "variable limit equal f_drag[9]", "print \"limit ${limit}\""]
    said = lmp(tmp_path, lines).text
    limit = float(said.split("limit ")[-1].split()[0])
    from_lammps = lmp(tmp_path, [f"units {units}", "atom_modify map array", "region b block -1 1 -1 1 -1 1",
                                 "create_box 1 b", "mass 1 1.0", "create_atoms 1 single 0 0 0",
                                 "fix push all setforce 1 0 0", "fix 1 all nve", "pair_style zero 1",
                                 "pair_coeff * *", "timestep 1e-9", "run 1", "variable v equal vx[1]",
                                 "print \"gain $(v_v/1e-9:%.12g)\""]).text
    gain = float(from_lammps.split("gain ")[-1].split()[0])    # velocity per time, of a unit mass under a unit force
    vxmu2f = viscosity * length * velocity / force
    mass = density * 4 / 3 * np.pi * A**3
    assert limit == pytest.approx(2 * mass / (6 * np.pi * ETA * A * vxmu2f * gain), rel=0.05)


# SI value of a unit of pressure
PRESSURE = {"lj": 1.0, "si": 1.0, "cgs": 0.1, "real": 101325.0, "metal": 1e5, "micro": 1e-15 / (1e-6 * 1e-12),
            "nano": 1e-21 / (1e-9 * 1e-18)}


@pytest.mark.parametrize("units", list(UNITS))
def test_the_pressure_gradient_in_a_slit_is_a_pressure_over_a_length(simulation, units):
    """That of a force in a closed slit, by the reciprocal theorem: 6/(S H^3) [z (H - z) - a^2/3] F"""
    length, _, _, force = UNITS[units]
    z, H, a = 3.0, 8.0, 1.0
    sim = simulation(Spheres([(0, 0, z)], a), f"cut_off_distance inf visc {ETA} wall zlo 0 zhi {H} flow flux",
                     boundary="p p f", box=[(-5, 5), (-5, 5), (-1, 9)], units=units, fix=False)
    sim.commands("fix pull all addforce 2.0 0 0\nfix move all stokes_dynamics/overdamped").run(0)
    gradient = 6 / (100 * H**3) * (z * (H - z) - a**2 / 3) * 2.0 * force / length**3
    assert sim.lmp.extract_fix("move", 0, 1, nrow=12) * PRESSURE[units] / length == pytest.approx(gradient, rel=2e-5)


def test_the_skin_of_units_si_in_a_box_of_micrometres_is_an_error(simulation):
    """LAMMPS would make 1e7 ghosts of each sphere before it says a word."""
    a = 1e-6
    sim = simulation(Spheres([(0, 0, 0), (4e-6, 0, 0)], a), "cut_off_distance inf visc 1e-3", units="si",
                     boundary="p p p", box=[(-4e-6, 4e-6)] * 3)
    with pytest.raises(LammpsError, match="the skin 0.001 of LAMMPS's command neighbor makes more than 1000 ghosts of "
                                          "each sphere and 1e6 in all .*, such as neighbor 2e-07 bin"):
        sim.run(0)
    sim.command("neighbor 2e-7 bin")
    assert np.isfinite(sim.run(0).drag).all()
