"""What may be wrong with the particles of an SPH scene: it is put right, warned of or refused."""
import pytest

from sph_tools import by_id, fix_by_id, run, start

SQUARE = """
units lj
dimension 2
atom_style sph
lattice sq 144 origin 0.5 0.5 0
region b block 0 1 0 1 -0.04 0.04 units box
create_box 1 b
create_atoms 1 box
mass 1 $(1/144)
set group all sph/rho 1.1
neighbor 0.02 bin
neigh_modify delay 0 every 1
pair_style sph/artVisc/tensCorr wendland $(1/6) viscosity 0.01 central
pair_coeff * * c 10
fix p all sph/pressure Tait $(100*1.1/7) 1.1 7
fix d all sph/density/continuity
fix m all nve/sph
fix e all enforce2d
compute r all sph/rho/atom
compute rho all reduce ave c_r
thermo_style custom step lx c_rho
timestep 0.003
"""


def density(lmp):
    lmp.command("run 0 post no")
    return lmp.extract_compute("rho", 0, 0)


@pytest.mark.parametrize("how, there", [
    ("fix x all deform 1 x scale 0.98 y scale 0.95 remap x", 0.98 * 0.95),
    ("fix x all press/berendsen x 1 1 0.05 y 1 1 0.05 modulus 100", None),
])
def test_density_follows_a_box_that_moves_its_particles(how, there):
    """The mass per volume of the box, by whatever the box is changed."""
    lmp = start()
    run(lmp, SQUARE + how + "\nrun 100 post no\nunfix x\n")
    rho = density(lmp)
    area = lmp.get_thermo("lx") * lmp.get_thermo("ly")
    assert rho * area == pytest.approx(1.1, rel=1e-4)
    if there:
        assert area == pytest.approx(there, rel=1e-9)
    lmp.close()


@pytest.mark.parametrize("remap, factor", [("remap", 1 / 0.9), ("", 1.0)])
def test_density_follows_change_box_only_where_it_moves_particles(remap, factor):
    lmp = start()
    run(lmp, SQUARE.replace("region b block 0 1", "region b block 0 1.2") +
        "region cut block 1 1.2 INF INF INF INF units box\n"
        "delete_atoms region cut\nrun 1 post no\n")
    before = density(lmp)
    run(lmp, "change_box all x scale 0.9 " + remap)
    assert density(lmp) == pytest.approx(before * factor, rel=1e-9)
    lmp.close()


def test_a_particle_made_in_a_run_has_the_density_of_its_equation_of_state():
    lmp = start()
    run(lmp, SQUARE + "region r block 0.3 0.7 0.3 0.7 0 0 units box\nfix in all deposit 1 1 1 77 region r near 0.03\n"
                      "run 3 post no\n")
    assert lmp.get_natoms() == 145
    assert density(lmp) == pytest.approx(1.1, rel=0.05)
    lmp.close()


def test_a_particle_without_density_is_named_before_its_neighbours():
    lmp = start()
    with pytest.raises(Exception, match=r"step [12]: atom 145 has the density 0; it must be a number > 0; "
                                        r"if it was created in this run"):
        run(lmp, SQUARE.replace("fix p all sph/pressure Tait $(100*1.1/7) 1.1 7", "fix p all sph/pressure absolut 10") +
            "region r block 0.3 0.7 0.3 0.7 0 0 units box\nfix in all deposit 1 1 1 77 region r near 0.03\n"
            "run 3 post no\n")
    lmp.close()


def test_planes_one_behind_the_other_are_refused_in_two_dimensions():
    """create_atoms makes them with LAMMPS of 2021 where the box has room; with newer ones they come from elsewhere."""
    lmp = start()
    run(lmp, SQUARE.replace("-0.04 0.04", "-0.2 0.2"))
    lmp.numpy.extract_atom("x")[0, 2] = -0.16
    with pytest.raises(Exception,
                       match="in two dimensions all particles must stand in one plane, and they stand from z = -0.16"):
        run(lmp, "run 0")
    lmp.close()


FLOOR = """
units lj
dimension 2
atom_style sph
boundary p f p
lattice sq 400 origin 0.5 0.5 0
region b block 0 0.5 -0.25 0.5 -0.025 0.025 units box
create_box 2 b
region w block INF INF 0 0.3 INF INF units box
region f block INF INF -0.2 0 INF INF units box
create_atoms 1 region w
create_atoms 2 region f
mass 1 0.0025
mass 2 $(0.0025*v_ratio)
group water type 1
group floor type 2
set group all sph/rho 1
neighbor 0.015 bin
neigh_modify delay 0 every 1 exclude type 2 2
pair_style sph/artVisc/tensCorr wendland 0.1 viscosity 0.001 central
pair_coeff * * c 10
"""
REST = """
fix d all sph/density/continuity delta 0.1 volume {volume}
fix m water nve/sph
fix w floor wall/adami/sph gravity 0 -1 0
fix e all enforce2d
timestep 0.002
run 1 post no
"""


def log_of(tmp_path, text):
    lmp = start()
    lmp.command(f"log {tmp_path}/log")
    run(lmp, text)
    lmp.close()
    return (tmp_path / "log").read_text()


@pytest.mark.parametrize("ratio, warned", [(1, False), (1.05, False), (0.8, True), (2, True)])
def test_walls_of_another_mass_than_the_fluid_are_warned_of(tmp_path, ratio, warned):
    log = log_of(tmp_path, f"variable ratio index {ratio}\n" + FLOOR + "fix p all sph/pressure Tait 14.2857 1 7" +
                 REST.format(volume="no"))
    assert ("and the mass of the fluid particles in front of it differ by more than 10 %" in log) == warned


@pytest.mark.parametrize("scheme, P0, warned", [("shift yes", 0, False), ("shift yes", 2, True),
                                                ("shift pliant", 2, True), ("", 2, False)])
def test_a_surface_under_a_background_pressure_is_warned_of(tmp_path, scheme, P0, warned):
    """P0 > 0 says that shift need not end at a surface."""
    log = log_of(tmp_path, "variable ratio index 1\n" + FLOOR.replace("central", "central " + scheme) +
                 f"fix p all sph/pressure Tait 14.2857 1 7 {P0}" +
                 REST.format(volume="no"))
    assert ("fills its vessel, but atom" in log) == warned


def test_a_wall_takes_the_pressure_of_another_fluid_where_its_own_is_not():
    """volume yes, and the floor in the group of a second fix sph/pressure: it bears the water as the floor of the
    water's own fix does. In a tank that sloshes, fluids come to stand before the walls of each other."""
    loads = []
    for states in ("fix p all sph/pressure Tait 14.2857 1 7",
                   "fix p water sph/pressure Tait 14.2857 1 7\nfix q floor sph/pressure Tait 14.2857 1 7"):
        lmp = start()
        run(lmp, "variable ratio index 1\n" + FLOOR + states + "\nfix g water gravity 1 vector 0 -1 0" +
            REST.format(volume="yes").replace("run 1", "run 100"))
        loads.append([lmp.extract_fix("w", 0, 1, 1), fix_by_id(lmp, "p")[by_id(lmp, "type") == 1].sum()])
        lmp.close()
    assert loads[0][0] < -0.1 and loads[1] == pytest.approx(loads[0], rel=1e-10)


@pytest.mark.parametrize("c, warned", [(10, False), (9.2, False), (5, True), (12, True)])
def test_a_speed_of_sound_that_is_not_the_fluids_is_warned_of(tmp_path, c, warned):
    log = log_of(tmp_path, SQUARE.replace("c 10", f"c {c}") + "run 0 post no\n")
    assert (f"has the speed of sound {c} by pair_coeff c, and 10 by its fix sph/pressure" in log) == warned


@pytest.mark.parametrize("integrator, delta, warned", [("nve/sph", 0.1, False), ("sph", 0, False), ("sph", 0.1, True)])
def test_delta_that_fix_sph_leaves_without_effect_is_warned_of(tmp_path, integrator, delta, warned):
    scene = SQUARE.replace("fix m all nve/sph",
                           f"fix m all {integrator}").replace("continuity", f"continuity delta {delta}")
    assert ("delta of fix sph/density/continuity has no effect with fix sph" in log_of(
        tmp_path, scene + "run 0 post no\n")) == warned


@pytest.mark.parametrize("h, warned", [(0.1, False), (0.2, True)])
def test_widths_that_differ_are_warned_of(tmp_path, h, warned):
    log = log_of(tmp_path, "variable ratio index 1\n" + FLOOR +
                 f"pair_coeff 2 2 c 10 h {h}\nfix p all sph/pressure Tait 14.2857 1 7" +
                 REST.format(volume="no"))
    assert ("types 1 and 2 differ in h" in log) == warned


@pytest.mark.parametrize("rho0, volume, warned", [(1.05, "no", False), (1.2, "no", True), (1.2, "yes", False)])
def test_two_fluids_without_their_volume_are_warned_of(tmp_path, rho0, volume, warned):
    states = f"fix p high sph/pressure Tait 14.2857 1 7\nfix q low sph/pressure Tait 14.2857 {rho0} 7"
    log = log_of(tmp_path, "variable ratio index 1\n" + FLOOR + "region deep block INF INF INF 0.2 INF INF units box\n"
                 "group low region deep\n"
                 "group high subtract all low\n" + states + REST.format(volume=volume))
    assert (f"fix q has rho0 = {rho0}, fix p has rho0 = 1: where these fluids meet" in log) == warned


@pytest.mark.parametrize("dt, style, says", [
    (0.009, "viscosity 0.001 central", ""), (0.011, "viscosity 0.001 central", "is longer than h/c = 0.01,"),
    (0.002, "viscosity 0.62", ""), (0.0021, "viscosity 0.62", "than h^2 rho/(8 mu) = 0.00201613"),
    (0.002, "viscosity 0.27 central", ""), (0.0021, "viscosity 0.27 central", "than h^2 rho/(18 mu) = 0.00205761"),
    (0.0021, "viscosity 0.62 central implicit yes", "")])
def test_a_time_step_that_no_flow_bears_is_warned_of(tmp_path, dt, style, says):
    """h/c is 0.01, h^2 rho/8 is 0.00125, and h^2 rho/18 is 0.000556."""
    rest = REST.format(volume="no").replace("timestep 0.002", f"timestep {dt}").replace("run 1", "run 0")
    log = log_of(tmp_path, "variable ratio index 1\n" + FLOOR.replace("viscosity 0.001 central", style) +
                 "fix p all sph/pressure Tait 14.2857 1 7" + rest)
    assert ("WARNING: Pair style sph/artVisc/tensCorr: " in log) == bool(says) and says in log


def test_a_wall_without_suction_pulls_half_as_much():
    """Water that moves away from its floor, without gravity: half of the pull is the floor's, and without it no wall
    particle has a pressure below 0."""
    pull, least = [], []
    for suction in ("yes", "no"):
        lmp = start()
        scene = (FLOOR + "fix p all sph/pressure Tait 14.2857 1 7" +
                 REST.format(volume="no").replace("0 -1 0", "0 0 0 suction " + suction))
        run(lmp, "variable ratio index 1\n" + scene.replace("run 1 post no",
                                                            "velocity water set 0 0.025 0 units box\nrun 0 post no"))
        forces, pressures = [], []
        for _ in range(8):
            run(lmp, "run 4 post no")
            forces.append(lmp.extract_fix("w", 0, 1, 1))
            pressures.append(fix_by_id(lmp, "p")[by_id(lmp, "type") == 2].min())
        pull.append(max(forces))
        least.append(min(pressures))
        lmp.close()
    assert pull[0] > 0.1 and pull[1] == pytest.approx(pull[0] / 2, rel=0.2)
    assert least[0] < -0.2 and least[1] > -1e-12
