"""The tables of neighbours (common/neighbours.h), read off the sources of a model's room and off the page, where a row
is an entry of a list. Called by hand it prints the entries for the page."""
import pathlib
import re
import textwrap

PACKAGE = pathlib.Path(__file__).resolve().parents[2] / "PKG-STOKESDYN"
PAGE = PACKAGE / "doc" / "howto_trouble.md"
KINDS = {"FIX": "fix", "PAIR": "pair_style", "BOND": "bond_style", "COMPUTE": "compute", "ATOM": "atom_style",
         "COMMAND": "command"}
VERDICTS = {"FINE": "fine", "WARNING": "warning", "ERROR": "error"}
# the heading of the page above the list of each room
HEADINGS = {"stokes": "### Beside pair_style stokes_dynamics and its fixes", "sph": "### Beside the SPH styles",
            "vans": "### Beside fix hydro/vans"}

STRINGS = r"(?:\"(?:[^\"\\]|\\.)*\"\s*)+"
ROW = re.compile(rf"\{{N::(?P<kind>\w+),\s*(?P<styles>{STRINGS}|[A-Z]+),\s*(?P<where>[\w\s|]+?),"
                 rf"\s*N::(?P<verdict>\w+),\s*(?P<why>{STRINGS})")


def joined(strings):
    return "".join(re.findall(r"\"((?:[^\"\\]|\\.)*)\"", strings))


def rows(room):
    """Of every row: kind, styles, facts, verdict, why. Styles stand in the row, or in the constant that it names."""
    for path in sorted((PACKAGE / room).rglob("neighbours*.cpp")):
        text = path.read_text()
        for row in ROW.finditer(text):
            named = re.search(rf"static const char {re.escape(row['styles'])}\[\] = ({STRINGS});", text)
            yield (row["kind"], joined(named.group(1) if named else row["styles"]), row["where"], row["verdict"],
                   joined(row["why"]))


def names_of_rows(room):
    """Kind and styles, facts, verdict"""
    return [(f"{kind} {styles}", where, verdict) for kind, styles, where, verdict, _ in rows(room)]


def facts(room):
    """Of the enum StokesFact and its like: what the page says of each, which is the comment behind it."""
    words = {}
    for header in sorted((PACKAGE / room).rglob("neighbours*.h")):
        for enum in re.findall(r"enum \w+Fact\b[^{]*\{(.*?)\};", header.read_text(), re.S):
            words.update(re.findall(r"(\w+) = 1 << \d+,\s*// (.*)", enum))
    return words


def rows_of_code(room):
    """Every row, in its order and in the words of the page."""
    words, entries = facts(room), []
    for kind, styles, where, verdict, why in rows(room):
        of_run = [] if where == "0" else [words[name.strip()] for name in where.split("|")]
        what = ", ".join([f"{KINDS[kind]} " + " ".join(f"`{style}`" for style in styles.split())] + of_run)
        entries.append(f"**{VERDICTS[verdict]}**: {what}: {why.replace('{}', '...')}")
    return entries


def rows_of_page(room):
    text = PAGE.read_text()
    if HEADINGS[room] + "\n" not in text:
        return []
    part = re.split(r"^#+ ", text.split(HEADINGS[room] + "\n", 1)[1], maxsplit=1, flags=re.M)[0]
    return [" ".join(row.split()) for row in re.findall(r"^\* (\*\*.*?)(?=^\* |\n\n|\Z)", part, re.S | re.M)]


if __name__ == "__main__":
    for room, heading in HEADINGS.items():
        print(f"\n{heading}\n")
        for row in rows_of_code(room):
            print("\n".join(textwrap.wrap("* " + row, 120, subsequent_indent="  ", break_long_words=False,
                                          break_on_hyphens=False)))
