#!/bin/sh
# SPDX-License-Identifier: MIT
# test_one_sided.sh GICGEN GICRUN: code for a scene computes one side for both only where both have the same formulas.
#
# Vehicles whose sides differ where a run at rest, at time 0 or at small numbers does not show it: late, beyond a
# threshold, in a last digit. They are judged by the interpreted engine gic, which computes both sides.
gicgen=$1
gicrun=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
. "$root/tests/lib/checking.sh"
models=$root/models

# vehicle BASE TEXT: a model that includes BASE
vehicle() { printf 'gicgen: 1\nmodel: sided\ninclude: %s/%s.veh\n%s\n' "$models" "$1" "$2" >"$work/sided.veh"; }

# scene TEXT [STEP]
scene() { printf 'gicscene: 1\nstep: %s\noutput_step: 0.05\n%s\n' "${2-0.005}" "$1" >"$work/sided.scene"; }

# account: what is said of one side for both, in a comment whose long lines are broken
account() {
    "$gicgen" --scene "$work/sided.scene" "$work/sided.veh" -o - 2>&1 | sed 's/^ \* *//' | tr '\n' ' ' |
        sed -n 's/.*one side for both *[0-9]* *[0-9]* *//p'
}
refuses() { account | grep -q "^refused: $1"; }
takes() { account | grep -q '^model, initial state, inputs and road are the same'; }

# agrees TOLERANCE FILE FILE: the same columns and, within the tolerance times 1 + the largest of a column, the same numbers
agrees() {
    awk -F, -v tolerance="$1" 'FNR == 1 { if (NR == 1) head = $0; else if ($0 != head) bad = 1; next }
        NR == FNR { for (i = 1; i <= NF; ++i) { a[FNR, i] = $i; s = $i < 0 ? -$i : $i; if (s > m[i]) m[i] = s }; rows = FNR; next }
        { for (i = 1; i <= NF; ++i) { d = a[FNR, i] - $i; if (d < 0) d = -d; if (!(d <= tolerance * (1 + m[i]))) bad = 1 }; other = FNR }
        END { exit bad || rows < 5 || rows != other }' "$2" "$3"
}

# turns: the vehicle leaves its straight line by more than rounding does; columns chassis_attitude.roll and .yaw
turns() {
    awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /attitude.(roll|yaw)/) c[i]; next }
        { for (i in c) { d = $i < 0 ? -$i : $i; if (d > most) most = d } } END { exit !(most > 1e-7) }' "$1"
}

# right NAME: code for the scene does what gic does
right() {
    run --engine gic "$work/sided.veh" "$work/sided.scene" -o "$work/gic"
    check "$1: gic" exits 0
    run --engine tcc "$work/sided.veh" "$work/sided.scene" -o "$work/code"
    check "$1: code for the scene" exits 0
    check "$1: as gic" agrees 1e-7 "$work/gic" "$work/code"
}

# uneven NAME WHY: both sides are computed, and they differ
uneven() {
    check "$1: both sides" refuses "$2"
    right "$1"
    check "$1: it turns" turns "$work/gic"
}

# even NAME: one side is
even() {
    check "$1: one side" takes
    right "$1"
}

seen='outputs: [chassis, chassis_attitude, spring_f_l, spring_f_r]'
wheel='body: wheel_f_r, center: centre_f_r, tire: all, spin_inertia: 7.78782'

# ---- late, and beyond thresholds -----------------------------------------------------------------------------------

braking="duration: 1.6
integrator: ab3
ratio: 5
initial: {speed: 10}
inputs: {brake: 0.3, selector: 0}
$seen"
scene "$braking"
vehicle hmmwv_vehicle "wheels: {tire_f_r: {$wheel, brake: '4000 * brake * if(time > 1.2, 0, 1)'}}"
uneven "a brake that fails" "torques on wheels 'tire_f_l' and 'tire_f_r'"
vehicle hmmwv_vehicle "wheels: {tire_f_r: {$wheel, brake: '4000 * brake - 300 * max(0, spin - 20)'}}"
uneven "a brake that fades with the spin" "torques on wheels"
vehicle hmmwv_vehicle "wheels: {tire_f_r: {$wheel, brake: '4000 * min(brake, 0.25)'}}"
uneven "a brake that gives out" "torques on wheels"

rolling="duration: 1.6
initial: {velocity: [10, 0, 0], position: [0, 0, 0.5]}
$seen"
scene "$rolling"
vehicle hmmwv "forces: {push_r: {type: force, coordinate: spring_f_r, value: 'if(time > 1, 2000, 0)'}}"
uneven "a push" "forces are not the same on both sides: along coordinate 'spring_f_r'"
vehicle hmmwv "forces: {push_r: {type: force, coordinate: spring_f_r, value: '100000 * max(0, 0.243 - spring_f_r)'}}"
uneven "beyond a travel" "forces are not the same"
vehicle hmmwv "forces: {push_r: {type: force, coordinate: spring_f_r, value: 'if(rate(spring_f_r) > 0.05, -2000, 0)'}}"
uneven "beyond a speed" "forces are not the same"
vehicle hmmwv "forces: {gust: {type: load, body: chassis, force: [0, 'if(time > 1, 2000, 0)', 0]}}"
uneven "a gust" "forces are not the same on both sides: on body 'chassis'"
vehicle hmmwv "forces: {push_r: {type: force, coordinate: spring_f_r, value: 'late(time)'}}
tables: {late: {x: [0, 1.2, 1.3], y: [0, 0, 2000]}}"
uneven "the far end of a table" "forces are not the same"
vehicle hmmwv "forces:
  push_f_l: {type: force, coordinate: spring_f_l, value: one(time)}
  push_f_r: {type: force, coordinate: spring_f_r, value: other(time)}
tables:
  one: {x: [0, 1.2, 1.3], y: [0, 0, 2000]}
  other: {x: [0, 1.2, 1.3], y: [0, 0, 2001]}"
uneven "tables that differ in their last number" "forces are not the same"

# ---- tires, links, roads ---------------------------------------------------------------------------------------------

# a tire whose file calls it symmetric and whose coefficients are not: both sides push the same way
sed "s/^TYRESIDE.*/TYRESIDE = 'SYMMETRIC'/" "$models/tires/hmmwv_pac2002.tir" >"$work/leaning.tir"
coasting="duration: 0.6
integrator: ab3
ratio: 5
initial: {speed: 10}
$seen"
sed 's/^PVY1 = .*/PVY1 = 0.0152/' "$models/tires/hmmwv_pac2002.tir" >"$work/weak.tir"
scene "$coasting"
vehicle hmmwv_tires "tires: {all: {file: $work/leaning.tir}}"
uneven "tires that lean to one side" "tires 'tire_f_l' and 'tire_f_r'"
vehicle hmmwv_tires "tires: {weak: {file: $work/weak.tir}}
wheels: {tire_f_r: {body: wheel_f_r, center: centre_f_r, tire: weak, spin_inertia: 7.38782, drive: drive_torque / 4, brake: 4000 * brake}}"
uneven "another tire" "wheel 'tire_f_"

# the same link, hinged at its other end on one side: elsewhere as soon as the wheel moves
scene "$rolling"
vehicle hmmwv "joints: {upper_f_r: {type: revolute_spherical, bodies: [wheel_f_r, chassis], points: [upper_u_f_r, upper_c_f_r],
  axis: [0.2202992, 0.0317754, 0.0490626]}}"
uneven "a link the other way round" "joint 'upper_f_"

vehicle hmmwv ""
scene "duration: 1.6
initial: {velocity: [20, 0, 0], position: [0, 0, 0.474]}
road: {type: table, x: [0, 25, 26, 27], left: [0, 0, 0, 0], right: [0, 0, 0.01, 0]}
$seen"
uneven "a road that differs far ahead" "the road"
vehicle hmmwv_tires ""
scene "duration: 0.8
integrator: ab3
ratio: 5
initial: {speed: 20}
inputs: {brake: 0.2}
road: {type: flat, friction: {patches: [{x: [10, 20], y: [-2, 0], value: 0.5}]}}
$seen"
uneven "a patch of ice ahead" "the road"

# ---- last digits: their motion is not seen, the decision is ---------------------------------------------------------

scene "$braking"
for brake in 4000.000000000001 3999.9999999999995; do
    vehicle hmmwv_vehicle "wheels: {tire_f_r: {$wheel, brake: $brake * brake}}"
    check "a brake of $brake N m" refuses "torques on wheels"
done
vehicle hmmwv_vehicle "wheels: {tire_f_r: {body: wheel_f_r, center: centre_f_r, tire: all, spin_inertia: 7.78782000000001, brake: 4000 * brake}}"
check "spin inertia in the 15th digit" refuses "wheel 'tire_f_\|body 'wheel_f_"
vehicle hmmwv_vehicle "wheels: {tire_f_r: {$wheel, brake: 4000 * brake, windup: 0.1000000000000001}}"
check "windup in the 16th digit" refuses "wheel 'tire_f_"
# the other side's centre is 0.447711 + 0.0085, which is 6e-17 more
vehicle hmmwv_vehicle "wheels: {tire_f_r: {body: wheel_f_r, center: [1.648579, -0.909701, 0.456211], tire: all, spin_inertia: 7.78782, brake: 4000 * brake}}"
check "centre in the 17th digit" refuses "wheel 'tire_f_"
sed 's/front: {outputs: \[tire_f_l, tire_f_r\], /&split: 0.50000000000001, /' "$models/parts/hmmwv_powertrain.veh" >"$work/powertrain.veh"
sed "s|parts/hmmwv_powertrain.veh|$work/powertrain.veh|; s|parts/on|$models/parts/on|" "$models/hmmwv_vehicle.veh" >"$work/sided.veh"
check "a differential in the 14th digit" refuses "torques on wheels"
scene "$rolling"
arm='com: [-1.688965, -0.5467858, 0.414945], inertia: [0.4469, 0.4469, 0.8938], orientation: {x: [1, 0, 0], z: [0, -0.11811, 0.479425]}'
vehicle hmmwv "bodies: {lca_r_r: {mass: 23.965, $arm}}"
check "a body written out" takes
vehicle hmmwv "bodies: {lca_r_r: {mass: 23.965000000000004, $arm}}"
check "its mass in the 16th digit" refuses "body 'lca_r_"
vehicle hmmwv "forces: {spring_r_r: {type: spring_damper, coordinate: spring_r_r, stiffness: 369167.2, damping: 24780.400000000001, free: 0.3372700000000001}}"
check "a spring in the 16th digit" refuses "forces are not the same on both sides: along coordinate 'spring_r_r'"
vehicle hmmwv "parameters: {k: {value: 369167.2, tunable: true}}
forces: {spring_r_r: {type: spring_damper, coordinate: spring_r_r, stiffness: k, damping: 24780.4, free: 0.33727}}"
check "a tunable parameter with the other side's value" takes
scene "$rolling
parameters: {k: 369167.2000000001}"
check "in the 16th digit of another one" refuses "forces are not the same"
vehicle hmmwv ""
for state in 'angular_velocity: [1e-300, 0, 0]' 'rates: {spring_f_r: 1e-300}' 'rates: {rack: -1e-300}' 'orientation: {roll: 1e-300}'; do
    scene "duration: 1.6
initial: {velocity: [10, 0, 0], position: [0, 0, 0.5], $state}
$seen"
    check "$state" refuses "the \(vehicle\|initial state\)"
done
scene "duration: 1.6
initial: {velocity: [10, 1e-300, 0], position: [0, 0, 0.5]}
$seen"
check "a velocity of 1e-300" refuses "the vehicle does not move straight ahead"

# ---- one side still stands for both -----------------------------------------------------------------------------------

scene "$braking"
vehicle hmmwv_vehicle "wheels: {tire_f_l: {body: wheel_f_l, center: centre_f_l, tire: all, spin_inertia: 7.78782, brake: '4000 * brake * if(time > 1.2, 0, 1)'}}"
even "both brakes fail"
vehicle hmmwv_vehicle "wheels: {tire_f_r: {$wheel, brake: brake * 4000}}"
even "a brake written the other way round"
scene "$rolling"
vehicle hmmwv "forces:
  push_f_l: {type: force, coordinate: spring_f_l, value: one(time)}
  push_f_r: {type: force, coordinate: spring_f_r, value: other(time)}
  bar_l: {type: force, coordinate: spring_r_l, value: -40000 * (spring_r_l - spring_r_r)}
  bar_r: {type: force, coordinate: spring_r_r, value: -40000 * (spring_r_r - spring_r_l)}
  both_l: {type: load, body: chassis, point: [1, 0.5, 0.5], force: [0, 'if(time > 1, 2000, 0)', -100]}
tables:
  one: {x: [0, 1.2, 1.3], y: [0, 0, 2000]}
  other: {x: [0, 1.2, 1.3], y: [0, 0, 2000]}"
even "forces on both sides, tables of the same numbers, a bar between the sides"
vehicle hmmwv "ports: {hand: {body: wheel_f_r, point: centre_f_r}}"
even "a port on one side that nothing acts on"
# a body that hangs between the arms of both sides, one of which is not solved
vehicle hmmwv "bodies: {bar: {mass: 20, com: [1.75, 0, 0.55], inertia: [2, 1, 2]}}
joints:
  drop_l: {type: distance, bodies: [lca_f_l, bar], points: [[1.75, 0.6, 0.4], [1.75, 0.6, 0.6]]}
  side_l: {type: distance, bodies: [chassis, bar], points: [[1.55, 0.3, 0.55], [1.75, 0.3, 0.55]]}
  lift: {type: distance, bodies: [chassis, bar], points: [[1.5, 0, 0.65], [1.75, 0, 0.65]]}
  across: {type: point_in_plane, bodies: [chassis, bar], point: [1.75, 0, 0.55], axis: [0, 1, 0]}
outputs: {bar: {type: position, body: bar}}"
scene "duration: 1
initial: {velocity: [10, 0, 0], position: [0, 0, 0.5]}
road: {type: bumps, bumps: [{x: 3, length: 2, height: 0.05}]}
outputs: [chassis, bar, spring_f_l, spring_f_r]"
even "a body between the sides"
# entries in any order: of the arms the right one comes first, of the hubs that stand on them the left one
cat >"$work/sided.veh" <<'END'
gicgen: 1
model: sided
gravity: [0, 0, -9.81]
base: chassis
bodies:
  chassis: {mass: 1000, com: [0, 0, 0.7], inertia: [400, 1200, 1400]}
  front_r: {mass: 50, com: [1.6, -0.75, 0.42], inertia: [2, 3, 2]}
  hub_l: {mass: 30, com: [1.5, 0.9, 0.45], inertia: [1, 1.5, 1]}
  front_l: {mass: 50, com: [1.6, 0.75, 0.42], inertia: [2, 3, 2]}
  rear_l: {mass: 50, com: [-1.4, 0.75, 0.42], inertia: [2, 3, 2]}
joints:
  front_l: {type: revolute, bodies: [chassis, front_l], point: [2, 0.6, 0.5], axis: [0, 1, 0]}
  front_r: {type: revolute, bodies: [chassis, front_r], point: [2, -0.6, 0.5], axis: [0, -1, 0]}
  hub_l: {type: revolute, bodies: [front_l, hub_l], point: [1.5, 0.85, 0.35], axis: [1, 0, 0]}
  link_l: {type: distance, bodies: [chassis, hub_l], points: [[1.5, 0.45, 0.7], [1.5, 0.85, 0.65]]}
  rear_l: {type: revolute, bodies: [chassis, rear_l], point: [-1, 0.6, 0.5], axis: [0, 1, 0]}
coordinates:
  front_l: {type: angle, bodies: [chassis, front_l], axis: [0, 1, 0], range: [-0.4, 0.4]}
  rear_l: {type: angle, bodies: [chassis, rear_l], axis: [0, 1, 0]}
forces:
  front_l: {type: spring_damper, coordinate: front_l, stiffness: 30000, damping: 800}
  rear_l: {type: spring_damper, coordinate: rear_l, stiffness: 30000, damping: 800}
wheels:
  wheel_f_l: {body: hub_l, center: [1.5, 1, 0.4], radius: 0.45, stiffness: 250000, damping: 500}
  wheel_r_l: {body: rear_l, center: [-1.5, 1, 0.4], radius: 0.45, stiffness: 250000, damping: 500}
outputs:
  chassis: {type: position, body: chassis}
  hub_l: {type: position, body: hub_l}
  hub_r: {type: position, body: hub_r}
END
scene "duration: 1
initial: {velocity: [8, 0, 0], position: [0, 0, 0.7]}
road: {type: bumps, bumps: [{x: 3, length: 2, height: 0.04}]}" 0.001
even "entries in another order"
sed "s/^TYRESIDE.*/TYRESIDE = 'SYMMETRIC'/
    s/^\(PHY1\|PHY2\|PVY1\|PVY2\|PEY3\|RBY3\|RVY1\|RVY2\|RHX1\|QHZ1\|QHZ2\|QDZ3\|QDZ6\|QDZ7\|QBZ4\|QEZ4\|QSX1\|SSZ1\) = .*/\1 = 0/" \
    "$models/tires/hmmwv_pac2002.tir" >"$work/symmetric.tir"
scene "$coasting"
vehicle hmmwv_tires "tires: {all: {file: $work/symmetric.tir}}"
even "a symmetric tire"

# the models that come along, in their own scenes and in a jump
for case in hmmwv:tires_jump hmmwv14:tires_jump five_link:tires_jump hmmwv_full:hmmwv_full trailing_arm:trailing_arm \
    hmmwv_tires:tires_brake hmmwv_tmeasy:tires_brake hmmwv_tires:tires_park hmmwv_vehicle:straight hmmwv_vehicle:cruise \
    hmmwv_vehicle:coasting hmmwv_vehicle:parked hmmwv_vehicle:acceleration_braking; do
    "$gicgen" --scene "$models/scenes/${case#*:}.scene" "$models/${case%:*}.veh" -o "$work/code.c"
    sed 's/^ \* *//' "$work/code.c" | tr '\n' ' ' >"$work/code.line"
    check "$case: one side" grep -q 'one side for both .*model, initial state, inputs and road are the same' "$work/code.line"
done
vehicle hmmwv_full ""
scene "duration: 0.6
initial: {velocity: [10, 0, 0]}
road: {type: bumps, bumps: [{x: 2, length: 2, height: 0.05}]}
$seen" 0.0025
even "hmmwv_full"

# two skids on each side, on a road of the caller's own that is the same on both sides but not across
vehicle hmmwv "wheels:
  inner_l: {body: chassis, center: [0, 0.5, 0.46], radius: 0.4699, stiffness: 283000, damping: 500}
  outer_l: {body: chassis, center: [0, 1.2, 0.46], radius: 0.4699, stiffness: 283000, damping: 500}"
scene "duration: 1
initial: {position: [0, 0, 0.474]}
road: {type: bumps, bumps: [{x: 3, length: 2, height: 0.05}]}
outputs: [chassis]"
sed 's/^model: .*/model: twin/' "$work/sided.veh" >"$work/twin.veh"
sed 's/^model: .*/model: any/' "$work/sided.veh" >"$work/any.veh"
"$gicgen" --scene "$work/sided.scene" "$work/twin.veh" -o "$work/twin.c" && "$gicgen" "$work/any.veh" -o "$work/any.c" &&
    gcc -std=c99 -O1 -Wall -Wextra -Werror -I"$root/runtime" -I"$work" -o "$work/twin" "$root/tests/data/narrow/twin.c" \
        "$work/twin.c" "$work/any.c" "$root/runtime/gic_runtime.c" -lm && "$work/twin" >"$work/out"
check "twin skids on a road with a step between them" [ $? -eq 0 ]
check "one side for both there" takes

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
