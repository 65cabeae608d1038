#!/bin/sh
# SPDX-License-Identifier: MIT
# test_tangent.sh GICGEN GICRUN RANDOM_VEHICLE STATES QUAD_LINEAR: derivatives of rates and outputs by the code of
# `gicgen --derivatives`, against dual numbers in C++ over the same code, 1e-13 (derivatives/compare.py), the linear
# models of `gicrun --linearize`, 1e-12, and through their files against differences of the engine gic, 1e-6 (linear_difference.py): tires, powertrain,
# reactions, tunable geometry, all forms of the equations of motion, Newton's iteration, random vehicles. Kinks and mistakes.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
random_vehicle=$(realpath "$3")
states=$(realpath "$4")
quad_linear=$(realpath "$5")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
python=/usr/bin/python3
compare() { "$python" -B "$root/tests/derivatives/compare.py" "$gicgen" "$@" >"$work/said" 2>&1; }
models=$root/models

# ---- against dual numbers

check 'a pendulum' compare "$models/pendulum.veh"
check 'loops' compare "$models/andrews.veh"
check 'a vehicle' compare "$models/hmmwv.veh"
check "a vehicle, by Newton's iteration" compare "$models/hmmwv.veh" -n 2 --option=--recovery=newton
check 'a vehicle, augmented form' compare "$models/hmmwv.veh" -n 2 --option=--solve=augmented
check 'tires and powertrain on a wavy road' compare "$models/hmmwv_vehicle.veh" -n 2 --wave
sh "$root/tests/lib/chain.sh" 6 >"$work/chain.veh" && check 'a chain, articulated form' compare "$work/chain.veh" \
    --option=--solve=articulated
check 'states of a model, no wheels' compare "$root/tests/data/laws/states.veh"
check 'bushings' compare "$root/tests/data/laws/bushing.veh"
check 'air' compare "$root/tests/data/laws/aero.veh"
check 'bodies on bushings alone' compare "$root/tests/data/laws/free.veh" -n 2
check 'gears and couplers' compare "$root/tests/data/laws/coupled.veh" -n 2
check 'bodies that slide and turn on axes' compare "$root/tests/data/laws/sliders.veh"
check 'forces in a loop drawn in a plane' compare "$root/tests/data/laws/planar_loop.veh"
sed 's/^base: box/base: ground/; s/^joints:/joints:\n  stand: {type: prismatic, bodies: [ground, box], axis: [1, 0, 0]}/; s/^coordinates:/coordinates:\n  along: {type: translation, bodies: [ground, box], axis: [1, 0, 0], range: [-1, 1]}/; s/^model: .*/model: stood/' \
    "$root/tests/data/laws/sliders.veh" >"$work/stood.veh" && check 'on a rail of the ground' compare "$work/stood.veh"
{
    cat "$models/hmmwv_tires.veh"
    printf 'states:\n  soft: {rate: "(rate(spring_f_l) - soft) / 0.05"}\n'
    printf 'forces:\n  soft: {type: force, coordinate: spring_f_r, value: 1000 * soft}\n'
} >"$work/soft"
cp -r "$models" "$work/models"
mv "$work/soft" "$work/models/soft.veh"
check 'states of a model beside tires' compare "$work/models/soft.veh" -n 2
car=$root/tests/data/tuning/car.veh
"$gicgen" --dump-model "$car" >"$work/dump" && sh "$root/tests/lib/reactions.sh" "$work/dump" "$car" >"$work/reacting.veh"
check 'reactions, tunable geometry' compare "$work/reacting.veh" -n 2
for seed in 2 3; do
    "$random_vehicle" --seed $seed >"$work/random.veh"
    check "random vehicle $seed" compare "$work/random.veh" -n 2
    "$random_vehicle" --seed $seed --rich "$work" --tire "$models/tires/hmmwv_pac2002.tir" >/dev/null
    check "random vehicle $seed with tires and formulas" compare "$work/$seed.veh" -n 2
done
for seed in 2 3 4 5 6; do
    "$random_vehicle" --seed $seed --mechanism >"$work/random.veh"
    check "random mechanism $seed" compare "$work/random.veh" -n 2
done

# Complete vehicles at random states, in which wheels roll, stand still or are in the air, against differences in quad
# precision of the independent solution; and at states such as people write, upside down and at kinks, where these have
# none, against dual numbers.
# quad MODEL N,N...: of 16 states these, the last of which stands still
quad() {
    "$gicgen" --dump-model "$1" >"$work/dump" && "$states" "$work/dump" --count 16 --seed 3 |
        awk -v rows=",$2," 'NR == 1 || index(rows, "," NR - 1 ",")' >"$work/states" &&
        compare "$1" --matrices "$work/states" "$work/matrices" &&
        "$quad_linear" "$work/dump" "$work/states" --matrices "$work/matrices" --tolerance 1e-11 >"$work/said" 2>&1
}
# written MODEL COUNT
written() {
    "$gicgen" --dump-model "$1" >"$work/dump" && "$states" "$work/dump" --count "$2" --seed 5 --nice >"$work/states" &&
        compare "$1" --states "$work/states"
}
for vehicle in hmmwv_vehicle hmmwv_tmeasy; do # a check has a name of its own
    check "$vehicle: differences in quad precision" quad "$models/$vehicle.veh" 1,2,3,5,16
    check "$vehicle: states such as people write" written "$models/$vehicle.veh" 16
done
check 'states of a model: such as people write' written "$root/tests/data/laws/states.veh" 8

# ---- against linear models

# linear NAME MODEL [OPTION...] -- [SCENE TIME]
linear() {
    name=$1
    model=$2
    shift 2
    options=
    while [ "$1" != -- ]; do
        options="$options $1"
        shift
    done
    run --linearize -q ${3:+--at "$3"} "$model" ${2:+"$2"} -o "$work/linear.npz"
    check "$name: a linear model" exits 0
    # shellcheck disable=SC2086  # a list of words
    check "$name: the same by the code" compare "$model" --npz "$work/linear.npz" "$work/own.npz" $options
    "$python" -B "$root/tests/tools/linear_difference.py" "$gicrun" "$model" "$work/own.npz" ${2:+"$2"} >"$work/said" 2>&1
    verdict $? "$name: differences of another engine"
}
printf 'gicscene: 1\nduration: 1\nstep: 0.005\ninitial: {velocity: [8, 0, 0]}\n' >"$work/roll.scene"
linear 'pendulum' "$models/pendulum.veh" --
linear 'a vehicle' "$models/hmmwv.veh" --
linear 'reactions, tunable geometry' "$work/reacting.veh" -- "$work/roll.scene" 0.3
# the brake is at 0, where its limit makes a kink
run --linearize -q --at 3 "$models/hmmwv_vehicle.veh" "$models/scenes/lane_change.scene" -o "$work/linear.npz"
check 'a complete vehicle in a lane change' compare "$models/hmmwv_vehicle.veh" --npz "$work/linear.npz" "$work/own.npz" \
    --but brake

# ---- kinks, and what has no derivative

cat >"$work/kinks.veh" <<'END'
gicgen: 1
model: kinks
base: ground
gravity: [0, 0, 0]
inputs:
  a: {unit: N}
  b: {unit: N}
  c: {unit: N}
bodies:
  block: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  guide: {type: prismatic, bodies: [ground, block], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, block], axis: [1, 0, 0], range: [-9, 9]}
forces:
  size: {type: force, coordinate: x, value: "abs(a)"}
  root: {type: force, coordinate: x, value: "sqrt(b * b)"}
  angle: {type: force, coordinate: x, value: "atan2(a, b)"}
  most: {type: force, coordinate: x, value: "3 * max(a, b)"}
  way: {type: force, coordinate: x, value: "sqrt(c)"}
END
cat >"$work/kinks_main.c" <<'END'
#include "kinks.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static kinks v;
static kinks_direction d;

/* the derivative of the acceleration along a, b, x at a, b and x = 0 */
static int along(double a, double b, double da, double db, double dx, double wanted)
{
    int status;
    memset(&d, 0, sizeof d);
    v.input[0] = a, v.input[1] = b;
    d.input[0] = da, d.input[1] = db, d.state[0] = dx;
    status = kinks_tangent(&v, 0, v.state, &d);
    if (status == GIC_OK && d.rate[1] == wanted)
        return 0;
    printf("%g %g along %g %g %g: status %d, %.17g, not %g\n", a, b, da, db, dx, status, d.rate[1], wanted);
    return 1;
}

int main(void)
{
    int bad = kinks_setup(&v);
    bad += along(2, 1, 1, 0, 0, 1 + 1 / 5.0 + 3); /* abs, atan2, max */
    bad += along(-2, 0, 1, 0, 0, -1);
    bad += along(0, 0, 1, 0, 0, 0);  /* 0 for abs; atan2 has none; max takes b where both are equal */
    bad += along(0, 1, 0, 1, 0, 1 + 3);
    memset(&d, 0, sizeof d);
    d.input[2] = 1;
    if (kinks_tangent(&v, 0, v.state, &d) != GIC_ERROR_RESULT)
        bad += printf("a root that leaves 0 has a derivative\n");
    d.input[2] = NAN;
    if (kinks_tangent(&v, 0, v.state, &d) != GIC_ERROR_INPUT)
        bad += printf("a direction that is no number is taken\n");
    return bad != 0;
}
END
kinks() {
    "$gicgen" --derivatives "$work/kinks.veh" -o "$work/kinks.c" && gcc -std=c99 -w -I"$root/runtime" \
        "$work/kinks_main.c" "$work/kinks.c" "$root/runtime/gic_runtime.c" -o "$work/kinks" -lm && "$work/kinks"
} >"$work/said" 2>&1
check 'derivatives at kinks' kinks

# ---- the code compiles everywhere, and is the same without derivatives but for what is added

for name in hmmwv_vehicle pendulum; do "$gicgen" --derivatives "$models/$name.veh" -o "$work/$name.c" || exit 1; done
"$gicgen" --derivatives "$work/reacting.veh" -o "$work/reacting.c" || exit 1
cp "$root"/runtime/gic_runtime.[ch] "$work/"
cat >"$work/compilers" <<'END'
gcc -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wshadow
gcc -std=c99 -DGIC_FLOAT -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion
g++ -std=c++11 -x c++ -Wall -Wextra -Wpedantic -Wconversion -Wshadow
clang -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wshadow
tcc -std=c99 -Wall
END
while read -r how; do
    for name in hmmwv_vehicle pendulum reacting kinks; do
        # shellcheck disable=SC2086  # a list of words
        $how -Werror -I"$work" -c "$work/$name.c" -o "$work/$name.o" >"$work/said" 2>&1
        verdict $? "$how $name.c"
    done
done <"$work/compilers"
contains() { # the lines of FILE stand in OTHER, in order
    ! diff "$1" "$2" | grep '^<' | grep -q -v '_H 0x\|_H != 0x'
}
"$gicgen" "$models/hmmwv_vehicle.veh" -o "$work/plain.c"
sed 's/plain\.h/hmmwv_vehicle.h/' "$work/plain.c" >"$work/same.c"
check 'all lines of the plain code stay' contains "$work/same.c" "$work/hmmwv_vehicle.c"

refuses() {
    "$gicgen" "$@" "$models/hmmwv.veh" -o "$work/refused.c" >"$work/said" 2>&1
    [ $? -eq 2 ] && grep -q "without --batch and --scene" "$work/said" && [ ! -e "$work/refused.c" ]
}
check 'derivatives not for many vehicles' refuses --derivatives --batch 8
check 'derivatives not for one scene' refuses --derivatives --scene "$models/scenes/paper_run.scene"
check 'derivatives are of code' refuses --derivatives --sequence

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
