"""Cases of all styles (for fuzz.py), and how often each is drawn."""
from fuzz_grammar import Case
from fuzz_sph import (make_sph_adami, make_sph_check, make_sph_coeff, make_sph_density, make_sph_global,
                      make_sph_grains, make_sph_move, make_sph_opening, make_sph_order, make_sph_pair,
                      make_sph_pressure, make_sph_tension, make_sph_wall)
from fuzz_stokes import make_overdamped, make_stokes, make_stokes_coeff, make_stokes_fix
from fuzz_vans import make_vans, make_vans_modify

MAKERS = [(make_stokes, 42), (make_stokes_fix, 4), (make_stokes_coeff, 1), (make_overdamped, 10), (make_vans, 24),
          (make_vans_modify, 2), (make_sph_pair, 8), (make_sph_order, 12), (make_sph_global, 3), (make_sph_coeff, 5),
          (make_sph_pressure, 3), (make_sph_density, 3), (make_sph_move, 1),
          (make_sph_wall, 4), (make_sph_adami, 2), (make_sph_check, 2), (make_sph_opening, 8), (make_sph_grains, 6),
          (make_sph_tension, 5)]


def draw(seed, number):
    """A case of any style, made of its seed and number alone."""
    return Case(seed, number, MAKERS)
