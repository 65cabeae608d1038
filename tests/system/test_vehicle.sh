#!/bin/sh
# SPDX-License-Identifier: MIT
# test_vehicle.sh GICRUN: the complete HMMWV in its scenes, against mechanics, geometry and the tire's data; energy, rates
# and engines against each other.
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0
failed=0

/usr/bin/python3 -B "$root/tests/vehicle/scenes.py" "$gicrun" "$root/models" "$work" >"$work/notes" 2>"$work/err"
status=$?
while read -r how what; do
    if [ "$how" = good ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED: $what"
    fi
done <"$work/notes"
if [ $status -ne 0 ]; then
    failed=$((failed + 1))
    echo "FAILED: the scenes are driven to the end"
    sed 's/^/    /' "$work/err"
fi

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
