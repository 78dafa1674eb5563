"""The same forces, densities and trajectories on any number of ranks, newton on or off; momentum is kept."""
import numpy as np
import pytest

from host import allowed, by_open_mpi
from sph_tools import jittered_lattice, mpirun, read_dump, write_data

# Forces and places in steps 0, 1 and 100. One start has the scene with newton on, and then, after `clear`, with newton
# off.
STEPS = (0, 1, 100)
SCENE = """
    plugin load stokesdynplugin.so
    units si
    newton {newton}
    atom_style sph
    boundary p p p
    dimension {dim}
    read_data scene.data
    mass 1 {m1}
    mass 2 {m2}
    neighbor 0.002 bin
    neigh_modify delay 0 every 1
    timestep 5e-5
    pair_style sph/artVisc/tensCorr {kernel}
    pair_coeff 1 1 h 0.012 c 20
    pair_coeff 2 2 h 0.013 c 25
    fix eos all sph/pressure Tait 60000 1000 7
    {fixes}
    dump d all custom 1 {newton}.*.dump id x y z vx vy vz fx fy fz f_eos
    dump_modify d first yes format float %.17g
    run 1
    dump_modify d every 100
    run 99
    clear
"""

THREE = dict(dim=3, n=8, m1=0.001, m2=0.0013)
TWO = dict(dim=2, n=12, m1=0.1, m2=0.13)
MOVE = "fix move all nve/sph"
DELTA = "fix rho all sph/density/continuity delta 0.1\n"
FILTER = "fix filter all sph/density/corr shepard every 7\n"
FLUIDS = ("group a type 1\ngroup b type 2\nunfix eos\nfix eos a sph/pressure Tait 60000 1000 7\n"
          "fix other b sph/pressure Tait 60000 1000 7 50\nfix rho all sph/density/continuity delta 0.1 volume yes\n")
WALL = ("group fluid type 1\ngroup wall type 2\nfix rho all sph/density/continuity\n"
        "fix wall wall wall/adami/sph gravity 3 -1 0\nfix rest wall nve/sph/stationary\nfix move fluid nve/sph")
SPACED = "pair_coeff * * deltap 0.01\n"
CASES = {    # all talk to other ranks through ghost_rows.h: by sums of neighbours, for walls, before and after a move
    "delta and filter": dict(TWO, kernel="cubicspline 0.012 artVisc 0.1 0.2 1.44e-6 tensCorr 0.2 0.01",
                             fixes=DELTA + FILTER + MOVE),
    "two fluids with correction": dict(TWO, kernel="cubicspline 0.012 viscosity 0.01 central correction yes",
                                       fixes=SPACED + FLUIDS + MOVE),
    "wall along gravity": dict(TWO, kernel="wendland 0.012 artVisc 0.1 0.2 1.44e-6 viscosity 0.01", fixes=WALL),
    "fix sph": dict(TWO, kernel="wendland 0.012 artVisc 0.1 0.2 1.44e-6",
                    fixes="fix rho all sph/density/continuity\nfix move all sph"),
    "leapfrog": dict(THREE, kernel="wendland 0.012 artVisc 0.1 0.2 1.44e-6 tensCorr 0.2 0.01 viscosity 0.01",
                     fixes="fix rho all sph/density/continuity\n" + MOVE),
    "summation": dict(TWO, kernel="wendland 0.012 artVisc 0.1 0.2 1.44e-6",
                      fixes="fix rho all sph/density/summation\n" + MOVE),
    "shift": dict(TWO, kernel="wendland 0.012 artVisc 0.1 0.2 1.44e-6 viscosity 0.01 central shift yes",
                  fixes=DELTA + MOVE),
    "shift in 3-D": dict(THREE, kernel="wendland 0.012 artVisc 0.1 0.2 1.44e-6 shift yes", fixes=DELTA + MOVE),
    "correction": dict(TWO, kernel="cubicspline 0.012 artVisc 0.1 0.2 1.44e-6 viscosity 0.01 correction yes",
                       fixes=DELTA + FILTER + MOVE),
    "two fluids": dict(TWO, kernel="wendland 0.012 viscosity 0.01 central", fixes=FLUIDS + MOVE),
    "two fluids with shift": dict(TWO, kernel="wendland 0.012 viscosity 0.01 central shift yes",
                                  fixes=SPACED + FLUIDS + MOVE),
}
COLUMNS = "x y z vx vy vz fx fy fz f_eos".split()


def box(case):
    L = 0.01 * CASES[case]["n"]
    return np.array([L, L, L if CASES[case]["dim"] == 3 else 1.0])


def scene(case, directory):
    L, dim = box(case), CASES[case]["dim"]
    x = jittered_lattice(dim, CASES[case]["n"], 0.01, 0.002) % L
    k = 2 * np.pi / L
    v = np.stack([0.7 * np.sin(k[1] * x[:, 1]), 0.6 * np.sin(k[0] * x[:, 0]), 0.3 * np.sin(k[2] * x[:, 2])], axis=1)
    rho = 1000 + 30 * np.sin(k[0] * x[:, 0] + k[1] * x[:, 1])
    types = 1 + (x[:, 0] < L[0] / 2)
    lo = np.zeros(3) if dim == 3 else np.array([0, 0, -0.5])
    write_data(directory / "scene.data", x, v, rho, types, lo, lo + L)
    return x, v, types


def run(case, ranks, newtons, directory):
    """{newton: {step: its dump}}"""
    directory.mkdir(exist_ok=True)
    scene(case, directory)
    done = mpirun(ranks, "".join(SCENE.format(newton=newton, **CASES[case]) for newton in newtons), directory)
    assert done.returncode == 0, done.stdout + done.stderr
    return {newton: {step: read_dump(directory / f"{newton}.{step}.dump") for step in STEPS} for newton in newtons}


def check_same(case, first, other, what):
    for name in COLUMNS:
        group = [c for c in COLUMNS if c[0] == name[0]]
        scale = max(np.abs(first[c]).max() for c in group)
        difference = np.abs(first[name] - other[name])
        if name in "xyz":
            L = box(case)["xyz".index(name)]
            difference = np.minimum(difference, np.abs(difference - L))
        assert difference.max() <= 1e-12 * scale, (*what, name)


def check_momentum_is_kept(case, directory, end):
    """Against the largest impulse that a particle gets in the 100 steps."""
    x, v, types = scene(case, directory)
    m = np.where(types == 1, CASES[case]["m1"], CASES[case]["m2"])
    impulse = m[:, None] * (np.stack([end["vx"], end["vy"], end["vz"]], axis=1) - v)
    assert np.abs(impulse.sum(0)).max() <= 1e-12 * np.abs(impulse).max()


@pytest.mark.parametrize("case", by_open_mpi(CASES, but=4))
def test_layout_does_not_matter_and_momentum_is_kept(case, tmp_path):
    first = None
    for ranks in allowed(1, 2, 4):
        found = run(case, ranks, ("on", "off"), tmp_path / str(ranks))
        first = first or found["on"]
        for newton, frames in found.items():
            for step in STEPS:
                check_same(case, first[step], frames[step], (ranks, newton, step))
        if case not in ("correction", "two fluids with correction", "wall along gravity"):
            check_momentum_is_kept(case, tmp_path / str(ranks), found["on"][100])
