#!/bin/sh
# SPDX-License-Identifier: MIT
# near_singular.sh GICGEN NEAR_SINGULAR REFERENCE AGREE: suspensions driven to their limits and beyond, against gic and quad precision
#
# No state is taken whose accelerations or poses are off by more than 1e-8 of the sum of magnitudes of their terms, or of
# the model's size: quad precision starts from its poses. None is in another assembly mode than its way leads to: that is
# gone again in small pieces, by generated code and by gic. COUNT states a model and way of recovery (a million:
# COUNT=1000000 KEEP=1000), of which KEEP and half as many more are compared with the reference; MODELS instead of ours.
# Of those the largest condition number of each subset's Jacobian is left in $BUILD/stress/conditions.MODEL-WAY, the
# largest of all in the table.
gicgen=$1
near_singular=$2
reference=$3
agree=$4
conditions=$(dirname "$gicgen")/stress
mkdir -p "$conditions" || exit 1
models=$(cd "$(dirname "$0")/../../models" && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
case $STRESS in
short) count=${COUNT:-1500} keep=${KEEP:-4} names="hmmwv:newton five_link:auto quarter_car:newton" ;;
*) count=${COUNT:-100000} keep=${KEEP:-60} names="" ;;
esac
for name in hmmwv hmmwv14 hmmwv_full five_link quarter_car solid_axle trailing_arm pendulum hmmwv_tires hmmwv_tmeasy \
    hmmwv_vehicle; do
    [ "$STRESS" = short ] || names="$names $name:closed $name:newton"
done
for pair in ${MODELS:-$names}; do
    name=${pair%:*}
    way=${pair#*:}
    model=$models/$name.veh
    if "$gicgen" --dump-model "$model" >"$work/dump" &&
        "$near_singular" "$model" --recovery "$way" --count "$count" --seed 1 --keep "$keep" -o "$work/worst" >"$work/out"; then
        read -r tried taken refused doubted screened wrong lost leapt elsewhere blocked unfollowed <"$work/out"
    else
        echo "near_singular | $name $way | 0 | 0 | 0 | - | the attack itself failed"
        continue
    fi
    "$reference" "$work/dump" "$work/worst.states" --near "$work/worst.results" -o "$work/reference.csv" 2>"$work/log"
    "$agree" "$work/dump" "$work/reference.csv" "$work/worst.results" --tolerance 1e-8 --condition 1e300 --refusals \
        >"$work/agree"
    status=$?
    worst=$(sed -n 's/.* worst \([^ ]*\) in row .*/\1/p' "$work/agree" | sort -g | tail -n 1)
    unreached=$(sed -n 's/.* rows: \([0-9]*\) not reached.*/\1/p' "$work/agree")
    compared=$(sed -n 's/.*, \([0-9]*\) compared.*/\1/p' "$work/agree")
    # columns condition.SUBSET of rows that were reached
    awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if (sub(/^condition[.]/, "", $i)) name[i] = $i }
        NR > 1 && $NF == 0 { for (i in name) if ($i + 0 > most[i] + 0) most[i] = $i }
        END { for (i in name) print name[i], most[i] + 0 }' "$work/reference.csv" |
        sort -k2,2gr -k1,1 >"$conditions/conditions.$name-$way"
    verdict="ok: $compared in quad precision, gic refuses $doubted, else differs by $screened; condition"
    verdict="$verdict up to $(awk 'NR == 1 { print $2 " (" $1 ")" }' "$conditions/conditions.$name-$way")"
    [ "$blocked$unfollowed" = 00 ] ||
        verdict="$verdict; small pieces are refused on the way to $blocked, gic's to $unfollowed"
    [ "$unreached" = 0 ] || verdict="$unreached that quad precision finds nothing near"
    [ "$wrong" = 0 ] || verdict="$wrong results are no numbers"
    [ "$lost" = 0 ] || verdict="$lost refusals after which the last good state is not found again"
    [ "$leapt$elsewhere" = 00 ] || verdict="$leapt elsewhere than small pieces lead, $elsewhere than gic goes"
    [ $((3 * doubted)) -le "$taken" ] || verdict="gic refuses $doubted: too few are screened"
    # rounding next to the bound is some 1e-10 of a whole: more is another assembly mode
    awk "BEGIN { exit !($screened < 1e-6) }" || verdict="gic differs by $screened"
    [ $status -eq 0 ] || verdict="off by more than 1e-8"
    [ "${compared:-0}" -gt 0 ] || verdict="nothing compared"
    echo "near_singular | $name $way | $tried | $taken | $refused | $worst relative | $verdict"
done
