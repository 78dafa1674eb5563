"""Hard cases of Ewald sums: they end with the right answer or with an error that says why, in little time."""
import numpy as np
import pytest

from system import LammpsError, Spheres, input_lines, largest_difference, lmp

ALL = "cut_off_distance inf algorithm 2 max_iter 1000 visc 1.3"
STOKES = 6 * np.pi * 1.3
PERIODIC = dict(boundary="p p p", box=[(0.0, 9.0)] * 3)


@pytest.mark.hard_case("far field: one sphere in an open box has Stokes' drag")
@pytest.mark.parametrize("far_field", ["auto", "ewald"])
def test_one_sphere_in_an_open_box(simulation, far_field):
    sim = simulation(Spheres([(1, 2, 3)], 0.7, (0.1, 0.2, 0.3)), f"{ALL} far_field {far_field}").run()
    assert np.abs(sim.drag[0] + STOKES * 0.7 * np.array([0.1, 0.2, 0.3])).max() < 1e-13


@pytest.mark.hard_case("far field: one sphere in a periodic box is a lattice")
def test_one_sphere_in_a_periodic_box(simulation):
    """Hasimoto: 1/K = 1 - 1.7601 phi^(1/3) + phi for spheres that do not overlap, at this level exactly."""
    a, L = 0.7, 9.0
    phi = 4 / 3 * np.pi * a**3 / L**3
    sim = simulation(Spheres([(1, 2, 3)], a, (0.1, 0.2, 0.3)),
                     f"{ALL} relative_tolerance 1e-10 far_field_tolerance 1e-10", **PERIODIC).run()
    K = 1 / (1 - 2.837297479480620 * a / L + phi)
    assert np.abs(sim.drag[0] / (STOKES * a * np.array([0.1, 0.2, 0.3])) + K).max() < 1e-9 * K


@pytest.mark.hard_case("far field: two equal spheres at one point")
@pytest.mark.parametrize("where", [PERIODIC, {}], ids=["periodic", "open"])
def test_two_spheres_at_one_point(simulation, where):
    """One velocity: they share what one has. Two: there is no answer."""
    tight = f"{ALL} far_field ewald relative_tolerance 1e-9 far_field_tolerance 1e-11"
    one = simulation(Spheres([(1, 2, 3), (4, 4, 4)], 0.7, (0.1, 0.2, 0.3)), tight, **where).run().drag
    two = simulation(Spheres([(1, 2, 3), (1, 2, 3), (4, 4, 4)], 0.7, (0.1, 0.2, 0.3)), tight, **where).run().drag
    assert np.abs(two[:2].sum(axis=0) - one[0]).max() < 1e-7 and np.abs(two[2] - one[1]).max() < 1e-7


@pytest.mark.hard_case("far field: a sphere larger than the box, radii 1 : 4")
def test_a_sphere_larger_than_the_box(simulation):
    """The same lattice with a box of two cells, twice as many spheres."""
    a, L = 4.0, 5.0
    words = f"{ALL} relative_tolerance 1e-7 far_field_tolerance 1e-8"
    cell = Spheres([(1, 2, 3), (3.5, 3.5, 1)], [a, 1.0], [(0.1, 0.2, 0.3), (0.3, 0, 0)])
    pair = Spheres(np.vstack([cell.x, cell.x + (L, 0, 0)]), [a, 1.0, a, 1.0], np.tile(cell.v, (2, 1)))
    one = simulation(cell, words, boundary="p p p", box=[(0.0, L)] * 3).run().drag
    two = simulation(pair, words, boundary="p p p", box=[(0.0, 2 * L), (0.0, L), (0.0, L)]).run().drag
    assert np.abs(two - np.tile(one, (2, 1))).max() < 1e-4 * np.abs(one).max()


@pytest.mark.hard_case("far field: a sphere ten to a thousand times larger than the box")
@pytest.mark.parametrize("a", [90, 9000])
def test_a_sphere_out_of_all_proportion(simulation, a):
    with pytest.raises(LammpsError,
                       match=f"far_field: the largest sphere, radius {a}, is so large for the periodic box"):
        simulation(Spheres([(1, 2, 3)], a, (0.1, 0.2, 0.3)), ALL, **PERIODIC).run()


@pytest.mark.hard_case("far field: nobody in the group")
@pytest.mark.parametrize("where", [PERIODIC, {}], ids=["periodic", "open"])
@pytest.mark.parametrize("ranks", [1, 2])
def test_an_empty_group(tmp_path, where, ranks):
    spheres = Spheres([(1, 2, 3), (4, 4, 4)], 0.7, (0.1, 0.2, 0.3))
    lines = input_lines(spheres, f"{ALL} far_field ewald group nobody", tmp_path / "data",
                        before_pair="group nobody empty", **where)
    lmp(tmp_path, lines + ["run 2"], ranks=ranks)


@pytest.mark.hard_case("far field: all spheres in a corner of a large open box, on one of two ranks")
def test_a_cloud_in_one_corner(tmp_path):
    rng = np.random.default_rng(2)
    spheres = Spheres(rng.uniform(0, 10, (60, 3)), 0.7, (0, 0, 0.4))
    forces = []
    for ranks, box in ((1, None), (2, [(-1.0, 900.0)] * 3)):
        lines = input_lines(spheres, f"{ALL} far_field ewald relative_tolerance 1e-4 far_field_tolerance 1e-9",
                            tmp_path / "data", box=box)
        lmp(tmp_path, lines + [f"dump out all custom 1 {tmp_path}/dump id f_drag[1] f_drag[2] f_drag[3]",
                               "dump_modify out sort id format float %.15g",
                               "run 0"], ranks=ranks)
        forces.append(np.loadtxt(tmp_path / "dump", skiprows=9)[:, 1:])
    assert largest_difference(forces[1], forces[0]) < 1e-7


@pytest.mark.hard_case("far field: bricks of unequal size, tiled communication, newton off, a wide skin")
@pytest.mark.parametrize("where", [PERIODIC, {}], ids=["periodic", "open"])
@pytest.mark.ranks(3)
def test_any_decomposition(tmp_path, where):
    rng = np.random.default_rng(2)
    spheres = Spheres(9 * rng.uniform(0, 1, (80, 3))**2, 0.7, rng.normal(size=(80, 3)))
    forces = []
    for ranks, comm, newton in ((1, "", "on"), (3, "comm_style tiled\nbalance 1.0 rcb\nneighbor 1.5 bin", "off")):
        lines = input_lines(spheres, f"{ALL} far_field ewald relative_tolerance 1e-11 far_field_tolerance 1e-9",
                            tmp_path / "data", newton=newton, **where)
        lines = [line for line in lines if not line.startswith("comm_modify mode")] + comm.splitlines()
        lmp(tmp_path, lines + [f"dump out all custom 1 {tmp_path}/dump id f_drag[1] f_drag[2] f_drag[3]",
                               "dump_modify out sort id format float %.15g", "run 0"], ranks=ranks)
        forces.append(np.loadtxt(tmp_path / "dump", skiprows=9)[:, 1:])
    assert largest_difference(forces[1], forces[0]) < 1e-9


@pytest.mark.hard_case("far field: algorithm 1 in a periodic box, where it diverges")
def test_substitution_in_a_periodic_box(simulation):
    spheres = Spheres(3.0 * np.stack(np.meshgrid(*3 * [np.arange(4.0)], indexing="ij"), axis=-1).reshape(-1, 3), 1.0,
                      (0.1, 0.2, 0.3))
    words = "cut_off_distance inf visc 1.3 relative_tolerance 1e-6"
    where = dict(boundary="p p p", box=[(0.0, 12.0)] * 3)
    reference = simulation(spheres, words + " algorithm 2", **where).run().drag
    assert largest_difference(simulation(spheres, words, **where).run().drag, reference) < 1e-5


@pytest.mark.hard_case("far field: an open cloud with one sphere very far away")
def test_a_sphere_far_away(simulation):
    """auto counts the grid, and sums pairs; whoever insists is told."""
    rng = np.random.default_rng(2)
    x = np.vstack([rng.uniform(0, 60, (2500, 3)), [(1e6, 0, 0)]])
    auto = simulation(Spheres(x, 0.7, (0, 0, 0.4)), f"{ALL} relative_tolerance 1e-6").run()
    assert abs(auto.drag[-1, 2] / (-STOKES * 0.7 * 0.4) - 1) < 1e-2
    with pytest.raises(LammpsError, match="far_field: no grid for Ewald sums of 2501 spheres in a box of"):
        simulation(Spheres(np.vstack([x[:-1], [(1e9, 0, 0)]]), 0.7, (0, 0, 0.4)), f"{ALL} far_field ewald").run()


@pytest.mark.hard_case("far field: a number that is none")
@pytest.mark.parametrize("name,text", [("x", "position"), ("v", "velocity"), ("radius", "radius")])
def test_not_a_number(simulation, name, text):
    sim = simulation(Spheres([(1, 2, 3), (4, 4, 4)], 0.7, (0.1, 0.2, 0.3)), ALL, **PERIODIC).run()
    sim.raw(name)[0] = np.nan
    with pytest.raises(LammpsError, match=f"atom [12]: its {text}"):
        sim.run(1, "pre no")
