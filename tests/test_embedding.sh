#!/bin/sh
# SPDX-License-Identifier: MIT
# test_embedding.sh GICGEN: README's example works as it stands there, and emitted code and runtime core compile without
# a warning in every way that users build them.
gicgen=$1
root=$(cd "$(dirname "$0")/.." && pwd)
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
    "$gicgen" "$model" -o "$work/$name.c" || exit 1
    warnings="-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror -O0 -fsyntax-only -I$work -I$root/runtime"
    for source in "$work/$name.c" "$root/runtime/gic_runtime.c"; do
        # shellcheck disable=SC2086  # lists of words
        for how in "gcc -std=c99" "gcc -std=c11" "gcc -std=c99 -DGIC_FLOAT -Wdouble-promotion" "g++ -std=c++11 -x c++" \
            "g++ -std=c++20 -DGIC_FLOAT -Wdouble-promotion -x c++"; do
            $how $warnings "$source"
            check $? "$how $(basename "$source")"
        done
    done
done

# the example: the first block of C in README, compiled by the two lines of shell that follow it
sed -n '/^```c$/,/^```$/p' "$root/README.md" | sed '/^```/d' >"$work/main.c"
(cd "$work" && cc -Wall -Wextra -Werror -I. -I"$root/runtime" main.c hmmwv.c "$root/runtime/gic_runtime.c" -lm -o example)
check $? "README's example does not compile"
answer=$("$work/example")
check $? "README's example fails: $answer"
# the model says that it rests within a millimetre of its design configuration, whose chassis stands at 0.474
echo "$answer" | awk '/^ok: / { z = $6 } END { exit !(z > 0.473 && z < 0.475) }'
check $? "README's example prints: $answer"

# freestanding: no allocation, no input or output, nothing but mathematics and memory copies (a compiler may merge sin
# and cos, or guard the stack)
allowed='gic_.*|sqrt|sin|cos|sincos|tan|atan2|asin|acos|fabs|floor|mem(cpy|set|move|cmp)|__stack_chk_fail'
for model in "$root"/models/*.veh; do
    name=$(basename "$model" .veh)
    cc -O2 -fno-pie -c -I"$work" -I"$root/runtime" "$work/$name.c" -o "$work/$name.o"
    foreign=$(nm -u "$work/$name.o" | awk '{ print $2 }' | grep -Evx "$allowed")
    [ -z "$foreign" ]
    check $? "$name needs $foreign"
    # writable data or common symbols would be globals
    [ -z "$(nm "$work/$name.o" | awk '$2 ~ /^[DdBbC]$/')" ]
    check $? "$name has variables: $(nm "$work/$name.o" | awk '$2 ~ /^[DdBbC]$/ { print $3 }')"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
