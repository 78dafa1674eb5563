"""Energies of SPH scenes, whose balance closes; every output on ranks and over restarts; bad input."""
import numpy as np
import pytest

from host import at_most
from sph_tools import mpirun, read_dump, run, start
from test_sph_input import message

BEGIN = """
units lj
dimension 2
atom_style sph
atom_modify map array
"""
COLUMN = BEGIN + """
boundary f f p
lattice sq 100 origin 0.5 0.5 0
region all block -0.4 2.4 -0.4 2 -0.05 0.05 units box
create_box 2 all
region water block 0 1 0 1 INF INF units box
region tank block 0 2 0 2 INF INF units box side out
create_atoms 1 region water
create_atoms 2 region tank
mass * 0.01
group water type 1
group tank type 2
variable rho atom (1+7/400*(1-y))^(1/7)
set group all sph/rho 1
set group water sph/rho v_rho
"""
FLOW = """
neighbor 0.03 bin
neigh_modify delay 0 every 1 exclude type 2 2
{pair}
fix eos all sph/pressure Tait $(400/7) 1 7
fix density all sph/density/continuity {density}
fix tank tank wall/adami/sph gravity 0 -1 0 slip no
fix move water nve/sph
fix gravity water gravity 1 vector 0 -1 0
fix flat all enforce2d
compute E water sph/energy
compute P all sph/probe pressure 0.5 0.5 0 pressure 0 0.3 0 height y 0.5 0 0 height y 1.9 0 0
compute S water sph/surface/atom
compute top water reduce sum c_S[2]
variable balance equal c_E+c_E[4]-c_E[6]
thermo_style custom step c_E c_E[1] c_E[2] c_E[3] c_E[4] c_E[5] c_E[6] c_E[7] v_balance &
  c_P[1] c_P[2] c_P[3] c_P[4] c_top
thermo_modify norm no format float %.17g
timestep 0.0025
"""
SHIFT = dict(pair="pair_style sph/artVisc/tensCorr wendland 0.2 artVisc 0.02 0 4e-4 viscosity 1e-3 central shift yes\n"
                  "pair_coeff * * c 20",
             density="delta 0.1")
PLAIN = dict(pair="pair_style sph/artVisc/tensCorr wendland 0.2 artVisc 0.02 0 4e-4\npair_coeff * * c 20", density="")


def energy(lmp):
    """Without what is of the surface (test_sph_tension.py)"""
    return np.array(lmp.numpy.extract_compute("E", 0, 1))[:7]


@pytest.mark.parametrize("scheme, tension", [(SHIFT, "yes"), (PLAIN, "yes"), (SHIFT, "no")],
                         ids=["shift", "plain", "no_tension"])
def test_the_balance_of_a_dam_break_closes(scheme, tension):
    """Past the impact on the far wall, to 1e-4 of the energy of the start."""
    lmp = start()
    run(lmp, COLUMN + FLOW.format(**scheme).replace("1 7\n", "1 7 tension %s\n" % tension) + "run 0 post no")
    first = lmp.extract_variable("balance", None, 0)
    for _ in range(4):
        run(lmp, "run 200 post no")
        assert lmp.extract_variable("balance", None, 0) == pytest.approx(first, rel=1e-4)
    kinetic, potential, elastic, dissipated, friction, work, brought = energy(lmp)
    assert kinetic > 0.05 and potential < 0.47 and 0 < friction < dissipated and work == 0 == brought
    lmp.close()


PERIODIC = BEGIN + """
boundary p p p
lattice sq 400 origin 0.5 0.5 0
region all block 0 1 0 1 -0.025 0.025 units box
create_box 1 all
create_atoms 1 box
mass 1 0.0025
set group all sph/rho 1
displace_atoms all random 0.003 0.003 0 11 units box
neighbor 0.02 bin
neigh_modify delay 0 every 1
pair_style sph/artVisc/tensCorr wendland 0.1 {pair}
pair_coeff * * c 10
fix eos all sph/pressure Tait $(100/7) 1 7 {background}
fix density all sph/density/continuity {density}
fix move all nve/sph
compute E all sph/energy
thermo_style custom step c_E c_E[1] c_E[3] c_E[4] c_E[5]
thermo_modify norm no
timestep 0.002
variable u atom 0.3*sin(2*PI*y)
variable w atom 0.3*sin(2*PI*x)
"""


@pytest.mark.parametrize("mu", ["laplacian", "central"])
def test_friction_alone_dissipates_in_the_plain_scheme(mu):
    """Rate and force of the pressure take nothing from each other: without delta and shift all that is lost is the work
    of friction."""
    lmp = start()
    run(lmp, PERIODIC.format(pair="viscosity 0.02 " + mu, density="", background="") + "velocity all set v_u v_w 0\n"
        "run 400 post no")
    kinetic, _, elastic, dissipated, friction, work, _ = energy(lmp)
    assert friction > 0.02 and work == 0
    assert dissipated == pytest.approx(friction, rel=2e-3)
    assert kinetic + elastic + dissipated == pytest.approx(0.045, rel=1e-3)
    lmp.close()


@pytest.mark.parametrize("density, rises", [("", False), ("delta 0.1", True)])
def test_a_sound_wave_loses_energy_to_diffusion_alone(density, rises):
    lmp = start()
    run(lmp, PERIODIC.format(pair="", density=density, background="1") + "variable s atom 0.1*sin(2*PI*x)\n"
        "velocity all set v_s 0 0\nrun 0")
    start_energy = energy(lmp)[0]
    run(lmp, "run 400 post no")
    kinetic, _, elastic, dissipated, friction, _, _ = energy(lmp)
    assert friction == 0
    assert kinetic + elastic + dissipated == pytest.approx(start_energy, rel=1e-3)
    assert (dissipated > 3e-5) == rises and dissipated > -1e-5
    lmp.close()


def test_with_shift_no_energy_belongs_to_a_background_pressure():
    """Its force is P - P0, and the elastic energy is that of it: 1/4 of the kinetic energy would belong to P0 = 3
    otherwise."""
    found = []
    for background in ("", "3"):
        lmp = start()
        run(lmp, PERIODIC.format(pair="shift yes", density="delta 0.1", background=background) +
            "velocity all set v_u v_w 0\nrun 50 post no")
        found.append(energy(lmp)[:5])
        lmp.close()
    assert found[0][2] > 1e-5
    assert found[1] == pytest.approx(found[0], rel=1e-6, abs=1e-9)


FREE = {    # region, velocities, kinetic energy
    "two jets": ("block -0.5 0.5 -0.25 0.25 INF INF", "-0.7*x/abs(x)", "0", 0.5 * 0.49 * 0.5),
    "drop": ("sphere 0 0 0 0.5", "-0.8*x", "0.8*y", 0.25 * 0.64 * 3.141593 / 16),
}


@pytest.mark.parametrize("case", FREE)
def test_the_balance_of_free_surfaces_closes(case):
    """Two blocks of fluid that meet head on, and a drop that is drawn out, without viscosity: diffusion and shift take
    what they lose."""
    region, u, w, start_energy = FREE[case]
    text = BEGIN + """
    boundary f f p
    lattice sq 400 origin 0.5 0.5 0
    region all block -2 2 -2 2 -0.025 0.025 units box
    create_box 1 all
    region fluid %s units box
    create_atoms 1 region fluid
    mass 1 0.0025
    set group all sph/rho 1
    neighbor 0.02 bin
    neigh_modify delay 0 every 1
    pair_style sph/artVisc/tensCorr wendland 0.1 shift yes
    pair_coeff * * c 20
    fix eos all sph/pressure Tait $(400/7) 1 7
    fix density all sph/density/continuity delta 0.1
    fix move all nve/sph
    compute E all sph/energy
    variable u atom %s
    variable w atom %s
    velocity all set v_u v_w 0
    timestep 0.00125
    thermo_style custom step c_E
    run 0 post no
    """ % (region, u, w)
    lmp = start()
    run(lmp, text)
    assert energy(lmp)[0] == pytest.approx(start_energy, rel=0.03)
    begin = energy(lmp)[:4].sum()
    run(lmp, "run 400 post no")
    kinetic, _, elastic, dissipated, friction, _, _ = energy(lmp)
    assert kinetic + elastic + dissipated == pytest.approx(begin, rel=1e-3)
    assert dissipated > 1e-4 and friction == 0
    lmp.close()


JET = BEGIN + """
boundary f f p
lattice sq 400 origin 0.5 0.5 0
region all block -0.4 1.25 -1.4 1.4 -0.025 0.025 units box
create_box 2 all
region jet block -0.4 0.5 -0.25 0.25 INF INF units box
region plate block 1 INF INF INF INF INF units box
create_atoms 1 region jet
create_atoms 2 region plate
mass * 0.0025
group water type 1
group plate type 2
set group all sph/rho 1
set group water vx 1
neighbor 0.015 bin
neigh_modify delay 0 every 1 exclude type 2 2
pair_style sph/artVisc/tensCorr wendland 0.1 viscosity 1e-3 central shift yes
pair_coeff * * c 10
fix eos all sph/pressure Tait $(100/7) 1 7
fix density all sph/density/continuity delta 0.1
fix plate plate wall/adami/sph slip yes
fix in water sph/inlet xlo 0 0.4 velocity 1
fix up water sph/outlet yhi 1 0.4
fix down water sph/outlet ylo -1 0.4
fix move water nve/sph
fix gravity water gravity 0.05 vector 0 -1 0
fix flat all enforce2d
compute E water sph/energy
variable balance equal c_E+c_E[4]-c_E[6]-c_E[7]
thermo_style custom step c_E c_E[4] v_balance
thermo_modify norm no lost warn
thermo 100
timestep 0.0025
"""


def test_the_balance_of_a_jet_on_a_plate_closes():
    """A jet comes in, meets a plate and leaves at both of its ends, to 1e-3 of the energy at the start. Before it meets
    the plate, nothing happens but that particles come in with v^2 / 2 each; later it brings more than it takes along,
    what is dissipated."""
    lmp = start()
    run(lmp, JET + "run 0 post no")
    first = lmp.extract_variable("balance", None, 0)
    assert first == pytest.approx(0.5 * 0.25, rel=1e-3)
    run(lmp, "run 100 post no")
    assert energy(lmp)[6] == pytest.approx(0.5 * lmp.extract_fix("in", 0, 0), rel=0.02)
    assert abs(energy(lmp)[3]) < 1e-4
    for _ in range(3):
        run(lmp, "run 250 post no")
        assert abs(lmp.extract_variable("balance", None, 0) - first) < 1e-3 * first
    dissipated, brought = energy(lmp)[3], energy(lmp)[6]
    gone = [lmp.extract_fix(name, 0, 0) for name in ("up", "down")]
    assert min(gone) > 0.05 and 0.01 < dissipated < brought < 0.5 * lmp.extract_fix("in", 0, 0) - 0.3 * sum(gone)
    lmp.close()


def test_energy_asks_nothing_of_the_order_of_the_input():
    """The compute before the open ends and after them, in a jet whose layers change their velocities."""
    text = JET.replace("block -1.4", "block -0.4").replace("yhi 1 0.4",
                                                           "yhi 0.6 0.4").replace("ylo -1 0.4", "ylo -0.6 0.4")
    text = text.replace("velocity 1", "velocity v_u").replace("fix plate",
                                                              "variable u equal 1+0.1*sin(0.05*step)\nfix plate")
    compute = "compute E water sph/energy\n"
    seen = []
    for scene in (text, text.replace(compute, "").replace("fix plate", compute + "fix plate")):
        lmp = start()
        run(lmp, scene + "run 450 post no")
        seen.append(energy(lmp).copy())
        assert min(lmp.extract_fix(name, 0, 0) for name in ("in", "up", "down")) > 0
        lmp.close()
    assert np.abs(seen[0] - seen[1]).max() < 1e-12 * np.abs(seen[0]).max()


def test_energy_that_comes_and_goes_on_any_number_of_ranks_and_over_restarts(tmp_path):
    row = "print \"out " + " ".join("$(c_E[%d]:%%.17g)" % k for k in range(1, 8)) + "\"\n"

    def go(ranks, text):
        done = mpirun(ranks, text, tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
        return np.array([float(w) for w in done.stdout.split("\nout ")[-1].split("\n")[0].split()])
    short = JET.replace("block -1.4", "block -0.4").replace("yhi 1 0.4",
                                                            "yhi 0.6 0.4").replace("ylo -1 0.4", "ylo -0.6 0.4")
    first = go(1, short + "run 500 post no\n" + row)
    assert first[6] > 0.1 and first[3] > 0.01
    assert np.abs(go(at_most(3), short + "run 500 post no\n" + row) - first).max() <= 1e-12 * np.abs(first).max()
    go(1, short + "restart 300 half\nrun 310 post no\n" + row)
    fixes = "\n".join(line for line in short.splitlines()
                      if line.startswith(("fix", "neigh", "timestep", "compute", "thermo", "variable")))
    again = go(2, "atom_modify map array\nread_restart half.300\n" + fixes + "\nrun 200 post no\n" + row)
    assert np.abs(again - first).max() <= 1e-12 * np.abs(first).max()


def test_the_work_of_a_piston_is_that_of_its_force():
    """A column of water on a floor that is lifted; force times way of fix wall/adami/sph is the work of others."""
    lift = "fix lift tank move linear 0 0.1 0 units box\nfix load all vector 1 f_tank[2]\n"
    lmp = start()
    run(lmp, COLUMN + FLOW.format(**SHIFT) + lift + "run 200 post no")
    loads = np.array([lmp.extract_fix("load", 0, 1, k) for k in range(201)])
    work = energy(lmp)[5]
    # it starts from rest
    assert work == pytest.approx(-0.1 * 0.0025 * (loads.sum() - loads[0] - 0.5 * loads[-1]), rel=1e-9)
    assert work > 0.02
    lmp.close()


DUMPED = ("dump d water custom 60 dump.{n} id c_S[1] c_S[2]\ndump_modify d format float %.17g\n"
          "fix out all print 60 \"{row}\" file out.{n} screen no\n")
ROW = " ".join("$(%s)" % name for name in ["c_E[%d]" % k for k in (1, 2, 3, 4, 5, 6)] +
               ["c_P[%d]" % k for k in (1, 2, 3, 4)])


def numbers(directory, name):
    return np.loadtxt(directory / ("out." + name))[-1]


@pytest.mark.parametrize("scheme", [SHIFT, PLAIN], ids=["shift", "plain"])
def test_ranks_and_restarts_leave_every_output_alone(scheme, tmp_path):
    moving = "fix push tank move linear 0.05 0 0 units box\n"
    begin, end = COLUMN + FLOW.format(**scheme) + moving, DUMPED + "thermo 60\nrun 120 post no\n"

    def go(ranks, script, name):
        done = mpirun(ranks, script.replace("{n}", name).replace("{row}", ROW), tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
        shown = read_dump(tmp_path / ("dump." + name))
        # lattices give other IDs on other ranks
        return numbers(tmp_path, name), np.sort([shown["c_S[1]"], shown["c_S[2]"]])

    first, dump = go(1, begin + end, "one")
    assert (np.abs(first[[0, 1, 2, 3, 4, 5, 6, 8]]) > 0).all()
    other, other_dump = go(at_most(3), begin + end, "three")
    assert np.abs(other - first).max() <= 1e-12 * np.abs(first).max()
    assert np.abs(dump - other_dump).max() <= 1e-12
    go(2, begin + end.replace("run 120", "restart 60 half\nrun 70"), "half")
    fixes = FLOW.format(**dict(scheme, pair="")) + moving
    again, _ = go(2, "atom_modify map array\nread_restart half.60\n" + fixes + end.replace("run 120", "run 60"),
                  "again")
    assert np.abs(again - first).max() <= 1e-12 * np.abs(first).max()


ERRORS = {
    "no probe": ("compute P all sph/probe", "there is no probe: give pressure X Y Z or height AXIS X Y Z"),
    "kind": ("compute P all sph/probe depth 0 0 0", "'depth' is none of: pressure, height"),
    "axis": ("compute P all sph/probe height up 0 0 0", "'up' is none of: x, y, z"),
    "short": ("compute P all sph/probe pressure 0 0", "keyword point of a probe: value missing"),
    "energy": ("compute E all sph/energy potential", "unknown keyword 'potential'"),
    "surface": ("compute S all sph/surface/atom 3", "unknown keyword '3'"),
    # the last is LAMMPS's, of 2025
    "no list": ("compute S all sph/surface/atom\nwrite_dump all custom none.dump c_S[1]",
                "no neighbour list yet|not current|before initialization by a run"),
    "no pair": ("pair_style none\ncompute P all sph/probe pressure 0 0 0\nrun 0",
                "there is no pair_style sph/artVisc/tensCorr"),
    "fix taken": ("fix E_SPH_ENERGY all enforce2d\ncompute E all sph/energy", "the fix ID E_SPH_ENERGY is taken"),
    "fix gone": ("compute E all sph/energy\nthermo_style custom c_E\nunfix E_SPH_ENERGY\nrun 0", "has been deleted"),
}


@pytest.mark.parametrize("case", ERRORS)
def test_bad_input(case, tmp_path, monkeypatch):
    import re

    monkeypatch.chdir(tmp_path)
    text, expected = ERRORS[case]
    assert re.search(expected, message(PERIODIC.format(pair="", density="", background="").split("compute E")[0] +
                                       text))
