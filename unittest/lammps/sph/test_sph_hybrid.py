"""Water below pair_style hybrid and hybrid/overlay is the water without: positions, densities, forces and pressures."""
import numpy as np
import pytest

from sph_tools import mpirun, read_dump, run, start

ZERO = "zero 0.001"
# pair_style and pair_coeff lines; the types of the water are 1 and 2, and in a hybrid 3 is of the other style
WAYS = {"alone": ["pair_style {sph}", "pair_coeff * * {coeff}"],
        "hybrid": [f"pair_style hybrid {{sph}} {ZERO}", "pair_coeff 1*2 1*2 sph/artVisc/tensCorr {coeff}",
                   "pair_coeff * 3 zero"],
        "hybrid, zero first": [f"pair_style hybrid {ZERO} {{sph}}", "pair_coeff 1*2 1*2 sph/artVisc/tensCorr {coeff}",
                               "pair_coeff * 3 zero"],
        "hybrid/overlay": [f"pair_style hybrid/overlay {{sph}} {ZERO}", "pair_coeff * * sph/artVisc/tensCorr {coeff}",
                           "pair_coeff * * zero"]}
BELOW = sorted(set(WAYS) - {"alone"})


def pair(way, sph, coeff="c 10"):
    return "\n".join(WAYS[way]).format(sph="sph/artVisc/tensCorr " + sph, coeff=coeff)


# Most of the water is on one of two ranks: that one has many ghosts of walls to hear of, and few of its own to tell.
DAM = """
units lj
atom_style sph
atom_modify map array
newton on
boundary f f f
processors * 1 1
lattice sc 1.0
region box block -0.5 14.5 -0.5 14.5 -0.5 40.5
create_box 3 box
region dam block INF 6.5 INF INF INF INF
create_atoms 1 region dam
region rest block 6.51 INF INF INF INF 3
create_atoms 1 region rest
region floor block INF INF INF INF INF 3
group wall region floor
set group wall type 2
group fluid subtract all wall
mass * 1.0
set group all sph/rho 1.0
{pair}
neighbor 0.3 bin
neigh_modify delay 0 every 1
fix p all sph/pressure Tait 14.2857 1.0 7
fix d all sph/density/continuity
fix w wall wall/adami/sph
fix i fluid nve/sph
fix s wall nve/sph/stationary
{motion}
timestep 0.001
compute rho all sph/rho/atom
dump d all custom 2 dump id x y z c_rho vx vy vz fx fy fz
dump_modify d format float %.17g
run 2
"""
MOTION = {"at rest": "", "that move": "fix m wall move linear 0.1 0.0 0.0"}


def dam(way, motion, ranks, folder):
    folder.mkdir()
    done = mpirun(ranks, DAM.format(pair=pair(way, "wendland 1.3 viscosity 0.1 central"), motion=MOTION[motion]),
                  folder)
    assert done.returncode == 0, done.stdout[-1500:] + done.stderr[-1500:]
    return read_dump(folder / "dump")


@pytest.mark.ranks(2)
@pytest.mark.parametrize("motion", sorted(MOTION))
def test_sums_at_walls_have_room_on_two_ranks(motion, tmp_path):
    """A sum at a wall has 8 columns, with walls that move 17, of each ghost; the atom style would have LAMMPS make room
    for 5."""
    alone = dam("alone", motion, 1, tmp_path / "alone")
    for k, way in enumerate(BELOW):
        below = dam(way, motion, 2, tmp_path / str(k))
        for name in alone:
            assert np.abs(below[name] - alone[name]).max() < 1e-11 * (1 + np.abs(alone[name]).max()), (way, name)


SEA = """
units lj
atom_style sph
atom_modify map array
newton on
boundary p p p
lattice sc 1.0
region box block 0 7 0 7 0 7
create_box 3 box
create_atoms 1 box
mass * 1.0
set group all sph/rho 1.0
displace_atoms all random 0.1 0.1 0.1 4711
velocity all create 0.1 1234 loop geom
{pair}
neighbor 0.3 bin
fix p all sph/pressure Tait 14.2857 1.0 7
fix d all sph/density/continuity {delta}
fix i all nve/sph
compute w all pressure NULL virial
compute s all stress/atom NULL pair
compute sum all reduce sum c_s[1] c_s[2] c_s[3] c_s[4] c_s[5] c_s[6]
thermo_style custom step c_w c_w[1] c_w[2] c_w[3] c_w[4] c_w[5] c_w[6] &
  c_sum[1] c_sum[2] c_sum[3] c_sum[4] c_sum[5] c_sum[6]
timestep 0.001
run 2
"""
SCHEMES = {"plain": ("viscosity 0.1 central", ""), "delta": ("viscosity 0.1 central", "delta 0.1"),
           "shift": ("viscosity 0.1 central shift yes", "delta 0.1"),
           "correction": ("viscosity 0.1 central correction yes", "delta 0.1")}


def pressures(way, scheme):
    words, delta = SCHEMES[scheme]
    lmp = start()
    try:
        coeff = "c 10 deltap 1" if "yes" in words else "c 10"
        run(lmp, SEA.format(pair=pair(way, "wendland 1.3 " + words, coeff), delta=delta))
        pointer, stress = lmp.extract_compute("w", 0, 1), lmp.extract_compute("sum", 0, 1)
        volume = 7.0**3
        return np.array([lmp.extract_compute("w", 0, 0)] + [pointer[k] for k in range(6)]), np.array(
            [-stress[k] / volume for k in range(6)])
    finally:
        lmp.close()


@pytest.mark.parametrize("scheme", sorted(SCHEMES))
def test_the_pressure_is_the_one_without(scheme):
    """Where no force is put on ghosts, positions times forces are no virial, and hybrid has to know that."""
    alone, of_atoms = pressures("alone", scheme)
    assert alone[1:] == pytest.approx(of_atoms, rel=1e-10, abs=1e-13)
    for way in BELOW:
        assert pressures(way, scheme)[0] == pytest.approx(alone, rel=1e-10, abs=1e-13), way
