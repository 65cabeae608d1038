#!/bin/sh
# SPDX-License-Identifier: MIT
# test_warnings.sh GICGEN GICSWEEP: no option, alone or beside another one, gives code that compilers warn about.
#
# Small models, each of which has something that others have not: hop a wheel whose point of the road stays, rig eight alike
# bodies (arrays of 8 x 30 numbers), corner no state at all, states own states, quarter_car posts.
gicgen=$1
gicsweep=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
. "$root/tests/lib/checking.sh"
data=$root/tests/data
mkdir "$work/code"

# compiles MODEL OPTION...: as C99, in lanes with the vectors of gcc, for both kinds of numbers
compiles() {
    model=$1
    shift
    "$gicgen" "$@" "$model" -o "$work/code/model.c" >"$work/said" 2>&1 || return 1
    for real in -DGIC_DOUBLE -DGIC_FLOAT; do
        ${CC:-cc} -std=c99 -Wall -Wextra -Wpedantic -Wno-psabi -Werror $real -O0 -I"$root/runtime" -I"$work/code" -S \
            -o "$work/code/model.s" "$work/code/model.c" >"$work/said" 2>&1 || return 1
    done
}
for model in "$data/contact/hop.veh" "$data/elements/rig.veh" "$root/models/optimize/corner.veh" "$data/laws/states.veh" \
    "$root/models/quarter_car.veh"; do
    own=$(sed -n 's/^model: *//p' "$model")
    "$gicgen" "$model" -o "$work/code/$own.c"
    while read -r options; do
        # shellcheck disable=SC2086  # a list of words
        check "$own: $options" compiles "$model" $options
    done <<'END_OF_OPTIONS'

--derivatives
--implicit
--derivatives --implicit
--implicit --spread-jacobian
--lanes 4 --derivatives
--lanes 4 --implicit
--batch 4
--batch 8 --lanes 2
--solve augmented --derivatives --implicit
END_OF_OPTIONS
done

# ---- vehicles without a state run in lanes. The interpreted engine recovers poses to 1e-12 of a corner's 0.3 m

sweep() {
    "$gicsweep" "$root/models/optimize/corner.veh" "$root/models/optimize/corner.scene" \
        --vary parameter/link_in_y=0.2:0.24:5 "$@" >"$work/out" 2>"$work/err"
}
agree() { # numbers of both tables, which are at most 1 here; time and status to the same bound
    paste -d, "$work/lanes.csv" "$work/gic.csv" | awk -F, 'NR > 1 { for (i = 1; i <= NF / 2; ++i) {
        d = $i - $(i + NF / 2); if (!(d <= 1e-10 && d >= -1e-10)) bad = 1 } } END { exit bad || NR != 6 }'
}
sweep -o "$work/lanes.csv"
check 'vehicles without a state run in lanes' says 'in lanes'
sweep --engine gic -o "$work/gic.csv"
check 'and as interpreted' agree

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
