"""fix hydro/vans between runs: fix_modify average, solve, given; and fluctuations of a given intensity."""
import numpy as np
import pytest
# close_scenes is a fixture
from vans_helper import Scene, bed_script, close_scenes, dump_rows, run_lmp, write_columns  # noqa: F401

N, WATER = 201, "fluid 1000 0.001 gravity 0.4905 0 -9.797 phi_max 0.61"


@pytest.fixture
def mesh(tmp_path):
    u = write_columns(tmp_path / "u.txt", np.concatenate([[0], 0.6 * np.arange(1, N + 1) / N]))
    return f"mesh {N} 0.0003 0 {WATER} profile file {u}"


def state(s):
    profiles = [s.column(name, N, "vans") for name in ("u", "phi", "vx", "drag", "b", "nut", "stress")]
    return profiles + [s.atoms("x"), s.atoms("v"), s.atoms("f_vans")]


@pytest.mark.parametrize("keywords", ["", "conserve no", "felt volume", "classes yes sidewall 0.03 1",
                                      "fluctuation correlated 5 0.01 renewal 5e-4", "fluctuation depth 5 0.01"])
def test_average_and_solve_on_demand_are_those_of_a_run(mesh, keywords):
    """Three intervals of 20 steps with a coupling at the end of each, by itself or by fix_modify."""
    seen = []
    for every, asked in ((20, []), (1000, ["fix_modify vans average", "fix_modify vans solve 2e-4 2e-5"])):
        s = Scene.of(bed_script(f"{mesh} {keywords}", every=every))
        for _ in range(3):
            s.do("run 20", *asked)
        s.do("run 7")
        seen.append(state(s))
        s.close()
    for a, b in zip(*seen):
        assert np.abs(a - b).max() <= 1e-12 * np.abs(a).max()


def test_solves_on_demand_keep_the_momentum(mesh):
    """Couplings when the user says, at uneven times; in between the water moves on alone past grains that are held,
    which counts as given to others."""
    s = Scene.of(bed_script(mesh, every=100000))
    s.do("unfix gravity", "pair_style zero 0.006", "pair_coeff * *", "run 0")

    def account():
        grains = (s.atoms("rmass") * s.atoms("v")[:, 0])[s.atoms("type") == 2].sum()
        outside = [s.number(k, "vans") for k in ("driving", "bottom", "walls", "surface")]
        return grains + s.number("momentum", "vans") + s.number("transit", "vans") + s.number("others", "vans") - sum(
            outside), np.abs(outside).sum()

    start, _ = account()
    for k, steps in enumerate((50, 33, 40, 100)):
        s.do(f"run {steps}", "fix_modify vans solve 1e-3 2e-5", f"fix_modify vans solve {steps * 1e-5} 1e-5",
             "fix_modify vans solve 3e-4 1e-5")
        end, moved = account()
        assert abs(end - start) < 1e-11 * moved
    assert moved > 1e-4
    s.close()


def test_given_between_runs_is_given_at_the_start(tmp_path, mesh):
    """Forces with couple none; the stream with couple fluid."""
    z = (np.arange(N) + 0.5) / N
    first, second = (write_columns(tmp_path / name, phi, 0.1 * z, 2e-6 * (1 - z))
                     for name, phi in (("a", 0.3 * (1 - z)), ("b", 0.5 * (1 - z) ** 2)))
    for couple in ("none", "fluid radius 0.003 solve 0.01 1e-4"):
        seen = []
        for given, asked in ((first, [f"fix_modify vans given {second}"]), (second, [])):
            s = Scene.of(bed_script(f"{mesh} couple {couple} given file {given}", every=1))
            s.do(*asked, "run 0", "run 3")
            seen.append(state(s))
            s.close()
        for a, b in zip(*seen):
            assert np.abs(a - b).max() <= 1e-13 * np.abs(a).max()


def test_an_average_sees_grains_that_came_between_runs():
    s = Scene()
    s.spheres([[0.01, 0.01, 0.0055]], np.zeros((1, 3)), 0.002)
    s.do("fix h all hydro/vans 1000 mesh 20 0.001 0 fluid 1000 0.001 gravity 0.5 0 -9.8 couple one", "run 0")
    one = (s.column("phi", 20) * 0.001 * 4e-4).sum()
    s.do("create_atoms 1 single 0.004 0.004 0.0105", "set atom 2 diameter 0.002 density 2500", "fix_modify h average")
    assert abs((s.column("phi", 20) * 0.001 * 4e-4).sum() / one - (1 + 0.5 ** 3)) < 1e-12
    s.close()


@pytest.mark.parametrize("ranks", [2, 4])
def test_ranks_agree(tmp_path, mesh, ranks):
    rows = {}
    for n, grid in ((1, "1 1 1"), (ranks, f"2 1 {ranks // 2}")):
        script = bed_script(mesh, processors="processors " + grid, every=1000) + f"""
run 50
fix_modify vans average
fix_modify vans solve 5e-4 1e-5
run 50
write_dump all custom dump.{n} id x y z vx vy vz f_vans[1] f_vans[2] f_vans[3] modify format float %.17g
"""
        done = run_lmp(tmp_path, script, n, name=f"in.{n}")
        assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
        rows[n] = dump_rows(tmp_path / f"dump.{n}")
    assert (np.abs(rows[ranks] - rows[1]).max(axis=0) <= 1e-12 * np.abs(rows[1]).max(axis=0)).all()


BAD = [
    ("average", "none", "keyword average: couple none and fluid have no averages"),
    ("solve 1e-3", "two", "keyword solve: value missing: dt"),
    ("solve 0 1e-3", "two", "keyword solve: '0' must be > 0"),
    ("solve 1e-3 1e-2", "two", "keyword solve: the step 0.01 is longer than the period 0.001"),
    ("solve 1 1e-12", "two", "keyword solve: the step 1e-12 is too short"),
    ("given", "two", "keyword given: value missing"),
    ("given nowhere", "two", "keyword given: cannot read file 'nowhere'"),
    ("given short", "two", "keyword given: file 'short' has 2 rows, ncell = 20 are needed"),
    ("given full", "two", "keyword given: file 'full': phi = 1.2 in slice 4"),
    ("profile", "two", "keyword profile: value missing"),
    ("profile values 1 2", "two", "keyword profile: 2 values, ncell \\+ 1 = 21 are needed"),
    ("gravity v_atoms 0 -9.8", "two", "keyword gravity: the variable must be of equal style: one value for all"),
    ("profile upward 1", "two", "keyword profile: 'upward' is none of: file, values"),
]


@pytest.mark.parametrize("words, couple, message", BAD)
def test_bad_input(tmp_path, monkeypatch, words, couple, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "short").write_text("0.1 0 0\n" * 2)
    (tmp_path / "full").write_text("0.1 0 0\n" * 3 + "1.2 0 0\n" + "0.1 0 0\n" * 16)
    s = Scene()
    s.spheres([[0.01, 0.01, 0.0055]], np.zeros((1, 3)), 0.001)
    s.do("variable atoms atom x",
         f"fix h all hydro/vans 1 mesh 20 0.001 0 fluid 1000 0.001 gravity 0.5 0 -9.8 couple {couple}", "run 0")
    with pytest.raises(Exception, match="fix_modify h: " + message):
        s.do("fix_modify h " + words)


# --- intensity --------------------------------------------------------------------------------------------------------

@pytest.mark.parametrize("kind", ["number", "variable", "file"])
def test_the_intensity_given_is_that_of_the_fluctuations(tmp_path, kind):
    """Each component of u' that 40 000 grains see has the rms that the user gives, per slice where a file gives it;
    water at rest, no stress. The sampling error of a variance is sqrt(2/n): five of them."""
    n, cells = 40000, 20
    u_star = 0.01 * (1 + np.arange(cells)) if kind == "file" else np.full(cells, 0.07)
    words = {"number": "0.07", "variable": "v_i", "file": "file " + write_columns(tmp_path / "i", u_star)}[kind]
    s = Scene(extra=["neigh_modify one 10000 page 100000", "comm_modify cutoff 0.0001", "pair_style none"])
    s.do("variable i equal 0.01*7", f"region r block 0 0.02 0 0.02 0.0001 {0.001 * cells - 0.0001} units box",
         f"create_atoms 1 random {n} 7 r", "set group all diameter 1e-5 density 2500",
         f"fix h all hydro/vans 1 mesh {cells} 0.001 0 fluid 1000 0.001 gravity 0 0 -9.8 couple none stream rest "
         f"fluctuation uncorrelated 11 0 intensity {words}", "run 0")
    slices = (s.atoms("x")[:, 2] / 0.001).astype(int)
    seen = s.atoms("f_h")[:, 3:] / u_star[slices][:, None]
    for d in range(3):
        assert abs((seen[:, d] ** 2).mean() - 1) < 5 * np.sqrt(2 / n)
        assert abs(seen[:, d].mean()) < 5 / np.sqrt(n)
        assert max(abs((seen[slices == k, d] ** 2).mean() - 1) / np.sqrt(2 / (slices == k).sum())
                   for k in range(cells)) < 5
    s.close()


@pytest.mark.parametrize("words, message", [
    ("-1", "keyword intensity: '-1' must be >= 0"),
    ("v_none", "keyword intensity: variable 'none' does not exist"),
    ("v_minus", "keyword intensity: -2 must be >= 0"),
    ("v_nan", "keyword intensity: -?nan is not a finite number"),
    ("file bad", "keyword intensity: file 'bad': '-3' in row 2 must be >= 0"),
    ("file short", "keyword intensity: file 'short' has 1 values, ncell = 20 are needed"),
])
def test_bad_intensity(tmp_path, monkeypatch, words, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "bad").write_text("1\n-3\n" + "1\n" * 18)
    (tmp_path / "short").write_text("1\n")
    s = Scene()
    s.spheres([[0.01, 0.01, 0.0055]], np.zeros((1, 3)), 0.001)
    with pytest.raises(Exception, match=message):
        s.do("variable minus equal -2", "variable nan equal 0*exp(999)",
             "fix h all hydro/vans 1 mesh 20 0.001 0 fluid 1000 0.001 gravity 0.5 0 -9.8 fluctuation correlated 3 0 "
             f"intensity {words}", "run 0")


def test_intensity_without_fluctuations():
    with pytest.raises(Exception, match="keyword intensity requires fluctuations"):
        Scene().do("fix h all hydro/vans 1 mesh 20 0.001 0 fluid 1000 0.001 gravity 0.5 0 -9.8 intensity 0.1")


def test_the_surface_stays_where_it_was_when_the_water_would_rise_above_the_mesh():
    """Who catches the error may go on: the next solve says the same."""
    s = Scene()
    s.spheres([(0.005, 0.005, 0.003)], [(0, 0, 0)], 0.003)
    s.do("fix h all hydro/vans 1 mesh 10 0.002 0 fluid 1000 0.001 gravity 0.05 0 -9.81 turbulence none "
         "surface follow 0.012 discharge 5 adjust depth 1e-4")
    for _ in range(2):
        with pytest.raises(Exception, match="above the mesh"):
            s.do("run 200")
        assert s.number("elevation") == pytest.approx(0.012, rel=1e-3)
    s.close()
