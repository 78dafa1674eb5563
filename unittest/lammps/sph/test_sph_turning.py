"""Walls that turn: water turns with its vessel; with viscosity laplacian the torque on walls is wrong, so it is refused
beside them; with central it is right."""
import numpy as np
import pytest

from host import at_most
from sph_tools import by_id, mpirun, read_dump, run, start
from test_sph_input import message

# Taylor-Couette flow between radii 1 and 2, the shaft has the angular velocity 1; n particles over the gap.
COUETTE = """
units lj
dimension 2
atom_style sph
atom_modify map array
boundary f f p
variable n index {n}
lattice sq $(v_n*v_n) origin 0.5 0.5 0
region all block -2.6 2.6 -2.6 2.6 $(-0.5/v_n) $(0.5/v_n) units box
create_box 3 all
region hole cylinder z 0 0 1 INF INF units box side out
region rod cylinder z 0 0 1 INF INF units box
region bore cylinder z 0 0 $(1-4/v_n) INF INF units box side out
region shaft intersect 2 rod bore
region inside cylinder z 0 0 2 INF INF units box
region gap intersect 2 hole inside
region outside cylinder z 0 0 2 INF INF units box side out
region rim cylinder z 0 0 $(2+4/v_n) INF INF units box
region case intersect 2 outside rim
create_atoms 1 region gap
create_atoms 2 region shaft
create_atoms 3 region case
group water type 1
group shaft type 2
group case type 3
group walls type 2 3
mass * $(1/v_n^2)
set group all sph/rho 1
neighbor $(0.3/v_n) bin
neigh_modify delay 0 every 1 {exclude}
pair_style sph/artVisc/tensCorr wendland $(2/v_n) viscosity 0.2 {form}
pair_coeff * * c 20
fix eos all sph/pressure Tait $(400/7) 1 7
fix density all sph/density/continuity delta 0.1
fix move water nve/sph
fix wall walls wall/adami/sph {slip}
variable w atom (4/(x*x+y*y)-1)/3
variable vx atom -v_w*y
variable vy atom v_w*x
velocity water set v_vx v_vy 0
variable zero equal 0
{motion}
fix flat all enforce2d
timestep $(0.015/v_n)
"""
TURNS = "fix turn shaft move rotate 0 0 0 0 0 1 %.15g" % (2 * np.pi)
REST = "velocity shaft set 0 0 0"
REFUSED = ("Fix wall/adami/sph: step %s: the wall turns: beside it, 'viscosity mu laplacian' of pair_style "
           "sph/artVisc/tensCorr")


def scene(motion, form="laplacian shift yes", n=8, slip="", exclude=""):
    return COUETTE.format(motion=motion, form=form, n=n, slip=slip, exclude=exclude)


@pytest.mark.parametrize("exclude", ["", "exclude group walls walls"])
@pytest.mark.parametrize("form", ["laplacian shift yes", "laplacian correction yes", "laplacian"])
def test_laplacian_is_refused_beside_a_wall_that_turns(form, exclude):
    assert REFUSED % 1 in message(scene(TURNS, form, exclude=exclude) + "run 2")


@pytest.mark.ranks(2)
def test_it_is_refused_on_every_rank(tmp_path):
    out = mpirun(at_most(3), scene(TURNS) + "run 2", tmp_path)
    assert out.returncode and REFUSED % 1 in out.stdout + out.stderr


def test_it_is_refused_when_the_wall_begins_to_turn():
    """A shaft at rest that begins to turn as t^2 in the midst of a run."""
    angle = "variable a equal (step>200)*((step-200)*dt)^2\nvariable da equal (step>200)*2*(step-200)*dt\n"
    late = angle + "\n".join((
        "variable r0x atom x", "variable r0y atom y", "fix at shaft store/state 0 v_r0x v_r0y",
        "variable ux atom f_at[1]*(cos(v_a)-1)-f_at[2]*sin(v_a)",
        "variable uy atom f_at[1]*sin(v_a)+f_at[2]*(cos(v_a)-1)",
        "variable sx atom -v_da*(f_at[1]*sin(v_a)+f_at[2]*cos(v_a))",
        "variable sy atom v_da*(f_at[1]*cos(v_a)-f_at[2]*sin(v_a))",
        "fix turn shaft move variable v_ux v_uy NULL v_sx v_sy NULL"))
    said = message(scene(late) + "run 600")
    assert REFUSED.split("%s")[1] in said and int(said.split("step ")[1].split(":")[0]) > 200


@pytest.mark.parametrize("motion, slip, n", [
    ("fix turn shaft move linear 0.3 0.1 0", "", 8), (REST, "", 8), (TURNS, "slip yes", 8),
    ("fix turn shaft move wiggle 0.05 0 0 0.5", "", 8),
    # water in the gap has both walls in its support, which slide past each other
    ("fix turn shaft move linear 0.3 0 0\nfix push case move linear -0.3 0 0", "", 5)])
def test_walls_that_do_not_turn_may_have_laplacian(motion, slip, n):
    lmp = start()
    run(lmp, scene(motion, slip=slip, n=n) + "run 20")
    assert np.isfinite(by_id(lmp, "f", 3)).all()
    lmp.close()


def test_a_rigid_body_that_turns_is_refused_and_one_that_only_sinks_is_not():
    body = "neigh_modify exclude group shaft shaft\nfix turn shaft rigid single %s\nvelocity shaft set 0 -0.2 0\n"
    sinks = scene(body % "torque 1 off off off" + "velocity water set 0 0 0\n") + "run 60"
    assert message(sinks) == "no error"
    turned = scene(body % "force 1 off off off torque 1 off off on") + "run 60"
    assert REFUSED.split("%s")[1] in message(turned)


def test_the_torque_of_central_is_that_of_taylor_couette():
    """4 pi mu w R1^2 R2^2 / (R2^2 - R1^2) on both walls, from the exact flow on."""
    lmp = start()
    run(lmp, scene(TURNS, "central correction yes", n=14) + """
variable torque atom x*fy-y*fx
compute on_shaft shaft reduce sum v_torque
compute on_case case reduce sum v_torque
run 700 post no
fix mean all ave/time 1 700 700 c_on_shaft c_on_case
thermo_style custom step c_on_shaft c_on_case
run 700 post no""")
    exact = 0.2 * 4 * np.pi * 4 / 3
    shaft, case = (lmp.extract_fix("mean", 0, 1, k) / exact for k in (0, 1))
    lmp.close()
    assert shaft == pytest.approx(-1, abs=0.02)
    assert case == pytest.approx(1, abs=0.02)


VESSEL = """
units lj
dimension 2
atom_style sph
atom_modify map array
boundary f f p
lattice sq 400 origin 0.5 0.5 0
region all block -1 1 -1 1 -0.025 0.025 units box
create_box 2 all
region inside cylinder z 0 0 0.5 INF INF units box
region outside cylinder z 0 0 0.5 INF INF units box side out
region rim cylinder z 0 0 0.7 INF INF units box
region ring intersect 2 outside rim
create_atoms 1 region inside
create_atoms 2 region ring
group water type 1
group ring type 2
mass * 0.0025
variable rho atom 1+0.005*(x*x+y*y)
set group water sph/rho v_rho
set group ring sph/rho 1
neighbor 0.015 bin
neigh_modify delay 0 every 1 exclude type 2 2
pair_style sph/artVisc/tensCorr wendland 0.1 {friction} shift yes
pair_coeff * * c 10
fix eos all sph/pressure Tait $(100/7) 1 7
fix density all sph/density/continuity delta 0.1
fix move water nve/sph
fix wall ring wall/adami/sph own_acceleration yes
fix turn ring move rotate 0 0 0 0 0 1 $(2*PI)
variable vx atom -y
variable vy atom x
velocity water set v_vx v_vy 0
fix flat all enforce2d
timestep 0.0025
"""


@pytest.mark.parametrize("friction", ["viscosity 0.05 central", "artVisc 0.1 0 1e-4"])
def test_water_turns_with_its_vessel(friction):
    """A round vessel, 10 particles over the radius. When friction took the velocity of the water for that in the depth
    of the wall, the water came to turn 6 % faster than the vessel."""
    lmp = start()
    run(lmp, VESSEL.format(friction=friction) + "run 800")
    x, v, water = by_id(lmp, "x", 3), by_id(lmp, "v", 3), by_id(lmp, "type") == 1
    lmp.close()
    speed = (x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0])[water].sum() / (x[water, :2] ** 2).sum()
    assert speed == pytest.approx(1, abs=0.004)


def test_a_turning_wall_on_any_number_of_ranks_and_in_pieces(tmp_path):
    def go(name, ranks, runs):
        text = scene(TURNS, "central shift yes", n=6) + runs
        out = mpirun(ranks, text + f"\nwrite_dump all custom {name} id x y vx vy modify format float %.17g", tmp_path)
        assert out.returncode == 0, out.stdout[-1000:]
        rows = read_dump(tmp_path / name)
        return np.stack([rows[c] for c in ("x", "y", "vx", "vy")], axis=1)

    whole = go("whole", 1, "run 60")
    for name, ranks, runs in (("ranks", at_most(4), "run 60"), ("pieces", 1, "run 23\nrun 37")):
        rows = go(name, ranks, runs)
        # create_atoms numbers atoms by ranks: who is at the same place
        same = np.linalg.norm(rows[:, None, :2] - whole[None, :, :2], axis=-1).argmin(axis=1)
        assert len(set(same)) == len(whole) and np.abs(rows - whole[same]).max() < 1e-11
