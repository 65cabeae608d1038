#!/bin/sh
# SPDX-License-Identifier: MIT
# test_accelerations.sh GICGEN GICRUN STATES REFERENCE AGREE: accelerations and poses of generated code against the
# independent reference in quad precision, at ROWS (default 100) random states of every model.
gicgen=$1
gicrun=$2
states=$3
reference=$4
agree=$5
root=$(dirname "$0")/..
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0
failed=0

for model in "$root"/models/*.veh; do
    if "$gicgen" --dump-model "$model" >"$work/dump" &&
        "$states" "$work/dump" --count "${ROWS:-100}" --seed 1 -o "$work/states" &&
        "$reference" "$work/dump" "$work/states" -o "$work/accelerations" &&
        "$gicrun" --eval "$work/states" "$model" -o "$work/results" &&
        "$agree" "$work/dump" "$work/accelerations" "$work/results"; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL $(basename "$model")"
    fi
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
