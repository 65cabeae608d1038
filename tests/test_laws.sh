#!/bin/sh
# SPDX-License-Identifier: MIT
# test_laws.sh GICGEN GICRUN STATES REFERENCE AGREE: formulas, tables, parameters, loads and ports. Accelerations against the
# reference, which evaluates the dumped formulas in quad precision; tunable parameters and ports against the same numbers
# written into the model; a scene's parameters against a model with other values.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
states=$(realpath "$3")
reference=$(realpath "$4")
agree=$(realpath "$5")
root=$(cd "$(dirname "$0")/.." && pwd)
# shellcheck source=tests/checking.sh
. "$(dirname "$0")/checking.sh"
cd "$work" || exit 1

cart=$root/tests/laws/cart.veh
"$gicgen" --dump-model "$cart" >dump && "$states" dump --count 50 --seed 4 -o states.csv &&
    "$reference" dump states.csv -o accelerations.csv && "$gicrun" --eval states.csv "$cart" -o results.csv &&
    "$agree" dump accelerations.csv results.csv
verdict $? "accelerations"

# the port's numbers as a load, the tunable parameters' other values baked in
sed 's/^model: .*/model: tuned/; s/value: 4000/value: 5000/; s/value: 25,/value: -8,/; s/, tunable: true//
    s/^ports:/  hook: {type: load, body: arm_r, point: [0.5, -0.6, 0.25], in: mast, force: [11, -7, 30], torque: [2, 0.5, -3]}\nports:/' \
    "$cart" >tuned.veh
"$gicgen" "$cart" -o cart.c && "$gicgen" tuned.veh -o tuned.c &&
    cc -std=c99 -O1 -ffp-contract=off -I. -I"$root/runtime" "$root/tests/laws/ports.c" cart.c tuned.c "$root/runtime/gic_runtime.c" \
        -lm -o ports && ./ports
verdict $? "ports and tunable parameters"

# a scene's parameter is the model's with that value: the same run to rounding
scene='gicscene: 1
duration: 0.5
step: 0.005
integrator: rk4
output_step: 0.5'
echo "$scene" >plain.scene
printf '%s\nparameters: {k: 5500}\n' "$scene" >tuned.scene
sed 's/value: 4000/value: 5500/' "$cart" >stiff.veh
"$gicrun" --quiet stiff.veh plain.scene -o plain.csv && "$gicrun" --quiet "$cart" tuned.scene -o tuned.csv &&
    [ "$(tail -n 1 plain.csv)" = "$(tail -n 1 tuned.csv)" ]
verdict $? "parameters of a scene"
"$gicrun" --quiet "$cart" plain.scene -o soft.csv && [ "$(tail -n 1 plain.csv)" != "$(tail -n 1 soft.csv)" ]
verdict $? "a parameter changes the run"
printf '%s\nparameters: {half: 1}\n' "$scene" >fixed.scene
"$gicrun" --quiet "$cart" fixed.scene -o fixed.csv 2>message
[ $? -eq 1 ] && grep -q "fixed.scene:6:14: error: parameter 'half' is fixed" message && [ ! -e fixed.csv ]
verdict $? "a parameter that is not tunable: $(cat message)"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
