#!/bin/sh
# SPDX-License-Identifier: MIT
# test_understeer.sh GICRUN: understeer of the complete HMMWV against axle loads at rest over cornering stiffnesses,
# with several tires and the mass moved (tests/vehicle/understeer.py).
here=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
/usr/bin/python3 -B "$here/vehicle/understeer.py" "$1" "$here/../models" "$work" >"$work/said"
status=$?
grep -v '^ok' "$work/said"
passed=$(grep -c '^ok' "$work/said")
failed=$(grep -c '^FAIL' "$work/said")
[ $status -eq 0 ] || failed=$((failed + 1))
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -ge 58 ]
