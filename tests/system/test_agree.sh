#!/bin/sh
# SPDX-License-Identifier: MIT
# test_agree.sh STATES REFERENCE AGREE: the comparison passes equal results and notices every kind of difference.
states=$1
reference=$2
agree=$3
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
dump=$work/dump
cat >"$dump" <<'END'
{"gicgen_dump": 1, "model": "swing", "gravity": [0, 0, -9.81], "base": "free", "bodies": [
  {"name": "hull", "mass": 100, "com": [0, 0, 0.1], "inertia": [10, 20, 25, 0, -1, 0],
   "position": [0, 0, 0.5], "euler": [1, 0, 0, 0]},
  {"name": "arm", "mass": 20, "com": [0.5, 0, 0], "inertia": [2, 3, 4, 0, 0, 0],
   "position": [1, 0, 0.5], "euler": [0.5, 0.5, 0.5, 0.5]}],
 "joints": [
  {"name": "hinge", "type": "revolute", "a": 0, "b": 1, "point_a": [1, 0, 0], "point_b": [0, 0, 0],
   "axis_a": [1, 0, 0], "axis_b": [0, 0, 1], "length": null, "offset": null}],
 "coordinates": [
  {"name": "phi", "type": "angle", "a": 0, "b": 1, "point_a": null, "point_b": null, "axis_a": [1, 0, 0],
   "reference_a": [0, 1, 0], "reference_b": [1, 0, 0], "design": 0, "offset": null, "range": [-1, 2], "driven": false}],
 "forces": [
  {"name": "spring", "type": "coordinate", "coordinate": 0, "a": null, "b": null, "point_a": null, "point_b": null,
   "stiffness": 300, "damping": 5, "free": 0, "low": null, "high": null, "fade": null, "table": null, "law": []}],
 "wheels": [{"name": "tire", "body": 0, "center": [0, 0, 0], "radius": 0.5, "stiffness": 5000, "damping": 50, "fade": 0.01, "tire": null}], "tires": [],
 "inputs": [], "tables": [], "outputs": [],
 "sequence": [{"stage": 1, "class": null, "bodies": [0], "joints": [], "coordinates": []},
  {"stage": 2, "class": "arm", "bodies": [1], "joints": [0], "coordinates": [0]}]}
END
passed=0
failed=0

# expect STATUS LABEL [ARGUMENTS]: agree must exit with STATUS on $work/eval
expect() {
    want=$1
    label=$2
    shift 2
    "$agree" "$dump" "$work/accel" "$work/eval" "$@" >"$work/out" 2>&1
    got=$?
    if [ "$got" -eq "$want" ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL $label: exit $got instead of $want"
        cat "$work/out"
    fi
}

# edit COLUMN EXPRESSION: $work/eval with that column of the third row replaced
edit() {
    awk -F, -v OFS=, -v name="$1" -v CONVFMT=%.17g -v OFMT=%.17g '
        NR == 1 { for (i = 1; i <= NF; ++i) if ($i == name) column = i; if (!column) exit 1 }
        NR == 4 { x = $column + 0; $column = '"$2"' }
        { print }' "$work/accel" >"$work/eval"
}

"$states" "$dump" --count 6 --seed 3 -o "$work/states" && "$reference" "$dump" "$work/states" -o "$work/accel" \
    2>/dev/null || exit 1
cp "$work/accel" "$work/eval"
expect 0 "the same numbers"
edit a.y 'x * (1 + 1e-9) + 1e-9'
expect 1 "one acceleration off"
expect 0 "one acceleration off, within a wide tolerance" --tolerance 1e-3
edit "$(head -n 1 "$work/accel" | tr , '\n' | grep '\.e2$' | tail -n 1)" 'x + 1e-10'
expect 1 "one Euler parameter off"
edit arm.x 'x + 1e-10'
expect 1 "one place off"
edit hinge.torque.y 'x * (1 + 1e-9) + 1e-9'
expect 0 "a reaction that nobody compares"
sed -i '1s/,hinge\./,output.hinge./g' "$work/eval"
expect 1 "one reaction off" --reactions
sed '1s/,hinge\./,output.hinge./g' "$work/accel" >"$work/eval"
expect 0 "the same reactions" --reactions
cp "$work/accel" "$work/eval"
expect 1 "no outputs of reactions" --reactions
expect 1 "no outputs of wheels" --wheels
edit tire_load.fz 'x * (1 + 1e-9) + 1e-9'
sed -i '1s/,tire_load\./,output.tire_load./g; 1s/,energies\./,output.energies./g' "$work/eval"
expect 1 "one load off" --wheels
sed '1s/,tire_load\./,output.tire_load./g; 1s/,energies\./,output.energies./g' "$work/accel" >"$work/eval"
expect 0 "the same of wheels" --wheels
edit alpha.z '"nan"'
expect 1 "not a number"
edit a.x '""'
expect 1 "an empty cell"
edit status '-5'
expect 1 "a refused row"
head -n 5 "$work/accel" >"$work/eval"
expect 1 "rows missing"
cp "$work/accel" "$work/eval"
expect 1 "no row admissible" --condition 0.5
cut -d, -f2- "$work/accel" >"$work/eval"
expect 1 "a column missing"

# equal seeds give equal states, other seeds others
"$states" "$dump" --count 6 --seed 3 >"$work/again"
"$states" "$dump" --count 6 --seed 4 >"$work/other"
if cmp -s "$work/states" "$work/again" && ! cmp -s "$work/states" "$work/other"; then
    passed=$((passed + 1))
else
    failed=$((failed + 1))
    echo "FAIL seeds"
fi

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -eq 19 ]
