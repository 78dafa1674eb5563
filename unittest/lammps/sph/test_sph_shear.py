"""Shear between images of the box that glide (Lees & Edwards 1972): fix deform with remap v."""
import numpy as np
import pytest

from sph_tools import by_id, mpirun, read_dump, run, start
from test_sph_input import message

RATE, H = 0.02, 16.0
SCENE = """
    units lj
    dimension 2
    boundary p p p
    atom_style sph
    lattice sq 1
    region b prism 0 16 0 16 -0.5 0.5 0 0 0
    create_box 1 b
    create_atoms 1 box
    mass 1 1
    set group all sph/rho 1
    variable vx atom {start}*(y-8)
    velocity all set v_vx {drift} 0
    neighbor 0.4 bin
    neigh_modify delay 0 every 1
    pair_style sph/artVisc/tensCorr wendland 2.0 {terms}
    pair_coeff * * c 10
    fix p all sph/pressure Tait 14.2857 1 7
    fix d all sph/density/continuity
    fix i all {integrator}
    fix e all enforce2d
    fix x all deform 1 xy erate 0.02 remap v
    timestep 0.02
    """
VISCOUS = dict(terms="viscosity 1.0", integrator="nve/sph", drift=0, start=0)


@pytest.mark.parametrize("drift", [0, 0.2])
def test_gliding_faces_drive_the_flow(drift):
    """Fluid at rest is taken along from the faces, mode k of the sawtooth RATE (y - 8) at the rate nu (2 pi k / H)^2.
    The Laplacian has 0.97 of the nominal viscosity at h = 2 spacings. With a drift of 0.2 particles change sides all
    the time: ten spacings."""
    lmp = start()
    try:
        run(lmp, SCENE.format(**dict(VISCOUS, drift=drift)) + "run 0")
        for steps in (200, 2300):
            run(lmp, "run %d" % steps)
            t = lmp.extract_global("ntimestep") * 0.02
            y = by_id(lmp, "x", 3)[:, 1]
            deviation = by_id(lmp, "v", 3)[:, 0] - RATE * (y - H / 2)
            # The sawtooth moves with the fluid, and a uniform velocity comes with it that counts the particles that
            # changed sides.
            deviation -= deviation.mean()
            wave = np.exp(-2j * np.pi * (y - drift * t) / H)
            amplitude = 2 * abs((deviation * wave).mean())
            assert abs(amplitude - RATE * H / np.pi *
                       np.exp(-0.97 * (2 * np.pi / H) ** 2 * t)) < 0.03 * RATE * H / np.pi
        assert np.abs(deviation).max() < 0.02 * RATE * H
    finally:
        lmp.close()


def test_stress_of_artificial_viscosity():
    """alpha h c / 16, 0.87 to 0.94 of it where it was measured; braked by the faces it would be 0."""
    lmp = start()
    try:
        run(lmp, SCENE.format(**dict(VISCOUS, terms="artVisc 0.2 0 0.01", start=RATE)) +
            "compute pr all pressure NULL virial\nfix mean all ave/time 1 500 500 c_pr[4]\nrun 500")
        assert 0.8 < -lmp.extract_fix("mean", 0, 0) / (0.2 * 2 * 10 / 16 * RATE) < 1.0
    finally:
        lmp.close()


@pytest.mark.ranks(2)
def test_run_in_pieces_is_one_run(tmp_path):
    """LAMMPS moves the box after the force of a step, so the first force of the next run sees ghosts one step farther:
    4e-8 of the forces here."""
    ends = []
    for name, runs in (("one", ["run 300"]), ("three", ["run 170", "run 0", "run 130"]), ("two ranks", ["run 300"])):
        folder = tmp_path / name
        folder.mkdir()
        done = mpirun(2 if "ranks" in name else 1, SCENE.format(**dict(VISCOUS, drift=0.2)) + "\n".join(runs) +
                      "\nwrite_dump all custom end.dump id x y vx vy fx fy modify format float %.17g", folder)
        assert done.returncode == 0, done.stdout
        end = read_dump(folder / "end.dump")
        end["vx"] -= RATE * end["y"]    # the same on both sides, whenever a particle is put back into the box
        if ends:                        # create_atoms numbers the atoms rank by rank
            partner = np.hypot(end["x"] - ends[0]["x"][:, None], end["y"] - ends[0]["y"][:, None]).argmin(1)
            end = {n: end[n][partner] for n in end}
        ends.append(end)
    for limit, other in zip((1e-7, 1e-11), ends[1:]):
        for names in (("vx", "vy"), ("fx", "fy")):
            scale = max(np.abs(ends[0][n]).max() for n in names)
            for n in names:
                assert np.abs(other[n] - ends[0][n]).max() <= limit * scale, n


def lasting(*parts):
    """vx - RATE y, by IDs, of particles that are at random places and drift upwards"""
    lmp = start()
    try:
        scene = SCENE.format(**dict(VISCOUS, drift=1)).replace(
            "mass 1 1", "displace_atoms all random 0.2 0.4 0 871 units box\nmass 1 1")
        run(lmp, scene + "\n".join(parts))
        return by_id(lmp, "v", 3)[:, 0] - RATE * by_id(lmp, "x", 3)[:, 1]
    finally:
        lmp.close()


def test_before_a_run_of_no_steps_those_outside_are_put_back_by_a_last_step():
    """What the page says of LAMMPS: at run 0 those that have left the box come back without their change of velocity,
    RATE H; a last step that looks for neighbours has left nobody outside."""
    unbroken = lasting("run 61")
    lost = np.abs(lasting("run 60", "run 0", "run 1") - unbroken)
    assert 1 <= (lost > 0.9 * RATE * H).sum() <= 10
    kept = lasting("run 60", "neigh_modify check no", "run 1", "run 0")
    assert np.abs(kept - unbroken).max() < 1e-4


def test_fix_sph_of_lammps_cannot():
    """It extrapolates velocities before LAMMPS shifts those that change sides."""
    text = message(SCENE.format(**dict(VISCOUS, integrator="sph")) + "run 1")
    assert "remap v" in text and "fix sph extrapolates" in text and "use fix nve/sph" in text
