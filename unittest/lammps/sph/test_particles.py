"""examples/ship/particles.py and examples/surfaces.py: who is inside, walls as thick as the reach, what is refused,
what LAMMPS reads."""
import pathlib

import numpy as np
import pytest

EXAMPLES = pathlib.Path(__file__).resolve().parents[3] / "examples"


@pytest.fixture
def surfaces(monkeypatch):
    monkeypatch.syspath_prepend(str(EXAMPLES))
    import surfaces
    return surfaces


@pytest.fixture
def particles(monkeypatch, surfaces):
    monkeypatch.syspath_prepend(str(EXAMPLES / "ship"))
    import particles
    return particles


def scene(particles, *words):
    return particles.main(["--spacing", "0.05", "--tank", "1", "0.8", "0.7", "--level", "0.5", *map(str, words)])


AT = ("at", 0.51, 0.42, 0.33)


def test_a_node_is_inside_by_rays_where_its_solid_angle_says_so(surfaces):
    ball = surfaces.sphere_mesh(6)
    solid = np.concatenate([ball * [0.9, 0.7, 0.8], 0.4 * ball[:, ::-1] + [0.1, 0, 0.05]])      # with a cavity
    axes = [np.linspace(-1, 1, n) for n in (14, 15, 16)]
    nodes = np.stack(np.meshgrid(*axes, indexing="ij"), axis=3).reshape(-1, 3)
    number = surfaces.winding_number(solid, nodes)
    found = surfaces.inside(solid, *axes).ravel()
    assert np.abs(number - found).max() < 1e-9 and 200 < found.sum() < len(found) / 2


def test_nodes_below_edges_and_corners_are_counted_once(surfaces):
    axis = np.arange(-6, 7) * 0.1                # nodes lie right below edges of this cube, 0.9 wide
    found = surfaces.inside(surfaces.cube(0.9, 9) + [0, 0, 0.001], axis, axis, axis)
    assert found.sum() == 9**3


def test_units_scale_turn_and_place(particles, surfaces, tmp_path):
    surfaces.write_stl(tmp_path / "rod.stl", 1000 * surfaces.rod(0.4, 0.1))
    one, two, three = (particles.Part([str(tmp_path / "rod.stl"), "scale", scale, "turn", "y", "90", "at", "1", "2",
                                       "3"])
                       for scale in ("mm", "0.001", "cm"))
    assert np.array_equal(one.triangles, two.triangles) and np.allclose(three.triangles - [1, 2, 3],
                                                                        10 * (one.triangles - [1, 2, 3]))
    assert np.allclose(np.sum(one.box(), axis=0) / 2, [1, 2, 3]) and np.allclose(np.subtract(*one.box()[::-1]),
                                                                                 [0.6, 0.2, 0.2], rtol=1e-5)


def test_every_place_that_water_feels_beyond_its_walls_has_a_particle(particles):
    for words in ((), ("--h", 2)):
        found = scene(particles, "--body", "ellipsoid", 0.3, 0.2, 0.2, *AT, *words)
        air = (found.axes[2] > 0.5)[None, None, :]
        assert not (particles.around(found.type == 1, 2 * found.h) & (found.type == 0) & ~air).any()
        assert found.layers == 2 * found.h
    vessel = particles.main(["--spacing", "0.05", "--vessel", "ellipsoid", "0.6", "0.4", "0.5", "--level", "0"])
    air = (vessel.axes[2] > 0)[None, None, :]
    assert not (particles.around(vessel.type == 1, 2 * vessel.h) & (vessel.type == 0) & ~air).any()


def test_mass_and_inertia_are_of_the_solid_and_its_own_density(particles, tmp_path):
    scene(particles, "--body", "ellipsoid", 0.3, 0.2, 0.15, *AT, "density", 400, "--out", tmp_path / "a")
    row = [float(word) for word in (tmp_path / "a.3.body").read_text().split()[1:]]
    mass = 400 * 4 / 3 * np.pi * 0.3 * 0.2 * 0.15
    assert row[0] == 1 and np.allclose(row[2:5], AT[1:], rtol=1e-6) and len(row) == 20
    assert np.allclose([row[1], *row[5:8]], [mass, *(mass / 5 * np.array([0.0625, 0.1125, 0.13]))],
                       rtol=0.02) and np.allclose(row[8:11], 0)


def test_fit_brings_the_volume_of_particles_to_that_of_the_body(particles, capsys):
    place = ("at", 0.5, 0.4, 0.3)
    plain = scene(particles, "--body", "disc", 0.2, 0.26, *place)
    fitted = scene(particles, "--body", "disc", 0.2, 0.26, *place, "--fit")
    volume = [abs(s.solids[0].sum() * 0.05**3 / particles.volume_and_centre(s.parts[0].triangles)[0] - 1)
              for s in (plain, fitted)]
    assert volume[1] < volume[0] and np.abs(fitted.parts[0].box()[0] - plain.parts[0].box()[0]).max() < 0.0126
    assert "moved by" in capsys.readouterr().out


@pytest.mark.parametrize("words, message", [
    ("--body ball.stl scale 1e-3 at 0.5 0.4 0.3", "ball.stl: no particle lies in it.*scale right"),
    ("--body open.stl at 0.5 0.4 0.3", "open.stl: the surface is not closed: 4 edges belong to one triangle only"),
    ("--body turned.stl at 0.5 0.4 0.3", "turned.stl: parts of the surface lie in each other"),
    ("--body none.stl", "none.stl: No such file"),
    ("--body text.stl", "text.stl: there is no triangle"),
    ("--body cube 0.2 at 0.5 0.4 0.05", "cube.*stand in another part or in the wall"),
    ("--body cube 0.2 at 0.5 0.4 0.3 --body ball.stl at 0.5 0.4 0.3", "ball.stl: .* stand in another part"),
    ("--body cube 0.2 sclae 2", "sclae: known are scale S"), ("--body cube 0.2 scale km", "scale km: not a number"),
    ("--body cube 0.2 scale 0", "scale 0: must be > 0"), ("--body cube 0.2 turn w 3", "turn w: the axis"),
    ("--body cube 0.2 density -1", "density -1: must be > 0"), ("--level -1", "level -1: there is no room"),
    ("--h 0.5", "--h 0.5: must"), ("--spacing 0", "--spacing 0: must be > 0"),
    ("--body cube 1e4 at 0 0 0", "too many. Are spacing and scale in the same unit")])
def test_what_cannot_be_is_refused_and_named(particles, surfaces, tmp_path, monkeypatch, words, message):
    ball = surfaces.sphere_mesh(5) * 0.2
    surfaces.write_stl(tmp_path / "ball.stl", ball)
    surfaces.write_stl(tmp_path / "open.stl", ball[2:])
    surfaces.write_stl(tmp_path / "turned.stl", np.concatenate([ball, ball * 0.5]))
    (tmp_path / "text.stl").write_text("solid nothing\nendsolid\n")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(surfaces.Error, match=message):
        scene(particles, *words.split())


def test_other_files_need_trimesh(surfaces, tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "trimesh", None)
    with pytest.raises(surfaces.Error, match="a.obj: .*trimesh, which is not installed"):
        surfaces.read(tmp_path / "a.obj")


def test_thin_plates_are_warned_of_and_sealed_rooms_stay_dry(particles, surfaces, tmp_path, capsys):
    scene(particles, "--wall", "disc", 0.3, 0.06, "at", 0.5, 0.4, 0.33)
    assert "WARNING: disc 0.3 0.06 at 0.5 0.4 0.33: too thin" in capsys.readouterr().out
    scene(particles, "--wall", "cube", 0.4, "at", 0.5, 0.4, 0.25)
    assert "too thin" not in capsys.readouterr().out
    ball = surfaces.sphere_mesh(8) * 0.3
    surfaces.write_stl(tmp_path / "hollow.stl", np.concatenate([ball, ball[:, ::-1] * 0.4]))
    found = scene(particles, "--body", tmp_path / "hollow.stl", *AT)
    assert "closed in and stay empty" in capsys.readouterr().out
    assert found.type[tuple(np.searchsorted(a, x) for a, x in zip(found.axes, AT[1:]))] == 0


def test_lammps_reads_what_is_written(particles, tmp_path):
    import sph_tools

    found = scene(particles, "--body", "ellipsoid", 0.3, 0.2, 0.15, *AT, "--wall", "cube", 0.1, "at", 0.9, 0.7, 0.05,
                  "--out", tmp_path / "a")
    lmp = sph_tools.start()
    sph_tools.run(lmp, f"units si\natom_style sph\nboundary f f f\nread_data {tmp_path}/a.data")
    x, kind = found.particles()
    assert np.array_equal(sph_tools.by_id(lmp, "type"), kind) and set(kind) == {1, 2, 3}
    assert np.allclose(sph_tools.by_id(lmp, "x", 3), x, atol=1e-9)
    lmp.close()
