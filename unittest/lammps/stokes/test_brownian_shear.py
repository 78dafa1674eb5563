"""Brownian motion in a box that deforms with the fluid: scheme midpoint in the frame that goes with the box, its
moments in shear, images of the half-way box, flips, one run on several ranks and in pieces."""
import numpy as np
import pytest

from brownian import A, BEYOND, ETA, KT, TIGHT, UNIT, check_pieces, check_ranks, noise
from host import by_open_mpi
from system import LammpsError, Spheres, dump_lines, input_lines, read_dump
from test_brownian_bodies import SHARP, close_spheres, in_few_clumps
from test_sheared_box import edges, up_to_images

COMM = "comm_modify vel yes"


def sheared(simulation, spheres, words, side, rate, dt, options="", kT=KT, deform="flip yes", tilt=0.0):
    """In a cube of this side, whose lower corner is not the origin, a shear u_x = rate (y - ylo)"""
    lo = np.array([-1.0, 2.0, 0.5])
    sim = simulation(Spheres(spheres.x + lo, spheres.a, molecule=spheres.molecule),
                     f"cut_off_distance inf visc {ETA} fluid_velocity box {words}",
                     fix=False, dt=dt, boundary="p p p", box=[(c, c + side) for c in lo], tilt=(tilt, 0.0, 0.0),
                     comm=COMM)
    if rate:
        sim.commands(f"fix d all deform 1 {deform if 'rate' in deform else f'xy erate {rate!r} {deform}'} remap v")
    return noise(sim, options, kT)


# --- one sphere, far from its images: the steps are known number by number --------------------------------------------

FAR = 4000.0    # its images change its mobility by 5e-4, and the shape of the box changes that by 1e-7


def path(simulation, folder, h, rate, steps, trap=None, scheme="midpoint"):
    """Places [steps + 1, 3] less that of the start, at the height where the fluid rests, and velocities [steps, 3]
    beyond the fluid's; dt is h times UNIT, which is 1/mobility. trap: its stiffness"""
    sim = sheared(simulation, Spheres([(FAR / 2, 0.0, FAR / 2)], A), "", FAR, rate, h * UNIT, f"scheme {scheme}")
    if trap:
        sim.commands(f"fix trap all spring/self {trap!r}")
    sim.commands(dump_lines(folder / "path", every=1, columns="xu yu zu f_move[1] f_move[2] f_move[3]")).run(steps)
    rows = np.array([rows[0] for _, rows in read_dump(folder / "path")])
    return rows[:, :3] - rows[0, :3], rows[:-1, 3:]


def shear(rate, t):
    return np.array([(1.0, rate * t, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)])


# random numbers in a box that is sheared: its waves, which are a part of them, differ from those of a cube
OF_WAVES = 0.03


def test_the_noise_of_a_step_is_carried_for_half_of_it(simulation, tmp_path):
    """x <- S(dt) x + S(dt/2) dt V', V' the velocity beyond that of the fluid half a step later, with the random numbers
    of a run without shear"""
    h, rate = 0.1, 0.3 / UNIT
    d = np.diff(path(simulation, tmp_path, h, 0.0, 30)[0], axis=0)
    x, v = path(simulation, tmp_path, h, rate, 30)
    step = h * UNIT * v
    for k in range(30):
        assert np.abs(x[k + 1] - shear(rate, h * UNIT) @ x[k] - shear(rate, 0.5 * h * UNIT) @
                      step[k]).max() < 1e-9 * np.abs(x).max()
    assert np.abs(step - d).max() < OF_WAVES * np.abs(d).max()


def moments(Pe, h):
    """Exact <xx>, <xy>, <yy> over kT/k of a step with the forces of the scheme: the covariance C of (x, the place that
    F_old is of) that a step leaves as it is, C = T C T' + B B'"""
    S = lambda t: shear(Pe, t)[:2, :2]
    T, B = np.zeros((4, 4)), np.zeros((4, 2))
    T[:2, :2], T[:2, 2:], T[2:, :2] = S(h) - 1.5 * h * S(0.5 * h), 0.5 * h * S(0.5 * h), np.eye(2)
    B[:2] = np.sqrt(2 * h) * S(0.5 * h)
    C = np.linalg.solve(np.eye(16) - np.kron(T, T), (B @ B.T).ravel()).reshape(4, 4)
    return C[0, 0], C[0, 1], C[1, 1]


@pytest.mark.parametrize("Pe", [0.1, 1.0, 10.0])
@pytest.mark.parametrize("h, xy", [(0.2, 2.07e-3), (0.1, 2.5e-4), (0.05, 3e-5)])
def test_a_dumbbell_in_shear_has_the_moments_of_the_half_way_frame(simulation, tmp_path, Pe, h, xy):
    """A spring (here to a fixed place: the same equations) in a shear of Pe rates of relaxation. Each step is that of
    the recursion of which the moments are known exactly, by random numbers that a run without spring and shear shows.
    <yy> = 1, <xy> = Pe/2, <xx> = 1 + Pe^2/2 in the limit of short steps; a displacement that is added at the end of the
    step has <xy> 10, 5, 2.5 % low."""
    exact = moments(Pe, h)
    assert exact[1] / (0.5 * Pe) - 1 == pytest.approx(xy, abs=1e-5)
    assert exact[0] / (1 + 0.5 * Pe**2) - 1 == pytest.approx(0, abs=2.4e-2 * (h / 0.2)**1.8)
    Pe = min(Pe, 0.4 / h)    # fix deform cannot follow more than half an edge in a step
    d = np.diff(path(simulation, tmp_path, h, 0.0, 40)[0], axis=0)
    x, v = path(simulation, tmp_path, h, Pe / UNIT, 40, trap=1.0)
    assert np.abs(x).max() > 0.5
    for k in range(40):
        force = -(1.5 * x[k] - 0.5 * x[k - 1]) if k else -x[k]
        step = h * UNIT * v[k]
        assert np.abs(step - h * force - d[k]).max() < OF_WAVES * np.abs(d).max()
        assert np.abs(x[k + 1] - shear(Pe, h) @ x[k] - shear(Pe, 0.5 * h) @ step).max() < 1e-9 * np.abs(x).max()


@pytest.mark.parametrize("h, xy", [(0.2, -2.63e-2), (0.1, -5.6e-3), (0.05, -1.3e-3)])
def test_ab2_in_shear_has_the_moments_of_the_page(simulation, tmp_path, h, xy):
    """The same of x <- x + dt (3/2 v - 1/2 v_old) + noise, whose shear by half a step comes with v_old"""
    Pe, K = 1.0, np.array([(-1.0, 1.0), (0.0, -1.0)])
    T, B = np.zeros((4, 4)), np.zeros((4, 2))
    T[:2, :2], T[:2, 2:], T[2:, :2] = np.eye(2) + 1.5 * h * K, -0.5 * h * K, np.eye(2)
    B[:2] = np.sqrt(2 * h) * np.eye(2)
    C = np.linalg.solve(np.eye(16) - np.kron(T, T), (B @ B.T).ravel()).reshape(4, 4)
    assert C[0, 1] / 0.5 - 1 == pytest.approx(xy, abs=1e-4)
    d = np.diff(path(simulation, tmp_path, h, 0.0, 40, scheme="ab2")[0], axis=0)
    x, _ = path(simulation, tmp_path, h, Pe / UNIT, 40, trap=1.0, scheme="ab2")
    mine, old = [np.zeros(3)], None
    for step in d:
        v = np.append(K @ mine[-1][:2], -mine[-1][2])
        mine.append(mine[-1] + h * (v if old is None else 1.5 * v - 0.5 * old) + step)
        old = v
    assert np.abs(x - mine).max() < 2e-2 * np.abs(x).max()    # the noise of waves is that of the present box


# --- spheres and clumps that feel each other, also through faces ------------------------------------------------------

SIDE = 7.5
SHELLS = "multiblob 12 lubrication yes relative_tolerance 1e-10 max_iter 400"
CLUMPS = "rigid_clumps yes multiblob 12 relative_tolerance 1e-10 max_iter 400"
POINTS = ""
# a kT whose noise is rounding: that of waves depends on the edges that are taken for the lattice, and where its corner
# is
FAINT = 1e-20


def scene(style):
    """Ten spheres with films through the faces, or two clumps of four and two spheres"""
    if "rigid" not in style:
        return close_spheres(10, SIDE)
    spheres = in_few_clumps()
    return Spheres(spheres.x - (16.0, 3.0, 3.0), A, molecule=spheres.molecule)


def moved(simulation, style, shift=0.0, steps=25, rate=1.0, dt=0.02, kT=FAINT, **more):
    """Places less those of the start, up to images, and the edges of the box"""
    spheres = scene(style)
    side = SIDE if "rigid" not in style else 12.0
    spheres = Spheres((spheres.x + shift) % side, spheres.a, molecule=spheres.molecule)
    sim = sheared(simulation, spheres, f"far_field_tolerance 1e-6 {style}", side, rate, dt,
                  "scheme midpoint noise_tolerance 1e-6", kT=kT, **more)
    sim.commands("variable fy atom 9*(id%3-1)\nvariable fz atom 7*(id%2)-3\nfix pull all addforce 3.0 v_fy v_fz").run(
        steps)
    return sim.x, edges(sim)[0]


@pytest.mark.parametrize("style", [POINTS, SHELLS, CLUMPS], ids=["points", "shells", "clumps"])
def test_where_the_faces_are_does_not_matter(simulation, style):
    """The same suspension, shifted through the faces: relative places are the same though other pairs now see each
    other through faces that move. With images that stand where the box was at the start of the step they are off by
    rate dt side/2, a tenth of a radius."""
    first, H = moved(simulation, style)
    other, _ = moved(simulation, style, shift=np.array([1.3, 3.1, 2.2]))
    d = other - first
    assert np.abs(up_to_images(d - d[0], H)).max() < 1e-6


@pytest.mark.parametrize("style", [POINTS, SHELLS, CLUMPS], ids=["points", "shells", "clumps"])
def test_flips_of_the_box_change_nothing(simulation, style):
    first, H = moved(simulation, style, steps=40, rate=1.2)
    other, _ = moved(simulation, style, steps=40, rate=1.2, deform="flip no")
    assert H[0, 1] < 0
    assert np.abs(up_to_images(other - first, H)).max() < 1e-6


def test_noise_that_knows_no_waves_does_not_know_the_faces(simulation):
    """Spheres that overlap so that the near part is not positive, and the noise is that of the whole matrix: by the
    same random numbers of the points, wherever the faces are and whichever edges are taken for the lattice (the box
    flips in the third step)."""
    side, x, dt, kT = (5.0, np.array([(2.0, 2.0, 2.0), (2.0, 2.0, 2.0)]) +
                       np.outer((0, 1.155), (0.5**0.5, 0, 0.5**0.5)), 0.02, 1e-5)

    def ends(shift, flip="flip yes", rate=1.0):
        sim = sheared(simulation, Spheres((x + shift) % side),
                      "far_field_tolerance 1e-8 multiblob 12 relative_tolerance 1e-10 max_iter 400", side, rate, dt,
                      "noise_tolerance 1e-8", kT=kT, deform=flip, tilt=2.4)
        sim.run(5)
        return sim.x, edges(sim)[0]

    (first, H), (shifted, _), (tall, _) = ends(0.0), ends(np.array([1.3, 2.1, 2.6])), ends(0.0, "flip no")
    still = x @ shear(1.0, 5 * dt).T
    relative = lambda x: up_to_images(x - x[0], H)[1]
    assert H[0, 1] < 0 and np.linalg.norm(relative(first) - relative(still)) > 1e-4    # which noise makes
    assert (np.abs(relative(shifted) - relative(first)).max() < 1e-8 and
            np.abs(relative(tall) - relative(first)).max() < 1e-8)


@pytest.mark.parametrize("style", [POINTS, SHELLS, CLUMPS], ids=["points", "shells", "clumps"])
def test_without_noise_midpoint_is_of_second_order_in_shear(simulation, style):
    ends = []
    for n in (40, 80, 160):
        x, H = moved(simulation, style, steps=n, dt=1.6 / n, kT=0.0)
        ends.append(x)
    coarse, fine = (np.abs(up_to_images(ends[k + 1] - ends[k], H)).max() for k in (0, 1))
    assert 1e-6 < fine < 5e-3
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.25)


@pytest.mark.parametrize("style", [SHELLS, CLUMPS], ids=["shells", "clumps"])
def test_a_box_that_stretches_has_images_at_the_middle_too(simulation, style):
    """Extension, whose edges do not grow evenly, with a shear: as above"""
    stretch = "x trate 0.5 y trate -0.3 xz erate 0.6"
    first, H = moved(simulation, style, deform=stretch)
    other, _ = moved(simulation, style, deform=stretch, shift=np.array([1.3, 3.1, 2.2]))
    d = other - first
    share = np.linalg.solve(H, d.T).T    # the flow pulls apart what is shifted: fractions of the edges are the same
    assert np.abs(up_to_images(d - d[0], H)).max() < 1e-6 and np.ptp(share - np.round(share - share[0]),
                                                                     axis=0).max() < 1e-6


def test_noise_fades_as_the_peclet_number_grows(simulation):
    """Paths in units of the shear, of kT = 1/Pe: they leave the one without noise by Pe^-1/2, until that is rounding"""
    still, H = moved(simulation, SHELLS, steps=20)
    far = [np.abs(up_to_images(moved(simulation, SHELLS, steps=20, kT=kT)[0] - still, H)).max()
           for kT in (1e-4, 1e-6, 1e-8)]
    assert far[0] / far[1] == pytest.approx(10, rel=0.1) and far[1] / far[2] == pytest.approx(10, rel=0.01)


@pytest.mark.parametrize("style", [POINTS, SHELLS, CLUMPS], ids=["points", "shells", "clumps"])
def test_where_noise_has_faded_the_path_is_that_without(simulation, style):
    """The half step knows of other spheres what films know: where there is noise, what is not random has an error of
    the first order."""
    off = []
    for n in (10, 20, 40):
        (one, H), (other, _) = (moved(simulation, style, steps=n, dt=0.8 / n, kT=kT) for kT in (FAINT, 0.0))
        off.append(np.abs(up_to_images(one - other, H)).max())
    assert off[1] < 0.02 and off[1] < 0.6 * off[0] and off[2] < 0.6 * off[1]


# --- one run, in whatever pieces and on however many ranks ------------------------------------------------------------

def unlike_spheres():
    """Four small ones around a large one that stands in a face, with films"""
    to = np.array([(0.0, 0.0, 0.0), (2.55, 0.8, 0.2), (-2.0, -1.55, 1.1), (0.2, -0.5, -2.7), (1.6, 1.6, -1.6)])
    return Spheres(((9.0, 17.5, 9.0) + 0.71 * to) % 18.0, [1.2, 0.6, 0.6, 0.6, 0.6])


DEFORM = "\nchange_box all triclinic\nfix d all deform 1 xy erate 1.7 remap v"
WAYS = {"shells with films": ("p p p", close_spheres, f"{SHARP} multiblob 12 lubrication yes fluid_velocity box",
                              TIGHT + DEFORM),
        "clumps of shells": ("p p p", in_few_clumps,
                             f"{SHARP} rigid_clumps yes multiblob 12 lubrication yes fluid_velocity box",
                             TIGHT + DEFORM),
        "points": ("p p p", close_spheres, f"{SHARP} fluid_velocity box", " scheme midpoint" + TIGHT + DEFORM),
        "unlike shells": ("p p p", unlike_spheres, f"{SHARP} multiblob 12 lubrication yes fluid_velocity box",
                          TIGHT + DEFORM),
        "points ab2": ("p p p", close_spheres, f"{SHARP} fluid_velocity box", DEFORM)}


@pytest.mark.parametrize("way", by_open_mpi(WAYS.values()), ids=WAYS)
def test_ranks_and_newton_do_not_matter(tmp_path, way):
    check_ranks(tmp_path, way, END=BEYOND)


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
def test_a_run_in_pieces_is_the_run_in_one(tmp_path, way):
    check_pieces(tmp_path, way, END=BEYOND)


@pytest.mark.parametrize("fluid, deform, scheme, message", [
    ("0 0 0", "deform 1 xy erate 0.1", "midpoint",
     "keyword scheme: midpoint needs a fluid that goes with the box, which fix d of style deform deforms"),
    ("box", "deform 5 xy erate 0.1", "midpoint",
     "keyword scheme: midpoint needs a box that moves in every step, and fix d of style deform moves it every 5"),
    ("box", "deform 1 xy erate 30", "midpoint", "the box strains by 0.6 of an edge in a step"),
    ("box", "deform 1 xy erate 30", "ab2", "the box strains by 0.6 of an edge in a step")])
@pytest.mark.parametrize("kT", [KT, 0.0])
def test_what_a_box_must_do_is_said(simulation, fluid, deform, scheme, message, kT):
    """Twice as high as it is wide: fix deform takes a tilt that is nearest to the last one, and half a width of it is a
    quarter of the height."""
    sim = simulation(close_spheres(), f"cut_off_distance inf visc {ETA} fluid_velocity {fluid}", fix=False, dt=0.01,
                     boundary="p p p", box=[(0.0, 18.0), (0.0, 36.0), (0.0, 18.0)], tilt=(0.0, 0.0, 0.0), comm=COMM)
    sim.commands(f"fix d all {deform} remap v")
    with pytest.raises(LammpsError, match=message):
        noise(sim, f"scheme {scheme}", kT).run(2)


# --- in a plane, and radii that change --------------------------------------------------------------------------------

PLANE_X = np.array([(0, 0, 0), (2.3, 0.4, 0), (0.9, 2.6, 0), (3.4, 2.9, 0), (-2.1, 1.2, 0)]) * A


def in_sheared_plane(simulation, folder, words, fluid="formula", kT=KT, dt=0.02, shift=0.0, steps=20):
    """u_x = 1.7 (y - shift). fluid "box": of one that is periodic and sheared, else by a formula in an open one"""
    box = fluid == "box"
    where = dict(boundary="p p p" if box else "f f p", box=[(-30.0, 30.0)] * 2 + [(-0.5, 0.5)],
                 tilt=(0.0, 0.0, 0.0) if box else None)
    flow = "box" if box else "v_ux v_zero v_zero" + (" fluid_vorticity 0 0 -1.7" if "inf" in words else "")
    lines = input_lines(Spheres(PLANE_X + (0, shift, 0), A), f"visc {ETA} {words} fluid_velocity {flow}",
                        str(folder / "data"), fix=False, dt=dt, comm=COMM if box else "",
                        before_pair=f"variable ux atom 1.7*(y-({shift!r}))\nvariable zero atom 0", **where)
    sim = simulation().commands(["dimension 2"] + lines)
    if box:
        sim.commands("fix d all deform 1 xy erate 1.7 remap v")
    sim.commands("variable fx atom 3*cos(id)\nvariable fy atom 3*sin(2*id)\nfix pull all addforce v_fx v_fy 0")
    noise(sim, kT=kT).run(steps)
    assert (sim.x[:, 2] == 0).all() and ("inf" not in words or (sim.atom("omega")[:, :2] == 0).all())
    return sim.x - (0, shift, 0), edges(sim)[0] if box else None


def test_lone_spheres_in_a_plane_that_is_sheared_go_as_in_that_flow(simulation, tmp_path):
    """Whether the box or a formula gives the flow, noise and all"""
    (x, H), (other, _), (still, _) = (in_sheared_plane(simulation, tmp_path, "clumps_only yes", fluid, kT)
                                      for fluid, kT in (("box", KT), ("formula", KT), ("box", 0.0)))
    d = x - other    # the box flows with a stream beside that of the formula
    assert np.abs(up_to_images(d - d[0], H)).max() < 1e-9
    assert np.abs(up_to_images(x - still, H)).max() > 0.1


@pytest.mark.parametrize("words", ["rotation yes lubrication yes", "multiblob 12 lubrication yes"])
def test_spheres_in_a_plane_that_flows_stay_in_it(simulation, tmp_path, words):
    """Where the flow rests does not matter, and where noise has faded, with its differences for the plane, the path is
    that without"""
    words = f"cut_off_distance inf relative_tolerance 1e-10 max_iter 400 {words}"
    make = lambda **how: in_sheared_plane(simulation, tmp_path, words, **how)[0]
    x = make()
    assert np.abs(make(shift=2.5) - x).max() < 1e-6 and np.abs(make(kT=0.0) - x).max() > 0.1
    off = [np.abs(make(kT=FAINT, dt=0.4 / n, steps=n) - make(kT=0.0, dt=0.4 / n, steps=n)).max() for n in (20, 40)]
    assert off[0] < 0.02 and off[1] < 0.6 * off[0]


def test_radii_that_change_in_shear_are_those_of_each_step(simulation, tmp_path):
    """By fix adapt in one run, or set by hand between runs of one step"""
    shrinks = ["group some id 1 3 4 8"]

    def make():
        lines = input_lines(close_spheres(10, SIDE), f"cut_off_distance inf visc {ETA} far_field_tolerance 1e-6 "
                                                     f"{SHELLS} multiblob_most 12 fluid_velocity box",
                            str(tmp_path / "data"), fix=False, dt=0.01, boundary="p p p", box=[(0.0, SIDE)] * 3,
                            tilt=(0.0, 0.0, 0.0), comm=COMM)
        lines[1] = "atom_style hybrid sphere 1 bond"
        return noise(simulation().commands(lines + ["fix d all deform 1 xy erate 1.0 remap v"]), "noise_tolerance 1e-8")

    plain = make().run(6).x
    sim = make().commands(shrinks + [f"variable d equal {2 * A!r}*(1-0.02*step)",
                                     "fix shrink some adapt 1 atom diameter v_d"]).run(6)
    whole, H = sim.x, edges(sim)[0]
    sim = make().commands(shrinks)
    for k in range(6):
        sim.commands(f"set group some diameter {2 * A * (1 - 0.02 * k)!r}").run(1)
    assert np.abs(up_to_images(whole - sim.x, H)).max() < 1e-9 < 1e-2 < np.abs(up_to_images(whole - plain, H)).max()
