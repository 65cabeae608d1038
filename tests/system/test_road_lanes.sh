#!/bin/sh
# SPDX-License-Identifier: MIT
# test_road_lanes.sh: gic_road_lanes.h against gic_road.c (tests/data/lanes/roads.c): equal heights and slopes of roads of every
# kind, also where sines are libm's and products are not contracted; of either number type, by gcc and clang, with the
# processor's own vectors and without.
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
passed=0
failed=0
native=
echo 'int main(void) { return 0; }' >native.c
gcc -march=native native.c -o native 2>said && ./native && native=-march=native
warnings="-Wall -Wextra -Wpedantic -Wshadow -Wno-psabi -Werror"

# roads COMPILER...
roads() {
    # shellcheck disable=SC2086  # lists of words
    if "$@" $warnings "-I$root/runtime" "$root/tests/data/lanes/roads.c" "$root/runtime/gic_road.c" \
        "$root/runtime/gic_runtime.c" -lm -o roads >said 2>&1 && ./roads >said 2>&1; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL $*"
        sed 's/^/    /' said | head -30
    fi
}

exact="-std=c99 -ffp-contract=off -DEXACT"
for compiler in gcc clang; do
    # shellcheck disable=SC2086  # lists of words
    {
        roads $compiler $exact -DLANES=8 -O3 $native
        roads $compiler $exact -DLANES=4 -O1
        roads $compiler $exact -DLANES=16 -O2 $native -DGIC_FLOAT
        roads $compiler $exact -DLANES=2 -O2 -fsanitize=address,undefined -fno-sanitize-recover=all
        roads $compiler -std=c99 -DLANES=8 -O3 $native -ffp-contract=fast
        roads $compiler -std=c99 -DLANES=4 -O2 -DGIC_FLOAT -ffp-contract=off
    }
done
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
