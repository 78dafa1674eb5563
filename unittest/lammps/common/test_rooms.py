"""The rooms of the house: what a model may include, as its include path has it. The build tells it in
compile_commands.json."""
import ast
import json
import os
import pathlib
import re
import shlex
import subprocess

import pytest

TOP = pathlib.Path(__file__).resolve().parents[3]
BUILD = os.environ["LAMMPS_PLUGIN_PATH"]

# a header of each room, and of the libraries
OF = {"base": "sd_status.h", "drag": "sd_drag.h", "stokes": "sd_tensor.h", "sph": "sd_sph_kernel.h",
      "vans": "sd_vans.h", "LAMMPS": "lammps.h", "MPI": "mpi.h",
      "common": "keywords.h", "glue of stokes": "pair_stokes_dynamics.h", "glue of sph": "sph.h",
      "glue of vans": "vans_settings.h"}
SEES = {
    "stokesdyn_base": {"base"}, "stokesdyn_drag": {"base", "drag"}, "stokesdyn_stokes": {"base", "stokes"},
    "stokesdyn_sph": {"base", "drag", "sph"}, "stokesdyn_vans": {"base", "drag", "vans"},
    "styles_common": {"LAMMPS", "MPI", "common"},
    "styles_stokes": {"LAMMPS", "MPI", "common", "base", "stokes", "glue of stokes"},
    "styles_sph": {"LAMMPS", "MPI", "common", "base", "drag", "sph", "glue of sph"},
    "styles_vans": {"LAMMPS", "MPI", "common", "base", "drag", "vans", "glue of vans"},
}


def compiler(target):
    """The command that compiles a file of the target, without the file."""
    with open(os.path.join(BUILD, "compile_commands.json")) as file:
        entries = [entry for entry in json.load(file) if f"/{target}.dir/" in entry["command"]]
    words = shlex.split(entries[0]["command"])
    return words[os.path.basename(words[0]) == "ccache":words.index("-o")]


@pytest.mark.parametrize("target", SEES)
def test_a_room_sees_itself_and_what_is_below(target):
    seen = set()
    for room, header in OF.items():
        language = "c++" if target.startswith("styles") else "c"
        done = subprocess.run(compiler(target) + ["-x", language, "-E", "-o", os.devnull, "-"],
                              input=f'#include "{header}"\n', stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True)
        assert done.returncode == 0 or f"{header}: No such file" in done.stdout, done.stdout
        if done.returncode == 0:
            seen.add(room)
    assert seen == SEES[target]


def test_who_asks_the_boundary_stands_in_the_map():
    stokes = TOP / "PKG-STOKESDYN" / "stokes"
    asks = {path.stem for path in stokes.rglob("*.*") if re.search(r"\bboundary\.(?!h\b)\w|[.&]boundary\b|\bboundary,",
                                                                path.read_text())}
    asks -= {"boundary", "boundary_checks", "scene_at_boundary"}
    listed = re.search(r"\n\* \*\*Walls\.\*\*(.*?)\n\* ", (TOP / "PKG-STOKESDYN" / "README.md").read_text(),
                       re.S).group(1)
    assert "engine" in asks
    assert not [name for name in sorted(asks) if f"`{name}`" not in listed]


def test_every_engine_climbs_the_ladder():
    engines = re.findall(r"^extern const sd_mobility_engine (\w+);",
                         (TOP / "PKG-STOKESDYN/core/stokes/mobility/sd_mobility.h").read_text(), re.M)
    placed = (TOP / "unittest/core/stokes/mobility/engines.h").read_text()
    assert len(engines) >= 5
    assert not [name for name in engines if f"engine = &{name};" not in placed]


def test_a_name_of_a_function_stands_in_one_file():
    """So that grep, a breakpoint and a profile mean one thing."""
    found = {}
    for path in (TOP / "PKG-STOKESDYN").rglob("*"):
        if path.suffix in (".c", ".h", ".cpp"):
            for name in re.findall(r"^static [\w\s*:<>,]*?[\s*](\w+)\(", path.read_text(), re.M):
                found.setdefault(name, set()).add(path.name)
    assert len(found) > 900
    assert {name: files for name, files in found.items() if len(files) > 1} == {}


def parameters(listed):
    """Of a list between brackets; commas of types and nested brackets do not count."""
    while (plain := re.sub(r"<[^<>]*>|\([^()]*\)|\{[^{}]*\}", "", listed)) != listed:
        listed = plain
    return listed.count(",") + 1


def test_functions_have_at_most_eight_parameters():
    """More of them are a struct that has no name yet. Two functions stand in for those of LAPACK and MPI."""
    function = re.compile(r"^(?:\w[\w\s*&:<>,]*?)?([\w:~]+)\(((?:[^(){};]|\([^(){};]*\))*)\)[^;{}()]*\{", re.M)
    found = {}
    for room in ("PKG-STOKESDYN", "unittest"):
        for path in (TOP / room).rglob("*"):
            if path.suffix not in (".c", ".h", ".cpp"):
                continue
            text = re.sub(r"/\*.*?\*/|//[^\n]*", "", path.read_text(), flags=re.S)
            for name, listed in function.findall(text):
                found[name] = max(parameters(listed), found.get(name, 0))
    assert len(found) > 3000
    assert {name for name, count in found.items() if count > 8} == {"dpotrs_", "MPI_Alltoallv"}


def long_functions(path):
    """Names of those with more than 60 lines in braces (C, C++) or below their first line (Python)"""
    text = path.read_text()
    if path.suffix == ".py":
        return [node.name for node in ast.walk(ast.parse(text))
                if isinstance(node, ast.FunctionDef) and node.end_lineno - node.lineno > 60]
    return [head for head, body in re.findall(r"([^\n]*)\n\{\n(.*?)^\}", text, re.S | re.M) if body.count("\n") > 60]


def test_functions_have_at_most_60_lines():
    paths = [path for room in ("PKG-STOKESDYN", "unittest", "examples") for path in (TOP / room).rglob("*")
             if path.suffix in (".c", ".h", ".cpp", ".py")]
    assert len(paths) > 900
    assert {path.name: names for path in paths if (names := long_functions(path))} == {}


def sources_below():
    """{source: sources that it calls}, {header: headers that it includes} of the core"""
    texts = {path: re.sub(r"/\*.*?\*/|//[^\n]*", "", path.read_text(), flags=re.S)
             for path in (TOP / "PKG-STOKESDYN/core").rglob("*.[ch]")}
    sources = {path: text for path, text in texts.items() if path.suffix == ".c"}
    headers = {path.name: text for path, text in texts.items() if path.suffix == ".h"}
    defined = {name: path.name for path, text in sources.items()
               for name in re.findall(r"^(?!static|typedef)\w[\w *]*?\b(sd_\w+)\([^;{}]*\)\s*\{", text, re.M)}
    calls = {path.name: {defined[name] for name in re.findall(r"\b(sd_\w+)\(", text) if name in defined}
             for path, text in sources.items()}
    includes = {name: {other for other in re.findall(r'#include "([^"]+)"', text) if other in headers}
                for name, text in headers.items()}
    return calls, includes


def circles(arrows):
    """What is left when files that stand on nothing are taken away, again and again: circles, and what stands on
    them"""
    left = {name: below - {name} for name, below in arrows.items()}
    while ground := {name for name, below in left.items() if not below & set(left)}:
        left = {name: below for name, below in left.items() if name not in ground}
    return left


def test_no_files_of_the_core_call_or_include_each_other_in_a_circle():
    calls, includes = sources_below()
    assert "sd_tie.c" in calls["sd_bodies.c"] and "sd_ewald_box.h" in includes["sd_ewald_chosen.h"]
    assert circles(calls) == {} and circles(includes) == {}


def test_no_files_of_the_glue_include_each_other_in_a_circle():
    """A header and the source of its name count as one; further sources of a class include both sides, and nobody
    includes them."""
    texts = {}
    for room in ("common", "stokes", "sph", "vans"):
        for path in (TOP / "PKG-STOKESDYN" / room).rglob("*"):
            if path.suffix in (".h", ".cpp"):
                texts[path.stem] = texts.get(path.stem, "") + path.read_text()
    includes = {name: set(re.findall(r'#include "([^"]+)\.h"', text)) & set(texts) for name, text in texts.items()}
    assert "pair_sph_artvisc_tenscorr" in includes["fix_sph_friction"] and "scene" in includes["solve"]
    assert circles(includes) == {}


def arrows_between_rooms(depth=None):
    """{room: rooms whose headers it includes}; depth: of folders that count, deeper ones are parts of them"""
    files = [path for path in (TOP / "PKG-STOKESDYN").rglob("*") if path.suffix in (".c", ".h", ".cpp")]
    room = {path.name: "/".join(path.parent.relative_to(TOP / "PKG-STOKESDYN").parts[:depth]) for path in files}
    arrows = {name: set() for name in room.values()}
    for path in files:
        arrows[room[path.name]] |= {room[name] for name in re.findall(r'#include "([^"]+)"', path.read_text())
                                    if name in room}
    return {name: below - {name} for name, below in arrows.items()}


def test_no_rooms_include_each_other_in_a_circle():
    arrows = arrows_between_rooms()
    assert "core/stokes/bodies" in arrows["stokes/bodies"] and "stokes/fluid" in arrows["stokes/scene"]
    assert circles(arrows) == {}


@pytest.mark.parametrize("rooms, row", [
    ("stokes", r"^\| (`stokes/\w+/`) \|"), ("core/stokes", r"^  \| ((?:`\w+/`(?:, )?)+) \|"),
    ("core/stokes/ewald", r"^  \| (`ewald/\w+/`) \|")])
def test_the_map_has_rooms_in_the_order_in_which_they_stand_on_each_other(rooms, row):
    """Those of the glue from above, those of the core from below"""
    rows = "".join(re.findall(row, (TOP / "PKG-STOKESDYN" / "README.md").read_text(), re.M))
    order = [f"{rooms}/{name}" for name in re.findall(r"(\w+)/`", rows)][::-1 if "core" in rooms else 1]
    arrows = arrows_between_rooms(depth=order[0].count("/") + 1)
    assert set(order) == {name for name in arrows if name.startswith(rooms + "/")}
    for number, name in enumerate(order):
        assert arrows[name] & set(order) <= set(order[number:]), name


# --- how sources read -------------------------------------------------------------------------------------------------

def scripts():
    """Sources and inputs beside the package: no data, logs, pictures and pages"""
    kinds = (".py", ".c", ".h", ".cpp", ".sh", ".cmake")
    return [path for room in ("unittest", "examples", "cmake") for path in sorted((TOP / room).rglob("*"))
            if path.name.endswith(kinds) or path.name.startswith(("in.", "CMakeLists"))]


# of LAMMPS, MPI and another program, and examples of names
ELSEWHERE = {"fix_deform.h", "mpi.h", "test_tensors.py", "a.c", "NAME_kernels.c"}


def test_comments_name_files_that_are_here():
    here = {path.name for room in ("PKG-STOKESDYN", "unittest", "examples", "cmake")
            for path in (TOP / room).rglob("*")}
    named = {}
    for path in (path for room in ("PKG-STOKESDYN", "unittest") for path in (TOP / room).rglob("*.*")):
        comment = {".py": r"# [^\n]*|\"\"\".*?\"\"\""}.get(path.suffix, r"/\*.*?\*/|//[^\n]*")
        if path.suffix not in (".c", ".h", ".cpp", ".py"):
            continue
        for text in re.findall(comment, path.read_text(), re.S):
            for name in re.findall(r"(?<![\w/*.-])[\w-]+\.(?:h|c|cpp|md|py|csv)\b", text):
                named.setdefault(name, path.name)
    assert len(named) > 150
    assert {name: path for name, path in named.items() if name not in here | ELSEWHERE} == {}


def test_lines_of_scripts_have_at_most_120_columns():
    files = scripts()
    assert len(files) > 500
    assert not [f"{path.relative_to(TOP)}:{number}" for path in files
                for number, line in enumerate(path.read_text().splitlines(), 1) if len(line) > 120]


def test_files_of_tests_have_at_most_500_lines():
    """Each has one idea."""
    files = [path for path in scripts() if "unittest" in path.parts and path.suffix in (".py", ".c", ".h", ".cpp")]
    assert len(files) > 250
    assert not [path.name for path in files if len(path.read_text().splitlines()) > 500]
