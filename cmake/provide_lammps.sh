#!/usr/bin/env bash
# Provides a LAMMPS that can load plugins: Debian's (Ubuntu's) own source package of LAMMPS, built once with
# shared libraries, Open MPI, exceptions, PNG and the packages that this project and its users need.
# The binary package cannot be used: it is built without PLUGIN.
#
#   provide_lammps.sh            builds it if need be; the last line of output is the folder that holds
#                                bin/ lib/ python/ and the source tree src/
#   provide_lammps.sh --check    prints that folder if it is complete, else exits 1; touches nothing
#
# No system file is changed: the apt source list is a private copy, derived from the machine's own. Everything lands in
# $STOKESDYN_CACHE/<key>, where the key names version, system and build options; unless told that folder is
# ${XDG_CACHE_HOME:-$HOME/.cache}/stokesdyn. It may be one that others can read, /opt/stokesdyn say: then they use the
# same LAMMPS. An interrupted run is taken up where it stopped; two runs at once wait for each other.
set -euo pipefail
export PATH HOME=${HOME:-$(getent passwd "$(id -u)" | cut -d: -f6)}    # a bare shell may have neither
here=$(cd "$(dirname "$0")" && pwd)
. "$here/progress.sh"

packages="PLUGIN RIGID MOLECULE GRANULAR COLLOID SPH DIPOLE BROWNIAN ASPHERE KSPACE EXTRA-FIX EXTRA-MOLECULE"
options=(
  -D CMAKE_BUILD_TYPE=Release -D CMAKE_CXX_FLAGS_RELEASE="-O2 -DNDEBUG"
  -D BUILD_SHARED_LIBS=ON -D BUILD_MPI=ON -D BUILD_OMP=OFF -D BUILD_TOOLS=OFF -D LAMMPS_EXCEPTIONS=ON
  -D LAMMPS_SIZES="${STOKESDYN_LAMMPS_SIZES:-smallbig}"
  -D FFT=KISS -D WITH_PNG=ON -D WITH_JPEG=OFF -D WITH_GZIP=OFF -D WITH_FFMPEG=OFF -D WITH_CURL=OFF
)
for p in $packages; do options+=(-D "PKG_$p=ON"); done

fail() { printf 'provide_lammps: %s\n' "$*" >&2; exit 1; }

cache=${STOKESDYN_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/stokesdyn}
. /etc/os-release
system="$ID${VERSION_ID:-}-$(uname -m)"
hash=$(printf '%s\n' "${options[@]}" | sha256sum | cut -c1-8)

newest_complete() {
  local stamp newest=""
  for stamp in "$cache"/lammps-*-"$system-$hash"/complete; do
    [ -f "$stamp" ] && { [ -z "$newest" ] || [ "$stamp" -nt "$newest" ]; } && newest=$stamp
  done
  printf '%s' "${newest%/complete}"
}

found=$(newest_complete)
if [ -n "$found" ]; then printf '%s\n' "$found"; exit 0; fi
[ "${1:-}" = --check ] && exit 1

mkdir -p "$cache" && [ -w "$cache" ] || fail "there is no LAMMPS of this version in $cache, and you may not write there.
  Ask its owner to run cmake/provide_lammps.sh, or set STOKESDYN_CACHE to a folder of your own"
trap '[ $? = 0 ] || ! full "$cache" || echo "provide_lammps: the disk of $cache is full: make room for 700 MB and call
  this again (what is there is used then), or set STOKESDYN_CACHE to a folder on another disk" >&2' EXIT
exec 9> "$cache/lock"
flock -n 9 || { echo "provide_lammps: another run is building LAMMPS, waiting for it" >&2; flock 9; }
found=$(newest_complete)                     # the other run may have finished it
if [ -n "$found" ]; then printf '%s\n' "$found"; exit 0; fi

for tool in apt-get dpkg-source cmake ninja mpicxx; do
  command -v "$tool" > /dev/null || fail "$tool is missing; run cmake/setup.sh, which installs it"
done
start=$SECONDS
say() { printf '[LAMMPS %3d s] %s\n' $((SECONDS - start)) "$*" >&2; }

# --- the source package, through a private apt -------------------------------------------------------------
apt=$cache/apt
mkdir -p "$apt/lists/partial" "$apt/archives/partial" "$apt/parts"
rm -f "$apt"/parts/*
n=0
for list in /etc/apt/sources.list /etc/apt/sources.list.d/*.list; do           # one-line style
  [ -f "$list" ] || continue
  n=$((n + 1)); sed -nE 's/^[[:space:]]*deb[[:space:]]/deb-src /p' "$list" > "$apt/parts/$n.list"
done
for list in /etc/apt/sources.list.d/*.sources; do                              # deb822 style
  [ -f "$list" ] || continue
  n=$((n + 1)); sed -E 's/^Types:.*/Types: deb-src/I' "$list" > "$apt/parts/$n.sources"
done
apt_options=(-o "Dir::Etc::SourceList=/dev/null" -o "Dir::Etc::SourceParts=$apt/parts" -o "Dir::State::Lists=$apt/lists"
             -o "Dir::Cache=$apt" -o "Dir::Cache::archives=$apt/archives"
             -o "APT::Sandbox::User=" -o "Acquire::Retries=3")
[ "$(id -u)" = 0 ] || apt_options+=(-o "Debug::NoLocking=1")

say "asking the package registry for the source of LAMMPS"
unknown() { :; }
# one dead list must not stop us
with_progress "LAMMPS, source" "$apt/update.log" unknown apt-get "${apt_options[@]}" -qq update || true
version=$(apt-cache "${apt_options[@]}" showsrc --only-source lammps 2> /dev/null |
  sed -n 's/^Version: //p' | sort -V | tail -n 1)
[ -n "$version" ] || { cat "$apt/update.log" >&2
  fail "the package registry of this machine could not be reached, or it has no source package 'lammps' (see above).
  Check the network and /etc/apt, or build against your own LAMMPS source tree:
  cmake -S cmake -B build -D LAMMPS_SOURCE_DIR=DIR"; }

root=$cache/lammps-${version//[^0-9A-Za-z.+]/_}-$system-$hash
mkdir -p "$root"
if [ ! -d "$root/src" ]; then
  say "downloading and unpacking lammps $version"
  rm -rf "$root/download"; mkdir "$root/download"
  # A mirror may lack the description (.dsc) of a package whose tarball it has. apt has checked the tarball then, so it
  # is taken as it is, without the distribution's patches (which concern its own packaging).
  (cd "$root/download" && with_progress "LAMMPS, source" get.log unknown \
     apt-get "${apt_options[@]}" -q source --only-source --download-only "lammps=$version") || true
  mkdir "$root/download/tree"
  if compgen -G "$root/download/*.dsc" > /dev/null; then
    rmdir "$root/download/tree"
    (cd "$root/download" && with_progress "LAMMPS, unpacking" unpack.log unknown dpkg-source --no-check -x ./*.dsc tree)
  else
    with_progress "LAMMPS, unpacking" "$root/download/unpack.log" unknown \
      tar -xf "$root"/download/lammps_*.orig.tar.* -C "$root/download/tree"
  fi || { tail -n 20 "$root"/download/*.log >&2
    fail "the source package lammps $version could not be downloaded or unpacked"; }
  top=$(find "$root/download/tree" -maxdepth 3 -path '*/src/lammps.h' | head -n 1)
  [ -n "$top" ] || { tail -n 20 "$root"/download/*.log >&2
    fail "the source package lammps $version holds no src/lammps.h"; }
  mv "${top%/src/lammps.h}" "$root/src"
  rm -rf "$root/download"
fi

# --- build: resumed if interrupted -------------------------------------------------------------------------
export CC=gcc CXX=g++
mpicxx=$(command -v mpicxx.openmpi || command -v mpicxx)
mpicc=$(command -v mpicc.openmpi || command -v mpicc)
say "configuring: $packages"
with_progress "LAMMPS, configuring" "$root/configure.log" unknown \
  cmake -S "$root/src/cmake" -B "$root/build" -G Ninja "${options[@]}" \
  -D CMAKE_PROJECT_lammps_INCLUDE="$here/lammps_headers.cmake" \
  -D MPI_CXX_COMPILER="$mpicxx" -D MPI_C_COMPILER="$mpicc" \
  -D CMAKE_INSTALL_PREFIX="$root" -D CMAKE_INSTALL_LIBDIR=lib -D CMAKE_INSTALL_RPATH="$root/lib" ||
  { tail -n 30 "$root/configure.log" >&2; fail "LAMMPS could not be configured; whole log: $root/configure.log"; }
jobs=$(env -u OMP_NUM_THREADS nproc)
say "compiling on $jobs cores: about 5 minutes on two that have nothing else to do, half a GB while it goes on," \
  "150 MB for good"
if ! with_progress LAMMPS "$root/build.log" ninja_percent ninja -C "$root/build" -j "$jobs" install; then
  grep -nE 'error|Error|FAILED' "$root/build.log" | head -n 20 >&2
  fail "LAMMPS could not be compiled; whole log: $root/build.log"
fi
mkdir -p "$root/python"
cp -r "$root/src/python/lammps" "$root/python/"
ln -sf ../../lib/liblammps.so "$root/python/lammps/liblammps.so"

# Debian's own liblammps has the same soname: make sure that the new program loads the new library.
# (Help goes to a file first: a pipe closed early would look like a failure of lmp.)
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
"$root/bin/lmp" -h > "$root/help.txt" 2>&1 || { tail -n 5 "$root/help.txt" >&2; fail "the new LAMMPS does not start"; }
for p in $packages; do
  grep -qw "$p" "$root/help.txt" ||
    fail "the new LAMMPS has no package $p: is another liblammps loaded in its place? (ldd $root/bin/lmp)"
done
rm -rf "$root/build" "$apt/archives" "$root/src/"{doc,examples,bench,potentials,debian,.pc}
echo "lammps $version, options: ${options[*]}" > "$root/complete"
say "done: $root"
printf '%s\n' "$root"
