#!/bin/sh
# SPDX-License-Identifier: MIT
# install.sh [test]: installs the Debian packages that building and the demonstration need, with `test` those of the
# tests too. Does nothing where all are there; asks for nothing. This is the one list of what the project depends on.
packages="gcc libc6-dev make libyaml-dev libgsl-dev libmumps-seq-dev libsuitesparse-dev libtcc-dev gnuplot-nox"
[ "$1" = test ] && packages="$packages g++ clang libclang-rt-dev libcmocka-dev graphviz python3-jsonschema \
    python3-numpy python3-yaml gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user \
    mandoc pkgconf tcc chromium libc6-dev-i386 lib32gcc-12-dev"

if ! command -v dpkg-query >/dev/null; then
    echo "This is no Debian system: make sure that it has what these packages hold: $packages" >&2
    exit 0
fi
# Frama-C takes 0.9 GB with all that it needs (0.2 GB to fetch), and not every release of Debian has it
optional=
[ "$1" = test ] && optional=frama-c-base
# has PACKAGE: does the system offer it, as far as it knows before it has fetched any list?
has() { apt-cache show "$1" >/dev/null 2>&1 || ! apt-cache show gcc >/dev/null 2>&1; }
missing=
for package in $packages $optional; do
    state=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)
    [ "$state" = installed ] || { [ "$package" = "$optional" ] && ! has "$package"; } || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

echo "Installing:$missing" >&2
if [ "$(id -u)" -eq 0 ]; then
    as_root=
elif command -v sudo >/dev/null; then
    as_root=sudo
else
    echo "These packages are missing, and installing them needs root or sudo. As root: apt-get install$missing" >&2
    exit 1
fi
export DEBIAN_FRONTEND=noninteractive
# what is left now that the lists are there
wanted() { for package in $missing; do [ "$package" = "$optional" ] && ! has "$package" || echo "$package"; done; }
# shellcheck disable=SC2046  # a list of words
if ! { $as_root apt-get -q update && $as_root apt-get -q install -y --no-install-recommends $(wanted); } >&2; then
    echo "The packages could not be installed:$missing" >&2
    exit 1
fi
