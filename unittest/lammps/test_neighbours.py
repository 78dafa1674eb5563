"""Other commands of LAMMPS beside the styles: each row of the tables of neighbours (common/neighbours.h) says what its list says,
and says nothing of the same command on other atoms."""
import os
import re

import pytest

from neighbour_tables import KINDS, ROW, PACKAGE, joined
from system import LammpsError, input_lines, lmp

OVERDAMPED = "fix move ours stokes_dynamics/overdamped"
NOISY = f"{OVERDAMPED} temperature 1 4711"


def scene(words="cut_off_distance inf visc 1", pair="", coeff="", atoms="hybrid sphere bond"):
    """Two spheres of the group ours, type 1, which alone are selected, and two others, type 2. Beside the pair style another one
    with its pair_coeff between the types of `coeff`."""
    plugin = f"stokes_dynamics {words} group ours"
    lines = ["units lj", f"atom_style {atoms}", "comm_modify vel yes cutoff 8", "atom_modify map array", "boundary f f f",
             "plugin load stokesdynplugin.so", "region box block -9 9 -9 9 -9 9", "create_box 2 box"]
    lines += [f"create_atoms {kind} single {x} 0 0" for kind, x in ((1, -6.0), (1, -3.5), (2, 3.5), (2, 6.0))]
    lines += ["set group all diameter 2.0 density 1.7", "group ours type 1", "group others type 2"]
    if pair:
        name = pair.split()[0]
        lines += [f"pair_style hybrid/overlay {pair} {plugin} zero 3.0", "pair_coeff * * zero", f"pair_coeff {coeff.replace('NAME', name)}"]
    else:
        lines += [f"pair_style {plugin}"]
    return lines + ["pair_coeff * *" + (" stokes_dynamics" if pair else ""), "timestep 1e-3"]


def fixed(line, move=OVERDAMPED, **more):
    """The commands with a fix that acts on the group GROUP."""
    return lambda ours: scene(**more) + [line.replace("GROUP", "ours" if ours else "others"), move]


def paired(pair, coeff, move=OVERDAMPED, **more):
    """The commands with another pair style, between types IJ."""
    return lambda ours: scene(pair=pair, coeff=coeff.replace("IJ", "1 1" if ours else "2 2"), **more) + [move]


HOOKE = "gran/hooke/history 10 NULL {} NULL {} 0"
# (kind and styles of the row, its facts, the input, what is said of which guest)
CASES = [
    ("FIX viscous* langevin*", "OVERDAMPED", fixed("fix b GROUP viscous 1"), "fix b of style viscous adds a drag"),
    ("FIX viscous* langevin*", "OVERDAMPED", fixed("fix b GROUP langevin 1 1 1 77"), "fix b of style langevin adds a drag"),
    ("PAIR lubricate*", "OVERDAMPED", paired("lubricate 1 1 1 2.01 2.5", "IJ NAME"), "pair_style lubricate has a drag"),
    ("PAIR brownian*", "OVERDAMPED | NOISE", paired("brownian 1 1 1 2.01 2.5 1 77", "IJ NAME", NOISY), "pair_style brownian has noise"),
    ("FIX move", "OVERDAMPED", fixed("fix b GROUP move linear 0 0 1"), "fix b of style move integrates spheres"),
    ("FIX *", "OVERDAMPED", fixed("fix b GROUP nve/sphere"), "fix b of style nve/sphere integrates spheres"),
    ("FIX setforce freeze", "OVERDAMPED", fixed("fix b GROUP setforce 0 0 0"), "fix b of style setforce sets forces to 0"),
    ("PAIR gran/hooke gran/hooke/history gran/hertz/history", "OVERDAMPED", paired(HOOKE.format(0.3, 0), "IJ NAME"),
     "pair_style gran/hooke/history damps its contacts (gamma 0.3)"),
    ("PAIR gran/hooke gran/hooke/history gran/hertz/history", "OVERDAMPED | NOISE", paired(HOOKE.format(0, 0.4), "IJ NAME", NOISY),
     "pair_style gran/hooke/history has friction (0.4)"),
    ("PAIR granular", "OVERDAMPED", paired("granular", "IJ NAME hooke 10 0 tangential linear_nohistory 0 0"), "pair_style granular must have no damping"),
    ("PAIR granular", "OVERDAMPED | NOISE", paired("granular", "IJ NAME hooke 10 0 tangential linear_nohistory 0 0", NOISY),
     "pair_style granular must have no friction"),
    ("FIX wall/gran*", "OVERDAMPED", fixed("fix b GROUP wall/gran hooke 10 NULL 0 NULL 0 0 zplane -8 8"), "fix b of style wall/gran must have no damping"),
    ("FIX wall/gran*", "OVERDAMPED | NOISE", fixed("fix b GROUP wall/gran hooke 10 NULL 0 NULL 0 0 zplane -8 8", NOISY),
     "fix b of style wall/gran must have no friction"),
]
# those that act on whatever atoms
ANYWHERE = [
    ("FIX dt/reset", "OVERDAMPED | NOISE", fixed("fix b GROUP dt/reset 10 NULL 0.1 0.1", NOISY), "fix b of style dt/reset makes steps"),
    ("FIX deform*", "OVERDAMPED | ADAPTING", fixed("fix b GROUP deform 1 z erate 0.1 units box", f"{OVERDAMPED} adapt 1 1e-3 1 0.1"),
     "fix b of style deform counts its rate"),
]


def rows():
    for path in sorted((PACKAGE / "stokes").glob("neighbours*.cpp")):
        for row in ROW.finditer(path.read_text()):
            yield f"{row['kind']} {joined(row['styles'])}", row["where"], row["verdict"]


def ids(case):
    return re.sub(r"\W+", "-", f"{case[0]} {case[1]} {case[3]}")


def said(simulation, tmp_path, lines):
    """The error and the warnings of one step."""
    log = tmp_path / "log"
    sim = simulation(log=log)
    try:
        sim.commands(lines).run(1)
        error = ""
    except LammpsError as stop:
        error = str(stop)
    sim.command("log none")
    return error, "\n".join(re.findall("^WARNING.*", log.read_text(), re.M))


@pytest.mark.parametrize("ours", [True, False], ids=["ours", "others"])
@pytest.mark.parametrize("case", CASES + ANYWHERE, ids=ids)
def test_a_row_speaks_of_atoms_of_ours(simulation, tmp_path, case, ours):
    row, facts, lines, message = case
    verdict = {(row, where): verdict for row, where, verdict in rows()}[(row, facts)]
    error, warnings = said(simulation, tmp_path, lines(ours))
    if ours or case in ANYWHERE:
        assert message in (error if verdict == "ERROR" else warnings), (error, warnings)
    else:
        assert message not in warnings and not error, (error, warnings)
    assert verdict == "ERROR" or not error


def test_every_row_has_a_case():
    tested = {case[:2] for case in CASES + ANYWHERE}
    missing = [row for row in rows() if row[:2] not in tested and row[2] != "FINE"]
    assert not missing
    assert all(kind.split()[0] in KINDS for kind, _ in tested)


def test_spheres_that_are_held_may_be_moved_and_need_no_force(simulation, tmp_path):
    lines = scene() + ["group one id 1", "fix a one move linear 0 0 1", "fix b one setforce 0 0 0", f"{OVERDAMPED} held one"]
    error, warnings = said(simulation, tmp_path, lines)
    assert not error and "sets forces to 0" not in warnings


def test_a_warning_is_given_once(simulation, tmp_path):
    log = tmp_path / "log"
    sim = simulation(log=log).commands(scene() + ["fix b ours setforce 0 0 0", OVERDAMPED]).run(1).run(1)
    sim.command("log none")
    assert log.read_text().count("sets forces to 0") == 1


def test_two_ranks_say_the_same(tmp_path):
    """The group is on one rank only."""
    for ours, line in ((True, "fix b of style viscous adds a drag"), (False, "")):
        finished = lmp(tmp_path, ["processors 2 1 1"] + CASES[0][2](ours) + ["run 1"], ranks=2, succeed=not ours)
        assert (line in finished.text) and (finished.code != 0) == ours
