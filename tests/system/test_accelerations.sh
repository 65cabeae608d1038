#!/bin/sh
# SPDX-License-Identifier: MIT
# test_accelerations.sh GICGEN GICRUN STATES REFERENCE AGREE REFERENCE_LONG: accelerations, poses, reactions of all joints, drive
# forces, all that wheels tell, rates of fast states, energies and power of generated code against the independent
# reference in quad precision, at ROWS (default 12; four times that with tires) random states of every model, of a cart
# with every kind of force law and of the HMMWV with a driven rack, with the equations of motion in either form; constraint
# residuals at the same states; the reduced form also with alike parts side by side in lanes. Each form within half of
# 1e-12 of the reference: so they agree with each other to 1e-12.
# With tires within 2e-12, for tires are stiff: at some states they make 1e-12 of the last digit of a pose, whichever way
# that is found; of vehicles longer than 10 m within 4e-12, for places of their ends have larger last digits (2.2e-12 seen in
# the steering of the semitrailer, at one of 400 states). Once more on waves with a patch of little friction, where 100 m from
# the origin heights of a road whose slope reaches 0.1 are known to 1e-15 m; there also with wheels side by side in lanes.
# The reference takes seven times as long in quad precision as in extended precision (64 bits): quad judges a quarter of the
# states, extended all of them, those included.
gicgen=$1
gicrun=$2
states=$3
reference=$4
agree=$5
reference_long=$6
root=$(cd "$(dirname "$0")/../.." && pwd)
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

cat >"$work/waves.scene" <<END
gicscene: 1
duration: 1
step: 0.1
road:
  {type: sine, amplitude: 0.05, wavelength: 3, start: 0.4, phase_per_y: 0.7,
   friction: {patches: [{x: [-50, 40], y: [-60, 70], value: 0.3, fade: 30}]}}
END

# refer OPTION...: what the reference says at all states, and in quad precision at the first quarter of them
refer() {
    head -n $((rows / 4 + 2)) "$work/states" >"$work/quad.states" &&
        "$reference_long" "$work/dump" "$work/states" -o "$work/accelerations" "$@" &&
        "$reference" "$work/dump" "$work/quad.states" -o "$work/quad.accelerations" "$@"
}
# agrees: do results with what it said?
agrees() {
    head -n $((rows / 4 + 2)) "$work/results" >"$work/quad.results" &&
        "$agree" "$work/dump" "$work/quad.accelerations" "$work/quad.results" --reactions --wheels --tolerance "$tolerance" &&
        "$agree" "$work/dump" "$work/accelerations" "$work/results" --reactions --wheels --tolerance "$tolerance"
}

# the tolerance of a vehicle with tires, by the distance in x of its bodies
with_tires() {
    /usr/bin/python3 -c 'import json, sys
x = [body["position"][0] for body in json.load(open(sys.argv[1]))["bodies"]]
print("2e-12" if max(x) - min(x) < 10 else "4e-12")' "$work/dump"
}

for model in "$root"/models/*.veh "$root"/tests/data/laws/*.veh "$work/steered.veh"; do
    rows=${ROWS:-12}
    tires=false
    tolerance=5e-13
    if "$gicgen" --dump-model "$model" >"$work/dump" &&
        { ! grep -q '"tire": [0-9]' "$work/dump" || { tires=true && tolerance=$(with_tires) && rows=$((4 * rows)); }; } &&
        { sh "$root/tests/lib/reactions.sh" "$work/dump" "$(realpath "$model")" &&
            sh "$root/tests/lib/wheels.sh" "$work/dump"; } >"$work/variant.veh" &&
        "$states" "$work/dump" --count "$rows" --seed 1 -o "$work/states" &&
        refer; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL $(basename "$model")"
        continue
    fi
    for solve in reduced augmented 'reduced --lanes 4' 'reduced --lanes 2 --recovery newton'; do
        cc=${CC:-cc}
        [ "$solve" = reduced ] || cc="sh $work/cc"
        # shellcheck disable=SC2086  # a list of words
        if "$gicrun" --solve $solve --engine cc --cc "$cc" --eval "$work/states" "$work/variant.veh" -o "$work/results" &&
            agrees; then
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
    $tires || continue
    if refer --road sine:0.05,3,0.4,0.7 --friction -50,40,-60,70,0.3,30 &&
        "$gicrun" --engine cc --cc "sh $work/cc" --eval "$work/states" "$work/variant.veh" "$work/waves.scene" \
            -o "$work/results" && agrees; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        echo "FAIL $(basename "$model") on waves"
    fi
    # wheels side by side: the same tolerance
    for lanes in "2 --cc 'sh $work/cc'" '4 --cflags -march=native\ -ffp-contract=fast'; do
        if eval "'$gicrun'" --engine cc --lanes "$lanes" --eval '"$work/states" "$work/variant.veh" "$work/waves.scene"' \
            -o '"$work/results"' && agrees; then
            passed=$((passed + 1))
        else
            failed=$((failed + 1))
            echo "FAIL $(basename "$model") with --lanes $lanes"
        fi
    done
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
