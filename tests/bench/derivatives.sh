#!/bin/sh
# SPDX-License-Identifier: MIT
# derivatives.sh GICGEN [FLAG...]: what tangents and Jacobians cost in right-hand sides, by turns in one run (derivatives.c);
# the code is compiled with `-O2 -march=native` or the FLAGs.
gicgen=$1
shift
[ $# -gt 0 ] || set -- -O2 -march=native
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
for model in pendulum quarter_car hmmwv hmmwv_vehicle; do
    "$gicgen" --derivatives "$here/../../models/$model.veh" -o "$work/$model.c" &&
        cc -std=c99 "$@" -I"$work" -I"$here/../../runtime" -DMODEL=$model "-DCODE=\"$model.c\"" \
            "$here/derivatives.c" -o "$work/run" -lm && printf '%s: ' "$model" && "$work/run" || exit 1
done
