#!/bin/sh
# SPDX-License-Identifier: MIT
# test_sanitized.sh GICGEN GICRUN DENY_EXEC: the whole path under the sanitizers for addresses, undefined behaviour and,
# where the system lets it look, leaks: programs of `make debug` read, generate, compile and run with every engine, with
# compiled objects that are sanitized too, and fail in the ways that they may; generated code runs in a sanitized
# program of its own. Results must be those of the ordinary programs to the last digit: sanitizers change nothing that
# is right.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
deny_exec=$(realpath "$3")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

# check STATUS LABEL: also a failure is what a sanitizer has to say
check() {
    [ "$1" -eq 0 ] && ! grep -q 'runtime error:\|Sanitizer' "$work/said"
    verdict $? "$2"
    : >"$work/said"
}

debug=$(dirname "$gicgen")/debug
make -C "$root" --no-print-directory -s -j2 WERROR=-Werror BUILD="$(dirname "$gicgen")" debug >"$work/said" 2>&1
check $? "make debug"
cd "$work" || exit 1
mkdir tmp
TMPDIR=$work/tmp
GICGEN_CACHE=$work/kept
export TMPDIR GICGEN_CACHE
clean() { [ -z "$(ls -A tmp)" ]; }

sanitize="-fsanitize=address,undefined -fno-sanitize-recover=all"
# they do see what they are for, leaks too unless the system forbids to look for them
cat >wrong.c <<'END_OF_C'
#include <stdlib.h>
#include <string.h>
int main(int count, char **word)
{
    char *volatile lost = malloc(7);
    volatile int most = 0x7fffffff;
    if (count == 2)
        return lost[strlen(word[1])];
    if (count > 2)
        most += count;
    lost = NULL;
    return 0;
}
END_OF_C
# shellcheck disable=SC2086  # lists of words
cc -O0 $sanitize wrong.c -o wrong 2>said && ! ./wrong 12345678 2>said && grep -q AddressSanitizer said &&
    ! ./wrong 1 2 3 2>said && grep -q 'runtime error' said && : >said
check $? "sanitizers work"
if ./wrong 2>leak || ! grep -q 'detected memory leaks' leak; then
    echo "no leaks are looked for, for this system does not let the sanitizer do so"
    ASAN_OPTIONS=detect_leaks=0
    export ASAN_OPTIONS
fi

# ---- the library: its calls, threads and failures, and all broken models in one process ---------------------------

make -C "$root" --no-print-directory -s -j2 WERROR=-Werror BUILD="$debug" CFLAGS="-O1 -g -fsanitize=address,undefined \
    -fno-sanitize-recover=all -fno-omit-frame-pointer" "$debug/check/test_library" "$debug/check/library" \
    "$debug/check/library_calls" >"$work/said" 2>&1 &&
    (cd "$root" && GICGEN_CACHE='' "$debug/check/test_library") >"$work/out" 2>"$work/said"
status=$?
[ $status -ne 0 ] || : >"$work/said"
check $status "calls of the library"
"$debug/check/library" open "$root"/tests/data/mistakes/*.veh 2>"$work/refused"
[ $? -eq 1 ] && ! grep 'runtime error:\|Sanitizer' "$work/refused" >"$work/said"
check $? "the library refuses broken models and leaves nothing of them"
for threads in 1 3; do
    (cd "$root" && GICGEN_CACHE="$work/calls" "$debug/check/library_calls" 1 2 600 $threads \
        models/quarter_car.veh=models/scenes/quarter_car.scene models/pendulum.veh=models/scenes/pendulum.scene \
        models/controllers/skyhook.veh=models/controllers/skyhook.scene tests/data/tuning/car.veh) >"$work/out" 2>"$work/said"
    check $? "calls in random order, threads: $threads"
done

# ---- gicgen -------------------------------------------------------------------------------------------------------

models=$root/models
for model in "$models"/*.veh; do
    name=$(basename "$model" .veh)
    "$debug/gicgen" "$model" -o "$name.c" 2>said && "$gicgen" "$model" -o plain.c 2>>said &&
        sed 's/plain\.h/'"$name"'.h/' plain.c | cmp - "$name.c" >>said
    check $? "gicgen $name.veh"
done
for asked in '--solve augmented -o -' --main --sequence --dump-model '--graph graph.dot' '--report report.html'; do
    # shellcheck disable=SC2086  # lists of words
    "$debug/gicgen" $asked "$models/hmmwv.veh" >plain 2>said
    check $? "gicgen $asked"
done
refused=0
for file in "$root"/tests/data/mistakes/*.veh; do
    "$debug/gicgen" --dump-model "$file" >plain 2>message
    [ $? -eq 1 ] && ! grep 'runtime error:\|Sanitizer' message >>said || echo "$file" >>said
    refused=$((refused + 1))
done
[ "$refused" -gt 200 ] && [ ! -s said ]
check $? "gicgen refuses broken models"

# ---- gicrun: every engine -----------------------------------------------------------------------------------------

for scene in paper_run pendulum; do
    sed 's/^duration: .*/duration: 0.1/; s/^output_step: .*/output_step: 0.05/' \
        "$models/scenes/$scene.scene" >$scene.scene
done
# same ENGINE MODEL SCENE [OPTION...]: the same rows as without sanitizers, from the tape for all generated formulas
same() {
    engine=$1
    model=$models/$2.veh
    scene=$3
    shift 3
    case $engine in
    g*) plain=$engine ;;
    *) plain=tape ;;
    esac
    rm -f sanitized.csv
    "$gicrun" -q --engine "$plain" "$@" "$model" "$scene" -o plain.csv 2>said &&
        "$debug/gicrun" --general --engine "$engine" "$@" "$model" "$scene" -o sanitized.csv 2>>said &&
        cmp plain.csv sanitized.csv >>said && [ "$(wc -l <sanitized.csv)" -gt 2 ] && clean
    check $? "gicrun --engine $engine $* $model"
}
for engine in tcc tape gic gcp1 gcp2 auto; do
    same "$engine" hmmwv paper_run.scene
    same "$engine" pendulum pendulum.scene
    same "$engine" hmmwv paper_run.scene --integrator rkck --tolerance 1e-6
done
same tape hmmwv paper_run.scene --solve augmented --integrator adams --tolerance 1e-6
for again in compiled kept; do
    same cc pendulum pendulum.scene --cflags "-O1 $sanitize"
done
[ "$(find kept -name '*.so' | wc -l)" -eq 1 ]
check $? "one object, $again"
same cc hmmwv paper_run.scene --cflags "-O1 $sanitize"
same tcc hmmwv paper_run.scene --plot picture.svg
# compiled code takes over: sanitized, too
sed 's/^duration: .*/duration: 4000/; s/^step: .*/step: 0.0005/; s/^output_step: .*/output_step: 10/' \
    "$models/scenes/pendulum.scene" >long.scene
same auto pendulum long.scene --cflags "-O1 $sanitize"
"$debug/gicrun" "$models/pendulum.veh" long.scene -o sanitized.csv --cflags "-O1 $sanitize" 2>said &&
    grep -q 'compiled code  *from t' said && clean
check $? "auto changes to compiled code"

# ---- what goes wrong ------------------------------------------------------------------------------------------------

pendulum=$models/pendulum.veh
"$gicrun" -q --engine tape "$pendulum" pendulum.scene -o right.csv
# fails STATUS TEXT ARGUMENT...: with the text
fails() {
    status=$1
    text=$2
    shift 2
    "$debug/gicrun" "$@" >plain 2>said
    [ $? -eq "$status" ] && grep -q "$text" said && clean
    check $? "status $status: $text"
}
fails 1 "error: the C compiler '/nonexistent' can't be started" --engine cc --cc /nonexistent "$pendulum" pendulum.scene
fails 1 "error: the C compiler 'false' failed" --engine cc --cc false "$pendulum" pendulum.scene
fails 1 "results.csv: error: can't create" -q "$pendulum" pendulum.scene -o nowhere/results.csv
fails 2 "error: no scene given" "$pendulum"
for scene in "$models/pendulum.veh" /nonexistent; do
    fails 1 'error: ' "$pendulum" "$scene"
done
# goes LABEL NOTE COMMAND...: to its end, with right results and so many lines of the note
goes() {
    label=$1
    note=$2
    shift 2
    rm -f sanitized.csv
    "$@" --general "$pendulum" pendulum.scene -o sanitized.csv 2>said && cmp right.csv sanitized.csv >>said && clean &&
        [ "$(grep -c '^gicrun: note: ' said)" -eq "$note" ]
    check $? "$label"
}
for object in kept/*.so; do
    truncate -s 4096 "$object"
done
goes "truncated objects" 0 "$debug/gicrun" --engine cc --cflags "-O1 $sanitize"
GICGEN_CACHE=/proc/nowhere goes "nowhere to keep an object" 1 "$debug/gicrun" --engine cc --cflags "-O1 $sanitize"
goes "auto without a compiler" 0 "$debug/gicrun" --cc /nonexistent
goes "refused executable memory" 1 "$deny_exec" "$debug/gicrun"
goes "refused executable memory: tcc" 1 "$deny_exec" "$debug/gicrun" --engine tcc

# a crank and its spring's line: at w = 1.75 they are in line, and the length ceases to be a coordinate
cat >crank.veh <<'END'
gicgen: 1
model: crank
base: ground
gravity: [0, 0, 0]
bodies:
  arm: {mass: 1, com: [0.5, 0, 0], inertia: [1, 1, 1]}
joints:
  hinge: {type: revolute, bodies: [ground, arm], point: [0, 0, 0], axis: [0, 0, 1]}
coordinates:
  w: {type: length, bodies: [ground, arm], points: [[0, 0.75, 0], [1, 0, 0]]}
END
printf '%s\n' 'gicscene: 1' 'duration: 10' 'step: 0.001' 'initial: {rates: {w: 0.3}}' >crank.scene
printf 'w,w.rate\n1.25,0\n1.8,0\n1.4,-1\n1e9,0\n' >crank.csv
for engine in tcc tape gic; do
    fails 1 'error: the run ends at t = ' --engine $engine crank.veh crank.scene
done
for engine in tcc tape gic gcp1 gcp2; do
    fails 0 'warning: 2 of 4 rows have no result' --engine $engine --eval crank.csv crank.veh
done

for processes in 1 2; do
    OMP_NUM_THREADS=$processes "$debug/gicsweep" -q --engine tcc "$pendulum" pendulum.scene --vary angle=0:0.5:4 -o sweep.csv \
        2>said && [ "$(wc -l <sweep.csv)" -eq 5 ] && clean
    check $? "gicsweep, $processes processes"
done
"$debug/gicbench" --quick -o page "$pendulum" pendulum.scene pendulum.scene 2>said && [ -s page/index.html ] && clean
check $? "gicbench"

# ---- generated code in a program of its own -------------------------------------------------------------------------

cp "$root"/runtime/gic_runtime.[ch] "$root"/runtime/gic_road.[ch] .
for real in '' -DGIC_FLOAT; do
    # shellcheck disable=SC2086  # lists of words
    cc -std=c99 -O1 -g $sanitize $real -I. "$root/tests/data/embed/two_vehicles.c" hmmwv.c pendulum.c gic_runtime.c \
        gic_road.c -lm -o ride 2>said && ./ride >ride.txt 2>>said && [ "$(wc -l <ride.txt)" -eq 3 ]
    check $? "two vehicles $real"
done
# shellcheck disable=SC2086  # lists of words
"$debug/gicgen" --main "$pendulum" -o main.c 2>said &&
    cc -std=c99 -O1 -g $sanitize -I. main.c pendulum.c gic_runtime.c -lm -o example 2>>said && ./example >plain 2>>said
check $? "the example of the pendulum"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
