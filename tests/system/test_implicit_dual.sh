#!/bin/sh
# SPDX-License-Identifier: MIT
# test_implicit_dual.sh GICGEN GICRUN: `ratio` with implicit and exponential steps: slow states by the method, fast ones
# by AB3 within each step. A linear model with a stiff bushing and a filter that long explicit steps do not stand,
# against the exponential of its matrix, by a program that knows nothing of these steps; what does not change with a
# ratio of 1; vehicles with tires, gears, contacts and controllers against short steps of RK4; FMUs, libgic and embedded
# code; what is refused.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# shellcheck source=tests/lib/against_gic.sh
. "$(dirname "$0")/../lib/against_gic.sh"
# shellcheck source=tests/lib/scenes.sh
. "$(dirname "$0")/../lib/scenes.sh"
cd "$work" || exit 1
models=$root/models

# ---- 2 kg on 200 N/m and 2 Ns/m carry 0.01 kg on a bushing of 1e4 N/m and 20 Ns/m (two motions of some -1000 /s); a
# filter of -500 /s pushes back. Steps of 20 ms: 20 |lambda|; a ratio of 20: half a unit.
cat >carrier.veh <<'END'
gicgen: 1
model: carrier
gravity: [0, 0, 0]
base: ground
bodies:
  b: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
  s: {mass: 0.01, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  j: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}
  k: {type: prismatic, bodies: [b, s], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, b], axis: [1, 0, 0], range: [-9, 9]}
  d: {type: translation, bodies: [b, s], axis: [1, 0, 0], range: [-9, 9]}
states:
  z: {initial: 0.1, rate: "100 * rate(x) + 50 * x - 500 * z"}
forces:
  spring: {type: spring_damper, coordinate: x, stiffness: 200, damping: 2}
  rubber: {type: bushing, bodies: [b, s], point: [0, 0, 0], stiffness: [1e4, 0, 0, 0, 0, 0], damping: [20, 0, 0, 0, 0, 0]}
  push: {type: force, coordinate: x, value: "5 * z"}
signals: {z_s: z}
outputs:
  x: {type: coordinate, coordinate: x}
  d: {type: coordinate, coordinate: d}
  z: {type: signal, signal: z_s}
END
# the exponential of A / 10 by its series in fractions of 1/2^16, squared
cat >exact.py <<'END'
def product(a, b):
    return [[sum(x * y for x, y in zip(row, column)) for column in zip(*b)] for row in a]
M, m = 2.0, 0.01
# of x, d, x', d', z; the carried mass: m (x'' + d'') = -f, f = 1e4 d + 20 d'; the carrier: M x'' = f + ...
own = [-200 / M, 1e4 / M, -2 / M, 20 / M, 5 / M]
A = [[0, 0, 1, 0, 0], [0, 0, 0, 1, 0], own, [-own[0], -1e4 / m - own[1], -own[2], -20 / m - own[3], -own[4]],
     [50, 0, 100, 0, -500]]
h = 0.1 / 2**16
step = one = [[float(i == k) for k in range(5)] for i in range(5)]
term = one
for k in range(1, 12):
    term = [[h / k * x for x in row] for row in product(term, A)]
    step = [[x + y for x, y in zip(*rows)] for rows in zip(step, term)]
for k in range(16):
    step = product(step, step)
y = [[1.0], [0.0], [0.0], [0.0], [0.1]]
print('time,x,d,z')
for k in range(11):
    print(k / 10, y[0][0], y[1][0], y[4][0], sep=',')
    y = product(step, y)
END
python3 exact.py >exact.csv
# error METHOD STEP LINE...: of x, d and z at the last three rows, 0.8 s and later
error() {
    method=$1 step=$2
    shift 2
    scene 1 "$step" "integrator: $method" 'initial: {coordinates: {x: 1}}' 'outputs: [x.value, d.value, z]' "$@" >carrier.scene
    run carrier.veh carrier.scene -o carrier.csv
    [ "$status" -eq 0 ] || { cat err >&2; return; }
    { head -n 1 exact.csv; tail -n 3 exact.csv; } >late.csv
    { head -n 1 carrier.csv; tail -n 3 carrier.csv; } >made.csv
    apart late.csv made.csv
}
for method in ros2 ros3 imex exp3; do
    order=$([ $method = ros2 ] || [ $method = imex ] && echo 2 || echo 3)
    off1=$(error "$method" 0.02 'ratio: 20')
    off2=$(error "$method" 0.01 'ratio: 20')
    found=$(awk -v a="${off1:-0}" -v b="${off2:-0}" 'BEGIN { print (b > 0 ? log(a / b) / log(2) : 0) }')
    # what damped out at the start is of a lower order (stiff parts of a start are): from the method's order on
    check "$method, ratio 20: errors ${off1:-none} and ${off2:-none}, order $found" within "$order - 0.2" "$found"
    check "$method: the run says its ratio" says 'ratio 20'
    # without a ratio nothing changes; at a ratio that the filter does not stand the run says so
    one=$(error "$method" 0.01)
    mv carrier.csv one.csv
    # no worse than at one rate, but for what a cubic through links has of motions of 10 rad/s, 3/128 (w H)^4 = 2e-6
    check "$method, ratio 20, 10 ms: $off2, at one rate $one" within "${off2:-1}" "1.05 * $one + 1e-5"
    error "$method" 0.01 'ratio: 1' >/dev/null
    check "$method: a ratio of 1 is none" cmp -s one.csv carrier.csv
    scene 1 0.02 "integrator: $method" 'initial: {coordinates: {x: 1}}' 'outputs: [x]' 'ratio: 2' >short.scene
    run carrier.veh short.scene -o short.csv
    { [ "$status" -eq 1 ] && says 'error: '; }
    verdict $? "$method: five units of the filter in a fast step are told"
    sed "s/^integrator.*/integrator: ab3/" short.scene >explicit.scene
    run -q --integrator "$method" carrier.veh explicit.scene -o replaced.csv
    check "$method in the place of ab3 takes one rate" exits 0
    error "$method" 0.01 'ratio: 20' >/dev/null
    mv carrier.csv bits.csv
    for engine in cc tcc; do
        run -q --engine $engine carrier.veh carrier.scene -o other.csv
        check "$method: the bits of $engine" cmp -s bits.csv other.csv
    done
done
# ---- the longest step that --modes tells: the filter's, 20 fast steps of 6/11 of its time, as it hardly feels the body
scene 1 0.01 'integrator: imex' 'ratio: 20' >modes.scene
"$gicrun" --modes carrier.veh modes.scene >modes 2>err
stable=$(sed -n 's/^imex, ratio 20  *\([0-9.]*\) s.*/\1/p' modes)
check "--modes: stable up to ${stable:-nothing} s with a ratio of 20" within "$(awk "BEGIN { d = ${stable:-0} * 500 / 20 * 11 / 6 - 1; print d < 0 ? -d : d }")" 0.05
for part in 0.95 1.05; do
    step=$(awk "BEGIN { print $part * ${stable:-1} }")
    printf '%s\n' 'gicscene: 1' "step: $step" "duration: $(awk "BEGIN { print 2000 * $step }")" 'integrator: imex' 'ratio: 20' 'outputs: [z]' 'initial: {coordinates: {x: 1}}' >limit.scene
    run carrier.veh limit.scene -o limit.csv
    check "2000 steps of $part of it" exits "$([ $part = 0.95 ] && echo 0 || echo 1)"
done

# ---- a vehicle with tires, powertrain and gears, against short steps
{
    scene 3 0.0005 'integrator: rk4' 'outputs: [chassis, chassis_velocity]'
    rest_of "$models/scenes/full_run.scene"
} >short.scene
run -q "$models/hmmwv_vehicle.veh" short.scene -o short.csv
for method in ros2 ros3 imex exp3; do
    sed "s/^step:.*/step: 0.006/; s/^integrator:.*/integrator: $method/" short.scene >one.scene
    { cat one.scene; echo 'ratio: 6'; } >dual.scene
    run -q "$models/hmmwv_vehicle.veh" one.scene -o one.csv
    run "$models/hmmwv_vehicle.veh" dual.scene -o dual.csv
    one=$(apart short.csv one.csv)
    dual=$(apart short.csv dual.csv)
    check "a vehicle that shifts, $method, ratio 6: $dual, without $one" within "${dual:-1}" "$one"
done
# a Jacobian by shares, and fast steps that are left out: twice what imex with its own Jacobians is off by, which is of
# order 2 at 6 ms, and what `steady` may move a spin by
{ sed 's/^integrator:.*/integrator: imex/' dual.scene; echo 'keep_jacobian: 16'; } >kept.scene
{ cat kept.scene; echo 'spread_jacobian: true'; } >spread.scene
{ cat kept.scene; echo 'steady: 1e-4'; } >steady.scene
for way in kept spread steady; do
    run "$models/hmmwv_vehicle.veh" $way.scene -o $way.csv
    check "$way, ratio 6: $(apart short.csv $way.csv)" within "$(apart short.csv $way.csv)" 4e-4
done
check 'fast steps that are left out are counted' says 'fast rates skipped'

# ---- a jump, whose contacts are located, and bounded work. Tires that land move at 30 Hz, 0.8 rad a step: centimetres are
# what methods of order 2 make of that; a contact that is missed makes more
{
    scene 1.2 0.0005 'integrator: rk4' 'locate: true' 'outputs: [chassis]'
    rest_of "$models/scenes/tires_jump.scene"
} >jump.scene
run -q "$models/hmmwv_vehicle.veh" jump.scene -o jump.csv
for method in ros2 ros3 imex exp3; do
    for most in 'locate: true' 'most_work: 60'; do
        { sed "s/^step:.*/step: 0.004/; s/^integrator:.*/integrator: $method/" jump.scene; echo 'ratio: 4'; } >landing.scene
        case $most in most*) echo "$most" >>landing.scene ;; esac
        run "$models/hmmwv_vehicle.veh" landing.scene -o landing.csv
        check "a jump, $method, $most: $(apart jump.csv landing.csv)" within "$(apart jump.csv landing.csv)" 2e-2
        check "$method, $most: contacts are located" says 'contacts located'
    done
done
sed 's/^most_work.*/most_work: 19/' landing.scene >bad.scene
run "$models/hmmwv_vehicle.veh" bad.scene -o none.csv
{ [ "$status" -eq 1 ] && says 'most_work must be a whole number from 20 to' && [ ! -e none.csv ]; }
verdict $? 'less work than a start takes is refused'

# ---- embedded: both number types, a copy on the way, failures
"$gicgen" --implicit --exponential "$models/hmmwv_vehicle.veh" -o hmmwv_vehicle.c || exit 1
cp "$root"/runtime/gic_runtime.[ch] .
cat >drive.c <<'END'
#include "hmmwv_vehicle.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static hmmwv_vehicle car, copy, before;

static int step(hmmwv_vehicle *self, double length, gic_method method, int ratio)
{
    return gic_step_dual_by(&hmmwv_vehicle_model, self, (gic_real)length, (int32_t)method, ratio, (gic_real)0.0);
}

int main(void)
{
    static const gic_method methods[4] = {GIC_ROS2, GIC_ROS3, GIC_IMEX, GIC_EXP3};
    int i, k;
    for (i = 0; i < 4; ++i) {
        const gic_method method = methods[i];
        if (hmmwv_vehicle_setup(&car) != GIC_OK)
            return 1;
        car.implicit.keep = 3;
        car.input[HMMWV_VEHICLE_INPUT_BRAKE] = (gic_real)0.3;
        for (k = 0; k < 200; ++k) {
            if (k == 51)
                hmmwv_vehicle_snapshot(&car, &copy);
            if (step(&car, 0.005, method, 5) != GIC_OK)
                return printf("%s %s\n", hmmwv_vehicle_status_text(car.head.status), hmmwv_vehicle_status_state(&car));
        }
        for (k = 51; k < 200; ++k)
            if (step(&copy, 0.005, method, 5) != GIC_OK)
                return 3;
        if (memcmp(car.state, copy.state, sizeof car.state) != 0)
            return printf("a copy goes another way\n");
        /* what fails leaves state, time and inputs */
        hmmwv_vehicle_snapshot(&car, &before);
        if (step(&car, 0.005, method, 0) != GIC_ERROR_ARGUMENT || step(&car, 0.005, GIC_RK4, 2) != GIC_ERROR_ARGUMENT ||
            step(&car, -0.005, method, 5) != GIC_ERROR_ARGUMENT)
            return 4;
        car.input[HMMWV_VEHICLE_INPUT_BRAKE] = (gic_real)HUGE_VAL;
        if (step(&car, 0.005, method, 5) == GIC_OK || memcmp(car.state, before.state, sizeof car.state) != 0 ||
            hmmwv_vehicle_time(&car) != hmmwv_vehicle_time(&before))
            return 5;
        car.input[HMMWV_VEHICLE_INPUT_BRAKE] = (gic_real)0.3;
        if (step(&car, 0.005, method, 5) != GIC_OK)
            return 6;
        printf("%.9g ", (double)car.state[HMMWV_VEHICLE_STATE_R_Z]);
    }
    return 0;
}
END
warnings='-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Werror'
for how in 'gcc -std=c99' 'gcc -std=c99 -DGIC_FLOAT -Wdouble-promotion' 'g++ -std=c++11 -x c++' 'clang -std=c99 -O1 -fsanitize=address,undefined -fno-sanitize-recover=all'; do
    # shellcheck disable=SC2086  # lists of words
    { $how $warnings -I. drive.c hmmwv_vehicle.c gic_runtime.c -o drive -lm && ./drive; } >said 2>&1
    verdict $? "$how: $(tail -n 1 said)"
done

# ---- units of FMI have the bits of gicrun; libgic and Python take a ratio
# shellcheck source=tests/fmi/lib.sh
. "$root/tests/fmi/lib.sh"
importer -o "$work/importer" >"$work/out" 2>"$work/err"
verdict $? "the importer compiles"
scene 1 0.01 'integrator: imex' 'keep_jacobian: 4' 'ratio: 20' >unit.scene
for version in 2 3; do
    "$gicrun" -q --general --engine tcc carrier.veh unit.scene -o steps.csv 2>err && unit carrier.veh unit.scene &&
        drive steps 0.1 1 >unit.csv 2>err && as_run 0 steps.csv
    verdict $? "FMI $version.0: imex with a ratio has the bits of gicrun"
done
sed 's/imex/exp3/; /^keep/d' unit.scene >other.scene
"$gicrun" -q --general --engine tcc carrier.veh other.scene -o steps.csv 2>err && unit carrier.veh other.scene &&
    drive steps 0.1 1 >unit.csv 2>err && as_run 0 steps.csv
verdict $? "FMI 3.0: exp3 with a ratio has the bits of gicrun"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
