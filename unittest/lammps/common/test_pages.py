"""The pages and the sources say the same: every message, every keyword and every style of the sources is on a page, and
a page holds no message that no source has. Pages are read as a user searches them: by the first words of what LAMMPS
has printed."""
import csv
import pathlib
import re

import pytest

import neighbour_tables

PACKAGE = pathlib.Path(__file__).resolve().parents[3] / "PKG-STOKESDYN"
PAGES = {path.name: path.read_text() for path in sorted((PACKAGE / "doc").glob("*.md"))}
EVERYWHERE = "howto_trouble.md"    # messages that all styles share
ROOMS = {    # the pages on which the messages of a folder may stand
    "stokes": ["pair_stokes_dynamics.md", "messages_stokes_dynamics.md", "fix_stokes_dynamics.md",
               "fix_stokes_dynamics_overdamped.md", "messages_overdamped.md", "flow_grid.md",
               "fix_stokes_dynamics_field.md", "compute_stokes_dynamics_stress.md"],
    "sph": [name for name in PAGES if "sph" in name],
    "vans": ["fix_hydro_vans.md", "messages_hydro_vans.md"],
}
STYLES = [name for name in PAGES if name.startswith(("pair_", "fix_", "compute_"))]
# tables of messages that are too long for the style's page
MESSAGES = [name for name in PAGES if name.startswith("messages_")]

TEXT = re.compile(r'"((?:[^"\\]|\\.)*)"')
EITHER = re.compile(r"\?\s*((?:\"[^\"]*\"\s*)+):\s*((?:\"[^\"]*\"\s*)+)")    # condition ? "one" : "other"
CALL = re.compile(r"\b(?:fail|fail_one|fail_by|require|refuse|check|all|one|warning|warn)\s*\(")
HOLE = "\0"


def without_comments(source):
    return re.sub(r"/\*.*?\*/|(?<![:\"])//[^\n]*", "", source, flags=re.S)


def last_argument(source, begin):
    """Of a call whose parenthesis opens before `begin`: its last argument, and where the call ends."""
    depth, at, argument = 1, begin, begin
    while depth:
        token = re.compile(r"\"(?:[^\"\\]|\\.)*\"|'(?:[^'\\]|\\.)'|[()\[\]{},]").search(source, at)
        depth += {"(": 1, "[": 1, "{": 1, ")": -1, "]": -1, "}": -1}.get(token.group(), 0)
        at = token.end()
        if token.group() == "," and depth == 1:
            argument = at
    return source[argument:at - 1], at


def joined(code):
    """The strings of an expression, put together; a hole where something else stands between two of them."""
    words, at = "", 0
    for string in TEXT.finditer(code):
        if code[at:string.start()].strip():
            words += HOLE
        words += string.group(1)
        at = string.end()
    return words + (HOLE if code[at:].strip() else "")


def room_of(path):
    """Of a file of the glue: common, stokes, sph or vans; of those above, the package itself"""
    return PACKAGE.name if path.parent == PACKAGE else path.relative_to(PACKAGE).parts[0]


def messages():
    """(folder, file, message) of all errors and warnings of the glue, the status texts of the core, the loader's
    reasons."""
    for path in sorted(PACKAGE.rglob("*.cpp")):
        source, end = without_comments(path.read_text()), 0
        for call in CALL.finditer(source):
            if call.start() < end:
                continue
            code, end = last_argument(source, call.end())
            for way in (r"\1", r"\2"):
                if TEXT.search(code):
                    yield room_of(path), path.name, joined(EITHER.sub(way, code))
        for table in re.findall(r"\bwhy\[\] = \{(.*?)\};", source, re.S):
            for code in re.split(r",\s*(?=\")", table):
                yield room_of(path), path.name, joined(code)
    status = without_comments((PACKAGE / "core/base/sd_status.h").read_text())
    for text in re.findall(r"_\(SD_\w+, \"(.*?)\"\)", status):
        yield "stokes", "sd_status.h", text
    for name in ("stokesdynloader.c", "stokesdynplugin.cpp"):
        source = without_comments((PACKAGE / name).read_text())
        for call in re.finditer(r"\b(?:printf|snprintf)\s*\(", source):
            code = source[call.end():last_argument(source, call.end())[1]]
            yield "common", name, re.sub(r"%\w", HOLE, joined(code[code.index('"'):]))


# what a message may begin with before it says anything: the command, the step
COMMAND = re.compile(r"(?:[\s.:]|ERROR:|Fix(?=\s+\.)|Pair style \S+:|step(?=\s+\.)|stokesdynplugin\.so:)+")


# what may be put before a message where it is given: the voice of a keyword
BEFORE = re.compile(r"^(keyword \w+:|\w+ yes) ")


def words(text):
    """The words of a message or of a row, without what differs from run to run and without punctuation between them."""
    text = re.sub(r"%\w|\\.|" + HOLE, " ... ", text)
    text = text[COMMAND.match(" " + text).end() - 1:].replace("...", " ")
    return [word for word in (word.strip(" :;,.'`()[]=") for word in text.split()) if word]


ALL = sorted({(room, file, " ".join(words(message)[:5])) for room, file,
              message in messages() if re.search("[a-z]{2}", message) and words(message) != ["atom"]})


def rows(name):
    """What a page's tables of messages list: their first columns."""
    listed, table = [], False
    for line in PAGES.get(name, "").splitlines():
        table = line.startswith("|") and (table or line.startswith("| message |"))
        if table and not re.match(r"\|(---| message \|)", line):
            listed.append(line[1:].split(" | ")[0].strip())
    return listed


@pytest.mark.parametrize("room, file, begin", ALL)
def test_the_first_words_of_a_message_are_on_a_page(room, file, begin):
    where = ROOMS.get(room, []) + [EVERYWHERE]
    begin = begin.split()
    listed = [row for name in where for row in rows(name)]
    listed += [BEFORE.sub("", row) for row in listed]
    assert any(words(row)[:len(begin)] == begin
               for row in listed), f"no table of {where} has a row that begins with {begin}"


def test_there_are_messages():
    assert len(ALL) > 150
    assert ("stokes", "settings.cpp", "keyword visc is required the") in ALL
    assert ("common", "keywords.cpp", "must be > 0") in ALL


@pytest.mark.parametrize("name", STYLES + MESSAGES)
def test_no_page_has_a_message_that_no_source_has(name):
    sources = HOLE.join(joined(without_comments(path.read_text())) for path in PACKAGE.rglob("*.*")
                        if path.suffix in (".cpp", ".c", ".h"))
    for row in rows(name):
        for piece in BEFORE.sub("", row).split("..."):
            piece = piece.strip(" :;,'()`")
            assert piece in sources or piece.replace("\\",
                                                     "") in sources, f"{name}: '{piece}' of row '{row}' is in no source"


@pytest.mark.parametrize("name", STYLES)
def test_a_page_has_its_messages_or_a_link_to_them(name):
    section = PAGES[name][PAGES[name].index("Messages and what to do"):]
    linked = [page for page in re.findall(r"\]\((\w+\.md)", section) if page in MESSAGES]
    assert rows(name) or linked and rows(linked[0])


@pytest.mark.parametrize("name", MESSAGES)
def test_messages_lead_back_to_the_page_of_their_style(name):
    linked = set(re.findall(r"\]\((\w+\.md)", PAGES[name]))
    assert rows(name) and any(f"]({name})" in PAGES[style] for style in linked & set(STYLES))


KEYWORDS = sorted({(room_of(path), keyword) for path in PACKAGE.rglob("*.cpp")
                   for keyword in re.findall(r"\{\"(\w+)\",\s*\[", path.read_text())})


@pytest.mark.parametrize("room, keyword", KEYWORDS)
def test_each_keyword_has_a_row_or_a_line_of_syntax(room, keyword):
    text = "\n".join(PAGES.get(name, "") for name in ROOMS[room])
    syntax = "\n".join(re.findall(r"## Syntax\n(.*?)\n## ", text, re.S))
    assert re.search(rf"^\| .*`{keyword}|\[{keyword} ", syntax,
                     re.M), f"keyword {keyword} is in no Syntax of {ROOMS[room]}"


def test_there_are_keywords():
    assert ("stokes", "cut_off_distance") in KEYWORDS and ("vans", "mesh") in KEYWORDS and len(KEYWORDS) >= 50


@pytest.mark.parametrize("name", PAGES)
def test_pages_are_narrow(name):
    wide = [f"{number}: {line}" for number, line in enumerate(PAGES[name].splitlines(), 1) if len(line) > 120]
    assert not wide, wide


@pytest.mark.parametrize("name", STYLES)
def test_pages_have_the_order_of_a_manual_page(name):
    order = ["Use this", "Units", "Syntax", "Examples", "Description", "Restart, output, other settings",
             "Restrictions", "Related commands", "Default", "Messages and what to do"]
    marks = re.findall(r"^(?:## |> \*\*|\*\*)(" + "|".join(order) + r")\b", PAGES[name], re.M)
    assert marks == order


@pytest.mark.parametrize("name", STYLES)
def test_the_page_of_a_style_is_read_in_ten_minutes(name):
    """What is longer stands on a page of its own, to which the style's page links."""
    assert len(PAGES[name].split()) <= 4000


@pytest.mark.parametrize("name", PAGES)
def test_no_link_leads_nowhere(name):
    for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", PAGES[name]):
        if not target.startswith("http"):
            assert (PACKAGE / "doc" / target).exists(), target


TEXTS = [PACKAGE.parent / "README.md", PACKAGE.parent / ".github" / "CONTRIBUTING.md", PACKAGE / "README.md",
         PACKAGE / "CHANGELOG.md", *sorted((PACKAGE / "doc").glob("*.md")),
         *sorted((PACKAGE.parent / "examples").rglob("*.md")),
         *sorted((PACKAGE.parent / "unittest").rglob("*.md"))]


def anchors(path):
    """Of the headings of a text, as GitHub and the manual name them."""
    headings = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", path.read_text(), flags=re.S | re.M), re.M)
    return {re.sub(r"[^\w\- ]", "", re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).lower()).replace(" ", "-")
            for heading in headings}


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_every_link_and_every_anchor_leads_somewhere(path):
    text = re.sub(r"^```.*?^```", "", path.read_text(), flags=re.S | re.M)
    for target in re.findall(r"\]\(([^)\s]+)\)", text) + re.findall(r"^\[[^]]+\]: (\S+)$", text, re.M):
        file, _, anchor = target.partition("#")
        if re.match(r"(https?|mailto):", target):
            continue
        to = (path.parent / file).resolve() if file else path
        assert to.exists(), target
        assert not anchor or anchor in anchors(to), target


def test_every_example_and_every_page_is_in_its_list():
    examples = PACKAGE.parent / "examples"
    listed = (examples / "README.md").read_text()
    assert not [path.parent.name for path in examples.glob("*/README.md")
                if f"]({path.parent.name}/README.md)" not in listed]
    assert not [name for name in PAGES if name != "index.md" and f"]({name})" not in PAGES["index.md"]]


def test_the_readme_is_short_and_the_other_texts_are_narrow():
    assert len((PACKAGE.parent / "README.md").read_text().splitlines()) < 120
    for path in (PACKAGE.parent / "README.md", PACKAGE / "README.md", PACKAGE / "CHANGELOG.md",
                 PACKAGE.parent / "examples" / "README.md"):
        assert max(len(line) for line in path.read_text().splitlines()) <= 120, path


COLUMNS_OF_PROGRAMS = [("1000", ["seconds"]), ("10000", ["seconds"]), ("100000", ["seconds"]),
                       ("10000", ["placed", "seconds"])]


def test_other_programs_take_as_long_as_the_readme_and_the_page_on_accuracy_say():
    def times(row, *what):
        return sum(float(row[name]) for name in what) / sum(float(row["ours_" + name]) for name in what)

    def said(cell):
        numbers = [float(number) for number in re.findall(r"[0-9.]+", cell)]
        return [] if not numbers else pytest.approx([numbers[0], numbers[-1]], rel=0.06)

    with open(PACKAGE.parent / "unittest" / "bench" / "peers.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    ratios = [times(row, "seconds") for row in rows]
    readme = re.search(r"(\d+) to (\d+) times as long, at the same", (PACKAGE.parent / "README.md").read_text())
    assert [min(ratios), max(ratios)] == pytest.approx([float(number) for number in readme.groups()], rel=0.15)
    table = re.findall(r"^\| (H2Pack|PyStokes|RigidMultiblobsWall|FMM3D|JFSD)[^|]*\| (?:open|periodic) \|(.*)\|$",
                       PAGES["howto_accuracy.md"], re.M)
    assert len(table) == 5
    for name, cells in table:
        for cell, (n, what) in zip(cells.split("|"), COLUMNS_OF_PROGRAMS):
            of = [times(row, *what) for row in rows if row["program"].lower().startswith(name.lower()) and
                  row["spheres"] == n]
            assert [min(of), max(of)] == said(cell) if of else not said(cell), (name, n, cell)


COLUMNS_OF_SUMS = [("periodic", "float"), ("periodic", "double"), ("open", "float"), ("open", "double"),
                   ("slit", "double")]


def test_errors_of_sums_are_those_that_the_page_on_accuracy_says():
    with open(PACKAGE.parent / "unittest" / "bench" / "speed_error.csv", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["spheres"] == "100000"]

    def measured(engine, numbers, digits=1):
        return {row["tolerance"]: re.sub("e-0", "e-", f"{float(row['error']):.{digits}e}") for row in rows
                if (row["engine"], row["numbers"]) == (engine, numbers)}

    text = PAGES["howto_accuracy.md"]
    table = re.findall(r"^\| (1e-\d) \|" + r" ([^|]*) \|" * len(COLUMNS_OF_SUMS) + "$", text, re.M)
    assert len(table) == 8
    for tolerance, *cells in table:
        errors = [measured(*column).get(f"{float(tolerance):g}", "") for column in COLUMNS_OF_SUMS]
        assert [cell.strip() for cell in cells] == errors, tolerance
        assert all(float(error) < float(tolerance) for error in errors if error), tolerance
    pairs = [error for numbers in ("double", "float") for error in measured("all pairs", numbers, 0).values()]
    assert f"the error is {pairs[0]}, and {pairs[1]} in single precision" in " ".join(text.split())


# --- which LAMMPS commands go with ours -------------------------------------------------------------------------------

@pytest.mark.parametrize("room", neighbour_tables.HEADINGS)
def test_the_page_shows_the_table_of_neighbours_row_by_row(room):
    assert neighbour_tables.rows_of_page(room) == neighbour_tables.rows_of_code(room)


def test_there_are_neighbours():
    assert len(neighbour_tables.rows_of_code("stokes")) > 10
    source = "".join(path.read_text() for path in (PACKAGE / "stokes").rglob("neighbours*.cpp"))
    assert len(neighbour_tables.rows_of_code("stokes")) == source.count("{N::")
