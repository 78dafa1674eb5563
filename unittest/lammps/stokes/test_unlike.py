"""Spheres of unlike radii as shells whose points go with the radius (multiblob 12 lubrication yes), through LAMMPS,
against exact Stokes flow (unlike.py)."""
import numpy as np
import pytest

import unlike

BY_RADIUS = "multiblob 12 lubrication yes"
EXACT = unlike.rows()


def errors(simulation, tmp_path, ratio, xi, count, style=BY_RADIUS):
    """Per cent of each sphere's own scale, [ways][loads][large, small], and the motions beside the exact ones"""
    V = unlike.motions(simulation, tmp_path, ratio, xi, style, unlike.turns(count))
    V0 = unlike.exact(EXACT[ratio, xi])
    return 100 * unlike.errors(V, V0, ratio), V, V0


@pytest.mark.parametrize("ratio, xi", [(2.0, 0.055), (2.5, 0.01), (3.0, 0.1), (5.0, 0.01), (5.0, 0.3), (7.0, 0.055),
                                       (10.0, 0.01)])
def test_lone_pairs(simulation, tmp_path, ratio, xi):
    """Some orientations; the means of twelve are 2 % at most (test_unlike_pair.c), the worst of them 3.2 %."""
    off, _, _ = errors(simulation, tmp_path, ratio, xi, 3 if ratio < 6 else 1)
    assert off[..., 1].max() < 3.2
    assert off[..., 0].max() < 6    # the large one, of its own tiny motion by loads on the small one


def test_points_of_the_large_sphere_alone_make_the_difference(simulation, tmp_path):
    """A small sphere in the shear beside one ten times as large: with 12 points for both its spin is wrong by more than
    15 %."""
    by_radius, old = (errors(simulation, tmp_path, 10.0, 0.1, 1, style)
                      for style in (BY_RADIUS, BY_RADIUS + " multiblob_most 12"))
    k = unlike.LOADS.index("E shear")
    spin = [np.linalg.norm((V - V0)[:, k, 1, 3:]) / np.linalg.norm(V0[k, 1, 3:]) for _, V, V0 in (by_radius, old)]
    assert spin[0] < 0.03 and spin[1] > 0.15


@pytest.mark.parametrize("xi", [0.1, 1.9])
def test_cases_of_lamb(simulation, tmp_path, xi):
    """Ratio 10 of the 88 cases of Pecnut/stokesian-dynamics, along x as there: what the smaller sphere does by a load
    on the other one or in a strain, velocities and spins over their own exact values; what it does by its own load,
    over its own largest motion."""
    V0 = unlike.exact(EXACT[10.0, xi])
    along_x = np.array([(0, 0, 1), (1, 0, 0), (0, 1, 0)])
    V = unlike.motions(simulation, tmp_path, 10.0, xi, BY_RADIUS, [along_x])
    off = 100 * unlike.errors(V, V0, 10.0)[0, :, 1]
    for k, load in enumerate(unlike.LOADS):
        if "_s" in load:
            assert off[k] < 1, load
            continue
        for part, most in ((slice(0, 3), 0.01), (slice(3, 6), 0.03)):
            known = np.abs(V0[k, 1, part]).max()
            if known > 0:
                assert np.abs(V[0, k, 1, part] - V0[k, 1, part]).max() < most * known, load


# --- groups -----------------------------------------------------------------------------------------------------------

# The worst small sphere in strain, under unlike forces and under unlike torques, per cent, of a prototype in
# Python. With 12 points for all they are 5 to 43 in strain.
PROTOTYPE = {"1 + 3x0.333 close": (1.5, 0.9, 1.2), "1 + 3x0.2 apart": (0.9, 1.0, 2.6),
             "1 0.5 0.333 0.1": (0.6, 0.4, 0.6), "1 + 2x0.1": (1.0, 1.8, 3.0), "1 + 3x0.1 close": (1.3, 2.5, 4.9),
             "1 1 0.2 in the gap": (1.6, 0.7, 0.4), "1 1 0.1 in the gap": (0.8, 3.1, 0.2)}


@pytest.mark.parametrize("case", sorted(PROTOTYPE))
def test_groups(simulation, case):
    off = unlike.group_errors(unlike.group_motions(simulation, case, BY_RADIUS), case)
    small = unlike.GROUPS[case][1] < 0.99
    for kind, known in zip(("strain", "forces", "torques"), PROTOTYPE[case]):
        assert off[kind][small].max() < known + 0.3, (kind, off[kind])
        assert off[kind][~small].max() < 1.0, (kind, off[kind])
