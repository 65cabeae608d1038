#!/bin/sh
# SPDX-License-Identifier: MIT
# test_embedding.sh GICGEN: README's example works as it stands there, and emitted code and runtime core compile without
# a warning in every way that users build them, need nothing, and run the same in all of them.
gicgen=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

names=
for model in "$root"/models/*.veh; do
    name=$(basename "$model" .veh)
    "$gicgen" "$model" -o "$work/$name.c" || exit 1
    names="$names $name"
done
# ways of the generator that these models do not go, to compile only: force laws of every kind in the augmented form;
# geometry tuned at set-up, and all reactions after the reduced form; all reactions and a drive force of the augmented form
"$gicgen" --solve augmented "$root/tests/data/laws/cart.veh" -o "$work/cart.c" || exit 1
sed 's/^  rack: *{type: translation,/& driven: true,/; s/^model: .*/model: steered/' \
    "$root/models/hmmwv.veh" >"$work/steered.veh"
ln -s "$root/models/parts" "$work/parts"
# reacting NAME FILE [OPTION...]
reacting() {
    name=$1
    file=$2
    shift 2
    "$gicgen" --dump-model "$file" >"$work/dump" && sh "$root/tests/lib/reactions.sh" "$work/dump" "$file" >"$work/reacting.veh" &&
        "$gicgen" "$@" "$work/reacting.veh" -o "$work/$name.c" || exit 1
}
reacting car "$root/tests/data/tuning/car.veh"
reacting steered "$work/steered.veh" --solve augmented
# welded NAME KEEP: a bracket welded to the ground, and with KEEP = 0 a rod on it
welded() {
    printf '%s\n' "gicgen: 1" "model: $1" "base: ground" bodies: \
        "  bracket: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}" \
        "  rod: {mass: 1, com: [0, 0, 1], inertia: [1, 1, 1]}" joints: "  weld: {type: fixed, bodies: [ground, bracket]}" \
        "  pivot: {type: revolute, bodies: [bracket, rod], point: [0, 0, 0], axis: [0, 1, 0]}" coordinates: \
        "  angle: {type: angle, bodies: [bracket, rod], axis: [0, 1, 0], range: [-1, 1]}" |
        if [ "$2" -eq 1 ]; then sed '/rod/d; /coordinates/d'; else cat; fi >"$work/$1.veh"
    "$gicgen" "$work/$1.veh" -o "$work/$1.c" || exit 1
}
welded bracket 1
welded hinged 0
compiled="$names cart car steered bracket hinged gic_runtime gic_road"
cp "$root"/runtime/gic_runtime.[ch] "$root"/runtime/gic_road.[ch] "$work/"
cd "$work" || exit 1

# ---- warnings ----------------------------------------------------------------------------------------------

cat >compilers <<'END'
gcc -std=c99
gcc -std=c11
gcc -std=c99 -DGIC_FLOAT -Wdouble-promotion
g++ -std=c++11 -x c++
g++ -std=c++20 -DGIC_FLOAT -Wdouble-promotion -x c++
END
cat >>compilers <<'END'
clang -std=c99
clang -std=c99 -DGIC_FLOAT -Wdouble-promotion
clang++ -std=c++11 -x c++
END
while read -r how; do
    for name in $compiled; do
        # shellcheck disable=SC2086  # lists of words
        $how -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -O0 -fsyntax-only -I. "$name.c"
        verdict $? "$how $name.c"
    done
done <compilers
for name in $compiled; do
    tcc -std=c99 -Wall -Werror -I. -c "$name.c" -o tcc.o && tcc -DGIC_FLOAT -Wall -Werror -I. -c "$name.c" -o tcc.o
    verdict $? "tcc $name.c"
done

# all models in one translation unit: nothing that a file defines for itself has another one's name
for name in $names cart car steered bracket hinged; do echo "#include \"$name.c\""; done >unit.c
for how in "gcc -std=c99" "g++ -std=c++11 -x c++"; do
    # shellcheck disable=SC2086  # lists of words
    $how -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -O0 -fsyntax-only -I. unit.c
    verdict $? "$how: all models in one translation unit"
done

mkdir lanes
for name in hmmwv hmmwv_tires hmmwv_vehicle; do
    "$gicgen" --lanes 4 "$root/models/$name.veh" -o "lanes/$name.c" 2>err
    echo "#include \"$name.c\""
done >lanes/unit.c
[ "$(grep -l gic_lane_4 lanes/hmmwv*.c | wc -l)" -ge 1 ] &&
    gcc -std=c99 -Wall -Wextra -Wconversion -Wshadow -Werror -O0 -fsyntax-only -Ilanes -I. -I"$root/runtime" lanes/unit.c
verdict $? "gcc: models in lanes in one translation unit"

# ---- freestanding ------------------------------------------------------------------------------------------

# objects SUFFIX OPTION...: optimized objects of everything, without a warning of what only optimization finds
objects() {
    suffix=$1
    shift
    for name in $compiled; do
        cc -std=c99 -O2 -Wall -Wextra -Werror -ffp-contract=off -fno-pie -I. "$@" -c "$name.c" -o "$name.$suffix.o"
        verdict $? "cc -O2 $* $name.c"
    done
}
objects double
objects float -DGIC_FLOAT -O1 # what optimization finds, double has shown

# no allocation, no input or output, nothing but mathematics and memory copies (a compiler may merge sin and cos, or
# guard the stack); in single precision no function of double
memory='mem(cpy|set|move|cmp)|__stack_chk_fail'
for name in $compiled; do
    for real in double float; do
        f=$([ $real = float ] && echo f)
        mathematics="(sqrt|sin|cos|sincos|tan|atan2|asin|acos|atan|exp|log|tanh|pow|fabs|floor|ceil|round)$f"
        foreign=$(nm -u "$name.$real.o" | awk '{ print $2 }' | grep -Evx "gic_.*|$mathematics|$memory")
        [ -z "$foreign" ]
        verdict $? "$name in $real precision needs $foreign"
        # writable data or common symbols would be globals
        variables=$(nm "$name.$real.o" | awk '$2 ~ /^[DdBbC]$/ { print $3 }')
        [ -z "$variables" ]
        verdict $? "$name has variables: $variables"
    done
done

# no arithmetic in double precision, nor a conversion from or to it: instructions on scalar or packed doubles
doubles='v?((add|sub|mul|div|sqrt|min|max|comi|ucomi|f?n?madd|f?n?msub)[0-9]*[sp]d|cvt[a-z0-9]*[sp]d[a-z0-9]*)'
if [ "$(uname -m)" = x86_64 ]; then
    for name in $compiled; do
        objdump -d --no-show-raw-insn "$name.float.o" | grep -Ew "$doubles" >found
        [ ! -s found ]
        verdict $? "$name in single precision computes in double: $(head -n 3 found)"
    done
    # the search finds them where they are
    objdump -d --no-show-raw-insn gic_runtime.double.o | grep -Ewq "$doubles"
    verdict $? "no arithmetic found in double precision"
fi

# ---- programs ----------------------------------------------------------------------------------------------

# README's example: the first block of C there, compiled by the two lines of shell that follow it
sed -n '/^```c$/,/^```$/p' "$root/README.md" | sed '/^```/d' >main.c
cc -Wall -Wextra -Werror -O2 -I. main.c hmmwv.double.o gic_runtime.double.o -no-pie -lm -o example
verdict $? "README's example does not compile"
answer=$(./example)
verdict $? "README's example fails: $answer"
# the model says that it rests within a millimetre of its design configuration, whose chassis stands at 0.474
echo "$answer" | awk '/^ok: / { z = $6 } END { exit !(z > 0.473 && z < 0.475) }'
verdict $? "README's example prints: $answer"

# two vehicles and a pendulum in one program, as C and C++: the same digits; in float: to five of them, for the run
# takes 400 steps of 1e-7 each
program="$root/tests/data/embed/two_vehicles.c"
parts="hmmwv.c pendulum.c gic_runtime.c gic_road.c"
cc -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Werror -O2 -I. "$program" hmmwv.double.o pendulum.double.o \
    gic_runtime.double.o gic_road.double.o -no-pie -lm -o ride && ./ride >ride.double
verdict $? "two vehicles in C"
awk 'NF != 4 { bad = 1 } END { exit bad || NR != 3 }' ride.double
verdict $? "two vehicles print: $(cat ride.double)"
# the pendulum is where the benchmark has it at 2 s (RK4 at 5 ms is right to 1e-7), the cars 10 m down the road
awk 'NR < 3 && ($2 < 9.99 || $2 > 10.01) { bad = 1 }
    NR == 3 && (($2 + 0.793566195343)^2 + ($3 + 0.608483930444)^2 > 1e-14) { bad = 1 } END { exit bad }' ride.double
verdict $? "two vehicles went elsewhere: $(cat ride.double)"
# shellcheck disable=SC2086  # lists of words
g++ -x c++ -std=c++17 -Wall -Wextra -Wpedantic -Wconversion -Werror -O1 -ffp-contract=off -I. "$program" $parts -lm \
    -o ride && ./ride | cmp - ride.double
verdict $? "two vehicles in C++"
# shellcheck disable=SC2086  # lists of words
tcc -I. "$program" $parts -lm -o ride && ./ride | cmp - ride.double
verdict $? "two vehicles with tcc"
# shellcheck disable=SC2086  # lists of words
clang -std=c99 -O1 -ffp-contract=off -I. "$program" $parts -lm -o ride && ./ride | cmp - ride.double
verdict $? "two vehicles with clang"
# shellcheck disable=SC2086  # lists of words
clang++ -x c++ -std=c++17 -O1 -ffp-contract=off -I. "$program" $parts -lm -o ride && ./ride | cmp - ride.double
verdict $? "two vehicles with clang++"
cc -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Werror -DGIC_FLOAT -O2 -I. "$program" hmmwv.float.o \
    pendulum.float.o gic_runtime.float.o gic_road.float.o -no-pie -lm -o ride && ./ride >ride.float
verdict $? "two vehicles in single precision"
paste ride.double ride.float | awk '{ for (i = 1; i <= 4; ++i) if (($i - $(i + 4))^2 > 1e-10 * (1 + $i^2)) bad = 1 }
    END { exit bad || NR != 3 }'
verdict $? "two vehicles in single precision end elsewhere: $(cat ride.float)"

# the example that gicgen writes for each model: short, without a warning in C and C++, for two seconds, with shorter steps
# where the model wants them
for name in $names; do
    "$gicgen" --main "$root/models/$name.veh" -o "main_$name.c"
    [ "$(wc -l <"main_$name.c")" -lt 85 ]
    verdict $? "the example of $name is too long"
    cc -std=c99 -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -I. "main_$name.c" "$name.double.o" \
        gic_runtime.double.o -no-pie -lm -o example && ./example >results 2>messages
    status=$?
    [ $status -eq 0 ] && awk -F, 'NR == 1 { n = NF } NF != n || /nan|inf/ { bad = 1 }
        END { exit bad || NR != 102 || $1 != 2 }' results
    verdict $? "the example of $name: $(cat messages)"
    g++ -x c++ -std=c++11 -Wall -Wextra -Wpedantic -Wconversion -Werror -fsyntax-only -I. "main_$name.c"
    verdict $? "the example of $name in C++"
done
# energy comes from the torque of 0.033 N m on the crank alone, over thousands of its turns
"$gicgen" --main "$root/models/andrews.veh" -o main.c && cc -O1 -I. main.c andrews.double.o gic_runtime.double.o -no-pie \
    -lm -o example && ./example 2>messages | awk -F, '
    NR == 1 { for (i = 1; i <= NF; ++i) { sub(/ .*/, "", $i); at[$i] = i }; next }
    { energy = $at["energy.kinetic"] + $at["energy.potential"]; angle = $at["beta.value"] }
    NR == 2 { energy0 = energy; angle0 = angle }
    { work = 0.033 * (angle - angle0); if ((energy - energy0 - work)^2 > (0.01 * (1 + work))^2) bad = 1 }
    END { exit bad || NR != 102 || angle < 1000 }'
verdict $? "the example of andrews gains another energy than the torque's work: $(cat messages)"
# AB3 at 2 ms is right to 1e-6
"$gicgen" --main "$root/models/pendulum.veh" -o main.c && cc -I. main.c pendulum.double.o gic_runtime.double.o -no-pie -lm \
    -o example && ./example | awk -F, 'END { exit ($2 + 0.793566195343)^2 + ($4 + 0.608483930444)^2 > 1e-12 }'
verdict $? "the example of the pendulum ends elsewhere"

# ---- versions that do not fit -------------------------------------------------------------------------------

cc -O0 -I. "$program" hmmwv.double.o pendulum.double.o gic_runtime.float.o gic_road.float.o -no-pie -lm -o mixed 2>messages
[ $? -ne 0 ] && grep -q gic_step messages
verdict $? "number types can be mixed"
mkdir later
sed 's/^#define GIC_ABI_VERSION .*/#define GIC_ABI_VERSION 999/' gic_runtime.h >later/gic_runtime.h
for name in $names; do
    cp "$name.c" "$name.h" later/
    cc -Ilater -fsyntax-only "later/$name.c" 2>messages
    [ $? -ne 0 ] && grep -q "error.*$name.h was generated for version .* of gic_runtime.h" messages
    verdict $? "$name compiles with another version of the runtime"
done

# halves of two runs, as a kill between the two files leaves them: another parameter, state or output would be read
mkdir run1 run2
sed 's/mass: 1\([^0-9.]\)/mass: 2\1/' "$root/models/pendulum.veh" >run2/pendulum.veh
cp "$root/models/pendulum.veh" run1
for run in run1 run2; do
    "$gicgen" $run/pendulum.veh -o $run/pendulum.c && "$gicgen" --batch 4 $run/pendulum.veh -o $run/pendulum_batch.c
    verdict $? "$run of gicgen"
done
cp "$root/runtime/gic_batch.h" "$root/runtime/gic_road_lanes.h" .
for c in run1 run2; do
    for h in run1 run2; do
        for name in pendulum pendulum_batch; do
            mkdir -p "$c$h"
            cp $h/*.h $c/$name.c "$c$h"
            cc -I. -fsyntax-only "$c$h/$name.c" 2>messages
            status=$?
            if [ $c = $h ]; then
                [ $status -eq 0 ]
            else
                [ $status -ne 0 ] && [ "$(grep -c 'error: #error.*not of the same run of gicgen' messages)" -eq 1 ]
            fi
            verdict $? "$name.c of $c with $name.h of $h: $(cat messages)"
        done
    done
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
