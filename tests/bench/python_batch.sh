#!/bin/sh
# SPDX-License-Identifier: MIT
# python_batch.sh LIBGIC.so [ROUNDS]: what a step of 1,024 vehicles by Python takes against the same steps in C, one after
# another and in lanes: seconds by Python and in C, and the quotient (batch_cost.py).
library=$(realpath "$1")
rounds=${2:-60}
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cc -O2 -shared -fPIC -I"$root/runtime" -o "$work/steps.so" "$root/tests/bench/batch_steps.c" "$library" || exit 1
for run in 'quarter_car quarter_car 1' 'quarter_car quarter_car 4' 'hmmwv paper_run 4'; do
    read -r model scene lanes <<END
$run
END
    printf '%s, lanes %s: ' "$model" "$lanes"
    GICGEN_LIBRARY=$library PYTHONPATH=$root/runtime/python /usr/bin/python3 "$root/tests/bench/batch_cost.py" "$work/steps.so" \
        "$root/models/$model.veh" "$root/models/scenes/$scene.scene" 1024 "$lanes" 0.001 "$rounds" || exit 1
done
