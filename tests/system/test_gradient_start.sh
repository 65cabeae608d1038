#!/bin/sh
# SPDX-License-Identifier: MIT
# test_gradient_start.sh GICRUN: how starts of runs follow parameters and inputs, in gradients (tests/vehicle/gradient_start.py).
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
/usr/bin/python3 -B "$root/tests/vehicle/gradient_start.py" "$gicrun" "$root/models" "$work" >"$work/said" 2>&1
verdict $? "how starts of runs follow parameters"
sed -n '/FAILED/p;$p' "$work/said"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
