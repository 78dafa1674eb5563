#!/usr/bin/env bash
# Resistance, mobility, settling velocities and aspect ratio of a rigid clump, without a run of LAMMPS.
#   clump_resistance.sh FILE [shell n] [rotation yes|no] [visc eta] [memory bytes]
# FILE: a LAMMPS molecule file (Coords, Diameters), or a list of spheres, x y z radius a line. See README.md.
# Sets everything up when the program is not there yet.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
build=${STOKESDYN_BUILD:-$top/build}
[ -x "$build/clump_resistance" ] || "$top/cmake/setup.sh" core >&2
exec "$build/clump_resistance" "$@"
