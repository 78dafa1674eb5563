"""Open ends: a plug flow passes through as a lattice, mass that came in and went out is what the box has more,
hydrostatic ends leave water at rest, and neither ranks nor restarts matter."""
import numpy as np
import pytest

from host import at_most
from sph_tools import BASIN, by_id, fix_by_id, mpirun, run, start
from test_sph_input import message

PIPE = """
units lj
dimension 2
atom_style sph
atom_modify map array
boundary f p p
lattice sq 100 origin 0.5 0.5 0
region all block -0.7 1.7 0 0.6 -0.05 0.05 units box
create_box 1 all
create_atoms 1 box
mass 1 0.01
set group all sph/rho 1
set group all vx 1
neighbor 0.03 bin
neigh_modify delay 0 every 1
pair_style sph/artVisc/tensCorr wendland 0.2 viscosity 0.05 shift yes
pair_coeff * * c 10
fix eos all sph/pressure Tait $(100/7) 1 7
fix density all sph/density/continuity delta 0.1
fix move all nve/sph
timestep 0.005
thermo_modify lost error
"""
OPEN = ("fix in all sph/inlet xlo 0 0.7 velocity {}\nfix out all sph/outlet xhi 1 0.7 pressure 0\n"
        "fix flat all enforce2d\n")


def test_plug_flow_passes_through_as_a_lattice():
    """2.3 lengths of the flow: all particles are others, and stand as if nothing had happened."""
    lmp = start()
    run(lmp, PIPE + OPEN.format(1) + "run 460 post no")
    x, v, P = by_id(lmp, "x", 3), by_id(lmp, "v", 3), fix_by_id(lmp, "eos")
    inside = (x[:, 0] > 0) & (x[:, 0] < 1)
    assert np.abs(v[inside] - [1, 0, 0]).max() < 1e-9 and np.abs(P[inside]).max() < 1e-7
    assert inside.sum() == 60
    columns = np.sort(x[:, 0])[::6]
    assert np.abs(np.diff(columns) - 0.1).max() < 1e-9
    assert len(np.unique(by_id(lmp, "id"))) == len(x) and by_id(lmp, "id").min() > 0
    passed = [lmp.extract_fix(name, 0, 0) for name in ("in", "out")]
    assert passed[0] == pytest.approx(0.01 * 6 * 23, abs=0.061)
    assert abs(passed[0] - passed[1] - 0.01 * (len(x) - 144)) < 0.07    # a column may be on its way
    lmp.close()


def test_no_mass_is_made_where_the_flow_turns_back():
    """A flow that goes back and forth across the inlet's plane: who has been replaced is not replaced again."""
    lmp = start()
    room = PIPE.replace("block -0.7 1.7", "block -0.9 1.9").replace("create_atoms 1 box", "region full block -0.7 1.7 "
                                                                     "INF INF INF INF units box\n"
                                                                     "create_atoms 1 region full")
    run(lmp, room + "variable u equal 0.5*cos(2*PI*step*dt/0.8)+0.1\nset group all vx 0.6\n" + OPEN.format("v_u") +
        "run 640 post no")
    x = by_id(lmp, "x", 3)[:, 0]
    assert len(x) <= 144 and ((x > 0) & (x < 1)).sum() <= 60
    assert lmp.extract_fix("in", 0, 0) <= 0.01 * 6 * (0.1 * 3.2 / 0.1 + 2)
    lmp.close()


STILL = BASIN + """
region water block INF INF 0 1 INF INF units box
region floor block INF INF INF 0 INF INF units box
create_atoms 1 region water
create_atoms 2 region floor
mass * 0.01
group water type 1
group floor type 2
variable rho atom (1+7/100*(1-y)*(y<1))^(1/7)
set group all sph/rho v_rho
set group water vx 0.5
neighbor 0.03 bin
neigh_modify delay 0 every 1
pair_style sph/artVisc/tensCorr wendland 0.2 artVisc 0.1 0 4e-4 shift yes
pair_coeff * * c 10
fix eos all sph/pressure Tait $(100/7) 1 7
fix density all sph/density/continuity delta 0.1
fix floor floor wall/adami/sph gravity 0 -1 0 slip yes
variable P atom 1-y
fix in water sph/inlet xlo 0 0.7 velocity 0.5 gravity 0 -1 0
fix out water sph/outlet xhi 1 0.7 pressure v_P
fix move water nve/sph
fix g water gravity 1 vector 0 -1 0
fix flat all enforce2d
timestep 0.005
"""


def test_a_river_keeps_its_depth_and_its_speed():
    """Water with a free surface that glides over a floor without friction, hydrostatic at both ends: one length of the
    flow."""
    lmp = start()
    run(lmp, STILL + "run 400 post no")
    x, v, kind, P = by_id(lmp, "x", 3), by_id(lmp, "v", 3), by_id(lmp, "type"), fix_by_id(lmp, "eos")
    inside = (x[:, 0] > 0.2) & (x[:, 0] < 0.8) & (kind == 1)
    assert v[inside, 0].mean() == pytest.approx(0.5, rel=0.02)
    assert x[inside, 1].max() == pytest.approx(0.95, abs=0.05)
    deep = inside & (x[:, 1] < 0.6)
    assert np.polyfit(x[deep, 1], P[deep], 1)[0] == pytest.approx(-1, rel=0.06)
    lmp.close()


@pytest.mark.parametrize("gravity, says", [("gravity 0 -1 0", 0), ("gravity 0 -2 0", 1), ("", 1)])
def test_an_inlet_that_is_told_another_gravity_is_warned_of(tmp_path, gravity, says):
    """Its own, and not that of the floor, which is right."""
    done = mpirun(1, STILL.replace("velocity 0.5 gravity 0 -1 0", "velocity 0.5 " + gravity) + "run 2\n", tmp_path)
    assert done.returncode == 0 and done.stdout.count("keyword gravity has the numbers") == says, done.stdout
    assert done.stdout.count("Fix sph/inlet: keyword gravity has") == says, done.stdout


def test_open_ends_on_any_number_of_ranks_and_over_restarts(tmp_path):
    scene = PIPE + "variable u atom 0.8+0.4*sin(2*PI*y/0.6)\n" + OPEN.format("v_u")
    dump = "dump d all custom 200 %s.dump.* x y vx vy f_eos\ndump_modify d format float %%.17g\nrun %d post no\n"

    def go(name, ranks, text):
        done = mpirun(ranks, text, tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
        rows = np.loadtxt(tmp_path / (name + ".dump.200"), skiprows=9)
        rows = rows[(rows[:, 0] > 0) & (rows[:, 0] < 1)]
        return rows[np.lexsort((rows[:, 1].round(7), rows[:, 0].round(7)))]
    first = go("one", 1, scene + dump % ("one", 200))
    assert np.abs(go("three", at_most(3), scene + dump % ("three", 200)) - first).max() <= 1e-12 * np.abs(first).max()
    done = mpirun(1, scene + "run 123\nwrite_restart half\nrun 10\nvariable a equal f_in\nprint \"in $(v_a:%.17g)\"\n",
                  tmp_path)
    assert done.returncode == 0, done.stdout
    fixes = "\n".join(line for line in scene.splitlines() if line.startswith(("fix", "neigh", "timestep", "variable")))
    again = go("again", 2, "atom_modify map array\nread_restart half\n" + fixes + "\n" + dump % ("again", 77))
    assert np.abs(again - first).max() <= 1e-12 * np.abs(first).max()


@pytest.mark.parametrize("drive", ["pressure 0.3", "flow_rate 0.5"])
def test_what_drives_a_flow_asks_nothing_of_ranks_and_restarts(drive, tmp_path):
    scene = PIPE + OPEN.replace("velocity {}", drive)
    dump = "\nwrite_dump all custom end.dump x y vx vy modify format float %.17g"
    ends = []
    fixes = "\n".join(line for line in scene.splitlines() if line.startswith(("fix", "neigh", "timestep")))
    for name, ranks, text in (("one", 1, scene + "run 200"), ("two", 2, scene + "run 200"),
                              ("restart", 1, scene + "run 123\nwrite_restart half\nclear\n"
                               "plugin load stokesdynplugin.so\natom_modify map array\n"
                               "read_restart half\n" + fixes + "\nrun 77")):
        folder = tmp_path / name
        folder.mkdir()
        done = mpirun(ranks, text + dump, folder)
        assert done.returncode == 0, done.stdout
        rows = np.loadtxt(folder / "end.dump", skiprows=9)
        rows = rows[(rows[:, 0] > 0) & (rows[:, 0] < 1)]
        ends.append(rows[np.lexsort((rows[:, 1].round(7), rows[:, 0].round(7)))])
    assert max(np.abs(end - ends[0]).max() for end in ends[1:]) < 1e-11


@pytest.mark.parametrize("speed", ["equal 0.8+0.3*sin(step*0.07)", "atom 0.8+0.3*sin(step*0.07)*sin(2*PI*y/0.6)"])
def test_a_speed_that_changes_in_time_asks_nothing_of_lists_and_runs(speed):
    """New particles are made when there is a new list: with a skin of a third of a spacing ten steps later than with a
    small one, at the same places. And a run in pieces is the run in one."""
    rows = []
    for skin, runs in (("0.004", "run 200 post no"), ("0.06", "run 200 post no"),
                       ("0.03", "run 77 post no\nrun 123 post no")):
        lmp = start()
        run(lmp, PIPE.replace("neighbor 0.03", "neighbor " + skin).replace(
            "viscosity 0.05", "artVisc 0.2 0 4e-4 viscosity 0.05") + "variable u %s\n" % speed +
            OPEN.format("v_u") + runs)
        x, v = by_id(lmp, "x", 3), by_id(lmp, "v", 3)
        inside = (x[:, 0] > -0.5) & (x[:, 0] < 1)
        rows.append(np.hstack([x[inside], v[inside]])[np.lexsort((x[inside, 1].round(7), x[inside, 0].round(7)))])
        assert lmp.extract_fix("in", 0, 0) > 0.05
        lmp.close()
    assert max(np.abs(rows[0] - other).max() for other in rows[1:]) < 1e-11


def end_of(scene, steps):
    """Places and velocities of the flow, along x and y; the mass that has come in."""
    lmp = start()
    try:
        run(lmp, scene + "run %d post no" % steps)
        x, v = by_id(lmp, "x", 3), by_id(lmp, "v", 3)
        inside = (x[:, 0] > -0.5) & (x[:, 0] < 1)
        order = np.lexsort((x[inside, 1].round(7), x[inside, 0].round(7)))
        return np.hstack([x[inside], v[inside]])[order], lmp.extract_fix("in", 0, 0)
    finally:
        lmp.close()


def test_a_discharge_is_the_speed_that_brings_it():
    """0.48 through a width of 0.6 is the speed 0.8. The mass that comes in is the discharge times the time, but for a
    column."""
    scene = PIPE.replace("all vx 1", "all vx 0.8")
    rows, mass = end_of(scene + OPEN.replace("velocity {}", "flow_rate 0.48"), 300)
    assert np.abs(rows - end_of(scene + OPEN.format(0.8), 300)[0]).max() < 1e-9
    assert mass == pytest.approx(0.48 * 300 * 0.005, abs=0.061)


def test_a_hydrograph_is_the_variable_that_it_describes(tmp_path):
    path = tmp_path / "flood.txt"
    path.write_text("# s   m2/s\n0.2, 0.48\n0.7 0.72\n1.2 0.54 # falls\n")
    scene = PIPE.replace("all vx 1", "all vx 0.8").replace("viscosity 0.05", "artVisc 0.2 0 4e-4 viscosity 0.05")
    t = "step*dt"
    formula = f"variable q equal 0.48+0.48*({t}-0.2)*({t}>0.2)-0.84*({t}-0.7)*({t}>0.7)+0.36*({t}-1.2)*({t}>1.2)\n"
    given = end_of(scene + OPEN.replace("velocity {}", f"flow_rate file {path}"), 200)[0]
    assert np.abs(given - end_of(scene + formula + OPEN.replace("velocity {}", "flow_rate v_q"), 200)[0]).max() < 1e-9
    assert given[:, 3].mean() == pytest.approx((0.72 - 0.18 * 0.3 / 0.5) / 0.6, rel=0.03)    # sound is on its way


@pytest.mark.parametrize("rows, words", [("", "no rows of a time and a discharge"),
                                         ("0 1\n1 2 3\n", "row 2 must have two numbers"),
                                         ("0 1\n0 2\n", "the time 0 does not lie after 0"),
                                         ("0 x\n", "line 1: 'x' is not a finite number")])
def test_what_is_no_hydrograph(rows, words, tmp_path):
    path = tmp_path / "flood.txt"
    path.write_text(rows)
    text = message(PIPE + OPEN.replace("velocity {}", f"flow_rate file {path}") + "run 1")
    assert words in text and "keyword flow_rate" in text


def test_a_hydrograph_goes_on_over_a_restart(tmp_path):
    """Also where LAMMPS begins its time at 0 again; and a second restart does not add the first one's time twice."""
    (tmp_path / "flood.txt").write_text("0 0.48\n0.4 0.72\n0.8 0.3\n1.2 0.6\n")
    scene = PIPE.replace("all vx 1", "all vx 0.8") + OPEN.replace("velocity {}", f"flow_rate file {tmp_path}/flood.txt")
    fixes = "\n".join(line for line in scene.splitlines() if line.startswith(("fix", "neigh", "timestep")))
    text = scene
    for part in ("one", "two"):
        text += (f"run 67\nwrite_restart {tmp_path}/{part}\nclear\nplugin load stokesdynplugin.so\n"
                 "atom_modify map array\n"
                 f"read_restart {tmp_path}/{part}\n{fixes}\n")
    assert np.abs(end_of(text, 66)[0] - end_of(scene, 200)[0]).max() < 1e-11


@pytest.mark.parametrize("steps", range(8, 14))
def test_a_run_may_end_while_particles_stand_beyond_the_end_of_the_box(steps):
    """The outlet deletes them before LAMMPS loses them. Mass that came in and went out is what the box has more."""
    lmp = start()
    run(lmp, PIPE + OPEN.format(1) + "run %d\nrun 20" % steps)
    due = lmp.extract_fix("in", 0, 0) - lmp.extract_fix("out", 0, 0) - 0.01 * (lmp.get_natoms() - 144)
    assert abs(due) < 0.061    # a column may be on its way
    lmp.close()


def test_a_pressure_drives_fluid_in():
    """Without walls nothing holds it: the difference of both pressures over the length is what accelerates it. The
    layers follow and weigh nothing. Each of the two pressures acts a spacing behind its plane: du/dt = 0.3/1.2."""
    rows, mass = end_of(PIPE.replace("all vx 1", "all vx 0.5") + OPEN.replace("velocity {}", "pressure 0.3"), 300)
    flow = rows[(rows[:, 0] > 0.1) & (rows[:, 0] < 0.9)]
    assert flow[:, 3].mean() == pytest.approx(0.5 + 0.25 * 1.5, rel=0.01)
    assert np.abs(flow[:, 4]).max() < 0.02
    assert mass == pytest.approx(0.6 * (0.5 * 1.5 + 0.25 * 1.5**2 / 2), rel=0.08)


def test_flow_that_turns_back_is_stopped_and_said_once(tmp_path):
    """A pressure that drives it out again: it stands at the inlet."""
    done = mpirun(1, PIPE.replace("all vx 1", "all vx 0.2") + OPEN.replace("velocity {}", "pressure -0.4") + "run 300",
                  tmp_path)
    assert done.returncode == 0, done.stdout
    assert (done.stdout + done.stderr).count("the flow turns back at this inlet, which lets nothing out and "
                                             "holds it there") == 1
    assert (done.stdout + done.stderr).count("the flow turns back at this outlet, which has no fluid to give and "
                                             "holds it there") == 1


def test_an_inlet_goes_on_without_particles_that_lammps_has_lost():
    """A drop flies out of a box with boundary f, which `thermo_modify lost ignore` allows: the jet below it goes on as
    without the drop."""
    jet = PIPE.replace("boundary f p p", "boundary f f p").replace("1.7 0 0.6", "1.7 -0.1 0.9")
    jet = jet.replace("lost error", "lost ignore").replace(
        "create_atoms 1 box", "region jet block -0.7 1.7 0 0.6 -0.05 0.05 units box\ncreate_atoms 1 region jet")
    counts = []
    for drop in ("", "create_atoms 1 single 0.5 0.75 0 units box\nset atom 145 sph/rho 1 vy 2\n"):
        lmp = start()
        run(lmp, jet + drop + OPEN.format(1) + "run 200")
        counts.append((len(by_id(lmp, "id")), lmp.get_natoms(), lmp.extract_fix("in", 0, 0)))
        lmp.close()
    assert counts[1] == counts[0] and counts[0][0] == counts[0][1] == 144


def test_new_particles_have_the_size_of_those_that_they_replace():
    lmp = start()
    run(lmp, PIPE.replace("atom_style sph", "atom_style hybrid sph sphere").replace(
        "mass 1 0.01", "set type 1 diameter 0.08\nset type 1 mass 0.01")
        .replace("pair_coeff * * c 10", "pair_coeff * * c 10 deltap 0.1") + OPEN.format(1) + "run 100 post no")
    assert lmp.extract_fix("in", 0, 0) > 0.1
    assert np.ptp(by_id(lmp, "radius")) == 0 and np.ptp(by_id(lmp, "rmass")) == 0
    lmp.close()


@pytest.mark.parametrize("change, words", [
    (("velocity 1", ""), "one of the keywords velocity, flow_rate and pressure is required"),
    (("velocity 1", "velocity 1 flow_rate 2"), "one of the keywords velocity, flow_rate and pressure is required"),
    (("velocity 1", "pressure 1 gravity 0 -1 0"), "keyword gravity does not go with pressure"),
    (("velocity 1", "flow_rate"), "keyword flow_rate: value missing"),
    (("velocity 1", "flow_rate file nowhere.txt"), "keyword flow_rate: cannot read file 'nowhere.txt'"),
    (("xlo 0 0.7", "left 0 0.7"), "'left' is none of: xlo, xhi"),
    (("xlo 0 0.7", "xlo 0 0.9"), "does not fit into the box, which ends at -0.7"),
    (("xlo 0 0.7", "xlo 8 0.7"), "POSITION 8 is outside of the box, which goes from -0.7 to 1.7"),
    (("xhi 1 0.7", "xhi -3 0.7"), "POSITION -3 is outside of the box"),
    (("xlo 0 0.7", "xlo 0 0.5"), "the width 0.5 of the layer is too small"),
    (("xlo 0 0.7", "ylo 0.3 0.3"), "the box must have boundary f beyond the layer, along y"),
    (("fix move all nve/sph", "group some id 1:100\nfix move some nve/sph"),
     "of its group is not moved by fix nve/sph"),
    (("pressure 0", "pressure -20"), "the pressure -20 that is asked of it is not above -14.2857"),
    (("velocity 1", "velocity v_no"), "variable 'no' does not exist"),
])
def test_bad_input(change, words):
    scene = PIPE + OPEN.format(1)
    assert change[0] in scene
    assert words in message(scene.replace(*change) + "run 1")


def test_the_width_that_a_layer_must_have_is_enough():
    """2 * 0.2 + 0.2 is not 0.6 to the last digit."""
    lmp = start()
    run(lmp, PIPE + OPEN.format(1).replace("0.7", "0.6") + "run 0 post no")
    lmp.close()


@pytest.mark.parametrize("other, first", [("sph/inlet xlo 0 0.7 velocity 1", "in"), ("sph/outlet xlo 0 0.7", "in"),
                                          ("sph/inlet xhi 1 0.7 velocity 1", "out")])
def test_two_openings_on_one_layer_are_an_error_that_names_both(other, first):
    """Two inlets made particles at one place, and an inlet with an outlet went on."""
    text = message(PIPE + OPEN.format(1) + f"fix too all {other}\nrun 1")
    assert "stands in the layer of fix" in text and "fix too" in text and f"fix {first} " in text.replace(":", " ")


def test_two_inlets_of_two_groups_share_a_layer():
    half = "region low block INF INF INF 0.3 INF INF units box\ngroup low region low\ngroup high subtract all low\n"
    lmp = start()
    run(lmp, PIPE + half + OPEN.format(1).replace("fix in all", "fix in low") +
        "fix too high sph/inlet xlo 0 0.7 velocity 1\nrun 40 post no")
    assert lmp.extract_fix("in", 0, 0) == pytest.approx(lmp.extract_fix("too", 0, 0)) == pytest.approx(0.06, abs=1e-9)
    lmp.close()


def test_an_empty_layer_is_an_error():
    assert "its layer is empty" in message(PIPE + "region b block -1 0 INF INF INF INF units box\n"
                                                  "delete_atoms region b\n" + OPEN.format(1) + "run 1")


@pytest.mark.parametrize("change", [("xlo 0 0.7", "xlo 1.6 0.7"), ("xhi 1 0.7", "xhi -0.6 0.7")])
def test_a_layer_with_all_of_the_flow_behind_it_is_an_error(change):
    """Nobody comes in or goes out at a layer on the other side of the fluid."""
    part = "INF 0.1" if change[0].startswith("xhi") else "0.8 INF"
    gone = f"region b block {part} INF INF INF INF units box\ndelete_atoms region b\n"
    text = message(PIPE + gone + "\n".join(line for line in OPEN.format(1).replace(*change).splitlines()
                                           if change[1] in line or "flat" in line) + "\nrun 1")
    assert ("all particles of its group stand behind the layer" in text and
            f"FACE {change[1][:3]} is the end of the flow" in text)


def test_new_particles_find_no_atom_id():
    lmp = start()
    run(lmp, PIPE.replace("map array", "map hash") + OPEN.format(1))
    lmp.numpy.extract_atom("id")[0] = 2**31 - 4
    with pytest.raises(RuntimeError, match="there is no atom ID left for 6 new particles: the largest is 2147483644"):
        run(lmp, "run 100")
    lmp.close()
