#!/bin/sh
# SPDX-License-Identifier: MIT
# library_calls.sh LIBRARY_CALLS: calls of libgic in random order: closed handles, wrong sizes, NULL, NaN, huge numbers
#
# A wrong call is an error and changes nothing, a right one is none, and nothing falls, hangs or leaks; by one thread
# and by four that share a library. In full with the sanitizers, and more models, of tires and powertrain too.
calls=$1
cd "$(dirname "$0")/../.." || exit 1
# with SCENE...: models with the scenes of their names
with() { for name in "$@"; do echo "models/$name.veh=models/scenes/$name.scene"; done; }
some="$(with quarter_car pendulum) tests/data/tuning/car.veh"
some="$some models/controllers/skyhook.veh=models/controllers/skyhook.scene"
seeds=3
count=1500
if [ "$STRESS" != short ]; then
    seeds=40
    count=5000
    some="$some $(with andrews trailing_arm) tests/data/laws/cart.veh tests/data/powertrain/rig.veh"
    some="$some models/hmmwv_tires.veh=models/scenes/tires_coast.scene"
    some="$some models/controllers/abs.veh=models/controllers/abs.scene"
    build=$(dirname "$(dirname "$calls")")
    calls=$build/debug/check/library_calls
    make --no-print-directory -s BUILD="$build/debug" "$calls" CFLAGS="-O1 -g -fsanitize=address,undefined \
        -fno-sanitize-recover=all -fno-omit-frame-pointer" >&2 || exit 1
fi
# shellcheck disable=SC2086  # lists of words
"$calls" 1 $seeds $count 1 $some && "$calls" 1 $seeds $count 4 $some
