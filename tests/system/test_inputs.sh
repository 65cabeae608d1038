#!/bin/sh
# SPDX-License-Identifier: MIT
# test_inputs.sh GICRUN GICSWEEP: inputs of scenes from files, as forms and as formulas, from end to end: against closed
# solutions, with all integrators, and every mistake with one message, its place and a remedy.
gicrun=$1
gicsweep=$2
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

# A cart that a force pushes (2 kg: x'' = push / 2) and one that is driven.
cat >"$work/carts.veh" <<'END'
gicgen: 1
model: carts
gravity: [0, 0, 0]
base: ground
bodies:
  left: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
  right: {mass: 3, com: [0, 1, 0], inertia: [1, 1, 1]}
joints:
  left: {type: prismatic, bodies: [ground, left], axis: [1, 0, 0]}
  right: {type: prismatic, bodies: [ground, right], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, left], axis: [1, 0, 0], range: [-50, 50]}
  drive: {type: translation, bodies: [ground, right], axis: [1, 0, 0], range: [-5, 5], driven: true}
inputs:
  push: {unit: N}
parameters:
  soft: {value: 3, tunable: true}
forces:
  push: {type: force, coordinate: x, value: push + 0 * soft}
outputs:
  x: {type: coordinate, coordinate: x}
  drive: {type: coordinate, coordinate: drive}
  force: {type: drive_force, coordinate: drive}
END
# scene TEXT: of two seconds
scene() { printf 'gicscene: 1\nduration: 2\nstep: 0.01\noutput_step: 0.1\nintegrator: rk4\n%s\n' "$1" >"$work/a.scene"; }
# near COLUMN AWK: is the column what the formula of t says, within 1e-6?
near() {
    awk -F, "BEGIN {pi = 3.14159265358979} NR > 1 {t = \$1; d = \$$1 - ($2); if (!(d < 1e-6 && d > -1e-6)) bad = 1}
        END {exit bad || NR < 20}" "$work/a.csv"
}

# ---- a force of time: x'' = 3 sin(5 t) gives x = 3/5 t - 3/25 sin(5 t)
for integrator in rk4 adams rkck; do
    scene 'inputs: {push: {formula: "6 * sin(5 * time)"}, drive: {formula: "0.1 * time ^ 3"}}'
    run "$work/carts.veh" "$work/a.scene" --integrator $integrator --tolerance 1e-9 -o "$work/a.csv" --general
    [ $integrator != rk4 ] || run "$work/carts.veh" "$work/a.scene" -o "$work/a.csv" --general
    check "$integrator: a formula pushes" exits 0
    check "$integrator: the cart moves as its closed solution" near 2 '3 / 5 * t - 3 / 25 * sin(5 * t)'
    check "$integrator: value of a driven coordinate" near 5 '0.1 * t ^ 3'
    check "$integrator: its rate" near 6 '0.3 * t ^ 2'
    check "$integrator: its force, from the acceleration" near 8 '3 * 0.6 * t'
done

# ---- samples of a sine, 1 kHz, in other units: the force is 3 kg times the acceleration to a thousandth
awk 'BEGIN {print "time [ms],drive [mm],push [kN]"
    for (i = 0; i <= 2000; ++i) printf "%d,%.12g,%.12g\n", i, 100 * sin(4 * i / 1000), 0.006 * sin(5 * i / 1000)}' >"$work/both.csv"
scene 'input_file: both.csv'
for integrator in rk4 adams rkck; do
    run "$work/carts.veh" "$work/a.scene" --integrator $integrator --tolerance 1e-9 -o "$work/a.csv"
    [ $integrator != rk4 ] || run "$work/carts.veh" "$work/a.scene" -o "$work/a.csv"
    check "$integrator: two inputs from a file" exits 0
    check "$integrator: the driven cart is where the samples are" near 5 '0.1 * sin(4 * t)'
    check "$integrator: its rate is that of the sine, its start included" awk -F, 'NR > 1 {
        d = $6 - 0.4 * cos(4 * $1); if (!(d < 1e-5 && d > -1e-5)) bad = 1} END {exit bad || NR != 22}' "$work/a.csv"
    check "$integrator: the force too" awk -F, 'NR > 1 && $1 > 0 && $1 < 2 {
        d = $8 + 4.8 * sin(4 * $1); if (!(d < 5e-3 && d > -5e-3)) bad = 1} END {exit bad || NR != 22}' "$work/a.csv"
    check "$integrator: the free cart as well" awk -F, 'NR > 1 {
        d = $2 - 3 / 5 * $1 + 3 / 25 * sin(5 * $1); if (!(d < 2e-5 && d > -2e-5)) bad = 1} END {exit bad || NR != 22}' "$work/a.csv"
done
# results of a run are inputs of another
scene 'inputs: {drive: {step: {to: 0.5, rise: 1}}}
outputs: [input.drive]'
run "$work/carts.veh" "$work/a.scene" -o "$work/recorded.csv"
scene 'input_file: recorded.csv'
run "$work/carts.veh" "$work/a.scene" -o "$work/a.csv"
check "results as inputs" exits 0

# so they are where a unit has quotes, commas or brackets; another unit is refused as ever
for unit in 'a"b' '"' '""a""' 'a[b' '[a]' 'a]b' 'a [b], "c"'; do
    sed "s/unit: N/unit: '$unit'/" "$work/carts.veh" >"$work/unit.veh"
    scene 'inputs: {push: {formula: "6 * sin(5 * time)"}}
outputs: [input.push]'
    run "$work/unit.veh" "$work/a.scene" -o "$work/recorded.csv"
    scene 'input_file: recorded.csv'
    run "$work/unit.veh" "$work/a.scene" -o "$work/a.csv"
    check "unit $unit: results as inputs" exits 0
    run "$work/carts.veh" "$work/a.scene" -o "$work/a.csv"
    check "unit $unit: it is told as it is" grep -qF "column 'input.push' is in $unit, and its numbers would be taken for N" "$work/err"
    run --equilibrium "$work/unit.veh" -o "$work/rest.csv"
    run --eval "$work/rest.csv" "$work/unit.veh" -o "$work/eval.csv"
    check "unit $unit: an equilibrium as states" exits 0
done

# ---- what the inputs do stands in the summary
scene 'inputs: {drive: {knots: {times: [0, 2], values: [0, 0.4]}}}'
run "$work/carts.veh" "$work/a.scene" -o "$work/a.csv"
check "the summary states rates" says 'input drive *0 to 0.4 m, rate up to 0.375 m/s, acceleration up to 0.5774 m/s^2'

# ---- mistakes
# bad PLACE TEXT: of the scene that scene() wrote
bad() {
    run "$work/carts.veh" "$work/a.scene" -o "$work/never.csv"
    check "mistake: exit status 1 for $2" exits 1
    check "mistake: $1 $2" grep -q "^$work/$1: error: .*$2" "$work/err"
    check "mistake: one error, one remedy for $2" [ "$(grep -c 'error: ' "$work/err") $(grep -c 'remedy: ' "$work/err")" = '1 1' ]
    check "mistake: no results for $2" [ ! -e "$work/never.csv" ]
}
# file CONTENT...: lines of a table of inputs
file() { printf '%s\n' "$@" >"$work/in.csv"; }
file 'time,drive' 0,0 1,1
scene 'input_file: nowhere.csv'
bad a.scene:6:13 'can.t read the table of inputs'
scene 'input_file: {name: in.csv, fit: linear}'
bad a.scene:6:33 "no fit 'linear'"
scene 'input_file: in.csv
inputs: {drive: 1}'
bad in.csv:1:6 "'drive' is described twice"
scene 'input_file: in.csv'
file 'drive,time' 0,0 1,1
bad in.csv:1:1 'first column .* must be the time'
file 'time,drives' 0,0 1,1
bad in.csv:1:6 "no input 'drives'"
file 'time,drive.rate' 0,0 1,1
bad in.csv:1:6 'no input of its own'
file 'time [h],drive' 0,0 1,1
bad in.csv:1:1 "'time' is in h"
file 'time,drive [in]' 0,0 1,1
bad in.csv:1:6 "'drive' is in in"
file 'time,drive' 0,0 1,nan
bad in.csv:3:3 "must be a number, not 'nan'"
file 'time,drive' 0,0 1,
bad in.csv:3:3 "must be a number, not ''"
file 'time,drive' 0,0 1
bad in.csv:3:1 'the row has 1 cells'
file 'time,drive' 0,0 2,1 1,3
bad in.csv:4:1 'after 2 s comes 1 s'
file 'time,drive' 0,0 2,1 2,3
bad in.csv:4:1 'times must rise'
file 'time;drive' '0;0' '1;1'
bad in.csv:1:1 'separated by semicolons'
file 'time,drive'
bad in.csv 'no samples'
awk 'BEGIN {print "time,drive"; for (i = 0; i < 200; ++i) if (i < 50 || i > 120) printf "%g,%g\n", i / 100, i}' >"$work/in.csv"
bad in.csv:52:1 'no sample between 0.49 s and 1.21 s'
sed -i 's/,.*/,0/; 1s/.*/time,push/' "$work/in.csv"
scene 'input_file: {name: in.csv, fit: monotone}'
run "$work/carts.veh" "$work/a.scene" -o "$work/a.csv"
check "monotone, a gap is bridged" exits 0
file 'time,wheel,pedal' 0,0,1 1,1,2
scene 'inputs: {drive: {file: {name: in.csv}}}'
bad a.scene:6:24 "has no column 'drive'"
scene 'inputs: {drive: {file: {name: in.csv, column: weel}}}'
bad a.scene:6:47 "has no column 'weel'"
check "the nearest column is named" says 'did you mean `column: wheel`'
scene 'inputs: {drive: {samples: {times: [0, 1], values: [0, 1], fit: monotone}}}'
bad a.scene:6:64 'acceleration of a monotone curve jumps'
scene 'inputs: {drive: {samples: {times: [1, 0], values: [0, 1]}}}'
bad a.scene:6:39 'times of samples must rise'
scene 'inputs: {drive: {step: {to: 1, rise: 0}}}'
bad a.scene:6:38 'must be positive'
scene 'inputs: {drive: {ramp: {to: 1, duration: 1, blend: 0.6}}}'
bad a.scene:6:52 'corners are longer'
scene 'inputs: {drive: {pulse: {to: 1, rise: 1, duration: 1}}}'
bad a.scene:6:52 'before it has risen and fallen'
scene 'inputs: {drive: {pulse: {to: 1, rise: 0.1, duration: 1, count: 3}}}'
bad a.scene:6:64 "need the key 'period'"
scene 'inputs: {drive: {pulse: {to: 1, rise: 0.1, duration: 1, count: 3, period: 0.5}}}'
bad a.scene:6:75 'begins before the last ended'
scene 'inputs: {drive: {chirp: {amplitude: 1, from: 1, to: 2, duration: 1}}}'
bad a.scene:6:66 'shorter than its first and its last period'
scene 'inputs: {drive: {chirp: {amplitude: 1, from: 1, to: 0, duration: 9}}}'
bad a.scene:6:53 'must be positive'
scene 'inputs: {drive: {chirp: {amplitude: 1, from: 1, to: 2, duration: 9, growth: quick}}}'
bad a.scene:6:77 "'quick'"
scene 'inputs: {drive: {formula: "abs(time - 1)"}}'
bad a.scene:6:27 "the rate of 'abs' may jump"
scene 'inputs: {push: {formula: "1 / (time - 1)"}}'
bad a.scene:6:26 'no finite number at time 1 s'
scene 'inputs: {drive: {formula: "sqrt(time)"}}'
bad a.scene:6:27 'the rate of the formula is no finite number at time 0 s'
scene 'inputs: {push: {formula: "2 * x"}}'
bad a.scene:6:31 "'x' changes with time"
scene 'inputs: {push: {formula: "2 * soft"}}'
bad a.scene:6:26 'tunable parameter'
scene 'inputs: {push: {formula: "2 * tim"}}'
bad a.scene:6:31 "there is no 'tim'"

# ---- a sweep goes on with the same file of inputs alone
scene 'input_file: in.csv'
sed -i 's/^step:.*/step: 0.0002/; s/^duration:.*/duration: 20/' "$work/a.scene"
file 'time,drive' 0,0 1,1 2,0
"$gicsweep" -q "$work/carts.veh" "$work/a.scene" --vary soft=1:3:2000 -o "$work/s.csv" >"$work/out" 2>"$work/err" &
running=$!
while kill -0 $running 2>/dev/null && [ "$(cat "$work/s.csv.journal" 2>/dev/null | wc -l)" -lt 3 ]; do sleep 0.02; done
kill -TERM $running 2>/dev/null
wait $running 2>/dev/null
check "a sweep is stopped on the way" [ "$(wc -l <"$work/s.csv.journal")" -gt 2 ]
file 'time,drive' 0,0 1,1.5 2,0
"$gicsweep" -q "$work/carts.veh" "$work/a.scene" --vary soft=1:3:2000 -o "$work/s.csv" >"$work/out" 2>"$work/err"
check "another table of inputs is another sweep" says 'is of another sweep'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
