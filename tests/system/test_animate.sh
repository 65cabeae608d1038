#!/bin/sh
# SPDX-License-Identifier: MIT
# test_animate.sh GICRUN: the page of --animate: its numbers against the results and the road's formula, with every
# engine; in a real browser the picture, what moves in it, and every control; names with what HTML means something by.
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

page() { /usr/bin/python3 -B "$root/tests/data/animate/page.py" "$@" >"$work/said" 2>&1; }

model=$root/models/hmmwv.veh
scene=$root/models/scenes/paper_run.scene
run "$model" "$scene" -o "$work/run.csv" --animate "$work/run.html"
check 'a run writes a page' exits 0
check 'no temporary file is left' [ -z "$(find "$work" -name '*.tmp')" ]
check 'poses, wheels, forces and curves are those of the results' page motion "$work/run.html" "$work/run.csv"
check 'the road is that of the scene' page road "$work/run.html" "$scene"
# 401 frames of some 150 channels with some 4 bytes a number, and 200 kB of road and page
check 'the page is small' [ "$(wc -c <"$work/run.html")" -lt 450000 ]
inside() { ! grep -oE '(src|href)="[^"]*|https?://[^ ]*|@import|url\(' "$1" | grep -v 'href="data:,$'; }
check 'it refers to nothing outside' inside "$work/run.html"
cp "$work/run.html" "$work/first.html"
run "$model" "$scene" --animate "$work/run.html"
check 'without -o only the page' [ ! -s "$work/out" ]
check 'the same page again, byte for byte' cmp "$work/run.html" "$work/first.html"

# another run: every third row of this one, twice the numbers, up to 3 s
awk -F, -v OFS=, 'NR == 1 || ($1 <= 3 && NR % 3 == 2) { for (i = 2; NR > 1 && i <= NF; ++i) $i *= 2; print }' "$work/run.csv" \
    >"$work/twice.csv"
run "$model" "$scene" --animate "$work/beside.html" --with "$work/twice.csv"
check 'curves of another run are beside' page other "$work/beside.html" "$work/twice.csv"
printf 'time [s],nothing\n0,1\n1,2\n' >"$work/nothing.csv"
run "$model" "$scene" --animate "$work/none.html" --with "$work/nothing.csv"
check 'another run without them' exits 1
check 'another run without them: why' says 'none of the curves of the page'
cut -d, -f2- "$work/run.csv" >"$work/timeless.csv"
run "$model" "$scene" --animate "$work/none.html" --with "$work/timeless.csv"
check 'another run without time' exits 1
check 'another run without time: why' says "timeless.csv:1:1: error: results of a run begin with a column"
sed '3s/^[^,]*/99/' "$work/run.csv" >"$work/back.csv"
run "$model" "$scene" --animate "$work/none.html" --with "$work/back.csv"
check 'time goes back' says 'back.csv:4:1: error: time goes back from 99 to'

# a second vehicle, whose results have a name that HTML means something by, and end earlier; what they do not tell; and who needs more
later=$root/models/scenes/lane_change.scene
sed 's/target: 10/target: 9/; s/^duration: 10/duration: 8/; s/preview: 0.55/preview: 0.8/' "$later" >"$work/later.scene"
run -q "$root/models/hmmwv_vehicle.veh" "$work/later.scene" -o "$work/<b>later&.csv"
run "$root/models/hmmwv_vehicle.veh" "$later" --animate "$work/two.html" --with "$work/<b>later&.csv"
check 'a page of two vehicles' exits 0
check 'the second vehicle is where its results put it' page ghost "$work/two.html" "$work/<b>later&.csv"
run -q --engine gcp1 "$root/models/hmmwv_vehicle.veh" "$later" --animate "$work/gcp_two.html" --with "$work/<b>later&.csv"
check 'it is with another engine' page ghost "$work/gcp_two.html" "$work/<b>later&.csv"
sed '1s/spring_f_l.value/spring.value/' "$work/<b>later&.csv" >"$work/less.csv"
run "$root/models/hmmwv_vehicle.veh" "$later" --animate "$work/less.html" --with "$work/less.csv"
check 'what is not told is as at the start' grep -q '"untold":\["spring_f_l"\]' "$work/less.html"
sed '1s/chassis\.z/body.z/' "$work/<b>later&.csv" >"$work/nowhere.csv"
run "$root/models/hmmwv_vehicle.veh" "$later" --animate "$work/curves.html" --with "$work/nowhere.csv"
check 'results that do not tell where the base is' exits 0
check 'results that do not tell where the base is: why' says 'a second vehicle needs outputs'
check 'results that do not tell where the base is: no vehicle' grep -q '"ghost":null' "$work/curves.html"

# Euler parameters of the second vehicle that are none, in its third row
for length in 0 2; do
    awk -F, -v OFS=, -v length_="$length" 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^chassis_orientation[.]e0/) c = i }
        NR == 4 { $c = length_; $(c + 1) = $(c + 2) = $(c + 3) = 0 } { print }' "$work/<b>later&.csv" >"$work/wrong.csv"
    run "$root/models/hmmwv_vehicle.veh" "$later" --animate "$work/wrong.html" --with "$work/wrong.csv"
    check "Euler parameters of length $length" says "wrong.csv:4:1: warning: the Euler parameters 'chassis_orientation.e0' and on are no orientation: their length is $length"
    check "Euler parameters of length $length: no vehicle" grep -q '"ghost":null' "$work/wrong.html"
done

# outputs that tell how wheels are turned, for the table of the wheels
{
    printf 'gicgen: 1\ninclude: %s\nmodel: turning\noutputs:\n' "$root/models/hmmwv_vehicle.veh"
    for wheel in f_l f_r r_l r_r; do echo "  turn_$wheel: {type: orientation, body: wheel_$wheel}"; done
} >"$work/turning.veh"
run -q "$work/turning.veh" "$later" -o "$work/turning.csv" --animate "$work/turning.html"

# units: numbers of the picture and of the page, files as they are, and mistakes
{
    cat "$later"
    echo '  - chassis_velocity.x'
    echo 'units: [deg, km/h, g]'
} | sed 's/^  - {x: chassis.x, y: chassis.y}//; s/^duration: 10/duration: 4.5/' >"$work/units.scene"
sed '/^units/d' "$work/units.scene" >"$work/si.scene"
mkdir "$work/bin"
printf '#!/bin/sh\nif [ "$1" = - ]; then cat >"%s"; exec %s - <"%s"; fi\nexec %s "$@"\n' "$work/script" "$(command -v gnuplot)" \
    "$work/script" "$(command -v gnuplot)" >"$work/bin/gnuplot"
chmod +x "$work/bin/gnuplot"
run -q "$root/models/hmmwv_vehicle.veh" "$work/si.scene" -o "$work/si.csv" --plot "$work/si.svg"
PATH=$work/bin:$PATH run -q "$root/models/hmmwv_vehicle.veh" "$work/units.scene" -o "$work/units.csv" --plot "$work/units.svg" \
    --animate "$work/units.html" --with "$work/si.csv"
check 'units change no results' cmp "$work/units.csv" "$work/si.csv"
check 'axes have the units' grep -q 'angle \[deg\]' "$work/units.svg"
check 'the picture has the numbers in them, of both runs' page units "$work/script" "$work/units.csv" chassis_attitude.roll \
    57.29577951308232 chassis_velocity.x 3.6 wheel_f_l.y 1
for mistake in 'units: deg=units must be a list' 'units: [degree]=do not know the unit' "units: [rpm, deg/s]='rpm' and 'deg/s' are both"; do
    { cat "$work/si.scene"; echo "${mistake%%=*}"; } >"$work/bad.scene"
    run -q "$root/models/hmmwv_vehicle.veh" "$work/bad.scene" -o "$work/bad.csv"
    check "mistake: ${mistake#*=}" exits 1
    check "mistake: ${mistake#*=}: why" says "${mistake#*=}"
done

# to rounding, twice a unit, for the last digit may fall either way; partitioned coordinates are integrated themselves,
# with errors of their own: more
for engine in cc tape gic gcp1 gcp2; do
    run -q --engine $engine "$model" "$scene" --animate "$work/$engine.html"
    case $engine in gcp*) units=10 ;; *) units=2 ;; esac
    check "engine $engine gives the same motion" page same "$work/run.html" "$work/$engine.html" $units
done

# wheels that spin, on a plane that rises to the left and ahead: steered, braked until they lock
tires=$root/models/hmmwv_tires.veh
cat >"$work/tires.scene" <<'END'
gicscene: 1
duration: 3
step: 0.005
ratio: 5
initial: {position: [0, 0, 0.4826], orientation: {yaw: 0.3}, speed: 12}
road: {type: slope, x: 0.05, y: 0.03}
inputs:
  rack: {knots: {times: [0.2, 1], values: [0, 0.03]}}
  brake: {knots: {times: [1.5, 1.7], values: [0, 0.9]}}
END
run "$tires" "$work/tires.scene" -o "$work/tires.csv" --animate "$work/tires.html"
check 'wheels with tires turn by their spin, arrows have all three components' \
    page tires "$work/tires.html" "$work/tires.csv" 0.05 0.03 0.3175
run -q --engine gcp1 "$tires" "$work/tires.scene" -o "$work/gcp1.csv" --animate "$work/gcp1.html"
check 'they do with another engine' page tires "$work/gcp1.html" "$work/gcp1.csv" 0.05 0.03 0.3175

# ice and glue
cat >"$work/ice.scene" <<'END'
gicscene: 1
duration: 1
step: 0.005
initial: {speed: 8}
road:
  type: flat
  friction:
    value: 1
    patches: [{x: [3, 9], y: [-2, 0.3], value: 0.1, fade: 0.5}, {x: [6, 7], y: [0, 1], value: 1.6, fade: 0.3}]
END
run "$model" "$work/ice.scene" --animate "$work/ice.html"
check 'friction of the road is that of the scene' page friction "$work/ice.html" "$work/ice.scene"

# names that HTML means something by; a long run of something small on a fixed base, made larger by a parameter
cat >"$work/odd.veh" <<'END'
gicgen: 1
model: odd
description: "</script><b>\"5 < 6\" & \\ Größe \u2028 <!-- x"
base: ground
parameters:
  length: {value: 0.02, tunable: true}
bodies:
  bob: {mass: 1, com: [0, 0, -length], inertia: [1e-6, 1e-6, 1e-6]}
joints:
  pivot: {type: revolute, bodies: [ground, bob], point: [0, 0, 0], axis: [0, 1, 0]}
coordinates:
  angle: {type: angle, bodies: [ground, bob], axis: [0, 1, 0], range: [-1, 1], initial: 0.5}
END
cat >"$work/<i>&.scene" <<'END'
gicscene: 1
duration: 500
step: 0.005
parameters: {length: 0.03}
END
run "$work/odd.veh" "$work/<i>&.scene" --animate "$work/odd.html"
check 'odd names: a page' exits 0
check 'the joint is where the parameter puts it' grep -q '"name":"bob".*\[0,0,0.03\]' "$work/odd.html"
# 100001 output times; at most 6000 frames of two numbers that change, three curves; 90 kB of page
check 'a long run has a small page' [ "$(wc -c <"$work/odd.html")" -lt 400000 ]

# springs and dampers along coordinates and between points
cat >"$work/lines.veh" <<'END'
gicgen: 1
model: lines
base: ground
bodies:
  near: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}
  far: {mass: 1, com: [3, 0, 0], inertia: [1, 1, 1]}
joints:
  near: {type: prismatic, bodies: [ground, near], axis: [1, 0, 0]}
  far: {type: prismatic, bodies: [ground, far], axis: [1, 0, 0]}
coordinates:
  coil: {type: length, bodies: [ground, near], points: [[0, 0, 0], [1, 0, 0]]}
  pot: {type: length, bodies: [ground, far], points: [[0, 1, 0], [3, 0, 0]]}
forces:
  coil: {type: spring_damper, coordinate: coil, stiffness: 100, damping: 10}
  pot: {type: spring_damper, coordinate: pot, stiffness: 0, damping: 10}
  strut: {type: spring_damper, bodies: [near, far], points: [[1, 0, 0.2], [3, 0, 0.1]], stiffness: 50, damping: 1}
  dash: {type: spring_damper, bodies: [near, far], points: [[1, 0.3, 0], [3, 0.4, 0]], stiffness: 0, damping: 1}
  rubber: {type: bushing, bodies: [near, far], point: [2, 0, 0.3], orientation: {x: [0, 0, 1], z: [0, 1, 0]}, stiffness: [9, 9, 9, 0, 0, 0]}
END
printf 'gicscene: 1\nduration: 0.1\nstep: 0.01\n' >"$work/lines.scene"
run --engine tape "$work/lines.veh" "$work/lines.scene" --animate "$work/lines.html"
check 'springs, dampers and bushings are at their points' page lines "$work/lines.html" coil:spring:ground:0,0,0:near:0,0,0 \
    pot:damper:ground:0,1,0:far:0,0,0 strut:spring:near:0,0,0.2:far:0,0,0.1 dash:damper:near:0,0.3,0:far:0,0.4,0 \
    rubber:bushing:near:1,0,0.3:far:-1,0,0.3
check 'a bushing lies along z of its frame' grep -q '"name":"rubber".*"u":\[0,1,0\],"v":\[0,1,0\]' "$work/lines.html"

# shapes that models name, and those of bodies of which little is known; wheels whose forces no output tells
cat >"$work/shapes.scene" <<'END'
gicscene: 1
duration: 0.5
step: 0.002
output_step: 0.01
initial: {speed: 8}
END
shapes=$root/tests/data/animate/shapes.veh
run "$shapes" "$work/shapes.scene" -o "$work/shapes.csv" --animate "$work/shapes.html"
check 'bodies look as their model says or their mass suggests' page looks "$work/shapes.html"
cp "$root/tests/data/animate/wing.obj" "$work"
{
    cat "$shapes"
    echo 'outputs:'
    for wheel in front_l rear_l trailer_l; do echo "  load_$wheel: {type: wheel, wheel: $wheel}"; done
} >"$work/loads.veh"
run "$work/loads.veh" "$work/shapes.scene" -o "$work/loads.csv"
check 'forces of wheels without an output are those that an output tells' page forces "$work/shapes.html" "$work/loads.csv"
run --general "$shapes" "$work/shapes.scene" -o "$work/plain.csv"
check 'a page leaves no trace in the results' cmp "$work/shapes.csv" "$work/plain.csv"

lanes=$root/models/scenes/lane_change.scene
run "$root/models/hmmwv_vehicle.veh" "$lanes" --animate "$work/lanes.html"
check 'cones, lanes and path are those of the scene' page course "$work/lanes.html"

{ cat "$work/shapes.scene"; echo 'course: {lanes: [{points: [[0, 0], [10, 0], [10, 10]], width: 4}]}'; } >"$work/bend.scene"
run "$shapes" "$work/bend.scene" --animate "$work/bend.html"
check 'edges of a lane that turns' page bend "$work/bend.html"

# ---- in the browser

run "$model" "$root/models/scenes/spin.scene" -o "$work/spin.csv" --animate "$work/spin.html"
timeout 600 /usr/bin/python3 -B "$root/tests/data/animate/browser.py" "$work/profile" "$work/run.html" "$work/run.csv" \
    "$work/spin.html" "$work/spin.csv" "$work/odd.html" "$work/lanes.html" "$work/beside.html" "$work/two.html" "$work/turning.html" "$work/turning.csv" "$work/units.html" "$work/units.csv" >"$work/notes" 2>"$work/err"
check 'the browser is used to the end' [ $? -eq 0 ]
while read -r how what; do
    check "$what" [ "$how" = good ]
done <"$work/notes"

# ---- mistakes and failures

run "$model" "$scene" --animate "$work/page.txt"
check 'a page of another kind' exits 2
check 'a page of another kind: why' says 'must end in .html'
run --eval "$work/run.csv" "$model" --animate "$work/page.html"
check 'not with --eval' exits 2
run "$model" "$scene" -o "$work/kept.csv" --animate "$work/nowhere/page.html"
check 'a place that is not there' exits 1
check 'a place that is not there: why' says "nowhere/page.html: error: can't create"
check 'a place that is not there: noticed before the run' [ ! -e "$work/kept.csv" ]
# the wheels drop into a hole and the springs go beyond reach
sed 's/height: 0.08, tracks: both/height: -80, tracks: both/' "$scene" >"$work/hole.scene"
run "$model" "$work/hole.scene" -o "$work/hole.csv" --animate "$work/hole.html"
check 'a run that fails' exits 1
check 'a run that fails has its page up to there' page motion "$work/hole.html" "$work/hole.csv"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
