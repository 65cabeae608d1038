#!/bin/sh
# SPDX-License-Identifier: MIT
# test_study.sh GICGEN GICRUN: studies over what is varied, `gicrun --vary`: each run against the study of a file that has
# its numbers (tests/vehicle/study.py); runs that fail; the page; wrong words.
gicrun=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
models=$root/models
linear=$root/tests/data/manoeuvre/linear.veh
PATH=/usr/bin:$PATH
check 'runs are studies of files with their numbers' /usr/bin/python3 -B "$root/tests/vehicle/study.py" "$gicrun" "$models" \
    "$root/tests/data" "$work"

run --kc --axle front "$models/formula_student.veh" --vary f_upper_out_l.z=0.27:0.29:3 --report "$work/page.html"
check 'the page' exits 0
run --kc --axle front "$models/formula_student.veh" --vary f_upper_out_l.z=0.27:0.29:3 --report "$work/again.html"
check 'the same page again' cmp "$work/page.html" "$work/again.html"
check 'nothing is loaded' sh -c "! grep -qE 'https?:|src=|@import|url\(' '$work/page.html'"
check 'no number is none' sh -c "! grep -qiE '[^a-z](nan|inf)[^a-z]' '$work/page.html'"
check 'numbers over the point' grep -q 'f_upper_out_l.z, m' "$work/page.html"
check 'families' grep -q '<h2>front: Opposite travel</h2>' "$work/page.html"
check 'a family has a curve a run' sh -c "sed -n '/front: Parallel travel/,/<.figure>/p' '$work/page.html' | grep -c '<polyline' | grep -qx 3"
run --kc --axle front "$models/formula_student.veh" --vary f_upper_out_l.z=0.27:0.29:2 --vary f_upper_in_l.z=0.25:0.26:6 \
    --report "$work/page.html"
check 'more runs than colors' grep -q 'Families show 8 runs' "$work/page.html"
check 'a curve over the last one for each value of the others' grep -q 'f_upper_out_l.z = 0.29</span> <div' "$work/page.html"

# what does not change is left out of the table; a run that fails leaves others alone
run --kc "$models/formula_student.veh" --vary bar_front=0:50:2
check 'a table' prints 'Roll rate'
check 'without what does not change' sh -c "! grep -q Camber '$work/out'"
run --manoeuvre step-steer "$linear" --vary ay=2:14:2 -o "$work/some.csv"
check 'a run that fails' exits 1
check 'is told' says '1 of 2 runs has no results, the first with ay = 14: '
check 'and has empty cells' grep -qE '^1,14(,)+$' "$work/some.csv"
check 'the other one is there' grep -qE '^0,2,[0-9]' "$work/some.csv"
run --manoeuvre step-steer "$linear" speed=16 --vary ay=2:4:3 -q --report "$work/page.html" -o "$work/three.csv"
check 'a manoeuvre over what is varied' exits 0
check 'the page names manoeuvre and keys' grep -q '^<p>Step of the steering: speed=16\. ' "$work/page.html"
titles() { sed '/<h2>left/,$d' "$work/page.html" | grep -o '<figcaption>[^<]*'; }
check 'numbers of left and right have diagrams' [ "$(titles | wc -l)" -gt 3 ]
check 'no two of them one title' [ -z "$(titles | sort | uniq -d)" ]
run --sheet "$models/formula_student.veh" --vary bar_front=-2000:-50:2 --vary bar_rear=-70:70:2 -q
check 'no sheet at all' exits 1
run --kc "$models/formula_student.veh" --vary bar_front=-50:50:3 --report "$work/page.html"
check 'the page of a run that fails' exits 1
check 'says why' grep -q 'No results: with bar_front = -50: stiffness of force' "$work/page.html"
check 'and has a mark in the table' grep -q '<td class="n">failed</td><td class="n">[0-9]' "$work/page.html"
run --kc "$models/formula_student.veh" --vary bar_front=-50:50:3
check 'the table of a run that fails' exits 1
check 'says why' prints 'No results: with bar_front = -50: stiffness of force'
check 'and has the others' prints 'Roll rate .* failed  *[0-9]'
run --kc "$models/formula_student.veh" --vary bar_front=-50:50:2 -q
check 'one run with results' prints 'Camber, front_tire_l .* failed  *[0-9-]'
check 'quiet: the error alone' sh -c "! grep -q note: '$work/err'"

# a bar acts on the roll of the vehicle and on no heave: by its shape roll is motion 1 in all runs, though heave is slower with a
# stiff bar; all runs have the motions of their own sheets
bar=$root/tests/data/manoeuvre/bar.veh
run --sheet "$bar" --vary bar=0:20000:3 -q -o "$work/bars.csv"
followed() { awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) { sub(/ .*/, "", $i); at[$i] = i } next } { n = NR - 1; roll[n] = $at["mode_1.frequency"]; heave[n] = $at["mode_2.frequency"] }
    END { d = heave[3] / heave[1] - 1; exit !(roll[1] + 0.01 < roll[2] && roll[2] + 0.01 < roll[3] && roll[1] < heave[1] && heave[3] < roll[3] && d * d < 1e-12) }' "$work/bars.csv"; }
check 'roll and heave keep their numbers' followed
sed 's/value: 10000/value: 20000/' "$bar" >"$work/stiff.veh"
run --sheet "$work/stiff.veh" -q -o "$work/stiff.csv"
same_motions() { awk -F, 'FNR == 1 && NR > 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^mode_.*frequency/) of[i]; next } NR == FNR { if ($1 ~ /^mode_.*frequency/) own[++n] = $2; next } FNR == 4 {
    for (i in of) if ($i != "") { ++m; best = 1; for (k in own) { d = ($i / own[k] - 1) ^ 2; best = d < best ? d : best } bad += best > 1e-12 } }
    END { exit !(n > 5 && m == n && !bad) }' "$work/stiff.csv" "$work/bars.csv"; }
check 'the stiffest run has the motions of its sheet' same_motions

# compliance, joints, two vehicles, as tables and pages
run --kc --loads --axle front "$models/formula_student.veh" --vary f_upper_out_l.z=0.27:0.29:3 --report "$work/page.html"
check 'the page of compliance' grep -q '<figcaption>vertical: toe, front_tire_l, deg/kN' "$work/page.html"
run --kc --joints --axle front "$models/formula_student.veh" --vary f_upper_out_l.z=0.27:0.29:3 --report "$work/page.html"
check 'the page of joints' grep -q '<h2>front: Steering, by lateral</h2>' "$work/page.html"
check 'a family has a curve a run' sh -c "sed -n '/front: Steering, by lateral/,/<.figure>/p' '$work/page.html' | grep -c '<polyline' | grep -qx 3"
check 'no number is none' sh -c "! grep -qiE '[^a-z](nan|inf)[^a-z]' '$work/page.html'"
run --kc --joints --axle front "$models/formula_student.veh" --vary f_upper_out_l.z=0.27:0.29:3
check 'the table of joints' prints '1/m '
run --kc --axle front "$models/hmmwv.veh" --vary upper_u_f_l.z=0.67:0.71:3 --compare "$models/formula_student.veh" --report "$work/page.html"
check 'two vehicles' exits 0
check 'the second one does not have that point' says "formula_student has no 'upper_u_f_l.z', which changes nothing of it"
check 'both vehicles in a family' sh -c "sed -n '/front: Parallel travel/,/<.figure>/p' '$work/page.html' | grep -c '<polyline' | grep -qx 6"
check 'three of them dashed' sh -c "sed -n '/front: Parallel travel/,/<.figure>/p' '$work/page.html' | grep -c dasharray | grep -qx 3"
check 'differences are marked' grep -q '<td class="n differs">' "$work/page.html"
run --kc --axle front "$models/hmmwv.veh" --vary upper_u_f_l.z=0.67:0.71:2 --compare "$models/hmmwv_full.veh"
check 'the table of two' prints '  of hmmwv_full .*[0-9][*]'
run --kc "$models/formula_student.veh" --vary bar_front=-50:50:2 --compare "$models/hatchback.veh" -o "$work/both.csv"
check 'one of two fails' exits 1
check 'it is named' says 'the first formula_student with bar_front = -50: '
check 'the other one stays' sh -c "tail -n 2 '$work/both.csv' | head -n 1 | grep -qE '^0,-50,,[0-9-]'"
run --manoeuvre step-steer "$linear" --vary ay=14:14.5:2 -o "$work/none.csv"
check 'no run has results' exits 1
check 'the reason' says 'no step of the steering ends in\|tips over'
check 'and no file' [ ! -e "$work/none.csv" ]

# ---- wrong words
run --kc "$models/formula_student.veh" --vary f_upper_out_r.z=0.27:0.29:3
check 'the image follows' exits 1
check 'it is named' says "no coordinate of a point 'f_upper_out_r.z'"
check 'and what it follows' says "did you mean 'f_upper_out_l.z'"
run --kc "$models/formula_student.veh" --vary f_upper_out_l.w=0.27:0.29:3
check 'no such axis' exits 1
for words in 'f_upper_out_l.z=1' 'x=1:2:0' 'bar_front=0:1' 'bar_front=0:1:2 --vary bar_front=0:1:2' 'bar_front=0:1:1000 --vary bar_rear=0:1:1000' \
    'bar_front=0:1:2 --loads --joints' 'bar_front=0:1:2 --trace x.csv' 'bar_front=0:1:2 -o page.html'; do
    # shellcheck disable=SC2086 # words
    run --kc "$models/formula_student.veh" --vary $words
    check "--vary $words" exits 2
done
run "$models/formula_student.veh" "$models/scenes/formula_student_skid_pad.scene" --vary bar_front=0:1:2
check '--vary of a scene' exits 2
check 'is gicsweep' says 'scenes are varied by gicsweep'
run --sheet "$models/formula_student.veh" --report "$work/x.html"
check '--report of a sheet' exits 2
run --manoeuvre step-steer "$linear" speed=20 --vary speed=10:20:2
check 'a key twice' says "'speed' is given twice"
check 'a key twice, status' exits 2

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -ge 59 ]
