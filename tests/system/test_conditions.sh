#!/bin/sh
# SPDX-License-Identifier: MIT
# test_conditions.sh GICRUN GICSWEEP: `until` and `when` of scenes: times of conditions against closed solutions, with
# all integrators; what starts then; what became of a vehicle; and every mistake with its place and a remedy.
gicrun=$1
gicsweep=$2
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"

# A cart on a spring, x = 0.1 cos(6 t), and one that is driven.
cat >"$work/carts.veh" <<'END'
gicgen: 1
model: carts
gravity: [0, 0, 0]
base: ground
bodies:
  left: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
  right: {mass: 3, com: [0, 1, 0], inertia: [1, 1, 1]}
joints:
  left: {type: prismatic, bodies: [ground, left], axis: [1, 0, 0]}
  right: {type: prismatic, bodies: [ground, right], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, left], axis: [1, 0, 0], range: [-5, 5]}
  drive: {type: translation, bodies: [ground, right], axis: [1, 0, 0], range: [-5, 5], driven: true}
inputs:
  push: {unit: N}
forces:
  spring: {type: spring_damper, coordinate: x, stiffness: 72}
  push: {type: force, coordinate: x, value: push}
outputs:
  x: {type: coordinate, coordinate: x}
  drive: {type: coordinate, coordinate: drive}
END
scene() {
    printf 'gicscene: 1\nduration: 2\nstep: 0.001\noutput_step: 0.02\nintegrator: rk4\ninitial: {coordinates: {x: 0.1}}\n%s\n' \
        "$1" >"$work/a.scene"
}
# happened TEXT TIME TOLERANCE: does the summary say that it happened then?
happened() {
    awk -v text="$1" -v want="$2" -v most="$3" 'index($0, text " at t = ") {
        split(substr($0, index($0, " at t = ") + 8), word, " "); d = word[1] - want; found = d <= most && d >= -most}
        END {exit !found}' "$work/err"
}
# last COLUMN VALUE TOLERANCE: of the last row
last() {
    awk -F, -v c="$1" -v want="$2" -v most="$3" '{x = $c} END {d = x - want; exit !(d <= most && d >= -most)}' "$work/a.csv"
}

# pi / 12; asin(1/2) / 6; a step's half is over 0.05 s after it began, and it begins 1/64 s late, which no step ends at
scene 'until: x.value < 0
when:
  - {if: "rate(x) < -0.3", mark: fast, inputs: {drive: {step: {to: 0.5, start: 0.015625, rise: 0.1}}}}
  - {if: "time > 0.1", mark: late}
  - {if: "input.drive >= 0.25 and rate(drive) > 0", mark: halfway}'
for integrator in ab3 rk4 adams rkck; do
    engines='tape tcc'
    [ $integrator != rk4 ] || engines="$engines gic gcp2"
    for engine in $engines; do
        run "$work/carts.veh" "$work/a.scene" --integrator $integrator --tolerance 1e-11 --engine "$engine" -o "$work/a.csv"
        case $integrator in ab3 | rk4)
            run "$work/carts.veh" "$work/a.scene" --integrator $integrator --engine "$engine" -o "$work/a.csv"
            ;;
        esac
        near=1e-8
        [ $integrator != ab3 ] || near=1e-7 # order 3: 0.001^3 * 6^4 / 12
        check "$integrator, $engine: a run ends at a condition" exits 0
        check "$integrator, $engine: when" happened 'x.value < 0' 0.261799387799 $near
        check "$integrator, $engine: rate of a coordinate" happened 'rate(x) < -0.3' 0.0872664625997 $near
        check "$integrator, $engine: time" happened 'time > 0.1' 0.1 1e-12
        check "$integrator, $engine: an input that an action moves" \
            happened 'input.drive >= 0.25 and rate(drive) > 0' 0.1528914625997 $near
        check "$integrator, $engine: the last row is the end" last 1 0.261799387799 $near
        check "$integrator, $engine: and its state" last 2 0 $near
        check "$integrator, $engine: what started has its effect" last 5 0.5 1e-9
        check "$integrator, $engine: marks are columns" awk -F, 'NR == 1 {good = $0 ~ /,mark.fast \[1\],mark.late \[1\],mark.halfway \[1\]$/}
            NR > 1 {good = good && $8 == ($1 > 0.0873) && $9 == ($1 > 0.1000001) && $10 == ($1 > 0.1529)} END {exit !good}' "$work/a.csv"
    done
done

# what happens goes on as it would from a run of its own: a push from pi / 12 on, where the cart has -0.6 m/s:
# x = c (1 - cos(6 s)) - 0.1 sin(6 s) with c = 3.6 / 72
scene 'when: [{if: "x < 0", inputs: {push: 3.6}}]'
for integrator in rk4 adams; do
    run "$work/carts.veh" "$work/a.scene" --integrator $integrator --tolerance 1e-11 -o "$work/a.csv"
    [ $integrator != rk4 ] || run "$work/carts.veh" "$work/a.scene" -o "$work/a.csv"
    check "$integrator: the push starts within a step" awk -F, 'NR > 1 {s = $1 - 3.14159265358979 / 12
        x = s < 0 ? 0.1 * cos(6 * $1) : 0.05 * (1 - cos(6 * s)) - 0.1 * sin(6 * s)
        d = $2 - x; if (!(d < 1e-9 && d > -1e-9)) bad = 1} END {exit bad || NR != 102}' "$work/a.csv"
done
check "output times stay" [ "$(sed 1d "$work/a.csv" | cut -d, -f1)" = "$(awk 'BEGIN {for (i = 0; i <= 100; ++i) printf "%.15g\n", i / 50}')" ]
scene 'until: x.value > 0.2'
run "$work/carts.veh" "$work/a.scene" -o "$work/a.csv"
check "a condition that does not become true" says 'did not happen *x.value > 0.2'
check "the run goes to its end" last 1 2 0
scene 'until: x.value > 0'
run "$work/carts.veh" "$work/a.scene" -o "$work/a.csv"
check "one that holds at the start must cease to hold first: 3/4 of a period" happened 'x.value > 0' 0.785398163397 1e-8

# ---- a vehicle: conditions on its motion, a driver's new target, gears
printf '%s\n' 'gicscene: 1' 'duration: 12' 'step: 0.006' 'ratio: 6' 'output_step: 0.06' \
    'initial: {position: [0, 0, 0.4825], equilibrium: true}' \
    'inputs: {brake: 0.3}' \
    'when:' '  - {if: time > 0.3, inputs: {brake: {step: {to: 0, rise: 0.3}}, accelerator: {step: {to: 1, rise: 0.3}}}}' \
    '  - {if: drive.gear >= 2, mark: second, inputs: {accelerator: {step: {to: 0, rise: 0.2}}, brake: {step: {to: 0.5, rise: 0.3}}}}' \
    >"$work/drive.scene"
run models/hmmwv_vehicle.veh "$work/drive.scene" -o "$work/a.csv"
check "one that comes to rest is reported" says 'vehicle at rest'
echo 'until: "time > 1.9 and speed < 2"' >>"$work/drive.scene"
run models/hmmwv_vehicle.veh "$work/drive.scene" -o "$work/a.csv"
check "a vehicle pulls away, shifts and brakes" exits 0
check "it ends where the condition says" says 'ended  *time > 1.9 and speed < 2'
column() { awk -F, -v name="$1" 'NR == 1 {for (i = 1; i <= NF; ++i) if (index($i, name " ") == 1) c = i} END {print $c}' "$work/a.csv"; }
check "at that speed" awk -v v="$(column chassis_velocity.x)" 'BEGIN {exit !(v < 2.001 && v > 1.999)}'
check "the mark is set" [ "$(column mark.second)" = 1 ]
run models/hmmwv_vehicle.veh models/scenes/roll_over.scene -o "$work/a.csv"
check "a vehicle on its side is reported" says 'vehicle tips over'
run models/hmmwv_vehicle.veh models/scenes/step_steer.scene -o "$work/a.csv"
check "one that stays on its wheels is not" eval '! says "vehicle tips over"'
printf '%s\n' 'gicscene: 1' 'duration: 2' 'step: 0.005' 'initial: {speed: 5}' \
    'road: {type: table, x: [-5, 5], height: [0, 0.01]}' >"$work/short.scene"
run models/hmmwv.veh "$work/short.scene" -o "$work/a.csv"
check "one that leaves the road's data is reported" says "beyond the road's data from t = 1"

# ---- mistakes
# bad PLACE TEXT
bad() {
    run "$work/carts.veh" "$work/a.scene" -o "$work/never.csv"
    check "mistake: exit status 1 for $2" exits 1
    check "mistake: $1 $2" grep -q "^$work/a.scene:$1: error: .*$2" "$work/err"
    check "mistake: one error, one remedy for $2" [ "$(grep -c 'error: ' "$work/err") $(grep -c 'remedy: ' "$work/err")" = '1 1' ]
    check "mistake: no results for $2" [ ! -e "$work/never.csv" ]
}
scene 'until: y.value < 0'
bad 7:8 "there is no 'y.value'"
scene 'until: speed < 0.1'
bad 7:8 "there is no 'speed'"
scene 'until: 1 < 2'
bad 7:8 'the same all along'
scene 'until: time > 3'
bad 7:8 'can never hold'
scene 'until: time < 1'
bad 7:8 'does not become true between 0 and 2 s'
scene 'until: time >= 0'
bad 7:8 'holds from the start'
scene 'until: abs(x) < -1'
bad 7:8 'can never hold'
scene 'until: x.value ^ 2 < 1 or time < 9'
bad 7:8 'holds from the start'
scene 'until: x.value = 1'
bad 7:16 'compares nothing'
scene 'when: {if: x < 0, mark: a}'
bad 7:7 'must be a list'
scene 'when: [{mark: a}]'
bad 7:8 "needs the key 'if'"
scene 'when: [{if: x < 0}]'
bad 7:8 'nothing happens'
scene 'when: [{if: x < 0, mark: a}, {if: x > 0, mark: a}]'
bad 7:48 'set by two conditions'
scene 'when: [{if: x < 0, inputs: {pull: 3}}]'
bad 7:29 "no input 'pull'"
scene 'when: [{if: x < 0, inputs: {push: {step: {to: 1, rise: -1}}}}]'
bad 7:56 'must be positive'
scene 'when: [{if: x < 0, target: 3}]'
bad 7:28 'no driver keeps a speed'
scene 'when: [{if: x < 0, inputs: {drive: {step: {from: 0.3, to: 1, rise: 1}}}}]'
run "$work/carts.veh" "$work/a.scene" -o "$work/a.csv"
check "a driven coordinate does not jump" says "the value of 'drive' would jump from 0 to 0.3"
scene 'until: x < 0'
"$gicsweep" -q "$work/carts.veh" "$work/a.scene" --vary push=0:1:2 -o "$work/s.csv" >"$work/out" 2>"$work/err"
check "sweeps have no conditions" says 'the scene has conditions'

# states of the model, among them what controllers hold: s = t from the start, c counts at 0, 0.25, 0.5 ...; u is 10 times what c was at the sample before, 0.1 s later
cat >"$work/states.veh" <<'END'
gicgen: 1
model: states
gravity: [0, 0, 0]
base: BASE
states: {other: {rate: "-1"}, s: {rate: "1"}}
bodies:
  m: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}
  n: {mass: 1, com: [1, 0, 0], inertia: [1, 1, 1]}
joints: {rail: {type: prismatic, bodies: [ROOT, n], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ROOT, n], axis: [1, 0, 0], range: [-9, 9]}}
controllers:
  c: {period: 0.25, rules: {n: "c.n + 1", u: {value: "10 * c.n", delay: 0.1}}}
END
for base in ground m; do
    # without the body m, or with it
    sed "s/BASE/$base/; s/ROOT/$base/" "$work/states.veh" | sed "$([ $base = m ] || echo '/^  m:/d')" >"$work/held.veh"
    for way in '' --general '--engine tape' '--engine gic' '--engine gcp1' '--integrator rkck'; do
        for condition in 's > 0.5|0.5' 's + time > 0.5|0.25' 's > 0.7 + other|0.35' 'c.n > 2.5|0.5' 'c.u > 15|0.6' 'c.u + 100 * s > 55|0.45'; do
            echo "{gicscene: 1, duration: 1, step: 0.01, output_step: 0.1, integrator: rk4, until: '${condition%|*}'}" >"$work/a.scene"
            # shellcheck disable=SC2086  # a list of words
            run $way "$work/held.veh" "$work/a.scene" -o "$work/a.csv"
            check "$base, $way: ${condition%|*}" happened "${condition%|*}" "${condition#*|}" 1e-9
        done
    done
done

# ---- what follows at the same time: an input jumps and with it an acceleration, two at one instant, an end; x'' = push / 2
sed -e '/^  spring:/d' -e 's/^outputs:/&\n  push: {type: acceleration, body: left}/' "$work/carts.veh" >"$work/pushed.veh"
for integrator in ab3 rk4 ros3 adams rkck; do
    printf 'gicscene: 1\nduration: 1\nstep: 0.01\noutput_step: 0.1\nintegrator: %s\n%s\n' $integrator 'when:
  - {if: "time > 0.355", inputs: {push: 1}}
  - {if: "input.push > 0.5", mark: pushed}
  - {if: "push.x > 0.25", mark: faster}
  - {if: "time > 0.355", mark: twin}
  - {if: "x < 0", mark: never}' >"$work/a.scene"
    case $integrator in adams | rkck) echo 'tolerance: 1e-12' >>"$work/a.scene" ;; esac
    run "$work/pushed.veh" "$work/a.scene" -o "$work/a.csv"
    for condition in 'time > 0.355' 'input.push > 0.5' 'push.x > 0.25'; do
        check "$integrator: $condition" happened "$condition" 0.355 1e-12
    done
    check "$integrator: both of one condition" [ "$(grep -c 'happened *time > 0.355 at t = 0.355 s' "$work/err")" -eq 2 ]
    check "$integrator: what does not follow" says 'did not happen *x < 0'
    check "$integrator: one parabola from there on" awk -F, 'NR > 1 {s = $1 < 0.355 ? 0 : $1 - 0.355; d = $5 - s * s / 4
        if (!(d < 1e-10 && d > -1e-10)) bad = 1} END {exit bad || NR != 12}' "$work/a.csv"
    sed -i 's/^when:/until: "input.push > 0.5"\n&/' "$work/a.scene"
    run "$work/pushed.veh" "$work/a.scene" -o "$work/a.csv"
    check "$integrator: an end that follows" last 1 0.355 1e-12
done

# ---- a controller counts, and copies an input a period later. The third sample, at 0.2 s, sets that input: it has read it as it was
# before, wherever steps end, so that the copy is 1 up to 0.4 s and 2 then
cat >"$work/counts.veh" <<'END'
gicgen: 1
model: counts
base: ground
bodies: {n: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {rail: {type: prismatic, bodies: [ground, n], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, n], axis: [1, 0, 0], range: [-9, 9]}}
inputs: {f: {unit: N}}
controllers:
  c: {period: 0.1, rules: {n: "c.n + 1", d: {value: f, delay: 0.1}}}
signals: {d: c.d}
outputs: {d: {type: signal, signal: d}}
END
for integrator in ab3 rk4 ros2 adams rkck; do
    for step in 0.1 0.05 0.025 0.07 0.03; do
        printf 'gicscene: 1\nduration: 1\nstep: %s\noutput_step: 0.05\nintegrator: %s\ninputs: {f: 1}\nwhen: [{if: "c.n >= 3", inputs: {f: 2}}]\n' \
            $step $integrator >"$work/a.scene"
        case $step in 0.07 | 0.03) sed -i "s/output_step: 0.05/output_step: $(awk "BEGIN {print 5 * $step}")/; s/duration: 1/duration: $(awk "BEGIN {print 30 * $step}")/" "$work/a.scene" ;;
        0.1) sed -i 's/output_step: 0.05/output_step: 0.1/' "$work/a.scene" ;;
        esac
        run "$work/counts.veh" "$work/a.scene" -o "$work/a.csv"
        check "$integrator, $step: the third sample" happened 'c.n >= 3' 0.2 1e-9
        check "$integrator, $step: what was read" awk -F, 'NR > 1 && ($1 > 0.1001 && $1 < 0.3999 || $1 > 0.4001) {
            wrong += $2 != ($1 < 0.4 ? 1 : 2); n += 1} END {exit wrong || n < 4}' "$work/a.csv"
    done
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
