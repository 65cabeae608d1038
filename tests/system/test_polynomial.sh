#!/bin/sh
# SPDX-License-Identifier: MIT
# test_polynomial.sh GICGEN GICGEN_PLANTED: recovery by polynomials. Five links: rates are those of Newton's iteration within 1e-11 (the
# bound of 1e-13 times the springs' stiffness over the masses), lengths of the links those of the model file within 1e-12 m,
# inside the range, at its ends and beyond. A four-bar linkage with nice lengths and as a parallelogram against its closed
# solution, places within 2e-13 m (of 2 m), velocities within 1e-9, which is what differences of steps of 1e-5 leave.
# A coefficient that is off by twice the bound is found by the proof alone. What can't be: a branch within the range, tunable geometry, subsets of closed form, lanes. Same bytes without the option.
gicgen=$1
planted=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
: >"$work/said"

compile() { # PROGRAM FILES...
    program=$1
    shift
    "${CC:-cc}" -std=c99 -O1 -ffp-contract=off -I"$work" -I"$root/runtime" "$@" "$root/runtime/gic_runtime.c" -o "$work/$program" -lm
}
# refused LABEL STATUS TEXT OPTIONS...: a message, and no file
refused() {
    label=$1 wanted=$2 text=$3
    shift 3
    "$gicgen" "$@" -o "$work/refused.c" >"$work/out" 2>"$work/err"
    status=$?
    [ "$status" -eq "$wanted" ] && grep -q -- "$text" "$work/err" && ! [ -e "$work/refused.c" ] &&
        { [ "$wanted" -eq 2 ] || grep -q 'remedy' "$work/err"; }
    verdict $? "$label"
}

cp -r "$root/models/parts" "$work/parts"
for name in exact fitted; do
    sed "s/^model: .*/model: $name/" "$root/models/five_link.veh" >"$work/$name.veh"
done
"$gicgen" "$work/exact.veh" -o "$work/exact.c" && "$gicgen" --recovery polynomial "$work/fitted.veh" -o "$work/fitted.c" &&
    compile links "$root/tests/data/polynomial/links.c" "$work/exact.c" "$work/fitted.c" && "$work/links" >"$work/out"
verdict $? "five links: both run"
awk '{exit !($1 < 1e-11 && $2 < 1e-12 && $3 == 69)}' "$work/out"
verdict $? "five links: rates and lengths"
grep -q "of spring_r_l in \[0.32, 0.42\], spring_r_r in \[0.32, 0.42\]" "$work/fitted.c" &&
    grep -q "bound 1e-13, proved [1-9][.0-9]*e-14 by [0-9]* intervals, largest error found .* at 2001 points" "$work/fitted.c"
verdict $? "five links: what the head says"
"$gicgen" --lanes 2 --recovery polynomial "$work/fitted.veh" -o "$work/fitted.c" && grep -q "wheel_r_l_MADE" "$work/fitted.c" &&
    compile links "$root/tests/data/polynomial/links.c" "$work/exact.c" "$work/fitted.c" && "$work/links" >"$work/out"
awk '{exit !($1 < 1e-11 && $2 < 1e-12 && $3 == 69)}' "$work/out"
verdict $? "five links in lanes"
"$gicgen" --derivatives --implicit "$work/exact.veh" -o "$work/exact.c"
for lanes in "" "--lanes 2"; do
    # shellcheck disable=SC2086
    "$gicgen" $lanes --derivatives --implicit --recovery polynomial "$work/fitted.veh" -o "$work/fitted.c" &&
        compile links -O0 "$root/tests/data/polynomial/derivatives.c" "$work/exact.c" "$work/fitted.c" && "$work/links" >"$work/out" &&
        awk '{exit !($1 < 1e-11 && $2 < 1e-8 && $3 == 24 && $4 < 1e-11)}' "$work/out"
    verdict $? "derivatives and implicit steps $lanes"
done
"$gicgen" --recovery polynomial "$work/fitted.veh" -o "$work/fitted.c" &&
    "$gicgen" --batch 4 --recovery polynomial "$work/fitted.veh" -o "$work/fitted_batch.c" &&
    compile batch -O0 -std=gnu99 -w "$root/tests/data/polynomial/batch.c" "$work/fitted.c" "$work/fitted_batch.c" 2>"$work/err" &&
    "$work/batch" >"$work/out" && awk '{exit !($1 == 0 && $2 > 3 && $3 == 13)}' "$work/out"
verdict $? "a batch has the bits of vehicles one by one"
printf '%s\n' 'gicscene: 1' 'duration: 2' 'step: 0.005' 'integrator: ab3' 'initial:' '  position: [0, 0, 0.474472]' '  velocity: [8, 0, 0]' >"$work/straight.scene"
"$gicgen" --scene "$work/straight.scene" "$work/exact.veh" -o "$work/exact.c" &&
    "$gicgen" --scene "$work/straight.scene" --recovery polynomial "$work/fitted.veh" -o "$work/fitted.c" &&
    grep -q "'spring_r_r' is the mirror image of 'spring_r_l'" "$work/fitted.c" && grep -q "inside\[4\]" "$work/fitted.c" &&
    compile links -w -DSTRAIGHT "$root/tests/data/polynomial/links.c" "$work/exact.c" "$work/fitted.c" "$root/runtime/gic_road.c" &&
    "$work/links" >"$work/out" && awk '{exit !($1 < 1e-11 && $2 < 1e-12 && $3 == 69)}' "$work/out"
verdict $? "code for one scene, of half a vehicle"
GICGEN_PLANT=polynomial "$planted" --recovery polynomial "$work/fitted.veh" -o "$work/off.c" >"$work/out" 2>"$work/err"
[ $? -eq 1 ] && grep -q "it can't be proved that errors are below 1e-13 with 'spring_r_l' between 0.3" "$work/err" && ! [ -e "$work/off.c" ]
verdict $? "five links: a coefficient that is wrong"
GICGEN_PLANT=polynomial "$planted" --recovery polynomial "$root/models/semitrailer.veh" -o "$work/semitrailer.c" >"$work/out" 2>"$work/err" &&
    grep -q "semitrailer.veh: warning: 'pitman' keeps Newton's iteration: it can't be proved" "$work/err" &&
    grep -q "'pitman': none, for it can't be proved" "$work/semitrailer.c" && grep -q "'nut': of steering in" "$work/semitrailer.c"
verdict $? "one of two that can't be proved"
sed "s/^model: .*/model: five_link/" "$root/models/five_link.veh" >"$work/five_link.veh"
"$gicgen" "$work/five_link.veh" -o "$work/five_link.c" && cmp -s "$work/five_link.c" "$root/generated/five_link.c"
verdict $? "the same bytes without the option"

# four LOW HIGH GROUND CRANK COUPLER ROCKER X Z: the crank upright, the far pin at X, Z
four() {
    echo "gicgen: 1
model: four
base: ground
parameters: {along: {value: $7, unit: m, tunable: true}}
bodies:
  crank: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
  coupler: {mass: 1, com: [0, 0, 1], inertia: [1, 1, 1]}
  rocker: {mass: 1, com: [$3, 0, 0], inertia: [1, 1, 1]}
joints:
  crank: {type: revolute, bodies: [ground, crank], point: [0, 0, 0], axis: [0, 1, 0]}
  rocker: {type: revolute, bodies: [ground, rocker], point: [$3, 0, 0], axis: [0, 1, 0]}
  pin: {type: revolute, bodies: [crank, coupler], point: [0, 0, $4], axis: [0, 1, 0]}
  meet: {type: point_on_line, bodies: [coupler, rocker], point: [$7, 0, $8], axis: [0, 1, 0]}
coordinates:
  angle: {type: angle, bodies: [ground, crank], axis: [0, 1, 0], range: [$1, $2]}
outputs:
  pin: {type: position, body: coupler, point: [$7, 0, $8]}
  speed: {type: velocity, body: coupler, point: [$7, 0, $8]}"
}
bars() { # LABEL LOW HIGH GROUND CRANK COUPLER ROCKER X Z
    label=$1
    shift
    four "$@" | sed '/^parameters/d' >"$work/four.veh"
    "$gicgen" --recovery polynomial "$work/four.veh" -o "$work/four.c" 2>"$work/err" &&
        compile four -DGROUND="$3" -DCRANK="$4" -DCOUPLER="$5" -DROCKER="$6" "$root/tests/data/polynomial/bars.c" "$work/four.c" &&
        "$work/four" "$1" "$2" >"$work/out" 2>"$work/err" &&
        awk '{exit !($1 < 2e-13 && $2 < 1e-9 && $3 == 242)}' "$work/out"
    verdict $? "$label"
}
bars "parallelogram" -0.5 0.5 2 1 2 1 2 1
bars "parallelogram from upright on" 0 0.75 2 1 2 1 2 1
bars "lengths 2, 1, 2 and 2" -0.5 0.5 2 1 2 2 1.7416198487095662 1.9832396974191324
bars "a square, over a quarter turn" -0.7853981633974483 0.7853981633974483 1 1 1 1 1 1
bars "lengths 3, 1, 3 and 2, over half a turn" -1.5 1.5 3 1 3 2 2.8309475019311123 1.9928425057933374

four -0.5 3 2 1 2 1 2 1 | sed '/^parameters/d' >"$work/branch.veh"
refused "a change point within the range" 1 "branch.veh:.*error: .*within its range \[-0.5, 3\]" --recovery polynomial "$work/branch.veh"
four -0.5 0.5 2 1 2 1 2 1 | sed 's/point: \[2, 0, 1\], axis/point: [along, 0, 1], axis/' >"$work/tuned.veh"
refused "tunable geometry" 1 "tuned.veh:[0-9]*:[0-9]*: error: .*tunable" --recovery polynomial "$work/tuned.veh"
four -0.5 0.5 2 1 2 1 2 1 | sed 's/^parameters:.*/parameters: {load: {value: 1, tunable: true}}/; s/coupler: {mass: 1,/coupler: {mass: "load",/' >"$work/loaded.veh"
"$gicgen" --recovery polynomial "$work/loaded.veh" -o "$work/loaded.c" 2>"$work/err" && grep -q polynomial "$work/loaded.c"
verdict $? "a tunable mass is no geometry"
refused "closed forms" 1 "hmmwv.veh: error: no subset" --recovery polynomial "$root/models/hmmwv.veh"
refused "with an FMU" 2 "--recovery polynomial is for" --recovery polynomial --fmu 2 "$root/models/five_link.veh"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
