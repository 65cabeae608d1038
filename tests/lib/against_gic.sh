# shellcheck shell=sh
# SPDX-License-Identifier: MIT
# against_gic.sh: results of runs compared, and runs of every way against those of the engine gic, which evaluates models
# by itself; to be sourced after checking.sh, in a folder for files.

# column NAME FILE: its numbers
column() { awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; ++i) if (index($i, name " ") == 1) k = i; next } { print $k }' "$2"; }
# apart FILE FILE: the largest difference of two tables relative to 1 and the larger number
apart() {
    paste -d, "$1" "$2" | awk -F, 'NR > 1 { for (i = 1; i <= NF / 2; ++i) {
            d = $i - $(i + NF / 2); s = $i < 0 ? -$i : $i; if (d < 0) d = -d; d /= 1 + s; if (!(d <= most)) most = d } }
        END { print (NR > 1 ? most + 0 : 1) }'
}
within() { awk "BEGIN { exit !($1 <= $2) }"; }

# every_way NAME TOLERANCE MODEL SCENE: a run by all ways of generating
every_way() { some_ways "$@" '' --general '--engine tape' '--engine cc --lanes 4' '--solve augmented' '--recovery newton'; }
# some_ways NAME TOLERANCE MODEL SCENE WAY...: by these
# shellcheck disable=SC2154  # who sources this sets $gicrun
some_ways() {
    named=$1
    tolerance=$2
    compared=$3
    scene_of_it=$4
    shift 4
    "$gicrun" -q --engine gic "$compared" "$scene_of_it" -o gic.csv 2>err
    for way; do
        off=
        # shellcheck disable=SC2086  # options
        "$gicrun" -q $way "$compared" "$scene_of_it" -o way.csv 2>err && off=$(apart way.csv gic.csv)
        check "$named against gic, $way: ${off:-no run}" within "${off:-1}" "$tolerance"
    done
}
