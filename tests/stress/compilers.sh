#!/bin/sh
# SPDX-License-Identifier: MIT
# compilers.sh GICGEN TRAPPED STATES REFERENCE AGREE: compilers and their options; floating-point exceptions
#
# Generated code by gcc, clang and tcc, with -O0, -O2, -O3 -march=native, -ffast-math, for 32 bit processors, whose
# registers may hold more digits, and in single precision: accelerations and poses at random states against quad
# precision; rates, outputs and runs against gcc -O2; statuses that see what is no number in each of them. The same of
# code with alike parts in lanes; vehicles in lanes beside single ones by the same compiler. Then no invalid operation,
# division by zero or overflow in runs of all models and scenes. In short one model and, of the
# commands, those with another compiler, arithmetic or width.
gicgen=$(realpath "$1")
trapped=$(realpath "$2")
states=$(realpath "$3")
reference=$(realpath "$4")
agree=$(realpath "$5")
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
found=0
models=quarter_car
rows=4
if [ "$STRESS" != short ]; then
    models=$(cd "$root/models" && echo *.veh | sed 's/[.]veh//g')
    rows=12
fi
cp "$root"/runtime/gic_*.[ch] "$root"/tests/stress/compilers/* "$work/"
cd "$work" || exit 1
mkdir lanes
for file in "$root"/models/*.veh; do
    model=$(basename "$file" .veh)
    [ "$STRESS" = short ] && case $model in hmmwv | quarter_car) ;; *) continue ;; esac
    "$gicgen" "$file" -o "$model.c" || exit 1
    case " $models " in *" $model "*) ;; *) continue ;; esac
    "$gicgen" --lanes 4 "$file" -o "lanes/$model.c" || exit 1
    # there is none yet of models with tires, and it says so
    "$gicgen" --batch 4 "$file" -o "${model}_batch.c" 2>messages || grep -q 'with tires yet' messages || exit 1
    "$gicgen" --dump-model "$file" >"$model.dump" &&
        "$states" "$model.dump" --count $rows --seed 5 -o drawn && python3 single.py <drawn >"$model.states" &&
        "$reference" "$model.dump" "$model.states" -o "$model.quad" 2>messages || exit 1
done

# compile COMPILER MODEL FOLDER: objects of the model's code in a folder and of the runtime
compile() {
    for source in "$3/$2.c" gic_runtime.c gic_road.c; do
        # shellcheck disable=SC2086  # a list of words
        $1 -std=c99 -I"$3" -I. -c "$source" -o "$(basename "$source" .c).o" 2>messages || return 1
    done
}
# build COMPILER MODEL MAIN FOLDER [MORE]: the program MAIN with these objects
build() {
    # shellcheck disable=SC2086
    $1 -std=c99 -I"$4" -I. -DMODEL="$2" -DHEADER="\"$2.h\"" "$3.c" "$2.o" gic_runtime.o gic_road.o -lm -o "$3" 2>messages
}

# differ FILE FILE: largest difference of numbers relative to 1 and the column's own size
differ() {
    paste "$1" "$2" | awk 'NF != 2 { most = 1e9 } { d = $1 - $2; s = 1 + ($1 < 0 ? -$1 : $1); if (d < 0) d = -d
        if (!(d / s <= most)) most = d / s } END { printf "%.1e", NR ? most : 1e9 }'
}
# larger A B: the larger one
larger() { awk "BEGIN { print ($1 > $2) ? \"$1\" : \"$2\" }"; }
within() { awk "BEGIN { exit !($1 <= $2) }"; }

# 32-bit programs go through QEMU where the kernel runs none of its own
emulator=
echo 'int main(void) { return 0; }' >narrow.c
if gcc -m32 narrow.c -o narrow 2>/dev/null && ! ./narrow 2>/dev/null; then
    emulator=qemu-i386
fi
# starter HOW: what starts a program that was compiled so
starter() { case $1 in *-m32*) echo "$emulator" ;; esac; }

# try TOLERANCE QUAD HOW MODEL FOLDER: $reason and, after success, the worst deviations $off and $error
try() {
    reason=
    start=$(starter "$3")
    if ! { compile "$3" "$4" "$5" && build "$3" "$4" drive "$5" && $start ./drive >numbers 2>messages &&
        build "$3" "$4" evaluate "$5" && $start ./evaluate <"$4.states" >evaluated 2>messages; }; then
        reason="$4: $(grep -m 1 'error\|row\|step\|numbers' messages || tail -n 1 messages)"
        return
    fi
    off=$(differ "$4.expected" numbers)
    within "$off" "$1" || reason="$4 differs by $off"
    "$agree" "$4.dump" "$4.quad" evaluated --tolerance "$2" >agreed 2>&1 || reason="$4: $(grep -m 1 FAILED agreed || tail -n 1 agreed)"
    error=$(awk '{ for (i = 1; i < NF; ++i) if ($i == "worst" && $(i + 1) + 0 > most) most = $(i + 1) + 0 }
        END { printf "%.1e", most }' agreed)
}

# installed HOW: with its library
installed() {
    $1 -I. gic_runtime.c -shared -o empty.so 2>/dev/null && return
    found=1
    echo "compilers | $1 | 1 | 0 | 1 | not installed, or without its library | sh tests/install.sh test installs it"
    return 1
}

for model in $models; do
    compile "gcc -O2 -ffp-contract=off" "$model" . && build "gcc -O2 -ffp-contract=off" "$model" drive . &&
        ./drive >"$model.expected" 2>messages || {
        echo "compilers | $model, gcc -O2 | 1 | 0 | 1 | | $(tail -n 1 messages)"
        found=1
    }
done

# skipped HOW: not in short: another level of optimization alone, or a pair of things of which each is tried by itself
skipped() {
    [ "$STRESS" = short ] || return 1
    case $1 in
    *-O3* | clang*-O0* | gcc*FLOAT*fast-math | clang*FLOAT | gcc\ -O2\ -ffast-math | gcc*-m32\ -O0) ;;
    *) return 1 ;;
    esac
}
# matrix WHAT FOLDER: rows for the commands on standard input: from gcc -O2 and from quad precision, what may differ, and
# how. From gcc: digits of the last place, which stiff tires and springs make some 1e3 times larger; from quad: 2e-13 of
# the largest term of an acceleration, and in single precision as many of its digits
matrix() {
    while read -r tolerance quad how; do
        skipped "$how" && continue
        installed "$how" || continue
        tried=0 good=0 most=0 worst=0 verdict=ok
        for model in $models; do
            tried=$((tried + 1))
            try "$tolerance" "$quad" "$how" "$model" "$2"
            if [ -z "$reason" ]; then
                good=$((good + 1)) most=$(larger "$off" "$most") worst=$(larger "$error" "$worst")
            else
                verdict=$reason
                echo "$how: $reason" >&2
            fi
        done
        [ "$verdict" = ok ] || found=1
        echo "compilers | $1$how | $tried | $good | $((tried - good)) | $most, $worst from quad | $verdict"
    done
}

matrix "" . <<END
0 2e-13 gcc -O2 -ffp-contract=off
0 2e-13 gcc -O0 -ffp-contract=off
1e-10 2e-13 gcc -O3 -march=native
1e-10 2e-13 gcc -O2 -ffast-math
0 2e-13 clang -O0 -ffp-contract=off
0 2e-13 clang -O2 -ffp-contract=off
1e-10 2e-13 clang -O3 -march=native
1e-10 2e-13 clang -O2 -ffast-math
0 2e-13 tcc
1e-10 2e-13 gcc -m32 -O2
1e-10 2e-13 gcc -m32 -O0
1e-2 1e-4 gcc -O2 -DGIC_FLOAT
1e-2 1e-4 gcc -O2 -DGIC_FLOAT -ffast-math
1e-2 1e-4 clang -O2 -DGIC_FLOAT
END
# registers with more digits don't mix with vectors: -mfpmath=sse
matrix "--lanes 4: " lanes <<END
1e-10 2e-13 gcc -O2 -ffp-contract=off
1e-10 2e-13 gcc -O3 -march=native
1e-10 2e-13 gcc -m32 -msse2 -mfpmath=sse -O2 -Wno-psabi
1e-10 2e-13 clang -O2 -ffp-contract=off
1e-10 2e-13 clang -O3 -march=native
1e-2 1e-4 gcc -O2 -DGIC_FLOAT
END

# vehicles in lanes beside single ones: the same bits where nothing is contracted
while read -r tolerance how; do
    skipped "$how" && continue
    installed "$how" || continue
    tried=0 good=0 most=0 verdict=ok
    for model in $models; do
        [ -f "${model}_batch.c" ] || continue
        tried=$((tried + 1))
        # shellcheck disable=SC2086
        if compile "$how" "$model" . && $how -std=c11 -I. -DMODEL="$model" -DMANY="${model}_batch" \
            -DHEADER="\"${model}_batch.h\"" many.c "$model.o" "${model}_batch.c" gic_runtime.o gic_road.o -lm -o many \
            2>messages && $(starter "$how") ./many >numbers 2>messages; then
            off=$(cat numbers)
            most=$(larger "$off" "$most")
            if within "$off" "$tolerance"; then good=$((good + 1)); else verdict="$model differs by $off"; fi
        else
            verdict="$model: $(grep -m 1 'error\|vehicles' messages)"
        fi
    done
    [ "$verdict" = ok ] || found=1
    echo "compilers | --batch 4: $how | $tried | $good | $((tried - good)) | $most | $verdict"
done <<END
0 gcc -O2 -ffp-contract=off
1e-10 gcc -O3 -march=native
1e-10 gcc -O2 -ffast-math
0 gcc -m32 -msse2 -mfpmath=sse -O2 -Wno-psabi -ffp-contract=off
0 clang -O2 -ffp-contract=off
1e-10 clang -O3 -march=native
0 gcc -O2 -DGIC_FLOAT -ffp-contract=off
END

# ---- floating-point exceptions ---------------------------------------------------------------------------------

tried=0 good=0 verdict=ok
for file in "$root"/models/*.veh; do
    model=$(basename "$file" .veh)
    [ "$STRESS" = short ] && case $model in hmmwv | quarter_car) ;; *) continue ;; esac
    tried=$((tried + 1))
    if compile "gcc -O1 -ffp-contract=off" "$model" . && build "gcc -O1 -ffp-contract=off -DTRAP" "$model" drive . &&
        ./drive >/dev/null 2>messages; then
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
    paper_run | rough_road | spin | suspension_rig) model=hmmwv ;;
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
