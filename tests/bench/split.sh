#!/bin/sh
# SPDX-License-Identifier: MIT
# split.sh GICGEN [FLAG...]: steps of 1 ms of the hatchback on its bushings with all states implicit and with those alone that have a share in stiff
# motions (gicgen --stiff), by turns in one run, as implicit.sh; a second in a crosswind from where the model is drawn. The code is compiled
# by cc (environment CC: another one) with `-O2 -march=native` or the FLAGs, which takes minutes.
gicgen=$(realpath "$1")
shift
[ $# -gt 0 ] || set -- -O2 -march=native
here=$(cd "$(dirname "$0")" && pwd)
model=$here/../../models/hatchback.veh
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
"$gicgen" --implicit --spread-jacobian "$model" -o hatchback.c && "$gicgen" --implicit --spread-jacobian --stiff 0.001 "$model" -o split.c || exit 1
for part in c h; do # both codes in one program: names of their own
    sed 's/"split\.h"/"hatchback.h"/; s/hatchback/hatchback_split/g; s/HATCHBACK/HATCHBACK_SPLIT/g' "split.$part" >"hatchback_split.$part"
done
for code in hatchback.c hatchback_split.c; do
    "${CC:-cc}" -std=c99 "$@" -I. -I"$here/../../runtime" -c "$code" || exit 1
done
"${CC:-cc}" -std=c99 -D_POSIX_C_SOURCE=199309L "$@" -I. -I"$here/../../runtime" -DMODEL=hatchback -DLANES=hatchback_split -DSPLIT \
    -DINPUT=HATCHBACK_INPUT_CROSSWIND -DVALUE=20 "$here/implicit.c" hatchback.o hatchback_split.o "$here/../../runtime/gic_runtime.c" -o run -lm && uptime && ./run
