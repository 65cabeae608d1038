#!/bin/sh
# SPDX-License-Identifier: MIT
# install.sh [--dry-run] [test]: installs the Debian packages that building and the demonstration need, with `test` those
# of the tests too. Does nothing where all are there; asks for nothing; says before what it takes. With --dry-run it
# only says that. This is the one list of what the project depends on.
cd "$(dirname "$0")/.." || exit 1
dry=
[ "$1" != --dry-run ] || { dry=yes && shift; }
[ $# -eq 0 ] || { [ $# -eq 1 ] && [ "$1" = test ]; } || { echo "usage: install.sh [--dry-run] [test]" >&2; exit 2; }
# a name with ^ is the beginning of one that has a version in it
packages="gcc libc6-dev make libyaml-dev libminizip-dev zlib1g-dev libgsl-dev libsuitesparse-dev libtcc-dev libhdf5-dev gnuplot-nox"
# MUMPS without its packages for linking, which bring MPI and a Fortran compiler: 14 MB, not 250
[ "$1" = test ] && packages="$packages libmumps-headers-dev ^libmumps-seq-5 g++ clang libclang-rt-dev libcmocka-dev \
    graphviz python3-jsonschema python3-h5py python3-numpy python3-scipy python3-yaml gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm \
    gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user mandoc patch pkgconf tcc chromium libc6-dev-i386 lib32gcc-dev \
    lld wasi-libc libclang-rt-dev-wasm32 clang-format clang-tidy shellcheck libsundials-dev coinor-libipopt-dev libxml2-dev libxml2-utils gcc-mingw-w64-x86-64-win32"

if ! command -v dpkg-query >/dev/null; then
    echo "This is no Debian system: make sure that it has what these packages hold: $packages" >&2
    exit 0
fi
# Frama-C takes 0.9 GB with all that it needs (0.2 GB to fetch), Wine 0.7 GB (0.1 GB), Slurm 0.05 GB, and not every release
# of Debian has them
optional=
[ "$1" = test ] && optional="frama-c-base wine64 slurmctld slurmd slurm-client munge"
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

lists= # options of apt for package lists elsewhere
# shellcheck disable=SC2086  # a list of words
cache() { apt-cache $lists "$@" 2>/dev/null; }
known() { cache show gcc | grep -q .; }
installed() { dpkg-query -W -f '${db:Status-Status}\n' "$1" 2>/dev/null | grep -qx installed; }

# name PACKAGE: as this release has it: with its version, and lib32gcc-dev for the version of gcc that is the usual one
name() {
    case $1 in
    ^*) cache pkgnames "${1#^}" | sort -V | tail -n 1 | grep . || echo "$1" ;;
    lib32gcc-dev)
        version=$(cache depends gcc | sed -n 's/.*Depends: gcc-\([0-9]*\)$/\1/p')
        echo "lib32gcc-${version:-$(gcc -dumpversion 2>/dev/null || echo 12)}-dev"
        ;;
    *) echo "$1" ;;
    esac
}

is_optional() { case " $optional " in *" $1 "*) ;; *) return 1 ;; esac; }

# what is not installed, of what can be
missing() {
    for package in $packages $optional; do
        package=$(name "$package")
        case $package in
        ^*) installed "${package#^}*" ;;
        *) installed "$package" ;;
        esac || { is_optional "$package" && known && ! cache show "$package" | grep -q .; } || echo "$package"
    done
}

# plan: what apt would do, for `wanted`
plan() {
    # shellcheck disable=SC2086  # lists of words
    LC_ALL=C apt-get $lists -o Debug::NoLocking=1 install --assume-no --no-install-recommends $wanted 2>&1
}

# mb TEXT: a size as apt writes it, in MB, rounded up
mb() {
    echo "$1" | awk '{ sub(/.*\//, ""); sub(/,/, "", $1)
        n = $1 * ($2 == "GB" ? 1000 : $2 == "MB" ? 1 : 0.001); print int(n) + (n > int(n)) }'
}

# what installing takes: a line of 5 MB a second and a disk that unpacks 10
tell() {
    plan >"$work/plan"
    fetch=$(mb "$(sed -n 's/^Need to get \(.*\) of archives.*/\1/p' "$work/plan")")
    room=$(mb "$(sed -n 's/^After this operation, \(.*\) of additional disk space.*/\1/p' "$work/plan")")
    count=$(sed -n 's/.* \([0-9]*\) newly installed.*/\1/p' "$work/plan")
    [ -n "$count" ] || { cat "$work/plan" >&2; return 1; }
    echo "Installing with apt-get, with what these need $count packages:"
    # shellcheck disable=SC2086  # a list of words
    echo $wanted | fold -s -w 100 | sed 's/^/    /'
    echo "They take $fetch MB to fetch, $room MB on the disk, and about $(((fetch / 5 + room / 10 + 59) / 60)) min."
}

wanted=$(missing)
if [ -z "$wanted" ]; then
    [ -z "$dry" ] || echo "Nothing to install."
    exit 0
fi
if [ -n "$dry" ]; then
    if ! known; then # lists of packages, for this once
        mkdir -p "$work/lists/partial"
        lists="-o Dir::State::lists=$work/lists -o Dir::Cache=$work"
        # shellcheck disable=SC2086  # a list of words
        apt-get $lists -o Debug::NoLocking=1 -o APT::Sandbox::User= update >/dev/null 2>&1
        wanted=$(missing)
    fi
    tell
    exit
fi

if [ "$(id -u)" -eq 0 ]; then
    as_root=
elif command -v sudo >/dev/null; then
    as_root=sudo
else
    # shellcheck disable=SC2086  # a list of words
    echo "Packages are missing, and installing them needs root or sudo. As root: apt-get install" $wanted >&2
    exit 1
fi
log=${BUILD:-build}/install.log
mkdir -p "$(dirname "$log")" || exit 1
DEBIAN_FRONTEND=noninteractive
export DEBIAN_FRONTEND
fail() {
    tail -n 20 "$log" >&2
    echo "The packages could not be installed; all that apt-get said: $log" >&2
    exit 1
}
echo "Some packages are missing; asking what they take ..." >&2
$as_root apt-get -q update >"$log" 2>&1 || fail
wanted=$(missing)
{ tell && echo "What apt-get says goes to $log."; } >&2 || exit 1
# shellcheck disable=SC2086  # a list of words
$as_root apt-get -q install -y --no-install-recommends $wanted >>"$log" 2>&1 || fail
