"""What has no answer above a floor and between two walls in a box that is periodic along them is named."""
import pytest

from system import LammpsError, Spheres
from test_slab import FLOOR, MOVE, cell
from test_wall import pull


def bad(words, message, boundary="p p f", **options):
    return pytest.param(words, boundary, message, options, id=f"{words} {boundary}")


@pytest.mark.parametrize("words, boundary, message, options", [
    bad("wall zlo 0", "keyword wall: it needs boundary f, s or m across it, and z is periodic: "
                      "use boundary p p f, or f f f", "p p p"),
    bad("wall zlo 0", "keyword wall: the box is periodic in one of the two directions along it: use boundary p p f",
        "p f f"),
    bad("wall xlo 0 xhi 9", "x is periodic: use boundary f p p, or f f f"),
    bad("wall zlo 0 zhi 9", "between two walls the box must be periodic along them: use boundary p p f, or leave out",
        "f f f"),
    bad("wall zlo 9 zhi 0", "keyword wall: zlo at 9 must be below zhi at 0"),
    bad("wall zlo 0 xhi 9",
        "keyword wall: 'zlo' and 'xhi' are not opposite sides: give one side, or two opposite ones"),
    bad("wall zlo 0 zlo 9", "'zlo' and 'zlo' are not opposite sides"),
    bad("wall zlo 0 zhi 9 xlo 3",
        "keyword wall: a corner of walls is not possible: give one side, or two opposite ones"),
    bad("wall zlo 0 wall zhi 9",
        "keyword wall: two walls are given by two sides after one keyword, such as wall zlo 0 zhi 10"),
    bad("wall zlo 0 zhi", "keyword wall"),
    bad("wall zlo 0 flow flux", "keyword flow requires two walls"),
    bad("flow flux", "keyword flow requires two walls"),
    bad("wall zlo 0 zhi 9 flow up", "keyword flow: 'up'"),
    bad("", "boundary: in a box without walls .* drags that follow from velocities have a net force along it"),
    bad("wall zlo 0 rotation yes",
        "keyword rotation: yes: above a floor, periodic along it, torques of one-point spheres are not summed: use "
        "multiblob 12"),
    bad("wall zlo 0 zhi 9 rotation yes lubrication yes", "in a slit, .* use multiblob 12"),
    bad("wall zlo 0 far_field direct", "far_field direct and precondition sparse require a box that is not periodic"),
    bad("wall zlo 0 precondition waves algorithm 2", "precondition waves is for periodic boxes"),
    bad("wall zlo 2.5", "step 0: keyword wall: the centre of atom 1, radius 1, is 0.5 behind the wall zlo at 2.5"),
    bad("wall zlo 0 zhi 3", "step 0: keyword wall: the centre of atom 2, radius 1, is 1 behind the wall zhi at 3"),
    bad("wall zlo 1.5 zhi 3.4",
        "the largest sphere, radius 1, does not fit between zlo at 1.5 and zhi at 3.4: .* at least 2 apart"),
    bad("wall zlo 0 fluid_velocity 0 0 0.1", "nothing flows through the wall zlo at 0"),
    bad("wall zlo 0", "must not be tilted", tilt=(1.0, 0, 0)),
    bad("wall zlo EDGE", "EDGE: that side of the box follows the spheres", "p p s"),
])
def test_what_does_not_go_with_a_slab_is_named(simulation, words, boundary, message, options):
    with pytest.raises(LammpsError, match=message):
        simulation(Spheres([(1, 1, 2), (1, 4, 4)]), f"cut_off_distance inf visc 1 {words}", box=cell(12),
                   boundary=boundary, **options).run()


def test_a_cut_off_has_no_walls_in_a_periodic_box(simulation):
    with pytest.raises(LammpsError, match="it requires cut_off_distance inf and clumps_only no"):
        simulation(Spheres([(1, 1, 2)]), "cut_off_distance 3 visc 1 wall zlo 0", box=cell(12), boundary="p p f").run()


def test_radii_that_differ_too_much_are_an_error(simulation):
    with pytest.raises(LammpsError,
                       match="the largest radius must be at most 10 times the smallest, and they are 1 and 0.09"):
        simulation(Spheres([(1, 1, 2), (1, 4, 4)], [1, 0.09]), f"cut_off_distance inf visc 1 {FLOOR}", box=cell(12),
                   boundary="p p f").run()


@pytest.mark.parametrize("lines, message", [
    (["fix pull all addforce 1 0 0", MOVE], "the forces along x add up to 2: in a box without walls"),
    ([f"{MOVE} held all"], "keyword held: in a box without walls"),
    ([f"{MOVE} temperature 1 7"], "keyword temperature: in a box without walls .* no bound")])
def test_what_a_layer_cannot_bear_is_named(simulation, lines, message):
    sim = simulation(Spheres([(1, 1, 2), (1, 4, 4)]), "cut_off_distance inf visc 1", box=cell(12), boundary="p p f",
                     fix=False, dt=0.1)
    with pytest.raises(LammpsError, match=message):
        sim.commands(lines).run()


def test_a_layer_has_no_shells(simulation):
    sim = simulation(Spheres([(1, 1, 2)]), "cut_off_distance inf visc 1 multiblob 12", box=cell(12), boundary="p p f",
                     fix=False, dt=0.1)
    with pytest.raises(LammpsError, match="multiblobs and rigid clumps are not available: give the pair style a wall"):
        sim.commands([MOVE]).run()


def test_a_box_that_changes_is_an_error(simulation):
    sim = simulation(Spheres([(1, 1, 2)]), f"cut_off_distance inf visc 1 {FLOOR}", box=cell(12), boundary="p p f",
                     fix=False, dt=0.1)
    with pytest.raises(LammpsError, match="fix grow of style deform changes the box, and above a floor"):
        sim.commands(["fix grow all deform 1 x scale 1.1", MOVE]).run()
