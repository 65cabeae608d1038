#!/bin/sh
# SPDX-License-Identifier: MIT
# implicit.sh GICGEN [FLAG...]: steps of the hatchback on its bushings, ab3 and rk4 against ros2, ros3, imex and exp3, with its parts one after another
# and in lanes of 4 (environment LANES: another width), by turns in one run, with the error of the place after a second in a crosswind, from where
# the model is drawn, against rk4 at 31 us, and the longest step of each (implicit.c); the code is compiled by cc (environment CC: another one) with `-O2 -march=native` or the FLAGs,
# which takes minutes.
gicgen=$(realpath "$1")
shift
[ $# -gt 0 ] || set -- -O2 -march=native
here=$(cd "$(dirname "$0")" && pwd)
model=$here/../../models/hatchback.veh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
"$gicgen" --implicit --exponential --spread-jacobian "$model" -o hatchback.c &&
    "$gicgen" --implicit --exponential --spread-jacobian --lanes "${LANES:-4}" "$model" -o lanes.c || exit 1
for part in c h; do # both codes in one program: names of their own
    sed 's/"lanes\.h"/"hatchback.h"/; s/hatchback/hatchback_lanes/g; s/HATCHBACK/HATCHBACK_LANES/g' "lanes.$part" >"hatchback_lanes.$part"
done
for code in hatchback.c hatchback_lanes.c; do
    "${CC:-cc}" -std=c99 "$@" -Wno-psabi -I. -I"$here/../../runtime" -c "$code" || exit 1
done
"${CC:-cc}" -std=c99 -D_POSIX_C_SOURCE=199309L "$@" -I. -I"$here/../../runtime" -DMODEL=hatchback -DLANES=hatchback_lanes -DINPUT=HATCHBACK_INPUT_CROSSWIND \
    -DVALUE=20 "$here/implicit.c" hatchback.o hatchback_lanes.o "$here/../../runtime/gic_runtime.c" -o run -lm && uptime && ./run
