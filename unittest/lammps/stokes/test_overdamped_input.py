"""fix stokes_dynamics/overdamped beside other commands: what leaves it alone, and what does not go with it."""
import re

import numpy as np
import pytest

from neighbour_tables import PACKAGE
from system import Spheres
from test_overdamped_clumps import doublet_and_sphere
from without_inertia import ALL, COMM, FIX, THREE, chains, cloud, weight


@pytest.mark.parametrize("other", ["temp/rescale 1 1 1 0.01 1", "temp/berendsen 1 1 1", "momentum 1 linear 1 1 1"])
def test_who_writes_to_v_does_not_steer(simulation, other):
    """v is output: thermostats and fix momentum change what is printed, not the path, and not the step of adapt."""
    ends = []
    for line in ("", f"fix other all {other}"):
        sim = simulation(cloud(8), ALL, fix=False, box=[(-30.0, 30.0)] * 3, dt=0.05)
        sim.commands(weight(THREE)).commands(line).commands(f"{FIX} adapt 1 1e-3 0.5 0.05").run(20)
        ends.append(sim.x)
    assert np.abs(ends[0][:, 2] - cloud(8).x[:, 2]).max() > 0.5
    assert (ends[1] == ends[0]).all()


def test_other_atoms_may_be_integrated_otherwise(simulation):
    sim = simulation(THREE, "cut_off_distance inf visc 1 group slow", fix=False, box=[(-20.0, 20.0)] * 3, dt=0.01,
                     before_pair="group slow id 1 2\ngroup fast id 3\nvelocity fast set 1 0 0")
    sim.commands(
        "fix other fast nve/sphere\nfix move slow stokes_dynamics/overdamped\nfix pull slow addforce 0 0 -1").run(10)
    assert sim.v[2] == pytest.approx((1, 0, 0)) and sim.v[0, 2] < -0.05


@pytest.mark.parametrize("lines, message", [
    ("fix other all nve/sphere", "fix other of style nve/sphere integrates spheres that fix"),
    ("fix other all nve", "fix other of style nve integrates spheres that fix"),
    ("fix other all nvt temp 1 1 1", "fix other of style nvt integrates spheres that fix"),
    ("fix other all rigid single", "fix other of style rigid integrates spheres that fix"),
    ("fix other all rigid/small molecule", "fix other of style rigid/small integrates spheres that fix"),
    ("fix other all viscous 1.0", "fix other of style viscous adds a drag to spheres"),
    ("fix other all langevin 1 1 1 4711", "fix other of style langevin adds a drag to spheres"),
    ("fix other all stokes_dynamics", "fix other of style stokes_dynamics cannot apply"),
    ("fix other all stokes_dynamics apply yes", "fix other of style stokes_dynamics cannot apply"),
    ("fix other all stokes_dynamics/overdamped",
     "fix other of style stokes_dynamics/overdamped integrates spheres that fix"),
    ("pair_style stokes_dynamics cut_off_distance inf visc 1 add_force yes\npair_coeff * *",
     "keyword add_force .* must be no"),
    ("pair_style stokes_dynamics cut_off_distance inf visc 1 update_every 3\npair_coeff * *",
     "update_every .* must be 1, not 3"),
    ("pair_style stokes_dynamics clumps_only yes visc 1 rigid_clumps auto rotation yes\npair_coeff * *",
     "yes or no, not auto"),
    ("pair_style stokes_dynamics clumps_only yes visc 1 rigid_clumps yes\npair_coeff * *",
     "requires rotation yes or a shell"),
    ("pair_style stokes_dynamics cut_off_distance 8 visc 1\npair_coeff * *",
     "cut_off_distance: '8' of pair_style .* leaves out flows"),
    ("pair_style none", "there is no pair_style stokes_dynamics"),
    ("run_style respa 2 2", "respa"),
    ("group some id 1\npair_style stokes_dynamics cut_off_distance inf visc 1 group some\npair_coeff * *",
     "atom 2 is selected either by the group of this fix or by pair_style stokes_dynamics"),
    ("comm_modify vel yes\npair_style hybrid/overlay gran/hooke/history 10 NULL 0.3 NULL 0 0 stokes_dynamics "
     "cut_off_distance inf visc 1\n"
     "pair_coeff * * gran/hooke/history\npair_coeff * * stokes_dynamics",
     "pair_style gran/hooke/history damps its contacts .gamma 0.3"),
    ("comm_modify vel yes\npair_style hybrid/overlay gran/hooke 10 NULL 0.3 0.1 0 1 stokes_dynamics "
     "cut_off_distance inf visc 1\n"
     "pair_coeff * * gran/hooke\npair_coeff * * stokes_dynamics", "pair_style gran/hooke damps its contacts"),
])
def test_what_does_not_go_with_it_is_named(simulation, lines, message):
    sim = simulation(chains(2), ALL, fix=False, box=[(-40.0, 40.0)] * 3, dt=0.01, comm=COMM)
    sim.commands(FIX)
    with pytest.raises(Exception, match=message):
        sim.commands(lines).run(1)


@pytest.mark.parametrize("words", ["cut_off_distance inf visc 1", "clumps_only yes visc 1",
                                   "cut_off_distance inf visc 1 multiblob 12"])
@pytest.mark.parametrize("more", ["", " temperature 1 77"])
def test_a_force_that_is_no_number_is_told_with_its_atom(simulation, words, more):
    sim = simulation(Spheres([[0, 0, 0], [3, 0, 0], [0, 3, 0]]), words, fix=False, box=[(-20.0, 20.0)] * 3, dt=0.01)
    sim.commands(f"variable big atom 1e200^(1+(id==3))\nfix odd all addforce v_big 0 0\n{FIX}{more}")
    with pytest.raises(Exception, match="step 0: the force or torque on atom 3 is not a finite number"):
        sim.run(1)


def test_it_cannot_be_minimised(simulation):
    sim = simulation(doublet_and_sphere(), ALL, fix=False, box=[(-20.0, 20.0)] * 3, dt=0.01, comm=COMM)
    sim.commands(FIX)
    with pytest.raises(Exception, match="cannot be minimised|minimize cannot be used"):
        sim.command("minimize 0 1e-3 10 10")


@pytest.mark.parametrize("words, message", [
    ("scheme rk4", "Fix stokes_dynamics/overdamped: keyword scheme: 'rk4'"),
    ("scheme", "keyword scheme"),
    ("adapt 0 1 2 3", "keyword adapt: '0' must be >= 1"),
    ("adapt 1 -1 2 3", "keyword adapt: '-1' must be > 0"),
    ("adapt 1 2 1 3", "keyword adapt: tmin '2' must not be above tmax '1'"),
    ("adapt 1 2 3", "keyword adapt: value missing: xmax"),
    ("temperature", "keyword temperature: value missing: T"),
    ("temperature 1", "keyword temperature: value missing: seed"),
    ("temperature v_T", "keyword temperature: value missing: seed"),
    ("spin all 0 1", "keyword spin: value missing after '1'"),
    ("adapt 1 1 2 nan", "keyword adapt: 'nan'"),
    ("rigid yes", "unknown keyword 'rigid'; those that there are: scheme, adapt, held, pin, spin, squirm, torque, "
                  "temperature, noise_tolerance"),
    ("visc 1", "unknown keyword 'visc': it is a keyword of pair_style stokes_dynamics"),
    ("scheme ab2 scheme euler", "keyword scheme"),
])
def test_bad_words(simulation, words, message):
    sim = simulation(doublet_and_sphere(), ALL, fix=False, box=[(-20.0, 20.0)] * 3, dt=0.01, comm=COMM)
    with pytest.raises(Exception, match=message):
        sim.commands(f"{FIX} {words}")


def keywords_of(page):
    """The first column of the tables below Syntax"""
    syntax = (PACKAGE / "doc" / page).read_text().split("## Syntax\n")[1].split("\n## ")[0]
    return sorted(set(re.findall(r"^\| `(\w+)` \|", syntax, re.M)))


@pytest.mark.parametrize("page, command, owner", [
    ("fix_stokes_dynamics_overdamped.md", f"pair_style stokes_dynamics {ALL}", "fix stokes_dynamics/overdamped"),
    ("pair_stokes_dynamics.md", FIX, "pair_style stokes_dynamics")])
def test_a_keyword_of_the_other_command_is_sent_there(simulation, page, command, owner):
    sim = simulation(doublet_and_sphere(), ALL, fix=False, box=[(-20.0, 20.0)] * 3, dt=0.01, comm=COMM)
    words = keywords_of(page)
    assert len(words) > 8
    for word in words:
        with pytest.raises(Exception, match=f"unknown keyword '{word}': it is a keyword of {owner}"):
            sim.command(f"{command} {word} 1")


@pytest.mark.parametrize("k, told", [(11000, True), (90000, True), (2000, False)])
def test_steps_that_are_too_long_are_told_before_an_atom_is_lost(simulation, tmp_path, k, told):
    """A sphere at a spring k: in a step of dt k/(6 pi eta a) = 1.17 its displacement grows by 1.2 in every step, with
    9.5 by 14; it must be told while the sphere is still in the box. With 0.21 it comes to rest."""
    log = tmp_path / "log"
    sim = simulation(log=log).commands([
        "atom_style sphere", "boundary f f f", "plugin load stokesdynplugin.so", "region box block 0 12 0 12 0 12",
        "create_box 1 box", "create_atoms 1 single 6 6 6", "set group all diameter 1",
        f"pair_style stokes_dynamics {ALL}", "pair_coeff * *", "timestep 0.001",
        FIX, f"fix spring all spring/self {k}", "run 0", "displace_atoms all move 1e-6 0 0", "thermo 1"])
    try:
        sim.run(100)
    except Exception as lost:
        assert told and "Lost atoms" in str(lost)
    sim.command("log none")
    assert ("the change of velocities grows from step to step" in log.read_text()) == told


def test_springs_with_a_largest_force_do_not_hide_long_steps(simulation, tmp_path):
    """A force of constant size towards x = 6 throws a sphere from side to side: the change of its velocity does not
    grow."""
    log = tmp_path / "log"
    sim = simulation(log=log).commands([
        "atom_style sphere", "boundary f f f", "plugin load stokesdynplugin.so", "region box block 0 12 0 12 0 12",
        "create_box 1 box", "create_atoms 1 single 6 6 6", "set group all diameter 1",
        f"pair_style stokes_dynamics {ALL}", "pair_coeff * *", "timestep 0.001",
        FIX, "variable f atom 4000*(x<6)-4000*(x>6)", "fix spring all addforce v_f 0 0",
        "displace_atoms all move 0.01 0 0"])
    sim.run(60).command("log none")
    assert "or stays large" in log.read_text()
