"""What is read between runs, and by which fix, after atoms and styles have come and gone."""
import subprocess
import sys

import numpy as np
import pytest

from host import PATIENCE
from system import LammpsError, Spheres, environment, input_lines, lmp

STYLE = "cut_off_distance inf visc 1.3 algorithm 2"


def four():
    return Spheres([(0, 0, 0), (2.5, 0, 0), (0, 3, 0), (0, 0, 4)], 0.7, np.random.default_rng(3).normal(size=(4, 3)))


def test_rows_follow_their_atoms_when_one_is_deleted(simulation):
    sim = simulation(four(), STYLE, box=[(-9, 9)] * 3).run()
    before = sim.fix_rows()
    sim.commands("group gone id 2\ndelete_atoms group gone compress no")
    assert np.array_equal(sim.fix_rows(), before[[0, 2, 3]])


def test_a_created_atom_has_a_row_of_zeros_until_the_next_run(simulation):
    sim = simulation(four(), STYLE, box=[(-9, 9)] * 3).run()
    before = sim.fix_rows()
    sim.commands("create_atoms 1 single 5 5 5")
    assert np.array_equal(sim.fix_rows(), np.vstack([before, np.zeros(9)]))


def test_many_created_atoms(simulation, tmp_path):
    sim = simulation(four(), STYLE, box=[(-90, 90)] * 3).run()
    before = sim.fix_rows()
    sim.commands(["lattice sc 2", "region far block -80 -5 -80 80 -20 20", "create_atoms 1 region far",
                  f"write_dump all custom {tmp_path}/dump id f_drag[1] f_drag[9] modify sort id"])
    assert sim.n > 20000 and np.array_equal(sim.fix_rows()[:4], before) and not sim.fix_rows()[4:].any()


MOVES = "fix move all stokes_dynamics/overdamped"
# what the pair style has besides, a fix, commands before the first run and between two, what the error says
NAMES = {
    "variable of the viscosity": ("visc v_eta", "", "variable eta equal 1.3", "variable eta delete",
                                  "keyword visc: variable 'eta' does not exist"),
    "variable of the fluid": ("visc 1.3 fluid_velocity v_u 0 0", "", "variable u atom y", "variable u delete",
                              "keyword fluid_velocity: variable 'u' does not exist"),
    "another style": ("visc 1.3 fluid_velocity v_u 0 0", "", "variable u atom y",
                      "variable u delete\nvariable u equal 0.1",
                      "keyword fluid_velocity: variable 'u' is of another style than when the run was prepared"),
    "no value for all": ("visc 1.3 fluid_velocity v_u 0 0", "", "variable u atom y",
                         "variable u delete\nvariable u string y",
                         "keyword fluid_velocity: variable 'u' is neither equal nor atom style"),
    "region": ("visc 1.3 region r", "", "region r sphere 0 0 0 8", "region r delete",
               "keyword region: region 'r' does not exist"),
    "part of a region": ("visc 1.3 region r", "", "region s sphere 0 0 0 8\nregion q sphere 1 0 0 8\n"
                         "region r union 2 s q", "region s delete", "[Rr]egion .*exist"),
    "group": ("visc 1.3 group g", "", "group g id 1:4", "group g delete", "keyword group: group 'g' does not exist"),
    "held": ("visc 1.3", MOVES + " held g", "group g id 1 2", "group g delete",
             "keyword held: group 'g' does not exist"),
    "pin": ("visc 1.3 rotation yes", MOVES + " pin g", "group g id 1 2", "group g delete",
            "keyword pin: group 'g' does not exist"),
    "spin": ("visc 1.3 rotation yes", MOVES + " spin g 0 0 1", "group g id 1 2", "group g delete",
             "keyword spin: group 'g' does not exist"),
    "torque": ("visc 1.3 rotation yes", MOVES + " torque g 0 0 1", "group g id 1 2", "group g delete",
               "keyword torque: group 'g' does not exist"),
}


@pytest.mark.parametrize("name", NAMES)
def test_a_run_that_is_not_prepared_misses_what_keywords_name(simulation, name):
    """LAMMPS would read another variable's value or freed memory, and a deleted group holds nobody."""
    more, fix, before, between, says = NAMES[name]
    sim = simulation(four(), f"cut_off_distance inf algorithm 2 {more}", box=[(-9, 9)] * 3, fix=not fix,
                     before_pair=before)
    sim.commands(fix or "fix move all nve/sphere").run(1)
    sim.commands(between)
    with pytest.raises(LammpsError, match=says):
        sim.command("run 1 pre no")


@pytest.mark.parametrize("scheme", ["ab2", "midpoint"])
@pytest.mark.parametrize("command", ["write_data", "write_restart"])
def test_a_file_between_runs_loses_no_step(simulation, tmp_path, command, scheme):
    """LAMMPS begins anew to write it: the first step of a run with 'pre no' then moved nobody."""
    def fall(between, pre):
        sim = simulation(four(), STYLE, box=[(-9, 9)] * 3, fix=False, dt=0.01)
        sim.commands(f"fix pull all addforce 0 0 -1\n{MOVES} scheme {scheme}").run(2)
        sim.commands(between).command(f"run 3 {pre}")
        return sim.x

    write = f"{command} {tmp_path}/file"
    assert np.abs(fall(write, "pre yes") - fall("", "pre no")).max() < 1e-12
    with pytest.raises(LammpsError, match="leave out 'pre no' of the run command"):
        fall(write, "pre no")


@pytest.mark.parametrize("ids", ["1", "2 4"])
def test_values_of_the_fix_without_inertia_when_atoms_have_other_indices(simulation, ids):
    """Dissipation and largest speed are those of the last step, and the smallest gap that of who is there now."""
    sim = simulation(Spheres(four().x, 1.1), STYLE, box=[(-9, 9)] * 3, fix=False, dt=0.01)
    sim.commands("variable f atom id^2\nfix pull all addforce v_f 0 0\nfix move all stokes_dynamics/overdamped").run(3)
    before, power = sim.fix_vector("move"), sim.fix_scalar("move")
    sim.commands(f"group gone id {ids}\ndelete_atoms group gone compress no")
    after = sim.fix_vector("move")
    gap = min(np.linalg.norm(p - q) for k, p in enumerate(sim.x) for q in sim.x[:k]) / 1.1 - 2
    assert sim.fix_scalar("move") == power and after[0] == before[0] and after[7] == pytest.approx(gap, rel=1e-12)
    assert sim.run(0).fix_scalar("move") != power and sim.fix_vector("move")[7] == after[7]


@pytest.mark.parametrize("gone", ["pair_style none", "pair_style zero 3\npair_coeff * *"])
def test_numbers_of_the_solve_without_the_pair_style_are_a_clean_error(simulation, gone):
    sim = simulation(four(), STYLE, box=[(-9, 9)] * 3).run()
    sim.commands("variable n equal f_drag[4]")
    sim.commands(gone)
    with pytest.raises(LammpsError, match="Fix stokes_dynamics: there is no pair_style stokes_dynamics"):
        sim.command('print "${n}"')


def test_a_deleted_memory_is_a_clean_error_and_the_next_whole_run_goes_on(simulation):
    sim = simulation(four(), STYLE, box=[(-9, 9)] * 3).run()
    drag = sim.drag
    sim.command("unfix STOKES_DYNAMICS_STATE")
    assert sim.fix_vector()[5] == 0.0
    with pytest.raises(LammpsError,
                       match="Pair style stokes_dynamics: its internal fix STOKES_DYNAMICS_STATE has been deleted"):
        sim.command("run 1 pre no")
    assert np.array_equal(sim.run().drag, drag)


@pytest.mark.parametrize("algorithm", [1, 2])
def test_a_fix_of_the_user_with_the_id_of_the_memory_is_a_clean_error(tmp_path, algorithm):
    lines = input_lines(four(), f"cut_off_distance inf visc 1.3 algorithm {algorithm}", tmp_path / "data",
                        box=[(-9, 9)] * 3)
    ended = lmp(tmp_path, lines + ["fix STOKES_DYNAMICS_STATE all nve", "run 1"], succeed=False)
    assert ended.code == 1 and "the fix ID STOKES_DYNAMICS_STATE is taken by a fix of style nve" in " ".join(
        ended.text.split())


def test_a_fix_of_the_user_with_the_id_of_the_last_fix_stays_and_is_a_clean_error(simulation):
    sim = simulation(four(), STYLE, box=[(-9, 9)] * 3)
    sim.commands("fix STOKES_DYNAMICS_LAST all enforce2d\nfix go all stokes_dynamics/overdamped")
    with pytest.raises(LammpsError, match="the fix ID STOKES_DYNAMICS_LAST is taken by a fix of style enforce2d"):
        sim.run()


def test_a_fix_of_the_user_with_that_id_after_a_run(tmp_path):
    lines = input_lines(four(), STYLE, tmp_path / "data", box=[(-9, 9)] * 3)
    lines += ["run 1", "unfix STOKES_DYNAMICS_STATE", "fix STOKES_DYNAMICS_STATE all nve", "run 1 pre no"]
    ended = lmp(tmp_path, lines, succeed=False)
    assert ended.code == 1 and "is taken by a fix of style nve" in " ".join(ended.text.split())


@pytest.mark.parametrize("style", ["clumps_only yes visc 1.3 algorithm 2",
                                   "cut_off_distance 3 visc 1.3 taper wendland algorithm 2",
                                   "cut_off_distance 3 visc 1.3 taper wendland algorithm 2 precondition clump",
                                   "clumps_only yes rigid_clumps auto visc 1.3 algorithm 2"])
@pytest.mark.parametrize("ranks", [1, 2])
def test_a_run_that_blows_up_in_a_periodic_box_ends_with_atom_and_step(tmp_path, style, ranks):
    """The time step is a thousand times too long."""
    rng = np.random.default_rng(5)
    x = np.array([[i, j, k] for i in (-6, 6) for j in (-6, 6) for k in (-6, 6)], float)
    x = np.vstack([x, x + (1.9, 0.1, 0)])
    spheres = Spheres(x, 0.7, rng.normal(size=(16, 3)), molecule=np.tile(np.arange(1, 9), 2))
    lines = input_lines(spheres, style, tmp_path / "data", boundary="p p p", box=[(-12, 12)] * 3,
                        comm="comm_modify cutoff 11", dt=10.0)
    ended = lmp(tmp_path, lines + ["fix move all nve/sphere", "thermo 1000", "run 400"], ranks=ranks, succeed=False)
    assert ended.code != 0 and "ERROR" in ended.text


def test_spheres_far_outside_of_a_periodic_box_are_named(simulation):
    sim = simulation(four(), "clumps_only yes visc 1.3", boundary="p p p",
                     box=[(-9, 9)] * 3).commands("fix move all nve/sphere")
    sim.commands("neigh_modify delay 100").run(1)    # LAMMPS of 2025 loses such an atom when it re-neighbours
    sim.set("x", 3, (1e22, 0.0, 0.0))
    with pytest.raises(LammpsError,
                       match="step 2, atom 3: its position is more than a box length outside of the periodic box"):
        sim.command("run 1 pre no")


@pytest.mark.parametrize("tolerance", ["1", "2.5", "1e30"])
def test_a_tolerance_that_no_force_at_all_satisfies_is_refused(simulation, tolerance):
    with pytest.raises(LammpsError, match="keyword relative_tolerance: '.*' must be < 1"):
        simulation(four(), f"{STYLE} relative_tolerance {tolerance}")


def test_a_loose_tolerance_is_warned_of(tmp_path):
    lines = input_lines(four(), STYLE + " relative_tolerance 0.5", tmp_path / "data", box=[(-9, 9)] * 3)
    assert "keyword relative_tolerance: '0.5' allows errors of the forces of more than a tenth" in " ".join(
        lmp(tmp_path, lines).text.split())
    lines = input_lines(four(), STYLE + " relative_tolerance 0.1", tmp_path / "data", box=[(-9, 9)] * 3)
    assert "relative_tolerance" not in lmp(tmp_path, lines).log.split("pair_coeff")[1]


# --- spheres that take no part ----------------------------------------------------------------------------------------

PROGRAM = """
import sys
from lammps import lammps
lmp = lammps(cmdargs=["-log", "none", "-screen", "none", "-nocite"])
for line in open(sys.argv[1]):
    lmp.command(line)
resident = [line for line in open("/proc/self/status") if line.startswith("VmRSS")]
print(lmp.get_natoms(), 1024 * int(resident[0].split()[1]))
"""


def memory_of(tmp_path, style):
    """Atoms and resident memory of a process that has run a step, 1000 spheres of which are in the group part."""
    lines = ["units lj", "atom_style sphere", "boundary f f f", "plugin load stokesdynplugin.so",
             "atom_modify sort 0 0", "lattice sc 0.04", "region b block 0 200 0 100 0 10", "create_box 1 b",
             "create_atoms 1 box", "set group all diameter 1 density 1",
             "velocity all set 0.1 0 0", "group part id 1:1000", "neighbor 0.3 bin"] + style + ["run 1"]
    (tmp_path / "in.memory").write_text("\n".join(lines) + "\n")
    words = [sys.executable, "-c", PROGRAM, str(tmp_path / "in.memory")]
    out = subprocess.run(words, stdout=subprocess.PIPE, check=True, timeout=PATIENCE, env=environment()).stdout.split()
    return int(out[-2]), int(out[-1])


@pytest.mark.parametrize("fix", [False, True])
def test_a_bystander_costs_less_than_64_bytes(tmp_path, fix):
    style = ["pair_style stokes_dynamics cut_off_distance inf visc 1.3 algorithm 2 group part add_force " +
             ("no" if fix else "yes"),
             "pair_coeff * *"] + (["fix drag all stokes_dynamics"] if fix else [])
    n, with_style = memory_of(tmp_path, style)
    n, without = memory_of(tmp_path, ["comm_modify cutoff 1.3"])
    # beside the bystanders: the 1000 spheres and their solver, 1 MB
    assert n == 200000 and (with_style - without - 1e6) / n < 64
