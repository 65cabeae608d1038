#!/bin/sh
# SPDX-License-Identifier: MIT
# test_pivots.sh GICGEN GICRUN: where elimination of the mass matrix would leave too few digits of an acceleration, code
# says so and names coordinate and subset, or body: one by one, in lanes of alike parts, for many vehicles at once, as
# tapes; below that bound accelerations are right within the promised 1e-8. Engines that solve for all multipliers name
# the subset.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1
# builds COMPILER... of sledges.c [sledges_batch.c]
runs() {
    "$@" -std=c11 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -O1 -ffp-contract=off -I. -I"$root/runtime" \
        "$root/tests/data/pivots/statuses.c" "$root/runtime/gic_runtime.c" -lm -o statuses 2>err && ./statuses >out
}

for lanes in '' '--lanes 2'; do
    for recovery in auto newton; do
        # shellcheck disable=SC2086  # a list of words
        "$gicgen" $lanes --recovery $recovery "$root/tests/data/pivots/sledges.veh" -o sledges.c && runs gcc sledges.c
        verdict $? "gcc $lanes --recovery $recovery: $(cat err out)"
    done
done
"$gicgen" "$root/tests/data/pivots/sledges.veh" -o sledges.c &&
    "$gicgen" --batch 8 "$root/tests/data/pivots/sledges.veh" -o sledges_batch.c &&
    runs gcc -DBATCH sledges.c sledges_batch.c
verdict $? "gcc --batch 8: $(cat err out)"

# no place within the range is refused where elimination in a bad order finds a zero, 4e-5 m wide; and what comes out is
# what the interpreted engine finds by other pivots, within 1e-9 of some 4 m/s^2
awk 'BEGIN { print "s,s.rate"; for (i = 0; i < 2000; ++i) printf "%.6f,0.3\n", 0.4855 + 1e-5 * i }' >wishbone.csv
"$gicrun" --quiet --engine gic --eval wishbone.csv "$root/tests/data/pivots/wishbone.veh" -o sound.csv 2>err
verdict $? "wishbone, gic: $(head -n 1 err)"
for recovery in auto newton; do
    "$gicrun" --quiet --recovery $recovery --eval wishbone.csv "$root/tests/data/pivots/wishbone.veh" -o found.csv 2>err &&
        ! grep -q warning err && paste -d, sound.csv found.csv | awk -F, '
            NR > 1 { n = NF / 2; for (i = 1; i <= n; ++i) { d = $i - $(n + i); if (!(d * d <= 1e-18) || $(n + i) == "") bad = 1 } }
            END { exit bad || NR != 2001 }'
    verdict $? "wishbone --recovery $recovery: no place is refused: $(head -n 1 err)"
done

# A block of three pivots whose determinant loses digits while no pivot of its own does (pivots/train.veh): right within
# 1e-8 of what 60 digits give, or refused.
awk 'BEGIN { print "x,x.rate,y,y.rate,z,z.rate,apart"
    for (i = 0; i < 150; ++i) printf "0,0,0,0,0,0,%.17g\n", 0.7 * exp(-0.05 * i) }' >train.csv
for engine in tape tcc; do
    "$gicrun" --quiet --engine $engine --eval train.csv "$root/tests/data/pivots/train.veh" -o found.csv 2>err
    python3 "$root/tests/data/pivots/train.py" train.csv found.csv >out 2>&1
    verdict $? "three pivots, engine $engine: $(cat out)"
done

# a free base whose arms weigh 1e9 times as much as they do: heave of the base is named, by every engine
python3 "$root/tests/stress/scale.py" "$root/models/trailing_arm.veh" 'body=arm*:1e9' >light.veh
verdict $? "scaling a model"
printf 'gicscene: 1\nduration: 0.01\nstep: 0.001\n' >light.scene
for engine in tcc cc tape; do
    "$gicrun" --general --engine $engine light.veh light.scene -o light.csv 2>err
    [ $? -eq 1 ] && grep -q "too few digits would be left: 'v.z' of body 'chassis'" err
    verdict $? "engine $engine: $(cat err)"
done

# Engines that say where constraints seem to depend on each other name the subset: the wheels weigh 1e12 times as much as
# they do, and what their arms' hinges can move is lost beside them. Generated code knows no such limit there.
for model in trailing_arm hmmwv; do
    python3 "$root/tests/stress/scale.py" "$root/models/$model.veh" 'body=wheel*:1e12' >heavy.veh
    for engine in gic gcp1 gcp2; do
        "$gicrun" --engine $engine heavy.veh light.scene -o heavy.csv 2>err
        [ $? -eq 1 ] && grep -q "too few digits would be left: subset '\(lca\|arm\|wheel\)_[fr]_[lr]'$" err
        verdict $? "$model, engine $engine: $(cat err)"
    done
done

# The augmented form has no such account of digits at run time: gicgen refuses masses that are too unequal for it, and
# takes those some hundred times nearer.
scaled() { python3 "$root/tests/stress/scale.py" "$root/models/trailing_arm.veh" "body=arm*:$1" >unequal.veh; }
scaled 1e9 && "$gicgen" --solve augmented unequal.veh -o unequal.c 2>err
[ $? -eq 1 ] && [ ! -e unequal.c ] &&
    grep -q "unequal.veh:[0-9]*:[0-9]*: error: body 'arm_[fr]_[lr]' has more than 1e+09 times the mass of 'rack'" err
verdict $? "masses too unequal for the augmented form: $(cat err)"
scaled 1e6 && "$gicgen" --solve augmented unequal.veh -o unequal.c 2>err && scaled 1e9 &&
    "$gicgen" unequal.veh -o unequal.c 2>err
verdict $? "masses that it takes, and that the reduced form does: $(cat err)"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
