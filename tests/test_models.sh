#!/bin/sh
# SPDX-License-Identifier: MIT
# test_models.sh GICGEN GICRUN: what models and scenes claim: sequence and counts of the paper, the pendulum's published
# positions, orders of the integrators, energy, rest at the design configuration, stability at 10 ms.
gicgen=$1
gicrun=$2
root=$(dirname "$0")/..
models=$root/models
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

# scene LINES...: writes $work/scene
scene() {
    printf '%s\n' "gicscene: 1" "$@" >"$work/scene"
}

# run MODEL [SCENE]: simulates, $work/csv holds the results
run() {
    "$gicrun" --quiet "$models/$1.veh" "${2:-$work/scene}" -o "$work/csv"
    check $? "$1 does not run"
}

# at TIME COLUMN: a value of $work/csv; TIME may be `end`
at() {
    awk -F, -v time="$1" -v name="$2" '
        NR == 1 { for (i = 1; i <= NF; ++i) { split($i, word, " "); if (word[1] == name) column = i } next }
        time == "end" || ($1 - time)^2 < 1e-18 { value = $column }
        END { if (!column || value == "") { print "no " name " at " time; exit } printf "%.17g\n", value }' "$work/csv"
}

# near VALUE EXPECTED TOLERANCE LABEL
near() {
    awk -v x="$1" -v y="$2" -v t="$3" 'BEGIN { exit !(x ~ /^-?[0-9]/ && (x - y)^2 <= t * t) }'
    check $? "$4: $1 instead of $2 (+- $3)"
}

# ---- the sequence of the paper ----------------------------------------------------------------------------

"$gicgen" --sequence "$models/hmmwv.veh" >"$work/sequence"
check $? "no sequence"
for claim in '10 bodies, 15 joints, 5 dual coordinates' '70 coordinates, 59 equations' '11 degrees of freedom' \
    '10 subsets in 3 stages'; do
    grep -q "$claim" "$work/sequence"
    check $? "the HMMWV's sequence does not say '$claim'"
done
# stage 1: chassis; stage 2: rack and four arms; stage 3: four wheel assemblies
awk '/^stage/ { stage = $2 } $1 == "bodies" { $1 = ""; print stage $0 }' "$work/sequence" | sort >"$work/stages"
printf '%s\n' '1 chassis' '2 lca_f_l' '2 lca_f_r' '2 lca_r_l' '2 lca_r_r' '2 rack' '3 wheel_f_l' '3 wheel_f_r' \
    '3 wheel_r_l' '3 wheel_r_r' | cmp -s - "$work/stages"
check $? "the HMMWV's stages are $(tr '\n' ';' <"$work/stages")"

# ---- the pendulum's published positions (IFToMM benchmark A01) ---------------------------------------------

run pendulum "$models/scenes/pendulum.scene"
near "$(at 2 bob.x)" -0.793566195343 1e-9 "pendulum x at 2 s"
near "$(at 2 bob.z)" -0.608483930444 1e-9 "pendulum y at 2 s"
near "$(at 10 bob.x)" -0.275087462576 1e-9 "pendulum x at 10 s"
near "$(at 10 bob.z)" -0.961419205099 1e-9 "pendulum y at 10 s"

# distance METHOD STEP: error of the bob's position at 2 s, and energy gained by 2 s, into $error and $energy
distance() {
    scene "duration: 2" "step: $2" "integrator: $1"
    run pendulum
    error=$(awk -v x="$(at 2 bob.x)" -v y="$(at 2 bob.z)" \
        'BEGIN { print sqrt((x + 0.793566195343)^2 + (y + 0.608483930444)^2) }')
    energy=$(awk -v k="$(at 2 energy.kinetic)" -v p="$(at 2 energy.potential)" 'BEGIN { print sqrt((k + p)^2) }')
}

# order METHOD EXPECTED COARSE FINE: observed order between two steps, from positions; energy keeps at least that order
order() {
    distance "$1" "$3"
    coarse=$error
    lost=$energy
    distance "$1" "$4"
    near "$(awk -v a="$coarse" -v b="$error" -v h="$3" -v k="$4" 'BEGIN { print log(a / b) / log(h / k) }')" "$2" 0.1 \
        "observed order of $1"
    awk -v a="$lost" -v b="$energy" -v h="$3" -v k="$4" -v n="$2" 'BEGIN { exit !(log(a / b) / log(h / k) > n - 0.1) }'
    check $? "energy of the pendulum with $1: $lost J at step $3, $energy J at step $4"
}

order ab3 3 0.001 0.0005
order rk4 4 0.01 0.005

# ---- rest --------------------------------------------------------------------------------------------------

run quarter_car "$models/scenes/quarter_car.scene"
# carried mass, arm and wheel assembly
near "$(at end tire.fz)" "$(awk 'BEGIN { print 9.81 * (525.59 + 23.965 + 90.555) }')" 1 "load on the rig's tire"
near "$(at end bounce.value)" 0 1e-4 "rest of the quarter car"

scene "duration: 2" "step: 0.005" "output_step: 0.1" \
    "initial: {position: [0, 0, 0.4740625], orientation: {pitch: 0.0004326}}"
run hmmwv
load=$(for wheel in f_l f_r r_l r_r; do at 0 tire_$wheel.fz; done | awk '{ sum += $1 } END { printf "%.9g\n", sum }')
near "$load" "$(awk 'BEGIN { print 9.81 * (2086.52 + 9.072 + 4 * (23.965 + 90.555)) }')" 10 "load on the HMMWV's tires"
for time in 0 1 2; do
    near "$(at $time chassis.z)" 0.4740625 1e-5 "height of the resting chassis at $time s"
    near "$(at $time chassis_attitude.pitch)" 0.0004326 1e-5 "pitch of the resting chassis at $time s"
    near "$(at $time spring_f_l.value)" 0.246463 1e-5 "spring of the resting HMMWV at $time s"
done

# ---- the paper's run at the largest step, against RK4 at a tenth of it ------------------------------------------

for how in "ab3 0.01" "rk4 0.001"; do
    sed "s/^step:.*/step: ${how#* }/; s/^integrator:.*/integrator: ${how% *}/" "$models/scenes/paper_run.scene" >"$work/scene"
    run hmmwv
    cp "$work/csv" "$work/${how% *}.csv"
done
for name in chassis.z wheel_r_l.z wheel_f_l.z; do
    for time in 1 2 3 4; do
        cp "$work/rk4.csv" "$work/csv"
        value=$(at $time $name)
        cp "$work/ab3.csv" "$work/csv"
        near "$(at $time $name)" "$value" 1e-3 "$name at $time s, AB3 at 10 ms against RK4 at 1 ms"
    done
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
