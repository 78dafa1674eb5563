#!/usr/bin/env bash
# The manual for the browser: README, pages, howtos, examples and the headers of the core, with search and formulas.
#   build.sh            leaves build/manual/html/index.html; nothing in it needs the network
#   build.sh check      stops at a warning, and opens every page in a headless chromium: links, pictures, formulas, and whether the
#                       search finds each keyword and the first words of each message, on the pages for users first
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
top=$(cd "$here/../.." && pwd)
out=$top/build/manual

packages="python3-sphinx python3-myst-parser furo python3-sphinx-copybutton libjs-katex" strict=""
if [ "${1:-}" = check ]; then packages="$packages chromium" strict="-W --keep-going"; fi
missing=""
for p in $packages; do
  dpkg-query -W -f '${db:Status-Abbrev}' "$p" 2> /dev/null | grep -q '^ii' || missing="$missing $p"
done
if [ -n "$missing" ]; then
  if [ "$(id -u)" != 0 ]; then echo "build.sh: packages are missing. Ask for:  apt-get install$missing" >&2; exit 1; fi
  echo "[manual] installing Debian packages:$missing"
  apt-get -q update > /dev/null
  DEBIAN_FRONTEND=noninteractive apt-get -q -y --no-install-recommends install $missing > /dev/null
fi

mkdir -p "$out"
/usr/bin/python3 "$here/manual.py" source "$out/source"
/usr/bin/python3 -m sphinx -q $strict -b html "$out/source" "$out/html"

# KaTeX, with its fonts
to=$out/html/_static/katex
rm -rf "$to"
mkdir -p "$to/fonts"
cp -L /usr/share/javascript/katex/katex.min.{js,css} "$to"
cp -L /usr/share/javascript/katex/fonts/*.woff2 "$to/fonts"

echo "[manual] $out/html/index.html"
if [ "${1:-}" = check ]; then /usr/bin/python3 "$here/manual.py" check "$out/html"; fi
