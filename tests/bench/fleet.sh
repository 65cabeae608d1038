#!/bin/sh
# SPDX-License-Identifier: MIT
# fleet.sh GICGEN [VEHICLES [FLAG...]]: complete vehicles in a batch against one by one over the 30 s of full_run, by turns in
# one run, with the spread of the ratio over the 50 parts of the run (first and last tenth left out) and the distance of the
# states (fleet.c). 4 and 8 lanes of double, 8 and 16 of float, by cc, and by clang if there is one, with `-O3 -march=native`
# or the FLAGs, for batch and single vehicle alike; COMPILERS and LANES choose fewer. 64 VEHICLES. Compiling takes minutes.
gicgen=$1
vehicles=${2:-64}
shift
[ $# -gt 0 ] && shift
[ $# -gt 0 ] || set -- -O3 -march=native
here=$(cd "$(dirname "$0")" && pwd)
runtime=$here/../../runtime
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
model=$here/../../models/hmmwv_vehicle.veh
"$gicgen" "$model" -o "$work/hmmwv_vehicle.c" || exit 1
for compiler in ${COMPILERS:-cc clang}; do
    command -v "$compiler" >/dev/null || continue
    for lanes in ${LANES:-4 8 float8 float16}; do
        float=
        case $lanes in float*) float=-DGIC_FLOAT ;; esac
        "$gicgen" --batch "$vehicles" --lanes "${lanes#float}" "$model" -o "$work/hmmwv_vehicle_batch.c" || exit 1
        objects=
        for source in "$work/hmmwv_vehicle_batch.c" "$work/hmmwv_vehicle.c" "$runtime/gic_runtime.c" "$here/fleet.c"; do
            object=$work/$(basename "$source" .c).o
            "$compiler" "$@" $float -D_POSIX_C_SOURCE=200809L -I"$work" -I"$runtime" -c "$source" -o "$object" || exit 1
            objects="$objects $object"
        done
        # shellcheck disable=SC2086 # a list
        "$compiler" $objects -o "$work/run" -lm && printf '%s %s %s: ' "$compiler" "$*" "$float" && "$work/run" || exit 1
    done
done
