#!/bin/sh
# SPDX-License-Identifier: MIT
# test_driver_scenes.sh GICRUN: drivers that are written wrong.
gicrun=$1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0
failed=0

cat >"$work/car.veh" <<'END'
gicgen: 1
model: car
base: hull
inputs: {accelerator: {unit: "1"}, brake: {unit: "1"}, steer: {unit: rad}}
bodies:
  hull: {mass: 10, com: [0, 0, 1], inertia: [1, 1, 1]}
forces:
  all: {type: load, body: hull, in: hull, force: [accelerator - brake, steer, 0]}
outputs:
  hull: {type: position, body: hull}
END
cat >"$work/good.scene" <<'END'
gicscene: 1
duration: 1
step: 0.005
driver:
  period: 0.02
  speed: {target: 10, gain: 1, full: [3, 8]}
  steering:
    path: {points: [[0, 0], [100, 0], [200, 5]]}
    input: steer
    per_angle: 1
    wheelbase: 3
END
"$gicrun" -q "$work/car.veh" "$work/good.scene" -o "$work/good.csv" 2>"$work/err" && passed=1 ||
    { failed=1; echo 'FAILED: a scene with a driver'; cat "$work/err"; }

# change SED LINE:COLUMN TEXT: refused there, with one remedy, once the scene is edited so
change() {
    sed "$1" "$work/good.scene" >"$work/bad.scene"
    rm -f "$work/bad.csv"
    "$gicrun" "$work/car.veh" "$work/bad.scene" -o "$work/bad.csv" 2>"$work/err"
    if [ $? -eq 1 ] && grep -q "^$work/bad.scene:$2: error: .*$3" "$work/err" && [ ! -e "$work/bad.csv" ] &&
        [ "$(grep -c 'error: ' "$work/err")" -eq 1 ] && [ "$(grep -c '  remedy: ' "$work/err")" -eq 1 ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAILED: $2 $3"
        sed 's/^/    /' "$work/err"
    fi
}
change '5,$d; s/^driver:/driver: 5/' 4:9 'must be a map'
change 's/target: 10, //' 6:10 "needs the key 'target'"
change 's/target: 10/target: {bend: 1}/' 6:20 "unknown key 'bend'"
change 's/target: 10/target: fast/' 6:19 'must be a number'
change 's/gain: 1/gain: 0/' 6:29 'must be positive'
change 's/gain: 1/integral: -1/' 6:33 'must not be negative'
change 's/full: \[3, 8\]/full: [3, 0]/' 6:38 'full must be positive'
change 's/full: \[3, 8\]/full: [3]/' 6:38 'full'
change 's/gain: 1/brake: brakes/' 6:30 "no input 'brakes'"
change 's/gain: 1/brake: steer/' 6:30 "the driver moves 'steer' from 0 to 1, but the model has it in rad"
change 's/gain: 1/gains: 1/' 6:23 "unknown key 'gains'"
change 's/period: 0.02/period: 0.012/' 5:11 'multiple of step'
change 's/period: 0.02/reach: 0/' 5:10 'must be positive'
change '/^  speed/d; /^  steering/,$d' 5:3 'nothing to do'
change 's/input: steer$/input: wheel/' 9:12 "no input 'wheel'"
change '/input: steer$/d' 8:5 "no input 'steering' for the driver"
change 's/per_angle: 1/per_angle: 0/' 10:16 'does nothing'
change '/per_angle/d' 8:5 "needs the key 'per_angle'"
change 's/wheelbase: 3/wheelbase: -3/' 11:16 'must be positive'
change '$a \    adapt: -1' 12:12 'must not be negative'
change 's/points: .*/points: [[0, 0]]}/' 8:20 'at least two points'
change 's/\[100, 0\], /[0, 0], /' 8:20 'points 1 and 2 of the path are the same'
change 's/\[100, 0\], /[100], /' 8:29 'point of the path'
change 's/points: .*/points: [[0, 0], [1, 0]], circle: {}}/' 8:11 'in one way'
change 's/points: .*/circle: {center: [0, 0], radius: 0.5}}/' 8:45 'must be 1 m at least'
change 's/points: .*/circle: {center: [0, 0]}}/' 8:20 "needs the key 'radius'"
change 's/points: .*/points: [[0, 0], [2e5, 0]]}/' 8:20 'longer than'
change 's/points: .*/file: nowhere.csv}/' 8:18 'nowhere.csv'
printf 'x,z\n1,2\n3,4\n' >"$work/path.csv"
sed 's/points: .*/file: path.csv}/' "$work/good.scene" >"$work/file.scene"
if ! "$gicrun" "$work/car.veh" "$work/file.scene" 2>"$work/err" &&
    grep -q 'path.csv:1:1: error: .*columns x and y' "$work/err"; then
    passed=$((passed + 1))
else
    failed=$((failed + 1))
    echo 'FAILED: columns of a file'
    sed 's/^/    /' "$work/err"
fi

# a vehicle that turns to the other side than it is steered for is told so, by either sign; one that follows is not
for sign in 1 -1; do
    for turn in left right; do
        [ $turn = left ] && radius=40 || radius=-40
        cat >"$work/circle.scene" <<END
gicscene: 1
duration: 8
integrator: rkck
output_step: 0.1
initial: {velocity: [10, 0, 0]}
driver:
  speed: {target: 10}
  steering: {path: {circle: {center: [0, $radius], radius: $radius}}, input: steer, per_angle: $sign, wheelbase: 2.6, limit: 0.4}
END
        "$gicrun" "$(dirname "$0")/../data/manoeuvre/linear.veh" "$work/circle.scene" -o "$work/circle.csv" >/dev/null 2>"$work/err"
        told=$(grep -c 'turns to the other side than the driver steers for' "$work/err")
        if [ "$told" -eq $((sign < 0)) ]; then
            passed=$((passed + 1))
        else
            failed=$((failed + 1))
            echo "FAILED: a circle to the $turn, per_angle: $sign"
            sed 's/^/    /' "$work/err"
        fi
    done
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
