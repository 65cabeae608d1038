#!/bin/sh
# SPDX-License-Identifier: MIT
# derivatives.sh GICGEN RANDOM_VEHICLE GICRUN: derivatives in the code and in runs of random mechanisms, MODELS (short: 1,
# full: 300) of them from the seed 1,001 on, with what tests/system/test_random_derivatives.sh wants of each.
[ "$STRESS" = short ] && usual=1 || usual=300
export MODELS="${MODELS:-$usual}" FIRST="${FIRST:-1001}"
sh "$(dirname "$0")/../system/test_random_derivatives.sh" "$@" | awk -v all="$MODELS" '
    /^FAILED: / { verdict = verdict ? verdict : $0 }
    /mechanisms refused by gicgen$/ { refused = $1 }
    /^[0-9]* passed, [0-9]* failed$/ { passed = $1 }
    { print >"/dev/stderr" }
    END {
        if (passed == 0)
            verdict = "nothing was compared"
        printf "derivatives | random mechanisms | %d | %d | %d | %d comparisons | %s\n", all, all - refused, refused, passed,
            verdict ? verdict : "ok"
    }'
