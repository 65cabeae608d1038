#!/bin/sh
# SPDX-License-Identifier: MIT
# test_random_derivatives.sh GICGEN RANDOM_VEHICLE GICRUN: derivatives in the code of random mechanisms, MODELS (5) of them from the
# seed FIRST (1) on: right-hand sides and outputs forwards against backwards at 100 random states, 1e-13 of the terms'
# magnitudes and what roundings of the state change (derivatives/both_ways.c); whole runs forwards against backwards, 1e-13,
# and against differences of runs of the same code in quad precision, 1e-9, with remainders that shrink with the square of
# the change (derivatives/whole_run.c). And whole
# runs of gicrun --gradient, some of which a condition ends, by such remainders (vehicle/gradient_random.py). A model that gicgen
# refuses is left out. A line for each failure.
gicgen=$(realpath "$1")
random_vehicle=$(realpath "$2")
gicrun=$(realpath "$3")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
programs=$root/tests/derivatives
runtime=$root/runtime
first=${FIRST:-1}
last=$((first + ${MODELS:-5} - 1))

mkdir "$work/code" "$work/quad"
sed 's/typedef double gic_real;/typedef __float128 gic_real;/
s/^        gic_real number;/        double number;/
s/look.number = x;/look.number = (double)x;/' "$runtime/gic_runtime.h" >"$work/quad/gic_runtime.h"
cp "$runtime/gic_runtime.c" "$runtime/gic_gradient.c" "$runtime/gic_gradient.h" "$work/quad/"

both_ways() {
    gcc -std=c99 -O0 -w -I"$work/code" -I"$runtime" "-DMODEL=$model" "-DCODE=\"$model.c\"" "$programs/both_ways.c" \
        "$work/runtime.o" -o "$work/both" -lm && "$work/both" 100 1e-13 conditioned
} >"$work/said" 2>&1
whole() {
    gcc -std=c99 -O0 -w -I"$work/code" -I"$runtime" "-DMODEL=$model" "-DCODE=\"$model.c\"" "$programs/whole_run.c" \
        "$work/runtime.o" "$work/gradient.o" -o "$work/whole" -lm && "$work/whole" 12 0.001 1e-13 >"$work/slopes"
} 2>"$work/said"
# The same slopes by differences; remainders, over h, halve with h, or are rounding: these are of a double's slope, which an
# angle near a quarter turn (a pitch) may lose digits of.
quad() {
    cp "$work/code/$model".[ch] "$work/quad/"
    gcc -std=gnu99 -O0 -w -DQUAD -I"$work/quad" -include "$programs/quad_real.h" "-DMODEL=$model" "-DCODE=\"$model.c\"" \
        "$programs/whole_run.c" "$work/quad_runtime.o" -o "$work/quad/run" -lquadmath -lm &&
        "$work/quad/run" 12 0.001 1e-8 "$work/slopes" >"$work/differences" &&
        paste "$work/slopes" "$work/differences" | awk '
            function magnitude(x) { return x < 0 ? -x : x }
            { off = magnitude($1 - $3) / $2
              worst = off > worst ? off : worst
              bad += !(magnitude($4 / 2 - $5) <= 0.02 * magnitude($5) + 1e-12 * $2) }
            END { print NR, "slopes,", worst, "off,", bad + 0, "remainders"; exit !(NR == 8 && worst <= 1e-9 && !bad) }'
} >"$work/said" 2>&1

gcc -std=c99 -O1 -w -I"$runtime" -c "$runtime/gic_runtime.c" -o "$work/runtime.o" &&
    gcc -std=c99 -O1 -w -I"$runtime" -c "$runtime/gic_gradient.c" -o "$work/gradient.o" &&
    gcc -std=gnu99 -O1 -w -I"$work/quad" -include "$programs/quad_real.h" -c "$work/quad/gic_runtime.c" -o "$work/quad_runtime.o" || exit 1
seed=$first
refused=0
while [ "$seed" -le "$last" ]; do
    model=random_$seed
    "$random_vehicle" --seed "$seed" --mechanism >"$work/$model.veh"
    if "$gicgen" --derivatives "$work/$model.veh" -o "$work/code/$model.c" >"$work/said" 2>&1; then
        check "mechanism $seed: backwards as forwards" both_ways
        check "mechanism $seed: a run backwards as forwards" whole
        check "mechanism $seed: a run in quad precision" quad
    else
        refused=$((refused + 1))
    fi
    seed=$((seed + 1))
done
check 'not all are refused' [ "$refused" -lt $(((last - first + 2) / 2)) ]
/usr/bin/python3 -B "$root/tests/vehicle/gradient_random.py" "$gicrun" "$root/models" "$work" "$random_vehicle" "$first" \
    "$((last - first + 1))" >"$work/said" 2>&1
verdict $? 'runs that conditions end'
echo "$refused mechanisms refused by gicgen"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
