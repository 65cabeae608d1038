#!/bin/sh
# SPDX-License-Identifier: MIT
# test_identify.sh GICRUN: parameters from measurements, `gicrun --identify` (tests/vehicle/identify.py); what it says and refuses.
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
/usr/bin/python3 -B "$root/tests/vehicle/identify.py" "$gicrun" "$root/models" "$work" >"$work/said" 2>&1
verdict $? "identification"
tail -n 1 "$work/said"

spring=$work/spring.veh # which identify.py left, with a scene
start=$work/start.scene
run -q "$spring" "$start" -o "$work/run.csv"
cut -d, -f1,2 "$work/run.csv" >"$work/m.csv"
run --identify "$work/m.csv" "$spring" "$start" parameter/k -o "$work/a.csv"
check 'a table' prints '^parameter/k .* N/m$'
run --identify "$work/m.csv" "$spring" "$start" parameter/k -o "$work/b.csv"
check 'the same bytes again' cmp "$work/a.csv" "$work/b.csv"
check 'columns' grep -qx 'variable,unit,start,value,deviation,low,high' "$work/a.csv"
run --identify "$work/m.csv" "$spring" "$start" parameter/k initial/x -o "$work/a.html"
drawn() { # a diagram with what was measured, a row for each number
    [ "$(grep -c '<figure>' "$work/a.html")" -eq 1 ] && [ "$(grep -c '<polyline' "$work/a.html")" -eq 2 ] &&
        [ "$(grep -c '<tr><td>' "$work/a.html")" -eq 2 ] && ! grep -q 'nan\|inf' "$work/a.html"
}
check 'a page' drawn
run --identify "$work/m.csv" "$spring" "$start" 'input/push[1]' -o "$work/a.csv"
check 'a number of an input' grep -q '^input/push\[1\],N,20,' "$work/a.csv"

# measurements that the model cannot follow: it comes near somewhere, and that is said; those of its own run: nothing is
run --identify "$work/m.csv" "$spring" "$start" parameter/k
check 'no warning where the model follows' test -z "$(grep 'does not follow' "$work/err")"
awk -F, -v OFS=, 'NR > 1 { $2 = 1000 } { print }' "$work/m.csv" >"$work/far.csv"
run --identify "$work/far.csv" "$spring" "$start" parameter/k
check 'a warning where it does not' says "far.csv:1:10: warning: the model does not follow 'cart.x'"

# ---- what is refused
ends() { exits "$1" && says "$2" && [ ! -e "$work/no.csv" ]; }
mistake() { # STATUS TEXT MEASURED WORD...: said, and no file is left
    wanted=$1
    text=$2
    measured=$3
    shift 3
    run --identify "$measured" "$@" -o "$work/no.csv"
    check "$text" ends "$wanted" "$text"
}
mistake 2 'needs names of what is looked for' "$work/m.csv" "$spring" "$start"
mistake 2 "there is no 'parameter/none'" "$work/m.csv" "$spring" "$start" parameter/none
sed 's/^inputs.*//' "$start" >"$work/free.scene"
mistake 2 "does not find 'input/push'" "$work/m.csv" "$spring" "$work/free.scene" 'input/push'
mistake 2 'no scene given' "$work/m.csv" "$spring"
mistake 2 'does not go with --engine' "$work/m.csv" --engine cc "$spring" "$start" parameter/k
{ cat "$start" && echo 'until: cart.x > 9'; } >"$work/ends.scene"
mistake 1 "error: --identify looks at all times of a run, and 'cart.x > 9' ends it" "$work/m.csv" "$spring" "$work/ends.scene" parameter/k
mistake 1 'No such file' "$work/none.csv" "$spring" "$start" parameter/k
sed '1s/cart.x/cart.w/' "$work/m.csv" >"$work/bad.csv"
mistake 1 "bad.csv:1:10: error: the model has no output 'cart.w'" "$work/bad.csv" "$spring" "$start" parameter/k
sed '1s/\[m\]/[mm]/' "$work/m.csv" >"$work/bad.csv"
mistake 1 'bad.csv:1:' "$work/bad.csv" "$spring" "$start" parameter/k
sed '3s/^[^,]*/0.05/' "$work/m.csv" >"$work/bad.csv"
mistake 1 'bad.csv:3:1: error: 0.05 s is the end of no step' "$work/bad.csv" "$spring" "$start" parameter/k
sed '4s/^[^,]*/0.04/' "$work/m.csv" >"$work/bad.csv"
mistake 1 'bad.csv:4:1: error: 0.04 s does not follow 0.04 s' "$work/bad.csv" "$spring" "$start" parameter/k
head -n 2 "$work/m.csv" >"$work/bad.csv"
mistake 1 '1 measurements do not tell 1 numbers' "$work/bad.csv" "$spring" "$start" parameter/k
cut -d, -f2 "$work/m.csv" >"$work/bad.csv"
mistake 1 'need a column `time`' "$work/bad.csv" "$spring" "$start" parameter/k
sed 's/^initial.*//; s/^inputs.*//' "$start" >"$work/free.scene" # it rests: nothing tells anything
mistake 1 'do not tell parameter/k' "$work/m.csv" "$spring" "$work/free.scene" parameter/k
sed 's/^initial.*/initial: {coordinates: {x: 1}}/; s/^inputs.*//' "$start" >"$work/free.scene" # k, c and m but for a factor
mistake 1 'a combination of what is looked for changes nothing' "$work/m.csv" "$spring" "$work/free.scene" parameter

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
