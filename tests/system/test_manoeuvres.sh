#!/bin/sh
# SPDX-License-Identifier: MIT
# test_manoeuvres.sh GICGEN GICRUN: standard manoeuvres, `gicrun --manoeuvre`. A vehicle with linear tires against a bicycle with
# roll and the tables against the time histories (tests/vehicle/manoeuvres.py); the complete HMMWV through all of them; a
# vehicle that tips over, and those that can't be driven; wrong words.
gicrun=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
models=$root/models
linear=$root/tests/data/manoeuvre/linear.veh
/usr/bin/python3 -B "$root/tests/vehicle/manoeuvres.py" "$gicrun" "$linear" "$work" >"$work/said" 2>&1
verdict $? "the vehicle with linear tires"

# ---- the complete vehicle
for name in 'steady-speed speed=16' 'steady-radius radius=30' 'step-steer speed=16' 'sine-dwell speed=16' 'frequency speed=16 duration=20' \
    lane-change 'braking speed=16' 'coast-down speed=16' acceleration 'ride speed=15 class=3 duration=20'; do
    # shellcheck disable=SC2086 # a name and its keys
    set -- $name
    manoeuvre=$1
    shift
    run --manoeuvre "$manoeuvre" "$models/hmmwv_vehicle.veh" "$@" --report "$work/page.html" --trace "$work/trace.csv"
    check "$manoeuvre" exits 0
    check "$manoeuvre: a table" prints 'models/MANOEUVRES.md'
    check "$manoeuvre: no number is none" sh -c "! grep -qiE '[^a-z](nan|inf)[^a-z]' '$work/out' '$work/trace.csv' '$work/page.html'"
    check "$manoeuvre: nothing is loaded" sh -c "! grep -qE 'https?:|src=|@import|url\(' '$work/page.html'"
done
# the scenes on the page are scenes
run --manoeuvre step-steer "$linear" speed=20 ay=1 --report "$work/page.html"
sed -n '/<summary>left/,/<\/pre>/p' "$work/page.html" | sed -e 's/.*<pre>//' -e 's/<\/pre>.*//' -e 's/&quot;/"/g' >"$work/left.scene"
run "$linear" "$work/left.scene" -q -o "$work/again.csv"
check 'a scene of the page runs again' exits 0

# the longer the wheelbase and the slower, the same: another number of a key changes what it says and nothing else
run --manoeuvre braking "$linear" speed=20 brake=0.25 -q -o "$work/a.csv"
run --manoeuvre braking "$linear" speed=20 brake=0.25 -q -o "$work/b.csv"
check 'the same again' cmp "$work/a.csv" "$work/b.csv"
run --manoeuvre braking "$linear" --compare "$linear" speed=20 brake=0.25
check 'a vehicle beside itself' sh -c "test -s '$work/out' && ! grep -q '\*$' '$work/out'"

# ---- what can not be done
run --manoeuvre step-steer "$linear" speed=30 ay=12.5
check 'a vehicle that tips over' exits 1
check 'it is told so' says 'tips over\|no step of the steering ends in'
run --manoeuvre steady-speed "$models/hmmwv_vehicle.veh"
check 'a speed that is too high' exits 1
check 'with one that is not' says 'does not keep 22.22 m/s.*' 'remedy: choose a speed that it keeps'
run --manoeuvre steady-radius "$models/hmmwv_tmeasy.veh"
check 'nothing drives it' says "the model has no input 'accelerator'"
run --manoeuvre braking "$models/hmmwv.veh"
check 'no tires' says "has no tire"
run --manoeuvre lane-change "$models/tutorial/5_tires.veh"
check 'no steering' says "the vehicle can't be steered"
run --manoeuvre steady-radius "$linear" radius=5
check 'too narrow a circle' says 'the steering does not reach that circle'
run --manoeuvre coast-down "$linear"
check 'nothing resists it' says 'hardly anything resists the vehicle'
run --manoeuvre coast-down "$linear" speed=5 to=6
check 'down, not up' exits 1
run --manoeuvre step-steer "$models/quarter_car.veh"
check 'a rig is no vehicle' says 'has no free base'

# ---- wrong words
run --manoeuvre slalom "$linear"
check 'an unknown manoeuvre' exits 2
check 'the known ones are listed' says 'steady-speed, steady-radius, step-steer'
run --manoeuvre braking "$linear" spede=3
check 'an unknown key' exits 2
check 'the known ones are listed, too' says 'speed=27.7778 m/s'
run --manoeuvre braking "$linear" brake=2
check 'a number out of bounds' says "'brake=2' is no number from 0.01 to 1"
run --manoeuvre braking "$linear" speed=abc
check 'no number' exits 2
run --trace "$work/x.csv" --sheet "$linear"
check '--trace alone' exits 2
run --manoeuvre braking --sheet "$linear"
check 'one study at a time' exits 2

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -ge 59 ]
