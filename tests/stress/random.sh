#!/bin/sh
# SPDX-License-Identifier: MIT
# random.sh RANDOM_VEHICLE GICGEN GICRUN STATES REFERENCE AGREE COMPARE_DUMP: VEHICLES (short: 2, full: 1000) random
# vehicles against quad precision at ROWS (short: 10, full: 4) states, and as many mechanisms with a mistake, which must
# be refused with a culprit's name (tests/system/test_random.sh); and MISTAKES (short: 50, full: 2000) mistakes of all kinds in
# files of such vehicles (tests/system/test_mistakes.sh).
[ "$STRESS" = short ] && usual=2 || usual=1000
[ "$STRESS" = short ] && states=10 || states=4
[ "$STRESS" = short ] && mistakes=50 || mistakes=2000
export VEHICLES="${VEHICLES:-$usual}" ROWS="${ROWS:-$states}" COMPILED="${COMPILED:-50}"
export MISTAKES="${MISTAKES:-$mistakes}"
sh "$(dirname "$0")/../system/test_random.sh" "$@" |
    awk -v all=$((2 * VEHICLES)) '
    /^FAIL / {
        verdict = verdict ? verdict : $0
        print >"/dev/stderr"
        next
    }
    /^worst / { worst = $2 }
    /^[0-9]* passed, [0-9]* failed$/ { passed = $1 }
    END {
        # what is broken and refused with a culprit counts as half of what passed
        refused = verdict ? 0 : all / 2
        printf "random | random vehicles | %d | %d | %d | %s of all terms | %s\n", all, passed - refused, refused,
            worst, verdict ? verdict : "ok"
    }'
sh "$(dirname "$0")/../system/test_mistakes.sh" "$2" "$1" | awk -v all="$MISTAKES" '
    /^FAIL / { verdict = verdict ? verdict : $0 }
    /^FAIL /, !/./ { print >"/dev/stderr" }
    /^[0-9]* kinds$/ { kinds = $1 }
    /^[0-9]* passed, [0-9]* failed$/ { passed = $1 }
    END { printf "random | mistakes | %d | 0 | %d | %d kinds | %s\n", all, passed, kinds, verdict ? verdict : "ok" }'
