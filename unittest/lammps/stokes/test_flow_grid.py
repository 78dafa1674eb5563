"""fluid_velocity grid FILE: a flow from a file is that flow, and a file that is none is told with its line."""
import importlib.util
import pathlib
import subprocess
import sys

import numpy as np
import pytest

import model
from system import LammpsError, Spheres, chain, dump_lines, input_lines, largest_difference, lmp, read_dump
from test_rotation import torques

EXAMPLES = pathlib.Path(__file__).resolve().parents[3] / "examples"
sys.path.insert(0, str(EXAMPLES))
import flow_grid    # noqa: E402

ETA, A = 1.3, 0.7
EXACT = "algorithm 2 relative_tolerance 1e-13 max_iter 500"
AXES = [np.linspace(-9, 9, 7), np.array([-9, -4.5, 0.3, 2, 9.0]), np.linspace(-9.0, 9.0, 4)]
SHEAR = np.array([[0.1, -0.3, 0.7], [0.5, 0.2, -0.4], [-0.6, 0.35, -0.3]])      # d u_p / d x_q
PUSH = np.array([0.25, -0.4, 0.15])
VARIABLES = "\n".join(f"variable u{p} atom {PUSH[p]}" + "".join(f"+({SHEAR[p][q]})*{'xyz'[q]}" for q in range(3))
                      for p in range(3))


def cloud(n=14, seed=11):
    rng = np.random.default_rng(seed)
    return Spheres(rng.uniform(-3, 3, (n, 3)), rng.uniform(0.4, 1.1, n), rng.normal(size=(n, 3)))


def linear(x):
    return PUSH + x @ SHEAR.T


def nodes(axes):
    z, y, x = np.meshgrid(*axes[::-1], indexing="ij")
    return np.stack([x, y, z], axis=-1)


@pytest.fixture
def shear(tmp_path):
    """The linear flow with a viscosity that is linear too."""
    x = nodes(AXES)
    flow_grid.write(tmp_path / "shear.grid", AXES, linear(x), 2.0 + 0.1 * x[..., 0] - 0.05 * x[..., 2])
    return tmp_path / "shear.grid"


def rows(sim):
    return np.hstack([sim.drag, torques(sim)]) if sim.fix_rows().shape[1] > 6 else sim.drag


def test_forces_in_a_linear_flow_are_those_of_its_formula(simulation, shear):
    spheres = cloud()
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} fluid_velocity grid {shear} {EXACT}").run()
    assert largest_difference(sim.drag, model.forces(spheres, ETA, linear(spheres.x))) < 1e-12


def test_viscosity_of_the_grid(simulation, shear):
    spheres = cloud()
    sim = simulation(spheres, f"cut_off_distance inf visc grid fluid_velocity grid {shear} {EXACT}").run()
    eta = 2.0 + 0.1 * spheres.x[:, 0] - 0.05 * spheres.x[:, 2]
    assert largest_difference(sim.drag, model.forces(spheres, eta, linear(spheres.x))) < 1e-12


@pytest.mark.parametrize("style", ["cut_off_distance inf rotation yes", "clumps_only yes rigid_clumps yes",
                                   "clumps_only yes rigid_clumps yes rotation yes",
                                   "clumps_only yes rigid_clumps yes shell 12"])
def test_torques_and_clumps_have_the_gradient(simulation, shear, style):
    """Against the formula's, which is differenced over a radius to either side: exact in a linear flow, to rounding."""
    spheres = Spheres(np.vstack([chain(4, 1.5, axis=0).x, (1, 2, 3) + chain(3, 1.6, axis=1).x, [(5, 5, -5)]]), A,
                      molecule=[1] * 4 + [2] * 3 + [0])
    answers = []
    for velocity in (f"grid {shear}", "v_u0 v_u1 v_u2"):
        sim = simulation(spheres, f"{style} visc {ETA} fluid_velocity {velocity} {EXACT}", box=[(-9.0, 9.0)] * 3,
                         before_pair=VARIABLES, comm="comm_modify cutoff 12")
        answers.append(rows(sim.run()))
    for part in (slice(0, 3), slice(3, 6)):
        scale = np.abs(answers[1][:, part]).max() if answers[1][:, part].size else 0.0
        if scale:
            assert np.abs(answers[0][:, part] - answers[1][:, part]).max() < 1e-12 * scale


def test_vorticity_that_is_given_goes_before_that_of_the_grid(simulation, shear):
    sphere = Spheres([(1.0, 2.0, 0.5)], A)
    sim = simulation(sphere, f"cut_off_distance inf rotation yes visc {ETA} fluid_velocity grid {shear} "
                             f"fluid_vorticity 0.2 0.4 -0.6", box=[(-9.0, 9.0)] * 3).run()
    assert np.abs(torques(sim)[0] / (8 * np.pi * ETA * A**3) - (0.1, 0.2, -0.3)).max() < 1e-12


@pytest.mark.parametrize("binary", [False, True])
def test_a_series_follows_the_time(simulation, tmp_path, binary):
    """Linear in time between uneven frames; past the last one it stays."""
    times = np.array([0.0, 0.02, 0.05])
    flow = np.stack([linear(nodes(AXES)) * (1 + 30 * t) for t in times])
    flow_grid.write(tmp_path / "series.grid", AXES, flow, times=times, beyond={"time": "clamp"}, binary=binary)
    spheres = cloud()
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} fluid_velocity grid {tmp_path}/series.grid {EXACT}",
                     dt=0.01)
    sim.commands(dump_lines(tmp_path / "dump")).run(3).run(4).close()      # nothing integrates: only the fluid changes
    steps = dict(read_dump(tmp_path / "dump"))
    assert sorted(steps) == list(range(8))
    for step, seen in steps.items():
        u = linear(spheres.x) * (1 + 30 * min(0.01 * step, 0.05))
        assert largest_difference(seen[:, 6:], model.forces(spheres, ETA, u)) < 1e-12


def vortices(path, seed=4, times=None):
    """Something that repeats itself in the box -4 to 4."""
    axes = [np.linspace(-4, 4, n) for n in (17, 13, 9)]
    x = nodes(axes) * np.pi / 4
    rng = np.random.default_rng(seed)
    frames = []
    for _ in times if times is not None else [0]:
        u = 0.0
        for _ in range(4):
            k, phase = rng.integers(-1, 2, 3), rng.uniform(0, 6)
            u = u + rng.normal(size=3) * np.sin(x @ k + phase)[..., None]
        frames.append(u)
    beyond = dict.fromkeys("xyz", "periodic")
    if times is not None:
        frames[-1] = frames[0]
        beyond["time"] = "periodic"
    flow_grid.write(path, axes, np.array(frames) if times is not None else frames[0], times=times, beyond=beyond)


def stirred(folder, words="update_every 3", **options):
    """Spheres that go with the vortices through a periodic box, and leave it."""
    spheres = Spheres(np.random.default_rng(8).uniform(-4, 4, (30, 3)), 0.3)
    return input_lines(spheres, "cut_off_distance 2 taper wendland visc 0.8 fluid_velocity grid "
                                f"{folder}/vortices.grid {EXACT} rotation yes {words}",
                       folder / "data", boundary="p p p", box=[(-4.0, 4.0)] * 3, dt=0.02,
                       before_pair="neigh_modify every 1 delay 0", **options) + ["fix move all nve/sphere"]


COLUMNS = "xu yu zu vx vy vz omegax omegay omegaz f_drag[1] f_drag[2] f_drag[3]"


@pytest.mark.parametrize("ranks,newton,neighbor", [(2, "on", ""), (4, "off", ""), (1, "off", "neighbor 1.2 bin")])
def test_ranks_newton_and_skin_leave_the_run_alone(tmp_path, ranks, newton, neighbor):
    vortices(tmp_path / "vortices.grid", times=[0, 0.5, 0.7, 1.1])
    end = dump_lines(tmp_path / "dump", every=60, columns=COLUMNS) + ["run 60"]
    lmp(tmp_path, stirred(tmp_path) + end)
    alone = read_dump(tmp_path / "dump")[-1][1]
    assert (np.abs(alone[:, :3]) > 4.0).any()        # some have left the box
    lmp(tmp_path, stirred(tmp_path, newton=newton) + [neighbor] + end, ranks=ranks)
    assert np.abs(read_dump(tmp_path / "dump")[-1][1] - alone).max() < 1e-10


def state(sim):
    """Places as points on circles: a sphere at one side of the periodic box may as well be at the other."""
    return np.hstack([np.exp(0.25j * np.pi * sim.x), sim.v, sim.fix_rows()])


@pytest.mark.parametrize("stop", [30, 31])
@pytest.mark.parametrize("way", ["runs", "restart", "timestep"])
def test_a_broken_run_goes_on_with_the_series(simulation, tmp_path, stop, way):
    """Also from a restart file, and where the steps before it had another length: LAMMPS of 2021 does not store its
    time."""
    vortices(tmp_path / "vortices.grid", times=[0, 0.5, 0.7, 1.1])
    begin = stirred(tmp_path) + (["timestep 0.01", "run 9", "timestep 0.02"] if way == "timestep" else [])
    first = 9 * (way == "timestep")
    whole = state(simulation().commands(begin).run(60 - first))
    sim = simulation().commands(begin).run(stop - first)
    if way != "runs":
        sim.command(f"write_restart {tmp_path}/mid")
        sim = simulation().commands(["plugin load stokesdynplugin.so", f"read_restart {tmp_path}/mid",
                                     "neigh_modify every 1 delay 0", "timestep 0.02", "fix drag all stokes_dynamics",
                                     "fix move all nve/sphere"])
    assert np.abs(state(sim.run(60 - stop)) - whole).max() < 1e-10


def test_spheres_without_inertia_go_with_the_flow(simulation, shear):
    """Far apart and with no force on them: their velocity is the fluid's, where they are."""
    spheres = Spheres([(-6, 0, 0), (6, 0.5, 0), (0, 1, 6.5)], 0.01)
    sim = simulation(spheres, f"cut_off_distance 1 taper wendland visc {ETA} fluid_velocity grid {shear} {EXACT}",
                     box=[(-9.0, 9.0)] * 3, fix=False, dt=0.001)
    sim.commands("fix move all stokes_dynamics/overdamped").run(7)
    assert largest_difference(sim.v, linear(sim.x)) < 1e-12 and np.abs(sim.x - spheres.x).max() > 1e-3


def test_another_file_of_the_same_name_is_another_flow(simulation, tmp_path):
    """Between two runs: the force of the last step does not stand."""
    spheres = Spheres([(1.0, 0.5, -2.0)], A)
    style = f"cut_off_distance inf visc {ETA} fluid_velocity grid {tmp_path}/vortices.grid"
    vortices(tmp_path / "vortices.grid")
    sim = simulation(spheres, style, box=[(-4.0, 4.0)] * 3).run()
    first = sim.drag
    vortices(tmp_path / "vortices.grid", seed=5)
    sim.commands([f"pair_style stokes_dynamics {style}", "pair_coeff * *"])
    second = sim.run().drag
    again = simulation(spheres, style, box=[(-4.0, 4.0)] * 3).run().drag
    assert largest_difference(second, again) < 1e-14 and np.abs(again - first).max() > 0.1 * np.abs(first).max()


# --- outside of the grid ----------------------------------------------------------------------------------------------

def channel(path, ends):
    x = nodes(AXES)
    flow_grid.write(path, AXES, linear(x) if ends != "periodic" else 0 * x + PUSH, beyond=dict.fromkeys("xyz", ends))
    return path


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_sphere_outside_of_the_grid_is_an_error(tmp_path, ranks):
    channel(tmp_path / "channel.grid", "error")
    spheres = Spheres([(1, 2, 3), (-1, 9.5, 2.0), (2, 0, 1)], A)
    words = f"cut_off_distance inf visc {ETA} fluid_velocity grid {tmp_path}/channel.grid"
    lines = input_lines(spheres, words, tmp_path / "data", box=[(-20.0, 20.0)] * 3)
    said = lmp(tmp_path, lines + ["run 0"], ranks=ranks, succeed=False)
    assert said.code != 0
    for text in ("Pair style stokes_dynamics: step 0, atom 2: keyword fluid_velocity: its position -1 9.5 2 is outside "
                 "of the grid in",
                 "channel.grid', whose y goes from -9 to 9", "clamp or periodic"):
        assert text in " ".join(said.log.split()), said.log[-900:]


def test_those_that_take_no_part_may_be_anywhere(simulation, tmp_path):
    channel(tmp_path / "channel.grid", "error")
    spheres = Spheres([(1, 2, 3), (-1, 15, 2.0)], A)
    sim = simulation(spheres, f"cut_off_distance inf visc {ETA} group here fluid_velocity grid {tmp_path}/channel.grid",
                     box=[(-20.0, 20.0)] * 3, before_pair="group here id 1").run()
    assert largest_difference(sim.drag[:1], 6 * np.pi * ETA * A * linear(spheres.x[:1])) < 1e-12


@pytest.mark.parametrize("ends", ["clamp", "periodic"])
def test_beyond_the_grid(simulation, tmp_path, ends):
    channel(tmp_path / "channel.grid", ends)
    spheres = Spheres([(1, 2, 3), (-1, 15, -13.0)], A)
    sim = simulation(spheres, f"cut_off_distance 0.1 taper wendland visc {ETA} fluid_velocity grid "
                              f"{tmp_path}/channel.grid {EXACT}",
                     box=[(-20.0, 20.0)] * 3).run()
    u = linear(np.clip(spheres.x, -9, 9)) if ends == "clamp" else PUSH
    assert largest_difference(sim.drag, 6 * np.pi * ETA * A * u * np.ones((2, 3))) < 1e-12


def test_a_series_that_has_ended_is_an_error(simulation, tmp_path):
    flow_grid.write(tmp_path / "short.grid", AXES, np.stack([linear(nodes(AXES))] * 2), times=[0.0, 0.025])
    sim = simulation(cloud(), f"cut_off_distance inf visc {ETA} fluid_velocity grid {tmp_path}/short.grid {EXACT}",
                     dt=0.01)
    with pytest.raises(LammpsError) as error:
        sim.run(5)
    for text in ("keyword fluid_velocity: step 3", "the time 0.03 is outside of the series in", "short.grid",
                 "from 0 to 0.025"):
        assert text in str(error.value)


# --- files that are none ----------------------------------------------------------------------------------------------

GOOD = """stokesdyn_grid 1
# a comment
x 3 0 4
y 2 -1 1 clamp
z 1 0
time 2 0 0.5

columns ux uy uz
rows text
"""
ROWS = "".join(f"{k} {0.5 * k} -{k}\n" for k in range(12))

# what is changed in the good file -> what the error says after the file's name
BAD = {
    "empty": (lambda text: "", ["is empty"]),
    "title": (lambda text: text.replace("grid 1", "grid 2"), ["line 1: a grid begins with 'stokesdyn_grid 1'"]),
    "another file": (lambda text: "units lj\n" + text, ["line 1: a grid begins with"]),
    "unknown word": (lambda text: text.replace("# a", "w"), ["line 2: unknown word 'w'"]),
    "axis twice": (lambda text: text.replace("# a comment", "x 2 0 1"), ["line 3: axis x is given twice"]),
    "axis missing": (lambda text: text.replace("z 1 0", ""), ["line 9: no axis z"]),
    "no columns": (lambda text: text.replace("columns ux uy uz", ""), ["line 9: no 'columns"]),
    "columns": (lambda text: text.replace("ux uy uz", "ux uz uy"), ["line 8: the columns are 'ux uy uz' or 'ux uy uz "
                                                                    "eta', not 'uz'"]),
    "two columns": (lambda text: text.replace("ux uy uz", "ux uy"), ["line 8: the columns are"]),
    "kind of rows": (lambda text: text.replace("rows text",
                                               "rows hex"), ["line 9: 'rows' is followed by 'text' or 'binary'"]),
    "header only": (lambda text: text[:text.index("time")], ["ends within its header"]),
    "nodes": (lambda text: text.replace("x 3", "x 3.5"), ["line 3: axis x: the number of nodes '3.5' must be "
                                                          "an integer >= 1"]),
    "no nodes": (lambda text: text.replace("x 3 0 4", "x"), ["line 3: axis x: the number of nodes ''"]),
    "negative nodes": (lambda text: text.replace("x 3", "x -3"), ["line 3: axis x: the number of nodes '-3'"]),
    "backwards": (lambda text: text.replace("x 3 0 4",
                                            "x 3 4 0"), ["line 3: axis x: its last node 0 must be above the first, 4"]),
    "not ascending": (lambda text: text.replace("x 3 0 4",
                                                "x 3 0 4 4"), ["line 3: axis x: node 3 at 4 is not above the "
                                                               "one before it, 4"]),
    "frames": (lambda text: text.replace("time 2 0 0.5",
                                         "time 2 0.5 0.5"), ["line 6: axis time: node 2 at 0.5 is not above"]),
    "coordinates": (lambda text: text.replace("x 3 0 4", "x 4 0 4 5"), ["line 3: axis x: 3 coordinates for 4 nodes"]),
    "nan on an axis": (lambda text: text.replace("x 3 0 4",
                                                 "x 3 0 nan"), ["line 3: axis x: 'nan' is not a finite number"]),
    "word on an axis": (lambda text: text.replace("clamp", "wrap"), ["line 4: axis y: 'wrap' is neither a number nor "
                                                                     "error, clamp, periodic"]),
    "two words": (lambda text: text.replace("clamp", "clamp periodic"), ["line 4: axis y: unexpected 'periodic'"]),
    "huge": (lambda text: text.replace("x 3",
                                       "x 900000000"), ["line 3: axis x: the file is too short for so many nodes"]),
    "vast": (lambda text: text.replace("x 3", "x 90").replace("y 2", "y 90").replace("time 2", "time 90"), [
        "line 9: after it come", "too few"]),
    "cut off": (lambda text: text[:text.index("11 5.5")] + "      \n" * 4, ["line 24: ends after 11 of 12 rows"]),
    "too many": (lambda text: text + "1 2 3\n", ["line 22: more than the 12 rows"]),
    "nan": (lambda text: text.replace("3 1.5 -3", "3 nan -3"), ["line 13: uy is not a finite number: '3 nan -3'"]),
    "letters": (lambda text: text.replace("3 1.5 -3", "3 1.5x -3"), ["line 13: no number for uy: '3 1.5x -3'"]),
    "two numbers": (lambda text: text.replace("3 1.5 -3", "3 1.5   "), ["line 13: no number for uz: '3 1.5"]),
    "four numbers": (lambda text: text.replace("3 1.5 -3",
                                               "3 1.5 -3 1"), ["line 13: more than 3 numbers: '3 1.5 -3 1'"]),
    "seam": (lambda text: text.replace("x 3 0 4", "x 3 0 4 periodic"), ["axis x is periodic, but its last node",
                                                                        "differs by"]),
}


def refused(simulation, path, what=""):
    with pytest.raises(LammpsError) as error:
        simulation(cloud(), f"cut_off_distance inf visc {ETA} fluid_velocity grid {path} {what}")
    return str(error.value)


@pytest.mark.parametrize("name", BAD)
def test_a_file_that_is_no_grid_is_told_with_its_line(simulation, tmp_path, name):
    change, expected = BAD[name]
    (tmp_path / "bad.grid").write_text(change(GOOD + ROWS))
    said = refused(simulation, tmp_path / "bad.grid")
    for text in ["Pair style stokes_dynamics: keyword fluid_velocity: grid file", "bad.grid'"] + expected:
        assert text in said, said


def test_the_good_file_is_read(simulation, tmp_path):
    (tmp_path / "good.grid").write_text(GOOD + ROWS.replace("\n", "\r\n"))
    sim = simulation(Spheres([(1, 0, 7)], A),
                     f"cut_off_distance inf visc {ETA} fluid_velocity grid {tmp_path}/good.grid").run()
    assert sim.drag[0] == pytest.approx(6 * np.pi * ETA * A * np.array([2.0, 1.0, -2.0]), rel=1e-12)


def test_a_file_that_is_not_there(simulation, tmp_path):
    assert "nowhere.grid' cannot be opened: No such file" in refused(simulation, tmp_path / "nowhere.grid")
    assert "no file that can be read" in refused(simulation, tmp_path)


def test_binary_rows_that_are_cut_off_or_no_numbers(simulation, tmp_path):
    u = linear(nodes(AXES))
    u[1, 2, 3, 1] = np.inf
    flow_grid.write(tmp_path / "bad.grid", AXES, u, binary=True)
    assert f"row {3 + 7 * (2 + 5 * 1) + 1} after line 6: uy is inf, no finite number" in refused(
        simulation, tmp_path / "bad.grid")
    flow_grid.write(tmp_path / "bad.grid", AXES, linear(nodes(AXES)), -1.0 + 0 * u[..., 0], binary=True)
    assert "row 1 after line 6: eta is -1, and must be > 0" in refused(simulation, tmp_path / "bad.grid")
    whole = (tmp_path / "bad.grid").read_bytes()
    for part in (whole[:-8], whole + b"1234"):
        (tmp_path / "bad.grid").write_bytes(part)
        assert "line 6: after it come" in refused(simulation, tmp_path / "bad.grid")


def test_bytes_of_a_file_are_printed_so_that_they_can_be(simulation, tmp_path):
    """No byte of a message is beyond UTF-8 or a control character, which terminals and LAMMPS's Python module would
    choke on."""
    for bad, shown in ((b"x 2 -20 \xfe", "\\xfe"), (b"x 2 -20 \x1b[31m", "\\x1b[31m"), ("x 2 -20 ü".encode(), "ü"),
                       (b"x 2 -20 \xed\xa0\x80", "\\xed\\xa0\\x80")):
        (tmp_path / "bad.grid").write_bytes(b"stokesdyn_grid 1\n" + bad + b"\ny 1 0\nz 1 0\ncolumns ux uy uz\n"
                                            b"rows text\n0 0 0\n0 0 0\n")
        assert shown in refused(simulation, tmp_path / "bad.grid")


def test_a_viscosity_must_be_one_and_must_be_there(simulation, tmp_path):
    text = (GOOD + ROWS).replace("uz\n", "uz eta\n", 1)
    (tmp_path / "bad.grid").write_text("".join(line + " 0\n" if k > 8 else line + "\n"
                                               for k, line in enumerate(text.splitlines())))
    assert "line 10: the viscosity 0 must be > 0" in refused(simulation, tmp_path / "bad.grid")
    (tmp_path / "bad.grid").write_text(GOOD + ROWS)
    for style, expected in ((f"visc grid fluid_velocity grid {tmp_path}/bad.grid", "bad.grid' has no viscosity"),
                            ("visc grid", "keyword visc: 'grid' requires fluid_velocity grid FILE"),
                            ("visc 1 fluid_velocity grid", "keyword fluid_velocity: value missing")):
        with pytest.raises(LammpsError) as error:
            simulation(cloud(), f"cut_off_distance inf {style}")
        assert expected in str(error.value)


@pytest.mark.parametrize("ranks", [2])
def test_every_rank_ends_with_the_error(tmp_path, ranks):
    (tmp_path / "bad.grid").write_text(GOOD)
    said = lmp(tmp_path, input_lines(cloud(), f"cut_off_distance inf visc 1 fluid_velocity grid {tmp_path}/bad.grid",
                                     tmp_path / "data"),
               ranks=ranks, succeed=False)
    assert said.code != 0 and "line 9: after it come" in " ".join(said.log.split())


# --- from VTK ---------------------------------------------------------------------------------------------------------

# VTK is half a gigabyte, which examples/openfoam_step installs for itself and the tests do not: this is a test where it
# is there.
if importlib.util.find_spec("vtk"):
    def test_a_mesh_of_vtk_becomes_a_grid(simulation, tmp_path):
        """A linear flow on tetrahedra is linear in each of them, and so it is on the grid."""
        import vtk
        from vtk.util.numpy_support import numpy_to_vtk
        grid = vtk.vtkRectilinearGrid()
        grid.SetDimensions(*(len(axis) for axis in AXES))
        for axis, put in zip(AXES, (grid.SetXCoordinates, grid.SetYCoordinates, grid.SetZCoordinates)):
            put(numpy_to_vtk(axis, deep=True))
        field = numpy_to_vtk(linear(nodes(AXES)).reshape(-1, 3), deep=True)
        field.SetName("flow")
        grid.GetPointData().AddArray(field)
        mesh = vtk.vtkDataSetTriangleFilter()
        mesh.SetInputData(grid)
        mesh.Update()
        writer = vtk.vtkXMLUnstructuredGridWriter()
        writer.SetFileName(str(tmp_path / "mesh.vtu"))
        writer.SetInputData(mesh.GetOutput())
        writer.Write()
        said = subprocess.run([sys.executable, str(EXAMPLES / "flow_grid.py"), str(tmp_path / "mesh.vtu"), "-o",
                               str(tmp_path / "mesh.grid"), "--nodes", "9", "10", "11", "--velocity", "flow",
                               "--binary", "--beyond", "x", "clamp"],
                              capture_output=True, text=True)
        assert said.returncode == 0 and "990 of 990 nodes" in said.stdout, said
        spheres = cloud()
        sim = simulation(spheres,
                         f"cut_off_distance inf visc {ETA} fluid_velocity grid {tmp_path}/mesh.grid {EXACT}").run()
        # VTK has points in single precision
        assert largest_difference(sim.drag, model.forces(spheres, ETA, linear(spheres.x))) < 1e-8
