#!/bin/sh
# SPDX-License-Identifier: MIT
# test_bounce_watch.sh GICRUN: runs whose bodies bounce higher than their stops let them are reported, others are not.
gicrun=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
cd "$work" || exit 1
cp "$root/tests/data/contact/drop.veh" .

check "heights of bounces against the drop height" sh -c "python3 '$root/tests/data/contact/drop.py' '$gicrun' drop.veh >said 2>&1"

scene() {
    printf 'gicscene: 1\nduration: 2\nstep: %s\nlocate: %s\n' "$1" "$2"
    printf 'initial: {coordinates: {z: 0.2}}\nparameters: {k: 10000, c: %s}\n' "$3"
}
scene 0.01 false 0 >now.scene
run -q drop.veh now.scene -o now.csv
check "100 rad/s at 10 ms by AB3 fails" exits 1
check "with element, time and factor" says "the low end of stop 'floor' gives back more than it may: at t = .* a body bounces 3.99 times"
check "and the remedy" says "remedy: take steps of at most about 0.0016 s, or .locate: true."
check "all results are there" [ "$(wc -l <now.csv)" -eq 202 ]
scene 0.0016 false 0 >now.scene
run -q drop.veh now.scene -o now.csv
check "the step that it tells is quiet" exits 0
scene 0.0016 true 0 >now.scene
run -q drop.veh now.scene -o now.csv
check "so are contacts that are located" exits 0
scene 0.01 false 100 >now.scene
run -q drop.veh now.scene -o now.csv
check "a stop with a damper at 10 ms fails too" exits 1
for method in ab3 rk4; do
    grep -v '^ratio' "$root/models/scenes/tires_rough.scene" >rough.scene
    run -q --integrator "$method" "$root/models/hmmwv_tires.veh" rough.scene -o rough.csv
    check "a rough road is no stop: $method" sh -c "! grep -q 'gives back' err"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
