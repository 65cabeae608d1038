#!/bin/sh
# SPDX-License-Identifier: MIT
# test_tire_tables.sh GICGEN: tires by table. Forces and moments at the states of test_tires.sh are within 1e-6 of the load
# of the published formulas (tests/data/tires); curves are near what they stand for up to and beyond the end of their
# tables, at 0 and where there is no number, without a step of their slope; by short polynomials, in lanes and for many
# vehicles at once (tests/data/tires/by_batch.c), forces are within the same bound; the code compiles without a warning by gcc and
# clang, as C99 and C++, with either number type; what can't be by table is refused with a remedy.
gicgen=$(realpath "$1")
here=$(cd "$(dirname "$0")/.." && pwd)
runtime=$(cd "$here/../runtime" && pwd)
models=$(cd "$here/../models" && pwd)
# shellcheck source=tests/lib/checking.sh
. "$here/lib/checking.sh"
cd "$work" || exit 1
: >out
: >err
cp "$here/data/tires/rig.veh" "$here/data/tires/car.tir" .
cp "$models/tires/hmmwv_pac2002.tir" truck.tir
for mode in 0 1 2 3; do
    sed "s/^USE_MODE = 4/USE_MODE = $mode/" car.tir >car_$mode.tir
done
"$gicgen" --tire-tables rig.veh -o rig.c
cp rig.c before.c
check "what it is off by is said in the header" [ "$(grep -c "by table (--tire-tables): forces off by at most [2-4].[0-9]e-08 of" rig.h)" -eq 5 ]
"$gicgen" --tire-tables rig.veh -o rig.c
check "the same bytes again" cmp before.c rig.c
mkdir plain && "$gicgen" rig.veh -o plain/rig.c
check "no tables without the option" sh -c '! grep -q curve plain/rig.c'

# beside the tables' own numbers there is none that the code without tables does not have: measuring leaves the graph as it was
literals() { sed '/^static const gic_real .*_cell\[/,/^};/d; /_curve(gic_real/,/^}/d; /_curve_[0-9]*(gic_real/,/^}/d' "$1" | grep -oE 'R\([0-9.e+-]+\)' | sort -u; }
literals plain/rig.c >plain.txt
literals rig.c >tables.txt
check "no other numbers" sh -c '! comm -13 plain.txt tables.txt | grep -q .'

compiles() {
    "$@" -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Werror -ffp-contract=off -I"$runtime" -c rig.c \
        -o x.o >out 2>&1
}
check "gcc" compiles gcc -std=c99 -O1
check "gcc, float" compiles gcc -std=c99 -O1 -DGIC_FLOAT
check "clang, float" compiles clang -std=c99 -O0 -DGIC_FLOAT
check "g++" compiles g++ -std=c++11 -x c++ -O0

# two lines: the comment with the function, and the name of the curve
sed -n -e 's,^/\* \(GIC_.*\) within .*,\1,p' -e 's,^static gic_real \(rig_curve_[0-9]*\)(gic_real x)$,\1,p' rig.c |
    sed 'N;s/^\(.*\)\n\(.*\)$/LOOK(\2, \1)/' >curves.inc
check "there are curves" [ "$(grep -c LOOK curves.inc)" -ge 10 ]
cp "$here/data/tires/by_table.c" .
program() {
    cc -std=c99 "$@" -I. -I"$runtime" by_table.c "$runtime/gic_runtime.c" -o by_table -lm >out 2>err
}
check "a program, float" program -O1 -DGIC_FLOAT
check "curves, float" ./by_table curves
check "a program" program -O1 -ffp-contract=off
./by_table curves >said
check "curves" [ $? -eq 0 ]
check "all curves" [ "$(grep -c within said)" -eq "$(grep -c LOOK curves.inc)" ]
cat said >>out

# against RADIUS FRICTION WHEEL...: as in test_tires.sh
against() {
    radius=$1 friction=$2
    shift 2
    python3 "$here/data/tires/compare.py" states "$radius" >states.csv
    ./by_table "$friction" <states.csv >results.csv
    check "it ran" [ $? -eq 0 ]
    python3 "$here/data/tires/compare.py" check . "$friction" --within 1e-6 "$@" <results.csv >said 2>err
    check "$*, friction $friction" sh -c "! grep -v ^ok said && [ \$(grep -c ^ok said) -eq $# ]"
}
for friction in 1 0.35; do
    against 0.4699 "$friction" truck truck_right
    against 0.317 "$friction" car car_right car_0 car_1 car_2 car_3
done
# the same states by short polynomials: in lanes, and four vehicles at once, each with the bits that it has alone
mkdir lanes && cp by_table.c rig.veh ./*.tir lanes
cd lanes || exit 1
check "lanes" "$gicgen" --tire-tables --lanes 4 rig.veh -o rig.c
check "what it is off by in lanes" [ "$(grep -c "by short polynomials (--tire-tables): forces off by at most [0-9].[0-9]e-09 of" rig.h)" -ge 1 ]
check "tires in lanes and others" grep -q "LANE_SHORT_COSINE" rig.c
check "C++" g++ -std=gnu++11 -x c++ -O0 -fsyntax-only -Wno-psabi -I"$runtime" rig.c
: >curves.inc
cc -std=gnu11 -O2 -ffp-contract=off -Wno-psabi -Wno-unused -I. -I"$runtime" by_table.c "$runtime/gic_runtime.c" -o by_table -lm >out 2>err
check "a program in lanes" [ $? -eq 0 ]
for friction in 1 0.35; do
    against 0.4699 "$friction" truck truck_right
    against 0.317 "$friction" car car_right car_0 car_1 car_2 car_3
done
mkdir ../batch && cp rig.veh ./*.tir ../batch && cd ../batch || exit 1
"$gicgen" rig.veh -o rig.c
check "many vehicles" "$gicgen" --tire-tables --batch 4 rig.veh -o rig_batch.c
check "what it is off by for many" [ "$(grep -c "by short polynomials (--tire-tables): forces off by at most [0-9].[0-9]e-09 of" rig_batch.c)" -eq 5 ]
for compiler in gcc clang; do
    $compiler -std=gnu11 -O2 -ffp-contract=off -Wno-psabi -Wno-unused -I. -I"$runtime" "$here/data/tires/by_batch.c" rig.c rig_batch.c \
        "$runtime/gic_runtime.c" -o by_table -lm >out 2>err
    check "a program for many vehicles, $compiler" [ $? -eq 0 ]
    against 0.4699 1 truck truck_right
    against 0.317 0.35 car car_right car_0 car_1 car_2 car_3
done
cd .. || exit 1
# wheels with different tires in one vector: each is measured
mkdir two && cp "$models"/hmmwv*.veh two && cp -r "$models/parts" "$models/tires" two
sed 's/^PEX1 = .*/PEX1 = 0.3/; s/^PCY1 = .*/PCY1 = 1.45/' truck.tir >two/tires/other.tir
sed -i 's,^  all: {file: ../tires/hmmwv_pac2002.tir},&\n  other: {file: ../tires/other.tir},' two/parts/on_tires.veh
sed -i '/tire_r_l:/,/tire: all/s/tire: all/tire: other/' two/hmmwv_tires.veh
check "two tires" "$gicgen" --tire-tables --lanes 4 two/hmmwv_tires.veh -o two.c
check "both are said" grep -q "^ \* Tires 'all', 'other' by short polynomials" two.c
sed 's/^PEX1 = .*/PEX1 = -1e6/' truck.tir >two/tires/other.tir
"$gicgen" --tire-tables --lanes 4 two/hmmwv_tires.veh -o two.c >out 2>err
check "the second one is refused" grep -q "errors of short polynomials for tire 'other' may add up to" err
check "derivatives beside" "$gicgen" --tire-tables --derivatives --implicit rig.veh -o derived.c
check "for one scene" "$gicgen" --tire-tables --scene "$models/scenes/tires_brake.scene" "$models/hmmwv_tires.veh" \
    -o scene.c

# refused: STATUS TEXT ARGUMENT...
refused() {
    status=$1 text=$2
    shift 2
    rm -f none.c
    "$gicgen" "$@" -o none.c >out 2>err
    got=$?
    check "refused: $text" [ $got -eq "$status" ]
    check "with the message: $text" grep -q -e "$text" err
    check "with the remedy: $text" grep -q -e "$([ "$status" -eq 2 ] && echo "gicgen -h" || echo "leave --tire-tables out")" err
    check "nothing is written: $text" [ ! -e none.c ]
}
refused 1 "no tire of 'hmmwv_tmeasy' has a Magic Formula" --tire-tables "$models/hmmwv_tmeasy.veh"
refused 1 "no wheel of 'hmmwv' has a tire" --tire-tables "$models/hmmwv.veh"
refused 2 "tire-tables is for code" --tire-tables --fmu 2 "$models/hmmwv_tires.veh"
# a peak of combined slip at kappa = -RHY1 so narrow that places miss it: errors of tables divided by its small value at kappa = 0
cp truck.tir truck_kept.tir
sed 's/^RBY1 = .*/RBY1 = 10000/; s/^RBY2 = .*/RBY2 = 0/; s/^RCY1 = .*/RCY1 = 1/; s/^REY1 = .*/REY1 = 0/; s/^KPUMIN = .*/KPUMIN = -100/; s/^KPUMAX = .*/KPUMAX = 100/' \
    truck_kept.tir >truck.tir
refused 1 "errors of tables for tire 'truck' may add up to [1-9].[0-9]e-0[1-5] of its load" --tire-tables rig.veh
mv truck_kept.tir truck.tir
# curvature factors that multiply what a table is off by
sed 's/^PEX1 = .*/PEX1 = -1e6/' truck.tir >truck_bent.tir
sed 's/^PEX1 = .*/PEX1 = -1e4/' truck.tir >truck_kept.tir
mv truck_bent.tir truck.tir
refused 1 "errors of short polynomials for tire 'truck' may add up to [1-9].[0-9]e-0[3-6] of its load" --tire-tables --lanes 2 rig.veh
refused 1 "errors of short polynomials for tire 'truck' may add up to [1-9].[0-9]e-0[3-6] of its load" --tire-tables --batch 4 rig.veh
mv truck_kept.tir truck.tir
refused 1 "errors of tables for tire 'truck' may add up to [1-9].[0-9]e-0[3-6] of its load" --tire-tables rig.veh

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
