"""Keywords region and group: who takes part."""
import re

import numpy as np
import pytest

import model
from system import Spheres, chain, dump_lines, input_lines, largest_difference, lmp, read_dump

ETA, A = 1.3, 0.7
STOKES = 6 * np.pi * ETA * A
U = 0.4
EXACT = f"visc {ETA} algorithm 2 relative_tolerance 1e-12"
# Total drag of k touching spheres in a row that move along it, in 6 pi eta a U: dense solves, 11 digits.
ROW = {1: 1.0, 2: 1.2307692308, 3: 1.4864864865, 4: 1.7096660808, 5: 1.9217095465}
MODES = {"all": "cut_off_distance inf", "list": "cut_off_distance 20", "clump": "clumps_only yes"}


def row_of_five():
    return chain(5, 2 * A, a=A, v=(0, 0, U))


def lower(k):
    """A region with the lowest k spheres of the row."""
    return f"region part block INF INF INF INF INF {2 * A * (k - 0.5)}"


@pytest.mark.hard_case("region border through a clump, 1 and 2 ranks")
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("k", ROW)
def test_spheres_outside_the_region_neither_feel_nor_act(simulation, mode, k):
    sim = simulation(row_of_five(), f"{MODES[mode]} {EXACT} region part", comm="comm_modify cutoff 12",
                     before_pair=lower(k)).run()
    assert np.abs(sim.fix_rows()[k:]).max(initial=0.0) == 0.0
    assert -sim.drag[:, 2].sum() / (STOKES * U) == pytest.approx(ROW[k], rel=1e-9)


@pytest.mark.hard_case("region border through a clump, 1 and 2 ranks")
@pytest.mark.parametrize("mode", MODES)
def test_region_border_through_a_clump_on_two_ranks(tmp_path, mode):
    """The third sphere is the last inside. The ranks meet between the second and the third, or the third and the
    fourth."""
    for shift in (0.0, 1.0):
        folder = tmp_path / str(shift)
        folder.mkdir()
        middle = 2 * A * (1.5 + shift)
        lines = input_lines(row_of_five(), f"{MODES[mode]} {EXACT} region part", folder / "data",
                            comm="comm_modify cutoff 12", before_pair=lower(3),
                            box=[(-2, 2), (-2, 2), (middle - 9, middle + 9)])
        lmp(folder, lines + dump_lines(folder / "dump") + ["run 1"], ranks=2)
        F = read_dump(folder / "dump")[0][1][:, 6:]
        assert np.abs(F[3:]).max() == 0.0
        assert -F[:, 2].sum() / (STOKES * U) == pytest.approx(ROW[3], rel=1e-9)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("k", ROW)
def test_spheres_outside_the_group_neither_feel_nor_act(simulation, mode, k):
    sim = simulation(row_of_five(), f"{MODES[mode]} {EXACT} group part", comm="comm_modify cutoff 12",
                     before_pair=f"group part id 1:{k}").run()
    assert np.abs(sim.fix_rows()[k:]).max(initial=0.0) == 0.0
    assert -sim.drag[:, 2].sum() / (STOKES * U) == pytest.approx(ROW[k], rel=1e-9)


def test_region_and_group_together_select_what_is_in_both(simulation):
    sim = simulation(row_of_five(), f"cut_off_distance inf {EXACT} region part group odd",
                     before_pair=lower(4) + "\ngroup odd id 1 3 5").run()
    spheres = row_of_five()
    assert np.abs(sim.drag[[1, 3, 4]]).max() == 0.0
    assert largest_difference(sim.drag[[0, 2]], model.forces(Spheres(spheres.x[[0, 2]], A, (0, 0, U)), ETA)) < 1e-11


def test_spheres_outside_may_have_any_radius(simulation):
    sim = simulation(row_of_five(), f"cut_off_distance inf {EXACT} group part",
                     before_pair="group part id 1:3\nset atom 5 diameter 0").run()
    assert -sim.drag[:, 2].sum() / (STOKES * U) == pytest.approx(ROW[3], rel=1e-9)


@pytest.mark.parametrize("mode", MODES)
def test_types_that_a_hybrid_gives_to_another_style_feel_the_fluid_all_the_same(simulation, tmp_path, mode):
    words = f"{MODES[mode]} {EXACT}"
    hybrid = [f"pair_style hybrid stokes_dynamics {words} zero 3", "set atom 1*3 type 2",
              "pair_coeff * * stokes_dynamics", "pair_coeff 2 2 zero"]
    lines = input_lines(row_of_five(), hybrid, str(tmp_path / "two.data"), comm="comm_modify cutoff 12")
    lines = [f"{line} extra/atom/types 1" if line.startswith("read_data") else line for line in lines]
    alone = simulation(row_of_five(), words, comm="comm_modify cutoff 12").run().drag
    assert np.array_equal(simulation().commands(lines).run().drag, alone)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("algorithm", [1, 2])
def test_nobody_selected_is_no_error(simulation, mode, algorithm):
    sim = simulation(row_of_five(), f"{MODES[mode]} visc {ETA} algorithm {algorithm} group nobody",
                     comm="comm_modify cutoff 12", before_pair="group nobody id 77").run(2)
    assert np.abs(sim.fix_rows()).max() == 0.0 and sim.iterations == 0


@pytest.mark.parametrize("mode", MODES)
def test_nobody_selected_on_two_ranks_is_no_error(tmp_path, mode):
    lines = input_lines(row_of_five(), f"{MODES[mode]} {EXACT} group nobody", tmp_path / "data",
                        comm="comm_modify cutoff 12", before_pair="group nobody id 77")
    lmp(tmp_path, lines + dump_lines(tmp_path / "dump") + ["run 1"], ranks=2)
    assert np.abs(read_dump(tmp_path / "dump")[-1][1][:, 6:]).max() == 0.0


@pytest.mark.parametrize("mode", MODES)
def test_rank_without_spheres(tmp_path, mode):
    """All spheres in one corner of the box, on one of two ranks."""
    spheres = row_of_five()
    lines = input_lines(spheres, f"{MODES[mode]} {EXACT}", tmp_path / "data", comm="comm_modify cutoff 12",
                        box=[(-2, 10), (-2, 10), (-2, 40)])
    lmp(tmp_path, lines + dump_lines(tmp_path / "dump") + ["run 1"], ranks=2)
    assert largest_difference(read_dump(tmp_path / "dump")[0][1][:, 6:], model.forces(spheres, ETA)) < 1e-10


def selected_forces(x, v, inside):
    F = np.zeros_like(x)
    F[inside] = model.forces(Spheres(x[inside], A, v[inside]), ETA)
    return F


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("options", ["", "pre no"])
def test_a_group_that_changes_between_runs(simulation, mode, options):
    """LAMMPS has not re-neighboured since; who has left the group has no force and no v' any more."""
    sim = simulation(row_of_five(), f"{MODES[mode]} {EXACT} group part", comm="comm_modify cutoff 12",
                     before_pair="neigh_modify every 1000 delay 1000 check no\ngroup part id 1:3").run(1)
    sim.commands(["group part clear", "group part id 3:5"]).run(1, options)
    assert np.abs(sim.fix_rows()[:2]).max() == 0.0
    assert -sim.drag[2:, 2].sum() / (STOKES * U) == pytest.approx(ROW[3], rel=1e-9)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("group", ["region part", "var low"])
def test_a_dynamic_group_is_found_before_the_first_force(simulation, mode, group):
    """LAMMPS itself finds it after the first forces of a run; so do those of the next run after spheres were moved."""
    before = f"{lower(3)}\nvariable low atom z<{2 * A * 2.5}\ngroup part dynamic all {group} every 1"
    sim = simulation(row_of_five(), f"{MODES[mode]} {EXACT} group part", comm="comm_modify cutoff 12",
                     before_pair=before).run(0)
    for k in (3, 4):
        assert np.abs(sim.fix_rows()[k:]).max() == 0.0
        assert -sim.drag[:, 2].sum() / (STOKES * U) == pytest.approx(ROW[k], rel=1e-9)
        sim.commands([f"displace_atoms all move 0 0 {-2 * A}"]).run(0)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("update_every", [1, 10])
@pytest.mark.parametrize("selected", ["region slab", "group inside"])
def test_spheres_enter_and_leave_the_region_during_a_run(simulation, mode, update_every, selected):
    """Free flight through a slab. Whoever comes or goes is in the very next force, whatever update_every."""
    x = [(0, 0, 0), (1.6, 0, 1.4), (3.2, 0, 2.6), (0, 1.8, 0.4), (1.8, 1.8, 3.1)]
    spheres = Spheres(x, A, (0, 0, U), molecule=1)
    sim = simulation(spheres, f"{MODES[mode]} {EXACT} {selected} update_every {update_every}",
                     comm="comm_modify cutoff 12", box=[(-9, 9), (-9, 9), (-9, 15)],
                     before_pair="region slab block INF INF INF INF 1.0 3.0\nneigh_modify every 1 delay 0\n"
                                 "group inside dynamic all region slab every 1", dt=0.05)
    sim.commands(["unfix drag", "fix drag all stokes_dynamics apply no", "fix move all nve/sphere"])
    sim.commands(dump_lines(sim.folder / "dump")).run(120).close()
    seen = set()
    for step, rows in read_dump(sim.folder / "dump"):
        if step == 0 and "group" in selected:
            continue        # LAMMPS fills the group after the forces of the first step
        now, F = rows[:, 0:3], rows[:, 6:9]
        inside = (now[:, 2] >= 1.0) & (now[:, 2] <= 3.0)
        seen.add(tuple(inside))
        # Uniform motion: the drag depends on who is there only, and v' of the last solve is that of now.
        if inside.any():
            assert largest_difference(F, selected_forces(now, rows[:, 3:6], inside)) < 1e-10, step
        else:
            assert np.abs(F).max() == 0.0, step
    assert len(seen) >= 5


def per_rank_megabytes(log):
    return float(re.search(r"Per MPI rank memory allocation .* = [0-9.]+ \| [0-9.]+ \| ([0-9.]+) Mbytes", log).group(1))


@pytest.mark.parametrize("ranks", [1, 2])
def test_bystanders_are_not_in_the_list(tmp_path, ranks):
    """Every 50th of 8000 spheres is in the group: its forces are those without the others, and the list of pairs, 150
    of 200 neighbours a sphere for all, is not what the run takes memory for."""
    side = 20
    x = 2.2 * A * np.stack(np.meshgrid(*3 * [np.arange(side)], indexing="ij"), axis=-1).reshape(-1, 3)
    rng = np.random.default_rng(4)
    spheres = Spheres(x + rng.uniform(-0.1, 0.1, x.shape), A, rng.normal(size=x.shape))
    chosen = np.arange(3, len(x), 50)
    box = [(-1.0, 2.2 * A * side)] * 3
    forces, memory = {}, {}
    for name, those, words in (("all", spheres, ""), ("group", spheres, "group part"),
                               ("alone", Spheres(spheres.x[chosen], A, spheres.v[chosen]), "")):
        folder = tmp_path / name
        folder.mkdir()
        lines = input_lines(those, f"cut_off_distance 6 taper wendland {EXACT} {words}", folder / "data", box=box,
                            before_pair="group part id " + " ".join(str(i + 1) for i in chosen) if words else "")
        log = lmp(folder, lines + dump_lines(folder / "dump") + ["run 0"], ranks=ranks).log
        forces[name] = read_dump(folder / "dump")[0][1][:, 6:9]
        memory[name] = per_rank_megabytes(log)
    assert largest_difference(forces["group"][chosen], forces["alone"]) < 1e-10
    assert np.abs(np.delete(forces["group"], chosen, axis=0)).max() == 0.0
    others = memory["all"] - memory["alone"]
    assert memory["group"] - memory["alone"] < 0.4 * others, memory


@pytest.mark.parametrize("ranks", [1, 2])
def test_newcomers_between_two_re_neighbourings(tmp_path, ranks):
    """Spheres fly into a region under a wide skin; nobody re-neighbours for 40 steps. The forces are those of a list
    that is made afresh in every step."""
    rng = np.random.default_rng(6)
    x = 2.4 * A * np.stack(np.meshgrid(*3 * [np.arange(5)], indexing="ij"), axis=-1).reshape(-1, 3)
    spheres = Spheres(x, A, rng.uniform(-0.5, 0.5, x.shape))
    forces = {}
    for name, neigh, skin in (("lazy", "every 20 delay 40 check no", 3.0), ("eager", "every 1 delay 0 check no", 0.3)):
        folder = tmp_path / name
        folder.mkdir()
        lines = input_lines(spheres, f"cut_off_distance 3.1 taper wendland {EXACT} region slab", folder / "data",
                            box=[(-4.0, 11.0)] * 3, before_pair="region slab block INF INF INF INF 0.2 3.2\n"
                            f"neighbor {skin} bin\n"
                            f"neigh_modify {neigh}\ncomm_modify cutoff 7", dt=0.02)
        lines += ["unfix drag", "fix drag all stokes_dynamics apply no", "fix move all nve/sphere"]
        lmp(folder, lines + dump_lines(folder / "dump") + ["run 60"], ranks=ranks)
        forces[name] = [rows[:, 6:9] for _, rows in read_dump(folder / "dump")]
    inside = [tuple(np.abs(F).max(axis=1) > 0.0) for F in forces["eager"]]
    assert len(set(inside)) > 10
    for step in range(61):
        assert largest_difference(forces["lazy"][step], forces["eager"][step]) < 1e-9, step


def test_list_made_while_two_spheres_are_apart(tmp_path):
    """Two spheres swing by 0.9 about places 5.8 apart, less than half the skin of 2 each. A third joins in step 10,
    when they are 7.6 apart; in step 25 they come by at 4.53 and see each other, by a cut-off of 5, though LAMMPS has
    not re-neighboured."""
    spheres = Spheres([(0, 0, 0), (5.8, 0, 0), (3, 8, -0.3)], A, [(0, 0, 0.3), (0, 0.2, 0), (0, 0, 0)])
    lines = input_lines(spheres, f"cut_off_distance 5 {EXACT} region above", tmp_path / "data", box=[(-12.0, 18.0)] * 3,
                        dt=0.1, before_pair="region above block INF INF INF INF -0.01 INF\nneighbor 2 bin\n"
                                            "neigh_modify every 1 delay 0 check yes\ncomm_modify cutoff 9")
    lines += ["unfix drag", "fix drag all stokes_dynamics apply no", "group one id 1", "group two id 2",
              "group three id 3", "fix a one move wiggle -0.9 0 0 4", "fix b two move wiggle 0.9 0 0 4",
              "fix c three move linear 0 0 0.3"]
    log = lmp(tmp_path, lines + dump_lines(tmp_path / "dump") + ["run 25"]).log
    rows = read_dump(tmp_path / "dump")[-1][1]
    assert "Neighbor list builds = 0" in log
    assert rows[1, 0] - rows[0, 0] == pytest.approx(4.53, abs=0.01)
    sees = np.array([[0, 1, 0], [1, 0, 0], [0, 0, 0]], bool)
    assert largest_difference(rows[:, 6:9], model.forces(Spheres(rows[:, 0:3], A, rows[:, 3:6]), ETA,
                                                         sees=sees)) < 1e-10


def test_rigid_clump_that_leaves_the_region_keeps_nothing(simulation):
    spheres = row_of_five()
    spheres.molecule[:] = (1, 1, 1, 3, 3)
    sim = simulation(spheres, f"clumps_only yes rigid_clumps yes rotation yes {EXACT} region slab",
                     comm="comm_modify cutoff 12", before_pair="variable gone equal -100*(step>1)\n"
                                 "region slab block INF INF INF INF INF 20 move NULL NULL v_gone")
    sim.run(1)
    assert np.abs(sim.fix_rows()[:, [2, 5]]).min() > 0.0    # F z, v' z
    sim.run(1)
    assert np.abs(sim.fix_rows()).max() == 0.0


def test_another_pair_style_with_another_group_clears_the_rows(simulation):
    """Both have made one selection: the second one's is not taken for the first one's."""
    sim = simulation(row_of_five(), f"cut_off_distance inf {EXACT}", before_pair="group part id 1:2").run()
    assert np.abs(sim.fix_rows()[:, 2]).min() > 0.0
    sim.commands(["pair_style none", f"pair_style stokes_dynamics cut_off_distance inf {EXACT} group part",
                  "pair_coeff * *"]).run()
    assert np.abs(sim.fix_rows()[2:]).max() == 0.0
    assert -sim.fix_rows()[:, 2].sum() / (STOKES * U) == pytest.approx(ROW[2], rel=1e-9)


@pytest.mark.parametrize("mode", MODES)
def test_region_that_moves(simulation, mode):
    spheres = row_of_five()
    spheres.v[:] = (0, 0, U)
    sim = simulation(spheres, f"{MODES[mode]} {EXACT} region slab", comm="comm_modify cutoff 12", dt=0.1,
                     before_pair="variable up equal 0.1*step\n"
                                 "region slab block INF INF INF INF -0.5 2.5 move NULL NULL v_up")
    # Nothing integrates: the spheres stay, the region rises.
    counts = set()
    for step in range(60):
        sim.run(1 if step else 0)
        z = spheres.x[:, 2] - 0.1 * step
        inside = (z >= -0.5) & (z <= 2.5)
        if np.abs(np.concatenate([z + 0.5, z - 2.5])).min() < 1e-6:
            continue                                     # on the border, where rounding decides
        counts.add(inside.sum())
        assert np.array_equal(np.abs(sim.drag).max(axis=1) > 0, inside)
        if inside.any():
            assert largest_difference(sim.drag, selected_forces(spheres.x, spheres.v, inside)) < 1e-10
    assert counts == {1, 2, 3}


# --- where LAMMPS keeps an atom, and when it looks --------------------------------------------------------------------


@pytest.mark.parametrize("mode", MODES)
def test_a_sphere_beyond_a_periodic_face_is_where_its_image_is(simulation, mode):
    """LAMMPS wraps it when it re-neighbours, which is not in this run."""
    far = MODES[mode].replace("inf", "4.5")    # sums over a periodic box are not what this is about
    spheres = Spheres([(9.95, 3, 5), (5.0, 5, 2), (0.05, 6, 5)], A, [(1, 0, 0), (0, 1, 0), (-1, 0, 0)])
    sim = simulation(spheres, f"{far} {EXACT} region left", boundary="p p p", box=[(0.0, 10.0)] * 3, dt=0.1,
                     comm="comm_modify cutoff 5",
                     before_pair="region left block 0 5.5 INF INF INF INF\nneighbor 2 bin\n"
                                 "neigh_modify delay 1000 every 1000 check no")
    sim.commands(["unfix drag", "fix drag all stokes_dynamics apply no", "fix move all nve/sphere"])
    for step, inside in ((0, [1, 2]), (1, [0, 1])):
        sim.run(step)
        taking_part = np.abs(sim.drag).max(axis=1) > 0.0
        assert list(np.nonzero(taking_part)[0]) == inside, step


def grouped(simulation, runs, every=1, steps="1"):
    """A sphere goes down across z = 6 in step 3; fz of every step, by the group that LAMMPS itself fills"""
    sim = simulation(Spheres([(6, 6, 6.025), (8, 6, 3)], A, (0, 0, -1)), f"cut_off_distance inf {EXACT} group low",
                     box=[(0, 12)] * 3, dt=0.01, before_pair="region low block INF INF INF INF INF 6\n"
                                                             f"group low dynamic all region low every {every}")
    sim.commands(["unfix drag", "fix drag all stokes_dynamics apply no", "fix down all move linear 0 0 -1"])
    forces = []
    for n in runs:
        for k in range(n):
            sim.run(1, "post no" if k == 0 else "pre no post no")
            forces.append(sim.drag[0, 2])
    return forces


@pytest.mark.parametrize("runs", [(6,), (3, 3), (1, 1, 4)])
def test_a_dynamic_group_is_that_of_the_step(simulation, runs):
    """Also where LAMMPS fills it only after the pair styles; and a run in pieces is the run in one."""
    forces = np.array(grouped(simulation, runs))
    assert np.all(forces[:2] == 0.0) and np.all(forces[2:] > 0.5 * STOKES)


def test_a_dynamic_group_has_those_that_a_periodic_face_brings(simulation):
    """In the step in which LAMMPS wraps it, a sphere is in the region at the other side."""
    sim = simulation(Spheres([(3, 3, 9.995)], A, (0, 0, 1)), f"clumps_only yes {EXACT} group bottom", boundary="p p p",
                     box=[(0.0, 10.0)] * 3, dt=0.01, before_pair="neigh_modify delay 0 every 1 check no\n"
                                          "region bottom block INF INF INF INF 0 1\n"
                                          "group bottom dynamic all region bottom every 1")
    sim.commands(["unfix drag", "fix drag all stokes_dynamics apply no", "fix move all nve/sphere"]).run(1)
    assert sim.x[0, 2] < 0.01 and sim.drag[0, 2] == pytest.approx(-STOKES, rel=1e-9)
