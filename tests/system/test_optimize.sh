#!/bin/sh
# SPDX-License-Identifier: MIT
# test_optimize.sh GICRUN: numbers that bring formulas near 0, `gicrun --optimize` (tests/vehicle/optimize.py); what it says,
# draws and refuses.
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
/usr/bin/python3 -B "$root/tests/vehicle/optimize.py" "$gicrun" "$root/models" "$work" >"$work/said" 2>&1
verdict $? "optimization"
cat "$work/said"

corner=$root/models/optimize/corner.veh
travel=$root/models/optimize/corner.scene
run --optimize wheel.yaw "$corner" "$travel" parameter/link_in_z=0.13:0.14 -o "$work/a.csv"
check 'a table' prints '^parameter/link_in_z .* m$'
check 'what was reached' prints '^corner: root mean square of wheel.yaw from 0.000676358 to '
run --optimize wheel.yaw "$corner" "$travel" parameter/link_in_z=0.13:0.14 -o "$work/b.csv"
check 'the same bytes again' cmp "$work/a.csv" "$work/b.csv"
check 'columns' grep -qx 'variable,unit,start,value,low,high' "$work/a.csv"
run --optimize 'wheel.yaw; 0.1 * (wheel.roll + 0.1)' "$corner" "$travel" parameter/link_in_z=0.13:0.14 parameter/link_in_y=0.219:0.23 -o "$work/a.html"
drawn() { # a diagram for each formula with two curves, a row for each number
    [ "$(grep -c '<figure>' "$work/a.html")" -eq 2 ] && [ "$(grep -c '<polyline' "$work/a.html")" -eq 4 ] &&
        [ "$(grep -c '<tr><td>parameter/' "$work/a.html")" -eq 2 ] && ! grep -q 'nan\|inf' "$work/a.html"
}
check 'a page' drawn
check 'a bound' prints '^parameter/link_in_y .* m, at a bound$'
run --optimize 'maximum(wheel.yaw)' "$corner" "$travel" parameter/link_in_z=0.13:0.14
check 'a largest magnitude' prints '^corner: largest magnitude of wheel.yaw from 0.0011283 to '

# a start at which nothing can be known: where a square is least, what is left is most
flat=$work/flat.veh
sed 's/^parameters:/&\n  flat: {value: 0, unit: "1", tunable: true}\n  idle: {value: 0, unit: "1", tunable: true}/' "$corner" >"$flat"
grep -q '^  flat:' "$flat" || echo "FAILED: parameters of $corner"
run --optimize 'flat^2 - 4' "$flat" "$travel" parameter/flat=-5:5
check 'a largest value' says 'parameter/flat does not move the formulas at 0: it has no influence, or a largest value is there'
run --optimize 'flat - 4' "$flat" "$travel" parameter/flat=-5:5
check 'it moves them: no warning' eval '! grep -q "does not move" "$work/err"'
run --optimize 'flat - 4' "$flat" "$travel" parameter/flat=-1:1 parameter/idle=-1:1
check 'no influence' says 'parameter/idle does not move the formulas at 0'

# ---- what is refused
ends() { exits "$1" && says "$2" && [ ! -e "$work/no.csv" ]; }
mistake() { # STATUS TEXT WORD...: said, and no file is left
    wanted=$1
    text=$2
    shift 2
    run --optimize "$@" -o "$work/no.csv"
    check "$text" ends "$wanted" "$text"
}
z=parameter/link_in_z
mistake 2 'needs names of what may change' wheel.yaw "$corner" "$travel"
mistake 2 "there is no 'parameter/none'" wheel.yaw "$corner" "$travel" parameter/none=0:1
mistake 2 "'$z' does not tell between which numbers" wheel.yaw "$corner" "$travel" $z
mistake 2 "'$z=1:0' does not tell between which numbers" wheel.yaw "$corner" "$travel" $z=1:0
mistake 2 "'$z=1:2:3' does not tell between which numbers" wheel.yaw "$corner" "$travel" $z=1:2:3
mistake 2 "'$z=0:inf' does not tell between which numbers" wheel.yaw "$corner" "$travel" $z=0:inf
mistake 2 "$z begins with 0.1345 m, which is not between its bounds" wheel.yaw "$corner" "$travel" $z=0:0.1
mistake 2 "'$z' is there twice" wheel.yaw "$corner" "$travel" $z=0:1 $z=0:2
mistake 2 "'parameter/link_in_y' has no bounds" wheel.yaw "$corner" "$travel" parameter=0:1
mistake 1 "wheel.w" wheel.w "$corner" "$travel" $z=0:1
{ cat "$travel" && echo 'until: hub.z > 0.2'; } >"$work/ends.scene"
mistake 1 "ends.scene:11:8: error: --optimize looks at all times of a run, and 'hub.z > 0.2' ends it" wheel.yaw "$corner" "$work/ends.scene" $z=0:1
{ cat "$travel" && echo 'sleep: {}'; } >"$work/sleeps.scene"
mistake 1 'no gradient of a run in which the vehicle may sleep' wheel.yaw "$corner" "$work/sleeps.scene" $z=0:1
check 'what to do about sleep' says 'remedy: leave `sleep` out'
mistake 2 'no scene given' wheel.yaw "$corner"
mistake 2 'does not go with --engine' wheel.yaw --engine cc "$corner" "$travel" $z=0:1
mistake 2 'one of --eval' wheel.yaw --modes "$corner" "$travel" $z=0:1

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
