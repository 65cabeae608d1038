#!/bin/sh
# SPDX-License-Identifier: MIT
# test_massless.sh GICGEN GICRUN: `massless` of a scene, against the general code and against a model of tiny masses.
gicgen=$1
gicrun=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
. "$root/tests/lib/checking.sh"
model=$root/models/hmmwv14.veh
general=$work/general.scene

sed 's/^step:.*/&\noutputs: [chassis, spring_f_l, force_f_l]/' "$root/models/scenes/hmmwv14.scene" >"$general"
# without KG: the scene in which bodies below that have no mass
without() { sed "s/^step:.*/&\nmassless: {below: $1}/" "$general" >"$work/light.scene"; }

# apart FILE FILE COLUMN LEAST MOST: largest difference in a column, between the two
apart() {
    awk -F, -v column="$3" -v least="$4" -v most="$5" '
        FNR == 1 { for (i = 1; i <= NF; ++i) if (index($i, column " ") == 1) at = i; next }
        NR == FNR { a[FNR] = $at; next }
        { d = a[FNR] - $at; if (d < 0) d = -d; if (!(d <= far)) far = d; rows = FNR }
        END { exit !(at && rows > 100 && far > least && far < most) }' "$1" "$2"
}

run --engine cc --cflags -O1 "$model" "$general" -o "$work/general.csv"
check "general" exits 0
without 6
run --engine cc --cflags -O1 "$model" "$work/light.scene" -o "$work/light.csv"
check "upper arms without mass" exits 0
# the bounds of models/SCENE.md section 9; and the approximation is one
check "chassis" apart "$work/general.csv" "$work/light.csv" chassis.z 1e-6 1.5e-3
check "spring" apart "$work/general.csv" "$work/light.csv" spring_f_l.value 1e-6 0.8e-3
check "force" apart "$work/general.csv" "$work/light.csv" force_f_l 1e-3 120
# engines that evaluate the same formulas differ by rounding alone
run --engine tape "$model" "$work/light.scene" -o "$work/tape.csv"
check "tape" exits 0
check "tape as cc" apart "$work/tape.csv" "$work/light.csv" force_f_l -1 1e-5

# The reference: arms of 5.8 mg (a millionth), by an engine that has no notion of bodies without mass. What they do is
# that part of the differences above: 1.3e-9 m and 1.1e-4 N.
sed "s|parts/|$root/models/parts/|g; s/mass: 5.813/mass: 5.813e-6/; s/\[0.03138, 0.03138, 0.06276\]/[3.138e-8, 3.138e-8, 6.276e-8]/" \
    "$model" >"$work/tiny.veh"
check "masses are replaced" [ "$(grep -c '5.813e-6\|3.138e-8' "$work/tiny.veh")" -eq 4 ]
run --engine gic "$work/tiny.veh" "$general" -o "$work/tiny.csv"
check "tiny masses" exits 0
check "chassis as with tiny masses" apart "$work/tiny.csv" "$work/light.csv" chassis.z -1 1e-8
check "force as with tiny masses" apart "$work/tiny.csv" "$work/light.csv" force_f_l -1 1e-3
run --engine gic "$model" "$work/light.scene" -o "$work/refused.csv"
check "engines with the coordinates of bodies refuse" exits 1
check "and say why" says "needs the mass of 'uca_f_l'"

"$gicgen" --scene "$work/light.scene" "$model" -o "$work/light.c" 2>"$work/err"
check "code" [ $? -eq 0 ]
# a comment, whose long lines are broken
sed 's/^ \* *//' "$work/light.c" | tr '\n' ' ' >"$work/light.line"
check "tells what it leaves out" grep -q "below 6 kg massless, an approximation .*uca_f_l, uca_f_r, uca_r_l, uca_r_r" "$work/light.line"
check "and saves operations" awk '/code for any scene/ { general = $6 } /massless, an approx/ { light = $9 } END { exit !(light && light < 0.9 * general) }' "$work/light.c"

# SCENE.md's bound of natural frequencies from the part of inertia that is lost: with the base held they rise by 0.81
# percent in front, of 0.91 that 1.8 percent of inertia allow
hertz() { awk '/spring_f_l/ { print $4; exit }' "$work/out"; }
for scene in general light; do
    sed 's/^step/base: fixed\nstep/; /velocity/d' "$work/$scene.scene" >"$work/held.scene"
    run --modes "$model" "$work/held.scene"
    check "modes" exits 0
    hertz >"$work/$scene.hertz"
done
lost=$(sed -n 's/.*loses up to \([0-9.]*\) of its inertia.*/\1/p' "$work/light.c" | head -1)
check "frequencies rise as inertia is lost" awk -v lost="$lost" 'NR == FNR { general = $1; next }
    { good = lost > 0 && $1 > 1.005 * general && $1 < general / sqrt(1 - lost) } END { exit !good }' "$work/general.hertz" "$work/light.hertz"

# refused KG TEXT
refused() {
    without "$1"
    run "$model" "$work/light.scene" -o "$work/refused.csv"
    [ "$status" -eq 1 ] && grep -q "$2" "$work/err"
}
check "nothing is that light" refused 5 "no body of 'hmmwv14' is lighter than 5 kg"
check "no inertia left" refused 100 "a coordinate has no inertia"
check "no base left" refused 3000 "the base 'chassis' of 2086.52 kg would be without mass"
check "no mass" refused -1 "below must be positive"
# a coordinate that is driven needs none
without 100
sed 's/^massless/base: fixed\ndriven: {spring_f_l: 0.245, spring_f_r: 0.245, spring_r_l: 0.305, spring_r_r: 0.305, rack: 0}\n&/; /velocity/d' \
    "$work/light.scene" >"$work/rig.scene"
run "$model" "$work/rig.scene" -o "$work/rig.csv"
check "driven coordinates need no inertia" exits 0

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
