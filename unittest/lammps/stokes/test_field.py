"""fix stokes_dynamics/field: the flow that the forces on the spheres make, read back from its files."""
import os
import sys

import numpy as np
import pytest

from host import allowed
from model import mobility
from system import Spheres, chain, dump_lines, input_lines, lmp, read_dump

sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "..", "..", "examples"))
from image import Image  # noqa: E402

ETA = 1.3
OVERDAMPED = "fix move all stokes_dynamics/overdamped"
PULL = ("variable fx atom sin(3*id)\nvariable fy atom 0.1*id\nvariable fz atom -5-0.2*id\n"
        "fix pull all addforce v_fx v_fy v_fz")
SHEAR = "variable ux atom 0.3*z-0.1*y"
BOX = [(-6.0, 5.0), (-5.0, 5.5), (-4.0, 6.0)]


def cloud(n=12, seed=3, low=-5.0, high=5.0):
    """Spheres of two sizes, two of which overlap"""
    random = np.random.default_rng(seed)
    x = random.uniform(low, high, (n, 3))
    x[1] = x[0] + (0.9, 0.3, 0.2)
    return Spheres(x, np.where(np.arange(n) % 3 == 0, 1.1, 0.7), random.normal(size=(n, 3)))


def run(folder, spheres, style, more, grid="9 8 7", steps=0, ranks=1, every=1, **how):
    """The flow in the last step, and of the spheres x a v w, with fix=True also v' forces and torques of the fluid"""
    how.setdefault("fix", False)
    columns = "x y z radius vx vy vz omegax omegay omegaz" + (" f_drag[*]" if how["fix"] else "")
    lines = input_lines(spheres, style, str(folder / "data"), **how) + more
    lines += [f"fix field all stokes_dynamics/field {every} {folder}/flow.*.vti {grid}"]
    lmp(folder, lines + dump_lines(folder / "out", columns=columns) + [f"run {steps}"], ranks)
    return Image(folder / f"flow.{steps}.vti"), read_dump(str(folder / "out"))[-1][1]


def sum_over_spheres(points, x, a, F, T, eta):
    """u [..., 3] of the forces F and torques T on the fluid"""
    u = np.zeros_like(points)
    for k in range(len(x)):
        r = points - x[k]
        R = np.linalg.norm(r, axis=-1, keepdims=True)
        out = np.maximum(R, a[k])
        rF = (r @ F[k])[..., None]
        stokes = F[k] / out + r * rF / out**3 + a[k]**2 / 3 * (F[k] / out**3 - 3 * r * rF / out**5) + np.cross(
            T[k], r) / out**3
        u += np.where(R > a[k], stokes, 4 / 3 * F[k] / a[k] + np.cross(T[k], r) / a[k]**3) / (8 * np.pi * eta[k])
    return u


def inside(points, x, a, v, w, u):
    """u, with the velocity of the nearest sphere, in radii, inside of spheres; and where that is"""
    share = np.stack([np.linalg.norm(points - x[k], axis=-1) / a[k] for k in range(len(x))])
    nearest, within = share.argmin(axis=0), share.min(axis=0) <= 1
    r = points - x[nearest]
    return np.where(within[..., None], v[nearest] + np.cross(w[nearest], r), u), within


# --- the flow, against sums over all spheres ---------------------------------------------------------------------


@pytest.mark.parametrize("far_field, rotation, visc",
                         [("direct", "yes", "1.3"), ("ewald far_field_tolerance 1e-12", "yes", "1.3"),
                         ("direct", "no", "v_eta")])
def test_flow_is_that_of_the_forces(tmp_path, far_field, rotation, visc):
    spheres = cloud()
    style = (f"cut_off_distance inf algorithm 2 visc {visc} rotation {rotation} far_field {far_field} "
             "fluid_velocity v_ux 0.2 0 relative_tolerance 1e-9")
    field, rows = run(tmp_path, spheres, style, [], "15 13 9 lo -5 -5 -5 hi 5 5 5",
                      before_pair=f"{SHEAR}\nvariable eta atom 1.3+0.02*id", fix=True)
    x, a, v, w, F, T = rows[:, :3], rows[:, 3], rows[:, 4:7], rows[:, 7:10], -rows[:, 10:13], -rows[:, 16:19]
    eta = 1.3 + 0.02 * np.arange(1, 13) if visc == "v_eta" else np.full(len(x), 1.3)
    points = field.points()
    u = sum_over_spheres(points, x, a, F, T if rotation == "yes" else 0 * F, eta)
    u += np.stack([0.3 * points[..., 2] - 0.1 * points[..., 1], 0.2 + 0 * points[..., 0], 0 * points[..., 0]], axis=-1)
    u, within = inside(points, x, a, v, w, u)
    assert 5 < within.sum() == field["inside"].sum() and (within == field["inside"]).all()
    assert np.abs(field["velocity"] - u).max() <= 1e-10 * np.abs(u).max()


@pytest.mark.parametrize("tilt", [None, (2.0, -1.0, 1.5)])
def test_periodic_flow_carries_a_speck(tmp_path, tilt):
    """Spheres of radius 1e-6 without force, in a run of their own, at points of the grid"""
    spheres = cloud(low=-4.0)
    style = "cut_off_distance inf visc 1.3 rotation yes relative_tolerance 1e-9 far_field_tolerance 1e-12"
    pull = "variable f atom (id<=12)*(1+0.1*id)\nvariable g atom (id<=12)*sin(id)\nfix pull all addforce v_g 0.0 v_f"
    how = {"boundary": "p p p", "box": BOX, "tilt": tilt}
    field, _ = run(tmp_path, spheres, style, pull.splitlines() + [OVERDAMPED], **how)
    points, free = field.points().reshape(-1, 3), np.nonzero(field["inside"].ravel() == 0)[0][::37]
    (tmp_path / "specks").mkdir()
    specks = Spheres(np.vstack([spheres.x, points[free]]), np.concatenate([spheres.a, np.full(len(free), 1e-6)]))
    lines = input_lines(specks, style, str(tmp_path / "specks/data"), fix=False,
                        **how) + pull.splitlines() + [OVERDAMPED]
    lmp(tmp_path / "specks", lines + dump_lines(tmp_path / "specks/out", columns="vx vy vz") + ["run 0"])
    v = read_dump(str(tmp_path / "specks/out"))[-1][1][12:]
    u = field["velocity"].reshape(-1, 3)[free]
    assert len(free) >= 10 and np.abs(u - v).max() <= 1e-8 * np.abs(v).max()    # relative_tolerance


def test_sphere_of_points_has_the_flow_of_stokes(tmp_path):
    """multiblob 42: u of a falling sphere; the shell is that of the exact sphere to 2 % at 2 radii, to 0.5 % beyond
    4"""
    one = Spheres([(0, 0, 0)])
    field, rows = run(tmp_path, one, "cut_off_distance inf visc 1.3 multiblob 42",
                      ["fix pull all addforce 0 0 -3", OVERDAMPED], "9 1 9 lo 0 0 0 hi 8 0 8")
    U = -3 / (6 * np.pi * ETA)
    assert abs(rows[0, 6] / U - 1) < 1e-9
    r, u = field.axis(0)[2:], field["velocity"][0, 0, 2:, 2]
    error = np.abs(u / (U * (0.75 / r + 0.25 / r**3)) - 1)
    assert error[0] < 0.02 and error[2:].max() < 0.005
    assert field["inside"].sum() == 3 and np.abs(field["velocity"][0, 0, :2, 2] - U).max() < 1e-9


def test_sphere_of_points_in_shear(tmp_path):
    """Free of force and torque: u = G x - 5/2 a^3 x (x.E x)/r^5 (1 - a^2/r^2) - a^5 E x/r^5, E the rate of strain"""
    field, rows = run(tmp_path, Spheres([(0, 0, 0)]),
                      "cut_off_distance inf visc 1.3 multiblob 42 fluid_velocity v_ux 0 0", [OVERDAMPED],
                      "7 1 7 lo -6 0 -6 hi 6 0 6", before_pair="variable ux atom 0.8*z")
    assert abs(rows[0, 8] - 0.4) < 1e-6    # half the vorticity
    x = field.points()
    r = np.linalg.norm(x, axis=-1, keepdims=True)
    E = np.array([[0, 0, 0.4], [0, 0, 0], [0.4, 0, 0]])
    with np.errstate(divide="ignore", invalid="ignore"):
        u = -2.5 * x * np.einsum("...p,pq,...q", x, E, x)[..., None] / r**5 * (1 - 1 / r**2) - (x @ E) / r**5
    u[field["inside"] == 1] = 0
    disturbance = field["velocity"] - np.stack([0.8 * x[..., 2], 0 * x[..., 0], 0 * x[..., 0]], axis=-1)
    assert field["inside"].sum() == 1 and np.abs(disturbance[field["inside"] == 1]).max() < 1e-12
    far = (r[..., 0] > 3.9) & (field["inside"] == 0)
    assert (np.abs(disturbance - u).max() < 0.1 * np.abs(u).max() and np.abs((disturbance - u)[far]).max() < 0.03 *
            np.abs(u[far]).max())


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("who", ["nobody", "another group", "outside"])
def test_the_undisturbed_flow_without_spheres(tmp_path, who, ranks):
    """Formulas where no sphere takes part: LAMMPS evaluates them for atoms only. A later sphere is as if nothing had
    been."""
    spheres, style = Spheres([(1.0, 0.5, 0.3)],
                             v=(0.4, 0, 0)), "cut_off_distance inf visc 1.3 fluid_velocity v_ux 0.2 v_uz"
    style += {"nobody": "", "another group": " group some", "outside": " region far"}[who]
    before = SHEAR + "\nvariable uz atom 0.1*x*(y+1)\ngroup some id 7\nregion far block 3 4 3 4 3 4"
    lines = input_lines(spheres, style, str(tmp_path / "data"), before_pair=before, fix=False)
    lines += ["group all_of_it id 1", "delete_atoms group all_of_it"] if who == "nobody" else []
    lines += ["fix move all nve/sphere",
              f"fix field all stokes_dynamics/field 1 {tmp_path}/flow.*.vti 5 4 3 lo -2 -2 -2 hi 2 2 2", "run 2"]
    lines += ["create_atoms 1 single 0.1 0.2 0.3 units box", "set group all diameter 1 density 1",
              "run 1"] if who == "nobody" else []
    lmp(tmp_path, lines + dump_lines(tmp_path / "out", columns="id x y z vx") + ["run 0"], ranks)
    for step in (0, 1):
        field = Image(tmp_path / f"flow.{step}.vti")
        x = field.points()
        u = np.stack([0.3 * x[..., 2] - 0.1 * x[..., 1], 0.2 + 0 * x[..., 0], 0.1 * x[..., 0] * (x[..., 1] + 1)],
                     axis=-1)
        assert (np.abs(field["velocity"] - u).max() < 1e-14 and
                not field["inside"][np.linalg.norm(x - (1, 0.5, 0.3), axis=-1) > 1.1].any())
    rows = read_dump(str(tmp_path / "out"))[-1][1]
    assert len(rows) == 1 and (who == "nobody" or rows[0, 4] == 0.4)


# --- ways of the pair style -----------------------------------------------------------------------------------------


WAYS = {"films": "cut_off_distance inf rotation yes lubrication yes",
        "clumps": "cut_off_distance inf rigid_clumps yes rotation yes",
        "shells": "cut_off_distance inf multiblob 12 lubrication yes",
        "alone": "clumps_only yes rigid_clumps yes shell 12",
        "no memory": "cut_off_distance inf multiblob 12 warm_start no"}


@pytest.mark.parametrize("way", WAYS)
def test_far_away_only_the_weight_counts(tmp_path, way):
    """Whatever the model: the flow of a cluster is that of its weight from afar, but for what films of spheres that are
    points resist of their common motion, and the middle of a sphere moves as the sphere."""
    clump = way in ("clumps", "alone")
    spheres = chain(3, 2.2, axis=0, molecule=1 if clump else 0)
    field, rows = run(tmp_path, spheres, WAYS[way] + " visc 1.3", ["fix pull all addforce 0 0 -1", OVERDAMPED],
                      "3 1 2 lo 2.2 0 0 hi 602.2 0 300")
    u, r, rtol = field["velocity"], np.array((300.0, 600.0)), 1e-2 if way == "films" else 3e-4
    assert np.allclose(u[0, 0, 1:, 2], -3 / (8 * np.pi * ETA * r), rtol=rtol)
    assert np.allclose(u[1, 0, 0, 2], -3 / (4 * np.pi * ETA * 300), rtol=rtol)
    assert np.abs(u[0, 0, 0] - rows[1, 4:7]).max() < 1e-14 and (field["inside"].ravel() == (1, 0, 0, 0, 0, 0)).all()


@pytest.mark.parametrize("way", ["shells", "clumps"])
def test_ranks_and_runs_in_two_parts(tmp_path, way):
    """The same file from 1 to 4 ranks, and where a run has ended and the next one begins"""
    random = np.random.default_rng(5)
    x = np.array([(i, j, k) for i in (-4, 0, 3.4) for j in (-3, 1, 4) for k in (-2, 2)]) + random.uniform(
        -0.3, 0.3, (18, 3))
    spheres = Spheres(np.vstack([x, x[:2] + (1.2, 0.8, 0.7)]), 0.9,
                      molecule=np.where(np.arange(20) % 18 < 2, 1 + np.arange(20) % 18, 0))
    style = (WAYS[way] + " visc 1.3 relative_tolerance 1e-11 far_field_tolerance 1e-10" +
             (" rigid_clumps yes" if way == "shells" else ""))
    first = None
    for ranks in allowed(1, 2, 3, 4):
        folder = tmp_path / str(ranks)
        folder.mkdir()
        field, _ = run(folder, spheres, style, PULL.splitlines() + [OVERDAMPED, "timestep 1e-3", "run 2"] * (ranks == 1)
                       + (PULL.splitlines() + [OVERDAMPED, "timestep 1e-3"]) * (ranks > 1), steps=2 if ranks > 1 else 0,
                       ranks=ranks, boundary="p p p", box=BOX) if ranks > 1 else (None, None)
        if ranks == 1:
            lines = input_lines(spheres, style, str(folder / "data"), fix=False, boundary="p p p",
                                box=BOX) + PULL.splitlines()
            lines += [OVERDAMPED, "timestep 1e-3", f"fix field all stokes_dynamics/field 2 {folder}/flow.*.vti 9 8 7",
                      "run 2"]
            lmp(folder, lines + [f"shell cp {folder}/flow.2.vti {folder}/end.vti", "run 0"])
            first = Image(folder / "end.vti")
            again = Image(folder / "flow.2.vti")
            assert np.abs(again["velocity"] - first["velocity"]).max() < 1e-10 * np.abs(first["velocity"]).max()
            assert first.time == 0.002 and sorted(os.listdir(folder))[:3] == ["data", "end.vti", "flow.0.vti"]
            continue
        # of sums to 1e-10
        assert np.abs(field["velocity"] - first["velocity"]).max() < 1e-6 * np.abs(first["velocity"]).max()
        assert (field["inside"] == first["inside"]).all()


GIVEN = {"open, all pairs": ("far_field direct", {}), "open, split": ("far_field ewald", {}),
         "periodic": ("", {"boundary": "p p p", "box": BOX}),
         "tilted": ("", {"boundary": "p p p", "box": BOX, "tilt": (2.0, -1.0, 1.5)})}


@pytest.mark.parametrize("way", GIVEN)
def test_forces_that_are_given_make_one_flow_on_all_ranks(tmp_path, way):
    """Free spheres without inertia: no solve comes in between, so that ranks differ by rounding only; by that of
    doubles at this tolerance."""
    style, how = GIVEN[way]
    style += " relative_tolerance 9e-5"
    flows = []
    for ranks in allowed(1, 2, 3, 4):
        folder = tmp_path / str(ranks)
        folder.mkdir()
        field, _ = run(folder, cloud(40, low=-3.9, high=4.9),
                       f"cut_off_distance inf visc 1.3 {style} fluid_velocity 0.3 0 0",
                       PULL.splitlines() + [OVERDAMPED], "9 8 11", ranks=ranks, **how)
        flows.append(field)
    u = flows[0]["velocity"]
    for field in flows[1:]:
        assert (np.abs(field["velocity"] - u).max() < 1e-10 * np.abs(u).max() and
                (field["inside"] == flows[0]["inside"]).all())


@pytest.mark.parametrize("scheme", ["ab2", "euler", "midpoint"])
def test_the_flow_goes_with_the_velocities_of_noise_or_without(tmp_path, scheme):
    """With a temperature the flow is that of the forces where noise has put the spheres; the slip of midpoint, which v
    has, is none of it."""
    spheres = cloud()
    field, rows = run(tmp_path, spheres, "cut_off_distance inf visc 1.3", PULL.splitlines() +
                      [f"fix move all stokes_dynamics/overdamped temperature 2 4711 scheme {scheme}", "timestep 0.01"],
                      "9 8 7 lo -6 -6 -6 hi 6 6 6", steps=2)
    x, a, v, w = rows[:, :3], rows[:, 3], rows[:, 4:7], rows[:, 7:10]
    k = np.arange(1.0, 13.0)
    F = np.stack([np.sin(3 * k), 0.1 * k, -5 - 0.2 * k], axis=-1)
    slip = v - (mobility(x, a, 1.3) @ F.ravel()).reshape(-1, 3)
    assert (np.abs(slip).max() > np.abs(v - slip).max()) == (scheme == "midpoint")    # sqrt(2 kT/(6 pi eta a dt)) is 4
    u, within = inside(field.points(), x, a, v, 0 * w,
                       sum_over_spheres(field.points(), x, a, F, 0 * F, np.full(12, 1.3)))
    assert np.abs(x - spheres.x).max() > 0.1    # 0.04 sigma
    assert within.sum() > 3 and np.abs(field["velocity"] - u).max() <= 1e-10 * np.abs(u).max()


def test_sheared_box(tmp_path):
    """From a point to its image the velocity grows by what the box shears, in the fluid and in the spheres."""
    spheres = cloud(low=-3.9, high=4.9)
    field, _ = run(tmp_path, spheres,
                   "cut_off_distance inf visc 1.3 rotation yes fluid_velocity box relative_tolerance 1e-6",
                   PULL.splitlines() + ["fix shear all deform 1 xz erate 0.4 remap none", OVERDAMPED, "timestep 0.01"],
                   "12 5 21 lo -6 -5 -4 hi 5 5.5 16", steps=1, boundary="p p p", box=BOX, tilt=(0.0, 0.0, 0.0))
    u, tilt = field["velocity"], 0.04    # of z = 6, 0.4 10 0.01, which is no multiple of the spacing
    fine, _ = run(tmp_path, spheres,
                  "cut_off_distance inf visc 1.3 rotation yes fluid_velocity box relative_tolerance 1e-6",
                  PULL.splitlines() + ["fix shear all deform 1 xz erate 0.4 remap none", OVERDAMPED, "timestep 0.01"],
                  f"12 5 11 lo {-6 + tilt} -5 6 hi {5 + tilt} 5.5 16", steps=1, boundary="p p p", box=BOX,
                  tilt=(0.0, 0.0, 0.0))
    growth = fine["velocity"] - u[:11]
    assert np.abs(growth - (4.0, 0, 0)).max() < 1e-6 and fine["inside"].sum() > 5


@pytest.mark.parametrize("n, how, split, rtol",
                         [(3, "relative_tolerance 1e-8", "far_field ewald far_field_tolerance 1e-8", 1e-6),
                          (7, "", "", 1e-2)])
def test_points_of_an_open_cloud_stand_where_the_spheres_are(tmp_path, n, how, split, rtol):
    """The flow of shells by Ewald sums, in a box around the cloud, is that of all pairs, wherever the input stands. The
    tolerance is that of the solves; 343 spheres take Ewald sums by themselves."""
    random = np.random.default_rng(3)
    x = 3.0 * np.stack(np.meshgrid(*3 * [np.arange(n)]), axis=-1).reshape(-1, 3) + random.uniform(-0.3, 0.3, (n**3, 3))
    pull = ["variable fz atom -5-0.2*id", "fix pull all addforce 0 0 v_fz", OVERDAMPED]
    flows = []
    for far_field, by in (("far_field direct", (10.0, -4.0, 2.0)), (split, (10.0, -4.0, 2.0)),
                          (split, (-35.0, 7.0, 300.0))):
        folder = tmp_path / str(len(flows))
        folder.mkdir()
        lo, hi = np.array(by) - 4, np.array(by) + 10
        style = f"cut_off_distance inf visc 1.3 multiblob 12 {how} {far_field}"
        flows.append(run(folder, Spheres(x + by), style, pull,
                         "9 9 9 lo {} {} {} hi {} {} {}".format(*lo, *hi))[0]["velocity"])
    assert np.abs(flows[1:] - flows[0]).max() < rtol * np.abs(flows[0]).max()


def test_points_of_an_open_cloud_between_two_solves(tmp_path):
    """With inertia and update_every 2: the file of a step with a solve and that of a step without one are alike."""
    random = np.random.default_rng(3)
    x = 3.0 * np.stack(np.meshgrid(*3 * [np.arange(3)]), axis=-1).reshape(-1, 3) + (10.0, -4.0, 2.0)
    spheres = Spheres(x, v=random.normal(size=(27, 3)))
    run(tmp_path, spheres, "cut_off_distance inf visc 1.3 multiblob 12 far_field ewald update_every 2",
        ["fix move all nve/sphere", "timestep 1e-9"], "9 9 9 lo 6 -8 -2 hi 20 6 12", steps=3)
    flows = [Image(tmp_path / f"flow.{step}.vti")["velocity"] for step in range(4)]
    assert all(np.abs(u - flows[0]).max() < 1e-4 * np.abs(flows[0]).max() for u in flows[1:])


# --- messages ---------------------------------------------------------------------------------------------------------


BAD = {"FILE: 'flow.vti' must have a": "1 flow.vti 3 3 3", "N: '0' must be >= 1": "0 f.*.vti 3 3 3",
       "ny": "1 f.*.vti 3 0 3", "keyword hi: '0' must be above lo, 1": "1 f.*.vti 3 3 3 lo 1 1 1 hi 0 2 2",
       "keywords lo and hi: '1e+308' is too far away": "1 f.*.vti 3 3 3 hi 1 1 1e308",
       "must have fewer than 7e8": "1 f.*.vti 1000 1000 1000",
       "unknown keyword": "1 f.*.vti 3 3 3 above 1", "could not be written": "1 nowhere/f.*.vti 3 3 3",
       "leaves no room": "1 f.*.vti 3 3 3 lo 900 0 0"}


@pytest.mark.parametrize("why", BAD)
def test_bad_input_is_named(tmp_path, why):
    lines = input_lines(cloud(), "cut_off_distance inf visc 1.3", str(tmp_path / "data"), fix=False)
    done = lmp(tmp_path, lines + [f"fix field all stokes_dynamics/field {BAD[why]}", "run 0"], succeed=False)
    assert "ERROR: Fix stokes_dynamics/field" in done.text and why in done.text, done.text[-600:]


@pytest.mark.parametrize("hi", ["5 1e9 5", "5 1e20 5", "1e9 1e9 1e9"])
def test_a_grid_far_beyond_a_periodic_box_is_refused(tmp_path, hi):
    """It would go through all images of the spheres."""
    lines = input_lines(cloud(low=-3.9, high=4.9), "cut_off_distance inf visc 1.3", str(tmp_path / "data"), fix=False,
                        boundary="p p p", box=BOX)
    done = lmp(tmp_path, lines + [f"fix field all stokes_dynamics/field 1 {tmp_path}/f.*.vti 3 4 5 hi {hi}", "run 0"],
               succeed=False)
    assert "sees more than 1000 images of each sphere" in done.text and "lo and hi" in done.text, done.text[-600:]


def test_a_file_that_does_not_fit_is_removed(tmp_path):
    os.symlink("/dev/full", tmp_path / "flow.0.vti")
    lines = input_lines(cloud(), "cut_off_distance inf visc 1.3", str(tmp_path / "data"), fix=False)
    done = lmp(tmp_path, lines + [f"fix field all stokes_dynamics/field 1 {tmp_path}/flow.*.vti 20 20 20", "run 0"],
               succeed=False)
    assert "flow.0.vti' could not be written" in done.text and not os.path.lexists(
        tmp_path / "flow.0.vti"), done.text[-600:]


def test_what_it_needs(tmp_path):
    field = f"fix field all stokes_dynamics/field 1 {tmp_path}/f.*.vti 3 3 3"
    start = input_lines(cloud(), ["pair_style zero 1", "pair_coeff * *"], str(tmp_path / "data"), fix=False)
    assert "there is no pair_style stokes_dynamics whose flow" in lmp(tmp_path, start + [field, "run 0"],
                                                                      succeed=False).text
    half = input_lines(cloud(low=-3.9, high=4.9), "cut_off_distance 3 visc 1.3", str(tmp_path / "data"), fix=False,
                       boundary="p f f", box=BOX)
    assert "periodic in 1 of 3 directions" in lmp(tmp_path, half + [field, "run 0"], succeed=False).text
    own = input_lines(cloud(), "cut_off_distance inf visc 1.3 algorithm 2 fluid_velocity v_ux 0 0",
                      str(tmp_path / "data"), fix=False, before_pair="variable ux atom 0.1*id")
    assert "the velocity belongs to atoms (0.1 to 1.2 at one place)" in lmp(tmp_path, own + [field, "run 0"],
                                                                            succeed=False).text
    wall = input_lines(cloud(), "cut_off_distance inf visc 1.3 wall zlo -20", str(tmp_path / "data"), fix=False)
    assert "the pair style has keyword wall" in lmp(tmp_path, wall + [field, "run 0"], succeed=False).text
