#!/bin/sh
# SPDX-License-Identifier: MIT
# classes.sh GICGEN GICRUN STATES REFERENCE_LONG AGREE: mechanisms of each class (tests/data/classes) on a table that turns on
# the ground and on a base that moves, at 10,000 states (short: 100) of each, quarter, half and many turns among them: by
# closed forms, by Newton's iterations and by the augmented form against extended precision, to what FORMAT.md section 14
# promises. No state is refused whose condition is below 100 and whose determinant is above a twentieth of the design's.
gicgen=$1
gicrun=$2
states=$3
reference=$4
agree=$5
count=$([ "$STRESS" = short ] && echo 100 || echo 10000)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
failed=0

# moving NAME: the mechanism of $work/NAME.veh on a base that moves
moving() {
    sed 's/^base: ground/base: car/; s/\[ground, /[car, /; s/^bodies:/&\n  car: {mass: 10, com: [0, 0, -0.5], inertia: [1, 2, 3]}/' "$1"
}

# judge CLASS FILE: a row of the table
judge() {
    "$gicgen" --dump-model "$2" >"$work/dump" && "$states" "$work/dump" --count "$count" --seed 1 --nice -o "$work/states" &&
        "$reference" "$work/dump" "$work/states" --brisk -o "$work/accelerations" 2>"$work/said" || return 1
    tried=0 results=0 worst=0 found=
    for way in "--recovery closed" "--recovery newton" "--solve augmented"; do
        # shellcheck disable=SC2086  # two words
        "$gicrun" --engine tape $way --eval "$work/states" "$2" -o "$work/results" 2>/dev/null || return 1
        "$agree" "$work/dump" "$work/accelerations" "$work/results" --tolerance 2e-12 --condition 100 --regular 100 --floor 0.1 \
            >"$work/agreed" 2>&1
        baseless=$(sed -n 's/.* \([0-9]*\) refused without cause$/\1/p' "$work/agreed")
        wrong=$(sed -n 's/.* passed, \([0-9]*\) failed$/\1/p' "$work/agreed")
        tried=$((tried + count))
        results=$((results + $(awk -F, 'NR > 1 && $1 != ""' "$work/results" | wc -l)))
        worst=$(awk -v worst="$worst" '/ worst / { x = $0; sub(/.* worst /, "", x); if (x + 0 > worst) worst = x + 0 } END { print worst }' "$work/agreed")
        [ "${wrong:-1}" -eq 0 ] && [ "${baseless:-0}" -eq 0 ] ||
            found="$found $way: $(grep -m 1 'FAILED\|refused without\|^row' "$work/agreed" | tr '|' '/')"
    done
    echo "classes | $1 | $tried | $results | $((tried - results)) | $worst of all terms | ${found:-ok}"
    [ -z "$found" ] || failed=1
}
for file in "$(dirname "$0")"/../data/classes/*.veh; do
    name=$(basename "$file" .veh)
    judge "$name" "$file" || failed=1
    moving "$file" >"$work/$name.veh"
    judge "$name, moving base" "$work/$name.veh" || failed=1
done
exit $failed
