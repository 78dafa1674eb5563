"""Loads of walls, probes and the free surface of SPH scenes are what they say."""
import numpy as np
import pytest

from sph_tools import by_id, run, start
from test_sph_output import BEGIN, COLUMN, FLOW, SHIFT, PERIODIC


def probes(lmp):
    return np.array(lmp.numpy.extract_compute("P", 0, 1))


def test_the_load_on_patches_of_a_wall_at_rest():
    """Force on the particles of a wall over the area: hydrostatic to 3 %, in the corner, too, if those under the floor
    are counted."""
    still = COLUMN.replace("2.4 -0.4", "1.4 -0.4").replace("tank block 0 2", "tank block 0 1")
    patches = """
    region low block INF 0 INF 0.3 INF INF units box
    region high block INF 0 0.3 0.6 INF INF units box
    group low region low
    group high region high
    variable low equal -fcm(low,x)/0.3
    variable high equal -fcm(high,x)/0.3
    """
    lmp = start()
    run(lmp, still + patches + FLOW.format(**SHIFT) + "run 0 post no")
    assert lmp.extract_variable("low", None, 0) == pytest.approx(0.85, rel=0.03)
    assert lmp.extract_variable("high", None, 0) == pytest.approx(0.55, rel=0.03)
    lmp.close()


@pytest.mark.parametrize("more", ["", "fix weight all gravity 3 vector 0.6 -0.8 0\n", "fix push tank addforce 5 6 0\n"])
def test_the_load_of_a_wall_is_that_of_the_fluid_alone(more):
    """Forces of other fixes on the wall particles, given before fix wall/adami/sph or after it, are no load."""
    still = COLUMN.replace("2.4 -0.4", "1.4 -0.4").replace("tank block 0 2", "tank block 0 1")
    for text in (FLOW.format(**SHIFT).replace("fix tank", more + "fix tank"), FLOW.format(**SHIFT) + more):
        lmp = start()
        run(lmp, still + text + "thermo_style custom step f_tank[1] f_tank[2]\nrun 0 post no")
        load = [lmp.extract_fix("tank", 0, 1, k) for k in (0, 1)]
        assert load[1] == pytest.approx(-1, rel=0.03) and abs(load[0]) < 1e-9
        lmp.close()


SLAB = BEGIN + """
boundary f p p
lattice sq 1 origin 0.5 0.5 0
region all block -4 60 0 12 -0.5 0.5 units box
create_box 2 all
region slab block 3 {end} INF INF INF INF units box
region plate block -3 0 INF INF INF INF units box
create_atoms 1 region slab
create_atoms 2 region plate
mass * 1
group water type 1
group plate type 2
set group all sph/rho 1
set group water vx -1
neighbor 0.3 bin
neigh_modify delay 0 every 1 exclude type 2 2
pair_style sph/artVisc/tensCorr wendland 1.5 viscosity 1e-5 central shift yes
pair_coeff * * c 7.5
fix eos all sph/pressure Tait $(7.5^2/7) 1 7
fix density all sph/density/continuity delta 0.1
fix plate plate wall/adami/sph slip yes
fix move water nve/sph
fix flat all enforce2d
timestep 0.06
compute P all sph/probe pressure 0 6 0
variable load equal -fcm(plate,x)/12
variable u equal vcm(water,x)
fix sum all ave/time 1 250 250 v_load c_P[1]
"""


@pytest.mark.parametrize("rows", [2, 10])
def test_the_impulse_of_a_slab_is_in_the_load_and_not_in_the_probe(rows):
    """Water that hits a plate at c/7.5 and flies back. The load is its change of momentum; the probe's pressure is not,
    as its page says."""
    lmp = start()
    run(lmp, SLAB.format(end=3 + rows) + "run 250 post no")
    load, probe = (15 * lmp.extract_fix("sum", 0, 1, k) for k in (0, 1))
    change = rows * (lmp.extract_variable("u", None, 0) + 1)
    assert change > 1.5 * rows
    assert load == pytest.approx(change, rel=1e-9)
    assert 1.3 * load < probe < 2.5 * load
    lmp.close()


@pytest.mark.parametrize("tension", ["yes", "no"])
def test_water_without_tension_comes_apart(tension):
    """Two halves of a slab that fly away from each other, in the plain scheme: nothing but tension takes from their
    energy."""
    text = SLAB.format(end=36).replace("slab block 3", "slab block 30").replace("1 7\n", "1 7 tension %s\n" % tension)
    lmp = start()
    run(lmp, text.replace(" delta 0.1", "").replace(" shift yes", "") + "variable apart atom (x>33)*2-1\n"
        "set group water vx v_apart\n"
        "compute rho water sph/rho/atom\ncompute least water reduce min c_rho\nthermo_style custom step c_least\n"
                                                                        "run 100")
    v = np.array(lmp.numpy.extract_atom("v"))[:lmp.extract_global("nlocal")]
    kinetic = (v ** 2).sum() / 72
    if tension == "no":
        assert kinetic == pytest.approx(1, abs=1e-4)
        assert 0.3 <= lmp.extract_compute("least", 0, 0) < 0.9    # what comes off has room
    else:
        assert kinetic < 0.95
    lmp.close()


def test_spray_that_comes_together_has_the_volume_that_it_had():
    """A disk bursts in a harmonic trap, twice as wide as it was: particles swing, x cos(wt) + x 2 sin(wt), and nothing
    pushes until they are back where they were. Density that had a limit near rho0 pushed as soon as they came nearer,
    and splashed water stood twice as high as it should."""
    lmp = start()
    run(lmp, BEGIN + """
boundary f f p
lattice sq 1
region all block -20 20 -20 20 -0.5 0.5 units box
create_box 1 all
region disk sphere 0 0 0 5.6 units box
create_atoms 1 region disk
mass 1 1
set group all sph/rho 1
variable u atom 0.2*x
variable v atom 0.2*y
velocity all set v_u v_v 0 units box
neighbor 0.3 bin
neigh_modify delay 0 every 1
pair_style sph/artVisc/tensCorr wendland 1.5 viscosity 1e-5 central shift yes
pair_coeff * * c 7.5
fix eos all sph/pressure Tait $(7.5^2/7) 1 7 tension no
fix density all sph/density/continuity delta 0.1
fix move all nve/sph
variable pullx atom -0.01*x
variable pully atom -0.01*y
fix trap all addforce v_pullx v_pully 0
timestep $(10*2.214297435588181/400)
""")
    x = by_id(lmp, "x", 3)
    run(lmp, "compute H all sph/probe height y 0 0 0\nthermo_style custom step c_H[1]\nrun 200 post no")
    assert np.abs(by_id(lmp, "x", 3)).max() > 2 * np.abs(x).max()
    assert lmp.extract_compute("H", 0, 1)[0] == 0    # a fifth of the space is water
    run(lmp, "run 200 post no")
    back = by_id(lmp, "x", 3)
    assert (back * x).sum() / (x * x).sum() == pytest.approx(1, abs=0.02)
    lmp.close()


def test_probes_of_water_at_rest():
    """Pressure inside to 1 %, on the wall with its particles to 5 %; height to a twentieth of a spacing; a dry column
    has 0; one row of 10 is the surface, and the first and last columns are not, since walls count."""
    still = COLUMN.replace("2.4 -0.4", "1.4 -0.4").replace("tank block 0 2", "tank block 0 1")
    lmp = start()
    run(lmp, still + FLOW.format(**SHIFT) + "run 0 post no")
    inside, at_wall, height, dry = probes(lmp)
    assert inside == pytest.approx(0.5, rel=0.01) and at_wall == pytest.approx(0.7, rel=0.05)
    assert height == pytest.approx(1.0, abs=0.005) and dry == 0
    assert lmp.extract_compute("top", 0, 0) == 10
    rows = np.array(lmp.numpy.extract_compute("S", 1, 2))[:lmp.extract_global("nlocal")]
    types = np.array(lmp.numpy.extract_atom("type", nelem=len(rows)))[:len(rows)]
    y = np.array(lmp.numpy.extract_atom("x", nelem=len(rows), dim=3))[:len(rows), 1]
    assert (rows[types == 2] == 0).all()
    assert rows[(types == 1) & (y < 0.6), 0] == pytest.approx(1.0, abs=0.03)
    lmp.close()


NARROW = """
units lj
atom_style sph
boundary f p f
lattice sc 1000 origin 0.5 0.5 0.5
region all block 0 0.8 0 {} 0 1.5 units box
create_box 1 all
region water block INF INF INF INF 0 1 units box
create_atoms 1 region water
mass 1 0.001
variable rho atom 1+0.01*z
set group all sph/rho v_rho
neighbor 0.03 bin
pair_style sph/artVisc/tensCorr wendland 0.2
pair_coeff * * c 20
fix eos all sph/pressure Tait $(400/7) 1 7
fix density all sph/density/continuity
fix move all nve/sph
compute P all sph/probe pressure 0.4 0.07 0.97 height z 0.4 0.07 0
thermo_style custom step c_P[1] c_P[2]
run 0
"""


@pytest.mark.parametrize("width", [0.1, 0.2, 0.3, 0.5, 0.8])
def test_probes_in_a_box_narrower_than_the_support(width):
    """One to eight particles across, periodic: every width has the water of a wide box, all images of a particle
    count."""
    lmp = start()
    run(lmp, NARROW.format(1.2))
    wide = probes(lmp).copy()
    lmp.close()
    lmp = start()
    run(lmp, NARROW.format(width))
    assert wide[1] == pytest.approx(1, abs=0.01) and probes(lmp) == pytest.approx(wide, rel=1e-12)
    lmp.close()


def test_surface_particles_of_a_list_that_is_gone_are_refused():
    """Asked by python between two runs, after half of the atoms have been deleted: the list of neighbours is that of
    the others."""
    lmp = start()
    run(lmp, PERIODIC.format(pair="", density="", background="") + "compute S all sph/surface/atom\nrun 1")
    lmp.extract_compute("S", 1, 2)
    run(lmp, "region half block INF 0.5 INF INF INF INF units box\ndelete_atoms region half compress no\n"
             "reset_timestep 7")
    with pytest.raises(Exception, match="there is no neighbour list yet"):
        lmp.extract_compute("S", 1, 2)
    run(lmp, "run 0")
    lmp.extract_compute("S", 1, 2)
    lmp.close()
