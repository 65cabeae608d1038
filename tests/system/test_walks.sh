#!/bin/sh
# SPDX-License-Identifier: MIT
# test_walks.sh: what generator/README.md walks through works. Each walk is a patch of tests/walks: a joint, a force element,
# an output, an emission target. They are applied to a copy of the sources, which is built without optimization; the sled of
# walks/walk.veh has all of them. Accelerations, poses and reactions agree with quad precision to 5e-13; runs are those of a
# twin with joints and formulas that were there before, and those of an engine that shares no formula with the generator.
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)
walks=$root/tests/walks
copy=$work/copy
build=$work/build
cc=${CC:-cc}

mkdir "$copy"
cp -r "$root/Makefile" "$root/LICENSE" "$root/generator" "$root/runtime" "$root/templates" "$copy/"
mkdir "$copy/models" "$copy/tests"
cp "$root"/models/*.md "$copy/models/"
cp -r "$root/tests/unit" "$root/tests/tools" "$root/tests/reference" "$copy/tests/"

apply() { patch -s -f -F 3 --no-backup-if-mismatch -d "$copy" -p1 <"$walks/$1.patch" >"$work/out" 2>"$work/err"; }
for walk in add_joint add_force add_output add_target; do
    check "$walk.patch applies: where it does not, do the walk again as generator/README.md says and write it anew" apply $walk
done
programs="$build/gicgen $build/gicrun $build/check/states $build/check/reference $build/check/agree"
# shellcheck disable=SC2086  # a list of words
build() { make -s -C "$copy" -j"$(nproc)" BUILD="$build" CC="$cc" CFLAGS=-O0 WERROR=-Werror $programs >"$work/out" 2>"$work/err"; }
check 'what they make compiles without a warning' build
gicrun=$build/gicrun
model=$walks/walk.veh
scene=$walks/walk.scene
cd "$work" || exit 1

# quad precision, which knows the joint and the friction from FORMAT.md's lines alone
judged() {
    "$build/gicgen" --dump-model "$model" >dump && "$build/check/states" dump --count 50 --seed 1 -o states &&
        "$build/check/reference" dump states -o accelerations && "$gicrun" --eval states "$model" -o results &&
        "$build/check/agree" dump accelerations results --reactions --tolerance 5e-13
} >"$work/out" 2>"$work/err"
check 'accelerations, poses and reactions agree with quad precision' judged

# near FILE FILE TOLERANCE: the same rows and columns, numbers within TOLERANCE of each other
near() {
    awk -F, -v tolerance="$3" 'NR == FNR { row[FNR] = $0; rows = FNR; next }
        { if (split(row[FNR], other) != NF) exit bad = 1
          for (i = 1; i <= NF; ++i) if (FNR == 1 ? $i != other[i] : ($i - other[i])^2 > tolerance^2) exit bad = 1
          ++compared }
        END { exit bad || compared != rows || rows < 100 }' "$1" "$2"
}
run -q "$model" "$scene" -o walk.csv
check 'the sled slides' exits 0
run -q --engine gic "$model" "$scene" -o gic.csv
check 'the interpreted engine knows it' exits 0
check 'and sees the same' near walk.csv gic.csv 1e-9

# the twin: the joint as two that were there, friction as a formula, speed from the velocity
awk '/plane: .type: planar/ { print "  square: {type: parallel, bodies: [ground, sled], axis: [0, -0.6, 0.8]}"
        sub(/planar/, "point_in_plane") }
    /type: friction/ { print "  brake: {type: force, coordinate: yaw, value: -0.3 * tanh(rate(yaw) / 0.1)}"; next }
    /corner_speed/ || /type: reaction/ { next } { print }' "$model" >twin.veh
run -q twin.veh "$scene" -o twin.csv
check 'its twin slides' exits 0
awk -F, -v OFS=, '{ NF = 4; print }' twin.csv >twin_corner.csv
awk -F, -v OFS=, '{ NF = 4; print }' walk.csv >walk_corner.csv
check 'and goes the same way' near walk_corner.csv twin_corner.csv 1e-10
check 'speed is the norm of the velocity' awk -F, 'NR == 1 { exit !($5 == "corner_speed [m/s]") }' walk.csv
speed() { awk -F, 'NR > 1 && ($5 - sqrt($2^2 + $3^2 + $4^2))^2 > 1e-24 { bad = 1 } END { exit bad || NR < 100 }' walk.csv; }
check 'at each row' speed

# the target: the same bits as other code, and no single precision
"$build/gicgen" --main "$model" >main.c
for target in '' --double; do
    # shellcheck disable=SC2086  # an option or none
    "$build/gicgen" $target "$model" -o walk.c && "$cc" -I. -I"$root/runtime" -ffp-contract=off main.c walk.c \
        "$root/runtime/gic_runtime.c" -lm -o program && ./program >"said$target" && mv walk.c "code$target.c"
done
check 'the target writes other text' [ -s code--double.c ]
differs() { ! cmp -s code.c code--double.c; }
check 'than without it' differs
check 'of the same results' cmp said said--double
refuses() { ! "$cc" -DGIC_FLOAT -I. -I"$root/runtime" -c code--double.c -o /dev/null 2>err; }
check 'in double precision alone' refuses
check 'and says so' says 'in double precision alone'

# the pages of the walks name what the patches change
named() { for file in $(sed -n 's|^+++ b/||p' "$walks/$1.patch"); do
    grep -qF "${file#generator/}" "$root/generator/README.md" || { echo "$file" >said; return 1; }
done; }
for walk in add_joint add_force add_output add_target; do
    check "generator/README.md names each file that $walk.patch changes" named $walk
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
