#!/bin/sh
# SPDX-License-Identifier: MIT
# test_own_states.sh GICGEN GICRUN GICSWEEP: states of a model's own (FORMAT.md section 7.3). Filters of first and second order and a
# chain against their closed solutions, by all integrators and engines; initial values of scenes; equilibrium, modes and
# linear models in closed form; runs against the engine gic, which evaluates rates by itself; a vehicle whose brakes and
# drives follow states and speeds, at one rate and at two; images in the mirror; mistakes. Rates against quad precision
# are in test_accelerations, random mechanisms with states in test_random_mechanisms.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
gicsweep=$(realpath "$3")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# shellcheck source=tests/lib/against_gic.sh
. "$(dirname "$0")/../lib/against_gic.sh"
cd "$work" || exit 1

# ---- steps: one = 1 - 3/4 e^(-2 t); two of 3 rad/s and damping 1/3; behind = what follows one with a lag of 1 s; a mass
# of 2 kg that the first pushes
cat >steps.veh <<'END'
gicgen: 1
model: steps
gravity: [0, 0, 0]
base: ground
bodies: {b: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {j: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, b], axis: [1, 0, 0], range: [-10, 10]}}
inputs: {u: {default: 1}}
parameters: {lag: {value: 0.5, tunable: true}}
states:
  one: {initial: 0.25, rate: "(u - one) / lag"}
  two: {rate: fast}
  fast: {rate: "9 * (u - two) - 2 * fast", unit: 1/s}
  behind: {rate: one - behind}
  clock: {rate: 1, unit: s}
signals: {one_s: one, two_s: two, behind_s: behind, clock_s: clock}
forces: {f: {type: force, coordinate: x, value: "2 * one"}}
outputs:
  one: {type: signal, signal: one_s}
  two: {type: signal, signal: two_s}
  behind: {type: signal, signal: behind_s}
  clock: {type: signal, signal: clock_s}
  x: {type: coordinate, coordinate: x}
END
# scene STEP INTEGRATOR...: lines of a scene
scene() {
    printf 'gicscene: 1\nduration: 2\nstep: %s\noutput_step: 0.25\n' "$1"
    shift
    printf '%s\n' "$@"
}
# error FILE [Z0]: the largest deviation from the closed solutions
error() {
    awk -F, -v z="${2:-0.25}" 'NR > 1 { t = $1; e = exp(-2 * t); w = sqrt(8); d = exp(-t)
            right[2] = 1 - (1 - z) * e
            right[3] = 1 - d * (cos(w * t) + sin(w * t) / w)
            right[4] = 1 + (1 - z) * e - (2 - z) * d
            right[5] = t
            right[6] = t * t / 2 - (1 - z) / 4 * (e - 1 + 2 * t)
            for (i = 2; i <= 6; ++i) { off = $i - right[i]; if (off < 0) off = -off; if (!(off <= most)) most = off } }
        END { print (NR == 10 ? most + 0 : 1) }' "$1"
}
# RK4's error after 2 s at steps h of 1 ms is below 2 (3 h)^4 / 120 * 3 = 4e-12
scene 0.001 'integrator: rk4' >rk4.scene
for engine in auto cc tape gic gcp1 gcp2; do
    "$gicrun" -q --engine $engine steps.veh rk4.scene -o $engine.csv && off=$(error $engine.csv)
    check "RK4 with $engine: ${off:-no run}" within "${off:-1}" 1e-11
done
"$gicrun" -q --general steps.veh rk4.scene -o general.csv && off=$(error general.csv)
check "RK4, general code: ${off:-no run}" within "${off:-1}" 1e-11
for ratio in '' 'ratio: 4'; do
    for step in 0.005 0.0025; do
        scene $step 'integrator: ab3' "$ratio" >ab3.scene
        "$gicrun" -q steps.veh ab3.scene -o ab3.csv && error ab3.csv
        "$gicrun" -q --engine gic steps.veh ab3.scene -o other.csv && error other.csv
    done >errors
    # third order: half the step, an eighth of the error
    awk 'NR == 1 { a = $1 } NR == 3 { b = $1 } END { exit !(NR == 4 && a < 2e-6 && a / b > 6.5 && a / b < 9.5) }' errors
    verdict $? "AB3 $ratio, third order: $(tr '\n' ' ' <errors)"
    off=$(apart ab3.csv other.csv)
    check "AB3 $ratio against gic: $off" within "${off:-1}" 1e-13
done
scene 0.01 'integrator: dopri5' 'tolerance: 1e-10' | sed 's/^integrator.*/integrator: variable/' >variable.scene
"$gicrun" -q steps.veh variable.scene -o variable.csv 2>err && off=$(error variable.csv)
check "variable steps: ${off:-no run}" within "${off:-1}" 1e-8
scene 0.001 'integrator: rk4' 'initial: {states: {one: -1}}' >start.scene
"$gicrun" -q steps.veh start.scene -o start.csv && off=$(error start.csv -1)
check "a scene's initial value: ${off:-no run}" within "${off:-1}" 1e-11
"$gicsweep" -q steps.veh rk4.scene --vary state/one=0:1:3 -o sweep.csv 2>err
[ $? -eq 0 ] && [ "$(wc -l <sweep.csv)" -ge 4 ]
verdict $? 'a sweep over an initial value'
"$gicgen" steps.veh -o steps.c && "$gicgen" --batch 4 steps.veh -o steps_batch.c &&
    ${CC:-cc} -std=c11 -O1 -ffp-contract=off -DGIC_BATCH_LIBM -DBATCH=steps_batch_model -I. -I"$root/runtime" \
        "$root/tests/data/embed/lanes.c" steps.c steps_batch.c "$root/runtime/gic_runtime.c" -lm -o lanes 2>said &&
    [ "$(./lanes)" = '4 4 4 of 4' ]
verdict $? "many vehicles at once: $(./lanes) $(head -n 1 said)"
for std in c99 c11; do
    cc -std=$std -Wall -Wextra -Werror -pedantic -fsyntax-only -I. -I"$root/runtime" steps.c 2>said
    verdict $? "no warnings, $std"
done

# ---- rest, modes and linear model: 2 x'' = 2 z - 50 x - 4 x', z' = (u + 0.1 x - z) / lag
sed 's/^states:/states: {z: {initial: 0.25, rate: "(u + 0.1 * place.x - z) \/ lag"}}/; /^  one:/,/^signals/d
    s/value: "2 \* one"}/value: "2 * z"}, s: {type: spring_damper, coordinate: x, stiffness: 50, damping: 4}/
    /^outputs/,$d' steps.veh >held.veh
printf 'outputs:\n  place: {type: position, body: b}\n' >>held.veh
"$gicrun" --equilibrium held.veh >out 2>err && awk '/^z / { z = $2 } /^x / { x = $2 } END { exit !((z - 1 / 0.996)^2 < 1e-16 && (x - z / 25)^2 < 1e-16) }' out
verdict $? 'rest is where rates are 0'
cat >held.py <<'END'
import sys
import numpy as np
d = np.load(sys.argv[1])
z = 1 / 0.996
assert list(d["states"]) == ["x", "x.rate", "z"], list(d["states"])
for name, wanted in [("z0", [z / 25, 0, z]), ("A", [[0, 1, 0], [-25, -2, 1], [0.2, 0, -2]]), ("B", [[0], [0], [2]])]:
    assert np.allclose(d[name], wanted, rtol=1e-12, atol=1e-12), (name, d[name], wanted)
END
"$gicrun" --linearize held.veh -o held.npz >out 2>err && /usr/bin/python3 -B held.py held.npz >said 2>&1
verdict $? 'a linear model'
"$gicrun" --modes held.veh >out 2>err && grep -q ' -1.9920 .* z 100 %' out
verdict $? 'modes'

# ---- two sides, against gic
model=$root/tests/data/laws/states.veh
cat >sides.scene <<'END'
gicscene: 1
duration: 1
step: 0.001
output_step: 0.1
integrator: rk4
initial: {speed: 10, angular_velocity: [0.1, 0.2, 0.3], rates: {swing_l: 0.5}, states: {flow_r: -0.5}}
inputs: {wish: {sine: {amplitude: 0.5, frequency: 1}}}
END
every_way 'both sides' 1e-11 "$model" sides.scene
sed 's/rates: .*}, states: .*}/position: [0, 0, 1]}/; s/angular_velocity: [^]]*], //' sides.scene >straight.scene
some_ways 'straight on' 1e-11 "$model" straight.scene '' --general

# ---- brakes and drives that follow states, speeds and spins; code for the scene, all code, gic; one rate and two
cp -r "$root/models/parts" "$root/models/tires" .
cp "$root"/models/hmmwv*.veh .
sed 's/brake: 4000 \* brake/brake: "4000 * pedal * tanh(max(0, forward))"/; s/drive: drive_torque \/ 4/drive: "drive_torque \/ 4 - 2 * turned_l"/
    s/^model: .*/model: followed/' hmmwv_tires.veh >followed.veh
cat >>followed.veh <<'END'
states:
  pedal: {rate: "(brake - pedal) / 0.05"}
  turned_l: {rate: "0.1 * (spinning_l.spin - turned_l)", unit: rad/s}
signals:
  forward: {value: own.x, unit: m/s}
  pedal_s: pedal
outputs:
  own: {type: velocity, body: chassis, in: chassis}
  spinning_l: {type: tire, wheel: tire_f_l}
  pedal: {type: signal, signal: pedal_s}
END
sed 's/^duration: .*/duration: 1.5/; /^plot/d' "$root/models/scenes/tires_brake.scene" >two.scene
sed '/^ratio/d; s/^step: .*/step: 0.001/' two.scene >one.scene
for rates in one two; do
    some_ways "brakes and drives, rates: $rates" 1e-8 followed.veh $rates.scene '' --general '--engine tape' '--engine cc --lanes 4'
done
column pedal way.csv | tail -n 1 | awk '{ exit !($1 > 0.99 && $1 < 1) }'
verdict $? 'the pedal arrives'

# ---- an engine held at a speed by a controller with an integral part
sed 's/^    throttle: .*/    throttle: "0.2 * (11 - ahead.x) + lasting"/' parts/hmmwv_powertrain.veh >held && mv held parts/hmmwv_powertrain.veh
cat >cruise.veh <<'END'
gicgen: 1
model: cruise
include: hmmwv_vehicle.veh
states: {lasting: {initial: 0.1, rate: "0.05 * (11 - ahead.x)"}}
outputs:
  ahead: {type: velocity, body: chassis, in: chassis}
  drive: {type: powertrain}
END
# at rest, where the scene would find an equilibrium, the integral part never stops
sed 's/^duration: .*/duration: 3/; /^  equilibrium/d; /^inputs/,$d' "$root/models/scenes/straight.scene" >cruise.scene
some_ways 'a controller of the engine' 1e-8 cruise.veh cruise.scene '' --general '--engine tape'

# ---- entries that nothing reads, and mistakes
# said PLACE MESSAGE: gicgen warns
cat >idle.veh <<'END'
gicgen: 1
model: idle
base: car
bodies: {car: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}
states: {alone: {rate: -alone}, chain: {rate: 1}, end: {rate: chain - end}}
forces: {push: {type: load, body: car, force: [end, 0, 0]}}
END
"$gicgen" idle.veh -o idle.c 2>said && grep -q "^idle.veh:5:10: warning: nothing in the model reads state 'alone'" said &&
    [ "$(grep -c warning: said)" -eq 1 ]
verdict $? "a state that nothing reads: $(cat said)"
# refused PLACE MESSAGE REMEDY STATES [MORE]: one message and no output
refused() {
    rm -f bad.c
    printf 'gicgen: 1\nmodel: m\nbase: car\nbodies: {car: {mass: 1, com: [0, 0, 0], inertia: [1, 1, 1]}}\nstates: %s\n%b\n' "$4" "$5" >bad.veh
    "$gicgen" bad.veh -o bad.c >out 2>said
    [ $? -eq 1 ] && [ ! -e bad.c ] && [ "$(grep -c error: said)" -eq 1 ] && grep -qF "bad.veh:$1: error: $2" said && grep -qF "  remedy: $3" said
    verdict $? "refused: $2"
}
refused 5:10 "state 'z' lacks the key 'rate'" 'add `rate: formula`' '{z: {initial: 1}}'
refused 5:10 "state 'u' has the name of an input" 'give the state another name' '{u: {rate: 1}}' 'inputs: {u: {}}'
refused 6:11 "signal 'z' has the name of a state" 'give the signal another name' '{z: {rate: 1}}' 'signals: {z: 1}'
refused 5:21 "rate of state 'z': there is no 'y'" "did you mean 'z'?" '{z: {rate: "y - z"}}'
refused 5:25 "formulas of states are evaluated before forces are known: rate of state 'z' reads 'seen', an output of type force" \
    'read positions, velocities' '{z: {rate: "1 + seen"}}' \
    'forces: {f: {type: force, bodies: [ground, car], points: [[0, 0, 1], [0, 0, 0]], value: z}}\noutputs: {seen: {type: force, element: f}}'
refused 5:21 "formulas of states are evaluated before forces are known: rate of state 'z' reads 's', value of signal 's' reads 'a.x', an output of type acceleration" \
    'read positions, velocities' '{z: {rate: "s"}}' 'signals: {s: a.x}\noutputs: {a: {type: acceleration, body: car}}'
refused 6:24 "value of signal 't': 's' follows itself: value of signal 's' reads 't', value of signal 't' reads 's'" \
    'let one of them read' '{z: {rate: "s"}}' 'signals: {s: "2*t", t: s + z}'

# names that states of wheels and of the powertrain have in generated code
for own in tire_f_l_spin ENGINE_speed; do
    printf 'gicgen: 1\nmodel: named\ninclude: %s\nstates: {%s: {rate: -%s}}\n' "$root/models/hmmwv_vehicle.veh" $own $own >bad.veh
    "$gicgen" bad.veh -o bad.c >out 2>said
    [ $? -eq 1 ] && [ ! -e bad.c ] && grep -q "bad.veh:4:10: error: the states '.*' and '$own' have the same name in generated code" said
    verdict $? "a state called $own"
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
