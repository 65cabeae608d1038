#!/bin/sh
# SPDX-License-Identifier: MIT
# test_gradient.sh GICRUN: gradients of runs, `gicrun --gradient` (tests/vehicle/gradient.py); what it says and refuses.
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
models=$root/models
/usr/bin/python3 -B "$root/tests/vehicle/gradient.py" "$gicrun" "$models" "$work" >"$work/said" 2>&1
verdict $? "gradients"
tail -n 1 "$work/said"

car=$models/hmmwv.veh
printf 'gicscene: 1\nduration: 0.1\nstep: 0.005\ninitial: {speed: 5}\n' >"$work/short.scene"
run --gradient 'chassis.x' "$car" "$work/short.scene"
check 'a table' prints '^initial/x.rate .* m/s '
check 'the value' prints '^hmmwv: chassis.x = 0.[45]'
run --gradient 'chassis.x' "$car" "$work/short.scene" -o "$work/a.csv"
run --gradient 'chassis.x' "$car" "$work/short.scene" -o "$work/b.csv"
check 'the same bytes again' cmp "$work/a.csv" "$work/b.csv"
check 'columns' grep -qx 'variable,value,unit,derivative' "$work/a.csv"

# ---- what is refused
rm -f "$work"/no.*
ends() { exits "$1" && says "$2" && [ ! -e "$work/no.csv" ]; }
mistake() { # STATUS TEXT WORD...: said, and no file is left
    wanted=$1
    text=$2
    shift 2
    run "$@" -o "$work/no.csv"
    check "$text" ends "$wanted" "$text"
}
scene() { # LINES
    printf 'gicscene: 1\nduration: 1\n%b\n' "$1" >"$work/bad.scene"
}
tires=$models/hmmwv_tires.veh
complete=$models/hmmwv_vehicle.veh
scene 'integrator: rkck\noutput_step: 0.1'
mistake 1 'a run in which steps vary' --gradient chassis.x "$car" "$work/bad.scene"
scene 'step: 0.005\nratio: 5'
mistake 1 'fast states take steps of their own' --gradient chassis.x "$tires" "$work/bad.scene"
scene 'step: 0.005\nuntil: time > 0.5'
mistake 1 'conditions change the run' --gradient chassis.x "$car" "$work/bad.scene"
scene 'step: 0.005\nsleep: {}'
mistake 1 'the vehicle may sleep' --gradient chassis.x "$car" "$work/bad.scene"
scene 'step: 0.005\nlocate: true'
mistake 1 'steps end where contacts' --gradient chassis.x "$car" "$work/bad.scene"
scene 'step: 0.001\ninitial: {speed: 10, gear: 1}'
mistake 1 'a gear changes at t = ' --gradient chassis.x "$complete" "$work/bad.scene"
sed 's/duration: 40/duration: 1/; s/ratio: 6/ratio: 1/' "$models/scenes/steady_circle.scene" >"$work/bad.scene"
mistake 1 'a driver drives' --gradient chassis.x "$complete" "$work/bad.scene"
scene 'step: 0.001'
mistake 1 "controllers hold what they sampled" --gradient chassis.x "$models/formula_student.veh" "$work/bad.scene"
mistake 1 "chassis.w" --gradient 'chassis.w' "$car" "$work/short.scene"
mistake 1 'gradient' --gradient 'chassis.x +' "$car" "$work/short.scene"
mistake 2 "there is no 'parameter/none'" --gradient chassis.x "$car" "$work/short.scene" parameter/none
mistake 2 'no scene given' --gradient chassis.x "$car"
mistake 2 'does not go with --engine' --engine cc --gradient chassis.x "$car" "$work/short.scene"
mistake 2 'one of --eval' --modes --gradient chassis.x "$car" "$work/short.scene"
mistake 1 'the run with its derivatives ends at t = 0 s' --gradient 'integral(sqrt(abs(rate(rack))))' "$car" "$work/short.scene"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
