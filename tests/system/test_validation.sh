#!/bin/sh
# SPDX-License-Identifier: MIT
# test_validation.sh GICGEN_PLANTED GICRUN_PLANTED: the validation of what is generated (generator/validate/validate.h) is alive: errors
# that are planted into formulas, and into what blocks store, are each found. Then there is a message and no file.
#
# A store is planted too large by a thousandth and that of its unit. Not asked for are stores that no other block reads:
# inertia[] and motion[] that only a free base or an output would need, torques that a powertrain replaces, and the sum that
# the power balance is relative to.
planted=$1
gicrun=$2
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
models=$root/models
code=$work/code.c

# generate WHAT OPTION... : with that error
generate() {
    rm -f "$code"
    what=$1
    shift
    GICGEN_PLANT=$what "$planted" "$@" -o "$code" >"$work/out" 2>"$work/err"
    status=$?
}

# found WHAT OPTION...: the error ends in the message, and there is no file
found() {
    generate "$@"
    name="$1 of $(echo "$*" | sed 's/.*\///')"
    { exits 1 && says 'error: gicgen found an error of its own: ' && says 'remedy: .*report it' && [ ! -e "$code" ]; }
    verdict $? "$name is found"
}

# sound OPTION...: nothing is planted, and all is well, at so many states
sound() {
    GICGEN_VALIDATION=1 generate '' "$@"
    { exits 0 && [ -s "$code" ] && says 'compared [1-9]'; }
    verdict $? "$* without an error"
}

# all_found FORM SKIPPED OPTION...: each store of the blocks of a form but for those that match SKIPPED
all_found() {
    form=$1
    skipped=$2
    shift 2
    GICGEN_PLANT=list "$planted" "$@" -o "$code" | grep "^$form:[a-z]*:" | sort -u | grep -Ev "$skipped" >"$work/stores"
    [ -s "$work/stores" ]
    verdict $? "$*: stores"
    while read -r store; do
        found "$store" "$@"
    done <"$work/stores"
}

# formulas: a sign in a row, a quadratic-velocity term, a damper that acts on its length, the image of a point that is only
# one of a direction (hinges a unit apart)
for what in row bias force; do
    found "$what" "$models/hmmwv.veh"
    found "$what" --lanes 4 "$models/hmmwv.veh"
done
sound "$models/hmmwv.veh"
found image "$root/tests/data/validation/links.veh"
sound "$root/tests/data/validation/links.veh"
sound --recovery newton "$root/tests/data/validation/carried.veh"

# lanes: always the first one; a number in the packed equations of motion
found lane --lanes 4 "$models/hmmwv.veh"
found 'lanes:dynamics:rate[13]' --lanes 4 "$models/hmmwv.veh"
sound --lanes 4 "$models/hmmwv.veh"

# stores of all blocks; every reaction
all_found all ':inertia|energy.2' "$models/quarter_car.veh"
all_found all ':(solve|poses|outputs):|energy.2' --solve augmented "$models/hmmwv14.veh"
cp -r "$models" "$work/models"
printf 'gicgen: 1\nmodel: tires\ninclude: hmmwv_tires.veh\noutputs: {of_ball: {type: reaction, joint: ball_f_l}}\n' \
    >"$work/models/tires.veh"
for store in 'contact:rate[1]' 'contact:contact[0]' 'contact:grip[25]' 'tire:force[1]' 'balance:rate[0]' 'balance:grip[4]' \
    'link:link[5]' 'torque:torque[1]' 'react:w[0]' 'solve:motion[13]' 'solve:motion[25]' \
    'solve:inertia[4]' 'inverse:tau[3]' 'poses:pose[11]'; do
    found "all:$store" "$work/models/tires.veh"
done
GICGEN_PLANT=list "$planted" "$work/models/tires.veh" -o "$code" | grep wrenches >"$work/wrenches"
found "$(head -n 1 "$work/wrenches")" "$work/models/tires.veh"
found 'all:predict:q[2]' --recovery newton "$models/hmmwv.veh"
found 'all:chord:q[2]' --recovery newton "$models/hmmwv.veh"
found 'all:drive:rate[0]' "$models/hmmwv_vehicle.veh"
found 'all:drive:watch[4]' "$models/hmmwv_vehicle.veh"

# code for a scene: one side taken for both though a law of the other one differs, from some time, spin or length on
mirrored() {
    printf 'gicgen: 1\nmodel: half\ninclude: %s.veh\n%s\n' "$1" "$3" >"$work/models/half.veh"
    found mirror --scene "$2" "$work/models/half.veh"
}
wheel='wheels: {tire_f_r: {body: wheel_f_r, center: centre_f_r, tire: all, spin_inertia: 7.78782, brake: '
scene=$root/tests/data/validation/brake.scene
mirrored hmmwv_vehicle "$scene" "$wheel'4000 * brake * if(time > 1.2, 0, 1)'}}"
mirrored hmmwv_vehicle "$scene" "$wheel'4000 * brake - 300 * max(0, spin - 21)'}}"
bounce=$root/tests/data/narrow/bounce.scene
mirrored hmmwv "$bounce" "forces: {push_r: {type: force, coordinate: spring_f_r, value: 'if(time > 0.1, 20000, 0)'}}"
mirrored hmmwv "$bounce" "forces: {push_r: {type: force, coordinate: spring_f_r, value: '1e5 * max(0, spring_f_r - 0.28)'}}"
for store in 'dynamics:rate[13]' 'outputs:out[0]' 'contact:rate[1]' 'solve:motion[1]' 'inverse:tau[4]'; do
    found "scene:$store" --scene "$scene" "$models/hmmwv_vehicle.veh"
done
sound --scene "$scene" "$models/hmmwv_vehicle.veh"

# who runs what is generated sees it too; engines that share no formula with it run on
for engine in tape tcc 'cc --cc cc'; do
    # shellcheck disable=SC2086  # an engine with its options
    GICGEN_CACHE='' GICGEN_PLANT=force "$gicrun" --engine $engine "$models/hmmwv.veh" "$bounce" -o "$work/table" \
        >"$work/out" 2>"$work/err"
    status=$?
    { exits 1 && says 'error: gicgen found an error of its own: ' && [ ! -e "$work/table" ]; }
    verdict $? "gicrun --engine $engine"
done
GICGEN_PLANT=force "$gicrun" --engine gic "$models/hmmwv.veh" "$bounce" -o "$work/table" >"$work/out" 2>"$work/err"
verdict $? "gicrun --engine gic"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
