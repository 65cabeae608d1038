#!/bin/sh
# SPDX-License-Identifier: MIT
# pivots.sh GICGEN GICRUN STATES REFERENCE AGREE: masses and inertias from equal ones to 1e12 times others
#
# Bodies of several models, one kind after another, are made 1e0 to 1e12 times as heavy, or as light; accelerations
# where there are any against quad precision, within the 1e-8 that FORMAT.md section 14 promises; statuses must be
# GIC_ERROR_MASS, and name a coordinate or number of the base's state with its subset or body (in the augmented form
# GIC_ERROR_SINGULAR, and the subset). A kind that is refused at one ratio in all states and accepted at a greater one is
# a finding too.
#
# Errors are those of agree, relative to the largest term of a sum.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
states=$(realpath "$3")
reference=$(realpath "$4")
agree=$(realpath "$5")
cd "$(dirname "$0")/../.." || exit 1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
found=0
if [ "$STRESS" = short ]; then
    rows=2
    powers='6 9'
else
    rows=12
    powers='0 1 2 3 4 5 6 7 8 9 10 11 12'
fi

# one MODEL BODIES FACTOR OPTIONS...: adds to $compared, $refused, $worst; $verdict where something is wrong
one() {
    model=$1 bodies=$2 factor=$3
    shift 3
    compared=0 refused=0
    if ! python3 tests/stress/scale.py "models/$model.veh" "body=$bodies:$factor" >"$work/model.veh" ||
        ! "$gicgen" --dump-model "$work/model.veh" >"$work/dump" ||
        ! "$states" "$work/dump" --count "$rows" --seed 5 -o "$work/drawn" ||
        ! "$reference" "$work/dump" "$work/drawn" -o "$work/expected" >"$work/err" 2>&1; then
        verdict="can't be compared"
        return
    fi
    "$gicrun" -q "$@" --eval "$work/drawn" "$work/model.veh" -o "$work/found" 2>"$work/err"
    if ! "$agree" "$work/dump" "$work/expected" "$work/found" --tolerance 1e-8 --refusals >"$work/out"; then
        verdict="times $factor: $(tail -n 3 "$work/out" | tr '\n' ' ')"
    fi
    compared=$(sed -n 's/.* \([0-9]*\) compared.*/\1/p' "$work/out")
    worst=$(awk -v most="$worst" '/ worst / { for (i = 1; i < NF; ++i) if ($i == "worst" && $(i + 1) + 0 > most + 0)
        most = $(i + 1) } END { print most }' "$work/out")
    # status -7 or -6, and who is meant
    refused=$(awk -F, 'NR > 1 && $0 ~ /,-7,/ && /left: .[^,]*. of (subset|body) ./ || /,-6,/ && /: subset ./ { ++n } END { print n + 0 }' \
        "$work/found")
    [ "$(awk 'END { print NR - 1 }' "$work/found")" -eq $((compared + refused)) ] ||
        verdict="times $factor: other statuses, or none named: $(tail -n 1 "$work/found" | sed 's/.*,//')"
}

# sweep MODEL BODIES SIGN WHAT OPTIONS...
sweep() {
    model=$1 bodies=$2 sign=$3 what=$4
    shift 4
    all=0 good=0 stopped=0 worst=0 verdict=ok last=none none=false
    for power in $powers; do
        one "$model" "$bodies" "1e$sign$power" "$@"
        good=$((good + compared)) stopped=$((stopped + refused)) all=$((all + rows))
        $none && [ "$compared" -gt 0 ] && verdict="accepted at 1e$sign$power again"
        [ "$compared" -gt 0 ] || none=true
        [ "$compared" -eq 0 ] || last=1e$sign$power
    done
    case $verdict in ok) verdict="ok: accepted to $last" ;; *) found=1 ;; esac
    echo "pivots | $model, $what | $all | $good | $stopped | $worst of an acceleration | $verdict"
}

sweep trailing_arm 'arm*' '' 'heavy arms' --engine tcc
sweep solid_axle axle '' 'heavy axle' --engine tcc
if [ "$STRESS" != short ]; then
    sweep trailing_arm 'arm*' '' 'heavy arms, in lanes' --engine cc --lanes 4
    sweep solid_axle axle '' 'heavy axle, interpreted' --engine tape
    # masses that differ by more are refused by gicgen (tests/system/test_pivots.sh)
    all_powers=$powers powers='0 1 2 3 4 5 6'
    sweep trailing_arm 'arm*' '' 'heavy arms, augmented' --engine tcc --solve augmented
    sweep solid_axle axle '' 'heavy axle, augmented' --engine tcc --solve augmented
    powers=$all_powers
    sweep solid_axle 'wheel*' '' 'heavy wheels' --engine tcc
    sweep trailing_arm chassis - 'light chassis' --engine tcc
    sweep trailing_arm 'wheel*' '' 'heavy wheels in front' --engine tcc
    sweep trailing_arm rack '' 'heavy rack' --engine tcc
    sweep five_link 'wheel*' '' 'heavy wheels' --engine tcc
    sweep five_link chassis - 'light chassis' --engine tcc
    sweep hmmwv chassis - 'light chassis' --engine tcc
    sweep hmmwv 'wheel*' '' 'heavy wheels, in lanes' --engine cc --lanes 4
    sweep hmmwv 'lca*' - 'light arms' --engine tcc
    sweep hmmwv rack '' 'heavy rack' --engine tcc
    sweep quarter_car carriage - 'light carriage' --engine tcc
    sweep quarter_car wheel '' 'heavy wheel' --engine tcc
    sweep andrews 'K[1-4]' '' 'heavy cranks' --engine tcc
    sweep andrews 'K[567]' '' 'heavy links' --engine tcc
fi
exit $found
