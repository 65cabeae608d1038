#!/bin/sh
# SPDX-License-Identifier: MIT
# test_random.sh RANDOM_VEHICLE GICGEN GICRUN STATES REFERENCE AGREE: accelerations, poses, reactions of all joints and
# drive forces of random vehicles against the independent reference in quad precision at random states, with the
# equations of motion in either form, and the diagnosis of random mistakes: one error, which names a culprit. VEHICLES
# (default 20) of either kind at ROWS (default 10) states, or those of SEEDS alone (SEEDS="12 40"); a full run is
# VEHICLES=300 ROWS=20. KEEP=folder: what they made is left there.
random_vehicle=$1
gicgen=$2
gicrun=$3
states=$4
reference=$5
agree=$6
rows=${ROWS:-10}
if [ -n "$KEEP" ]; then
    work=$KEEP
    mkdir -p "$work" || exit 1
else
    work=$(mktemp -d) || exit 1
    trap 'rm -rf "$work"' EXIT
fi
passed=0
failed=0

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

# agrees SEED
agrees() {
    "$random_vehicle" --seed "$1" >"$work/$1.veh" &&
        "$gicgen" --dump-model "$work/$1.veh" >"$work/$1.dump" &&
        "$states" "$work/$1.dump" --count "$rows" --seed "$1" -o "$work/$1.states" &&
        "$reference" "$work/$1.dump" "$work/$1.states" -o "$work/$1.accelerations" &&
        sh "$(dirname "$0")/reactions.sh" "$work/$1.dump" "$(realpath "$work/$1.veh")" >"$work/$1.variant.veh" || return 1
    for solve in reduced augmented; do
        echo "$solve:"
        "$gicrun" --solve $solve --engine cc --cc "sh $work/cc" --eval "$work/$1.states" "$work/$1.variant.veh" \
            -o "$work/$1.results" && "$agree" "$work/$1.dump" "$work/$1.accelerations" "$work/$1.results" --reactions ||
            return 1
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

for seed in ${SEEDS:-$(seq 1 "${VEHICLES:-20}")}; do
    agrees "$seed" >"$work/said" 2>&1
    result $? "random_vehicle --seed $seed"
    refused "$seed" >"$work/said" 2>&1
    result $? "random_vehicle --seed $seed --broken"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
