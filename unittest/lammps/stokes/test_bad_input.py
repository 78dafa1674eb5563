"""Bad input: each case has its own error, which names the command, the keyword and the value."""
import re
import subprocess

import numpy as np
import pytest

import model
from host import PATIENCE, environment, lmp_program, mpirun
from system import LammpsError, Spheres, dump_lines, input_lines, largest_difference, lmp, read_dump

ETA, A = 1.3, 0.7
BOX = [(-9.0, 9.0)] * 3
PAIR = "Pair style stokes_dynamics"
FIX = "Fix stokes_dynamics"


def three():
    return Spheres([(-1.5, 0, 0), (0.4, 0.2, 0), (1.9, 0.3, 0.2)], A, [(0.3, 0, 0.1), (0, -0.2, 0.4), (0.1, 0.1, -0.5)],
                   molecule=1)


# keywords and values of the pair_style command -> words of the error, all of which must be there
AT_THE_COMMAND = [
    ("cut_off_distance inf", ["keyword visc is required"]),
    ("", ["keyword visc is required"]),
    ("visc 1.3", ["keyword cut_off_distance is required", "inf", "unless clumps_only yes"]),
    ("visc 1.3 clumps_only no", ["keyword cut_off_distance is required"]),
    ("cut_off_distance inf visc -1.5", ["keyword visc: '-1.5' must be > 0"]),
    ("cut_off_distance inf visc 0", ["keyword visc: '0' must be > 0"]),
    ("cut_off_distance inf visc nan", ["keyword visc: 'nan' is not a finite number"]),
    ("cut_off_distance inf visc inf", ["keyword visc: 'inf' is not a finite number"]),
    ("cut_off_distance inf visc water", ["keyword visc: 'water' is not a number"]),
    ("cut_off_distance inf visc 1.3x", ["keyword visc: '1.3x' is not a number"]),
    ("cut_off_distance inf visc v_", ["keyword visc", "'v_'"]),
    ("cut_off_distance -2 visc 1.3", ["keyword cut_off_distance: '-2' must be > 0"]),
    ("cut_off_distance 0 visc 1.3", ["keyword cut_off_distance: '0' must be > 0"]),
    ("cut_off_distance nan visc 1.3", ["keyword cut_off_distance: 'nan' is not a finite number"]),
    ("cut_off_distance far visc 1.3", ["keyword cut_off_distance: 'far' is not a number"]),
    ("cut_off_distance -inf visc 1.3", ["keyword cut_off_distance: '-inf' is not a finite number"]),
    ("cut_off_distance inf visc 1.3 relative_tolerance 0", ["keyword relative_tolerance: '0' must be > 0"]),
    ("cut_off_distance inf visc 1.3 relative_tolerance -1e-3", ["keyword relative_tolerance: '-1e-3' must be > 0"]),
    ("cut_off_distance inf visc 1.3 relative_tolerance nan",
     ["keyword relative_tolerance: 'nan' is not a finite number"]),
    ("cut_off_distance inf visc 1.3 update_every 0", ["keyword update_every: '0' must be >= 1"]),
    ("cut_off_distance inf visc 1.3 update_every -3", ["keyword update_every: '-3' must be >= 1"]),
    ("cut_off_distance inf visc 1.3 update_every 2.5", ["keyword update_every: '2.5' is not an integer"]),
    ("cut_off_distance inf visc 1.3 update_every 99999999999", ["keyword update_every: '99999999999' must be <="]),
    ("cut_off_distance inf visc 1.3 max_iter 0", ["keyword max_iter: '0' must be >= 1"]),
    ("cut_off_distance inf visc 1.3 max_iter -1", ["keyword max_iter: '-1' must be >= 1"]),
    ("cut_off_distance inf visc 1.3 max_iter many", ["keyword max_iter: 'many' is not an integer"]),
    ("cut_off_distance inf visc 1.3 algorithm 3", ["keyword algorithm: '3' is none of: 1, 2"]),
    ("cut_off_distance inf visc 1.3 algorithm 0", ["keyword algorithm: '0' is none of: 1, 2"]),
    ("cut_off_distance inf visc 1.3 tensor stokeslet", ["keyword tensor: 'stokeslet' is none of: rpy, oseen"]),
    ("cut_off_distance inf visc 1.3 clumps_only maybe", ["keyword clumps_only: 'maybe' is none of: no, yes"]),
    ("cut_off_distance inf visc 1.3 add_force on", ["keyword add_force: 'on' is none of: no, yes"]),
    ("cut_off_distance inf visc 1.3 viscosity 2",
     ["unknown keyword 'viscosity'", "those that there are: cut_off_distance, update_every"]),
    ("cut_off_distance inf visc 1.3 temperature 1 77",
     ["unknown keyword 'temperature': it is a keyword of fix stokes_dynamics/overdamped"]),
    ("cut_off_distance inf visc 1.3 2.0", ["unknown keyword '2.0'"]),
    ('cut_off_distance inf visc 1.3 region ""', ["keyword region: '' is empty"]),
    ('cut_off_distance inf visc 1.3 group ""', ["keyword group: '' is empty"]),
    ("cut_off_distance inf visc 1.3 fluid_velocity 1 2", ["keyword fluid_velocity: value missing after '2'"]),
    ("cut_off_distance inf visc 1.3 fluid_velocity 1 nan 3", ["keyword fluid_velocity: 'nan' is not a finite number"]),
    ("cut_off_distance inf visc 1.3 fluid_velocity 1 up 3", ["keyword fluid_velocity: 'up' is not a number"]),
]
AT_THE_COMMAND += [(f"cut_off_distance inf visc {number}", [f"keyword visc: '{number}' is not a number"])
                   for number in ("0x10", "-0X1p-3", "1.5f", "1_000", "+", "--1")]
AT_THE_COMMAND += [("cut_off_distance 0x10 visc 1.3", ["keyword cut_off_distance: '0x10' is not a number"]),
                   ("cut_off_distance inf visc 1.3 max_iter 0x10", ["keyword max_iter: '0x10' is not an integer"]),
                   ("cut_off_distance inf visc 1.3 max_iter ++1", ["keyword max_iter: '++1' is not an integer"]),
                   ("cut_off_distance inf visc 1.3 algorithm 2 strict", ["unknown keyword 'strict'"]),
                   ("cut_off_distance inf visc 1e999", ["keyword visc: '1e999' is not a finite number"]),
                   ("cut_off_distance inf visc 1.3 visc 1.3", ["keyword visc: given twice"]),
                   ("clumps_only yes visc 1.3 region nowhere clumps_only yes", ["keyword clumps_only: given twice"])]
AT_THE_COMMAND += [(f"{cut} visc 1.3 {words}", [expected]) for cut, words, expected in (
    ("cut_off_distance 9", "rotation yes lubrication yes",
     "keyword lubrication: yes requires cut_off_distance inf and clumps_only no"),
    ("clumps_only yes", "rotation yes lubrication yes",
     "keyword lubrication: yes requires cut_off_distance inf and clumps_only no"),
    ("cut_off_distance inf", "lubrication yes", "keyword lubrication: yes requires rotation yes"),
    ("cut_off_distance inf", "multiblob 13", "keyword multiblob: '13' must be 1, 12, 42 or 162"),
    ("cut_off_distance inf", "multiblob 12 half", "keyword multiblob: 'half' goes with 42 points alone"),
    ("cut_off_distance inf", "multiblob 12 multiblob_most 100",
     "keyword multiblob_most: '100' must be 12, 42, 162 or 642"),
    ("cut_off_distance inf", "multiblob 42 multiblob_most 12",
     "keyword multiblob_most: '12' must not be less than multiblob, 42"),
    ("cut_off_distance inf", "multiblob_most 42", "keyword multiblob_most requires multiblob"),
    ("cut_off_distance 9", "multiblob 12", "keyword multiblob: '12' requires cut_off_distance inf and clumps_only no"),
    ("clumps_only yes", "multiblob 12", "keyword multiblob: '12' requires cut_off_distance inf and clumps_only no"),
    ("cut_off_distance inf", "multiblob 12 tensor oseen",
     "keyword multiblob is not available with tensor oseen: use tensor rpy"),
    ("cut_off_distance inf", "multiblob 12 rigid_clumps yes shell 12",
     "keyword multiblob: the spheres of rigid clumps are shells of points already; leave out shell"),
    ("cut_off_distance inf", "multiblob 42 rotation no",
     "keyword multiblob: shells of points always rotate; leave out rotation no"),
    ("cut_off_distance inf", "multiblob 12 algorithm 2 precondition sparse",
     "keyword multiblob has its own preconditioner"),
    ("cut_off_distance inf", "multiblob 12 lubrication yes lubrication_range 3",
     "keyword lubrication_range: '3' must be <= 2 with multiblob"),
    ("cut_off_distance inf", "one_body no", "keyword one_body requires multiblob"),
    ("cut_off_distance inf", "lubrication on", "keyword lubrication: 'on' is none of: no, yes"),
    ("cut_off_distance inf", "rotation yes lubrication_gap 1e-3", "keyword lubrication_gap requires lubrication yes"),
    ("cut_off_distance inf", "rotation yes lubrication no lubrication_range 1",
     "keyword lubrication_range requires lubrication yes"),
    ("cut_off_distance inf", "rotation yes lubrication yes lubrication_gap 1e-7",
     "keyword lubrication_gap: '1e-7' must be >= 1e-6"),
    ("cut_off_distance inf", "rotation yes lubrication yes lubrication_gap 0",
     "keyword lubrication_gap: '0' must be > 0"),
    ("cut_off_distance inf", "rotation yes lubrication yes lubrication_range 8.5",
     "keyword lubrication_range: '8.5' must be <= 8"),
    ("cut_off_distance inf", "rotation yes lubrication yes lubrication_gap 0.1 lubrication_range 0.1",
     "keyword lubrication_gap: '0.1' must be below lubrication_range, 0.1"))]
AT_THE_COMMAND += [(keyword, [f"keyword {keyword}: value missing"])
                   for keyword in ("cut_off_distance", "update_every", "clumps_only", "visc", "region", "group",
                                   "add_force", "relative_tolerance",
                                   "max_iter", "algorithm", "fluid_velocity", "tensor")]


@pytest.mark.parametrize("words,expected", AT_THE_COMMAND, ids=[words or "nothing" for words, _ in AT_THE_COMMAND])
def test_pair_style_command(simulation, words, expected):
    with pytest.raises(LammpsError) as error:
        simulation(three(), words, box=BOX)
    for text in [PAIR] + expected:
        assert text in str(error.value)


@pytest.mark.parametrize("number", ["+1.3", "1.3e+0", ".13e1", "130E-02"])
def test_numbers_as_lammps_reads_them(simulation, number):
    sim = simulation(three(), f"cut_off_distance inf visc {number} max_iter +100 algorithm 2", box=BOX).run()
    assert largest_difference(sim.f, model.forces(three(), 1.3)) < 1e-2


def test_error_names_the_file_as_it_is_called_within_the_project(simulation):
    with pytest.raises(LammpsError, match=r" \(PKG-STOKESDYN/common/keywords\.cpp:[0-9]+\)"):
        simulation(three(), "cut_off_distance inf visc -1", box=BOX)


# seen when a run starts: (words, input lines before, words of the error)
AT_THE_RUN = [
    ("region nowhere", "", ["keyword region: region 'nowhere' does not exist"]),
    ("group nobody", "", ["keyword group: group 'nobody' does not exist"]),
    ("visc v_none", "", ["keyword visc: variable 'none' does not exist"]),
    ("visc v_words", "variable words string abc", ["keyword visc: variable 'words' is neither equal nor atom style"]),
    ("visc v_numbers", "variable numbers index 1 2 3",
     ["keyword visc: variable 'numbers' is neither equal nor atom style"]),
    ("fluid_velocity 0 v_none 0", "", ["keyword fluid_velocity: variable 'none' does not exist"]),
    ("fluid_velocity 0 0 v_words", "variable words string abc",
     ["keyword fluid_velocity: variable 'words' is neither equal nor atom style"]),
    ("visc v_eta", "variable eta equal -2.5", ["step 0, atom 1", "keyword visc", "-2.5"]),
    ("visc v_eta", "variable eta atom 1.3-2*(id==2)", ["step 0, atom 2", "keyword visc", "-0.7"]),
    ("visc v_eta", "variable eta atom 0*id", ["step 0, atom 1", "keyword visc", "must be > 0"]),
    ("visc v_eta", "variable eta equal 0*exp(999)", ["step 0, atom 1", "keyword visc"]),
    ("fluid_velocity 0 v_u 0", "variable u equal 0*exp(999)",
     ["step 0, atom 1", "keyword fluid_velocity", "not a finite number"]),
    ("fluid_velocity 0 v_u 0", "variable u atom exp(999*(id==3))",
     ["step 0, atom 3", "keyword fluid_velocity", "not a finite number"]),
]


@pytest.mark.parametrize("words,before,expected", AT_THE_RUN, ids=[f"{w}: {b}" for w, b, _ in AT_THE_RUN])
def test_start_of_a_run(simulation, words, before, expected):
    visc = "" if words.startswith("visc") else "visc 1.3"
    sim = simulation(three(), f"cut_off_distance inf {visc} algorithm 2 {words}", box=BOX, before_pair=before)
    with pytest.raises(LammpsError) as error:
        sim.run()
    for text in [PAIR] + expected:
        assert text in str(error.value)


@pytest.mark.parametrize("words", ["cut_off_distance 1e4", "clumps_only yes cut_off_distance 1e4"])
@pytest.mark.parametrize("ranks", [1, 2])
def test_cut_off_of_very_many_periodic_boxes(tmp_path, words, ranks):
    lines = input_lines(three(), f"{words} visc 1.3 algorithm 2", tmp_path / "data", box=BOX, boundary="p p p")
    ended = lmp(tmp_path, lines + ["run 0"], ranks=ranks, succeed=False)
    assert ended.code != 0
    for text in (PAIR, "keyword cut_off_distance: '10000'", "is it in other units?"):
        assert text in ended.text


@pytest.mark.parametrize("cutoff", ["1e12", "1e100"])
@pytest.mark.parametrize("ranks", [1, 2])
def test_cut_off_far_beyond_an_open_box_is_none(tmp_path, cutoff, ranks):
    forces = []
    for distance in (cutoff, "inf"):
        lines = input_lines(three(), f"cut_off_distance {distance} visc 1.3 algorithm 2 relative_tolerance 1e-12",
                            tmp_path / "data", box=BOX)
        lmp(tmp_path, lines + dump_lines(tmp_path / "dump", columns="f_drag[1] f_drag[2] f_drag[3]") + ["run 0"],
            ranks=ranks)
        forces.append(read_dump(tmp_path / "dump")[0][1])
    assert abs(forces[0]).max() > 0.1 and abs(forces[0] - forces[1]).max() < 1e-11 * abs(forces[1]).max()


@pytest.mark.hard_case("radius zero, negative, NaN, infinite")
@pytest.mark.parametrize("radius,seen", [(0.0, "0"), (-0.4, "-0.4"), (float("nan"), "nan")])
def test_radius_that_is_no_positive_number(simulation, radius, seen):
    sim = simulation(three(), "cut_off_distance inf visc 1.3 algorithm 2", box=BOX)
    sim.set("radius", 3, radius)
    with pytest.raises(LammpsError) as error:
        sim.run()
    for text in (PAIR, "atom 3", f"radius {seen} must be > 0"):
        assert text in str(error.value)


@pytest.mark.hard_case("radius zero, negative, NaN, infinite")
@pytest.mark.parametrize("mode", ["cut_off_distance inf", "cut_off_distance 5", "clumps_only yes"])
def test_infinite_radius(tmp_path, mode):
    """In a process of its own: it is the length that LAMMPS is told, too, and it does not survive an infinite one."""
    lines = input_lines(three(), f"{mode} visc 1.3 algorithm 2", tmp_path / "data", box=BOX,
                        before_pair="variable r atom exp(999)\ngroup one id 3\nset group one diameter v_r")
    ended = lmp(tmp_path, lines + ["run 0"], succeed=False)
    assert ended.code != 0
    assert PAIR in ended.log and "atom 3" in ended.log and "radius inf must be > 0" in ended.log


def test_atom_style_without_radius(simulation):
    sim = simulation().commands(["atom_style molecular", "boundary f f f", "plugin load stokesdynplugin.so",
                                 "region b block -9 9 -9 9 -9 9",
                                 "create_box 1 b", "create_atoms 1 single 0 0 0", "mass 1 1.0",
                                 "pair_style stokes_dynamics cut_off_distance inf visc 1.3", "pair_coeff * *"])
    with pytest.raises(LammpsError, match=f"{PAIR} requires an atom style with radius"):
        sim.run()


@pytest.mark.parametrize("words, keyword", [
    ("clumps_only yes", "clumps_only: yes"), ("cut_off_distance inf rotation yes rigid_clumps yes", "rigid_clumps"),
    ("cut_off_distance inf multiblob 12 rigid_clumps yes", "rigid_clumps")])
def test_clumps_without_molecule_ids(simulation, words, keyword):
    sim = simulation().commands(["atom_style sphere", "boundary f f f", "plugin load stokesdynplugin.so",
                                 "region b block -9 9 -9 9 -9 9",
                                 "create_box 1 b", "create_atoms 1 single 0 0 0",
                                 f"pair_style stokes_dynamics {words} visc 1.3", "pair_coeff * *"])
    with pytest.raises(LammpsError, match=f"{PAIR}: keyword {keyword} requires molecule IDs"):
        sim.run()


@pytest.mark.parametrize("molecule, words, warned", [
    ((0, 0), "rigid_clumps yes", True), ((0, -2), "rigid_clumps yes", False), ((0, 0), "", False)])
@pytest.mark.parametrize("ranks", [1, 2])
def test_rigid_clumps_where_no_sphere_is_in_one_are_warned_of(tmp_path, molecule, words, warned, ranks):
    """Data without molecule IDs ran as free spheres, without a word."""
    lines = input_lines(Spheres([(0, 0, 0), (1.4, 0, 0)], A, molecule=molecule),
                        f"clumps_only yes visc {ETA} {words}", tmp_path / "data")
    log = " ".join(lmp(tmp_path, lines + ["run 0"], ranks=ranks).log.split())
    assert ("all atoms have the molecule ID 0, so that each sphere is free" in log) == warned


def test_spheres_without_ids(simulation):
    sim = simulation().commands(["atom_style sphere", "atom_modify id no", "boundary f f f",
                                 "plugin load stokesdynplugin.so", "region b block -9 9 -9 9 -9 9", "create_box 1 b",
                                 "create_atoms 1 single 0 0 0",
                                 "pair_style stokes_dynamics cut_off_distance inf visc 1.3", "pair_coeff * *"])
    with pytest.raises(LammpsError, match=f"{PAIR} requires atom IDs"):
        sim.run()


@pytest.mark.parametrize("line,text", [("pair_coeff 1 1", f"{PAIR}: the only form of pair_coeff is: pair_coeff"),
                                       ("pair_coeff * * 1.0", f"{PAIR}: the only form of pair_coeff is: pair_coeff")])
def test_pair_coeff_has_one_form(simulation, line, text):
    sim = simulation(three(), ["pair_style stokes_dynamics cut_off_distance inf visc 1.3"], box=BOX, fix=False)
    with pytest.raises(LammpsError, match=text):
        sim.command(line)


def test_pair_coeff_is_needed(simulation):
    sim = simulation(three(), ["pair_style stokes_dynamics cut_off_distance inf visc 1.3"], box=BOX, fix=False)
    with pytest.raises(LammpsError):
        sim.run()


def test_twice_in_a_hybrid_style(simulation):
    words = "stokes_dynamics cut_off_distance inf visc 1.3"
    sim = simulation(three(), [f"pair_style hybrid/overlay {words} {words}", "pair_coeff * * stokes_dynamics 1",
                               "pair_coeff * * stokes_dynamics 2"],
                     box=BOX, fix=False)
    with pytest.raises(LammpsError, match="may appear only once in a hybrid pair style"):
        sim.run()


# --- the fix ----------------------------------------------------------------------------------------------------------

AT_THE_FIX = [("apply", ["keyword apply: value missing"]),
              ("apply maybe", ["keyword apply: 'maybe' is none of: no, yes"]),
              ("report yes", ["unknown keyword 'report'"])]


@pytest.mark.parametrize("words,expected", AT_THE_FIX, ids=[w for w, _ in AT_THE_FIX])
def test_fix_command(simulation, words, expected):
    sim = simulation(three(), "cut_off_distance inf visc 1.3", box=BOX, fix=False)
    with pytest.raises(LammpsError) as error:
        sim.command(f"fix drag all stokes_dynamics {words}")
    for text in [FIX] + expected:
        assert text in str(error.value)


def test_force_added_by_pair_style_and_fix(simulation):
    sim = simulation(three(), "cut_off_distance inf visc 1.3 add_force yes", box=BOX,
                     fix=False).commands("fix drag all stokes_dynamics apply yes")
    with pytest.raises(LammpsError) as error:
        sim.run()
    for text in (FIX, "keyword apply: 'yes'", "add_force yes", "twice"):
        assert text in str(error.value)


@pytest.mark.parametrize("one,other", [("", ""), ("apply yes", ""), ("apply yes", "apply yes")])
def test_two_fixes_that_apply(simulation, one, other):
    sim = simulation(three(), "cut_off_distance inf visc 1.3", box=BOX, fix=False)
    sim.commands([f"fix first all stokes_dynamics {one}", f"fix second all stokes_dynamics {other}"])
    with pytest.raises(LammpsError) as error:
        sim.run()
    for text in (FIX, "first", "second", "twice"):
        assert text in str(error.value)


def test_two_fixes_of_which_one_applies_are_no_error(simulation):
    sim = simulation(three(), "cut_off_distance inf visc 1.3 algorithm 2 relative_tolerance 1e-12", box=BOX)
    sim.commands("fix second all stokes_dynamics apply no").run()
    assert largest_difference(sim.f, model.forces(three(), 1.3)) < 1e-10


# --- numbers that go bad during a run ---------------------------------------------------------------------------------

MODES = {"all": "cut_off_distance inf", "list": "cut_off_distance 5", "clump": "clumps_only yes"}


@pytest.mark.hard_case("NaN or infinite position or velocity")
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("what,text", [("v", "its velocity is not a finite number"),
                                       ("x", "its position is not a finite number")])
@pytest.mark.parametrize("value", [float("nan"), float("inf")], ids=["nan", "inf"])
def test_position_or_velocity_gone_bad_between_runs(simulation, mode, what, text, value):
    sim = simulation(three(), f"{MODES[mode]} visc 1.3 algorithm 2", box=BOX, comm="comm_modify cutoff 6",
                     dt=1e-3).run(2)
    sim.set(what, 2, [0.1, value, 0.2])
    with pytest.raises(LammpsError) as error:
        sim.run(1)
    # LAMMPS may find a bad position first, when it sorts atoms into the box
    assert (text in str(error.value) and "atom 2" in str(error.value) or
            (what == "x" and "Non-numeric" in str(error.value)))


@pytest.mark.hard_case("NaN or infinite position or velocity")
@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("ranks", [1, 2])
def test_velocity_that_becomes_nan_within_a_run_stops_it_on_all_ranks(tmp_path, mode, ranks):
    lines = input_lines(three(), f"{MODES[mode]} visc 1.3 algorithm 2", tmp_path / "data", box=BOX,
                        comm="comm_modify cutoff 6", dt=1e-3)
    lines += ["fix move all nve/sphere", "variable bad atom 0*exp(999*(id==2)*(step>5))",
              "fix kick all addforce v_bad 0 0", "run 20"]
    ended = lmp(tmp_path, lines, ranks=ranks, succeed=False)
    assert ended.code != 0
    # which spoils the position in the same step, too
    assert re.search(f"{PAIR}: step [67], atom 2: its velocity is not a finite number", ended.log)


@pytest.mark.parametrize("mode", MODES)
def test_fluid_velocity_that_becomes_nan_on_one_rank_stops_all(tmp_path, mode):
    lines = input_lines(three(), f"{MODES[mode]} visc 1.3 algorithm 2 fluid_velocity v_u 0 0", tmp_path / "data",
                        box=BOX, comm="comm_modify cutoff 6",
                        before_pair="variable u atom 0*exp(999*(id==3)*(step>=5))", dt=1e-3)
    ended = lmp(tmp_path, lines + ["fix move all nve/sphere", "run 20"], ranks=2, succeed=False)
    assert ended.code != 0
    assert "step 5, atom 3: keyword fluid_velocity: the fluid velocity there is not a finite number" in ended.log


@pytest.mark.parametrize("words,text", [("cut_off_distance inf visc 1.3 algorithm 1 strict", "diverged"),
                                        ("cut_off_distance 1.6 visc 1.3 algorithm 2", "not positive definite")])
def test_failed_solve_stops_all_ranks(tmp_path, words, text):
    x = np.zeros((10, 3))
    x[:, 2] = 1.4 * np.arange(10) - 6
    lines = input_lines(Spheres(x, A, (0, 0, 0.3)), words, tmp_path / "data", box=BOX)
    ended = lmp(tmp_path, lines + ["run 0"], ranks=2, succeed=False)
    assert ended.code != 0 and f"{PAIR}: step 0: algorithm" in ended.log and text in ended.log


def in_partitions(tmp_path, lines):
    """Two of one rank each"""
    (tmp_path / "in").write_text("\n".join(lines) + "\n")
    return subprocess.run([*mpirun(2), lmp_program(), "-partition", "2x1", "-in", "in", "-log", "log", "-nocite"],
                          cwd=tmp_path, env=environment(), stdin=subprocess.DEVNULL, capture_output=True,
                          timeout=PATIENCE)


@pytest.mark.ranks(2)
def test_a_partition_that_fails_has_the_error_in_its_log(tmp_path):
    """It ends all others by MPI_Abort, with which what is still in a buffer is lost."""
    lines = input_lines(three(), "cut_off_distance inf visc ${viscosity}", tmp_path / "data", box=BOX,
                        before_pair="variable viscosity world -1 1.3")
    assert in_partitions(tmp_path, lines + ["run 0"]).returncode != 0
    assert f"ERROR: {PAIR}: keyword visc" in (tmp_path / "log.0").read_text()


@pytest.mark.ranks(2)
def test_partitions_are_told_what_one_seed_draws(tmp_path):
    lines = input_lines(three(), "cut_off_distance inf visc 1.3", tmp_path / "data", box=BOX, fix=False)
    lines += ["fix move all stokes_dynamics/overdamped temperature 0.1 4711", "run 1"]
    assert in_partitions(tmp_path, lines).returncode == 0
    for each in ("log.0", "log.1"):
        assert "partitions with one seed draw the same numbers" in (tmp_path / each).read_text()
    assert "partitions with one seed" not in lmp(tmp_path, lines).log


@pytest.mark.parametrize("words", ["cut_off_distance inf visc -1", "cut_off_distance inf visc 1.3 algorithm 3",
                                   "visc 1.3"])
def test_bad_command_stops_all_ranks(tmp_path, words):
    lines = input_lines(three(), words, tmp_path / "data", box=BOX)
    ended = lmp(tmp_path, lines + ["run 0"], ranks=2, succeed=False)
    assert ended.code != 0 and f"ERROR: {PAIR}: keyword" in ended.log
