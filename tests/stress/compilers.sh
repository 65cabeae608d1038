#!/bin/sh
# SPDX-License-Identifier: MIT
# compilers.sh GICGEN TRAPPED: compilers and their options against each other; floating-point exceptions
#
# Generated code by gcc, clang and tcc, with -O0, -O2, -O3 -march=native, -ffast-math, for 32 bit
# processors, whose registers may hold more digits, and in single precision, against gcc -O2, which other tests hold
# against quad precision; in each of them statuses see what is no number. Then no invalid operation, division by zero or
# overflow in runs of all models and scenes.
gicgen=$(realpath "$1")
trapped=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
found=0
models=quarter_car
[ "$STRESS" = short ] || models="hmmwv quarter_car andrews five_link trailing_arm hmmwv14 hmmwv_full solid_axle hmmwv_tires"
cp "$root"/runtime/gic_runtime.[ch] "$root"/runtime/gic_road.[ch] "$root/tests/stress/compilers/drive.c" "$work/"
cd "$work" || exit 1
for model in "$root"/models/*.veh; do
    "$gicgen" "$model" -o "$(basename "$model" .veh).c" || exit 1
done

# build COMPILER MODEL: the command compiles ./drive
build() {
    $1 -std=c99 -I. -DMODEL="$2" -DHEADER="\"$2.h\"" drive.c "$2.c" gic_runtime.c gic_road.c -lm -o drive 2>messages
}

# differ FILE FILE: largest difference of numbers relative to 1 and the column's own size
differ() {
    paste "$1" "$2" | awk 'NF != 2 { most = 1e9 } { d = $1 - $2; s = 1 + ($1 < 0 ? -$1 : $1); if (d < 0) d = -d
        if (!(d / s <= most)) most = d / s } END { printf "%.1e", NR ? most : 1e9 }'
}

for model in $models; do
    build "gcc -O2 -ffp-contract=off" "$model" && ./drive >"$model.expected" 2>messages || {
        echo "compilers | $model, gcc -O2 | 1 | 0 | 1 | | $(tail -n 1 messages)"
        found=1
    }
done
# how, and what may differ: digits of the last place, which stiff tires and springs make some 1e3 times larger
while read -r tolerance how; do
    [ "$STRESS" = short ] && case $how in *-O3* | clang*-O0*) continue ;; esac
    if ! $how -I. gic_runtime.c -shared -o empty.so 2>/dev/null; then
        echo "compilers | $how | 1 | 0 | 1 | not installed, or without its library | ok: not tried"
        continue
    fi
    tried=0 good=0 most=0 verdict=ok
    for model in $models; do
        tried=$((tried + 1))
        if build "$how" "$model" && ./drive >numbers 2>messages; then
            off=$(differ "$model.expected" numbers)
            most=$(awk "BEGIN { print ($off > $most) ? \"$off\" : \"$most\" }")
            if awk "BEGIN { exit !($off <= $tolerance) }"; then good=$((good + 1)); else verdict="$model differs by $off"; fi
        else
            verdict="$model: $(tail -n 1 messages)"
        fi
    done
    [ "$verdict" = ok ] || found=1
    echo "compilers | $how | $tried | $good | $((tried - good)) | $most | $verdict"
done <<END
0 gcc -O0 -ffp-contract=off
1e-10 gcc -O3 -march=native
1e-10 gcc -O2 -ffast-math
0 clang -O0 -ffp-contract=off
0 clang -O2 -ffp-contract=off
1e-10 clang -O3 -march=native
1e-10 clang -O2 -ffast-math
0 tcc
1e-10 gcc -m32 -O2
1e-10 gcc -m32 -O0
1e-2 gcc -O2 -DGIC_FLOAT
1e-2 gcc -O2 -DGIC_FLOAT -ffast-math
1e-2 clang -O2 -DGIC_FLOAT
END

# ---- floating-point exceptions ---------------------------------------------------------------------------------

tried=0 good=0 verdict=ok
for file in "$root"/models/*.veh; do
    model=$(basename "$file" .veh)
    [ "$STRESS" = short ] && case $model in hmmwv | quarter_car) ;; *) continue ;; esac
    tried=$((tried + 1))
    if build "gcc -O1 -ffp-contract=off -DTRAP" "$model" && ./drive >/dev/null 2>messages; then
        good=$((good + 1))
    else
        verdict="$model: $? $(tail -n 1 messages)"
        found=1
    fi
done
echo "compilers | exceptions on, random states and runs | $tried | $good | $((tried - good)) | | $verdict"

tried=0 good=0 verdict=ok
for scene in "$root"/models/scenes/*.scene; do
    name=$(basename "$scene" .scene)
    case $name in
    tires_*) model=hmmwv_tires ;;
    paper_run | rough_road | spin) model=hmmwv ;;
    *) model=$name && [ -f "$root/models/$name.veh" ] || model=hmmwv_vehicle ;;
    esac
    [ "$STRESS" = short ] && case $name in paper_run | step_steer | five_link) ;; *) continue ;; esac
    tried=$((tried + 1))
    if "$trapped" "$root/models/$model.veh" "$scene" 3 2>messages; then
        good=$((good + 1))
    else
        verdict="$name: $? $(head -n 1 messages)"
        found=1
    fi
done
echo "compilers | exceptions on, scenes | $tried | $good | $((tried - good)) | | $verdict"
exit $found
