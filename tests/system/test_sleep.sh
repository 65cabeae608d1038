#!/bin/sh
# SPDX-License-Identifier: MIT
# test_sleep.sh GICRUN: what a scene allows to leave out (SCENE.md section 9): a vehicle at rest sleeps and wakes by the
# first change of an input, results differ by no more than is said; the summary's counts hang together; what can't be is
# refused.
gicrun=$1
models=$(cd "$(dirname "$0")/../../models" && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

# count NAME: of the summary's line that begins so, 0 where there is none
count() {
    sed -n "s/^  $1  *\([0-9]*\).*/\1/p" "$work/err" | grep . || echo 0
}

# within LOW VALUE HIGH
within() {
    awk "BEGIN {exit !($1 <= $2 && $2 <= $3)}"
}

# gap A B [FROM TO]: largest difference of two results of the same columns in that time
gap() {
    paste -d , "$work/$1.csv" "$work/$2.csv" | awk -F, -v from="${3:-0}" -v to="${4:-1e9}" 'NR > 1 && $1 >= from && $1 <= to {
        for (i = 1; i <= NF / 2; ++i) {
            d = $i - $(i + NF / 2)
            if (d < 0) d = -d
            if (!(d <= most)) most = d
        }
    } END {printf "%.3e\n", most}'
}

# value NAME COLUMN ROW: a cell of a result
cell() {
    awk -F, -v column="$2" -v row="$3" 'NR == row + 1 {print $column}' "$work/$1.csv"
}

# scene NAME MORE: a minute's stand on a slope, shortened; the brake lets go at 2 s
scene() {
    cat >"$work/$1.scene" <<XXX
gicscene: 1
duration: 3
step: 0.004
ratio: 2
output_step: 0.02
initial: {equilibrium: true}
road: {type: slope, x: 0.05}
inputs: {brake: {knots: {times: [2, 2.3], values: [1, 0]}}}
outputs: [chassis, input.brake]
$2
XXX
}

scene awake ''
scene asleep 'sleep: {within: 1e-6, after: 0.5}'
run --engine tape "$models/hmmwv_tires.veh" "$work/awake.scene" -o "$work/awake.csv"
check 'without sleep' exits 0
check 'nothing is said of sleep' [ "$(count 'steps asleep')" = 0 ]
run --engine tape "$models/hmmwv_tires.veh" "$work/asleep.scene" -o "$work/asleep.csv"
check 'with sleep' exits 0
asleep=$(count 'steps asleep') rhs=$(count 'right-hand sides')
# it begins at rest: (2 - 0.5) s of 4 ms, and no more; a knot at 2 s makes the brake move in the step after it
check "it sleeps from half a second on until the brake lets go ($asleep)" within 374 "$asleep" 376
# two starts of two steps of RK4 in halves take 17 right-hand sides each, in place of two
check "it does nothing meanwhile ($rhs)" within 1 "$rhs" $((750 - asleep + 30))
check "it starts anew when it wakes ($rhs)" within $((750 - asleep + 15)) "$rhs" 750
# what was within 1e-6 of rest for half a second stays within that
check "asleep it is where it would be ($(gap awake asleep 0 2))" within 0 "$(gap awake asleep 0 2)" 2e-6
# after that both roll: what differed by 1e-6 m/s and less at the beginning differs by some of that
check "awake it goes on as it would ($(gap awake asleep 2 3))" within 0 "$(gap awake asleep 2 3)" 1e-5
rolled=$(awk "BEGIN {print $(cell asleep 2 150) - $(cell asleep 2 99)}")
check "and it does roll ($rolled m)" within -1 "$rolled" -0.05
# the first step with another input is made: in the row after it the brake has moved
check 'the input is followed while it sleeps' within 0.9 "$(cell asleep 5 102)" 0.99999

# another engine, compiled, the same steps asleep
run --engine tcc "$models/hmmwv_tires.veh" "$work/asleep.scene" -o "$work/compiled.csv"
check 'compiled code sleeps as interpreted code does' cmp -s "$work/asleep.csv" "$work/compiled.csv"
check 'and as long' [ "$(count 'steps asleep')" = "$asleep" ]
run --engine gic "$models/hmmwv_tires.veh" "$work/asleep.scene" -o "$work/gic.csv"
check "so does the paper's form, interpreted ($(gap gic asleep))" within 0 "$(gap gic asleep)" 1e-5

# parked for good: a hundredth of the right-hand sides at most
sed 's/^duration: .*/duration: 60/' "$models/scenes/parked.scene" >"$work/parked.scene"
run --engine tape "$models/hmmwv_vehicle.veh" "$work/parked.scene" -o "$work/parked.csv"
check 'parked' exits 0
check "it sleeps nearly all the time ($(count 'steps asleep'))" within 9900 "$(count 'steps asleep')" 9925
check 'time goes on' within 59.99 "$(cell parked 1 501)" 60.01
check 'outputs stay' [ "$(cell parked 2 20)" = "$(cell parked 2 500)" ]

# what moves does not sleep: a vehicle that rolls, a pendulum, a vehicle that somebody moves a little again and again
cat >"$work/roll.scene" <<XXX
gicscene: 1
duration: 1
step: 0.004
ratio: 2
initial: {speed: 5}
sleep: {within: 1e-3, after: 0.1}
XXX
run --engine tape "$models/hmmwv_tires.veh" "$work/roll.scene"
check 'a vehicle that rolls does not sleep' [ "$(count 'steps asleep')" = 0 ]
cat >"$work/swing.scene" <<XXX
gicscene: 1
duration: 5
step: 0.002
integrator: rk4
sleep: {within: 1e-2, after: 0.1}
XXX
run --engine tape "$models/pendulum.veh" "$work/swing.scene"
check 'a pendulum does not sleep' [ "$(count 'steps asleep')" = 0 ]
scene touched 'sleep: {within: 1e-3, after: 0.5}'
sed -i 's/^inputs.*/inputs: {brake: {sine: {amplitude: 0.01, frequency: 1, offset: 0.9}}}/' "$work/touched.scene"
run --engine tape "$models/hmmwv_tires.veh" "$work/touched.scene"
check 'whoever is touched does not sleep' [ "$(count 'steps asleep')" = 0 ]

# a mechanism on a fixed base sleeps too, with RK4, once it has come to rest
cat >"$work/rig.scene" <<XXX
gicscene: 1
duration: 20
step: 0.002
integrator: rk4
output_step: 0.1
sleep: {within: 1e-7, after: 0.5}
initial: {coordinates: {spring: 0.26}}
XXX
run --engine tape "$models/quarter_car.veh" "$work/rig.scene" -o "$work/rig.csv"
check "a rig comes to rest and sleeps ($(count 'steps asleep'))" within 1000 "$(count 'steps asleep')" 9700
sed '/^sleep/d' "$work/rig.scene" >"$work/still.scene"
run --engine tape "$models/quarter_car.veh" "$work/still.scene" -o "$work/still.csv"
# columns that are no state (loads, forces) follow by their stiffness, 2.8e5 N/m: positions come first
cut -d , -f 1-3 "$work/rig.csv" >"$work/a.csv"
cut -d , -f 1-3 "$work/still.csv" >"$work/b.csv"
check "where it would be ($(gap a b))" within 0 "$(gap a b)" 1e-6

# ---- fast steps only while they are needed

# eased BOUND: two seconds straight ahead, then a bend
eased() {
    cat >"$work/eased.scene" <<XXX
gicscene: 1
duration: 4
step: 0.005
ratio: 5
output_step: 0.05
initial: {speed: 12}
inputs:
  rack: {knots: {times: [2, 2.5], values: [0, 0.02]}}
outputs: [chassis]
$1
XXX
    run --engine tape "$models/hmmwv_tires.veh" "$work/eased.scene" -o "$work/eased.csv"
}
eased ''
cp "$work/eased.csv" "$work/full.csv"
all=$(count 'fast rates')
check 'fast steps all along' [ "$(count 'fast rates skipped')" = 0 ]
eased 'steady: 1e-5'
few=$(count 'fast rates') less=$(count 'fast rates skipped')
check "what is left out and what is not add up ($few + $less)" [ $((few + less)) -eq "$all" ]
check 'a third of them is left out' within $((all / 3)) "$less" "$all"
# tires of 0.1 m of relaxation and more settle within some steps; m and m/s of the chassis follow their slips
check "the chassis does not mind ($(gap eased full))" within 1e-14 "$(gap eased full)" 1e-3

# ---- what is refused

# refused TEXT REMEDY
refused() {
    run --engine tape "$1" "$work/bad.scene"
    check "refused: $2" exits 1
    check "message: $2" says "error: .*$2"
    check "remedy: $2" says "remedy: .*$3"
}
scene bad 'sleep: {within: 0}'
refused "$models/hmmwv_tires.veh" 'within must be positive' 'greater than zero'
scene bad 'sleep: soon'
refused "$models/hmmwv_tires.veh" 'sleep must be a map' 'within'
scene bad 'sleep: {}'
sed -i 's/^ratio.*/integrator: adams/' "$work/bad.scene"
refused "$models/hmmwv_tires.veh" 'only constant steps' 'ab3'
scene bad 'steady: 1e-4'
sed -i '/^ratio/d' "$work/bad.scene"
refused "$models/hmmwv_tires.veh" 'fast steps, of which there are none' 'ratio'
cat >"$work/bad.scene" <<XXX
gicscene: 1
duration: 1
step: 0.01
sleep: {}
XXX
cat >"$work/timed.veh" <<XXX
gicgen: 1
model: cart
base: ground
bodies:
  cart: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, bodies: [ground, cart], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, cart], axis: [1, 0, 0], range: [-9, 9]}
forces:
  shake: {type: force, coordinate: x, value: "sin(3 * time)"}
outputs:
  x: {type: coordinate, coordinate: x}
XXX
refused "$work/timed.veh" "'shake' of 'cart' changes with time" 'remove'
sed "s/\"sin(3 \* time)\"/wave/; s/^forces:/signals: {phase: 3 * time, wave: sin(phase)}\n&/" "$work/timed.veh" >"$work/signal.veh"
refused "$work/signal.veh" "'shake' of 'cart' changes with time" 'remove'
sed "s/\"sin(3 \* time)\"/slow/; s/^forces:/states: {slow: {rate: sin(3 * time)}}\n&/" "$work/timed.veh" >"$work/state.veh"
refused "$work/state.veh" "'slow' of 'cart' changes with time" 'remove'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
