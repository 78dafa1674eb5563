"""fix hydro/vans in runs: momentum, ranks, restart, fluctuations."""
import re

import numpy as np
import pytest
from host import allowed, by_open_mpi
from system import STYLES_OF_TODAY, there
# close_scenes is a fixture
from vans_helper import Scene, bed_script, close_scenes, dump_rows, run_lmp, write_columns  # noqa: F401

N, WATER = 201, "fluid 1000 0.001 gravity 0.4905 0 -9.797 phi_max 0.61"
MESH = f"mesh {N} 0.0003 0 {WATER}"


@pytest.fixture
def profile(tmp_path):
    return write_columns(tmp_path / "u.txt", np.concatenate([[0], 0.6 * np.arange(1, N + 1) / N]))


@pytest.mark.parametrize("keywords", ["", "sidewall 0.03 1", "surface speed 0.7 viscosity einstein",
                                      "turbulence none pressure_gradient -300 viscosity power",
                                      "fluctuation correlated 7 0.01 renewal 0.0004",
                                      "fluctuation langevin 7 0.01 fall_diameter 0.7", "lift 0.2",
                                      "discharge 0.03 adjust depth 0.2 surface follow 0.045", "felt volume",
                                      "felt volume classes yes surface speed 0.7 viscosity power",
                                      "pressure_gradient v_dpdx bed_mixing 0.5 felt volume",
                                      "turbulence ni_capart bed_mixing 0.7 pressure_gradient 50 discharge 0.03 "
                                      "adjust depth 0.2 surface follow 0.045", "discharge 0.02",
                                      "felt volume surface follow 0.045 drag brown_lawler",
                                      "drag ferguson_church added_mass 0.4 upflow 0.002 discharge 0.012 "
                                      "surface follow 0.045 sidewall 0.03 1 wall_roughness 1e-3 wall_mixing yes",
                                      "classes 6 felt volume turbulence rousseau", "average seen",
                                      "mesh 16 0.004 0 profile zero grains point"])
def test_grains_water_bed_and_walls_keep_the_momentum(profile, keywords):
    """Mobile grains + water + what is on its way = start + what came from outside - what the fixed bed took, by drag
    and by contacts. Velocity Verlet gives the force of the first and the last step half a time step each. 1e-12 of all
    that was moved. The group seen has the bed and every other loose grain."""
    mesh = f"{WATER} " if keywords.startswith("mesh") else f"{MESH} profile file {profile} "
    s = Scene.of(bed_script(mesh + keywords, spread=0.5 if "classes 6" in keywords else None))
    s.do("unfix gravity", "group seen id 1:16 17:80:2")

    def of_type(name, k, wanted):
        return s.atoms(name)[s.atoms("type") == wanted, k]

    def account():
        grains = (s.atoms("rmass")[s.atoms("type") == 2] * of_type("v", 0, 2)).sum()
        outside = sum(s.number(k, "vans") for k in ("driving", "bottom", "walls", "surface"))
        moved = sum(abs(s.number(k, "vans")) for k in ("driving", "bottom", "walls", "surface", "momentum"))
        return (grains - s.number("pressed", "vans") + s.number("momentum", "vans") + s.number("transit", "vans") +
                s.number("others", "vans") - outside, moved)

    s.do("run 0")
    start, _ = account()
    contact, before = 0.0, of_type("f", 0, 1).sum()
    for _ in range(400):
        s.do("run 1 pre no post no")
        now = of_type("f", 0, 1).sum()
        contact += 1e-5 * 0.5 * (before + now)
        before = now
    end, moved = account()
    assert moved > 1e-4
    assert abs(end + contact - start) < 1e-12 * moved
    # on its way: no more than the grains take in a few couplings (20 steps)
    assert abs(s.number("transit", "vans")) < 5 * 20 * 1e-5 * np.abs(s.atoms("f_vans")[:, 0]).sum()
    s.close()


def mesh_for(kind):
    """The mesh, and gravity and side walls unless the kind has its own; gravity of a flume that tilts is a variable."""
    if "gravity" not in kind:
        return MESH + " sidewall 0.03 1"
    return MESH.replace("gravity 0.4905 0 -9.797 ", "")


def moving(kind):
    """kind: of the fluctuations, and more keywords"""
    name, _, more = kind.partition(" ")
    return f"fluctuation {name} 4711 0.008 " + ("" if name in ("langevin", "depth") else "renewal 0.001 ") + more


ALL_THAT_MOVES = ("depth felt volume drag brown_lawler hindrance di_felice added_mass 0.4 upflow 0.002 discharge 0.02 "
                  "surface follow 0.045 wall_roughness 1e-3 wall_mixing yes gravity v_gx 0 -9.797 sidewall 0.03 1")
AND_THESE = ("langevin schmidt 0.44 turbulence ni_capart bed_mixing 0.5 pressure_gradient v_dpdx drag schiller_naumann "
             "fall_diameter 0.7 discharge 0.03 adjust depth 0.05 surface follow 0.045 gravity v_gx 0 -9.797 "
             "sidewall 0.03 1")


@pytest.mark.parametrize("kind", by_open_mpi([ALL_THAT_MOVES, AND_THESE, "correlated", "depth", "depth felt volume"],
                                             but=2))
def test_ranks_agree(tmp_path, profile, kind):
    """Positions, velocities, forces and profiles on 2 and 4 ranks as on one, to 1e-10; fluctuations on."""
    result = {}
    for ranks, grid in allowed((1, "1 1 1"), (2, "2 1 1"), (4, "2 1 2")):
        script = bed_script(f"{mesh_for(kind)} profile file {profile} classes yes " + moving(kind), damp=0,
                            processors="processors " + grid)
        script += f"""
fix out all ave/time 100 1 100 f_vans[*] mode vector file profile.{ranks}
thermo_style custom step f_vans[1] f_vans[4] f_vans[6] f_vans[8]
run 400
write_dump all custom dump.{ranks} id x y z vx vy vz f_vans[1] f_vans[2] f_vans[3] f_vans[4] f_vans[5] f_vans[6] &
  modify format float %.17g
"""
        done = run_lmp(tmp_path, script, ranks, name=f"in.{ranks}")
        assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
        result[ranks] = dump_rows(tmp_path / f"dump.{ranks}"), np.loadtxt(
            [x for x in open(tmp_path / f"profile.{ranks}") if len(x.split()) > 2])
    atoms, profiles = result[1]
    assert np.abs(atoms[:, 10:13]).max() > 0.005    # there are fluctuations
    for ranks in allowed(2, 4):
        assert np.array_equal(result[ranks][0][:, 0], atoms[:, 0])
        scale = np.abs(atoms).max(axis=0) + 1e-300
        assert (np.abs(result[ranks][0] - atoms).max(axis=0) / scale).max() < 1e-10
        scale = np.abs(profiles).max(axis=0) + 1e-300
        assert (np.abs(result[ranks][1] - profiles).max(axis=0) / scale).max() < 1e-5    # ave/time prints 6 digits


@pytest.mark.ranks(2)
@pytest.mark.parametrize("kind", ["correlated", "depth", "correlated felt volume", ALL_THAT_MOVES, AND_THESE])
def test_restart_goes_on_as_if_unbroken(tmp_path, profile, kind):
    """Broken at a step that is no coupling step. Contacts without damping: LAMMPS's own contact forces at the first
    step of a run are those of the velocity at full step, others those at half step, so that damped contacts are not the
    same after any restart."""
    script = bed_script(f"{mesh_for(kind)} profile file {profile} " + moving(kind), damp=0)
    output = ("write_dump all custom dump.{0} id x y z vx vy vz f_vans[1] f_vans[2] f_vans[3] f_vans[4] f_vans[5] "
              "f_vans[6] modify format float %.17g\n")
    done = run_lmp(tmp_path, script + "run 150\nwrite_restart half\nrun 250\n" + output.format("split"),
                   name="in.split")
    assert done.returncode == 0, done.stdout[-2000:]
    done = run_lmp(tmp_path, script + "run 400\n" + output.format("whole"), name="in.whole")
    assert done.returncode == 0, done.stdout[-2000:]
    again = (script[:script.index("region box")] + "read_restart half\n" + script[script.index("pair_style"):] +
             "run 250\n" + output.format("again"))
    done = run_lmp(tmp_path, again, 2, name="in.again")
    assert done.returncode == 0, done.stdout[-2000:]
    whole, names = dump_rows(tmp_path / "dump.whole"), ["split", "again"]
    if "v_" not in kind:    # variables know the step
        done = run_lmp(tmp_path, script + "run 150\nreset_timestep 1000150\nrun 250\n" + output.format("reset"),
                       name="in.reset")
        assert done.returncode == 0, done.stdout[-2000:]
        names.append("reset")
    for name in names:
        other = dump_rows(tmp_path / f"dump.{name}")
        assert (np.abs(other - whole).max(axis=0) / (np.abs(whole).max(axis=0) + 1e-300)).max() < 1e-10, name


def test_a_push_after_the_run_is_seen_in_the_restart_file_too(tmp_path):
    """The force of the last step is that of the old velocities: behind the push it counts neither in the script nor
    from the file."""
    script = bed_script(MESH, layers=2)
    output = "run 0\nwrite_dump all custom dump.{0} id f_vans[1] f_vans[2] f_vans[3] modify format float %.17g\n"
    pushed = script + "run 30\nvelocity mobile set 0.5 0 0\n"
    runs = {"here": pushed, "file": pushed + "write_restart half\n",
            "there": script[:script.index("region box")] + "read_restart half\n" + script[script.index("pair_style"):]}
    for name, text in runs.items():
        done = run_lmp(tmp_path, text + output.format(name), name="in." + name)
        assert done.returncode == 0, done.stdout[-2000:]
    here, _, there = (dump_rows(tmp_path / f"dump.{name}") for name in runs)
    assert np.abs(there - here).max() < 1e-10 * np.abs(here[:, 1:]).max()


@pytest.mark.parametrize("keywords", ["gravity v_gx 0 v_gz stream rest",
                                      "gravity 0.4905 0 v_gz stream rest couple one upflow v_up"])
def test_gravity_in_a_run_in_pieces_is_that_of_the_last_coupling(tmp_path, profile, keywords):
    """A variable is read at every coupling: broken between two of them, a run goes on with what it had, from memory and
    from a restart file."""
    variables = "variable gz equal -9.8*(1+100*step*dt)\nvariable up equal 0.01*(1+300*step*dt)\nfix vans"
    script = bed_script(f"mesh {N} 0.0003 0 fluid 1000 0.001 phi_max 0.61 profile file {profile} {keywords}",
                        layers=2).replace("fix vans", variables)
    output = ("write_dump all custom dump.{0} id x y z vx vy vz f_vans[1] f_vans[2] f_vans[3] modify "
              "format float %.17g\n")
    runs = {"whole": script + "run 70\n", "split": script + "run 33\nwrite_restart half\nrun 37\n",
            "again": script[:script.index("region box")] + "read_restart half\n" + script[script.index("pair_style"):] +
            "run 37\n"}
    for name, text in runs.items():
        done = run_lmp(tmp_path, text + output.format(name), name="in." + name)
        assert done.returncode == 0, done.stdout[-2000:]
    whole = dump_rows(tmp_path / "dump.whole")
    for name in ("split", "again"):
        other = dump_rows(tmp_path / f"dump.{name}")
        assert (np.abs(other - whole).max(axis=0) / (np.abs(whole).max(axis=0) + 1e-300)).max() < 1e-10, name


@pytest.mark.parametrize("keywords", ["fluctuation langevin 7 0.01", "fluctuation correlated 7 0.01",
                                      "fluctuation depth 7 0.01", "discharge {}0.02 surface follow 0.045",
                                      "discharge {}0.03 adjust depth 0.2 surface follow 0.045"])
def test_a_stream_along_minus_x_is_the_mirror_image(tmp_path, keywords):
    rows = []
    for sign in (1, -1):
        u = write_columns(tmp_path / "u.txt", sign * np.concatenate([[0], 0.6 * np.arange(1, N + 1) / N]))
        script = bed_script(f"mesh {N} 0.0003 0 fluid 1000 0.001 gravity {sign * 0.4905} 0 -9.797 phi_max 0.61 "
                            f"profile file {u} " + keywords.format("-" if sign < 0 else ""),
                            layers=2).replace("vector 0.05", f"vector {sign * 0.05}")
        if sign < 0:    # grains too
            script = re.sub(r"single (\S+)", lambda m: f"single {0.03 - float(m.group(1)):.17g}", re.sub(
                r" vx (\S+)", lambda m: f" vx {-float(m.group(1)):.17g}", script))
        s = Scene.of(script)
        s.do("run 100")
        rows.append([s.atoms("v"), s.atoms("f_vans"), s.column("u", N, "vans"),
                     [s.number(k, "vans") for k in ("friction_velocity", "shields", "largest_stress", "transport")]])
        s.close()
    mirror = [[-1, 1, 1], [-1, 1, 1, -1, 1, 1], -1, [1, -1, -1, -1]]
    for one, other, sign in zip(*rows, mirror):
        one, other = np.array(one), np.array(other) * sign
        assert (np.abs(one - other).max(axis=0) / (np.abs(one).max(axis=0) + 1e-300)).max() < 1e-9
    assert rows[0][3][0] > 0.01 and ("fluct" not in keywords or np.abs(rows[0][1][:, 3:]).max() > 0.005)


def cloud(n, box, z, diameter, seed=2):
    """Grains at random places that do not touch each other (pair_style zero)."""
    x = np.random.default_rng(seed).uniform([0, 0, z[0]], [box[0], box[1], z[1]], (n, 3))
    return [f"create_atoms 1 single {a:.17g} {b:.17g} {c:.17g} units box" for a, b,
            c in x] + [f"set group all diameter {diameter} density 2500"]


@pytest.mark.parametrize("leave", [False, True])
def test_nothing_stays_on_its_way_when_the_motion_ends(tmp_path, leave):
    """Grains at rest in viscous water that moves: it takes them along, and the bottom stops both within e^-20. The
    water has given what the grains got, and has it back: vector 12 is 0, and what the bottom took is all that there
    was. leave: some grains go, with the momentum that they have, and not with what the last solve had for them."""
    u = write_columns(tmp_path / "u", np.concatenate([[0], 0.1 * np.ones(21)]))
    s = Scene(box=(0, 0.006, 0, 0.006, -0.02, 0.02))
    s.do(*cloud(60, (0.006, 0.006), (0.001, 0.0045), 0.001))
    s.do("timestep 2e-4", "fix h all hydro/vans 5 mesh 21 0.00025 0 fluid 1000 0.1 gravity 0 0 -1e-9 turbulence none "
                          f"profile file {u}", "fix m all nve/sphere", "run 0")
    start = s.number("momentum")
    s.do("run 100")
    assert (s.atoms("rmass") * s.atoms("v")[:, 0]).sum() > 0.05 * start
    gone = 0.0
    if leave:
        gone = (s.atoms("rmass") * s.atoms("v")[:, 0])[:20].sum()
        s.do("group gone id 1:20", "delete_atoms group gone")
    s.do("run 15000")
    assert abs(s.number("momentum")) < 1e-8 * start
    assert abs(s.number("transit")) < 1e-8 * start
    assert abs((s.number("bottom") + s.number("surface") - gone) / start + 1) < 1e-8
    s.close()


COUPLED = """units si
plugin load stokesdynplugin.so
atom_style sphere
boundary p p f
comm_modify vel yes
region b block 0 {w} 0 {w} {low} {high} units box
create_box 1 b
{grains}
pair_style zero {d}
pair_coeff * *
neighbor {d} bin
neigh_modify one 10000 page 100000
timestep {dt}
fix h all hydro/vans {every} mesh 41 {dz} 0 fluid 1000 0.001 gravity 0.5 0 -9.8 {keywords}
run 1
"""


def bed_of_specks(d, every, keywords=""):
    """A bed of phi 0.4, 12 diameters deep under 28 of water, with time steps of 1e-5."""
    w = 6 * d
    grains = cloud(int(0.4 * 6 * 6 * 12 / (np.pi / 6)), (w, w), (0.5 * d, 12 * d), d)
    return COUPLED.format(d=d, w=w, low=-d, high=45 * d, dz=d, dt=1e-5, every=every, grains="\n".join(grains),
                          keywords=keywords + " area %g" % (w * w))


def coupled(tmp_path, d, every, keywords=""):
    """Three couplings of that bed. What LAMMPS prints."""
    done = run_lmp(tmp_path, bed_of_specks(d, every, keywords).replace("run 1", f"run {3 * every}"))
    assert done.returncode == 0, done.stdout[-1000:]
    return done.stdout


@pytest.mark.parametrize("d, every, told", [(0.006, 1000, False), (1e-4, 1000, True), (1e-4, 10, False)])
def test_coupling_time_that_is_too_long_is_told(tmp_path, d, every, told):
    """b T of grains of 6 mm is 0.2 at couplings of 10 ms, that of grains of 0.1 mm more than 50."""
    assert ("couplings are too far apart" in coupled(tmp_path, d, every)) == told


@pytest.mark.parametrize("every, solve, told", [(100, "", True), (10, "solve 1e-3 1e-4", True), (10, "", False),
                                                (100, "solve 1e-4 1e-5", False)])
def test_it_is_the_time_of_a_solve_that_counts(tmp_path, every, solve, told):
    """1 ms or 0.1 ms of water, after 1 ms or 0.1 ms of the grains, which are fixed: b T is 8 or 0.8. Where that is
    told, the water of the first solve is three times as fast as in the end, whatever N; the advice says what is to be
    changed."""
    script = bed_of_specks(1e-4, every, solve).replace("run 1",
                                                       "variable u equal f_h[6][2]\n"
                                                       f"fix u all ave/time {every} 1 {every} v_u file u\n"
                                                       f"run {12 * every}")
    done = run_lmp(tmp_path, script)
    assert done.returncode == 0, done.stdout[-1000:]
    advice = ": a shorter period of keyword solve, and N steps that take as long" if solve else ": fewer steps N"
    assert ("couplings are too far apart" in done.stdout) == told and (advice in done.stdout) == told
    u = np.loadtxt(tmp_path / "u")[1:, 1]
    assert (u[0] > 2 * u[-1]) == told and (told or u[0] < u[-1])


def test_water_that_moves_on_alone_is_not_too_far_apart(tmp_path):
    """fix_modify solve past grains that are held: a stream that develops over a bed at rest, b T is 10^4."""
    done = run_lmp(tmp_path, bed_of_specks(1e-4, 10).replace("run 1", "run 0\nfix_modify h solve 1 1e-3\nrun 10"))
    assert done.returncode == 0, done.stdout[-1000:]
    assert "couplings are too far apart" not in done.stdout


@pytest.mark.parametrize("style, says, before, behind", [
    ("setforce 0 0 0", "stands before this fix in the input, whose forces then move what it holds", True, False),
    ("rigid single", "stands before this fix in the input, so that it reads forces before", True, False),
    ("viscous 1e-9", "adds a drag to grains that the water drags as well", True, True),
    ("lb/fluid", "adds a drag to grains that the water drags as well", True, True),
    ("temp/berendsen 1 1 1", "changes velocities of grains, of which the water feels nothing", True, True),
    ("viscosity 10 x z 4", "changes velocities of grains, of which the water feels nothing", True, True),
    ("rigid single langevin 1 1 1 77", "has a drag of its own (keyword langevin) on grains", True, True),
    ("rigid/nvt single temp 1 1 1", "changes velocities of grains, of which the water feels nothing", True, True),
    ("damping/cundall 0.1 0.1", "stands behind this fix in the input and makes forces larger", False, True)])
def test_what_the_stream_does_not_go_with_is_told(tmp_path, style, says, before, behind):
    """In both orders of the input, and nothing where the fix has no grains."""
    script = bed_of_specks(1e-4, 10).replace("run 1", "thermo_style custom step\nrun 0")
    line = f"fix other all {style}\n"
    if style.split()[0] in ("damping/cundall", "lb/fluid"):
        line = f"plugin load {there(STYLES_OF_TODAY)}\n" + line
    for at, told in ((script.index("fix h"), before), (script.index("run 0"), behind)):
        done = run_lmp(tmp_path, script[:at] + line + script[at:])
        assert done.returncode == 0, done.stdout[-1000:]
        assert (f"fix other of style {style.split()[0]} {says}" in " ".join(done.stdout.split())) == told
    none = run_lmp(tmp_path, script[:at] + "group none empty\n" + line.replace(" all ", " none ") + script[at:])
    assert style.startswith("rigid") or (none.returncode == 0 and says not in none.stdout)


@pytest.mark.parametrize("lines, error, says", [
    (f"plugin load {STYLES_OF_TODAY}\nfix b all srd", False, "fix b of style srd has a fluid of its own"),
    ("timestep -1e-5", True, "timestep is -1e-05, and neither drag nor the friction of the water have a way back")])
def test_a_second_fluid_is_told_and_a_way_back_refused(tmp_path, lines, error, says):
    there(STYLES_OF_TODAY)
    done = run_lmp(tmp_path, bed_of_specks(1e-4, 10).replace("run 1", f"{lines}\nrun 0"))
    assert (done.returncode != 0) == error and says in " ".join(done.stdout.split())


@pytest.mark.parametrize("pair, told", [("lubricate 1 1 1", True), ("lubricate 1 1 0", False)])
def test_lubrication_with_a_drag_of_its_own_is_told(tmp_path, pair, told):
    """flagfld 1: the pair style drags each grain as the water does; without it, it is lubrication alone."""
    done = run_lmp(tmp_path, bed_of_specks(1e-4, 10).replace("newton off", "newton on").replace(
        "run 1", f"pair_style {pair} 1.01e-4 2e-4\npair_coeff * *\nrun 0"))
    assert done.returncode == 0, done.stdout[-1000:]
    said = "pair_style lubricate has a drag of its own on each grain (flagfld 1)"
    assert (said in " ".join(done.stdout.split())) == told


@pytest.mark.parametrize("some, refused", [("1", True), ("1:1000", False)])
def test_grains_whose_forces_would_add_up_are_refused(tmp_path, some, refused):
    """LAMMPS sets the forces of others than those of neigh_modify include to 0 never again."""
    done = run_lmp(tmp_path, bed_of_specks(1e-4, 10).replace(
        "run 1", f"group some id {some}\natom_modify first some\nneigh_modify include some\nrun 2"))
    assert (done.returncode != 0) == refused, done.stdout[-1000:]
    assert ("neigh_modify has include some, which leaves out atom 2" in " ".join(done.stdout.split())) == refused


RISES = "keyword gravity: no fix gives atom 1 a weight"


@pytest.mark.parametrize("lines, told", [
    ("fix m all nve/sphere", True), ("fix m all rigid single", True), ("", False),
    ("fix g all gravity 9.8 vector 0.5 0 -9.8\nfix m all nve/sphere", False),
    ("fix w all addforce 0 0 -1e-9\nfix m all nve/sphere", False),
    ("fix s all setforce 0 0 0\nfix m all nve/sphere", False), ("fix m all move linear 0 0 0", False),
    ("group one id 1\nfix g one gravity 9.8 vector 0 0 -1\ngroup two id 2\nfix m one nve/sphere", False),
    ("group one id 2\nfix g one gravity 9.8 vector 0 0 -1\nfix m all nve/sphere", True)])
def test_grains_without_a_weight_are_told(tmp_path, lines, told):
    """They rose without a word. Once, and not where nobody moves them, or where something may be their weight."""
    script = bed_of_specks(1e-4, 10).replace("timestep 1e-05", "timestep 1e-09").replace(
        "run 1", f"thermo_style custom step\n{lines}\nrun 1\nrun 1")
    done = run_lmp(tmp_path, script)
    assert done.returncode == 0, done.stdout[-1000:]
    assert " ".join(done.stdout.split()).count(RISES) == told


@pytest.mark.parametrize("keyword, apart, ranks, told", [("", 0.7, 1, True), ("", 0.7, 2, True), ("", 0.97, 1, False),
                                                         ("overlap twice", 0.7, 1, False),
                                                         ("overlap once", 0.7, 1, False)])
def test_members_that_share_volume_are_told(tmp_path, keyword, apart, ranks, told):
    """Molecule 7 has two members that are so many diameters apart; those of molecule 3 are far from each other."""
    script = bed_of_specks(1e-4, 10, keyword).replace("run 1", "thermo_style custom step\nrun 0\nrun 0")
    script = script.replace("fix h", "fix mol all property/atom mol\nset atom 3*4 mol 3\nset atom 1*2 mol 7 y 3e-4 "
                            f"z 3e-4\nset atom 1 x 2e-4\nset atom 2 x {2e-4 + apart * 1e-4:g}\nfix h", 1)
    done = run_lmp(tmp_path, script, ranks)
    assert done.returncode == 0, done.stdout[-1000:]
    assert done.stdout.count("what members of the clump of molecule 7 share counts twice") == told


@pytest.mark.parametrize("model, wall, told", [("langevin", "reflect", True), ("langevin", "lj126", False),
                                               ("correlated", "reflect", False)])
def test_a_wall_that_mirrors_grains_is_told(tmp_path, model, wall, told):
    end = "zhi 0.004" if wall == "reflect" else "zhi 0.004 1e-12 1e-6 2e-6"
    done = run_lmp(tmp_path, bed_of_specks(1e-4, 10, f"fluctuation {model} 3 -1").replace(
        "run 1", f"fix top all wall/{wall} {end}\nrun 1\nrun 1"))
    assert done.returncode == 0, done.stdout[-1000:]
    assert done.stdout.count("fix top of style wall/reflect turns grains back, but not the fluctuation") == told


@pytest.mark.parametrize("keywords, told", [("conserve no", True), ("rules yade", True), ("conserve yes", False),
                                            ("conserve no solve 1e-4 1e-7", False)])
def test_exchange_that_is_cut_off_is_told(tmp_path, keywords, told):
    """Grains of 0.05 mm every 0.1 ms, with fluid steps of 10 us: b is above 1/(10 dt), and the water too fast unless
    the books are kept."""
    assert ("of the drag does not reach the water" in coupled(tmp_path, 5e-5, 10, keywords)) == told


@pytest.mark.parametrize("conserve", ["yes", "no"])
def test_water_in_a_bed_of_spheres_that_overlap_is_even(conserve):
    """160 fixed spheres at even heights, phi 0.66 above phi_max 0.61, so that there is no eddy viscosity: all the water
    in the bed has the velocity where drag balances the slope, f(U) n = rho (1 - phi) g, and so it stays. (Felt at the
    centre, waves of half a diameter grow until the run ends.)"""
    d, phi, width, g = 0.006, 0.66, 0.024, 0.4905
    height = np.pi / 6 * d / phi * 10
    s = Scene(box=(0, width, 0, width, -d, 0.18))
    x = np.random.default_rng(1).uniform(0, width, (160, 3))
    x[:, 2] = d / 2 + (np.arange(160) + 0.5) / 160 * height
    s.spheres(x, np.zeros((160, 3)), d / 2)
    s.do("timestep 1e-2", f"fix h all hydro/vans 1 mesh 151 {0.09 / 150} 0 fluid 1000 0.001 gravity {g} 0 -9.8 solve "
                          f"0.01 1e-3 phi_max 0.61 felt volume conserve {conserve}",
         "run 3000")
    z, U, phi = s.column("z", 151), s.column("u", 151), s.column("phi", 151)
    inside = (z > 2 * d) & (z < height - 2 * d)
    grains = phi[inside] / (np.pi / 6 * d ** 3) * 0.5 * np.pi * (d / 2) ** 2 * (1 - phi[inside]) ** -3.1
    viscous = 24.4 * 1e-6 / d
    law = (-viscous + np.sqrt(viscous ** 2 + 4 * 0.44 * g * (1 - phi[inside]) / grains)) / (2 * 0.44)
    assert np.abs(U[inside] / law - 1).max() < 1e-4
    before = s.column("u", 151)
    s.do("run 2000")
    assert np.abs(s.column("u", 151) - before).max() < 1e-6 * before.max()
    s.close()


def test_fluctuations_by_depth_know_no_unit_of_time(tmp_path):
    """The same grains in micrometres and microseconds have the same fluctuations after 200 couplings of 1 ms."""
    seen = []
    for units, L, T, density in (("si", 1.0, 1.0, 1.0), ("micro", 1e6, 1e6, 1e-3)):
        s = Scene(box=(0, 0.02 * L, 0, 0.02 * L, -0.02 * L, 0.15 * L), units=units,
                  extra=[f"pair_style zero {0.01 * L}", "pair_coeff * *", f"neighbor {0.001 * L} bin"])
        s.spheres(L * np.random.default_rng(3).uniform([0, 0, 0.001], [0.02, 0.02, 0.0199], (50, 3)), np.zeros((50, 3)),
                  1e-4 * L, density=2500 * density)
        u = write_columns(tmp_path / "u", 0.02 * np.arange(22))
        s.do(f"timestep {1e-3 * T}", f"fix h all hydro/vans 1 mesh 21 {1e-3 * L} 0 fluid {1000 * density} "
             f"{0.001 * density * L * L / T} gravity {0.5 * L / T / T} 0 {-9.8 * L / T / T} "
             f"couple none profile file {u} fluctuation depth 5 0", "run 200")
        seen.append(s.atoms("f_h")[:, 3:])
        s.close()
    assert np.abs(seen[0]).max() > 1e-3
    assert np.abs(seen[1] - seen[0]).max() < 1e-9 * np.abs(seen[0]).max()


@pytest.mark.parametrize("molecule", [1, -5])
def test_shares_of_a_clump_follow_its_members(molecule):
    """overlap once: a member is replaced by another, or grows; the number of atoms stays. Volume of the union by the
    formula of two spheres."""
    def union(a, b, h):
        lens = np.pi * (a + b - h) ** 2 * (h * h + 2 * h * (a + b) - 3 * (a - b) ** 2) / (12 * h)
        return 4 / 3 * np.pi * (a ** 3 + b ** 3) - lens

    s = Scene(style="hybrid sphere bond")
    s.spheres([[0.01, 0.01, 0.015], [0.0113, 0.01, 0.015], [0.004, 0.01, 0.015]], np.zeros((3, 3)), 0.001)
    s.molecule([1, 2], molecule)
    s.do("fix h all hydro/vans 1 mesh 41 0.001 0 fluid 1030 0.0017 gravity 0 0 -9.7 couple one stream "
         "rest overlap once",
         "run 1")

    def volume():
        return (s.column("phi", 41) * 0.001 * 4e-4).sum()

    sphere = 4 / 3 * np.pi * 1e-9
    assert abs(volume() / (sphere + union(0.001, 0.001, 0.0013)) - 1) < 1e-10
    s.do("group gone id 2", "delete_atoms group gone compress no", "create_atoms 1 single 0.0116 0.01 0.015 units box",
         "set atom 4 diameter 0.002 density 2500")
    s.molecule([4], molecule)
    s.do("run 1")
    assert abs(volume() / (sphere + union(0.001, 0.001, 0.0016)) - 1) < 1e-10
    s.do("set atom 4 diameter 0.0024", "run 1")
    assert abs(volume() / (sphere + union(0.001, 0.0012, 0.0016)) - 1) < 1e-10


def test_clump_wider_than_half_the_box():
    """A chain of nine along x in a box that is only twice its radius longer: every pair of neighbours shares one
    lens."""
    a, h, n = 0.001, 0.0012, 9
    s = Scene(box=(0, 0.012, 0, 0.02, -0.02, 0.15), style="hybrid sphere bond")
    s.spheres([[0.0011 + h * k, 0.01, 0.015] for k in range(n)], np.zeros((n, 3)), a)
    s.do("set group all mol 1", "fix h all hydro/vans 1 mesh 41 0.001 0 fluid 1030 0.0017 gravity 0 0 -9.7 couple one "
                                "stream rest overlap once", "run 0")
    lens = np.pi * (4 * a + h) * (2 * a - h) ** 2 / 12
    volume = (s.column("phi", 41) * 0.001 * 0.012 * 0.02).sum()
    assert abs(volume / (n * 4 / 3 * np.pi * a ** 3 - (n - 1) * lens) - 1) < 1e-10
