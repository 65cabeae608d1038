#!/bin/sh
# SPDX-License-Identifier: MIT
# test_models.sh GICGEN GICRUN: what models and scenes claim: sequences derived by hand, the pendulum's published
# positions, orders of the integrators, energy, rest at the design configuration, accuracy at the scenes' steps, cost
# that grows with the number of bodies and no faster.
gicgen=$1
gicrun=$2
root=$(dirname "$0")/../..
models=$root/models
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

# scene LINES...: writes $work/scene
scene() {
    printf '%s\n' "gicscene: 1" "$@" >"$work/scene"
}

# run MODEL [SCENE]: simulates, $work/csv holds the results
run() {
    rm -f "$work/csv"
    "$gicrun" --quiet "$models/$1.veh" "${2:-$work/scene}" -o "$work/csv"
    verdict $? "$1 does not run"
}

# at TIME COLUMN: a value of $work/csv; TIME may be `end`
at() {
    [ -f "$work/csv" ] || return 0
    awk -F, -v time="$1" -v name="$2" '
        NR == 1 { for (i = 1; i <= NF; ++i) { split($i, word, " "); if (word[1] == name) column = i } next }
        time == "end" || ($1 - time)^2 < 1e-18 { value = $column }
        END { if (!column || value == "") { print "no " name " at " time; exit } printf "%.17g\n", value }' "$work/csv"
}

# near VALUE EXPECTED TOLERANCE LABEL
near() {
    awk -v x="$1" -v y="$2" -v t="$3" 'BEGIN { exit !(x ~ /^-?[0-9]/ && (x - y)^2 <= t * t) }'
    verdict $? "$4: $1 instead of $2 (+- $3)"
}

# ---- sequences, against tests/data/expected/MODEL.txt -------------------------------------------------------------
# Each of these says how it was derived: a set of bodies is a subset when the equations of joints and dual coordinates
# among them and to known bodies are 6 a body, and those of no smaller set are. Then come totals and a line a subset,
# `STAGE: bodies <- joints and coordinates`, names and lines in alphabetical order.

# subsets: what gicgen --sequence printed, in that form
subsets() {
    awk '
        function sorted(list, n, i, k, word, text) {
            n = split(list, word, " ")
            for (i = 2; i <= n; ++i)
                for (k = i; k > 1 && word[k - 1] > word[k]; --k) {
                    text = word[k]
                    word[k] = word[k - 1]
                    word[k - 1] = text
                }
            text = ""
            for (i = 1; i <= n; ++i)
                text = text (i > 1 ? " " : "") word[i]
            return text
        }
        function finish() {
            if (bodies)
                print stage ": " sorted(bodies) " <-" (equations ? " " sorted(equations) : "")
            bodies = equations = kind = ""
        }
        function add() {
            gsub(/\([^)]*\)|,/, " ")
            if (kind == "bodies")
                bodies = bodies " " $0
            else if (kind == "joints" || kind == "coordinates")
                equations = equations " " $0
        }
        /^stage/ || /^ *[0-9]+  [0-9]+ x/ || /^classes/ { finish() }
        /^stage/ { stage = $2 }
        /^ +(bodies|joints|coordinates|known before) / { kind = $1; sub(/^ +[a-z]+/, ""); add(); next }
        /^ / && kind { add() }
        END { finish() }' "$1" | LC_ALL=C sort
}

for file in "$models"/*.veh; do
    name=$(basename "$file" .veh)
    "$gicgen" --sequence "$file" >"$work/sequence"
    verdict $? "$name has no sequence"
    grep -v '^#' "$root/tests/data/expected/$name.txt" >"$work/expected"
    verdict $? "no expected sequence for $name"
    {
        sed -n 's/^\([0-9]* coordinates, [0-9]* equations\) .*), /total: \1, /p' "$work/sequence"
        subsets "$work/sequence"
    } | diff "$work/expected" - >"$work/difference"
    verdict $? "sequence of $name: $(cat "$work/difference")"
done

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
    verdict $? "energy of the pendulum with $1: $lost J at step $3, $energy J at step $4"
}

order ab3 3 0.001 0.0005
order rk4 4 0.01 0.005

# ---- rest --------------------------------------------------------------------------------------------------

run quarter_car "$models/scenes/quarter_car.scene"
# carried mass, arm and wheel assembly
near "$(at end tire.fz)" "$(awk 'BEGIN { print 9.81 * (525.59 + 23.965 + 90.555) }')" 1 "load on the rig's tire"
near "$(at end bounce.value)" 0 1e-4 "rest of the quarter car"

# rest MODEL HEIGHT PITCH COORDINATE MASS: at this pose of the chassis, coordinates at their design values, springs and
# tires balance the weight of MASS kg, so that nothing moves: to 10 N and 0.01 mm, which is what the rounding of pitch
# and free lengths leaves.
rest() {
    scene "duration: 2" "step: 0.005" "output_step: 0.1" "initial: {position: [0, 0, $2], orientation: {pitch: $3}}"
    run "$1"
    load=$(for wheel in f_l f_r r_l r_r; do at 0 tire_$wheel.fz; done | awk '{ sum += $1 } END { printf "%.9g\n", sum }')
    near "$load" "$(awk -v mass="$5" 'BEGIN { print 9.81 * mass }')" 10 "load on the tires of $1"
    value=$(at 0 "$4.value")
    for time in 0 1 2; do
        near "$(at $time chassis.z)" "$2" 1e-5 "height of the resting chassis at $time s, $1"
        near "$(at $time chassis_attitude.pitch)" "$3" 1e-5 "pitch of the resting chassis at $time s, $1"
        near "$(at $time "$4.value")" "$value" 1e-5 "$4 at rest at $time s, $1"
    done
}

# masses: chassis and rack, then arms, wheel assemblies, axle
rest hmmwv 0.4740625 0.0004326 spring_f_l "$(awk 'BEGIN { print 2095.592 + 4 * (23.965 + 90.555) }')"
near "$(at 0 spring_f_l.value)" 0.246463 1e-6 "front spring at its design length"
rest hmmwv_full 0.5807093 0.0030043 spring_r_l "$(awk 'BEGIN { print 2095.592 + 4 * (23.965 + 90.555) }')"
# 6.591 mm into the rebound stop, by the data's table
near "$(at 2 stop_r_l)" -659.1 0.5 "rebound stop at rest"
rest hmmwv14 0.473856 0.0004314 spring_r_l "$(awk 'BEGIN { print 2095.592 + 4 * (23.965 + 5.813 + 90.555) }')"
rest five_link 0.474472 0.0006879 spring_r_l "$(awk 'BEGIN { print 2095.592 + 2 * 23.965 + 4 * 90.555 }')"
rest solid_axle 0.473694 0.0002147 spring_r_l "$(awk 'BEGIN { print 2095.592 + 2 * (23.965 + 90.555) + 271.11 }')"
rest trailing_arm 0.474126 0.0005099 bar_r_l "$(awk 'BEGIN { print 2095.592 + 2 * (23.965 + 90.555 + 110.555) }')"

# ---- the paper's run at the largest step, against RK4 at a tenth of it ------------------------------------------

for how in "ab3 0.01" "rk4 0.001"; do
    sed "s/^step:.*/step: ${how#* }/; s/^integrator:.*/integrator: ${how% *}/" "$models/scenes/paper_run.scene" \
        >"$work/scene"
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

# ---- scenes of the other vehicles: AB3 at their step against RK4 at a tenth of it -----------------------------------

for name in hmmwv_full hmmwv14 five_link solid_axle trailing_arm; do
    file=$models/scenes/$name.scene
    run $name "$file"
    for column in chassis.z wheel_f_l.z wheel_r_l.z; do at end $column; done >"$work/coarse"
    sed 's/^step:.*/step: 0.0005/; s/^integrator:.*/integrator: rk4/' "$file" >"$work/scene"
    run $name
    for column in chassis.z wheel_f_l.z wheel_r_l.z; do
        near "$(sed -n 1p "$work/coarse")" "$(at end $column)" 2e-4 "$column at the end of $name.scene, AB3 at its step"
        sed -i 1d "$work/coarse"
    done
done

# ---- the stops of the real springs, as the wheels hang in them: they follow the data's table and never pull ----------

run hmmwv_full "$models/scenes/hmmwv_full.scene"
awk -F, '
    NR == 1 { for (i = 1; i <= NF; ++i) { split($i, word, " "); column[word[1]] = i }; next }
    {
        for (i = 0; i < 2; ++i) {
            side = i ? "r_l" : "f_l"
            value = $column["spring_" side ".value"]
            depth = 1000 * (value - (i ? 0.35 : 0.30)) # mm
            rubber = depth < 0 ? 0 : depth < 10 ? 100 * depth : depth < 20 ? 150 * depth - 500 : 200 * depth - 1500
            force = $column["stop_" side]
            if ((force + rubber)^2 > 1e-12 || force > 0) bad = bad " " side " " force " N at " depth " mm"
            if (depth > most[i]) most[i] = depth
        }
    }
    # 30 mm would need 4500 N
    END {
        for (i = 0; i < 2; ++i)
            if (!(most[i] > 20 && most[i] < 30)) bad = bad " deepest " most[i]
        if (bad) { print bad; exit 1 }
    }' "$work/csv" >"$work/said"
verdict $? "stops: $(head -c 300 "$work/said")"

# ---- cost grows with the number of bodies, not faster ------------------------------------------------------------

# operations BODIES: of one right-hand side per body, as the generated header states them
operations() {
    sh "$root/tests/lib/axle_chain.sh" "$1" >"$work/chain.veh" && "$gicgen" "$work/chain.veh" -o "$work/chain.c" &&
        awk -v n="$1" '/all together/ { print ($4 + $5 + $6 + $7 + $8) / n }' "$work/chain.h"
}

few=$(operations 10)
for bodies in 20 40 60; do
    near "$(operations $bodies)" "$few" "$(awk -v few="$few" 'BEGIN { print 0.2 * few }')" \
        "operations per body, $bodies bodies against 10"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
