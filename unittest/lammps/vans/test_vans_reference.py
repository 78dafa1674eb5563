"""fix hydro/vans against the reference tables, through LAMMPS: forces 1e-12, averages 1e-12, fluid 1e-9 of the largest
entry."""
import numpy as np
import pytest
# close_scenes is a fixture
from vans_helper import Scene, close_scenes, difference, table, write_columns  # noqa: F401

CLOSURES = ["kz", "parabolic", "li_sawamoto", "pore", "rousseau", "ni_capart", "pipe"]
RULES = ["yade", "consistent"]


def vectors(columns, *names):
    return np.array([columns[name] for name in names]).T


@pytest.mark.parametrize("rules", RULES)
@pytest.mark.parametrize("case", ["force_steady", "force_unsteady"])
def test_forces(case, rules, tmp_path):
    header, spheres = table(case)
    _, profiles = table(case + "_profiles")
    u = write_columns(tmp_path / "u", profiles["vxFluid"])
    given = write_columns(tmp_path / "given", profiles["phi"], 0 * profiles["phi"], 0 * profiles["phi"])
    gravity = " ".join("%.17g" % g for g in header["gravity"])
    s = Scene()
    s.spheres(vectors(spheres, "x", "y", "z"), vectors(spheres, "vx", "vy", "vz"), spheres["radius"])
    s.do(f"fix h all hydro/vans 1 mesh 60 0.001 0.05 fluid 1000 0.001 gravity {gravity} couple none profile file {u} "
         f"given file {given} rules {rules} stream {'steady' if header['steadyFlow'][0] else 'rest'}", "run 0")
    F, expected = s.atoms("f_h")[:, :3], vectors(spheres, "fx", "fy", "fz")
    inside = (spheres["z"] >= 0.05) & (spheres["z"] < 0.11)
    assert difference(F[inside], expected[inside]) < 1e-12
    assert difference(s.atoms("f")[inside], expected[inside]) < 1e-12
    assert s.number("outside") == (~inside).sum() == 8
    # outside the mesh: nothing with Yade's rules; else buoyancy at least
    assert np.all((np.abs(F[~inside]).sum(axis=1) > 0) == (rules == "consistent"))
    assert abs(s.number("fz") - F[:, 2].sum()) < 1e-15
    s.close()


@pytest.mark.parametrize("rules", RULES)
@pytest.mark.parametrize("case, classes", [("avg_fine", False), ("avg_twosize", True)])
def test_averages(case, classes, rules, tmp_path):
    """phi and velocities of both size classes. The tables' drag contains velocity fluctuations that no keyword sets: it
    is in the tests of the core."""
    _, spheres = table(case + "_spheres")
    _, profiles = table(case + "_profiles")
    _, expected = table(case + "_profiles" + ("" if rules == "yade" else ".consistent"))
    u = write_columns(tmp_path / "u", profiles["vxFluid"])
    given = write_columns(tmp_path / "given", profiles["phi_in"], 0 * profiles["phi_in"], 0 * profiles["phi_in"])
    s = Scene()
    s.spheres(vectors(spheres, "x", "y", "z"), vectors(spheres, "vx", "vy", "vz"), spheres["radius"])
    s.do(f"fix h all hydro/vans 1 mesh 60 0.001 0.05 fluid 1000 0.001 gravity 0 0 -9.81 couple one profile file {u} "
         # no integrator: the grains stay; averages at set-up and after step 1
         f"given file {given} rules {rules} classes {'yes' if classes else 'no'}", "run 1")
    for name in ("phi", "vx", "vy", "vz"):
        assert difference(s.column(name, 60), expected[name + "_2"]) < 1e-12
        for c in range(2 if classes else 0):
            column = 10 + 5 * c + ["phi", "vx", "vy", "vz"].index(name)
            assert difference(s.column(column, 60), expected[f"{name}_c{c}_2"]) < 1e-12
    s.close()


@pytest.mark.parametrize("rules", RULES)
@pytest.mark.parametrize("case", ["lam_dpdx", "lam_visc0", "turb_lm1", "turb_lm2", "turb_lm2_wall", "turb_lm5"])
def test_fluid(case, rules, tmp_path):
    """couple fluid: one solve, with an empty box."""
    header, columns = table("fluid_" + case)
    _, expected = table("fluid_" + case + ("" if rules == "yade" else ".consistent"))

    def key(name):
        return header[name][0]

    classes = "phi_c0" in columns
    u = write_columns(tmp_path / "u", columns["u_in"])
    given = [columns[name] for name in ("phi", "vx", "drag") + (("phi_c0", "drag_c0", "phi_c1", "drag_c1") if classes
                                                                else ())]
    given = write_columns(tmp_path / "given", *given)
    closure = CLOSURES[int(key("ilm"))] if key("iturbu") else "none"
    s = Scene()
    s.do(f"fix h all hydro/vans 1 mesh {int(key('nCell'))} {key('deltaZ')} 0 fluid {key('densFluid')} "
         f"{key('viscoDyn')} gravity {' '.join('%.17g' % g for g in header['gravity'])} couple fluid profile file {u} "
         f"given file {given} rules {rules} turbulence {closure} phi_max {key('phiMax')} phi_bed {key('phiBed')} "
         f"viscosity {['constant', 'einstein', 'power'][int(key('irheolf'))]} "
         f"pressure_gradient {key('dpdx')} radius {key('radiusPart')} solve {key('t_end')} {key('dt')} "
         + (f"sidewall {key('channelWidth')} {key('fluidFrictionCoef')} " if key("fluidWallFriction") else "") +
         ("class_radii 2 0.003 0.002" if classes else ""), "run 1")
    rows = int(key("nCell"))
    assert difference(s.column("u", rows), expected["u_out"][1:]) < 1e-9
    for ours, theirs in (("b", "taufsi"), ("nut", "nut"), ("stress", "stress")):
        if np.abs(expected[theirs]).max() > 0:
            assert difference(s.column(ours, rows), expected[theirs]) < 1e-9
        else:
            assert np.abs(s.column(ours, rows)).max() == 0
    s.close()
