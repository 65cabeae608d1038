#!/bin/sh
# SPDX-License-Identifier: MIT
# single.sh GICGEN [ROUNDS [FLAG...]]: 30 s of one complete vehicle over full_run (single.c) by the code as it is, in lanes of 4 and of 8, and in lanes with tire
# tables, by turns in ROUNDS (20) rounds: least and median CPU time. By cc, and by clang if there is one (COMPILERS chooses), with `-O3 -march=native
# -ffp-contract=fast` or the FLAGs.
gicgen=$1
rounds=${2:-20}
shift
[ $# -gt 0 ] && shift
[ $# -gt 0 ] || set -- -O3 -march=native -ffp-contract=fast
here=$(cd "$(dirname "$0")" && pwd)
runtime=$here/../../runtime
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
compilers=
for compiler in ${COMPILERS:-cc clang}; do
    command -v "$compiler" >/dev/null && compilers="$compilers $compiler"
done
ways="plain --lanes_4 --lanes_8 --lanes_4_--tire-tables --lanes_8_--tire-tables"
for way in $ways; do
    mkdir "$work/$way"
    option=$(echo "$way" | tr _ ' ')
    # shellcheck disable=SC2086 # words
    "$gicgen" ${option#plain} "$here/../../models/hmmwv_vehicle.veh" -o "$work/$way/hmmwv_vehicle.c" || exit 1
    for compiler in $compilers; do
        "$compiler" -Wno-psabi "$@" -D_POSIX_C_SOURCE=200809L -I"$work/$way" -I"$runtime" "$here/single.c" "$work/$way/hmmwv_vehicle.c" "$runtime/gic_runtime.c" \
            -o "$work/$way/$compiler" -lm || exit 1
    done
done
uptime
round=0
while [ $((round += 1)) -le "$rounds" ]; do
    for compiler in $compilers; do
        for way in $ways; do
            printf '%s %s ' "$compiler" "$way" && "$work/$way/$compiler" || exit 1
        done
    done
done >"$work/times"
for compiler in $compilers; do
    for way in $ways; do
        grep "^$compiler $way " "$work/times" | sort -k3 -n | awk -v flags="$*" '{ t[NR] = $3; x = $4; way = $2; by = $1; gsub("_", " ", way) }
            END { printf "%s %s, %-26s %.4f s at least, %.4f median, %.2f us a step; x = %.9g m\n", by, flags, way ":", t[1], t[int((NR + 1) / 2)], t[1] / 5000 * 1e6, x }'
    done
done
