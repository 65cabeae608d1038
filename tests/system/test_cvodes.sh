#!/bin/sh
# SPDX-License-Identifier: MIT
# test_cvodes.sh GICGEN GICRUN: gradients of smooth runs by `gicrun --gradient`, which are those of its steps, against the
# adjoint of the differential equation by SUNDIALS' CVODES over code of `gicgen --derivatives` (tests/derivatives/cvodes.py).
gicgen=$1
gicrun=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
libraries="-lsundials_cvodes -lsundials_nvecserial -lsundials_sunnonlinsolfixedpoint -lm"
cat >"$work/probe.c" <<'END'
#include <cvodes/cvodes.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
int main(void) { return 0; }
END
# shellcheck disable=SC2086  # a list of words
if ! cc -o "$work/probe" "$work/probe.c" $libraries >"$work/said" 2>&1; then
    echo "CVODES can not be used here: $(grep error "$work/said" | head -n 1)"
    exit 0
fi
# shellcheck disable=SC2086  # a list of words
/usr/bin/python3 -B "$root/tests/derivatives/cvodes.py" "$gicgen" "$gicrun" "$root" "$work" $libraries >"$work/said" 2>&1
verdict $? "against CVODES"
cat "$work/said"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
