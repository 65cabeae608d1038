#!/bin/sh
# SPDX-License-Identifier: MIT
# test_control_models.sh GICGEN GICRUN STATES AGREE REFERENCE_LONG: models/controllers with their scenes: each control does what
# it is for, against the same run with it switched off; general code and the tape have the same digits; and with random held
# values accelerations, reactions and wheels are those of the independent reference.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
states=$(realpath "$3")
agree=$(realpath "$4")
reference_long=$(realpath "$5")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1
folder=$root/models/controllers

# both NAME SWITCH: on.csv and off.csv
both() {
    for state in 1 0; do
        sed "s/^inputs:/inputs:\\n  $2: $state/" "$folder/$1.scene" >$state.scene
        "$gicrun" -q "$folder/$1.veh" $state.scene -o $state.csv 2>err
        verdict $? "$1, $2: $state"
    done
    mv 1.csv on.csv
    mv 0.csv off.csv
}
# columns FILE NAME...: times and these columns
columns() {
    file=$1
    shift
    awk -F, -v names="$*" 'BEGIN { n = split(names, name, " ") }
        NR == 1 { for (i = 1; i <= NF; ++i) for (k = 1; k <= n; ++k) if (index($i, name[k] " ") == 1) at[k] = i; next }
        { printf "%s", $1; for (k = 1; k <= n; ++k) printf " %s", $at[k]; print "" }' "$file"
}
# alike NAME DURATION: general code and the tape have the same digits
alike() {
    sed "s/^duration: .*/duration: $2/; /^until/d; /^plot/,\$d" "$folder/$1.scene" >short.scene
    "$gicrun" -q --general "$folder/$1.veh" short.scene -o general.csv 2>err &&
        "$gicrun" -q --engine tape "$folder/$1.veh" short.scene -o tape.csv 2>err && cmp general.csv tape.csv >said
    verdict $? "$1: general code and tape"
}

# ---- ABS: stops shorter, wheels turn on
both abs abs_on
for state in on off; do
    columns $state.csv ahead.x lag_f_l lag_r_l chassis.x | awk '$2 > 5 && $1 > 1 { if ($3 > most) most = $3; if ($4 > most) most = $4
            if (least == "" || $3 < least) least = $3 } { x = $5 } END { print x, most, least }' >$state
done
awk '{ if (NR == 1) { on = $1; slip = $2 } else { off = $1; locked = $3 } }
    END { exit !(NR == 2 && on > 30 && on < 0.8 * off && slip < 0.3 && locked > 0.99) }' on off
verdict $? "stops after $(cut -d' ' -f1 on) m with the largest slip $(cut -d' ' -f2 on), locked after $(cut -d' ' -f1 off) m"
alike abs 1.5

# ---- active damper: the body moves half as much near its own frequency
both skyhook skyhook
for state in on off; do
    columns $state.csv body.z | awk '$1 > 3 { s += $2^2; ++n } END { print sqrt(s / n) }' >$state
done
[ -s on ] && awk 'NR == 1 { on = $1 } NR == 2 { off = $1 } END { exit !(on > 0 && on < 0.5 * off) }' on off
verdict $? "body's velocity, m/s rms: $(cat on) with, $(cat off) without"
alike skyhook 2

# ---- ESC: sideslip stays small where the vehicle spins without it
both esc esc_on
for state in on off; do
    columns $state.csv ahead.x ahead.y | awk '{ b = atan2($3, $2) * 57.29578; if (b < 0) b = -b; if (b > most) most = b } END { print most }' >$state
done
awk 'NR == 1 { on = $1 } NR == 2 { off = $1 } END { exit !(on > 0 && on < 10 && off > 45) }' on off
verdict $? "largest sideslip, degrees: $(cat on) with, $(cat off) without"
alike esc 2.5

# ---- the reference
for model in abs skyhook esc; do
    file=$folder/$model.veh
    { "$gicgen" --dump-model "$file" >dump && sh "$root/tests/lib/reactions.sh" dump "$file" && sh "$root/tests/lib/wheels.sh" dump; } >variant.veh 2>err
    "$states" dump --count 40 --seed 1 -o states 2>err && "$reference_long" dump states -o accelerations 2>err &&
        "$gicrun" --engine tape --eval states variant.veh -o results 2>err &&
        "$agree" dump accelerations results --reactions --wheels --tolerance 2e-12 >said 2>&1
    verdict $? "$model: the reference"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
