"""The examples of the three manual pages on which the styles are modelled, word by word: they run, or a message says
why not.

Original pages: pair_style stokes_dynamics (Aspherix), pair_style sph/artVisc/tensCorr (LIGGGHTS 3.8), "Using YADE 1D
vertical VANS fluid resolution" (Yade)."""
import pathlib
import re

import numpy as np
import pytest

import model
from system import Spheres, input_lines, largest_difference, lmp, read_dump

STOKES = """\
pair_style stokes_dynamics cut_off_distance 1e-2 clumps_only yes update_every 10 visc 1e-2 \
add_force yes relative_tolerance 1e-3 max_iter 100 algorithm 1
pair_coeff * *"""

SPH = ["pair_style sph/artVisc/tensCorr wendland 0.001 artVisc 1e-4 0 1e-8",
       "pair_style sph/artVisc/tensCorr cubicspline 0.001 artVisc 1e-4 0 1e-8 tensCorr 0.2 1e-2"]
LIGGGHTS = ["fix m2 all property/global sl peratomtype 0.0012",
            "fix m1 all property/global speedOfSound peratomtype 20"]

# what the page calls HydroForceEngine.NAME, and the profiles that it works on
YADE = ["action", "averageProfile", "fluidResolution", "densFluid", "ids", "steadyFlow", "vxFluid", "phiPart", "expoRZ",
        "lift"]


@pytest.mark.parametrize("n, goes_on", [(2, 0), (5, 1)])
def test_the_example_of_stokes_dynamics_runs(tmp_path, n, goes_on):
    """A row of touching grains of 1 mm: two are solved by the page's substitution, five by what takes its place."""
    a = 5e-4
    v = np.zeros((n, 3))
    v[:, 2], v[0, 0] = -0.01, 0.002
    row = Spheres([(2 * a * k, 0.0, 0.0) for k in range(n)], a, v, molecule=1)
    lines = input_lines(row, STOKES.splitlines(), tmp_path / "data", units="si", dt=1e-9,
                        comm="comm_modify cutoff 0.02", fix=False) + ["fix report all stokes_dynamics",
                                                                      "fix move all nve/sphere"]
    lines += [f"dump 1 all custom 1 {tmp_path}/dump id f_report[1] f_report[2] f_report[3]",
              "dump_modify 1 sort id format float %.15g"]
    ended = lmp(tmp_path, lines + ["run 25"])
    assert " ".join(ended.log.split()).count("the run goes on with algorithm 2") == goes_on
    drag = read_dump(tmp_path / "dump")[-1][1][:, -3:]
    assert largest_difference(drag, model.forces(row, 1e-2)) < 0.01


def sph_scene(line, more=()):
    return ["plugin load stokesdynplugin.so", "units si", "atom_style sph", "boundary p p p", "lattice sc 0.0008",
            "region box block 0 8 0 8 0 8", "create_box 1 box", "create_atoms 1 box", "mass 1 5.12e-7",
            "set group all sph/rho 1001", line, "pair_coeff * * c 20", "neighbor 1e-4 bin",
            "fix p all sph/pressure Tait 57142.9 1000 7", "fix d all sph/density/continuity", "fix i all nve/sph",
            "timestep 1e-6", *more]


def test_the_first_example_of_sph_runs(tmp_path):
    ended = lmp(tmp_path, sph_scene(SPH[0], ["compute ke all ke", "thermo_style custom step c_ke press", "run 20"]))
    assert "ERROR" not in ended.log


def test_the_second_example_of_sph_is_refused(tmp_path):
    """deltap 0.01 lies outside of the support 2 h = 0.002, so that W(deltap), by which tensCorr divides, is 0."""
    ended = lmp(tmp_path, sph_scene(SPH[1], ["run 0"]), succeed=False)
    assert "deltap 0.01 must be smaller than the support 2 h = 0.002" in " ".join(ended.text.split())


def test_the_fixes_of_the_original_page_run(tmp_path):
    """c and h by property/global are those of pair_coeff, which wins where both are given."""
    scene = sph_scene(SPH[0], ["displace_atoms all random 2e-4 2e-4 2e-4 7 units box", "velocity all create 1e15 5",
                               "thermo_style custom step press", "thermo_modify format float %.15g", "run 0"])
    scene[scene.index("atom_style sph")] += "\natom_modify map array"
    given = [line for line in scene if line != "pair_coeff * * c 20"]
    given[given.index("neighbor 1e-4 bin")] += "\npair_coeff * *"

    def pressure(lines):
        return re.search(r"^ +0 +(\S+)", lmp(tmp_path, lines).log, re.M).group(1)
    expected = pressure([line.replace("c 20", "c 20 h 0.0012") for line in scene])
    at = given.index("fix i all nve/sph")
    assert pressure(given[:at] + LIGGGHTS + given[at:]) == expected
    wrong = [line.replace("20", "31") for line in LIGGGHTS]
    assert pressure(given[:at] + LIGGGHTS[:1] + wrong[1:] + ["pair_coeff * * c 20"] + given[at:]) == expected
    assert pressure(given[:at] + LIGGGHTS[:1] + wrong[1:] + given[at:]) != expected


def test_each_name_of_yades_page_is_in_the_table_of_attributes():
    page = (pathlib.Path(__file__).resolve().parents[3] / "PKG-STOKESDYN" / "doc" / "vans_yade.md").read_text()
    table = page[page.index("## Attributes of Yade"):page.index("## Rules yade")]
    missing = [name for name in YADE if not re.search(rf"\b{name}\b", table)]
    assert not missing


def test_the_periods_of_yades_page_run(tmp_path):
    """fluidResolPeriod 1e-2 and dtFluid 1e-5, the drag law with expoRZ 3.1, both kinds of buoyancy: a stream over fixed
    grains."""
    lines = ["plugin load stokesdynplugin.so", "units si", "atom_style sphere", "boundary p p f",
             "lattice sc 0.006 origin 0 0 0.5", "region box block 0 3 0 3 -0.1 8", "create_box 1 box",
             "region bed block 0 3 0 3 0 1.9", "create_atoms 1 region bed",
             "set group all diameter 0.006 density 2500", "pair_style zero 0.01", "pair_coeff * *",
             "comm_modify vel yes", "timestep 1e-4",
             "fix s all hydro/vans 100 mesh 81 0.0005 0 fluid 1000 0.001 gravity 0.49 0 -9.8 solve 1e-2 1e-5 hindrance "
             "3.1 stream steady",
             "thermo_style custom step f_s[1] f_s[3] f_s[5]", "run 1000"]
    for stream, along in (("steady", 0.0), ("rest", -1000.0 * 18 * np.pi / 6 * 0.006**3 * 0.49)):
        ended = lmp(tmp_path, [line.replace("stream steady", f"stream {stream}") for line in lines])
        first, last = [[float(word) for word in re.search(rf"^ +{step} +(.*)$", ended.log, re.M).group(1).split()]
                       for step in (0, 1000)]
        assert first[0] == pytest.approx(along, abs=1e-12)
        # buoyancy: the grains do not move
        assert last[1] == pytest.approx(1000.0 * 18 * np.pi / 6 * 0.006**3 * 9.8, rel=1e-6)
        assert last[0] > first[0] and last[2] > 0.0
