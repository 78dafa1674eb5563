"""Changes of an input that must not matter do not (relations.py): 60 scenes of all models. And the judge itself: it
finds what is wrong, makes it small, and knows the numbers of an input by what they are."""
import re

import numpy as np
import pytest

import lives
import relations
import relations_changes as changes
from host import PATIENCE, by_open_mpi
from relations_frame import KINDS, Frame, turned

SEED, GROUPS, EACH = 41, 20, 3


@pytest.mark.parametrize("group", by_open_mpi(range(GROUPS), but=4))
def test_what_must_not_matter_does_not_on_any_number_of_ranks(group):
    failures, judged, number = [], 0, 100 * group
    while judged < EACH:
        more, ran = relations.judge(SEED, [number], relations.most_ranks())
        failures, judged, number = failures + more, judged + ran["judged"], number + 1
    assert number < 100 * group + 2 * EACH, "too many scenes are refused"
    assert not failures, "\n\n".join(failures)


# --- the judge --------------------------------------------------------------------------------------------------------

def case(model, names, **options):
    module = relations.MODELS[model]
    simple = {name: values[0] for name, values in module.OPTIONS.items()}
    return relations.Case(model, "judge 1", module.lawful(dict(simple, **options)), names)


def test_a_force_that_does_not_turn_with_the_input_is_found_and_made_small(monkeypatch):
    """A wind that blows along x in whatever frame: the smallest case has one change, and all options are the simplest
    ones."""
    right = relations.commands

    def wrong(scene, frame, **how):
        return [(ranks, [line + "\nfix wind odd addforce 0.01 0 0" if line.startswith("fix pull") else line
                         for line in lines])
                for ranks, lines in right(scene, frame, **how)]

    monkeypatch.setattr(relations, "commands", wrong)
    found = case("stokes", ["turn", "skin"], spheres=5, radii="unlike", motion="ab2", flow="uniform")
    assert found.judge()[0] == "differs"
    small = found.reduced(patience=np.inf)
    assert small.names == ["turn"] and small.options == case("stokes", []).options | {"radii": small.options["radii"]}
    script = small.script()
    assert script.count("fix wind odd addforce 0.01 0 0") == 2 and script.count("\nlmp -in in.0\n") == 2
    assert script.count("create_atoms 1 single") == 4


def test_an_input_that_breaks_is_told_with_its_message(monkeypatch):
    right = relations.commands
    monkeypatch.setattr(relations, "commands", lambda scene, frame, **how: [
        (ranks, lines + ["nonsense"] * bool(how)) for ranks, lines in right(scene, frame, **how)])
    what, why = case("stokes", ["skin"]).judge()
    assert what == "breaks" and "Unknown command: nonsense" in why


@pytest.mark.parametrize("R", [np.eye(3), turned("y", "z", "x"), turned("x", "-y", "z"), turned("-z", "y", "x")],
                         ids=str)
def test_what_is_written_in_a_frame_comes_back(R):
    frame, v = Frame(R=R, shift=(3.0, -2.0, 5.0), scale=(10.0, 0.5, 3.0)), np.array([1.0, -2.0, 0.5])
    for kind in KINDS:
        words = frame.write(f"<{kind} 1.0 -2.0 0.5>").split()
        assert np.abs(frame.back(kind, np.array([float(w) for w in words])) - v).max() < 1e-14, kind
    S = np.array([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    assert np.abs(Frame(R=R.T).back("stress", Frame(R=R).back("stress", S)) - S).max() < 1e-14


@pytest.mark.parametrize("mark, wanted", [
    ("<side zlo -8.5>", "xlo -8.5"), ("<block 0 1 INF INF 2 3>", "2.0 3.0 0.0 1.0 INF INF"),
    ("<planes x 0.5 NULL>", "yplane 0.5 NULL"), ("<each p f s>", "s p f"), ("<ids 1 3>", "3 1"),
    ("<W 1 2 3>", "3.0 1.0 2.0"), ("<at y 4>", "4.0"), ("<axis z>", "x"),
    ("<corners -1 1 -2 2 -3 3>", "lo -3.0 -1.0 -2.0 hi 3.0 1.0 2.0")])
def test_marks_say_where_things_are_after_a_turn(mark, wanted):
    """x becomes y, y becomes z, z becomes x"""
    assert Frame(R=turned("y", "z", "x"), order=[3, 2, 1]).write(mark) == wanted


def test_axial_vectors_keep_their_sign_across_a_mirror_that_polar_ones_lose():
    frame = Frame(R=turned("x", "y", "-z"))
    assert frame.write("<F 1 2 3>") == "1.0 2.0 -3.0" and frame.write("<W 1 2 3>") == "-1.0 -2.0 3.0"
    assert frame.write("<block 0 1 2 3 4 5>") == "0.0 1.0 2.0 3.0 -5.0 -4.0" and frame.write("<face zlo>") == "zhi"


def test_each_exception_has_its_reason_and_names_changes_that_there_are():
    for names, _, *rest in changes.EXCEPTIONS + changes.COARSE:
        assert set(names) <= set(changes.CHANGES) and len(rest[-1]) > 8


def test_every_change_and_every_option_can_be_drawn():
    drawn, options = set(), set()
    for number in range(1500):
        c = relations.Case.draw(3, number, 3)
        drawn.update(c.names)
        options.update((c.model, k, v) for k, v in c.options.items())
    assert drawn == set(changes.CHANGES)
    for model, module in relations.MODELS.items():
        missing = {(k, v) for k, values in module.OPTIONS.items()
                   for v in values} - {(k, v) for m, k, v in options if m == model}
        assert not missing, (model, missing)


# --- lives ------------------------------------------------------------------------------------------------------------

def test_lives_of_all_models_end_well(tmp_path):
    for model in relations.MODELS:
        worker = lives.Worker(5, 2, 1, PATIENCE, str(tmp_path), lives.__file__, {"LIVES_MODEL": model})
        results = list(worker.results(0))
        assert [r.get("end") for r in results] == [None,
                                                   None] and all(r["commands"] >= lives.LENGTH[0] for r in results)


@pytest.mark.parametrize("frame, ours", [("#3 0x7f in PairSph::compute (/home/u/build/stokesdynstyles.so+0x12)", True),
                                         ("#1 0x7f in lammpsplugin_init (/home/u/build/stokesdynplugin.so+0x12)", True),
                                         ("#0 0x7f in sd_cg ../PKG-STOKESDYN/core/base/sd_cg.c:31", True),
                                         ("#0 0x7f in LAMMPS_NS::Thermo::compute (/usr/lib/liblammps.so.0+0x34)",
                                          False)])
def test_a_report_is_ours_where_a_frame_is(tmp_path, frame, ours):
    (tmp_path / "asan.12").write_text("==12==ERROR: AddressSanitizer: heap-use-after-free\n"
                                      f"    #0 0x7e in memcpy\n    {frame}\n")
    (found, text), = lives.reports(str(tmp_path))
    assert found == ours and re.search("heap-use-after-free", text)
    assert lives.reports(str(tmp_path)) == []
