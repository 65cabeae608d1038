#!/bin/sh
# SPDX-License-Identifier: MIT
# test_lane_functions.sh: the elementary functions of gic_lanes.h against quad precision (tests/data/lanes): every multiple of
# pi/2 in the range and its neighbours, random arguments of all magnitudes, and special ones, within the bounds that the
# header states; of either number type, with and without fused products, -ffast-math (which leaves out subnormal numbers
# and infinities), by gcc and clang, C and C++. The short polynomials likewise, within absolute bounds (tests/data/lanes/short.c);
# their coefficients are those of Remez' exchange (short.py).
root=$(cd "$(dirname "$0")/../.." && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
passed=0
failed=0
includes="-I$root/runtime -I$root/tests/data/lanes"
native=
echo 'int main(void) { return 0; }' >native.c
gcc -march=native native.c -o native 2>said && ./native && native=-march=native

# bounds COUNT ARGUMENTS LANES COMPILER...: of so many arguments, all or normal
bounds() {
    count=$1 arguments=$2 lanes=$3
    shift 3
    case $* in
    *GIC_FLOAT*) real=-DGIC_FLOAT ;;
    *) real= ;;
    esac
    # shellcheck disable=SC2086  # lists of words
    if "$@" -Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Werror -DLANES="$lanes" $includes -c \
        "$root/tests/data/lanes/wrappers.c" -o wrappers.o >said 2>&1 &&
        gcc -std=gnu11 -O2 $real -DLANES="$lanes" $includes "$root/tests/data/lanes/functions.c" wrappers.o -lquadmath -lm \
            -o functions >said 2>&1 && ./functions "$count" "$arguments" >said 2>&1; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL $lanes lanes: $*"
        sed 's/^/    /' said | head -30
    fi
}

# every multiple is every fourth argument
bounds 2700000 all 4 gcc -std=c99 -O2 -ffp-contract=off
bounds 40000 all 4 gcc -std=c99 -O2 -ffp-contract=off -DGIC_FLOAT
bounds 40000 all 2 gcc -std=c99 -O0
bounds 40000 all 8 clang -std=c99 -O1 -DGIC_FLOAT
bounds 40000 all 2 clang -std=c99 -O1
for compiler in gcc clang; do
    bounds 200000 all 4 $compiler -std=c99 -O3 $native -ffp-contract=fast
    bounds 40000 all 4 $compiler -std=c99 -O3 $native -ffp-contract=fast -DGIC_FLOAT
    bounds 40000 normal 4 $compiler -std=c99 -O3 $native -ffast-math
done
bounds 40000 all 16 g++ -std=c++11 -x c++ -O1
bounds 40000 all 4 clang++ -std=c++11 -x c++ -O1 -DGIC_FLOAT

# short COMPILER...: the short polynomials, for tires
short() {
    if "$@" -std=gnu11 -Wall -Wextra -Wno-psabi -Werror "-I$root/runtime" "$root/tests/data/lanes/short.c" -lquadmath -lm \
        -o short >said 2>&1 && ./short >said 2>&1; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL short polynomials: $*"
        sed 's/^/    /' said | head -30
    fi
}
short gcc -DLANES=4 -O2 -ffp-contract=off
short gcc -DLANES=8 -O3 $native -ffp-contract=fast
short gcc -DLANES=2 -O0
short gcc -DLANES=16 -O2 -DGIC_FLOAT
short gcc -DLANES=4 -O3 $native -DGIC_FLOAT
# their coefficients, found once more
if python3 "$root/tests/data/lanes/short.py" "$root/runtime/gic_lanes.h" "$root/generator/expression/short_curve.c" >said 2>&1; then
    passed=$((passed + 1))
else
    failed=$((failed + 1))
    cat said
fi

# a compiler without vectors is told so
# shellcheck disable=SC2086
tcc -DLANES=4 $includes -c "$root/tests/data/lanes/wrappers.c" -o x.o >said 2>&1
if grep -q 'lanes need the vector extensions' said; then
    passed=$((passed + 1))
else
    failed=$((failed + 1))
    echo "FAIL tcc: $(cat said)"
fi

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
