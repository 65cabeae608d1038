#!/bin/sh
# SPDX-License-Identifier: MIT
# axle_chain.sh [BODIES...]: how the cost of a vehicle grows with its number of bodies (10 20 40 60 by default): time of
# gicgen, operations of one right-hand side, compile time, and run time of one right-hand side within AB3 steps, each
# also per body. Wants the programs built; GICGEN, CC, CFLAGS and STEPS (20000) may be given.
#
# The vehicle of axle_chain.sh drops by 1 cm onto a flat road, and its springs and tires move throughout. Times are the
# shortest of three; a busy machine still shows in them.
root=$(cd "$(dirname "$0")/../.." && pwd)
gicgen=${GICGEN:-$root/build/gicgen}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM

cat >"$work/main.c" <<'END'
#include "chain.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* nanoseconds of one right-hand side */
int main(int argc, char **argv)
{
    static axle_chain vehicle;
    double best = 1e9;
    long steps = argc > 1 ? atol(argv[1]) : 0;
    for (int repeat = 0; repeat < 3; ++repeat) {
        if (axle_chain_setup(&vehicle) != GIC_OK)
            return 1;
        vehicle.state[AXLE_CHAIN_STATE_R_Z] += 0.01;
        double start = seconds();
        for (long i = 0; i < steps; ++i)
            if (axle_chain_step(&vehicle, 0.001, GIC_AB3) != GIC_OK)
                return 1;
        double time = (seconds() - start) / (double)vehicle.head.rhs_count;
        best = time < best ? time : best;
    }
    printf("%.0f\n", 1e9 * best);
    return 0;
}
END

# shortest COMMAND...: wall time in seconds, the shortest of three runs
shortest() {
    for _ in 1 2 3; do
        start=$(date +%s.%N)
        "$@" || exit 1
        echo "$start $(date +%s.%N)"
    done | awk '{ time = $2 - $1; if (NR == 1 || time < best) best = time } END { printf "%.3f\n", best }'
}

# compile: the model only, as a user's build would
compile() {
    # shellcheck disable=SC2086  # CFLAGS is a list
    ${CC:-cc} -std=c99 ${CFLAGS:--O2} -ffp-contract=off -I"$root/runtime" -c "$work/chain.c" -o "$work/chain.o"
}

printf '%6s %10s %8s %12s %8s %12s %8s %12s %8s\n' bodies 'gicgen [s]' ms/body operations /body 'compile [s]' ms/body \
    'rhs [ns]' /body
[ $# -gt 0 ] || set -- 10 20 40 60
for bodies in "$@"; do
    sh "$root/tests/lib/axle_chain.sh" "$bodies" >"$work/chain.veh" || exit 1
    generate=$(shortest "$gicgen" "$work/chain.veh" -o "$work/chain.c")
    operations=$(awk '/all together/ { print $4 + $5 + $6 + $7 + $8 }' "$work/chain.h")
    compile=$(shortest compile)
    ${CC:-cc} -std=gnu99 -O2 -ffp-contract=off -I"$root/runtime" -I"$work" "$work/main.c" "$work/chain.o" \
        "$root/runtime/gic_runtime.c" -lm -o "$work/chain" || exit 1
    rhs=$("$work/chain" "${STEPS:-20000}") || exit 1
    echo "$bodies $generate $operations $compile $rhs" | awk '{
        printf "%6d %10.3f %8.2f %12d %8.1f %12.2f %8.1f %12d %8.1f\n", $1, $2, 1e3 * $2 / $1, $3, $3 / $1, $4,
            1e3 * $4 / $1, $5, $5 / $1 }'
done
