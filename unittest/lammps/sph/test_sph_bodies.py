"""Walls and bodies that move: each has the pressure that its own acceleration asks for; a box floats where Archimedes
has it, and heaves as linear theory says."""
import os
import re
import sys

import numpy as np
import pytest

from host import at_most
from sph_tools import by_id, fix_by_id, mpirun, run, start
from test_sph_input import message

EXAMPLE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "examples", "floating_box")
sys.path.insert(0, EXAMPLE)

FLOORS = """
units lj
dimension 2
atom_style sph
atom_modify map array
boundary p f p
lattice sq 400 origin 0.5 0.5 0
region all block 0 0.5 -0.2 3 -0.025 0.025 units box
create_box 3 all
region low block INF INF -0.2 0.3 INF INF units box
region high block INF INF 1.5 2 INF INF units box
create_atoms 1 region low
create_atoms 1 region high
region under block INF INF -0.2 0 INF INF units box
region shelf block INF INF 1.5 1.7 INF INF units box
set region under type 2
set region shelf type 3
group water type 1
group under type 2
group shelf type 3
group walls type 2 3
mass * 0.0025
set group all sph/rho 1
neighbor 0.03 bin
neigh_modify delay 0 every 1 exclude type 2 2 exclude type 3 3
pair_style sph/artVisc/tensCorr wendland 0.1 artVisc 1 0 1e-4
pair_coeff * * c 20
fix eos all sph/pressure Tait $(400/7) 1 7
fix density all sph/density/continuity delta 0.1
fix move water nve/sph
fix g water gravity 1 vector 0 -1 0
fix wall walls wall/adami/sph gravity 0 -1 0 slip yes own_acceleration {own}
variable o equal 0
variable y equal 0.5*2*(step*dt)^2
variable v equal 2*step*dt
fix lift shelf move variable v_o v_y NULL v_o v_v NULL
fix flat all enforce2d
timestep 0.001
"""


def test_each_wall_has_the_pressure_of_its_own_acceleration():
    """Two floors with water: one at rest, one that is lifted with twice gravity. Pressure grows into a floor as in the
    water over it."""
    lmp = start()
    run(lmp, FLOORS.format(own="yes") + "run 500 post no")
    y, P, types = by_id(lmp, "x", 3)[:, 1], fix_by_id(lmp, "eos"), by_id(lmp, "type")
    for kind, expected in ((2, 1.0), (3, 3.0)):
        rows = np.sort(np.unique(y[types == kind].round(6)))[-2:]
        low, high = [P[(types == kind) & (np.abs(y - row) < 1e-3)].mean() for row in rows]
        assert (low - high) / 0.05 == pytest.approx(expected, rel=0.05), kind
    lmp.close()




def test_water_stays_in_its_plane_beside_walls_that_do_not():
    """Two dimensions: fix rigid turns its particles out of the plane by 1e-17. With shift the water followed, and z
    grew four times in every 200 steps of calm water, and in every 2 of an impact."""
    lmp = start()
    scene = FLOORS.replace("wendland 0.1 artVisc 1 0 1e-4",
                           "wendland 0.1 viscosity 0.01 central shift yes").format(own="yes")
    run(lmp, scene + "velocity water create 1e-4 4711\nrun 0 post no")
    n = lmp.extract_global("nlocal")
    x, wall = lmp.numpy.extract_atom("x", nelem=n,
                                     dim=3)[:n], np.ravel(lmp.numpy.extract_atom("type", nelem=n))[:n] != 1
    x[wall, 2] = 1e-9           # a command that moves atoms keeps them in the plane since 2024
    run(lmp, "run 100 post no")
    z, water = by_id(lmp, "x", 3)[:, 2], by_id(lmp, "type") == 1
    assert np.abs(z[~water]).max() > 0 and np.abs(z[water]).max() == 0
    lmp.close()


def test_moving_walls_on_any_number_of_ranks_and_over_restarts(tmp_path):
    scene = (FLOORS.format(own="yes") + "fix swing under move wiggle 0.02 0.01 0 0.3 units box\n"
                                        "compute E water sph/energy\n")
    scene = re.sub("variable [oyv] .*\n|fix lift .*\n", "", scene)
    dump = "dump d all custom 100 %s.dump.* x y vx vy f_eos\ndump_modify d format float %%.17g\nrun %d post no\n"

    def go(name, ranks, text):
        done = mpirun(ranks, text, tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
        rows = np.loadtxt(tmp_path / (name + ".dump.100"), skiprows=9)
        return rows[np.lexsort((rows[:, 1].round(7), rows[:, 0].round(7)))]
    first = go("one", 1, scene + dump % ("one", 100))
    assert np.abs(go("three", at_most(3), scene + dump % ("three", 100)) - first).max() <= 1e-12 * np.abs(first).max()
    done = mpirun(1, scene + "run 60\nwrite_restart half\nrun 10\n", tmp_path)
    assert done.returncode == 0, done.stdout
    fixes = "\n".join(line for line in scene.splitlines() if line.startswith(("fix", "neigh", "timestep", "compute")))
    again = go("again", 2, "atom_modify map array\nread_restart half\n" + fixes + "\n" + dump % ("again", 40))
    assert np.abs(again - first).max() <= 1e-12 * np.abs(first).max()


def test_a_floating_box_heaves_as_linear_theory_says(tmp_path):
    """4 particles high: the period within 4 %, from the first to the fourth passage of its new place."""
    import linear

    done = mpirun(1, open(os.path.join(EXAMPLE, "in.floating_box")).read().replace("index 40", "index 20").replace(
        "density index 0.5", "density index 0.75")
                  .replace("thermo        $(floor(0.02/dt))",
                           "thermo 1").replace("thermo_style  custom step time v_y c_gauge[1] f_float[1][8] c_E[4]",
                                               "thermo_style custom time v_y")
                  .replace("time    index 3", "time index 6"), tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    rows = np.array([[float(w) for w in line.split()] for line in done.stdout.splitlines()
                     if re.fullmatch(r"\s*[\d.e+-]+\s+0\.[45]\d*\s*", line)])

    def passages(t, z):
        u = z - z[0] + 0.035
        k = np.nonzero(u[:-1] * u[1:] < 0)[0]
        return (t[k] + u[k] * (t[k + 1] - t[k]) / (u[k] - u[k + 1]))[:4]
    mine, exact = passages(*rows.T), passages(*linear.heave(0.045, 0.03, T=6))
    assert mine[3] - mine[0] == pytest.approx(exact[3] - exact[0], rel=0.04)


def test_a_body_that_begins_with_the_speed_of_the_water_keeps_it(tmp_path):
    """Tank, water and body move at one speed; that of the body stands in the infile of fix rigid, and its particles get
    it after the setup. No acceleration: plain scheme, walls that slip, so that nothing but a wrong pressure could take
    speed along x from the body."""
    changes = [("index 40", "index 20"), (" shift yes", ""),
               ("block $(-v_layers) $(1+v_layers)", "block $(-v_layers) $(2+v_layers)"),
               ("tank  block 0 1 0 1 INF INF units box side out",
                "outer block $(-v_layers) $(1+v_layers) INF INF INF INF units box\n"
                "region inner block 0 1 0 1 INF INF units box side out\nregion tank intersect 2 outer inner"),
               ("neighbor      ", "set type 1*2 vx 0.3\nneighbor "), ("0.13/12) 0 0 0 0 0", "0.13/12) 0 0 0 0.3 0"),
               ("fix           flat", "group tank type 2\nfix drive tank move linear 0.3 0 0 units box\nfix flat")]
    text = open(os.path.join(EXAMPLE, "in.floating_box")).read()
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    done = mpirun(1, text[:text.index("dump ")] + "run 100\nprint \"speed $(f_float[1][4]:%.17g)\"\n", tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert float(re.search(r"\nspeed (\S+)", done.stdout).group(1)) == pytest.approx(0.3, abs=1e-10)


def test_own_acceleration_maybe():
    assert "'maybe' is none of: no, yes" in message(FLOORS.format(own="maybe"))


SHAKEN = """
units lj
dimension 2
atom_style sph
atom_modify map array
boundary f f p
lattice sq 256 origin 0.5 0.5 0
region box block -0.25 1.25 -0.75 0.75 -0.03125 0.03125 units box
create_box 3 box
create_atoms 2 box
region in block 0 1 -0.5 0.5 INF INF units box
set region in type 1
region disk cylinder z 0.5 0 0.2 INF INF units box
set region disk type 3
mass * 0.00390625
group water type 1
group walls type 2 3
group disk type 3
set group all sph/rho 1
displace_atoms water random 0.0006 0.0006 0 4711 units box
pair_style sph/artVisc/tensCorr wendland 0.125 viscosity 1e-3 central {scheme}
pair_coeff * * c 10
fix eos all sph/pressure Tait $(100/7) 1 7 {background}
fix density all sph/density/continuity delta 0.1
fix wall walls wall/adami/sph own_acceleration yes slip yes
fix move water nve/sph
variable z equal 0
variable y equal 0.01*(1-cos(4*PI*step*dt))
variable v equal 0.04*PI*sin(4*PI*step*dt)
fix go disk move variable v_z v_y NULL v_z v_v NULL
fix flat all enforce2d
neighbor 0.02 bin
neigh_modify delay 0 every 1 exclude type 2 2 exclude type 3 3 exclude type 2 3
timestep 3e-3
"""


@pytest.mark.parametrize("scheme", ["correction yes", "shift yes", "shift pliant"])
def test_a_body_does_not_feel_the_background_pressure(scheme):
    """With correction it took a part of the added mass that grew with P0: 11 % at P0 = 50 rho a R, 24 % at 100; with
    shift it pushed the water as well, which added some."""
    loads = []
    for background in (0.0, 2.0):
        lmp = start()
        run(lmp, SHAKEN.format(background=background, scheme=scheme) + "run 30 post no")
        F, disk = by_id(lmp, "f", 3), by_id(lmp, "type") == 3
        loads.append(F[disk, 1].sum())
        lmp.close()
    assert abs(loads[0]) > 0.01 and loads[1] == pytest.approx(loads[0], rel=1e-7)


def test_rates_of_the_first_set_up_are_those_of_the_next():
    """They see the densities that walls take from the fluid, not those of the input: 2.5 % of the largest rate apart
    before, with delta."""
    lmp = start()
    run(lmp, FLOORS.format(own="yes") + "velocity water create 1e-4 4711\nset group walls sph/rho 1.02\nrun 0 post no")
    first = fix_by_id(lmp, "density")
    run(lmp, "run 0 post no")
    assert np.abs(first).max() > 0 and np.abs(first - fix_by_id(lmp, "density")).max() < 1e-10 * np.abs(first).max()
    lmp.close()


DEEP = """
    units si
    dimension 2
    atom_style sph
    boundary f f p
    lattice sq 0.02 origin 0.5 0.5 0
    region all block -0.08 0.68 -0.08 0.7 -0.01 0.01 units box
    create_box 3 all
    region tank block 0 0.6 0 0.7 INF INF units box side out
    region ball cylinder z 0.3 {y} 0.08 INF INF units box
    region water block 0 0.6 0 0.6 INF INF units box
    create_atoms 2 region tank
    create_atoms 1 region water
    set region ball type 3
    mass * 0.4
    group water type 1
    group ball type 3
    group walls type 2 3
    variable rho atom 1000*(1+7*9.81/30^2*(0.6-y)*(y<0.6))^(1/7)
    set group all sph/rho v_rho
    neighbor 0.006 bin
    neigh_modify delay 0 every 1 exclude type 2 2 exclude type 3 3 exclude type 2 3
    pair_style sph/artVisc/tensCorr wendland $({h}*0.02) viscosity 1e-3 central {more}
    pair_coeff * * c 30
    fix eos all sph/pressure Tait $(30^2*1000/7) 1000 7 tension no
    fix density all sph/density/continuity delta 0.1
    fix wall walls wall/adami/sph gravity 0 -9.81 0 own_acceleration yes
    fix move water nve/sph
    fix g water gravity 9.81 vector 0 -1 0
    variable M equal {s}*0.4*count(ball)
    print "1" file ball.txt
    print "1 $M 0.3 {y} 0 $(v_M*0.0016) $(v_M*0.0016) $(v_M*0.0032) 0 0 0 0 0 0 0 0 0 0 0 0" append ball.txt
    fix float ball rigid single infile ball.txt gravity g force 1 on on off torque 1 off off on
    timestep 1e-4
    run 0
"""


@pytest.mark.parametrize("s, y, h, held", [(0.98, 0.2, 2, True), (0.5, 0.2, 2, False), (0.995, 0.2, 3, True),
                                           (0.94, 0.2, 3, False), (1.02, 0.2, 2, True), (0.9, 0.2, 2, False),
                                           (0.98, 0.5, 2, False)])
def test_a_body_that_the_arrangement_of_particles_holds_is_warned_of(s, y, h, held, tmp_path):
    """Its weight less that of the water, |1-s| rho g V, is weighed against 2 pi G L, G = 0.002 P (2 dx/h)^3, L^2 = V:
    at the depth 0.4 the first is less where |1-s| < 0.035 for h of 2 spacings and 0.0104 for 3, at the depth 0.1 where
    it is less than 0.009."""
    done = mpirun(1, DEEP.format(s=s, y=y, h=h, more="shift pliant"), tmp_path)
    assert done.returncode == 0, done.stdout
    assert ("body 1 of fix float is moved by" in done.stdout) is held
    if held and s == 0.98:
        weight, pressure, resists = map(float,
                                        re.search(r"is moved by (\S+), .*under the pressure (\S+) "
                                                  r".*\n?.*resists with (\S+)", done.stdout).groups())
        V = weight / (0.02 * 9810)
        assert V == pytest.approx(np.pi * 0.08**2, rel=0.05) and pressure == pytest.approx(9810 * 0.4, rel=0.02)
        assert resists == pytest.approx(2 * np.pi * 0.002 * pressure * V**0.5, rel=1e-4)


@pytest.mark.parametrize("more, part", [("", 0.01), ("shift yes", 0.01), ("shift pliant", 0.002)])
def test_unless_shift_is_pliant_the_arrangement_holds_five_times_as_much(more, part, tmp_path):
    done = mpirun(1, DEEP.format(s=0.995, y=0.2, h=2, more=more), tmp_path)
    assert done.returncode == 0, done.stdout
    pressure, resists, cure = re.search(r"under the pressure (\S+) .*\n?.*resists with (\S+) when .*stay; use (.*)",
                                        done.stdout).groups()
    assert float(resists) == pytest.approx(2 * np.pi * part * float(pressure) * (0.02**2 * 52) ** 0.5, rel=0.05)
    assert cure.startswith("h = 3 dx" if "pliant" in more else "shift pliant, or h = 3 dx")


SHEARED = """
    units lj
    dimension 2
    atom_style sph
    atom_modify map array
    boundary p p p
    lattice sq 1600 origin 0.5 0.5 0
    region box block 0 1 0 1 -0.0125 0.0125 units box
    create_box 1 box
    create_atoms 1 box
    mass 1 0.000625
    set group all sph/rho 1
    displace_atoms all random {jitter} {jitter} 0 4711 units box
    variable u atom {u}*sin(2*PI*y)
    displace_atoms all move v_u 0 0 units box
    neighbor 0.01 bin
    pair_style sph/artVisc/tensCorr wendland 0.05 {more}
    pair_coeff * * c 10
    fix eos all sph/pressure Tait $(100/7) $((1+3*7/100)^(-1/7)) 7    # 3 at the density 1
    fix density all sph/density/continuity {density}
    fix move all nve/sph
    timestep 1e-3
    run 0
"""


@pytest.mark.parametrize("jitter", [0, 0.003])
def test_with_pliant_shift_rows_under_pressure_do_not_resist_shear(jitter):
    """A wave u = 0.002 sin(2 pi y) that shears a lattice under the pressure 3: F = - V G u'' with G = 0.0036 P in the
    plain scheme, in which a body that is nearly as heavy as the water comes to rest. With pliant shift it is a
    thirtieth, and the forces have the sum 0."""
    def modulus(more, density):
        F = []
        for u in (0.0, 0.002):
            lmp = start()
            run(lmp, SHEARED.format(u=u, jitter=jitter, more=more, density=density))
            F.append(by_id(lmp, "f", 3))
            y = by_id(lmp, "x", 3)[:, 1]
            lmp.close()
        assert np.abs(F[1].sum(0)).max() < 1e-12
        wave = np.sin(2 * np.pi * y)
        return -((F[1] - F[0])[:, 0] * wave).sum() / (wave**2).sum() / (0.000625 * 4 * np.pi**2 * 0.002) / 3
    assert modulus("artVisc 0 0 0.01", "") == pytest.approx(0.0036, rel=0.05)
    assert modulus("shift yes", "delta 0.1") == pytest.approx(0.0036, rel=0.05)
    assert modulus("shift pliant", "delta 0.1") == pytest.approx(0.0001, abs=0.00003)


def test_pliant_shift_is_shift_where_the_surface_cuts_every_support():
    """A patch of 5 x 5 particles under pressure: B says more of the cut than of the arrangement, and is 1."""
    F = []
    for more in ("shift yes", "shift pliant"):
        lmp = start()
        patch = SHEARED.format(u=0.002, jitter=0.003, more=more, density="delta 0.1").replace(
            "create_atoms 1 box", "region five block 0.4 0.524 0.4 0.524 INF INF "
                                                                                              "units box\n"
                                  "    create_atoms 1 region five")
        run(lmp, patch)
        F.append(by_id(lmp, "f", 3))
        lmp.close()
    assert len(F[0]) == 25 and np.abs(F[0]).max() > 0.01
    assert np.abs(F[1] - F[0]).max() < 1e-12 * np.abs(F[0]).max()


def test_pliant_shift_and_two_fluids():
    found = message(SHEARED.format(u=0, jitter=0, more="shift pliant", density="delta 0.1 volume yes"))
    assert "shift pliant does not go with volume yes of fix sph/density/continuity: use shift yes" in found
