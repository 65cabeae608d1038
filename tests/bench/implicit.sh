#!/bin/sh
# SPDX-License-Identifier: MIT
# implicit.sh GICGEN [FLAG...]: steps of the hatchback on its bushings, ab3 and rk4 against ros2, ros3 and imex by turns in one run, with the
# error of the place after a second in a crosswind, from where the model is drawn, against rk4 at 31 us, and the longest step of each (implicit.c); the code is
# compiled with `-O2 -march=native` or the FLAGs, which takes minutes.
gicgen=$1
shift
[ $# -gt 0 ] || set -- -O2 -march=native
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
"$gicgen" --implicit --spread-jacobian "$here/../../models/hatchback.veh" -o "$work/hatchback.c" &&
    cc -std=c99 -D_POSIX_C_SOURCE=199309L "$@" -I"$work" -I"$here/../../runtime" -DMODEL=hatchback -DINPUT=HATCHBACK_INPUT_CROSSWIND \
        -DVALUE=20 "$here/implicit.c" "$work/hatchback.c" "$here/../../runtime/gic_runtime.c" -o "$work/run" -lm && "$work/run"
