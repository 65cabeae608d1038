#!/bin/sh
# SPDX-License-Identifier: MIT
# test_thresholds.sh GICGEN GICRUN: what happens at a time or a threshold happens in the step that exact arithmetic says,
# however the time adds up and whatever the sign of a zero: changes of gear (POWERTRAIN.md section 4), in every engine and
# way of generating, and sleep (SCENE.md section 9), where steps are counted by hand; an engine that stops, wheels that
# begin to roll, and a wheel between two tracks of a road.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$root/tests/lib/checking.sh"
cd "$work" || exit 1

# A powertrain on wheels in the air, with a turbine that is always fast enough for the next gear.
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
inputs:
  selector: {unit: "1", default: 1}
  push: {unit: "1"}
tables:
  capacity: {x: [0, 1], y: [10, 30]}
  multiplication: {x: [0, 1], y: [2, 1]}
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
  engine: {inertia: 0.2, throttle: push, torque: 20 * throttle}
  converter: {capacity: capacity, torque: multiplication}
  transmission:
    forward: [3, 2.5, 2, 1.5, 1]
    reverse: [-3]
    selector: selector
    up: [-1, -1, -1, -1]
    down: [-2, -2, -2, -2]
    latency: 0.3
    duration: 0.3
  differentials:
    axle: {outputs: [left, right], ratio: 2}
outputs:
  line: {type: powertrain}
END

# line LATENCY DURATION and scene STEP RATIO END: the model, and a scene of it
line() { sed "s/latency: .*/latency: $1/; s/duration: .*/duration: $2/" line.veh >now.veh; }
scene() {
    printf 'gicscene: 1\nduration: %s\nstep: %s\nratio: %s\noutputs: [line.gear]\n' "$3" "$1" "$2" >now.scene
}
# changes COLUMN: the rows of results, from 0, where the gear changes
changes() { awk -F, 'NR > 2 && $2 != gear {printf "%s%d", n++ ? " " : "", NR - 2} {gear = $2} END {print ""}' results; }
# changes_at ROWS ARGUMENT...: gicrun with them
changes_at() {
    rows=$1
    shift
    "$gicrun" -q "$@" now.veh now.scene -o results >out 2>err && [ "$(changes)" = "$rows" ] || { changes >>err; false; }
}

# A change happens when it is due, and rows show it from the end of the step in which that time is; a step's end belongs
# to the step that ends there. The first change is due at 0, where step 1 begins, for gears have not changed for long;
# the others follow `latency` (at least `duration`) after each other, here N steps: at the ends of steps N, 2 N, 3 N.
# Where the first gear is new at 0 the first change is at the end of step N. A latency that is a microsecond longer
# puts all of these into the step after, one that is shorter does not.
# rows ROW...: those that a run of 2.2 s has
rows() {
    for row; do
        [ "$row" -gt "$steps" ] || echo "$row"
    done | paste -sd ' '
}
for case in '0.1 0.1 0.01 1 10' '0.3 0.3 0.006 1 50' '0.3 0.1 0.006 6 50' '0.1 0.02 0.001 1 100' '0.6 0.3 0.02 4 30' \
    '0.05 0.1 0.01 1 10' '0.7 0.3 0.01 10 70'; do
    # shellcheck disable=SC2086  # words
    set -- $case
    n=$5
    line "$1" "$2"
    scene "$3" "$4" 2.2
    steps=$(awk "BEGIN {printf \"%d\", 2.2 / $3 + 0.5}")
    expected=$(rows 1 "$n" $((2 * n)) $((3 * n)))
    for engine in tape tcc gic gcp1; do
        check "latency $1, duration $2, steps of $3 / $4: $engine" changes_at "$expected" --engine $engine
    done
    check "latency $1, duration $2, steps of $3 / $4: code for all scenes" changes_at "$expected" --engine tcc --general
    echo 'initial: {states: {transmission.age: 0}}' >>now.scene
    check "latency $1, duration $2, steps of $3 / $4: a new gear" \
        changes_at "$(rows "$n" $((2 * n)) $((3 * n)) $((4 * n)))" --engine tcc
    line "$(awk "BEGIN {print $1 + 1e-6}")" "$(awk "BEGIN {print $2 + 1e-6}")"
    scene "$3" "$4" 2.2
    check "latency $1 + 1e-6, duration $2, steps of $3 / $4" \
        changes_at "$(rows 1 $((n + 1)) $((2 * n + 1)) $((3 * n + 1)))" --engine tcc
    line "$(awk "BEGIN {print $1 - 1e-6}")" "$(awk "BEGIN {print $2 - 1e-6}")"
    check "latency $1 - 1e-6, duration $2, steps of $3 / $4" changes_at "$expected" --engine tcc
done
line 0.1 0.1
scene 0.01 1 1
expected='1 10 20 30'
check 'lanes' changes_at "$expected" --engine cc --lanes 4
check 'rk4' changes_at "$expected" --engine tape --integrator rk4
check 'the augmented form' changes_at "$expected" --engine tcc --solve augmented
check 'gcp2' changes_at "$expected" --engine gcp2

# shifts shorter than a step: the first is due at 0 and the others `duration` after each other, so that row R, at the end
# of step R, has gear 2 + (R step) / duration, one due at that end included, but 5 at most
for case in '0.001 5 5' '0.0025 5 5' '0.003 5 5' '0.004 4 5' '0.005 4 5' '0.006 3 5' '0.01 3 4'; do
    # shellcheck disable=SC2086  # words
    set -- $case
    line 0 "$1"
    for ratio in 1 6; do
        scene 0.01 $ratio 0.02
        for engine in tape tcc gic gcp1; do
            "$gicrun" -q --engine $engine now.veh now.scene -o results >out 2>err
            check "shifts of $1 s in steps of 0.01 s / $ratio, $engine" \
                [ "$(cut -d, -f2 results | tail -n 2 | paste -sd ' ')" = "$2 $3" ]
        done
    done
done
# gears that change up and down a hundred times in a step, and 30 times
for engine in tape tcc gic; do
    line 0 0.0001
    sed -i 's/down: .*/down: [1000, -1, -1, -1]/; s/up: .*/up: [-1, 1000, 1000, 1000]/' now.veh
    run --engine $engine now.veh now.scene -o results
    check "a hundred changes in a step are refused, $engine" exits 1
    check "with a message, $engine" says 'gears or contacts change, or controllers sample, more often within a step than a step can follow: transmission.gear'
    check "and a remedy, $engine" says 'try a shorter step, or a longer `duration`'
    sed -i 's/duration: .*/duration: 0.00033/' now.veh
    run --engine $engine now.veh now.scene -o results
    check "thirty are not, $engine" exits 0
done

# single and double precision in a program of one's own, where the gear is an output
cp "$root"/runtime/gic_runtime.[ch] .
line 0.3 0.3
"$gicgen" now.veh -o line.c >out 2>err && "$gicgen" --main now.veh |
    sed 's/GIC_R(0.02)/GIC_R(0.006)/; s/steps = 10;/steps = 1;/; s/rows = 100,/rows = 160,/' >main.c
for real in '' -DGIC_FLOAT; do
    # shellcheck disable=SC2086  # nothing or one word
    cc -std=c99 -Wall -Wextra -Werror -O1 $real main.c line.c gic_runtime.c -lm -o program >out 2>err &&
        ./program >said 2>err && awk -F, 'NR == 1 {for (i = 1; i <= NF; ++i) if ($i ~ /gear/) c = i} {print $1 "," $c}' said >results
    check "a program of one's own $real" [ "$(changes)" = '1 50 100 150' ]
done

# a selector that is 0.5 at 0.3 s, by itself and as a difference: it is above at the end of the step after that
line 0 0.01
sed 's/selector: selector/selector: selector - 0.5/' now.veh >other.veh
for step in 0.006 0.01 0.001; do
    for whole in 'now 0 1' 'other 0.5 1.5'; do
        # shellcheck disable=SC2086  # words
        set -- $whole
        scene $step 1 0.32
        printf 'initial: {gear: 0}\ninputs: {selector: {knots: {times: [0, 0.6], values: [%s, %s]}}}\n' "$2" "$3" >>now.scene
        [ "$1" = now ] || cp other.veh now.veh
        row=$(awk "BEGIN {printf \"%d\", 0.3 / $step + 1.5}")
        for engine in tape tcc gic; do
            "$gicrun" -q --engine $engine now.veh now.scene -o results >out 2>err
            check "a selector at 0.5 ($1), steps of $step, $engine" [ "$(changes | cut -d' ' -f1)" = "$row" ]
        done
        line 0 0.01
    done
done
# backwards without a reverse gear is neutral
line 0.1 0.1
sed -i '/reverse:/d' now.veh
scene 0.01 1 0.3
echo 'inputs: {selector: -1}' >>now.scene
for engine in tape tcc gic gcp1; do
    check "no reverse gear, $engine" changes_at 1 --engine $engine
done

# a turbine at rest, but for rounding: neither above nor below 0
for spin in 0 1e-25 -1e-25 1e-12 -1e-12; do
    line 0.1 0.1
    sed -i 's/up: .*/up: [0, 0, 0, 0]/; s/down: .*/down: [0, 0, 0, 0]/' now.veh
    scene 0.01 1 0.3
    echo "initial: {gear: 2, states: {left.spin: $spin, right.spin: $spin}}" >>now.scene
    for engine in tape tcc gic gcp1; do
        check "a turbine at rest, spins of $spin rad/s, $engine" changes_at '' --engine $engine
    done
done
line 0.1 0.1
sed -i 's/up: .*/up: [0, 0, 0, 0]/; s/down: .*/down: [0, 0, 0, 0]/' now.veh
scene 0.01 1 0.08
for spin in 1e-3 -1e-3; do
    sed -i '/^initial/d' now.scene
    echo "initial: {gear: 2, states: {left.spin: $spin, right.spin: $spin}}" >>now.scene
    check "one that turns, spins of $spin rad/s" changes_at 1 --engine gic
done

# ---- sleep ------------------------------------------------------------------------------------------------------

# An input that stays from 0.1 s on (its last change is in the step that ends there): asleep `after` seconds after that,
# to the end at 1 s.
cat >rests.veh <<'END'
gicgen: 1
model: rests
base: ground
bodies:
  slide: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  slide: {type: prismatic, bodies: [ground, slide], axis: [1, 0, 0]}
coordinates:
  slide: {type: translation, bodies: [ground, slide], axis: [1, 0, 0]}
inputs:
  nothing: {unit: "1"}
forces:
  slide: {type: spring_damper, coordinate: slide, stiffness: 10, damping: 10}
END
for case in '0.01 0.2 70' '0.01 0.1 80' '0.02 0.2 35' '0.05 0.2 14' '0.01 0.6 30' '0.005 0.7 40' '0.1 0.2 7' '0.1 0.5 4'; do
    # shellcheck disable=SC2086  # words
    set -- $case
    printf 'gicscene: 1\nduration: 1\nstep: %s\nsleep: {after: %s}\n' "$1" "$2" >rests.scene
    echo 'inputs: {nothing: {knots: {times: [0, 0.1], values: [0, 1]}}}' >>rests.scene
    for engine in tape gic; do
        run --engine $engine rests.veh rests.scene -o results
        check "asleep $3 steps of $1 s, after $2 s, $engine" says "steps asleep  *$3 "
    done
done

# ---- an engine that is held back at rest ------------------------------------------------------------------------

# at 0 but for rounding it stays there; from 1/2 rad/s with -40 N m and 0.2 kg m^2 it creeps to 0: with S = w^2 (3 - 2 w)
# and w' = -200 S, -200 t = integral of dw / S = -1 / (3 w) + 2/9 ln(w / (3 - 2 w)), up to a constant
line 0.1 0.1
sed -i 's/torque: 20.*}/torque: -40}/' now.veh
# last COLUMN: of the last row of results
last() { awk -F, -v name="$1" 'NR == 1 {for (i = 1; i <= NF; ++i) if ($i ~ "^" name " ") c = i} END {printf "%.17g\n", $c}' results; }
for speed in 0 1e-25 -1e-25; do
    printf 'gicscene: 1\nduration: 0.3\nstep: 0.01\ninitial: {gear: 0, states: {engine.speed: %s}}\n' $speed >now.scene
    for engine in tape tcc gic gcp1; do
        "$gicrun" -q --engine $engine now.veh now.scene -o results >out 2>err
        check "an engine of $speed rad/s stands, $engine" awk "BEGIN {exit !(($(last line.engine_speed))^2 < 1e-40)}"
    done
done
printf 'gicscene: 1\nduration: 0.1\nstep: 0.0005\ninputs: {selector: 0}\ninitial: {gear: 0, states: {engine.speed: 0.5}}\n' >now.scene
for engine in tape tcc gic; do
    "$gicrun" -q --engine $engine --integrator rk4 now.veh now.scene -o results >out 2>err
    check "an engine creeps to rest, $engine" awk "BEGIN {w = $(last line.engine_speed)
        exit !(w > 0 && w < 0.02 && (F(w) - F(0.5) + 200 * 0.1)^2 < 1e-6)}
        function F(w) {return -1 / (3 * w) + 2 / 9 * log(w / (3 - 2 * w))}"
done

# ---- wheels that begin to roll ----------------------------------------------------------------------------------

# at 1 m/s, the low speed of their tires, t' = V_y / V_x = 0.1 whatever rounding makes of it, and fades below; alpha is
# that of t' + tau L t'', and in the air t'' = -(V_x + L V_y / kappa_0) t' / sigma_y
line 0.1 0.1
cat >>now.veh <<'END'
  left: {type: tire, wheel: left}
END
sed -i 's/base: ground/base: carriage/; /^joints:/,/^coordinates:/d; /along: /d; /hold: /d; s/^forces:/# &/' now.veh
for speed in 0.9999999999999 1 1.0000000000001 0.5; do
    printf 'gicscene: 1\nduration: 0.001\nstep: 0.001\ninitial: {velocity: [%s, 0.1, 0]}\n' $speed >now.scene
    for engine in tape tcc gic; do
        "$gicrun" -q --engine $engine now.veh now.scene -o results >out 2>err
        sed -n 1,2p results | awk -F, -v V="$speed" 'NR == 1 {for (i = 1; i <= NF; ++i) if ($i ~ /^left.alpha /) c = i}
            NR == 2 {S = V < 1 ? V * V * (3 - 2 * V) : 1
                t = S * 0.1 / V
                t -= 0.01 * (1 - S) * (V + (1 - S) * 0.1 / 0.3) * t / 0.31
                d = $c - atan2(t, 1)
                exit !(d * d < 1e-20)}'
        verdict $? "rolling at $speed m/s, $engine"
    done
done

# ---- a wheel between two tracks ---------------------------------------------------------------------------------

# it is on the right: 0.02 m high in the middle of the bump there, and 0 with one on the left; a strip has its edges
cat >single.veh <<'END'
gicgen: 1
model: single
base: ground
bodies:
  hub: {mass: 40, com: [0, 0, 0.5], inertia: [1, 1, 1]}
joints:
  post: {type: prismatic, bodies: [ground, hub], axis: [0, 0, 1]}
coordinates:
  post: {type: translation, bodies: [ground, hub], axis: [0, 0, 1], range: [-0.5, 0.5]}
forces:
  post: {type: spring_damper, coordinate: post, stiffness: 2000, damping: 100}
wheels:
  wheel: {body: hub, center: [0, PLACE, 0.5], radius: 0.4, stiffness: 20000, damping: 100}
outputs:
  wheel: {type: wheel, wheel: wheel}
END
# height Y ROAD: under a wheel at y
height() {
    sed "s/PLACE/$1/" single.veh >now.veh
    printf 'gicscene: 1\nduration: 0.01\nstep: 0.01\nroad: %s\noutputs: [wheel.height]\n' "$2" >now.scene
    "$gicrun" -q --engine "$3" now.veh now.scene -o results >out 2>err && sed -n '2s/.*,//p' results
}
bump='x: -1, length: 2, height: 0.02'
table='type: table, x: [-1, 1]'
for y in 0 1e-18 -1e-18 1e-13; do
    for engine in tape gic; do
        check "right of the middle, y = $y, $engine" [ "$(height $y "{type: bumps, bumps: [{$bump, tracks: right}]}" $engine)" = 0.02 ]
        check "not left of it, y = $y, $engine" [ "$(height $y "{type: bumps, bumps: [{$bump, tracks: left}]}" $engine)" = 0 ]
        check "table, y = $y, $engine" [ "$(height $y "{$table, left: [0, 0], right: [0.02, 0.02]}" $engine)" = 0.02 ]
    done
done
check 'the left begins beside it' [ "$(height 1e-8 "{type: bumps, bumps: [{$bump, tracks: left}]}" tape)" = 0.02 ]
check 'the right ends there' [ "$(height 1e-8 "{type: bumps, bumps: [{$bump, tracks: right}]}" tape)" = 0 ]
for y in 0.3 0.30000000000000004 0.29999999999999993; do
    check "a strip to 0.3, y = $y" [ "$(height $y "{type: bumps, bumps: [{$bump, y: [0, 0.3]}]}" tape)" = 0.02 ]
    check "a strip from 0.3, y = $y" [ "$(height $y "{type: bumps, bumps: [{$bump, y: [0.3, 1]}]}" tape)" = 0.02 ]
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
