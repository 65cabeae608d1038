#!/bin/sh
# SPDX-License-Identifier: MIT
# demo.sh [--dry-run]: installs what is missing, builds, drives the complete HMMWV for 30 s, another one over the road of
# models/scenes/paper_run.scene, makes a page to drive in where clang compiles for WebAssembly, and says where pictures,
# pages and numbers are. --dry-run: only says what it would do.
set -e
cd "$(dirname "$0")/.."
case "$#$1" in
0) ;;
1--dry-run)
    sh tests/install.sh --dry-run
    echo "Then it builds in ${BUILD:-build}, which takes a minute or two, and runs two scenes for some seconds."
    exit 0
    ;;
*)
    echo "usage: demo.sh [--dry-run]" >&2
    exit 2
    ;;
esac
sh tests/install.sh
echo "Building, which takes a minute or two ..." >&2
make --no-print-directory -s -j"$(nproc)" all
exec make --no-print-directory -s demo
