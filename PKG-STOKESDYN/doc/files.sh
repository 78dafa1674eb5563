#!/usr/bin/env bash
# files.sh howto_NAME      writes the files that stand on the page howto_NAME.md into the folder that you are in.
# files.sh README          the same for the README.
# A file is a block whose first line is "# NAME", with a dot in NAME.
set -euo pipefail
doc=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
page=$doc/$(basename "${1:-none}" .md).md
[ "${1:-}" = README ] && page=$doc/../../README.md
[ -f "$page" ] || { echo "usage: files.sh howto_NAME | README" >&2; exit 2; }
awk '/^```$/ { inside = !inside; first = inside; name = ""; next }
     first   { first = 0; if (match($0, /^# [A-Za-z_]+\.[A-Za-z_.]+/)) name = substr($0, 3, RLENGTH - 2) }
     inside && name != "" { if (!(name in seen)) { printf "" > name; seen[name]; print name }
                            print >> name }' "$page"
