#!/bin/sh
# SPDX-License-Identifier: MIT
# test_chain.sh GICGEN GICRUN STATES REFERENCE AGREE: the articulated form of the equations of motion. Accelerations and
# reactions of chains and trees within half of 1e-12 of the reference in quad precision; energy of a swinging chain is kept;
# operations and C grow linearly in the length of a chain, as far as 100 links in 300 MB; the generator takes the form with
# fewer operations; what a large model takes is told; masses that the form is not for are refused.
gicgen=$1
gicrun=$2
states=$3
reference=$4
agree=$5
tests=$(dirname "$0")/..
# shellcheck source=tests/lib/checking.sh
. "$tests/lib/checking.sh"
model=$work/model.veh

# agrees ROWS AGREE-OPTIONS GICRUN-OPTIONS: $model at random states
agrees() {
    rows=$1
    compared=$2
    shift 2
    # shellcheck disable=SC2086  # a list of words
    "$gicgen" --dump-model "$model" >"$work/dump" 2>"$work/err" &&
        "$states" "$work/dump" --count "$rows" --seed 5 -o "$work/states" 2>>"$work/err" &&
        "$reference" "$work/dump" "$work/states" -o "$work/accelerations" 2>>"$work/err" &&
        "$gicrun" "$@" --eval "$work/states" "$model" -o "$work/results" 2>>"$work/err" &&
        "$agree" "$work/dump" "$work/accelerations" "$work/results" --tolerance 5e-13 $compared >"$work/out"
}

for kind in "20 spatial free" "40 planar fixed"; do
    # shellcheck disable=SC2086
    sh "$tests/lib/chain.sh" $kind >"$model"
    check "chain $kind: reference" agrees 3 "" --engine tape
done
sh "$tests/lib/chain.sh" 6 spatial free >"$model"
for engine in cc tcc; do
    check "chain of 6, $engine: reference" agrees 6 "" --engine $engine --solve articulated
done
seed=0
while [ $((seed += 1)) -le 4 ]; do
    python3 "$tests/tools/chain_tree.py" $seed 7 >"$model"
    for recovery in closed newton; do
        check "tree $seed, $recovery: reference" agrees 5 --reactions --engine tape --solve articulated --recovery $recovery
    done
done
check "tree, lanes: reference" agrees 5 --reactions --engine cc --cflags -O0 --lanes 4 --solve articulated

# kinetic and potential energy, 0 at first and some 80 J later, are 0 together
keeps_energy() {
    awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) place[$i] = i; next }
        { kinetic = $place["energy.kinetic [J]"]; sum = kinetic + $place["energy.potential [J]"] }
        sum > 1e-6 || sum < -1e-6 { bad = 1 }
        END { exit !(!bad && NR > 10 && kinetic > 10) }' "$1"
}
sh "$tests/lib/chain.sh" 20 planar fixed >"$model"
printf 'gicscene: 1\nduration: 0.3\nstep: 0.0005\nintegrator: rk4\noutput_step: 0.01\n' >"$work/swing.scene"
for engine in tape tcc; do
    run --engine $engine "$model" "$work/swing.scene" -o "$work/motion.csv"
    check "a chain of 20 swings, $engine" exits 0
    cp "$work/motion.csv" "$work/out" 2>/dev/null
    check "and keeps its energy, $engine" keeps_energy "$work/motion.csv"
done

# operations LINKS: of one right-hand side; size: of the C
operations() {
    sh "$tests/lib/chain.sh" "$1" planar fixed >"$model"
    "$gicgen" "$model" -o "$work/c.c" 2>"$work/err" &&
        awk '/all together/ { print $4 + $5 + $6 + $7 + $8 }' "$work/c.c"
}
ten=$(operations 20) twenty=$(operations 40) forty=$(operations 80)
small=$(wc -c <"$work/c.c")
check "operations grow linearly: $ten $twenty $forty" \
    [ "$((forty - twenty))" -le "$((2 * (twenty - ten) + (twenty - ten) / 50))" ]
check "and there are some" [ "$ten" -gt 1000 ]

sh "$tests/lib/chain.sh" 100 spatial free >"$model"
# shellcheck disable=SC3045
check "100 links in 300 MB" sh -c "ulimit -v 300000 && exec '$gicgen' '$model' -o '$work/c.c' 2>'$work/err'"
check "and in C that grows linearly" [ "$(wc -c <"$work/c.c")" -lt "$((2 * small))" ]
check "which nobody needs to be warned of" [ ! -s "$work/err" ]
sh "$tests/lib/chain.sh" 40 spatial free >"$model"
"$gicgen" --solve reduced "$model" -o "$work/c.c" 2>"$work/err"
verdict $? "40 links in the reduced form"
check "are told beforehand" says "note: model 'chain' is large, with [0-9]* numbers .* about [0-9]* s, [0-9]* MB of memory"

# the form with fewer operations: counted, or known to be
sh "$tests/lib/chain.sh" 3 planar fixed >"$model"
"$gicgen" "$model" -o - >"$work/out" 2>"$work/err"
check "a short chain is reduced" prints "in the reduced form"
sh "$tests/lib/chain.sh" 20 planar fixed >"$model"
"$gicgen" "$model" -o - >"$work/out" 2>"$work/err"
check "a long one articulated" prints "in the articulated form"
sed 's/link_2: {mass: 1,/link_2: {mass: 0.00001,/' "$model" >"$work/light.veh"
"$gicgen" --solve articulated "$work/light.veh" -o - >"$work/out" 2>"$work/err"
check "masses that differ by more are refused" [ $? -eq 1 ]
check "with the reason" says "more than 10000 times the mass"
printf 'gicgen: 1\nmodel: one\nbase: ground\nbodies:\n  rod: {mass: 1, com: [0.5, 0, 0], inertia: [1, 1, 1]}\njoints:\n%s\n%s\n%s\n' \
    '  pin: {type: revolute, bodies: [ground, rod], point: [0, 0, 0], axis: [0, 1, 0]}' 'coordinates:' \
    '  turn: {type: angle, bodies: [ground, rod], axis: [0, 1, 0], range: [-1, 1]}' >"$work/one.veh"
"$gicgen" --solve articulated "$work/one.veh" -o - >"$work/out" 2>"$work/err"
check "the form is for chains" says "needs a chain"
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
