"""rigid_clumps yes and auto: which clumps have one shape, runs that end in an error and the next, molecule IDs, clumps
that are not rigid."""
import re

import numpy as np
import pytest

from host import by_open_mpi
from model import forces, same_clump
from system import Spheres, dump_lines, from_restart, input_lines, lmp, lmp_in_turn, read_dump
from test_rigid_clumps import SOLVED, WIDE, many, rotation_matrix
from test_rotation import CLUSTERS, resistance


# --- which clumps have the same shape

# Third sphere of an angle of three (size 2.6) displaced: each is the shape of the one before, but the first and the
# last are 2 d apart.
@pytest.mark.parametrize("d", by_open_mpi([0.0, 1e-4, 3e-6, 2e-4, 2.5e-4, 1e-3], but=2))
def test_nearly_equal_clumps_have_their_drag_on_any_ranks(tmp_path, d):
    angle = np.array([(0, 0, 0), (2, 0, 0), (0, 2, 0)], float)
    centres = [(-10, 0, 0), (10, 0, 0), (10, 0, 8)]
    x = np.vstack([angle + (0, 0, 0) + c + np.array([(0, 0, 0), (0, 0, 0), (0, k * d, 0)])
                   for k, c in enumerate(centres)])
    spheres = Spheres(x, 1.0, (1.0, 0, 0), np.repeat([1, 2, 3], 3))
    totals, shapes = [], []
    for ranks, processors in ((1, "1 1 1"), (2, "2 1 1"), (2, "1 1 2")):
        lines = input_lines(spheres, "clumps_only yes rigid_clumps yes shell 12 visc 1", tmp_path / "data",
                            comm=f"processors {processors}\ncomm_modify cutoff 10")
        shapes.append(lmp(tmp_path, [lines[0], f"processors {processors}"] +
                          [w for w in lines[1:] if not w.startswith("processors")]
                          + dump_lines(tmp_path / "dump", columns="f_drag[1]") + ["run 0"],
                          ranks=ranks).log.count("Rigid clumps, shape"))
        F = read_dump(tmp_path / "dump")[-1][1][:, 0]
        totals.append(F.reshape(3, 3).sum(axis=1))
    assert np.abs(np.array(totals) / -30.825 - 1).max() < 1e-3
    assert np.abs(np.array(totals) / totals[0] - 1).max() < 1e-10
    assert shapes == shapes[:1] * 3


def block(n, digits, seed=3):
    """n copies of a clump of ten in a cube, turned, with coordinates of so many digits."""
    rng = np.random.default_rng(seed)
    shape = np.vstack([CLUSTERS["cube8"], [(0.3, -0.2, 2.6), (0.1, 2.9, 0.4)]])
    side = int(np.ceil(n ** (1 / 3)))
    x = np.vstack([shape @ rotation_matrix(rng).T + 12.0 * np.array([k % side, k // side % side, k // side**2]) - 6.0 *
                   side
                   for k in range(n)])
    return Spheres(np.array([[float(f"%.{digits}g" % c) for c in row] for row in x]), 1.0,
                   molecule=np.repeat(np.arange(1, n + 1), 10))


@pytest.mark.parametrize("ranks", [1, 2])
def test_equal_clumps_from_a_file_of_six_digits_share_one_shape(tmp_path, ranks):
    text = lmp(tmp_path, input_lines(block(500, 6), "clumps_only yes rigid_clumps yes shell 12 visc 1",
                                     tmp_path / "data", comm="comm_modify cutoff 12")
               + ["run 0"], ranks=ranks).log
    assert text.count("Rigid clumps, shape") == 1


def test_clumps_that_all_differ_are_told_apart_in_little_time(tmp_path):
    """1500 shapes; pairs of them that are looked at in earnest are few."""
    spheres = block(1500, 12)
    rng = np.random.default_rng(5)
    spheres.x[9::10] += rng.uniform(-0.5, 0.5, size=(1500, 3))
    text = lmp(tmp_path, input_lines(spheres, "clumps_only yes rigid_clumps yes visc 1", tmp_path / "data",
                                     comm="comm_modify cutoff 12")
               + ["timer full", "run 0"], ranks=2).log
    assert text.count("Rigid clumps, shape") == 1500


@pytest.mark.parametrize("ranks", [1, 2])
def test_stiffly_bonded_clumps_that_migrate_make_no_new_shapes(tmp_path, ranks):
    """Pairs held by stiff springs that breathe by less than the tolerance, in a flow through a periodic box."""
    spheres = Spheres([(k % 2 * 2.0 - 5, 4.0 * (k // 2) - 6, 0) for k in range(8)], 1.0, (2.0, 0.3, 0),
                      np.arange(8) // 2 + 1, bonds=[(k, k + 1) for k in (1, 3, 5, 7)])
    lines = input_lines(spheres, "clumps_only yes rigid_clumps yes visc 0.1 shell 12 fluid_velocity 2 0.3 "
                                 "0 add_force yes", tmp_path / "data",
                        boundary="p p p", box=[(-8.0, 8.0)] * 3, comm="comm_modify cutoff 6", dt=2e-3)
    at = lines.index("bond_style zero")
    lines[at:at + 2] = ["bond_style harmonic", "bond_coeff 1 1e4 2.0001"]
    text = lmp(tmp_path, lines + ["special_bonds lj/coul 0 1 1", "fix nve all nve/sphere", "run 2000", "run 2000"],
               ranks=ranks).log
    assert text.count("Rigid clumps, shape") == 1


def test_shapes_that_nobody_has_are_dropped(tmp_path):
    """Two clumps of which one is stretched and set back: its own shape goes, and is solved anew the next time."""
    spheres, _ = many("square", 2)
    lines = input_lines(spheres, "clumps_only yes rigid_clumps yes shell 12 visc 1", tmp_path / "data", comm=WIDE)
    pull, back = "displace_atoms corner move 0 0 0.3", "displace_atoms corner move 0 0 -0.3"
    text = lmp(tmp_path, lines + ["run 0", "group corner id 8", pull, "run 0", "run 0", back, "run 0", pull, "run 0"],
               ranks=2).log
    assert re.findall("Rigid clumps, shape ([0-9]+)", text) == ["1", "2", "3"]


# --- a run that ends in an error, and the next

def fresh(simulation, spheres, style, **options):
    return simulation(spheres, style, comm=WIDE, **options).run(0).drag


@pytest.mark.hard_case("run after an error of rigid clumps")
def test_run_after_spheres_at_one_point(simulation):
    spheres = Spheres([(0, 0, 0), (2, 0, 0), (0, 2, 0), (20, 0, 0), (22, 0, 0), (20, 2, 0)], 1.0, (0.3, 0.1, 0),
                      [1, 1, 1, 2, 2, 2])
    style = "clumps_only yes rigid_clumps yes shell 12 visc 1"
    expected = fresh(simulation, spheres, style)
    sim = simulation(spheres, style, comm=WIDE)
    sim.commands("group moved id 2\ndisplace_atoms moved move -2 0 0")
    for _ in range(2):
        with pytest.raises(Exception, match="at one point"):
            sim.run(0)
    with pytest.raises(Exception, match="at one point"):
        sim.run(1, "pre no")
    sim.commands("displace_atoms moved move 2 0 0").run(0)
    assert np.abs(sim.drag - expected).max() < 1e-12


@pytest.mark.hard_case("run after an error of rigid clumps")
@pytest.mark.parametrize("shell", [100000000, 2147483646, 2147483647])
def test_run_after_a_shell_that_is_too_large(simulation, shell):
    spheres, _ = many("square", 2)
    style = "stokes_dynamics clumps_only yes rigid_clumps yes visc 1 shell"
    expected = fresh(simulation, spheres, "clumps_only yes rigid_clumps yes visc 1 shell 12")
    sim = simulation(spheres, f"clumps_only yes rigid_clumps yes visc 1 shell {shell}", comm=WIDE)
    for _ in range(2):
        with pytest.raises(Exception, match="its resistance needs .* GB, more than 4; use a smaller shell"):
            sim.run(0)
    sim.commands(f"pair_style {style} 12\npair_coeff * *").run(0)
    assert np.abs(sim.drag - expected).max() < 1e-12


@pytest.mark.hard_case("run after an error of rigid clumps")
def test_run_after_a_split_a_bent_and_a_shrunk_clump(simulation):
    spheres, _ = many("square", 2)
    style = "clumps_only yes rigid_clumps yes visc 1 group some"
    sim = simulation(spheres, style, comm=WIDE, before_pair="group some id 1:2 5:8", dt=1e-3)
    with pytest.raises(Exception, match="molecule 3 is split"):
        sim.run(0)
    found = [(spheres, sim.commands("group some id 3:4").run(0).drag)]
    sim.commands("fix nve all nve/sphere\nvelocity all create 1.0 4711")
    with pytest.raises(Exception, match="is not rigid"):
        sim.run(200)
    sim.command("unfix nve")                    # as it stands now it is a clump like any other
    found.append((Spheres(sim.x, 1.0, sim.v, spheres.molecule), sim.run(0).drag))
    sim.commands("group gone id 3\ndelete_atoms group gone compress no").run(0)
    found.append((Spheres(sim.x, 1.0, sim.v, np.delete(spheres.molecule, 2)), sim.drag))
    for now, drag in found:
        assert np.abs(drag - fresh(simulation, now, "clumps_only yes rigid_clumps yes visc 1")).max() < 1e-10


# --- molecule IDs

@pytest.mark.parametrize("molecule", [-5, 5, -2147483647])
def test_negative_molecule_is_a_molecule(simulation, molecule):
    """As for fix rigid/small and neigh_modify exclude molecule: only 0 is none. All checks see it."""
    spheres, _ = many("square", 2)
    expected = fresh(simulation, spheres, "clumps_only yes rigid_clumps yes visc 1")
    spheres.molecule[:4] = molecule
    sim = simulation(spheres, "clumps_only yes rigid_clumps yes visc 1", comm=WIDE, dt=1e-3).run(0)
    assert np.abs(sim.drag - expected).max() < 1e-12
    sim.commands("fix nve all nve/sphere\nvelocity all create 1.0 4711\nvelocity all set NULL NULL 0")
    sim.commands("group other id 5:8\nvelocity other set 0 0 0")
    with pytest.raises(Exception, match=f"molecule {molecule} is not rigid"):
        sim.run(200)
    sim = simulation(spheres, "clumps_only yes rigid_clumps yes visc 1 group some", comm=WIDE,
                     before_pair="group some id 1:2 5:8")
    with pytest.raises(Exception, match=f"molecule {molecule} is split"):
        sim.run(0)
    sim = simulation(spheres, "clumps_only yes rigid_clumps yes visc 1", comm=WIDE)
    sim.commands(LOSE.format(*spheres.x[2]))
    with pytest.raises(Exception, match=f"molecule {molecule} has gained or lost atoms"):
        sim.run(5)


# --- what is not rigid

@pytest.mark.hard_case("rigid clump that bends")
@pytest.mark.parametrize("ranks", [1, 2])
def test_clump_that_bends_is_an_error_that_names_the_molecule(tmp_path, ranks):
    spheres, _ = many("square", 3)
    lines = input_lines(spheres, "clumps_only yes rigid_clumps yes visc 1.3", tmp_path / "data", comm=WIDE, dt=1e-3)
    ended = lmp(tmp_path, lines + ["fix nve all nve/sphere", "velocity all create 1.0 4711", "run 200"], ranks=ranks,
                succeed=False)
    assert "keyword rigid_clumps: the clump of molecule" in ended.text
    assert "is not rigid" in ended.text
    assert "does no fix rigid/small hold it together, or is the time step too long?" in ended.text


@pytest.mark.hard_case("rigid_clumps auto: clump that bends")
def test_auto_solves_bent_clumps_anew(simulation):
    """Loose spheres with drag: every clump soon loses its shape. The force is the model's for the velocities of the
    half step."""
    spheres, omega = many("square", 3)
    sim = simulation(spheres, f"clumps_only yes visc 1.3 rigid_clumps auto {SOLVED}", comm=WIDE, dt=1e-3)
    sim.command("fix nve all nve/sphere")
    sim.run(300)
    rows = sim.fix_rows()
    half_step = rows[:, 3:6] - rows[:, 0:3] / (6 * np.pi * 1.3)
    now = Spheres(sim.x, 1.0, half_step, spheres.molecule)
    F = forces(now, 1.3, sees=same_clump(now))
    assert sim.solves > 100
    assert np.abs(rows[:, 0:3] - F).max() < 1e-9 * np.abs(F).max()


LOSE = """group gone id 3
fix nve all nve/limit 1e-9
region r sphere {} {} {} 0.1
fix lose gone evaporate 1 1 r 4711"""


@pytest.mark.hard_case("rigid clump that loses an atom")
def test_lost_atom_is_an_error(simulation):
    spheres, _ = many("square", 2)
    sim = simulation(spheres, "clumps_only yes rigid_clumps yes visc 1.3", comm=WIDE)
    sim.commands(LOSE.format(*spheres.x[2]))
    with pytest.raises(Exception, match="molecule 3 has gained or lost atoms"):
        sim.run(5)


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("from_file", [False, True], ids=["script", "restart"])
def test_a_clump_that_loses_an_atom_between_two_runs_without_inertia_is_an_error(tmp_path, from_file, ranks):
    """All of a molecule, which is fine, and one atom of another. From a file the run went on; on two ranks the clump
    was told to have bent."""
    spheres, _ = many("square", 2)
    lines = input_lines(spheres, "clumps_only yes rigid_clumps yes rotation yes visc 1.3", tmp_path / "data", comm=WIDE,
                        fix=False, dt=1e-6)
    fix = "fix move all stokes_dynamics/overdamped"
    cut = [fix, "group whole molecule 13", "delete_atoms group whole", "run 0", "group gone id 2",
           "delete_atoms group gone", "run 1"]
    runs = [lines + [fix, "run 1", "write_restart half.restart"]]
    runs = runs + [from_restart(lines) + cut[:3] + cut[4:]] if from_file else [runs[0] + cut[1:]]
    for one in runs:
        ended = lmp(tmp_path, one, ranks, succeed=False)
    text = " ".join(ended.text.split())
    assert ended.code != 0 and "the clump of molecule 3 has gained or lost atoms, so it is not rigid" in text


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("fix", ["fix nve all nve/sphere", "fix move all stokes_dynamics/overdamped"])
def test_a_clump_that_leaves_a_box_with_fixed_faces_is_told_to_have_left_it(tmp_path, fix, ranks):
    """One sphere is outside, and LAMMPS has deleted it; it looks for lost atoms only when it writes thermo output."""
    spheres = Spheres([(0, 3, 0), (2, 3, 0)], 1.0, (3.0, 0.0, 0.0), molecule=1)
    drag = ["fix drag all stokes_dynamics"] if "nve" in fix else []
    lines = input_lines(spheres, "clumps_only yes rigid_clumps yes shell 42 visc 1e-3 fluid_velocity 3 0 0",
                        tmp_path / "data", box=[(-10, 10)] * 3, fix=False, dt=0.05)
    ended = lmp(tmp_path, lines + drag + [fix, "thermo 100", "run 100"], ranks, succeed=False)
    text = " ".join(ended.text.split())
    assert ended.code != 0 and "the clump of molecule 1 has lost atoms that left the box: use boundary m or s" in text
    assert "rigid_clumps auto" not in text


def test_no_error_offers_auto_to_motion_without_inertia(simulation):
    """Which refuses it."""
    spheres, _ = many("square", 2)
    sim = simulation(spheres, "clumps_only yes rigid_clumps yes rotation yes visc 1.3", comm=WIDE, fix=False)
    sim.commands(LOSE.format(*spheres.x[2])).commands("unfix nve\nfix move all stokes_dynamics/overdamped")
    with pytest.raises(Exception, match="molecule 3 has gained or lost atoms.*by whole molecules") as told:
        sim.run(5)
    assert "auto" not in str(told.value)
    sim = simulation(spheres, "clumps_only yes rigid_clumps yes rotation yes visc 1.3", comm=WIDE, fix=False, dt=0.01)
    sim.commands("fix move all stokes_dynamics/overdamped").run(1)
    sim.raw("radius")[0] *= 1.1
    with pytest.raises(Exception, match="is not rigid.*another command moves their atoms") as told:
        sim.run(1, "pre no")
    assert "auto" not in str(told.value)


@pytest.mark.hard_case("rigid_clumps auto: clump that loses an atom")
def test_auto_goes_on_after_a_lost_atom(simulation):
    spheres, _ = many("square", 2)
    sim = simulation(spheres, f"clumps_only yes rigid_clumps auto visc 1.3 {SOLVED}", comm=WIDE)
    sim.commands(LOSE.format(*spheres.x[2])).run(5)
    assert sim.n == 7 and sim.solves > 0
    assert np.all(np.isfinite(sim.drag))


def flexible(count):
    """Triangles of soft springs that fall and bend, and one that falls rigid."""
    spheres, _ = many("triangle", count, spacing=9.0)
    spheres.v[:] = 0.0
    spheres.bonds = [(3 * k + p, 3 * k + q) for k in range(count) for p, q in ((1, 2), (2, 3))]
    return spheres


def bending(tmp_path, spheres):
    lines = input_lines(spheres, f"clumps_only yes rigid_clumps auto shell 12 visc 0.7 add_force yes {SOLVED}",
                        tmp_path / "data", comm=WIDE, dt=0.01)
    at = lines.index("bond_style zero")
    lines[at:at + 2] = ["bond_style harmonic", "bond_coeff 1 5 2.3"]
    return lines + ["group rigid id 4:6", "group soft subtract all rigid", "special_bonds lj/coul 0 1 1",
                    "fix down all addforce 3.0 1.0 -2.0", "fix rigid rigid rigid/small molecule",
                    "fix nve soft nve/sphere"]


@pytest.mark.parametrize("ranks", [1, 2])
def test_auto_run_cut_in_pieces_is_the_same_run(tmp_path, ranks):
    spheres = flexible(3)
    inputs = [bending(tmp_path, spheres) + dump_lines(tmp_path / f"dump.{pieces}", every=40,
                                                      columns="xu yu zu vx vy vz f_drag[1]")
              + [f"run {40 // pieces}"] * pieces for pieces in (1, 2, 4)]
    shapes = [log.count("Rigid clumps, shape") for log in lmp_in_turn(tmp_path, inputs, ranks)]
    frames = [read_dump(tmp_path / f"dump.{pieces}")[-1] for pieces in (1, 2, 4)]
    assert [step for step, _ in frames] == [40, 40, 40]
    for _, rows in frames[1:]:
        assert np.abs(rows - frames[0][1]).max() < 1e-10 * np.abs(frames[0][1]).max()
    assert shapes == shapes[:1] * 3


def test_auto_restart_knows_who_is_loose(tmp_path):
    spheres = flexible(3)
    spheres.molecule[:3] = -9
    columns = "xu yu zu vx vy vz f_drag[1]"
    lmp(tmp_path, bending(tmp_path, spheres) + [f"restart 20 {tmp_path}/restart"] +
        dump_lines(tmp_path / "whole", every=40, columns=columns) + ["run 40"])
    lines = bending(tmp_path, spheres)
    after = lines[lines.index("group rigid id 4:6") + 2:]
    text = lmp(tmp_path, ["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/restart.20", WIDE,
                          "fix drag all stokes_dynamics"] + after
               + dump_lines(tmp_path / "rest", every=40, columns=columns) + ["run 20"], ranks=2).log
    assert text.count("Rigid clumps, shape") == 1
    whole, rest = read_dump(tmp_path / "whole")[-1][1], read_dump(tmp_path / "rest")[-1][1]
    assert np.abs(whole - rest).max() < 1e-10 * np.abs(whole).max()


def test_bent_clump_does_not_hide_one_that_is_split(simulation):
    """auto: molecule 13 bends in the very step in which molecule 3 loses two spheres to the group."""
    spheres, _ = many("square", 2)
    spheres.v[4:] = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 1)]
    sim = simulation(spheres, f"clumps_only yes rigid_clumps auto visc 1.3 {SOLVED} region r", comm=WIDE, dt=1e-2,
                     before_pair="region r block {} 100 -100 100 -100 100".format(
                         np.sort(spheres.x[:4, 0])[1:3].mean() - 1.0))
    spheres.v[:4] = 0.0
    with pytest.raises(Exception, match="molecule 3 is split"):
        sim.commands("velocity all set -1 0 0 sum yes\nfix nve all nve/sphere").run(400)


@pytest.mark.parametrize("many_lost", [3000])
def test_many_clumps_that_lose_atoms_at_once_are_no_recursion(simulation, many_lost):
    x = np.array([(5.0 * (k % 100), 5.0 * (k // 100), z) for k in range(many_lost) for z in (0.0, 2.0)])
    spheres = Spheres(x, 1.0, (0, 0, 0.1), np.repeat(np.arange(1, many_lost + 1), 2))
    sim = simulation(spheres, "clumps_only yes rigid_clumps auto visc 1", comm=WIDE)
    sim.commands("fix nve all nve/limit 1e-9\nregion up block INF INF INF INF 1.0 INF\n"
                 f"fix lose all evaporate 1 {many_lost} up 4711").run(3)
    assert sim.n == many_lost
    assert np.abs(sim.drag[:, 2] / (-6 * np.pi * sim.v[:, 2]) - 1).max() < 0.05


@pytest.mark.hard_case("blow-up in a periodic box")
@pytest.mark.parametrize("far", [1e6, 1e20])
def test_positions_far_out_of_a_periodic_box_end_in_an_error(tmp_path, far):
    spheres, _ = many("square", 2, spacing=8.0)
    lines = input_lines(spheres, f"clumps_only yes rigid_clumps auto visc 1.3 {SOLVED}", tmp_path / "data",
                        boundary="p p p", box=[(-9.0, 15.0), (-9.0, 9.0), (-9.0, 9.0)], comm="comm_modify cutoff 6",
                        dt=1e-3)
    ended = lmp(tmp_path, lines + ["neigh_modify every 1 delay 0 check yes", "fix nve all nve/sphere",
                                   "velocity all create 1.0 4711", "run 100", f"velocity all scale {far * far}",
                                   "timestep 1.0", "run 100"], succeed=False)
    assert "ERROR" in ended.text


@pytest.mark.parametrize("how", ["group half", "region r"])
def test_split_clump_is_an_error(simulation, how):
    spheres, _ = many("square", 2)
    x = spheres.x[0]
    with pytest.raises(Exception, match="the clump of molecule 3 is split by the keyword group or region"):
        simulation(spheres, f"clumps_only yes rigid_clumps yes visc 1.3 {how}", comm=WIDE,
                   before_pair="group half id 1:2 5:8\nregion r sphere {} {} {} 1.0".format(*x)).run(0)


@pytest.mark.parametrize("words, message", [
    ("cut_off_distance inf rigid_clumps yes",
     "keyword rigid_clumps: with clumps_only no, rotation yes .or a shell. is required"),
    ("clumps_only yes cut_off_distance 5 rigid_clumps yes", "keyword rigid_clumps: no cut_off_distance may be given"),
    ("clumps_only yes rigid_clumps maybe", "keyword rigid_clumps: 'maybe' is none of: no, yes, auto"),
    ("clumps_only yes rigid_clumps yes shell 7", "keyword shell: '7' must be 1 or >= 12"),
    ("clumps_only yes rigid_clumps yes shell -1", "keyword shell: '-1' must be >= 1"),
    ("clumps_only yes shell 12", "keyword shell requires rigid_clumps yes"),
    ("clumps_only yes rigid_clumps yes tensor oseen", "keyword rigid_clumps is not available with tensor oseen"),
])
def test_bad_input(simulation, words, message):
    with pytest.raises(Exception, match=message):
        simulation(Spheres([[0, 0, 0]]), f"{words} visc 1")


@pytest.mark.hard_case("rigid clump with equal spheres at one point")
def test_spheres_at_one_point_are_an_error(simulation):
    with pytest.raises(Exception, match="two of its spheres of equal radius are at one point"):
        simulation(Spheres([[0, 0, 0], [0, 0, 0], [1, 0, 0]], molecule=1),
                   "clumps_only yes rigid_clumps yes visc 1").run(0)


def test_a_resistance_too_large_for_memory_is_an_error_before_anything_is_allocated(simulation):
    with pytest.raises(Exception, match="needs .* GB, more than 4; use a smaller shell"):
        simulation(Spheres(CLUSTERS["fcc13"], molecule=1), "clumps_only yes rigid_clumps yes shell 100000000 visc 1",
                   comm=WIDE).run(0)


def test_a_clump_longer_than_the_ghost_cut_off_is_solved_on_one_rank(tmp_path):
    spheres = Spheres(np.column_stack((2.0 * np.arange(10), np.zeros(10), np.zeros(10))), molecule=1)
    forces = []
    for ranks in (1, 2):
        lmp(tmp_path, input_lines(spheres, "clumps_only yes rigid_clumps yes visc 1", tmp_path / "data")
            + ["velocity all set 0.1 0.2 0.3", *dump_lines(tmp_path / "dump", columns="f_drag[1] f_drag[2] f_drag[3]"),
               "run 0"], ranks=ranks)
        forces.append(read_dump(tmp_path / "dump")[0][1])
    assert np.abs(forces[0]).max() > 1 and np.abs(forces[1] - forces[0]).max() < 1e-10
