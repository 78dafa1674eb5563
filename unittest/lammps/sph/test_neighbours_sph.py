"""Other commands of LAMMPS beside the SPH styles and the stream: each row of their tables of neighbours says what its
list says, and says nothing of the same command on other atoms."""
import re

import pytest

from neighbour_tables import names_of_rows
from system import LammpsError, Simulation

MOVE = "fix move ours nve/sph"


def scene(pair="", coeff="", move=MOVE, more="viscosity 0.05 central"):
    """Water on a floor (types 1 and 2) and four atoms of another kind (type 3) in the same box; beside them another
    pair style."""
    words = f"sph/artVisc/tensCorr wendland 0.2 {more}"
    lines = ["units lj", "dimension 2", "atom_style sph", "atom_modify map array", "boundary f f p",
             "plugin load stokesdynplugin.so", "lattice sq 100 origin 0.5 0.5 0",
             "region box block -0.4 2.4 -0.4 1.2 -0.05 0.05 units box", "create_box 3 box",
             "region water block 0 0.8 0 0.6 INF INF units box", "region floor block 0 0.8 -0.4 0 INF INF units box",
             "create_atoms 1 region water", "create_atoms 2 region floor"]
    lines += [f"create_atoms 3 single {x} {y} 0 units box" for x in (1.9, 2.1) for y in (0.3, 0.5)]
    lines += ["mass * 0.01", "set group all sph/rho 1", "group ours type 1", "group walls type 2",
              "group others type 3", "group sph type 1 2", f"pair_style hybrid/overlay {words} {pair} zero 0.15",
              "pair_coeff * * zero", "pair_coeff 1*2 1*2 sph/artVisc/tensCorr c 20"]
    lines += [f"pair_coeff {coeff}"] if coeff else []
    return lines + ["neighbor 0.1 bin", "neigh_modify delay 0 every 1", "timestep 0.002",
                    "fix eos sph sph/pressure Tait $(400/7) 1 7", "fix density sph sph/density/continuity",
                    "fix floor walls wall/adami/sph", move, "fix flat all enforce2d"]


def fixed(line, **more):
    return lambda ours: scene(**more) + [line.replace("GROUP", "ours" if ours else "others")]


def paired(pair, coeff):
    return lambda ours: scene(pair=pair, coeff=coeff.replace("IJ", "1 1" if ours else "3 3"))


def moved_by_lammps(ours):
    """Of the others, so that those who are ours may have fix nve/sph."""
    return scene(move="fix move ours sph") if ours else scene() + ["fix b others sph"]


def told(command, water, others):
    """A command that keeps water from others, and one that does not."""
    return lambda ours: scene() + [f"{command} {water if ours else others}"]


def of_a_group(command):
    """Of the water alone, and of water and walls."""
    def lines(ours):
        which = "ours" if ours else "sph"
        made = scene()
        made.insert(made.index("group sph type 1 2") + 1, f"atom_modify sort 0 0 first {which}")
        return made + [f"{command} {which}"]
    return lines


def bound(ours):
    """Bonds of neighbours"""
    lines = [line.replace("atom_style sph", "atom_style hybrid sph bond")
             .replace("box 3 box", "box 3 box bond/types 1 extra/bond/per/atom 9 extra/special/per/atom 60")
             for line in scene()]
    group, near = ("ours", 0.11) if ours else ("others", 0.21)
    return lines + ["bond_style zero", "bond_coeff 1", f"create_bonds many {group} {group} 1 0.05 {near}"]


def molecules(group):
    lines = [line.replace("atom_style sph", "atom_style hybrid sph bond") for line in scene()]
    return lines + [f"neigh_modify exclude molecule/intra {group}"]


DYNAMIC = ["variable low atom y<0.35", "group low dynamic ours every 1 var low"]
# (kind and styles of the row, its facts, the input, what is said)
LAMMPS_SPH = ("PAIR sph/rhosum sph/taitwater* sph/idealgas sph/lj rheo*", "0")
WALL = ("FIX wall/reflect* wall/lj* wall/harmonic* wall/morse wall/table wall/lepton wall/colloid "
        "wall/region wall/gran*", "0")
LIST = ("COMMAND neigh_modify", "0")
GROUP = ("FIX nve/sph nve/sph/stationary wall/adami/sph sph/grains", "0")
BESIDE = [
    (*LAMMPS_SPH, paired("sph/rhosum 1", "IJ sph/rhosum 0.2"),
     "pair_style sph/rhosum sets the density or adds the pressure"),
    (*LAMMPS_SPH, paired("sph/taitwater", "IJ sph/taitwater 1 20 0.01 0.2"),
     "pair_style sph/taitwater sets the density"),
    (*LAMMPS_SPH, paired("sph/idealgas", "IJ sph/idealgas 0.01 0.2"), "pair_style sph/idealgas sets the density"),
    ("FIX sph", "CONTINUITY", moved_by_lammps, "fix move of style sph lets sound grow at time steps above 0.00075"),
    ("FIX recenter", "0", fixed("fix b GROUP recenter INIT NULL NULL"),
     "fix b of style recenter moves some of the particles without a velocity"),
    ("FIX temp/* langevin* heat ehex", "0", fixed("fix b GROUP temp/rescale 1 1 1 0.1 1"),
     "fix b of style temp/rescale changes velocities of the water, which are its flow"),
    ("FIX temp/* langevin* heat ehex", "0", fixed("fix b GROUP langevin 1 1 1 77"),
     "fix b of style langevin changes velocities of the water, which are"),
    (*WALL, fixed("fix b GROUP wall/reflect xhi EDGE"), "fix b of style wall/reflect is no wall for water"),
    (*WALL, fixed("fix b GROUP wall/lj93 xhi EDGE 1 0.02 0.05"), "fix b of style wall/lj93 is no wall for water"),
    (*WALL, fixed("fix b GROUP wall/harmonic xhi EDGE 1 0.02 0.05"),
     "fix b of style wall/harmonic is no wall for water"),
    (*WALL, fixed("fix b GROUP wall/morse xhi EDGE 1 1 0.02 0.05"), "fix b of style wall/morse is no wall for water"),
    (*WALL, fixed("fix b GROUP wall/region box harmonic 1 0.02 0.05"),
     "fix b of style wall/region is no wall for water"),
    (*LIST, told("neigh_modify exclude type", "1 1", "2 2 exclude type 3 3 exclude type 2 3 exclude type 1 3"),
     "neigh_modify has exclude type 1 1, so that atoms 1 and 2 would not see each other: take it out"),
    (*LIST, told("neigh_modify exclude group", "ours walls", "walls walls"),
     "neigh_modify has exclude group ours walls, so that atoms 1 and 49 would not see"),
    (*LIST, lambda ours: molecules("all" if ours else "walls"), "neigh_modify has exclude molecule/intra all, so that"),
    (*LIST, of_a_group("neigh_modify include"), "neigh_modify has include ours, so that atoms 1 and 49 would not see"),
    ("COMMAND comm_modify", "0", of_a_group("comm_modify group"), "comm_modify has group ours, so that atoms 1 and 49"),
    ("COMMAND special_bonds", "0", bound, "special_bonds has a factor 0 and keeps atom 1 from those"),
    ("COMMAND timestep", "0", told("timestep", "-0.002", "0.002"), "timestep is -0.002, and friction would drive"),
    ("COMMAND pair_coeff", "0", told("pair_coeff", "1 2 none", "1 3 none"),
     "pair_coeff leaves out types 1 and 2, so that atoms 1 and 49 would not see each other"),
]
DYNAMICS = [
    (*GROUP, ["fix move low nve/sph"], "fix move of style nve/sph has the dynamic group low"),
    (*GROUP, ["fix move ours nve/sph", "unfix floor", "fix floor low wall/adami/sph"],
     "fix floor of style wall/adami/sph has the dynamic group low"),
]
# of packages and versions that not every LAMMPS has
ELSEWHERE = {("FIX rheo*", "0"): ("fix", "rheo"),
             # three dimensions: test_sph_grains.py
             ("FIX hydro/vans viscous* langevin* lb/*", "GRAINS"): ("fix", "viscous"),
             ("FIX gravity addforce efield spring* drag wall/gran*", "GRAINS"): ("fix", "gravity"),
             ("FIX freeze setforce planeforce lineforce", "GRAINS"): ("fix", "setforce"),
             ("FIX rigid*", "TENSION"): ("fix", "rigid")}    # test_sph_tension.py


def ids(case):
    return re.sub(r"\W+", "-", f"{case[1]} {case[-1]}")


def said(tmp_path, lines, steps=0):
    """The error and the warnings of a run."""
    log = tmp_path / "log"
    sim = Simulation(tmp_path, log=log)
    try:
        sim.commands(lines + [f"run {steps}"])
        error = ""
    except LammpsError as stop:
        error = str(stop)
    try:
        sim.command("log none")
    finally:
        sim.close()
    return error, "\n".join(re.findall("^WARNING.*", log.read_text(), re.M))


@pytest.mark.parametrize("ours", [True, False], ids=["ours", "others"])
@pytest.mark.parametrize("case", BESIDE, ids=ids)
def test_a_row_speaks_of_particles_of_ours(tmp_path, case, ours):
    row, facts, lines, message = case
    verdict = {(row, where): verdict for row, where, verdict in names_of_rows("sph")}[(row, facts)]
    error, warnings = said(tmp_path, lines(ours))
    if ours:
        assert message in (error if verdict == "ERROR" else warnings), (error, warnings)
    else:
        assert message not in warnings and not error, (error, warnings)
    assert verdict == "ERROR" or not error


@pytest.mark.parametrize("case", DYNAMICS, ids=ids)
def test_who_moves_or_is_a_wall_is_no_dynamic_group(tmp_path, case):
    lines = scene(move="") + DYNAMIC + case[2]
    assert case[-1] in said(tmp_path, lines)[0]


def test_every_row_has_a_case(tmp_path):
    tested = {case[:2] for case in BESIDE + DYNAMICS}
    assert not [row for row in names_of_rows("sph")
                if row[:2] not in tested and row[2] != "FINE" and row[:2] not in ELSEWHERE]
    assert [row for row in names_of_rows("vans") if row[2] != "FINE"] == [
        # test_vans_coupling.py
        ("FIX wall/reflect*", "LANGEVIN", "WARNING"), ("FIX freeze setforce planeforce lineforce", "0", "WARNING"),
        ("FIX rigid* poems shake rattle", "DRAGS", "WARNING"),
        ("FIX viscous langevin* gld gle gjf ffl ttm* nve/dotc/langevin electron/stopping* brownian* lb/*", "DRAGS",
         "WARNING"), ("FIX rigid*", "DRAGS", "WARNING"),
        ("PAIR lubricate lubricate/poly", "DRAGS", "WARNING"),
        ("FIX nvt* npt* nvk temp/* rigid/nvt* rigid/npt* bocs hmc momentum* viscosity thermal/conductivity heat ehex",
         "DRAGS", "WARNING"), ("FIX damping/cundall", "DRAGS", "WARNING"), ("FIX srd", "DRAGS", "WARNING"),
        ("COMMAND neigh_modify", "DRAGS", "ERROR"), ("COMMAND timestep", "0", "ERROR"),
        ("COMMAND boundary", "DRAGS", "WARNING")]


def test_particles_at_rest_may_lose_their_own_kind(tmp_path):
    """As walls of LIGGGHTS's inputs do, where their densities have rates alone."""
    lines = [line.replace("fix floor walls wall/adami/sph", "fix floor walls nve/sph/stationary") for line in scene()]
    lines.append("neigh_modify exclude group walls walls")
    assert said(tmp_path, lines, 1) == ("", "")
    lines = [line + " delta 0.1" * line.startswith("fix density") for line in lines]
    assert "exclude group walls walls" in said(tmp_path, lines)[0]


def test_factors_above_0_of_bonds_keep_neighbours(tmp_path):
    assert said(tmp_path, bound(True) + ["special_bonds lj/coul 1 1 1"])[0] == ""


def test_viscosity_that_damps_sound_lets_fix_sph_be(tmp_path):
    """3 alpha h/(8 c) is 0.00375 with alpha 1, and the step 0.002."""
    for alpha, warned in ((1.0, False), (0.5, True)):
        lines = scene(move="fix move ours sph", more=f"artVisc {alpha} 0 4e-4")
        error, warnings = said(tmp_path, lines)
        assert not error and ("lets sound grow" in warnings) == warned, (error, warnings)


def test_particles_of_a_wall_may_meet_a_wall_of_lammps(tmp_path):
    error, warnings = said(tmp_path, scene() + ["fix b walls wall/reflect xhi EDGE"])
    assert not error and "is no wall" not in warnings


IDLE = " particles, the first is atom 49, are in the group of no fix nve/sph, nve/sph/stationary or wall/adami/sph"


@pytest.mark.parametrize("change, steps, says", [
    (("fix floor walls wall/adami/sph", ""), 1, True), (("fix floor walls wall/adami/sph", ""), 0, False),
    (("fix floor walls wall/adami/sph", "fix floor walls nve/sph/stationary"), 1, False), (("", ""), 1, False)])
def test_a_floor_that_no_fix_makes_a_wall_is_warned_of(tmp_path, change, steps, says):
    """Its particles acted as water at rest, without a word. A run of no steps needs no integration."""
    error, warnings = said(tmp_path, [line.replace(*change) for line in scene()], steps)
    assert error == "" and (IDLE in warnings) == says


def test_water_must_not_be_moved_by_a_fix_that_does_not_advance_its_density(tmp_path):
    """Beside fix nve/sph/stationary of a floor, fix nve let it flow with the densities of the beginning."""
    lines = [line.replace("nve/sph", "nve") if line.startswith("fix move") else line for line in scene()]
    error, _ = said(tmp_path, lines + ["fix rest walls nve/sph/stationary"], 1)
    assert "fix move of style nve, which does not advance its density: water is moved by fix nve/sph, and" in error


TWICE, THIN = "create_atoms 1 region again", "region floor block 0 0.8 -0.1 0 INF INF units box"


@pytest.mark.parametrize("old, new, filled, thin", [
    ("", "", None, False), ("mass * 0.01", "mass * 0.001", 0.1, False), ("mass * 0.01", "mass * 0.02", 2.0, False),
    ("mass * 0.01", f"region again block 0 0.8 0.04 0.6 INF INF units box\nlattice sq 100 origin 0.9 0.9 0\n{TWICE}\n"
     "group ours type 1\ngroup sph type 1 2\nmass * 0.01\nset group all sph/rho 1", 2.0, False),
    ("region floor block 0 0.8 -0.4 0 INF INF units box", THIN, None, True),
    ("region floor block 0 0.8 -0.4 0 INF INF units box", THIN.replace("0.1", "0.3"), None, False)])
def test_masses_that_do_not_fill_space_and_thin_walls_are_warned_of(tmp_path, old, new, filled, thin):
    """The mass of another spacing, two lattices in one place, a floor of one row: they ran without a word."""
    lines = [line for of in scene() for line in (of.replace(old, new) if old else of).split("\n")]
    error, warnings = said(tmp_path, lines)
    said_so = re.search(r"volumes of particles, mass over density, fill (\S+) of the space in place of 1", warnings)
    assert not error and bool(said_so) == bool(filled), warnings
    assert not filled or abs(float(said_so[1]) / filled - 1) < 0.1
    assert ("the wall is thin" in warnings and "the first is atom 1, see its other" in warnings) == thin, warnings


@pytest.mark.parametrize("rho, says", [(1, False), (0.9, False), (1000, True), (0.7, True)])
def test_densities_far_from_that_at_rest_are_warned_of(tmp_path, rho, says):
    """In other units than the equation of state, with masses that fit them: LAMMPS lost atoms, and no more was said."""
    lines = [line.replace("sph/rho 1", f"sph/rho {rho}").replace("mass * 0.01", f"mass * {0.01 * rho}")
             for line in scene()]
    error, warnings = said(tmp_path, lines)
    told = f"the densities of the fluid of fix eos are {rho} times its rho0"
    assert not error and (told in warnings) == says and "volumes of particles" not in warnings, (error, warnings)


@pytest.mark.parametrize("water, again", [("density/continuity", True), ("density/summation", False)])
def test_densities_go_on_once_in_a_step(tmp_path, water, again):
    """fix numdiff let them go on once for each place that it tries: they were wrong by half, without a word."""
    lines = [line.replace("density/continuity", water) for line in scene()] + ["fix b ours numdiff 1 1e-7", "thermo 1"]
    assert said(tmp_path, lines, 0)[0] == ""
    assert ("step 0: another command asks for the forces of this step again" in said(tmp_path, lines, 1)[0]) == again


RESET = ["thermo_style custom step", "run 1", "reset_timestep 0", "run 1 pre no", "reset_timestep 0"]


def test_a_run_may_have_the_steps_of_one_before(tmp_path):
    assert said(tmp_path, scene() + RESET, 1)[0] == ""


def test_rates_of_the_set_up_are_those_of_one_force(tmp_path):
    """fix sph goes on with them: densities were off by more than they changed in 20 steps, without a word."""
    lines = scene(move="fix move ours sph") + ["fix b ours numdiff 99 1e-7"]
    assert "step 0: another command asks for the forces of this step again" in said(tmp_path, lines, 20)[0]


FALL, PUSH = "fix fall ours gravity 1 vector 0 -1 0", "fix push ours addforce 0.01 0 0"


@pytest.mark.parametrize("gravity, more, says", [
    ("", [FALL], True), ("gravity 0 1 0", [FALL], True), ("gravity 0 -1 0", [FALL], False),
    ("gravity 0 -1 0", [PUSH], False), ("gravity 0.2 -1 0", [FALL, PUSH], False),
    ("gravity 0 v_g 0", ["variable g equal -2", FALL], False), ("", [FALL.replace("ours", "walls")], False)])
def test_a_wall_that_is_told_another_gravity_is_warned_of(tmp_path, gravity, more, says):
    """Water sank into its floor without a word, or rose from it."""
    lines = [f"{line} {gravity}" if line.startswith("fix floor") else line for line in scene()]
    error, warnings = said(tmp_path, lines + more, 2)
    assert error == "" and ("keyword gravity has the numbers" in warnings) == says, warnings
