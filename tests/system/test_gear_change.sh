#!/bin/sh
# SPDX-License-Identifier: MIT
# test_gear_change.sh GICGEN GICRUN: changes of gear against motion that is integrated by hand, to 1e-10; a run again and
# one from a snapshot to the last bit.
#
# Two equal wheels in the air turn at Omega, the turbine at 2 i Omega. An engine of 100 rad/s and a converter of capacity
# 20 and torque ratio 1 give (100 / 20)^2 = 25 N m on either side, which is the engine's torque, so that its speed stays.
# POWERTRAIN.md section 3 has then, with 1 kg m^2 of each wheel and 0.5 kg m^2 that turns with the turbine,
#
#     (1 + 0.5 (2 i)^2 / 2) Omega' = 25 (2 i) / 2
#
# where i is constant but for the 0.3 s of a shift. So the turbine's speed is linear in time until the shift is due; the
# shift is a quadrature, done here by Simpson's rule in 2000 parts (error below 1e-14).
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
cd "$work" || exit 1

cat >line.veh <<'END'
gicgen: 1
model: line
base: ground
bodies:
  carriage: {mass: 400, com: [0, 0, 0.6], inertia: [100, 200, 200]}
joints:
  track: {type: prismatic, bodies: [ground, carriage], axis: [1, 0, 0]}
coordinates:
  along: {type: translation, bodies: [ground, carriage], axis: [1, 0, 0], range: [-0.5, 0.5]}
tables:
  capacity: {x: [0, 1], y: [20, 20]}
  multiplication: {x: [0, 1], y: [1, 1]}
forces:
  hold: {type: spring_damper, coordinate: along, stiffness: 2000, damping: 800}
tires:
  easy:
    {type: tmeasy, radius: 0.31, stiffness: 200000, damping: 200, load: 4000, dfx0: [100000, 160000],
     fxm: [4000, 7000], fxs: [3000, 5500], dfy0: [80000, 120000], fym: [3800, 6500], fys: [3100, 5200],
     sxm: [0.12, 0.14], sxs: [0.4, 0.4], sym: [0.18, 0.22], sys: [0.5, 0.55],
     trail: [0.15, 0.14], sq0: [0.2, 0.24], sqe: [0.4, 0.5]}
wheels:
  left: {body: carriage, center: [0, 0.7, 1.3], tire: easy, spin_inertia: 1}
  right: {body: carriage, center: [0, -0.7, 1.3], tire: easy, spin_inertia: 1}
powertrain:
  engine: {inertia: 0.2, throttle: 1, torque: 25}
  converter: {capacity: capacity, torque: multiplication}
  transmission: {forward: [3, 2, 1.2], up: [UP, UP], down: [-1, -1], latency: LATENCY, duration: 0.3, inertia: 0.5}
  differentials:
    axle: {outputs: [left, right], ratio: 2}
outputs:
  line: {type: powertrain}
END

# follows UP LATENCY FILE: the largest distance of turbine speed, ratio and engine speed from what is due, relative to
# their size, and that of gears, for which rounding may choose at the time of a change itself
follows() {
    awk -F, -v up="$1" -v latency="$2" '
        function smooth(x) {return x >= 1 ? 1 : x * x * (3 - 2 * x)}
        function ratio(age) {return i[g - 1] + smooth(age / 0.3) * (i[g] - i[g - 1])}
        function slope(age) {return 25 * ratio(age) / (1 + ratio(age)^2)}
        # change of Omega from the change of gear on
        function gain(age, part, sum, k) {
            if (age > 0.3)
                return gain(0.3) + (age - 0.3) * slope(1)
            part = age / 2000
            for (k = 0; k <= 2000; ++k)
                sum += slope(k * part) * (k % 2 ? 4 : k % 2000 ? 2 : 1)
            return sum * part / 3
        }
        # time, since the last one, of the next change: where the speed is above `up` by the share d of 1 + up that
        # POWERTRAIN.md section 4 has, but not before the latency; shifts have ended then
        function next_change(need, when) {
            need = (up + 1e-9 * (1 + up)) / (2 * i[g]) - omega
            when = g == 1 ? need / slope(1) : 0.3 + (need - gain(0.3)) / slope(1)
            return g > 1 && when < latency * (1 - 1e-9) ? latency * (1 - 1e-9) : when < 0 ? 0 : when
        }
        function off(x, exact) {
            x -= exact
            x = (x < 0 ? -x : x) / (1 + (exact < 0 ? -exact : exact))
            if (x > most)
                most = x
        }
        BEGIN {i[0] = i[1] = 3; i[2] = 2; i[3] = 1.2; g = 1; began = omega = 0; due = next_change()}
        NR == 1 {for (c = 1; c <= NF; ++c) {sub(/ .*/, "", $c); column[$c] = c}; next}
        {
            while (g < 3 && $1 > began + due) {
                omega += gain(due)
                began += due
                ++g
                due = g < 3 ? next_change() : 1e9
            }
            age = $1 - began
            off($column["line.ratio"], ratio(age))
            off($column["line.turbine_speed"], 2 * ratio(age) * (omega + gain(age)))
            off($column["line.engine_speed"], 100)
            wrong += $column["line.gear"] != g && age > 1e-12 && began + due - $1 > 1e-12
        }
        END {printf "%.3g, %d gears wrong, ends in gear %d\n", most, wrong, g >"said"; exit !(g == 3 && !wrong && most < 1e-10)}' "$3"
}

# Changes that the speed decides, at 60 rad/s: general times. At 45 rad/s in the first gear, for 1 s at 7.5 rad/s^2: a
# nanosecond after the end of a step, for 45 is not above 45. Changes that the latency decides: 0 and multiples of it,
# which are ends of steps.
for case in '60 0.4' '45 0.4' '-1 0.4'; do
    # shellcheck disable=SC2086  # words
    set -- $case
    sed "s/UP/$1/g; s/LATENCY/$2/" line.veh >now.veh
    for way in 'integrator: rk4' 'ratio: 1' 'ratio: 5'; do
        printf 'gicscene: 1\nduration: 2.5\nstep: 0.0001\noutput_step: 0.01\noutputs: [line]\n%s\n' "$way" >now.scene
        echo 'initial: {states: {engine.speed: 100}}' >>now.scene
        for engine in tcc tape gic gcp1; do
            : >results
            "$gicrun" -q --engine $engine now.veh now.scene -o results 2>err
            check "shift at $1 rad/s, latency $2 s, $way, $engine" follows "$1" "$2" results
        done
    done
    # variable steps bisect the time of a change to a hundredth of their tolerance
    printf 'gicscene: 1\nduration: 2.5\noutput_step: 0.01\noutputs: [line]\n' >free.scene
    echo 'initial: {states: {engine.speed: 100}}' >>free.scene
    for way in adams rkck; do
        for engine in tcc gic; do
            : >results
            "$gicrun" -q --engine $engine --integrator $way --tolerance 1e-12 now.veh free.scene -o results 2>err
            check "shift at $1 rad/s, latency $2 s, $way, $engine" follows "$1" "$2" results
        done
    done
    "$gicrun" -q --engine tcc now.veh now.scene -o first 2>err
    "$gicrun" -q --engine tcc now.veh now.scene -o second 2>err
    check "shift at $1 rad/s: the same again" cmp first second
done

# Snapshots in steps before, with and after the change at 4/3 s: a copy of the instance goes on to the same last bit, in
# either precision.
sed 's/UP/60/g; s/LATENCY/0.4/' line.veh >now.veh
cp "$root"/runtime/gic_runtime.[ch] .
cat >snapshot.c <<'END'
#include "line.h"
#include <stdio.h>
#include <string.h>

static line first, copy;

static int step(line *vehicle, int ratio)
{
    return gic_step_dual(&line_model, vehicle, GIC_R(0.01), ratio) != GIC_OK;
}

int main(void)
{
    int bad = 0, changes = 0;
    for (int ratio = 1; ratio <= 5; ratio += 4)
        for (int taken = 129; taken < 138; ++taken) {
            memset(&first, 0, sizeof first);
            bad += line_setup(&first) != GIC_OK;
            first.state[LINE_STATE_ENGINE_SPEED] = 100;
            for (int k = 0; k < 160; ++k) {
                if (k == taken)
                    memcpy(&copy, &first, sizeof first);
                bad += step(&first, ratio);
                if (k >= taken)
                    bad += step(&copy, ratio) + (memcmp(&first, &copy, sizeof first) != 0);
            }
            changes += first.discrete[0] == 2;
        }
    printf("%d bad, %d changes\n", bad, changes);
    return bad || changes != 18;
}
END
"$gicgen" now.veh -o line.c >out 2>err
for real in '' -DGIC_FLOAT; do
    # shellcheck disable=SC2086  # nothing or one word
    cc -std=c99 -Wall -Wextra -Werror -O1 $real snapshot.c line.c gic_runtime.c -lm -o snapshot >out 2>err && ./snapshot >said
    verdict $? "snapshots $real"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
