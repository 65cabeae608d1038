#!/bin/sh
# SPDX-License-Identifier: MIT
# test_drive.sh GICRUN: the page of --drive: the vehicle in it takes whole scenes to every digit of gicrun, on every kind of
# road, with profiles, drivers, events and controllers; in a real browser it is driven by keys and pads; what was recorded
# there is replayed to every digit of the page; and mistakes end in messages.
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
compare() { /usr/bin/python3 -B "$root/tests/data/drive/compare.py" "$@" >"$work/said" 2>&1; }

vehicle=$root/models/hmmwv_vehicle.veh
full=$root/models/scenes/full_run.scene

# an output at each look at the targets
sed 's/^output_step: .*/output_step: 0.024/' "$full" >"$work/fine.scene"
run --drive "$work/drive.html" "$vehicle" "$work/fine.scene"
check 'a page' exits 0
check 'it says nothing, and leaves no other file' [ -z "$(cat "$work/out" "$work/err"; find "$work" -name '*.tmp' -o -name '*.wasm')" ]
inside() { ! sed '/^<script id="code"/,/<\/script>/d' "$1" | grep -oE '(src|href)="[^"]*|https?://[^ ]*|@import|url\(' |
    grep -v 'href="data:,$'; }
check 'it refers to nothing outside' inside "$work/drive.html"
run --drive "$work/again.html" "$vehicle" "$work/fine.scene"
check 'the same page again, byte for byte' cmp "$work/drive.html" "$work/again.html"

# ---- whole scenes: roads of all kinds, every form of profiles, a driver, no wheels

cat >"$work/roads.scene" <<'END'
gicscene: 1
duration: 3
step: 0.005
integrator: rk4
initial: {position: [0, 0, 0.4826], speed: 8}
road:
  type: sum
  roads:
    - {type: slope, x: 0.02, y: -0.01}
    - {type: sine, amplitude: 0.02, wavelength: 7}
    - {type: bumps, bumps: [{x: 5, length: 1, height: 0.05, tracks: left}, {x: 9, length: 2, height: 0.04}]}
    - {type: table, x: [0, 5, 9, 30], left: [0, 0.01, 0.03, 0], right: [0, 0, 0.02, 0]}
  friction: {value: 0.9, patches: [{x: [6, 12], y: [-2, 0], value: 0.4}]}
inputs:
  rack: {sine: {amplitude: 0.01, frequency: 0.7, start: 0.3}}
  brake: {samples: {times: [0, 1, 1.5, 2.2], values: [0, 0, 0.2, 0.1]}}
  drive_torque: {formula: "100 * time * (2 - time) / (1 + time)"}
END
cat >"$work/chirp.scene" <<'END'
gicscene: 1
duration: 2
step: 0.005
ratio: 3
initial: {position: [0, 0, 0.4826], speed: 10}
inputs: {rack: {chirp: {amplitude: 0.01, from: 1, to: 4, duration: 1.7, growth: logarithmic}}}
END
set --
# page MODEL SCENE DIGITS: a page, and what gicrun computes by the page's arithmetic, which the browser must have to the last
# bit. By that of the computer it is the same to DIGITS: ten times what was seen, and forces that are zero but for rounding
# count as 1e-3 of their unit
page() {
    scene=$(basename "$2" .scene)
    run --drive "$work/$scene.html" "$1" "$2"
    check "a page of $scene" exits 0
    run --engine page "$1" "$2" -o "$work/$scene.csv"
    check "$scene by the page's arithmetic" exits 0
    check "it says so" says "those of the page of --drive"
    run -q --general "$1" "$2" -o "$work/plain.csv"
    check "$scene by another arithmetic" compare "$work/$scene.csv" "$work/plain.csv" "$3"
    printf '%s\n' "$work/$scene.html" "$work/$scene.csv" >>"$work/pages"
}
page "$vehicle" "$full" 1e-9
page "$vehicle" "$root/models/scenes/lane_change.scene" 1e-9
page "$vehicle" "$root/models/scenes/field_track.scene" 1e-9
page "$root/models/hmmwv_tires.veh" "$work/roads.scene" 1e-8
page "$root/models/hmmwv_tires.veh" "$work/chirp.scene" 1e-8
sed 's/^duration:.*/duration: 1.5/' "$root/models/scenes/tires_jump.scene" >"$work/jump.scene"
echo 'locate: true' >>"$work/jump.scene"
page "$root/models/hmmwv_tires.veh" "$work/jump.scene" 1e-6
page "$root/models/hmmwv.veh" "$root/models/scenes/suspension_rig.scene" 1e-11
page "$root/models/pendulum.veh" "$root/models/scenes/pendulum.scene" 1e-12
# straight ahead: motion to the side is nothing but rounding, which grows
page "$root/models/formula_student.veh" "$root/models/scenes/formula_student_acceleration.scene" 1e-2
page "$root/models/motorcycle.veh" "$root/models/scenes/motorcycle_lane_change.scene" 1e-6

# ---- in the browser

tutorial=$root/models/tutorial/6_steering
run --drive "$work/driver.html" "$tutorial.veh" "$tutorial.scene"
check 'a page with a driver and a parameter' exits 0
# shellcheck disable=SC2046  # two words a page
timeout 900 /usr/bin/python3 -B "$root/tests/data/drive/browser.py" "$work/profile" "$work/drive.html" "$work/recording.csv" \
    "$work/driver.html" "$work/handed.csv" $(cat "$work/pages") >"$work/notes" 2>"$work/err"
check 'the browser is used to the end' [ $? -eq 0 ]
while read -r how what; do
    check "$what" [ "$how" = good ]
done <"$work/notes"

# replays ENGINE DIGITS: the recording; 0: every digit
replays() {
    run -q --engine "$1" --replay "$work/recording.csv" "$vehicle" "$work/fine.scene" -o "$work/replay.csv"
    check "engine $1 replays the recording" exits 0
    check "engine $1 finds its digits" compare "$work/recording.csv" "$work/replay.csv" "$2"
}
replays auto 0
replays page 0
replays tcc 1e-9
replays tape 1e-9

check 'the other recording has the parameter' grep -q 'parameter.bar' "$work/handed.csv"
run -q --replay "$work/handed.csv" "$tutorial.veh" "$tutorial.scene" -o "$work/handed_replay.csv"
check 'a recording of a driver, a gamepad and the driver again is replayed' compare "$work/handed.csv" "$work/handed_replay.csv" 0

# the first of what `make demo` makes and names; before that it only builds
first() { make --no-print-directory -n -C "$root" demo | grep -m 1 -E 'full_run|paper_run|echo "to drive' | grep -q -e --drive; }
check 'the demo makes a page to drive first' first

# ---- mistakes

# misses WHAT STATUS WORDS ARGUMENTS...: a run that fails and leaves no page
misses() {
    what=$1 wanted=$2 words=$3
    shift 3
    rm -f "$work/none.html"
    run "$@"
    check "$what: status" exits "$wanted"
    check "$what: why" says "$words"
    check "$what: no page" [ ! -e "$work/none.html" ]
}
misses 'a page of another kind' 2 'must end in .html' --drive "$work/none.txt" "$vehicle" "$full"
misses 'a page and results' 2 'writes a page and no results' --drive "$work/none.html" -o - "$vehicle" "$full"
misses 'variable steps' 1 'takes constant steps' --drive "$work/none.html" --integrator adams "$vehicle" "$full"
sed 's/^initial:/road: {type: iso8608, class: C, length: 30000}\n&/' "$full" >"$work/long.scene"
misses 'the engine page without a run' 2 'goes with a run' --engine page --modes "$vehicle"
misses 'the engine page with variable steps' 1 'takes constant steps' --engine page --integrator adams "$vehicle" "$full"
misses 'a road that is too long' 1 'too many for a page' --drive "$work/none.html" "$vehicle" "$work/long.scene"
mkdir "$work/bin" "$work/none"
program=$(realpath "$gicrun")
# through PATH: gicrun finds no other clang than that of a folder
through() {
    printf '#!/bin/sh\nPATH=%s exec %s "$@"\n' "$1" "$program" >"$work/through"
    chmod +x "$work/through"
    gicrun=$work/through
}
through "$work/none"
misses 'no generated code' 2 'does not go with --engine' --engine gic --drive "$work/none.html" "$vehicle" "$full"
misses 'no clang' 1 'install clang' --engine tape --drive "$work/none.html" "$vehicle" "$full"
run -q --replay "$work/recording.csv" "$vehicle" "$work/fine.scene" -o "$work/replay.csv"
check 'a replay without clang' exits 0
check 'it warns that digits differ, with the remedy' says 'differs from the page in the last digits'
check 'and what to do' says 'install clang'
check 'it is near' compare "$work/recording.csv" "$work/replay.csv" 1e-9
run -q --engine page "$vehicle" "$work/fine.scene" -o "$work/none.csv"
check 'the engine page without clang' exits 1
check 'it says why' says 'install clang'
check 'it leaves no results' [ ! -e "$work/none.csv" ]
printf '#!/bin/sh\necho "error: unknown target wasm32" >&2\nexit 1\n' >"$work/bin/clang"
chmod +x "$work/bin/clang"
through "$work/bin"
misses 'a clang without WebAssembly' 1 'unknown target wasm32' --engine tape --drive "$work/none.html" \
    "$vehicle" "$full"
gicrun=$program
check 'nothing of its work is left' [ -z "$(find "${TMPDIR:-/tmp}" -maxdepth 1 -name 'gicrun-*' -newer "$work/bin/clang")" ]

recorded() { misses "$1" 1 "$2" -q --replay "$work/wrong.csv" "$vehicle" "$work/fine.scene" -o "$work/wrong_results.csv"; }
{
    echo 'time [s],hands,target.brake,target.accelerator'
    for k in 0 1 2; do echo "$k,1,0,0" | awk -F, -v OFS=, '{ $1 *= 0.024; print }'; done
} >"$work/short.csv"
sed 's/accelerator/throttle/' "$work/short.csv" >"$work/wrong.csv"
recorded 'an input that is not there' "no input 'throttle'"
sed 's/^0.048/0.05/' "$work/short.csv" >"$work/wrong.csv"
recorded 'another step' 'time must be 0.048 s'
head -n 2 "$work/short.csv" >"$work/wrong.csv"
recorded 'one row' 'fewer than two rows'
sed 's/hands/feet/' "$work/short.csv" >"$work/wrong.csv"
recorded 'no hands' "no column 'hands'"
sed 's/brake/brake [N]/' "$work/short.csv" >"$work/wrong.csv"
recorded 'another unit' 'target.brake'
run -q --replay "$work/short.csv" "$vehicle" "$work/fine.scene" -o "$work/short_results.csv"
check 'a short recording' exits 0
check 'the run ends with it' [ "$(tail -n 1 "$work/short_results.csv" | cut -d, -f1)" = 0.048 ]
misses 'a replay with --modes' 2 '--replay goes with a run' --replay "$work/short.csv" --modes "$vehicle"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
