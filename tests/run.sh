#!/bin/sh
# SPDX-License-Identifier: MIT
# run.sh [--dry-run] [quick | NAME...]: installs what is missing, builds and runs every test on all processors, or those
# of tests/quick.txt, or those named (test_read test_runtime ...). Ctrl-C ends them all. The last line is
# `N passed, N failed`; the exit status is 0 when none failed. --dry-run: only says what it would do.
#
# A test is either tests/unit/test_NAME.c, a cmocka program, or tests/system/test_NAME.sh, a script that prints `N passed, N failed`
# at its end. A script's first line of comment names the programs that it wants as arguments: tests/paths.sh. Tests run
# side by side, so that a test writes into its $TMPDIR alone.
cd "$(dirname "$0")/.." || exit 1
build=${BUILD:-build}
dry=
[ "$1" != --dry-run ] || { dry=yes && shift; }
case $1 in
quick) time="the tests of tests/quick.txt, which take three minutes on two processors" ;;
'') time="every test, which takes an hour to an hour and a half on two processors" ;;
*) time="$*" ;;
esac
if [ -n "$dry" ]; then
    sh tests/install.sh --dry-run test || exit 1
    echo "Then it builds in $build, some minutes, and runs $time."
    exit 0
fi
sh tests/install.sh test || exit 1
echo "Building, from nothing some minutes; then $time ..." >&2
make --no-print-directory -s -j"$(nproc)" WERROR=-Werror BUILD="$build" test-programs || exit 1

programs() { make --no-print-directory -s BUILD="$build" list-tests; }
# names of all tests
tests() {
    programs
    for file in tests/system/test_*.sh; do basename "$file" .sh; done
}

case $1 in
quick) names="$(programs) $(sed -n 's/^\(test_[a-z0-9_]*\) .*/\1/p' tests/quick.txt)" ;;
'') names=$(tests) ;;
*) names=$* ;;
esac
# shellcheck disable=SC2086  # a list of words
exec python3 tests/in_parallel.py "$build" $names
