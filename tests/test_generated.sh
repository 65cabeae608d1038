#!/bin/sh
# SPDX-License-Identifier: MIT
# test_generated.sh GICGEN: generated/ holds, byte for byte, what gicgen makes of models/, and nothing else.
gicgen=$1
root=$(dirname "$0")/..
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0
failed=0

check() {
    if [ "$1" -eq 0 ]; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL $2"
    fi
}

for model in "$root"/models/*.veh; do
    name=$(basename "$model" .veh)
    "$gicgen" "$model" -o "$work/$name.c"
    check $? "$name: not generated"
    for file in "$name.c" "$name.h"; do
        cmp "$work/$file" "$root/generated/$file"
        check $? "generated/$file is out of date: make generated"
    done
done
[ "$(ls "$work")" = "$(ls "$root/generated")" ]
check $? "generated/ has other files than models/ give"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
