#!/bin/sh
# SPDX-License-Identifier: MIT
# entry_points.sh ENTRY ENTRY_BATCH: NaN, infinities, denormals, zero, negative and huge numbers into every function
#
# Of generated code, for one vehicle, with alike parts in lanes and for many vehicles at once: a status that leaves
# everything as it was, or finite results. In full also optimized code, all interpreted engines and more models at once.
entry=$1
entry_batch=$2
cd "$(dirname "$0")/../.." || exit 1
engines=tcc
models=$(echo models/*.veh models/controllers/skyhook.veh tests/data/tuning/car.veh tests/data/tuning/hand.veh tests/data/laws/cart.veh tests/data/powertrain/rig.veh)
many=models/quarter_car.veh
# of the engines that compile or run for long, few models
some="gcp1 lanes"
implicit="models/quarter_car.veh models/hmmwv.veh models/hmmwv_tires.veh"
if [ "$STRESS" != short ]; then
    engines="tcc cc tape gic gcp1 gcp2 lanes"
    some=
    implicit=$models
    many="$many models/hmmwv.veh models/hmmwv14.veh models/five_link.veh models/solid_axle.veh models/trailing_arm.veh"
    many="$many tests/data/tuning/car.veh"
fi
found=0
for engine in $engines; do
    for model in $models; do
        "$entry" "$engine" "$model" || found=1
    done
done
for engine in $some; do
    "$entry" "$engine" models/quarter_car.veh || found=1
done
for model in $implicit; do # code of gicgen --implicit by tcc
    "$entry" implicit "$model" || found=1
done
for model in $many; do
    "$entry_batch" "$model" || found=1
done
exit $found
