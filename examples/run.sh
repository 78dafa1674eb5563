#!/usr/bin/env bash
# Command 1 of the README: set-up (packages, LAMMPS, plugin), then examples/sedimentation. From any folder, with nothing set
# beforehand.
#   run.sh              tables and pictures go to build/examples/sedimentation
#   run.sh --update     also refreshes those that are kept in examples/sedimentation
set -euo pipefail
export PATH=${PATH:-/usr/local/bin:/usr/bin:/bin}:/usr/local/sbin:/usr/sbin:/sbin      # sbin: dpkg looks for its tools there
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

case "${1:-}" in
  "" | --update) ;;
  *) echo "usage: examples/run.sh [--update]" >&2; exit 2 ;;
esac

"$top/cmake/setup.sh"
. "$top/build/env.sh"

# Debian's python has the numpy and matplotlib that the set-up installed; another one on the PATH need not.
python=/usr/bin/python3
"$python" -c "import numpy, matplotlib" 2> /dev/null || python=python3
echo "[sedimentation] rigid clumps fall in a viscous fluid"
exec "$python" "$top/examples/sedimentation/run.py" "$@"
