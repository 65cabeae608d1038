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
check 'an end is no part of what is identified' ends "bad.scene:4:8: error: --identify looks at all times of a run, and 'x > 1' ends it"
sed 's/^duration: .*/duration: 0.5\nwhen: [{if: "time > 0.2", target: 5}]/; s/^equilibrium.*//' "$models/scenes/lane_change.scene" >"$work/target.scene"
run --gradient chassis.x "$models/hmmwv_vehicle.veh" "$work/target.scene" initial/x.rate -o "$work/no.csv"
check 'a target that begins' ends "a \`target\` of the driver that begins with condition 'time > 0.2' at t = 0.2"
for until in 'flag > 0' '2 * if(x.value > hi, 1, -1)' 'x.value > if(x.rate > 1.5, 0, 9)'; do
    printf 'gicscene: 1\nduration: 3\nstep: 0.01\nparameters: {hi: 1.496}\ninitial: {rates: {x: 1}}\nuntil: "%s"\n' "$until" >"$work/jump.scene"
    run --gradient time "$work/cart.veh" "$work/jump.scene" -o "$work/no.csv"
    check "a condition that jumps: $until" ends "jump.scene:6:8: error: condition '.*', whose \`if\` jumps, and not between comparisons, at t = "
done
# a side that stays where both are equal: 0 is reached and not crossed, within a step and at the end of one (0.5 s, 0.05 m)
for until in 'min(x.value, 0.0503) >= 0.0503' 'min(x.value, 0.05) >= 0.05' 'not (min(x.value, 0.503) < 0.503)' 'min(0, x.value - 0.503) + 1e-25 > 0'; do
    printf 'gicscene: 1\nduration: 3\nstep: 0.01\ninitial: {rates: {x: 1}}\nuntil: "%s"\n' "$until" >"$work/graze.scene"
    run --gradient time "$work/cart.veh" "$work/graze.scene" -o "$work/no.csv"
    check "a condition that grazes: $until" ends "graze.scene:5:8: error: condition '$until', which becomes true without crossing 0, at t = "
done
printf 'gicscene: 1\nduration: 3\nstep: 0.01\ninitial: {rates: {x: 1}}\nuntil: "min(time, 1.005) >= 1.005"\n' >"$work/graze.scene"
run --gradient time "$work/cart.veh" "$work/graze.scene"
check 'whose time is known: it stays' prints '^cart: time = 1.005 at the end'
# what the model's file would refuse is refused of numbers that are looked for, too: a pendulum that swings up needs negative damping
cat >"$work/pend.veh" <<'END'
gicgen: 1
model: pend
base: ground
parameters:
  c: {value: 0.1, unit: N m s/rad, tunable: true}
bodies:
  bob: {mass: 1, com: [0, 0, -1], inertia: [0.01, 0.01, 0.01]}
joints:
  pin: {type: revolute, bodies: [ground, bob], point: [0, 0, 0], axis: [0, 1, 0]}
coordinates:
  phi: {type: angle, bodies: [ground, bob], axis: [0, 1, 0], range: [-10, 10]}
forces:
  d: {type: spring_damper, coordinate: phi, stiffness: 0, damping: c}
outputs:
  phi: {type: coordinate, coordinate: phi}
END
printf 'gicscene: 1\nduration: 2\nstep: 0.01\ninitial: {coordinates: {phi: 0.5}}\n' >"$work/pend.scene"
run --optimize 'abs(phi.value) - 2' "$work/pend.veh" "$work/pend.scene" parameter/c=-5:5 -o "$work/found.csv"
allowed() { awk -F, '$1 == "parameter/c" { found = 1; exit !($3 >= 0) } END { exit !found }' "$work/found.csv"; }
check 'an optimum that the model refuses is none' allowed
run --gradient phi.value "$work/pend.veh" "$work/pend.scene" parameter/c=-1 -o "$work/no.csv"
impossible() { exits 2 && says 'with these parameters the model is impossible: damping' && [ ! -e "$work/no.csv" ]; }
check 'nor has it a gradient' impossible
awk 'BEGIN { print "time [s],phi.value [rad]"; for (t = 0; t < 2; t += 0.1) print t "," 0.5 * exp(0.5 * t) * cos(3.13 * t) }' >"$work/up.csv"
run --identify "$work/up.csv" "$work/pend.veh" "$work/pend.scene" parameter/c -o "$work/no.csv"
check 'nor is it identified' ends 'these measurements lead out of what the model allows: damping\|the least sum of squares was not found'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
