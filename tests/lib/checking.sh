# shellcheck shell=sh
# SPDX-License-Identifier: MIT
# checking.sh: for scripts that test; to be sourced. A folder $work that goes at the end; counts $passed and $failed, by
# check() and verdict(); and conditions for check() about a run of $gicrun.
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
PYTHONDONTWRITEBYTECODE=1 # the sources stay as they are
export PYTHONDONTWRITEBYTECODE
passed=0
failed=0
# what a failure shows, whether or not anything was written there
: >"$work/out"
: >"$work/err"
: >"$work/said"

# verdict STATUS NAME: counts what has been found out; anything but 0 is a failure
verdict() {
    if [ "$1" -eq 0 ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED: $2"
        sed 's/^/    /' "$work/out" "$work/err" "$work/said" 2>&1 | tail -n 60
    fi
}

# check NAME CONDITION...: the command must succeed
check() {
    name=$1
    shift
    "$@"
    verdict $? "$name"
}

# shellcheck disable=SC2154  # who sources this sets $gicrun
run() {
    "$gicrun" "$@" >"$work/out" 2>"$work/err"
    status=$?
}
exits() { [ "$status" -eq "$1" ]; }
prints() { grep -q -- "$1" "$work/out"; }
says() { grep -q -- "$1" "$work/err"; }
