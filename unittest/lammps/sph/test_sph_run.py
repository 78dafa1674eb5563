"""SPH in motion: sound waves, restart, walls, time step limits."""
import numpy as np
import pytest

import sph_tools as T
from host import allowed
from sph_tools import by_id, evaluate, mpirun, pair_commands, random_scene, run, start, tait
from sph_wave import wave


def off(value, expected):
    return np.abs(value - expected).max() / np.abs(expected).max()


# --- time stepping -----------------------------------------------------------------------------------------------


def test_sound_wave_does_not_grow(tmp_path):
    """Leapfrog keeps the energy in a band of order (w dt)^2, here 1e-3, however long it runs; so the second half is no
    wider than the first."""
    _, energy, _ = wave(str(tmp_path / "wave.data"), "nve/sph", 0.2, 20000, 40)
    band = np.abs(energy / energy[0] - 1)
    assert band.max() < 1.5e-3
    assert band[20:].max() < 1.2 * band[:21].max()


def test_sound_wave_with_fix_sph_of_lammps_grows(tmp_path):
    """The scheme of fix sph is unstable without viscosity: what the leapfrog is for."""
    _, energy, _ = wave(str(tmp_path / "wave.data"), "sph", 0.2, 1000, 2)
    assert energy[-1] > 1.02 * energy[0]


MOVING = random_scene() + "timestep 2e-5\n"
FIXES = """
fix eos all sph/pressure Tait 60000 1000 7
fix density all sph/density/continuity delta 0.05
fix filter all sph/density/corr shepard every 30
fix move all nve/sph
"""


def scene(extra=""):
    return (MOVING.replace("fix eos", "#").replace("fix density", "#") +
            pair_commands("wendland", 1, 1, "viscosity 0.2") + FIXES + extra)


def state(lmp):
    return by_id(lmp, "x", 3), by_id(lmp, "v", 3), by_id(lmp, "rho"), by_id(lmp, "f", 3)


def trajectory(*parts):
    lmp = start()
    try:
        for part in parts:
            run(lmp, part)
        return state(lmp)
    finally:
        lmp.close()


@pytest.fixture(scope="module")
def unbroken():
    return trajectory(scene("run 100"))


def same(a, b, limit=1e-12):
    for name, one, other in zip("x v rho f".split(), a, b):
        assert off(one, other) <= limit, name


def test_run_in_pieces_is_one_run(unbroken):
    same(trajectory(scene("run 37\nrun 0\nrun 63")), unbroken)


def test_a_data_file_that_is_written_between_two_runs_changes_nothing(unbroken, tmp_path):
    """LAMMPS prepares a run for it, of which no force comes."""
    write = f"write_data {tmp_path}/data\n"
    same(trajectory(scene("run 37\n" + 2 * write + "run 63")), unbroken)


@pytest.mark.parametrize("how", ["run 50\nwrite_restart {0}", "restart 50 {0}\nrun 60\nshell mv {0}.50 {0}",
                                 "run 50\nwrite_data {0}.data\nwrite_restart {0}"])
def test_restart_without_pair_style(how, unbroken, tmp_path):
    """The pair style and its coefficients come back from the file; the fixes are given again, as LAMMPS wants it."""
    path = str(tmp_path / "restart")
    trajectory(scene(how.format(path)))
    again = ("atom_modify map array\nread_restart %s\nneighbor 0.003 bin\nneigh_modify delay 0 every 1\n"
             "timestep 2e-5\n" % path)
    same(trajectory(again + FIXES + "run 50"), unbroken)


@pytest.mark.parametrize("gone", ["density", "eos", "filter", "SPH_SHIFT_STATE", "wall"])
def test_a_run_that_is_not_prepared_misses_a_fix_that_is_gone(gone):
    lines = scene().replace("tensCorr", "#") if gone == "SPH_SHIFT_STATE" else scene()
    if gone == "SPH_SHIFT_STATE":
        lines = (MOVING.replace("fix eos", "#").replace("fix density", "#") +
                 "pair_style sph/artVisc/tensCorr wendland 0.012 shift yes\n"
                 "pair_coeff * * c 20 deltap 0.01\n" + FIXES)
    if gone == "wall":
        lines = lines.replace("fix move all", "group w id 1:9\ngroup fluid subtract all w\nfix wall w wall/adami/sph\n"
                                              "fix move fluid")
    lmp = start()
    try:
        run(lmp, lines + f"run 1\nunfix {gone}")
        with pytest.raises(RuntimeError, match=f"fix {gone} of style .* has been deleted since the last run"):
            run(lmp, "run 1 pre no")
    finally:
        lmp.close()


def test_a_run_that_is_not_prepared_misses_the_region_of_a_wall():
    lmp = start()
    try:
        run(lmp, scene("region r block INF INF INF INF INF INF\nfix w all wall/region/sph r 1e-4 5\nrun 1\n"
                       "region r delete"))
        with pytest.raises(RuntimeError, match="region 'r' does not exist"):
            run(lmp, "run 1 pre no")
    finally:
        lmp.close()


def test_a_run_that_is_not_prepared_misses_a_pair_style_that_is_new():
    lmp = start()
    try:
        run(lmp, scene("run 1\n") + pair_commands("wendland", 1, 1))
        with pytest.raises(RuntimeError, match="no run has prepared it yet"):
            run(lmp, "run 1 pre no")
    finally:
        lmp.close()


def test_a_fix_with_the_id_of_the_memory_stays_when_the_pair_style_goes(tmp_path):
    done = mpirun(1, random_scene() + pair_commands("wendland", 1, 1) + "\nfix SPH_SHIFT_STATE all nve\n"
                  "pair_style none\nunfix SPH_SHIFT_STATE\nclear\nprint ended",
                  tmp_path)
    assert done.returncode == 0 and "ended" in done.stdout, done.stdout[-1000:]


def test_restart_without_fixes_is_an_error(tmp_path):
    path = str(tmp_path / "restart")
    trajectory(scene("run 5\nwrite_restart " + path))
    with pytest.raises(RuntimeError, match="no fix sph/pressure"):
        trajectory("read_restart %s\nrun 5" % path)


@pytest.mark.ranks(2)
def test_restart_file_of_another_version_is_said_once_and_not_read(tmp_path):
    """The run then starts from the velocities as they are, like any first run."""
    path = tmp_path / "restart"
    trajectory(scene("run 50\nwrite_restart %s" % path))
    mine = path.read_bytes()
    assert mine.count(b"stokesdyn 1 nve/sph") == 1
    path.write_bytes(mine.replace(b"stokesdyn 1 nve/sph", b"stokesdyn 7 nve/sph"))
    done = mpirun(2, "read_restart %s\nneighbor 0.003 bin\nneigh_modify delay 0 every 1\ntimestep 2e-5\n" % path +
                  FIXES + "run 5", tmp_path)
    assert done.returncode == 0, done.stdout
    warnings = [line for line in done.stdout.splitlines() if "WARNING" in line and "nve/sph" in line]
    assert len(warnings) == 1, done.stdout


def test_new_velocities_are_seen_at_once():
    """A velocity that changed between two runs replaces the estimate that the last run left."""
    lmp = start()
    try:
        run(lmp, scene("run 10\nset atom 7 vx 2.5\nrun 0"))
        types = by_id(lmp, "type") - 1
        each = lambda values: np.array(values)[types]
        rho = by_id(lmp, "rho")
        F = evaluate("wendland", 3, by_id(lmp, "x", 3), by_id(lmp, "v", 3), rho, tait(rho), each(T.MASS), each(T.H),
                     (each(T.ALPHA), each(T.BETA), each(T.C), T.ETA), (T.EPSILON, each(T.DELTAP)), 0.2)[0]
        assert off(by_id(lmp, "f", 3), F) <= 1e-12
    finally:
        lmp.close()


def test_particles_at_rest_change_density_only():
    lmp = start()
    try:
        run(lmp, random_scene() + pair_commands("wendland", 0, 0) +
            "\ngroup one type 1\ngroup two type 2\nvelocity two set 0 0 0\nfix a one nve/sph\n"
            "fix b two nve/sph/stationary\ntimestep 1e-5\nrun 0")
        x, rho, types = by_id(lmp, "x", 3), by_id(lmp, "rho"), by_id(lmp, "type")
        run(lmp, "run 10")
        still = types == 2
        assert np.abs(by_id(lmp, "x", 3) - x)[still].max() == 0.0
        assert np.abs(by_id(lmp, "rho") - rho)[still].min() > 0.0
        assert np.abs(by_id(lmp, "x", 3) - x)[~still].min() > 0.0
    finally:
        lmp.close()


def test_communication_is_handed_back(tmp_path):
    """Ghost velocities are asked for as long as the pair style is there, and kept where the user asked for them."""
    for user in ("no", "yes"):
        done = mpirun(1, scene("comm_modify vel %s\nrun 0\ninfo communication\npair_style none\ninfo communication" %
                               user), tmp_path)
        said = [line.split()[-1] for line in done.stdout.splitlines() if "elocities for ghost" in line]
        assert said == ["yes", user], done.stdout


# --- walls ------------------------------------------------------------------------------------------------------------


def one_particle(x, wall):
    """Force on one lone particle at x, and on the wall."""
    lmp = start()
    try:
        run(lmp, """
        units si
        atom_style sph
        boundary f f f
        region box block -2 2 -2 2 -2 2 units box
        create_box 1 box
        create_atoms 1 single %.17g %.17g %.17g units box
        mass 1 0.013
        set group all sph/rho 1010
        neighbor 0.1 bin
        pair_style sph/artVisc/tensCorr cubicspline 0.12
        pair_coeff * *
        comm_modify cutoff 1
        fix eos all sph/pressure Tait 60000 1000 7
        fix density all sph/density/continuity
        fix move all nve/sph
        %s
        run 0
        """ % (*x, wall))
        return by_id(lmp, "f", 3)[0], np.array([lmp.extract_fix("w", 0, 1, k) for k in range(3)])
    finally:
        lmp.close()


def repulsion(D, r0, r):
    return D * ((r0 / r) ** 4 - (r0 / r) ** 2)


@pytest.mark.parametrize("wall, x, expected", [
    ("xplane -1 1 0.3 5", (-0.8, 0, 0), (repulsion(5, 0.3, 0.2), 0, 0)),
    ("xplane -1 1 0.3 5", (0.9, 0, 0), (-repulsion(5, 0.3, 0.1), 0, 0)),
    ("xplane -1 1 0.3 5", (0.6, 0, 0), (0, 0, 0)),
    ("yplane NULL 1 0.3 5", (0, 0.9, 0), (0, -repulsion(5, 0.3, 0.1), 0)),
    ("zplane -1 NULL 0.3 5", (0, 0, -0.9), (0, 0, repulsion(5, 0.3, 0.1))),
    ("zcylinder 1 0.3 5", (0.6 * 0.9, 0.8 * 0.9, 0.4), (-0.6 * repulsion(5, 0.3, 0.1), -0.8 * repulsion(5, 0.3, 0.1),
                                                        0)),
    ("zcylinder 1 0.3 5", (0, 0, 0.4), (0, 0, 0)),
])
def test_wall_forces(wall, x, expected):
    force, on_wall = one_particle(x, "fix w all wall/sph " + wall)
    assert np.abs(force - expected).max() <= 1e-12 * 500
    assert np.abs(force + on_wall).max() <= 1e-12


def test_region_wall_adds_a_mirror_particle():
    """In a corner of a block both walls push."""
    r0, D, m, rho, h = 0.3, 5.0, 0.013, 1010.0, 0.12
    expected = [0.0, 0.0, 0.0]
    for axis, r in ((0, 0.2), (1, 0.1)):
        dW = T.kernel("cubicspline", 3, np.array(r), h)[1]
        expected[axis] = repulsion(D, r0, r) + m * m * 2 * tait(rho) / rho**2 * abs(dW)
    force, _ = one_particle((-0.8, -0.9, 0),
                            "region r block -1 1 -1 1 -1 1 units box\nfix w all wall/region/sph r 0.3 5")
    assert np.abs(force - expected).max() <= 1e-12 * np.abs(expected).max()


TANK = """
units lj
dimension 2
atom_style sph
boundary f f p
lattice sq 100 origin 0.5 0.5 0
region box block -0.6 1.6 -0.6 1.2 -0.05 0.05 units box
create_box 2 box
region water block 0 1 0 0.5 -0.05 0.05 units box
region tank block -0.39 1.39 -0.39 0.79 -0.05 0.05 units box
region outside block 0 1 0 1.2 -0.05 0.05 units box side out
region walls intersect 2 tank outside
create_atoms 1 region water
create_atoms 2 region walls
mass * 0.01
group water type 1
group walls type 2
set group all sph/rho 1
neighbor 0.05 bin
pair_style sph/artVisc/tensCorr wendland 0.2 viscosity 0.01 central
pair_coeff * * c 10
fix eos all sph/pressure Tait 14.3 1 7
fix density all sph/density/continuity delta 0.1
fix move water nve/sph
fix weight water addforce %g -0.01 0
variable x equal 0.5*%g*time^2
variable v equal %g*time
variable b equal -0.3
variable zero equal 0
fix push walls move variable v_x v_zero NULL v_v v_zero NULL
fix w walls wall/adami/sph gravity v_b -1 0 slip %s
timestep %g
run %d
"""


def tank(a, push, slip, dt, steps):
    """Water in a tank that moves with a t^2/2, and on it the force per mass `push`: where it is in the tank, how fast,
    and its force on the walls."""
    lmp = start()
    try:
        run(lmp, TANK % (0.01 * push, a, a, slip, dt, steps))
        water, t = by_id(lmp, "type") == 1, dt * steps
        x, v = by_id(lmp, "x", 3)[water], by_id(lmp, "v", 3)[water]
        force = np.array([lmp.extract_fix("w", 0, 1, k) for k in range(3)])
        return x - [0.5 * a * t * t, 0, 0], v - [a * t, 0, 0], force
    finally:
        lmp.close()


@pytest.mark.parametrize("slip", ["yes", "no"])
def test_a_tank_that_is_pushed_is_a_tank_at_rest_with_the_inertial_force(slip):
    """Up to a t dt/2: the density takes the velocity of the water in the middle of a step, and of the walls what fix
    move has set, that at the end."""
    a, t, apart = 0.3, 0.6, []
    for steps in (150, 300):
        dt = t / steps
        (x, v, F), (x0, v0, F0) = tank(a, 0.0, slip, dt, steps), tank(0.0, -a, slip, dt, steps)
        assert np.abs(v0).max() > 0.1 and abs(F0[0]) > 0.1
        apart.append([np.abs(x - x0).max() / (a * t * dt / 2), np.abs(v - v0).max() / dt, np.abs(F - F0).max() / dt])
    assert 0.9 < apart[1][0] < 1.1
    assert np.allclose(apart[0], apart[1], rtol=0.02)


# --- time step limits -------------------------------------------------------------------------------------------------


def check(lmp):
    return lmp.extract_fix("c", 0, 1, 0), lmp.extract_fix("c", 0, 1, 1), lmp.extract_fix("c", 0, 0)


@pytest.mark.parametrize("form, share", [("", 0), ("viscosity 500", 8), ("viscosity 500 central", 18),
                                         ("viscosity 500 central implicit yes", 0)])
def test_step_limit_is_that_of_the_worst_particle(form, share):
    lmp = start()
    try:
        run(lmp, random_scene() + pair_commands("wendland", 1, 0, form) +
            "\nfix move all nve/sph\ntimestep 1e-9\nfix c all check/timestep/sph 1 0.5\nrun 0")
        x, v, rho, types = by_id(lmp, "x", 3), by_id(lmp, "v", 3), by_id(lmp, "rho"), by_id(lmp, "type") - 1
        h, c = np.array(T.H)[types], np.array(T.C)[types]
        d, u = x[:, None] - x[None], v[:, None] - v[None]
        r2, vd, hm = (d**2).sum(-1), (d * u).sum(-1), (h[:, None] + h[None]) / 2
        approach = np.where(r2 < 4 * hm**2, np.abs(hm * vd / (r2 + T.ETA)), 0).max(1)
        limit = h / (c + approach)
        if share:
            limit = np.minimum(limit, h**2 * rho / (share * 500))
        smallest, worst, ratio = check(lmp)
        assert abs(smallest / limit.min() - 1) < 1e-12
        assert worst == 1 + np.argmin(limit)
        assert abs(ratio * limit.min() / 1e-9 - 1) < 1e-12
    finally:
        lmp.close()


@pytest.mark.parametrize("form, kernel, h", [("central", "wendland", 0.16), ("central", "cubicspline", 0.12),
                                             ("laplacian", "wendland", 0.16)])
def test_friction_is_stable_up_to_the_limit_of_the_step(form, kernel, h):
    """Noise on a disturbed lattice of spacing 0.08 dies in steps of 0.99 of the limit. With central it grows from 1.06
    of it on (wendland); h^2 rho/(8 mu) of laplacian let the water fly apart."""
    lmp = start()
    run(lmp, f"""
        units lj
        dimension 2
        atom_style sph
        atom_modify map array
        lattice sq $(1/0.08^2) origin 0.5 0.5 0
        region all block 0 12 0 12 -0.1 0.1
        create_box 1 all
        create_atoms 1 box
        mass 1 $(0.08^2)
        set group all sph/rho 1
        displace_atoms all random 0.004 0.004 0 4711 units box
        velocity all create 1e-8 4711
        neighbor 0.02 bin
        neigh_modify delay 0 every 1
        pair_style sph/artVisc/tensCorr {kernel} {h} viscosity 1 {form} {"shift yes" if kernel == "wendland" else ""}
        pair_coeff * * c 1
        fix eos all sph/pressure Tait $(1/7) 1 7
        fix density all sph/density/continuity delta 0.1
        fix move all nve/sph
        fix c all check/timestep/sph 1000 1
        fix flat all enforce2d
        timestep 1e-9
        run 0""")
    run(lmp, f"timestep {0.99 * check(lmp)[0]}\nrun 100")
    early = (by_id(lmp, "v", 3)**2).sum()
    run(lmp, "run 200")
    late = (by_id(lmp, "v", 3)**2).sum()
    lmp.close()
    assert late < 0.9 * early


def test_step_limit_on_any_number_of_ranks(tmp_path):
    lines = set()
    for ranks in allowed(1, 2, 4):
        for newton in ("on", "off"):
            done = mpirun(ranks, random_scene(newton) + pair_commands("wendland", 1, 0) +
                          "\nfix move all nve/sph\ntimestep 1e-4\nfix c all check/timestep/sph 10 0.1 warn\nthermo 10\n"
                          "thermo_style custom step f_c f_c[1] f_c[2]\nrun 20", tmp_path)
            assert done.returncode == 0, done.stdout
            warnings = [line.split("(")[0] for line in done.stdout.splitlines() if "more than 0.1" in line]
            assert len(warnings) == 3
            lines.add("\n".join(warnings))
    assert len(lines) == 1
