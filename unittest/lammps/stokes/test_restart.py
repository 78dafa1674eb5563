"""A run that is broken and continued, in the same input or from a restart file, is the unbroken run: to 1e-10."""
import pathlib

import numpy as np
import pytest

import model
from host import by_open_mpi
from system import LammpsError, Spheres, chain, dump_lines, input_lines, largest_difference, lmp, read_dump

ETA, A = 1.3, 0.7
BOX = [(-20.0, 20.0)] * 3
LIMIT = 1e-10
COLUMNS = "x y z vx vy vz f_drag[1] f_drag[2] f_drag[3] f_drag[4] f_drag[5] f_drag[6]"

MODES = {"all": "cut_off_distance inf", "list": "cut_off_distance 15", "clump": "clumps_only yes"}
SOLVERS = {"exact": "algorithm 2 relative_tolerance 1e-12", "loose": "algorithm 2 relative_tolerance 1e-2"}


def scene(kind):
    """free: seven spheres of two molecules that integrate freely. rigid: two clumps."""
    rng = np.random.default_rng(6)
    x = np.vstack([chain(4, 1.5, axis=0).x, chain(3, 1.3, axis=1).x + (0.5, 2.5, 2.0)])
    if kind == "free":
        return Spheres(x, rng.uniform(0.5, 0.9, 7), 0.3 * rng.normal(size=(7, 3)), [1] * 4 + [2] * 3)
    v = np.zeros((7, 3))
    for part, w in ((slice(0, 4), (0.3, 0.2, 0.5)), (slice(4, 7), (-0.2, 0.4, 0.1))):
        v[part] = np.cross(w, x[part] - x[part].mean(axis=0)) + (0.1, 0.2, -0.3)
    return Spheres(x, A, v, [1] * 4 + [2] * 3)


INTEGRATORS = {"free": "fix move all nve/sphere", "rigid": "fix move all rigid/small molecule"}


def style(mode, n, solver, add_force="no"):
    return f"{MODES[mode]} visc {ETA} update_every {n} {SOLVERS[solver]} add_force {add_force}"


def rest(kind):
    """What a restart file does not hold. Rigid bodies come last: when a run starts they see the forces of the fixes
    before."""
    return ["fix drag all stokes_dynamics", "fix pull all gravity 1.5 vector 0.3 0 -1", INTEGRATORS[kind],
            "thermo_style custom step"]


def begin(kind, words, data, newton="on"):
    return input_lines(scene(kind), words, data, boundary="f f f", box=BOX, fix=False, dt=0.01,
                       comm="comm_modify cutoff 16", before_pair="neigh_modify every 1 delay 0",
                       newton=newton) + rest(kind)


def proceed(kind, restart, newton="on"):
    return [f"newton {newton}", "plugin load stokesdynplugin.so", f"read_restart {restart}", "comm_modify cutoff 16",
            "neigh_modify every 1 delay 0", "timestep 0.01"] + rest(kind)


def last(sim):
    return np.hstack([sim.x, sim.v, sim.fix_rows()[:, :6]])


@pytest.fixture(scope="module")
def unbroken(tmp_path_factory):
    """State after 100 steps in one run, for each kind of scene and style."""
    known = {}

    def get(kind, words):
        if (kind, words) not in known:
            folder = tmp_path_factory.mktemp("unbroken")
            lines = begin(kind, words, folder / "data") + dump_lines(folder / "dump", every=100,
                                                                     columns=COLUMNS) + ["run 100"]
            lmp(folder, lines)
            known[kind, words] = read_dump(folder / "dump")[-1][1]
        return known[kind, words]

    return get


CASES = [(kind, mode, n, solver, stop)
         for kind in INTEGRATORS for mode in MODES for n in (1, 7) for solver in SOLVERS for stop in (50, 49)
         if (n, stop) != (1, 49)]


def label(case):
    return "-".join(map(str, case))


@pytest.mark.parametrize("case", CASES, ids=label)
def test_two_runs_are_one(simulation, unbroken, tmp_path, case):
    kind, mode, n, solver, stop = case
    words = style(mode, n, solver)
    sim = simulation().commands(begin(kind, words, tmp_path / "data")).run(stop).run(100 - stop)
    assert np.abs(last(sim) - unbroken(kind, words)).max() < LIMIT


@pytest.mark.parametrize("case", CASES, ids=label)
def test_restart_file_in_a_new_instance_continues(simulation, unbroken, tmp_path, case):
    kind, mode, n, solver, stop = case
    words = style(mode, n, solver)
    simulation().commands(begin(kind, words, tmp_path / "data")).run(stop).command(f"write_restart {tmp_path}/mid")
    sim = simulation().commands(proceed(kind, tmp_path / "mid")).run(100 - stop)     # no pair_style line
    assert np.abs(last(sim) - unbroken(kind, words)).max() < LIMIT


@pytest.mark.parametrize("kind", INTEGRATORS)
@pytest.mark.parametrize("n", [1, 7])
def test_restart_file_written_within_a_run_continues(simulation, unbroken, tmp_path, kind, n):
    words = style("all", n, "loose")
    simulation().commands(begin(kind, words, tmp_path / "data")).commands(f"restart 50 {tmp_path}/mid").run(100)
    sim = simulation().commands(proceed(kind, tmp_path / "mid.50")).run(50)
    assert np.abs(last(sim) - unbroken(kind, words)).max() < LIMIT


BETWEEN = {"pushed": "velocity all set 3 0 0", "displaced": "displace_atoms all random 0.2 0.2 0.2 77 units box",
           "resized": "set group all diameter 1.1", "box": "change_box all z final -20 40 units box"}


@pytest.mark.parametrize("between", BETWEEN)
@pytest.mark.parametrize("inertia", [True, False])
def test_what_has_changed_since_the_run_is_seen_in_the_file_too(simulation, tmp_path, inertia, between):
    """Forces, v' and velocities from before the change are not those of the run that begins behind it, in the script or
    from the file."""
    drag = ["fix drag all stokes_dynamics", INTEGRATORS["free"]]
    move = drag if inertia else ["fix move all stokes_dynamics/overdamped"]
    rows = "f_drag[1]" if inertia else "f_move[1]"
    proceed = ["fix pull all gravity 1.5 vector 0.3 0 -1", *move, "timestep 0.01"]
    begin = input_lines(scene("free"), "cut_off_distance inf visc 1.3" + " update_every 7" * inertia, tmp_path / "data",
                        boundary="p p p", box=BOX, fix=False)

    def one_step(sim):
        columns = f"x y z vx vy vz {rows}"
        sim.commands(dump_lines(tmp_path / "dump", every=1, columns=columns) + ["run 1", "undump out"])
        return np.vstack([frame for _, frame in read_dump(tmp_path / "dump")])

    def changed():
        return simulation().commands(begin + proceed).run(5).commands([BETWEEN[between]])

    here = one_step(changed())
    changed().command(f"write_restart {tmp_path}/mid")
    there = one_step(simulation().commands(["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/mid",
                                            *proceed]))
    assert np.abs(there - here).max() < LIMIT


def test_atoms_deleted_behind_a_restart_file_leave_the_others_their_rows(simulation, tmp_path):
    """How a clump has turned is in the file alone. LAMMPS does not move it with the atoms that take the places of those
    deleted, until a fix has it."""
    clumps = Spheres([(2 * k, y, 0) for y in (-9, 0, 9) for k in range(3)], molecule=np.repeat([1, 2, 3], 3))
    fix = ["group head id 1 4 7", "variable T atom 30*(id<4)-90*(id>6)", "timestep 0.5",
           "fix move all stokes_dynamics/overdamped torque head 10 0 v_T body yes"]
    gone = ["group gone id 1 2 3", "delete_atoms group gone compress no"]
    read = ["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/mid"]
    sim = simulation(clumps, "cut_off_distance inf visc 1 rotation yes rigid_clumps yes", box=BOX, fix=False)
    sim.commands(fix).run(10).commands([f"write_restart {tmp_path}/mid", *gone]).run(4)
    here = np.hstack([sim.x, sim.fix_rows("move")[:, 9:13]])
    sim = simulation().commands(read + fix + gone).run(4)
    there = np.hstack([sim.x, sim.fix_rows("move")[:, 9:13]])
    assert np.abs(there - here).max() < 1e-3 and np.abs(here[0] - here[3])[3:].max() > 0.1
    with pytest.raises(LammpsError, match="atom [789] stands where the restart file has another one: give this fix "
                                          "before delete_atoms"):
        simulation().commands(read + gone + fix)


@pytest.mark.parametrize("restart", [False, True])
@pytest.mark.parametrize("warm", ["no", "yes"])
def test_a_run_goes_on_with_algorithm_2_though_algorithm_1_would_converge_by_now(simulation, tmp_path, warm, restart):
    """Three touching spheres, where it diverges, come apart. A loose tolerance shows which algorithm the later forces
    are of."""
    apart = Spheres(chain(3, 2 * A).x, A, [(0, 0, -0.5), (0.2, 0, 0.4), (0, 0, 1.3)])
    lines = input_lines(apart, f"cut_off_distance inf visc {ETA} relative_tolerance 0.05 warm_start {warm}",
                        tmp_path / "data", box=BOX, fix=False, dt=0.1) + ["fix drag all stokes_dynamics apply no",
                                                                          "fix move all nve"]
    whole = last(simulation().commands(lines).run(40))
    sim = simulation().commands(lines).run(20)
    if restart:
        sim.command(f"write_restart {tmp_path}/mid")
        sim = simulation().commands(["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/mid", "timestep 0.1"] +
                                    lines[-2:])
    assert np.abs(last(sim.run(20)) - whole).max() < LIMIT
    other = simulation().commands([line.replace("relative", "algorithm 2 relative") for line in lines]).run(40)
    assert np.abs(last(other)[:, 6:] - whole[:, 6:]).max() < LIMIT
    first = simulation(Spheres(whole[:, :3], A, whole[:, 3:6]),
                       f"cut_off_distance inf visc {ETA} relative_tolerance 0.05").run()
    assert first.iterations > 0 and np.abs(first.drag - whole[:, 6:9]).max() > 1e3 * LIMIT


def test_force_inside_the_pair_style_continues(simulation, tmp_path):
    lines = begin("free", style("all", 7, "exact", "yes"), tmp_path / "data")
    whole = last(simulation().commands(lines).run(100))
    simulation().commands(lines).run(50).command(f"write_restart {tmp_path}/mid")
    assert np.abs(last(simulation().commands(proceed("free", tmp_path / "mid")).run(50)) - whole).max() < LIMIT


@pytest.mark.parametrize("kind", INTEGRATORS)
@pytest.mark.parametrize("mode", by_open_mpi(MODES))
@pytest.mark.parametrize("write,read", [(2, 1), (1, 2)])
def test_restart_on_another_number_of_ranks_continues(unbroken, tmp_path, kind, mode, write, read):
    words = style(mode, 7, "exact")
    lmp(tmp_path, begin(kind, words, tmp_path / "data") + ["run 50", f"write_restart {tmp_path}/mid"], ranks=write)
    lmp(tmp_path, proceed(kind, tmp_path / "mid") + dump_lines(tmp_path / "dump", every=100, columns=COLUMNS) +
        ["run 50"],
        ranks=read)
    assert np.abs(read_dump(tmp_path / "dump")[-1][1] - unbroken(kind, words)).max() < LIMIT


def test_restart_within_hybrid_overlay_continues(simulation, tmp_path):
    """Contacts without damping or friction: those follow the velocity, and LAMMPS does not continue them exactly.
    LAMMPS wants the pair_coeff lines of a hybrid style again."""
    gran = "gran/hooke 500 NULL 0 NULL 0 0"
    coefficients = ["pair_coeff * * gran/hooke", "pair_coeff * * stokes_dynamics"]
    hybrid = [f"pair_style hybrid/overlay {gran} stokes_dynamics {style('all', 7, 'exact')}"] + coefficients
    lines = input_lines(scene("free"), hybrid, tmp_path / "data", box=BOX, newton="off", fix=False, dt=0.01,
                        comm="comm_modify vel yes") + rest("free")
    whole = last(simulation().commands(lines).run(100))
    simulation().commands(lines).run(50).command(f"write_restart {tmp_path}/mid")
    again = ["newton off", "plugin load stokesdynplugin.so", f"read_restart {tmp_path}/mid", "comm_modify vel yes",
             "timestep 0.01"]
    again += coefficients + rest("free")
    assert np.abs(last(simulation().commands(again).run(50)) - whole).max() < LIMIT


def test_restart_keeps_every_keyword(simulation, tmp_path):
    words = (f"cut_off_distance 9.5 visc {ETA} update_every 3 region part group some relative_tolerance 1e-9 "
             "max_iter 77 algorithm 2 fluid_velocity 0.1 v_u 0.3 tensor oseen")
    extra = ["region part block INF INF INF INF INF 1.5", "variable u equal 0.01*step"]
    spheres = Spheres(chain(5, 3.0).x, A, (0.1, 0.2, 0.3))
    options = dict(boundary="f f f", box=BOX, fix=False)
    sim = simulation(spheres, words, before_pair="\n".join(extra + ["group some id 1 2 3"]), **options)
    sim.commands("fix drag all stokes_dynamics").run(5).command(f"write_restart {tmp_path}/mid")
    expected, vector = sim.drag, sim.fix_vector()
    sim = simulation().commands(["plugin load stokesdynplugin.so",
                                 f"read_restart {tmp_path}/mid"] + extra + ["fix drag all stokes_dynamics"]).run()
    assert largest_difference(sim.drag, expected) < 1e-9
    assert sim.fix_vector()[3] == vector[3]


def test_restart_keeps_the_viscosity_that_fix_adapt_has_set(simulation, tmp_path):
    sim = simulation().commands(begin("free", style("all", 1, "exact"), tmp_path / "data"))
    sim.commands(["variable eta equal 1.3+0.02*step", "fix vary all adapt 1 pair stokes_dynamics visc * * v_eta"]).run(
        20)
    sim.command(f"write_restart {tmp_path}/mid")
    before = sim.x, sim.v
    sim = simulation().commands(proceed("free", tmp_path / "mid"))
    sim.command("velocity all set 0.1 0.2 -0.3")
    sim.run()
    spheres = Spheres(before[0], scene("free").a, (0.1, 0.2, -0.3))
    assert largest_difference(sim.drag, model.forces(spheres, 1.3 + 0.02 * 20)) < 1e-9


def test_counts_of_solves_go_on_after_a_restart(simulation, tmp_path):
    sim = simulation().commands(begin("free", style("all", 7, "exact"), tmp_path / "data")).run(50)
    solves = sim.solves
    sim.command(f"write_restart {tmp_path}/mid")
    sim = simulation().commands(proceed("free", tmp_path / "mid")).run()
    assert sim.solves == solves == 8                      # steps 0, 7, ... 49


@pytest.mark.parametrize("n", [1, 7])
def test_same_pair_style_line_after_the_restart_continues(simulation, unbroken, tmp_path, n):
    """Many input scripts give the pair_style line whether they restart or not."""
    words = style("all", n, "exact")
    simulation().commands(begin("free", words, tmp_path / "data")).run(50).command(f"write_restart {tmp_path}/mid")
    lines = proceed("free", tmp_path / "mid")
    sim = simulation().commands(lines + [f"pair_style stokes_dynamics {words}", "pair_coeff * *"]).run(50)
    assert np.abs(last(sim) - unbroken("free", words)).max() < LIMIT


@pytest.mark.parametrize("changed", ["cut_off_distance inf visc 2.6 algorithm 2",
                                     "clumps_only yes visc 1.3 algorithm 2",
                                     "cut_off_distance 0.8 visc 1.3 algorithm 2",
                                     "cut_off_distance inf visc 1.3 algorithm 2 group some"])
def test_other_pair_style_line_after_the_restart_is_in_the_first_force(simulation, tmp_path, changed):
    simulation().commands(begin("free", style("all", 7, "exact"),
                                tmp_path / "data")).commands("group some id 1 2 3").run(50).command(
        f"write_restart {tmp_path}/mid")
    new = [f"pair_style stokes_dynamics {changed} relative_tolerance 1e-12", "pair_coeff * *"]
    sim = simulation().commands(proceed("free", tmp_path / "mid") + new).run()
    first = sim.drag
    sim.commands(new).run()                               # in the same instance new settings forget everything
    assert largest_difference(first, sim.drag) < 1e-9


def test_restart_without_the_plugin_is_refused_by_lammps(simulation, tmp_path):
    simulation().commands(begin("free", style("all", 1, "exact"),
                                tmp_path / "data")).run(1).command(f"write_restart {tmp_path}/mid")
    # newer LAMMPS may load it by itself in this process
    ended = lmp(tmp_path, f"read_restart {tmp_path}/mid", succeed=False)
    assert ended.code != 0 and "stokes_dynamics" in ended.text


def test_write_data_and_read_data(simulation, tmp_path):
    sim = simulation().commands(begin("free", style("all", 1, "exact"), tmp_path / "data")).run(20)
    sim.commands(f"mass 1 1.0\nwrite_data {tmp_path}/out.data")      # atom_style hybrid writes masses of types, too
    sim.commands("velocity all set 0.1 0.2 -0.3").run()
    expected = sim.drag
    lines = begin("free", style("all", 1, "exact"), tmp_path / "data")
    lines = [f"read_data {tmp_path}/out.data" if l.startswith("read_data") else l for l in lines]
    sim = simulation().commands(lines).commands("velocity all set 0.1 0.2 -0.3").run()
    assert largest_difference(sim.drag, expected) < 1e-9


# --- files of another version -----------------------------------------------------------------------------------------

VERSION = (pathlib.Path(__file__).resolve().parents[3] / "PKG-STOKESDYN" / "VERSION").read_bytes().strip()


def changed_restart(tmp_path, old, new):
    """A restart file after 50 steps, and the forces of that step; then the bytes `old` in it are replaced."""
    words = style("all", 1, "exact")
    lines = begin("free", words, tmp_path / "data") + dump_lines(tmp_path / "dump", every=50, columns=COLUMNS)
    lmp(tmp_path, lines + ["run 50", f"write_restart {tmp_path}/restart"])
    content = (tmp_path / "restart").read_bytes()
    assert content.count(old) == 1 and len(old) == len(new)
    (tmp_path / "restart").write_bytes(content.replace(old, new))
    return read_dump(tmp_path / "dump")[-1][1]


def test_memory_of_another_version_is_warned_of_once_and_the_run_begins_afresh(tmp_path):
    then = changed_restart(tmp_path, b"stokesdyn 1 STOKES_DYNAMICS/STATE " + VERSION,
                           b"stokesdyn 7 STOKES_DYNAMICS/STATE 9" + VERSION[1:])
    lines = proceed("free", tmp_path / "restart") + ["fix none all ave/time 1 1 1 f_drag[6]"]
    ended = lmp(tmp_path, lines + dump_lines(tmp_path / "again", columns=COLUMNS) + ["run 0"])
    said = " ".join(ended.log.split())
    assert said.count("the restart file was written by another version of the plugin, 9") == 1
    assert f"this is {VERSION.decode()}: its data for this fix are ignored" in said
    now = read_dump(tmp_path / "again")[-1][1]
    assert np.array_equal(now[:, :6], then[:, :6])
    # velocity Verlet's half step is not known any more: the forces are those of the whole velocities
    expected = model.forces(Spheres(now[:, :3], scene("free").a, now[:, 3:6]), ETA)
    assert largest_difference(now[:, 6:9], expected) < 1e-10


def change_format(tmp_path, by):
    """A restart file's bytes with another number for the format of the pair style's words, and where it stands."""
    words = VERSION + b"\n" + b"\n".join(style("all", 1, "exact").encode().split())
    lines = begin("free", style("all", 1, "exact"), tmp_path / "data")
    lmp(tmp_path, lines + ["run 1", f"write_restart {tmp_path}/restart"])
    content = bytearray((tmp_path / "restart").read_bytes())
    at = content.index(words) - 8        # the number of the format, and the length
    content[at] += by
    return at, content


def test_words_of_another_version_are_an_error_with_a_way_out(tmp_path):
    (tmp_path / "restart").write_bytes(change_format(tmp_path, 1)[1])
    ended = lmp(tmp_path, proceed("free", tmp_path / "restart"), succeed=False)
    said = " ".join(ended.text.split())
    version = VERSION.decode()
    assert f"written by another version of the plugin, {version}, in format 4; this is version {version}" in said
    assert "write_data" in said


def test_files_from_before_the_first_version_are_read(tmp_path):
    """They had the words alone, in format 2, and states without a version in their head."""
    at, content = change_format(tmp_path, -1)
    line = VERSION + b"\n"
    length = int.from_bytes(content[at + 4:at + 8], "little") - len(line)
    content = bytes(content[:at + 4]) + length.to_bytes(4, "little") + bytes(content[at + 8 + len(line):])
    head = b"stokesdyn 1 STOKES_DYNAMICS/STATE"
    assert content.count(head + b" " + line) == 1
    size = content.index(head) - 4
    shorter = int.from_bytes(content[size:size + 4], "little") - len(line)
    content = content[:size] + shorter.to_bytes(4,
                                                "little") + content[size + 4:].replace(head + b" " + line, head + b"\n")
    (tmp_path / "older").write_bytes(content)
    for name in ("restart", "older"):
        dump = dump_lines(tmp_path / f"{name}.dump", columns=COLUMNS)
        ended = lmp(tmp_path, proceed("free", tmp_path / name) + dump + ["run 1"])
        assert "another version" not in ended.log
    assert (tmp_path / "restart.dump").read_text() == (tmp_path / "older.dump").read_text()


def test_a_number_that_the_memory_does_not_know_is_left_alone(tmp_path):
    """A file of a later version, which knows one more, is read by name."""
    then = changed_restart(tmp_path, b"\nunconverged 1 ", b"\nunconvergeX 1 ")
    lmp(tmp_path, proceed("free", tmp_path / "restart") + dump_lines(tmp_path / "again", columns=COLUMNS) + ["run 0"])
    assert np.array_equal(read_dump(tmp_path / "again")[-1][1], then)
