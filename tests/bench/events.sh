#!/bin/sh
# SPDX-License-Identifier: MIT
# events.sh BUILD [SCENE...]: where the errors of scenes with events come from (models/EVENTS.md). For each scene:
# the largest error of the chassis position over the whole run with the scene's step, its half and its quarter, against
# a sixteenth; then what build/check/event_errors says.
set -e
build=${1:-build}
[ $# -eq 0 ] || shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
[ $# -gt 0 ] || set -- full_run acceleration_braking tires_rough tires_jump lane_change step_steer tires_brake

model_of() {
    case $1 in
    tires_*) echo models/hmmwv_tires.veh ;;
    *) echo models/hmmwv_vehicle.veh ;;
    esac
}
value_of() { sed -n "s/^$1: *\([0-9.e-]*\).*/\1/p" "models/scenes/$2.scene"; }

# The scene with a part of its step; the driver's period, output times and road files stay.
with_step() { # SCENE DIVISOR
    step=$(value_of step "$1")
    output=$(value_of output_step "$1")
    new=$(awk -v s="$step" -v d="$2" 'BEGIN {printf "%.12g", s / d}')
    sed "s/^step:.*/step: $new/; s/^output_step:.*/output_step: ${output:-$step}/" "models/scenes/$1.scene" >"$work/$1_$2.scene"
    "$build/gicrun" -q "$(model_of "$1")" "$work/$1_$2.scene" -o "$work/$1_$2.csv"
}

# The largest distance of chassis positions between two results.
apart() {
    paste -d, "$1" "$2" | awk -F, 'NR == 1 {for (i = 1; i <= NF; ++i) {if ($i == "chassis.x [m]") if (a) b = i; else a = i}}
        NR > 1 {d = sqrt(($a - $b)^2 + ($(a + 1) - $(b + 1))^2 + ($(a + 2) - $(b + 2))^2); if (d > most) most = d}
        END {printf "%.3g", most}'
}

for scene; do
    for part in 1 2 4 16; do
        with_step "$scene" $part
    done
    echo "$scene, step $(value_of step "$scene") s: whole run $(apart "$work/${scene}_1.csv" "$work/${scene}_16.csv") m," \
        "half $(apart "$work/${scene}_2.csv" "$work/${scene}_16.csv"), quarter $(apart "$work/${scene}_4.csv" "$work/${scene}_16.csv")"
    "$build/check/event_errors" "$(model_of "$scene")" "models/scenes/$scene.scene"
done
