"""The manual for the browser, for build.sh.

    manual.py source FOLDER     lays out what Sphinx reads: the markdown files as they are, a page for each header of the core, contents
    manual.py check FOLDER      opens the pages of FOLDER in a headless chromium; exits with 1 when something is wrong
"""
import html
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

TOP = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = TOP / "PKG-STOKESDYN"
VERSION = (PACKAGE / "VERSION").read_text().strip()

CONF = f"""
import pathlib
import sphinx.search.en
# The stems of "its" and "has" are too short for the index, and a search for them would find nothing.
sphinx.search.en.english_stopwords.update(["its", "has"])
project = "PKG-STOKESDYN"
version = release = "{VERSION}"
extensions = ["myst_parser", "sphinx.ext.mathjax", "sphinx_copybutton"]
root_doc = "index"
exclude_patterns = []
myst_enable_extensions = ["dollarmath"]
myst_update_mathjax = False
myst_heading_anchors = 4
# Formulas by KaTeX, which draws them before a page is seen; Sphinx's own extension only marks them and asks for the script.
mathjax_path = "katex/katex.min.js"
mathjax_options = {{"defer": "defer"}}
html_theme = "furo"
html_title = "PKG-STOKESDYN {VERSION}"
html_theme_options = {{"navigation_with_keys": True}}
html_static_path = ["manual.css", "page.js"]
html_css_files = ["katex/katex.min.css", "manual.css"]
html_js_files = [("page.js", {{"defer": "defer"}})]
html_search_scorer = str(pathlib.Path(__file__).with_name("scorer.js"))
html_show_sourcelink = False
html_copy_source = False
html_show_copyright = False
html_show_sphinx = False
copybutton_prompt_text = "$ "
suppress_warnings = ["myst.header"]
highlight_language = "none"
"""

# Tables, formulas and code that are too wide for a phone move in a frame of their own, never the page.
CSS = """
.content { width: 54em; max-width: 100%; }
article table { font-size: 0.9em; }
article td, article th { vertical-align: top; }
article td code { white-space: normal; overflow-wrap: break-word; }
article img { max-width: 100%; height: auto; }
article p, article li { overflow-wrap: break-word; }
article div.highlight pre { font-size: 0.8em; }
article blockquote { border-left: 4px solid #5a9a5a; font-style: normal; padding: 4px 14px; overflow-x: auto; }
article h1, article h2, article h3 { overflow-wrap: anywhere; }
article h2 { font-size: 1.6em; }
article h3 { font-size: 1.25em; }
@media (max-width: 46em) {
  article h1 { font-size: 1.7em; }
  article h2 { font-size: 1.4em; }
  article h3 { font-size: 1.15em; }
  article table { font-size: 0.75em; }
  article td, article th { padding: 2px 4px; }
  article td code, article td a { overflow-wrap: anywhere; }
}
.katex-display { overflow-x: auto; overflow-y: hidden; padding: 2px 0; }
.katex { font-size: 1.1em; }
body[data-theme="dark"] article img { background: white; }
@media (prefers-color-scheme: dark) { body:not([data-theme="light"]) article img { background: white; } }
"""

# Formulas, and the switch of the colours: Furo's own script is a module in Debian's build, which no browser loads from a file.
SCRIPT = r"""
for (const formula of document.querySelectorAll(".math")) {
  const text = formula.textContent.trim();
  katex.render(text.slice(2, -2), formula, {displayMode: text.startsWith("\\["), throwOnError: false});
}
document.documentElement.classList.remove("no-js");
for (const button of document.querySelectorAll(".theme-toggle"))
  button.addEventListener("click", () => {
    const next = {auto: "dark", dark: "light", light: "auto"}[document.body.dataset.theme];
    document.body.dataset.theme = next;
    localStorage.setItem("theme", next);
  });
"""

# What a user looks for is on the pages of the styles and in the howtos; headers of the core come last. A message that is pasted into
# the search leads to the page whose table has it: MESSAGES has the pieces of its rows between the places that differ from run to run.
SCORER = """
var Scorer = (() => {
const weights = [[/^PKG-STOKESDYN\\/doc\\//, 80], [/\\/doc\\/(howto|messages)_/, 20], [/\\/doc\\/(stokes|sph|vans)_/, 30],
  [/\\/doc\\/(pair|fix|compute)_/, 40], [/\\/doc\\/(pair_|fix_hydro_vans|fix_stokes_dynamics_over)/, 5],
  [/^README$/, 60], [/^examples\\//, 30], [/^PKG-STOKESDYN\\/core\\//, -100]];
const messages = MESSAGES;
function likeMessage(page) {
  const asked = window.asked || new URLSearchParams(window.location.search).get("q") || "";
  const words = asked.toLowerCase().split(/[\\s:;,.'`()\\[\\]=]+/).filter(word => word);
  const text = " " + words.join(" ") + " ", pieces = words.length > 2 && messages[page] || [];
  return pieces.some(piece => piece.includes(text)) ? 100 : pieces.some(piece => text.includes(piece)) ? 50 : 0;
}
return {
  score: ([page, title, anchor, description, score, file]) => score + weights.filter(([name]) => name.test(page)).reduce((sum, [, w]) => sum + w, 0)
    + likeMessage(page),
  objNameMatch: 11, objPartialMatch: 6, objPrio: {0: 15, 1: 5, 2: -5}, objPrioDefault: 0, title: 15, partialTitle: 7, term: 5, partialTerm: 2,
};
})();
"""


# --- what Sphinx reads -----------------------------------------------------------------------------------------------------

def contents(chapters):
    """The root document: the README, whose pages follow in the menu, a list for each chapter (title, documents)."""
    lines = ["PKG-STOKESDYN", "=============", "", f"The manual of version {VERSION}. It begins with :doc:`the README <README>`.", ""]
    for title, documents in chapters:
        lines += [".. toctree::", "   :maxdepth: 1", f"   :caption: {title}", ""] + [f"   {name}" for name in documents] + [""]
    return "\n".join(lines)


def contents_page(title, text, documents):
    lines = [title, "=" * len(title), "", text, "", ".. toctree::", "   :maxdepth: 1", ""]
    return "\n".join(lines + [f"   {name}" for name in documents] + [""])


def header_page(header):
    """A header of the core is the manual of its functions: shown as it stands."""
    name = str(header.relative_to(PACKAGE / "core"))
    return f"{name}\n{'=' * len(name)}\n\n.. literalinclude:: /PKG-STOKESDYN/core/{name}\n   :language: c\n"


def dark_when_asked():
    """Colours of Furo for a browser that asks for dark pages: Debian's build of the theme has lost them, those of its switch it has."""
    import furo
    styles = (pathlib.Path(furo.__file__).parent / "theme/furo/static/styles/furo.css").read_text()
    colours = re.search(r'body\[data-theme="?dark"?\] *\{([^}]*)\}', styles).group(1)
    return "@media (prefers-color-scheme: dark) { body[data-theme=\"auto\"] {" + colours + "} }\n"


def links(text):
    """Files of this project that a page links to, as it names them: in the line, or below as [name]: file."""
    return re.findall(r"\]\(([^)#: ]+)(?:#[^)]*)?\)", text) + re.findall(r"^\[[^]]+\]: ([^#:\s]+)$", text, re.M)


def menu_of_examples():
    """Title and document of each example, in the order of the list of examples; the folder stands behind the title."""
    for name in re.findall(r"\]\((\w+)/README\.md\)", (TOP / "examples" / "README.md").read_text()):
        title = (TOP / "examples" / name / "README.md").read_text().splitlines()[0].lstrip("# ")
        yield f"{title} ({name}) <examples/{name}/README>"


def plain(text):
    """The words of a text without punctuation, and a blank before and after each, as likeMessage of SCORER has them."""
    words = re.split(r"[\s:;,.'`()\[\]=]+", text.lower())
    return " " + " ".join(word for word in words if word) + " "


def pieces_of_messages():
    """Of each page: what its tables of messages list, as words without punctuation: each row whole, and cut where a message differs from
    run to run."""
    for path in sorted((PACKAGE / "doc").glob("*.md")):
        rows = [row[1:].split(" | ")[0] for table in re.findall(r"^\| message \|.*\n\|---.*\n((?:\|.*\n)+)", path.read_text(), re.M)
                for row in table.splitlines()]
        for beside in re.findall(r"^\* \*\*(?:error|warning)\*\*: (.+(?:\n  .+)*)", path.read_text(), re.M):    # other commands of LAMMPS
            rows += beside.split(":")[1:]
        pieces = {plain(piece) for row in rows for piece in [row.replace("...", " "), *row.split("...")]}
        yield f"PKG-STOKESDYN/doc/{path.stem}", sorted(piece for piece in pieces if len(piece.split()) > 2)


def source(folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    pages = [TOP / "README.md", TOP / ".github" / "CONTRIBUTING.md", PACKAGE / "README.md", PACKAGE / "CHANGELOG.md", TOP / "examples" / "README.md",
             *sorted((PACKAGE / "doc").glob("*.md")), *sorted((TOP / "examples").glob("*/README.md"))]
    headers = [path for path in sorted((PACKAGE / "core").rglob("*.h")) if not re.search("_(internal|kernel|loops|visit)\\.h", path.name)]
    waiting, laid = pages + headers, set(pages)
    for path in waiting:
        text = path.read_text() if path.suffix in (".md", ".h") else None
        to = folder / path.relative_to(TOP)
        to.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix == ".md" and path not in pages:    # a table beside a README: a page that no list of contents has
            to.write_text("---\norphan: true\n---\n\n" + text)
        else:
            shutil.copy(path, to)
        for target in links(text) if path.suffix == ".md" else []:
            linked = (path.parent / target).resolve()    # pictures, and other files that a page links to
            if linked.is_file() and linked not in laid:
                laid.add(linked)
                waiting.append(linked)
    for header in headers:
        (folder / header.relative_to(TOP)).with_suffix(".rst").write_text(header_page(header))

    def names(paths):
        return [str(path.relative_to(TOP).with_suffix("")) for path in paths]

    index = (PACKAGE / "doc" / "index.md").read_text()
    chapters = [("Start", ["README", "PKG-STOKESDYN/doc/index"])]
    for title, part in re.findall(r"^## (.*?)\n(.*?)(?=^## |\Z)", index, re.S | re.M):
        chapters.append((title, ["PKG-STOKESDYN/doc/" + name for name in re.findall(r"\]\((\w+)\.md\)", part)]))
    chapters += [("Examples", ["examples/README", *dict.fromkeys(menu_of_examples())]),
                 ("Inside", ["PKG-STOKESDYN/README", ".github/CONTRIBUTING", "PKG-STOKESDYN/CHANGELOG"]), ("Headers", ["headers"])]
    (folder / "headers.rst").write_text(contents_page("Headers of the core", "Each is the manual of its functions.", names(headers)))
    (folder / "index.rst").write_text(contents(chapters))
    (folder / "conf.py").write_text(CONF)
    for name, text in (("manual.css", CSS + dark_when_asked()), ("page.js", SCRIPT), ("scorer.js", SCORER.replace("MESSAGES", json.dumps(dict(pieces_of_messages()))))):
        (folder / name).write_text(text)


# --- checks in a browser ---------------------------------------------------------------------------------------------------

def dom(page):
    """The page after its scripts have run."""
    with tempfile.TemporaryDirectory() as profile:
        command = ["chromium", "--headless", "--no-sandbox", "--disable-gpu", "--allow-file-access-from-files",
                   f"--user-data-dir={profile}", "--virtual-time-budget=20000", "--dump-dom", page]
        return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=True, timeout=300).stdout


def dead_links(folder):
    """(page, target) of every link, picture and script that leads nowhere within the manual, anchors included."""
    ids = {}
    for page in folder.rglob("*.html"):
        ids[page.resolve()] = set(re.findall(r'\bid="([^"]*)"', page.read_text()))
    links = 0
    for page in sorted(ids):
        for target in re.findall(r'\b(?:href|src)="([^"]*)"', page.read_text()):
            target = html.unescape(target)
            if re.match(r"(https?:|mailto:|data:)", target):
                continue
            links += 1
            path, _, anchor = target.partition("#")
            to = (page.parent / path.split("?")[0]).resolve() if path else page
            if not to.exists() or (anchor and to in ids and anchor not in ids[to]):
                yield str(page.relative_to(folder)), target
    print(f"[manual] {len(ids)} pages, {links} links")


# The manual's own search, asked one query after the other; what its full-text part answers, before it is shown piece by piece.
PROBE = """<!DOCTYPE html><html><head><script src="_static/jquery.js"></script><script src="_static/underscore.js"></script>
<script id="documentation_options" data-url_root="./" src="_static/documentation_options.js"></script>
<script src="_static/doctools.js"></script><script src="_static/sphinx_highlight.js"></script>
<script src="_static/language_data.js"></script><script src="_static/searchtools.js"></script></head>
<body><div id="search-progress"></div><pre id="found"></pre><script src="searchindex.js"></script><script>
const found = {}, terms = Search.performTermsSearch;
let answer = [];
Search.performTermsSearch = (...words) => { answer = terms(...words); return []; };
for (const name of ["out", "title", "dots", "status", "output"]) Search[name] = document.createElement("p");
for (const query of QUERIES) {
  answer = [];
  window.asked = query;
  Search.query(query);
  found[query] = answer.sort((a, b) => Scorer.score(b) - Scorer.score(a)).map(result => result[0]);
}
document.getElementById("found").textContent = JSON.stringify(found);
</script></body></html>"""


# Each page in a frame as wide as a phone and as a desk: what is wider than the frame, and is in no part that scrolls for itself, is cut
# or makes the page sway.
FRAMES = """<!DOCTYPE html><html><body><pre id="found"></pre><script>
function scrolls(element) {
  for (let at = element; at && at.tagName !== "BODY"; at = at.parentElement)
    if (["auto", "scroll"].includes(getComputedStyle(at).overflowX)) return true;
  return false;
}
async function measure() {
  const pages = PAGES, wide = [];
  for (const width of WIDTHS) for (const page of pages) {
    const frame = document.createElement("iframe");
    frame.style = `width: ${width}px; height: 800px; border: 0`;
    frame.src = page;
    await new Promise(done => { frame.onload = done; document.body.append(frame); });
    const root = frame.contentDocument.documentElement;
    const out = [...root.querySelectorAll("article *")].find(e => !e.closest("svg, .katex-mathml") && !scrolls(e) &&
      e.getBoundingClientRect().right > root.clientWidth + 1);
    if (root.scrollWidth > root.clientWidth || out)
      wide.push(`${page} at ${width}: ${root.scrollWidth} wide` + (out ? `, ${out.tagName} ${out.textContent.slice(0, 40)}` : ""));
    frame.remove();
  }
  document.getElementById("found").textContent = JSON.stringify([pages.length, wide]);
}
measure();
</script></body></html>"""
WIDTHS = [390, 1280]


def probed(folder, page):
    """What the script of a page, which is put into the folder for this alone, has written."""
    probe = folder / "probe.html"
    probe.write_text(page)
    seen = dom(probe.as_uri())
    probe.unlink()
    return json.loads(html.unescape(re.search(r'<pre id="found">(.*?)</pre>', seen, re.S).group(1)) or "null")


def wide_pages(folder):
    pages = sorted(str(page.relative_to(folder)) for page in folder.rglob("*.html"))
    for first in range(0, len(pages), 20):
        some = pages[first:first + 20]
        measured, wide = probed(folder, FRAMES.replace("WIDTHS", json.dumps(WIDTHS)).replace("PAGES", json.dumps(some))) or (0, [])
        yield from wide if measured == len(some) else [f"the widths of {some[0]} and those after it could not be measured"]
    print(f"[manual] {len(pages)} pages measured at {WIDTHS} pixels")


def searches():
    """(query, the pages of which one must be found): keywords and first words of messages, as unittest/lammps/common/test_pages.py has them."""
    sys.path[:0] = [str(TOP / "unittest" / "lammps"), str(TOP / "unittest" / "lammps" / "common")]
    import test_pages
    for room, keyword in test_pages.KEYWORDS:
        yield keyword, test_pages.ROOMS[room]
    for room, _, begin in test_pages.ALL:
        yield begin, test_pages.ROOMS.get(room, []) + [test_pages.EVERYWHERE]


# what people look for, and how the page begins that must come first
FIRST = {"adds a drag to spheres that": "PKG-STOKESDYN/doc/howto_trouble", "no grid for Ewald": "PKG-STOKESDYN/doc/messages_stokes_dynamics",
         "uninstall": "PKG-STOKESDYN/doc/howto_build", "OVITO": "PKG-STOKESDYN/doc/", "Brownian": "PKG-STOKESDYN/doc/"}


# what a stranger types who has a question, and words of the answer: they must be on one of the first two pages
QUESTIONS = {
    "sand falls too fast": "`drag ferguson_church`",
    "narrow flume side walls": "a fifth of this friction",
    "steady state transport rate error": "the errors of these means",
    "suspension settles too fast": "2.9 times the right speed",
    "periodic box net flux": "no net flux of volume",
    "sphere touches wall too fast": "add `lubrication yes`",
    "rotational diffusion temperature": "no rotational diffusion",
    "clump drag too small": "is 3 to 9 % too small",
    "water at rest swells": "`artVisc 0.05 0 ETA`",
    "two fluids speed of sound": "100 to 1",
}


def wrong_answers(folder):
    """Of the search: what it does not find, or not among the first pages."""
    asked, rows = list(searches()), dict(pieces_of_messages())
    found = probed(folder, PROBE.replace("QUERIES", json.dumps(sorted({query for query, _ in asked} | set(FIRST) | set(QUESTIONS))))) or {}
    missed = [(query, pages) for query, pages in asked
              if not any(f"PKG-STOKESDYN/doc/{name[:-3]}" in found.get(query, []) for name in pages)]
    yield from (f"search for '{query}' does not find any of {pages}" for query, pages in missed)
    print(f"[manual] search finds {len(asked) - len(missed)} of {len(asked)} keywords and messages")

    def first_pages(query):
        return found.get(query, [])[:2]
    for query, page in FIRST.items():
        if not (found.get(query) or [""])[0].startswith(page):
            yield f"search for '{query}' begins with {first_pages(query)}, not with {page}"
    query, page = next(iter(FIRST.items()))
    if f'href="{page}.html' not in dom(f"{(folder / 'search.html').as_uri()}?q={query.replace(' ', '+')}"):
        yield f"the page of the search does not show {page} for '{query}'"
    messages = {query for query, _ in asked if len(query.split()) > 2}
    late = [query for query in messages if not any(plain(query) in piece for page in first_pages(query) for piece in rows.get(page, []))]
    yield from (f"search for '{query}' begins with {first_pages(query)}, whose tables do not have this message" for query in late)
    print(f"[manual] search shows {len(messages) - len(late)} of {len(messages)} messages on the first two pages")
    silent = [query for query, answer in QUESTIONS.items()
              if not any(answer in " ".join((folder.parent / "source" / f"{page}.md").read_text().split()) for page in first_pages(query))]
    yield from (f"search for '{query}' begins with {first_pages(query)}, which do not say {QUESTIONS[query]}" for query in silent)
    print(f"[manual] search answers {len(QUESTIONS) - len(silent)} of {len(QUESTIONS)} questions on the first two pages")


def check(folder):
    wrong = [f"dead link in {page}: {target}" for page, target in dead_links(folder)]

    formulas = drawn = pictures = 0
    for page in sorted(folder.rglob("*.html")):
        text = page.read_text()
        wanted = len(re.findall(r'class="math notranslate', text))
        if not wanted and "<img" not in text:
            continue
        seen = dom(page.as_uri())
        got = len(re.findall(r'<span class="katex">', seen))
        formulas, drawn, pictures = formulas + wanted, drawn + got, pictures + len(re.findall("<img", text))
        if got < wanted or 'class="katex-error' in seen:
            wrong.append(f"formulas of {page.relative_to(folder)}: {got} of {wanted} drawn")
    print(f"[manual] {drawn} of {formulas} formulas drawn, {pictures} pictures")

    wrong += [f"wider than the window: {page}" for page in wide_pages(folder)]

    wrong += wrong_answers(folder)
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit({"source": source, "check": check}[sys.argv[1]](pathlib.Path(sys.argv[2]).resolve()))
