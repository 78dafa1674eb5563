"""compute pair/local below pair_style hybrid/overlay has the forces of the other style, and alone it has no answer."""
import numpy as np
import pytest

from system import LammpsError, Simulation


def contacts(model, ours):
    """Particles with forces of pairs, below hybrid/overlay with our pair style or with zero of the same reach."""
    if model == "sph":
        lines = ["units lj", "dimension 2", "atom_style sph", "boundary f f p", "plugin load stokesdynplugin.so",
                 "lattice sq 100", "region box block 0 0.5 0 0.5 -0.05 0.05 units box", "create_box 1 box",
                 "create_atoms 1 box", "mass 1 0.01", "set group all sph/rho 1"]
        other, style = "lj/cut 0.25", "sph/artVisc/tensCorr wendland 0.2" if ours else "zero 0.4"
        fixes = ["fix eos all sph/pressure Tait 57 1 7", "fix density all sph/density/continuity",
                 "fix move all nve/sph"]
        coeff = "pair_coeff * * lj/cut 1 0.09"
    else:
        lines = ["units lj", "atom_style sphere", "boundary f f f", "comm_modify vel yes",
                 "plugin load stokesdynplugin.so", "region box block 0 12 0 12 0 12", "create_box 1 box",
                 "create_atoms 1 single 5.505 6 6", "create_atoms 1 single 6.495 6 6",
                 "set group all diameter 1 density 1"]
        other, style = ("gran/hooke 1e4 NULL 50 NULL 0.4 1", "stokes_dynamics cut_off_distance inf visc 1 add_force yes"
                        if ours else "zero 3")
        fixes, coeff = ["fix move all nve/sphere"], "pair_coeff * * gran/hooke"
    lines += [f"pair_style hybrid/overlay {other} {style}", coeff,
              f"pair_coeff * * {style.split()[0]}"] + (fixes if ours or model == "stokes" else [])
    return lines + ["compute c all pair/local force", "dump c all local 1 forces c_c",
                    "dump_modify c format line %.17g", "run 0"]


@pytest.mark.parametrize("model", ["sph", "stokes"])
def test_a_hybrid_tells_the_forces_of_the_other_style(tmp_path, model):
    """compute pair/local as with pair zero in place of ours."""
    values = []
    for ours in (True, False):
        sim = Simulation(tmp_path)
        try:
            sim.commands(line.replace("forces", str(tmp_path / "forces")) for line in contacts(model, ours))
        finally:
            sim.close()
        forces = np.loadtxt(str(tmp_path / "forces"), skiprows=9, ndmin=1)
        values.append(np.sort(forces[forces != 0.0]))
    assert len(values[1]) > 0 and values[0] == pytest.approx(values[1], rel=1e-12)


@pytest.mark.parametrize("command, says", [("run 0", "does not support compute pair/local"),
                                           ("pair_write 1 1 5 r 0.01 1 {}/table forces",
                                            "pair_write has nothing to write")])
@pytest.mark.parametrize("model", ["sph", "stokes"])
def test_alone_no_style_says_that_there_are_no_forces(tmp_path, model, command, says):
    lines = [line for line in contacts(model, True) if not line.startswith(("pair_", "run"))]
    if command != "run 0":
        lines = [line for line in lines if not line.startswith(("compute", "dump"))] + 4 * ["echo none"]
    lines.insert(-4, {"sph": "pair_style sph/artVisc/tensCorr wendland 0.2",
                      "stokes": "pair_style stokes_dynamics cut_off_distance inf visc 1"}[model])
    lines.insert(-4, "pair_coeff * *")
    sim = Simulation(tmp_path)
    try:
        with pytest.raises(LammpsError, match=says):
            sim.commands(lines + [command.format(tmp_path)])
    finally:
        sim.close()
