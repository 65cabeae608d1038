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
exit $found
