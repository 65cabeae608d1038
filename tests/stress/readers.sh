#!/bin/sh
# SPDX-License-Identifier: MIT
# readers.sh GICGEN GICRUN: files made to be large, deep, wide, circular or endless (hostile.py). Each must be taken, or
# refused with one message that says why and how to help it, within 60 s (they take some seconds at the most) and 3 GB.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
here=$(realpath "$(dirname "$0")")
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
[ "$STRESS" = short ] && size=5 || size=100
cd "$work" || exit 1
python3 "$here/hostile.py" . "$size" >list || exit 1
GICGEN_CACHE=
export GICGEN_CACHE

# what is wrong with the answer to a file, or nothing
why() {
    if [ "$status" -eq 124 ]; then
        echo "takes longer than 60 s"
    elif [ "$status" -ne "$2" ]; then
        echo "exit status $status: $(head -c 200 err | head -n 1)"
    elif [ "$status" -eq 0 ]; then
        ! grep -q ': error: ' err || echo "an error, and exit status 0"
    elif [ "$(grep -c 'error: ' err)" -ne 1 ]; then
        echo "not one error"
    elif ! grep -qF -e "$3" err; then
        echo "not '$3': $(head -c 200 err | head -n 1)"
    elif ! grep -q '^  remedy: ' err; then
        echo "no remedy"
    elif [ "$(wc -c <err)" -gt 20000 ]; then
        echo "a message of $(wc -c <err) bytes"
    fi
}

for reader in veh scene; do
    tried=0 good=0 refused=0 worst=0 wrong=
    grep "^$reader|" list >cases
    while IFS='|' read -r _ file expected says; do
        start=$(date +%s%N)
        (
            # shellcheck disable=SC3045  # dash and bash have it
            ulimit -v 3000000
            if [ $reader = veh ]; then
                exec timeout 60 "$gicgen" --dump-model "$file"
            else
                exec timeout 60 "$gicrun" -q --engine tape "$here/../../models/quarter_car.veh" "$file"
            fi
        ) >out 2>err </dev/null
        status=$?
        taken=$((($(date +%s%N) - start) / 1000000))
        [ $taken -le $worst ] || { worst=$taken && slowest=$file; }
        reason=$(why "$file" "$expected" "$says")
        tried=$((tried + 1))
        if [ -n "$reason" ]; then
            wrong=${wrong:-$file: $reason}
            echo "$file: $reason" >&2
        elif [ $status -eq 0 ]; then
            good=$((good + 1))
        else
            refused=$((refused + 1))
        fi
    done <cases
    echo "readers | $reader | $tried | $good | $refused | $worst ms: $slowest | ${wrong:-ok}"
done
