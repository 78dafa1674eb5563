"""One owner for each clump and one halo for each rank: no ghosts of LAMMPS are needed, images move with their box."""
import os
import re

import model
import numpy as np
import pytest
from host import allowed
from system import Spheres, chain, dump_lines, input_lines, largest_difference, lmp, read_dump, there

A, ETA = 0.8, 1.3
EXACT = f"visc {ETA} algorithm 2 relative_tolerance 1e-12"
COLUMNS = "x y z vx vy vz omegax omegay omegaz"
FORCES = "f_drag[1] f_drag[2] f_drag[3]"


def long_clumps(length):
    """Two chains that cross the faces of a box of 20, along x and askew, and lone spheres, all apart."""
    n = 7
    along = np.linspace(0.0, length, n)[:, None]
    x = np.vstack([(6.0, 1.0, -9.5) + along * (1.0, 0.0, 0.0), (-8.0, 6.0, -7.0) + along * np.array((0.0, 0.6, 0.8)),
                   (0.0, -6.0, 0.0), (-5.0, -3.0, 4.0)])
    return Spheres(x, 0.5, np.sin(np.arange(3 * len(x))).reshape(-1, 3), molecule=[3] * n + [7] * n + [0, 0])


def run(tmp_path, spheres, words, ranks, steps=0, columns=FORCES, **options):
    options = {"boundary": "p p p", "box": [(-10.0, 10.0)] * 3, **options}
    lines = input_lines(spheres, words, tmp_path / "data", **options)
    lmp(tmp_path, lines + dump_lines(tmp_path / "dump", every=max(steps, 1), columns=columns) + [f"run {steps}"],
        ranks=ranks)
    return read_dump(tmp_path / "dump")[-1][1]


@pytest.mark.parametrize("ranks", [1, 2, 3, 4])
def test_clumps_nearly_half_as_long_as_the_box_need_no_wider_ghosts(tmp_path, ranks):
    spheres = long_clumps(9.0)
    F = run(tmp_path, spheres, f"clumps_only yes {EXACT}", ranks)
    assert largest_difference(F, model.forces(spheres, ETA, sees=model.same_clump(spheres))) < 1e-10


WAYS = {"apart": "clumps_only yes rigid_clumps yes shell 12 visc 1.3",
        "films": "cut_off_distance inf rotation yes rigid_clumps yes "
        "lubrication yes relative_tolerance 1e-12 far_field_tolerance 1e-4 visc 1.3",
        "list": "cut_off_distance 7 taper wendland rotation yes rigid_clumps yes relative_tolerance 1e-13 visc 1.3"}


@pytest.mark.parametrize("way", WAYS)
def test_long_clumps_move_the_same_on_all_numbers_of_ranks(tmp_path, way):
    options = dict(fix=False, dt=0.02, comm="neigh_modify exclude molecule/intra all", columns=COLUMNS,
                   before_pair="fix pull all addforce 1.0 -2.0 30.0\nfix move all stokes_dynamics/overdamped", steps=10)
    ends = [run(tmp_path, long_clumps(9.0), WAYS[way], ranks, **options) for ranks in allowed(1, 2, 4)]
    assert np.abs(ends[0][:, 3:]).max() > 1.0
    for end in ends[1:]:
        d = end - ends[0]
        d[:, :3] -= 20 * np.round(d[:, :3] / 20)
        assert np.abs(d).max() < 1e-10 * max(1.0, np.abs(ends[0][:, 3:]).max())


def test_contacts_beside_clumps_with_films_and_many_ghosts(tmp_path):
    """In a hybrid style LAMMPS makes its buffers for what a sub-style says in time; ours wants none."""
    rng = np.random.default_rng(8)
    centres = np.array([(x, y, z) for x in (-7.6, -2.5, 2.5, 7.6) for y in (-7.5, -2.5, 2.5, 7.5)
                        for z in (-7.5, -2.5, 2.5, 7.5)])
    axis = rng.normal(size=centres.shape)
    axis /= np.linalg.norm(axis, axis=1)[:, None]
    x = np.vstack([centres - axis, centres + axis])
    spheres = Spheres(x, 1.0, molecule=np.tile(1 + np.arange(64), 2))
    style = ["pair_style hybrid/overlay gran/hooke/history 20.0 NULL 0 NULL 0.0 0 stokes_dynamics "
             "cut_off_distance inf visc 1.1 rotation yes rigid_clumps yes lubrication yes relative_tolerance 1e-11 "
             "far_field_tolerance 1e-6",
             "pair_coeff * * gran/hooke/history", "pair_coeff * * stokes_dynamics"]
    options = dict(fix=False, dt=0.01,
                   comm="comm_modify vel yes\nneighbor 6 bin\nneigh_modify exclude molecule/intra all",
                   columns=COLUMNS, steps=2,
                   before_pair="variable fx atom sin(id)\nfix pull all addforce v_fx 0 -6\n"
                               "fix move all stokes_dynamics/overdamped")
    one, two = (run(tmp_path, spheres, style, ranks, **options) for ranks in (1, 2))
    text = open(tmp_path / "log.test").read()
    assert int(float(re.search(r"Nghost: +([0-9.]+)", text).group(1))) > 6 * 60
    assert np.abs((one - two)[:, 3:]).max() < 1e-9 * np.abs(one[:, 3:]).max()


# --- boxes that shear with the fluid ----------------------------------------------------------------------------------

SHEARED = dict(boundary="p p p", box=[(0.0, 30.0)] * 3, tilt=(0.0, 0.0, 0.0), fix=False)
FLOW = "variable ux atom 0.2*z"
TIGHT = "relative_tolerance 1e-9 far_field_tolerance 1e-7 visc 0.05305 fluid_velocity v_ux 0 0"


def pair_at(z, apart, molecule):
    x = np.array([(15.0, 15.0, z), (15.0 + 0.6 * apart, 15.0, z + 0.8 * apart)])
    x[:, 2] %= 30.0
    return Spheres(x, 1.0, np.outer(0.2 * x[:, 2], (1.0, 0.0, 0.0)), molecule)


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("words", ["cut_off_distance inf", "clumps_only yes"])
def test_a_clump_across_a_sheared_face_turns_as_in_the_middle(tmp_path, words, ranks):
    ends = []
    for z in (15.0, 29.5):
        ends.append(run(tmp_path, pair_at(z, 2.0, 1), f"{words} rigid_clumps yes shell 12 " + TIGHT.replace(
            "far_field_tolerance 1e-7", "" if "only" in words else "far_field_tolerance 1e-7"), ranks, steps=20,
            columns="omegax omegay omegaz f_move[4] f_move[5] f_move[6]", dt=0.01,
                        comm="neigh_modify exclude molecule/intra all", before_pair=f"{FLOW}\n"
                        "fix move all stokes_dynamics/overdamped\nfix d all deform 1 xz erate 0.2 remap none flip yes",
            **SHEARED))
    assert abs(ends[0][0, 1]) > 0.05
    assert np.abs(ends[1] - ends[0]).max() < 1e-6


@pytest.mark.parametrize("ranks", [1, 2])
def test_a_clump_of_given_motion_across_a_sheared_face_feels_what_it_feels_in_the_middle(tmp_path, ranks):
    F = [run(tmp_path, pair_at(z, 2.0, 1), "clumps_only yes rigid_clumps yes shell 12 visc 1.3 fluid_velocity v_ux 0 0",
             ranks, before_pair=FLOW, comm="comm_modify vel yes\nfix d all deform 1 xz erate 0.2 remap v flip yes",
             **{**SHEARED, "fix": True})
         for z in (15.0, 29.5)]
    assert np.abs(F[0]).max() > 0.1
    assert np.abs(F[1] - F[0]).max() < 1e-9


@pytest.mark.parametrize("ranks", [1, 2])
def test_films_across_a_sheared_face_are_those_of_the_middle(tmp_path, ranks):
    F = [run(tmp_path, pair_at(z, 2.02, 0), f"cut_off_distance inf rotation yes lubrication yes algorithm 2 {TIGHT}",
             ranks, before_pair=FLOW, comm="comm_modify vel yes\nfix d all deform 1 xz erate 0.2 remap v flip yes",
             **{**SHEARED, "fix": True})
         for z in (15.0, 29.5)]
    assert np.abs(F[0]).max() > 0.5
    assert np.abs(F[1] - F[0]).max() < 1e-6


# --- which copies are above -------------------------------------------------------------------------------------------

@pytest.mark.parametrize("ranks", allowed(1, 2, 4))
@pytest.mark.parametrize("boundary", ["p p p", "p f f"])
def test_of_two_spheres_across_a_border_one_alone_has_the_other_above(tmp_path, boundary, ranks):
    """Where this is wrong, films across borders are in no factor or in two, and a run only takes longer."""
    plugin = there(os.path.join(os.environ["LAMMPS_PLUGIN_PATH"], "wrong", "haloabove.so"))
    log = lmp(tmp_path, [f"boundary {boundary}", "region box prism -6 6 -6 6 -6 6 2 0 0", "create_box 1 box",
                         "create_atoms 1 random 90 4 box", "mass 1 1", f"plugin load {plugin}",
                         "fix halo all test/halo 3"], ranks=ranks).log
    numbers = re.search(r"halo: (\d+) below, (\d+) above, (\d+) wrong", log).groups()
    below, above, wrong = (int(number) for number in numbers)
    assert below == above > 20 and wrong == 0


# --- lists and copies that are kept -----------------------------------------------------------------------------------

KEPT = "cut_off_distance inf visc 1.3 multiblob 12 lubrication yes relative_tolerance 1e-10 far_field_tolerance 1e-8"
EVENTS = {"none": [], "fewer": ["group gone id 4 15 26", "delete_atoms group gone"],
          "sorted": ["atom_modify sort 1 1.0"], "box": ["change_box all x scale 0.93"],
          "moved": ["displace_atoms all random 0.4 0.4 0.4 77"], "larger": ["set atom 5 diameter 1.8"]}


@pytest.mark.parametrize("event", EVENTS)
def test_velocities_are_those_of_lists_made_anew(tmp_path, event):
    """Steps in which lists are kept and made anew, copies come and go, and something happens between two runs."""
    rng = np.random.default_rng(2)
    grid = np.array([(x, y, z) for x in range(3) for y in range(3) for z in range(3)])
    spheres = Spheres(3.0 * grid - 3.0 + rng.uniform(-0.4, 0.4, size=(27, 3)), 0.7)
    lines = input_lines(spheres, KEPT, tmp_path / "data", boundary="p p p", box=[(-4.5, 4.5)] * 3, fix=False, dt=0.05,
                        comm="neighbor 0.5 bin\nvariable f atom 9*sin(7*id)",
                        before_pair="fix pull all addforce v_f -6 4\nfix move all stokes_dynamics/overdamped")
    lines += ["run 10"] + EVENTS[event] + ["run 0"]
    style = ["pair_style none", f"pair_style stokes_dynamics {KEPT}", "pair_coeff * *"]
    for k, anew in enumerate(([], style + ["run 0"])):
        lines += anew + [f"write_dump all custom {tmp_path}/v{k} id {COLUMNS} modify sort id format float %.17g"]
    for ranks in allowed(*((1, 2, 4) if event == "none" else (2,))):
        lmp(tmp_path, lines, ranks=ranks)
        kept, anew = (read_dump(tmp_path / f"v{k}")[-1][1] for k in range(2))
        assert np.abs(kept[:, :3] - spheres.x[:len(kept)]).max() > 0.3 and np.abs(kept[:, 3:]).max() > 0.3
        assert np.abs(anew - kept).max() < 1e-8 * np.abs(kept[:, 3:]).max()


# --- what a run may get wrong -----------------------------------------------------------------------------------------

@pytest.mark.parametrize("words", ["clumps_only yes rigid_clumps yes visc 1.3",
                                   "cut_off_distance inf rotation yes rigid_clumps yes visc 1.3"])
def test_a_rigid_clump_whose_radii_change_is_not_rigid(tmp_path, words):
    motion = "fix move all stokes_dynamics/overdamped" if "inf" in words else ""
    lines = input_lines(chain(3, 2 * A, a=A), words, tmp_path / "data", fix=not motion, dt=1e-3,
                        before_pair=f"variable d equal 1.6+0.01*step\n{motion}\nfix grow all adapt 1 atom diameter v_d")
    lines[1] = "atom_style hybrid sphere 1 bond"
    ended = lmp(tmp_path, lines + ["run 5"], succeed=False)
    assert ended.code != 0 and "the clump of molecule 1 is not rigid" in ended.text


@pytest.mark.parametrize("ranks", [1, 2])
@pytest.mark.parametrize("words, named", [("cut_off_distance 3200 visc 1.3", "keyword cut_off_distance: '3200'"),
                                          ("cut_off_distance inf rotation yes lubrication yes visc 1.3", "radius")])
def test_images_without_end_are_a_question_of_units(tmp_path, words, named, ranks):
    spheres = Spheres([(-6.0, 0, 0), (3.0, 2.0, 0)], [0.7, 1e5 if "inf" in words else 0.7], (0, 0, 0.1))
    lines = input_lines(spheres, words, tmp_path / "data", boundary="p p p", box=[(-9.0, 9.0)] * 3)
    ended = lmp(tmp_path, lines + ["run 0"], ranks=ranks, succeed=False)
    assert ended.code != 0 and named in ended.text and "is it in other units?" in ended.text


def test_a_giant_among_clumps_apart_has_no_ghosts(tmp_path):
    spheres = Spheres([(-6.0, 0, 0), (3.0, 2.0, 0)], [1000.0, 0.7], (0, 0, 0.1), molecule=[0, 0])
    F = run(tmp_path, spheres, f"clumps_only yes {EXACT}", 1, box=[(-9.0, 9.0)] * 3)
    assert F[:, 2] == pytest.approx(-6 * np.pi * ETA * spheres.a * 0.1, rel=1e-12)
