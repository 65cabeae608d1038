#!/bin/sh
# SPDX-License-Identifier: MIT
# test_wheel_runs.sh GICGEN GICRUN: wheels with tires along runs (tests/data/tires/runs.py): braking with lock-up to
# standstill, parking on a slope, backing up through standstill, a jump, a gyroscope, symmetry, balance of energy and
# orders of the integrators.
here=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
python3 "$here/data/tires/runs.py" "$1" "$2" "$here/../models" "$work" >"$work/said"
status=$?
grep -v '^ok' "$work/said"
passed=$(grep -c '^ok' "$work/said")
failed=$(grep -c '^FAIL' "$work/said")
[ $status -eq 0 ] || failed=$((failed + 1))
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -ge 50 ]
