#!/bin/sh
# SPDX-License-Identifier: MIT
# test_roads.sh GICRUN: the HMMWV on every type of road. Roads that are the same in two forms give the same run,
# roughness grows as its class says, and mistakes in scenes and their files are refused where they stand.
gicrun=$1
models=$(cd "$(dirname "$0")/../../models" && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

# scene ROAD [SED]: the HMMWV from rest on its springs at 6 m/s over the road that follows `road: `, in $work/scene
scene() {
    printf '%s\n' 'gicscene: 1' 'duration: 2' 'step: 0.002' 'output_step: 0.01' 'initial:' \
        '  position: [0, 0, 0.4740625]' '  orientation: {pitch: 0.0004326}' '  velocity: [6, 0, 0]' \
        'outputs: [chassis, chassis_attitude, spring_f_l, spring_r_l]' "road: $1" | sed "$2" >"$work/scene"
}
# drive NAME ROAD [SED]: its results in $work/NAME.csv
drive() {
    name=$1
    shift
    scene "$@"
    "$gicrun" --quiet "$models/hmmwv.veh" "$work/scene" -o "$work/$name.csv" 2>"$work/err"
    verdict $? "$name: $(cat "$work/err")"
}
# same A B TOLERANCE: all numbers of two results are as near as that
same() {
    paste -d, "$work/$1.csv" "$work/$2.csv" | awk -F, -v most="$3" 'NR > 1 {
        for (i = 1; i <= NF / 2; ++i) { d = $i - $(i + NF / 2); if (d < 0) d = -d; if (!(d <= most)) bad = 1 }
    } END { exit bad || NR != 202 }'
    verdict $? "$1 and $2 differ"
}

# ---- the same road in two forms ----------------------------------------------------------------------------

drive flat '{type: flat}'
drive none '{type: flat}' '/^road/d'
same flat none 0
drive raised '{type: flat, height: 0.25}' 's/0.4740625/0.7240625/'
awk -F, 'BEGIN { OFS = FS; CONVFMT = "%.17g" } NR > 1 { $4 -= 0.25 } { print }' "$work/raised.csv" >"$work/lowered.csv"
same flat lowered 1e-12

drive bumps '{type: bumps, bumps: [{x: 3, length: 2, height: 0.05}, {x: 7, length: 1, height: 0.03, tracks: left}]}'
drive unsorted '{type: bumps, bumps: [{x: 7, length: 1, height: 0.03, tracks: left}, {x: 3, length: 2, height: 0.05}]}'
same bumps unsorted 0
drive sum '{type: sum, roads: [{type: bumps, bumps: [{x: 3, length: 2, height: 0.05}]},
    {type: bumps, bumps: [{x: 7, length: 1, height: 0.03, tracks: left}]}], friction: {value: 1}}'
same bumps sum 0
# a sine is bumps of one length in a row
drive sine '{type: sum, roads: [{type: sine, amplitude: -0.01, wavelength: 2, start: -0.5},
    {type: flat, height: 0.01}]}'
row=$(awk 'BEGIN { for (x = -4; x < 20; x += 2) printf "{x: %d, length: 2, height: 0.02},", x }')
drive row "{type: bumps, bumps: [$row]}"
same sine row 1e-12

drive inline '{type: table, x: [0, 3, 4, 5, 6.5, 30], left: [0, 0, 0.05, -0.02, 0, 0], right: [0, 0, 0.01, 0.01, 0, 0]}'
printf '%s\n' 'x,left,right' 0,0,0 3,0,0 4,0.05,0.01 5,-0.02,0.01 6.5,0,0 30,0,0 >"$work/table_road.csv"
drive table '{type: table, file: table_road.csv}'
same inline table 0

# a plane by its nodes is one between them, where no edge is near
awk 'BEGIN { print "x,y,z"; for (x = -12; x <= 24; x += 3) for (y = -8; y <= 8; y += 2)
    printf "%g,%g,%.17g\n", x, y, 0.02 * x + 0.01 * y }' >"$work/plane.csv"
drive slope '{type: slope, x: 0.02, y: 0.01}'
drive grid '{type: grid, file: plane.csv}'
same slope grid 1e-9

# ---- random roads ------------------------------------------------------------------------------------------

# deviation CSV: how far the chassis' height strays from its mean, root mean square
deviation() {
    awk -F, 'NR > 1 { n += 1; s += $4; q += $4 * $4 } END { print sqrt(q / n - s / n * s / n) }' "$work/$1.csv"
}
for class in A B C; do
    drive "$class" "{type: iso8608, class: $class, seed: 5, length: 40, start: 2}"
done
# springs and tires are linear in the small: twice the road, twice the motion
echo "$(deviation A) $(deviation B) $(deviation C)" |
    awk '{ exit !($1 > 1e-4 && $2 / $1 > 1.9 && $2 / $1 < 2.1 && $3 / $2 > 1.9 && $3 / $2 < 2.1) }'
verdict $? "motions on classes A, B, C: $(deviation A) $(deviation B) $(deviation C)"
drive again '{type: iso8608, class: C, seed: 5, length: 40, start: 2}'
same C again 0
drive other '{type: iso8608, class: C, seed: 6, length: 40, start: 2}'
! cmp -s "$work/C.csv" "$work/other.csv"
verdict $? "another seed, the same road"

# every scene with a road of the models runs, and the vehicle stays on it
for name in rough_road field_track; do
    "$gicrun" --quiet "$models/hmmwv.veh" "$models/scenes/$name.scene" -o "$work/$name.csv" 2>"$work/err"
    verdict $? "$name.scene: $(cat "$work/err")"
    awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^chassis.z/) z = i; next }
        $z < 0.35 || $z > 0.75 { bad = 1 } END { exit bad || NR < 300 }' "$work/$name.csv"
    verdict $? "$name.scene: the vehicle leaves the road"
done

# ---- mistakes ----------------------------------------------------------------------------------------------

# refused FILE:LINE:COLUMN TEXT: the scene must be, with one error that has a remedy
refused() {
    "$gicrun" "$models/hmmwv.veh" "$work/scene" --cc false >"$work/out" 2>"$work/err"
    [ $? -eq 1 ] && grep -q "^$work/$1 error: .*$2" "$work/err" && [ "$(grep -c 'error: ' "$work/err")" -eq 1 ] &&
        grep -q '^  remedy: ' "$work/err"
    verdict $? "not refused at $1 with '$2': $(cat "$work/err")"
}
# bad ROAD COLUMN TEXT: the road is refused at that column of its line, the scene's tenth
bad() {
    scene "$1"
    refused "scene:10:$2:" "$3"
}
bad '{type: grids}' 14 "no road of type 'grids'"
bad '{type: grid}' 7 "needs the key 'file'"
bad '{type: grid, file: nowhere.csv}' 26 "can't read the road '.*/nowhere.csv': No such file"
bad '{type: grid, file: .}' 26 'it is a folder'
bad '{type: grid, file: "-"}' 26 'is no file of a road'
bad '{type: table, file: table.csv, x: [0, 1]}' 38 "unknown key 'x'"
bad '{type: iso8608, length: 9}' 7 "needs the key 'class'"
bad '{type: iso8608, class: I, length: 9}' 30 "no road class 'I'"
bad '{type: iso8608, class: AB, length: 9}' 30 "no road class 'AB'"
bad '{type: iso8608, class: A}' 7 "needs the key 'length'"
bad '{type: iso8608, class: A, length: 1e7}' 41 'more than 1e+07 points'
bad '{type: iso8608, class: A, length: 9, seed: 1.5}' 50 'whole number'
bad '{type: iso8608, class: A, length: 9, seed: -1}' 50 'whole number'
bad '{type: iso8608, class: A, length: 9, fade: -1}' 50 "can't be negative"
bad '{type: iso8608, class: A, length: 9, spacing: 0}' 53 'must be positive'
bad '{type: iso8608, class: A, length: 9, track: 0.04}' 51 'less than a track apart'
bad '{type: sum, roads: []}' 26 'list of roads'
bad '{type: sum, roads: [{type: flat}, {type: hill}]}' 48 "no road of type 'hill'"
bad '{type: sum, roads: [{type: flat, friction: {value: 1}}]}' 50 'belongs to the sum'
bad '{type: flat, friction: 0.8}' 30 'must be a map'
bad '{type: flat, friction: {value: 0}}' 38 'must be positive'
bad '{type: flat, friction: {patches: {x: [0, 1]}}}' 40 'must be a list'
bad '{type: flat, friction: {patches: [{x: [0, 1], y: [0, 1]}]}}' 41 "needs the key 'value'"
bad '{type: flat, friction: {patches: [{x: [2, 1], y: [0, 1], value: 1}]}}' 45 'x of a patch must rise'
bad '{type: flat, friction: {patches: [{x: [0, 9], y: [0, 1], value: 1, fade: 2}]}}' 80 'no room for edges'
bad '{type: flat, friction: {patches: [{x: [0, 9], y: [0, 0.01], value: 1}]}}' 41 'no room for edges'

# badfile TYPE LINE:COLUMN TEXT ROW...: a file of these rows is refused there
badfile() {
    type=$1
    place=$2
    text=$3
    shift 3
    printf '%s\n' "$@" >"$work/road.csv"
    scene "{type: $type, file: road.csv}"
    refused "road.csv:$place" "$text"
}
: >"$work/road.csv"
scene '{type: table, file: road.csv}'
refused 'road.csv:' 'the file is empty'
badfile table 1:3: "no column 'hight'" x,hight 0,0 1,0
badfile table 1:1: 'columns are separated by semicolons' 'x;height' '0;0' '1;0'
badfile table 1:1: 'columns are separated by tabs' "x$(printf '\t')height" "0$(printf '\t')0"
badfile table 1:1: 'this line names no column of such a table' 0,0 1,0
badfile table 1:3: "column 'height' is in mm" x,'height [mm]' 0,0 1,0
badfile table 1:3: 'height beside left or right' x,height,left 0,0,0 1,0,0
badfile table 1:1: "the column 'x' is missing" left,right 0,0 1,0
badfile table 1:1: "the column 'right' is missing" x,left 0,0 1,0
badfile table 1:10: "'height' is here twice" x,height,height 0,0,0 1,0,0
badfile table '' 'needs two points' x,height 0,0
badfile table 5:1: 'must rise: after 1 comes 1' '# ours' x,height 0,0 1,0 1,0
badfile table 3:3: "height must be a number, not 'low'" x,height 0,0 1,low
badfile table 3:3: 'too large' x,height 0,0 1,1e999
badfile table 3:1: 'the row has 1 cells' x,height 0,0 1
badfile grid 1:1: "the column 'z' is missing" x,y 0,0 1,0
badfile grid '' 'needs two nodes along x and along y' x,y,z 0,0,0 1,0,0 2,0,0
badfile grid '' 'needs two nodes along x and along y' x,y,z
badfile grid 6:1: 'x = 1, y = 0 is on line 3 already' x,y,z 0,0,0 1,0,0 0,1,0 1,1,0 1,0,0
badfile grid 6:1: 'has the point x = 2, y = 1 where x = 1, y = 1 should be' x,y,z 0,0,0 1,0,0 2,0,0 0,1,0 2,1,0
badfile grid 6:1: 'ends at x = 1, y = 1, not at x = 2' x,y,z 0,0,0 1,0,0 2,0,0 0,1,0 1,1,0
badfile grid 3:1: 'has the point x = 1, y = 0 where x = 1.5, y = 0 should be' x,y,z 0,0,0 1,0,0 3,0,0 0,1,0 1,1,0 3,1,0

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
