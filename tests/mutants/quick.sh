#!/bin/sh
# SPDX-License-Identifier: MIT
# quick.sh GICGEN GICRUN STATES REFERENCE AGREE: a short look at everything that generates, for mutants.py: gicgen takes
# models in all ways and for their scenes, which its own validation judges; at a few random states tapes agree with the
# reference in quad precision as in test_accelerations.sh, and short runs of tapes with those of the engine gic. The folder
# $WANTED, where it is given, keeps what the reference finds for a model and its states.
gicgen=$1
gicrun=$2
states=$3
reference=$4
agree=$5
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"

# close A B: do two results differ by less than 1e-6 of the largest of a column, or of 1?
close() { awk -F, 'FNR == 1 { next } NR == FNR { for (i = 1; i <= NF; ++i) { a[FNR, i] = $i; d = $i < 0 ? -$i : $i; if (d > m[i]) m[i] = d } next }
    { for (i = 1; i <= NF; ++i) { d = a[FNR, i] - $i; if (d < 0) d = -d; if (!(d <= 1e-6 * (1 + m[i]))) bad = 1 }; rows = FNR }
    END { exit bad || rows < 3 }' "$1" "$2"; }

# ask_reference: accelerations of $work/dump at $work/states, into $work/wanted
ask_reference() {
    kept=${WANTED:-$work}/$(cat "$work/dump" "$work/states" "$reference" | sha256sum | cut -d ' ' -f 1)
    [ -s "$kept" ] || { "$reference" "$work/dump" "$work/states" -o "$kept.$$" && mv "$kept.$$" "$kept"; } || return 1
    cp "$kept" "$work/wanted"
}

# those first that have most of everything
for name in hmmwv_vehicle solid_axle five_link hmmwv_tmeasy andrews trailing_arm hmmwv14 quarter_car pendulum cart; do
    model=$root/models/$name.veh
    [ -f "$model" ] || model=$root/tests/data/laws/$name.veh
    for way in '' '--solve augmented' '--recovery newton' '--recovery closed' '--lanes 4'; do
        # shellcheck disable=SC2086  # words
        check "$name $way" "$gicgen" $way "$model" -o "$work/code.c" 2>"$work/err"
    done
    tolerance=5e-13
    "$gicgen" --dump-model "$model" >"$work/dump" &&
        { ! grep -q '"tire": [0-9]' "$work/dump" || tolerance=2e-12; } &&
        { sh "$root/tests/lib/reactions.sh" "$work/dump" "$model" && sh "$root/tests/lib/wheels.sh" "$work/dump"; } >"$work/variant.veh" &&
        "$states" "$work/dump" --count 6 --seed 1 -o "$work/states" &&
        ask_reference >"$work/out" 2>&1
    verdict $? "$name: reference"
    for solve in reduced augmented; do
        "$gicrun" -q --solve $solve --engine tape --eval "$work/states" "$work/variant.veh" -o "$work/found" 2>"$work/err" &&
            "$agree" "$work/dump" "$work/wanted" "$work/found" --reactions --wheels --tolerance $tolerance >"$work/out"
        verdict $? "$name $solve"
    done
done
cp -r "$root/models" "$work" # scenes name files beside them
for run in hmmwv/rough_road hmmwv/paper_run hmmwv_tires/tires_jump hmmwv_vehicle/full_run quarter_car/quarter_car; do
    model=$root/models/${run%/*}.veh
    sed -E 's/^duration:.*/duration: 0.12/; s/^output_step:.*/output_step: 0.03/' "$root/models/scenes/${run#*/}.scene" \
        >"$work/models/scenes/quick.scene"
    check "$run" "$gicgen" --scene "$root/models/scenes/${run#*/}.scene" "$model" -o "$work/code.c" 2>"$work/err"
    for engine in tape gic; do
        "$gicrun" -q --engine $engine "$model" "$work/models/scenes/quick.scene" -o "$work/$engine.csv" 2>"$work/err"
        verdict $? "$run, $engine"
    done
    check "$run: engines agree" close "$work/tape.csv" "$work/gic.csv"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
