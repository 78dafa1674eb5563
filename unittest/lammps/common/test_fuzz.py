"""Commands by grammar and mutation (fuzz.py): no crash, no hang, nothing accepted that the pages call wrong, nothing
refused that they call right, and every error names its command and keyword."""
import select

import pytest

import fuzz
import fuzz_grammar
import fuzz_stokes
import fuzz_vans
from host import PATIENCE

STOKES = "visc 1 cut_off_distance inf"


def test_300_commands_do_what_the_pages_say():
    found = fuzz.run(300, seed=20261122, timeout=PATIENCE)
    assert sum(found.count.values()) == 300
    assert found.defects == 0, found.table() + found.examples(3)


# --- the judge --------------------------------------------------------------------------------------------------------

class Read(fuzz_grammar.Case):
    """A command that is given, not drawn."""

    def __init__(self, judge, words, how="open"):
        self.extreme, self.variables, self.faults, self.level = False, set(), [], fuzz_grammar.GOOD
        self.settings, self.given, self.keyword = {}, [], ""
        self.lines, self.tried = [""], 0
        judge(self, words.split(), how)


@pytest.mark.parametrize("words, level", [
    ("", "good"), ("algorithm 2 rotation yes", "good"), ("visc v_eta", "loud"), ("update_every 0", "bad"),
    ("max_iter 1e3", "bad"), ("shell 12", "bad"), ("clumps_only yes rigid_clumps yes shell 12", "odd"),
    ("relative_tolerance 1", "bad"), ("relative_tolerance 0.5", "loud"), ("fluid_velocity 0 0", "bad"),
    ("fluid_velocity 0 0 0x1", "bad"), ("tensor RPY", "bad"),
    ("taper wendland", "bad"), ("precondition sparse", "bad"), ("precondition sparse algorithm 2", "good"),
    ("bogus", "bad")])
def test_the_judge_reads_as_the_page_of_the_pair_style(words, level):
    assert Read(fuzz_stokes.judge_stokes, f"{STOKES} {words}").level == level


@pytest.mark.parametrize("words, level", [
    ("", "good"), ("couple one", "good"), ("couple both", "bad"), ("solve 1 2", "bad"), ("solve 1 1e-9", "loud"),
    ("phi_max 1.1", "bad"), ("lift off", "good"), ("lift on", "bad"), ("class_radii 2 0.003", "bad"),
    ("fluctuation depth 1", "bad"), ("fluctuation depth 1 auto", "good"), ("profile file short.txt", "bad"),
    ("mesh 20 0.001 0", "loud")])
def test_the_judge_reads_as_the_page_of_the_stream(words, level):
    assert Read(fuzz_vans.judge_vans, f"1 mesh 20 0.001 0 fluid 1000 0.001 gravity 0.5 0 -9.8 {words}",
                "usual").level == level


@pytest.mark.parametrize("words, result, wanted", [
    ("bogus", {"error": ""}, "accepted, though the pages call it wrong"),
    ("bogus", {"error": "ERROR: Pair style stokes_dynamics: unknown keyword 'bogus'"},
     "error that names command and keyword"),
    ("bogus", {"error": "ERROR: Pair style stokes_dynamics: wrong"}, "error does not name the keyword"),
    ("bogus", {"error": "ERROR: wrong"}, "error does not name the command"),
    ("", {"error": "ERROR: Pair style stokes_dynamics: keyword visc: no"}, "refused, though valid"),
    ("", {"error": "", "finite": False}, "forces not finite"),
    ("", {"error": ""}, "accepted, forces finite"),
    ("relative_tolerance 0.5", {"error": ""}, "accepted without the warning"),
    ("relative_tolerance 0.5", {"error": "", "warnings": "WARNING: relative_tolerance"}, "accepted with a warning"),
    ("", {"end": "crash"}, "crash")])
def test_an_outcome_is_called_by_its_name(words, result, wanted):
    whole = dict({"number": 0, "at": 0, "finite": True, "warnings": ""}, **result)
    assert fuzz.outcome(Read(fuzz_stokes.judge_stokes, f"{STOKES} {words}"), whole) == wanted


def test_a_worker_that_dies_is_a_crash_and_the_next_case_goes_on(tmp_path, monkeypatch):
    """Case 1 kills its worker, case 3 sleeps: no other is taken for one that hangs, however long it takes to begin."""
    script, asleep = tmp_path / "worker.py", tmp_path / "asleep"
    script.write_text("import os, sys, time, json\n"
                      "for k in range(int(sys.argv[3]), int(sys.argv[4])):\n"
                      "    if k == 1: os.abort()\n"
                      f"    if k == 3: open({str(asleep)!r}, 'w').close(); time.sleep(600)\n"
                      "    print('@' + json.dumps({'number': k}), flush=True)\n")

    class Patient:
        @staticmethod
        def select(read, write, error, timeout):
            while True:
                sleeps = asleep.exists()
                ready = select.select(read, write, error, timeout if sleeps else 0.05)
                if sleeps and not ready[0]:
                    asleep.unlink()
                if sleeps or ready[0]:
                    return ready

    monkeypatch.setattr(fuzz, "select", Patient)
    monkeypatch.setattr(fuzz, "__file__", str(script))
    results = list(fuzz.Worker(0, 6, 1, 2.0, str(tmp_path)).results(0))
    assert [r["number"] for r in results] == list(range(6))
    assert [r.get("end") for r in results] == [None, "crash", None, "hang", None, None]
