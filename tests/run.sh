#!/bin/sh
# SPDX-License-Identifier: MIT
# run.sh [--dry-run] [NAME...]: installs what is missing, builds and runs every test, or those named (test_read
# test_runtime ...). The last line is `N passed, N failed`; the exit status is 0 when none failed. --dry-run: only says
# what it would do.
#
# A test is either tests/test_NAME.c, a cmocka program, or tests/test_NAME.sh, a script that prints `N passed, N failed`
# at its end. A script's first line of comment names the programs that it wants as arguments: tests/paths.sh.
cd "$(dirname "$0")/.." || exit 1
if [ "$1" = --dry-run ]; then
    sh tests/install.sh --dry-run test || exit 1
    echo "Then it builds in ${BUILD:-build}, some minutes, and runs every test, which takes half an hour to an hour."
    exit 0
fi
sh tests/install.sh test || exit 1
echo "Building, some minutes; all tests take half an hour to an hour ..." >&2
build=${BUILD:-build}
. tests/paths.sh
make --no-print-directory -s -j2 WERROR=-Werror BUILD="$build" test-programs || exit 1

# names of all tests, programs before scripts: what the scripts use should have been tested before
tests() {
    make --no-print-directory -s BUILD="$build" list-tests
    for file in tests/test_*.sh; do basename "$file" .sh; done
}

# run NAME: runs one test; its output ends in $log
run() {
    if [ -f "tests/$1.sh" ]; then
        # shellcheck disable=SC2046  # one argument a path
        sh "tests/$1.sh" $(paths "tests/$1.sh")
    else
        "$build/check/$1"
    fi >"$log" 2>&1
}

log=$(mktemp) || exit 1
# compiled models are kept for the tests alone
GICGEN_CACHE=$(mktemp -d) || exit 1
PYTHONDONTWRITEBYTECODE=1
export GICGEN_CACHE PYTHONDONTWRITEBYTECODE
trap 'rm -rf "$log" "$GICGEN_CACHE"' EXIT
trap 'exit 130' INT TERM
passed=0
failed=0
for name in ${*:-$(tests)}; do
    printf '%-28s' "$name"
    start=$(date +%s)
    run "$name"
    status=$?
    if [ -f "tests/$name.sh" ]; then
        good=$(sed -n '$s/^\([0-9]*\) passed, [0-9]* failed$/\1/p' "$log")
        bad=$(sed -n '$s/^[0-9]* passed, \([0-9]*\) failed$/\1/p' "$log")
    else
        good=$(grep -c '^\[       OK \]' "$log")
        bad=$(grep '^\[  FAILED  \] [^ ]*$' "$log" | sort -u | wc -l)
    fi
    good=${good:-0}
    bad=${bad:-0}
    # a test that stops halfway, or that tests nothing, has failed
    if [ "$status" -ne 0 ] || [ "$good" -eq 0 ]; then
        [ "$bad" -ne 0 ] || bad=1
        echo "$good passed, $bad FAILED, exit status $status, $(($(date +%s) - start)) s"
        sed 's/^/    /' "$log"
    else
        echo "$good passed, $(($(date +%s) - start)) s"
    fi
    passed=$((passed + good))
    failed=$((failed + bad))
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
