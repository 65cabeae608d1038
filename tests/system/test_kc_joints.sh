#!/bin/sh
# SPDX-License-Identifier: MIT
# test_kc_joints.sh GICGEN GICRUN: what joints and the steering carry, `gicrun --kc --joints`. Axles against the equilibrium
# of all bodies by themselves, an upright from hard points, levers in nice numbers (tests/vehicle/joints.py); axles on rubber by a static
# solution and on paper (tests/vehicle/joints_rubber.py); axles that have no such numbers; the page; two models.
gicgen=$1
gicrun=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
models=$root/models
/usr/bin/python3 -B "$root/tests/vehicle/joints.py" "$gicgen" "$gicrun" "$models" "$work" >"$work/said" 2>&1
verdict $? 'the equilibrium of all bodies'

# the pads are those of --kc, what hangs on them is there: of a single arm without springs beside it 1 kN is 1 kN
run --kc --joints --axle rear "$models/trailing_arm.veh"
check 'a table' exits 0
check 'the hinge of a trailing arm takes what its pad gives' prints 'arm_r_l  *[0-9.]*  *1000.0000  *1000.0000'
check 'what stops it is told' prints 'rear, steer: not possible'
# a joint that has the name of the steering is another row, and another diagram
mkdir "$work/m" && cp -r "$models/." "$work/m" && sed 's/^  column: /  steering: /' "$models/formula_student.veh" >"$work/m/named.veh"
for of in formula_student named; do
    run --kc --joints --axle front "$work/m/$of.veh" --report "$work/$of.html" -o "$work/$of.csv"
    check "$of: exits" exits 0
done
check 'the joint has a row' sh -c "run() { '$gicrun' --kc --joints --axle front '$work/m/named.veh'; }; run | grep -qE '^  steering  ' && run | grep -qE '^  steering: steering  '"
check 'each a diagram' sh -c "[ \$(grep -cE '<figcaption>(steering|steering: steering), N' '$work/named.html') -eq 6 ]"
same_numbers() { sed 's/"//g' "$work/$1.csv" | sed 1d | cut -d, -f2-; }
check 'with the same numbers' [ "$(same_numbers formula_student)" = "$(same_numbers named)" ]
run --kc --joints "$models/motorcycle.veh"
check 'one wheel behind the other' exits 0
run --kc --joints "$models/semitrailer.veh" --axle axle_3 -q -o "$work/truck.csv"
check 'dual wheels' exits 0
check 'other axles are left out' sh -c "head -1 '$work/truck.csv' | grep -q 'drive_2_low_l' && ! head -1 '$work/truck.csv' | grep -q drive_1"

/usr/bin/python3 -B "$root/tests/vehicle/joints_rubber.py" "$gicgen" "$gicrun" "$models" "$work" >"$work/said" 2>&1
verdict $? 'axles on rubber'
sed 's/stiffness: \[2e5, 2e5, 1e5, 25000, 50000, 12500\]/force: ["-1e5 * dx^3", 0, 0]/' "$work/one_bushing_joints.veh" >"$work/formula.veh"
run --kc --joints "$work/formula.veh" -o "$work/rubber.csv"
check 'rubber with a formula' exits 1
check 'it is named' says 'has a formula, of which no stiffness is known'
check 'no file' [ ! -e "$work/rubber.csv" ]
run --kc --joints "$models/pendulum.veh"
check 'no wheels' exits 1
for words in '--kc --loads --joints' '--joints' '--sheet --joints'; do
    # shellcheck disable=SC2086 # words
    run $words "$models/hmmwv.veh"
    check "$words" exits 2
done

run --kc --joints --axle front "$models/formula_student.veh" -q --report "$work/a.html" -o "$work/a.csv"
check 'the page' exits 0
run --kc --joints --axle front "$models/formula_student.veh" -q --report "$work/b.html"
check 'the same page again' cmp "$work/a.html" "$work/b.html"
check 'no curve has something else than numbers' sh -c "! grep -qiE '[^a-z](nan|inf)[^a-z]' '$work/a.html' '$work/a.csv'"
check 'curves' [ "$(grep -c '<polyline' "$work/a.html")" -gt 150 ]
check 'the rod is there' grep -q 'front_link_l, N' "$work/a.html"
check 'and the torque that steers' grep -q 'steering, N m' "$work/a.html"

run --kc --joints --axle front --compare "$models/hmmwv.veh" "$models/hmmwv.veh"
check 'a vehicle beside itself' sh -c "grep -q 'tierod_f_l: lateral' '$work/out' && ! grep -q '\*$' '$work/out'"
run --kc --joints --axle front --compare "$models/hmmwv14.veh" "$models/hmmwv.veh" -o "$work/both.csv"
check 'two vehicles' grep -q '^front.rack.aligning,[0-9.e+-]*,1/m,[0-9.e+-]*,' "$work/both.csv"
run --kc --joints --axle front --compare "$models/hmmwv14.veh" "$models/hmmwv.veh" --report "$work/both.html"
check 'their page' exits 0
check 'differences are marked' grep -q '<tr class="differs">' "$work/both.html"
sed -n '/front: Steering/,/<.figure>/p' "$work/both.html" | grep '<polyline' >"$work/lines"
check 'six loads of both' [ "$(wc -l <"$work/lines")" -ge 12 ]
check 'half of them dashed' [ "$(grep -c dasharray "$work/lines")" -ge 6 ]
check 'a joint that one of them has' [ "$(grep -c '<figcaption>knee_f_l, N' "$work/both.html")" -eq 3 ]
check 'no curve has something else than numbers' sh -c "! grep -qiE '[^a-z](nan|inf)[^a-z]' '$work/both.html'"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -ge 29 ]
