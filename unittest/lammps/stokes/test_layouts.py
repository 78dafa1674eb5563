"""The forces do not depend on ranks, newton, decomposition or neighbour exclusions.

All cases of data/golden.csv, in one run of lmp for each number of ranks."""
import itertools

import pytest

from system import dump_lines, input_lines, largest_difference, lmp, read_dump
from test_golden import CASES, EXACT, answer, eta_of, reach, si, spheres_of

DIFFERENCE = 1e-10      # of the largest force, to one rank, newton on, brick, no exclusions
MODES = ("all", "list", "clump")
EXCLUSIONS = {"none": "", "exclude": "neigh_modify exclude molecule/intra all",
              "special": "special_bonds lj 0 0 0 coul 0 0 0"}
LAYOUTS = list(itertools.product(("on", "off"), ("brick", "tiled"), EXCLUSIONS))


def style_of(name, mode):
    r = float(reach(spheres_of(name)))
    words = {"all": "cut_off_distance inf", "list": f"cut_off_distance {r!r}", "clump": "clumps_only yes"}[mode]
    return f"{words} visc {eta_of(name)!r} {EXACT}"


def block(folder, name, mode, newton, comm, exclusion):
    """Input for one case in one layout, from clear to clear."""
    spheres = spheres_of(name).chain_bonds()
    key = "-".join((name, mode, newton, comm, exclusion))
    parts = f"comm_modify cutoff {float(reach(spheres))!r}\n" + ("comm_style tiled\nbalance 1.0 rcb" if comm == "tiled"
                                                                 else "")
    lines = input_lines(spheres, style_of(name, mode), folder / (key + ".data"), newton=newton, comm=parts,
                        before_pair=si(name) + "\n" + EXCLUSIONS[exclusion])
    return lines + dump_lines(folder / (key + ".dump"),
                              columns="f_drag[1] f_drag[2] f_drag[3]") + ["run 0 post no", "clear"]


@pytest.fixture(scope="module", params=[1, *(pytest.param(n, marks=pytest.mark.ranks(n)) for n in (2, 4))],
                ids=lambda n: f"{n}ranks")
def forces(request, tmp_path_factory):
    """Forces of every case, mode and layout on 1, 2 or 4 ranks."""
    folder = tmp_path_factory.mktemp("layouts")
    lines, keys = [], list(itertools.product(CASES, MODES, LAYOUTS))
    for name, mode, layout in keys:
        lines += block(folder, name, mode, *layout)
    lmp(folder, lines, ranks=request.param)
    return {key: read_dump(folder / ("-".join((key[0], key[1]) + key[2]) + ".dump"))[0][1] for key in keys}


@pytest.mark.parametrize("layout", LAYOUTS, ids="-".join)
def test_layout_leaves_the_forces_alone(forces, layout):
    for name, mode in itertools.product(CASES, MODES):
        reference = answer(name, "clump" if mode == "clump" else "all")
        assert largest_difference(forces[name, mode, layout], reference) < 1e-9, (name, mode)
        assert largest_difference(forces[name, mode, layout], forces[name, mode, LAYOUTS[0]]) < DIFFERENCE, (name, mode)


@pytest.fixture(scope="module")
def one_rank(tmp_path_factory):
    folder = tmp_path_factory.mktemp("one")
    lines = []
    for name, mode in itertools.product(CASES, MODES):
        lines += block(folder, name, mode, *LAYOUTS[0])
    lmp(folder, lines)
    return {(name, mode): read_dump(folder / ("-".join((name, mode) + LAYOUTS[0]) + ".dump"))[0][1]
            for name, mode in itertools.product(CASES, MODES)}


@pytest.mark.hard_case("ranks, newton, decomposition, exclusions: golden.csv")
@pytest.mark.parametrize("mode", MODES)
def test_ranks_leave_the_forces_alone(forces, one_rank, mode):
    for name in CASES:
        for layout in LAYOUTS:
            assert largest_difference(forces[name, mode, layout], one_rank[name, mode]) < DIFFERENCE, (name, layout)
