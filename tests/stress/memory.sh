#!/bin/sh
# SPDX-License-Identifier: MIT
# memory.sh GICGEN GICRUN GICSWEEP GICBENCH: memory that ends, at each allocation in turn
#
# Of libraries too; in short at 25 of them and the last 12, of a benchmark at 200 at most. The program must end with one
# message and without results, or go on without what was not to be had and write the same results as ever; it may not
# fall, hang or leave files. A sweep may leave its journal, with which the same command goes on, to the same results.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
gicsweep=$(realpath "$3")
gicbench=$(realpath "$4")
models=$(realpath "$(dirname "$0")/../../models")
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
GICGEN_CACHE=
TMPDIR=$work/tmp
OMP_NUM_THREADS=1
export GICGEN_CACHE TMPDIR OMP_NUM_THREADS
mkdir tmp

# DENY=n: the n-th allocation and all behind it fail; COUNT: a file for their number. What libraries allocate before the
# program begins doesn't count: it does not get that far.
cat >deny.c <<'END'
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t size);
static long made, least = -1;

__attribute__((constructor)) static void begin(void)
{
    const char *word = getenv("DENY");
    least = word ? atol(word) : 0;
}

static int denied(void)
{
    if (least < 0 || ++made < least || !least)
        return 0;
    errno = ENOMEM;
    return 1;
}

void *malloc(size_t size) { return denied() ? NULL : __libc_malloc(size); }
void *calloc(size_t count, size_t size) { return denied() ? NULL : __libc_calloc(count, size); }
void *realloc(void *block, size_t size) { return denied() ? NULL : __libc_realloc(block, size); }

/* A library that is opened begins as the program does. libgfortran of GCC 14, which MUMPS needs, calls its own message
 * about memory without end where it gets none then. */
void *dlopen(const char *path, int mode)
{
    void *(*const open)(const char *, int) = (void *(*)(const char *, int))dlsym(RTLD_NEXT, "dlopen");
    const long held = least;
    least = -1;
    void *library = open(path, mode);
    least = held;
    return library;
}

__attribute__((destructor)) static void report(void)
{
    const char *path = getenv("COUNT");
    const long count = made;
    FILE *file = path ? fopen(path, "w") : NULL;
    if (file) {
        fprintf(file, "%ld\n", count);
        fclose(file);
    }
}
END
${CC:-cc} -shared -fPIC -O1 deny.c -o deny.so -ldl || exit 1

# what is wrong with how it ended, or nothing
why() {
    [ -z "$(ls -A tmp)" ] || { echo "leaves $(ls tmp)" && rm -rf tmp && mkdir tmp; }
    for file in results* results/*; do
        case $file in
        *.tmp) echo "leaves $file" && rm -f "$file" ;;
        esac
    done
    if [ -f results.csv.journal ]; then
        # with memory again it goes on; with a whole journal's first line, or none
        "$@" >out 2>err.again && cmp -s results.csv sound.csv || echo "does not go on: $(head -n 1 err.again)"
        rm -f results.csv
        ! [ -f results.csv.journal ] || echo "leaves its journal"
    fi
    if [ "$status" -eq 0 ] && [ -d sound ]; then
        tail -n 1 results/index.html | grep -q '^</html>$' || echo "half a report"
    elif [ "$status" -eq 0 ]; then
        for file in results*; do
            cmp -s "$file" "sound.${file#*.}" || echo "other results in $file"
        done
    elif [ "$status" -eq 124 ]; then
        echo "hangs"
    elif [ "$status" -ne 1 ]; then
        echo "exit status $status: $(tail -n 1 err)"
    elif [ "$(grep -c 'error: \|memory full' err)" -ne 1 ]; then
        echo "$(grep -c 'error: ' err) messages"
    elif [ -d sound ]; then
        # a folder without an index, and what is in it is whole
        [ ! -f results/index.html ] || echo "a report in spite of an error"
    elif ls results* >rest 2>&1; then
        echo "results in spite of an error: $(cat rest)"
    fi
}

# attack NAME COMMAND...: writes results.*, or a report into the folder results
attack() {
    name=$1
    shift
    rm -rf results* sound*
    COUNT=count LD_PRELOAD=./deny.so "$@" >out 2>err || { echo "memory | $name | 0 | 0 | 0 | | $(head -n 1 err)" && return; }
    for file in results*; do
        case $file in
        results) mv "$file" sound ;;
        *) mv "$file" "sound.${file#*.}" ;;
        esac
    done
    all=$(cat count)
    rm -f count
    by=1
    [ ! -d sound ] || by=$(((all + 199) / 200))
    [ "$STRESS" != short ] || by=$(((all + 24) / 25))
    tried=0 good=0 refused=0 wrong=''
    # where not all are tried, the last ones too: by then there are results
    for at in $(seq 1 "$by" "$all") $([ "$by" -eq 1 ] || seq $((all - 11)) "$all"); do
        rm -rf results*
        DENY=$at LD_PRELOAD=./deny.so timeout 60 "$@" >out 2>err
        status=$?
        reason=$(why "$@")
        tried=$((tried + 1))
        if [ -n "$reason" ]; then
            wrong=${wrong:-allocation $at: $reason}
            echo "$name: allocation $at: $reason" >&2
        elif [ $status -eq 0 ]; then
            good=$((good + 1))
        else
            refused=$((refused + 1))
        fi
    done
    echo "memory | $name | $tried | $good | $refused | $all allocations | ${wrong:-ok}"
}

sed 's/^duration: .*/duration: 0.1/; s/^output_step: .*/output_step: 0.05/' "$models/scenes/tires_coast.scene" >short.scene
sed 's/^duration: .*/duration: 0.1/; s/^output_step: .*/output_step: 0.05/' "$models/scenes/quarter_car.scene" >car.scene
attack gicgen "$gicgen" "$models/hmmwv_vehicle.veh" -o results.c
attack "gicgen --graph" "$gicgen" --graph results.dot "$models/hmmwv_tires.veh"
engines="tape gic tcc gcp2"
[ "$STRESS" = short ] || engines="$engines gcp1"
for engine in $engines; do
    attack "gicrun $engine" "$gicrun" -q --engine "$engine" "$models/hmmwv_tires.veh" short.scene -o results.csv
done
attack "gicrun --equilibrium" "$gicrun" -q --engine tape --equilibrium "$models/hmmwv_tires.veh" -o results.csv
attack "gicrun --modes" "$gicrun" -q --engine tape --modes "$models/quarter_car.veh" -o results.csv
attack "gicrun --linearize" "$gicrun" -q --linearize "$models/quarter_car.veh" -o results.npz
attack "gicrun adams" "$gicrun" -q --engine tape --integrator adams "$models/quarter_car.veh" car.scene -o results.csv
attack "gicrun --animate" "$gicrun" -q --engine tape "$models/hmmwv_tires.veh" short.scene --animate results.html
# the picture is gnuplot's, which gets its memory elsewhere: gicrun's own ends
attack "gicrun --plot" "$gicrun" -q --engine tape "$models/hmmwv_tires.veh" short.scene --plot results.svg
attack "gicsweep" "$gicsweep" -q --engine tape "$models/hmmwv_tires.veh" short.scene --vary drive_torque=0:10:2 \
    -o results.csv
OMP_NUM_THREADS=2
attack "gicsweep, two processes" "$gicsweep" -q --engine tape "$models/hmmwv_tires.veh" short.scene \
    --vary drive_torque=0:10:3 -o results.csv
OMP_NUM_THREADS=1
[ "$STRESS" = short ] ||
    attack "gicbench" "$gicbench" --quick --drive --engines tape -o results "$models/hmmwv_tires.veh" short.scene
