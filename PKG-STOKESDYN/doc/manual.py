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
import sphinx.search.en
# The stem of "its" is too short for the index, and a search for it would find nothing.
sphinx.search.en.english_stopwords.add("its")
project = "PKG-STOKESDYN"
version = release = "{VERSION}"
extensions = ["myst_parser", "sphinx.ext.mathjax"]
root_doc = "index"
exclude_patterns = []
myst_enable_extensions = ["dollarmath"]
myst_update_mathjax = False
myst_heading_anchors = 4
mathjax_path = "mathjax/MathJax.js?config=TeX-AMS_CHTML"
html_theme = "alabaster"
html_theme_options = {{"page_width": "1260px", "sidebar_width": "260px", "fixed_sidebar": False, "description": "version {VERSION}",
                      "show_powered_by": False}}
html_sidebars = {{"**": ["about.html", "searchbox.html", "navigation.html"]}}
html_static_path = ["manual.css"]
html_css_files = ["manual.css"]
html_show_sourcelink = False
html_copy_source = False
html_show_copyright = False
suppress_warnings = ["myst.header"]
highlight_language = "none"
"""

CSS = """
div.body { max-width: 1000px; }
div.body table { font-size: 0.92em; }
div.body td, div.body th { padding: 3px 8px; vertical-align: top; }
div.body td code { white-space: normal; }
div.body img { max-width: 100%; }
div.highlight pre { font-size: 0.82em; }
blockquote { background: #eef5ee; border-left: 4px solid #5a9a5a; padding: 4px 14px; margin: 12px 0; }
a.headerlink { visibility: hidden; }
"""


# --- what Sphinx reads -----------------------------------------------------------------------------------------------------

def contents(chapters):
    """A root document with a table of contents for each chapter: (title, documents)."""
    lines = ["Manual", "======", "", f"PKG-STOKESDYN, version {VERSION}. Start with :doc:`README`.", ""]
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


def source(folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    pages = [TOP / "README.md", PACKAGE / "README.md", PACKAGE / "CHANGELOG.md", TOP / "examples" / "README.md",
             *sorted((PACKAGE / "doc").glob("*.md")), *sorted((TOP / "examples").glob("*/README.md"))]
    headers = [path for path in sorted((PACKAGE / "core").rglob("*.h")) if not re.search("_(internal|kernel|loops|visit)\\.h", path.name)]
    for path in pages + headers:
        to = folder / path.relative_to(TOP)
        to.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, to)
        for target in re.findall(r"\]\(([^)#:]+)\)", path.read_text()) if path.suffix == ".md" else []:
            linked = (path.parent / target).resolve()    # pictures, and other files that a page links to
            if linked.is_file() and linked not in pages:
                beside = folder / linked.relative_to(TOP)
                beside.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(linked, beside)
                if linked.suffix == ".md":    # a table beside a README: a page that no list of contents has
                    beside.write_text("---\norphan: true\n---\n\n" + linked.read_text())
    for header in headers:
        (folder / header.relative_to(TOP)).with_suffix(".rst").write_text(header_page(header))

    def names(paths):
        return [str(path.relative_to(TOP).with_suffix("")) for path in paths]

    index = (PACKAGE / "doc" / "index.md").read_text()
    chapters = [("Start", ["README", "PKG-STOKESDYN/doc/index"])]
    for title, part in re.findall(r"^## (.*?)\n(.*?)(?=^## |\Z)", index, re.S | re.M):
        chapters.append((title, ["PKG-STOKESDYN/doc/" + name for name in re.findall(r"\]\((\w+)\.md\)", part)]))
    chapters += [("Examples", ["examples/README"] + names(sorted((TOP / "examples").glob("*/README.md")))),
                 ("Inside", ["PKG-STOKESDYN/README", "PKG-STOKESDYN/CHANGELOG"]), ("Headers", ["headers"])]
    (folder / "headers.rst").write_text(contents_page("Headers of the core", "Each is the manual of its functions.", names(headers)))
    (folder / "index.rst").write_text(contents(chapters))
    (folder / "conf.py").write_text(CONF)
    (folder / "manual.css").write_text(CSS)


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
  Search.query(query);
  found[query] = answer.map(result => result[0]);
}
document.getElementById("found").textContent = JSON.stringify(found);
</script></body></html>"""


def searches():
    """(query, the pages of which one must be found): keywords and first words of messages, as unittest/lammps/test_pages.py has them."""
    sys.path.insert(0, str(TOP / "unittest" / "lammps"))
    import test_pages
    for room, keyword in test_pages.KEYWORDS:
        yield keyword, test_pages.ROOMS[room]
    for room, _, begin in test_pages.ALL:
        yield begin, test_pages.ROOMS.get(room, []) + [test_pages.EVERYWHERE]


def check(folder):
    wrong = [f"dead link in {page}: {target}" for page, target in dead_links(folder)]

    formulas = drawn = pictures = 0
    for page in sorted(folder.rglob("*.html")):
        text = page.read_text()
        wanted = len(re.findall(r'class="math notranslate', text))
        if not wanted and "<img" not in text:
            continue
        seen = dom(page.as_uri())
        got = len(re.findall(r'class="mjx-chtml MathJax_CHTML', seen))
        formulas, drawn, pictures = formulas + wanted, drawn + got, pictures + len(re.findall("<img", text))
        if got < wanted or 'class="mjx-merror' in seen:
            wrong.append(f"formulas of {page.relative_to(folder)}: {got} of {wanted} drawn")
    print(f"[manual] {drawn} of {formulas} formulas drawn, {pictures} pictures")

    asked = list(searches())
    probe = folder / "search_probe.html"
    probe.write_text(PROBE.replace("QUERIES", json.dumps(sorted({query for query, _ in asked}))))
    seen = dom(probe.as_uri())
    probe.unlink()
    found = json.loads(html.unescape(re.search(r'<pre id="found">(.*?)</pre>', seen, re.S).group(1)) or "{}")
    missed = [(query, pages) for query, pages in asked
              if not any(f"PKG-STOKESDYN/doc/{name[:-3]}" in found.get(query, []) for name in pages)]
    wrong += [f"search for '{query}' does not find any of {pages}" for query, pages in missed]
    print(f"[manual] search finds {len(asked) - len(missed)} of {len(asked)} keywords and messages")

    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit({"source": source, "check": check}[sys.argv[1]](pathlib.Path(sys.argv[2]).resolve()))
