#!/bin/sh
# SPDX-License-Identifier: MIT
# test_accelerations.sh GICGEN GICRUN STATES REFERENCE AGREE: accelerations, poses, reactions of all joints and drive
# forces of generated code against the independent reference in quad precision, at ROWS (default 100) random states of
# every model, of a cart with every kind of force law and of the HMMWV with a driven rack, with the equations of motion
# in either form; constraint residuals at the same states. Each form within half of 1e-12 of the reference: so they
# agree with each other to 1e-12.
gicgen=$1
gicrun=$2
states=$3
reference=$4
agree=$5
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0
failed=0

# gicrun's own flags for one form; the other one's long functions compile in a quarter of the time without optimization
echo "exec ${CC:-cc} \"\$@\" -O0" >"$work/cc"

sed "s|parts/|$root/models/parts/|g; s/^model: .*/model: steered/; s/^  rack: *{type: translation,/& driven: true,/" \
    "$root/models/hmmwv.veh" >"$work/steered.veh"

# the largest of the column `constraint`; nothing when a row has none
residual() {
    awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i ~ /^constraint/) column = i; next }
        $column !~ /^[0-9]/ { exit bad = 1 }
        $column > worst { worst = $column }
        END { if (!bad && NR > 1) printf "%.3g\n", worst }' "$work/results"
}

for model in "$root"/models/*.veh "$root/tests/laws/cart.veh" "$work/steered.veh"; do
    if "$gicgen" --dump-model "$model" >"$work/dump" &&
        sh "$root/tests/reactions.sh" "$work/dump" "$(realpath "$model")" >"$work/variant.veh" &&
        "$states" "$work/dump" --count "${ROWS:-100}" --seed 1 -o "$work/states" &&
        "$reference" "$work/dump" "$work/states" -o "$work/accelerations"; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL $(basename "$model")"
        continue
    fi
    for solve in reduced augmented; do
        cc=${CC:-cc}
        [ $solve = reduced ] || cc="sh $work/cc"
        if "$gicrun" --solve $solve --engine cc --cc "$cc" --eval "$work/states" "$work/variant.veh" -o "$work/results" &&
            "$agree" "$work/dump" "$work/accelerations" "$work/results" --reactions --tolerance 5e-13; then
            passed=$((passed + 1))
        else
            failed=$((failed + 1))
            echo "FAIL $(basename "$model") $solve"
            continue
        fi
        worst=$(residual)
        if awk -v x="$worst" 'BEGIN { exit !(x != "" && x >= 0 && x <= 1e-12) }'; then
            passed=$((passed + 1))
        else
            failed=$((failed + 1))
            echo "FAIL $(basename "$model") $solve: constraint residual '$worst'"
        fi
    done
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
