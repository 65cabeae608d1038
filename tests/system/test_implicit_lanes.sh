#!/bin/sh
# SPDX-License-Identifier: MIT
# test_implicit_lanes.sh GICGEN GICRUN: implicit steps of code in lanes (`gicgen --implicit --lanes W`) against those of code without: the
# Jacobian and the masses bit for bit, where both call the C library, at states such as people write too; states after 120 steps of each
# method, with Jacobians of each step, kept ones and shared ones, to rounding; copies go on with the same bits; contacts and gears in
# gicrun; compilers, sanitizers; what is not asked for is not there.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1
models=$root/models
mkdir lanes single
cat >steps.c <<'END_OF_PROGRAM'
#include <stdio.h>
#include <string.h>
#define TEXT_OF(x) #x
#define TEXT(x) TEXT_OF(x)
#define JOIN_OF(a, b) a##b
#define JOIN(a, b) JOIN_OF(a, b)
#include TEXT(MODEL.h)
enum { STATES = sizeof((MODEL *)0)->state / sizeof(gic_real), INPUTS = sizeof((MODEL *)0)->input / sizeof(gic_real) };
static MODEL car, copy;
static gic_real jacobian[sizeof car.implicit_number / sizeof(gic_real)];
static int failed;
static gic_real chance(void)
{
    static uint32_t seed = 1;
    seed = seed * 1664525u + 1013904223u;
    return (gic_real)(seed >> 8) / 8388608 - 1;
}
static void begin(int keep, int spread)
{
    failed += JOIN(MODEL, _setup)(&car) != GIC_OK;
    car.implicit.keep = keep;
    car.implicit.spread = spread;
}
/* The Jacobian and the masses at the start, at states about it, some with all numbers moved alike, some turned by quarters and halves. */
static void jacobians(void)
{
    static const gic_real turn[4][4] = {
        {1, 0, 0, 0}, {(gic_real)0.70710678118654757, 0, 0, (gic_real)0.70710678118654757}, {0, 0, 0, 1}, {(gic_real)0.5, (gic_real)0.5, (gic_real)0.5, (gic_real)0.5}};
    const gic_model *model = &JOIN(MODEL, _model);
    const int count = STATES * model->implicit->columns + model->implicit->mass_count;
    gic_real state[STATES], rate[STATES];
    int good = 0;
    begin(1, 0);
    for (int k = 0; k < 16; ++k) {
        memcpy(state, car.state, sizeof state);
        for (int i = 0; i < STATES && k > 0; ++i)
            state[i] += k % 4 == 3 ? (gic_real)0.0078125 : (gic_real)0.001 * chance();
        for (int i = 0; i < 4 && FREE && k > 3; ++i)
            state[3 + i] = turn[k % 4][i];
        for (int i = 0; i < INPUTS && k > 2; ++i)
            car.input[i] = (gic_real)0.01 * chance();
        const int status = JOIN(MODEL, _rhs)(&car, 0, state, rate);
        const int found = status == GIC_OK ? model->implicit->jacobian(&car, 0, state, jacobian) : status;
        printf("%d %d\n", status, found);
        good += found == GIC_OK;
        for (int i = 0; i < count && found == GIC_OK; ++i)
            printf("%a\n", (double)jacobian[i]);
    }
    failed += good < 10;
}
static void runs(void)
{
    static const gic_method method[] = {GIC_ROS2, GIC_ROS3, GIC_IMEX};
    static const int keep[] = {1, 7, 16, 16};
    for (int m = 0; m < 3; ++m)
        for (int k = 0; k < 4; ++k) {
            begin(keep[k], k == 3);
            for (int i = 0; i < 120; ++i) {
                if (i == 25)
                    copy = car;
                failed += JOIN(MODEL, _step)(&car, (gic_real)0.001, method[m]) != GIC_OK;
            }
            for (int i = 25; i < 120; ++i)
                failed += JOIN(MODEL, _step)(&copy, (gic_real)0.001, method[m]) != GIC_OK;
            failed += memcmp(copy.state, car.state, sizeof car.state) != 0;
            printf("%d %d\n", (int)method[m], (int)car.implicit.jacobian_count);
            for (int i = 0; i < STATES; ++i)
                printf("%.17g\n", (double)car.state[i]);
        }
}
int main(int words, char **word)
{
    (void)word;
    if (words > 1)
        jacobians();
    else
        runs();
    return failed != 0;
}
END_OF_PROGRAM
# Numbers of two files, two columns of one file, are off by at most $1, relative to 1 + their magnitude; lines of two numbers are equal.
near() {
    awk -v most="$1" 'NF == 4 { bad += $1 != $3 || $2 != $4; next }
        { d = $1 - $2; size = 1 + ($1 < 0 ? -$1 : $1); d = (d < 0 ? -d : d) / size; if (!(d <= worst)) worst = d }
        END { print NR, "lines,", worst + 0, "off"; exit !(NR > 12 && !bad && worst <= most) }'
}
# steps WIDTH TOLERANCE MODEL "OPTIONS" COMPILER [FLAG...]: tolerances are some thousand roundings
steps() {
    width=$1 most=$2 file=$3 options=$4
    shift 4
    model=$(basename "$file" .veh)
    free=1
    case $model in pendulum | quarter_car | chain) free=0 ;; esac
    what="$model, $width lanes $options: $*"
    for way in single lanes; do
        lanes=
        [ $way = single ] || lanes="--lanes $width"
        # shellcheck disable=SC2086  # options
        "$gicgen" --implicit $options $lanes "$file" -o "$way/$model.c" >said 2>&1 &&
            "$@" -Wno-psabi -ffp-contract=off -I"$way" -I"$root/runtime" "-DMODEL=$model" "-DFREE=$free" steps.c "$way/$model.c" "$root/runtime/gic_runtime.c" -o run -lm >said 2>&1 &&
            ./run jacobians >"$way/jacobians" 2>said && ./run >"$way/states" 2>said
        check "$what: runs, $way" [ $? -eq 0 ]
    done
    check "$what: Jacobians, bit for bit" cmp single/jacobians lanes/jacobians
    paste single/states lanes/states | near "$most" >said
    verdict $? "$what: states"
}
strict='-std=c99 -O0 -Wall -Wextra -Wshadow -Wconversion -Wpedantic -Werror'
# shellcheck disable=SC2086  # flags
{
    steps 4 1e-12 "$models/hmmwv.veh" --spread-jacobian gcc $strict
    steps 2 1e-12 "$models/hmmwv.veh" '' clang $strict
    steps 4 1e-12 "$models/hmmwv.veh" '--recovery newton --spread-jacobian' gcc $strict
    steps 8 1e-12 "$models/hmmwv_tires.veh" --derivatives gcc $strict
    steps 4 1e-12 "$models/hmmwv_tires.veh" --spread-jacobian gcc -std=c99 -O0 -g -fsanitize=address,undefined -fno-sanitize-recover=all -w
    steps 4 1e-12 "$models/hmmwv_vehicle.veh" --spread-jacobian clang $strict
    steps 2 1e-11 "$models/hatchback.veh" --spread-jacobian gcc -std=c99 -O0 -w
    steps 4 1e-12 "$models/hmmwv.veh" '--solve augmented' gcc $strict
    steps 4 1e-3 "$models/hmmwv_tires.veh" '' gcc $strict -Wdouble-promotion -DGIC_FLOAT
    # nothing alike
    steps 4 0 "$models/pendulum.veh" --spread-jacobian gcc $strict
    steps 16 0 "$models/quarter_car.veh" --spread-jacobian gcc $strict
    sh "$root/tests/lib/chain.sh" 6 >chain.veh && steps 4 1e-12 chain.veh '--solve articulated' gcc $strict
}
for how in 'g++ -std=c++11' 'clang++ -std=c++11'; do
    $how -x c++ -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wno-psabi -Werror -O0 -Ilanes -I"$root/runtime" -c lanes/hmmwv_vehicle.c -o x.o
    verdict $? "$how"
done

# ---- what is not asked for: explicit steps have the same bits, instances no copies

cat >explicit.c <<'END_OF_PROGRAM'
#include "hmmwv_vehicle.h"
#include <stdio.h>
static hmmwv_vehicle car;
int main(void)
{
    int status = hmmwv_vehicle_setup(&car);
    for (int i = 0; i < 200 && status == GIC_OK; ++i)
        status = hmmwv_vehicle_step(&car, (gic_real)0.001, i < 100 ? GIC_AB3 : GIC_RK4);
    for (unsigned i = 0; i < sizeof car.state / sizeof *car.state; ++i)
        printf("%a\n", (double)car.state[i]);
    return status;
}
END_OF_PROGRAM
for options in '' --implicit; do
    # shellcheck disable=SC2086  # options
    "$gicgen" --lanes 4 $options "$models/hmmwv_vehicle.veh" -o hmmwv_vehicle.c &&
        gcc -std=c99 -O0 -w -Wno-psabi -I. -I"$root/runtime" explicit.c hmmwv_vehicle.c "$root/runtime/gic_runtime.c" -o run -lm && ./run >"explicit$options"
    check "explicit steps $options" [ $? -eq 0 ]
done
check "explicit steps have the same bits" cmp explicit explicit--implicit
check "no copies in an instance" sh -c '! grep -q flat_ hmmwv_vehicle.h'

# ---- gicrun: contacts, gears, a reference with exact Jacobians

# same_run NAME MODEL TOLERANCE [OPTION...]: NAME.scene
same_run() {
    run=$1 model=$2 most=$3
    shift 3
    for lanes in '' 4; do
        "$gicrun" --quiet --engine cc --cflags -O0 ${lanes:+--lanes "$lanes"} "$@" "$model" "$run.scene" -o "run$lanes.csv" >said 2>&1
        check "$run: gicrun, lanes '$lanes'" [ $? -eq 0 ]
    done
    tail -n +2 run.csv | tr , '\n' >one && tail -n +2 run4.csv | tr , '\n' >four && paste one four | near "$most" >said
    verdict $? "$run: the same run"
}
for way in 'ros2 1' 'ros3 4' 'imex 8 spread_jacobian:'; do
    # shellcheck disable=SC2086  # words
    set -- $way
    {
        sed '/^ratio/d; s/^duration:.*/duration: 3/; s/^step:.*/step: 0.004/; s/^output_step:.*/output_step: 0.04/; s/times: \[0.5, 0.8, 12, 12.3\]/times: [0.1, 0.2, 2.6, 2.7]/; s/times: \[0.2, 0.6, 12.5, 13\]/times: [0.05, 0.1, 2.7, 2.8]/; s/^integrator:.*/integrator: '"$1"'/' \
            "$models/scenes/acceleration_braking.scene"
        printf 'keep_jacobian: %s\n' "$2"
        [ -z "$3" ] || echo "$3 true"
    } >"gears_$1.scene"
    same_run "gears_$1" "$models/hmmwv_vehicle.veh" 1e-8
done
sed '/^ratio/d; /^integrator/d; s/^step:.*/step: 0.002/; s/^duration:.*/duration: 1/' "$models/scenes/tires_jump.scene" >jump.scene
printf '%s\n' 'integrator: ros2' 'keep_jacobian: 4' >>jump.scene
same_run jump "$models/hmmwv_tires.veh" 1e-8
printf '%s\n' 'gicscene: 1' 'duration: 0.5' 'step: 0.01' 'integrator: auto' >auto.scene
same_run auto "$models/hmmwv.veh" 1e-9

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
