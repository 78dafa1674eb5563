"""A box that fix deform changes: the flow that takes it along (fluid_velocity box), spheres that cross its faces
without inertia, which remap goes with which motion."""
import numpy as np
import pytest

import model
from system import LammpsError, Spheres, dump_lines, from_restart, input_lines, lmp, read_dump
from test_loading import lammps_source

P6 = 6 * np.pi
FIX = "fix move all stokes_dynamics/overdamped"
BOX = [(-3.0, 7.0), (1.0, 11.0), (-5.0, 6.0)]


def edges(sim):
    """The edges of the box as columns, and its lower corner"""
    lo, hi, xy, yz, xz = sim.lmp.extract_box()[:5]
    (lx, ly, lz) = np.array(hi) - lo
    return np.array([[lx, xy, xz], [0, ly, yz], [0, 0, lz]]), np.array(lo)


STYLES = {"shear": "xy erate 0.7", "two shears": "xz vel 2.1 yz erate -0.3",
          "extension": "x erate 0.4 y erate -0.2 z vel 0.8",
          "final": "x final -4 9 xy final 2.5", "delta": "y delta -0.3 0.7 yz delta 1.5", "scale": "z scale 1.4",
          "trate": "x trate 0.5 z trate -0.4 xy trate 0.9", "wiggle": "z wiggle 1.3 0.7 xz wiggle 0.8 0.9",
          "volume of one": "x erate 0.4 y volume", "volume of two": "x trate 0.4 y erate 0.2 z volume",
          "two by volume": "x erate 0.4 y volume z volume", "variable": "x variable v_d v_r xy variable v_d v_r"}


@pytest.mark.parametrize("style", STYLES)
def test_the_fluid_goes_with_the_box(simulation, style):
    """u = dH/dt s + d lo/dt at fractions s of the edges H: against the box one step before and one after."""
    eta, a, dt, N = 1.3, 0.7, 1e-4, 40
    x = np.array([(0.3, 2.1, -1.7), (5.0, 9.2, 4.4), (1.0, 6.0, 0.0)])
    sim = simulation(Spheres(x, a), f"cut_off_distance 3 visc {eta} fluid_velocity box rotation yes", fix=False,
                     box=BOX, tilt=(0.5, -0.4, 0.6), boundary="p p p", dt=dt, comm="comm_modify vel yes")
    sim.commands("variable d equal 0.3*sin(5*elaplong*dt)\nvariable r equal 1.5*cos(5*elaplong*dt)\n"
                 "fix drag all stokes_dynamics apply no\n"
                 f"fix d all deform 1 {STYLES[style]} remap v units box")
    seen = []
    for n in range(3):
        sim.run(N - 1 if n == 0 else 1, f"start 0 stop 100")
        seen.append((*edges(sim), sim.drag / (P6 * eta * a), sim.fix_rows()[:, 6:9] / (8 * np.pi * eta * a**3)))
    rate, corner_rate = ((seen[2][k] - seen[0][k]) / (2 * dt) for k in (0, 1))
    H, lo, u, spin = seen[1]
    expected = np.linalg.solve(H, (x - lo).T).T @ rate.T + corner_rate
    assert np.abs(expected).max() > 0.1
    assert np.abs(u - expected).max() < 1e-6 * np.abs(expected).max()
    G = rate @ np.linalg.inv(H)
    half_curl = 0.5 * np.array([G[2, 1] - G[1, 2], G[0, 2] - G[2, 0], G[1, 0] - G[0, 1]])
    assert np.abs(spin - half_curl).max() < 1e-6 * np.abs(G).max()


# whether the volume changes; two opposite erate keep it in the first step alone
VOLUMES = {"extension": True, "trate": True, "shear": False, "volume of one": False, "volume of two": False,
           "two by volume": False}
MORE = {"opposite rates": ("x erate 0.4 y erate -0.4", True),
        "opposite true rates": ("x trate 0.4 y trate -0.4", False)}


@pytest.mark.parametrize("style, changes", [(STYLES[name], changes) for name, changes in VOLUMES.items()] +
                         list(MORE.values()), ids=[*VOLUMES, *MORE])
def test_a_fluid_that_follows_a_volume_that_changes_is_told_once(simulation, tmp_path, style, changes):
    log = tmp_path / "log"
    sim = simulation(cloud(), "clumps_only yes visc 1.3 fluid_velocity box", fix=False, box=BOX, log=log,
                     tilt=(0.5, -0.4, 0.6), boundary="p p p", dt=1e-3, comm="comm_modify vel yes")
    sim.commands(f"{FIX}\nfix d all deform 1 {style} remap v units box").run(300).run(3)
    sim.close()
    said = log.read_text().count("keyword fluid_velocity: fix d of style deform changes the volume of the box, by ")
    assert said == changes


def cloud():
    """Three spheres; each is pulled another way, through all faces"""
    return Spheres([(0, 3, 0), (5.5, 5.5, 3.3), (2.0, 9.0, -3.0)], [1.0, 0.6, 0.8])


FLOWS = {"box": "fluid_velocity box", "formula": "fluid_velocity v_ux 0 0"}
PULL = "variable fy atom 25*(id-2)-20\nvariable fz atom -12*id\nfix pull all addforce 3.0 v_fy v_fz\n"


def sheared(flow, dt, rate=0.4, remap="v", tolerance=1e-6, style=""):
    words = f"cut_off_distance inf visc 1 far_field_tolerance {tolerance} {FLOWS[flow]} {style}"
    lines = (words, dict(fix=False, box=BOX, tilt=(0.0, 0.0, 0.0), boundary="p p p", dt=dt, comm="comm_modify vel yes",
                         before_pair=f"variable ux atom {rate}*(y-1.0)"))
    return lines, PULL + f"{FIX}\nfix d all deform 1 xy erate {rate} remap {remap} flip yes"


def path(simulation, flow, dt, t=5.0, remap="v", style=""):
    (words, options), commands = sheared(flow, dt, remap=remap, style=style)
    sim = simulation(cloud(), words, **options)
    sim.commands(commands).run(round(t / dt))
    return sim


def up_to_images(d, H):
    """A difference of places, less what edges of the box it holds"""
    s = np.linalg.solve(H, d.T).T
    return (s - np.round(s)) @ H.T


SHELLS = "multiblob 12 lubrication yes relative_tolerance 1e-8"


@pytest.mark.parametrize("style", ["", SHELLS], ids=["points", "shells"])
def test_ab2_is_of_second_order_through_sheared_faces(simulation, style):
    """Three spheres that interact, through faces and flips of the box: differences of paths fall with the square of the
    step."""
    ends = []
    for dt in (0.1, 0.05, 0.025):
        sim = path(simulation, "box", dt, style=style)
        ends.append(sim.x)
        H, _ = edges(sim)
    assert (np.abs(sim.atom("image") - (512 << 20 | 512 << 10 | 512)) > 0).any()
    coarse, fine = (np.abs(up_to_images(ends[k + 1] - ends[k], H)).max() for k in (0, 1))
    assert fine < 5e-3
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.25)


def test_a_clump_without_load_goes_with_the_sheared_flow(simulation):
    """A dumbbell along the axis of the vorticity keeps its height: in every step its centroid goes with the fluid
    there, also where that is far from the origin and the clump has crossed faces. ab2 then adds nothing to the velocity
    of now."""
    dt, rate, steps = 0.1, 0.4, 60
    x = np.array([(4.5, 8.0, 0.0), (4.5, 8.0, 2.0)])
    sim = simulation(Spheres(x, molecule=1), "clumps_only yes visc 1 rigid_clumps yes rotation yes fluid_velocity box",
                     fix=False, box=BOX, tilt=(0.0, 0.0, 0.0), boundary="p p p", dt=dt, comm="comm_modify vel yes")
    sim.commands(f"{FIX}\nfix d all deform 1 xy erate {rate} remap v flip yes").run(steps)
    carried = x + np.array([rate * (8.0 - 1.0) * dt * steps, 0.0, 0.0])
    assert carried[0, 0] > BOX[0][1] + 10.0
    assert np.abs(up_to_images(sim.x - carried, edges(sim)[0])).max() < 1e-9


def test_box_and_formula_and_either_remap_are_one_flow(simulation):
    sim = path(simulation, "box", 0.05)
    first = sim.x, sim.v
    for flow, remap in (("formula", "v"), ("box", "none")):
        sim = path(simulation, flow, 0.05, remap=remap)
        assert np.abs(sim.x - first[0]).max() < 1e-9 and np.abs(sim.v - first[1]).max() < 1e-9


def test_velocities_and_box_are_of_one_moment(simulation):
    """What a run ends with is what a new run begins with, though the box has changed in its last step."""
    sim = path(simulation, "box", 0.05, t=1.0)
    v = sim.v
    sim.run(0, "start 0 stop 100")
    assert np.abs(sim.v - v).max() < 1e-10 * np.abs(v).max()


@pytest.mark.parametrize("ranks, style", [(1, ""), (3, ""), (1, SHELLS + " max_iter 200"),
                                          (2, SHELLS + " max_iter 200")])
def test_a_sheared_run_in_pieces_on_any_ranks_is_the_run_in_one(tmp_path, ranks, style):
    def script(runs, restart=False):
        (words, options), commands = sheared("box", 0.05, style=style.replace("1e-8", "1e-12"))
        lines = input_lines(cloud(), words, str(tmp_path / "data"), **options)
        if restart:
            lines = from_restart(lines)
        return lines + commands.splitlines() + dump_lines(tmp_path / "end", every=60,
                                                          columns="xu yu zu f_move[1] f_move[2] f_move[3]") + runs

    def last():
        return read_dump(tmp_path / "end")[-1][1]

    lmp(tmp_path, script(["run 60"]), 1)
    whole = last()
    assert np.abs(whole).max() > 1
    lmp(tmp_path, script(["run 37", "write_restart half.restart", "run 23"]), ranks)
    assert np.abs(last() - whole).max() < 1e-10 * np.abs(whole).max()
    lmp(tmp_path, script(["run 23"], restart=True), ranks)
    assert np.abs(last() - whole).max() < 1e-10 * np.abs(whole).max()


def test_the_box_flips_in_the_step_after_half_an_edge(simulation, tmp_path):
    """Not when LAMMPS re-neighbours for another reason: noise is that of the box as it is, and a run in pieces that of
    the run in one."""
    (words, options), commands = sheared("box", 0.05, rate=0.41)
    sim = simulation(cloud(), words, **options).commands(commands)
    sim.commands(["neigh_modify delay 100 every 100", "variable tilt equal xy",
                  f"fix tell all print 1 '${{tilt}}' file {tmp_path}/tilts"]).run(28)
    tilts = np.loadtxt(tmp_path / "tilts")
    steps = np.arange(len(tilts)) + 28 - len(tilts) + 1
    expected = 0.41 * 0.05 * 10 * steps
    assert tilts == pytest.approx(np.where(steps > 25, expected - 10, expected), abs=1e-4) and expected[steps == 25] > 5


SHEAR = "fix d all deform 1 xy erate 0.1 remap"


@pytest.mark.parametrize("fluid, motion, line, message", [
    ("box", FIX, f"{SHEAR} x",
     "fix d of style deform: remap x moves the spheres with the box, and the fluid carries them as well"),
    ("v_ux 0 0", FIX, "fix d all deform 1 xy erate 0.1",
     "fix d of style deform: remap x moves the spheres with the box"),
    ("box", "fix drag all stokes_dynamics\nfix move all nve/sphere", f"{SHEAR} none",
     "needs the velocity of its image"),
    ("v_ux 0 0", "fix drag all stokes_dynamics\nfix move all nve/sphere", f"{SHEAR} none", "use remap v"),
    ("0 0 0 rigid_clumps yes rotation yes", FIX, f"{SHEAR} x", "remap x moves the spheres of a rigid clump apart"),
    ("box", FIX + " adapt 1 1e-3 1 0.1", f"{SHEAR} v", "fix d of style deform counts its rate"),
])
def test_what_a_box_that_moves_does_not_go_with_is_named(simulation, fluid, motion, line, message):
    sim = simulation(cloud(), f"cut_off_distance inf visc 1 fluid_velocity {fluid}", fix=False, box=BOX,
                     tilt=(0.0, 0.0, 0.0), boundary="p p p", dt=0.01, comm="comm_modify vel yes",
                     before_pair="variable ux atom 0.1*y")
    with pytest.raises(Exception, match=message):
        sim.commands(motion).commands(line).run(1)


@pytest.mark.nothing_to_test_if(lammps_source(), "LAMMPS of 2021 has no fix deform/pressure")
def test_a_box_of_whose_motion_only_its_fix_knows_is_named(simulation):
    def sheared(fluid):
        sim = simulation(cloud(), f"cut_off_distance inf visc 1 fluid_velocity {fluid}", fix=False, box=BOX,
                         tilt=(0.0, 0.0, 0.0), boundary="p p p", dt=0.01)
        return sim.commands([FIX, "fix d all deform/pressure 1 xy erate 0.1 remap none"])

    sheared("0 0 0").run(1)
    with pytest.raises(LammpsError, match="Pair style stokes_dynamics: fix d of style deform/pressure: its rates are "
                                          "not known to the pair style: use fix deform, or fluid_velocity 0 0 0"):
        sheared("box").run(1)


@pytest.mark.parametrize("rigid", ["rigid/small", "rigid"])
@pytest.mark.parametrize("style", ["rigid_clumps yes rotation yes", "multiblob 12"])
def test_rigid_bodies_with_inertia_do_not_cross_faces_that_are_sheared(simulation, style, rigid):
    """LAMMPS gives a body one velocity, also on the other side of a face. Across a face whose images do not move it is
    right."""
    def dumbbell(edge, x, v=0.0):
        places = np.array([(1.5, 2.5, 3.5), (1.5, 2.5, 3.5)])
        places[:, edge] = (x, x + 1.9)
        lo, hi = np.array(BOX).T
        images = np.floor((places - lo) / (hi - lo)).astype(int)
        spheres = Spheres(places - images * (hi - lo), v=[v * (edge == d) for d in range(3)], molecule=1)
        sim = simulation(spheres, f"cut_off_distance inf visc 1 fluid_velocity box add_force yes {style}", fix=False,
                         box=BOX, tilt=(0.0, 0.0, 0.0), boundary="p p p", dt=1e-3, comm="comm_modify vel yes cutoff 5\n"
                         "neigh_modify delay 0 every 1 check no")
        sim.commands([f"set atom {i + 1} image {a} {b} {c}" for i, (a, b, c) in enumerate(images)])
        return sim.commands(["thermo_style custom step", f"fix bodies all {rigid} molecule", f"{SHEAR} v"])

    hi = [edge[1] for edge in BOX]
    lying = dumbbell(0, hi[0] - 1.0).run(2).f
    assert np.abs(dumbbell(0, hi[0] - 4.0).run(2).f - lying).max() < 1e-2 * np.abs(lying).max()
    for x, v, step in ((hi[1] - 1.0, 0.0, "0"), (hi[1] - 1.92, 30.0, "[1-9]")):
        with pytest.raises(Exception,
                           match=f"fix bodies of style {rigid}: step {step}: atom 2 has crossed a face of the box"):
            dumbbell(1, x, v).run(20)


@pytest.mark.parametrize("motion", [FIX + " held one", "fix drag all stokes_dynamics"])
def test_a_sphere_that_fix_move_moves_does_not_cross_faces_that_are_sheared(simulation, motion):
    """Its velocity stays that of the first image, while its place becomes that of another one."""
    for axis, crosses in (("0 30 0", True), ("30 0 0", False)):
        sim = simulation(Spheres([(6.9, 10.9, 0.0), (2.0, 3.0, 1.0)]), "cut_off_distance inf visc 1 fluid_velocity box",
                         fix=False, box=BOX, tilt=(0.0, 0.0, 0.0), boundary="p p p", dt=1e-2,
                         comm="comm_modify vel yes\nneigh_modify delay 0 every 1 check no")
        sim.commands(["group one id 1", f"velocity one set {axis}", f"fix go one move linear {axis}", motion,
                      f"{SHEAR} v"])
        if not crosses:
            sim.run(5)
            continue
        with pytest.raises(Exception, match="fix go of style move: step [1-5]: atom 1 has crossed a face of the box"):
            sim.run(5)


def test_a_fluid_at_rest_allows_compression(simulation):
    """remap x with fluid_velocity 0 packs spheres; the box alone takes them along."""
    sim = simulation(cloud(), "cut_off_distance inf visc 1", fix=False, box=BOX, boundary="p p p", dt=0.01)
    before, (H, lo) = sim.x, edges(sim)
    sim.commands(f"{FIX}\nfix d all deform 1 x scale 0.8 y scale 0.9 remap x").run(10)
    after, (K, corner) = sim.x, edges(sim)
    assert np.abs(np.linalg.solve(H, (before - lo).T) - np.linalg.solve(K, (after - corner).T)).max() < 1e-12


def test_vorticity_of_the_box_is_not_given_twice(simulation):
    with pytest.raises(Exception, match="keyword fluid_vorticity: fluid_velocity box has a vorticity of its own"):
        simulation(cloud(), "cut_off_distance inf visc 1 rotation yes fluid_velocity box fluid_vorticity 0 0 1",
                   fix=False, box=BOX)


def test_a_formula_that_does_not_follow_the_box_is_told(simulation, tmp_path):
    """Half the rate of the box: the jump at a face is not that of the images."""
    for rate, told in ((0.1, False), (0.05, True)):
        lines = input_lines(cloud(), "cut_off_distance inf visc 1 fluid_velocity v_ux 0 0", str(tmp_path / "data"),
                            fix=False, box=BOX, tilt=(0.0, 0.0, 0.0), boundary="p p p", dt=0.01,
                            comm="comm_modify vel yes", before_pair=f"variable ux atom {rate}*y")
        assert ("does not have the period of the box" in lmp(tmp_path,
                                                             lines + [FIX, f"{SHEAR} v", "run 2"]).log) == told
