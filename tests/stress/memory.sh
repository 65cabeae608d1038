#!/bin/sh
# SPDX-License-Identifier: MIT
# memory.sh GICGEN GICRUN: memory that ends, at each allocation in turn (short: at 25 of them), of libraries too. The
# program must end with one message and without results, or go on without what was not to be had and write the same
# results as ever; it may not fall, hang or leave files.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
models=$(realpath "$(dirname "$0")/../../models")
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
GICGEN_CACHE=
TMPDIR=$work/tmp
export GICGEN_CACHE TMPDIR
mkdir tmp

# DENY=n: the n-th allocation and all behind it fail; COUNT: a file for their number. What libraries allocate before the
# program begins doesn't count: it does not get that far.
cat >deny.c <<'END'
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
${CC:-cc} -shared -fPIC -O1 deny.c -o deny.so || exit 1

# what is wrong with how it ended, or nothing
why() {
    [ -z "$(ls -A tmp)" ] || { echo "leaves $(ls tmp)" && rm -rf tmp && mkdir tmp; }
    for file in results*; do
        case $file in
        *.tmp) echo "leaves $file" && rm -f "$file" ;;
        esac
    done
    if [ "$status" -eq 0 ]; then
        for file in results*; do
            cmp -s "$file" "sound.${file#*.}" || echo "other results in $file"
        done
    elif [ "$status" -eq 124 ]; then
        echo "hangs"
    elif [ "$status" -ne 1 ]; then
        echo "exit status $status: $(tail -n 1 err)"
    elif [ "$(grep -c 'error: \|memory full' err)" -ne 1 ]; then
        echo "$(grep -c 'error: ' err) messages"
    elif ls results* >rest 2>&1; then
        echo "results in spite of an error: $(cat rest)"
    fi
}

# attack NAME COMMAND...: writes results.*
attack() {
    name=$1
    shift
    rm -f results* sound*
    COUNT=count LD_PRELOAD=./deny.so "$@" >out 2>err || { echo "memory | $name | 0 | 0 | 0 | | $(head -n 1 err)" && return; }
    for file in results*; do
        mv "$file" "sound.${file#*.}"
    done
    all=$(cat count)
    rm -f count
    [ "$STRESS" = short ] && by=$(((all + 24) / 25)) || by=1
    tried=0 good=0 refused=0 wrong=
    at=1
    while [ $at -le "$all" ]; do
        rm -f results*
        DENY=$at LD_PRELOAD=./deny.so timeout 60 "$@" >out 2>err
        status=$?
        reason=$(why)
        tried=$((tried + 1))
        if [ -n "$reason" ]; then
            wrong=${wrong:-allocation $at: $reason}
            echo "$name: allocation $at: $reason" >&2
        elif [ $status -eq 0 ]; then
            good=$((good + 1))
        else
            refused=$((refused + 1))
        fi
        at=$((at + by))
    done
    echo "memory | $name | $tried | $good | $refused | $all allocations | ${wrong:-ok}"
}

sed 's/^duration: .*/duration: 0.1/; s/^output_step: .*/output_step: 0.05/' "$models/scenes/tires_coast.scene" >short.scene
attack gicgen "$gicgen" "$models/hmmwv_vehicle.veh" -o results.c
attack "gicgen --graph" "$gicgen" --graph results.dot "$models/hmmwv_tires.veh"
for engine in tape gic tcc; do
    attack "gicrun $engine" "$gicrun" -q --engine $engine "$models/hmmwv_tires.veh" short.scene -o results.csv
done
attack "gicrun --equilibrium" "$gicrun" -q --engine tape --equilibrium "$models/hmmwv_tires.veh" -o results.csv
attack "gicrun --animate" "$gicrun" -q --engine tape "$models/hmmwv_tires.veh" short.scene --animate results.html
