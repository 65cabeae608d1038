#!/bin/sh
# SPDX-License-Identifier: MIT
# test_controllers.sh GICGEN GICRUN: sampled controllers (FORMAT.md section 7.4). A mass under discrete control against its
# motion in closed form from event to event (tests/controllers/exact.py): periods equal to the step, twice, half of it and
# no multiple, longer than the run, offsets, delays of none, part of a period, one, several, rounding, two controllers at
# one instant or not; all integrators, engines, one rate and two; with a spring, orders of RK4 and AB3 across samples.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1
within() { awk "BEGIN { exit !($1 <= $2) }"; }

# loop SETTING=VALUE...: loop.veh with these; the others as exact.py has them
loop() {
    period=0.1 offset=0 delay=0 quantum= mean=0.1 mean_offset=0 spring=0 start=0
    for setting; do
        eval "${setting%%=*}=${setting#*=}"
    done
    [ -z "$quantum" ] || quantum=", quantum: $quantum"
    sed "s/@period@/$period/; s/@offset@/$offset/; s/@delay@/$delay/; s/@quantum@/$quantum/; s/@mean@/$mean/
        s/@mean_offset@/$mean_offset/; s/@spring@/$spring/; s/@start@/$start/" "$root/tests/controllers/loop.veh.in" >loop.veh
}
# scene STEP OUTPUT_STEP DURATION LINE...
scene() {
    printf 'gicscene: 1\nstep: %s\noutput_step: %s\nduration: %s\n' "$1" "$2" "$3" >a.scene
    shift 3
    printf '%s\n' "$@" >>a.scene
}
# off SETTING=VALUE...: largest deviation of out.csv
off() { /usr/bin/python3 -B "$root/tests/controllers/exact.py" out.csv "$@"; }
# run LIMIT NAME OPTIONS -- SETTING=VALUE...: the scene with these
run() {
    limit=$1 name=$2 options=$3
    shift 4
    loop "$@"
    rm -f out.csv
    # shellcheck disable=SC2086  # options
    "$gicrun" -q $options loop.veh a.scene -o out.csv 2>err
    found=$(off "$@" 2>&1)
    check "$name, $options $*: ${found:-no run}" within "${found:-1}" "$limit"
}

# ---- the closed form, at any step: RK4, AB3 and two rates are exact on parabolas
for method in 'integrator: rk4' 'integrator: ab3' 'ratio: 4'; do
    scene 0.1 0.1 2 "$method"
    run 1e-12 "period = step, $method" '' --
    run 1e-12 "period of two steps, $method" '' -- period=0.2
    run 1e-12 "period of half a step, $method" '' -- period=0.05 mean=0.025
    run 1e-12 "period longer than the run, $method" '' -- period=3 mean=100
    scene 0.006 0.06 2.4 "$method"
    run 1e-12 "period 1/7 s, $method" '' -- period=0.14285714285714285
    run 1e-12 "both, apart, $method" '' -- period=0.14285714285714285 mean=0.0909090909 offset=0.05 mean_offset=0.003
    run 1e-12 "delay of part of a period, $method" '' -- period=0.09 delay=0.02
    run 1e-12 "delay of a period, $method" '' -- period=0.09 delay=0.09
    run 1e-12 "delay of 2.5 periods, $method" '' -- period=0.0625 delay=0.15625
    run 1e-12 "delay of 3 periods, $method" '' -- period=0.1 delay=0.3
    run 1e-12 "rounded, $method" '' -- period=0.03 quantum=0.5
    run 1e-12 "rounded and delayed, $method" '' -- period=0.07 quantum=0.25 delay=0.1
done
scene 0.1 0.1 2
for tolerance in 1e-6 1e-9; do
    for method in adams rkck; do
        scene 0.1 0.1 2 "integrator: $method" "tolerance: $tolerance"
        run $tolerance "variable steps" '' -- period=0.14285714285714285 delay=0.05 mean=0.1
    done
done
scene 0.01 0.1 2 'integrator: ab3' 'ratio: 2'
for way in --general '--engine cc' '--engine tape' '--engine gic' '--engine gcp1' '--engine gcp2' '--solve augmented'; do
    run 1e-11 'engines' "$way" -- period=0.07 delay=0.1 mean=0.1
done

# ---- 10^5 samples: k * period, no sum. In 1000 s a sum of 0.01 is off by some 1e-9 s
scene 0.005 100 1000 'integrator: ab3'
run 1e-10 'long' '' -- period=0.01 mean=0.1 delay=0.0125

# ---- rounding of exact halves: 0.5, 1.5, -0.5, -1.5 and what is no half
halves() {
    cat >halves.veh <<END
gicgen: 1
model: halves
base: ground
bodies: {b: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {j: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, b], axis: [1, 0, 0], range: [-10, 10]}}
tables: {u: {x: [0, 0.25, 0.5, 0.75, 1, 1.25, 1.5, 1.75, 2], y: [$2]}}
controllers: {round: {period: 0.25, rules: {u: {value: u(time), quantum: $1}}}}
signals: {rounded: round.u}
outputs: {rounded: {type: signal, signal: rounded}}
END
    printf 'gicscene: 1\nstep: 0.25\noutput_step: 0.25\nduration: 2\n' >halves.scene
    "$gicrun" -q halves.veh halves.scene -o halves.csv 2>err
    found=$(awk -F, 'NR > 2 { printf "%s ", $2 + 0 }' halves.csv)
    verdict "$([ "$found" = "$3 " ]; echo $?)" "multiples of $1: $found"
}
halves 1 '0.5, 1.5, -0.5, -1.5, 0.25, -0.75, 2, 0, 0' '1 2 -1 -2 0 -1 2 0'
halves 0.5 '0.25, 0.75, -0.25, -0.75, 0.125, -0.5, 1, 0.24, 0' '0.5 1 -0.5 -1 0 -0.5 1 0'

# ---- orders across samples: a spring, 3 rad/s
for method in 'rk4 13' 'ab3 6.5'; do
    for step in 0.01 0.005; do
        scene $step 0.1 2 "integrator: ${method% *}"
        settings='period=0.14285714285714285 delay=0.05 mean=0.1 spring=18 start=0.5'
        # shellcheck disable=SC2086  # settings
        loop $settings
        "$gicrun" -q loop.veh a.scene -o out.csv 2>err
        # shellcheck disable=SC2086  # settings
        off $settings
    done >errors
    awk -v most="${method#* }" 'NR == 1 { a = $1 } NR == 2 { b = $1 } END { exit !(NR == 2 && a < 1e-4 && a / b > most) }' errors
    verdict $? "order of ${method% *}: $(tr '\n' ' ' <errors)"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
