#!/bin/sh
# SPDX-License-Identifier: MIT
# test_sheet.sh GICGEN GICRUN: the vehicle on one page, `gicrun --sheet`. Its numbers found again from what --dump-model,
# --eval, --equilibrium, --modes and --linearize say (tests/vehicle/sheet.py); what it can't say; the page.
gicgen=$1
gicrun=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
models=$root/models
for name in hmmwv_vehicle hmmwv_tmeasy hmmwv five_link; do
    /usr/bin/python3 -B "$root/tests/vehicle/sheet.py" "$gicgen" "$gicrun" "$models/$name.veh" "$work" >"$work/said" 2>&1
    verdict $? "the sheet of $name"
done

run --sheet "$models/hmmwv.veh"
check 'without tires there is no cornering' prints 'not there: cornering: a wheel has no tire'
check 'and all the rest' prints 'Load of axle rear'
run --sheet "$models/quarter_car.veh"
check 'a rig is no vehicle' exits 1
check 'a rig is no vehicle, said' says "has no free base"
run --sheet --kc "$models/hmmwv.veh"
check 'one at a time' exits 2

# wheels behind are steered out of the curve: by the yaw rate of a unit of their angle, 1 / (v gain) = L / v^2 + gradient
run --sheet "$root/tests/data/sheet/behind.veh" -o "$work/behind.csv"
turns() { awk -F, '{ n[$1] = $2 } END { v = 20; k = 1 / (n["at_20.yaw_gain"] * v) - 2.5 / v ^ 2
    d = n["at_20.understeer"] - k; exit !(n["at_20.yaw_gain"] > 0 && k > 1e-4 && k < 3e-4 && d * d < 1e-24) }' "$work/behind.csv"; }
check 'a car that steers behind understeers' turns
# a vehicle drawn with z = 0 at its wheels' centres, 0.3 m deep in the road, rests like one drawn upon it
printf '%s\n' 'gicgen: 1' 'model: deep' 'base: chassis' "include: [{file: $root/tests/data/manoeuvre/bar.veh, at: [0, 0, -0.3]}]" >"$work/deep.veh"
run --sheet "$work/deep.veh" -q -o "$work/deep.csv"
check 'a vehicle drawn deep in the road' exits 0
run --sheet "$root/tests/data/manoeuvre/bar.veh" -q -o "$work/upon.csv"
check 'rests as upon it' sh -c "awk -F, '/^mode_|load|camber/ && NR == FNR { v[\$1] = \$2; next } \$1 in v { ++n; d = \$2 - v[\$1]; bad += !(d * d <= 1e-12 * (1e-3 + v[\$1] * v[\$1])) }
    END { exit !(n > 30 && !bad) }' '$work/upon.csv' '$work/deep.csv'"

# the base's own frame is any frame: of a vehicle with equal moments of inertia about all axes, turned by quarter turns, small motions
# at 20 m/s along x of the drawing are the same
sed 's/inertia: \[300,1000,1200\]/inertia: [1100, 1100, 1100]/' "$root/tests/data/manoeuvre/bar.veh" >"$work/drawn.veh"
run --sheet "$work/drawn.veh" -q -o "$work/drawn.csv"
for turn in '[0, 0, 1], angle: 1.5707963267948966' '[0, 0, 1], angle: 3.141592653589793' '[0, 1, 0], angle: 1.5707963267948966' '[1, 0, 0], angle: -1.5707963267948966'; do
    sed "s/chassis: {mass/chassis: {orientation: {axis: $turn}, mass/" "$work/drawn.veh" >"$work/turned.veh"
    run --sheet "$work/turned.veh" -q -o "$work/turned.csv"
    check "base turned about $turn" sh -c "awk -F, '/^mode_/ && NR == FNR { v[\$1] = \$2; next } /^mode_/ { ++n; d = \$2 / v[\$1] - 1; bad += !(d * d < 1e-10) }
        END { exit !(n > 15 && !bad) }' '$work/drawn.csv' '$work/turned.csv'"
done

check 'steered in front, behind, by both axles' /usr/bin/python3 -B "$root/tests/vehicle/steered_axles.py" "$gicrun" \
    "$root/tests/data/manoeuvre/linear.veh" "$work"

# tires without resistance roll without slip: slopes there are those of pure slips, whatever the other direction has (TIRES.md 6).
# Lateral slopes 10 and 12.5 times the load are an understeer gradient of (1/10 - 1/12.5) / g
linear=$root/tests/data/manoeuvre/linear.veh
run --sheet "$linear" -o "$work/linear.csv"
gradient() { awk -F, '$1 ~ /understeer/ {k = 0.02 / 9.80665; n += 1; bad += ($2 / k - 1) ^ 2 > 1e-6} END {exit !(n == 3 && !bad)}' "$work/linear.csv"; }
check 'the stiffness at slip zero is that of lateral slip' gradient
# whatever the pitch at which it rests, 0.023 rad: the road is level. That tires lean and stand elsewhere changes less than 1 percent;
# a vertical velocity of 0.023 times the speed would change loads by half
for lengths in '-0.0756 -0.1205' '-0.1356 -0.0605'; do
    sed "s/free: -0.10773/free: ${lengths% *}/; s/free: -0.0905/free: ${lengths#* }/; s/damping: 200,/damping: 2000,/" "$linear" >"$work/pitched.veh"
    run --sheet "$work/pitched.veh" -o "$work/linear.csv"
    pitched() { awk -F, '$1 == "pitch" {pitch = $2 ^ 2} $1 ~ /understeer/ {k = 0.02 / 9.80665; n += 1; bad += ($2 / k - 1) ^ 2 > 1e-4}
        END {exit !(n == 3 && !bad && pitch > 0.022 ^ 2)}' "$work/linear.csv"; }
    check "a car that rests with a pitch, $lengths" pitched
done
# a scene that begins in equilibrium with a speed begins without a heave; on a slope, along the slope: g sin(atan(0.1)) along x alone
printf '%s\n' 'gicscene: 1' 'duration: 1' 'step: 0.001' 'initial: {equilibrium: true, speed: 30}' >"$work/level.scene"
run --linearize "$work/pitched.veh" "$work/level.scene" -o "$work/level.csv"
check 'no heave at its start' prints 'largest acceleration: -\?[0-9.]*e-1[0-9] '
sed 's/^initial/road: {type: slope, x: 0.1}\n&/' "$work/level.scene" >"$work/slope.scene"
run --linearize "$work/pitched.veh" "$work/slope.scene" -o "$work/slope.csv"
check 'nor on a slope' prints 'largest acceleration: -0.97[0-9] m/s^2, of x$'
sed -e '/tie:/d' -e 's/steer:/steer_l:/' "$linear" >"$work/apart.veh"
run --sheet "$work/apart.veh"
check 'wheels that are steered separately' prints 'not there: cornering: the wheels of axle front are steered separately, f_[lr] not by steer_[lr]'

# a vehicle with a powertrain leans as it does when it is driven: 0.0065 rad s^2/m, in first gear and idle 7 % less
run --sheet "$models/hmmwv_vehicle.veh" -o "$work/complete.csv"
run --manoeuvre step-steer "$models/hmmwv_vehicle.veh" speed=10 ay=0.5 -q -o "$work/driven.csv"
leans() { awk -F, '{ n[FILENAME, $1] = $2 } END { k = n[ARGV[2], "left.roll.steady"] / n[ARGV[2], "left.ay.steady"]
    d = n[ARGV[1], "at_10.roll_gradient"] / k - 1; exit !(d * d < 1e-4) }' "$work/complete.csv" "$work/driven.csv"; }
check 'it leans as it does when it is driven' leans

# numbers of motions that do not last are told: wheels at 0.02 rad; air that pushes down what the springs carry, 1202 kg
sed 's/driven: true/driven: true, initial: 0.02/' "$linear" >"$work/off.veh"
run --sheet "$work/off.veh"
check 'steering that does not stand straight' prints 'do not stand straight but turned by 1.15 deg on the mean, with steer at 0.02 rad.*`initial: 0`'
run --sheet "$linear"
check 'steering that does' sh -c "! grep -q 'stand straight\|equilibrium' '$work/out'"
sed 's/^forces:/&\n  air: {type: aero, body: chassis, point: [0.001996672, 0, 0.5], area: 2, density: 1.25, drag: 0, force: [0, 0, -1]}/' "$linear" >"$work/air.veh"
run --sheet "$work/air.veh"
check 'air that pushes down' prints 'cornering at 20 m/s: there .* pushed down with 0.416 m/s^2' # 1.25 20^2 / 1202

# a trailer does not count: the wheelbase of the tractor is that of its drawing, 0 to -4.9 and -6.2 m, and the circle that of its outer
# wheel at the end of the steering; understeer follows from the yaw gain
run --sheet "$models/semitrailer.veh" -o "$work/truck.csv"
check 'the sheet of a semitrailer' exits 0
check 'axles of the trailer are told once' [ "$(grep -c "axles axle_4, rear belong to a unit that turns by 'bend'" "$work/err")" -eq 1 ]
check 'and their loads' grep -q '^trailer_2_outer_l.load,' "$work/truck.csv"
run --kc -q --axle front "$models/semitrailer.veh" -o "$work/truck_kc.csv"
truck() { awk -F, 'NR == FNR { n[$1] = $2; next } FNR == 1 { for (i = 1; i <= NF; ++i) { split($i, h, " "); at[h[1]] = i } }
    $2 == "steer" { w = $at["mean_steer"] > 0 ? "steer_tire_r." : "steer_tire_l."; o = $at[w "steer"]; if (o * o > most) { most = o * o; x = $at[w "contact_x"] } }
    END { l = n["wheelbase"]; bad = !((l / 5.55 - 1) ^ 2 < 1e-8); c = n["front.turning_circle"] * sin(sqrt(most)) / 2 / (x + 5.55) - 1; bad += !(c * c < 1e-12)
    for (v = 10; v <= 30; v += 10) { k = 1 / (v * n["at_" v ".yaw_gain"]) - l / v ^ 2; d = n["at_" v ".understeer"] - k; bad += !(d * d < 1e-24) || !(k > 0.004 && k < 0.01) }
    exit bad > 0 }' "$work/truck.csv" "$work/truck_kc.csv"; }
check 'wheelbase, circle and understeer of the tractor' truck
run --sheet "$models/hatchback.veh" -o "$work/rubber.csv"
check 'bushings are told once' [ "$(grep -c 'left out' "$work/err")" -eq 1 ]
even() { awk -F, '{ n[$1] = $2 } END { d = n["rear_l.wheel_rate"] / n["rear_r.wheel_rate"] - 1; exit !(n["rear_l.wheel_rate"] > 0 && d * d < 1e-12) }' "$work/rubber.csv"; }
check 'left and right of the twist beam' even

run --sheet "$models/hmmwv_vehicle.veh" -o "$work/sheet.html"
check 'the page' exits 0
run --sheet "$models/hmmwv_vehicle.veh" -o "$work/again.html"
check 'the same page again' cmp "$work/sheet.html" "$work/again.html"
check 'nothing is loaded' sh -c "! grep -qE 'https?:|src=|@import|url\(' '$work/sheet.html'"
check 'no number is none' sh -c "! grep -qiE '[^a-z](nan|inf)[^a-z]' '$work/sheet.html'"
check 'cornering is there' grep -q 'Understeer gradient' "$work/sheet.html"

check 'modes move on the page' sh -c "[ $(grep -c 'class="shape"' "$work/sheet.html") -ge 8 ]"
run --sheet "$models/hmmwv_vehicle.veh" -q -o "$work/sheet.csv"
run --manoeuvre acceleration "$models/hmmwv_vehicle.veh" -q -o "$work/fast.csv"
fast() { a=$(grep '^top_speed' "$work/sheet.csv"); [ -n "$a" ] && [ "$a" = "$(grep '^top_speed' "$work/fast.csv")" ]; }
check 'the top speed is that of the manoeuvre' fast

# two vehicles: numbers are those of either alone; one beside itself has no differences
run --sheet -q "$models/five_link.veh" -o "$work/other.csv"
run --sheet -q --compare "$models/five_link.veh" "$models/hmmwv.veh" -o "$work/both.csv"
check 'two vehicles' exits 0
both() { awk -F, 'NR == FNR {if (FNR > 1) other[$1] = $2; next} FNR > 1 && $1 !~ /^mode_/ {n += ($1 in other); d += other[$1] != $4
    e += ($1 in other) && ($4 - $2 - $5) ^ 2 > 1e-18 * (1 + $2 ^ 2)} END {exit !(n > 50 && !d && !e)}' "$work/other.csv" "$work/both.csv"; }
check 'the other one has its numbers' both
run --sheet --compare "$models/hmmwv.veh" "$models/hmmwv.veh"
check 'a vehicle beside itself' sh -c "! grep -q '\*$' '$work/out'"
run --sheet --compare "$models/five_link.veh" "$models/hmmwv.veh"
check 'what differs is marked' grep -q 'Mass  .*\*$' "$work/out"
# two settings of one: the sheet with the scene has the other numbers
printf '%s\n' 'gicscene: 1' 'duration: 1' 'step: 0.001' 'parameters: {bar_front: 0, bar_rear: 0}' >"$work/none.scene"
run --sheet -q "$models/formula_student.veh" "$work/none.scene" -o "$work/other.csv"
run --sheet -q --compare "$work/none.scene" "$models/formula_student.veh" -o "$work/both.csv"
settings() { awk -F, 'NR == FNR {if (FNR > 1) other[$1] = $2; next} FNR > 1 && $1 !~ /^mode_/ {n += ($1 in other)
    d += other[$1] != $4; r += $1 ~ /roll_rate/ && $2 != $4} END {exit !(n > 50 && !d && r == 2)}' "$work/other.csv" "$work/both.csv"; }
check 'two settings' settings
# parameters of a scene act on the top speed: a drag four times as large
sed -e 's/^inputs:/parameters:\n  area: {value: 1, unit: m^2, tunable: true}\ninputs:/' \
    -e 's/^forces:/&\n  air: {type: aero, body: chassis, point: [0, 0, 0.5], area: area, density: 1.25, drag: 0.8, force: [0, 0, 0]}/' "$linear" >"$work/drag.veh"
printf '%s\n' 'gicscene: 1' 'duration: 1' 'step: 0.001' 'parameters: {area: 4}' >"$work/drag.scene"
sed 's/value: 1, unit: m^2/value: 4, unit: m^2/' "$work/drag.veh" >"$work/drag_4.veh"
for of in drag drag_4; do run --sheet -q "$work/$of.veh" -o "$work/$of.csv"; done
run --sheet -q "$work/drag.veh" "$work/drag.scene" -o "$work/drag_by_scene.csv"
check 'the top speed is that of the scene' cmp "$work/drag_4.csv" "$work/drag_by_scene.csv"
slower() { awk -F, '$1 == "top_speed" { v[++n] = $2 } END { exit !(n == 2 && v[2] < 0.55 * v[1] && v[2] > 0.45 * v[1]) }' "$work/drag.csv" "$work/drag_4.csv"; }
check 'half as fast as with a quarter of the drag' slower
# wheels on tires, and their relaxation: tires in front and behind change places: modes of wheels in front go up, of those behind down, whatever their numbers
sed 's/\(front: .*stiffness: \)250000/\1200000/; s/\(rear: .*stiffness: \)250000/\1300000/' "$linear" >"$work/soft_front.veh"
sed 's/\(front: .*stiffness: \)250000/\1300000/; s/\(rear: .*stiffness: \)250000/\1200000/' "$linear" >"$work/soft_rear.veh"
run --sheet --compare "$work/soft_rear.veh" "$work/soft_front.veh" -o "$work/hop.csv"
check 'modes change their numbers' says 'has the shape of the other.s mode'
hops() { awk -F, '$1 ~ /^mode_.*frequency/ && $2 > 10 { r = $4 / $2; up += r > 1.05 && r < 1.3; down += r < 0.95 && r > 0.77; ++n } END { exit !(n == 8 && up == 4 && down == 4) }' "$work/hop.csv"; }
check 'wheels in front hop faster, those behind more slowly' hops

# a wheel that is called as an axle is has names of its own, whatever the other vehicle's wheels are called; no two numbers have one name
once() { [ -s "$1" ] && [ -z "$(cut -d, -f1 "$1" | sort | uniq -d)" ]; }
delta=$root/tests/data/sheet/delta.veh
run --sheet -q "$delta" -o "$work/delta.csv"
check 'a wheel called front: names' once "$work/delta.csv"
check 'its load and that of the axle' sh -c "grep -q '^wheel.front.load,2070.22' '$work/delta.csv' && grep -q '^front.load,2070.22' '$work/delta.csv'"
sed 's/model: delta/model: other/; s/  front: {body/  nose: {body/' "$delta" >"$work/nose.veh"
for pair in "$work/nose.veh $delta" "$delta $work/nose.veh"; do
    # shellcheck disable=SC2086 # two files
    run --sheet -q --compare $pair -o "$work/pair.csv"
    check 'one vehicle under two names' once "$work/pair.csv"
    check 'has the same numbers' awk -F, 'NR > 1 { ++n; bad += $2 == "" || $4 == "" || ($4 - $2) ^ 2 > 1e-18 * (1 + $2 ^ 2) } END { exit !(n > 50 && !bad) }' "$work/pair.csv"
done
# motions that only the other one has get numbers that no other motion has
for pair in "$linear $delta" "$delta $linear"; do
    # shellcheck disable=SC2086 # two files
    run --sheet -q --compare $pair -o "$work/pair.csv"
    check 'vehicles of different motions' once "$work/pair.csv"
    check 'some are of the other one alone' grep -q '^mode_.*,,' "$work/pair.csv"
done
sed 's/mass: 1200/mass: m/; s/^inputs:/parameters:\n  m: {value: 1200, unit: kg}\n&/' "$linear" >"$work/mass.veh"
run --sheet -q "$work/mass.veh" --vary m=1100:1300:3 --compare "$delta" -o "$work/runs.csv"
check 'nor do columns of a study have one name' [ -z "$(head -n 1 "$work/runs.csv" | tr , '\n' | sort | uniq -d)" ]
# slips that balance each other move no body, at -V / 0.5 m = -40 1/s in all runs: two motions, each with one number
run --sheet -q "$work/mass.veh" --vary m=1100:1300:3 -o "$work/runs.csv"
balanced() { awk -F, 'NR > 1 { for (i = 1; i <= NF; ++i) if ($i != "" && ($i + 40) ^ 2 < 1e-18) { ++n[i]; last = i } }
    END { for (i in n) { ++c; bad += n[i] != 3 } exit !(c == 2 && !bad) }' "$work/runs.csv"; }
check 'motions that move no body keep their numbers' balanced

# a vehicle whose centre of mass is beside its wheels has no sheet, but an equilibrium on its side
sed 's/com: \[-0.2, 0, 0.4\]/com: [-0.2, 0.8, 0.4]/' "$delta" >"$work/fallen.veh"
for way in --sheet '--manoeuvre step-steer'; do
    # shellcheck disable=SC2086 # words
    run $way "$work/fallen.veh" -o "$work/fallen.csv"
    check "$way of a vehicle on its side" exits 1
    check 'says so' says 'does not rest on its wheels: it tips over and lies there leaning by 101 degrees'
    check 'no file' [ ! -e "$work/fallen.csv" ]
done
run --equilibrium "$work/fallen.veh"
check 'its equilibrium' exits 0
check 'is told to be none on wheels' says 'warning: the vehicle does not rest on its wheels: it tips over'
# a coordinate that rests beyond its range is told once, by the name of a file that there is
sed 's/\(slide: {type: translation.*\)-0.1, 0.1/\1-0.01, 0.01/; s/^bodies:/inputs:\n  accelerator: {unit: "1"}\n  brake: {unit: "1"}\n&/; s/fade: 0.001/&, drive: 100 * accelerator, brake: 500 * brake/' "$delta" >"$work/beyond.veh"
sed -i 's/stiffness: 20000/stiffness: 22000/' "$work/beyond.veh"
run --sheet "$work/beyond.veh" -o "$work/beyond.csv"
check 'beyond a range' [ "$(grep -c "beyond.veh: warning: coordinate 'slide' leaves its range" "$work/err")" -eq 1 ]
check 'of no scene that nobody has' sh -c "! grep -q 'scene of' '$work/err'"

# wheels behind that a coordinate of their own turns by 0.02 rad: 0.02 v^2 / (L + K v^2) = 0.713 m/s^2 at 10 m/s (0.3 % less by the
# lean), as the wheels in front would at -0.02 rad; both at 0.02 rad run straight aside
sed -e 's/^  rear_l: {mass/  turner_l: {mass: 1, com: [-1.4, 0.75, 0.3], inertia: [0.1, 0.1, 0.1]}\n&/' \
    -e 's/^  rear_l: {type: prismatic.*/  turn_l: {type: revolute, bodies: [chassis, turner_l], point: [-1.4, 0.75, 0.3], axis: [0, 0, 1]}\n  rear_l: {type: prismatic, bodies: [turner_l, rear_l], axis: [0, 0, 1]}\n  tie_b: {type: distance, bodies: [turner_l, turner_r], points: [[-1.6, 0.75, 0.3], [-1.6, -0.75, 0.3]]}/' \
    -e 's/^  r_l: {type: translation, bodies: \[chassis/  behind: {type: angle, bodies: [chassis, turner_l], axis: [0, 0, 1], range: [-0.5, 0.5], driven: true, initial: 0.02}\n  r_l: {type: translation, bodies: [turner_l/' "$linear" >"$work/askew.veh"
run --sheet "$work/askew.veh"
check 'an axle that is not steered stands askew' prints 'does not run straight ahead: at 10 m/s it turns to the right by 0.71[0-9] m/s^2, as if the wheels of axle front were turned by -1.15 deg; wheels of axle rear stand at 1.15 deg'
sed 's/0.5\], driven: true}/0.5], driven: true, initial: 0.02}/' "$work/askew.veh" >"$work/crab.veh"
run --sheet "$work/crab.veh"
check 'both alike' sh -c "! grep -q 'straight' '$work/out'"
run --compare "$models/hmmwv.veh" --modes "$models/hmmwv.veh"
check '--compare without --sheet' exits 2

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -ge 60 ]
