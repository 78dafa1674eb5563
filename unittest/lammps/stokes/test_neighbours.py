"""Other commands of LAMMPS beside the Stokes styles: each row of the table of neighbours (common/neighbours.h) says
what the page says, and says nothing of the same command on other atoms."""
import re

import pytest

from neighbour_tables import KINDS, names_of_rows
from system import STYLES_OF_TODAY, LammpsError, lmp, there
from test_loading import lammps_source

OVERDAMPED = "fix move ours stokes_dynamics/overdamped"
NOISY = f"{OVERDAMPED} temperature 1 4711"
HALFWAY = f"{OVERDAMPED} scheme midpoint"
INERTIA = "fix drag ours stokes_dynamics\nfix move ours nve/sphere"
UNAPPLIED = INERTIA.replace("dynamics", "dynamics apply no", 1)
WORDS = "cut_off_distance inf visc 1"
TURN = f"{WORDS} rotation yes"
ELLIPSOID, ROUND = "hybrid sphere ellipsoid", "set group all shape 2 2 2 quat 0 0 1 0"
OVERLAP = "set atom 1*2 mol 1\nset atom 2 x -5"


def scene(words=WORDS, pair="", coeff="", atoms="hybrid sphere bond", hybrid="hybrid/overlay", before="",
          boundary="f f f"):
    """Two spheres of the group ours, type 1, which alone are selected, and two others, type 2. Beside the pair style
    another one with the pair_coeff `coeff`, in which NAME is its name."""
    plugin = f"stokes_dynamics {words} group ours"
    lines = ["units lj", f"atom_style {atoms}", "comm_modify vel yes cutoff 8", "atom_modify map array",
             f"boundary {boundary}", "plugin load stokesdynplugin.so", "region box prism -9 9 -9 9 -9 9 0 0 0",
             "create_box 2 box" + (" bond/types 1 extra/bond/per/atom 2 extra/special/per/atom 4" if "bond" in atoms
                                   else "")]
    lines += [f"create_atoms {kind} single {x} 0 0" for kind, x in ((1, -6.0), (1, -3.5), (2, 3.5), (2, 6.0))]
    lines += ["set group all diameter 2.0 density 1.7", "group ours type 1", "group others type 2",
              *before.splitlines()]
    if pair:
        lines += [f"pair_style {hybrid} {pair} {plugin} zero 3.0", "pair_coeff * * zero",
                  f"pair_coeff {coeff.replace('NAME', pair.split()[0])}"]
    else:
        lines += [f"pair_style {plugin}"]
    return lines + ["pair_coeff * *" + (" stokes_dynamics" if pair else ""), "timestep 1e-3"]


def fixed(line, move=OVERDAMPED, **more):
    """The commands with a fix that acts on the group GROUP."""
    return lambda ours: scene(**more) + [line.replace("GROUP", "ours" if ours else "others"), *move.splitlines()]


def paired(pair, coeff, move=OVERDAMPED, **more):
    """The commands with another pair style, between types IJ."""
    return lambda ours: scene(pair=pair, coeff=coeff.replace("IJ", "1 1" if ours else "2 2"),
                              **more) + move.splitlines()


def prepared(before, move=OVERDAMPED, **more):
    """The commands after lines that change the atoms of the group GROUP."""
    return lambda ours: scene(before=before.replace("GROUP", "ours" if ours else "others"), **more) + move.splitlines()


def listed(move):
    """The commands where only the others have neighbours, or only ours."""
    name = "atom_modify first {0}\nneigh_modify include {0}".format
    return lambda ours: scene() + [name("others" if ours else "ours"), *move.splitlines()]


TODAY = f"plugin load {STYLES_OF_TODAY}"


def bonded(style, gamma):
    before = f"{TODAY}\nbond_style {style}\nbond_coeff 1 {gamma}\ncreate_bonds single/bond 1 "
    return lambda ours: scene(before=before + ("1 2" if ours else "3 4")) + [OVERDAMPED]


HOOKE = "gran/hooke/history 10 NULL {} NULL {} 0"
GRAN = "PAIR gran/hooke gran/hooke/history gran/hertz/history"
LANGEVIN = "FIX viscous langevin* gld gle gjf ffl ttm* nve/dotc/langevin electron/stopping*"
TURNLESS = "FIX nve nve/limit nvt npt nph nvk nvt/sllod nvt/uef npt/uef npt/cauchy nphug msst bocs"
HOLDING = "FIX setforce freeze planeforce lineforce aveforce flow/gauss"
PRINTED = "FIX temp/* momentum* oneway heat ehex viscosity thermal/conductivity wall/flow"
THERMOSTATS = "FIX nvt* npt* nvk temp/* rigid/nvt* rigid/npt* bocs hmc"
EXCHANGE = "FIX momentum* viscosity thermal/conductivity heat ehex"
AGAIN, PERTURBED = "FIX numdiff*", "COMPUTE fep* born/matrix"
PRESSURE = "COMPUTE pressure* stress/* centroid/stress/*"
VANS = "hydro/vans 1 mesh 10 1 -9 fluid 1 1 gravity 0.1 0 -1 phi_max 0.6 area 100"
BONDS = "\n".join(["bond_style harmonic", "bond_coeff 1 1 2.5"] + [f"create_bonds single/bond 1 {both}"
                                                                  for both in ("1 2", "3 4")])
# (kind and styles of the row, its facts, the input, what is said of which guest)
CASES = [
    (LANGEVIN, "FORCE", fixed("fix b GROUP viscous 1", INERTIA),
     "fix b of style viscous adds a drag to spheres that the fluid drags as well, so"),
    (LANGEVIN, "FORCE", fixed("fix b GROUP langevin 1 1 1 77", "fix move ours nve/sphere",
                              words=f"{WORDS} add_force yes"),
     "fix b of style langevin adds a drag to spheres that the fluid drags as well, so that drag counts twice"),
    (LANGEVIN, "OVERDAMPED", fixed("fix b GROUP viscous 1"),
     "fix b of style viscous adds a drag to spheres that the fluid drags as well: take"),
    (LANGEVIN, "OVERDAMPED", fixed("fix b GROUP langevin 1 1 1 77"),
     "noise is the keyword temperature of fix stokes_dynamics/overdamped"),
    (LANGEVIN, "FORCE", fixed("fix b GROUP gld 1 1 1 77 pprony 1 1", "fix drag ours stokes_dynamics"),
     "fix b of style gld adds a drag to spheres that the fluid drags as well, so"),
    (LANGEVIN, "OVERDAMPED", fixed("fix b GROUP viscous/omp 1", before=TODAY),
     "fix b of style viscous/omp adds a drag to spheres that the fluid drags as well: take"),
    ("FIX viscous/sphere", "TURNING", fixed("fix b GROUP viscous/sphere 1", INERTIA, words=TURN, before=TODAY),
     "fix b of style viscous/sphere damps spins"),
    ("FIX rigid*", "FORCE", fixed("fix b GROUP rigid single langevin 1 1 1 77", "fix drag ours stokes_dynamics"),
     "(keyword langevin)"),
    ("FIX rigid*", "FORCE", fixed("fix b GROUP rigid/small molecule langevin 1 1 1 77", "fix drag ours stokes_dynamics",
                                  before="set group all mol 1"), "(keyword langevin)"),
    ("FIX brownian*", "FORCE", fixed("fix b GROUP brownian 1 77 gamma_t 1", "fix drag ours stokes_dynamics"),
     "fix b of style brownian moves spheres"),
    ("PAIR lubricate* brownian*", "FORCE", paired("lubricate 1 1 1 2.01 2.5", "IJ NAME", INERTIA),
     "pair_style lubricate has a drag"),
    ("PAIR lubricate* brownian*", "FORCE", paired("brownian 1 1 1 2.01 2.5 1 77", "IJ NAME", INERTIA),
     "pair_style brownian has a drag"),
    ("PAIR lubricate* brownian*", "OVERDAMPED", paired("lubricate 1 1 1 2.01 2.5", "IJ NAME"),
     "pair_style lubricate has a drag or noise"),
    ("PAIR lubricate* brownian*", "OVERDAMPED", paired("brownian 1 1 1 2.01 2.5 1 77", "IJ NAME", NOISY),
     "pair_style brownian has a drag or noise"),
    ("PAIR *dpd*", "FORCE", paired("dpd 2.5", "IJ NAME 4.5", INERTIA, before=TODAY),
     "pair_style dpd has friction between spheres (gamma 4.5) and may have noise"),
    ("PAIR *dpd*", "FORCE", paired("mdpd/rhosum 2.5", "IJ NAME 1", INERTIA, before=TODAY),
     "pair_style mdpd/rhosum has friction or noise of its own between spheres, beside"),
    ("FIX hydro/vans sph/grains lb/*", "0", fixed(f"fix b GROUP {VANS}", INERTIA),
     "fix b of style hydro/vans drags spheres by a fluid of its own"),
    ("FIX hydro/vans sph/grains lb/*", "0", fixed(f"fix b GROUP {VANS}"), "fix b of style hydro/vans drags spheres"),
    ("FIX shake rattle", "OVERDAMPED", fixed("fix b GROUP shake 1e-4 20 0 b 1", before=BONDS),
     "fix b of style shake finds the forces of its bonds from masses"),
    (TURNLESS, "FORCE | TURNING", fixed("fix b GROUP nve", "fix drag ours stokes_dynamics", words=TURN),
     "fix b of style nve moves spheres but does not turn them"),
    (HOLDING, "APPLIED", fixed("fix b GROUP setforce 0 0 0", INERTIA),
     "fix b of style setforce stands before fix stokes_dynamics in the input"),
    (HOLDING, "APPLIED", fixed("fix b GROUP aveforce NULL NULL NULL", INERTIA),
     "fix b of style aveforce stands before fix stokes_dynamics in the input"),
    ("FIX move", "OVERDAMPED", fixed("fix b GROUP move linear 0 0 1"), "fix b of style move integrates spheres"),
    ("FIX *", "OVERDAMPED", fixed("fix b GROUP nve/sphere"), "fix b of style nve/sphere integrates spheres"),
    (TURNLESS, "FORCE | TURNING", fixed("fix d all deform 1 xy erate 0.1 remap v\nfix b GROUP nvt/sllod temp 1 1 1",
                                        "fix drag ours stokes_dynamics", words=TURN, boundary="p p p",
                                        before="velocity all create 1 77"),
     "fix b of style nvt/sllod moves spheres but does not turn them"),
    ("FIX */asphere*", "FORCE | TURNING", fixed("fix b GROUP nve/asphere", "fix drag ours stokes_dynamics",
                                                   words=TURN, atoms=ELLIPSOID, before=ROUND),
        "fix b of style nve/asphere turns spheres by"),
    ("FIX setforce freeze", "OVERDAMPED", fixed("fix b GROUP setforce 0 0 0"),
     "fix b of style setforce sets forces"),
    ("FIX planeforce lineforce", "OVERDAMPED", fixed("fix b GROUP planeforce 0 0 1"),
     "fix b of style planeforce takes away forces"),
    ("FIX wall/reflect* wall/piston", "OVERDAMPED | MIDWAY", fixed("fix b GROUP wall/reflect zlo -8", HALFWAY),
     "fix b of style wall/reflect stands before fix stokes_dynamics/overdamped"),
    ("COMMAND neigh_modify", "0", listed(OVERDAMPED),
     "neigh_modify has include others, which leaves out atom 1: its forces of all steps add up"),
    ("COMMAND neigh_modify", "0", listed(INERTIA), "neigh_modify has include others, which leaves out atom 1"),
    ("FIX flow/gauss", "OVERDAMPED", fixed("fix b GROUP flow/gauss 1 0 0"),
     "fix b of style flow/gauss takes the mean force away"),
    ("FIX propel/self", "OVERDAMPED", fixed("fix b GROUP propel/self velocity 1"),
     "fix b of style propel/self pushes spheres along their velocities"),
    ("FIX propel/self", "OVERDAMPED | TURNING", fixed("fix b GROUP propel/self velocity 1", words=TURN,
                                                      atoms="hybrid sphere dipole"),
     "fix b of style propel/self pushes spheres along their velocities if"),
    (PRINTED, "OVERDAMPED", fixed("fix b GROUP momentum 1 linear 1 1 1"),
     "fix b of style momentum changes velocities, which without inertia follow"),
    (PRINTED, "OVERDAMPED", fixed("fix b GROUP temp/berendsen 1 1 1", before="velocity all create 1 77\n"
                                     "fix w ours addforce 1 0 0"),
     "fix b of style temp/berendsen changes"),
    (THERMOSTATS, "FORCE", fixed("fix b GROUP nvt/sphere temp 1 1 1", "fix drag ours stokes_dynamics"),
     "fix b of style nvt/sphere changes velocities to hold a temperature"),
    (THERMOSTATS, "FORCE", fixed("fix drag ours stokes_dynamics\nfix b GROUP rigid/nvt single temp 1 1 1", ""),
     "fix b of style rigid/nvt changes velocities to hold a temperature"),
    (EXCHANGE, "FORCE", fixed("fix b GROUP momentum 1 linear 1 1 1", INERTIA),
     "fix b of style momentum changes velocities of spheres beside the forces on them"),
    (EXCHANGE, "FORCE", fixed("fix b GROUP viscosity 10 x z 4", INERTIA),
     "fix b of style viscosity changes velocities of spheres beside"),
    (THERMOSTATS, "FORCE", fixed("fix b GROUP temp/rescale 1 1 1 0.1 1", INERTIA, before="velocity all create 1 77"),
     "fix b of style temp/rescale changes velocities to hold a temperature"),
    ("FIX damping/cundall", "ADDED", fixed("fix b GROUP damping/cundall 0.1 0.1", "fix move ours nve/sphere",
                                           words=f"{WORDS} add_force yes", before=TODAY),
     "fix b of style damping/cundall makes forces larger that oppose"),
    ("FIX damping/cundall", "ADDED", fixed("fix b GROUP damping/cundall 0.1 0.1", UNAPPLIED,
                                           words=f"{WORDS} add_force yes", before=TODAY),
     "fix b of style damping/cundall makes forces larger that oppose"),
    ("FIX damping/cundall", "APPLIED", fixed(f"{INERTIA}\nfix b GROUP damping/cundall 0.1 0.1", "", before=TODAY),
     "fix b of style damping/cundall stands behind fix stokes_dynamics in the input"),
    ("FIX ti/spring", "ADDED", fixed("fix b GROUP ti/spring 1 1 1", "fix move ours nve/sphere",
                                     words=f"{WORDS} add_force yes"),
     "fix b of style ti/spring scales all forces on its spheres"),
    ("FIX ti/spring", "APPLIED", fixed(f"{INERTIA}\nfix b GROUP ti/spring 1 1 1", ""),
     "fix b of style ti/spring stands behind fix stokes_dynamics in the input"),
    (AGAIN, "ADDED | TURNING", fixed("fix b GROUP numdiff 1 1e-6\nthermo 1", "fix move ours nve/sphere",
                                     words=f"{TURN} add_force yes"),
     "fix b of style numdiff computes forces once more in the same step"),
    ("FIX hydro/vans sph/grains lb/*", "0", fixed("fix b GROUP lb/fluid", INERTIA, before=TODAY),
     "fix b of style lb/fluid drags spheres by a fluid of its own"),
    ("FIX addtorque", "TURNING", lambda ours: fixed("group one id %d\nfix b one addtorque 0 0 1" % (1 if ours else 4),
                                                    words=TURN)(ours),
     "fix b of style addtorque pushes the atoms of its group"),
    (GRAN, "OVERDAMPED", paired(HOOKE.format(0.3, 0), "IJ NAME"),
     "pair_style gran/hooke/history damps its contacts (gamma 0.3)"),
    (GRAN, "OVERDAMPED | NOISE", paired(HOOKE.format(0, 0.4), "IJ NAME", NOISY),
     "pair_style gran/hooke/history has friction (0.4)"),
    ("PAIR granular", "OVERDAMPED", paired("granular", "IJ NAME hooke 10 0 tangential linear_nohistory 0 0"),
     "pair_style granular must have no damping"),
    ("PAIR granular", "OVERDAMPED | NOISE", paired("granular", "IJ NAME hooke 10 0 tangential linear_nohistory 0 0",
                                                   NOISY),
     "pair_style granular must have no friction"),
    ("FIX wall/gran*", "OVERDAMPED", fixed("fix b GROUP wall/gran hooke 10 NULL 0 NULL 0 0 zplane -8 8"),
     "fix b of style wall/gran must have no damping"),
    ("FIX wall/gran*", "OVERDAMPED | NOISE", fixed("fix b GROUP wall/gran hooke 10 NULL 0 NULL 0 0 zplane -8 8", NOISY),
     "fix b of style wall/gran must have no friction"),
    ("FIX damping/cundall", "OVERDAMPED", fixed("fix b GROUP damping/cundall 0.1 0.1", before=TODAY),
     "fix b of style damping/cundall makes forces"),
    ("PAIR *dpd* bpm/spring", "OVERDAMPED", paired("dpd 2.5", "IJ NAME 4.5", before=TODAY),
     "pair_style dpd has friction between spheres (gamma 4.5)"),
    ("PAIR *dpd* bpm/spring", "OVERDAMPED", paired("dpd/omp 2.5", "IJ NAME 4.5", before=TODAY),
     "pair_style dpd/omp has friction between spheres (gamma 4.5)"),
    ("PAIR *dpd* bpm/spring", "OVERDAMPED", paired("bpm/spring 2.5", "IJ NAME 4.5", before=TODAY),
     "pair_style bpm/spring has friction"),
    ("PAIR *dpd*", "OVERDAMPED", paired("mdpd/rhosum 2.5", "IJ NAME 1", before=TODAY),
     "pair_style mdpd/rhosum has friction or noise"),
    ("BOND bpm/*", "OVERDAMPED", bonded("bpm/spring", 15), "bond_style bpm/spring damps its bonds (gamma 15)"),
    ("BOND bpm/*", "OVERDAMPED", bonded("bpm/rotational", 15), "bond_style bpm/rotational damps its bonds (gamma 15)"),
    ("BOND bpm/*", "OVERDAMPED", bonded("bpm/spring/plastic", 15),
     "bond_style bpm/spring/plastic must have no damping"),
    ("BOND bpm/rotational", "OVERDAMPED | UPRIGHT", bonded("bpm/rotational", 0),
     "bond_style bpm/rotational needs spheres that turn"),
    ("ATOM dipole", "OVERDAMPED | UPRIGHT", prepared("set group GROUP dipole 1 0 0", atoms="hybrid sphere dipole"),
     "atom_style dipole has directions (the dipole of atom 1)"),
 
       ("ATOM ellipsoid", "0", prepared(f"{ROUND}\nset group GROUP shape 3 1 1", atoms=ELLIPSOID),
     "atom_style ellipsoid gives atom 1 a shape"),
    ("ATOM line tri body", "0", prepared("set group GROUP tri 2.0", atoms="hybrid sphere tri"),
     "atom_style tri gives atom 1 a shape of its own"),
 
       ("FIX gravity", "0", fixed("fix b GROUP gravity 1 vector 0 0 -1", before=f"{OVERLAP}\nset atom 3*4 mol 2\n"
                                  "set atom 3 x 5"),
     "fix b of style gravity pulls on the mass of each sphere, and in the clump of molecule 1 spheres overlap"),
]
# those that act on whatever atoms
ANYWHERE = [
    ("FIX srd", "0", fixed("fix b GROUP srd", INERTIA, before=TODAY), "fix b of style srd has a fluid of its own"),
    ("COMMAND timestep", "FORCE", fixed("timestep -1e-3", INERTIA), "timestep is -0.001, and drag would drive"),
    ("FIX dt/reset", "OVERDAMPED | NOISE", fixed("fix b GROUP dt/reset 10 NULL 0.1 0.1", NOISY),
     "fix b of style dt/reset makes steps"),
    ("FIX deform*", "OVERDAMPED | ADAPTING", fixed("fix b GROUP deform 1 z erate 0.1 units box",
                                                   f"{OVERDAMPED} adapt 1 1e-3 1 0.1"),
     "fix b of style deform counts its rate"),
    ("FIX deform*", "RESTING", fixed("fix b GROUP deform 1 xy erate 0.1 remap v", boundary="p p p"),
     "fix b of style deform deforms the box with remap v"),
    (PRESSURE, "0", fixed("compute P all pressure NULL pair"),
     "compute P of style pressure knows nothing of the forces"),
    (PRESSURE, "0", fixed("compute S all stress/atom NULL"), "compute S of style stress/atom knows nothing"),
    (PRESSURE, "0", fixed("thermo_style custom step pxx"),
     "compute thermo_press of style pressure knows nothing of the forces"),
    (PRESSURE, "0", fixed("thermo_style custom step press", INERTIA),
     "compute thermo_press of style pressure knows nothing of the forces"),
]


def ids(case):
    return re.sub(r"\W+", "-", f"{case[0]} {case[1]} {case[3]}")[:70]


def said(simulation, tmp_path, lines, steps=2):
    """The error and the warnings of a short run."""
    if TODAY in lines:
        there(STYLES_OF_TODAY)
    log = tmp_path / "log"
    sim = simulation(log=log)
    try:
        sim.commands("\n".join(lines)).run(steps)
        error = ""
    except LammpsError as stop:
        error = str(stop)
    sim.command("log none")
    return error, "\n".join(re.findall("^WARNING.*", log.read_text(), re.M))


@pytest.mark.parametrize("ours", [True, False], ids=["ours", "others"])
@pytest.mark.parametrize("case", CASES + ANYWHERE, ids=ids)
def test_a_row_speaks_of_atoms_of_ours(simulation, tmp_path, case, ours):
    row, facts, lines, message = case
    verdicts = {verdict for r, where, verdict in names_of_rows("stokes") if (r, where) == (row, facts)}
    assert verdicts
    # LAMMPS of today divides by the moment of inertia of one atom, 0, and loses the atoms of a rigid body with langevin
    # one time in six
    steps = 0 if row == "FIX addtorque" or "langevin" in message and row == "FIX rigid*" else 2
    error, warnings = said(simulation, tmp_path, lines(ours), steps)
    if ours or case in ANYWHERE:
        assert message in error if error else message in warnings, (error, warnings)
        assert ("ERROR" if error else "WARNING") in verdicts
    else:
        assert message not in warnings and not error, (error, warnings)


def test_every_row_has_a_case():
    tested = {case[:2] for case in CASES + ANYWHERE}
    told = [row for row in names_of_rows("stokes") if row[2] != "FINE"]
    assert {row[:2] for row in told} == tested | {("PAIR hybrid/scaled*", "0"), (PERTURBED, "ADDED | TURNING")}
    assert all(kind.split()[0] in KINDS for kind, _ in tested)


@pytest.mark.nothing_to_test_if(lammps_source(), "LAMMPS of 2021 has no compute born/matrix")
@pytest.mark.parametrize("added", [True, False], ids=["pair style", "fix"])
def test_a_compute_that_perturbs_adds_torques_of_the_pair_style_again(simulation, tmp_path, added):
    """It has f put back, but not torque."""
    ends = []
    for more in ("", "compute c all born/matrix numdiff 1e-6 thermo_press\nfix b all ave/time 1 1 1 c_c[1]"):
        lines = scene(TURN + " add_force yes" * added, boundary="p p p")
        lines += ["set group ours omega 1 2 3", "fix move ours nve/sphere"] + ["fix drag ours stokes_dynamics"] * (
            not added)
        log = tmp_path / "log"
        sim = simulation(log=log).commands(lines + more.splitlines()).run(4)
        ends.append(sim.atom("omega"))
        sim.command("log none")
        told = "compute c of style born/matrix computes forces once more in the same step" in log.read_text()
        assert told == (added and more != "")
    assert (abs(ends[0] - ends[1]).max() > 1e-3) == added


@pytest.mark.parametrize("factor, says", [
    ("1.0", ""), ("0.5", "scales forces of stokes_dynamics by 0.5"),
    ("v_half", "scales forces of stokes_dynamics by v_half")])
def test_a_hybrid_may_not_scale_the_forces(simulation, tmp_path, factor, says):
    lines = scene()
    at = lines.index(f"pair_style stokes_dynamics {WORDS} group ours")
    lines[at:at + 2] = ["variable half equal 1.0",
                        f"pair_style hybrid/scaled 1.0 zero 3.0 {factor} stokes_dynamics {WORDS} group ours",
                        "pair_coeff * * zero", "pair_coeff * * stokes_dynamics"]
    error, _ = said(simulation, tmp_path, lines + [OVERDAMPED])
    assert says in error if says else not error, error


def test_spheres_that_are_held_may_be_moved_and_need_no_force(simulation, tmp_path):
    lines = scene() + ["group one id 1", "fix a one move linear 0 0 1", "fix b one setforce 0 0 0",
                       f"{OVERDAMPED} held one"]
    error, warnings = said(simulation, tmp_path, lines)
    assert not error and "sets forces" not in warnings


FINE = {
    "a drag where nobody applies ours": scene() + ["fix b ours viscous 1", "fix move ours nve/sphere"],
    "a drag where ours is applied to others": scene() + ["group one id 1", "group two id 2",
                                                         "fix drag one stokes_dynamics", "fix b two viscous 1",
                                                         "fix move ours nve/sphere"],
    "forces set behind the fix that adds the drag": scene() + INERTIA.splitlines() + ["fix b ours setforce 0 0 0"],
    "forces set where the pair style adds the drag": scene(f"{WORDS} add_force yes")
    + ["fix b ours setforce 0 0 0", "fix move ours nve/sphere"],
    "spheres that are centred by the step of ab2": scene() + ["fix b ours recenter INIT INIT INIT", OVERDAMPED],
    "spheres that are centred beside midpoint": scene() + ["fix b ours recenter INIT INIT INIT", HALFWAY],
    "a wall that sees the step of midpoint": scene() + [HALFWAY, "fix b ours wall/reflect zlo -8"],
    "a wall before a step that it sees": scene() + ["fix b ours wall/reflect zlo -8", OVERDAMPED],
    "contacts damped before the fluid drags": scene(before=TODAY) + ["fix b ours damping/cundall 0.1 0.1"]
    + INERTIA.splitlines(),
    "forces scaled before the fluid drags": scene() + ["fix b ours ti/spring 1 1 1"] + INERTIA.splitlines(),
    "spheres pushed along their dipoles": prepared("set group ours dipole 1 0 0", words=TURN,
                                                   atoms="hybrid sphere dipole")(True)
    + ["fix b ours propel/self dipole 1"],
    "nve where nobody turns": scene() + ["fix drag ours stokes_dynamics", "fix move ours nve"],
    "rigid without langevin": scene() + ["fix drag ours stokes_dynamics", "fix b ours rigid single"],
    "spins that the fluid does not damp": scene(before=TODAY) + ["fix b ours viscous/sphere 1", *INERTIA.splitlines()],
    "asphere where nobody turns": scene(atoms=ELLIPSOID, before=ROUND)
    + ["fix b ours nve/asphere", "fix drag ours stokes_dynamics"],
    "addtorque on many": scene(TURN) + ["fix b ours addtorque 0 0 1", OVERDAMPED],
    "remap v with a fluid that goes with the box": scene(f"{WORDS} fluid_velocity box", boundary="p p p")
    + ["fix b all deform 1 xy erate 0.1 remap v", OVERDAMPED],
    "the pressure that LAMMPS prints unasked": scene() + [OVERDAMPED],
    "contacts without damping": paired(HOOKE.format(0, 0), "IJ NAME")(True),
    "pairs without friction": paired("dpd 2.5", "IJ NAME 0", before=TODAY)(True),
    "bonds without damping": bonded("bpm/spring", 0)(True),
    "dipoles where spheres turn": prepared("set group ours dipole 1 0 0", words=TURN,
                                           atoms="hybrid sphere dipole")(True),
    "dipoles of length 0": scene(atoms="hybrid sphere dipole") + [OVERDAMPED],
    "an ellipsoid that is a sphere": scene(atoms=ELLIPSOID, before=ROUND) + [OVERDAMPED],
    "clumps that touch": scene(before="set atom 1*2 mol 1\nset atom 2 x -4.05") +
    ["fix b all gravity 1 vector 0 0 -1", OVERDAMPED],
}


@pytest.mark.parametrize("what", FINE)
def test_what_goes_together_has_no_word(simulation, tmp_path, what):
    error, warnings = said(simulation, tmp_path, FINE[what])
    assert not error
    assert not re.findall("^.*(?:Fix|Pair style) stokes_dynamics.*: (?:fix|pair_style|atom_style|compute) .*", warnings,
                          re.M)


@pytest.mark.nothing_to_test_if(not lammps_source(),
                                "installed headers do not tell what fix gravity disable is, so that it is warned of")
def test_gravity_that_only_fix_rigid_knows_has_no_word(simulation, tmp_path):
    _, warnings = said(simulation, tmp_path, scene(before=OVERLAP) + ["fix b all gravity 1 vector 0 0 -1 disable",
                                                                      OVERDAMPED])
    assert "gravity pulls" not in warnings


def test_replicate_after_a_run_has_a_way_out(simulation, tmp_path):
    lines = scene(boundary="p p p") + ["unfix move", "run 0", "pair_style none", "replicate 2 1 1"]
    at = lines.index("unfix move")
    lines[at:at] = [OVERDAMPED, "run 1"]
    without = [line for line in lines if line != "pair_style none"]
    assert "Cannot replicate with fixes that store" in said(simulation, tmp_path, without)[0]
    lines += [f"pair_style stokes_dynamics {WORDS} group ours", "pair_coeff * *", OVERDAMPED]
    assert said(simulation, tmp_path, lines)[0] == ""


def test_who_looks_further_than_contacts_gets_a_list(simulation, tmp_path):
    further = ["compute near all coord/atom cutoff 4.0", "compute most all reduce max c_near",
               "thermo_style custom step c_most", OVERDAMPED]
    assert "cutoff is longer than pairwise cutoff" in said(simulation, tmp_path, scene() + further)[0]
    listed = "\n".join(scene()).replace("pair_style ", "pair_style hybrid/overlay zero 5.0 ").replace(
        "pair_coeff * *", "pair_coeff * * zero\npair_coeff * * stokes_dynamics").splitlines()
    assert said(simulation, tmp_path, listed + further)[0] == ""


def test_a_warning_is_given_once(simulation, tmp_path):
    log = tmp_path / "log"
    sim = simulation(log=log).commands(scene() + ["fix b ours setforce 0 0 0", OVERDAMPED]).run(2).run(2)
    sim.command("log none")
    assert log.read_text().count("sets forces") == 1


@pytest.mark.parametrize("case", [CASES[0], next(case for case in CASES if "gravity" in case[0])], ids=ids)
def test_two_ranks_say_the_same(tmp_path, case):
    """The group is on one rank only, and so is the clump."""
    error = dict(((row, where), verdict) for row, where, verdict in names_of_rows("stokes"))[case[:2]] == "ERROR"
    for ours in (True, False):
        finished = lmp(tmp_path, ["processors 2 1 1"] + case[2](ours) + ["run 1"], ranks=2,
                       succeed=not (ours and error))
        assert (case[3] in finished.text) == ours
        assert (finished.code != 0) == (ours and error)


def test_a_clump_across_ranks_overlaps(tmp_path):
    lines = scene(before="set atom 2*3 mol 7\nset atom 2 x -0.5\nset atom 3 x 0.5\nset atom 3 type 1\n"
                         "group ours type 1")
    finished = lmp(tmp_path, ["processors 2 1 1"] + lines + ["fix g all gravity 1 vector 0 0 -1", OVERDAMPED, "run 0"],
                   ranks=2)
    assert "in the clump of molecule 7 spheres overlap" in finished.text
