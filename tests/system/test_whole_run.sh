#!/bin/sh
# SPDX-License-Identifier: MIT
# test_whole_run.sh GICGEN: derivatives of whole runs by generated code (gic_gradient.h), tangents against adjoints, 1e-13,
# and both against differences of runs of the same code in quad precision; right-hand sides and outputs backwards against
# forwards at 1,000 random states of every model, 1e-13; all checkpoints and few; single precision; vehicles of a batch (derivatives/*.c).
gicgen=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
models=$root/models
programs=$root/tests/derivatives
runtime=$root/runtime

# write FILE [OPTION...]: the code of a model
write() {
    file=$1
    shift
    mkdir -p "$work/code" && "$gicgen" --derivatives "$@" "$file" -o "$work/code/$(named "$file").c" >"$work/said" 2>&1
}
named() { sed -n 's/^model: *//p' "$1"; }

# both_ways NAME TOLERANCE
both_ways() {
    gcc -std=c99 -O0 -w -I"$work/code" -I"$runtime" "-DMODEL=$1" "-DCODE=\"$1.c\"" "$programs/both_ways.c" \
        "$runtime/gic_runtime.c" -o "$work/both" -lm && "$work/both" 1000 "$2"
} >"$work/said" 2>&1

# whole NAME STEPS STEP TOLERANCE [FLAG]: slopes in slopes
whole() {
    gcc -std=c99 -O1 -w ${5:+"$5"} -I"$work/code" -I"$runtime" "-DMODEL=$1" "-DCODE=\"$1.c\"" "$programs/whole_run.c" \
        "$runtime/gic_runtime.c" "$runtime/gic_gradient.c" -o "$work/whole" -lm &&
        "$work/whole" "$2" "$3" "$4" >"$work/slopes"
} 2>"$work/said"

mkdir "$work/quad"
sed 's/typedef double gic_real;/typedef __float128 gic_real;/
s/^        gic_real number;/        double number;/
s/look.number = x;/look.number = (double)x;/' "$runtime/gic_runtime.h" >"$work/quad/gic_runtime.h"
cp "$runtime/gic_runtime.c" "$runtime/gic_gradient.h" "$work/quad/"

# quad NAME STEPS STEP: the same slopes by differences
quad() {
    cp "$work/code/$1".[ch] "$work/quad/"
    gcc -std=gnu99 -O0 -w -DQUAD -I"$work/quad" -include "$programs/quad_real.h" "-DMODEL=$1" "-DCODE=\"$1.c\"" \
        "$programs/whole_run.c" "$work/quad/gic_runtime.c" -o "$work/quad/run" -lquadmath -lm &&
        "$work/quad/run" "$2" "$3" >"$work/differences" &&
        paste "$work/slopes" "$work/differences" | awk '{
            off = $1 - $3; off = off < 0 ? -off : off
            worst = off / $2 > worst ? off / $2 : worst
        } END { print NR, "slopes,", worst, "off"; exit !(NR == 8 && worst <= 1e-13) }'
} >"$work/said" 2>&1

# ---- at random states, and whole runs both ways

for file in "$models"/*.veh "$root/tests/data/tuning/car.veh"; do
    model=$(named "$file")
    check "$model: code" write "$file"
    check "$model: backwards as forwards" both_ways "$model" 1e-13
done
while read -r model steps step; do
    check "$model: a run backwards as forwards" whole "$model" "$steps" "$step" 1e-13
    check "$model: a run in quad precision" quad "$model" "$steps" "$step"
done <<END
pendulum 60 0.01
andrews 20 0.00002
quarter_car 40 0.002
hmmwv 40 0.002
hmmwv_tires 20 0.001
hmmwv_vehicle 12 0.001
car 20 0.001
END
for model in pendulum hmmwv; do
    check "$model: a run in single precision" whole "$model" 40 0.002 1e-5 -DGIC_FLOAT
done
check "by Newton's iteration: code" write "$models/hmmwv.veh" --recovery=newton
check "by Newton's iteration: backwards as forwards" both_ways hmmwv 1e-13
check "by Newton's iteration: a run backwards as forwards" whole hmmwv 24 0.002 1e-13
check "by Newton's iteration: a run in quad precision" quad hmmwv 24 0.002

# ---- vehicles of a batch, the same bits as by themselves

batch() { # NAME [FLAG]
    "$gicgen" --batch 6 "$models/$1.veh" -o "$work/code/$1_batch.c" &&
        gcc -std=gnu11 -O0 -w -ffp-contract=off -DGIC_BATCH_LIBM ${2:+"$2"} -I"$work/code" -I"$runtime" "-DMODEL=$1" "-DCODE=\"$1_batch.h\"" \
            "$programs/batch.c" "$work/code/$1.c" "$work/code/$1_batch.c" "$runtime/gic_runtime.c" -o "$work/batch" -lm && "$work/batch"
} >"$work/said" 2>&1
check 'vehicles of a batch: code' write "$models/hmmwv.veh"
for model in pendulum hmmwv hmmwv_vehicle; do check "$model: vehicles of a batch" batch "$model"; done
check 'hmmwv_vehicle: vehicles of a batch, single precision' batch hmmwv_vehicle -DGIC_FLOAT

# ---- what has no derivative: a gear that is left at the start of a run

cat >"$work/gear.c" <<'END'
#include "gic_gradient.h"
#include "hmmwv_vehicle.h"

#include <stdio.h>
#include <stdlib.h>

static gic_real weigh(void *user, int64_t number, const void *self, gic_real *by_state, gic_real *by_output)
{
    (void)user, (void)number, (void)self, (void)by_output;
    by_state[0] = 1;
    return 0;
}

int main(void)
{
    static hmmwv_vehicle start;
    static hmmwv_vehicle_direction along;
    gic_gradient run = {0};
    gic_real slope = 7;
    int bad = hmmwv_vehicle_setup(&start);
    run.code = &hmmwv_vehicle_derivatives;
    run.start = &start;
    run.step = 1e-3;
    run.steps = 3;
    run.checkpoints = 3;
    run.weigh = weigh;
    start.input[HMMWV_VEHICLE_INPUT_SELECTOR] = 0;
    run.size = 10000000;
    run.memory = malloc(run.size);
    bad |= gic_run_tangent(&run, &along, &slope) != GIC_ERROR_EVENTS || slope != 7;
    bad |= gic_run_adjoint(&run, &along) != GIC_ERROR_EVENTS;
    start.input[HMMWV_VEHICLE_INPUT_SELECTOR] = 1;
    bad |= gic_run_tangent(&run, &along, &slope) != GIC_OK || gic_run_adjoint(&run, &along) != GIC_OK;
    return bad;
}
END
gear() {
    gcc -std=c99 -O0 -w -I"$work/code" -I"$runtime" "$work/gear.c" "$work/code/hmmwv_vehicle.c" "$runtime/gic_runtime.c" \
        "$runtime/gic_gradient.c" -o "$work/gear" -lm && "$work/gear"
} >"$work/said" 2>&1
check 'a gear that changes has no derivative' gear

# ---- the file compiles everywhere

while read -r how; do
    # shellcheck disable=SC2086  # a list of words
    $how -Werror -I"$runtime" -c "$runtime/gic_gradient.c" -o "$work/gradient.o" >"$work/said" 2>&1
    verdict $? "$how"
done <<'END'
gcc -std=c99 -O2 -Wall -Wextra -Wpedantic -Wconversion -Wshadow
gcc -std=c99 -DGIC_FLOAT -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion
clang -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wshadow
tcc -std=c99 -Wall
END

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
