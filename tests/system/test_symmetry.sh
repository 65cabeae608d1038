#!/bin/sh
# SPDX-License-Identifier: MIT
# test_symmetry.sh GICRUN: a model written for the left side alone moves in the mirror on the right: equal coordinates
# are mirrored poses, whatever the axes, orientations and products of inertia.
gicrun=$1
here=$(dirname "$0")/../data/symmetry
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

"$gicrun" "$here/swing.veh" "$here/swing.scene" -o "$work/run.csv" >"$work/log" 2>&1 || cat "$work/log"
# each column of the left with its sign in the mirror: polar vectors change y; turns and Euler parameters x and z
awk -F, '
    BEGIN {
        count = split("tip.x + tip.y - tip.z + push.x + push.y - push.z + spin.x - spin.y + spin.z - " \
            "turn.e0 + turn.e1 - turn.e2 + turn.e3 - swing.value + swing.rate + swing.acceleration + " \
            "out.value + out.rate + out.acceleration + pull +", word, " ") / 2
    }
    NR == 1 { for (i = 1; i <= NF; ++i) { sub(/ .*/, "", $i); column[$i] = i } }
    NR > 1 {
        for (k = 1; k <= count; ++k) {
            name = word[2 * k - 1]
            dot = index(name ".", ".")
            left = $column[substr(name, 1, dot - 1) "_l" substr(name, dot)]
            right = $column[substr(name, 1, dot - 1) "_r" substr(name, dot)]
            difference = left - (word[2 * k] "1") * right
            if (difference > 1e-12 || difference < -1e-12) bad[name] = 1
            if (left > largest[name] || -left > largest[name]) largest[name] = left < 0 ? -left : left
        }
    }
    END {
        for (k = 1; k <= count; ++k) {
            name = word[2 * k - 1]
            # a column that stays zero would show nothing
            if (NR == 22 && !(name in bad) && largest[name] > 1e-3) ++passed
            else { ++failed; print "FAIL " name " is not mirrored (largest value " largest[name] ", rows " NR - 1 ")" }
        }
        print passed + 0 " passed, " failed + 0 " failed"
        exit failed > 0
    }' "$work/run.csv"
