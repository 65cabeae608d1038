#!/bin/sh
# SPDX-License-Identifier: MIT
# test_generated.sh GICGEN: generated/ holds, byte for byte, what gicgen makes of models/, and nothing else.
gicgen=$1
root=$(dirname "$0")/../..
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

mkdir "$work/made"
for model in "$root"/models/*.veh; do
    name=$(basename "$model" .veh)
    "$gicgen" "$model" -o "$work/made/$name.c"
    verdict $? "$name: not generated"
    for file in "$name.c" "$name.h"; do
        cmp "$work/made/$file" "$root/generated/$file"
        verdict $? "generated/$file is out of date: make generated"
    done
done
[ "$(ls "$work/made")" = "$(ls "$root/generated")" ]
verdict $? "generated/ has other files than models/ give"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
