#!/bin/sh
# SPDX-License-Identifier: MIT
# entry_points.sh ENTRY ENTRY_BATCH: NaN, infinities, denormals, zero, negative and huge numbers into every function
#
# Of generated code, for one vehicle and in lanes: a status that leaves everything as it was, or finite results. In
# full also optimized code, interpreted engines and more models in lanes.
entry=$1
entry_batch=$2
cd "$(dirname "$0")/../.." || exit 1
engines=tcc
lanes=models/quarter_car.veh
[ "$STRESS" = short ] || engines="tcc cc tape gic" lanes="$lanes models/hmmwv.veh models/five_link.veh tests/tuning/car.veh"
found=0
for engine in $engines; do
    for model in models/*.veh tests/tuning/car.veh tests/tuning/hand.veh tests/laws/cart.veh tests/powertrain/rig.veh; do
        "$entry" "$engine" "$model" || found=1
    done
done
for model in $lanes; do
    "$entry_batch" "$model" || found=1
done
exit $found
