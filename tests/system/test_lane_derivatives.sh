#!/bin/sh
# SPDX-License-Identifier: MIT
# test_lane_derivatives.sh GICGEN STATES: derivatives of code in lanes (`gicgen --derivatives --lanes W`), against dual
# numbers over the code without lanes, 1e-13 (derivatives/compare.py), at states such as people write too; against each
# other, forwards and backwards; whole runs against the same slopes of code without lanes; single precision; compilers;
# the code in lanes is the same without derivatives.
gicgen=$(realpath "$1")
states=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
models=$root/models
programs=$root/tests/derivatives
runtime=$root/runtime
compare() { /usr/bin/python3 -B "$programs/compare.py" "$gicgen" "$@" >"$work/said" 2>&1; }
mkdir "$work/lanes" "$work/single"

# ---- against dual numbers over the code without lanes

check 'a vehicle' compare "$models/hmmwv.veh" -n 2 --lanes 4
check "a vehicle, by Newton's iteration" compare "$models/hmmwv.veh" -n 1 --lanes 4 --option=--recovery=newton
check 'tires and powertrain on a wavy road' compare "$models/hmmwv_vehicle.veh" -n 1 --wave --lanes 4
check 'more lanes than parts' compare "$models/hmmwv_tires.veh" -n 1 --lanes 8
check 'nothing alike' compare "$models/pendulum.veh" -n 2 --lanes 4
sh "$root/tests/lib/chain.sh" 6 >"$work/chain.veh" && check 'a chain, articulated form' compare "$work/chain.veh" -n 1 \
    --lanes 4 --option=--solve=articulated
check 'augmented form' compare "$models/hmmwv.veh" -n 1 --lanes 4 --option=--solve=augmented
written() {
    "$gicgen" --dump-model "$1" >"$work/dump" && "$states" "$work/dump" --count 8 --seed 5 --nice >"$work/states" &&
        compare "$1" --states "$work/states" --lanes 4
}
check 'states such as people write' written "$models/hmmwv_vehicle.veh"
"$gicgen" --dump-model "$root/tests/data/tuning/car.veh" >"$work/dump" &&
    sh "$root/tests/lib/reactions.sh" "$work/dump" "$root/tests/data/tuning/car.veh" >"$work/reacting.veh"
check 'reactions, tunable geometry' compare "$work/reacting.veh" -n 1 --lanes 4

# ---- both ways; whole runs, beside the code without lanes

# code MODEL: with lanes and without
code() {
    "$gicgen" --derivatives --lanes 4 "$models/$1.veh" -o "$work/lanes/$1.c" &&
        "$gicgen" --derivatives "$models/$1.veh" -o "$work/single/$1.c"
} >"$work/said" 2>&1
# both_ways COMPILER MODEL
both_ways() {
    "$1" -std=c99 -O0 -w -Wno-psabi "-I$work/lanes" "-I$runtime" "-DMODEL=$2" "-DCODE=\"$2.c\"" "$programs/both_ways.c" \
        "$runtime/gic_runtime.c" -o "$work/both" -lm && "$work/both" 200 1e-13
} >"$work/said" 2>&1
# whole FOLDER COMPILER MODEL STEPS STEP TOLERANCE [FLAG]: slopes in FOLDER/slopes
whole() {
    "$2" -std=c99 -O0 -w -Wno-psabi ${7:+"$7"} "-I$work/$1" "-I$runtime" "-DMODEL=$3" "-DCODE=\"$3.c\"" \
        "$programs/whole_run.c" "$runtime/gic_runtime.c" "$runtime/gic_gradient.c" -o "$work/whole" -lm &&
        "$work/whole" "$4" "$5" "$6" >"$work/$1/slopes"
} 2>"$work/said"
# same_run COMPILER MODEL STEPS STEP TOLERANCE [FLAG]: backwards as forwards in lanes, and the slopes of the code without
# them; elementary functions of tires in lanes are not those of the C library, so that runs differ by roundings
same_run() {
    whole lanes "$@" && whole single "$@" && paste "$work/lanes/slopes" "$work/single/slopes" | awk -v most="$5" '{
        off = $1 - $3; off = off < 0 ? -off : off
        worst = off / $4 > worst ? off / $4 : worst
    } END { print NR, "slopes,", worst, "off"; exit !(NR == 8 && worst <= most) }' >"$work/said"
}
for model in hmmwv hmmwv_vehicle hatchback; do
    check "$model: code" code "$model"
    check "$model: backwards as forwards" both_ways gcc "$model"
    [ "$model" = hatchback ] || check "$model: backwards as forwards, clang" both_ways clang "$model"
done
check 'hmmwv: a run' same_run gcc hmmwv 40 0.002 1e-13
check 'hmmwv: a run, clang' same_run clang hmmwv 40 0.002 1e-13
check 'hmmwv_vehicle: a run' same_run gcc hmmwv_vehicle 12 0.001 1e-12
check 'hmmwv: a run in single precision' same_run gcc hmmwv 40 0.002 1e-5 -DGIC_FLOAT
check 'hmmwv: a run in single precision, clang' same_run clang hmmwv 40 0.002 1e-5 -DGIC_FLOAT

# ---- compilers; what is not asked for is not there

while read -r how; do
    for model in hmmwv hmmwv_vehicle; do
        # shellcheck disable=SC2086  # a list of words
        $how -Werror "-I$runtime" -c "$work/lanes/$model.c" -o "$work/code.o" >"$work/said" 2>&1
        verdict $? "$how $model.c"
    done
done <<'END_OF_COMPILERS'
gcc -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wshadow
gcc -std=c99 -DGIC_FLOAT -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion
g++ -std=c++11 -x c++ -Wall -Wextra -Wpedantic -Wconversion -Wshadow
clang -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wshadow
END_OF_COMPILERS
contains() { # the lines of FILE stand in OTHER, in order
    ! diff "$1" "$2" | grep '^<' | grep -q -v '_H 0x\|_H != 0x'
}
"$gicgen" --lanes 4 "$models/hmmwv.veh" -o "$work/plain.c"
sed 's/plain\.h/hmmwv.h/' "$work/plain.c" >"$work/same.c"
check 'all lines of the code in lanes stay' contains "$work/same.c" "$work/lanes/hmmwv.c"
check 'those of its header, too' contains "$work/plain.h" "$work/lanes/hmmwv.h"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
