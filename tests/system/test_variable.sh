#!/bin/sh
# SPDX-License-Identifier: MIT
# test_variable.sh GICRUN: integration with variable steps: against published and closed solutions, against constant
# steps, at kinks of inputs, over changes of the dependent Euler parameter, and what users are told.
gicrun=$1
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# near A B TOLERANCE
near() { awk -v a="$1" -v b="$2" -v t="$3" 'BEGIN {d = a - b; exit !(d * d <= t * t && a != "" && b != "")}' || {
    echo "$1 is not $2 within $3" >>"$work/err"
    false
}; }
# at FILE COLUMN TIME: a number of a results file
at() { awk -F, -v column="$2" -v time="$3" 'NR == 1 {for (i = 1; i <= NF; ++i) if ($i ~ "^" column " ") c = i}
    $1 == time {print $c}' "$1"; }
# apart A B COLUMNS: the largest difference of columns 2 to COLUMNS between two results files with the same times
apart() { paste -d, "$1" "$2" | awk -F, -v n="$3" 'NR > 1 {
    if ($1 != $(NF / 2 + 1)) bad = 1
    for (i = 2; i <= n; ++i) {d = $i - $(NF / 2 + i); if (d < 0) d = -d; if (d > most) most = d}
} END {print bad || NR < 3 ? "nan" : most}'; }
below() { awk -v a="$1" -v b="$2" 'BEGIN {exit !(a != "nan" && a <= b)}' || {
    echo "$1 is not below $2" >>"$work/err"
    false
}; }

# The pendulum of 1 m from the horizontal; published: IFToMM benchmark A01. Nothing damps it: errors of 1e-11 a step
# change its energy with the number of steps, some thousand, and its place with the square of that.
for integrator in adams rkck; do
    run models/pendulum.veh models/scenes/pendulum.scene --integrator $integrator --tolerance 1e-11 -o "$work/a.csv"
    check "$integrator: the pendulum runs" exits 0
    check "$integrator: output times are exact" [ "$(sed 1d "$work/a.csv" | cut -d, -f1)" = \
        "$(awk 'BEGIN {for (i = 0; i <= 1000; ++i) printf "%.15g\n", i / 100}')" ]
    check "$integrator: x at 2 s" near "$(at "$work/a.csv" bob.x 2)" -0.793566195343 1e-9
    check "$integrator: z at 2 s" near "$(at "$work/a.csv" bob.z 2)" -0.608483930444 1e-9
    check "$integrator: x at 10 s" near "$(at "$work/a.csv" bob.x 10)" -0.275087462576 1e-7
    check "$integrator: z at 10 s" near "$(at "$work/a.csv" bob.z 10)" -0.961419205099 1e-7
done

# Andrews' mechanism against converged values (two independent integrations; Test Set for IVP Solvers), 0.03 s with
# beta turning more than twice: with rates of 1e3 rad/s a step may err by 1e-9 rad/s
sed 's/^step:.*/step: 0.001/; s/^output_step:.*//; s/^integrator:.*/integrator: adams\ntolerance: 1e-12/' \
    models/scenes/andrews.scene >"$work/andrews.scene"
run models/andrews.veh "$work/andrews.scene" -o "$work/a.csv"
check "Andrews' mechanism" near "$(at "$work/a.csv" beta.value 0.03)" 15.8107711951537 1e-7

# Loose tolerances try steps whose stages reach over a singular configuration. They are shortened, and what such a stage
# did to the starts of Newton's method is undone: errors stay within those of ten steps of 0.1 (1 + |beta|).
for tolerance in 0.1 0.05 0.02 0.01; do
    run models/andrews.veh "$work/andrews.scene" --integrator rkck --tolerance $tolerance -o "$work/a.csv"
    check "Andrews' mechanism with $tolerance" exits 0
    check "Andrews' mechanism with $tolerance: where it is" near "$(at "$work/a.csv" beta.value 0.03)" 15.8107711951537 0.3
done

# The HMMWV over a bump, against RK4 with steps of 0.1 ms, whose own error is below 1e-9 (C1 ends of the bump included).
# Each step adds an error below the tolerance (1 + |x|); damping takes care that they don't pile up: ten times the
# tolerance. Fewer digits must cost less.
scene() {
    cat <<'XXX'
gicscene: 1
duration: 1.6
output_step: 0.04
initial: {position: [0, 0, 0.4740625], velocity: [5, 0, 0]}
road: {type: bumps, bumps: [{x: 4, length: 2, height: 0.06, tracks: left}]}
outputs: [chassis, wheel_f_l, wheel_r_l]
XXX
}
{ scene; echo 'step: 0.0001'; echo 'integrator: rk4'; } >"$work/fine.scene"
{ scene; echo 'integrator: adams'; } >"$work/variable.scene"
run models/hmmwv.veh "$work/fine.scene" -o "$work/fine.csv"
check 'the vehicle with constant steps' exits 0
for integrator in adams rkck; do
    before=1000000
    for digits in 8 4; do
        run models/hmmwv.veh "$work/variable.scene" --integrator $integrator --tolerance 1e-$digits -o "$work/a.csv"
        check "$integrator: error with a tolerance of 1e-$digits" \
            below "$(apart "$work/fine.csv" "$work/a.csv" 10)" "1e-$((digits - 1))"
        count=$(sed -n 's/.* right-hand sides *//p' "$work/err")
        check "$integrator: a tolerance of 1e-$digits costs less than a tighter one" [ "$count" -lt "$before" ]
        before=$count
    done
done

# Turning freely on flat ground, the vehicle changes its dependent Euler parameter; nothing may come of it. Nothing
# damps the turn either, so that errors of 1e-8 a step add up; a jump would be of the size of the parameters, 0.1 and more
sed '/^road/d; s/velocity/angular_velocity: [0, 0, 3], velocity/' "$work/fine.scene" >"$work/turn.scene"
run models/hmmwv.veh "$work/turn.scene" -o "$work/fine.csv"
run models/hmmwv.veh "$work/turn.scene" --integrator adams --tolerance 1e-8 -o "$work/a.csv"
check 'turning: the dependent parameter changes' says 'parameter switches *[1-9]'
check 'turning: the error stays small' below "$(apart "$work/fine.csv" "$work/a.csv" 10)" 1e-6

# A body tumbles freely and changes its dependent parameter again and again. What the right-hand side does not use drifts,
# and the stepper has to start anew with what is shown: against RK4 with steps of 1 ms, whose own error is below 1e-8.
# 1657 steps with errors of 1e-8 each.
cat >"$work/top.veh" <<'XXX'
gicgen: 1
model: top
gravity: [0, 0, 0]
base: top
bodies:
  top: {mass: 2, com: [0, 0, 0], inertia: [1, 2, 3]}
outputs:
  tip: {type: position, body: top, point: [1, 0, 0]}
  edge: {type: position, body: top, point: [0, 1, 0]}
XXX
cat >"$work/top.scene" <<'XXX'
gicscene: 1
duration: 100
step: 0.001
output_step: 1
integrator: rk4
initial: {angular_velocity: [0.3, 3, 0.2]}
XXX
run "$work/top.veh" "$work/top.scene" -o "$work/fine.csv"
sed '/^step/d' "$work/top.scene" >"$work/tumble.scene"
run "$work/top.veh" "$work/tumble.scene" --integrator rkck --tolerance 1e-8 -o "$work/a.csv"
check 'tumbling: the dependent parameter changes' says 'parameter switches *[1-9][0-9]'
check 'tumbling: the error stays small' below "$(apart "$work/fine.csv" "$work/a.csv" 7)" 2e-5

# A cart at rest and a push that lasts 2 ms in the middle of an output step of 1 s: without a stop at the knots a step
# would pass over it. Quintics from 0 to 3000 N and back have the mean 1500 N: 3 N s, 1.5 m/s for 2 kg.
cat >"$work/cart.veh" <<'XXX'
gicgen: 1
model: cart
gravity: [0, 0, 0]
base: ground
bodies:
  cart: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, bodies: [ground, cart], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, cart], axis: [1, 0, 0], range: [-9, 9]}
inputs:
  push: {unit: N}
forces:
  push: {type: force, coordinate: x, value: push}
outputs:
  x: {type: coordinate, coordinate: x}
XXX
cat >"$work/cart.scene" <<'XXX'
gicscene: 1
duration: 2
output_step: 1
integrator: adams
tolerance: 1e-9
inputs: {push: {knots: {times: [0.412, 0.413, 0.414], values: [0, 3000, 0]}}}
XXX
for integrator in adams rkck; do
    run "$work/cart.veh" "$work/cart.scene" --integrator $integrator -o "$work/a.csv"
    check "$integrator: a short push is not missed" near "$(at "$work/a.csv" x.rate 2)" 1.5 1e-7
    # from the middle of the push on at constant speed, for it is symmetric
    check "$integrator: nor is its place" near "$(at "$work/a.csv" x.value 2)" 2.3805 1e-7
done

# A bump 5 cm long at 30 m/s, after a second on flat ground where steps have become long: as RK4 has it with steps of
# 0.1 ms, three millimetres; and as a table with the same bump among straight pieces has it. Steps go up to the bump, over
# it and on: some hundreds, where steps of a millimetre everywhere would be twenty thousand.
short() {
    cat <<XXX
gicscene: 1
duration: 2
output_step: 0.5
initial: {position: [0, 0, 0.4740625], velocity: [30, 0, 0]}
road: $1
outputs: [chassis, wheel_f_l, wheel_r_l]
XXX
}
bump='{type: bumps, bumps: [{x: 30.01, length: 0.05, height: 0.03}]}'
table='{type: table, x: [0, 30, 30.02, 30.04, 90], height: [0, 0, 0.03, 0, 0]}'
short '{type: flat}' >"$work/level.scene"
run models/hmmwv.veh "$work/level.scene" --integrator adams --tolerance 1e-6 -o "$work/level.csv"
for road in "$bump" "$table"; do
    kind=$(echo "$road" | sed 's/{type: //; s/,.*//')
    { short "$road"; echo 'step: 0.0001'; echo 'integrator: rk4'; } >"$work/fine.scene"
    run models/hmmwv.veh "$work/fine.scene" -o "$work/fine.csv"
    check "$kind: the road moves the car" eval '! below "$(apart "$work/level.csv" "$work/fine.csv" 10)" 1e-4'
    { short "$road"; echo 'integrator: adams'; } >"$work/variable.scene"
    for integrator in adams rkck; do
        run models/hmmwv.veh "$work/variable.scene" --integrator $integrator --tolerance 1e-6 -o "$work/a.csv"
        check "$kind, $integrator: no step passes over it" below "$(apart "$work/fine.csv" "$work/a.csv" 10)" 1e-5
        check "$kind, $integrator: steps are long elsewhere" \
            [ "$(sed -n 's/.* in \([0-9]*\) steps of .*/\1/p' "$work/err")" -lt 1000 ]
    done
done

# Pushed back to where it came from by 10 m/s^2: where it turns its speed says little of how far it goes in a step, and the
# motion before the bump is a parabola, which integrators follow in steps of a second. RK4 as above
cat >"$work/sled.veh" <<'XXX'
gicgen: 1
model: sled
base: ground
gravity: [0, 0, -10]
bodies:
  sled: {mass: 1, com: [0, 0, 1], inertia: [1, 1, 1]}
  hub: {mass: 1, com: [0, 0, 0.3], inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, bodies: [ground, sled], axis: [1, 0, 0]}
  post: {type: prismatic, bodies: [sled, hub], axis: [0, 0, 1]}
coordinates:
  x: {type: translation, bodies: [ground, sled], axis: [1, 0, 0], range: [-99, 900]}
  z: {type: translation, bodies: [sled, hub], axis: [0, 0, 1], range: [-1, 9]}
forces:
  push: {type: force, coordinate: x, value: "20"}
wheels:
  wheel: {body: hub, center: [0, 0, 0.3], radius: 0.3, stiffness: 1000, damping: 20}
outputs:
  x: {type: coordinate, coordinate: x}
  z: {type: coordinate, coordinate: z}
XXX
cat >"$work/sled.scene" <<'XXX'
gicscene: 1
duration: 2.4
output_step: 2.4
initial: {coordinates: {z: -0.01}, rates: {x: -10}}
road: {type: bumps, bumps: [{x: 0.5, length: 0.05, height: 0.03}]}
XXX
{ cat "$work/sled.scene"; echo 'step: 0.0001'; echo 'integrator: rk4'; } >"$work/fine.scene"
run "$work/sled.veh" "$work/fine.scene" -o "$work/fine.csv"
check 'a sled that is pushed over a bump swings' [ "$(at "$work/fine.csv" z.rate 2.4 | cut -c1-5)" = -0.04 ]
for integrator in adams rkck; do
    run "$work/sled.veh" "$work/sled.scene" --integrator $integrator --tolerance 1e-6 -o "$work/a.csv"
    check "$integrator: no step from where it turns passes over a bump" \
        near "$(at "$work/a.csv" z.rate 2.4)" "$(at "$work/fine.csv" z.rate 2.4)" 1e-4
done

# A failure is told with its status, and what was computed is kept: the force ceases to be a number at x = 1, where the
# cart arrives before 0.5 s (it is never slower than 2 m/s) and after 0.47 s (it is never pushed by more than 1 N)
sed 's/value: push/value: sqrt(1 - x)/; /^inputs/d; /^  push: {unit/d' "$work/cart.veh" >"$work/wall.veh"
sed 's/^inputs.*/initial: {rates: {x: 2}}/; s/^output_step.*/output_step: 0.1/' "$work/cart.scene" >"$work/wall.scene"
for integrator in adams rkck; do
    run "$work/wall.veh" "$work/wall.scene" --integrator $integrator -o "$work/a.csv"
    check "$integrator: a run that can go no further fails" exits 1
    check "$integrator: it is told when and why" says "the run ends at t = 0\.4[789][0-9]* s: a result is not a finite"
    # the names, five output times, and the last state
    check "$integrator: its results are kept" [ "$(wc -l <"$work/a.csv")" -eq 7 ]
    check "$integrator: with its last state" says "at t = $(tail -n 1 "$work/a.csv" | cut -c1-7)"
done

# refuse TEXT REMEDY SED: the scene changed by SED brings a message with a place, and a remedy
refuse() {
    sed "$3" "$work/cart.scene" >"$work/bad.scene"
    run "$work/cart.veh" "$work/bad.scene"
    check "refused: $1" exits 1
    check "message: $1" says "^$work/bad.scene:[0-9]*:[0-9]*: error: .*$1"
    check "remedy of: $1" says "remedy: .*$2"
}
refuse "no integrator 'adam'" 'write ab3, rk4, ros2, ros3, imex, exp3, adams, rkck, bdf or auto' 's/adams/adam/'
refuse 'tolerance must be between 1e-13 and 0.1' 'for example 1e-6' 's/^tolerance.*/tolerance: 1e-14/'
refuse 'tolerance must be between 1e-13 and 0.1' 'for example 1e-6' 's/^tolerance.*/tolerance: 1/'
refuse 'ab3 has constant steps' 'integrator: adams' 's/adams/ab3/'
refuse "with rk4 needs the key 'step'" 'step: ' 's/adams/rk4/; /^tolerance/d'
refuse "without step needs the key 'output_step'" 'output_step: ' '/^output_step/d'
run "$work/cart.veh" "$work/cart.scene" --integrator dassl
check 'an unknown integrator is a usage error' exits 2
run "$work/cart.veh" "$work/cart.scene" --tolerance 1e-6x
check 'a tolerance that is no number is a usage error' exits 2
run models/pendulum.veh models/scenes/pendulum.scene --tolerance 1e-6
check 'a tolerance for constant steps is refused' says 'remedy: .*--integrator adams'

# Where all coordinates are driven there is no state: a mass that goes as 10 s^3 - 15 s^4 + 6 s^5 takes the force that is its
# second derivative, whatever the steps.
cat >"$work/driven.veh" <<'END'
gicgen: 1
model: driven
base: ground
gravity: [0, 0, 0]
bodies: {m: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {rail: {type: prismatic, bodies: [ground, m], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, m], axis: [1, 0, 0], driven: true}}
outputs: {force: {type: drive_force, coordinate: x}}
END
for integrator in rkck adams; do
    for engine in tcc gic tape; do
        echo "{gicscene: 1, duration: 2, output_step: 0.125, integrator: $integrator, inputs: {x: {step: {to: 1, rise: 1}}}}" >"$work/driven.scene"
        run --engine $engine "$work/driven.veh" "$work/driven.scene" -o "$work/driven.csv"
        check "$integrator, $engine: a model without states runs" exits 0
        check "$integrator, $engine: with the force of its motion" awk -F, 'NR > 1 { s = $1; f = s < 1 ? 60 * s - 180 * s * s + 120 * s * s * s : 0
            d = $2 - f; if (!(d * d <= 1e-22)) bad = 1 } END { exit bad || NR != 18 }' "$work/driven.csv"
    done
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
