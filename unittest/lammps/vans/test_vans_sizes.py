"""fix hydro/vans with any number of sizes: bins, their averages, sorting by height, and what bins must not change."""
import numpy as np
import pytest
from host import allowed
# close_scenes is a fixture
from vans_helper import ARRAY, VECTOR, Scene, bed_script, close_scenes, dump_rows, run_lmp, write_columns  # noqa: F401

N = 201
MESH = f"mesh {N} 0.0003 0 fluid 1000 0.001 gravity 0.4905 0 -9.797 phi_max 0.61"


def grid(s, fix, classes):
    """[slices][columns] of the array."""
    return np.array([s.column(k, N, fix) for k in range(len(ARRAY) + 5 * classes)]).T


def of_classes(s, fix, classes):
    """[classes][radius, height, transport] behind the other numbers of the vector."""
    return np.array([s.lmp.extract_fix(fix, 0, 1, len(VECTOR) + k) for k in range(3 * classes)]).reshape(classes, 3)


@pytest.fixture
def profile(tmp_path):
    return write_columns(tmp_path / "u.txt", np.concatenate([[0], 0.6 * np.arange(1, N + 1) / N]))


@pytest.mark.parametrize("radii", [1, 32, 33])
def test_more_radii_than_classes_are_sorted_into_bins(radii):
    """Up to 32 radii have a class each, in the order of the atoms; 33 have 32 bins, whose radii rise."""
    s = Scene()
    a = 0.001 * (1.0 + 0.01 * np.arange(radii)[::-1])
    s.spheres([[0.01, 0.01, 0.004 * k] for k in range(radii)], np.zeros((radii, 3)), a)
    s.do("fix h all hydro/vans 1 mesh 80 0.002 0 fluid 1000 0.001 gravity 0.5 0 -9.8 classes yes", "run 0")
    found = of_classes(s, "h", min(radii, 32))
    if radii <= 32:
        assert np.array_equal(found[:, 0], a)
    else:
        assert np.all(np.diff(found[:, 0]) > 0) and abs(found[:, 0].mean() / a.mean() - 1) < 0.01
    s.close()


def test_bins_have_the_mass_and_momentum_of_the_grains():
    """100 radii and 7 bins: phi, momentum and drag of the bins add up to those of all grains, slice by slice, 1e-13;
    the numbers of each bin are those of the grains of its sizes, as numpy has them: Sauter's mean radius, mean height,
    transport rate."""
    s = Scene()
    R = np.random.default_rng(3)
    a = 0.001 * 4 ** R.uniform(0, 1, 100)
    x, v = R.uniform([0, 0, 0.005], [0.02, 0.02, 0.05], (100, 3)), R.uniform(-0.2, 0.3, (100, 3))
    s.spheres(x, v, a)
    s.do(f"fix h all hydro/vans 1 mesh {N} 0.0003 0 area 0.01 fluid 1000 0.001 gravity 0.5 0 -9.8 classes 7", "run 0")
    table, each = grid(s, "h", 7), of_classes(s, "h", 7)
    transport = s.number("transport")
    s.close()
    phi, bins = table[:, 2], table[:, 10:].reshape(N, 7, 5)
    assert np.abs(bins[:, :, 0].sum(1) - phi).max() < 1e-13 * phi.max()
    for k in range(1, 5):
        part = bins[:, :, 0] * bins[:, :, k]
        assert np.abs(part.sum(1) - phi * table[:, 2 + k]).max() < 1e-13 * np.abs(part).sum(1).max()
    limits = a.min() * (a.max() / a.min()) ** (np.arange(8) / 7)
    which = np.clip(np.searchsorted(limits, a, side="right") - 1, 0, 6)
    for c in range(7):
        mine, V = which == c, a ** 3 * (which == c)
        assert mine.any()
        assert abs(each[c, 0] / (V.sum() / (a[mine] ** 2).sum()) - 1) < 1e-13
        # slices of 3e-4: their middles stand for what is in them
        assert abs(each[c, 1] - (V * x[:, 2]).sum() / V.sum()) < 2e-5
        assert abs(each[c, 2] / (4 / 3 * np.pi * (V * v[:, 0]).sum() / 0.01) - 1) < 1e-12
    assert abs(each[:, 2].sum() / transport - 1) < 1e-13


@pytest.mark.parametrize("keywords, spread", [("", 0.5), ("drag brown_lawler discharge 0.02 surface follow 0.045", 0.5),
                                              ("felt volume turbulence rousseau bed_mixing 0.5", 3e-15)],
                         ids=["drag of each grain", "discharge", "one law for all"])
def test_bins_change_nothing_that_one_class_has(profile, keywords, spread):
    """The drag that the water gets is that of the grains themselves: 112 radii in no class, one, six or 32 move and
    slow the water alike, 1e-12. Where b and pores come from the radii of the bins (felt volume, rousseau), that holds
    when all bins have the radius of all grains."""
    results = []
    for classes in ("no", "1", "6", "yes"):
        s = Scene.of(bed_script(f"{MESH} profile file {profile} classes {classes} {keywords}", layers=7, spread=spread))
        s.do("run 200")
        results.append([s.atoms("x"), s.atoms("v"), s.column("u", N, "vans"), s.column("stress", N, "vans")])
        s.close()
    for other in results[1:]:
        for one, single in zip(other, results[0]):
            assert np.abs(one - single).max() < 1e-12 * np.abs(single).max()


def test_bins_matter_where_the_law_is_that_of_their_radius(profile):
    """With felt volume b is the law's at the radius of each class: one class of Sauter's mean is not the mean radius of
    the grains."""
    speeds = []
    for classes in ("no", "6"):
        s = Scene.of(bed_script(f"{MESH} profile file {profile} classes {classes} felt volume", layers=7, spread=0.8))
        s.do("run 20")
        speeds.append(s.column("b", N, "vans"))
        s.close()
    assert np.abs(speeds[1] / np.maximum(speeds[0], 1e-9) - 1)[:40].max() > 0.1


LAYOUTS = allowed((1, "on"), (1, "off"), (2, "on"), (4, "off"))


@pytest.mark.ranks(max(ranks for ranks, _ in LAYOUTS))
def test_many_sizes_are_the_same_on_any_ranks_and_after_a_restart(tmp_path, profile):
    """112 radii in 6 bins, felt by volume, with the pore length of the bins: positions, velocities, forces and the
    averages of each bin; a run that goes on from a restart file on two ranks is the one that was not broken."""
    script = bed_script(f"{MESH} profile file {profile} classes 6 felt volume turbulence rousseau", layers=7,
                        spread=0.7)
    output = """
write_dump all custom dump.{0} id x y z vx vy vz f_vans[1] f_vans[2] f_vans[3] modify format float %.17g
variable z3 equal f_vans[35]
print "CLASSES $(f_vans[28]:%.17g) $(f_vans[29]:%.17g) $(f_vans[30]:%.17g) $(f_vans[43]:%.17g) &
$(f_vans[44]:%.17g) $(f_vans[30][11]:%.17g) $(f_vans[30][40]:%.17g)"
"""
    result = {}

    def take(name, text, ranks):
        done = run_lmp(tmp_path, text + output.format(name), ranks, name="in." + name)
        assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
        numbers = [line for line in done.stdout.split("\n") if line.startswith("CLASSES")][0].split()[1:]
        result[name] = dump_rows(tmp_path / f"dump.{name}"), np.array(numbers, float)

    for ranks, newton in LAYOUTS:
        take(f"{ranks}{newton}", script.replace("newton on", "newton " + newton) +
             "thermo_style custom step f_vans[28]\nrun 300\n", ranks)
    take("first", script + "run 150\nwrite_restart half\nrun 0\n", 1)
    again = script[:script.index("region box")] + "read_restart half\n" + script[script.index("pair_style"):]
    take("again", again + "run 150\n", 2)
    atoms, classes = result["1on"]
    assert np.all(classes != 0.0)
    for name, (rows, numbers) in result.items():
        if name == "first":
            continue
        assert (np.abs(rows - atoms).max(axis=0) / np.abs(atoms).max(axis=0)).max() < 1e-10, name
        assert np.abs(numbers / classes - 1).max() < 1e-9, name


def test_a_continuous_distribution_runs_and_shows_its_sorting():
    """5000 grains, each of its own radius (log-normal), larger ones higher up; the mean height of each of 10 bins
    rises, and the one number for each is what the column of its phi has. Grains that come later, larger than all,
    belong to the last bin."""
    s = Scene(box=(0, 0.05, 0, 0.05, -0.01, 0.1))
    s.do("create_atoms 1 random 5000 51 NULL", "variable d atom 0.001*exp(0.4*normal(0,1,7))",
         "set group all diameter 0.001", "set group all diameter v_d",
         "set group all density 2500", "variable z atom 0.01+20*(0.75*mass/(2500*PI))^(1/3)+0.002*random(0,1,3)",
         "set group all z v_z", f"fix h all hydro/vans 1 mesh {N} 0.0003 0 fluid 1000 0.001 gravity 0.5 0 -9.8 drag "
                                "brown_lawler classes 10 couple one", "run 10")
    each, table = of_classes(s, "h", 10), grid(s, "h", 10)
    assert np.all(np.diff(each[:, 0]) > 0) and np.all(np.diff(each[:, 1]) > 0)
    phi = table[:, 10::5]
    assert np.abs((phi * table[:, :1]).sum(0) / phi.sum(0) - each[:, 1]).max() < 1e-12
    last = each[-1]
    s.do("create_atoms 1 single 0.02 0.02 0.04", "set atom 5001 diameter 0.008 density 2500", "run 2 pre no")
    later = of_classes(s, "h", 10)
    s.close()
    assert (later[-1, 0] == last[0] and abs(later[-1, 1] - last[1]) > 1e-4 and
            np.abs(later[:-1, 1] - each[:-1, 1]).max() < 1e-5)


@pytest.mark.parametrize("classes", ["yes", "3"])
def test_classes_that_are_new_in_a_run_have_averages_at_its_start(classes):
    """A radius that comes between two runs: from step 0 of the second on all classes have the averages of their grains,
    and a solve on demand the drag of all grains; the transport of the classes adds up to that of all."""
    s = Scene()
    s.spheres([[0.01, 0.01, 0.004 * k] for k in range(1, 6)], np.full((5, 3), [0.1, 0, 0]),
              [0.001, 0.0012, 0.0012, 0.0014, 0.001])
    s.do(f"fix h all hydro/vans 10 mesh 80 0.0006 0 fluid 1000 0.001 gravity 0.5 0 -9.8 felt volume classes {classes}",
         "run 0", "create_atoms 1 single 0.015 0.005 0.03", "set atom 6 diameter 0.004 density 2500 vx 0.1", "run 0")
    count = 4 if classes == "yes" else 3
    each, transport = of_classes(s, "h", count), s.number("transport")
    s.do("fix_modify h solve 1e-4 1e-5")
    phi, b = s.column("phi", 80), s.column("b", 80)
    s.close()
    assert abs(each[:, 2].sum() / transport - 1) < 1e-12 and each[-1, 2] > 0
    assert np.all(b[:79][phi[:79] > 0.001] > 0)


@pytest.mark.parametrize("classes", ["yes", "3"])
def test_a_restart_file_with_new_classes_goes_on_with_their_averages(tmp_path, classes):
    """A radius that came after the last run: whoever reads the file averages as whoever wrote it."""
    fix = f"fix h all hydro/vans 10 mesh 80 0.0006 0 fluid 1000 0.001 gravity 0.5 0 -9.8 felt volume classes {classes}"
    s = Scene()
    s.spheres([[0.01, 0.01, 0.004 * k] for k in range(1, 6)], np.full((5, 3), [0.1, 0, 0]),
              [0.001, 0.0012, 0.0012, 0.0014, 0.001])
    s.do(fix, "run 15", "create_atoms 1 single 0.015 0.005 0.03", "set atom 6 diameter 0.004 density 2500 vx 0.1",
         f"write_restart {tmp_path}/half", "run 0")
    here, count = (s.atoms("f_h"), s.column("phi", 80)), 4 if classes == "yes" else 3
    transport = of_classes(s, "h", count)[:, 2]
    s.close()
    s = Scene.of(f"plugin load stokesdynplugin.so\nread_restart {tmp_path}/half\npair_style zero 0.01\n"
                 f"pair_coeff * *\n{fix}\nrun 0")
    there, again = (s.atoms("f_h"), s.column("phi", 80)), of_classes(s, "h", count)[:, 2]
    s.close()
    assert transport[-1] > 0 and np.abs(again / transport - 1).max() < 1e-12
    for one, other in zip(here, there):
        assert np.abs(one - other).max() < 1e-12 * np.abs(one).max()


@pytest.mark.parametrize("classes", ["yes", "3"])
def test_a_run_that_begins_without_grains_says_that_it_has_no_classes(tmp_path, classes):
    """Classes of grains that come later would need their sizes: a warning, and none once a run begins with grains."""
    text = f"""plugin load stokesdynplugin.so
units si
atom_style sphere
boundary p p f
region box block 0 0.02 0 0.02 0 0.05
create_box 1 box
pair_style zero 0.01
pair_coeff * *
comm_modify vel yes
timestep 1e-5
fix h all hydro/vans 10 mesh 80 0.0006 0 fluid 1000 0.001 gravity 0.5 0 -9.8 classes {classes}
run 0
print "FILLED"
create_atoms 1 single 0.01 0.01 0.02
set group all diameter 0.002
run 0
"""
    done = run_lmp(tmp_path, text)
    assert done.returncode == 0, done.stdout[-2000:]
    before, after = done.stdout.split("FILLED", 1)
    assert "keyword classes: the run begins without grains to average" in before
    assert "without grains to average" not in after and ("3 bins" in after) == (classes == "3")


def test_classes_stay_in_their_columns_when_grains_go():
    """The lowest ID of a size, then all of that size; a run that begins has the classes of the last one."""
    s = Scene()
    s.spheres([[0.004 * k + 0.002, 0.01, 0.01] for k in range(4)], np.zeros((4, 3)), [0.001, 0.0008, 0.001, 0.0008])
    s.do("fix h all hydro/vans 1 mesh 41 0.001 0 fluid 1000 0.001 gravity 0.5 0 -9.8 couple one classes yes")
    for gone in ("", "1", "3"):
        s.do(*[f"group gone id {gone}", "delete_atoms group gone compress no"] * bool(gone), "run 1")
        radii = [s.lmp.extract_fix("h", 0, 1, 27 + 3 * c) for c in range(2)]
        assert radii == [0.001, 0.0008]
    s.close()
