#!/bin/sh
# SPDX-License-Identifier: MIT
# test_knots.sh GICRUN GICSWEEP: constant steps with knots of a driven coordinate within them have the order that they
# have without: a mass on a spring, whose other end is moved, against motion that is integrated by hand; the complete
# vehicle against steps of a sixteenth; sweeps in lanes have the digits of gicrun.
gicrun=$(realpath "$1")
gicsweep=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
cd "$work" || exit 1

cat >shaken.veh <<'END'
gicgen: 1
model: shaken
base: ground
bodies:
  sled: {mass: 3, com: [0, 0, 0], inertia: [1, 1, 1]}
  load: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  track: {type: prismatic, bodies: [ground, sled], axis: [1, 0, 0]}
  guide: {type: prismatic, bodies: [sled, load], axis: [1, 0, 0]}
coordinates:
  drive: {type: translation, bodies: [ground, sled], axis: [1, 0, 0], range: [-10, 10], driven: true}
  y: {type: translation, bodies: [sled, load], axis: [1, 0, 0], range: [-10, 10]}
forces:
  spring: {type: spring_damper, coordinate: y, stiffness: 800, damping: 4}
outputs:
  y: {type: coordinate, coordinate: y}
END

# follows TIMES VALUES FILE: the largest error of y, where 2 y'' = -800 y - 4 y' - 2 s'': RK4 whose steps end at knots and
# are 0.2 ms at most (20 rad/s: errors below 1e-11)
follows() {
    awk -F, -v times="$1" -v values="$2" '
        function jolt(t, k, T, x) { # acceleration in the piece after knot k
            if (k < 1 || k >= n)
                return 0
            T = at[k + 1] - at[k]
            x = (t - at[k]) / T
            return (to[k + 1] - to[k]) * 60 * x * (1 - x) * (1 - 2 * x) / T^2
        }
        function rate(t, y, v, k) {return -400 * y - 2 * v - jolt(t, k)}
        function go(until, k, parts, h, i, a1, a2, a3, a4, v2, v3, v4) {
            parts = 1 + int((until - t) / 0.0002)
            h = (until - t) / parts
            for (i = 0; i < parts; ++i) {
                a1 = rate(t, y, v, k); v2 = v + h / 2 * a1
                a2 = rate(t + h / 2, y + h / 2 * v, v2, k); v3 = v + h / 2 * a2
                a3 = rate(t + h / 2, y + h / 2 * v2, v3, k); v4 = v + h * a3
                a4 = rate(t + h, y + h * v3, v4, k)
                y += h / 6 * (v + 2 * v2 + 2 * v3 + v4)
                v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
                t += h
            }
            t = until
        }
        BEGIN {n = split(times, at, " "); split(values, to, " "); t = y = v = k = 0}
        NR > 1 {
            while (k < n && at[k + 1] < $1) {
                go(at[k + 1], k)
                ++k
            }
            go($1, k)
            off = $2 - y
            off = off < 0 ? -off : off
            if (off > most)
                most = off
        }
        END {printf "%.3g\n", most}' "$3"
}

# scene STEP WAY TIMES VALUES
scene() {
    printf 'gicscene: 1\nduration: 1.6\nstep: %s\noutput_step: 0.04\noutputs: [y.value]\n%s\n' "$1" "$2"
    printf 'inputs: {drive: {knots: {times: [%s], values: [%s]}}}\n' \
        "$(echo "$3" | sed 's/ /, /g')" "$(echo "$4" | sed 's/ /, /g')"
}

# Knots at ends of steps, in their middles, at thirds (where RK4 misses nothing), anywhere, and two in a step.
cat >cases <<'END'
ends 0.2,0.4 0,0.1
middles 0.202,0.402 0,0.1
thirds 0.2013333333333333,0.402666666666667 0,0.1
anywhere 0.2011,0.3977,0.7113 0,0.1,-0.05
pairs 0.2011,0.2032,0.4017 0,0,0.1
END
while read -r knots times values; do
    times=$(echo "$times" | tr , ' ') values=$(echo "$values" | tr , ' ')
    for way in 'integrator: ab3' 'integrator: rk4'; do
        for step in 0.004 0.002 0.001; do
            scene $step "$way" "$times" "$values" >now.scene
            "$gicrun" -q --engine tape shaken.veh now.scene -o results 2>err
            follows "$times" "$values" results
        done >errors
        echo "$knots, $way: $(tr '\n' ' ' <errors)" >said
        # order 2.8 from the step to its quarter
        check "$knots, $way" awk 'NR == 1 {first = $1} NR == 3 {exit !($1 > 0 && first > 2^5.6 * $1)}' errors
    done
done <cases

# Moves within less than four steps: the steps do not resolve them, and nothing is added. A load that nothing holds stays
# where it is, but for the parts of the move that the sums of steps meet; those of 1 ms lie between all times of 10 ms.
sed '/^forces:/,/spring:/d' shaken.veh >loose.veh
for way in 'integrator: ab3' 'integrator: rk4'; do
    printf 'gicscene: 1\nduration: 1\nstep: 0.01\noutput_step: 1\noutputs: [y.value]\n%s\n%s\n' "$way" \
        'inputs: {drive: {step: {to: 0.001, rise: 0.001, start: 0.5031}}}' >now.scene
    "$gicrun" -q --engine tape loose.veh now.scene -o results 2>err
    tail -1 results >said
    check "a short move, $way" awk -F, '{exit !($2 * $2 < 1e-18)}' said
done

# Samples end in motion with the scene: no knot, though the input would rest from there on. y' = s'(0) - s', 7/30 m/s
# at the end by the natural spline's equations; AB3 leaves its kinks of h^2, 4e-5 m/s.
printf 'gicscene: 1\nduration: 2\nstep: 0.01\noutput_step: 2\noutputs: [y.rate]\n%s\n' \
    'inputs: {drive: {samples: {times: [0, 0.5, 1, 1.5, 2], values: [0, 0.1, 0, 0.1, 0.3]}}}' >now.scene
"$gicrun" -q --engine tape loose.veh now.scene -o results 2>err
tail -1 results >said
check "samples that end with the scene" awk -F, '{d = $2 - 7 / 30; exit !(d * d < 1e-8)}' said

# Two rates: the complete vehicle, whose rack stops within a step
sed 's/^output_step:.*/output_step: 0.024/; s/^duration:.*/duration: 5.04/' "$root/models/scenes/step_steer.scene" >steer.scene
steer() { # STEP FORM RESULTS
    sed "s/^step:.*/step: $1/; $2" steer.scene >now.scene
    "$gicrun" -q "$root/models/hmmwv_vehicle.veh" now.scene -o "$3" 2>err
}
steer 0.006 '' whole
steer 0.0015 '' quarter
steer 0.000375 's/ab3/rk4/; /^ratio/d' fine
apart() {
    paste -d, "$1" "$2" | awk -F, '
        NR == 1 {for (i = 1; i <= NF; ++i) if ($i == "chassis.x [m]") {if (a) b = i; else a = i}}
        NR > 1 {d = sqrt(($a - $b)^2 + ($(a + 1) - $(b + 1))^2 + ($(a + 2) - $(b + 2))^2); if (d > most) most = d}
        END {print most}'
}
echo "$(apart whole fine) $(apart quarter fine)" >said
check "step_steer at two rates" awk '{exit !($1 > 0 && $1 < 1e-5 && $1 > 2^5.6 * $2)}' said

# Lanes: runs that have the same knots in the same steps, and what a knot adds depends on the run
cat >lanes.scene <<'END'
gicscene: 1
duration: 1.6
step: 0.004
output_step: 0.04
outputs: [y.value]
initial: {coordinates: {y: 0}}
inputs: {drive: {knots: {times: [0.2011, 0.3977, 0.3991, 0.7113], values: [0, 0.1, 0.1, -0.05]}}}
END
"$gicsweep" -q shaken.veh lanes.scene --vary y=0:0.02:3 -o sweep.csv >out 2>err
check "a sweep" [ $? -eq 0 ]
for row in 2 3 4; do
    sed "s/y: 0}/y: $(sed -n ${row}p sweep.csv | cut -d, -f2)}/" lanes.scene >now.scene
    "$gicrun" -q shaken.veh now.scene -o one.csv 2>err
    tail -1 one.csv >said
    check "lanes have gicrun's digits" [ "$(sed -n ${row}p sweep.csv | cut -d, -f5)" = "$(tail -1 one.csv | cut -d, -f2)" ]
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
