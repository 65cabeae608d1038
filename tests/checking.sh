# shellcheck shell=sh
# SPDX-License-Identifier: MIT
# checking.sh: for scripts that run $gicrun and look at what it prints; to be sourced. A folder $work that goes at the
# end, counts $passed and $failed, and conditions for check().
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0
failed=0
# check() shows them, whether there was a run or not
: >"$work/out"
: >"$work/err"

# check NAME CONDITION...: the command must succeed
check() {
    name=$1
    shift
    if "$@"; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED: $name"
        sed 's/^/    /' "$work/out" "$work/err"
    fi
}

run() {
    "$gicrun" "$@" >"$work/out" 2>"$work/err"
    status=$?
}
exits() { [ "$status" -eq "$1" ]; }
prints() { grep -q -- "$1" "$work/out"; }
says() { grep -q -- "$1" "$work/err"; }
