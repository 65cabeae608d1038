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
check 'a run that fails' exits 0
check 'is told' says 'no results with ay = 14: '
check 'and has empty cells' grep -qE '^1,14(,)+$' "$work/some.csv"
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
    'bar_front=0:1:2 --loads' "bar_front=0:1:2 --compare $models/hmmwv.veh" 'bar_front=0:1:2 -o page.html'; do
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
[ "$failed" -eq 0 ] && [ "$passed" -ge 34 ]
