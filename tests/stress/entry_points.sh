#!/bin/sh
# SPDX-License-Identifier: MIT
# entry_points.sh ENTRY: NaN, infinities, denormals, zero, negative and huge numbers into every function of generated
# code: a status that leaves everything as it was, or finite results. In full also optimized code and interpreted engines.
entry=$1
cd "$(dirname "$0")/../.." || exit 1
engines=tcc
[ "$STRESS" = short ] || engines="tcc cc tape gic"
found=0
for engine in $engines; do
    for model in models/*.veh tests/tuning/car.veh tests/tuning/hand.veh tests/laws/cart.veh tests/powertrain/rig.veh; do
        "$entry" "$engine" "$model" || found=1
    done
done
exit $found
