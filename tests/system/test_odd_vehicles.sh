#!/bin/sh
# SPDX-License-Identifier: MIT
# test_odd_vehicles.sh GICRUN: three wheels, a trailer by itself and a motorcycle through every study. Numbers of the three-wheeler
# in closed form; where a study has no meaning a message with a remedy, and exit status 1.
gicrun=$1
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
three=$root/tests/data/manoeuvre/three.veh
trailer=$root/tests/data/manoeuvre/trailer.veh
motorcycle=$root/models/motorcycle.veh
sound() { [ "$status" -eq 0 ] && ! grep -qiE '(^|[^a-z])-?(nan|inf)($|[^a-z])' "$work/out"; }

# 545 kg, 2.2 m: statics; wheels that steer alike turn about a point on the line of the one behind
run --sheet "$three" -q -o "$work/three.csv"
check 'the sheet of three wheels' exits 0
statics() { awk -F, '{ v[$1] = $2 } END { m = 500 + 2 * 15 + 15; x = (500 * 0.3 + 2 * 15 * 1.2 - 15) / m; f = (x + 1) / 2.2
    a = v["front.share"] / f - 1; b = v["r.load"] / (m * 9.81 * (1 - f)) - 1; c = v["front.turning_circle"] / (2 * 2.2 / sin(0.5)) - 1
    exit !(a * a < 1e-6 && b * b < 1e-5 && c * c < 1e-20) }' "$work/three.csv"; }
check 'loads of its axles, and its turning circle' statics
for study in '--kc' '--kc --loads' '--kc --joints'; do
    for model in "$three" "$trailer" "$motorcycle"; do
        # shellcheck disable=SC2086 # words
        run $study "$model"
        check "$study of $(basename "$model")" sound
    done
done
run --kc "$three"
check 'one wheel in the middle' prints 'rear, opposite: not possible: it has wheels on one side only'
drives() {
    manoeuvre=$1
    shift
    run --manoeuvre "$manoeuvre" "$three" "$@"
    check "$manoeuvre on three wheels" sound
}
drives step-steer speed=15 ay=2
drives lane-change
drives braking speed=15
drives ride speed=15 duration=20
run --manoeuvre step-steer "$three" speed=15 ay=14
check 'more than it can' exits 1

run --sheet "$motorcycle"
check 'the sheet of a motorcycle' sound
check 'what it can not say' prints 'not there: cornering: no axle is steered'
check 'nor this' prints "not there: top speed: the model has no input 'accelerator'"
steered='steady-speed steady-radius step-steer ramp-steer sine sine-dwell frequency random lane-change lift-off turn-braking j-turn fishhook'
for which in $steered; do
    run --manoeuvre "$which" "$motorcycle" -o "$work/none.csv"
    check "$which of a motorcycle" exits 1
    check "$which of a motorcycle: why" says "can't be steered: no axle is steered by a driven coordinate"
    check "$which of a motorcycle: what helps" says 'remedy: drive the rack'
    check "$which of a motorcycle: no file" [ ! -e "$work/none.csv" ]
done
for which in acceleration elasticity ride ride-speeds; do
    run --manoeuvre $which "$motorcycle"
    check "$which of a motorcycle" exits 1
    check "$which of a motorcycle: why" says "nothing drives the vehicle: .*"
done
for which in braking split-braking; do
    run --manoeuvre $which "$motorcycle"
    check "$which of a motorcycle" exits 1
done

# nothing holds the trailer upright: it lies on its drawbar's end, and no study is of that
fallen='the vehicle does not rest on its wheels: it tips over and lies there'
run --sheet "$trailer" -o "$work/none.csv"
check 'the sheet of what does not stand' exits 1
check 'the sheet of what does not stand: why' says "$fallen"
check 'the sheet of what does not stand: no file' [ ! -e "$work/none.csv" ]
for which in $steered acceleration elasticity ride ride-speeds braking split-braking coast-down four-post; do
    run --manoeuvre "$which" "$trailer" -o "$work/none.csv"
    check "$which of what does not stand" exits 1
    check "$which of what does not stand: why" says "$fallen"
    check "$which of what does not stand: what helps" says 'remedy: bring the centre of mass between the wheels'
    check "$which of what does not stand: no file" [ ! -e "$work/none.csv" ]
done
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -ge 145 ]
