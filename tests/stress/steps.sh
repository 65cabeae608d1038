#!/bin/sh
# SPDX-License-Identifier: MIT
# steps.sh STEPS GICRUN: the longest stable steps against theory, and what is said of longer ones
#
# AB3, RK4 and dual rate, over nine decades
# of stiffness and of models; and what gicrun says of runs with longer ones: when, and which quantity grew.
steps=$1
gicrun=$(realpath "$2")
cd "$(dirname "$0")/../.." || exit 1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
found=0
models="models/quarter_car.veh models/hmmwv.veh"
[ "$STRESS" = short ] || models="$models models/trailing_arm.veh models/solid_axle.veh models/five_link.veh \
    models/hmmwv14.veh models/andrews.veh models/pendulum.veh models/hmmwv_tires.veh models/hmmwv_tmeasy.veh"
# dampers that work otherwise in compression than in rebound: theory is about models where they work as in one of them
for side in compression rebound; do
    sed "s|{file: |{file: $PWD/models/|; s|^\( *include: \)\([^{[]\)|\1$PWD/models/\2|" models/hmmwv_full.veh |
        sed "s/value: .*min(0, speed) + rebound_\(.\)(length) .*/value: \"${side}_\1(length) * speed\"}/" >"$work/$side.veh"
done
# shellcheck disable=SC2086  # a list
"$steps" "$work/mass.veh" $models --sides "$work/compression.veh" "$work/rebound.veh" models/hmmwv_full.veh || found=1

# twice the longest stable step of each method, as people write it
tried=0
refused=0
verdict=ok
while read -r model integrator step; do
    tried=$((tried + 1))
    cat >"$work/long.scene" <<END_OF_SCENE
gicscene: 1
duration: $(awk "BEGIN { print 1000 * $step }")
step: $step
output_step: $step
integrator: $integrator
END_OF_SCENE
    "$gicrun" -q --engine tcc -o "$work/out.csv" "models/$model.veh" "$work/long.scene" 2>"$work/err"
    status=$?
    if [ $status -eq 1 ] && grep -q "the run ends at t = [0-9.]* s: .*the run is unstable.*: '[a-z_.]*' is at" "$work/err" &&
        grep -q "try a shorter step" "$work/err" && ! grep -qi 'nan\|inf' "$work/out.csv"; then
        refused=$((refused + 1))
    else
        verdict="gicrun says: $(head -n 1 "$work/err")"
        found=1
    fi
done <<END
quarter_car ab3 0.024
hmmwv ab3 0.022
hmmwv rk4 0.1
trailing_arm ab3 0.024
solid_axle ab3 0.025
andrews rk4 0.015
END
echo "steps | gicrun, steps twice too long | $tried | $((tried - refused)) | $refused | named with time and quantity | $verdict"

# Beyond the limit, tires or stops keep what grows within bounds: whatever accelerations of springs are off by more than
# half, against a finer step, is to be reported or refused; and steps of 0.9 times the limit and less are not.
# drive STEP NAME: the scene at hand with that step, rows every 0.24 s in $work/NAME.csv
drive() {
    {
        printf 'gicscene: 1\nstep: %s\nintegrator: %s\n' "$1" "$integrator"
        printf 'duration: %s\noutput_step: 0.24\n' "$duration"
        [ "$ratio" -eq 1 ] || echo "ratio: $ratio"
        grep -Ev '^(gicscene|step|integrator|ratio|duration|output_step):' "models/scenes/$scene.scene"
    } >"$work/run.scene"
    "$gicrun" -q --engine tcc -o "$work/$2.csv" "models/$model.veh" "$work/run.scene" 2>"$work/err"
}
off() {
    paste -d , "$work/run.csv" "$work/fine.csv" | awk -F, 'NR == 1 {
        half = NF / 2
        for (i = 1; i <= half; ++i) if ($i ~ /^spring_.*acceleration/) column[i] = i
        next
    }
    { for (i in column) { a += ($i - $(i + half))^2; b += $(i + half)^2 } }
    END { print (sqrt(a / b) > 0.5) ? "wrong" : "right" }'
}
tried=0
good=0
told=0
verdict=ok
# model, scene, integrator, ratio, duration, longest good step in ms; how many steps 0.24 s have
while read -r model scene integrator ratio duration limit counts; do
    [ "$STRESS" = short ] && counts=$(echo "$counts" | awk '{print $1, $NF}')
    for count in $counts; do
        step=$(awk "BEGIN { printf \"%.15g\", 0.24 / $count }")
        tried=$((tried + 1))
        # a quarter, or what is well within the limit
        fine=$(awk "BEGIN { for (k = 4; $step / k > 5e-4 * $limit; k *= 2); printf \"%.15g\", $step / k }")
        drive "$fine" fine || verdict="$model, $scene: $fine s fails"
        if drive "$step" run; then
            good=$((good + 1))
            [ "$(off)" = right ] || verdict="$model, $scene, $integrator, $step s: wrong, and nothing is said"
        else
            told=$((told + 1))
            grep -Eq "is unstable.*'[a-z_.]*'( is at|, eigenvalue)" "$work/err" ||
                verdict="gicrun says: $(head -n 1 "$work/err")"
            awk "BEGIN { exit !($step > 9e-4 * $limit) }" ||
                verdict="$model, $scene, $integrator, $step s: called unstable, and is not"
        fi
    done
done <<END
hmmwv_tires tires_brake ab3 6 4.8 8.5 32 29 28 27 26 25 24 22 20 18 16
hmmwv_tmeasy tires_brake ab3 6 4.8 8.5 32 29 28 27 26 25 24 22 20 18 16
hmmwv_tires tires_park ab3 1 4.8 2.2 120 80 60 50 40 30 20
hmmwv_tires tires_park ab3 2 4.8 4.4 60 50 40 30 20
hmmwv_tires tires_park ab3 4 4.8 8.5 32 29 27 26 25 24 22 20 18
hmmwv_tires tires_park rk4 1 4.8 11.2 27 24 22 20 18 16 14 12 10 9 7
hmmwv_tmeasy tires_park rk4 1 4.8 18.5 18 16 14 10 8 7
hmmwv_tires tires_brake rk4 1 4.8 13.5 22 20 18 16 14 12
hmmwv_vehicle full_run ab3 6 7.2 8.5 32 29 28 27 26 25 24 22 20 18 16
hmmwv_vehicle acceleration_braking ab3 6 7.2 8.5 32 29 28 27 26 25 24 22 20 18 16
hmmwv_full hmmwv_full ab3 1 3.84 4.5 80 60 54 50 40 35 30 27 26 24 20
END
[ "$verdict" = ok ] || found=1
echo "steps | gicrun, kept within bounds by tires or stops | $tried | $good | $told | what is wrong is reported \
with time and quantity, steps within limits are not | $verdict"
exit $found
