"""pair_style given again in one input: what follows depends on the last one only, whatever came before."""
import numpy as np
import pytest

from system import LammpsError, Spheres, dump_lines, input_lines, largest_difference, lmp, read_dump
from without_inertia import CLUMPS, mixed

SETTINGS = ["", "rotation yes", "rotation yes lubrication yes", "multiblob 12 lubrication yes",
            "multiblob 12 one_body no lubrication yes", "multiblob 42 lubrication yes", "multiblob 12",
            "rotation yes lubrication yes lubrication_gap 0.01", "rigid_clumps yes rotation yes",
            "rigid_clumps yes rotation yes shell 12", "rigid_clumps yes rotation yes shell 42 lubrication yes",
            "precondition none"]


def cluster():
    places = np.array([(0, 0, 0), (2.1, 0, 0), (0.3, 2.05, 0.2), (-1.4, 0.9, 1.6), (1.3, 1.2, -2.4), (9.0, 1.0, 0.0)])
    return Spheres(places + 20.0, [1.0, 1.0, 1.0, 0.8, 1.1, 1.0], molecule=[1, 1, 0, 0, 0, 0])


def settle(simulation, words, boundary):
    sim = simulation(cluster(), style_of(words), fix=False, dt=1e-9, boundary=boundary, box=[(0.0, 40.0)] * 3)
    return sim.commands(["fix weight all addforce 0.3 -0.2 -1.0", "fix move all stokes_dynamics/overdamped"])


def style_of(words):
    return f"cut_off_distance inf visc 1.3 relative_tolerance 1e-8 far_field_tolerance 1e-9 {words}"


@pytest.mark.parametrize("boundary", ["f f f", "p p p"])
def test_a_pair_style_given_again_is_as_if_it_were_the_first(simulation, boundary):
    fresh = {}
    for words in SETTINGS:
        fresh[words] = settle(simulation, words, boundary).run().v.copy()
    sim = settle(simulation, SETTINGS[-1], boundary).run()
    for words in SETTINGS + SETTINGS[::-1]:
        sim.commands([f"pair_style stokes_dynamics {style_of(words)}", "pair_coeff * *"]).run()
        assert np.abs(sim.v - fresh[words]).max() < 1e-7 * np.abs(fresh[words]).max(), words


# --- what was derived from the settings before ------------------------------------------------------------------------

FIRST = ["rigid_clumps yes rotation yes", "rigid_clumps yes shell 12", "rigid_clumps yes multiblob 12",
         "rigid_clumps yes rotation yes clumps_only yes"]


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("first", FIRST)
def test_rigid_clumps_first_and_free_multiblobs_second(tmp_path, first, ranks):
    """With inertia: shells of the second stood as clumps of the first, whose shapes were freed."""
    x = [(0, 0, 0), (1.5, 0, 0), (2, 1.5, 0), (5, 0, 0), (0.4, 5, 1)]
    spheres = Spheres(x, 0.7, np.random.default_rng(4).normal(size=(5, 3)), molecule=[1, 1, 1, 0, 0])
    forces = {}
    for name, words in (("again", [first, "multiblob 12"]), ("fresh", ["multiblob 12"])):
        folder = tmp_path / name
        folder.mkdir()
        styles = [f"pair_style stokes_dynamics cut_off_distance inf visc 1.3 relative_tolerance 1e-10 {w}"
                  for w in words]
        lines = input_lines(spheres, [styles[0], "pair_coeff * *"], folder / "data", box=[(-9, 9)] * 3)
        for style in styles[1:]:
            lines += ["run 1", style, "pair_coeff * *"]
        lmp(folder, lines + dump_lines(folder / "dump") + ["run 1"], ranks)
        forces[name] = read_dump(folder / "dump")[-1][1][:, 6:9]
    assert largest_difference(forces["again"], forces["fresh"]) < 1e-9


def test_outputs_between_another_pair_style_and_the_next_run(simulation):
    """They are those of the last step."""
    sim = simulation(mixed(), CLUMPS, fix=False, dt=0.01)
    sim.commands("fix weight all addforce 0 0 -1\nfix move all stokes_dynamics/overdamped").run(2)
    figures = sim.fix_vector("move")
    assert figures[1] > 0.0
    for words in ("relative_tolerance 1e-4", "lubrication yes"):
        sim.commands([f"pair_style stokes_dynamics {CLUMPS} {words}", "pair_coeff * *"])
        assert np.array_equal(sim.fix_vector("move"), figures)
    sim.commands(["pair_style stokes_dynamics cut_off_distance inf visc 1 multiblob 12", "pair_coeff * *"])
    assert np.array_equal(sim.fix_vector("move")[:3], figures[:3])
    sim.run(2)


@pytest.mark.parametrize("fix", ["fix drag all stokes_dynamics", "fix move all stokes_dynamics/overdamped held some"])
def test_torques_of_a_pair_style_before_are_gone_where_the_next_has_none(simulation, fix):
    name = fix.split()[1]
    sim = simulation(cluster(), style_of("rotation yes"), fix=False, dt=1e-9, box=[(0.0, 40.0)] * 3)
    sim.commands(["group some id 1 2", "set group all omega 0.1 0.2 0.3", "fix push all addforce 1 0 0", fix]).run()
    assert np.abs(sim.fix_rows(name)[:, 6:9]).max() > 1e-2
    sim.commands([f"pair_style stokes_dynamics {style_of('')}", "pair_coeff * *"]).run()
    assert np.array_equal(sim.fix_rows(name)[:, 6:9], np.zeros((6, 3)))


@pytest.mark.parametrize("fix", ["fix drag all stokes_dynamics", "fix move all stokes_dynamics/overdamped"])
def test_a_run_without_its_preparation_after_another_pair_style_is_an_error(simulation, fix):
    sim = simulation(mixed(), CLUMPS, fix=False, dt=0.01).commands(fix).run(2)
    sim.commands([f"pair_style stokes_dynamics {CLUMPS} relative_tolerance 1e-4", "pair_coeff * *"])
    with pytest.raises(LammpsError,
                       match="Pair style stokes_dynamics: the command has been given again since the last run"):
        sim.command("run 1 pre no")
    sim.run(1)
