#!/bin/sh
# SPDX-License-Identifier: MIT
# test_side_by_side.sh GICGEN: code that solves alike parts of a vehicle in lanes (gicgen --lanes W) against code that
# solves them one by one: states, rates, outputs and self-test after 200 steps, counts of corrections, and what happens
# when one coordinate after another goes half a metre or radian too far: status, subset, and a state that has not moved.
# The equations of motion add up in another order, so numbers are compared within 1e-11 of 1 and their size, in single
# precision within 1e-3, which is some ten thousand roundings: 400 right-hand sides amplify the first ones; forces and
# torques (outputs in N or N m) within that of 1000 and their size, as in test_engines.sh, for they may be what is left of
# large ones: of 1e5 N on an arm of 6 m in the kingpin of a truck, say. Counts of corrections may differ by a hundredth,
# for what is small enough hangs on roundings.
gicgen=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

mkdir "$work/alone" "$work/lanes"
cd "$work" || exit 1

# equal TOLERANCE: numbers of both courses; states after a failed step have every bit
equal() {
    awk -v tolerance="$1" '
        NR == FNR { line[FNR] = $0; lines = FNR; next }
        { split(line[FNR], other); bound = tolerance * (1 + ($3 < 0 ? -$3 : $3)) }
        $1 == "force" { bound += tolerance * 999 }
        $1 ~ /^(state|rate|output|force)$/ && $3 - other[3] <= bound && other[3] - $3 <= bound { next }
        $1 == "moved" && $3 - other[3] <= bound && other[3] - $3 <= bound { next }
        $1 == "self-test" && $2 == other[2] && $3 < tolerance + 0 { next }
        $1 == "self-test" && $2 == other[2] && $3 == other[3] { next }
        $1 == "counts" && $2 == other[2] && $3 == other[3] && $4 < 1.01 * other[4] + 1 && other[4] < 1.01 * $4 + 1 { next }
        $0 != line[FNR] { print "  " line[FNR] " but in lanes " $0; bad = 1 }
        END { exit bad || lines != FNR || !lines }' alone/out lanes/out
}

# agrees MODEL.veh LANES OPTIONS TOLERANCE COMPILER...
agrees() {
    file=$1
    lanes=$2
    options=$3
    tolerance=$4
    shift 4
    name=$(sed -n 's/^model: *//p' "$file")
    good=0
    # shellcheck disable=SC2086  # a list of words
    "$gicgen" $options "$file" -o "alone/$name.c" && "$gicgen" $options --lanes "$lanes" "$file" -o "lanes/$name.c" ||
        good=1
    for way in alone lanes; do
        "$@" -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -ffp-contract=off -DMODEL="${name}_model" -I$way \
            -I"$root/runtime" "$root/tests/data/embed/course.c" "$way/$name.c" "$root/runtime/gic_runtime.c" -lm -o course \
            2>err && ./course >$way/out || good=1
    done
    [ $good -eq 0 ] && equal "$tolerance"
    verdict $? "$file --lanes $lanes $options: $* $(cat err)"
}

# Andrews' mechanism goes round twenty times in these steps and makes 6e4 times as much of a rounding (so says code with
# contraction beside code without), and Newton's poses may differ by 1e-14 of their size
for model in "$root"/models/*.veh "$root/tests/data/tuning/car.veh"; do
    case $model in
    */andrews.veh) tolerance=1e-9 ;;
    *) tolerance=1e-11 ;;
    esac
    agrees "$model" 4 '' "$tolerance" gcc -std=c11 -O0
done

# alike parts that are not found at the same time, and numbers of which only some lanes are checked
agrees "$root/tests/data/lanes/stages.veh" 2 '' 1e-11 gcc -std=c11 -O0
agrees "$root/tests/data/lanes/stages.veh" 4 '--recovery newton' 1e-11 gcc -std=c11 -O0

hmmwv=$root/models/hmmwv.veh
agrees "$hmmwv" 2 '' 1e-11 gcc -std=c11 -O2
agrees "$hmmwv" 8 '--recovery newton' 1e-11 gcc -std=c11 -O1
agrees "$hmmwv" 4 '--recovery newton' 1e-11 clang -std=c11 -O1
agrees "$hmmwv" 16 '--solve augmented' 1e-11 clang -std=c11 -O1
agrees "$root/models/hmmwv14.veh" 4 '--recovery newton' 1e-11 gcc -std=c11 -O1 -march=native
agrees "$hmmwv" 4 '' 1e-3 gcc -std=c11 -O1 -DGIC_FLOAT -Wdouble-promotion
agrees "$hmmwv" 8 '' 1e-3 clang -std=c11 -O1 -DGIC_FLOAT
for how in 'g++ -std=c++11' 'clang++ -std=c++11 -DGIC_FLOAT'; do
    $how -x c++ -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -O1 -Ilanes -I"$root/runtime" \
        -c lanes/hmmwv.c -o x.o 2>err
    verdict $? "$how hmmwv.c: $(cat err)"
done
"$gicgen" --lanes 8 "$hmmwv" -o again.c && sed 's/again.h/hmmwv.h/' again.c | cmp - lanes/hmmwv.c
verdict $? "the same input gives other bytes"
printf '#undef __GNUC__\n' | cat - lanes/hmmwv.c >other.c
! gcc -std=c11 -Ilanes -I"$root/runtime" -c other.c -o x.o 2>err && grep -q 'needs the vector extensions of gcc or clang' err
verdict $? "another compiler is not told what it lacks: $(cat err)"
"$gicgen" --lanes 3 "$hmmwv" -o three.c 2>err
[ $? -eq 2 ] && grep -q 'lanes takes 2, 4, 8 or 16, not: 3' err
verdict $? "three lanes"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
