#!/bin/sh
# SPDX-License-Identifier: MIT
# test_gradient_events.sh GICRUN: gradients of runs in which conditions become true (tests/vehicle/gradient_events.py), and what of them has none.
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
models=$root/models
/usr/bin/python3 -B "$root/tests/vehicle/gradient_events.py" "$gicrun" "$models" "$work" >"$work/said" 2>&1
verdict $? "gradients of runs with conditions"
tail -n 1 "$work/said"

# ---- what is refused
rm -f "$work"/no.*
ends() { exits 1 && says "$1" && [ ! -e "$work/no.csv" ]; }
ball=$work/ball.veh # which gradient_events.py left
printf 'time [s],ball.x [m]\n1,0.4\n2,0.1\n' >"$work/m.csv"
printf 'gicscene: 1\nduration: 2\nstep: 0.01\nuntil: "x > 1"\n' >"$work/bad.scene"
run --identify "$work/m.csv" "$ball" "$work/bad.scene" initial/x
check 'conditions are no part of what is identified' ends 'a run in which conditions change the run'
sed 's/^duration: .*/duration: 0.5\nwhen: [{if: "time > 0.2", target: 5}]/; s/^equilibrium.*//' "$models/scenes/lane_change.scene" >"$work/target.scene"
run --gradient chassis.x "$models/hmmwv_vehicle.veh" "$work/target.scene" initial/x.rate -o "$work/no.csv"
check 'a target that begins' ends 'a `target` of the driver that begins as a condition becomes true at t = 0.2'
for until in 'flag > 0' '2 * if(x.value > hi, 1, -1)' 'x.value > if(x.rate > 1.5, 0, 9)'; do
    printf 'gicscene: 1\nduration: 3\nstep: 0.01\nparameters: {hi: 1.496}\ninitial: {rates: {x: 1}}\nuntil: "%s"\n' "$until" >"$work/jump.scene"
    run --gradient time "$work/cart.veh" "$work/jump.scene" -o "$work/no.csv"
    check "a condition that jumps: $until" ends 'a condition whose `if` jumps, and not between comparisons, at t = '
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
