"""The howtos run as they stand on the page, commands pasted into a shell, and print what the page says.

A block of a page whose first line is "# NAME" with a dot in NAME is that file. A block that begins with "Step" is what
the log of the input before it must hold. The first block of commands, which begins with ". build/env.sh", is pasted as
it is."""
import os
import pathlib
import re
import subprocess
import sys

import pytest

from host import PATIENCE, environment

TOP = pathlib.Path(__file__).resolve().parents[3]
DOC = TOP / "PKG-STOKESDYN" / "doc"

# page -> how far each column of its tables may be off (relative)
HOWTOS = {
    "brownian": {"c_mean": 0.25},
    "clumps": {"v_drift": 1e-2},
    "cfd": {},
    "overdamped": {},
    "mud": {"v_front": 0.02, "v_inner": 0.01, "v_outer": 0.01},
    "sph": {"c_kinetic": 0.5},
    "stream": {"v_surface": 0.04, "f_stream[4]": 0.6, "f_stream[8]": 0.35},
    "waves": {"v_surface": 0.05, "f_water[4]": 0.6, "f_water[8]": 0.35},
    "rheology": {"f_mean[1]": 0.05, "f_mean[2]": 0.5, "f_mean[3]": 0.5, "f_mean[4]": 0.2},
    "suspension": {"v_down": 0.04, "f_move[1]": 0.25},
    "speed": {},
    "shapes": {},
    "magnetic": {},
    "active": {"c_memory": 0.1, "c_square[4]": 0.1},
    "swimmers": {},
    "fibres": {},
    "python": {},
}
PASTE = re.compile(r"^    \. build/env\.sh\n(?:    .*\n)+", re.M)


def blocks(name):
    return re.findall(r"^```\n(.*?)^```", (DOC / f"howto_{name}.md").read_text(), re.S | re.M)


def paste(commands, clone):
    """What the commands print in a shell that stands in a clone. The clone is a folder with links: what they write
    stays here."""
    for name in ("PKG-STOKESDYN", "examples", "build"):
        (clone / name).symlink_to(TOP / name if name != "build" else os.environ["LAMMPS_PLUGIN_PATH"])
    env = {key: value for key, value in environment().items() if not key.startswith(("LAMMPS_", "LD_", "PYTHONPATH"))}
    env["PATH"] = os.path.dirname(sys.executable) + ":" + env["PATH"]      # the python3 that has numpy
    done = subprocess.run(["bash", "-e"], input=commands, cwd=clone, env=dict(env, MPLCONFIGDIR=str(clone)),
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=PATIENCE)
    assert done.returncode == 0, done.stdout[-3000:]
    return done.stdout


def follow(name, folder):
    """The block of commands of the page, pasted: what it prints."""
    said = paste(PASTE.search((DOC / f"howto_{name}.md").read_text()).group(), folder)
    for block in blocks(name):
        file = re.match(r"# ([A-Za-z_]+\.[A-Za-z_.]+)", block)
        assert not file or (folder / "try" / file.group(1)).read_text() == block
    return said


@pytest.mark.parametrize("name", HOWTOS)
def test_a_howto_runs_as_it_stands(name, tmp_path):
    said, page = follow(name, tmp_path), (DOC / f"howto_{name}.md").read_text()
    for block in blocks(name):
        if not block.startswith("Step"):
            continue
        head, *rows = [line.split() for line in block.splitlines()]
        table = said[re.search(r"^ *" + r"\s+".join(map(re.escape, head)), said, re.M).end():]
        for row in rows:
            found = re.search(rf"^ *{row[0]} +(.*)$", table, re.M)
            assert found, f"no row {row[0]} below {head}"
            for column, wanted, got in zip(head[1:], row[1:], found.group(1).split()):
                assert float(got) == pytest.approx(float(wanted),
                                                   rel=HOWTOS[name].get(column, 1e-3)), (column, wanted, got)
    # LAMMPS itself writes it as PPM, which every LAMMPS can
    for picture in re.findall(r"\]\((howto_\w+)\.png\)", page):
        assert max(file.stat().st_size for file in (tmp_path / "try").glob(picture + ".p[np][gm]")) > 2000, picture
    if name == "cfd":
        assert float(re.search(r"momentum lost (\S+)", said).group(1)) < 1e-12
    if name == "python":
        printed = re.findall(r"^    (\S.*)$", re.sub(r"```\n.*?```", "", PASTE.sub("", page), flags=re.S), re.M)
        assert said.splitlines() == ["rod.py"] + printed
    if name == "waves":    # the closed form of the Stokes layer; grains that stick stay in the bed
        assert float(re.search(r"largest error (\S+)", said).group(1)) < 5e-4
        loose, stuck = [[float(q) for q in re.findall(r"^ *(?:6250|18750) +\S+ +(\S+)", table, re.M)]
                        for table in re.split(r"Step +v_surface", said)[1:] if "18750" in table]
        assert len(loose) == len(stuck) == 2 and all(abs(b) < 0.01 * abs(a) for a, b in zip(loose, stuck))
    if name == "speed":
        errors = [float(error) for error in re.findall(r"^tolerance \S+ iterations \d+ error (\S+)", said, re.M)]
        assert len(errors) == 6 and errors[0] == 0.0 and all(a > b for a, b in zip(errors[1:], errors[2:]))


def test_every_howto_with_an_input_is_followed():
    with_input = {path.stem[len("howto_"):] for path in DOC.glob("howto_*.md")
                  if re.search(r"^```\n# in\.", path.read_text(), re.M)}
    assert with_input <= set(HOWTOS)


def test_the_commands_of_the_readme_settle_a_rod_as_it_says(tmp_path):
    readme = (TOP / "README.md").read_text()
    printed = paste(PASTE.search(readme).group(), tmp_path)
    said = float(re.search(r"settling velocity, (\S+) m/s", readme).group(1))
    exact = float(re.search(r"Exact Stokes flow gives (\S+) m/s", readme).group(1))
    found = float(re.search(r"^ +100 +(\S+)", printed, re.M).group(1))
    assert found == pytest.approx(said, rel=1e-3) and found == pytest.approx(exact, rel=1e-2)


@pytest.mark.parametrize("path", sorted(DOC.glob("howto_*.md")) + sorted((TOP / "examples").glob("*/README.md")) +
                         [TOP / "README.md"],
                         ids=lambda path: path.stem if path.parent == DOC else path.parent.name)
def test_commands_begin_where_a_shell_stands_in_the_clone(path):
    """One convention: a block that runs LAMMPS or an example says . build/env.sh first and then goes to the folder that
    it needs."""
    text = re.sub(r"```\n.*?```", "", path.read_text(), flags=re.S)
    for block in re.findall(r"(?:^    .*\n|^\n(?=    ))+", text, re.M):
        lines = [line[4:].split("#")[0].strip() for line in block.splitlines() if line]
        if not any(re.match(r"(mpirun .*)?lmp -in|\./run\.py|python3? \w+\.py", line) for line in lines):
            continue
        if lines[0] == "examples/run.sh":      # which makes build/env.sh
            del lines[0]
        assert lines[0] == ". build/env.sh", block
        assert re.match(r"cd examples/|examples/|mkdir -p try; cd try", lines[1]), block


def test_the_time_step_of_howto_sph_is_one_that_it_advises():
    page = (DOC / "howto_sph.md").read_text()
    low, high = map(float, re.search(r"c dt/h is ([\d.]+) to ([\d.]+)", page).groups())
    h, c, dt = (float(re.search(pattern, blocks("sph")[0], re.M).group(1))
                for pattern in (r"tensCorr wendland (\S+)", r"^pair_coeff .* c (\S+)", r"^timestep +(\S+)"))
    assert low <= c * dt / h <= high
