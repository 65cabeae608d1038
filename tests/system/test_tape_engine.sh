#!/bin/sh
# SPDX-License-Identifier: MIT
# test_tape_engine.sh GICGEN GICRUN STATES RANDOM_VEHICLE: the engine `tape` against compiled code, byte by byte: both
# do the same operations, so that every digit of results, statuses and messages must agree. At ROWS (default 30) random
# states of every model and of random vehicles, some of them out of reach, and over runs of scenes. Neither does it take
# a compiler nor does it matter how that optimizes.
gicgen=$1
gicrun=$2
states=$3
random_vehicle=$4
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

# compiles in a quarter of the time
echo "exec ${CC:-cc} \"\$@\" -O0" >"$work/cc"

# without PATH nothing can be started
tape() {
    env -i PATH=/nonexistent "$gicrun" --engine tape "$@"
}

# every seventh row: a coordinate far from where it can be, or a number that is none of the state's
spoil() {
    awk -F, -v OFS=, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == "e0") parameter = i; print; next }
        NR % 7 == 0 && NR % 2 { $(parameter ? NF / 2 : 1) *= 40 }
        NR % 7 == 0 && NR % 2 == 0 { $(parameter ? parameter : NF) = parameter ? 3 : "1e308" }
        { print }' "$1"
}

# tuned MODEL FILE: the states in FILE with values of MODEL's tunable parameters from between the two numbers behind some,
# in every fifth row a negative one, which some refuse
tuned() {
    awk -F '[ ,:]+' 'NR == FNR {
            if (/tunable: true[}] # [-0-9.]+ [-0-9.]+$/) {
                low[++count] = $(NF - 1)
                high[count] = $NF
                sub(/^ */, "")
                name[count] = $1
            }
            next
        }
        FNR == 1 { srand(9); for (i = 1; i <= count; ++i) $0 = $0 "," name[i]; print; next }
        { for (i = 1; i <= count; ++i) {
              value = low[i] + rand() * (high[i] - low[i])
              $0 = $0 "," (FNR % 5 == 0 && i == 1 + FNR / 5 % count ? -value : value)
          }
          print }' "$1" "$2"
}

# same_states MODEL LABEL [OPTION...]
same_states() {
    rm -f "$work/compiled" "$work/played"
    model=$1
    label=$2
    shift 2
    "$gicgen" --dump-model "$model" >"$work/dump" 2>"$work/said" &&
        "$states" "$work/dump" --count "${ROWS:-30}" --seed 5 2>"$work/said" >"$work/plain" &&
        spoil "$work/plain" >"$work/spoilt" && tuned "$model" "$work/spoilt" >"$work/states" &&
        "$gicrun" "$@" --engine cc --cc "sh $work/cc" --eval "$work/states" "$model" -o "$work/compiled" \
            2>"$work/said.compiled" &&
        tape "$@" --eval "$work/states" "$model" -o "$work/played" 2>"$work/said.played" &&
        cmp "$work/said.compiled" "$work/said.played" >"$work/said" &&
        diff "$work/compiled" "$work/played" >"$work/said"
    verdict $? "states of $label"
    grep -q ',0,"ok"' "$work/played" && grep -q ',-[0-9]*,"[^"]*"' "$work/played"
    verdict $? "states of $label, of either kind"
}

# same_run MODEL SCENE LABEL: results and summary, but for the time it took
same_run() {
    "$gicrun" --general --engine cc "$1" "$2" -o "$work/run" 2>"$work/said.compiled" && mv "$work/run" "$work/compiled" &&
        tape "$1" "$2" -o "$work/run" 2>"$work/said.played" &&
        sed -i '/CPU time/d' "$work/said.compiled" "$work/said.played" &&
        diff "$work/said.compiled" "$work/said.played" >"$work/said" &&
        cmp "$work/compiled" "$work/run" >"$work/said"
    verdict $? "run of $3"
}

sed "s|parts/|$root/models/parts/|g; s/^model: .*/model: steered/; s/^  rack: *{type: translation,/& driven: true,/" \
    "$root/models/hmmwv.veh" >"$work/steered.veh"
for model in "$root"/models/*.veh "$work/steered.veh" "$root"/tests/data/laws/*.veh \
    "$root"/tests/data/tuning/car.veh "$root"/tests/data/tuning/rig.veh; do
    same_states "$model" "$(basename "$model")"
done
for name in hmmwv14 quarter_car; do # with reaction forces of all joints
    "$gicgen" --dump-model "$root/models/$name.veh" >"$work/dump" &&
        sh "$root/tests/lib/reactions.sh" "$work/dump" "$root/models/$name.veh" >"$work/reactions.veh"
    same_states "$work/reactions.veh" "$name with reactions"
    same_states "$work/reactions.veh" "$name with reactions, augmented form" --solve augmented
done
for seed in 3 8 21; do
    "$random_vehicle" --seed $seed >"$work/random.veh"
    same_states "$work/random.veh" "random_vehicle --seed $seed"
done

cp "$root/models/scenes/paper_run.scene" "$work/hmmwv.scene"
for scene in hmmwv solid_axle andrews; do
    [ -f "$work/$scene.scene" ] || cp "$root/models/scenes/$scene.scene" "$work"
    same_run "$root/models/$scene.veh" "$work/$scene.scene" $scene
done
# the steering driven by an input, RK4, the parameter that is dependent changing on the way
cat >"$work/steered.scene" <<'END'
gicscene: 1
duration: 2
step: 0.004
integrator: rk4
output_step: 0.1
initial: {position: [0, 0, 0.474], velocity: [8, 0, 0], angular_velocity: [0, 0, 2]}
inputs: {rack: {knots: {times: [0.2, 1], values: [0, 0.03]}}}
road: {type: sine, amplitude: 0.02, wavelength: 3}
END
same_run "$work/steered.veh" "$work/steered.scene" "steered"
grep -q 'parameter switches *[1-9]' "$work/said.played"
verdict $? "the dependent parameter changes"

# wheels with tires: rolling, steering, locking up on patches of ice, in one rate and in two
for ratio in 1 4; do
    cat >"$work/tires.scene" <<END
gicscene: 1
duration: 3
step: 0.002
ratio: $ratio
integrator: ab3
output_step: 0.02
initial: {position: [0, 0, 0.485], velocity: [14, 0, 0]}
inputs: {rack: {knots: {times: [0.2, 1], values: [0, 0.01]}}, brake: {knots: {times: [1, 1.2], values: [0, 0.8]}}}
road:
  {type: sine, amplitude: 0.02, wavelength: 5,
   friction: {value: 0.9, patches: [{x: [15, 30], y: [-9, 0], value: 0.2}]}}
END
    for tire in tires tmeasy; do
        same_run "$root/models/hmmwv_$tire.veh" "$work/tires.scene" "hmmwv_$tire, ratio $ratio"
    done
done

# a failure on the way is the same one at the same time
sed 's/^duration.*/duration: 2/; s/^step:.*/step: 0.02/; s/^output_step:.*/output_step: 0.02/
    s/height: 0.06/height: 3/' \
    "$root/models/scenes/paper_run.scene" >"$work/hmmwv.scene"
"$gicrun" --general --engine cc --cc "sh $work/cc" -q "$root/models/hmmwv.veh" "$work/hmmwv.scene" -o "$work/compiled" \
    2>"$work/said.compiled"
compiled=$?
tape -q "$root/models/hmmwv.veh" "$work/hmmwv.scene" -o "$work/played" 2>"$work/said.played"
[ $? -eq 1 ] && [ $compiled -eq 1 ] && cmp "$work/compiled" "$work/played" &&
    cmp "$work/said.compiled" "$work/said.played"
verdict $? "a run that fails"

"$gicrun" --engine taep "$root/models/hmmwv.veh" "$work/hmmwv.scene" 2>"$work/said"
[ $? -eq 2 ] && grep -q 'tape' "$work/said"
verdict $? "an engine that there is not"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
