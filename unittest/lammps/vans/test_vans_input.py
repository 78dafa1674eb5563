"""fix hydro/vans: bad input, each with its own message."""
import numpy as np
import pytest
# close_scenes is a fixture
from vans_helper import Scene, bed_script, close_scenes, run_lmp, write_columns  # noqa: F401

GOOD = {"mesh": "20 0.001 0", "fluid": "1000 0.001", "gravity": "0.5 0 -9.8"}


def line(every="1", **changes):
    keywords = {**GOOD, **changes}
    return f"fix h all hydro/vans {every} " + " ".join(f"{key} {value}" for key, value in keywords.items()
                                                       if value is not None)


BAD = [
    (dict(every="0"), "keyword N: '0' must be >= 1"),
    (dict(every="2.5"), "keyword N: '2.5' is not an integer"),
    (dict(every="1e3"), "keyword N: '1e3' is not an integer"),
    (dict(every="0x10"), "keyword N: '0x10' is not an integer"),
    (dict(mesh="20 0.001 0 mesh 30 0.001 0"), "keyword mesh: given twice"),
    (dict(mesh=None), "keyword mesh .* is required"),
    (dict(fluid=None), "keyword fluid .* is required"),
    (dict(gravity=None), "keyword gravity .* is required; its x component is the slope"),
    (dict(gravity="0 0 -9.8"), "nothing drives the stream"),
    (dict(mesh="20 0 0"), "keyword mesh: '0' must be > 0"),
    (dict(mesh="20 -0.001 0"), "keyword mesh: '-0.001' must be > 0"),
    (dict(mesh="1 0.001 0"), "keyword mesh: '1' must be >= 2"),
    (dict(mesh="20 0.001"), "keyword mesh: 'fluid' is not a number"),
    (dict(mesh="20 nan 0"), "keyword mesh: 'nan' is not a finite number"),
    (dict(fluid="0 0.001"), "keyword fluid: '0' must be > 0"),
    (dict(fluid="1000 -1"), "keyword fluid: '-1' must be > 0"),
    (dict(area="0"), "keyword area: '0' must be > 0"),
    (dict(couple="both"), "keyword couple: 'both' is none of: none, one, two, fluid"),
    (dict(turbulence="k-eps"), "keyword turbulence: 'k-eps' is none of"),
    (dict(viscosity="krieger"), "keyword viscosity: 'krieger' is none of"),
    (dict(phi_max="1.2"), "keyword phi_max: '1.2' is a volume fraction"),
    (dict(solve="1e-3 1e-2"), "keyword solve: the step 0.01 is longer than the period 0.001"),
    (dict(solve="0 1e-2"), "keyword solve: '0' must be > 0"),
    (dict(solve="1e7 1e-9"), "keyword solve: the step 1e-09 is too short for the period 1e\\+07"),
    (dict(solve="1e7 1e-9", rules="yade"), "keyword solve: the step 1e-09 is too short"),
    (dict(solve="1e300 1e-300"), "keyword solve: the step 1e-300 is too short"),
    (dict(solve="1 1e-9"), "keyword solve: the step 1e-09 is too short for the period 1: 1e\\+09 steps of"),
    (dict(class_radii="2 0.001 0.001"), "keyword class_radii: '0.001' is given twice"),
    (dict(classes="0"), "keyword classes: '0' must be >= 1"),
    (dict(classes="1001"), "keyword classes: '1001' must be <= 1000"),
    (dict(classes="2.5"), "keyword classes: '2.5' is not an integer"),
    (dict(classes="5", class_radii="1 0.001"),
     "keyword classes: with a number of classes they are bins of equal ratio"),
    (dict(felt="surface"), "keyword felt: 'surface' is none of: centre, volume"),
    (dict(felt="volume", rules="yade"), "keyword felt is not available with rules yade"),
    (dict(felt="volume", grains="point"), "keyword felt has no effect with grains point"),
    (dict(renewal="0.1"), "keyword renewal requires fluctuations"),
    (dict(fluctuation="depth 5 0", renewal="0.1"), "keyword renewal has no effect with fluctuation depth"),
    (dict(couple="fluid", fluctuation="correlated 5 0"), "keyword fluctuation: with couple fluid there are no grains"),
    (dict(sidewall="0 1"), "keyword sidewall: '0' must be > 0"),
    (dict(radius="-1"), "keyword radius: '-1' must be > 0"),
    (dict(fluctuation="correlated 0 0.1"), "keyword fluctuation: '0' must be >= 1"),
    (dict(fluctuation="depth 99999999999999999999 0"),
     "keyword fluctuation: '99999999999999999999' must be <= 9223372036854775807"),
    (dict(fluctuation="depth -99999999999999999999 0"), "keyword fluctuation: '-99999999999999999999' must be >= 1"),
    (dict(fluctuation="correlated 5"), "keyword fluctuation: value missing: bed"),
    (dict(profile="file nowhere"), "keyword profile: cannot read file 'nowhere'"),
    (dict(region="nowhere"), "keyword region: region 'nowhere' does not exist"),
    (dict(average="nobody"), "keyword average: group 'nobody' does not exist"),
    (dict(pressure_gradient="v_none"), "keyword pressure_gradient: variable 'none' does not exist"),
    (dict(overlap="once"), "keyword overlap: molecule IDs are needed"),
    (dict(hindrance="-1"), "keyword hindrance: '-1' must be >= 0"),
    (dict(drag="stokes"), "keyword drag: 'stokes' is none of"),
    (dict(drag="brown_lawler", rules="yade"),
     "keyword drag: with rules yade only drag yade and hindrance n are available"),
    (dict(hindrance="di_felice", rules="yade"),
     "keyword drag: with rules yade only drag yade and hindrance n are available"),
    (dict(drag="beetstra", rules="yade"), "keyword drag: with rules yade only drag yade and hindrance n are available"),
    (dict(drag="gidaspow", hindrance="3.1"), "keyword hindrance: ergun, gidaspow, beetstra and koch_hill have"),
    (dict(added_mass="0.5", rules="yade"), "keyword added_mass is not available with rules yade"),
    (dict(added_mass="-0.5"), "keyword added_mass: '-0.5' must be >= 0"),
    (dict(upflow="0", couple="none"), "keyword upflow: it needs couple one or two"),
    (dict(wall_roughness="0.001"), "keyword wall_roughness requires sidewall"),
    (dict(wall_mixing="yes"), "keyword wall_mixing requires sidewall"),
    (dict(wall_mixing="yes", sidewall="0.1 1", rules="yade"), "wall_mixing are not available with rules yade"),
    (dict(discharge="0.1", couple="one"), "keyword discharge: it needs couple two or fluid"),
    (dict(discharge="0.1", surface="speed 1"), "keyword discharge: with surface speed the stream is driven already"),
    (dict(discharge="0.1", pressure_gradient="1"), "keyword discharge: the pressure gradient follows from it"),
    (dict(discharge="v_none"), "keyword discharge: variable 'none' does not exist"),
    (dict(adjust="width"), "keyword adjust: 'width' is none of: slope, depth"),
    (dict(adjust="depth 0", discharge="0.1", surface="follow 0.01"), "keyword adjust: '0' must be > 0"),
    (dict(adjust="depth 1", discharge="0.1"), "keyword adjust: depth needs discharge and surface follow"),
    (dict(adjust="depth 1", surface="follow 0.01"), "keyword adjust: depth needs discharge and surface follow"),
    (dict(adjust="depth 1", surface="follow 0.01", discharge="0.1", gravity="0 0 -9.8"), "nothing drives the stream"),
    (dict(fluctuation="langevin 5 0", rules="yade"), "keyword fluctuation: langevin is not available with rules yade"),
    (dict(fluctuation="correlated 5 0", schmidt="0.7"), "keyword schmidt requires fluctuation langevin"),
    (dict(fluctuation="langevin 5 0", schmidt="0"), "keyword schmidt: '0' must be > 0"),
    (dict(fall_diameter="0"), "keyword fall_diameter: '0' must be > 0"),
    (dict(fall_diameter="0.7", rules="yade"), "keyword fall_diameter is not available with rules yade"),
    (dict(surface="follow 0.01", couple="fluid"), "keyword surface: follow needs couple two"),
    (dict(surface="follow 0.019"), "keyword surface: the surface at 0.019 has no room to rise: the mesh holds"),
    (dict(surface="follow 0"), "keyword surface: '0' must be > 0"),
    (dict(gravity="v_none 0 -9.8"), "keyword gravity: variable 'none' does not exist"),
    (dict(hindrance="inf"), "keyword hindrance: 'inf' is not a finite number"),
    (dict(bed_mixing="-0.5"), "keyword bed_mixing: '-0.5' must be >= 0"),
    (dict(bed_mixing="much"), "keyword bed_mixing: 'much' is not a number"),
    (dict(bed_mixing="0.5", rules="yade"), "keyword bed_mixing is not available with rules yade"),
    (dict(bed_mixing="0.5", turbulence="none"), "keyword bed_mixing has no effect with turbulence none"),
    (dict(mesh='file ""'), "Fix hydro/vans: keyword mesh: '' is empty"),
    (dict(profile='file ""'), "Fix hydro/vans: keyword profile: '' is empty"),
    (dict(given='file ""'), "Fix hydro/vans: keyword given: '' is empty"),
    (dict(convective='file ""'), "Fix hydro/vans: keyword convective: '' is empty"),
    (dict(fluctuation="correlated 5 0", intensity='file ""'), "Fix hydro/vans: keyword intensity: '' is empty"),
    (dict(region='""'), "Fix hydro/vans: keyword region: '' is empty"),
    (dict(average='""'), "Fix hydro/vans: keyword average: '' is empty"),
    (dict(drag='""'), "Fix hydro/vans: keyword drag: '' is empty"),
    (dict(kappa='""'), "Fix hydro/vans: keyword kappa: '' is empty"),
    (dict(slope="0.1"), "unknown keyword 'slope'"),
]


@pytest.mark.parametrize("changes, message", BAD)
def test_bad_keyword(changes, message):
    s = Scene()
    s.spheres([[0.01, 0.01, 0.0055]], [[0, 0, 0]], 0.001)
    with pytest.raises(Exception, match=message):
        s.do(line(**changes), "run 0")


PROFILE, GIVEN = dict(profile="file rows"), dict(couple="fluid", given="file rows")


@pytest.mark.parametrize("keywords, rows, message", [
    (PROFILE, ["1"] * 20, "has 20 values, ncell \\+ 1 = 21 are needed"),
    (PROFILE, ["1"] * 22, "has 22 values, ncell \\+ 1 = 21 are needed"),
    (PROFILE, ["0 1"] * 10 + ["1"], "row 1 has 2 values, one per row is needed"),
    (PROFILE, ["1"] * 20 + ["nan"], "line 21: 'nan' is not a finite number"),
    (PROFILE, ["1"] * 20 + ["fast"], "line 21: 'fast' is not a finite number"),
    (GIVEN, ["0.1 0 0"] * 19, "has 19 rows, ncell = 20 are needed"),
    (GIVEN, ["0.1 0 0"] * 19 + ["0.1 0"], "row 20 has 2 values"),
    (GIVEN, ["0.1 0 0"] * 19 + ["1.1 0 0"], "phi = 1.1 in slice 20"),
    (GIVEN, ["0.1 0 0"] * 19 + ["0.1 0 inf"], "line 20: 'inf' is not a finite number"),
])
def test_bad_file(tmp_path, monkeypatch, keywords, rows, message):
    monkeypatch.chdir(tmp_path)    # short names: the python module cuts messages off
    (tmp_path / "rows").write_text("\n".join(rows))
    with pytest.raises(Exception, match=message):
        Scene().do(line(**keywords))


@pytest.mark.parametrize("edges, message", [("0 0.1", "has 2 edges, at least 3 are needed"),
                                            ("0 0.1 0.1 0.2", "edge 3 \\(0.1\\) is not above the one before")])
def test_bad_mesh_file(tmp_path, monkeypatch, edges, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "edges").write_text(edges)
    with pytest.raises(Exception, match=message):
        Scene().do(line(mesh="file edges"))


def test_rules_yade_has_equal_slices(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "edges").write_text("0 0.1 0.3 0.4")
    with pytest.raises(Exception, match="rules yade needs slices of equal height"):
        Scene().do(line(mesh="file edges", rules="yade"))


def test_phi_above_one():
    s = Scene()
    s.spheres([[0.01, 0.01, 0.0055]], [[0, 0, 0]], 0.003)
    with pytest.raises(Exception, match=r"phi = [0-9.]+ in slice \d+ \(z = .* more grains than fit"):
        s.do(line(area="1e-5"), "run 0")


def test_bed_up_to_the_surface():
    s = Scene(box=(0, 0.0062, 0, 0.0062, -0.02, 0.15))
    s.spheres([[0.003, 0.003, 0.0065 + 0.006 * k] for k in range(3)], np.zeros((3, 3)), 0.003)
    with pytest.raises(Exception, match="keyword mesh: the bed reaches the surface of the water: phi = "):
        s.do(line(), "run 0")


@pytest.mark.parametrize("z, boundary, full, periodic", [("0.009", "p p f", 1, 0), ("0.004", "p p p", 0, 1)])
def test_a_bed_that_rises_to_the_surface_and_a_box_without_ends_are_told(tmp_path, z, boundary, full, periodic):
    """Once each; a bed that is there when a run begins is an error."""
    text = run_lmp(tmp_path, f"""plugin load stokesdynplugin.so
units si
atom_style sphere
boundary {boundary}
region box block 0 0.0062 0 0.0062 -0.02 0.15 units box
create_box 1 box
create_atoms 1 single 0.003 0.003 0.0035 units box
create_atoms 1 single 0.003 0.003 0.0095 units box
set group all diameter 0.006 density 2500
pair_style zero 0.01
pair_coeff * *
{line()}
timestep 1e-5
run 1
displace_atoms all move 0 0 {z} units box
run 2
run 2
""").stdout
    text = " ".join(text.split())
    assert text.count("since step 2 the bed reaches the surface of the water at z = 0.019") == full, text
    assert text.count("boundary is periodic along z: a grain that leaves") == periodic, text


def test_mesh_that_misses_the_grains():
    s = Scene()
    s.spheres([[0.01, 0.01, 0.0055], [0.01, 0.01, 0.0855], [0.01, 0.01, 0.0955]], np.zeros((3, 3)), 0.001)
    with pytest.raises(Exception, match="it misses 66.6667 % of the grains"):
        s.do(line(), "run 0")


def test_atom_style_without_radius():
    with pytest.raises(Exception, match="an atom style with radius is needed"):
        Scene(style="atomic").do(line())


def test_minimisation_and_respa_are_refused():
    s = Scene()
    s.spheres([[0.01, 0.01, 0.0055]], [[0, 0, 0]], 0.001)
    s.do(line())
    with pytest.raises(Exception, match="minimize cannot be used with it"):
        s.do("minimize 0 0 1 1")
    s.close()
    s = Scene()
    s.spheres([[0.01, 0.01, 0.0055]], [[0, 0, 0]], 0.001)
    s.do(line(), "run_style respa 2 2 pair 1")
    with pytest.raises(Exception, match="run_style respa is not supported"):
        s.do("run 0")


def test_nan_in_a_run():
    s = Scene()
    s.spheres([[0.01, 0.01, 0.0055], [0.005, 0.01, 0.0055]], np.zeros((2, 3)), 0.001)
    s.do(line(couple="none"), "set atom 2 vx 1e200")
    with pytest.raises(Exception, match="the force on atom 2 is not finite"):
        s.do("run 0")


@pytest.mark.parametrize("radius", [np.nan, np.inf, -np.inf, -0.001])
def test_a_radius_that_is_none(radius):
    """0 is that of an atom that is no grain; LAMMPS's commands make no other, programs may."""
    s = Scene()
    s.spheres([[0.01, 0.01, 0.0055], [0.005, 0.01, 0.0055]], np.zeros((2, 3)), 0.001)
    s.do(line(couple="none"), "run 0")
    s.lmp.numpy.extract_atom("radius")[1] = radius
    with pytest.raises(Exception, match="atom [12] has the radius .*; it must be a number > 0"):
        s.do("run 0")


@pytest.mark.parametrize("keyword, message", [
    ("pressure_gradient v_p", "step 1: keyword pressure_gradient: -?nan is not a finite number"),
    ("surface speed v_p", "step 1: keyword surface: speed -?nan is not a finite number"),
])
def test_variable_that_is_no_number(keyword, message):
    s = Scene()
    key, value = keyword.split(" ", 1)
    s.do("variable p equal 0*exp(999)", line(couple="fluid", **{key: value}))
    with pytest.raises(Exception, match=message):
        s.do("run 1")


def test_step_that_is_no_fraction_is_told(tmp_path):
    vans = "mesh 200 0.0003 0 fluid 1000 0.001 gravity 0.4905 0 -9.797 phi_max 0.61 solve 2e-4 3e-5"
    done = run_lmp(tmp_path, bed_script(vans) + "run 20\n")
    assert done.returncode == 0
    assert "the step 3e-05 of keyword solve is no fraction of 0.0002: 7 steps of 2.85714e-05 are used" in done.stdout
    done = run_lmp(tmp_path, bed_script(vans.replace("3e-5", "2e-5") + " rules yade") + "run 20\n")
    assert "rules yade: " in done.stdout or done.returncode == 0


def test_grains_outside_are_counted_and_told(tmp_path):
    vans = "mesh 60 0.0003 0 fluid 1000 0.001 gravity 0.4905 0 -9.797 phi_max 0.61 couple one"
    done = run_lmp(tmp_path, bed_script(vans) + "thermo_style custom step f_vans[7]\nrun 20\n")
    assert done.returncode == 0
    assert "grains are outside the mesh: those above it feel the velocity of the surface" in done.stdout + done.stderr


def test_new_radius_that_is_no_class():
    s = Scene()
    s.spheres([[0.01, 0.01, 0.0055], [0.005, 0.01, 0.0055]], np.zeros((2, 3)), [0.001, 0.0012])
    s.do(line(couple="one", classes="yes", class_radii="1 0.001"))
    with pytest.raises(Exception, match="atom 2 has radius 0.0012, which is no size class"):
        s.do("run 0")


def test_restart_with_another_mesh(tmp_path):
    vans = "mesh {} 0.0003 0 fluid 1000 0.001 gravity 0.4905 0 -9.797 phi_max 0.61"
    done = run_lmp(tmp_path, bed_script(vans.format(200)) + "run 20\nwrite_restart half\n")
    assert done.returncode == 0
    script = bed_script(vans.format(210))
    again = script[:script.index("region box")] + "read_restart half\n" + script[script.index("pair_style"):]
    done = run_lmp(tmp_path, again)
    assert done.returncode != 0 and "the restart file has 200 slices, this fix has 210" in done.stdout


WORKING = ["lj", "si", "cgs", "micro", "nano"]


@pytest.mark.parametrize("units", WORKING + ["real", "metal", "electron"])
def test_unit_systems(units):
    """Where force is mass times acceleration the numbers are the same in all systems; elsewhere the fix says where it
    works."""
    s = Scene(units=units, extra=["atom_modify sort 0 0"])
    s.spheres([[0.01, 0.01, 0.0055]], [[0, 0, 0]], 0.001)
    command = line(couple="none", stream="rest", gravity="0 0 -9.8")
    if units not in WORKING:
        with pytest.raises(Exception, match=f"units {units}: use lj, si, cgs, micro or nano"):
            s.do(command, "run 0")
        return
    s.do(command, "fix_modify h profile values " + " ".join("0.3" for _ in range(21)), "run 0")
    drag = 0.5 * 1000 * np.pi * 1e-6 * (0.44 * 0.3 + 24.4 * 0.001 / 1000 / 0.002) * 0.3
    assert np.allclose(s.atoms("f")[0], [drag, 0, 9.8 * 1000 * 4 / 3 * np.pi * 1e-9], rtol=1e-12)


def test_two_dimensions_are_refused():
    s = Scene.of("plugin load stokesdynplugin.so\nunits si\natom_style sphere\ndimension 2\n"
                 "region b block 0 1 0 1 -0.1 0.1\ncreate_box 1 b")
    with pytest.raises(Exception, match="dimension 2: the stream needs three dimensions"):
        s.do(line(couple="none"))


@pytest.mark.parametrize("boundary", ["s p f", "p m f"])
def test_shrink_wrapped_box_needs_an_area(boundary):
    s = Scene(boundary=boundary)
    with pytest.raises(Exception,
                       match=f"keyword area: the box is shrink-wrapped along {'x' if boundary[0] == 's' else 'y'}"):
        s.do(line())
    s.do(line(area="4e-4"))


def restarted(script):
    return script[:script.index("region box")] + "read_restart half\n" + script[script.index("pair_style"):]


@pytest.mark.parametrize("other", ["200 0.00031 0", "200 0.0003 0.0001", "file edges"])
def test_restart_with_another_mesh_of_the_same_number(tmp_path, other):
    vans = "mesh {} fluid 1000 0.001 gravity 0.4905 0 -9.797 phi_max 0.61"
    write_columns(tmp_path / "edges", 0.06 * np.linspace(0, 1, 201) ** 1.1)
    done = run_lmp(tmp_path, bed_script(vans.format("200 0.0003 0")) + "run 20\nwrite_restart half\n")
    assert done.returncode == 0
    done = run_lmp(tmp_path, restarted(bed_script(vans.format(other))))
    assert done.returncode != 0 and "the restart file has another mesh" in done.stdout + done.stderr


@pytest.mark.parametrize("before, after", [("fluctuation correlated 7 0.01", ""), ("", "fluctuation correlated 7 0.01"),
                                           ("conserve no", ""), ("", "added_mass 0.5")])
def test_restart_with_other_keywords_says_what_the_grains_lose(tmp_path, before, after):
    vans = "mesh 200 0.0003 0 fluid 1000 0.001 gravity 0.4905 0 -9.797 phi_max 0.61 "
    done = run_lmp(tmp_path, bed_script(vans + before) + "run 20\nwrite_restart half\n")
    assert done.returncode == 0
    done = run_lmp(tmp_path, restarted(bed_script(vans + after)) + "run 20\n")
    assert done.returncode == 0, done.stdout[-1000:]
    assert ("the restart file was written with other keywords "
            "(conserve, overlap, fluctuation or added_mass)" in done.stdout)


def test_two_fixes_on_one_group_are_told(tmp_path):
    vans = "mesh 200 0.0003 0 fluid 1000 0.001 gravity 0.4905 0 -9.797 phi_max 0.61"
    second = f"fix other all hydro/vans 20 {vans} couple none\n"
    done = run_lmp(tmp_path, bed_script(vans) + second + "run 1\n")
    assert done.returncode == 0, done.stdout[-1000:]
    assert "64 atoms are in the groups of fix vans and of fix other" in done.stdout
    apart = f"fix other bed hydro/vans 20 {vans} couple none\n"
    assert "are in the groups" not in run_lmp(tmp_path, bed_script(vans) + apart + "run 1\n").stdout


def test_a_solve_of_many_seconds_is_told(tmp_path):
    script = "units si\nplugin load stokesdynplugin.so\nregion b block 0 1 0 1 0 1\ncreate_box 1 b\nmass 1 1\n"
    done = run_lmp(tmp_path, script + line(couple="fluid", solve="1 1e-7") + "\nrun 0\n")
    assert "10000000 steps of 20 slices in every coupling" not in done.stdout
    done = run_lmp(tmp_path, script + line(couple="fluid", solve="1 1e-8") + "\nrun 0\n")
    assert "1e+08 steps of 20 slices in every coupling" in done.stdout and done.returncode == 0


# radius, density, fluid, words; is it said, and the Reynolds number of the fall. The first four are ten Cate's spheres
# in oil.
FALLS = [(0.0075, 1120, "970 0.373", "", "1.5"), (0.0075, 1120, "965 0.212", "", "4.3"),
         (0.0075, 1120, "962 0.113", "", "12"), (0.0075, 1120, "960 0.058", "", "32"),
         (0.0075, 1120, "960 0.058", "drag yade", None), (0.0075, 1120, "960 0.058", "drag brown_lawler", None),
         (0.0075, 1120, "960 0.058", "rules yade", None), (0.003, 2500, "1000 0.001", "", None),
         (0.00025, 2650, "1000 0.001", "", "3"), (0.000002, 2650, "1000 0.001", "", None),
         (0.0075, 960, "960 0.058", "", None)]


@pytest.mark.parametrize("radius, density, fluid, words, Re", FALLS)
def test_the_default_drag_is_warned_of_by_the_reynolds_number_of_the_fall(tmp_path, radius, density, fluid, words, Re):
    script = f"""plugin load stokesdynplugin.so
units si
atom_style sphere
boundary p p f
region box block 0 0.1 0 0.1 -1 1 units box
create_box 1 box
create_atoms 1 single 0.05 0.05 0.9
create_atoms 1 single 0.05 0.05 0.5
set group all diameter {2 * radius!r} density {density}
set atom 2 density {fluid.split()[0]}
pair_style zero 0.01
pair_coeff * *
fix s all hydro/vans 1 mesh 100 0.02 -1 fluid {fluid} gravity 0 0 -9.81 couple none stream rest {words}
timestep 1e-9
run 0
run 0
"""
    text = run_lmp(tmp_path, script).stdout
    assert text.count("keyword drag: by its default, yade, a lone grain of radius") == (Re is not None), text
    assert Re is None or f"(Re = {Re}" in text, text


def test_the_default_drag_is_warned_of_by_the_worst_of_thousands_of_sizes(tmp_path):
    """Two thousand specks of as many sizes, for which the default is right, stand before the one sphere for which it is
    not."""
    script = """plugin load stokesdynplugin.so
units si
atom_style sphere
atom_modify sort 0 0
boundary p p f
region box block 0 0.1 0 0.1 -1 1 units box
create_box 2 box
create_atoms 1 random 2000 4711 box
create_atoms 2 single 0.05 0.05 0.9
variable size atom 4e-6*(1+id/10000)
set type 1 diameter v_size
set type 1 density 2650
set type 2 diameter 0.015 density 1120
pair_style zero 0.01
pair_coeff * *
fix s all hydro/vans 1 mesh 100 0.02 -1 fluid 962 0.113 gravity 0 0 -9.81 couple none stream rest
timestep 1e-9
run 0
"""
    text = run_lmp(tmp_path, script).stdout
    assert "a lone grain of radius 0.0075 falls" in text and "(Re = 12" in text, text
