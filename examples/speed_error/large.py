"""What Ewald sums are for: scenes of 10^4 spheres in a periodic box and 10^5 in an open one, their settings, what must
hold."""
from runs import np

EXACT = "cut_off_distance inf far_field ewald"
STEPS = 5


def suspension(n, phi):
    """Equal spheres in a cube, each moved at random within its cell of a lattice, so that none overlap."""
    m = round(n**(1 / 3))
    cell = (4 / 3 * np.pi / phi)**(1 / 3)
    corner = np.stack(np.meshgrid(*3 * [np.arange(m)], indexing="ij"), -1).reshape(-1, 3)
    x = cell * (corner + 0.5) + np.random.default_rng(1).uniform(-1, 1, (m**3, 3)) * (0.5 * cell - 1.0)
    return (x, np.ones(m**3), np.zeros(m**3, int)), m * cell


def options(pairs):
    """(family, words, False) of pairs of relative_tolerance and far_field_tolerance, and of other ways at 1e-3"""
    solver = f"{EXACT} algorithm 2 relative_tolerance"
    for tolerance, far in pairs:
        if far == "auto":
            yield "tolerance", f"{solver} {tolerance}", False
        else:
            yield "far_field_tolerance", f"{solver} {tolerance} far_field_tolerance {far}", False
    for family, words in ("precondition", "precondition none"), ("warm_start no",
                                                                 "warm_start no"), ("update_every", "update_every 5"):
        yield family, f"{solver} 1e-3 {words}", False


def scenes(quick):
    """name: (spheres, side of the periodic box or None, words of the reference, settings)"""
    with_auto = [(t, "auto") for t in ("1e-1", "1e-2", "1e-3", "1e-4", "1e-6")]
    others = [("1e-3", t) for t in ("1e-1", "1e-2", "1e-3", "1e-6")]
    n = 10 if quick else 22
    yield (f"periodic {n}^3, phi 0.2", *suspension(n**3, 0.2), "relative_tolerance 1e-9 far_field_tolerance 1e-10",
           options(with_auto + others))
    n = 12 if quick else 46
    yield (f"open {n}^3, phi 0.05", suspension(n**3, 0.05)[0], None, "relative_tolerance 1e-7 far_field_tolerance 1e-8",
           options(with_auto[:-1] + others))


def check(c, name, points, wanted):
    """far_field_tolerance auto, a tenth of relative_tolerance, is as good as a far tighter one; a loose one shows."""
    error = {p[2].partition("relative_tolerance ")[2]: p[0] for p in points}
    for tolerance in ("1e-2", "1e-3", "1e-4"):
        c.below(f"{name}: error over relative_tolerance {tolerance}", error[tolerance] / float(tolerance), 8)
    c.within(f"{name}: error of far_field_tolerance auto over that of 1e-6",
             error["1e-3"] / error["1e-3 far_field_tolerance 1e-6"],
             0.5, 3.0)
    c.below(f"{name}: error of far_field_tolerance auto over that of 1e-1",
            error["1e-3"] / error["1e-3 far_field_tolerance 1e-1"], 0.2)
    c.holds(f"{name}: a setting has all errors below {wanted:g}", any(p[0] <= wanted for p in points))
