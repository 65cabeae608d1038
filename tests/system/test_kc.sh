#!/bin/sh
# SPDX-License-Identifier: MIT
# test_kc.sh GICGEN GICRUN: kinematics of axles, `gicrun --kc`. Double wishbones, five links, a solid axle and an axle
# with other hard points on one side against an independent solution (tests/vehicle/kinematics.py, to 1e-12); planar
# mechanisms and sliding pillars against constructions by hand (planar_axles.py); a vehicle against its mirror image;
# steering in nice numbers; what can't be moved; the page.
gicgen=$1
gicrun=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
models=$root/models
python() { /usr/bin/python3 -B "$@" >"$work/said" 2>&1; }

# other hard points on one side
one_sided() {
    printf 'gicgen: 1\nmodel: one_sided\ninclude: %s/hmmwv.veh\npoints:\n' "$models"
    case $1 in
    left)
        echo '  tierod_u_f_l: [1.42, 0.7, 0.51]'
        echo '  upper_u_f_l: [1.60, 0.73, 0.69]'
        echo '  tierod_u_f_r: [1.5131462, -0.8211058, 0.4576678]' # those of chassis.veh
        echo '  upper_u_f_r: [1.6359298, -0.715518, 0.6894936]'
        ;;
    right)
        echo '  tierod_u_f_r: [1.42, -0.7, 0.51]'
        echo '  upper_u_f_r: [1.60, -0.73, 0.69]'
        ;;
    esac
}
one_sided left >"$work/left.veh"
one_sided right >"$work/right.veh"

for axle in "$models/hmmwv.veh front" "$models/hmmwv14.veh front" "$models/hmmwv14.veh rear" "$models/five_link.veh rear" \
    "$models/solid_axle.veh rear" "$work/left.veh front"; do
    # shellcheck disable=SC2086  # a model and an axle
    check "the independent solution of $axle" python "$root/tests/vehicle/kinematics.py" "$gicgen" "$gicrun" $axle
done
check 'axles on rubber, and a trailer' python "$root/tests/vehicle/rubber_and_units.py" "$gicrun" "$work"
check 'corners from their hard points, by scipy' python "$root/tests/vehicle/corners.py" "$gicrun" "$models"
check 'planar axles by hand' python "$root/tests/vehicle/planar_axles.py" "$gicrun" "$work"

check 'compliance by an independent solution, in closed form and mutual' python "$root/tests/vehicle/compliance.py" "$gicgen" \
    "$gicrun" "$models" "$work"
check 'compliance on rubber: on paper, by statics, mutual' python "$root/tests/vehicle/compliance_rubber.py" "$gicgen" "$gicrun" \
    "$models" "$work"
run --kc --loads "$models/hmmwv_vehicle.veh"
check 'an axle whose rack is driven does not give way' exits 0
run --kc --loads "$work/left.veh"
check 'a one-sided axle settles first' exits 0

for side in left right; do
    run --kc "$work/$side.veh" -q -o "$work/$side.csv"
    check "other hard points on the $side" exits 0
done
check 'the mirror image' python "$root/tests/vehicle/mirrored_axles.py" "$work/left.csv" "$work/right.csv"

# a vertical kingpin through the wheel's centre, a lever of 0.12 m behind it: the rack moves 0.12 m a radian
cell() { awk -F, -v want="$1" -v motion="$2" -v at="$3" 'NR == 1 {for (i = 1; i <= NF; ++i) {sub(/ \[.*/, "", $i); c[$i] = i}}
    $1 == "front" && $2 == motion && $c["rack"] == at && $c["travel"] == 0 {print $c[want]; exit}' "$work/steering.csv"; }
run --kc "$models/tutorial/6_steering.veh" -q -o "$work/steering.csv"
check 'steering runs' exits 0
near() { awk -v x="$(cell "$1" "$2" "$3")" -v y="$4" 'BEGIN {d = x - y; exit !(x != "" && d * d < 1e-24)}'; }
check 'steering ratio' near steering_ratio steer 0 -0.12
for name in kingpin_inclination caster scrub_radius caster_trail kingpin_offset caster_offset camber toe steer; do
    check "$name of the vertical kingpin" near "front_tire_l.$name" steer 0 0
done

# without steering, without wheels, without suspension; wrong words
run --kc --axle rear "$models/hmmwv.veh"
check 'an axle without steering is told' prints 'rear, steer: not possible: no coordinate turns its wheels'
check 'and the rest is there' prints 'Roll rate'
run --kc --axle rear "$models/solid_axle.veh"
check 'where wheels stop, by name' prints 'tire_r_l, tire_r_r stop at a travel of -74.55 mm: coordinate .spring_r_l.'
run --kc --axle 2 "$models/hmmwv.veh" -o "$work/two.csv"
run --kc --axle rear "$models/hmmwv.veh" -o "$work/rear.csv"
check 'axles by number' cmp "$work/two.csv" "$work/rear.csv"
run --kc --axle middle "$models/hmmwv.veh"
check 'no such axle' exits 1
check 'its axles are named' says 'its axles are: front, rear'
printf '%s\n' 'gicgen: 1' 'model: soft' "include: $models/hmmwv.veh" 'forces:' \
    '  mount: {type: bushing, bodies: [chassis, rack], point: [1.4, 0, 0.5], stiffness: [1, 1, 1, 1, 1, 1]}' >"$work/soft.veh"
run --kc "$work/soft.veh"
check 'bushings are left out' says "bushing 'mount' is left out of forces"
run --kc --axle rear "$models/hatchback.veh"
check 'all of them at once' says "10 bushings, 'frame_l', .*, are left out of forces"
check 'and that once' [ "$(grep -c 'warning' "$work/err")" -eq 1 ]
run --kc "$models/pendulum.veh"
check 'no wheels' exits 1
check 'no wheels, said' says 'has no wheels, and so no axles'
printf '%s\n' 'gicgen: 1' 'model: cart' 'base: cart' 'bodies:' '  cart: {mass: 9, com: [0, 0, 1], inertia: [1, 1, 1]}' \
    'wheels:' '  wheel: {body: cart, center: [0, 0, 0.3], radius: 0.3, stiffness: 1000}' >"$work/cart.veh"
run --kc "$work/cart.veh" -o "$work/cart.csv"
check 'no suspension' exits 1
check 'no suspension, said' says 'no coordinate moves its wheels up and down'
check 'and no file' [ ! -e "$work/cart.csv" ]
for words in '--axle front' '--travel 0.1' '--report x.html' '--loads'; do
    # shellcheck disable=SC2086  # words
    run $words "$models/hmmwv.veh" "$models/scenes/paper_run.scene"
    check "$words without --kc" exits 2
done
for words in '--travel 0' '--travel x' '--report x.pdf' '--modes' '-o x.html'; do
    # shellcheck disable=SC2086
    run --kc $words "$models/hmmwv.veh"
    check "--kc $words" exits 2
done

# the page is complete in itself, has curves and no number that is none, and is the same each time
run --kc "$models/five_link.veh" --report "$work/kc.html"
check 'the page' exits 0
run --kc "$models/five_link.veh" --report "$work/again.html"
check 'the same page again' cmp "$work/kc.html" "$work/again.html"
check 'nothing is loaded' sh -c "! grep -qE 'https?:|src=|@import|url\(' '$work/kc.html'"
check 'no curve has something else than numbers' sh -c "! grep -qiE '[^a-z](nan|inf)[^a-z]' '$work/kc.html'"
check 'curves' [ "$(grep -c '<polyline' "$work/kc.html")" -gt 150 ]
check 'what stops is on the page' grep -q 'stop at a travel of -58.97 mm' "$work/kc.html"

# each column of the files has its figure: drawn as committed, on the page and in models/KC.md
check 'figures are as they are drawn' python "$root/tests/tools/kc_figures.py" "$root" --check
run --kc --axle front "$models/hmmwv_vehicle.veh" -q -o "$work/columns.csv" --report "$work/figures.html"
head -1 "$work/columns.csv" | tr , '\n' | sed 's/ \[.*//' | sed -e '1,2d' -e '4d' -e 's/^.*\.ratio\..*/motion_ratio/' -e 's/^.*\.//' | sort -u >"$work/columns"
check 'columns are there' [ "$(wc -l <"$work/columns")" -gt 36 ]
without=
while read -r column; do
    grep -q "<figcaption>$column</figcaption>" "$work/figures.html" && grep -q "(kc/$column.svg)" "$models/KC.md" &&
        grep -q "<title>$column</title>" "$models/kc/$column.svg" || without="$without $column"
done <"$work/columns"
check "each column has a figure:$without" [ -z "$without" ]
run --kc --loads --axle front "$models/hmmwv_vehicle.veh" -q -o "$work/loads.csv"
for column in $(head -1 "$work/loads.csv" | tr , '\n' | sed 1,5d | grep -v '^force$'); do
    check "compliance: $column has a figure" grep -q "[> ]${column}[,< ]" "$models/kc/gives.svg"
done

# two vehicles at set-up: one beside itself has no differences; numbers are those of the rows at travel 0
run --kc --compare "$models/hmmwv.veh" "$models/hmmwv.veh"
check 'a vehicle beside itself' sh -c "test -s '$work/out' && ! grep -q '\*$' '$work/out'"
run --kc --compare "$models/five_link.veh" "$models/hmmwv.veh" -o "$work/both.csv"
check 'two vehicles' exits 0
run --kc --axle front "$models/five_link.veh" -q -o "$work/rows.csv"
beside() { awk -F, 'NR == FNR {if (FNR == 1) for (i = 1; i <= NF; ++i) {split($i, h, " "); name[i] = h[1]}
    else if ($2 == "parallel" && $3 ^ 2 < 1e-24) for (i = 1; i <= NF; ++i) at[name[i]] = $i; next}
    FNR > 1 && $1 in at {n += 1; e += at[$1] != $4} END {exit !(n > 20 && !e)}' "$work/rows.csv" "$work/both.csv"; }
check 'the other one has its numbers' beside
sed 's/stiffness: \[1, 1, 1, 1, 1, 1\]/force: ["-1e5 * dx^3", 0, 0]/' "$work/soft.veh" >"$work/formula.veh"
run --kc --loads --axle front "$work/formula.veh" -q -o "$work/rubber.csv"
check 'no compliance with a formula of rubber' exits 1
check 'its bushing is named' says "has a compliance: front: bushing 'mount' has a formula, of which no stiffness is known"
check 'no file' [ ! -e "$work/rubber.csv" ]
printf '%s\n' 'gicgen: 1' 'model: loose' 'base: car' 'bodies:' '  car: {mass: 9, com: [0, 0, 1], inertia: [1, 1, 1]}' \
    '  hub: {mass: 9, com: [0, 0, 0.3], inertia: [1, 1, 1]}' 'joints:' '  slide: {type: prismatic, bodies: [car, hub], axis: [0, 0, 1]}' \
    'coordinates:' '  rise: {type: translation, bodies: [car, hub], axis: [0, 0, 1], range: [-0.1, 0.1]}' \
    'wheels:' '  wheel: {body: hub, center: [0, 0, 0.3], radius: 0.3, stiffness: 1000}' >"$work/loose.veh"
run --kc --loads "$work/loose.veh"
check 'what nothing holds under a vertical load is told' prints 'vertical: nothing holds a coordinate'
# two that call their wheels differently, two settings of one, compliance; the page
column() { awk -F, -v want="$2" 'NR == 1 {for (i = 1; i <= NF; ++i) {split($i, h, " "); if (h[1] == want) c = i}}
    NR > 1 && $2 == "parallel" && $3 ^ 2 < 1e-24 {print $c; exit}' "$1"; }
compared() { awk -F, -v want="$2" -v c="$3" '$1 == want {print $c}' "$1"; }
same() { [ -n "$1" ] && [ "$1" = "$2" ]; }
run --kc --axle front --compare "$models/hmmwv.veh" "$models/formula_student.veh" -o "$work/two.csv" --report "$work/two.html"
check 'wheels of other names' exits 0
run --kc --axle front "$models/hmmwv.veh" -q -o "$work/b.csv"
run --kc --axle front "$models/formula_student.veh" -q -o "$work/a.csv"
for quantity in camber_rate caster scrub_radius wheel_rate; do
    check "$quantity of this one" same "$(compared "$work/two.csv" "front_tire_r.$quantity" 2)" "$(column "$work/a.csv" "front_tire_r.$quantity")"
    check "$quantity of the other" same "$(compared "$work/two.csv" "front_tire_r.$quantity" 4)" "$(column "$work/b.csv" "tire_f_r.$quantity")"
done
check 'what only the other has' grep -q '^tire_f_l.ratio.spring_f_l,,1,-' "$work/two.csv"
check 'the page has both' sh -c "grep -q 'class=\"differs\"' '$work/two.html' && grep -q 'formula_student and hmmwv' '$work/two.html'"
check 'both are drawn' [ "$(grep -c '<polyline.*dasharray' "$work/two.html")" -gt 40 ]
check 'with numbers alone' sh -c "! grep -qiE '[^a-z](nan|inf)[^a-z]' '$work/two.html'"
printf '%s\n' 'gicscene: 1' 'duration: 1' 'step: 0.001' 'parameters: {bar_front: 0}' >"$work/soft.scene"
run --kc --axle front --compare "$work/soft.scene" "$models/formula_student.veh" -o "$work/two.csv"
check 'two settings' exits 0
run --kc --axle front "$models/formula_student.veh" "$work/soft.scene" -q -o "$work/b.csv"
check 'roll rate of this one' same "$(compared "$work/two.csv" front.roll_rate 2)" "$(column "$work/a.csv" roll_rate)"
check 'roll rate of the other' same "$(compared "$work/two.csv" front.roll_rate 4)" "$(column "$work/b.csv" roll_rate)"
run --kc --axle front --compare "$work/soft.scene" "$models/formula_student.veh"
check 'its name' prints 'formula_student and formula_student with soft.scene'
check 'the roll rate alone differs' [ "$(grep '\*$' "$work/out" | grep -vc 'Roll rate')" -eq 0 ]
# what can not be printed is told
"$gicrun" --kc --axle front "$models/formula_student.veh" >/dev/full 2>"$work/err"
check 'a full standard output' [ $? -eq 1 ]
check 'is told' says "standard output can't be written"

# compliance as a page: a line a load and wheel, a bar a vehicle in each cell, numbers as in the table; axles without one are told
run --kc --loads --axle rear "$models/hatchback.veh" --report "$work/loads.html"
check 'the page of compliance' exits 0
check 'has a line a load and wheel' sh -c "grep -c '<tr><td>' '$work/loads.html' | grep -qx 28"
run --kc --loads --axle rear --compare "$models/hmmwv.veh" "$models/hatchback.veh" --report "$work/loads.html"
check 'that of two' exits 0
check 'has a bar a vehicle' sh -c "grep -o '<rect' '$work/loads.html' | wc -l | grep -qx 280"
run --kc --loads --axle rear --compare "$models/hmmwv.veh" "$models/hatchback.veh"
check 'and their numbers' sh -c "awk '/  lateral: toe, / { print \$(NF - 2 + (\$NF != \"*\")); exit }' '$work/out' | grep -qxF \"\$(sed -n 's/^<tr[^>]*><td>lateral<.td><td>[^<]*<.td><td class=.n.>\\([^<]*\\)<br>.*/\\1/p' '$work/loads.html' | head -1)\""
run --kc --loads --axle rear "$models/hatchback.veh"
check 'an aligning torque of 100 N m in both' sh -c "toe=\$(awk '\$1 == \"aligning\" && \$2 != \"opposed\" { print \$3; exit }' '$work/out') && grep -qF \"<td>aligning</td><td>rear_l</td><td class=\\\"n\\\">\$toe<br>\" '$work/loads.html'"
run --kc --loads "$models/motorcycle.veh" -o "$work/loads.csv"
check 'an axle without compliance is told beside CSV' says 'compliance of axle front: nothing holds a coordinate that moves its wheels'
# a beam that rocks on a slider, with a wheel 0.5 m ahead and one behind: it is free, which is told, and stays
cat >"$work/bogie.veh" <<'EOF'
gicgen: 1
model: bogie
base: body
bodies:
  body: {mass: 1000, com: [0, 0, 0.5], inertia: [500, 1500, 1500]}
  slider_l: {mass: 10, com: [-1, 0.7, 0.3], inertia: [1, 1, 1]}
  beam_l: {mass: 60, com: [-1, 0.7, 0.3], inertia: [5, 20, 20]}
  front_l: {mass: 10, com: [1, 0.7, 0.3], inertia: [1, 1, 1]}
joints:
  slider_l: {type: prismatic, bodies: [body, slider_l], axis: [0, 0, 1]}
  beam_l: {type: revolute, bodies: [slider_l, beam_l], point: [-1, 0.7, 0.3], axis: [0, 1, 0]}
  front_l: {type: prismatic, bodies: [body, front_l], axis: [0, 0, 1]}
coordinates:
  slider_l: {type: translation, bodies: [body, slider_l], axis: [0, 0, 1], range: [-0.1, 0.1]}
  beam_l: {type: angle, bodies: [slider_l, beam_l], axis: [0, 1, 0], range: [-0.3, 0.3]}
  front_l: {type: translation, bodies: [body, front_l], axis: [0, 0, 1], range: [-0.1, 0.1]}
forces:
  slider_l: {type: spring_damper, coordinate: slider_l, stiffness: 40000, damping: 4000, free: -0.06}
  front_l: {type: spring_damper, coordinate: front_l, stiffness: 20000, damping: 2000, free: -0.12}
wheels:
  front_l: {body: front_l, center: [1, 0.7, 0.3], radius: 0.3, stiffness: 200000, damping: 100}
  second_l: {body: beam_l, center: [-0.5, 0.7, 0.3], radius: 0.3, stiffness: 200000, damping: 100}
  third_l: {body: beam_l, center: [-1.5, 0.7, 0.3], radius: 0.3, stiffness: 200000, damping: 100}
EOF
run --kc "$work/bogie.veh" -q -o "$work/bogie.csv"
check 'a bogie' exits 0
check 'its free beam is told' says "axle rear: no force element holds coordinate 'beam_l', which moves its wheels up and down"
check 'of the axle in front nothing' sh -c "! grep -q 'axle front' '$work/err'"
# drawn 9 m aside, left is left
plain=$root/tests/data/manoeuvre/plain.veh
sed 's/, 0.7, /, 9.7, /g; s/, -0.7, /, 8.3, /g; s/\[0, 0, 0.5\]/[0, 9, 0.5]/g' "$plain" >"$work/aside.veh"
run --kc "$plain" -o "$work/drawn.csv"
run --kc "$work/aside.veh" -o "$work/aside.csv"
drawn_aside() { awk -F, 'FNR == 1 { for (i = 1; i <= NF; ++i) { moved[i] = $i ~ /contact_y|roll_centre_y/; rolls = rolls || $i ~ /roll_rate/ } next } NR == FNR { for (i = 1; i <= NF; ++i) v[FNR, i] = $i; next }
    { for (i = 1; i <= NF; ++i) if (!moved[i]) { d = $i - v[FNR, i]; ++n; bad += !($i == v[FNR, i] || d * d < 1e-18 * (1 + $i * $i)) } } END { exit !(n > 1000 && rolls && !bad) }' "$work/drawn.csv" "$work/aside.csv"; }
check 'a vehicle that is drawn aside' drawn_aside

# one axle is the foremost and the rearmost one, and stands beside that of a vehicle
sed '/^  r_/d; /rear/d' "$root/tests/data/manoeuvre/bar.veh" >"$work/single.veh"
run --kc --axle front --compare "$work/single.veh" "$root/tests/data/manoeuvre/bar.veh"
check 'one axle beside one of two' exits 0
check 'is the same there' sh -c "grep -q '^  Camber, f_wheel_l .* 0.0000 *0.0000$' '$work/out' && ! grep -q 'Only' '$work/out'"

run --kc --loads --axle rear --compare "$models/hmmwv.veh" "$models/hatchback.veh" -o "$work/two.csv"
run --kc --loads --axle rear "$models/hatchback.veh" -o "$work/a.csv"
check 'compliance of two' same "$(compared "$work/two.csv" rear_l.lateral.opposed.contact_x 2)" \
    "$(awk -F, '$2 == "lateral" && $3 == 1 && $4 == "rear_l" {print $10}' "$work/a.csv")"
run --kc --loads --axle rear --compare "$models/hatchback.veh" "$models/hatchback.veh"
check 'compliance beside itself' sh -c "grep -q 'lateral, opposed: toe' '$work/out' && ! grep -q '\*$' '$work/out'"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -ge 80 ]
