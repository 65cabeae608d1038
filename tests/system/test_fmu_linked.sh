#!/bin/sh
# SPDX-License-Identifier: MIT
# test_fmu_linked.sh GICGEN: the sources of two FMUs, compiled as the standard says with a prefix each and linked into one
# program: no name is there twice, and both vehicles move by turns as their binaries do, bit for bit.
gicgen=$1
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# shellcheck source=tests/fmi/small/lib.sh
. "$(dirname "$0")/../fmi/small/lib.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)
# other platforms are not what this is about, and take most of the time
mkdir "$work/without"
for name in aarch64-linux-gnu-gcc x86_64-w64-mingw32-gcc; do
    printf '#!/bin/sh\nexit 1\n' >"$work/without/$name"
    chmod +x "$work/without/$name"
done
PATH=$work/without:$PATH
strict="-std=c99 -pedantic -Wall -Wextra -Werror -O1"

# objects NAME VERSION MODEL: of the sources of the unit, all of them
objects() {
    for source in "$work/$1/sources/"*.c; do
        # shellcheck disable=SC2086  # a list of words
        ${CC:-cc} $strict "-DFMI$2_FUNCTION_PREFIX=$3_" -c "$source" -o "${source%.c}.o" || return 1
    done
}
library() { echo "$work/$1/binaries/"*/*.so; }
# names that a program sees begin with the model's
own_names() { ! nm -g --defined-only "$work/$1/sources/"*.o | awk 'NF == 3 { print $3 }' | grep -v "^$2_"; }

for version in 2 3; do
    unit "one$version" $version "$root/models/pendulum.veh" && unit "other$version" $version "$root/models/quarter_car.veh"
    verdict $? "FMI $version.0: two FMUs"
    for unit in "one$version pendulum" "other$version quarter_car"; do
        objects "${unit% *}" $version "${unit#* }" >"$work/out" 2>"$work/err"
        verdict $? "FMI $version.0, ${unit#* }: sources compile with a prefix"
        own_names "${unit% *}" "${unit#* }" >"$work/out"
        verdict $? "FMI $version.0, ${unit#* }: all names for the linker begin with the model's"
    done
    # shellcheck disable=SC2086  # a list of words
    ${CC:-cc} $strict -Wno-pedantic -DVERSION=$version "$root/tests/fmi/small/steps.c" -ldl -o "$work/alone" >"$work/out" 2>"$work/err" &&
        ${CC:-cc} $strict -DVERSION=$version -DFIRST=pendulum_ -DSECOND=quarter_car_ "$root/tests/fmi/small/steps.c" \
            "$work/one$version/sources/"*.o "$work/other$version/sources/"*.o -lm -o "$work/linked" >"$work/out" 2>"$work/err"
    verdict $? "FMI $version.0: both are linked into one program"
    set -- "$(token one$version)" "$(outputs one$version)" "$(token other$version)" "$(outputs other$version)"
    { "$work/alone" 0.01 200 "$(library one$version)" "$1" "$2" &&
        "$work/alone" 0.01 200 "$(library other$version)" "$3" "$4"; } >"$work/alone.txt" 2>"$work/err" &&
        "$work/linked" 0.01 200 1 "$1" "$2" 2 "$3" "$4" >"$work/linked.txt" 2>>"$work/err"
    verdict $? "FMI $version.0: both run by turns in one program, and alone"
    [ "$(wc -l <"$work/linked.txt")" -gt 10 ] && cmp "$work/alone.txt" "$work/linked.txt" >"$work/out"
    verdict $? "FMI $version.0: they move as alone, bit for bit"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
