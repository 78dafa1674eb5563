"""Scenes of fix sph/grains: water on a lattice of spacing 1, h = 2, density 1, with grains; and what laws of drag say
of them."""
H = 2.0


def scene(size, mu, c, dt, fix, grains, diameter=0.5, boundary="p p p", density=2.65, pair="central shift yes",
          gravity="", floor=0, newton="on", before_fix="", mover="fix mg grains nve/sphere", delta=0.1,
          atom_style="sph sphere"):
    """Water (type 1) fills size[0] x size[1] x size[2] spacings, with `floor` rows of wall (type 3) below; grains (type
    2): commands."""
    x, y, z = size
    return f"""
    units lj
    newton {newton}
    atom_style hybrid {atom_style}
    atom_modify map array sort 0 0
    boundary {boundary}
    lattice sc 1 origin 0.5 0.5 0.5
    region box block 0 {x} 0 {y} {-floor} {z} units box
    create_box 3 box
    region water block 0 {x} 0 {y} 0 {z - (4 if floor else 0)} units box
    region floor block 0 {x} 0 {y} {-floor} 0 units box
    create_atoms 1 region water
    {"create_atoms 3 region floor" if floor else ""}
    {grains}
    set type 2 diameter {diameter} density {density}
    set type 1*3 sph/rho 1
    set type 1 mass 1
    set type 3 mass 1
    group water type 1
    group grains type 2
    group floor type 3
    group sph type 1 3
    pair_style hybrid/overlay sph/artVisc/tensCorr wendland {H} viscosity {mu} {pair} zero 1
    pair_coeff * * zero
    pair_coeff 1 1 sph/artVisc/tensCorr c {c} deltap 1
    pair_coeff 1 3 sph/artVisc/tensCorr
    pair_coeff 3 3 sph/artVisc/tensCorr c {c} deltap 1
    comm_modify vel yes
    neighbor 0.3 bin
    neigh_modify delay 0 every 1
    timestep {dt}
    fix eos sph sph/pressure Tait {c * c / 7} 1 7
    fix den sph sph/density/continuity delta {delta} volume yes
    {f"fix wall floor wall/adami/sph gravity {gravity}" if floor else ""}
    fix mw water nve/sph
    {mover}
    {before_fix}
    fix g grains sph/grains {fix}
    """


def singles(places):
    return "\n".join("create_atoms 2 single %.17g %.17g %.17g units box" % tuple(p) for p in places)


def brown_lawler(Re):
    return 24 * (1 + 0.15 * Re**0.681) + 0.407 * Re * Re / (Re + 8710)


def richardson_zaki(Re, e):
    """w_0/w and the Reynolds number of w_0."""
    ratio = 1.0
    for _ in range(200):
        n = min(4.65, max(2.39, 4.4 * (Re * ratio) ** (-0.03 if Re * ratio < 1 else -0.1)))
        ratio = e ** (1 - n)
    return ratio


def of_bed(law, Re, e):
    """F/(3 pi mu d w) as published."""
    phi, s = 1 - e, e * Re
    if law == "beetstra":
        inertia = (1 / e + 3 * phi * e + 8.4 * s**-0.343) / (1 + 10 ** (3 * phi) * s ** (-(1 + 4 * phi) / 2))
        return 10 * phi / e**2 + e**2 * (1 + 1.5 * phi**0.5) + 0.413 * s / (24 * e**2) * inertia
    if law == "brown_lawler":
        ratio = richardson_zaki(Re, e)
        return brown_lawler(Re * ratio) / 24 * ratio
    return 150 * phi / (18 * e * e) + 1.75 * Re / (18 * e)
