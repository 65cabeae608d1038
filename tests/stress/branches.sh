#!/bin/sh
# SPDX-License-Identifier: MIT
# branches.sh BRANCHES PASSAGE RANDOM_VEHICLE: random walks that must never leap to another assembly mode, nor leave a trace where they are refused
#
# COUNT steps a model and way of recovery (a million steps: COUNT=1000000), of ours and of VEHICLES random mechanisms;
# and runs towards a singular configuration in steps that are longer than its margin.
branches=$1
passage=$2
random_vehicle=$3
models=$(cd "$(dirname "$0")/../../models" && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
case $STRESS in
short) count=${COUNT:-3000} vehicles=${VEHICLES:-2} names="hmmwv five_link quarter_car solid_axle" ;;
*) count=${COUNT:-100000} vehicles=${VEHICLES:-40} names="hmmwv hmmwv14 five_link quarter_car solid_axle trailing_arm pendulum" ;;
esac

# walk LABEL MODEL STEPS
walk() {
    for way in newton closed; do
        if "$branches" "$2" --recovery $way --count "$3" --seed 1 >"$work/out"; then
            read -r tried taken refused blocked leapt traces largest <"$work/out"
            verdict=ok
            [ "$blocked" = 0 ] || verdict="ok: $blocked not reached in small pieces"
            [ "$traces" = 0 ] || verdict="$traces refusals left a trace"
            [ "$leapt" = 0 ] || verdict="$leapt leaps to another assembly mode"
            echo "branches | $1 $way | $tried | $taken | $refused | $largest m apart | $verdict"
        else
            echo "branches | $1 $way | 0 | 0 | 0 | - | the attack itself failed"
        fi
    done
}

for name in $names; do
    walk "$name" "$models/$name.veh" "$count"
done
# Newton's iteration alone, thousands of pieces a step: all its angles go round
[ "$STRESS" = short ] || walk andrews "$models/andrews.veh" $((count / 20))
for seed in $(seq 1 "$vehicles"); do
    "$random_vehicle" --seed "$seed" >"$work/random.veh" && walk "random vehicle $seed" "$work/random.veh" $((count / 10))
done
for way in newton closed; do
    if "$passage" --recovery $way --count $((count / 10)) --seed 1 >"$work/out"; then
        read -r tried ended passed left <"$work/out"
        verdict=ok
        [ "$passed" = 0 ] || verdict="$passed runs turned back where they should have ended"
        echo "branches | passage $way | $tried | 0 | $ended | $left steps early | $verdict"
    else
        echo "branches | passage $way | 0 | 0 | 0 | - | the attack itself failed"
    fi
done
