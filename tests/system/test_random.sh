#!/bin/sh
# SPDX-License-Identifier: MIT
# test_random.sh RANDOM_VEHICLE GICGEN GICRUN STATES REFERENCE AGREE COMPARE_DUMP: random vehicles with everything that
# the format has against the independent reference in quad precision at random states: accelerations, poses, reactions of
# all joints, drive forces, wheels, tires, powertrains, energies, by generated code in several ways and with the
# equations of motion in either form; what is included and mirrored against the same vehicle written out; and the
# diagnosis of random mistakes: one error, which names a culprit. VEHICLES (default 20, and some that were once found
# wrong) of either kind at ROWS (default 10) states, or those of SEEDS alone (SEEDS="12 40"); make stress has a thousand.
# KEEP=folder: what they made is left there. The last line but one is the largest deviation, relative to the sum of
# magnitudes of all terms.
random_vehicle=$1
gicgen=$2
gicrun=$3
states=$4
reference=$5
agree=$6
compare_dump=$7
tests=$(dirname "$0")/..
rows=${ROWS:-10}
compiled=${COMPILED:-10}
if [ -n "$KEEP" ]; then
    work=$KEEP
    mkdir -p "$work" || exit 1
else
    work=$(mktemp -d) || exit 1
    trap 'rm -rf "$work"' EXIT
fi
passed=0
failed=0

GICGEN_CACHE=
export GICGEN_CACHE

# what is on trial is the formulas, which compile in a quarter of the time without optimization
echo "exec ${CC:-cc} \"\$@\" -O0" >"$work/cc"

# result STATUS LABEL: counts, and shows what was said where it failed
result() {
    if [ "$1" -eq 0 ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL $2"
        cat "$work/said"
    fi
}

# agrees SEED, to what rounding becomes where a subset is as ill-conditioned as may count: 2.2e-16 times 1e4. Most of the
# time goes into the reference and a C compiler, which therefore has one of $compiled vehicles only; libtcc takes a
# thousandth of that.
agrees() {
    "$random_vehicle" --seed "$1" --rich "$work" --tire "$tests/../models/tires/hmmwv_pac2002.tir" &&
        "$gicgen" --dump-model "$work/$1.veh" >"$work/$1.dump" &&
        "$gicgen" --dump-model "$work/$1.plain.veh" >"$work/$1.plain.dump" &&
        "$compare_dump" "$work/$1.plain.dump" "$work/$1.dump" 1 &&
        "$states" "$work/$1.dump" --count "$rows" --seed "$1" -o "$work/$1.states" &&
        "$reference" "$work/$1.dump" "$work/$1.states" -o "$work/$1.accelerations" &&
        sh "$tests/lib/reactions.sh" "$work/$1.dump" "$1.veh" >"$work/$1.variant.veh" &&
        sh "$tests/lib/wheels.sh" "$work/$1.dump" >>"$work/$1.variant.veh" || return 1
    set -- "$1" "tape" "tcc" "tcc --solve augmented --recovery newton" "tape --general --recovery closed"
    [ $(($1 % compiled)) -ne 0 ] || set -- "$@" "cc --lanes 4 --solve augmented"
    seed=$1
    shift
    for engine in "$@"; do
        echo "$engine:"
        # shellcheck disable=SC2086  # an engine with its options
        "$gicrun" --engine $engine --cc "sh $work/cc" --eval "$work/$seed.states" "$work/$seed.variant.veh" \
            -o "$work/$seed.results" &&
            "$agree" "$work/$seed.dump" "$work/$seed.accelerations" "$work/$seed.results" --reactions --wheels \
                --tolerance 2e-12 || return 1
    done
}

# refused SEED: exit status 1, one error, and among the names in its message or remedy a culprit's. The line of the file
# that is shown below the message doesn't count: it names bodies in any case.
refused() {
    "$random_vehicle" --seed "$1" --broken >"$work/$1.broken.veh" 2>"$work/culprits" || return 1
    "$gicgen" "$work/$1.broken.veh" -o "$work/broken.c" 2>"$work/message"
    status=$?
    echo "exit status $status, culprits: $(cat "$work/culprits")"
    cat "$work/message"
    [ "$status" -eq 1 ] && [ "$(grep -c ': error: ' "$work/message")" -eq 1 ] || return 1
    tr ' ' '\n' <"$work/culprits" | sed "s/.*/'&'/" >"$work/names"
    grep -E ': error: |^ *remedy: ' "$work/message" | grep -qFf "$work/names"
}

# by default with those that were once found wrong
for seed in ${SEEDS:-$(seq 1 "${VEHICLES:-20}") $([ -n "$VEHICLES" ] || echo 400 403 430 958 1097 1359 1565)}; do
    agrees "$seed" >"$work/said" 2>&1
    result $? "random_vehicle --seed $seed"
    sed -n 's/.*worst \([0-9.e+-]*\) in row.*/\1/p' "$work/said" >>"$work/worst"
    refused "$seed" >"$work/said" 2>&1
    result $? "random_vehicle --seed $seed --broken"
    [ -n "$KEEP" ] || rm -f "$work/$seed".*
done
echo "worst $(sort -g "$work/worst" | tail -n 1)"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
