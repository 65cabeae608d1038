#!/bin/sh
# SPDX-License-Identifier: MIT
# test_manoeuvre_keys.sh GICRUN: the table of keys in models/MANOEUVRES.md has all that the messages have, and values at both bounds and beyond them.
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
/usr/bin/python3 -B "$root/tests/vehicle/manoeuvre_keys.py" "$gicrun" "$root/models" "$work" >"$work/said" 2>&1
verdict $? "the table of keys"
tail -n 1 "$work/said"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
