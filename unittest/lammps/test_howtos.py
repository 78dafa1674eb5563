"""The inputs of the howtos run as they stand on the page, and print what the page says.

A block of a page whose first line is "# NAME" with a dot in NAME is that file. A block that begins with "Step" is what the log of
the input before it must hold."""
import pathlib
import re
import subprocess
import sys

import pytest

from system import environment

DOC = pathlib.Path(__file__).resolve().parents[2] / "PKG-STOKESDYN" / "doc"

# page -> commands, and how far each column of its tables may be off (relative)
HOWTOS = {
    "clumps": (["lmp -in in.clumps"], {"v_drift": 1e-2}),
    "cfd": (["python couple.py"], {}),
    "overdamped": (["lmp -in in.overdamped"], {}),
    "sph": (["lmp -in in.sph"], {"c_kinetic": 0.5}),
    "stream": (["lmp -in in.stream", "python plot.py"], {"v_surface": 0.04, "f_stream[4]": 0.6, "f_stream[8]": 0.35}),
    "suspension": (["lmp -in in.settling"], {"v_down": 0.04, "f_move[1]": 0.25}),
    "speed": (["lmp -in in.speed"], {}),
    "python": (["python rod.py"], {}),
}


def blocks(name):
    return re.findall(r"^```\n(.*?)^```", (DOC / f"howto_{name}.md").read_text(), re.S | re.M)


def follow(name, folder):
    """The files of the page, its commands run: what they print."""
    written = subprocess.run([DOC / "files.sh", f"howto_{name}"], cwd=folder, capture_output=True, text=True, check=True).stdout.split()
    for file in written:
        assert (folder / file).read_text() in blocks(name), file
    said = ""
    for command in HOWTOS[name][0]:
        words = [sys.executable if word == "python" else word for word in command.split()]
        done = subprocess.run(words, cwd=folder, env=dict(environment(), MPLCONFIGDIR=str(folder)), stdin=subprocess.DEVNULL,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300)
        assert done.returncode == 0, done.stdout[-3000:]
        said += done.stdout
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
                assert float(got) == pytest.approx(float(wanted), rel=HOWTOS[name][1].get(column, 1e-3)), (column, wanted, got)
    for picture in re.findall(r"\]\((howto_\w+\.png)\)", page):
        assert (tmp_path / picture).stat().st_size > 2000, picture
    if name == "cfd":
        assert float(re.search(r"momentum lost (\S+)", said).group(1)) < 1e-12
    if name == "python":
        assert said.splitlines() == re.findall(r"^    (\S.*)$", re.sub(r"```\n.*?```", "", page, flags=re.S), re.M)
    if name == "speed":
        errors = [float(error) for error in re.findall(r"^tolerance \S+ iterations \d+ error (\S+)", said, re.M)]
        assert len(errors) == 6 and errors[0] == 0.0 and all(a > b for a, b in zip(errors[1:], errors[2:]))


def test_every_howto_with_an_input_is_followed():
    with_input = {path.stem[len("howto_"):] for path in DOC.glob("howto_*.md") if re.search(r"^```\n# in\.", path.read_text(), re.M)}
    assert with_input <= set(HOWTOS)


def test_the_input_of_the_readme_settles_as_it_says(tmp_path):
    readme = (DOC.parents[1] / "README.md").read_text()
    block = re.search(r"^    plugin +load.*?(?=^\S)", readme, re.S | re.M).group()
    (tmp_path / "in.rod").write_text(block)
    done = subprocess.run(["lmp", "-in", "in.rod"], cwd=tmp_path, env=environment(), stdin=subprocess.DEVNULL, capture_output=True,
                          text=True, timeout=300)
    assert done.returncode == 0, done.stdout[-2000:]
    said = re.search(r"settling velocity, (\S+) m/s", readme).group(1)
    assert float(re.search(r"^ +100 +(\S+)", done.stdout, re.M).group(1)) == pytest.approx(float(said), rel=1e-3)
